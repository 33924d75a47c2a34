//! Clips of walking.

use super::body::Body;
use super::course::Course;
use super::gait::{Bearing, Ends, Gait, HALTING, SETTING_OFF};
use super::{BuiltinInfo, BuiltinParameter, FPS, Generator, Made, STATURE, Values, frame_at};

pub(super) const ALL: &[Generator] = &[Generator { info: WALK, make: walk }];

/// What a parameter `speed` is.
pub(super) const SPEED_HELP: &str = "along the course";

/// How a course bends, a parameter of clips that go ahead.
pub(super) const TURN: BuiltinParameter = BuiltinParameter {
    name: "turn",
    description: "to the left at full speed, along a circle; 0 goes straight ahead",
    unit: "deg/s",
    default: 0.0,
    range: (-45.0, 45.0),
};

/// Whether a clip begins standing.
pub(super) const fn start(default: f64) -> BuiltinParameter {
    BuiltinParameter {
        name: "start",
        description: "1: stands first and sets off; 0: walks from the first frame on",
        unit: "",
        default,
        range: (0.0, 1.0),
    }
}

/// Whether a clip ends standing.
pub(super) const fn stop(default: f64) -> BuiltinParameter {
    BuiltinParameter {
        name: "stop",
        description: "1: halts at the end and stands; 0: walks to the last frame",
        unit: "",
        default,
        range: (0.0, 1.0),
    }
}

const WALK: BuiltinInfo = BuiltinInfo {
    name: "walk",
    description: "walks straight ahead or round a curve, in cycles that end as they began; sets off and halts on request",
    parameters: &[
        BuiltinParameter {
            name: "speed",
            description: SPEED_HELP,
            unit: "m/s",
            default: 1.2,
            range: (0.5, 1.8),
        },
        TURN,
        BuiltinParameter {
            name: "seconds",
            description: "length, to the nearest cycle unless it only starts; at the default speed one takes 17/15 s",
            unit: "s",
            default: 3.4,
            range: (0.5, 600.0),
        },
        start(0.0),
        stop(0.0),
        STATURE,
    ],
    events: &[],
};

/// Seconds of standing before a walk sets off, and after it has halted.
const STANDING: f64 = 0.4;

/// The course of a clip with a speed and a turn.
pub(super) fn course(values: &Values) -> Course {
    Course { curvature: values["turn"].to_radians() / values["speed"] }
}

/// When a clip of walking begins and ends, in its gait's time: a strike of the left foot falls on a frame.
pub(super) struct Schedule {
    /// Seconds before its time 0 that the clip begins.
    before: f64,
    /// When it stands again, in the gait's time, if it does.
    pub(super) halted: Option<f64>,
    /// Frames after the first.
    pub(super) last_frame: usize,
}

impl Schedule {
    /// In the gait's time.
    pub(super) fn instant(&self, frame: usize) -> f64 {
        frame as f64 / FPS - self.before
    }

    /// Nearest to an instant of the gait.
    pub(super) fn frame(&self, time: f64) -> usize {
        frame_at(time + self.before)
    }
}

/// Has a gait begin and end as `start` and `stop` ask for, with seconds of standing before and after; `seconds` of the clip,
/// to the nearest cycle unless it only starts.
pub(super) fn schedule(gait: &mut Gait, values: &Values, standing: [f64; 2]) -> Schedule {
    let (starts, stops) = (values["start"] >= 0.5, values["stop"] >= 0.5);
    let before =
        if starts { ((standing[0] + 0.5 * SETTING_OFF * gait.period) * FPS).round() / FPS } else { 0.0 };
    let (mut stop, mut seconds) = (None, values["seconds"]);
    if stops {
        let after = HALTING * gait.period + standing[1];
        let cycles = ((seconds - before - after) / gait.period).round().max(if starts { 1.0 } else { 0.0 });
        stop = Some(cycles);
        seconds = before + cycles * gait.period + after;
    } else if !starts {
        seconds = whole_cycles(seconds, gait.period);
    }
    gait.end_at(Ends { start: starts, stop });
    let halted = stop.map(|stop| gait.period * (stop + HALTING));
    Schedule { before, halted, last_frame: frame_at(seconds) }
}

/// Seconds of the nearest number of whole cycles, of one at least: the clip ends as it began.
pub(super) fn whole_cycles(seconds: f64, period: f64) -> f64 {
    (seconds / period).round().max(1.0) * period
}

fn walk(body: &Body, values: &Values) -> Made {
    let mut gait = Gait::new(body.clone(), values["speed"], course(values), Bearing::default());
    let schedule = schedule(&mut gait, values, [STANDING; 2]);
    let poses = (0..=schedule.last_frame).map(|frame| gait.pose(schedule.instant(frame))).collect();
    Made { poses, events: Vec::new() }
}
