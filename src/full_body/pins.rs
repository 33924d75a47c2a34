//! Feet held perfectly still: which parts of a contact really stand, at which points, and what that asks of the captured foot.
//!
//! A heel's contact lasts until the ankle is a hand's breadth up, and old captures drift by centimetres: what is held is the
//! part of a contact in which its point stays within [`STILL`] of one place. The place is the one within that part that
//! turns the joints of the leg least; the captured foot is moved there, as little as possible.

use glam::{DMat3, DVec3};

use crate::clip::contacts::runs;
use crate::full_body::chain::Place;
use crate::full_body::fade::{Span, fill};
use crate::full_body::limb::minimal_rotation;
use crate::full_body::plants::{Displacement, LegTrack};
use crate::geometry::{exp, log};

/// A point that stands stays within this distance of its place, metres.
const STILL: f64 = 0.01;
/// No point stands that is never slower than this, m/s.
const FASTEST: f64 = 0.25;
/// Shortest time that a point stands, seconds: three working frames.
const SHORTEST: f64 = 2.0 / 30.0;
/// Time in which the foot turns back as captured when heel or toe lift, seconds.
const BLEND: f64 = 5.0 / 30.0;
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
    for span in still(times, &heels, &leg.heel) {
        held.heel[span.first..=span.last].fill(Some(least_turn(&leg.rest, &heels, span)));
    }
    for span in still(times, &toes, &leg.toe) {
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
    /// Holds the toe at `place`, but as far from the heel as it is on the foot where both are held. A second place of the
    /// heel within `span` ends it: one toe has one place.
    fn hold_toe(&mut self, leg: &LegTrack, span: Span, place: DVec3) {
        let first_heel = self.heel[span.first..=span.last].iter().flatten().next().copied();
        let length = leg.rest[span.first].limb.lower.distance(leg.rest[span.first].end);
        let place = first_heel.map_or(place, |heel| heel + (place - heel).normalize_or_zero() * length);
        for at in span.first..=span.last {
            if self.heel[at].is_some() && self.heel[at] != first_heel {
                break;
            }
            self.toe[at] = Some(place);
        }
    }
}

/// The stretches of `labels` in which a point stands still.
fn still(times: &[f64], points: &[DVec3], labels: &[bool]) -> Vec<Span> {
    let mut open: Vec<Span> = runs(labels).into_iter().map(|(first, last)| Span { first, last }).collect();
    let mut found = Vec::new();
    let long = |span: &Span| times[span.last] - times[span.first] > SHORTEST - 1e-9;
    while let Some(span) = open.pop() {
        let slowest = (span.first..=span.last)
            .map(|at| (speed(times, points, at), at))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((speed, at)) = slowest.filter(|_| long(&span)) else {
            continue;
        };
        if speed > FASTEST {
            continue;
        }
        let core = around(points, span, at);
        found.extend(Some(core).filter(long));
        if core.first > span.first {
            open.push(Span { first: span.first, last: core.first - 1 });
        }
        if core.last < span.last {
            open.push(Span { first: core.last + 1, last: span.last });
        }
    }
    found.sort_by_key(|span| span.first);
    found
}

/// Speed of a point at sample `at`, m/s.
fn speed(times: &[f64], points: &[DVec3], at: usize) -> f64 {
    let (before, after) = (at.saturating_sub(1), (at + 1).min(points.len() - 1));
    points[after].distance(points[before]) / (times[after] - times[before]).max(f64::MIN_POSITIVE)
}

/// The samples about `at` in which a point stays near where it is then.
fn around(points: &[DVec3], within: Span, at: usize) -> Span {
    let near = |other: &usize| points[*other].distance(points[at]) < STILL;
    let first = (within.first..=at).rev().take_while(near).last().unwrap_or(at);
    let last = (at..=within.last).take_while(near).last().unwrap_or(at);
    Span { first, last }
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
        let lengths: Vec<f64> =
            costs.iter().map(|(cost, point)| (*cost * (best - *point)).dot(best - *point).max(0.0).sqrt()).collect();
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
    for at in 0..count {
        if let (Some(heel), Some(toe)) = (held.heel[at], held.toe[at]) {
            let foot = leg.rest[at].end - leg.rest[at].limb.lower;
            turns[at] = [log(minimal_rotation(foot, toe - heel))];
        }
    }
    fill(times, &spans(&both), BLEND, &mut turns);
    let mut shifts = vec![[DVec3::ZERO]; count];
    for at in 0..count {
        let (ankle, toe) = (leg.rest[at].limb.lower, leg.rest[at].end);
        shifts[at] = [match (held.heel[at], held.toe[at]) {
            (Some(held), _) => held - ankle,
            (None, Some(held)) => held - exp(turns[at][0]) * (toe - ankle) - ankle,
            (None, None) => DVec3::ZERO,
        }];
    }
    let any: Vec<bool> = (0..count).map(|at| held.heel[at].is_some() || held.toe[at].is_some()).collect();
    fill(times, &spans(&any), fade, &mut shifts);
    shifts.iter().zip(&turns).map(|(shift, turn)| [shift[0], turn[0]]).collect()
}

/// The runs of `labels`.
pub fn spans(labels: &[bool]) -> Vec<Span> {
    runs(labels).into_iter().map(|(first, last)| Span { first, last }).collect()
}
