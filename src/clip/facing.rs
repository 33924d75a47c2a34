//! Which way a body faces on the ground, at one instant and along a clip.

use std::f64::consts::FRAC_PI_2;

use glam::{DQuat, DVec3};

use crate::geometry::{c64, plan_of, wrap};
use crate::index::JointId;
use crate::skeleton::{JointFrame, JointRole, Pose, Skeleton, facing_vector};

/// Hips closer than this share of their width, seen from above, show no facing: the body lies on its side.
const LEAST_SHARE_OF_WIDTH: f64 = 0.1;

/// Heading of the rest pose, which faces +z: −90°.
pub const REST_HEADING: f64 = -FRAC_PI_2;

/// Ground heading of a body from its hips, radians in (−π, π]: `arg(−i·(hip_left − hip_right))` in the plan.
///
/// `frames`: world frames of all joints. `None` where the skeleton has no hips, or where they are nearer to each other
/// seen from above than a tenth of the hip width.
pub fn facing(skeleton: &Skeleton, frames: &[JointFrame]) -> Option<f64> {
    facing_of_hips(skeleton, |hip| frames[hip.as_usize()].position)
}

/// The same of a pose: only what leads to the hips is posed.
pub fn pose_facing(skeleton: &Skeleton, pose: &Pose) -> Option<f64> {
    facing_of_hips(skeleton, |hip| skeleton.joint_frame(pose, hip).position)
}

fn facing_of_hips(skeleton: &Skeleton, position: impl Fn(JointId) -> DVec3) -> Option<f64> {
    let left = position(skeleton.joint_of(JointRole::LeftHip)?);
    let right = position(skeleton.joint_of(JointRole::RightHip)?);
    let ahead: c64 = facing_vector(plan_of(left), plan_of(right));
    let width = left.distance(right);
    (width > 0.0 && ahead.norm() >= LEAST_SHARE_OF_WIDTH * width).then(|| ahead.arg())
}

/// Turn of `rotation` about +y, radians in (−π, π]: its twist; 0 for a half turn about a level axis, which has none.
pub fn turn_about_up(rotation: DQuat) -> f64 {
    if rotation.y == 0.0 && rotation.w == 0.0 {
        return 0.0;
    }
    wrap(2.0 * rotation.y.atan2(rotation.w))
}

/// Headings of successive poses, unwrapped from frame to frame, radians.
///
/// `poses`: world frames of all joints of each pose. Where the hips show no facing, the root's turn since the nearest
/// pose that does (the earlier of two as near) is added to that pose's facing; where no pose does, the root's turn since
/// the rest pose, which faces +z.
pub fn headings(skeleton: &Skeleton, poses: &[Vec<JointFrame>]) -> Vec<f64> {
    let shown: Vec<Option<f64>> = poses.iter().map(|frames| facing(skeleton, frames)).collect();
    let nearest = nearest_shown(&shown);
    let mut headings: Vec<f64> = Vec::with_capacity(poses.len());
    for (index, frames) in poses.iter().enumerate() {
        let root = frames[0].rotation;
        let heading = shown[index].unwrap_or_else(|| match nearest[index] {
            Some(good) => {
                let since = turn_about_up(root * poses[good][0].rotation.inverse());
                shown[good].unwrap_or(REST_HEADING) + since
            }
            None => REST_HEADING + turn_about_up(root),
        });
        let before = headings.last().copied();
        headings.push(before.map_or_else(|| wrap(heading), |before| before + wrap(heading - before)));
    }
    headings
}

/// For each index the nearest one that holds a value, the earlier of two as near.
fn nearest_shown(shown: &[Option<f64>]) -> Vec<Option<usize>> {
    let mut nearest: Vec<Option<usize>> = Vec::with_capacity(shown.len());
    let mut last = None;
    for (index, value) in shown.iter().enumerate() {
        last = value.map(|_| index).or(last);
        nearest.push(last);
    }
    let mut next = None;
    for index in (0..shown.len()).rev() {
        next = shown[index].map(|_| index).or(next);
        nearest[index] = match (nearest[index], next) {
            (Some(before), Some(after)) if after - index < index - before => Some(after),
            (before, after) => before.or(after),
        };
    }
    nearest
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::DVec3;

    use super::*;
    use crate::geometry::yaw;
    use crate::index::JointId;
    use crate::skeleton::{Axis, Joint};

    /// Rounding of a few rotations.
    const ROUNDING: f64 = 1e-12;

    fn body(with_hips: bool) -> Skeleton {
        let joint = |name: &str, parent: Option<u32>, offset: DVec3, role| Joint {
            name: name.to_owned(),
            parent: parent.map(JointId),
            offset,
            end_site: None,
            rotation_order: [Axis::Z, Axis::X, Axis::Y],
            role: Some(role),
        };
        let mut joints = vec![joint("hips", None, DVec3::ZERO, JointRole::Pelvis)];
        if with_hips {
            // At rest the body faces +z, its left is +x.
            joints.push(joint("l", Some(0), DVec3::X * 0.1, JointRole::LeftHip));
            joints.push(joint("r", Some(0), DVec3::X * -0.1, JointRole::RightHip));
        }
        Skeleton { joints }
    }

    fn turned(skeleton: &Skeleton, rotation: DQuat) -> Vec<JointFrame> {
        let mut pose = skeleton.rest_pose();
        pose.rotations[0] = rotation;
        skeleton.forward_kinematics(&pose)
    }

    #[test]
    fn at_rest_a_body_faces_plus_z_with_and_without_hips() {
        for with_hips in [true, false] {
            let skeleton = body(with_hips);
            let poses = [0.0, 0.5, 1.0].map(|angle| turned(&skeleton, yaw(angle)));
            let found = headings(&skeleton, &poses);
            for (heading, angle) in found.iter().zip([0.0, 0.5, 1.0]) {
                assert!((heading - (REST_HEADING + angle)).abs() < ROUNDING);
            }
        }
    }

    #[test]
    fn lying_on_a_side_keeps_the_turn_of_the_root() {
        let skeleton = body(true);
        let on_side = DQuat::from_rotation_z(PI / 2.0);
        let poses =
            [yaw(0.4), yaw(0.4) * on_side, yaw(0.7) * on_side, yaw(0.9)].map(|turn| turned(&skeleton, turn));
        assert_eq!(facing(&skeleton, &poses[1]), None);
        let found = headings(&skeleton, &poses);
        assert!((found[1] - (REST_HEADING + 0.4)).abs() < 1e-9);
        assert!((found[3] - (REST_HEADING + 0.9)).abs() < ROUNDING);
    }

    #[test]
    fn headings_go_on_past_half_a_turn() {
        let skeleton = body(true);
        let poses: Vec<_> = (0..20).map(|k| turned(&skeleton, yaw(0.5 * f64::from(k)))).collect();
        let found = headings(&skeleton, &poses);
        assert!((found[19] - found[0] - 9.5).abs() < 1e-9);
    }
}
