//! The body of generated clips: its skeleton, its legs' inverse kinematics, its arms and trunk.
//!
//! Rest pose: arms stretched sideways, +x left, +z ahead, y up. Lengths hold for 1.75 m and scale with the stature.

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};

use crate::index::JointId;
use crate::skeleton::{Axis, Joint, JointRole, Pose, Skeleton};

/// Stature for which the lengths below hold, metres.
const REFERENCE_STATURE: f64 = 1.75;
/// Pelvis of the rest pose above the ground, metres.
pub(super) const PELVIS_HEIGHT: f64 = 0.94;
/// Ankle of a flat foot above the ground, metres.
pub(super) const ANKLE_HEIGHT: f64 = 0.08;
/// Toe joint from the ankle in a flat foot, metres.
pub(super) const TOE_OFFSET: DVec3 = DVec3::new(0.0, -0.06, 0.13);
/// Thigh and shank, metres.
const THIGH: f64 = 0.42;
const SHANK: f64 = 0.40;
/// Upper arm and forearm, metres.
const UPPER_ARM: f64 = 0.28;
const FOREARM: f64 = 0.25;

/// Positions of the joints in [`skeleton`].
pub(super) const PELVIS: usize = 0;
pub(super) const SPINE: usize = 1;
pub(super) const CHEST: usize = 2;
const NECK: usize = 3;
const HEAD: usize = 4;
pub(super) const ARMS: [usize; 2] = [5, 9];
const LEGS: [usize; 2] = [13, 17];

/// Left or right; `sign` is +1 for the left, where +x lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

impl Side {
    pub(super) const BOTH: [Self; 2] = [Self::Left, Self::Right];

    pub(super) const fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Right => 1,
        }
    }

    pub(super) const fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// Where one foot is.
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

/// Attitude of pelvis and thorax, radians: turns about +y, and the list of the pelvis (left side up).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Trunk {
    pub(super) pelvis_turn: f64,
    pub(super) pelvis_list: f64,
    pub(super) chest_turn: f64,
    /// Bend forward, shared by spine and chest.
    pub(super) lean: f64,
}

/// A body of some stature.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) skeleton: Arc<Skeleton>,
    /// Stature over 1.75 m.
    pub(super) scale: f64,
}

impl Body {
    pub(super) fn new(stature: f64) -> Self {
        let scale = stature / REFERENCE_STATURE;
        Self { skeleton: Arc::new(skeleton(scale)), scale }
    }

    /// A pose with this trunk, the rest as in the rest pose; head level, looking ahead.
    pub(super) fn pose(&self, pelvis: DVec3, trunk: Trunk) -> Pose {
        let mut pose = self.skeleton.rest_pose();
        pose.root = pelvis;
        let twist = DQuat::from_rotation_y((trunk.chest_turn - trunk.pelvis_turn) / 2.0);
        let straighten = DQuat::from_rotation_z(-trunk.pelvis_list / 2.0);
        let bend = DQuat::from_rotation_x(trunk.lean / 2.0);
        let look =
            DQuat::from_rotation_x(-trunk.lean / 2.0) * DQuat::from_rotation_y(-trunk.chest_turn / 2.0);
        pose.rotations[PELVIS] =
            DQuat::from_rotation_y(trunk.pelvis_turn) * DQuat::from_rotation_z(trunk.pelvis_list);
        pose.rotations[SPINE] = straighten * twist * bend;
        pose.rotations[CHEST] = straighten * twist * bend;
        pose.rotations[NECK] = look;
        pose.rotations[HEAD] = look;
        pose
    }

    /// Turns hip, knee, ankle and toe joint so that the ankle is where `foot` has it; the knee bends forward only.
    /// Returns how far the leg is stretched, 1 when straight; a target out of reach leaves it straight.
    ///
    /// Two-bone chain by the law of cosines in the plane that holds hip, ankle and the foot's direction.
    pub(super) fn place_foot(&self, pose: &mut Pose, side: Side, foot: Foot) -> f64 {
        let [hip, knee, ankle, toe] = [0, 1, 2, 3].map(|k| LEGS[side.index()] + k);
        let (thigh, shank) = (THIGH * self.scale, SHANK * self.scale);
        let pelvis = pose.rotations[PELVIS];
        let to_ankle = foot.ankle - (pose.root + pelvis * self.skeleton.joints[hip].offset);
        let distance = to_ankle.length().min(thigh + shank);
        let ahead = DQuat::from_rotation_y(foot.turn / 2.0) * DVec3::Z;
        let thigh_direction = first_bone(to_ankle, distance, [thigh, shank], ahead);
        let shank_direction = (to_ankle.normalize() * distance - thigh_direction * thigh).normalize();
        let lateral = ahead.cross(to_ankle).normalize();
        let thigh_world = axes(lateral, -thigh_direction);
        let shank_world = axes(lateral, -shank_direction);
        let foot_world = DQuat::from_rotation_y(foot.turn) * DQuat::from_rotation_x(foot.pitch);
        pose.rotations[hip] = pelvis.inverse() * thigh_world;
        pose.rotations[knee] = thigh_world.inverse() * shank_world;
        pose.rotations[ankle] = shank_world.inverse() * foot_world;
        pose.rotations[toe] = DQuat::from_rotation_x(foot.toe);
        to_ankle.length() / (thigh + shank)
    }

    /// Lets an arm hang: `swing` backwards about the shoulder, `bend` of the elbow forwards, radians.
    pub(super) fn hang_arm(&self, pose: &mut Pose, side: Side, swing: f64, bend: f64) {
        /// Angle of the hanging upper arm from the vertical, radians.
        const AWAY: f64 = 0.13;
        let [_, shoulder, elbow, hand] = arm_joints(side);
        let down = DQuat::from_rotation_z(side.sign() * (AWAY - std::f64::consts::FRAC_PI_2));
        pose.rotations[shoulder] = DQuat::from_rotation_x(swing) * down;
        pose.rotations[elbow] = DQuat::from_rotation_y(-side.sign() * bend);
        pose.rotations[hand] = DQuat::from_rotation_z(side.sign() * 0.05);
    }

    /// Brings the right wrist to `wrist` in the world, the elbow towards `elbow_hint`, fingers along `fingers` and the palm
    /// along `palm` (made perpendicular); half the forearm's twist is the elbow joint's.
    pub(super) fn reach_right(&self, pose: &mut Pose, wrist: DVec3, elbow_hint: DVec3, hand: [DVec3; 2]) {
        let [collar, shoulder, elbow, wrist_joint] = arm_joints(Side::Right);
        let frames = self.skeleton.forward_kinematics(pose);
        let (upper, fore) = (UPPER_ARM * self.scale, FOREARM * self.scale);
        let to_wrist = wrist - frames[shoulder].position;
        let distance = to_wrist.length().min(upper + fore);
        let upper_direction = first_bone(to_wrist, distance, [upper, fore], elbow_hint);
        let fore_direction = (to_wrist.normalize() * distance - upper_direction * upper).normalize();
        let bend = upper_direction.angle_between(fore_direction);
        let upper_world = axes(-upper_direction, upper_direction.cross(fore_direction).normalize());
        let bent = DQuat::from_rotation_y(bend);
        let fingers = hand[0].normalize();
        let hand_world = axes(-fingers, -hand[1].reject_from(fingers).normalize());
        let against_forearm = (upper_world * bent).inverse() * hand_world;
        let twist = DQuat::from_rotation_x(against_forearm.x.atan2(against_forearm.w));
        pose.rotations[shoulder] = frames[collar].rotation.inverse() * upper_world;
        pose.rotations[elbow] = bent * twist;
        pose.rotations[wrist_joint] = twist.inverse() * against_forearm;
    }
}

/// Collar, shoulder, elbow and wrist joints of one side.
pub(super) fn arm_joints(side: Side) -> [usize; 4] {
    [0, 1, 2, 3].map(|k| ARMS[side.index()] + k)
}

/// Direction of the first of two bones that span `distance` along `to_target`, bent towards `hint`.
fn first_bone(to_target: DVec3, distance: f64, bones: [f64; 2], hint: DVec3) -> DVec3 {
    let along = to_target.normalize();
    let sideways = hint.reject_from(along).normalize();
    let cosine = (bones[0].powi(2) + distance.powi(2) - bones[1].powi(2)) / (2.0 * bones[0] * distance);
    let cosine = cosine.clamp(-1.0, 1.0);
    along * cosine + sideways * (1.0 - cosine * cosine).sqrt()
}

/// The rotation that takes +x to `x` and +y to `y`, two perpendicular unit vectors.
fn axes(x: DVec3, y: DVec3) -> DQuat {
    DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize()
}

/// Name, parent's position, offset in metres at 1.75 m, end site, role.
type Row = (&'static str, Option<usize>, [f64; 3], Option<[f64; 3]>, JointRole);

fn skeleton(scale: f64) -> Skeleton {
    let trunk: [Row; 5] = [
        ("Hips", None, [0.0, PELVIS_HEIGHT, 0.0], None, JointRole::Pelvis),
        ("Spine", Some(PELVIS), [0.0, 0.09, -0.01], None, JointRole::Spine),
        ("Spine1", Some(SPINE), [0.0, 0.15, -0.005], None, JointRole::Chest),
        ("Neck", Some(CHEST), [0.0, 0.30, 0.0], None, JointRole::Neck),
        ("Head", Some(NECK), [0.0, 0.09, 0.015], Some([0.0, 0.18, 0.0]), JointRole::Head),
    ];
    let rows = trunk
        .into_iter()
        .chain(arm(Side::Left))
        .chain(arm(Side::Right))
        .chain(leg(Side::Left))
        .chain(leg(Side::Right));
    Skeleton { joints: rows.map(|row| joint(row, scale)).collect() }
}

fn joint((name, parent, offset, end_site, role): Row, scale: f64) -> Joint {
    Joint {
        name: name.to_owned(),
        parent: parent.map(JointId::from_usize),
        offset: DVec3::from_array(offset) * scale,
        end_site: end_site.map(|end| DVec3::from_array(end) * scale),
        rotation_order: [Axis::Z, Axis::X, Axis::Y],
        role: Some(role),
    }
}

fn arm(side: Side) -> [Row; 4] {
    use JointRole as R;
    let (names, roles) = match side {
        Side::Left => (
            ["LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"],
            [R::LeftClavicle, R::LeftShoulder, R::LeftElbow, R::LeftHand],
        ),
        Side::Right => (
            ["RightShoulder", "RightArm", "RightForeArm", "RightHand"],
            [R::RightClavicle, R::RightShoulder, R::RightElbow, R::RightHand],
        ),
    };
    let [collar, shoulder, elbow, _] = arm_joints(side);
    let sign = side.sign();
    [
        (names[0], Some(CHEST), [sign * 0.03, 0.24, 0.01], None, roles[0]),
        (names[1], Some(collar), [sign * 0.15, 0.0, -0.01], None, roles[1]),
        (names[2], Some(shoulder), [sign * UPPER_ARM, 0.0, 0.0], None, roles[2]),
        (names[3], Some(elbow), [sign * FOREARM, 0.0, 0.0], Some([sign * 0.17, 0.0, 0.0]), roles[3]),
    ]
}

fn leg(side: Side) -> [Row; 4] {
    use JointRole as R;
    let (names, roles) = match side {
        Side::Left => (
            ["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"],
            [R::LeftHip, R::LeftKnee, R::LeftFoot, R::LeftToe],
        ),
        Side::Right => (
            ["RightUpLeg", "RightLeg", "RightFoot", "RightToeBase"],
            [R::RightHip, R::RightKnee, R::RightFoot, R::RightToe],
        ),
    };
    let hip = LEGS[side.index()];
    [
        (names[0], Some(PELVIS), [side.sign() * 0.09, -0.04, 0.0], None, roles[0]),
        (names[1], Some(hip), [0.0, -THIGH, 0.0], None, roles[1]),
        (names[2], Some(hip + 1), [0.0, -SHANK, 0.0], None, roles[2]),
        (names[3], Some(hip + 2), TOE_OFFSET.to_array(), Some([0.0, 0.0, 0.07]), roles[3]),
    ]
}
