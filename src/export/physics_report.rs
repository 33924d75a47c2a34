//! What the touch-up did to somebody of a scene, for the report. Lengths in metres, angles in degrees, times in seconds; frames count
//! from 0 at `first_frame`.

use serde::Serialize;

use crate::clip::Clip;
use crate::export::picture::{TouchUpCurves, touch_up_svg};
use crate::export::touch_up_report::{FlaggedFrames, FlightPart, GroundPart, JudgedReport, TurnReport};
use crate::physics::course::{Course, course};
use crate::physics::ground::report::{GroundReport, Judged, largest_change};
use crate::physics::stages::Stages;
use crate::physics::touch_up::TouchedUp;
use crate::plausible::{NotTouched, Touched, shown_part};

/// What became of somebody who was to be touched up.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum PhysicsReport {
    /// Was.
    Touched(Box<TouchedReport>),
    /// Was not.
    NotTouched {
        /// Why.
        not_touched: String,
    },
}

/// What was done to somebody.
#[derive(Clone, Debug, Serialize)]
pub struct TouchedReport {
    /// Output frame that is frame 0 here: before it the character holds still.
    pub first_frame: usize,
    /// The motion before the edit, the one that came from the full body, and what the ground pass made of it.
    pub ground: GroundPart,
    /// Flights as they fell before the edit, and what the flight pass did.
    pub flights: Vec<FlightPart>,
    /// What is written: after both passes, hands and feet where they must be.
    pub result: JudgedReport,
    /// Joint that turned most on the way there; `null` where none did.
    pub largest_change: Option<TurnReport>,
    /// Frames to look at.
    pub flagged_frames: FlaggedFrames,
    /// What to think about before the result is used.
    pub doubts: Vec<String>,
}

/// Measures of a motion before the touch-up and of what is written.
pub fn courses(touched: &Touched, written: &Clip) -> [Course; 2] {
    let after = shown_part(written, touched.first_frame);
    [&touched.before, &after].map(|clip| course(clip, &touched.body, &touched.stages))
}

/// `written`: the character's motion on the clock, as it is written. Cost: linear in its frames.
pub fn physics_report(touched: &Result<Touched, NotTouched>, written: &Clip) -> PhysicsReport {
    let touched = match touched {
        Ok(touched) => touched,
        Err(error) => return PhysicsReport::NotTouched { not_touched: error.to_string() },
    };
    let after = shown_part(written, touched.first_frame);
    let Touched { before, body, stages, done, .. } = touched;
    let course = course(&after, body, stages);
    let flagged_frames = FlaggedFrames::of(&course, &course.pulled_down, body.stature);
    PhysicsReport::Touched(Box::new(TouchedReport {
        first_frame: touched.first_frame,
        ground: GroundPart::of(&done.ground, before),
        flights: FlightPart::all(done, &stages.flights),
        result: JudgedReport::from(&Judged { distance: course.summaries, miss: None }),
        largest_change: largest_change(before, &after).map(|change| TurnReport::of(&change, before)),
        doubts: doubts(stages, done, &flagged_frames),
        flagged_frames,
    }))
}

/// What to think about before a touch-up is used. `stages`: of the motion that was edited.
pub fn doubts(stages: &Stages, touched: &TouchedUp, flagged: &FlaggedFrames) -> Vec<String> {
    let doubtful = stages.flights.iter().filter(|flight| flight.is_doubtful());
    let mut doubts: Vec<String> = doubtful.map(ToString::to_string).collect();
    let far = touched.flight.flights.iter().filter(|facts| facts.turns_far());
    doubts.extend(far.map(|facts| {
        let degrees = facts.largest_turn.to_degrees();
        format!("the flight of frames {} to {} turns by {degrees:.0}°", facts.first, facts.last)
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

/// Curves of a touch-up of `clip`, `edits`: what was done to it before, if anything.
pub fn curves_svg(
    (title, edits): (&str, &str),
    (clip, stages): (&Clip, &Stages),
    [before, after]: &[Course; 2],
    ground: &GroundReport,
) -> String {
    let mean = |judged: &Judged| judged.distance.map(|own| own.map_or(0.0, |own| own.mean));
    let told = |judged: &Judged| {
        let [own, six] = mean(judged).map(|metres| metres * 1e3);
        format!("{own:.1} mm ({six:.1} at 6 Hz)")
    };
    let mut steps = vec![mean(&ground.before)];
    steps.extend(ground.steps.iter().map(|step| mean(&step.judged)));
    let distances = format!("{} → {}", told(&ground.before), told(&ground.after));
    touch_up_svg(&TouchUpCurves {
        title,
        subtitle: &format!("{edits}mean distance on the ground {distances}"),
        fps: clip.fps,
        before,
        after,
        stages,
        steps: &steps,
        kept: ground.kept,
    })
}
