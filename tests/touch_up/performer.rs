//! Edits of captures.

use std::ops::Range;
use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::derived::{Share, bent, blended, tilted};
use cotillion::clip::gait::gait;
use cotillion::clip::working::WorkingClip;
use cotillion::physics::body_model::BodyModel;
use cotillion::physics::ground::target::Source;
use cotillion::physics::stages::Stages;
use libtest_mimic::Failed;

use crate::performance::Performance;

/// An edit of a capture. Labels are those of the capture, but of blends.
#[derive(Clone)]
pub(crate) struct Edited {
    pub(crate) clip: Clip,
    pub(crate) body: BodyModel,
    pub(crate) stages: Stages,
    pub(crate) source: Option<Source>,
}

impl Edited {
    pub(crate) fn untouched(capture: &Performance) -> Self {
        let Performance { clip, body, stages, .. } = capture.clone();
        let source = Some(Source::of(&clip, &body, &stages));
        Self { clip, body, stages, source }
    }

    pub(crate) fn bent(capture: &Performance, radius: f64) -> Result<Self, Failed> {
        Ok(Self { clip: bent(&capture.clip, radius)?, ..Self::untouched(capture) })
    }

    pub(crate) fn tilted(capture: &Performance, degrees: f64) -> Result<Self, Failed> {
        Ok(Self { clip: tilted(&capture.clip, degrees.to_radians())?, ..Self::untouched(capture) })
    }

    /// And the frames of the blended cycle.
    pub(crate) fn blended(from: &Performance, to: &Performance) -> Result<(Self, Range<usize>), Failed> {
        let blend = blended(&from.clip, &to.clip)?;
        let is_mixed = |share: &&Share| share.weight <= 0.0;
        let first = blend.shares.iter().take_while(is_mixed).count();
        let cycle = first..blend.alone_from().as_usize();
        let Performance { clip, body, stages, .. } = Performance::of(blend.clip)?;
        Ok((Self { clip, body, stages, source: None }, cycle))
    }

    /// Frames of its median cycle.
    pub(crate) fn stride(&self) -> usize {
        let clip = &self.clip;
        let working = WorkingClip::new("stride", Arc::new(clip.clone()), clip.usable.0, clip.usable.1);
        let moves: Vec<bool> = working.stationary.iter().map(|stands| !stands).collect();
        let frames = gait(&working.contacts, &moves).cycle.unwrap_or(33) as f64 * clip.fps / 30.0;
        cotillion::index::floor_index(frames.round())
    }

    /// Frames from the ends of a clip within which displacements fade: half the widest kernel and what filters have no data for.
    pub(crate) fn edge(&self) -> usize {
        cotillion::index::floor_index((0.17 + 20.0 / 30.0) * self.clip.fps)
    }
}
