//! What the ground pass did.

use crate::clip::Clip;
use crate::geometry::log;
use crate::index::JointId;
use crate::physics::ground::state::State;
pub use crate::physics::ground::step::TurnFaults;
use crate::physics::ground::target::{Sight, Source, summary};
use crate::physics::posed::PosedClip;
use crate::physics::zmp::DistanceSummary;

/// How good a motion is. Pairs: by the filter that is optimised, and by the judge's, at 6 Hz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// From zero moment points to polygons; `None` where nothing bears.
    pub distance: [Option<DistanceSummary>; 2],
    /// From zero moment points to where they are to be, where that is carried over from a source.
    pub miss: Option<[f64; 2]>,
}

impl Judged {
    pub(super) fn of(sights: &[Vec<Option<Sight>>; 2], is_carried: bool) -> Self {
        let mean =
            |measured: &Vec<Option<Sight>>| summary(measured, Sight::miss).map_or(0.0, |miss| miss.mean);
        Self {
            distance: [0, 1].map(|filter| summary(&sights[filter], |sight| sight.distance)),
            miss: is_carried.then(|| [mean(&sights[0]), mean(&sights[1])]),
        }
    }

    /// What is to fall, metres.
    pub(super) fn optimised(&self) -> f64 {
        self.miss.map_or_else(|| self.mean(0), |miss| miss[0])
    }

    fn mean(&self, filter: usize) -> f64 {
        self.distance[filter].map_or(0.0, |distance| distance.mean)
    }

    /// Whether the judge sees its zero moment points farther from their polygons.
    pub(super) fn is_farther_than(&self, other: &Self) -> bool {
        self.mean(1) > other.mean(1)
    }

    /// Whether the judge prefers it.
    pub(super) fn is_better_than(&self, other: &Self) -> bool {
        match (self.miss, other.miss) {
            (Some(own), Some(other)) => own[1] < other[1],
            _ => self.mean(1) < other.mean(1),
        }
    }
}

/// One step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Where turns were not what they should.
    pub faults: TurnFaults,
    /// After it.
    pub judged: Judged,
}

/// A joint that turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointChange {
    /// Which.
    pub joint: JointId,
    /// When.
    pub frame: usize,
    /// Against its parent (the root: against the world), radians.
    pub angle: f64,
}

/// What the ground pass did.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundReport {
    /// The untouched source of the edit, where it is known: of both filters.
    pub source: Option<[Option<DistanceSummary>; 2]>,
    /// The input.
    pub before: Judged,
    /// The result.
    pub after: Judged,
    /// All steps that were tried.
    pub steps: Vec<StepReport>,
    /// So many of them are in the result: later ones were worse.
    pub kept: usize,
    /// Largest distance of planted feet and hands from where the input has them, metres.
    pub plant_error: f64,
    /// Largest turn of planted feet and hands, radians.
    pub plant_turn: f64,
    /// Largest turn of a joint, if any turned.
    pub largest_change: Option<JointChange>,
    /// Largest shift of the root, metres.
    pub root_shift: f64,
}

impl GroundReport {
    pub(super) fn new(before: &Judged, source: Option<&Source>) -> Self {
        Self {
            source: source.map(|source| source.distances),
            before: *before,
            after: *before,
            steps: Vec::new(),
            kept: 0,
            plant_error: 0.0,
            plant_turn: 0.0,
            largest_change: None,
            root_shift: 0.0,
        }
    }

    pub(super) fn finish(
        &mut self,
        input: &Clip,
        result: &Clip,
        (judged, kept): (&Judged, usize),
        state: &State<'_>,
    ) {
        (self.after, self.kept) = (*judged, kept);
        if kept > 0 {
            (self.plant_error, self.plant_turn) = state.plants.errors(&PosedClip::of(result));
        }
        let shifts = input.root_positions.iter().zip(&result.root_positions);
        self.root_shift = shifts.map(|(from, to)| from.distance(*to)).fold(0.0, f64::max);
        self.largest_change = largest_change(input, result);
    }
}

/// Turns of all joints from one clip to another of the same skeleton and length, radians: all of frame 0, then of frame 1 …
pub fn joint_changes(from: &Clip, to: &Clip) -> Vec<f64> {
    let change = |(from, to): (&glam::DQuat, &glam::DQuat)| {
        if from == to { 0.0 } else { log(*to * from.inverse()).length() }
    };
    from.rotations.iter().zip(&to.rotations).map(change).collect()
}

/// Joint that turns most against its parent from one clip to another of the same skeleton and length; `None` if none turns.
pub fn largest_change(from: &Clip, to: &Clip) -> Option<JointChange> {
    let joint_count = from.skeleton.joints.len();
    let changes = joint_changes(from, to);
    let (at, angle) = changes.iter().enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    (*angle > 0.0).then(|| JointChange {
        joint: JointId::from_usize(at % joint_count),
        frame: at / joint_count,
        angle: *angle,
    })
}
