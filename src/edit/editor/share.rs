//! What some characters cost by themselves, and what of them other solvers are given.

use std::collections::BTreeMap;

use super::{Editor, extent};
use crate::edit::direct::FrameProblem;
use crate::edit::energy::Energy;
use crate::edit::expand::Following;
use crate::edit::groups::connected;

impl Editor {
    /// The shape phase of each connected group as the problem of all its frames, as last solved: for other solvers to be
    /// compared with. None but with [`Backend::Direct`](crate::edit::Backend::Direct).
    pub fn shape_problems(&self) -> impl Iterator<Item = FrameProblem<'_>> {
        self.spatial.iter().filter_map(|group| group.component.shape.frame_problem())
    }

    /// Characters who are tied to each other by constraints, in space or time, or by what they carry, each group and the list of
    /// groups rising.
    pub fn tied(&self) -> Vec<Vec<usize>> {
        let count = self.scene.characters.len();
        let by_objects = self.carried_by_some();
        let links = self.scene.constraints.iter().flat_map(|constraint| {
            let all: Vec<usize> =
                constraint.kind.moments().iter().map(|moment| moment.character.as_usize()).collect();
            all.windows(2).map(|pair| (pair[0], pair[1])).collect::<Vec<_>>()
        });
        connected(count, links.chain(by_objects))
    }

    /// Pairs of characters of whom a place held relative to an object, or who has it when, depends on the other.
    fn carried_by_some(&self) -> Vec<(usize, usize)> {
        let mut first = BTreeMap::new();
        let mut pairs = Vec::new();
        for carry in &self.scene.carries {
            let moments = [&carry.during.0, &carry.during.1].map(|moment| moment.character);
            for who in carry.by.iter().chain(&moments) {
                pairs.push((*first.entry(carry.object).or_insert(who.as_usize()), who.as_usize()));
            }
        }
        let known = |(row, _): &(Following, _)| Some((row.at.path, *first.get(&row.object)?));
        pairs.extend(self.following.iter().filter_map(known));
        pairs
    }

    /// Terms of Ê of `members`, who are tied to nobody else, for the last solve. Cost: linear in characters.
    pub fn energy_among(&self, members: &[usize]) -> Energy {
        let mut sums = (0.0, 0.0, 0.0);
        for group in self.spatial.iter().filter(|group| members.contains(&group.characters[0])) {
            let energy = group.component.energy;
            sums.0 += energy.shape + energy.shape_soft;
            sums.1 += energy.scale + energy.scale_soft;
        }
        for group in self.temporal.iter().filter(|group| members.contains(&group.characters[0])) {
            sums.2 += group.component.energy.0 + group.component.energy.1;
        }
        let extents: Vec<_> = members.iter().map(|member| extent(&self.edit.characters[*member])).collect();
        Energy::new(sums.0, sums.1, sums.2, &extents, self.scene.mode)
    }
}
