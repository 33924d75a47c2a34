//! Solves paths while objects move.

use super::{Editor, named};
use crate::edit::error::{EditError, Named};
use crate::edit::expand::{Following, expand};
use crate::edit::facing::Turns;
use crate::edit::following::{Change, OwnLoad, adopt, change, follow, wanted};
use crate::edit::groups::{Group, spatial_groups};
use crate::edit::moved::Moved;
use crate::index::ConstraintId;
use crate::object_motion::{Overlap, object_motions, overlap};
use crate::path::RestPath;
use crate::scene::Scene;

/// Places relative to carried objects are solved so often, and twice more for each carry.
const ROUNDS: usize = 20;
/// They stay where nothing changes by more than this, metres or radians.
const SETTLED: f64 = 1e-11;
/// They do not stay where the last attempt still changes this much.
const UNSETTLED: f64 = 1e-7;

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
        let carried = |row: &Following| self.scene.carries.iter().any(|carry| carry.object == row.object);
        let settles = self.following.iter().any(|(row, _)| carried(row));
        if settles {
            self.begin_at_rest();
        }
        let rounds = if settles { ROUNDS + 2 * self.scene.carries.len() } else { 1 };
        let mut apart = f64::INFINITY;
        for round in 0..rounds {
            apart = self.follow_objects(if round > 0 { SETTLED } else { 0.0 })?;
            if round > 0 && apart == 0.0 {
                return Ok(());
            }
            self.solve_space()?;
            if settles {
                self.take_paths();
            }
        }
        if settles && apart > UNSETTLED {
            let constraints = self.following.iter().map(|(row, _)| self.held[row.row]);
            let ids = constraints.map(|(group, row)| self.spatial[group].component.held[row].row.constraint);
            let mut ids: Vec<ConstraintId> = ids.collect();
            ids.dedup();
            let constraints = ids.into_iter().map(|id| named(&self.scene, id)).collect();
            return Err(EditError::Unsettled { constraints, metres: apart });
        }
        Ok(())
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

    /// Sets rows relative to objects that move as these are on the present paths, but for rows that would change by no more
    /// than `settled`; by how much the others changed, metres or radians, infinite where they bind other frames.
    fn follow_objects(&mut self, settled: f64) -> Result<f64, EditError> {
        let moved = Moved { scene: &self.scene, characters: &self.edit.characters };
        let motions = object_motions(&self.scene, &moved);
        let (mut rebuild, mut apart, mut changed) = (false, 0.0_f64, Vec::new());
        for (row, old) in &mut self.following {
            let (group, place) = self.held[row.row];
            let Group { component, stale, .. } = &mut self.spatial[group];
            let constraint = component.held[place].row.constraint;
            let wanted = wanted(&self.scene.constraints[constraint.as_usize()].kind, row.before);
            let new = follow(&moved, &motions, row, wanted).map_err(|OwnLoad { carry }| {
                let constraint = named(&self.scene, constraint);
                EditError::OwnLoad { constraint, carry: carry_named(&self.scene, carry) }
            })?;
            let change = change(old, &new);
            match change {
                Change::Target(by) | Change::Coefficient(by) if by <= settled => continue,
                Change::Structure => {
                    (rebuild, apart, *old) = (true, f64::INFINITY, new);
                    continue;
                }
                Change::Coefficient(by) => {
                    changed.push(group);
                    apart = apart.max(by);
                }
                Change::Target(by) => apart = apart.max(by),
            }
            *old = new;
            *stale = true;
            adopt(&mut component.held[place].row.hold, &new);
        }
        if rebuild {
            self.rebuild();
        } else {
            changed.sort_unstable();
            changed.dedup();
            changed.into_iter().for_each(|group| self.spatial[group].component.reassemble());
        }
        Ok(apart)
    }

    /// Groups and assembles all spatial rows anew, those relative to moving objects as they are at present.
    fn rebuild(&mut self) {
        let rests: Vec<RestPath> =
            self.edit.characters.iter().map(|character| character.rest.clone()).collect();
        let mut held = expand(&self.scene, &rests).held;
        for (row, hold) in &self.following {
            held[row.row].hold = *hold;
        }
        (self.spatial, self.held) = spatial_groups(&rests, &held, self.settings, self.backend);
    }
}

fn carry_named(scene: &Scene, carry: usize) -> Named {
    let carry = &scene.carries[carry];
    Named { name: carry.name.clone(), line: carry.line }
}
