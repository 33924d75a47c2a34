//! Hands and feet where they must be: the poses of an edited track corrected sample by sample.
//!
//! An edit moves and turns the root, joint angles stay: feet slide, hands miss. [`refine`] puts that right. Feet that bear
//! stand as captured, on ground that moves as a whole with the edit; between, their displacement goes over from one plant
//! to the next. So do hands that are stated to bear. Trunks and heads turn as asked before. Where limbs do not reach, the body
//! comes down, smoothly, or follows, no farther and faster than it can. Hands go where else they must by hierarchical
//! displacements. What an edit does not touch comes out bit for bit as it went in.
//!
//! Sources: Kovar, Schreiner & Gleicher, *Footskate Cleanup for Motion Capture Editing*, SCA 2002; Lee & Shin, *A
//! Hierarchical Approach to Interactive Motion Editing for Human-like Figures*, SIGGRAPH 1999.

pub mod displacement;
pub mod smooth;
pub mod chain;
pub mod limits;
pub mod wrist;
pub mod aim;
pub mod hinge;
pub mod fade;
pub mod plants;
pub mod turning;
pub mod holding;
pub mod whole;
pub mod pins;
pub mod seams;
pub mod reach;
pub mod knee_program;
pub mod knees;
pub mod feet;
pub mod ground;
pub mod rolling;
pub mod plan;
pub mod effector;
pub mod hierarchical;
pub mod trunk;
pub mod pull;
pub mod report;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_bones;
#[cfg(test)]
mod tests_of_turns;

use glam::DVec3;

use crate::clip::contacts::Contacts;
use crate::full_body::chain::{Chain, EndPose, bearing_arms};
use crate::full_body::displacement::Sample;
pub use crate::full_body::effector::{Effector, Part, Target};
use crate::full_body::feet::{FADE, Leg};
use crate::full_body::hierarchical::{CLOSE, KNOTS, blended, bring, bring_beside, level, sample};
pub use crate::full_body::plan::Jerks;
use crate::full_body::plan::{Still, limbs, overstrained, popped};
use crate::full_body::reach::{Demand, Demands, drops, within_reach};
pub use crate::full_body::report::{BodyReport, JointChange, PlantedPoint, Shortfall, WholeContact};
pub use crate::full_body::seams::{Cut, Seams};
use crate::full_body::trunk::turn_trunk;
use crate::skeleton::{Pose, Skeleton};

/// One character at successive moments: output frames, and constrained moments between them.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyInput {
    /// Seconds, rising; at least one.
    pub times: Vec<f64>,
    /// As captured and placed, before the edit; one a moment, like all below.
    pub rest: Vec<Pose>,
    /// With the root where the edit has it.
    pub moved: Vec<Pose>,
    /// Which points of the feet and hands bear.
    pub contacts: Vec<Contacts>,
    /// Ends of the body that must be somewhere.
    pub effectors: Vec<Effector>,
    /// Where the motion before the edit is not as captured but joined.
    pub seams: Seams,
    /// How hard the limbs of the clips are jerked that `rest` shows parts of; nothing where it shows all of them.
    pub source: Jerks,
}

/// How feet stand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PlantMode {
    /// As the capture has them, with its own small drift: an edit that changes nothing changes nothing.
    #[default]
    AsCaptured,
    /// Perfectly still, at the points that turn the joints least, and as long as that turns none by 5°.
    Pinned,
    /// Perfectly still from the first sample of each contact to its last, at the points that turn the joints least, however far.
    Whole,
}

/// What [`refine`] makes of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// One a moment.
    pub poses: Vec<Pose>,
    /// Which points of the feet and hands are planted: the contacts, and of these only what stands in [`PlantMode::Pinned`].
    pub planted: Vec<Contacts>,
    /// What was done, and what could not be.
    pub report: BodyReport,
}

/// Sweeps over the place of the body: hands may pull it where feet do not reach, and the other way round.
const SWEEPS: usize = 3;

/// Rounds in which feet held still are let go where the edit is too much for their legs.
const RELEASES: usize = 3;

/// Corrects the poses of one character. Cost: linear in moments.
///
/// # Panics
/// If the lists of `input` differ in length or an effector has targets beyond them; poses must be of `skeleton`.
pub fn refine(skeleton: &Skeleton, input: &BodyInput, mode: PlantMode) -> Refined {
    let count = input.times.len();
    let lengths = [input.rest.len(), input.moved.len(), input.contacts.len()];
    assert_eq!(lengths, [count; 3], "one pose before and after the edit and one contact a moment");
    let limbs = limbs(skeleton, input);
    let (legs, poses) = match mode {
        PlantMode::AsCaptured => {
            posed(skeleton, input, limbs.iter().map(|limb| limb.leg(&input.times)).collect())
        }
        PlantMode::Pinned => {
            let still = |limb| Still::gentle(skeleton, input, limb);
            held((skeleton, input), limbs.iter().map(still).collect(), popped)
        }
        PlantMode::Whole => {
            let still = |limb| Still::whole(input, limb);
            held((skeleton, input), limbs.iter().map(still).collect(), overstrained)
        }
    };
    let planted = feet::planted(&legs, &input.contacts);
    let report = report::report(skeleton, input, (&legs, &planted), &poses);
    Refined { poses, planted, report }
}

/// Where what the feet do in poses is too much, for each leg.
type Refused = fn(&Skeleton, &BodyInput, &[Leg], &[Pose]) -> Vec<Vec<bool>>;

/// With `feet` held still, but about where that is refused.
fn held(
    (skeleton, input): (&Skeleton, &BodyInput),
    mut feet: Vec<Still>,
    refused: Refused,
) -> (Vec<Leg>, Vec<Pose>) {
    let posed =
        |feet: &[Still]| posed(skeleton, input, feet.iter().map(|foot| foot.leg(&input.times)).collect());
    let (mut legs, mut poses) = posed(&feet);
    for _ in 0..RELEASES {
        let refused = refused(skeleton, input, &legs, &poses);
        let mut any = false;
        for (foot, refused) in feet.iter_mut().zip(refused) {
            any |= foot.release(skeleton, input, &refused);
        }
        if !any {
            break;
        }
        (legs, poses) = posed(&feet);
    }
    (legs, poses)
}

/// The poses with each of `legs` where it is planned to be, and every other end where it must be.
fn posed(skeleton: &Skeleton, input: &BodyInput, mut legs: Vec<Leg>) -> (Vec<Leg>, Vec<Pose>) {
    bind_feet(skeleton, input, &mut legs);
    let mut poses = input.moved.clone();
    if turn_trunk(skeleton, &input.times, &input.effectors, &mut poses) {
        legs.iter_mut().for_each(|leg| leg.hang(skeleton, &poses));
    }
    let shifts = body_shifts((skeleton, &poses), input, &legs);
    for (pose, shift) in poses.iter_mut().zip(&shifts) {
        pose.root += *shift;
    }
    for leg in &legs {
        leg.solve(skeleton, &input.times, &shifts, &mut poses);
    }
    for leg in &legs {
        let is_beside =
            |end: &&Effector| end.part(skeleton, &leg.chain).is_some_and(|part| part != Part::End);
        let effectors: Vec<&Effector> = input.effectors.iter().filter(is_beside).collect();
        bring_beside(skeleton, &input.times, leg, &effectors, &mut poses);
        if has_targets(skeleton, input, &leg.chain) {
            leg.clear_ground(skeleton, &mut poses);
        }
    }
    let limbs: Vec<Chain> = bearing_arms(skeleton).into_iter().flatten().collect();
    for limb in limbs.iter().filter(|limb| !legs.iter().any(|leg| leg.chain == **limb)) {
        let of_limb = |end: &&Effector| end.part(skeleton, limb).is_some();
        let effectors: Vec<&Effector> = input.effectors.iter().filter(of_limb).collect();
        bring(skeleton, &input.times, limb, &effectors, &mut poses);
    }
    (legs, poses)
}

/// Effectors on feet, on hands that bear elsewhere in time, and on the bones above them go before their plants, which let go
/// about them.
fn bind_feet(skeleton: &Skeleton, input: &BodyInput, legs: &mut [Leg]) {
    for leg in legs {
        let chain = leg.chain;
        let own = input.effectors.iter().filter(|end| end.part(skeleton, &chain).is_some());
        let (ends, above): (Vec<&Effector>, Vec<&Effector>) =
            own.partition(|end| end.part(skeleton, &chain) == Some(Part::End));
        let above = above.into_iter().flat_map(|end| end.first..end.first + end.targets.len());
        leg.let_go(&input.times, above);
        let target = |end: &Effector, at: usize| {
            let place = |target| effector::end_pose(skeleton, &chain, &input.moved[at], (end.joint, target));
            end.at(at).map(|target| (at, place(target)))
        };
        let targets: Vec<(usize, EndPose)> =
            ends.into_iter().flat_map(|end| (end.first..).map_while(move |at| target(end, at))).collect();
        leg.bind(&input.times, &targets);
        leg.fill(&input.times);
        if has_targets(skeleton, input, &chain) {
            leg.keep_above_ground();
        }
    }
}

/// Whether any effector is on `limb`.
fn has_targets(skeleton: &Skeleton, input: &BodyInput, limb: &Chain) -> bool {
    input.effectors.iter().any(|end| end.part(skeleton, limb).is_some())
}

/// How the body, which is in `poses`, must be shifted so that feet and other ends reach: down for the feet, any way for the
/// others. Feet go first where not all can.
fn body_shifts((skeleton, poses): (&Skeleton, &[Pose]), input: &BodyInput, legs: &[Leg]) -> Vec<DVec3> {
    let times = &input.times;
    let feet: Vec<Vec<Demand>> =
        legs.iter().map(|leg| (0..times.len()).map(|at| leg.demand(at)).collect()).collect();
    let lowest = lowest_shifts(legs, times.len());
    let still = vec![DVec3::ZERO; times.len()];
    let own: Vec<Vec<Demand>> =
        legs.iter().zip(&feet).map(|(leg, foot)| leg.own_demands(times, foot)).collect();
    let base = lowered(times, (&own, &lowest), &still);
    let others = other_demands((skeleton, poses), input, legs);
    if others.is_empty() && own == feet {
        return base;
    }
    let all_demands = |(at, mut others): (usize, Vec<Demand>)| {
        let standing = |(leg, foot): (&Leg, &Vec<Demand>)| Some(foot[leg.standing_near(times, at)?]);
        let aimed = legs.iter().zip(&feet).filter(|(leg, _)| leg.aimed[at]);
        others.extend(aimed.map(|(_, foot)| foot[at]));
        let feet = legs.iter().zip(&feet).filter_map(standing).collect();
        (at, Demands { feet, others, lowest: lowest[at] })
    };
    let others: Vec<(usize, Demands)> = others.into_iter().map(all_demands).collect();
    let mut shifts = pulled_shifts(times, (legs, &feet), &lowest, &others);
    let stands: Vec<bool> = (0..times.len()).map(|at| legs.iter().any(|leg| leg.stands(at))).collect();
    let mut pulls: Vec<DVec3> = shifts.iter().zip(&base).map(|(shift, base)| *shift - *base).collect();
    if pull::bound(times, &stands, &mut pulls) {
        shifts = base.iter().zip(&pulls).map(|(base, pull)| *base + *pull).collect();
    }
    shifts
}

/// The same with all that `others` ask for, however far and fast it pulls the body where feet do not bear.
fn pulled_shifts(
    times: &[f64],
    (legs, feet): (&[Leg], &[Vec<Demand>]),
    lowest: &[f64],
    others: &[(usize, Demands)],
) -> Vec<DVec3> {
    let mut pulled = vec![DVec3::ZERO; times.len()];
    let mut shifts = lowered(times, (feet, lowest), &pulled);
    let missing = |shifts: &[DVec3]| -> Vec<(usize, [DVec3; 1])> {
        let miss = |at: usize, demands: &Demands| within_reach(demands, shifts[at]) - shifts[at];
        others.iter().map(|(at, demands)| (*at, [miss(*at, demands)])).collect()
    };
    for spacing in std::iter::repeat_n(KNOTS, SWEEPS).flatten() {
        let misses = missing(&shifts);
        if misses.iter().all(|(_, [miss])| miss.length() < CLOSE) {
            break;
        }
        let samples: Vec<Sample<3>> = misses.iter().map(|(at, miss)| sample(times[*at], miss)).collect();
        let spline = level(times, &samples, spacing);
        for (pull, time) in pulled.iter_mut().zip(times) {
            *pull += DVec3::from_array(spline.at(*time));
        }
        shifts = lowered(times, (feet, lowest), &pulled);
    }
    let exact = blended(times, &missing(&shifts));
    let pulled: Vec<bool> =
        pulled.iter().zip(&exact).map(|(pull, exact)| *pull + exact[0] != DVec3::ZERO).collect();
    for ((shift, exact), lowest) in shifts.iter_mut().zip(exact).zip(lowest) {
        *shift += exact[0];
        shift.y = shift.y.max(*lowest);
    }
    bring_back(times, &bearing_demands((legs, feet), lowest, &pulled), &mut shifts);
    shifts
}

/// What bearing feet ask of the body where hands have `pulled` it, by sample.
fn bearing_demands(
    (legs, feet): (&[Leg], &[Vec<Demand>]),
    lowest: &[f64],
    pulled: &[bool],
) -> Vec<(usize, Demands)> {
    let demands = |at: usize| {
        let bound = legs.iter().zip(feet).filter(|(leg, _)| leg.stands(at));
        let feet: Vec<Demand> = bound.map(|(_, foot)| foot[at]).collect();
        Demands { feet, others: Vec::new(), lowest: lowest[at] }
    };
    let pulled = (0..pulled.len()).filter(|&at| pulled[at]);
    pulled.map(|at| (at, demands(at))).filter(|(_, demands)| !demands.feet.is_empty()).collect()
}

/// Brings a body that hands have pulled away back to where its bearing feet reach: smoothly, then exactly.
fn bring_back(times: &[f64], bearing: &[(usize, Demands)], shifts: &mut [DVec3]) {
    for is_exact in [false, true] {
        let missing = |(at, demands): &(usize, Demands)| {
            let miss = within_reach(demands, shifts[*at]) - shifts[*at];
            (is_exact || miss.length() > CLOSE).then_some((*at, [miss]))
        };
        let misses: Vec<(usize, [DVec3; 1])> = bearing.iter().filter_map(missing).collect();
        for (shift, back) in shifts.iter_mut().zip(blended(times, &misses)) {
            *shift += back[0];
        }
    }
}

/// The lowest shift at each sample that leaves all knees above the ground, metres.
fn lowest_shifts(legs: &[Leg], count: usize) -> Vec<f64> {
    let mut lowest = vec![f64::INFINITY; count];
    for leg in legs {
        lowest.iter_mut().zip(leg.lowest_shifts()).for_each(|(lowest, own)| *lowest = lowest.min(own));
    }
    lowest.into_iter().map(|shift| if shift.is_finite() { shift } else { f64::NEG_INFINITY }).collect()
}

/// `pulled`, and down as far as the feet need it, but not below the lowest shift.
fn lowered(times: &[f64], (feet, lowest): (&[Vec<Demand>], &[f64]), pulled: &[DVec3]) -> Vec<DVec3> {
    let drops = drops(times, feet, pulled, FADE);
    let lowered = pulled.iter().zip(drops).map(|(pull, drop)| *pull - DVec3::Y * drop);
    lowered.zip(lowest).map(|(shift, lowest)| shift.with_y(shift.y.max(*lowest))).collect()
}

/// What the effectors that are on no foot ask of the body, by sample; samples without any are left out.
fn other_demands(
    (skeleton, poses): (&Skeleton, &[Pose]),
    input: &BodyInput,
    legs: &[Leg],
) -> Vec<(usize, Vec<Demand>)> {
    let feet: Vec<Chain> = legs.iter().filter(|leg| !leg.is_arm()).map(|leg| leg.chain).collect();
    let limbs: Vec<Chain> =
        bearing_arms(skeleton).into_iter().flatten().chain(feet.iter().copied()).collect();
    let is_foot = |end: &Effector| feet.iter().any(|leg| end.part(skeleton, leg) == Some(Part::End));
    let limb = |end: &Effector| limbs.iter().find(|limb| end.part(skeleton, limb).is_some());
    let ends: Vec<(&Effector, Option<&Chain>)> =
        input.effectors.iter().filter(|end| !is_foot(end)).map(|end| (end, limb(end))).collect();
    let demands = |at: usize| -> Vec<Demand> {
        ends.iter().filter_map(|(end, limb)| end.demand(skeleton, *limb, &poses[at], at)).collect()
    };
    (0..input.times.len()).map(|at| (at, demands(at))).filter(|(_, demands)| !demands.is_empty()).collect()
}
