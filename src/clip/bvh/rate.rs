//! The rate that a rounded frame time stands for.

use super::parse::RawBvh;

/// Rates in use, frames per second, that a rounded frame time may stand for.
const RATES: [f64; 16] =
    [24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 72.0, 75.0, 90.0, 100.0, 120.0, 144.0, 150.0, 200.0, 240.0, 250.0];

/// Frame times of many digits may be off by one in the last, share of the time.
const NEAR: f64 = 1e-5;

/// Frames per second of a frame time that may be written in few digits.
///
/// A whole rate of which it is the exact reciprocal is meant: `.1` is 10. Else a rate in use whose frame time, rounded or
/// cut, has the digits written: `.0083333` is 120, `.033` is 30. Else a whole rate of which the same is true. Else the
/// reciprocal as it stands: `.0417083` is 23.976… and no 24.
pub(super) fn frame_rate(raw: &RawBvh) -> f64 {
    let time = raw.frame_time;
    let whole = (1.0 / time).round();
    let rounding = 4.0 * f64::EPSILON * time;
    // What the digits written leave out.
    let rest = |rate: f64| 1.0 / rate - time;
    let is_meant = |rate: &f64| {
        let is_rounded = rest(*rate).abs() <= raw.frame_time_rounding + rounding;
        let is_cut = (-rounding..2.0 * raw.frame_time_rounding + rounding).contains(&rest(*rate));
        // Written from 32 bits, or rounded up.
        let is_near = rest(*rate).abs() <= (2.0 * raw.frame_time_rounding).min(NEAR * time);
        is_rounded || is_cut || is_near
    };
    if rest(whole).abs() <= rounding {
        return whole;
    }
    let nearest = RATES.into_iter().min_by(|a, b| rest(*a).abs().total_cmp(&rest(*b).abs()));
    nearest.into_iter().chain([whole]).find(is_meant).unwrap_or(1.0 / time)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::bvh::parse::parse;

    fn rate(written: &str) -> f64 {
        let text = format!(
            "HIERARCHY ROOT a\n{{ OFFSET 0 0 0 CHANNELS 3 Xrotation Yrotation Zrotation }} MOTION Frames: 1 \
             Frame Time: {written}\n1 2 3\n"
        );
        frame_rate(&parse(text.as_bytes(), false).expect("a sound file"))
    }

    #[test]
    fn frame_times_of_few_digits_mean_the_rates_they_round_or_are_cut_from() {
        for (written, fps) in [
            (".0083333", 120.0),
            (".0083", 120.0),
            ("0.008333", 120.0),
            (".033333", 30.0),
            (".03333334", 30.0),
            (".033", 30.0),
            (".03", 30.0),
            ("0.04", 25.0),
            ("0.1", 10.0),
            ("0.5", 2.0),
            ("1", 1.0),
            ("2", 0.5),
            ("10", 0.1),
            ("0.0166667", 60.0),
            (".041667", 24.0),
        ] {
            assert_eq!(rate(written), fps, "{written}");
        }
        assert!((rate(".0417083") - 23.976).abs() < 1e-3);
    }
}
