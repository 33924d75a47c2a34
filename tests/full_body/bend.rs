//! Clips laid from their chord onto an arc, and stretched along it.

use cotillion::geometry::{c64, cis, plan_of, world_of, yaw};
use cotillion::skeleton::Pose;

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
    /// `pose` with its root moved and turned.
    fn lay(&self, pose: &Pose) -> Pose {
        let local = (plan_of(pose.root) - self.start) / self.ahead;
        let (place, turn) = laid(self.bend.stretch * local.re, local.im, self.bend.turn, self.length);
        let mut moved = pose.clone();
        moved.root = world_of(self.start + self.ahead * place, pose.root.y);
        moved.rotations[0] = yaw(turn) * pose.rotations[0];
        moved
    }

    /// By how much lengths along the chord change at a place; lengths across stay.
    pub(crate) fn factor(&self, place: c64) -> f64 {
        let left = ((place - self.start) / self.ahead).im;
        self.bend.stretch * (1.0 - left * self.bend.turn / self.length)
    }
}

/// `poses` with their roots moved and turned.
pub(crate) fn bent(poses: &[Pose], bend: Bend) -> Vec<Pose> {
    let chord = bend.chord(poses);
    poses.iter().map(|pose| chord.lay(pose)).collect()
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
