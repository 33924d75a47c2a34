//! Masses by conjugate gradients, as published.

use super::MassProblem;

/// Steps at most.
const STEPS: usize = 100;
/// A step is accepted when it brings this share of what the slope promises (Armijo).
const SUFFICIENT: f64 = 1e-4;
/// Halvings of a step before it is given up.
const HALVINGS: usize = 40;

/// Factors of small `½ Σ d² + ½ pull Σ count (x − 1)²`, d the distance of a frame's zero moment point from its polygon, by projected
/// Polak-Ribière conjugate gradients. Factors keep the sum of the masses and are at least `least`. The objective does not rise; it is
/// flat where all points are inside, so that without pull nothing would be decided there.
///
/// Source: Shin, Kovar, Gleicher 2003, section 3.2; Nocedal and Wright, *Numerical Optimization*, 2nd ed., §5.2.
pub fn descend(problem: &MassProblem, pull: f64, least: f64) -> Vec<f64> {
    let mut factors = vec![1.0; problem.masses.len()];
    let (mut value, mut slope) = objective(problem, pull, &factors);
    let mut direction: Vec<f64> = slope.iter().map(|own| -own).collect();
    let mut length = 1.0;
    for _ in 0..STEPS {
        let mut promised = dot(&slope, &direction);
        if promised >= 0.0 {
            direction = slope.iter().map(|own| -own).collect();
            promised = -dot(&slope, &slope);
        }
        if promised > -1e-18 {
            break;
        }
        let Some(next) =
            line_search(problem, (pull, least), (&factors, &direction), (value, promised, &mut length))
        else {
            break;
        };
        let (next_value, next_slope) = objective(problem, pull, &next);
        let change: Vec<f64> = next_slope.iter().zip(&slope).map(|(new, old)| new - old).collect();
        let mix = (dot(&next_slope, &change) / dot(&slope, &slope)).max(0.0);
        for (own, new) in direction.iter_mut().zip(&next_slope) {
            *own = mix * *own - new;
        }
        (factors, value, slope) = (next, next_value, next_slope);
    }
    factors
}

/// The first of ever shorter steps that lowers the objective enough; `length` remembers what was long enough.
fn line_search(
    problem: &MassProblem,
    (pull, least): (f64, f64),
    (factors, direction): (&[f64], &[f64]),
    (value, promised, length): (f64, f64, &mut f64),
) -> Option<Vec<f64>> {
    for _ in 0..HALVINGS {
        let moved = factors.iter().zip(direction).map(|(factor, step)| factor + *length * step);
        let tried = projected(problem, moved.collect(), least);
        if objective(problem, pull, &tried).0 <= value + SUFFICIENT * *length * promised {
            *length *= 4.0;
            return Some(tried);
        }
        *length *= 0.5;
    }
    None
}

/// Clamped, then scaled to the sum of the masses, until both hold.
fn projected(problem: &MassProblem, mut factors: Vec<f64>, least: f64) -> Vec<f64> {
    let total: f64 = problem.masses.iter().sum();
    for _ in 0..20 {
        factors.iter_mut().for_each(|factor| *factor = factor.max(least));
        let scale = total / dot(&problem.masses, &factors);
        factors.iter_mut().for_each(|factor| *factor *= scale);
    }
    factors
}

/// Value, and its slope along directions that keep the sum of the masses.
fn objective(problem: &MassProblem, pull: f64, factors: &[f64]) -> (f64, Vec<f64>) {
    let (mut value, mut slope) = (0.0, vec![0.0; factors.len()]);
    for ((factor, count), own) in factors.iter().zip(&problem.counts).zip(&mut slope) {
        value += 0.5 * pull * count * (factor - 1.0).powi(2);
        *own += pull * count * (factor - 1.0);
    }
    for frame in &problem.frames {
        let (target, distance) = frame.target(factors);
        if distance > 0.0 {
            value += 0.5 * distance * distance;
            let zmp = frame.zmp(factors);
            let force: f64 = frame.groups.iter().zip(factors).map(|(own, factor)| factor * own[2]).sum();
            for ([x, z, own_force], own) in frame.groups.iter().zip(&mut slope) {
                let by_factor = [(x - zmp.x * own_force) / force, (z - zmp.y * own_force) / force];
                *own += (zmp.x - target.x) * by_factor[0] + (zmp.y - target.y) * by_factor[1];
            }
        }
    }
    let along = dot(&slope, &problem.masses) / dot(&problem.masses, &problem.masses);
    for (own, mass) in slope.iter_mut().zip(&problem.masses) {
        *own -= along * mass;
    }
    (value, slope)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
