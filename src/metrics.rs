//! Measures of any clip, captured or edited, and of what an edit does to feet.

pub use crate::clip::measure::{foot_slide, foot_slide_at, foot_slide_working, root_path, standing_height};
use crate::embody::sample_times;
use crate::index::CharacterId;
use crate::object_motion::{AtRest, Performance, skeleton_of};
use crate::resample::bearing_contacts_at;
use crate::scene::Scene;
use crate::skeleton::Pose;
use crate::ties::Ties;

/// Mean slide of a character's feet, m/s: before the edit, and in `result`; 0 where nothing bears.
///
/// Both are measured at the same instants of the character's own motion, those that the result shows, but for waiting in the
/// first or last pose; both count the same steps: where a point bears at both ends, at the working frames on either side.
/// So the numbers compare whatever the clock's phase. `clock`: scene time of output frame 0, and how many the character has.
/// Cost: linear in output frames and joints.
pub fn shown_slides(
    (scene, ties): (&Scene, &Ties),
    result: &impl Performance,
    who: CharacterId,
    clock: (f64, usize),
) -> [f64; 2] {
    let track = &scene.characters[who.as_usize()].track;
    let last = track.frame_count() as f64 - 1.0 + track.overhang();
    let [start, end] = [0.0, last].map(|frame| result.time(who, frame));
    let mut times = sample_times((scene, ties), result, who, clock);
    times.retain(|time| (start..=end).contains(time));
    let frames: Vec<f64> = times.iter().map(|time| result.frame(who, *time)).collect();
    let bears = bearing_contacts_at(track, &frames);
    let skeleton = skeleton_of(scene, who);
    let rest = AtRest(scene);
    let captured: Vec<Pose> = frames.iter().map(|frame| rest.pose(who, *frame)).collect();
    let own_times: Vec<f64> = frames.iter().map(|frame| rest.time(who, *frame)).collect();
    let edited: Vec<Pose> = frames.iter().map(|frame| result.pose(who, *frame)).collect();
    [(own_times, captured), (times, edited)]
        .map(|(times, poses)| foot_slide_at(skeleton, (&times, &poses), &bears).unwrap_or(0.0))
}
