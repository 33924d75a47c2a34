//! When a jump leaves and lands, and where its centre of mass is then.

use super::FPS;
use super::body::{Body, SHANK, Side, THIGH};
use super::crouch;
use super::keyed::Curve;
use super::leap::{Attitude, Style};
use super::mass::GRAVITY;
use super::performance::Performance;

/// When and how fast; seconds from the first frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timing {
    pub(super) crouched: f64,
    pub(super) takeoff: f64,
    pub(super) landing: f64,
    pub(super) given: f64,
    pub(super) standing: f64,
}

/// Course of the centre of mass, metres ahead of the stance and above the ground, and metres per second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    pub(super) crouched: (f64, f64),
    pub(super) leave: (f64, f64),
    pub(super) land: (f64, f64),
    pub(super) given: (f64, f64),
    pub(super) speed: f64,
    pub(super) up: f64,
    pub(super) down: f64,
}

/// Seconds of getting ready, of the longest push and give, of standing up again, and of standing at both ends.
const READY: f64 = 0.55;
const LONGEST_PUSH: f64 = 0.34;
const LONGEST_GIVE: f64 = 0.28;
const RISE: f64 = 0.70;
pub(super) const STANDING: f64 = 0.10;
/// Centre of mass ahead of the ankles in the deepest crouches, metres at 1.75 m.
const READY_AHEAD: f64 = 0.05;
/// Share of the speed gained times the time that a push covers; its lowest and longest way, metres at 1.75 m.
const PUSH_SHAPE: f64 = 0.42;
const LONGEST_WAY: f64 = 0.30;
const LONGEST_FALL: f64 = 0.26;
/// Pitch of the feet that leave and its rate, radians and radians per second.
pub(super) const TOE_OFF: (f64, f64) = (0.70, 3.5);
/// Shares of straight legs at takeoff and landing.
const LEAVING_LEG: f64 = 0.93;
const LANDING_LEG: f64 = 0.92;

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
pub(super) fn plan(body: &Body, style: &Style) -> (Timing, Course) {
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
