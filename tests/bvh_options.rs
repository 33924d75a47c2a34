//! BVH files hold the same motion whatever their rate, unit, rotation order and joint names.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use cotillion::clip::Clip;
use cotillion::clip::builtin::generate;
use cotillion::clip::read::{Capture, ReadOptions, Up, read};
use cotillion::clip::roles::assign_roles;
use cotillion::export::bvh::{BvhOptions, JointNames, rotation_of, to_bvh, to_bvh_with};
use cotillion::geometry::log;
use cotillion::index::{JointId, SourceFrame};
use cotillion::skeleton::{Axis, Joint, JointRole, Pose, Skeleton};
use glam::DVec3;
use proptest::prelude::*;

/// Ten decimals of a metre or less, over chains of a few joints; ten decimals of a degree turn a metre by 1e-12.
const WRITTEN: f64 = 1e-8;

const ORDERS: [[Axis; 3]; 6] = [
    [Axis::X, Axis::Y, Axis::Z],
    [Axis::Y, Axis::Z, Axis::X],
    [Axis::Z, Axis::X, Axis::Y],
    [Axis::X, Axis::Z, Axis::Y],
    [Axis::Y, Axis::X, Axis::Z],
    [Axis::Z, Axis::Y, Axis::X],
];

const NAMES: [JointNames; 3] = [JointNames::AsRead, JointNames::Cmu, JointNames::Mixamo];

/// Roles of a whole body, each with one name that our reader and others know.
const BODY: [(&str, usize, JointRole); 21] = [
    ("pelvis", 0, JointRole::Pelvis),
    ("abdomen", 0, JointRole::Spine),
    ("chest", 1, JointRole::Chest),
    ("neck", 2, JointRole::Neck),
    ("head", 3, JointRole::Head),
    ("lCollar", 2, JointRole::LeftClavicle),
    ("lShldr", 5, JointRole::LeftShoulder),
    ("lForeArm", 6, JointRole::LeftElbow),
    ("lHand", 7, JointRole::LeftHand),
    ("rCollar", 2, JointRole::RightClavicle),
    ("rShldr", 9, JointRole::RightShoulder),
    ("rForeArm", 10, JointRole::RightElbow),
    ("rHand", 11, JointRole::RightHand),
    ("lThigh", 0, JointRole::LeftHip),
    ("lShin", 13, JointRole::LeftKnee),
    ("lFoot", 14, JointRole::LeftFoot),
    ("lToe", 15, JointRole::LeftToe),
    ("rThigh", 0, JointRole::RightHip),
    ("rShin", 17, JointRole::RightKnee),
    ("rFoot", 18, JointRole::RightFoot),
    ("rToe", 19, JointRole::RightToe),
];

/// A body with joints in mixed orders and two fingers of one name.
fn skeleton() -> Skeleton {
    let fingers = [("finger", 8_usize), ("finger", 12)];
    let rows = BODY.iter().map(|(name, parent, _)| (*name, *parent)).chain(fingers);
    let joint = |(index, (name, parent)): (usize, (&str, usize))| Joint {
        name: name.to_owned(),
        parent: (index > 0).then(|| JointId::from_usize(parent)),
        offset: DVec3::new(0.05 + 0.01 * index as f64, 0.3, -0.1),
        end_site: (index % 4 == 0).then_some(DVec3::new(0.0, 0.1, 0.02)),
        rotation_order: ORDERS[index % 6],
        role: None,
    };
    let mut joints: Vec<Joint> = rows.enumerate().map(joint).collect();
    assign_roles(&mut joints);
    Skeleton { joints }
}

/// A clip of `skeleton` whose angles come from `angles`, one of whose joints moves against its parent.
fn clip(fps: f64, angles: &[[f64; 3]]) -> Clip {
    let skeleton = Arc::new(skeleton());
    let moving = JointId(3);
    let poses: Vec<Pose> = angles
        .iter()
        .enumerate()
        .map(|(frame, angles)| Pose {
            root: DVec3::new(angles[0], 1.0 + 0.1 * angles[1], 0.02 * frame as f64),
            rotations: (0..skeleton.joints.len())
                .map(|joint| {
                    rotation_of(angles.map(|angle| angle * (1.0 + joint as f64 * 0.1)), ORDERS[joint % 6])
                })
                .collect(),
            offsets: vec![(moving, skeleton.joints[3].offset + DVec3::Y * (0.01 * angles[2]))],
        })
        .collect();
    Clip::from_poses("any", skeleton, fps, &poses)
}

fn read_back(text: &str, unit_to_m: f64) -> Clip {
    let options = ReadOptions { unit_to_m: Some(unit_to_m), up: Some(Up::Y), ..ReadOptions::default() };
    read(Capture::Bvh(text.as_bytes()), "any", &options).expect("what we write we read").clip
}

fn options() -> impl Strategy<Value = BvhOptions> {
    let fps = prop::option::of(prop::sample::select(vec![24.0, 25.0, 30.0, 59.94, 120.0, 33.3]));
    let unit = prop::sample::select(vec![1.0, 0.01, 0.0254, 0.056_444_4, 1e-3, 2.5]);
    let order = prop::option::of(prop::sample::select(ORDERS.to_vec()));
    (fps, unit, order, prop::sample::select(NAMES.to_vec())).prop_map(
        |(fps, unit_to_m, rotation_order, names)| BvhOptions { fps, unit_to_m, rotation_order, names },
    )
}

proptest! {
    #[test]
    fn every_combination_is_read_back_to_the_same_poses(
        options in options(),
        fps in prop::sample::select(vec![30.0, 60.0, 120.0, 29.97]),
        angles in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 2..12),
    ) {
        let clip = clip(fps, &angles);
        let back = read_back(&to_bvh_with(&clip, &options), options.unit_to_m);
        let rate = options.fps.unwrap_or(fps);
        let seconds = (clip.frame_count() - 1) as f64 / fps;
        prop_assert!((back.fps - rate).abs() < 1e-9);
        prop_assert!((back.frame_count() as f64 - 1.0) / rate <= seconds + 1e-9);
        prop_assert!(back.frame_count() as f64 / rate > seconds - 1e-9);
        // Depth first: the two fingers move up behind their hands.
        let place = |index: usize| match index {
            0..=8 => index,
            9..=12 => index + 1,
            13..=20 => index + 2,
            21 => 9,
            _ => 14,
        };
        for frame in 0..back.frame_count() {
            let pose = clip.sample(frame as f64 * fps / rate);
            let before = clip.skeleton.forward_kinematics(&pose);
            let after = back.skeleton.forward_kinematics(&back.pose(SourceFrame::from_usize(frame)));
            for (index, before) in before.iter().enumerate() {
                let after = after[place(index)];
                prop_assert!(before.position.distance(after.position) < WRITTEN);
                prop_assert!(log(before.rotation.inverse() * after.rotation).length() < WRITTEN);
            }
        }
        if let Some(order) = options.rotation_order {
            prop_assert!(back.skeleton.joints.iter().all(|joint| joint.rotation_order == order));
        }
    }
}

#[test]
fn the_default_writes_what_was_always_written() {
    let clip = clip(30.0, &[[0.1, 0.2, 0.3], [0.4, -0.5, 2.0]]);
    assert_eq!(to_bvh_with(&clip, &BvhOptions::default()), to_bvh(&clip));
    // The same by the way that converts: a unit of one metre divides nothing.
    let own_rate = BvhOptions { fps: Some(30.0), ..BvhOptions::default() };
    assert_eq!(to_bvh_with(&clip, &own_rate), to_bvh(&clip));
}

#[test]
fn presets_name_every_role_once_and_are_recognised_again() {
    let clip = clip(30.0, &[[0.0; 3], [0.1; 3]]);
    for names in [JointNames::Cmu, JointNames::Mixamo] {
        let options = BvhOptions { names, ..BvhOptions::default() };
        let back = read_back(&to_bvh_with(&clip, &options), 1.0);
        let distinct: HashSet<&str> = back.skeleton.joints.iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(distinct.len(), back.skeleton.joints.len(), "{names:?}");
        for (own, _, role) in BODY {
            let joint = back.skeleton.joint_of(role).expect("every role is found again");
            let name = &back.skeleton.joints[joint.as_usize()].name;
            assert_ne!(name, own, "{role:?} has the preset's name");
            assert_eq!(names == JointNames::Mixamo, name.starts_with("mixamorig:"), "{name}");
        }
        let fingers = distinct.iter().filter(|name| name.starts_with("finger")).count();
        assert_eq!(fingers, 2, "joints without a role keep their names, apart");
    }
}

#[test]
fn a_generated_clip_has_cmu_names_already() {
    let walk = generate("walk", &BTreeMap::new()).expect("a generated clip");
    let options = BvhOptions { names: JointNames::Cmu, ..BvhOptions::default() };
    assert_eq!(to_bvh_with(&walk, &options), to_bvh(&walk));
}
