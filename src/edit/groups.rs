//! Connected groups of characters: each is solved by itself, so that nobody is affected by the edits of strangers.

use std::borrow::Borrow;

use rayon::prelude::*;

use crate::edit::hold::{HeldRow, Prepared};
use crate::edit::parallel::at_once;
use crate::edit::settings::{Backend, SpatialSettings};
use crate::edit::spatial::SpatialComponent;
use crate::edit::temporal::{TemporalComponent, TemporalSettings};
use crate::edit::time_row::{StepBounds, TimeRow};
use crate::path::RestPath;

/// A component and the characters in it.
pub struct Group<C> {
    /// In rising order; paths and tracks of the component are numbered in this order.
    pub characters: Vec<usize>,
    /// Their system.
    pub component: C,
    /// Frames of all of them.
    pub frames: usize,
    /// Whether targets have moved since the result was taken.
    pub stale: bool,
}

impl<C> Group<C> {
    fn new(characters: Vec<usize>, rests: &[impl Borrow<RestPath>], component: C) -> Self {
        let frames = characters.iter().map(|character| rests[*character].borrow().len()).sum();
        Self { characters, component, frames, stale: true }
    }
}

/// Calls `work` with every stale group, on all threads where there is enough to do, until one fails.
///
/// # Errors
/// The first in the order of groups.
pub fn for_each_stale<C: Send, E: Send>(
    groups: &mut [Group<C>],
    work: impl Fn(&mut Group<C>) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let own = |group: &mut Group<C>| if group.stale { work(group).err() } else { None };
    let stale = groups.iter().filter(|group| group.stale);
    let (count, frames) = stale.fold((0, 0), |sum, group| (sum.0 + 1, sum.1 + group.frames));
    let failure = match at_once(groups.len(), frames).filter(|_| count > 1) {
        Some(share) => groups.par_iter_mut().with_min_len(share).find_map_first(own),
        None => groups.iter_mut().find_map(own),
    };
    failure.map_or(Ok(()), Err)
}

/// Groups of characters that `links` connect, each group and the list of groups rising.
pub fn connected(count: usize, links: impl IntoIterator<Item = (usize, usize)>) -> Vec<Vec<usize>> {
    let mut leader: Vec<usize> = (0..count).collect();
    fn find(leader: &mut [usize], mut item: usize) -> usize {
        while leader[item] != item {
            leader[item] = leader[leader[item]];
            item = leader[item];
        }
        item
    }
    for (a, b) in links {
        let (a, b) = (find(&mut leader, a), find(&mut leader, b));
        leader[a.max(b)] = a.min(b);
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); count];
    for item in 0..count {
        let root = find(&mut leader, item);
        groups[root].push(item);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

/// Group, and place in it, of each of `count` characters.
fn places(groups: &[Vec<usize>], count: usize) -> Vec<(usize, usize)> {
    let mut places = vec![(0, 0); count];
    for (group, characters) in groups.iter().enumerate() {
        for (place, character) in characters.iter().enumerate() {
            places[*character] = (group, place);
        }
    }
    places
}

/// Components, and the component and place in it of each row.
pub type Grouped<C> = (Vec<Group<C>>, Vec<(usize, usize)>);

/// Spatial components of all characters, with the rows in them.
pub fn spatial_groups(
    rests: &[RestPath],
    held: &[HeldRow],
    settings: SpatialSettings,
    backend: Backend,
) -> Grouped<SpatialComponent> {
    spatial_groups_of((rests, |_| true), held, settings, backend)
}

/// Those of the characters that are `wanted`, which all rows are on.
pub fn spatial_groups_of(
    (rests, wanted): (&[impl Borrow<RestPath> + Sync], impl Fn(usize) -> bool),
    held: &[HeldRow],
    settings: SpatialSettings,
    backend: Backend,
) -> Grouped<SpatialComponent> {
    let links = held.iter().filter_map(|row| row.hold.partner().map(|to| (row.hold.at().path, to)));
    let mut groups = connected(rests.len(), links);
    groups.retain(|group| wanted(group[0]));
    let places = places(&groups, rests.len());
    let mut rows: Vec<Vec<Prepared>> = vec![Vec::new(); groups.len()];
    let mut index = Vec::with_capacity(held.len());
    for row in held {
        let prepared = Prepared::new(*row, rests, settings.baseline);
        let group = places[row.hold.at().path].0;
        index.push((group, rows[group].len()));
        rows[group].push(prepared.renumbered(|path| places[path].1));
    }
    let build = |(characters, held): (Vec<usize>, Vec<Prepared>)| {
        let own = characters.iter().map(|character| rests[*character].borrow().clone()).collect();
        Group::new(characters, rests, SpatialComponent::new(own, held, settings, backend))
    };
    let pairs: Vec<_> = groups.into_iter().zip(rows).collect();
    (pairs.into_par_iter().map(build).collect(), index)
}

/// Temporal components of all characters, with the rows in them.
/// `backend`: of the spatial components; times are reduced with all but the published one.
pub fn temporal_groups(
    (bounds, backend): (Option<StepBounds>, Backend),
    rests: &[RestPath],
    rows: &[TimeRow],
) -> Grouped<TemporalComponent> {
    let links = rows.iter().filter_map(|row| row.minus.map(|minus| (row.at.track, minus.track)));
    let groups = connected(rests.len(), links);
    let places = places(&groups, rests.len());
    let mut own: Vec<Vec<TimeRow>> = vec![Vec::new(); groups.len()];
    let mut index = Vec::with_capacity(rows.len());
    for row in rows {
        let mut row = *row;
        let group = places[row.at.track].0;
        row.at.track = places[row.at.track].1;
        if let Some(minus) = &mut row.minus {
            minus.track = places[minus.track].1;
        }
        index.push((group, own[group].len()));
        own[group].push(row);
    }
    let backend = if backend == Backend::Published { backend } else { Backend::default() };
    let settings = TemporalSettings { bounds, backend, ..TemporalSettings::default() };
    let build = |(characters, rows): (Vec<usize>, Vec<TimeRow>)| {
        let counts = characters.iter().map(|character| rests[*character].len()).collect();
        Group::new(characters, rests, TemporalComponent::new(counts, rows, settings))
    };
    let pairs: Vec<_> = groups.into_iter().zip(own).collect();
    (pairs.into_par_iter().map(build).collect(), index)
}
