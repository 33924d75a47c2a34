//! How the places of held rows turn from the rest paths to the shaped ones.

use std::sync::Arc;

use super::verdicts::unique;
use super::{Like, SpatialComponent, SpatialError};
use crate::edit::bodies::{first_disagreement, spread_still_rotations};
use crate::edit::clash::Miss;
use crate::edit::direction::Direction;
use crate::edit::hold::{Hold, Rotations};
use crate::edit::parallel::for_each_path;
use crate::edit::turned::TurnedPath;
use crate::geometry::{c64, cis};
use crate::path::RestPath;

impl SpatialComponent {
    /// Rotations before the shape phase, which only bodies without direction use: what a facing of their own says.
    pub(super) fn rest_rotations(&mut self) {
        let mut facings = vec![c64::new(1.0, 0.0); self.rests.len()];
        for prepared in self.held.iter().rev().filter(|prepared| prepared.at.is_none()) {
            if let Hold::Facing { at, heading } = prepared.row.hold {
                facings[at.path] = cis(heading - at.heading);
            }
        }
        for (rotations, prepared) in self.rotations.iter_mut().zip(&self.held) {
            rotations.at = match prepared.row.hold {
                Hold::Facing { at, heading } if prepared.body_only => cis(heading - at.heading),
                hold => facings[hold.at().path],
            };
            rotations.to = prepared.row.hold.to().map_or(c64::new(1.0, 0.0), |to| facings[to.path]);
        }
        self.update_body_partners();
    }

    /// Whether [`update_rotations`](Self::update_rotations) can find that a body turned on the way.
    pub(super) fn may_turn(&self) -> bool {
        self.held.iter().any(|prepared| {
            let still = prepared.at.is_none() && matches!(prepared.row.hold, Hold::RelativeFacing { .. });
            still || prepared.partner_row.is_some()
        })
    }

    /// Whether the shape phase has other targets than with the rotations `before`.
    pub(super) fn asks_otherwise(&self, before: &[Rotations]) -> bool {
        let turned = self.held.iter().zip(self.rotations.iter().zip(before));
        turned.filter(|(_, (now, before))| now != before).any(|(held, _)| !held.ignores_rotations())
    }

    /// Turns the rest paths as the last shape says.
    pub(super) fn turn_paths(&mut self) {
        let (rests, segments, chords, released) = (&self.rests, &self.segments, &self.chords, &self.released);
        let turn = |path: usize, shaped: &mut Vec<c64>, turned: &mut TurnedPath| {
            turned.follow(&segments[path], shaped, kept_runs((rests, chords), released, path));
        };
        for_each_path(rests, &mut self.shaped, &mut self.turned, turn);
    }

    /// Rotations of all places on the shaped paths, or those of `like` that stand for them; whether a body without direction turned on the way.
    pub(super) fn update_rotations(&mut self, like: Option<Like>) -> bool {
        let (alike, own, its) = (&self.alike, &self.shaped, like.map(|like| like.group.shaped.as_slice()));
        let shaped = |path: usize| alike.pick(path, own, its);
        let mut turned = false;
        for (rotations, prepared) in self.rotations.iter_mut().zip(&self.held) {
            let hold = prepared.row.hold;
            if let (Some(direction), Some(to), None) = (prepared.to, hold.to(), prepared.partner_row) {
                rotations.to = direction.rotation(shaped(to.path));
            }
            match (prepared.at, hold) {
                (Some(direction), _) if !prepared.body_only => {
                    rotations.at = direction.rotation(shaped(hold.at().path));
                }
                (_, Hold::RelativeFacing { at, to, angle }) => {
                    let own = cis(to.heading + angle - at.heading) * rotations.to;
                    turned |= prepared.at.is_none() && (own - rotations.at).norm_sqr() > 1e-24;
                    rotations.at = own;
                }
                (_, Hold::Facing { at, heading }) => rotations.at = cis(heading - at.heading),
                (_, Hold::Position { .. } | Hold::Offset { .. } | Hold::Beside { .. }) => {}
            }
        }
        let partners = self.update_body_partners();
        (turned && spread_still_rotations(&self.held, &mut self.rotations, self.rests.len())) || partners
    }

    /// Hard facings that are left to one body at one moment must agree.
    pub(super) fn check_bodies(&self) -> Result<(), SpatialError> {
        match first_disagreement(&self.held, &self.rotations) {
            None => Ok(()),
            Some((rows, radians)) => {
                let constraints = unique(rows.map(|row| self.held[row].row.constraint).to_vec());
                Err(SpatialError::Conflict { constraints, miss: Miss::Radians(radians) })
            }
        }
    }

    /// Rotations of partners whose facing at that very moment is left to their bodies; whether one changed.
    fn update_body_partners(&mut self) -> bool {
        let mut changed = false;
        for row in 0..self.held.len() {
            if let Some(partner) = self.held[row].partner_row {
                let rotation = self.rotations[partner].at;
                changed |= (self.rotations[row].to - rotation).norm_sqr() > 1e-24;
                self.rotations[row].to = rotation;
            }
        }
        changed
    }
}

/// Stationary stretches of a path that keep their shape, and their longest chords.
pub(super) fn kept_runs<'a>(
    (rests, chords): (&'a [Arc<RestPath>], &'a [Arc<Vec<Direction>>]),
    released: &'a [(usize, usize)],
    path: usize,
) -> impl Iterator<Item = (&'a (usize, usize), &'a Direction)> {
    let kept = move |(run, _): &(usize, _)| released.binary_search(&(path, *run)).is_err();
    rests[path].rigid.iter().zip(chords[path].iter()).enumerate().filter(kept).map(|(_, run)| run)
}
