//! A limb of two bones brought to a target, analytically; its swivel is kept.

use glam::{DQuat, DVec3};

/// Share of the limb's length between whose ends it bends and beyond which it is softened.
const SOFT_SHARE: f64 = 0.02;
/// Distances nearer than this to a straight or a folded limb are none, share of its length.
const NEAREST: f64 = 1e-9;

/// A limb: hip, knee and ankle, or shoulder, elbow and wrist, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// Upper joint, metres.
    pub upper: DVec3,
    /// Middle joint.
    pub middle: DVec3,
    /// Lower joint.
    pub lower: DVec3,
}

/// How a limb reaches its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Where the middle joint comes to lie.
    pub middle: DVec3,
    /// Where the lower joint comes to lie: the target, or the point nearest to it that the limb reaches.
    pub lower: DVec3,
    /// How far the lower joint stays from the target, metres.
    pub shortfall: f64,
}

impl Limb {
    /// Lengths of the upper and of the lower bone, metres.
    pub fn lengths(&self) -> [f64; 2] {
        [self.upper.distance(self.middle), self.middle.distance(self.lower)]
    }

    /// The middle joint that brings the lower one to `target`, in the half plane where `pole`, a direction, lies.
    ///
    /// `D = |T − A|` clamped to what the bones span; `a = (l₁² − l₂² + D²)/(2D)`, `r = √(l₁² − a²)`,
    /// `K = A + a·u + r·n` with `u` towards the target and `n` the part of the pole perpendicular to it.
    ///
    /// Source: Lee & Shin, *A Hierarchical Approach to Interactive Motion Editing for Human-like Figures*, SIGGRAPH 1999, §5.
    pub fn reach(&self, target: DVec3, pole: DVec3) -> Reach {
        let [upper, lower] = self.lengths();
        let to_target = target - self.upper;
        let distance = to_target.length();
        let margin = NEAREST * (upper + lower);
        let spanned = distance.min(upper + lower - margin).max((upper - lower).abs() + margin);
        let along = to_target.try_normalize().unwrap_or(DVec3::NEG_Y);
        let across = perpendicular(pole, along);
        let foot = (upper * upper - lower * lower + spanned * spanned) / (2.0 * spanned);
        let height = (upper * upper - foot * foot).max(0.0).sqrt();
        let lower = self.upper + along * spanned;
        Reach {
            middle: self.upper + along * foot + across * height,
            lower,
            shortfall: lower.distance(target),
        }
    }

    /// Angle between its bones, radians: 0 for a straight limb.
    pub fn bend(&self) -> f64 {
        (self.middle - self.upper).angle_between(self.lower - self.middle)
    }

    /// The bend with which it spans `distance` between its ends, metres; straight or folded beyond what it spans.
    pub fn bend_at(&self, distance: f64) -> f64 {
        let [upper, lower] = self.lengths();
        ((distance * distance - upper * upper - lower * lower) / (2.0 * upper * lower))
            .clamp(-1.0, 1.0)
            .acos()
    }

    /// The distance of its ends, metres, at a bend.
    pub fn span_at(&self, bend: f64) -> f64 {
        let [upper, lower] = self.lengths();
        (upper * upper + lower * lower + 2.0 * upper * lower * bend.cos()).max(0.0).sqrt()
    }

    /// From the line between its ends to the middle joint, metres.
    pub fn bow(&self) -> DVec3 {
        let along = (self.lower - self.upper).normalize_or_zero();
        let upper = self.middle - self.upper;
        upper - along * upper.dot(along)
    }

    /// How far the middle joint is from the line between the ends when they are `distance` apart, metres.
    pub fn bow_at(&self, distance: f64) -> f64 {
        let [upper, lower] = self.lengths();
        let distance = distance.max(f64::MIN_POSITIVE);
        let foot = (upper * upper - lower * lower + distance * distance) / (2.0 * distance);
        (upper * upper - foot * foot).max(0.0).sqrt()
    }
}

/// Unit vector of the part of `direction` perpendicular to the unit vector `along`; any where there is none.
fn perpendicular(direction: DVec3, along: DVec3) -> DVec3 {
    direction.reject_from(along).try_normalize().unwrap_or_else(|| along.any_orthonormal_vector())
}

/// Smallest rotation that takes the direction of `from` to that of `to`.
pub fn minimal_rotation(from: DVec3, to: DVec3) -> DQuat {
    match (from.try_normalize(), to.try_normalize()) {
        (Some(from), Some(to)) => DQuat::from_rotation_arc(from, to),
        _ => DQuat::IDENTITY,
    }
}

/// The distance that a limb of `length` spans in place of `distance`, so that its middle joint does not snap straight:
/// beyond 98 % it goes slower and slower towards 100 %.
///
/// `D′ = .98 L + .02 L·(1 − exp(−(D − .98 L)/(.02 L)))`.
///
/// Source: Kovar, Schreiner & Gleicher, *Footskate Cleanup for Motion Capture Editing*, SCA 2002, §4.4.
pub fn softened(distance: f64, length: f64) -> f64 {
    let (start, room) = ((1.0 - SOFT_SHARE) * length, SOFT_SHARE * length);
    if distance <= start { distance } else { start - room * f64::exp_m1(-(distance - start) / room) }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Rounding of a few operations on metres.
    const ROUNDING: f64 = 1e-12;

    fn leg() -> Limb {
        Limb {
            upper: DVec3::new(0.0, 0.9, 0.0),
            middle: DVec3::new(0.0, 0.45, 0.0),
            lower: DVec3::new(0.0, 0.02, 0.0),
        }
    }

    #[test]
    fn a_knee_lies_where_the_reference_has_it() {
        let reach = leg().reach(DVec3::new(0.2, 0.08, 0.1), DVec3::new(1.0, 0.0, 0.2));
        let expected = DVec3::new(0.21095458820255, 0.50886823070717, 0.07081031539364);
        assert!(reach.middle.distance(expected) < 1e-13, "{}", reach.middle);
        assert!(reach.shortfall < ROUNDING);
    }

    proptest! {
        #[test]
        fn bones_keep_their_lengths_whatever_the_target(
            target in prop::array::uniform3(-3.0..3.0_f64),
            pole in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            let (leg, target) = (leg(), DVec3::from_array(target));
            let reach = leg.reach(target, DVec3::from_array(pole));
            let [upper, lower] = leg.lengths();
            prop_assert!((leg.upper.distance(reach.middle) - upper).abs() < ROUNDING);
            prop_assert!((reach.middle.distance(reach.lower) - lower).abs() < 1e-10);
            let distance = leg.upper.distance(target);
            let beyond = (distance - upper - lower).max((upper - lower).abs() - distance).max(0.0);
            prop_assert!((reach.shortfall - beyond).abs() < 1e-8);
        }

        #[test]
        fn a_limb_at_its_target_stays_as_it_is(bend in 0.05..2.5_f64, turn in -3.0..3.0_f64) {
            let turned = DQuat::from_rotation_y(turn);
            let middle = leg().upper + turned * DVec3::new(0.0, -0.45, 0.0);
            let lower = middle + turned * (DQuat::from_rotation_x(bend) * DVec3::new(0.0, -0.43, 0.0));
            let bent = Limb { upper: leg().upper, middle, lower };
            let reach = bent.reach(bent.lower, bent.bow());
            prop_assert!(reach.middle.distance(bent.middle) < 1e-9);
        }

        #[test]
        fn softened_distances_rise_smoothly_and_stay_below_the_length(distance in 0.0..3.0_f64) {
            let value = softened(distance, 0.88);
            prop_assert!(value <= 0.88 && value <= distance);
            let slope = (softened(distance + 1e-6, 0.88) - value) / 1e-6;
            prop_assert!((-1e-6..=1.0 + 1e-6).contains(&slope));
        }
    }
}
