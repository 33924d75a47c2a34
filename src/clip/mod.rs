//! Motion of one body: what readers produce, every later stage consumes and produces again.

pub mod acclaim;
pub mod builtin;
pub mod bvh;
pub mod contacts;
pub mod deepmimic;
pub mod derived;
pub mod facing;
pub mod file;
mod file_motion;
pub mod flight;
pub mod gait;
pub mod inspect;
pub mod measure;
pub mod note;
pub mod read;
mod repair;
pub mod retarget;
pub mod roles;
pub mod sample;
pub mod stationary;
pub mod text;
pub mod working;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DQuat, DVec3};

use crate::clip::contacts::annotated::AnnotatedContact;
use crate::index::{JointId, SourceFrame};
use crate::skeleton::{Pose, Skeleton};

/// Motion of one skeleton at a fixed rate, in the world's conventions (y up, metres), converted once where it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// Name for people: of the file, or of the generated clip.
    pub name: String,
    /// The body.
    pub skeleton: Arc<Skeleton>,
    /// Frames per second; frame k is at `k / fps` seconds.
    pub fps: f64,
    /// World position of the root in each frame, metres.
    pub root_positions: Vec<DVec3>,
    /// Rotations against the parent joint, all joints of frame 0, then of frame 1 …
    pub rotations: Vec<DQuat>,
    /// Joints that move against their parents; mostly empty.
    pub moving_offsets: Vec<MovingOffset>,
    /// Named frames.
    pub events: BTreeMap<String, SourceFrame>,
    /// Contacts that are stated, of hands and of feet; those of other feet are found.
    pub contacts: Vec<AnnotatedContact>,
    /// First and last frame worth using: all of them, but for a rest pose at frame 0 and what is no motion at the ends.
    pub usable: (SourceFrame, SourceFrame),
}

/// A joint whose offset changes from frame to frame.
#[derive(Clone, Debug, PartialEq)]
pub struct MovingOffset {
    /// Which joint; never the root.
    pub joint: JointId,
    /// From its parent in the parent's axes, metres, one a frame.
    pub offsets: Vec<DVec3>,
}

impl Clip {
    /// Number of frames.
    pub fn frame_count(&self) -> usize {
        self.root_positions.len()
    }

    /// Pose of one frame.
    ///
    /// # Panics
    /// If the clip has no such frame.
    pub fn pose(&self, frame: SourceFrame) -> Pose {
        let joints = self.skeleton.joints.len();
        let start = frame.as_usize() * joints;
        Pose {
            root: self.root_positions[frame.as_usize()],
            rotations: self.rotations[start..start + joints].to_vec(),
            offsets: self
                .moving_offsets
                .iter()
                .map(|moving| (moving.joint, moving.offsets[frame.as_usize()]))
                .collect(),
        }
    }

    /// A clip of the given poses (all of `skeleton`), without events and stated contacts.
    pub fn from_poses(name: &str, skeleton: Arc<Skeleton>, fps: f64, poses: &[Pose]) -> Self {
        let moving =
            poses.first().map_or(Vec::new(), |pose| pose.offsets.iter().map(|(joint, _)| *joint).collect());
        let moving_offsets = moving
            .into_iter()
            .map(|joint| MovingOffset {
                joint,
                offsets: poses.iter().map(|pose| pose.offset_of(joint).unwrap_or(DVec3::ZERO)).collect(),
            })
            .collect();
        Self {
            name: name.to_owned(),
            skeleton,
            fps,
            root_positions: poses.iter().map(|pose| pose.root).collect(),
            rotations: poses.iter().flat_map(|pose| pose.rotations.iter().copied()).collect(),
            moving_offsets,
            events: BTreeMap::new(),
            contacts: Vec::new(),
            usable: (SourceFrame(0), SourceFrame::from_usize(poses.len().saturating_sub(1))),
        }
    }
}
