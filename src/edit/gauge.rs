//! Free motions that too few constraints leave, and the rows that fix them at the least change.
//!
//! Shape rows do not see a similarity of a path, scale rows not a shift and an even stretch; what the constraints do not
//! decide either stays as at rest. Rows along these motions cost no energy and bias nothing else.

use std::collections::BTreeMap;

use cotillion_solvers::{RowMatrix, analyse_rank};

use crate::edit::hold::{Phase, Term};
use crate::edit::settings::RunMode;
use crate::geometry::c64;
use crate::path::{COINCIDENT, RestPath};

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

/// A combination of motions: motion, share; rising.
type Combination = Vec<(usize, c64)>;

/// Rows that fix the free motions of a component: orthonormal coefficients on the points of its paths.
///
/// `functionals`: all held rows of the phase. Cost: linear in frames; near linear in paths where constraints tie
/// neighbours only, as their sparse elimination is.
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
    let on_frames = |(row, share): (usize, c64)| {
        let (path, motion) = &motions[row];
        motion.iter().enumerate().map(move |(frame, value)| (*path, frame, (share * value).conj()))
    };
    free_combinations(&motions, paths.len(), functionals)
        .into_iter()
        .map(|combination| combination.into_iter().flat_map(on_frames).collect())
        .collect()
}

/// Combinations of `motions` that no functional sees, orthonormal: the dependencies among what functionals see of each.
fn free_combinations(
    motions: &[(usize, Vec<c64>)],
    path_count: usize,
    functionals: &[Vec<Term>],
) -> Vec<Combination> {
    let mut of_path: Vec<Vec<usize>> = vec![Vec::new(); path_count];
    for (index, (path, _)) in motions.iter().enumerate() {
        of_path[*path].push(index);
    }
    let mut seen: Vec<Combination> = vec![Vec::new(); motions.len()];
    for (row, terms) in functionals.iter().enumerate() {
        let length = terms.iter().map(|(_, _, factor)| factor.norm_sqr()).sum::<f64>().sqrt();
        for (path, frame, factor) in terms {
            for motion in &of_path[*path] {
                seen[*motion].push((row, factor * motions[*motion].1[*frame] / length));
            }
        }
    }
    let mut matrix = RowMatrix::new(functionals.len().max(1));
    for own in &seen {
        matrix.push_row(own);
    }
    let dependent = analyse_rank(&matrix.to_csr()).dependent;
    orthonormal(dependent.into_iter().map(|dependency| dependency.combination))
}

/// Modified Gram–Schmidt, twice, on sparse vectors that are independent.
fn orthonormal(vectors: impl Iterator<Item = Combination>) -> Vec<Combination> {
    let mut basis: Vec<Combination> = Vec::new();
    for mut vector in vectors {
        vector.sort_unstable_by_key(|(index, _)| *index);
        for _ in 0..2 {
            for known in &basis {
                let share = dot(known, &vector);
                if share != c64::default() {
                    vector = less(&vector, share, known);
                }
            }
            let length = vector.iter().map(|(_, value)| value.norm_sqr()).sum::<f64>().sqrt();
            vector.iter_mut().for_each(|(_, value)| *value /= length);
        }
        basis.push(vector);
    }
    basis
}

/// `aᴴb` of sparse vectors.
fn dot(a: &Combination, b: &Combination) -> c64 {
    let value = |(index, x): &(usize, c64)| {
        b.binary_search_by_key(index, |(other, _)| *other)
            .map_or(c64::default(), |place| x.conj() * b[place].1)
    };
    a.iter().map(value).sum()
}

/// `a − share·b` of sparse vectors.
fn less(a: &Combination, share: c64, b: &Combination) -> Combination {
    let mut sum: BTreeMap<usize, c64> = a.iter().copied().collect();
    for (index, value) in b {
        *sum.entry(*index).or_default() -= share * value;
    }
    sum.into_iter().collect()
}
