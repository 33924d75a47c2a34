//! Points and axes of a body that its pictures are drawn around.

use glam::{DQuat, DVec3};

use crate::index::JointId;
use crate::skeleton::{JointFrame, JointRole, Skeleton};

/// Something on the left and the same on the right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sides<T> {
    left: T,
    right: T,
}

/// Left or right of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

impl Side {
    /// The one that belongs to this side.
    pub(super) fn pick<T>(self, left: T, right: T) -> T {
        match self {
            Self::Left => left,
            Self::Right => right,
        }
    }
}

impl<T> Sides<T> {
    pub(super) const BOTH: [Side; 2] = [Side::Left, Side::Right];

    pub(super) fn each(mut make: impl FnMut(Side) -> T) -> Self {
        Self { left: make(Side::Left), right: make(Side::Right) }
    }

    pub(super) const fn get(&self, side: Side) -> &T {
        match side {
            Side::Left => &self.left,
            Side::Right => &self.right,
        }
    }
}

/// Perpendicular unit vectors of a part of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axes {
    pub(super) left: DVec3,
    pub(super) ahead: DVec3,
    pub(super) up: DVec3,
}

impl Axes {
    /// With this direction up, and left as near as can be to `left`.
    pub(super) fn of(left: DVec3, up: DVec3) -> Self {
        let up = up.normalize_or(DVec3::Y);
        let left = left.reject_from_normalized(up).normalize_or(up.any_orthonormal_vector());
        Self { left, ahead: left.cross(up), up }
    }

    pub(super) fn turned(&self, rotation: DQuat) -> Self {
        Self { left: rotation * self.left, ahead: rotation * self.ahead, up: rotation * self.up }
    }
}

/// Where a body has what, in the world.
pub(super) struct Landmarks {
    /// Middle of the hip joints.
    pub(super) hips: DVec3,
    /// Where the trunk bends: at its chest joint, else half-way up.
    pub(super) middle: DVec3,
    /// Middle of the shoulders.
    pub(super) top: DVec3,
    /// Where the neck begins.
    pub(super) neck: DVec3,
    /// Both shoulders.
    pub(super) shoulders: [DVec3; 2],
    /// Of the chest.
    pub(super) axes: Axes,
    /// Of the pelvis.
    pub(super) hip_axes: Axes,
    /// Shoulder, elbow, wrist.
    pub(super) arms: Sides<[Option<JointId>; 3]>,
    /// Hip, knee, ankle.
    pub(super) legs: Sides<[Option<JointId>; 3]>,
}

impl Landmarks {
    /// `None` for a skeleton without hips or shoulders.
    pub(super) fn of(skeleton: &Skeleton, frames: &[JointFrame]) -> Option<Self> {
        use JointRole as R;
        let place = |role| Some(frames[skeleton.joint_of(role)?.as_usize()].position);
        let (hip_left, hip_right) = (place(R::LeftHip)?, place(R::RightHip)?);
        let shoulders = [place(R::LeftShoulder)?, place(R::RightShoulder)?];
        let hips = hip_left.midpoint(hip_right);
        let top = shoulders[0].midpoint(shoulders[1]);
        let joints = |roles: [JointRole; 3]| roles.map(|role| skeleton.joint_of(role));
        let neck = neck(hips, top, place(R::Neck));
        let middle = middle(hips, top, place(R::Chest), place(R::Spine));
        Some(Self {
            hips,
            middle,
            top,
            neck,
            shoulders,
            axes: Axes::of(shoulders[0] - shoulders[1], top - middle),
            hip_axes: Axes::of(hip_left - hip_right, middle - hips),
            arms: Sides {
                left: joints([R::LeftShoulder, R::LeftElbow, R::LeftHand]),
                right: joints([R::RightShoulder, R::RightElbow, R::RightHand]),
            },
            legs: Sides {
                left: joints([R::LeftHip, R::LeftKnee, R::LeftFoot]),
                right: joints([R::RightHip, R::RightKnee, R::RightFoot]),
            },
        })
    }
}

/// The neck joint where it lies a little above the shoulders, else that place.
fn neck(hips: DVec3, top: DVec3, joint: Option<DVec3>) -> DVec3 {
    let length = hips.distance(top);
    let up = (top - hips).normalize_or(DVec3::Y);
    let plausible = |neck: &DVec3| (0.05..0.3).contains(&((*neck - top).dot(up) / length.max(1e-9)));
    joint.filter(plausible).unwrap_or(top + up * (0.12 * length))
}

/// The joint of the trunk nearest to its middle, moved to the middle's share of the way; half-way where none is near it.
fn middle(hips: DVec3, top: DVec3, chest: Option<DVec3>, spine: Option<DVec3>) -> DVec3 {
    let length = hips.distance(top);
    let share =
        |point: &DVec3| hips.distance(*point) / (hips.distance(*point) + point.distance(top)).max(1e-9);
    let near = |point: &&DVec3| (0.25..0.75).contains(&share(point)) && hips.distance(**point) < length * 1.2;
    let candidates = [chest, spine];
    let best = candidates
        .iter()
        .flatten()
        .filter(near)
        .min_by(|a, b| (share(a) - 0.5).abs().total_cmp(&(share(b) - 0.5).abs()));
    best.map_or(hips.midpoint(top), |best| {
        // The bend of the polyline hips, joint, top, carried over to its half-way point.
        let bend = *best - hips.lerp(top, share(best));
        hips.midpoint(top) + bend
    })
}
