//! The limbs of a skeleton: which joints they are, where they are in a pose, and how a pose takes a new place of one.

use glam::{DQuat, DVec3};

use crate::clip::contacts::{BodyPoint, ContactPoint, contact_point, end_of};
use crate::geometry::{RigidMotion, yaw};
use crate::index::JointId;
use crate::limb::{Limb, minimal_rotation};
use crate::skeleton::{JointFrame, JointRole, Pose, Skeleton};

/// A limb of a skeleton: hip, knee and ankle, or shoulder, elbow and wrist. Other joints between them keep their rotations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    /// Turns the upper bone.
    pub upper: JointId,
    /// Turns the lower bone.
    pub middle: JointId,
    /// Ankle or wrist; of an arm that ends without a wrist the elbow once more, and the wrist is the end.
    pub lower: JointId,
    /// The toe of a leg, where the skeleton has one; the lower joint elsewhere.
    pub end: BodyPoint,
}

/// Where a limb is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Its joints in the world.
    pub limb: Limb,
    /// From the axes of the upper joint to the world's.
    pub upper_rotation: DQuat,
    /// From the axes of the lower joint to the world's.
    pub lower_rotation: DQuat,
    /// Where its end is.
    pub end: DVec3,
}

/// A foot or a hand in the world: of the lower joint of a limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndPose {
    /// Metres.
    pub position: DVec3,
    /// From joint axes to the world's.
    pub rotation: DQuat,
}

impl Place {
    /// Its lower joint.
    pub const fn end_pose(&self) -> EndPose {
        EndPose { position: self.limb.lower, rotation: self.lower_rotation }
    }

    /// The same limb, carried by a motion of the ground.
    pub fn carried(&self, motion: &RigidMotion) -> Self {
        let Limb { upper, middle, lower } = self.limb;
        let [upper, middle, lower, end] =
            [upper, middle, lower, self.end].map(|point| motion.apply_world(point));
        let turn = yaw(motion.angle());
        Self {
            limb: Limb { upper, middle, lower },
            upper_rotation: turn * self.upper_rotation,
            lower_rotation: turn * self.lower_rotation,
            end,
        }
    }

    /// The same limb moved by `shift`.
    pub fn shifted(mut self, shift: DVec3) -> Self {
        self.limb.upper += shift;
        self.limb.middle += shift;
        self.limb.lower += shift;
        self.end += shift;
        self
    }
}

/// The legs of a skeleton, the left one first; `None` for one that lacks hip, knee or ankle.
pub fn legs(skeleton: &Skeleton) -> [Option<Chain>; 2] {
    let left = [JointRole::LeftHip, JointRole::LeftKnee, JointRole::LeftFoot];
    let right = [JointRole::RightHip, JointRole::RightKnee, JointRole::RightFoot];
    [
        chain(skeleton, left, contact_point(skeleton, ContactPoint::LeftToe)),
        chain(skeleton, right, contact_point(skeleton, ContactPoint::RightToe)),
    ]
}

/// The arms of a skeleton, the left one first; `None` for one that lacks shoulder, elbow or wrist.
pub fn arms(skeleton: &Skeleton) -> [Option<Chain>; 2] {
    let left = [JointRole::LeftShoulder, JointRole::LeftElbow, JointRole::LeftHand];
    let right = [JointRole::RightShoulder, JointRole::RightElbow, JointRole::RightHand];
    [chain(skeleton, left, None), chain(skeleton, right, None)]
}

/// The arms whose hands can bear: also those that end without a wrist, at the end of the forearm.
pub fn bearing_arms(skeleton: &Skeleton) -> [Option<Chain>; 2] {
    let [left, right] = arms(skeleton);
    [
        left.or_else(|| open_chain(skeleton, [JointRole::LeftShoulder, JointRole::LeftElbow])),
        right.or_else(|| open_chain(skeleton, [JointRole::RightShoulder, JointRole::RightElbow])),
    ]
}

/// The limb of two roles and the end of its second bone.
fn open_chain(skeleton: &Skeleton, roles: [JointRole; 2]) -> Option<Chain> {
    let [upper, middle] = roles.map(|role| skeleton.joint_of(role));
    let (upper, middle) = (upper?, middle?);
    let found = Chain { upper, middle, lower: middle, end: end_of(skeleton, middle)? };
    (upper != JointId(0) && is_below(skeleton, middle, upper) && found.has_bones(skeleton)).then_some(found)
}

/// The limb of three roles, if each joint is there and below the one before, the upper one is not the root, and both bones
/// have a length.
fn chain(skeleton: &Skeleton, roles: [JointRole; 3], end: Option<BodyPoint>) -> Option<Chain> {
    let [upper, middle, lower] = roles.map(|role| skeleton.joint_of(role));
    let (upper, middle, lower) = (upper?, middle?, lower?);
    let is_chain =
        upper != JointId(0) && is_below(skeleton, middle, upper) && is_below(skeleton, lower, middle);
    let end = end.unwrap_or(BodyPoint { joint: lower, local: DVec3::ZERO });
    let found = is_chain.then_some(Chain { upper, middle, lower, end })?;
    found.has_bones(skeleton).then_some(found)
}

/// Shorter bones bend no limb, metres.
const SHORTEST_BONE: f64 = 1e-3;

/// Whether `joint` hangs on `ancestor`.
pub fn is_below(skeleton: &Skeleton, joint: JointId, ancestor: JointId) -> bool {
    let mut above = skeleton.joints[joint.as_usize()].parent;
    while let Some(at) = above {
        if at == ancestor {
            return true;
        }
        above = skeleton.joints[at.as_usize()].parent;
    }
    false
}

/// World frame of one joint. Cost: linear in the joints above it.
pub fn world_frame(skeleton: &Skeleton, pose: &Pose, joint: JointId) -> JointFrame {
    let at = joint.as_usize();
    let rotation = pose.rotations[at];
    match skeleton.joints[at].parent {
        None => JointFrame { position: pose.root, rotation },
        Some(parent) => below(skeleton, pose, joint, &world_frame(skeleton, pose, parent)),
    }
}

/// World frame of `joint`, whose parent is at `above`.
fn below(skeleton: &Skeleton, pose: &Pose, joint: JointId, above: &JointFrame) -> JointFrame {
    let at = joint.as_usize();
    let offset = if pose.offsets.is_empty() { None } else { pose.offset_of(joint) };
    JointFrame {
        position: above.position + above.rotation * offset.unwrap_or(skeleton.joints[at].offset),
        rotation: above.rotation * pose.rotations[at],
    }
}

/// World frame of `joint`, which hangs on `ancestor`, whose frame is `from`.
fn frame_from(
    skeleton: &Skeleton,
    pose: &Pose,
    joint: JointId,
    (ancestor, from): (JointId, &JointFrame),
) -> JointFrame {
    if joint == ancestor {
        return *from;
    }
    match skeleton.joints[joint.as_usize()].parent {
        Some(parent) => below(skeleton, pose, joint, &frame_from(skeleton, pose, parent, (ancestor, from))),
        None => *from,
    }
}

impl Chain {
    /// Whether both bones have a length.
    fn has_bones(&self, skeleton: &Skeleton) -> bool {
        let [upper, lower] = self.place(skeleton, &skeleton.rest_pose()).limb.lengths();
        upper.min(lower) > SHORTEST_BONE
    }

    /// Whether it ends without a wrist.
    pub fn is_open(&self) -> bool {
        self.lower == self.middle
    }

    /// Where the limb is in `pose`.
    pub fn place(&self, skeleton: &Skeleton, pose: &Pose) -> Place {
        let upper = world_frame(skeleton, pose, self.upper);
        let middle = frame_from(skeleton, pose, self.middle, (self.upper, &upper));
        let lower = frame_from(skeleton, pose, self.lower, (self.middle, &middle));
        let end = frame_from(skeleton, pose, self.end.joint, (self.lower, &lower));
        let end = end.position + end.rotation * self.end.local;
        let last = if self.is_open() { end } else { lower.position };
        Place {
            limb: Limb { upper: upper.position, middle: middle.position, lower: last },
            upper_rotation: upper.rotation,
            lower_rotation: lower.rotation,
            end,
        }
    }

    /// Turns the limb, which is at `from` in `pose`, so that its middle joint comes to `middle` and its lower one to
    /// `to`, by the smallest turns of both bones.
    pub fn turn(&self, skeleton: &Skeleton, pose: &mut Pose, from: &Place, (middle, to): (DVec3, &EndPose)) {
        let upper_turn = minimal_rotation(from.limb.middle - from.limb.upper, middle - from.limb.upper);
        let carried = upper_turn * (from.limb.lower - from.limb.middle);
        let lower_turn = minimal_rotation(carried, to.position - middle);
        turn_in_world(skeleton, pose, self.upper, upper_turn);
        turn_in_world(skeleton, pose, self.middle, lower_turn);
        if !self.is_open() {
            set_in_world(skeleton, pose, self.lower, to.rotation);
        }
    }
}

/// Turns `joint` and all that hangs on it by `turn`, in the world's axes.
pub fn turn_in_world(skeleton: &Skeleton, pose: &mut Pose, joint: JointId, turn: DQuat) {
    let above = rotation_above(skeleton, pose, joint);
    let local = &mut pose.rotations[joint.as_usize()];
    *local = (above.inverse() * turn * above * *local).normalize();
}

/// Gives `joint` the world rotation `rotation`.
pub fn set_in_world(skeleton: &Skeleton, pose: &mut Pose, joint: JointId, rotation: DQuat) {
    let above = rotation_above(skeleton, pose, joint);
    let before = pose.rotations[joint.as_usize()];
    let local = (above.inverse() * rotation).normalize();
    // Either sign is the same rotation; the nearer one keeps channels of files continuous.
    pose.rotations[joint.as_usize()] = if local.dot(before) < 0.0 { -local } else { local };
}

fn rotation_above(skeleton: &Skeleton, pose: &Pose, joint: JointId) -> DQuat {
    let mut above = skeleton.joints[joint.as_usize()].parent;
    let mut rotation = DQuat::IDENTITY;
    while let Some(at) = above {
        rotation = pose.rotations[at.as_usize()] * rotation;
        above = skeleton.joints[at.as_usize()].parent;
    }
    rotation
}
