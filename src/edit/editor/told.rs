//! What the systems of an editor say, in the words of its scene.

use super::{DEFAULT_BOUNDS, Editor};
use crate::edit::error::{EditError, Named};
use crate::edit::hold::Phase;
use crate::edit::note::EditNote;
use crate::edit::spatial::SpatialError;
use crate::edit::temporal::TemporalError;
use crate::edit::time_row::StepBounds;
use crate::index::ConstraintId;
use crate::scene::{Mode, Scene};

/// Paths shorter than this may change their length as they like, metres.
const SHORT_PATH: f64 = 0.5;
/// A path within these ratios of its length before the edit is no surprise.
const USUAL_RATIO: std::ops::RangeInclusive<f64> = 0.5..=2.0;

pub(super) fn named(scene: &Scene, constraint: ConstraintId) -> Named {
    let constraint = &scene.constraints[constraint.as_usize()];
    Named { name: constraint.name.clone(), line: constraint.line }
}

fn names_of(scene: &Scene, characters: &[usize]) -> String {
    characters.iter().map(|c| scene.characters[*c].name.as_str()).collect::<Vec<_>>().join(", ")
}

pub(super) fn space_error(scene: &Scene, characters: &[usize], error: SpatialError) -> EditError {
    match error {
        SpatialError::Conflict { constraints, miss } => EditError::Conflict {
            constraints: constraints.into_iter().map(|id| named(scene, id)).collect(),
            miss,
        },
        SpatialError::Solver(phase, source) => {
            let system = if phase == Phase::Shape { "shape" } else { "scale" };
            EditError::Solver { system, characters: names_of(scene, characters), source }
        }
    }
}

pub(super) fn time_error(scene: &Scene, characters: &[usize], error: TemporalError) -> EditError {
    let names = |constraints: Vec<ConstraintId>| constraints.into_iter().map(|id| named(scene, id)).collect();
    match error {
        TemporalError::Conflict { constraints, miss } => {
            EditError::TimeConflict { constraints: names(constraints), miss }
        }
        TemporalError::Infeasible { constraints, deficit } => {
            let bounds = step_bounds(scene).unwrap_or(DEFAULT_BOUNDS);
            EditError::InfeasibleTimes {
                constraints: names(constraints),
                deficit,
                min_step: bounds.min,
                max_step: bounds.max,
            }
        }
        TemporalError::Solver(source) => {
            EditError::Solver { system: "time", characters: names_of(scene, characters), source }
        }
        TemporalError::Bounds(source) => {
            EditError::Bounds { characters: names_of(scene, characters), source }
        }
    }
}

/// Bounds on steps that hold in `scene`.
pub(super) fn step_bounds(scene: &Scene) -> Option<StepBounds> {
    let default = (scene.mode == Mode::Production).then_some(DEFAULT_BOUNDS);
    match (scene.warp.min_step, scene.warp.max_step, default) {
        (None, None, default) => default,
        (min, max, default) => Some(StepBounds {
            min: min.or(default.map(|bounds| bounds.min)).unwrap_or(1e-6),
            max: max.or(default.map(|bounds| bounds.max)).unwrap_or(1e6),
        }),
    }
}

impl Editor {
    /// What the user should know of the last solve.
    pub(super) fn notes(&self) -> Vec<EditNote> {
        let name = |character: usize| self.scene.characters[character].name.clone();
        let mut notes = Vec::new();
        let mut redundant: Vec<ConstraintId> =
            self.temporal.iter().flat_map(|group| group.component.redundant()).collect();
        redundant.extend(self.spatial.iter().flat_map(|group| group.component.redundant()));
        redundant.sort_unstable();
        redundant.dedup();
        if !redundant.is_empty() {
            notes.push(EditNote::Redundant(redundant.into_iter().map(|id| named(&self.scene, id)).collect()));
        }
        let steps = self.temporal.iter().map(|group| group.component.active_steps).sum();
        notes.extend((steps > 0).then_some(EditNote::StepsAtBound { steps }));
        for group in &self.spatial {
            notes.extend(group.component.released.iter().map(|(path, run)| EditNote::Released {
                character: name(group.characters[*path]),
                frames: group.component.rests[*path].rigid[*run],
            }));
        }
        for (index, character) in self.edit.characters.iter().enumerate() {
            notes.extend(character.turns.flips.iter().map(|flip| EditNote::Flip {
                character: name(index),
                frames: (flip.first, flip.last),
                repaired: flip.repaired,
            }));
            let (before, after) = self.extents[index].length;
            let ratio = after / before;
            let drastic = before > SHORT_PATH && !USUAL_RATIO.contains(&ratio);
            notes.extend(drastic.then(|| EditNote::Stretched { character: name(index), ratio }));
        }
        notes
    }
}
