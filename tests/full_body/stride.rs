//! Why whole contacts are not pinned, once more: what the leg would have to do for its heel to stay in one place from the
//! first frame of a contact to the last.
//!
//! The root stays where the path has it, so hips stay as captured. A heel within `d` of one place `p` all along: at each frame
//! the ankle is at some `a`, `|a − p| ≤ d`. Where no joint turns by more than `θ`, the knee's bend is within `θ` of the captured
//! one, so that the distance from the hip to `a` is between two spans of the leg; and the line from the hip to `a` is within
//! `θ` (of the hip) and `asin(2 l sin(θ/2)/D)` (of the knee; `l` the shin, `D` the captured distance from hip to ankle) of
//! the captured line. Boxes of places that some frame rules out as a whole are thrown away, the others halved; where none is left,
//! no place will do.

use std::path::Path;

use cotillion::clip::contacts::runs;
use cotillion::full_body::chain::{Place, legs};
use cotillion::full_body::plants::{FEET, bearing};
use cotillion::limb::Limb;
use glam::DVec3;
use libtest_mimic::Failed;

use crate::clips::{Stretch, load};
use crate::{DRIFT, PINNED_CHANGE, tell, whole};

/// The walks of CMU 16 and of SNU that cannot be held from end to end within 5°: all but two.
pub(crate) const STRIDES: [&str; 15] = [
    "amc/cmu_16_11_walk_veer_left.amc",
    "amc/cmu_16_13_walk_veer_right.amc",
    "amc/cmu_16_15_walk_straight.amc",
    "amc/cmu_16_17_walk_90_degree_left_turn.amc",
    "amc/cmu_16_19_walk_90_degree_right_turn.amc",
    "amc/cmu_16_33_slow_walk_then_stop.amc",
    "bvh/snu_cross_walk_90.bvh",
    "bvh/snu_slope_up_10.bvh",
    "bvh/snu_slope_up_16.bvh",
    "bvh/snu_spiral_walk_normal.bvh",
    "bvh/snu_u_turn.bvh",
    "bvh/snu_walk_stop_walk.bvh",
    "bvh/snu_walk_straight_normal.bvh",
    "bvh/snu_walk_to_slope_and_back.bvh",
    "bvh/snu_walk_turn_180.bvh",
];

/// Places are sought so far around where the heel is as captured, metres.
const AROUND: f64 = 0.25;
/// Boxes whose corners are nearer to their middles than this count as a place, metres.
const FINEST: f64 = 2.5e-4;
/// Turns of joints are told to this, radians: a tenth of a degree.
const STEP: f64 = 0.1 * std::f64::consts::PI / 180.0;
/// And up to this.
const MOST: f64 = 0.5;

pub(crate) fn strides_too_far_to_be_held(folder: &Path, file: &str) -> Result<(), Failed> {
    let walk = load(folder, file)?;
    let least = least_turn(&whole(&walk)).to_degrees();
    tell(&format!(
        "{file}: to hold its heels' whole contacts some joint turns by at least {least:.1} degrees"
    ));
    if least > PINNED_CHANGE.to_degrees() && least < MOST.to_degrees() {
        Ok(())
    } else {
        Err(format!("only {least}°").into())
    }
}

/// By how much some joint must turn to hold all contacts of heels from end to end, radians, to one [`STEP`] below.
fn least_turn(stretch: &Stretch) -> f64 {
    let skeleton = stretch.walk.skeleton();
    let limbs = legs(skeleton).into_iter().zip(FEET).filter_map(|(leg, soles)| Some((leg?, soles)));
    let contacts = limbs.flat_map(|(leg, soles)| {
        let places: Vec<Place> = stretch.rest.iter().map(|pose| leg.place(skeleton, pose)).collect();
        let [heel, _] = bearing(stretch.contacts, soles);
        let limbs =
            |(first, last): (usize, usize)| places[first..=last].iter().map(|place| place.limb).collect();
        runs(&heel).into_iter().map(limbs).collect::<Vec<Vec<Limb>>>()
    });
    contacts.map(|limbs| least_turn_of_contact(&limbs)).fold(0.0, f64::max)
}

fn least_turn_of_contact(limbs: &[Limb]) -> f64 {
    let mut least = 0.0;
    while least < MOST && is_ruled_out(limbs, least + STEP) {
        least += STEP;
    }
    least
}

/// Whether at no place the heel can stay all along without a turn by more than `turn`.
fn is_ruled_out(limbs: &[Limb], turn: f64) -> bool {
    let bounds: Vec<Bounds> = limbs.iter().map(|limb| Bounds::of(limb, turn)).collect();
    let low = limbs.iter().map(|limb| limb.lower).fold(DVec3::INFINITY, DVec3::min) - DVec3::splat(AROUND);
    let high =
        limbs.iter().map(|limb| limb.lower).fold(DVec3::NEG_INFINITY, DVec3::max) + DVec3::splat(AROUND);
    let mut boxes = vec![(0.5 * (low + high), 0.5 * (high - low))];
    while let Some((middle, half)) = boxes.pop() {
        if bounds.iter().any(|bounds| bounds.exclude(middle, half.length() + DRIFT)) {
            continue;
        }
        if half.length() < FINEST {
            return false;
        }
        let half = 0.5 * half;
        let eighths = (0..8).map(|corner| {
            let side = |axis: i32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
            (middle + half * DVec3::new(side(0), side(1), side(2)), half)
        });
        boxes.extend(eighths);
    }
    true
}

/// Where an ankle may be at one frame.
struct Bounds {
    hip: DVec3,
    /// Metres from the hip.
    spans: [f64; 2],
    /// From the hip to the captured ankle, and how far from that line, radians.
    line: (DVec3, f64),
}

impl Bounds {
    fn of(limb: &Limb, turn: f64) -> Self {
        let (bend, leg) = (limb.bend(), limb.lower - limb.upper);
        let nearest = limb.span_at((bend + turn).min(std::f64::consts::PI));
        let farthest = limb.span_at((bend - turn).max(0.0));
        let swung = (2.0 * limb.lengths()[1] * (0.5 * turn).sin() / leg.length()).min(1.0).asin();
        Self { hip: limb.upper, spans: [nearest, farthest], line: (leg.normalize(), turn + swung) }
    }

    /// Whether an ankle is nowhere within `radius` of `middle`.
    fn exclude(&self, middle: DVec3, radius: f64) -> bool {
        let away = middle - self.hip;
        let distance = away.length();
        let [nearest, farthest] = self.spans;
        let seen = if radius < distance { (radius / distance).asin() } else { std::f64::consts::PI };
        let (along, cone) = self.line;
        distance + radius < nearest || distance - radius > farthest || away.angle_between(along) - seen > cone
    }
}
