//! The ground pass: small turns of the body so that the ground can bear it where it stands.
//!
//! Step by step of a [`schedule`], the [`parts`] of a body turn so that the zero moment point comes to its [`target`], by angles in
//! [`closed_form`]; these are smoothed along time and applied ([`displacement`]), and feet are brought back to where the input has
//! them ([`plants`]). Of all iterates the one is kept whose zero moment point is best by derivatives that are not optimised.
//!
//! Source: Shin, Kovar, Gleicher, *Physical Touch-Up of Human Motions*, Pacific Graphics 2003, §5; beyond it: margins, carried targets,
//! turns about both axes, the judge.

pub mod closed_form;
pub mod displacement;
mod loads;
pub mod parts;
pub mod plants;
pub mod report;
pub mod schedule;
mod state;
mod step;
pub mod target;

use crate::clip::Clip;
use crate::physics::body_model::BodyModel;
use crate::physics::ground::parts::PartsError;
use crate::physics::ground::report::{GroundReport, Judged};
use crate::physics::ground::schedule::Step;
use crate::physics::ground::state::State;
use crate::physics::ground::step::PreparedStep;
use crate::physics::ground::target::{Source, Target};
use crate::physics::input::{InputError, check_motion, check_numbers};
use crate::physics::stages::Stages;
use crate::physics::zmp::ExternalForce;

/// How the ground pass works.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundSettings {
    /// Steps of one round.
    pub schedule: Vec<Step>,
    /// How often the schedule is gone through at most.
    pub rounds: usize,
    /// Good enough: a mean distance of zero moment points from polygons, metres.
    pub tolerance: f64,
    /// Where zero moment points are to be.
    pub target: Target,
    /// Whether turns are exact along both axes instead of one.
    pub two_axis: bool,
    /// Whether links resist turning; otherwise they are points.
    pub inertia: bool,
    /// What others exert.
    pub external: Vec<ExternalForce>,
    /// Whether the judge chooses among the iterates; otherwise the last one is the result, as published, even if it is worse than the input.
    pub judged: bool,
}

/// Share of the stature by which polygons are made smaller.
pub const MARGIN: f64 = 0.0125;

impl Default for GroundSettings {
    /// Of a clip of which nothing else is known.
    fn default() -> Self {
        Self {
            schedule: schedule::level(),
            rounds: 3,
            tolerance: 0.0,
            target: Target::Hull { margin: MARGIN },
            two_axis: false,
            inertia: false,
            external: Vec::new(),
            judged: true,
        }
    }
}

/// Why there is no ground pass.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GroundError {
    /// A step that no body can do.
    #[error("step {step}: {cause}")]
    Step {
        /// Place in the schedule, from 1.
        step: usize,
        /// What is wrong with it.
        #[source]
        cause: PartsError,
    },
    /// A carried target of an edit that does not know its source.
    #[error("zero moment points cannot be carried over: the motion that was edited is not known")]
    NoSource,
    /// A source of other length.
    #[error("the source tells of {source_frames} frames, the motion has {frames}")]
    OtherLength {
        /// Frames that the source tells of.
        source_frames: usize,
        /// Frames of the motion.
        frames: usize,
    },
    /// A motion that is not of these stages, or a number that is none.
    #[error(transparent)]
    Input(#[from] InputError),
}

/// Rounds in succession that bring nothing before it is given up.
const IDLE_ROUNDS: usize = 2;
/// A round brings something if it takes this share off.
const PROGRESS: f64 = 0.02;

/// `clip` touched up on the ground, and what was done. Frames of flight take part in what their neighbours do. Cost: linear in frames
/// times steps.
///
/// `stages`: of `clip`, or of the motion it was edited from, whose labels an edit keeps. `source`: that motion, frame by frame.
///
/// # Errors
/// [`GroundError`] for what does not fit together.
pub fn ground_pass(
    clip: &Clip,
    body: &BodyModel,
    stages: &Stages,
    source: Option<&Source>,
    settings: &GroundSettings,
) -> Result<(Clip, GroundReport), GroundError> {
    check(clip, stages, source, settings)?;
    let steps = prepare(clip, body, settings)?;
    let mut state = State::new((clip, body, stages), source, settings);
    let mut report = GroundReport::new(&state.judged(), source);
    let mut best = Best { start: state.judged(), judged: state.judged(), clip: None, steps: 0 };
    let mut idle = 0;
    for _ in 0..settings.rounds {
        let before = state.judged().optimised();
        for step in &steps {
            if state.is_good_enough(settings.tolerance) {
                break;
            }
            let done = state.step(step);
            report.steps.push(done);
            if !settings.judged || best.is_beaten_by(&state.judged()) {
                best.take(&state, report.steps.len());
            }
        }
        let is_idle = state.judged().optimised() > (1.0 - PROGRESS) * before;
        idle = if is_idle { idle + 1 } else { 0 };
        if idle == IDLE_ROUNDS || state.is_good_enough(settings.tolerance) {
            break;
        }
    }
    let result = best.clip.unwrap_or_else(|| clip.clone());
    report.finish(clip, &result, (&best.judged, best.steps), &state);
    Ok((result, report))
}

/// The best iterate so far, or the last.
struct Best {
    start: Judged,
    judged: Judged,
    /// `None` where that is the input.
    clip: Option<Clip>,
    steps: usize,
}

impl Best {
    fn is_beaten_by(&self, judged: &Judged) -> bool {
        !judged.is_farther_than(&self.start) && judged.is_better_than(&self.judged)
    }

    fn take(&mut self, state: &State<'_>, steps: usize) {
        match &mut self.clip {
            Some(clip) => {
                clip.root_positions.copy_from_slice(&state.clip.root_positions);
                clip.rotations.copy_from_slice(&state.clip.rotations);
            }
            none => *none = Some(state.clip.clone()),
        }
        (self.judged, self.steps) = (state.judged(), steps);
    }
}

fn prepare(
    clip: &Clip,
    body: &BodyModel,
    settings: &GroundSettings,
) -> Result<Vec<PreparedStep>, GroundError> {
    let prepared = settings.schedule.iter().enumerate().map(|(index, step)| {
        PreparedStep::of(step, clip, body).map_err(|cause| GroundError::Step { step: index + 1, cause })
    });
    prepared.collect()
}

fn check(
    clip: &Clip,
    stages: &Stages,
    source: Option<&Source>,
    settings: &GroundSettings,
) -> Result<(), GroundError> {
    check_motion(clip, stages)?;
    let frames = clip.frame_count();
    match (settings.target, source) {
        (Target::Carried, None) => return Err(GroundError::NoSource),
        (_, Some(source)) if source.roots.len() != frames => {
            return Err(GroundError::OtherLength { source_frames: source.roots.len(), frames });
        }
        _ => (),
    }
    let is_finite = |step: &Step| {
        [step.width, step.share, step.largest_turn].iter().all(|value| value.is_finite() && *value >= 0.0)
    };
    let target_is_finite = match settings.target {
        Target::Hull { margin } => margin.is_finite(),
        Target::Carried => true,
    };
    check_numbers(&[
        (settings.schedule.iter().all(is_finite), "width, share and largest turn of every step"),
        (settings.tolerance.is_finite() && target_is_finite, "tolerance and margin"),
    ])?;
    Ok(())
}
