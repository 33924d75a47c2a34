//! Solves of the compliance form: multipliers by substitution, refined against the springs; then one pass over the points.

use crate::c64;
use crate::compliance::{Compliance, ComplianceFactor};
use crate::error::{KktError, SolveReport};
use crate::lu::LuScratch;
use crate::refine::relative_to;
use crate::scalar::TwoPart;
use crate::springs::{Drawing, Load, State};

/// How good a solution is to be: by how much the next correction is expected to move points, relative to the farthest, and by
/// how much rows are missed, relative to the largest target.
type Accuracy = (f64, f64);

/// How far a solve goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// To rounding.
    Full,
    /// To about ten digits, for less than half the work.
    Estimate,
    /// One substitution where that leaves about five digits; else an estimate.
    Sketch,
}

impl Effort {
    /// Refinement ends at the first; it is settled if it comes to rest near the second.
    fn goals(self) -> (Accuracy, Accuracy) {
        match self {
            Self::Full => ((1e-15, 3e-14), NEAR),
            Self::Estimate | Self::Sketch => ((1e-10, 1e-10), TRUSTED),
        }
    }
}

/// A sketch misses its rows by no more, relative to the targets: points are then off by a few times as much, relative to the
/// farthest.
const SKETCHED: f64 = 1e-6;
/// From this step on loads are summed to about 32 digits: forces that nearly cancel leave too few otherwise.
const FIRST_COMPENSATED_STEP: usize = 2;
/// Solutions come to rest near these: scenes that are well posed get to 1e-13, others stay five digits above.
const NEAR: Accuracy = (1e-11, 1e-12);
/// A solution farther off is refused: rows of stiff clusters leave fewer digits.
const TRUSTED: Accuracy = (1e-9, 1e-10);
/// Most refinements of one solve.
const MOST_REFINEMENTS: usize = 6;
/// Solutions that miss their rows by more, relative to the targets, are refused.
const ALLOWED_RESIDUAL: f64 = 1e-9;

/// Loads and states at the nodes of one piece.
pub(crate) struct PieceBend<'a> {
    pub(crate) loads: &'a [Load],
    pub(crate) states: &'a [State],
    /// State of the first point that it knows.
    pub(crate) origin: State,
}

/// Bent paths, as loads and states at the constrained points: everything in between is known from these. Holds the memory
/// of solves; nothing else is allocated.
pub struct Bent {
    /// Multipliers, one a row.
    lambda: Vec<TwoPart<c64>>,
    /// Multipliers, similarities and multipliers of free motions, of the scaled system.
    unknowns: Vec<TwoPart<c64>>,
    residual: Vec<c64>,
    values: Vec<c64>,
    /// First node of each piece in `loads` and `states`; one more entry closes the last.
    starts: Vec<usize>,
    loads: Vec<Load>,
    states: Vec<State>,
    /// Forces on the nodes of one piece.
    forces: Vec<TwoPart<c64>>,
    /// State of the first point that each piece knows.
    origins: Vec<State>,
    energy: f64,
    settled: bool,
    scratch: LuScratch,
}

impl Bent {
    /// Memory for solves of `problem` with `factor`; all paths at zero.
    pub fn new(problem: &Compliance, factor: &ComplianceFactor) -> Self {
        let mut bent = Self {
            lambda: Vec::new(),
            unknowns: Vec::new(),
            residual: Vec::new(),
            values: Vec::new(),
            starts: Vec::new(),
            loads: Vec::new(),
            states: Vec::new(),
            forces: Vec::new(),
            origins: Vec::new(),
            energy: 0.0,
            settled: true,
            scratch: factor.scratch(),
        };
        bent.fit(problem, factor);
        bent
    }

    /// Makes room for a problem of which one path was exchanged, or for the next that was: nothing is allocated where they are as
    /// large. What was solved holds no longer.
    pub fn fit(&mut self, problem: &Compliance, factor: &ComplianceFactor) {
        if self.residual.len() != problem.layout.size {
            self.scratch = factor.scratch();
        }
        let counts = || problem.loads.iter().map(|loads| loads.nodes.len());
        self.starts.clear();
        self.starts.push(0);
        self.starts.extend(counts().scan(0, |next, count| {
            *next += count;
            Some(*next)
        }));
        let (rows, size, nodes) = (problem.rows.len(), problem.layout.size, counts().sum());
        self.lambda.resize(rows, TwoPart::default());
        self.unknowns.resize(size, TwoPart::default());
        self.residual.resize(size, c64::default());
        self.values.resize(rows, c64::default());
        self.loads.resize(nodes, Load::default());
        self.states.resize(nodes, State::default());
        self.forces.resize(counts().max().unwrap_or(0), TwoPart::default());
        self.origins.resize(problem.loads.len(), State::default());
    }

    /// Solves for one target a row. Cost: by rows, but for one pass over the points where motions are free.
    ///
    /// # Errors
    /// [`KktError::ShapeMismatch`] and [`KktError::NotFinite`] for the targets; [`KktError::SolutionNotFinite`] and
    /// [`KktError::Residual`] if no solution came out, or refinement came to rest too early for one to be believed: rows that
    /// are many, stiff and close together depend on each other nearly.
    pub fn solve(
        &mut self,
        problem: &Compliance,
        factor: &ComplianceFactor,
        targets: &[c64],
    ) -> Result<SolveReport, KktError> {
        self.solve_to(Effort::Full, (problem, factor), targets)
    }

    /// The same with less effort.
    ///
    /// # Errors
    /// As [`Bent::solve`].
    pub fn solve_to(
        &mut self,
        effort: Effort,
        (problem, factor): (&Compliance, &ComplianceFactor),
        targets: &[c64],
    ) -> Result<SolveReport, KktError> {
        let (goals, near) = effort.goals();
        check(problem, targets)?;
        // How far points move is counted from zero, whatever was solved before.
        self.states.fill(State::default());
        self.unknowns.fill(TwoPart::default());
        self.residual.fill(c64::default());
        self.residual.iter_mut().zip(targets).zip(&problem.scales).for_each(|((r, d), s)| *r = d * s);
        let scale = largest(&self.residual);
        let (mut last, mut missed, mut refinements, mut settled) = (1.0, f64::INFINITY, 0, false);
        for step in 0..=MOST_REFINEMENTS {
            factor.substitute(&mut self.residual, &mut self.scratch);
            let changed = self.unknowns.iter_mut().zip(&self.residual);
            match step {
                0 => changed.for_each(|(u, first)| u.high = *first),
                _ => changed.for_each(|(u, change)| u.add(*change)),
            }
            let correction = self.bend_nodes(problem, step >= FIRST_COMPENSATED_STEP);
            self.find_residual(problem, targets);
            let misses = relative_to(largest(&self.residual[..problem.rows.len()]), scale);
            let sketched = step == 0 && effort == Effort::Sketch && misses <= SKETCHED;
            settled = sketched || correction * correction <= goals.0 * last && misses <= goals.1;
            let stalled = step > FIRST_COMPENSATED_STEP && misses > 0.5 * missed;
            (last, missed, refinements) = (correction, misses, step);
            if scale == 0.0 || !correction.is_finite() || settled || stalled {
                break;
            }
        }
        self.settled = settled || scale == 0.0 || (last <= near.0 && missed <= near.1);
        let sketched = refinements == 0 && effort == Effort::Sketch;
        let relative_residual =
            self.check_solution(problem, (scale, if sketched { SKETCHED } else { ALLOWED_RESIDUAL }))?;
        if !settled && scale > 0.0 && (last > TRUSTED.0 || missed > TRUSTED.1) {
            return Err(KktError::Residual { relative: last.max(missed), allowed: TRUSTED.0 });
        }
        self.settle_free_motions(problem, refinements >= FIRST_COMPENSATED_STEP);
        Ok(SolveReport {
            energy: self.spring_energy() + self.soft_energy(problem),
            hard_residual: self.hard_residual(problem, targets),
            relative_residual,
            last_correction: last,
            refinements,
        })
    }

    /// Whether the last solve came down to rounding. Where it did not, points are good to nine digits or so.
    pub fn settled(&self) -> bool {
        self.settled
    }

    /// Unknowns of the scaled system.
    pub(crate) fn unknowns(&self) -> &[TwoPart<c64>] {
        &self.unknowns
    }

    /// Multiplier of a row.
    pub(crate) fn multiplier(&self, row: usize) -> c64 {
        self.lambda[row].high
    }

    /// What is known of a piece.
    pub(crate) fn piece(&self, piece: usize) -> PieceBend<'_> {
        let nodes = self.starts[piece]..self.starts[piece + 1];
        PieceBend {
            loads: &self.loads[nodes.clone()],
            states: &self.states[nodes],
            origin: self.origins[piece],
        }
    }

    /// Loads and states at all nodes from the unknowns; how far points moved, relative to the farthest.
    fn bend_nodes(&mut self, problem: &Compliance, compensated: bool) -> f64 {
        for ((lambda, unknown), scale) in self.lambda.iter_mut().zip(&self.unknowns).zip(&problem.scales) {
            *lambda = unknown.scaled(scale / problem.unit);
        }
        let (mut moved, mut farthest) = (0.0_f64, 0.0_f64);
        self.energy = 0.0;
        for (piece, loads) in problem.loads.iter().enumerate() {
            let nodes = self.starts[piece]..self.starts[piece + 1];
            if compensated {
                let forces = &mut self.forces[..nodes.len()];
                loads.compensated_loads_under(&self.lambda, forces, &mut self.loads[nodes.clone()]);
            } else {
                loads.loads_under(&self.lambda, &mut self.loads[nodes.clone()]);
            }
            let y =
                &self.unknowns[problem.layout.similarities[piece]..problem.layout.similarities[piece + 1]];
            self.energy += loads.energy(&self.loads[nodes.clone()]);
            let y = [y[0].high, y.get(1).map_or(c64::default(), |turn| turn.high)];
            let mut see = |before: c64, after: c64| {
                moved = moved.max((after - before).norm_sqr());
                farthest = farthest.max(after.norm_sqr());
            };
            self.origins[piece] =
                loads.states_under(&y, &self.loads[nodes.clone()], &mut self.states[nodes], &mut see);
        }
        relative_to(moved.sqrt(), farthest.sqrt())
    }

    /// What the equations miss, scaled as the system is.
    fn find_residual(&mut self, problem: &Compliance, targets: &[c64]) {
        let layout = &problem.layout;
        self.values.fill(c64::default());
        let rest = &mut self.residual[problem.rows.len()..];
        rest.fill(c64::default());
        for (piece, loads) in problem.loads.iter().enumerate() {
            loads.add_rows(&self.states[self.starts[piece]..self.starts[piece + 1]], &mut self.values);
            let start = layout.similarities[piece] - problem.rows.len();
            loads.visit_similarities(|row, motion, value| {
                rest[start + motion] -= value.conj() * self.lambda[row].high * problem.unit;
            });
        }
        for (index, combination) in problem.free.iter().enumerate() {
            let column = layout.free + index;
            for (motion, share) in combination {
                self.residual[problem.rows.len() + motion] -= share * self.unknowns[column].high;
                self.residual[column] -= share.conj() * self.unknowns[problem.rows.len() + motion].high;
            }
        }
        for (index, row) in problem.rows.iter().enumerate() {
            let slack = row.weight.map_or(c64::default(), |weight| self.lambda[index].high / weight);
            let target = targets.get(index).copied().unwrap_or_default();
            self.residual[index] = problem.scales[index] * (target - self.values[index] - slack);
        }
    }

    fn check_solution(&self, problem: &Compliance, (scale, allowed): (f64, f64)) -> Result<f64, KktError> {
        if !self.unknowns.iter().all(|u| u.high.is_finite())
            || !self.states.iter().all(|s| s.point.is_finite())
        {
            return Err(KktError::SolutionNotFinite);
        }
        let (rows, balance) = self.residual.split_at(problem.rows.len());
        let forces = self.unknowns[..problem.rows.len()].iter().map(|u| u.high.norm_sqr());
        let forces = forces.fold(0.0, f64::max).sqrt().max(scale);
        let relative = relative_to(largest(rows), scale).max(relative_to(largest(balance), forces));
        if relative <= allowed { Ok(relative) } else { Err(KktError::Residual { relative, allowed }) }
    }

    fn hard_residual(&self, problem: &Compliance, targets: &[c64]) -> f64 {
        let hard =
            problem.rows.iter().zip(&self.values).zip(targets).filter(|((row, _), _)| row.weight.is_none());
        hard.map(|((_, value), target)| (target - value).norm_sqr()).fold(0.0, f64::max).sqrt()
    }

    /// Takes off what the springs moved along free motions: no row sees it, and all points together stay nearest to zero.
    fn settle_free_motions(&mut self, problem: &Compliance, compensated: bool) {
        if problem.free.is_empty() {
            return;
        }
        let first = problem.rows.len();
        for combination in &problem.free {
            let mut share = c64::default();
            let mut known = None;
            for (motion, value) in combination {
                let piece = problem.layout.similarities.partition_point(|start| *start <= first + motion) - 1;
                let components = match known {
                    Some((other, components)) if other == piece => components,
                    _ => self.components(problem, piece),
                };
                known = Some((piece, components));
                share += value.conj() * components[first + motion - problem.layout.similarities[piece]];
            }
            for (motion, value) in combination {
                self.unknowns[first + motion].add(-value * share);
            }
        }
        self.bend_nodes(problem, compensated);
    }

    /// Components of a bent piece along its similarities.
    fn components(&self, problem: &Compliance, piece: usize) -> [c64; 2] {
        let path = problem.first_pieces.partition_point(|first| *first <= piece) - 1;
        let (rest, centre) = (&*problem.paths[path], problem.loads[piece].centre());
        let (mut sum, mut turned) = (c64::default(), c64::default());
        self.draw_piece(problem, (path, piece), &mut |j: usize, point: c64, _: c64| {
            sum += point;
            turned += (rest.point(j) - centre).conj() * point;
        });
        problem.loads[piece].components(sum, turned)
    }

    /// Calls `visit` with every point j of a path, in order: j, `x_j`, and the factor `ζ_j` of the segment after it (at the
    /// last point, of the one before). Cost: linear in points.
    pub fn expand(&self, problem: &Compliance, path: usize, mut visit: impl FnMut(usize, c64, c64)) {
        self.draw(problem, path, &mut visit);
    }

    /// Draws all points of a path. Cost: linear in points.
    pub fn draw(&self, problem: &Compliance, path: usize, drawing: &mut impl Drawing) {
        for piece in problem.first_pieces[path]..problem.first_pieces[path + 1] {
            self.draw_piece(problem, (path, piece), drawing);
        }
    }

    fn draw_piece(&self, problem: &Compliance, (path, piece): (usize, usize), drawing: &mut impl Drawing) {
        let (known, rest) = (&problem.loads[piece], &problem.paths[path]);
        let range = self.starts[piece]..self.starts[piece + 1];
        let (mut from, mut state) = (known.first_known(), self.origins[piece]);
        for ((node, load), at_node) in
            known.nodes.iter().zip(&self.loads[range.clone()]).zip(&self.states[range])
        {
            if from >= known.own.start {
                rest.bend(from..*node, state, *load, drawing);
            }
            (from, state) = (*node, *at_node);
        }
        rest.bend(from..known.own.end, state, Load::default(), drawing);
    }

    /// `½ Σ |δ_s|²/c_s`.
    pub fn spring_energy(&self) -> f64 {
        self.energy
    }

    /// `½ Σ w_r |C_r x − d_r|²` of the soft rows.
    pub fn soft_energy(&self, problem: &Compliance) -> f64 {
        let soft = |(row, lambda): (&crate::PointRow<c64>, &TwoPart<c64>)| {
            row.weight.map_or(0.0, |weight| 0.5 * lambda.high.norm_sqr() / weight)
        };
        problem.rows.iter().zip(&self.lambda).map(soft).sum()
    }
}

fn check(problem: &Compliance, targets: &[c64]) -> Result<(), KktError> {
    let (expected, actual) = (problem.given, targets.len());
    if expected != actual {
        return Err(KktError::ShapeMismatch { block: "d", side: "rows", expected, actual });
    }
    match targets.iter().position(|target| !target.is_finite()) {
        Some(row) => Err(KktError::NotFinite { block: "d", row }),
        None => Ok(()),
    }
}

/// Largest modulus; NaN if any entry is not a number.
fn largest(x: &[c64]) -> f64 {
    let larger = |most: f64, own: f64| if own > most || own.is_nan() { own } else { most };
    x.iter().map(c64::norm_sqr).fold(0.0, larger).sqrt()
}
