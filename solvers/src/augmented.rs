//! Entries of the augmented systems, and checks of what goes into them. Their mathematics: [`kkt`](crate::kkt).

use crate::error::KktError;
use crate::least_squares::LeastSquares;
use crate::scalar::Scalar;
use crate::stretch::{Stretched, power_of_two_below};
use sprs::CsMat;

/// `α`: small against the squared singular values of a scaled `M` that matter, large against rounding.
pub(crate) const ALPHA: f64 = 1.0 / 1024.0;

/// Which system of linear equations stands for the problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum KktForm {
    /// Residual as unknown; accurate.
    #[default]
    Hachtel,
    /// `MᴴM` formed; smaller, with the squared condition number.
    NormalEquations,
}

/// Row starts and column indices of a matrix compressed by rows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RowPattern(Vec<usize>, Vec<usize>);

/// Where the blocks begin in the augmented system of the stretched problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Layout {
    pub(crate) unknowns: usize,
    pub(crate) multipliers: usize,
    pub(crate) size: usize,
}

impl Layout {
    pub(crate) fn new<T: Scalar>(stretched: &Stretched<T>, form: KktForm) -> Self {
        let unknowns = match form {
            KktForm::Hachtel => stretched.soft.rows(),
            KktForm::NormalEquations => 0,
        };
        let multipliers = unknowns + stretched.soft.columns();
        Self { unknowns, multipliers, size: multipliers + stretched.hard.rows() }
    }
}

impl RowPattern {
    pub(crate) fn of<T>(matrix: &CsMat<T>) -> Self {
        Self(matrix.indptr().to_proper().to_vec(), matrix.indices().to_vec())
    }

    fn fits<T>(&self, matrix: &CsMat<T>) -> bool {
        *self.0 == *matrix.indptr().to_proper() && self.1 == matrix.indices()
    }
}

/// Calls `visit` with place and value of every entry of the scaled system, always in the same order.
pub(crate) fn visit_entries<T: Scalar>(
    form: KktForm,
    Layout { unknowns, multipliers, .. }: Layout,
    (soft, soft_scales): (&CsMat<T>, &[f64]),
    (hard, hard_scales): (&CsMat<T>, &[f64]),
    mut visit: impl FnMut((usize, usize), T),
) {
    for (i, (row, &d)) in soft.outer_iterator().zip(soft_scales).enumerate() {
        match form {
            KktForm::Hachtel => {
                visit((i, i), T::from_real(ALPHA * d * d));
                for (j, &a) in row.iter() {
                    visit((i, unknowns + j), a.scale(d));
                    visit((unknowns + j, i), a.scale(d).conjugate());
                }
            }
            KktForm::NormalEquations => {
                for (j, &a) in row.iter() {
                    row.iter().for_each(|(k, &b)| visit((j, k), a.conjugate() * b));
                }
            }
        }
    }
    for (i, (row, &e)) in hard.outer_iterator().zip(hard_scales).enumerate() {
        for (j, &a) in row.iter() {
            visit((multipliers + i, unknowns + j), a.scale(e));
            visit((unknowns + j, multipliers + i), a.scale(e).conjugate());
        }
    }
}

/// Powers of two that bring the rows to norms between 1 and 2.
pub(crate) fn row_scales<T: Scalar>(matrix: &CsMat<T>) -> Vec<f64> {
    let norm = |row: sprs::CsVecView<'_, T>| row.iter().map(|(_, a)| a.modulus_squared()).sum::<f64>().sqrt();
    matrix.outer_iterator().map(|row| 1.0 / power_of_two_below(norm(row))).collect()
}

/// `b − A x`, row by row.
pub(crate) fn row_residuals<T: Scalar>(a: &CsMat<T>, x: &[T], b: &[T]) -> impl Iterator<Item = T> {
    a.outer_iterator().zip(b).map(|(row, &b_i)| row.iter().fold(b_i, |rest, (j, &a_ij)| rest - a_ij * x[j]))
}

pub(crate) fn check_shape<T: Scalar>(problem: &LeastSquares<T>) -> Result<(), KktError> {
    for (block, matrix) in [("M", &problem.soft), ("H", &problem.hard)] {
        if !matrix.is_csr() {
            return Err(KktError::NotByRows { block });
        }
        let (expected, actual) = (problem.columns, matrix.cols());
        if actual != expected {
            return Err(KktError::ShapeMismatch { block, side: "columns", expected, actual });
        }
    }
    Ok(())
}

pub(crate) fn check_pattern<T>(
    block: &'static str,
    pattern: &RowPattern,
    matrix: &CsMat<T>,
) -> Result<(), KktError> {
    if pattern.fits(matrix) { Ok(()) } else { Err(KktError::PatternChanged { block }) }
}

pub(crate) fn check_values<T: Scalar>(block: &'static str, matrix: &CsMat<T>) -> Result<(), KktError> {
    match matrix.outer_iterator().position(|row| row.iter().any(|(_, a)| !a.all_finite())) {
        Some(row) => Err(KktError::NotFinite { block, row }),
        None => Ok(()),
    }
}

pub(crate) fn check_target<T: Scalar>(
    block: &'static str,
    expected: usize,
    target: &[T],
) -> Result<(), KktError> {
    check_length(block, expected, target.len())?;
    match target.iter().position(|b| !b.all_finite()) {
        Some(row) => Err(KktError::NotFinite { block, row }),
        None => Ok(()),
    }
}

pub(crate) fn check_length(block: &'static str, expected: usize, actual: usize) -> Result<(), KktError> {
    let side = "rows";
    if actual == expected { Ok(()) } else { Err(KktError::ShapeMismatch { block, side, expected, actual }) }
}
