//! Clips of jumps from both feet to both feet: a crouch, a push, a flight, a landing that gives way, and a stand.

use super::body::{Body, SHANK, Side, THIGH};
use super::crouch;
use super::flight::{Air, Tuck, fly};
use super::keyed::{Curve, Key};
use super::mass::GRAVITY;
use super::performance::{Performance, Track};
use super::{BuiltinInfo, BuiltinParameter, FPS, Generator, Made, STATURE, Values, frame_at, stand};

pub(super) const ALL: &[Generator] = &[
    Generator { info: JUMP, make: jump },
    Generator { info: JUMP_OVER, make: jump_over },
    Generator { info: BACK_FLIP, make: back_flip },
];

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

const JUMP_OVER: BuiltinInfo = BuiltinInfo {
    name: "jump_over",
    description: "jumps forward from both feet over an obstacle half way, legs tucked, and lands on both",
    parameters: &[
        BuiltinParameter {
            name: "height",
            description: "of the obstacle",
            unit: "m",
            default: 0.3,
            range: (0.1, 0.4),
        },
        STATURE,
    ],
    events: &["takeoff", "landing"],
};

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

/// Attitude at one instant, radians: pitch of the pelvis, bend of the back, swing and bend of the arms.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attitude {
    pub(super) pitch: f64,
    pub(super) bend: f64,
    pub(super) swing: f64,
    pub(super) elbow: f64,
}

/// What a jump is like; lengths in metres, angles in radians.
#[derive(Clone, Copy, Debug)]
pub(super) struct Style {
    pub(super) distance: f64,
    /// Rise of the centre of mass in flight.
    pub(super) height: f64,
    pub(super) turns: f64,
    /// Lowest before the push, leaving, half way, landing, lowest after it.
    pub(super) crouch: Attitude,
    pub(super) leave: Attitude,
    pub(super) flying: Attitude,
    pub(super) land: Attitude,
    pub(super) give: Attitude,
    /// Hip and knee half way, from and until these shares of the flight.
    pub(super) tuck: (f64, f64),
    pub(super) tucked: (f64, f64),
}

/// When and how fast; seconds from the first frame.
#[derive(Clone, Copy, Debug)]
struct Timing {
    crouched: f64,
    takeoff: f64,
    landing: f64,
    given: f64,
    standing: f64,
}

/// Course of the centre of mass, metres ahead of the stance and above the ground, and metres per second.
#[derive(Clone, Copy, Debug)]
struct Course {
    crouched: (f64, f64),
    leave: (f64, f64),
    land: (f64, f64),
    given: (f64, f64),
    speed: f64,
    up: f64,
    down: f64,
}

fn jump(body: &Body, values: &Values) -> Made {
    let style = Style {
        distance: values["distance"],
        height: values["height"],
        turns: 0.0,
        crouch: Attitude { pitch: 0.55, bend: 0.35, swing: 0.60, elbow: 0.35 },
        leave: Attitude { pitch: 0.20, bend: 0.05, swing: -2.0, elbow: 0.35 },
        flying: Attitude { pitch: 0.0, bend: 0.30, swing: -1.7, elbow: 0.35 },
        land: Attitude { pitch: 0.35, bend: 0.30, swing: -0.9, elbow: 0.35 },
        give: Attitude { pitch: 0.46, bend: 0.40, swing: -0.35, elbow: 0.45 },
        tuck: (0.9, 1.2),
        tucked: (0.45, 0.55),
    };
    made(body, &style)
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

fn jump_over(body: &Body, values: &Values) -> Made {
    let obstacle = values["height"];
    let high = (obstacle / (HIGH_OBSTACLE * body.scale)).min(1.0);
    let mut style = Style {
        distance: 0.7 * body.scale + 0.6 * obstacle,
        height: 0.12 + 0.3 * obstacle,
        turns: 0.0,
        crouch: Attitude { pitch: 0.55, bend: 0.35, swing: 0.60, elbow: 0.35 },
        leave: Attitude { pitch: 0.20, bend: 0.05, swing: -2.0, elbow: 0.35 },
        flying: Attitude { pitch: 0.0, bend: 0.50, swing: -1.3, elbow: 0.45 },
        land: Attitude { pitch: 0.35, bend: 0.30, swing: -0.9, elbow: 0.35 },
        give: Attitude { pitch: 0.46, bend: 0.40, swing: -0.35, elbow: 0.45 },
        tuck: (0.9 + 0.85 * high, 1.1 + 0.8 * high),
        tucked: (0.42, 0.58),
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
pub(super) const HALF_THICKNESS: f64 = 0.03;

/// Where an obstacle is that is jumped over: half way between the toes that leave and the heels that land, metres ahead of the
/// ankles that leave.
pub(super) fn obstacle_ahead(body: &Body, distance: f64) -> f64 {
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

/// Seconds of getting ready, of the longest push and give, of standing up again, and of standing at both ends.
const READY: f64 = 0.55;
const LONGEST_PUSH: f64 = 0.34;
const LONGEST_GIVE: f64 = 0.28;
const RISE: f64 = 0.70;
const STANDING: f64 = 0.10;
/// Centre of mass ahead of the ankles in the deepest crouches, metres at 1.75 m.
const READY_AHEAD: f64 = 0.05;
/// Share of the speed gained times the time that a push covers; its lowest and longest way, metres at 1.75 m.
const PUSH_SHAPE: f64 = 0.42;
const LONGEST_WAY: f64 = 0.30;
const LONGEST_FALL: f64 = 0.26;
/// Pitch of the feet that leave and its rate, radians and radians per second.
const TOE_OFF: (f64, f64) = (0.70, 3.5);
/// Eyes below the horizon in a crouch, radians.
const LOW_GAZE: f64 = 0.20;
/// Shorter flights leave no time for the whole tuck, seconds.
const UNHURRIED: f64 = 0.5;
/// Shares of straight legs at takeoff and landing.
const LEAVING_LEG: f64 = 0.93;
const LANDING_LEG: f64 = 0.92;

/// A clip of a jump.
fn made(body: &Body, style: &Style) -> Made {
    let (act, timing) = performance(body, style);
    let events = vec![frame_at(timing.takeoff), frame_at(timing.landing)];
    act.made(frame_at(timing.standing + STANDING), events)
}

fn performance(body: &Body, style: &Style) -> (Performance, Timing) {
    let mut act = Performance::standing(body);
    let (timing, course) = plan(body, style);
    set_course(&mut act, &timing, &course, style.distance);
    set_limbs(&mut act, &timing, style);
    let key = |time: f64, attitude: &Attitude| Key::still(time, attitude.pitch);
    let flight = timing.landing - timing.takeoff;
    let much = (flight / UNHURRIED).min(1.0);
    let tuck = |share: f64| Tuck {
        time: timing.takeoff + share * flight,
        hip: much * style.tuck.0,
        knee: much * style.tuck.1,
        ankle: 0.35,
    };
    let air = Air {
        takeoff: timing.takeoff,
        landing: timing.landing,
        turns: style.turns,
        tucks: vec![tuck(style.tucked.0), tuck(style.tucked.1)],
        pitch: vec![
            Key::still(STANDING, 0.0),
            key(timing.crouched, &style.crouch),
            key(timing.takeoff, &style.leave),
            key(timing.landing, &style.land),
            key(timing.given, &style.give),
            Key::still(timing.standing, 0.0),
        ],
    };
    act.trunk.pitch = Curve::new(air.pitch.clone());
    set_pelvis(&mut act, &timing);
    fly(&mut act, air);
    (act, timing)
}

/// Speeds (m/s), durations (s) and heights of the centre of mass (m) of a jump.
#[derive(Clone, Copy, Debug)]
struct Ballistics {
    ahead: f64,
    up: f64,
    down: f64,
    push: f64,
    flight: f64,
    give: f64,
    leave: f64,
    land: f64,
}

/// Decides when everything happens and where the centre of mass is then.
fn plan(body: &Body, style: &Style) -> (Timing, Course) {
    const ROUNDS: usize = 6;
    let up = (-2.0 * GRAVITY * style.height).sqrt();
    let flight = -2.0 * up / GRAVITY;
    let (push, give, down) = (LONGEST_PUSH, LONGEST_GIVE, up);
    let mut jump = Ballistics { ahead: 0.0, up, down, push, flight, give, leave: 0.0, land: 0.0 };
    for _ in 0..ROUNDS {
        jump = refined(body, style, &jump);
    }
    let ready = READY_AHEAD * body.scale;
    let takeoff_frame = ((STANDING + READY + jump.push) * FPS).round();
    let (takeoff, landing) = (takeoff_frame / FPS, (takeoff_frame + (jump.flight * FPS).round()) / FPS);
    let timing = Timing {
        crouched: takeoff - jump.push,
        takeoff,
        landing,
        given: landing + jump.give,
        standing: landing + jump.give + RISE,
    };
    let leave = ready + PUSH_SHAPE * jump.ahead * jump.push;
    let course = Course {
        crouched: (ready, jump.leave - PUSH_SHAPE * jump.up * jump.push),
        leave: (leave, jump.leave),
        land: (leave + jump.ahead * jump.flight, jump.land),
        given: (style.distance + ready, jump.land - PUSH_SHAPE * jump.down * jump.give),
        speed: jump.ahead,
        up: jump.up,
        down: jump.down,
    };
    (timing, course)
}

/// One round of a fixed point: the legs' stretch fixes the heights at takeoff and landing; with them a flight of whole frames
/// fixes the speed up; the durations fix the speed ahead, that how far ahead of the feet the centre is, and that the heights.
fn refined(body: &Body, style: &Style, before: &Ballistics) -> Ballistics {
    let (g, scale) = (-GRAVITY, body.scale);
    let push = LONGEST_PUSH.min(LONGEST_WAY * scale / (PUSH_SHAPE * before.up));
    let give = LONGEST_GIVE.min(LONGEST_FALL * scale / (PUSH_SHAPE * before.down));
    let ahead = style.distance / (PUSH_SHAPE * (push + give) + before.flight);
    let ready = READY_AHEAD * scale;
    let leave = height_for(body, &style.leave, (ready + PUSH_SHAPE * ahead * push, TOE_OFF.0), LEAVING_LEG);
    let land = height_for(body, &style.land, (ready - PUSH_SHAPE * ahead * give, 0.0), LANDING_LEG);
    let asked = (2.0 * g * style.height).sqrt();
    let fall = (asked + (asked * asked + 2.0 * g * (leave - land)).max(0.0).sqrt()) / g;
    let flight = (fall * FPS).round() / FPS;
    let up = (land - leave) / flight + 0.5 * g * flight;
    // The last round's own durations belong to its speeds.
    let ahead = style.distance / (PUSH_SHAPE * (push + give) + flight);
    Ballistics { ahead, up, down: g * flight - up, push, flight, give, leave, land }
}

/// Height of the centre of mass `ahead` of flat feet (or on their toes with `pitch`) at which the legs are stretched to `share`.
fn height_for(body: &Body, attitude: &Attitude, (ahead, pitch): (f64, f64), share: f64) -> f64 {
    let mut act = Performance::standing(body);
    act.over[1] = Curve::constant(ahead);
    act.trunk.pitch = Curve::constant(attitude.pitch);
    act.trunk.bend = Curve::constant(attitude.bend);
    for side in Side::BOTH {
        act.arms[side.index()].swing = Curve::constant(attitude.swing);
        act.arms[side.index()].bend = Curve::constant(attitude.elbow);
        act.feet[side.index()].pitch = Curve::constant(pitch);
    }
    let length = (THIGH + SHANK) * body.scale;
    let (low, high) = (0.35 * body.scale, 1.4 * body.scale);
    act.height.share = Curve::constant(1.0);
    let is_short = |s: f64| {
        act.height.center = Curve::constant(low + s * (high - low));
        act.leg_span(0.0) < share * length
    };
    low + crouch::bisect(is_short) * (high - low)
}

fn set_course(act: &mut Performance, timing: &Timing, course: &Course, distance: f64) {
    let center = Performance::standing_center(&act.body);
    let push = timing.takeoff - timing.crouched;
    let give = timing.given - timing.landing;
    let still = Key::still;
    let ahead = vec![
        still(STANDING, center.z),
        still(timing.crouched, course.crouched.0),
        Key { rate: course.speed, ..still(timing.takeoff, course.leave.0) },
        Key { rate: course.speed, ..still(timing.landing, course.land.0) },
        still(timing.given, course.given.0),
        still(timing.standing, distance + center.z),
    ];
    let falling = |time: f64, rate: f64, value: f64| Key { time, value, rate, acceleration: GRAVITY };
    let turning = |time: f64, acceleration: f64, value: f64| Key { time, value, rate: 0.0, acceleration };
    let height = vec![
        still(STANDING, center.y),
        turning(timing.crouched, 0.8 * course.up / push, course.crouched.1),
        falling(timing.takeoff, course.up, course.leave.1),
        falling(timing.landing, -course.down, course.land.1),
        turning(timing.given, 0.8 * course.down / give, course.given.1),
        still(timing.standing, center.y),
    ];
    act.over[1] = Curve::new(ahead);
    act.height.center = Curve::new(height);
    for track in &mut act.feet {
        move_track(track, timing, distance);
    }
}

/// Before the lowest point of the push and after that of the landing the pelvis moves as smoothly as the centre of mass does
/// in between: a trunk that is still bent would stretch the legs.
fn set_pelvis(act: &mut Performance, timing: &Timing) {
    let stand = act.height.pelvis.at(0.0);
    act.height.share = Curve::constant(1.0);
    let [before, after] = [timing.crouched, timing.given].map(|time| act.pose(time).root.y);
    let half_way = 0.5 * (timing.given + timing.standing);
    act.height.share =
        Curve::through(&[(STANDING, 0.0), (timing.crouched, 1.0), (timing.given, 1.0), (half_way, 0.0)]);
    act.height.pelvis = Curve::through(&[
        (STANDING, stand),
        (timing.crouched, before),
        (timing.given, after),
        (timing.standing, stand),
    ]);
}

/// A foot leaves with its heel up and lands flat; in between its leg's joints say where it is.
fn move_track(track: &mut Track, timing: &Timing, distance: f64) {
    /// Seconds in which the heel rises.
    const RISING: f64 = 0.20;
    let from = track.toe[2].at(0.0);
    track.toe[2] = Curve::through(&[(timing.takeoff, from), (timing.landing, from + distance)]);
    track.pitch = Curve::new(vec![
        Key::still(timing.takeoff - RISING, 0.0),
        Key { rate: TOE_OFF.1, ..Key::still(timing.takeoff, TOE_OFF.0) },
        Key::still(timing.landing, 0.0),
    ]);
}

fn set_limbs(act: &mut Performance, timing: &Timing, style: &Style) {
    /// Seconds by which the arms swing back before the lowest point and reach up after the takeoff.
    const EARLY: f64 = 0.14;
    const LATE: f64 = 0.05;
    let (set, turned) = (timing.crouched - EARLY, timing.takeoff + LATE);
    act.trunk.bend = curve(timing, style, [timing.crouched, timing.takeoff], (stand::LEAN, |a| a.bend));
    act.trunk.level = Curve::through(&[
        (timing.crouched, 1.0),
        (timing.takeoff, 0.0),
        (timing.landing, 0.0),
        (timing.given, 1.0),
    ]);
    act.trunk.gaze = Curve::through(&[
        (STANDING, 0.0),
        (timing.crouched, LOW_GAZE),
        (timing.takeoff, 0.0),
        (timing.landing, 0.0),
        (timing.given, LOW_GAZE),
        (timing.standing, 0.0),
    ]);
    for arm in &mut act.arms {
        arm.swing = curve(timing, style, [set, turned], (stand::HANGING_ARM.0, |a| a.swing));
        arm.bend = curve(timing, style, [set, turned], (stand::HANGING_ARM.1, |a| a.elbow));
    }
}

/// One number of the attitudes; `leaving`: when it is that of the crouch and of the takeoff.
fn curve(
    timing: &Timing,
    style: &Style,
    leaving: [f64; 2],
    (still, of): (f64, fn(&Attitude) -> f64),
) -> Curve {
    let middle = |share: f64| timing.takeoff + share * (timing.landing - timing.takeoff);
    Curve::through(&[
        (STANDING, still),
        (leaving[0], of(&style.crouch)),
        (leaving[1], of(&style.leave)),
        (middle(style.tucked.0), of(&style.flying)),
        (middle(style.tucked.1), of(&style.flying)),
        (timing.landing, of(&style.land)),
        (timing.given, of(&style.give)),
        (timing.standing, still),
    ])
}
