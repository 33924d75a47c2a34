//! Clips of sitting down on a chair behind, and of standing up from it.
//!
//! The centre of mass stays over the feet until the seat bears; how far back the seat is follows from that, with the trunk's lean.

use super::body::{Body, Side};
use super::keyed::Curve;
use super::lift::backwards;
use super::performance::Performance;
use super::{BuiltinInfo, BuiltinParameter, FPS, Generator, Made, STATURE, Values, frame_at, stand};

pub(super) const ALL: &[Generator] =
    &[Generator { info: SIT_DOWN, make: sit_down }, Generator { info: STAND_UP, make: stand_up }];

const SIT_DOWN: BuiltinInfo = BuiltinInfo {
    name: "sit_down",
    description: "sits down on the chair behind, leaning forward until the seat bears; feet stay",
    parameters: &[SECONDS, SEAT, STATURE],
    events: &["seated"],
};

const STAND_UP: BuiltinInfo = BuiltinInfo {
    name: "stand_up",
    description: "stands up from a chair, a sit_down backwards; seated is its last frame on the seat",
    parameters: &[SECONDS, SEAT, STATURE],
    events: &["seated"],
};

const SECONDS: BuiltinParameter =
    BuiltinParameter { name: "seconds", description: "length", unit: "s", default: 3.0, range: (2.0, 10.0) };

const SEAT: BuiltinParameter = BuiltinParameter {
    name: "seat",
    description: "height of the seat; who sits has the pelvis 0.13 m above it, at another stature in proportion",
    unit: "m",
    default: 0.45,
    range: (0.3, 0.5),
};

/// Pelvis above the seat, metres at 1.75 m.
const PELVIS_OVER_SEAT: f64 = 0.13;
/// Centre of mass behind the ankles when the seat takes over, metres at 1.75 m; heels are farther back.
const BEHIND: f64 = 0.015;
/// Pitch of the pelvis, bend of the back, swing and bend of the arms when the seat takes over, radians.
const LEANING: (f64, f64) = (0.62, 0.34);
/// Pitch and bend on the lowest seats, where the thighs leave the pelvis no room.
const LEANING_LOW: (f64, f64) = (0.22, 1.00);
const BALANCING: (f64, f64) = (-0.60, 1.00);
/// The same when sitting.
const SITTING: (f64, f64) = (-0.06, 0.10);
const RESTING: (f64, f64) = (-0.30, 0.80);
/// Drop of the pelvis from which on people lean so much, metres at 1.75 m.
const FULL_DROP: f64 = 0.30;
/// Drop on the lowest seats, metres at 1.75 m.
const LOWEST_DROP: f64 = 0.57;

/// When the seat bears and when the trunk is upright again, as shares of the clip.
const SEATED: f64 = 0.60;
const UPRIGHT: f64 = 0.96;

fn sit_down(body: &Body, values: &Values) -> Made {
    let last_frame = frame_at(values["seconds"]);
    let seconds = last_frame as f64 / FPS;
    let seated_frame = frame_at(SEATED * seconds);
    let seated = seated_frame as f64 / FPS;
    let times = [0.03 * seconds, seated, UPRIGHT * seconds];
    let mut act = Performance::standing(body);
    let height = stand::pelvis_height(body);
    let low = values["seat"] + PELVIS_OVER_SEAT * body.scale;
    let drop = (height - low) / body.scale;
    let lean = (drop / FULL_DROP).min(1.0);
    let deep = ((drop - FULL_DROP) / (LOWEST_DROP - FULL_DROP)).clamp(0.0, 1.0);
    let leaning = |high: f64, low: f64| high + deep * (low - high);
    let key = |still: f64, down: f64, sitting: f64| {
        let down = still + lean * (down - still);
        Curve::through(&[(times[0], still), (times[1], down), (times[2], sitting)])
    };
    let center = Performance::standing_center(body);
    act.height.pelvis = Curve::through(&[(times[0], height), (times[1], low)]);
    act.over[1] = Curve::through(&[(0.0, center.z), (seated, -BEHIND * body.scale)]);
    act.trunk.pitch = key(0.0, leaning(LEANING.0, LEANING_LOW.0), SITTING.0);
    act.trunk.bend = key(stand::LEAN, leaning(LEANING.1, LEANING_LOW.1), SITTING.1);
    act.trunk.gaze = key(0.0, 0.35, 0.0);
    for side in Side::BOTH {
        let arm = &mut act.arms[side.index()];
        arm.swing = key(stand::HANGING_ARM.0, BALANCING.0, RESTING.0);
        arm.bend = key(stand::HANGING_ARM.1, BALANCING.1, RESTING.1);
    }
    act.seat = Some((seated, act.pose(seated).root.z));
    act.made(last_frame, vec![seated_frame])
}

fn stand_up(body: &Body, values: &Values) -> Made {
    backwards(sit_down(body, values))
}
