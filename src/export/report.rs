//! `report.json`: what an edit did, in numbers.

use serde::Serialize;

use crate::clip::Clip;
use crate::constraint::Strength;
use crate::edit::energy::{Energy, length};
use crate::edit::{Edit, EditedCharacter};
use crate::index::floor_index;
use crate::metrics::foot_slide;
use crate::resample::{Resampled, rest_clip, shown_contacts, time_of};
use crate::residual::{MomentTime, Residual, largest, moment_times, residuals};
use crate::scene::{Character, Scene};

use crate::clip::working::WORKING_STEP;

/// The whole report. Lengths in metres, times in seconds, angles in degrees.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Title of the scene.
    pub scene: String,
    /// Version of the program.
    pub cotillion: &'static str,
    /// Rate of the result.
    pub fps: f64,
    /// Scene time of output frame 0.
    pub start_time: f64,
    /// As in the scene.
    pub characters: Vec<CharacterReport>,
    /// As in the scene.
    pub constraints: Vec<ConstraintReport>,
    /// Moments that constraints name.
    pub moments: Vec<MomentReport>,
    /// Terms of the deformation energy.
    pub energy: Energy,
    /// What the user should know.
    pub notes: Vec<String>,
    /// Names of the files written beside the report.
    pub files: Vec<String>,
    /// Milliseconds of each stage.
    pub timing_ms: Timing,
}

/// One character's share of a report.
#[derive(Clone, Debug, Serialize)]
pub struct CharacterReport {
    /// As in the scene.
    pub name: String,
    /// Frames at the scene's rate before the edit.
    pub frames_in: usize,
    /// Frames of the exported file.
    pub frames_out: usize,
    /// From the first to the last frame of the track, seconds.
    pub seconds: f64,
    /// Ground length of the path, metres.
    pub path_length: RestEdited,
    /// Smallest and largest time step, as multiples of the rest step.
    pub time_step: MinMax,
    /// Mean horizontal speed of feet in contact, m/s.
    pub foot_slide: RestEdited,
    /// Discrete edits, in order.
    pub discrete: Vec<DiscreteReport>,
}

/// A quantity before and after the edit.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the type says it")]
pub struct RestEdited {
    pub rest: f64,
    pub edited: f64,
}

/// A range.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the type says it")]
pub struct MinMax {
    pub min: f64,
    pub max: f64,
}

/// A discrete edit.
#[derive(Clone, Debug, Serialize)]
pub struct DiscreteReport {
    /// What was done.
    pub kind: String,
}

/// One constraint's share of a report.
#[derive(Clone, Debug, Serialize)]
pub struct ConstraintReport {
    /// Its name.
    pub name: String,
    /// `pin`, `relative`, `time`, `duration`, `sync`.
    pub kind: &'static str,
    /// `"hard"`, or the weight.
    pub strength: serde_json::Value,
    /// On the final motion, at the moments themselves.
    pub residual: f64,
    /// Unit of `residual`.
    pub unit: &'static str,
    /// On the solved path, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path_residual: Option<f64>,
    /// Of a held facing, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub facing_residual: Option<f64>,
}

/// When a moment happens.
#[derive(Clone, Debug, Serialize)]
pub struct MomentReport {
    /// As in the scene file.
    pub name: String,
    /// Scene time, seconds.
    pub time: f64,
}

/// Milliseconds of each stage.
#[derive(Clone, Copy, Debug, Default, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Timing {
    pub load: f64,
    pub assemble: f64,
    pub factor: f64,
    pub solve: f64,
    pub discrete: f64,
    pub full_body: f64,
    pub physics: f64,
    pub export: f64,
}

/// Reports on an edit; files and times are filled in where files are written and clocks are read.
pub fn report(scene: &Scene, edit: &Edit, resampled: &Resampled) -> Report {
    let characters = scene.characters.iter().zip(&edit.characters).zip(&resampled.clips);
    let constraints = scene.constraints.iter().zip(residuals(scene, edit));
    let clock = (scene.fps, resampled.start_time);
    Report {
        scene: scene.title.clone(),
        cotillion: env!("CARGO_PKG_VERSION"),
        fps: scene.fps,
        start_time: resampled.start_time,
        characters: characters
            .map(|((character, edited), clip)| character_report(clock, character, edited, clip))
            .collect(),
        constraints: constraints
            .map(|(constraint, residual)| constraint_report(constraint, &residual))
            .collect(),
        moments: moment_times(scene, edit)
            .into_iter()
            .map(|MomentTime { name, time }| MomentReport { name, time })
            .collect(),
        energy: edit.energy,
        notes: edit.notes.iter().map(ToString::to_string).collect(),
        files: Vec::new(),
        timing_ms: Timing::default(),
    }
}

fn character_report(
    (fps, start_time): (f64, f64),
    character: &Character,
    edited: &EditedCharacter,
    clip: &Clip,
) -> CharacterReport {
    let track = &character.track;
    let last = track.frame_count() as f64 - 1.0 + track.overhang();
    let steps = edited.times.windows(2).map(|pair| (pair[1] - pair[0]) / WORKING_STEP);
    let (min, max) =
        steps.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), step| (min.min(step), max.max(step)));
    let still = edited.times.len() < 2;
    let rest = rest_clip(fps, track);
    let rest_slide = foot_slide(&rest.clip, &rest.contacts).unwrap_or(0.0);
    let edited_slide = foot_slide(clip, &shown_contacts(start_time, fps, track, edited, clip.frame_count()));
    CharacterReport {
        name: character.name.clone(),
        frames_in: floor_index(last * WORKING_STEP * fps + 1e-6) + 1,
        frames_out: clip.frame_count(),
        seconds: time_of(&edited.times, last) - edited.times[0],
        path_length: RestEdited { rest: length(&edited.rest.positions), edited: length(&edited.positions) },
        time_step: if still { MinMax { min: 1.0, max: 1.0 } } else { MinMax { min, max } },
        foot_slide: RestEdited { rest: rest_slide, edited: edited_slide.unwrap_or(0.0) },
        discrete: Vec::new(),
    }
}

fn constraint_report(constraint: &crate::constraint::Constraint, residual: &Residual) -> ConstraintReport {
    let (value, unit) = largest(&constraint.kind, residual);
    ConstraintReport {
        name: constraint.name.clone(),
        kind: constraint.kind.keyword(),
        strength: match constraint.strength {
            Strength::Hard => "hard".into(),
            Strength::Soft(weight) => weight.into(),
        },
        residual: value,
        unit,
        path_residual: residual.path_position,
        facing_residual: residual.facing.map(f64::to_degrees),
    }
}
