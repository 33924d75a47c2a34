//! How big a body is and how it stands: measured in its rest pose and where both ends of a foot bear.

use glam::{DMat3, DQuat, DVec3};

use crate::clip::Clip;
use crate::clip::contacts::{
    ContactPoint, ContactSettings, contact_point, foot_contacts, percentile, sampled_frames,
};
use crate::clip::working::WORKING_STEP;
use crate::skeleton::{JointFrame, JointRole, Skeleton};

/// Rest poses this near to axes are meant to lie on them, as the cosine of 25°.
const NEAR_AXIS: f64 = 0.906;
/// Flat feet whose soles point up alike are flat: the mean of their unit normals is at least so long.
const LEAST_AGREEMENT: f64 = 0.95;
/// Of the frames in which both ends of a foot bear, one in so many, the lowest, is flat: in the others it rolls.
const FLAT_PART: usize = 4;
/// A foot whose only segment is steeper goes down to the sole, not ahead: the sine of 30°. Where it points the body tells.
const LEAST_AHEAD: f64 = 0.5;
/// Smaller bodies have no size, metres.
const LEAST_SIZE: f64 = 1e-3;
/// Share of the frames in which an ankle is lower than its floor, where no foot is ever flat.
const FLOOR_SHARE: f64 = 0.01;

/// Measures of one body in one clip.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stance {
    /// From the body's axes (x left, y up, z ahead) to those of the rest pose.
    pub(super) body: DQuat,
    /// Thigh and shank, else the extent of the rest pose, metres.
    pub(super) size: f64,
    /// Height of the ankles in flat feet, metres.
    pub(super) ankle_height: f64,
    /// Left and right.
    pub(super) soles: [Option<Sole>; 2],
}

/// The sole of a foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sole {
    /// From the sole's axes (x left, y up, z ahead) to those of the foot joint.
    pub(super) axes: DQuat,
    /// From the ankle to the toe point in the sole's axes, metres.
    pub(super) toe: DVec3,
}

impl Stance {
    /// Cost: linear in frames times joints.
    pub(super) fn of(clip: &Clip) -> Self {
        let skeleton = &clip.skeleton;
        let rest = skeleton.forward_kinematics(&skeleton.rest_pose());
        let body = body_axes(skeleton, &rest);
        let step = clip.fps * WORKING_STEP;
        let poses = sampled_frames(clip, clip.usable.0, clip.usable.1, step);
        let flat = flat_feet(skeleton, &poses);
        let soles = [0, 1].map(|side| sole(skeleton, side, &flat[side], body));
        let ankle_height = ankle_height(skeleton, &poses, &flat);
        let shown = poses.first().unwrap_or(&rest);
        Self { body, size: size(skeleton, shown), ankle_height, soles }
    }
}

/// Ankle and toe point of a side.
const POINTS: [[ContactPoint; 2]; 2] =
    [[ContactPoint::LeftHeel, ContactPoint::LeftToe], [ContactPoint::RightHeel, ContactPoint::RightToe]];

/// Frames of the ankle where a foot stands flat, left and right: both ends bear, and are lowest.
fn flat_feet(skeleton: &Skeleton, poses: &[Vec<JointFrame>]) -> [Vec<JointFrame>; 2] {
    let contacts = foot_contacts(skeleton, poses, poses, &ContactSettings::default());
    POINTS.map(|points| {
        let [Some(ankle), Some(toe)] = points.map(|point| contact_point(skeleton, point)) else {
            return Vec::new();
        };
        let is_flat = |index: &usize| points.iter().all(|point| contacts[*index].at(*point));
        let mut flat: Vec<(f64, JointFrame)> = (0..poses.len())
            .filter(is_flat)
            .map(|index| &poses[index])
            .map(|frames| (ankle.place(frames).y + toe.place(frames).y, frames[ankle.joint.as_usize()]))
            .collect();
        flat.sort_by(|a, b| a.0.total_cmp(&b.0));
        flat.truncate(flat.len().div_ceil(FLAT_PART));
        flat.into_iter().map(|(_, frame)| frame).collect()
    })
}

fn sole(skeleton: &Skeleton, side: usize, flat: &[JointFrame], body: DQuat) -> Option<Sole> {
    let ankle = contact_point(skeleton, POINTS[side][0])?;
    let toe = contact_point(skeleton, POINTS[side][1])?;
    let mut to_toe = toe.local;
    let mut joint = toe.joint;
    while joint != ankle.joint {
        let row = &skeleton.joints[joint.as_usize()];
        to_toe += row.offset;
        joint = row.parent?;
    }
    let mean = flat.iter().map(|frame| frame.rotation.inverse() * DVec3::Y).sum::<DVec3>();
    let agreed = mean.length() >= LEAST_AGREEMENT * flat.len() as f64;
    let up = mean.try_normalize().filter(|_| agreed).unwrap_or(body * DVec3::Y);
    let along = to_toe.reject_from_normalized(up);
    let is_told = along.length() > LEAST_AHEAD * to_toe.length();
    let ahead = if is_told { along } else { (body * DVec3::Z).reject_from_normalized(up) }.try_normalize()?;
    let axes = DQuat::from_mat3(&DMat3::from_cols(up.cross(ahead), up, ahead)).normalize();
    Some(Sole { axes, toe: axes.inverse() * to_toe })
}

/// Median height of the ankles in flat feet; where none is, how low the lower ankle comes.
fn ankle_height(skeleton: &Skeleton, poses: &[Vec<JointFrame>], flat: &[Vec<JointFrame>; 2]) -> f64 {
    let medians = flat
        .iter()
        .filter(|frames| !frames.is_empty())
        .map(|frames| percentile(frames.iter().map(|frame| frame.position.y).collect(), 0.5));
    let floors = POINTS.iter().filter_map(|points| {
        let ankle = contact_point(skeleton, points[0])?;
        Some(percentile(poses.iter().map(|frames| ankle.place(frames).y).collect(), FLOOR_SHARE))
    });
    medians.reduce(f64::min).or_else(|| floors.reduce(f64::min)).unwrap_or(0.0)
}

/// Length of a leg, mean of both; of a body without legs the extent of its joints.
fn size(skeleton: &Skeleton, frames: &[JointFrame]) -> f64 {
    let at = |role| Some(frames[skeleton.joint_of(role)?.as_usize()].position);
    let leg = |[hip, knee, foot]: [JointRole; 3]| {
        let knee = at(knee)?;
        Some(at(hip)?.distance(knee) + knee.distance(at(foot)?))
    };
    let lengths: Vec<f64> = LEGS.into_iter().filter_map(leg).filter(|length| *length > LEAST_SIZE).collect();
    if !lengths.is_empty() {
        return lengths.iter().sum::<f64>() / lengths.len() as f64;
    }
    let extent = frames.iter().map(|frame| frame.position.distance(frames[0].position)).fold(0.0, f64::max);
    if extent > LEAST_SIZE { extent } else { 1.0 }
}

/// Hip, knee and ankle, left and right.
pub(super) const LEGS: [[JointRole; 3]; 2] = [
    [JointRole::LeftHip, JointRole::LeftKnee, JointRole::LeftFoot],
    [JointRole::RightHip, JointRole::RightKnee, JointRole::RightFoot],
];

/// From the body's axes to those of its rest pose: left from hip to hip (else shoulder to shoulder), up along the trunk.
fn body_axes(skeleton: &Skeleton, rest: &[JointFrame]) -> DQuat {
    use JointRole as R;
    let at = |role| Some(rest[skeleton.joint_of(role)?.as_usize()].position);
    let pair = |left, right| Some((at(left)?, at(right)?));
    let hips = pair(R::LeftHip, R::RightHip);
    let shoulders = pair(R::LeftShoulder, R::RightShoulder);
    let below = hips.map_or(rest[0].position, |(left, right)| (left + right) / 2.0);
    let above = shoulders.map(|(left, right)| (left + right) / 2.0);
    let above = above.or_else(|| at(R::Head)).or_else(|| at(R::Neck)).or_else(|| at(R::Chest));
    let Some((left, right)) = hips.or(shoulders) else {
        return DQuat::IDENTITY;
    };
    let up = onto_axis(above.map_or(DVec3::Y, |above| above - below));
    let left = onto_axis((left - right).reject_from(up));
    match (up.try_normalize(), left.reject_from(up).try_normalize()) {
        (Some(up), Some(left)) => DQuat::from_mat3(&DMat3::from_cols(left, up, left.cross(up))).normalize(),
        _ => DQuat::IDENTITY,
    }
}

/// The axis that a direction is meant to lie on; itself, where it lies near none.
fn onto_axis(direction: DVec3) -> DVec3 {
    let unit = direction.normalize_or(DVec3::Y);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
    axes.into_iter().find(|axis| axis.dot(unit) > NEAR_AXIS).unwrap_or(unit)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;

    use super::*;
    use crate::clip::builtin::generate;

    #[test]
    fn a_foot_that_goes_straight_down_to_the_sole_points_where_the_body_looks() {
        let walk = generate("walk", &BTreeMap::new()).expect("it is generated");
        let mut skeleton = (*walk.skeleton).clone();
        for role in [JointRole::LeftToe, JointRole::RightToe] {
            let toe = skeleton.joint_of(role).expect("generated bodies have toes");
            // A little aside, as captures have it.
            skeleton.joints[toe.as_usize()].offset = DVec3::new(0.008, -0.08, -0.002);
        }
        let stance = Stance::of(&Clip { skeleton: Arc::new(skeleton), ..walk });
        for sole in stance.soles {
            let ahead = sole.expect("a foot has a sole").axes * DVec3::Z;
            assert!(ahead.dot(stance.body * DVec3::Z) > 0.9, "{ahead}");
        }
    }
}
