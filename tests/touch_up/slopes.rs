//! A straight walk tilted uphill.

use std::path::Path;

use cotillion::physics::ground::GroundSettings;
use cotillion::physics::ground::schedule::{five_five_two, uphill};
use cotillion::physics::ground::target::Target;
use libtest_mimic::Failed;

use crate::lean::{Strides, mean};
use crate::measure::{Done, falls_at_every_step, ratios};
use crate::performance::load;
use crate::performer::Edited;
use crate::{WALK, tell};

/// Degrees.
const SLOPE: f64 = 10.0;

fn nine(target: Target) -> GroundSettings {
    GroundSettings { schedule: uphill(), target, ..GroundSettings::default() }
}

pub(crate) fn nine_steps(folder: &Path, _: &str) -> Result<(), Failed> {
    let slope = Edited::tilted(&load(folder, WALK)?, SLOPE)?;
    let Done { report, .. } = slope.touched_up("uphill, nine", &nine(GroundSettings::default().target))?;
    let [own, judge] = ratios(&report);
    if own > 1.0 / 8.0 || !falls_at_every_step(&report) || report.steps.len() != 9 {
        return Err(format!("{own:.3}, judge {judge:.3}").into());
    }
    Ok(())
}

/// Added lean ahead over the slope.
fn share_of_lean(slope: &Edited, done: &Done) -> f64 {
    let [before, after] =
        [&slope.clip, &done.clip].map(|clip| Strides::of(clip, &slope.body, slope.stride()));
    let added =
        |frame: usize| after.lean(frame, before.ahead(frame)) - before.lean(frame, before.ahead(frame));
    let share = mean(before.frames(slope.edge()).map(added)) / SLOPE.to_radians();
    tell(&format!("    lean {share:.3} of the slope"));
    share
}

pub(crate) fn lean(folder: &Path, _: &str) -> Result<(), Failed> {
    let slope = Edited::tilted(&load(folder, WALK)?, SLOPE)?;
    let carried = share_of_lean(&slope, &slope.touched_up("uphill, carried", &nine(Target::Carried))?);
    let twelve = GroundSettings { schedule: five_five_two(), rounds: 1, ..GroundSettings::default() };
    let hull = share_of_lean(&slope, &slope.touched_up("uphill, twelve with margin", &twelve)?);
    if (carried - 1.0).abs() > 0.15 || hull < 0.5 {
        return Err(format!("carried {carried:.3}, hull {hull:.3}").into());
    }
    Ok(())
}
