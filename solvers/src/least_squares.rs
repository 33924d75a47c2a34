//! The problem: `min ½‖M x − m‖²` subject to `H x = h`.

use crate::scalar::Scalar;
use crate::sparse::multiply;
use sprs::CsMat;
use std::ops::Range;

/// Matrices of a least-squares problem with hard equality rows, both compressed by rows.
///
/// ```text
///     min ½‖M x − m‖²    subject to    H x = h
/// ```
///
/// The targets `m`, `h` are kept apart: they change from solve to solve while the matrices stay.
#[derive(Clone, Debug, PartialEq)]
pub struct LeastSquares<T> {
    /// Unknowns; columns of both matrices.
    pub columns: usize,
    /// `M`: soft rows, each already multiplied by the root of its weight.
    pub soft: CsMat<T>,
    /// `H`: hard rows. They must be linearly independent: see [`analyse_rank`](crate::analyse_rank).
    pub hard: CsMat<T>,
}

impl<T: Scalar> LeastSquares<T> {
    /// `m − M x`, one number per soft row.
    pub fn soft_residual(&self, x: &[T], m: &[T]) -> Vec<T> {
        subtract(m, &multiply(&self.soft, x))
    }

    /// `h − H x`, one number per hard row.
    pub fn hard_residual(&self, x: &[T], h: &[T]) -> Vec<T> {
        subtract(h, &multiply(&self.hard, x))
    }

    /// `½‖M x − m‖²`.
    pub fn energy(&self, x: &[T], m: &[T]) -> f64 {
        half_square(&self.soft_residual(x, m))
    }

    /// The share of some soft rows in [`energy`](Self::energy).
    ///
    /// # Panics
    /// If `rows` reaches past the last soft row.
    pub fn energy_of_rows(&self, rows: Range<usize>, x: &[T], m: &[T]) -> f64 {
        half_square(&self.soft_residual(x, m)[rows])
    }
}

/// `½ Σ |r_i|²`.
pub(crate) fn half_square<T: Scalar>(r: &[T]) -> f64 {
    0.5 * r.iter().map(|r_i| r_i.modulus_squared()).sum::<f64>()
}

fn subtract<T: Scalar>(a: &[T], b: &[T]) -> Vec<T> {
    debug_assert_eq!(a.len(), b.len(), "one target per row");
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}
