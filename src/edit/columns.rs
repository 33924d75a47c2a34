//! Unknowns of the spatial systems: one per free frame, two per stationary stretch, one per repeated point.

use crate::edit::hold::{Phase, Term};
use crate::edit::settings::RunMode;
use crate::geometry::c64;
use crate::path::RestPath;

/// How the point of one frame is made of unknowns: `x_column + q·x_second + constant`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameColumns {
    /// First unknown.
    pub column: usize,
    /// Second unknown with its factor q, inside a stretch that keeps its shape up to similarity.
    pub second: Option<(usize, c64)>,
    /// Stationary stretch (by position in the path's list) whose rotation decides the constant: rigid stretches in the
    /// scale phase.
    pub run: Option<usize>,
}

/// Unknowns of several paths.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    /// By path, then frame.
    pub frames: Vec<Vec<FrameColumns>>,
    /// Number of unknowns.
    pub count: usize,
}

impl Columns {
    /// Numbers the unknowns of `paths` for `phase`. `released`: stretches, by path and position, that lost their rigidity.
    pub fn new(paths: &[RestPath], phase: Phase, runs: RunMode, released: &[(usize, usize)]) -> Self {
        let mut columns = Self::default();
        for (index, path) in paths.iter().enumerate() {
            let kept = |run: usize| !released.contains(&(index, run));
            let frames = columns.number(path, phase, runs, kept);
            columns.frames.push(frames);
        }
        columns
    }

    fn number(
        &mut self,
        path: &RestPath,
        phase: Phase,
        runs: RunMode,
        kept: impl Fn(usize) -> bool,
    ) -> Vec<FrameColumns> {
        let mut frames: Vec<Option<FrameColumns>> = vec![None; path.len()];
        for (run, (first, last)) in path.rigid.iter().enumerate().filter(|(run, _)| kept(*run)) {
            let rigid = phase == Phase::Scale && runs == RunMode::Rigid;
            self.number_run(path, (*first, *last), rigid.then_some(run), &mut frames);
        }
        for frame in 0..path.len() {
            if frames[frame].is_some() {
                continue;
            }
            let shared = if phase == Phase::Shape { shared_point(path, frame, &frames) } else { None };
            if shared.is_none() {
                frames[frame] = Some(FrameColumns { column: self.count, second: None, run: None });
                self.count += 1;
            } else {
                frames[frame] = shared;
            }
        }
        frames.into_iter().flatten().collect()
    }

    fn number_run(
        &mut self,
        path: &RestPath,
        (first, last): (usize, usize),
        rigid: Option<usize>,
        frames: &mut [Option<FrameColumns>],
    ) {
        let points = &path.positions[first..=last];
        let centre = points.iter().sum::<c64>() / points.len() as f64;
        let extent = points.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max);
        let turns = rigid.is_none() && extent > crate::path::COINCIDENT * (1.0 + centre.norm());
        for (frame, own) in (first..=last).zip(&mut frames[first..=last]) {
            let q = || (path.positions[frame] - centre) / extent;
            *own = Some(FrameColumns {
                column: self.count,
                second: turns.then(|| (self.count + 1, q())),
                run: rigid,
            });
        }
        self.count += if turns { 2 } else { 1 };
    }

    /// Adds the columns of `terms` to `row`, and to `constants` the terms whose frames also have a constant.
    pub fn expand(&self, terms: &[Term], row: &mut Vec<(usize, c64)>, constants: &mut Vec<Term>) {
        for (path, frame, factor) in terms.iter().copied() {
            let columns = self.frames[path][frame];
            row.push((columns.column, factor));
            if let Some((second, q)) = columns.second {
                row.push((second, factor * q));
            }
            if columns.run.is_some() {
                constants.push((path, frame, factor));
            }
        }
    }

    /// Points of path `path` from the unknowns; `constant(frame, run)` gives a rigid stretch's constants.
    pub fn points(&self, path: usize, x: &[c64], constant: impl Fn(usize, usize) -> c64, out: &mut Vec<c64>) {
        out.clear();
        out.extend(self.frames[path].iter().enumerate().map(|(frame, columns)| {
            let mut point = x[columns.column];
            if let Some((second, q)) = columns.second {
                point += q * x[second];
            }
            if let Some(run) = columns.run {
                point += constant(frame, run);
            }
            point
        }));
    }
}

/// Unknowns of an earlier frame, or of a stationary stretch ahead, at the very same point.
fn shared_point(path: &RestPath, frame: usize, frames: &[Option<FrameColumns>]) -> Option<FrameColumns> {
    if frame > 0 && path.coincide(frame - 1, frame) {
        return frames[frame - 1];
    }
    (frame + 1..path.len()).take_while(|next| path.coincide(next - 1, *next)).find_map(|next| frames[next])
}
