//! Generated bodies with as many joints as captured ones have.

use std::collections::BTreeMap;

use cotillion::clip::Clip;
use cotillion::clip::builtin::generate;
use cotillion::index::JointId;
use cotillion::skeleton::{JointRole, Pose, Skeleton};
use glam::{DQuat, DVec3};

/// Joints of the most common captured skeleton.
const JOINTS: usize = 31;

/// A generated walk of `seconds`.
pub(crate) fn walk(seconds: f64) -> Clip {
    generate("walk", &BTreeMap::from([("seconds".to_owned(), seconds)])).expect("a known clip")
}

/// `skeleton` with fingers that make its joints as many.
pub(crate) fn with_fingers(skeleton: &Skeleton) -> Skeleton {
    let mut skeleton = skeleton.clone();
    let hand = skeleton.joint_of(JointRole::RightHand).expect("the generated body has hands");
    let mut finger = skeleton.joints[hand.as_usize()].clone();
    finger.role = None;
    finger.offset = DVec3::NEG_Y * 0.05;
    while skeleton.joints.len() < JOINTS {
        finger.parent = Some(JointId::from_usize(skeleton.joints.len() - 1));
        skeleton.joints.push(finger.clone());
    }
    skeleton
}

/// `pose` with fingers that hold still.
pub(crate) fn with_still_fingers(mut pose: Pose) -> Pose {
    pose.rotations.resize(JOINTS, DQuat::IDENTITY);
    pose
}
