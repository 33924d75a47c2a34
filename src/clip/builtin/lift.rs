//! Clips of a box that is picked up, put down, handed over and taken over with both hands.
//!
//! The palms are half way up its sides, [`HELD`] before the waist; clips that begin or end with a box begin or end so, and
//! stand otherwise as an idle clip does. Lengths are for 1.75 m and scale with the stature, but for the box.

use glam::DVec3;

use super::arms::palm_from_wrist;
use super::body::{Body, FOREARM, Side, UPPER_ARM, arm_joints};
use super::crouch;
use super::keyed::Curve;
use super::performance::{Performance, ReachTrack};
use super::{BuiltinInfo, BuiltinParameter, FPS, Generator, Made, STATURE, Values, frame_at, stand};

pub(super) const ALL: &[Generator] = &[
    Generator { info: PICK_UP, make: pick_up },
    Generator { info: PUT_DOWN, make: put_down },
    Generator { info: HAND_OVER, make: hand_over },
    Generator { info: TAKE_OVER, make: take_over },
];

const PICK_UP: BuiltinInfo = BuiltinInfo {
    name: "pick_up",
    description: "bends knees and back, grasps a box on the floor, or on something, with both hands and brings it to the waist",
    parameters: &[seconds(3.0), BOX_WIDTH, BOX_HEIGHT, ON, STATURE],
    events: &["grasp"],
};

const PUT_DOWN: BuiltinInfo = BuiltinInfo {
    name: "put_down",
    description: "puts a box from the waist on the floor, or on something; a pick_up backwards",
    parameters: &[seconds(3.0), BOX_WIDTH, BOX_HEIGHT, ON, STATURE],
    events: &["release"],
};

const HAND_OVER: BuiltinInfo = BuiltinInfo {
    name: "hand_over",
    description: "holds a box at the waist, stretches both arms ahead and lets a partner take it",
    parameters: &[seconds(2.4), BOX_WIDTH, STATURE],
    events: &["release"],
};

const TAKE_OVER: BuiltinInfo = BuiltinInfo {
    name: "take_over",
    description: "takes a box from a partner's hands to the waist; a hand_over backwards",
    parameters: &[seconds(2.4), BOX_WIDTH, STATURE],
    events: &["grasp"],
};

const fn seconds(default: f64) -> BuiltinParameter {
    BuiltinParameter { name: "seconds", description: "length", unit: "s", default, range: (2.0, 10.0) }
}

/// Width of a box, a parameter of clips that hold one.
pub(super) const fn box_width(default: f64) -> BuiltinParameter {
    BuiltinParameter {
        name: "width",
        description: "of the box, between the palms",
        unit: "m",
        default,
        range: (0.15, 0.5),
    }
}

const BOX_WIDTH: BuiltinParameter = box_width(0.35);

const BOX_HEIGHT: BuiltinParameter = BuiltinParameter {
    name: "height",
    description: "of the box; palms are half way up its sides, but not lower than 0.1 of 1.75 m",
    unit: "m",
    default: 0.3,
    range: (0.15, 0.5),
};

const ON: BuiltinParameter = BuiltinParameter {
    name: "on",
    description: "height of what the box stands on, at another stature in proportion; 0 is the floor",
    unit: "m",
    default: 0.0,
    range: (0.0, 0.6),
};

/// Palms on a box that is held before the waist, and their fingers below the horizon in radians: up and ahead.
pub(super) const HELD: (f64, f64, f64) = (1.02, 0.32, 0.33);
/// On a box on the floor: ahead, fingers; and the lowest palm that leaves the fingers room.
const ON_FLOOR: (f64, f64) = (0.40, 0.95);
const LOWEST_PALM: f64 = 0.10;
/// On a box held out to a partner.
const OFFERED: (f64, f64) = (1.18, 0.15);
/// Share of a straight arm that reaches for a box.
const STRETCHED: f64 = 0.87;
/// Space between palms and box before they close on it, metres.
const OPENING: f64 = 0.07;

/// When the knees are bent most, the hands close, the box is at the waist, the back is upright, as shares of a pick-up.
const BENT: f64 = 0.42;
const GRASP: f64 = 0.46;
const LIFTED: f64 = 0.88;
const UPRIGHT: f64 = 0.97;
/// When it is above the knees and may come nearer.
const PAST_KNEES: f64 = 0.62;
/// When the hands have turned to how they carry it.
const TURNED: f64 = 0.72;

fn pick_up(body: &Body, values: &Values) -> Made {
    let last_frame = frame_at(values["seconds"]);
    let seconds = last_frame as f64 / FPS;
    let grasp_frame = frame_at(GRASP * seconds);
    let grasp = grasp_frame as f64 / FPS;
    // The higher the box stands, the more the hands are on it as they hold it. Their wrists are as much higher as it is, so
    // that it is put exactly there, whatever it was lifted from.
    let fingers = ON_FLOOR.1 + (HELD.2 - ON_FLOOR.1) * (values["on"] / HELD.0).min(1.0);
    let turned = palm_from_wrist(body, fingers).y - palm_from_wrist(body, ON_FLOOR.1).y;
    let on_floor = (values["height"] / 2.0).max(LOWEST_PALM * body.scale);
    let palm = on_floor + values["on"] * body.scale + turned;
    let held = HELD.0 * body.scale;
    let depth = depth_for(body, values["width"], (palm, fingers));
    let times = [0.0, BENT * seconds, grasp + 0.04 * seconds, UPRIGHT * seconds];
    let mut act = Performance::standing(body);
    crouch::down_and_up(&mut act, depth, times);
    act.trunk.gaze = Curve::through(&[
        (0.0, 0.0),
        (0.2 * seconds, 0.6),
        (grasp, 0.75),
        (0.7 * seconds, 0.3),
        (seconds, 0.0),
    ]);
    let scaled = |value: f64| value * body.scale;
    let (open, shut) = (values["width"] / 2.0 + OPENING, values["width"] / 2.0);
    for side in Side::BOTH {
        act.arms[side.index()].reach = Some(ReachTrack {
            weight: Curve::through(&[(0.0, 0.0), (0.40 * seconds, 1.0)]),
            palm: [
                Curve::through(&[(0.32 * seconds, side.sign() * open), (grasp, side.sign() * shut)]),
                Curve::through(&[(grasp, palm), (LIFTED * seconds, held)]),
                Curve::through(&[
                    (grasp, scaled(ON_FLOOR.0)),
                    (PAST_KNEES * seconds, scaled(ON_FLOOR.0)),
                    (LIFTED * seconds, scaled(HELD.1)),
                ]),
            ],
            fingers: Curve::through(&[(grasp, fingers), (TURNED * seconds, HELD.2)]),
        });
    }
    act.made(last_frame, vec![grasp_frame])
}

fn put_down(body: &Body, values: &Values) -> Made {
    backwards(pick_up(body, values))
}

/// How deep to crouch so that arms bent a little reach the box, by bisection.
fn depth_for(body: &Body, width: f64, (palm, fingers): (f64, f64)) -> f64 {
    let shoulder_to_wrist = |depth: f64| {
        let mut act = Performance::standing(body);
        crouch::still(&mut act, depth);
        let pose = act.pose(0.0);
        let shoulder = body.skeleton.forward_kinematics(&pose)[arm_joints(Side::Left)[1]].position;
        let target = DVec3::new(width / 2.0, palm, ON_FLOOR.0 * body.scale);
        (target - palm_from_wrist(body, fingers)).distance(shoulder)
    };
    let reach = STRETCHED * (UPPER_ARM + FOREARM) * body.scale;
    crouch::bisect(|depth| shoulder_to_wrist(depth) > reach)
}

fn hand_over(body: &Body, values: &Values) -> Made {
    /// Palms are out, let go, and hang again, as shares of the clip.
    const OUT: f64 = 0.40;
    const RELEASE: f64 = 0.50;
    const OPEN: f64 = 0.60;
    const DOWN: f64 = 0.95;
    let (open, shut) = (values["width"] / 2.0 + OPENING, values["width"] / 2.0);
    let last_frame = frame_at(values["seconds"]);
    let seconds = last_frame as f64 / FPS;
    let release_frame = frame_at(RELEASE * seconds);
    let release = release_frame as f64 / FPS;
    let mut act = Performance::standing(body);
    let back = |still: f64, out: f64| {
        Curve::through(&[(0.0, still), (OUT * seconds, out), (OPEN * seconds, out), (DOWN * seconds, still)])
    };
    let center = Performance::standing_center(body);
    act.over[1] = back(center.z, center.z + 0.03 * body.scale);
    act.trunk.pitch = back(0.0, 0.10);
    act.trunk.bend = back(stand::LEAN, stand::LEAN + 0.08);
    let offered = farthest(&act, OUT * seconds, shut);
    let held = |from: f64, to: f64| Curve::through(&[(0.04 * seconds, from), (OUT * seconds, to)]);
    for side in Side::BOTH {
        act.arms[side.index()].reach = Some(ReachTrack {
            weight: Curve::through(&[(OPEN * seconds - 0.03 * seconds, 1.0), (DOWN * seconds, 0.0)]),
            palm: [
                Curve::through(&[(release, side.sign() * shut), (0.68 * seconds, side.sign() * open)]),
                held(HELD.0 * body.scale, OFFERED.0 * body.scale),
                Curve::through(&[
                    (0.04 * seconds, HELD.1 * body.scale),
                    (OUT * seconds, offered),
                    (OPEN * seconds, offered),
                    (DOWN * seconds, HELD.1 * body.scale),
                ]),
            ],
            fingers: Curve::through(&[(0.04 * seconds, HELD.2), (OUT * seconds, OFFERED.1)]),
        });
    }
    act.made(last_frame, vec![release_frame])
}

/// How far ahead almost stretched arms hold a box out at `time`, metres.
fn farthest(act: &Performance, time: f64, half_width: f64) -> f64 {
    let (body, pose) = (&act.body, act.pose(time));
    let shoulder = body.skeleton.forward_kinematics(&pose)[arm_joints(Side::Left)[1]].position;
    let from_wrist = palm_from_wrist(body, OFFERED.1);
    let away = DVec3::new(half_width, OFFERED.0 * body.scale, 0.0) - from_wrist - shoulder;
    let reach = STRETCHED * (UPPER_ARM + FOREARM) * body.scale;
    shoulder.z + from_wrist.z + (reach.powi(2) - away.x.powi(2) - away.y.powi(2)).max(0.0).sqrt()
}

fn take_over(body: &Body, values: &Values) -> Made {
    backwards(hand_over(body, values))
}

/// The same in reverse.
pub(super) fn backwards(made: Made) -> Made {
    let last_frame = made.poses.len() - 1;
    Made {
        poses: made.poses.into_iter().rev().collect(),
        events: made.events.into_iter().map(|frame| last_frame - frame).collect(),
    }
}
