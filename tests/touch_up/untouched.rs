//! Captures that nobody edited.

use std::path::Path;

use cotillion::physics::ground::GroundSettings;
use cotillion::physics::ground::report::joint_changes;
use cotillion::physics::ground::target::Target;
use libtest_mimic::Failed;

use crate::measure::Done;
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

fn one_round() -> GroundSettings {
    GroundSettings { rounds: 1, target: Target::Hull { margin: 0.0 }, ..GroundSettings::default() }
}

/// Turns of joints that turned at all, degrees, rising.
fn changes(file: &str, folder: &Path) -> Result<Vec<f64>, Failed> {
    let capture = Edited::untouched(&load(folder, file)?);
    let Done { clip, report } = capture.touched_up(&format!("{file}, one round"), &one_round())?;
    let changes = joint_changes(&capture.clip, &clip).into_iter().map(f64::to_degrees);
    // What is less is rounding of products that were taken apart and put together.
    let mut moved: Vec<f64> = changes.filter(|change| *change > 1e-9).collect();
    moved.sort_by(f64::total_cmp);
    tell(&format!(
        "    95 % below {:.2}, largest {:.2} degrees ({:?})",
        most(&moved),
        moved.last().copied().unwrap_or(0.0),
        report
            .largest_change
            .map(|change| capture.clip.skeleton.joints[change.joint.as_usize()].name.clone())
    ));
    Ok(moved)
}

/// What 95 % of rising values are below; 0 of none.
fn most(rising: &[f64]) -> f64 {
    rising.get(rising.len() * 95 / 100).copied().unwrap_or(0.0)
}

pub(crate) fn hardly_change(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for file in STEADY {
        let moved = changes(file, folder)?;
        let largest = moved.last().copied().ok_or("a walk is never quite balanced")?;
        if largest >= 1.0 {
            faults.push(format!("{file}: {largest:.2} degrees"));
        }
    }
    verdict(faults)
}

pub(crate) fn change_little(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for file in LIVELY {
        let most = most(&changes(file, folder)?);
        if most >= 2.0 {
            faults.push(format!("{file}: 95 % below {most:.2} degrees"));
        }
    }
    verdict(faults)
}
