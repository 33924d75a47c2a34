//! What the energy would be if one character performed another track, where objects tie paths to each other: all whom that
//! concerns are solved as by [`Editor::solve`], all others stay as they are.

use super::timing::Timing;
use super::variant::Variant;
use super::{Edit, EditError, Editor, extent};
use crate::constraint::ConstraintKind;
use crate::edit::carrying::HandsAtRest;
use crate::edit::energy::{Energy, Extent};
use crate::edit::expand::{Expansion, Following, expand_some};
use crate::edit::groups::{Group, spatial_groups_of};
use crate::edit::hold::Hold;
use crate::edit::moved::EditedCharacter;
use crate::edit::spatial::SpatialComponent;
use crate::index::CharacterId;
use crate::path::RestPath;
use crate::scene::Scene;

/// First character of a spatial component, and its energies, m².
type Sums = (usize, (f64, f64));

impl Editor {
    /// Ê if `variant` were performed, whose scene is `scene`, for the targets of the last solve: the same as that of an editor
    /// built for it. `timing`: its times. Cost: linear in the frames of all who are tied to it, also by objects, as often as it
    /// takes until they stay.
    ///
    /// # Errors
    /// Those of [`Editor::solve`].
    pub fn energy_entangled(
        &self,
        scene: Scene,
        variant: &Variant,
        timing: &Timing,
    ) -> Result<Energy, EditError> {
        let concerned = self.concerned(variant.character);
        let mut part = self.part(scene, (variant, timing), &concerned)?;
        let nothing_else = vec![false; part.ties.entangled.len()];
        part.solve_tied(&nothing_else)?;
        part.take_paths(|_| true);
        let mut extents = self.extents.clone();
        for who in part.spatial.iter().flat_map(|group| &group.characters) {
            extents[*who].length = part.extents[*who].length;
        }
        self.take_seconds(variant, timing, &mut extents);
        let untouched = self.spatial.iter().zip(&concerned).filter(|(_, concerned)| !**concerned);
        let mut sums: Vec<Sums> = untouched.map(|(group, _)| sums_of(group)).collect();
        sums.extend(part.spatial.iter().map(sums_of));
        // In the order of Editor::solve.
        sums.sort_unstable_by_key(|own| own.0);
        let add = |sum: (f64, f64), (_, own): &Sums| (sum.0 + own.0, sum.1 + own.1);
        let (shape, scale) = sums.iter().fold((0.0, 0.0), add);
        Ok(Energy::new(shape, scale, self.time_sum(timing), &extents, self.scene.mode))
    }

    /// An editor of the paths of all whom a variant concerns, with the rows on these; `concerned`: of each spatial component.
    fn part(
        &self,
        scene: Scene,
        (variant, timing): (&Variant, &Timing),
        concerned: &[bool],
    ) -> Result<Self, EditError> {
        let members = self.members(concerned);
        let mut rests: Vec<&RestPath> = self.edit.characters.iter().map(|own| &own.rest).collect();
        rests[variant.character] = &variant.own.rest;
        let wanted = |kind: &ConstraintKind| {
            let spatial = matches!(kind, ConstraintKind::Pin { .. } | ConstraintKind::Relative { .. });
            spatial && kind.moments().iter().any(|moment| members[moment.character.as_usize()])
        };
        let Expansion { mut held, following, .. } = expand_some(&scene, &rests, wanted);
        let own = |who: usize| EditedCharacter {
            times: self.times_then(who, timing).to_vec(),
            ..EditedCharacter::at_rest(rests[who].clone())
        };
        let nobody = || EditedCharacter::at_rest(RestPath::default());
        let characters = members.iter().enumerate().map(|(who, is)| if *is { own(who) } else { nobody() });
        let characters: Vec<EditedCharacter> = characters.collect();
        let of = |(own, is): (&EditedCharacter, &bool)| if *is { extent(own) } else { Extent::default() };
        let extents = characters.iter().zip(&members).map(of).collect();
        let mut hands = HandsAtRest::default();
        hands.adopt(&self.hands, CharacterId::from_usize(variant.character));
        let following: Vec<(Following, Hold)> =
            following.into_iter().map(|row| (row, held[row.row].hold)).collect();
        let mut part = Self {
            ties: self.ties.sets_alone(),
            scene,
            edit: Edit { characters, energy: Energy::default(), notes: Vec::new() },
            extents,
            spatial: Vec::new(),
            temporal: Vec::new(),
            held: Vec::new(),
            times: Vec::new(),
            coupled: vec![false; following.len()],
            following,
            hands,
            regrouped: 0,
            timed: 0,
            settings: self.settings,
            backend: self.backend,
        };
        let all: Vec<usize> = (0..part.following.len()).collect();
        let read = part.read_objects(&all)?;
        for ((row, hold), read) in part.following.iter_mut().zip(read) {
            *hold = read;
            held[row.row].hold = read;
        }
        let wanted = |who: usize| members[who];
        (part.spatial, part.held) = spatial_groups_of((&rests, wanted), &held, self.settings, self.backend);
        Ok(part)
    }

    /// Of each character, whether they are in one of these spatial components.
    fn members(&self, concerned: &[bool]) -> Vec<bool> {
        let mut members = vec![false; self.edit.characters.len()];
        for (group, _) in self.spatial.iter().zip(concerned).filter(|(_, concerned)| **concerned) {
            group.characters.iter().for_each(|who| members[*who] = true);
        }
        members
    }

    /// Times of a character with those of a variant.
    fn times_then<'a>(&'a self, who: usize, timing: &'a Timing) -> &'a [f64] {
        match self.temporal[timing.group].characters.binary_search(&who) {
            Ok(place) => &timing.times[place],
            Err(_) => &self.edit.characters[who].times,
        }
    }
}

fn sums_of(group: &Group<SpatialComponent>) -> Sums {
    let energy = group.component.energy;
    (group.characters[0], (energy.shape + energy.shape_soft, energy.scale + energy.scale_soft))
}
