//! The edited motion of a character at any instant: when a frame is shown, and the pose there.

use crate::clip::working::WORKING_STEP;
use crate::edit::facing::Turns;
use crate::geometry::c64;
use crate::geometry::{cis, plan_of, world_of, yaw};
use crate::index::CharacterId;
use crate::object_motion::Performance;
use crate::path::{self, RestPath};
use crate::scene::Scene;
use crate::skeleton::Pose;
use crate::track::Track;

/// Motion path and times of one character after the edit.
#[derive(Clone, Debug, PartialEq)]
pub struct EditedCharacter {
    /// Before the edit.
    pub rest: RestPath,
    /// Ground position of each working frame after the edit, metres.
    pub positions: Vec<c64>,
    /// Turn of the body against rest.
    pub turns: Turns,
    /// Scene time of each working frame, seconds; rising.
    pub times: Vec<f64>,
}

/// Frame (a fraction) shown at `time`: held at the first frame before, and at `last` after. `times` rise.
pub fn frame_at(times: &[f64], last: f64, time: f64) -> f64 {
    if times.len() < 2 || time <= times[0] {
        return 0.0;
    }
    let low = times.partition_point(|t| *t <= time).saturating_sub(1).min(times.len() - 2);
    let share = (time - times[low]) / (times[low + 1] - times[low]);
    (low as f64 + share).min(last)
}

/// Scene time at which a fractional frame is shown, seconds.
pub fn time_of(times: &[f64], frame: f64) -> f64 {
    let (low, high, share) = path::bracket(frame, times.len());
    times[low] + share * (times[high] - times[low])
}

impl EditedCharacter {
    /// The motion before an edit.
    pub fn at_rest(rest: RestPath) -> Self {
        Self {
            positions: rest.positions.clone(),
            turns: Turns { along_path: vec![0.0; rest.len()], ..Turns::default() },
            times: (0..rest.len()).map(|frame| frame as f64 * WORKING_STEP).collect(),
            rest,
        }
    }

    /// Scene time of the last frame of the track, seconds.
    pub fn end_time(&self, track: &Track) -> f64 {
        time_of(&self.times, track.frame_count() as f64 - 1.0 + track.overhang())
    }

    /// Frame of the track shown at a scene time, held before the first and after the last frame.
    pub fn frame_at(&self, track: &Track, time: f64) -> f64 {
        let last = track.frame_count() as f64 - 1.0 + track.overhang();
        snap(frame_at(&self.times, last, time))
    }

    /// Pose at a scene time, held before the first and after the last frame.
    pub fn pose_at(&self, track: &Track, time: f64) -> Pose {
        self.pose(track, self.frame_at(track, time))
    }

    /// Edited pose at a fractional frame of the track.
    pub fn pose(&self, track: &Track, frame: f64) -> Pose {
        let mut pose = track.pose(frame);
        let turn = self.turns.at(frame);
        let detail = plan_of(pose.root) - path::at(&self.rest.positions, frame);
        let place = path::at(&self.positions, frame) + cis(turn) * detail;
        pose.root = world_of(place, pose.root.y);
        pose.rotations[0] = yaw(turn) * pose.rotations[0];
        pose
    }
}

/// Frames within rounding of a whole frame are that frame.
pub fn snap(frame: f64) -> f64 {
    let whole = frame.round();
    if (frame - whole).abs() < 1e-7 { whole } else { frame }
}

/// Everybody as the edit moves them, joint angles as before it.
#[derive(Clone, Copy)]
pub struct Moved<'a> {
    /// Whose tracks.
    pub scene: &'a Scene,
    /// As in the scene.
    pub characters: &'a [EditedCharacter],
}

impl Performance for Moved<'_> {
    fn time(&self, who: CharacterId, frame: f64) -> f64 {
        time_of(&self.characters[who.as_usize()].times, frame)
    }

    fn frame(&self, who: CharacterId, seconds: f64) -> f64 {
        let who = who.as_usize();
        self.characters[who].frame_at(&self.scene.characters[who].track, seconds)
    }

    fn pose(&self, who: CharacterId, frame: f64) -> Pose {
        let who = who.as_usize();
        self.characters[who].pose(&self.scene.characters[who].track, frame)
    }
}
