//! Time warping: when each frame happens. Rows `t_{i+1} − t_i = h` of every track, and the temporal constraints.
//!
//! The unconstrained answer comes from the full augmented system; where it breaks a bound on time steps, the exact
//! condensation to constrained frames is solved by a dual active set (steps between them are uniform at the optimum, with
//! bounds as without). Source: Kim et al. 2009, §4.3; bounds: Goldfarb & Idnani 1983.

use cotillion_solvers::{
    BoundMethod, BoundsError, Dependency, Difference, DifferenceError, Factor, KktError, KktForm,
    LeastSquares, RowMatrix, Workspace, analyse, analyse_rank, node_bounds, solve_bounded,
};

use crate::clip::working::WORKING_STEP;
use crate::constraint::Strength;
use crate::edit::condensed::Condensed;
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
    starts: Vec<usize>,
    /// What constraints hold beyond the last frame of each track, in steps.
    tails: Vec<f64>,
    gauge: Option<usize>,
    hard: Vec<usize>,
    soft: Vec<usize>,
    kept: Vec<usize>,
    dependent: Vec<Dependency<f64>>,
    problem: LeastSquares<f64>,
    factor: Option<(Factor<f64>, Workspace<f64>)>,
    soft_targets: Vec<f64>,
    hard_targets: Vec<f64>,
    x: Vec<f64>,
}

impl TemporalComponent {
    /// Assembles the system of a connected group of tracks; without an absolute time, the first frame of the first track
    /// stays at 0.
    pub fn new(counts: Vec<usize>, rows: Vec<TimeRow>, settings: TemporalSettings) -> Self {
        let starts: Vec<usize> = counts
            .iter()
            .scan(0, |next, count| {
                let start = *next;
                *next += count;
                Some(start)
            })
            .collect();
        let columns = counts.iter().sum();
        let (hard, soft): (Vec<usize>, Vec<usize>) =
            (0..rows.len()).partition(|row| rows[*row].strength == Strength::Hard);
        let terms = |row: usize| rows[row].terms(&counts, |track, frame| starts[track] + frame);
        let mut hard_matrix = RowMatrix::new(columns);
        hard.iter().for_each(|row| {
            hard_matrix.push_row(&terms(*row));
        });
        let rank = analyse_rank(&hard_matrix.to_csr());
        let mut kept_matrix = RowMatrix::new(columns);
        rank.independent.iter().for_each(|row| {
            kept_matrix.push_row(&terms(hard[*row]));
        });
        let gauge = rows.iter().all(|row| row.minus.is_some()).then_some(0);
        if let Some(column) = gauge {
            kept_matrix.push_row(&[(column, 1.0)]);
        }
        let tails = tails(&counts, &rows);
        let soft_matrix = soft_rows(&rows, &soft, &counts, &starts, &tails);
        let soft_targets = step_targets(&counts, &tails, soft_matrix.rows());
        let problem = LeastSquares { columns, soft: soft_matrix.to_csr(), hard: kept_matrix.to_csr() };
        Self {
            times: counts.iter().map(|count| vec![0.0; *count]).collect(),
            energy: (0.0, 0.0),
            active_steps: 0,
            factor: None,
            soft_targets,
            tails,
            hard_targets: vec![0.0; problem.hard.rows()],
            x: vec![0.0; columns],
            kept: rank.independent,
            dependent: rank.dependent,
            counts,
            rows,
            settings,
            starts,
            gauge,
            hard,
            soft,
            problem,
        }
    }

    /// Factors the system unless that is done; [`TemporalComponent::solve`] does it where it was not.
    ///
    /// # Errors
    /// What the solver says of a matrix it cannot factor.
    pub fn factor(&mut self) -> Result<(), TemporalError> {
        if self.factor.is_none() {
            let factor = analyse(&self.problem, KktForm::Hachtel)
                .and_then(|analysis| analysis.factor(&self.problem))
                .map_err(TemporalError::Solver)?;
            let workspace = factor.workspace();
            self.factor = Some((factor, workspace));
        }
        Ok(())
    }

    /// Solves for the present seconds. Cost: linear in frames, cubic in constrained frames where a bound is met.
    ///
    /// # Errors
    /// Contradicting hard times, or hard times that the bounds do not allow.
    pub fn solve(&mut self) -> Result<(), TemporalError> {
        self.check_agreement()?;
        self.check_bounds_allow()?;
        let steps = self.step_count();
        for (target, row) in self.soft_targets[steps..].iter_mut().zip(&self.soft) {
            *target = self.rows[*row].weight().sqrt() * self.rows[*row].seconds;
        }
        for (target, kept) in self.hard_targets.iter_mut().zip(&self.kept) {
            *target = self.rows[self.hard[*kept]].seconds;
        }
        self.factor()?;
        let Some((factor, workspace)) = &mut self.factor else { return Ok(()) };
        factor
            .solve_into(&self.soft_targets, &self.hard_targets, &mut self.x, workspace)
            .map_err(TemporalError::Solver)?;
        for ((times, start), count) in self.times.iter_mut().zip(&self.starts).zip(&self.counts) {
            times.copy_from_slice(&self.x[*start..start + count]);
        }
        self.active_steps = 0;
        if let Some(bounds) = self.settings.bounds.filter(|bounds| self.breaks(*bounds)) {
            self.solve_condensed(bounds)?;
        }
        let all = self.soft_targets.len();
        self.energy = (
            self.problem.energy_of_rows(0..steps, &self.x, &self.soft_targets),
            self.problem.energy_of_rows(steps..all, &self.x, &self.soft_targets),
        );
        Ok(())
    }

    /// Constraints whose hard rows others imply.
    pub fn redundant(&self) -> Vec<ConstraintId> {
        let mut constraints: Vec<ConstraintId> =
            self.dependent.iter().map(|dependency| self.rows[self.hard[dependency.row]].constraint).collect();
        constraints.dedup();
        constraints
    }

    fn step_count(&self) -> usize {
        self.counts.iter().map(|count| count - 1).sum()
    }

    fn check_agreement(&self) -> Result<(), TemporalError> {
        let targets: Vec<f64> = self.hard.iter().map(|row| self.rows[*row].seconds).collect();
        for dependency in &self.dependent {
            let miss = dependency.mismatch(&targets);
            if miss > AGREEMENT {
                let rows = dependency.certificate();
                let constraints = rows.into_iter().map(|row| self.rows[self.hard[row]].constraint).collect();
                return Err(TemporalError::Conflict { constraints: unique(constraints), miss });
            }
        }
        Ok(())
    }

    /// Hard times and bounds are differences of times: a negative cycle says which cannot hold together.
    fn check_bounds_allow(&self) -> Result<(), TemporalError> {
        let Some(bounds) = self.settings.bounds else { return Ok(()) };
        let mut nodes: Vec<(usize, f64)> = self
            .hard
            .iter()
            .flat_map(|row| std::iter::once(self.rows[*row].at).chain(self.rows[*row].minus))
            .map(|point| (point.track, point.frame))
            .collect();
        nodes.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        nodes.dedup();
        let origin = nodes.len();
        let node =
            |point: TimePoint| nodes.iter().position(|n| *n == (point.track, point.frame)).unwrap_or(origin);
        let mut differences = Vec::new();
        for (index, pair) in nodes.windows(2).enumerate().filter(|(_, pair)| pair[0].0 == pair[1].0) {
            let rest = (pair[1].1 - pair[0].1) * WORKING_STEP;
            let (lower, upper) = (rest * bounds.min, rest * bounds.max);
            differences.push(Difference { from: index, to: index + 1, lower, upper, id: self.rows.len() });
        }
        for row in &self.hard {
            let TimeRow { at, minus, seconds, .. } = self.rows[*row];
            let from = minus.map_or(origin, node);
            differences.push(Difference { from, to: node(at), lower: seconds, upper: seconds, id: *row });
        }
        match node_bounds(origin + 1, origin, &differences) {
            Err(DifferenceError::Contradiction { ids, deficit }) => {
                let rows = ids.into_iter().filter(|id| *id < self.rows.len());
                let constraints = rows.map(|row| self.rows[row].constraint).collect();
                Err(TemporalError::Infeasible { constraints: unique(constraints), deficit })
            }
            _ => Ok(()),
        }
    }

    fn breaks(&self, bounds: StepBounds) -> bool {
        let slack = BOUND_TOLERANCE;
        let broken = |pair: &[f64]| {
            let step = (pair[1] - pair[0]) / WORKING_STEP;
            step < bounds.min - slack || step > bounds.max + slack
        };
        self.times.iter().any(|times| times.windows(2).any(broken))
    }

    /// Solves for the constrained frames alone, with the bounds, and fills in the rest.
    fn solve_condensed(&mut self, bounds: StepBounds) -> Result<(), TemporalError> {
        let hard: Vec<TimeRow> = self.kept.iter().map(|kept| self.rows[self.hard[*kept]]).collect();
        let soft: Vec<TimeRow> = self.soft.iter().map(|row| self.rows[*row]).collect();
        let rows = (&hard[..], &soft[..]);
        let condensed = Condensed::new(&self.counts, &self.tails, rows, self.gauge.is_some());
        let solution = solve_bounded(&condensed.problem(bounds), self.settings.method)
            .map_err(|error| self.explain(error))?;
        condensed.expand(&solution.x, &mut self.times);
        for (times, start) in self.times.iter().zip(&self.starts) {
            self.x[*start..start + times.len()].copy_from_slice(times);
        }
        let at_bound = |step: f64| (step - bounds.min).abs() < 1e-7 || (step - bounds.max).abs() < 1e-7;
        let steps = self.times.iter().flat_map(|times| times.windows(2));
        self.active_steps = steps.filter(|pair| at_bound((pair[1] - pair[0]) / WORKING_STEP)).count();
        Ok(())
    }

    fn explain(&self, error: BoundsError) -> TemporalError {
        match error {
            BoundsError::Infeasible { violation, equalities, .. } => {
                let rows = equalities.into_iter().filter_map(|row| self.kept.get(row));
                let constraints = rows.map(|kept| self.rows[self.hard[*kept]].constraint).collect();
                TemporalError::Infeasible { constraints: unique(constraints), deficit: violation }
            }
            other => TemporalError::Bounds(other),
        }
    }
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

/// Right-hand sides of `rows` soft rows, those of constraints 0.
fn step_targets(counts: &[usize], tails: &[f64], rows: usize) -> Vec<f64> {
    let mut targets = Vec::with_capacity(rows);
    for (count, tail) in counts.iter().zip(tails).filter(|(count, _)| **count > 1) {
        targets.resize(targets.len() + count - 2, WORKING_STEP);
        targets.push(WORKING_STEP * (1.0 + tail).sqrt());
    }
    targets.resize(rows, 0.0);
    targets
}

fn unique(mut constraints: Vec<ConstraintId>) -> Vec<ConstraintId> {
    constraints.sort_unstable();
    constraints.dedup();
    constraints
}

/// Rows of the steps, then of the soft constraints. A last step that also decides the time after it counts accordingly.
fn soft_rows(
    rows: &[TimeRow],
    soft: &[usize],
    counts: &[usize],
    starts: &[usize],
    tails: &[f64],
) -> RowMatrix<f64> {
    let mut matrix = RowMatrix::new(counts.iter().sum());
    for ((start, count), tail) in starts.iter().zip(counts).zip(tails) {
        for frame in 0..count - 1 {
            let root = if frame + 2 == *count { (1.0 + tail).sqrt() } else { 1.0 };
            matrix.push_row(&[(start + frame, -root), (start + frame + 1, root)]);
        }
    }
    for row in soft {
        let root = rows[*row].weight().sqrt();
        let mut terms = rows[*row].terms(counts, |track, frame| starts[track] + frame);
        terms.iter_mut().for_each(|(_, value)| *value *= root);
        matrix.push_row(&terms);
    }
    matrix
}
