//! A limb of a pose brought to a target.

use glam::DVec3;

use crate::full_body::chain::{Chain, EndPose, Place};
use crate::geometry::smoothstep;
use crate::limb::minimal_rotation;
use crate::skeleton::{Pose, Skeleton};

/// Direction in which the middle joint of a limb lies from the line between its ends, in the axes of the upper joint: the
/// mean over `places`, so that a straight limb knows how to bend. Zero for a limb that is always straight.
pub fn bend_hint<'a>(places: impl Iterator<Item = &'a Place>) -> DVec3 {
    let own = |place: &Place| place.upper_rotation.inverse() * place.limb.bow();
    places.map(own).sum::<DVec3>().normalize_or_zero()
}

/// A middle joint farther than this from the line between the ends of its limb tells alone to which side it bends, share
/// of the limb's length.
const TELLING: f64 = 0.05;

/// Brings a limb, which is at `place` in `pose`, to `target`; how far it stays away, metres.
///
/// The plane of the limb turns with the line between its ends. Where it was nearly straight and has to bend, `hint` (in
/// the axes of the upper joint) decides to which side: knees and elbows never bend backwards.
pub fn solve(
    chain: &Chain,
    skeleton: &Skeleton,
    pose: &mut Pose,
    (place, target): (&Place, &EndPose),
    hint: DVec3,
) -> f64 {
    let limb = place.limb;
    let length: f64 = limb.lengths().iter().sum();
    let to_target = target.position - limb.upper;
    let turn = minimal_rotation(limb.lower - limb.upper, to_target);
    let own = limb.bow();
    let straight = 1.0 - smoothstep(own.length() / (TELLING * length));
    let missing = (limb.bow_at(to_target.length()) - own.length()).max(0.0);
    let pole = turn * (own + place.upper_rotation * hint * (straight * missing));
    let reach = limb.reach(target.position, pole);
    let end = EndPose { position: reach.lower, rotation: target.rotation };
    chain.turn(skeleton, pose, place, (reach.middle, &end));
    reach.shortfall
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::clip::builtin::generate;
    use crate::full_body::chain::legs;
    use crate::index::SourceFrame;

    /// A leg of the generated body, bent by `bend` about the axis that bends knees (backwards if negative).
    fn bent_leg(bend: f64) -> (Skeleton, Pose, Chain, DVec3) {
        let clip = generate("walk", &Default::default()).expect("a known clip");
        let skeleton = (*clip.skeleton).clone();
        let [Some(chain), _] = legs(&skeleton) else { panic!("the generated body has legs") };
        let walk: Vec<Place> = (0..clip.frame_count())
            .map(|frame| chain.place(&skeleton, &clip.pose(SourceFrame::from_usize(frame))))
            .collect();
        let mut pose = skeleton.rest_pose();
        pose.root = DVec3::Y;
        pose.rotations[chain.middle.as_usize()] = DQuat::from_rotation_x(bend);
        (skeleton, pose, chain, bend_hint(walk.iter()))
    }

    #[test]
    fn knees_bend_forwards_whether_they_were_straight_or_bent_a_little_backwards() {
        for bend in [0.0, -0.02, 0.02, 0.6] {
            let (skeleton, mut pose, chain, hint) = bent_leg(bend);
            let place = chain.place(&skeleton, &pose);
            let target = EndPose { position: place.limb.lower + DVec3::Y * 0.15, ..place.end_pose() };
            let shortfall = solve(&chain, &skeleton, &mut pose, (&place, &target), hint);
            let after = chain.place(&skeleton, &pose);
            assert!(shortfall < 1e-9 && after.limb.lower.distance(target.position) < 1e-9);
            // The body faces +z.
            assert!(after.limb.bow().z > 0.1, "{bend}: {}", after.limb.bow());
            assert!(after.lower_rotation.dot(target.rotation).abs() > 1.0 - 1e-12);
        }
    }

    #[test]
    fn the_plane_of_a_bent_limb_turns_no_farther_than_its_ends() {
        let (skeleton, mut pose, chain, hint) = bent_leg(0.6);
        let place = chain.place(&skeleton, &pose);
        let target = EndPose { position: place.limb.lower + DVec3::new(0.1, 0.05, 0.2), ..place.end_pose() };
        solve(&chain, &skeleton, &mut pose, (&place, &target), hint);
        let after = chain.place(&skeleton, &pose).limb;
        let turn = minimal_rotation(place.limb.lower - place.limb.upper, after.lower - after.upper);
        assert!((turn * place.limb.bow()).angle_between(after.bow()) < 1e-9);
    }
}
