//! Rest paths turned segment by segment as the shape phase turned them: what the scale phase starts from.

use crate::edit::direction::Direction;
use crate::geometry::c64;
use crate::path::{RestPath, RestSegments, SegmentFactors};

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

/// Unit rotation of a stationary stretch in the shape phase; one without extent turns with its first step.
fn run_rotation(chord: &Direction, shaped: &[c64], rotations: &[c64], first: usize) -> c64 {
    if chord.rest.norm() > 0.0 {
        return chord.rotation(shaped);
    }
    rotations.get(first).copied().unwrap_or(c64::new(1.0, 0.0))
}
