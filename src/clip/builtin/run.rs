//! Running: what the ground does to the centre of mass decides; the body follows.
//!
//! In each stance the ground pushes with one force that rises and falls as a half sine, so that the centre of mass flies on a
//! parabola from take-off to the next touch-down, whatever its limbs do. Feet stand still, or swing along a spline that leaves
//! the ground and meets it without a jump in speed; the pelvis is where it must be for the centre of mass.
//!
//! Step 0 begins with the touch-down of the left foot at time 0.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::body::{ANKLE_HEIGHT, Body, HEEL_OFFSET, Side, TOE_OFFSET, Trunk};
use super::curve::Curve;
use super::limbs::{ArmAngles, Foot};
use super::mass::{GRAVITY, balance, ballistic};
use super::walks::{SPEED_HELP, TURN, whole_cycles};
use super::{BuiltinInfo, BuiltinParameter, FPS, Generator, Made, STATURE, Values, frame_at};
use crate::geometry::{smoothstep, yaw};
use crate::index::floor_index;
use crate::skeleton::Pose;

pub(super) const ALL: &[Generator] = &[Generator { info: RUN, make: run }];

const RUN: BuiltinInfo = BuiltinInfo {
    name: "run",
    description: "runs straight ahead or round a curve, in cycles that end as they began",
    parameters: &[
        BuiltinParameter {
            name: "speed",
            description: SPEED_HELP,
            unit: "m/s",
            default: 3.2,
            range: (2.5, 4.5),
        },
        TURN,
        BuiltinParameter {
            name: "seconds",
            description: "length, to the nearest cycle; at the default speed one takes 11/15 s",
            unit: "s",
            default: 2.2,
            range: (0.5, 600.0),
        },
        STATURE,
    ],
    events: &[],
};

/// Shares of a stance: flat foot, heel lifting.
const FLAT: f64 = 0.2;
const HEEL_OFF: f64 = 0.30;
/// Pitch of the foot at touch-down and at take-off, radians.
const STRIKE_PITCH: f64 = -0.10;
const TOE_OFF_PITCH: f64 = 1.08;
/// Exponent of the heel's rise in time.
const HEEL_RISE: f64 = 1.7;
/// Ankles beside the line of running, metres.
const HALF_STEP_WIDTH: f64 = 0.04;
/// Turn of the toes outwards, radians.
const TOES_OUT: f64 = 0.05;
/// Speed to the side in flight, away from the foot that pushed, m/s.
const SIDEWAYS: f64 = 0.09;
/// Largest braking, and pushing, of the ground, m/s².
const BRAKING: f64 = 2.6;
/// Share of a stance's way that the ankle is ahead of the centre of mass at touch-down, from slow to fast.
const AHEAD: [f64; 2] = [0.25, 0.32];
/// Share of a straight leg that the most stretched leg of the cycle has.
const LONGEST_LEG: f64 = 0.991;

fn run(body: &Body, values: &Values) -> Made {
    let mut running = Running::new(body.clone(), values["speed"], values["turn"].to_radians());
    let last_frame = frame_at(whole_cycles(values["seconds"], 2.0 * running.step));
    running.plan_steps(last_frame as f64 / FPS);
    let poses = (0..=last_frame).map(|frame| running.pose(frame as f64 / FPS)).collect();
    Made { poses, events: Vec::new() }
}

/// A way to run.
#[derive(Clone, Debug)]
struct Running {
    body: Body,
    /// Metres per second.
    speed: f64,
    /// Of the whole body about +y, radians a second.
    turn: f64,
    /// Seconds from one touch-down to the next; a whole number of frames.
    step: f64,
    /// Seconds of a step that a foot is on the ground.
    stance: f64,
    /// Height of the centre of mass at touch-down and take-off, metres.
    height: f64,
    /// Plan position of the centre of mass at the touch-down of every step from number −2 on.
    starts: Vec<DVec3>,
}

/// Steps before the first that the first cycle needs: the right foot swings from one of them.
const STEPS_BEFORE: i32 = 2;

impl Running {
    /// Running at `speed` (m/s), turning by `turn` (rad/s).
    fn new(body: Body, speed: f64, turn: f64) -> Self {
        let (step, stance) = step_and_stance(body.scale, speed);
        let height = 1.05 * body.scale;
        let mut running = Self { body, speed, turn, step, stance, height, starts: Vec::new() };
        running.plan_steps(2.0 * step);
        running.height = running.highest_reachable();
        running
    }

    /// Finds where steps begin, for poses up to `seconds`.
    fn plan_steps(&mut self, seconds: f64) {
        let count = floor_index(seconds / self.step) + 6;
        self.starts.clear();
        let mut place = DVec3::ZERO;
        for (number, _) in (-STEPS_BEFORE..).zip(0..count) {
            self.starts.push(place);
            let after = self.flight_velocity(number + 1);
            let stance = 0.5 * (self.flight_velocity(number) + after) * self.stance;
            let braked = self.ahead_of(number) * (BRAKING * self.stance * self.stance / TAU);
            place += (stance + after * (self.step - self.stance) - braked) * DVec3::new(1.0, 0.0, 1.0);
        }
        let origin = self.starts[floor_index(f64::from(STEPS_BEFORE))];
        self.starts.iter_mut().for_each(|start| *start -= origin);
    }

    /// Heading of the body at an instant, radians about +y; that of step 0 at its mid-stance is 0.
    fn heading(&self, time: f64) -> f64 {
        self.turn * (time - 0.5 * self.stance)
    }

    /// Direction ahead at mid-stance of a step.
    fn ahead_of(&self, number: i32) -> DVec3 {
        yaw(self.turn * self.step * f64::from(number)) * DVec3::Z
    }

    /// Velocity at the end of the flight before a step, m/s; at its beginning it goes up as fast.
    fn flight_velocity(&self, number: i32) -> DVec3 {
        let ahead = self.speed + BRAKING * self.stance * self.stance / (TAU * self.step);
        let down = 0.5 * GRAVITY * (self.step - self.stance);
        let turned = self.turn * self.step * (f64::from(number) - 0.5);
        yaw(turned) * DVec3::new(SIDEWAYS * side_of(number).sign(), down, ahead)
    }

    /// Centre of mass at an instant, metres.
    fn center(&self, time: f64) -> DVec3 {
        // A touch-down falls on a frame; rounding must not put it before itself.
        let number = step_number(time / self.step + 1e-9);
        self.center_in(number, time - self.step * f64::from(number))
    }

    /// Centre of mass `since` the touch-down of a step.
    fn center_in(&self, number: i32, since: f64) -> DVec3 {
        let before = self.flight_velocity(number);
        let after = self.flight_velocity(number + 1) * DVec3::new(1.0, -1.0, 1.0);
        let push = after - before - DVec3::Y * (GRAVITY * self.stance);
        let start = self.start(number) + DVec3::Y * self.height;
        let stood = since.min(self.stance);
        let u = stood / self.stance;
        let pushed = push * (self.stance * (0.5 * u - (PI * u).sin() / TAU));
        let braked = self.stance / TAU * BRAKING * (stood - self.stance / TAU * (TAU * u).sin());
        let center = ballistic(start, before, stood) + pushed - self.ahead_of(number) * braked;
        ballistic(center, after, since - stood)
    }

    fn start(&self, number: i32) -> DVec3 {
        self.starts[floor_index(f64::from(number + STEPS_BEFORE))]
    }

    /// 0 for a slow run, 1 for a fast one; small bodies are sooner fast.
    fn fast(&self) -> f64 {
        ((self.speed / self.body.scale.sqrt() - 2.5) / 2.0).clamp(0.0, 1.0)
    }

    /// Where a foot stands in a step: its ankle when flat, and its turn.
    fn plant(&self, number: i32) -> Foot {
        let side = side_of(number);
        let turn = self.turn * self.step * f64::from(number);
        let middle = self.center_in(number, 0.5 * self.stance);
        let outwards = self.beside(side, ANKLE_HEIGHT * self.body.scale);
        let ahead = AHEAD[0] + (AHEAD[1] - AHEAD[0]) * self.fast();
        let behind = (0.5 - ahead) * self.speed * self.stance;
        let swayed = side.sign() * SIDEWAYS * (0.5 * (self.step - self.stance) + self.stance / PI);
        let ankle = DVec3::new(outwards - swayed, 0.0, -behind);
        let ankle = (middle + yaw(turn) * ankle).with_y(ANKLE_HEIGHT * self.body.scale);
        Foot { ankle, turn: turn + side.sign() * TOES_OUT, pitch: 0.0, toe: 0.0 }
    }

    /// Lean into the curve, radians to the left: as much as balances the centripetal force.
    fn list(&self) -> f64 {
        (self.speed * self.turn / -GRAVITY).atan()
    }

    /// Foot of a step `since` its touch-down, on the ground.
    fn standing(&self, number: i32, since: f64) -> Foot {
        let flat = self.plant(number);
        let share = since / self.stance;
        let pivoted = |point, pitch| self.body.pivoted(point, flat.ankle, [flat.turn, pitch]);
        if share < HEEL_OFF {
            let pitch = STRIKE_PITCH * (1.0 - smoothstep(share / FLAT));
            return Foot { ankle: pivoted(HEEL_OFFSET, pitch), pitch, ..flat };
        }
        let pitch = TOE_OFF_PITCH * ((share - HEEL_OFF) / (1.0 - HEEL_OFF)).powf(HEEL_RISE);
        let ankle = pivoted(TOE_OFFSET, pitch);
        Foot { ankle, pitch, toe: -pitch, ..flat }
    }

    /// A foot seen from the centre of mass, ahead along z, but at its height above the ground; turned, pitched and bent.
    fn seen(&self, foot: Foot, center: DVec3, time: f64) -> [DVec3; 2] {
        let place = yaw(-self.heading(time)) * (foot.ankle - center);
        let attitude = DVec3::new(foot.turn - self.heading(time), foot.pitch, foot.toe);
        [place.with_y(foot.ankle.y), attitude]
    }

    /// How far to the side of the centre of mass an ankle at some height is, metres: the leg leans as the body does, and
    /// a lifted foot is nearer to below its hip.
    fn beside(&self, side: Side, height: f64) -> f64 {
        let lifted = height - ANKLE_HEIGHT * self.body.scale;
        let outwards = HALF_STEP_WIDTH * self.body.scale + 0.12 * lifted;
        side.sign() * outwards - (self.height - height) * self.list().tan()
    }

    /// The foot that stood in a step, `since` its touch-down, in the air before its next.
    fn swinging(&self, number: i32, since: f64) -> Foot {
        /// Half the interval of difference quotients, seconds.
        const SMALL: f64 = 1e-5;
        let seconds = 2.0 * self.step - self.stance;
        let at = |number: i32, since: f64| {
            let time = self.step * f64::from(number) + since;
            self.seen(self.standing(number, since), self.center_in(number, since), time)
        };
        let rate = |number: i32, since: f64| {
            let (later, now) = (at(number, since + SMALL), at(number, since - SMALL));
            [0, 1].map(|k| (later[k] - now[k]) / (2.0 * SMALL) * seconds)
        };
        let ends = [at(number, self.stance), at(number + 2, 0.0)];
        // The stance formulas hold a little before and beyond a stance; a foot is still as it lands.
        let slopes = [rate(number, self.stance - SMALL), self.landing_rate(number + 2, seconds)];
        let u = (since - self.stance) / seconds;
        let [place, attitude] = self.swing_curves(side_of(number), ends, slopes).map(|curve| curve.at(u));
        let time = self.step * f64::from(number) + since;
        let ankle = self.center(time) + yaw(self.heading(time)) * place;
        Foot {
            ankle: ankle.with_y(place.y),
            turn: attitude.x + self.heading(time),
            pitch: attitude.y,
            toe: attitude.z,
        }
    }

    /// Rate at which a still foot moves as the centre of mass and the heading see it at touch-down, per swing.
    fn landing_rate(&self, number: i32, seconds: f64) -> [DVec3; 2] {
        let time = self.step * f64::from(number);
        let [place, _] = self.seen(self.standing(number, 0.0), self.center_in(number, 0.0), time);
        let velocity = yaw(-self.heading(time)) * self.flight_velocity(number);
        let turning = DVec3::Y.cross(place) * self.turn;
        [-(velocity + turning).with_y(0.0) * seconds, DVec3::X * (-self.turn * seconds)]
    }

    /// Place and attitude of a foot over the share of its swing: heel to the buttock, knee up, down to the ground.
    fn swing_curves(&self, side: Side, ends: [[DVec3; 2]; 2], slopes: [[DVec3; 2]; 2]) -> [Curve; 2] {
        let fast = self.fast();
        let scale = self.body.scale;
        let key = |u: f64, ahead: f64, high: f64| {
            (u, DVec3::new(self.beside(side, high * scale), high * scale, ahead * scale))
        };
        let places = [
            (0.0, ends[0][0]),
            key(0.30, -0.42 - 0.02 * fast, 0.40 + 0.09 * fast),
            key(0.52, -0.12 + 0.03 * fast, 0.33 + 0.11 * fast),
            key(0.74, 0.20 + 0.09 * fast, 0.19 + 0.13 * fast),
            key(0.89, 0.25 + 0.09 * fast, 0.125 + 0.05 * fast),
            (1.0, ends[1][0]),
        ];
        let turned = |u: f64, pitch: f64, toe: f64| (u, DVec3::new(0.0, pitch, toe));
        let attitudes = [
            (0.0, ends[0][1]),
            turned(0.24, 1.55 + 0.10 * fast, -0.45),
            turned(0.40, 1.50 + 0.15 * fast, -0.15),
            turned(0.55, 0.85 + 0.15 * fast, 0.0),
            turned(0.78, 0.08, 0.0),
            (1.0, ends[1][1]),
        ];
        let slope = |k: usize| [slopes[0][k], slopes[1][k]];
        [Curve::through(&places, slope(0)), Curve::through(&attitudes, slope(1))]
    }

    /// Where in the world a foot is.
    fn foot(&self, side: Side, time: f64) -> Foot {
        let number = step_number(time / self.step + 1e-9);
        let number = if side_of(number) == side { number } else { number - 1 };
        let since = time - self.step * f64::from(number);
        if since <= self.stance { self.standing(number, since) } else { self.swinging(number, since) }
    }

    /// Pose `time` seconds after a touch-down of the left foot.
    fn pose(&self, time: f64) -> Pose {
        self.stretched_pose(time).0
    }

    /// Pose and how far its more stretched leg is stretched.
    fn stretched_pose(&self, time: f64) -> (Pose, f64) {
        let heading = self.heading(time);
        let back = yaw(-heading);
        let center = self.center(time);
        let mut pose = self.upper_body(time, back * center - DVec3::Y * (0.06 * self.body.scale));
        let feet = Side::BOTH.map(|side| {
            let foot = self.foot(side, time);
            Foot { ankle: back * foot.ankle, turn: foot.turn - heading, ..foot }.target()
        });
        let longest = balance(&self.body, &mut pose, feet, back * center);
        pose.root = yaw(heading) * pose.root;
        pose.rotations[0] = yaw(heading) * pose.rotations[0];
        (pose, longest)
    }

    /// Trunk and arms, looking ahead along +z.
    fn upper_body(&self, time: f64, pelvis: DVec3) -> Pose {
        let angle = PI * time / self.step;
        let wave = |phase: f64| (angle - TAU * phase).cos();
        let fast = self.fast();
        let trunk = Trunk {
            pelvis_turn: -0.09 * wave(0.95),
            pelvis_list: 0.05 * wave(0.15) - self.list(),
            pelvis_tilt: 0.10 + 0.03 * fast,
            chest_turn: (0.16 + 0.05 * fast) * wave(0.95),
            chest_list: -self.list(),
            lean: 0.06 + 0.03 * fast,
        };
        let mut pose = self.body.pose(pelvis, trunk);
        for side in Side::BOTH {
            let back = side.sign() * wave(0.95);
            let arm = ArmAngles {
                swing: 0.10 + (0.55 + 0.12 * fast) * back,
                away: 0.20,
                inwards: 0.45 - 0.20 * back,
                bend: 1.65 - 0.20 * back,
            };
            self.body.bend_arm(&mut pose, side, arm);
        }
        pose
    }

    /// Largest height of the centre of mass at which both legs reach their feet all the time, by bisection.
    fn highest_reachable(&self) -> f64 {
        let mut trial = self.clone();
        let (mut low, mut high) = (0.6 * self.height, self.height);
        for _ in 0..30 {
            trial.height = 0.5 * (low + high);
            let mut instants = (0..60).map(|k| 2.0 * self.step * f64::from(k) / 60.0);
            if instants.all(|time| trial.stretched_pose(time).1 < LONGEST_LEG) {
                low = trial.height;
            } else {
                high = trial.height;
            }
        }
        low
    }
}

/// Seconds of a step, and how many of them a foot is on the ground. Both fall with speed, scaled as a pendulum of the body's
/// size; flights last a tenth of a second at least.
///
/// Source of the trends: Cavanagh & Kram, *Med. Sci. Sports Exerc.* 21 (1989), 467–479; Munro, Miller & Fuglevand,
/// *J. Biomechanics* 20 (1987), 147–155; the lines are ours.
pub(super) fn step_and_stance(scale: f64, speed: f64) -> (f64, f64) {
    const SHORTEST_FLIGHT: f64 = 0.105;
    let pendulum = scale.sqrt();
    let relative = speed / pendulum;
    let sprint = (relative - 4.5).max(0.0);
    let step = (pendulum * (0.400 - 0.0145 * relative - 0.03 * sprint) * FPS).round() / FPS;
    (step, (pendulum * (0.56 / relative + 0.076)).min(step - SHORTEST_FLIGHT))
}

/// Whole steps, of either sign.
#[expect(clippy::cast_possible_truncation, reason = "clips last 600 s at most, 3600 steps")]
fn step_number(steps: f64) -> i32 {
    steps.floor() as i32
}

/// Which foot a step lands on.
fn side_of(number: i32) -> Side {
    if number.rem_euclid(2) == 0 { Side::Left } else { Side::Right }
}
