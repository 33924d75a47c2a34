//! What it turns the joints of a leg by to hold a point of its foot somewhere else than captured.

use glam::{DMat3, DQuat, DVec3};

use crate::full_body::chain::Place;
use crate::full_body::fade::Span;
use crate::geometry::{exp, log};
use crate::limb::{Limb, minimal_rotation};

/// Passes of the search for the place of least turn.
const PASSES: usize = 20;
/// Weights stay above this, so that no system is singular.
const LEAST_WEIGHT: f64 = 1e-12;
/// Knees straighter than this count as so bent, sine.
const STRAIGHTEST: f64 = 0.1;

/// Turns of the joints of a leg, to first order, where one point of its foot is shifted and the foot turns as suits them
/// best: hip, knee, ankle and the foot itself by the least sum of squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Least {
    /// `δᵀ cost δ`: that sum for a shift `δ` of the point, radians² by metres².
    pub cost: DMat3,
    /// By which rotation vector the foot turns, radians a metre.
    pub turn: DMat3,
}

/// For the point `lever` away from the ankle, metres.
///
/// The ankle is shifted by `s = δ + lever × w`, `w` the turn of the foot; thigh and shin turn by `Θ s` and `Ψ s`, the knee by
/// `K s`. Minimised over `w`: `|Θ s|² + |K s|² + |w − Ψ s|² + |w|²`.
pub fn least(place: &Place, lever: DVec3) -> Least {
    let [thigh, knee, shin] = turns_by_metre(place);
    let swung = cross(lever);
    let by_turn = [thigh * swung, knee * swung, DMat3::IDENTITY - shin * swung, DMat3::IDENTITY];
    let by_shift = [thigh, knee, shin * -1.0, DMat3::ZERO];
    let sum = |a: &[DMat3; 4], b: &[DMat3; 4]| -> DMat3 {
        a.iter().zip(b).map(|(a, b)| a.transpose() * *b).fold(DMat3::ZERO, |sum, term| sum + term)
    };
    let mixed = sum(&by_turn, &by_shift);
    let turn = sum(&by_turn, &by_turn).inverse() * mixed * -1.0;
    Least { cost: sum(&by_shift, &by_shift) + mixed.transpose() * turn, turn }
}

/// Rotation vectors of thigh, knee and shin, radians a metre by which the ankle is shifted.
fn turns_by_metre(place: &Place) -> [DMat3; 3] {
    let limb = place.limb;
    let [upper, lower] = limb.lengths();
    let leg = limb.lower - limb.upper;
    let distance = leg.length().max(STRAIGHTEST * (upper + lower));
    let along = leg.normalize_or_zero();
    let bow = upper.max(lower) * STRAIGHTEST;
    let height = limb.bow().length().max(bow);
    let axis = along.cross(limb.bow()).normalize_or_zero();
    let swing = cross(along) * (1.0 / distance);
    // Bones of lengths a and b over the line of length D at height h: D = √(a² − h²) + √(b² − h²).
    let share = |bone: f64| (bone * bone - height * height).max(0.0).sqrt() / (height * distance);
    let bent = |radians: f64| outer(axis, along) * radians;
    let (thigh, shin) = (share(lower), share(upper));
    [swing - bent(thigh), bent(thigh + shin), swing + bent(shin)]
}

/// `a ↦ v × a`.
fn cross(v: DVec3) -> DMat3 {
    DMat3::from_cols(v.cross(DVec3::X), v.cross(DVec3::Y), v.cross(DVec3::Z))
}

/// `a bᵀ`.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// How far a joint of the leg turns when the ankle is shifted and the foot turned, radians: hip, knee, or ankle. No turn is
/// enough where the leg does not reach.
pub fn largest_turn(place: &Place, shift: DVec3, turn: DVec3) -> f64 {
    let limb = place.limb;
    let target = limb.lower + shift;
    let distance = limb.upper.distance(target);
    let length: f64 = limb.lengths().iter().sum();
    if distance > length && distance > limb.upper.distance(limb.lower) {
        return f64::INFINITY;
    }
    let [thigh, shin] = turned_bones(&limb, target);
    let knee = limb.bend_at(distance) - limb.bend();
    let ankle = log(exp(turn) * shin.inverse());
    log(thigh).length().max(knee.abs()).max(ankle.length())
}

/// Rotations of thigh and shin where the ankle goes to `target`: with the line from hip to ankle, then within their plane.
fn turned_bones(limb: &Limb, target: DVec3) -> [DQuat; 2] {
    let to = limb.reach(target, limb.bow());
    let swing = minimal_rotation(limb.lower - limb.upper, to.lower - limb.upper);
    let bones = [
        (limb.middle - limb.upper, to.middle - limb.upper),
        (limb.lower - limb.middle, to.lower - to.middle),
    ];
    bones.map(|(from, to)| minimal_rotation(swing * from, to) * swing)
}

/// The place for a point of the foot that turns the joints of the leg least, all along `span`: the smallest largest of
/// `costs`, one for each of its samples like `points`.
///
/// Source: weights after Lawson (Rice & Usow, *The Lawson Algorithm and Extensions*, Math. Comp. 1968).
pub fn least_turn(costs: &[Least], points: &[DVec3], span: Span) -> DVec3 {
    let costs: Vec<(DMat3, DVec3)> =
        (span.first..=span.last).map(|at| (costs[at].cost, points[at])).collect();
    let mut weights = vec![1.0; costs.len()];
    let mut best = points[span.first];
    for _ in 0..PASSES {
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for ((cost, point), weight) in costs.iter().zip(&weights) {
            matrix += *cost * *weight;
            right += *cost * *point * *weight;
        }
        best = matrix.inverse() * right;
        let lengths: Vec<f64> = costs
            .iter()
            .map(|(cost, point)| (*cost * (best - *point)).dot(best - *point).max(0.0).sqrt())
            .collect();
        let total: f64 = lengths.iter().zip(&weights).map(|(length, weight)| length * weight).sum();
        if total < f64::MIN_POSITIVE {
            break;
        }
        for (weight, length) in weights.iter_mut().zip(lengths) {
            *weight = (*weight * length / total).max(LEAST_WEIGHT);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Second order of shifts of a tenth of a millimetre, radians a metre.
    const SECOND_ORDER: f64 = 0.05;
    /// Of a few operations.
    const ROUNDING: f64 = 1e-12;
    /// Metres.
    const STEP: f64 = 1e-4;

    /// A leg bent by `bend`, radians, its hip a metre up, its foot ahead of the ankle.
    fn leg(bend: f64, heading: f64) -> Place {
        let turn = DQuat::from_rotation_y(heading);
        let upper = DVec3::Y;
        let middle = upper + turn * DVec3::new(0.0, -0.45, 0.1).normalize() * 0.45;
        let bone = turn * DQuat::from_rotation_x(bend) * turn.inverse() * (middle - upper).normalize();
        let lower = middle + bone * 0.43;
        Place {
            limb: Limb { upper, middle, lower },
            upper_rotation: turn,
            lower_rotation: turn,
            end: lower + turn * DVec3::new(0.0, -0.05, 0.15),
        }
    }

    /// Sum of the squares that [`least`] makes least, of shift `shift` and turn `turn`, with all joints moved.
    fn squares(place: &Place, shift: DVec3, turn: DVec3) -> f64 {
        let limb = place.limb;
        let [thigh, shin] = turned_bones(&limb, limb.lower + shift).map(log);
        let knee = limb.bend_at(limb.upper.distance(limb.lower + shift)) - limb.bend();
        thigh.length_squared() + knee * knee + (turn - shin).length_squared() + turn.length_squared()
    }

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0_f64).prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn the_foot_turns_as_costs_least(
            bend in 0.3..1.5_f64,
            heading in -3.0..3.0_f64,
            at_toe in any::<bool>(),
            (shift, other) in (vector(), vector()),
        ) {
            let place = leg(bend, heading);
            let lever = if at_toe { place.end - place.limb.lower } else { DVec3::ZERO };
            let least = least(&place, lever);
            let by = |turn: DVec3| squares(&place, STEP * shift + lever.cross(turn), turn).sqrt() / STEP;
            let turn = least.turn * (STEP * shift);
            let expected = (least.cost * shift).dot(shift).max(0.0).sqrt();
            prop_assert!((by(turn) - expected).abs() < SECOND_ORDER, "{} {expected}", by(turn));
            prop_assert!(by(turn) < by(turn + STEP * other) + SECOND_ORDER);
        }

        #[test]
        fn a_place_in_the_middle_turns_the_leg_least(bend in 0.3..1.5_f64, shift in vector()) {
            let place = leg(bend, 0.0);
            let costs = [least(&place, DVec3::ZERO); 3];
            let ankle = place.limb.lower;
            let points = [ankle - 0.01 * shift, ankle + 0.004 * shift, ankle + 0.01 * shift];
            let middle = least_turn(&costs, &points, Span { first: 0, last: 2 });
            prop_assert!(middle.distance(ankle) < 1e-3 * shift.length(), "{middle} {ankle}");
        }
    }

    #[test]
    fn what_moves_nothing_turns_nothing_and_what_is_out_of_reach_no_turn_reaches() {
        let place = leg(0.4, 1.0);
        assert!(largest_turn(&place, DVec3::ZERO, DVec3::ZERO) < ROUNDING);
        assert_eq!(largest_turn(&place, DVec3::NEG_Y, DVec3::ZERO), f64::INFINITY);
    }
}
