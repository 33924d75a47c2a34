//! Clips that the program generates, so that scenes run without any file: `builtin:walk`, `builtin:idle`, `builtin:slap`.
//!
//! All have one human skeleton of 21 joints, +x left, +z ahead, y up, and 30 frames a second. No chance and no clock: the
//! same parameters give the same clip.

mod body;
mod gait;
mod stand;

use std::collections::BTreeMap;

use self::body::Body;
use self::gait::{Gait, HALTING, SETTING_OFF};
use crate::clip::Clip;
use crate::index::{SourceFrame, floor_index};
use crate::skeleton::Pose;

/// Frames per second of every generated clip.
pub const FPS: f64 = 30.0;

/// What there is to know about one generated clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuiltinInfo {
    /// As in `builtin:NAME`.
    pub name: &'static str,
    /// One line.
    pub description: &'static str,
    /// What can be chosen.
    pub parameters: &'static [BuiltinParameter],
    /// Named frames of the clip.
    pub events: &'static [&'static str],
}

/// A number that shapes a generated clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuiltinParameter {
    /// Name, unique in its clip.
    pub name: &'static str,
    /// One line.
    pub description: &'static str,
    /// Unit of the numbers.
    pub unit: &'static str,
    /// Value where none is given.
    pub default: f64,
    /// Smallest and largest value, both allowed.
    pub range: (f64, f64),
}

/// Why a clip could not be generated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuiltinError {
    /// No such clip.
    #[error("no generated clip \"{name}\"{} (known: {})", did_you_mean(*.suggestion), clip_names())]
    UnknownName {
        /// As asked for.
        name: String,
        /// The known name closest to it, if any is close.
        suggestion: Option<&'static str>,
    },
    /// The clip has no such parameter.
    #[error("generated clip \"{clip}\" has no parameter \"{parameter}\"{} (known: {})", did_you_mean(*.suggestion), parameter_names(.clip))]
    UnknownParameter {
        /// Name of the clip.
        clip: &'static str,
        /// As asked for.
        parameter: String,
        /// The known name closest to it, if any is close.
        suggestion: Option<&'static str>,
    },
    /// A value outside its range, or none at all.
    #[error("{parameter} = {value} of generated clip \"{clip}\" is outside {} to {} {unit}", .range.0, .range.1)]
    OutOfRange {
        /// Name of the clip.
        clip: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// As asked for.
        value: f64,
        /// Smallest and largest value allowed.
        range: (f64, f64),
        /// Unit of the numbers.
        unit: &'static str,
    },
}

const STATURE: BuiltinParameter = BuiltinParameter {
    name: "stature",
    description: "height of the body",
    unit: "m",
    default: 1.75,
    range: (1.2, 2.2),
};

const WALK: BuiltinInfo = BuiltinInfo {
    name: "walk",
    description: "walks straight ahead, in cycles that end as they began; sets off and halts on request",
    parameters: &[
        BuiltinParameter {
            name: "speed",
            description: "of walking",
            unit: "m/s",
            default: 1.2,
            range: (0.5, 1.8),
        },
        BuiltinParameter {
            name: "seconds",
            description: "length, with stop = 1 to the nearest cycle; at the default speed one takes 17/15 s",
            unit: "s",
            default: 3.4,
            range: (0.5, 600.0),
        },
        BuiltinParameter {
            name: "start",
            description: "1: stands first and sets off; 0: walks from the first frame on",
            unit: "",
            default: 0.0,
            range: (0.0, 1.0),
        },
        BuiltinParameter {
            name: "stop",
            description: "1: halts at the end and stands; 0: walks to the last frame",
            unit: "",
            default: 0.0,
            range: (0.0, 1.0),
        },
        STATURE,
    ],
    events: &[],
};

const IDLE: BuiltinInfo = BuiltinInfo {
    name: "idle",
    description: "stands on both feet, breathing and swaying a little; ends as it began",
    parameters: &[
        BuiltinParameter {
            name: "seconds",
            description: "length",
            unit: "s",
            default: 3.0,
            range: (1.0, 600.0),
        },
        STATURE,
    ],
    events: &[],
};

const SLAP: BuiltinInfo = BuiltinInfo {
    name: "slap",
    description: "stands, claps the right hand forward into another's at shoulder height, stands again",
    parameters: &[
        BuiltinParameter {
            name: "seconds",
            description: "length; the hand hits after two fifths of it",
            unit: "s",
            default: 3.0,
            range: (2.4, 10.0),
        },
        STATURE,
    ],
    events: &["hit"],
};

/// All generated clips.
pub fn names() -> &'static [BuiltinInfo] {
    const ALL: &[BuiltinInfo] = &[WALK, IDLE, SLAP];
    ALL
}

/// The generated clip `name` with `parameters`, defaults for those left out.
///
/// # Errors
/// [`BuiltinError`] for an unknown name, an unknown parameter, a value out of range.
pub fn generate(name: &str, parameters: &BTreeMap<String, f64>) -> Result<Clip, BuiltinError> {
    let info = names().iter().find(|info| info.name == name).ok_or_else(|| BuiltinError::UnknownName {
        name: name.to_owned(),
        suggestion: closest(name, names().iter().map(|info| info.name)),
    })?;
    check(info, parameters)?;
    let value =
        |parameter: &BuiltinParameter| parameters.get(parameter.name).copied().unwrap_or(parameter.default);
    let values: BTreeMap<&str, f64> =
        info.parameters.iter().map(|parameter| (parameter.name, value(parameter))).collect();
    let body = Body::new(values["stature"]);
    let last_frame = floor_index(values["seconds"] * FPS + 0.5);
    Ok(match info.name {
        "walk" => walk(body, &values),
        "idle" => on_the_spot(info, &body, last_frame, stand::idle),
        _ => {
            let mut clip = on_the_spot(info, &body, last_frame, stand::slap);
            clip.events.insert("hit".to_owned(), hit_frame(last_frame));
            clip
        }
    })
}

/// Seconds of standing before a walk sets off, and after it has halted.
const STANDING: f64 = 0.4;

fn walk(body: Body, values: &BTreeMap<&str, f64>) -> Clip {
    let skeleton = body.skeleton.clone();
    let mut gait = Gait::new(body, values["speed"], FPS);
    let (starts, stops) = (values["start"] >= 0.5, values["stop"] >= 0.5);
    // A strike of the left foot falls on a frame.
    let before =
        if starts { ((STANDING + 0.5 * SETTING_OFF * gait.period) * FPS).round() / FPS } else { 0.0 };
    let mut seconds = values["seconds"];
    if stops {
        let after = HALTING * gait.period + STANDING;
        let cycles = ((seconds - before - after) / gait.period).round().max(if starts { 1.0 } else { 0.0 });
        gait.ends.stop = Some(cycles);
        seconds = before + cycles * gait.period + after;
    }
    gait.ends.start = starts;
    let last_frame = floor_index(seconds * FPS + 0.5);
    let poses: Vec<Pose> = (0..=last_frame).map(|frame| gait.pose(frame as f64 / FPS - before)).collect();
    Clip::from_poses(WALK.name, skeleton, FPS, &poses)
}

/// A clip whose pose depends on the body, its seconds and the share of it that has passed.
fn on_the_spot(
    info: &BuiltinInfo,
    body: &Body,
    last_frame: usize,
    pose: fn(&Body, f64, f64) -> Pose,
) -> Clip {
    let seconds = last_frame as f64 / FPS;
    let poses: Vec<Pose> =
        (0..=last_frame).map(|frame| pose(body, seconds, frame as f64 / last_frame as f64)).collect();
    Clip::from_poses(info.name, body.skeleton.clone(), FPS, &poses)
}

/// Frame nearest to the instant of the hit.
fn hit_frame(last_frame: usize) -> SourceFrame {
    SourceFrame::from_usize(floor_index(stand::SLAP_HIT * last_frame as f64 + 0.5))
}

fn check(info: &BuiltinInfo, parameters: &BTreeMap<String, f64>) -> Result<(), BuiltinError> {
    for (name, value) in parameters {
        let known = info.parameters.iter().find(|parameter| parameter.name == name);
        let parameter = known.ok_or_else(|| BuiltinError::UnknownParameter {
            clip: info.name,
            parameter: name.clone(),
            suggestion: closest(name, info.parameters.iter().map(|parameter| parameter.name)),
        })?;
        let (low, high) = parameter.range;
        // Written so that NaN is out of range.
        if !(low <= *value && *value <= high) {
            return Err(BuiltinError::OutOfRange {
                clip: info.name,
                parameter: parameter.name,
                value: *value,
                range: parameter.range,
                unit: parameter.unit,
            });
        }
    }
    Ok(())
}

/// The candidate that somebody who typed `name` may have meant.
fn closest(name: &str, candidates: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    /// Jaro–Winkler similarity below which a name is just another name.
    const SIMILAR: f64 = 0.75;
    candidates
        .map(|candidate| (strsim::jaro_winkler(name, candidate), candidate))
        .filter(|(similarity, _)| *similarity > SIMILAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

fn did_you_mean(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |name| format!("; did you mean \"{name}\"?"))
}

fn clip_names() -> String {
    quoted(names().iter().map(|info| info.name))
}

fn parameter_names(clip: &str) -> String {
    let info = names().iter().find(|info| info.name == clip);
    quoted(info.into_iter().flat_map(|info| info.parameters).map(|parameter| parameter.name))
}

fn quoted(names: impl Iterator<Item = &'static str>) -> String {
    let names: Vec<String> = names.map(|name| format!("\"{name}\"")).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests;
