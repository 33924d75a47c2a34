//! How fast joints turn around the seams of a track.

use cotillion::clip::working::WorkingClip;
use cotillion::geometry::log;
use cotillion::similarity::weighted_joints;
use cotillion::skeleton::Pose;
use cotillion::track::Track;
use libtest_mimic::Failed;

/// Frames on either side of a seam that are looked at.
const AROUND: usize = 10;
/// Joints turn at most so many times as fast as ever in the clip, and their speed changes at most so many times as fast as in
/// all but a thousandth of it.
const SPEED: f64 = 1.1;
const CHANGE: f64 = 1.6;
/// Working frames a second.
const FPS: f64 = 30.0;

/// What joints of a clip do.
pub(crate) struct Usual {
    joints: Vec<usize>,
    /// Of each, rad/s.
    fastest: Vec<f64>,
    /// rad/s².
    change: f64,
}

/// Angular speeds of a joint between successive poses, rad/s.
fn speeds(poses: &[Pose], joint: usize) -> Vec<f64> {
    let turn = |pair: &[Pose]| log(pair[0].rotations[joint].inverse() * pair[1].rotations[joint]).length();
    poses.windows(2).map(|pair| turn(pair) * FPS).collect()
}

fn changes(speeds: &[f64]) -> impl Iterator<Item = f64> {
    speeds.windows(2).map(|pair| (pair[1] - pair[0]).abs() * FPS)
}

pub(crate) fn usual(clip: &WorkingClip) -> Usual {
    let poses: Vec<Pose> = (0..clip.frame_count()).map(|frame| clip.pose(frame as f64)).collect();
    let joints: Vec<usize> =
        weighted_joints(&clip.clip.skeleton).into_iter().map(|(joint, _)| joint).collect();
    let all: Vec<Vec<f64>> = joints.iter().map(|joint| speeds(&poses, *joint)).collect();
    let mut found: Vec<f64> = all.iter().flat_map(|speeds| changes(speeds)).collect();
    found.sort_unstable_by(f64::total_cmp);
    let fastest = all.iter().map(|speeds| speeds.iter().copied().fold(0.0, f64::max)).collect();
    let change = found[(found.len() - 1) * 999 / 1000];
    Usual { joints, fastest, change }
}

/// Checks all seams of `track`: largest speed over the fastest of the joint, and largest change over the usual.
pub(crate) fn seams(usual: &Usual, track: &Track) -> Result<(f64, f64), Failed> {
    let mut worst: (f64, f64) = (0.0, 0.0);
    let last = track.frame_count() - 1;
    for (_, start) in track.placed_runs().skip(1) {
        let frames = start.saturating_sub(AROUND + 1)..=(start + AROUND).min(last);
        let poses: Vec<Pose> = frames.map(|frame| track.pose(frame as f64)).collect();
        for (joint, fastest) in usual.joints.iter().zip(&usual.fastest) {
            let speeds = speeds(&poses, *joint);
            let speed = speeds.iter().copied().fold(0.0, f64::max) / fastest;
            let change = changes(&speeds).fold(0.0, f64::max) / usual.change;
            worst = (worst.0.max(speed), worst.1.max(change));
            if speed > SPEED || change > CHANGE {
                let runs: Vec<(u32, u32)> = track.runs.iter().map(|run| (run.first.0, run.last.0)).collect();
                let told = format!("joint {joint} turns {speed:.2} times as fast as ever, {change:.2} times");
                return Err(format!("{told} at {start} of {runs:?}").into());
            }
        }
    }
    Ok(worst)
}
