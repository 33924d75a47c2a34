//! Discrete changes of a track: exact frames, seams that continue the step of their source, feet that stay where somebody
//! stands, and a way back.

use std::collections::BTreeMap;
use std::sync::Arc;

use cotillion::clip::builtin::generate;
use cotillion::clip::contacts::{ContactPoint, contact_point};
use cotillion::clip::working::WorkingClip;
use cotillion::geometry::{c64, log, plan_of, wrap};
use cotillion::index::{FrameIndex, SourceFrame};
use cotillion::similarity::{features, mean_rotations};
use cotillion::track::{Jump, Keep, SeamRule, Splice, Stretch, Track};
use proptest::prelude::*;

/// Rounding of rigid motions of some metres, one after another.
const ROUNDING: f64 = 1e-11;

fn clip(name: &str, parameters: &[(&str, f64)]) -> Arc<WorkingClip> {
    let parameters: BTreeMap<String, f64> = parameters.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect();
    let clip = generate(name, &parameters).expect("a known clip");
    let last = SourceFrame::from_usize(clip.frame_count() - 1);
    Arc::new(WorkingClip::new(name, Arc::new(clip), SourceFrame(0), last))
}

fn walk_idle_walk(rule: SeamRule) -> Track {
    let clips = vec![
        clip("walk", &[("stop", 1.0)]),
        clip("idle", &[("seconds", 4.0)]),
        clip("walk", &[("start", 1.0)]),
    ];
    Track::string(clips, &[], (Some(c64::new(1.0, 2.0)), Some(0.3)), rule).0
}

/// Clip and working frame that each track frame shows.
fn shown(track: &Track) -> Vec<(usize, u32)> {
    track.runs.iter().flat_map(|run| (run.first.0..=run.last.0).map(|frame| (run.entry, frame))).collect()
}

/// A splice of each type, somewhere on a track of `count` frames, from four shares of it.
fn some_splice(track: &Track, kind: usize, shares: [f64; 4]) -> Splice {
    let count = track.frame_count();
    let [a, b, c, d] = shares.map(|share| cotillion::index::floor_index(share * (count - 2) as f64));
    let (i, j) = (a.min(b), a.max(b) + 1);
    let (k, l) = (c.min(d), c.max(d) + 1);
    match kind {
        0 => Splice::delete(i, j.min(count - 2).max(i)),
        1 => Splice::duplicate(i, j),
        2 => Splice::insert(i, track.stretches(k + 1, l)),
        _ => Splice::replace(i, j.min(count - 2).max(i), track.stretches(k + 1, l)),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// The frames of a spliced track are exactly those that the splice says, and what is named on one that stays is found
    /// on the very same frame.
    #[test]
    fn frames_are_exact(kind in 0usize..4, shares in prop::array::uniform4(0.0..1.0_f64)) {
        let track = walk_idle_walk(SeamRule::PlantedFeet);
        let splice = some_splice(&track, kind, shares);
        let (before, after) = (shown(&track), shown(&track.spliced(&splice)));
        let inserted = splice.inserted.iter().flat_map(|s| (s.first.0..=s.last.0).map(|frame| (s.entry, frame)));
        let expected: Vec<_> = before[..=splice.after]
            .iter()
            .copied()
            .chain(inserted)
            .chain(before[splice.resume..].iter().copied())
            .collect();
        prop_assert_eq!(&after, &expected);
        prop_assert_eq!(after.len(), splice.new_count(before.len()));
        for keep in [Keep::First, Keep::Second] {
            for (frame, source) in before.iter().enumerate() {
                if let Some(mapped) = splice.map(frame, keep) {
                    prop_assert_eq!(after[mapped], *source);
                }
            }
        }
    }

    /// At a seam aligned by the root, the step is that of the source, turned with its run.
    #[test]
    fn seams_continue_the_step_of_their_source(kind in 0usize..4, shares in prop::array::uniform4(0.0..1.0_f64)) {
        let track = walk_idle_walk(SeamRule::Root);
        let spliced = track.spliced(&some_splice(&track, kind, shares));
        let path = spliced.rest_path();
        for (run, start) in spliced.placed_runs().skip(1) {
            let (source, first) = (&spliced.clips[run.entry], run.first.as_usize());
            if first == 0 {
                continue;
            }
            let step = run.placement.turn * (source.positions[first] - source.positions[first - 1]);
            prop_assert!((path.positions[start] - path.positions[start - 1] - step).norm() < ROUNDING);
            let turn = source.headings[first] - source.headings[first - 1];
            prop_assert!(wrap(path.headings[start] - path.headings[start - 1] - turn).abs() < ROUNDING);
        }
    }

    /// What is shown twice and then taken out again leaves no trace.
    #[test]
    fn duplication_and_deletion_undo_each_other(shares in prop::array::uniform4(0.0..1.0_f64)) {
        let track = walk_idle_walk(SeamRule::PlantedFeet);
        let splice = some_splice(&track, 1, shares);
        let (i, j) = (splice.resume - 1, splice.after);
        let back = track.spliced(&splice).spliced(&Splice::delete(j, 2 * j - i));
        prop_assert_eq!(back, track);
    }

    /// Frames before the first seam do not move, those after the last move rigidly.
    #[test]
    fn the_tail_moves_rigidly(shares in prop::array::uniform4(0.0..1.0_f64)) {
        let track = walk_idle_walk(SeamRule::Root);
        let splice = some_splice(&track, 0, shares);
        let (before, after) = (track.rest_path(), track.spliced(&splice).rest_path());
        prop_assert_eq!(&before.positions[..=splice.after], &after.positions[..=splice.after]);
        let moved = splice.resume - splice.after - 1;
        let steps = |positions: &[c64]| positions.windows(2).map(|p| (p[1] - p[0]).norm()).collect::<Vec<_>>();
        let (old, new) = (steps(&before.positions[splice.resume..]), steps(&after.positions[splice.resume - moved..]));
        prop_assert!(old.iter().zip(&new).all(|(a, b)| (a - b).abs() < ROUNDING));
    }
}

/// Ground points of the feet at a track frame, as the run that shows it places them, not blended.
fn planted(track: &Track, entry: usize, frame: usize, run: usize) -> Vec<c64> {
    let clip = &track.clips[entry];
    let skeleton = &clip.clip.skeleton;
    let frames = skeleton.forward_kinematics(&clip.pose(frame as f64));
    let place = |point| plan_of(contact_point(skeleton, point).expect("a foot").place(&frames));
    ContactPoint::FEET.into_iter().map(|point| track.runs[run].placement.apply(place(point))).collect()
}

#[test]
fn feet_stay_where_somebody_stands_and_the_root_makes_good_what_is_left() {
    let idle = clip("idle", &[("seconds", 6.0)]);
    let track = Track::string(vec![idle], &[], (None, None), SeamRule::PlantedFeet).0;
    let spliced = track.spliced(&Splice::duplicate(40, 97));
    assert_eq!(spliced.runs.len(), 2);
    let (last, first) = (spliced.runs[0].last.as_usize(), spliced.runs[1].first.as_usize());
    let (here, there) = (planted(&spliced, 0, last, 0), planted(&spliced, 0, first - 1, 1));
    assert!(here.iter().zip(&there).all(|(a, b)| (a - b).norm() < 1e-3), "{here:?} {there:?}");
    assert!(spliced.runs[1].jump != Jump::default(), "the root sways between them");
    let path = spliced.rest_path();
    let usual = track.rest_path();
    let longest = |positions: &[c64]| positions.windows(2).map(|p| (p[1] - p[0]).norm()).fold(0.0, f64::max);
    assert!(longest(&path.positions) < 2.0 * longest(&usual.positions), "the path is continuous");
    for frame in 0..path.len() {
        let root = plan_of(spliced.pose(frame as f64).root);
        assert!((root - path.positions[frame]).norm() < ROUNDING, "path and poses agree at {frame}");
    }
}

/// The frame half a second to two seconds after `frame` that is most like it.
fn most_alike(clip: &WorkingClip, frame: usize) -> usize {
    let features = features(clip, &mean_rotations(&[clip]));
    let distance = |other: &usize| features.distance(frame, &features, *other);
    let candidates = frame + 15..(frame + 60).min(clip.frame_count());
    candidates.min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a second of walking is left")
}

#[test]
fn poses_are_continuous_at_the_seams_of_splices() {
    let track = walk_idle_walk(SeamRule::PlantedFeet);
    let spliced = track.spliced(&Splice::duplicate(20, most_alike(&track.clips[0], 20)));
    let (_, start) = spliced.placed_runs().nth(1).expect("two runs at least");
    let (before, after) = (spliced.pose(start as f64 - 1.0), spliced.pose(start as f64));
    let earlier = spliced.pose(start as f64 - 2.0);
    for (joint, (a, b)) in before.rotations.iter().zip(&after.rotations).enumerate() {
        let (step, known) =
            (log(a.inverse() * *b).length(), log(earlier.rotations[joint].inverse() * *a).length());
        assert!(step < known + 0.12, "joint {joint} turns by {step} after {known}");
    }
}

#[test]
fn frames_of_another_clip_can_be_shown() {
    let track = walk_idle_walk(SeamRule::PlantedFeet);
    let inserted = vec![Stretch { entry: 2, first: FrameIndex(5), last: FrameIndex(40) }];
    let spliced = track.spliced(&Splice::insert(30, inserted));
    assert_eq!(spliced.frame_count(), track.frame_count() + 36);
    assert_eq!(spliced.runs[1].entry, 2);
}
