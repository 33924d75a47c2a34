//! Free motions that too few constraints leave, and the rows that fix them at the least change.
//!
//! Shape rows do not see a similarity of a path, scale rows not a shift and an even stretch; what the constraints do not
//! decide either stays as at rest. Rows along these motions cost no energy and bias nothing else.

use cotillion_solvers::{Combination, PointRow, free_combinations};

use crate::edit::columns::Freedom;
use crate::edit::hold::{Phase, Term};
use crate::edit::settings::RunMode;
use crate::geometry::c64;
use crate::path::{COINCIDENT, RestPath};

/// Orthonormal motions of one path that its rows do not see: by motion, then frame.
fn invisible_motions(
    path: &RestPath,
    phase: Phase,
    fixed_slope: bool,
    frame_of: impl Fn(usize) -> usize,
) -> Vec<Vec<c64>> {
    let count = path.len();
    let shift = vec![c64::new(1.0 / (count as f64).sqrt(), 0.0); count];
    let raw: Vec<c64> = match phase {
        Phase::Shape => path.positions.clone(),
        Phase::Scale if fixed_slope => return vec![shift],
        Phase::Scale => (0..count).map(|frame| c64::new(frame_of(frame) as f64, 0.0)).collect(),
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
/// `held`: all held rows of the phase. Cost: linear in frames; near linear in paths where constraints tie neighbours only,
/// as their sparse elimination is.
pub fn rows(freedom: Freedom, held: &[PointRow<c64>]) -> Vec<Vec<Term>> {
    let mut motions: Vec<(usize, Vec<c64>)> = Vec::new();
    let mut groups = vec![0];
    for (index, path) in freedom.paths.iter().enumerate() {
        let fixed_slope = freedom.kept_runs(index).next().is_some() && freedom.runs == RunMode::Rigid;
        let sampling = freedom.samplings.get(index);
        let frame_of = |frame: usize| sampling.map_or(frame, |sampling| sampling.frames[frame]);
        for motion in invisible_motions(path, freedom.phase, fixed_slope, frame_of) {
            motions.push((index, motion));
        }
        groups.push(motions.len());
    }
    let mut seen: Vec<Combination> = vec![Vec::new(); motions.len()];
    for (row, held) in held.iter().enumerate() {
        let length = held.terms.iter().map(|(_, _, factor)| factor.norm_sqr()).sum::<f64>().sqrt();
        if length == 0.0 {
            continue;
        }
        for (path, frame, factor) in &held.terms {
            for motion in groups[*path]..groups[*path + 1] {
                add(&mut seen[motion], row, factor * motions[motion].1[*frame] / length);
            }
        }
    }
    let on_frames = |(row, share): (usize, c64)| {
        let (path, motion) = &motions[row];
        motion.iter().enumerate().map(move |(frame, value)| (*path, frame, (share * value).conj()))
    };
    free_combinations(&seen, &groups, held.len())
        .into_iter()
        .map(|combination| combination.into_iter().flat_map(on_frames).collect())
        .collect()
}

/// Adds what `row`, the last or the next, sees.
fn add(seen: &mut Combination, row: usize, value: c64) {
    match seen.last_mut() {
        Some((last, sum)) if *last == row => *sum += value,
        _ => seen.push((row, value)),
    }
}
