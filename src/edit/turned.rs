//! Rest paths turned segment by segment as the shape phase turned them: what the scale phase starts from.

use std::ops::Range;

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

    /// The same of the points alone, where nobody asks for factors: these stay as they were.
    pub fn follow_points<'a>(
        &mut self,
        rest: &RestSegments,
        shaped: &[c64],
        runs: impl Iterator<Item = (&'a (usize, usize), &'a Direction)> + Clone,
    ) {
        let one = c64::new(1.0, 0.0);
        let (mut from, mut sound) = (0, true);
        self.points[0] = c64::default();
        for ((first, last), chord) in runs.clone() {
            sound &= self.turn_segments(rest, shaped, from..*first);
            // One without extent has no segments to turn.
            let rotation = if chord.rest.norm() > 0.0 { chord.rotation(shaped) } else { one };
            let mut point = self.points[*first];
            for (step, next) in rest.steps[*first..*last].iter().zip(&mut self.points[*first + 1..]) {
                point += step * rotation;
                *next = point;
            }
            from = *last;
        }
        sound &= self.turn_segments(rest, shaped, from..rest.steps.len());
        if !sound {
            self.follow(rest, shaped, runs);
        }
    }

    /// Turns each of these segments by itself; whether none collapses.
    fn turn_segments(&mut self, rest: &RestSegments, shaped: &[c64], range: Range<usize>) -> bool {
        let (mut point, mut sound) = (self.points[range.start], true);
        let segments = rest.steps[range.clone()].iter().zip(&rest.inverses[range.clone()]);
        let ends = shaped[range.start..=range.end].windows(2);
        for (((step, inverse), ends), next) in segments.zip(ends).zip(&mut self.points[range.start + 1..]) {
            let rotation = rotation_of((ends[1] - ends[0]) * inverse);
            // Where both points are one at rest, there is nothing to turn.
            sound &= rotation != c64::default() || *inverse == c64::default();
            point += step * rotation;
            *next = point;
        }
        sound
    }
}

/// Unit rotation of a stationary stretch in the shape phase; one without extent turns with its first step.
fn run_rotation(chord: &Direction, shaped: &[c64], rotations: &[c64], first: usize) -> c64 {
    if chord.rest.norm() > 0.0 {
        return chord.rotation(shaped);
    }
    rotations.get(first).copied().unwrap_or(c64::new(1.0, 0.0))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::edit::own_path::chords;

    /// Steps, how far each bends, and whether it stands: some of the path is repeated, some collapses.
    fn given() -> impl Strategy<Value = Vec<(u8, f64, u8)>> {
        prop::collection::vec((0..4_u8, -1.0..1.0_f64, 0..12_u8), 4..40)
    }

    proptest! {
        #[test]
        fn points_alone_are_the_same_points(given in given(), runs in (0..12_usize, 1..4_usize, 1..9_usize)) {
            let (mut at, mut to) = (c64::default(), c64::default());
            let (mut positions, mut shaped) = (vec![at], vec![to]);
            for (length, bend, kind) in &given {
                let step = c64::new(f64::from(*length) * 0.01, bend * 0.003 * f64::from(*length));
                at += step;
                to += if *kind == 0 { c64::default() } else { step * c64::new(1.1, *bend) };
                positions.push(at);
                shaped.push(to);
            }
            let (first, gap, long) = runs;
            let starts = [first, first + long + gap];
            let kept = starts.into_iter().map(|a| (a, a + long)).filter(|(_, b)| *b < positions.len());
            let rest = RestPath { headings: vec![0.0; positions.len()], positions, rigid: kept.collect() };
            let (segments, chords) = (rest.segments(), chords(&rest));
            let runs = || rest.rigid.iter().zip(&chords);
            let [mut all, mut own] = [TurnedPath::new(&rest), TurnedPath::new(&rest)];
            all.follow(&segments, &shaped, runs());
            own.follow_points(&segments, &shaped, runs());
            prop_assert_eq!(all.points, own.points);
        }
    }
}
