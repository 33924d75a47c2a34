//! Walking from footplants: where the feet are decides, the legs follow by inverse kinematics.
//!
//! A walk may set off from a stand and come to one: then the first and last plants are those of the stand, the pelvis gains
//! and loses its speed evenly, and everything else of the gait grows and fades with that speed.
//!
//! Phase 0 is a strike of the left foot, phase ½ one of the right. A foot strikes with its toes up and turns about the
//! heel until flat, stays flat, lifts its heel about the toe joint, which stays put, and swings.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::body::{ANKLE_HEIGHT, Body, HEEL_OFFSET, PELVIS_HEIGHT, Side, TOE_OFFSET, Trunk};
use super::course::{Course, Place};
use super::limbs::Foot;
use super::mass::GRAVITY;
use super::swing::{TOE_OFF, ahead, bump, heel_rise, swinging_pitch, swinging_toe};
use super::{FPS, stand};
use crate::geometry::{smoothstep, yaw};
use crate::skeleton::Pose;

/// Seconds in which a foot that has struck comes down flat, and in which its heel rises before the toes lift.
const LANDING: f64 = 2.0 / FPS;
const HEEL_RISING: f64 = 0.24;
/// Longest rise of the heel, in cycles.
const LONGEST_RISE: f64 = 0.23;
/// Pitch of the foot at its strike, less in slow walks, radians.
const STRIKE_PITCH: f64 = -0.30;
/// Phase of the strongest support by the left leg: the pelvis is highest and farthest left.
const MID_STANCE: f64 = 0.31;
/// Ankles beside the line of walking, metres.
const HALF_STEP_WIDTH: f64 = 0.065;
/// Turn of the toes outwards, radians.
const TOES_OUT: f64 = 0.07;
/// Cycles in which a walk gains its speed and loses it.
pub(super) const SETTING_OFF: f64 = 1.3;
pub(super) const HALTING: f64 = 1.0;
/// Cycles from the first strike, and from the last, between which the weight is on the right foot.
const LEAVING: [f64; 2] = [-0.85, 0.15];
const COMING: [f64; 2] = [0.4, 1.2];
/// Share of a straight leg that the most stretched leg of the cycle has.
const LONGEST_LEG: f64 = 0.997;
/// The same while setting off and halting.
const LONGEST_LEG_BETWEEN: f64 = 0.9977;

/// A way to walk.
#[derive(Clone, Debug)]
pub(super) struct Gait {
    body: Body,
    /// Metres per second.
    speed: f64,
    /// Seconds of a cycle of two steps; a whole number of frames.
    pub(super) period: f64,
    /// Pelvis above the ground on average, metres.
    height: f64,
    /// How much lower it is half way between standing and walking, metres.
    dip: f64,
    /// Of a foot at its strike, radians.
    strike_pitch: f64,
    /// Where it goes.
    course: Course,
    bearing: Bearing,
    /// Where the walk begins and ends, if it does.
    ends: Ends,
}

/// How the upper body is borne, beside what walking does with it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bearing {
    /// Pelvis ahead of where it would be above the feet, metres at 1.75 m.
    pub(super) ahead: f64,
    /// Pelvis lower than without, metres at 1.75 m.
    pub(super) low: f64,
    /// Tilt of the pelvis and bend of the trunk, both forward, radians.
    pub(super) tilt: f64,
    pub(super) lean: f64,
    /// Share of the thorax' turning that it does without.
    pub(super) still: f64,
}

/// Stands at the ends of a walk.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ends {
    /// Sets off from a stand, at full speed half [`SETTING_OFF`] cycles after the first strike.
    pub(super) start: bool,
    /// Strike of the left foot, in cycles, at which it begins to halt.
    pub(super) stop: Option<f64>,
}

/// Where a foot stands from one strike to the next lift.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plant {
    ankle: DVec3,
    turn: f64,
}

/// What a foot does between two plants.
#[derive(Clone, Copy, Debug)]
struct Step {
    before: Plant,
    plant: Plant,
    next: Plant,
}

impl Gait {
    /// Walking at `speed` along `course`; step length and cadence keep a walk ratio of 0.39 m·s, as people do.
    ///
    /// Source: Sekiya et al., *J. Human Movement Studies* 30 (1996), 241–257 (walk ratio 0.0065 m per step/min).
    pub(super) fn new(body: Body, speed: f64, course: Course, bearing: Bearing) -> Self {
        const WALK_RATIO: f64 = 0.39;
        /// Metres at 1.75 m; where small bodies are fast, only their cadence rises.
        const LONGEST_STEP: f64 = 0.80;
        let step = (speed * WALK_RATIO * body.scale).sqrt().min(LONGEST_STEP * body.scale);
        let half_period = (step / speed * FPS).round() / FPS;
        let height = PELVIS_HEIGHT * body.scale;
        let usual = speed / (1.2 * body.scale.sqrt());
        let strike_pitch = STRIKE_PITCH * usual.clamp(0.3, 1.0);
        let ends = Ends::default();
        let mut gait = Self {
            height,
            dip: 0.0,
            period: 2.0 * half_period,
            body,
            speed,
            strike_pitch,
            course,
            bearing,
            ends,
        };
        gait.height = gait.highest_reachable();
        gait
    }

    /// Pose `time` seconds after a strike of the left foot at which the pelvis was over the origin.
    pub(super) fn pose(&self, time: f64) -> Pose {
        let mut pose = self.pose_on_course(time, 1.0).0;
        self.place(time).bring(&mut pose);
        pose
    }

    /// Where on its course the body is.
    pub(super) fn place(&self, time: f64) -> Place {
        self.course.place(self.travel(time))
    }

    /// Where in the world a foot is `time` seconds after a strike of the left one.
    pub(super) fn foot(&self, side: Side, time: f64) -> Foot {
        let delay = match side {
            Side::Left => 0.0,
            Side::Right => 0.5,
        };
        let cycles = time / self.period - delay;
        // A strike falls on a frame; rounding must not put it before itself.
        let cycle = (cycles + 1e-9).floor();
        let phase = (cycles - cycle).max(0.0);
        let plant = |cycle: f64| self.plant(side, cycle + delay);
        let step = Step { before: plant(cycle - 1.0), plant: plant(cycle), next: plant(cycle + 1.0) };
        if step.plant == step.next {
            return self.landing(step, phase.min(self.flat()));
        }
        if phase < TOE_OFF { self.supporting(step, phase) } else { self.swinging(step, phase) }
    }

    /// Plant of a foot that strikes at `strike`, in cycles, in course coordinates.
    fn plant(&self, side: Side, strike: f64) -> Plant {
        let stand = |z: f64| {
            let (ankle, turn) = stand::planted(&self.body, side);
            Plant { ankle: ankle + DVec3::Z * z, turn }
        };
        if self.ends.start && strike < -1e-9 {
            return stand(0.0);
        }
        if let Some(stop) = self.ends.stop.filter(|stop| strike > stop + 1e-9) {
            return stand(self.travel(self.period * (stop + HALTING)));
        }
        let ankle = DVec3::new(
            side.sign() * HALF_STEP_WIDTH * self.body.scale,
            ANKLE_HEIGHT * self.body.scale,
            self.speed * self.period * strike + self.reach_ahead(),
        );
        Plant { ankle, turn: side.sign() * TOES_OUT }
    }

    /// Where the pelvis is `time` seconds after the first strike, metres ahead.
    fn travel(&self, time: f64) -> f64 {
        let half = 0.5 * SETTING_OFF * self.period;
        if self.ends.start && time < half {
            return self.speed * (time + half).max(0.0).powi(2) / (4.0 * half);
        }
        match self.ends.stop.map(|stop| stop * self.period).filter(|stop| time > *stop) {
            Some(stop) => {
                let length = HALTING * self.period;
                let gone = (time - stop).min(length);
                self.speed * (stop + gone - gone * gone / (2.0 * length))
            }
            None => self.speed * time,
        }
    }

    /// Share of the full speed, smoothed.
    fn pace(&self, time: f64) -> f64 {
        let cycles = time / self.period;
        let started = if self.ends.start { smoothstep(cycles / SETTING_OFF + 0.5) } else { 1.0 };
        let stopping = self.ends.stop.map_or(1.0, |stop| 1.0 - smoothstep((cycles - stop) / HALTING));
        started * stopping
    }

    /// How far the pelvis goes to the right, metres, before the left foot leaves a stand, and before it comes to one.
    fn weight_shift(&self, time: f64) -> f64 {
        /// Metres at 1.75 m.
        const FARTHEST: f64 = 0.04;
        let bump = |cycles: f64, [first, last]: [f64; 2]| {
            let half = 0.5 * (last - first);
            smoothstep((cycles - first) / half) * smoothstep((last - cycles) / half)
        };
        let cycles = time / self.period;
        let leaving = if self.ends.start { bump(cycles, LEAVING) } else { 0.0 };
        let coming = self.ends.stop.map_or(0.0, |stop| bump(cycles - stop, COMING));
        FARTHEST * self.body.scale * (leaving + coming)
    }

    /// Phase at which a foot that has struck is flat.
    fn flat(&self) -> f64 {
        LANDING / self.period
    }

    /// Phase at which a heel begins to rise.
    fn heel_off(&self) -> f64 {
        TOE_OFF - (HEEL_RISING / self.period).min(LONGEST_RISE)
    }

    /// Distance of a striking ankle ahead of the pelvis, metres.
    fn reach_ahead(&self) -> f64 {
        0.235 * self.speed * self.period
    }

    /// Largest height of the pelvis at which both legs reach their feet all the time, by bisection.
    fn highest_reachable(&self) -> f64 {
        let mut trial = self.clone();
        let (mut low, mut high) = (0.6 * self.height, self.height);
        for _ in 0..30 {
            trial.height = 0.5 * (low + high);
            if trial.reaches([0.0, 1.0], LONGEST_LEG) {
                low = trial.height;
            } else {
                high = trial.height;
            }
        }
        low
    }

    /// Makes the walk begin and end so, its pelvis just low enough meanwhile for both legs to reach.
    pub(super) fn end_at(&mut self, ends: Ends) {
        self.ends = ends;
        let mut trial = self.clone();
        let mut reaches = |dip: f64| {
            trial.dip = dip;
            let halting = ends.stop.is_none_or(|stop| trial.reaches([stop, COMING[1]], LONGEST_LEG_BETWEEN));
            halting && trial.reaches([LEAVING[0], 1.5], LONGEST_LEG_BETWEEN)
        };
        if reaches(0.0) {
            return;
        }
        let (mut low, mut high) = (0.0, 0.2 * self.height);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if reaches(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        self.dip = high;
    }

    /// Whether no leg is stretched farther than `longest` from the first of some cycles on; legs are longest when a heel lifts.
    fn reaches(&self, [first, cycles]: [f64; 2], longest: f64) -> bool {
        let even = (0..60).map(|k| first + cycles * f64::from(k) / 60.0);
        let half_cycles = (0..6).map(|k| (2.0 * first).floor() / 2.0 + 0.5 * f64::from(k));
        let lifts = half_cycles
            .map(|half| half + self.heel_off())
            .filter(|lift| (first..first + cycles).contains(lift));
        let mut instants = even.chain(lifts);
        instants.all(|instant| self.pose_on_course(self.period * instant, 1.0).1 < longest)
    }

    /// Pose on the course straightened where the body is, with a share of its bearing, and how far its more stretched leg is
    /// stretched.
    pub(super) fn pose_on_course(&self, time: f64, bearing: f64) -> (Pose, f64) {
        let share = self.pace(time);
        let pace = share * self.speed.min(1.6) / 1.2;
        let angle = TAU * time / self.period;
        let wave = |phase: f64| (angle - TAU * phase).cos();
        let bob = (2.0 * (angle - TAU * MID_STANCE)).cos();
        let (place, borne) = (self.place(time), self.bearing);
        // Who stands with the pelvis ahead of the feet has it lower, or the legs were too short.
        let lower = 0.8 * borne.ahead * borne.ahead * bearing * self.body.scale;
        let low = borne.low * bearing * self.body.scale;
        let stand = stand::pelvis_height(&self.body) - lower;
        let list = -share * self.list();
        let pelvis = DVec3::new(
            0.018 * self.body.scale * share * wave(MID_STANCE)
                - self.height * list.tan()
                - self.weight_shift(time),
            stand - low + share * (self.height - stand) - 4.0 * self.dip * share * (1.0 - share)
                + 0.016 * self.body.scale * pace * bob,
            self.travel(time) + borne.ahead * bearing * self.body.scale,
        );
        let trunk = Trunk {
            pelvis_turn: -0.09 * pace * wave(0.03),
            pelvis_list: 0.045 * pace * wave(0.2) + list,
            chest_list: list,
            pelvis_tilt: 0.11 * pace + borne.tilt * bearing,
            chest_turn: 0.08 * pace * wave(0.03) * (1.0 - borne.still * bearing),
            lean: stand::LEAN * (1.0 - share) - 0.03 * pace + borne.lean * bearing,
        };
        let mut pose = self.body.pose(pelvis, trunk);
        let mut longest: f64 = 0.0;
        for side in Side::BOTH {
            let stretch = self.body.place_foot(&mut pose, side, place.straighten(self.foot(side, time)));
            longest = longest.max(stretch);
            let back = side.sign() * wave(0.04);
            let (swing, bend) = (pace * (0.36 * back - 0.02), 0.28 + 0.14 * pace * (1.0 - back));
            let (stand_swing, stand_bend) = stand::HANGING_ARM;
            stand::lift_collar(&mut pose, side, 1.0 - share);
            let mixed = |stand: f64, walk: f64| stand + share * (walk - stand);
            self.body.hang_arm(&mut pose, side, mixed(stand_swing, swing), mixed(stand_bend, bend));
        }
        (pose, longest)
    }

    /// Lean into the curve, radians to the left, at full speed: as much as balances the centripetal force.
    fn list(&self) -> f64 {
        (self.speed * self.speed * self.course.curvature / -GRAVITY).atan()
    }

    /// On the ground: toes come down, flat, heel goes up about the toe joint.
    fn supporting(&self, step: Step, phase: f64) -> Foot {
        if phase < self.heel_off() {
            return self.landing(step, phase);
        }
        let turn = step.plant.turn;
        let cycles = TOE_OFF - self.heel_off();
        let pitch = heel_rise((phase - self.heel_off()) / cycles, cycles);
        let ankle = self.about(TOE_OFFSET, step.plant, pitch);
        self.planted(step.plant, Foot { ankle, turn, pitch, toe: -pitch })
    }

    /// A flat foot, but for its toes coming down about the heel after a strike.
    fn landing(&self, step: Step, phase: f64) -> Foot {
        let turn = step.plant.turn;
        let pitch = if step.before == step.plant {
            0.0
        } else {
            self.strike_pitch * (1.0 - smoothstep(phase / self.flat()))
        };
        let ankle = self.about(HEEL_OFFSET, step.plant, pitch);
        self.planted(step.plant, Foot { ankle, turn, pitch, toe: 0.0 })
    }

    /// In the world a foot that is on the ground, given on the course straightened at its plant.
    fn planted(&self, plant: Plant, foot: Foot) -> Foot {
        let place = self.course.place(plant.ankle.z);
        Foot { ankle: place.to_world(foot.ankle), turn: place.heading + foot.turn, ..foot }
    }

    /// Ankle of a foot that has turned by `pitch` about a point of it since it was flat.
    fn about(&self, point: DVec3, plant: Plant, pitch: f64) -> DVec3 {
        self.body.pivoted(point, plant.ankle, [plant.turn, pitch])
    }

    /// In the air: the toe joint goes from the plant to where it is at the next strike, upwards before ahead; the heel
    /// turns about it.
    fn swinging(&self, step: Step, phase: f64) -> Foot {
        /// Additional height of the toe joint half way, metres.
        const LIFT: f64 = 0.04;
        let u = (phase - TOE_OFF) / (1.0 - TOE_OFF);
        let bent = |plant: Plant, point| self.course.bend(self.course.place(plant.ankle.z), point);
        let from = bent(step.plant, step.plant.ankle + self.to_toe(step.plant.turn, 0.0));
        let struck = self.about(HEEL_OFFSET, step.next, self.strike_pitch);
        let to = bent(step.next, struck + self.to_toe(step.next.turn, self.strike_pitch));
        let height = from.y + (to.y - from.y) * smoothstep(u) + LIFT * self.body.scale * bump(u);
        let toe_joint = self.course.to_world((from + (to - from) * ahead(u)).with_y(height));
        let turn_at = |plant: Plant| self.course.place(plant.ankle.z).heading + plant.turn;
        let turn = turn_at(step.plant) + (turn_at(step.next) - turn_at(step.plant)) * smoothstep(u);
        let pitch = swinging_pitch(self.strike_pitch, u);
        Foot { ankle: toe_joint - self.to_toe(turn, pitch), turn, pitch, toe: swinging_toe(pitch, u) }
    }

    /// From the ankle to the toe joint, metres.
    fn to_toe(&self, turn: f64, pitch: f64) -> DVec3 {
        yaw(turn) * (DQuat::from_rotation_x(pitch) * (TOE_OFFSET * self.body.scale))
    }
}
