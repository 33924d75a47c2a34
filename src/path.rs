//! Motion paths: rest path, tangents, local similarity factors, facing along a bent path.
//!
//! A path is one complex number a frame (`x − i z` of the root, metres). Source: Kim et al. 2009, §4.

use std::f64::consts::TAU;

use crate::clip::working::WORKING_STEP;
use crate::geometry::{c64, cis, smoothstep};

pub use tangents::{
    Flip, SHORTEST_TANGENT, TangentTurning, TangentTurns, degenerate, raw_tangents, repair_tangents,
    tangent_turns,
};

mod tangents;

/// Slower than this a tangent says nothing about direction, m/s.
pub const DEGENERATE_SPEED: f64 = 0.05;
/// Below `COINCIDENT · (1 + |p|)` metres two points are one.
pub const COINCIDENT: f64 = 1e-9;
/// Below this size a local similarity factor has collapsed and its angle is noise.
const COLLAPSED: f64 = 1e-9;
/// Tangents shorter than the first, at .3 m/s, count for nothing, longer than the second, at .6 m/s, for everything, metres
/// ([`blended_turns`]).
const BLEND_TANGENTS: (f64, f64) = (0.6 * WORKING_STEP, 1.2 * WORKING_STEP);

/// Rest path of one character: its track on the ground, before the edit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestPath {
    /// Ground position of each working frame, metres.
    pub positions: Vec<c64>,
    /// Facing of the body at each working frame, radians; as long as `positions`.
    pub headings: Vec<f64>,
    /// Stationary stretches, first and last frame, disjoint and rising.
    pub rigid: Vec<(usize, usize)>,
}

impl RestPath {
    /// Number of frames.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// No frame at all; the rest path of a track always has some.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The stationary stretch that holds the fractional frame `frame`.
    pub fn rigid_at(&self, frame: f64) -> Option<(usize, usize)> {
        self.rigid.iter().copied().find(|(a, b)| *a as f64 <= frame && frame <= *b as f64)
    }

    /// Whether two points of this path are one, to rounding.
    pub fn coincide(&self, a: usize, b: usize) -> bool {
        self.distance(a, b) <= COINCIDENT * (1.0 + self.positions[a].norm_sqr().sqrt())
    }

    /// Metres from one point to another.
    fn distance(&self, a: usize, b: usize) -> f64 {
        // Roots of sums: coordinates are metres, and the library's hypot takes several times as long.
        (self.positions[a] - self.positions[b]).norm_sqr().sqrt()
    }

    /// Its segments. Cost: linear in frames.
    pub fn segments(&self) -> RestSegments {
        let zero = c64::default();
        let step =
            |i: usize| if self.coincide(i, i + 1) { zero } else { self.positions[i + 1] - self.positions[i] };
        let steps: Vec<c64> = (0..self.len().saturating_sub(1)).map(step).collect();
        let inverses = steps.iter().map(|step| if *step == zero { zero } else { step.inv() }).collect();
        let length = |frame: usize| frame.checked_sub(1).map_or(0.0, |before| self.distance(before, frame));
        let along = (0..self.len()).scan(0.0, |sum, frame| {
            *sum += length(frame);
            Some(*sum)
        });
        RestSegments { steps, inverses, along: along.collect() }
    }
}

/// Segments of a rest path, found once: every edit of the path needs them at every frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestSegments {
    /// `v_i = q_{i+1} − q_i`, metres; 0 where both points are one.
    pub steps: Vec<c64>,
    /// `1/v_i`; 0 where both points are one.
    pub inverses: Vec<c64>,
    /// Length of the path up to each frame, metres.
    pub along: Vec<f64>,
}

/// The two frames whose line shows the value at the fractional frame `frame` of `count`, and the share of the second.
///
/// Beyond the last frame the line of the last two goes on. With one frame only, both are that frame.
pub fn bracket(frame: f64, count: usize) -> (usize, usize, f64) {
    if count < 2 {
        return (0, 0, 0.0);
    }
    let rounded = frame.round();
    let frame = if (frame - rounded).abs() < 1e-9 { rounded } else { frame };
    let low = crate::index::floor_index(frame).min(count - 2);
    let share = frame - low as f64;
    if share == 1.0 && low + 2 < count { (low + 1, low + 2, 0.0) } else { (low, low + 1, share) }
}

/// Value of a polyline at a fractional frame.
pub fn at(points: &[c64], frame: f64) -> c64 {
    let (low, high, share) = bracket(frame, points.len());
    if share == 0.0 { points[low] } else { points[low] * (1.0 - share) + points[high] * share }
}

/// Central tangent `p_{i+1} − p_{i−1}` at frame `i`, at the ends the doubled one-sided difference; 0 for a lone point.
#[inline]
pub fn tangent(points: &[c64], i: usize) -> c64 {
    let (before, after) = (i.saturating_sub(1), (i + 1).min(points.len() - 1));
    let difference = points[after] - points[before];
    if after - before == 1 { 2.0 * difference } else { difference }
}

/// Local similarity factors of the segments of a bent path and their unit rotations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SegmentFactors {
    /// `z_i = (p̄_{i+1} − p̄_i)/v_i`; where the rest segment has no length or the factor has collapsed, its rotation.
    pub factors: Vec<c64>,
    /// `z_i/|z_i|`, interpolated by angle between sound neighbours where it is undefined.
    pub rotations: Vec<c64>,
}

/// Unit rotation of a local similarity factor; 0 where it has collapsed.
#[inline]
pub fn rotation_of(factor: c64) -> c64 {
    let size_sq = factor.norm_sqr();
    if size_sq < COLLAPSED * COLLAPSED { c64::default() } else { factor / size_sq.sqrt() }
}

impl SegmentFactors {
    /// Fills both lists for `bent` against `rest`, reusing their storage. Source: Kim et al. 2009, eq. 7.
    pub fn update(&mut self, rest: &RestSegments, bent: &[c64]) {
        let segments = bent.windows(2).zip(&rest.inverses);
        self.factors.clear();
        self.factors.extend(segments.map(|(points, inverse)| (points[1] - points[0]) * inverse));
        self.rotations.clear();
        self.rotations.extend(self.factors.iter().map(|factor| rotation_of(*factor)));
        self.fill_gaps();
    }

    /// Replaces missing rotations (zero) by interpolation, and missing factors by rotations.
    fn fill_gaps(&mut self) {
        let Self { factors, rotations } = self;
        let count = rotations.len();
        let mut end = 0;
        while let Some(gap) = rotations[end..].iter().position(|z| *z == c64::default()) {
            let first = end + gap;
            end = (first..count).find(|i| rotations[*i] != c64::default()).unwrap_or(count);
            let one = c64::new(1.0, 0.0);
            let (mut rotation, turn) = match (first.checked_sub(1).map(|i| rotations[i]), rotations.get(end))
            {
                (Some(before), Some(after)) => {
                    (before, cis((after * before.conj()).arg() / (end - first + 1) as f64))
                }
                (Some(only), None) => (only, one),
                (None, Some(only)) => (*only, one),
                (None, None) => (one, one),
            };
            for (filled, factor) in rotations[first..end].iter_mut().zip(&mut factors[first..end]) {
                rotation *= turn;
                (*filled, *factor) = (rotation, rotation);
            }
        }
    }
}

/// Turn φ of the body at each frame by the blend of phase-1 rotations and tangents, radians, unwrapped from frame to frame.
///
/// Where somebody moves, tangents decide; where they stand, the smooth rotations of the shape phase:
/// `φ_i = arg z̃_i + w_i·wrap(arg(t̂_i/t_i) − arg z̃_i)`, `z̃_i = (z_{i−1} + z_i)/2`, w rising from 0 to 1 between .3 and .6 m/s.
/// Identity and rigid motions give exactly their own turn. Fills `turns`, reusing its storage. Cost: linear in frames.
pub fn blended_turns(rest: &[c64], edited: &[c64], factors: &SegmentFactors, turns: &mut Vec<f64>) {
    let mut previous = 0.0;
    turns.clear();
    turns.extend((0..rest.len()).map(|i| {
        let (before, after) = (tangent(rest, i), tangent(edited, i));
        let along = after * before.conj();
        let w = tangent_share(before.norm_sqr().min(after.norm_sqr()));
        // Of an angle that counts for nothing, the arctangent is saved.
        let turn = if w == 1.0 {
            along.arg()
        } else {
            let smooth = mean_rotation(factors, i);
            smooth.arg() + if w > 0.0 { w * (along * smooth.conj()).arg() } else { 0.0 }
        };
        previous = nearest_turn(turn, previous);
        previous
    }));
}

/// How much tangents count, the shorter of which has this squared length.
fn tangent_share(length_sq: f64) -> f64 {
    let (low, high) = BLEND_TANGENTS;
    match length_sq {
        l if l >= high * high => 1.0,
        l if l <= low * low => 0.0,
        l => smoothstep((l.sqrt() - low) / (high - low)),
    }
}

/// Mean factor of the two segments at frame `i`; their rotation where it collapses.
fn mean_rotation(factors: &SegmentFactors, i: usize) -> c64 {
    let segments = factors.factors.len();
    if segments == 0 {
        return c64::new(1.0, 0.0);
    }
    let (l, r) = (i.saturating_sub(1).min(segments - 1), i.min(segments - 1));
    let mean = 0.5 * (factors.factors[l] + factors.factors[r]);
    if mean.norm_sqr() < COLLAPSED * COLLAPSED { factors.rotations[r] } else { mean }
}

/// Of the angles that differ from `angle` by whole turns, the one nearest to `other`, radians.
fn nearest_turn(angle: f64, other: f64) -> f64 {
    let turns = (other - angle) / TAU;
    if turns.abs() <= 0.5 { angle } else { angle + TAU * turns.round() }
}

/// Adds whole turns so that no two neighbours are more than half a turn apart.
pub fn unwrap(angles: &mut [f64]) {
    for i in 1..angles.len() {
        angles[i] = nearest_turn(angles[i], angles[i - 1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::wrap;
    use proptest::prelude::*;

    fn stop_and_turn() -> (Vec<c64>, Vec<f64>) {
        let line = [0.0, 0.1, 0.2, 0.2, 0.2, 0.2, 0.2];
        let mut path: Vec<c64> = line.iter().map(|x| c64::new(*x, 0.0)).collect();
        path.extend([c64::new(0.2, 0.1), c64::new(0.2, 0.2)]);
        let headings = (0..9).map(|i| 1.4 * f64::from(i) / 8.0).collect();
        (path, headings)
    }

    proptest! {
        #[test]
        fn blended_turns_of_a_rigid_motion_are_its_turn(angle in -3.0..3.0_f64, x in -4.0..4.0_f64) {
            let (path, _) = stop_and_turn();
            let moved: Vec<c64> = path.iter().map(|p| cis(angle) * p + x).collect();
            let mut factors = SegmentFactors::default();
            let rest = RestPath { headings: vec![0.0; path.len()], positions: path, rigid: Vec::new() };
            factors.update(&rest.segments(), &moved);
            let mut turns = Vec::new();
            blended_turns(&rest.positions, &moved, &factors, &mut turns);
            for turn in turns {
                prop_assert!(wrap(turn - angle).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn the_bracket_goes_on_beyond_the_last_frame() {
        assert_eq!(bracket(2.0, 3), (1, 2, 1.0));
        assert_eq!(bracket(1.0, 3), (1, 2, 0.0));
        assert_eq!(bracket(2.5, 3), (1, 2, 1.5));
        assert_eq!(bracket(0.25, 3), (0, 1, 0.25));
        assert_eq!(bracket(0.0, 1), (0, 0, 0.0));
    }
}
