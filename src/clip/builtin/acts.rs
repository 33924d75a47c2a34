//! Clips of standing and of a slap.

use super::body::Body;
use super::stand;
use super::{BuiltinInfo, BuiltinParameter, Generator, Made, STATURE, Values, frame_at};
use crate::skeleton::Pose;

pub(super) const ALL: &[Generator] =
    &[Generator { info: IDLE, make: idle }, Generator { info: SLAP, make: slap }];

const IDLE: BuiltinInfo = BuiltinInfo {
    name: "idle",
    description: "stands on both feet, breathing and swaying a little; ends as it began",
    parameters: &[
        BuiltinParameter {
            name: "seconds",
            description: "length",
            unit: "s",
            default: 3.0,
            range: (1.0, 600.0),
        },
        STATURE,
    ],
    events: &[],
};

const SLAP: BuiltinInfo = BuiltinInfo {
    name: "slap",
    description: "stands, claps the right hand forward into another's at shoulder height, stands again",
    parameters: &[
        BuiltinParameter {
            name: "seconds",
            description: "length; the hand hits after two fifths of it",
            unit: "s",
            default: 3.0,
            range: (2.4, 10.0),
        },
        STATURE,
    ],
    events: &["hit"],
};

fn idle(body: &Body, values: &Values) -> Made {
    on_the_spot(body, values, stand::idle)
}

fn slap(body: &Body, values: &Values) -> Made {
    let made = on_the_spot(body, values, stand::slap);
    let last_frame = made.poses.len() - 1;
    Made { events: vec![frame_at(stand::SLAP_HIT * last_frame as f64 / super::FPS)], ..made }
}

/// A clip whose pose depends on the body, its seconds and the share of it that has passed.
fn on_the_spot(body: &Body, values: &Values, pose: fn(&Body, f64, f64) -> Pose) -> Made {
    let last_frame = frame_at(values["seconds"]);
    let seconds = last_frame as f64 / super::FPS;
    let poses = (0..=last_frame).map(|frame| pose(body, seconds, frame as f64 / last_frame as f64)).collect();
    Made { poses, events: Vec::new() }
}
