//! The quadratic programs of masses.

use glam::DVec2;

use super::{MassError, MassProblem};
use crate::physics::GRAVITY;
use crate::quadratic::{Program, Unsolved};

/// Objectives are squares of millimetres: the solver's own tolerance of the gap would be as large as they are.
const TIGHT: f64 = 1e-13;

impl From<Unsolved> for MassError {
    fn from(Unsolved { status }: Unsolved) -> Self {
        Self::Unsolved { status }
    }
}

/// Factors of the groups' masses, and one slack a frame: see [`MassProblem::solve`].
pub(super) fn solve(problem: &MassProblem, pull: f64, least: f64) -> Result<Vec<f64>, MassError> {
    let (groups, frames) = (problem.masses.len(), problem.frames.len());
    let weight = problem.masses.iter().sum::<f64>() * GRAVITY;
    let mut program = Program::new(groups + frames);
    for (group, count) in problem.counts.iter().enumerate() {
        program.add_square(group, pull * count, 1.0);
    }
    add_total(&mut program, &problem.masses);
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
    let mut solution = program.solve(TIGHT)?;
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
            program.add_product(row, column, *product);
        }
        program.add_square(row, weights[row], 1.0);
        program.add_upper(&[(row, -1.0)], 0.0);
    }
    add_total(&mut program, masses);
    // Bounds hold to the solver's tolerance.
    Ok(program.solve(TIGHT)?.into_iter().map(|factor| factor.max(0.0)).collect())
}

/// The factors of `masses` keep their sum.
fn add_total(program: &mut Program, masses: &[f64]) {
    // Of order 1 as the other rows are.
    let total: f64 = masses.iter().sum();
    let row: Vec<(usize, f64)> = masses.iter().map(|mass| mass / total).enumerate().collect();
    program.add_equality(&row, 1.0);
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
