//! Timing of the systems of an edit, phase by phase.

use std::time::Instant;

use cotillion_solvers::workload::Workload;
use cotillion_solvers::{KktError, PointRow, Scalar, c64};
use rayon::prelude::*;

use super::names::{Mode, System};

/// Workloads with more samples are spread over all threads by those back ends that can.
pub(super) const MANY_SAMPLES: usize = 20_000;

/// A stage of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Phase {
    /// From paths and rows to matrices.
    Assemble,
    /// What depends on where the matrices have entries: order of elimination, memory.
    Analyse,
    /// Numbers of the factors.
    Factor,
    /// From targets to unknowns.
    Solve,
    /// From unknowns to points of all frames.
    Expand,
}

/// Milliseconds of each [`Phase`], in order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Watch(pub(super) [f64; 5]);

impl Watch {
    /// Calls `work` and adds the time it took.
    pub(super) fn lap<T>(&mut self, phase: Phase, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.0[phase as usize] += start.elapsed().as_secs_f64() * 1e3;
        result
    }

    /// All phases together.
    pub(super) fn total(&self) -> f64 {
        self.0.iter().sum()
    }
}

/// A system of an edit that every back end solves in a way of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Shape,
    Scale,
    Time,
}

impl Part {
    /// Hard rows of the stands, for back ends that have no form of their own for them.
    pub(super) fn stand_rows(self, workload: &Workload) -> Vec<PointRow<c64>> {
        match self {
            Self::Shape => workload.shape_stand_rows(),
            Self::Scale => workload.scale_stand_rows(),
            Self::Time => Vec::new(),
        }
    }
}

/// One system, factored by some back end.
pub(super) trait Solver: Sized {
    /// A point: complex on a path, real on a track of times.
    type Point: Scalar;

    /// Assembles, analyses and factors.
    fn prepare(workload: &Workload, part: Part, watch: &mut Watch) -> Result<Self, KktError>;

    /// Solves for `targets`, one for each row of the workload, and writes the points of every path.
    ///
    /// `steps`: for [`Part::Scale`], what each step of each path shall be; else none.
    fn solve_into(
        &mut self,
        steps: Option<Steps<'_>>,
        targets: &[Self::Point],
        points: &mut [Vec<Self::Point>],
        watch: &mut Watch,
    ) -> Result<(), KktError>;
}

/// An edit, as far as solvers make it.
#[derive(Clone, Debug)]
pub(super) struct Edited {
    pub(super) shape: Vec<Vec<c64>>,
    pub(super) scale: Vec<Vec<c64>>,
    pub(super) times: Vec<Vec<f64>>,
}

impl Edited {
    /// Memory for the edits of a workload.
    pub(super) fn room(workload: &Workload) -> Self {
        Self {
            shape: workload.paths.clone(),
            scale: workload.paths.clone(),
            times: workload.paths.iter().map(|path| vec![0.0; path.len()]).collect(),
        }
    }

    /// Largest distance to another edit of the same workload, metres; for times, seconds; for all, the larger number.
    pub(super) fn distance(&self, other: &Self, system: System) -> f64 {
        match system {
            System::Shape => largest_distance(&self.shape, &other.shape),
            System::Scale => largest_distance(&self.scale, &other.scale),
            System::Time => largest_distance(&self.times, &other.times),
            System::All => [System::Shape, System::Scale, System::Time]
                .map(|system| self.distance(other, system))
                .into_iter()
                .fold(0.0, f64::max),
        }
    }
}

fn largest_distance<T: Scalar>(a: &[Vec<T>], b: &[Vec<T>]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(&a, &b)| (a - b).modulus()).fold(0.0, f64::max)
}

/// The three systems of an edit, factored.
pub(super) struct Rig<S, T> {
    pub(super) shape: S,
    pub(super) scale: S,
    pub(super) time: T,
}

/// Times of the three systems in one repetition.
pub(super) type Lap = [Watch; 3];

/// Everything from rest to the edit.
pub(super) fn cold<S: Solver<Point = c64>, T: Solver<Point = f64>>(
    workload: &Workload,
    edited: &mut Edited,
) -> Result<(Rig<S, T>, Lap), KktError> {
    let mut laps = Lap::default();
    let mut rig = Rig {
        shape: S::prepare(workload, Part::Shape, &mut laps[0])?,
        scale: S::prepare(workload, Part::Scale, &mut laps[1])?,
        time: T::prepare(workload, Part::Time, &mut laps[2])?,
    };
    let targets = (workload.targets.as_slice(), workload.time_targets.as_slice());
    let solved = drag(&mut rig, workload, targets, edited)?;
    for (lap, own) in laps.iter_mut().zip(solved) {
        lap.0.iter_mut().zip(own.0).for_each(|(sum, ms)| *sum += ms);
    }
    Ok((rig, laps))
}

/// New targets, everything else reused.
pub(super) fn drag<S: Solver<Point = c64>, T: Solver<Point = f64>>(
    rig: &mut Rig<S, T>,
    workload: &Workload,
    (targets, time_targets): (&[c64], &[f64]),
    edited: &mut Edited,
) -> Result<Lap, KktError> {
    let mut laps = Lap::default();
    let Edited { shape, scale, times } = edited;
    rig.shape.solve_into(None, targets, shape, &mut laps[0])?;
    rig.scale.solve_into(Some(Steps { workload, shape }), targets, scale, &mut laps[1])?;
    rig.time.solve_into(None, time_targets, times, &mut laps[2])?;
    Ok(laps)
}

/// `make` of every path, on all threads where there is enough to do.
pub(super) fn map_paths<T: Send>(workload: &Workload, make: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    let count = workload.paths.len();
    if workload.samples() > MANY_SAMPLES {
        (0..count).into_par_iter().with_min_len(16).map(make).collect()
    } else {
        (0..count).map(make).collect()
    }
}

/// Steps of the rest paths, turned as the shape phase turned them: `v z / |z|` with `z = v̄ / v`; a stand turns as a whole. A
/// step that collapsed is not turned.
#[derive(Clone, Copy)]
pub(super) struct Steps<'a> {
    pub(super) workload: &'a Workload,
    /// Paths of the shape phase.
    pub(super) shape: &'a [Vec<c64>],
}

impl Steps<'_> {
    /// Writes the steps of one path, one fewer than it has points.
    pub(super) fn write(self, path: usize, steps: &mut [c64]) {
        let (rest, shape) = (&self.workload.paths[path], &self.shape[path]);
        for ((rest, shape), step) in rest.windows(2).zip(shape.windows(2)).zip(&mut *steps) {
            let (own, bent) = (rest[1] - rest[0], shape[1] - shape[0]);
            *step = own * rotation(bent * own.conj());
        }
        for &(_, first, last) in self.workload.stands_of(path) {
            turn_stand(&rest[first..=last], &shape[first..=last], &mut steps[first..last]);
        }
    }
}

/// All steps of a stand turned by one rotation: the one that fits them best.
fn turn_stand(rest: &[c64], shape: &[c64], steps: &mut [c64]) {
    let turns = rest.windows(2).zip(shape.windows(2)).map(|(a, b)| (b[1] - b[0]) * (a[1] - a[0]).conj());
    let rotation = rotation(turns.sum());
    rest.windows(2).zip(steps).for_each(|(pair, step)| *step = (pair[1] - pair[0]) * rotation);
}

/// `turn / |turn|`; 1 for 0.
fn rotation(turn: c64) -> c64 {
    let size = turn.norm_sqr().sqrt();
    if size > 0.0 { turn * size.recip() } else { c64::new(1.0, 0.0) }
}

/// Least and most repetitions, unless a number is given.
const REPETITIONS: (usize, usize) = (5, 1000);
/// Repetitions go on for so long.
const ENOUGH_SECONDS: f64 = 0.5;

/// Repeats `work` after one call to warm up.
pub(super) fn repeated(
    repetitions: Option<usize>,
    mut work: impl FnMut(usize) -> Result<Lap, KktError>,
) -> Result<Vec<Lap>, KktError> {
    work(0)?;
    let start = Instant::now();
    let mut laps = Vec::new();
    loop {
        laps.push(work(laps.len() + 1)?);
        let done = match repetitions {
            Some(count) => laps.len() >= count,
            None => laps.len() >= REPETITIONS.0 && start.elapsed().as_secs_f64() >= ENOUGH_SECONDS,
        };
        if done || laps.len() >= REPETITIONS.1 {
            return Ok(laps);
        }
    }
}

/// The repetition whose total is the median (of an even number, the faster one in the middle), so that its phases add up.
pub(super) fn median_lap(laps: &[Lap], system: System) -> Watch {
    let mut watches: Vec<Watch> = laps.iter().map(|lap| watch_of(lap, system)).collect();
    watches.sort_by(|a, b| a.total().total_cmp(&b.total()));
    watches.get(watches.len().saturating_sub(1) / 2).copied().unwrap_or_default()
}

/// Milliseconds of the fastest repetition.
pub(super) fn least_ms(laps: &[Lap], system: System) -> Option<f64> {
    laps.iter().map(|lap| watch_of(lap, system).total()).min_by(f64::total_cmp)
}

fn watch_of(lap: &Lap, system: System) -> Watch {
    match system {
        System::Shape => lap[0],
        System::Scale => lap[1],
        System::Time => lap[2],
        System::All => Watch(std::array::from_fn(|k| lap.iter().map(|watch| watch.0[k]).sum())),
    }
}

/// Phases that a mode goes through.
pub(super) fn passes(mode: Mode, phase: Phase) -> bool {
    mode == Mode::Cold || matches!(phase, Phase::Solve | Phase::Expand)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cotillion_solvers::workload::relay_chain;

    #[test]
    fn median_repetition_keeps_its_phases() {
        let lap = |solve: f64| {
            let mut lap = Lap::default();
            lap[0].0 = [1.0, 0.0, 0.0, solve, 0.0];
            lap
        };
        let laps = [lap(9.0), lap(1.0), lap(3.0)];
        assert_eq!(median_lap(&laps, System::Shape).0, [1.0, 0.0, 0.0, 3.0, 0.0]);
        assert_eq!(median_lap(&laps, System::All).total(), 4.0);
        assert_eq!(median_lap(&laps, System::Time).total(), 0.0);
        assert_eq!(least_ms(&laps, System::All), Some(2.0));
    }

    #[test]
    fn turned_steps_keep_their_lengths() {
        let steps = steps_of(Vec::new(), [c64::new(0.0, 5.0), c64::new(0.0, 5.0)]);
        assert_eq!(steps, [c64::new(0.0, 1.0), c64::new(0.0, 2.0)]);
    }

    #[test]
    fn stands_turn_as_a_whole() {
        let free = steps_of(Vec::new(), [c64::new(0.0, 2.0), c64::new(-5.0, 2.0)]);
        let stand = steps_of(vec![(0, 0, 2)], [c64::new(0.0, 2.0), c64::new(-5.0, 2.0)]);
        assert_eq!(free, [c64::new(0.0, 1.0), c64::new(-2.0, 0.0)]);
        assert_eq!(stand, free);
        let stand = steps_of(vec![(0, 0, 2)], [c64::new(0.0, 2.0), c64::new(-2.0, 1.0)]);
        assert_eq!(stand[1], c64::new(0.0, 2.0) * stand[0]);
        assert!((stand[0].norm() - 1.0).abs() < f64::EPSILON);
    }

    /// Steps of the path 0, 1, 1 + 2i with these stands, shaped to 0 and these two points.
    fn steps_of(stands: Vec<(usize, usize, usize)>, shaped: [c64; 2]) -> [c64; 2] {
        let zero = c64::default();
        let paths = vec![vec![zero, c64::new(1.0, 0.0), c64::new(1.0, 2.0)]];
        let workload = Workload { paths, stands, ..relay_chain(2) };
        let mut steps = [zero; 2];
        Steps { workload: &workload, shape: &[vec![zero, shaped[0], shaped[1]]] }.write(0, &mut steps);
        steps
    }
}
