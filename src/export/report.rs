//! `report.json`: what an edit did, in numbers.

mod parts;

use std::borrow::Cow;

use serde::Serialize;

use crate::constraint::Strength;
use crate::discrete::outcome::Outcome;
use crate::edit::Moved;
use crate::edit::energy::{Energy, length};
use crate::embody::Embodied;
use crate::export::body_report::{FullBodyReport, full_body_report};
use crate::export::changes::{ChangesReport, DiscreteReport};
use crate::export::physics_report::{PhysicsReport, TouchedReport};
use crate::geometry::{c64, wrap};
use crate::index::{CharacterId, floor_index};
use crate::metrics::shown_slides;
use crate::object_motion::{ObjectMotion, Owner};
use crate::reach::{Miss, REACHED};
use crate::resample::time_of;
use crate::residual::{Residual, largest};
use crate::scene::{Performed, Scene};
use crate::ties::Ties;

use crate::clip::working::WORKING_STEP;

pub use parts::{PartReport, Setting, is_told, part_report, report, whole_report};

/// Places of an object that moves are told so far apart, seconds.
const PLACES_APART: f64 = 0.1;

/// Moments nearer to each other than this are one, seconds: nobody has anything between them.
const ONE_MOMENT: f64 = 1e-9;

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
    pub objects: Vec<ObjectReport>,
    /// As in the scene; then carries, by where their hands are, and end effectors.
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
    /// Mean horizontal speed of feet in contact, m/s, while the character's own motion is shown: on output frames and
    /// constrained moments; `rest` at the same instants of the track with all discrete changes, before bending.
    pub foot_slide: RestEdited,
    /// What became of the body; `null` where the full body is off.
    pub full_body: Option<FullBodyReport>,
    /// What the touch-up did; left out for those who were not to be touched up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub physics: Option<PhysicsReport>,
    /// Clips of other bodies, each once: scale, joints that nothing corresponds to, how far legs fall short.
    pub performed: Vec<Performed>,
    /// What became of the track, where it could change.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub changes: Option<ChangesReport>,
    /// Discrete edits, in order.
    pub discrete: Vec<DiscreteReport>,
}

impl CharacterReport {
    /// What the touch-up did, where it did something.
    pub fn touched(&self) -> Option<&TouchedReport> {
        match self.physics.as_ref()? {
            PhysicsReport::Touched(told) => Some(told),
            PhysicsReport::NotTouched { .. } => None,
        }
    }
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

/// One object's share of a report.
#[derive(Clone, Debug, Serialize)]
pub struct ObjectReport {
    /// As in the scene.
    pub name: String,
    /// Ground length of its way, metres.
    pub path_length: f64,
    /// Where it is every tenth of a second and at the last output frame, but where it stays: then from when and until when;
    /// once, if it never moves.
    pub path: Vec<ObjectPlace>,
    /// Who has it from when to when, without gap from the first output frame to the last.
    pub owners: Vec<OwnerReport>,
}

/// Where an object is at one time.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ObjectPlace {
    /// Scene time, seconds.
    pub time: f64,
    /// Middle of its base, `[x, -z]`, metres.
    pub position: [f64; 2],
    /// Of its base above the ground, metres.
    pub height: f64,
    /// Degrees.
    pub facing: f64,
}

/// Who has an object for a while.
#[derive(Clone, Debug, Serialize)]
pub struct OwnerReport {
    /// `itself` (it stands where it was at first, or moves by its keys), `carried`, `left`.
    pub kind: &'static str,
    /// Who carries it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by: Vec<String>,
    /// Name of the carry that carries it, or left it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub carry: Option<String>,
    /// Scene time, seconds.
    pub from: f64,
    /// Scene time, seconds.
    pub to: f64,
}

/// One constraint's share of a report.
#[derive(Clone, Debug, Serialize)]
pub struct ConstraintReport {
    /// Its name.
    pub name: String,
    /// `pin`, `relative`, `time`, `duration`, `sync`, `carry`, `end_effector`.
    pub kind: Cow<'static, str>,
    /// `"hard"`, or the weight; carries and end effectors have none.
    #[serde(skip_serializing_if = "serde_json::Value::is_null")]
    pub strength: serde_json::Value,
    /// On the final motion, at the moments themselves.
    pub residual: f64,
    /// Unit of `residual`.
    pub unit: Cow<'static, str>,
    /// On the solved path, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path_residual: Option<f64>,
    /// Of a held facing, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub facing_residual: Option<f64>,
    /// Of an end effector whose joint must be turned in some way, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation_residual: Option<f64>,
    /// Of a carry or an end effector whose hands do not reach it, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shortfall: Option<f64>,
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

fn character_report(
    (embodied, ties): (&Embodied<'_>, &Ties),
    outcome: &Outcome,
    (start_time, frames_out): (f64, usize),
    who: CharacterId,
) -> CharacterReport {
    let Moved { scene, characters } = embodied.moved;
    let (character, edited) = (&scene.characters[who.as_usize()], &characters[who.as_usize()]);
    let track = &character.track;
    let last = track.frame_count() as f64 - 1.0 + track.overhang();
    let steps = edited.times.windows(2).map(|pair| (pair[1] - pair[0]) / WORKING_STEP);
    let (min, max) =
        steps.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), step| (min.min(step), max.max(step)));
    let still = edited.times.len() < 2;
    let rest = &outcome.original.characters[who.as_usize()].track;
    let rest_last = rest.frame_count() as f64 - 1.0 + rest.overhang();
    let frames_in = floor_index(rest_last * WORKING_STEP * scene.fps + 1e-6) + 1;
    let [rest_slide, edited_slide] = shown_slides((scene, ties), embodied, who, (start_time, frames_out));
    CharacterReport {
        name: character.name.clone(),
        frames_in,
        frames_out,
        seconds: time_of(&edited.times, last) - edited.times[0],
        path_length: RestEdited {
            rest: length(&rest.rest_path().positions),
            edited: length(&edited.positions),
        },
        time_step: if still { MinMax { min: 1.0, max: 1.0 } } else { MinMax { min, max } },
        foot_slide: RestEdited { rest: rest_slide, edited: edited_slide },
        full_body: full_body_report(embodied, who),
        physics: None,
        performed: character.performed.clone(),
        changes: outcome.tracks.get(who.as_usize()).map(|changes| ChangesReport::new(changes, rest, track)),
        discrete: outcome
            .log
            .iter()
            .filter(|entry| entry.character == who)
            .map(DiscreteReport::new)
            .collect(),
    }
}

/// By how much a constraint is missed.
fn constraint_report(
    (name, kind, strength): (&str, Cow<'static, str>, serde_json::Value),
    residual: &Residual,
) -> ConstraintReport {
    let (value, unit) = largest(&kind, residual);
    ConstraintReport {
        name: name.to_owned(),
        kind,
        strength,
        residual: value,
        unit: unit.into(),
        path_residual: residual.path_position,
        facing_residual: residual.facing.map(f64::to_degrees),
        orientation_residual: None,
        shortfall: None,
    }
}

fn strength(constraint: &crate::constraint::Constraint) -> serde_json::Value {
    match constraint.strength {
        Strength::Hard => "hard".into(),
        Strength::Soft(weight) => weight.into(),
    }
}

/// What hands must reach, and by how much they miss it.
fn hands_report(name: &str, kind: Cow<'static, str>, miss: &Miss) -> ConstraintReport {
    ConstraintReport {
        name: name.to_owned(),
        kind,
        strength: serde_json::Value::Null,
        residual: miss.metres,
        unit: "m".into(),
        path_residual: None,
        facing_residual: None,
        orientation_residual: miss.radians.map(f64::to_degrees),
        shortfall: (miss.metres > REACHED).then_some(miss.metres),
    }
}

/// `start`, `frames`: scene time of output frame 0, and output frames of the scene.
fn object_report(moved: &Moved<'_>, motion: &ObjectMotion, (start, frames): (f64, usize)) -> ObjectReport {
    let scene = moved.scene;
    let end = start + (frames - 1) as f64 / scene.fps;
    let place = |time: f64| {
        let pose = motion.pose_at(scene, moved, time);
        let position = pose.plan();
        ObjectPlace {
            time,
            position: [position.re, position.im],
            height: pose.position.y,
            facing: wrap(pose.facing).to_degrees(),
        }
    };
    let steps = if motion.moves(scene) { ((end - start) / PLACES_APART - 1e-9).ceil() } else { 0.0 };
    let path: Vec<ObjectPlace> =
        (0..=floor_index(steps)).map(|k| place((start + k as f64 * PLACES_APART).min(end))).collect();
    let plan: Vec<c64> = path.iter().map(|place| c64::new(place.position[0], place.position[1])).collect();
    let spans = motion.spans.iter().map(|span| (span, span.from.max(start), span.to.min(end)));
    ObjectReport {
        name: scene.objects[motion.object.as_usize()].name.clone(),
        path_length: length(&plan),
        owners: spans
            .filter(|(_, from, to)| to - from > ONE_MOMENT)
            .map(|(span, from, to)| owner_report(scene, &span.owner, (from, to)))
            .collect(),
        path: without_stays(path),
    }
}

/// The places without those between equal ones.
fn without_stays(path: Vec<ObjectPlace>) -> Vec<ObjectPlace> {
    let same = |a: &ObjectPlace, b: &ObjectPlace| {
        (a.position, a.height, a.facing) == (b.position, b.height, b.facing)
    };
    let stays = |k: usize| {
        k > 0 && k + 1 < path.len() && same(&path[k - 1], &path[k]) && same(&path[k], &path[k + 1])
    };
    (0..path.len()).filter(|k| !stays(*k)).map(|k| path[k]).collect()
}

fn owner_report(scene: &Scene, owner: &Owner, (from, to): (f64, f64)) -> OwnerReport {
    let carry = |index: usize| &scene.carries[index];
    let (kind, by, carry) = match owner {
        Owner::Itself => ("itself", Vec::new(), None),
        Owner::Carried(hold) => {
            let who = carry(hold.carry).by.iter();
            let names = who.map(|who| scene.characters[who.as_usize()].name.clone());
            ("carried", names.collect(), Some(carry(hold.carry).name.clone()))
        }
        Owner::Left { carry: index, .. } => ("left", Vec::new(), Some(carry(*index).name.clone())),
    };
    OwnerReport { kind, by, carry, from, to }
}
