//! Ends of the body that must be somewhere at some time: what they ask of the body and of its limbs.

use glam::{DQuat, DVec3};

use crate::full_body::chain::{Chain, EndPose, is_below, set_in_world, world_frame};
use crate::full_body::limits::MOST_BENT;
use crate::full_body::reach::Demand;
use crate::index::JointId;
use crate::skeleton::{Pose, Skeleton};

/// Where a joint must be at successive samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Effector {
    /// Any joint. Hands, feet and what hangs on them are brought there by their limbs, other joints by the whole body.
    pub joint: JointId,
    /// First sample.
    pub first: usize,
    /// From the first sample on, one a sample.
    pub targets: Vec<Target>,
}

/// Where a joint must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// World position, metres.
    pub position: DVec3,
    /// World rotation, where it matters.
    pub rotation: Option<DQuat>,
}

/// Limbs are asked to reach no farther than this, share of their length, as long as the body can go nearer instead.
const COMFORTABLE: f64 = 0.98;

impl Effector {
    /// The target at sample `at`.
    pub fn at(&self, at: usize) -> Option<&Target> {
        self.targets.get(at.checked_sub(self.first)?)
    }

    /// The limb of `limbs` that brings it to its targets.
    pub fn limb<'a>(&self, skeleton: &Skeleton, limbs: &'a [Chain]) -> Option<&'a Chain> {
        let hangs_on = |lower: JointId| self.joint == lower || is_below(skeleton, self.joint, lower);
        limbs.iter().find(|limb| hangs_on(limb.lower))
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
        let end = end_pose(skeleton, limb, pose, (self.joint, target));
        let place = limb.place(skeleton, pose).limb;
        let length: f64 = place.lengths().iter().sum();
        let fold = place.span_at(MOST_BENT).min(place.upper.distance(place.lower));
        Some(Demand { hip: place.upper, ankle: end.position, reach: COMFORTABLE * length, fold })
    }

    /// How far the joint is from its target in `pose` at sample `at`, metres.
    pub fn shortfall(&self, skeleton: &Skeleton, pose: &Pose, at: usize) -> Option<f64> {
        let target = self.at(at)?;
        Some(world_frame(skeleton, pose, self.joint).position.distance(target.position))
    }

    /// Gives the joint its rotation at sample `at`, for joints that no limb brings there.
    pub fn orient(&self, skeleton: &Skeleton, pose: &mut Pose, at: usize) {
        if let Some(rotation) = self.at(at).and_then(|target| target.rotation) {
            set_in_world(skeleton, pose, self.joint, rotation);
        }
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
