//! The touch-up: an edited motion made physically plausible.
//!
//! First the ground pass, for frames in which something bears, then the flight pass: what smooths must not come after a parabola. No
//! hidden state: the same input gives the same output, and an edit can be touched up again while it is dragged. Callers work on many
//! characters in parallel.

use crate::clip::Clip;
use crate::physics::body_model::BodyModel;
use crate::physics::flight::report::FlightReport;
use crate::physics::flight::{FlightError, FlightSettings, Flown, fly};
use crate::physics::ground::report::GroundReport;
use crate::physics::ground::target::Source;
use crate::physics::ground::{GroundError, GroundSettings, ground_pass};
use crate::physics::stages::Stages;

/// How a touch-up works.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TouchUpSettings {
    /// On the ground.
    pub ground: GroundSettings,
    /// In the air; `None`: flights stay as they come from the ground pass.
    pub flight: Option<FlightSettings>,
}

/// A motion after its touch-up.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchedUp {
    /// The motion.
    pub clip: Clip,
    /// What was done on the ground.
    pub ground: GroundReport,
    /// What was done in the air; of no flights where that pass is left out.
    pub flight: FlightReport,
}

/// Why there is no touch-up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TouchUpError {
    /// None on the ground.
    #[error(transparent)]
    Ground(#[from] GroundError),
    /// None in the air.
    #[error(transparent)]
    Flight(#[from] FlightError),
}

/// `clip` touched up. See [`ground_pass`] and [`fly`] for what the arguments are. Cost: linear in frames times steps.
///
/// # Errors
/// [`TouchUpError`] for what does not fit together.
pub fn touch_up(
    clip: &Clip,
    body: &BodyModel,
    stages: &Stages,
    source: Option<&Source>,
    settings: &TouchUpSettings,
) -> Result<TouchedUp, TouchUpError> {
    let (clip, ground) = ground_pass(clip, body, stages, source, &settings.ground)?;
    let Some(in_flight) = &settings.flight else {
        return Ok(TouchedUp { clip, ground, flight: FlightReport::default() });
    };
    let Flown { clip, report: flight } = fly(&clip, body, stages, in_flight)?;
    Ok(TouchedUp { clip, ground, flight })
}
