//! What the touch-up did to somebody of a scene, for the report. Lengths in metres, angles in degrees, times in seconds; frames count
//! from 0 at `first_frame`.

use serde::Serialize;

use crate::clip::Clip;
use crate::export::picture::{TouchUpCurves, touch_up_svg};
use crate::export::touch_up_report::TouchUpPart;
use crate::physics::course::{Course, course};
use crate::physics::ground::report::{GroundReport, Judged};
use crate::physics::stages::Stages;
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
    /// What was done; its result has hands and feet where they must be.
    #[serde(flatten)]
    pub done: TouchUpPart,
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
    let done = TouchUpPart::of(done, [before, &after], (body, stages), &course);
    PhysicsReport::Touched(Box::new(TouchedReport { first_frame: touched.first_frame, done }))
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
