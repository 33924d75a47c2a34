//! Hands, heads and feet of a generated walk brought to targets.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use proptest::prelude::*;

use super::*;
use crate::clip::Clip;
use crate::clip::builtin::generate;
use crate::clip::working::{WORKING_STEP, WorkingClip};
use crate::full_body::chain::{arms, world_frame};
use crate::full_body::plan::Jerks;
use crate::full_body::plants::FEET;
use crate::full_body::report::TOLERATED;
use crate::geometry::{log, yaw};
use crate::index::{JointId, SourceFrame};
use crate::skeleton::JointRole;

/// Nothing changes farther than this from a constraint, frames.
pub(super) const FAR: usize = 32;

pub(super) fn walk(seconds: f64) -> (Skeleton, BodyInput) {
    let clip = generate("walk", &[("seconds".to_owned(), seconds)].into()).expect("a known clip");
    input_of("walk", clip)
}

/// A clip that nothing is done to.
pub(super) fn input_of(name: &str, clip: Clip) -> (Skeleton, BodyInput) {
    let last = SourceFrame::from_usize(clip.frame_count() - 1);
    let working = WorkingClip::new(name, Arc::new(clip), SourceFrame(0), last);
    let rest: Vec<Pose> = (0..working.frame_count()).map(|frame| working.pose(frame as f64)).collect();
    let input = BodyInput {
        times: (0..rest.len()).map(|frame| frame as f64 * WORKING_STEP).collect(),
        moved: rest.clone(),
        rest,
        contacts: working.contacts.clone(),
        effectors: Vec::new(),
        seams: Seams::default(),
        source: Jerks::default(),
    };
    ((*working.clip.skeleton).clone(), input)
}

pub(super) fn joint(skeleton: &Skeleton, role: JointRole) -> JointId {
    skeleton.joint_of(role).expect("the generated body has all joints")
}

/// `role` held for `frames` frames from `first` on where it is at `first`, shifted.
pub(super) fn held(
    skeleton: &Skeleton,
    input: &BodyInput,
    role: JointRole,
    at: (usize, usize),
    shift: DVec3,
) -> Effector {
    let joint = joint(skeleton, role);
    let position = world_frame(skeleton, &input.moved[at.0], joint).position + shift;
    Effector { joint, first: at.0, targets: vec![Target { position, rotation: None }; at.1], holds: false }
}

pub(super) fn miss(skeleton: &Skeleton, refined: &Refined, end: &Effector) -> f64 {
    let samples = end.first..end.first + end.targets.len();
    samples.filter_map(|at| end.shortfall(skeleton, &refined.poses[at], at)).fold(0.0, f64::max)
}

#[test]
fn a_hand_is_where_it_must_be_and_all_is_as_it_was_far_away() {
    let (skeleton, mut input) = walk(8.0);
    let end = held(&skeleton, &input, JointRole::LeftHand, (120, 6), DVec3::new(0.1, 0.3, 0.1));
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &end) < 1e-9);
    assert!(refined.report.shortfalls.is_empty());
    for at in (0..120 - FAR).chain(126 + FAR..input.times.len()) {
        assert_eq!(refined.poses[at], input.moved[at], "sample {at}");
    }
}

#[test]
fn the_way_to_a_target_and_back_is_smooth() {
    /// What the hand of a walk adds to its own acceleration on its way, m/s²: 0.3 m in a quarter of a second and back.
    const GENTLE: f64 = 40.0;
    let (skeleton, mut input) = walk(8.0);
    input.effectors.push(held(&skeleton, &input, JointRole::LeftHand, (120, 1), DVec3::new(0.0, 0.3, 0.1)));
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    let hand = joint(&skeleton, JointRole::LeftHand);
    let places: Vec<DVec3> =
        refined.poses.iter().map(|pose| world_frame(&skeleton, pose, hand).position).collect();
    for (at, three) in places.windows(3).enumerate() {
        let acceleration = (three[0] - three[1] * 2.0 + three[2]) / (WORKING_STEP * WORKING_STEP);
        assert!(acceleration.length() < GENTLE, "sample {at}: {}", acceleration.length());
    }
}

#[test]
fn a_hand_takes_the_rotation_it_must_have() {
    let (skeleton, mut input) = walk(4.0);
    let mut end = held(&skeleton, &input, JointRole::RightHand, (60, 3), DVec3::new(0.0, 0.2, 0.1));
    let rotation = DQuat::from_rotation_x(0.8) * yaw(0.4);
    for target in &mut end.targets {
        target.rotation = Some(rotation);
    }
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &end) < 1e-9);
    for at in 60..63 {
        let shown = world_frame(&skeleton, &refined.poses[at], end.joint).rotation;
        assert!(log(shown.inverse() * rotation).length() < 1e-9);
    }
}

#[test]
fn the_body_follows_a_hand_that_arms_do_not_reach_and_the_feet_stay() {
    let (skeleton, mut input) = walk(8.0);
    let shoulder = joint(&skeleton, JointRole::LeftShoulder);
    let at = world_frame(&skeleton, &input.moved[100], shoulder).position;
    let arm: f64 = {
        let chain = arms(&skeleton)[0].expect("the generated body has arms");
        chain.place(&skeleton, &input.moved[100]).limb.lengths().iter().sum()
    };
    let target =
        Target { position: at + DVec3::new(0.3, -0.2, 0.2).normalize() * (arm + 0.04), rotation: None };
    let end = Effector {
        joint: joint(&skeleton, JointRole::LeftHand),
        first: 100,
        targets: vec![target],
        holds: false,
    };
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &end) < TOLERATED, "{}", miss(&skeleton, &refined, &end));
    assert!(refined.report.root_shift > 0.04 && refined.report.root_shift < 0.2);
    assert!(refined.report.shortfalls.is_empty(), "{:?}", refined.report.shortfalls);
    for plant in &refined.report.plants {
        assert!(plant.drift < plant.captured_drift + TOLERATED, "{plant:?}");
    }
}

#[test]
fn what_is_out_of_reach_is_told_with_the_distance_that_is_missing() {
    let (skeleton, mut input) = walk(4.0);
    let end = held(&skeleton, &input, JointRole::LeftHand, (60, 1), DVec3::new(0.0, 3.0, 0.0));
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    let told = refined.report.shortfalls.iter().find(|told| told.joint == end.joint).expect("it is 3 m up");
    assert_eq!(told.sample, 60);
    assert!((told.metres - miss(&skeleton, &refined, &end)).abs() < 1e-12);
    assert!(told.metres > 1.5 && told.metres < 3.0);
    assert!(refined.poses.iter().all(|pose| pose.root.is_finite()));
}

#[test]
fn a_head_goes_where_it_must_with_the_body() {
    let (skeleton, mut input) = walk(4.0);
    let end = held(&skeleton, &input, JointRole::Head, (60, 3), DVec3::new(0.03, -0.1, 0.0));
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &end) < TOLERATED, "{}", miss(&skeleton, &refined, &end));
    assert!(refined.report.plants.iter().all(|plant| plant.drift < plant.captured_drift + TOLERATED));
}

#[test]
fn a_foot_goes_where_it_must() {
    let (skeleton, mut input) = walk(4.0);
    let swinging = (40..80)
        .find(|&at| input.contacts[at..at + 6].iter().all(|contact| !contact.left_heel && !contact.left_toe))
        .expect("feet swing");
    let end = held(&skeleton, &input, JointRole::LeftFoot, (swinging + 2, 1), DVec3::new(0.0, 0.1, 0.0));
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &end) < 1e-9);
    assert!(refined.report.plants.iter().all(|plant| plant.drift < plant.captured_drift + TOLERATED));
}

#[test]
fn every_joint_goes_where_it_must_at_the_first_and_at_the_last_sample() {
    let (skeleton, input) = walk(2.0);
    let last = input.times.len() - 1;
    for (index, _) in skeleton.joints.iter().enumerate() {
        for at in [0, last] {
            let joint = JointId::from_usize(index);
            let position = world_frame(&skeleton, &input.moved[at], joint).position;
            let targets = vec![Target { position, rotation: None }];
            let mut input = input.clone();
            input.effectors.push(Effector { joint, first: at, targets, holds: false });
            let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
            let miss = miss(&skeleton, &refined, &input.effectors[0]);
            assert!(miss < TOLERATED, "joint {index} at sample {at}: {miss}");
        }
    }
}

/// Somebody who stands for three seconds.
pub(super) fn standing() -> (Skeleton, BodyInput) {
    let clip = generate("idle", &[("seconds".to_owned(), 3.0)].into()).expect("a known clip");
    input_of("idle", clip)
}

#[test]
fn a_foot_that_bears_leaves_its_plant_for_a_target_and_comes_back_to_it() {
    /// To half a metre away and back in a third of a second each: the foot is at most 2.4 m/s fast, and a knee that sets out
    /// nearly straight turns by 13° from frame to frame; at once it would be 70°.
    const GENTLE: f64 = 15.0 * std::f64::consts::PI / 180.0;
    for (role, side) in [(JointRole::LeftFoot, 1.0), (JointRole::RightFoot, -1.0)] {
        for frames in [1, 20] {
            let (skeleton, mut input) = standing();
            let end = held(&skeleton, &input, role, (40, frames), DVec3::new(0.2 * side, 0.3, 0.4));
            input.effectors.push(end.clone());
            let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
            assert!(miss(&skeleton, &refined, &end) < TOLERATED);
            assert!(refined.report.shortfalls.is_empty(), "{:?}", refined.report.shortfalls);
            for (sample, pair) in refined.poses.windows(2).enumerate() {
                for (a, b) in pair[0].rotations.iter().zip(&pair[1].rotations) {
                    let angle = log(a.inverse() * *b).length();
                    assert!(angle < GENTLE, "{role:?} {frames}, sample {sample}: {angle}");
                }
            }
            let points = FEET[usize::from(role == JointRole::RightFoot)].map(|point| point.expect("feet"));
            for (sample, planted) in refined.planted.iter().enumerate() {
                let is_away = (31..49 + frames).contains(&sample);
                for point in points {
                    assert_eq!(planted.at(point), !is_away && input.contacts[sample].at(point), "{sample}");
                }
            }
            for plant in &refined.report.plants {
                assert!(plant.drift < plant.captured_drift + TOLERATED, "{plant:?}");
            }
        }
    }
}

#[test]
fn a_foot_that_must_be_where_it_stands_goes_on_standing() {
    let (skeleton, mut input) = standing();
    input.effectors.push(held(&skeleton, &input, JointRole::LeftFoot, (40, 1), DVec3::ZERO));
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert_eq!(refined.planted, input.contacts);
}

#[test]
fn moments_between_frames_are_treated_like_frames() {
    let (skeleton, mut input) = walk(4.0);
    let at = 60;
    let between = |a: &Pose, b: &Pose| Pose { root: a.root.lerp(b.root, 0.3), ..a.clone() };
    let time = input.times[at] + 0.3 * WORKING_STEP;
    let pose = between(&input.rest[at], &input.rest[at + 1]);
    input.times.insert(at + 1, time);
    input.rest.insert(at + 1, pose.clone());
    input.moved.insert(at + 1, pose);
    input.contacts.insert(at + 1, input.contacts[at]);
    let end = held(&skeleton, &input, JointRole::RightHand, (at + 1, 1), DVec3::new(0.0, 0.2, 0.1));
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &end) < 1e-9);
}

#[test]
fn an_untouched_walk_stays_as_it_is_to_the_last_bit() {
    let (skeleton, input) = walk(4.0);
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert_eq!(refined.poses, input.moved);
    assert_eq!(refined.report.largest_change, None);
}

#[test]
fn a_body_without_legs_and_arms_comes_out_as_it_went_in() {
    let (skeleton, input) = walk(1.0);
    let trunk = Skeleton { joints: skeleton.joints[..1].to_vec() };
    let cut = |poses: &[Pose]| -> Vec<Pose> {
        poses.iter().map(|pose| Pose { rotations: pose.rotations[..1].to_vec(), ..pose.clone() }).collect()
    };
    let input = BodyInput { rest: cut(&input.rest), moved: cut(&input.moved), ..input };
    assert_eq!(refine(&trunk, &input, PlantMode::Pinned).poses, input.moved);
}

#[test]
fn an_extra_moment_hardly_changes_the_frames_beside_it() {
    /// Far less than anybody sees; the kinks that interpolation has between frames are not the frames' own. Radians: 0.5°.
    const UNSEEN: f64 = 0.009;
    let (skeleton, mut input) = walk(4.0);
    for pose in &mut input.moved {
        pose.root.z *= 1.3;
    }
    let without = refine(&skeleton, &input, PlantMode::AsCaptured);
    for at in [31, 47, 60, 62, 75] {
        let mut more = input.clone();
        let middle = |poses: &[Pose]| Pose {
            root: poses[at].root.lerp(poses[at + 1].root, 0.5),
            rotations: poses[at]
                .rotations
                .iter()
                .zip(&poses[at + 1].rotations)
                .map(|(from, to)| crate::geometry::slerp(*from, *to, 0.5))
                .collect(),
            offsets: Vec::new(),
        };
        more.times.insert(at + 1, input.times[at] + 0.5 * WORKING_STEP);
        more.rest.insert(at + 1, middle(&input.rest));
        more.moved.insert(at + 1, middle(&input.moved));
        more.contacts.insert(at + 1, input.contacts[at]);
        let mut with = refine(&skeleton, &more, PlantMode::AsCaptured).poses;
        with.remove(at + 1);
        for (sample, (a, b)) in without.poses.iter().zip(&with).enumerate() {
            for (from, to) in a.rotations.iter().zip(&b.rotations) {
                let angle = log(from.inverse() * *to).length();
                assert!(angle < UNSEEN, "moment {at}, sample {sample}: {angle}");
            }
        }
    }
}

/// Rounding of a bone's length, metres.
const BONES: f64 = 1e-9;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn whatever_is_asked_for_poses_are_finite_and_bones_keep_their_lengths(
        stretch in prop::array::uniform3(-3.0..3.0_f64),
        turn in -0.3..0.3_f64,
        labels in prop::collection::vec(0..16_u8, 61),
        ends in prop::collection::vec((0..21_u32, 0..55_usize, prop::array::uniform3(-2.0..2.0_f64)), 0..4),
        mode in prop::sample::select(&[PlantMode::AsCaptured, PlantMode::Pinned, PlantMode::Whole]),
    ) {
        let (skeleton, mut input) = walk(2.0);
        for (at, pose) in input.moved.iter_mut().enumerate() {
            pose.root *= DVec3::from_array(stretch);
            pose.rotations[0] = yaw(turn * at as f64) * pose.rotations[0];
        }
        for (contact, label) in input.contacts.iter_mut().zip(&labels) {
            for (bit, point) in crate::clip::contacts::ContactPoint::FEET.into_iter().enumerate() {
                contact.set(point, label & (1 << bit) != 0);
            }
        }
        for (joint, first, place) in ends {
            let target = Target { position: DVec3::from_array(place), rotation: Some(yaw(place[0])) };
            input.effectors.push(Effector { joint: JointId(joint), first, targets: vec![target; 7], holds: false });
        }
        let refined = refine(&skeleton, &input, mode);
        for (before, after) in input.moved.iter().zip(&refined.poses) {
            prop_assert!(after.root.is_finite());
            let (before, after) = (skeleton.forward_kinematics(before), skeleton.forward_kinematics(after));
            for (index, joint) in skeleton.joints.iter().enumerate() {
                let Some(parent) = joint.parent else { continue };
                let length = |frames: &[crate::skeleton::JointFrame]| {
                    frames[index].position.distance(frames[parent.as_usize()].position)
                };
                prop_assert!((length(&before) - length(&after)).abs() < BONES);
            }
        }
    }
}

/// Height of the lowest knee and of the hips, metres.
fn lowest_knee_and_hip(skeleton: &Skeleton, poses: &[Pose]) -> f64 {
    let legs = crate::full_body::chain::legs(skeleton).into_iter().flatten();
    let heights = legs.flat_map(|leg| {
        poses.iter().map(move |pose| {
            let limb = leg.place(skeleton, pose).limb;
            limb.middle.y.min(limb.upper.y)
        })
    });
    heights.fold(f64::INFINITY, f64::min)
}

/// Knees stay this far above the ground, metres: as high as ankles, but for what the heel comes up.
const KNEES: f64 = 0.05;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn knees_and_hips_stay_above_the_ground_however_low_a_hand_must_go(
        place in prop::array::uniform3(-1.0..1.0_f64),
        down in -0.5..1.2_f64,
        at in 20..60_usize,
        frames in 1..20_usize,
        is_walking in any::<bool>(),
    ) {
        let (skeleton, mut input) = if is_walking { walk(3.0) } else { standing() };
        let under = input.moved[at].root.with_y(down);
        let position = under + DVec3::new(place[0], 0.0, place[2]);
        let targets = vec![Target { position, rotation: None }; frames];
        let joint = joint(&skeleton, JointRole::RightHand);
        input.effectors.push(Effector { joint, first: at, targets, holds: false });
        let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
        let lowest = lowest_knee_and_hip(&skeleton, &refined.poses);
        prop_assert!(lowest > KNEES, "{lowest}");
        let miss = miss(&skeleton, &refined, &input.effectors[0]);
        let told = refined.report.shortfalls.iter().filter(|told| told.joint == joint);
        let told = told.map(|told| told.metres).fold(0.0, f64::max);
        prop_assert!((if miss > TOLERATED { miss } else { 0.0 } - told).abs() < BONES, "{miss} {told}");
        let foot = refined.report.shortfalls.iter().find(|told| told.joint != joint);
        prop_assert!(foot.is_none(), "{foot:?}");
    }
}
