//! Which captures warn of flights that do not fall as bodies do.

use std::path::Path;

use cotillion::physics::ballistics::FlightCheck;
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

/// Rates at which a jump, captured at 120, must warn when declared so.
const TOO_SLOW: [f64; 7] = [24.0, 30.0, 40.0, 50.0, 54.0, 60.0, 80.0];

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
