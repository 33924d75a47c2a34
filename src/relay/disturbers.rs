//! Those who get in the way, each of one carrier.

use std::f64::consts::PI;

use super::acts::{Act, Place, STATURE, act};
use super::chance::{Choice, below, signed};
use super::layout::{Acts, Carrier, Part, hundredths, stature};
use super::{Disturbance, Relay};
use crate::geometry::{c64, cis, wrap};

/// One who gets in the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturber {
    /// How.
    pub how: Disturbance,
    /// Position of the carrier it disturbs.
    pub whom: usize,
    /// On the carrier's left, or right; who pats leaves to its own left, or right.
    pub left: bool,
    /// Where its track starts.
    pub start: Place,
    /// The hurdle, of those who jump.
    pub hurdle: Option<Place>,
    /// Seconds after the carrier; negative before.
    pub late: f64,
    /// Height, metres.
    pub stature: f64,
}

/// Frame of stepping aside at which the carrier comes.
pub const ASIDE_FRAME: usize = 60;

/// Ahead of the carrier and beside its way who steps aside is then, metres.
pub const ASIDE_AT: (f64, f64) = (1.1, 0.6);

/// The middle of the hurdle is so far before the pelvis of who takes off, metres: the flight is half way over it.
pub const TAKEOFF: f64 = 0.35;

/// The carrier is so far past the hurdle and beside it, seen by who jumps, metres.
pub const BESIDE: (f64, f64) = (0.3, 1.1);

/// Who pats stands so, seen from the back that is patted, at [`STATURE`], metres; shorter ones stand nearer.
pub const PAT_FROM: (f64, f64) = (-0.62, 0.1);

/// Metres ahead of the patted back, below 0, and to its left, of one of this height.
pub fn pat_from(stature: f64) -> (f64, f64) {
    (PAT_FROM.0 * stature / STATURE, PAT_FROM.1)
}

/// Stepping aside, to the left or to the right.
pub fn aside(left: bool) -> Act {
    let events = [("aside", ASIDE_FRAME)];
    let to_the_left = if left { 1.0 } else { 0.0 };
    act(aside_name(left), "side_step", &[("seconds", 5.0), ("left", to_the_left)], &events)
}

/// Name of [`aside`] in the scene.
pub const fn aside_name(left: bool) -> &'static str {
    if left { "aside left" } else { "aside right" }
}

/// Jumping over the hurdle.
pub fn jump() -> Act {
    act("jump", "jump_over", &[], &[])
}

/// Patting somebody: the right hand comes forward.
pub fn pat() -> Act {
    act("pat", "slap", &[], &[])
}

/// `count` disturbers, spread evenly over the carriers. Who is to be patted waits.
pub fn disturbers(relay: &Relay, carriers: &mut [Carrier], count: usize, acts: &Acts) -> Vec<Disturber> {
    let clips = Clips { left: aside(true), right: aside(false), jump: jump() };
    let all = (0..count).map(|index| {
        let whom = (2 * index + 1) * carriers.len() / (2 * count);
        let how = how(relay, &carriers[whom], index);
        if how == Disturbance::Pat {
            let place = acts.take_over.start(acts.take_over.last() / 2, carriers[whom].take);
            carriers[whom].comes = false;
            carriers[whom].start = acts.wait.start(acts.wait.last(), place);
        }
        let carrier = carriers[whom];
        let left = match how {
            Disturbance::Pat => wrap(carrier.give.facing - carrier.take.facing - PI) > 0.0,
            Disturbance::Aside | Disturbance::Jump => below(2, relay.seed, Choice::Side, index) == 0,
        };
        let stature = stature(relay, Choice::DisturberHeight, index);
        let (start, hurdle) = match how {
            Disturbance::Aside => (in_the_way(&carrier, left, &clips), None),
            Disturbance::Jump => {
                let hurdle = hurdle(&carrier, left);
                (run_up(hurdle, &clips.jump, acts), Some(hurdle))
            }
            Disturbance::Pat => (behind(&carrier, stature), None),
        };
        let late = match how {
            // Hands meet backs at one and the same moment.
            Disturbance::Pat => 0.0,
            Disturbance::Aside | Disturbance::Jump => {
                hundredths(relay.phase * signed(relay.seed, Choice::Lateness, index))
            }
        };
        Disturber { how, whom, left, start, hurdle, late, stature }
    });
    all.collect()
}

/// What disturbers perform.
struct Clips {
    left: Act,
    right: Act,
    jump: Act,
}

fn how(relay: &Relay, carrier: &Carrier, index: usize) -> Disturbance {
    let how = relay.disturbances[below(relay.disturbances.len(), relay.seed, Choice::Disturbance, index)];
    // Who starts with a box does not wait for one.
    let waits = matches!(carrier.part, Part::Middle(_) | Part::Last(_));
    if how == Disturbance::Pat && !waits { Disturbance::Aside } else { how }
}

fn middle(carrier: &Carrier) -> c64 {
    0.5 * (carrier.take.position + carrier.give.position)
}

const fn side(left: bool) -> f64 {
    if left { 1.0 } else { -1.0 }
}

/// Where who stands before a carrier steps aside from.
fn in_the_way(carrier: &Carrier, left: bool, clips: &Clips) -> Place {
    let facing = carrier.give.facing;
    let position = middle(carrier) + cis(facing) * c64::new(ASIDE_AT.0, ASIDE_AT.1 * side(left));
    // Who faces the carrier has the carrier's right on the left.
    let clip = if left { &clips.right } else { &clips.left };
    clip.start(ASIDE_FRAME, Place { position, facing: facing + PI })
}

/// A hurdle beside the carrier's way, to be taken against it.
fn hurdle(carrier: &Carrier, left: bool) -> Place {
    let facing = carrier.give.facing + PI;
    Place { position: middle(carrier) - cis(facing) * c64::new(BESIDE.0, BESIDE.1 * side(left)), facing }
}

/// Behind who waits for a box.
fn behind(carrier: &Carrier, stature: f64) -> Place {
    let (ahead, left) = pat_from(stature);
    let Place { position, facing } = carrier.take;
    Place { position: position + cis(facing) * c64::new(ahead, left), facing }
}

/// Where who jumps over `hurdle` sets off.
fn run_up(hurdle: Place, jump: &Act, acts: &Acts) -> Place {
    let takeoff = jump.clip.clip.events.get("takeoff").map_or(0, |frame| frame.as_usize());
    let place = Place { position: hurdle.position - cis(hurdle.facing) * TAKEOFF, ..hurdle };
    acts.come.start(acts.come.last(), jump.start(takeoff, place))
}
