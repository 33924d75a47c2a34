//! Lengths of edited paths: all that what-ifs ask of these. Less is drawn for them than for an edit.

use std::ops::Range;

use cotillion_solvers::{Drawing, SpringPath};

use super::rotations::kept_runs;
use super::{Like, SpatialComponent};
use crate::edit::energy::length;
use crate::edit::facing::Body;
use crate::edit::parallel::for_each_path;
use crate::edit::turned::{TurnedPath, Turning};
use crate::geometry::c64;
use crate::path::RestSegments;

impl SpatialComponent {
    /// Draws the paths as the shape phase was last solved, and turns the rest paths, but for those that are about as in `like`. Cost:
    /// linear in frames.
    pub(super) fn shape_and_turn(&mut self, like: Option<Like>) {
        self.find_alike(like);
        let alike = &self.alike;
        let (shape, rests, segments) = (&self.shape, &self.rests, &self.segments);
        let (translations, chords, released) = (&self.translations, &self.chords, &self.released);
        let draw = |path: usize, shaped: &mut Vec<c64>, turned: &mut TurnedPath| {
            if alike.apart(path).is_some() {
                return;
            }
            let (own, translation) = ((&*rests[path], &*segments[path]), translations[path]);
            let mut turning = Turning::new(own, translation, (shaped, turned));
            if shape.draw(path, &mut turning) && turning.is_sound() {
                return;
            }
            shape.points(path, |frame| rests[path].positions[frame] + translation, shaped);
            turned.follow(&segments[path], shaped, kept_runs((rests, chords), released, path));
        };
        for_each_path(rests, &mut self.shaped, &mut self.turned, draw);
    }

    /// Lengths of the paths as the scale phase was last solved, which moved the turned ones by `translations` before that, or those in
    /// `like` that are about the same. Cost: linear in frames outside of stationary stretches.
    pub(super) fn find_lengths(&mut self, translations: &[c64], like: Option<Like>) {
        let known = self.lengths_alike(like);
        let (scale, segments, turned, alike) = (&self.scale, &self.segments, &self.turned, &self.alike);
        let its = like.map(|like| like.group.turned.as_slice());
        let measure = |path: usize, edited: &mut Vec<c64>, body: &mut Body| {
            if let Some(length) = known.get(path).copied().flatten() {
                body.length = length;
                return;
            }
            let points = alike.pick(path, turned, its).points.as_slice();
            let mut measuring = Measuring { turned: points, rest: &segments[path], sum: 0.0 };
            body.length = if scale.draw(path, &mut measuring) {
                measuring.sum
            } else {
                edited.resize(points.len(), c64::default());
                scale.points(path, |frame| points[frame] + translations[path], edited);
                length(edited)
            };
        };
        for_each_path(&self.rests, &mut self.edited, &mut self.bodies, measure);
    }
}

/// Adds up the length of a path as the scale phase moves its turned points.
struct Measuring<'a> {
    turned: &'a [c64],
    rest: &'a RestSegments,
    sum: f64,
}

impl Drawing for Measuring<'_> {
    #[inline]
    fn point(&mut self, j: usize, _: c64, factor: c64) {
        if let Some([from, to]) = self.turned.get(j..j + 2) {
            self.sum += (to - from + factor).norm_sqr().sqrt();
        }
    }

    /// But for the first point, springs do not bend inside of stationary stretches only, which a row keeps as they are.
    fn stiff(&mut self, range: Range<usize>, (x, factor): (c64, c64), _: &SpringPath) {
        let last = self.turned.len() - 1;
        if range.start == 0 {
            self.point(0, x, factor);
        }
        self.sum += self.rest.along[range.end.min(last)] - self.rest.along[range.start.max(1).min(last)];
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::constraint::Strength;
    use crate::edit::hold::{HeldRow, Hold, Place, Prepared};
    use crate::edit::settings::{Backend, SpatialSettings};
    use crate::index::ConstraintId;
    use crate::path::RestPath;

    /// Stretches of walks and stands: frames, metres a frame, turn a frame, radians.
    fn stretches() -> impl Strategy<Value = Vec<(usize, f64, f64)>> {
        let pace = prop_oneof![2 => 0.02..0.06_f64, 1 => Just(0.0), 1 => 0.0..0.002_f64];
        prop::collection::vec((4..20_usize, pace, -0.05..0.05_f64), 2..6)
    }

    /// Stands are stationary.
    fn path(stretches: &[(usize, f64, f64)]) -> RestPath {
        let (mut at, mut heading, mut path) = (c64::default(), 0.0, RestPath::default());
        for (frames, pace, turn) in stretches {
            let first = path.positions.len();
            for _ in 0..*frames {
                path.positions.push(at);
                path.headings.push(heading);
                at += c64::from_polar(*pace, heading);
                heading += turn;
            }
            if *pace < 0.01 && path.rigid.last().is_none_or(|last| last.1 + 1 < first) {
                path.rigid.push((first, path.positions.len() - 1));
            }
        }
        path
    }

    fn rows(rest: &RestPath, pins: &[(f64, (f64, f64), bool)]) -> Vec<Prepared> {
        let row = |(index, (share, shift, hard)): (usize, &(f64, (f64, f64), bool))| {
            let frame = (share * (rest.len() - 1) as f64).round();
            let strength = if *hard { Strength::Hard } else { Strength::Soft(5.0) };
            let at = Place { path: 0, frame, heading: 0.0, detail: c64::default() };
            let target = crate::path::at(&rest.positions, frame) + c64::new(shift.0, shift.1);
            let row = HeldRow {
                constraint: ConstraintId::from_usize(index),
                strength,
                hold: Hold::Position { at, target },
            };
            Prepared::new(row, std::slice::from_ref(rest), SpatialSettings::PRODUCTION.baseline)
        };
        pins.iter().enumerate().map(row).collect()
    }

    proptest! {
        #[test]
        fn lengths_are_those_of_the_edit(
            stretches in stretches(),
            pins in prop::collection::vec((0.0..1.0_f64, (-0.5..0.5_f64, -0.5..0.5_f64), any::<bool>()), 1..5),
            (paper, direct) in (any::<bool>(), any::<bool>()),
        ) {
            let settings = if paper { SpatialSettings::PAPER } else { SpatialSettings::PRODUCTION };
            let backend = if direct { Backend::Direct } else { Backend::Reduced };
            let rest = path(&stretches);
            let build = |lengths_only: bool| {
                let mut own = SpatialComponent::new(vec![rest.clone()], rows(&rest, &pins), settings, backend);
                own.lengths_only = lengths_only;
                own.solve().map(|()| own)
            };
            let (Ok(all), Ok(own)) = (build(false), build(true)) else { return Ok(()) };
            let close = |a: &[c64], b: &[c64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).norm() < 1e-9);
            prop_assert!(close(&all.shaped[0], &own.shaped[0]), "the shape");
            prop_assert!(close(&all.turned[0].points, &own.turned[0].points), "the turned path");
            let lengths = [all.bodies[0].length, own.bodies[0].length];
            prop_assert!((lengths[0] - lengths[1]).abs() < 1e-9, "{lengths:?}");
            prop_assert!((length(&all.edited[0]) - lengths[1]).abs() < 1e-9);
        }
    }
}
