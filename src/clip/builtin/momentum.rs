//! Angular momentum and inertia of a body about the lateral axis through its centre of mass, per kilogram of the body.

use glam::{DQuat, DVec3};

use super::body::{ARMS, Body, CHEST, HEAD, LEGS, PELVIS, SPINE};
use super::mass::{Segment, segments};
use crate::geometry::log;
use crate::skeleton::{JointFrame, Pose};

/// Radii of gyration about the segments' centres of mass, metres at 1.75 m: Winter's fractions of the lengths; of the trunk's
/// segments those of boxes as long and 0.2 m deep.
///
/// Source: Winter, *Biomechanics and Motor Control of Human Movement*, 4th ed., table 4.1.
const TRUNK: [(usize, f64); 4] = [(PELVIS, 0.063), (SPINE, 0.072), (CHEST, 0.104), (HEAD, 0.495 * 0.27)];
/// Upper arm, forearm, hand.
const ARM: [f64; 3] = [0.322 * 0.28, 0.303 * 0.25, 0.297 * 0.085];
/// Thigh, shank, foot.
const LEG: [f64; 3] = [0.323 * 0.42, 0.302 * 0.40, 0.475 * 0.143];

/// Where the segments of a pose are.
#[derive(Clone, Debug)]
pub(super) struct Segments {
    /// Share of the mass, square of the radius of gyration (m²), centre of mass from the body's (m), rotation.
    parts: Vec<(f64, f64, DVec3, DQuat)>,
}

impl Segments {
    pub(super) fn of(body: &Body, pose: &Pose) -> Self {
        let frames = body.skeleton.forward_kinematics(pose);
        let mut parts: Vec<_> = segments()
            .map(|Segment { joint, mass, center }| {
                let JointFrame { position, rotation } = frames[joint];
                (mass, gyration_sq(body, joint), position + rotation * (center * body.scale), rotation)
            })
            .collect();
        let center: DVec3 = parts.iter().map(|(mass, _, place, _)| *mass * *place).sum();
        for (_, _, place, _) in &mut parts {
            *place -= center;
        }
        Self { parts }
    }

    /// Moment of inertia about the lateral (+x) axis, m².
    pub(super) fn inertia(&self) -> f64 {
        let own = self.parts.iter();
        own.map(|(mass, gyration_sq, arm, _)| mass * (arm.y * arm.y + arm.z * arm.z + gyration_sq)).sum()
    }

    /// Angular momentum about the lateral (+x) axis on the way from here to `to`, m²/s times the time between them: exact to
    /// the second order in it.
    pub(super) fn angular_step(&self, to: &Self) -> f64 {
        let steps =
            self.parts.iter().zip(&to.parts).map(|((mass, gyration_sq, before, from), (_, _, after, to))| {
                let swept = (0.5 * (*before + *after)).cross(*after - *before).x;
                mass * (swept + gyration_sq * log(*to * from.inverse()).x)
            });
        steps.sum()
    }
}

fn gyration_sq(body: &Body, joint: usize) -> f64 {
    let trunk = TRUNK.iter().find(|(of, _)| *of == joint).map(|(_, radius)| *radius);
    let limb = |first: usize, radii: [f64; 3]| joint.checked_sub(first).and_then(|k| radii.get(k).copied());
    let arms = ARMS.iter().find_map(|collar| limb(collar + 1, ARM));
    let legs = LEGS.iter().find_map(|hip| limb(*hip, LEG));
    let radius = trunk.or(arms).or(legs).unwrap_or(0.0);
    (radius * body.scale).powi(2)
}
