//! Which points of a captured foot are held still, when, and where.
//!
//! In each step one point goes first: it is held alone as long as that turns no joint too far. The other is held with it, as far
//! from it as it is on the foot, or alone before and after. Walkers land on the heel and roll off over the toe: the toe goes
//! first. Who turns on a heel has that first: whichever holds more and moves the foot less.

use glam::DVec3;

use crate::clip::contacts::runs;
use crate::full_body::chain::Place;
use crate::full_body::fade::Span;
use crate::full_body::plants::{Displacement, LegTrack};
use crate::full_body::turning::{Least, largest_turn, least, least_turn};
use crate::geometry::{exp, log};
use crate::limb::minimal_rotation;

/// What is held is sought from where a point stays within this distance of its slowest moment, metres.
const STILL: f64 = 0.01;
/// No point stands that is never slower than this, m/s.
const FASTEST: f64 = 0.4;
/// Shortest time that a point stands, seconds: three working frames.
const SHORTEST: f64 = 2.0 / 30.0;
/// Time in which the foot turns back as captured when heel or toe lift, seconds.
pub const BLEND: f64 = 5.0 / 30.0;
/// Both points of a foot are as far from each other as this, metres.
const EXACT: f64 = 1e-6;
/// Points are held no farther above or below their captured median than this, metres.
const FLOATS: f64 = 5e-3;
/// As bad as a point that is not held at a sample: one that is moved so far, metres.
const MOVED: f64 = 0.02;
/// How often what is held and its place are sought in turn.
const ROUNDS: usize = 8;
/// Rounding of times, seconds.
const ROUNDING: f64 = 1e-9;

/// The captured foot, and what holding its points costs.
pub struct Foot<'a> {
    /// Where it is as captured.
    pub places: &'a [Place],
    /// Where its heel is.
    pub heels: Vec<DVec3>,
    /// Where its toe is.
    pub toes: Vec<DVec3>,
    heel_costs: Vec<Least>,
    toe_costs: Vec<Least>,
    /// Nothing is held that would turn hip, knee or ankle farther than this, radians.
    pub largest_turn: f64,
}

impl<'a> Foot<'a> {
    /// The foot of a leg, for the holding of which no joint may turn farther than `largest_turn`, radians. Cost: linear.
    pub fn new(leg: &'a LegTrack, largest_turn: f64) -> Self {
        let places = &leg.rest;
        let heels: Vec<DVec3> = places.iter().map(|place| place.limb.lower).collect();
        let toes: Vec<DVec3> = places.iter().map(|place| place.end).collect();
        let heel_costs = places.iter().map(|place| least(place, DVec3::ZERO)).collect();
        let toe_costs = places.iter().map(|place| least(place, place.end - place.limb.lower)).collect();
        Self { places, heels, toes, heel_costs, toe_costs, largest_turn }
    }

    /// What holds the toe alone at `place`: the shift of the ankle and the turn of the foot.
    pub fn to_toe(&self, at: usize, place: DVec3) -> Displacement {
        let turn = self.toe_costs[at].turn * (place - self.toes[at]);
        [self.shift_about(at, place, turn), turn]
    }

    /// The shift of the ankle with which the toe is at `place` and the foot turned by `turn`.
    pub fn shift_about(&self, at: usize, place: DVec3, turn: DVec3) -> DVec3 {
        place - exp(turn) * (self.toes[at] - self.heels[at]) - self.heels[at]
    }

    /// What holds the heel alone.
    pub fn to_heel(&self, at: usize, place: DVec3) -> Displacement {
        let shift = place - self.heels[at];
        [shift, self.heel_costs[at].turn * shift]
    }

    /// What holds both, as far from each other as they are on the foot.
    pub fn to_both(&self, at: usize, heel: DVec3, toe: DVec3) -> Displacement {
        let foot = self.toes[at] - self.heels[at];
        [heel - self.heels[at], log(minimal_rotation(foot, toe - heel))]
    }

    /// Whether no joint turns too far for it.
    pub fn affords(&self, at: usize, [shift, turn]: Displacement) -> bool {
        largest_turn(&self.places[at], shift, turn) < self.largest_turn
    }
}

/// Heel or toe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sole {
    /// Heel: the ankle.
    Heel,
    /// Toe.
    Toe,
}

impl Sole {
    const fn other(self) -> Self {
        match self {
            Self::Heel => Self::Toe,
            Self::Toe => Self::Heel,
        }
    }
}

impl Foot<'_> {
    /// Where heel or toe is as captured.
    pub fn points(&self, sole: Sole) -> &[DVec3] {
        match sole {
            Sole::Heel => &self.heels,
            Sole::Toe => &self.toes,
        }
    }

    fn alone(&self, sole: Sole, at: usize, place: DVec3) -> Displacement {
        match sole {
            Sole::Heel => self.to_heel(at, place),
            Sole::Toe => self.to_toe(at, place),
        }
    }

    fn both(&self, sole: Sole, at: usize, [place, other]: [DVec3; 2]) -> Displacement {
        match sole {
            Sole::Heel => self.to_both(at, place, other),
            Sole::Toe => self.to_both(at, other, place),
        }
    }

    /// Where `sole` turns the joints least, held for all of `span`.
    pub fn least_turn(&self, sole: Sole, span: Span) -> DVec3 {
        let costs = match sole {
            Sole::Heel => &self.heel_costs,
            Sole::Toe => &self.toe_costs,
        };
        least_turn(costs, self.points(sole), span)
    }

    /// The same, nearly as high as captured.
    fn best(&self, sole: Sole, span: Span) -> DVec3 {
        let place = self.least_turn(sole, span);
        let mut heights: Vec<f64> =
            self.points(sole)[span.first..=span.last].iter().map(|point| point.y).collect();
        let middle = heights.len() / 2;
        let (_, median, _) = heights.select_nth_unstable_by(middle, f64::total_cmp);
        place.with_y(place.y.clamp(*median - FLOATS, *median + FLOATS))
    }

    /// How far both points are moved by a displacement, metres.
    fn moves(&self, at: usize, [shift, turn]: Displacement) -> f64 {
        let lever = self.toes[at] - self.heels[at];
        shift.length() + (shift + exp(turn) * lever - lever).length()
    }
}

/// A point held at a place.
#[derive(Clone, Copy, Debug)]
struct Hold {
    span: Span,
    place: DVec3,
}

impl Hold {
    fn contains(&self, at: usize) -> bool {
        (self.span.first..=self.span.last).contains(&at)
    }

    fn meets(&self, span: Span) -> bool {
        self.span.first <= span.last && span.first <= self.span.last
    }
}

/// Where heel and toe are held at each sample.
#[derive(Clone, Debug)]
pub struct Held {
    /// Of the heel.
    pub heel: Vec<Option<DVec3>>,
    /// Of the toe.
    pub toe: Vec<Option<DVec3>>,
}

impl Held {
    /// When either is held.
    pub fn any(&self) -> Vec<bool> {
        (0..self.heel.len()).map(|at| self.any_at(at)).collect()
    }

    /// Whether either is held at sample `at`.
    pub fn any_at(&self, at: usize) -> bool {
        self.heel[at].is_some() || self.toe[at].is_some()
    }

    fn add(&mut self, sole: Sole, holds: &[Hold]) {
        let places = match sole {
            Sole::Heel => &mut self.heel,
            Sole::Toe => &mut self.toe,
        };
        for hold in holds {
            places[hold.span.first..=hold.span.last].fill(Some(hold.place));
        }
    }
}

/// What of a foot can be held. Cost: linear in samples times the places that the foot stands on within one contact.
pub fn held(times: &[f64], foot: &Foot, leg: &LegTrack) -> Held {
    let mut held = Held { heel: vec![None; times.len()], toe: vec![None; times.len()] };
    for (first, last) in runs(&leg.bears()) {
        let step = Step { times, foot, leg, span: Span { first, last } };
        let [toe_first, heel_first] = [Sole::Toe, Sole::Heel].map(|sole| step.held(sole));
        let (sole, [own, others]) = if heel_first.worth > toe_first.worth {
            (Sole::Heel, heel_first.holds)
        } else {
            (Sole::Toe, toe_first.holds)
        };
        held.add(sole, &own);
        held.add(sole.other(), &others);
    }
    held
}

/// A stretch in which any point of a foot bears.
struct Step<'a> {
    times: &'a [f64],
    foot: &'a Foot<'a>,
    leg: &'a LegTrack,
    span: Span,
}

/// What can be held in a step with one point first.
struct Choice {
    /// Of that point, and of the other.
    holds: [Vec<Hold>; 2],
    /// Samples by points held, less what moving the foot for it is worth.
    worth: f64,
}

impl Step<'_> {
    fn held(&self, sole: Sole) -> Choice {
        let foot = self.foot;
        let affords = |at: usize, place: DVec3| foot.affords(at, foot.alone(sole, at, place));
        let mut own = Vec::new();
        for contact in self.contacts(sole) {
            own.extend(holds(
                self.times,
                (foot.points(sole), contact),
                &|span| foot.best(sole, span),
                &affords,
            ));
        }
        let mut others = Vec::new();
        for contact in self.contacts(sole.other()) {
            for (zone, hold) in self.zones(contact, &own) {
                others.extend(self.held_by(sole.other(), zone, hold));
            }
        }
        let worth = self.worth(sole, &own, &others);
        Choice { holds: [own, others], worth }
    }

    fn contacts(&self, sole: Sole) -> Vec<Span> {
        let labels = match sole {
            Sole::Heel => &self.leg.heel,
            Sole::Toe => &self.leg.toe,
        };
        let Span { first, last } = self.span;
        let own = runs(&labels[first..=last]).into_iter();
        own.map(|(from, to)| Span { first: first + from, last: first + to }).collect()
    }

    /// `contact`, cut where it meets `holds` of the other point so that each part meets one of these at most, [`BLEND`] apart.
    fn zones(&self, contact: Span, holds: &[Hold]) -> Vec<(Span, Option<Hold>)> {
        let met: Vec<&Hold> = holds.iter().filter(|hold| hold.meets(contact)).collect();
        if met.is_empty() {
            return vec![(contact, None)];
        }
        let mut zones = Vec::new();
        let mut first = contact.first;
        for (index, hold) in met.iter().enumerate() {
            let last = met.get(index + 1).map_or(contact.last, |next| next.span.first - 1);
            if first <= last {
                zones.push((Span { first, last }, Some(**hold)));
            }
            first = self.times.partition_point(|time| *time <= self.times[last] + BLEND);
        }
        zones
    }

    /// Holds of `sole` within `zone`, in which the other point is held by `other` and else free.
    fn held_by(&self, sole: Sole, zone: Span, other: Option<Hold>) -> Vec<Hold> {
        let foot = self.foot;
        let affords = |at: usize, place: DVec3| {
            let Some(other) = other.filter(|other| other.contains(at)) else {
                return foot.affords(at, foot.alone(sole, at, place));
            };
            let misses = place.distance(other.place) - foot.heels[at].distance(foot.toes[at]);
            misses.abs() < EXACT && foot.affords(at, foot.both(sole, at, [place, other.place]))
        };
        let place = |span: Span| {
            let place = foot.best(sole, span);
            let Some(other) = other.filter(|other| other.meets(span)) else { return place };
            let length = foot.heels[span.first].distance(foot.toes[span.first]);
            other.place + (place - other.place).normalize_or_zero() * length
        };
        holds(self.times, (foot.points(sole), zone), &place, &affords)
    }

    fn worth(&self, sole: Sole, own: &[Hold], others: &[Hold]) -> f64 {
        let held_at =
            |holds: &[Hold], at: usize| holds.iter().find(|hold| hold.contains(at)).map(|hold| hold.place);
        let worth = |at: usize| match (held_at(own, at), held_at(others, at)) {
            (Some(place), Some(other)) => {
                2.0 - self.foot.moves(at, self.foot.both(sole, at, [place, other])) / MOVED
            }
            (Some(place), None) => 1.0 - self.foot.moves(at, self.foot.alone(sole, at, place)) / MOVED,
            (None, Some(other)) => {
                1.0 - self.foot.moves(at, self.foot.alone(sole.other(), at, other)) / MOVED
            }
            (None, None) => 0.0,
        };
        (self.span.first..=self.span.last).map(worth).sum()
    }
}

/// The stretches of `within` in which one of `points` can be held, [`BLEND`] apart, in the order of time: about its
/// slowest moment first. `place`: the best one for a stretch; `affords`: whether it will do at a sample.
fn holds(
    times: &[f64],
    (points, within): (&[DVec3], Span),
    place: &impl Fn(Span) -> DVec3,
    affords: &impl Fn(usize, DVec3) -> bool,
) -> Vec<Hold> {
    let mut open = vec![within];
    let mut found: Vec<Hold> = Vec::new();
    while let Some(span) = open.pop() {
        let slowest = (span.first..=span.last)
            .map(|at| (speed(times, points, at), at))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, at)) = slowest.filter(|(speed, _)| *speed < FASTEST) else {
            continue;
        };
        let hold = grown(points, (span, at), place, affords);
        if let Some(hold) = hold.filter(|hold| lasts(times, hold.span)) {
            found.push(hold);
        }
        let core = hold.map_or(Span { first: at, last: at }, |hold| hold.span);
        let before = (span.first..core.first).rev().find(|&at| times[at] < times[core.first] - BLEND);
        let after = (core.last..=span.last).find(|&at| times[at] > times[core.last] + BLEND);
        open.extend(before.map(|last| Span { first: span.first, last }));
        open.extend(after.map(|first| Span { first, last: span.last }));
    }
    found.sort_by_key(|hold| hold.span.first);
    found
}

fn lasts(times: &[f64], span: Span) -> bool {
    times[span.last] - times[span.first] > SHORTEST - ROUNDING
}

/// The longest stretch about `at` that is found by seeking the best place for a stretch, and the stretch for that place,
/// in turn.
fn grown(
    points: &[DVec3],
    (within, at): (Span, usize),
    place: &impl Fn(Span) -> DVec3,
    affords: &impl Fn(usize, DVec3) -> bool,
) -> Option<Hold> {
    let about = |holds: &dyn Fn(usize) -> bool| {
        let first = (within.first..=at).rev().take_while(|other| holds(*other)).last()?;
        let last = (at..=within.last).take_while(|other| holds(*other)).last()?;
        Some(Span { first, last })
    };
    let mut span = about(&|other| points[at].distance(points[other]) < STILL)?;
    let mut best: Option<Hold> = None;
    for _ in 0..ROUNDS {
        let place = place(span);
        let Some(next) = about(&|other| affords(other, place)) else { break };
        let length = |span: Span| span.last - span.first;
        if best.is_some_and(|best| length(best.span) >= length(next)) {
            break;
        }
        best = Some(Hold { span: next, place });
        span = next;
    }
    best
}

/// Speed of a point at sample `at`, m/s.
fn speed(times: &[f64], points: &[DVec3], at: usize) -> f64 {
    let (before, after) = (at.saturating_sub(1), (at + 1).min(points.len() - 1));
    points[after].distance(points[before]) / (times[after] - times[before]).max(f64::MIN_POSITIVE)
}
