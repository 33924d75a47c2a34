//! Captures with bodies and stages.
//!
//! They are looked for in `$COTILLION_MOCAP`, else in `../shared/mocap` beside the checkout.

use std::path::{Path, PathBuf};

use cotillion::clip::Clip;
use cotillion::clip::file::read_file;
use cotillion::clip::read::ReadOptions;
use cotillion::index::SourceFrame;
use cotillion::physics::body_model::{BodyModel, BodySettings, body_model};
use cotillion::physics::posed::PosedClip;
use cotillion::physics::stages::{StageSettings, Stages, stages};
use libtest_mimic::{Failed, Trial};

/// Headers of these say 24 frames a second, and are wrong: played so, bodies fall slower than they do.
const WRONG_RATE: &str = "snu_";
/// What they were captured at.
const RIGHT_RATE: f64 = 30.0;

/// Where captures are; `None` where there are none.
pub(crate) fn mocap_folder() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/mocap");
    let set = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    [set, Some(beside)].into_iter().flatten().find(|folder| folder.is_dir())
}

/// What a test does with a capture of the folder.
pub(crate) type Run = fn(&Path, &str) -> Result<(), Failed>;

/// `run` on `file` of `folder`; ignored, by name, where there is no folder.
pub(crate) fn trial(folder: Option<&Path>, name: String, run: Run, file: &'static str) -> Trial {
    let folder = folder.map(Path::to_owned);
    let is_missing = folder.is_none();
    Trial::test(name, move || match folder {
        Some(folder) => run(&folder, file),
        None => Err("no captures found".into()),
    })
    .with_ignored_flag(is_missing)
}

/// All of `faults` as one, if there are any.
pub(crate) fn verdict(faults: Vec<String>) -> Result<(), Failed> {
    if faults.is_empty() { Ok(()) } else { Err(faults.join("\n").into()) }
}

/// Names of all motions below `folder`.
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

/// A motion and what physics says of it.
#[derive(Clone)]
pub(crate) struct Capture {
    pub(crate) clip: Clip,
    pub(crate) body: BodyModel,
    pub(crate) posed: PosedClip,
    pub(crate) stages: Stages,
}

impl Capture {
    pub(crate) fn of(clip: Clip) -> Result<Self, Failed> {
        let body = body_model(&clip.skeleton, &BodySettings::default())?;
        let posed = PosedClip::of(&clip);
        let stages = stages(&clip, &body, &posed, &StageSettings::default());
        Ok(Self { clip, body, posed, stages })
    }
}

/// The usable frames of a file, at the rate it was captured at.
pub(crate) fn load(folder: &Path, file: &str) -> Result<Capture, Failed> {
    let header = read_file(&folder.join(file), None, &ReadOptions::default())?.header_fps;
    let is_wrong = file.contains(WRONG_RATE) && (header - 24.0).abs() < 0.01;
    load_as(folder, file, is_wrong.then_some(RIGHT_RATE), 1.0)
}

/// The usable frames of a file declared to be of another rate, all lengths times `scale`.
pub(crate) fn load_as(folder: &Path, file: &str, fps: Option<f64>, scale: f64) -> Result<Capture, Failed> {
    let clip = read_file(&folder.join(file), None, &ReadOptions { fps, ..ReadOptions::default() })?.clip;
    let (first, last) = clip.usable;
    let mut poses: Vec<_> = (first.0..=last.0).map(|frame| clip.pose(SourceFrame(frame))).collect();
    let mut skeleton = (*clip.skeleton).clone();
    for joint in &mut skeleton.joints {
        joint.offset *= scale;
        joint.end_site = joint.end_site.map(|end| end * scale);
    }
    poses.iter_mut().for_each(|pose| pose.root *= scale);
    Capture::of(Clip::from_poses(&clip.name, skeleton.into(), clip.fps, &poses))
}
