//! Relatives, reaches and hand-overs have two moments that need not be simultaneous: warns where nothing ties the two in time.

use std::collections::BTreeMap;

use crate::constraint::{ConstraintKind, Moment, Partner, When};
use crate::effector::EffectorTarget;
use crate::object::hand_overs;
use crate::scene::checker::{Checked, order};
use crate::scene::moment::Member;
use crate::scene::report::{Place, Report};

/// Warns of relatives, reaches and hand-overs between characters whose moments no sync, time or duration ties.
pub fn warn_of_untied(checked: &Checked, cast: &[Member], report: &mut Report) {
    let ties = Ties::of(checked, cast);
    for (constraint, place) in checked.constraints.iter().zip(&checked.places) {
        if let ConstraintKind::Relative { when, partner: Partner::Character(other), .. } = &constraint.kind {
            ties.warn((when, other), place, report);
        }
    }
    for (effector, place) in checked.end_effectors.iter().zip(&checked.effector_places) {
        if let EffectorTarget::Joint { when: Some(other), .. } = &effector.target {
            ties.warn((&effector.when, other), place, report);
        }
    }
    for (before, next) in hand_overs(&checked.carries) {
        let (release, grasp) = (&checked.carries[before].during.1, &checked.carries[next].during.0);
        if release.character != grasp.character && !ties.tied(grasp, release) {
            let message = format!("nothing ties the time of \"{}\" to \"{}\"", grasp.name, release.name);
            let help = format!(
                "add a [[sync]] with moments = [\"{}\", \"{}\"], and an offset where the object rests in between",
                grasp.name, release.name
            );
            report.warn(&checked.carry_places[next], message, help);
        }
    }
}

/// A moment, whatever its name: character, clip of the track, bits of the working frame.
type Knot = (u32, usize, u64);

/// Sets of moments that time constraints tie together.
struct Ties<'a> {
    cast: &'a [Member],
    positions: BTreeMap<Knot, usize>,
    /// Parent of each moment in the forest of sets; 0 is the clock.
    parents: Vec<usize>,
}

impl<'a> Ties<'a> {
    fn of(checked: &Checked, cast: &'a [Member]) -> Self {
        let mut ties = Self { cast, positions: BTreeMap::new(), parents: vec![0] };
        for constraint in &checked.constraints {
            match &constraint.kind {
                ConstraintKind::Time { at, .. } => {
                    let at = ties.enter(at);
                    ties.join(0, at);
                }
                ConstraintKind::Duration { from, to, .. } => {
                    let (from, to) = (ties.enter(from), ties.enter(to));
                    ties.join(from, to);
                }
                ConstraintKind::Sync { moments, .. } => {
                    for pair in moments.windows(2) {
                        for (a, b) in pair[0].moments().into_iter().zip(pair[1].moments()) {
                            let (a, b) = (ties.enter(a), ties.enter(b));
                            ties.join(a, b);
                        }
                    }
                }
                ConstraintKind::Pin { .. } | ConstraintKind::Relative { .. } => {}
            }
        }
        ties
    }

    /// Warns where the moments of a pair are not tied.
    fn warn(&self, (when, other): (&When, &When), place: &Place, report: &mut Report) {
        let mut pairs = when.moments().into_iter().zip(other.moments());
        let Some((mine, theirs)) = pairs.find(|(mine, theirs)| !self.tied(mine, theirs)) else {
            return;
        };
        let message = format!("nothing makes \"{}\" and \"{}\" happen together", mine.name, theirs.name);
        let help = match when {
            When::At(_) => {
                format!("add a [[sync]] with moments = [\"{}\", \"{}\"]", mine.name, theirs.name)
            }
            When::During(..) => "add a [[sync]] with the two intervals".to_owned(),
        };
        report.warn(place, message, help);
    }

    fn knot(&self, moment: &Moment) -> Knot {
        let (entry, working) = order(moment.instant, &self.cast[moment.character.as_usize()]);
        (moment.character.0, entry, working.to_bits())
    }

    fn enter(&mut self, moment: &Moment) -> usize {
        let knot = self.knot(moment);
        let next = self.parents.len();
        let position = *self.positions.entry(knot).or_insert(next);
        if position == next {
            self.parents.push(next);
        }
        position
    }

    fn root(&self, mut position: usize) -> usize {
        while self.parents[position] != position {
            position = self.parents[position];
        }
        position
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b)] = a.min(b);
    }

    fn tied(&self, a: &Moment, b: &Moment) -> bool {
        let position = |moment| self.positions.get(&self.knot(moment));
        match (position(a), position(b)) {
            (Some(a), Some(b)) => self.root(*a) == self.root(*b),
            _ => false,
        }
    }
}
