//! Reversible manipulation: every update searches from the motion at rest on, so that its result depends on that and on
//! where the targets are, not on how they got there.
//!
//! Of characters who are tied to each other, sequences of changes are followed level by level, the eight with the least Ê
//! of each length. Every change of a sequence must be worth it, as in any
//! update, so sequences are the longer the farther targets are from rest. Taken is the length that reaches the least Ê; of
//! its sequences within a near tie of that, the one that repeats frames least, then the first one by what it shows. There is
//! no hysteresis against the present tracks: it would remember the way. Solved sequences are kept from one update to the
//! next, by what they lead to; this changes nothing but time. Cost: that of updates of eight tracks for every change of the
//! longest sequence and one more.
//!
//! Source: ours. Kim et al. 2009 go on from the present tracks (their §5), so that a drag out and back need not end where it
//! began.

mod beam;

use std::collections::{BTreeMap, BTreeSet};
use std::mem::{discriminant, take};
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::{DiscreteEditor, LogEntry, Occasion};
use crate::constraint::{Constraint, Instant, Target};
use crate::discrete::candidates::Candidate;
use crate::discrete::choose::worth;
use crate::discrete::tracks::{copies, turns};
use crate::discrete::weighing::Timings;
use crate::edit::{EditError, Editor};
use crate::index::{CharacterId, ConstraintId};
use crate::scene::Scene;

use beam::{Best, Node, alike, better, children, frames, grow, node};

/// Solved sequences are kept while they have no more working frames than this, over all characters: some hundred megabytes.
const KEPT_FRAMES: usize = 500_000;

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
        let present = self.solve();
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
            let mut editor = Editor::of(next, self.settings.backend)?;
            editor.solve()?;
            self.editor = editor;
            self.forget_systems();
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
        worth(self.energy_among(members), &self.settings)
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
                kept += frames(&state);
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
            responses: scene.characters.iter().map(|_| OnceLock::new()).collect(),
            timings: Timings::default(),
            editor: Editor::of(scene, self.settings.backend)?,
            graph: Arc::clone(&self.graph),
            clips: self.clips.clone(),
            rest_angles: self.rest_angles.clone(),
            settings,
            log: Vec::new(),
            made: Vec::new(),
            search: None,
        })
    }

    fn copies(&self, scene: &Scene, members: &[usize]) -> usize {
        let of = |member: &usize| copies(&scene.characters[*member].track, &self.clips[*member]);
        members.iter().map(of).max().unwrap_or(0)
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
