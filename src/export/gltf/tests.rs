//! What a GLB promises to its readers.

use std::collections::BTreeMap;

use super::*;
use crate::clip::MovingOffset;
use crate::clip::builtin::generate;
use crate::geometry::c64;
use crate::skeleton::{Axis, Joint, JointRole};

/// Single precision on numbers below 10.
const SINGLE: f64 = 1e-5;

fn made(name: &str) -> Clip {
    generate(name, &BTreeMap::new()).expect("defaults are valid")
}

/// A skeleton as files have them: helpers, a stray rig joint, a bone of no length, odd names, joints that move.
fn odd_clip(frames: usize) -> Clip {
    let joint = |name: &str, parent: Option<usize>, offset: [f64; 3], role| Joint {
        name: name.to_owned(),
        parent: parent.map(JointId::from_usize),
        offset: DVec3::from_array(offset),
        end_site: None,
        rotation_order: [Axis::Z, Axis::X, Axis::Y],
        role,
    };
    let skeleton = Arc::new(Skeleton {
        joints: vec![
            joint("hip \"root\" \\ \u{1}", None, [0.0, 0.9, 0.0], Some(JointRole::Pelvis)),
            joint("", Some(0), [0.0, 0.0, 0.0], None),
            joint("Brust", Some(1), [0.0, 0.3, 0.0], Some(JointRole::Chest)),
            joint("頭", Some(2), [0.0, 0.3, 0.0], Some(JointRole::Head)),
            joint("RIGMESH", Some(0), [40.0, -70.0, 3.0], None),
            joint("lhand", Some(2), [0.6, 0.0, 0.0], Some(JointRole::LeftHand)),
        ],
    });
    let turn = DQuat::from_rotation_z(3.0);
    let poses: Vec<_> = (0..frames)
        .map(|frame| {
            let mut pose = skeleton.rest_pose();
            pose.rotations[2] = if frame % 2 == 0 { turn } else { -turn };
            pose
        })
        .collect();
    let mut clip = Clip::from_poses("odd", skeleton, 120.0, &poses);
    clip.moving_offsets.push(MovingOffset {
        joint: JointId(5),
        offsets: (0..frames).map(|k| DVec3::X * (0.6 + 0.01 * k as f64)).collect(),
    });
    clip
}

/// JSON part and binary part of a GLB.
fn parts(glb: &[u8]) -> (serde_json::Value, &[u8]) {
    let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().expect("four bytes")) as usize;
    assert_eq!(&glb[..4], b"glTF");
    assert_eq!((word(4), word(8)), (2, glb.len()));
    let json_length = word(12);
    let binary = 20 + json_length;
    assert_eq!(binary + 8 + word(binary), glb.len());
    assert_eq!((json_length % 4, word(binary) % 4), (0, 0));
    let json = serde_json::from_slice(&glb[20..binary]).expect("JSON");
    (json, &glb[binary + 8..])
}

/// Numbers of a floating-point accessor.
fn numbers(json: &serde_json::Value, binary: &[u8], accessor: &serde_json::Value) -> Vec<f64> {
    let whole = |value: &serde_json::Value| {
        let number = value.as_u64().expect("a whole number");
        usize::try_from(number).expect("fits in memory")
    };
    let accessor = &json["accessors"][whole(accessor)];
    let view = &json["bufferViews"][whole(&accessor["bufferView"])];
    let start = whole(&view["byteOffset"]);
    binary[start..start + whole(&view["byteLength"])]
        .chunks(4)
        .map(|bytes| f64::from(f32::from_le_bytes(bytes.try_into().expect("four bytes"))))
        .collect()
}

fn trio<'a>(clips: &'a [Clip]) -> GlbScene<'a> {
    GlbScene {
        title: "three & a <box>",
        performers: clips
            .iter()
            .enumerate()
            .map(|(number, clip)| Performer { name: &clip.name, number, clip })
            .collect(),
        objects: vec![GlbObject {
            name: "box",
            size: [0.4, 0.3, 0.2],
            poses: vec![ObjectPose::on_ground(c64::new(0.0, 2.0), 0.3)],
            fps: 30.0,
        }],
    }
}

#[test]
fn a_trio_has_skins_one_animation_and_its_names() {
    let clips = [made("walk"), made("idle"), made("slap")];
    let glb = to_glb(&trio(&clips));
    let (json, binary) = parts(&glb);
    assert_eq!(json["asset"]["generator"], "cotillion");
    assert_eq!(json["skins"].as_array().map(Vec::len), Some(3));
    assert_eq!(json["animations"].as_array().map(Vec::len), Some(1));
    assert_eq!(json["animations"][0]["channels"].as_array().map(Vec::len), Some(3 * 22));
    let names: Vec<_> = json["nodes"].as_array().expect("nodes").iter().map(|node| &node["name"]).collect();
    for name in ["walk", "idle body", "slap", "box", "Hips", "LeftToeBase"] {
        assert!(names.iter().any(|known| *known == name), "{name}");
    }
    assert_eq!(json["buffers"][0]["byteLength"].as_u64(), Some(binary.len() as u64));
    assert_eq!(glb, to_glb(&trio(&clips)));
}

#[test]
fn keyframes_replay_the_clip() {
    let clips = [made("walk")];
    let glb = to_glb(&trio(&clips));
    let (json, binary) = parts(&glb);
    let samplers = json["animations"][0]["samplers"].as_array().expect("samplers");
    let times = numbers(&json, binary, &samplers[0]["input"]);
    assert_eq!(times.len(), clips[0].frame_count());
    assert!((times[30] - 1.0).abs() < SINGLE);
    let roots = numbers(&json, binary, &samplers[0]["output"]);
    for (root, expected) in roots.chunks(3).zip(&clips[0].root_positions) {
        assert!(DVec3::from_slice(root).distance(*expected) < SINGLE);
    }
    for (joint, sampler) in samplers[1..].iter().enumerate() {
        let rotations = numbers(&json, binary, &sampler["output"]);
        for (frame, q) in rotations.chunks(4).enumerate() {
            let expected = clips[0].rotations[frame * 21 + joint];
            assert!(DQuat::from_slice(q).dot(expected).abs() > 1.0 - SINGLE);
        }
    }
}

#[test]
fn an_object_that_moves_has_keyframes_of_its_own() {
    let clips = [made("walk")];
    let poses: Vec<ObjectPose> = (0..clips[0].frame_count())
        .map(|k| ObjectPose { position: DVec3::new(0.1 * k as f64, 0.5, 1.0), facing: 0.2 * k as f64 })
        .collect();
    let mut scene = trio(&clips);
    scene.objects[0].poses.clone_from(&poses);
    scene.objects[0].fps = clips[0].fps;
    let glb = to_glb(&scene);
    let (json, binary) = parts(&glb);
    let channels = json["animations"][0]["channels"].as_array().expect("channels");
    let samplers = json["animations"][0]["samplers"].as_array().expect("samplers");
    assert_eq!(channels.len(), 22 + 2);
    assert_eq!(samplers[0]["input"], samplers[22]["input"], "frames of equal times share them");
    let node = channels[22]["target"]["node"].as_u64().expect("a node");
    assert_eq!(json["nodes"][usize::try_from(node).expect("few nodes")]["name"], "box");
    let places = numbers(&json, binary, &samplers[22]["output"]);
    let turns = numbers(&json, binary, &samplers[23]["output"]);
    for (k, pose) in poses.iter().enumerate() {
        assert!(DVec3::from_slice(&places[3 * k..]).distance(pose.position) < SINGLE);
        let turn = DQuat::from_slice(&turns[4 * k..]);
        assert!(turn.dot(DQuat::from_rotation_y(pose.facing)).abs() > 1.0 - SINGLE);
        assert!(k == 0 || turn.dot(DQuat::from_slice(&turns[4 * k - 4..])) > 0.0);
    }
}

#[test]
fn odd_skeletons_and_single_frames_are_written() {
    for frames in [1, 5] {
        let clips = [odd_clip(frames)];
        let glb = to_glb(&trio(&clips));
        let (json, binary) = parts(&glb);
        let samplers = json["animations"][0]["samplers"].as_array().expect("samplers");
        assert_eq!(numbers(&json, binary, &samplers[0]["input"]).len(), frames);
        assert_eq!(samplers.len(), 1 + 1 + 6);
        let chest = numbers(&json, binary, &samplers[4]["output"]);
        for pair in chest.chunks(4).collect::<Vec<_>>().windows(2) {
            let dot: f64 = pair[0].iter().zip(pair[1]).map(|(a, b)| a * b).sum();
            assert!(dot > 0.0, "neighbouring keys have the same sign");
        }
    }
}

#[test]
fn an_empty_stage_is_a_ground() {
    let (json, _) = parts(&to_glb(&GlbScene { title: "", performers: Vec::new(), objects: Vec::new() }));
    assert_eq!(json["nodes"].as_array().map(Vec::len), Some(1));
    assert!(json.get("animations").is_none());
}

#[test]
fn bodies_surround_their_bones_and_rig_joints_get_none() {
    let walker = made("walk").skeleton;
    let mesh = body_mesh(&walker);
    let low = mesh.positions.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let high = mesh.positions.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
    assert!((-0.005..0.03).contains(&low), "soles at {low}");
    assert!((1.72..1.80).contains(&high), "top of the head at {high}");
    for (normal, (position, joint)) in mesh.normals.iter().zip(mesh.positions.iter().zip(&mesh.joints)) {
        assert!((normal.length() - 1.0).abs() < 1e-9, "{position} of joint {joint}");
    }
    let odd = body_mesh(&odd_clip(1).skeleton);
    assert!(odd.positions.iter().all(|p| p.length() < 3.0));
    assert!(!odd.positions.is_empty());
}

#[test]
fn triangles_face_outwards() {
    let mesh = body_mesh(&made("idle").skeleton);
    // Signed volume of all closed limbs: positive when counter-clockwise seen from outside.
    let volume: f64 = mesh
        .triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex]);
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    assert!((0.03..0.12).contains(&volume), "a person of {volume} m³");
}
