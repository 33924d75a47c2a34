//! Solving with an LU factorisation and not believing it: iterative refinement and a probe for singularity.

use crate::lu::{ColumnPattern, Lu, LuOrder, LuScratch, NoFactor, dense_inverse};
use crate::scalar::{Scalar, TwoPart};
use std::ops::Range;

/// Refinement ends when a correction is smaller than this, relative to the unknowns. A residual in plain arithmetic
/// gives corrections of about the size of the error, so one such step both repairs and measures.
const CORRECTION_GOAL: f64 = 1e-12;
/// Steps with the residual summed to 32 digits, which are taken if the plain one does not reach the goal.
const MOST_COMPENSATED_STEPS: usize = 8;
/// A refinement step on a regular matrix shrinks the error by (condition number) × 1e-16. On a singular one it does
/// not shrink it at all: the first correction is as large as the solution.
const PROBE_CONTRACTION: f64 = 0.1;

/// A Hermitian (or real symmetric) matrix with its factorisation.
#[derive(Clone, Debug)]
pub(crate) struct RefinedLu<T> {
    values: Vec<T>,
    lu: Lu<T>,
}

/// Memory for [`RefinedLu::solve`].
pub(crate) struct RefineScratch<T> {
    residual: Vec<T>,
    lu: LuScratch,
}

/// How a refinement went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Refinement {
    /// Corrections made.
    pub(crate) steps: usize,
    /// Size of the last one relative to the unknowns, largest entries compared.
    pub(crate) last_correction: f64,
}

impl<T: Scalar> RefinedLu<T> {
    /// Factors a matrix and makes sure that it can be solved with.
    ///
    /// `values`: entries of a Hermitian matrix, in the order of `pattern`.
    ///
    /// # Errors
    /// [`NoFactor`] if the matrix is singular to working precision.
    pub(crate) fn new(pattern: &ColumnPattern, order: &LuOrder, values: Vec<T>) -> Result<Self, NoFactor> {
        let lu = order.factor(pattern, &values)?;
        let refined = Self { values, lu };
        refined.probe(pattern)?;
        Ok(refined)
    }

    /// Memory for solves.
    pub(crate) fn scratch(&self, size: usize) -> RefineScratch<T> {
        RefineScratch { residual: vec![T::zero(); size], lu: self.lu.scratch() }
    }

    /// Memory for [`RefinedLu::substitute`].
    pub(crate) fn lu_scratch(&self) -> LuScratch {
        self.lu.scratch()
    }

    /// Replaces `b` by the solution of `K x = b`, not refined: for callers who know better residuals than the matrix gives.
    pub(crate) fn substitute(&self, b: &mut [T], scratch: &mut LuScratch) {
        self.lu.solve_in_place(b, scratch);
    }

    /// Replaces `count` right-hand sides, one after the other, likewise.
    pub(crate) fn substitute_columns(&self, b: &mut [T], count: usize) {
        self.lu.solve_columns_in_place(b, count, &mut self.lu.scratch_of_columns(count));
    }

    /// All columns of the inverse, one after the other, not refined. Cost: cubic.
    pub(crate) fn inverse(&self, pattern: &ColumnPattern) -> Vec<T> {
        dense_inverse(pattern, &self.values)
    }

    /// Solves `K x = b`. `watched`: the unknowns whose accuracy decides how often to refine. The solution may still be
    /// nonsense if `K` is nearly singular; whoever knows the problem must check its residual.
    pub(crate) fn solve(
        &self,
        pattern: &ColumnPattern,
        (b, x): (&[T], &mut [T]),
        watched: Range<usize>,
        scratch: &mut RefineScratch<T>,
    ) -> Refinement {
        x.copy_from_slice(b);
        self.lu.solve_in_place(x, &mut scratch.lu);
        let mut done = Refinement { steps: 0, last_correction: f64::INFINITY };
        while done.last_correction > CORRECTION_GOAL && done.steps <= MOST_COMPENSATED_STEPS {
            let size = largest(&x[watched.clone()]);
            if !size.is_finite() {
                break;
            }
            if done.steps == 0 {
                self.residual_into(pattern, (b, x), &mut scratch.residual);
            } else {
                self.compensated_residual_into(pattern, (b, x), &mut scratch.residual);
            }
            self.lu.solve_in_place(&mut scratch.residual, &mut scratch.lu);
            let correction = relative_to(largest(&scratch.residual[watched.clone()]), size);
            // The first compensated step may well be as large as the plain one; from then on each must halve it.
            let to_beat = if done.steps < 2 { f64::MAX } else { 0.5 * done.last_correction };
            if correction.is_nan() || correction > to_beat {
                break;
            }
            x.iter_mut().zip(&scratch.residual).for_each(|(x_i, &d_i)| *x_i += d_i);
            done = Refinement { steps: done.steps + 1, last_correction: correction };
        }
        done
    }

    /// `b − K x` in plain arithmetic. Column i of a Hermitian matrix is the conjugate of row i.
    pub(crate) fn residual_into(&self, pattern: &ColumnPattern, (b, x): (&[T], &[T]), out: &mut [T]) {
        for (i, out_i) in out.iter_mut().enumerate() {
            let entries = pattern.column_starts[i]..pattern.column_starts[i + 1];
            let mut sum = b[i];
            for (&j, &k_ji) in pattern.row_indices[entries.clone()].iter().zip(&self.values[entries]) {
                sum -= k_ji.conjugate() * x[j];
            }
            *out_i = sum;
        }
    }

    /// `b − K x`, products summed to about 32 digits and rounded once.
    fn compensated_residual_into(&self, pattern: &ColumnPattern, (b, x): (&[T], &[T]), out: &mut [T]) {
        for (i, out_i) in out.iter_mut().enumerate() {
            let entries = pattern.column_starts[i]..pattern.column_starts[i + 1];
            let mut sum = TwoPart { high: b[i], low: T::zero() };
            for (&j, &k_ji) in pattern.row_indices[entries.clone()].iter().zip(&self.values[entries]) {
                T::add_product(&mut sum, -k_ji.conjugate(), x[j]);
            }
            *out_i = sum.high;
        }
    }

    /// Solves for a vector without structure and looks at the first correction.
    fn probe(&self, pattern: &ColumnPattern) -> Result<(), NoFactor> {
        let b: Vec<T> = scattered(pattern.size);
        let mut x = b.clone();
        let mut scratch = self.scratch(pattern.size);
        self.lu.solve_in_place(&mut x, &mut scratch.lu);
        let size = largest(&x);
        if !size.is_finite() {
            return Err(NoFactor);
        }
        self.residual_into(pattern, (&b, &x), &mut scratch.residual);
        self.lu.solve_in_place(&mut scratch.residual, &mut scratch.lu);
        if relative_to(largest(&scratch.residual), size) < PROBE_CONTRACTION { Ok(()) } else { Err(NoFactor) }
    }
}

/// Largest modulus; NaN if any entry is not a number.
pub(crate) fn largest<T: Scalar>(x: &[T]) -> f64 {
    x.iter().fold(0.0, |largest: f64, x_i| {
        let modulus = x_i.modulus();
        if modulus > largest || modulus.is_nan() { modulus } else { largest }
    })
}

/// `part / whole`, where nothing of nothing is nothing.
pub(crate) fn relative_to(part: f64, whole: f64) -> f64 {
    if part == 0.0 { 0.0 } else { part / whole }
}

/// Numbers between −1 and 1 that no null vector is likely to be orthogonal to: multiples of the golden ratio, mod 1.
fn scattered<T: Scalar>(size: usize) -> Vec<T> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let mut phase = 0.5;
    let next = |_| {
        phase = (phase + GOLDEN) % 1.0;
        T::from_real(2.0 * phase - 1.0)
    };
    (0..size).map(next).collect()
}
