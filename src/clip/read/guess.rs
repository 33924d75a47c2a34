//! What a file does not say: its unit, which way is up, whether frame 0 belongs to the motion.

use glam::DVec3;

use super::Up;
use crate::clip::Clip;
use crate::clip::contacts::percentile;
use crate::clip::roles::is_helper;
use crate::geometry::log;
use crate::index::{JointId, SourceFrame};
use crate::skeleton::{JointRole, Skeleton};

/// Metres per file unit that files come in: metres, decimetres, CMU's Acclaim unit (an inch of 0.45), inches, centimetres.
const UNITS: [f64; 5] = [1.0, 0.1, 0.0254 / 0.45, 0.0254, CENTIMETRE];

/// Metres.
const CENTIMETRE: f64 = 0.01;

/// Metres per unit of the rig with buttock joints that every CMU subject was put on, about a centimetre; measured.
const BUTTOCK_RIG_UNIT: f64 = 0.0103;

/// Length of an adult's leg from hip joint to ankle, metres; 0.75 to 0.9 in most captures.
const LEG_LENGTH: f64 = 0.82;

/// Distance between the lowest and the highest joint of an adult, metres, for skeletons without legs.
const JOINT_EXTENT: f64 = 1.4;

/// Rate of film and what is rounded to it, frames per second.
const FILM_RATES: std::ops::Range<f64> = 23.9..24.1;

/// Whether a rate is what programs write when they are not told one.
pub(super) fn is_film_rate(fps: f64) -> bool {
    FILM_RATES.contains(&fps)
}

/// Whether the skeleton is the 43-joint rig whose rest pose bleeds into the first frames.
pub(super) fn is_buttock_rig(skeleton: &Skeleton) -> bool {
    skeleton.joint_named("lButtock").is_some() && skeleton.joint_named("rButtock").is_some()
}

/// Metres per file unit from the size of the body, in file units: the unit in which its legs are nearest to an adult's.
/// `None` where the skeleton has no size.
pub(super) fn unit_to_m(skeleton: &Skeleton) -> Option<f64> {
    let (size, expected) = match leg_length(skeleton) {
        Some(leg) => (leg, LEG_LENGTH),
        None => (rest_extent(skeleton).max_element(), JOINT_EXTENT),
    };
    if size <= 0.0 {
        return None;
    }
    let mismatch = |unit: &f64| (unit * size / expected).ln().abs();
    let nearest = UNITS.into_iter().min_by(|a, b| mismatch(a).total_cmp(&mismatch(b)))?;
    let is_rig_unit = nearest == CENTIMETRE && is_buttock_rig(skeleton);
    Some(if is_rig_unit { BUTTOCK_RIG_UNIT } else { nearest })
}

/// Length of the bones from the hip to the ankle, the longer leg; whatever the rest pose.
fn leg_length(skeleton: &Skeleton) -> Option<f64> {
    let leg = |hip: JointRole, foot: JointRole| {
        let hip = skeleton.joint_of(hip)?;
        let mut joint = skeleton.joint_of(foot)?;
        let mut length = 0.0;
        while joint != hip {
            let bone = &skeleton.joints[joint.as_usize()];
            length += bone.offset.length();
            joint = bone.parent?;
        }
        Some(length)
    };
    let left = leg(JointRole::LeftHip, JointRole::LeftFoot);
    let right = leg(JointRole::RightHip, JointRole::RightFoot);
    left.into_iter().chain(right).max_by(f64::total_cmp).filter(|length| *length > 0.0)
}

/// Sizes of bodies from the lowest to the highest joint, metres: children to giants, arms stretched sideways or upwards.
const BODY_SIZES: std::ops::Range<f64> = 0.5..2.8;

/// Largest extent of a body at rest, metres, where it has a size that bodies do not have.
pub(super) fn odd_size(skeleton: &Skeleton) -> Option<f64> {
    let extent = rest_extent(skeleton).max_element();
    (!BODY_SIZES.contains(&extent)).then_some(extent)
}

/// Size of the box around all joints at rest.
fn rest_extent(skeleton: &Skeleton) -> DVec3 {
    let frames = skeleton.forward_kinematics(&skeleton.rest_pose());
    let places = || {
        frames
            .iter()
            .zip(&skeleton.joints)
            .filter(|(_, joint)| !is_helper(&joint.name))
            .map(|(frame, _)| frame.position)
    };
    let low = places().fold(DVec3::INFINITY, DVec3::min);
    let high = places().fold(DVec3::NEG_INFINITY, DVec3::max);
    high - low
}

/// Axis that points up in the file: y, unless the body at rest stands along z and so does the motion (or the motion says
/// nothing), or the motion stands along z at the height of its legs. `clip` is in the file's axes and units.
pub(super) fn up(clip: &Clip) -> Up {
    let skeleton = &clip.skeleton;
    let rest = upright(skeleton, &[skeleton.rest_pose()]);
    let step = (clip.frame_count() / 20).max(1);
    let first = usize::from(clip.frame_count() > 1);
    let poses: Vec<_> = (first..clip.frame_count())
        .step_by(step)
        .map(|frame| clip.pose(SourceFrame::from_usize(frame)))
        .collect();
    let moving = upright(skeleton, &poses);
    let hips = poses.iter().map(|pose| pose.root).sum::<DVec3>() / poses.len().max(1) as f64;
    let leg = leg_length(skeleton).unwrap_or(f64::INFINITY);
    let hips_say_z = (0.6..1.6).contains(&(hips.z / leg)) && !(0.6..1.6).contains(&(hips.y / leg));
    match (rest, moving) {
        (Some(Up::Z), Some(Up::Z) | None) => Up::Z,
        (_, Some(Up::Z)) if hips_say_z => Up::Z,
        _ => Up::Y,
    }
}

/// Axis along which the body stands: from the feet to the head, on average over `poses`; without roles, the axis of its
/// largest extent at rest. `None` where neither y nor z stands out.
fn upright(skeleton: &Skeleton, poses: &[crate::skeleton::Pose]) -> Option<Up> {
    let feet = [JointRole::LeftFoot, JointRole::RightFoot].map(|role| skeleton.joint_of(role));
    let top = [JointRole::Head, JointRole::Neck, JointRole::Chest, JointRole::Spine]
        .into_iter()
        .find_map(|role| skeleton.joint_of(role));
    let ([Some(left), Some(right)], Some(top)) = (feet, top) else {
        let extent = rest_extent(skeleton);
        return (extent.z > 2.0 * extent.x.max(extent.y)).then_some(Up::Z);
    };
    let mut along = DVec3::ZERO;
    for pose in poses {
        let frames = skeleton.forward_kinematics(pose);
        let place = |joint: JointId| frames[joint.as_usize()].position;
        along += place(top) - 0.5 * (place(left) + place(right));
    }
    let along = along.normalize_or_zero();
    // cos 45°: within 45° of an axis.
    if along.z > 0.7072 {
        Some(Up::Z)
    } else if along.y > 0.7072 {
        Some(Up::Y)
    } else {
        None
    }
}

/// How frame 0 goes over into frame 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Start {
    /// Like the frames after it.
    Smooth,
    /// Frame 0 is a rest pose, all joints turned alike, and the motion starts elsewhere.
    RestPose,
    /// Frame 0 is no rest pose, but the body jumps.
    Jump,
}

/// Judges frame 0 by the mean turn of all joints from frame to frame.
///
/// A rest pose is one of unturned joints that the body leaves in a jump, perhaps blended over a few frames, or any pose
/// that it leaves so fast that no body could.
pub(super) fn start(clip: &Clip) -> Start {
    if clip.frame_count() < 3 {
        return Start::Smooth;
    }
    let jump = turn_between(clip, 0);
    let later: Vec<f64> =
        (1..clip.frame_count() - 1).take(30).map(|frame| turn_between(clip, frame)).collect();
    let usual = percentile(later.clone(), 0.5);
    let largest = later.iter().copied().fold(0.0, f64::max);
    let leaves_rest = rest_turn(clip) < REST_TURN && jump > LEAST_JUMP && jump > JUMP_RATIO * usual;
    if leaves_rest || (jump > IMPOSSIBLE_JUMP && jump > 2.0 * JUMP_RATIO * largest) {
        Start::RestPose
    } else if jump > LEAST_JUMP && jump > JUMP_RATIO * largest {
        Start::Jump
    } else {
        Start::Smooth
    }
}

/// A smaller mean turn of the joints from frame 0 to 1 is motion, radians.
const LEAST_JUMP: f64 = 0.05;
/// A larger one is none, radians.
const IMPOSSIBLE_JUMP: f64 = 0.2;
/// A jump is this many times the steps after it.
const JUMP_RATIO: f64 = 3.0;
/// Mean turn of the joints in a rest pose, radians; captures have 0.2 and more.
const REST_TURN: f64 = 0.1;

/// Mean angle by which the joints turn from `frame` to the next, radians.
fn turn_between(clip: &Clip, frame: usize) -> f64 {
    let joints = clip.skeleton.joints.len();
    let turned = |k: usize| clip.rotations[k].inverse() * clip.rotations[k + joints];
    (0..joints).map(|joint| log(turned(frame * joints + joint)).length()).sum::<f64>() / joints as f64
}

/// Mean angle between the joints of frame 0 and no rotation, the root left out, radians.
fn rest_turn(clip: &Clip) -> f64 {
    let joints = clip.skeleton.joints.len();
    clip.rotations[1..joints].iter().map(|&turn| log(turn).length()).sum::<f64>() / joints as f64
}
