//! Clips that the program generates, so that scenes run without any file: `builtin:walk`, `builtin:slap`, …
//!
//! All have one human skeleton of 21 joints, +x left, +z ahead, y up, and 30 frames a second. No chance and no clock: the
//! same parameters give the same clip.

mod acts;
mod arms;
mod ballistics;
mod body;
mod course;
mod crouch;
mod curve;
mod dodge;
mod flight;
mod gait;
mod jump;
mod keyed;
mod leap;
mod lift;
mod limbs;
#[cfg(test)]
mod limits;
mod loads;
mod mass;
mod momentum;
mod performance;
mod request;
mod rhythm;
mod run;
mod side;
mod sit;
mod stand;
mod swing;
mod turn;
mod walks;

use std::collections::BTreeMap;

pub use request::request;

use self::body::Body;
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
    /// Unit of the numbers; empty for a switch.
    pub unit: &'static str,
    /// Value where none is given.
    pub default: f64,
    /// Smallest and largest value, both allowed.
    pub range: (f64, f64),
}

impl BuiltinParameter {
    /// Whether it is 0 or 1 and nothing between.
    pub const fn is_switch(&self) -> bool {
        self.unit.is_empty()
    }
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
    /// Something that is no parameter with its value.
    #[error("\"{found}\" is not PARAMETER=VALUE with a finite number")]
    NotAParameter {
        /// As asked for.
        found: String,
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
    /// A value between those of a switch.
    #[error("{parameter} = {value} of generated clip \"{clip}\" is neither 0 nor 1")]
    NoSwitch {
        /// Name of the clip.
        clip: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// As asked for.
        value: f64,
    },
}

/// Height of the body, a parameter of every clip.
const STATURE: BuiltinParameter = BuiltinParameter {
    name: "stature",
    description: "height of the body",
    unit: "m",
    default: 1.75,
    range: (1.2, 2.2),
};

/// A generated clip: what there is to know about it, and how it is made.
#[derive(Clone, Copy, Debug)]
struct Generator {
    info: BuiltinInfo,
    /// The clip on this body; its name and events are set by whoever calls.
    make: fn(&Body, &Values) -> Made,
}

/// Values of all parameters of a clip by name.
type Values = BTreeMap<&'static str, f64>;

/// Poses at [`FPS`] and the frames of events, in the order of the clip's [`BuiltinInfo::events`].
#[derive(Clone, Debug, Default)]
struct Made {
    poses: Vec<Pose>,
    events: Vec<usize>,
}

/// Families of generated clips, in the order they are listed.
const FAMILIES: &[&[Generator]] = &[
    walks::ALL,
    run::ALL,
    side::ALL,
    turn::ALL,
    loads::ALL,
    acts::ALL,
    lift::ALL,
    sit::ALL,
    dodge::ALL,
    jump::ALL,
];

/// All generated clips.
pub fn names() -> impl Iterator<Item = &'static BuiltinInfo> {
    generators().map(|generator| &generator.info)
}

fn generators() -> impl Iterator<Item = &'static Generator> {
    FAMILIES.iter().flat_map(|family| family.iter())
}

/// The generated clip `name` with `parameters`, defaults for those left out.
///
/// # Errors
/// [`BuiltinError`] for an unknown name, an unknown parameter, a value out of range, a switch that is neither 0 nor 1.
pub fn generate(name: &str, parameters: &BTreeMap<String, f64>) -> Result<Clip, BuiltinError> {
    let generator = generators().find(|generator| generator.info.name == name).ok_or_else(|| {
        BuiltinError::UnknownName {
            name: name.to_owned(),
            suggestion: closest(name, names().map(|info| info.name)),
        }
    })?;
    let info = &generator.info;
    check(info, parameters)?;
    let value =
        |parameter: &BuiltinParameter| parameters.get(parameter.name).copied().unwrap_or(parameter.default);
    let values: Values = info.parameters.iter().map(|parameter| (parameter.name, value(parameter))).collect();
    let body = Body::new(values["stature"]);
    let made = (generator.make)(&body, &values);
    let mut clip = Clip::from_poses(info.name, body.skeleton.clone(), FPS, &made.poses);
    for (name, frame) in info.events.iter().zip(made.events) {
        clip.events.insert((*name).to_owned(), SourceFrame::from_usize(frame));
    }
    Ok(clip)
}

/// Frame nearest to an instant.
fn frame_at(seconds: f64) -> usize {
    floor_index(seconds * FPS + 0.5)
}

fn check(info: &BuiltinInfo, parameters: &BTreeMap<String, f64>) -> Result<(), BuiltinError> {
    for (name, value) in parameters {
        let known = info.parameters.iter().find(|parameter| parameter.name == name);
        let parameter = known.ok_or_else(|| BuiltinError::UnknownParameter {
            clip: info.name,
            parameter: name.clone(),
            suggestion: closest(name, info.parameters.iter().map(|parameter| parameter.name)),
        })?;
        if parameter.is_switch() && ![0.0, 1.0].contains(value) {
            return Err(BuiltinError::NoSwitch { clip: info.name, parameter: parameter.name, value: *value });
        }
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
    quoted(names().map(|info| info.name))
}

fn parameter_names(clip: &str) -> String {
    let info = names().find(|info| info.name == clip);
    quoted(info.into_iter().flat_map(|info| info.parameters).map(|parameter| parameter.name))
}

fn quoted(names: impl Iterator<Item = &'static str>) -> String {
    let names: Vec<String> = names.map(|name| format!("\"{name}\"")).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests;
