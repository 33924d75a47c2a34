//! Arms between hanging and reaching, so that hands find what they take without a jump.

use glam::{DQuat, DVec3};

use super::body::{Body, FOREARM, Side, UPPER_ARM, arm_joints};
use super::limbs::{ArmAngles, ArmTarget};
use crate::geometry::slerp;
use crate::skeleton::Pose;

/// Angle of a hanging upper arm from the vertical, radians, as [`Body::hang_arm`] has it.
pub(super) const AWAY: f64 = 0.13;
/// Middle of the palm from the wrist along the fingers, metres: half way to their tips.
const PALM: f64 = 0.085;

/// What a hand reaches for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Middle of the palm in the world, metres; the palm faces the other hand.
    pub(super) palm: DVec3,
    /// Fingers below the horizon, radians.
    pub(super) fingers: f64,
    /// 0: the arm is as its angles say; 1: the palm is where it should be.
    pub(super) weight: f64,
}

/// Poses an arm by its angles, reaching, or between the two. The trunk is posed before.
pub(super) fn place(body: &Body, pose: &mut Pose, side: Side, (angles, reach): (ArmAngles, Option<Reach>)) {
    body.bend_arm(pose, side, angles);
    let Some(reach) = reach.filter(|reach| reach.weight > 0.0) else {
        return;
    };
    let [_, shoulder, elbow, wrist] = arm_joints(side);
    let hanging = [shoulder, elbow, wrist].map(|joint| pose.rotations[joint]);
    body.reach(pose, side, target(body, pose, side, reach));
    let reaching = [shoulder, elbow, wrist].map(|joint| pose.rotations[joint]);
    let between = |k: usize| slerp(hanging[k], reaching[k], reach.weight);
    pose.rotations[shoulder] = between(0);
    pose.rotations[elbow] = between_elbows([hanging[1], reaching[1]], reach.weight);
    pose.rotations[wrist] = between(2);
}

/// Middle of a palm from its wrist, metres, with the fingers below the horizon by `fingers` radians.
pub(super) fn palm_from_wrist(body: &Body, fingers: f64) -> DVec3 {
    DVec3::new(0.0, -fingers.sin(), fingers.cos()) * (PALM * body.scale)
}

fn target(body: &Body, pose: &Pose, side: Side, reach: Reach) -> ArmTarget {
    let shoulder = body.skeleton.forward_kinematics(pose)[arm_joints(side)[1]].position;
    let from_wrist = palm_from_wrist(body, reach.fingers);
    let to_wrist = reach.palm - from_wrist - shoulder;
    let distance = to_wrist.length();
    let spanned = soft_reach(distance, (UPPER_ARM + FOREARM) * body.scale);
    ArmTarget {
        wrist: shoulder + to_wrist * (spanned / distance),
        // Outwards, down and back: never along an arm that works in front of the body.
        elbow: DVec3::new(side.sign() * 0.6, -0.4, -1.0),
        fingers: from_wrist,
        palm: DVec3::NEG_X * side.sign(),
    }
}

/// Distance that an arm of `length` spans for a target at `distance`: the same below that share of the arm, then less and less more, so
/// that an arm on its way to a target that is still too far does not snap straight.
fn soft_reach(distance: f64, length: f64) -> f64 {
    const EXACT: f64 = 0.94;
    const SLACK: f64 = 0.05;
    let share = distance / length;
    if share <= EXACT {
        return distance;
    }
    length * (EXACT + SLACK * (1.0 - ((EXACT - share) / SLACK).exp()))
}

/// Share of the way between two elbows, in bend and in twist: what lies between the rotations would bend sideways.
fn between_elbows(elbows: [DQuat; 2], share: f64) -> DQuat {
    let [from, to] = elbows.map(bend_and_twist);
    let mixed = [0, 1].map(|k| from[k] + share * (to[k] - from[k]));
    DQuat::from_rotation_y(mixed[0]) * DQuat::from_rotation_x(mixed[1])
}

/// Angles of a turn about +y after one about +x, each less than a half turn.
fn bend_and_twist(elbow: DQuat) -> [f64; 2] {
    let bone = elbow * DVec3::X;
    let bend = (-bone.z).atan2(bone.x);
    let twist = DQuat::from_rotation_y(-bend) * elbow;
    [bend, 2.0 * twist.x.atan2(twist.w)]
}
