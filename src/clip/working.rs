//! A range of a clip on working frames: the rest data that editing reads.

use std::sync::Arc;

use crate::clip::Clip;
use crate::clip::contacts::annotated::apply;
use crate::clip::contacts::raised::{RaisedGround, RaisedSettings, raise};
use crate::clip::contacts::{ContactSettings, Contacts, foot_contacts, sampled_frames};
use crate::clip::derived::Origin;
use crate::clip::facing::{facing, headings, turn_about_up};
use crate::clip::flight::{FlightSettings, flight};
use crate::clip::stationary::{StationarySettings, stationary};
use crate::geometry::{c64, lerp_angle, plan_of, wrap};
use crate::index::{SourceFrame, floor_index};
use crate::skeleton::{JointFrame, Pose};

/// Seconds between working frames at rest, whatever the file's or the scene's rate.
pub const WORKING_STEP: f64 = 1.0 / 30.0;

/// Ranges shorter than this take the floors of the whole clip: they may not touch the ground at all. Working frames, 1 s.
const SHORTEST_WITH_OWN_FLOOR: usize = 30;

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
    /// Which points of the feet, and stated ones of the hands, bear at each working frame.
    pub contacts: Vec<Contacts>,
    /// Where the ground under a foot is not the floor.
    pub grounds: Vec<RaisedGround>,
    /// Working frames in flight: nothing touches the ground.
    pub flight: Vec<bool>,
    /// Working frames of stationary stretches (standing, sitting).
    pub stationary: Vec<bool>,
    /// What the clip was before it was edited, where it is made of others.
    pub origin: Option<Arc<Origin>>,
}

impl WorkingClip {
    /// Rest data of the file frames `first` to `last` of `clip`; `⌊(last − first)·30/fps⌋ + 1` working frames.
    /// Cost: linear in frames times joints.
    ///
    /// # Panics
    /// If the clip has no such frames.
    pub fn new(name: &str, clip: Arc<Clip>, first: SourceFrame, last: SourceFrame) -> Self {
        assert!(
            first <= last && last.as_usize() < clip.frame_count(),
            "the range of a clip is checked where it enters"
        );
        let step = clip.fps * WORKING_STEP;
        let poses = sampled_frames(&clip, first, last, step);
        let is_short = poses.len() < SHORTEST_WITH_OWN_FLOOR;
        let whole = is_short.then(|| sampled_frames(&clip, clip.usable.0, clip.usable.1, step));
        let floor_poses = whole.as_ref().unwrap_or(&poses);
        let skeleton = &clip.skeleton;
        let positions: Vec<c64> = poses.iter().map(|frames| plan_of(frames[0].position)).collect();
        let (contacts, grounds) = contacts(&clip, (first, last), &poses, floor_poses);
        let overhang = f64::from(last.0 - first.0) / step - (poses.len() - 1) as f64;
        Self {
            name: name.to_owned(),
            first,
            last,
            overhang: overhang.max(0.0),
            headings: headings(skeleton, &poses),
            flight: flight(skeleton, &poses, floor_poses, &contacts, &FlightSettings::default()),
            stationary: stationary(&positions, &contacts, &StationarySettings::default()),
            positions,
            contacts,
            grounds,
            origin: None,
            clip,
        }
    }

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

    /// Facing of the pose shown at working frame `working`, a fraction, radians, on the branch nearest to
    /// [`Self::headings`]; equal to them at whole frames, held at both ends.
    ///
    /// Where the hips show no facing, the heading of the nearest whole frame and the root's turn since.
    pub fn facing(&self, working: f64) -> f64 {
        let last = self.frame_count() - 1;
        let working = working.clamp(0.0, last as f64 + self.overhang);
        let nearest = floor_index(working + 0.5).min(last);
        if (working - nearest as f64).abs() < 1e-9 {
            return self.headings[nearest];
        }
        let skeleton = &self.clip.skeleton;
        let frames = skeleton.forward_kinematics(&self.pose(working));
        if let Some(shown) = facing(skeleton, &frames) {
            let lower = floor_index(working).min(last);
            let upper = (lower + 1).min(last);
            let near = lerp_angle(self.headings[lower], self.headings[upper], working - lower as f64);
            return near + wrap(shown - near);
        }
        let at_nearest = self.pose(nearest as f64).rotations[0];
        self.headings[nearest] + turn_about_up(frames[0].rotation * at_nearest.inverse())
    }
}

/// What bears at each working frame of the file frames `first` to `last`, on the floor, on something higher, and as stated.
fn contacts(
    clip: &Clip,
    (first, last): (SourceFrame, SourceFrame),
    poses: &[Vec<JointFrame>],
    floor_poses: &[Vec<JointFrame>],
) -> (Vec<Contacts>, Vec<RaisedGround>) {
    let settings = ContactSettings::default();
    let mut contacts = foot_contacts(&clip.skeleton, poses, floor_poses, &settings);
    let raised = (&RaisedSettings::default(), &settings);
    let mut grounds = raise(&clip.skeleton, (poses, floor_poses), &mut contacts, raised);
    let nearest = |frame: SourceFrame| {
        let working = (f64::from(frame.0) - f64::from(first.0)) / (clip.fps * WORKING_STEP);
        floor_index((working + 0.5).max(0.0)).min(poses.len() - 1)
    };
    let span = |from: SourceFrame, to: SourceFrame| {
        (from <= last && to >= first).then(|| (nearest(from), nearest(to)))
    };
    let spans: Vec<_> = clip.contacts.iter().map(|own| span(own.from, own.to)).collect();
    apply(&clip.contacts, &spans, &mut contacts);
    grounds.retain(|ground| !clip.contacts.iter().any(|own| own.point == ground.point));
    (contacts, grounds)
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};

    use super::*;
    use crate::clip::facing::REST_HEADING;
    use crate::geometry::yaw;
    use crate::skeleton::{Axis, Joint, Skeleton};

    /// A root that goes along +z at 1 m/s and turns left at 2 rad/s.
    fn turning(fps: f64, frames: u32) -> Arc<Clip> {
        let root = Joint {
            name: "Hips".to_owned(),
            parent: None,
            offset: DVec3::ZERO,
            end_site: None,
            rotation_order: [Axis::Z, Axis::X, Axis::Y],
            role: None,
        };
        let skeleton = Arc::new(Skeleton { joints: vec![root] });
        let poses: Vec<Pose> = (0..frames)
            .map(|frame| Pose {
                root: DVec3::Z * (f64::from(frame) / fps),
                rotations: vec![yaw(2.0 * f64::from(frame) / fps) * DQuat::IDENTITY],
                offsets: Vec::new(),
            })
            .collect();
        Arc::new(Clip::from_poses("turning", skeleton, fps, &poses))
    }

    #[test]
    fn working_frames_divide_the_range_and_the_rest_hangs_over() {
        // (fps, first, last) and the working frames and overhang they make
        let cases = [
            (120.0, 0, 8, 3, 0.0),
            (120.0, 1, 7, 2, 0.5),
            (24.0, 0, 4, 6, 0.0),
            (24.0, 0, 3, 4, 0.75),
            (30.0, 5, 5, 1, 0.0),
        ];
        for (fps, first, last, count, overhang) in cases {
            let working = WorkingClip::new("w", turning(fps, 12), SourceFrame(first), SourceFrame(last));
            assert_eq!(working.frame_count(), count, "{fps} {first} {last}");
            assert!((working.overhang - overhang).abs() < 1e-12);
            let end = (count - 1) as f64 + working.overhang;
            assert!((working.source_frame(end) - f64::from(last)).abs() < 1e-9);
            assert!((working.working_frame(f64::from(last)) - end).abs() < 1e-9);
        }
    }

    #[test]
    fn facing_follows_the_turn_between_frames_and_past_half_a_turn() {
        let working = WorkingClip::new("w", turning(24.0, 100), SourceFrame(0), SourceFrame(99));
        let end = (working.frame_count() - 1) as f64 + working.overhang;
        for step in 0..200 {
            let at = end * f64::from(step) / 199.0;
            let expected = REST_HEADING + 2.0 * at * WORKING_STEP;
            assert!((working.facing(at) - expected).abs() < 1e-9, "{at}");
        }
        assert_eq!(working.facing(7.0), working.headings[7]);
        assert!((working.positions[30] - c64::new(0.0, -1.0)).norm() < 1e-9);
    }
}
