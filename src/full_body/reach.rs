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
    /// How far it folds: nearer the lower joint does not come. Below `reach`.
    pub fold: f64,
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
        let wanted = distance.min(self.reach).max(self.fold);
        if (distance - wanted).abs() <= self.reach * ROUNDING || distance == 0.0 {
            return DVec3::ZERO;
        }
        to_target * ((distance - wanted) / distance)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Alternate projections stop when they move less than 1e-9 m a sweep.
    const CONVERGED: f64 = 1e-6;

    fn demand(hip: DVec3, ankle: DVec3, reach: f64) -> Demand {
        Demand { hip, ankle, reach, fold: 0.0 }
    }

    #[test]
    fn a_body_comes_down_as_far_as_the_longest_stride_needs() {
        let times: Vec<f64> = (0..60).map(|k| f64::from(k) / 30.0).collect();
        let mut leg = vec![demand(DVec3::Y * 0.9, DVec3::ZERO, 0.95); 60];
        leg[30].ankle = DVec3::X * 0.6;
        let drops = drops(&times, &[leg.clone()], &[DVec3::ZERO; 60], 0.3);
        // At 0.6 m ahead a leg of 0.95 m reaches from √(.95² − .6²) above.
        let needed = 0.9 - (0.95_f64 * 0.95 - 0.6 * 0.6).sqrt();
        assert!(drops[30] > needed - 1e-6, "{} for {needed}", drops[30]);
        assert!(drops.iter().all(|drop| *drop <= needed + 1e-6));
        assert!(drops[..11].iter().chain(&drops[50..]).all(|drop| *drop == 0.0));
        assert_eq!(super::drops(&times, &[leg[..1].repeat(60)], &[DVec3::ZERO; 60], 0.3), vec![0.0; 60]);
    }

    #[test]
    fn a_body_goes_where_all_limbs_reach() {
        let demands = [
            demand(DVec3::new(0.2, 1.4, 0.0), DVec3::new(1.1, 1.5, 0.0), 0.55),
            demand(DVec3::new(0.1, 0.9, 0.0), DVec3::ZERO, 0.95),
            demand(DVec3::new(-0.1, 0.9, 0.0), DVec3::new(-0.1, 0.0, 0.0), 1.0),
        ];
        let shift = within_reach(&demands, DVec3::ZERO);
        for demand in &demands {
            let distance = (demand.hip + shift).distance(demand.ankle);
            assert!(distance < demand.reach + CONVERGED, "{distance} of {}", demand.reach);
        }
        assert_eq!(within_reach(&demands[1..], DVec3::ZERO), DVec3::ZERO);
        // Too near for an arm that folds to 0.12 m: the shoulder gives way, straight back.
        let near = Demand { fold: 0.12, ..demand(DVec3::Y, DVec3::Y + DVec3::X * 0.08, 0.55) };
        assert!((within_reach(&[near], DVec3::ZERO) - DVec3::X * -0.04).length() < CONVERGED);
    }
}
