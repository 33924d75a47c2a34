//! Captures with bodies and stages, and edits of them.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::derived::{Share, bent, blended, tilted};
use cotillion::clip::file::read_file;
use cotillion::clip::gait::gait;
use cotillion::clip::read::ReadOptions;
use cotillion::clip::working::WorkingClip;
use cotillion::index::SourceFrame;
use cotillion::physics::body_model::{BodyModel, BodySettings, body_model};
use cotillion::physics::ground::target::Source;
use cotillion::physics::posed::PosedClip;
use cotillion::physics::stages::{StageSettings, Stages, stages};
use libtest_mimic::Failed;

/// Headers of these say 24 frames a second, and are wrong: played so, bodies fall slower than they do.
const WRONG_RATE: &str = "snu_";
/// What they were captured at.
const RIGHT_RATE: f64 = 30.0;

/// A capture and what physics says of it.
#[derive(Clone)]
pub(crate) struct Performance {
    pub(crate) clip: Clip,
    pub(crate) body: BodyModel,
    pub(crate) stages: Stages,
}

/// The usable frames of a file.
pub(crate) fn load(folder: &Path, file: &str) -> Result<Performance, Failed> {
    let path = folder.join(file);
    let header = read_file(&path, None, &ReadOptions::default())?.header_fps;
    let is_wrong = file.contains(WRONG_RATE) && (header - 24.0).abs() < 0.01;
    let options = ReadOptions { fps: is_wrong.then_some(RIGHT_RATE), ..ReadOptions::default() };
    let clip = read_file(&path, None, &options)?.clip;
    let (first, last) = clip.usable;
    let poses: Vec<_> = (first.0..=last.0).map(|frame| clip.pose(SourceFrame(frame))).collect();
    Performance::of(Clip::from_poses(&clip.name, clip.skeleton.clone(), clip.fps, &poses))
}

impl Performance {
    pub(crate) fn of(clip: Clip) -> Result<Self, Failed> {
        let body = body_model(&clip.skeleton, &BodySettings::default())?;
        let stages = stages(&clip, &body, &PosedClip::of(&clip), &StageSettings::default());
        Ok(Self { clip, body, stages })
    }
}

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
        let Performance { clip, body, stages } = capture.clone();
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
        let Performance { clip, body, stages } = Performance::of(blend.clip)?;
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
