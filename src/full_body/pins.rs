//! Feet held perfectly still: which parts of a contact really stand, at which points, and what that asks of the captured foot.
//!
//! A heel's contact lasts until the ankle is a hand's breadth up, and old captures drift by centimetres: what is held is the
//! part of a contact in which its point stays within a centimetre of one place. The place is the one within that part that
//! turns the joints of the leg least; the captured foot is moved there, as little as possible.

use glam::{DMat3, DVec3};

use crate::clip::contacts::runs;
use crate::full_body::chain::Place;
use crate::full_body::fade::{Slopes, Span, fill};
use crate::full_body::plants::{Displacement, LegTrack};
use crate::geometry::{exp, log};
use crate::limb::minimal_rotation;

/// A point that stands stays within this distance of its place, metres.
const STILL: f64 = 0.01;
/// No point stands that is never slower than this, m/s.
const FASTEST: f64 = 0.25;
/// Shortest time that a point stands, seconds: three working frames.
const SHORTEST: f64 = 2.0 / 30.0;
/// Time in which the foot turns back as captured when heel or toe lift, seconds.
const BLEND: f64 = 5.0 / 30.0;
/// Nothing is held that would turn hip or knee farther than this, radians: 2° …
const LARGEST_TURN: f64 = 0.035;
/// … or the foot farther than this: 3°. Ankles add up both, and no joint may turn by 5°.
const LARGEST_FOOT_TURN: f64 = 0.052;
/// Passes of the search for the place of least turn.
const PASSES: usize = 20;

/// The captured foot held still.
#[derive(Clone, Debug, PartialEq)]
pub struct Pins {
    /// What moves the captured foot to where it is held, before the edit; faded out where it is not held.
    pub corrections: Vec<Displacement>,
    /// When the heel is held.
    pub heel: Vec<bool>,
    /// When the toe is held.
    pub toe: Vec<bool>,
}

/// Holds the feet of a leg still. `fade`: seconds in which corrections vanish outside. Cost: linear in samples times the
/// places that a foot stands on within one contact.
pub fn pins(times: &[f64], leg: &LegTrack, fade: f64) -> Pins {
    let count = times.len();
    let mut held = Held { heel: vec![None; count], toe: vec![None; count] };
    let heels: Vec<DVec3> = leg.rest.iter().map(|place| place.limb.lower).collect();
    let toes: Vec<DVec3> = leg.rest.iter().map(|place| place.end).collect();
    for span in still(times, &leg.rest, &heels, &leg.heel) {
        held.hold_heel(leg, span, least_turn(&leg.rest, &heels, span));
    }
    for span in still(times, &leg.rest, &toes, &leg.toe) {
        held.hold_toe(leg, span, least_turn(&leg.rest, &toes, span));
    }
    let corrections = corrections(times, leg, &held, fade);
    let is_held = |places: &[Option<DVec3>]| places.iter().map(Option::is_some).collect();
    Pins { corrections, heel: is_held(&held.heel), toe: is_held(&held.toe) }
}

/// Where heel and toe are held at each sample.
struct Held {
    heel: Vec<Option<DVec3>>,
    toe: Vec<Option<DVec3>>,
}

impl Held {
    /// Holds the heel at `place` while that turns no joint by more than [`LARGEST_TURN`].
    fn hold_heel(&mut self, leg: &LegTrack, span: Span, place: DVec3) {
        for at in span.first..=span.last {
            let own = &leg.rest[at];
            if leg_turn(own, place - own.limb.lower) < LARGEST_TURN {
                self.heel[at] = Some(place);
            }
        }
    }

    /// Holds the toe at `place`, but as far from the heel as it is on the foot where both are held, and only while that
    /// turns neither foot nor leg too far. A second place of the heel within `span` ends it: one toe has
    /// one place.
    fn hold_toe(&mut self, leg: &LegTrack, span: Span, place: DVec3) {
        let first_heel = self.heel[span.first..=span.last].iter().flatten().next().copied();
        let length = leg.rest[span.first].limb.lower.distance(leg.rest[span.first].end);
        let place = first_heel.map_or(place, |heel| heel + (place - heel).normalize_or_zero() * length);
        for at in span.first..=span.last {
            let own = &leg.rest[at];
            match self.heel[at] {
                Some(_) if self.heel[at] != first_heel => break,
                Some(heel) if (own.end - own.limb.lower).angle_between(place - heel) > LARGEST_FOOT_TURN => {}
                None if leg_turn(own, place - own.end) > LARGEST_TURN => {}
                _ => self.toe[at] = Some(place),
            }
        }
    }
}

/// The stretches of `labels` in which a point stands still, [`BLEND`] apart.
fn still(times: &[f64], places: &[Place], points: &[DVec3], labels: &[bool]) -> Vec<Span> {
    let mut open: Vec<Span> = runs(labels).into_iter().map(|(first, last)| Span { first, last }).collect();
    let mut found = Vec::new();
    while let Some(span) = open.pop() {
        let slowest = (span.first..=span.last)
            .map(|at| (speed(times, points, at), at))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, at)) = slowest.filter(|(speed, _)| *speed < FASTEST) else {
            continue;
        };
        let core = around(places, points, span, at);
        if times[core.last] - times[core.first] > SHORTEST - ROUNDING {
            found.push(core);
        }
        let before = (span.first..core.first).rev().find(|&at| times[at] < times[core.first] - BLEND);
        let after = (core.last..=span.last).find(|&at| times[at] > times[core.last] + BLEND);
        open.extend(before.map(|last| Span { first: span.first, last }));
        open.extend(after.map(|first| Span { first, last: span.last }));
    }
    found.sort_by_key(|span| span.first);
    found
}

/// Rounding of times, seconds.
const ROUNDING: f64 = 1e-9;

/// Speed of a point at sample `at`, m/s.
fn speed(times: &[f64], points: &[DVec3], at: usize) -> f64 {
    let (before, after) = (at.saturating_sub(1), (at + 1).min(points.len() - 1));
    points[after].distance(points[before]) / (times[after] - times[before]).max(f64::MIN_POSITIVE)
}

/// The samples about `at` in which a point stays near where it is then.
fn around(places: &[Place], points: &[DVec3], within: Span, at: usize) -> Span {
    let near = |other: &usize| {
        let shift = points[at] - points[*other];
        shift.length() < STILL && leg_turn(&places[*other], shift) < LARGEST_TURN
    };
    let first = (within.first..=at).rev().take_while(near).last().unwrap_or(at);
    let last = (at..=within.last).take_while(near).last().unwrap_or(at);
    Span { first, last }
}

/// How far a joint of the leg turns when the foot is shifted, radians: the knee, or the hip. No turn is enough where the
/// leg does not reach.
fn leg_turn(place: &Place, shift: DVec3) -> f64 {
    let limb = place.limb;
    let distance = limb.upper.distance(limb.lower + shift);
    let length: f64 = limb.lengths().iter().sum();
    if distance > length && distance > limb.upper.distance(limb.lower) {
        return f64::INFINITY;
    }
    let knee = limb.bend_at(distance) - limb.bend();
    knee.abs().max((limb.lower - limb.upper).angle_between(limb.lower + shift - limb.upper))
}

/// The place for a point of the foot that turns the joints of the leg least, all along `span`: the smallest largest cost,
/// where a shift along the leg costs what it bends the knee by and any shift what it turns the leg by.
///
/// Source: weights after Lawson (Rice & Usow, *The Lawson Algorithm and Extensions*, Math. Comp. 1968).
fn least_turn(places: &[Place], points: &[DVec3], span: Span) -> DVec3 {
    let costs: Vec<(DMat3, DVec3)> =
        (span.first..=span.last).map(|at| (cost(&places[at]), points[at])).collect();
    let mut weights = vec![1.0; costs.len()];
    let mut best = points[span.first];
    for _ in 0..PASSES {
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for ((cost, point), weight) in costs.iter().zip(&weights) {
            matrix += *cost * *weight;
            right += *cost * *point * *weight;
        }
        best = matrix.inverse() * right;
        let lengths: Vec<f64> = costs
            .iter()
            .map(|(cost, point)| (*cost * (best - *point)).dot(best - *point).max(0.0).sqrt())
            .collect();
        let total: f64 = lengths.iter().zip(&weights).map(|(length, weight)| length * weight).sum();
        if total < f64::MIN_POSITIVE {
            break;
        }
        for (weight, length) in weights.iter_mut().zip(lengths) {
            *weight = (*weight * length / total).max(LEAST_WEIGHT);
        }
    }
    best
}

/// Weights stay above this, so that no system is singular.
const LEAST_WEIGHT: f64 = 1e-12;

/// `k² u uᵀ + 1/D²`: `u` along the leg, `k` radians of the knee per metre, `D` from hip to ankle.
fn cost(place: &Place) -> DMat3 {
    /// Knees straighter than this count as so bent, sine.
    const STRAIGHTEST: f64 = 0.1;
    let limb = place.limb;
    let [upper, lower] = limb.lengths();
    let leg = limb.lower - limb.upper;
    let distance = leg.length().max(STRAIGHTEST * (upper + lower));
    let knee = distance / (upper * lower * limb.bend().sin().max(STRAIGHTEST));
    let along = leg.normalize_or_zero() * knee;
    DMat3::from_cols(along * along.x, along * along.y, along * along.z)
        + DMat3::from_diagonal(DVec3::splat(1.0 / (distance * distance)))
}

/// What moves the captured foot so that its held points are where they are held.
fn corrections(times: &[f64], leg: &LegTrack, held: &Held, fade: f64) -> Vec<Displacement> {
    let count = times.len();
    let mut turns = vec![[DVec3::ZERO]; count];
    let both: Vec<bool> = (0..count).map(|at| held.heel[at].is_some() && held.toe[at].is_some()).collect();
    for (at, turn) in turns.iter_mut().enumerate() {
        if let (Some(heel), Some(toe)) = (held.heel[at], held.toe[at]) {
            let foot = leg.rest[at].end - leg.rest[at].limb.lower;
            *turn = [log(minimal_rotation(foot, toe - heel))];
        }
    }
    fill(times, &spans(&both), (BLEND, Slopes::Level), &mut turns);
    let mut shifts = vec![[DVec3::ZERO]; count];
    for (at, shift) in shifts.iter_mut().enumerate() {
        let (ankle, toe) = (leg.rest[at].limb.lower, leg.rest[at].end);
        *shift = [match (held.heel[at], held.toe[at]) {
            (Some(held), _) => held - ankle,
            (None, Some(held)) => held - exp(turns[at][0]) * (toe - ankle) - ankle,
            (None, None) => DVec3::ZERO,
        }];
    }
    let any: Vec<bool> = (0..count).map(|at| held.heel[at].is_some() || held.toe[at].is_some()).collect();
    fill(times, &spans(&any), (fade, Slopes::Level), &mut shifts);
    for at in (0..count).filter(|&at| !any[at]) {
        shifts[at][0] = afforded(&leg.rest[at], shifts[at][0]);
    }
    shifts.iter().zip(&turns).map(|(shift, turn)| [shift[0], turn[0]]).collect()
}

/// `shift`, or as much of it as turns no joint of the leg by more than [`LARGEST_TURN`]: a faded shift is small, but a leg
/// may be stretched straight there.
fn afforded(place: &Place, shift: DVec3) -> DVec3 {
    let (mut afforded, mut refused) = (0.0, 1.0);
    if leg_turn(place, shift) <= LARGEST_TURN {
        return shift;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (afforded + refused);
        if leg_turn(place, shift * middle) <= LARGEST_TURN {
            afforded = middle;
        } else {
            refused = middle;
        }
    }
    shift * afforded
}

/// Halvings of a share: to a millionth.
const HALVINGS: usize = 20;

/// The runs of `labels`.
pub fn spans(labels: &[bool]) -> Vec<Span> {
    runs(labels).into_iter().map(|(first, last)| Span { first, last }).collect()
}
