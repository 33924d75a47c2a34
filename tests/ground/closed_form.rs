//! Turns that bring zero moment points where they are wanted, against brute force and stated numbers.

use cotillion::geometry::exp;
use cotillion::physics::GRAVITY;
use cotillion::physics::ground::closed_form::{Loads, axis_across};
use glam::{DMat3, DQuat, DVec2, DVec3};
use proptest::prelude::*;

/// Stated to nine digits.
const STATED: f64 = 1e-8;
/// Rounding of sums of a few terms of order 1.
const ROUNDING: f64 = 1e-11;

/// Mass, place and acceleration.
type Mass = (f64, DVec3, DVec3);

/// Six masses: two stay, two turn about a pivot, two are carried by a border.
struct Six {
    masses: [Mass; 6],
    pivot: DVec3,
    border: DVec3,
}

fn six() -> Six {
    let mass = |i: usize| {
        let k = i as f64;
        let place = DVec3::new(0.3 * (1.0 + k).sin(), 0.4 + 0.25 * k, 0.2 * (2.0 + 0.7 * k).cos());
        let acceleration =
            DVec3::new(0.8 * (2.0 * k + 0.5).sin(), 0.6 * (1.5 * k).cos(), -0.5 * (k + 0.3).sin());
        (2.0 + k, place, acceleration)
    };
    Six {
        masses: std::array::from_fn(mass),
        pivot: DVec3::new(0.05, 0.7, -0.03),
        border: DVec3::new(0.1, 1.3, 0.02),
    }
}

fn force((mass, _, acceleration): Mass) -> DVec3 {
    mass * (acceleration + DVec3::Y * GRAVITY)
}

impl Six {
    fn loads(&self) -> Loads {
        let mut loads = Loads { force: DVec3::ZERO, moment: DVec3::ZERO, arms: DMat3::ZERO };
        for (index, mass) in self.masses.iter().enumerate() {
            let force = force(*mass);
            loads.force += force;
            loads.moment += mass.1.cross(force);
            let arm = match index {
                0 | 1 => DVec3::ZERO,
                2 | 3 => mass.1 - self.pivot,
                _ => self.border - self.pivot,
            };
            loads.arms += DMat3::from_cols(arm * force.x, arm * force.y, arm * force.z);
        }
        loads
    }

    /// The zero moment point with the links really moved.
    fn turned(&self, turn: DQuat) -> DVec2 {
        let carried = turn * (self.border - self.pivot) - (self.border - self.pivot);
        let (mut sum, mut vertical) = (DVec2::ZERO, 0.0);
        for (index, mass) in self.masses.iter().enumerate() {
            let place = match index {
                0 | 1 => mass.1,
                2 | 3 => self.pivot + turn * (mass.1 - self.pivot),
                _ => mass.1 + carried,
            };
            let force = force(*mass);
            sum += DVec2::new(force.y * place.x - force.x * place.y, force.y * place.z - force.z * place.y);
            vertical += force.y;
        }
        sum / vertical
    }
}

const ALONG_X: DVec2 = DVec2::X;

#[test]
fn six_masses_have_the_stated_coefficients() {
    let loads = six().loads();
    assert!((loads.force.y - 268.101_438_940).abs() < STATED);
    assert!(loads.zmp(0.0).distance(DVec2::new(-0.061_808_160, -0.057_626_059)) < STATED);
    let stated =
        [-0.023_049_168, 0.404_164_656, -0.038_758_992, -0.012_219_413, -0.000_690_958, -0.045_406_646];
    for (found, stated) in loads.coefficients(0.0, ALONG_X).into_iter().zip(stated) {
        assert!((found - stated).abs() < STATED, "{found} {stated}");
    }
}

#[test]
fn turned_masses_have_the_stated_points() {
    let stated = [
        (0.1, -0.102_042_148, -0.057_633_993),
        (-0.3, 0.058_660_120, -0.056_876_105),
        (1.0, -0.391_305_342, -0.052_590_244),
    ];
    let [a1, a2, a3, a4, a5, a6] = six().loads().coefficients(0.0, ALONG_X);
    for (angle, x, z) in stated {
        let angle: f64 = angle;
        let expected = DVec2::new(x, z);
        let (sine, cosine) = angle.sin_cos();
        let by_form = DVec2::new(a1 * cosine - a2 * sine + a3, a4 * cosine + a5 * sine + a6);
        let turn = DQuat::from_rotation_z(angle);
        assert!(by_form.distance(expected) < STATED);
        assert!(six().loads().zmp_turned(turn, 0.0).distance(by_form) < ROUNDING);
        assert!(six().turned(turn).distance(by_form) < ROUNDING, "by moving the masses");
    }
}

#[test]
fn shifts_need_the_stated_turns() {
    let loads = six().loads();
    let stated = [(0.05, -0.123_591_354), (-0.08, 0.200_419_729), (0.2, -0.509_348_640)];
    for (shift, angle) in stated {
        let turn = loads.turn_for(0.0, DVec2::X * shift).expect("a lever");
        // Turns about the axis across: towards −x the axis is −z.
        let about_z = turn.angle * shift.signum();
        assert!(turn.reaches && (about_z - angle).abs() < STATED, "{shift}: {about_z}");
        let found = six().turned(DQuat::from_rotation_z(about_z)).x - loads.zmp(0.0).x;
        assert!((found - shift).abs() < ROUNDING);
    }
    let turn = loads.turn_for(0.0, DVec2::X * 0.05).expect("a lever");
    assert!((turn.other + 3.131_936_196).abs() < STATED);
}

#[test]
fn points_drift_across_by_the_stated_way() {
    let loads = six().loads();
    for (angle, drift) in [(-0.123_591_354, 1.78e-4), (-0.509_348_640, 1.888e-3)] {
        let found = loads.zmp_turned(DQuat::from_rotation_z(angle), 0.0).y - loads.zmp(0.0).y;
        assert!((found - drift).abs() < 5e-7, "{found}");
    }
}

#[test]
fn what_is_out_of_reach_is_taken_as_far_as_it_goes() {
    let loads = six().loads();
    let turn = loads.turn_for(0.0, DVec2::X * 2.0).expect("a lever");
    assert!(!turn.reaches && (turn.angle + 1.627_763_775).abs() < STATED);
    let gain = |angle: f64| loads.zmp_turned(DQuat::from_rotation_z(angle), 0.0).x - loads.zmp(0.0).x;
    assert!((gain(turn.angle) - 0.427_870_528).abs() < STATED);
    assert!(gain(turn.angle) >= gain(turn.angle + 1e-3) && gain(turn.angle) >= gain(turn.angle - 1e-3));
}

#[test]
fn turns_about_both_axes_leave_nothing() {
    let loads = six().loads();
    let shift = DVec2::new(0.04, -0.03);
    let turn = loads.turn_for(0.0, shift).expect("a lever");
    let axis = axis_across(shift.normalize());
    assert!((axis - DVec3::new(0.6, 0.0, 0.8)).length() < ROUNDING);
    assert!((turn.angle + 0.123_965_841).abs() < STATED);
    let target = loads.zmp(0.0) + shift;
    let left = loads.zmp_turned(exp(turn.angle * axis), 0.0) - target;
    assert!((left - DVec2::new(-7.08e-5, -9.44e-5)).length() < 5e-7, "{left}");
    let both = loads.turn_about_both(0.0, target, turn.angle * axis).expect("it converges");
    assert!((both - DVec3::new(-0.074_146_947, 0.0, -0.099_346_252)).length() < STATED, "{both}");
    assert!(six().turned(exp(both)).distance(target) < 1e-10);
}

#[test]
fn a_body_without_a_lever_does_not_turn() {
    let loads = Loads { force: DVec3::Y * 700.0, moment: DVec3::ZERO, arms: DMat3::ZERO };
    assert_eq!(loads.turn_for(0.0, DVec2::X * 0.01), None);
}

/// One mass that turns about the origin.
fn one(place: DVec3, acceleration: DVec3) -> Loads {
    let force = acceleration + DVec3::Y * GRAVITY;
    Loads {
        force,
        moment: place.cross(force),
        arms: DMat3::from_cols(place * force.x, place * force.y, place * force.z),
    }
}

#[test]
fn who_accelerates_leans_into_it() {
    let loads = one(DVec3::Y, DVec3::X);
    let shift = -loads.zmp(0.0);
    let turn = loads.turn_for(0.0, shift).expect("a lever");
    assert!((turn.angle + 0.101_585_905).abs() < STATED && shift.x > 0.0, "{}", turn.angle);
    assert!((turn.angle + (1.0 / GRAVITY).atan()).abs() < ROUNDING);
}

#[test]
fn who_walks_a_curve_leans_inwards() {
    let (speed, radius): (f64, f64) = (1.5, 2.5);
    let loads = one(DVec3::Y * 0.95, DVec3::NEG_Z * (speed * speed / radius));
    let outside = loads.zmp(0.0);
    assert!((outside.length() - 0.087_155_963).abs() < STATED);
    let turn = loads.turn_for(0.0, -outside).expect("a lever");
    assert!((turn.angle.abs().to_degrees() - 5.241_820).abs() < 1e-6);
    let leaned = exp(turn.angle * axis_across(-outside.normalize())) * (DVec3::Y * 0.95);
    assert!(leaned.z < 0.0, "inwards");
}

proptest! {
    /// Of any loads on any plane, in any direction.
    #[test]
    fn reached_points_are_reached(
        numbers in prop::array::uniform9(-80.0..80.0_f64),
        up in 200.0..900.0_f64,
        direction in -3.0..3.0_f64,
        shift in 0.001..0.2_f64,
        height in -0.5..0.5_f64,
    ) {
        let [a, b, c, d, e, f, g, h, i] = numbers;
        let arms = DMat3::from_cols_array(&[a, b, c, d, e + 400.0, f, g, h, i]);
        let loads = Loads { force: DVec3::new(a, up, c), moment: DVec3::new(g, h, i), arms };
        let shift = DVec2::from_angle(direction) * shift;
        let turn = loads.turn_for(height, shift).expect("a lever");
        let ahead = shift.normalize();
        let found = loads.zmp_turned(exp(turn.angle * axis_across(ahead)), height) - loads.zmp(height);
        if turn.reaches {
            prop_assert!((found - shift).dot(ahead).abs() < 1e-9, "{found} {shift}");
            prop_assert!(turn.angle.abs() <= turn.other.abs());
            let other = loads.zmp_turned(exp(turn.other * axis_across(ahead)), height) - loads.zmp(height);
            prop_assert!((other - shift).dot(ahead).abs() < 1e-9);
        } else {
            prop_assert!(found.dot(ahead) < shift.length());
        }
    }
}
