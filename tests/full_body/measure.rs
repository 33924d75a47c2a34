//! What is measured of a body in motion.

use cotillion::clip::Clip;
use cotillion::clip::contacts::{ContactPoint, Contacts, contact_point};
use cotillion::full_body::chain::{arms, legs};
use cotillion::full_body::limits::{Cone, MOST_BENT};
use cotillion::full_body::smooth::largest_acceleration;
use cotillion::full_body::wrist::{SWING, TWIST, Wrist};
use cotillion::geometry::log;
use cotillion::metrics::foot_slide;
use cotillion::skeleton::{Pose, Skeleton};
use std::sync::Arc;

use super::clips::Stretch;

/// Largest angular acceleration of a knee, rad/s², by second differences.
pub(crate) fn knee_acceleration(skeleton: &Skeleton, times: &[f64], poses: &[Pose]) -> f64 {
    let knees = legs(skeleton).into_iter().flatten().map(|leg| {
        let angles: Vec<f64> = poses.iter().map(|pose| leg.place(skeleton, pose).limb.bend()).collect();
        largest_acceleration(times, &angles)
    });
    knees.fold(0.0, f64::max)
}

/// Mean horizontal speed of points of the feet in contact, m/s.
pub(crate) fn slide(skeleton: &Skeleton, poses: &[Pose], contacts: &[Contacts]) -> f64 {
    let clip = Clip::from_poses("", Arc::new(skeleton.clone()), 30.0, poses);
    foot_slide(&clip, contacts).unwrap_or(0.0)
}

/// Largest change of the height of a point of a foot or a hand while it bears and `counts` it at that frame, metres.
pub(crate) fn height_change(
    stretch: &Stretch<'_>,
    after: &[Pose],
    counts: impl Fn(ContactPoint, usize) -> bool,
) -> f64 {
    let skeleton = stretch.walk.skeleton();
    let mut largest = 0.0_f64;
    for (frame, (before, after)) in stretch.rest.iter().zip(after).enumerate() {
        let contact = stretch.contacts[frame];
        let (before, after) = (skeleton.forward_kinematics(before), skeleton.forward_kinematics(after));
        let bearing = ContactPoint::ALL.into_iter().filter(|point| contact.at(*point));
        for point in bearing.filter(|point| counts(*point, frame)) {
            let Some(at) = contact_point(skeleton, point) else { continue };
            largest = largest.max((at.place(&before).y - at.place(&after).y).abs());
        }
    }
    largest
}

/// Largest change of a joint's angle, radians.
pub(crate) fn largest_change(before: &[Pose], after: &[Pose]) -> f64 {
    let angles = before.iter().zip(after).flat_map(|(before, after)| {
        before.rotations.iter().zip(&after.rotations).map(|(a, b)| log(a.inverse() * *b).length())
    });
    angles.fold(0.0, f64::max)
}

/// Largest difference of the length of a bone, metres, and whether all numbers are finite.
pub(crate) fn bone_change(skeleton: &Skeleton, before: &[Pose], after: &[Pose]) -> f64 {
    let mut largest = 0.0_f64;
    for (before, after) in before.iter().zip(after) {
        let (before, after) = (skeleton.forward_kinematics(before), skeleton.forward_kinematics(after));
        for (index, joint) in skeleton.joints.iter().enumerate() {
            let Some(parent) = joint.parent else { continue };
            let length = |frames: &[cotillion::skeleton::JointFrame]| {
                frames[index].position.distance(frames[parent.as_usize()].position)
            };
            let change = (length(&before) - length(&after)).abs();
            largest = largest.max(if change.is_finite() { change } else { f64::INFINITY });
        }
    }
    largest
}

/// How far the lowest point of a foot comes below the lowest one of the capture, metres.
pub(crate) fn below_ground(skeleton: &Skeleton, before: &[Pose], after: &[Pose]) -> f64 {
    let lowest = |poses: &[Pose]| {
        let points: Vec<_> =
            ContactPoint::FEET.into_iter().filter_map(|point| contact_point(skeleton, point)).collect();
        let heights = poses.iter().flat_map(|pose| {
            let frames = skeleton.forward_kinematics(pose);
            points.iter().map(|point| point.place(&frames).y).collect::<Vec<_>>()
        });
        heights.fold(f64::INFINITY, f64::min)
    };
    (lowest(before) - lowest(after)).max(0.0)
}

/// How far thighs, upper arms, knees, elbows and wrists go beyond what limbs are brought to, radians.
pub(crate) fn beyond_limits(skeleton: &Skeleton, poses: &[Pose]) -> f64 {
    let beyond = legs(skeleton).into_iter().chain(arms(skeleton)).flatten().flat_map(|limb| {
        let cone = Cone::of(skeleton, &limb);
        let is_arm = arms(skeleton).contains(&Some(limb));
        let wrist = Wrist::of(skeleton, &limb).filter(|_| is_arm);
        poses.iter().map(move |pose| {
            let place = limb.place(skeleton, pose);
            let above = place.upper_rotation * pose.rotations[limb.upper.as_usize()].inverse();
            let bone = place.limb.middle - place.limb.upper;
            let swing = cone.map_or(0.0, |cone| bone.angle_between(above * cone.axis) - cone.angle);
            let hand = pose.rotations[limb.lower.as_usize()];
            let [tilt, twist] = wrist.map_or([0.0; 2], |wrist| wrist.angles(hand));
            swing.max(place.limb.bend() - MOST_BENT).max(tilt - SWING).max(twist - TWIST)
        })
    });
    beyond.fold(0.0, f64::max)
}
