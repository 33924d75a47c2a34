//! Time warping: when each frame happens. Rows `t_{i+1} − t_i = h` of every track, and the temporal constraints.
//!
//! The unconstrained answer comes from the full augmented system; where it breaks a bound on time steps, the exact
//! condensation to constrained frames is solved by a dual active set (steps between them are uniform at the optimum, with
//! bounds as without). Source: Kim et al. 2009, §4.3; bounds: Goldfarb & Idnani 1983.

use cotillion_solvers::{
    BoundMethod, BoundedQp, BoundsError, DMatrix, DVector, Dependency, Difference, DifferenceError, Factor,
    KktError, KktForm, LeastSquares, RowMatrix, Workspace, analyse, analyse_rank, node_bounds, solve_bounded,
};

use crate::clip::working::WORKING_STEP;
use crate::constraint::Strength;
use crate::index::ConstraintId;
use crate::path::bracket;

/// Dependent hard times agree if they miss by no more than this, seconds.
const AGREEMENT: f64 = 1e-9;
/// A step breaks its bound if it does so by more than this share of the rest step.
const BOUND_TOLERANCE: f64 = 1e-9;

/// A moment of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimePoint {
    /// Track, by position in the list of frame counts.
    pub track: usize,
    /// Frame, a fraction where rates differ.
    pub frame: f64,
}

/// One row of a temporal constraint: time of `at`, less time of `minus`, equals `seconds`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeRow {
    /// Which constraint of the scene.
    pub constraint: ConstraintId,
    /// Hard, or the weight of this row.
    pub strength: Strength,
    /// Moment.
    pub at: TimePoint,
    /// Moment whose time is taken off; none for an absolute time.
    pub minus: Option<TimePoint>,
    /// Seconds.
    pub seconds: f64,
}

/// Bounds on steps, as multiples of the rest step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepBounds {
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
}

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
        let terms = |row: usize| row_terms(&rows[row], &counts, &starts);
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
        let soft_matrix = soft_rows(&rows, &soft, &counts, &starts);
        let problem = LeastSquares { columns, soft: soft_matrix.to_csr(), hard: kept_matrix.to_csr() };
        Self {
            times: counts.iter().map(|count| vec![0.0; *count]).collect(),
            energy: (0.0, 0.0),
            active_steps: 0,
            factor: None,
            soft_targets: vec![WORKING_STEP; problem.soft.rows()],
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
            *target = weight(self.rows[*row].strength).sqrt() * self.rows[*row].seconds;
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
        if self.settings.bounds.is_some_and(|bounds| self.breaks(bounds)) {
            self.solve_condensed()?;
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
    fn solve_condensed(&mut self) -> Result<(), TemporalError> {
        let Some(bounds) = self.settings.bounds else { return Ok(()) };
        let knots = self.knots();
        let offsets: Vec<usize> = knots
            .iter()
            .scan(0, |next, own| {
                let start = *next;
                *next += own.len();
                Some(start)
            })
            .collect();
        let qp = self.condensed_problem(&knots, &offsets, bounds);
        let solution = solve_bounded(&qp, self.settings.method).map_err(|error| self.explain(error))?;
        for (track, own) in knots.iter().enumerate() {
            let values = &solution.x[offsets[track]..offsets[track] + own.len()];
            spread(own, values, &mut self.times[track]);
            let start = self.starts[track];
            self.x[start..start + self.counts[track]].copy_from_slice(&self.times[track]);
        }
        let at_bound = |step: f64| (step - bounds.min).abs() < 1e-7 || (step - bounds.max).abs() < 1e-7;
        let steps = self.times.iter().flat_map(|times| times.windows(2));
        self.active_steps = steps.filter(|pair| at_bound((pair[1] - pair[0]) / WORKING_STEP)).count();
        Ok(())
    }

    /// Frames of each track that some row touches, and the first of a track that none does; rising.
    fn knots(&self) -> Vec<Vec<usize>> {
        let mut knots: Vec<Vec<usize>> = vec![Vec::new(); self.counts.len()];
        for row in &self.rows {
            for point in std::iter::once(row.at).chain(row.minus) {
                let (low, high, share) = bracket(point.frame, self.counts[point.track]);
                knots[point.track].extend((share != 1.0).then_some(low));
                knots[point.track].extend((share != 0.0).then_some(high));
            }
        }
        for (track, own) in knots.iter_mut().enumerate() {
            if own.is_empty() || self.gauge == Some(self.starts[track]) {
                own.push(0);
            }
            own.sort_unstable();
            own.dedup();
        }
        knots
    }

    fn condensed_problem(&self, knots: &[Vec<usize>], offsets: &[usize], bounds: StepBounds) -> BoundedQp {
        let size: usize = knots.iter().map(Vec::len).sum();
        let mut hessian = DMatrix::zeros(size, size);
        let mut linear = DVector::zeros(size);
        let mut add_spring = |terms: &[(usize, f64)], weight: f64, target: f64| {
            for (row, a) in terms {
                linear[*row] += weight * a * target;
                for (column, b) in terms {
                    hessian[(*row, *column)] += weight * a * b;
                }
            }
        };
        let mut inequalities: Vec<([usize; 2], [f64; 2], f64)> = Vec::new();
        for (track, own) in knots.iter().enumerate() {
            for (index, pair) in own.windows(2).enumerate() {
                let steps = (pair[1] - pair[0]) as f64;
                let (a, b) = (offsets[track] + index, offsets[track] + index + 1);
                add_spring(&[(a, -1.0), (b, 1.0)], 1.0 / steps, steps * WORKING_STEP);
                let scale = steps * WORKING_STEP;
                inequalities.push(([a, b], [-1.0, 1.0], bounds.min * scale));
                inequalities.push(([a, b], [1.0, -1.0], -bounds.max * scale));
            }
        }
        for row in self.soft.iter().map(|row| &self.rows[*row]) {
            add_spring(&self.knot_terms(row, knots, offsets), weight(row.strength), row.seconds);
        }
        let count = self.kept.len() + usize::from(self.gauge.is_some());
        let mut equalities = DMatrix::zeros(count, size);
        let mut equality_targets = DVector::zeros(count);
        for (index, kept) in self.kept.iter().enumerate() {
            let row = &self.rows[self.hard[*kept]];
            for (column, value) in self.knot_terms(row, knots, offsets) {
                equalities[(index, column)] += value;
            }
            equality_targets[index] = row.seconds;
        }
        if self.gauge.is_some() {
            equalities[(count - 1, 0)] = 1.0;
        }
        let mut matrix = DMatrix::zeros(inequalities.len(), size);
        let mut lower_bounds = DVector::zeros(inequalities.len());
        for (row, (columns, values, bound)) in inequalities.into_iter().enumerate() {
            matrix[(row, columns[0])] = values[0];
            matrix[(row, columns[1])] = values[1];
            lower_bounds[row] = bound;
        }
        BoundedQp { hessian, linear, equalities, equality_targets, inequalities: matrix, lower_bounds }
    }

    fn knot_terms(&self, row: &TimeRow, knots: &[Vec<usize>], offsets: &[usize]) -> Vec<(usize, f64)> {
        let column =
            |track: usize, frame: usize| offsets[track] + knots[track].partition_point(|k| *k < frame);
        let mut terms = Vec::with_capacity(4);
        for (point, sign) in std::iter::once((row.at, 1.0)).chain(row.minus.map(|minus| (minus, -1.0))) {
            let (low, high, share) = bracket(point.frame, self.counts[point.track]);
            if share != 1.0 {
                terms.push((column(point.track, low), sign * (1.0 - share)));
            }
            if share != 0.0 {
                terms.push((column(point.track, high), sign * share));
            }
        }
        terms
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

fn weight(strength: Strength) -> f64 {
    match strength {
        Strength::Hard => 1.0,
        Strength::Soft(weight) => weight,
    }
}

fn unique(mut constraints: Vec<ConstraintId>) -> Vec<ConstraintId> {
    constraints.sort_unstable();
    constraints.dedup();
    constraints
}

fn row_terms(row: &TimeRow, counts: &[usize], starts: &[usize]) -> Vec<(usize, f64)> {
    let mut terms = Vec::with_capacity(4);
    for (point, sign) in std::iter::once((row.at, 1.0)).chain(row.minus.map(|minus| (minus, -1.0))) {
        let (low, high, share) = bracket(point.frame, counts[point.track]);
        if share != 1.0 {
            terms.push((starts[point.track] + low, sign * (1.0 - share)));
        }
        if share != 0.0 {
            terms.push((starts[point.track] + high, sign * share));
        }
    }
    terms
}

fn soft_rows(rows: &[TimeRow], soft: &[usize], counts: &[usize], starts: &[usize]) -> RowMatrix<f64> {
    let mut matrix = RowMatrix::new(counts.iter().sum());
    for (start, count) in starts.iter().zip(counts) {
        for frame in 0..count - 1 {
            matrix.push_row(&[(start + frame, -1.0), (start + frame + 1, 1.0)]);
        }
    }
    for row in soft {
        let root = weight(rows[*row].strength).sqrt();
        let terms: Vec<(usize, f64)> = row_terms(&rows[*row], counts, starts)
            .into_iter()
            .map(|(column, value)| (column, root * value))
            .collect();
        matrix.push_row(&terms);
    }
    matrix
}

/// Times between knots are evenly spaced; before the first and after the last knot steps are those at rest.
fn spread(knots: &[usize], values: &[f64], times: &mut [f64]) {
    let (first, last) = (knots[0], knots[knots.len() - 1]);
    for frame in 0..times.len() {
        times[frame] = if frame <= first {
            values[0] - (first - frame) as f64 * WORKING_STEP
        } else if frame >= last {
            values[values.len() - 1] + (frame - last) as f64 * WORKING_STEP
        } else {
            let after = knots.partition_point(|knot| *knot <= frame);
            let (a, b) = (knots[after - 1], knots[after]);
            let share = (frame - a) as f64 / (b - a) as f64;
            values[after - 1] + share * (values[after] - values[after - 1])
        };
    }
}
