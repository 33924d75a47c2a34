//! Feet held perfectly still: what that asks of the captured foot.
//!
//! A foot lands on its heel, comes down, and rolls off over its toe: its heel's contact lasts until the ankle is a hand's
//! breadth up, and old captures drift by centimetres. Of each contact is held what can be without turning any joint too
//! far, at places that turn the joints of the leg least: one point hands over to the other.

use glam::DVec3;

use crate::clip::contacts::runs;
use crate::full_body::fade::{Slopes, Span, fill};
use crate::full_body::holding::{BLEND, Foot, Held, held};
use crate::full_body::plants::{Displacement, LegTrack};
use crate::full_body::turning::largest_turn;
use crate::full_body::whole::{raise, whole};

/// A strained leg is held otherwise within this time, seconds.
const NEARBY: f64 = 10.0 / 30.0;

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
    /// When heel or toe bears, where contacts are held all along.
    whole: Option<Vec<bool>>,
}

impl<'a> Standing<'a> {
    /// What can be held while no joint turns farther than `largest_turn`, radians. Cost: linear in samples times the
    /// places that a foot stands on within one contact.
    pub fn gentle(times: &'a [f64], leg: &'a LegTrack, largest_turn: f64) -> Self {
        let foot = Foot::new(leg, largest_turn);
        let held = held(times, &foot, leg);
        Self { times, foot, held, whole: None }
    }

    /// All contacts from their first sample to their last, however far joints turn. Cost: linear.
    pub fn whole(times: &'a [f64], leg: &'a LegTrack) -> Self {
        let foot = Foot::new(leg, f64::INFINITY);
        let held = whole(&foot, leg);
        Self { times, foot, held, whole: Some(leg.bears()) }
    }

    /// What that asks of the captured foot. `fade`: seconds in which corrections vanish outside.
    pub fn pins(&self, fade: f64) -> Pins {
        let is_held = |places: &[Option<DVec3>]| places.iter().map(Option::is_some).collect();
        let slopes = if self.whole.is_some() { Slopes::Kept } else { Slopes::Level };
        let mut corrections = corrections(self.times, &self.foot, &self.held, (fade, slopes));
        if let Some(bears) = &self.whole {
            raise(&self.foot, (&self.held, bears), &mut corrections);
        }
        Pins { corrections, heel: is_held(&self.held.heel), toe: is_held(&self.held.toe) }
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

/// What moves the captured foot so that its held points are where they are held, with `slopes` in `fade` seconds from one to the next.
fn corrections(times: &[f64], foot: &Foot, held: &Held, (fade, slopes): (f64, Slopes)) -> Vec<Displacement> {
    let any = held.any();
    let turns = turns(times, foot, (held, &any), slopes);
    let mut shifts = vec![[DVec3::ZERO]; times.len()];
    for (at, shift) in shifts.iter_mut().enumerate() {
        *shift = [match (held.heel[at], held.toe[at]) {
            (Some(heel), _) => heel - foot.heels[at],
            (None, Some(toe)) => foot.shift_about(at, toe, turns[at][0]),
            (None, None) => DVec3::ZERO,
        }];
    }
    fill(times, &spans(&any), (fade, slopes), &mut shifts);
    let mut corrections: Vec<Displacement> =
        shifts.iter().zip(&turns).map(|(shift, turn)| [shift[0], turn[0]]).collect();
    for at in (0..times.len()).filter(|&at| !any[at]) {
        corrections[at] = afforded(foot, at, corrections[at]);
    }
    corrections
}

/// By what the foot turns: where both points are held as these ask for, where one is as the joints like best, and without a
/// jump from one to the other.
fn turns(times: &[f64], foot: &Foot, (held, any): (&Held, &[bool]), slopes: Slopes) -> Vec<[DVec3; 1]> {
    let both: Vec<bool> =
        held.heel.iter().zip(&held.toe).map(|(heel, toe)| heel.is_some() && toe.is_some()).collect();
    let best = best_turns(times, foot, held, &both);
    let mut beyond = vec![[DVec3::ZERO]; times.len()];
    for (at, beyond) in beyond.iter_mut().enumerate() {
        if let (Some(heel), Some(toe)) = (held.heel[at], held.toe[at]) {
            *beyond = [foot.to_both(at, heel, toe)[1] - best[at]];
        }
    }
    fill(times, &spans(&both), (BLEND, slopes), &mut beyond);
    let mut turns: Vec<[DVec3; 1]> =
        best.iter().zip(&beyond).map(|(best, beyond)| [*best + beyond[0]]).collect();
    fill(times, &spans(any), (BLEND, slopes), &mut turns);
    turns
}

/// By what the foot turns as the joints like best: about the one point that is held; where `both` are, from what suits the one held
/// alone before to what suits the one held alone after.
fn best_turns(times: &[f64], foot: &Foot, held: &Held, both: &[bool]) -> Vec<DVec3> {
    let by_heel = |at: usize| held.heel[at].map(|heel| foot.to_heel(at, heel)[1]);
    let by_toe = |at: usize| held.toe[at].map(|toe| foot.to_toe(at, toe)[1]);
    let mut best: Vec<DVec3> =
        (0..times.len()).map(|at| by_toe(at).or_else(|| by_heel(at)).unwrap_or(DVec3::ZERO)).collect();
    let is_heel = |at: usize| held.any_at(at).then(|| held.toe[at].is_none());
    for Span { first, last } in spans(both) {
        let before = first.checked_sub(1).and_then(is_heel);
        let after = (last + 1 < times.len()).then_some(last + 1).and_then(is_heel);
        let heel_share = |is_heel: Option<bool>| if is_heel == Some(true) { 1.0 } else { 0.0 };
        let [early, late] = [before.or(after), after.or(before)].map(heel_share);
        for at in first..=last {
            let passed = (times[at] - times[first]) / (times[last] - times[first]).max(f64::MIN_POSITIVE);
            let share = early + (late - early) * passed;
            if let (Some(heel), Some(toe)) = (by_heel(at), by_toe(at)) {
                best[at] = heel * share + toe * (1.0 - share);
            }
        }
    }
    best
}

/// A displacement, or as much of it as turns no joint of the leg too far: a faded one is small, but a
/// leg may be stretched straight there.
fn afforded(foot: &Foot, at: usize, [shift, turn]: Displacement) -> Displacement {
    let affords =
        |share: f64| largest_turn(&foot.places[at], shift * share, turn * share) <= foot.largest_turn;
    let (mut afforded, mut refused) = (0.0, 1.0);
    if affords(1.0) {
        return [shift, turn];
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (afforded + refused);
        if affords(middle) {
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
