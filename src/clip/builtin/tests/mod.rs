//! What generated clips promise: here what holds for all of them, in the modules below what holds for a family.

mod acts;
mod detection;
mod jumps;
mod loads;
mod run;
mod turns;
mod walks;

use glam::{DQuat, DVec3};

use super::*;
use crate::geometry::log;
use crate::index::JointId;
use crate::skeleton::{JointFrame, JointRole};

/// Rounding of a chain of rotations in metres and radians.
const ROUNDING: f64 = 1e-9;

fn made(name: &str, parameters: &[(&str, f64)]) -> Clip {
    let parameters = parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    generate(name, &parameters).expect("valid parameters")
}

/// Every clip with defaults, and those that a family adds.
fn many() -> Vec<Clip> {
    let mut clips: Vec<Clip> = names().map(|info| made(info.name, &[])).collect();
    clips.extend(walks::variants());
    clips.extend(acts::variants());
    clips.extend(turns::variants());
    clips
}

fn world(clip: &Clip, frame: usize) -> Vec<JointFrame> {
    clip.skeleton.forward_kinematics(&clip.pose(SourceFrame::from_usize(frame)))
}

fn joint(clip: &Clip, role: JointRole) -> usize {
    clip.skeleton.joint_of(role).expect("all roles are filled").as_usize()
}

/// Positions of one joint in all frames.
fn trajectory(clip: &Clip, role: JointRole) -> Vec<DVec3> {
    let joint = joint(clip, role);
    (0..clip.frame_count()).map(|frame| world(clip, frame)[joint].position).collect()
}

fn end_site(clip: &Clip, frames: &[JointFrame], joint: usize) -> Option<DVec3> {
    let end = clip.skeleton.joints[joint].end_site?;
    Some(frames[joint].position + frames[joint].rotation * end)
}

fn horizontal_distance(a: DVec3, b: DVec3) -> f64 {
    (a.x - b.x).hypot(a.z - b.z)
}

#[test]
fn the_body_has_twenty_one_joints_each_with_its_role() {
    let clip = made("idle", &[]);
    assert_eq!(clip.skeleton.joints.len(), 21);
    assert!(clip.skeleton.joints.iter().all(|joint| joint.role.is_some()));
    let rest = clip.skeleton.forward_kinematics(&clip.skeleton.rest_pose());
    let top = end_site(&clip, &rest, joint(&clip, JointRole::Head)).expect("the head ends");
    assert!((top.y - 1.75).abs() < ROUNDING);
    assert!(rest[joint(&clip, JointRole::LeftHip)].position.x > 0.0);
}

#[test]
fn bones_keep_their_lengths_and_rotations_are_units() {
    for clip in many() {
        for rotation in &clip.rotations {
            assert!((rotation.length() - 1.0).abs() < ROUNDING, "{}", clip.name);
        }
        let frames = world(&clip, clip.frame_count() / 2);
        for (index, joint) in clip.skeleton.joints.iter().enumerate().skip(1) {
            let parent = joint.parent.expect("only the root has none").as_usize();
            let length = frames[index].position.distance(frames[parent].position);
            assert!((length - joint.offset.length()).abs() < ROUNDING);
        }
    }
}

/// Largest angle between two lists of rotations, radians.
fn turn_between(a: &[DQuat], b: &[DQuat]) -> f64 {
    let angles = a.iter().zip(b).map(|(a, b)| log(a.inverse() * *b).length());
    angles.fold(0.0, f64::max)
}

#[test]
fn nothing_sinks_into_the_ground() {
    for clip in many() {
        let scale = clip.skeleton.joints[0].offset.y / body::PELVIS_HEIGHT;
        let sole = (body::ANKLE_HEIGHT + body::TOE_OFFSET.y) * scale;
        for frame in 0..clip.frame_count() {
            let frames = world(&clip, frame);
            for index in 0..frames.len() {
                let lowest = end_site(&clip, &frames, index)
                    .map_or(frames[index].position.y, |end| end.y.min(frames[index].position.y));
                assert!(lowest > sole - ROUNDING, "{} {frame}: joint {index} at {lowest}", clip.name);
            }
        }
    }
}

#[test]
fn knees_and_elbows_bend_one_way() {
    for clip in many() {
        for (role, axis) in [
            (JointRole::LeftKnee, DVec3::X),
            (JointRole::RightKnee, DVec3::X),
            (JointRole::LeftElbow, DVec3::NEG_Y),
            (JointRole::RightElbow, DVec3::Y),
        ] {
            let joint = joint(&clip, role);
            let bone = clip.skeleton.joints[joint + 1].offset.normalize();
            for frame in 0..clip.frame_count() {
                let bent = clip.pose(SourceFrame::from_usize(frame)).rotations[joint] * bone;
                let flexion = bone.cross(bent).dot(axis).atan2(bone.dot(bent));
                assert!(bent.dot(axis).abs() < 1e-6, "{role:?} bends sideways");
                assert!(
                    (0.0..2.62).contains(&(flexion + 1e-9)),
                    "{role:?} of {} {frame}: {flexion}",
                    clip.name
                );
            }
        }
    }
}

#[test]
fn joints_stay_within_human_limits() {
    for clip in many() {
        for frame in 0..clip.frame_count() {
            let beyond = limits::beyond(&clip.pose(SourceFrame::from_usize(frame)));
            assert!(beyond.is_empty(), "{} {frame}: {beyond:?}", clip.name);
        }
    }
}

#[test]
fn joints_turn_no_faster_than_people_can() {
    /// Radians per second; the slapping arm may be faster, knees and ankles of children who keep up with adults, and legs that
    /// jump.
    const FASTEST: f64 = 12.0;
    const FASTEST_SLAP: f64 = 20.0;
    const FASTEST_WALK: f64 = 17.0;
    const FASTEST_RUN: f64 = 23.0;
    const FASTEST_JUMP: f64 = 30.0;
    for clip in many() {
        let joints = clip.skeleton.joints.len();
        for (k, pair) in clip.rotations.windows(joints + 1).enumerate() {
            let speed = log(pair[0].inverse() * pair[joints]).length() * FPS;
            let slapping = clip.name == "slap" && (body::ARMS[1]..body::ARMS[1] + 4).contains(&(k % joints));
            let limit = match clip.name.as_str() {
                "run" => FASTEST_RUN,
                "walk" | "carry" => FASTEST_WALK,
                "jump" | "jump_over" | "back_flip" => FASTEST_JUMP,
                _ if slapping => FASTEST_SLAP,
                _ => FASTEST,
            };
            let joint = &clip.skeleton.joints[k % joints].name;
            assert!(speed < limit, "{joint} of {} at {}: {speed} rad/s", clip.name, k / joints);
        }
    }
}

#[test]
fn mistakes_name_what_is_known() {
    let wrong = |name: &str, parameter: &str, value: f64| {
        generate(name, &BTreeMap::from([(parameter.to_owned(), value)])).expect_err("a mistake").to_string()
    };
    let known = clip_names();
    assert_eq!(
        wrong("wlak", "speed", 1.0),
        format!("no generated clip \"wlak\"; did you mean \"walk\"? (known: {known})")
    );
    assert!(known.starts_with("\"walk\", ") && known.contains("\"idle\""));
    assert_eq!(
        wrong("idle", "secnds", 1.0),
        "generated clip \"idle\" has no parameter \"secnds\"; did you mean \"seconds\"? (known: \"seconds\", \"stature\")"
    );
    assert_eq!(wrong("walk", "speed", 9.0), "speed = 9 of generated clip \"walk\" is outside 0.5 to 1.8 m/s");
    assert_eq!(wrong("walk", "start", 0.5), "start = 0.5 of generated clip \"walk\" is neither 0 nor 1");
    assert_eq!(wrong("walk", "stop", 2.0), "stop = 2 of generated clip \"walk\" is neither 0 nor 1");
    assert!(wrong("idle", "seconds", f64::NAN).contains("NaN"));
}

#[test]
fn every_default_is_in_its_range_and_every_event_in_its_clip() {
    for info in names() {
        let clip = made(info.name, &[]);
        assert!(info.parameters.iter().all(|p| p.range.0 <= p.default && p.default <= p.range.1));
        assert!(info.parameters.iter().all(|p| !p.is_switch() || p.range == (0.0, 1.0)));
        assert!(info.events.iter().all(|event| clip.events[*event].as_usize() < clip.frame_count()));
        assert_eq!(clip.events.len(), info.events.len());
        let _root: JointId = clip.skeleton.joint_of(JointRole::Pelvis).expect("a pelvis");
    }
}
