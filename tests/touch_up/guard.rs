//! Nothing gets worse by derivatives that were not optimised.

use std::path::Path;

use cotillion::physics::GRAVITY;
use cotillion::physics::flight::report::FlightFacts;
use cotillion::physics::ground::GroundSettings;
use cotillion::physics::ground::schedule::five_five_two;
use cotillion::physics::ground::target::Target;
use libtest_mimic::Failed;

use crate::JOG;
use crate::measure::mean;
use crate::performance::{load, verdict};
use crate::performer::Edited;

/// All captures that are walked or run.
pub(crate) const WALKED_OR_RUN: [&str; 47] = [
    "amc/cmu_02_01_walk_straight.amc",
    "amc/cmu_02_03_run_jog_straight.amc",
    "amc/cmu_03_01_walk_on_uneven_terrain_step_down.amc",
    "amc/cmu_03_02_walk_on_uneven_terrain.amc",
    "amc/cmu_09_01_run_straight.amc",
    "amc/cmu_09_12_navigate_forward_backward_sideways.amc",
    "amc/cmu_127_04_walk_to_run_transition.amc",
    "amc/cmu_127_05_run_to_quick_stop.amc",
    "amc/cmu_127_13_run_side_step_left.amc",
    "amc/cmu_127_14_run_side_step_right.amc",
    "amc/cmu_127_16_run_turn_right.amc",
    "amc/cmu_127_21_run_jump_stop_run.amc",
    "amc/cmu_127_25_run_jump_over_obstacle.amc",
    "amc/cmu_127_29_run_duck_underneath.amc",
    "amc/cmu_127_33_run_over_low_obstacle.amc",
    "amc/cmu_127_37_run_duck_underneath_low.amc",
    "amc/cmu_16_11_walk_veer_left.amc",
    "amc/cmu_16_13_walk_veer_right.amc",
    "amc/cmu_16_15_walk_straight.amc",
    "amc/cmu_16_17_walk_90_degree_left_turn.amc",
    "amc/cmu_16_19_walk_90_degree_right_turn.amc",
    "amc/cmu_16_33_slow_walk_then_stop.amc",
    "amc/cmu_16_35_jog_straight.amc",
    "amc/cmu_16_37_jog_veer_left.amc",
    "amc/cmu_16_41_jog_90_degree_left_turn.amc",
    "amc/cmu_16_57_jog_sudden_stop.amc",
    "amc/cmu_49_01_walk_straight_gymnast.amc",
    "bvh/cmu_12_01_walk.bvh",
    "bvh/cmu_131_01_start_walk_stop.bvh",
    "bvh/cmu_131_01_start_walk_stop_metres.bvh",
    "bvh/cmu_37_01_walk.bvh",
    "bvh/mass_run.bvh",
    "bvh/mass_walk.bvh",
    "bvh/snu_cross_walk_90.bvh",
    "bvh/snu_slope_up_10.bvh",
    "bvh/snu_slope_up_16.bvh",
    "bvh/snu_spiral_left_fast.bvh",
    "bvh/snu_spiral_walk_normal.bvh",
    "bvh/snu_u_turn.bvh",
    "bvh/snu_walk_left_90.bvh",
    "bvh/snu_walk_stop_walk.bvh",
    "bvh/snu_walk_straight_normal.bvh",
    "bvh/snu_walk_to_slope_and_back.bvh",
    "bvh/snu_walk_turn_180.bvh",
    "deepmimic/humanoid3d_jog.txt",
    "deepmimic/humanoid3d_run.txt",
    "deepmimic/humanoid3d_walk.txt",
];

/// Flights that do not fall as bodies do would leave it worse.
const WORSE_IN_THE_AIR: &str = "deepmimic/humanoid3d_jog.txt";
/// Jumps and hops.
const HOPS: &str = "amc/cmu_49_02_jump_up_and_down_hop_on_one_foot.amc";

fn schedules() -> [(&'static str, GroundSettings); 3] {
    let twelve = GroundSettings { schedule: five_five_two(), rounds: 1, ..GroundSettings::default() };
    let no_margin = Target::Hull { margin: 0.0 };
    [
        ("nine", GroundSettings::default()),
        ("twelve", twelve.clone()),
        ("twelve without margin", GroundSettings { target: no_margin, ..twelve }),
    ]
}

/// [`Edited::touched_up`] asks for it.
pub(crate) fn never_worse(folder: &Path, file: &str) -> Result<(), Failed> {
    let capture = Edited::untouched(&load(folder, file)?);
    for (name, settings) in schedules() {
        capture.touched_up(&format!("{file}, {name}"), &settings)?;
    }
    Ok(())
}

/// [`Edited::touched_up_whole`] asks for it.
pub(crate) fn never_worse_in_the_air(folder: &Path, file: &str) -> Result<(), Failed> {
    let capture = Edited::untouched(&load(folder, file)?);
    let carried = GroundSettings { target: Target::Carried, ..GroundSettings::default() };
    for (name, settings) in schedules().into_iter().chain([("carried", carried)]) {
        capture.touched_up_whole(&format!("{file}, {name}"), &settings)?;
    }
    Ok(())
}

pub(crate) fn flights_are_left(folder: &Path, _: &str) -> Result<(), Failed> {
    let capture = Edited::untouched(&load(folder, WORSE_IN_THE_AIR)?);
    let done = capture.touched_up_whole(WORSE_IN_THE_AIR, &GroundSettings::default())?;
    if done.flight.left.is_empty() { Err("all of its flights are flown".into()) } else { Ok(()) }
}

/// What a flight falls like was measured before the ground pass, which moves hops on the ground beside them.
pub(crate) fn hops_fall_as_captured(folder: &Path, _: &str) -> Result<(), Failed> {
    let capture = Edited::untouched(&load(folder, HOPS)?);
    let done = capture.touched_up_whole(HOPS, &GroundSettings::default())?;
    let falls = |facts: &&FlightFacts| {
        facts.gravity == GRAVITY && facts.check == capture.stages.check_of((facts.first, facts.last))
    };
    let others: Vec<String> =
        done.flight.flights.iter().filter(|own| !falls(own)).map(ToString::to_string).collect();
    if done.flight.flights.is_empty() { Err("nothing is flown".into()) } else { verdict(others) }
}

pub(crate) fn is_needed(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for file in [JOG, "amc/cmu_16_17_walk_90_degree_left_turn.amc"] {
        let capture = Edited::untouched(&load(folder, file)?);
        let mut is_needed = false;
        for (name, settings) in schedules() {
            let report = capture.touched_up(&format!("{file}, {name}"), &settings)?.report;
            let last = report.steps.last().ok_or("no step")?;
            is_needed |= mean(&last.judged, 1) > mean(&report.before, 1) && report.kept < report.steps.len();
        }
        if !is_needed {
            faults.push(format!("{file} ends no worse by the judge"));
        }
    }
    verdict(faults)
}
