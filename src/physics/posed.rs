//! Where joints and links are in all frames of a clip.

use glam::DVec3;

use crate::clip::Clip;
use crate::index::JointId;
use crate::physics::body_model::BodyModel;
use crate::physics::derivatives::Lanes;
use crate::skeleton::JointFrame;

/// World frames of all joints in every frame of a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct PosedClip {
    /// Frames per second.
    pub fps: f64,
    /// Joints of the skeleton; at least one.
    pub joint_count: usize,
    /// All joints of frame 0, then of frame 1 …
    pub joints: Vec<JointFrame>,
}

impl PosedClip {
    /// The whole of `clip`. Cost: linear in frames times joints; one allocation.
    pub fn of(clip: &Clip) -> Self {
        let joint_count = clip.skeleton.joints.len();
        let mut posed = Self { fps: clip.fps, joint_count, joints: Vec::new() };
        posed.pose_again(clip);
        posed
    }

    /// [`Self::of`] of a clip with the same skeleton, in place.
    pub fn pose_again(&mut self, clip: &Clip) {
        self.joints.clear();
        self.joints.reserve(clip.rotations.len());
        for (frame, rotations) in clip.rotations.chunks_exact(self.joint_count).enumerate() {
            let start = self.joints.len();
            for (index, (joint, rotation)) in clip.skeleton.joints.iter().zip(rotations).enumerate() {
                let own = match joint.parent {
                    None => JointFrame { position: clip.root_positions[frame], rotation: *rotation },
                    Some(parent) => {
                        let above = self.joints[start + parent.as_usize()];
                        let offset = offset(clip, index, frame).unwrap_or(joint.offset);
                        JointFrame {
                            position: above.position + above.rotation * offset,
                            rotation: above.rotation * *rotation,
                        }
                    }
                };
                self.joints.push(own);
            }
        }
    }

    /// Number of frames.
    pub fn frame_count(&self) -> usize {
        self.joints.len() / self.joint_count
    }

    /// World frames of all joints in one frame.
    ///
    /// # Panics
    /// If the clip has no such frame.
    pub fn frame(&self, frame: usize) -> &[JointFrame] {
        &self.joints[frame * self.joint_count..(frame + 1) * self.joint_count]
    }

    /// World frame of `joint` in one frame.
    ///
    /// # Panics
    /// If there is no such joint or frame.
    pub fn at(&self, frame: usize, joint: JointId) -> &JointFrame {
        &self.joints[frame * self.joint_count + joint.as_usize()]
    }

    /// Seconds from one frame to the next.
    pub fn step(&self) -> f64 {
        1.0 / self.fps
    }
}

fn offset(clip: &Clip, joint: usize, frame: usize) -> Option<DVec3> {
    let moving = clip.moving_offsets.iter().find(|moving| moving.joint.as_usize() == joint)?;
    Some(moving.offsets[frame])
}

/// World places of the links' centres of mass, metres: lanes x, y, z of the first link, then of the second …
/// Cost: linear in frames times links.
pub fn link_places(body: &BodyModel, posed: &PosedClip) -> Lanes {
    let frame_count = posed.frame_count();
    let mut lanes = Lanes::zeros(3 * body.links.len(), frame_count);
    for (index, link) in body.links.iter().enumerate() {
        let [x, y, z] = lanes.vector_mut(index);
        for frame in 0..frame_count {
            let joint = posed.at(frame, link.joint);
            let place = joint.position + joint.rotation * link.com;
            (x[frame], y[frame], z[frame]) = (place.x, place.y, place.z);
        }
    }
    lanes
}

/// World place of the whole body's centre of mass in each frame, metres, of [`link_places`].
pub fn centers_of_mass(body: &BodyModel, places: &Lanes) -> Vec<DVec3> {
    let mut centers = vec![DVec3::ZERO; places.frame_count];
    for (index, link) in body.links.iter().enumerate() {
        let share = link.mass / body.mass;
        for (frame, center) in centers.iter_mut().enumerate() {
            *center += share * places.vector(index, frame);
        }
    }
    centers
}
