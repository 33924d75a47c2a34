//! What a group says of its held rows: which contradict each other, which say nothing new.

use super::{Attempt, SpatialComponent, SpatialError};
use crate::edit::clash;
use crate::edit::hold::Prepared;
use crate::index::ConstraintId;

impl SpatialComponent {
    /// Releases the stationary stretches that the contradicting rows touch; without any, that is a conflict.
    pub(super) fn clash(&self, rows: &[usize], miss: f64) -> Result<Attempt, SpatialError> {
        let clashing: Vec<&Prepared> = rows.iter().map(|row| &self.held[*row]).collect();
        let mut runs = clash::touched_runs(&self.rests, &clashing);
        runs.retain(|run| !self.released.contains(run));
        if !runs.is_empty() && !clash::is_irreducible(&self.rests, &clashing, self.settings.relative) {
            return Ok(Attempt::Release(runs));
        }
        let constraints = unique(clashing.iter().map(|prepared| prepared.row.constraint).collect());
        Err(SpatialError::Conflict { constraints, miss: clash::miss_of(&clashing, miss) })
    }

    /// Constraints with hard rows that others imply, in either phase.
    pub fn redundant(&self) -> Vec<ConstraintId> {
        let rows = self.shape.redundant().chain(self.scale.redundant());
        unique(rows.map(|row| self.held[row].row.constraint).collect())
    }

    /// Number of free motions that were fixed as at rest, in the shape and the scale phase.
    pub fn gauges(&self) -> (usize, usize) {
        (self.shape.gauges(), self.scale.gauges())
    }
}

/// Rising, each once.
pub(super) fn unique(mut constraints: Vec<ConstraintId>) -> Vec<ConstraintId> {
    constraints.sort_unstable();
    constraints.dedup();
    constraints
}
