//! Poses of the edited track at any instant, and the edited motion on the scene's clock.
//!
//! A pose is sampled from its source at the source's own rate; the edit of the working path moves its root:
//! `p̂_u + e^{iφ_u}(x_s − p_u)`. At rest every track starts at scene time 0; output frame k is at `τ₀ + k/fps`.

use std::sync::Arc;

use rayon::prelude::*;

use crate::clip::Clip;
use crate::clip::contacts::{ContactPoint, Contacts};
use crate::edit::{Edit, EditedCharacter};
use crate::index::{CharacterId, floor_index};
use crate::scene::{Character, Scene};
use crate::skeleton::Pose;
use crate::track::Track;

pub use crate::edit::moved::{frame_at, time_of};

/// Clock ticks this near to an instant are at it, in ticks; so are working frames, in frames.
const ON_TICK: f64 = 1e-6;

/// The result on the scene's clock.
#[derive(Clone, Debug, PartialEq)]
pub struct Resampled {
    /// Scene time of output frame 0, seconds: 0, or a whole number of ticks below it.
    pub start_time: f64,
    /// Output frames of the whole scene.
    pub frames: usize,
    /// Whose motion this is, rising.
    pub members: Vec<CharacterId>,
    /// Edited motion of each of these, from output frame 0 to the character's last.
    pub clips: Vec<Clip>,
}

impl Resampled {
    /// Motion of a character; `None` where it is not among those sampled.
    pub fn clip(&self, who: CharacterId) -> Option<&Clip> {
        Some(&self.clips[self.members.binary_search(&who).ok()?])
    }
}

/// A result that would be out of all proportion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the result would have {frames:.0} frames, from {start_time:.0} s to {end_time:.0} s, more than memory is for; \
     everybody holds still from the first output frame to their own first"
)]
pub struct TooLong {
    /// Frames of all characters.
    pub frames: f64,
    /// Scene time of output frame 0, seconds.
    pub start_time: f64,
    /// Scene time of the last output frame, seconds.
    pub end_time: f64,
}

/// Most joint rotations of a result: some gigabytes.
const MOST_ROTATIONS: f64 = 1e8;

/// Samples all characters of an edit on the scene's clock. Cost: linear in output frames and joints.
///
/// # Errors
/// [`TooLong`] where times lie so far apart that the result would not fit in memory.
pub fn resample(scene: &Scene, edit: &Edit) -> Result<Resampled, TooLong> {
    let everybody: Vec<CharacterId> = (0..scene.characters.len()).map(CharacterId::from_usize).collect();
    resample_some(scene, edit, &everybody)
}

/// [`resample`] of some characters, on the clock of all. `members`: rising.
///
/// # Errors
/// [`TooLong`] where these would not fit in memory.
pub fn resample_some(scene: &Scene, edit: &Edit, members: &[CharacterId]) -> Result<Resampled, TooLong> {
    let start_tick = first_tick(scene, edit);
    check_size(scene, edit, (start_tick, members))?;
    let sample = |who: &CharacterId| {
        let (character, edited) = (&scene.characters[who.as_usize()], &edit.characters[who.as_usize()]);
        let track = &character.track;
        let count = frame_count(scene, (character, edited), start_tick);
        let poses: Vec<Pose> =
            (0..count).map(|k| edited.pose_at(track, (start_tick + k as f64) / scene.fps)).collect();
        let skeleton = Arc::clone(&track.clips[0].clip.skeleton);
        Clip::from_poses(&character.name, skeleton, scene.fps, &poses)
    };
    let everybody = scene.characters.iter().zip(&edit.characters);
    Ok(Resampled {
        start_time: start_tick / scene.fps,
        frames: everybody.map(|own| frame_count(scene, own, start_tick)).max().unwrap_or(1),
        members: members.to_vec(),
        clips: members.par_iter().map(sample).collect(),
    })
}

/// Output frames of a character.
fn frame_count(scene: &Scene, (character, edited): (&Character, &EditedCharacter), start_tick: f64) -> usize {
    let last = end_tick(scene.fps, edited.end_time(&character.track)).max(start_tick);
    floor_index(last - start_tick) + 1
}

fn check_size(
    scene: &Scene,
    edit: &Edit,
    (start_tick, members): (f64, &[CharacterId]),
) -> Result<(), TooLong> {
    let (mut frames, mut rotations, mut last_tick) = (0.0, 0.0, start_tick);
    for who in members {
        let (character, edited) = (&scene.characters[who.as_usize()], &edit.characters[who.as_usize()]);
        let last = end_tick(scene.fps, edited.end_time(&character.track)).max(start_tick);
        frames += last - start_tick + 1.0;
        rotations += (last - start_tick + 1.0) * character.track.clips[0].clip.skeleton.joints.len() as f64;
        last_tick = last_tick.max(last);
    }
    let (start_time, end_time) = (start_tick / scene.fps, last_tick / scene.fps);
    if rotations > MOST_ROTATIONS { Err(TooLong { frames, start_time, end_time }) } else { Ok(()) }
}

/// Contacts of the feet at fractional frames of a track: those of the nearer working frame.
pub fn shown_contacts_at(track: &Track, frames: &[f64]) -> Vec<Contacts> {
    let known = track.collect(|clip, frame, _| clip.contacts[frame]);
    frames.iter().map(|frame| nearest(&known, *frame)).collect()
}

/// Points of the feet and hands that bear at both working frames around fractional frames of a track: those that surely
/// stand there.
pub fn bearing_contacts_at(track: &Track, frames: &[f64]) -> Vec<Contacts> {
    let known = track.collect(|clip, frame, _| clip.contacts[frame]);
    let both = |frame: &f64| {
        let [before, mut after] =
            [(frame + ON_TICK).floor(), (frame - ON_TICK).ceil()].map(|frame| nearest(&known, frame));
        for point in ContactPoint::ALL {
            after.set(point, after.at(point) && before.at(point));
        }
        after
    };
    frames.iter().map(both).collect()
}

fn nearest(contacts: &[Contacts], frame: f64) -> Contacts {
    contacts[floor_index(frame.round()).min(contacts.len() - 1)]
}

/// Tick of output frame 0: the last one at or below both 0 and the earliest frame.
fn first_tick(scene: &Scene, edit: &Edit) -> f64 {
    let earliest = edit.characters.iter().map(|edited| edited.times[0]).fold(0.0, f64::min);
    (earliest * scene.fps + ON_TICK).floor().min(0.0)
}

/// Last tick at or before `time`.
fn end_tick(fps: f64, time: f64) -> f64 {
    (time * fps + ON_TICK).floor()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warped_times_are_inverted_as_in_the_reference() {
        let times = [0.0, 0.05, 0.08, 0.12, 0.2];
        let expected = [0.0, 0.6667, 1.5556, 2.5, 3.1667, 3.5833, 4.0];
        for (k, frame) in expected.into_iter().enumerate() {
            let found = frame_at(&times, 4.0, k as f64 / 30.0);
            assert!((found - frame).abs() < 5e-5, "output frame {k}: {found}");
        }
        assert_eq!(end_tick(30.0, 0.2), 6.0);
    }

    #[test]
    fn poses_are_held_before_the_first_and_after_the_last_frame() {
        let times = [1.0, 1.1, 1.2];
        assert_eq!(frame_at(&times, 2.0, 0.0), 0.0);
        assert_eq!(frame_at(&times, 2.0, 9.0), 2.0);
        assert_eq!(frame_at(&times, 2.5, 1.25), 2.5);
    }
}
