//! What a touch-up did, of a clip or of somebody of a scene, for a report. Lengths in metres, angles in degrees, times in seconds; frames count from 0 at the first one
//! of the result.

use serde::Serialize;

use crate::clip::Clip;
use crate::export::flight_report::FlightPart;
use crate::export::masses_report::BodyPart;
use crate::index::JointId;
use crate::physics::body_model::BodyModel;
use crate::physics::course::Course;
use crate::physics::ground::report::{GroundReport, JointChange, Judged, StepReport, largest_change};
use crate::physics::stages::Stages;
use crate::physics::touch_up::TouchedUp;
use crate::physics::zmp::DistanceSummary;

/// Distances of zero moment points from polygons.
#[derive(Clone, Copy, Debug, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct DistanceReport {
    pub mean: f64,
    pub max: f64,
    /// Share of the frames counted.
    pub outside: f64,
    /// Frames counted.
    pub frames: usize,
}

impl From<DistanceSummary> for DistanceReport {
    fn from(DistanceSummary { mean, largest, outside, frames }: DistanceSummary) -> Self {
        Self { mean, max: largest, outside, frames }
    }
}

/// How good a motion is.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct JudgedReport {
    /// By derivatives that are optimised; `null` where nothing bears.
    pub d: Option<DistanceReport>,
    /// By those that are not: a Butterworth filter at 6 Hz.
    pub d_6hz: Option<DistanceReport>,
    /// Mean distance of zero moment points from where the source has them, where that is the target.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub miss: Option<f64>,
    /// The same at 6 Hz.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub miss_6hz: Option<f64>,
}

impl From<&Judged> for JudgedReport {
    fn from(judged: &Judged) -> Self {
        let [d, d_6hz] = judged.distance.map(|distance| distance.map(Into::into));
        Self { d, d_6hz, miss: judged.miss.map(|miss| miss[0]), miss_6hz: judged.miss.map(|miss| miss[1]) }
    }
}

/// One step on the ground.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct StepLine {
    /// After it.
    #[serde(flatten)]
    pub judged: JudgedReport,
    /// Frames in which no turn brings the point where it is to be.
    pub unreachable: usize,
    /// Frames in which the turn was larger than allowed.
    pub clamped: usize,
    /// Frames in which turning hardly moves the point.
    pub without_lever: usize,
}

impl From<&StepReport> for StepLine {
    fn from(step: &StepReport) -> Self {
        let faults = step.faults;
        Self {
            judged: (&step.judged).into(),
            unreachable: faults.unreachable,
            clamped: faults.clamped,
            without_lever: faults.without_lever,
        }
    }
}

/// How far a joint was turned.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct TurnReport {
    pub joint: String,
    pub frame: usize,
    pub seconds: f64,
    pub degrees: f64,
}

impl TurnReport {
    /// Of a joint of `clip`.
    pub fn of(change: &JointChange, clip: &Clip) -> Self {
        let JointChange { joint, frame, angle } = *change;
        let name = |joint: JointId| clip.skeleton.joints[joint.as_usize()].name.clone();
        Self { joint: name(joint), frame, seconds: frame as f64 / clip.fps, degrees: angle.to_degrees() }
    }
}

/// What was done on the ground.
#[derive(Clone, Debug, Serialize)]
pub struct GroundPart {
    /// The motion that was edited, where it is known.
    pub source: Option<JudgedReport>,
    /// The motion as it came.
    pub before: JudgedReport,
    /// After the ground pass.
    pub after: JudgedReport,
    /// All steps that were tried.
    pub steps: Vec<StepLine>,
    /// So many of them are in the result: later ones were worse at 6 Hz.
    pub kept: usize,
    /// Planted feet and hands.
    pub plants: PlantPart,
    /// Joint that turned most, against its parent; `null` where none turned.
    pub largest_change: Option<TurnReport>,
    /// Largest shift of the root.
    pub root_shift: f64,
    /// Largest relative change of a bone's length.
    pub stretch: f64,
}

/// How planted feet and hands stay where they were.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PlantPart {
    /// Largest distance from there.
    pub largest_error: f64,
    /// Largest turn.
    pub largest_turn: f64,
}

impl GroundPart {
    /// Of a pass over `clip`.
    pub fn of(report: &GroundReport, clip: &Clip) -> Self {
        let source = report.source.map(|distance| Judged { distance, miss: None });
        Self {
            source: source.as_ref().map(Into::into),
            before: (&report.before).into(),
            after: (&report.after).into(),
            steps: report.steps.iter().map(Into::into).collect(),
            kept: report.kept,
            plants: PlantPart {
                largest_error: report.plant_error,
                largest_turn: report.plant_turn.to_degrees(),
            },
            largest_change: report.largest_change.as_ref().map(|change| TurnReport::of(change, clip)),
            root_shift: report.root_shift,
            stretch: report.stretch,
        }
    }
}

/// Frames to look at. Runs: first and last frame.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FlaggedFrames {
    /// Zero moment points still farther than 0.03 of the stature from their polygons: more than small turns can mend.
    pub far_outside: Vec<[usize; 2]>,
    /// On the ground, yet pulled down: labels are probably wrong.
    pub pulled_down: Vec<[usize; 2]>,
}

/// Share of the stature beyond which a zero moment point is far outside.
const FAR: f64 = 0.03;

impl FlaggedFrames {
    /// Of a result whose frames in `pulled_down` are pulled down.
    pub fn of(course: &Course, pulled_down: &[usize], stature: f64) -> Self {
        let is_far = |(frame, distance): (usize, &Option<f64>)| {
            distance.is_some_and(|distance| distance > FAR * stature).then_some(frame)
        };
        let far: Vec<usize> = course.distances[0].iter().enumerate().filter_map(is_far).collect();
        Self { far_outside: runs_of(&far), pulled_down: runs_of(pulled_down) }
    }
}

/// Runs of rising frames.
fn runs_of(frames: &[usize]) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for frame in frames {
        match runs.last_mut() {
            Some(run) if run[1] + 1 == *frame => run[1] = *frame,
            _ => runs.push([*frame; 2]),
        }
    }
    runs
}

/// What was done, whoever asked for it.
#[derive(Clone, Debug, Serialize)]
pub struct TouchUpPart {
    /// The motion before the edit, the one that came to be touched up, and what the ground pass made of it.
    pub ground: GroundPart,
    /// Flights as they fell before the edit, and what the flight pass did.
    pub flights: Vec<FlightPart>,
    /// What is written: after both passes, in scenes hands and feet where they must be.
    pub result: JudgedReport,
    /// Joint that turned most on the way there; `null` where none did.
    pub largest_change: Option<TurnReport>,
    /// Frames to look at.
    pub flagged_frames: FlaggedFrames,
    /// What to think about before the result is used.
    pub doubts: Vec<String>,
}

impl TouchUpPart {
    /// Of what was `done` to the first clip. The second is what is written, `course` its measures; `stages`: of the motion that was edited.
    pub fn of(
        done: &TouchedUp,
        [before, written]: [&Clip; 2],
        (body, stages): (&BodyModel, &Stages),
        course: &Course,
    ) -> Self {
        let flagged_frames = FlaggedFrames::of(course, &course.pulled_down, body.stature);
        Self {
            ground: GroundPart::of(&done.ground, before),
            flights: FlightPart::all(done, &stages.flights),
            result: JudgedReport::from(&Judged { distance: course.summaries, miss: None }),
            largest_change: largest_change(before, written).map(|change| TurnReport::of(&change, before)),
            doubts: doubts(stages, done, &flagged_frames),
            flagged_frames,
        }
    }
}

/// What to think about before a touch-up is used. `stages`: of the motion that was edited.
fn doubts(stages: &Stages, touched: &TouchedUp, flagged: &FlaggedFrames) -> Vec<String> {
    let doubtful = stages.flights.iter().filter(|flight| flight.is_doubtful());
    let mut doubts: Vec<String> = doubtful.map(ToString::to_string).collect();
    let far = touched.flight.flights.iter().filter(|facts| facts.turns_far());
    doubts.extend(far.map(|facts| {
        let degrees = facts.largest_turn.to_degrees();
        format!("the flight of frames {} to {} turns by {degrees:.0}°", facts.first, facts.last)
    }));
    doubts.extend(touched.flight.flights.iter().filter_map(|facts| {
        let frame = facts.momentum_break?.frame;
        Some(format!(
            "the flight of frames {} to {} came with a momentum that breaks at frame {frame}: a limb was captured wrong there, or labels are",
            facts.first, facts.last
        ))
    }));
    if touched.ground.before.distance[0].is_none() {
        doubts.push("nothing bears the body long enough to tell a zero moment point".to_owned());
    }
    if !flagged.pulled_down.is_empty() {
        let count = flagged.pulled_down.len();
        doubts.push(format!("labels: {count} stretches stand on the ground and are pulled down"));
    }
    doubts
}

/// `report.json` of a touch-up.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names say it")]
pub struct TouchUpReport {
    /// As it was named.
    pub clip: String,
    /// Version of the program.
    pub cotillion: &'static str,
    pub fps: f64,
    pub frames: usize,
    /// Frame of the file that is frame 0 here.
    pub first_frame: u32,
    pub seconds: f64,
    /// What was done to the clip before, word by word.
    pub edits: Vec<String>,
    pub settings: SettingsPart,
    pub body: BodyPart,
    #[serde(flatten)]
    pub done: TouchUpPart,
    /// What the reader had to guess.
    pub notes: Vec<String>,
    pub files: Vec<String>,
}

/// How the touch-up worked.
#[derive(Clone, Debug, Serialize)]
pub struct SettingsPart {
    /// `hull` or `carried`.
    pub target: &'static str,
    /// Share of the stature by which polygons are made smaller, where they are the target.
    pub margin: Option<f64>,
    /// `level`, `uphill` or `published`.
    pub schedule: &'static str,
    /// How often at most.
    pub rounds: usize,
    /// Mean distance that is good enough.
    pub tolerance: f64,
    /// Whether turns are exact along both axes.
    pub two_axis: bool,
    /// Whether the flight pass ran.
    pub flight: bool,
}
