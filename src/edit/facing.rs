//! Where bodies look after the edit: turns along the path, and what held facings still need.

use crate::clip::working::WORKING_STEP;
use crate::constraint::Strength;
use crate::edit::energy::length;
use crate::edit::hold::{HeldRow, Prepared, Rotations};
use crate::edit::settings::FacingMode;
use crate::geometry::{c64, smoothstep, wrap};
use crate::index::floor_index;
use crate::path::{self, Flip, RestPath, SHORTEST_TANGENT, SegmentFactors, TangentTurning, bracket};

/// Held facings nearer than this are joined by interpolation, seconds.
const JOINED: f64 = 1.0;
/// A lone correction fades over this long, seconds.
const FADE: f64 = 0.5;

/// Turn of a body against rest along its track, radians.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Turns {
    /// Turn at each working frame, unwrapped from frame to frame.
    pub along_path: Vec<f64>,
    /// What is added at held frames so that held facings are exact: frame, radians; rising.
    pub corrections: Vec<(f64, f64)>,
    /// Stretches whose tangents were turned over.
    pub flips: Vec<Flip>,
}

impl Turns {
    /// Makes the turn at each frame of `held` what it must be, radians up to whole turns; of two at one frame, the first.
    pub fn correct(&mut self, held: &[(f64, f64)]) {
        for (frame, turn) in held.iter().copied() {
            if let Err(place) = self.corrections.binary_search_by(|(f, _)| f.total_cmp(&frame)) {
                let correction = wrap(turn - self.uncorrected(frame));
                self.corrections.insert(place, (frame, correction));
            }
        }
    }

    fn uncorrected(&self, frame: f64) -> f64 {
        let (low, high, share) = bracket(frame, self.along_path.len());
        self.along_path[low] * (1.0 - share) + self.along_path[high] * share
    }

    /// Turn at a fractional frame.
    pub fn at(&self, frame: f64) -> f64 {
        self.uncorrected(frame) + self.correction(frame)
    }

    /// Corrections at a fractional frame: joined by smoothstep where they are near, else faded out.
    fn correction(&self, frame: f64) -> f64 {
        let after = self.corrections.partition_point(|(f, _)| *f <= frame);
        let left = after.checked_sub(1).map(|index| self.corrections[index]);
        let right = self.corrections.get(after).copied();
        let faded = |(f, e): (f64, f64)| e * (1.0 - smoothstep((frame - f).abs() * WORKING_STEP / FADE));
        match (left, right) {
            (Some(l), Some(r)) if (r.0 - l.0) * WORKING_STEP < JOINED => {
                l.1 + (r.1 - l.1) * smoothstep((frame - l.0) / (r.0 - l.0))
            }
            _ => left.map_or(0.0, faded) + right.map_or(0.0, faded),
        }
    }
}

/// The body on one path after the edit, with the storage of its solves.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// Where it looks.
    pub turns: Turns,
    /// Length of its path, metres.
    pub length: f64,
    /// Frames whose direction is held; no repair of turned-over tangents crosses them.
    pinned: Vec<usize>,
    /// Frames whose facing the shape phase decides, with the turn it gives; hard rows first.
    held_turns: Vec<(f64, f64)>,
    /// In the published mode.
    tangents: Option<TangentTurning>,
}

impl Body {
    /// The body as at rest.
    pub fn new(rest: &RestPath, mode: FacingMode) -> Self {
        let turning = || TangentTurning::new(&rest.positions, SHORTEST_TANGENT, rest.headings[0]);
        Self {
            turns: Turns { along_path: vec![0.0; rest.len()], ..Turns::default() },
            length: length(&rest.positions),
            pinned: Vec::new(),
            held_turns: Vec::new(),
            tangents: (mode == FacingMode::Tangent).then(turning),
        }
    }

    /// Follows the path `edited`; [`hold_facings`] comes first. Cost: linear in frames.
    pub fn follow(&mut self, rest: &RestPath, edited: &[c64], factors: &SegmentFactors) {
        self.length = length(edited);
        let Turns { along_path, corrections, flips } = &mut self.turns;
        corrections.clear();
        flips.clear();
        match &mut self.tangents {
            Some(tangents) => tangents.update(edited, &self.pinned, along_path, flips),
            None => {
                path::blended_turns(&rest.positions, edited, factors, along_path);
                self.turns.correct(&self.held_turns);
            }
        }
    }
}

/// Tells the bodies of all paths of a component what held rows say of their facing. `rotations`: of the places of each row.
/// Cost: linear in rows.
pub fn hold_facings(held: &[Prepared], rotations: &[Rotations], bodies: &mut [Body]) {
    for body in bodies.iter_mut() {
        body.pinned.clear();
        body.held_turns.clear();
    }
    for pass in [true, false] {
        for (prepared, rotations) in held.iter().zip(rotations) {
            let HeldRow { hold, strength, .. } = prepared.row;
            if (strength == Strength::Hard) != pass {
                continue;
            }
            let at = hold.at();
            if hold.is_direction() {
                bodies[at.path].pinned.push(floor_index(at.frame));
            }
            if hold.is_direction() || at.detail != c64::default() {
                bodies[at.path].held_turns.push((at.frame, rotations.at.arg()));
            }
            if let Some(to) = hold.to() {
                bodies[to.path].held_turns.push((to.frame, rotations.to.arg()));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corrections_hold_at_their_frames_and_fade_out() {
        let mut turns = Turns { along_path: vec![0.1; 200], ..Turns::default() };
        turns.correct(&[(50.5, 0.3), (60.0, 0.2), (150.0, 0.1)]);
        assert!((turns.at(50.5) - 0.3).abs() < 1e-15);
        assert!((turns.at(60.0) - 0.2).abs() < 1e-15);
        assert!(turns.at(55.0) > 0.2 && turns.at(55.0) < 0.3);
        assert_eq!(turns.at(20.0), 0.1);
        assert_eq!(turns.at(100.0), 0.1);
    }
}
