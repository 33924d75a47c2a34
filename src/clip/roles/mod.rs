//! What each joint of a skeleton is for, from its name and its place in the tree.
//!
//! Names differ between packages, and two words mean different joints: a *shoulder* is the upper arm where no other joint
//! is, else the collar before it; a *hip* of one side is the thigh where no other joint is, else a helper; a *leg* is the
//! shank below a thigh, else the thigh. The tree decides, and a knee counts only below its own hip.

mod names;

pub use names::is_helper;
use names::{Part, Side, read_name};

use crate::index::JointId;
use crate::skeleton::{Joint, JointRole, Skeleton};

/// Roles every whole body has, whatever the flavour of its file.
pub const EXPECTED_ROLES: [JointRole; 11] = [
    JointRole::Pelvis,
    JointRole::LeftHip,
    JointRole::LeftKnee,
    JointRole::LeftFoot,
    JointRole::RightHip,
    JointRole::RightKnee,
    JointRole::RightFoot,
    JointRole::LeftShoulder,
    JointRole::LeftElbow,
    JointRole::RightShoulder,
    JointRole::RightElbow,
];

/// Sets the role of every joint, at most one joint for each role. `joints`: parents before children. Cost: linear.
pub fn assign_roles(joints: &mut [Joint]) {
    let named: Vec<Option<(Option<Side>, Part)>> =
        joints.iter().map(|joint| read_name(&joint.name)).collect();
    for joint in joints.iter_mut() {
        joint.role = None;
    }
    let tree = NamedTree {
        parents: joints.iter().map(|joint| joint.parent.map(JointId::as_usize)).collect(),
        named,
    };
    let mut found: Vec<(JointRole, usize)> = Vec::new();
    for side in [Side::Left, Side::Right] {
        found.extend(tree.leg(side));
        found.extend(tree.arm(side));
    }
    found.extend(tree.trunk(&found));
    for (role, joint) in found {
        joints[joint].role = Some(role);
    }
}

/// Roles of [`EXPECTED_ROLES`] that `skeleton` lacks.
pub fn missing_roles(skeleton: &Skeleton) -> Vec<JointRole> {
    EXPECTED_ROLES.into_iter().filter(|&role| skeleton.joint_of(role).is_none()).collect()
}

struct NamedTree {
    parents: Vec<Option<usize>>,
    named: Vec<Option<(Option<Side>, Part)>>,
}

impl NamedTree {
    /// First joint of `side` that means one of `parts`, earlier parts preferred, below `above` where given.
    fn first(&self, side: Option<Side>, parts: &[Part], above: Option<usize>) -> Option<usize> {
        let below = above.map(|joint| self.descendants(joint));
        parts.iter().find_map(|&part| {
            (0..self.named.len()).find(|&joint| {
                let is_below = below.as_ref().is_none_or(|below| below[joint]);
                is_below && self.named[joint] == Some((side, part))
            })
        })
    }

    /// Which joints lie below `joint`, itself left out.
    fn descendants(&self, joint: usize) -> Vec<bool> {
        let mut below: Vec<bool> = Vec::with_capacity(self.parents.len());
        for parent in &self.parents {
            below.push(parent.is_some_and(|parent| parent == joint || below[parent]));
        }
        below
    }

    fn leg(&self, side: Side) -> Vec<(JointRole, usize)> {
        let roles = match side {
            Side::Left => [JointRole::LeftHip, JointRole::LeftKnee, JointRole::LeftFoot, JointRole::LeftToe],
            Side::Right => {
                [JointRole::RightHip, JointRole::RightKnee, JointRole::RightFoot, JointRole::RightToe]
            }
        };
        let side = Some(side);
        let hip = self.first(side, &[Part::Thigh, Part::Hip, Part::Leg], None);
        let knee = self.first(side, &[Part::Shank, Part::Leg], hip);
        let foot = self.first(side, &[Part::Foot], knee.or(hip));
        let toe = foot.and_then(|foot| self.first(side, &[Part::Toe], Some(foot)));
        pairs(roles, [hip, knee, foot, toe])
    }

    fn arm(&self, side: Side) -> Vec<(JointRole, usize)> {
        let roles = match side {
            Side::Left => {
                [JointRole::LeftClavicle, JointRole::LeftShoulder, JointRole::LeftElbow, JointRole::LeftHand]
            }
            Side::Right => [
                JointRole::RightClavicle,
                JointRole::RightShoulder,
                JointRole::RightElbow,
                JointRole::RightHand,
            ],
        };
        let side = Some(side);
        let upper = self.first(side, &[Part::UpperArm, Part::Shoulder], None);
        let elbow = self.first(side, &[Part::Forearm], upper);
        let hand = self.first(side, &[Part::Hand], elbow.or(upper));
        let is_above_upper = |&collar: &usize| upper.is_some_and(|upper| self.descendants(collar)[upper]);
        let collar = self.first(side, &[Part::Collar, Part::Shoulder], None).filter(is_above_upper);
        pairs(roles, [collar, upper, elbow, hand])
    }

    fn trunk(&self, limbs: &[(JointRole, usize)]) -> Vec<(JointRole, usize)> {
        let limb = |role| limbs.iter().find(|(found, _)| *found == role).map(|(_, joint)| *joint);
        let common = |a, b| Some(self.common_ancestor(limb(a)?, limb(b)?));
        let pelvis = common(JointRole::LeftHip, JointRole::RightHip)
            .or_else(|| self.first(None, &[Part::Pelvis, Part::Hip], None))
            .unwrap_or(0);
        let chest = common(JointRole::LeftShoulder, JointRole::RightShoulder)
            .filter(|&chest| self.descendants(pelvis)[chest])
            .or_else(|| self.first(None, &[Part::Chest], Some(pelvis)));
        let spine = match chest {
            Some(chest) => self.child_towards(pelvis, chest).filter(|&spine| spine != chest),
            None => self.first(None, &[Part::Trunk], None),
        };
        let neck = self.first(None, &[Part::Neck], None);
        let head = self.first(None, &[Part::Head], None);
        let roles = [JointRole::Pelvis, JointRole::Chest, JointRole::Spine, JointRole::Neck, JointRole::Head];
        let mut taken: Vec<usize> = limbs.iter().map(|(_, joint)| *joint).collect();
        let mut found = pairs(roles, [Some(pelvis), chest, spine, neck, head]);
        found.retain(|(_, joint)| {
            let is_new = !taken.contains(joint);
            taken.push(*joint);
            is_new
        });
        found
    }

    fn common_ancestor(&self, a: usize, b: usize) -> usize {
        let above_a: Vec<usize> = self.ancestors(a).collect();
        let mut marked = vec![false; self.parents.len()];
        for joint in above_a {
            marked[joint] = true;
        }
        self.ancestors(b).find(|&joint| marked[joint]).unwrap_or(0)
    }

    fn ancestors(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(self.parents[joint], |&above| self.parents[above])
    }

    /// Child of `above` on the way down to `below`.
    fn child_towards(&self, above: usize, below: usize) -> Option<usize> {
        std::iter::once(below).chain(self.ancestors(below)).find(|&joint| self.parents[joint] == Some(above))
    }
}

fn pairs<const N: usize>(roles: [JointRole; N], joints: [Option<usize>; N]) -> Vec<(JointRole, usize)> {
    roles.into_iter().zip(joints).filter_map(|(role, joint)| Some((role, joint?))).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::skeleton::Axis;

    /// Roles of a chain given as `name parent` lines, parent by name.
    fn roles_of(lines: &[(&str, &str)]) -> Vec<(String, JointRole)> {
        let mut joints: Vec<Joint> = Vec::new();
        for (name, parent) in lines {
            let parent = joints.iter().position(|joint| joint.name == *parent).map(JointId::from_usize);
            joints.push(Joint {
                name: (*name).to_owned(),
                parent,
                offset: DVec3::Y,
                end_site: None,
                rotation_order: [Axis::Z, Axis::X, Axis::Y],
                role: None,
            });
        }
        assign_roles(&mut joints);
        joints.into_iter().filter_map(|joint| Some((joint.name, joint.role?))).collect()
    }

    fn role(lines: &[(&str, &str)], name: &str) -> Option<JointRole> {
        roles_of(lines).into_iter().find(|(found, _)| found == name).map(|(_, role)| role)
    }

    #[test]
    fn a_shoulder_is_the_upper_arm_only_where_no_other_joint_is() {
        let with_collar = [
            ("Hips", ""),
            ("LeftCollar", "Hips"),
            ("LeftShoulder", "LeftCollar"),
            ("LeftElbow", "LeftShoulder"),
        ];
        assert_eq!(role(&with_collar, "LeftShoulder"), Some(JointRole::LeftShoulder));
        assert_eq!(role(&with_collar, "LeftCollar"), Some(JointRole::LeftClavicle));
        let with_arm = [
            ("Hips", ""),
            ("LeftShoulder1", "Hips"),
            ("LeftArm", "LeftShoulder1"),
            ("LeftForeArm", "LeftArm"),
        ];
        assert_eq!(role(&with_arm, "LeftShoulder1"), Some(JointRole::LeftClavicle));
        assert_eq!(role(&with_arm, "LeftArm"), Some(JointRole::LeftShoulder));
    }

    #[test]
    fn a_buttock_and_a_hip_joint_are_not_the_thigh() {
        let daz = [
            ("hip", ""),
            ("lButtock", "hip"),
            ("lThigh", "lButtock"),
            ("lShin", "lThigh"),
            ("lFoot", "lShin"),
        ];
        assert_eq!(role(&daz, "lButtock"), None);
        assert_eq!(role(&daz, "lThigh"), Some(JointRole::LeftHip));
        assert_eq!(role(&daz, "hip"), Some(JointRole::Pelvis));
        let cmu = [("Hips", ""), ("LHipJoint", "Hips"), ("LeftHip", "LHipJoint"), ("LeftKnee", "LeftHip")];
        assert_eq!(role(&cmu, "LHipJoint"), None);
        assert_eq!(role(&cmu, "LeftHip"), Some(JointRole::LeftHip));
        assert_eq!(role(&cmu, "LeftKnee"), Some(JointRole::LeftKnee));
    }

    #[test]
    fn prefixes_case_and_helpers_do_not_matter() {
        let body = [
            ("Character1_Hips", ""),
            ("L_Femur_RIGMESH", "Character1_Hips"),
            ("HEad", "Character1_Hips"),
            ("mixamorig:LeftUpLeg", "Character1_Hips"),
            ("lowerback", "Character1_Hips"),
        ];
        assert_eq!(role(&body, "Character1_Hips"), Some(JointRole::Pelvis));
        assert_eq!(role(&body, "L_Femur_RIGMESH"), None);
        assert_eq!(role(&body, "HEad"), Some(JointRole::Head));
        assert_eq!(role(&body, "mixamorig:LeftUpLeg"), Some(JointRole::LeftHip));
        assert_eq!(role(&body, "lowerback"), Some(JointRole::Spine));
    }

    #[test]
    fn of_two_hand_joints_the_wrist_turns_the_hand() {
        let arm = [
            ("Hips", ""),
            ("lhumerus", "Hips"),
            ("lradius", "lhumerus"),
            ("lwrist", "lradius"),
            ("lhand", "lwrist"),
        ];
        assert_eq!(role(&arm, "lwrist"), Some(JointRole::LeftHand));
        assert_eq!(role(&arm, "lhand"), None);
        assert_eq!(role(&arm, "lradius"), Some(JointRole::LeftElbow));
    }
}
