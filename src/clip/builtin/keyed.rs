//! Numbers that change in time between keys: quintic pieces, with continuous speed and acceleration.

/// What a number is at one instant, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Key {
    pub(super) time: f64,
    pub(super) value: f64,
    /// Per second.
    pub(super) rate: f64,
    /// Per second squared.
    pub(super) acceleration: f64,
}

impl Key {
    /// At rest.
    pub(super) const fn still(time: f64, value: f64) -> Self {
        Self { time, value, rate: 0.0, acceleration: 0.0 }
    }
}

/// A number in time; before its first key and after its last it keeps their values.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    /// At least one, in the order of time.
    keys: Vec<Key>,
}

impl Curve {
    pub(super) fn constant(value: f64) -> Self {
        Self { keys: vec![Key::still(0.0, value)] }
    }

    /// Through keys with their own rates.
    pub(super) fn new(keys: Vec<Key>) -> Self {
        debug_assert!(!keys.is_empty() && keys.is_sorted_by(|a, b| a.time < b.time));
        Self { keys }
    }

    /// Through `(time, value)`: at rest at both ends, without a rest where it turns back, never beyond its keys.
    ///
    /// Rates are the weighted harmonic means of the neighbouring slopes; where it turns back, the acceleration is that of
    /// the flatter of the two cubic pieces.
    /// Source of the rates: Fritsch & Butland, *SIAM J. Sci. Stat. Comput.* 5 (1984), 300–304.
    pub(super) fn through(points: &[(f64, f64)]) -> Self {
        let key = |index: usize| match (index.checked_sub(1), points.get(index + 1)) {
            (Some(before), Some(after)) => passing([points[before], points[index], *after]),
            _ => Key::still(points[index].0, points[index].1),
        };
        Self::new((0..points.len()).map(key).collect())
    }

    /// Through `(time, value)` with these rates at both ends.
    pub(super) fn between(points: &[(f64, f64)], rates: [f64; 2]) -> Self {
        let mut curve = Self::through(points);
        if let [first, .., last] = curve.keys.as_mut_slice() {
            (first.rate, last.rate) = (rates[0], rates[1]);
        }
        curve
    }

    /// Value at `time`.
    pub(super) fn at(&self, time: f64) -> f64 {
        let after = self.keys.partition_point(|key| key.time <= time);
        match (after.checked_sub(1).map(|before| self.keys[before]), self.keys.get(after)) {
            (Some(from), Some(to)) => quintic(from, *to, time),
            (Some(last), None) => last.value,
            (None, _) => self.keys[0].value,
        }
    }
}

/// Key at the middle of three points.
fn passing(points: [(f64, f64); 3]) -> Key {
    let [first, second] = [0, 1].map(|k| points[k + 1].0 - points[k].0);
    let [before, after] = [0, 1].map(|k| (points[k + 1].1 - points[k].1) / (points[k + 1].0 - points[k].0));
    let key = Key::still(points[1].0, points[1].1);
    if before * after <= 0.0 {
        let curvature = (6.0 * before / first).abs().min((6.0 * after / second).abs());
        return Key { acceleration: curvature * (after - before).signum(), ..key };
    }
    let share = (first + 2.0 * second) / (3.0 * (first + second));
    Key { rate: before * after / (share * after + (1.0 - share) * before), ..key }
}

/// The polynomial of degree five with the values, rates and accelerations of two keys.
fn quintic(from: Key, to: Key, time: f64) -> f64 {
    let span = to.time - from.time;
    let u = (time - from.time) / span;
    let gain = to.value - from.value;
    let (v, w) = (from.rate * span, to.rate * span);
    let (a, b) = (0.5 * from.acceleration * span * span, 0.5 * to.acceleration * span * span);
    let third = 10.0 * gain - 6.0 * v - 4.0 * w - 3.0 * a + b;
    let fourth = -15.0 * gain + 8.0 * v + 7.0 * w + 3.0 * a - 2.0 * b;
    let fifth = 6.0 * gain - 3.0 * (v + w) - a + b;
    from.value + u * (v + u * (a + u * (third + u * (fourth + u * fifth))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Rounding of a polynomial of small numbers.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn a_fall_between_two_keys_is_a_parabola() {
        let fall = |time: f64| 1.0 + 2.0 * time - 4.905 * time * time;
        let key = |time: f64| Key { time, value: fall(time), rate: 2.0 - 9.81 * time, acceleration: -9.81 };
        let curve = Curve::new(vec![key(0.1), key(0.6)]);
        for k in 0..=10 {
            let time = 0.1 + 0.05 * f64::from(k);
            assert!((curve.at(time) - fall(time)).abs() < ROUNDING);
        }
    }

    #[test]
    fn ends_keep_their_values() {
        let curve = Curve::through(&[(0.5, 1.0), (1.0, 2.0), (2.0, 2.5)]);
        assert_eq!([0.0, 0.5, 1.0, 2.0, 9.0].map(|time| curve.at(time)), [1.0, 1.0, 2.0, 2.5, 2.5]);
        assert_eq!(Curve::constant(3.0).at(-1.0), 3.0);
    }

    proptest! {
        #[test]
        fn rates_and_accelerations_do_not_jump_at_keys(values in prop::collection::vec(-1.0..1.0_f64, 3..7)) {
            const STEP: f64 = 1e-4;
            /// Third derivatives stay below 60 × 2 a second cubed with keys a second apart.
            const JUMP: f64 = 400.0 * STEP;
            let points: Vec<_> = values.iter().enumerate().map(|(k, value)| (k as f64, *value)).collect();
            let curve = Curve::through(&points);
            for (time, _) in &points {
                let [a, b, c, d, e] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| curve.at(time + k * STEP));
                prop_assert!(((c - b) / STEP - (d - c) / STEP).abs() < JUMP);
                prop_assert!((a - 2.0 * b + c - (c - 2.0 * d + e)).abs() / STEP / STEP < JUMP);
            }
        }

        #[test]
        fn a_curve_stays_within_neighbouring_keys(values in prop::collection::vec(-1.0..1.0_f64, 3..7)) {
            let points: Vec<_> = values.iter().enumerate().map(|(k, value)| (k as f64, *value)).collect();
            let curve = Curve::through(&points);
            for (k, pair) in values.windows(2).enumerate() {
                let (low, high) = (pair[0].min(pair[1]) - ROUNDING, pair[0].max(pair[1]) + ROUNDING);
                for step in 0..=20 {
                    let value = curve.at(k as f64 + f64::from(step) / 20.0);
                    prop_assert!((low..=high).contains(&value), "{value} of {low} to {high}");
                }
            }
        }
    }
}
