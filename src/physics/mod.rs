//! What physics says about a motion: masses, forces, where the ground must push, when nothing does.
//!
//! [`body_model`] gives every skeleton links with masses; [`posed`] has their places along time; [`derivatives`] filters and
//! differentiates them; [`support`] has polygons; [`sole`] finds the soles of the feet in a clip; [`stages`] tells ground from
//! flight; [`zmp`] has the zero moment point and its distance to the polygon; [`masses`] fits masses to motion that is known to
//! be physical; [`input`] is what both passes need; [`ground`] turns bodies so that the ground can bear them; [`flight`] makes flights fall as bodies do; [`touch_up`] is all
//! of the touch-up; [`blended_source`] knows where zero moment points of blends were; [`course`] has what it changes, frame by frame.
//!
//! Plan points here are `(x, z)` of the world (a mirrored plan: counter-clockwise here is clockwise seen from above).
//!
//! Source: Shin, Kovar, Gleicher, *Physical Touch-Up of Human Motions*, Pacific Graphics 2003; where we depart from it the
//! module's docs say so and why.

pub mod body_model;
pub mod derivatives;
pub mod posed;
pub mod support;
pub mod sole;
pub mod ballistics;
pub mod stages;
pub mod zmp;
pub mod masses;
pub mod input;
pub mod ground;
pub mod flight;
pub mod touch_up;
pub mod blended_source;
pub mod course;

use glam::{DVec2, DVec3};

/// Gravity, m/s² along −y.
pub const GRAVITY: f64 = 9.81;

/// Below the world point `point`: its `(x, z)`, metres.
pub fn on_plan(point: DVec3) -> DVec2 {
    DVec2::new(point.x, point.z)
}
