//! One clip of the captures on a track of its own, its last frame pulled about in space or in time.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use cotillion::clip::contacts::{Contacts, runs};
use cotillion::clip::file::read_file;
use cotillion::clip::read::ReadOptions;
use cotillion::clip::working::{WORKING_STEP, WorkingClip};
use cotillion::discrete::editor::{DiscreteEditor, Occasion};
use cotillion::discrete::outcome::Outcome;
use cotillion::discrete::settings::DiscreteSettings;
use cotillion::edit::Target;
use cotillion::embody::embody;
use cotillion::geometry::{c64, plan_of};
use cotillion::graph::{GraphSettings, motion_graph};
use cotillion::index::ConstraintId;
use cotillion::metrics::foot_slide_at;
use cotillion::resample::{resample, shown_contacts_at};
use cotillion::scene::{ClipFolders, Scene, load_text};
use cotillion::skeleton::{JointRole, Pose, Skeleton};
use cotillion::track::Track;
use libtest_mimic::Failed;

/// Where the last frame is to be, and when, seconds after the first; any time where nothing is said.
pub(crate) type End = (c64, Option<f64>);

/// What came of a drag.
pub(crate) struct Pulled {
    pub(crate) outcome: Outcome,
    /// One an update.
    pub(crate) steps: Vec<Step>,
    /// The track after each change, in the order of the log.
    pub(crate) changed: Vec<Track>,
}

/// The track after one update.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub(crate) frames: usize,
    /// Changes so far.
    pub(crate) changes: usize,
    /// Ground length of the track before bending, metres …
    pub(crate) rest: f64,
    /// … and after it.
    pub(crate) edited: f64,
}

/// Somebody who performs a clip, from its first frame that is no rest pose, or the frames `range` of it; with first and last
/// place, first time, and a last time where it is `timed`. `snu_*` are 30 frames a second.
pub(crate) fn read(
    folder: &Path,
    name: &str,
    range: Option<(u32, u32)>,
    timed: bool,
) -> Result<Scene, Failed> {
    let fps = name.contains("snu_").then_some(30.0);
    let clip = read_file(&folder.join(name), None, &ReadOptions { fps, ..ReadOptions::default() })?.clip;
    let (first, last) = range.unwrap_or((clip.usable.0.0, clip.usable.1.0));
    // To the last working frame, so that the track ends on one.
    let step = if clip.fps > 60.0 { 4 } else { 1 };
    let last = first + (last - first) / step * step;
    let rate = fps.map_or(String::new(), |fps| format!(", fps = {fps:?}"));
    let mut text = format!(
        "fps = 30\n[clips]\nc = {{ file = \"mocap:{name}\", frames = [{first}, {last}]{rate} }}\n\
         [[character]]\nname = \"a\"\ntrack = [\"c\"]\n\
         [[pin]]\nat = \"a:start\"\nposition = [0, 0]\nstrength = \"hard\"\n\
         [[pin]]\nat = \"a:end\"\nposition = [1, 0]\nstrength = \"hard\"\n\
         [[time]]\nat = \"a:start\"\nseconds = 0\nstrength = \"hard\"\n"
    );
    if timed {
        text += "[[time]]\nat = \"a:end\"\nseconds = 1\nstrength = \"hard\"\n";
    }
    let folders = ClipFolders { mocap: Some(folder.to_path_buf()) };
    let loaded = load_text(&text, Path::new("scene.toml"), &folders).map_err(|faults| faults.to_string())?;
    Ok(loaded.scene)
}

/// The only clip of a scene.
pub(crate) fn clip(scene: &Scene) -> &Arc<WorkingClip> {
    &scene.characters[0].track.clips[0]
}

/// First and last place of its root.
pub(crate) fn ends(scene: &Scene) -> (c64, c64) {
    let positions = &clip(scene).positions;
    (positions[0], positions[positions.len() - 1])
}

/// Takes the end of `scene` through `to`, one update each.
pub(crate) fn pull(scene: &Scene, to: &[End], settings: DiscreteSettings) -> Result<Pulled, Failed> {
    let clips = vec![Arc::clone(clip(scene))];
    let graph = Arc::new(motion_graph(&clips, &GraphSettings::default()));
    let (start, _) = ends(scene);
    let failed = |error: cotillion::edit::EditError| Failed::from(error.to_string());
    let mut editor = DiscreteEditor::new(scene.clone(), (graph, &clips), settings).map_err(failed)?;
    editor.move_target(ConstraintId(0), Target::Position(start)).map_err(failed)?;
    let (mut steps, mut changed) = (Vec::new(), Vec::new());
    for (step, (place, seconds)) in to.iter().enumerate() {
        editor.move_target(ConstraintId(1), Target::Position(*place)).map_err(failed)?;
        if let Some(seconds) = seconds {
            editor.move_target(ConstraintId(3), Target::Seconds(*seconds)).map_err(failed)?;
        }
        if editor.update(Occasion::Drag { drag: 0, step: step + 1 }).map_err(failed)? {
            changed.push(editor.scene().characters[0].track.clone());
        }
        let edited = &editor.edit().characters[0];
        steps.push(Step {
            frames: edited.positions.len(),
            changes: changed.len(),
            rest: length(&edited.rest.positions),
            edited: length(&edited.positions),
        });
    }
    Ok(Pulled { outcome: editor.into_outcome(), steps, changed })
}

fn length(path: &[c64]) -> f64 {
    path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}

/// What feet do: mean slide before and after the clean-up, m/s, and the mean length of a stride, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Feet {
    pub(crate) before: f64,
    pub(crate) after: f64,
    pub(crate) stride: f64,
}

/// Those of a result.
pub(crate) fn feet(outcome: &Outcome) -> Result<Feet, Failed> {
    let Outcome { scene, edit, .. } = outcome;
    let mut resampled = resample(scene, edit).map_err(|error| error.to_string())?;
    let embodied = embody(scene, edit, &mut resampled);
    let (body, track) = (&embodied.bodies[0], &scene.characters[0].track);
    let skeleton = &track.clips[0].clip.skeleton;
    let frames: Vec<f64> = body.times.iter().map(|time| edit.characters[0].frame_at(track, *time)).collect();
    let contacts = shown_contacts_at(track, &frames);
    let slide = |poses: &[Pose]| foot_slide_at(skeleton, (&body.times, poses), &contacts).unwrap_or(0.0);
    let mut strides = strides(skeleton, JointRole::LeftFoot, &body.poses, |at| contacts[at].left_foot());
    strides
        .extend(self::strides(skeleton, JointRole::RightFoot, &body.poses, |at| contacts[at].right_foot()));
    let stride = strides.iter().sum::<f64>() / strides.len() as f64;
    Ok(Feet { before: slide(&body.moved), after: slide(&body.poses), stride })
}

/// Distances between successive places of a foot; shorter ones than a step are the same place.
fn strides(skeleton: &Skeleton, foot: JointRole, poses: &[Pose], bears: impl Fn(usize) -> bool) -> Vec<f64> {
    const SHORTEST: f64 = 0.4;
    let Some(joint) = skeleton.joint_of(foot) else { return Vec::new() };
    let place = |at: usize| plan_of(skeleton.forward_kinematics(&poses[at])[joint.as_usize()].position);
    let labels: Vec<bool> = (0..poses.len()).map(bears).collect();
    let plants: Vec<c64> = runs(&labels)
        .into_iter()
        .map(|(first, last)| (first..=last).map(place).sum::<c64>() / (last - first + 1) as f64)
        .collect();
    plants.windows(2).map(|pair| (pair[1] - pair[0]).norm()).filter(|length| *length > SHORTEST).collect()
}

/// How often the track shows each frame of its clip.
pub(crate) fn shown(scene: &Scene) -> BTreeMap<usize, usize> {
    let mut shown = BTreeMap::new();
    for run in &scene.characters[0].track.runs {
        for frame in run.first.as_usize()..=run.last.as_usize() {
            *shown.entry(frame).or_default() += 1;
        }
    }
    shown
}

/// Slide of the feet in a clip, over the frames that a track shows of it, as often as it shows them, m/s.
pub(crate) fn shown_slide(track: &Track) -> f64 {
    let clip = &track.clips[0];
    let (mut poses, mut contacts) = (Vec::new(), Vec::new());
    for run in &track.runs {
        // The frame before a run is the one that its seam takes for the last of the run before.
        let frames = run.first.as_usize().saturating_sub(1)..=run.last.as_usize();
        contacts.extend(frames.clone().map(|frame| clip.contacts[frame]));
        poses.extend(frames.map(|frame| clip.pose(frame as f64)));
        // Nobody slides from one run to the next.
        contacts.push(Contacts::default());
        poses.push(clip.pose(run.last.as_usize() as f64));
    }
    let times: Vec<f64> = (0..poses.len()).map(|at| at as f64 * WORKING_STEP).collect();
    foot_slide_at(&clip.clip.skeleton, (&times, &poses), &contacts).unwrap_or(0.0)
}
