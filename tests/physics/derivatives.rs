//! Filters and derivatives.

use std::f64::consts::TAU;

use cotillion::geometry::exp;
use cotillion::physics::derivatives::orientation::{lee_shin, smooth_logs, turn_weights};
use cotillion::physics::derivatives::{
    DERIVATIVE_WIDTH, Filter, JUDGE_CUTOFF, Kernel, Lanes, low_pass, second_differences, smooth,
};
use glam::{DQuat, DVec3};
use proptest::prelude::*;

/// Stated to nine digits.
const STATED: f64 = 1e-9;
/// Rounding of sums of a hundred terms below 10.
const ROUNDING: f64 = 1e-12;

fn lane(values: impl Iterator<Item = f64>) -> Lanes {
    let values: Vec<f64> = values.collect();
    Lanes { frame_count: values.len(), values }
}

#[test]
fn kernels_have_their_stated_taps() {
    let narrow = Kernel::gaussian(5.0, 30.0);
    let stated = [0.402_619_947, 0.244_201_342, 0.054_488_685];
    assert!(narrow.taps.iter().zip(stated).all(|(tap, stated)| (tap - stated).abs() < STATED));
    for (width, middle) in [(10.0, 0.163_967_208), (20.0, 0.082_718_465), (40.0, 0.041_568_660)] {
        assert!((Kernel::gaussian(width, 30.0).taps[0] - middle).abs() < STATED);
        assert_eq!(
            Kernel::gaussian(width, 120.0),
            Kernel::of_frames(4 * Kernel::gaussian(width, 30.0).half() * 2)
        );
    }
    assert_eq!(Kernel::gaussian(40.0, 120.0).half(), 80);
    assert_eq!(Kernel::gaussian(1.0, 30.0).taps, [1.0]);
}

/// Of the second derivative of a sine, against the true one; the kernel is of five frames whatever the rate.
fn gain(fps: f64, hertz: f64) -> f64 {
    let omega = TAU * hertz;
    let sine = lane((0..1200).map(|k| (omega * f64::from(k) / fps).sin()));
    let found = second_differences(&smooth(&sine, &Kernel::of_frames(5)), fps);
    let dot = |a: &[f64], b: &[f64]| (100..1100).map(|k| a[k] * b[k]).sum::<f64>();
    -dot(found.lane(0), &sine.values) / dot(&sine.values, &sine.values) / (omega * omega)
}

#[test]
fn accelerations_have_the_stated_gains() {
    let stated = [(30.0, [0.976_329, 0.908_320, 0.677_009]), (120.0, [0.998_505, 0.994_034, 0.976_329])];
    for (fps, gains) in stated {
        for (hertz, stated) in [1.0, 2.0, 4.0].into_iter().zip(gains) {
            let found = gain(fps, hertz);
            assert!((found - stated).abs() < 1e-6, "{fps} {hertz}: {found}");
        }
    }
    assert_eq!(DERIVATIVE_WIDTH, 5.0);
}

/// `1/(1 + (tan πf/tan πf_c)⁴)`: forwards and back, in closed form.
#[test]
fn the_judge_has_the_gain_of_a_butterworth_filter() {
    for fps in [30.0, 60.0, 120.0_f64] {
        for hertz in [1.0, 3.0, 6.0, 10.0_f64] {
            let ratio = (TAU * 0.5 * hertz / fps).tan() / (TAU * 0.5 * JUDGE_CUTOFF / fps).tan();
            let expected = 1.0 / (1.0 + ratio.powi(4));
            let sine = lane((0..1200).map(|k| (TAU * hertz * f64::from(k) / fps).sin()));
            let found = low_pass(&sine, JUDGE_CUTOFF, fps);
            for k in 500..700 {
                assert!((found.values[k] - expected * sine.values[k]).abs() < 1e-9, "{fps} {hertz}");
            }
        }
    }
}

#[test]
fn a_body_that_moves_evenly_is_not_braked_at_the_ends() {
    let even = lane((0..50).map(|k| 3.0 + 0.7 * f64::from(k)));
    let wide = smooth(&even, &Kernel::gaussian(40.0, 120.0));
    assert!(wide.values.iter().zip(&even.values).all(|(a, b)| (a - b).abs() < ROUNDING * 1e2));
    for filter in [Filter::Gaussian, Filter::Butterworth] {
        let none = filter.accelerations(&even, 120.0);
        assert!(none.values.iter().all(|a| a.abs() < 1e-7), "{filter:?}");
    }
}

#[test]
fn clips_shorter_than_the_kernel_stay_finite() {
    for count in 0..5 {
        let short = lane((0..count).map(|k| f64::from(k * k)));
        for filter in [Filter::Gaussian, Filter::Butterworth] {
            let found = filter.accelerations(&short, 120.0);
            assert!(found.values.iter().all(|a| a.is_finite()) && found.frame_count == short.frame_count);
        }
    }
}

fn turning() -> Vec<DQuat> {
    let vector = |i: f64| DVec3::new(0.3 * (0.5 * i).sin(), 0.2 * (0.8 * i).cos(), 0.1 * i);
    (0..=10).map(|i| exp(vector(f64::from(i)))).collect()
}

fn assert_quaternion(found: DQuat, [w, x, y, z]: [f64; 4]) {
    let expected = DQuat::from_xyzw(x, y, z, w);
    assert!((found - expected).length() < 1e-8, "{found}");
}

#[test]
fn rotations_smooth_to_the_stated_ones() {
    let kernel = Kernel::of_frames(5);
    let weights = turn_weights(&kernel);
    let stated = [-0.054_488_685, -0.298_690_027, 0.298_690_027, 0.054_488_685];
    assert!(weights.iter().zip(stated).all(|(own, stated)| (own - stated).abs() < STATED));
    let found = lee_shin(&turning(), &kernel)[5];
    assert_quaternion(found, [0.964_468_23, 0.079_070_46, -0.048_081_73, 0.247_461_18]);
    let by_logs = smooth_logs(&turning(), &kernel)[5];
    assert_quaternion(by_logs, [0.964_599_45, 0.078_961_14, -0.047_778_85, 0.247_042_93]);
}

proptest! {
    #[test]
    fn smoothing_commutes_with_turns_of_everything(a in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], b in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0]) {
        let (left, right) = (exp(DVec3::from_array(a)), exp(DVec3::from_array(b)));
        let kernel = Kernel::of_frames(6);
        let turned: Vec<DQuat> = turning().into_iter().map(|q| left * q * right).collect();
        let after = lee_shin(&turning(), &kernel);
        for (found, own) in lee_shin(&turned, &kernel).into_iter().zip(after) {
            prop_assert!(found.dot(left * own * right).abs() > 1.0 - 1e-14);
        }
    }

    /// With a kernel longer than the motion, too.
    #[test]
    fn about_a_fixed_axis_rotations_smooth_as_their_angles(angles in prop::collection::vec(-0.5..0.5_f64, 1..12), width in 0..40_usize) {
        let kernel = Kernel::of_frames(width);
        let axis = DVec3::new(0.6, 0.0, 0.8);
        let rotations: Vec<DQuat> = angles.iter().map(|angle| exp(axis * *angle)).collect();
        let smoothed = smooth(&lane(angles.iter().copied()), &kernel);
        for (found, angle) in lee_shin(&rotations, &kernel).into_iter().zip(&smoothed.values) {
            prop_assert!(found.dot(exp(axis * *angle)).abs() > 1.0 - 1e-14);
        }
    }

    /// Against the definition, tap by tap.
    #[test]
    fn convolution_is_the_sum_of_reflected_taps(values in prop::collection::vec(-5.0..5.0_f64, 2..40), width in 0..30_usize) {
        let kernel = Kernel::of_frames(width);
        let found = smooth(&lane(values.iter().copied()), &kernel);
        for k in 0..values.len() {
            let tap = |j: usize| kernel.taps[j] * (before(&values, k, j) + after(&values, k, j));
            let sum: f64 = kernel.taps[0] * values[k] + (1..kernel.taps.len()).map(tap).sum::<f64>();
            prop_assert!((found.values[k] - sum).abs() < 1e-10);
        }
    }
}

/// Value `j` frames before frame `k`, reflected in the first point.
fn before(values: &[f64], k: usize, j: usize) -> f64 {
    if j <= k { values[k - j] } else { 2.0 * values[0] - after(values, 0, j - k) }
}

/// Value `j` frames after frame `k`, reflected in the last point.
fn after(values: &[f64], k: usize, j: usize) -> f64 {
    let last = values.len() - 1;
    if k + j <= last { values[k + j] } else { 2.0 * values[last] - before(values, last, k + j - last) }
}
