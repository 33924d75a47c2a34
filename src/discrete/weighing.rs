//! Candidates on the scales: what is known of their energy at no cost, a sharper bound, and Ê itself.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::discrete::candidates::Candidate;
use crate::discrete::remap::{spliced, while_spliced};
use crate::edit::own_path::OwnPath;
use crate::edit::{Editor, Exchange, GroupResponse, Timing, Variant, WhatIf};
use crate::scene::Scene;

/// A candidate with what stays known of it until its track, or what it is tied to, changes.
pub struct Proposal {
    /// What would happen.
    pub candidate: Candidate,
    /// Sum of the turns at the seams of its track, radians.
    pub turned: f64,
    /// How often it would show one source frame at most.
    pub copies: usize,
    /// It puts the very frames in the place of those that go.
    pub repeats: bool,
    /// The path of the track it leads to, once asked for: that depends on nothing else.
    path: OnceLock<Arc<OwnPath>>,
    /// That track, once asked for; `None` where a moment is torn apart.
    pub variant: OnceLock<Option<Variant>>,
    /// The group with that track, since systems were last factored; `None` where these do not tell.
    exchange: OnceLock<Option<Mutex<Exchange>>>,
    /// The one before.
    before: Mutex<Option<Exchange>>,
    /// Ê when it was last estimated.
    last: Mutex<Option<f64>>,
}

impl Proposal {
    /// Nothing else is known of it yet.
    /// `repeats`: whether the track shows what it showed before.
    pub fn new(candidate: Candidate, (turned, copies): (f64, usize), repeats: bool) -> Self {
        Self {
            candidate,
            turned,
            copies,
            repeats,
            path: OnceLock::new(),
            variant: OnceLock::new(),
            exchange: OnceLock::new(),
            before: Mutex::default(),
            last: Mutex::default(),
        }
    }

    /// Systems were factored anew: the exchange holds no longer, but much of the next one may be the same.
    pub fn forget_exchange(&mut self) {
        if let Some(known) = self.exchange.take().flatten() {
            self.before = Mutex::new(Some(known.into_inner().unwrap_or_else(PoisonError::into_inner)));
        }
    }

    fn remember(&self, energy: f64) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(energy);
    }

    /// Ê when it was last estimated, in an earlier update.
    pub fn last(&self) -> Option<f64> {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Solved times by what they depend on besides the targets; `None` where there are none. They hold until times are solved anew.
pub type Timings = Mutex<BTreeMap<Vec<u64>, Arc<OnceLock<Option<Timing>>>>>;

/// What the candidates of one update share.
pub struct Weighing<'a> {
    editor: &'a Editor,
    turn_weight: f64,
    /// Present sum of the turns at seams of each character, radians.
    turned: Vec<f64>,
    /// Of each character: least energy of all that its changes leave alone, and how its group answers to them.
    others: Vec<OnceLock<f64>>,
    responses: &'a [OnceLock<Option<GroupResponse>>],
    timings: &'a Timings,
    /// Copies of the scene to put other tracks into, as many as were needed at once.
    scenes: Mutex<Vec<Scene>>,
    /// Whether there is room to keep exchanged groups from update to update.
    keeps: bool,
}

/// What changes nothing has the present Ê to this, relative to 1 and itself; a gain of as little is none.
const REPEATED: f64 = 1e-8;

/// Exchanged groups are kept up to about so many paths and constraints of all of them, each a kilobyte or so.
const MOST_KEPT: usize = 200_000;

impl<'a> Weighing<'a> {
    /// Weighs changes of what `editor` has just solved. `responses`: room for that of each character, or what is known of
    /// them since systems were last factored. `timings`: room for times, or those that still hold. `turned`: sum of the turns at
    /// seams of each character, radians. `candidates`: how many there are to weigh.
    pub fn new(
        (editor, responses, timings): (&'a Editor, &'a [OnceLock<Option<GroupResponse>>], &'a Timings),
        turned: Vec<f64>,
        turn_weight: f64,
        candidates: usize,
    ) -> Self {
        let scene = editor.scene();
        let size = scene.characters.len() + scene.constraints.len();
        Self {
            editor,
            turn_weight,
            others: turned.iter().map(|_| OnceLock::new()).collect(),
            responses,
            timings,
            scenes: Mutex::default(),
            keeps: size.saturating_mul(candidates) <= MOST_KEPT,
            turned,
        }
    }

    /// A lower bound that takes no work: turns at seams, and those who are not tied to the character.
    pub fn first_bound(&self, proposal: &Proposal) -> f64 {
        let who = proposal.candidate.character;
        let others = self.others[who.as_usize()].get_or_init(|| self.editor.energy_of_others(who));
        others + self.turns(proposal)
    }

    /// A sharper lower bound; infinite where the times have no solution.
    pub fn bound(&self, proposal: &Proposal) -> f64 {
        let Some(variant) = self.variant(proposal) else { return f64::INFINITY };
        if proposal.repeats && self.editor.has_path(variant) {
            let present = self.editor.edit().energy.total + self.turns(proposal);
            return present - REPEATED * (1.0 + present);
        }
        let timing = self.timing(variant);
        let Some(timing) = timing.get().and_then(Option::as_ref) else { return f64::INFINITY };
        self.editor.energy_bound(variant, timing) + self.turns(proposal)
    }

    /// Ê to rounding; `None` where only solving anew tells. `bound`: what it is at least. What comes to more than `most` may be
    /// infinite.
    pub fn estimate(&self, proposal: &Proposal, bound: f64, most: f64) -> Option<f64> {
        let variant = self.variant(proposal)?;
        let timing = self.timing(variant);
        let timing = timing.get()?.as_ref().filter(|timing| !timing.is_entangled())?;
        let who = proposal.candidate.character;
        let response = self.responses[who.as_usize()].get_or_init(|| self.editor.response(who)).as_ref()?;
        let make = || {
            let before = proposal.before.lock().unwrap_or_else(PoisonError::into_inner).take();
            self.editor.exchange((variant, timing), response, before)
        };
        let turns = self.turns(proposal);
        let range = (bound - turns, most - turns);
        let estimate =
            |exchange: &mut Exchange| self.editor.energy_if((variant, timing), (exchange, response), range);
        let told = if self.keeps {
            let kept = proposal.exchange.get_or_init(|| make().map(Mutex::new)).as_ref()?;
            estimate(&mut kept.lock().unwrap_or_else(PoisonError::into_inner))?
        } else {
            estimate(&mut make()?)?
        };
        match told {
            WhatIf::Energy(energy) => {
                let total = energy.with_turns(turns).total;
                proposal.remember(total);
                Some(total)
            }
            WhatIf::TooMuch(about) => {
                about.into_iter().for_each(|about| proposal.remember(about + turns));
                Some(f64::INFINITY)
            }
        }
    }

    /// Ê by the published estimate; `marked`: frames of each present track that any change joins. Where objects move, Ê.
    pub fn sampled(&self, proposal: &Proposal, marked: &[Vec<usize>]) -> Option<f64> {
        if !self.editor.is_separable() {
            return self.energy(proposal);
        }
        let Candidate { character, splice, keep, .. } = &proposal.candidate;
        let variant = self.variant(proposal)?;
        let timing = (!self.editor.samples_times()).then(|| self.timing(variant));
        let timing = match &timing {
            Some(timing) => Some(timing.get()?.as_ref()?),
            None => None,
        };
        let mut marked = marked.to_vec();
        let own = &mut marked[character.as_usize()];
        *own = own.iter().filter_map(|frame| splice.map(*frame, *keep)).collect();
        let energy = self.editor.energy_sampled(variant, timing, &marked).ok()?;
        Some(energy.with_turns(self.turns(proposal)).total)
    }

    /// Ê; `None` where there is no solution. Solves the groups that the character is in; all where these depend on each other.
    pub fn energy(&self, proposal: &Proposal) -> Option<f64> {
        let Candidate { character, splice, keep, .. } = &proposal.candidate;
        let variant = self.variant(proposal)?;
        let timing = self.timing(variant);
        let timing = timing.get()?.as_ref()?;
        let energy = if timing.is_entangled() {
            let scene = spliced(self.editor.scene(), *character, splice, *keep)?;
            self.editor.energy_entangled(scene, variant, timing).ok()?
        } else {
            self.editor.energy_of(variant, timing).ok()?
        };
        Some(energy.with_turns(self.turns(proposal)).total)
    }

    /// The turn term if `proposal` happened.
    fn turns(&self, proposal: &Proposal) -> f64 {
        let who = proposal.candidate.character.as_usize();
        let own = |(other, turned): (usize, &f64)| if other == who { proposal.turned } else { *turned };
        self.turn_weight * self.turned.iter().enumerate().map(own).sum::<f64>()
    }

    fn variant<'b>(&self, proposal: &'b Proposal) -> Option<&'b Variant> {
        let Candidate { character, splice, keep, .. } = &proposal.candidate;
        let make = || {
            let free = || self.scenes.lock().unwrap_or_else(PoisonError::into_inner);
            let known = free().pop();
            let mut scene = known.unwrap_or_else(|| self.editor.scene().clone());
            let made = while_spliced(&mut scene, *character, (splice, *keep), |scene| {
                let draw =
                    || Arc::new(OwnPath::new(scene.characters[character.as_usize()].track.rest_path()));
                let path = Arc::clone(proposal.path.get_or_init(draw));
                self.editor.variant(scene, *character, path)
            });
            free().push(scene);
            made
        };
        proposal.variant.get_or_init(make).as_ref()
    }

    /// Times of a variant: many have the same ones.
    fn timing(&self, variant: &Variant) -> Arc<OnceLock<Option<Timing>>> {
        let known = {
            let mut timings = self.timings.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(timings.entry(variant.time_key()).or_default())
        };
        known.get_or_init(|| self.editor.timing(variant).ok());
        known
    }
}
