//! What turning on the spot promises.

use super::super::mass::center_of_mass;
use super::walks::{contacts, slide};
use super::*;

/// Both clips, turned little and much to either side, by small and large bodies.
pub(super) fn variants() -> Vec<Clip> {
    let turns = [(-180.0, 1.2), (-60.0, 2.2), (0.0, 1.75), (45.0, 1.2), (135.0, 1.75), (180.0, 2.2)];
    let clip = |name, (angle, stature)| made(name, &[("angle", angle), ("stature", stature)]);
    ["turn", "carry_turn"].iter().flat_map(|name| turns.map(|turn| clip(name, turn))).collect()
}

#[test]
fn who_turns_comes_to_look_where_asked_and_stays_where_they_stood() {
    for angle in [-180.0, -100.0, 0.0, 30.0, 90.0, 180.0] {
        for name in ["turn", "carry_turn"] {
            let clip = made(name, &[("angle", angle)]);
            let last = clip.frame_count() - 1;
            let [first, last] = [0, last].map(|frame| clip.pose(SourceFrame::from_usize(frame)));
            let turned = DQuat::from_rotation_y(angle.to_radians());
            let gap = turn_between(&[turned * first.rotations[0]], &last.rotations[..1]);
            assert!(gap < 1e-6, "{name} by {angle}: {gap}");
            assert!(turn_between(&first.rotations[1..], &last.rotations[1..]) < 1e-6, "{name} by {angle}");
            assert!(first.root.distance(last.root) < ROUNDING);
        }
    }
    let stand = made("idle", &[]).pose(SourceFrame(0)).rotations;
    assert!(turn_between(&made("turn", &[]).pose(SourceFrame(0)).rotations, &stand) < 1e-6);
}

#[test]
fn feet_step_in_turn_and_do_not_slide() {
    for clip in variants() {
        assert!(slide(&clip) < 1e-3, "{}: {} m/s", clip.name, slide(&clip));
        let [left, right] = contacts(&clip);
        assert!(
            left.iter().zip(&right).all(|(left, right)| left.any() || right.any()),
            "{} flies",
            clip.name
        );
        assert!([&left, &right].iter().all(|foot| foot.iter().any(|contact| !contact.any())));
    }
}

#[test]
fn the_inner_foot_opens_the_turn() {
    for (angle, inner) in [(90.0, 0), (-90.0, 1)] {
        let contacts = contacts(&made("turn", &[("angle", angle)]));
        let lifts = contacts.map(|foot| foot.iter().position(|contact| !contact.any()));
        assert!(lifts[inner] < lifts[1 - inner], "{lifts:?}");
    }
}

#[test]
fn weight_is_on_the_foot_that_stands() {
    let (clip, body) = (made("turn", &[("angle", 120.0)]), Body::new(1.75));
    let [left, right] = contacts(&clip);
    let ankles = [JointRole::LeftFoot, JointRole::RightFoot].map(|foot| trajectory(&clip, foot));
    // Towards the standing foot from the middle between both: mean over all steps.
    let towards = (0..clip.frame_count()).filter_map(|frame| {
        let (standing, lifted) = match (left[frame].any(), right[frame].any()) {
            (true, false) => (ankles[0][frame], ankles[1][frame]),
            (false, true) => (ankles[1][frame], ankles[0][frame]),
            _ => return None,
        };
        let center = center_of_mass(&body, &clip.pose(SourceFrame::from_usize(frame)));
        let way = (standing - lifted).with_y(0.0);
        Some((center - standing.midpoint(lifted)).dot(way) / way.length())
    });
    let towards: Vec<f64> = towards.collect();
    let mean = towards.iter().sum::<f64>() / towards.len() as f64;
    assert!(mean > 0.01, "{mean} m");
}

#[test]
fn who_turns_with_a_box_holds_it_level_and_as_picked_up() {
    let clip = made("carry_turn", &[("angle", -120.0), ("width", 0.3)]);
    let hands = [JointRole::LeftHand, JointRole::RightHand].map(|hand| trajectory(&clip, hand));
    for (left, right) in hands[0].iter().zip(&hands[1]) {
        assert!((left.distance(*right) - 0.3).abs() < ROUNDING && (left.y - right.y).abs() < ROUNDING);
    }
    let picked = made("pick_up", &[("width", 0.3)]);
    let last = picked.frame_count() - 1;
    for (hand, role) in hands.iter().zip([JointRole::LeftHand, JointRole::RightHand]) {
        let before = trajectory(&picked, role)[last] - picked.root_positions[last];
        assert!((hand[0] - clip.root_positions[0]).distance(before) < 0.01);
    }
}
