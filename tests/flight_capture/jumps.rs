//! Captured jumps, as they are and bent, with bodies and stages.

use std::path::Path;

use cotillion::clip::Clip;
use cotillion::clip::file::read_file;
use cotillion::clip::read::ReadOptions;
use cotillion::geometry::{c64, cis, plan_of, world_of, yaw};
use cotillion::index::SourceFrame;
use cotillion::physics::body_model::{BodyModel, BodySettings, body_model};
use cotillion::physics::posed::PosedClip;
use cotillion::physics::stages::{StageSettings, Stages, stages};
use libtest_mimic::Failed;

/// Headers of these say 24 frames a second, and are wrong: played so, bodies fall slower than they do.
const WRONG_RATE: &str = "snu_";
/// What they were captured at.
const RIGHT_RATE: f64 = 30.0;

/// A motion and what physics says of it.
#[derive(Clone)]
pub(crate) struct Jump {
    pub(crate) clip: Clip,
    pub(crate) body: BodyModel,
    pub(crate) stages: Stages,
}

/// A capture as it is.
pub(crate) fn load(folder: &Path, file: &str) -> Result<Jump, Failed> {
    let header = read_file(&folder.join(file), None, &ReadOptions::default())?.header_fps;
    let is_wrong = file.contains(WRONG_RATE) && (header - 24.0).abs() < 0.01;
    load_as(folder, file, is_wrong.then_some(RIGHT_RATE), 1.0)
}

/// The usable frames of a file declared to be of another rate, all lengths times `scale`.
pub(crate) fn load_as(folder: &Path, file: &str, fps: Option<f64>, scale: f64) -> Result<Jump, Failed> {
    let clip = read_file(&folder.join(file), None, &ReadOptions { fps, ..ReadOptions::default() })?.clip;
    let (first, last) = clip.usable;
    let mut poses: Vec<_> = (first.0..=last.0).map(|frame| clip.pose(SourceFrame(frame))).collect();
    let mut skeleton = (*clip.skeleton).clone();
    for joint in &mut skeleton.joints {
        joint.offset *= scale;
        joint.end_site = joint.end_site.map(|end| end * scale);
    }
    poses.iter_mut().for_each(|pose| pose.root *= scale);
    let clip = Clip::from_poses(&clip.name, skeleton.into(), clip.fps, &poses);
    let body = body_model(&clip.skeleton, &BodySettings::default())?;
    let stages = stages(&clip, &body, &PosedClip::of(&clip), &StageSettings::default());
    Ok(Jump { clip, body, stages })
}

impl Jump {
    /// Its path laid from its chord onto an arc that turns by `degrees`, bodies turned with it. Stages are those it had.
    pub(crate) fn bent(mut self, degrees: f64) -> Self {
        let turn = degrees.to_radians();
        let joints = self.clip.skeleton.joints.len();
        let roots = &self.clip.root_positions;
        let start = plan_of(roots[0]);
        let chord = plan_of(roots[roots.len() - 1]) - start;
        let (ahead, radius) = (chord / chord.norm(), chord.norm() / turn);
        for (frame, root) in self.clip.root_positions.iter_mut().enumerate() {
            let local = (plan_of(*root) - start) / ahead;
            let angle = local.re / radius;
            let laid = c64::new(0.0, radius) + c64::new(0.0, local.im - radius) * cis(angle);
            *root = world_of(start + ahead * laid, root.y);
            let rotation = &mut self.clip.rotations[frame * joints];
            *rotation = yaw(angle) * *rotation;
        }
        self
    }
}
