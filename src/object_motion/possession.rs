//! Who has an object when: what times alone decide of it.

use super::SAME_MOMENT;

/// Who has an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Possessor {
    /// Nobody yet: it goes its own course.
    Itself,
    /// A carry, by position in the scene.
    Carried(usize),
    /// Nobody: it stays where this carry ended.
    Left(usize),
}

/// Who has an object how long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Possession {
    /// Scene time, seconds; −∞ at first.
    pub from: f64,
    /// Scene time, seconds: where the next one begins, ∞ at last.
    pub to: f64,
    /// Who.
    pub by: Possessor,
}

/// Who has an object along time, without gap. `carries`: those of the object in the order of the scene, each with the times of
/// its grasp and release; where they overlap, each is cut short where the next begins.
pub fn possessions(carries: &[(usize, [f64; 2])]) -> Vec<Possession> {
    let mut all = vec![Possession { from: f64::NEG_INFINITY, to: f64::INFINITY, by: Possessor::Itself }];
    for (carry, [grasp, release]) in carries {
        // A carry cut short has no stretch after its release: that one goes first.
        let is_left = |last: &Possession| matches!(last.by, Possessor::Left(_)) && last.from >= *grasp;
        if all.last().is_some_and(is_left) {
            all.pop();
        }
        let last = all.len() - 1;
        let grasp = grasp.max(all[last].from);
        let release = release.max(grasp);
        all[last].to = grasp;
        all.push(Possession { from: grasp, to: release, by: Possessor::Carried(*carry) });
        all.push(Possession { from: release, to: f64::INFINITY, by: Possessor::Left(*carry) });
    }
    all
}

/// The possession that holds just before a scene time: at a hand-over the one that ends.
pub fn possession_before(all: &[Possession], seconds: f64) -> &Possession {
    let before = |own: &Possession| own.from < seconds - SAME_MOMENT;
    &all[all.partition_point(before).saturating_sub(1)]
}
