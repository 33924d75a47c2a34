//! Frames at the ends of a file in which a moving body is frozen.

use crate::clip::Clip;
use crate::clip::note::ReadNote;
use crate::index::{SourceFrame, floor_index};

/// A body that comes to a rest does so more slowly than within one frame: no slower than this is it frozen, m/s.
const MOVING: f64 = 0.5;

/// Longer rests are meant, seconds.
const LONGEST: f64 = 0.1;

/// Leaves out of the usable frames those at either end that are all the same, to the bit, where the body travels right beside them:
/// programs repeat a frame to fill up a length, and who stands still for these frames only would stop within one. Cost: linear.
pub(super) fn leave_out(clip: &mut Clip, notes: &mut Vec<ReadNote>) {
    let (first, last) = (clip.usable.0.as_usize(), clip.usable.1.as_usize());
    let id = SourceFrame::from_usize;
    let is_same = |a: usize, b: usize| clip.pose(id(a)) == clip.pose(id(b));
    let longest = floor_index(LONGEST * clip.fps + 0.5);
    let stops = |still: usize, moving: usize| {
        let way = clip.root_positions[still].distance(clip.root_positions[moving]);
        way * clip.fps > MOVING
    };
    // The first frame from which on, and the last up to which, not all are the same.
    let from = (first..last).find(|frame| !is_same(*frame, frame + 1)).unwrap_or(first);
    let to = (first + 1..=last).rev().find(|frame| !is_same(*frame, frame - 1)).unwrap_or(last);
    if to <= from {
        return;
    }
    let starts = (1..=longest).contains(&(from - first)) && stops(from, from + 1);
    let ends = (1..=longest).contains(&(last - to)) && stops(to, to - 1);
    if starts {
        clip.usable.0 = id(from);
    }
    if ends {
        clip.usable.1 = id(to);
    }
    if starts {
        notes.push(ReadNote::FrozenLeftOut { frozen: (id(first), id(from - 1)), usable: clip.usable });
    }
    if ends {
        notes.push(ReadNote::FrozenLeftOut { frozen: (id(to + 1), id(last)), usable: clip.usable });
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::clip::builtin::generate;

    /// Called so, with its first frame shown so many times more before it, and its last after it.
    fn frozen(name: &str, (before, after): (usize, usize)) -> Clip {
        let clip = generate(name, &BTreeMap::new()).expect("a generated clip");
        let count = clip.frame_count();
        let frames =
            std::iter::repeat_n(0, before).chain(0..count).chain(std::iter::repeat_n(count - 1, after));
        let poses: Vec<_> = frames.map(|frame| clip.sample(frame as f64)).collect();
        Clip::from_poses(name, clip.skeleton, clip.fps, &poses)
    }

    fn left(mut clip: Clip) -> ((u32, u32), usize) {
        let mut notes = Vec::new();
        leave_out(&mut clip, &mut notes);
        ((clip.usable.0.0, clip.usable.1.0), notes.len())
    }

    #[test]
    fn frozen_walkers_are_left_out_at_either_end() {
        let last = u32::try_from(frozen("walk", (0, 0)).frame_count() - 1).expect("few");
        assert_eq!(left(frozen("walk", (0, 0))), ((0, last), 0));
        assert_eq!(left(frozen("walk", (0, 1))), ((0, last), 1));
        assert_eq!(left(frozen("walk", (2, 0))), ((2, last + 2), 1));
        assert_eq!(left(frozen("walk", (1, 3))), ((1, last + 1), 2));
    }

    #[test]
    fn long_rests_are_kept_and_so_is_who_stands() {
        let last = u32::try_from(frozen("walk", (0, 20)).frame_count() - 1).expect("few");
        assert_eq!(left(frozen("walk", (0, 20))), ((0, last), 0));
        let clip = frozen("idle", (2, 2));
        let last = u32::try_from(clip.frame_count() - 1).expect("few");
        assert_eq!(left(clip), ((0, last), 0));
    }
}
