//! Those who get in the way, each of one carrier.

use std::f64::consts::PI;

use super::acts::{Act, Place, STATURE, act};
use super::chance::{Choice, below, signed};
use super::courses::{BODY, Course, Crowd, performed};
use super::layout::{Acts, Carrier, Part, hundredths, stature_within};
use super::{Disturbance, Relay};
use crate::clip::builtin::FPS;
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
    /// Of those who jump: how far the carrier is past the hurdle and beside it, to the right negative, metres.
    pub beside: (f64, f64),
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

/// The carrier is so far past the hurdle and beside it, seen by who jumps, metres, where nobody else is there.
const BESIDE: (f64, f64) = (0.3, 1.1);

/// Where somebody is there, the hurdle is so much farther to the side, or so much farther along, metres.
const FARTHER: [f64; 6] = [0.0, 0.4, 0.8, 1.2, 1.6, 2.0];
const ALONG: [f64; 3] = [0.0, 1.0, -1.0];

/// Half the width of the hurdle, metres.
const HURDLE: f64 = 0.5;

/// Between people at least, metres: edits move them a little.
const CLEAR: f64 = 0.15;

/// Who pats stands so, seen from the back that is patted, at [`STATURE`], metres; shorter ones stand nearer.
pub const PAT_FROM: (f64, f64) = (-0.62, 0.1);

/// Who pats is no taller than this above who is patted, metres.
const TALLER: f64 = 0.15;

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

/// Two of a relay who are ever in each other, as clips last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clash {
    /// Who: positions of carriers, or behind them of disturbers (or of what these jump over); rising.
    pub who: (usize, usize),
    /// How far into each other, metres.
    pub depth: f64,
    /// When they are so deep in each other, seconds.
    pub time: f64,
}

/// `count` disturbers, spread evenly over the carriers. Who is to be patted waits. Each is where nobody else comes, as clips last:
/// of its ways to disturb, in the order in which chance and nearness prefer them, the first with room for it; where none has,
/// that with the most. Those who can give way least are placed first. Cost: linear in disturbers and those about them.
/// Also who are in each other all the same.
pub fn disturbers(
    relay: &Relay,
    carriers: &mut [Carrier],
    count: usize,
    acts: &Acts,
) -> (Vec<Disturber>, Vec<Clash>) {
    let clips = Clips { left: aside(true), right: aside(false), jump: jump(), pat: pat(), acts };
    let asked: Vec<(usize, Disturbance)> = (0..count)
        .map(|index| {
            let whom = (2 * index + 1) * carriers.len() / (2 * count);
            let how = how(relay, &carriers[whom], index);
            if how == Disturbance::Pat {
                let place = acts.take_over.start(acts.take_over.last() / 2, carriers[whom].take);
                carriers[whom].comes = false;
                carriers[whom].start = acts.wait.start(acts.wait.last(), place);
            }
            (whom, how)
        })
        .collect();
    let mut crowd = Crowd::default();
    carriers.iter().enumerate().for_each(|(whom, carrier)| crowd.add(whom, clips.carried(carrier)));
    let mut placed: Vec<(usize, Disturber)> = Vec::with_capacity(count);
    for turn in [Disturbance::Pat, Disturbance::Aside, Disturbance::Jump] {
        for (index, (whom, _)) in asked.iter().enumerate().filter(|(_, (_, how))| *how == turn) {
            let ways = ways(relay, (&carriers[*whom], *whom), (index, turn), &clips);
            let (disturber, courses) = freest(&crowd, &carriers[*whom], ways, &clips);
            // Numbers beyond those of carriers: only its hurdle is its own.
            courses.into_iter().for_each(|course| crowd.add(carriers.len() + index, course));
            placed.push((index, disturber));
        }
    }
    placed.sort_by_key(|(index, _)| *index);
    // In the way of the one it disturbs it is meant to be.
    let meant = |(one, other): &(usize, usize)| {
        other.checked_sub(carriers.len()).is_some_and(|index| asked[index].0 == *one)
    };
    let clash = |(who, (gap, time)): (_, (f64, f64))| Clash { who, depth: -gap, time };
    let clashes = crowd.clashes().into_iter().filter(|(who, _)| !meant(who)).map(clash).collect();
    (placed.into_iter().map(|(_, disturber)| disturber).collect(), clashes)
}

/// The first of some ways with room for it, else that with the most; and what it takes up.
fn freest(
    crowd: &Crowd,
    carrier: &Carrier,
    ways: Vec<Disturber>,
    clips: &Clips<'_>,
) -> (Disturber, Vec<Course>) {
    let mut best: Option<(f64, Disturber, Vec<Course>)> = None;
    for way in ways {
        let courses = clips.taken_up(carrier, &way);
        // In the way of the one it disturbs it is meant to be.
        let but = (way.how != Disturbance::Jump).then_some(way.whom);
        let gap = courses.iter().map(|course| crowd.gap(course, but)).fold(f64::INFINITY, f64::min);
        if best.as_ref().is_none_or(|(known, ..)| gap.min(CLEAR) > *known) {
            best = Some((gap.min(CLEAR), way, courses));
        }
        if gap >= CLEAR {
            break;
        }
    }
    let (_, way, courses) = best.expect("there is a way to disturb");
    (way, courses)
}

/// Ways of one to disturb, those preferred first.
fn ways(
    relay: &Relay,
    (carrier, whom): (&Carrier, usize),
    (index, how): (usize, Disturbance),
    clips: &Clips<'_>,
) -> Vec<Disturber> {
    // A hand that comes down on somebody much shorter would pull its body along.
    let tallest = if how == Disturbance::Pat { carrier.stature + TALLER } else { f64::INFINITY };
    let stature = stature_within(relay, (Choice::DisturberHeight, index), (0.0, tallest));
    let late = match how {
        // Hands meet backs at one and the same moment.
        Disturbance::Pat => 0.0,
        Disturbance::Aside | Disturbance::Jump => {
            hundredths(relay.phase * signed(relay.seed, Choice::Lateness, index))
        }
    };
    let left = match how {
        Disturbance::Pat => wrap(carrier.give.facing - carrier.take.facing - PI) > 0.0,
        Disturbance::Aside | Disturbance::Jump => below(2, relay.seed, Choice::Side, index) == 0,
    };
    let way = |left: bool, start: Place| Disturber {
        how,
        whom,
        left,
        start,
        hurdle: None,
        beside: BESIDE,
        late,
        stature,
    };
    let sides = [left, !left];
    match how {
        Disturbance::Pat => sides.map(|left| way(left, behind(carrier, stature))).into(),
        Disturbance::Aside => sides.map(|left| way(left, in_the_way(carrier, left, clips))).into(),
        Disturbance::Jump => {
            let places = FARTHER.into_iter().flat_map(|farther| ALONG.map(|along| (farther, along)));
            let both = places.flat_map(|place| sides.map(|left| (place, left)));
            let jumps = both.map(|((farther, along), left)| {
                let beside = (BESIDE.0 + along, (BESIDE.1 + farther) * side(left));
                let hurdle = hurdle(carrier, beside);
                Disturber { hurdle: Some(hurdle), beside, ..way(left, run_up(hurdle, clips)) }
            });
            jumps.collect()
        }
    }
}

/// What people of a relay perform.
struct Clips<'a> {
    left: Act,
    right: Act,
    jump: Act,
    pat: Act,
    acts: &'a Acts,
}

impl Clips<'_> {
    /// Stepping aside to a carrier's left: who faces the carrier has that on the right.
    const fn aside(&self, left: bool) -> &Act {
        if left { &self.right } else { &self.left }
    }

    /// Where a carrier is when.
    fn carried(&self, carrier: &Carrier) -> Course {
        let (take, give) = (carrier.take.position, carrier.give.position);
        let walks = self.acts.carries[carrier.walk].seconds();
        let way = [(carrier.sets_off, take), (carrier.sets_off + walks, give)];
        let mut knots = Vec::with_capacity(4);
        match carrier.part {
            Part::First => knots.extend(way),
            Part::Between(back) => {
                let turned = carrier.gives + 1.0 + self.acts.about.seconds();
                knots.extend(way);
                knots.extend([(turned, give), (turned + self.acts.backs[back.walk].seconds(), take)]);
            }
            Part::Middle(_) | Part::Last(_) => {
                if carrier.comes {
                    let there = carrier.takes - self.acts.take_over.event("grasp") as f64 / FPS;
                    knots.extend([(there - self.acts.come.seconds(), carrier.start.position), (there, take)]);
                }
                knots.extend(way);
            }
        }
        Course { knots, radius: BODY }
    }

    /// Where who disturbs a carrier is when, and its hurdle.
    fn taken_up(&self, carrier: &Carrier, disturber: &Disturber) -> Vec<Course> {
        let carry = &self.acts.carries[carrier.walk];
        let halfway = carrier.sets_off + carry.event("halfway") as f64 / FPS + disturber.late;
        let course = |acts: &[&Act], at: (usize, usize), place: Place, time: f64| {
            performed(acts, at, (place, time), disturber.stature)
        };
        match disturber.how {
            Disturbance::Aside => {
                let place = beside_way(carrier, disturber.left);
                vec![course(&[self.aside(disturber.left)], (0, ASIDE_FRAME), place, halfway)]
            }
            Disturbance::Pat => {
                let leaves = if disturber.left { &self.left } else { &self.right };
                let patted = carrier.takes - 1.5 * self.acts.wait.seconds();
                vec![course(&[&self.pat, leaves], (0, self.pat.event("hit")), disturber.start, patted)]
            }
            Disturbance::Jump => {
                let come = &self.acts.come;
                let hurdle = disturber.hurdle.unwrap_or(disturber.start);
                let takeoff = Place { position: hurdle.position - cis(hurdle.facing) * TAKEOFF, ..hurdle };
                let jumps =
                    course(&[come, &self.jump, come], (1, self.jump.event("takeoff")), takeoff, halfway);
                vec![jumps, Course::resting(hurdle.position, HURDLE)]
            }
        }
    }
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

/// Where who stands before a carrier is when it has just stepped aside.
fn beside_way(carrier: &Carrier, left: bool) -> Place {
    let facing = carrier.give.facing;
    let position = middle(carrier) + cis(facing) * c64::new(ASIDE_AT.0, ASIDE_AT.1 * side(left));
    Place { position, facing: facing + PI }
}

/// Where it steps aside from.
fn in_the_way(carrier: &Carrier, left: bool, clips: &Clips<'_>) -> Place {
    clips.aside(left).start(ASIDE_FRAME, beside_way(carrier, left))
}

/// A hurdle beside the carrier's way, to be taken against it.
fn hurdle(carrier: &Carrier, (past, beside): (f64, f64)) -> Place {
    let facing = carrier.give.facing + PI;
    Place { position: middle(carrier) - cis(facing) * c64::new(past, beside), facing }
}

/// Behind who waits for a box.
fn behind(carrier: &Carrier, stature: f64) -> Place {
    let (ahead, left) = pat_from(stature);
    let Place { position, facing } = carrier.take;
    Place { position: position + cis(facing) * c64::new(ahead, left), facing }
}

/// Where who jumps over `hurdle` sets off.
fn run_up(hurdle: Place, clips: &Clips<'_>) -> Place {
    let place = Place { position: hurdle.position - cis(hurdle.facing) * TAKEOFF, ..hurdle };
    let come = &clips.acts.come;
    come.start(come.last(), clips.jump.start(clips.jump.event("takeoff"), place))
}
