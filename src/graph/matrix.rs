//! Distances of many pairs of frames as one matrix product, to rounding.

use std::ops::Range;

use cotillion_solvers::DMatrix;

use crate::similarity::Features;

/// Frames as columns whose products are squared distances.
///
/// ```text
///     a = [−2f, |f|², 1],   b = [g, 1, |g|²]   ⇒   a·b = |f|² − 2f·g + |g|² = |f − g|²
/// ```
#[derive(Clone, Debug)]
pub(super) struct Factors {
    /// `a` of every frame, a row each.
    left: DMatrix<f64>,
    /// `b` of every frame, a column each.
    right: DMatrix<f64>,
    /// Largest |f|².
    largest_sq: f64,
}

impl Factors {
    /// Cost: linear in frames times features.
    pub(super) fn new(features: &Features) -> Self {
        let (width, frames) = (features.width, features.values.len() / features.width);
        let norms: Vec<f64> =
            (0..frames).map(|frame| features.frame(frame).iter().map(|value| value * value).sum()).collect();
        let left = DMatrix::from_fn(frames, width + 2, |frame, k| match k {
            k if k < width => -2.0 * features.frame(frame)[k],
            k if k == width => norms[frame],
            _ => 1.0,
        });
        let right = DMatrix::from_fn(width + 2, frames, |k, frame| match k {
            k if k < width => features.frame(frame)[k],
            k if k == width => 1.0,
            _ => norms[frame],
        });
        Self { left, right, largest_sq: norms.into_iter().fold(0.0, f64::max) }
    }

    /// Squared distances of frames `rows` to frames `columns` of `other`, one matrix product.
    pub(super) fn distances_sq(
        &self,
        rows: Range<usize>,
        other: &Self,
        columns: Range<usize>,
    ) -> DMatrix<f64> {
        self.left.rows_range(rows) * other.right.columns_range(columns)
    }

    /// How far an entry of [`Self::distances_sq`] may lie from the exact sum of squares, and that sum from its own rounding.
    ///
    /// A product of n terms rounds by at most `n·ε·Σ|aₖbₖ|` however it is ordered, with Σ ≤ 2(|f|² + |g|²); the norms round by
    /// as much again, the sum of squares by less. (Higham, *Accuracy and Stability of Numerical Algorithms*, §3.1.)
    pub(super) fn rounding(&self, other: &Self) -> f64 {
        4.0 * (self.right.nrows() as f64 + 8.0) * f64::EPSILON * (self.largest_sq + other.largest_sq)
    }
}
