//! Trunks and heads of a generated walk turned, bodies pulled too far, and feet with targets that stay above the ground.

use glam::{DQuat, DVec3};

use super::tests::{held, input_of, joint, miss, standing, walk};
use super::*;
use crate::clip::builtin::generate;
use crate::full_body::chain::{legs, world_frame};
use crate::full_body::report::TOLERATED;
use crate::full_body::trunk::{NECK, SPINE};
use crate::geometry::{log, yaw};
use crate::skeleton::JointRole;

/// Of some turns, radians.
const ROUNDING: f64 = 1e-9;

/// `role` held where it is at sample `at`, turned by `turn` radians about up.
fn turned(
    (skeleton, input): (&Skeleton, &BodyInput),
    role: JointRole,
    (at, frames): (usize, usize),
    turn: f64,
) -> Effector {
    let mut end = held(skeleton, input, role, (at, frames), DVec3::ZERO);
    let own = world_frame(skeleton, &input.moved[at], end.joint).rotation;
    end.targets.iter_mut().for_each(|target| target.rotation = Some(yaw(turn) * own));
    end
}

/// How far a joint is from how it must be turned at its first sample, radians.
fn turn_missed(skeleton: &Skeleton, refined: &Refined, end: &Effector) -> f64 {
    let own = world_frame(skeleton, &refined.poses[end.first], end.joint).rotation;
    log(own.inverse() * end.targets[0].rotation.expect("it must be turned")).length()
}

/// Farthest turn of a joint from one sample to the next beyond that of the capture, radians.
fn fastest(input: &BodyInput, refined: &Refined) -> f64 {
    let step =
        |a: &Pose, b: &Pose, joint: usize| log(a.rotations[joint].inverse() * b.rotations[joint]).length();
    let steps = refined.poses.windows(2).zip(input.moved.windows(2)).flat_map(|(after, before)| {
        let joints = 0..after[0].rotations.len();
        joints.map(|joint| step(&after[0], &after[1], joint) - step(&before[0], &before[1], joint))
    });
    steps.fold(0.0, f64::max)
}

#[test]
fn heads_trunks_and_pelvises_turn_smoothly_as_asked_and_feet_stay() {
    /// 30° to 55° in half a second, fastest in the middle.
    const GENTLE: f64 = 7.0 * std::f64::consts::PI / 180.0;
    for (role, degrees) in [
        (JointRole::Head, 55.0_f64),
        (JointRole::Neck, 30.0),
        (JointRole::Chest, 30.0),
        (JointRole::Spine, -20.0),
        (JointRole::Pelvis, 30.0),
        (JointRole::LeftShoulder, 30.0),
    ] {
        let (skeleton, mut input) = walk(4.0);
        let end = turned((&skeleton, &input), role, (60, 1), degrees.to_radians());
        input.effectors.push(end.clone());
        let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
        let missed = turn_missed(&skeleton, &refined, &end);
        assert!(missed < ROUNDING, "{role:?}: {missed}");
        assert!(miss(&skeleton, &refined, &end) < TOLERATED, "{role:?}");
        assert!(refined.report.shortfalls.is_empty(), "{role:?}: {:?}", refined.report.shortfalls);
        let fastest = fastest(&input, &refined);
        assert!(fastest < GENTLE, "{role:?}: {fastest}");
        for plant in &refined.report.plants {
            assert!(plant.drift < plant.captured_drift + TOLERATED, "{role:?}: {plant:?}");
        }
        // The body comes down for two windows beyond what is turned and pulled.
        assert_eq!(refined.poses[5], input.moved[5]);
        assert_eq!(refined.poses[115], input.moved[115]);
    }
}

#[test]
fn hands_are_at_their_places_on_a_trunk_that_turns() {
    let (skeleton, mut input) = walk(4.0);
    let chest = turned((&skeleton, &input), JointRole::Chest, (60, 4), 0.5);
    let hand = held(&skeleton, &input, JointRole::RightHand, (58, 8), DVec3::new(0.0, 0.25, 0.1));
    input.effectors = vec![hand.clone(), chest.clone()];
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &hand) < TOLERATED, "{}", miss(&skeleton, &refined, &hand));
    assert!(turn_missed(&skeleton, &refined, &chest) < ROUNDING);
}

#[test]
fn a_head_on_a_chest_that_is_turned_too_turns_its_neck_alone() {
    let (skeleton, mut input) = standing();
    let head = turned((&skeleton, &input), JointRole::Head, (40, 10), -0.9);
    let chest = turned((&skeleton, &input), JointRole::Chest, (45, 10), 0.5);
    input.effectors = vec![head.clone(), chest.clone()];
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(turn_missed(&skeleton, &refined, &head) < ROUNDING);
    assert!(turn_missed(&skeleton, &refined, &chest) < ROUNDING);
}

#[test]
fn heads_turn_no_farther_than_necks_and_spines_do() {
    let (skeleton, mut input) = standing();
    let end = turned((&skeleton, &input), JointRole::Head, (40, 5), 3.0);
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    let missed = turn_missed(&skeleton, &refined, &end);
    assert!((3.0 - NECK - SPINE - 0.1..3.0 - NECK).contains(&missed), "{missed}");
    let chest = world_frame(&skeleton, &refined.poses[40], joint(&skeleton, JointRole::Chest)).rotation;
    let before = world_frame(&skeleton, &input.moved[40], joint(&skeleton, JointRole::Chest)).rotation;
    assert!(log(before.inverse() * chest).length() < SPINE + ROUNDING);
}

/// Largest speed that is added to the root, m/s.
fn pull_speed(input: &BodyInput, refined: &Refined) -> f64 {
    let shifts: Vec<DVec3> =
        refined.poses.iter().zip(&input.moved).map(|(after, before)| after.root - before.root).collect();
    let steps = shifts.windows(2).zip(input.times.windows(2));
    steps.map(|(shift, time)| shift[1].distance(shift[0]) / (time[1] - time[0])).fold(0.0, f64::max)
}

#[test]
fn nobody_is_pulled_faster_and_farther_than_people_go_by_what_is_out_of_reach() {
    /// What a pull has of its own, and what it loses where it would be faster, m/s.
    const FASTEST: f64 = 5.0;
    let clips = ["walk", "run", "jump", "idle", "back_flip", "sit_down"];
    let roles = [JointRole::RightHand, JointRole::LeftKnee, JointRole::Head, JointRole::LeftFoot];
    for (clip, role) in clips.into_iter().flat_map(|clip| roles.map(|role| (clip, role))) {
        let (skeleton, input) = input_of(clip, generate(clip, &Default::default()).expect("a known clip"));
        let count = input.times.len();
        for (first, frames) in [(count / 3, count / 3), (count / 2, 1), (0, count)] {
            for shift in [DVec3::new(0.3, 0.5, -1.0), DVec3::new(4.0, 0.0, 2.0)] {
                let mut input = input.clone();
                let end = held(&skeleton, &input, role, (first, frames), shift);
                input.effectors.push(end.clone());
                let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
                let speed = pull_speed(&input, &refined);
                assert!(speed < FASTEST, "{clip} {role:?} {first} {shift}: {speed} m/s");
                assert!(refined.report.root_shift < 1.2, "{clip} {role:?}: {}", refined.report.root_shift);
                let missed = miss(&skeleton, &refined, &end);
                let told = refined.report.shortfalls.iter().filter(|told| told.joint == end.joint);
                let told = told.map(|told| told.metres).fold(0.0, f64::max);
                assert!(missed < TOLERATED || told >= missed - ROUNDING, "{missed} m, {told} m told");
            }
        }
    }
}

/// How far ankle or toe come below the lowest captured place of their own, metres.
fn sunk(skeleton: &Skeleton, input: &BodyInput, refined: &Refined) -> f64 {
    let sunk = |leg: Chain| {
        let heights = |poses: &[Pose]| {
            let places = poses.iter().map(|pose| leg.place(skeleton, pose));
            places.fold([f64::INFINITY; 2], |[ankle, toe], place| {
                [ankle.min(place.limb.lower.y), toe.min(place.end.y)]
            })
        };
        let (before, after) = (heights(&input.moved), heights(&refined.poses));
        (before[0] - after[0]).max(before[1] - after[1])
    };
    legs(skeleton).into_iter().flatten().map(sunk).fold(0.0, f64::max)
}

#[test]
fn feet_and_knees_that_must_be_elsewhere_leave_the_foot_above_the_ground() {
    let (skeleton, input) = walk(4.0);
    let ahead = (input.moved[90].root - input.moved[30].root).with_y(0.0).normalize();
    let roles = [JointRole::LeftKnee, JointRole::RightKnee, JointRole::LeftFoot, JointRole::RightFoot];
    for role in roles {
        for at in 40..72 {
            for (shift, frames) in [(ahead * 0.3, 1), (ahead * 0.3, 6), (DVec3::Y * -0.3, 3)] {
                let mut input = input.clone();
                let end = held(&skeleton, &input, role, (at, frames), shift);
                input.effectors.push(end);
                let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
                let sunk = sunk(&skeleton, &input, &refined);
                assert!(sunk < TOLERATED, "{role:?} at {at} for {frames}, {shift}: {sunk} m");
            }
        }
    }
}

#[test]
fn a_toe_that_would_be_in_the_ground_turns_up_and_its_ankle_is_where_it_must_be() {
    let (skeleton, mut input) = walk(4.0);
    let mut end = held(&skeleton, &input, JointRole::LeftFoot, (60, 4), DVec3::Y * 0.02);
    let rotation = world_frame(&skeleton, &input.moved[60], end.joint).rotation;
    let right = rotation * DVec3::X;
    let down = DQuat::from_axis_angle(right.with_y(0.0).normalize(), 1.0) * rotation;
    end.targets.iter_mut().for_each(|target| target.rotation = Some(down));
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &end) < TOLERATED, "{}", miss(&skeleton, &refined, &end));
    assert!(sunk(&skeleton, &input, &refined) < TOLERATED);
}
