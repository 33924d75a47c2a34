//! The rate that a rounded frame time stands for.

use super::parse::RawBvh;

/// Rates in use, frames per second, that a rounded frame time may stand for.
const RATES: [f64; 16] =
    [24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 72.0, 75.0, 90.0, 100.0, 120.0, 144.0, 150.0, 200.0, 240.0, 250.0];

/// Frames per second of a frame time that may be written in few digits.
///
/// A rate in use whose frame time rounds (or was cut) to the digits written is meant: `.0083333` is 120, `.033333` is 30.
/// Else a whole rate that rounds so. Else the reciprocal as it stands: `.0417083` is 23.976… and no 24.
pub(super) fn frame_rate(raw: &RawBvh) -> f64 {
    let time = raw.frame_time;
    // Twice half a unit: cut digits count as well; a few roundings of the reciprocal on top.
    let tolerance = 2.0 * raw.frame_time_rounding + 4.0 * f64::EPSILON * time;
    let distance = |rate: &f64| (1.0 / rate - time).abs();
    RATES
        .into_iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .into_iter()
        .chain(std::iter::once((1.0 / time).round()))
        .find(|rate| distance(rate) <= tolerance)
        .unwrap_or(1.0 / time)
}
