//! What the full body knows of the clips behind a track: how they are joined, and how hard they jerk limbs.

use std::sync::Arc;

use super::plant_mode;
use crate::clip::working::{WORKING_STEP, WorkingClip};
use crate::full_body::{Cut, Jerks, PlantMode, Seams};
use crate::index::CharacterId;
use crate::scene::Scene;
use crate::skeleton::Pose;
use crate::track::{Run, Track};

/// Seams of a track, seen at fractional frames of it, which rise.
pub(super) fn seams(track: &Track, frames: &[f64]) -> Seams {
    if track.runs.len() == 1 {
        return Seams::default();
    }
    let cut = |(index, (_, start)): (usize, (&Run, usize))| Cut {
        // What lies between two runs belongs to the later one.
        sample: frames.partition_point(|frame| *frame <= start as f64 - 1.0),
        matched: track.matched(index),
    };
    Seams {
        unblended: frames.iter().map(|frame| track.unblended(*frame)).collect(),
        cuts: track.placed_runs().enumerate().skip(1).map(cut).collect(),
    }
}

/// How hard the clips of somebody's track jerk the limbs: only contacts that are held as wholes ask. Cost: linear in the clips.
pub(super) fn source_jerks(scene: &Scene, who: CharacterId) -> Jerks {
    if plant_mode(scene) != PlantMode::Whole {
        return Jerks::default();
    }
    let jerks = |clip: &Arc<WorkingClip>| {
        let frames = 0..clip.frame_count();
        let times: Vec<f64> = frames.clone().map(|frame| frame as f64 * WORKING_STEP).collect();
        let poses: Vec<Pose> = frames.map(|frame| clip.pose(frame as f64)).collect();
        Jerks::of(&clip.clip.skeleton, &times, &poses)
    };
    let clips = scene.characters[who.as_usize()].track.clips.iter();
    clips.map(jerks).fold(Jerks::default(), Jerks::max)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::discrete::remap::spliced;
    use crate::scene::{ClipFolders, load_text};
    use crate::track::{Keep, Splice};

    fn walker(plants: &str) -> Scene {
        let text = format!(
            "fps = 30\n[clips]\nwalk = {{ builtin = \"walk\" }}\n[[character]]\nname = \"ann\"\ntrack = [\"walk\"]\n\
             [full_body]\nplants = \"{plants}\"\n"
        );
        load_text(&text, Path::new("walker.toml"), &ClipFolders::default()).expect("a sound scene").scene
    }

    /// Jerks of the frames that the track shows.
    fn shown(scene: &Scene) -> Jerks {
        let track = &scene.characters[0].track;
        let frames = 0..track.frame_count();
        let times: Vec<f64> = frames.clone().map(|frame| frame as f64 * WORKING_STEP).collect();
        let poses: Vec<Pose> = frames.map(|frame| track.pose(frame as f64)).collect();
        Jerks::of(&track.clips[0].clip.skeleton, &times, &poses)
    }

    #[test]
    fn frames_taken_out_of_a_track_still_say_how_hard_its_clip_jerks() {
        let scene = walker("whole");
        let whole = source_jerks(&scene, CharacterId(0));
        assert_eq!(whole, shown(&scene));
        let last = scene.characters[0].track.frame_count() - 1;
        let short = spliced(&scene, CharacterId(0), &Splice::delete(8, last), Keep::First).expect("a splice");
        assert!(shown(&short).knees < 0.9 * whole.knees, "{:?} {whole:?}", shown(&short));
        assert_eq!(source_jerks(&short, CharacterId(0)), whole);
    }

    #[test]
    fn only_contacts_held_as_wholes_ask_how_hard_clips_jerk() {
        for plants in ["as-captured", "pinned"] {
            assert_eq!(source_jerks(&walker(plants), CharacterId(0)), Jerks::default());
        }
    }
}
