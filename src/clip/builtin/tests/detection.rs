//! Contacts of generated locomotion as detection by height and speed sees them.

use std::sync::Arc;

use super::walks::steady;
use super::*;
use crate::clip::measure::foot_slide_working;
use crate::clip::working::WorkingClip;

#[test]
fn threshold_rules_see_alternating_stances() {
    for (name, speed) in [("walk", 0.5), ("walk", 1.2), ("walk", 1.8), ("carry", 1.0), ("push", 0.6)] {
        let clip = steady(name, &[("speed", speed)]);
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
fn feet_that_are_taken_for_planted_hardly_slide() {
    /// Metres a second on average. Heels are seen at the ankle joint, which is taken for planted for a frame or two when the
    /// foot turns about its heel or toes; in the slow first and last steps of who sets off and halts, and in the short
    /// stances of a run, these count for more.
    const SLIDE: f64 = 0.01;
    const SLIDE_OF_SHORT_STANCES: f64 = 0.025;
    for info in names() {
        let clip = made(info.name, &[]);
        let (first, last) = clip.usable;
        let working = WorkingClip::new(&clip.name, Arc::new(clip.clone()), first, last);
        let slide = foot_slide_working(&working).expect("feet on the ground");
        let most = if ["run", "carry", "push", "duck_walk"].contains(&info.name) {
            SLIDE_OF_SHORT_STANCES
        } else {
            SLIDE
        };
        assert!(slide < most, "{}: {slide} m/s", info.name);
    }
}
