//! Who stands where, takes from whom, turns how far: everything about a relay but the words.

use std::f64::consts::PI;

use super::acts::{Act, PALMS_APART, Place, REACH, STATURE, WIDTH, act, nearest_turn};
use super::chance::{Choice, below, signed};
use super::curve::{Curve, curve};
use super::disturbers::{Clash, Disturber, disturbers};
use super::ways::{wait_for_boxes, walk};
use super::{Disturbance, FARTHEST_DRAG, HEIGHTS, LONGEST_PHASE, Relay, RelayError, counts, most_boxes};
use crate::geometry::{c64, cis};

/// What a carrier does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// Picks the first box up.
    First,
    /// Picks a box up, hands it on, walks back, and puts the box before it down.
    Between(Back),
    /// Takes a box and hands it on; turns so many degrees in between.
    Middle(i32),
    /// Takes the last box and puts it down; turns so many degrees in between.
    Last(i32),
}

/// How somebody comes back for the box before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Back {
    /// Turns on the spot so many degrees, to face who brings it; not at all where the walk ends so.
    pub facing: Option<i32>,
    /// Waits so long, frames.
    pub wait: usize,
    /// Position of its way back in [`Acts::backs`].
    pub walk: usize,
}

/// One who carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carrier {
    /// What it does.
    pub part: Part,
    /// The box it takes or picks up first, from 0.
    pub load: usize,
    /// Where its track starts.
    pub start: Place,
    /// Where it takes the box, or picks it up.
    pub take: Place,
    /// Where it holds the box out, or puts it down.
    pub give: Place,
    /// Whether it walks up to take the box, and does not stand there.
    pub comes: bool,
    /// Height, metres.
    pub stature: f64,
    /// Position of its way with the box in [`Acts::carries`].
    pub walk: usize,
    /// When it takes the box or picks it up, seconds, by its clips strung together.
    pub takes: f64,
    /// When it sets off with it: where the first frame of its way is, or would be were it not dropped.
    pub sets_off: f64,
    /// When it lets the box go.
    pub gives: f64,
}

/// The clips of a relay that all its tracks share.
#[derive(Clone, Debug)]
pub struct Acts {
    /// Bends and lifts the box.
    pub pick_up: Act,
    /// Stands until the box comes.
    pub wait: Act,
    /// Comes until the box comes.
    pub come: Act,
    /// Takes the box.
    pub take_over: Act,
    /// Ways with it.
    pub carries: Vec<Act>,
    /// Holds it out.
    pub hand_over: Act,
    /// Puts it down.
    pub put_down: Act,
    /// Stands at last.
    pub rest: Act,
    /// Turns back without the box.
    pub about: Act,
    /// Ways back without the box.
    pub backs: Vec<Act>,
}

/// A relay laid out.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Along the curve.
    pub carriers: Vec<Carrier>,
    /// Along the curve.
    pub disturbers: Vec<Disturber>,
    /// Position of the carrier that picks each box up.
    pub starters: Vec<usize>,
    /// When each of them begins, seconds.
    pub beginnings: Vec<f64>,
    /// Metres from one hand-over to the next.
    pub spacing: f64,
    /// The clips that all share.
    pub acts: Acts,
    /// Who are in each other, as clips last.
    pub clashes: Vec<Clash>,
}

/// Hand-overs are so far beside the curve, to the left and to the right in turn, metres: nobody turns right round and walks
/// into who gave the box.
const ASIDE: f64 = 0.45;

/// Farthest from the origin that scenes reach, metres, with room for those who come from there.
const FARTHEST: f64 = 99_900.0;

/// Lays a relay out. Cost: linear in characters, and in the length of the curve.
///
/// # Errors
/// [`RelayError`] where the numbers do not fit.
pub fn layout(relay: &Relay) -> Result<Layout, RelayError> {
    let (carriers, disturbing) = counts(relay)?;
    check(relay, carriers, disturbing)?;
    let (curve, spacing) = curve(&relay.along, carriers, relay.spacing)?;
    let mut acts = acts();
    let starters: Vec<usize> = (0..relay.boxes).map(|load| load * carriers / relay.boxes).collect();
    let mut carriers = chain(relay, (&curve, spacing), (carriers, &starters), &acts);
    let far = carriers.iter().map(|carrier| carrier.give.position.norm()).fold(0.0, f64::max);
    if far > FARTHEST {
        return Err(RelayError::TooFar(far));
    }
    walk(&mut carriers, &mut acts);
    let late =
        |load: usize| (0.5 * relay.phase * (1.0 + signed(relay.seed, Choice::Beginning, load))).max(0.0);
    let beginnings: Vec<f64> = (0..relay.boxes).map(|load| hundredths(late(load))).collect();
    wait_for_boxes(&mut carriers, &beginnings, &acts);
    let (disturbers, clashes) = disturbers(relay, &mut carriers, disturbing, &acts);
    Ok(Layout { carriers, disturbers, starters, beginnings, spacing, acts, clashes })
}

/// To two digits, as it is written.
pub fn hundredths(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

fn check(relay: &Relay, carriers: usize, disturbers: usize) -> Result<(), RelayError> {
    let most = most_boxes(carriers);
    if relay.boxes == 0 || relay.boxes > most {
        return Err(RelayError::Boxes { boxes: relay.boxes, carriers, most });
    }
    let (shortest, tallest) = relay.heights;
    if !(HEIGHTS.0 <= shortest && shortest <= tallest && tallest <= HEIGHTS.1) {
        return Err(RelayError::Heights(relay.heights));
    }
    if !(0.0..=LONGEST_PHASE).contains(&relay.phase) {
        return Err(RelayError::Phase(relay.phase));
    }
    if let Some(drag) = relay.drag.filter(|drag| !(0.1..=FARTHEST_DRAG).contains(drag)) {
        return Err(RelayError::Drag(drag));
    }
    if disturbers > 0 && relay.disturbances.is_empty() {
        return Err(RelayError::NoDisturbance);
    }
    Ok(())
}

fn acts() -> Acts {
    let box_for = |seconds: f64| [("seconds", seconds), ("width", WIDTH)];
    Acts {
        pick_up: act("pick up", "pick_up", &box_for(2.0), &[]),
        wait: act("wait", "idle", &[("seconds", 1.0)], &[("patted", 15)]),
        come: act("come", "walk", &[("start", 1.0), ("stop", 1.0), ("seconds", 2.5)], &[]),
        take_over: act("take over", "take_over", &box_for(2.0), &[]),
        carries: Vec::new(),
        hand_over: act("hand over", "hand_over", &box_for(2.0), &[]),
        put_down: act("put down", "put_down", &box_for(2.0), &[]),
        rest: act("rest", "idle", &[("seconds", 1.0)], &[]),
        about: act("turn about", "turn", &[("angle", 180.0)], &[]),
        backs: Vec::new(),
    }
}

/// Heights to choose from: up to five, to the centimetre.
pub fn statures((shortest, tallest): (f64, f64)) -> Vec<f64> {
    let mut all: Vec<f64> =
        (0..5).map(|step| hundredths(shortest + (tallest - shortest) * f64::from(step) / 4.0)).collect();
    all.dedup();
    all
}

/// Height of number `index`.
pub fn stature(relay: &Relay, choice: Choice, index: usize) -> f64 {
    stature_within(relay, (choice, index), (0.0, f64::INFINITY))
}

/// The same among heights within a range; the nearest to it where none is.
pub fn stature_within(relay: &Relay, (choice, index): (Choice, usize), (from, to): (f64, f64)) -> f64 {
    let all = statures(relay.heights);
    let (shortest, tallest) = (all[0], all[all.len() - 1]);
    let within: Vec<f64> = all.into_iter().filter(|height| (from..=to).contains(height)).collect();
    let chosen = within.get(below(within.len(), relay.seed, choice, index)).copied();
    chosen.unwrap_or(if tallest < from { tallest } else { shortest })
}

/// How tall carrier `n` is. A box is offered as high all along as by who picked it up: nobody is so much shorter than others that these
/// would stoop for it.
fn carrier_stature(relay: &Relay, n: usize, starts: bool) -> f64 {
    /// By how much a taker may be taller, metres.
    const STOOP: f64 = 0.3;
    let least = if starts { relay.heights.1 - STOOP } else { 0.0 };
    stature_within(relay, (Choice::CarrierHeight, n), (least, f64::INFINITY))
}

/// Where hand-over `n` is, between carriers `n` − 1 and `n`; the first and the last are where boxes start and end.
fn meeting(curve: &Curve, spacing: f64, n: usize, count: usize) -> c64 {
    let s = spacing * n as f64;
    let aside = match n {
        _ if n == 0 || n == count => 0.0,
        _ if n % 2 == 1 => ASIDE,
        _ => -ASIDE,
    };
    curve.at(s) + c64::i() * curve.direction(s, 0.25 * spacing) * aside
}

/// Metres from body to body when these two hold one box.
pub fn apart(giver: f64, taker: f64) -> f64 {
    REACH * (giver + taker) / STATURE + PALMS_APART
}

/// Everybody along the curve: each walks straight from where the box is taken to where it is held out.
fn chain(
    relay: &Relay,
    (curve, spacing): (&Curve, f64),
    (count, starters): (usize, &[usize]),
    acts: &Acts,
) -> Vec<Carrier> {
    let mut carriers: Vec<Carrier> = Vec::with_capacity(count);
    let mut load = 0;
    for n in 0..count {
        let starts = starters.get(load + usize::from(n > 0)) == Some(&n);
        load += usize::from(starts && n > 0);
        let stature = carrier_stature(relay, n, starts || n == 0);
        let (here, there) = (meeting(curve, spacing, n, count), meeting(curve, spacing, n + 1, count));
        let before = carriers.last().copied();
        let take = match before {
            // As far from the first hand-over as all others are from theirs.
            None => {
                let facing = (there - here).arg();
                Place { position: here + cis(facing) * (0.5 * apart(stature, stature)), facing }
            }
            Some(giver) => {
                let ahead = cis(giver.give.facing);
                let position = giver.give.position + ahead * apart(giver.stature, stature);
                Place { position, facing: giver.give.facing + PI }
            }
        };
        let facing = (there - take.position).arg();
        let half = 0.5 * apart(stature, stature);
        let give = Place { position: there - cis(facing) * half, facing };
        let turned = nearest_turn(facing - take.facing);
        let part = match before {
            None => Part::First,
            Some(_) if starts => {
                Part::Between(Back { facing: back_turn(facing, take.facing), wait: 0, walk: 0 })
            }
            Some(_) if n + 1 == count => Part::Last(turned),
            Some(_) => Part::Middle(turned),
        };
        let comes =
            below(3, relay.seed, Choice::Coming, n) == 0 && matches!(part, Part::Middle(_) | Part::Last(_));
        let start = start(part, (take, give), comes, acts);
        let (walk, [takes, sets_off, gives]) = (0, [0.0; 3]);
        carriers.push(Carrier {
            part,
            load,
            start,
            take,
            give,
            comes,
            stature,
            walk,
            takes,
            sets_off,
            gives,
        });
    }
    carriers
}

/// Who walked back against `facing` turns so far to look along `taking`.
fn back_turn(facing: f64, taking: f64) -> Option<i32> {
    /// Less than this the walk itself takes up, radians.
    const LITTLE: f64 = 0.26;
    let angle = crate::geometry::wrap(taking - facing - PI);
    (angle.abs() > LITTLE).then(|| nearest_turn(angle))
}

/// Where a track starts.
fn start(part: Part, (take, give): (Place, Place), comes: bool, acts: &Acts) -> Place {
    if matches!(part, Part::First | Part::Between(_)) {
        let place = Place { position: take.position, facing: give.facing };
        return acts.pick_up.start(acts.pick_up.event("grasp"), place);
    }
    let place = acts.take_over.start(acts.take_over.event("grasp"), take);
    let first = if comes { &acts.come } else { &acts.wait };
    first.start(first.last(), place)
}

/// Whether anybody disturbs so.
pub fn disturbed(layout: &Layout, how: Disturbance) -> bool {
    layout.disturbers.iter().any(|disturber| disturber.how == how)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relay::tests::spiral;

    #[test]
    fn givers_and_takers_stand_face_to_face_an_arms_length_apart() {
        let layout = layout(&spiral()).expect("it fits");
        for pair in layout.carriers.windows(2) {
            let (giver, taker) = (&pair[0], &pair[1]);
            let between = taker.take.position - giver.give.position;
            assert!((between.norm() - apart(giver.stature, taker.stature)).abs() < 1e-9);
            assert!((between / between.norm() - cis(giver.give.facing)).norm() < 1e-9);
            assert!((cis(taker.take.facing) + cis(giver.give.facing)).norm() < 1e-9);
        }
    }

    #[test]
    fn every_box_starts_once_and_ends_with_who_started_the_next() {
        let layout = layout(&spiral()).expect("it fits");
        assert_eq!(layout.starters, [0, 5, 10, 15, 20, 25, 30, 35]);
        for (n, carrier) in layout.carriers.iter().enumerate() {
            assert_eq!(carrier.load, n / 5);
            let expected = match n {
                0 => matches!(carrier.part, Part::First),
                39 => matches!(carrier.part, Part::Last(_)),
                _ if n % 5 == 0 => matches!(carrier.part, Part::Between(_)),
                _ => matches!(carrier.part, Part::Middle(_)),
            };
            assert!(expected, "carrier {n}: {:?}", carrier.part);
        }
    }
}
