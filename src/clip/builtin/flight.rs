//! Flights: nothing but gravity moves the centre of mass, nothing changes the angular momentum.
//!
//! The centre of mass is on its parabola by the performance's curves. The limbs do what they do; the pitch of the body
//! follows from the momentum, `θ̇ = (L − L_limbs) / I`, where `L_limbs` and the inertia `I` are those of the moving shape with
//! its pelvis upright. `L` is chosen so that the body lands at the pitch in which it is to stand.

use std::f64::consts::TAU;

use glam::DVec3;

use super::FPS;
use super::body::{LEGS, Side};
use super::keyed::{Curve, Key};
use super::momentum::Segments;
use super::performance::{Performance, vector};
use crate::geometry::{exp, log};
use crate::index::floor_index;
use crate::skeleton::Pose;

/// Time in the air: the legs by their joints' angles, the pitch by the momentum.
#[derive(Clone, Debug)]
pub(super) struct Flight {
    /// Seconds; feet stand until then and from then on.
    pub(super) takeoff: f64,
    pub(super) landing: f64,
    /// Of the pelvis, radians.
    pub(super) pitch: Curve,
    /// Rotation vectors of the leg joints, radians, in the skeleton's order.
    pub(super) legs: [[Curve; 3]; 8],
}

/// Angles of both legs at one instant in the air, radians.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tuck {
    /// Seconds.
    pub(super) time: f64,
    pub(super) hip: f64,
    pub(super) knee: f64,
    /// Toes down.
    pub(super) ankle: f64,
}

/// What a flight is to be.
#[derive(Clone, Debug)]
pub(super) struct Air {
    /// Seconds, on frames.
    pub(super) takeoff: f64,
    pub(super) landing: f64,
    /// Whole turns forward.
    pub(super) turns: f64,
    pub(super) tucks: Vec<Tuck>,
    /// Keys of the pelvis' pitch before and after; the rates of those at takeoff and landing follow from the momentum.
    pub(super) pitch: Vec<Key>,
}

/// Step of difference quotients in time, seconds.
const SMALL: f64 = 1e-5;

impl Flight {
    /// Whether the body is in the air; at the ends its feet still or already stand.
    pub(super) fn holds(&self, time: f64) -> bool {
        self.takeoff < time && time < self.landing
    }

    /// Turns the leg joints.
    pub(super) fn place_legs(&self, pose: &mut Pose, time: f64) {
        for (joint, curves) in self.legs.iter().enumerate() {
            pose.rotations[LEGS[0] + joint] = exp(vector(curves, time));
        }
    }
}

/// Lets a performance fly. Its curves but the pitch are set, and leave the ground and come back with the speed of the fall.
///
/// The rates of the legs at both ends depend on the pitch's, and it on theirs: a fixed point, which halves its error.
pub(super) fn fly(act: &mut Performance, mut air: Air) {
    const ROUNDS: usize = 80;
    /// Radians per second.
    const CLOSE: f64 = 1e-10;
    for _ in 0..ROUNDS {
        act.trunk.pitch = Curve::new(air.pitch.clone());
        act.flight = None;
        let mut flight = Flight {
            takeoff: air.takeoff,
            landing: air.landing,
            pitch: Curve::constant(0.0),
            legs: leg_curves(act, &air),
        };
        let (pitch, rates) = integrated_pitch(act, &flight, air.turns);
        flight.pitch = pitch;
        act.flight = Some(flight);
        if set_rates(&mut air, rates) < CLOSE {
            break;
        }
    }
}

/// Sets the pitch's rates at takeoff and landing; returns by how much they changed.
fn set_rates(air: &mut Air, rates: [f64; 2]) -> f64 {
    let mut change: f64 = 0.0;
    for (time, rate) in [(air.takeoff, rates[0]), (air.landing, rates[1])] {
        for key in air.pitch.iter_mut().filter(|key| key.time == time) {
            change = change.max((key.rate - rate).abs());
            key.rate = rate;
        }
    }
    change
}

/// Curves of the leg joints from the stance that pushes through the tucks to the stance that lands.
fn leg_curves(act: &Performance, air: &Air) -> [[Curve; 3]; 8] {
    let [leaving, landing] = [End::new(act, air.takeoff, -SMALL), End::new(act, air.landing, SMALL)];
    std::array::from_fn(|joint| {
        let tucks: Vec<(f64, DVec3)> = air.tucks.iter().map(|tuck| (tuck.time, tuck.angles(joint))).collect();
        [0, 1, 2].map(|axis| {
            let [first, last] = [&leaving, &landing].map(|end| (end.time, end.vectors[joint][axis]));
            let [free, ready] = [leaving.relaxed(joint, 1.0), landing.relaxed(joint, -1.0)];
            let middle = tucks.iter().map(|(time, vector)| (*time, vector[axis]));
            let points: Vec<(f64, f64)> = [first, (free.0, free.1[axis])]
                .into_iter()
                .chain(middle)
                .chain([(ready.0, ready.1[axis]), last])
                .collect();
            Curve::between(&points, [leaving.rates[joint][axis], landing.rates[joint][axis]])
        })
    })
}

/// Leg joints at one end of a flight: rotation vectors and their rates, as those of the feet that stand.
#[derive(Clone, Debug)]
struct End {
    time: f64,
    vectors: [DVec3; 8],
    rates: [DVec3; 8],
}

impl End {
    /// `step`, seconds, leads to where the feet stand.
    fn new(act: &Performance, time: f64, step: f64) -> Self {
        let vectors = |time: f64| {
            let pose = act.pose(time);
            std::array::from_fn::<DVec3, 8, _>(|joint| log(pose.rotations[LEGS[0] + joint]))
        };
        let (here, there) = (vectors(time), vectors(time + step));
        let rates = std::array::from_fn(|joint| (there[joint] - here[joint]) / step);
        Self { time, vectors: here, rates }
    }

    /// When and where a joint has lost its rate, after this end (`sign` 1) or before it (−1): soon enough that the knees do not
    /// lock.
    fn relaxed(&self, joint: usize, sign: f64) -> (f64, DVec3) {
        /// Longest, seconds; share of rate times time that a joint moves on; least bend of a knee, radians.
        const LONGEST: f64 = 0.10;
        const MOVES: f64 = 0.4;
        const LEAST_BEND: f64 = 0.10;
        let knee = 1;
        let (bend, straightening) = (self.vectors[knee].x, -sign * self.rates[knee].x);
        let time = LONGEST.min((bend - LEAST_BEND) / (MOVES * straightening.max(1e-3))).max(0.02);
        (self.time + sign * time, self.vectors[joint] + self.rates[joint] * (sign * MOVES * time))
    }
}

impl Tuck {
    /// Rotation vector of the leg joint at `joint` of eight: hip, knee, ankle, toes, left before right.
    fn angles(&self, joint: usize) -> DVec3 {
        /// Knees a little apart, radians.
        const APART: f64 = 0.10;
        let side = if joint < 4 { Side::Left } else { Side::Right };
        match joint % 4 {
            0 => DVec3::new(-self.hip, 0.0, APART * side.sign()),
            1 => DVec3::X * self.knee,
            2 => DVec3::X * self.ankle,
            _ => DVec3::ZERO,
        }
    }
}

/// The pitch in flight, and its rates at takeoff and landing.
///
/// Simpson's rule on quarters of frames; the shape's quantities do not depend on the pitch.
fn integrated_pitch(act: &Performance, air: &Flight, turns: f64) -> (Curve, [f64; 2]) {
    const PER_FRAME: f64 = 4.0;
    let span = air.landing - air.takeoff;
    let steps = floor_index(span * FPS * PER_FRAME + 0.5);
    let step = span / steps as f64;
    let samples: Vec<Momentum> =
        (0..=2 * steps).map(|k| momentum(act, air, air.takeoff + 0.5 * step * k as f64)).collect();
    let integral = |value: &dyn Fn(&Momentum) -> f64, k: usize| {
        let [a, b, c] = [0, 1, 2].map(|m| value(&samples[2 * k + m]));
        step / 6.0 * (a + 4.0 * b + c)
    };
    let total = |value: &dyn Fn(&Momentum) -> f64| (0..steps).map(|k| integral(value, k)).sum::<f64>();
    let [from, to] = [air.takeoff, air.landing].map(|time| act.trunk.pitch.at(time));
    let turn = to - from + turns * TAU;
    let held = (turn + total(&|m| m.limbs / m.inertia)) / total(&|m| 1.0 / m.inertia);
    let rate = |m: &Momentum| (held - m.limbs) / m.inertia;
    let mut value = from;
    let keys = (0..=steps).map(|k| {
        let (before, after) = ((2 * k).saturating_sub(1), (2 * k + 1).min(2 * steps));
        let time = air.takeoff + step * k as f64;
        let acceleration =
            (rate(&samples[after]) - rate(&samples[before])) / (0.5 * step * (after - before) as f64);
        let key = Key { time, value, rate: rate(&samples[2 * k]), acceleration };
        if k < steps {
            value += integral(&rate, k);
        }
        key
    });
    (Curve::new(keys.collect()), [rate(&samples[0]), rate(&samples[2 * steps])])
}

/// Of a moving shape about the lateral axis through its centre of mass, per kilogram of the body.
#[derive(Clone, Copy, Debug)]
struct Momentum {
    /// Angular momentum with the pelvis held upright, m²/s.
    limbs: f64,
    /// Moment of inertia, m².
    inertia: f64,
}

fn momentum(act: &Performance, air: &Flight, time: f64) -> Momentum {
    let (before, after) = ((time - SMALL).max(air.takeoff), (time + SMALL).min(air.landing));
    let [before_shape, shape, after_shape] =
        [before, time, after].map(|time| Segments::of(&act.body, &act.shape(air, time)));
    let limbs = before_shape.angular_step(&after_shape) / (after - before);
    Momentum { limbs, inertia: shape.inertia() }
}
