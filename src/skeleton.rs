//! A body: joints in a tree, what each is for, and where they are in a pose.

use std::fmt;

use glam::{DQuat, DVec3};

use crate::geometry::c64;
use crate::index::JointId;

/// What a joint is for, whatever its file calls it.
///
/// Limb joints are named by the segment end they turn: `LeftHip` turns the thigh, `LeftKnee` the shank, `LeftFoot` the
/// foot (it is the ankle), `LeftToe` the toes; `LeftShoulder` the upper arm, `LeftElbow` the forearm, `LeftHand` the hand
/// (it is the wrist); `LeftClavicle` is the collar before the upper arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[expect(missing_docs, reason = "the names say it, the type's docs say the rule")]
pub enum JointRole {
    Pelvis,
    Spine,
    Chest,
    Neck,
    Head,
    LeftClavicle,
    LeftShoulder,
    LeftElbow,
    LeftHand,
    RightClavicle,
    RightShoulder,
    RightElbow,
    RightHand,
    LeftHip,
    LeftKnee,
    LeftFoot,
    LeftToe,
    RightHip,
    RightKnee,
    RightFoot,
    RightToe,
}

impl JointRole {
    /// All roles, from the pelvis up and out, then down the legs.
    pub const ALL: [Self; 21] = [
        Self::Pelvis,
        Self::Spine,
        Self::Chest,
        Self::Neck,
        Self::Head,
        Self::LeftClavicle,
        Self::LeftShoulder,
        Self::LeftElbow,
        Self::LeftHand,
        Self::RightClavicle,
        Self::RightShoulder,
        Self::RightElbow,
        Self::RightHand,
        Self::LeftHip,
        Self::LeftKnee,
        Self::LeftFoot,
        Self::LeftToe,
        Self::RightHip,
        Self::RightKnee,
        Self::RightFoot,
        Self::RightToe,
    ];

    /// The name that people write, as in `left_hand`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pelvis => "pelvis",
            Self::Spine => "spine",
            Self::Chest => "chest",
            Self::Neck => "neck",
            Self::Head => "head",
            Self::LeftClavicle => "left_clavicle",
            Self::LeftShoulder => "left_shoulder",
            Self::LeftElbow => "left_elbow",
            Self::LeftHand => "left_hand",
            Self::RightClavicle => "right_clavicle",
            Self::RightShoulder => "right_shoulder",
            Self::RightElbow => "right_elbow",
            Self::RightHand => "right_hand",
            Self::LeftHip => "left_hip",
            Self::LeftKnee => "left_knee",
            Self::LeftFoot => "left_foot",
            Self::LeftToe => "left_toe",
            Self::RightHip => "right_hip",
            Self::RightKnee => "right_knee",
            Self::RightFoot => "right_foot",
            Self::RightToe => "right_toe",
        }
    }

    /// The role that people write as `name`.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.name() == name)
    }
}

impl fmt::Display for JointRole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Axis of a rotation channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the three axes")]
pub enum Axis {
    X,
    Y,
    Z,
}

/// One joint of a skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name in the file, whole.
    pub name: String,
    /// `None` for the root only.
    pub parent: Option<JointId>,
    /// From the parent joint in the parent's axes at rest, metres. The root's is where the file has it; poses replace it.
    pub offset: DVec3,
    /// End of the last segment from this joint, in its own axes, metres, where the file gives one.
    pub end_site: Option<DVec3>,
    /// Order of the rotation channels in the file: the rotation is the product of the three in this order.
    pub rotation_order: [Axis; 3],
    /// What the joint is for; at most one joint per role. Helper joints have none.
    pub role: Option<JointRole>,
}

/// Joints of a body; parents before children, the root at 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    /// At least one.
    pub joints: Vec<Joint>,
}

/// Places of all joints at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// World position of the root, metres.
    pub root: DVec3,
    /// Rotation of each joint against its parent (the root's against the world).
    pub rotations: Vec<DQuat>,
    /// Offsets that differ from the skeleton's, for files that move joints against their parents; mostly empty.
    pub offsets: Vec<(JointId, DVec3)>,
}

/// World position and rotation of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFrame {
    /// Metres.
    pub position: DVec3,
    /// From joint axes to world axes.
    pub rotation: DQuat,
}

impl Skeleton {
    /// The joint that has `role`.
    pub fn joint_of(&self, role: JointRole) -> Option<JointId> {
        self.joints.iter().position(|joint| joint.role == Some(role)).map(JointId::from_usize)
    }

    /// The joint called `name` in the file (the first, where names repeat).
    pub fn joint_named(&self, name: &str) -> Option<JointId> {
        self.joints.iter().position(|joint| joint.name == name).map(JointId::from_usize)
    }

    /// The pose in which every rotation is none and the root stands where its offset says.
    pub fn rest_pose(&self) -> Pose {
        Pose {
            root: self.joints[0].offset,
            rotations: vec![DQuat::IDENTITY; self.joints.len()],
            offsets: Vec::new(),
        }
    }

    /// World frames of all joints in `pose`, parents first. Cost: linear in joints.
    pub fn forward_kinematics(&self, pose: &Pose) -> Vec<JointFrame> {
        let mut frames: Vec<JointFrame> = Vec::with_capacity(self.joints.len());
        for (index, joint) in self.joints.iter().enumerate() {
            let above = joint.parent.map(|parent| frames[parent.as_usize()]);
            frames.push(self.frame_below(above, pose, JointId::from_usize(index)));
        }
        frames
    }

    /// World frame of one joint. Cost: by the joints from the root to it.
    pub fn joint_frame(&self, pose: &Pose, joint: JointId) -> JointFrame {
        let parent = |below: &JointId| self.joints[below.as_usize()].parent;
        let chain: Vec<JointId> = std::iter::successors(Some(joint), parent).collect();
        let from_root = chain.iter().rev();
        let frame = from_root.fold(None, |above, joint| Some(self.frame_below(above, pose, *joint)));
        frame.expect("a chain ends at its joint")
    }

    /// World frame of a joint below another frame, or of the root.
    fn frame_below(&self, above: Option<JointFrame>, pose: &Pose, joint: JointId) -> JointFrame {
        let index = joint.as_usize();
        let Some(above) = above else {
            return JointFrame { position: pose.root, rotation: pose.rotations[0] };
        };
        let offset = pose.offset_of(joint).unwrap_or(self.joints[index].offset);
        JointFrame {
            position: above.position + above.rotation * offset,
            rotation: above.rotation * pose.rotations[index],
        }
    }

    /// Same names, parents and offsets (1e-6 m): clips of such skeletons go on one track as they are.
    pub fn matches(&self, other: &Self) -> bool {
        self.joints.len() == other.joints.len()
            && self
                .joints
                .iter()
                .zip(&other.joints)
                .skip(1)
                .all(|(a, b)| a.name == b.name && a.parent == b.parent && a.offset.distance(b.offset) < 1e-6)
    }
}

impl Pose {
    /// Offset of `joint` where this pose has its own.
    pub fn offset_of(&self, joint: JointId) -> Option<DVec3> {
        self.offsets.iter().find(|(moved, _)| *moved == joint).map(|(_, offset)| *offset)
    }
}

/// Ground heading of a body from its two hip joints: `−i·(hip_left − hip_right)` in the plan. Its length is the width
/// of the hips seen from above; short where the body lies on its side.
pub fn facing_vector(hip_left: c64, hip_right: c64) -> c64 {
    c64::new(0.0, -1.0) * (hip_left - hip_right)
}
