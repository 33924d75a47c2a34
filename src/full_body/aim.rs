//! A limb of a pose brought to a target.

use glam::DVec3;

use crate::full_body::chain::{Chain, EndPose, Place};
use crate::full_body::limits::{Cone, MOST_BENT};
use crate::geometry::smoothstep;
use crate::limb::{Limb, minimal_rotation};
use crate::skeleton::{Pose, Skeleton};

/// How a limb can move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mobility {
    /// Direction in which its middle joint lies from the line between its ends, in the axes of the upper joint, so that a
    /// straight limb knows how to bend. Zero for a limb that is always straight.
    pub hint: DVec3,
    /// Where its upper bone stays.
    pub cone: Option<Cone>,
}

impl Mobility {
    /// Of a limb that is at `places` by itself: the hint is their mean.
    pub fn of<'a>(skeleton: &Skeleton, limb: &Chain, places: impl Iterator<Item = &'a Place>) -> Self {
        let own = |place: &Place| place.upper_rotation.inverse() * place.limb.bow();
        Self { hint: places.map(own).sum::<DVec3>().normalize_or_zero(), cone: Cone::of(skeleton, limb) }
    }
}

/// A middle joint farther than this from the line between the ends of its limb tells alone to which side it bends, share
/// of the limb's length.
pub const TELLING: f64 = 0.05;

/// Brings a limb, which is at `place` in `pose`, to `target`; how far it stays away, metres.
///
/// The plane of the limb turns with the line between its ends. Where it was nearly straight and has to bend, the hint
/// decides to which side: knees and elbows never bend backwards, fold no farther than [`MOST_BENT`], and the upper bone stays
/// in its cone, but for what the limb does in `place` already.
pub fn solve(
    chain: &Chain,
    skeleton: &Skeleton,
    pose: &mut Pose,
    (place, target): (&Place, &EndPose),
    mobility: &Mobility,
) -> f64 {
    let limb = place.limb;
    let length: f64 = limb.lengths().iter().sum();
    let aim = unfolded(&limb, target.position);
    let to_aim = aim - limb.upper;
    let turn = minimal_rotation(limb.lower - limb.upper, to_aim);
    let own = limb.bow();
    let straight = 1.0 - smoothstep(own.length() / (TELLING * length));
    let missing = (limb.bow_at(to_aim.length()) - own.length()).max(0.0);
    let pole = turn * (own + place.upper_rotation * mobility.hint * (straight * missing));
    let reach = limb.reach(aim, pole);
    let above = place.upper_rotation * pose.rotations[chain.upper.as_usize()].inverse();
    let joints = [reach.middle, reach.lower];
    let [middle, lower] = mobility.cone.map_or(joints, |cone| cone.clamp(above, &limb, joints));
    let end = EndPose { position: lower, rotation: target.rotation };
    chain.turn(skeleton, pose, place, (middle, &end));
    lower.distance(target.position)
}

/// `target`, or where it is nearer than a limb folds, the point behind it that it reaches.
fn unfolded(limb: &Limb, target: DVec3) -> DVec3 {
    let nearest = limb.span_at(MOST_BENT.max(limb.bend()));
    let to_target = target - limb.upper;
    if to_target.length() >= nearest {
        return target;
    }
    let along =
        to_target.try_normalize().unwrap_or_else(|| (limb.lower - limb.upper).normalize_or(DVec3::NEG_Y));
    limb.upper + along * nearest
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::clip::builtin::generate;
    use crate::full_body::chain::legs;
    use crate::index::SourceFrame;

    /// A leg of the generated body, bent by `bend` about the axis that bends knees (backwards if negative).
    fn bent_leg(bend: f64) -> (Skeleton, Pose, Chain, Mobility) {
        let clip = generate("walk", &Default::default()).expect("a known clip");
        let skeleton = (*clip.skeleton).clone();
        let [Some(chain), _] = legs(&skeleton) else { panic!("the generated body has legs") };
        let walk: Vec<Place> = (0..clip.frame_count())
            .map(|frame| chain.place(&skeleton, &clip.pose(SourceFrame::from_usize(frame))))
            .collect();
        let mut pose = skeleton.rest_pose();
        pose.root = DVec3::Y;
        pose.rotations[chain.middle.as_usize()] = DQuat::from_rotation_x(bend);
        let mobility = Mobility::of(&skeleton, &chain, walk.iter());
        (skeleton, pose, chain, mobility)
    }

    #[test]
    fn knees_bend_forwards_whether_they_were_straight_or_bent_a_little_backwards() {
        for bend in [0.0, -0.02, 0.02, 0.6] {
            let (skeleton, mut pose, chain, mobility) = bent_leg(bend);
            let place = chain.place(&skeleton, &pose);
            let target = EndPose { position: place.limb.lower + DVec3::Y * 0.15, ..place.end_pose() };
            let shortfall = solve(&chain, &skeleton, &mut pose, (&place, &target), &mobility);
            let after = chain.place(&skeleton, &pose);
            assert!(shortfall < 1e-9 && after.limb.lower.distance(target.position) < 1e-9);
            // The body faces +z.
            assert!(after.limb.bow().z > 0.1, "{bend}: {}", after.limb.bow());
            assert!(after.lower_rotation.dot(target.rotation).abs() > 1.0 - 1e-12);
        }
    }

    #[test]
    fn the_plane_of_a_bent_limb_turns_no_farther_than_its_ends() {
        let (skeleton, mut pose, chain, mobility) = bent_leg(0.6);
        let place = chain.place(&skeleton, &pose);
        let target = EndPose { position: place.limb.lower + DVec3::new(0.1, 0.05, 0.2), ..place.end_pose() };
        solve(&chain, &skeleton, &mut pose, (&place, &target), &mobility);
        let after = chain.place(&skeleton, &pose).limb;
        let turn = minimal_rotation(place.limb.lower - place.limb.upper, after.lower - after.upper);
        assert!((turn * place.limb.bow()).angle_between(after.bow()) < 1e-9);
    }

    #[test]
    fn a_knee_folds_no_farther_than_knees_do_and_what_is_missing_is_told() {
        let (skeleton, mut pose, chain, mobility) = bent_leg(0.6);
        let place = chain.place(&skeleton, &pose);
        let near = place.limb.upper + (place.limb.lower - place.limb.upper) * 0.05;
        let target = EndPose { position: near, ..place.end_pose() };
        let shortfall = solve(&chain, &skeleton, &mut pose, (&place, &target), &mobility);
        let after = chain.place(&skeleton, &pose).limb;
        assert!((after.bend() - MOST_BENT).abs() < 1e-6, "{}", after.bend());
        assert!(shortfall > 0.1 && (shortfall - after.lower.distance(near)).abs() < 1e-9, "{shortfall}");
    }

    #[test]
    fn a_thigh_goes_no_farther_back_than_thighs_do_unless_it_is_there_already() {
        let (skeleton, mut pose, chain, mobility) = bent_leg(0.6);
        let cone = mobility.cone.expect("the generated body stands at rest");
        let place = chain.place(&skeleton, &pose);
        // The body faces +z.
        let back = place.limb.upper + DVec3::new(0.0, 0.25, -0.7);
        let target = EndPose { position: back, ..place.end_pose() };
        let shortfall = solve(&chain, &skeleton, &mut pose, (&place, &target), &mobility);
        let after = chain.place(&skeleton, &pose);
        assert!(shortfall > 0.05, "{shortfall}");
        let bone = after.limb.middle - after.limb.upper;
        assert!((bone.angle_between(cone.axis) - cone.angle).abs() < 1e-6, "{bone}");
        let again = EndPose { position: after.limb.lower, ..after.end_pose() };
        assert!(solve(&chain, &skeleton, &mut pose, (&after, &again), &mobility) < 1e-9);
    }
}
