//! A small dense quadratic program with bounds, and its solution where chosen rows hold with equality.

use crate::error::BoundsError;
use nalgebra::{DMatrix, DVector};

/// A row is violated if it misses its bound by more, relative to the sizes of its terms.
pub(crate) const VIOLATION_TOLERANCE: f64 = 1e-11;
/// Residual of a dense solve, relative to its right-hand side, beyond which the matrix counts as singular.
const SOLVE_TOLERANCE: f64 = 1e-7;

/// `min ½xᵀGx − gᵀx` subject to `A x = b` and `C x ≥ d`.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundedQp {
    /// `G`: n × n, symmetric, positive definite on the null space of `A`.
    pub hessian: DMatrix<f64>,
    /// `g`.
    pub linear: DVector<f64>,
    /// `A`: full row rank.
    pub equalities: DMatrix<f64>,
    /// `b`.
    pub equality_targets: DVector<f64>,
    /// `C`.
    pub inequalities: DMatrix<f64>,
    /// `d`; −∞ for a row that bounds nothing.
    pub lower_bounds: DVector<f64>,
}

/// The minimiser.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundedSolution {
    /// `x`.
    pub x: Vec<f64>,
    /// Rows of `C` that hold with equality, in the order they were added.
    pub active: Vec<usize>,
    /// Their multipliers `u`: `G x − g = Aᵀν + Cᵀu`. Not negative, except after [`PaperIteration`](crate::BoundMethod).
    pub multipliers: Vec<f64>,
    /// Dense systems solved after the first.
    pub iterations: usize,
}

impl BoundedQp {
    /// `½xᵀGx − gᵀx`.
    pub fn objective(&self, x: &[f64]) -> f64 {
        let x = DVector::from_column_slice(x);
        0.5 * x.dot(&(&self.hessian * &x)) - self.linear.dot(&x)
    }

    /// `d_p − c_p x` if that is more than rounding.
    pub(crate) fn violation(&self, row: usize, x: &DVector<f64>) -> Option<f64> {
        let (mut missing, mut size) = (self.lower_bounds[row], self.lower_bounds[row].abs());
        for (c, x_j) in self.inequalities.row(row).iter().zip(x.iter()) {
            missing -= c * x_j;
            size += (c * x_j).abs();
        }
        (missing > VIOLATION_TOLERANCE * size).then_some(missing)
    }

    /// The most violated row and what it misses, first in the unit of the row's length.
    pub(crate) fn worst(&self, x: &DVector<f64>) -> Option<(usize, f64)> {
        let violated = (0..self.inequalities.nrows()).filter_map(|row| Some((row, self.violation(row, x)?)));
        let distance = |&(row, missing): &(usize, f64)| missing / self.inequalities.row(row).norm();
        violated.reduce(|a, b| if distance(&b) > distance(&a) { b } else { a })
    }

    /// Solves `G z + Aᵀv + C_Wᵀ w = f`, `A z = e`, `C_W z = e_W` for the rows `W`; returns `z` and `(v, w)`.
    pub(crate) fn solve_held(
        &self,
        held: &[usize],
        f: &DVector<f64>,
        e: &DVector<f64>,
    ) -> Result<(DVector<f64>, DVector<f64>), BoundsError> {
        let (n, equal) = (self.linear.len(), self.equality_targets.len());
        let size = n + equal + held.len();
        let mut kkt = DMatrix::zeros(size, size);
        kkt.view_mut((0, 0), (n, n)).copy_from(&self.hessian);
        let rows = self.equalities.row_iter().chain(held.iter().map(|&row| self.inequalities.row(row)));
        for (k, row) in rows.enumerate() {
            kkt.view_mut((n + k, 0), (1, n)).copy_from(&row);
            kkt.view_mut((0, n + k), (n, 1)).copy_from(&row.transpose());
        }
        let mut b = DVector::zeros(size);
        b.rows_mut(0, n).copy_from(f);
        b.rows_mut(n, equal + held.len()).copy_from(e);
        let lu = kkt.clone().lu();
        let mut x = lu.solve(&b).ok_or(BoundsError::Singular)?;
        if let Some(correction) = lu.solve(&(&b - &kkt * &x)) {
            x += correction;
        }
        let residual = (&b - &kkt * &x).amax();
        if !x.iter().all(|x| x.is_finite()) || residual > SOLVE_TOLERANCE * b.amax() {
            return Err(BoundsError::Singular);
        }
        Ok((x.rows(0, n).into_owned(), x.rows(n, size - n).into_owned()))
    }
}

/// Checks shapes and numbers of a program from outside.
pub(crate) fn check(qp: &BoundedQp) -> Result<(), BoundsError> {
    let n = qp.linear.len();
    check_block("G", &qp.hessian, (n, n), f64::is_finite)?;
    check_block("A", &qp.equalities, (qp.equality_targets.len(), n), f64::is_finite)?;
    check_block("C", &qp.inequalities, (qp.lower_bounds.len(), n), f64::is_finite)?;
    let column = |v: &DVector<f64>| DMatrix::from_column_slice(v.len(), 1, v.as_slice());
    check_block("g", &column(&qp.linear), (n, 1), f64::is_finite)?;
    check_block("b", &column(&qp.equality_targets), (qp.equality_targets.len(), 1), f64::is_finite)?;
    let bounds = column(&qp.lower_bounds);
    check_block("d", &bounds, (qp.lower_bounds.len(), 1), |d| d.is_finite() || d == f64::NEG_INFINITY)
}

fn check_block(
    block: &'static str,
    matrix: &DMatrix<f64>,
    (rows, columns): (usize, usize),
    allowed: fn(f64) -> bool,
) -> Result<(), BoundsError> {
    let (actual_rows, actual_columns) = matrix.shape();
    if (actual_rows, actual_columns) != (rows, columns) {
        return Err(BoundsError::ShapeMismatch { block, rows, columns, actual_rows, actual_columns });
    }
    match matrix.row_iter().position(|row| !row.iter().all(|&a| allowed(a))) {
        Some(row) => Err(BoundsError::NotFinite { block, row }),
        None => Ok(()),
    }
}
