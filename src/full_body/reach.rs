//! How far the body must come down so that legs reach what they must, smoothly along time.

use crate::full_body::smooth::envelope;
use glam::DVec3;

/// What one leg asks of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// Where its hip is without correction, metres.
    pub hip: DVec3,
    /// Where its ankle is to be.
    pub ankle: DVec3,
    /// How far it may stretch.
    pub reach: f64,
}

/// Legs do not stretch flatter than this: hip over ankle, share of the reach.
const FLATTEST: f64 = 0.5;

impl Demand {
    /// How far the hip must come down, metres; 0 where the leg reaches.
    pub fn drop(&self) -> f64 {
        let to_hip = self.hip - self.ankle;
        if to_hip.length_squared() <= self.reach * self.reach {
            return 0.0;
        }
        let level_sq = to_hip.x * to_hip.x + to_hip.z * to_hip.z;
        let height = (self.reach * self.reach - level_sq).max(0.0).sqrt().max(FLATTEST * self.reach);
        (to_hip.y - height).max(0.0)
    }
}

/// The drop at each sample: smooth along time, at least what each demand asks for, and none farther than `window` seconds
/// from any that asks.
pub fn drops(times: &[f64], demands: &[Vec<Demand>], window: f64) -> Vec<f64> {
    let needed: Vec<f64> = (0..times.len())
        .map(|at| demands.iter().filter_map(|leg| leg.get(at)).map(Demand::drop).fold(0.0, f64::max))
        .collect();
    envelope(times, &needed, window)
}
