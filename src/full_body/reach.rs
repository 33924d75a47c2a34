//! Where the body must go so that limbs reach what they must.
//!
//! Feet: the body comes down, smoothly along time, just as people do who take long strides. Other ends: the nearest place
//! from which all limbs reach, the intersection of balls about their targets.

use glam::DVec3;

use crate::full_body::smooth::envelope;

/// What one limb asks of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// Where its upper joint is without correction, metres.
    pub hip: DVec3,
    /// Where its lower joint is to be.
    pub ankle: DVec3,
    /// How far it may stretch.
    pub reach: f64,
}

/// Legs do not spread flatter than this, height of the hip over the ankle as a share of the reach.
const FLATTEST: f64 = 0.5;

/// Rounding of a reach that is met as captured, relative.
const ROUNDING: f64 = 1e-9;

impl Demand {
    /// How far the body, shifted by `shift`, must come down, metres; 0 where the leg reaches.
    fn drop(&self, shift: DVec3) -> f64 {
        let to_hip = self.hip + shift - self.ankle;
        let reach_sq = self.reach * self.reach * (1.0 + ROUNDING);
        if to_hip.length_squared() <= reach_sq {
            return 0.0;
        }
        let level_sq = to_hip.x * to_hip.x + to_hip.z * to_hip.z;
        let height = (reach_sq - level_sq).max(0.0).sqrt().max(FLATTEST * self.reach);
        (to_hip.y - height).max(0.0)
    }

    /// What is missing from `shift` until the limb reaches; the shortest way.
    fn missing(&self, shift: DVec3) -> DVec3 {
        let to_target = self.ankle - self.hip - shift;
        let distance = to_target.length();
        if distance <= self.reach * (1.0 + ROUNDING) {
            return DVec3::ZERO;
        }
        to_target * ((distance - self.reach) / distance)
    }
}

/// How far the body must come down at each sample, metres: smooth along time, enough for each of `demands`, and nothing
/// farther than two `window`s (seconds) from any sample that needs it.
///
/// `demands`: for each leg, one a sample. `shifts`: how the body is shifted already.
pub fn drops(times: &[f64], demands: &[Vec<Demand>], shifts: &[DVec3], window: f64) -> Vec<f64> {
    let needed = |at: usize| demands.iter().map(|leg| leg[at].drop(shifts[at])).fold(0.0, f64::max);
    let needed: Vec<f64> = (0..times.len()).map(needed).collect();
    envelope(times, &needed, window)
}

/// Sweeps over the balls.
const SWEEPS: usize = 50;

/// Shift of the body nearest to `shift` from which every limb of `demands` reaches; where no place is, one between.
/// Alternate projections.
pub fn within_reach(demands: &[Demand], shift: DVec3) -> DVec3 {
    let mut shift = shift;
    for _ in 0..SWEEPS {
        let before = shift;
        for demand in demands {
            shift += demand.missing(shift);
        }
        if shift.distance(before) < ROUNDING {
            break;
        }
    }
    shift
}
