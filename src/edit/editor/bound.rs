//! What is known of the energy with another track before anything is solved in space.

use super::Editor;
use super::timing::Timing;
use super::variant::{Space, Variant, place_of};
use crate::clip::working::WORKING_STEP;
use crate::edit::bound_rows::weight_of;
use crate::edit::energy::{Energy, least_length_cost};
use crate::edit::groups::Group;
use crate::edit::hold::{Hold, Prepared};
use crate::geometry::c64;
use crate::index::CharacterId;
use crate::path::RestPath;

/// Bounds are lowered by this share of the energies they come from, and by as much without units.
const ROUNDING: f64 = 1e-9;

/// Points of one path spliced in two ways are apart by rounding only, metres.
const SAME_PLACE: f64 = 1e-11;

impl Editor {
    /// Whether a variant takes the very path that its character has, to rounding.
    pub fn has_path(&self, variant: &Variant) -> bool {
        let (own, present) = (&variant.own.rest, &self.edit.characters[variant.character].rest);
        let near = |(a, b): (&c64, &c64)| (a - b).norm_sqr() <= SAME_PLACE * SAME_PLACE;
        own.len() == present.len()
            && own.rigid == present.rigid
            && own.positions.iter().zip(&present.positions).all(near)
    }

    /// A lower bound of [`Editor::energy_of`]: exact times; paths that go straight from one place to the next. Cost: by the
    /// rows and the frames of the variant, and the rows of its group.
    pub fn energy_bound(&self, variant: &Variant, timing: &Timing) -> f64 {
        if timing.is_entangled() || !timing.objects.elsewhere.is_empty() {
            return self.time_bound(variant, timing);
        }
        let (index, place) = place_of(&self.spatial, variant.character).unwrap_or_default();
        let group = &self.spatial[index];
        let held = self.held_with((variant, &timing.objects), index);
        let mut lengths: Vec<f64> =
            group.characters.iter().map(|tied| self.extents[*tied].length.0).collect();
        lengths[place] = variant.own.length;
        let places = held_places(&held, group.characters.len());
        let least = |(path, own): (usize, &f64)| {
            let rest = if path == place { &variant.own.rest } else { &group.component.rests[path] };
            let [all, hard] = [true, false].map(|soft| {
                let (straight, give) = straight_length(&places[path], rest, soft);
                least_length_cost((*own, straight), give, self.scene.mode)
            });
            all.max(hard)
        };
        let length_cost: f64 = lengths.iter().enumerate().map(least).sum();
        let space = Space { group: index, energies: (0.0, 0.0), lengths };
        let bound = self.energy_with(variant, timing, &[space]).total + length_cost;
        bound - ROUNDING * (1.0 + bound + self.edit.energy.total)
    }

    /// A lower bound of what all those cost who are not tied to `character`.
    pub fn energy_of_others(&self, character: CharacterId) -> f64 {
        let who = character.as_usize();
        let mut extents = self.extents.clone();
        let mut sums = (0.0, 0.0, 0.0);
        for (Group { characters, component, .. }, concerned) in self.spatial.iter().zip(self.concerned(who)) {
            if concerned {
                characters.iter().for_each(|tied| extents[*tied].length = (0.0, 0.0));
            } else {
                sums.0 += component.energy.shape + component.energy.shape_soft;
                sums.1 += component.energy.scale + component.energy.scale_soft;
            }
        }
        for Group { characters, component, .. } in &self.temporal {
            if characters.binary_search(&who).is_ok() {
                characters.iter().for_each(|tied| extents[*tied].seconds = (0.0, 0.0));
            } else {
                sums.2 += component.energy.0 + component.energy.1;
            }
        }
        let bound = Energy::new(sums.0, sums.1, sums.2, &extents, self.scene.mode).total;
        bound - ROUNDING * (1.0 + bound)
    }

    /// What times alone cost.
    fn time_bound(&self, variant: &Variant, timing: &Timing) -> f64 {
        let mut extents = self.extents.clone();
        extents.iter_mut().for_each(|extent| extent.length = (0.0, 0.0));
        self.take_seconds(variant, timing, &mut extents);
        let time = self.time_sum(timing);
        let bound = Energy::new(0.0, 0.0, time, &extents, self.scene.mode).total;
        bound - ROUNDING * (1.0 + bound)
    }
}

/// A place that a row holds: frame, point, how far the pose is off the path there, weight of a soft row.
type HeldPlace = (f64, c64, f64, Option<f64>);

/// Places that rows hold on each of `count` paths, rising.
fn held_places(held: &[Prepared], count: usize) -> Vec<Vec<HeldPlace>> {
    let mut places = vec![Vec::new(); count];
    for prepared in held {
        if let Hold::Position { at, target } = prepared.row.hold {
            places[at.path].push((at.frame, target, at.detail.norm(), weight_of(prepared)));
        }
    }
    places.iter_mut().for_each(|own| own.sort_by(|a: &HeldPlace, b| a.0.total_cmp(&b.0)));
    places
}

/// Length of the straight lines from each held place of a path to the next, metres, and how readily soft ones give way:
/// residuals that shorten the lines by R cost at least `R²/2g` in Ê, g the second number, m².
/// `soft`: whether soft places count.
fn straight_length(places: &[HeldPlace], rest: &RestPath, soft: bool) -> (f64, f64) {
    // Beyond the last frame, rows go on along its line, which the path does not.
    let counts = |place: &&HeldPlace| (soft || place.3.is_none()) && place.0 <= (rest.len() - 1) as f64;
    let places: Vec<&HeldPlace> = places.iter().filter(counts).collect();
    let between = |pair: &[&HeldPlace]| (pair[1].1 - pair[0].1).norm() - pair[0].2 - pair[1].2;
    let straight = places.windows(2).map(|pair| between(pair).max(0.0)).sum();
    // A place within the path moves two lines.
    let last = places.len().saturating_sub(1);
    let lever = |index: usize| if index == 0 || index == last { 1.0 } else { 4.0 };
    let give = |(index, place): (usize, &&HeldPlace)| {
        place.3.map_or(0.0, |weight| lever(index) * WORKING_STEP.powi(3) / weight)
    };
    (straight, places.iter().enumerate().map(give).sum())
}
