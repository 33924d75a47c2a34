//! How far links must turn for a zero moment point to come where it is wanted.
//!
//! Links that turn about a pivot have arms from it to their centres of mass; links that are carried have all the arm of the joint
//! that carries them. With accelerations frozen at their world values the zero moment point depends on the arms by
//! `B = Σ arm ⊗ F` alone. In axes `x'` (where the point is to go), `y'` up, `z' = x' × y'`, with `s = Σ F_y`:
//!
//! ```text
//!     a1 = (B_xy − B_yx)/s     a2 = (B_yy + B_xx)/s     a3 = Z_x' − a1
//!     a4 = −B_yz/s             a5 = −B_xz/s             a6 = Z_z' − a4
//!
//!     Z_x'(t) = a1 cos t − a2 sin t + a3       Z_z'(t) = a4 cos t + a5 sin t + a6
//! ```
//!
//! Source: Shin, Kovar, Gleicher 2003, §5.1 and appendix. The printed appendix gives a2, a4 and a5 the wrong sign, leaves the carried
//! links out of them, and has another force in a6; these follow from its equations 6 and 7.

use glam::{DMat3, DQuat, DVec2, DVec3};

use crate::geometry::{exp, wrap};

/// Forces of one frame, and the arms of the links that move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loads {
    /// Sum of the forces on all links, newtons.
    pub force: DVec3,
    /// Their moment about the origin, free moments included, N m.
    pub moment: DVec3,
    /// `Σ arm F_x`, `Σ arm F_y`, `Σ arm F_z` over the links that turn or are carried, N m.
    pub arms: DMat3,
}

/// Shifts of the point below this are none, metres.
pub const NO_SHIFT: f64 = 1e-6;

/// Square of the arm below which turning hardly moves the point, m².
const NO_LEVER: f64 = 1e-8;

/// By how much links turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Radians about `z'`.
    pub angle: f64,
    /// The other angle that brings the point as far, radians.
    pub other: f64,
    /// Whether the point gets there; otherwise the angle takes it as far as it goes.
    pub reaches: bool,
}

impl Loads {
    /// The zero moment point on the plane `y = height`, `(x, z)` in metres.
    pub fn zmp(&self, height: f64) -> DVec2 {
        self.on_plane(self.moment, height)
    }

    /// The same with the moving links turned by `rotation`.
    pub fn zmp_turned(&self, rotation: DQuat, height: f64) -> DVec2 {
        let turned = DMat3::from_quat(rotation) * self.arms;
        self.on_plane(self.moment + moment_of(&turned) - moment_of(&self.arms), height)
    }

    fn on_plane(&self, moment: DVec3, height: f64) -> DVec2 {
        let about = moment - (DVec3::Y * height).cross(self.force);
        DVec2::new(about.z, -about.x) / self.force.y
    }

    /// a1 to a6 for turns about the axis across the direction `ahead` (unit, plan), metres.
    pub fn coefficients(&self, height: f64, ahead: DVec2) -> [f64; 6] {
        let x = DVec3::new(ahead.x, 0.0, ahead.y);
        let z = axis_across(ahead);
        let along = |force: DVec3| self.arms * force;
        let (by_x, by_y, by_z) = (along(x), along(DVec3::Y), along(z));
        let share = 1.0 / self.force.y;
        let zmp = self.zmp(height);
        let a1 = (by_y.dot(x) - by_x.y) * share;
        let a2 = (by_y.y + by_x.dot(x)) * share;
        let a4 = -by_z.y * share;
        let a5 = -by_z.dot(x) * share;
        [a1, a2, zmp.dot(ahead) - a1, a4, a5, zmp.dot(DVec2::new(z.x, z.z)) - a4]
    }

    /// The smaller turn about the axis across `shift` (plan, metres) that moves the point by it; `None` where turning hardly moves
    /// the point.
    pub fn turn_for(&self, height: f64, shift: DVec2) -> Option<Turn> {
        let ahead = shift.normalize();
        let [a1, a2, a3, ..] = self.coefficients(height, ahead);
        let lever_sq = a1 * a1 + a2 * a2;
        if lever_sq < NO_LEVER {
            return None;
        }
        let wanted = (self.zmp(height) + shift).dot(ahead) - a3;
        let rest = lever_sq - wanted * wanted;
        let (root, now) = (rest.max(0.0).sqrt(), a2.atan2(a1));
        let [a, b] = [root, -root].map(|root| wrap(root.atan2(wanted) - now));
        let (angle, other) = if a.abs() <= b.abs() { (a, b) } else { (b, a) };
        Some(Turn { angle, other, reaches: rest >= 0.0 })
    }

    /// The level rotation vector near `start` that brings the point to `target` along both axes, by Newton's method; `None` where it does
    /// not converge.
    ///
    /// From the turn about one axis two iterations suffice for 1e-9 m. Beyond the paper, which leaves the drift across.
    pub fn turn_about_both(&self, height: f64, target: DVec2, start: DVec3) -> Option<DVec3> {
        let missing = |w: DVec2| self.zmp_turned(exp(DVec3::new(w.x, 0.0, w.y)), height) - target;
        let mut w = DVec2::new(start.x, start.z);
        for _ in 0..NEWTON_STEPS {
            let off = missing(w);
            if off.length() < NEWTON_TOLERANCE {
                return Some(DVec3::new(w.x, 0.0, w.y));
            }
            let slope = |axis: DVec2| {
                (missing(w + DIFFERENCE * axis) - missing(w - DIFFERENCE * axis)) / (2.0 * DIFFERENCE)
            };
            let (by_x, by_z) = (slope(DVec2::X), slope(DVec2::Y));
            let determinant = by_x.perp_dot(by_z);
            if determinant.abs() < NO_LEVER {
                return None;
            }
            w -= DVec2::new(off.perp_dot(by_z), by_x.perp_dot(off)) / determinant;
        }
        (missing(w).length() < NEWTON_TOLERANCE).then_some(DVec3::new(w.x, 0.0, w.y))
    }
}

/// Newton's method gives up after so many steps.
const NEWTON_STEPS: usize = 8;
/// Points nearer than this are where they are to be, metres.
const NEWTON_TOLERANCE: f64 = 1e-11;
/// Radians for slopes: central differences err by the square of it.
const DIFFERENCE: f64 = 1e-5;

/// `z' = x' × up`, unit: turns about it move things towards `ahead` below the pivot.
pub fn axis_across(ahead: DVec2) -> DVec3 {
    DVec3::new(-ahead.y, 0.0, ahead.x)
}

/// `Σ arm × F` of `Σ arm ⊗ F`.
fn moment_of(arms: &DMat3) -> DVec3 {
    let [x, y, z] = [arms.x_axis, arms.y_axis, arms.z_axis];
    DVec3::new(z.y - y.z, x.z - z.x, y.x - x.y)
}
