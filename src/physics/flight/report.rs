//! What the flight pass did.

use std::fmt;

use glam::{DQuat, DVec3};

use crate::clip::Clip;
use crate::geometry::log;
use crate::index::floor_index;
use crate::physics::ballistics::FlightCheck;
use crate::physics::body_model::BodyModel;
use crate::physics::derivatives::Filter;
use crate::physics::flight::block::{Block, Path};
use crate::physics::flight::breaks::{MomentumBreak, momentum_break};
use crate::physics::flight::momentum::{Pair, pairs};
use crate::physics::posed::{PosedClip, centers_of_mass, link_places};
use crate::physics::stages::Stages;
use crate::physics::zmp::{Balance, DistanceSummary, ForceSettings, balances, distance_summary, link_forces};

/// What became of one flight. Of pairs: before the pass, and after it.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightFacts {
    /// First frame in the air.
    pub first: usize,
    /// Last frame in the air.
    pub last: usize,
    /// How it fell as captured; `None` for a flight of less than 0.2 s, or one that is cut off by an end of the clip.
    pub check: Option<FlightCheck>,
    /// How fast it falls now, m/s².
    pub gravity: f64,
    /// Angular momentum about the centre of mass that it now has, kg m²/s.
    pub momentum: DVec3,
    /// Share of the way to it that is gone: 1 but for bodies that would have to tumble for it.
    pub share: f64,
    /// Farthest that the momentum of two successive frames is from that, kg m²/s.
    pub momentum_errors: [f64; 2],
    /// Where its momentum, as it came, breaks; `None` where it does not.
    pub momentum_break: Option<MomentumBreak>,
    /// Farthest of the centre of mass from its parabola, metres.
    pub center_errors: [f64; 2],
    /// Largest turn of the body against the input, radians.
    pub largest_turn: f64,
    /// Newton steps on the momentum.
    pub newton_steps: usize,
    /// Turns of the borders that neighbours fade out, radians.
    pub border_turns: [f64; 2],
    /// Whether the poses at both borders are the same to the bit.
    pub borders_kept: bool,
    /// Distances of zero moment points from polygons in the half second on either side, by the Gaussian; `None` where nothing counts.
    pub beside: [Option<DistanceSummary>; 2],
    /// The same by the judge.
    pub beside_judged: [Option<DistanceSummary>; 2],
}

/// What became of all flights of a clip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlightReport {
    /// Those that were worked on, in the order of time.
    pub flights: Vec<FlightFacts>,
    /// Those that were not, in the order of time.
    pub left: Vec<LeftFlight>,
}

/// A flight that stays as it came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftFlight {
    /// First frame in the air.
    pub first: usize,
    /// Last frame in the air.
    pub last: usize,
    /// As in [`FlightFacts::check`].
    pub check: Option<FlightCheck>,
}

/// A flight that was worked on.
pub(super) struct Landed {
    pub(super) block: Block,
    pub(super) path: Path,
    pub(super) turns: [DQuat; 2],
    pub(super) check: Option<FlightCheck>,
}

/// Turns beyond this are doubtful, degrees: what is small along the long axis of a body is divided by a small inertia.
pub const FAR_TURN_DEG: f64 = 30.0;
/// Momentum below this (of 75 kg) is none: there is no relative error of it, kg m²/s.
pub const NO_MOMENTUM: f64 = 0.5;
/// What counts as beside a flight, seconds.
const BESIDE: f64 = 0.5;

impl FlightFacts {
    /// [`Self::momentum_errors`] as shares of the momentum; `None` where that is about 0.
    pub fn relative_momentum_errors(&self) -> Option<[f64; 2]> {
        let size = self.momentum.length();
        (size >= NO_MOMENTUM).then(|| self.momentum_errors.map(|error| error / size))
    }

    /// Whether the body turns so far that labels or rate may be wrong.
    pub fn turns_far(&self) -> bool {
        self.largest_turn.to_degrees() > FAR_TURN_DEG
    }

    /// Whether it is known to have fallen as bodies do.
    pub fn is_sound(&self) -> bool {
        self.check.is_some_and(|check| !check.is_doubtful())
    }

    /// Whether labels, rate or scale are doubtful.
    pub fn is_doubtful(&self) -> bool {
        self.check.is_some_and(|check| check.is_doubtful())
    }
}

impl fmt::Display for FlightFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [before, after] = self.momentum_errors;
        let [off, on] = self.center_errors.map(|error| error * 1e3);
        let (turn, steps) = (self.largest_turn.to_degrees(), self.newton_steps);
        write!(
            f,
            "flight {} to {}: turned by up to {turn:.2}°, momentum {:.2} kg m²/s held to {after:.1e} (was {before:.2}), centre of mass \
             {on:.1e} mm off its parabola (was {off:.1}), {steps} Newton steps",
            self.first,
            self.last,
            self.momentum.length()
        )?;
        if self.turns_far() {
            write!(f, "; turns of more than {FAR_TURN_DEG:.0}° are doubtful")?;
        }
        if let Some(broken) = self.momentum_break {
            write!(
                f,
                "; as it came, its momentum breaks at frame {} (by {:.1})",
                broken.frame, broken.change
            )?;
        }
        if self.share < 1.0 {
            write!(f, "; only {:.0} % of the way to one momentum", 100.0 * self.share)?;
        }
        match &self.check {
            Some(check) if check.is_doubtful() => write!(f, "; {check}"),
            _ => Ok(()),
        }
    }
}

impl FlightFacts {
    /// Of the motion before and after, and their frames.
    pub(super) fn all(
        clips: [&Clip; 2],
        posed: [&PosedClip; 2],
        body: &BodyModel,
        stages: &Stages,
        landed: &[Landed],
    ) -> Vec<Self> {
        if landed.is_empty() {
            return Vec::new();
        }
        let by = |filter: Filter| posed.map(|posed| balanced(body, posed, stages, filter));
        let (gaussian, judged) = (by(Filter::Gaussian), by(Filter::Butterworth));
        let centers = posed.map(|posed| centers_of_mass(body, &link_places(body, posed)));
        let facts = |Landed { block, path, turns, check }: &Landed| {
            let air = block.airborne();
            let beside = |balances: &[Vec<Option<Balance>>; 2]| {
                [0, 1].map(|at| beside(&balances[at], block, posed[at].fps))
            };
            Self {
                first: air.start,
                last: air.end - 1,
                check: *check,
                gravity: path.parabola.gravity,
                momentum: turns[0] * path.aim.target,
                momentum_errors: posed
                    .map(|posed| momentum_error(body, posed, block, turns[0] * path.aim.target)),
                momentum_break: momentum_break(body, posed[0], (block.first, block.last)),
                center_errors: [0, 1].map(|at| center_error(&centers[at], block, path, posed[at].step())),
                share: path.aim.share,
                largest_turn: path.largest_turn,
                newton_steps: path.newton_steps,
                border_turns: turns.map(|turn| log(turn).length()),
                borders_kept: borders_kept(clips, block),
                beside: beside(&gaussian),
                beside_judged: beside(&judged),
            }
        };
        landed.iter().map(facts).collect()
    }
}

fn balanced(body: &BodyModel, posed: &PosedClip, stages: &Stages, filter: Filter) -> Vec<Option<Balance>> {
    let forces = link_forces(body, posed, &ForceSettings { filter, ..ForceSettings::default() });
    balances(body, posed, stages, &forces)
}

/// Of the half second on either side.
fn beside(balances: &[Option<Balance>], block: &Block, fps: f64) -> Option<DistanceSummary> {
    let reach = floor_index((BESIDE * fps).round());
    let before = block.first.saturating_sub(reach)..=block.first;
    let after = block.last..=(block.last + reach).min(balances.len() - 1);
    let frames: Vec<Option<Balance>> = before.chain(after).map(|frame| balances[frame].clone()).collect();
    distance_summary(&frames)
}

fn momentum_error(body: &BodyModel, posed: &PosedClip, block: &Block, momentum: DVec3) -> f64 {
    let pairs = pairs(body, posed, (block.first, block.last), None);
    let error = |pair: &Pair| pair.momentum([DQuat::IDENTITY; 2]).value.distance(momentum);
    pairs.iter().map(error).fold(0.0, f64::max)
}

fn center_error(centers: &[DVec3], block: &Block, path: &Path, step: f64) -> f64 {
    let off = |frame: usize| centers[frame].distance(path.parabola.at((frame - block.first) as f64 * step));
    (block.first..=block.last).map(off).fold(0.0, f64::max)
}

fn borders_kept(clips: [&Clip; 2], block: &Block) -> bool {
    let is_kept = |frame: usize| {
        let joints = clips[0].skeleton.joints.len();
        let own = frame * joints..(frame + 1) * joints;
        clips[0].root_positions[frame] == clips[1].root_positions[frame]
            && clips[0].rotations[own.clone()] == clips[1].rotations[own]
    };
    let borders = [block.first, block.last].into_iter().zip(block.held);
    borders.filter(|(_, held)| *held).all(|(frame, _)| is_kept(frame))
}
