//! Turns of a step along time: filled where nothing is known, smoothed, applied.

use glam::{DQuat, DVec3};

use crate::clip::Clip;
use crate::geometry::exp;
use crate::physics::derivatives::{Kernel, Lanes, smooth_from_rest};
use crate::physics::ground::parts::LinkSets;
use crate::physics::posed::PosedClip;

/// What is done to one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displacement {
    /// Turn of what turns, a rotation vector in the world's axes.
    pub turn: DVec3,
    /// Shift of the root, metres.
    pub shift: DVec3,
}

/// Displacements of all frames, smoothed: between known ones linear, none before the first and after the last. Lanes of turns, then of
/// shifts. Cost: linear in frames times taps.
///
/// Held ends instead of none would let one bad frame at an end carry the root away.
pub fn smoothed(known: &[Option<Displacement>], kernel: &Kernel) -> Lanes {
    let mut lanes = Lanes::zeros(6, known.len());
    let mut before: Option<(usize, Displacement)> = None;
    for (frame, displacement) in known.iter().enumerate() {
        let Some(displacement) = displacement else { continue };
        let from = before.map_or(frame, |(at, _)| at + 1);
        for between in from..=frame {
            let value = before.map_or(*displacement, |(at, earlier)| {
                earlier.lerp(displacement, (between - at) as f64 / (frame - at) as f64)
            });
            set(&mut lanes, between, &value);
        }
        before = Some((frame, *displacement));
    }
    smooth_from_rest(&lanes, kernel)
}

impl Displacement {
    fn lerp(&self, other: &Self, share: f64) -> Self {
        Self { turn: self.turn.lerp(other.turn, share), shift: self.shift.lerp(other.shift, share) }
    }
}

fn set(lanes: &mut Lanes, frame: usize, value: &Displacement) {
    for (index, vector) in [value.turn, value.shift].into_iter().enumerate() {
        for (lane, component) in lanes.vector_mut(index).into_iter().zip(vector.to_array()) {
            lane[frame] = component;
        }
    }
}

/// Turns and carries what `sets` say in all frames of `clip`, which `posed` has the frames of. What is carried keeps its rotation in
/// the world. Frames without displacement stay as they are, to the bit. Cost: linear.
pub fn apply(displacements: &Lanes, sets: &LinkSets, posed: &PosedClip, clip: &mut Clip) {
    let joints = &clip.skeleton.joints;
    for (frame, locals) in clip.rotations.chunks_exact_mut(joints.len()).enumerate() {
        let (turn, shift) = (displacements.vector(0, frame), displacements.vector(1, frame));
        if turn == DVec3::ZERO && shift == DVec3::ZERO {
            continue;
        }
        let (turn, world) = (exp(turn), posed.frame(frame));
        for component in &sets.components {
            let own = component.top.as_usize();
            let above =
                joints[own].parent.map_or(DQuat::IDENTITY, |parent| world[parent.as_usize()].rotation);
            replace(&mut locals[own], above.inverse() * (turn * world[own].rotation));
        }
        for border in &sets.borders {
            let own = border.joint.as_usize();
            let above =
                joints[own].parent.map_or(DQuat::IDENTITY, |parent| turn * world[parent.as_usize()].rotation);
            replace(&mut locals[own], above.inverse() * world[own].rotation);
        }
        clip.root_positions[frame] += shift;
    }
}

/// Either sign of a quaternion is the same rotation; the nearer one keeps channels of files continuous.
pub fn replace(local: &mut DQuat, rotation: DQuat) {
    let rotation = rotation.normalize();
    *local = if rotation.dot(*local) < 0.0 { -rotation } else { rotation };
}
