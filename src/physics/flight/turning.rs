//! Turns of a body, frame after frame, that give it the angular momentum it should have.
//!
//! Turns accumulate: every frame starts from the turn of the one before. A frame turned against the unturned one before it would
//! get the right momentum, and its successor what it lost.

use glam::{DMat3, DQuat, DVec3};

use crate::geometry::{exp, log};
use crate::physics::flight::momentum::{Pair, trace};

/// Momentum that a body should have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// Wanted, kg m²/s.
    pub target: DVec3,
    /// Share of the way there, 0 to 1.
    pub share: f64,
}

/// Newton steps of one frame at most; two or three are needed.
pub const FRAME_STEPS: usize = 12;
/// A frame is right with a momentum so near to what it should be, kg m²/s.
const FRAME_MISS: f64 = 1e-12;

/// Turns of the frames of `pairs` (the first frame's is none) by which every pair has the momentum aimed at. `steps`: Newton steps of
/// one frame at most. Cost: linear in pairs times links.
///
/// ```text
///     D_0 = 1,   D_k = Exp(K⁻¹ (h_aim,k − h) dt) D  from D = D_{k−1} on, over and over
/// ```
pub fn accumulated(pairs: &[Pair], aim: Aim, steps: usize) -> Vec<DQuat> {
    let mut turn = DQuat::IDENTITY;
    let mut turns = Vec::with_capacity(pairs.len() + 1);
    turns.push(turn);
    for pair in pairs {
        let wanted = if aim.share == 1.0 {
            aim.target
        } else {
            pair.momentum([DQuat::IDENTITY; 2]).value.lerp(aim.target, aim.share)
        };
        turn = turned_to(pair, turn, wanted, steps);
        turns.push(turn);
    }
    turns
}

/// The turn of the later frame of `pair` that gives it the momentum `wanted` while the earlier is turned by `before`.
fn turned_to(pair: &Pair, before: DQuat, wanted: DVec3, steps: usize) -> DQuat {
    let mut turn = before;
    for _ in 0..steps {
        let momentum = pair.momentum([before, turn]);
        let miss = wanted - momentum.value;
        if miss.length() <= FRAME_MISS {
            break;
        }
        turn = (exp(solved(&momentum.resistance, miss * pair.step)) * turn).normalize();
    }
    turn
}

/// A matrix whose determinant is a smaller share than this of what even resistance would have is singular.
const SINGULAR: f64 = 1e-4;
/// What is then added to its diagonal, share of the mean resistance.
///
/// Source: Tikhonov's regularisation.
const STIFFENING: f64 = 1e-3;

/// `matrix⁻¹ vector`; of a singular matrix (one thin link turns) nearly.
fn solved(matrix: &DMat3, vector: DVec3) -> DVec3 {
    let mean = trace(matrix) / 3.0;
    if !(mean.abs() > 0.0) {
        return DVec3::ZERO;
    }
    let is_singular = matrix.determinant().abs() < SINGULAR * mean.abs().powi(3);
    let added = if is_singular { STIFFENING * mean } else { 0.0 };
    (*matrix + DMat3::from_diagonal(DVec3::splat(added))).inverse() * vector
}

/// Mean momentum of `pairs` as they are, kg m²/s; 0 without any.
pub fn mean_momentum(pairs: &[Pair]) -> DVec3 {
    let sum: DVec3 = pairs.iter().map(|pair| pair.momentum([DQuat::IDENTITY; 2]).value).sum();
    sum / pairs.len().max(1) as f64
}

/// Momentum with which the last frame is turned by nothing, to first order: `(Σ K⁻¹)⁻¹ Σ K⁻¹ h`, kg m²/s.
pub fn end_preserving_momentum(pairs: &[Pair]) -> DVec3 {
    let (mut compliance, mut turned) = (DMat3::ZERO, DVec3::ZERO);
    for pair in pairs {
        let momentum = pair.momentum([DQuat::IDENTITY; 2]);
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| solved(&momentum.resistance, axis));
        compliance += DMat3::from_cols(x, y, z);
        turned += solved(&momentum.resistance, momentum.value);
    }
    solved(&compliance, turned)
}

/// Turns with one momentum, and how they were found.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// One a frame, of a pair more than there are pairs.
    pub turns: Vec<DQuat>,
    /// Momentum aimed at, kg m²/s.
    pub target: DVec3,
    /// Newton steps on it.
    pub newton_steps: usize,
}

impl Settled {
    /// Of the last frame: `Log D`, radians.
    pub fn last_turn(&self) -> DVec3 {
        self.turns.last().map_or(DVec3::ZERO, |turn| log(*turn))
    }

    /// Takes off the last turn little by little, so that the last frame is exactly not turned.
    pub fn ramp_off(&mut self) {
        let (rest, count) = (self.last_turn(), self.turns.len().saturating_sub(1).max(1));
        for (index, turn) in self.turns.iter_mut().enumerate() {
            *turn = (exp(rest * (-(index as f64) / count as f64)) * *turn).normalize();
        }
        if let Some(last) = self.turns.last_mut() {
            *last = DQuat::IDENTITY;
        }
    }
}

/// The last frame is turned by nothing below this, radians: spread over a flight it is 1e-7 of the momentum of a slow jump.
pub const NO_TURN: f64 = 1e-8;
/// Newton steps on the momentum at most; two are needed, three where a body turns right over.
const NEWTON_STEPS: usize = 10;
/// Halvings of one Newton step.
const HALVINGS: i32 = 5;
/// Differences by which the Jacobian is taken, share of the momentum and of 1 kg m²/s.
const DIFFERENCE: f64 = 1e-4;

/// Turns after which the last frame is turned by nothing (nearly: see [`Settled::last_turn`]): Newton's method on the momentum aimed
/// at, three unknowns for the three of `Log D` of the last frame, from [`end_preserving_momentum`]. Cost: linear, some ten times that of
/// [`accumulated`].
///
/// Approximate Jacobians (the sum of `K⁻¹`) stall; differences of the whole recursion do not.
pub fn settled(pairs: &[Pair], share: f64) -> Settled {
    let at = |target: DVec3, newton_steps: usize| Settled {
        turns: accumulated(pairs, Aim { target, share }, FRAME_STEPS),
        target,
        newton_steps,
    };
    let mut best = at(end_preserving_momentum(pairs), 0);
    for step in 1..=NEWTON_STEPS {
        let miss = best.last_turn();
        if miss.length() < NO_TURN {
            break;
        }
        let difference = DIFFERENCE * (1.0 + best.target.length());
        let columns = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
            let moved = at(best.target + difference * axis, step);
            (moved.last_turn() - miss) / difference
        });
        let change = solved(&DMat3::from_cols(columns[0], columns[1], columns[2]), -miss);
        let tried = (0..HALVINGS).map(|halvings| at(best.target + change * 0.5_f64.powi(halvings), step));
        let nearer = |next: &Settled| next.last_turn().length() < miss.length();
        match tried.into_iter().find(nearer) {
            Some(next) => best = next,
            None => break,
        }
    }
    best
}
