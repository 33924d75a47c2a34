//! Why whole contacts are not pinned: a heel's contact lasts until the ankle is a hand's breadth up, a toe's until the toe is;
//! meanwhile the foot rolls.
//!
//! Let heel and toe, `l` apart, both bear at frames `f` and `g`, and let the foot point there along `c_f` and `c_g`, `R` apart.
//! Held within `d` of one place each, it points within `asin(2d/l)` of one direction at both, so at one of them by at least
//! `R/2 − asin(2d/l)` otherwise than captured. Where a foot points is a product of the rotations of the joints from the root
//! to the ankle: with `n` of them, one turns by at least an `n`-th of that.

use std::path::Path;

use cotillion::clip::contacts::runs;
use cotillion::full_body::chain::{Chain, legs};
use cotillion::full_body::plants::{FEET, bearing};
use cotillion::skeleton::{Pose, Skeleton};
use glam::DVec3;
use libtest_mimic::Failed;

use crate::clips::{Stretch, load};
use crate::{DRIFT, PINNED_CHANGE, tell, whole};

/// Goes up a slope, turns there, and comes back.
pub(crate) const ROLLS: &str = "bvh/snu_walk_to_slope_and_back.bvh";

pub(crate) fn rolls_too_far_to_be_held(folder: &Path, file: &str) -> Result<(), Failed> {
    let walk = load(folder, file)?;
    let least = least_turn(&whole(&walk)).to_degrees();
    tell(&format!("{file}: to hold whole contacts some joint turns by at least {least:.2} degrees"));
    if least > PINNED_CHANGE.to_degrees() { Ok(()) } else { Err(format!("only {least}°").into()) }
}

/// By how much some joint must turn to hold all contacts from end to end, radians.
fn least_turn(stretch: &Stretch) -> f64 {
    let skeleton = stretch.walk.skeleton();
    let limbs = legs(skeleton).into_iter().zip(FEET).filter_map(|(leg, soles)| Some((leg?, soles)));
    let of_leg = |(leg, soles)| {
        let [heel, toe] = bearing(stretch.contacts, soles);
        let both: Vec<bool> = heel.into_iter().zip(toe).map(|(heel, toe)| heel && toe).collect();
        let turns = runs(&both)
            .into_iter()
            .map(|(first, last)| least_turn_of_foot(skeleton, &leg, &stretch.rest[first..=last]));
        turns.fold(0.0, f64::max) / joints_above(skeleton, &leg) as f64
    };
    limbs.map(of_leg).fold(0.0, f64::max)
}

fn least_turn_of_foot(skeleton: &Skeleton, leg: &Chain, poses: &[Pose]) -> f64 {
    let foot = |pose: &Pose| -> DVec3 {
        let place = leg.place(skeleton, pose);
        place.end - place.limb.lower
    };
    let feet: Vec<DVec3> = poses.iter().map(foot).collect();
    let ranges = feet.iter().flat_map(|foot| feet.iter().map(|other| foot.angle_between(*other)));
    let slack = |foot: &DVec3| (2.0 * DRIFT / foot.length()).asin();
    0.5 * ranges.fold(0.0, f64::max) - feet.iter().map(slack).fold(0.0, f64::max)
}

/// How many joints turn a foot: its ankle, and all from there to the root.
fn joints_above(skeleton: &Skeleton, leg: &Chain) -> usize {
    let mut joint = Some(leg.lower);
    let mut count = 0;
    while let Some(at) = joint {
        count += 1;
        joint = skeleton.joints[at.as_usize()].parent;
    }
    count
}
