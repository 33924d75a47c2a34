//! The choice: of all offers the one with the least energy, found without weighing those that cannot win.

use rayon::prelude::*;

use crate::constraint::Evaluator;
use crate::discrete::settings::DiscreteSettings;

/// What is known of a candidate beforehand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offer {
    /// How often it would show one source frame at most.
    pub copies: usize,
    /// Largest distance of the frames matched at its seams.
    pub distance: f64,
    /// Ê is at least this, which costs nothing to know.
    pub bound: f64,
}

/// An offer and its Ê.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighed {
    /// Which offer.
    pub place: usize,
    /// Its Ê.
    pub energy: f64,
}

/// So many offers are weighed at once: on any number of threads the same ones.
const BATCH: usize = 4;

/// The offer to take, if one is worth it: its Ê is below `before` by the least relative and absolute gain of the settings.
/// Among those within a near tie of the best, the one that repeats frames least, then the one with less Ê, then with
/// nearer frames, then the earlier one.
///
/// Offers that could be worth it get a sharper bound first, then they are weighed in rising order of it until the next
/// bound lies above the best by more than a near tie: what is left cannot win. The brute-force evaluator weighs all, with the
/// same result. `bound`, `weigh`: sharper bound and Ê of an offer; `None` where that cannot be solved.
pub fn choose(
    offers: Vec<Offer>,
    before: f64,
    (bound, weigh): (impl Fn(usize) -> f64 + Sync, impl Fn(usize) -> Option<f64> + Sync),
    settings: &DiscreteSettings,
) -> Option<Weighed> {
    let worth = before * (1.0 - settings.least_gain) - settings.least_drop;
    let all = settings.evaluator == Evaluator::BruteForce;
    let hopeful: Vec<usize> = (0..offers.len()).filter(|place| all || offers[*place].bound < worth).collect();
    let sharper = |place: &usize| {
        let known = offers[*place].bound;
        (if all { known } else { bound(*place).max(known) }, *place)
    };
    let mut order: Vec<(f64, usize)> = hopeful.par_iter().map(sharper).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut weighed: Vec<Weighed> = Vec::new();
    let mut best = f64::INFINITY;
    for batch in order.chunks(BATCH) {
        let hopeless = |bound: f64| !all && (bound > best + settings.near_tie || bound >= worth);
        let open: Vec<usize> =
            batch.iter().filter(|(bound, _)| !hopeless(*bound)).map(|(_, place)| *place).collect();
        if open.is_empty() {
            break;
        }
        let energies: Vec<Option<f64>> = open.par_iter().map(|place| weigh(*place)).collect();
        for (place, energy) in open.into_iter().zip(energies) {
            if let Some(energy) = energy.filter(|energy| *energy < worth) {
                best = best.min(energy);
                weighed.push(Weighed { place, energy });
            }
        }
    }
    weighed.into_iter().filter(|own| own.energy <= best + settings.near_tie).min_by(|a, b| {
        let (left, right) = (&offers[a.place], &offers[b.place]);
        let repeats = left.copies.cmp(&right.copies);
        let distance = left.distance.total_cmp(&right.distance);
        repeats.then(a.energy.total_cmp(&b.energy)).then(distance).then(a.place.cmp(&b.place))
    })
}
