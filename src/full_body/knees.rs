//! Knees of swinging legs that do not pop.
//!
//! The foot of a swinging leg is free, its knee angle is seen: near full extension a centimetre at the foot is many degrees
//! at the knee. Where a displaced foot would jerk the knee harder than the capture ever does, the *change* of the knee's
//! angle is rounded off, as little as it takes; the foot then passes a little higher or lower.

use crate::clip::contacts::runs;
use crate::full_body::knee_program::{Bounds, nearest};
use crate::full_body::smooth::{largest_acceleration, relax};

/// A knee may be jerked this many times as hard as the capture does at most.
const HARDEST: f64 = 1.35;

/// Widths of the rounding that are tried, seconds, the least first; where none will do, a quadratic program finds the nearest
/// angles that do, or those that are above [`HARDEST`] by the least.
const WIDTHS: [f64; 6] = [1.0 / 30.0, 1.5 / 30.0, 2.0 / 30.0, 2.5 / 30.0, 3.0 / 30.0, 4.0 / 30.0];

/// Samples beside a swing that its rounding has to meet: a second difference reaches two.
const MARGIN: usize = 2;

/// Rounds at which a foot that came too low is held up.
const ROUNDS: usize = 4;

/// Rounds off `changes` of a joint's angle, radians, while the leg is `free`, so that `captured + changes` accelerates
/// hardly more than 1.35 times as hard as `captured` does; no change is below `least`, with which the foot touches
/// the ground. Cost: linear; a program of a swing takes a few dozen factorisations of its band.
pub fn soften(times: &[f64], captured: &[f64], (free, least): (&[bool], &[f64]), changes: &mut [f64]) {
    let most = HARDEST * largest_acceleration(times, captured);
    for (first, last) in runs(free) {
        let range = first.saturating_sub(MARGIN)..(last + MARGIN + 1).min(times.len());
        let swing = Swing {
            times: &times[range.clone()],
            captured: &captured[range.clone()],
            free: &free[range.clone()],
            least: &least[range.clone()],
        };
        let given = changes[range.clone()].to_vec();
        if swing.acceleration(&given) <= most {
            continue;
        }
        let rounded = WIDTHS.iter().map(|width| swing.rounded(&given, *width));
        let soft = rounded.into_iter().find(|rounded| swing.acceleration(rounded) <= most);
        changes[range].copy_from_slice(&soft.unwrap_or_else(|| swing.nearest(&given, most)));
    }
}

/// One swing of a leg with the samples beside it.
struct Swing<'a> {
    times: &'a [f64],
    captured: &'a [f64],
    free: &'a [bool],
    least: &'a [f64],
}

impl Swing<'_> {
    fn acceleration(&self, changes: &[f64]) -> f64 {
        let angles: Vec<f64> = changes.iter().zip(self.captured).map(|(a, b)| a + b).collect();
        largest_acceleration(self.times, &angles)
    }

    /// The changes nearest to `given` with which the joint accelerates by at most `most`, or beyond it by the least.
    fn nearest(&self, given: &[f64], most: f64) -> Vec<f64> {
        let angles = |changes: &[f64]| -> Vec<f64> {
            changes.iter().zip(self.captured).map(|(change, captured)| change + captured).collect()
        };
        let bounds = Bounds { free: self.free, least: &angles(self.least), most };
        match nearest(self.times, &angles(given), &bounds) {
            Ok(found) => {
                let change = |(at, angle): (usize, f64)| {
                    if self.free[at] { angle - self.captured[at] } else { given[at] }
                };
                found.into_iter().enumerate().map(change).collect()
            }
            Err(_) => self.rounded(given, WIDTHS[WIDTHS.len() - 1]),
        }
    }

    /// `given`, rounded off over `width` seconds; where that falls below the least, it is held there.
    fn rounded(&self, given: &[f64], width: f64) -> Vec<f64> {
        let (mut given, mut free) = (given.to_vec(), self.free.to_vec());
        let mut rounded = relax(self.times, &given, &free, width);
        for _ in 0..ROUNDS {
            let mut is_low = false;
            for at in 0..given.len() {
                if free[at] && rounded[at] < self.least[at] {
                    (given[at], free[at], is_low) = (self.least[at], false, true);
                }
            }
            if !is_low {
                return rounded;
            }
            rounded = relax(self.times, &given, &free, width);
        }
        for (at, value) in rounded.iter_mut().enumerate().filter(|(at, _)| self.free[*at]) {
            *value = value.max(self.least[at]);
        }
        rounded
    }
}
