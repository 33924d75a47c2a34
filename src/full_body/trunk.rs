//! The pelvis, the trunk, the neck and the head turned as asked, before limbs are brought anywhere: what hangs on them is
//! brought to its own places afterwards.
//!
//! Neck and head turn first, then the spine takes what is missing, all evenly; turns come and go smoothly. What is beyond the
//! limits is not done.
//!
//! Source: ranges of motion after Norkin & White, *Measurement of Joint Motion*, 5th ed., 2016, appendix, widened.

use std::collections::BTreeSet;

use glam::{DQuat, DVec3};

use crate::full_body::chain::{Chain, bearing_arms, is_below, legs, turn_in_world, world_frame};
use crate::full_body::effector::Effector;
use crate::full_body::hierarchical::spread;
use crate::full_body::limits::Cone;
use crate::geometry::{exp, log};
use crate::index::JointId;
use crate::limb::minimal_rotation;
use crate::skeleton::{Pose, Skeleton};

/// Seconds in which a turn comes and goes.
const EASE: f64 = 15.0 / 30.0;

/// Neck and head turn so far from how they are at rest, radians: 90°.
pub const NECK: f64 = 1.571;

/// All joints of the spine together, radians: 60°.
pub const SPINE: f64 = 1.047;

/// The pelvis, from how it is before, radians: 60°, which hips give while feet stand.
pub const PELVIS: f64 = 1.047;

/// A collarbone, and what else hangs on the trunk, radians: 40°.
const COLLARBONE: f64 = 0.698;

/// Turns smaller than this are none, radians.
const NOTHING: f64 = 1e-12;

/// Turns joints that no limb brings to its targets as `effectors` ask, in all `poses`; the nearest to the root first. Cost: linear
/// in samples, for each of the joints that take part in the turn of each such effector. Says whether any is asked for.
pub fn turn_trunk(skeleton: &Skeleton, times: &[f64], effectors: &[Effector], poses: &mut [Pose]) -> bool {
    let body = Body::new(skeleton);
    let mut asked: Vec<&Effector> = effectors.iter().filter(|end| body.turns(end)).collect();
    asked.sort_by_key(|end| end.joint.as_usize());
    let any = !asked.is_empty();
    // Samples at which each joint is turned already.
    let mut held: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); skeleton.joints.len()];
    for end in asked {
        let turn = |(at, rotation)| {
            let is_free = |joint: &JointId| !held[joint.as_usize()].contains(&at);
            (at, body.turned(&poses[at], (end.joint, rotation), is_free))
        };
        let turned: Vec<(usize, Turns)> = rotations(end).map(turn).collect();
        for joint in body.path(end.joint) {
            let own = &mut held[joint.as_usize()];
            let zeros = own.iter().map(|at| (*at, [DVec3::ZERO]));
            let exact: Vec<(usize, [DVec3; 1])> = zeros.chain(turns_of(joint, &turned)).collect();
            for (pose, [turn]) in poses.iter_mut().zip(spread(times, &exact, EASE)) {
                turn_in_own_axes(pose, joint, turn);
            }
            own.extend(turned.iter().map(|(at, _)| *at));
        }
    }
    any
}

/// Rotation vectors of joints in their own axes.
type Turns = Vec<(JointId, DVec3)>;

/// The turns of one joint, by sample.
fn turns_of(joint: JointId, turned: &[(usize, Turns)]) -> impl Iterator<Item = (usize, [DVec3; 1])> {
    turned.iter().filter_map(move |(at, turns)| {
        let own = turns.iter().find(|(turned, _)| *turned == joint);
        own.map(|(_, turn)| (*at, [*turn]))
    })
}

fn turn_in_own_axes(pose: &mut Pose, joint: JointId, turn: DVec3) {
    if turn != DVec3::ZERO {
        let local = &mut pose.rotations[joint.as_usize()];
        *local = (*local * exp(turn)).normalize();
    }
}

/// Samples at which an effector asks for a rotation, and which.
fn rotations(end: &Effector) -> impl Iterator<Item = (usize, DQuat)> {
    (end.first..).zip(&end.targets).filter_map(|(at, target)| Some((at, target.rotation?)))
}

/// A body and its limbs.
struct Body<'a> {
    skeleton: &'a Skeleton,
    rest: Pose,
    arms: Vec<Chain>,
    limbs: Vec<Chain>,
}

impl<'a> Body<'a> {
    fn new(skeleton: &'a Skeleton) -> Self {
        let arms: Vec<Chain> = bearing_arms(skeleton).into_iter().flatten().collect();
        let limbs = legs(skeleton).into_iter().flatten().chain(arms.iter().copied()).collect();
        Self { skeleton, rest: skeleton.rest_pose(), arms, limbs }
    }

    /// Whether the joint is one that no limb brings anywhere, and is to be turned.
    fn turns(&self, end: &Effector) -> bool {
        let is_on_limb = self.limbs.iter().any(|limb| end.part(self.skeleton, limb).is_some());
        !is_on_limb && end.targets.iter().any(|target| target.rotation.is_some())
    }

    /// Joints that take part in the turn of `joint`, from the root on: those of limbs and collarbones turn alone.
    fn path(&self, joint: JointId) -> Vec<JointId> {
        let carries = |limb: &&Chain| limb.upper == joint || is_below(self.skeleton, limb.upper, joint);
        let carried = self.limbs.iter().filter(carries).count();
        let mut path = vec![joint];
        if carried == 1 {
            return path;
        }
        while let Some(parent) = self.skeleton.joints[path[path.len() - 1].as_usize()].parent
            && self.skeleton.joints[parent.as_usize()].parent.is_some()
        {
            path.push(parent);
        }
        path.reverse();
        path
    }

    /// Whether arms hang on it, but it is no collarbone.
    fn is_spine(&self, joint: JointId) -> bool {
        self.arms.iter().filter(|arm| is_below(self.skeleton, arm.upper, joint)).count() > 1
    }

    /// Turns of joints in their own axes with which `joint` of `pose` is turned as asked, or as nearly as they go.
    fn turned(
        &self,
        pose: &Pose,
        (joint, rotation): (JointId, DQuat),
        is_free: impl Fn(&JointId) -> bool,
    ) -> Turns {
        let path: Vec<JointId> = self.path(joint).into_iter().filter(is_free).collect();
        let mut turned = pose.clone();
        let (spine, neck): (Vec<JointId>, Vec<JointId>) =
            path.iter().copied().partition(|joint| self.is_spine(*joint));
        for part in [neck, spine] {
            let own = world_frame(self.skeleton, &turned, joint).rotation;
            let missing = log(rotation * own.inverse());
            if missing.length() > NOTHING {
                for one in &part {
                    let share = missing / part.len() as f64;
                    self.turn(pose, &mut turned, (*one, share), part.len());
                }
            }
        }
        let turn = |joint: JointId| {
            let at = joint.as_usize();
            (joint, log(pose.rotations[at].inverse() * turned.rotations[at]))
        };
        path.into_iter().map(turn).collect()
    }

    /// Turns one of `count` joints by `turn`, in the world's axes, within its limits or those of `before`.
    fn turn(&self, before: &Pose, pose: &mut Pose, (joint, turn): (JointId, DVec3), count: usize) {
        turn_in_world(self.skeleton, pose, joint, exp(turn));
        let at = joint.as_usize();
        let (own, captured) = (pose.rotations[at], before.rotations[at]);
        if let Some(limb) = self.limbs.iter().find(|limb| limb.upper == joint) {
            self.stop_bone(before, pose, limb);
            return;
        }
        let share = 1.0 / count as f64;
        let (from, most) = match self.skeleton.joints[at].parent {
            None => (captured, PELVIS),
            Some(_) if self.is_spine(joint) => (self.rest.rotations[at], SPINE * share),
            Some(_) if self.path(joint).len() == 1 => (captured, COLLARBONE),
            Some(_) => (self.rest.rotations[at], NECK * share),
        };
        let from_rest = log(from.inverse() * own);
        let most = most.max(log(from.inverse() * captured).length());
        if from_rest.length() > most {
            pose.rotations[at] = (from * exp(from_rest * (most / from_rest.length()))).normalize();
        }
    }

    /// Turns the upper bone of a limb back into its cone.
    fn stop_bone(&self, before: &Pose, pose: &mut Pose, limb: &Chain) {
        let [was, is] = [before, &*pose].map(|pose| limb.place(self.skeleton, pose));
        let Some(cone) = Cone::of(self.skeleton, limb) else { return };
        let above = is.upper_rotation * pose.rotations[limb.upper.as_usize()].inverse();
        let bone = is.limb.middle - is.limb.upper;
        let stopped = cone.stop(above, &was.limb, bone);
        if stopped != bone {
            turn_in_world(self.skeleton, pose, limb.upper, minimal_rotation(bone, stopped));
        }
    }
}
