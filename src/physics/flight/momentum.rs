//! Angular momentum of a body between two successive frames, as a function of turns of a part of it.
//!
//! About the centre of mass `c`, with `x = r − c` in the frames 0 and 1, `ω = Log(R1 R0ᵀ)/dt` and R half way:
//!
//! ```text
//!     h = Σ [ R I Rᵀ ω + m x0 × x1/dt ]        dh = K φ/dt  for a turn φ of frame 1,
//!     K = Σ_S [ R I Rᵀ + m ((x0·d1) 1 − d1 x0ᵀ) ],  d = r − p,  S what turns about p
//! ```
//!
//! It is the momentum of links that turn evenly and go straight between the frames, so that what is constant frame by frame is
//! constant. What goes by masses alone are sums over links of `m r0 r1ᵀ`: 3 × 3, whatever the turns.

use glam::{DMat3, DQuat, DVec3};

use crate::geometry::{exp, log};
use crate::physics::body_model::{BodyModel, Link};
use crate::physics::flight::halves::Half;
use crate::physics::posed::PosedClip;

/// Two successive frames of a body of which a part turns about a pivot.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// From one frame to the next, seconds.
    pub step: f64,
    mass: f64,
    /// `Σ m r0 r1ᵀ` from the pivots, of what turns.
    turning: DMat3,
    /// The same of what does not.
    still: DMat3,
    /// `Σ m r / M` from the pivots, of what turns and of what does not, in both frames.
    centers: [Centers; 2],
    /// Of links that do not turn, kg m².
    still_spin: DVec3,
    spins: Vec<Spin>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Centers {
    turning: DVec3,
    still: DVec3,
}

/// How a link that turns turns between the frames.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spin {
    /// In the world, from frame 0 to frame 1.
    turn: DQuat,
    /// In frame 0.
    rotation: DQuat,
    inertia: DMat3,
}

/// Momentum and how it depends on turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momentum {
    /// `h`, about the centre of mass, kg m²/s.
    pub value: DVec3,
    /// `K`, kg m²: what resists turning.
    pub resistance: DMat3,
}

/// Pairs of the frames `first` to `last` of `posed`. `half`: what turns, about where it hangs; without it all, about the centre of
/// mass. Cost: linear in frames times links.
pub fn pairs(
    body: &BodyModel,
    posed: &PosedClip,
    (first, last): (usize, usize),
    half: Option<&Half>,
) -> Vec<Pair> {
    let frames: Vec<Frame> = (first..=last).map(|frame| Frame::of(body, posed, frame, half)).collect();
    frames.windows(2).map(|two| Pair::of(body, [&two[0], &two[1]], half, posed.step())).collect()
}

/// Links in one frame, from the pivot.
struct Frame {
    places: Vec<DVec3>,
    rotations: Vec<DQuat>,
}

impl Frame {
    fn of(body: &BodyModel, posed: &PosedClip, frame: usize, half: Option<&Half>) -> Self {
        let place = |link: &Link| {
            let joint = posed.at(frame, link.joint);
            joint.position + joint.rotation * link.com
        };
        let mut places: Vec<DVec3> = body.links.iter().map(place).collect();
        let pivot = half.map_or_else(
            || places.iter().zip(&body.links).map(|(place, link)| link.mass / body.mass * *place).sum(),
            |half| posed.at(frame, half.border).position,
        );
        places.iter_mut().for_each(|place| *place -= pivot);
        let rotations = body.links.iter().map(|link| posed.at(frame, link.joint).rotation).collect();
        Self { places, rotations }
    }
}

impl Pair {
    fn of(body: &BodyModel, [before, after]: [&Frame; 2], half: Option<&Half>, step: f64) -> Self {
        let mut pair = Self {
            step,
            mass: body.mass,
            turning: DMat3::ZERO,
            still: DMat3::ZERO,
            centers: [Centers::default(); 2],
            still_spin: DVec3::ZERO,
            spins: Vec::with_capacity(body.links.len()),
        };
        for (index, link) in body.links.iter().enumerate() {
            let turns = half.is_none_or(|half| half.turns(link.joint));
            let places = [before.places[index], after.places[index]];
            let [from, to] = [before.rotations[index], after.rotations[index]];
            let spin = Spin { turn: to * from.inverse(), rotation: from, inertia: link.inertia };
            let product = link.mass * outer(places[0], places[1]);
            if turns {
                pair.turning += product;
                pair.spins.push(spin);
            } else {
                pair.still += product;
                pair.still_spin += spin.momentum([DQuat::IDENTITY; 2]).0;
            }
            // About its own centre of mass a body has none.
            for (centers, place) in pair.centers.iter_mut().zip(places).filter(|_| half.is_some()) {
                let sum = if turns { &mut centers.turning } else { &mut centers.still };
                *sum += link.mass / body.mass * place;
            }
        }
        pair
    }

    /// Momentum when what turns is turned by `turns` in the two frames. Cost: linear in the links that turn.
    pub fn momentum(&self, turns: [DQuat; 2]) -> Momentum {
        let [from, to] = turns.map(DMat3::from_quat);
        let centers = [(from, self.centers[0]), (to, self.centers[1])];
        let [center_from, center_to] = centers.map(|(turn, own)| own.still + turn * own.turning);
        let turning = from * self.turning * to.transpose();
        let all = turning + self.still - self.mass * outer(center_from, center_to);
        let arms = turning - self.mass * outer(center_from, to * self.centers[1].turning);
        let mut value = self.still_spin + crosswise(&all);
        let mut resistance = DMat3::from_diagonal(DVec3::splat(trace(&arms))) - arms.transpose();
        for spin in &self.spins {
            let (momentum, inertia) = spin.momentum(turns);
            value += momentum;
            resistance += inertia;
        }
        Momentum { value: value / self.step, resistance }
    }
}

impl Pair {
    /// Axes of the first link that turns, in the world.
    pub(super) fn axes(&self) -> DMat3 {
        self.spins.first().map_or(DMat3::IDENTITY, |spin| DMat3::from_quat(spin.rotation))
    }
}

impl Spin {
    /// `R I Rᵀ Log(R1 R0ᵀ)` and `R I Rᵀ`, R half way.
    fn momentum(&self, [from, to]: [DQuat; 2]) -> (DVec3, DMat3) {
        let turn = log(to * self.turn * from.inverse());
        let axes = DMat3::from_quat(exp(0.5 * turn) * (from * self.rotation));
        let inertia = axes * self.inertia * axes.transpose();
        (inertia * turn, inertia)
    }
}

/// `a bᵀ`.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// Of `Σ a bᵀ` the sum `Σ a × b`.
fn crosswise(sum: &DMat3) -> DVec3 {
    let [x, y, z] = [sum.x_axis, sum.y_axis, sum.z_axis];
    DVec3::new(z.y - y.z, x.z - z.x, y.x - x.y)
}

pub(super) fn trace(matrix: &DMat3) -> f64 {
    matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z
}
