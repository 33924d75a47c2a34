//! Ends of the body that must be somewhere at some time: what they ask of the body and of its limbs.

use glam::{DQuat, DVec3};

use crate::full_body::chain::{Chain, EndPose, is_below, world_frame};
use crate::full_body::hinge::Hinge;
use crate::full_body::limits::MOST_BENT;
use crate::full_body::reach::Demand;
use crate::index::JointId;
use crate::skeleton::{Pose, Skeleton};

/// Where a joint must be at successive samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Effector {
    /// Any joint. What hangs on a limb is brought there by the limb, other joints by the whole body.
    pub joint: JointId,
    /// First sample.
    pub first: usize,
    /// From the first sample on, one a sample.
    pub targets: Vec<Target>,
    /// Whether it holds something: it turns as asked however far, so that its fingers do not slip.
    pub holds: bool,
}

/// Where a joint must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// World position, metres.
    pub position: DVec3,
    /// World rotation, where it matters.
    pub rotation: Option<DQuat>,
}

/// What of a limb brings a joint to its target; what is farther out goes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// The joint is the hand or the foot, or hangs on it.
    End,
    /// It hangs on the lower bone.
    Lower,
    /// It is the middle joint, or hangs on the upper bone.
    Upper,
}

/// Limbs are asked to reach no farther than this, share of their length, as long as the body can go nearer instead.
const COMFORTABLE: f64 = 0.98;

impl Effector {
    /// The target at sample `at`.
    pub fn at(&self, at: usize) -> Option<&Target> {
        self.targets.get(at.checked_sub(self.first)?)
    }

    /// The part of `limb` that brings it to its targets; `None` where another limb or the body does.
    pub fn part(&self, skeleton: &Skeleton, limb: &Chain) -> Option<Part> {
        let is_end =
            !limb.is_open() && (self.joint == limb.lower || is_below(skeleton, self.joint, limb.lower));
        if is_end {
            Some(Part::End)
        } else if is_below(skeleton, self.joint, limb.middle) {
            Some(Part::Lower)
        } else {
            is_below(skeleton, self.joint, limb.upper).then_some(Part::Upper)
        }
    }

    /// What `limb` (the whole body without one) asks of the place of the body at sample `at`, where it is in `pose`.
    pub fn demand(
        &self,
        skeleton: &Skeleton,
        limb: Option<&Chain>,
        pose: &Pose,
        at: usize,
    ) -> Option<Demand> {
        let target = self.at(at)?;
        let Some(limb) = limb else {
            let hip = world_frame(skeleton, pose, self.joint).position;
            return Some(Demand { hip, ankle: target.position, reach: 0.0, fold: 0.0 });
        };
        let place = limb.place(skeleton, pose);
        let hip = place.limb.upper;
        let own = world_frame(skeleton, pose, self.joint).position;
        let (ankle, reach, fold) = match self.part(skeleton, limb) {
            Some(Part::Upper) => (target.position, hip.distance(own), hip.distance(own)),
            Some(Part::End) if target.rotation.is_some() => {
                let length: f64 = place.limb.lengths().iter().sum();
                let end = end_pose(skeleton, limb, pose, (self.joint, target));
                let fold = place.limb.span_at(MOST_BENT).min(hip.distance(place.limb.lower));
                (end.position, COMFORTABLE * length, fold)
            }
            _ => {
                let [nearest, farthest] = Hinge::new(&place, own, DVec3::ZERO).spans();
                let reach = COMFORTABLE * farthest;
                (target.position, reach, nearest.min(hip.distance(own)).min(reach))
            }
        };
        Some(Demand { hip, ankle, reach, fold })
    }

    /// How far the joint is from its target in `pose` at sample `at`, metres.
    pub fn shortfall(&self, skeleton: &Skeleton, pose: &Pose, at: usize) -> Option<f64> {
        let target = self.at(at)?;
        Some(world_frame(skeleton, pose, self.joint).position.distance(target.position))
    }
}

/// Where the lower joint of `limb` must be so that `joint`, which hangs on it, is at `target`. Without a rotation the hand
/// keeps its own in the world.
pub fn end_pose(
    skeleton: &Skeleton,
    limb: &Chain,
    pose: &Pose,
    (joint, target): (JointId, &Target),
) -> EndPose {
    let lower = world_frame(skeleton, pose, limb.lower);
    let own = world_frame(skeleton, pose, joint);
    let to_lower = lower.rotation.inverse();
    let rotation = match target.rotation {
        Some(rotation) => (rotation * own.rotation.inverse() * lower.rotation).normalize(),
        None => lower.rotation,
    };
    let offset = to_lower * (own.position - lower.position);
    EndPose { position: target.position - rotation * offset, rotation }
}
