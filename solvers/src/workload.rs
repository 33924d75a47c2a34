//! Synthetic problems of known size and known answers, for benchmarks, tests and comparisons with other solvers.

use std::ops::Range;

use crate::c64;
use crate::points::PointRow;

mod published;

pub use published::{CharacterCounts, PUBLISHED_SCENES, PublishedScene, published_scene};

/// Seconds between samples at rest.
pub const STEP: f64 = 1.0 / 30.0;

const ONE: c64 = c64::new(1.0, 0.0);

/// Paths, rows on their points and rows on their times: what every back end is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Workload {
    /// For tables.
    pub name: String,
    /// Rest paths, metres.
    pub paths: Vec<Vec<c64>>,
    /// Stretches that stay as they are: path, first and last sample; rising, none shares a step with another. In the shape
    /// phase each keeps its shape up to a similarity ([`shape_stand_rows`](Self::shape_stand_rows)), in the scale phase its
    /// steps, turned as a whole ([`scale_stand_rows`](Self::scale_stand_rows)).
    pub stands: Vec<(usize, usize, usize)>,
    /// Rows on points, the same in both phases.
    pub rows: Vec<PointRow<c64>>,
    /// One target for each of `rows`.
    pub targets: Vec<c64>,
    /// Rows on times; sample i of every track is at `i ·` [`STEP`] at rest.
    pub time_rows: Vec<PointRow<f64>>,
    /// One target for each of `time_rows`, seconds.
    pub time_targets: Vec<f64>,
    /// The handle that is dragged: a row of `rows` and one of `time_rows`.
    pub handle: (usize, usize),
}

impl Workload {
    /// Samples of all paths.
    pub fn samples(&self) -> usize {
        self.paths.iter().map(Vec::len).sum()
    }

    /// Stands of one path.
    pub fn stands_of(&self, path: usize) -> &[(usize, usize, usize)] {
        let before = |path: usize| self.stands.partition_point(|stand| stand.0 < path);
        &self.stands[before(path)..before(path + 1)]
    }

    /// Samples of a path whose neighbours bend it: all but its ends and those strictly inside a stand.
    pub fn bending(&self, path: usize) -> Vec<Range<usize>> {
        let end = self.paths[path].len().saturating_sub(1);
        let mut bending = Vec::new();
        let mut start = 1;
        for (_, first, last) in self.stands_of(path) {
            bending.push(start..first + 1);
            start = *last;
        }
        bending.push(start.max(1)..end);
        bending
    }

    /// Hard rows of the stands in the shape phase, targets 0: at each sample q strictly inside,
    /// `p_q − (1 − z) p_{q−1} − z p_{q+1}` with `z = (p⁰_q − p⁰_{q−1}) / (p⁰_{q+1} − p⁰_{q−1})`.
    pub fn shape_stand_rows(&self) -> Vec<PointRow<c64>> {
        let row = |k: usize, q: usize| {
            let rest = &self.paths[k];
            let z = (rest[q] - rest[q - 1]) / (rest[q + 1] - rest[q - 1]);
            PointRow::hard(vec![(k, q - 1, z - ONE), (k, q, ONE), (k, q + 1, -z)])
        };
        self.stands.iter().flat_map(|&(k, first, last)| (first + 1..last).map(move |q| row(k, q))).collect()
    }

    /// Hard rows of the stands in the scale phase: each step `p_{q+1} − p_q`. Targets: the steps at rest, turned as the shape
    /// phase turned the stand.
    pub fn scale_stand_rows(&self) -> Vec<PointRow<c64>> {
        let row = |k: usize, q: usize| PointRow::hard(vec![(k, q + 1, ONE), (k, q, -ONE)]);
        self.stands.iter().flat_map(|&(k, first, last)| (first..last).map(move |q| row(k, q))).collect()
    }

    /// Targets after drag step `step`: the handle goes round in a circle of 0.1 m, and its time with it.
    pub fn dragged(&self, step: usize) -> (Vec<c64>, Vec<f64>) {
        let angle = 0.3 * (step + 1) as f64;
        let (mut targets, mut times) = (self.targets.clone(), self.time_targets.clone());
        targets[self.handle.0] += c64::from_polar(0.1, angle);
        times[self.handle.1] += 0.1 * angle.sin();
        (targets, times)
    }
}

/// Samples of each path of [`relay_chain`].
pub const CHAIN_SAMPLES: usize = 200;

/// A chain of `characters` paths of [`CHAIN_SAMPLES`] samples, each tied to the next by two hard rows, drawn by four soft pins.
///
/// Times: everybody meets the next at the same samples, and the ends are drawn apart by two seconds.
pub fn relay_chain(characters: usize) -> Workload {
    let n = CHAIN_SAMPLES;
    let paths: Vec<Vec<c64>> = (0..characters).map(|c| chain_path(c as f64)).collect();
    let last = characters - 1;
    let pins = [
        (0, 0, c64::default()),
        (last, n - 1, c64::new(2.0, 3.0)),
        (characters / 2, n / 3, c64::new(0.0, 2.0)),
        (0, 2 * n / 3, c64::new(0.2, 0.1)),
    ];
    let mut workload = Workload {
        name: format!("relay chain {characters}"),
        rows: pins.iter().map(|(c, i, _)| PointRow::soft(vec![(*c, *i, ONE)], 1.0)).collect(),
        targets: pins.iter().map(|(c, i, offset)| paths[*c][*i] + offset).collect(),
        stands: Vec::new(),
        time_rows: vec![
            PointRow::soft(vec![(0, 0, 1.0)], 1.0),
            PointRow::soft(vec![(last, n - 1, 1.0)], 1.0),
        ],
        time_targets: vec![0.0, (n - 1) as f64 * STEP + 2.0],
        handle: (1, 1),
        paths,
    };
    let (i, j, ahead) = (n / 4, 3 * n / 4, c64::new(0.3, 1.2));
    for c in 0..last {
        let position = vec![(c + 1, i, ONE), (c, j, -ONE), (c, j + 1, -ahead), (c, j - 1, ahead)];
        let direction = vec![(c + 1, i + 1, ONE), (c + 1, i - 1, -ONE), (c, j + 1, ONE), (c, j - 1, -ONE)];
        workload.rows.extend([PointRow::hard(position), PointRow::hard(direction)]);
        workload.targets.extend([c64::default(); 2]);
        workload.time_rows.push(PointRow::hard(vec![(c + 1, i, 1.0), (c, j, -1.0)]));
        workload.time_targets.push((i as f64 - j as f64) * STEP);
    }
    workload
}

fn chain_path(c: f64) -> Vec<c64> {
    let point =
        |t: f64| c64::new(1.5 * c + 3.0 * t, 0.3 * (9.0 * t + c).sin() + 0.2 * c + 0.01 * (37.0 * t).sin());
    (0..CHAIN_SAMPLES).map(|i| point(i as f64 / CHAIN_SAMPLES as f64)).collect()
}
