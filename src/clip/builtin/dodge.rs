//! Clips of getting out of the way on the spot: ducking under something, cowering, dodging aside.

use super::body::{Body, HEAD, Side};
use super::crouch;
use super::keyed::Curve;
use super::performance::Performance;
use super::{BuiltinInfo, BuiltinParameter, FPS, Generator, Made, STATURE, Values, frame_at, stand};

pub(super) const ALL: &[Generator] = &[
    Generator { info: DUCK, make: duck },
    Generator { info: COWER, make: cower },
    Generator { info: DODGE, make: dodge },
];

const DUCK: BuiltinInfo = BuiltinInfo {
    name: "duck",
    description: "ducks under something and comes up again",
    parameters: &[
        BuiltinParameter {
            name: "seconds",
            description: "length; lowest between two and three fifths of it",
            unit: "s",
            default: 1.8,
            range: (1.2, 10.0),
        },
        BuiltinParameter {
            name: "depth",
            description: "how much lower the top of the head comes",
            unit: "m",
            default: 0.4,
            range: (0.1, 0.5),
        },
        STATURE,
    ],
    events: &[],
};

const COWER: BuiltinInfo = BuiltinInfo {
    name: "cower",
    description: "crouches as low as it goes with the head down, and comes up again",
    parameters: &[
        BuiltinParameter {
            name: "seconds",
            description: "length; lowest between two and three fifths of it",
            unit: "s",
            default: 3.0,
            range: (1.8, 10.0),
        },
        STATURE,
    ],
    events: &["low"],
};

const DODGE: BuiltinInfo = BuiltinInfo {
    name: "dodge",
    description: "steps aside, sways out of the way over that foot, and steps back",
    parameters: &[
        BuiltinParameter {
            name: "seconds",
            description: "length; farthest aside half way",
            unit: "s",
            default: 2.0,
            range: (1.4, 10.0),
        },
        BuiltinParameter {
            name: "left",
            description: "1: to the left; 0: to the right",
            unit: "",
            default: 1.0,
            range: (0.0, 1.0),
        },
        BuiltinParameter {
            name: "distance",
            description: "of the step aside",
            unit: "m",
            default: 0.3,
            range: (0.15, 0.4),
        },
        STATURE,
    ],
    events: &[],
};

/// When a duck begins, is down, leaves the ground again, is up, as shares of the clip.
const DUCKING: [f64; 4] = [0.05, 0.42, 0.58, 0.97];

fn duck(body: &Body, values: &Values) -> Made {
    let last_frame = frame_at(values["seconds"]);
    let times = DUCKING.map(|share| share * last_frame as f64 / FPS);
    let mut act = Performance::standing(body);
    ducked(&mut act, crouch_for(body, values["depth"]), |still, low| {
        Curve::through(&[(times[0], still), (times[1], low), (times[2], low), (times[3], still)])
    });
    act.made(last_frame, Vec::new())
}

fn cower(body: &Body, values: &Values) -> Made {
    /// Eyes below the horizon, radians.
    const HEAD_DOWN: f64 = 1.3;
    let last_frame = frame_at(values["seconds"]);
    let times = DUCKING.map(|share| share * last_frame as f64 / FPS);
    let key = |still: f64, low: f64| {
        Curve::through(&[(times[0], still), (times[1], low), (times[2], low), (times[3], still)])
    };
    let mut act = Performance::standing(body);
    ducked(&mut act, 1.0, key);
    act.trunk.gaze = key(0.0, HEAD_DOWN);
    act.made(last_frame, vec![last_frame / 2])
}

/// Crouches `depth` deep, hands before the chest, eyes ahead.
fn ducked(act: &mut Performance, depth: f64, key: impl Fn(f64, f64) -> Curve) {
    let share = |still: f64, deep: f64| key(still, still + depth * (deep - still));
    crouch::set(act, share);
    act.trunk.gaze = share(0.0, 0.5);
    for arm in &mut act.arms {
        arm.swing = share(stand::HANGING_ARM.0, -0.75);
        arm.bend = share(stand::HANGING_ARM.1, 2.1);
        arm.away = share(super::arms::AWAY, 0.3);
        arm.inwards = share(0.0, 0.3);
    }
}

/// How deep to crouch so that the head's top is `drop` metres lower, by bisection.
fn crouch_for(body: &Body, drop: f64) -> f64 {
    let top = |depth: f64| {
        let mut act = Performance::standing(body);
        ducked(&mut act, depth, |_, low| Curve::constant(low));
        let frames = body.skeleton.forward_kinematics(&act.pose(0.0));
        let end = body.skeleton.joints[HEAD].end_site.unwrap_or_default();
        (frames[HEAD].position + frames[HEAD].rotation * end).y
    };
    let aim = top(0.0) - drop;
    crouch::bisect(|depth| top(depth) > aim)
}

/// When the stepping foot leaves and lands, leaves and lands again, as shares of the clip.
const STEPS: [f64; 4] = [0.15, 0.37, 0.64, 0.88];

fn dodge(body: &Body, values: &Values) -> Made {
    let last_frame = frame_at(values["seconds"]);
    let seconds = last_frame as f64 / FPS;
    let side = if values["left"] >= 0.5 { Side::Left } else { Side::Right };
    let distance = values["distance"];
    let mut act = Performance::standing(body);
    let out_and_back = |still: f64, out: f64| {
        let keys = [(0.06, still), (0.46, out), (0.52, out), (0.96, still)];
        Curve::through(&keys.map(|(share, value)| (share * seconds, value)))
    };
    let sign = side.sign();
    // The weight goes to the other foot before this one is lifted, and when it comes back.
    let aside = [(0.0, 0.0), (0.15, -0.078 * body.scale), (0.47, 0.09 * body.scale + 0.54 * distance)];
    let back = [(0.52, aside[2].1), (0.86, -0.06 * body.scale), (1.0, 0.0)];
    let keys: Vec<_> = aside.into_iter().chain(back).map(|(share, x)| (share * seconds, sign * x)).collect();
    act.over[0] = Curve::through(&keys);
    let height = stand::pelvis_height(body);
    act.height.pelvis = out_and_back(height, height - 0.09 * body.scale - 0.22 * distance);
    act.trunk.list = out_and_back(0.0, -0.10 * sign);
    act.trunk.aside = out_and_back(0.0, -0.26 * sign);
    act.trunk.twist = out_and_back(0.0, -0.22 * sign);
    act.trunk.bend = out_and_back(stand::LEAN, 0.22);
    act.trunk.pitch = out_and_back(0.0, 0.12);
    for arm in &mut act.arms {
        arm.swing = out_and_back(stand::HANGING_ARM.0, -0.25);
        arm.bend = out_and_back(stand::HANGING_ARM.1, 1.9);
        arm.away = out_and_back(super::arms::AWAY, 0.40);
        arm.inwards = out_and_back(0.0, 0.35);
    }
    step_aside(&mut act, side, distance, STEPS.map(|share| share * seconds));
    act.made(last_frame, Vec::new())
}

/// One foot steps aside and back.
fn step_aside(act: &mut Performance, side: Side, distance: f64, times: [f64; 4]) {
    let scale = act.body.scale;
    let track = &mut act.feet[side.index()];
    let [leave, land, leave_again, land_again] = times;
    let [x, y] = [0, 1].map(|k| track.toe[k].at(0.0));
    let far = x + side.sign() * distance;
    track.toe[0] = Curve::through(&[(leave, x), (land, far), (leave_again, far), (land_again, x)]);
    let (first, second) = (0.5 * (leave + land), 0.5 * (leave_again + land_again));
    let bump = |low: f64, high: f64| {
        let keys =
            [(leave, low), (first, high), (land, low), (leave_again, low), (second, high), (land_again, low)];
        Curve::through(&keys)
    };
    track.toe[1] = bump(y, y + 0.05 * scale);
    track.pitch = bump(0.0, 0.30);
}
