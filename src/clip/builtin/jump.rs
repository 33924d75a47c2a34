//! Clips of jumps.

use super::ballistics::Timing;
use super::body::Body;
use super::leap::{Attitude, Style, made, performance};
use super::performance::Performance;
use super::{BuiltinInfo, BuiltinParameter, FPS, Generator, Made, STATURE, Values, frame_at};

pub(super) const ALL: &[Generator] = &[
    Generator { info: JUMP, make: jump },
    Generator { info: JUMP_OVER, make: jump_over },
    Generator { info: BACK_FLIP, make: back_flip },
];

const JUMP: BuiltinInfo = BuiltinInfo {
    name: "jump",
    description: "jumps forward from both feet and lands on both",
    parameters: &[
        BuiltinParameter {
            name: "distance",
            description: "from where the feet leave to where they land",
            unit: "m",
            default: 0.7,
            range: (0.0, 0.9),
        },
        BuiltinParameter {
            name: "height",
            description: "by which the centre of mass rises in flight, to the nearest flight of whole frames",
            unit: "m",
            default: 0.25,
            range: (0.1, 0.35),
        },
        STATURE,
    ],
    events: &["takeoff", "landing"],
};

const JUMP_OVER: BuiltinInfo = BuiltinInfo {
    name: "jump_over",
    description: "jumps forward from both feet over an obstacle half way, legs tucked, and lands on both",
    parameters: &[
        BuiltinParameter {
            name: "height",
            description: "of the obstacle",
            unit: "m",
            default: 0.3,
            range: (0.1, 0.45),
        },
        STATURE,
    ],
    events: &["takeoff", "landing"],
};

const BACK_FLIP: BuiltinInfo = BuiltinInfo {
    name: "back_flip",
    description: "turns over backwards in the air, tucked, and lands on both feet",
    parameters: &[
        BuiltinParameter {
            name: "height",
            description: "by which the centre of mass rises in flight, to the nearest flight of whole frames",
            unit: "m",
            default: 0.45,
            range: (0.4, 0.55),
        },
        STATURE,
    ],
    events: &["takeoff", "landing"],
};

fn jump(body: &Body, values: &Values) -> Made {
    let style = Style {
        distance: values["distance"],
        height: values["height"],
        turns: 0.0,
        crouch: Attitude { pitch: 0.55, bend: 0.35, swing: 0.60, elbow: 0.35 },
        leave: Attitude { pitch: 0.20, bend: 0.05, swing: -2.0, elbow: 0.35 },
        flying: Attitude { pitch: 0.0, bend: 0.12, swing: -1.7, elbow: 0.35 },
        land: Attitude { pitch: 0.35, bend: 0.30, swing: -0.9, elbow: 0.35 },
        give: Attitude { pitch: 0.46, bend: 0.40, swing: -0.35, elbow: 0.45 },
        tuck: (0.55, 0.95),
        tucked: (0.55, 0.60),
    };
    made(body, &style)
}

fn jump_over(body: &Body, values: &Values) -> Made {
    let obstacle = values["height"];
    let high = (obstacle / (HIGH_OBSTACLE * body.scale)).min(1.0);
    let mut style = Style {
        distance: 0.7 * body.scale + 0.6 * obstacle,
        height: 0.12 + 0.3 * obstacle,
        turns: 0.0,
        crouch: Attitude { pitch: 0.55, bend: 0.35, swing: 0.60, elbow: 0.35 },
        leave: Attitude { pitch: 0.20, bend: 0.05, swing: -2.0, elbow: 0.35 },
        flying: Attitude { pitch: 0.0, bend: 0.30, swing: -1.5, elbow: 0.40 },
        land: Attitude { pitch: 0.35, bend: 0.30, swing: -0.9, elbow: 0.35 },
        give: Attitude { pitch: 0.46, bend: 0.40, swing: -0.35, elbow: 0.45 },
        tuck: (0.7 + 0.75 * high, 1.0 + 0.8 * high),
        tucked: (0.50, 0.55),
    };
    // Who jumps higher has the feet higher by at least as much.
    for _ in 0..8 {
        let (act, timing) = performance(body, &style);
        let missing = obstacle + SPARE - lowest_over(&act, &timing, style.distance);
        if missing <= 0.0 {
            break;
        }
        style.height += missing.max(LEAST_RAISE);
    }
    made(body, &style)
}

/// Obstacle for which legs are tucked most, metres at 1.75 m.
const HIGH_OBSTACLE: f64 = 0.4;
/// A flight of one frame more, metres.
const LEAST_RAISE: f64 = 0.02;
/// Room between soles and obstacle, and the obstacle's half thickness, metres.
const SPARE: f64 = 0.02;
const HALF_THICKNESS: f64 = 0.03;

/// Where an obstacle is that is jumped over: half way between the toes that leave and the heels that land, metres ahead of the
/// ankles that leave.
fn obstacle_ahead(body: &Body, distance: f64) -> f64 {
    0.5 * distance + 0.07 * body.scale
}

/// Height of the lowest sole while it is over the obstacle, metres.
fn lowest_over(act: &Performance, timing: &Timing, distance: f64) -> f64 {
    const PER_FRAME: f64 = 8.0;
    let middle = obstacle_ahead(&act.body, distance);
    let steps = frame_at((timing.landing - timing.takeoff) * PER_FRAME);
    let soles = (1..steps).map(|k| act.soles(timing.takeoff + k as f64 / (FPS * PER_FRAME)));
    let over = soles.flatten().filter(|sole| {
        let (near, far) = (sole[0].z.min(sole[1].z), sole[0].z.max(sole[1].z));
        near < middle + HALF_THICKNESS && far > middle - HALF_THICKNESS
    });
    over.map(|sole| sole[0].y.min(sole[1].y)).fold(f64::INFINITY, f64::min)
}

fn back_flip(body: &Body, values: &Values) -> Made {
    let style = Style {
        distance: -0.25 * body.scale,
        height: values["height"],
        turns: -1.0,
        crouch: Attitude { pitch: 0.62, bend: 0.40, swing: 0.70, elbow: 0.30 },
        leave: Attitude { pitch: -0.10, bend: -0.10, swing: -2.75, elbow: 0.30 },
        flying: Attitude { pitch: 0.0, bend: 0.70, swing: -0.55, elbow: 1.0 },
        land: Attitude { pitch: 0.70, bend: 0.35, swing: -1.1, elbow: 0.35 },
        give: Attitude { pitch: 0.55, bend: 0.45, swing: -0.90, elbow: 0.35 },
        tuck: (2.0, 2.15),
        tucked: (0.36, 0.64),
    };
    made(body, &style)
}
