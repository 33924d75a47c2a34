//! A range of a clip on working frames: the rest data that editing reads.

use std::sync::Arc;

use crate::clip::Clip;
use crate::clip::contacts::FootContacts;
use crate::geometry::c64;
use crate::index::SourceFrame;
use crate::skeleton::Pose;

/// Seconds between working frames at rest, whatever the file's or the scene's rate.
pub const WORKING_STEP: f64 = 1.0 / 30.0;

/// A range of a clip, sampled every [`WORKING_STEP`] from its first frame on.
///
/// Working frame w is at the file's frame `first + w·fps/30`, a fraction where the rates do not divide.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkingClip {
    /// Name in the scene.
    pub name: String,
    /// Source of all poses, at its own rate.
    pub clip: Arc<Clip>,
    /// First file frame of the range.
    pub first: SourceFrame,
    /// Last file frame of the range, included.
    pub last: SourceFrame,
    /// What lies between the last working frame and the file's last frame of the range, in working frames: 0 ≤ overhang < 1.
    pub overhang: f64,
    /// Root on the ground plan at each working frame, metres; no smoothing.
    pub positions: Vec<c64>,
    /// Facing of the body at each working frame, radians, unwrapped from frame to frame.
    pub headings: Vec<f64>,
    /// Which points of the feet bear on the ground at each working frame.
    pub contacts: Vec<FootContacts>,
    /// Working frames in flight: nothing touches the ground.
    pub flight: Vec<bool>,
    /// Working frames of stationary stretches (standing, sitting).
    pub stationary: Vec<bool>,
}

impl WorkingClip {
    /// Number of working frames.
    pub fn frame_count(&self) -> usize {
        self.positions.len()
    }

    /// File frame (a fraction) shown at working frame `working` (a fraction).
    pub fn source_frame(&self, working: f64) -> f64 {
        f64::from(self.first.0) + working * self.clip.fps * WORKING_STEP
    }

    /// Working frame (a fraction) at which the file's frame `source` is shown.
    pub fn working_frame(&self, source: f64) -> f64 {
        (source - f64::from(self.first.0)) / (self.clip.fps * WORKING_STEP)
    }

    /// Pose at working frame `working`, a fraction: sampled at the file's own rate.
    pub fn pose(&self, working: f64) -> Pose {
        self.clip.sample(self.source_frame(working))
    }
}

impl WorkingClip {
    /// Stub.
    pub fn facing(&self, working: f64) -> f64 {
        let (a, b, s) = (working.floor() as usize, working.ceil() as usize, working.fract());
        self.headings[a] * (1.0 - s) + self.headings[b.min(self.headings.len() - 1)] * s
    }
}
