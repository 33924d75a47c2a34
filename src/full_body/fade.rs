//! Displacements between the stretches where they are known: from one to the next without a jump or a kink, none far away.

use std::ops::Range;

use glam::DVec3;

/// Samples from `first` to `last`, included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// First sample.
    pub first: usize,
    /// Last sample.
    pub last: usize,
}

/// With which slopes displacements leave their spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slopes {
    /// With those they have at the ends of the spans: without a kink.
    Kept,
    /// Level: never larger than in the spans.
    Level,
}

/// Carries displacements that are known in `spans` (apart, in the order of time) on into the samples between.
///
/// `displacements`: `N` vectors a sample; those outside the spans are overwritten. `fade`: seconds in which a displacement
/// vanishes; in a gap shorter than two fades it goes over into the next one instead. Cubic Hermite. Cost: linear.
pub fn fill<const N: usize>(
    times: &[f64],
    spans: &[Span],
    (fade, slopes): (f64, Slopes),
    displacements: &mut [[DVec3; N]],
) {
    let slope_samples = if slopes == Slopes::Kept { SLOPE_SAMPLES } else { 0 };
    let mut before: Option<Knot<N>> = None;
    let mut from = 0;
    for span in spans {
        let after = Knot::new(times, displacements, span.first, (span.first + slope_samples).min(span.last));
        fill_gap(times, from..span.first, [before, Some(after)], fade, displacements);
        let inside = span.last.saturating_sub(slope_samples).max(span.first);
        before = Some(Knot::new(times, displacements, span.last, inside));
        from = span.last + 1;
    }
    fill_gap(times, from..times.len(), [before, None], fade, displacements);
}

/// Samples over which the slope at an end of a span is taken.
const SLOPE_SAMPLES: usize = 2;

/// Displacements at a time, and how fast they change.
#[derive(Clone, Copy, Debug)]
struct Knot<const N: usize> {
    time: f64,
    value: [DVec3; N],
    slope: [DVec3; N],
}

impl<const N: usize> Knot<N> {
    /// At sample `at`, with the slope towards sample `inside` of the same span.
    fn new(times: &[f64], displacements: &[[DVec3; N]], at: usize, inside: usize) -> Self {
        let (time, value) = (times[at], displacements[at]);
        let span = time - times[inside];
        let slope = if span == 0.0 {
            [DVec3::ZERO; N]
        } else {
            std::array::from_fn(|channel| (value[channel] - displacements[inside][channel]) / span)
        };
        Self { time, value, slope }
    }

    const fn nothing(time: f64) -> Self {
        Self { time, value: [DVec3::ZERO; N], slope: [DVec3::ZERO; N] }
    }
}

fn fill_gap<const N: usize>(
    times: &[f64],
    gap: Range<usize>,
    [before, after]: [Option<Knot<N>>; 2],
    fade: f64,
    displacements: &mut [[DVec3; N]],
) {
    for at in gap {
        let time = times[at];
        displacements[at] = match [before, after] {
            [Some(before), Some(after)] if after.time - before.time < 2.0 * fade => {
                between(&before, &after, time)
            }
            [Some(before), _] if time < before.time + fade => {
                between(&before, &Knot::nothing(before.time + fade), time)
            }
            [_, Some(after)] if time > after.time - fade => {
                between(&Knot::nothing(after.time - fade), &after, time)
            }
            _ => [DVec3::ZERO; N],
        };
    }
}

/// The cubic that has the values and slopes of both knots.
fn between<const N: usize>(from: &Knot<N>, to: &Knot<N>, time: f64) -> [DVec3; N] {
    // Samples may share an instant.
    let span = (to.time - from.time).max(f64::MIN_POSITIVE);
    let u = ((time - from.time) / span).clamp(0.0, 1.0);
    let (u2, u3) = (u * u, u * u * u);
    let (late, leaving, meeting) = (3.0 * u2 - 2.0 * u3, u3 - 2.0 * u2 + u, u3 - u2);
    std::array::from_fn(|channel| {
        let slopes = from.slope[channel] * leaving + to.slope[channel] * meeting;
        from.value[channel] * (1.0 - late) + to.value[channel] * late + slopes * span
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(count: u32) -> Vec<f64> {
        (0..count).map(|k| f64::from(k) / 30.0).collect()
    }

    #[test]
    fn a_displacement_vanishes_within_a_fade_and_has_no_kink_where_it_starts() {
        let times = times(60);
        let mut track = vec![[DVec3::ZERO]; 60];
        for (sample, value) in track.iter_mut().enumerate().take(21) {
            value[0] = DVec3::X * (0.01 * sample as f64);
        }
        fill(&times, &[Span { first: 0, last: 20 }], (10.0 / 30.0, Slopes::Kept), &mut track);
        let slope = |at: usize| 30.0 * (track[at + 1][0].x - track[at][0].x);
        // The cubic's second derivative at its start is (6·(0 − .2) − 4·.3·fade)/fade², a step of 1/30 s long.
        assert!((slope(20) - slope(19)).abs() < 0.25, "{} {}", slope(19), slope(20));
        assert!(track[30..].iter().all(|value| value[0] == DVec3::ZERO));
    }

    #[test]
    fn in_a_short_gap_one_displacement_goes_over_into_the_next() {
        let times = times(20);
        let mut track = vec![[DVec3::ZERO]; 20];
        track[..5].fill([DVec3::X]);
        track[15..].fill([DVec3::Y]);
        fill(
            &times,
            &[Span { first: 0, last: 4 }, Span { first: 15, last: 19 }],
            (10.0 / 30.0, Slopes::Kept),
            &mut track,
        );
        for value in &track[5..15] {
            assert!((value[0].x + value[0].y - 1.0).abs() < 1e-12);
        }
        assert!(track.windows(2).all(|pair| pair[1][0].x <= pair[0][0].x));
    }
}
