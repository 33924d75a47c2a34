//! Small convex quadratic programs. The only file that names Clarabel.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSettingsBuilderError, DefaultSolver, IPSolver,
    NonnegativeConeT, SolverStatus, ZeroConeT,
};

/// `min ½xᵀPx + qᵀx` with equalities and upper bounds on rows, all sparse.
#[derive(Clone, Debug)]
pub struct Program {
    /// Entries of P's upper triangle; those at one place add up.
    quadratic: Vec<(usize, usize, f64)>,
    linear: Vec<f64>,
    equalities: Vec<Row>,
    uppers: Vec<Row>,
}

/// Coefficients by unknown, and the value or bound of their sum.
type Row = (Vec<(usize, f64)>, f64);

/// A program that the solver gave up.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the quadratic program is not solved: {status}")]
pub struct Unsolved {
    /// What the solver says.
    pub status: String,
}

impl Program {
    /// Of so many unknowns, nothing asked of them yet.
    pub fn new(unknowns: usize) -> Self {
        Self {
            quadratic: Vec::new(),
            linear: vec![0.0; unknowns],
            equalities: Vec::new(),
            uppers: Vec::new(),
        }
    }

    /// Adds `weight (x − center)²` to what is made least.
    pub fn add_square(&mut self, unknown: usize, weight: f64, center: f64) {
        self.add_product(unknown, unknown, weight);
        self.linear[unknown] -= 2.0 * weight * center;
    }

    /// Adds the entry of `xᵀ(weight)x` at `row` and `column`, and the one across the diagonal; `row ≤ column`.
    pub fn add_product(&mut self, row: usize, column: usize, weight: f64) {
        self.quadratic.push((row, column, 2.0 * weight));
    }

    /// Adds `weight x`.
    pub fn add_linear(&mut self, unknown: usize, weight: f64) {
        self.linear[unknown] += weight;
    }

    /// Asks for `row · x = value`; coefficients should be of order 1.
    pub fn add_equality(&mut self, row: &[(usize, f64)], value: f64) {
        self.equalities.push((row.to_vec(), value));
    }

    /// Asks for `row · x ≤ bound`.
    pub fn add_upper(&mut self, row: &[(usize, f64)], bound: f64) {
        self.uppers.push((row.to_vec(), bound));
    }

    /// The unknowns. `gap`: how far the objective may be from the least, absolute; bounds hold to the solver's tolerance of 1e-8.
    /// Cost: a few dozen factorisations of the sparse system.
    ///
    /// # Errors
    /// [`Unsolved`] where the program has no solution or the solver finds none.
    pub fn solve(self, gap: f64) -> Result<Vec<f64>, Unsolved> {
        let unknowns = self.linear.len();
        let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
        let mut bounds = Vec::new();
        for (row, bound) in self.equalities.iter().chain(&self.uppers) {
            for (column, value) in row {
                rows.push(bounds.len());
                columns.push(*column);
                values.push(*value);
            }
            bounds.push(*bound);
        }
        let constraints = CscMatrix::new_from_triplets(bounds.len(), unknowns, rows, columns, values);
        let [rows, columns] = [|entry: &(usize, usize, f64)| entry.0, |entry: &(usize, usize, f64)| entry.1]
            .map(|part| self.quadratic.iter().map(part).collect());
        let values = self.quadratic.iter().map(|entry| entry.2).collect();
        let quadratic = CscMatrix::new_from_triplets(unknowns, unknowns, rows, columns, values);
        let cones = [ZeroConeT(self.equalities.len()), NonnegativeConeT(self.uppers.len())];
        let unsolved = |status: String| Unsolved { status };
        let settings = settings(gap).map_err(|error| unsolved(error.to_string()))?;
        let mut solver =
            DefaultSolver::new(&quadratic, &self.linear, &constraints, &bounds, &cones, settings)
                .map_err(|error| unsolved(error.to_string()))?;
        solver.solve();
        let solution = solver.solution;
        // Nearly solved is to 1e-4 or better.
        let is_solved = matches!(solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
        if is_solved && solution.x.iter().all(|x| x.is_finite()) {
            return Ok(solution.x);
        }
        Err(unsolved(format!("{:?}", solution.status)))
    }
}

fn settings(gap: f64) -> Result<DefaultSettings<f64>, DefaultSettingsBuilderError> {
    DefaultSettingsBuilder::default().verbose(false).tol_gap_abs(gap).tol_gap_rel(1e-9).build()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_projected_onto_a_corner() {
        // The nearest to (2, 3) with x + y = 1 + z, z = 0, x ≤ 0.25.
        let mut program = Program::new(3);
        program.add_square(0, 1.0, 2.0);
        program.add_square(1, 1.0, 3.0);
        program.add_equality(&[(0, 1.0), (1, 1.0), (2, -1.0)], 1.0);
        program.add_equality(&[(2, 1.0)], 0.0);
        program.add_upper(&[(0, 1.0)], -0.25);
        let found = program.solve(1e-12).expect("it has a solution");
        for (found, expected) in found.iter().zip([-0.25, 1.25, 0.0]) {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
    }

    #[test]
    fn what_contradicts_is_told() {
        let mut program = Program::new(1);
        program.add_upper(&[(0, 1.0)], 0.0);
        program.add_upper(&[(0, -1.0)], -1.0);
        assert!(program.solve(1e-9).is_err());
    }
}
