//! Masses told by captures.

use std::path::Path;

use cotillion::physics::body_model::Segment;
use cotillion::physics::derivatives::Filter;
use cotillion::physics::masses::{
    FlightMassSettings, MassFit, MassMethod, MassSettings, masses_from_flight, masses_from_ground,
};
use libtest_mimic::Failed;

use crate::performance::{Performance, load, verdict};
use crate::{DIFFERENCE, JUMP, distance, only};

pub(crate) const WALKS: [&str; 3] = [
    "amc/cmu_16_15_walk_straight.amc",
    "amc/cmu_16_11_walk_veer_left.amc",
    "amc/cmu_16_13_walk_veer_right.amc",
];
pub(crate) const UNSEEN: [&str; 2] =
    ["amc/cmu_16_17_walk_90_degree_left_turn.amc", "amc/cmu_16_33_slow_walk_then_stop.amc"];

/// Walks on the level, each by itself.
pub(crate) const SINGLE_WALKS: [&str; 21] = [
    "amc/cmu_02_01_walk_straight.amc",
    "amc/cmu_127_04_walk_to_run_transition.amc",
    "amc/cmu_16_11_walk_veer_left.amc",
    "amc/cmu_16_13_walk_veer_right.amc",
    "amc/cmu_16_15_walk_straight.amc",
    "amc/cmu_16_17_walk_90_degree_left_turn.amc",
    "amc/cmu_16_19_walk_90_degree_right_turn.amc",
    "amc/cmu_16_33_slow_walk_then_stop.amc",
    "amc/cmu_49_01_walk_straight_gymnast.amc",
    "bvh/cmu_12_01_walk.bvh",
    "bvh/cmu_131_01_start_walk_stop.bvh",
    "bvh/cmu_37_01_walk.bvh",
    "bvh/mass_walk.bvh",
    "bvh/snu_cross_walk_90.bvh",
    "bvh/snu_spiral_walk_normal.bvh",
    "bvh/snu_u_turn.bvh",
    "bvh/snu_walk_left_90.bvh",
    "bvh/snu_walk_stop_walk.bvh",
    "bvh/snu_walk_straight_normal.bvh",
    "bvh/snu_walk_turn_180.bvh",
    "deepmimic/humanoid3d_walk.txt",
];

fn walks(folder: &Path, files: &[&str]) -> Result<Vec<Performance>, Failed> {
    files.iter().map(|file| load(folder, file)).collect()
}

pub(crate) fn walks_tell_masses(folder: &Path, _: &str) -> Result<(), Failed> {
    let seen = walks(folder, &WALKS)?;
    let standing: Vec<_> = seen.iter().map(|own| (&own.posed, &own.stages)).collect();
    let fit = masses_from_ground(&seen[0].body, &standing, &MassSettings::default())?;
    let told = format!("{:?} {:?} {:?}", fit.factors, fit.singular_values, fit.distances);
    if fit.factors.iter().any(|(_, factor)| !(0.5..=2.0).contains(factor))
        || (fit.body.mass - 75.0).abs() > 1e-4
    {
        return Err(told.into());
    }
    // What is not seen gets better, too.
    for own in seen.iter().chain(&walks(folder, &UNSEEN)?) {
        let fitted = Performance { body: fit.body.clone(), ..own.clone() };
        let (before, after) = (distance(own, Filter::Gaussian)?, distance(&fitted, Filter::Gaussian)?);
        if after > 0.95 * before {
            return Err(format!("{} {before} {after} {told}", own.clip.name).into());
        }
    }
    Ok(())
}

/// Mean distances in millimetres with masses that a prototype fitted to [`WALKS`] by a pull of one strength, of these and of [`UNSEEN`].
const BY_ONE_PULL: [f64; 5] = [2.0, 3.6, 5.7, 11.2, 5.3];
/// What the abdomen then weighs, share of the body.
const ABDOMEN: f64 = 0.226;

pub(crate) fn one_pull_tells_as_measured(folder: &Path, _: &str) -> Result<(), Failed> {
    let seen = walks(folder, &WALKS)?;
    let settings = MassSettings { pull_of_noise: 0.0, ..MassSettings::default() };
    let fit = fitted(&seen.iter().collect::<Vec<_>>(), &settings)?;
    let mut ends = Vec::new();
    for own in seen.iter().chain(&walks(folder, &UNSEEN)?) {
        ends.push(distance(&Performance { body: fit.body.clone(), ..own.clone() }, Filter::Gaussian)?);
    }
    let abdomen = fit.body.segment_masses()[Segment::Abdomen as usize] / fit.body.mass;
    let is_near = |found: f64, stated: f64| (found / stated - 1.0).abs() < DIFFERENCE;
    let are_near = ends.iter().zip(BY_ONE_PULL).all(|(found, stated)| is_near(*found, stated));
    if are_near && is_near(abdomen, ABDOMEN) {
        Ok(())
    } else {
        Err(format!("{ends:?} {abdomen} {}", fit.frames).into())
    }
}

/// Whether no segment is below half or above twice what the table says.
fn is_near_table(fit: &MassFit) -> bool {
    fit.factors.iter().all(|(_, factor)| (0.5..=2.0).contains(factor))
}

fn fitted(seen: &[&Performance], settings: &MassSettings) -> Result<MassFit, Failed> {
    let standing: Vec<_> = seen.iter().map(|own| (&own.posed, &own.stages)).collect();
    Ok(masses_from_ground(&seen[0].body, &standing, settings)?)
}

pub(crate) fn walk_tells_masses(folder: &Path, file: &str) -> Result<(), Failed> {
    let walk = load(folder, file)?;
    let mut faults = Vec::new();
    for method in [MassMethod::Quadratic, MassMethod::ConjugateGradients] {
        let fit = fitted(&[&walk], &MassSettings { method, ..MassSettings::default() })?;
        // Masses are fitted to squares: of walks that are noise the mean may stay.
        if !is_near_table(&fit) || fit.largest_change() < 0.02 || fit.distances[1] > 1.01 * fit.distances[0] {
            faults.push(format!("{method:?}: {:?} {:?}", fit.factors, fit.distances));
        }
    }
    verdict(faults)
}

pub(crate) fn pairs_tell_masses(folder: &Path, _: &str) -> Result<(), Failed> {
    let seen = walks(folder, &[&WALKS[..], &UNSEEN[..]].concat())?;
    let mut faults = Vec::new();
    for (index, one) in seen.iter().enumerate() {
        for other in &seen[index + 1..] {
            let fit = fitted(&[one, other], &MassSettings::default())?;
            if !is_near_table(&fit) || fit.distances[1] > 0.95 * fit.distances[0] {
                faults.push(format!("{} {}: {:?}", one.clip.name, other.clip.name, fit.factors));
            }
        }
    }
    verdict(faults)
}

pub(crate) fn noise_must_pull(folder: &Path, file: &str) -> Result<(), Failed> {
    let turn = load(folder, file)?;
    let fit = fitted(&[&turn], &MassSettings { pull_of_noise: 0.0, ..MassSettings::default() })?;
    if is_near_table(&fit) { Err(format!("{:?}", fit.factors).into()) } else { Ok(()) }
}

pub(crate) fn descent_agrees(folder: &Path, _: &str) -> Result<(), Failed> {
    let seen = walks(folder, &WALKS)?;
    let standing: Vec<_> = seen.iter().map(|own| (&own.posed, &own.stages)).collect();
    let settings = MassSettings { method: MassMethod::ConjugateGradients, ..MassSettings::default() };
    let fit = masses_from_ground(&seen[0].body, &standing, &settings)?;
    let plausible = fit.factors.iter().all(|(_, factor)| (0.5..=2.0).contains(factor));
    let [before, after] = fit.distances;
    if plausible && after < 0.85 * before {
        return Ok(());
    }
    Err(format!("{:?} {:?}", fit.factors, fit.distances).into())
}

pub(crate) fn jumps_tell_masses(folder: &Path, _: &str) -> Result<(), Failed> {
    let jumps = walks(folder, &[JUMP, "amc/cmu_16_03_high_jump_in_place.amc"])?;
    let flights = jumps.iter().map(|own| {
        let (first, last) = own.stages.flight_runs()[0];
        (&own.posed, first, last)
    });
    let fit =
        masses_from_flight(&jumps[0].body, &flights.collect::<Vec<_>>(), &FlightMassSettings::default())?;
    let [before, after] = fit.residuals;
    let is_plausible = fit.is_fitted && fit.largest_change() < 0.3 && (fit.body.mass - 75.0).abs() < 1e-4;
    if is_plausible && before < 0.006 && after < before { Ok(()) } else { Err(format!("{fit:?}").into()) }
}

pub(crate) fn flips_tell_no_masses(folder: &Path, file: &str) -> Result<(), Failed> {
    let own = load(folder, file)?;
    let check = only(&own.stages.flights)?;
    let fit = masses_from_flight(
        &own.body,
        &[(&own.posed, check.first, check.last)],
        &FlightMassSettings::default(),
    )?;
    if !fit.is_fitted && fit.factors.iter().all(|(_, factor)| *factor == 1.0) && fit.body == own.body {
        return Ok(());
    }
    Err(format!("{fit:?}").into())
}
