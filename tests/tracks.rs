//! Clips strung on a track: joined where they match, aligned by the root, blended, and no named frame is lost.

use std::collections::BTreeMap;
use std::sync::Arc;

use cotillion::clip::builtin::generate;
use cotillion::clip::working::WorkingClip;
use cotillion::constraint::Instant;
use cotillion::geometry::{c64, cis, log, wrap};
use cotillion::index::SourceFrame;
use cotillion::track::{Protected, SeamRule, Track};
use proptest::prelude::*;

/// Rounding of rigid motions of some metres.
const ROUNDING: f64 = 1e-12;

fn clip(name: &str, parameters: &[(&str, f64)]) -> Arc<WorkingClip> {
    let parameters: BTreeMap<String, f64> = parameters.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect();
    let clip = generate(name, &parameters).expect("a known clip");
    let last = SourceFrame::from_usize(clip.frame_count() - 1);
    Arc::new(WorkingClip::new(name, Arc::new(clip), SourceFrame(0), last))
}

fn meeting_clips() -> Vec<Arc<WorkingClip>> {
    let stop = clip("walk", &[("stop", 1.0), ("seconds", 4.0)]);
    let start = clip("walk", &[("start", 1.0), ("seconds", 4.0)]);
    vec![stop, clip("slap", &[]), start, clip("walk", &[])]
}

fn strung(protected: &[Protected]) -> Track {
    Track::string(meeting_clips(), protected, (Some(c64::new(2.0, -1.0)), Some(0.4)), SeamRule::Root).0
}

fn protect(entry: usize, working: f64) -> Protected {
    Protected { entry, working, moment: format!("a/{entry}:{working}") }
}

/// Track frames of the seams: the last of each run but the last.
fn seams(track: &Track) -> Vec<usize> {
    track.placed_runs().skip(1).map(|(_, start)| start - 1).collect()
}

#[test]
fn the_first_frame_stands_where_the_scene_says() {
    let track = strung(&[]);
    let path = track.rest_path();
    assert!((path.positions[0] - c64::new(2.0, -1.0)).norm() < ROUNDING);
    assert!(wrap(path.headings[0] - 0.4).abs() < ROUNDING);
    assert_eq!(path.len(), track.frame_count());
}

#[test]
fn a_seam_continues_the_step_of_the_source() {
    let track = strung(&[]);
    let path = track.rest_path();
    for (index, seam) in seams(&track).into_iter().enumerate() {
        let run = track.runs[index + 1];
        let (source, first) = (&track.clips[run.entry], run.first.as_usize());
        let step = match first {
            0 => source.positions[1] - source.positions[0],
            _ => source.positions[first] - source.positions[first - 1],
        };
        let found = path.positions[seam + 1] - path.positions[seam];
        assert!((found - run.placement.turn * step).norm() < ROUNDING);
        let turned = if first == 0 { 0.0 } else { source.headings[first] - source.headings[first - 1] };
        assert!(wrap(path.headings[seam + 1] - path.headings[seam] - turned).abs() < ROUNDING);
    }
}

#[test]
fn clips_meet_at_like_poses_within_a_second_of_their_ends() {
    let (track, choices) = Track::string(meeting_clips(), &[], (None, None), SeamRule::Root);
    assert_eq!(choices.len(), 3);
    for (choice, runs) in choices.iter().zip(track.runs.windows(2)) {
        assert!(choice.distance < 0.1, "stands and cycles match: {choice:?}");
        assert!(choice.admissible > 0.0 && choice.admissible <= 1.0);
        let before = &track.clips[runs[0].entry];
        assert!(before.frame_count() - 1 - runs[0].last.as_usize() <= 30);
        assert!(runs[1].first.as_usize() <= 30);
    }
}

#[test]
fn poses_are_continuous_at_seams_and_untouched_away_from_them() {
    let track = strung(&[]);
    for seam in seams(&track) {
        let (before, after) = (track.pose(seam as f64), track.pose(seam as f64 + 1.0));
        let usual = track.pose(seam as f64 - 1.0);
        for (joint, (a, b)) in before.rotations.iter().zip(&after.rotations).enumerate() {
            let step = log(a.inverse() * *b).length();
            let known = log(usual.rotations[joint].inverse() * *a).length();
            assert!(step < known + 0.12, "joint {joint} turns by {step} after {known}");
        }
        let middle = track.pose(seam as f64 + 0.5);
        assert!((middle.root - 0.5 * (before.root + after.root)).length() < 1e-9);
    }
    let (run, start) = track.placed_runs().nth(1).expect("four runs");
    let middle = run.frame_count() / 2;
    let shown = track.pose((start + middle) as f64);
    let source = track.clips[run.entry].pose(f64::from(run.first.0) + middle as f64);
    assert_eq!(shown.rotations[1..], source.rotations[1..]);
    assert!((shown.root.y - source.root.y).abs() < ROUNDING);
}

#[test]
fn moments_find_their_frames() {
    let track = strung(&[protect(1, 38.0)]);
    let last = track.frame_count() as f64 - 1.0;
    assert_eq!(track.locate(Instant::TrackStart), Some(0.0));
    assert_eq!(track.locate(Instant::TrackEnd), Some(last));
    assert_eq!(track.locate(Instant::ClipStart(0)), Some(0.0));
    assert_eq!(track.locate(Instant::ClipEnd(3)), Some(last));
    let hit = track.locate(Instant::Frame { entry: 1, working: 38.0 }).expect("protected");
    let (run, start) = track.placed_runs().nth(1).expect("four runs");
    assert_eq!(hit, start as f64 + 38.0 - f64::from(run.first.0));
    let seam = seams(&track)[0] as f64;
    assert_eq!(track.locate(Instant::ClipEnd(0)), Some(seam));
    assert_eq!(track.locate(Instant::ClipStart(1)), Some(seam + 1.0));
    assert_eq!(track.locate(Instant::Frame { entry: 1, working: 1e6 }), None);
}

#[test]
fn one_clip_alone_is_not_touched() {
    let walk = clip("walk", &[]);
    let (track, seams) = Track::string(vec![Arc::clone(&walk)], &[], (None, None), SeamRule::Root);
    assert!(seams.is_empty());
    for frame in [0.0, 10.25, 57.5, 102.0] {
        assert_eq!(track.pose(frame), walk.pose(frame));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Named frames, and one on either side, are never dropped.
    #[test]
    fn protected_frames_stay(frames in prop::collection::vec((0usize..4, 0.0..89.0_f64), 0..6)) {
        let protected: Vec<Protected> = frames.iter().map(|(entry, working)| protect(*entry, *working)).collect();
        let track = strung(&protected);
        for Protected { entry, working, .. } in protected {
            let run = track.runs[entry];
            let last = track.clips[run.entry].frame_count() as f64 - 1.0;
            let found = track.locate(Instant::Frame { entry, working });
            prop_assert!(found.is_some());
            prop_assert!(f64::from(run.first.0) <= (working.floor() - 1.0).max(0.0));
            prop_assert!(f64::from(run.last.0) >= (working.ceil() + 1.0).min(last));
        }
    }

    /// Placing a track elsewhere moves its rest path rigidly.
    #[test]
    fn placement_is_rigid(x in -9.0..9.0_f64, y in -9.0..9.0_f64, facing in -3.0..3.0_f64) {
        let here = Track::string(meeting_clips(), &[], (Some(c64::default()), Some(0.0)), SeamRule::Root).0.rest_path();
        let there = Track::string(meeting_clips(), &[], (Some(c64::new(x, y)), Some(facing)), SeamRule::Root).0.rest_path();
        for (p, q) in here.positions.iter().zip(&there.positions) {
            prop_assert!((cis(facing) * p + c64::new(x, y) - q).norm() < 1e-10);
        }
    }
}
