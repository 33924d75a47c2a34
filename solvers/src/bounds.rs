//! Small dense quadratic programs with bounds: the dual active-set method, and a clamping loop to compare it with.

use crate::rank::analyse_rank;
use crate::sparse::RowMatrix;
use nalgebra::{DMatrix, DVector};

/// A row is violated if it misses its bound by more, relative to the sizes of its terms.
const VIOLATION_TOLERANCE: f64 = 1e-11;
/// A row with less curvature than this, relative to its square over the largest entry of `G`, depends on the active ones.
const CURVATURE_TOLERANCE: f64 = 1e-11;
/// Residual of a dense solve, relative to its right-hand side, beyond which the matrix counts as singular.
const SOLVE_TOLERANCE: f64 = 1e-7;
/// Coefficients below this, relative to the largest, are not part of a certificate.
const CERTIFICATE_TOLERANCE: f64 = 1e-6;

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

/// How bounds are met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoundMethod {
    /// Exact: adds the most violated row, releases rows whose multiplier reaches zero.
    #[default]
    DualActiveSet,
    /// Turns all violated rows into equalities and solves again until none is left; never releases one. Often not
    /// optimal, and may find no answer where there is one.
    PaperIteration,
}

/// The minimiser.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundedSolution {
    /// `x`.
    pub x: Vec<f64>,
    /// Rows of `C` that hold with equality, in the order they were added.
    pub active: Vec<usize>,
    /// Their multipliers `u`: `G x − g = Aᵀν + Cᵀu`. Not negative, except after [`BoundMethod::PaperIteration`].
    pub multipliers: Vec<f64>,
    /// Dense systems solved after the first.
    pub iterations: usize,
}

/// Why there is no minimiser.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoundsError {
    /// A block does not fit the others.
    #[error("{block} is {actual_rows} x {actual_columns}, expected {rows} x {columns}")]
    ShapeMismatch {
        /// Letter of the block.
        block: &'static str,
        /// Rows it should have.
        rows: usize,
        /// Columns it should have.
        columns: usize,
        /// Rows it has.
        actual_rows: usize,
        /// Columns it has.
        actual_columns: usize,
    },
    /// A number is infinite or undefined.
    #[error("row {row} of {block} is not finite")]
    NotFinite {
        /// Letter of the block.
        block: &'static str,
        /// Its row.
        row: usize,
    },
    /// `G` leaves some direction free that `A` does not hold, or rows of `A` depend on each other.
    #[error("the system is singular: some unknown is free, or equality rows depend on each other")]
    Singular,
    /// Rows contradict each other.
    #[error(
        "inequality {row} misses its bound by {violation} where inequalities {certificate:?} and equalities {equalities:?} hold"
    )]
    Infeasible {
        /// Row of `C` that cannot be met.
        row: usize,
        /// Other rows of `C` in its way.
        certificate: Vec<usize>,
        /// Rows of `A` in its way.
        equalities: Vec<usize>,
        /// What it misses while the others hold.
        violation: f64,
    },
    /// Rounding made the method go on without end.
    #[error("no minimiser after {limit} steps")]
    TooManyIterations {
        /// Steps allowed.
        limit: usize,
    },
}

/// Solves a quadratic program with bounds. Cost: one dense factorisation of (unknowns + held rows)³ per iteration.
///
/// # Errors
/// [`BoundsError::Infeasible`] if rows contradict each other (or, with [`BoundMethod::PaperIteration`], if the rows it has
/// clamped do); the others for what is not a program at all.
///
/// Source: Goldfarb and Idnani, *A numerically stable dual method for solving strictly convex quadratic programs*,
/// Math. Programming 27 (1983); here with a dense factorisation per step instead of updates.
pub fn solve_bounded(qp: &BoundedQp, method: BoundMethod) -> Result<BoundedSolution, BoundsError> {
    check(qp)?;
    match method {
        BoundMethod::DualActiveSet => dual_active_set(qp),
        BoundMethod::PaperIteration => clamp_and_repeat(qp),
    }
}

impl BoundedQp {
    /// `½xᵀGx − gᵀx`.
    pub fn objective(&self, x: &[f64]) -> f64 {
        let x = DVector::from_column_slice(x);
        0.5 * x.dot(&(&self.hessian * &x)) - self.linear.dot(&x)
    }

    /// `d_p − c_p x` if that is more than rounding.
    fn violation(&self, row: usize, x: &DVector<f64>) -> Option<f64> {
        let (mut missing, mut size) = (self.lower_bounds[row], self.lower_bounds[row].abs());
        for (c, x_j) in self.inequalities.row(row).iter().zip(x.iter()) {
            missing -= c * x_j;
            size += (c * x_j).abs();
        }
        (missing > VIOLATION_TOLERANCE * size).then_some(missing)
    }

    /// The most violated row and what it misses, first in the unit of the row's length.
    fn worst(&self, x: &DVector<f64>) -> Option<(usize, f64)> {
        let violated = (0..self.inequalities.nrows()).filter_map(|row| Some((row, self.violation(row, x)?)));
        let distance = |&(row, missing): &(usize, f64)| missing / self.inequalities.row(row).norm();
        violated.reduce(|a, b| if distance(&b) > distance(&a) { b } else { a })
    }

    /// Solves `G z + Aᵀv + C_Wᵀ w = f`, `A z = e`, `C_W z = e_W` for the rows `W`; returns `z` and `(v, w)`.
    fn solve_held(
        &self,
        held: &[usize],
        f: &DVector<f64>,
        e: &DVector<f64>,
    ) -> Result<(DVector<f64>, DVector<f64>), BoundsError> {
        let (n, equal) = (self.linear.len(), self.equality_targets.len());
        let size = n + equal + held.len();
        let mut kkt = DMatrix::zeros(size, size);
        kkt.view_mut((0, 0), (n, n)).copy_from(&self.hessian);
        let rows = self
            .equalities
            .row_iter()
            .chain(held.iter().map(|&row| self.inequalities.row(row)));
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

fn dual_active_set(qp: &BoundedQp) -> Result<BoundedSolution, BoundsError> {
    let limit = 100 + 20 * (qp.linear.len() + qp.inequalities.nrows());
    let (mut x, _) = qp.solve_held(&[], &qp.linear, &qp.equality_targets)?;
    let (mut active, mut multipliers): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut iterations = 0;
    while let Some((row, _)) = qp.worst(&x) {
        let mut multiplier = 0.0;
        loop {
            iterations += 1;
            if iterations > limit {
                return Err(BoundsError::TooManyIterations { limit });
            }
            let step = Step::toward(qp, row, &active, &x)?;
            let blocking = step.blocking(&multipliers);
            let blocked_at = blocking.map_or(f64::INFINITY, |(_, length)| length);
            let length = step.full_length.min(blocked_at);
            if length.is_infinite() {
                return Err(step.infeasible(row, &active));
            }
            x += &step.direction * if step.full_length.is_finite() { length } else { 0.0 };
            multipliers
                .iter_mut()
                .zip(&step.relief)
                .for_each(|(u, r)| *u -= length * r);
            multiplier += length;
            match blocking {
                Some((k, _)) if blocked_at < step.full_length => {
                    active.remove(k);
                    multipliers.remove(k);
                }
                _ => break,
            }
        }
        active.push(row);
        multipliers.push(multiplier);
    }
    Ok(BoundedSolution {
        x: x.as_slice().to_vec(),
        active,
        multipliers,
        iterations,
    })
}

/// How `x` and the multipliers of the active rows move as the multiplier of a violated row grows.
struct Step {
    direction: DVector<f64>,
    /// Decrease of each active row's multiplier per unit of the new one.
    relief: Vec<f64>,
    /// The same of the equality rows.
    equality_relief: Vec<f64>,
    /// Multiplier at which the row is met; infinite if no step meets it.
    full_length: f64,
    missing: f64,
}

impl Step {
    fn toward(qp: &BoundedQp, row: usize, active: &[usize], x: &DVector<f64>) -> Result<Self, BoundsError> {
        let normal = qp.inequalities.row(row).transpose();
        let equal = qp.equality_targets.len();
        let still = DVector::zeros(equal + active.len());
        let (direction, relief) = qp.solve_held(active, &normal, &still)?;
        let missing = qp.lower_bounds[row] - normal.dot(x);
        let curvature = normal.dot(&direction);
        let least = CURVATURE_TOLERANCE * normal.norm_squared() / qp.hessian.amax();
        let full_length = if curvature > least {
            (missing / curvature).max(0.0)
        } else {
            f64::INFINITY
        };
        let (of_equalities, of_active) = relief.as_slice().split_at(equal);
        let (relief, equality_relief) = (of_active.to_vec(), of_equalities.to_vec());
        Ok(Self {
            direction,
            relief,
            equality_relief,
            full_length,
            missing,
        })
    }

    /// The active row whose multiplier reaches zero first, and when.
    fn blocking(&self, multipliers: &[f64]) -> Option<(usize, f64)> {
        let largest = self.relief.iter().fold(0.0_f64, |a, r| a.max(r.abs()));
        let falls = |r: f64| r > 1e-12 * largest;
        let candidates = multipliers
            .iter()
            .zip(&self.relief)
            .enumerate()
            .filter(|(_, (_, r))| falls(**r));
        candidates
            .map(|(k, (u, r))| (k, u.max(0.0) / r))
            .reduce(|a, b| if b.1 < a.1 { b } else { a })
    }

    fn infeasible(&self, row: usize, active: &[usize]) -> BoundsError {
        let all = self.relief.iter().chain(&self.equality_relief);
        let limit = CERTIFICATE_TOLERANCE * all.fold(0.0_f64, |a, r| a.max(r.abs()));
        let large = |(k, r): (usize, &f64)| (r.abs() > limit).then_some(k);
        BoundsError::Infeasible {
            row,
            certificate: self
                .relief
                .iter()
                .enumerate()
                .filter_map(large)
                .map(|k| active[k])
                .collect(),
            equalities: self
                .equality_relief
                .iter()
                .enumerate()
                .filter_map(large)
                .collect(),
            violation: self.missing,
        }
    }
}

fn clamp_and_repeat(qp: &BoundedQp) -> Result<BoundedSolution, BoundsError> {
    let mut active: Vec<usize> = Vec::new();
    for iterations in 0..=qp.inequalities.nrows() {
        let held = independent_rows(qp, &active)?;
        let targets = qp
            .equality_targets
            .iter()
            .copied()
            .chain(held.iter().map(|&row| qp.lower_bounds[row]));
        let targets = DVector::from_vec(targets.collect());
        let (x, forces) = qp.solve_held(&held, &qp.linear, &targets)?;
        let violated: Vec<usize> = (0..qp.inequalities.nrows())
            .filter(|&row| qp.violation(row, &x).is_some())
            .collect();
        if violated.is_empty() {
            let multipliers = forces
                .iter()
                .skip(qp.equality_targets.len())
                .map(|w| -w)
                .collect();
            return Ok(BoundedSolution {
                x: x.as_slice().to_vec(),
                active: held,
                multipliers,
                iterations,
            });
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
    Err(BoundsError::TooManyIterations {
        limit: qp.inequalities.nrows(),
    })
}

/// The clamped rows without those that repeat others.
fn independent_rows(qp: &BoundedQp, clamped: &[usize]) -> Result<Vec<usize>, BoundsError> {
    let equal = qp.equality_targets.len();
    let mut rows = RowMatrix::new(qp.linear.len());
    let mut push = |row: nalgebra::RowDVector<f64>| {
        let terms: Vec<_> = row
            .iter()
            .copied()
            .enumerate()
            .filter(|&(_, a)| a != 0.0)
            .collect();
        rows.push_row(&terms);
    };
    (0..equal).for_each(|k| push(qp.equalities.row(k).into_owned()));
    clamped
        .iter()
        .for_each(|&k| push(qp.inequalities.row(k).into_owned()));
    let targets: Vec<f64> = qp
        .equality_targets
        .iter()
        .copied()
        .chain(clamped.iter().map(|&k| qp.lower_bounds[k]))
        .collect();
    let scale = targets.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let report = analyse_rank(&rows.to_csr());
    for dependency in &report.dependent {
        let violation = dependency.mismatch(&targets);
        if dependency.row >= equal && violation > 1e-9 * scale {
            let others = dependency
                .certificate()
                .into_iter()
                .filter(|&k| k != dependency.row);
            let (equalities, certificate): (Vec<_>, Vec<_>) = others.partition(|&k| k < equal);
            let certificate = certificate.into_iter().map(|k| clamped[k - equal]).collect();
            let row = clamped[dependency.row - equal];
            return Err(BoundsError::Infeasible {
                row,
                certificate,
                equalities,
                violation,
            });
        }
    }
    Ok(report
        .independent
        .into_iter()
        .filter(|&k| k >= equal)
        .map(|k| clamped[k - equal])
        .collect())
}

fn check(qp: &BoundedQp) -> Result<(), BoundsError> {
    let n = qp.linear.len();
    check_block("G", &qp.hessian, (n, n), f64::is_finite)?;
    check_block(
        "A",
        &qp.equalities,
        (qp.equality_targets.len(), n),
        f64::is_finite,
    )?;
    check_block("C", &qp.inequalities, (qp.lower_bounds.len(), n), f64::is_finite)?;
    let column = |v: &DVector<f64>| DMatrix::from_column_slice(v.len(), 1, v.as_slice());
    check_block("g", &column(&qp.linear), (n, 1), f64::is_finite)?;
    check_block(
        "b",
        &column(&qp.equality_targets),
        (qp.equality_targets.len(), 1),
        f64::is_finite,
    )?;
    let bounds = column(&qp.lower_bounds);
    check_block("d", &bounds, (qp.lower_bounds.len(), 1), |d| {
        d.is_finite() || d == f64::NEG_INFINITY
    })
}

fn check_block(
    block: &'static str,
    matrix: &DMatrix<f64>,
    (rows, columns): (usize, usize),
    allowed: fn(f64) -> bool,
) -> Result<(), BoundsError> {
    let (actual_rows, actual_columns) = matrix.shape();
    if (actual_rows, actual_columns) != (rows, columns) {
        return Err(BoundsError::ShapeMismatch {
            block,
            rows,
            columns,
            actual_rows,
            actual_columns,
        });
    }
    match matrix.row_iter().position(|row| !row.iter().all(|&a| allowed(a))) {
        Some(row) => Err(BoundsError::NotFinite { block, row }),
        None => Ok(()),
    }
}
