//! How far human joints move, and by how much a pose goes beyond.
//!
//! Source: American Academy of Orthopaedic Surgeons, *Joint Motion: Method of Measuring and Recording* (1965); Norkin & White,
//! *Measurement of Joint Motion*, 5th ed., appendix of normal values. Where loaded or actively sporting joints are known to
//! move farther than the clinic's passive figures, the row says so.

use glam::{DQuat, DVec3};

use super::body::{CHEST, HEAD, NECK, SPINE, Side, arm_joints, leg_joints};
use crate::skeleton::Pose;

/// Range of one angle, degrees.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limit {
    /// Joint and motion.
    pub(super) name: &'static str,
    range: (f64, f64),
    /// The angle, degrees, of one side; trunk and neck have the same on both.
    angle: fn(&Pose, Side) -> f64,
}

/// One row an angle; flexion, and motion to the outside, are positive.
pub(super) const LIMITS: &[Limit] = &[
    Limit { name: "hip flexion", range: (-30.0, 120.0), angle: |p, s| thigh(p, s).flexion },
    Limit { name: "hip abduction", range: (-30.0, 45.0), angle: |p, s| thigh(p, s).outwards },
    Limit { name: "hip rotation", range: (-45.0, 45.0), angle: |p, s| thigh(p, s).twist },
    // Active flexion with a bent hip reaches 150.
    Limit { name: "knee flexion", range: (0.0, 150.0), angle: |p, s| shank(p, s).flexion },
    Limit { name: "knee sideways", range: (-1.0, 1.0), angle: |p, s| shank(p, s).outwards },
    Limit { name: "knee rotation", range: (-10.0, 10.0), angle: |p, s| shank(p, s).twist },
    // 20 unloaded; 45 with the body's weight on a bent knee (lunge test).
    Limit { name: "ankle dorsiflexion", range: (-55.0, 45.0), angle: |p, s| foot(p, s).flexion },
    Limit { name: "ankle inversion", range: (-35.0, 35.0), angle: |p, s| foot(p, s).outwards },
    Limit { name: "ankle rotation", range: (-35.0, 35.0), angle: |p, s| foot(p, s).twist },
    // 70 unloaded, 90 under the heel of one who pushes off.
    Limit {
        name: "toe extension",
        range: (-40.0, 80.0),
        angle: |p, s| -about_x(p.rotations[leg_joints(s)[3]]),
    },
    Limit { name: "upper arm backwards", range: (-180.0, 60.0), angle: |p, s| upper_arm(p, s).backwards },
    Limit { name: "upper arm across", range: (-180.0, 50.0), angle: |p, s| upper_arm(p, s).across },
    Limit { name: "upper arm rotation", range: (-90.0, 90.0), angle: |p, s| upper_arm(p, s).twist },
    Limit { name: "elbow flexion", range: (0.0, 150.0), angle: |p, s| elbow_and_forearm(p, s).0 },
    Limit { name: "forearm rotation", range: (-90.0, 90.0), angle: |p, s| elbow_and_forearm(p, s).1 },
    Limit { name: "wrist flexion", range: (-75.0, 80.0), angle: |p, s| wrist(p, s).0 },
    Limit { name: "wrist to the thumb", range: (-35.0, 25.0), angle: |p, s| wrist(p, s).1 },
    // The collar's share of raising an arm.
    Limit { name: "collar", range: (0.0, 35.0), angle: |p, s| whole(p.rotations[arm_joints(s)[0]]) },
    Limit { name: "trunk flexion", range: (-30.0, 85.0), angle: |p, _| trunk(p).flexion },
    Limit { name: "trunk sideways", range: (-35.0, 35.0), angle: |p, _| trunk(p).outwards },
    Limit { name: "trunk rotation", range: (-45.0, 45.0), angle: |p, _| trunk(p).twist },
    Limit { name: "neck flexion", range: (-60.0, 50.0), angle: |p, _| neck(p).flexion },
    Limit { name: "neck sideways", range: (-45.0, 45.0), angle: |p, _| neck(p).outwards },
    Limit { name: "neck rotation", range: (-80.0, 80.0), angle: |p, _| neck(p).twist },
];

/// What a pose does beyond the limits: name, side and the angle in degrees. Empty for what people can do.
///
/// A thousandth of a degree is rounding.
pub(super) fn beyond(pose: &Pose) -> Vec<(&'static str, Side, f64)> {
    const ROUNDING: f64 = 1e-3;
    let all = LIMITS.iter().flat_map(|limit| Side::BOTH.map(|side| (limit, side, (limit.angle)(pose, side))));
    all.filter(|(limit, _, angle)| !(limit.range.0 - ROUNDING..=limit.range.1 + ROUNDING).contains(angle))
        .map(|(limit, side, angle)| (limit.name, side, angle))
        .collect()
}

/// A bone that hangs or stands, seen from its parent, degrees.
struct Bone {
    /// Forward, about the parent's x.
    flexion: f64,
    /// Away from the middle.
    outwards: f64,
    /// About itself, outwards.
    twist: f64,
}

/// `bone` at rest is along `rest`; positive flexion takes its free end along +z.
fn bone(rotation: DQuat, rest: DVec3, side: Side) -> Bone {
    let direction = rotation * rest;
    let swing = DQuat::from_rotation_arc(rest, direction);
    let twist = swing.inverse() * rotation;
    Bone {
        flexion: direction.z.atan2(direction.dot(rest)).to_degrees(),
        outwards: (side.sign() * direction.x).clamp(-1.0, 1.0).asin().to_degrees(),
        twist: side.sign() * turn_about(twist, DVec3::Y),
    }
}

fn thigh(pose: &Pose, side: Side) -> Bone {
    bone(pose.rotations[leg_joints(side)[0]], DVec3::NEG_Y, side)
}

fn shank(pose: &Pose, side: Side) -> Bone {
    let shank = bone(pose.rotations[leg_joints(side)[1]], DVec3::NEG_Y, side);
    Bone { flexion: -shank.flexion, ..shank }
}

/// Toes up is positive; inversion is the roll about the foot's length.
fn foot(pose: &Pose, side: Side) -> Bone {
    let rotation = pose.rotations[leg_joints(side)[2]];
    let toes = rotation * DVec3::Z;
    let swing = DQuat::from_rotation_arc(DVec3::Z, toes);
    Bone {
        flexion: toes.y.clamp(-1.0, 1.0).asin().to_degrees(),
        outwards: side.sign() * turn_about(swing.inverse() * rotation, DVec3::Z),
        twist: side.sign() * toes.x.atan2(toes.z.hypot(toes.y)).to_degrees(),
    }
}

/// Where an upper arm is, degrees.
struct UpperArm {
    backwards: f64,
    across: f64,
    twist: f64,
}

/// Against the thorax; rotation of the arm about itself is measured from hanging with the elbow bending forwards, and not at
/// all within 60 degrees of straight up, where it has no meaning.
fn upper_arm(pose: &Pose, side: Side) -> UpperArm {
    let [collar, shoulder, ..] = arm_joints(side);
    let rotation = pose.rotations[collar] * pose.rotations[shoulder];
    let outwards = DVec3::X * side.sign();
    let direction = rotation * outwards;
    let hanging = DQuat::from_rotation_z(-side.sign() * std::f64::consts::FRAC_PI_2);
    let swing = DQuat::from_rotation_arc(DVec3::NEG_Y, direction) * hanging;
    let twist = turn_about(swing.inverse() * rotation, DVec3::X);
    UpperArm {
        backwards: (-direction.z).clamp(-1.0, 1.0).asin().to_degrees(),
        across: (-side.sign() * direction.x).clamp(-1.0, 1.0).asin().to_degrees(),
        twist: if direction.y > 0.5 { 0.0 } else { twist },
    }
}

/// Flexion of the elbow and the forearm's rotation, degrees; the palm of a hand that hangs with rotation 0 faces the thigh.
fn elbow_and_forearm(pose: &Pose, side: Side) -> (f64, f64) {
    let [_, _, elbow, hand] = arm_joints(side);
    let outwards = DVec3::X * side.sign();
    let forearm = pose.rotations[elbow] * outwards;
    let flexion = forearm.z.atan2(side.sign() * forearm.x).to_degrees();
    let bent = DQuat::from_rotation_arc(outwards, forearm);
    let twist = |rotation: DQuat| turn_about(rotation, DVec3::X);
    (flexion, twist(bent.inverse() * pose.rotations[elbow]) + twist(pose.rotations[hand]))
}

/// Flexion (to the palm) and motion to the thumb, degrees.
fn wrist(pose: &Pose, side: Side) -> (f64, f64) {
    let rotation = pose.rotations[arm_joints(side)[3]];
    let outwards = DVec3::X * side.sign();
    let twist = DQuat::from_rotation_x(turn_about(rotation, DVec3::X).to_radians());
    let fingers = rotation * twist.inverse() * outwards;
    (-fingers.y.clamp(-1.0, 1.0).asin().to_degrees(), fingers.z.clamp(-1.0, 1.0).asin().to_degrees())
}

fn trunk(pose: &Pose) -> Bone {
    bone(pose.rotations[SPINE] * pose.rotations[CHEST], DVec3::Y, Side::Left)
}

fn neck(pose: &Pose) -> Bone {
    bone(pose.rotations[NECK] * pose.rotations[HEAD], DVec3::Y, Side::Left)
}

/// Turn about one axis in the swing–twist sense, degrees from −180 to 180.
fn turn_about(rotation: DQuat, axis: DVec3) -> f64 {
    let along = DVec3::new(rotation.x, rotation.y, rotation.z).dot(axis);
    let half = if rotation.w < 0.0 { (-along).atan2(-rotation.w) } else { along.atan2(rotation.w) };
    2.0 * half.to_degrees()
}

fn about_x(rotation: DQuat) -> f64 {
    turn_about(rotation, DVec3::X)
}

fn whole(rotation: DQuat) -> f64 {
    rotation.angle_between(DQuat::IDENTITY).to_degrees()
}

#[test]
fn angles_have_the_signs_their_names_say() {
    use super::body::{Body, Trunk};
    let body = Body::new(1.75);
    let mut pose = body.pose(DVec3::Y, Trunk { lean: 0.5, ..Trunk::default() });
    let [hip, knee, ankle, toe] = leg_joints(Side::Left);
    pose.rotations[hip] = DQuat::from_rotation_x(-0.4);
    pose.rotations[knee] = DQuat::from_rotation_x(0.7);
    pose.rotations[ankle] = DQuat::from_rotation_x(-0.2);
    pose.rotations[toe] = DQuat::from_rotation_x(-0.3);
    body.hang_arm(&mut pose, Side::Right, 0.3, 0.9);
    let angle = |name: &str, side: Side| {
        let limit = LIMITS.iter().find(|limit| limit.name == name).expect("a row");
        (limit.angle)(&pose, side).to_radians()
    };
    for (name, side, expected) in [
        ("hip flexion", Side::Left, 0.4),
        ("knee flexion", Side::Left, 0.7),
        ("ankle dorsiflexion", Side::Left, 0.2),
        ("toe extension", Side::Left, 0.3),
        ("trunk flexion", Side::Left, 0.5),
        ("elbow flexion", Side::Right, 0.9),
    ] {
        assert!((angle(name, side) - expected).abs() < 1e-9, "{name} is {}", angle(name, side));
    }
    assert!(angle("upper arm backwards", Side::Right) > 0.2);
}
