//! What hangs on a bone of a limb brought to a target by the bones alone; joints below keep their angles.
//!
//! A limb of two bones with a hand that is stiff is a limb of two bones again, but its middle joint is a hinge that is
//! straight and folded as its real bones are: in closed form.

use glam::{DQuat, DVec3};

use crate::full_body::aim::{Mobility, TELLING};
use crate::full_body::chain::{Chain, Place, turn_in_world, world_frame};
use crate::full_body::limits::MOST_BENT;
use crate::geometry::smoothstep;
use crate::index::JointId;
use crate::limb::{Limb, minimal_rotation};
use crate::skeleton::{Pose, Skeleton};

/// How far an end on the lower bone of a limb comes from its upper joint as its middle joint turns.
///
/// With the upper bone `u`, `w` from the middle joint to the end and a hinge `n ⊥ u` the distance at a turn Δ is
/// `D² = |u|² + |w|² + 2ρ cos(Δ − φ)`, `ρ cos φ = u·w`, `ρ sin φ = u·(n × w)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hinge {
    /// Unit vector, perpendicular to the upper bone; more turn is more bend.
    axis: DVec3,
    /// `|u|² + |w|²`.
    squares: f64,
    /// ρ.
    rise: f64,
    /// φ: the end is farthest.
    farthest: f64,
    /// The least and the most turn, radians: nothing is gained with less, and knees and elbows neither bend backwards nor fold
    /// farther than they do.
    turns: [f64; 2],
}

impl Hinge {
    /// Of a limb at `place`, for what is at `end`. `hint`: as in [`Mobility`].
    pub fn new(place: &Place, end: DVec3, hint: DVec3) -> Self {
        let limb = place.limb;
        let (upper, lower) = (limb.middle - limb.upper, end - limb.middle);
        let telling = TELLING * limb.lengths().iter().sum::<f64>();
        let own = limb.bow();
        let straight = 1.0 - smoothstep(own.length() / telling);
        let pole = own + place.upper_rotation * hint * (straight * telling);
        let axis =
            pole.cross(upper).try_normalize().unwrap_or_else(|| upper.any_orthogonal_vector().normalize());
        let (level, side) = (upper.dot(lower), upper.dot(axis.cross(lower)));
        let farthest = side.atan2(level);
        let bend = limb.bend();
        let least = farthest.max(-bend);
        Self {
            axis,
            squares: upper.length_squared() + lower.length_squared(),
            rise: level.hypot(side),
            farthest,
            turns: [least, (MOST_BENT - bend).max(0.0).max(least)],
        }
    }

    /// Distance of the end from the upper joint at a turn, metres.
    fn span(&self, turn: f64) -> f64 {
        (self.squares + 2.0 * self.rise * (turn - self.farthest).cos()).max(0.0).sqrt()
    }

    /// The nearest and the farthest that the end comes to the upper joint, metres.
    pub fn spans(&self) -> [f64; 2] {
        [self.span(self.turns[1]), self.span(self.turns[0])]
    }

    /// The turn with which the end is `distance` away, or as nearly as it comes, radians.
    fn turn_for(&self, distance: f64) -> f64 {
        let doubled = (distance * distance - self.squares) / (2.0 * self.rise.max(f64::MIN_POSITIVE));
        (self.farthest + doubled.clamp(-1.0, 1.0).acos()).clamp(self.turns[0], self.turns[1])
    }
}

/// Brings `joint`, which hangs on the lower bone of a limb of `pose`, to `target`: the middle joint bends as a hinge, the whole
/// limb turns the shortest way. The upper bone stays in its cone.
pub fn bring_lower(
    (chain, mobility): (&Chain, &Mobility),
    skeleton: &Skeleton,
    pose: &mut Pose,
    (joint, target): (JointId, DVec3),
) {
    let place = chain.place(skeleton, pose);
    let (limb, own) = (place.limb, world_frame(skeleton, pose, joint).position);
    let hinge = Hinge::new(&place, own, mobility.hint);
    let to_target = target - limb.upper;
    let bend = DQuat::from_axis_angle(hinge.axis, hinge.turn_for(to_target.length()));
    let bent = limb.middle + bend * (own - limb.middle);
    let whole = minimal_rotation(bent - limb.upper, to_target);
    let joints = [limb.middle, bent].map(|point| limb.upper + whole * (point - limb.upper));
    let above = above(chain, &place, pose);
    turn_in_world(skeleton, pose, chain.middle, bend);
    turn_in_world(skeleton, pose, chain.upper, whole);
    let stopped = mobility.cone.map_or(joints, |cone| cone.clamp(above, &limb, joints));
    if stopped != joints {
        let [[middle, end], [to_middle, to_end]] = [joints, stopped];
        let back = minimal_rotation(middle - limb.upper, to_middle - limb.upper);
        turn_in_world(skeleton, pose, chain.upper, back);
        let on = minimal_rotation(back * (end - middle), to_end - to_middle);
        turn_in_world(skeleton, pose, chain.middle, on);
    }
}

/// Turns the upper bone of a limb of `pose`, so that `joint`, which hangs on it, comes as near to `target` as it can. The bone
/// stays in its cone.
pub fn bring_upper(
    (chain, mobility): (&Chain, &Mobility),
    skeleton: &Skeleton,
    pose: &mut Pose,
    (joint, target): (JointId, DVec3),
) {
    let place = chain.place(skeleton, pose);
    let Limb { upper, middle, .. } = place.limb;
    let own = world_frame(skeleton, pose, joint).position;
    let turn = minimal_rotation(own - upper, target - upper);
    let bone = turn * (middle - upper);
    let above = above(chain, &place, pose);
    let stopped = mobility.cone.map_or(bone, |cone| cone.stop(above, &place.limb, bone));
    turn_in_world(skeleton, pose, chain.upper, minimal_rotation(bone, stopped) * turn);
}

/// Bends the middle joint of a limb of `pose` until its lower joint and its end are not below `ground`, their least heights, or as
/// far as it folds.
pub fn bend_above(
    (chain, mobility): (&Chain, &Mobility),
    skeleton: &Skeleton,
    pose: &mut Pose,
    ground: [f64; 2],
) {
    let place = chain.place(skeleton, pose);
    let middle = place.limb.middle;
    let axis = Hinge::new(&place, place.limb.lower, mobility.hint).axis;
    let turn = |(point, height): (DVec3, f64)| {
        let lever = point - middle;
        let along = axis * lever.dot(axis);
        let (across, aside) = (lever - along, axis.cross(lever));
        let wanted = height - middle.y - along.y;
        if across.y >= wanted {
            return 0.0;
        }
        let rise = across.y.hypot(aside.y).max(f64::MIN_POSITIVE);
        let top = aside.y.atan2(across.y);
        (top - (wanted / rise).min(1.0).acos()).rem_euclid(std::f64::consts::TAU)
    };
    let most = (MOST_BENT - place.limb.bend()).max(0.0);
    let bend = [place.limb.lower, place.end].into_iter().zip(ground).map(turn).fold(0.0, f64::max).min(most);
    if bend > 0.0 {
        turn_in_world(skeleton, pose, chain.middle, DQuat::from_axis_angle(axis, bend));
    }
}

/// From the axes of the joint that the limb hangs on to the world's.
fn above(chain: &Chain, place: &Place, pose: &Pose) -> DQuat {
    place.upper_rotation * pose.rotations[chain.upper.as_usize()].inverse()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::builtin::generate;
    use crate::full_body::chain::arms;
    use crate::skeleton::JointRole;

    /// Rounding of some turns, metres.
    const ROUNDING: f64 = 1e-9;

    /// A left arm bent by 0.6 at the elbow, its wrist by `wrist` about the same axis.
    fn arm(wrist: f64) -> (Skeleton, Pose, Chain, Mobility) {
        let clip = generate("walk", &Default::default()).expect("a known clip");
        let skeleton = (*clip.skeleton).clone();
        let [Some(chain), _] = arms(&skeleton) else { panic!("the generated body has arms") };
        let mut pose = clip.pose(crate::index::SourceFrame(0));
        let place = chain.place(&skeleton, &pose);
        let axis = (place.limb.middle - place.limb.upper).cross(place.limb.bow()).normalize();
        turn_in_world(&skeleton, &mut pose, chain.middle, DQuat::from_axis_angle(axis, -0.6));
        turn_in_world(&skeleton, &mut pose, chain.lower, DQuat::from_axis_angle(axis, wrist));
        let mobility = Mobility::of(&skeleton, &chain, [chain.place(&skeleton, &pose)].iter());
        (skeleton, pose, chain, mobility)
    }

    /// What hangs on the wrist farthest.
    fn tip(skeleton: &Skeleton, chain: &Chain) -> JointId {
        let mut last = (0..skeleton.joints.len()).map(JointId::from_usize);
        let is_below = |joint: &JointId| crate::full_body::chain::is_below(skeleton, *joint, chain.lower);
        last.rfind(is_below).unwrap_or(chain.lower)
    }

    #[test]
    fn fingers_come_to_a_target_and_the_wrist_keeps_its_angle() {
        for wrist in [-0.7, 0.0, 0.7] {
            let (skeleton, before, chain, mobility) = arm(wrist);
            let tip = tip(&skeleton, &chain);
            let shoulder = chain.place(&skeleton, &before).limb.upper;
            for offset in [DVec3::new(0.1, -0.2, 0.25), DVec3::new(0.2, 0.1, 0.2), DVec3::new(0.3, 0.0, 0.3)]
            {
                let (mut pose, target) = (before.clone(), shoulder + offset);
                bring_lower((&chain, &mobility), &skeleton, &mut pose, (tip, target));
                let miss = world_frame(&skeleton, &pose, tip).position.distance(target);
                assert!(miss < ROUNDING, "{wrist}, {offset}: {miss}");
                let lower = chain.lower.as_usize();
                assert_eq!(pose.rotations[lower], before.rotations[lower]);
            }
        }
    }

    #[test]
    fn an_elbow_is_straight_at_most_and_folds_no_farther_than_elbows_do() {
        for wrist in [-0.7, 0.7] {
            for distance in [0.0, 3.0] {
                let (skeleton, mut pose, chain, mobility) = arm(wrist);
                let tip = tip(&skeleton, &chain);
                let before = chain.place(&skeleton, &pose);
                let away = DVec3::new(1.0, 0.0, 1.0).normalize() * distance;
                bring_lower((&chain, &mobility), &skeleton, &mut pose, (tip, before.limb.upper + away));
                let after = chain.place(&skeleton, &pose);
                assert!(after.limb.bend() < MOST_BENT + 1e-6, "{}", after.limb.bend());
                let hinge = |place: &Place| {
                    let bow = place.limb.bow();
                    place.upper_rotation.inverse() * bow
                };
                assert!(hinge(&after).dot(hinge(&before)) > -ROUNDING, "elbows never bend backwards");
            }
        }
    }

    #[test]
    fn an_upper_arm_points_to_where_its_elbow_must_be_and_stops_in_its_cone() {
        let (skeleton, before, chain, mobility) = arm(0.3);
        let place = chain.place(&skeleton, &before);
        let shoulder = place.limb.upper;
        let elbow = skeleton.joint_of(JointRole::LeftElbow).expect("the generated body has elbows");
        let length = place.limb.lengths()[0];
        let mut pose = before.clone();
        let target = shoulder + DVec3::new(0.5, 0.3, 0.6).normalize() * length;
        bring_upper((&chain, &mobility), &skeleton, &mut pose, (elbow, target));
        assert!(world_frame(&skeleton, &pose, elbow).position.distance(target) < ROUNDING);
        assert_eq!(pose.rotations[chain.middle.as_usize()], before.rotations[chain.middle.as_usize()]);
        let cone = mobility.cone.expect("the generated body stands at rest");
        let axis = above(&chain, &place, &before) * cone.axis;
        let mut pose = before.clone();
        bring_upper((&chain, &mobility), &skeleton, &mut pose, (elbow, shoulder - axis * length));
        let bone = world_frame(&skeleton, &pose, elbow).position - shoulder;
        assert!((bone.angle_between(axis) - cone.angle).abs() < 1e-6, "{}", bone.angle_between(axis));
    }
}
