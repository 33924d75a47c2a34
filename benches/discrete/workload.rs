//! The five scenes of the paper's Table 1 to edit with discrete changes: its counts of frames, rows and changes, on synthetic
//! paths.

use std::sync::Arc;

use cotillion::clip::working::WorkingClip;
use cotillion::constraint::{
    Constraint, ConstraintKind, Discrete, Instant, Partner, Relation, Strength, Target, When,
};
use cotillion::discrete::candidates::{Seen, candidates};
use cotillion::discrete::remap::{bound, protected};
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::geometry::c64;
use cotillion::graph::MotionGraph;
use cotillion::index::{CharacterId, ConstraintId};
use cotillion::scene::{Mode, Scene};
use cotillion_solvers::PointRow;
use cotillion_solvers::workload::{PublishedScene, Workload, published_scene};

use crate::paths::{graph, moment, path_clip, scene};

/// Frames of one gait cycle of the workloads.
const CYCLE: usize = 30;
/// Distance of frames a cycle apart.
const ALIKE: f64 = 0.1;

/// A scene to edit, with all that is given beforehand.
pub(crate) struct Case {
    /// For tables.
    pub(crate) name: &'static str,
    pub(crate) scene: Scene,
    pub(crate) graph: Arc<MotionGraph>,
    pub(crate) clips: Vec<Arc<WorkingClip>>,
    /// Handles that are dragged, with their targets at rest and where they are drawn.
    pub(crate) place: (ConstraintId, c64, c64),
    pub(crate) time: (ConstraintId, f64, f64),
}

impl Case {
    /// Targets after step `step` of `steps`.
    pub(crate) fn dragged(&self, step: usize, steps: usize) -> [(ConstraintId, Target); 2] {
        let share = step as f64 / steps as f64;
        let ((place, from, to), (time, early, late)) = (self.place, self.time);
        [
            (place, Target::Position(from + share * (to - from))),
            (time, Target::Seconds(early + share * (late - early))),
        ]
    }
}

/// The scene of the table: soft rows become pins and places beside the partner, the hard rows stationary stretches; similar
/// frames are a cycle apart, as many as bring about the changes of the table.
pub(crate) fn case(published: &PublishedScene, mode: Mode) -> Case {
    let workload = published_scene(published);
    let clips: Vec<Arc<WorkingClip>> = (0..workload.paths.len()).map(|path| clip(&workload, path)).collect();
    let (constraints, handles) = constraints(&workload);
    let mut scene = scene(&clips, constraints);
    scene.mode = mode;
    scene.discrete = Some(Discrete::default());
    let frames: Vec<usize> = clips.iter().map(|clip| clip.frame_count()).collect();
    let mut pairs = Vec::new();
    for (who, counts) in published.characters.iter().enumerate() {
        let start: usize = frames[..who].iter().sum();
        let own = similar(&scene, who, counts.changes);
        pairs.extend(own.into_iter().map(|(i, j)| (start + i, start + j, ALIKE)));
    }
    let (place, time) = handles;
    let target = |row: usize| workload.targets[row];
    let last = workload.paths.len() - 1;
    let (end, steps) = (workload.paths[last][workload.paths[last].len() - 1], workload.paths[last].len() - 1);
    Case {
        name: published.name,
        scene,
        graph: Arc::new(graph(&frames, &pairs)),
        clips,
        place: (place, end, target(workload.handle.0)),
        time: (time, steps as f64 / 30.0, workload.time_targets[workload.handle.1]),
    }
}

fn clip(workload: &Workload, path: usize) -> Arc<WorkingClip> {
    let mut clip = (*path_clip(&workload.paths[path], None)).clone();
    clip.name = format!("path {path}");
    for (_, first, last) in workload.stands_of(path) {
        clip.stationary[*first..=*last].fill(true);
        let facing = clip.headings[*first];
        clip.headings[*first..=*last].fill(facing);
    }
    Arc::new(clip)
}

/// Constraints of all rows, and the two that are dragged.
fn constraints(workload: &Workload) -> (Vec<Constraint>, (ConstraintId, ConstraintId)) {
    let mut constraints = Vec::new();
    let mut place = ConstraintId::from_usize(0);
    let mut row = 0;
    while row < workload.rows.len() {
        let PointRow { terms, weight } = &workload.rows[row];
        if row == workload.handle.0 {
            place = ConstraintId::from_usize(constraints.len());
        }
        let at = When::At(at(terms[0]));
        let (kind, rows) = match terms[..] {
            [(path, point, _)] => {
                let position = Some(workload.paths[path][point]);
                (ConstraintKind::Pin { when: at, position, facing: None }, 1)
            }
            [_, partner, ..] => (beside(at, partner), 2),
            [] => unreachable!("every row has a term"),
        };
        constraints.push(constraint("place", weight.map_or(Strength::Hard, Strength::Soft), kind));
        row += rows;
    }
    let mut time = ConstraintId::from_usize(0);
    for (index, (row, seconds)) in workload.time_rows.iter().zip(&workload.time_targets).enumerate() {
        if index == workload.handle.1 {
            time = ConstraintId::from_usize(constraints.len());
        }
        let kind = match row.terms[..] {
            [own, partner] => {
                let moments = vec![When::At(at(own)), When::At(at(partner))];
                ConstraintKind::Sync { moments, offset: *seconds }
            }
            _ => {
                let own = at(row.terms[0]);
                ConstraintKind::Time { at: own, seconds: row.terms[0].1 as f64 / 30.0 }
            }
        };
        constraints.push(constraint("time", row.weight.map_or(Strength::Hard, Strength::Soft), kind));
    }
    (constraints, (place, time))
}

fn constraint(name: &str, strength: Strength, kind: ConstraintKind) -> Constraint {
    Constraint { name: name.to_owned(), line: 0, strength, kind }
}

fn at<T>((path, point, _): (usize, usize, T)) -> cotillion::constraint::Moment {
    moment(path, Instant::Frame { entry: 0, working: point as f64 })
}

fn beside<T>(when: When, partner: (usize, usize, T)) -> ConstraintKind {
    let partner = Partner::Character(When::At(at(partner)));
    ConstraintKind::Relative { when, partner, offset: Relation::AsBefore, facing: Relation::AsBefore }
}

/// Pairs of frames a cycle apart, spread over the walking frames of a character, as many as it takes to have `changes`.
fn similar(scene: &Scene, who: usize, changes: usize) -> Vec<(usize, usize)> {
    let track = &scene.characters[who].track;
    let still = &track.clips[0].stationary;
    let walking = |i: &usize| still[*i..=i + CYCLE].iter().all(|still| !still);
    let all: Vec<usize> = (1..still.len() - CYCLE - 1).filter(walking).collect();
    let bound = bound(scene.clone());
    let protected = protected(&bound, CharacterId::from_usize(who));
    let settings = DiscreteSettings::of_scene(scene);
    let open = vec![true; still.len()];
    let found = |pairs: &[(usize, usize)]| {
        let pairs: Vec<_> = pairs.iter().map(|(i, j)| (*i, *j, ALIKE)).collect();
        let graph = graph(&[still.len()], &pairs);
        let character = CharacterId::from_usize(who);
        let seen = Seen { character, track, clips: &[0], protected: &protected, still, open: &open };
        candidates(&graph, &seen, &settings).len()
    };
    let mut pairs = Vec::new();
    for count in 1..=all.len() {
        pairs =
            (0..count).map(|k| all[(2 * k + 1) * all.len() / (2 * count)]).map(|i| (i, i + CYCLE)).collect();
        if found(&pairs) >= changes {
            break;
        }
    }
    pairs
}
