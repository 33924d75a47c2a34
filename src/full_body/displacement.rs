//! Scattered displacements along time made one smooth curve: multilevel uniform cubic B-splines.
//!
//! Source: Lee, Wolberg & Shin, *Scattered Data Interpolation with Multilevel B-Splines*, TVCG 1997; used for motion as in
//! Lee & Shin, *A Hierarchical Approach to Interactive Motion Editing for Human-like Figures*, SIGGRAPH 1999, §4.

/// A value that a curve should have at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<const N: usize> {
    /// Within the curve's domain.
    pub time: f64,
    /// One number a channel.
    pub value: [f64; N],
}

/// A uniform cubic B-spline of `N` channels on the domain `[start, start + spans·spacing]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline<const N: usize> {
    /// Start of the domain.
    pub start: f64,
    /// Distance of knots.
    pub spacing: f64,
    /// Control points, three more than spans.
    pub controls: Vec<[f64; N]>,
}

impl<const N: usize> Spline<N> {
    /// The spline of `spans` spans on `[start, end]` that follows `samples` where it can: each control point is the
    /// average of what the samples near it want, weighted by the square of its influence on them; 0 where none is near.
    ///
    /// `φ_kc = w_kc·δ_c/Σ_a w_ac²`, `φ_k = Σ_c w_kc²·φ_kc/Σ_c w_kc²`. Cost: linear in samples and spans.
    pub fn fit(start: f64, end: f64, spans: usize, samples: &[Sample<N>]) -> Self {
        let spacing = (end - start) / spans as f64;
        let mut sums = vec![[0.0; N]; spans + 3];
        let mut weights = vec![0.0; spans + 3];
        let mut spline = Self { start, spacing, controls: Vec::new() };
        for sample in samples {
            let (first, influence) = spline.influence(sample.time, spans);
            let norm_sq: f64 = influence.iter().map(|weight| weight * weight).sum();
            for (control, weight) in influence.into_iter().enumerate() {
                let weight_sq = weight * weight;
                for (sum, value) in sums[first + control].iter_mut().zip(sample.value) {
                    *sum += weight_sq * (weight * value / norm_sq);
                }
                weights[first + control] += weight_sq;
            }
        }
        for (sum, weight) in sums.iter_mut().zip(weights).filter(|(_, weight)| *weight > 0.0) {
            for channel in sum {
                *channel /= weight;
            }
        }
        spline.controls = sums;
        spline
    }

    /// The value at `time`, held at the ends of the domain.
    pub fn at(&self, time: f64) -> [f64; N] {
        let (first, influence) = self.influence(time, self.controls.len() - 3);
        let mut value = [0.0; N];
        for (weight, control) in influence.into_iter().zip(&self.controls[first..first + 4]) {
            for (channel, from) in value.iter_mut().zip(control) {
                *channel += weight * from;
            }
        }
        value
    }

    /// First of the four control points that matter at `time`, and how much each does.
    fn influence(&self, time: f64, spans: usize) -> (usize, [f64; 4]) {
        let at = ((time - self.start) / self.spacing).clamp(0.0, spans as f64);
        let first = crate::index::floor_index(at).min(spans - 1);
        let u = at - first as f64;
        let v = 1.0 - u;
        let sixth = 1.0 / 6.0;
        let influence = [
            v * v * v * sixth,
            (3.0 * u * u * u - 6.0 * u * u + 4.0) * sixth,
            (-3.0 * u * u * u + 3.0 * u * u + 3.0 * u + 1.0) * sixth,
            u * u * u * sixth,
        ];
        (first, influence)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn residuals_fall_level_by_level_as_in_the_reference() {
        let mut samples = [(10.0, 0.1), (40.0, -0.2), (45.0, 0.05), (90.0, 0.3)]
            .map(|(time, value)| Sample { time, value: [value] });
        let expected = [
            (0.2814824887777, 1e-12),
            (0.2062736672987, 1e-12),
            (0.1525182545178, 1e-12),
            (0.1027913984218, 1e-6),
            (0.0661780484113, 1e-12),
            (0.0062664959434, 1e-12),
            (6.634137732e-7, 1e-12),
        ];
        let mut middle = 0.0;
        for (level, (residual, tolerance)) in expected.into_iter().enumerate() {
            let spline = Spline::fit(0.0, 100.0, 1 << level, &samples);
            middle += spline.at(50.0)[0];
            for sample in &mut samples {
                sample.value[0] -= spline.at(sample.time)[0];
            }
            let largest = samples.iter().map(|sample| sample.value[0].abs()).fold(0.0, f64::max);
            assert!((largest - residual).abs() < tolerance, "level {level}: {largest}");
        }
        assert!((middle - 0.0643436831095).abs() < 1e-12, "{middle}");
    }

    proptest! {
        #[test]
        fn one_sample_is_met_and_its_spline_ends_two_knots_away(time in 0.0..100.0_f64, spans in 1..60_usize) {
            let sample = Sample { time, value: [1.0, -2.0] };
            let spline = Spline::fit(0.0, 100.0, spans, &[sample]);
            let value = spline.at(time);
            prop_assert!((value[0] - 1.0).abs() < 1e-12 && (value[1] + 2.0).abs() < 1e-12);
            for k in 0..=100 {
                let at = f64::from(k);
                if (at - time).abs() > 4.0 * spline.spacing {
                    prop_assert_eq!(spline.at(at), [0.0, 0.0]);
                }
            }
        }
    }
}
