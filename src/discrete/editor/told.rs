//! What is told of the tracks as they are now.

use super::DiscreteEditor;
use crate::clip::working::WORKING_STEP;
use crate::discrete::candidates::Candidate;
use crate::discrete::outcome::TrackChanges;
use crate::discrete::remap::protected;
use crate::discrete::tracks::{copies, turns};
use crate::edit::energy::length;
use crate::index::CharacterId;
use crate::scene::Character;
use crate::track::Run;

/// A change that brings the logarithm of how far a path is stretched down by less is no help.
const LESS: f64 = 0.02;

impl DiscreteEditor {
    /// What became of a track.
    pub(super) fn changes(&self, who: usize) -> TrackChanges {
        let id = CharacterId::from_usize(who);
        let (track, edited) = (&self.scene().characters[who].track, &self.edit().characters[who]);
        let last = edited.times.len() - 1;
        let (rest, seconds) = (length(&edited.rest.positions), last as f64 * WORKING_STEP);
        let ratio = |edited: f64, rest: f64| if rest > 0.0 { edited / rest } else { 1.0 };
        let stretched = |rest: f64| ratio(length(&edited.positions), rest);
        let strain = |rest: f64| stretched(rest).ln().abs();
        let after = |candidate: &Candidate| length(&track.spliced(&candidate.splice).rest_path().positions);
        let candidates = self.candidates_of(id, track, &protected(self.scene(), id));
        TrackChanges {
            length: stretched(rest),
            time: ratio(edited.times[last] - edited.times[0], seconds),
            turns: turns(track, &self.rest_angles[who]),
            copies: copies(track, &self.clips[who]),
            open: candidates.iter().any(|candidate| strain(after(candidate)) < strain(rest) - LESS),
        }
    }

    /// Clip and file frame that a character's track shows at a track frame, as moments name them.
    pub(super) fn place(&self, character: CharacterId, frame: usize) -> String {
        let Character { name, track, .. } = &self.editor.scene().characters[character.as_usize()];
        let shows = |(run, start): &(&Run, usize)| *start + run.frame_count() > frame;
        let Some((run, start)) = track.placed_runs().find(shows) else { return name.clone() };
        let clip = &track.clips[run.entry];
        let own = self.rest_angles[character.as_usize()].len();
        let same = |entry: &usize| track.clips[*entry].name == clip.name;
        let uses = (0..own).filter(same).count();
        let number = (0..=run.entry.min(own - 1)).filter(same).count();
        let file = clip.source_frame(f64::from(run.first.0) + (frame - start) as f64).round();
        if uses > 1 {
            format!("{name}/{}#{number}:{file}", clip.name)
        } else {
            format!("{name}/{}:{file}", clip.name)
        }
    }
}
