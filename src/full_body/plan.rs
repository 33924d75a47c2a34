//! What is to become of the feet of one body: where they stand, as captured or still, before anything brings them there.

use glam::DVec3;

use crate::clip::working::WORKING_STEP;
use crate::full_body::BodyInput;
use crate::full_body::aim::{Mobility, solve};
use crate::full_body::chain::{Chain, EndPose, Place, bearing_arms, legs};
use crate::full_body::feet::{FADE, Leg, STRETCH, from_to};
use crate::full_body::pins::{Pins, Standing};
use crate::full_body::plants::{Displacement, FEET, HANDS, LegTrack, Soles, bearing, plants};
use crate::full_body::reach::{Demand, drops};
use crate::full_body::seams::stand_through;
use crate::full_body::smooth::accelerations_over;
use crate::geometry::log;
use crate::index::JointId;
use crate::skeleton::{Pose, Skeleton};

/// Turns of which no less is tried, radians: just below 5°.
pub const GENTLE_TURN: f64 = 0.084;

/// Rounds in which what cannot be held still is let go.
const RELEASES: usize = 30;

/// Held still, a foot jerks its knee at most so many times as hard as the capture does: edits add to it.
const HARDEST: f64 = 1.0;

/// Limbs that hardly move as captured may be jerked so hard, radians/s²: a tenth of what knees do in a walk.
const GENTLE: f64 = 10.0;

/// Held still, a foot comes no farther below its lowest captured place than this, metres.
const SUNK: f64 = 3e-3;

/// The body comes down by less than this for nothing, metres.
const NO_DROP: f64 = 1e-4;

/// Edited, knees may be jerked so many times as hard as captured before the feet by which they are let go.
const POPS: f64 = 1.4;

/// A limb that bears, and where it is.
pub struct Limb {
    chain: Chain,
    soles: Soles,
    mobility: Mobility,
    track: LegTrack,
}

/// Both legs, then the arms whose hands bear; those that the skeleton lacks are left out.
pub fn limbs(skeleton: &Skeleton, input: &BodyInput) -> Vec<Limb> {
    let bears = |soles: &Soles| bearing(&input.contacts, *soles).concat().contains(&true);
    let legs = legs(skeleton).into_iter().zip(FEET);
    let arms = bearing_arms(skeleton).into_iter().zip(HANDS).filter(|(_, soles)| bears(soles));
    let limb = |(chain, soles): (Chain, Soles)| {
        let [heel, toe] = bearing(&input.contacts, soles);
        let mut rest = places(skeleton, &chain, &input.rest);
        stand_through((skeleton, &chain), &input.seams, [&heel, &toe], &mut rest);
        let track = LegTrack { rest, moved: places(skeleton, &chain, &input.moved), heel, toe };
        Limb { chain, soles, mobility: Mobility::of(skeleton, &chain, track.rest.iter()), track }
    };
    legs.chain(arms).filter_map(|(chain, soles)| Some((chain?, soles))).map(limb).collect()
}

fn places(skeleton: &Skeleton, chain: &Chain, poses: &[Pose]) -> Vec<Place> {
    poses.iter().map(|pose| chain.place(skeleton, pose)).collect()
}

impl Limb {
    /// What is to become of it with its foot as captured, before anything holds it still.
    pub fn leg(&self, times: &[f64]) -> Leg {
        planned(times, self, self.track.clone())
    }
}

fn planned(times: &[f64], limb: &Limb, track: LegTrack) -> Leg {
    Leg {
        chain: limb.chain,
        soles: limb.soles,
        displacements: displacements(times, &track),
        corrections: None,
        aimed: vec![false; track.rest.len()],
        bound: track.bears(),
        planted: [track.heel.clone(), track.toe.clone()],
        reaches: reaches(&track, None),
        mobility: limb.mobility,
        track,
    }
}

/// Holds `leg` still, which stood as captured. What is held has no slope where it is let go.
fn hold(leg: &mut Leg, pins: Pins) {
    leg.reaches = reaches(&leg.track, Some(&pins.corrections));
    leg.planted = [pins.heel, pins.toe];
    leg.corrections = Some(pins.corrections);
}

/// A foot held still.
pub struct Still<'a> {
    limb: &'a Limb,
    standing: Standing<'a>,
    /// What becomes of the leg where nothing is edited, its displacements as captured, and what was found of it.
    unedited: Leg,
    as_captured: Vec<Displacement>,
    tried: Vec<Tried>,
    largest_turn: f64,
}

/// One sample of a captured leg with its foot held still.
#[derive(Clone, Copy)]
struct Tried {
    goal: Option<EndPose>,
    place: Place,
    turns_too_far: bool,
}

impl<'a> Still<'a> {
    /// What of it can be held while no joint turns farther than `largest_turn`, radians. Who may turn far jerks knees by it and
    /// may hold less: it is tried with half of that, too, and so on down to [`GENTLE_TURN`], and each step is held as long as any
    /// of them can. Cost: linear in samples times the places that a foot stands on within one contact, for each try.
    pub fn new(skeleton: &Skeleton, input: &'a BodyInput, limb: &'a Limb, largest_turn: f64) -> Self {
        let mut tries = vec![Self::within(skeleton, input, limb, largest_turn)];
        let mut turn = largest_turn;
        while turn > GENTLE_TURN {
            turn = (0.5 * turn).max(GENTLE_TURN);
            tries.push(Self::within(skeleton, input, limb, turn));
        }
        if tries.len() > 1 {
            let mut joined = Self::within(skeleton, input, limb, largest_turn);
            for gentler in &tries[1..] {
                joined.standing.prefer(&gentler.standing);
            }
            joined.settle(skeleton, input);
            tries.push(joined);
        }
        let most_held = tries.into_iter().max_by_key(|still| still.standing.count());
        most_held.expect("tried at least once")
    }

    fn within(skeleton: &Skeleton, input: &'a BodyInput, limb: &'a Limb, largest_turn: f64) -> Self {
        let moved = places(skeleton, &limb.chain, &input.rest);
        let track = LegTrack { moved, ..limb.track.clone() };
        let unedited = planned(&input.times, limb, track);
        let as_captured = unedited.displacements.clone();
        let untried = |place: &Place| Tried { goal: None, place: *place, turns_too_far: false };
        let tried = unedited.track.moved.iter().map(untried).collect();
        let standing = Standing::new(&input.times, &limb.track, largest_turn);
        let mut still = Self { limb, standing, unedited, as_captured, tried, largest_turn };
        still.settle(skeleton, input);
        still
    }

    /// The edited leg.
    pub fn leg(&self, times: &[f64]) -> Leg {
        let mut leg = self.limb.leg(times);
        hold(&mut leg, self.standing.pins(FADE));
        leg
    }

    /// Lets go of what is held next to where it is `refused`; says whether anything was.
    pub fn release(&mut self, skeleton: &Skeleton, input: &BodyInput, refused: &[bool]) -> bool {
        let any = self.standing.release(refused);
        if any {
            self.settle(skeleton, input);
        }
        any
    }

    /// Keeps what does nothing bad to the captured leg where nothing is edited: where a joint would turn too far or the body had
    /// to come down, the nearest held samples are let go.
    fn settle(&mut self, skeleton: &Skeleton, input: &BodyInput) {
        for _ in 0..RELEASES {
            self.unedited.displacements.clone_from(&self.as_captured);
            hold(&mut self.unedited, self.standing.pins(FADE));
            self.unedited.fill(&input.times);
            let strained = self.strained(skeleton, &input.times, &input.rest);
            if !self.standing.release(&strained) {
                break;
            }
        }
    }

    /// Where a joint of the captured leg turns too far, its knee is jerked harder than captured, its foot
    /// sinks, or the body had to come down. Cost: linear; poses are solved only where they are others than before.
    fn strained(&mut self, skeleton: &Skeleton, times: &[f64], rest: &[Pose]) -> Vec<bool> {
        let leg = &self.unedited;
        let still = vec![DVec3::ZERO; times.len()];
        for ((tried, goal), rest) in self.tried.iter_mut().zip(leg.goals(times, &still)).zip(rest) {
            if tried.goal != goal {
                *tried = retried(skeleton, leg, rest, goal, self.largest_turn);
            }
        }
        let demands: Vec<Demand> = (0..times.len()).map(|at| leg.demand(at)).collect();
        let drops = drops(times, &[demands], &still, FADE);
        let sinks = sinks(&leg.track.rest, &self.tried);
        let jerked = jerked(times, &leg.track.rest, self.tried.iter().map(|tried| tried.place), HARDEST);
        let strained = self.tried.iter().zip(drops).zip(sinks.into_iter().zip(jerked));
        strained
            .map(|((tried, drop), (sinks, jerked))| tried.turns_too_far || drop > NO_DROP || sinks || jerked)
            .collect()
    }
}

fn retried(skeleton: &Skeleton, leg: &Leg, rest: &Pose, goal: Option<EndPose>, largest_turn: f64) -> Tried {
    let mut pose = rest.clone();
    let place = leg.chain.place(skeleton, rest);
    if let Some(goal) = goal {
        solve(&leg.chain, skeleton, &mut pose, (&place, &goal), &leg.mobility);
    }
    let turn = |joint: JointId| {
        let joint = joint.as_usize();
        log(rest.rotations[joint].inverse() * pose.rotations[joint]).length()
    };
    let joints = [leg.chain.upper, leg.chain.middle, leg.chain.lower];
    let turns_too_far = joints.into_iter().any(|joint| turn(joint) > largest_turn);
    Tried { goal, place: leg.chain.place(skeleton, &pose), turns_too_far }
}

/// Where the foot comes below the lowest captured place.
fn sinks(rest: &[Place], tried: &[Tried]) -> Vec<bool> {
    let height = |place: &Place| place.limb.lower.y.min(place.end.y);
    let lowest = rest.iter().map(height).fold(f64::INFINITY, f64::min);
    tried.iter().map(|tried| height(&tried.place) < lowest - SUNK).collect()
}

/// Where the knee (or the elbow) is jerked more than `most` times as hard as captured, and not gently.
fn jerked(times: &[f64], rest: &[Place], places: impl Iterator<Item = Place>, most: f64) -> Vec<bool> {
    let captured: Vec<f64> = rest.iter().map(|place| place.limb.bend()).collect();
    let bends: Vec<f64> = places.map(|place| place.limb.bend()).collect();
    let hardest = accelerations_over(times, &captured, WORKING_STEP).into_iter().fold(0.0, f64::max);
    let most = (most * hardest).max(GENTLE);
    let bends = accelerations_over(times, &bends, WORKING_STEP);
    bends.into_iter().map(|acceleration| acceleration > most).collect()
}

/// Where the knee of each leg is jerked much harder than captured in `poses`.
pub fn popped(skeleton: &Skeleton, times: &[f64], legs: &[Leg], poses: &[Pose]) -> Vec<Vec<bool>> {
    let of_leg = |leg: &Leg| {
        let places = poses.iter().map(|pose| leg.chain.place(skeleton, pose));
        jerked(times, &leg.track.rest, places, POPS)
    };
    legs.iter().map(of_leg).collect()
}

/// Displacements of the foot in its plants, as captured; none elsewhere.
fn displacements(times: &[f64], track: &LegTrack) -> Vec<Displacement> {
    let mut displacements = vec![[DVec3::ZERO; 2]; track.rest.len()];
    for plant in plants(times, track) {
        let frames = plant.span.first..=plant.span.last;
        let places = track.moved[frames.clone()].iter().zip(&track.rest[frames.clone()]);
        for (displacement, (moved, rest)) in displacements[frames].iter_mut().zip(places) {
            *displacement = from_to(&moved.end_pose(), &plant.carry(&rest.end_pose()));
        }
    }
    displacements
}

/// How far the leg may stretch at each sample, metres: as captured (and held still), or nearly straight.
fn reaches(track: &LegTrack, corrections: Option<&[Displacement]>) -> Vec<f64> {
    let reach = |(at, place): (usize, &Place)| {
        let limb = &place.limb;
        let length: f64 = limb.lengths().iter().sum();
        let held = corrections.map_or(limb.lower, |corrections| limb.lower + corrections[at][0]);
        limb.upper.distance(limb.lower).max(limb.upper.distance(held).min(length)).max(STRETCH * length)
    };
    track.rest.iter().enumerate().map(reach).collect()
}
