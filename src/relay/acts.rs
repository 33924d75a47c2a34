//! The generated clips of a relay: how a scene declares them, how long they take and how far they go.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

use crate::clip::builtin::{FPS, generate};
use crate::clip::working::WorkingClip;
use crate::geometry::{c64, cis};
use crate::index::{SourceFrame, floor_index};

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

    /// Where its last frame is, where its first is at `start`.
    pub fn end(&self, start: Place) -> Place {
        let facing = start.facing + self.clip.headings[self.last()] - self.clip.headings[0];
        Place { position: self.at(start, self.last()), facing }
    }

    /// Where the body is at `frame`, where its first is at `start`.
    pub fn at(&self, start: Place, frame: usize) -> c64 {
        let way = self.clip.positions[frame.min(self.last())] - self.clip.positions[0];
        start.position + way * cis(start.facing - self.clip.headings[0])
    }

    /// Frame of an event; 0 where there is none of this name.
    pub fn event(&self, name: &str) -> usize {
        self.clip.clip.events.get(name).map_or(0, |frame| frame.as_usize())
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

/// Walks of one kind, made as they are asked for.
pub struct Walks {
    kind: Kind,
    /// Those tried, by position in [`SPEEDS`] and whole seconds.
    tried: BTreeMap<(usize, u32), Act>,
    /// Those chosen, in the order in which they first were.
    chosen: Vec<Act>,
}

/// What a walk is made of besides its speed and its seconds.
struct Kind {
    name: &'static str,
    builtin: &'static str,
    fixed: Vec<(&'static str, f64)>,
    middle: bool,
}

/// Metres a second, in the order in which they are preferred.
const SPEEDS: [f64; 10] = [1.3, 1.2, 1.1, 1.0, 0.9, 1.4, 0.8, 0.7, 0.6, 0.5];

/// So many of them are at ease.
const AT_EASE: usize = 6;

/// A walk this near to the way asked for, as a share of it, is taken at the first speed that has one; one at ease that is not quite so
/// near before slower ones.
const NEAR: f64 = 0.03;
const TOLERABLE: f64 = 0.06;

impl Walks {
    /// With the box; their middle frames are called "halfway".
    pub fn with_box() -> Self {
        let fixed = vec![("take", 0.0), ("give", 0.0), ("width", WIDTH)];
        Self::of(Kind { name: "carry", builtin: "carry", fixed, middle: true })
    }

    /// Without it.
    pub fn back() -> Self {
        let fixed = vec![("start", 1.0), ("stop", 1.0)];
        Self::of(Kind { name: "walk back", builtin: "walk", fixed, middle: false })
    }

    const fn of(kind: Kind) -> Self {
        Self { kind, tried: BTreeMap::new(), chosen: Vec::new() }
    }

    /// Position among those chosen of a walk of about `distance` metres.
    pub fn nearest(&mut self, distance: f64) -> usize {
        let mut best: Option<(f64, Act)> = None;
        for (speed, metres) in SPEEDS.iter().enumerate() {
            // Setting off and halting take some seconds more.
            let about = whole_seconds(distance / metres);
            for seconds in about.max(2)..about + 6 {
                let act = self.made(speed, seconds);
                let off = (act.distance() / distance - 1.0).abs();
                // A hair of preference for what comes first keeps the choice from hanging on rounding.
                if best.as_ref().is_none_or(|(known, _)| off < known - 0.001) {
                    best = Some((off, act.clone()));
                }
            }
            let enough = if speed + 1 < AT_EASE { NEAR } else { TOLERABLE };
            if best.as_ref().is_some_and(|(off, _)| *off < enough) {
                break;
            }
        }
        let (_, act) = best.expect("some speed was tried");
        let known = self.chosen.iter().position(|known| known.name == act.name);
        known.unwrap_or_else(|| {
            self.chosen.push(act);
            self.chosen.len() - 1
        })
    }

    fn made(&mut self, speed: usize, seconds: u32) -> &Act {
        let Kind { name, builtin, fixed, middle } = &self.kind;
        self.tried.entry((speed, seconds)).or_insert_with(|| {
            let mut parameters = vec![("speed", SPEEDS[speed]), ("seconds", f64::from(seconds))];
            parameters.extend_from_slice(fixed);
            let made = act("", builtin, &parameters, &[]);
            let name = format!("{name} {:.2} at {:.1}", made.distance(), SPEEDS[speed]);
            let halfway = [("halfway", made.last() / 2)];
            act(&name, builtin, &parameters, if *middle { &halfway } else { &[] })
        })
    }

    /// One of those chosen.
    pub fn get(&self, walk: usize) -> &Act {
        &self.chosen[walk]
    }

    /// Those chosen.
    pub fn into_chosen(self) -> Vec<Act> {
        self.chosen
    }
}

/// Below `seconds`, which are few.
fn whole_seconds(seconds: f64) -> u32 {
    u32::try_from(floor_index(seconds)).unwrap_or(0)
}

/// A turn by the nearest of the angles that clips are made for, degrees; never none at all.
pub fn nearest_turn(radians: f64) -> i32 {
    /// Degrees: fine enough for ways to stay as they are, coarse enough for a dozen or two of clips.
    const STEP: i32 = 5;
    let wrapped = radians - TAU * (radians / TAU).round();
    let steps = (wrapped.to_degrees() / f64::from(STEP)).round();
    let steps = (1..=180 / STEP).rev().find(|step| f64::from(*step) <= steps.abs()).unwrap_or(1);
    if wrapped < 0.0 { -STEP * steps } else { STEP * steps }
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

    #[test]
    fn every_way_has_a_walk_within_six_percent() {
        for mut walks in [Walks::with_box(), Walks::back()] {
            for centimetres in (140..900).step_by(7).chain([2000, 5857]) {
                let distance = 0.01 * f64::from(centimetres);
                let walk = walks.nearest(distance);
                let own = walks.get(walk).distance();
                assert!((own / distance - 1.0).abs() < TOLERABLE, "{own} for {distance}");
            }
            let names: Vec<String> = walks.into_chosen().into_iter().map(|act| act.name).collect();
            let mut once = names.clone();
            once.sort();
            once.dedup();
            assert_eq!(once.len(), names.len());
        }
    }

    #[test]
    fn turns_are_to_the_nearest_of_five_degrees() {
        let nearest = [1.0, -1.0, 53.0, 178.0, -178.0, 190.0, -350.0]
            .map(|degrees: f64| nearest_turn(degrees.to_radians()));
        assert_eq!(nearest, [5, -5, 55, 180, -180, -170, 10]);
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
