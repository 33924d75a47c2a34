//! Solves paths while objects move.

use std::collections::BTreeMap;

use super::Editor;
use super::told::named;
use crate::edit::carrying::Carrying;
use crate::edit::error::{EditError, Named};
use crate::edit::expand::{Following, expand};
use crate::edit::facing::Turns;
use crate::edit::following::{OwnLoad, alike, follow, numbers, step, wanted, with_numbers};
use crate::edit::groups::{Group, spatial_groups};
use crate::edit::hold::Hold;
use crate::edit::mixing::Mixer;
use crate::edit::moved::{EditedCharacter, Moved};
use crate::index::{CharacterId, ConstraintId};
use crate::object_motion::{Objects, Overlap, Performance, Possessor, TwoLoads, overlap, two_loads};
use crate::path::RestPath;
use crate::scene::Scene;

/// Places relative to carried objects are solved so often at most, and twice more for each row that holds one.
const ROUNDS: usize = 20;
/// They stay where nothing changes by more than this, metres or radians.
const SETTLED: f64 = 1e-11;
/// Where somebody stands, a small shift turns their body much, and solves are not as exact: after the last attempt they
/// stay if this changes no more.
const UNSETTLED: f64 = 1e-8;

/// A set of characters whose rows relative to objects do not stay yet.
#[derive(Default)]
struct Unsettled {
    /// These rows, by position in the list of them.
    rows: Vec<usize>,
    mixer: Mixer,
    /// By how much they changed last, metres or radians.
    apart: f64,
}

impl Editor {
    /// Solves paths while objects move: keyframed ones are where the times say, and what is held relative to carried ones
    /// is solved until it stays. That begins from rest, so that the result does not depend on earlier targets.
    /// `timed`: of each set of characters that objects tie, whether times that concern it have changed.
    pub(super) fn solve_with_objects(&mut self, timed: &[bool]) -> Result<(), EditError> {
        let moved = Moved { scene: &self.scene, characters: &self.edit.characters };
        if let Some(Overlap { first, second, seconds }) = overlap(&self.scene, &moved) {
            let [first, second] = [first, second].map(|carry| carry_named(&self.scene, carry));
            return Err(EditError::CarriesOverlap { first, second, seconds });
        }
        if let Some(TwoLoads { character, overlap }) = two_loads(&self.scene, &moved) {
            let [first, second] =
                [overlap.first, overlap.second].map(|carry| carry_named(&self.scene, carry));
            let character = self.scene.characters[character.as_usize()].name.clone();
            return Err(EditError::HandsTaken { character, first, second, seconds: overlap.seconds });
        }
        if self.following.is_empty() {
            return self.solve_space();
        }
        self.hands.forget_times();
        self.solve_tied(timed)
    }

    /// The same of carries that do not overlap, with rows relative to objects.
    pub(super) fn solve_tied(&mut self, timed: &[bool]) -> Result<(), EditError> {
        let coupled = self.coupled_rows();
        self.timed += u64::from(coupled != self.coupled);
        self.coupled = coupled;
        self.ties.entangle(&self.following, &self.coupled);
        let (sets, entangled) = (&self.ties.sets, &self.ties.entangled);
        let mut active = timed.to_vec();
        for group in self.spatial.iter().filter(|group| group.stale) {
            active[sets[group.characters[0]]] = true;
        }
        let settling: Vec<bool> = active.iter().zip(entangled).map(|(active, own)| *active && *own).collect();
        let of = |(_, set): &(usize, &usize)| settling[**set];
        let settling_ones = self.ties.sets.iter().enumerate().filter(of);
        let before: Vec<(usize, EditedCharacter)> =
            settling_ones.map(|(who, _)| (who, self.edit.characters[who].clone())).collect();
        let solved = self.solve_sets(&active, &settling);
        if solved.is_err() {
            before.into_iter().for_each(|(who, own)| self.edit.characters[who] = own);
        }
        solved
    }

    /// Solves sets of characters that are `active`; those that are `settling`, from rest until they stay.
    fn solve_sets(&mut self, active: &[bool], settling: &[bool]) -> Result<(), EditError> {
        self.begin_at_rest(settling);
        let rows = self.rows_of(|set| active[set]);
        self.place(&rows)?;
        self.solve_space()?;
        let mut sets = BTreeMap::<usize, Unsettled>::new();
        for row in self.rows_of(|set| settling[set]) {
            sets.entry(self.ties.sets[self.following[row].0.at.path]).or_default().rows.push(row);
        }
        let settles: Vec<bool> = self.ties.sets.iter().map(|set| settling[*set]).collect();
        self.settle(sets.into_values().collect(), |who| settles[who])
    }

    /// Places rows relative to objects as these are on the present paths, whatever the rows bind.
    fn place(&mut self, rows: &[usize]) -> Result<(), EditError> {
        let read = self.read_objects(rows)?;
        if self.furthest(rows, &read).is_finite() {
            self.renumber(rows, &read);
            return Ok(());
        }
        let mut all: Vec<Hold> = self.following.iter().map(|(_, hold)| *hold).collect();
        rows.iter().zip(read).for_each(|(row, read)| all[*row] = read);
        self.rebuild(all);
        Ok(())
    }

    /// Solves until all sets stay, each by itself; their rows were placed on paths at rest and solved once. `settles`: whether a
    /// character is in one of them.
    fn settle(&mut self, mut sets: Vec<Unsettled>, settles: impl Fn(usize) -> bool) -> Result<(), EditError> {
        for round in 1.. {
            self.take_paths(&settles);
            let mut failure = None;
            sets.retain_mut(|set| match self.mix(set, round) {
                Ok(goes_on) => goes_on,
                Err(error) => {
                    failure.get_or_insert(error);
                    false
                }
            });
            if let Some(error) = failure {
                return Err(error);
            }
            if sets.is_empty() {
                break;
            }
            match self.solve_space() {
                // What runs away ends where numbers do, whatever the solver says of it.
                Err(EditError::Solver { .. }) => {
                    let rows: Vec<usize> = sets.iter().flat_map(|set| set.rows.iter().copied()).collect();
                    return Err(EditError::Unsettled(self.followers(&rows)));
                }
                solved => solved?,
            }
        }
        Ok(())
    }

    /// Gives the rows of a set their next numbers; `false` once they stay, or do so well enough after the last attempt.
    fn mix(
        &mut self,
        Unsettled { rows, mixer, apart }: &mut Unsettled,
        round: usize,
    ) -> Result<bool, EditError> {
        if round == ROUNDS + 2 * rows.len() {
            let stays = *apart <= UNSETTLED;
            return if stays { Ok(false) } else { Err(EditError::Unsettled(self.followers(rows))) };
        }
        let read = self.read_objects(rows)?;
        *apart = self.furthest(rows, &read);
        if *apart <= SETTLED {
            return Ok(false);
        }
        let present: Vec<f64> = rows.iter().flat_map(|row| numbers(&self.following[*row].1)).collect();
        let pairs = rows.iter().zip(&read);
        let steps: Vec<f64> = pairs.flat_map(|(row, new)| step(&self.following[*row].1, new)).collect();
        let mixed = mixer.next(&present, &steps);
        let mixed = mixed.chunks_exact(2).zip(&read).map(|(own, like)| with_numbers(like, [own[0], own[1]]));
        self.renumber(rows, &mixed.collect::<Vec<_>>());
        Ok(true)
    }

    /// Rows relative to objects, by position, whose characters are in a set that is `wanted`.
    fn rows_of(&self, wanted: impl Fn(usize) -> bool) -> Vec<usize> {
        let own = |row: &usize| wanted(self.ties.sets[self.following[*row].0.at.path]);
        (0..self.following.len()).filter(own).collect()
    }

    /// Of each row relative to an object that moves, whether its place depends on how others move: somebody has had the object.
    fn coupled_rows(&self) -> Vec<bool> {
        let moved = Moved { scene: &self.scene, characters: &self.edit.characters };
        let objects = Objects::new(&self.scene, &moved, &self.ties.carries);
        let coupled = |(row, _): &(Following, Hold)| {
            let seconds = moved.time(CharacterId::from_usize(row.at.path), row.at.frame);
            objects.possession_before(row.object, seconds).by != Possessor::Itself
        };
        self.following.iter().map(coupled).collect()
    }

    /// Constraints relative to objects that move, in the order of the scene.
    fn followers(&self, rows: &[usize]) -> Vec<Named> {
        let mut ids: Vec<ConstraintId> = rows.iter().map(|row| self.following[*row].0.constraint).collect();
        ids.dedup();
        ids.into_iter().map(|id| named(&self.scene, id)).collect()
    }

    /// Whoever is in one of these sets is at rest again.
    fn begin_at_rest(&mut self, settling: &[bool]) {
        let sets = &self.ties.sets;
        for (character, _) in self.edit.characters.iter_mut().zip(sets).filter(|(_, set)| settling[**set]) {
            character.positions.copy_from_slice(&character.rest.positions);
            let Turns { along_path, corrections, flips } = &mut character.turns;
            along_path.fill(0.0);
            corrections.clear();
            flips.clear();
        }
        self.spatial.iter_mut().for_each(|group| group.stale |= settling[sets[group.characters[0]]]);
    }

    /// Rows relative to objects that move as these are on the present paths.
    pub(super) fn read_objects(&self, rows: &[usize]) -> Result<Vec<Hold>, EditError> {
        let moved = Moved { scene: &self.scene, characters: &self.edit.characters };
        let performance = Carrying { moved, hands: &self.hands };
        let objects = Objects::new(&self.scene, &performance, &self.ties.carries);
        let read = |row: &usize| {
            let (row, _) = &self.following[*row];
            let constraint = row.constraint;
            let wanted = wanted(&self.scene.constraints[constraint.as_usize()].kind, row.before);
            follow(&moved, &objects, row, wanted).map_err(|OwnLoad { carry }| {
                let constraint = named(&self.scene, constraint);
                EditError::OwnLoad { constraint, carry: carry_named(&self.scene, carry) }
            })
        };
        rows.iter().map(read).collect()
    }

    /// By how much rows differ from the present ones, metres or radians; infinite where they bind other frames.
    fn furthest(&self, rows: &[usize], read: &[Hold]) -> f64 {
        let pairs = rows.iter().zip(read);
        let apart = |(row, new): (&usize, &Hold)| {
            let (_, old) = &self.following[*row];
            if alike(old, new) {
                step(old, new).into_iter().map(f64::abs).fold(0.0, f64::max)
            } else {
                f64::INFINITY
            }
        };
        pairs.map(apart).fold(0.0, f64::max)
    }

    /// Gives rows relative to objects that move other targets.
    fn renumber(&mut self, rows: &[usize], all: &[Hold]) {
        for (index, new) in rows.iter().zip(all) {
            let (row, hold) = &mut self.following[*index];
            if hold == new {
                continue;
            }
            *hold = *new;
            self.timed += 1;
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
        self.timed += 1;
    }
}

pub(super) fn carry_named(scene: &Scene, carry: usize) -> Named {
    let carry = &scene.carries[carry];
    Named { name: carry.name.clone(), line: carry.line }
}
