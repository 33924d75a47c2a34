//! Jumps from both feet to both feet: a crouch, a push, a flight, a landing that gives way, and a stand.

use super::ballistics::{Course, STANDING, TOE_OFF, Timing, plan};
use super::body::Body;
use super::flight::{Air, Tuck, fly};
use super::keyed::{Curve, Key};
use super::mass::GRAVITY;
use super::performance::{Performance, Track};
use super::{Made, frame_at, stand};

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

/// Eyes below the horizon in a crouch, radians.
const LOW_GAZE: f64 = 0.20;
/// Shorter flights leave no time for the whole tuck, seconds.
const UNHURRIED: f64 = 0.5;
/// A clip of a jump.
pub(super) fn made(body: &Body, style: &Style) -> Made {
    let (act, timing) = performance(body, style);
    let events = vec![frame_at(timing.takeoff), frame_at(timing.landing)];
    act.made(frame_at(timing.standing + STANDING), events)
}

pub(super) fn performance(body: &Body, style: &Style) -> (Performance, Timing) {
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
