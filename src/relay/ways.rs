//! The walks of carriers, and when they set out on them.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::acts::{Act, Place, STATURE, Walks, act, turn, turn_name};
use super::layout::{Acts, Back, Carrier, Part, hundredths};
use super::strung::{Held, Strung};
use crate::clip::builtin::FPS;
use crate::geometry::{c64, cis};
use crate::index::floor_index;

/// Gives everybody the walks that come nearest to their ways. Those of others are as much longer as who walks is taller.
pub fn walk(carriers: &mut [Carrier], acts: &mut Acts) {
    let (mut carries, mut backs) = (Walks::with_box(), Walks::back());
    let mut besides = BTreeMap::new();
    for carrier in carriers {
        let way = (carrier.give.position - carrier.take.position).norm() * STATURE / carrier.stature;
        let turned = match carrier.part {
            Part::First | Part::Between(_) => None,
            Part::Middle(turned) | Part::Last(turned) => Some(turned),
        };
        let beside = *besides.entry(turned).or_insert_with(|| beside_walk(turned, acts));
        let along = (way * way - beside.im * beside.im).max(0.0).sqrt();
        carrier.walk = carries.nearest((along - beside.re).max(SHORTEST));
        if let Part::Between(back) = &mut carrier.part {
            back.walk = backs.nearest(way);
        }
    }
    (acts.carries, acts.backs) = (carries.into_chosen(), backs.into_chosen());
}

/// No way with a box is shorter, metres.
const SHORTEST: f64 = 0.5;

/// How far a carrier gets from where it grasps a box to where it lets go without the walk between, along the walk and to its left.
/// `turned`: with the box, degrees, if it takes it from somebody.
fn beside_walk(turned: Option<i32>, acts: &Acts) -> c64 {
    let origin = Place { position: c64::new(0.0, 0.0), facing: 0.0 };
    let grasps = if turned.is_some() { &acts.take_over } else { &acts.pick_up };
    let grasped = grasps.end(grasps.start(grasps.event("grasp"), origin));
    let ready = turned.map_or(grasped, |degrees| turn(degrees, true).end(grasped));
    let gives = &acts.hand_over;
    ready.position * cis(-ready.facing) + gives.at(origin, gives.event("release"))
}

/// When everybody takes a box, sets off with it and lets it go, by the clips of all before them strung together; who is back waits
/// until the box before comes, to the frame. `beginnings`: of each box, seconds. Cost: linear in carriers.
pub fn wait_for_boxes(carriers: &mut [Carrier], beginnings: &[f64], acts: &Acts) {
    let (mut made, mut strung) = (Made::default(), Strung::default());
    let mut released = 0.0;
    for carrier in carriers {
        carries(carrier, (beginnings[carrier.load], released), acts, (&mut made, &mut strung));
        if let Part::Between(back) = carrier.part {
            // From the release of its own box to the grasp of the one before.
            let needed = ((released - carrier.gives) * FPS).round();
            let wait = waits(carrier, (back, needed), acts, (&mut made, &mut strung));
            carrier.part = Part::Between(Back { wait, ..back });
        }
        released = carrier.gives;
    }
}

/// Sets when it carries its box. Its clips begin when the box does, or as the one before lets the box go.
fn carries(
    carrier: &mut Carrier,
    (beginning, released): (f64, f64),
    acts: &Acts,
    (made, strung): (&mut Made, &mut Strung),
) {
    let turned = match carrier.part {
        Part::First | Part::Between(_) => None,
        Part::Middle(degrees) | Part::Last(degrees) => Some(made.turn(degrees, true)),
    };
    let gives = if matches!(carrier.part, Part::Last(_)) { &acts.put_down } else { &acts.hand_over };
    let takes = held(if turned.is_some() { &acts.take_over } else { &acts.pick_up }, "grasp");
    let (carry, gives) = ((&acts.carries[carrier.walk], None), held(gives, "release"));
    let turned = turned.as_deref().map(|turn| (turn, None));
    let way: Vec<Held<'_>> = [Some(takes), turned, Some(carry), Some(gives)].into_iter().flatten().collect();
    let at = strung.begins(&way, carrier.stature);
    let begins = if turned.is_some() { released - frame(takes) / FPS } else { beginning };
    carrier.takes = begins + frame(takes) / FPS;
    carrier.sets_off = begins + at[at.len() - 2] / FPS;
    carrier.gives = begins + (at[at.len() - 1] + frame(gives)) / FPS;
}

/// How long who is back waits, frames, for `needed` frames to be between letting one box go and taking the other.
fn waits(
    carrier: &Carrier,
    (back, needed): (Back, f64),
    acts: &Acts,
    (made, strung): (&mut Made, &mut Strung),
) -> usize {
    let (gives, takes) = (held(&acts.hand_over, "release"), held(&acts.take_over, "grasp"));
    let facing = back.facing.map(|degrees| made.turn(degrees, false));
    fitting_wait(needed, |frames| {
        let waits: Vec<Arc<Act>> =
            wait_seconds(frames).into_iter().map(|seconds| made.wait(seconds)).collect();
        let mut way = vec![gives, (&acts.about, None), (&acts.backs[back.walk], None)];
        way.extend(facing.iter().chain(&waits).map(|act| (&**act, None)));
        way.push(takes);
        strung.begins(&way, carrier.stature)[way.len() - 1] + frame(takes) - frame(gives)
    })
}

/// An act with the frame of its event.
fn held<'a>(act: &'a Act, event: &str) -> Held<'a> {
    (act, Some(act.event(event)))
}

/// The frame of an act that stays.
fn frame((_, held): Held<'_>) -> f64 {
    held.unwrap_or(0) as f64
}

/// Frames of waiting for which what `takes` says comes to `needed` frames, or as near as may be. Where clips are cut hangs a little on
/// how long they are: those about the length that would do without that are tried.
fn fitting_wait(needed: f64, mut takes: impl FnMut(usize) -> f64) -> usize {
    /// Frames, either way.
    const ABOUT: f64 = 15.0;
    let shortest = SHORTEST_WAIT as f64;
    let about = shortest + needed - takes(SHORTEST_WAIT);
    let from = floor_index((about - ABOUT).max(shortest));
    let to = floor_index((about + ABOUT).max(shortest));
    let missed = |wait: usize| ((needed - takes(wait)).abs(), wait);
    let best = (from..=to).map(missed).min_by(|one, other| one.0.total_cmp(&other.0));
    best.map_or(SHORTEST_WAIT, |(_, wait)| wait)
}

/// Who is back waits no less, frames.
const SHORTEST_WAIT: usize = 30;

/// Seconds of the clips by which somebody waits so many frames: whole ones, and one or two more to the frame. So some dozens of short
/// clips make all waits of a crowd.
pub fn wait_seconds(frames: usize) -> Vec<f64> {
    let whole = (frames / SECOND).saturating_sub(1);
    let more = hundredths((frames - whole * SECOND) as f64 / FPS);
    let (longest, rest) = (whole / LONGEST_WAIT, whole % LONGEST_WAIT);
    let mut all = vec![LONGEST_WAIT as f64; longest];
    all.extend((rest > 0).then_some(rest as f64));
    all.push(more);
    all
}

/// No clip of waiting is longer, seconds; who waits longer performs several.
const LONGEST_WAIT: usize = 600;

/// Frames.
const SECOND: usize = 30;

/// Name in the scene of waiting so long.
pub fn wait_name(seconds: f64) -> String {
    format!("wait {seconds}")
}

/// Clips by their names, each made once.
#[derive(Default)]
struct Made(BTreeMap<String, Arc<Act>>);

impl Made {
    fn turn(&mut self, degrees: i32, with_box: bool) -> Arc<Act> {
        let made = || Arc::new(turn(degrees, with_box));
        Arc::clone(self.0.entry(turn_name(degrees, with_box)).or_insert_with(made))
    }

    fn wait(&mut self, seconds: f64) -> Arc<Act> {
        let name = wait_name(seconds);
        let made = || Arc::new(act(&name, "idle", &[("seconds", seconds)], &[]));
        Arc::clone(self.0.entry(name.clone()).or_insert_with(made))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relay::{Along, Relay, relay};

    #[test]
    fn waits_are_made_of_clips_to_the_frame() {
        assert_eq!(wait_seconds(30), [1.0]);
        assert_eq!(wait_seconds(59), [1.97]);
        assert_eq!(wait_seconds(97), [2.0, 1.23]);
        assert_eq!(wait_seconds(601 * SECOND), [600.0, 1.0]);
        assert_eq!(wait_seconds(1300 * SECOND + 1), [600.0, 600.0, 99.0, 1.03]);
    }

    #[test]
    fn who_waits_longer_than_any_clip_performs_several() {
        let asked = Relay { disturbers: Some(0), boxes: 2, along: Along::Line, ..Relay::of(160) };
        let scene = relay(&asked, "a test").expect("it fits");
        assert!(scene.contains("\"wait 600\", \"wait "), "80 carriers take some 700 s");
    }
}
