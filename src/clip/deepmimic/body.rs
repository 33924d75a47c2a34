//! The humanoid of DeepMimic: its joints, and where their numbers stand in a row.

use glam::{DQuat, DVec3};

use crate::clip::roles::assign_roles;
use crate::index::JointId;
use crate::skeleton::{Axis, Joint, Skeleton};

/// Numbers of a row: duration, place of the root, rotations.
pub(super) const ROW: usize = 44;

/// Column of the root's x; y and z follow.
pub(super) const FIRST_PLACE: usize = 1;

/// Column of the first rotation.
pub(super) const FIRST_ROTATION: usize = 4;

/// A joint of the humanoid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) name: &'static str,
    parent: Option<usize>,
    /// From the parent, metres: x ahead, y up, z to the right.
    offset: [f64; 3],
    end_site: Option<[f64; 3]>,
    /// Turns about z only, by one angle; the others have a quaternion.
    pub(super) is_hinge: bool,
}

impl Part {
    const fn ball(name: &'static str, parent: usize, offset: [f64; 3]) -> Self {
        Self { name, parent: Some(parent), offset, end_site: None, is_hinge: false }
    }

    const fn hinge(name: &'static str, parent: usize, offset: [f64; 3]) -> Self {
        Self { is_hinge: true, ..Self::ball(name, parent, offset) }
    }

    const fn ending(self, end_site: [f64; 3]) -> Self {
        Self { end_site: Some(end_site), ..self }
    }

    /// Numbers in a row.
    pub(super) const fn width(&self) -> usize {
        if self.is_hinge { 1 } else { 4 }
    }
}

/// Hips and shoulders from the middle, metres.
const HIP: f64 = 0.084_887;
const SHOULDER: f64 = 0.183_11;

const KNEE: [f64; 3] = [0.0, -0.421_546, 0.0];
const ANKLE: [f64; 3] = [0.0, -0.409_87, 0.0];
const ELBOW: [f64; 3] = [0.0, -0.274_788, 0.0];
/// The wrists are fixed: ends of the forearms.
const WRIST: [f64; 3] = [0.0, -0.258_947, 0.0];
/// Front edge of the sole below the ankle: the foot is a box 0.177 m long and 0.055 m high about (0.045, −0.0225, 0).
const TOE: [f64; 3] = [0.1335, -0.05, 0.0];
/// Top of the head above the neck: a ball of 0.205 m about (0, 0.175, 0).
const CROWN: [f64; 3] = [0.0, 0.2775, 0.0];

/// All joints in the order of a row, parents before children.
pub(super) const BODY: [Part; 13] = [
    Part { name: "root", parent: None, offset: [0.0; 3], end_site: None, is_hinge: false },
    Part::ball("chest", 0, [0.0, 0.236_151, 0.0]),
    Part::ball("neck", 1, [0.0, 0.223_894, 0.0]).ending(CROWN),
    Part::ball("right_hip", 0, [0.0, 0.0, HIP]),
    Part::hinge("right_knee", 3, KNEE),
    Part::ball("right_ankle", 4, ANKLE).ending(TOE),
    Part::ball("right_shoulder", 1, [-0.024_05, 0.243_5, SHOULDER]),
    Part::hinge("right_elbow", 6, ELBOW).ending(WRIST),
    Part::ball("left_hip", 0, [0.0, 0.0, -HIP]),
    Part::hinge("left_knee", 8, KNEE),
    Part::ball("left_ankle", 9, ANKLE).ending(TOE),
    Part::ball("left_shoulder", 1, [-0.024_05, 0.243_5, -SHOULDER]),
    Part::hinge("left_elbow", 11, ELBOW).ending(WRIST),
];

/// The humanoid in metres, with roles.
pub(super) fn skeleton() -> Skeleton {
    let mut joints: Vec<Joint> = BODY
        .iter()
        .map(|part| Joint {
            name: part.name.to_owned(),
            parent: part.parent.map(JointId::from_usize),
            offset: part.offset.into(),
            end_site: part.end_site.map(DVec3::from_array),
            rotation_order: [Axis::Z, Axis::X, Axis::Y],
            role: None,
        })
        .collect();
    assign_roles(&mut joints);
    Skeleton { joints }
}

/// Lengths of a quaternion outside these are no slip of rounding or editing; files have 0.8 to 1.1.
const LENGTHS: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// Rotation of `part` by its numbers of a row, and how long its quaternion was.
///
/// # Errors
/// The length, if it is far from 1.
pub(super) fn rotation(part: &Part, numbers: &[f64]) -> Result<(DQuat, f64), f64> {
    if part.is_hinge {
        // Whole turns add nothing but rounding.
        return Ok((DQuat::from_rotation_z(numbers[0] % std::f64::consts::TAU), 1.0));
    }
    let quaternion = DQuat::from_xyzw(numbers[1], numbers[2], numbers[3], numbers[0]);
    let length = quaternion.length();
    if LENGTHS.contains(&length) { Ok((quaternion.normalize(), length)) } else { Err(length) }
}
