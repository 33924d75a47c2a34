//! Which captures warn of flights that do not fall as bodies do.

use std::path::Path;

use cotillion::clip::flight::fitted_gravity;
use cotillion::physics::ballistics::FlightCheck;
use cotillion::physics::flight::breaks::momentum_break;
use cotillion::physics::posed::{centers_of_mass, link_places};
use libtest_mimic::Failed;

use crate::performance::{load, load_as, verdict};
use crate::{FLIP, motions, only, text};

/// All captures that warn, and how many of their flights do: runs, a dive, a dance, and flips.
const WARNING: [(&str, usize); 8] = [
    ("amc/cmu_02_03_run_jog_straight.amc", 1),
    ("amc/cmu_127_23_run_dive_over_and_roll_run.amc", 2),
    ("amc/cmu_127_37_run_duck_underneath_low.amc", 1),
    ("bvh/cmu_60_10_salsa_A.bvh", 1),
    (FLIP, 1),
    ("deepmimic/humanoid3d_backflip.txt", 1),
    ("deepmimic/humanoid3d_run.txt", 1),
    ("deepmimic/humanoid3d_sideflip.txt", 1),
];

/// All captures in which the momentum of flights breaks, and of how many: limbs captured wrong, a kicked ball, dances, turns and flips that are
/// no flights, not one walk and not one run.
const BREAKING: [(&str, usize); 12] = [
    ("amc/cmu_49_02_jump_up_and_down_hop_on_one_foot.amc", 1),
    ("amc/cmu_49_04_run_and_leap.amc", 1),
    ("bvh/cmu_10_03_kick_ball.bvh", 1),
    ("bvh/cmu_60_05_salsa_A.bvh", 1),
    ("bvh/cmu_60_10_salsa_A.bvh", 3),
    ("bvh/cmu_61_05_salsa_B.bvh", 1),
    ("bvh/cmu_61_10_salsa_B.bvh", 1),
    (FLIP, 2),
    ("bvh/mass_pirouette.bvh", 1),
    ("deepmimic/humanoid3d_backflip.txt", 1),
    ("deepmimic/humanoid3d_sideflip.txt", 1),
    ("deepmimic/humanoid3d_spinkick.txt", 1),
];

/// Rates at which a jump, captured at 120, must warn when declared so.
const TOO_SLOW: [f64; 7] = [24.0, 30.0, 40.0, 50.0, 54.0, 60.0, 80.0];

/// What a wrong rate or scale makes of a fall may be off by this: labels that do not change with it begin and end elsewhere.
const OFF_TRUE_FALL: f64 = 0.015;

fn is_about(found: f64, expected: f64) -> bool {
    (found / expected - 1.0).abs() < OFF_TRUE_FALL
}

pub(crate) fn too_slow_names_its_rate(folder: &Path, file: &str) -> Result<(), Failed> {
    let right = only(&load(folder, file)?.stages.flights)?;
    let check = only(&load_as(folder, file, Some(60.0), 1.0)?.stages.flights)?;
    let rate = check.mending_rate.unwrap_or(0.0);
    let is_told =
        check.is_doubtful() && is_about(check.gravity, right.gravity / 4.0) && (rate - 120.0).abs() < 1.0;
    // 2.4 was measured.
    if is_told && (check.gravity - 2.4).abs() < 0.1 { Ok(()) } else { Err(check.to_string().into()) }
}

pub(crate) fn too_large_names_its_scale(folder: &Path, file: &str) -> Result<(), Failed> {
    let right = only(&load(folder, file)?.stages.flights)?;
    let check = only(&load_as(folder, file, None, 2.54)?.stages.flights)?;
    let scale = check.mending_scale.unwrap_or(0.0);
    let is_told =
        check.is_doubtful() && is_about(check.gravity, 2.54 * right.gravity) && is_about(scale * 2.54, 1.0);
    if is_told { Ok(()) } else { Err(check.to_string().into()) }
}

/// Of a jump 2.54 times as large 24.3 m/s² were measured. That is the whole run of labels, whose ends are on the ground: it is farther from the
/// true fall than the run without a tenth at either end, by which flights are told.
pub(crate) fn whole_runs_tell_less(folder: &Path, file: &str) -> Result<(), Failed> {
    let truth = 2.54 * only(&load(folder, file)?.stages.flights)?.gravity;
    let own = load_as(folder, file, None, 2.54)?;
    let check = only(&own.stages.flights)?;
    let centers = centers_of_mass(&own.body, &link_places(&own.body, &own.posed));
    let heights: Vec<f64> = centers[check.first..=check.last].iter().map(|center| center.y).collect();
    let whole = fitted_gravity(&heights, 1.0 / own.clip.fps);
    let is_measured = (whole - 24.3).abs() < 0.15;
    let told = format!("whole {whole}, told {}, true {truth}", check.gravity);
    if is_measured && (check.gravity - truth).abs() < (whole - truth).abs() {
        Ok(())
    } else {
        Err(told.into())
    }
}

pub(crate) fn flip_is_doubtful(folder: &Path, file: &str) -> Result<(), Failed> {
    let check = only(&load(folder, file)?.stages.flights)?;
    let rate = check.mending_rate.unwrap_or(0.0);
    // Measured: 56 to 60 m/s², 49 to 50 frames a second, no parabola at all.
    let is_told =
        check.is_doubtful() && (56.0..=60.0).contains(&check.gravity) && (49.0..=50.0).contains(&rate);
    if is_told && (0.055..=0.06).contains(&check.residual) { Ok(()) } else { Err(check.to_string().into()) }
}

pub(crate) fn any_rate_names_its_own(folder: &Path, file: &str) -> Result<(), Failed> {
    for rate in TOO_SLOW {
        let check = only(&load_as(folder, file, Some(rate), 1.0)?.stages.flights)?;
        let mended = check.mending_rate.unwrap_or(0.0);
        if !check.is_doubtful() || (mended - 120.0).abs() > 2.0 {
            return Err(format!("{rate}: {check}").into());
        }
    }
    Ok(())
}

pub(crate) fn only_known_warn(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for file in motions(folder)? {
        let own = load(folder, &file)?;
        let doubtful: Vec<FlightCheck> =
            own.stages.flights.into_iter().filter(FlightCheck::is_doubtful).collect();
        let known = WARNING.iter().find(|(name, _)| *name == file).map_or(0, |(_, count)| *count);
        let says = text(&doubtful);
        if doubtful.len() != known || says.matches("labels, rate or scale doubtful").count() != known {
            faults.push(format!("{file}: {known} expected of {says}"));
        }
    }
    verdict(faults)
}

pub(crate) fn only_known_break(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for file in motions(folder)? {
        let own = load(folder, &file)?;
        let last_frame = own.clip.frame_count() - 1;
        let breaks = |(first, last): &(usize, usize)| {
            let frames = (first.saturating_sub(1), (last + 1).min(last_frame));
            momentum_break(&own.body, &own.posed, frames).is_some()
        };
        let count = own.stages.flight_runs().iter().filter(|run| breaks(run)).count();
        let known = BREAKING.iter().find(|(name, _)| *name == file).map_or(0, |(_, count)| *count);
        if count != known {
            faults.push(format!("{file}: {count} flights break, {known} expected"));
        }
    }
    verdict(faults)
}
