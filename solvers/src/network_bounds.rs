//! Networks whose steps have bounds: the dual active-set method on the factored sparse system.
//!
//! All n steps of a piece k are alike, so `min ≤ step ≤ max` is two inequalities on its delays,
//!
//! ```text
//!     row 2k:      x_b − x_a ≥ n (min − step)          row 2k+1:    x_a − x_b ≥ −n (max − step)
//! ```
//!
//! and their normals are multiples of the piece's own soft row, `c = ± √(n/w) M_k`. So a force on a bound is a shifted target
//! of its spring, and `K⁻¹c`, the response to it, is one solve with the factor of the network without bounds. For the active
//! rows `W` and a violated row p,
//!
//! ```text
//!     S r = s,    S = C_W K⁻¹ C_Wᵀ,   s = C_W K⁻¹ c_p,        direction  z = K⁻¹ (c_p − C_Wᵀ r),
//! ```
//!
//! with `S` as large as the active set, its Cholesky factor updated row by row.
//!
//! Source: Goldfarb and Idnani, *A numerically stable dual method for solving strictly convex quadratic programs*, Math.
//! Programming 27 (1983); Schur complement of the active set: Gill, Murray, Saunders and Wright, *A Schur-complement method for
//! sparse quadratic programming* (1990).

use crate::bounds::{CURVATURE_TOLERANCE, Program, Step, dual_active_set, full_length, step_limit};
use crate::error::BoundsError;
use crate::kkt::{Factor, Workspace};
use crate::network::{Network, Piece};
use crate::quadratic::{BoundedQp, BoundedSolution, VIOLATION_TOLERANCE};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
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
    /// The most violated of the inequalities `2k`, `2k + 1` on every piece k.
    fn worst_row(&self, range: StepRange, x: &[f64]) -> Option<usize> {
        let sides =
            self.pieces.iter().enumerate().flat_map(|(k, piece)| [(2 * k, piece), (2 * k + 1, piece)]);
        let violated = sides.filter_map(|(row, piece)| {
            let bound = bound(piece, row, self.step, range);
            let (a, b) = (x[piece.from], x[piece.from + 1]);
            let missing = bound - sign(row) * (b - a);
            (missing > VIOLATION_TOLERANCE * (bound.abs() + a.abs() + b.abs())).then_some((row, missing))
        });
        Some(violated.reduce(|a, b| if b.1 > a.1 { b } else { a })?.0)
    }

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

    /// Solves the network with bounds on its steps. `factor`: of the network's problem; `m`, `h`: its targets.
    ///
    /// Inequalities are numbered as above, two a piece; equalities as the hard rows of the problem. Cost: two sparse solves
    /// and the square of the active set for every row that becomes active or ceases to be.
    ///
    /// # Errors
    /// [`BoundsError::Infeasible`] if hard rows and bounds contradict each other; [`BoundsError::Solve`] for targets that are
    /// not finite, or if the factor is of another problem.
    pub fn solve_within(
        &self,
        factor: &Factor<f64>,
        targets: (&[f64], &[f64]),
        range: StepRange,
    ) -> Result<BoundedSolution, BoundsError> {
        let mut program = SparseProgram::new(self, factor, targets, range);
        let mut solution = dual_active_set(&mut program)?;
        program.polish(&mut solution)?;
        Ok(solution)
    }
}

/// +1 for the row that bounds a piece from below, −1 for the one from above.
fn sign(row: usize) -> f64 {
    if row % 2 == 0 { 1.0 } else { -1.0 }
}

/// Right-hand side of a row.
fn bound(piece: &Piece, row: usize, step: f64, range: StepRange) -> f64 {
    let limit = if row % 2 == 0 { range.min } else { range.max };
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
    factor: &'a Factor<f64>,
    workspace: Workspace<f64>,
    range: StepRange,
    targets: (&'a [f64], &'a [f64]),
    /// Targets of springs shifted by forces on bounds; zero targets of hard rows.
    forces: Vec<f64>,
    still: Vec<f64>,
    /// The row of the last step, and `K⁻¹c` of it.
    response: Option<(usize, DVector<f64>)>,
    schur: Cholesky<f64, Dyn>,
    /// Curvature that is rounding.
    least: f64,
}

impl<'a> SparseProgram<'a> {
    fn new(
        network: &'a Network,
        factor: &'a Factor<f64>,
        targets: (&'a [f64], &'a [f64]),
        range: StepRange,
    ) -> Self {
        let mut stiffness = vec![0.0; network.problem.columns];
        for row in network.problem.soft.outer_iterator() {
            row.iter().for_each(|(j, a)| stiffness[j] += a * a);
        }
        // The largest entry of a positive semidefinite matrix is on its diagonal; a normal is (1, −1).
        let stiffest = stiffness.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        Self {
            network,
            factor,
            workspace: factor.workspace(),
            range,
            targets,
            forces: vec![0.0; targets.0.len()],
            still: vec![0.0; targets.1.len()],
            response: None,
            schur: Cholesky::pack_dirty(DMatrix::zeros(0, 0)),
            least: CURVATURE_TOLERANCE * 2.0 / stiffest,
        }
    }

    fn piece(&self, row: usize) -> &Piece {
        &self.network.pieces[row / 2]
    }

    /// `c x`.
    fn along(&self, row: usize, x: &[f64]) -> f64 {
        let Piece { from, .. } = *self.piece(row);
        sign(row) * (x[from + 1] - x[from])
    }

    /// Adds a force on a bound.
    fn push(&mut self, row: usize, force: f64) {
        let Piece { steps, weight, .. } = *self.piece(row);
        self.forces[row / 2] += sign(row) * force * (steps as f64 / weight).sqrt();
    }

    /// `K⁻¹` of the forces, which are taken off again. Multipliers of the hard rows are left in the workspace.
    fn respond(&mut self) -> Result<DVector<f64>, BoundsError> {
        let mut x = DVector::zeros(self.network.problem.columns);
        self.factor.solve_into(&self.forces, &self.still, x.as_mut_slice(), &mut self.workspace)?;
        self.forces.fill(0.0);
        Ok(x)
    }

    /// Solves for the multipliers' sake once more: `x` to the accuracy of one sparse solve, active rows met to rounding.
    fn polish(&mut self, solution: &mut BoundedSolution) -> Result<(), BoundsError> {
        let (m, h) = self.targets;
        for _ in 0..2 {
            self.forces.copy_from_slice(m);
            for (row, force) in solution.active.iter().zip(&solution.multipliers) {
                self.push(*row, *force);
            }
            self.factor.solve_into(&self.forces, h, &mut solution.x, &mut self.workspace)?;
            let missing = solution.active.iter().map(|row| {
                bound(self.piece(*row), *row, self.network.step, self.range) - self.along(*row, &solution.x)
            });
            let missing = DVector::from_iterator(solution.active.len(), missing);
            let change = self.schur.solve(&missing);
            solution.multipliers.iter_mut().zip(change.iter()).for_each(|(u, d)| *u = (*u + d).max(0.0));
        }
        Ok(())
    }
}

impl Program for SparseProgram<'_> {
    fn start(&mut self) -> Result<DVector<f64>, BoundsError> {
        let mut x = DVector::zeros(self.network.problem.columns);
        let (m, h) = self.targets;
        self.factor.solve_into(m, h, x.as_mut_slice(), &mut self.workspace)?;
        Ok(x)
    }

    fn worst(&self, x: &DVector<f64>) -> Option<usize> {
        self.network.worst_row(self.range, x.as_slice())
    }

    fn toward(&mut self, row: usize, active: &[usize], x: &DVector<f64>) -> Result<Step, BoundsError> {
        let response = match self.response.take() {
            Some((known, response)) if known == row => response,
            _ => {
                self.push(row, 1.0);
                self.respond()?
            }
        };
        let shared = active.iter().map(|other| self.along(*other, response.as_slice()));
        let relief = self.schur.solve(&DVector::from_iterator(active.len(), shared));
        self.response = Some((row, response));
        self.push(row, 1.0);
        active.iter().zip(relief.iter()).for_each(|(other, r)| self.push(*other, -r));
        let direction = self.respond()?;
        let missing =
            bound(self.piece(row), row, self.network.step, self.range) - self.along(row, x.as_slice());
        let curvature = self.along(row, direction.as_slice());
        Ok(Step {
            full_length: full_length(missing, curvature, self.least),
            relief: relief.as_slice().to_vec(),
            equality_relief: self.workspace.multipliers().to_vec(),
            direction,
            missing,
        })
    }

    fn activate(&mut self, active: &[usize]) {
        let Some((_, response)) = self.response.take() else { return };
        let column = active.iter().map(|other| self.along(*other, response.as_slice()));
        let column = DVector::from_iterator(active.len(), column);
        self.schur = self.schur.insert_column(active.len() - 1, column);
    }

    fn release(&mut self, place: usize) {
        self.schur = self.schur.remove_column(place);
    }

    fn step_limit(&self) -> usize {
        step_limit(self.network.problem.columns + 2 * self.network.pieces.len())
    }
}
