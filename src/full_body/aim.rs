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
    chain.turn(
        skeleton,
        pose,
        place,
        reach.middle,
        &EndPose { position: reach.lower, rotation: target.rotation },
    );
    reach.shortfall
}
