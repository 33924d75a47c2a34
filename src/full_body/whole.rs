//! Contacts held from end to end.
//!
//! A contact lasts from when a point comes down to when it is up by a hand's breadth, and old captures drift by centimetres
//! meanwhile. Every one has a place where it turns the joints least, as far from that of the foot's other point as these are on the
//! foot where both bear at once.

use glam::{DQuat, DVec3};

use crate::clip::contacts::runs;
use crate::full_body::fade::Span;
use crate::full_body::holding::{Foot, Held, Sole};
use crate::full_body::pins::spans;
use crate::full_body::plants::{Displacement, LegTrack};
use crate::geometry::{exp, log, smoothstep};
use crate::limb::minimal_rotation;

/// Sweeps over the pairs of contacts that bear at once. Two are apart right after one; a toe that bears through several contacts of
/// its heel takes a few more.
const SWEEPS: usize = 100;

/// A foot points no steeper than this up or down, share of its length.
const STEEPEST: f64 = 0.95;

/// A foot in the air that points no steeper than this, share of its length, is tilted so that its toe is above the ground …
const TILTED: f64 = 0.75;
/// … and one that points steeper than this is lifted.
const LIFTED: f64 = 0.92;

/// A contact, and where it is held.
struct Contact {
    sole: Sole,
    span: Span,
    place: DVec3,
    /// Its lowest captured height, metres: it is held no lower.
    lowest: f64,
}

impl Contact {
    fn new(foot: &Foot, sole: Sole, span: Span) -> Self {
        let points = &foot.points(sole)[span.first..=span.last];
        let lowest = points.iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
        let place = foot.least_turn(sole, span);
        Self { sole, span, place: place.with_y(place.y.max(lowest)), lowest }
    }

    fn samples(&self) -> f64 {
        (self.span.last + 1 - self.span.first) as f64
    }

    fn move_by(&mut self, way: DVec3) {
        self.place += way;
        self.place.y = self.place.y.max(self.lowest);
    }
}

/// Where heel and toe are held, all along their contacts. Cost: linear in samples.
pub fn whole(foot: &Foot, leg: &LegTrack) -> Held {
    let of = |sole: Sole, labels: &[bool]| -> Vec<Contact> {
        runs(labels).into_iter().map(|(first, last)| Contact::new(foot, sole, Span { first, last })).collect()
    };
    let (mut heels, mut toes) = (of(Sole::Heel, &leg.heel), of(Sole::Toe, &leg.toe));
    let pairs = pairs(&heels, &toes);
    for chain in pairs.chunk_by(|a, b| a.heel == b.heel || a.toe == b.toe) {
        align(foot, chain, (&mut heels, &mut toes));
    }
    for _ in 0..SWEEPS {
        for pair in &pairs {
            let at = pair.both.first;
            let length = foot.heels[at].distance(foot.toes[at]);
            keep_apart(&mut heels[pair.heel], &mut toes[pair.toe], length);
        }
    }
    let mut held = Held { heel: vec![None; leg.heel.len()], toe: vec![None; leg.toe.len()] };
    for contact in heels.into_iter().chain(toes) {
        let places = match contact.sole {
            Sole::Heel => &mut held.heel,
            Sole::Toe => &mut held.toe,
        };
        places[contact.span.first..=contact.span.last].fill(Some(contact.place));
    }
    held
}

/// Contacts of heel and toe that bear at once, and when.
struct Pair {
    heel: usize,
    toe: usize,
    both: Span,
}

impl Pair {
    /// From heel to toe as captured meanwhile, metres: the mean.
    fn lever(&self, foot: &Foot) -> DVec3 {
        let Span { first, last } = self.both;
        let sum: DVec3 = (first..=last).map(|at| foot.toes[at] - foot.heels[at]).sum();
        sum / (last + 1 - first) as f64
    }
}

/// All pairs, in the order of time as contacts are: each shares a contact with the one before, or begins a new chain.
fn pairs(heels: &[Contact], toes: &[Contact]) -> Vec<Pair> {
    let mut pairs = Vec::new();
    let (mut heel, mut toe) = (0, 0);
    while heel < heels.len() && toe < toes.len() {
        let (a, b) = (heels[heel].span, toes[toe].span);
        let both = Span { first: a.first.max(b.first), last: a.last.min(b.last) };
        if both.first <= both.last {
            pairs.push(Pair { heel, toe, both });
        }
        if a.last < b.last { heel += 1 } else { toe += 1 }
    }
    pairs
}

/// Moves the contacts of a chain of pairs so that in each the foot points as captured on the mean: by the least sum of squares over
/// samples.
fn align(foot: &Foot, chain: &[Pair], (heels, toes): (&mut [Contact], &mut [Contact])) {
    // Where each contact is from the first heel.
    let (mut heel_from, mut toe_from) = (vec![(chain[0].heel, DVec3::ZERO)], Vec::new());
    for pair in chain {
        let lever = pair.lever(foot);
        match (heel_from.last().copied(), toe_from.last().copied()) {
            (Some((heel, from)), _) if heel == pair.heel => toe_from.push((pair.toe, from + lever)),
            (_, Some((_, from))) => heel_from.push((pair.heel, from - lever)),
            _ => {}
        }
    }
    let of_heels = heel_from.iter().map(|(heel, from)| (&heels[*heel], *from));
    let of_toes = toe_from.iter().map(|(toe, from)| (&toes[*toe], *from));
    let (sum, samples) =
        of_heels.chain(of_toes).fold((DVec3::ZERO, 0.0), |(sum, samples), (contact, from)| {
            (sum + (contact.place - from) * contact.samples(), samples + contact.samples())
        });
    let first = sum / samples;
    heel_from.into_iter().for_each(|(heel, from)| heels[heel].place = first + from);
    toe_from.into_iter().for_each(|(toe, from)| toes[toe].place = first + from);
}

/// Brings two places to `length` from each other; the one that is held for longer moves less.
fn keep_apart(heel: &mut Contact, toe: &mut Contact, length: f64) {
    let between = toe.place - heel.place;
    let too_far = between.normalize_or_zero() * (between.length() - length);
    let share = toe.samples() / (heel.samples() + toe.samples());
    heel.move_by(too_far * share);
    toe.move_by(too_far * (share - 1.0));
}

/// Raises what the `corrections` of a foot do to a point that is not held where that would bring it below the ground: the lowest
/// captured place of the steps before and after, in which it `bears`, or of itself. A foot held by one point turns about it.
/// Cost: linear.
pub fn raise(foot: &Foot, (held, bears): (&Held, &[bool]), corrections: &mut [Displacement]) {
    let grounds = grounds(foot, bears);
    for (at, ([ankle, toe], correction)) in grounds.into_iter().zip(corrections).enumerate() {
        let lever = foot.toes[at] - foot.heels[at];
        let [shift, turn] = correction;
        let is_free = |place: &Option<DVec3>| place.is_none();
        let at_ankle = foot.heels[at] + *shift;
        if is_free(&held.heel[at]) && at_ankle.y < ankle {
            if is_free(&held.toe[at]) {
                shift.y += ankle - at_ankle.y;
            } else {
                let turned = exp(*turn) * lever;
                let place = at_ankle + turned;
                *turn = log(tilt(turned, place.y - ankle) * exp(*turn));
                *shift = foot.shift_about(at, place, *turn);
            }
        }
        let (at_ankle, turned) = (foot.heels[at] + *shift, exp(*turn) * lever);
        let missing = toe - at_ankle.y - turned.y;
        if is_free(&held.toe[at]) && missing > 0.0 {
            let lifted = if is_free(&held.heel[at]) { missing * steepness(turned) } else { 0.0 };
            shift.y += lifted;
            if lifted < missing {
                *turn = log(tilt(turned, turned.y + missing - lifted) * exp(*turn));
            }
        }
    }
}

/// How steep a foot points, from 0 (it can be tilted) to 1 (it is lifted instead: tilting hardly changes the height of its end).
fn steepness(lever: DVec3) -> f64 {
    let share = lever.y.abs() / lever.length().max(f64::MIN_POSITIVE);
    smoothstep((share - TILTED) / (LIFTED - TILTED))
}

/// The turn that brings the end of `lever` to `height` above its beginning.
fn tilt(lever: DVec3, height: f64) -> DQuat {
    let length = lever.length();
    let up = height.clamp(-STEEPEST * length, STEEPEST * length);
    let level = lever.with_y(0.0).normalize_or_zero() * (length * length - up * up).max(0.0).sqrt();
    minimal_rotation(lever, level.with_y(up))
}

/// The lowest that ankle and toe may come at each sample, metres.
fn grounds(foot: &Foot, bears: &[bool]) -> Vec<[f64; 2]> {
    let lower = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].min(b[1])];
    let own = |at: usize| [foot.heels[at].y, foot.toes[at].y];
    let mut grounds = vec![[f64::NEG_INFINITY; 2]; bears.len()];
    let mut before: Option<[f64; 2]> = None;
    let mut from = 0;
    for Span { first, last } in spans(bears) {
        let lowest = (first..=last).map(own).fold([f64::INFINITY; 2], lower);
        grounds[from..first].fill(before.map_or(lowest, |before| lower(before, lowest)));
        grounds[first..=last].fill(lowest);
        (before, from) = (Some(lowest), last + 1);
    }
    if let Some(before) = before {
        grounds[from..].fill(before);
    }
    grounds.into_iter().enumerate().map(|(at, ground)| lower(ground, own(at))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::full_body::chain::{Place, legs};
    use crate::full_body::plants::{FEET, bearing};
    use crate::full_body::tests::walk;

    /// Rounding of metres.
    const ROUNDING: f64 = 1e-9;

    /// The left leg of a generated walk.
    fn left() -> LegTrack {
        let (skeleton, input) = walk(3.0);
        let [Some(chain), _] = legs(&skeleton) else { panic!("the generated body has legs") };
        let rest: Vec<Place> = input.rest.iter().map(|pose| chain.place(&skeleton, pose)).collect();
        let [heel, toe] = bearing(&input.contacts, FEET[0]);
        LegTrack { moved: rest.clone(), rest, heel, toe }
    }

    #[test]
    fn every_contact_has_one_place_and_feet_keep_their_length() {
        let leg = left();
        let foot = Foot::new(&leg, f64::INFINITY);
        let held = whole(&foot, &leg);
        for (labels, places, points) in
            [(&leg.heel, &held.heel, &foot.heels), (&leg.toe, &held.toe, &foot.toes)]
        {
            assert!(runs(labels).len() > 2, "it takes steps");
            for (first, last) in runs(labels) {
                let place = places[first].expect("it is held");
                assert!(places[first..=last].iter().all(|own| *own == Some(place)));
                let lowest = points[first..=last].iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
                assert!(place.y > lowest - ROUNDING, "{} below {lowest}", place.y);
            }
            assert!((0..labels.len()).all(|at| labels[at] == places[at].is_some()));
        }
        for at in 0..leg.heel.len() {
            let (Some(heel), Some(toe)) = (held.heel[at], held.toe[at]) else { continue };
            let length = foot.heels[at].distance(foot.toes[at]);
            assert!((heel.distance(toe) - length).abs() < ROUNDING);
            let turned = (toe - heel).angle_between(foot.toes[at] - foot.heels[at]);
            assert!(turned < 0.5, "sample {at}: the foot points {turned} rad aside");
        }
    }

    #[test]
    fn what_would_be_in_the_ground_is_raised_and_what_is_held_stays() {
        let leg = left();
        let foot = Foot::new(&leg, f64::INFINITY);
        let held = whole(&foot, &leg);
        let down = [DVec3::Y * -0.05, DVec3::ZERO];
        let mut corrections = vec![down; leg.heel.len()];
        raise(&foot, (&held, &leg.bears()), &mut corrections);
        let grounds = grounds(&foot, &leg.bears());
        for (at, [shift, turn]) in corrections.into_iter().enumerate() {
            let ankle = foot.heels[at] + shift;
            let toe = ankle + exp(turn) * (foot.toes[at] - foot.heels[at]);
            match (held.heel[at], held.toe[at]) {
                (Some(_), Some(_)) => assert_eq!([shift, turn], down),
                (Some(_), None) => assert!(shift == down[0] && toe.y > grounds[at][1] - ROUNDING),
                (None, Some(_)) => {
                    assert!(toe.distance(foot.toes[at] + down[0]) < ROUNDING);
                    assert!(ankle.y > grounds[at][0] - ROUNDING);
                }
                (None, None) => {
                    assert!(ankle.y > grounds[at][0] - ROUNDING && toe.y > grounds[at][1] - ROUNDING)
                }
            }
        }
    }

    #[test]
    fn a_foot_that_points_straight_down_is_lifted_and_not_swung_aside() {
        let leg = left();
        let mut foot = Foot::new(&leg, f64::INFINITY);
        for at in 0..leg.heel.len() {
            foot.heels[at].y = if at == 0 { 0.1 } else { 0.2 };
            foot.toes[at] = foot.heels[at].with_y(0.0);
        }
        let nothing = || vec![None; leg.heel.len()];
        let held = Held { heel: nothing(), toe: nothing() };
        let bears: Vec<bool> = (0..leg.heel.len()).map(|at| at == 0).collect();
        let mut corrections = vec![[DVec3::Y * -0.002, DVec3::ZERO]; leg.heel.len()];
        raise(&foot, (&held, &bears), &mut corrections);
        for [shift, turn] in corrections {
            assert!(shift.length() < ROUNDING && turn == DVec3::ZERO, "{shift} {turn}");
        }
    }
}
