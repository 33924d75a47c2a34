//! Reversible manipulation: every update searches from the motion at rest on, so that its result depends on that and on
//! where the targets are, not on how they got there.
//!
//! Of characters who are tied to each other, sequences of changes are followed level by level, the eight with the least Ê of
//! each length. Every change of a sequence must be worth it, as in any update, so sequences are the longer the farther
//! targets are from rest. Taken is the length that reaches the least Ê; of its sequences within a near tie of that, the one
//! that repeats frames least, then the first one by what it shows. There is no hysteresis against the present tracks: it would
//! remember the way. Solved sequences are kept from one update to the next, by what they lead to; this changes nothing but
//! time. Cost: that of updates of eight tracks for every change of the longest sequence and one more.
//!
//! Source: ours. Kim et al. 2009 go on from the present tracks (their §5), so that a drag out and back need not end where it
//! began.

use std::collections::{BTreeMap, BTreeSet};
use std::mem::{discriminant, take};
use std::sync::Arc;

use rayon::prelude::*;

use super::{DiscreteEditor, LogEntry, Occasion};
use crate::constraint::{Constraint, Evaluator, Instant, Target};
use crate::discrete::candidates::Candidate;
use crate::discrete::remap::spliced;
use crate::discrete::tracks::{copies, turns};
use crate::discrete::weighing::{Proposal, Weighing};
use crate::edit::{EditError, Editor};
use crate::index::{CharacterId, ConstraintId};
use crate::scene::Scene;

/// So many sequences of changes of each length are followed.
const BEAM: usize = 8;
/// So many candidates are weighed at once: on any number of threads the same ones.
const BATCH: usize = 8;
/// Solved sequences are kept while they have no more working frames than this, over all characters: some hundred megabytes.
const KEPT_FRAMES: usize = 500_000;
/// A gain in Ê of less, relative to 1 and Ê, is rounding: a stand may become longer at no cost at all.
const NO_GAIN: f64 = 1e-7;

/// What tracks show and where moments are: sequences of changes with the same key lead to the same result.
type Key = Vec<u64>;

/// What every update searches.
pub(super) struct AnchoredSearch {
    /// The motion at rest, with the first targets.
    rest: Scene,
    groups: Vec<Group>,
    /// Group of each constraint.
    group_of: Vec<usize>,
}

/// Characters who are tied to each other, and to nobody else.
struct Group {
    members: Vec<usize>,
    /// Targets that have moved, as they are now.
    targets: Vec<(ConstraintId, Target)>,
    /// Whether the present tracks are those for these targets.
    searched: bool,
    /// What led to the present tracks.
    steps: Vec<Step>,
    known: BTreeMap<Key, DiscreteEditor>,
}

/// A change, on the track that the steps before it lead to.
#[derive(Clone)]
struct Step {
    candidate: Candidate,
    entry: LogEntry,
}

/// A sequence of changes, solved for the present targets. All others are at rest, with their first targets.
struct Node {
    key: Key,
    steps: Vec<Step>,
    state: DiscreteEditor,
    /// How often a member shows one source frame at most.
    copies: usize,
    /// Ê of the members; infinite where there is no solution.
    energy: f64,
    /// Ê of everybody must fall below this.
    worth: f64,
}

/// A node to be.
struct Child {
    parent: usize,
    candidate: Candidate,
    scene: Scene,
    key: Key,
    /// Ê of everybody.
    energy: f64,
}

/// A candidate of a node.
struct Offer<'a> {
    node: usize,
    proposal: &'a Proposal,
    bound: f64,
}

/// The sequence to take of those looked at so far.
struct Best {
    /// The least Ê of sequences as long as it.
    energy: f64,
    steps: Vec<Step>,
    scene: Scene,
}

impl AnchoredSearch {
    /// Of the scene of `editor`, which is at rest.
    pub(super) fn new(editor: &Editor) -> Self {
        let group = |members| Group {
            members,
            targets: Vec::new(),
            searched: false,
            steps: Vec::new(),
            known: BTreeMap::new(),
        };
        let groups: Vec<Group> = editor.tied().into_iter().map(group).collect();
        let rest = editor.scene().clone();
        let first_of = |constraint: &Constraint| {
            let who = constraint.kind.moments().first().map_or(0, |moment| moment.character.as_usize());
            groups.iter().position(|group| group.members.contains(&who)).unwrap_or(0)
        };
        let group_of = rest.constraints.iter().map(first_of).collect();
        Self { rest, groups, group_of }
    }

    /// Keeps in mind that a target has moved.
    pub(super) fn move_target(&mut self, constraint: ConstraintId, target: Target) {
        let group = &mut self.groups[self.group_of[constraint.as_usize()]];
        group
            .targets
            .retain(|(own, known)| *own != constraint || discriminant(known) != discriminant(&target));
        group.targets.push((constraint, target));
        group.searched = false;
    }
}

impl DiscreteEditor {
    /// Takes the tracks to those that are best for the present targets; whether they changed.
    pub(super) fn update_from_rest(
        &mut self,
        search: &mut AnchoredSearch,
        occasion: Occasion,
    ) -> Result<bool, EditError> {
        let present = self.editor.solve().map(|_| ());
        let mut next = self.editor.scene().clone();
        let mut found = Vec::new();
        let most = KEPT_FRAMES / search.groups.len().max(1);
        for (place, group) in search.groups.iter_mut().enumerate().filter(|(_, group)| !group.searched) {
            if present.is_ok() && group.steps.is_empty() && self.worth(&group.members) <= 0.0 {
                continue;
            }
            let Best { steps, scene, .. } = self.search(&search.rest, group, most)?;
            if self.differs(&scene, &group.members) {
                adopt(&mut next, &scene, &group.members);
                found.push((place, steps));
            }
        }
        if found.is_empty() {
            present?;
        } else {
            let before = present.map_or(f64::INFINITY, |()| self.energy().total);
            let mut editor = Editor::new(next)?;
            editor.solve()?;
            self.editor = editor;
            self.tell(&mut search.groups, &found, (before, occasion));
        }
        search.groups.iter_mut().for_each(|group| group.searched = true);
        Ok(!found.is_empty())
    }

    /// Logs what groups have found.
    fn tell(
        &mut self,
        groups: &mut [Group],
        found: &[(usize, Vec<Step>)],
        (before, occasion): (f64, Occasion),
    ) {
        let energy = (before, self.energy().total);
        for (place, steps) in found {
            let Group { members, steps: known, .. } = &mut groups[*place];
            members.iter().for_each(|member| self.forget(CharacterId::from_usize(*member)));
            let entries = changes(known, steps, members);
            self.log.extend(entries.into_iter().map(|entry| LogEntry { occasion, energy, ..entry }));
            known.clone_from(steps);
        }
    }

    /// Whether `members` perform other tracks in `scene`, or are held elsewhere on them.
    fn differs(&self, scene: &Scene, members: &[usize]) -> bool {
        let present = self.editor.scene();
        !alike(present, scene, members) || self.key(present, members) != self.key(scene, members)
    }

    /// What Ê of `members` must fall below to be worth a change.
    fn worth(&self, members: &[usize]) -> f64 {
        let own = self.energy_among(members);
        own - own * self.settings.least_gain - self.settings.least_drop.max(NO_GAIN * (1.0 + own))
    }

    fn energy_among(&self, members: &[usize]) -> f64 {
        let turned = |member: &usize| {
            turns(&self.editor.scene().characters[*member].track, &self.rest_angles[*member])
        };
        let turned = members.iter().map(turned).sum::<f64>();
        self.editor.energy_among(members).with_turns(self.settings.turn_weight * turned).total
    }

    /// The best sequence of changes of a group for its present targets.
    /// Of what it looked at, as much as has `most` working frames is kept for the next time.
    fn search(&self, rest: &Scene, group: &mut Group, most: usize) -> Result<Best, EditError> {
        let mut known = take(&mut group.known);
        let key = self.key(rest, &group.members);
        let state = known.remove(&key).map_or_else(|| self.branch(rest.clone(), &group.members), Ok)?;
        let (first, failure) = node((key, Vec::new(), state), group)?;
        let mut seen = BTreeSet::from([first.key.clone()]);
        let mut best = Best::of(&first, first.energy);
        let (mut level, mut kept) = (vec![first], 0);
        while !level.is_empty() {
            level.par_iter_mut().for_each(|node| node.state.propose());
            let children = children(&level, &group.members, &seen);
            seen.extend(children.iter().map(|child| child.key.clone()));
            let next = grow(&level, children, group, &mut known);
            for Node { key, state, .. } in level {
                kept += state.scene().characters.iter().map(|own| own.track.frame_count()).sum::<usize>();
                if kept <= most {
                    group.known.insert(key, state);
                }
            }
            best = better(best, &next, self.settings.near_tie);
            level = next;
        }
        match failure {
            Some(failure) if !best.energy.is_finite() => Err(failure),
            _ => Ok(best),
        }
    }

    /// An editor of `scene` in which only the tracks of `members` may change.
    fn branch(&self, scene: Scene, members: &[usize]) -> Result<Self, EditError> {
        let mut settings = self.settings.clone();
        (settings.undo, settings.reversible) = (false, false);
        let closed = |who| (!members.contains(&who)).then(Vec::new);
        Ok(Self {
            original: scene.clone(),
            proposals: (0..scene.characters.len()).map(closed).collect(),
            editor: Editor::new(scene)?,
            graph: Arc::clone(&self.graph),
            clips: self.clips.clone(),
            rest_angles: self.rest_angles.clone(),
            settings,
            log: Vec::new(),
            made: Vec::new(),
            search: None,
        })
    }

    /// What the tracks of `members` show, stretch by stretch, and where their moments are.
    fn key(&self, scene: &Scene, members: &[usize]) -> Key {
        let mut key = Vec::new();
        for member in members {
            let mut stretches: Vec<[u64; 3]> = Vec::new();
            for run in &scene.characters[*member].track.runs {
                let clip = self.clips[*member][run.entry] as u64;
                let (first, last) = (u64::from(run.first.0), u64::from(run.last.0));
                match stretches.last_mut() {
                    Some(before) if before[0] == clip && before[2] + 1 == first => before[2] = last,
                    _ => stretches.push([clip, first, last]),
                }
            }
            key.push(stretches.len() as u64);
            key.extend(stretches.into_iter().flatten());
        }
        key.extend(scene.moments().filter_map(|moment| match moment.instant {
            Instant::Shown(frame) if members.contains(&moment.character.as_usize()) => Some(frame.to_bits()),
            _ => None,
        }));
        key
    }
}

/// Solves `state` for the targets of its group; with the error where that cannot be done.
fn node(
    (key, steps, mut state): (Key, Vec<Step>, DiscreteEditor),
    group: &Group,
) -> Result<(Node, Option<EditError>), EditError> {
    for (constraint, target) in &group.targets {
        state.move_target(*constraint, *target)?;
    }
    let shown = |member: &usize| copies(&state.scene().characters[*member].track, &state.clips[*member]);
    let copies = group.members.iter().map(shown).max().unwrap_or(0);
    let failure = state.editor.solve().err();
    let (energy, worth) = match failure {
        Some(_) => (f64::INFINITY, f64::INFINITY),
        None => {
            let own = state.energy_among(&group.members);
            // All others are the same before and after.
            (own, state.energy().total - own + state.worth(&group.members))
        }
    };
    Ok((Node { key, steps, state, copies, energy, worth }, failure))
}

impl Best {
    fn of(node: &Node, energy: f64) -> Self {
        Self { energy, steps: node.steps.clone(), scene: node.state.scene().clone() }
    }
}

/// The better one of `before` and a level of longer sequences.
fn better(before: Best, level: &[Node], near_tie: f64) -> Best {
    let least = level.iter().map(|node| node.energy).fold(f64::INFINITY, f64::min);
    let near = level.iter().filter(|node| node.energy <= least + near_tie);
    let taken = near.min_by(|a, b| a.copies.cmp(&b.copies).then_with(|| a.key.cmp(&b.key)));
    match taken {
        Some(node) if least < before.energy => Best::of(node, least),
        _ => before,
    }
}

/// The changes of a level that lead to the least Ê, each worth it, no two to the same tracks, in rising order of it.
fn children(level: &[Node], members: &[usize], seen: &BTreeSet<Key>) -> Vec<Child> {
    let scales: Vec<Weighing<'_>> = level.iter().map(|node| node.state.weighing()).collect();
    let offers = offers(level, &scales);
    let mut found: Vec<Child> = Vec::new();
    for batch in offers.chunks(BATCH) {
        let most = if found.len() == BEAM { found[BEAM - 1].energy } else { f64::INFINITY };
        let hopeful: Vec<&Offer<'_>> = batch.iter().filter(|offer| offer.bound <= most).collect();
        if hopeful.is_empty() {
            break;
        }
        let weighed: Vec<Option<Child>> =
            hopeful.par_iter().map(|offer| child(offer, level, &scales[offer.node], members)).collect();
        for own in weighed.into_iter().flatten() {
            if !seen.contains(&own.key) && found.iter().all(|known| known.key != own.key) {
                found.push(own);
            }
        }
        found.sort_by(|a, b| a.energy.total_cmp(&b.energy).then_with(|| a.key.cmp(&b.key)));
        found.truncate(BEAM);
    }
    found
}

/// What could be worth it, in rising order of what it costs at least; where all are weighed, in no order.
fn offers<'a>(level: &'a [Node], scales: &[Weighing<'_>]) -> Vec<Offer<'a>> {
    let mut offers = Vec::new();
    for (node, Node { state, worth, .. }) in level.iter().enumerate().filter(|(_, node)| node.worth > 0.0) {
        let all: Vec<&Proposal> = state.proposals.iter().flatten().flatten().collect();
        let known = worth.is_finite() && state.settings.evaluator != Evaluator::BruteForce;
        let bound = |proposal: &&'a Proposal| {
            let first = if known { scales[node].first_bound(proposal) } else { f64::NEG_INFINITY };
            let bound = if known && first < *worth { scales[node].bound(proposal).max(first) } else { first };
            Offer { node, proposal, bound }
        };
        let found: Vec<Offer<'a>> = all.par_iter().map(bound).collect();
        offers.extend(found.into_iter().filter(|offer| offer.bound < *worth));
    }
    offers.sort_by(|a, b| a.bound.total_cmp(&b.bound));
    offers
}

/// Where an offer leads; `None` if it is not worth it.
fn child(offer: &Offer<'_>, level: &[Node], scale: &Weighing<'_>, members: &[usize]) -> Option<Child> {
    let Node { state, worth, .. } = &level[offer.node];
    let candidate = &offer.proposal.candidate;
    let exactly = worth.is_finite() && state.settings.evaluator != Evaluator::BruteForce;
    let energy = if exactly { scale.energy(offer.proposal)? } else { state.weigh(candidate)? };
    if energy >= *worth {
        return None;
    }
    let scene = spliced(state.scene(), candidate.character, &candidate.splice, candidate.keep)?;
    let key = state.key(&scene, members);
    Some(Child { parent: offer.node, candidate: candidate.clone(), scene, key, energy })
}

/// The next level: what `children` lead to, solved; those of the last update where they are `known`.
fn grow(
    level: &[Node],
    children: Vec<Child>,
    group: &Group,
    known: &mut BTreeMap<Key, DiscreteEditor>,
) -> Vec<Node> {
    let mut met = |child: Child| {
        let same = |state: &DiscreteEditor| alike(state.scene(), &child.scene, &group.members);
        let state = known.remove(&child.key).filter(same);
        (child, state)
    };
    let met: Vec<(Child, Option<DiscreteEditor>)> = children.into_iter().map(&mut met).collect();
    let solved = |(child, state): (Child, Option<DiscreteEditor>)| {
        let Child { parent, candidate, scene, key, .. } = child;
        let Node { steps, state: before, .. } = &level[parent];
        let entry = before.entry(&candidate, Occasion::First, (0.0, 0.0));
        let steps = steps.iter().cloned().chain([Step { candidate, entry }]).collect();
        let state = state.map_or_else(|| before.branch(scene, &group.members), Ok).ok()?;
        let (node, failure) = node((key, steps, state), group).ok()?;
        failure.is_none().then_some(node)
    };
    met.into_par_iter().filter_map(solved).collect()
}

/// Gives `next` the tracks of `members`, and the places of their moments, that `scene` has.
fn adopt(next: &mut Scene, scene: &Scene, members: &[usize]) {
    for member in members {
        next.characters[*member].track = scene.characters[*member].track.clone();
    }
    for (own, found) in next.moments_mut().zip(scene.moments()) {
        if members.contains(&own.character.as_usize()) {
            own.instant = found.instant;
        }
    }
}

/// Whether `members` show the same runs; of the same key, these may come from other places of a track's list.
fn alike(a: &Scene, b: &Scene, members: &[usize]) -> bool {
    members.iter().all(|member| a.characters[*member].track.runs == b.characters[*member].track.runs)
}

/// What leads from one sequence of changes to another, member by member: steps that they do not share are taken back, last
/// ones first, then the other's are made.
fn changes(before: &[Step], after: &[Step], members: &[usize]) -> Vec<LogEntry> {
    let mut entries = Vec::new();
    for member in members {
        let of = |steps: &[Step]| -> Vec<Step> {
            steps.iter().filter(|step| step.candidate.character.as_usize() == *member).cloned().collect()
        };
        let (before, after) = (of(before), of(after));
        let common = before.iter().zip(&after).take_while(|(a, b)| a.candidate == b.candidate).count();
        let back = before[common..].iter().rev();
        entries.extend(back.map(|step| LogEntry {
            undo: true,
            frames: -step.entry.frames,
            ..step.entry.clone()
        }));
        entries.extend(after[common..].iter().map(|step| step.entry.clone()));
    }
    entries
}
