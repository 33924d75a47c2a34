//! How stiff a path is, frame by frame: stiffness of its local similarity factors in the shape phase, evenly stiff second
//! differences in the scale phase. Source: Kim et al. 2009, eqs. 3 and 7.

use cotillion_solvers::{PointRow, SpringPath};

use crate::clip::working::WORKING_STEP;
use crate::edit::columns::Freedom;
use crate::edit::hold::Phase;
use crate::edit::settings::{RunMode, SpatialSettings};
use crate::geometry::c64;
use crate::path::RestPath;

/// Rows inside a stationary stretch that had to be released weigh this much more than others.
pub const RELEASED_WEIGHT: f64 = 100.0;
/// Rows are stiffened by at most this factor of their weight.
const MOST_STIFFENING: f64 = 1e8;

/// The spring of an interior frame in the shape phase: energy `½ κ |z_i − z_{i−1}|²`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeSpring {
    /// Last frame before at another point.
    pub before: usize,
    /// Next frame at another point.
    pub next: usize,
    /// κ of the published row: `|v_{i−1}|²|v_i|²/|t_i|²`, m²; infinite where a path turns back on itself.
    pub free: f64,
    /// κ within floor and cap, m².
    pub stiffness: f64,
}

/// The spring at interior frame `frame`; `None` at all frames of a repeated point but one, and where it lies at an end of the
/// path.
pub fn shape_spring(path: &RestPath, frame: usize, settings: &SpatialSettings) -> Option<ShapeSpring> {
    if path.coincide(frame - 1, frame) && path.rigid.binary_search_by_key(&frame, |(_, to)| *to).is_err() {
        return None;
    }
    let first = (0..=frame).rev().find(|at| *at == 0 || !path.coincide(at - 1, *at))?;
    let before = first.checked_sub(1)?;
    let next = (frame + 1..path.len()).find(|next| !path.coincide(next - 1, *next))?;
    if frame != place_of_spring(path, first, next) {
        return None;
    }
    let points = &path.positions;
    let (come, go) = (points[first] - points[before], points[next] - points[first]);
    let tangent = points[next] - points[before];
    let free = come.norm_sqr() * go.norm_sqr() / tangent.norm_sqr();
    let floor = (WORKING_STEP * settings.stiffness_speed / 2.0).powi(2);
    let stiffness = free.max(floor.min(free * MOST_STIFFENING)).min(settings.stiffness_cap);
    Some(ShapeSpring { before, next, free, stiffness })
}

/// Which frame of a point repeated from `first` until before `next` has its spring: the first one, unless that is inside a
/// stationary stretch, which has none, and the point lasts to its end: then that end.
fn place_of_spring(path: &RestPath, first: usize, next: usize) -> usize {
    let ends_there = |(from, to): &&(usize, usize)| *from < first && first < *to && *to < next;
    path.rigid.iter().find(ends_there).map_or(first, |(_, to)| *to)
}

/// Path `path` as a chain of springs, and the rows that keep its stationary stretches. `None` where springs cannot say what
/// a stretch keeps: its shape up to similarity, in the scale phase. Cost: linear in frames.
pub fn spring_path(freedom: Freedom, path: usize, settings: &SpatialSettings) -> Option<SpringPath> {
    match freedom.phase {
        Phase::Shape => Some(shape_path(freedom, path, settings)),
        Phase::Scale => scale_path(freedom, path),
    }
}

/// The same in the shape phase, in which springs say everything.
pub fn shape_path(freedom: Freedom, path: usize, settings: &SpatialSettings) -> SpringPath {
    let rest = &freedom.paths[path];
    let mut compliances = vec![0.0; rest.len()];
    for (frame, compliance) in compliances.iter_mut().enumerate().skip(1).take(rest.len().saturating_sub(2)) {
        let Some(spring) = shape_spring(rest, frame, settings) else { continue };
        // A stretch that ends in a repeated point has its last spring where that point begins.
        let run = rest.rigid.iter().position(|(a, b)| *a < frame && spring.next <= *b);
        *compliance = match run {
            Some(run) if freedom.released.contains(&(path, run)) => {
                spring.stiffness.recip() / RELEASED_WEIGHT
            }
            Some(_) => 0.0,
            None => spring.stiffness.recip(),
        };
    }
    let mut points = rest.positions.clone();
    for frame in 1..points.len() {
        if rest.coincide(frame - 1, frame) {
            points[frame] = points[frame - 1];
        }
    }
    SpringPath::Listed { points, compliances }
}

fn scale_path(freedom: Freedom, path: usize) -> Option<SpringPath> {
    let rest = &freedom.paths[path];
    let mut stretches = vec![(0, 1.0)];
    for (run, (first, last)) in rest.rigid.iter().enumerate().filter(|(_, (a, b))| a < b) {
        let released = freedom.released.contains(&(path, run));
        if !released && freedom.runs == RunMode::Similar {
            return None;
        }
        stretches.push((first + 1, if released { RELEASED_WEIGHT.recip() } else { 0.0 }));
        stretches.push((*last, 1.0));
    }
    Some(SpringPath::Even { count: rest.len(), stretches })
}

/// Rows that keep the rigid stretches of the scale phase as they are: nothing is added to their first step.
pub fn run_rows(freedom: Freedom) -> Vec<PointRow<c64>> {
    let one = c64::new(1.0, 0.0);
    let mut rows = Vec::new();
    if freedom.phase == Phase::Scale {
        for path in 0..freedom.paths.len() {
            for (first, _) in freedom.kept_runs(path).filter(|(first, last)| first < last) {
                rows.push(PointRow::hard(vec![(path, first + 1, one), (path, first, -one)]));
            }
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Walks ahead, stands still at one point from frame 4 to 9, walks on; `rigid`: what counts as standing.
    fn halted(rigid: &[(usize, usize)]) -> RestPath {
        let along = [0.0, 0.04, 0.08, 0.1, 0.11, 0.11, 0.11, 0.11, 0.11, 0.11, 0.12, 0.15, 0.19];
        RestPath {
            positions: along.iter().map(|x| c64::new(*x, 0.02 * x * x)).collect(),
            headings: vec![0.0; along.len()],
            rigid: rigid.to_vec(),
        }
    }

    #[test]
    fn a_point_where_somebody_stands_has_one_spring_where_the_stretch_leaves_it_free_to_bend() {
        let springs = |rigid: &[(usize, usize)]| {
            let path = halted(rigid);
            let at = |frame: &usize| shape_spring(&path, *frame, &SpatialSettings::PRODUCTION).is_some();
            (4..=9).filter(at).collect::<Vec<_>>()
        };
        assert_eq!(springs(&[]), [4]);
        assert_eq!(springs(&[(2, 7)]), [7], "inside of a stretch nothing bends: its end does");
        assert_eq!(springs(&[(2, 9)]), [9]);
        assert_eq!(springs(&[(4, 8)]), [4], "a stretch that begins there");
        assert_eq!(springs(&[(2, 11)]), [4], "inside of a stretch it does not count");
        let path = halted(&[(2, 7)]);
        let spring = shape_spring(&path, 7, &SpatialSettings::PRODUCTION).expect("a spring");
        assert_eq!((spring.before, spring.next), (3, 10));
    }
}
