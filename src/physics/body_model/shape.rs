//! Inertia of cylinders and boxes of constant density.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

/// A link's shape, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Round about its length; its radius follows from mass and density.
    Cylinder {
        /// Along the bone.
        length: f64,
    },
    /// Sides along the body's lateral axis, along the bone, and across both.
    Box {
        /// Left to right.
        lateral: f64,
        /// Along the bone.
        along: f64,
        /// The third side.
        depth: f64,
    },
}

/// Radius of a cylinder of `mass` (kg), `density` (kg/m³) and `length` (m), metres: `√(m/(ρ π L))`.
pub fn radius_of_cylinder(mass: f64, density: f64, length: f64) -> f64 {
    (mass / (density * PI * length)).sqrt()
}

/// Third side of a box of `mass` (kg) and `density` (kg/m³) with two `sides` (m), metres.
pub fn depth_of_box(mass: f64, density: f64, sides: (f64, f64)) -> f64 {
    mass / (density * sides.0 * sides.1)
}

/// Principal moments about the centre of mass, kg m²: about the lateral axis, about the bone, about the third one.
///
/// A cylinder has `m r²/2` about its bone and `m (3r² + L²)/12` across; a box `m/12` times the squares of the other two sides.
/// `density`: kg/m³; only a cylinder needs it.
pub fn principal_moments(shape: Shape, mass: f64, density: f64) -> DVec3 {
    match shape {
        Shape::Cylinder { length } => {
            let radius_sq = radius_of_cylinder(mass, density, length).powi(2);
            let across = mass * (3.0 * radius_sq + length * length) / 12.0;
            DVec3::new(across, 0.5 * mass * radius_sq, across)
        }
        Shape::Box { lateral, along, depth } => {
            let [x, y, z] = [lateral * lateral, along * along, depth * depth];
            DVec3::new(y + z, x + z, x + y) * (mass / 12.0)
        }
    }
}

/// The same shape grown alike in all directions until its volume is `factor` times as large; cylinders keep their length, as
/// their radius follows from the mass.
pub fn grown(shape: Shape, factor: f64) -> Shape {
    match shape {
        Shape::Cylinder { .. } => shape,
        Shape::Box { lateral, along, depth } => {
            let scale = factor.cbrt();
            Shape::Box { lateral: lateral * scale, along: along * scale, depth: depth * scale }
        }
    }
}

/// Inertia tensor in joint axes of principal `moments` (as of [`principal_moments`]) about a bone in direction `bone` (unit) with
/// the lateral axis as near to `lateral` as it can be; where the bone itself is lateral, `across` takes its place.
pub fn inertia_tensor(moments: DVec3, bone: DVec3, [lateral, across]: [DVec3; 2]) -> DMat3 {
    let rest = |axis: DVec3| axis - axis.dot(bone) * bone;
    let side = if rest(lateral).length() > 0.5 { rest(lateral) } else { rest(across) };
    let side = side.try_normalize().unwrap_or_else(|| bone.any_orthonormal_vector());
    let axes = DMat3::from_cols(side, bone, side.cross(bone));
    axes * DMat3::from_diagonal(moments) * axes.transpose()
}
