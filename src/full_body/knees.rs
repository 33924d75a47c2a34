//! Knees of swinging legs that do not pop.
//!
//! The foot of a swinging leg is free, its knee angle is seen: near full extension a centimetre at the foot is many degrees
//! at the knee. Where a displaced foot would jerk the knee harder than the capture ever does, the *change* of the knee's
//! angle is rounded off, as little as it takes; the foot then passes a little higher or lower.

use crate::clip::contacts::runs;
use crate::full_body::smooth::{largest_acceleration, relax};

/// A knee may be jerked this many times as hard as the capture does at most.
const HARDEST: f64 = 1.35;

/// Widths of the rounding that are tried, seconds, the least first; with the last one some knees may stay above
/// [`HARDEST`].
const WIDTHS: [f64; 6] = [1.0 / 30.0, 1.5 / 30.0, 2.0 / 30.0, 2.5 / 30.0, 3.0 / 30.0, 4.0 / 30.0];

/// Samples beside a swing that its rounding has to meet: a second difference reaches two.
const MARGIN: usize = 2;

/// Rounds off `changes` of a joint's angle, radians, while the leg is `free`, so that `captured + changes` accelerates
/// hardly more than [`HARDEST`] times `captured`'s own `largest` acceleration. Cost: linear.
pub fn soften(times: &[f64], captured: &[f64], free: &[bool], largest: f64, changes: &mut [f64]) {
    for (first, last) in runs(free) {
        let range = first.saturating_sub(MARGIN)..(last + MARGIN + 1).min(times.len());
        let (times, free) = (&times[range.clone()], &free[range.clone()]);
        let given = changes[range.clone()].to_vec();
        let is_soft = |changes: &[f64]| {
            let angles: Vec<f64> = changes.iter().zip(&captured[range.clone()]).map(|(a, b)| a + b).collect();
            largest_acceleration(times, &angles) <= HARDEST * largest
        };
        if is_soft(&given) {
            continue;
        }
        for width in WIDTHS {
            let rounded = relax(times, &given, free, width);
            changes[range.clone()].copy_from_slice(&rounded);
            if is_soft(&rounded) {
                break;
            }
        }
    }
}
