//! The bodies and files of a solved scene, one part after the other.

use std::collections::BTreeSet;

use cotillion::discrete::outcome::Outcome;
use cotillion::edit::{Edit, Moved};
use cotillion::embody::{Embodied, closed_groups, embody_some};
use cotillion::export::bvh::BvhOptions;
use cotillion::export::files::{OutputFile, Staging, WriteError};
use cotillion::export::parts::{MANY, OF_A_PART, Part, parts};
use cotillion::export::physics_report::{courses, curves_svg};
use cotillion::export::picture::to_png;
use cotillion::export::report::{PartReport, Report, Setting, Timing, is_told, part_report, whole_report};
use cotillion::export::scene::{animation, names, part_files, pictures};
use cotillion::export::shards::{Shard, ShardFiles, shard_report};
use cotillion::export::strips::strip_files;
use cotillion::geometry::c64;
use cotillion::index::CharacterId;
use cotillion::object_motion::object_motions;
use cotillion::plausible::{NotTouched, TouchUps, Touched, make_plausible};
use cotillion::reach::Stage;
use cotillion::resample::{Resampled, TooLong, resample_some};
use cotillion::residual::{Demands, Stances};
use cotillion::ties::Ties;
use indicatif::ProgressBar;
use rayon::prelude::*;

use super::RunArgs;
use super::run::timed;

/// Why there are no files.
pub(crate) enum Unproduced {
    TooLong(TooLong),
    Write(WriteError),
    /// A picture cannot be drawn: its name, and why.
    Png(String, String),
}

impl From<TooLong> for Unproduced {
    fn from(error: TooLong) -> Self {
        Self::TooLong(error)
    }
}

impl From<WriteError> for Unproduced {
    fn from(error: WriteError) -> Self {
        Self::Write(error)
    }
}

/// A solved scene, before its drags too if it has any, and what is asked for.
pub(crate) struct Order<'a> {
    pub(crate) solved: &'a Outcome,
    pub(crate) before: Option<&'a Edit>,
    pub(crate) args: &'a RunArgs,
    pub(crate) bvh: &'a BvhOptions,
}

/// What was made, and of whom.
pub(crate) struct Produced {
    pub(crate) report: Report,
    pub(crate) own: BTreeSet<CharacterId>,
}

/// Makes all files but the report, puts them into `staging`, and reports.
pub(crate) fn produce(
    order: &Order<'_>,
    staging: &Staging,
    (timing, bar): (&mut Timing, &ProgressBar),
) -> Result<Produced, Unproduced> {
    let solved = order.solved;
    let (scene, edit) = (&solved.scene, &solved.edit);
    let moved = Moved { scene, characters: &edit.characters };
    let (objects, ties) = (object_motions(scene, &moved), Ties::of(scene));
    let stage = Stage { scene, performance: &moved, objects: &objects, ties: &ties };
    let demands = Demands::of((scene, edit), &objects);
    let places: Vec<c64> = edit.characters.iter().map(|own| own.positions[0]).collect();
    let parts = parts(scene, &ties, &places);
    let own = order.args.shard.map_or(&parts[..], |shard| shard.of_parts(&parts));
    let clock = resample_some(scene, edit, &[])?;
    let setting =
        Setting { stage, demands: &demands, outcome: solved, clock: (clock.start_time, clock.frames) };
    let maker = Maker { order, setting: &setting, staging, names: names(scene) };
    bar.set_length(own.iter().map(|part| part.members.len() as u64).sum());
    let mut told = PartReport::default();
    let mut files = Vec::new();
    for part in own {
        let (report, named) = maker.part(part, (timing, bar))?;
        told = told.and(report);
        files.extend(named);
    }
    if order.args.shard.is_none_or(|shard| shard.number == shard.of) {
        let before = order.before.map(|before| (&solved.original, before));
        let drawn = timed(&mut timing.export, || pictures((scene, edit), before));
        files.extend(maker.keep(drawn, timing)?);
        if order.args.animate {
            let drawn = timed(&mut timing.export, || animation((scene, edit)));
            staging.add(&drawn)?;
            files.push(drawn.name);
        }
    }
    let beside = maker.stances_beside(&told, timing)?;
    told.stances.extend(beside);
    let own = told.members();
    Ok(Produced { own, report: Report { files, ..whole_report(&setting, told) } })
}

/// The shard's report: with its own characters, and nothing of constraints of which it knows nothing.
pub(crate) fn of_shard(
    shard: Shard,
    solved: &Outcome,
    told: &Report,
    (own, files): (&BTreeSet<CharacterId>, ShardFiles),
) -> serde_json::Value {
    let scene = &solved.scene;
    let mut report = serde_json::to_value(told).unwrap_or_default();
    if let Some(constraints) = report.get_mut("constraints").and_then(|own| own.as_array_mut()) {
        let untold = constraints.iter_mut().zip(is_told(scene, own)).filter(|(_, told)| !told);
        untold.for_each(|(constraint, _)| *constraint = serde_json::Value::Null);
    }
    shard_report(shard, own, scene.characters.len(), files, report)
}

/// Every SVG among `files` as PNG.
fn pngs(files: &[OutputFile], width: u32) -> Result<Vec<OutputFile>, Unproduced> {
    let svgs = files.iter().filter_map(|file| Some((file.name.strip_suffix(".svg")?, &file.bytes)));
    let drawn = svgs.map(|(stem, svg)| {
        let name = format!("{stem}.png");
        to_png(&String::from_utf8_lossy(svg), width)
            .map_err(|error| Unproduced::Png(name.clone(), error.to_string()))
            .map(|bytes| OutputFile { name, bytes })
    });
    drawn.collect()
}

/// Bodies of those in `resampled`, made plausible where the scene wants it.
fn plausible<'a>(
    stage: &Stage<'_, Moved<'a>>,
    resampled: &mut Resampled,
    timing: &mut Timing,
) -> (Embodied<'a>, TouchUps) {
    let mut embodied = timed(&mut timing.full_body, || embody_some(stage, resampled));
    let touch_ups = timed(&mut timing.physics, || make_plausible(stage, &mut embodied, resampled));
    (embodied, touch_ups)
}

/// Curves of everybody who was touched up.
fn curve_files(touch_ups: &TouchUps, resampled: &Resampled, names: &[String]) -> Vec<OutputFile> {
    let file = |(who, touched): (&CharacterId, &Result<Touched, NotTouched>)| {
        let touched = touched.as_ref().ok()?;
        let written = resampled.clip(*who)?;
        let about = (written.name.as_str(), "");
        let motion = (&touched.before, &touched.stages);
        let svg = curves_svg(about, motion, &courses(touched, written), &touched.done.ground);
        let name = format!("{}.curves.svg", names[who.as_usize()]);
        Some(OutputFile { name, bytes: svg.into_bytes() })
    };
    touch_ups.par_iter().filter_map(file).collect()
}

/// Makes the files of parts.
struct Maker<'a> {
    order: &'a Order<'a>,
    setting: &'a Setting<'a>,
    staging: &'a Staging,
    names: Vec<String>,
}

impl Maker<'_> {
    /// Report and names of the files of one part.
    fn part(
        &self,
        part: &Part,
        (timing, bar): (&mut Timing, &ProgressBar),
    ) -> Result<(PartReport, Vec<String>), Unproduced> {
        let Setting { stage, outcome, .. } = self.setting;
        let (scene, edit) = (stage.scene, &outcome.edit);
        // Bodies are about half of the work, files the other.
        let half = part.members.len() as u64 / 2;
        let mut resampled = timed(&mut timing.export, || resample_some(scene, edit, &part.members))?;
        let (embodied, touch_ups) = plausible(stage, &mut resampled, timing);
        bar.inc(half);
        let args = self.order.args;
        let writes_bvh = args.bvh_files || scene.characters.len() <= MANY;
        let (report, files) = timed(&mut timing.export, || {
            let bvh = writes_bvh.then_some(self.order.bvh);
            let made = (part, &resampled);
            let mut files = part_files((stage.performance, stage.objects), made, &self.names, bvh);
            if args.strip {
                files.extend(strip_files(scene, edit, &resampled, &self.names));
            }
            if args.plots {
                files.extend(curve_files(&touch_ups, &resampled, &self.names));
            }
            let report = part_report(self.setting, &embodied, &resampled);
            (report.with_physics(&touch_ups, &resampled), files)
        });
        let named = self.keep(files, timing)?;
        bar.inc(part.members.len() as u64 - half);
        Ok((report, named))
    }

    /// Puts files aside, pictures as PNG too where asked for; their names.
    fn keep(&self, files: Vec<OutputFile>, timing: &mut Timing) -> Result<Vec<String>, Unproduced> {
        timed(&mut timing.export, || {
            let drawn =
                if self.order.args.png { pngs(&files, self.order.args.png_width)? } else { Vec::new() };
            let mut names = Vec::new();
            for file in files.into_iter().chain(drawn) {
                self.staging.add(&file)?;
                names.push(file.name);
            }
            Ok(names)
        })
    }

    /// Where those are to whom the characters of a shard are held, and who are in another one: their bodies are made for that, with
    /// those whom they reach and no others.
    fn stances_beside(&self, told: &PartReport, timing: &mut Timing) -> Result<Stances, Unproduced> {
        let Setting { stage, demands, outcome, .. } = self.setting;
        let own = told.members();
        let beside = demands.beside(|who| own.contains(&who));
        let is_beside = |who: &CharacterId| beside.binary_search(who).is_ok();
        let mut stances = Stances::default();
        if beside.is_empty() {
            return Ok(stances);
        }
        let groups: Vec<Vec<CharacterId>> = closed_groups(stage.scene, stage.ties)
            .into_iter()
            .filter(|group| group.iter().any(is_beside))
            .collect();
        for some in groups.chunks(OF_A_PART) {
            let mut members = some.concat();
            members.sort_unstable();
            let mut resampled = resample_some(stage.scene, &outcome.edit, &members)?;
            let (embodied, _) = plausible(stage, &mut resampled, timing);
            for who in members.into_iter().filter(is_beside) {
                stances.extend(demands.stances((stage.scene, &outcome.edit), &embodied, who));
            }
        }
        Ok(stances)
    }
}
