//! The shape energy of a group of characters if one of their paths were another, without solving again.
//!
//! Exact where the rows stay what they are but for their terms on that path and their targets. Mathematics: the what-ifs of
//! `cotillion_solvers`.

use cotillion_solvers::{Change, MomentTree, Part, PathResponse};

use crate::edit::columns::Freedom;
use crate::edit::hold::{Phase, Prepared, Rotations, Term};
use crate::edit::phase::{PhaseSolver, weight_of};
use crate::edit::settings::{RunMode, SpatialSettings};
use crate::edit::springs::shape_path;
use crate::geometry::c64;
use crate::path::RestPath;

/// Coefficients and weights are the same if they differ by no more than this, relative to the larger.
const SAME: f64 = 1e-12;

/// A group of which one path is another.
#[derive(Clone, Copy, Debug)]
pub struct ChangedPath<'a> {
    /// Which path, by position in the group.
    pub path: usize,
    /// Rest paths, the other one among them.
    pub rests: &'a [&'a RestPath],
    /// Held rows of the group on these.
    pub held: &'a [Prepared],
    /// Displacements of the rest paths that the present targets are counted from.
    pub translations: &'a [c64],
}

/// Shape energy with that of soft rows if a path were another; `None` where more than that path would change.
/// `shape`: solved; `response`: that of the path. Cost: linear in the frames of the path.
pub fn shape_energy_if(
    shape: &PhaseSolver,
    response: &PathResponse,
    changed: &ChangedPath<'_>,
    settings: &SpatialSettings,
) -> Option<f64> {
    let rest = changed.rests[changed.path];
    let paths = std::slice::from_ref(rest);
    let freedom = Freedom { paths, phase: Phase::Shape, runs: settings.runs, released: &[] };
    let trees = [MomentTree::new(&shape_path(freedom, 0, settings))];
    let whole = Part {
        source: 0,
        points: (0, rest.len() - 1),
        turn: c64::new(1.0, 0.0),
        start: trees[0].point(0),
        compliances: (0.0, 0.0),
    };
    let path = cotillion_solvers::SplicedPath::new(&trees, vec![whole]);
    let counts: Vec<usize> = changed.rests.iter().map(|rest| rest.len()).collect();
    let rows = response.rows.iter().map(|row| changed_row(shape, *row, changed, (&counts, settings)));
    let (terms, targets) = rows.collect::<Option<Vec<_>>>()?.into_iter().unzip();
    shape.energy_if(response, &Change { path: &path, terms, targets })
}

/// Terms on the changed path and target of row `row` of the system, if the rest of it stays.
fn changed_row(
    shape: &PhaseSolver,
    row: usize,
    changed: &ChangedPath<'_>,
    (counts, settings): (&[usize], &SpatialSettings),
) -> Option<(Vec<(usize, c64)>, c64)> {
    let (held, present) = shape.row(row);
    let prepared = &changed.held[held];
    if !prepared.binds(Phase::Shape, settings.runs == RunMode::Rigid) {
        return None;
    }
    let terms = prepared.terms(Phase::Shape, settings.relative, counts);
    let weights_stay = match (weight_of(prepared), present.weight) {
        (Some(own), Some(before)) => (own - before).abs() <= SAME * before,
        (None, None) => true,
        _ => false,
    };
    let elsewhere = |(path, ..): &&Term| *path != changed.path;
    let others_stay =
        terms.iter().filter(elsewhere).count() == present.terms.iter().filter(elsewhere).count();
    let pairs = terms.iter().filter(elsewhere).zip(present.terms.iter().filter(elsewhere));
    let stays = |(a, b): (&Term, &Term)| (a.0, a.1) == (b.0, b.1) && (a.2 - b.2).norm() <= SAME * b.2.norm();
    if !weights_stay || !others_stay || !pairs.into_iter().all(stays) {
        return None;
    }
    let on_reference =
        |(path, frame, c): &Term| c * (changed.rests[*path].positions[*frame] + changed.translations[*path]);
    let value = prepared.target(Phase::Shape, settings.relative, Rotations::NONE);
    let target = value - terms.iter().map(on_reference).sum::<c64>();
    let own = terms.iter().filter(|term| term.0 == changed.path).map(|(_, frame, c)| (*frame, *c));
    Some((own.collect(), target))
}
