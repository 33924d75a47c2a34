//! The generated clips of a relay: how a scene declares them, how long they take and how far they go.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

use crate::clip::builtin::{FPS, generate};
use crate::clip::working::WorkingClip;
use crate::geometry::{c64, cis};
use crate::index::SourceFrame;

/// Between the palms that carry, metres: room for the hands of two on the box, one before the other's.
pub const WIDTH: f64 = 0.3;

/// Stature for which the numbers below hold, metres.
pub const STATURE: f64 = 1.75;

/// Palms ahead of the body at a hand-over, at [`STATURE`], metres.
pub const REACH: f64 = 0.59;

/// Palms ahead of the body when a box is picked up or put down, at [`STATURE`], metres.
pub const GRASP: f64 = 0.58;

/// Between the palms of two who hold one box, metres.
pub const PALMS_APART: f64 = 0.24;

/// A clip of the relay.
#[derive(Clone, Debug)]
pub struct Act {
    /// Name in the scene.
    pub name: String,
    /// As the scene declares it.
    pub declaration: String,
    /// The motion.
    pub clip: WorkingClip,
}

/// Where somebody is and looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// On the plan, metres.
    pub position: c64,
    /// Radians.
    pub facing: f64,
}

/// The generated clip `builtin` under the name `name`; `events`: named frames besides its own.
pub fn act(name: &str, builtin: &str, parameters: &[(&str, f64)], events: &[(&str, usize)]) -> Act {
    let values: BTreeMap<String, f64> =
        parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let clip =
        generate(builtin, &values).expect("the relay asks for clips that there are, within their ranges");
    let last = SourceFrame::from_usize(clip.frame_count() - 1);
    let clip = WorkingClip::new(name, Arc::new(clip), SourceFrame(0), last);
    let mut declaration = format!("{{ builtin = \"{builtin}\"");
    parameters.iter().for_each(|(name, value)| declaration += &format!(", {name} = {value}"));
    if !events.is_empty() {
        let events: Vec<String> = events.iter().map(|(name, frame)| format!("{name} = {frame}")).collect();
        declaration += &format!(", events = {{ {} }}", events.join(", "));
    }
    declaration += " }";
    Act { name: name.to_owned(), declaration, clip }
}

impl Act {
    /// How long it takes.
    pub fn seconds(&self) -> f64 {
        (self.clip.positions.len() - 1) as f64 / FPS
    }

    /// Metres on the ground from the first to the last frame.
    pub fn distance(&self) -> f64 {
        (self.clip.positions[self.clip.positions.len() - 1] - self.clip.positions[0]).norm()
    }

    /// Number of its last frame.
    pub fn last(&self) -> usize {
        self.clip.positions.len() - 1
    }

    /// Where its first frame is, for frame `frame` to be at `place`.
    pub fn start(&self, frame: usize, place: Place) -> Place {
        let frame = frame.min(self.last());
        let turn = self.clip.headings[frame] - self.clip.headings[0];
        let facing = place.facing - turn;
        let way = self.clip.positions[frame] - self.clip.positions[0];
        Place { position: place.position - way * cis(facing - self.clip.headings[0]), facing }
    }
}

/// Walking with the box for `distance` metres; its middle frame is called "halfway".
pub fn carry(distance: f64) -> Act {
    let fixed = [("take", 0.0), ("give", 0.0), ("width", WIDTH)];
    let parameters = nearest("carry", &[1.3, 1.2, 1.1, 1.0, 0.9], &fixed, distance);
    let halfway = act("carry", "carry", &parameters, &[]).last() / 2;
    act("carry", "carry", &parameters, &[("halfway", halfway)])
}

/// Walking without it for `distance` metres.
pub fn walk(distance: f64) -> Act {
    let parameters = nearest("walk", &[1.2, 1.1, 1.0], &[("start", 1.0), ("stop", 1.0)], distance);
    act("walk back", "walk", &parameters, &[])
}

/// Parameters of the clip `builtin`, `fixed` ones among them, with the speed and the number of steps that come nearest to
/// `distance` metres.
fn nearest(
    builtin: &str,
    speeds: &[f64],
    fixed: &[(&'static str, f64)],
    distance: f64,
) -> Vec<(&'static str, f64)> {
    let mut best: Option<(f64, Vec<(&'static str, f64)>)> = None;
    for speed in speeds {
        // Setting off and halting take about a second more.
        let about = (distance / speed + 1.0).round();
        for seconds in [about - 1.0, about, about + 1.0, about + 2.0].map(|seconds| seconds.max(2.0)) {
            let mut parameters = vec![("speed", *speed), ("seconds", seconds)];
            parameters.extend_from_slice(fixed);
            let off = (act("", builtin, &parameters, &[]).distance() - distance).abs();
            // A hair of preference for what comes first keeps the choice from hanging on rounding.
            if best.as_ref().is_none_or(|(known, _)| off < known - 0.01) {
                best = Some((off, parameters));
            }
        }
    }
    best.map(|(_, parameters)| parameters).unwrap_or_default()
}

/// A turn by the nearest of the angles that clips are made for, degrees; never none at all.
pub fn nearest_turn(radians: f64) -> i32 {
    /// Fine enough for an edit to take up the rest, coarse enough for a dozen clips.
    const STEP: f64 = 30.0;
    let wrapped = radians - TAU * (radians / TAU).round();
    let steps = (wrapped.to_degrees() / STEP).round();
    let steps = (1..=6).rev().find(|step| f64::from(*step) <= steps.abs()).unwrap_or(1);
    if wrapped < 0.0 { -30 * steps } else { 30 * steps }
}

/// Turning on the spot by `degrees`, with the box or without.
pub fn turn(degrees: i32, with_box: bool) -> Act {
    let (name, angle) = (turn_name(degrees, with_box), f64::from(degrees));
    if with_box {
        act(&name, "carry_turn", &[("angle", angle), ("width", WIDTH)], &[])
    } else {
        act(&name, "turn", &[("angle", angle)], &[])
    }
}

/// Name of [`turn`] in the scene.
pub fn turn_name(degrees: i32, with_box: bool) -> String {
    let how = if with_box { "carry" } else { "turn" };
    let side = if degrees < 0 { "right" } else { "left" };
    format!("{how} {side} {}", degrees.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relay::SPACINGS;

    #[test]
    fn ways_are_walked_with_hardly_any_deformation() {
        for spacing in [SPACINGS.0, 3.5, 5.0, 7.7, 20.0, SPACINGS.1] {
            let distance = spacing - 2.0 * REACH - PALMS_APART;
            let carried = carry(distance);
            let off = (carried.distance() - distance).abs();
            // The shortest walk is of 2.05 m; else speeds and steps come within a quarter of a step of 1.3 m.
            assert!(off < 0.35 || distance < 2.05, "{distance} {}", carried.distance());
        }
    }

    #[test]
    fn turns_are_to_the_nearest_of_thirty_degrees() {
        let nearest = [10.0, -10.0, 50.0, 178.0, -178.0, 190.0, -350.0]
            .map(|degrees: f64| nearest_turn(degrees.to_radians()));
        assert_eq!(nearest, [30, -30, 60, 180, -180, -180, 30]);
    }

    #[test]
    fn starting_places_lead_where_they_should() {
        let turn = turn(90, true);
        let last = turn.last();
        let place = Place { position: c64::new(3.0, 1.0), facing: 0.4 };
        let start = turn.start(last, place);
        assert!((start.facing - (0.4 - (turn.clip.headings[last] - turn.clip.headings[0]))).abs() < 1e-12);
        let clip = &turn.clip;
        let there = start.position
            + (clip.positions[last] - clip.positions[0]) * cis(start.facing - clip.headings[0]);
        assert!((there - place.position).norm() < 1e-12);
    }
}
