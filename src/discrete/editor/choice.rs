//! Which candidate an update takes, by each of the evaluators.

use super::DiscreteEditor;
use crate::constraint::Evaluator;
use crate::discrete::candidates::Candidate;
use crate::discrete::choose::{Offer, Scales, choose, choose_by_all};
use crate::discrete::tracks::turns;
use crate::discrete::weighing::{Proposal, Weighing};

impl DiscreteEditor {
    pub(super) fn weighing(&self) -> Weighing<'_> {
        let tracks = self.editor.scene().characters.iter().map(|character| &character.track);
        let turned = tracks.zip(&self.rest_angles).map(|(track, angles)| turns(track, angles)).collect();
        let candidates = self.known().len();
        Weighing::new(
            (&self.editor, &self.responses, &self.timings),
            turned,
            self.settings.turn_weight,
            candidates,
        )
    }

    /// The candidate to take, if one is worth it.
    pub(super) fn choose(&self, before: f64) -> Option<Candidate> {
        let (weighing, all) = (self.weighing(), self.known());
        let offers = offers(&weighing, &all);
        let weigh = |place: usize| weighing.energy(all[place]);
        let chosen = match self.settings.evaluator {
            Evaluator::Exact => {
                let bound = |place: usize| weighing.bound(all[place]);
                let estimate =
                    |place: usize, (bound, most): (f64, f64)| weighing.estimate(all[place], bound, most);
                choose(&offers, before, &Scales { bound, estimate, weigh }, &self.settings)
            }
            Evaluator::BruteForce => {
                choose_by_all(&offers, before, |place| self.weigh(&all[place].candidate), &self.settings)
            }
            Evaluator::Subsampled => {
                let marked = self.joined(&all);
                let sampled = |place: usize| weighing.sampled(all[place], &marked);
                choose_by_all(&offers, before, sampled, &self.settings)
            }
        };
        chosen.map(|chosen| all[chosen.place].candidate.clone())
    }

    /// The same by weighing all.
    pub(super) fn choose_weighed(&self, before: f64) -> Option<Candidate> {
        let (weighing, all) = (self.weighing(), self.known());
        let weigh = |place: usize| weighing.energy(all[place]);
        let chosen = choose_by_all(&offers(&weighing, &all), before, weigh, &self.settings)?;
        Some(all[chosen.place].candidate.clone())
    }

    /// Everything that could happen.
    pub(super) fn known(&self) -> Vec<&Proposal> {
        self.proposals.iter().flatten().flatten().collect()
    }

    /// Frames of each track that some candidate joins to others.
    fn joined(&self, all: &[&Proposal]) -> Vec<Vec<usize>> {
        let mut joined = vec![Vec::new(); self.proposals.len()];
        for Proposal { candidate, .. } in all {
            let before = candidate.splice.resume - 1;
            joined[candidate.character.as_usize()].extend([candidate.splice.after, before]);
        }
        for own in &mut joined {
            own.sort_unstable();
            own.dedup();
        }
        joined
    }
}

fn offers(weighing: &Weighing<'_>, all: &[&Proposal]) -> Vec<Offer> {
    let offer = |proposal: &&Proposal| Offer {
        copies: proposal.copies,
        distance: proposal.candidate.distance,
        bound: weighing.first_bound(proposal),
        last: proposal.last(),
    };
    all.iter().map(offer).collect()
}
