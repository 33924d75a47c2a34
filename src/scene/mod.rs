//! A choreography: who performs what, and what must hold. A sound [`Scene`] never panics later.

pub mod annotations;
pub mod bodies;
pub mod busy;
pub mod check;
pub mod checker;
pub mod clips;
pub mod constraints;
pub mod derived;
pub mod diagnostic;
pub mod discrete;
pub mod drags;
pub mod effectors;
pub mod group;
pub mod load;
pub mod manipulation;
pub mod moment;
pub mod objects;
pub mod physics;
pub mod physics_table;
pub mod raw;
pub mod report;
pub mod schema;
pub mod sources;
pub mod suggest;
pub mod things;
pub mod ties;
pub mod tree;
pub mod values;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::clip::retarget::RetargetReport;
use crate::constraint::{Captured, Constraint, ConstraintKind, Discrete, Drag, Moment};
use crate::effector::EndEffector;
use crate::index::{CharacterId, ConstraintId, ObjectId};
use crate::object::{Carry, Course, Object};
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
    /// Pins, relatives, times, durations, syncs, each kind in the order of the file; then those that drags pull and that the
    /// file does not have.
    pub constraints: Vec<Constraint>,
    /// In the order of the file, those of one object in the order of time; their objects are not keyframed.
    pub carries: Vec<Carry>,
    /// In the order of the file.
    pub end_effectors: Vec<EndEffector>,
    /// Scripted manipulation, in order.
    pub drags: Vec<Drag>,
    /// What discrete editing may do; `None`: nothing, tracks stay as they are.
    pub discrete: Option<Discrete>,
    /// How everybody is touched up; `None`: nobody is.
    pub physics: Option<physics::Physics>,
    /// What constraints that ask for it had before all discrete changes; empty as long as there is none.
    pub captured: BTreeMap<ConstraintId, Captured>,
    /// Bounds on time steps, as multiples of the rest step; `None`: the mode's default.
    pub warp: Warp,
    /// Feet and hands.
    pub full_body: FullBody,
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
    /// Motion before the edit, placed; all its clips have one skeleton.
    pub track: Track,
    /// Clips on the track that were captured on other bodies, each once.
    pub performed: Vec<Performed>,
}

/// A clip performed by another body than its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Performed {
    /// Name of the clip.
    pub clip: String,
    /// Name of the clip whose body performs it.
    pub body: String,
    /// What became of the joints.
    #[serde(flatten)]
    pub joints: RetargetReport,
}

/// Bounds on time steps, as multiples of the rest step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Warp {
    /// Smallest; above 0.
    pub min_step: Option<f64>,
    /// Largest; at least `min_step`.
    pub max_step: Option<f64>,
}

/// Settings of the full-body stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FullBody {
    /// Whether it runs.
    pub enabled: bool,
    /// How planted feet hold.
    pub plants: Plants,
}

impl Default for FullBody {
    fn default() -> Self {
        Self { enabled: true, plants: Plants::default() }
    }
}

/// How planted feet hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Plants {
    /// With the small drift that their capture has: an edit that changes nothing changes nothing.
    #[default]
    AsCaptured,
    /// Without any drift, as long as no joint of a captured leg turns by 5° for it.
    Pinned,
    /// Without any drift from the first frame of each contact to its last.
    Whole,
}

impl Scene {
    /// Frame on its character's track of a moment.
    pub fn frame_of(&self, moment: &Moment) -> f64 {
        let track = &self.characters[moment.character.as_usize()].track;
        track.locate(moment.instant).expect("a checked scene's tracks show every frame that a moment names")
    }

    /// Whether an object is ever elsewhere than at first.
    pub fn moves(&self, object: ObjectId) -> bool {
        matches!(self.objects[object.as_usize()].course, Course::Keys(_))
            || self.carries.iter().any(|carry| carry.object == object)
    }

    /// Carries of an object, by position, rising. Cost: linear in carries.
    pub fn carries_of(&self, object: ObjectId) -> Vec<usize> {
        (0..self.carries.len()).filter(|carry| self.carries[*carry].object == object).collect()
    }

    /// Every moment that something names: constraints, carries, end effectors, times of discrete editing, in this order.
    pub fn moments(&self) -> impl Iterator<Item = &Moment> {
        let constraints = self.constraints.iter().flat_map(|constraint| constraint.kind.moments());
        let carries = self.carries.iter().flat_map(|carry| [&carry.during.0, &carry.during.1]);
        let times = self.discrete.iter().flat_map(|discrete| discrete.times.iter().flatten());
        constraints
            .chain(carries)
            .chain(self.end_effectors.iter().flat_map(EndEffector::moments))
            .chain(times.flat_map(|(from, to)| [from, to]))
    }

    /// Every moment that something names, in the same order, to be changed.
    pub fn moments_mut(&mut self) -> impl Iterator<Item = &mut Moment> {
        self.moments_where_mut(|_| true)
    }

    /// Those of one character, in the same order.
    pub fn moments_of_mut(&mut self, who: CharacterId) -> impl Iterator<Item = &mut Moment> {
        self.moments_where_mut(move |kind| kind.names(who)).filter(move |moment| moment.character == who)
    }

    /// Those of the constraints that are `wanted`, and all others.
    fn moments_where_mut(
        &mut self,
        wanted: impl Fn(&ConstraintKind) -> bool,
    ) -> impl Iterator<Item = &mut Moment> {
        let constraints = self.constraints.iter_mut().filter(move |constraint| wanted(&constraint.kind));
        let carries = self.carries.iter_mut().flat_map(|Carry { during, .. }| [&mut during.0, &mut during.1]);
        let times = self.discrete.iter_mut().flat_map(|discrete| discrete.times.iter_mut().flatten());
        constraints
            .flat_map(|constraint| constraint.kind.moments_mut())
            .chain(carries)
            .chain(self.end_effectors.iter_mut().flat_map(EndEffector::moments_mut))
            .chain(times.flat_map(|(from, to)| [from, to]))
    }
}
