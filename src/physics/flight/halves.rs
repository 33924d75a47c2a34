//! The body in two, cut where the trunk hangs on the pelvis.

use glam::DQuat;

use crate::clip::Clip;
use crate::full_body::chain::is_below;
use crate::index::JointId;
use crate::physics::body_model::BodyModel;
use crate::physics::ground::displacement::replace;
use crate::physics::posed::PosedClip;
use crate::skeleton::{JointRole, Skeleton};

/// Which half of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HalfName {
    /// From the root to the hips, and the legs.
    Lower,
    /// What hangs on the pelvis above it.
    Upper,
}

/// One half of a skeleton, which turns about the joint where the halves meet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Half {
    /// Which.
    pub name: HalfName,
    /// Lowest joint of the upper half: its place is the pivot.
    pub border: JointId,
    /// Whether each joint belongs to this half.
    members: Vec<bool>,
}

impl Half {
    /// A half of `skeleton`; `None` where nothing hangs on the pelvis. Cost: quadratic in joints.
    pub fn of(skeleton: &Skeleton, body: &BodyModel, name: HalfName) -> Option<Self> {
        let joints = || (0..skeleton.joints.len()).map(JointId::from_usize);
        let hips: Vec<JointId> = [JointRole::LeftHip, JointRole::RightHip]
            .into_iter()
            .filter_map(|role| body.foot(skeleton, role))
            .collect();
        let is_pelvis =
            |joint: JointId| joint == JointId(0) || hips.iter().any(|hip| is_below(skeleton, *hip, joint));
        let is_leg = |joint: JointId| hips.iter().any(|hip| *hip == joint || is_below(skeleton, joint, *hip));
        let is_border = |joint: &JointId| {
            let above = skeleton.joints[joint.as_usize()].parent;
            !is_pelvis(*joint) && !is_leg(*joint) && above.is_some_and(is_pelvis)
        };
        let in_upper = |border: JointId, joint: JointId| joint == border || is_below(skeleton, joint, border);
        // Collars and helpers may hang on the pelvis, too: the trunk is the heaviest.
        let mass = |border: JointId| -> f64 {
            body.links.iter().filter(|link| in_upper(border, link.joint)).map(|link| link.mass).sum()
        };
        let border = joints().filter(is_border).max_by(|a, b| mass(*a).total_cmp(&mass(*b)))?;
        if mass(border) <= 0.0 {
            return None;
        }
        let members = joints().map(|joint| in_upper(border, joint) == (name == HalfName::Upper)).collect();
        Some(Self { name, border, members })
    }

    /// Whether `joint` turns with this half.
    pub fn turns(&self, joint: JointId) -> bool {
        self.members[joint.as_usize()]
    }

    /// Turns this half in the frames from `first` on by `turns`, one a frame. The other half stays where it is. `posed`: frames of
    /// `clip`.
    pub fn turn(&self, clip: &mut Clip, posed: &PosedClip, first: usize, turns: &[DQuat]) {
        let own = self.border.as_usize();
        let above = clip.skeleton.joints[own].parent;
        for (frame, turn) in (first..).zip(turns).filter(|(_, turn)| **turn != DQuat::IDENTITY) {
            let world = posed.frame(frame);
            let start = frame * posed.joint_count;
            let above = above.map_or(DQuat::IDENTITY, |above| world[above.as_usize()].rotation);
            let border = world[own];
            if self.name == HalfName::Upper {
                replace(&mut clip.rotations[start + own], above.inverse() * (*turn * border.rotation));
                continue;
            }
            replace(&mut clip.rotations[start + own], (*turn * above).inverse() * border.rotation);
            replace(&mut clip.rotations[start], *turn * world[0].rotation);
            let root = clip.root_positions[frame];
            clip.root_positions[frame] = border.position + *turn * (root - border.position);
        }
    }
}
