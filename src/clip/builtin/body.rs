//! The body of generated clips: its skeleton and its trunk. Its limbs are in `limbs`, its masses in `mass`.
//!
//! Rest pose: arms stretched sideways, +x left, +z ahead, y up. Lengths hold for 1.75 m and scale with the stature.

use std::sync::Arc;

use glam::{DQuat, DVec3};

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
/// Lowest point of the heel from the ankle in a flat foot, metres.
pub(super) const HEEL_OFFSET: DVec3 = DVec3::new(0.0, -ANKLE_HEIGHT, -0.05);
/// Thigh and shank, metres.
pub(super) const THIGH: f64 = 0.42;
pub(super) const SHANK: f64 = 0.40;
/// Upper arm and forearm, metres.
pub(super) const UPPER_ARM: f64 = 0.28;
pub(super) const FOREARM: f64 = 0.25;

/// Positions of the joints in [`skeleton`].
pub(super) const PELVIS: usize = 0;
pub(super) const SPINE: usize = 1;
pub(super) const CHEST: usize = 2;
pub(super) const NECK: usize = 3;
pub(super) const HEAD: usize = 4;
pub(super) const ARMS: [usize; 2] = [5, 9];
pub(super) const LEGS: [usize; 2] = [13, 17];

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

/// Attitude of pelvis and thorax, radians. The pelvis turns about +y, then lists, then tilts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Trunk {
    pub(super) pelvis_turn: f64,
    /// Left side up.
    pub(super) pelvis_list: f64,
    /// Top forward.
    pub(super) pelvis_tilt: f64,
    /// Of the thorax about +y, as the pelvis' is.
    pub(super) chest_turn: f64,
    /// Of the thorax, left side up; the spine undoes the rest of the pelvis' list.
    pub(super) chest_list: f64,
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

    /// A pose with this trunk, the rest as in the rest pose; head level, looking ahead, or down where the neck bends no farther.
    pub(super) fn pose(&self, pelvis: DVec3, trunk: Trunk) -> Pose {
        /// Neck and head against the trunk, radians: short of the neck's limit.
        const FARTHEST_BACK: f64 = 0.9;
        let mut pose = self.skeleton.rest_pose();
        pose.root = pelvis;
        let twist = DQuat::from_rotation_y((trunk.chest_turn - trunk.pelvis_turn) / 2.0);
        let straighten = DQuat::from_rotation_z((trunk.chest_list - trunk.pelvis_list) / 2.0);
        let bend = DQuat::from_rotation_x(trunk.lean / 2.0);
        let look = DQuat::from_rotation_x(-(trunk.lean + trunk.pelvis_tilt).min(FARTHEST_BACK) / 2.0)
            * DQuat::from_rotation_y(-trunk.chest_turn / 2.0)
            * DQuat::from_rotation_z(-trunk.chest_list / 2.0);
        pose.rotations[PELVIS] = DQuat::from_rotation_y(trunk.pelvis_turn)
            * DQuat::from_rotation_z(trunk.pelvis_list)
            * DQuat::from_rotation_x(trunk.pelvis_tilt);
        pose.rotations[SPINE] = straighten * twist * bend;
        pose.rotations[CHEST] = straighten * twist * bend;
        pose.rotations[NECK] = look;
        pose.rotations[HEAD] = look;
        pose
    }
}

/// Collar, shoulder, elbow and wrist joints of one side.
pub(super) fn arm_joints(side: Side) -> [usize; 4] {
    [0, 1, 2, 3].map(|k| ARMS[side.index()] + k)
}

/// Hip, knee, ankle and toe joints of one side.
pub(super) fn leg_joints(side: Side) -> [usize; 4] {
    [0, 1, 2, 3].map(|k| LEGS[side.index()] + k)
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
