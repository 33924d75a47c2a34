//! Masses of the segments of generated clips' body: centre of mass, and poses that put it where it must be.
//!
//! Source: Dempster's fractions in Winter, *Biomechanics and Motor Control of Human Movement*, 4th ed., table 4.1; the trunk in
//! three segments.

use glam::DVec3;

use super::body::{Body, CHEST, HEAD, PELVIS, SPINE, Side, TOE_OFFSET, arm_joints, leg_joints};
use super::limbs::LegTarget;
use crate::skeleton::Pose;

/// Gravity, m/s² along +y.
pub(super) const GRAVITY: f64 = -9.81;

/// A segment of one mass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// Joint that turns it.
    pub(super) joint: usize,
    /// Share of the whole body's.
    pub(super) mass: f64,
    /// Centre of mass in the joint's axes, metres at 1.75 m.
    pub(super) center: DVec3,
}

/// Head and trunk; centres from below: 0.5 of the pelvis, 0.56 of the abdomen, 0.5 of the thorax, the ear of the head.
const TRUNK: [Segment; 4] = [
    Segment { joint: PELVIS, mass: 0.142, center: DVec3::new(0.0, 0.025, -0.005) },
    Segment { joint: SPINE, mass: 0.139, center: DVec3::new(0.0, 0.084, -0.003) },
    Segment { joint: CHEST, mass: 0.216, center: DVec3::new(0.0, 0.15, 0.0) },
    Segment { joint: HEAD, mass: 0.081, center: DVec3::new(0.0, 0.08, 0.0) },
];

/// Upper arm, forearm and hand: mass, and centre as a distance along the arm, metres at 1.75 m.
const ARM: [(f64, f64); 3] = [(0.028, 0.436 * 0.28), (0.016, 0.430 * 0.25), (0.006, 0.506 * 0.085)];

/// Thigh, shank and foot: mass, and centre in the joint's axes, metres at 1.75 m.
const LEG: [(f64, DVec3); 3] = [
    (0.100, DVec3::new(0.0, -0.433 * 0.42, 0.0)),
    (0.0465, DVec3::new(0.0, -0.433 * 0.40, 0.0)),
    (0.0145, DVec3::new(0.5 * TOE_OFFSET.x, 0.5 * TOE_OFFSET.y, 0.5 * TOE_OFFSET.z)),
];

pub(super) fn segments() -> impl Iterator<Item = Segment> {
    let limbs = Side::BOTH.into_iter().flat_map(|side| {
        let ([_, arm @ ..], [hip, knee, ankle, _]) = (arm_joints(side), leg_joints(side));
        let arms = arm.into_iter().zip(ARM).map(move |(joint, (mass, along))| Segment {
            joint,
            mass,
            center: DVec3::X * (side.sign() * along),
        });
        arms.chain([hip, knee, ankle].into_iter().zip(LEG).map(|(joint, (mass, center))| Segment {
            joint,
            mass,
            center,
        }))
    });
    TRUNK.into_iter().chain(limbs)
}

/// Centre of mass of a pose in the world, metres.
pub(super) fn center_of_mass(body: &Body, pose: &Pose) -> DVec3 {
    let frames = body.skeleton.forward_kinematics(pose);
    segments()
        .map(|segment| {
            let frame = frames[segment.joint];
            segment.mass * (frame.position + frame.rotation * (segment.center * body.scale))
        })
        .sum()
}

/// Moves the pelvis until the centre of mass is at `center` while both feet stay at their targets (planted or not).
/// Returns how far the more stretched leg is stretched; where that is over 1 the feet are not reached.
///
/// Fixed point: a shift of the root by d shifts the centre of mass by 0.8 d to 0.95 d, as the legs bend.
pub(super) fn balance(body: &Body, pose: &mut Pose, feet: [LegTarget; 2], center: DVec3) -> f64 {
    /// Distance left, metres; rounding of the sums is 1e-16.
    const CLOSE: f64 = 1e-13;
    const ITERATIONS: usize = 40;
    /// Shift of the root over what the centre of mass lacks: each iteration leaves a tenth or less.
    const RELAXATION: f64 = 1.14;
    let mut longest = place_feet(body, pose, feet);
    for _ in 0..ITERATIONS {
        let missing = center - center_of_mass(body, pose);
        if missing.length() < CLOSE {
            break;
        }
        pose.root += RELAXATION * missing;
        longest = place_feet(body, pose, feet);
    }
    longest
}

fn place_feet(body: &Body, pose: &mut Pose, feet: [LegTarget; 2]) -> f64 {
    let stretched = Side::BOTH.map(|side| body.place_leg(pose, side, feet[side.index()]));
    stretched[0].max(stretched[1])
}

/// Where something flies `time` seconds after it was at `from` (metres) with `velocity` (m/s).
pub(super) fn ballistic(from: DVec3, velocity: DVec3, time: f64) -> DVec3 {
    from + velocity * time + DVec3::Y * (0.5 * GRAVITY * time * time)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_the_whole_body() {
        let total: f64 = segments().map(|segment| segment.mass).sum();
        assert!((total - 1.0).abs() < 1e-12, "{total}");
    }

    #[test]
    fn the_centre_of_mass_of_a_standing_body_is_at_the_pelvis() {
        let body = Body::new(1.75);
        let mut pose = body.skeleton.rest_pose();
        for side in Side::BOTH {
            body.hang_arm(&mut pose, side, 0.0, 0.0);
        }
        // 0.56 of the stature: Winter, section 4.1.
        let center = center_of_mass(&body, &pose);
        assert!((center.y / 1.75 - 0.56).abs() < 0.02, "{center}");
        assert!(center.x.abs() < 1e-12 && center.z.abs() < 0.02);
    }

    #[test]
    fn a_balanced_body_has_its_centre_and_its_feet_where_they_should_be() {
        let body = Body::new(1.6);
        let mut pose = body.skeleton.rest_pose();
        let foot = |side: Side| LegTarget {
            ankle: DVec3::new(0.1 * side.sign(), 0.3 + 0.1 * side.sign(), 0.1),
            foot: glam::DQuat::from_rotation_x(0.3),
            knee: DVec3::Z,
            toe: 0.0,
        };
        let center = DVec3::new(0.03, 0.99, 0.05);
        let stretched = balance(&body, &mut pose, Side::BOTH.map(foot), center);
        assert!(stretched < 1.0);
        assert!(center_of_mass(&body, &pose).distance(center) < 1e-12);
        let frames = body.skeleton.forward_kinematics(&pose);
        for side in Side::BOTH {
            let ankle = leg_joints(side)[2];
            assert!(frames[ankle].position.distance(foot(side).ankle) < 1e-12);
            assert!(frames[ankle].rotation.angle_between(foot(side).foot) < 1e-6);
        }
    }
}
