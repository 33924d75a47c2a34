//! Splices: frames of a track taken out, put in, shown twice or exchanged, and where every other frame goes.
//!
//! A splice shows `[0..after] inserted [resume..]`. With i ~ j for frames that look alike:
//!
//! | | after | inserted | resume |
//! |---|---|---|---|
//! | deletion of i+1..j | i | – | j+1 |
//! | duplication of i+1..j | j | – | i+1 |
//! | insertion of j+1..k after i | i | j+1..k | i+1 |
//! | replacement of i+1..j by k+1..l | i | k+1..l | j+1 |
//!
//! Source: Kim et al. 2009, §5.2, with exact frame counts: no frame is consumed by blending.

use crate::geometry::RigidMotion;
use crate::index::{FrameIndex, floor_index};
use crate::track::{Jump, Run, Track};

/// Frames of one clip, one after another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stretch {
    /// Position in [`Track::clips`].
    pub entry: usize,
    /// First working frame of the clip.
    pub first: FrameIndex,
    /// Last working frame of the clip, included; not before `first`.
    pub last: FrameIndex,
}

/// A discrete change of a track.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Splice {
    /// Last track frame before the change.
    pub after: usize,
    /// What follows it; nothing, or other frames.
    pub inserted: Vec<Stretch>,
    /// First track frame after the change, at least 1; at most `after` where frames are shown twice.
    pub resume: usize,
}

/// What is named on frames that are shown twice stays on one of their copies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// The first.
    First,
    /// The second.
    Second,
}

impl Stretch {
    /// Number of frames.
    pub fn frame_count(&self) -> usize {
        (self.last.0 - self.first.0 + 1) as usize
    }
}

impl Splice {
    /// Takes out frames i+1 to j.
    pub fn delete(i: usize, j: usize) -> Self {
        Self { after: i, inserted: Vec::new(), resume: j + 1 }
    }

    /// Shows frames i+1 to j twice.
    pub fn duplicate(i: usize, j: usize) -> Self {
        Self { after: j, inserted: Vec::new(), resume: i + 1 }
    }

    /// Shows `inserted` after frame i.
    pub fn insert(i: usize, inserted: Vec<Stretch>) -> Self {
        Self { after: i, inserted, resume: i + 1 }
    }

    /// Shows `inserted` in place of frames i+1 to j.
    pub fn replace(i: usize, j: usize, inserted: Vec<Stretch>) -> Self {
        Self { after: i, inserted, resume: j + 1 }
    }

    /// Number of frames put in from elsewhere.
    pub fn inserted_count(&self) -> usize {
        self.inserted.iter().map(Stretch::frame_count).sum()
    }

    /// Number of frames of a track of `count` frames after the change.
    pub fn new_count(&self, count: usize) -> usize {
        count + self.after + 1 + self.inserted_count() - self.resume
    }

    /// Where track frame `frame` goes; `None` where it is taken out.
    pub fn map(&self, frame: usize, keep: Keep) -> Option<usize> {
        let moved = || frame + self.after + 1 + self.inserted_count() - self.resume;
        match frame {
            _ if frame <= self.last_before(keep) => Some(frame),
            _ if frame >= self.resume => Some(moved()),
            _ => None,
        }
    }

    /// Track frames between which, both excluded, [`Splice::map_instant`] says `None`, for a splice that changes something: all
    /// instants up to the first and from the second on go somewhere.
    pub fn torn(&self, keep: Keep) -> (usize, usize) {
        let last_before = self.last_before(keep);
        (last_before, self.resume.max(last_before + 1))
    }

    /// The last frame that stays where it is.
    fn last_before(&self, keep: Keep) -> usize {
        match keep {
            Keep::First => self.after,
            Keep::Second => self.after.min(self.resume - 1),
        }
    }

    /// Where a fractional track frame goes: `None` where one of the frames around it is taken out or they are torn apart.
    pub fn map_instant(&self, frame: f64, keep: Keep) -> Option<f64> {
        let low = floor_index(frame);
        let share = frame - low as f64;
        let mapped = self.map(low, keep)?;
        if share == 0.0 {
            return Some(mapped as f64);
        }
        (self.map(low + 1, keep)? == mapped + 1).then_some(mapped as f64 + share)
    }
}

impl Track {
    /// The track after `splice`: the same runs where nothing changes, each placed on the one before it.
    /// Cost: linear in runs.
    ///
    /// # Panics
    /// If the splice names frames that the track does not have.
    pub fn spliced(&self, splice: &Splice) -> Self {
        self.showing(&self.shown_after(splice))
    }

    /// What the track shows after `splice`: one stretch for each of its runs. Cost: linear in runs.
    ///
    /// # Panics
    /// If the splice names frames that the track does not have.
    pub fn shown_after(&self, splice: &Splice) -> Vec<Stretch> {
        let mut shown = Vec::with_capacity(self.runs.len() + splice.inserted.len() + 1);
        self.show_after(splice, &mut shown);
        shown
    }

    /// The same in place of what `shown` holds.
    ///
    /// # Panics
    /// As [`Track::shown_after`].
    pub fn show_after(&self, splice: &Splice, shown: &mut Vec<Stretch>) {
        let last = self.frame_count() - 1;
        assert!(splice.after <= last && splice.resume <= last + 1, "a splice is made for its track");
        let after = self.shown_from((splice.resume <= last).then_some(splice.resume), last);
        let all = self.shown_from(Some(0), splice.after).chain(splice.inserted.iter().copied()).chain(after);
        shown.clear();
        for stretch in all {
            match shown.last_mut() {
                Some(own) if own.entry == stretch.entry && own.last.0 + 1 == stretch.first.0 => {
                    own.last = stretch.last;
                }
                _ => shown.push(stretch),
            }
        }
    }

    /// What the track shows from track frame `first` to `last`, included.
    pub fn stretches(&self, first: usize, last: usize) -> Vec<Stretch> {
        self.shown_from(Some(first), last).collect()
    }

    /// The same one after the other; nothing without a first frame.
    fn shown_from(&self, first: Option<usize>, last: usize) -> impl Iterator<Item = Stretch> {
        let first = first.unwrap_or(usize::MAX);
        let within = move |(run, start): (&Run, usize)| {
            let (from, to) = (first.max(start), last.min(start + run.frame_count() - 1));
            (from <= to).then(|| Stretch {
                entry: run.entry,
                first: FrameIndex::from_usize(run.first.as_usize() + from - start),
                last: FrameIndex::from_usize(run.first.as_usize() + to - start),
            })
        };
        self.placed_runs().filter_map(within)
    }

    /// This track's clips, `stretches` of them one after another, each a run. The first frame stays where this track's is.
    fn showing(&self, stretches: &[Stretch]) -> Self {
        let run = |stretch: &Stretch| Run {
            entry: stretch.entry,
            first: stretch.first,
            last: stretch.last,
            placement: RigidMotion::IDENTITY,
            jump: Jump::default(),
        };
        let mut runs: Vec<Run> = stretches.iter().map(run).collect();
        runs[0].placement = self.runs[0].placement;
        let mut track = Self { clips: self.clips.clone(), runs, rule: self.rule };
        track.place_from(1);
        track
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames of a track of `count` frames after `splice`, by the sequence that defines it.
    fn shown(splice: &Splice, count: usize) -> Vec<usize> {
        let inserted = splice.inserted.iter().flat_map(|s| s.first.as_usize()..=s.last.as_usize());
        (0..=splice.after).chain(inserted).chain(splice.resume..count).collect()
    }

    fn stretch(first: usize, last: usize) -> Vec<Stretch> {
        vec![Stretch { entry: 0, first: FrameIndex::from_usize(first), last: FrameIndex::from_usize(last) }]
    }

    #[test]
    fn sequences_of_ten_frames_are_as_published() {
        let cases = [
            (Splice::delete(3, 6), vec![0, 1, 2, 3, 7, 8, 9]),
            (Splice::duplicate(3, 6), vec![0, 1, 2, 3, 4, 5, 6, 4, 5, 6, 7, 8, 9]),
            (Splice::insert(3, stretch(7, 8)), vec![0, 1, 2, 3, 7, 8, 4, 5, 6, 7, 8, 9]),
            (Splice::replace(2, 5, stretch(7, 8)), vec![0, 1, 2, 7, 8, 6, 7, 8, 9]),
        ];
        for (splice, frames) in cases {
            assert_eq!(shown(&splice, 10), frames);
            assert_eq!(splice.new_count(10), frames.len());
        }
    }

    #[test]
    fn frames_go_where_they_are_shown() {
        let splices = [
            Splice::delete(3, 6),
            Splice::duplicate(3, 6),
            Splice::insert(3, stretch(7, 8)),
            Splice::replace(2, 5, stretch(7, 8)),
        ];
        for splice in splices {
            let frames = shown(&splice, 10);
            for keep in [Keep::First, Keep::Second] {
                let mut before = None;
                for frame in 0..10 {
                    let Some(mapped) = splice.map(frame, keep) else {
                        assert!((splice.after + 1..splice.resume).contains(&frame));
                        continue;
                    };
                    assert_eq!(frames[mapped], frame, "{splice:?} {keep:?}");
                    assert!(before < Some(mapped), "maps rise");
                    before = Some(mapped);
                }
            }
        }
    }

    #[test]
    fn what_lies_between_frames_that_are_torn_apart_is_gone() {
        let splice = Splice::duplicate(3, 6);
        assert_eq!(splice.map_instant(6.5, Keep::First), None);
        assert_eq!(splice.map_instant(6.5, Keep::Second), Some(9.5));
        assert_eq!(splice.map_instant(3.5, Keep::First), Some(3.5));
        assert_eq!(splice.map_instant(3.5, Keep::Second), None);
        assert_eq!(splice.map_instant(5.0, Keep::Second), Some(8.0));
    }

    #[test]
    fn instants_are_gone_where_a_splice_tears_and_nowhere_else() {
        let splices = [
            Splice::delete(3, 6),
            Splice::duplicate(3, 6),
            Splice::insert(3, stretch(7, 8)),
            Splice::replace(2, 5, stretch(7, 8)),
            Splice::replace(2, 5, stretch(6, 8)),
        ];
        for (splice, keep) in splices.iter().flat_map(|own| [(own, Keep::First), (own, Keep::Second)]) {
            let (last_before, first_after) = splice.torn(keep);
            for frame in (0..=36).map(|quarter| f64::from(quarter) / 4.0) {
                let gone = frame > last_before as f64 && frame < first_after as f64;
                assert_eq!(splice.map_instant(frame, keep).is_none(), gone, "{splice:?} {keep:?} {frame}");
            }
        }
    }
}
