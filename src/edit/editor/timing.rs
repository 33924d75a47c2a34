//! When everything happens if one character performs another track.

use super::objects::ObjectsThen;
use super::variant::{Variant, place_of};
use super::{Editor, solve_times};
use crate::edit::EditError;
use crate::edit::groups::Group;
use crate::edit::moved::time_of;
use crate::edit::retarget::seconds_of;
use crate::edit::temporal::{TemporalComponent, TemporalSettings};
use crate::edit::time_row::TimeRow;

/// Times of the tracks that are tied to a variant.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// Component.
    pub(super) group: usize,
    /// Its energy, s².
    pub(super) energy: f64,
    /// Seconds from first to last frame of each of its tracks.
    pub(super) seconds: Vec<f64>,
    /// Where objects are then.
    pub(super) objects: ObjectsThen,
    /// The times themselves, where only solving all tells more.
    pub(super) times: Vec<Vec<f64>>,
}

impl Timing {
    /// Whether somebody's place depends on how others move who are not in the same component: only solving all of them tells.
    pub fn is_entangled(&self) -> bool {
        self.objects.coupled
    }
}

impl Editor {
    /// Times of a variant for the present targets: from the present ones where these tell, else solved.
    ///
    /// # Errors
    /// Those of [`Editor::solve`].
    pub fn timing(&self, variant: &Variant) -> Result<Timing, EditError> {
        let solved = |_: &[usize], counts, rows, settings| TemporalComponent::new(counts, rows, settings);
        self.timing_told(variant).map_or_else(|| self.timing_by(variant, solved), Ok)
    }

    /// The same if the present times tell. Cost: linear in the rows and tracks of the group.
    fn timing_told(&self, variant: &Variant) -> Option<Timing> {
        let (index, place) = place_of(&self.temporal, variant.character)?;
        let Group { component, characters, stale: false, .. } = &self.temporal[index] else { return None };
        let rows = self.time_rows(variant, characters);
        let own = component.rows.iter().filter(|row| variant.binds(row.constraint));
        let retimed = component.retimed((place, variant.own.rest.len()), (own, &rows))?;
        let time = |track: usize, frame: f64| retimed.time(track, frame);
        let objects = self.objects_then(variant, (index, characters, &time)).ok()?;
        let (energy, seconds) = (retimed.energy, retimed.durations());
        (!objects.coupled).then_some(Timing { group: index, energy, seconds, objects, times: Vec::new() })
    }

    /// Temporal rows of a variant, with the present targets and tracks numbered as in a group of `characters`.
    fn time_rows(&self, variant: &Variant, characters: &[usize]) -> Vec<TimeRow> {
        let number = |track: usize| characters.binary_search(&track).unwrap_or_default();
        let mut rows = variant.times.clone();
        for row in &mut rows {
            row.seconds =
                seconds_of(&self.scene.constraints[row.constraint.as_usize()].kind).unwrap_or(row.seconds);
            row.at.track = number(row.at.track);
            if let Some(minus) = &mut row.minus {
                minus.track = number(minus.track);
            }
        }
        rows
    }

    /// Times by the system that `build` makes of characters, their numbers of frames, rows, and settings.
    pub(super) fn timing_by(
        &self,
        variant: &Variant,
        build: impl FnOnce(&[usize], Vec<usize>, Vec<TimeRow>, TemporalSettings) -> TemporalComponent,
    ) -> Result<Timing, EditError> {
        let (index, place) = place_of(&self.temporal, variant.character).unwrap_or_default();
        let Group { component, characters, frames, .. } = &self.temporal[index];
        let mut counts = component.counts.clone();
        counts[place] = variant.own.rest.len();
        let mut rows = self.time_rows(variant, characters);
        rows.extend(component.rows.iter().filter(|row| !variant.binds(row.constraint)));
        rows.sort_by_key(|row| row.constraint);
        let component = build(characters, counts, rows, component.settings());
        let characters = characters.clone();
        let mut group = Group { characters, component, frames: *frames, stale: true };
        solve_times(&self.scene, &mut group)?;
        let TemporalComponent { times, energy, .. } = &group.component;
        let time = |track: usize, frame: f64| time_of(&times[track], frame);
        let objects = self.objects_then(variant, (index, &group.characters, &time))?;
        let seconds = times.iter().map(|times| times[times.len() - 1] - times[0]).collect();
        let times = if objects.coupled { times.clone() } else { Vec::new() };
        Ok(Timing { group: index, energy: energy.0 + energy.1, seconds, objects, times })
    }
}
