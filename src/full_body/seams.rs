//! Contacts at seams. Who stands on through a seam keeps the foot where it is: it drifts as the frames before the seam have it,
//! then as those after it. The shift that aligns the two runs is none of its drift, nor is what blending does to the foot of
//! a contact that begins or ends beside a seam.

use crate::clip::facing::turn_about_up;
use crate::full_body::chain::{Chain, Place};
use crate::full_body::pins::spans;
use crate::geometry::{RigidMotion, c64, plan_of};
use crate::skeleton::{Pose, Skeleton};

/// Where the motion before the edit goes on with frames that are not the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seams {
    /// As captured and placed, without the blends at seams: one pose a moment; none where there is no seam.
    pub unblended: Vec<Pose>,
    /// In the order of time.
    pub cuts: Vec<Cut>,
}

/// One seam.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// First moment after it.
    pub sample: usize,
    /// The two poses that it takes for one, as captured and placed: the last before it, and the one before the first after it.
    pub matched: [Pose; 2],
}

/// Puts a limb, which is at `rest` in the blended motion, where it stands in every contact that a seam cuts or whose frames it
/// blends; other contacts stay as they are. `bearing`: when its lower joint and its end bear. Cost: linear.
pub fn stand_through(
    (skeleton, chain): (&Skeleton, &Chain),
    seams: &Seams,
    bearing: [&[bool]; 2],
    rest: &mut [Place],
) {
    let labels = |at: usize| bearing.map(|bears| bears[at]);
    let any: Vec<bool> = (0..rest.len()).map(|at| labels(at).contains(&true)).collect();
    for span in spans(&any).into_iter().filter(|_| !seams.cuts.is_empty()) {
        let within = |cut: &&Cut| (span.first + 1..=span.last).contains(&cut.sample);
        let mut cuts = seams.cuts.iter().filter(within).peekable();
        let mut ground = RigidMotion::IDENTITY;
        for (at, place) in rest.iter_mut().enumerate().take(span.last + 1).skip(span.first) {
            while let Some(cut) = cuts.next_if(|cut| cut.sample <= at) {
                let [last, next] = cut.matched.each_ref().map(|pose| chain.place(skeleton, pose));
                ground = laid(&next, &last, labels(at)).then(&ground);
            }
            let shown = chain.place(skeleton, &seams.unblended[at]);
            if shown != *place || ground != RigidMotion::IDENTITY {
                let motion = laid(place, &shown, labels(at)).then(&ground);
                *place = place.carried(&motion);
            }
        }
    }
}

/// Motion of the ground that lays the foot `from` onto `to`, at the points that bear.
fn laid(from: &Place, to: &Place, bears: [bool; 2]) -> RigidMotion {
    let turn = turn_about_up(to.lower_rotation * from.lower_rotation.inverse());
    RigidMotion::carrying(standing_point(from, bears), standing_point(to, bears), turn)
}

fn standing_point(place: &Place, bears: [bool; 2]) -> c64 {
    let (lower, end) = (plan_of(place.limb.lower), plan_of(place.end));
    match bears {
        [true, false] => lower,
        [false, true] => end,
        _ => 0.5 * (lower + end),
    }
}
