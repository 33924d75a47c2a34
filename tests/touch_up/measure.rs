//! What a touch-up did, measured apart from its own report.

use cotillion::clip::Clip;
use cotillion::physics::derivatives::Filter;
use cotillion::physics::flight::FlightSettings;
use cotillion::physics::ground::report::{GroundReport, Judged};
use cotillion::physics::ground::{GroundSettings, ground_pass};
use cotillion::physics::posed::PosedClip;
use cotillion::physics::touch_up::{TouchUpSettings, TouchedUp, touch_up};
use cotillion::physics::zmp::{ForceSettings, balances, distance_summary, link_forces};
use libtest_mimic::Failed;

use crate::performer::Edited;
use crate::tell;

/// Planted points stay within this, metres.
const PLANTED: f64 = 1e-4;
/// Legs may stretch by less than this; they do not at all.
const STRETCH: f64 = 0.005;
/// Rounding of a mean distance where feet stand as in the input, metres.
const ROUNDING: f64 = 1e-7;

/// A touch-up, and what was found out about it.
pub(crate) struct Done {
    pub(crate) clip: Clip,
    pub(crate) report: GroundReport,
}

/// Mean distances before and after each step, millimetres, by the filter that is optimised.
pub(crate) fn curve(report: &GroundReport) -> Vec<f64> {
    std::iter::once(&report.before)
        .chain(report.steps.iter().map(|step| &step.judged))
        .map(|judged| mean(judged, 0))
        .collect()
}

/// Millimetres.
pub(crate) fn mean(judged: &Judged, filter: usize) -> f64 {
    judged.distance[filter].map_or(0.0, |distance| distance.mean * 1e3)
}

pub(crate) fn falls_at_every_step(report: &GroundReport) -> bool {
    curve(report).windows(2).all(|pair| pair[1] < pair[0])
}

/// After over before, by both filters.
pub(crate) fn ratios(report: &GroundReport) -> [f64; 2] {
    [0, 1].map(|filter| mean(&report.after, filter) / mean(&report.before, filter))
}

impl Edited {
    /// Touches up, and checks what must hold of every touch-up: planted points stay, the judge sees nothing become worse, and the
    /// report says what another route finds.
    pub(crate) fn touched_up(&self, name: &str, settings: &GroundSettings) -> Result<Done, Failed> {
        let (clip, report) =
            ground_pass(&self.clip, &self.body, &self.stages, self.source.as_ref(), settings)?;
        let [before, after] = [&self.clip, &clip].map(|clip| self.distances(clip));
        tell(&format!(
            "{name}: d {:.1} -> {:.1} mm, judge {:.1} -> {:.1}; kept {} of {}; joints {:.1} deg, root {:.0} mm, plants {:.5} mm, source {:.1?}",
            before[0],
            after[0],
            before[1],
            after[1],
            report.kept,
            report.steps.len(),
            report.largest_change.map_or(0.0, |change| change.angle.to_degrees()),
            report.root_shift * 1e3,
            self.farthest_plant(&clip) * 1e3,
            report
                .source
                .map(|source| source.map(|distance| distance.map_or(0.0, |distance| distance.mean * 1e3))),
        ));
        tell(&format!("    {:.1?}", curve(&report)));
        if self.farthest_plant(&clip) > PLANTED || report.plant_error > PLANTED {
            return Err(format!("{name}: a planted point moved by {} m", self.farthest_plant(&clip)).into());
        }
        if report.stretch > STRETCH {
            return Err(format!("{name}: a bone is {} longer or shorter", report.stretch).into());
        }
        if after[1] > before[1] + ROUNDING * 1e3 {
            return Err(format!("{name}: the judge saw {} become {} mm", before[1], after[1]).into());
        }
        for filter in [0, 1] {
            let differs = |found: f64, told: &Judged| (found - mean(told, filter)).abs() > ROUNDING * 1e3;
            if differs(before[filter], &report.before) || differs(after[filter], &report.after) {
                return Err(
                    format!("{name}: found {before:?} -> {after:?} mm, told {:?}", report.after).into()
                );
            }
        }
        Ok(Done { clip, report })
    }

    /// The last iterate, which no judge chose; planted points must stay in it all the same.
    pub(crate) fn last_iterate(&self, name: &str, unjudged: &GroundSettings) -> Result<Clip, Failed> {
        let (clip, report) =
            ground_pass(&self.clip, &self.body, &self.stages, self.source.as_ref(), unjudged)?;
        let [before, after] = [&self.clip, &clip].map(|clip| self.distances(clip));
        tell(&format!(
            "{name}: d {:.1} -> {:.1} mm, judge {:.1} -> {:.1}",
            before[0], after[0], before[1], after[1]
        ));
        if self.farthest_plant(&clip) > PLANTED || report.kept != report.steps.len() {
            return Err(format!(
                "{name}: kept {} of {} steps, or a plant moved",
                report.kept,
                report.steps.len()
            )
            .into());
        }
        Ok(clip)
    }

    /// Touches up on the ground and in the air, and checks that the judge sees nothing become worse, and that flights that are left
    /// are as the ground pass leaves them.
    pub(crate) fn touched_up_whole(&self, name: &str, ground: &GroundSettings) -> Result<TouchedUp, Failed> {
        let with = |flight: Option<FlightSettings>| {
            let settings = TouchUpSettings { ground: ground.clone(), flight };
            touch_up(&self.clip, &self.body, &self.stages, self.source.as_ref(), &settings)
        };
        let done = with(Some(FlightSettings::default()))?;
        let [before, after] = [&self.clip, &done.clip].map(|clip| self.distances(clip)[1]);
        let left = &done.flight.left;
        tell(&format!(
            "{name}, whole: judge {before:.2} -> {:.2} on the ground -> {after:.2} mm; {} flights, {} left",
            mean(&done.ground.after, 1),
            done.flight.flights.len(),
            left.len()
        ));
        if after > before + ROUNDING * 1e3 {
            return Err(format!("{name}: in the air the judge saw {before} become {after} mm").into());
        }
        let grounded = with(None)?.clip;
        let joints = self.clip.skeleton.joints.len();
        let is_left = |frame: usize| {
            let own = frame * joints..(frame + 1) * joints;
            done.clip.root_positions[frame] == grounded.root_positions[frame]
                && done.clip.rotations[own.clone()] == grounded.rotations[own]
        };
        match left.iter().flat_map(|flight| flight.first..=flight.last).find(|frame| !is_left(*frame)) {
            Some(frame) => Err(format!("{name}: frame {frame} of a flight that is left has changed").into()),
            None => Ok(done),
        }
    }

    /// Mean distances by both filters, millimetres, by the route that knows nothing of touch-ups.
    fn distances(&self, clip: &Clip) -> [f64; 2] {
        let posed = PosedClip::of(clip);
        [Filter::Gaussian, Filter::Butterworth].map(|filter| {
            let forces =
                link_forces(&self.body, &posed, &ForceSettings { filter, ..ForceSettings::default() });
            let summary = distance_summary(&balances(&self.body, &posed, &self.stages, &forces));
            summary.map_or(0.0, |summary| summary.mean * 1e3)
        })
    }

    /// How far `clip` has the farthest point of a foot that bears from where the edit has it, metres.
    fn farthest_plant(&self, clip: &Clip) -> f64 {
        let [before, after] = [&self.clip, clip].map(PosedClip::of);
        let mut farthest = 0.0_f64;
        for support in &self.stages.supports {
            for frame in (0..before.frame_count()).filter(|frame| support.bears[*frame]) {
                for point in &support.points {
                    let [from, to] = [&before, &after].map(|posed| point.place(posed.frame(frame)));
                    farthest = farthest.max(from.distance(to));
                }
            }
        }
        farthest
    }
}
