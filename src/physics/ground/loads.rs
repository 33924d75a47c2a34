//! Sums over links that a step needs.

use glam::{DMat3, DVec3};

use crate::physics::body_model::BodyModel;
use crate::physics::ground::parts::{JointMotion, LinkSets};
use crate::physics::posed::PosedClip;
use crate::physics::zmp::LinkForces;

/// `Σ arm ⊗ F` of each frame for [`crate::physics::ground::closed_form::Loads::arms`], N m. Cost: linear in frames times links.
///
/// Where the root turns, arms are from the origin: the pivot is known only with the point's target, and [`about`] takes it off.
pub(super) fn arm_sums(
    sets: &LinkSets,
    body: &BodyModel,
    posed: &PosedClip,
    forces: &LinkForces,
) -> Vec<DMat3> {
    let mut sums = vec![DMat3::ZERO; posed.frame_count()];
    for (index, link) in body.links.iter().enumerate() {
        let (border, component) = match sets.motions[link.joint.as_usize()] {
            JointMotion::Stays => continue,
            JointMotion::Turns(component) => (None, component),
            JointMotion::Carried(border) => {
                (Some(sets.borders[border].joint), sets.borders[border].component)
            }
        };
        let top = sets.components[component].top;
        let pivot = (top.as_usize() > 0).then_some(top);
        for (frame, sum) in sums.iter_mut().enumerate() {
            let end = border
                .map_or_else(|| forces.places.vector(index, frame), |joint| posed.at(frame, joint).position);
            let start = pivot.map_or(DVec3::ZERO, |joint| posed.at(frame, joint).position);
            *sum += outer(end - start, forces.forces.vector(index, frame));
        }
    }
    sums
}

/// The sum with all arms from `pivot`, where everything moves; `force` is that on the whole body.
pub(super) fn about(sum: DMat3, pivot: DVec3, force: DVec3) -> DMat3 {
    sum - outer(pivot, force)
}

fn outer(arm: DVec3, force: DVec3) -> DMat3 {
    DMat3::from_cols(arm * force.x, arm * force.y, arm * force.z)
}
