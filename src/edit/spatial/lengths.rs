//! Lengths of edited paths: all that what-ifs ask of these. Less is drawn for them than for an edit.

use std::ops::Range;

use cotillion_solvers::{Drawing, SpringPath};

use super::SpatialComponent;
use super::rotations::kept_runs;
use crate::edit::energy::length;
use crate::edit::facing::Body;
use crate::edit::parallel::for_each_path;
use crate::edit::turned::{TurnedPath, Turning};
use crate::geometry::c64;
use crate::path::RestSegments;

impl SpatialComponent {
    /// Draws the paths as the shape phase was last solved, and turns the rest paths. Cost: linear in frames.
    pub(super) fn shape_and_turn(&mut self) {
        let (shape, rests, segments) = (&self.shape, &self.rests, &self.segments);
        let (translations, chords, released) = (&self.translations, &self.chords, &self.released);
        let draw = |path: usize, shaped: &mut Vec<c64>, turned: &mut TurnedPath| {
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

    /// Lengths of the paths as the scale phase was last solved, which moved the turned ones by `translations` before that. Cost:
    /// linear in frames outside of stationary stretches.
    pub(super) fn find_lengths(&mut self, translations: &[c64]) {
        let (scale, segments, turned) = (&self.scale, &self.segments, &self.turned);
        let measure = |path: usize, edited: &mut Vec<c64>, body: &mut Body| {
            let points = turned[path].points.as_slice();
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
