//! How long clips last one after the other: stringing drops frames where they meet.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::acts::{Act, act};
use crate::clip::retarget::retarget;
use crate::clip::working::WorkingClip;
use crate::track::{Protected, SeamRule, Track};

/// An act on a track, and the one of its frames that stays, if a moment of the scene names one.
pub type Held<'a> = (&'a Act, Option<usize>);

/// Seams of tracks, each found once, as the scene finds them: the same clips on the same bodies meet at the same frames.
#[derive(Default)]
pub struct Strung {
    /// Bodies, by height in millimetres.
    bodies: BTreeMap<u32, WorkingClip>,
    /// Clips by name, on bodies.
    clips: BTreeMap<(String, u32), Arc<WorkingClip>>,
    /// The last frame of the one and the first of the other, by names and the frames that stay.
    seams: BTreeMap<(Meeting, Meeting, u32), (usize, usize)>,
}

/// Name of an act where it meets another, and the frame of it that stays.
type Meeting = (String, Option<usize>);

impl Strung {
    /// Where the first frame of each act's clip is on the track, or would be if it were not dropped, in frames of the first act.
    /// Seams do not hang on each other, as no clip is cut beyond its middle. Cost: linear in acts; a new seam that of stringing two.
    pub fn begins(&mut self, acts: &[Held<'_>], stature: f64) -> Vec<f64> {
        let mut begins = vec![0.0];
        for pair in acts.windows(2) {
            let (last, first) = self.seam(pair[0], pair[1], stature);
            begins.push(begins[begins.len() - 1] + last as f64 + 1.0 - first as f64);
        }
        begins
    }

    fn seam(&mut self, one: Held<'_>, other: Held<'_>, stature: f64) -> (usize, usize) {
        let named = |(act, held): Held<'_>| (act.name.clone(), held);
        let key = (named(one), named(other), millimetres(stature));
        if let Some(seam) = self.seams.get(&key) {
            return *seam;
        }
        let clips = vec![self.clip(one.0, stature), self.clip(other.0, stature)];
        let stays = |(entry, held): (usize, Option<usize>)| {
            held.map(|frame| Protected { entry, working: frame as f64, moment: String::new() })
        };
        let protected: Vec<Protected> = [(0, one.1), (1, other.1)].into_iter().filter_map(stays).collect();
        let (track, _) = Track::string(clips, &protected, (None, None), SeamRule::default());
        let seam = (track.runs[0].last.as_usize(), track.runs[1].first.as_usize());
        self.seams.insert(key, seam);
        seam
    }

    /// The clip as one so tall performs it.
    fn clip(&mut self, own: &Act, stature: f64) -> Arc<WorkingClip> {
        let tall = millimetres(stature);
        let body =
            self.bodies.entry(tall).or_insert_with(|| act("body", "idle", &[("stature", stature)], &[]).clip);
        let made = || {
            let clip = &own.clip;
            let performed = retarget(&clip.clip, &body.clip).map_or_else(
                |_| clip.clone(),
                |(made, _)| WorkingClip::new(&clip.name, Arc::new(made), clip.first, clip.last),
            );
            Arc::new(performed)
        };
        Arc::clone(self.clips.entry((own.name.clone(), tall)).or_insert_with(made))
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand")]
fn millimetres(stature: f64) -> u32 {
    (1000.0 * stature).round() as u32
}
