//! The zero moment point, and how far it is from the polygon of support.
//!
//! With `F_i = m_i (a_i − g)` on every link and `σ = Σ F_iy`, the vertical force of the ground, about the plane `y = h`:
//!
//! ```text
//!     Z_x = (Σ F_iy x_i − Σ F_ix (y_i − h) + n_z) / σ
//!     Z_z = (Σ F_iy z_i − Σ F_iz (y_i − h) − n_x) / σ
//! ```
//!
//! `n` are free moments: of links that turn, and of forces from elsewhere. The printed vector equation demands that the whole moment
//! vanishes; only its two horizontal components can.

use glam::{DMat3, DQuat, DVec2, DVec3};

use crate::geometry::{exp, log, smoothstep};
use crate::physics::GRAVITY;
use crate::physics::body_model::{BodyModel, Link};
use crate::physics::derivatives::orientation::lee_shin;
use crate::physics::derivatives::{DERIVATIVE_WIDTH, Filter, Kernel, Lanes};
use crate::physics::posed::{PosedClip, link_places};
use crate::physics::stages::{Phase, Stages};
use crate::physics::support::nearest;

/// A force that something else than the ground exerts on the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExternalForce {
    /// When.
    pub frame: usize,
    /// Place of the link it acts on in [`BodyModel::links`].
    pub link: usize,
    /// World, newtons.
    pub force: DVec3,
    /// Where it acts, world, metres.
    pub point: DVec3,
}

/// What is counted as force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceSettings<'a> {
    /// How places are filtered before they are differentiated.
    pub filter: Filter,
    /// Whether links resist turning; otherwise they are points.
    pub inertia: bool,
    /// What others exert.
    pub external: &'a [ExternalForce],
}

/// Forces that links need from outside to move as they do.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkForces {
    /// Unfiltered world places of the links' centres of mass, metres: lanes x, y, z of each link.
    pub places: Lanes,
    /// `m (a − g)` less external forces, newtons, lanes as in `places`.
    pub forces: Lanes,
    /// Moments besides those of the forces at the places, N m, one a frame.
    pub free_moments: Vec<DVec3>,
}

/// Forces on the links of `body` in all frames of `posed`. Cost: linear in frames times links.
pub fn link_forces(body: &BodyModel, posed: &PosedClip, settings: &ForceSettings<'_>) -> LinkForces {
    link_forces_at(link_places(body, posed), body, posed, settings)
}

/// [`link_forces`] of links whose `places`, of [`link_places`], are known.
pub fn link_forces_at(
    places: Lanes,
    body: &BodyModel,
    posed: &PosedClip,
    settings: &ForceSettings<'_>,
) -> LinkForces {
    let mut forces = settings.filter.accelerations(&places, posed.fps);
    for (index, link) in body.links.iter().enumerate() {
        let [x, y, z] = forces.vector_mut(index);
        for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
            (*x, *y, *z) = (*x * link.mass, (*y + GRAVITY) * link.mass, *z * link.mass);
        }
    }
    let mut free_moments = vec![DVec3::ZERO; posed.frame_count()];
    if settings.inertia {
        for link in &body.links {
            add_turning(&mut free_moments, link, posed);
        }
    }
    let mut result = LinkForces { places, forces, free_moments };
    for external in settings.external {
        result.give(external);
    }
    result
}

impl LinkForces {
    /// Takes what something else gives off what the ground must.
    fn give(&mut self, external: &ExternalForce) {
        let ExternalForce { frame, link, force, point } = *external;
        let arm = point - self.places.vector(link, frame);
        for (lane, component) in self.forces.vector_mut(link).into_iter().zip(force.to_array()) {
            lane[frame] -= component;
        }
        self.free_moments[frame] -= arm.cross(force);
    }
}

/// Adds the rate of a link's spin, `I dω/dt + ω × I ω` in the world, by differences of the spin between frames. Rotations are filtered
/// by the Gaussian of the places, whatever the filter of those.
fn add_turning(moments: &mut [DVec3], link: &Link, posed: &PosedClip) {
    let rotations: Vec<DQuat> =
        (0..posed.frame_count()).map(|frame| posed.at(frame, link.joint).rotation).collect();
    let smoothed = lee_shin(&rotations, &Kernel::gaussian(DERIVATIVE_WIDTH, posed.fps));
    let spins: Vec<DVec3> =
        smoothed.windows(2).map(|pair| spin(link.inertia, [pair[0], pair[1]], posed.fps)).collect();
    let Some(last) = spins.len().checked_sub(2) else { return };
    for (frame, moment) in moments.iter_mut().enumerate() {
        let before = frame.saturating_sub(1).min(last);
        *moment += (spins[before + 1] - spins[before]) * posed.fps;
    }
}

/// Angular momentum of a link about its centre between two frames: `R I Rᵀ ω` with R half way, kg m²/s.
fn spin(inertia: DMat3, [from, to]: [DQuat; 2], fps: f64) -> DVec3 {
    let turn = log(to * from.inverse());
    let half = exp(0.5 * turn) * from;
    half * (inertia * (half.inverse() * (turn * fps)))
}

/// What the ground must give in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction {
    /// World, newtons.
    pub force: DVec3,
    /// Moment about the origin, N m.
    pub moment: DVec3,
}

impl Reaction {
    /// The zero moment point on the plane `y = height`, `(x, z)` in metres; `None` without vertical force.
    pub fn zero_moment_point(&self, height: f64) -> Option<DVec2> {
        if self.force.y == 0.0 {
            return None;
        }
        let about = self.moment - (DVec3::Y * height).cross(self.force);
        Some(DVec2::new(about.z, -about.x) / self.force.y)
    }
}

/// Force and moment of the ground in every frame. Cost: linear in frames times links.
pub fn reactions(forces: &LinkForces) -> Vec<Reaction> {
    let mut reactions: Vec<Reaction> =
        forces.free_moments.iter().map(|moment| Reaction { force: DVec3::ZERO, moment: *moment }).collect();
    for link in 0..forces.places.lane_count() / 3 {
        let places = forces.places.vector_lanes(link);
        let pushes = forces.forces.vector_lanes(link);
        for (frame, reaction) in reactions.iter_mut().enumerate() {
            let force = DVec3::from_array(pushes.map(|lane| lane[frame]));
            reaction.force += force;
            reaction.moment += DVec3::from_array(places.map(|lane| lane[frame])).cross(force);
        }
    }
    reactions
}

/// Share of the weight that the ground bears at which a zero moment point begins to count, and over which more it grows to count in
/// full.
const LEAST_LOAD: f64 = 0.3;
/// Nearer to the ends of a clip than this there is none, seconds: filters have no data there.
pub const CLIP_END: f64 = 0.17;

/// How far the zero moment point of one frame counts, 0 to 1. `load`: vertical force over weight.
pub fn confidence_of(load: f64) -> f64 {
    smoothstep((load - LEAST_LOAD) / LEAST_LOAD)
}

/// The zero moment point of one frame and its polygon.
#[derive(Clone, Debug, PartialEq)]
pub struct Balance {
    /// `(x, z)` on the plane of the polygon, metres.
    pub zmp: DVec2,
    /// Height of that plane, metres.
    pub height: f64,
    /// Of [`crate::physics::support::hull`]; at least one.
    pub corners: Vec<DVec2>,
    /// From the point to the polygon, metres; 0 inside.
    pub distance: f64,
    /// 0 to 1: small near flight, where the point diverges.
    pub confidence: f64,
}

/// Zero moment points and polygons of all frames; `None` in flight, where nothing supports, where the ground bears less than 0.3 of the
/// weight, and within 0.17 s of the ends. Cost: linear in frames times contacts.
pub fn balances(
    body: &BodyModel,
    posed: &PosedClip,
    stages: &Stages,
    forces: &LinkForces,
) -> Vec<Option<Balance>> {
    let weight = body.mass * GRAVITY;
    let reactions = reactions(forces);
    let last = posed.frame_count().saturating_sub(1);
    let balance = |(frame, reaction): (usize, &Reaction)| {
        let confidence = confidence_of(reaction.force.y / weight);
        let to_end = frame.min(last - frame) as f64 / posed.fps;
        if stages.phases[frame] != Phase::Ground || confidence <= 0.0 || to_end < CLIP_END {
            return None;
        }
        let polygon = stages.polygon(posed, frame, reaction.force);
        let zmp = reaction.zero_moment_point(polygon.height)?;
        let distance = nearest(&polygon.corners, zmp)?.distance;
        Some(Balance { zmp, height: polygon.height, corners: polygon.corners, distance, confidence })
    };
    reactions.iter().enumerate().map(balance).collect()
}

/// Frames that stand on the ground while nothing bears them (the vertical force is negative): their labels are probably wrong.
pub fn frames_pulled_down(stages: &Stages, reactions: &[Reaction]) -> Vec<usize> {
    let is_pulled = |frame: &usize| stages.phases[*frame] == Phase::Ground && reactions[*frame].force.y < 0.0;
    (0..reactions.len()).filter(is_pulled).collect()
}

/// How far zero moment points are from their polygons.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DistanceSummary {
    /// Mean, metres.
    pub mean: f64,
    /// Largest, metres.
    pub largest: f64,
    /// Share of the frames that are outside.
    pub outside: f64,
    /// Frames counted: those whose confidence is above 1/2.
    pub frames: usize,
}

/// Sums up the frames whose confidence is above 1/2; `None` if there is none.
pub fn distance_summary(balances: &[Option<Balance>]) -> Option<DistanceSummary> {
    let counted: Vec<f64> =
        balances.iter().flatten().filter(|own| own.confidence > 0.5).map(|own| own.distance).collect();
    let frames = counted.len();
    let share = |sum: f64| sum / frames as f64;
    (frames > 0).then(|| DistanceSummary {
        mean: share(counted.iter().sum()),
        largest: counted.iter().copied().fold(0.0, f64::max),
        outside: share(counted.iter().filter(|distance| **distance > 0.0).count() as f64),
        frames,
    })
}
