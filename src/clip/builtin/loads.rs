//! Walking with something in both hands, or before them.

use glam::DVec3;

use super::arms::palm_from_wrist;
use super::body::{Body, NECK, Side};
use super::gait::{Bearing, Gait};
use super::lift::HELD;
use super::limbs::ArmTarget;
use super::walks::{SPEED_HELP, Schedule, TURN, course, schedule, start, stop};
use super::{BuiltinInfo, BuiltinParameter, FPS, Generator, Made, STATURE, Values, frame_at, stand};
use crate::geometry::smoothstep;
use crate::skeleton::Pose;

pub(super) const ALL: &[Generator] = &[
    Generator { info: CARRY, make: carry },
    Generator { info: PUSH, make: push },
    Generator { info: DUCK_WALK, make: duck_walk },
];

const CARRY: BuiltinInfo = BuiltinInfo {
    name: "carry",
    description: "walks with a box held in both hands before the waist; takes it where it starts and gives it where it stops",
    parameters: &[
        BuiltinParameter {
            name: "speed",
            description: SPEED_HELP,
            unit: "m/s",
            default: 1.0,
            range: (0.5, 1.4),
        },
        TURN,
        BuiltinParameter {
            name: "seconds",
            description: "length, to the nearest cycle unless it only starts",
            unit: "s",
            default: 7.5,
            range: (0.5, 600.0),
        },
        BuiltinParameter {
            name: "width",
            description: "of the box, from hand to hand",
            unit: "m",
            default: 0.4,
            range: (0.2, 0.5),
        },
        start(1.0),
        stop(1.0),
        TAKE,
        GIVE,
        STATURE,
    ],
    events: &["grasp", "release"],
};

const PUSH: BuiltinInfo = BuiltinInfo {
    name: "push",
    description: "pushes something ahead with both hands, at chest height leaning on it, lower stooping",
    parameters: &[
        BuiltinParameter {
            name: "speed",
            description: SPEED_HELP,
            unit: "m/s",
            default: 0.6,
            range: (0.4, 0.8),
        },
        BuiltinParameter { range: (-20.0, 20.0), ..TURN },
        BuiltinParameter {
            name: "seconds",
            description: "length, to the nearest cycle unless it only starts",
            unit: "s",
            default: 8.0,
            range: (0.5, 600.0),
        },
        start(1.0),
        stop(1.0),
        TAKE,
        GIVE,
        BuiltinParameter {
            name: "height",
            description: "of the wrists, at another stature in proportion",
            unit: "m",
            default: CHEST_HIGH,
            range: (KNEE_HIGH, CHEST_HIGH),
        },
        STATURE,
    ],
    events: &["grasp", "release"],
};

const DUCK_WALK: BuiltinInfo = BuiltinInfo {
    name: "duck_walk",
    description: "walks ducked, hands beside the knees; ducks where it starts and rises where it stops",
    parameters: &[
        BuiltinParameter {
            name: "speed",
            description: SPEED_HELP,
            unit: "m/s",
            default: 0.6,
            range: (0.3, 0.6),
        },
        BuiltinParameter { range: (-20.0, 20.0), ..TURN },
        BuiltinParameter {
            name: "seconds",
            description: "length, to the nearest cycle unless it only starts",
            unit: "s",
            default: 8.0,
            range: (0.5, 600.0),
        },
        start(1.0),
        stop(1.0),
        BuiltinParameter {
            name: "down",
            description: "with start = 1: 1: stands upright at first and ducks; 0: is ducked from the first frame on",
            ..TAKE
        },
        BuiltinParameter {
            name: "up",
            description: "with stop = 1: 1: rises at last; 0: is ducked to the last frame",
            ..GIVE
        },
        STATURE,
    ],
    events: &["ducked", "rising"],
};

/// Wrists of one who pushes something tall, or low, metres at 1.75 m.
const CHEST_HIGH: f64 = 1.2;
const KNEE_HIGH: f64 = 0.5;

/// Whether the hands come from hanging.
const TAKE: BuiltinParameter = BuiltinParameter {
    name: "take",
    description: "with start = 1: 1: the hands hang at first and rise to grasp; 0: they hold from the first frame on",
    unit: "",
    default: 1.0,
    range: (0.0, 1.0),
};

/// Whether the hands hang again at the end.
const GIVE: BuiltinParameter = BuiltinParameter {
    name: "give",
    description: "with stop = 1: 1: the hands release and hang at last; 0: they hold to the last frame",
    unit: "",
    default: 1.0,
    range: (0.0, 1.0),
};

/// Seconds of standing before the hands move, while they move, and between that and walking.
const STANDING: f64 = 0.2;
const REACHING: f64 = 0.9;
const HOLDING: f64 = 0.2;

/// Where a hand is while it holds, for a pelvis in a pose on a straight course.
type Hold = fn(&Body, &Values, &Pose, Side) -> ArmTarget;

fn carry(body: &Body, values: &Values) -> Made {
    let bearing = Bearing { lean: -0.05, still: 0.9, ..Bearing::default() };
    let beside =
        |body: &Body, values: &Values, pose: &Pose, side| beside_box(body, values["width"], pose, side);
    made(body, (values, hands_move(values, ["take", "give"])), bearing, beside)
}

fn push(body: &Body, values: &Values) -> Made {
    let stooped = stooped(values);
    let mixed = |upright: f64, low: f64| upright + stooped * (low - upright);
    let bearing = Bearing {
        ahead: mixed(0.09, -0.09),
        low: mixed(0.0, 0.14),
        tilt: mixed(0.20, 0.65),
        lean: mixed(0.20, 0.85),
        still: 0.9,
    };
    made(body, (values, hands_move(values, ["take", "give"])), bearing, against)
}

/// Share of the way from pushing at the chest to pushing at the knees.
fn stooped(values: &Values) -> f64 {
    (CHEST_HIGH - values["height"]) / (CHEST_HIGH - KNEE_HIGH)
}

fn duck_walk(body: &Body, values: &Values) -> Made {
    let bearing = Bearing { ahead: -0.09, low: 0.15, tilt: 0.60, lean: 0.75, still: 0.9 };
    made(body, (values, hands_move(values, ["down", "up"])), bearing, beside_knees)
}

/// Whether the hands move at the start and at the stop, by the names of the parameters that say so.
fn hands_move(values: &Values, [first, last]: [&str; 2]) -> [bool; 2] {
    [("start", first), ("stop", last)].map(|(end, hands)| values[end] >= 0.5 && values[hands] >= 0.5)
}

fn made(body: &Body, (values, [takes, gives]): (&Values, [bool; 2]), bearing: Bearing, hold: Hold) -> Made {
    let mut gait = Gait::new(body.clone(), values["speed"], course(values), bearing);
    let standing =
        [takes, gives].map(|hands| if hands { STANDING + REACHING + HOLDING } else { 2.0 * HOLDING });
    let schedule = schedule(&mut gait, values, standing);
    let events = grasp_and_release(&schedule, takes, gives);
    let poses = (0..=schedule.last_frame).map(|frame| {
        let time = schedule.instant(frame);
        let held = held(frame, events, takes, gives);
        let (mut pose, _) = gait.pose_on_course(time, held);
        for side in Side::BOTH {
            let hanging = body.arm_target(&pose, side);
            let holding = hold(body, values, &pose, side);
            body.reach(&mut pose, side, hanging.towards(holding, held));
        }
        gait.place(time).bring(&mut pose);
        pose
    });
    Made { poses: poses.collect(), events: events.into() }
}

/// Frames at which the hands begin to hold, and let go.
fn grasp_and_release(schedule: &Schedule, takes: bool, gives: bool) -> [usize; 2] {
    let grasp = if takes { frame_at(STANDING + REACHING) } else { 0 };
    let release = match schedule.halted.filter(|_| gives) {
        Some(halted) => schedule.frame(halted + HOLDING),
        None => schedule.last_frame,
    };
    [grasp, release]
}

/// Share of holding in a frame: 1 between grasp and release.
fn held(frame: usize, [grasp, release]: [usize; 2], takes: bool, gives: bool) -> f64 {
    let share = |frames: usize| 1.0 - smoothstep(frames as f64 / (FPS * REACHING));
    if takes && frame < grasp {
        share(grasp - frame)
    } else if gives && frame > release {
        share(frame - release)
    } else {
        1.0
    }
}

/// Palms on both sides of a box before the waist, as who has picked it up holds it.
pub(super) fn beside_box(body: &Body, width: f64, pose: &Pose, side: Side) -> ArmTarget {
    let (height, ahead, fingers) = HELD;
    let outwards = DVec3::X * side.sign();
    // Half way between pelvis and neck to the side, where a body leans into a curve.
    let neck = body.skeleton.forward_kinematics(pose)[NECK].position;
    let middle = pose.root.with_x(0.5 * (pose.root.x + neck.x));
    let above_pelvis = height * body.scale - stand::pelvis_height(body);
    let palm = DVec3::new(0.0, above_pelvis, ahead * body.scale) + outwards * (0.5 * width);
    let fingers = palm_from_wrist(body, fingers);
    ArmTarget {
        wrist: middle + palm - fingers,
        elbow: DVec3::new(0.6 * side.sign(), -0.4, -1.0),
        fingers,
        palm: -outwards,
    }
}

/// Palms against something upright ahead, which moves as evenly as the body travels.
fn against(body: &Body, values: &Values, pose: &Pose, side: Side) -> ArmTarget {
    /// Fingers above the horizon, radians.
    const UPRIGHT: f64 = 1.326;
    const LEVEL: f64 = -0.1;
    let stooped = stooped(values);
    let wrist = DVec3::new(0.19 * side.sign(), values["height"], 0.60 - 0.01 * stooped);
    // Fingers point up where arms push straight ahead; who stoops has them on top, over the edge.
    let up = UPRIGHT * (1.0 - stooped) + LEVEL * stooped;
    ArmTarget {
        wrist: pose.root.with_x(0.0).with_y(0.0) + wrist * body.scale,
        elbow: DVec3::new((0.7 + 0.2 * stooped) * side.sign(), -1.0 + 0.4 * stooped, -0.2),
        fingers: DVec3::new(0.0, up.sin(), up.cos()),
        palm: DVec3::new(-0.6 * stooped * side.sign(), -up.cos(), up.sin()),
    }
}

/// Hands beside the knees: they move as evenly as the body travels.
fn beside_knees(body: &Body, _: &Values, pose: &Pose, side: Side) -> ArmTarget {
    /// Fingers below the horizon, radians.
    const FINGERS: f64 = 0.9;
    let outwards = DVec3::X * side.sign();
    ArmTarget {
        wrist: pose.root.with_x(0.0) + (outwards * 0.23 + DVec3::new(0.0, -0.22, 0.44)) * body.scale,
        elbow: DVec3::new(0.6 * side.sign(), -0.4, -1.0),
        fingers: palm_from_wrist(body, FINGERS),
        palm: -outwards,
    }
}
