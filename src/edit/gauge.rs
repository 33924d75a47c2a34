//! Free motions that too few constraints leave, and the rows that fix them at the least change.
//!
//! Shape rows do not see a similarity of a path, scale rows not a shift and an even stretch; what the constraints do not
//! decide either stays as at rest. Rows along these motions cost no energy and bias nothing else.

use cotillion_solvers::{DMatrix, null_space};

use crate::edit::hold::{Phase, Term};
use crate::edit::settings::RunMode;
use crate::geometry::c64;
use crate::path::{COINCIDENT, RestPath};

/// Singular values below this share of the largest are free motions.
const FREE: f64 = 1e-9;

/// Orthonormal motions of one path that its rows do not see: by motion, then frame.
fn invisible_motions(path: &RestPath, phase: Phase, fixed_slope: bool) -> Vec<Vec<c64>> {
    let count = path.len();
    let shift = vec![c64::new(1.0 / (count as f64).sqrt(), 0.0); count];
    let raw: Vec<c64> = match phase {
        Phase::Shape => path.positions.clone(),
        Phase::Scale if fixed_slope => return vec![shift],
        Phase::Scale => (0..count).map(|frame| c64::new(frame as f64, 0.0)).collect(),
    };
    let centre = raw.iter().sum::<c64>() / count as f64;
    let centred: Vec<c64> = raw.iter().map(|p| p - centre).collect();
    let length = centred.iter().map(c64::norm_sqr).sum::<f64>().sqrt();
    if length <= COINCIDENT * (1.0 + centre.norm()) * (count as f64).sqrt() {
        return vec![shift];
    }
    vec![shift, centred.into_iter().map(|p| p / length).collect()]
}

/// Rows that fix the free motions of a component: orthonormal coefficients on the points of its paths.
///
/// `functionals`: all held rows of the phase. Cost: cubic in the number of paths.
pub fn rows(
    paths: &[RestPath],
    functionals: &[Vec<Term>],
    phase: Phase,
    runs: RunMode,
    released: &[(usize, usize)],
) -> Vec<Vec<Term>> {
    let mut motions: Vec<(usize, Vec<c64>)> = Vec::new();
    for (index, path) in paths.iter().enumerate() {
        let has_run = (0..path.rigid.len()).any(|run| !released.contains(&(index, run)));
        let fixed_slope = has_run && runs == RunMode::Rigid;
        let own = invisible_motions(path, phase, fixed_slope);
        motions.extend(own.into_iter().map(|motion| (index, motion)));
    }
    let free = free_combinations(&motions, functionals);
    (0..free.ncols())
        .map(|column| {
            motions
                .iter()
                .enumerate()
                .filter(|(row, _)| free[(*row, column)].norm() > 1e-14)
                .flat_map(|(row, (path, motion))| {
                    let share = free[(row, column)];
                    motion
                        .iter()
                        .enumerate()
                        .map(move |(frame, value)| (*path, frame, (share * value).conj()))
                })
                .collect()
        })
        .collect()
}

/// Combinations of `motions` that no functional sees, as orthonormal columns.
fn free_combinations(motions: &[(usize, Vec<c64>)], functionals: &[Vec<Term>]) -> DMatrix<c64> {
    let mut seen: DMatrix<c64> = DMatrix::from_element(functionals.len(), motions.len(), c64::default());
    for (row, terms) in functionals.iter().enumerate() {
        let length = terms.iter().map(|(_, _, factor)| factor.norm_sqr()).sum::<f64>().sqrt();
        for (column, (path, motion)) in motions.iter().enumerate() {
            let own = terms.iter().filter(|(p, _, _)| p == path);
            seen[(row, column)] = own.map(|(_, frame, factor)| factor * motion[*frame]).sum::<c64>() / length;
        }
    }
    null_space(&seen, FREE)
}
