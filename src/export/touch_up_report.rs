//! What a touch-up did, for a report. Lengths in metres, angles in degrees, times in seconds; frames count from 0 at the first one
//! of the result.

use serde::Serialize;

use crate::clip::Clip;
use crate::index::JointId;
use crate::physics::ballistics::FlightCheck;
use crate::physics::body_model::{BodyModel, Segment};
use crate::physics::course::Course;
use crate::physics::flight::report::FlightFacts;
use crate::physics::ground::report::{GroundReport, JointChange, Judged, StepReport};
use crate::physics::masses::{FlightFit, MassFit};
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
        }
    }
}

/// A flight, as it came and as it is.
#[derive(Clone, Debug, Serialize)]
pub struct FlightPart {
    /// First frame in the air.
    pub first: usize,
    /// Last frame in the air.
    pub last: usize,
    /// Of the parabola nearest to the motion as it came, m/s²; `null` for a flight of less than 0.2 s.
    pub gravity: Option<f64>,
    /// Farthest from it.
    pub residual: Option<f64>,
    /// Whether labels, rate or scale are doubtful.
    pub doubtful: bool,
    /// Frames per second with which it would fall as bodies do.
    pub mending_rate: Option<f64>,
    /// Factor of all lengths with which it would.
    pub mending_scale: Option<f64>,
    /// What the flight pass did; `null` where it is left out.
    pub pass: Option<FlightPassPart>,
}

/// What was done in the air. Pairs: before and after.
#[derive(Clone, Debug, Serialize)]
pub struct FlightPassPart {
    /// Gravity of the result, m/s².
    pub gravity: f64,
    /// Angular momentum of the result about the centre of mass, kg m²/s.
    pub momentum: f64,
    /// Farthest of two successive frames from it, kg m²/s.
    pub momentum_errors: [f64; 2],
    /// Farthest of the centre of mass from its parabola.
    pub center_errors: [f64; 2],
    /// Largest turn of the body.
    pub largest_turn: f64,
    /// Newton steps on the momentum.
    pub newton_steps: usize,
    /// Distances in the half second on either side.
    pub beside: [Option<DistanceReport>; 2],
    /// The same at 6 Hz.
    pub beside_6hz: [Option<DistanceReport>; 2],
}

impl FlightPart {
    fn of_check(check: &FlightCheck) -> Self {
        Self {
            first: check.first,
            last: check.last,
            gravity: Some(check.gravity),
            residual: Some(check.residual),
            doubtful: check.is_doubtful(),
            mending_rate: check.mending_rate,
            mending_scale: check.mending_scale,
            pass: None,
        }
    }

    fn of_facts(facts: &FlightFacts) -> Self {
        let check = facts.check.as_ref();
        let bare = Self {
            first: facts.first,
            last: facts.last,
            gravity: None,
            residual: None,
            doubtful: false,
            mending_rate: None,
            mending_scale: None,
            pass: None,
        };
        let pass = FlightPassPart {
            gravity: facts.gravity,
            momentum: facts.momentum.length(),
            momentum_errors: facts.momentum_errors,
            center_errors: facts.center_errors,
            largest_turn: facts.largest_turn.to_degrees(),
            newton_steps: facts.newton_steps,
            beside: facts.beside.map(|own| own.map(Into::into)),
            beside_6hz: facts.beside_judged.map(|own| own.map(Into::into)),
        };
        Self { pass: Some(pass), ..check.map_or(bare, Self::of_check) }
    }

    /// Of the flight pass, or, where that is left out, of what `checks` say.
    pub fn all(touched: &TouchedUp, checks: &[FlightCheck]) -> Vec<Self> {
        if touched.flight.flights.is_empty() {
            return checks.iter().map(Self::of_check).collect();
        }
        touched.flight.flights.iter().map(Self::of_facts).collect()
    }
}

/// Mass of a segment, left and right together.
#[derive(Clone, Debug, Serialize)]
pub struct SegmentPart {
    /// Its name.
    pub segment: &'static str,
    /// kg.
    pub mass: f64,
    /// Over the table's, where masses are estimated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
}

/// Where estimated masses come from.
#[derive(Clone, Debug, Serialize)]
pub struct EstimatePart {
    /// `flight` or `ground`.
    pub by: &'static str,
    /// What the motion says of the masses, falling: what is small is not told by it. Metres of the centre of mass by flight, metres per
    /// kilogram of zero moment points on the ground.
    pub singular_values: Vec<f64>,
    /// What is off, with the table's masses and with the new ones, metres: the centre of mass from its trajectory, zero moment
    /// points from polygons.
    pub off: [f64; 2],
    /// Largest relative change of a segment.
    pub largest_change: f64,
    #[serde(skip)]
    factors: Vec<(Segment, f64)>,
}

impl From<&FlightFit> for EstimatePart {
    fn from(fit: &FlightFit) -> Self {
        Self {
            by: "flight",
            singular_values: fit.singular_values.clone(),
            off: fit.residuals,
            largest_change: fit.largest_change(),
            factors: fit.factors.clone(),
        }
    }
}

impl From<&MassFit> for EstimatePart {
    fn from(fit: &MassFit) -> Self {
        Self {
            by: "ground",
            singular_values: fit.singular_values.clone(),
            off: fit.distances,
            largest_change: fit.largest_change(),
            factors: fit.factors.clone(),
        }
    }
}

/// The body that was reckoned with.
#[derive(Clone, Debug, Serialize)]
pub struct BodyPart {
    /// `winter75` or `xiao2005`.
    pub table: &'static str,
    /// kg.
    pub mass: f64,
    /// By the length of the legs.
    pub stature: f64,
    /// Those that the body has.
    pub segments: Vec<SegmentPart>,
    /// Where masses are estimated.
    pub estimate: Option<EstimatePart>,
}

impl BodyPart {
    /// Of `body`, whose masses are from `table` or the `estimate`.
    pub fn of(body: &BodyModel, table: &'static str, estimate: Option<EstimatePart>) -> Self {
        let factor = |segment: Segment| {
            let factors = &estimate.as_ref()?.factors;
            factors.iter().find(|(own, _)| *own == segment).map(|(_, factor)| *factor)
        };
        let part = |(segment, mass): (Segment, f64)| SegmentPart {
            segment: segment.name(),
            mass,
            factor: factor(segment),
        };
        let segments = Segment::ALL.into_iter().zip(body.segment_masses()).filter(|(_, mass)| *mass > 0.0);
        Self {
            table,
            mass: body.mass,
            stature: body.stature,
            segments: segments.map(part).collect(),
            estimate,
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
    pub ground: GroundPart,
    pub flights: Vec<FlightPart>,
    /// The result after both passes.
    pub result: JudgedReport,
    /// Joint that turned most in both passes together.
    pub largest_change: Option<TurnReport>,
    pub flagged_frames: FlaggedFrames,
    /// What to think about before the result is used.
    pub doubts: Vec<String>,
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
