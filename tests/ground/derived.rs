//! Clips bent, tilted and blended.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use cotillion::clip::Clip;
use cotillion::clip::builtin::generate;
use cotillion::clip::derived::{ArcError, BlendError, SlopeError, bent, blended, tilted};
use cotillion::clip::facing::facing;
use cotillion::geometry::{c64, plan_of, wrap};
use cotillion::index::SourceFrame;

/// Rounding of a few turns of metres.
const ROUNDING: f64 = 1e-9;

fn clip(name: &str) -> Clip {
    generate(name, &BTreeMap::new()).expect("a generated clip")
}

fn heading(clip: &Clip, frame: usize) -> f64 {
    let frames = clip.skeleton.forward_kinematics(&clip.pose(SourceFrame::from_usize(frame)));
    facing(&clip.skeleton, &frames).expect("somebody upright")
}

#[test]
fn a_chord_becomes_an_arc_to_its_side_and_facing_turns_with_it() {
    let walk = clip("walk");
    let last = walk.frame_count() - 1;
    let [start, end] = [0, last].map(|frame| plan_of(walk.root_positions[frame]));
    for radius in [2.0, -3.0] {
        let laid = bent(&walk, radius).expect("an arc");
        let turn = (end - start).norm() / radius;
        let local = (plan_of(laid.root_positions[last]) - start) / ((end - start) / (end - start).norm());
        let expected = c64::new(radius.abs() * turn.abs().sin(), radius * (1.0 - turn.cos()));
        assert!((local - expected).norm() < ROUNDING, "{local} {expected}");
        assert!(wrap(heading(&laid, last) - heading(&walk, last) - turn).abs() < ROUNDING);
        assert!(wrap(heading(&laid, 0) - heading(&walk, 0)).abs() < ROUNDING);
        let heights = |clip: &Clip| clip.root_positions.iter().map(|root| root.y).collect::<Vec<_>>();
        assert_eq!(heights(&laid), heights(&walk));
    }
    assert!(matches!(bent(&walk, 0.0), Err(ArcError::NoRadius { .. })));
    assert!(matches!(bent(&clip("idle"), 2.0), Err(ArcError::NoChord { .. })));
}

#[test]
fn a_tilted_walk_climbs() {
    let (walk, angle) = (clip("walk"), 0.17_f64);
    let up = tilted(&walk, angle).expect("a slope");
    let last = walk.frame_count() - 1;
    let chord = (plan_of(walk.root_positions[last]) - plan_of(walk.root_positions[0])).norm();
    let climbed = up.root_positions[last].y - up.root_positions[0].y;
    let rise = walk.root_positions[last].y - walk.root_positions[0].y;
    assert!((climbed - chord * angle.sin() - rise * angle.cos()).abs() < ROUNDING);
    assert!(matches!(tilted(&walk, FRAC_PI_2), Err(SlopeError::NoAngle { .. })));
    assert!(matches!(tilted(&clip("idle"), angle), Err(SlopeError::NoChord { .. })));
}

#[test]
fn a_blend_is_each_clip_before_and_after_its_cycle() {
    let (walk, run) = (clip("walk"), clip("run"));
    let blend = blended(&walk, &run).expect("both have cycles");
    let first = blend.shares.iter().take_while(|share| share.weight <= 0.0).count();
    let alone = blend.alone_from().as_usize();
    assert!(first > 0 && alone > first && alone < blend.clip.frame_count());
    let joints = walk.skeleton.joints.len();
    for frame in 0..first.saturating_sub(1) {
        assert_eq!(
            blend.clip.pose(SourceFrame::from_usize(frame)),
            walk.pose(SourceFrame::from_usize(frame))
        );
    }
    for (frame, share) in blend.shares.iter().enumerate().skip(alone) {
        let own = run.sample(share.to);
        let place = blend.motion.apply(plan_of(own.root));
        assert!((plan_of(blend.clip.root_positions[frame]) - place).norm() < ROUNDING);
        let found = &blend.clip.rotations[frame * joints + 1..(frame + 1) * joints];
        assert_eq!(found, &own.rotations[1..]);
    }
    let steps: Vec<f64> = blend
        .clip
        .root_positions
        .windows(2)
        .map(|pair| (plan_of(pair[1]) - plan_of(pair[0])).norm() * blend.clip.fps)
        .collect();
    // Neither stops nor jumps on the way from one speed to the other.
    assert!(steps[first..alone].iter().all(|speed| (0.5..5.0).contains(speed)), "{steps:?}");
    assert!(matches!(blended(&clip("idle"), &run), Err(BlendError::NoCycle { .. })));
}
