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
