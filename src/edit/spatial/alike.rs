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
pub(in crate::edit) struct Like<'a> {
    /// The solution.
    pub(in crate::edit) group: &'a SpatialComponent,
    /// How far paths may be apart, and their lengths, metres.
    pub(in crate::edit) within: f64,
}

/// Paths that are taken from another solution.
#[derive(Default)]
pub(in crate::edit) struct Alike {
    /// By how much each is off after the shape phase, metres; `None` where it is drawn. Empty: all are.
    paths: Vec<Option<f64>>,
    /// By how much the lengths of all paths are off at most, metres, besides what follows from the energy.
    pub(in crate::edit) metres: f64,
    /// By how much the energy of the scale phase is less at most, m².
    pub(in crate::edit) energy: f64,
}

impl Alike {
    /// By how much a path is off, metres; `None` where it was drawn.
    pub(super) fn apart(&self, path: usize) -> Option<f64> {
        self.paths.get(path).copied().flatten()
    }

    /// What is known of a path: here, or there where it is about the same.
    pub(super) fn pick<'a, T>(&self, path: usize, own: &'a [T], its: Option<&'a [T]>) -> &'a T {
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use cotillion_solvers::Effort;
    use proptest::prelude::*;

    use super::*;
    use crate::constraint::Strength;
    use crate::edit::hold::{HeldRow, Place};
    use crate::edit::own_path::OwnPath;
    use crate::edit::settings::{Backend, SpatialSettings};
    use crate::edit::spatial::Solved;
    use crate::edit::what_if::{complete, exchanged, on_canvas, response, set_effort};
    use crate::index::ConstraintId;
    use crate::path::RestPath;

    /// Frames of walks and stands, in turn.
    const FRAMES: [usize; 5] = [30, 15, 40, 15, 30];
    /// Middles of the stands.
    const MEETINGS: [f64; 2] = [37.0, 92.0];
    /// How many paths there are; one in the middle is exchanged.
    const PATHS: usize = 9;

    /// A walk with two stands. `pace`: metres a frame; `turn`: radians a frame.
    fn walk(pace: f64, turn: f64) -> RestPath {
        let (mut at, mut heading, mut path) = (c64::default(), 0.0_f64, RestPath::default());
        for (stretch, frames) in FRAMES.into_iter().enumerate() {
            let first = path.positions.len();
            let stands = stretch % 2 == 1;
            for _ in 0..frames {
                path.positions.push(at);
                path.headings.push(heading);
                at += c64::from_polar(if stands { 1e-3 } else { pace }, heading);
                heading += turn;
            }
            if stands {
                path.rigid.push((first, path.positions.len() - 1));
            }
        }
        path
    }

    /// Walks that begin so that everybody's first stand is where the second one of the walk before is.
    fn chain(walks: &[(f64, f64)]) -> Vec<Arc<RestPath>> {
        let mut meeting = c64::default();
        let mut place = |(pace, turn): &(f64, f64)| {
            let mut walk = walk(*pace, *turn);
            let [first, second] = MEETINGS.map(|frame| crate::path::at(&walk.positions, frame));
            walk.positions.iter_mut().for_each(|point| *point += meeting - first);
            meeting += second - first;
            Arc::new(walk)
        };
        walks.iter().map(&mut place).collect()
    }

    /// Everybody's second stand is beside the next one's first; where they begin and the end of the chain is pinned, the last `moved`.
    fn rows(rests: &[Arc<RestPath>], moved: c64) -> Vec<Prepared> {
        let place = |path: usize, frame: f64| Place { path, frame, heading: 0.0, detail: c64::new(0.0, 0.3) };
        let pin = |at: Place, by: c64| Hold::Position {
            at: Place { detail: c64::default(), ..at },
            target: crate::path::at(&rests[at.path].positions, at.frame) + by,
        };
        let last = (rests[PATHS - 1].len() - 1) as f64;
        let mut holds = vec![pin(place(PATHS - 1, last), moved)];
        holds.extend((0..PATHS).map(|path| pin(place(path, 0.0), c64::default())));
        for path in 1..PATHS {
            let (at, to) = (place(path, MEETINGS[0]), place(path - 1, MEETINGS[1]));
            holds.push(Hold::Offset { at, to, offset: c64::new(0.5, 0.2) });
            holds.push(Hold::RelativeFacing { at, to, angle: 0.4 });
        }
        let row = |(index, hold): (usize, Hold)| {
            let constraint = ConstraintId::from_usize(index);
            let strength = if index == 0 { Strength::Soft(5.0) } else { Strength::Hard };
            Prepared::new(HeldRow { constraint, strength, hold }, rests, SpatialSettings::PRODUCTION.baseline)
        };
        holds.into_iter().enumerate().map(row).collect()
    }

    /// Lengths and energy of the scale phase with its residuals of what a chain of walks becomes if one of them goes at another pace:
    /// drawn, and like the chain as it is; with what the second is off by, and how many paths it took from there.
    struct Both {
        drawn: (Vec<f64>, f64),
        like: (Vec<f64>, f64),
        off: (f64, f64),
        taken: usize,
    }

    fn both(
        walks: &[(f64, f64)],
        moved: c64,
        other: f64,
        within: f64,
        settings: SpatialSettings,
    ) -> Option<Both> {
        let rests = chain(walks);
        let held = rows(&rests, moved);
        let mut present = SpatialComponent::new(rests.clone(), held, settings, Backend::Reduced);
        present.solve().ok()?;
        let changed = PATHS / 2;
        let answers = response(&present, changed)?;
        let own = {
            let mut walk = walk(walks[changed].0 * other, walks[changed].1);
            walk.positions.iter_mut().for_each(|point| *point += rests[changed].positions[0]);
            Arc::new(OwnPath::new(walk))
        };
        let mut all = rests;
        all[changed] = Arc::clone(&own.rest);
        let mut group = exchanged(&present, &answers, (&own, None), rows(&all, moved))?;
        on_canvas(&answers, &mut group, |group| {
            let mut solve = |like: Option<Like>| {
                set_effort(group, Effort::Estimate);
                let mut solved = group.solve_below(f64::INFINITY, like).ok()?;
                if solved == Solved::LacksScale {
                    complete(&present, &answers, (group, &own, Effort::Estimate))?;
                    solved = group.go_on(f64::INFINITY, like).ok()?;
                }
                assert_eq!(solved, Solved::Both);
                let lengths: Vec<f64> = group.bodies.iter().map(|body| body.length).collect();
                Some((lengths, group.energy.scale + group.energy.scale_soft))
            };
            let drawn = solve(None)?;
            let like = solve(Some(Like { group: &present, within }))?;
            let taken = (0..PATHS).filter(|path| group.alike.apart(*path).is_some()).count();
            Some(Both { drawn, like, off: (group.alike.metres, group.alike.energy), taken })
        })
    }

    proptest! {
        #[test]
        fn what_is_taken_is_off_by_no_more_than_is_said(
            walks in prop::collection::vec((0.03..0.06_f64, -0.02..0.02_f64), PATHS),
            moved in (-1.0..1.0_f64, -1.0..1.0_f64),
            other in 0.7..1.4_f64,
            within in prop::sample::select(vec![1.0, 1e-1, 1e-2, 1e-4]),
            paper in any::<bool>(),
        ) {
            let settings = if paper { SpatialSettings::PAPER } else { SpatialSettings::PRODUCTION };
            let told = both(&walks, c64::new(moved.0, moved.1), other, within, settings);
            prop_assume!(told.is_some());
            let Both { drawn, like, off, taken } = told.expect("just seen");
            let apart: f64 = drawn.0.iter().zip(&like.0).map(|(a, b)| (a - b).abs()).sum();
            // Lengths follow from the energy's residuals, too: see `PER_METRE`.
            prop_assert!(apart <= 2.0 * off.0 + 1e-9, "lengths are {apart} off, said to be {off:?}, {taken} taken");
            prop_assert!(drawn.1 >= like.1 - off.1 - 1e-9 * like.1, "{} is less than {} by more than {}", drawn.1, like.1, off.1);
            prop_assert!(taken < PATHS, "the path that was exchanged is drawn");
            prop_assert!(taken > 0 || off == (0.0, 0.0));
        }
    }

    #[test]
    fn paths_far_down_the_chain_are_taken_and_those_near_are_drawn() {
        let both = both(&[(0.045, 0.01); PATHS], c64::new(0.5, 0.0), 1.1, 1e-1, SpatialSettings::PRODUCTION);
        let both = both.expect("an exchange");
        assert!((2..PATHS - 2).contains(&both.taken), "{} taken", both.taken);
    }
}
