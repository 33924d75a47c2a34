//! A clip tilted as a whole.

use glam::{DQuat, DVec3};

use crate::clip::Clip;

/// Why a clip cannot be tilted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SlopeError {
    /// A clip that ends where it begins.
    #[error("the clip ends {chord:.3} m from where it begins: it has no way ahead")]
    NoChord {
        /// Metres.
        chord: f64,
    },
    /// An angle that is none.
    #[error("a slope has an angle between -90 and 90 degrees, not {degrees}")]
    NoAngle {
        /// What was asked for.
        degrees: f64,
    },
}

/// Shorter chords have no direction, metres.
const SHORTEST_CHORD: f64 = 0.1;

/// `clip` turned by `angle` (radians, uphill positive) about the sideways axis across its chord, through the floor below its first root.
/// Cost: linear.
///
/// # Errors
/// [`SlopeError`] without chord, or for a wall.
pub fn tilted(clip: &Clip, angle: f64) -> Result<Clip, SlopeError> {
    if !angle.is_finite() || angle.abs() >= std::f64::consts::FRAC_PI_2 {
        return Err(SlopeError::NoAngle { degrees: angle.to_degrees() });
    }
    let [first, last] =
        [clip.usable.0, clip.usable.1].map(|frame| clip.root_positions[frame.as_usize()].with_y(0.0));
    let chord = last - first;
    if chord.length() < SHORTEST_CHORD {
        return Err(SlopeError::NoChord { chord: chord.length() });
    }
    let turn = DQuat::from_axis_angle(chord.normalize().cross(DVec3::Y), angle);
    let mut tilted = clip.clone();
    let joint_count = clip.skeleton.joints.len();
    for (frame, root) in tilted.root_positions.iter_mut().enumerate() {
        *root = first + turn * (*root - first);
        let own = &mut tilted.rotations[frame * joint_count];
        *own = turn * *own;
    }
    Ok(tilted)
}
