//! Unknowns of the spatial systems: one per free frame, two per stationary stretch, one per repeated point.

use std::sync::Arc;

use crate::edit::hold::{Phase, Term};
use crate::edit::sampling::Sampling;
use crate::edit::settings::RunMode;
use crate::geometry::c64;
use crate::path::{COINCIDENT, RestPath};

/// How the point of one frame is made of unknowns: `x_column + q·x_second`, less what the rest path has at the stretch's start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameColumns {
    /// First unknown.
    pub column: usize,
    /// Second unknown with its factor q, inside a stretch that keeps its shape up to similarity.
    pub second: Option<(usize, c64)>,
}

/// Unknowns of several paths, of all frames or of those that rows touch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    paths: Vec<PathColumns>,
    /// Number of unknowns.
    pub count: usize,
}

#[derive(Clone, Debug, Default, PartialEq)]
struct PathColumns {
    /// Rising.
    frames: Vec<usize>,
    /// As long.
    columns: Vec<FrameColumns>,
}

/// What decides the unknowns of a group of paths.
#[derive(Clone, Copy, Debug)]
pub struct Freedom<'a> {
    /// Rest paths.
    pub paths: &'a [Arc<RestPath>],
    /// Which of the two edits.
    pub phase: Phase,
    /// What stationary stretches keep in the scale phase.
    pub runs: RunMode,
    /// Stretches, by path and position, that lost their rigidity; rising.
    pub released: &'a [(usize, usize)],
    /// Of each path that has fewer frames than it is performed in; empty where none has.
    pub samplings: &'a [Sampling],
}

impl<'a> Freedom<'a> {
    /// Stationary stretches of a path that are kept, first and last frame.
    pub fn kept_runs(self, path: usize) -> impl Iterator<Item = (usize, usize)> + 'a {
        let kept =
            move |(run, _): &(usize, &(usize, usize))| self.released.binary_search(&(path, *run)).is_err();
        self.paths[path].rigid.iter().enumerate().filter(kept).map(|(_, run)| *run)
    }
}

impl Columns {
    /// Unknowns of all frames. Cost: linear in frames.
    pub fn all(freedom: Freedom) -> Self {
        let frames = freedom.paths.iter().map(|path| (0..path.len()).collect()).collect();
        Self::of_frames(freedom, frames)
    }

    /// One unknown for each frame, whatever ties it to others. Cost: linear in frames.
    pub fn one_per_frame(freedom: Freedom) -> Self {
        let mut count = 0;
        let own = |path: &Arc<RestPath>| {
            let first = count;
            count += path.len();
            let columns = (first..count).map(|column| FrameColumns { column, second: None }).collect();
            PathColumns { frames: (0..path.len()).collect(), columns }
        };
        let paths = freedom.paths.iter().map(own).collect();
        Self { paths, count }
    }

    /// Unknowns of the frames that rows touch. Cost: linear in terms.
    pub fn touched<'a>(freedom: Freedom, rows: impl IntoIterator<Item = &'a [Term]>) -> Self {
        let mut frames: Vec<Vec<usize>> = vec![Vec::new(); freedom.paths.len()];
        for (path, frame, _) in rows.into_iter().flatten() {
            frames[*path].push(*frame);
        }
        for own in &mut frames {
            own.sort_unstable();
            own.dedup();
        }
        Self::of_frames(freedom, frames)
    }

    /// Numbers the unknowns by path, then by the first frame that has them.
    fn of_frames(freedom: Freedom, frames: Vec<Vec<usize>>) -> Self {
        let mut count = 0;
        let mut paths = Vec::with_capacity(frames.len());
        for (path, frames) in frames.into_iter().enumerate() {
            let mut columns = owners(freedom, path, &frames);
            let both =
                |own: &FrameColumns| std::iter::once(own.column).chain(own.second.map(|second| second.0));
            let mut known: Vec<usize> = columns.iter().flat_map(both).collect();
            known.sort_unstable();
            known.dedup();
            let number = |owner: usize| count + known.partition_point(|other| *other < owner);
            for own in &mut columns {
                own.column = number(own.column);
                own.second = own.second.map(|(owner, q)| (number(owner), q));
            }
            count += known.len();
            paths.push(PathColumns { frames, columns });
        }
        Self { paths, count }
    }

    fn at(&self, path: usize, frame: usize) -> FrameColumns {
        let PathColumns { frames, columns } = &self.paths[path];
        columns[frames.partition_point(|known| *known < frame)]
    }

    /// The row that `terms` make over the unknowns.
    pub fn row(&self, terms: &[Term]) -> Vec<(usize, c64)> {
        let mut row = Vec::with_capacity(2 * terms.len());
        for (path, frame, factor) in terms.iter().copied() {
            let columns = self.at(path, frame);
            row.push((columns.column, factor));
            if let Some((second, q)) = columns.second {
                row.push((second, factor * q));
            }
        }
        row
    }

    /// Points of path `path` from the unknowns, if the unknowns are those of all frames.
    pub fn points<'a>(&'a self, path: usize, x: &'a [c64]) -> impl Iterator<Item = c64> + 'a {
        self.paths[path].columns.iter().map(|columns| {
            let second = columns.second.map_or(c64::default(), |(second, q)| q * x[second]);
            x[columns.column] + second
        })
    }
}

/// The unknowns of `frames`, named by the frames that own them: the first of a repeated point; of a stationary stretch its
/// first, and its second for the turn.
fn owners(freedom: Freedom, path: usize, frames: &[usize]) -> Vec<FrameColumns> {
    let rest = &freedom.paths[path];
    let runs: Vec<RunShape> = freedom.kept_runs(path).map(|run| RunShape::new(freedom, rest, run)).collect();
    let in_run = |frame: usize| runs.iter().find(|run| run.holds(frame)).map(|run| run.columns(rest, frame));
    let mut owners: Vec<FrameColumns> = Vec::with_capacity(frames.len());
    let mut previous = None;
    for frame in frames.iter().copied() {
        let repeats = |at: usize| freedom.phase == Phase::Shape && at > 0 && rest.coincide(at - 1, at);
        let own = in_run(frame).unwrap_or_else(|| match owners.last() {
            Some(before) if repeats(frame) && previous == Some(frame - 1) => *before,
            _ => shared_point(frame, rest.len(), repeats, in_run),
        });
        owners.push(own);
        previous = Some(frame);
    }
    owners
}

/// Unknowns of the first frame of the very same point, or of the stationary stretch that touches it.
fn shared_point(
    frame: usize,
    count: usize,
    repeats: impl Fn(usize) -> bool,
    in_run: impl Fn(usize) -> Option<FrameColumns>,
) -> FrameColumns {
    let mut first = frame;
    while repeats(first) {
        first -= 1;
        if let Some(run) = in_run(first) {
            return run;
        }
    }
    let after = (frame + 1..count).take_while(|next| repeats(*next)).find_map(in_run);
    after.unwrap_or(FrameColumns { column: first, second: None })
}

/// A stationary stretch: its centre, and how far it reaches.
struct RunShape {
    frames: (usize, usize),
    centre: c64,
    extent: f64,
    turns: bool,
}

impl RunShape {
    fn new(freedom: Freedom, rest: &RestPath, frames: (usize, usize)) -> Self {
        let points = &rest.positions[frames.0..=frames.1];
        let centre = points.iter().sum::<c64>() / points.len() as f64;
        let extent = points.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max);
        let rigid = freedom.phase == Phase::Scale && freedom.runs == RunMode::Rigid;
        let turns = !rigid && extent > COINCIDENT * (1.0 + centre.norm());
        Self { frames, centre, extent, turns }
    }

    fn holds(&self, frame: usize) -> bool {
        self.frames.0 <= frame && frame <= self.frames.1
    }

    fn columns(&self, rest: &RestPath, frame: usize) -> FrameColumns {
        let second = || (self.frames.0 + 1, (rest.positions[frame] - self.centre) / self.extent);
        FrameColumns { column: self.frames.0, second: self.turns.then(second) }
    }
}
