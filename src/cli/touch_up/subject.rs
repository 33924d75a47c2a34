//! The motion that is touched up, and what is known of the one it was edited from.

use std::path::Path;

use cotillion::clip::Clip;
use cotillion::clip::derived::{Blended, bent, blended, tilted, usable_part};
use cotillion::clip::read::ReadOptions;
use cotillion::export::masses_report::EstimatePart;
use cotillion::physics::blended_source::blended_source;
use cotillion::physics::body_model::{BodyError, BodyModel, body_model};
use cotillion::physics::ground::target::Source;
use cotillion::physics::masses::{
    FlightMassSettings, MassError, MassSettings, masses_from_flight, masses_from_ground,
};
use cotillion::physics::posed::PosedClip;
use cotillion::physics::stages::{StageSettings, Stages, stages};

use super::args::TouchUpArgs;
use crate::cli::capture::plain;
use crate::cli::output::PlainError;

/// Everything a touch-up works on.
pub(super) struct Subject {
    /// As it comes, edits done.
    pub(super) clip: Clip,
    pub(super) body: BodyModel,
    /// Of the motion that was edited, where it is known.
    pub(super) stages: Stages,
    pub(super) source: Option<Source>,
    pub(super) estimate: Option<EstimatePart>,
    /// Frame of the file that is frame 0.
    pub(super) first_frame: u32,
    pub(super) edits: Vec<String>,
    pub(super) notes: Vec<String>,
}

/// A clip before its edits.
struct Base {
    clip: Clip,
    first_frame: u32,
    notes: Vec<String>,
}

/// Fewer frames have no accelerations.
const FEWEST_FRAMES: usize = 3;

pub(super) fn subject(args: &TouchUpArgs) -> Result<Subject, PlainError> {
    let options = args.read.options()?;
    let base = read(args, &args.clip, &options)?;
    let other = args.edit.blend.as_deref().map(|path| read(args, path, &options)).transpose()?;
    let named = args.work.source.as_deref().map(|path| read(args, path, &options)).transpose()?;
    let Base { clip, first_frame, mut notes } = base;
    for other in other.iter().chain(&named) {
        notes.extend(other.notes.iter().cloned());
    }
    let table = body_of(args, &clip)?;
    let (body, estimate) = estimated(args, &clip, table)?;
    let (start, blend) = match &other {
        None => (clip.clone(), None),
        Some(other) => {
            let blend = blended(&clip, &other.clip).map_err(|error| {
                let help = "name a clip of the same body at the same rate, in which each foot strikes the floor twice";
                plain("--blend", error.to_string(), Some(help.to_owned()))
            })?;
            (blend.clip.clone(), Some(blend))
        }
    };
    let (edited, edits) = edited(args, &start)?;
    let (stages, source) = match (&named, &blend, &other) {
        (Some(source), ..) => of_source(&edited, &source.clip, &body)?,
        (None, Some(blend), Some(other)) => of_blend(blend, [&clip, &other.clip], &body),
        _ if edits.is_empty() => (stages_of(&edited, &body), None),
        _ => {
            let stages = stages_of(&start, &body);
            let source = Source::of(&start, &body, &stages);
            (stages, Some(source))
        }
    };
    Ok(Subject { clip: edited, body, stages, source, estimate, first_frame, edits, notes })
}

fn read(args: &TouchUpArgs, path: &Path, options: &ReadOptions) -> Result<Base, PlainError> {
    let read = args.read.read(path, options)?;
    let clip = usable_part(&read.clip);
    if clip.frame_count() < FEWEST_FRAMES {
        let message = format!("{} frames have no accelerations", clip.frame_count());
        let help = format!("name a clip, or a range, of at least {FEWEST_FRAMES} frames");
        return Err(plain(&path.display().to_string(), message, Some(help)));
    }
    let notes = read.notes.iter().map(ToString::to_string).collect();
    Ok(Base { clip, first_frame: read.clip.usable.0.0, notes })
}

fn body_of(args: &TouchUpArgs, clip: &Clip) -> Result<BodyModel, PlainError> {
    body_model(&clip.skeleton, &args.body.settings()).map_err(|error| {
        let help = match error {
            BodyError::NoMass { .. } => "give --mass a number of kilograms above 0",
            BodyError::NoStature { .. } => "give the clip its right --unit",
            _ => "name what is there with --role, as in --role left_hip=LeftUpLeg; bodies need a trunk and two legs",
        };
        plain(&args.clip.display().to_string(), error.to_string(), Some(help.to_owned()))
    })
}

fn stages_of(clip: &Clip, body: &BodyModel) -> Stages {
    stages(clip, body, &PosedClip::of(clip), &StageSettings::default())
}

/// The body with masses fitted to `clip`, where asked for.
fn estimated(
    args: &TouchUpArgs,
    clip: &Clip,
    table: BodyModel,
) -> Result<(BodyModel, Option<EstimatePart>), PlainError> {
    if !args.body.masses {
        return Ok((table, None));
    }
    let posed = PosedClip::of(clip);
    let stages = stages(clip, &table, &posed, &StageSettings::default());
    let sound = stages.flights.iter().filter(|flight| !flight.is_doubtful());
    let flights: Vec<_> = sound.map(|flight| (&posed, flight.first, flight.last)).collect();
    let in_flight = masses_from_flight(&table, &flights, &FlightMassSettings::default());
    if let Some(fit) = in_flight.ok().filter(|fit| fit.is_fitted) {
        let estimate = EstimatePart::from(&fit);
        return Ok((fit.body, Some(estimate)));
    }
    let fit = masses_from_ground(&table, &[(&posed, &stages)], &MassSettings::default());
    let fit = fit.map_err(|error: MassError| {
        let help = "leave out --masses: the table's shares are used then".to_owned();
        plain(&args.clip.display().to_string(), format!("its masses are not to be told: {error}"), Some(help))
    })?;
    let estimate = EstimatePart::from(&fit);
    Ok((fit.body, Some(estimate)))
}

/// `start`, bent and tilted, and what was done in words.
fn edited(args: &TouchUpArgs, start: &Clip) -> Result<(Clip, Vec<String>), PlainError> {
    let mut clip = start.clone();
    let mut edits = Vec::new();
    if let Some(other) = &args.edit.blend {
        edits.push(format!("goes over into {} over one cycle", other.display()));
    }
    let helped = |option: &str, message: String, help: &str| plain(option, message, Some(help.to_owned()));
    let travel = "name a clip that travels, or a range of it with --frames FIRST..LAST";
    if let Some(radius) = args.edit.radius() {
        clip = bent(&clip, radius).map_err(|error| helped("--bend", error.to_string(), travel))?;
        let side = if radius > 0.0 { "left" } else { "right" };
        edits.push(format!("bent to the {side} on a radius of {} m", radius.abs()));
    }
    if let Some(degrees) = args.edit.tilt {
        let tilt = tilted(&clip, degrees.to_radians());
        clip = tilt.map_err(|error| helped("--tilt", error.to_string(), travel))?;
        let way = if degrees < 0.0 { "downhill" } else { "uphill" };
        edits.push(format!("tilted {way} by {}°", degrees.abs()));
    }
    Ok((clip, edits))
}

/// Stages and source of a clip named with `--source`.
fn of_source(edited: &Clip, source: &Clip, body: &BodyModel) -> Result<(Stages, Option<Source>), PlainError> {
    let fault = if !edited.skeleton.matches(&source.skeleton) {
        Some("it has another skeleton".to_owned())
    } else if edited.frame_count() != source.frame_count() {
        Some(format!("it has {} frames, the edited one has {}", source.frame_count(), edited.frame_count()))
    } else {
        None
    };
    if let Some(fault) = fault {
        let help = "name the clip that was edited, frame by frame, without changes of time".to_owned();
        return Err(plain("--source", fault, Some(help)));
    }
    let stages = stages_of(source, body);
    let known = Source::of(source, body, &stages);
    Ok((stages, Some(known)))
}

fn of_blend(blend: &Blended, clips: [&Clip; 2], body: &BodyModel) -> (Stages, Option<Source>) {
    let [from, to] = clips.map(|clip| stages_of(clip, body));
    let source = blended_source(blend, [(clips[0], &from), (clips[1], &to)], body);
    (stages_of(&blend.clip, body), Some(source))
}
