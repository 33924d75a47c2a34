//! What the energy would be if one character performed another track, estimated on fewer frames: the published way, kept to
//! compare with.
//!
//! All paths of the group on every 25th frame and those that matter, by sparse LU of all kept frames, planned anew each time.
//! Times are exact, by whatever system. Source: Kim et al. 2009, §5.3 (acceleration).

use std::sync::Arc;

use cotillion_solvers::SpringPath;

use super::Editor;
use super::objects::ObjectsThen;
use super::timing::Timing;
use super::variant::{Variant, place_of, space_of};
use crate::edit::EditError;
use crate::edit::columns::Freedom;
use crate::edit::energy::Energy;
use crate::edit::hold::{Phase, Prepared};
use crate::edit::sampling::{STRIDE, Sampling, sampled};
use crate::edit::settings::Backend;
use crate::edit::spatial::SpatialComponent;
use crate::edit::springs::shape_path;
use crate::edit::temporal::TemporalComponent;
use crate::path::RestPath;

use super::told::space_error;

impl Editor {
    /// Ê if `variant` were performed, estimated. `marked`: of each character, frames of its track (of the variant's own: of
    /// that) that are kept, with the next one and those on either side. `timing`: its times; where it is not given, they are
    /// solved on the kept frames. Only for scenes in which no object moves. Cost: by
    /// kept frames of the group.
    ///
    /// # Errors
    /// Those of [`Editor::solve`].
    pub fn energy_sampled(
        &self,
        variant: &Variant,
        timing: Option<&Timing>,
        marked: &[Vec<usize>],
    ) -> Result<Energy, EditError> {
        let (index, place) = place_of(&self.spatial, variant.character).unwrap_or_default();
        let group = &self.spatial[index];
        let held = self.held_with((variant, &ObjectsThen::default()), index);
        let rest_of =
            |path: usize| if path == place { &variant.own.rest } else { &group.component.rests[path] };
        let sampling = |(path, who): (usize, &usize)| {
            let starts = self.scene.characters[*who].track.placed_runs().skip(1).map(|(_, start)| start);
            let seams: Vec<usize> = if path == place { variant.seams.clone() } else { starts.collect() };
            let before = seams.iter().map(|start| start - 1);
            let marked: Vec<usize> = marked[*who].iter().copied().chain(before).collect();
            let rest = rest_of(path);
            Sampling::new(rest, (path, &held), &marked, &self.springs(rest))
        };
        let samplings: Vec<Sampling> = group.characters.iter().enumerate().map(sampling).collect();
        let paths: Vec<RestPath> =
            samplings.iter().enumerate().map(|(path, own)| own.path(rest_of(path))).collect();
        let held: Vec<Prepared> = held.into_iter().map(|row| sampled(row, &samplings)).collect();
        let chords: Vec<Vec<f64>> = paths.iter().map(chords).collect();
        let samples = (paths, samplings.clone());
        let mut component =
            SpatialComponent::of_samples(samples, held, self.settings, self.sampled_backend());
        component.solve().map_err(|error| space_error(&self.scene, &group.characters, error))?;
        let lengths = component.edited.iter().zip(&samplings).zip(&chords);
        let lengths = lengths.map(|((edited, sampling), rest)| stretched(edited, sampling, rest)).collect();
        let space = space_of(index, &component, lengths);
        match timing {
            Some(timing) => Ok(self.energy_with(variant, timing, &[space])),
            None => {
                let timing = self.timing_sampled(variant, (&group.characters, &samplings))?;
                Ok(self.energy_with(variant, &timing, &[space]))
            }
        }
    }

    /// Whether the times of estimates are solved on kept frames too, as published, though fewer would do.
    pub fn samples_times(&self) -> bool {
        self.backend == Backend::Published
    }

    fn sampled_backend(&self) -> Backend {
        if self.backend == Backend::Published { Backend::Published } else { Backend::Direct }
    }

    /// Times of a variant with the frames of `samplings` as unknowns; of characters without one, every 25th frame.
    fn timing_sampled(
        &self,
        variant: &Variant,
        (sampled, samplings): (&[usize], &[Sampling]),
    ) -> Result<Timing, EditError> {
        self.timing_by(variant, |characters, counts, rows, settings| {
            let frames = |(track, who): (usize, &usize)| match sampled.binary_search(who) {
                Ok(place) => samplings[place].frames.clone(),
                Err(_) => (0..counts[track]).step_by(STRIDE).chain([counts[track] - 1]).collect(),
            };
            let of_track = |(track, who)| {
                frames((track, who)).into_iter().map(|frame| (track, frame)).collect::<Vec<_>>()
            };
            let kept = characters.iter().enumerate().flat_map(of_track).collect();
            TemporalComponent::of_samples(counts.clone(), kept, rows, settings)
        })
    }

    /// Compliance at each frame of a path in the shape phase.
    fn springs(&self, rest: &Arc<RestPath>) -> Vec<f64> {
        let paths = std::slice::from_ref(rest);
        let runs = self.settings.runs;
        let freedom = Freedom { paths, phase: Phase::Shape, runs, released: &[], samplings: &[] };
        match shape_path(freedom, 0, &self.settings) {
            SpringPath::Listed { compliances, .. } => compliances,
            SpringPath::Even { count, .. } => vec![1.0; count],
        }
    }
}

fn chords(path: &RestPath) -> Vec<f64> {
    path.positions.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect()
}

/// Length of a path of which the pieces between kept frames are stretched as their chords are.
fn stretched(edited: &[crate::geometry::c64], sampling: &Sampling, chords: &[f64]) -> f64 {
    let pieces = edited.windows(2).zip(&sampling.lengths).zip(chords);
    let length = |((pair, length), chord): ((&[crate::geometry::c64], &f64), &f64)| {
        if *chord > 0.0 { length * (pair[1] - pair[0]).norm() / chord } else { *length }
    };
    pieces.map(length).sum()
}
