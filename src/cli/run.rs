//! `cotillion run`: a scene in, its motion out.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use cotillion::discrete::drags::perform;
use cotillion::discrete::outcome::Outcome;
use cotillion::edit::error::Named;
use cotillion::edit::{Backend, Edit, EditError, Editor};
use cotillion::embody::embody;
use cotillion::export::files::{OutputFile, write_all};
use cotillion::export::picture::to_png;
use cotillion::export::report::{Report, Timing, report};
use cotillion::export::scene::scene_files;
use cotillion::export::strips::strip_files;
use cotillion::graph::scene::{graph_settings, scene_clips};
use cotillion::graph_cache::cached_graph;
use cotillion::resample::{TooLong, resample};
use cotillion::scene::{ClipFolders, Diagnostic, Loaded, Scene, Severity, load};

use super::output::{Output, PlainError};
use super::summary::summary;
use super::{Failure, RunArgs};

pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let bvh = args.bvh.options().map_err(|error| output.fail(error))?;
    let bar = output.progress(5);
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
    let (solved, before) = solved(scene, args, (&mut timing, &bar), &output).map_err(|error| {
        bar.finish_and_clear();
        output.diagnostics(&unsatisfiable(&args.scene, &text, &error), &text);
        Failure::Unsatisfiable
    })?;
    let mut files = Vec::new();
    let mut full_body = 0.0;
    let sampled = timed(&mut timing.export, || {
        bar.set_message("sampling");
        let (scene, edit) = (&solved.scene, &solved.edit);
        let mut resampled = resample(scene, edit)?;
        bar.inc(1);
        bar.set_message("feet and hands");
        let embodied = timed(&mut full_body, || embody(scene, edit, &mut resampled));
        bar.set_message("writing");
        let before = before.as_ref().map(|before| (&solved.original, before));
        files = scene_files((scene, edit), before, &resampled, &bvh);
        if args.strip {
            files.extend(strip_files(scene, edit, &resampled));
        }
        Ok(report(&embodied, &solved, &resampled))
    });
    timing.full_body = full_body;
    timing.export -= full_body;
    let mut told = sampled.map_err(|error: TooLong| {
        bar.finish_and_clear();
        let help = Some("give times nearer to 0 and to each other".to_owned());
        let (file, message) = (args.scene.display().to_string(), error.to_string());
        output.errors(&[PlainError { file, line: 0, column: 0, message, help }]);
        Failure::Unsatisfiable
    })?;
    if args.png {
        let drawn = timed(&mut timing.export, || pngs(&files, args.png_width, &output))?;
        files.extend(drawn);
    }
    timing.export += write(args, &mut told, files, timing).map_err(|error| {
        bar.finish_and_clear();
        output.unwritable(&error.path, &error.source)
    })?;
    bar.finish_and_clear();
    told.timing_ms = timing;
    output.say(&summary(&told, &args.output));
    output.print_json(&told);
    Ok(())
}

/// Writes all files, `report.json` the last of them; milliseconds it took.
fn write(
    args: &RunArgs,
    told: &mut Report,
    mut files: Vec<OutputFile>,
    timing: Timing,
) -> Result<f64, cotillion::export::files::WriteError> {
    told.files = files.iter().map(|file| file.name.clone()).collect();
    told.timing_ms = timing;
    let text = format!("{}\n", serde_json::to_string_pretty(told).unwrap_or_default());
    files.push(OutputFile { name: "report.json".to_owned(), bytes: text.into_bytes() });
    let mut milliseconds = 0.0;
    timed(&mut milliseconds, || write_all(&args.output, &files))?;
    Ok(milliseconds)
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
fn timed<T>(milliseconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *milliseconds += start.elapsed().as_secs_f64() * 1e3;
    result
}

/// Every SVG among `files` as PNG.
fn pngs(files: &[OutputFile], width: u32, output: &Output) -> Result<Vec<OutputFile>, Failure> {
    let svgs = files.iter().filter_map(|file| Some((file.name.strip_suffix(".svg")?, &file.bytes)));
    let drawn = svgs.map(|(stem, svg)| {
        let name = format!("{stem}.png");
        to_png(&String::from_utf8_lossy(svg), width)
            .map_err(|error| (name.clone(), error))
            .map(|bytes| OutputFile { name, bytes })
    });
    drawn.collect::<Result<_, _>>().map_err(|(file, error)| {
        let help = Some("run without --png: the SVG holds the same picture".to_owned());
        output.errors(&[PlainError { file, line: 0, column: 0, message: error.to_string(), help }]);
        Failure::BadInput
    })
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
