//! A group of characters of which one performs another path: solved with the factorisations of the group as it is.
//!
//! Exact where rows stay what they are but for their terms on that path, their targets and their weights: two small updates
//! stand for two factorisations, and solutions are refined as always. Mathematics: the exchange of a path in
//! `cotillion_solvers`.

use std::sync::Arc;

use cotillion_solvers::{Effort, PathResponse};

use crate::edit::bodies::leave_to_the_body;
use crate::edit::canvas::{Canvas, Canvases};
use crate::edit::hold::{Phase, Prepared, Rotations};
use crate::edit::own_path::OwnPath;
use crate::edit::phase::PhaseSolver;
use crate::edit::settings::FacingMode;
use crate::edit::spatial::{Alike, SpatialComponent, freedom};
use crate::geometry::c64;

/// How the two phases of a group answer to changes of one of its paths.
pub struct GroupResponse {
    path: usize,
    phases: [PathResponse; 2],
    /// Memory for solves of exchanged groups.
    canvases: Canvases,
}

/// Answers to changes of path `path`; `None` where they cannot be said beforehand: stretches had to be released, motions are
/// free, or all frames had to be solved. They hold until systems are factored anew.
pub fn response(group: &SpatialComponent, path: usize) -> Option<GroupResponse> {
    if !group.released.is_empty() {
        return None;
    }
    let phases = [group.shape.response(path)?, group.scale.response(path)?];
    Some(GroupResponse { path, phases, canvases: group.canvases.clone() })
}

/// The group with `other` in place of a path, and the rows `held` with those on it, for the shape phase; of its bodies it tells
/// lengths only, and it is solved [with a canvas](on_canvas). `None` where more would change than that. `before`: the same in
/// an earlier group, whose work is taken over where it is the same. Cost: linear in frames of the path and paths of the group,
/// and by the square of the rows of the path.
pub fn exchanged(
    group: &SpatialComponent,
    response: &GroupResponse,
    (other, before): (&Arc<OwnPath>, Option<SpatialComponent>),
    mut held: Vec<Prepared>,
) -> Option<SpatialComponent> {
    let path = response.path;
    if !group.released.is_empty() {
        return None;
    }
    let mut rests = group.rests.clone();
    rests[path] = Arc::clone(&other.rest);
    if group.settings.facing == FacingMode::TangentBlend {
        leave_to_the_body(&mut held, &rests);
    }
    let settings = group.settings;
    let (all, rows) = (rests.as_slice(), held.as_slice());
    let own = (path, freedom((all, &[]), Phase::Shape, &settings, &[]), &**other);
    let known = before.as_ref().map(|before| &before.shape);
    let shape = group.shape.exchanged(own, (rows, &group.held), &settings, (&response.phases[0], known))?;
    let mut segments = group.segments.clone();
    segments[path] = Arc::clone(&other.segments);
    let mut own_chords = group.chords.clone();
    own_chords[path] = Arc::clone(&other.chords);
    Some(SpatialComponent {
        shaped: Vec::new(),
        edited: Vec::new(),
        turned: Vec::new(),
        bodies: Vec::new(),
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
        // Until it is there, what is known from before.
        scale: before.map_or_else(PhaseSolver::none, |before| before.scale),
        others: Vec::new(),
        lengths_only: true,
        lacks_scale: true,
        alike: Alike::default(),
        canvases: Canvases::default(),
    })
}

/// Does `work` with an exchanged group that has room to be solved.
pub fn on_canvas<T>(
    response: &GroupResponse,
    group: &mut SpatialComponent,
    work: impl FnOnce(&mut SpatialComponent) -> T,
) -> T {
    let mut canvas = response.canvases.take(&group.rests);
    swap(&mut canvas, group);
    let done = work(group);
    swap(&mut canvas, group);
    response.canvases.give_back(canvas);
    done
}

/// Gives a group a canvas, or takes it away again.
fn swap(canvas: &mut Canvas, group: &mut SpatialComponent) {
    std::mem::swap(&mut canvas.bent[0], &mut group.shape.bent);
    std::mem::swap(&mut canvas.bent[1], &mut group.scale.bent);
    std::mem::swap(&mut canvas.shaped, &mut group.shaped);
    std::mem::swap(&mut canvas.turned, &mut group.turned);
    std::mem::swap(&mut canvas.edited, &mut group.edited);
    std::mem::swap(&mut canvas.bodies, &mut group.bodies);
}

/// Gives a group exchanged for `other` its scale system, to be solved by `effort`; `None` where more would change than the
/// path. Most shapes take too much already.
pub fn complete(
    group: &SpatialComponent,
    response: &GroupResponse,
    (own, other, effort): (&mut SpatialComponent, &OwnPath, Effort),
) -> Option<()> {
    if !group.released.is_empty() {
        return None;
    }
    let settings = own.settings;
    let freedom = freedom((&own.rests, &[]), Phase::Scale, &settings, &[]);
    let path = (response.path, freedom, other);
    let mut scale = group.scale.exchanged(
        path,
        (&own.held, &group.held),
        &settings,
        (&response.phases[1], Some(&own.scale)),
    )?;
    scale.bent = own.scale.bent.take();
    own.scale = scale;
    set_effort(own, effort);
    own.lacks_scale = false;
    Some(())
}

/// How far solves of a group go from now on.
pub fn set_effort(group: &mut SpatialComponent, effort: Effort) {
    group.shape.set_effort(effort);
    group.scale.set_effort(effort);
}
