//! Steps of two feet in turn, each a way of its own or about the body: when each lifts and lands, and how the body goes along.
//!
//! Time is in cycles after the leading foot was about to lift; the other one follows half a cycle later.

use crate::geometry::smoothstep;

/// Cycles of the body's setting off before its feet's, and after; the same to halt.
pub(super) const SETTING_OFF: f64 = 0.5;
/// When a foot lifts and lands.
const LIFT: f64 = 0.06;
const LAND: f64 = 0.44;

/// From when to when.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rhythm {
    /// Whether it sets off from a stand, at time 0.
    pub(super) starts: bool,
    /// Time at which it stands again.
    pub(super) stop: Option<f64>,
}

impl Rhythm {
    /// Time of the body: even, but for setting off and halting.
    pub(super) fn progress(&self, cycles: f64) -> f64 {
        // Even speed is reached at the same time as by a jump to it half way.
        let eased = |since: f64| {
            let u = ((since + SETTING_OFF) / (2.0 * SETTING_OFF)).clamp(0.0, 1.0);
            SETTING_OFF * u * u + (since - SETTING_OFF).max(0.0)
        };
        match self.stop {
            Some(stop) if cycles > 0.5 * stop => stop - eased(stop - cycles),
            _ if self.starts => eased(cycles),
            _ => cycles,
        }
    }

    /// Share of stepping against standing.
    pub(super) fn pace(&self, cycles: f64) -> f64 {
        let eased = |since: f64| smoothstep((since + SETTING_OFF) / (2.0 * SETTING_OFF));
        let begun = if self.starts { eased(cycles) } else { 1.0 };
        begun * self.stop.map_or(1.0, |stop| eased(stop - cycles))
    }

    /// Steps that a foot has gone, and how high it is lifted, from 0 to 1.
    pub(super) fn step(&self, leading: bool, cycles: f64) -> (f64, f64) {
        let delay = if leading { 0.0 } else { 0.5 };
        let since = match self.stop {
            Some(stop) => cycles.min(stop),
            None => cycles,
        };
        let since = if self.starts { since.max(0.0) } else { since } - delay;
        let u = ((since - since.floor() - LIFT) / (LAND - LIFT)).clamp(0.0, 1.0);
        // Where the other foot begins, half a cycle is not yet gone; where it ends, it has closed.
        let gone = since.floor() + smoothstep(u);
        let gone = if self.starts { gone.max(0.0) } else { gone };
        (gone, 16.0 * (u * (1.0 - u)).powi(2))
    }
}
