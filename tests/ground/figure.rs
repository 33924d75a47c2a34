//! A figure of average proportions that walks on a circle by formulas.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::contacts::BodyPoint;
use cotillion::index::{JointId, floor_index};
use cotillion::limb::{Limb, minimal_rotation};
use cotillion::physics::body_model::{BodyModel, BodySettings, Link, Segment, body_model};
use cotillion::physics::sole::{Side, SolePart};
use cotillion::physics::stages::{Bearer, Phase, Stages, Support};
use cotillion::skeleton::{Axis, Joint, JointRole, Pose, Skeleton};
use glam::{DQuat, DVec3};

/// Metres.
pub(crate) const STATURE: f64 = 1.8;
pub(crate) const RADIUS: f64 = 2.0;
const SPEED: f64 = 1.2;
const STEP: f64 = 0.5;
const OVERLAP: f64 = 0.05;
const HIP_HEIGHT: f64 = 0.86;
const ASIDE: f64 = 0.09;
const ANKLE: f64 = 0.039 * STATURE;
/// Lumbosacral joint above the hips, share of the stature.
const SPINE: f64 = 0.05;
/// From there to the chest.
const ABDOMEN: f64 = 0.09;
/// From the chest to shoulder height: hips are at 0.53, shoulders at 0.818.
const THORAX: f64 = 0.818 - 0.53 - SPINE - ABDOMEN;
const RATE: f64 = 30.0;
const FRAMES: usize = 111;
/// Seconds.
const START: f64 = 1.0;

/// A motion, its body and its labels.
pub(crate) struct Figure {
    pub(crate) clip: Clip,
    pub(crate) body: BodyModel,
    pub(crate) stages: Stages,
}

const HIPS: usize = 0;
const LEGS: [[usize; 3]; 2] = [[1, 2, 3], [4, 5, 6]];
const ARMS: [[usize; 2]; 2] = [[11, 12], [14, 15]];

fn skeleton() -> Skeleton {
    let h = STATURE;
    let mut joints: Vec<Joint> = Vec::new();
    let mut joint = |name: &str, parent: Option<usize>, offset: [f64; 3], role, end_site: Option<DVec3>| {
        joints.push(Joint {
            name: name.to_owned(),
            parent: parent.map(JointId::from_usize),
            offset: DVec3::from_array(offset),
            end_site,
            rotation_order: [Axis::Z, Axis::X, Axis::Y],
            role: Some(role),
        });
    };
    let ball = Some(DVec3::new(0.0, -ANKLE, 0.1 * h));
    joint("hips", None, [0.0, 0.53 * h, 0.0], JointRole::Pelvis, None);
    for (side, roles) in [
        (1.0, [JointRole::LeftHip, JointRole::LeftKnee, JointRole::LeftFoot]),
        (-1.0, [JointRole::RightHip, JointRole::RightKnee, JointRole::RightFoot]),
    ] {
        let hip = if side > 0.0 { 1 } else { 4 };
        joint("hip", Some(HIPS), [side * 0.0955 * h, 0.0, 0.0], roles[0], None);
        joint("knee", Some(hip), [0.0, -0.245 * h, 0.0], roles[1], None);
        joint("foot", Some(hip + 1), [0.0, -0.246 * h, 0.0], roles[2], ball);
    }
    joint("spine", Some(HIPS), [0.0, SPINE * h, 0.0], JointRole::Spine, None);
    joint("chest", Some(7), [0.0, ABDOMEN * h, 0.0], JointRole::Chest, None);
    joint("neck", Some(8), [0.0, THORAX * h, 0.0], JointRole::Neck, Some(DVec3::Y * (0.1 * h)));
    for (side, roles) in [
        (1.0, [JointRole::LeftClavicle, JointRole::LeftShoulder, JointRole::LeftElbow]),
        (-1.0, [JointRole::RightClavicle, JointRole::RightShoulder, JointRole::RightElbow]),
    ] {
        let collar = if side > 0.0 { 10 } else { 13 };
        joint("collar", Some(8), [0.0, THORAX * h, 0.0], roles[0], None);
        joint("shoulder", Some(collar), [side * 0.129 * h, 0.0, 0.0], roles[1], None);
        joint("elbow", Some(collar + 1), [0.0, -0.186 * h, 0.0], roles[2], Some(DVec3::NEG_Y * (0.146 * h)));
    }
    Skeleton { joints }
}

/// Place and heading (about up, from +z) of the path at `seconds`, `aside` to the left.
fn path(seconds: f64, aside: f64) -> (DVec3, f64) {
    // Walks to the left: the centre is at the origin.
    let turn = SPEED * seconds / RADIUS;
    let out = DVec3::new(-turn.cos(), 0.0, turn.sin()) * -1.0;
    (out * (RADIUS - aside), heading_of(out))
}

/// Ahead is across the way out, so that the centre is on the left.
fn heading_of(out: DVec3) -> f64 {
    let ahead = DVec3::Y.cross(out);
    ahead.x.atan2(ahead.z)
}

fn side_of(step: i32) -> usize {
    usize::from(step.rem_euclid(2) == 1)
}

fn sign(side: usize) -> f64 {
    if side == 0 { 1.0 } else { -1.0 }
}

/// Place of the ankle and heading of the foot of `step`.
fn print(step: i32) -> (DVec3, f64) {
    let (place, heading) = path((f64::from(step) + 0.5) * STEP, sign(side_of(step)) * ASIDE);
    (place + DVec3::Y * ANKLE, heading)
}

/// Ankle, heading, and whether it bears.
fn foot(side: usize, seconds: f64) -> (DVec3, f64, bool) {
    let mut step = -2;
    while f64::from(step + 2) * STEP - OVERLAP <= seconds || side_of(step) != side {
        step += 1;
    }
    let ends = f64::from(step + 1) * STEP + OVERLAP;
    let (place, heading) = print(step);
    if seconds <= ends {
        return (place, heading, true);
    }
    let (next, other) = print(step + 2);
    let s = (seconds - ends) / (f64::from(step + 2) * STEP - OVERLAP - ends);
    let eased = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    let turn = cotillion::geometry::wrap(other - heading);
    (place.lerp(next, eased) + DVec3::Y * (0.1 * (PI * s).sin()), heading + eased * turn, false)
}

fn pose(skeleton: &Skeleton, seconds: f64) -> (Pose, [bool; 2]) {
    let step = (seconds / STEP).floor();
    let side = sign(usize::from(step.rem_euclid(2.0) > 0.5));
    let omega = (9.81_f64 / 0.95).sqrt();
    let tau = seconds - (step + 0.5) * STEP;
    let sway = side * ASIDE * (1.0 - (omega * tau).cosh() / (omega * STEP / 2.0).cosh());
    let (place, heading) = path(seconds, sway);
    let mut pose = skeleton.rest_pose();
    pose.root = place + DVec3::Y * HIP_HEIGHT;
    let facing = DQuat::from_rotation_y(heading);
    pose.rotations[HIPS] = facing;
    let mut bears = [false; 2];
    for (side, leg) in LEGS.iter().enumerate() {
        let (ankle, heading, is_down) = foot(side, seconds);
        bears[side] = is_down;
        let [hip, knee, foot] = leg.map(|joint| skeleton.joints[joint].offset);
        let upper = pose.root + facing * hip;
        let limb = Limb { upper, middle: upper + facing * knee, lower: upper + facing * (knee + foot) };
        let reach = limb.reach(ankle, facing * DVec3::Z);
        let thigh = minimal_rotation(facing * knee, reach.middle - upper) * facing;
        let shank = minimal_rotation(thigh * foot, reach.lower - reach.middle) * thigh;
        pose.rotations[leg[0]] = facing.inverse() * thigh;
        pose.rotations[leg[1]] = thigh.inverse() * shank;
        pose.rotations[leg[2]] = shank.inverse() * DQuat::from_rotation_y(heading);
    }
    for (side, arm) in ARMS.iter().enumerate() {
        // Against the leg of the same side.
        let swing = 0.35 * sign(side) * (PI * seconds / STEP + FRAC_PI_2).sin();
        pose.rotations[arm[0]] = DQuat::from_rotation_x(-swing);
        pose.rotations[arm[1]] = DQuat::from_rotation_x(-0.3);
    }
    (pose, bears)
}

/// The reference's arms are upper arms and forearms: it has no joints of hands, and what no joint turns weighs nothing there.
fn handless(body: &BodyModel) -> BodyModel {
    let mass = |link: &Link| if link.segment == Segment::Hand { 0.0 } else { link.mass };
    body.with_link_masses(&body.links.iter().map(mass).collect::<Vec<f64>>())
}

pub(crate) fn on_a_circle() -> Figure {
    let skeleton = Arc::new(skeleton());
    let frames: Vec<(Pose, [bool; 2])> =
        (0..FRAMES).map(|frame| pose(&skeleton, START + frame as f64 / RATE)).collect();
    let body = handless(&body_model(&skeleton, &BodySettings::default()).expect("a whole body"));
    let poses: Vec<Pose> = frames.iter().map(|(pose, _)| pose.clone()).collect();
    let clip = Clip::from_poses("circle", skeleton, RATE, &poses);
    let supports = [Side::Left, Side::Right]
        .into_iter()
        .enumerate()
        .flat_map(|(side, named)| {
            let bears: Vec<bool> = frames.iter().map(|(_, bears)| bears[side]).collect();
            soles(JointId::from_usize(LEGS[side][2])).map(|(part, points)| Support {
                bearer: Bearer::Sole(named, part),
                points,
                bears: bears.clone(),
            })
        })
        .collect();
    let stages =
        Stages { soles: Vec::new(), supports, phases: vec![Phase::Ground; FRAMES], flights: Vec::new() };
    Figure { clip, body, stages }
}

/// Heel and ball below the ankle: these feet have no toes.
fn soles(joint: JointId) -> [(SolePart, Vec<BodyPoint>); 2] {
    let half = 0.025 * STATURE;
    let pair = |ahead: f64, width: f64| {
        let at =
            |side: f64| BodyPoint { joint, local: DVec3::new(side * width * half, -ANKLE, ahead * STATURE) };
        vec![at(1.0), at(-1.0)]
    };
    [(SolePart::Heel, pair(-0.033, 0.75)), (SolePart::Ball, pair(0.08, 1.0))]
}

/// Frame at `seconds` after the start.
pub(crate) fn frame_at(seconds: f64) -> usize {
    floor_index(seconds * RATE)
}
