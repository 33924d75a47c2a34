//! Poses between frames.

use glam::DVec3;

use crate::clip::Clip;
use crate::geometry::slerp;
use crate::index::{SourceFrame, floor_index};
use crate::skeleton::Pose;

/// A frame this near to a whole one is that one: rounding of `first + w·fps/30`.
const WHOLE_FRAME: f64 = 1e-9;

impl Clip {
    /// Pose at the fractional frame `frame`, held at both ends: positions linear, rotations by slerp on the shorter arc;
    /// exact at whole frames (to 1e-9 of a frame).
    ///
    /// # Panics
    /// If the clip has no frames.
    pub fn sample(&self, frame: f64) -> Pose {
        let (lower, share) = self.bracket(frame);
        let mut pose = self.pose(lower);
        if share == 0.0 {
            return pose;
        }
        let upper = self.pose(SourceFrame(lower.0 + 1));
        pose.root = pose.root.lerp(upper.root, share);
        for (from, to) in pose.rotations.iter_mut().zip(&upper.rotations) {
            *from = slerp(*from, *to, share);
        }
        for ((_, from), (_, to)) in pose.offsets.iter_mut().zip(&upper.offsets) {
            *from = from.lerp(*to, share);
        }
        pose
    }

    /// World position of the root at the fractional frame `frame`, as [`Self::sample`] has it, metres.
    pub fn root_at(&self, frame: f64) -> DVec3 {
        let (lower, share) = self.bracket(frame);
        let from = self.root_positions[lower.as_usize()];
        if share == 0.0 {
            return from;
        }
        from.lerp(self.root_positions[lower.as_usize() + 1], share)
    }

    /// Whole frame at or before `frame` and the share of the way to the next, 0 ≤ share < 1; 0 at both ends.
    fn bracket(&self, frame: f64) -> (SourceFrame, f64) {
        let last = self.frame_count() - 1;
        let whole = frame.round();
        if (frame - whole).abs() <= WHOLE_FRAME || frame.is_nan() || frame <= 0.0 {
            return (SourceFrame::from_usize(floor_index(whole).min(last)), 0.0);
        }
        let lower = floor_index(frame);
        if lower >= last {
            return (SourceFrame::from_usize(last), 0.0);
        }
        (SourceFrame::from_usize(lower), frame - frame.floor())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DQuat;

    use super::*;
    use crate::skeleton::{Axis, Joint, Skeleton};

    fn turning_clip() -> Clip {
        let skeleton = Arc::new(Skeleton {
            joints: vec![Joint {
                name: "Hips".to_owned(),
                parent: None,
                offset: DVec3::ZERO,
                end_site: None,
                rotation_order: [Axis::Z, Axis::X, Axis::Y],
                role: None,
            }],
        });
        let poses: Vec<Pose> = (0..4)
            .map(|k| Pose {
                root: DVec3::X * f64::from(k),
                // Alternating signs: the same rotations, the long way round for a naive blend.
                rotations: vec![
                    DQuat::from_rotation_y(0.5 * f64::from(k)) * if k % 2 == 0 { 1.0 } else { -1.0 },
                ],
                offsets: Vec::new(),
            })
            .collect();
        Clip::from_poses("turn", skeleton, 30.0, &poses)
    }

    #[test]
    fn whole_frames_are_exact_even_when_rounding_missed_them() {
        let clip = turning_clip();
        assert_eq!(clip.sample(2.0), clip.pose(SourceFrame(2)));
        assert_eq!(clip.sample(2.0 - 1e-12), clip.pose(SourceFrame(2)));
        assert_eq!(clip.sample(-3.0), clip.pose(SourceFrame(0)));
        assert_eq!(clip.sample(99.5), clip.pose(SourceFrame(3)));
        assert_eq!(clip.sample(f64::NAN), clip.pose(SourceFrame(0)));
    }

    #[test]
    fn between_frames_rotations_take_the_shorter_arc() {
        let clip = turning_clip();
        let pose = clip.sample(1.25);
        assert!((pose.root.x - 1.25).abs() < 1e-15);
        assert_eq!(pose.root, clip.root_at(1.25));
        let expected = DQuat::from_rotation_y(0.625);
        assert!(pose.rotations[0].dot(expected).abs() > 1.0 - 1e-14);
    }
}
