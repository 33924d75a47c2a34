//! Elbows and knees of a generated body brought to targets, and wrists that stay as hands are brought.

use glam::{DQuat, DVec3};

use super::tests::{FAR, held, joint, miss, standing, walk};
use super::*;
use crate::full_body::chain::{arms, world_frame};
use crate::full_body::report::TOLERATED;
use crate::full_body::wrist::{SWING, TWIST, Wrist};
use crate::geometry::log;
use crate::index::JointId;
use crate::skeleton::JointRole;

/// Rounding of some turns, metres and radians.
const ROUNDING: f64 = 1e-9;
/// Rounding of an angle between vectors that are nearly parallel, radians.
const ANGLES: f64 = 1e-7;

/// `role` at `direction` from `from`, as far as the bone between them is long and `more`, for `frames` from `at` on.
fn swung(
    (skeleton, input): (&Skeleton, &BodyInput),
    (from, role): (JointRole, JointRole),
    (at, frames): (usize, usize),
    (direction, more): (DVec3, f64),
) -> Effector {
    let place = |role, at: usize| world_frame(skeleton, &input.moved[at], joint(skeleton, role)).position;
    let target = |at: usize| {
        let length = place(from, at).distance(place(role, at));
        let position = place(from, at) + direction.normalize() * (length + more);
        Target { position, rotation: None }
    };
    Effector {
        joint: joint(skeleton, role),
        first: at,
        targets: (at..at + frames).map(target).collect(),
        holds: false,
    }
}

const ELBOW: (JointRole, JointRole) = (JointRole::LeftShoulder, JointRole::LeftElbow);
const KNEE: (JointRole, JointRole) = (JointRole::LeftHip, JointRole::LeftKnee);

#[test]
fn an_elbow_goes_where_the_upper_arm_takes_it_and_the_body_stays() {
    let (skeleton, mut input) = walk(8.0);
    let end = swung((&skeleton, &input), ELBOW, (120, 6), (DVec3::new(0.4, -0.2, 0.6), 0.0));
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &end) < ROUNDING, "{}", miss(&skeleton, &refined, &end));
    assert!(refined.report.shortfalls.is_empty());
    assert_eq!(refined.report.root_shift, 0.0);
    for (at, (before, after)) in input.moved.iter().zip(&refined.poses).enumerate() {
        let is_far = !(120 - FAR..126 + FAR).contains(&at);
        for (index, (before, after)) in before.rotations.iter().zip(&after.rotations).enumerate() {
            let is_upper = index == joint(&skeleton, JointRole::LeftShoulder).as_usize();
            let turn = log(before.inverse() * *after).length();
            assert!(is_upper && !is_far || turn < ROUNDING, "joint {index} at {at}: {turn}");
            assert!(!is_far || before == after, "sample {at}");
        }
    }
}

#[test]
fn the_body_follows_an_elbow_that_its_bone_does_not_reach() {
    let (skeleton, mut input) = standing();
    let end = swung((&skeleton, &input), ELBOW, (40, 20), (DVec3::new(0.6, 0.1, 0.5), 0.05));
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &end) < TOLERATED, "{}", miss(&skeleton, &refined, &end));
    assert!(refined.report.root_shift > 0.04 && refined.report.root_shift < 0.1);
    assert!(refined.report.plants.iter().all(|plant| plant.drift < plant.captured_drift + TOLERATED));
}

#[test]
fn what_an_elbow_or_a_knee_misses_is_told() {
    for limb in [ELBOW, KNEE] {
        let (skeleton, mut input) = standing();
        let end = swung((&skeleton, &input), limb, (40, 5), (DVec3::new(0.6, 1.0, 0.5), 3.0));
        input.effectors.push(end.clone());
        let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
        let told: Vec<&Shortfall> = refined.report.shortfalls.iter().collect();
        assert!(told.len() == 1 && told[0].joint == end.joint, "{told:?}");
        assert!((told[0].metres - miss(&skeleton, &refined, &end)).abs() < ROUNDING);
        assert!(told[0].metres > 1.0 && told[0].metres < 3.0, "{told:?}");
    }
}

#[test]
fn a_knee_takes_its_foot_along_and_the_foot_comes_back_to_where_it_stood() {
    /// From one sample to the next: 60° in a third of a second and back, fastest in the middle.
    const GENTLE: f64 = 12.0 * std::f64::consts::PI / 180.0;
    for (mode, more) in
        [(PlantMode::AsCaptured, 0.0), (PlantMode::Pinned, 0.0), (PlantMode::AsCaptured, 0.02)]
    {
        let (skeleton, mut input) = standing();
        let end = swung((&skeleton, &input), KNEE, (40, 8), (DVec3::new(0.1, -0.6, 0.8), more));
        input.effectors.push(end.clone());
        let refined = refine(&skeleton, &input, mode);
        assert!(miss(&skeleton, &refined, &end) < TOLERATED, "{}", miss(&skeleton, &refined, &end));
        assert!(refined.report.shortfalls.is_empty(), "{:?}", refined.report.shortfalls);
        for (at, planted) in refined.planted.iter().enumerate() {
            let is_away = (31..57).contains(&at);
            assert!(!is_away || !planted.left_heel && !planted.left_toe, "sample {at}");
        }
        assert!(refined.report.plants.iter().any(|plant| plant.last > 60), "it stands again");
        assert!(refined.report.plants.iter().all(|plant| plant.drift < plant.captured_drift + TOLERATED));
        for (at, pair) in refined.poses.windows(2).enumerate() {
            for (a, b) in pair[0].rotations.iter().zip(&pair[1].rotations) {
                assert!(log(a.inverse() * *b).length() < GENTLE, "{mode:?}, sample {at}");
            }
        }
    }
}

#[test]
fn a_hand_goes_before_an_elbow_that_must_be_elsewhere() {
    let (skeleton, mut input) = walk(4.0);
    let hand = held(&skeleton, &input, JointRole::LeftHand, (60, 3), DVec3::new(0.05, 0.2, 0.1));
    input.effectors.push(hand.clone());
    input.effectors.push(swung((&skeleton, &input), ELBOW, (60, 3), (DVec3::new(0.6, 0.1, 0.5), 0.0)));
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &hand) < ROUNDING);
    assert!(refined.report.shortfalls.iter().any(|told| told.joint != hand.joint));
}

#[test]
fn a_hand_of_which_no_orientation_is_asked_goes_with_its_forearm() {
    let (skeleton, mut input) = walk(8.0);
    let end = held(&skeleton, &input, JointRole::LeftHand, (120, 6), DVec3::new(0.1, 0.5, 0.2));
    input.effectors.push(end.clone());
    let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
    assert!(miss(&skeleton, &refined, &end) < ROUNDING);
    for (before, after) in input.moved.iter().zip(&refined.poses) {
        let hand = end.joint.as_usize();
        assert!(log(before.rotations[hand].inverse() * after.rotations[hand]).length() < ROUNDING);
    }
}

#[test]
fn a_hand_asked_to_turn_farther_than_wrists_do_stops_there_and_stays_at_its_place() {
    let (skeleton, input) = walk(4.0);
    let limb = arms(&skeleton)[0].expect("the generated body has arms");
    let wrist = Wrist::of(&skeleton, &limb).expect("and wrists");
    let mut below = (0..skeleton.joints.len()).map(JointId::from_usize);
    let below = below.rfind(|joint| chain::is_below(&skeleton, *joint, limb.lower));
    for joint in [Some(limb.lower), below].into_iter().flatten() {
        let mut input = input.clone();
        let at = world_frame(&skeleton, &input.moved[60], joint);
        let position = at.position + DVec3::new(0.0, 0.3, 0.2);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let rotation = Some(DQuat::from_axis_angle(axis, 3.0) * at.rotation);
            let end =
                Effector { joint, first: 60, targets: vec![Target { position, rotation }; 4], holds: false };
            input.effectors = vec![end.clone()];
            let refined = refine(&skeleton, &input, PlantMode::AsCaptured);
            assert!(miss(&skeleton, &refined, &end) < TOLERATED, "{}", miss(&skeleton, &refined, &end));
            for (sample, pose) in refined.poses.iter().enumerate() {
                let [swing, twist] = wrist.angles(pose.rotations[limb.lower.as_usize()]);
                assert!(swing < SWING + ANGLES && twist < TWIST + ANGLES, "sample {sample}: {swing} {twist}");
            }
        }
    }
}
