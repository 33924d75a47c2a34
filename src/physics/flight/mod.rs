//! The flight pass: in the air the centre of mass goes along a parabola, and angular momentum stays what it is.
//!
//! Flight by flight: halves of the body may turn a little towards both ([`FlightStep`]); then the whole body turns about its centre of
//! mass until every pair of frames has one and the same [`momentum`], chosen so that the landing is not turned ([`turning`]), and is
//! moved onto its [`parabola`]. Where something is left to turn at the borders, neighbours on the ground fade it out, and feet
//! are brought back there. Frames on the ground else stay as they are, to the bit.
//!
//! What smooths must not come last: a smoothed parabola is none.
//!
//! Source: Shin, Kovar, Gleicher, *Physical Touch-Up of Human Motions*, Pacific Graphics 2003, §6; beyond it: turns accumulate, the momentum
//! is not the mean but what keeps the landing, momentum and trajectory are exact.

mod block;
pub mod breaks;
pub mod halves;
pub mod momentum;
mod neighbours;
pub mod parabola;
mod replant;
pub mod report;
pub mod turning;

use crate::clip::Clip;
use crate::physics::GRAVITY;
use crate::physics::ballistics::{FlightCheck, PLAUSIBLE_GRAVITY};
use crate::physics::body_model::BodyModel;
use crate::physics::flight::block::Block;
use crate::physics::flight::halves::HalfName;
use crate::physics::flight::neighbours::Neighbours;
use crate::physics::flight::report::{FlightFacts, FlightReport, Landed, LeftFlight};
use crate::physics::input::{InputError, check_motion, check_numbers};
use crate::physics::posed::PosedClip;
use crate::physics::stages::Stages;

/// Part of the way to momentum and parabola that a half of the body turns, smoothed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlightStep {
    /// What turns. A body that has no such half is left as it is.
    pub half: HalfName,
    /// Share of the turn that is done, 0 to 1.
    pub share: f64,
    /// Width of the kernel that smooths the turns, frames at 30 fps.
    pub width: f64,
}

/// Which momentum a flight gets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MomentumTarget {
    /// That with which the landing is not turned.
    #[default]
    Landing,
    /// That of [`Self::Landing`] to first order; neighbours fade out the rest.
    FirstOrder,
    /// The mean: the paper's; neighbours fade out what the landing is turned by.
    Mean,
}

/// How the flight pass works.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightSettings {
    /// Before the whole body turns.
    pub steps: Vec<FlightStep>,
    /// Which momentum a flight gets.
    pub target: MomentumTarget,
    /// Seconds in which neighbours on the ground fade out what is left at a border.
    pub fade: f64,
    /// Whether flights that fall otherwise than bodies do may go on to fall as fast as they do (and flights too short to tell as fast as
    /// the longest one of the clip): their rate or scale is wrong, and a parabola of true gravity would bury or lift them.
    pub trusts_fall: bool,
    /// Flights that stay as they come, counted from 0 in the order of time.
    pub left: Vec<usize>,
}

/// Seconds in which neighbours fade out: 15 frames at 30 fps.
const FADE: f64 = 0.5;

impl Default for FlightSettings {
    /// Without steps of halves: on captured jumps these turn joints farther than the whole body would have to turn.
    fn default() -> Self {
        Self {
            steps: Vec::new(),
            target: MomentumTarget::default(),
            fade: FADE,
            trusts_fall: true,
            left: Vec::new(),
        }
    }
}

/// The paper's steps of halves: lower body, upper body.
pub fn halves_in_turn() -> Vec<FlightStep> {
    [HalfName::Lower, HalfName::Upper]
        .into_iter()
        .map(|half| FlightStep { half, share: 0.3, width: 10.0 })
        .collect()
}

/// A motion after its flight pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Flown {
    /// The motion.
    pub clip: Clip,
    /// What was done.
    pub report: FlightReport,
}

/// `clip` with its flights made physical, and what was done. Cost: linear in frames times links; a frame of flight costs some fifty
/// evaluations of the momentum.
///
/// `stages`: of `clip`, or of the motion it was edited from, whose labels an edit keeps; what flights fall like is known from there, not
/// measured on what an edit or the ground pass made of them. Flights are worked on one after the other.
///
/// # Errors
/// [`InputError`] for what does not fit together.
pub fn fly(
    clip: &Clip,
    body: &BodyModel,
    stages: &Stages,
    settings: &FlightSettings,
) -> Result<Flown, InputError> {
    check(clip, stages, settings)?;
    let mut flown = clip.clone();
    let runs = stages.flight_runs();
    let checks: Vec<Option<FlightCheck>> = runs.iter().map(|run| stages.check_of(*run)).collect();
    let neighbours = Neighbours::of(clip, stages, &runs, settings.fade);
    let mut landed: Vec<Landed> = Vec::with_capacity(runs.len());
    let mut left = Vec::new();
    for (index, (run, check)) in runs.iter().zip(&checks).enumerate() {
        if settings.left.contains(&index) {
            left.push(LeftFlight { first: run.0, last: run.1, check: *check });
            continue;
        }
        let block = Block::of(*run, clip.frame_count());
        let mut own = block.cut(&flown);
        let path = block.fly(&mut own, body, gravity(*check, &checks, settings), settings);
        let turns = neighbours.border_turns(index, &flown, body, (&block, path.landing_turn));
        block.put(&mut flown, own, body, turns);
        neighbours.fade_out(index, &mut flown, body, (&block, turns));
        landed.push(Landed { block, path, turns, check: *check });
    }
    let posed = [PosedClip::of(clip), PosedClip::of(&flown)];
    let flights = FlightFacts::all([clip, &flown], [&posed[0], &posed[1]], body, stages, &landed);
    Ok(Flown { clip: flown, report: FlightReport { flights, left } })
}

/// By how much a flight is to fall, m/s². `checks`: of all flights.
fn gravity(own: Option<FlightCheck>, checks: &[Option<FlightCheck>], settings: &FlightSettings) -> f64 {
    let longest = || checks.iter().flatten().copied().max_by_key(|check| check.last - check.first);
    let falls_otherwise =
        |check: &FlightCheck| check.gravity > 0.0 && !PLAUSIBLE_GRAVITY.contains(&check.gravity);
    let odd = own.or_else(longest).filter(|check| settings.trusts_fall && falls_otherwise(check));
    odd.map_or(GRAVITY, |check| check.gravity)
}

fn check(clip: &Clip, stages: &Stages, settings: &FlightSettings) -> Result<(), InputError> {
    check_motion(clip, stages)?;
    let is_amount = |value: f64| value.is_finite() && value >= 0.0;
    let is_step = |step: &FlightStep| is_amount(step.share) && is_amount(step.width);
    check_numbers(&[
        (settings.steps.iter().all(is_step), "share and width of every step"),
        (is_amount(settings.fade), "the fade"),
    ])
}
