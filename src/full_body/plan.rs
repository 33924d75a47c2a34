//! What is to become of the feet of one body: where they stand, as captured or still, before anything brings them there.

use glam::DVec3;

use crate::clip::working::WORKING_STEP;
use crate::full_body::BodyInput;
use crate::full_body::aim::{Mobility, solve};
use crate::full_body::chain::{Chain, EndPose, Place, bearing_arms, legs};
use crate::full_body::feet::{FADE, Leg, STRETCH, TOLERATED, from_to};
use crate::full_body::pins::{Pins, Standing};
use crate::full_body::plants::{Displacement, FEET, HANDS, LegTrack, Soles, bearing, plants};
use crate::full_body::reach::{Demand, drops};
use crate::full_body::seams::stand_through;
use crate::full_body::smooth::accelerations_over;
use crate::geometry::log;
use crate::index::JointId;
use crate::skeleton::{Pose, Skeleton};

/// Feet that are held gently turn no joint farther than this, radians: just below 5°.
const GENTLE_TURN: f64 = 0.084;

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

/// The same where all of a contact is to be held.
const WHOLE_POPS: f64 = 1.5;

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
        rolls: vec![false; track.rest.len()],
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

/// Holds all contacts of `leg`, which stood as captured. The leg stretches no farther for it: the body comes down instead; held by its
/// toe alone the foot may roll about it.
fn hold_whole(leg: &mut Leg, pins: Pins) {
    leg.rolls = pins.heel.iter().zip(&pins.toe).map(|(heel, toe)| *toe && !*heel).collect();
    leg.planted = [pins.heel, pins.toe];
    leg.corrections = Some(pins.corrections);
}

/// A foot held still.
pub struct Still<'a> {
    limb: &'a Limb,
    standing: Standing<'a>,
    /// What tells what of a contact can be held; none where all of it is.
    trial: Option<Trial>,
}

/// A captured leg that is not edited, on which is tried what holding its foot still does.
struct Trial {
    /// What becomes of the leg, its displacements as captured, and what was found of it.
    unedited: Leg,
    as_captured: Vec<Displacement>,
    tried: Vec<Tried>,
}

/// One sample of a captured leg with its foot held still.
#[derive(Clone, Copy)]
struct Tried {
    goal: Option<EndPose>,
    place: Place,
    turns_too_far: bool,
}

impl<'a> Still<'a> {
    /// What of it can be held while no joint turns by 5°. Cost: linear in samples times the places that a foot stands on within one
    /// contact.
    pub fn gentle(skeleton: &Skeleton, input: &'a BodyInput, limb: &'a Limb) -> Self {
        let moved = places(skeleton, &limb.chain, &input.rest);
        let track = LegTrack { moved, ..limb.track.clone() };
        let unedited = planned(&input.times, limb, track);
        let as_captured = unedited.displacements.clone();
        let untried = |place: &Place| Tried { goal: None, place: *place, turns_too_far: false };
        let tried = unedited.track.moved.iter().map(untried).collect();
        let standing = Standing::gentle(&input.times, &limb.track, GENTLE_TURN);
        let mut still = Self { limb, standing, trial: Some(Trial { unedited, as_captured, tried }) };
        still.settle(skeleton, input);
        still
    }

    /// All of its contacts, from the first sample to the last. Cost: linear.
    pub fn whole(input: &'a BodyInput, limb: &'a Limb) -> Self {
        Self { limb, standing: Standing::whole(&input.times, &limb.track), trial: None }
    }

    /// The edited leg.
    pub fn leg(&self, times: &[f64]) -> Leg {
        let mut leg = self.limb.leg(times);
        let pins = self.standing.pins(FADE);
        if self.trial.is_some() {
            hold(&mut leg, pins)
        } else {
            hold_whole(&mut leg, pins)
        }
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
        let Some(trial) = &mut self.trial else { return };
        for _ in 0..RELEASES {
            trial.unedited.displacements.clone_from(&trial.as_captured);
            hold(&mut trial.unedited, self.standing.pins(FADE));
            trial.unedited.fill(&input.times);
            if !self.standing.release(&trial.strained(skeleton, &input.times, &input.rest)) {
                break;
            }
        }
    }
}

impl Trial {
    /// Where a joint of the captured leg turns too far, its knee is jerked harder than captured, its foot
    /// sinks, or the body had to come down. Cost: linear; poses are solved only where they are others than before.
    fn strained(&mut self, skeleton: &Skeleton, times: &[f64], rest: &[Pose]) -> Vec<bool> {
        let leg = &self.unedited;
        let still = vec![DVec3::ZERO; times.len()];
        for ((tried, goal), rest) in self.tried.iter_mut().zip(leg.goals(times, &still)).zip(rest) {
            if tried.goal != goal {
                *tried = retried(skeleton, leg, rest, goal, GENTLE_TURN);
            }
        }
        let demands: Vec<Demand> = (0..times.len()).map(|at| leg.demand(at)).collect();
        let drops = drops(times, &[demands], &still, FADE);
        let sinks = sinks(&leg.track.rest, &self.tried);
        let most = HARDEST * hardest(times, &leg.track.rest);
        let jerked = jerked(times, self.tried.iter().map(|tried| tried.place), most);
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

/// Where the knee (or the elbow) is jerked harder than `most`, radians/s², and not gently.
fn jerked(times: &[f64], places: impl Iterator<Item = Place>, most: f64) -> Vec<bool> {
    let bends: Vec<f64> = places.map(|place| place.limb.bend()).collect();
    let bends = accelerations_over(times, &bends, WORKING_STEP);
    bends.into_iter().map(|acceleration| acceleration > most.max(GENTLE)).collect()
}

/// How hard the knee is jerked as captured, radians/s².
fn hardest(times: &[f64], rest: &[Place]) -> f64 {
    let captured: Vec<f64> = rest.iter().map(|place| place.limb.bend()).collect();
    accelerations_over(times, &captured, WORKING_STEP).into_iter().fold(0.0, f64::max)
}

/// Where the knee of each leg is jerked much harder than captured in `poses`.
pub fn popped(skeleton: &Skeleton, input: &BodyInput, legs: &[Leg], poses: &[Pose]) -> Vec<Vec<bool>> {
    let times = &input.times;
    let of_leg = |leg: &Leg| {
        let places = poses.iter().map(|pose| leg.chain.place(skeleton, pose));
        jerked(times, places, POPS * hardest(times, &leg.track.rest))
    };
    legs.iter().map(of_leg).collect()
}

/// How hard the limbs of a motion are jerked: largest angular accelerations, radians/s².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jerks {
    /// Of either knee.
    pub knees: f64,
    /// Of either elbow.
    pub elbows: f64,
}

impl Jerks {
    /// Those of `poses`, one for each of `times`, seconds, which rise. Cost: linear.
    pub fn of(skeleton: &Skeleton, times: &[f64], poses: &[Pose]) -> Self {
        let of_limbs = |limbs: [Option<Chain>; 2]| {
            let limbs = limbs.into_iter().flatten();
            limbs.map(|limb| hardest(times, &places(skeleton, &limb, poses))).fold(0.0, f64::max)
        };
        Self { knees: of_limbs(legs(skeleton)), elbows: of_limbs(bearing_arms(skeleton)) }
    }

    /// The harder ones of both.
    pub const fn max(self, other: Self) -> Self {
        Self { knees: self.knees.max(other.knees), elbows: self.elbows.max(other.elbows) }
    }
}

/// Where a foot held all along jerks its knee half as hard again as the motion it comes from does any, or does not reach where it is
/// held; hands and elbows alike.
pub fn overstrained(skeleton: &Skeleton, input: &BodyInput, legs: &[Leg], poses: &[Pose]) -> Vec<Vec<bool>> {
    let times = &input.times;
    let hardest_of = |arms: bool| {
        let alike = legs.iter().filter(|leg| leg.is_arm() == arms);
        alike.map(|leg| hardest(times, &leg.track.rest)).fold(0.0, f64::max)
    };
    let shown = Jerks { knees: hardest_of(false), elbows: hardest_of(true) };
    let Jerks { knees, elbows } = shown.max(input.source);
    let of_leg = |leg: &Leg| {
        let most = if leg.is_arm() { elbows } else { knees };
        let places: Vec<Place> = poses.iter().map(|pose| leg.chain.place(skeleton, pose)).collect();
        let misses = |at: usize| leg.stands(at) && leg.miss(at, &places[at]) > TOLERATED;
        let jerked = jerked(times, places.iter().copied(), WHOLE_POPS * most);
        jerked.into_iter().enumerate().map(|(at, jerked)| jerked || misses(at)).collect()
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
