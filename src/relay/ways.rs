//! The walks of carriers, and when they set out on them.

use std::collections::BTreeMap;

use super::acts::{Place, STATURE, Walks, turn};
use super::layout::{Acts, Carrier, Part};
use crate::geometry::{c64, cis};

/// Gives everybody the walks that come nearest to their ways. Those of others are as much longer as who walks is taller.
pub fn walk(carriers: &mut [Carrier], acts: &mut Acts) {
    let (mut carries, mut backs) = (Walks::with_box(), Walks::back());
    let mut besides = BTreeMap::new();
    for carrier in carriers {
        let way = (carrier.give.position - carrier.take.position).norm() * STATURE / carrier.stature;
        let turned = match carrier.part {
            Part::First | Part::Between(_) => None,
            Part::Middle(turned) | Part::Last(turned) => Some(turned),
        };
        let beside = *besides.entry(turned).or_insert_with(|| beside_walk(turned, acts));
        let along = (way * way - beside.im * beside.im).max(0.0).sqrt();
        carrier.walk = carries.nearest((along - beside.re).max(SHORTEST));
        if let Part::Between(back) = &mut carrier.part {
            back.walk = backs.nearest(way);
        }
    }
    (acts.carries, acts.backs) = (carries.into_chosen(), backs.into_chosen());
}

/// No way with a box is shorter, metres.
const SHORTEST: f64 = 0.5;

/// How far a carrier gets from where it grasps a box to where it lets go without the walk between, along the walk and to its left.
/// `turned`: with the box, degrees, if it takes it from somebody.
fn beside_walk(turned: Option<i32>, acts: &Acts) -> c64 {
    let origin = Place { position: c64::new(0.0, 0.0), facing: 0.0 };
    let grasps = if turned.is_some() { &acts.take_over } else { &acts.pick_up };
    let grasped = grasps.end(grasps.start(grasps.event("grasp"), origin));
    let ready = turned.map_or(grasped, |degrees| turn(degrees, true).end(grasped));
    let gives = &acts.hand_over;
    ready.position * cis(-ready.facing) + gives.at(origin, gives.event("release"))
}

/// When everybody sets off with a box and lets it go, as the clips of all before them last; who is back waits until the box
/// before comes. `beginnings`: of each box, seconds.
pub fn wait_for_boxes(carriers: &mut [Carrier], beginnings: &[f64], acts: &Acts) {
    /// From the beginning of a hand-over to its moment, and on to its end: a second each.
    const HALF: f64 = 1.0;
    let mut known = BTreeMap::new();
    let mut turning = |degrees: i32, with_box: bool| -> f64 {
        *known.entry((degrees, with_box)).or_insert_with(|| turn(degrees, with_box).seconds())
    };
    let mut released = 0.0;
    for carrier in carriers {
        let begins = beginnings[carrier.load];
        (carrier.sets_off, carrier.turning) = match carrier.part {
            Part::First | Part::Between(_) => (begins + acts.pick_up.seconds(), 0.0),
            Part::Middle(turned) | Part::Last(turned) => {
                let turning = turning(turned, true);
                (released + HALF + turning, turning)
            }
        };
        carrier.gives = carrier.sets_off + acts.carries[carrier.walk].seconds() + HALF;
        if let Part::Between(back) = &mut carrier.part {
            let turned = back.facing.map_or(0.0, |degrees| turning(degrees, false));
            let way = acts.about.seconds() + acts.backs[back.walk].seconds();
            let ready = carrier.gives - begins + HALF + way + turned;
            let before = beginnings[carrier.load - 1];
            back.wait = (2.0 * (released - before - HALF - ready)).round().max(2.0) / 2.0;
        }
        released = carrier.gives;
    }
}
