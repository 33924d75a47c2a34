//! Paths of a what-if that are about as somewhere else: what is known there will do to tell whether it can win.
//!
//! Change one track of a long chain and most others hardly feel it. How far a path is from the same one of another solution follows from
//! what holds it ([`Bent::compare`](cotillion_solvers::Bent::compare)), without drawing either.

use super::SpatialComponent;
use crate::edit::hold::{Hold, Prepared};
use crate::geometry::c64;

/// Turns are measured by how far off their paths places are, metres, and by no less than this.
const REACH: f64 = 1.0;
/// Segments shorter than this share of those at rest may turn by any angle.
const SHORTEST: f64 = 0.1;

/// Another solution of the same group, and how near to it paths count as the same.
#[derive(Clone, Copy)]
pub struct Like<'a> {
    /// The solution.
    pub group: &'a SpatialComponent,
    /// How far paths may be apart, and their lengths, metres.
    pub within: f64,
}

/// Paths that are taken from another solution.
#[derive(Default)]
pub struct Alike {
    /// By how much each is off after the shape phase, metres; `None` where it is drawn. Empty: all are.
    paths: Vec<Option<f64>>,
    /// By how much the lengths of all paths are off at most, metres, besides what follows from the energy.
    pub metres: f64,
    /// By how much the energy of the scale phase is less at most, m².
    pub energy: f64,
}

impl Alike {
    /// By how much a path is off, metres; `None` where it was drawn.
    pub fn apart(&self, path: usize) -> Option<f64> {
        self.paths.get(path).copied().flatten()
    }

    /// What is known of a path: here, or there where it is about the same.
    pub fn pick<'a, T>(&self, path: usize, own: &'a [T], its: Option<&'a [T]>) -> &'a T {
        match (self.apart(path), its) {
            (Some(_), Some(its)) => &its[path],
            _ => &own[path],
        }
    }
}

impl SpatialComponent {
    /// Finds the paths that the shape phase bent about as in `like`. Cost: by rows.
    pub(super) fn find_alike(&mut self, like: Option<Like>) {
        let mut alike = std::mem::take(&mut self.alike.paths);
        alike.clear();
        if let Some(like) = like.filter(|_| !self.may_turn()) {
            let reach = self.held.iter().map(reach).fold(REACH, f64::max);
            let apart = |path: usize| {
                self.turned_apart(like.group, (path, reach)).filter(|metres| *metres <= like.within)
            };
            alike.extend((0..self.rests.len()).map(apart));
        }
        self.alike = Alike { paths: alike, metres: 0.0, energy: 0.0 };
    }

    /// How far the turned path, and what is within reach of it, is from that of `like` at most, metres; `None` where that cannot be said.
    fn turned_apart(&self, like: &Self, (path, reach): (usize, f64)) -> Option<f64> {
        let along = &self.segments[path].along;
        let (mut steps, mut turn) = (0.0, 0.0_f64);
        let told = self.shape.compare(&like.shape, path, |range, likeness| {
            // |z/|z| − z'/|z'|| ≤ 2|z − z'|/(|z| + |z'|).
            let shortest = (likeness.factor + 1.0).norm_sqr().sqrt() - likeness.bend();
            let own = match shortest - likeness.apart {
                left if left >= SHORTEST => likeness.apart / (shortest - 0.5 * likeness.apart),
                _ => f64::INFINITY,
            };
            let last = along.len() - 1;
            steps += own * (along[range.end.min(last)] - along[range.start.min(last)]);
            turn = turn.max(own);
        });
        let metres = steps + reach * turn;
        (told && metres.is_finite()).then_some(metres)
    }

    /// The same of the length after the scale phase; `None` for paths that were drawn, too.
    fn length_apart(&self, like: &Self, path: usize) -> Option<f64> {
        let mut metres = self.alike.apart(path)?;
        let told = self.scale.compare(&like.scale, path, |range, likeness| {
            metres += likeness.apart * range.len() as f64;
        });
        (told && metres.is_finite()).then_some(metres)
    }

    /// By how much energy is less at most, as targets of the scale phase were measured by paths that are off, m².
    pub(super) fn energy_apart(&self) -> f64 {
        let mut off: Vec<f64> =
            (0..self.rests.len()).map(|path| self.alike.apart(path).unwrap_or(0.0)).collect();
        for prepared in &self.held {
            // Where one looks may depend on where another does, whom the row does not touch.
            if let Some(to) = prepared.row.hold.to() {
                off[prepared.row.hold.at().path] += self.alike.apart(to.path).unwrap_or(0.0);
            }
        }
        self.scale.work(|path| off[path])
    }

    /// Lengths that are about as in `like`, by path, metres; what they are off by is added up.
    pub(super) fn lengths_alike(&mut self, like: Option<Like>) -> Vec<Option<f64>> {
        let Some(like) = like else { return Vec::new() };
        let apart = |path: usize| self.length_apart(like.group, path).filter(|metres| *metres <= like.within);
        let apart: Vec<Option<f64>> = (0..self.rests.len()).map(apart).collect();
        let off = |path: usize| apart[path].or_else(|| self.alike.apart(path)).unwrap_or(0.0);
        self.alike.metres = (0..self.rests.len()).map(off).sum();
        let known = |(path, apart): (usize, Option<f64>)| apart.map(|_| like.group.bodies[path].length);
        apart.into_iter().enumerate().map(known).collect()
    }
}

/// How far the places of a row are off their paths, metres.
fn reach(prepared: &Prepared) -> f64 {
    let hold = prepared.row.hold;
    let offset = if let Hold::Offset { offset, .. } = hold { offset } else { c64::default() };
    let looked = prepared.at.map_or(c64::default(), |direction| direction.rest);
    let details = [hold.at().detail, hold.to().map_or(c64::default(), |to| to.detail)];
    [looked, offset, details[0], details[1]].iter().map(|arm| arm.norm_sqr().sqrt()).sum()
}
