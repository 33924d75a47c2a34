//! A straight walk bent onto arcs.

use std::path::Path;

use cotillion::physics::ground::GroundSettings;
use cotillion::physics::ground::schedule::five_five_two;
use cotillion::physics::ground::target::Target;
use libtest_mimic::Failed;

use crate::lean::{Strides, balancing, left, mean};
use crate::measure::{Done, falls_at_every_step, ratios};
use crate::performance::{load, verdict};
use crate::performer::Edited;
use crate::{WALK, tell};

/// To the left and to the right, metres.
const RADII: [f64; 6] = [2.0, -2.0, 3.0, -3.0, 4.0, -4.0];

fn bends(folder: &Path) -> Result<Vec<(f64, Edited)>, Failed> {
    let walk = load(folder, WALK)?;
    RADII.into_iter().map(|radius| Ok((radius, Edited::bent(&walk, radius)?))).collect()
}

fn twelve(margin: f64) -> GroundSettings {
    let target = Target::Hull { margin };
    GroundSettings { schedule: five_five_two(), rounds: 1, target, ..GroundSettings::default() }
}

pub(crate) fn nine_steps_with_margin(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for (radius, bend) in bends(folder)? {
        let Done { report, .. } =
            bend.touched_up(&format!("R {radius}, nine"), &GroundSettings::default())?;
        let [own, judge] = ratios(&report);
        if own > 1.0 / 20.0 || judge > 1.0 / 8.0 || !falls_at_every_step(&report) || report.steps.len() != 9 {
            faults.push(format!("R {radius}: {own:.3}, judge {judge:.3}"));
        }
    }
    verdict(faults)
}

pub(crate) fn twelve_steps_without_margin(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for (radius, bend) in bends(folder)? {
        let Done { report, .. } = bend.touched_up(&format!("R {radius}, twelve"), &twelve(0.0))?;
        let [own, _] = ratios(&report);
        tell(&format!("    to {own:.3}"));
        if own > 1.0 / 10.0 || !falls_at_every_step(&report) || report.steps.len() != 12 {
            faults.push(format!("R {radius}: {own:.3}"));
        }
    }
    verdict(faults)
}

/// Added lean towards the centre over what balances `v²/R`, in the middle of the clip.
fn share_of_lean(radius: f64, bend: &Edited, done: &Done) -> f64 {
    let [before, after] = [&bend.clip, &done.clip].map(|clip| Strides::of(clip, &bend.body, bend.stride()));
    let inwards = |frame: usize| left(before.ahead(frame)) * radius.signum();
    let added = |frame: usize| after.lean(frame, inwards(frame)) - before.lean(frame, inwards(frame));
    let asked = |frame: usize| balancing(before.velocity(frame).length_squared() / radius.abs());
    let frames = before.frames(bend.edge());
    mean(frames.clone().map(added)) / mean(frames.map(asked))
}

pub(crate) fn carried_lean(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for (radius, bend) in bends(folder)? {
        let settings = GroundSettings { target: Target::Carried, ..GroundSettings::default() };
        let share =
            share_of_lean(radius, &bend, &bend.touched_up(&format!("R {radius}, carried"), &settings)?);
        tell(&format!("    lean {share:.3} of atan(a/g)"));
        if (share - 1.0).abs() > 0.15 {
            faults.push(format!("R {radius}: {share:.3}"));
        }
    }
    verdict(faults)
}

pub(crate) fn hull_lean(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for (radius, bend) in bends(folder)? {
        let done = bend.touched_up(&format!("R {radius}, twelve with margin"), &twelve(0.0125))?;
        let share = share_of_lean(radius, &bend, &done);
        tell(&format!("    lean {share:.3} of atan(a/g)"));
        if share < 0.5 {
            faults.push(format!("R {radius}: {share:.3}"));
        }
    }
    verdict(faults)
}

pub(crate) fn both_axes(folder: &Path, _: &str) -> Result<(), Failed> {
    let mut faults = Vec::new();
    for (radius, bend) in bends(folder)? {
        let settings = GroundSettings { two_axis: true, ..GroundSettings::default() };
        let Done { report, .. } = bend.touched_up(&format!("R {radius}, nine, both axes"), &settings)?;
        let [own, judge] = ratios(&report);
        if own > 1.0 / 20.0 || judge > 1.0 / 8.0 {
            faults.push(format!("R {radius}: {own:.3}, judge {judge:.3}"));
        }
    }
    verdict(faults)
}
