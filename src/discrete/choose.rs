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
/// nearer frames, then the earlier one. Differences of Ê that rounding could make are none: a walk that repeats itself exactly
/// offers cycles at one Ê, and neither the order of sums nor the way of solving may choose between them.
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
        let most = worth.min(near(least_high(&known, worth), settings.near_tie));
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

/// A difference in Ê of less, relative to 1 and Ê, is rounding: several times what estimates are off by. Less is no gain, as a
/// stand may become longer at no cost at all, and makes nothing better than another, whatever rounding says.
const NO_GAIN: f64 = 1e-7;

/// What Ê must be below to be worth a change, if it is `before` now.
pub fn worth(before: f64, settings: &DiscreteSettings) -> f64 {
    before * (1.0 - settings.least_gain) - settings.least_drop.max(NO_GAIN * (1.0 + before))
}

/// The best is no worse than this, of those that are worth it for sure.
fn least_high(known: &[Known], worth: f64) -> f64 {
    known.iter().map(|own| own.high).filter(|high| *high < worth).fold(f64::INFINITY, f64::min)
}

/// Up to here Ê is within a near tie of `energy`; at 0, up to here differences are rounding.
pub fn near(energy: f64, near_tie: f64) -> f64 {
    energy + near_tie + NO_GAIN * (1.0 + energy)
}

/// Weighs offers until it is sure which one is to be taken.
fn decide(
    offers: &[Offer],
    mut known: Vec<Known>,
    (worth, near_tie): (f64, f64),
    weigh: &(impl Fn(usize) -> Option<f64> + Sync),
) -> Option<Weighed> {
    loop {
        let most = near(least_high(&known, worth), near_tie);
        known.retain(|own| own.low <= most);
        let first = preferred(offers, &known, near_tie)?;
        let unsure: Vec<usize> = known
            .iter()
            .filter(|own| !own.is_weighed() && hangs_on(offers, own, (&known, worth), near_tie))
            .map(|own| own.place)
            .collect();
        if unsure.is_empty() {
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
    let least = |all: &[Known]| all.iter().map(Known::middle).fold(f64::INFINITY, f64::min);
    let most = near(least(known), near_tie);
    let near_best: Vec<Known> = known.iter().filter(|own| own.middle() <= most).copied().collect();
    let copies = near_best.iter().map(|own| offers[own.place].copies).min()?;
    let fewest: Vec<Known> = near_best.into_iter().filter(|own| offers[own.place].copies == copies).collect();
    let most = near(least(&fewest), 0.0);
    fewest.into_iter().filter(|own| own.middle() <= most).min_by(|a, b| {
        let distance = offers[a.place].distance.total_cmp(&offers[b.place].distance);
        distance.then(a.place.cmp(&b.place))
    })
}

/// Whether the choice may depend on where the Ê of `own` lies within what is known of it: about what is worth it, what is
/// near the best, or what ties with the best of those that repeat frames as little.
fn hangs_on(offers: &[Offer], own: &Known, (known, worth): (&[Known], f64), near_tie: f64) -> bool {
    let range = |of: &dyn Fn(&&Known) -> bool| {
        let own = known.iter().filter(of);
        own.fold((f64::INFINITY, f64::INFINITY), |(low, high), own| (low.min(own.low), high.min(own.high)))
    };
    let straddles = |(low, high): (f64, f64), near_tie: f64| {
        own.low <= near(high, near_tie) && own.high > near(low, near_tie)
    };
    let copies = offers[own.place].copies;
    let equals = range(&|other| offers[other.place].copies == copies);
    own.high >= worth || straddles(range(&|_| true), near_tie) || straddles(equals, 0.0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::scene::Mode;

    /// What solves in different ways are apart, relative to 1 and Ê: well within what estimates are off by.
    const OFF: f64 = 0.5 * ESTIMATE;

    /// Ê in hundredths, copies, distance, and how far off its estimate and its weight are.
    type Given = (u8, usize, u8, (f64, f64));

    fn given() -> impl Strategy<Value = Vec<Given>> {
        let off = -OFF..OFF;
        prop::collection::vec((0..30_u8, 1..3_usize, 0..2_u8, (off.clone(), off)), 1..20)
    }

    fn offers(given: &[Given]) -> Vec<Offer> {
        let offer = |(_, copies, distance, _): &Given| Offer {
            copies: *copies,
            distance: f64::from(*distance),
            bound: 0.0,
            last: None,
        };
        given.iter().map(offer).collect()
    }

    proptest! {
        /// Ê of many offers is the same, and differences of exactly a near tie occur.
        #[test]
        fn rounding_never_decides(given in given(), mode in prop::sample::select(vec![Mode::Paper, Mode::Production])) {
            let (offers, settings) = (offers(&given), DiscreteSettings::of(mode));
            let exact = |place: usize| f64::from(given[place].0) / 100.0;
            let estimate = |place: usize, _: (f64, f64)| Some(exact(place) + given[place].3.0 * (1.0 + exact(place)));
            let weigh = |place: usize| Some(exact(place) + given[place].3.1 * (1.0 + exact(place)));
            let expected = choose_by_all(&offers, 0.2, |place| Some(exact(place)), &settings);
            let scales = Scales { bound: |_: usize| 0.0, estimate, weigh };
            let chosen = choose(&offers, 0.2, &scales, &settings);
            prop_assert_eq!(chosen.map(|own| own.place), expected.map(|own| own.place));
            let weighed = choose_by_all(&offers, 0.2, weigh, &settings);
            prop_assert_eq!(weighed.map(|own| own.place), expected.map(|own| own.place));
        }
    }

    #[test]
    fn of_equal_offers_the_nearest_and_then_the_first_is_taken_and_none_is_weighed() {
        let offers: Vec<Offer> =
            [2.0, 1.0, 1.0].map(|distance| Offer { copies: 1, distance, bound: 0.0, last: None }).into();
        let estimates = [0.1 - 1e-9, 0.1 + 1e-9, 0.1];
        let scales = Scales {
            bound: |_: usize| 0.0,
            estimate: |place: usize, _: (f64, f64)| Some(estimates[place]),
            weigh: |_: usize| -> Option<f64> { panic!("estimates suffice") },
        };
        let chosen = choose(&offers, 1.0, &scales, &DiscreteSettings::of(Mode::Paper));
        assert_eq!(chosen.map(|own| own.place), Some(1));
    }
}
