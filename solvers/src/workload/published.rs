//! The five scenes of the paper's Table 1 as workloads: its counts of frames and rows, on synthetic paths.

use super::{ONE, STEP, Workload};
use crate::c64;
use crate::points::PointRow;
use std::f64::consts::TAU;

/// Counts of one character of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CharacterCounts {
    /// Frames of its edited motion.
    pub samples: usize,
    /// Soft rows on its path.
    pub soft_rows: usize,
    /// Hard rows on its path in the shape phase, all of them from stationary stretches: two fewer than each has samples.
    pub hard_rows: usize,
    /// Discrete changes that were plausible.
    pub changes: usize,
}

/// A scene of the paper's Table 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PublishedScene {
    /// For tables.
    pub name: &'static str,
    /// Everybody in it, in the order of the table.
    pub characters: &'static [CharacterCounts],
    /// The paper's milliseconds for one round of discrete evaluation, on hardware of 2009.
    pub discrete_ms: f64,
    /// The paper's milliseconds for one full Laplacian edit, on hardware of 2009.
    pub laplacian_ms: f64,
}

/// The five scenes. Of the two frame counts of the table, before and after the edit, these are the ones after it: the
/// larger scenes, and those the published times end with. "Duck walk 2" has 140 frames as printed, though its twin has 356.
///
/// Source: Kim, Hyun, Kim, Lee, *Synchronized Multi-Character Motion Editing*, SIGGRAPH 2009, Table 1.
pub const PUBLISHED_SCENES: [PublishedScene; 5] = [
    PublishedScene {
        name: "high five",
        characters: &[
            counts(142, 10, 30, 7),
            counts(105, 11, 30, 4),
            counts(253, 10, 30, 16),
            counts(105, 10, 30, 4),
        ],
        discrete_ms: 45.8,
        laplacian_ms: 58.9,
    },
    PublishedScene {
        name: "chair",
        characters: &[counts(322, 27, 98, 10), counts(322, 22, 49, 10), counts(241, 8, 105, 7)],
        discrete_ms: 68.8,
        laplacian_ms: 80.2,
    },
    PublishedScene {
        name: "adventure",
        characters: &[
            counts(356, 10, 35, 5),
            counts(140, 9, 53, 4),
            counts(370, 9, 53, 7),
            counts(251, 10, 55, 7),
            counts(140, 9, 35, 10),
            counts(140, 9, 53, 4),
            counts(370, 9, 53, 7),
            counts(251, 10, 55, 7),
        ],
        discrete_ms: 123.1,
        laplacian_ms: 332.4,
    },
    PublishedScene {
        name: "stacking",
        characters: &[
            counts(368, 12, 87, 9),
            counts(220, 10, 87, 2),
            counts(250, 9, 82, 3),
            counts(210, 9, 82, 2),
            counts(298, 8, 110, 7),
            counts(262, 8, 110, 7),
            counts(216, 11, 57, 13),
            counts(168, 13, 57, 7),
            counts(307, 11, 70, 9),
            counts(211, 10, 70, 5),
        ],
        discrete_ms: 112.7,
        laplacian_ms: 282.5,
    },
    PublishedScene {
        name: "relay",
        characters: &[
            counts(217, 17, 70, 4),
            counts(208, 9, 51, 4),
            counts(217, 19, 70, 3),
            counts(171, 10, 51, 4),
            counts(217, 14, 70, 7),
            counts(171, 9, 51, 4),
            counts(178, 14, 38, 3),
            counts(221, 10, 49, 5),
            counts(178, 14, 38, 3),
            counts(176, 10, 49, 3),
        ],
        discrete_ms: 82.8,
        laplacian_ms: 206.1,
    },
];

const fn counts(samples: usize, soft_rows: usize, hard_rows: usize, changes: usize) -> CharacterCounts {
    CharacterCounts { samples, soft_rows, hard_rows, changes }
}

/// More hard rows than this come from two stands instead of one.
const ROWS_OF_ONE_STAND: usize = 60;
/// Samples over which a walk comes to a stand, and gets going again.
const RAMP: usize = 8;
/// Metres a walker covers between two samples.
const STRIDE: f64 = 0.04;
/// Samples of one gait cycle, and of one round of the sway in a stand.
const CYCLE: f64 = 30.0;
/// Metres the hips swing to either side of a walk.
const SWING: f64 = 0.03;
/// Radius of the sway in a stand, metres. It keeps standing samples apart, and is too slow to undo a first step.
const SWAY: f64 = 0.001;
/// Metres between neighbours.
const SPACING: f64 = 1.0;
/// By how much the last character's end is drawn from where it rests, metres.
const PULL: c64 = c64::new(1.0, 2.0);
/// By how much the last character's end is drawn from when it rests, seconds.
const DELAY: f64 = 1.0;

/// A workload with the counts of `scene`: characters walk side by side, stop where the scene has stationary stretches, and
/// meet their neighbours.
///
/// Rows on each path: pins of its ends; positions and directions relative to the next character (the last one: the
/// one before), spread over the walking samples; one more pin if the count is odd. The last character's end is drawn away by 2.2 m. Times: neighbours meet at one moment each, and the end of
/// the last is drawn out by a second.
pub fn published_scene(scene: &PublishedScene) -> Workload {
    let actors: Vec<Actor> = scene.characters.iter().enumerate().map(|(k, own)| Actor::new(k, own)).collect();
    let mut workload = Workload {
        name: scene.name.to_owned(),
        paths: actors.iter().map(|actor| actor.path.clone()).collect(),
        stands: Vec::new(),
        rows: Vec::new(),
        targets: Vec::new(),
        time_rows: Vec::new(),
        time_targets: Vec::new(),
        handle: (0, 0),
    };
    let last = actors.len() - 1;
    for k in 0..=last {
        push_soft_rows(&mut workload, &actors, (k, scene.characters[k].soft_rows));
        workload.stands.extend(actors[k].stands.iter().map(|(first, last)| (k, *first, *last)));
        if k < last {
            push_meeting(&mut workload, &actors, k);
        }
    }
    push_absolute_times(&mut workload);
    workload
}

/// One character at rest.
struct Actor {
    path: Vec<c64>,
    /// First and last sample of each stand.
    stands: Vec<(usize, usize)>,
    /// Samples with a stencil clear of ends and stands, rising.
    walking: Vec<usize>,
}

impl Actor {
    fn new(index: usize, counts: &CharacterCounts) -> Self {
        let stands = stands(counts);
        let n = counts.samples;
        let walking = (2..n - 2).filter(|&i| distance_to_stand(&stands, i) > RAMP).collect();
        Self { path: walk(index, n, &stands), stands, walking }
    }

    /// The walking sample nearest to `sample`, the earlier one of two.
    fn walking_near(&self, sample: usize) -> usize {
        self.walking.iter().copied().min_by_key(|i| i.abs_diff(sample)).unwrap_or(self.path.len() / 2)
    }

    /// Walking sample number `k` of `count` spread evenly.
    fn walking_spread(&self, k: usize, count: usize) -> usize {
        self.walking[(2 * k + 1) * self.walking.len() / (2 * count)]
    }
}

/// One stand in the middle, or two at the thirds; a stand of `r + 2` samples gives `r` rows.
fn stands(counts: &CharacterCounts) -> Vec<(usize, usize)> {
    let count = if counts.hard_rows > ROWS_OF_ONE_STAND { 2 } else { 1 };
    let stand = |k: usize| {
        let samples = (counts.hard_rows + k) / count + 2;
        let first = (k + 1) * counts.samples / (count + 1) - samples / 2;
        (first, first + samples - 1)
    };
    (0..count).map(stand).collect()
}

fn distance_to_stand(stands: &[(usize, usize)], sample: usize) -> usize {
    let distance = |&(first, last): &(usize, usize)| sample.abs_diff(sample.clamp(first, last));
    stands.iter().map(distance).min().unwrap_or(usize::MAX)
}

/// A walk that winds gently and stops at the stands, where nothing but a small sway is left.
fn walk(index: usize, samples: usize, stands: &[(usize, usize)]) -> Vec<c64> {
    let gait = |i: usize| {
        let t = (distance_to_stand(stands, i) as f64 / RAMP as f64).min(1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let mut travelled = c64::new(0.0, SPACING * index as f64);
    let mut path = Vec::with_capacity(samples);
    for i in 0..samples {
        let phase = TAU * i as f64 / CYCLE;
        let heading = c64::from_polar(1.0, 0.3 * (TAU * i as f64 / samples as f64 + index as f64).sin());
        let swing = heading * c64::new(0.0, SWING * gait(i) * (phase + index as f64).sin());
        path.push(travelled + swing + c64::from_polar(SWAY, phase));
        travelled += heading * (STRIDE * 0.5 * (gait(i) + gait(i + 1)));
    }
    path
}

fn push_soft_rows(workload: &mut Workload, actors: &[Actor], (k, count): (usize, usize)) {
    let (own, last) = (&actors[k], actors.len() - 1);
    let end = own.path.len() - 1;
    push_pin(workload, (k, 0), c64::default());
    push_pin(workload, (k, end), if k == last { PULL } else { c64::default() });
    if k == last {
        workload.handle.0 = workload.rows.len() - 1;
    }
    let partner = if k < last { k + 1 } else { k - 1 };
    let pairs = (count - 2) / 2;
    for pair in 0..pairs {
        let i = own.walking_spread(pair, pairs);
        let j = actors[partner].walking_near(i);
        push_relative(workload, (k, i), (partner, j));
    }
    if count % 2 == 1 {
        push_pin(workload, (k, own.walking_near(end / 2)), c64::default());
    }
}

fn push_pin(workload: &mut Workload, (k, i): (usize, usize), offset: c64) {
    workload.rows.push(PointRow::soft(vec![(k, i, ONE)], 1.0));
    workload.targets.push(workload.paths[k][i] + offset);
}

/// Position and direction of sample i of path k as seen from sample j of path l, as at rest.
fn push_relative(workload: &mut Workload, (k, i): (usize, usize), (l, j): (usize, usize)) {
    let (own, other) = (&workload.paths[k], &workload.paths[l]);
    let ahead = other[j + 1] - other[j - 1];
    let place = (own[i] - other[j]) / ahead;
    let turn = (own[i + 1] - own[i - 1]) / ahead;
    let position = vec![(k, i, ONE), (l, j, -ONE), (l, j + 1, -place), (l, j - 1, place)];
    let direction = vec![(k, i + 1, ONE), (k, i - 1, -ONE), (l, j + 1, -turn), (l, j - 1, turn)];
    workload.rows.extend([PointRow::soft(position, 1.0), PointRow::soft(direction, 1.0)]);
    workload.targets.extend([c64::default(); 2]);
}

/// Character k meets the next one at a moment in the middle.
fn push_meeting(workload: &mut Workload, actors: &[Actor], k: usize) {
    let i = actors[k].walking_near(actors[k].path.len() / 2);
    let j = actors[k + 1].walking_near(i);
    workload.time_rows.push(PointRow::hard(vec![(k, i, 1.0), (k + 1, j, -1.0)]));
    workload.time_targets.push((i as f64 - j as f64) * STEP);
}

fn push_absolute_times(workload: &mut Workload) {
    let last = workload.paths.len() - 1;
    let end = workload.paths[last].len() - 1;
    for (k, i, delay) in [(0, 0, 0.0), (last / 2, 0, 0.0), (last, end, DELAY)] {
        workload.time_rows.push(PointRow::soft(vec![(k, i, 1.0)], 1.0));
        workload.time_targets.push(i as f64 * STEP + delay);
    }
    workload.handle.1 = workload.time_rows.len() - 1;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RowMatrix, analyse_rank};

    fn soft_rows_of(workload: &Workload, path: usize) -> usize {
        workload.rows.iter().filter(|row| row.terms[0].0 == path && row.weight.is_some()).count()
    }

    /// Hard rows of the shape phase, as a method without stands would have them.
    fn hard_rows(workload: &Workload) -> Vec<PointRow<c64>> {
        let own = workload.rows.iter().filter(|row| row.weight.is_none()).cloned();
        own.chain(workload.shape_stand_rows()).collect()
    }

    #[test]
    fn counts_are_those_of_the_table() {
        let totals = [605, 885, 2018, 2510, 1954];
        for (scene, total) in PUBLISHED_SCENES.iter().zip(totals) {
            let workload = published_scene(scene);
            assert_eq!(workload.paths.len(), scene.characters.len());
            for (k, counts) in scene.characters.iter().enumerate() {
                let path = workload.paths[k].len();
                let hard = hard_rows(&workload).iter().filter(|row| row.terms[0].0 == k).count();
                let found = (path, soft_rows_of(&workload, k), hard);
                let expected = (counts.samples, counts.soft_rows, counts.hard_rows);
                assert_eq!(found, expected, "{}, character {k}", scene.name);
            }
            assert_eq!(workload.samples(), total, "{}", scene.name);
        }
    }

    fn are_independent(workload: &Workload, rows: &[PointRow<c64>]) -> bool {
        let longest = workload.paths.iter().map(Vec::len).max().unwrap_or(0);
        let mut hard = RowMatrix::new(longest * workload.paths.len());
        for row in rows {
            let terms: Vec<_> = row.terms.iter().map(|&(k, i, a)| (k * longest + i, a)).collect();
            hard.push_row(&terms);
        }
        analyse_rank(&hard.to_csr()).dependent.is_empty()
    }

    #[test]
    fn hard_rows_are_independent() {
        for scene in &PUBLISHED_SCENES {
            let workload = published_scene(scene);
            assert!(are_independent(&workload, &hard_rows(&workload)), "{}", scene.name);
            assert!(are_independent(&workload, &workload.scale_stand_rows()), "{}", scene.name);
        }
    }

    #[test]
    fn stands_bend_at_their_ends_only() {
        for scene in &PUBLISHED_SCENES {
            let workload = published_scene(scene);
            for (k, counts) in scene.characters.iter().enumerate() {
                let bending: usize = workload.bending(k).into_iter().map(|range| range.len()).sum();
                assert_eq!(bending, counts.samples - 2 - counts.hard_rows, "{}, character {k}", scene.name);
            }
        }
    }

    #[test]
    fn everybody_is_tied_to_the_next() {
        for scene in &PUBLISHED_SCENES {
            let workload = published_scene(scene);
            for k in 1..workload.paths.len() {
                let ties = |terms: &[usize]| terms.contains(&k) && terms.contains(&(k - 1));
                let paths = |row: &PointRow<c64>| row.terms.iter().map(|term| term.0).collect::<Vec<_>>();
                assert!(workload.rows.iter().any(|row| ties(&paths(row))), "{}, {k}", scene.name);
                let tracks = |row: &PointRow<f64>| row.terms.iter().map(|term| term.0).collect::<Vec<_>>();
                assert!(workload.time_rows.iter().any(|row| ties(&tracks(row))), "{}, {k}", scene.name);
            }
        }
    }

    #[test]
    fn samples_next_to_each_other_are_apart() {
        // A tenth of the sway between two samples: what rounding could not bring about.
        let apart = SWAY * TAU / CYCLE / 10.0;
        for scene in &PUBLISHED_SCENES {
            let workload = published_scene(scene);
            for path in &workload.paths {
                assert!(path.windows(2).all(|pair| (pair[1] - pair[0]).norm() > apart), "{}", scene.name);
                assert!(path.windows(3).all(|three| (three[2] - three[0]).norm() > apart), "{}", scene.name);
            }
        }
    }
}
