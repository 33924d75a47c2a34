//! What some characters cost by themselves.

use super::{Editor, extent};
use crate::edit::energy::Energy;
use crate::edit::groups::connected;

impl Editor {
    /// Characters who are tied to each other by constraints, in space or time, each group and the list of groups rising; all are
    /// one group where objects move.
    pub fn tied(&self) -> Vec<Vec<usize>> {
        let count = self.scene.characters.len();
        if !self.is_separable() {
            return connected(count, (1..count).map(|character| (0, character)));
        }
        let links = self.scene.constraints.iter().flat_map(|constraint| {
            let all: Vec<usize> =
                constraint.kind.moments().iter().map(|moment| moment.character.as_usize()).collect();
            all.windows(2).map(|pair| (pair[0], pair[1])).collect::<Vec<_>>()
        });
        connected(count, links)
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
