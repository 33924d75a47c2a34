//! How alike two frames are: a distance between poses and their velocities in the root's own heading frame.
//!
//! `D²` is a weighted sum over joint angles, height, tilt, and velocities; every term is a squared length, so a frame is a
//! feature vector and D the distance of two of them (to the small-angle error of logarithms against a mean pose).
//! Source: Lee & Lee 2006 for the features, as listed by Kim et al. 2009, §5.1; formula and weights are ours.

use glam::{DQuat, DVec3};

use crate::clip::working::{WORKING_STEP, WorkingClip};
use crate::geometry::{cis, log, yaw};
use crate::index::floor_index;
use crate::skeleton::{JointRole, Pose, Skeleton};

/// Weight of root height, 1/m².
const HEIGHT: f64 = 10.0;
/// Weight of the root's tilt, 1/rad².
const TILT: f64 = 1.0;
/// Weight of joint angular velocities, s²/rad².
const ANGULAR_VELOCITY: f64 = 0.04;
/// Weight of root velocity, s²/m².
const VELOCITY: f64 = 1.0;
/// Weight of the root's turning rate, s²/rad².
const TURNING: f64 = 0.1;
/// Frames count as similar below this share of the median distance of moving frames …
const SHARE_OF_MEDIAN: f64 = 0.4;
/// … and never above this distance.
const LARGEST: f64 = 1.0;
/// Frames move if the mean speed of the root over half a second is above this, m/s.
const MOVING: f64 = 0.3;
/// So many moving frames tell the median; of more, as many spread over all stand for them: two million pairs.
const MOST_MOVING: usize = 2000;
/// Fraction of the golden ratio: its multiples fall evenly into any interval, and into any cycle of a gait.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Frames of one clip nearer than this are alike because they are neighbours, frames (0.3 s).
pub const NEIGHBOURS: usize = 9;

/// Feature vectors of the working frames of one clip.
#[derive(Clone, Debug, PartialEq)]
pub struct Features {
    /// Numbers a frame.
    pub width: usize,
    /// Frame by frame.
    pub values: Vec<f64>,
}

impl Features {
    /// Vector of one frame.
    pub fn frame(&self, frame: usize) -> &[f64] {
        &self.values[frame * self.width..(frame + 1) * self.width]
    }

    /// Distance D of two frames.
    pub fn distance(&self, frame: usize, other: &Self, other_frame: usize) -> f64 {
        self.distance_sq(frame, other, other_frame).sqrt()
    }

    /// D². Always summed in the same order: D(i, j) and D(j, i) have the same bits, on every machine.
    pub fn distance_sq(&self, frame: usize, other: &Self, other_frame: usize) -> f64 {
        let (a, b) = (self.frame(frame).chunks_exact(4), other.frame(other_frame).chunks_exact(4));
        let rest = a.remainder().iter().zip(b.remainder()).map(|(x, y)| (x - y) * (x - y)).sum::<f64>();
        // Four sums beside each other do not wait for each other.
        let mut sums = [0.0; 4];
        for (a, b) in a.zip(b) {
            for (sum, (x, y)) in sums.iter_mut().zip(a.iter().zip(b)) {
                *sum += (x - y) * (x - y);
            }
        }
        (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
    }
}

/// Weight of a joint's angles: 1 for hips, knees, shoulders, elbows, ½ for the spine, neck and ankles, 0 for the rest.
fn joint_weight(role: Option<JointRole>) -> f64 {
    use JointRole as R;
    match role {
        Some(
            R::LeftHip
            | R::RightHip
            | R::LeftKnee
            | R::RightKnee
            | R::LeftShoulder
            | R::RightShoulder
            | R::LeftElbow
            | R::RightElbow,
        ) => 1.0,
        Some(R::Spine | R::Chest | R::Neck | R::LeftFoot | R::RightFoot) => 0.5,
        _ => 0.0,
    }
}

/// Joints that count, with their weights.
pub fn weighted_joints(skeleton: &Skeleton) -> Vec<(usize, f64)> {
    let weights = skeleton.joints.iter().map(|joint| joint_weight(joint.role)).enumerate();
    weights.filter(|(_, weight)| *weight > 0.0).collect()
}

/// Mean rotation of each joint over all frames of `clips`, which share a skeleton; the root's without its heading.
pub fn mean_rotations(clips: &[&WorkingClip]) -> Vec<DQuat> {
    let mut sums: Vec<DQuat> = Vec::new();
    for clip in clips {
        for frame in 0..clip.frame_count() {
            let mut pose = clip.pose(frame as f64);
            pose.rotations[0] = tilt(clip, frame, &pose);
            if sums.is_empty() {
                sums.clone_from(&pose.rotations);
                continue;
            }
            for (sum, rotation) in sums.iter_mut().zip(pose.rotations) {
                *sum += if sum.dot(rotation) < 0.0 { -rotation } else { rotation };
            }
        }
    }
    sums.into_iter().map(|sum| if sum.length() > 1e-9 { sum.normalize() } else { DQuat::IDENTITY }).collect()
}

/// Orientation of the root without its heading.
fn tilt(clip: &WorkingClip, frame: usize, pose: &Pose) -> DQuat {
    yaw(-clip.headings[frame]) * pose.rotations[0]
}

/// Features of all working frames of `clip`, angles against `mean`. Cost: linear in frames and joints.
pub fn features(clip: &WorkingClip, mean: &[DQuat]) -> Features {
    let joints = weighted_joints(&clip.clip.skeleton);
    let poses: Vec<Pose> = (0..clip.frame_count()).map(|frame| clip.pose(frame as f64)).collect();
    let last = poses.len() - 1;
    let width = 6 * joints.len() + 8;
    let mut values = Vec::with_capacity(width * poses.len());
    for frame in 0..poses.len() {
        let (before, after) = (frame.saturating_sub(1), (frame + 1).min(last));
        let seconds = ((after - before).max(1)) as f64 * WORKING_STEP;
        let heading = clip.headings[frame];
        for (joint, weight) in &joints {
            let angle = log(mean[*joint].inverse() * poses[frame].rotations[*joint]) * weight.sqrt();
            let turn = log(poses[before].rotations[*joint].inverse() * poses[after].rotations[*joint]);
            let velocity = turn / seconds * (ANGULAR_VELOCITY * weight).sqrt();
            values.extend(angle.to_array());
            values.extend(velocity.to_array());
        }
        values.push(HEIGHT.sqrt() * poses[frame].root.y);
        let tilt = log(mean[0].inverse() * tilt(clip, frame, &poses[frame])) * TILT.sqrt();
        values.extend(tilt.to_array());
        let ground = cis(-heading) * (clip.positions[after] - clip.positions[before]) / seconds;
        let rise = (poses[after].root.y - poses[before].root.y) / seconds;
        let velocity = DVec3::new(ground.re, ground.im, rise) * VELOCITY.sqrt();
        values.extend(velocity.to_array());
        values.push(TURNING.sqrt() * (clip.headings[after] - clip.headings[before]) / seconds);
    }
    Features { width, values }
}

/// Which frames of `clip` move: the root's mean speed over half a second is above 0.3 m/s.
pub fn moving(clip: &WorkingClip) -> Vec<bool> {
    let half = NEIGHBOURS - 1;
    let last = clip.frame_count() - 1;
    let moves = |frame: usize| {
        let (a, b) = (frame.saturating_sub(half), (frame + half).min(last));
        let length: f64 = (a..b).map(|f| (clip.positions[f + 1] - clip.positions[f]).norm()).sum();
        length > MOVING * ((b - a).max(1)) as f64 * WORKING_STEP
    };
    (0..=last).map(moves).collect()
}

/// What tells frames of one body that are alike from those that are not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Admissible {
    /// Median distance of pairs of moving frames, those of one clip at least 0.3 s apart; `None` without such pairs.
    pub median: Option<f64>,
    /// Largest distance at which frames count as similar: 0.4 of the median, at most 1.
    pub largest: f64,
}

/// How near frames of `clips`, which share a skeleton and a mean pose, must be to count as similar. Of more than two thousand
/// moving frames as many, evenly spread, stand for all. Cost: linear in frames, and at most two million distances.
pub fn admissible(clips: &[(&WorkingClip, &Features)]) -> Admissible {
    let all: Vec<(usize, usize)> = clips
        .iter()
        .enumerate()
        .flat_map(|(clip, (working, _))| {
            let moves = moving(working);
            moves.into_iter().enumerate().filter(|(_, moves)| *moves).map(move |(frame, _)| (clip, frame))
        })
        .collect();
    let chosen = spread(&all, MOST_MOVING);
    let mut distances = Vec::new();
    for (index, (clip, frame)) in chosen.iter().enumerate() {
        let features = clips[*clip].1;
        let far = chosen[index..].iter().filter(|(b, f)| b != clip || f - frame >= NEIGHBOURS);
        distances.extend(far.map(|(b, f)| features.distance(*frame, clips[*b].1, *f)));
    }
    if distances.is_empty() {
        return Admissible { median: None, largest: LARGEST };
    }
    let middle = distances.len() / 2;
    let (_, median, _) = distances.select_nth_unstable_by(middle, f64::total_cmp);
    Admissible { median: Some(*median), largest: (SHARE_OF_MEDIAN * *median).min(LARGEST) }
}

/// At most `most` of `items`, one of each of as many equal stretches, at no regular distance: motion is periodic.
fn spread<T: Copy>(items: &[T], most: usize) -> Vec<T> {
    if items.len() <= most {
        return items.to_vec();
    }
    let stretch = items.len() as f64 / most as f64;
    let place = |k: usize| floor_index((k as f64 + (k as f64 * GOLDEN).fract()) * stretch);
    (0..most).map(|k| items[place(k).min(items.len() - 1)]).collect()
}
