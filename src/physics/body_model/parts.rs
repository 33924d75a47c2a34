//! Which joints bear which segments: by role, and by the tree at rest where names tell nothing.

use glam::DVec3;

use crate::clip::roles::is_helper;
use crate::index::JointId;
use crate::skeleton::{JointRole, Skeleton};

/// Joint of each role, as names or the tree tell.
#[derive(Clone, Debug)]
pub(super) struct Parts<'a> {
    pub(super) skeleton: &'a Skeleton,
    /// World places of the joints in the rest pose; joint axes are the world's there.
    pub(super) rest: Vec<DVec3>,
    roles: Vec<(JointRole, JointId)>,
}

/// Hip, knee, foot, toe; upper arm, elbow, hand.
pub(super) const LEGS: [[JointRole; 4]; 2] = [
    [JointRole::LeftHip, JointRole::LeftKnee, JointRole::LeftFoot, JointRole::LeftToe],
    [JointRole::RightHip, JointRole::RightKnee, JointRole::RightFoot, JointRole::RightToe],
];
pub(super) const ARMS: [[JointRole; 3]; 2] = [
    [JointRole::LeftShoulder, JointRole::LeftElbow, JointRole::LeftHand],
    [JointRole::RightShoulder, JointRole::RightElbow, JointRole::RightHand],
];

/// Joints nearer than this are one place, metres.
pub(super) const SAME_PLACE: f64 = 0.01;

impl<'a> Parts<'a> {
    pub(super) fn of(skeleton: &'a Skeleton) -> Self {
        let rest = skeleton
            .forward_kinematics(&skeleton.rest_pose())
            .into_iter()
            .map(|frame| frame.position)
            .collect();
        let named = skeleton.joints.iter().enumerate();
        let roles =
            named.filter_map(|(index, joint)| Some((joint.role?, JointId::from_usize(index)))).collect();
        let mut parts = Self { skeleton, rest, roles };
        if LEGS.iter().any(|leg| !parts.has(&leg[..3])) {
            parts.take_limbs_from_the_tree();
        }
        parts
    }

    /// Whether all of `roles` have joints.
    pub(super) fn has(&self, roles: &[JointRole]) -> bool {
        roles.iter().all(|role| self.joint(*role).is_some())
    }

    pub(super) fn joint(&self, role: JointRole) -> Option<JointId> {
        self.roles.iter().find(|(own, _)| *own == role).map(|(_, joint)| *joint)
    }

    /// Rest place of the joint of `role`, metres.
    pub(super) fn place(&self, role: JointRole) -> Option<DVec3> {
        self.joint(role).map(|joint| self.at(joint))
    }

    /// Rest place of `joint`, metres.
    pub(super) fn at(&self, joint: JointId) -> DVec3 {
        self.rest[joint.as_usize()]
    }

    /// Middle of the rest places of two roles, metres.
    pub(super) fn middle(&self, a: JointRole, b: JointRole) -> Option<DVec3> {
        Some(0.5 * (self.place(a)? + self.place(b)?))
    }

    /// Joints from `above` down to `below`, both included; empty if `below` does not hang on `above`.
    pub(super) fn chain(&self, above: JointId, below: JointId) -> Vec<JointId> {
        let mut chain: Vec<JointId> = self.upwards(below).take_while(|joint| *joint != above).collect();
        let last = chain.last().map_or(Some(below), |top| self.skeleton.joints[top.as_usize()].parent);
        if last != Some(above) {
            return Vec::new();
        }
        chain.push(above);
        chain.reverse();
        chain
    }

    /// `joint`, its parent, and so on up to the root.
    fn upwards(&self, joint: JointId) -> impl Iterator<Item = JointId> + '_ {
        std::iter::successors(Some(joint), |at| self.skeleton.joints[at.as_usize()].parent)
    }

    /// Joints that hang on `joint`, directly or not, helpers left out.
    pub(super) fn below(&self, joint: JointId) -> impl Iterator<Item = JointId> + '_ {
        let all = (joint.as_usize() + 1..self.rest.len()).map(JointId::from_usize);
        all.filter(move |other| {
            !is_helper(&self.skeleton.joints[other.as_usize()].name)
                && self.upwards(*other).skip(1).any(|above| above == joint)
        })
    }

    /// Names of all joints, for errors.
    pub(super) fn names(&self) -> Vec<String> {
        self.skeleton.joints.iter().map(|joint| joint.name.clone()).collect()
    }

    /// Gives roles by the tree at rest: the two lowest chains from the root are legs, the two that reach farthest to the sides
    /// arms, left where +x is (rest poses look along +z).
    fn take_limbs_from_the_tree(&mut self) {
        let mut chains: Vec<Vec<JointId>> = self.leaves().map(|leaf| self.joints_apart(leaf)).collect();
        chains.retain(|chain| chain.len() > 3);
        let end = |chain: &Vec<JointId>| self.rest[chain[chain.len() - 1].as_usize()] - self.rest[0];
        chains.sort_by(|a, b| end(a).y.total_cmp(&end(b).y));
        let lowest = chains.get(..2).filter(|both| both.iter().all(|chain| end(chain).y < 0.0));
        let Some(legs) = self.sided(lowest) else {
            return;
        };
        let mut others: Vec<Vec<JointId>> =
            chains[2..].iter().filter(|chain| chain.len() > 3 && end(chain).y > 0.0).cloned().collect();
        others.sort_by(|a, b| end(b).x.abs().total_cmp(&end(a).x.abs()));
        let arms = self.sided(others.get(..2));
        let mut found = vec![(JointRole::Pelvis, JointId(0))];
        for (roles, chain) in LEGS.iter().zip(&legs) {
            found.extend(roles.iter().copied().zip(branch(chain, &legs)));
        }
        for (roles, chain) in ARMS.iter().zip(arms.iter().flatten()) {
            let last = chain.iter().rev().take(3).rev();
            found.extend(roles.iter().copied().zip(last.copied()));
        }
        if let Some([a, b]) = &arms {
            let shared = a.iter().zip(b).take_while(|(a, b)| a == b).map(|(a, _)| *a).last();
            found.extend(shared.filter(|chest| chest.0 > 0).map(|chest| (JointRole::Chest, chest)));
        }
        self.roles = found;
    }

    fn leaves(&self) -> impl Iterator<Item = JointId> + '_ {
        let joints = (0..self.rest.len()).map(JointId::from_usize);
        joints.filter(|joint| self.below(*joint).next().is_none())
    }

    /// Joints from the root down to `leaf` that are apart from their parents.
    fn joints_apart(&self, leaf: JointId) -> Vec<JointId> {
        let apart = |joint: &JointId| {
            let parent = self.skeleton.joints[joint.as_usize()].parent;
            parent.is_none_or(|parent| self.at(parent).distance(self.at(*joint)) > SAME_PLACE)
        };
        let mut chain: Vec<JointId> = self.upwards(leaf).filter(apart).collect();
        chain.reverse();
        chain
    }

    /// Two chains of different sides, the left one first.
    fn sided(&self, chains: Option<&[Vec<JointId>]>) -> Option<[Vec<JointId>; 2]> {
        let [a, b] = chains? else { return None };
        let side = |chain: &Vec<JointId>| self.rest[chain[chain.len() - 1].as_usize()].x - self.rest[0].x;
        let (x_a, x_b) = (side(a), side(b));
        if x_a * x_b >= 0.0 {
            return None;
        }
        Some(if x_a > 0.0 { [a.clone(), b.clone()] } else { [b.clone(), a.clone()] })
    }
}

/// The part of `chain` that it does not share with the other of `both`.
fn branch(chain: &[JointId], both: &[Vec<JointId>; 2]) -> Vec<JointId> {
    let shared = both[0].iter().zip(&both[1]).take_while(|(a, b)| a == b).count();
    chain[shared..].to_vec()
}
