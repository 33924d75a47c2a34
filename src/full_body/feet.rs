//! Feet that do not slide: the exact pass over the legs.
//!
//! Source: Kovar, Schreiner & Gleicher, *Footskate Cleanup for Motion Capture Editing*, SCA 2002.

use glam::DVec3;

use crate::full_body::chain::{Chain, EndPose, Place};
use crate::full_body::plants::{Displacement, LegTrack};
use crate::full_body::limb::softened;
use crate::geometry::{exp, smoothstep};
use crate::skeleton::{Pose, Skeleton};

/// A displacement below this is none, metres and radians: rounding, which a straight knee would magnify.
pub const NOTHING: f64 = 1e-9;

/// Where a foot displaced by `displacement` stands.
pub fn displaced(moved: &Place, displacement: &Displacement) -> EndPose {
    EndPose {
        position: moved.limb.lower + displacement.shift,
        rotation: exp(displacement.turn) * moved.lower_rotation,
    }
}

/// Direction in which the middle joint of a limb lies from the line between its ends, in the axes of the upper joint: the
/// mean over `places`, so that a straight limb knows how to bend. Zero for a limb that is always straight.
pub fn bend_hint<'a>(places: impl Iterator<Item = &'a Place>) -> DVec3 {
    places.map(|place| place.upper_rotation.inverse() * bend(place)).sum::<DVec3>().normalize_or_zero()
}

/// From the line between the ends of a limb to its middle joint.
fn bend(place: &Place) -> DVec3 {
    let along = (place.limb.lower - place.limb.upper).normalize_or_zero();
    (place.limb.middle - place.limb.upper).reject_from(along)
}

/// A middle joint farther than this from the line between the ends of its limb tells the direction alone, share of the
/// limb's length.
const TELLING: f64 = 0.05;

/// Brings a limb, which is at `place` in `pose`, to `target`; how far it stays away, metres.
///
/// The plane of the limb turns with the line between its ends. Where it was nearly straight and has to bend, `hint` (in
/// the axes of the upper joint) decides to which side.
pub fn solve(chain: &Chain, skeleton: &Skeleton, pose: &mut Pose, place: &Place, target: &EndPose, hint: DVec3) -> f64 {
    let limb = place.limb;
    let length: f64 = limb.lengths().iter().sum();
    let to_target = target.position - limb.upper;
    let distance = to_target.length();
    let spanned = limb.upper.distance(limb.lower);
    // What is captured stays reachable as it is.
    let goal = distance;
    let aim = limb.upper + to_target * (goal / distance.max(f64::MIN_POSITIVE));
    let turn = crate::full_body::limb::minimal_rotation(limb.lower - limb.upper, to_target);
    let own = bend(place);
    let straight = 1.0 - smoothstep(own.length() / (TELLING * length));
    let missing = (bent(limb.lengths(), goal) - own.length()).max(0.0);
    let pole = turn * (own + place.upper_rotation * hint * (straight * missing));
    let reach = limb.reach(aim, pole);
    chain.turn(skeleton, pose, place, (reach.middle, reach.lower, target.rotation));
    reach.lower.distance(target.position)
}

/// Distance of the middle joint from the line between the ends of a limb that spans `distance`.
fn bent([upper, lower]: [f64; 2], distance: f64) -> f64 {
    let foot = (upper * upper - lower * lower + distance * distance) / (2.0 * distance.max(f64::MIN_POSITIVE));
    (upper * upper - foot * foot).max(0.0).sqrt()
}

/// Displacements of the foot in its plants; none elsewhere.
pub fn planted(leg: &LegTrack, plants: &[crate::full_body::plants::Plant]) -> Vec<Displacement> {
    let mut displacements = vec![Displacement::default(); leg.rest.len()];
    for plant in plants {
        for at in plant.first..=plant.last {
            let target = plant.carry(&leg.rest[at]);
            let moved = &leg.moved[at];
            displacements[at] = Displacement {
                shift: target.position - moved.limb.lower,
                turn: crate::geometry::log(target.rotation * moved.lower_rotation.inverse()),
            };
        }
    }
    displacements
}
