//! The systems of a group.

use std::sync::Arc;

use crate::edit::columns::Freedom;
use crate::edit::hold::{Phase, Prepared};
use crate::edit::phase::PhaseSolver;
use crate::edit::sampling::Sampling;
use crate::edit::settings::{Backend, SpatialSettings};
use crate::path::RestPath;

/// Systems of both phases, assembled.
pub(super) fn assemble_both(
    paths: (&[Arc<RestPath>], &[Sampling]),
    held: &[Prepared],
    (settings, backend): (&SpatialSettings, Backend),
    released: &[(usize, usize)],
) -> [PhaseSolver; 2] {
    [Phase::Shape, Phase::Scale]
        .map(|phase| PhaseSolver::new(freedom(paths, phase, settings, released), held, settings, backend))
}

/// What may move in a phase.
pub(in crate::edit) fn freedom<'a>(
    (paths, samplings): (&'a [Arc<RestPath>], &'a [Sampling]),
    phase: Phase,
    settings: &SpatialSettings,
    released: &'a [(usize, usize)],
) -> Freedom<'a> {
    Freedom { paths, phase, runs: settings.runs, released, samplings }
}
