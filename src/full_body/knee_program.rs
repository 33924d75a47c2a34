//! The joint angles nearest to given ones that are nowhere jerked harder than they may be.

use crate::full_body::limits::MOST_BENT;
use crate::full_body::smooth::SHORTEST_STEP;
use crate::quadratic::{Program, Unsolved};

/// What a radian by which a joint is jerked too hard weighs against squares of radians by which angles are others than given: more
/// than any of these could gain.
const JERKED: f64 = 1e3;

/// The objective is known to this, squares of radians.
const GAP: f64 = 1e-9;

/// What angles are bound to.
#[derive(Clone, Copy, Debug)]
pub struct Bounds<'a> {
    /// Samples at which they may be others than given.
    pub free: &'a [bool],
    /// They are not below this where they are free, nor below 0, radians.
    pub least: &'a [f64],
    /// Their second derivative by differences is at most this, radians/s²; where none is, it is beyond it by the least.
    pub most: f64,
}

/// Angles nearest to `given` by the sum of squares. Cost: a few dozen factorisations of a banded system, linear in samples.
///
/// # Errors
/// [`Unsolved`] where the solver gives up.
pub fn nearest(times: &[f64], given: &[f64], bounds: &Bounds<'_>) -> Result<Vec<f64>, Unsolved> {
    let mut count = 0;
    let mut unknown = vec![None; given.len()];
    for at in (0..given.len()).filter(|&at| bounds.free[at]) {
        unknown[at] = Some(count);
        count += 1;
    }
    let mut program = Program::new(count + 1);
    program.add_linear(count, JERKED);
    program.add_upper(&[(count, -1.0)], 0.0);
    for (at, column) in unknown.iter().enumerate() {
        let Some(column) = *column else { continue };
        program.add_square(column, 1.0, given[at]);
        program.add_upper(&[(column, -1.0)], -bounds.least[at].clamp(0.0, MOST_BENT));
        program.add_upper(&[(column, 1.0)], MOST_BENT.max(given[at]));
    }
    for at in 1..given.len().saturating_sub(1) {
        let own = &unknown[at - 1..=at + 1];
        if own.iter().all(Option::is_none) {
            continue;
        }
        let (weights, step_sq) = second_difference([times[at - 1], times[at], times[at + 1]]);
        let fixed: f64 = (0..3).filter(|k| own[*k].is_none()).map(|k| weights[k] * given[at - 1 + k]).sum();
        for sign in [1.0, -1.0] {
            let entry = |k: usize| own[k].map(|column| (column, sign * weights[k]));
            let mut row: Vec<(usize, f64)> = (0..3).filter_map(entry).collect();
            row.push((count, -1.0));
            program.add_upper(&row, bounds.most * step_sq - sign * fixed);
        }
    }
    let found = program.solve(GAP)?;
    Ok(given
        .iter()
        .zip(unknown)
        .map(|(given, column)| column.map_or(*given, |column| found[column]))
        .collect())
}

/// Weights of three values in their second difference, and what it is of a second derivative of 1: the square of a step.
fn second_difference(times: [f64; 3]) -> ([f64; 3], f64) {
    let [before, after] = [times[1] - times[0], times[2] - times[1]].map(|step| step.max(SHORTEST_STEP));
    let longest = before.max(after);
    let [early, late] = [longest / before, longest / after];
    ([early, -early - late, late], 0.5 * (before + after) * longest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::full_body::smooth::largest_acceleration;

    /// The solver's.
    const CLOSE: f64 = 1e-6;

    fn times() -> Vec<f64> {
        (0..30).map(|k| f64::from(k) / 30.0).collect()
    }

    #[test]
    fn a_kink_becomes_a_parabola_as_hard_as_it_may_be() {
        let given: Vec<f64> = (0..30).map(|k| 0.5 + 0.03 * f64::from(k - 15).abs()).collect();
        let free: Vec<bool> = (0..30).map(|k| (5..25).contains(&k)).collect();
        let bounds = Bounds { free: &free, least: &[0.0; 30], most: 20.0 };
        let found = nearest(&times(), &given, &bounds).expect("it is solved");
        assert!((largest_acceleration(&times(), &found) - 20.0).abs() < 1e-2);
        for at in (0..30).filter(|&at| !free[at]) {
            assert_eq!(found[at], given[at]);
        }
    }

    #[test]
    fn what_is_soft_stays_and_what_is_low_is_held_up() {
        let given: Vec<f64> = times().iter().map(|time| 0.5 + 0.3 * time).collect();
        let bounds = Bounds { free: &[true; 30], least: &[0.0; 30], most: 1.0 };
        let found = nearest(&times(), &given, &bounds).expect("it is solved");
        assert!(found.iter().zip(&given).all(|(found, given)| (found - given).abs() < CLOSE));
        let bounds = Bounds { least: &[0.7; 30], most: 100.0, ..bounds };
        let found = nearest(&times(), &given, &bounds).expect("it is solved");
        assert!(found.iter().all(|angle| *angle > 0.7 - CLOSE));
    }
}
