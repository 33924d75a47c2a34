//! How far and how fast a body is pulled by what its hands must reach.
//!
//! Where feet bear, legs say how far. In the air nothing does: what flies goes on as it took off, so that a pull goes over from
//! take-off to landing in a straight line. Where a pull would be faster than people move, less of it is done, smoothly.

use glam::DVec3;

use crate::full_body::feet::FADE;
use crate::full_body::pins::spans;
use crate::full_body::smooth::envelope;

/// Farther than this from the line between take-off and landing nobody is pulled in the air, metres.
pub const AIR: f64 = 0.05;

/// Who never bears on anything is pulled no farther, metres.
pub const FREE: f64 = 0.5;

/// Nobody is pulled farther, metres: as far as the widest lunge.
pub const FARTHEST: f64 = 0.8;

/// Faster than this no pull comes and goes by itself, m/s: lunges for what is in reach take 2 m/s.
pub const FASTEST: f64 = 3.0;

/// Seconds in which less of a pull is done before and after it would be too fast.
const WINDOW: f64 = 3.0 * FADE;

/// Samples nearer than this in time count as so far apart, seconds.
const SHORTEST_STEP: f64 = 1e-3;

/// Bounds `pulls` of the body, metres, one a sample; `stands`: whether anything bears. Says whether any is changed. Cost: linear.
pub fn bound(times: &[f64], stands: &[bool], pulls: &mut [DVec3]) -> bool {
    let before = pulls.to_vec();
    fly(times, stands, pulls);
    for pull in pulls.iter_mut() {
        *pull = pull.clamp_length_max(FARTHEST);
    }
    slow(times, pulls);
    before != pulls
}

/// Pulls in the air go straight from take-off to landing, or nearly.
fn fly(times: &[f64], stands: &[bool], pulls: &mut [DVec3]) {
    let flies: Vec<bool> = stands.iter().map(|stands| !stands).collect();
    for span in spans(&flies) {
        let before = span.first.checked_sub(1).map(|at| (times[at], pulls[at]));
        let after = pulls.get(span.last + 1).map(|pull| (times[span.last + 1], *pull));
        for at in span.first..=span.last {
            let (line, most) = match (before, after) {
                (Some((from, start)), Some((to, end))) => {
                    (start.lerp(end, (times[at] - from) / (to - from).max(f64::MIN_POSITIVE)), AIR)
                }
                (Some((_, pull)), None) | (None, Some((_, pull))) => (pull, AIR),
                (None, None) => (DVec3::ZERO, FREE),
            };
            let off = pulls[at] - line;
            if off.length() > most {
                pulls[at] = line + off.clamp_length_max(most);
            }
        }
    }
}

/// Less of `pulls` where they are too fast.
fn slow(times: &[f64], pulls: &mut [DVec3]) {
    let mut too_much = vec![0.0_f64; pulls.len()];
    for at in 1..pulls.len() {
        let most = FASTEST * (times[at] - times[at - 1]).max(SHORTEST_STEP);
        let step = pulls[at].distance(pulls[at - 1]);
        if step > most {
            let share = 1.0 - most / step;
            too_much[at - 1] = too_much[at - 1].max(share);
            too_much[at] = too_much[at].max(share);
        }
    }
    for (pull, less) in pulls.iter_mut().zip(envelope(times, &too_much, WINDOW)) {
        if less > 0.0 {
            *pull *= (1.0 - less).max(0.0);
        }
    }
}
