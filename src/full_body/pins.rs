//! Feet held perfectly still: which parts of a contact stand, at which points, and what that asks of the captured foot.
//!
//! A foot lands on its heel, comes down, and rolls off over its toe: its heel's contact lasts until the ankle is a hand's
//! breadth up, and old captures drift by centimetres. Of each contact is held what can be without turning any joint by
//! 5°: the toe first, about which the foot may turn, then the heel with it or, before the toe is down, alone. So one
//! point hands over to the other. Places are those that turn the joints of the leg least.

use glam::DVec3;

use crate::clip::contacts::runs;
use crate::full_body::chain::Place;
use crate::full_body::fade::{Slopes, Span, fill};
use crate::full_body::plants::{Displacement, LegTrack};
use crate::full_body::turning::{Least, largest_turn, least, least_turn};
use crate::geometry::{exp, log};
use crate::limb::minimal_rotation;

/// What is held is sought from where a point stays within this distance of its slowest moment, metres.
const STILL: f64 = 0.01;
/// No point stands that is never slower than this, m/s.
const FASTEST: f64 = 0.25;
/// Shortest time that a point stands, seconds: three working frames.
const SHORTEST: f64 = 2.0 / 30.0;
/// Time in which the foot turns back as captured when heel or toe lift, seconds.
const BLEND: f64 = 5.0 / 30.0;
/// Nothing is held that would turn hip, knee or ankle farther than this, radians.
pub const LARGEST_TURN: f64 = 0.084;
/// A strained leg is held otherwise within this time, seconds.
const NEARBY: f64 = 10.0 / 30.0;
/// How often what is held and its place are sought in turn.
const ROUNDS: usize = 8;
/// Rounding of times, seconds.
const ROUNDING: f64 = 1e-9;

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

/// What of a leg's foot is held, and where.
pub struct Standing<'a> {
    times: &'a [f64],
    foot: Foot<'a>,
    held: Held,
}

impl<'a> Standing<'a> {
    /// Finds what can be held. Cost: linear in samples times the places that a foot stands on within one contact.
    pub fn new(times: &'a [f64], leg: &'a LegTrack) -> Self {
        let foot = Foot::new(leg);
        let toes = toes(times, &foot, leg);
        let held = Held { heel: heels(times, &foot, leg, &toes), toe: spread(times.len(), &toes) };
        Self { times, foot, held }
    }

    /// What that asks of the captured foot. `fade`: seconds in which corrections vanish outside.
    pub fn pins(&self, fade: f64) -> Pins {
        let is_held = |places: &[Option<DVec3>]| places.iter().map(Option::is_some).collect();
        Pins {
            corrections: corrections(self.times, &self.foot, &self.held, fade),
            heel: is_held(&self.held.heel),
            toe: is_held(&self.held.toe),
        }
    }

    /// Lets go of what is held where it is `refused`, or of the held samples next to there; says whether there were any.
    pub fn release(&mut self, refused: &[bool]) -> bool {
        let held: Vec<bool> = self.held.any();
        let mut free = vec![false; held.len()];
        for (at, _) in refused.iter().enumerate().filter(|(_, refused)| **refused) {
            if held[at] {
                free[at] = true;
                continue;
            }
            let near = |other: &usize| (self.times[*other] - self.times[at]).abs() < NEARBY;
            let before = (0..at).rev().take_while(near).find(|&other| held[other]);
            let after = (at + 1..held.len()).take_while(near).find(|&other| held[other]);
            before.into_iter().chain(after).for_each(|other| free[other] = true);
        }
        for at in (0..free.len()).filter(|&at| free[at]) {
            (self.held.heel[at], self.held.toe[at]) = (None, None);
        }
        free.contains(&true)
    }
}

/// The captured foot, and what holding its points costs.
struct Foot<'a> {
    places: &'a [Place],
    heels: Vec<DVec3>,
    toes: Vec<DVec3>,
    heel_costs: Vec<Least>,
    toe_costs: Vec<Least>,
}

impl<'a> Foot<'a> {
    fn new(leg: &'a LegTrack) -> Self {
        let places = &leg.rest;
        let heels: Vec<DVec3> = places.iter().map(|place| place.limb.lower).collect();
        let toes: Vec<DVec3> = places.iter().map(|place| place.end).collect();
        let heel_costs = places.iter().map(|place| least(place, DVec3::ZERO)).collect();
        let toe_costs = places.iter().map(|place| least(place, place.end - place.limb.lower)).collect();
        Self { places, heels, toes, heel_costs, toe_costs }
    }

    /// What holds the toe alone at `place`: the shift of the ankle and the turn of the foot.
    fn to_toe(&self, at: usize, place: DVec3) -> Displacement {
        let turn = self.toe_costs[at].turn * (place - self.toes[at]);
        [self.shift_about(at, place, turn), turn]
    }

    /// The shift of the ankle with which the toe is at `place` and the foot turned by `turn`.
    fn shift_about(&self, at: usize, place: DVec3, turn: DVec3) -> DVec3 {
        place - exp(turn) * (self.toes[at] - self.heels[at]) - self.heels[at]
    }

    /// What holds the heel alone.
    fn to_heel(&self, at: usize, place: DVec3) -> Displacement {
        let shift = place - self.heels[at];
        [shift, self.heel_costs[at].turn * shift]
    }

    /// What holds both, as far from each other as they are on the foot.
    fn to_both(&self, at: usize, heel: DVec3, toe: DVec3) -> Displacement {
        let foot = self.toes[at] - self.heels[at];
        [heel - self.heels[at], log(minimal_rotation(foot, toe - heel))]
    }

    /// Whether no joint turns too far for it.
    fn affords(&self, at: usize, [shift, turn]: Displacement) -> bool {
        largest_turn(&self.places[at], shift, turn) < LARGEST_TURN
    }
}

/// A point held at a place.
#[derive(Clone, Copy, Debug)]
struct Hold {
    span: Span,
    place: DVec3,
}

/// Where heel and toe are held at each sample.
struct Held {
    heel: Vec<Option<DVec3>>,
    toe: Vec<Option<DVec3>>,
}

impl Held {
    fn any(&self) -> Vec<bool> {
        self.heel.iter().zip(&self.toe).map(|(heel, toe)| heel.is_some() || toe.is_some()).collect()
    }
}

fn spread(count: usize, holds: &[Hold]) -> Vec<Option<DVec3>> {
    let mut places = vec![None; count];
    for hold in holds {
        places[hold.span.first..=hold.span.last].fill(Some(hold.place));
    }
    places
}

/// Holds of the toe alone, in the order of time.
fn toes(times: &[f64], foot: &Foot, leg: &LegTrack) -> Vec<Hold> {
    let affords = |at: usize, place: DVec3| foot.affords(at, foot.to_toe(at, place));
    let place = |span: Span| least_turn(&foot.toe_costs, &foot.toes, span);
    let mut found = Vec::new();
    for (first, last) in runs(&leg.toe) {
        found.extend(holds(times, (&foot.toes, Span { first, last }), &place, &affords));
    }
    found
}

/// Where the heel is held: as far from a toe that is held as it is on the foot. From one toe's hold to the next is
/// sought apart.
fn heels(times: &[f64], foot: &Foot, leg: &LegTrack, toes: &[Hold]) -> Vec<Option<DVec3>> {
    let mut held = vec![None; times.len()];
    for (first, last) in runs(&leg.heel) {
        let of_toes = |hold: &&Hold| hold.span.first <= last && hold.span.last >= first;
        let mut from = first;
        let mut zones: Vec<(Span, Option<Hold>)> = Vec::new();
        for hold in toes.iter().filter(of_toes) {
            let until = hold.span.last.min(last);
            if from <= until {
                zones.push((Span { first: from, last: until }, Some(*hold)));
            }
            from = times.partition_point(|time| *time <= times[until] + BLEND);
        }
        if from <= last {
            zones.push((Span { first: from, last }, None));
        }
        for (zone, toe) in zones {
            for hold in heels_by(times, foot, zone, toe) {
                held[hold.span.first..=hold.span.last].fill(Some(hold.place));
            }
        }
    }
    held
}

/// Holds of the heel within `zone`, in which the toe is held by `toe` and otherwise free.
fn heels_by(times: &[f64], foot: &Foot, zone: Span, toe: Option<Hold>) -> Vec<Hold> {
    let at_toe = |at: usize| toe.filter(|toe| (toe.span.first..=toe.span.last).contains(&at));
    let affords = |at: usize, place: DVec3| {
        let displacement = match at_toe(at) {
            Some(toe) => foot.to_both(at, place, toe.place),
            None => foot.to_heel(at, place),
        };
        foot.affords(at, displacement)
    };
    let place = |span: Span| {
        let place = least_turn(&foot.heel_costs, &foot.heels, span);
        let Some(toe) = toe.filter(|toe| toe.span.first <= span.last) else { return place };
        let length = foot.heels[span.first].distance(foot.toes[span.first]);
        toe.place + (place - toe.place).normalize_or_zero() * length
    };
    holds(times, (&foot.heels, zone), &place, &affords)
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

/// What moves the captured foot so that its held points are where they are held.
fn corrections(times: &[f64], foot: &Foot, held: &Held, fade: f64) -> Vec<Displacement> {
    let any = held.any();
    let turns = turns(times, foot, held, &any);
    let mut shifts = vec![[DVec3::ZERO]; times.len()];
    for (at, shift) in shifts.iter_mut().enumerate() {
        *shift = [match (held.heel[at], held.toe[at]) {
            (Some(heel), _) => heel - foot.heels[at],
            (None, Some(toe)) => foot.shift_about(at, toe, turns[at][0]),
            (None, None) => DVec3::ZERO,
        }];
    }
    fill(times, &spans(&any), (fade, Slopes::Level), &mut shifts);
    let mut corrections: Vec<Displacement> =
        shifts.iter().zip(&turns).map(|(shift, turn)| [shift[0], turn[0]]).collect();
    for at in (0..times.len()).filter(|&at| !any[at]) {
        corrections[at] = afforded(&foot.places[at], corrections[at]);
    }
    corrections
}

/// By what the foot turns: where both points are held as these ask for, where one is as the joints like best, and without a
/// jump from one to the other.
fn turns(times: &[f64], foot: &Foot, held: &Held, any: &[bool]) -> Vec<[DVec3; 1]> {
    let best = |at: usize| match (held.heel[at], held.toe[at]) {
        (_, Some(toe)) => foot.to_toe(at, toe)[1],
        (Some(heel), None) => foot.to_heel(at, heel)[1],
        (None, None) => DVec3::ZERO,
    };
    let best: Vec<DVec3> = (0..times.len()).map(best).collect();
    let both: Vec<bool> =
        held.heel.iter().zip(&held.toe).map(|(heel, toe)| heel.is_some() && toe.is_some()).collect();
    let mut beyond = vec![[DVec3::ZERO]; times.len()];
    for (at, beyond) in beyond.iter_mut().enumerate() {
        if let (Some(heel), Some(toe)) = (held.heel[at], held.toe[at]) {
            *beyond = [foot.to_both(at, heel, toe)[1] - best[at]];
        }
    }
    fill(times, &spans(&both), (BLEND, Slopes::Level), &mut beyond);
    let mut turns: Vec<[DVec3; 1]> =
        best.iter().zip(&beyond).map(|(best, beyond)| [*best + beyond[0]]).collect();
    fill(times, &spans(any), (BLEND, Slopes::Level), &mut turns);
    turns
}

/// A displacement, or as much of it as turns no joint of the leg by more than [`LARGEST_TURN`]: a faded one is small, but a
/// leg may be stretched straight there.
fn afforded(place: &Place, [shift, turn]: Displacement) -> Displacement {
    let (mut afforded, mut refused) = (0.0, 1.0);
    if largest_turn(place, shift, turn) <= LARGEST_TURN {
        return [shift, turn];
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (afforded + refused);
        if largest_turn(place, shift * middle, turn * middle) <= LARGEST_TURN {
            afforded = middle;
        } else {
            refused = middle;
        }
    }
    [shift * afforded, turn * afforded]
}

/// Halvings of a share: to a millionth.
const HALVINGS: usize = 20;

/// The runs of `labels`.
pub fn spans(labels: &[bool]) -> Vec<Span> {
    runs(labels).into_iter().map(|(first, last)| Span { first, last }).collect()
}
