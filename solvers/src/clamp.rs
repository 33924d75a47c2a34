//! The clamping loop for bounds: turn violated rows into equalities, solve again, never let go.

use crate::error::BoundsError;
use crate::quadratic::{BoundedQp, BoundedSolution};
use crate::rank::analyse_rank;
use crate::sparse::RowMatrix;
use nalgebra::DVector;

/// Ends after at most as many rounds as there are rows, since each round clamps a new one.
pub(crate) fn clamp_and_repeat(qp: &BoundedQp) -> Result<BoundedSolution, BoundsError> {
    let mut active: Vec<usize> = Vec::new();
    for iterations in 0..=qp.inequalities.nrows() {
        let held = independent_rows(qp, &active)?;
        let targets = qp.equality_targets.iter().copied().chain(held.iter().map(|&row| qp.lower_bounds[row]));
        let targets = DVector::from_vec(targets.collect());
        let (x, forces) = qp.solve_held(&held, &qp.linear, &targets)?;
        let violated: Vec<usize> =
            (0..qp.inequalities.nrows()).filter(|&row| qp.violation(row, &x).is_some()).collect();
        if violated.is_empty() {
            let multipliers = forces.iter().skip(qp.equality_targets.len()).map(|w| -w).collect();
            return Ok(BoundedSolution { x: x.as_slice().to_vec(), active: held, multipliers, iterations });
        }
        if let Some(&row) = violated.iter().find(|row| active.contains(row)) {
            let violation = qp.violation(row, &x).unwrap_or(0.0);
            return Err(BoundsError::Infeasible {
                row,
                certificate: held,
                equalities: Vec::new(),
                violation,
            });
        }
        active.extend(violated);
    }
    Err(BoundsError::TooManyIterations { limit: qp.inequalities.nrows() })
}

/// The clamped rows without those that repeat others.
fn independent_rows(qp: &BoundedQp, clamped: &[usize]) -> Result<Vec<usize>, BoundsError> {
    let equal = qp.equality_targets.len();
    let mut rows = RowMatrix::new(qp.linear.len());
    let mut push = |row: nalgebra::RowDVector<f64>| {
        let terms: Vec<_> = row.iter().copied().enumerate().filter(|&(_, a)| a != 0.0).collect();
        rows.push_row(&terms);
    };
    (0..equal).for_each(|k| push(qp.equalities.row(k).into_owned()));
    clamped.iter().for_each(|&k| push(qp.inequalities.row(k).into_owned()));
    let targets: Vec<f64> =
        qp.equality_targets.iter().copied().chain(clamped.iter().map(|&k| qp.lower_bounds[k])).collect();
    let scale = targets.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let report = analyse_rank(&rows.to_csr());
    for dependency in &report.dependent {
        let violation = dependency.mismatch(&targets);
        if dependency.row >= equal && violation > 1e-9 * scale {
            let others = dependency.certificate().into_iter().filter(|&k| k != dependency.row);
            let (equalities, certificate): (Vec<_>, Vec<_>) = others.partition(|&k| k < equal);
            let certificate = certificate.into_iter().map(|k| clamped[k - equal]).collect();
            let row = clamped[dependency.row - equal];
            return Err(BoundsError::Infeasible { row, certificate, equalities, violation });
        }
    }
    Ok(report.independent.into_iter().filter(|&k| k >= equal).map(|k| clamped[k - equal]).collect())
}
