//! Ground plan, headings, rotations: the conventions of the world in one place.
//!
//! World: right-handed, y up, metres, radians. Ground plan: what a person draws looking down, `p = x − i z` as a complex
//! number, so that angles count counter-clockwise seen from above, as about +y; heading 0 looks along +x.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};

pub use cotillion_solvers::c64;

/// Plan point below the world point `point`: `x − i z`, metres.
pub fn plan_of(point: DVec3) -> c64 {
    c64::new(point.x, -point.z)
}

/// World point at `height` metres above the plan point `plan`.
pub fn world_of(plan: c64, height: f64) -> DVec3 {
    DVec3::new(plan.re, height, -plan.im)
}

/// `e^{i angle}`.
pub fn cis(angle: f64) -> c64 {
    c64::from_polar(1.0, angle)
}

/// The same angle in `(−π, π]`, radians.
pub fn wrap(angle: f64) -> f64 {
    let wrapped = angle.rem_euclid(TAU);
    if wrapped > PI { wrapped - TAU } else { wrapped }
}

/// `from` moved by the share `s` of the shorter arc to `to`, radians, not wrapped.
pub fn lerp_angle(from: f64, to: f64, s: f64) -> f64 {
    from + s * wrap(to - from)
}

/// 3s² − 2s³ of `s` clamped to [0, 1].
pub fn smoothstep(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

/// Turn by `angle` about +y.
pub fn yaw(angle: f64) -> DQuat {
    DQuat::from_rotation_y(angle)
}

/// Rotation vector (axis times angle, at most π long) of a unit quaternion: the shorter way.
pub fn log(rotation: DQuat) -> DVec3 {
    let q = if rotation.w < 0.0 { -rotation } else { rotation };
    let axis = DVec3::new(q.x, q.y, q.z);
    let sine = axis.length();
    if sine < 1e-12 {
        return axis * 2.0;
    }
    axis * (2.0 * sine.atan2(q.w) / sine)
}

/// Unit quaternion of a rotation vector.
pub fn exp(vector: DVec3) -> DQuat {
    DQuat::from_scaled_axis(vector)
}

/// Sine and cosine of half an angle in degrees; multiples of 90° are exact, and every platform has the same bits.
///
/// The angle less whole half turns, which is exact, is at most 90°, its half π/4: there series of nine terms are nearer to
/// the values than these are to each other.
#[inline]
pub fn sin_cos_of_half(degrees: f64) -> (f64, f64) {
    /// 1.5·2⁵²: what is added to it loses its fraction, and its last bits are a whole number.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    // Beyond a million turns nothing is left of a fraction that mattered.
    let degrees = if degrees.abs() < 1e9 { degrees } else { degrees % 720.0 };
    let shifted = degrees / 180.0 + WHOLE;
    let x = (degrees - 180.0 * (shifted - WHOLE)) * (std::f64::consts::PI / 360.0);
    let square = x * x;
    let (sine, cosine) = (x * series(SINE, square), series(COSINE, square));
    // Half of a half turn is a quarter turn.
    match shifted.to_bits() & 3 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// `Σ terms[k]·zᵏ` in pairs (Estrin's scheme): additions wait for each other less than in Horner's.
fn series(terms: [f64; 9], z: f64) -> f64 {
    let [a, b, c, d, e, f, g, h, i] = terms;
    let z_2 = z * z;
    let z_4 = z_2 * z_2;
    (a + b * z) + (c + d * z) * z_2 + ((e + f * z) + (g + h * z) * z_2) * z_4 + i * (z_4 * z_4)
}

/// (−1)ᵏ/(2k+1)! and (−1)ᵏ/(2k)!.
const SINE: [f64; 9] = [
    1.0,
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];
const COSINE: [f64; 9] = [
    1.0,
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// Spherical interpolation on the shorter arc; exact at both ends.
pub fn slerp(from: DQuat, to: DQuat, s: f64) -> DQuat {
    if s == 0.0 || from == to {
        return from;
    }
    if s == 1.0 {
        return to;
    }
    (from * exp(log(from.inverse() * to) * s)).normalize()
}

/// Rigid motion of the ground plan, `x ↦ turn·x + shift` with `|turn| = 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// `e^{iψ}` of the turn ψ.
    pub turn: c64,
    /// Where the origin goes, metres.
    pub shift: c64,
}

impl RigidMotion {
    /// The motion that moves nothing.
    pub const IDENTITY: Self = Self { turn: c64::new(1.0, 0.0), shift: c64::new(0.0, 0.0) };

    /// Turns by `angle` and moves `from` to `to`.
    pub fn carrying(from: c64, to: c64, angle: f64) -> Self {
        let turn = if angle == 0.0 { c64::new(1.0, 0.0) } else { cis(angle) };
        Self { turn, shift: to - turn * from }
    }

    /// Where `point` goes.
    pub fn apply(&self, point: c64) -> c64 {
        self.turn * point + self.shift
    }

    /// Turn, radians in (−π, π].
    pub fn angle(&self) -> f64 {
        self.turn.arg()
    }

    /// First `self`, then `after`.
    pub fn then(&self, after: &Self) -> Self {
        Self { turn: after.turn * self.turn, shift: after.apply(self.shift) }
    }

    /// Where a world point goes; its height stays.
    pub fn apply_world(&self, point: DVec3) -> DVec3 {
        world_of(self.apply(plan_of(point)), point.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Rounding of a few operations on numbers below 10.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn halves_of_degrees_have_the_sines_of_their_radians() {
        for k in -1000..=1000 {
            let degrees = 0.3711 * f64::from(k);
            let (sine, cosine) = sin_cos_of_half(degrees);
            let (s, c) = (0.5 * degrees.to_radians()).sin_cos();
            assert!((sine - s).abs() < 4e-16 && (cosine - c).abs() < 4e-16, "{degrees}");
        }
        assert_eq!(sin_cos_of_half(180.0), (1.0, 0.0));
        assert_eq!(sin_cos_of_half(-360.0), (0.0, -1.0));
        assert_eq!(sin_cos_of_half(0.0), (0.0, 1.0));
        let (sine, cosine) = sin_cos_of_half(-1e300);
        assert!((sine.hypot(cosine) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn ahead_and_left_agree_with_the_worked_example() {
        assert_eq!(plan_of(DVec3::new(1.0, 0.0, 2.0)), c64::new(1.0, -2.0));
        let towards_minus_z = yaw(PI / 2.0) * DVec3::X;
        assert!((towards_minus_z - DVec3::NEG_Z).length() < ROUNDING);
        assert!((plan_of(towards_minus_z).arg() - PI / 2.0).abs() < ROUNDING);
    }

    #[test]
    fn wrapping_keeps_pi_and_turns_minus_pi_over() {
        assert_eq!(wrap(PI), PI);
        assert_eq!(wrap(-PI), PI);
        assert!((wrap(7.0) - (7.0 - TAU)).abs() < ROUNDING);
    }

    proptest! {
        #[test]
        fn a_turn_about_up_is_a_complex_product(x in -5.0..5.0_f64, z in -5.0..5.0_f64, angle in -3.0..3.0_f64) {
            let point = DVec3::new(x, 0.3, z);
            let turned = plan_of(yaw(angle) * point);
            prop_assert!((turned - cis(angle) * plan_of(point)).norm() < ROUNDING);
        }

        #[test]
        fn exp_undoes_log(x in -1.7..1.7_f64, y in -1.7..1.7_f64, z in -1.7..1.7_f64) {
            let q = exp(DVec3::new(x, y, z));
            prop_assert!(exp(log(q)).dot(q).abs() > 1.0 - ROUNDING);
        }
    }
}
