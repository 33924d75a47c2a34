//! Which joint moves which, and the turn between their axes.

use glam::{DQuat, DVec3};

use crate::clip::contacts::end_of;
use crate::clip::retarget::stance::Stance;
use crate::index::JointId;
use crate::limb::minimal_rotation;
use crate::skeleton::{JointFrame, JointRole, Skeleton};

/// What turns a joint. `align` goes from the joint's axes to those of the clip's joint: rotations in the world are the clip's,
/// times it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drive {
    /// A joint of the clip.
    Joint {
        /// Which.
        source: JointId,
        /// See above.
        align: DQuat,
    },
    /// Two joints of the clip, between which it lies.
    Between {
        /// Joints with their `align`, from below up.
        ends: [(JointId, DQuat); 2],
        /// Of the way from the first to the second.
        share: f64,
    },
    /// Nothing: it rests against its parent.
    Rest,
}

/// Limbs whose bones are aligned one after another; each bone goes from its joint to the next, the last to its end.
const LIMBS: [&[JointRole]; 4] = [
    &[JointRole::LeftShoulder, JointRole::LeftElbow, JointRole::LeftHand],
    &[JointRole::RightShoulder, JointRole::RightElbow, JointRole::RightHand],
    &[JointRole::LeftHip, JointRole::LeftKnee, JointRole::LeftFoot, JointRole::LeftToe],
    &[JointRole::RightHip, JointRole::RightKnee, JointRole::RightFoot, JointRole::RightToe],
];

/// Parts of the trunk between which joints without role share the bend.
const TRUNK: [JointRole; 5] =
    [JointRole::Pelvis, JointRole::Spine, JointRole::Chest, JointRole::Neck, JointRole::Head];

/// One drive for each joint of `onto`. `stances`: of the clip's body and of the other.
///
/// Trunk and collars turn as bodies stand in their rest poses: where a trunk's joints lie is its author's choice. Bones of
/// limbs are aligned in direction, each by the smallest turn after the one before it. Feet and toes are aligned by the soles.
pub(super) fn drives(source: &Skeleton, onto: &Skeleton, stances: &[Stance; 2]) -> Vec<Drive> {
    let whole = (stances[0].body * stances[1].body.inverse()).normalize();
    let mut drives = vec![Drive::Rest; onto.joints.len()];
    for role in JointRole::ALL {
        if let (Some(from), Some(joint)) = (source.joint_of(role), onto.joint_of(role)) {
            drives[joint.as_usize()] = Drive::Joint { source: from, align: whole };
        }
    }
    for limb in LIMBS {
        align_limb((source, onto), limb, (stances, whole), &mut drives);
    }
    match_names(source, onto, &mut drives);
    share_trunk(onto, &mut drives);
    if drives[0] == Drive::Rest {
        let pelvis = source.joint_of(JointRole::Pelvis).unwrap_or(JointId(0));
        drives[0] = Drive::Joint { source: pelvis, align: whole };
    }
    drives
}

fn align_limb(
    (source, onto): (&Skeleton, &Skeleton),
    limb: &[JointRole],
    (stances, whole): (&[Stance; 2], DQuat),
    drives: &mut [Drive],
) {
    let rests = [source, onto].map(|skeleton| skeleton.forward_kinematics(&skeleton.rest_pose()));
    let mut turn = whole;
    for (index, &role) in limb.iter().enumerate() {
        let (Some(from), Some(joint)) = (source.joint_of(role), onto.joint_of(role)) else {
            continue;
        };
        let next = limb.get(index + 1).copied();
        let soles = match role {
            JointRole::LeftFoot => [stances[0].soles[0], stances[1].soles[0]],
            JointRole::RightFoot => [stances[0].soles[1], stances[1].soles[1]],
            _ => [None, None],
        };
        let is_toe = matches!(role, JointRole::LeftToe | JointRole::RightToe);
        turn = match soles {
            [Some(from), Some(to)] => (from.axes * to.axes.inverse()).normalize(),
            _ if is_toe => turn,
            _ => {
                let bones = [(source, from, &rests[0]), (onto, joint, &rests[1])];
                let bones = bones.map(|(skeleton, joint, rest)| bone(skeleton, joint, next, rest));
                match bones {
                    [Some(from), Some(to)] => (minimal_rotation(turn * to, from) * turn).normalize(),
                    _ => turn,
                }
            }
        };
        drives[joint.as_usize()] = Drive::Joint { source: from, align: turn };
    }
}

/// From a joint to the one of `next`, else to its end, in the rest pose.
fn bone(skeleton: &Skeleton, joint: JointId, next: Option<JointRole>, rest: &[JointFrame]) -> Option<DVec3> {
    let from = rest[joint.as_usize()].position;
    let next = next.and_then(|role| skeleton.joint_of(role));
    let to = match next {
        Some(next) => rest[next.as_usize()].position,
        None => end_of(skeleton, joint)
            .map(|end| end.place(rest))
            .or_else(|| only_child(skeleton, joint, rest))?,
    };
    (to - from).try_normalize()
}

/// Where the only joint below `joint` is.
fn only_child(skeleton: &Skeleton, joint: JointId, rest: &[JointFrame]) -> Option<DVec3> {
    let mut below = (0..skeleton.joints.len()).filter(|&index| skeleton.joints[index].parent == Some(joint));
    match (below.next(), below.next()) {
        (Some(only), None) => Some(rest[only].position),
        _ => None,
    }
}

/// Joints without role go with those of their name; the turn between their axes is that of the joint they hang on.
fn match_names(source: &Skeleton, onto: &Skeleton, drives: &mut [Drive]) {
    for (index, joint) in onto.joints.iter().enumerate() {
        let from = source.joint_named(&joint.name).filter(|_| joint.role.is_none());
        let Some(from) = from.filter(|from| source.joints[from.as_usize()].role.is_none()) else {
            continue;
        };
        let above = joint.parent.map(|parent| drives[parent.as_usize()]);
        if let Some(Drive::Joint { align, .. }) = above {
            drives[index] = Drive::Joint { source: from, align };
        }
    }
}

/// Joints of the trunk that nothing moves share the turn between the nearest that are moved, above and below.
fn share_trunk(onto: &Skeleton, drives: &mut [Drive]) {
    let moved: Vec<JointId> = TRUNK
        .into_iter()
        .filter_map(|role| onto.joint_of(role))
        .filter(|joint| drives[joint.as_usize()] != Drive::Rest)
        .collect();
    for pair in moved.windows(2) {
        let path = between(onto, pair[0], pair[1]);
        let ends = [pair[0], pair[1]].map(|joint| drives[joint.as_usize()]);
        let [Drive::Joint { source: low, align: a }, Drive::Joint { source: high, align: b }] = ends else {
            continue;
        };
        let count = path.len() as f64 + 1.0;
        for (step, joint) in path.into_iter().enumerate() {
            if drives[joint.as_usize()] == Drive::Rest {
                let share = (step as f64 + 1.0) / count;
                drives[joint.as_usize()] = Drive::Between { ends: [(low, a), (high, b)], share };
            }
        }
    }
}

/// Joints between `above` and `below` in the tree, from above; none if neither hangs on the other.
fn between(skeleton: &Skeleton, above: JointId, below: JointId) -> Vec<JointId> {
    let parent = |joint: &JointId| skeleton.joints[joint.as_usize()].parent;
    let mut path: Vec<JointId> = std::iter::successors(parent(&below), parent).collect();
    let Some(end) = path.iter().position(|joint| *joint == above) else {
        return Vec::new();
    };
    path.truncate(end);
    path.reverse();
    path
}
