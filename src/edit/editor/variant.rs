//! What the energy would be if one character performed another track: only who is connected to them is solved.

use std::sync::Arc;

use cotillion_solvers::Effort;

use crate::clip::working::WORKING_STEP;
use crate::constraint::ConstraintKind;
use crate::edit::EditError;
use crate::edit::energy::{Energy, Extent};
use crate::edit::expand::{Expansion, Following, expand_some};
use crate::edit::groups::Group;
use crate::edit::hold::Prepared;
use crate::edit::own_path::OwnPath;
use crate::edit::retarget::retarget;
use crate::edit::spatial::{Like, Solved, SpatialComponent};
use crate::edit::temporal::TemporalComponent;
use crate::edit::time_row::TimeRow;
use crate::edit::what_if::{GroupResponse, complete, exchanged, on_canvas, response, set_effort};
use crate::index::{CharacterId, ConstraintId};
use crate::path::RestPath;
use crate::scene::Scene;

use super::Editor;
use super::objects::ObjectsThen;
use super::timing::Timing;
use super::told::space_error;

/// Rows that lie elsewhere by no more than this, metres or radians, do so by the rounding of times.
const NOWHERE_ELSE: f64 = 1e-13;

/// Another track in place of a character's, with all rows on it. It outlives drags: numbers are read from the scene anew.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Whose track.
    pub character: usize,
    /// Rest path of the other track.
    pub own: Arc<OwnPath>,
    /// Spatial rows of all constraints that name the character, in their order; paths are numbered as characters.
    pub(super) held: Vec<Prepared>,
    /// Temporal rows of these, likewise.
    pub(super) times: Vec<TimeRow>,
    /// These constraints, rising.
    constraints: Vec<ConstraintId>,
    /// First frame of each run after a seam.
    pub(super) seams: Vec<usize>,
    /// Those of the rows that are relative to objects that move.
    pub(super) following: Vec<Following>,
    /// Carry, which end, frame of the track: where carries begin and end.
    pub(super) carries: Vec<(usize, usize, f64)>,
}

/// A group in which somebody performs another track.
pub struct Exchange {
    group: usize,
    /// Whose paths are in it.
    characters: Vec<usize>,
    component: SpatialComponent,
}

/// What came of a what-if.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WhatIf {
    /// Ê.
    Energy(Energy),
    /// More than was asked about; about how much, if that is known.
    TooMuch(Option<f64>),
}

/// A sketched Ê is off by no more than this, relative to 1 and itself: a hundred times what was seen.
const SKETCHED: f64 = 1e-3;
/// How far apart paths are at most that sketches take for one, metres: a rough one first, which suffices mostly.
const SKETCHES: [f64; 2] = [1e-2, 1e-4];
/// A metre by which lengths are off is no more than so much of Ê: four times what lengths cost.
const PER_METRE: f64 = 2.0;

/// What a variant makes of the paths that are tied to it.
pub(super) struct Space {
    pub(super) group: usize,
    /// Of the shape and the scale phase, m².
    pub(super) energies: (f64, f64),
    /// Length of each of its paths, metres.
    pub(super) lengths: Vec<f64>,
}

impl Variant {
    /// All that times depend on besides the present targets: variants with the same key are shown at the same times.
    pub fn time_key(&self) -> Vec<u64> {
        let points = self.times.iter().flat_map(|row| [Some(row.at), row.minus]).flatten();
        let objects =
            self.carries.iter().map(|own| own.2).chain(self.following.iter().map(|row| row.at.frame));
        let frames = points.map(|point| point.frame).chain(objects).map(f64::to_bits);
        [self.character as u64, self.own.rest.len() as u64].into_iter().chain(frames).collect()
    }
}

impl Editor {
    /// Whether no object moves, or none that concerns a solve.
    pub fn is_separable(&self) -> bool {
        self.scene.carries.is_empty() && self.following.is_empty()
    }

    /// The track that `character` has in `scene`, which differs from this editor's in nothing else but where moments on this
    /// track are; `own`: the path of that track.
    pub fn variant(&self, scene: &Scene, character: CharacterId, own: Arc<OwnPath>) -> Variant {
        let who = character.as_usize();
        let mut rests: Vec<&RestPath> = self.edit.characters.iter().map(|own| &own.rest).collect();
        rests[who] = &own.rest;
        let names = |kind: &ConstraintKind| kind.names(character);
        let Expansion { held, times, following } = expand_some(scene, &rests, names);
        let held = held.into_iter().map(|row| Prepared::new(row, &rests, self.settings.baseline)).collect();
        let named = scene.constraints.iter().enumerate().filter(|(_, constraint)| names(&constraint.kind));
        let constraints = named.map(|(index, _)| ConstraintId::from_usize(index)).collect();
        let starts = scene.characters[who].track.placed_runs().skip(1).map(|(_, start)| start);
        let seams = starts.collect();
        let carries = self.ties.moments(scene, character);
        Variant { character: who, own, held, times, constraints, seams, following, carries }
    }

    /// How the paths of a character's group answer to changes of theirs, for any number of variants; `None` where that cannot
    /// be said beforehand. It holds until systems are factored anew.
    pub fn response(&self, character: CharacterId) -> Option<GroupResponse> {
        let (group, place) = place_of(&self.spatial, character.as_usize())?;
        response(&self.spatial[group].component, place)
    }

    /// Ê if `variant` were performed, for the targets of the last solve: the same as that of an editor built for it. `timing`:
    /// its times, which are not [entangled](Timing::is_entangled).
    ///
    /// # Errors
    /// Those of [`Editor::solve`].
    pub fn energy_of(&self, variant: &Variant, timing: &Timing) -> Result<Energy, EditError> {
        debug_assert!(!timing.is_entangled(), "objects tie groups to each other");
        let (index, place) = place_of(&self.spatial, variant.character).unwrap_or_default();
        let group = &self.spatial[index];
        let mut rests = group.component.rests.clone();
        rests[place] = Arc::clone(&variant.own.rest);
        let mut spaces = vec![self.space(index, rests, self.held_with((variant, &timing.objects), index))?];
        for (other, _) in &timing.objects.elsewhere {
            spaces.push(self.space_then(*other, timing)?);
        }
        Ok(self.energy_with(variant, timing, &spaces))
    }

    /// What component `index` comes to with its own paths and objects where they are then.
    fn space_then(&self, index: usize, timing: &Timing) -> Result<Space, EditError> {
        let component = &self.spatial[index].component;
        let mut held: Vec<Prepared> = component.held.iter().map(unbound).collect();
        timing.objects.place(index, &mut held);
        self.space(index, component.rests.clone(), held)
    }

    /// What component `index` comes to with these paths and rows.
    fn space(
        &self,
        index: usize,
        rests: Vec<Arc<RestPath>>,
        held: Vec<Prepared>,
    ) -> Result<Space, EditError> {
        let mut component = SpatialComponent::new(rests, held, self.settings, self.backend);
        let characters = &self.spatial[index].characters;
        component.solve().map_err(|error| space_error(&self.scene, characters, error))?;
        let lengths = component.bodies.iter().map(|body| body.length).collect();
        Ok(space_of(index, &component, lengths))
    }

    /// The group of `variant` with its path exchanged, factored from the present systems; `None` where these do not tell.
    /// `response`: of the character, since systems were last factored; the exchange holds as long. `before`: that of the same path
    /// until then, whose work is taken over where it is the same. Cost: linear in the frames of the group, and by the cube of
    /// the rows of the path.
    pub fn exchange(
        &self,
        (variant, timing): (&Variant, &Timing),
        response: &GroupResponse,
        before: Option<Exchange>,
    ) -> Option<Exchange> {
        let (index, _) = place_of(&self.spatial, variant.character)?;
        let group = &self.spatial[index];
        let held = self.held_with((variant, &timing.objects), index);
        let same_paths = |before: &Exchange| before.characters == group.characters;
        let before = before.filter(same_paths).map(|before| before.component);
        let component = exchanged(&group.component, response, (&variant.own, before), held)?;
        Some(Exchange { group: index, characters: group.characters.clone(), component })
    }

    /// [`Editor::energy_of`] to ten digits, for the present targets; `None` where the exchange does not tell. It is sketched
    /// first, with the present paths where these hardly change, and given up where it is surely more than `most`; `least`: what it
    /// is at least. Cost: linear in the rows of the group and the frames of the paths that change, in all its frames where it is
    /// not given up.
    pub fn energy_if(
        &self,
        whom: (&Variant, &Timing),
        (exchange, response): (&mut Exchange, &GroupResponse),
        (least, most): (f64, f64),
    ) -> Option<WhatIf> {
        let timing = whom.1;
        if timing.is_entangled() {
            return None;
        }
        let Exchange { group, component, .. } = exchange;
        component.held.iter_mut().for_each(|prepared| {
            retarget(&mut prepared.row, &self.scene);
        });
        timing.objects.place(*group, &mut component.held);
        let doubtful = most + SKETCHED * (1.0 + most);
        on_canvas(response, component, |component| {
            let present = &self.spatial[*group].component;
            for within in SKETCHES {
                let how = (Effort::Sketch, Some(Like { group: present, within }));
                let told =
                    self.energy_below(whom, (*group, &mut *component, response), (least, doubtful), how)?;
                let off = off_by(component);
                match told {
                    WhatIf::Energy(energy) if energy.total - off > doubtful => {
                        return Some(WhatIf::TooMuch(Some(energy.total)));
                    }
                    WhatIf::Energy(_) if off > 0.0 => {}
                    WhatIf::Energy(_) => break,
                    given_up => return Some(given_up),
                }
            }
            self.energy_below(whom, (*group, component, response), (least, most), (Effort::Estimate, None))
        })
    }

    /// Ê by some effort, given up where space takes so much that Ê is more than `most`; `least`: what all else takes at least,
    /// the residuals of the scale phase among it.
    fn energy_below(
        &self,
        (variant, timing): (&Variant, &Timing),
        (group, component, response): (usize, &mut SpatialComponent, &GroupResponse),
        (least, most): (f64, f64),
        (effort, like): (Effort, Option<Like>),
    ) -> Option<WhatIf> {
        let most = (most - least) * WORKING_STEP.powi(3);
        set_effort(component, effort);
        let mut solved = component.solve_below(most, like).ok()?;
        if solved == Solved::LacksScale {
            complete(&self.spatial[group].component, response, (component, &variant.own, effort))?;
            solved = component.go_on(most, like).ok()?;
        }
        match solved {
            Solved::Both => {}
            Solved::TooMuchInAll => {
                let (shape, scale) = space_of(group, component, Vec::new()).energies;
                return Some(WhatIf::TooMuch(Some(least + (shape + scale) / WORKING_STEP.powi(3))));
            }
            Solved::TooMuch | Solved::LacksScale => return Some(WhatIf::TooMuch(None)),
        }
        let lengths = component.bodies.iter().map(|body| body.length).collect();
        let mut spaces = vec![space_of(group, component, lengths)];
        let far = timing.objects.elsewhere.iter().filter(|(_, apart)| *apart > NOWHERE_ELSE);
        for (other, _) in far {
            spaces.push(self.space_then(*other, timing).ok()?);
        }
        Some(WhatIf::Energy(self.energy_with(variant, timing, &spaces)))
    }

    pub(super) fn time_sum(&self, timing: &Timing) -> f64 {
        let own = |(index, group): (usize, &Group<TemporalComponent>)| match index == timing.group {
            true => timing.energy,
            false => group.component.energy.0 + group.component.energy.1,
        };
        self.temporal.iter().enumerate().map(own).fold(0.0, |sum, energy| sum + energy)
    }

    pub(super) fn take_seconds(&self, variant: &Variant, timing: &Timing, extents: &mut [Extent]) {
        extents[variant.character].seconds.0 = (variant.own.rest.len() - 1) as f64 * WORKING_STEP;
        for (character, seconds) in self.temporal[timing.group].characters.iter().zip(&timing.seconds) {
            extents[*character].seconds.1 = *seconds;
        }
    }

    /// Ê of the variant's groups and all others as they are, summed in the order of [`Editor::solve`].
    pub(super) fn energy_with(&self, variant: &Variant, timing: &Timing, spaces: &[Space]) -> Energy {
        let mut extents = self.extents.clone();
        extents[variant.character].length.0 = variant.own.length;
        for Space { group, lengths, .. } in spaces {
            for (character, length) in self.spatial[*group].characters.iter().zip(lengths) {
                extents[*character].length.1 = *length;
            }
        }
        self.take_seconds(variant, timing, &mut extents);
        let mut sums = (0.0, 0.0);
        for (index, group) in self.spatial.iter().enumerate() {
            let energy = group.component.energy;
            let present = (energy.shape + energy.shape_soft, energy.scale + energy.scale_soft);
            let then = spaces.iter().find(|space| space.group == index);
            let (shape, scale) = then.map_or(present, |space| space.energies);
            sums.0 += shape;
            sums.1 += scale;
        }
        Energy::new(sums.0, sums.1, self.time_sum(timing), &extents, self.scene.mode)
    }

    /// Held rows of component `index` with those of the variant in place of its character's.
    pub(super) fn held_with(
        &self,
        (variant, objects): (&Variant, &ObjectsThen),
        index: usize,
    ) -> Vec<Prepared> {
        let group = &self.spatial[index];
        let number = |path: usize| group.characters.binary_search(&path).unwrap_or_default();
        let fresh = |prepared: &Prepared| {
            let mut prepared = *prepared;
            retarget(&mut prepared.row, &self.scene);
            prepared.renumbered(number)
        };
        let others = group.component.held.iter().filter(|prepared| !variant.binds(prepared.row.constraint));
        let mut own = variant.held.iter().peekable();
        let mut held = Vec::with_capacity(variant.held.len() + group.component.held.len());
        for other in others {
            let before = |prepared: &&Prepared| prepared.row.constraint < other.row.constraint;
            held.extend(std::iter::from_fn(|| own.next_if(before)).map(fresh));
            held.push(unbound(other));
        }
        held.extend(own.map(fresh));
        objects.place(index, &mut held);
        held
    }
}

/// A row as it was before anything was left to bodies.
fn unbound(prepared: &Prepared) -> Prepared {
    Prepared { body_only: false, partner_row: None, ..*prepared }
}

impl Variant {
    pub(super) fn binds(&self, constraint: ConstraintId) -> bool {
        self.constraints.binary_search(&constraint).is_ok()
    }

    /// Which row of its constraint the row at a place is.
    pub(super) fn ordinal(&self, place: usize) -> usize {
        let constraint = self.held[place].row.constraint;
        place - self.held.partition_point(|prepared| prepared.row.constraint < constraint)
    }
}

/// By how much less Ê may be where paths were taken for others.
fn off_by(component: &SpatialComponent) -> f64 {
    PER_METRE * component.alike.metres + component.alike.energy / WORKING_STEP.powi(3)
}

/// Group of a character, and place in it.
pub(super) fn place_of<C>(groups: &[Group<C>], character: usize) -> Option<(usize, usize)> {
    let place =
        |(index, group): (usize, &Group<C>)| Some((index, group.characters.binary_search(&character).ok()?));
    groups.iter().enumerate().find_map(place)
}

pub(super) fn space_of(group: usize, component: &SpatialComponent, lengths: Vec<f64>) -> Space {
    let energy = component.energy;
    let energies = (energy.shape + energy.shape_soft, energy.scale + energy.scale_soft);
    Space { group, energies, lengths }
}
