//! What objects tie to each other, and where rows relative to them lie at the times of a variant.
//!
//! As long as nobody has had an object, times alone tell where it is: such a row is one of a place or a heading in the world.
//! Where somebody has had it, the row depends on how they move: whoever it holds and all who have had the object are solved
//! together.

use std::collections::BTreeMap;

use super::Editor;
use super::moving::carry_named;
use super::variant::{Variant, place_of};
use crate::edit::error::EditError;
use crate::edit::expand::Following;
use crate::edit::following::{in_the_world, numbers, step, wanted, with_numbers};
use crate::edit::groups::{Group, connected};
use crate::edit::hold::{Hold, Prepared};
use crate::edit::moved::time_of;
use crate::edit::spatial::SpatialComponent;
use crate::edit::temporal::TemporalComponent;
use crate::index::{CharacterId, ConstraintId, ObjectId};
use crate::object::{hand_overs, same_hands};
use crate::object_motion::{HAND_OVER, Possession, Possessor, both, possession_before, possessions};
use crate::scene::Scene;

/// Objects of a scene, by whom they concern.
#[derive(Clone, Debug, Default)]
pub(super) struct ObjectTies {
    /// Of each temporal component: carries that follow each other, one of them of its characters.
    hand_overs: Vec<Vec<(usize, usize)>>,
    /// Of each temporal component: carries of different objects by the same hands, whose these are, one of its characters.
    same_hands: Vec<Vec<(usize, usize, CharacterId)>>,
    /// Of each temporal component: rows relative to objects, by position in the list of these, that its times may move.
    rows_in_time: Vec<Vec<usize>>,
    /// Of each spatial component: rows on its paths.
    rows_in_space: Vec<Vec<usize>>,
    /// Of each character: carries that begin or end at a moment of theirs.
    named: Vec<Vec<usize>>,
    /// Carries of each object, rising.
    pub(super) carries: Vec<Vec<usize>>,
    /// Who could be solved together at some times: number of the set of each character.
    pub(super) sets: Vec<usize>,
    /// Of each of these sets, whether rows in it depend on how others move at present.
    pub(super) entangled: Vec<bool>,
}

/// Where rows relative to objects lie at the times of a variant.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ObjectsThen {
    rows: Vec<RowThen>,
    /// Spatial components besides the variant's whose rows lie elsewhere than at present, rising, and by how much, metres or
    /// radians.
    pub(super) elsewhere: Vec<(usize, f64)>,
    /// Whether some of these rows depend on how others move.
    pub(super) coupled: bool,
}

/// A row: spatial component, constraint, which of its rows, and what it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RowThen {
    group: usize,
    constraint: ConstraintId,
    ordinal: usize,
    hold: Hold,
}

impl ObjectTies {
    /// Of the objects of `scene`. Cost: linear in carries and rows.
    pub(super) fn new(
        scene: &Scene,
        (spatial, temporal): (&[Group<SpatialComponent>], &[Group<TemporalComponent>]),
        following: &[(Following, Hold)],
    ) -> Self {
        if scene.carries.is_empty() && following.is_empty() {
            return Self::default();
        }
        let count = scene.characters.len();
        let mut carries = vec![Vec::new(); scene.objects.len()];
        let mut own = vec![Vec::new(); count];
        for (index, carry) in scene.carries.iter().enumerate() {
            carries[carry.object.as_usize()].push(index);
            let [first, last] = [&carry.during.0, &carry.during.1].map(|moment| moment.character.as_usize());
            own[first].push(index);
            if last != first {
                own[last].push(index);
            }
        }
        let mut component = vec![0; count];
        for (index, group) in temporal.iter().enumerate() {
            group.characters.iter().for_each(|who| component[*who] = index);
        }
        let who_has = |own: &Vec<usize>| -> Vec<usize> {
            own.iter().flat_map(|carry| carriers(scene, *carry)).collect()
        };
        let who_have: Vec<Vec<usize>> = carries.iter().map(who_has).collect();
        let in_time = |own: &Vec<usize>| unique(own.iter().map(|who| component[*who]));
        let components: Vec<Vec<usize>> = who_have.iter().map(in_time).collect();
        let (mut pairs, mut rows) = (vec![Vec::new(); temporal.len()], vec![Vec::new(); temporal.len()]);
        for (first, second) in hand_overs(&scene.carries) {
            let who = [first, second].into_iter().flat_map(|carry| carriers(scene, carry));
            unique(who.map(|who| component[who]))
                .into_iter()
                .for_each(|own| pairs[own].push((first, second)));
        }
        let mut loads = vec![Vec::new(); temporal.len()];
        for pair in same_hands(&scene.carries) {
            let who = [pair.0, pair.1].into_iter().flat_map(|carry| carriers(scene, carry));
            unique(who.map(|who| component[who])).into_iter().for_each(|own| loads[own].push(pair));
        }
        for (index, (row, _)) in following.iter().enumerate() {
            let concerned = components[row.object.as_usize()].iter().copied().chain([component[row.at.path]]);
            unique(concerned).into_iter().for_each(|own| rows[own].push(index));
        }
        let in_space =
            spatial.iter().flat_map(|group| group.characters.windows(2).map(|pair| (pair[0], pair[1])));
        let by_rows = following
            .iter()
            .filter_map(|(row, _)| Some((row.at.path, *who_have[row.object.as_usize()].first()?)));
        let asked = unique(following.iter().map(|(row, _)| row.object.as_usize()));
        let by_objects =
            asked.iter().flat_map(|object| who_have[*object].windows(2).map(|pair| (pair[0], pair[1])));
        let mut sets = vec![0; count];
        for (index, set) in
            connected(count, in_space.chain(by_rows).chain(by_objects)).into_iter().enumerate()
        {
            set.into_iter().for_each(|who| sets[who] = index);
        }
        Self {
            hand_overs: pairs,
            same_hands: loads,
            rows_in_time: rows,
            rows_in_space: Vec::new(),
            named: own,
            carries,
            sets,
            entangled: vec![false; count],
        }
    }

    /// Takes note of the spatial components that rows are in.
    pub(super) fn regroup(
        &mut self,
        spatial: &[Group<SpatialComponent>],
        held: &[(usize, usize)],
        following: &[(Following, Hold)],
    ) {
        self.rows_in_space = vec![Vec::new(); spatial.len()];
        for (index, (row, _)) in following.iter().enumerate() {
            self.rows_in_space[held[row.row].0].push(index);
        }
    }

    /// Takes note of which rows depend on how others move.
    pub(super) fn entangle(&mut self, following: &[(Following, Hold)], coupled: &[bool]) {
        self.entangled.fill(false);
        for ((row, _), coupled) in following.iter().zip(coupled) {
            self.entangled[self.sets[row.at.path]] |= *coupled;
        }
    }

    /// Of each set, whether times of the components that have changed concern it.
    pub(super) fn timed(
        &self,
        temporal: &[Group<TemporalComponent>],
        following: &[(Following, Hold)],
    ) -> Vec<bool> {
        let mut timed = vec![false; self.entangled.len()];
        for (_, rows) in temporal.iter().zip(&self.rows_in_time).filter(|(group, _)| group.stale) {
            rows.iter().for_each(|row| timed[self.sets[following[*row].0.at.path]] = true);
        }
        timed
    }

    /// What a part of the scene needs of these.
    pub(super) fn sets_alone(&self) -> Self {
        let (sets, entangled) = (self.sets.clone(), vec![false; self.entangled.len()]);
        Self { sets, entangled, ..Self::default() }
    }

    fn is_empty(&self) -> bool {
        self.carries.is_empty()
    }

    /// Moments of a character's track at which carries begin and end: carry, which end, frame.
    pub(super) fn moments(&self, scene: &Scene, who: CharacterId) -> Vec<(usize, usize, f64)> {
        let named = self.named.get(who.as_usize()).into_iter().flatten();
        let ends = named.flat_map(|carry| [(*carry, 0), (*carry, 1)]);
        let own = |(carry, end): (usize, usize)| {
            let moment = moment_of(scene, carry, end);
            (moment.character == who).then(|| (carry, end, scene.frame_of(moment)))
        };
        ends.filter_map(own).collect()
    }
}

impl ObjectsThen {
    /// Gives held rows of a component, in the order of constraints, the places they have then.
    pub(super) fn place(&self, group: usize, held: &mut [Prepared]) {
        for RowThen { constraint, ordinal, hold, .. } in self.rows.iter().filter(|row| row.group == group) {
            let first = held.partition_point(|prepared| prepared.row.constraint < *constraint);
            if let Some(prepared) = held.get_mut(first + ordinal) {
                prepared.row.hold = with_numbers(&prepared.row.hold, numbers(hold));
            }
        }
    }
}

impl Editor {
    /// Where rows relative to objects lie if `variant` is shown when `times` says, of the characters of temporal component
    /// `index`. Cost: linear in the rows and carries that concern them.
    ///
    /// # Errors
    /// [`EditError::CarriesOverlap`].
    pub(super) fn objects_then(
        &self,
        variant: &Variant,
        (index, characters, times): (usize, &[usize], &Times<'_>),
    ) -> Result<ObjectsThen, EditError> {
        if self.ties.is_empty() {
            return Ok(ObjectsThen::default());
        }
        let clock = Clock { editor: self, variant, characters, times };
        clock.overlap(&self.ties.hand_overs[index])?;
        clock.two_loads(&self.ties.same_hands[index])?;
        let entangled = self.ties.entangled[self.ties.sets[variant.character]];
        if entangled {
            return Ok(ObjectsThen { coupled: true, ..ObjectsThen::default() });
        }
        Ok(self.rows_then(&clock, index))
    }

    /// The same of rows alone.
    fn rows_then(&self, clock: &Clock<'_>, index: usize) -> ObjectsThen {
        let (own, _) = place_of(&self.spatial, clock.variant.character).unwrap_or_default();
        let (mut then, mut known) = (ObjectsThen::default(), BTreeMap::new());
        for row in &clock.variant.following {
            let (constraint, ordinal) = (row.constraint, clock.variant.ordinal(row.row));
            match clock.told(row, &mut known) {
                Some(hold) => then.rows.push(RowThen { group: own, constraint, ordinal, hold }),
                None => then.coupled = true,
            }
        }
        for row in unique(self.ties.rows_in_time[index].iter().chain(&self.ties.rows_in_space[own]).copied())
        {
            let (following, present) = &self.following[row];
            if clock.variant.binds(following.constraint) {
                continue;
            }
            let Some(hold) = clock.told(following, &mut known) else {
                then.coupled = true;
                continue;
            };
            let (group, ordinal) = self.place_of_row(following);
            then.rows.push(RowThen { group, constraint: following.constraint, ordinal, hold });
            if group != own && hold != *present {
                let apart = step(present, &hold).into_iter().map(f64::abs).fold(0.0, f64::max);
                then.elsewhere.push((group, apart));
            }
        }
        // The farthest row of each.
        then.elsewhere.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
        then.elsewhere.dedup_by_key(|own| own.0);
        then
    }

    /// Spatial component of a row relative to an object, and which row of its constraint it is.
    fn place_of_row(&self, following: &Following) -> (usize, usize) {
        let (group, place) = self.held[following.row];
        let held = &self.spatial[group].component.held;
        (group, place - held.partition_point(|prepared| prepared.row.constraint < following.constraint))
    }

    /// Of each spatial component, whether a change of the track of `who` may change it.
    pub(super) fn concerned(&self, who: usize) -> Vec<bool> {
        let (own, _) = place_of(&self.spatial, who).unwrap_or_default();
        if self.ties.is_empty() {
            return (0..self.spatial.len()).map(|group| group == own).collect();
        }
        let (in_time, _) = place_of(&self.temporal, who).unwrap_or_default();
        let rows = self.ties.rows_in_time[in_time].iter().map(|row| self.following[*row].0.at.path);
        let sets = unique(rows.chain([who]).map(|who| self.ties.sets[who]));
        let touched = |group: &Group<SpatialComponent>| sets.contains(&self.ties.sets[group.characters[0]]);
        self.spatial.iter().map(touched).collect()
    }
}

/// When everything happens if a variant is shown at its times.
struct Clock<'a> {
    editor: &'a Editor,
    variant: &'a Variant,
    /// Whose times these are, rising.
    characters: &'a [usize],
    times: &'a Times<'a>,
}

/// Seconds at which a frame is shown, which may lie between two: place of the character, frame.
pub(super) type Times<'a> = dyn Fn(usize, f64) -> f64 + 'a;

impl Clock<'_> {
    fn time(&self, who: usize, frame: f64) -> f64 {
        match self.characters.binary_search(&who) {
            Ok(place) => (self.times)(place, frame),
            Err(_) => time_of(&self.editor.edit.characters[who].times, frame),
        }
    }

    /// When a carry begins, or ends.
    fn moment(&self, carry: usize, end: usize) -> f64 {
        let moment = moment_of(&self.editor.scene, carry, end);
        let own = self.variant.carries.iter().find(|own| (own.0, own.1) == (carry, end));
        let frame = own.map_or_else(|| self.editor.scene.frame_of(moment), |own| own.2);
        self.time(moment.character.as_usize(), frame)
    }

    fn overlap(&self, hand_overs: &[(usize, usize)]) -> Result<(), EditError> {
        for (first, second) in hand_overs {
            let seconds = self.moment(*first, 1) - self.moment(*second, 0);
            if seconds > HAND_OVER {
                let [first, second] = [*first, *second].map(|carry| carry_named(&self.editor.scene, carry));
                return Err(EditError::CarriesOverlap { first, second, seconds });
            }
        }
        Ok(())
    }

    fn two_loads(&self, same_hands: &[(usize, usize, CharacterId)]) -> Result<(), EditError> {
        for (first, second, character) in same_hands {
            let [own, other] = [first, second].map(|carry| [0, 1].map(|end| self.moment(*carry, end)));
            let seconds = both(own, other);
            if seconds > HAND_OVER {
                let scene = &self.editor.scene;
                let [first, second] = [*first, *second].map(|carry| carry_named(scene, carry));
                let character = scene.characters[character.as_usize()].name.clone();
                return Err(EditError::HandsTaken { character, first, second, seconds });
            }
        }
        Ok(())
    }

    /// A row as times alone tell it; `None` where somebody has had the object. `known`: who has those asked for when.
    fn told(&self, row: &Following, known: &mut BTreeMap<ObjectId, Vec<Possession>>) -> Option<Hold> {
        let Editor { scene, ties, .. } = self.editor;
        let seconds = self.time(row.at.path, row.at.frame);
        let found = || {
            let carries = ties.carries[row.object.as_usize()].iter();
            let times = carries.map(|carry| (*carry, [0, 1].map(|end| self.moment(*carry, end))));
            possessions(&times.collect::<Vec<_>>())
        };
        let possessions = known.entry(row.object).or_insert_with(found);
        if possession_before(possessions, seconds).by != Possessor::Itself {
            return None;
        }
        let wanted = wanted(&scene.constraints[row.constraint.as_usize()].kind, row.before);
        let pose = scene.objects[row.object.as_usize()].course.pose_at(seconds);
        Some(in_the_world(row, wanted, pose))
    }
}

fn moment_of(scene: &Scene, carry: usize, end: usize) -> &crate::constraint::Moment {
    let (first, last) = &scene.carries[carry].during;
    if end == 0 { first } else { last }
}

/// Whoever has to do with a carry.
fn carriers(scene: &Scene, carry: usize) -> Vec<usize> {
    let carry = &scene.carries[carry];
    let moments = [&carry.during.0, &carry.during.1].map(|moment| moment.character);
    carry.by.iter().chain(&moments).map(|who| who.as_usize()).collect()
}

fn unique(values: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut all: Vec<usize> = values.collect();
    all.sort_unstable();
    all.dedup();
    all
}
