//! Motion paths: rest path, tangents, local similarity factors, facing along a bent path.
//!
//! A path is one complex number a frame (`x − i z` of the root, metres). Source: Kim et al. 2009, §4.

use std::f64::consts::FRAC_PI_2;

use crate::clip::working::WORKING_STEP;
use crate::geometry::{c64, cis, lerp_angle, smoothstep, wrap};

/// Slower than this a tangent says nothing about direction, m/s.
pub const DEGENERATE_SPEED: f64 = 0.05;
/// Below `COINCIDENT · (1 + |p|)` metres two points are one.
pub const COINCIDENT: f64 = 1e-9;
/// Below this size a local similarity factor has collapsed and its angle is noise.
const COLLAPSED: f64 = 1e-9;
/// Tangents count for nothing below and for everything above these speeds, m/s ([`blended_turns`]).
const BLEND_SPEEDS: (f64, f64) = (0.3, 0.6);
/// Longest stretch of turned-over tangents that is taken for a flip, frames (half a second).
const LONGEST_FLIP: usize = 15;

/// Rest path of one character: its track on the ground, before the edit.
#[derive(Clone, Debug, PartialEq)]
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
        let (p, q) = (self.positions[a], self.positions[b]);
        (p - q).norm() <= COINCIDENT * (1.0 + p.norm())
    }
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
pub fn tangent(points: &[c64], i: usize) -> c64 {
    let last = points.len() - 1;
    match i {
        _ if last == 0 => c64::default(),
        0 => 2.0 * (points[1] - points[0]),
        i if i == last => 2.0 * (points[last] - points[last - 1]),
        i => points[i + 1] - points[i - 1],
    }
}

/// Central tangents of all frames; as they are, degenerate or not.
pub fn raw_tangents(points: &[c64]) -> Vec<c64> {
    (0..points.len()).map(|i| tangent(points, i)).collect()
}

/// Frames whose tangent is too short to have a direction: shorter than `2·h·v_ε`, [`DEGENERATE_SPEED`] by default.
pub fn degenerate(tangents: &[c64], shortest: f64) -> Vec<bool> {
    tangents.iter().map(|t| t.norm() < shortest).collect()
}

/// Shortest tangent that has a direction, metres.
pub const SHORTEST_TANGENT: f64 = 2.0 * WORKING_STEP * DEGENERATE_SPEED;

/// Replaces bad tangents by interpolation between their good neighbours; `fallback` is the angle where there is none.
///
/// Linear between the neighbours; where that comes out shorter than ten times `shortest`, the angle on the shorter arc.
pub fn repair_tangents(tangents: &mut [c64], bad: &[bool], shortest: f64, fallback: f64) {
    let good: Vec<usize> = (0..tangents.len()).filter(|i| !bad[*i]).collect();
    let (Some(&first), Some(&last)) = (good.first(), good.last()) else {
        tangents.fill(cis(fallback));
        return;
    };
    let (before, after) = (tangents[first], tangents[last]);
    tangents[..first].fill(before);
    tangents[last + 1..].fill(after);
    for pair in good.windows(2) {
        let (l, r) = (pair[0], pair[1]);
        let (from, to) = (tangents[l], tangents[r]);
        for (k, tangent) in tangents[l + 1..r].iter_mut().enumerate() {
            let s = (k + 1) as f64 / (r - l) as f64;
            let blend = from * (1.0 - s) + to * s;
            *tangent = if blend.norm() < 10.0 * shortest {
                c64::from_polar(from.norm(), lerp_angle(from.arg(), to.arg(), s))
            } else {
                blend
            };
        }
    }
}

/// Local similarity factors of the segments of a bent path and their unit rotations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SegmentFactors {
    /// `z_i = (p̄_{i+1} − p̄_i)/v_i`; where the rest segment has no length or the factor has collapsed, its rotation.
    pub factors: Vec<c64>,
    /// `z_i/|z_i|`, interpolated by angle between sound neighbours where it is undefined.
    pub rotations: Vec<c64>,
}

impl SegmentFactors {
    /// Fills both lists for `bent` against `rest`, reusing their storage. Source: Kim et al. 2009, eq. 7.
    pub fn update(&mut self, rest: &[c64], bent: &[c64]) {
        let segments = rest.len().saturating_sub(1);
        self.factors.clear();
        self.rotations.clear();
        for i in 0..segments {
            let step = rest[i + 1] - rest[i];
            let sound = step.norm() > COINCIDENT * (1.0 + rest[i].norm());
            let z = if sound { (bent[i + 1] - bent[i]) / step } else { c64::default() };
            self.factors.push(z);
            self.rotations.push(if z.norm() < COLLAPSED { c64::default() } else { z / z.norm() });
        }
        self.fill_gaps();
    }

    /// Replaces missing rotations (zero) by interpolation, and missing factors by rotations.
    fn fill_gaps(&mut self) {
        let mut previous: Option<usize> = None;
        let mut i = 0;
        while i < self.rotations.len() {
            if self.rotations[i] != c64::default() {
                previous = Some(i);
                i += 1;
                continue;
            }
            let end = (i..self.rotations.len()).find(|j| self.rotations[*j] != c64::default());
            let stop = end.unwrap_or(self.rotations.len());
            for j in i..stop {
                let rotation = match (previous, end) {
                    (Some(l), Some(r)) => {
                        let s = (j - l) as f64 / (r - l) as f64;
                        cis(lerp_angle(self.rotations[l].arg(), self.rotations[r].arg(), s))
                    }
                    (Some(only), None) | (None, Some(only)) => self.rotations[only],
                    (None, None) => c64::new(1.0, 0.0),
                };
                self.factors[j] = rotation;
                self.rotations[j] = rotation;
            }
            previous = Some(stop - 1);
            i = stop;
        }
    }
}

/// Turn φ of the body at each frame by the blend of phase-1 rotations and tangents, radians, unwrapped from frame to frame.
///
/// Where somebody moves, tangents decide; where they stand, the smooth rotations of the shape phase:
/// `φ_i = arg z̃_i + w_i·wrap(arg(t̂_i/t_i) − arg z̃_i)`, `z̃_i = (z_{i−1} + z_i)/2`, w rising from 0 to 1 between .3 and .6 m/s.
/// Identity and rigid motions give exactly their own turn. Fills `turns`, reusing its storage. Cost: linear in frames.
pub fn blended_turns(rest: &[c64], edited: &[c64], factors: &SegmentFactors, turns: &mut Vec<f64>) {
    turns.clear();
    let mut previous = 0.0;
    for i in 0..rest.len() {
        let (before, after) = (tangent(rest, i), tangent(edited, i));
        let smooth = mean_rotation(factors, i).arg();
        let speed = before.norm().min(after.norm()) / (2.0 * WORKING_STEP);
        let w = smoothstep((speed - BLEND_SPEEDS.0) / (BLEND_SPEEDS.1 - BLEND_SPEEDS.0));
        let along = if w > 0.0 { wrap((after / before).arg() - smooth) } else { 0.0 };
        let turn = smooth + w * along;
        previous = if i == 0 { wrap(turn) } else { previous + wrap(turn - previous) };
        turns.push(previous);
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
    if mean.norm() < COLLAPSED { factors.rotations[r] } else { mean }
}

/// A stretch of frames whose tangents were turned over by the edit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flip {
    /// First frame whose direction was replaced (or jumps, where nothing could be done).
    pub first: usize,
    /// Last such frame.
    pub last: usize,
    /// Whether the directions were replaced by interpolation.
    pub repaired: bool,
}

/// Turn φ of the body at each frame by tangents alone, flips repaired: the published method.
#[derive(Clone, Debug, PartialEq)]
pub struct TangentTurns {
    /// Radians, unwrapped from frame to frame.
    pub turns: Vec<f64>,
    /// What was found turned over.
    pub flips: Vec<Flip>,
}

/// Turns by tangents: heading = rest heading + the turn of the tangent, degenerate ones interpolated.
///
/// `fallback`: heading of the first frame, used where a path has no tangent at all. `threshold`: a change of φ larger than
/// this between frames is a flip, radians (`π/2`). `shortest`: see [`SHORTEST_TANGENT`]. `pinned`: frames whose direction
/// is held; no repair crosses them. Source: Kim et al. 2009, §4.1, extended from the singular point to the whole run.
pub fn tangent_turns(
    rest: &[c64],
    edited: &[c64],
    shortest: f64,
    fallback: f64,
    pinned: &[usize],
) -> TangentTurns {
    let mut before = raw_tangents(rest);
    let bad_rest = degenerate(&before, shortest);
    repair_tangents(&mut before, &bad_rest, shortest, fallback);
    let raw_after = raw_tangents(edited);
    let mut bad: Vec<bool> =
        bad_rest.iter().zip(degenerate(&raw_after, shortest)).map(|(rest, edited)| *rest || edited).collect();
    let turns_with = |bad: &[bool]| {
        let mut after = raw_after.clone();
        repair_tangents(&mut after, bad, shortest, fallback);
        after.iter().zip(&before).map(|(a, b)| (a / b).arg()).collect::<Vec<f64>>()
    };
    let mut turns = turns_with(&bad);
    let mut flips = find_flips(&turns);
    for flip in &mut flips {
        flip.repaired = !pinned.iter().any(|p| (flip.first..=flip.last).contains(p));
        if flip.repaired {
            bad[flip.first..=flip.last].fill(true);
        }
    }
    if flips.iter().any(|flip| flip.repaired) {
        turns = turns_with(&bad);
        let left: Vec<Flip> =
            find_flips(&turns).into_iter().map(|flip| Flip { repaired: false, ..flip }).collect();
        flips.retain(|flip| flip.repaired);
        flips.extend(left);
    }
    unwrap(&mut turns);
    TangentTurns { turns, flips }
}

/// Adds whole turns so that no two neighbours are more than half a turn apart.
pub fn unwrap(angles: &mut [f64]) {
    for i in 1..angles.len() {
        angles[i] = angles[i - 1] + wrap(angles[i] - angles[i - 1]);
    }
}

/// Runs between two jumps that agree before and after, and lone jumps.
fn find_flips(turns: &[f64]) -> Vec<Flip> {
    let jumps: Vec<usize> = (1..turns.len())
        .filter(|i| wrap(turns[*i] - turns[*i - 1]).abs() > FRAC_PI_2)
        .map(|i| i - 1)
        .collect();
    let mut flips = Vec::new();
    let mut k = 0;
    while k < jumps.len() {
        let start = jumps[k];
        let closing = jumps[k + 1..].iter().position(|end| {
            end - start <= LONGEST_FLIP && wrap(turns[end + 1] - turns[start]).abs() <= FRAC_PI_2
        });
        match closing {
            Some(offset) => {
                flips.push(Flip { first: start + 1, last: jumps[k + 1 + offset], repaired: false });
                k += offset + 2;
            }
            None => {
                flips.push(Flip { first: start, last: start + 1, repaired: false });
                k += 1;
            }
        }
    }
    flips
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The reference numbers are printed to six digits.
    const PRINTED: f64 = 1e-6;

    fn stop_and_turn() -> (Vec<c64>, Vec<f64>) {
        let line = [0.0, 0.1, 0.2, 0.2, 0.2, 0.2, 0.2];
        let mut path: Vec<c64> = line.iter().map(|x| c64::new(*x, 0.0)).collect();
        path.extend([c64::new(0.2, 0.1), c64::new(0.2, 0.2)]);
        let headings = (0..9).map(|i| 1.4 * f64::from(i) / 8.0).collect();
        (path, headings)
    }

    #[test]
    fn degenerate_tangents_are_interpolated_as_in_the_reference() {
        let (path, headings) = stop_and_turn();
        let mut tangents = raw_tangents(&path);
        let bad = degenerate(&tangents, 1e-3);
        assert_eq!((0..9).filter(|i| bad[*i]).collect::<Vec<_>>(), vec![3, 4, 5]);
        repair_tangents(&mut tangents, &bad, 1e-3, headings[0]);
        let expected = [(0.1, 0.0), (0.075, 0.025), (0.05, 0.05), (0.025, 0.075), (0.0, 0.1)];
        for (t, (x, y)) in tangents[2..=6].iter().zip(expected) {
            assert!((t - c64::new(x, y)).norm() < 1e-15);
        }
        let theta = [0.0, 0.175, 0.35, 0.203249, -0.085398, -0.374046, -0.520796, -0.345796, -0.170796];
        for i in 0..9 {
            assert!((wrap(headings[i] - tangents[i].arg()) - theta[i]).abs() < PRINTED, "frame {i}");
        }
    }

    #[test]
    fn a_rigid_motion_turns_every_heading_by_itself() {
        let (path, _) = stop_and_turn();
        let moved: Vec<c64> = path.iter().map(|p| cis(0.5) * p + 1.0).collect();
        let turns = tangent_turns(&path, &moved, 1e-3, 0.0, &[]);
        assert!(turns.flips.is_empty());
        for turn in turns.turns {
            assert!((turn - 0.5).abs() < 1e-15);
        }
    }

    proptest! {
        #[test]
        fn blended_turns_of_a_rigid_motion_are_its_turn(angle in -3.0..3.0_f64, x in -4.0..4.0_f64) {
            let (path, _) = stop_and_turn();
            let moved: Vec<c64> = path.iter().map(|p| cis(angle) * p + x).collect();
            let mut factors = SegmentFactors::default();
            factors.update(&path, &moved);
            let mut turns = Vec::new();
            blended_turns(&path, &moved, &factors, &mut turns);
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
