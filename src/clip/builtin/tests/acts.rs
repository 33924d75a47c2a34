//! What clips of acts on the spot promise.

use glam::DVec3;

use super::*;

/// Acts and bodies at the ends of their ranges.
pub(super) fn variants() -> Vec<Clip> {
    [1.2, 2.2].map(|stature| made("slap", &[("stature", stature), ("seconds", 2.4)])).into()
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
