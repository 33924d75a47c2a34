//! A walk that goes over into a jog.

use std::path::Path;

use cotillion::physics::ground::GroundSettings;
use cotillion::physics::ground::schedule::five_five_two;
use cotillion::physics::ground::target::Source;
use libtest_mimic::Failed;

use crate::lean::{Strides, balancing};
use crate::measure::{Done, falls_at_every_step, mean as distance, ratios};
use crate::performance::load;
use crate::performer::Edited;
use crate::{JOG, WALK, tell};

pub(crate) fn nine_steps(folder: &Path, _: &str) -> Result<(), Failed> {
    let (walk, jog) = (load(folder, WALK)?, load(folder, JOG)?);
    let (blend, _) = Edited::blended(&walk, &jog)?;
    let Done { report, .. } = blend.touched_up("walk to jog, nine", &GroundSettings::default())?;
    let of_jog = Source::of(&jog.clip, &jog.body, &jog.stages).distances[0].ok_or("jogs stand")?.mean * 1e3;
    let [own, judge] = ratios(&report);
    tell(&format!(
        "    to {own:.3}, judge {judge:.3}; captured jog {of_jog:.1} mm; falls: {}",
        falls_at_every_step(&report)
    ));
    if own > 0.3 || distance(&report.after, 0) >= of_jog {
        return Err(format!("{own:.3}, {} mm of the captured {of_jog}", distance(&report.after, 0)).into());
    }
    Ok(())
}

/// Over the blended cycle: what balances the speed-up from the last captured stride before it to the first one after, less the lean
/// before the touch-up, and how much of that is added.
pub(crate) fn lean(folder: &Path, _: &str) -> Result<(), Failed> {
    let (walk, jog) = (load(folder, WALK)?, load(folder, JOG)?);
    let (blend, cycle) = Edited::blended(&walk, &jog)?;
    let strides = [walk, jog].map(|capture| Edited::untouched(&capture).stride());
    let twelve = GroundSettings { schedule: five_five_two(), rounds: 1, ..GroundSettings::default() };
    let mut shares = Vec::new();
    for (name, settings) in [("nine", GroundSettings::default()), ("twelve", twelve)] {
        let done = blend.touched_up(&format!("walk to jog, {name} with margin"), &settings)?;
        let [before, after] =
            [&blend.clip, &done.clip].map(|clip| Strides::of(clip, &blend.body, cycle.len()));
        let middle = cycle.start.midpoint(cycle.end);
        let ahead = before.ahead(middle);
        let speed =
            |from: usize, to: usize| before.way(from, to).dot(ahead) * blend.clip.fps / (to - from) as f64;
        let last = (cycle.end + strides[1]).min(blend.clip.frame_count() - 1);
        let gained = speed(cycle.end, last) - speed(cycle.start - strides[0], cycle.start);
        let asked = balancing(gained * blend.clip.fps / cycle.len() as f64);
        let (missing, added) =
            (asked - before.lean(middle, ahead), after.lean(middle, ahead) - before.lean(middle, ahead));
        tell(&format!(
            "    {cycle:?}: lean {:.1}, balanced at {:.1}, missing {:.1}, added {:.1} degrees",
            before.lean(middle, ahead).to_degrees(),
            asked.to_degrees(),
            missing.to_degrees(),
            added.to_degrees()
        ));
        shares.push(added / missing);
    }
    if shares[1] < 0.5 {
        return Err(format!("{shares:.3?}").into());
    }
    Ok(())
}
