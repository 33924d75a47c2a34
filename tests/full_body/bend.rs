//! Clips laid from their chord onto an arc, and stretched along it.

use cotillion::clip::working::WORKING_STEP;
use cotillion::geometry::{c64, cis, plan_of, world_of, yaw};
use cotillion::index::floor_index;
use cotillion::skeleton::Pose;

use crate::clips::Stretch;

/// What is done to a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bend {
    /// Turn of the arc onto which the chord is laid, radians, left positive.
    pub(crate) turn: f64,
    /// Factor along the chord.
    pub(crate) stretch: f64,
}

/// The chord of a path, and the arc onto which it is laid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chord {
    start: c64,
    ahead: c64,
    /// Of the arc, metres.
    length: f64,
    bend: Bend,
}

impl Bend {
    /// Of the path of `poses`, of which there are two or more.
    pub(crate) fn chord(self, poses: &[Pose]) -> Chord {
        let start = plan_of(poses[0].root);
        let chord = plan_of(poses[poses.len() - 1].root) - start;
        Chord { start, ahead: chord / chord.norm(), length: self.stretch * chord.norm(), bend: self }
    }
}

impl Chord {
    /// Where a place comes to lie, and the turn there.
    fn lay(&self, place: c64) -> (c64, f64) {
        let local = (place - self.start) / self.ahead;
        let (laid, turn) = laid(self.bend.stretch * local.re, local.im, self.bend.turn, self.length);
        (self.start + self.ahead * laid, turn)
    }

    /// By how much lengths along the chord change at a place; lengths across stay.
    pub(crate) fn factor(&self, place: c64) -> f64 {
        let left = ((place - self.start) / self.ahead).im;
        self.bend.stretch * (1.0 - left * self.bend.turn / self.length)
    }
}

/// The poses of a stretch with their roots moved and turned. The path is that of every working frame, straight between; what
/// a root does beside it (at a higher rate mostly noise) is turned, not stretched.
pub(crate) fn bent(stretch: &Stretch, bend: Bend) -> Vec<Pose> {
    let poses = stretch.rest;
    let chord = bend.chord(poses);
    let every = working_step(&stretch.times);
    let moved = |(at, pose): (usize, &Pose)| {
        let low = (at / every * every).min((poses.len() - 1).saturating_sub(every));
        let high = (low + every).min(poses.len() - 1);
        let share = (at - low) as f64 / every as f64;
        let [from, to] = [low, high].map(|at| plan_of(poses[at].root));
        let [(start, left), (end, right)] = [from, to].map(|place| chord.lay(place));
        let turn = left + share * (right - left);
        let detail = plan_of(pose.root) - (from + (to - from) * share);
        let mut moved = pose.clone();
        moved.root = world_of(start + (end - start) * share + cis(turn) * detail, pose.root.y);
        moved.rotations[0] = yaw(turn) * pose.rotations[0];
        moved
    };
    poses.iter().enumerate().map(moved).collect()
}

/// Samples from one working frame to the next.
fn working_step(times: &[f64]) -> usize {
    let step = times[1] - times[0];
    floor_index((WORKING_STEP / step).round()).max(1)
}

/// The point `along` and `left` of a chord of `length`, laid onto an arc that turns by `turn` over it, and the turn there.
fn laid(along: f64, left: f64, turn: f64, length: f64) -> (c64, f64) {
    if turn == 0.0 {
        return (c64::new(along, left), 0.0);
    }
    let radius = length / turn;
    let angle = along / radius;
    let centre = c64::new(0.0, radius);
    (centre + c64::new(0.0, left - radius) * cis(angle), angle)
}

impl Bend {
    /// For messages.
    pub(crate) fn name(&self) -> String {
        format!("{:.0} degrees, ×{}", self.turn.to_degrees(), self.stretch)
    }
}

/// `poses` turned by `turn` about the origin and moved: an edit that changes no step.
pub(crate) fn placed(poses: &[Pose], turn: f64) -> Vec<Pose> {
    let moved = |pose: &Pose| {
        let mut moved = pose.clone();
        moved.root = world_of(cis(turn) * plan_of(pose.root) + c64::new(2.0, -1.0), pose.root.y);
        moved.rotations[0] = yaw(turn) * pose.rotations[0];
        moved
    };
    poses.iter().map(moved).collect()
}
