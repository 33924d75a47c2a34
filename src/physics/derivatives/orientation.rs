//! Smoothing of rotations along time.

use glam::{DQuat, DVec3};

use super::{Kernel, Lanes, smooth};
use crate::geometry::{exp, log};

/// Weights of the turns from frame `k + j` to `k + j + 1` in Lee and Shin's filter, j from −H to H − 1: sums of the taps beyond j,
/// negative before the middle.
pub fn turn_weights(kernel: &Kernel) -> Vec<f64> {
    // beyond[j] = Σ_{m>j} a_m; by symmetry the sum up to −j − 1 is the same.
    let half = kernel.half();
    let beyond: Vec<f64> = (0..half).map(|j| kernel.taps[j + 1..].iter().sum()).collect();
    let before = beyond.iter().rev().map(|sum: &f64| -sum);
    before.chain(beyond.iter().copied()).collect()
}

/// Rotations smoothed by `kernel`: `q_k' = q_k exp(Σ_j b_j log(q_{k+j}⁻¹ q_{k+j+1}))`. It commutes with turns of everything from
/// either side, and is a plain convolution where the axis is fixed. Beyond the ends the first and last turns repeat mirrored in
/// time, which is the point reflection of a fixed axis. Cost: frames times taps.
///
/// Source: Lee and Shin, *General Construction of Time-Domain Filters for Orientation Data*, IEEE TVCG 8(2), 2002.
pub fn lee_shin(rotations: &[DQuat], kernel: &Kernel) -> Vec<DQuat> {
    let turns: Vec<DVec3> = rotations.windows(2).map(|pair| log(pair[0].inverse() * pair[1])).collect();
    let weights = turn_weights(kernel);
    let Some(last) = turns.len().checked_sub(1) else {
        return rotations.to_vec();
    };
    let period = 2 * (last + 1);
    // Turn i lies between frames i and i + 1: turn −1 mirrors turn 0.
    let turn = |at: usize| if at <= last { turns[at] } else { turns[period - 1 - at] };
    let half = kernel.half() % period;
    let smoothed = |(k, rotation): (usize, &DQuat)| {
        let first = k + period - half;
        // A kernel longer than the clip starts whole periods earlier.
        let sum: DVec3 =
            weights.iter().enumerate().map(|(j, weight)| *weight * turn((first + j) % period)).sum();
        *rotation * exp(sum)
    };
    rotations.iter().enumerate().map(smoothed).collect()
}

/// Rotations smoothed by convolving their rotation vectors. To second order in the angles the same as [`lee_shin`], and none stays
/// none: right for displacements, which are small; wrong near half a turn.
pub fn smooth_logs(rotations: &[DQuat], kernel: &Kernel) -> Vec<DQuat> {
    let vectors: Vec<DVec3> = rotations.iter().map(|rotation| log(*rotation)).collect();
    smooth(&Lanes::of_vectors(&vectors), kernel).vectors(0).into_iter().map(exp).collect()
}
