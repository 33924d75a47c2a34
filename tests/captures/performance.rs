//! Captures with bodies and stages.

use std::path::Path;

use cotillion::clip::Clip;
use cotillion::clip::file::read_file;
use cotillion::clip::read::ReadOptions;
use cotillion::index::SourceFrame;
use cotillion::physics::body_model::{BodyModel, BodySettings, body_model};
use cotillion::physics::posed::PosedClip;
use cotillion::physics::stages::{StageSettings, Stages, stages};
use libtest_mimic::Failed;

use crate::captures::read_at_own_rate;

/// A motion and what physics says of it.
#[derive(Clone)]
pub(crate) struct Performance {
    pub(crate) clip: Clip,
    pub(crate) body: BodyModel,
    #[allow(dead_code, reason = "shared with tests that pose what they edit")]
    pub(crate) posed: PosedClip,
    pub(crate) stages: Stages,
}

impl Performance {
    pub(crate) fn of(clip: Clip) -> Result<Self, Failed> {
        let body = body_model(&clip.skeleton, &BodySettings::default())?;
        let posed = PosedClip::of(&clip);
        let stages = stages(&clip, &body, &posed, &StageSettings::default());
        Ok(Self { clip, body, posed, stages })
    }
}

/// The usable frames of a file.
pub(crate) fn load(folder: &Path, file: &str) -> Result<Performance, Failed> {
    Performance::of(scaled(&read_at_own_rate(folder, file)?, 1.0))
}

/// The usable frames of a file declared to be of another rate, all lengths times `scale`.
#[allow(dead_code, reason = "shared with tests that take captures as they are")]
pub(crate) fn load_as(
    folder: &Path,
    file: &str,
    fps: Option<f64>,
    scale: f64,
) -> Result<Performance, Failed> {
    let clip = read_file(&folder.join(file), None, &ReadOptions { fps, ..ReadOptions::default() })?.clip;
    Performance::of(scaled(&clip, scale))
}

/// The usable frames of `clip`, all lengths times `scale`.
fn scaled(clip: &Clip, scale: f64) -> Clip {
    let (first, last) = clip.usable;
    let mut poses: Vec<_> = (first.0..=last.0).map(|frame| clip.pose(SourceFrame(frame))).collect();
    let mut skeleton = (*clip.skeleton).clone();
    for joint in &mut skeleton.joints {
        joint.offset *= scale;
        joint.end_site = joint.end_site.map(|end| end * scale);
    }
    poses.iter_mut().for_each(|pose| pose.root *= scale);
    Clip::from_poses(&clip.name, skeleton.into(), clip.fps, &poses)
}

/// All of `faults` as one, if there are any.
pub(crate) fn verdict(faults: Vec<String>) -> Result<(), Failed> {
    if faults.is_empty() { Ok(()) } else { Err(faults.join("\n").into()) }
}
