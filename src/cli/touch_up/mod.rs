//! `cotillion touch-up`: a clip in, a physically plausible one out.

mod args;
mod subject;
mod summary;

use std::time::Instant;

use cotillion::clip::Clip;
use cotillion::export::bvh::to_bvh_with;
use cotillion::export::files::{OutputFile, file_names, write_all};
use cotillion::export::picture::{Company, StripOptions, TouchUpCurves, strip_svg, touch_up_svg};
use cotillion::export::touch_up_report::{
    BodyPart, FlaggedFrames, FlightPart, GroundPart, JudgedReport, TouchUpReport, TurnReport,
};
use cotillion::physics::course::{Course, course};
use cotillion::physics::ground::report::{GroundReport, Judged, largest_change};
use cotillion::physics::touch_up::{TouchedUp, touch_up};

pub(crate) use self::args::TouchUpArgs;
use self::subject::{Subject, subject};
use super::Failure;
use super::capture::plain;
use super::output::{Output, PlainError};

pub(crate) fn command(args: &TouchUpArgs) -> Result<(), Failure> {
    let output = Output::new(args.manner);
    let start = Instant::now();
    let faults = args.faults();
    if !faults.is_empty() {
        output.errors(&faults);
        return Err(Failure::BadInput);
    }
    let subject = subject(args).map_err(|error| output.fail(error))?;
    let result = Finished::of(args, &subject).map_err(|error| output.fail(error))?;
    write_all(&args.output, &result.files).map_err(|error| output.unwritable(&error.path, &error.source))?;
    output.say(&summary::summary(&result.report, &args.output, start.elapsed().as_secs_f64()));
    output.print_json(&result.report);
    Ok(())
}

/// A touch-up with its files, the report among them.
struct Finished {
    report: TouchUpReport,
    files: Vec<OutputFile>,
}

impl Finished {
    fn of(args: &TouchUpArgs, subject: &Subject) -> Result<Self, PlainError> {
        let name = file_names(&[&subject.clip.name]).remove(0);
        refuse_own_file(args, &name)?;
        let Subject { clip, body, stages, source, .. } = subject;
        let touched =
            touch_up(clip, body, stages, source.as_ref(), &args.work.settings()).map_err(|error| {
                let help = "name another clip, or leave out what is asked for beyond the defaults".to_owned();
                plain(&args.clip.display().to_string(), error.to_string(), Some(help))
            })?;
        let courses = [course(clip, body, stages), course(&touched.clip, body, stages)];
        let bvh = to_bvh_with(&touched.clip, &args.bvh.options()?).into_bytes();
        let mut files = vec![OutputFile { name: format!("{name}.bvh"), bytes: bvh }];
        if args.plots {
            let bytes = plots(subject, &touched, &courses).into_bytes();
            files.push(OutputFile { name: format!("{name}.curves.svg"), bytes });
        }
        if args.strip {
            files.extend([(clip, "before"), (&touched.clip, "after")].map(|own| strip(own, &name)));
        }
        let mut report = report(args, subject, (&touched, &courses[1]));
        report.files = files.iter().map(|file| file.name.clone()).collect();
        let text = serde_json::to_string_pretty(&report)
            .map_err(|error| plain("report.json", error.to_string(), None))?;
        files.push(OutputFile { name: "report.json".to_owned(), bytes: format!("{text}\n").into_bytes() });
        Ok(Self { report, files })
    }
}

/// A capture is not overwritten by its touch-up.
fn refuse_own_file(args: &TouchUpArgs, name: &str) -> Result<(), PlainError> {
    let own = args.output.join(format!("{name}.bvh"));
    let is_read = |path: &std::path::PathBuf| {
        std::fs::canonicalize(path).is_ok_and(|path| std::fs::canonicalize(&own).is_ok_and(|own| own == path))
    };
    if std::iter::once(&args.clip).chain(&args.edit.blend).chain(&args.work.source).any(is_read) {
        let message = "this file is read, and would be overwritten".to_owned();
        let help = Some("name another folder; captures are never overwritten".to_owned());
        return Err(plain(&own.display().to_string(), message, help));
    }
    Ok(())
}

fn plots(subject: &Subject, touched: &TouchedUp, [before, after]: &[Course; 2]) -> String {
    let ground = &touched.ground;
    let mean = |judged: &Judged| judged.distance.map(|own| own.map_or(0.0, |own| own.mean));
    let mut steps = vec![mean(&ground.before)];
    steps.extend(ground.steps.iter().map(|step| mean(&step.judged)));
    let subtitle = subtitle(subject, ground);
    touch_up_svg(&TouchUpCurves {
        title: &subject.clip.name,
        subtitle: &subtitle,
        fps: subject.clip.fps,
        before,
        after,
        stages: &subject.stages,
        steps: &steps,
        kept: ground.kept,
    })
}

fn subtitle(subject: &Subject, ground: &GroundReport) -> String {
    let mean = |judged: &Judged| {
        let [own, six] = judged.distance.map(|own| own.map_or(0.0, |own| own.mean * 1e3));
        format!("{own:.1} mm ({six:.1} at 6 Hz)")
    };
    let edits: String = subject.edits.iter().map(|edit| format!("{edit}; ")).collect();
    format!("{edits}mean distance on the ground {} → {}", mean(&ground.before), mean(&ground.after))
}

fn strip((clip, when): (&Clip, &str), name: &str) -> OutputFile {
    let named = Clip { name: format!("{}, {when}", clip.name), ..clip.clone() };
    let svg = strip_svg(&named, &Company::default(), &StripOptions::default());
    OutputFile { name: format!("{name}.{when}.svg"), bytes: svg.into_bytes() }
}

fn report(args: &TouchUpArgs, subject: &Subject, (touched, after): (&TouchedUp, &Course)) -> TouchUpReport {
    let Subject { clip, body, .. } = subject;
    let flights = FlightPart::all(touched, &subject.stages.flights);
    let flagged_frames = FlaggedFrames::of(after, &after.pulled_down, body.stature);
    TouchUpReport {
        clip: args.clip.display().to_string(),
        cotillion: env!("CARGO_PKG_VERSION"),
        fps: clip.fps,
        frames: clip.frame_count(),
        first_frame: subject.first_frame,
        seconds: (clip.frame_count() - 1) as f64 / clip.fps,
        edits: subject.edits.clone(),
        settings: args.work.report(),
        body: BodyPart::of(body, args.body.table.name(), subject.estimate.clone()),
        ground: GroundPart::of(&touched.ground, clip),
        result: JudgedReport::from(&Judged { distance: after.summaries, miss: None }),
        largest_change: largest_change(clip, &touched.clip).map(|change| TurnReport::of(&change, clip)),
        doubts: doubts(subject, touched, &flagged_frames),
        flights,
        flagged_frames,
        notes: subject.notes.clone(),
        files: Vec::new(),
    }
}

/// Estimated masses farther than this from the table's are doubtful.
const FAR_FACTOR: f64 = 2.0;

/// What to think about before the result is used.
fn doubts(subject: &Subject, touched: &TouchedUp, flagged: &FlaggedFrames) -> Vec<String> {
    let mut doubts: Vec<String> = Vec::new();
    let doubtful = subject.stages.flights.iter().filter(|flight| flight.is_doubtful());
    doubts.extend(doubtful.map(ToString::to_string));
    let far = touched.flight.flights.iter().filter(|facts| facts.turns_far());
    doubts.extend(far.map(|facts| {
        format!(
            "the flight of frames {} to {} turns by {:.0}°",
            facts.first,
            facts.last,
            facts.largest_turn.to_degrees()
        )
    }));
    if touched.ground.before.distance[0].is_none() {
        doubts.push("nothing bears the body long enough to tell a zero moment point".to_owned());
    }
    if !flagged.pulled_down.is_empty() {
        let count = flagged.pulled_down.len();
        doubts.push(format!("labels: {count} stretches stand on the ground and are pulled down"));
    }
    if let Some(estimate) = subject.estimate.as_ref().filter(|own| own.largest_change > FAR_FACTOR - 1.0) {
        let percent = 100.0 * estimate.largest_change;
        doubts.push(format!("masses by {}: a segment is {percent:.0} % off the table", estimate.by));
    }
    doubts
}
