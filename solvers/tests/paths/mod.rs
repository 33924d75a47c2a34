//! Paths and rows that tests share.

use cotillion_solvers::{ChainRow, c64};
use proptest::prelude::*;

pub(crate) const ONE: c64 = c64::new(1.0, 0.0);

/// Random problems have positions below about 10, and conditions below about 1e5.
pub(crate) const ROUNDING: f64 = 1e-9;

/// A path whose points all differ.
pub(crate) fn wavy_path(count: usize) -> Vec<c64> {
    (0..count)
        .map(|i| c64::new(0.05 * i as f64, 0.3 * (0.11 * i as f64).sin() + 0.02 * (i as f64).cos()))
        .collect()
}

pub(crate) fn second_differences(count: usize) -> Vec<ChainRow> {
    vec![[ONE, -2.0 * ONE, ONE]; count]
}

pub(crate) fn number() -> impl Strategy<Value = c64> {
    (-1.0..1.0_f64, -1.0..1.0_f64).prop_map(|(re, im)| c64::new(re, im))
}

/// Rows like those of paths, with coefficients off by up to a half, and targets.
pub(crate) fn rows(
    count: impl Into<prop::collection::SizeRange>,
) -> impl Strategy<Value = (Vec<ChainRow>, Vec<c64>)> {
    let row = [number(), number(), number()]
        .prop_map(|[a, b, c]| [-0.5 * ONE + 0.3 * a, ONE + 0.3 * b, -0.5 * ONE + 0.3 * c]);
    prop::collection::vec((row, number()), count).prop_map(|rows| rows.into_iter().unzip())
}

/// Points of two pairs.
pub(crate) fn probes() -> impl Strategy<Value = Vec<[c64; 4]>> {
    prop::collection::vec([number(), number(), number(), number()], 8)
}
