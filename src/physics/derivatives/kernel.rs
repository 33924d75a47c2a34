//! Smoothing by a Gaussian.

use super::Lanes;
use crate::index::floor_index;

/// A symmetric kernel of an odd number of taps whose sum is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Kernel {
    /// Taps at distance 0, 1 … from the middle; those before it are the same.
    pub taps: Vec<f64>,
}

/// Rate for which widths are stated, frames per second.
const STATED_RATE: f64 = 30.0;

impl Kernel {
    /// Gaussian of `width` frames at 30 fps, used at `fps`: `width·fps/30` frames, rounded.
    ///
    /// Of `W` frames the half-width is `H = ⌊W/2⌋`, with `2H + 1` taps `∝ exp(−j²/(2σ²))`, `σ = H/2`. Widths below two frames smooth
    /// nothing.
    pub fn gaussian(width: f64, fps: f64) -> Self {
        Self::of_frames(floor_index((width * fps / STATED_RATE).round()))
    }

    /// The same of `width` frames, whatever the rate.
    pub fn of_frames(width: usize) -> Self {
        let half = width / 2;
        if half == 0 {
            return Self { taps: vec![1.0] };
        }
        let sigma = 0.5 * half as f64;
        let mut taps: Vec<f64> = (0..=half).map(|j| (-0.5 * (j as f64 / sigma).powi(2)).exp()).collect();
        let sum = 2.0 * taps.iter().sum::<f64>() - taps[0];
        taps.iter_mut().for_each(|tap| *tap /= sum);
        Self { taps }
    }

    /// Frames it reaches to either side.
    pub fn half(&self) -> usize {
        self.taps.len() - 1
    }
}

/// `lanes` convolved with `kernel`, ends extended by point reflection. Cost: frames times lanes times taps, vectorised along time:
/// 161 taps on six lanes take 0.3 µs a frame.
pub fn smooth(lanes: &Lanes, kernel: &Kernel) -> Lanes {
    let count = lanes.frame_count;
    let mut result = Lanes::zeros(lanes.lane_count(), count);
    let mut extended = Vec::new();
    for index in 0..lanes.lane_count() {
        extend(lanes.lane(index), kernel.half(), &mut extended);
        convolve(&extended, kernel, result.lane_mut(index));
    }
    result
}

/// `lanes` convolved with `kernel`, with zeros before the first and after the last frame: for displacements, of which there are none
/// there. Lanes of zeros stay so. Cost: as of [`smooth`].
pub fn smooth_from_rest(lanes: &Lanes, kernel: &Kernel) -> Lanes {
    let (count, half) = (lanes.frame_count, kernel.half());
    let mut result = Lanes::zeros(lanes.lane_count(), count);
    let mut extended = vec![0.0; count + 2 * half];
    for index in 0..lanes.lane_count() {
        let lane = lanes.lane(index);
        if lane.iter().any(|value| *value != 0.0) {
            extended[half..half + count].copy_from_slice(lane);
            convolve(&extended, kernel, result.lane_mut(index));
        }
    }
    result
}

/// `lane` with `more` frames before and after it, into `extended`: `x_{−j} = 2 x_0 − x_j`, likewise at the end, over and over
/// where the lane is shorter than that.
pub(super) fn extend(lane: &[f64], more: usize, extended: &mut Vec<f64>) {
    extended.clear();
    let Some(last) = lane.len().checked_sub(1) else { return };
    let (first_value, last_value) = (lane[0], lane[last]);
    // Two reflections are a shift by twice the length and twice the rise.
    let beyond = |j: usize, end: f64, towards: f64, at: &dyn Fn(usize) -> f64| {
        if last == 0 {
            return end;
        }
        let (turns, rest) = (j / (2 * last), j % (2 * last));
        let shift = turns as f64 * 2.0 * (end - towards);
        if rest <= last {
            2.0 * end - at(rest) + shift
        } else {
            at(2 * last - rest) + 2.0 * (end - towards) + shift
        }
    };
    extended.extend((1..=more).rev().map(|j| beyond(j, first_value, last_value, &|k| lane[k])));
    extended.extend_from_slice(lane);
    extended.extend((1..=more).map(|j| beyond(j, last_value, first_value, &|k| lane[last - k])));
}

/// Frames that are summed together: they stay in the first cache.
const BLOCK: usize = 512;

fn convolve(extended: &[f64], kernel: &Kernel, result: &mut [f64]) {
    let half = kernel.half();
    for (block, sums) in result.chunks_mut(BLOCK).enumerate() {
        let (start, count) = (block * BLOCK + half, sums.len());
        for (sum, x) in sums.iter_mut().zip(&extended[start..start + count]) {
            *sum = kernel.taps[0] * x;
        }
        for (j, tap) in kernel.taps.iter().enumerate().skip(1) {
            let before = &extended[start - j..start - j + count];
            let after = &extended[start + j..start + j + count];
            for ((sum, a), b) in sums.iter_mut().zip(before).zip(after) {
                *sum += tap * (a + b);
            }
        }
    }
}
