//! What a touch-up changes, frame by frame: distances of the zero moment point, angular momentum, height of the centre of mass.

use glam::{DQuat, DVec3};

use crate::clip::Clip;
use crate::physics::body_model::BodyModel;
use crate::physics::derivatives::{Filter, Lanes};
use crate::physics::flight::momentum::pairs;
use crate::physics::ground::target::FILTERS;
use crate::physics::posed::{PosedClip, centers_of_mass, link_places};
use crate::physics::stages::Stages;
use crate::physics::zmp::{
    Balance, DistanceSummary, ForceSettings, balances, distance_summary, frames_pulled_down, link_forces,
    reactions,
};

/// Measures of a motion, each one a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// From the zero moment point to the polygon of support, metres, by the filter that is optimised and by the judge; `None` where
    /// there is none or its confidence is 1/2 or less.
    pub distances: [Vec<Option<f64>>; 2],
    /// Angular momentum about the centre of mass, filtered as what is optimised, kg m²/s.
    pub momentum: Vec<f64>,
    /// Height of the centre of mass, unfiltered, metres.
    pub heights: Vec<f64>,
    /// Of `distances`; `None` where nothing bears.
    pub summaries: [Option<DistanceSummary>; 2],
    /// Frames that stand on the ground while nothing bears them.
    pub pulled_down: Vec<usize>,
}

/// Measures of `clip`, which `stages` has the frames of. Cost: linear in frames times links.
pub fn course(clip: &Clip, body: &BodyModel, stages: &Stages) -> Course {
    let posed = PosedClip::of(clip);
    let forces = FILTERS
        .map(|filter| link_forces(body, &posed, &ForceSettings { filter, ..ForceSettings::default() }));
    let balances = forces.each_ref().map(|forces| balances(body, &posed, stages, forces));
    let counted =
        |own: &Option<Balance>| own.as_ref().filter(|own| own.confidence > 0.5).map(|own| own.distance);
    let centers = centers_of_mass(body, &link_places(body, &posed));
    Course {
        distances: balances.each_ref().map(|own| own.iter().map(counted).collect()),
        momentum: momentum(body, &posed),
        heights: centers.iter().map(|center| center.y).collect(),
        summaries: balances.each_ref().map(|own| distance_summary(own)),
        pulled_down: frames_pulled_down(stages, &reactions(&forces[0])),
    }
}

/// Size of the filtered momentum; that between a frame and the next stands at the frame, the last at the last two.
fn momentum(body: &BodyModel, posed: &PosedClip) -> Vec<f64> {
    let last = posed.frame_count().saturating_sub(1);
    let mut between: Vec<DVec3> = pairs(body, posed, (0, last), None)
        .iter()
        .map(|pair| pair.momentum([DQuat::IDENTITY; 2]).value)
        .collect();
    between.push(between.last().copied().unwrap_or(DVec3::ZERO));
    let filtered = Filter::Gaussian.apply(&Lanes::of_vectors(&between), posed.fps);
    filtered.vectors(0).iter().map(|momentum| momentum.length()).collect()
}
