//! What carrying and pushing promise beside other locomotion.

use super::walks::steady;
use super::*;

fn hands(clip: &Clip) -> [Vec<DVec3>; 2] {
    [JointRole::LeftHand, JointRole::RightHand].map(|hand| trajectory(clip, hand))
}

fn event(clip: &Clip, name: &str) -> usize {
    clip.events[name].as_usize()
}

#[test]
fn a_carried_box_keeps_its_width_and_its_level() {
    for (width, stature, turn) in
        [(0.2, 1.2, 45.0), (0.4, 1.75, 0.0), (0.5, 1.2, -45.0), (0.5, 2.2, 0.0), (0.2, 2.2, 0.0)]
    {
        let clip = made("carry", &[("width", width), ("stature", stature), ("turn", turn)]);
        let [left, right] = hands(&clip);
        let (grasp, release) = (event(&clip, "grasp"), event(&clip, "release"));
        assert!(0 < grasp && grasp + 60 < release && release < clip.frame_count() - 1);
        let apart = left[grasp].distance(right[grasp]);
        assert!((apart - width).abs() < ROUNDING, "{apart}");
        for frame in grasp..=release {
            assert!((left[frame].distance(right[frame]) - apart).abs() < ROUNDING, "{frame}");
            assert!((left[frame].y - right[frame].y).abs() < ROUNDING, "{frame}");
        }
        for frame in [0, clip.frame_count() - 1] {
            assert!(left[frame].y < left[grasp].y - 0.07 * stature, "hands hang at the ends");
        }
    }
}

#[test]
fn who_has_picked_a_box_up_carries_it_as_held() {
    let picked = made("pick_up", &[("width", 0.3)]);
    let carried = made("carry", &[("width", 0.3), ("take", 0.0)]);
    let last = picked.frame_count() - 1;
    for (before, after) in hands(&picked).iter().zip(hands(&carried)) {
        let from_root = |clip: &Clip, hand: DVec3, frame: usize| hand - clip.root_positions[frame];
        let step = from_root(&picked, before[last], last) - from_root(&carried, after[0], 0);
        assert!(step.length() < 0.01, "{step}");
    }
}

#[test]
fn what_is_pushed_moves_as_evenly_as_the_body() {
    let clip = steady("push", &[]);
    assert_eq!((event(&clip, "grasp"), event(&clip, "release")), (0, clip.frame_count() - 1));
    for hand in hands(&clip) {
        for pair in hand.windows(2) {
            assert!((pair[1] - pair[0]).distance(DVec3::Z * 0.6 / FPS) < ROUNDING);
        }
    }
}

#[test]
fn who_pushes_leans_on_it_with_bent_arms() {
    let clip = made("push", &[]);
    let (grasp, release) = (event(&clip, "grasp"), event(&clip, "release"));
    let [shoulder, elbow, wrist] =
        [JointRole::LeftShoulder, JointRole::LeftElbow, JointRole::LeftHand].map(|role| joint(&clip, role));
    for frame in grasp..=release {
        let frames = world(&clip, frame);
        let trunk = frames[shoulder].position - frames[0].position;
        assert!(trunk.z.atan2(trunk.y).to_degrees() > 12.0, "{frame}");
        assert!((1.0..1.45).contains(&frames[wrist].position.y), "at chest height");
        let upper = frames[elbow].position - frames[shoulder].position;
        let bend = upper.angle_between(frames[wrist].position - frames[elbow].position).to_degrees();
        assert!((20.0..110.0).contains(&bend), "{frame}: {bend}");
    }
}

#[test]
fn who_pushes_low_stoops_to_it() {
    for height in [0.5, 0.65, 0.8] {
        let clip = made("push", &[("height", height)]);
        let shoulder = trajectory(&clip, JointRole::LeftShoulder);
        let (grasp, release) = (event(&clip, "grasp"), event(&clip, "release"));
        let [left, right] = hands(&clip);
        for frame in grasp..=release {
            assert!((left[frame].y - height).abs() < ROUNDING && (right[frame].y - height).abs() < ROUNDING);
            let stretch = left[frame].distance(shoulder[frame]) / (body::UPPER_ARM + body::FOREARM);
            assert!((0.6..0.97).contains(&stretch), "{frame}: {stretch}");
        }
    }
}

#[test]
fn who_walks_ducked_is_lower_by_a_quarter_between_its_events() {
    let clip = made("duck_walk", &[]);
    let head = trajectory(&clip, JointRole::Head);
    let (ducked, rising) = (event(&clip, "ducked"), event(&clip, "rising"));
    assert!(ducked + 60 < rising);
    assert!((ducked..=rising).all(|frame| head[frame].y < 0.75 * head[0].y));
    assert!(head[clip.frame_count() - 1].y > 0.98 * head[0].y);
}

#[test]
fn hands_may_hold_from_the_first_frame_to_the_last() {
    for name in ["carry", "push"] {
        let clip = made(name, &[("take", 0.0), ("give", 0.0)]);
        assert_eq!((event(&clip, "grasp"), event(&clip, "release")), (0, clip.frame_count() - 1));
        let [left, _] = hands(&clip);
        let last = clip.frame_count() - 1;
        let held = |frame: usize| left[frame] - clip.root_positions[frame];
        assert!(held(0).distance(held(last)) < 1e-6, "{name}");
    }
}
