//! Stepping to the side, with a load or without: the leading foot goes, the other follows, the body sways over the one that
//! stands.

use std::f64::consts::TAU;

use glam::DVec3;

use super::body::{Body, Side, Trunk};
use super::lift::box_width;
use super::limbs::{ArmAngles, Foot};
use super::loads::beside_box;
use super::rhythm::{Rhythm, SETTING_OFF};
use super::stand;
use super::walks::whole_cycles;
use super::{BuiltinInfo, BuiltinParameter, FPS, Generator, Made, STATURE, Values, frame_at};
use crate::geometry::smoothstep;
use crate::skeleton::Pose;

pub(super) const ALL: &[Generator] =
    &[Generator { info: SIDE_STEP, make: side_step }, Generator { info: CARRY_SIDE, make: carry_side }];

const SIDE_STEP: BuiltinInfo = BuiltinInfo {
    name: "side_step",
    description: "steps to the side, looking ahead; each cycle is a step and a close",
    parameters: &[SPEED, LEFT, SECONDS, START, STOP, STATURE],
    events: &[],
};

const CARRY_SIDE: BuiltinInfo = BuiltinInfo {
    name: "carry_side",
    description: "steps to the side with a box, or one end of it, held in both hands before the waist",
    parameters: &[SPEED, LEFT, SECONDS, box_width(0.4), START, STOP, STATURE],
    events: &[],
};

const SPEED: BuiltinParameter = BuiltinParameter {
    name: "speed",
    description: "to the side",
    unit: "m/s",
    default: 0.4,
    range: (0.2, 0.6),
};

const LEFT: BuiltinParameter = BuiltinParameter {
    name: "left",
    description: "1: to the left; 0: to the right",
    unit: "",
    default: 1.0,
    range: (0.0, 1.0),
};

const SECONDS: BuiltinParameter = BuiltinParameter {
    name: "seconds",
    description: "length, to the nearest cycle unless it only starts",
    unit: "s",
    default: 4.0,
    range: (0.5, 600.0),
};

const START: BuiltinParameter = BuiltinParameter {
    name: "start",
    description: "1: stands first; 0: is under way from the first frame on",
    unit: "",
    default: 1.0,
    range: (0.0, 1.0),
};

const STOP: BuiltinParameter = BuiltinParameter {
    name: "stop",
    description: "1: stands at last; 0: is under way to the last frame",
    unit: "",
    default: 1.0,
    range: (0.0, 1.0),
};

/// Seconds of standing still at either end.
const STANDING: f64 = 0.2;
/// Height of a foot's lift, metres, and how far its toes hang half way, radians.
const CLEARANCE: f64 = 0.06;
const HANGING_TOES: f64 = 0.22;
/// Sway over the standing foot beside the even way, as a share of a stride: just no way back.
const SWAY: f64 = 0.14;
/// How much lower than standing the pelvis is, metres; more where that is needed to reach.
const CROUCH: f64 = 0.025;
/// Share of a straight leg that the most stretched leg of the cycle has.
const LONGEST_LEG: f64 = 0.994;

/// A way to step.
struct Stepping<'a> {
    body: &'a Body,
    leading: Side,
    /// Seconds of a cycle; a whole number of frames.
    period: f64,
    /// Way of a cycle, metres.
    stride: f64,
    /// How much lower than standing the pelvis is at least, so that both legs reach, metres.
    drop: f64,
    rhythm: Rhythm,
    /// Of the box in its hands, metres.
    box_width: Option<f64>,
}

fn side_step(body: &Body, values: &Values) -> Made {
    made(body, values, None)
}

fn carry_side(body: &Body, values: &Values) -> Made {
    made(body, values, Some(values["width"]))
}

fn made(body: &Body, values: &Values, box_width: Option<f64>) -> Made {
    let leading = if values["left"] >= 0.5 { Side::Left } else { Side::Right };
    let mut stepping = Stepping { box_width, ..Stepping::new(body, values["speed"], leading) };
    let starts = values["start"] >= 0.5;
    stepping.rhythm.starts = starts;
    let standing = ((STANDING + SETTING_OFF * stepping.period) * FPS).round() / FPS;
    let before = if starts { standing } else { 0.0 };
    let mut seconds = values["seconds"];
    if values["stop"] >= 0.5 {
        let fewest = if starts { 2.0 } else { 1.0 };
        let cycles = ((seconds - before - standing) / stepping.period).round().max(fewest);
        stepping.rhythm.stop = Some(cycles);
        seconds = before + cycles * stepping.period + standing;
    } else if !starts {
        seconds = whole_cycles(seconds, stepping.period);
    }
    let poses = (0..=frame_at(seconds)).map(|frame| stepping.pose(frame as f64 / FPS - before));
    Made { poses: poses.collect(), events: Vec::new() }
}

impl<'a> Stepping<'a> {
    /// Strides and cadence rise alike with speed: 0.30 m at 0.4 m/s.
    fn new(body: &'a Body, speed: f64, leading: Side) -> Self {
        let usual = (0.30 * 0.30 / 0.4 * speed * body.scale).sqrt();
        let period = (usual / speed * FPS).round() / FPS;
        let stride = speed * period;
        let mut stepping =
            Self { body, leading, period, stride, drop: 0.0, rhythm: Rhythm::default(), box_width: None };
        stepping.drop = stepping.smallest_drop();
        stepping
    }

    /// How far the pelvis goes ahead, metres, while the first step leaves a stand (back) or the last one comes to one.
    fn weight_shift(&self, cycles: f64) -> f64 {
        /// Metres at 1.75 m, and the cycles from the one end to the farthest.
        const FARTHEST: f64 = 0.03;
        const HALF: f64 = 0.45;
        let bump = |since: f64| {
            smoothstep((since + SETTING_OFF) / HALF) * smoothstep((2.0 * HALF - SETTING_OFF - since) / HALF)
        };
        let Rhythm { starts, stop } = self.rhythm;
        let leaving = if starts { bump(cycles) } else { 0.0 };
        FARTHEST * self.body.scale * (stop.map_or(0.0, |stop| bump(stop - cycles)) - leaving)
    }

    /// Where a foot is, in cycles after the leading one was about to lift.
    fn foot(&self, side: Side, cycles: f64) -> Foot {
        let (gone, lift) = self.rhythm.step(side == self.leading, cycles);
        let (ankle, turn) = stand::planted(self.body, side);
        let way = DVec3::X * (self.leading.sign() * self.stride * gone);
        let ankle = ankle + way + DVec3::Y * (CLEARANCE * self.body.scale * lift);
        Foot { ankle, turn, pitch: HANGING_TOES * lift, toe: 0.0 }
    }

    /// Pose at an instant, seconds after the first cycle began.
    fn pose(&self, time: f64) -> Pose {
        self.stretched_pose(time / self.period).0
    }

    /// Pose and how far its more stretched leg is stretched.
    fn stretched_pose(&self, cycles: f64) -> (Pose, f64) {
        let (progress, pace) = (self.rhythm.progress(cycles), self.rhythm.pace(cycles));
        let wave = (TAU * progress).sin();
        let ahead = self.leading.sign();
        let low = pace * (CROUCH * self.body.scale).max(self.drop);
        let way = ahead * (self.stride * (progress - SWAY * wave) + self.weight_shift(cycles));
        let trunk = Trunk {
            pelvis_list: -0.03 * ahead * pace * wave,
            chest_list: 0.04 * ahead * pace * wave,
            lean: stand::LEAN + 0.05 * pace,
            ..Trunk::default()
        };
        let mut pose = self.body.pose(DVec3::new(way, stand::pelvis_height(self.body) - low, 0.0), trunk);
        let mut longest: f64 = 0.0;
        for side in Side::BOTH {
            let stretch = self.body.place_foot(&mut pose, side, self.foot(side, cycles));
            longest = longest.max(stretch);
            self.hang_arm(&mut pose, side, pace, side.sign() * ahead * wave);
        }
        if let Some(width) = self.box_width {
            for side in Side::BOTH {
                let target = beside_box(self.body, width, &pose, side);
                self.body.reach(&mut pose, side, target);
            }
        }
        (pose, longest)
    }

    /// Arms a little away from the body, swinging to the sides; `outwards` from −1 to 1.
    fn hang_arm(&self, pose: &mut Pose, side: Side, pace: f64, outwards: f64) {
        let (swing, bend) = stand::HANGING_ARM;
        let arm = ArmAngles {
            swing: swing - 0.10 * pace,
            away: 0.13 + pace * (0.12 + 0.07 * outwards),
            inwards: 0.25 * pace,
            bend: bend + 0.35 * pace,
        };
        stand::lift_collar(pose, side, 1.0 - pace);
        self.body.bend_arm(pose, side, arm);
    }

    /// Smallest drop with which both legs reach their feet all the time, by bisection.
    fn smallest_drop(&self) -> f64 {
        let reaches = |drop: f64| {
            let trial = Self { drop, ..*self };
            (0..60).all(|k| trial.stretched_pose(f64::from(k) / 60.0).1 < LONGEST_LEG)
        };
        let (mut low, mut high) = (0.0, 0.3 * self.body.scale);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if reaches(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    }
}
