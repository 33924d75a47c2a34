//! The humanoid of DeepMimic: its joints, and where their numbers stand in a row.

use glam::{DQuat, DVec3};

use crate::clip::roles::assign_roles;
use crate::index::JointId;
use crate::skeleton::{Axis, Joint, Skeleton};

/// Numbers of a row: duration, place of the root, rotations.
pub(super) const ROW: usize = 44;

/// Column of the root's x; y and z follow.
pub(super) const FIRST_PLACE: usize = 1;

/// A joint of the humanoid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) name: &'static str,
    /// Of its first number in a row.
    pub(super) column: usize,
    parent: Option<usize>,
    /// From the parent, metres: x ahead, y up, z to the right.
    offset: [f64; 3],
    end_site: Option<[f64; 3]>,
    /// Turns about z only, by one angle; the others have a quaternion.
    pub(super) is_hinge: bool,
}

impl Part {
    const fn ball(name: &'static str, column: usize, parent: usize, offset: [f64; 3]) -> Self {
        Self { name, column, parent: Some(parent), offset, end_site: None, is_hinge: false }
    }

    const fn hinge(name: &'static str, column: usize, parent: usize, offset: [f64; 3]) -> Self {
        Self { is_hinge: true, ..Self::ball(name, column, parent, offset) }
    }

    const fn ending(self, end_site: [f64; 3]) -> Self {
        Self { end_site: Some(end_site), ..self }
    }

    /// Columns of its numbers in a row.
    pub(super) const fn columns(&self) -> std::ops::Range<usize> {
        self.column..self.column + if self.is_hinge { 1 } else { 4 }
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

/// All joints depth first, as other formats nest them; rows have the legs before the arms.
pub(super) const BODY: [Part; 13] = [
    Part { name: "root", column: 4, parent: None, offset: [0.0; 3], end_site: None, is_hinge: false },
    Part::ball("chest", 8, 0, [0.0, 0.236_151, 0.0]),
    Part::ball("neck", 12, 1, [0.0, 0.223_894, 0.0]).ending(CROWN),
    Part::ball("right_shoulder", 25, 1, [-0.024_05, 0.243_5, SHOULDER]),
    Part::hinge("right_elbow", 29, 3, ELBOW).ending(WRIST),
    Part::ball("left_shoulder", 39, 1, [-0.024_05, 0.243_5, -SHOULDER]),
    Part::hinge("left_elbow", 43, 5, ELBOW).ending(WRIST),
    Part::ball("right_hip", 16, 0, [0.0, 0.0, HIP]),
    Part::hinge("right_knee", 20, 7, KNEE),
    Part::ball("right_ankle", 21, 8, ANKLE).ending(TOE),
    Part::ball("left_hip", 30, 0, [0.0, 0.0, -HIP]),
    Part::hinge("left_knee", 34, 10, KNEE),
    Part::ball("left_ankle", 35, 11, ANKLE).ending(TOE),
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
