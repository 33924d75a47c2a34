//! Shape, then scale: the two-phase edit of the paths of one connected group of characters.
//!
//! Everything that depends only on rest paths and on which frames are constrained is computed once; a solve is
//! right-hand sides, substitutions and one pass over the frames. Source: Kim et al. 2009, §4.1–4.2, in the forms that
//! the module docs of `springs`, `hold` and `reference` give.

mod alike;
mod assembled;
mod lengths;
mod rotations;
mod verdicts;

use std::sync::Arc;

use cotillion_solvers::KktError;

use crate::edit::bodies::leave_to_the_body;
use crate::edit::canvas::Canvases;
use crate::edit::clash::Miss;
use crate::edit::direction::Direction;
use crate::edit::facing::{Body, hold_facings};
use crate::edit::hold::{Phase, Prepared, Rotations};
use crate::edit::own_path::chords;
use crate::edit::parallel::for_each_path;
use crate::edit::phase::PhaseSolver;
use crate::edit::reference::reference_translations;
use crate::edit::sampling::Sampling;
use crate::edit::settings::{Backend, FacingMode, SpatialSettings};
use crate::edit::turned::TurnedPath;
use crate::geometry::c64;
use crate::index::ConstraintId;
use crate::path::{RestPath, RestSegments};

pub(super) use alike::{Alike, Like};
use assembled::assemble_both;
pub(super) use assembled::freedom;

/// Energies of the two phases, m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpatialEnergy {
    /// `½‖M p̄ − m‖²` of the shape rows.
    pub shape: f64,
    /// … of the soft constraints in the shape phase.
    pub shape_soft: f64,
    /// … of the scale rows.
    pub scale: f64,
    /// … of the soft constraints in the scale phase.
    pub scale_soft: f64,
}

/// Why a group of characters has no edit.
#[derive(Debug, PartialEq)]
pub enum SpatialError {
    /// Hard rows contradict each other.
    Conflict {
        /// Constraints of these rows.
        constraints: Vec<ConstraintId>,
        /// By how much.
        miss: Miss,
    },
    /// The solver gave up.
    Solver(Phase, KktError),
}

/// Stationary stretches: path, position in its list; rising.
pub type Runs = Vec<(usize, usize)>;

/// One connected group of characters with its factored systems and its present result.
pub struct SpatialComponent {
    /// Rest paths.
    pub rests: Vec<Arc<RestPath>>,
    /// Which frames these are; empty: all.
    pub(super) samplings: Vec<Sampling>,
    /// Held rows; places name paths of this component. Targets may change, structure may not.
    pub held: Vec<Prepared>,
    /// Stationary stretches that had to give up their rigidity: path, position in its list.
    pub released: Runs,
    /// Paths after the shape phase.
    pub shaped: Vec<Vec<c64>>,
    /// Rest segments turned as in the shape phase.
    pub turned: Vec<TurnedPath>,
    /// Paths after the scale phase.
    pub edited: Vec<Vec<c64>>,
    /// Bodies on these.
    pub bodies: Vec<Body>,
    /// Rotations of the places of each held row in the shape phase.
    pub rotations: Vec<Rotations>,
    /// Energies of the present result.
    pub energy: SpatialEnergy,
    /// What moved each rest path before the shape phase bent it.
    pub(super) translations: Vec<c64>,
    pub(super) settings: SpatialSettings,
    pub(super) backend: Backend,
    /// Segments of the rest paths.
    pub(super) segments: Vec<Arc<RestSegments>>,
    /// Longest chord of every stationary stretch, by path.
    pub(super) chords: Vec<Arc<Vec<Direction>>>,
    pub(super) shape: PhaseSolver,
    pub(super) scale: PhaseSolver,
    /// Systems with other stretches released than the present ones, with these stretches.
    pub(super) others: Vec<(Runs, [PhaseSolver; 2])>,
    /// Of bodies, only the lengths of their paths are asked for.
    pub(super) lengths_only: bool,
    /// The scale system is not there yet.
    pub(super) lacks_scale: bool,
    /// Paths that were taken from another solution, about which they are.
    pub(super) alike: Alike,
    /// What its what-ifs draw on.
    pub(super) canvases: Canvases,
}

/// So many systems with other stretches released are kept.
const MOST_KEPT: usize = 4;

/// How far a solve went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solved {
    /// Both phases.
    Both,
    /// The shape takes too much energy.
    TooMuch,
    /// Both do, without the residuals of the second: its paths are not drawn.
    TooMuchInAll,
    /// The shape; what it takes to go on is missing.
    LacksScale,
}

/// What came of one attempt.
enum Attempt {
    Ended(Solved),
    Release(Runs),
}

impl SpatialComponent {
    /// Assembles both systems. Cost: linear in frames.
    pub fn new(
        rests: Vec<impl Into<Arc<RestPath>>>,
        held: Vec<Prepared>,
        settings: SpatialSettings,
        backend: Backend,
    ) -> Self {
        Self::of_samples((rests, Vec::new()), held, settings, backend)
    }

    /// The same of paths of which only some frames are given, as the samplings say; by [`Backend::Direct`].
    pub fn of_samples(
        (rests, samplings): (Vec<impl Into<Arc<RestPath>>>, Vec<Sampling>),
        mut held: Vec<Prepared>,
        settings: SpatialSettings,
        backend: Backend,
    ) -> Self {
        let rests: Vec<Arc<RestPath>> = rests.into_iter().map(Into::into).collect();
        if settings.facing == FacingMode::TangentBlend {
            leave_to_the_body(&mut held, &rests);
        }
        let [shape, scale] = assemble_both((&rests, &samplings), &held, (&settings, backend), &[]);
        Self {
            shaped: rests.iter().map(|rest| rest.positions.clone()).collect(),
            edited: rests.iter().map(|rest| rest.positions.clone()).collect(),
            turned: rests.iter().map(|rest| TurnedPath::new(rest)).collect(),
            bodies: rests.iter().map(|rest| Body::new(rest, settings.facing)).collect(),
            segments: rests.iter().map(|rest| Arc::new(rest.segments())).collect(),
            rotations: vec![Rotations::NONE; held.len()],
            energy: SpatialEnergy::default(),
            translations: vec![c64::default(); rests.len()],
            released: Vec::new(),
            chords: rests.iter().map(|rest| Arc::new(chords(rest))).collect(),
            rests,
            samplings,
            held,
            settings,
            backend,
            shape,
            scale,
            others: Vec::new(),
            lengths_only: false,
            lacks_scale: false,
            alike: Alike::default(),
            canvases: Canvases::default(),
        }
    }

    /// Assembles anew after coefficients of held rows have changed (an offset, not a target); the order of elimination stays.
    pub fn reassemble(&mut self) {
        self.others.clear();
        let [mut shape, mut scale] = self.assembled(&self.released);
        shape.adopt(&self.shape);
        scale.adopt(&self.scale);
        (self.shape, self.scale) = (shape, scale);
    }

    /// Takes over orders of elimination of a group with the same rows, where patterns are the same.
    pub fn adopt(&mut self, before: &Self) {
        self.shape.adopt(&before.shape);
        self.scale.adopt(&before.scale);
    }

    fn assembled(&self, released: &[(usize, usize)]) -> [PhaseSolver; 2] {
        assemble_both((&self.rests, &self.samplings), &self.held, (&self.settings, self.backend), released)
    }

    /// Goes over to the systems with the stretches `released`, which are kept once they are assembled.
    fn release(&mut self, released: Runs) {
        if released == self.released {
            return;
        }
        let known = self.others.iter().position(|(others, _)| *others == released);
        let [shape, scale] = match known {
            Some(place) => self.others.swap_remove(place).1,
            None => self.assembled(&released),
        };
        let before = [std::mem::replace(&mut self.shape, shape), std::mem::replace(&mut self.scale, scale)];
        self.others.push((std::mem::replace(&mut self.released, released), before));
        if self.others.len() > MOST_KEPT {
            self.others.remove(0);
        }
    }

    /// Factors both systems unless that is done; [`SpatialComponent::solve`] does it where it was not.
    ///
    /// # Errors
    /// What the solver says of a matrix it cannot factor.
    pub fn factor(&mut self) -> Result<(), SpatialError> {
        let freedom = |phase| freedom((&self.rests, &self.samplings), phase, &self.settings, &self.released);
        let shape = self.shape.factor(freedom(Phase::Shape), &self.settings);
        shape.map_err(|error| SpatialError::Solver(Phase::Shape, error))?;
        let scale = self.scale.factor(freedom(Phase::Scale), &self.settings);
        scale.map_err(|error| SpatialError::Solver(Phase::Scale, error))
    }

    /// Solves both phases for the present targets. Cost: linear in frames. Every stretch is rigid to begin with, so that
    /// the result does not depend on earlier targets.
    ///
    /// # Errors
    /// [`SpatialError::Conflict`] where hard rows contradict each other; a stationary stretch that is the cause is
    /// released first.
    pub fn solve(&mut self) -> Result<(), SpatialError> {
        self.solve_below(f64::INFINITY, None).map(|_| ())
    }

    /// The same, given up where the shape alone, or with it the springs of the scale phase, takes more energy than `most`, m².
    /// `like`: a solution of which paths are taken that are about the same, where lengths are all that is asked for.
    ///
    /// # Errors
    /// As [`SpatialComponent::solve`].
    pub(super) fn solve_below(&mut self, most: f64, like: Option<Like>) -> Result<Solved, SpatialError> {
        self.release(Vec::new());
        loop {
            match self.attempt(most, like)? {
                Attempt::Ended(solved) => return Ok(solved),
                Attempt::Release(mut runs) => {
                    runs.extend(&self.released);
                    runs.sort_unstable();
                    self.release(runs);
                }
            }
        }
    }

    /// Goes on where the solve before ended for lack of the scale system.
    ///
    /// # Errors
    /// As [`SpatialComponent::solve`].
    pub(super) fn go_on(&mut self, most: f64, like: Option<Like>) -> Result<Solved, SpatialError> {
        match self.solve_scale(most, like)? {
            None => Ok(Solved::Both),
            Some(Attempt::Ended(solved)) => Ok(solved),
            Some(Attempt::Release(_)) => self.solve_below(most, like),
        }
    }

    fn attempt(&mut self, most: f64, like: Option<Like>) -> Result<Attempt, SpatialError> {
        self.rest_rotations();
        // Where nobody turns on the spot, the first shape is the last one: no need to draw it if it takes too much.
        let drawn_up_to = if self.may_turn() { f64::INFINITY } else { most };
        if let Some(ended) = self.solve_shape(drawn_up_to, like)? {
            return Ok(ended);
        }
        let before = self.may_turn().then(|| self.rotations.clone());
        if self.update_rotations(like) {
            if before.is_none_or(|before| self.asks_otherwise(&before))
                && let Some(ended) = self.solve_shape(most, like)?
            {
                return Ok(ended);
            }
            self.update_rotations(like);
        }
        self.check_bodies()?;
        if self.energy.shape + self.energy.shape_soft > most {
            return Ok(Attempt::Ended(Solved::TooMuch));
        }
        if !self.lengths_only {
            self.turn_paths();
        }
        if self.lacks_scale {
            return Ok(Attempt::Ended(Solved::LacksScale));
        }
        self.solve_scale(most, like).map(|release| release.unwrap_or(Attempt::Ended(Solved::Both)))
    }

    /// Solves the shape phase; draws it unless it takes more energy than `most`.
    fn solve_shape(&mut self, most: f64, like: Option<Like>) -> Result<Option<Attempt>, SpatialError> {
        let (held, rotations, rests) = (&self.held, &self.rotations, &self.rests);
        let rest = |path: usize| rests[path].positions.as_slice();
        let asked = reference_translations(rests.len(), rest, held, |_| Rotations::NONE);
        self.translations = asked.into_iter().map(Option::unwrap_or_default).collect();
        let (translations, relative) = (&self.translations, self.settings.relative);
        let reference = |path: usize, frame: usize| rests[path].positions[frame] + translations[path];
        let value = |index: usize| held[index].target(Phase::Shape, relative, rotations[index]);
        self.shape.set_targets(value, reference);
        if let Some((rows, miss)) = self.shape.contradiction() {
            return self.clash(&rows, miss).map(Some);
        }
        let freedom = freedom((&self.rests, &self.samplings), Phase::Shape, &self.settings, &self.released);
        let solved = self.shape.solve(freedom, &self.settings);
        solved.map_err(|error| SpatialError::Solver(Phase::Shape, error))?;
        (self.energy.shape, self.energy.shape_soft) = self.shape.energies();
        if self.energy.shape + self.energy.shape_soft > most {
            return Ok(Some(Attempt::Ended(Solved::TooMuch)));
        }
        if self.lengths_only {
            self.shape_and_turn(like);
            return Ok(None);
        }
        let shape = &self.shape;
        let bend = |path: usize, shaped: &mut Vec<c64>, _: &mut TurnedPath| {
            let (rest, translation) = (&rests[path], translations[path]);
            shape.points(path, |frame| rest.positions[frame] + translation, shaped);
        };
        for_each_path(rests, &mut self.shaped, &mut self.turned, bend);
        Ok(None)
    }

    fn solve_scale(&mut self, most: f64, like: Option<Like>) -> Result<Option<Attempt>, SpatialError> {
        let translations = self.scale_translations(like);
        let (held, rotations) = (&self.held, &self.rotations);
        let (alike, own, its) = (&self.alike, &self.turned, like.map(|like| like.group.turned.as_slice()));
        let turned = |path: usize| alike.pick(path, own, its).points.as_slice();
        let relative = self.settings.relative;
        let value = |index: usize| held[index].target(Phase::Scale, relative, rotations[index]);
        self.scale.set_targets(value, |path, frame| turned(path)[frame] + translations[path]);
        if let Some((rows, miss)) = self.scale.contradiction() {
            return self.clash(&rows, miss).map(Some);
        }
        let freedom = freedom((&self.rests, &self.samplings), Phase::Scale, &self.settings, &self.released);
        let solved = self.scale.solve(freedom, &self.settings);
        solved.map_err(|error| SpatialError::Solver(Phase::Scale, error))?;
        (self.energy.scale, self.energy.scale_soft) = self.scale.energies();
        self.alike.energy = if like.is_some() { self.energy_apart() } else { 0.0 };
        // Of what targets that are off leave, only the energy with its residuals has a bound.
        let told = self.alike.energy == 0.0;
        if told && self.energy.shape + self.energy.shape_soft + self.energy.scale > most {
            return Ok(Some(Attempt::Ended(Solved::TooMuchInAll)));
        }
        if self.lengths_only {
            self.find_lengths(&translations, like);
            return Ok(None);
        }
        hold_facings(held, rotations, &mut self.bodies);
        let (scale, rests) = (&self.scale, &self.rests);
        let stretch = |path: usize, edited: &mut Vec<c64>, body: &mut Body| {
            let (turned, translation) = (&own[path], translations[path]);
            scale.points(path, |frame| turned.points[frame] + translation, edited);
            body.follow(&rests[path], edited, &turned.factors);
        };
        for_each_path(rests, &mut self.edited, &mut self.bodies, stretch);
        Ok(None)
    }

    /// What moves each turned path where its constraints ask for it; where none does, around the middle of the shaped one.
    fn scale_translations(&self, like: Option<Like>) -> Vec<c64> {
        let rotations = &self.rotations;
        let turned = |path: usize| {
            let its = like.map(|like| like.group.turned.as_slice());
            self.alike.pick(path, &self.turned, its).points.as_slice()
        };
        let asked = reference_translations(self.turned.len(), turned, &self.held, |row| rotations[row]);
        let shaped =
            |path: usize| self.alike.pick(path, &self.shaped, like.map(|like| like.group.shaped.as_slice()));
        let to_middle = |path: usize| centre(shaped(path)) - centre(turned(path));
        asked.into_iter().enumerate().map(|(path, asked)| asked.unwrap_or_else(|| to_middle(path))).collect()
    }
}

fn centre(points: &[c64]) -> c64 {
    points.iter().sum::<c64>() / points.len() as f64
}
