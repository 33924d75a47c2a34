//! When a body stands on the ground, and when it flies.
//!
//! Heel, ball and tip of each foot are labelled each by itself: the tip carries the push-off for a while after the ball has left.
//! Labels for support (polygons, plants) and for flight are apart: what touches without supporting is neither. All thresholds are in
//! seconds and metres. Where feet stand on something higher than the floor (steps, slopes), labels go by that.

use std::sync::Arc;

use glam::DVec3;

use crate::clip::Clip;
use crate::clip::contacts::raised::RaisedGround;
use crate::clip::contacts::{
    BodyPoint, ContactPoint, ContactSettings, contact_point, drop_short, latched, runs, tidy,
};
use crate::clip::flight::other_joints;
use crate::clip::working::WorkingClip;
use crate::index::floor_index;
use crate::physics::ballistics::{FlightCheck, check_flight};
use crate::physics::body_model::BodyModel;
use crate::physics::posed::{PosedClip, centers_of_mass, link_places};
use crate::physics::sole::{Along, Side, Sole, SolePart, soles};
use crate::physics::support::{hull, slid};

/// When points of feet support, and when nothing touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageSettings {
    /// A point of a sole supports, or touches, below this height above its lowest, metres.
    pub height: f64,
    /// It supports below this speed, m/s.
    pub speed: f64,
    /// Support lasts up to this many times both thresholds.
    pub hysteresis: f64,
    /// Shorter supports are dropped, seconds.
    pub shortest: f64,
    /// Gaps up to this long are filled, seconds.
    pub longest_gap: f64,
    /// A point of a sole touches below this speed, m/s.
    pub touch_speed: f64,
    /// Any other joint touches below this height above the lowest sole point, metres.
    pub joint_height: f64,
    /// Shorter flights are ground, frames.
    pub shortest_flight: usize,
}

impl Default for StageSettings {
    fn default() -> Self {
        Self {
            height: 0.03,
            speed: 0.4,
            hysteresis: 1.4,
            shortest: 0.05,
            longest_gap: 0.067,
            touch_speed: 1.5,
            joint_height: 0.12,
            shortest_flight: 3,
        }
    }
}

/// What a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Something supports the body.
    Ground,
    /// Something touches, nothing supports: no polygon, no zero moment point.
    Touch,
    /// Nothing touches.
    Flight,
}

/// What of a body supports it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Bearer {
    Sole(Side, SolePart),
    Hand(Side),
}

/// Points of the body that support together, and when.
#[derive(Clone, Debug, PartialEq)]
pub struct Support {
    /// What they are.
    pub bearer: Bearer,
    /// Two of a sole, one of a hand.
    pub points: Vec<BodyPoint>,
    /// Whether they support, one a frame.
    pub bears: Vec<bool>,
}

/// Ground and flight of a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct Stages {
    /// Soles by which feet support.
    pub soles: Vec<Sole>,
    /// Heel, ball and tip of each foot, then hands whose contacts are stated.
    pub supports: Vec<Support>,
    /// One a frame.
    pub phases: Vec<Phase>,
    /// What flights of 0.2 s or more fall like; of those that an end of the clip cuts off too little is seen to tell.
    pub flights: Vec<FlightCheck>,
}

/// Ground and flight of `clip`, which `posed` has the frames of. The body's own soles are measured on it. Cost: linear in frames
/// times points and joints.
pub fn stages(clip: &Clip, body: &BodyModel, posed: &PosedClip, settings: &StageSettings) -> Stages {
    let soles = soles(&clip.skeleton, body, posed);
    let mut supports = Vec::new();
    let mut touches = vec![false; posed.frame_count()];
    let mut floor = f64::INFINITY;
    let levels = Levels::of(clip);
    for sole in &soles {
        for point in &sole.points {
            let along = Along::of_places(&middles(point.pair, posed), posed.fps);
            let lowest = along.lowest();
            floor = floor.min(lowest);
            let bearer = Bearer::Sole(sole.side, point.part);
            let over_ground = Along { heights: levels.over(bearer, &along.heights, lowest), ..along };
            mark_touching(&mut touches, &over_ground, (settings.height, settings.touch_speed));
            let bears = supporting(&over_ground, posed.fps, settings);
            supports.push(Support { bearer, points: point.pair.to_vec(), bears });
        }
    }
    for joint in other_joints(&clip.skeleton) {
        let along = Along::of(&joint, posed);
        mark_touching(&mut touches, &along, (floor + settings.joint_height, settings.touch_speed));
    }
    supports.extend(hands(clip));
    let phases = phases(&supports, &touches, settings);
    let mut stages = Stages { soles, supports, phases, flights: Vec::new() };
    stages.check_flights(body, posed);
    stages
}

/// Ground that is not the floor, by frames of a clip.
struct Levels {
    /// What rests there, first and last frame, height above the floor in metres.
    grounds: Vec<(ContactPoint, f64, f64, f64)>,
    /// How far in frames a ground reaches beyond the contact it was found by: the tip pushes off later than the ball.
    reach: f64,
}

/// See [`Levels::reach`], seconds.
const GROUND_REACH: f64 = 0.2;

impl Levels {
    fn of(clip: &Clip) -> Self {
        if clip.frame_count() == 0 {
            return Self { grounds: Vec::new(), reach: 0.0 };
        }
        let (first, last) = clip.usable;
        let working = WorkingClip::new(&clip.name, Arc::new(clip.clone()), first, last);
        let frame = |working_frame: usize| working.source_frame(working_frame as f64);
        let ground = |own: &RaisedGround| (own.point, frame(own.first), frame(own.last), own.height);
        Self { grounds: working.grounds.iter().map(ground).collect(), reach: GROUND_REACH * clip.fps }
    }

    /// Heights above the floor, which is at `lowest`, or how far from raised ground, whichever is less; metres.
    fn over(&self, bearer: Bearer, heights: &[f64], lowest: f64) -> Vec<f64> {
        let mut over: Vec<f64> = heights.iter().map(|height| height - lowest).collect();
        for (_, first, last, level) in self.grounds.iter().filter(|own| is_of(own.0, bearer)) {
            let from = floor_index((first - self.reach).ceil());
            let to = floor_index(last + self.reach).min(heights.len().saturating_sub(1));
            for frame in from..=to {
                over[frame] = over[frame].min((heights[frame] - lowest - level).abs());
            }
        }
        over
    }
}

/// Balls and tips stand where toes do.
fn is_of(point: ContactPoint, bearer: Bearer) -> bool {
    use ContactPoint::{LeftHeel, LeftToe, RightHeel, RightToe};
    match bearer {
        Bearer::Sole(Side::Left, SolePart::Heel) => point == LeftHeel,
        Bearer::Sole(Side::Left, _) => point == LeftToe,
        Bearer::Sole(Side::Right, SolePart::Heel) => point == RightHeel,
        Bearer::Sole(Side::Right, _) => point == RightToe,
        Bearer::Hand(_) => false,
    }
}

fn middles([a, b]: [BodyPoint; 2], posed: &PosedClip) -> Vec<DVec3> {
    let middle = BodyPoint { joint: a.joint, local: 0.5 * (a.local + b.local) };
    (0..posed.frame_count()).map(|frame| middle.place(posed.frame(frame))).collect()
}

/// `below`: height and speed.
fn mark_touching(touches: &mut [bool], along: &Along, below: (f64, f64)) {
    for (frame, touch) in touches.iter_mut().enumerate() {
        *touch |= along.heights[frame] < below.0 && along.speeds[frame] < below.1;
    }
}

/// `over_ground`: heights above what the point can stand on.
fn supporting(over_ground: &Along, fps: f64, settings: &StageSettings) -> Vec<bool> {
    let labelling = ContactSettings {
        speed: settings.speed,
        hysteresis: settings.hysteresis,
        shortest_contact: floor_index((settings.shortest * fps).ceil()),
        longest_gap: floor_index(settings.longest_gap * fps),
        ..ContactSettings::default()
    };
    let mut labels = latched(&over_ground.heights, &over_ground.speeds, settings.height, &labelling);
    tidy(&mut labels, &labelling);
    labels
}

/// Hands whose contacts the clip states.
fn hands(clip: &Clip) -> impl Iterator<Item = Support> + '_ {
    let sides = [(ContactPoint::LeftHand, Side::Left), (ContactPoint::RightHand, Side::Right)];
    sides.into_iter().filter_map(|(point, side)| {
        let at = contact_point(&clip.skeleton, point)?;
        let mut bears = vec![false; clip.frame_count()];
        for stated in clip.contacts.iter().filter(|stated| stated.point == point) {
            let last = stated.to.as_usize().min(bears.len().saturating_sub(1));
            // A contact beyond the clip's end bears nowhere in it.
            bears.get_mut(stated.from.as_usize()..=last).into_iter().for_each(|frames| frames.fill(true));
        }
        let is_any = bears.contains(&true);
        is_any.then(|| Support { bearer: Bearer::Hand(side), points: vec![at], bears })
    })
}

fn phases(supports: &[Support], touches: &[bool], settings: &StageSettings) -> Vec<Phase> {
    let supported = |frame: usize| supports.iter().any(|support| support.bears[frame]);
    let mut flies: Vec<bool> =
        touches.iter().enumerate().map(|(frame, touch)| !touch && !supported(frame)).collect();
    drop_short(&mut flies, settings.shortest_flight);
    let phase = |frame: usize| match (flies[frame], supported(frame)) {
        (true, _) => Phase::Flight,
        // A single frame between two flights is a touch, whatever its label.
        (_, true) if frame > 0 && flies[frame - 1] && flies.get(frame + 1) == Some(&true) => Phase::Touch,
        (_, true) => Phase::Ground,
        _ => Phase::Touch,
    };
    (0..flies.len()).map(phase).collect()
}

/// A body that falls slower than this is held by something unseen, m/s²: a seat, a bar. Nobody declares a sixth of the right rate.
const LEAST_GRAVITY: f64 = 0.25;
/// So is one that falls slower than this, m/s² …
const SLOW_GRAVITY: f64 = 2.0;
/// … without rising and sinking by this on the way, metres: it steps down where feet do not show the step, or turns on the ball of a foot.
/// Who jumps rises as high at any rate of frames.
const LEAST_HOP: f64 = 0.1;

/// How far a body rises after the first of these heights of its centre of mass and sinks before the last, whichever is less; metres.
fn hop(heights: &[f64]) -> f64 {
    let top = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let below = |end: Option<&f64>| end.map_or(0.0, |end| top - end);
    below(heights.first()).min(below(heights.last()))
}

impl Stages {
    /// Runs of frames in flight: first and last of each.
    pub fn flight_runs(&self) -> Vec<(usize, usize)> {
        runs(&self.phases.iter().map(|phase| *phase == Phase::Flight).collect::<Vec<_>>())
    }

    /// What the flight in the frames `run` ([`Self::flight_runs`]) falls like, if that is known.
    pub fn check_of(&self, run: (usize, usize)) -> Option<FlightCheck> {
        self.flights.iter().find(|check| (check.first, check.last) == run).copied()
    }

    /// World places of all points that support in one frame, metres.
    pub fn contacts(&self, posed: &PosedClip, frame: usize) -> Vec<DVec3> {
        if self.phases[frame] != Phase::Ground {
            return Vec::new();
        }
        let bearing = self.supports.iter().filter(|support| support.bears[frame]);
        bearing.flat_map(|support| &support.points).map(|point| point.place(posed.frame(frame))).collect()
    }

    /// Polygon of support in one frame, at the mean height of what supports; without corners where nothing does.
    ///
    /// `force`: what the ground gives altogether, any unit. Points at other heights are slid along it.
    pub fn polygon(&self, posed: &PosedClip, frame: usize, force: DVec3) -> Polygon {
        Polygon::of(&self.contacts(posed, frame), force)
    }

    /// The stages of a motion that shows these frames in another order or pace: `frames`, one a frame of that motion, rising. Flights
    /// fall as they did.
    ///
    /// # Panics
    /// If a frame is beyond the last.
    pub fn at(&self, frames: &[usize]) -> Self {
        let shown = |bears: &[bool]| frames.iter().map(|frame| bears[*frame]).collect();
        let support = |own: &Support| Support { bears: shown(&own.bears), ..own.clone() };
        let flight = |check: &FlightCheck| {
            let first = frames.partition_point(|frame| *frame < check.first);
            let last = frames.partition_point(|frame| *frame <= check.last).checked_sub(1)?;
            (first <= last).then_some(FlightCheck { first, last, ..*check })
        };
        Self {
            soles: self.soles.clone(),
            supports: self.supports.iter().map(support).collect(),
            phases: frames.iter().map(|frame| self.phases[*frame]).collect(),
            flights: self.flights.iter().filter_map(flight).collect(),
        }
    }

    /// Whether the same supports in two frames.
    pub fn bear_alike(&self, one: usize, other: usize) -> bool {
        self.supports.iter().all(|support| support.bears[one] == support.bears[other])
    }

    fn check_flights(&mut self, body: &BodyModel, posed: &PosedClip) {
        let centers = centers_of_mass(body, &link_places(body, posed));
        let heights: Vec<f64> = centers.iter().map(|center| center.y).collect();
        for (first, last) in self.flight_runs() {
            let Some(check) = check_flight(&heights, (first, last), posed.fps) else { continue };
            let is_whole = first > 0 && last + 1 < heights.len();
            let hops = is_whole && hop(&heights[first..=last]) >= LEAST_HOP;
            if check.gravity < LEAST_GRAVITY || (check.gravity < SLOW_GRAVITY && !hops) {
                self.phases[first..=last].fill(Phase::Touch);
            } else if is_whole {
                self.flights.push(check);
            }
        }
    }
}

/// A polygon of support.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polygon {
    /// Height of its plane, metres.
    pub height: f64,
    /// Of [`hull`].
    pub corners: Vec<glam::DVec2>,
}

impl Polygon {
    /// Hull of `contacts` at their mean height, metres; those at other heights are slid along `force`.
    pub fn of(contacts: &[DVec3], force: DVec3) -> Self {
        let height = contacts.iter().map(|contact| contact.y).sum::<f64>() / contacts.len().max(1) as f64;
        let points: Vec<_> = contacts.iter().map(|contact| slid(*contact, force, height)).collect();
        Self { height, corners: hull(&points) }
    }
}
