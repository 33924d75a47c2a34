//! Where the angular momentum of a flight, as it came, breaks: nothing in the air changes it, so that a limb was captured wrong there, or
//! labels take for a flight what is none.

use glam::{DQuat, DVec3};

use crate::index::floor_index;
use crate::physics::body_model::BodyModel;
use crate::physics::flight::momentum::{Pair, pairs};
use crate::physics::posed::PosedClip;

/// Where momentum breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentumBreak {
    /// Frame at which it changes most.
    pub frame: usize,
    /// From its mean just before to its mean just after that frame, kg m²/s.
    pub change: f64,
}

/// What just before and just after mean, seconds.
const BESIDE: f64 = 1.0 / 30.0;
/// Momentum of sound captured jumps is off its mean by so much of 75 kg, kg m²/s, root mean square, as a prototype measured it.
/// Slow drifts may be larger; neighbouring means know nothing of them.
const SCATTER: f64 = 1.7;
/// What such scatter makes of differences, no more than three times of it (99.7 % of what is normally distributed), is no break.
const BREAK: f64 = 3.0 * std::f64::consts::SQRT_2 * SCATTER;

/// The greatest change of momentum within the frames `first` to `last`, both means within them, where it is more than captured flights
/// scatter; `None` where it is less, and in flights of less than a fifteenth of a second. Cost: linear in frames times links.
pub fn momentum_break(
    body: &BodyModel,
    posed: &PosedClip,
    (first, last): (usize, usize),
) -> Option<MomentumBreak> {
    let momentum = |pair: &Pair| pair.momentum([DQuat::IDENTITY; 2]).value;
    let course: Vec<DVec3> = pairs(body, posed, (first, last), None).iter().map(momentum).collect();
    let found = greatest_change(&course, floor_index((BESIDE * posed.fps).round()).max(1))?;
    (found.change > BREAK * body.mass / 75.0).then_some(MomentumBreak { frame: first + found.frame, ..found })
}

/// Of means of `count` values; pair `k` ends at frame `k + 1` of those counted here from 0.
fn greatest_change(course: &[DVec3], count: usize) -> Option<MomentumBreak> {
    let mean = |values: &[DVec3]| values.iter().sum::<DVec3>() / count as f64;
    let change = |(index, values): (usize, &[DVec3])| MomentumBreak {
        frame: index + count,
        change: mean(&values[..count]).distance(mean(&values[count..])),
    };
    course.windows(2 * count).enumerate().map(change).max_by(|a, b| a.change.total_cmp(&b.change))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_found_at_its_frame_and_noise_is_less() {
        let noise = |k: usize| if k.is_multiple_of(2) { 0.5 } else { -0.5 };
        let course: Vec<DVec3> =
            (0..40).map(|k| DVec3::new(noise(k), 0.0, if k < 21 { 8.0 } else { 0.0 })).collect();
        let found = greatest_change(&course, 4).expect("long enough");
        assert_eq!(found.frame, 21);
        assert!((found.change - 8.0).abs() < 1e-12);
        let still = greatest_change(&course[..20], 4).expect("long enough");
        assert!(still.change < 1e-12);
        assert!(greatest_change(&course[..7], 4).is_none());
    }
}
