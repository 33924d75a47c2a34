//! A group of characters of which one performs another path: solved with the factorisations of the group as it is.
//!
//! Exact where rows stay what they are but for their terms on that path, their targets and their weights: two small updates
//! stand for two factorisations, and solutions are refined as always. Mathematics: the exchange of a path in
//! `cotillion_solvers`.

use cotillion_solvers::{Effort, PathResponse};

use crate::edit::bodies::leave_to_the_body;
use crate::edit::facing::Body;
use crate::edit::hold::{Phase, Prepared, Rotations};
use crate::edit::phase::PhaseSolver;
use crate::edit::settings::FacingMode;
use crate::edit::spatial::{SpatialComponent, chords, freedom};
use crate::edit::turned::TurnedPath;
use crate::geometry::c64;
use crate::path::RestPath;

/// How the two phases of a group answer to changes of one of its paths.
#[derive(Clone, Debug)]
pub struct GroupResponse {
    path: usize,
    phases: [PathResponse; 2],
}

/// Answers to changes of path `path`; `None` where they cannot be said beforehand: stretches had to be released, motions are
/// free, or all frames had to be solved. They hold until systems are factored anew.
pub fn response(group: &SpatialComponent, path: usize) -> Option<GroupResponse> {
    if !group.released.is_empty() {
        return None;
    }
    Some(GroupResponse { path, phases: [group.shape.response(path)?, group.scale.response(path)?] })
}

/// The group with `rest` in place of a path, and the rows `held` with those on it, for the shape phase; of its bodies it tells
/// lengths only. `None`
/// where more would change than that. Cost: linear in frames of the group, and by the cube of the rows of the path.
pub fn exchanged(
    group: &SpatialComponent,
    response: &GroupResponse,
    rest: RestPath,
    mut held: Vec<Prepared>,
) -> Option<SpatialComponent> {
    let path = response.path;
    if !group.released.is_empty() {
        return None;
    }
    let mut rests = group.rests.clone();
    rests[path] = rest;
    if group.settings.facing == FacingMode::TangentBlend {
        leave_to_the_body(&mut held, &rests);
    }
    let settings = group.settings;
    let (all, rows) = (rests.as_slice(), held.as_slice());
    let own = |phase| (path, freedom((all, &[]), phase, &settings, &[]));
    let shape = group.shape.exchanged(own(Phase::Shape), rows, &settings, &response.phases[0])?;
    let mut segments = group.segments.clone();
    segments[path] = rests[path].segments();
    let mut own_chords = group.chords.clone();
    own_chords[path] = chords(&rests[path]);
    let points: Vec<Vec<c64>> = rests.iter().map(|rest| rest.positions.clone()).collect();
    Some(SpatialComponent {
        shaped: points.clone(),
        edited: points,
        turned: rests.iter().map(TurnedPath::new).collect(),
        bodies: rests.iter().map(|_| Body::default()).collect(),
        segments,
        rotations: vec![Rotations::NONE; held.len()],
        energy: Default::default(),
        translations: vec![c64::default(); rests.len()],
        released: Vec::new(),
        chords: own_chords,
        rests,
        samplings: Vec::new(),
        held,
        settings,
        backend: group.backend,
        shape,
        scale: PhaseSolver::none(),
        others: Vec::new(),
        lengths_only: true,
        lacks_scale: true,
    })
}

/// Gives an exchanged group its scale system, to be solved by `effort`; `None` where more would change than the path. Most shapes take too much already.
pub fn complete(
    group: &SpatialComponent,
    response: &GroupResponse,
    (own, effort): (&mut SpatialComponent, Effort),
) -> Option<()> {
    if !group.released.is_empty() {
        return None;
    }
    let settings = own.settings;
    let freedom = freedom((&own.rests, &[]), Phase::Scale, &settings, &[]);
    let path = (response.path, freedom);
    own.scale = group.scale.exchanged(path, &own.held, &settings, &response.phases[1])?;
    set_effort(own, effort);
    own.lacks_scale = false;
    Some(())
}

/// How far solves of a group go from now on.
pub fn set_effort(group: &mut SpatialComponent, effort: Effort) {
    group.shape.set_effort(effort);
    group.scale.set_effort(effort);
}
