//! What clips of locomotion promise.

use super::super::course::Course;
use super::super::gait::{Bearing, FLAT, Gait, HEEL_OFF, TOE_OFF};
use super::*;

/// Walks and bodies at the ends of their ranges.
pub(super) fn variants() -> Vec<Clip> {
    let mut clips = Vec::new();
    for speed in [0.5, 0.8, 1.5, 1.8] {
        clips.push(made("walk", &[("speed", speed)]));
    }
    for speed in [0.5, 1.2, 1.8] {
        clips.push(made("walk", &[("speed", speed), ("start", 1.0), ("stop", 1.0), ("seconds", 5.0)]));
    }
    for stature in [1.2, 2.2] {
        clips.push(made("walk", &[("stature", stature)]));
    }
    for (speed, turn, stature) in [
        (2.5, 45.0, 1.75),
        (4.5, -45.0, 1.75),
        (2.5, 0.0, 1.2),
        (4.5, 0.0, 1.2),
        (2.5, 0.0, 2.2),
        (4.5, 45.0, 2.2),
    ] {
        clips.push(made("run", &[("speed", speed), ("turn", turn), ("stature", stature)]));
    }
    for (speed, turn, ends) in
        [(0.5, 45.0, 0.0), (1.8, -45.0, 0.0), (0.5, -45.0, 1.0), (1.2, 45.0, 1.0), (1.8, 45.0, 1.0)]
    {
        clips.push(made(
            "walk",
            &[("speed", speed), ("turn", turn), ("start", ends), ("stop", ends), ("seconds", 5.0)],
        ));
    }
    clips
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
    let gait =
        Gait::new(Body::new(stature.expect("the head ends").y), speed, Course::default(), Bearing::default());
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
        let gait = Gait::new(Body::new(1.75), speed, Course::default(), Bearing::default());
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
