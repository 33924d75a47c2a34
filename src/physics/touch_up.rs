//! The touch-up: an edited motion made physically plausible.
//!
//! First the ground pass, for frames in which something bears. No hidden state: the same input gives the same output, and an edit can
//! be touched up again while it is dragged. Callers work on many characters in parallel.

use crate::clip::Clip;
use crate::physics::body_model::BodyModel;
use crate::physics::ground::report::GroundReport;
use crate::physics::ground::target::Source;
use crate::physics::ground::{GroundError, GroundSettings, ground_pass};
use crate::physics::stages::Stages;

/// How a touch-up works.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TouchUpSettings {
    /// On the ground.
    pub ground: GroundSettings,
}

/// A motion after its touch-up.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchedUp {
    /// The motion.
    pub clip: Clip,
    /// What was done on the ground.
    pub ground: GroundReport,
}

/// `clip` touched up. See [`ground_pass`] for what the arguments are. Cost: linear in frames times steps.
///
/// # Errors
/// [`GroundError`] for what does not fit together.
pub fn touch_up(
    clip: &Clip,
    body: &BodyModel,
    stages: &Stages,
    source: Option<&Source>,
    settings: &TouchUpSettings,
) -> Result<TouchedUp, GroundError> {
    let (clip, ground) = ground_pass(clip, body, stages, source, &settings.ground)?;
    Ok(TouchedUp { clip, ground })
}
