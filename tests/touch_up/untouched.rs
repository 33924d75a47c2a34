//! Captures that nobody edited.

use std::path::Path;

use cotillion::clip::Clip;
use cotillion::physics::ground::GroundSettings;
use cotillion::physics::ground::report::{StepReport, joint_changes};
use cotillion::physics::ground::target::Target;
use libtest_mimic::Failed;

use crate::measure::{Done, mean};
use crate::performance::{load, verdict};
use crate::performer::Edited;
use crate::{JOG, WALK, tell};

const LIKE_BYTES: [&str; 5] = [
    WALK,
    JOG,
    "amc/cmu_127_04_walk_to_run_transition.amc",
    "bvh/snu_spiral_walk_normal.bvh",
    "bvh/cmu_12_01_walk.bvh",
];
const STEADY: [&str; 2] = [WALK, "amc/cmu_16_11_walk_veer_left.amc"];
const LIVELY: [&str; 4] = [
    "amc/cmu_16_13_walk_veer_right.amc",
    "amc/cmu_02_01_walk_straight.amc",
    "amc/cmu_127_04_walk_to_run_transition.amc",
    JOG,
];

pub(crate) fn same_bytes(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for file in LIKE_BYTES {
        let capture = Edited::untouched(&load(folder, file)?);
        let settings = GroundSettings { target: Target::Carried, ..GroundSettings::default() };
        let done = capture.touched_up(&format!("{file}, carried"), &settings)?;
        let bits = |places: &[glam::DVec3]| {
            places.iter().flat_map(|place| place.to_array()).map(f64::to_bits).collect::<Vec<_>>()
        };
        let turns = |turns: &[glam::DQuat]| {
            turns.iter().flat_map(|turn| turn.to_array()).map(f64::to_bits).collect::<Vec<_>>()
        };
        let is_same = bits(&done.clip.root_positions) == bits(&capture.clip.root_positions)
            && turns(&done.clip.rotations) == turns(&capture.clip.rotations);
        if !is_same || done.clip != capture.clip {
            faults.push(format!("{file} came out otherwise"));
        }
    }
    verdict(faults)
}

/// `judged`: whether the judge chooses; otherwise the round's last iterate is taken, whatever it is.
fn one_round(judged: bool) -> GroundSettings {
    GroundSettings { rounds: 1, target: Target::Hull { margin: 0.0 }, judged, ..GroundSettings::default() }
}

/// Turns of joints that turned at all, degrees, rising: of what the judge chose, and of the last iterate.
fn changes(file: &str, folder: &Path) -> Result<[Vec<f64>; 2], Failed> {
    let capture = Edited::untouched(&load(folder, file)?);
    let Done { clip, report } = capture.touched_up(&format!("{file}, one round"), &one_round(true))?;
    let chosen = moved(&capture, &clip);
    let last = capture.last_iterate(&format!("{file}, one round, unjudged"), &one_round(false))?;
    let steps = report.steps.len();
    let is_worse = |step: &StepReport| mean(&step.judged, 1) > mean(&report.before, 1);
    if chosen.is_empty() && !(report.kept == 0 && report.steps.iter().all(is_worse)) {
        return Err(format!("{file} stays as it came, though one of {steps} steps is better").into());
    }
    Ok([chosen, moved(&capture, &last)])
}

fn moved(capture: &Edited, clip: &Clip) -> Vec<f64> {
    let changes = joint_changes(&capture.clip, clip).into_iter().map(f64::to_degrees);
    // What is less is rounding of products that were taken apart and put together.
    let mut moved: Vec<f64> = changes.filter(|change| *change > 1e-9).collect();
    moved.sort_by(f64::total_cmp);
    let largest = moved.last().copied().unwrap_or(0.0);
    tell(&format!("    95 % of {} below {:.2}, largest {largest:.2} degrees", moved.len(), most(&moved)));
    moved
}

/// What 95 % of rising values are below; 0 of none.
fn most(rising: &[f64]) -> f64 {
    rising.get(rising.len() * 95 / 100).copied().unwrap_or(0.0)
}

pub(crate) fn hardly_change(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for file in STEADY {
        for moved in changes(file, folder)? {
            let largest = moved.last().copied().ok_or("a walk is never quite balanced")?;
            if largest >= 1.0 {
                faults.push(format!("{file}: {largest:.2} degrees"));
            }
        }
    }
    verdict(faults)
}

/// The judge returns the jog as it came: every step of it is worse. What the steps do to it is small all the same.
pub(crate) fn change_little(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for file in LIVELY {
        let [chosen, last] = changes(file, folder)?;
        if last.is_empty() || chosen.is_empty() != (file == JOG) {
            faults.push(format!(
                "{file}: {} joints turned, {} in the last iterate",
                chosen.len(),
                last.len()
            ));
        }
        for most in [most(&chosen), most(&last)] {
            if most >= 2.0 {
                faults.push(format!("{file}: 95 % below {most:.2} degrees"));
            }
        }
    }
    verdict(faults)
}
