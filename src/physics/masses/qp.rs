//! The quadratic programs of masses. The only file that names Clarabel.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSettingsBuilder, DefaultSettingsBuilderError, DefaultSolver, IPSolver,
    NonnegativeConeT, SolverStatus, ZeroConeT,
};
use glam::DVec2;

use super::{MassError, MassProblem};
use crate::physics::GRAVITY;

/// Factors of the groups' masses, and one slack a frame: see [`MassProblem::solve`].
pub(super) fn solve(problem: &MassProblem, pull: f64, least: f64) -> Result<Vec<f64>, MassError> {
    let (groups, frames) = (problem.masses.len(), problem.frames.len());
    let weight = problem.masses.iter().sum::<f64>() * GRAVITY;
    let mut program = Program::new(groups + frames);
    for (group, count) in problem.counts.iter().enumerate() {
        program.add_square(group, pull * count, 1.0);
    }
    program.add_equality(&problem.masses, weight / GRAVITY);
    for group in 0..groups {
        program.add_upper(&[(group, -1.0)], -least);
    }
    for (frame, own) in problem.frames.iter().enumerate() {
        let slack = groups + frame;
        program.add_square(slack, 1.0, 0.0);
        program.add_upper(&[(slack, -1.0)], 0.0);
        for (outwards, offset) in half_planes(&own.corners) {
            let entry =
                |[x, z, force]: &[f64; 3]| (outwards.x * x + outwards.y * z - offset * force) / weight;
            let mut row: Vec<(usize, f64)> = own.groups.iter().map(entry).enumerate().collect();
            row.push((slack, -1.0));
            program.add_upper(&row, 0.0);
        }
    }
    let mut solution = program.solve()?;
    solution.truncate(groups);
    Ok(solution)
}

/// Least squares over few unknowns: `Σ (rows · x)² + Σ weight (x − 1)²` with `masses · x = Σ masses`, `x ≥ 0`.
///
/// `gram`: rows' products, square and symmetric.
pub(super) fn solve_dense(gram: &[Vec<f64>], weights: &[f64], masses: &[f64]) -> Result<Vec<f64>, MassError> {
    let mut program = Program::new(masses.len());
    for (row, products) in gram.iter().enumerate() {
        for (column, product) in products.iter().enumerate().skip(row) {
            program.quadratic.push((row, column, 2.0 * product));
        }
        program.add_square(row, weights[row], 1.0);
        program.add_upper(&[(row, -1.0)], 0.0);
    }
    program.add_equality(masses, masses.iter().sum());
    // Bounds hold to the solver's tolerance.
    Ok(program.solve()?.into_iter().map(|factor| factor.max(0.0)).collect())
}

/// Outward unit normals and offsets of the half-planes whose intersection a polygon is: two pairs of opposite ones for a point or a
/// segment.
fn half_planes(corners: &[DVec2]) -> Vec<(DVec2, f64)> {
    let bounds = |along: DVec2, from: DVec2, to: DVec2| [(along, along.dot(to)), (-along, -along.dot(from))];
    match *corners {
        [point] => [DVec2::X, DVec2::Y].into_iter().flat_map(|axis| bounds(axis, point, point)).collect(),
        [a, b] => {
            let along = (b - a).normalize();
            [bounds(along, a, b), bounds(along.perp(), a, a)].concat()
        }
        _ => {
            let next = corners.iter().skip(1).chain(corners.first());
            let edge = |(a, b): (&DVec2, &DVec2)| {
                let outwards = -(b - a).normalize().perp();
                (outwards, outwards.dot(*a))
            };
            corners.iter().zip(next).map(edge).collect()
        }
    }
}

/// `min ½xᵀPx + qᵀx` with one equality and any number of upper bounds on rows.
struct Program {
    /// Entries of P's upper triangle; those at one place add up.
    quadratic: Vec<(usize, usize, f64)>,
    linear: Vec<f64>,
    equality: (Vec<(usize, f64)>, f64),
    uppers: Vec<(Vec<(usize, f64)>, f64)>,
}

impl Program {
    fn new(unknowns: usize) -> Self {
        Self {
            quadratic: Vec::new(),
            linear: vec![0.0; unknowns],
            equality: (Vec::new(), 0.0),
            uppers: Vec::new(),
        }
    }

    /// Adds `weight (x − center)²`.
    fn add_square(&mut self, unknown: usize, weight: f64, center: f64) {
        self.quadratic.push((unknown, unknown, 2.0 * weight));
        self.linear[unknown] -= 2.0 * weight * center;
    }

    fn add_equality(&mut self, coefficients: &[f64], value: f64) {
        // Of order 1 as the other rows are.
        let row = coefficients.iter().map(|coefficient| coefficient / value).enumerate();
        self.equality = (row.collect(), 1.0);
    }

    fn add_upper(&mut self, row: &[(usize, f64)], bound: f64) {
        self.uppers.push((row.to_vec(), bound));
    }

    fn solve(self) -> Result<Vec<f64>, MassError> {
        let unknowns = self.linear.len();
        let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
        let (mut bounds, mut count) = (Vec::new(), 0);
        for (row, bound) in std::iter::once(&self.equality).chain(&self.uppers) {
            for (column, value) in row {
                rows.push(count);
                columns.push(*column);
                values.push(*value);
            }
            bounds.push(*bound);
            count += 1;
        }
        let constraints = CscMatrix::new_from_triplets(count, unknowns, rows, columns, values);
        let [rows, columns] = [|entry: &(usize, usize, f64)| entry.0, |entry: &(usize, usize, f64)| entry.1]
            .map(|part| self.quadratic.iter().map(part).collect());
        let values = self.quadratic.iter().map(|entry| entry.2).collect();
        let quadratic = CscMatrix::new_from_triplets(unknowns, unknowns, rows, columns, values);
        let cones = [ZeroConeT(1), NonnegativeConeT(count - 1)];
        let unsolved = |status: String| MassError::Unsolved { status };
        let settings = settings().map_err(|error| unsolved(error.to_string()))?;
        let mut solver =
            DefaultSolver::new(&quadratic, &self.linear, &constraints, &bounds, &cones, settings)
                .map_err(|error| unsolved(error.to_string()))?;
        solver.solve();
        let solution = solver.solution;
        // Nearly solved is to 1e-4 or better, far below what is asked of masses.
        let is_solved = matches!(solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
        if is_solved && solution.x.iter().all(|x| x.is_finite()) {
            return Ok(solution.x);
        }
        Err(unsolved(format!("{:?}", solution.status)))
    }
}

/// Objectives are squares of millimetres: the solver's own tolerances would be as large as they are.
fn settings() -> Result<DefaultSettings<f64>, DefaultSettingsBuilderError> {
    const TIGHT: f64 = 1e-13;
    DefaultSettingsBuilder::default().verbose(false).tol_gap_abs(TIGHT).tol_gap_rel(1e-9).build()
}
