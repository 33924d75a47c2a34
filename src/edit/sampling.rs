//! Fewer frames of a path in place of all: rows at the kept ones stand for those in between, so that energies stay what they
//! were.
//!
//! The published method keeps every 25th frame besides those that matter, and weighs its rows like any others, which are then
//! dozens of times too stiff. Here a kept frame has the compliance of the springs around it, each counted by its distance; in
//! the scale phase differences are divided by frames.
//!
//! Source: Kim et al. 2009, §5.3 (acceleration); weights ours.

use crate::edit::direction::{Direction, run_chord};
use crate::edit::hold::{Hold, Place, Prepared};
use crate::index::floor_index;
use crate::path::{RestPath, bracket};

/// Frames from one kept for its own sake to the next.
const STRIDE: usize = 25;

/// The frames of a path that are kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sampling {
    /// Rising; the first and the last among them.
    pub frames: Vec<usize>,
    /// Compliance at each of them in the shape phase, 1/m²; 0 inside stationary stretches.
    pub compliances: Vec<f64>,
    /// Length of the path at rest from each of them to the next, metres.
    pub lengths: Vec<f64>,
}

impl Sampling {
    /// Keeps the ends of `rest`, every 25th frame, those that rows `held` on path `path` read, ends and middles of stationary
    /// stretches, and `marked` ones with those around them. `springs`: compliance at each frame of `rest`. Cost: linear in
    /// frames.
    pub fn new(
        rest: &RestPath,
        (path, held): (usize, &[Prepared]),
        marked: &[usize],
        springs: &[f64],
    ) -> Self {
        let last = rest.len() - 1;
        let mut frames: Vec<usize> = (0..=last).step_by(STRIDE).collect();
        frames.extend([0, 1, last.saturating_sub(1), last]);
        for prepared in held {
            read_frames(prepared, path, |frame| frames.extend(around(frame, rest.len())));
        }
        for (first, end) in &rest.rigid {
            let chord = run_chord(rest, (*first, *end));
            frames.extend([first.saturating_sub(1), *first, (first + end) / 2, *end, end + 1]);
            frames.push(floor_index(chord.to));
        }
        frames
            .extend(marked.iter().flat_map(|frame| [frame.saturating_sub(1), *frame, frame + 1, frame + 2]));
        frames.iter_mut().for_each(|frame| *frame = (*frame).min(last));
        frames.sort_unstable();
        frames.dedup();
        let compliances = shared(springs, &frames);
        let step = |frame: usize| (rest.positions[frame + 1] - rest.positions[frame]).norm();
        let lengths = frames.windows(2).map(|pair| (pair[0]..pair[1]).map(step).sum()).collect();
        Self { frames, compliances, lengths }
    }

    /// Number of kept frames before `frame`, which is its own number if it is kept.
    fn number(&self, frame: usize) -> usize {
        self.frames.partition_point(|kept| *kept < frame)
    }

    /// A fractional frame whose neighbours are kept, counted in kept frames.
    fn counted(&self, frame: f64) -> f64 {
        let count = self.frames[self.frames.len() - 1] + 1;
        let (low, _, share) = bracket(frame, count);
        self.number(low) as f64 + share
    }

    /// The path through the kept frames.
    pub fn path(&self, rest: &RestPath) -> RestPath {
        let run = |(first, last): &(usize, usize)| (self.number(*first), self.number(*last));
        RestPath {
            positions: self.frames.iter().map(|frame| rest.positions[*frame]).collect(),
            headings: self.frames.iter().map(|frame| rest.headings[*frame]).collect(),
            rigid: rest.rigid.iter().map(run).collect(),
        }
    }

    /// Frames from kept frame `index` to the next.
    pub fn span(&self, index: usize) -> f64 {
        (self.frames[index + 1] - self.frames[index]) as f64
    }
}

/// A row on kept frames; `samplings`: of all paths.
pub fn sampled(mut prepared: Prepared, samplings: &[Sampling]) -> Prepared {
    let place = |place: &mut Place| place.frame = samplings[place.path].counted(place.frame);
    let hold = prepared.row.hold;
    let direction = |direction: Option<Direction>, path: usize| {
        direction.map(|own| Direction {
            from: samplings[path].counted(own.from),
            to: samplings[path].counted(own.to),
            ..own
        })
    };
    prepared.at = direction(prepared.at, hold.at().path);
    prepared.to = hold.to().and_then(|to| direction(prepared.to, to.path));
    match &mut prepared.row.hold {
        Hold::Position { at, .. } | Hold::Facing { at, .. } => place(at),
        Hold::Offset { at, to, .. } | Hold::RelativeFacing { at, to, .. } => {
            [at, to].into_iter().for_each(place)
        }
        Hold::Beside { at, to, from, .. } => [at, to, from].into_iter().for_each(place),
    }
    prepared
}

/// Calls `visit` with the fractional frames of path `path` that a row reads.
fn read_frames(prepared: &Prepared, path: usize, mut visit: impl FnMut(f64)) {
    let hold = prepared.row.hold;
    let mut both = |place: Option<Place>, direction: Option<Direction>| {
        let Some(place) = place.filter(|place| place.path == path) else { return };
        visit(place.frame);
        if let Some(direction) = direction {
            visit(direction.from);
            visit(direction.to);
        }
    };
    both(Some(hold.at()), prepared.at);
    both(hold.to(), prepared.to);
    if let Hold::Beside { to, from, .. } = hold {
        both(Some(to), None);
        both(Some(from), None);
    }
}

/// Frames that show a fractional frame, and one on either side.
fn around(frame: f64, count: usize) -> [usize; 4] {
    let (low, high, _) = bracket(frame, count);
    [low.saturating_sub(1), low, high, high + 1]
}

/// Compliance of `springs`, shared among the kept frames on either side by distance; those of the ends go to the frames next
/// to them.
fn shared(springs: &[f64], frames: &[usize]) -> Vec<f64> {
    let mut sums = vec![0.0; frames.len()];
    for (index, pair) in frames.windows(2).enumerate() {
        let span = (pair[1] - pair[0]) as f64;
        for (frame, spring) in springs[pair[0]..pair[1]].iter().enumerate() {
            let share = frame as f64 / span;
            sums[index] += (1.0 - share) * spring;
            sums[index + 1] += share * spring;
        }
    }
    let last = frames.len() - 1;
    if last > 1 {
        sums[1] += std::mem::take(&mut sums[0]);
        sums[last - 1] += std::mem::take(&mut sums[last]);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::c64;

    /// 100 frames of a bend that stands from frame 40 to 60.
    fn path() -> RestPath {
        let point = |i: usize| {
            let t = if i < 40 { i } else { 40.max(i.saturating_sub(20)) } as f64 * 0.04;
            c64::new(t, 0.1 * t * t + 1e-3 * (i as f64).sin())
        };
        RestPath { positions: (0..100).map(point).collect(), headings: vec![0.0; 100], rigid: vec![(40, 60)] }
    }

    #[test]
    fn kept_frames_share_all_compliance_and_length() {
        let rest = path();
        let springs: Vec<f64> = (0..100)
            .map(|i| if (1..40).contains(&i) || (60..99).contains(&i) { 1.0 + i as f64 } else { 0.0 })
            .collect();
        let sampling = Sampling::new(&rest, (0, &[]), &[70], &springs);
        for frame in [0, 1, 25, 39, 40, 50, 60, 61, 69, 70, 71, 72, 75, 98, 99] {
            assert!(sampling.frames.contains(&frame), "{frame}");
        }
        assert!(sampling.frames.len() < 30);
        let sum = |values: &[f64]| values.iter().sum::<f64>();
        // Sums of a hundred numbers up to a hundred.
        assert!((sum(&sampling.compliances) - sum(&springs)).abs() < 1e-9);
        let length = length(&rest.positions);
        assert!((sum(&sampling.lengths) - length).abs() < 1e-12);
        let coarse = sampling.path(&rest);
        let (first, last) = coarse.rigid[0];
        assert_eq!((sampling.frames[first], sampling.frames[last]), (40, 60));
        assert!((first + 1..last).all(|kept| sampling.compliances[kept] == 0.0), "a stand does not bend");
        assert_eq!(sampling.counted(70.5), sampling.number(70) as f64 + 0.5);
    }

    fn length(points: &[c64]) -> f64 {
        points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
    }
}
