//! Hard rows that contradict each other: by how much, and whether a stationary stretch is to blame.

use std::sync::Arc;

use cotillion_solvers::{RowMatrix, analyse_rank};

use crate::edit::columns::{Columns, Freedom};
use crate::edit::hold::{Phase, Prepared};
use crate::edit::settings::{RelativeMode, RunMode};
use crate::path::RestPath;

/// By how much hard constraints miss each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Miss {
    /// Places.
    Metres(f64),
    /// Facings.
    Radians(f64),
}

impl std::fmt::Display for Miss {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Metres(metres) => write!(f, "{metres:.6} m"),
            Self::Radians(radians) => write!(f, "{:.4} degrees", radians.to_degrees()),
        }
    }
}

/// What a contradiction of rows by `metres` means: an angle, where only facings clash.
pub fn miss_of(rows: &[&Prepared], metres: f64) -> Miss {
    let lengths = rows.iter().map(|prepared| {
        prepared.at.filter(|_| prepared.row.hold.is_direction()).map(|direction| direction.rest.norm())
    });
    match lengths.collect::<Option<Vec<f64>>>().and_then(|lengths| lengths.into_iter().reduce(f64::max)) {
        Some(length) => Miss::Radians(2.0 * (metres / (2.0 * length)).min(1.0).asin()),
        None => Miss::Metres(metres),
    }
}

/// Stationary stretches, by path and position in its list, in which the places of `rows` lie; rising.
pub fn touched_runs(rests: &[Arc<RestPath>], rows: &[&Prepared]) -> Vec<(usize, usize)> {
    let mut runs = Vec::new();
    for hold in rows.iter().map(|prepared| prepared.row.hold) {
        for place in std::iter::once(hold.at()).chain(hold.to()) {
            let holds = |(a, b): &(usize, usize)| *a as f64 <= place.frame && place.frame <= *b as f64;
            runs.extend(rests[place.path].rigid.iter().position(holds).map(|run| (place.path, run)));
        }
    }
    runs.sort_unstable();
    runs.dedup();
    runs
}

/// Whether rows would contradict each other even if every frame were free: two targets for one instant.
pub fn is_irreducible(rests: &[Arc<RestPath>], rows: &[&Prepared], relative: RelativeMode) -> bool {
    let counts: Vec<usize> = rests.iter().map(|rest| rest.len()).collect();
    let runs = |path: usize| (0..rests[path].rigid.len()).map(move |run| (path, run));
    let released: Vec<(usize, usize)> = (0..rests.len()).flat_map(runs).collect();
    let terms: Vec<_> = rows.iter().map(|prepared| prepared.terms(Phase::Shape, relative, &counts)).collect();
    let freedom = Freedom {
        paths: rests,
        phase: Phase::Scale,
        runs: RunMode::Similar,
        released: &released,
        samplings: &[],
    };
    let columns = Columns::touched(freedom, terms.iter().map(Vec::as_slice));
    let mut matrix = RowMatrix::new(columns.count);
    for own in &terms {
        matrix.push_row(&columns.row(own));
    }
    !analyse_rank(&matrix.to_csr()).dependent.is_empty()
}
