//! An edit with all constraints at rest returns the input: on tracks of one clip, at the clip's own rate, every frame to
//! 1e-6 (metres and radians). Real capture is reported as skipped where there is none.

use std::fs;
use std::path::{Path, PathBuf};

use cotillion::clip::Clip;
use cotillion::edit::Editor;
use cotillion::geometry::{cis, log};
use cotillion::index::SourceFrame;
use cotillion::resample::resample;
use cotillion::scene::{ClipFolders, Scene, load_text};
use libtest_mimic::{Arguments, Failed, Trial};

/// Largest change of a root position, metres, and of a joint rotation, radians.
const SAME: f64 = 1e-6;

fn main() {
    let arguments = Arguments::from_args();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let named = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    let capture = named.or_else(|| Some(root.join("../shared/mocap"))).filter(|folder| folder.is_dir());
    let mut trials: Vec<Trial> = ["walk", "idle", "slap"]
        .map(|name| {
            Trial::test(format!("builtin:{name}"), move || unchanged(&format!("builtin:{name}"), None))
        })
        .into();
    match capture {
        None => trials.push(Trial::test("real capture", || Ok(())).with_ignored_flag(true)),
        Some(folder) => {
            for file in captured(&folder) {
                let folder = folder.clone();
                trials.push(Trial::test(file.clone(), move || {
                    unchanged(&format!("mocap:{file}"), Some(folder))
                }));
            }
        }
    }
    libtest_mimic::run(&arguments, trials).exit();
}

fn captured(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder.join("bvh")).into_iter().flatten().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| format!("bvh/{}", entry.file_name().to_string_lossy())).collect();
    names.sort();
    assert!(names.len() > 20, "the capture is complete");
    names
}

/// The scene of two people who perform `source`, placed apart, without constraints.
fn bare(source: &str, fps: f64) -> String {
    format!(
        "fps = {fps:?}\n[clips]\nown = {source:?}\n\
         [[character]]\nname = \"a\"\ntrack = [\"own\"]\n\
         [[character]]\nname = \"b\"\ntrack = [\"own\"]\nposition = [3.0, -2.0]\nfacing = 70.0\n"
    )
}

fn loaded(text: &str, capture: Option<&PathBuf>) -> Result<Scene, Failed> {
    let folders = ClipFolders { mocap: capture.cloned() };
    let loaded =
        load_text(text, Path::new("identity.toml"), &folders).map_err(|faults| faults.to_string())?;
    Ok(loaded.scene)
}

fn unchanged(source: &str, capture: Option<PathBuf>) -> Result<(), Failed> {
    let fps = loaded(&bare(source, 30.0), capture.as_ref())?.characters[0].track.clips[0].clip.fps;
    let mut text = bare(source, fps);
    let scene = loaded(&text, capture.as_ref())?;
    let own = &scene.characters[0].track.clips[0];
    let (first, last) = (own.first.0, own.last.0);
    let middle = first + (last - first) / 3 + 1;
    for frame in [first, middle, last] {
        text += &at_rest(&scene, frame);
    }
    let scene = loaded(&text, capture.as_ref())?;
    let mut editor = Editor::new(scene).map_err(|error| error.to_string())?;
    let edit = editor.solve().map_err(|error| error.to_string())?.clone();
    if edit.energy.total > 1e-9 {
        return Err(format!("an edit that asks for nothing costs {:e}", edit.energy.total).into());
    }
    let resampled = resample(editor.scene(), &edit).map_err(|error| error.to_string())?;
    for (character, result) in editor.scene().characters.iter().zip(&resampled.clips) {
        let track = &character.track;
        if result.frame_count() != (last - first + 1) as usize {
            return Err(format!("{} frames of {}", result.frame_count(), last - first + 1).into());
        }
        same(&track.clips[0].clip, first, result, &track.runs[0].placement)?;
    }
    Ok(())
}

/// Constraints of all kinds that hold at rest, at one frame of the clip.
fn at_rest(scene: &Scene, frame: u32) -> String {
    let mut text = String::new();
    for (index, name) in ["a", "b"].into_iter().enumerate() {
        let track = &scene.characters[index].track;
        let working = track.clips[0].working_frame(f64::from(frame));
        let root = track.pose(working).root;
        let (x, y, facing) = (root.x, -root.z, track.heading(working).to_degrees());
        let strength = if index == 0 { "\"hard\"" } else { "3.0" };
        text += &format!(
            "[[pin]]\nat = \"{name}:{frame}\"\nposition = [{x:?}, {y:?}]\nfacing = {facing:?}\nstrength = {strength}\n"
        );
    }
    text + &format!(
        "[[relative]]\nat = \"b:{frame}\"\nto = \"a:{frame}\"\nfacing = \"rest\"\nstrength = \"hard\"\n\
         [[sync]]\nmoments = [\"a:{frame}\", \"b:{frame}\"]\nstrength = \"hard\"\n"
    )
}

fn same(
    source: &Clip,
    first: u32,
    result: &Clip,
    placement: &cotillion::geometry::RigidMotion,
) -> Result<(), Failed> {
    let turn = cotillion::geometry::yaw(placement.angle());
    assert!((cis(placement.angle()) - placement.turn).norm() < 1e-12);
    for frame in 0..result.frame_count() {
        let expected = source.pose(SourceFrame(first + u32::try_from(frame)?));
        let found = result.pose(SourceFrame(u32::try_from(frame)?));
        let moved = found.root.distance(placement.apply_world(expected.root));
        let mut turned = log((turn * expected.rotations[0]).inverse() * found.rotations[0]).length();
        for (a, b) in expected.rotations.iter().zip(&found.rotations).skip(1) {
            turned = turned.max(log(a.inverse() * *b).length());
        }
        if moved.is_nan() || turned.is_nan() || moved.max(turned) >= SAME {
            return Err(format!("frame {frame} is off by {moved:e} m, {turned:e} rad").into());
        }
    }
    Ok(())
}
