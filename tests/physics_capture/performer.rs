//! Captures with bodies and stages.

use std::path::Path;

use cotillion::clip::Clip;
use cotillion::clip::file::read_file;
use cotillion::clip::read::ReadOptions;
use cotillion::index::SourceFrame;
use cotillion::physics::body_model::{BodyModel, BodySettings, Segment, body_model};
use cotillion::physics::posed::{PosedClip, centers_of_mass, link_places};
use cotillion::physics::stages::{StageSettings, Stages, stages};
use libtest_mimic::Failed;

use crate::is_missing;

/// Headers of these say 24 frames a second, and are wrong: played so, bodies fall slower than they do.
const WRONG_RATE: &str = "snu_";
/// What they were captured at.
const RIGHT_RATE: f64 = 30.0;

/// A capture and what physics says of it.
#[derive(Clone)]
pub(crate) struct Performance {
    pub(crate) clip: Clip,
    pub(crate) body: BodyModel,
    pub(crate) posed: PosedClip,
    pub(crate) stages: Stages,
}

impl Performance {
    pub(crate) fn has_one_trunk_link(&self) -> bool {
        is_missing(Segment::Abdomen, self)
    }

    /// Largest distance of the centre of mass from the root along the clip, metres.
    pub(crate) fn farthest_center(&self) -> f64 {
        let centers = centers_of_mass(&self.body, &link_places(&self.body, &self.posed));
        let distances =
            centers.iter().zip(&self.clip.root_positions).map(|(center, root)| center.distance(*root));
        distances.fold(0.0, f64::max)
    }
}

/// Names of all motions below the captures' folder.
pub(crate) fn motions(folder: &Path) -> Result<Vec<String>, Failed> {
    let mut names = Vec::new();
    for kind in ["amc", "bvh", "deepmimic"] {
        for entry in std::fs::read_dir(folder.join(kind))? {
            let name = entry?.file_name().to_string_lossy().into_owned();
            if !name.ends_with(".asf") {
                names.push(format!("{kind}/{name}"));
            }
        }
    }
    names.sort();
    Ok(names)
}

pub(crate) fn load(folder: &Path, file: &str) -> Result<Performance, Failed> {
    let header = read_file(&folder.join(file), None, &ReadOptions::default())?.header_fps;
    let is_wrong = file.contains(WRONG_RATE) && (header - 24.0).abs() < 0.01;
    load_as(folder, file, &ReadOptions { fps: is_wrong.then_some(RIGHT_RATE), ..ReadOptions::default() }, 1.0)
}

/// The usable frames of a file, all lengths times `scale`.
pub(crate) fn load_as(
    folder: &Path,
    file: &str,
    options: &ReadOptions,
    scale: f64,
) -> Result<Performance, Failed> {
    let clip = read_file(&folder.join(file), None, options)?.clip;
    let (first, last) = clip.usable;
    let mut poses: Vec<_> = (first.0..=last.0).map(|frame| clip.pose(SourceFrame(frame))).collect();
    let mut skeleton = (*clip.skeleton).clone();
    for joint in &mut skeleton.joints {
        joint.offset *= scale;
        joint.end_site = joint.end_site.map(|end| end * scale);
    }
    for pose in &mut poses {
        pose.root *= scale;
    }
    let clip = Clip::from_poses(&clip.name, skeleton.into(), clip.fps, &poses);
    let body = body_model(&clip.skeleton, &BodySettings::default())?;
    let posed = PosedClip::of(&clip);
    let stages = stages(&clip, &body, &posed, &StageSettings::default());
    Ok(Performance { clip, body, posed, stages })
}
