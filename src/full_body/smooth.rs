//! Curves along time made smooth: averages, and the smooth curve above a rough one.

use std::collections::VecDeque;

/// A smooth curve on or above `values` ≥ 0: the largest value within `window` seconds, averaged over as many with weights
/// `(1 − u²)³`. Exactly 0 where all values within two windows are. Cost: linear in samples times samples in a window.
pub fn envelope(times: &[f64], values: &[f64], window: f64) -> Vec<f64> {
    if values.iter().all(|value| *value == 0.0) {
        return vec![0.0; values.len()];
    }
    average(times, &widened(times, values, window), window)
}

/// The largest of `values` within `window` seconds of each sample.
fn widened(times: &[f64], values: &[f64], window: f64) -> Vec<f64> {
    // Candidates from the largest down, each later than the one before.
    let mut candidates: VecDeque<usize> = VecDeque::new();
    let mut next = 0;
    let mut largest = Vec::with_capacity(values.len());
    for &time in times {
        while next < times.len() && times[next] <= time + window {
            while candidates.back().is_some_and(|&at| values[at] <= values[next]) {
                candidates.pop_back();
            }
            candidates.push_back(next);
            next += 1;
        }
        while candidates.front().is_some_and(|&at| times[at] < time - window) {
            candidates.pop_front();
        }
        largest.push(candidates.front().map_or(0.0, |&at| values[at]));
    }
    largest
}

/// Averages of `values` over `window` seconds on each side, with weights `(1 − u²)³`, each sample standing for the time
/// around it.
pub fn average(times: &[f64], values: &[f64], window: f64) -> Vec<f64> {
    let last = times.len().saturating_sub(1);
    let stands_for = |at: usize| times[(at + 1).min(last)] - times[at.saturating_sub(1)];
    let mut first = 0;
    let mut averages = Vec::with_capacity(values.len());
    for (own, &time) in times.iter().enumerate() {
        while times[first] <= time - window {
            first += 1;
        }
        let (mut sum, mut weights) = (0.0, 0.0);
        for at in first..times.len() {
            let u = (times[at] - time) / window;
            if u >= 1.0 {
                break;
            }
            let weight = (1.0 - u * u).max(0.0).powi(3) * stands_for(at);
            sum += weight * values[at];
            weights += weight;
        }
        averages.push(if weights > 0.0 { sum / weights } else { values[own] });
    }
    averages
}

/// `values` with their kinks rounded off where `free`; the others stay and are met without a kink: the minimum of
/// `∫ (v − values)² + (τ² v″)²`, by differences. `tau`: seconds; kinks are spread over about twice as many.
///
/// `times` rise. Cost: linear (a system of five diagonals).
pub fn relax(times: &[f64], values: &[f64], free: &[bool], tau: f64) -> Vec<f64> {
    let count = values.len();
    // Rows of the lower triangle: the diagonal, and the entries one and two before it.
    let mut rows = vec![[1.0, 0.0, 0.0]; count];
    let mut right = values.to_vec();
    for at in 1..count.saturating_sub(1) {
        let [before, after] =
            [times[at] - times[at - 1], times[at + 1] - times[at]].map(|step| step.max(SHORTEST_STEP) / tau);
        let mean = 0.5 * (before + after);
        let weights = [1.0 / (before * mean), -(1.0 / before + 1.0 / after) / mean, 1.0 / (after * mean)];
        for (row, weight) in weights.iter().enumerate() {
            for column in 0..=row {
                rows[at - 1 + row][row - column] += weight * weights[column];
            }
        }
    }
    for at in 0..count {
        for back in 1..=2.min(at) {
            let entry = rows[at][back];
            match (free[at - back], free[at]) {
                (true, false) => right[at - back] -= entry * values[at],
                (false, true) => right[at] -= entry * values[at - back],
                _ => {}
            }
            if !(free[at] && free[at - back]) {
                rows[at][back] = 0.0;
            }
        }
        if !free[at] {
            rows[at][0] = 1.0;
            right[at] = values[at];
        }
    }
    substitute(&mut rows, right)
}

/// Solves a symmetric positive definite system of five diagonals: `L D Lᵀ` in place, then both substitutions.
fn substitute(rows: &mut [[f64; 3]], mut right: Vec<f64>) -> Vec<f64> {
    let count = rows.len();
    for at in 0..count {
        if at >= 2 {
            let far = rows[at][2];
            rows[at][1] -= far * rows[at - 1][1];
            rows[at][2] = far / rows[at - 2][0];
            rows[at][0] -= far * rows[at][2];
        }
        if at >= 1 {
            let near = rows[at][1];
            rows[at][1] = near / rows[at - 1][0];
            rows[at][0] -= near * rows[at][1];
        }
        for back in 1..=2.min(at) {
            right[at] -= rows[at][back] * right[at - back];
        }
    }
    for at in (0..count).rev() {
        right[at] /= rows[at][0];
        for forward in 1..=2 {
            if at + forward < count {
                right[at] -= rows[at + forward][forward] * right[at + forward];
            }
        }
    }
    right
}

/// Largest second derivative of `values` along `times`, by differences.
pub fn largest_acceleration(times: &[f64], values: &[f64]) -> f64 {
    let steps = times.windows(3).zip(values.windows(3));
    steps
        .map(|(times, values)| {
            let [before, after] =
                [times[1] - times[0], times[2] - times[1]].map(|step| step.max(SHORTEST_STEP));
            let turn = (values[2] - values[1]) / after - (values[1] - values[0]) / before;
            (2.0 * turn / (before + after)).abs()
        })
        .fold(0.0, f64::max)
}

/// Magnitudes of the second derivatives of `values` at each sample, by differences to what they are `step` seconds before and
/// after, interpolated; 0 nearer to the ends. Cost: linear.
pub fn accelerations_over(times: &[f64], values: &[f64], step: f64) -> Vec<f64> {
    let mut at = [0; 2];
    let mut value = |side: usize, time: f64| {
        let from = &mut at[side];
        while *from + 2 < times.len() && times[*from + 1] < time {
            *from += 1;
        }
        let (start, end) = (times[*from], times[*from + 1]);
        let share = (time - start) / (end - start).max(f64::MIN_POSITIVE);
        values[*from] + (values[*from + 1] - values[*from]) * share.clamp(0.0, 1.0)
    };
    let Some((first, last)) = times.first().zip(times.last()) else { return Vec::new() };
    let bounds = first + step - ROUNDING..=last - step + ROUNDING;
    let acceleration = |(time, own): (&f64, &f64)| {
        if !bounds.contains(time) {
            return 0.0;
        }
        let [before, after] = [value(0, time - step), value(1, time + step)];
        ((after - 2.0 * own + before) / (step * step)).abs()
    };
    times.iter().zip(values).map(acceleration).collect()
}

/// Rounding of times, seconds.
const ROUNDING: f64 = 1e-9;

/// Samples nearer than this in time count as so far apart, seconds: a constrained moment beside an output frame.
pub const SHORTEST_STEP: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Uneven times, 0.02 to 0.06 s apart.
    fn uneven(count: usize) -> Vec<f64> {
        (0..count).map(|k| 0.04 * k as f64 + 0.01 * (1.7 * k as f64).sin()).collect()
    }

    /// What [`relax`] makes least.
    fn energy(times: &[f64], values: &[f64], given: &[f64], tau: f64) -> f64 {
        let data: f64 = values.iter().zip(given).map(|(a, b)| (a - b) * (a - b)).sum();
        let bends = (1..values.len() - 1).map(|at| {
            let [before, after] = [times[at] - times[at - 1], times[at + 1] - times[at]];
            let slopes = (values[at + 1] - values[at]) / after - (values[at] - values[at - 1]) / before;
            (tau * tau * 2.0 * slopes / (before + after)).powi(2)
        });
        data + bends.sum::<f64>()
    }

    #[test]
    fn accelerations_do_not_depend_on_how_often_a_curve_is_sampled() {
        for count in [31, 121, 481] {
            let times: Vec<f64> = (0..count).map(|k| f64::from(k) / f64::from(count - 1)).collect();
            let values: Vec<f64> = times.iter().map(|time| 3.0 * time * time).collect();
            let found = accelerations_over(&times, &values, 1.0 / 30.0);
            assert!(found.iter().all(|value| *value == 0.0 || (value - 6.0).abs() < 1e-9), "{found:?}");
            assert!(found.iter().filter(|value| **value == 0.0).count() <= (count as usize - 1) / 15 + 2);
        }
        assert_eq!(accelerations_over(&[0.0], &[1.0], 1.0 / 30.0), [0.0]);
        assert!(accelerations_over(&[], &[], 1.0 / 30.0).is_empty());
    }

    proptest! {
        #[test]
        fn an_envelope_is_nowhere_below_and_ends_two_windows_away(
            values in prop::collection::vec(prop_oneof![Just(0.0), 0.0..1.0_f64], 1..60),
            window in 0.05..0.5_f64,
        ) {
            let times = uneven(values.len());
            let curve = envelope(&times, &values, window);
            for (at, (curve, value)) in curve.iter().zip(&values).enumerate() {
                prop_assert!(*curve >= value - ROUNDING);
                let near = |other: usize| (times[other] - times[at]).abs() <= 2.0 * window;
                let is_far = (0..values.len()).all(|other| values[other] == 0.0 || !near(other));
                prop_assert!(!is_far || *curve == 0.0);
            }
        }

        #[test]
        fn no_other_curve_is_smoother_and_as_near(
            values in prop::collection::vec(-1.0..1.0_f64, 5..30),
            held in prop::collection::vec(any::<bool>(), 30),
            tau in 0.02..0.3_f64,
            change in prop::collection::vec(-0.1..0.1_f64, 30),
        ) {
            let times = uneven(values.len());
            let free: Vec<bool> = held[..values.len()].iter().map(|held| !held).collect();
            let curve = relax(&times, &values, &free, tau);
            let least = energy(&times, &curve, &values, tau);
            let other: Vec<f64> = (0..values.len())
                .map(|at| if free[at] { curve[at] + change[at] } else { curve[at] })
                .collect();
            prop_assert!(energy(&times, &other, &values, tau) >= least * (1.0 - ROUNDING));
            for at in (0..values.len()).filter(|&at| !free[at]) {
                prop_assert_eq!(curve[at], values[at]);
            }
        }
    }

    #[test]
    fn a_parabola_has_its_acceleration_at_uneven_times() {
        let times = uneven(20);
        let values: Vec<f64> = times.iter().map(|time| 3.0 * time * time).collect();
        assert!((largest_acceleration(&times, &values) - 6.0).abs() < 1e-9);
    }
}
