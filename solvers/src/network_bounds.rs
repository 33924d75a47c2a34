//! Networks whose steps have bounds: the dual active-set method on the factored sparse system.
//!
//! All n steps of a piece k are alike, so `min ≤ step ≤ max` is two inequalities on its delays,
//!
//! ```text
//!     row 2k:      x_b − x_a ≥ n (min − step)          row 2k+1:    x_a − x_b ≥ −n (max − step)
//! ```
//!
//! and their normals are multiples of the piece's own soft row, `c = ± √(n/w) M_k`. So a force on a bound is a shifted target
//! of its spring, and every step of the method is a sparse least-squares problem with the active rows among the hard ones:
//! factored anew, since a factor without them loses digits where bounds hold against strong forces.
//!
//! The method begins where the published loop ends its first round, with all violated rows met, less those that depend on
//! others or that want to be released; so few steps are left, however many rows are active at the end.
//!
//! Source: Goldfarb and Idnani, *A numerically stable dual method for solving strictly convex quadratic programs*, Math.
//! Programming 27 (1983).

use crate::augmented::KktForm;
use crate::bounds::{
    CURVATURE_TOLERANCE, DualPoint, Program, Step, dual_active_set, full_length, step_limit,
};
use crate::error::{BoundsError, Solution};
use crate::kkt::analyse;
use crate::least_squares::LeastSquares;
use crate::network::{Network, Piece};
use crate::quadratic::{BoundedQp, BoundedSolution, VIOLATION_TOLERANCE};
use crate::rank::analyse_rank;
use crate::sparse::RowMatrix;
use nalgebra::{DMatrix, DVector};
use sprs::CsMat;

/// Least and greatest length of a step, in the unit of [`Network::step`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepRange {
    /// Least.
    pub min: f64,
    /// Greatest.
    pub max: f64,
}

impl Network {
    /// The network with bounds on its steps as a dense program, for [`solve_bounded`](crate::solve_bounded): the independent
    /// route, and that of the clamping loop. `m`, `h`: targets of the problem. Cost: square in unknowns.
    pub fn dense_program(&self, (m, h): (&[f64], &[f64]), range: StepRange) -> BoundedQp {
        let columns = self.problem.columns;
        let mut hessian = DMatrix::zeros(columns, columns);
        let mut linear = DVector::zeros(columns);
        for (row, target) in self.problem.soft.outer_iterator().zip(m) {
            for (i, a) in row.iter() {
                linear[i] += a * target;
                row.iter().for_each(|(j, b)| hessian[(i, j)] += a * b);
            }
        }
        let mut inequalities = DMatrix::zeros(2 * self.pieces.len(), columns);
        let mut lower_bounds = DVector::zeros(2 * self.pieces.len());
        for (row, piece) in self.pieces.iter().flat_map(|piece| [piece; 2]).enumerate() {
            inequalities[(row, piece.from)] = -sign(row);
            inequalities[(row, piece.from + 1)] = sign(row);
            lower_bounds[row] = bound(piece, row, self.step, range);
        }
        let equality_targets = DVector::from_column_slice(h);
        BoundedQp {
            hessian,
            linear,
            equalities: dense(&self.problem.hard),
            equality_targets,
            inequalities,
            lower_bounds,
        }
    }

    /// Solves the network with bounds on its steps. `m`, `h`: targets of the problem.
    ///
    /// Inequalities are numbered as above, two a piece; equalities as the hard rows of the problem. Cost: a sparse
    /// factorisation of the problem for the start, and one for every row that becomes active or ceases to be after it.
    ///
    /// # Errors
    /// [`BoundsError::Infeasible`] if hard rows and bounds contradict each other; [`BoundsError::Solve`] for targets that are
    /// not finite.
    pub fn solve_within(
        &self,
        targets: (&[f64], &[f64]),
        range: StepRange,
    ) -> Result<BoundedSolution, BoundsError> {
        let program = SparseProgram::new(self, targets, range);
        let mut solution = dual_active_set(&program)?;
        if solution.iterations > 0 {
            // Steps add up their rounding; the last active set solved for once more does not.
            let (x, multipliers) = program.minimiser(&solution.active)?;
            solution.x = x;
            solution.multipliers = multipliers.into_iter().map(|u| u.max(0.0)).collect();
        }
        Ok(solution)
    }
}

/// +1 for the row that bounds a piece from below, −1 for the one from above.
fn sign(row: usize) -> f64 {
    if row.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// Right-hand side of a row.
fn bound(piece: &Piece, row: usize, step: f64, range: StepRange) -> f64 {
    let limit = if row.is_multiple_of(2) { range.min } else { range.max };
    sign(row) * piece.steps as f64 * (limit - step)
}

fn dense(matrix: &CsMat<f64>) -> DMatrix<f64> {
    let mut dense = DMatrix::zeros(matrix.rows(), matrix.cols());
    for (i, row) in matrix.outer_iterator().enumerate() {
        row.iter().for_each(|(j, a)| dense[(i, j)] = *a);
    }
    dense
}

struct SparseProgram<'a> {
    network: &'a Network,
    range: StepRange,
    targets: (&'a [f64], &'a [f64]),
    /// Hard rows of the network, to which active ones are added.
    hard: RowMatrix<f64>,
}

impl<'a> SparseProgram<'a> {
    fn new(network: &'a Network, targets: (&'a [f64], &'a [f64]), range: StepRange) -> Self {
        let mut hard = RowMatrix::new(network.problem.columns);
        for row in network.problem.hard.outer_iterator() {
            hard.push_row(&row.iter().map(|(column, a)| (column, *a)).collect::<Vec<_>>());
        }
        Self { network, range, targets, hard }
    }

    fn piece(&self, row: usize) -> &Piece {
        &self.network.pieces[row / 2]
    }

    fn bound(&self, row: usize) -> f64 {
        bound(self.piece(row), row, self.network.step, self.range)
    }

    /// `c x`.
    fn along(&self, row: usize, x: &[f64]) -> f64 {
        let Piece { from, .. } = *self.piece(row);
        sign(row) * (x[from + 1] - x[from])
    }

    /// Violated rows and what they miss; normals are all of one length.
    fn violated(&self, x: &[f64]) -> impl Iterator<Item = (usize, f64)> {
        (0..2 * self.network.pieces.len()).filter_map(move |row| {
            let Piece { from, .. } = *self.piece(row);
            let (bound, missing) = (self.bound(row), self.bound(row) - self.along(row, x));
            let size = bound.abs() + x[from].abs() + x[from + 1].abs();
            (missing > VIOLATION_TOLERANCE * size).then_some((row, missing))
        })
    }

    /// Hard rows, the active ones last.
    fn hard_with(&self, active: &[usize]) -> CsMat<f64> {
        let mut hard = self.hard.clone();
        for row in active {
            let Piece { from, .. } = *self.piece(*row);
            hard.push_row(&[(from, -sign(*row)), (from + 1, sign(*row))]);
        }
        hard.to_csr()
    }

    fn solve_held(&self, active: &[usize], m: &[f64], h: &[f64]) -> Result<Solution<f64>, BoundsError> {
        let Network { problem, .. } = self.network;
        let problem = LeastSquares {
            columns: problem.columns,
            soft: problem.soft.clone(),
            hard: self.hard_with(active),
        };
        Ok(analyse(&problem, KktForm::Hachtel)?.factor(&problem)?.solve(m, h)?)
    }

    /// Minimiser where the active rows hold with equality, and their multipliers.
    fn minimiser(&self, active: &[usize]) -> Result<(Vec<f64>, Vec<f64>), BoundsError> {
        let (m, h) = self.targets;
        let h: Vec<f64> = h.iter().copied().chain(active.iter().map(|row| self.bound(*row))).collect();
        let Solution { x, multipliers, .. } = self.solve_held(active, m, &h)?;
        Ok((x, multipliers[self.hard.rows()..].iter().map(|lambda| -lambda).collect()))
    }

    /// Rows without those that depend on the hard ones or on those before.
    fn independent(&self, rows: &[usize]) -> Vec<usize> {
        let own = analyse_rank(&self.hard_with(rows)).independent.into_iter();
        own.filter_map(|row| Some(rows[row.checked_sub(self.hard.rows())?])).collect()
    }
}

impl Program for SparseProgram<'_> {
    fn start(&self) -> Result<DualPoint, BoundsError> {
        let (free, _) = self.minimiser(&[])?;
        let violated: Vec<usize> = self.violated(&free).map(|(row, _)| row).collect();
        let mut active = self.independent(&violated);
        loop {
            let (x, multipliers) = self.minimiser(&active)?;
            if multipliers.iter().all(|u| *u >= 0.0) {
                return Ok(DualPoint { x: DVector::from_vec(x), active, multipliers });
            }
            let pushes = active.into_iter().zip(&multipliers).filter(|(_, u)| **u >= 0.0);
            active = pushes.map(|(row, _)| row).collect();
        }
    }

    fn worst(&self, x: &DVector<f64>) -> Option<usize> {
        Some(self.violated(x.as_slice()).reduce(|a, b| if b.1 > a.1 { b } else { a })?.0)
    }

    fn toward(&self, row: usize, active: &[usize], x: &DVector<f64>) -> Result<Step, BoundsError> {
        let Piece { steps, weight, .. } = *self.piece(row);
        let compliance = steps as f64 / weight;
        let mut force = vec![0.0; self.targets.0.len()];
        force[row / 2] = sign(row) * compliance.sqrt();
        let still = vec![0.0; self.hard.rows() + active.len()];
        let Solution { x: direction, mut multipliers, .. } = self.solve_held(active, &force, &still)?;
        let missing = self.bound(row) - self.along(row, x.as_slice());
        // Without everything else, the spring itself would give way by its compliance.
        let least = CURVATURE_TOLERANCE * compliance;
        Ok(Step {
            full_length: full_length(missing, self.along(row, &direction), least),
            relief: multipliers.split_off(self.hard.rows()),
            equality_relief: multipliers,
            direction: DVector::from_vec(direction),
            missing,
        })
    }

    fn step_limit(&self) -> usize {
        step_limit(self.network.problem.columns + 2 * self.network.pieces.len())
    }
}
