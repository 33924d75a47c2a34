//! What frames on the ground say about masses.

use glam::DVec2;
use nalgebra::DMatrix;

use super::{MassError, places, qp};
use crate::index::floor_index;
use crate::physics::GRAVITY;
use crate::physics::body_model::{BodyModel, Segment};
use crate::physics::posed::PosedClip;
use crate::physics::stages::Stages;
use crate::physics::support::nearest;
use crate::physics::zmp::{ForceSettings, LinkForces, balances, link_forces};

/// A clip on which masses are fitted: poses, and when they stand on what.
pub type Standing<'a> = (&'a PosedClip, &'a Stages);

/// What one frame says: the zero moment point is `Σ x (X, Z) / Σ x V` over the groups with factors x.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundFrame {
    /// Of each group with the table's masses: `X = Σ F_y x − F_x (y − h)`, `Z = Σ F_y z − F_z (y − h)`, `V = Σ F_y`, in newton metres and
    /// newtons.
    pub groups: Vec<[f64; 3]>,
    /// Polygon of support, of [`crate::physics::support::hull`]; at least one corner.
    pub corners: Vec<DVec2>,
}

impl GroundFrame {
    /// The zero moment point, `(x, z)`, metres.
    pub fn zmp(&self, factors: &[f64]) -> DVec2 {
        let [x, z, force] = self.groups.iter().zip(factors).fold([0.0; 3], |sum, (own, factor)| {
            [sum[0] + factor * own[0], sum[1] + factor * own[1], sum[2] + factor * own[2]]
        });
        DVec2::new(x, z) / force
    }

    /// The point of the polygon nearest to the zero moment point, and their distance, metres.
    pub(super) fn target(&self, factors: &[f64]) -> (DVec2, f64) {
        let zmp = self.zmp(factors);
        nearest(&self.corners, zmp).map_or((zmp, 0.0), |found| (found.point, found.distance))
    }
}

/// Frames, and what groups weigh before.
#[derive(Clone, Debug, PartialEq)]
pub struct MassProblem {
    /// All with as many groups as `masses`.
    pub frames: Vec<GroundFrame>,
    /// Table's mass of each group, kg; the fitted ones have the same sum.
    pub masses: Vec<f64>,
    /// Segments that a group ties, left and right.
    pub counts: Vec<f64>,
}

impl MassProblem {
    /// Frames of `clips` at least `spacing` seconds apart in which the zero moment point counts in full.
    pub fn of(body: &BodyModel, segments: &[Segment], clips: &[Standing<'_>], spacing: f64) -> Self {
        let places = places(body, segments);
        let mut masses = vec![0.0; segments.len()];
        for (link, place) in body.links.iter().zip(&places) {
            masses[*place] += link.mass;
        }
        let mut frames = Vec::new();
        for (posed, stages) in clips {
            let forces = link_forces(body, posed, &ForceSettings::default());
            let stride = floor_index((spacing * posed.fps).round()).max(1);
            let all = balances(body, posed, stages, &forces).into_iter().enumerate().step_by(stride);
            for (frame, balance) in all.filter_map(|(frame, balance)| Some((frame, balance?))) {
                if balance.confidence >= 1.0 {
                    let groups = group_sums(&forces, &places, segments.len(), (frame, balance.height));
                    frames.push(GroundFrame { groups, corners: balance.corners });
                }
            }
        }
        let counts = segments.iter().map(|segment| segment.count() as f64).collect();
        Self { frames, masses, counts }
    }

    /// Factors of least `Σ s² + pull Σ count (x − 1)²`: s is by how much a frame's zero moment point is beyond an edge of its polygon, in
    /// metres (of a body that bears its weight). No factor is below `least`.
    ///
    /// # Errors
    /// [`MassError::Unsolved`] if the program is not solved.
    pub fn solve(&self, pull: f64, least: f64) -> Result<Vec<f64>, MassError> {
        qp::solve(self, pull, least)
    }

    /// Mean distance of the zero moment points from their polygons, metres.
    pub fn mean_distance(&self, factors: &[f64]) -> f64 {
        let sum: f64 = self.frames.iter().map(|frame| frame.target(factors).1).sum();
        sum / self.frames.len().max(1) as f64
    }

    /// Mean squared distance of the zero moment points from their polygons, m².
    pub fn mean_square_distance(&self, factors: &[f64]) -> f64 {
        let sum: f64 = self.frames.iter().map(|frame| frame.target(factors).1.powi(2)).sum();
        sum / self.frames.len().max(1) as f64
    }

    /// Of the rows `(X − Z*_x V)/g`, `(Z − Z*_z V)/g` per kilogram of each group, `Z*` the point of the polygon nearest to the table's zero
    /// moment point; metres, falling. Cost: cubic in groups, linear in frames.
    pub fn singular_values(&self) -> Vec<f64> {
        let ones = vec![1.0; self.masses.len()];
        let targets: Vec<DVec2> = self.frames.iter().map(|frame| frame.target(&ones).0).collect();
        let entry = |row: usize, group: usize| {
            let [x, z, force] = self.frames[row / 2].groups[group];
            let target = targets[row / 2];
            let moment = if row.is_multiple_of(2) { x - target.x * force } else { z - target.y * force };
            moment / (GRAVITY * self.masses[group])
        };
        let rows = DMatrix::from_fn(2 * self.frames.len(), self.masses.len(), entry);
        // Squares of the values lose what is below 1e-8 of the largest, which says nothing anyway; R keeps it.
        let mut values: Vec<f64> = rows.qr().r().singular_values().iter().copied().collect();
        values.sort_by(|a, b| b.total_cmp(a));
        values
    }
}

fn group_sums(
    forces: &LinkForces,
    places: &[usize],
    count: usize,
    (frame, height): (usize, f64),
) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; count];
    for (link, place) in places.iter().enumerate() {
        let (at, force) = (forces.places.vector(link, frame), forces.forces.vector(link, frame));
        let sum = &mut sums[*place];
        sum[0] += force.y * at.x - force.x * (at.y - height);
        sum[1] += force.y * at.z - force.z * (at.y - height);
        sum[2] += force.y;
    }
    sums
}
