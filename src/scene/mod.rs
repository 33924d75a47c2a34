//! A choreography: who performs what, and what must hold. A sound [`Scene`] never panics later.

pub mod check;
pub mod checker;
pub mod clips;
pub mod constraints;
pub mod diagnostic;
pub mod load;
pub mod moment;
pub mod raw;
pub mod refuse;
pub mod report;
pub mod schema;
pub mod sources;
pub mod suggest;
pub mod ties;
pub mod tree;
pub mod unavailable;
pub mod values;

use crate::constraint::Constraint;
use crate::geometry::c64;
use crate::track::Track;

pub use clips::ClipFolders;
pub use diagnostic::{Diagnostic, Rendering, SceneFaults, Severity, render};
pub use load::{Loaded, load, load_text};
pub use schema::schema;

/// A choreography that has passed every check.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// For people.
    pub title: String,
    /// Rate of the result, frames per second.
    pub fps: f64,
    /// Which column of settings holds.
    pub mode: Mode,
    /// In the order of the file.
    pub characters: Vec<Character>,
    /// In the order of the file.
    pub objects: Vec<Object>,
    /// Pins, relatives, times, durations, syncs, each kind in the order of the file.
    pub constraints: Vec<Constraint>,
    /// Bounds on time steps, as multiples of the rest step; `None`: the mode's default.
    pub warp: Warp,
}

/// Whose settings: the method as published, or what serves users best.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// The published method as repaired here; all reference numbers hold for it.
    Paper,
    /// The default.
    #[default]
    Production,
}

/// Somebody who performs.
#[derive(Clone, Debug, PartialEq)]
pub struct Character {
    /// Unique among characters and objects.
    pub name: String,
    /// Motion before the edit, placed.
    pub track: Track,
}

/// A thing that stands in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Unique among characters and objects.
    pub name: String,
    /// Ahead, up, across, metres.
    pub size: [f64; 3],
    /// Ground plan of the middle of its base, metres.
    pub position: c64,
    /// Radians.
    pub facing: f64,
}

/// Bounds on time steps, as multiples of the rest step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Warp {
    /// Smallest; above 0.
    pub min_step: Option<f64>,
    /// Largest; at least `min_step`.
    pub max_step: Option<f64>,
}
