//! What a hand is made of, for tests of what it holds.

use cotillion::index::JointId;
use cotillion::skeleton::{Pose, Skeleton};
use glam::DVec3;

/// A hand and all that hangs on it: joints, and ends of their bones.
pub(crate) fn hand_points(skeleton: &Skeleton, pose: &Pose, hand: JointId) -> Vec<DVec3> {
    let frames = skeleton.forward_kinematics(pose);
    let mut is_of_hand = vec![false; frames.len()];
    let mut points = Vec::new();
    for (at, joint) in skeleton.joints.iter().enumerate() {
        is_of_hand[at] =
            at == hand.as_usize() || joint.parent.is_some_and(|parent| is_of_hand[parent.as_usize()]);
        if is_of_hand[at] {
            points.push(frames[at].position);
            points.extend(joint.end_site.map(|end| frames[at].position + frames[at].rotation * end));
        }
    }
    points
}
