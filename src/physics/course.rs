//! What a touch-up changes, frame by frame: distances of the zero moment point, angular momentum, height of the centre of mass.

use glam::{DQuat, DVec3};

use crate::clip::Clip;
use crate::physics::body_model::BodyModel;
use crate::physics::derivatives::Lanes;
use crate::physics::derivatives::Filter;
use crate::physics::flight::momentum::pairs;
use crate::physics::ground::target::FILTERS;
use crate::physics::posed::{PosedClip, centers_of_mass, link_places};
use crate::physics::stages::Stages;
use crate::physics::zmp::{ForceSettings, balances, link_forces};

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
}

/// Measures of `clip`, which `stages` has the frames of. Cost: linear in frames times links.
pub fn course(clip: &Clip, body: &BodyModel, stages: &Stages) -> Course {
    let posed = PosedClip::of(clip);
    let distances = FILTERS.map(|filter| {
        let forces = link_forces(body, &posed, &ForceSettings { filter, ..ForceSettings::default() });
        let counted = balances(body, &posed, stages, &forces).into_iter();
        counted.map(|own| own.filter(|own| own.confidence > 0.5).map(|own| own.distance)).collect()
    });
    let centers = centers_of_mass(body, &link_places(body, &posed));
    Course {
        distances,
        momentum: momentum(body, &posed),
        heights: centers.iter().map(|center| center.y).collect(),
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
