//! What generated clips promise.

use glam::{DQuat, DVec3};

use super::gait::{FLAT, Gait, HEEL_OFF, TOE_OFF};
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

/// Every clip with defaults, and walks and bodies at the ends of their ranges.
fn many() -> Vec<Clip> {
    let mut clips: Vec<Clip> = names().map(|info| made(info.name, &[])).collect();
    for speed in [0.5, 0.8, 1.5, 1.8] {
        clips.push(made("walk", &[("speed", speed)]));
    }
    for speed in [0.5, 1.2, 1.8] {
        clips.push(made("walk", &[("speed", speed), ("start", 1.0), ("stop", 1.0), ("seconds", 5.0)]));
    }
    for stature in [1.2, 2.2] {
        clips.push(made("walk", &[("stature", stature)]));
        clips.push(made("slap", &[("stature", stature), ("seconds", 2.4)]));
    }
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

#[test]
fn planted_feet_stay_put_in_a_walk() {
    for clip in many().into_iter().filter(|clip| clip.name == "walk") {
        let strikes = strike_phases(&clip);
        for (foot, toe, phases) in [
            (JointRole::LeftFoot, JointRole::LeftToe, &strikes[0]),
            (JointRole::RightFoot, JointRole::RightToe, &strikes[1]),
        ] {
            let (ankles, toes) = (trajectory(&clip, foot), trajectory(&clip, toe));
            for frame in 1..clip.frame_count() {
                let (before, now) = (phases[frame - 1], phases[frame]);
                if before < now && now <= HEEL_OFF {
                    assert!(horizontal_distance(ankles[frame - 1], ankles[frame]) < 1e-3 / FPS);
                }
                if FLAT <= before && before < now && now <= TOE_OFF {
                    assert!(toes[frame - 1].distance(toes[frame]) < 1e-3 / FPS);
                }
            }
        }
    }
}

/// Phase of the left and of the right foot in each frame, from its strike, in cycles.
fn strike_phases(clip: &Clip) -> [Vec<f64>; 2] {
    let speed = (clip.root_positions[1].z - clip.root_positions[0].z) * FPS;
    let stature = end_site(
        clip,
        &clip.skeleton.forward_kinematics(&clip.skeleton.rest_pose()),
        joint(clip, JointRole::Head),
    );
    let gait = Gait::new(Body::new(stature.expect("the head ends").y), speed, FPS);
    [0.0, 0.5].map(|delay| {
        (0..clip.frame_count())
            .map(|frame| (frame as f64 / FPS / gait.period - delay + 1e-9).rem_euclid(1.0))
            .collect()
    })
}

#[test]
fn threshold_rules_see_alternating_stances() {
    for clip in many().into_iter().filter(|clip| clip.name == "walk") {
        let [left, right] = [JointRole::LeftFoot, JointRole::RightFoot].map(|foot| down(&clip, foot, 0.08));
        let [left_toe, right_toe] =
            [JointRole::LeftToe, JointRole::RightToe].map(|toe| down(&clip, toe, 0.05));
        let frames = clip.frame_count() - 1;
        for frame in 0..frames {
            assert!(left[frame] || right[frame] || left_toe[frame] || right_toe[frame], "{frame} flies");
        }
        for contact in [left, right, left_toe, right_toe] {
            let share = contact[..frames].iter().filter(|down| **down).count() as f64 / frames as f64;
            assert!((0.3..0.8).contains(&share), "on the ground {share} of the time");
        }
    }
}

/// Frames in which a joint is low and slow, as contact detection sees it.
fn down(clip: &Clip, role: JointRole, height: f64) -> Vec<bool> {
    let path = trajectory(clip, role);
    let lowest = path.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    path.windows(2).map(|pair| pair[0].y < lowest + height && pair[0].distance(pair[1]) * FPS < 0.4).collect()
}

#[test]
fn a_walk_cycle_closes_in_pose_and_speed() {
    for speed in [0.5, 1.2, 1.8] {
        let clip = made("walk", &[("speed", speed)]);
        let gait = Gait::new(Body::new(1.75), speed, FPS);
        let cycle = floor_index(gait.period * FPS + 0.5);
        assert!((gait.period * FPS - cycle as f64).abs() < ROUNDING);
        let (first, last) = (clip.pose(SourceFrame(0)), clip.pose(SourceFrame::from_usize(cycle)));
        let second = clip.pose(SourceFrame(1));
        let beyond = clip.pose(SourceFrame::from_usize(cycle + 1));
        assert!(turn_between(&first.rotations, &last.rotations) < 1e-6);
        assert!(turn_between(&second.rotations, &beyond.rotations) < 1e-6);
        assert!(((last.root - first.root) - (beyond.root - second.root)).length() < ROUNDING);
        assert!((last.root.z - speed * gait.period).abs() < ROUNDING);
    }
    assert_eq!(made("walk", &[]).frame_count(), 103);
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
                assert!(lowest > sole - 0.005, "{} {frame}: joint {index} at {lowest}", clip.name);
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
                    (0.0..2.4).contains(&(flexion + 1e-9)),
                    "{role:?} of {} {frame}: {flexion}",
                    clip.name
                );
            }
        }
    }
}

#[test]
fn joints_turn_no_faster_than_people_can() {
    /// Radians per second; the slapping arm may be faster.
    const FASTEST: f64 = 12.0;
    const FASTEST_SLAP: f64 = 20.0;
    for clip in many() {
        let joints = clip.skeleton.joints.len();
        for (k, pair) in clip.rotations.windows(joints + 1).enumerate() {
            let speed = log(pair[0].inverse() * pair[joints]).length() * FPS;
            let slapping = clip.name == "slap" && (body::ARMS[1]..body::ARMS[1] + 4).contains(&(k % joints));
            let limit = if slapping { FASTEST_SLAP } else { FASTEST };
            let joint = &clip.skeleton.joints[k % joints].name;
            assert!(speed < limit, "{joint} of {} at {}: {speed} rad/s", clip.name, k / joints);
        }
    }
}

#[test]
fn standing_clips_stand_and_end_as_they_began() {
    for clip in [made("idle", &[]), made("slap", &[]), made("idle", &[("seconds", 1.0)])] {
        for role in [JointRole::LeftFoot, JointRole::RightFoot, JointRole::LeftToe, JointRole::RightToe] {
            let path = trajectory(&clip, role);
            assert!(path.iter().all(|p| p.distance(path[0]) < ROUNDING));
        }
        let steps = clip.root_positions.windows(2);
        assert!(steps.map(|pair| pair[0].distance(pair[1]) * FPS).all(|speed| speed < 0.10));
        let last = clip.pose(SourceFrame::from_usize(clip.frame_count() - 1));
        assert!(turn_between(&clip.pose(SourceFrame(0)).rotations, &last.rotations) < 1e-6);
    }
    let (idle, slap) = (made("idle", &[]), made("slap", &[]));
    assert!(turn_between(&idle.pose(SourceFrame(0)).rotations, &slap.pose(SourceFrame(0)).rotations) < 1e-6);
}

#[test]
fn a_slap_hits_ahead_and_to_the_right_at_shoulder_height() {
    let clip = made("slap", &[]);
    let hit = clip.events["hit"].as_usize();
    let hand = joint(&clip, JointRole::RightHand);
    let frames = world(&clip, hit);
    let fingertips = end_site(&clip, &frames, hand).expect("the hand ends");
    let palm = frames[hand].position.lerp(fingertips, 0.5);
    assert!(palm.distance(DVec3::new(-0.2, 1.48, 0.5)) < 0.04, "{palm}");
    let reach: Vec<f64> = trajectory(&clip, JointRole::RightHand).iter().map(|p| p.z).collect();
    let farthest = reach.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(reach[hit] > farthest - 0.01, "{} of {farthest}", reach[hit]);
}

#[test]
fn arms_and_legs_take_turns() {
    let clip = made("walk", &[]);
    let hand = trajectory(&clip, JointRole::LeftHand);
    let foot = trajectory(&clip, JointRole::RightFoot);
    let product: f64 = (0..clip.frame_count() - 1)
        .map(|k| (hand[k].z - clip.root_positions[k].z) * (foot[k].z - clip.root_positions[k].z + 0.05))
        .sum();
    assert!(product > 0.0);
}

#[test]
fn mistakes_name_what_is_known() {
    let wrong = |name: &str, parameter: &str, value: f64| {
        generate(name, &BTreeMap::from([(parameter.to_owned(), value)])).expect_err("a mistake").to_string()
    };
    assert_eq!(
        wrong("wlak", "speed", 1.0),
        "no generated clip \"wlak\"; did you mean \"walk\"? (known: \"walk\", \"idle\", \"slap\")"
    );
    assert_eq!(
        wrong("walk", "sped", 1.0),
        "generated clip \"walk\" has no parameter \"sped\"; did you mean \"speed\"? (known: \"speed\", \"seconds\", \"start\", \"stop\", \"stature\")"
    );
    assert_eq!(wrong("walk", "speed", 9.0), "speed = 9 of generated clip \"walk\" is outside 0.5 to 1.8 m/s");
    assert!(wrong("idle", "seconds", f64::NAN).contains("NaN"));
}

#[test]
fn every_default_is_in_its_range_and_every_event_in_its_clip() {
    for info in names() {
        let clip = made(info.name, &[]);
        assert!(info.parameters.iter().all(|p| p.range.0 <= p.default && p.default <= p.range.1));
        assert!(info.events.iter().all(|event| clip.events[*event].as_usize() < clip.frame_count()));
        assert_eq!(clip.events.len(), info.events.len());
        let _root: JointId = clip.skeleton.joint_of(JointRole::Pelvis).expect("a pelvis");
    }
}
