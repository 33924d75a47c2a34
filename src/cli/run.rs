//! `cotillion run`: a scene in, its motion out.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use cotillion::discrete::drags::perform;
use cotillion::discrete::outcome::Outcome;
use cotillion::edit::error::Named;
use cotillion::edit::{Backend, Edit, EditError, Editor};
use cotillion::export::bvh::BvhOptions;
use cotillion::export::files::{OutputFile, Staging, WriteError};
use cotillion::export::parts::MANY;
use cotillion::export::report::Timing;
use cotillion::export::shards::ShardFiles;
use cotillion::graph::scene::{graph_settings, scene_clips};
use cotillion::graph_cache::cached_graph;
use cotillion::scene::{ClipFolders, Diagnostic, Loaded, Scene, Severity, load};

use super::interrupt;
use super::output::{Output, PlainError};
use super::produce::{Order, Produced, Unproduced, of_shard, produce};
use super::summary::summary;
use super::{Failure, RunArgs};

pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let bvh = args.bvh.options().map_err(|error| output.fail(error))?;
    let bar = output.progress(3);
    let mut timing = Timing::default();
    bar.set_message("reading");
    let Loaded { scene, warnings, text } =
        timed(&mut timing.load, || load(&args.scene, &ClipFolders::from_environment())).map_err(
            |faults| {
                bar.finish_and_clear();
                output.faults(&[faults]);
                Failure::BadInput
            },
        )?;
    bar.suspend(|| output.warnings(&warnings, &text));
    bar.inc(1);
    if args.plots && scene.physics.is_none() {
        bar.finish_and_clear();
        return Err(output.fail(nothing_to_plot(args)));
    }
    let (solved, before) = solved(scene, args, (&mut timing, &bar), &output).map_err(|error| {
        bar.finish_and_clear();
        output.diagnostics(&unsatisfiable(&args.scene, &text, &error), &text);
        Failure::Unsatisfiable
    })?;
    bar.finish_and_clear();
    let staging =
        Staging::begin(&args.output).map_err(|error| output.unwritable(&error.path, &error.source))?;
    interrupt::watch(&staging);
    let bodies = output.progress_of("characters");
    let order = Order { solved: &solved, before: before.as_ref(), args, bvh: &bvh };
    let produced = produce(&order, &staging, (&mut timing, &bodies));
    bodies.finish_and_clear();
    let mut produced = produced.map_err(|error| unproduced(args, &output, error))?;
    produced.report.timing_ms = timing;
    timed(&mut timing.export, || write(&order, &produced, staging))
        .map_err(|error| output.unwritable(&error.path, &error.source))?;
    produced.report.timing_ms = timing;
    let many = solved.scene.characters.len() > MANY;
    output.say(&summary(&produced.report, many, &args.output));
    output.print_json(&produced.report);
    Ok(())
}

fn nothing_to_plot(args: &RunArgs) -> PlainError {
    PlainError {
        file: args.scene.display().to_string(),
        line: 0,
        column: 0,
        message: "--plots draws what the touch-up changes, and this scene has none".to_owned(),
        help: Some("add a table [physics] with touch_up = true, or leave --plots out".to_owned()),
    }
}

/// Adds the report to the files of a result and gives all their names.
fn write(order: &Order<'_>, produced: &Produced, staging: Staging) -> Result<(), WriteError> {
    let (name, value) = match order.args.shard {
        Some(shard) => {
            let files = files_of_shard(order, &produced.report.files, &staging)?;
            let told = of_shard(shard, order.solved, &produced.report, (&produced.own, files));
            (shard.report_name(), told)
        }
        None => ("report.json".to_owned(), serde_json::to_value(&produced.report).unwrap_or_default()),
    };
    let text = format!("{}\n", serde_json::to_string_pretty(&value).unwrap_or_default());
    staging.add(&OutputFile { name, bytes: text.into_bytes() })?;
    staging.commit()
}

/// What shapes the files of a shard, how large they are, and their digests. Cost: one pass over them.
fn files_of_shard(order: &Order<'_>, names: &[String], staging: &Staging) -> Result<ShardFiles, WriteError> {
    let RunArgs { png, png_width, animate, strip, plots, bvh_files, .. } = order.args;
    let asked = [
        (*png, "--png"),
        (*animate, "--animate"),
        (*strip, "--strip"),
        (*plots, "--plots"),
        (*bvh_files, "--bvh-files"),
    ];
    let mut options: Vec<String> =
        asked.iter().filter(|(is_asked, _)| *is_asked).map(|(_, name)| (*name).to_owned()).collect();
    options.extend(png.then(|| format!("--png-width {png_width}")));
    options.extend((*order.bvh != BvhOptions::default()).then(|| format!("{:?}", order.bvh)));
    let bytes: Result<Vec<u64>, WriteError> = names.iter().map(|name| staging.size(name)).collect();
    let digests: Result<Vec<String>, WriteError> = names.iter().map(|name| staging.digest(name)).collect();
    Ok(ShardFiles { options: options.join(" "), bytes: bytes?, digests: digests? })
}

/// Tells why there are no files.
fn unproduced(args: &RunArgs, output: &Output, error: Unproduced) -> Failure {
    let plain = |file: String, message: String, help: &str| {
        output.errors(&[PlainError { file, line: 0, column: 0, message, help: Some(help.to_owned()) }]);
    };
    match error {
        Unproduced::TooLong(error) => {
            plain(
                args.scene.display().to_string(),
                error.to_string(),
                "give times nearer to 0 and to each other; a relay is shorter with more boxes",
            );
            Failure::Unsatisfiable
        }
        Unproduced::Write(error) => output.unwritable(&error.path, &error.source),
        Unproduced::Png(file, message) => {
            plain(file, message, "run without --png: the SVG holds the same picture");
            Failure::BadInput
        }
    }
}

/// The scene after its drags and discrete changes, and the edit before its drags, if it has any.
fn solved(
    scene: Scene,
    args: &RunArgs,
    (timing, bar): (&mut Timing, &indicatif::ProgressBar),
    output: &Output,
) -> Result<(Outcome, Option<Edit>), EditError> {
    if scene.drags.is_empty() && scene.discrete.is_none() {
        return Ok((Outcome::plain(solve(scene, args.backend.into(), timing, bar)?.into_parts()), None));
    }
    let clips = if scene.discrete.is_some() { scene_clips(&scene) } else { Vec::new() };
    let settings = graph_settings(scene.mode);
    bar.set_message("comparing frames");
    let (graph, notes) =
        timed(&mut timing.discrete, || cached_graph(&clips, &settings, args.cache.folder().as_deref()));
    bar.suspend(|| notes.iter().for_each(|note| output.note(&note.to_string())));
    bar.inc(1);
    let told = |done: usize, all: usize| bar.set_message(format!("dragging: {done} of {all}"));
    let editor = timed(&mut timing.solve, || perform(scene, Arc::new(graph), &clips, told))?;
    bar.inc(1);
    let outcome = editor.into_outcome();
    if outcome.original.drags.is_empty() {
        return Ok((outcome, None));
    }
    let before = timed(&mut timing.solve, || Editor::new(outcome.original.clone())?.solve().cloned())?;
    Ok((outcome, Some(before)))
}

fn solve(
    scene: Scene,
    backend: Backend,
    timing: &mut Timing,
    bar: &indicatif::ProgressBar,
) -> Result<Editor, EditError> {
    bar.set_message("assembling");
    let mut editor = timed(&mut timing.assemble, || Editor::assemble(scene, backend));
    timed(&mut timing.factor, || editor.factor())?;
    bar.inc(1);
    bar.set_message("solving");
    timed(&mut timing.solve, || editor.solve().map(|_: &Edit| ()))?;
    bar.inc(1);
    Ok(editor)
}

/// Calls `work` and adds the milliseconds it took.
pub(crate) fn timed<T>(milliseconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *milliseconds += start.elapsed().as_secs_f64() * 1e3;
    result
}

/// What to tell of a scene without an answer: at the last constraint it concerns what is wrong and the remedy, then the
/// others.
fn unsatisfiable(scene: &Path, text: &str, error: &EditError) -> Vec<Diagnostic> {
    let (constraints, help): (&[Named], _) = match error {
        EditError::Conflict { constraints, .. } | EditError::TimeConflict { constraints, .. } => {
            (constraints, "change or remove one of them, or give one a weight as its strength")
        }
        EditError::InfeasibleTimes { constraints, .. } => (
            constraints,
            "change one of these times by what is missing, or widen min_step and max_step in [warp]",
        ),
        EditError::BackwardTime { .. } => (&[], "add min_step = 0.5 to the table [warp]"),
        EditError::CarriesOverlap { second, .. } => (
            std::slice::from_ref(second),
            "add a [[sync]] of its first moment with the release before, or a [[time]] for either",
        ),
        EditError::HandsTaken { second, .. } => (
            std::slice::from_ref(second),
            "add a [[sync]] with an offset, so that one is released before the other is grasped, or a [[time]] for either",
        ),
        EditError::OwnLoad { constraint, .. } => (
            std::slice::from_ref(constraint),
            "hold the place before the grasp or after the release, or relative to something else",
        ),
        EditError::Unsettled(constraints) => {
            (constraints, "hold those who carry by pins, or relative to what they grasp")
        }
        _ => (&[], "make hard constraints that lie close together soft"),
    };
    let cause = std::error::Error::source(error).map_or(String::new(), |source| format!(": {source}"));
    let (last, others) = match constraints.split_last() {
        Some((last, others)) => (last.line as usize, others),
        None => (0, constraints),
    };
    let about = |line: usize, message: String, help: Option<String>| Diagnostic {
        file: scene.display().to_string(),
        line,
        column: usize::from(line > 0),
        span: line_span(text, line),
        field: None,
        message,
        help,
        severity: Severity::Fault,
    };
    let mut told = vec![about(last, format!("{error}{cause}"), Some(help.to_owned()))];
    told.extend(
        others.iter().map(|named| about(named.line as usize, format!("{named} has a share in this"), None)),
    );
    told
}

/// Bytes of line `line` of `text`, from 1; none for 0.
fn line_span(text: &str, line: usize) -> std::ops::Range<usize> {
    let mut start = 0;
    for (index, own) in text.split_inclusive('\n').enumerate() {
        if index + 1 == line {
            return start..start + own.trim_end().len();
        }
        start += own.len();
    }
    0..0
}
