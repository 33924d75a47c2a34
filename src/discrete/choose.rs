//! The choice: of all offers the one with the least energy, found without weighing those that cannot win.

use crate::constraint::Evaluator;
use crate::discrete::candidates::Candidate;
use crate::discrete::settings::DiscreteSettings;

/// A candidate and what is known of it beforehand.
#[derive(Clone, Debug, PartialEq)]
pub struct Offer {
    /// What would happen.
    pub candidate: Candidate,
    /// Ê is at least this.
    pub bound: f64,
    /// How often it would show one source frame at most.
    pub copies: usize,
}

/// An offer and its Ê.
#[derive(Clone, Debug, PartialEq)]
pub struct Weighed {
    /// Which.
    pub offer: Offer,
    /// Its Ê.
    pub energy: f64,
}

/// The offer to take, if one is worth it: its Ê is below `before` by the least relative and absolute gain of the settings.
/// Among those within a near tie of the best, the one that repeats frames least, then the one with less Ê, then with
/// nearer frames, then the earlier one.
///
/// Offers are weighed by `weigh` in rising order of their bound until the next bound lies above the best by more than a near
/// tie: what is left cannot win. The brute-force evaluator weighs all, with the same result.
pub fn choose(
    mut offers: Vec<Offer>,
    before: f64,
    weigh: impl Fn(&Offer) -> Option<f64>,
    settings: &DiscreteSettings,
) -> Option<Weighed> {
    let worth = before * (1.0 - settings.least_gain) - settings.least_drop;
    let accepted = |energy: f64| energy < worth;
    let mut order: Vec<usize> = (0..offers.len()).collect();
    order.sort_by(|a, b| offers[*a].bound.total_cmp(&offers[*b].bound).then(a.cmp(b)));
    let mut weighed: Vec<(usize, f64)> = Vec::new();
    let mut best = f64::INFINITY;
    for place in order {
        let bound = offers[place].bound;
        let hopeless = bound > best + settings.near_tie || bound >= worth;
        if hopeless && settings.evaluator != Evaluator::BruteForce {
            break;
        }
        if let Some(energy) = weigh(&offers[place]).filter(|energy| accepted(*energy)) {
            best = best.min(energy);
            weighed.push((place, energy));
        }
    }
    let near = weighed.into_iter().filter(|(_, energy)| *energy <= best + settings.near_tie);
    let (place, energy) = near.min_by(|(a, x), (b, y)| {
        let (left, right) = (&offers[*a], &offers[*b]);
        let repeats = left.copies.cmp(&right.copies);
        let distance = left.candidate.distance.total_cmp(&right.candidate.distance);
        repeats.then(x.total_cmp(y)).then(distance).then(a.cmp(b))
    })?;
    Some(Weighed { offer: offers.swap_remove(place), energy })
}
