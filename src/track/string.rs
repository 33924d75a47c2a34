//! Stringing: clips one after another on a track, joined at well-matching frames.

use std::sync::Arc;

use crate::clip::working::WorkingClip;
use crate::geometry::{RigidMotion, c64};
use crate::index::{FrameIndex, floor_index};
use crate::similarity::{admissible, features, mean_rotations};
use crate::track::{Jump, Run, SeamRule, Track};

/// A frame that must not be dropped when clips are strung, and what names it.
#[derive(Clone, Debug, PartialEq)]
pub struct Protected {
    /// Position in the `track` list.
    pub entry: usize,
    /// Working frame of that clip, a fraction.
    pub working: f64,
    /// Name of the moment.
    pub moment: String,
}

/// What stringing did at one seam.
#[derive(Clone, Debug, PartialEq)]
pub struct SeamChoice {
    /// Position in the `track` list of the clip before the seam.
    pub entry: usize,
    /// Distance of the two matched frames, as in [`crate::similarity`].
    pub distance: f64,
    /// Largest distance at which frames count as similar.
    pub admissible: f64,
    /// Moments whose frames narrowed the search: they may not be dropped.
    pub held_by: Vec<String>,
}

/// Clips are joined in the last and the first second of their ranges, frames.
const SEAM_WINDOW: usize = 30;

impl Track {
    /// Strings `clips` one after another at well-matching frames, aligned by the root.
    ///
    /// Clip A is shown up to its frame e, then B from b: of the last second of A and the first of B (at most half of each)
    /// the pair whose frames e and b−1 are most alike; of equals, the one that drops the fewest frames.
    /// `protected`: frames that must stay, with one on either side. `start`: where the first frame's root goes and how its
    /// body faces there; what is left out stays as in the clip.
    pub fn string(
        clips: Vec<Arc<WorkingClip>>,
        protected: &[Protected],
        start: (Option<c64>, Option<f64>),
        rule: SeamRule,
    ) -> (Self, Vec<SeamChoice>) {
        let mut firsts = vec![0; clips.len()];
        let mut lasts: Vec<usize> = clips.iter().map(|clip| clip.frame_count() - 1).collect();
        let mut seams = Vec::new();
        for entry in 0..clips.len().saturating_sub(1) {
            let seam = best_seam(&clips, entry, firsts[entry], protected);
            lasts[entry] = seam.last;
            firsts[entry + 1] = seam.first;
            seams.push(seam.choice);
        }
        let runs = (0..clips.len())
            .map(|entry| Run {
                entry,
                first: FrameIndex::from_usize(firsts[entry]),
                last: FrameIndex::from_usize(lasts[entry]),
                placement: RigidMotion::IDENTITY,
                jump: Jump::default(),
            })
            .collect();
        let mut track = Self { clips, runs, rule };
        track.place(start);
        (track, seams)
    }
}

struct Seam {
    last: usize,
    first: usize,
    choice: SeamChoice,
}

/// The best pair of frames to join entries `entry` and `entry + 1`; the first of them starts at frame `start`.
fn best_seam(clips: &[Arc<WorkingClip>], entry: usize, start: usize, protected: &[Protected]) -> Seam {
    let (a, b) = (&clips[entry], &clips[entry + 1]);
    let range = |clip: &WorkingClip| (clip.frame_count() / 2).min(SEAM_WINDOW);
    let frames_of = |entry: usize| protected.iter().filter(move |frame| frame.entry == entry);
    let keep_from = frames_of(entry).map(|frame| floor_index(frame.working.ceil()) + 1).max().unwrap_or(0);
    let keep_to = frames_of(entry + 1).map(|frame| floor_index(frame.working).saturating_sub(1)).min();
    let a_last = a.frame_count() - 1;
    let earliest = (a.frame_count() - 1 - range(a)).max(keep_from.min(a_last)).max(start);
    let latest = range(b).min(keep_to.unwrap_or(usize::MAX));
    let mean = mean_rotations(&[a, b]);
    let (features_a, features_b) = (features(a, &mean), features(b, &mean));
    let mut best: Option<(bool, f64, usize, usize, usize)> = None;
    for last in earliest..=a_last {
        for first in 0..=latest {
            let matched = first.saturating_sub(1);
            let apart = a.contacts[last] != b.contacts[matched];
            let distance = features_a.distance(last, &features_b, matched);
            let dropped = a_last - last + first;
            let key = (apart, distance, dropped, last, first);
            let better = best.is_none_or(|known| {
                key.0.cmp(&known.0).then(key.1.total_cmp(&known.1)).then(key.2.cmp(&known.2)).is_lt()
            });
            if better {
                best = Some(key);
            }
        }
    }
    let (_, distance, _, last, first) =
        best.expect("the last frame of one clip and the first of the next may always meet");
    let largest = |clip, features| admissible(&[(clip, features)]).largest;
    let admissible = largest(a, &features_a).max(largest(b, &features_b));
    let free = |entry: usize| protected.iter().filter(move |frame| frame.entry == entry);
    let window = (a.frame_count() - 1 - range(a), range(b));
    let mut held_by: Vec<String> = free(entry)
        .filter(|frame| floor_index(frame.working.ceil()) + 1 > window.0)
        .chain(free(entry + 1).filter(|frame| floor_index(frame.working) <= window.1))
        .map(|frame| frame.moment.clone())
        .collect();
    held_by.sort_unstable();
    held_by.dedup();
    Seam { last, first, choice: SeamChoice { entry, distance, admissible, held_by } }
}
