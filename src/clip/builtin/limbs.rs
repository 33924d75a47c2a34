//! Legs and arms of generated clips: two-bone inverse kinematics, and arms by their angles.

use glam::{DMat3, DQuat, DVec3};

use super::body::{Body, FOREARM, PELVIS, SHANK, Side, THIGH, UPPER_ARM, arm_joints, leg_joints};
use crate::geometry::slerp;
use crate::skeleton::Pose;

/// Where one foot is, upright but for its pitch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Foot {
    /// World position, metres.
    pub(super) ankle: DVec3,
    /// Turn of the toes about +y, radians.
    pub(super) turn: f64,
    /// Toes below the ankle's level when positive (heel lifted), radians.
    pub(super) pitch: f64,
    /// Turn of the toe joint about its axis, radians.
    pub(super) toe: f64,
}

/// Where a leg is to be, whatever the attitude of body and foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LegTarget {
    /// World position, metres.
    pub(super) ankle: DVec3,
    /// From the foot's axes (toes along +z, sole down) to the world's.
    pub(super) foot: DQuat,
    /// World direction in which the knee points; its part along the leg does not matter. Ahead of the pelvis is a safe one.
    pub(super) knee: DVec3,
    /// Turn of the toe joint about its axis, radians; toes up when negative.
    pub(super) toe: f64,
}

/// Where an arm is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ArmTarget {
    /// World position, metres.
    pub(super) wrist: DVec3,
    /// World direction in which the elbow points; its part along the arm does not matter.
    pub(super) elbow: DVec3,
    /// World direction of the fingers.
    pub(super) fingers: DVec3,
    /// World direction of the palm, made perpendicular to the fingers.
    pub(super) palm: DVec3,
}

impl ArmTarget {
    /// Share `s` of the way to another target; the hand turns steadily.
    pub(super) fn towards(self, to: Self, s: f64) -> Self {
        let attitude = |target: Self| {
            let fingers = target.fingers.normalize();
            axes(fingers, perpendicular(target.palm, fingers))
        };
        let hand = slerp(attitude(self), attitude(to), s);
        Self {
            wrist: self.wrist.lerp(to.wrist, s),
            elbow: self.elbow.normalize().lerp(to.elbow.normalize(), s),
            fingers: hand * DVec3::X,
            palm: hand * DVec3::Y,
        }
    }
}

/// Angles of an arm that is not told where its hand is to be, radians; all zero: it hangs along the trunk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ArmAngles {
    /// Backwards about the shoulder.
    pub(super) swing: f64,
    /// Of the upper arm from the trunk, sideways.
    pub(super) away: f64,
    /// Of the upper arm about itself, so that a bent forearm points inwards.
    pub(super) inwards: f64,
    /// Of the elbow.
    pub(super) bend: f64,
}

impl Foot {
    /// Of a body that looks ahead (+z): the knee points between ahead and where the toes do.
    pub(super) fn target(self) -> LegTarget {
        LegTarget {
            ankle: self.ankle,
            foot: DQuat::from_rotation_y(self.turn) * DQuat::from_rotation_x(self.pitch),
            knee: DQuat::from_rotation_y(self.turn / 2.0) * DVec3::Z,
            toe: self.toe,
        }
    }
}

impl Body {
    /// Ankle of a foot that stood flat at `ankle` and has turned by `pitch` about a point of it, which is given from the ankle,
    /// metres at 1.75 m.
    pub(super) fn pivoted(&self, point: DVec3, ankle: DVec3, [turn, pitch]: [f64; 2]) -> DVec3 {
        let point = point * self.scale;
        ankle + DQuat::from_rotation_y(turn) * (point - DQuat::from_rotation_x(pitch) * point)
    }

    /// As [`Body::place_leg`], for a body that looks ahead (+z).
    pub(super) fn place_foot(&self, pose: &mut Pose, side: Side, foot: Foot) -> f64 {
        self.place_leg(pose, side, foot.target())
    }

    /// Turns hip, knee, ankle and toe joint as `target` says; the knee bends one way only. Returns how far the leg is
    /// stretched, 1 when straight; a target out of reach leaves it straight.
    ///
    /// Two-bone chain by the law of cosines in the plane that holds hip, ankle and the knee's direction.
    pub(super) fn place_leg(&self, pose: &mut Pose, side: Side, target: LegTarget) -> f64 {
        let [hip, knee, ankle, toe] = leg_joints(side);
        let (thigh, shank) = (THIGH * self.scale, SHANK * self.scale);
        let pelvis = pose.rotations[PELVIS];
        let to_ankle = target.ankle - (pose.root + pelvis * self.skeleton.joints[hip].offset);
        let (thigh_direction, shank_direction) = two_bones(to_ankle, [thigh, shank], target.knee);
        let lateral = across(target.knee, to_ankle);
        let thigh_world = axes(lateral, -thigh_direction);
        let shank_world = axes(lateral, -shank_direction);
        pose.rotations[hip] = pelvis.inverse() * thigh_world;
        pose.rotations[knee] = thigh_world.inverse() * shank_world;
        pose.rotations[ankle] = shank_world.inverse() * target.foot;
        pose.rotations[toe] = DQuat::from_rotation_x(target.toe);
        to_ankle.length() / (thigh + shank)
    }

    /// Lets an arm hang: `swing` backwards about the shoulder, `bend` of the elbow forwards, radians.
    pub(super) fn hang_arm(&self, pose: &mut Pose, side: Side, swing: f64, bend: f64) {
        /// Angle of the hanging upper arm from the trunk, radians.
        const AWAY: f64 = 0.13;
        self.bend_arm(pose, side, ArmAngles { swing, away: AWAY, inwards: 0.0, bend });
    }

    /// Turns shoulder, elbow and wrist by angles, against the collar.
    pub(super) fn bend_arm(&self, pose: &mut Pose, side: Side, arm: ArmAngles) {
        let [_, shoulder, elbow, hand] = arm_joints(side);
        let down = DQuat::from_rotation_z(side.sign() * (arm.away - std::f64::consts::FRAC_PI_2));
        // Seen from the shoulder an arm's own axis runs outwards, down where it hangs.
        let inwards = DQuat::from_rotation_x(arm.inwards);
        pose.rotations[shoulder] = DQuat::from_rotation_x(arm.swing) * down * inwards;
        pose.rotations[elbow] = DQuat::from_rotation_y(-side.sign() * arm.bend);
        pose.rotations[hand] = DQuat::from_rotation_z(side.sign() * 0.05);
    }

    /// Where an arm is in a pose: [`Body::reach`] for it leaves the arm there.
    pub(super) fn arm_target(&self, pose: &Pose, side: Side) -> ArmTarget {
        let [_, shoulder, elbow, wrist] = arm_joints(side);
        let frames = self.skeleton.forward_kinematics(pose);
        let at = |joint: usize| frames[joint].position;
        let hand = frames[wrist].rotation;
        ArmTarget {
            wrist: at(wrist),
            elbow: at(elbow) - at(shoulder).midpoint(at(wrist)),
            fingers: hand * (DVec3::X * side.sign()),
            palm: hand * DVec3::NEG_Y,
        }
    }

    /// Brings a hand where `target` says; half the forearm's twist is the elbow joint's. Returns how far the arm is stretched,
    /// 1 when straight; a target out of reach leaves it straight.
    pub(super) fn reach(&self, pose: &mut Pose, side: Side, target: ArmTarget) -> f64 {
        let [collar, shoulder, elbow, wrist] = arm_joints(side);
        let sign = side.sign();
        let frames = self.skeleton.forward_kinematics(pose);
        let bones = [UPPER_ARM * self.scale, FOREARM * self.scale];
        let to_wrist = target.wrist - frames[shoulder].position;
        let (upper, fore) = two_bones(to_wrist, bones, target.elbow);
        let upper_world = axes(upper * sign, across(target.elbow, to_wrist) * -sign);
        let bent = DQuat::from_rotation_y(upper.angle_between(fore) * -sign);
        let fingers = target.fingers.normalize();
        let palm = perpendicular(target.palm, fingers);
        let mut against_forearm = (upper_world * bent).inverse() * axes(fingers * sign, -palm);
        if against_forearm.w < 0.0 {
            against_forearm = -against_forearm;
        }
        let twist = DQuat::from_rotation_x(against_forearm.x.atan2(against_forearm.w));
        pose.rotations[shoulder] = frames[collar].rotation.inverse() * upper_world;
        pose.rotations[elbow] = bent * twist;
        pose.rotations[wrist] = twist.inverse() * against_forearm;
        to_wrist.length() / (bones[0] + bones[1])
    }
}

/// Directions of two bones that span `to_target`, or as much of it as they can, bent towards `hint`.
fn two_bones(to_target: DVec3, bones: [f64; 2], hint: DVec3) -> (DVec3, DVec3) {
    let distance = to_target.length().clamp((bones[0] - bones[1]).abs().max(1e-6), bones[0] + bones[1]);
    let along = to_target.normalize_or(DVec3::NEG_Y);
    let first = first_bone(along, distance, bones, perpendicular(hint, along));
    (first, (along * distance - first * bones[0]).normalize())
}

/// Direction of the first of two bones that span `distance` along `along`, bent towards `sideways`.
fn first_bone(along: DVec3, distance: f64, bones: [f64; 2], sideways: DVec3) -> DVec3 {
    let cosine = (bones[0].powi(2) + distance.powi(2) - bones[1].powi(2)) / (2.0 * bones[0] * distance);
    let cosine = cosine.clamp(-1.0, 1.0);
    along * cosine + sideways * (1.0 - cosine * cosine).sqrt()
}

/// Axis about which two bones along `along` bend towards `hint`.
fn across(hint: DVec3, along: DVec3) -> DVec3 {
    hint.cross(along).try_normalize().unwrap_or_else(|| {
        let along = along.normalize_or(DVec3::NEG_Y);
        perpendicular(hint, along).cross(along)
    })
}

/// Unit vector along the part of `vector` perpendicular to the unit vector `axis`; any where there is none.
fn perpendicular(vector: DVec3, axis: DVec3) -> DVec3 {
    vector.reject_from(axis).try_normalize().unwrap_or_else(|| axis.any_orthonormal_vector())
}

/// The rotation that takes +x to `x` and +y to `y`, two perpendicular unit vectors.
fn axes(x: DVec3, y: DVec3) -> DQuat {
    DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize()
}
