//! Solves paths while objects move.

use super::{Editor, named};
use crate::edit::carrying::Carrying;
use crate::edit::error::{EditError, Named};
use crate::edit::expand::{Following, expand};
use crate::edit::facing::Turns;
use crate::edit::following::{OwnLoad, alike, follow, numbers, step, wanted, with_numbers};
use crate::edit::groups::{Group, spatial_groups};
use crate::edit::hold::Hold;
use crate::edit::mixing::Mixer;
use crate::edit::moved::Moved;
use crate::index::{CharacterId, ConstraintId};
use crate::object_motion::{Objects, Overlap, Performance, Possessor, overlap};
use crate::path::RestPath;
use crate::scene::Scene;

/// Places relative to carried objects are solved so often at most, and twice more for each row that holds one.
const ROUNDS: usize = 20;
/// They stay where nothing changes by more than this, metres or radians.
const SETTLED: f64 = 1e-11;
/// Where somebody stands, a small shift turns their body much, and solves are not as exact: after the last attempt they
/// stay if this changes no more.
const UNSETTLED: f64 = 1e-8;

impl Editor {
    /// Solves paths while objects move: keyframed ones are where the times say, and what is held relative to carried ones
    /// is solved until it stays. It begins from rest, so that the result does not depend on earlier targets.
    pub(super) fn solve_with_objects(&mut self) -> Result<(), EditError> {
        let moved = Moved { scene: &self.scene, characters: &self.edit.characters };
        if let Some(Overlap { first, second, seconds }) = overlap(&self.scene, &moved) {
            let [first, second] = [first, second].map(|carry| carry_named(&self.scene, carry));
            return Err(EditError::CarriesOverlap { first, second, seconds });
        }
        if self.following.is_empty() {
            return self.solve_space();
        }
        self.coupled = self.coupled_rows();
        self.ties.entangle(&self.following, &self.coupled);
        if self.coupled.contains(&true) { self.settle_objects() } else { self.solve_once() }
    }

    /// Solves paths where times alone tell the places of all objects that rows are relative to.
    fn solve_once(&mut self) -> Result<(), EditError> {
        let read = self.read_objects()?;
        if self.furthest(&read).is_infinite() {
            self.rebuild(read);
        } else {
            self.renumber(&read);
        }
        self.solve_space()
    }

    fn settle_objects(&mut self) -> Result<(), EditError> {
        self.begin_at_rest();
        let rounds = ROUNDS + 2 * self.following.len();
        let (mut mixer, mut apart) = (Mixer::default(), f64::INFINITY);
        for round in 0..rounds {
            let read = self.read_objects()?;
            apart = self.furthest(&read);
            if round > 0 && apart <= SETTLED {
                return Ok(());
            }
            if apart.is_infinite() {
                self.rebuild(read);
                mixer = Mixer::default();
            } else if round == 0 {
                // What was read at rest is no answer to the present numbers.
                self.renumber(&read);
            } else {
                let present: Vec<f64> = self.following.iter().flat_map(|(_, hold)| numbers(hold)).collect();
                let pairs = self.following.iter().zip(&read);
                let steps: Vec<f64> = pairs.flat_map(|((_, old), new)| step(old, new)).collect();
                let mixed = mixer.next(&present, &steps);
                let mixed =
                    mixed.chunks_exact(2).zip(&read).map(|(own, like)| with_numbers(like, [own[0], own[1]]));
                self.renumber(&mixed.collect::<Vec<_>>());
            }
            match self.solve_space() {
                // What runs away ends where numbers do, whatever the solver says of it.
                Err(EditError::Solver { .. }) if round > 0 => {
                    return Err(EditError::Unsettled(self.followers()));
                }
                solved => solved?,
            }
            self.take_paths();
        }
        if apart.is_nan() || apart > UNSETTLED {
            return Err(EditError::Unsettled(self.followers()));
        }
        Ok(())
    }

    /// Of each row relative to an object that moves, whether its place depends on how others move: somebody has had the object.
    fn coupled_rows(&self) -> Vec<bool> {
        let moved = Moved { scene: &self.scene, characters: &self.edit.characters };
        let objects = Objects::new(&self.scene, &moved);
        let coupled = |(row, _): &(Following, Hold)| {
            let seconds = moved.time(CharacterId::from_usize(row.at.path), row.at.frame);
            objects.possession_before(row.object, seconds).by != Possessor::Itself
        };
        self.following.iter().map(coupled).collect()
    }

    /// Constraints relative to objects that move, in the order of the scene.
    fn followers(&self) -> Vec<Named> {
        let places = self.following.iter().map(|(row, _)| self.held[row.row]);
        let mut ids: Vec<ConstraintId> =
            places.map(|(group, row)| self.spatial[group].component.held[row].row.constraint).collect();
        ids.dedup();
        ids.into_iter().map(|id| named(&self.scene, id)).collect()
    }

    fn begin_at_rest(&mut self) {
        for character in &mut self.edit.characters {
            character.positions.copy_from_slice(&character.rest.positions);
            let Turns { along_path, corrections, flips } = &mut character.turns;
            along_path.fill(0.0);
            corrections.clear();
            flips.clear();
        }
        self.spatial.iter_mut().for_each(|group| group.stale = true);
    }

    /// Rows relative to objects that move as these are on the present paths.
    fn read_objects(&self) -> Result<Vec<Hold>, EditError> {
        let moved = Moved { scene: &self.scene, characters: &self.edit.characters };
        let performance = Carrying { moved, hands: &self.hands };
        let objects = Objects::new(&self.scene, &performance);
        let read = |(row, _): &(Following, Hold)| {
            let (group, place) = self.held[row.row];
            let constraint = self.spatial[group].component.held[place].row.constraint;
            let wanted = wanted(&self.scene.constraints[constraint.as_usize()].kind, row.before);
            follow(&moved, &objects, row, wanted).map_err(|OwnLoad { carry }| {
                let constraint = named(&self.scene, constraint);
                EditError::OwnLoad { constraint, carry: carry_named(&self.scene, carry) }
            })
        };
        self.following.iter().map(read).collect()
    }

    /// By how much rows differ from the present ones, metres or radians; infinite where they bind other frames.
    fn furthest(&self, read: &[Hold]) -> f64 {
        let pairs = self.following.iter().zip(read);
        let apart = |((_, old), new): (&(Following, Hold), &Hold)| {
            if alike(old, new) {
                step(old, new).into_iter().map(f64::abs).fold(0.0, f64::max)
            } else {
                f64::INFINITY
            }
        };
        pairs.map(apart).fold(0.0, f64::max)
    }

    /// Gives rows relative to objects that move other targets.
    fn renumber(&mut self, all: &[Hold]) {
        for ((row, hold), new) in self.following.iter_mut().zip(all).filter(|((_, old), new)| old != *new) {
            *hold = *new;
            let (group, place) = self.held[row.row];
            let Group { component, stale, .. } = &mut self.spatial[group];
            *stale = true;
            // Paths are numbered otherwise there.
            let own = &mut component.held[place].row.hold;
            *own = with_numbers(own, numbers(new));
        }
    }

    /// Groups and assembles all spatial rows anew, with these in place of those relative to moving objects.
    fn rebuild(&mut self, read: Vec<Hold>) {
        let rests: Vec<RestPath> =
            self.edit.characters.iter().map(|character| character.rest.clone()).collect();
        let mut held = expand(&self.scene, &rests).held;
        for ((row, hold), read) in self.following.iter_mut().zip(read) {
            *hold = read;
            held[row.row].hold = read;
        }
        (self.spatial, self.held) = spatial_groups(&rests, &held, self.settings, self.backend);
        self.ties.regroup(&self.spatial, &self.held, &self.following);
        self.regrouped += 1;
    }
}

pub(super) fn carry_named(scene: &Scene, carry: usize) -> Named {
    let carry = &scene.carries[carry];
    Named { name: carry.name.clone(), line: carry.line }
}
