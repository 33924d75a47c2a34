//! `cotillion touch-up`: a clip in, a physically plausible one out.

mod args;
mod subject;
mod summary;

use std::time::Instant;

use cotillion::clip::Clip;
use cotillion::export::bvh::to_bvh_with;
use cotillion::export::files::{OutputFile, file_names, write_all};
use cotillion::export::masses_report::{BodyPart, EstimatePart};
use cotillion::export::physics_report::curves_svg;
use cotillion::export::picture::{Company, StripOptions, strip_svg};
use cotillion::export::touch_up_report::{TouchUpPart, TouchUpReport};
use cotillion::physics::course::{Course, course};
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

fn plots(subject: &Subject, touched: &TouchedUp, courses: &[Course; 2]) -> String {
    let edits: String = subject.edits.iter().map(|edit| format!("{edit}; ")).collect();
    let about = (subject.clip.name.as_str(), edits.as_str());
    curves_svg(about, (&subject.clip, &subject.stages), courses, &touched.ground)
}

fn strip((clip, when): (&Clip, &str), name: &str) -> OutputFile {
    let named = Clip { name: format!("{}, {when}", clip.name), ..clip.clone() };
    let svg = strip_svg(&named, &Company::default(), &StripOptions::default());
    OutputFile { name: format!("{name}.{when}.svg"), bytes: svg.into_bytes() }
}

fn report(args: &TouchUpArgs, subject: &Subject, (touched, after): (&TouchedUp, &Course)) -> TouchUpReport {
    let Subject { clip, body, stages, .. } = subject;
    let mut done = TouchUpPart::of(touched, [clip, &touched.clip], (body, stages), after);
    done.doubts.extend(subject.estimate.iter().flat_map(EstimatePart::doubts));
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
        done,
        notes: subject.notes.clone(),
        files: Vec::new(),
    }
}
