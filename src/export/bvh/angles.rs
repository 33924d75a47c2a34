//! Euler angles of rotations, continuous from frame to frame.

use glam::{DMat3, DQuat};

use crate::geometry::wrap;
use crate::skeleton::Axis;

/// Below this cosine of the middle angle the outer two turn about one axis, and the first is taken from the frame before.
const GIMBAL_COSINE: f64 = 1e-9;

/// Angles `[α, β, γ]`, radians, of the product of turns about the axes `order` that is `rotation`, nearest to `before`.
///
/// Of the two triples that make a rotation and all whole turns added to them, the nearest to `before` in the sum of
/// differences. Where the middle angle is ±90° (gimbal lock) α stays as before and γ takes the rest, which is exact: γ is
/// always found from what `rotation` leaves after α is undone.
pub fn euler_angles(rotation: DQuat, order: [Axis; 3], before: [f64; 3]) -> [f64; 3] {
    let [i, j, k] = order.map(axis_index);
    // +1 for x y z and its cyclic shifts, −1 for the others.
    let sign = if (i + 1) % 3 == j { 1.0 } else { -1.0 };
    let matrix = DMat3::from_quat(rotation.normalize());
    let entry = |row: usize, column: usize| matrix.col(column)[row];
    let cosine = entry(i, i).hypot(entry(i, j));
    let alpha = if cosine < GIMBAL_COSINE { before[0] } else { (-sign * entry(j, k)).atan2(entry(k, k)) };
    let beta = (sign * entry(i, k)).atan2(entry(j, k).hypot(entry(k, k)));
    let (sine_alpha, cosine_alpha) = alpha.sin_cos();
    let left_over = |column: usize| cosine_alpha * entry(j, column) + sign * sine_alpha * entry(k, column);
    let gamma = (sign * left_over(i)).atan2(left_over(j));
    let half_turn = std::f64::consts::PI;
    let direct = nearest_turns([alpha, beta, gamma], before);
    let flipped = nearest_turns([alpha + half_turn, half_turn - beta, gamma + half_turn], before);
    let distance = |angles: &[f64; 3]| -> f64 { angles.iter().zip(before).map(|(a, b)| (a - b).abs()).sum() };
    // In gimbal lock alpha is kept on purpose; flipping it would leave the lock on the far side.
    if cosine >= GIMBAL_COSINE && distance(&flipped) < distance(&direct) { flipped } else { direct }
}

fn nearest_turns(angles: [f64; 3], before: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|index| before[index] + wrap(angles[index] - before[index]))
}

fn axis_index(axis: Axis) -> usize {
    match axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    }
}

/// Rotation of Euler angles, radians: the product of the turns about the axes `order`.
pub fn rotation_of(angles: [f64; 3], order: [Axis; 3]) -> DQuat {
    let turn = |index: usize| match order[index] {
        Axis::X => DQuat::from_rotation_x(angles[index]),
        Axis::Y => DQuat::from_rotation_y(angles[index]),
        Axis::Z => DQuat::from_rotation_z(angles[index]),
    };
    turn(0) * turn(1) * turn(2)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use proptest::prelude::*;

    use super::*;
    use crate::geometry::log;

    /// Rounding of a decomposition; between locked and free the first angle loses digits that the last makes up for.
    const ROUNDING: f64 = 2e-9;

    const ORDERS: [[Axis; 3]; 6] = [
        [Axis::X, Axis::Y, Axis::Z],
        [Axis::Y, Axis::Z, Axis::X],
        [Axis::Z, Axis::X, Axis::Y],
        [Axis::X, Axis::Z, Axis::Y],
        [Axis::Y, Axis::X, Axis::Z],
        [Axis::Z, Axis::Y, Axis::X],
    ];

    fn angle_between(a: DQuat, b: DQuat) -> f64 {
        log(a.inverse() * b).length()
    }

    proptest! {
        #[test]
        fn euler_angles_make_the_rotation_again(
            order in 0..6_usize,
            angles in prop::array::uniform3(-10.0..10.0_f64),
            before in prop::array::uniform3(-10.0..10.0_f64),
        ) {
            let rotation = rotation_of(angles, ORDERS[order]);
            let found = euler_angles(rotation, ORDERS[order], before);
            prop_assert!(angle_between(rotation_of(found, ORDERS[order]), rotation) < ROUNDING);
            let near_itself = euler_angles(rotation, ORDERS[order], angles);
            for (found, expected) in near_itself.iter().zip(angles) {
                // The middle angle is lost where its sine is flat; 1e-4 allows for 1e-9 of its cosine.
                prop_assert!((found - expected).abs() < 1e-4);
            }
        }

        #[test]
        fn gimbal_lock_keeps_the_rotation_and_the_first_angle(
            order in 0..6_usize,
            outer in prop::array::uniform2(-3.0..3.0_f64),
            up in any::<bool>(),
            shift in prop::sample::select(vec![0.0, 1e-15, 1e-12, 3e-10, 1e-8, 1e-6]),
            before in prop::array::uniform3(-3.0..3.0_f64),
        ) {
            let beta = if up { FRAC_PI_2 - shift } else { shift - FRAC_PI_2 };
            let rotation = rotation_of([outer[0], beta, outer[1]], ORDERS[order]);
            let found = euler_angles(rotation, ORDERS[order], before);
            prop_assert!(angle_between(rotation_of(found, ORDERS[order]), rotation) < ROUNDING);
            if shift < 1e-10 {
                prop_assert_eq!(found[0], before[0]);
            }
        }
    }

    #[test]
    fn angles_pass_half_a_turn_without_a_jump() {
        let order = [Axis::Z, Axis::X, Axis::Y];
        let mut before = [0.0; 3];
        for step in 1..200 {
            let angles = [0.1 * f64::from(step), 1.4, -0.05 * f64::from(step)];
            let found = euler_angles(rotation_of(angles, order), order, before);
            for (found, expected) in found.iter().zip(angles) {
                assert!((found - expected).abs() < 1e-9);
            }
            before = found;
        }
    }
}
