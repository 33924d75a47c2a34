//! The choice: of all offers the one with the least energy, found without weighing those that cannot win.

use rayon::prelude::*;

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
    /// About what Ê was when it was last estimated: what comes first.
    pub last: Option<f64>,
}

/// An offer and its Ê.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighed {
    /// Which offer.
    pub place: usize,
    /// Its Ê, to rounding if nothing hangs on it.
    pub energy: f64,
}

/// Ways to find out about the Ê of an offer, cheap ones first.
pub struct Scales<B, E, W> {
    /// At least this.
    pub bound: B,
    /// Ê to rounding, given a bound and how much is of interest; `None` where it cannot be said beforehand.
    pub estimate: E,
    /// Ê; `None` where it cannot be solved.
    pub weigh: W,
}

/// So many offers are estimated at once: on any number of threads the same ones.
const BATCH: usize = 4;
/// Estimates are off by no more than this, relative to 1 and themselves: they are refined to rounding, which stiff rows close
/// together make worse than it should be.
const ESTIMATE: f64 = 1e-8;

/// What is known of the Ê of an offer: it lies between these; they are one once it is weighed.
#[derive(Clone, Copy, Debug)]
struct Known {
    place: usize,
    low: f64,
    high: f64,
}

impl Known {
    fn weighed(place: usize, energy: f64) -> Self {
        Self { place, low: energy, high: energy }
    }

    fn estimated(place: usize, energy: f64) -> Self {
        let margin = ESTIMATE * (1.0 + energy);
        Self { place, low: energy - margin, high: energy + margin }
    }

    fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }

    fn is_weighed(&self) -> bool {
        self.low == self.high
    }
}

/// The offer to take, if one is worth it: its Ê is below `before` by the least relative and absolute gain of the settings.
/// Among those within a near tie of the best, the one that repeats frames least, then the one with less Ê, then with
/// nearer frames, then the earlier one.
///
/// Offers that could be worth it get a sharper bound first, then they are estimated, the most promising first; those whose
/// bound lies above the best by more than a near tie cannot win. Those that the choice hangs on are weighed, so that it is the
/// same as if all were.
pub fn choose(
    offers: &[Offer],
    before: f64,
    scales: &Scales<
        impl Fn(usize) -> f64 + Sync,
        impl Fn(usize, (f64, f64)) -> Option<f64> + Sync,
        impl Fn(usize) -> Option<f64> + Sync,
    >,
    settings: &DiscreteSettings,
) -> Option<Weighed> {
    let worth = worth(before, settings);
    let hopeful: Vec<usize> = (0..offers.len()).filter(|place| offers[*place].bound < worth).collect();
    let sharper = |place: &usize| ((scales.bound)(*place).max(offers[*place].bound), *place);
    let mut order: Vec<(f64, usize)> = hopeful.par_iter().map(sharper).collect();
    let expected =
        |(bound, place): &(f64, usize)| offers[*place].last.map_or(*bound, |last| last.max(*bound));
    order.sort_by(|a, b| expected(a).total_cmp(&expected(b)).then(a.1.cmp(&b.1)));
    let estimate = |(bound, place): &(f64, usize), most: f64| match (scales.estimate)(*place, (*bound, most))
    {
        Some(energy) => energy.is_finite().then(|| Known::estimated(*place, energy)),
        None => (scales.weigh)(*place).map(|energy| Known::weighed(*place, energy)),
    };
    let mut known: Vec<Known> = Vec::new();
    for batch in order.chunks(BATCH) {
        let most = worth.min(least_high(&known, worth) + settings.near_tie);
        let open: Vec<(f64, usize)> = batch.iter().filter(|(bound, _)| *bound <= most).copied().collect();
        let most = most + ESTIMATE * (1.0 + most);
        let found: Vec<Option<Known>> = open.par_iter().map(|own| estimate(own, most)).collect();
        known.extend(found.into_iter().flatten().filter(|own| own.low < worth));
    }
    decide(offers, known, (worth, settings.near_tie), &scales.weigh)
}

/// The same by weighing all: for more work.
pub fn choose_by_all(
    offers: &[Offer],
    before: f64,
    weigh: impl Fn(usize) -> Option<f64> + Sync,
    settings: &DiscreteSettings,
) -> Option<Weighed> {
    let worth = worth(before, settings);
    let all: Vec<usize> = (0..offers.len()).collect();
    let energies: Vec<Option<f64>> = all.par_iter().map(|place| weigh(*place)).collect();
    let weighed = all.into_iter().zip(energies).filter_map(|(place, energy)| {
        energy.filter(|energy| *energy < worth).map(|energy| Known::weighed(place, energy))
    });
    decide(offers, weighed.collect(), (worth, settings.near_tie), &weigh)
}

/// A gain in Ê of less, relative to 1 and Ê, is rounding: several times what estimates are off by, as a stand may become longer
/// at no cost at all, whatever rounding says.
const NO_GAIN: f64 = 1e-7;

/// What Ê must be below to be worth a change, if it is `before` now.
pub fn worth(before: f64, settings: &DiscreteSettings) -> f64 {
    before * (1.0 - settings.least_gain) - settings.least_drop.max(NO_GAIN * (1.0 + before))
}

/// The best is no worse than this, of those that are worth it for sure.
fn least_high(known: &[Known], worth: f64) -> f64 {
    known.iter().map(|own| own.high).filter(|high| *high < worth).fold(f64::INFINITY, f64::min)
}

/// Weighs offers until it is sure which one is to be taken.
fn decide(
    offers: &[Offer],
    mut known: Vec<Known>,
    (worth, near_tie): (f64, f64),
    weigh: &(impl Fn(usize) -> Option<f64> + Sync),
) -> Option<Weighed> {
    loop {
        let most = least_high(&known, worth) + near_tie;
        known.retain(|own| own.low <= most);
        let first = preferred(offers, &known, near_tie)?;
        let unsure: Vec<usize> = known
            .iter()
            .filter(|own| !own.is_weighed() && hangs_on(offers, own, &first, near_tie))
            .map(|own| own.place)
            .collect();
        let sure = first.high < worth && unsure.iter().all(|place| *place == first.place);
        if sure {
            return Some(Weighed { place: first.place, energy: first.middle() });
        }
        let energies: Vec<Option<f64>> = unsure.par_iter().map(|place| weigh(*place)).collect();
        known.retain(|own| !unsure.contains(&own.place));
        for (place, energy) in unsure.into_iter().zip(energies) {
            known.extend(energy.filter(|energy| *energy < worth).map(|energy| Known::weighed(place, energy)));
        }
    }
}

/// The one to take if every Ê were in the middle of what is known of it.
fn preferred(offers: &[Offer], known: &[Known], near_tie: f64) -> Option<Known> {
    let best = known.iter().map(Known::middle).fold(f64::INFINITY, f64::min);
    let near = known.iter().filter(|own| own.middle() <= best + near_tie).copied();
    near.min_by(|a, b| {
        let (left, right) = (&offers[a.place], &offers[b.place]);
        let repeats = left.copies.cmp(&right.copies);
        let distance = left.distance.total_cmp(&right.distance);
        repeats.then(a.middle().total_cmp(&b.middle())).then(distance).then(a.place.cmp(&b.place))
    })
}

/// Whether the exact Ê of `own` could take the place of `first` from it.
fn hangs_on(offers: &[Offer], own: &Known, first: &Known, near_tie: f64) -> bool {
    let (copies, least) = (offers[own.place].copies, offers[first.place].copies);
    let fewer = copies < least;
    let nearer = copies == least && own.low <= first.high;
    let leaves_behind = own.low + near_tie < first.high;
    own.place == first.place || fewer || nearer || leaves_behind
}
