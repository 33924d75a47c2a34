//! Turns of a body by the tangents of its path alone: the published method.

use std::f64::consts::FRAC_PI_2;

use crate::clip::working::WORKING_STEP;
use crate::geometry::{c64, cis, lerp_angle};
use crate::path::{DEGENERATE_SPEED, nearest_turn, tangent, unwrap};

/// Longest stretch of turned-over tangents that is taken for a flip, frames (half a second).
const LONGEST_FLIP: usize = 15;

/// Shortest tangent that has a direction, metres.
pub const SHORTEST_TANGENT: f64 = 2.0 * WORKING_STEP * DEGENERATE_SPEED;

/// Central tangents of all frames; as they are, degenerate or not.
pub fn raw_tangents(points: &[c64]) -> Vec<c64> {
    (0..points.len()).map(|i| tangent(points, i)).collect()
}

/// Frames whose tangent is too short to have a direction: shorter than `shortest` metres ([`SHORTEST_TANGENT`]).
pub fn degenerate(tangents: &[c64], shortest: f64) -> Vec<bool> {
    tangents.iter().map(|t| is_degenerate(*t, shortest)).collect()
}

fn is_degenerate(tangent: c64, shortest: f64) -> bool {
    tangent.norm_sqr() < shortest * shortest
}

/// Replaces bad tangents by interpolation between their good neighbours; `fallback` is the angle where there is none.
///
/// Linear between the neighbours; where that comes out shorter than ten times `shortest`, the angle on the shorter arc.
/// Allocates nothing.
pub fn repair_tangents(tangents: &mut [c64], bad: &[bool], shortest: f64, fallback: f64) {
    let mut last_good = None;
    for r in (0..tangents.len()).filter(|i| !bad[*i]) {
        match last_good {
            None => {
                let first = tangents[r];
                tangents[..r].fill(first);
            }
            Some(l) => interpolate(&mut tangents[l..=r], shortest),
        }
        last_good = Some(r);
    }
    match last_good {
        None => tangents.fill(cis(fallback)),
        Some(l) => {
            let last = tangents[l];
            tangents[l + 1..].fill(last);
        }
    }
}

/// Replaces all tangents but the first and last.
fn interpolate(tangents: &mut [c64], shortest: f64) {
    let segments = tangents.len() - 1;
    let (from, to) = (tangents[0], tangents[segments]);
    for (k, tangent) in tangents[1..segments].iter_mut().enumerate() {
        let s = (k + 1) as f64 / segments as f64;
        let blend = from * (1.0 - s) + to * s;
        *tangent = if is_degenerate(blend, 10.0 * shortest) {
            c64::from_polar(from.norm(), lerp_angle(from.arg(), to.arg(), s))
        } else {
            blend
        };
    }
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
#[derive(Clone, Debug, Default, PartialEq)]
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
/// is held; no repair crosses them. For one edit; [`TangentTurning`] is for many of one path. Source: Kim et al. 2009, §4.1,
/// extended from the singular point to the whole run.
pub fn tangent_turns(
    rest: &[c64],
    edited: &[c64],
    shortest: f64,
    fallback: f64,
    pinned: &[usize],
) -> TangentTurns {
    let mut found = TangentTurns::default();
    TangentTurning::new(rest, shortest, fallback).update(edited, pinned, &mut found.turns, &mut found.flips);
    found
}

/// [`tangent_turns`] of one rest path for many edits: its tangents, and storage.
#[derive(Clone, Debug, PartialEq)]
pub struct TangentTurning {
    shortest: f64,
    fallback: f64,
    /// Tangents at rest, repaired, and which of them had to be.
    before: Vec<c64>,
    degenerate: Vec<bool>,
    /// Tangents after the edit, repaired, and which of them had to be.
    after: Vec<c64>,
    bad: Vec<bool>,
}

impl TangentTurning {
    /// Tangents of `rest`; the other arguments are those of [`tangent_turns`]. Cost: linear in frames.
    pub fn new(rest: &[c64], shortest: f64, fallback: f64) -> Self {
        let mut before = raw_tangents(rest);
        let degenerate = degenerate(&before, shortest);
        repair_tangents(&mut before, &degenerate, shortest, fallback);
        Self { shortest, fallback, after: before.clone(), bad: degenerate.clone(), before, degenerate }
    }

    /// Fills in the turns of `edited` and what was found turned over, reusing their storage. Cost: linear in frames.
    pub fn update(&mut self, edited: &[c64], pinned: &[usize], turns: &mut Vec<f64>, flips: &mut Vec<Flip>) {
        for (i, (bad, degenerate)) in self.bad.iter_mut().zip(&self.degenerate).enumerate() {
            *bad = *degenerate || is_degenerate(tangent(edited, i), self.shortest);
        }
        self.fill_turns(edited, turns);
        flips.clear();
        find_flips(turns, flips);
        for flip in flips.iter_mut() {
            flip.repaired = !pinned.iter().any(|p| (flip.first..=flip.last).contains(p));
            if flip.repaired {
                self.bad[flip.first..=flip.last].fill(true);
            }
        }
        if flips.iter().any(|flip| flip.repaired) {
            self.fill_turns(edited, turns);
            flips.retain(|flip| flip.repaired);
            find_flips(turns, flips);
        }
        unwrap(turns);
    }

    /// Turns of the tangents, bad ones interpolated.
    fn fill_turns(&mut self, edited: &[c64], turns: &mut Vec<f64>) {
        self.after.iter_mut().enumerate().for_each(|(i, after)| *after = tangent(edited, i));
        repair_tangents(&mut self.after, &self.bad, self.shortest, self.fallback);
        turns.clear();
        turns
            .extend(self.after.iter().zip(&self.before).map(|(after, before)| (after * before.conj()).arg()));
    }
}

/// Appends runs between two jumps that agree before and after, and lone jumps; none of them repaired.
fn find_flips(turns: &[f64], flips: &mut Vec<Flip>) {
    let apart = |a: usize, b: usize| (nearest_turn(turns[b], turns[a]) - turns[a]).abs() > FRAC_PI_2;
    let segments = turns.len().saturating_sub(1);
    let mut start = 0;
    while start < segments {
        if !apart(start, start + 1) {
            start += 1;
            continue;
        }
        let reach = (start + LONGEST_FLIP + 1).min(segments);
        let closing = (start + 1..reach).find(|end| apart(*end, end + 1) && !apart(start, end + 1));
        let (first, last) = closing.map_or((start, start + 1), |end| (start + 1, end));
        flips.push(Flip { first, last, repaired: false });
        start = last + usize::from(closing.is_some());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::wrap;

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
}
