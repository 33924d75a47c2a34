//! Quadratic programs with bounds: the dual active-set method, on small dense programs and whatever else can take its
//! steps, and a clamping loop to compare it with.

use crate::clamp::clamp_and_repeat;
use crate::error::BoundsError;
use crate::quadratic::{BoundedQp, BoundedSolution, check};
use nalgebra::DVector;

/// A row with less curvature than this, relative to its square over the largest entry of `G`, depends on the active ones.
pub(crate) const CURVATURE_TOLERANCE: f64 = 1e-11;
/// Coefficients below this, relative to the largest, are not part of a certificate.
const CERTIFICATE_TOLERANCE: f64 = 1e-6;

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

/// What the dual active-set method asks of a program `min ½xᵀGx − gᵀx` s.t. `A x = b`, `C x ≥ d`.
pub(crate) trait Program {
    /// Where to begin: the minimiser with some independent rows met, no multiplier below 0; possibly with none.
    fn start(&self) -> Result<DualPoint, BoundsError>;
    /// The most violated row of `C`.
    fn worst(&self, x: &DVector<f64>) -> Option<usize>;
    /// How to meet `row` while the active rows stay met.
    fn toward(&self, row: usize, active: &[usize], x: &DVector<f64>) -> Result<Step, BoundsError>;
    /// Steps that a sound program never needs.
    fn step_limit(&self) -> usize;
}

/// A minimiser where active rows hold with equality.
pub(crate) struct DualPoint {
    pub(crate) x: DVector<f64>,
    /// Active rows.
    pub(crate) active: Vec<usize>,
    /// Their multipliers.
    pub(crate) multipliers: Vec<f64>,
}

/// The dual active-set method: from a minimiser that ignores some rows to the one that meets all, the most violated row
/// first.
pub(crate) fn dual_active_set(program: &impl Program) -> Result<BoundedSolution, BoundsError> {
    let limit = program.step_limit();
    let DualPoint { mut x, mut active, mut multipliers } = program.start()?;
    let mut iterations = 0;
    while let Some(row) = program.worst(&x) {
        let mut multiplier = 0.0;
        loop {
            iterations += 1;
            if iterations > limit {
                return Err(BoundsError::TooManyIterations { limit });
            }
            let step = program.toward(row, &active, &x)?;
            let blocking = step.blocking(&multipliers);
            let blocked_at = blocking.map_or(f64::INFINITY, |(_, length)| length);
            let length = step.full_length.min(blocked_at);
            if length.is_infinite() {
                return Err(step.infeasible(row, &active));
            }
            x += &step.direction * if step.full_length.is_finite() { length } else { 0.0 };
            multipliers.iter_mut().zip(&step.relief).for_each(|(u, r)| *u -= length * r);
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
    Ok(BoundedSolution { x: x.as_slice().to_vec(), active, multipliers, iterations })
}

impl Program for BoundedQp {
    fn start(&self) -> Result<DualPoint, BoundsError> {
        let (x, _) = self.solve_held(&[], &self.linear, &self.equality_targets)?;
        Ok(DualPoint { x, active: Vec::new(), multipliers: Vec::new() })
    }

    fn worst(&self, x: &DVector<f64>) -> Option<usize> {
        Some(BoundedQp::worst(self, x)?.0)
    }

    fn toward(&self, row: usize, active: &[usize], x: &DVector<f64>) -> Result<Step, BoundsError> {
        let normal = self.inequalities.row(row).transpose();
        let equal = self.equality_targets.len();
        let still = DVector::zeros(equal + active.len());
        let (direction, relief) = self.solve_held(active, &normal, &still)?;
        let missing = self.lower_bounds[row] - normal.dot(x);
        let least = CURVATURE_TOLERANCE * normal.norm_squared() / self.hessian.amax();
        let full_length = full_length(missing, normal.dot(&direction), least);
        let (of_equalities, of_active) = relief.as_slice().split_at(equal);
        let (relief, equality_relief) = (of_active.to_vec(), of_equalities.to_vec());
        Ok(Step { direction, relief, equality_relief, full_length, missing })
    }

    fn step_limit(&self) -> usize {
        step_limit(self.linear.len() + self.inequalities.nrows())
    }
}

/// Far more steps than any program of `size` unknowns and inequalities was seen to take.
pub(crate) fn step_limit(size: usize) -> usize {
    100 + 20 * size
}

/// Multiplier at which a row that misses its bound by `missing` meets it, where a unit of it gains `curvature`; infinite if
/// that is no more than rounding, `least`.
pub(crate) fn full_length(missing: f64, curvature: f64, least: f64) -> f64 {
    if curvature > least { (missing / curvature).max(0.0) } else { f64::INFINITY }
}

/// How `x` and the multipliers of the active rows move as the multiplier of a violated row grows.
pub(crate) struct Step {
    pub(crate) direction: DVector<f64>,
    /// Decrease of each active row's multiplier per unit of the new one.
    pub(crate) relief: Vec<f64>,
    /// The same of the equality rows.
    pub(crate) equality_relief: Vec<f64>,
    /// Multiplier at which the row is met; infinite if no step meets it.
    pub(crate) full_length: f64,
    /// By how much the row misses its bound.
    pub(crate) missing: f64,
}

impl Step {
    /// The active row whose multiplier reaches zero first, and when.
    fn blocking(&self, multipliers: &[f64]) -> Option<(usize, f64)> {
        let largest = self.relief.iter().fold(0.0_f64, |a, r| a.max(r.abs()));
        let falls = |r: f64| r > 1e-12 * largest;
        let candidates = multipliers.iter().zip(&self.relief).enumerate().filter(|(_, (_, r))| falls(**r));
        candidates.map(|(k, (u, r))| (k, u.max(0.0) / r)).reduce(|a, b| if b.1 < a.1 { b } else { a })
    }

    fn infeasible(&self, row: usize, active: &[usize]) -> BoundsError {
        let all = self.relief.iter().chain(&self.equality_relief);
        let limit = CERTIFICATE_TOLERANCE * all.fold(0.0_f64, |a, r| a.max(r.abs()));
        let large = |(k, r): (usize, &f64)| (r.abs() > limit).then_some(k);
        BoundsError::Infeasible {
            row,
            certificate: self.relief.iter().enumerate().filter_map(large).map(|k| active[k]).collect(),
            equalities: self.equality_relief.iter().enumerate().filter_map(large).collect(),
            violation: self.missing,
        }
    }
}
