//! Whether what the passes of a touch-up are given fits together.

use crate::clip::Clip;
use crate::physics::stages::Stages;

/// Why a pass has nothing to work on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InputError {
    /// Stages of another motion.
    #[error("the stages are of {stages} frames, the motion has {frames}")]
    OtherStages {
        /// Frames of the stages.
        stages: usize,
        /// Frames of the motion.
        frames: usize,
    },
    /// A motion or a setting that is no number.
    #[error("{what} must be a number")]
    NotFinite {
        /// Which.
        what: &'static str,
    },
}

/// Checks that `stages` are of as many frames as `clip`, and all of that is numbers.
pub(super) fn check_motion(clip: &Clip, stages: &Stages) -> Result<(), InputError> {
    let frames = clip.frame_count();
    if stages.phases.len() != frames {
        return Err(InputError::OtherStages { stages: stages.phases.len(), frames });
    }
    let places = clip.root_positions.iter().all(|place| place.is_finite());
    let offsets =
        clip.moving_offsets.iter().flat_map(|moving| &moving.offsets).all(|offset| offset.is_finite());
    check_numbers(&[
        (places && offsets, "every place"),
        (clip.rotations.iter().all(|rotation| rotation.is_finite()), "every rotation"),
        (clip.fps.is_finite() && clip.fps > 0.0, "the frame rate"),
    ])
}

/// The first of what is not fine is an error.
pub(super) fn check_numbers(are_fine: &[(bool, &'static str)]) -> Result<(), InputError> {
    match are_fine.iter().find(|(is_fine, _)| !is_fine) {
        Some((_, what)) => Err(InputError::NotFinite { what }),
        None => Ok(()),
    }
}
