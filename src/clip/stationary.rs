//! Stretches in which a body stays where it is: standing, sitting, turning on the spot.
//!
//! Source: Kim et al. 2009, §4.1, for the idea; the thresholds were measured on captures.

use crate::clip::contacts::{Contacts, drop_short, fill_gaps, runs};
use crate::clip::working::WORKING_STEP;
use crate::geometry::c64;

/// What counts as staying.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StationarySettings {
    /// Mean speed below which a body stays, m/s.
    pub speed: f64,
    /// Frames on each side of a frame over which the speed is averaged: 7 make about half a second.
    pub half_window: usize,
    /// Shorter stretches are dropped, frames.
    pub shortest: usize,
    /// With both feet in contact throughout, a body stays below this mean speed, m/s …
    pub both_feet_speed: f64,
    /// … if the stretch is at least so long, frames (0.7 s).
    pub both_feet_shortest: usize,
    /// Stretches with fewer frames between them are one.
    pub merged_below: usize,
}

impl Default for StationarySettings {
    fn default() -> Self {
        Self {
            speed: 0.15,
            half_window: 7,
            shortest: 5,
            both_feet_speed: 0.25,
            both_feet_shortest: 21,
            merged_below: 3,
        }
    }
}

/// Working frames of stationary stretches. `positions`: root on the plan at each working frame, metres; `contacts`: as many.
pub fn stationary(positions: &[c64], contacts: &[Contacts], settings: &StationarySettings) -> Vec<bool> {
    let last = positions.len().saturating_sub(1);
    let mut lengths = vec![0.0];
    for pair in positions.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
    }
    // A range of one frame has no speed; it is in motion unless its neighbours say otherwise.
    let mean_speed = |first: usize, last: usize| match last - first {
        0 => f64::INFINITY,
        steps => (lengths[last] - lengths[first]) / (steps as f64 * WORKING_STEP),
    };
    let mut stays: Vec<bool> = (0..positions.len())
        .map(|index| {
            let first = index.saturating_sub(settings.half_window);
            mean_speed(first, (index + settings.half_window).min(last)) < settings.speed
        })
        .collect();
    drop_short(&mut stays, settings.shortest);
    let both: Vec<bool> = contacts.iter().map(|contact| contact.both_feet()).collect();
    for (first, last) in runs(&both) {
        let is_long = last + 1 - first >= settings.both_feet_shortest;
        if is_long && mean_speed(first, last) < settings.both_feet_speed {
            stays[first..=last].fill(true);
        }
    }
    fill_gaps(&mut stays, settings.merged_below.saturating_sub(1));
    stays
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames at 0, then a walk at `speed` m/s.
    fn stop_then_walk(stop: usize, walk: usize, speed: f64) -> Vec<c64> {
        (0..stop + walk)
            .map(|index| c64::new(index.saturating_sub(stop) as f64 * speed * WORKING_STEP, 0.0))
            .collect()
    }

    #[test]
    fn standing_is_stationary_and_walking_is_not() {
        let positions = stop_then_walk(40, 40, 1.0);
        let contacts = vec![Contacts::default(); 80];
        let stays = stationary(&positions, &contacts, &StationarySettings::default());
        let found = runs(&stays);
        assert_eq!(found.len(), 1);
        assert!(found[0].0 == 0 && (34..=40).contains(&found[0].1), "{found:?}");
    }

    #[test]
    fn both_feet_down_is_not_enough_when_short_or_fast() {
        let planted = Contacts {
            left_heel: true,
            left_toe: true,
            right_heel: true,
            right_toe: true,
            ..Contacts::default()
        };
        for (frames, speed, expected) in [(30, 0.2, true), (30, 0.3, false), (20, 0.2, false)] {
            let positions = stop_then_walk(0, frames, speed);
            let stays = stationary(&positions, &vec![planted; frames], &StationarySettings::default());
            assert_eq!(stays.iter().all(|stay| *stay), expected, "{frames} frames at {speed} m/s");
        }
    }
}
