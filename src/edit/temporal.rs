//! Time warping: when each frame happens. Rows `t_{i+1} − t_i = h` of every track, and the temporal constraints.
//!
//! Tracks are networks of springs, condensed exactly to the frames that constraints touch, or solved in full to compare
//! with. Where the answer breaks a bound on steps, a dual active set goes on from there (steps between constrained frames
//! are even at the optimum, with bounds as without). Source: Kim et al. 2009, §4.3; bounds: Goldfarb & Idnani 1983.

mod retimed;

use std::sync::OnceLock;

use cotillion_solvers::{
    BoundMethod, BoundsError, Difference, DifferenceError, Factor, KktError, KktForm, Knots, Network,
    NetworkEnergy, PointRow, StepRange, StepResponse, Track, Workspace, analyse, node_bounds, solve_bounded,
};

use crate::clip::working::WORKING_STEP;
use crate::constraint::Strength;
use crate::edit::settings::Backend;
use crate::edit::time_row::{StepBounds, TimePoint, TimeRow};
use crate::index::ConstraintId;

/// Dependent hard times agree if they miss by no more than this, seconds.
const AGREEMENT: f64 = 1e-9;
/// A step breaks its bound if it does so by more than this share of the rest step.
const BOUND_TOLERANCE: f64 = 1e-9;

/// Settings of time warping.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TemporalSettings {
    /// Bounds on steps, if any.
    pub bounds: Option<StepBounds>,
    /// How bounds are found.
    pub method: BoundMethod,
    /// Which solver answers.
    pub backend: Backend,
}

/// Why tracks have no times.
#[derive(Debug, PartialEq)]
pub enum TemporalError {
    /// Hard times contradict each other.
    Conflict {
        /// Constraints of these rows.
        constraints: Vec<ConstraintId>,
        /// Seconds.
        miss: f64,
    },
    /// Hard times contradict the bounds.
    Infeasible {
        /// Constraints on the cycle.
        constraints: Vec<ConstraintId>,
        /// Seconds.
        deficit: f64,
    },
    /// The solver gave up.
    Solver(KktError),
    /// The bounded problem could not be solved.
    Bounds(BoundsError),
}

/// One connected group of tracks with its factored system and its present times.
pub struct TemporalComponent {
    /// Number of frames of each track; at least one each.
    pub counts: Vec<usize>,
    /// Rows; seconds may change, structure may not.
    pub rows: Vec<TimeRow>,
    /// Time of each frame of each track, seconds.
    pub times: Vec<Vec<f64>>,
    /// `½‖M t − m‖²` of the present times, s²: of steps, and of soft constraints.
    pub energy: (f64, f64),
    /// Steps that stand at a bound.
    pub active_steps: usize,
    settings: TemporalSettings,
    /// Frames that are unknowns besides those that constraints touch, by track; `None`: what the solver takes.
    kept: Option<Vec<(usize, usize)>>,
    network: Network,
    factor: Option<(Factor<f64>, Workspace<f64>)>,
    /// Seconds of each row, as solved for.
    seconds: Vec<f64>,
    soft_targets: Vec<f64>,
    hard_targets: Vec<f64>,
    /// Delays of the network's knots.
    x: Vec<f64>,
    /// How it answers to other numbers of steps of each piece, once asked for.
    responses: Vec<OnceLock<Option<StepResponse>>>,
}

impl TemporalComponent {
    /// Assembles the system of a connected group of tracks; without an absolute time, the first frame of the first track
    /// stays at 0.
    ///
    /// # Panics
    /// If a row's moment or weight is not finite, its weight is negative, or its track does not exist.
    pub fn new(counts: Vec<usize>, rows: Vec<TimeRow>, settings: TemporalSettings) -> Self {
        Self::of_knots((counts, None), rows, settings)
    }

    /// The same with these frames as unknowns besides those that constraints touch: track, frame.
    ///
    /// # Panics
    /// As [`TemporalComponent::new`].
    pub fn of_samples(
        counts: Vec<usize>,
        kept: Vec<(usize, usize)>,
        rows: Vec<TimeRow>,
        settings: TemporalSettings,
    ) -> Self {
        Self::of_knots((counts, Some(kept)), rows, settings)
    }

    fn of_knots(
        (counts, kept): (Vec<usize>, Option<Vec<(usize, usize)>>),
        rows: Vec<TimeRow>,
        settings: TemporalSettings,
    ) -> Self {
        let knots = match (&kept, settings.backend) {
            (Some(kept), _) => Knots::Besides(kept),
            (None, Backend::Reduced) => Knots::Touched,
            (None, Backend::Direct | Backend::Published) => Knots::All,
        };
        let network = network(&counts, &rows, knots);
        let (soft_targets, hard_targets) = network.targets();
        Self {
            times: counts.iter().map(|count| vec![0.0; *count]).collect(),
            energy: (0.0, 0.0),
            active_steps: 0,
            factor: None,
            seconds: vec![0.0; rows.len()],
            soft_targets,
            hard_targets,
            x: vec![0.0; network.problem.columns],
            responses: network.pieces.iter().map(|_| OnceLock::new()).collect(),
            counts,
            rows,
            settings,
            kept,
            network,
        }
    }

    /// Assembles anew; what was factored is forgotten.
    pub fn reassemble(&mut self) {
        let (counts, rows) = (self.counts.clone(), self.rows.clone());
        let fresh = Self::of_knots((counts, self.kept.take()), rows, self.settings);
        let times = std::mem::replace(self, fresh).times;
        self.times = times;
    }

    /// As it was made with.
    pub fn settings(&self) -> TemporalSettings {
        self.settings
    }

    /// Factors the system unless that is done; [`TemporalComponent::solve`] does it where it was not.
    ///
    /// # Errors
    /// What the solver says of a matrix it cannot factor.
    pub fn factor(&mut self) -> Result<(), TemporalError> {
        if self.factor.is_none() {
            let problem = &self.network.problem;
            let form = match self.settings.backend {
                Backend::Published => KktForm::NormalEquations,
                Backend::Reduced | Backend::Direct => KktForm::Hachtel,
            };
            let factor = analyse(problem, form)
                .and_then(|analysis| analysis.factor(problem))
                .map_err(TemporalError::Solver)?;
            let workspace = factor.workspace();
            self.factor = Some((factor, workspace));
        }
        Ok(())
    }

    /// Solves for the present seconds. Cost: linear in rows, and one pass over the frames; where bounds are met, a
    /// factorisation on the rows for every time that the set of steps at a bound changes. [`Backend::Direct`]: linear in
    /// frames; where bounds are met, cubic in constrained frames for each of these times. Allocates nothing after the first
    /// time, unless bounds are met.
    ///
    /// # Errors
    /// Contradicting hard times, or hard times that the bounds do not allow; then times are still those of the last solve
    /// that succeeded.
    pub fn solve(&mut self) -> Result<(), TemporalError> {
        self.seconds.iter_mut().zip(&self.rows).for_each(|(seconds, row)| *seconds = row.seconds);
        self.check_agreement()?;
        self.network.write_targets(&self.seconds, &mut self.soft_targets, &mut self.hard_targets);
        self.factor()?;
        let Some((factor, workspace)) = &mut self.factor else { return Ok(()) };
        factor
            .solve_into(&self.soft_targets, &self.hard_targets, &mut self.x, workspace)
            .map_err(TemporalError::Solver)?;
        match self.settings.bounds.filter(|bounds| self.breaks(*bounds)) {
            Some(bounds) => self.solve_bounded(bounds)?,
            None => {
                self.active_steps = 0;
                self.take_solution();
            }
        }
        Ok(())
    }

    /// Constraints whose hard rows others imply.
    pub fn redundant(&self) -> Vec<ConstraintId> {
        let dependent = self.network.dependent.iter();
        let mut constraints: Vec<ConstraintId> =
            dependent.map(|dependency| self.rows[dependency.row].constraint).collect();
        constraints.dedup();
        constraints
    }

    fn check_agreement(&self) -> Result<(), TemporalError> {
        for dependency in &self.network.dependent {
            let miss = dependency.mismatch(&self.seconds);
            let agrees = miss <= AGREEMENT; // which NaN does not
            if !agrees {
                return Err(TemporalError::Conflict {
                    constraints: self.constraints(dependency.certificate()),
                    miss,
                });
            }
        }
        Ok(())
    }

    /// Hard times and bounds are differences of times: a negative cycle says which cannot hold together.
    fn check_bounds_allow(&self, bounds: StepBounds) -> Result<(), TemporalError> {
        let is_hard = |row: &usize| self.rows[*row].strength == Strength::Hard;
        let hard: Vec<usize> = (0..self.rows.len()).filter(is_hard).collect();
        let mut nodes: Vec<(usize, f64)> = hard
            .iter()
            .flat_map(|row| std::iter::once(self.rows[*row].at).chain(self.rows[*row].minus))
            .map(|point| (point.track, point.frame))
            .collect();
        nodes.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        nodes.dedup();
        let origin = nodes.len();
        let order = |a: &(usize, f64), b: &(usize, f64)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
        let node = |point: TimePoint| {
            let place = nodes.binary_search_by(|known| order(known, &(point.track, point.frame)));
            place.unwrap_or(origin)
        };
        let mut differences = Vec::new();
        for (index, pair) in nodes.windows(2).enumerate().filter(|(_, pair)| pair[0].0 == pair[1].0) {
            let rest = (pair[1].1 - pair[0].1) * WORKING_STEP;
            let (lower, upper) = (rest * bounds.min, rest * bounds.max);
            differences.push(Difference { from: index, to: index + 1, lower, upper, id: self.rows.len() });
        }
        for row in &hard {
            let TimeRow { at, minus, seconds, .. } = self.rows[*row];
            let from = minus.map_or(origin, node);
            differences.push(Difference { from, to: node(at), lower: seconds, upper: seconds, id: *row });
        }
        match node_bounds(origin + 1, origin, &differences) {
            Err(DifferenceError::Contradiction { ids, deficit }) => {
                let constraints = self.constraints(ids.into_iter().filter(|id| *id < self.rows.len()));
                Err(TemporalError::Infeasible { constraints, deficit })
            }
            _ => Ok(()),
        }
    }

    /// Whether steps between constrained frames are out of bounds; others are as at rest.
    fn breaks(&self, bounds: StepBounds) -> bool {
        let slack = BOUND_TOLERANCE;
        self.network.pieces.iter().any(|piece| {
            let step = 1.0 + self.network.lengthening(piece, &self.x) / WORKING_STEP;
            step < bounds.min - slack || step > bounds.max + slack
        })
    }

    fn take_solution(&mut self) {
        self.network.expand(&self.x, &mut self.times);
        let NetworkEnergy { springs, rows } = self.network.energy(&self.x, &self.soft_targets);
        self.energy = (springs, rows);
    }

    /// Goes on from a solution that breaks bounds: sparse, or where another solver or method is asked for, dense.
    fn solve_bounded(&mut self, bounds: StepBounds) -> Result<(), TemporalError> {
        self.check_bounds_allow(bounds)?;
        let range = StepRange { min: bounds.min * WORKING_STEP, max: bounds.max * WORKING_STEP };
        match (self.settings.backend, self.settings.method) {
            (Backend::Reduced, BoundMethod::DualActiveSet) => {
                let solution = self.network.solve_within((&self.soft_targets, &self.hard_targets), range);
                self.x = solution.map_err(|error| self.explain(error))?.x;
                self.take_solution();
            }
            (Backend::Published, BoundMethod::DualActiveSet) => {
                self.solve_reduced(|network, targets| {
                    network.solve_within(targets, range).map(|found| found.x)
                })?;
            }
            _ => self.solve_dense(range)?,
        }
        let at_bound = |step: f64| (step - bounds.min).abs() < 1e-7 || (step - bounds.max).abs() < 1e-7;
        let steps = self.times.iter().flat_map(|times| times.windows(2));
        self.active_steps = steps.filter(|pair| at_bound((pair[1] - pair[0]) / WORKING_STEP)).count();
        Ok(())
    }

    /// The bounded problem on the constrained frames, dense.
    fn solve_dense(&mut self, range: StepRange) -> Result<(), TemporalError> {
        let method = self.settings.method;
        self.solve_reduced(|network, targets| {
            solve_bounded(&network.dense_program(targets, range), method).map(|found| found.x)
        })
    }

    /// Solves on the constrained frames, whatever the unknowns are otherwise.
    fn solve_reduced(
        &mut self,
        solve: impl FnOnce(&Network, (&[f64], &[f64])) -> Result<Vec<f64>, BoundsError>,
    ) -> Result<(), TemporalError> {
        let network = network(&self.counts, &self.rows, Knots::Touched);
        let (mut m, mut h) = network.targets();
        network.write_targets(&self.seconds, &mut m, &mut h);
        let x = solve(&network, (&m, &h)).map_err(|error| self.explain(error))?;
        network.expand(&x, &mut self.times);
        let NetworkEnergy { springs, rows } = network.energy(&x, &m);
        self.energy = (springs, rows);
        Ok(())
    }

    fn explain(&self, error: BoundsError) -> TemporalError {
        match error {
            BoundsError::Infeasible { violation, equalities, .. } => {
                let rows = equalities.into_iter().filter_map(|row| self.network.kept.get(row).copied());
                TemporalError::Infeasible { constraints: self.constraints(rows), deficit: violation }
            }
            other => TemporalError::Bounds(other),
        }
    }

    /// Constraints of some rows, rising.
    fn constraints(&self, rows: impl IntoIterator<Item = usize>) -> Vec<ConstraintId> {
        let mut constraints: Vec<ConstraintId> =
            rows.into_iter().map(|row| self.rows[row].constraint).collect();
        constraints.sort_unstable();
        constraints.dedup();
        constraints
    }
}

/// Tracks with the rows on them.
fn network(counts: &[usize], rows: &[TimeRow], knots: Knots) -> Network {
    let tails = tails(counts, rows);
    let tracks: Vec<Track> =
        counts.iter().zip(tails).map(|(count, tail)| Track { points: *count, tail }).collect();
    let rows: Vec<PointRow<f64>> = rows.iter().map(|row| row.on_points(counts)).collect();
    Network::new(&tracks, WORKING_STEP, &rows, knots)
        .expect("moments are finite, weights finite and positive")
}

/// How far beyond the last frame of each track some constraint lies, in steps: tracks may end between working frames.
fn tails(counts: &[usize], rows: &[TimeRow]) -> Vec<f64> {
    let mut tails = vec![0.0; counts.len()];
    for point in rows.iter().flat_map(|row| std::iter::once(row.at).chain(row.minus)) {
        let beyond = point.frame - (counts[point.track] as f64 - 1.0);
        tails[point.track] = beyond.max(tails[point.track]);
    }
    tails
}
