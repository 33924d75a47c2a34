//! Turning on the spot, with a load or without: foot by foot, the inner one first, until the body looks where it should.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::body::{Body, HEAD, NECK, Side, Trunk};
use super::lift::box_width;
use super::limbs::Foot;
use super::loads::beside_box;
use super::rhythm::{Rhythm, SETTING_OFF};
use super::{BuiltinInfo, BuiltinParameter, FPS, Generator, Made, STATURE, Values, frame_at, stand};
use crate::geometry::yaw;
use crate::skeleton::Pose;

pub(super) const ALL: &[Generator] =
    &[Generator { info: TURN, make: turn }, Generator { info: CARRY_TURN, make: carry_turn }];

const TURN: BuiltinInfo = BuiltinInfo {
    name: "turn",
    description: "turns on the spot, foot by foot; stands at both ends",
    parameters: &[ANGLE, STATURE],
    events: &[],
};

const CARRY_TURN: BuiltinInfo = BuiltinInfo {
    name: "carry_turn",
    description: "turns on the spot with a box held in both hands before the waist; stands at both ends",
    parameters: &[ANGLE, box_width(0.4), STATURE],
    events: &[],
};

const ANGLE: BuiltinParameter = BuiltinParameter {
    name: "angle",
    description: "to the left; a step and a close turn by 60 at most",
    unit: "deg",
    default: 90.0,
    range: (-180.0, 180.0),
};

/// Largest turn of a cycle, radians: neither hips nor ankles turn farther than they can.
const LARGEST_STEP: f64 = TAU / 6.0;
/// Seconds of a cycle, in which both feet step once.
const CYCLE: f64 = 0.8;
/// Seconds of standing still at either end.
const STANDING: f64 = 0.2;
/// Height of a foot's lift, metres, and how far its toes hang half way, radians: steps this short must be seen as steps.
const CLEARANCE: f64 = 0.09;
const HANGING_TOES: f64 = 0.18;
/// Of the pelvis over the foot that stands, metres: as in a walk on the spot.
const SWAY: f64 = 0.035;
/// How much lower than standing the pelvis is, metres.
const CROUCH: f64 = 0.02;
/// Of the head ahead of the body, radians.
const LOOK: f64 = 0.35;

/// A way to turn.
struct Turning<'a> {
    body: &'a Body,
    /// Foot that steps first, which is the inner one.
    leading: Side,
    /// Turn of a cycle, radians, to the left.
    step: f64,
    rhythm: Rhythm,
    /// Of the box in its hands, metres.
    box_width: Option<f64>,
}

fn turn(body: &Body, values: &Values) -> Made {
    made(body, values, None)
}

fn carry_turn(body: &Body, values: &Values) -> Made {
    made(body, values, Some(values["width"]))
}

fn made(body: &Body, values: &Values, box_width: Option<f64>) -> Made {
    let angle = values["angle"].to_radians();
    // A whole number of largest steps may come out a little more than that.
    let cycles = (angle.abs() / LARGEST_STEP - 1e-9).ceil().max(1.0);
    let turning = Turning {
        body,
        leading: if angle > 0.0 { Side::Left } else { Side::Right },
        step: angle / cycles,
        rhythm: Rhythm { starts: true, stop: Some(cycles) },
        box_width,
    };
    let before = STANDING + SETTING_OFF * CYCLE;
    let last_frame = frame_at(2.0 * before + cycles * CYCLE);
    let poses = (0..=last_frame).map(|frame| turning.pose((frame as f64 / FPS - before) / CYCLE));
    Made { poses: poses.collect(), events: Vec::new() }
}

impl Turning<'_> {
    /// Pose at a time of the rhythm: of a body that looks ahead, then turned as a whole.
    fn pose(&self, cycles: f64) -> Pose {
        let (body, pace) = (self.body, self.rhythm.pace(cycles));
        let turned = self.step * self.rhythm.progress(cycles);
        let sway = -self.leading.sign() * SWAY * pace * (TAU * cycles).sin();
        let height = stand::pelvis_height(body) - CROUCH * pace * body.scale;
        let trunk = Trunk { lean: stand::LEAN + 0.03 * pace, ..Trunk::default() };
        let mut pose = body.pose(DVec3::new(sway * body.scale, height, 0.0), trunk);
        let look = DQuat::from_rotation_y(0.5 * LOOK * pace * self.step / LARGEST_STEP);
        for joint in [NECK, HEAD] {
            pose.rotations[joint] = look * pose.rotations[joint];
        }
        for side in Side::BOTH {
            body.place_foot(&mut pose, side, self.foot(side, cycles, turned));
            stand::lift_collar(&mut pose, side, 1.0 - pace);
            body.hang_arm(&mut pose, side, stand::HANGING_ARM.0, stand::HANGING_ARM.1 + 0.25 * pace);
            if let Some(width) = self.box_width {
                let target = beside_box(body, width, &pose, side);
                body.reach(&mut pose, side, target);
            }
        }
        pose.root = yaw(turned) * pose.root;
        pose.rotations[0] = yaw(turned) * pose.rotations[0];
        pose
    }

    /// A foot, seen from a body that has turned so far.
    fn foot(&self, side: Side, cycles: f64, turned: f64) -> Foot {
        let (gone, lift) = self.rhythm.step(side == self.leading, cycles);
        let against_body = self.step * gone - turned;
        let (ankle, toes_out) = stand::planted(self.body, side);
        let ankle = yaw(against_body) * ankle + DVec3::Y * (CLEARANCE * self.body.scale * lift);
        Foot { ankle, turn: toes_out + against_body, pitch: HANGING_TOES * lift, toe: 0.0 }
    }
}
