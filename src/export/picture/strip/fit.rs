//! What is fitted to a whole clip before its poses are drawn: the ground, the feet, the head.

use glam::DVec3;

use super::landmarks::{Axes, Landmarks};
use crate::clip::contacts::{BodyPoint, ContactPoint, contact_point, percentile};
use crate::index::{JointId, floor_index};
use crate::skeleton::{JointFrame, JointRole, Skeleton};

/// A foot: heel and ball move with the ankle joint, the tip with the toe joint where there is one.
pub(super) struct Foot {
    pub(super) heel: BodyPoint,
    pub(super) ball: BodyPoint,
    pub(super) tip: BodyPoint,
}

/// Share of the frames in which a foot is lower than the ground is taken to be.
const GROUND_PERCENTILE: f64 = 0.02;
/// Middle of the toe joint above the ground, metres.
const TOE_HEIGHT: f64 = 0.026;
/// Middle of the ankle joint above the ground, metres.
const ANKLE_HEIGHT: f64 = 0.085;
/// Ankle to tip of the toes, less the rounding of the tip, metres.
const FOOT_LENGTH: f64 = 0.185;
/// A foot is on the ground below this height above its floor, metres.
const GROUNDED: f64 = 0.015;
/// Of the frames with a foot on the ground the one that is taken for flat, by rising height of the ankle.
const FLAT_PERCENTILE: f64 = 0.25;
/// A trunk is upright above this cosine of its lean, 37°.
const UPRIGHT: f64 = 0.8;

/// Height of the ground: below the lowest foot, else below the lowest joint.
pub(super) fn ground(skeleton: &Skeleton, poses: &[Vec<JointFrame>], scale: f64) -> f64 {
    let floor = |point: ContactPoint| {
        let at = contact_point(skeleton, point)?;
        let heights = poses.iter().map(|frames| at.place(frames).y).collect();
        let above = if point.is_toe() { TOE_HEIGHT } else { ANKLE_HEIGHT };
        Some((point.is_toe(), percentile(heights, GROUND_PERCENTILE) - above * scale))
    };
    let floors: Vec<(bool, f64)> = ContactPoint::FEET.into_iter().filter_map(floor).collect();
    let has_toes = floors.iter().any(|(is_toe, _)| *is_toe);
    let lowest = floors.iter().filter(|(is_toe, _)| *is_toe == has_toes).map(|(_, floor)| *floor);
    lowest
        .reduce(f64::min)
        .unwrap_or_else(|| poses.iter().flatten().map(|frame| frame.position.y).fold(f64::INFINITY, f64::min))
}

/// A foot that stands flat in its flat pose.
pub(super) fn fit_foot(
    poses: &[Vec<JointFrame>],
    ankle: BodyPoint,
    toe: Option<BodyPoint>,
    (ground, scale): (f64, f64),
) -> Option<Foot> {
    let flat = flat_pose(poses, ankle, toe)?;
    let under = ankle.place(flat);
    let hidden_toe = || flat[ankle.joint.as_usize()].rotation * DVec3::Z + under;
    let ahead =
        (toe.map_or_else(hidden_toe, |toe| toe.place(flat)) - under).with_y(0.0).normalize_or(DVec3::Z);
    // The ground of this very step: feet that never come down, or stand on a stool, keep their shape.
    let sole = ground.max(under.y - 1.3 * ANKLE_HEIGHT * scale).min(under.y - 0.045 * scale);
    let at = |forward: f64, height: f64| (under + ahead * (forward * scale)).with_y(sole + height * scale);
    let to_toe = toe.map_or(0.13 * scale, |toe| (toe.place(flat) - under).with_y(0.0).length()) / scale;
    let ball = to_toe.clamp(0.08, 0.15);
    let local = |joint: JointId, point: DVec3| {
        let frame = flat[joint.as_usize()];
        BodyPoint { joint, local: frame.rotation.inverse() * (point - frame.position) }
    };
    let tip_joint = toe.map_or(ankle.joint, |toe| toe.joint);
    Some(Foot {
        heel: local(ankle.joint, at(-0.036, 0.037)),
        ball: local(ankle.joint, at(ball, 0.036)),
        tip: local(tip_joint, at(FOOT_LENGTH.max(ball + 0.02), 0.027)),
    })
}

/// The pose in which a foot stands flat: its toe down, its ankle low.
fn flat_pose(
    poses: &[Vec<JointFrame>],
    ankle: BodyPoint,
    toe: Option<BodyPoint>,
) -> Option<&Vec<JointFrame>> {
    let low = toe.unwrap_or(ankle);
    let height = |frames: &Vec<JointFrame>| low.place(frames).y;
    let floor = percentile(poses.iter().map(height).collect(), GROUND_PERCENTILE);
    let mut grounded: Vec<&Vec<JointFrame>> =
        poses.iter().filter(|frames| height(frames) <= floor + GROUNDED).collect();
    grounded.sort_by(|a, b| ankle.place(a).y.total_cmp(&ankle.place(b).y));
    grounded.get(floor_index(FLAT_PERCENTILE * grounded.len() as f64)).copied()
}

/// The head joint, else that of the chest, with the axes of the head in it: upright and ahead on average over the frames in
/// which the trunk is upright, else as the chest.
pub(super) fn fit_head(skeleton: &Skeleton, poses: &[Vec<JointFrame>]) -> Option<(JointId, Axes)> {
    let joint = skeleton.joint_of(JointRole::Head).or_else(|| skeleton.joint_of(JointRole::Chest))?;
    let axes: Vec<Axes> =
        poses.iter().map(|frames| Some(Landmarks::of(skeleton, frames)?.axes)).collect::<Option<_>>()?;
    let is_upright = |axes: &Axes| axes.up.y > UPRIGHT;
    let ever_upright = axes.iter().any(is_upright);
    let (mut ahead, mut up) = (DVec3::ZERO, DVec3::ZERO);
    for (frames, axes) in poses.iter().zip(&axes).filter(|(_, axes)| !ever_upright || is_upright(axes)) {
        let back = frames[joint.as_usize()].rotation.inverse();
        ahead += back * axes.ahead;
        up += back * if ever_upright { DVec3::Y } else { axes.up };
    }
    Some((joint, Axes::of(up.cross(ahead), up)))
}
