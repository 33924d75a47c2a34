//! Rest paths turned segment by segment as the shape phase turned them: what the scale phase starts from.

use std::ops::Range;

use cotillion_solvers::{Drawing, SpringPath};

use crate::edit::direction::Direction;
use crate::geometry::c64;
use crate::path::{RestPath, RestSegments, SegmentFactors, rotation_of};

/// A path of rest segments turned as in the shape phase.
#[derive(Default)]
pub struct TurnedPath {
    /// Segment factors of the shape phase; inside a kept stationary stretch, rotations are that of the stretch.
    pub factors: SegmentFactors,
    /// From the origin.
    pub points: Vec<c64>,
}

impl TurnedPath {
    /// Not turned yet.
    pub fn new(rest: &RestPath) -> Self {
        Self { factors: SegmentFactors::default(), points: rest.positions.clone() }
    }

    /// Turns as `shaped` does. `runs`: kept stationary stretches and their longest chords.
    pub fn follow<'a>(
        &mut self,
        rest: &RestSegments,
        shaped: &[c64],
        runs: impl Iterator<Item = (&'a (usize, usize), &'a Direction)>,
    ) {
        self.factors.update(rest, shaped);
        let rotations = &mut self.factors.rotations;
        for ((first, last), chord) in runs {
            let rotation = run_rotation(chord, shaped, rotations, *first);
            rotations[*first..*last].fill(rotation);
        }
        let mut point = c64::default();
        self.points[0] = point;
        for ((step, rotation), next) in rest.steps.iter().zip(rotations).zip(&mut self.points[1..]) {
            point += step * *rotation;
            *next = point;
        }
    }
}

/// Draws a path as the shape phase bent it and turns its rest segments in one pass, where nobody asks for their factors.
pub struct Turning<'a> {
    rest: &'a RestPath,
    segments: &'a RestSegments,
    /// What moves the rest path before it is bent.
    translation: c64,
    shaped: &'a mut [c64],
    turned: &'a mut [c64],
    /// The next point of the turned path.
    at: c64,
    /// No segment has collapsed.
    is_sound: bool,
}

impl<'a> Turning<'a> {
    /// Nothing is drawn yet. `shaped`, `turned`: room for as many points as the path has.
    pub fn new(
        (rest, segments): (&'a RestPath, &'a RestSegments),
        translation: c64,
        (shaped, turned): (&'a mut [c64], &'a mut TurnedPath),
    ) -> Self {
        let turned = turned.points.as_mut_slice();
        Self { rest, segments, translation, shaped, turned, at: c64::default(), is_sound: true }
    }

    /// Whether every segment had a direction: otherwise [`TurnedPath::follow`] tells how it turned.
    pub fn is_sound(&self) -> bool {
        self.is_sound
    }
}

impl Drawing for Turning<'_> {
    #[inline]
    fn point(&mut self, j: usize, x: c64, factor: c64) {
        self.shaped[j] = self.rest.positions[j] + self.translation + x;
        self.turned[j] = self.at;
        if let Some(step) = self.segments.steps.get(j) {
            let rotation = rotation_of(factor + 1.0);
            self.is_sound &= rotation != c64::default() || *step == c64::default();
            self.at += step * rotation;
        }
    }

    fn stiff(&mut self, range: Range<usize>, (x, factor): (c64, c64), _: &SpringPath) {
        let rotation = rotation_of(factor + 1.0);
        self.is_sound &= rotation != c64::default();
        let (start, at) = (self.translation + x, self.at);
        let first = self.rest.positions[range.start];
        let rest = &self.rest.positions[range.clone()];
        let drawn = self.shaped[range.clone()].iter_mut().zip(&mut self.turned[range.clone()]);
        for (own, (shaped, turned)) in rest.iter().zip(drawn) {
            let arm = own - first;
            *shaped = own + start + factor * arm;
            *turned = at + rotation * arm;
        }
        self.at += rotation * (self.rest.positions[range.end] - first);
    }
}

/// Unit rotation of a stationary stretch in the shape phase; one without extent turns with its first step.
fn run_rotation(chord: &Direction, shaped: &[c64], rotations: &[c64], first: usize) -> c64 {
    if chord.rest.norm() > 0.0 {
        return chord.rotation(shaped);
    }
    rotations.get(first).copied().unwrap_or(c64::new(1.0, 0.0))
}
