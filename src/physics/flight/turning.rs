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
    recursion(pairs, aim, steps).0
}

/// Turns, and the farthest that the momentum of a pair still is from what it should be, kg m²/s.
fn recursion(pairs: &[Pair], aim: Aim, steps: usize) -> (Vec<DQuat>, f64) {
    let mut turns = Vec::with_capacity(pairs.len() + 1);
    turns.push(DQuat::IDENTITY);
    let mut farthest = 0.0_f64;
    for (pair, frame) in pairs.iter().zip(0..) {
        let wanted = if aim.share == 1.0 {
            aim.target
        } else {
            pair.momentum([DQuat::IDENTITY; 2]).value.lerp(aim.target, aim.share)
        };
        let (turn, miss) = turned_to(pair, turns[frame], wanted, steps);
        turns.push(turn);
        farthest = farthest.max(miss);
    }
    (turns, farthest)
}

/// The turn of the later frame of `pair` that gives it the momentum `wanted` while the earlier is turned by `before`, and what was missing
/// before its last step.
fn turned_to(pair: &Pair, before: DQuat, wanted: DVec3, steps: usize) -> (DQuat, f64) {
    let mut turn = before;
    let mut missing = 0.0;
    for _ in 0..steps {
        let momentum = pair.momentum([before, turn]);
        let miss = wanted - momentum.value;
        missing = miss.length();
        if missing <= FRAME_MISS {
            break;
        }
        turn = (exp(solved(&momentum.resistance, miss * pair.step)) * turn).normalize();
    }
    (turn, missing)
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
    if mean == 0.0 {
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
    /// Momentum aimed at, and the share of the way to it that is gone, which is less than asked for where there is no more.
    pub aim: Aim,
    /// Newton steps on it.
    pub newton_steps: usize,
    /// Farthest that the momentum of a pair is from what it should be, kg m²/s.
    pub miss: f64,
}

/// Turns by which pairs have the momentum aimed at, wherever that turns the last frame. Cost: linear in pairs times links.
pub fn aimed(pairs: &[Pair], aim: Aim) -> Settled {
    let (turns, miss) = recursion(pairs, aim, FRAME_STEPS);
    Settled { turns, aim, newton_steps: 0, miss }
}

impl Settled {
    /// Whether every pair has the momentum that it should.
    pub fn is_exact(&self) -> bool {
        self.miss <= EXACT * (1.0 + self.aim.target.length())
    }

    /// Whether besides the last frame is turned by nothing.
    pub fn keeps_end(&self) -> bool {
        self.is_exact() && self.last_turn().length() < NO_TURN
    }

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
/// Of the momentum and of 1 kg m²/s: what pairs may miss.
const EXACT: f64 = 1e-8;
/// Newton steps on the momentum at most; two are needed, three where a body turns right over.
const NEWTON_STEPS: usize = 10;
/// Halvings of one Newton step.
const HALVINGS: i32 = 5;
/// Differences by which the Jacobian is taken, share of the momentum and of 1 kg m²/s.
const DIFFERENCE: f64 = 1e-4;
/// Stages in which a momentum is approached that cannot be reached at once.
const STAGES: u32 = 8;

/// Turns after which the last frame is turned by nothing (nearly: see [`Settled::keeps_end`]): Newton's method on the momentum aimed
/// at, three unknowns for the three of `Log D` of the last frame, from [`end_preserving_momentum`]. Cost: linear, some ten times that of
/// [`accumulated`].
///
/// Bodies that must turn far are brought there stage by stage, and no farther than it works: a share of 0 turns nothing.
pub fn settled(pairs: &[Pair], share: f64) -> Settled {
    let start = end_preserving_momentum(pairs);
    let direct = newton(pairs, aimed(pairs, Aim { target: start, share }));
    if direct.keeps_end() {
        return direct;
    }
    let mut best = aimed(pairs, Aim { target: start, share: 0.0 });
    for stage in 1..=STAGES {
        let share = share * f64::from(stage) / f64::from(STAGES);
        let mut next = newton(pairs, aimed(pairs, Aim { target: best.aim.target, share }));
        if !next.keeps_end() {
            break;
        }
        next.newton_steps += best.newton_steps;
        best = next;
    }
    best
}

/// Newton's method on the momentum from `best` on, as long as it brings the last frame nearer to where it was.
///
/// Approximate Jacobians (the sum of `K⁻¹`) stall; differences of the whole recursion do not. They go along axes of the body: whoever is
/// turned as a whole flies as before.
fn newton(pairs: &[Pair], mut best: Settled) -> Settled {
    let share = best.aim.share;
    let at = |target: DVec3| aimed(pairs, Aim { target, share });
    for step in 1..=NEWTON_STEPS {
        let miss = best.last_turn();
        if miss.length() < NO_TURN {
            break;
        }
        let target = best.aim.target;
        let difference = DIFFERENCE * (1.0 + target.length());
        let axes = pairs.first().map_or(DMat3::IDENTITY, Pair::axes);
        let slope = |axis: DVec3| (at(target + difference * axis).last_turn() - miss) / difference;
        let jacobian = DMat3::from_cols(slope(axes.x_axis), slope(axes.y_axis), slope(axes.z_axis));
        // Without an inverse this is no number, and no candidate nearer.
        let change = axes * (jacobian.inverse() * -miss);
        let mut tried = (0..HALVINGS).map(|halvings| at(target + change * 0.5_f64.powi(halvings)));
        let is_nearer = |next: &Settled| next.is_exact() && next.last_turn().length() < miss.length();
        match tried.find(is_nearer) {
            Some(next) => best = Settled { newton_steps: step, ..next },
            None => break,
        }
    }
    best
}
