//! Other rates, units, rotation orders and names, for files that open where people work.

use std::sync::Arc;

use crate::clip::Clip;
use crate::export::bvh::names::{JointNames, joint_names};
use crate::export::bvh::to_bvh;
use crate::index::floor_index;
use crate::skeleton::{Axis, Pose, Skeleton};

/// How a clip is written. The default changes nothing: its own rate, metres, its own orders and names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhOptions {
    /// Frames per second, positive; `None`: the clip's own. Frames are sampled from the clip every `1 / fps` from its
    /// first frame on, up to the last that it still reaches; what is named or usable in the clip is not in a BVH file.
    pub fps: Option<f64>,
    /// Metres a file unit, positive. Ten decimals of a unit are written.
    pub unit_to_m: f64,
    /// Order of the rotation channels of all joints; `None`: of each as in the clip.
    pub rotation_order: Option<[Axis; 3]>,
    /// What joints are called.
    pub names: JointNames,
}

impl Default for BvhOptions {
    fn default() -> Self {
        Self { fps: None, unit_to_m: 1.0, rotation_order: None, names: JointNames::AsRead }
    }
}

/// The clip as the text of a BVH file, y up. Cost: linear in the frames written.
///
/// # Panics
/// If the clip has no frames and a rate is asked for.
pub fn to_bvh_with(clip: &Clip, options: &BvhOptions) -> String {
    if *options == BvhOptions::default() {
        return to_bvh(clip);
    }
    let resampled = options.fps.filter(|fps| *fps != clip.fps).map(|fps| resampled(clip, fps));
    to_bvh(&converted(resampled.as_ref().unwrap_or(clip), options))
}

/// The clip at another rate.
fn resampled(clip: &Clip, fps: f64) -> Clip {
    /// Rounding of `frames · rate / rate`: a frame as near to the end as this is the last.
    const WHOLE_FRAME: f64 = 1e-9;
    let step = clip.fps / fps;
    let last = floor_index((clip.frame_count() - 1) as f64 / step + WHOLE_FRAME);
    let poses: Vec<Pose> = (0..=last).map(|frame| clip.sample(frame as f64 * step)).collect();
    Clip::from_poses(&clip.name, clip.skeleton.clone(), fps, &poses)
}

/// The clip with its lengths in file units, and with the orders and names of the file.
fn converted(clip: &Clip, options: &BvhOptions) -> Clip {
    let unit = options.unit_to_m;
    let mut joints = clip.skeleton.joints.clone();
    for (joint, name) in joints.iter_mut().zip(joint_names(&clip.skeleton, options.names)) {
        joint.name = name;
        joint.offset /= unit;
        joint.end_site = joint.end_site.map(|end| end / unit);
        joint.rotation_order = options.rotation_order.unwrap_or(joint.rotation_order);
    }
    let mut converted = Clip { skeleton: Arc::new(Skeleton { joints }), ..clip.clone() };
    let moving = converted.moving_offsets.iter_mut().flat_map(|moving| &mut moving.offsets);
    for length in converted.root_positions.iter_mut().chain(moving) {
        *length /= unit;
    }
    converted
}
