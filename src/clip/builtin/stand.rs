//! Standing and what is done on the spot: both feet planted, the pelvis swaying by a centimetre.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::body::{ANKLE_HEIGHT, Body, PELVIS_HEIGHT, Side, Trunk, arm_joints};
use super::limbs::{ArmTarget, Foot};
use crate::geometry::{slerp, smoothstep};
use crate::skeleton::Pose;

/// Ankles beside the middle, metres.
const HALF_STANCE: f64 = 0.10;
/// Turn of the toes outwards, radians.
const TOES_OUT: f64 = 0.12;
/// How much lower than with straight legs the pelvis is, metres.
const KNEES_SOFT: f64 = 0.005;
/// Lean of the trunk, radians, at the ends of a clip.
pub(super) const LEAN: f64 = 0.038;
/// Swing and bend of a hanging arm, radians, at the ends of a clip.
pub(super) const HANGING_ARM: (f64, f64) = (0.01, 0.22);
/// Seconds of a breath, rounded so that a clip holds whole ones.
const BREATH: f64 = 3.0;
/// Seconds of a sway, rounded likewise. Frames one sway apart look alike but for the breath, and are near enough in time that
/// what lies between can be shown twice: standing can be prolonged.
const SWAY: f64 = 1.5;

/// When the hand of a slap is highest behind, hits, and is down again, as shares of the clip.
const SLAP_RAISED: f64 = 0.30;
pub(super) const SLAP_HIT: f64 = 0.42;
const SLAP_DOWN: f64 = 0.85;
/// When it begins to rise.
const SLAP_START: f64 = 0.08;

/// Standing at share `s` of a clip of `seconds`, as the same at both ends.
pub(super) fn idle(body: &Body, seconds: f64, s: f64) -> Pose {
    let mut pose = upright(body, seconds, s, DVec3::ZERO, 0.0);
    plant(body, &mut pose);
    pose
}

/// A high five with the right hand at share `s` of a clip of `seconds`; stands as [`idle`] does at both ends.
pub(super) fn slap(body: &Body, seconds: f64, s: f64) -> Pose {
    let down = |turn| upright(body, seconds, s, DVec3::ZERO, turn);
    let mut raised = upright(body, seconds, s, DVec3::new(0.0, 0.0, -0.004) * body.scale, -0.10);
    let mut hit = upright(body, seconds, s, DVec3::new(0.003, 0.0, 0.012) * body.scale, 0.16);
    let behind = DVec3::new(-0.33, 1.52, 0.16) * body.scale;
    let at_partner = DVec3::new(-0.20, 1.41, 0.48) * body.scale;
    let outside = DVec3::new(-0.8, -0.6, -0.1);
    let below = DVec3::new(-0.45, -0.9, 0.0);
    let ahead = DVec3::new(0.0, -0.2, 1.0);
    let reach = |pose: &mut Pose, wrist: DVec3, elbow: DVec3, fingers: DVec3| {
        body.reach(pose, Side::Right, ArmTarget { wrist, elbow, fingers, palm: ahead });
    };
    reach(&mut raised, behind, outside, DVec3::new(-0.1, 1.0, -0.25));
    reach(&mut hit, at_partner, below, DVec3::new(0.0, 1.0, 0.25));
    let mut pose = if s < SLAP_RAISED {
        between(body, &down(0.0), &raised, smoothstep((s - SLAP_START) / (SLAP_RAISED - SLAP_START)))
    } else if s < SLAP_HIT {
        between(body, &raised, &hit, strike((s - SLAP_RAISED) / (SLAP_HIT - SLAP_RAISED)))
    } else {
        between(body, &hit, &down(0.0), smoothstep((s - SLAP_HIT) / (SLAP_DOWN - SLAP_HIT)))
    };
    plant(body, &mut pose);
    pose
}

/// Trunk and hanging arms, legs to come; `shift` of the pelvis in metres, `chest_turn` in radians.
fn upright(body: &Body, seconds: f64, s: f64, shift: DVec3, chest_turn: f64) -> Pose {
    let whole = |period: f64| (seconds / period).round().max(1.0);
    let sway = (TAU * whole(SWAY) * s).sin();
    let breath = (TAU * whole(BREATH) * s).cos();
    let place = DVec3::new(0.010 * sway, 0.0, 0.003 * (1.0 - breath));
    let trunk = Trunk {
        pelvis_turn: 0.012 * sway,
        pelvis_list: 0.012 * sway,
        chest_turn,
        lean: LEAN - 0.008 * (1.0 - breath),
        ..Trunk::default()
    };
    let pelvis = DVec3::Y * pelvis_height(body) + place * body.scale + shift;
    let mut pose = body.pose(pelvis, trunk);
    for side in Side::BOTH {
        lift_collar(&mut pose, side, breath);
        body.hang_arm(&mut pose, side, HANGING_ARM.0 * breath, HANGING_ARM.1);
    }
    pose
}

/// Raises a collar with a breath, from −1 to 1.
pub(super) fn lift_collar(pose: &mut Pose, side: Side, breath: f64) {
    let [collar, ..] = arm_joints(side);
    pose.rotations[collar] = DQuat::from_rotation_z(-side.sign() * 0.012 * breath);
}

/// Pelvis above the ground, metres.
pub(super) fn pelvis_height(body: &Body) -> f64 {
    (PELVIS_HEIGHT - KNEES_SOFT) * body.scale
}

/// Ankle (metres) and turn (radians) of a standing foot.
pub(super) fn planted(body: &Body, side: Side) -> (DVec3, f64) {
    let ankle = DVec3::new(side.sign() * HALF_STANCE, ANKLE_HEIGHT, 0.0) * body.scale;
    (ankle, side.sign() * TOES_OUT)
}

/// Puts both feet where they always stand.
fn plant(body: &Body, pose: &mut Pose) {
    for side in Side::BOTH {
        let (ankle, turn) = planted(body, side);
        body.place_foot(pose, side, Foot { ankle, turn, pitch: 0.0, toe: 0.0 });
    }
}

/// From rest to a hit at full speed.
fn strike(u: f64) -> f64 {
    u * u * (2.0 - u)
}

/// Share `s` of the way from one pose to another, joint by joint; the right hand turns steadily in the world.
fn between(body: &Body, from: &Pose, to: &Pose, s: f64) -> Pose {
    let mut pose = Pose {
        root: from.root.lerp(to.root, s),
        rotations: from.rotations.iter().zip(&to.rotations).map(|(a, b)| slerp(*a, *b, s)).collect(),
        offsets: Vec::new(),
    };
    straighten_right_elbow(&mut pose);
    let [_, _, elbow, hand] = arm_joints(Side::Right);
    let world = |pose: &Pose, joint: usize| body.skeleton.forward_kinematics(pose)[joint].rotation;
    let hand_world = slerp(world(from, hand), world(to, hand), s);
    pose.rotations[hand] = world(&pose, elbow).inverse() * hand_world;
    pose
}

/// Leaves the right elbow its bend and the forearm's twist only: what lies between two bent and twisted elbows would
/// bend a little sideways.
fn straighten_right_elbow(pose: &mut Pose) {
    let [_, _, elbow, _] = arm_joints(Side::Right);
    let rotation = pose.rotations[elbow];
    let bent = DQuat::from_rotation_y((rotation * DVec3::NEG_X).angle_between(DVec3::NEG_X));
    let rest = bent.inverse() * rotation;
    let twist = DQuat::from_rotation_x(2.0 * rest.x.atan2(rest.w));
    pose.rotations[elbow] = bent * twist;
}
