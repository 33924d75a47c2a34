//! The editor: built once per set of constraints, solved many times while targets move.

mod bound;
mod entangled;
mod moving;
mod objects;
mod sampled;
mod share;
mod timing;
mod told;
mod variant;

use std::ops::Range;

use rayon::prelude::*;

use crate::constraint::{Constraint, ConstraintKind, Relation, Target};
use crate::edit::carrying::HandsAtRest;
use crate::edit::energy::{Energy, Extent, length};
use crate::edit::error::{EditError, Named};
use crate::edit::expand::{Following, expand};
use crate::edit::groups::{Group, for_each_stale, spatial_groups, temporal_groups};
use crate::edit::hold::Hold;
use crate::edit::moved::EditedCharacter;
use crate::edit::note::EditNote;
use crate::edit::retarget::retarget;
use crate::edit::settings::{Backend, SpatialSettings};
use crate::edit::spatial::SpatialComponent;
use crate::edit::temporal::TemporalComponent;
use crate::edit::time_row::StepBounds;
use crate::index::{CharacterId, ConstraintId};
use crate::path::RestPath;
use crate::scene::Scene;

use crate::clip::working::WORKING_STEP;

use objects::ObjectTies;
use told::{space_error, step_bounds, time_error};

pub use timing::Timing;
pub use variant::{Exchange, Variant, WhatIf};

/// Default bounds on time steps in production mode, as multiples of the rest step.
const DEFAULT_BOUNDS: StepBounds = StepBounds { min: 0.5, max: 2.0 };

/// Result of a solve.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// As in the scene.
    pub characters: Vec<EditedCharacter>,
    /// Terms of Ê.
    pub energy: Energy,
    /// What the user should know.
    pub notes: Vec<EditNote>,
}

/// Edits one scene: everything that depends only on the constraint set is computed when it is built; a drag step is
/// substitutions and passes over the frames.
pub struct Editor {
    scene: Scene,
    edit: Edit,
    /// Of each character.
    extents: Vec<Extent>,
    spatial: Vec<Group<SpatialComponent>>,
    temporal: Vec<Group<TemporalComponent>>,
    /// Component and place in it of each spatial row, in the order of constraints.
    held: Vec<(usize, usize)>,
    /// Component and place in it of each temporal row, in the order of constraints.
    times: Vec<(usize, usize)>,
    /// Rows relative to objects that move, each with what it binds at present.
    following: Vec<(Following, Hold)>,
    /// Of each of these, whether its place depends on how others move, at the times of the last solve.
    coupled: Vec<bool>,
    ties: ObjectTies,
    hands: HandsAtRest,
    /// How often spatial components were formed anew.
    regrouped: u64,
    /// How often times were solved anew, or where objects are.
    timed: u64,
    settings: SpatialSettings,
    backend: Backend,
}

impl Editor {
    /// Assembles and factors all systems of `scene`. Cost: linear in frames and, where constraints tie neighbours, in
    /// characters.
    ///
    /// # Errors
    /// [`EditError::Solver`] where a system cannot be factored.
    pub fn new(scene: Scene) -> Result<Self, EditError> {
        Self::of(scene, Backend::default())
    }

    /// The same with a solver of one's choice.
    ///
    /// # Errors
    /// As [`Editor::new`].
    pub fn of(scene: Scene, backend: Backend) -> Result<Self, EditError> {
        let mut editor = Self::assemble(scene, backend);
        editor.factor()?;
        Ok(editor)
    }

    /// The first half of [`Editor::new`]: all systems, not factored yet.
    pub fn assemble(scene: Scene, backend: Backend) -> Self {
        let settings = SpatialSettings::of(scene.mode);
        let rests: Vec<RestPath> =
            scene.characters.par_iter().map(|character| character.track.rest_path()).collect();
        let expansion = expand(&scene, &rests);
        let (spatial, held) = spatial_groups(&rests, &expansion.held, settings, backend);
        let (temporal, times) = temporal_groups((step_bounds(&scene), backend), &rests, &expansion.times);
        let characters = rests.into_iter().map(EditedCharacter::at_rest);
        let edit = Edit { characters: characters.collect(), energy: Energy::default(), notes: Vec::new() };
        let extents = edit.characters.iter().map(extent).collect();
        let following: Vec<(Following, Hold)> =
            expansion.following.iter().map(|row| (*row, expansion.held[row.row].hold)).collect();
        let mut ties = ObjectTies::new(&scene, (&spatial, &temporal), &following);
        ties.regroup(&spatial, &held, &following);
        let (coupled, hands) = (vec![false; following.len()], HandsAtRest::new(scene.characters.len()));
        Self {
            scene,
            edit,
            extents,
            spatial,
            temporal,
            held,
            times,
            following,
            coupled,
            ties,
            hands,
            regrouped: 0,
            timed: 0,
            settings,
            backend,
        }
    }

    /// Takes over what `other` knows of bodies, and orders of elimination where patterns are the same: an editor of a scene in which
    /// nobody but `changed` has another track. Nothing solved is different for it.
    pub fn adopt(&mut self, other: &Self, changed: CharacterId) {
        self.hands.adopt(&other.hands, changed);
        for (group, before) in self.spatial.iter_mut().zip(&other.spatial) {
            if group.characters == before.characters {
                group.component.adopt(&before.component);
            }
        }
    }

    /// The second half of [`Editor::new`]; [`Editor::solve`] does it where it was not done.
    ///
    /// # Errors
    /// [`EditError::Solver`] where a system cannot be factored.
    pub fn factor(&mut self) -> Result<(), EditError> {
        let scene = &self.scene;
        for_each_stale(&mut self.spatial, |group| {
            group.component.factor().map_err(|error| space_error(scene, &group.characters, error))
        })?;
        for_each_stale(&mut self.temporal, |group| {
            group.component.factor().map_err(|error| time_error(scene, &group.characters, error))
        })
    }

    /// Assembles all systems anew and forgets what was factored, as a program would that keeps nothing: to compare with.
    pub fn reassemble(&mut self) {
        for group in &mut self.spatial {
            group.component.reassemble();
            group.stale = true;
        }
        for group in &mut self.temporal {
            group.component.reassemble();
            group.stale = true;
        }
    }

    /// The scene, with its targets as they are now.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// How often solves have formed other groups of characters: what is known of the present systems holds as long as it stays.
    pub fn regrouped(&self) -> u64 {
        self.regrouped
    }

    /// How often solves have found other times, or other places of what objects hold: times of variants hold as long as it stays.
    pub fn timed(&self) -> u64 {
        self.timed
    }

    /// Scene and result, without what solves them.
    pub fn into_parts(self) -> (Scene, Edit) {
        (self.scene, self.edit)
    }

    /// The result of the last solve that succeeded; before the first, the motion at rest.
    pub fn edit(&self) -> &Edit {
        &self.edit
    }

    /// Moves the target of a constraint. The next [`Editor::solve`] follows; the systems stay factored, but for a moved
    /// offset between characters, which is a coefficient of its row.
    ///
    /// # Errors
    /// [`EditError::NotFinite`], or [`EditError::NoSuchTarget`] where the constraint holds nothing of that kind.
    pub fn move_target(&mut self, constraint: ConstraintId, target: Target) -> Result<(), EditError> {
        let entry = &mut self.scene.constraints[constraint.as_usize()];
        let named = |entry: &Constraint| Named { name: entry.name.clone(), line: entry.line };
        let finite = match target {
            Target::Position(point) | Target::Offset(point) => point.is_finite(),
            Target::Facing(value) | Target::Seconds(value) => value.is_finite(),
        };
        if !finite {
            return Err(EditError::NotFinite(named(entry)));
        }
        match (&mut entry.kind, target) {
            (ConstraintKind::Pin { position: Some(position), .. }, Target::Position(point)) => {
                *position = point
            }
            (ConstraintKind::Pin { facing: Some(facing), .. }, Target::Facing(angle)) => *facing = angle,
            (ConstraintKind::Relative { offset: Relation::Given(offset), .. }, Target::Offset(point)) => {
                *offset = point;
            }
            (ConstraintKind::Relative { facing: Relation::Given(facing), .. }, Target::Facing(angle)) => {
                *facing = angle;
            }
            (
                ConstraintKind::Time { seconds, .. }
                | ConstraintKind::Duration { seconds, .. }
                | ConstraintKind::Sync { offset: seconds, .. },
                Target::Seconds(value),
            ) => *seconds = value,
            (_, target) => return Err(EditError::NoSuchTarget(named(entry), target.name())),
        }
        self.retarget(constraint, target);
        Ok(())
    }

    fn retarget(&mut self, constraint: ConstraintId, target: Target) {
        let of_row = |(group, row): (usize, usize)| self.spatial[group].component.held[row].row.constraint;
        let mut changed = Vec::new();
        for (group, row) in self.held[rows_of(constraint, &self.held, of_row)].iter().copied() {
            let Group { component, stale, .. } = &mut self.spatial[group];
            *stale = true;
            if retarget(&mut component.held[row].row, &self.scene) {
                changed.push(group);
            }
        }
        changed.dedup();
        changed.into_iter().for_each(|group| self.spatial[group].component.reassemble());
        let Target::Seconds(seconds) = target else { return };
        let of_row = |(group, row): (usize, usize)| self.temporal[group].component.rows[row].constraint;
        for (group, row) in self.times[rows_of(constraint, &self.times, of_row)].iter().copied() {
            let Group { component, stale, .. } = &mut self.temporal[group];
            *stale = true;
            component.rows[row].seconds = seconds;
        }
    }

    /// Solves times, then paths, for the present targets; those of connected characters none of whose targets moved stay
    /// as they are. Cost: linear in frames of the others; in characters. Where places relative to carried objects are held,
    /// a few times that.
    ///
    /// # Errors
    /// Contradicting hard constraints, hard times that the bounds do not allow, carries that overlap, or a solver that gives
    /// up; then [`Editor::edit`] is still the result of the last solve that succeeded.
    pub fn solve(&mut self) -> Result<&Edit, EditError> {
        let scene = &self.scene;
        self.timed += u64::from(self.temporal.iter().any(|group| group.stale));
        for_each_stale(&mut self.temporal, |group| solve_times(scene, group))?;
        if self.scene.carries.is_empty() && self.following.is_empty() {
            self.solve_space()?;
            self.take_times();
        } else {
            let timed = self.ties.timed(&self.temporal, &self.following);
            let taken: Vec<bool> = self.temporal.iter().map(|group| group.stale).collect();
            self.take_times();
            if let Err(error) = self.solve_with_objects(&timed) {
                self.give_times_back(&taken);
                self.temporal.iter_mut().for_each(|group| group.stale = true);
                self.spatial.iter_mut().for_each(|group| group.stale = true);
                return Err(error);
            }
        }
        self.take_paths(|_| true);
        self.update_energy();
        self.edit.notes = self.notes();
        Ok(&self.edit)
    }

    fn solve_space(&mut self) -> Result<(), EditError> {
        let scene = &self.scene;
        for_each_stale(&mut self.spatial, |group| {
            group.component.solve().map_err(|error| space_error(scene, &group.characters, error))
        })
    }

    /// Exchanges stale times for those of their components, once all are solved.
    fn take_times(&mut self) {
        for group in self.temporal.iter_mut().filter(|group| group.stale) {
            for (times, character) in group.component.times.iter_mut().zip(&group.characters) {
                std::mem::swap(&mut self.edit.characters[*character].times, times);
                let times = &self.edit.characters[*character].times;
                self.extents[*character].seconds.1 = times[times.len() - 1] - times[0];
            }
            group.stale = false;
        }
    }

    /// Undoes [`Editor::take_times`] for the components in which times were taken.
    fn give_times_back(&mut self, taken: &[bool]) {
        for (group, _) in self.temporal.iter_mut().zip(taken).filter(|(_, taken)| **taken) {
            for (times, character) in group.component.times.iter_mut().zip(&group.characters) {
                std::mem::swap(&mut self.edit.characters[*character].times, times);
            }
        }
    }

    /// Exchanges stale paths for those of their components, once all are solved: of components of `wanted` first characters.
    fn take_paths(&mut self, wanted: impl Fn(usize) -> bool) {
        for group in self.spatial.iter_mut().filter(|group| group.stale && wanted(group.characters[0])) {
            let SpatialComponent { edited, bodies, .. } = &mut group.component;
            for ((edited, body), character) in edited.iter_mut().zip(bodies).zip(&group.characters) {
                let own = &mut self.edit.characters[*character];
                std::mem::swap(&mut own.positions, edited);
                std::mem::swap(&mut own.turns, &mut body.turns);
                self.extents[*character].length.1 = body.length;
            }
            group.stale = false;
        }
    }

    fn update_energy(&mut self) {
        let mut sums = (0.0, 0.0, 0.0);
        for group in &self.spatial {
            let energy = group.component.energy;
            sums.0 += energy.shape + energy.shape_soft;
            sums.1 += energy.scale + energy.scale_soft;
        }
        for group in &self.temporal {
            sums.2 += group.component.energy.0 + group.component.energy.1;
        }
        self.edit.energy = Energy::new(sums.0, sums.1, sums.2, &self.extents, self.scene.mode);
    }
}

/// Which of the rows at `places` belong to `constraint`; `of_row`: constraint of the row at a place, rising.
fn rows_of(
    constraint: ConstraintId,
    places: &[(usize, usize)],
    of_row: impl Fn((usize, usize)) -> ConstraintId,
) -> Range<usize> {
    let first = places.partition_point(|place| of_row(*place) < constraint);
    first..places.partition_point(|place| of_row(*place) <= constraint)
}

fn solve_times(scene: &Scene, group: &mut Group<TemporalComponent>) -> Result<(), EditError> {
    group.component.solve().map_err(|error| time_error(scene, &group.characters, error))?;
    for (times, character) in group.component.times.iter().zip(&group.characters) {
        if let Some(frame) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
            let character = scene.characters[*character].name.clone();
            return Err(EditError::BackwardTime { character, frame });
        }
    }
    Ok(())
}

fn extent(character: &EditedCharacter) -> Extent {
    let last = character.times.len() - 1;
    Extent {
        length: (length(&character.rest.positions), length(&character.positions)),
        seconds: (last as f64 * WORKING_STEP, character.times[last] - character.times[0]),
    }
}
