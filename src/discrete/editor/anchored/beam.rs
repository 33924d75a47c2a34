//! One level of sequences of changes after the other: what could follow, and which of it is followed.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::{Group, Key, Step};
use crate::constraint::Evaluator;
use crate::discrete::candidates::Candidate;
use crate::discrete::choose::near;
use crate::discrete::editor::{DiscreteEditor, Occasion};
use crate::discrete::remap::spliced;
use crate::discrete::weighing::{Proposal, Weighing};
use crate::edit::EditError;
use crate::scene::Scene;

/// So many sequences of changes of each length are followed.
const BEAM: usize = 8;
/// So many candidates are weighed at once: on any number of threads the same ones.
const BATCH: usize = 8;

/// A sequence of changes, solved for the present targets. All others are at rest, with their first targets.
pub(super) struct Node {
    pub(super) key: Key,
    pub(super) steps: Vec<Step>,
    pub(super) state: DiscreteEditor,
    /// How often a member shows one source frame at most.
    pub(super) copies: usize,
    /// Ê of the members; infinite where there is no solution.
    pub(super) energy: f64,
    /// Ê of everybody must fall below this.
    pub(super) worth: f64,
}

/// A node to be.
pub(super) struct Child {
    parent: usize,
    candidate: Candidate,
    scene: Scene,
    pub(super) key: Key,
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
pub(super) struct Best {
    /// The least Ê of sequences as long as it.
    pub(super) energy: f64,
    pub(super) steps: Vec<Step>,
    pub(super) scene: Scene,
}

/// Working frames of everybody.
pub(super) fn frames(state: &DiscreteEditor) -> usize {
    state.scene().characters.iter().map(|character| character.track.frame_count()).sum()
}

/// Solves `state` for the targets of its group; with the error where that cannot be done.
pub(super) fn node(
    (key, steps, mut state): (Key, Vec<Step>, DiscreteEditor),
    group: &Group,
) -> Result<(Node, Option<EditError>), EditError> {
    for (constraint, target) in &group.targets {
        state.move_target(*constraint, *target)?;
    }
    let copies = state.copies(state.scene(), &group.members);
    let failure = state.solve().err();
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
    pub(super) fn of(node: &Node, energy: f64) -> Self {
        Self { energy, steps: node.steps.clone(), scene: node.state.scene().clone() }
    }
}

/// The better one of `before` and a level of longer sequences.
pub(super) fn better(before: Best, level: &[Node], near_tie: f64) -> Best {
    let least = level.iter().map(|node| node.energy).fold(f64::INFINITY, f64::min);
    let near_best = level.iter().filter(|node| node.energy <= near(least, near_tie));
    let taken = near_best.min_by(|a, b| a.copies.cmp(&b.copies).then_with(|| a.key.cmp(&b.key)));
    match taken {
        Some(node) if near(least, 0.0) < before.energy => Best::of(node, least),
        _ => before,
    }
}

/// The changes of a level that lead to the least Ê, each worth it, no two to the same tracks, in rising order of it.
pub(super) fn children(level: &[Node], members: &[usize], seen: &BTreeSet<Key>) -> Vec<Child> {
    let scales: Vec<Weighing<'_>> = level.iter().map(|node| node.state.weighing()).collect();
    let mut found: Vec<Child> = Vec::new();
    let mut known = seen.clone();
    for batch in offers(level, &scales).chunks(BATCH) {
        let most = found.get(BEAM - 1).map_or(f64::INFINITY, |last| near(last.energy, 0.0));
        let hopeful: Vec<&Offer<'_>> = batch.iter().filter(|offer| offer.bound <= most).collect();
        if hopeful.is_empty() {
            break;
        }
        let weigh = |offer: &&Offer<'_>| child(offer, level, (&scales[offer.node], members), &known);
        let weighed: Vec<Option<Child>> = hopeful.par_iter().map(weigh).collect();
        let new = |own: &Child| known.insert(own.key.clone());
        found.extend(weighed.into_iter().flatten().filter(new));
        rank(&mut found, |child| child.energy, |child| &child.key);
        found.truncate(BEAM);
    }
    found
}

/// Sorts by Ê, and what differs by rounding only by key.
fn rank<T, K: Ord>(all: &mut [T], energy: impl Fn(&T) -> f64, key: impl Fn(&T) -> &K) {
    all.sort_by(|a, b| energy(a).total_cmp(&energy(b)));
    let mut rest = all;
    while let Some(first) = rest.first() {
        let most = near(energy(first), 0.0);
        let (equals, others) = rest.split_at_mut(rest.partition_point(|own| energy(own) <= most).max(1));
        equals.sort_by(|a, b| key(a).cmp(key(b)));
        rest = others;
    }
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

/// Where an offer leads; `None` if it is not worth it, or `known`.
fn child(
    offer: &Offer<'_>,
    level: &[Node],
    (scale, members): (&Weighing<'_>, &[usize]),
    known: &BTreeSet<Key>,
) -> Option<Child> {
    let Node { state, worth, .. } = &level[offer.node];
    let candidate = &offer.proposal.candidate;
    let scene = spliced(state.scene(), candidate.character, &candidate.splice, candidate.keep)?;
    let key = state.key(&scene, members);
    if known.contains(&key) {
        return None;
    }
    let exactly = worth.is_finite() && state.settings.evaluator != Evaluator::BruteForce;
    let energy = if exactly { scale.energy(offer.proposal)? } else { state.weigh(candidate)? };
    (energy < *worth).then(|| Child { parent: offer.node, candidate: candidate.clone(), scene, key, energy })
}

/// The next level: what `children` lead to, solved; those of the last update where they are `known`.
pub(super) fn grow(
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

/// Whether `members` show the same runs; of the same key, these may come from other places of a track's list.
pub(super) fn alike(a: &Scene, b: &Scene, members: &[usize]) -> bool {
    members.iter().all(|member| a.characters[*member].track.runs == b.characters[*member].track.runs)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Ê in hundredths, with what rounding makes of it: the order is that of exact numbers.
        #[test]
        fn rounding_ranks_nothing(given in prop::collection::vec((0..6_u8, -1e-9..1e-9_f64), 1..30)) {
            let exact: Vec<(f64, usize)> =
                given.iter().enumerate().map(|(key, (energy, _))| (f64::from(*energy) / 100.0, key)).collect();
            let mut ranked = exact.clone();
            ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let mut rounded: Vec<(f64, usize)> =
                exact.iter().zip(&given).map(|((energy, key), (_, off))| (energy + off, *key)).collect();
            rank(&mut rounded, |own| own.0, |own| &own.1);
            let keys = |all: &[(f64, usize)]| all.iter().map(|own| own.1).collect::<Vec<_>>();
            prop_assert_eq!(keys(&rounded), keys(&ranked));
        }
    }
}
