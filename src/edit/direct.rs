//! One phase as the sparse system of all frames: the reference for the reduced one.

use cotillion_solvers::{Factor, KktError, KktForm, LeastSquares, PointRow, RowMatrix, Workspace, analyse};

use crate::edit::columns::{Columns, Freedom};
use crate::edit::gauge;
use crate::edit::hold::{Phase, Term};
use crate::edit::pairs::Pairs;
use crate::edit::settings::{Backend, RunMode, SpatialSettings};
use crate::edit::springs::{RELEASED_WEIGHT, ShapeSpring, shape_spring};
use crate::geometry::c64;
use crate::path::RestPath;

/// Interior rows, held rows and gauge rows of a group of paths over all free frames, for deviations from a reference that
/// satisfies the interior rows.
pub struct DirectPhase {
    columns: Columns,
    problem: LeastSquares<c64>,
    /// How many rows of `M` are interior rows.
    interior: usize,
    /// Free motions fixed by gauge rows, which follow the held ones in `H`.
    pub gauges: usize,
    /// Whether the system is that of [`Backend::Published`].
    published: bool,
    factor: Option<Factored>,
    x: Vec<c64>,
    soft_targets: Vec<c64>,
    hard_targets: Vec<c64>,
}

/// A phase as the problem of all frames, with its targets and what came of them: for other solvers to be compared with.
#[derive(Clone, Copy, Debug)]
pub struct FrameProblem<'a> {
    /// `min ½‖M x − m‖²` subject to `H x = h`, x: deviations from rest of the free frames.
    pub problem: &'a LeastSquares<c64>,
    /// m.
    pub soft_targets: &'a [c64],
    /// h.
    pub hard_targets: &'a [c64],
    /// x of the last solve.
    pub solution: &'a [c64],
    /// How many of the rows of `H` are not of constraints but fix motions that nothing else holds.
    pub gauges: usize,
}

/// In which numbers a system is factored.
enum Factored {
    Complex(Factor<c64>, Workspace<c64>),
    Pairs(Pairs),
}

impl DirectPhase {
    /// Assembles. `rows`: held rows, the hard ones independent. Cost: linear in frames.
    pub fn new(
        freedom: Freedom,
        rows: &[PointRow<c64>],
        settings: &SpatialSettings,
        backend: Backend,
    ) -> Self {
        let published = backend == Backend::Published;
        let columns = if published { Columns::one_per_frame(freedom) } else { Columns::all(freedom) };
        let mut soft = RowMatrix::new(columns.count);
        for path in 0..freedom.paths.len() {
            push_interior_rows(freedom, path, settings, |terms| {
                soft.push_row(&columns.row(terms));
            });
        }
        let interior = soft.rows();
        let mut hard = RowMatrix::new(columns.count);
        for row in rows {
            let mut values = columns.row(&row.terms);
            let Some(weight) = row.weight else {
                hard.push_row(&values);
                continue;
            };
            values.iter_mut().for_each(|(_, value)| *value *= weight.sqrt());
            soft.push_row(&values);
        }
        let gauge = gauge::rows(freedom, rows);
        gauge.iter().for_each(|terms| {
            hard.push_row(&columns.row(terms));
        });
        let held = if published { still_rows(freedom, settings) } else { Vec::new() };
        held.iter().for_each(|terms| {
            hard.push_row(&columns.row(terms));
        });
        let (soft_targets, hard_targets) =
            (vec![c64::default(); soft.rows()], vec![c64::default(); hard.rows()]);
        Self {
            x: vec![c64::default(); columns.count],
            problem: LeastSquares { columns: columns.count, soft: soft.to_csr(), hard: hard.to_csr() },
            columns,
            interior,
            gauges: gauge.len(),
            published,
            factor: None,
            soft_targets,
            hard_targets,
        }
    }

    /// Factors the system unless that is done.
    ///
    /// # Errors
    /// What the solver says of a matrix it cannot factor.
    pub fn factor(&mut self) -> Result<(), KktError> {
        if self.factor.is_none() && self.published {
            self.factor = Some(Factored::Pairs(Pairs::new(&self.problem)?));
        } else if self.factor.is_none() {
            let factor = analyse(&self.problem, KktForm::Hachtel)?.factor(&self.problem)?;
            let workspace = factor.workspace();
            self.factor = Some(Factored::Complex(factor, workspace));
        }
        Ok(())
    }

    /// Solves for one target a held row.
    ///
    /// # Errors
    /// What the solver says.
    pub fn solve(&mut self, rows: &[PointRow<c64>], targets: &[c64]) -> Result<(), KktError> {
        self.factor()?;
        let (mut soft, mut hard) = (self.interior, 0);
        for (row, target) in rows.iter().zip(targets) {
            match row.weight {
                Some(weight) => {
                    self.soft_targets[soft] = target * weight.sqrt();
                    soft += 1;
                }
                None => {
                    self.hard_targets[hard] = *target;
                    hard += 1;
                }
            }
        }
        let (m, h, x) = (&self.soft_targets, &self.hard_targets, &mut self.x);
        match &mut self.factor {
            Some(Factored::Complex(factor, workspace)) => factor.solve_into(m, h, x, workspace).map(|_| ()),
            Some(Factored::Pairs(pairs)) => pairs.solve_into((m, h), x),
            None => Ok(()),
        }
    }

    /// Calls `visit` with every frame of a path and its deviation.
    pub fn visit(&self, path: usize, mut visit: impl FnMut(usize, c64)) {
        self.columns.points(path, &self.x).enumerate().for_each(|(frame, x)| visit(frame, x));
    }

    /// The problem, as last solved.
    pub fn frame_problem(&self) -> FrameProblem<'_> {
        FrameProblem {
            problem: &self.problem,
            soft_targets: &self.soft_targets,
            hard_targets: &self.hard_targets,
            solution: &self.x,
            gauges: self.gauges,
        }
    }

    /// Energies of the interior rows and of the soft held rows.
    pub fn energies(&self) -> (f64, f64) {
        let energy = |rows| self.problem.energy_of_rows(rows, &self.x, &self.soft_targets);
        (energy(0..self.interior), energy(self.interior..self.soft_targets.len()))
    }
}

/// Interior rows of one path: in the shape phase `−(1−c_i)·p_{i−1} + p_i − c_i·p_{i+1}`, c from the rest path, stiffened where
/// the path is slow; in the scale phase second differences. None that ties points of one stationary stretch only (but
/// scale rows where it keeps its shape only), and one for a repeated point.
fn push_interior_rows(
    freedom: Freedom,
    path: usize,
    settings: &SpatialSettings,
    mut push: impl FnMut(&[Term]),
) {
    let rest = &freedom.paths[path];
    for frame in 1..rest.len().saturating_sub(1) {
        let next = match freedom.phase {
            Phase::Shape => shape_spring(rest, frame, settings).map_or(frame + 1, |spring| spring.next),
            Phase::Scale => frame + 1,
        };
        let run = rest.rigid.iter().position(|(a, b)| *a < frame && next <= *b);
        let weight = match run {
            Some(run) if freedom.released.contains(&(path, run)) => RELEASED_WEIGHT,
            Some(_) if freedom.phase == Phase::Scale && freedom.runs == RunMode::Similar => 1.0,
            Some(_) => continue,
            None => 1.0,
        };
        let sampling = freedom.samplings.get(path);
        let row = match freedom.phase {
            Phase::Shape => {
                let known = sampling.map(|sampling| sampling.compliances[frame]).filter(|known| *known > 0.0);
                shape_spring(rest, frame, settings).map(|spring| shape_row(rest, (frame, spring), known))
            }
            Phase::Scale => {
                let still =
                    |step: usize| freedom.kept_runs(path).any(|(first, last)| first <= step && step < last);
                let span = |step: usize| sampling.filter(|_| !still(step)).map_or(1.0, |own| own.span(step));
                Some(scale_row(frame, (span(frame - 1), span(frame))))
            }
        };
        if let Some((frames, coefficients)) = row {
            let factor = weight.sqrt();
            let term = |k: usize| (path, frames[k], coefficients[k] * factor);
            push(&[term(0), term(1), term(2)]);
        }
    }
}

/// Rows that hold what [`Columns::all`] has no unknowns for: the shape rows of stationary
/// stretches, all their steps where they keep their length, and points that repeat the one before. All of them are 0.
fn still_rows(freedom: Freedom, settings: &SpatialSettings) -> Vec<Vec<Term>> {
    let one = c64::new(1.0, 0.0);
    let mut rows = Vec::new();
    for (path, rest) in freedom.paths.iter().enumerate() {
        let step = |frame: usize| vec![(path, frame - 1, -one), (path, frame, one)];
        let kept = |(a, b): (usize, usize)| freedom.kept_runs(path).any(|run| run.0 <= a && b <= run.1);
        for frame in 1..rest.len() {
            let together = kept((frame - 1, frame));
            let rigid = freedom.phase == Phase::Scale && freedom.runs == RunMode::Rigid;
            let similar = freedom.phase == Phase::Shape || freedom.runs == RunMode::Similar;
            let repeats = rest.coincide(frame - 1, frame);
            if together && rigid || repeats && (freedom.phase == Phase::Shape || together) {
                rows.push(step(frame));
            }
            if !similar || frame + 1 == rest.len() {
                continue;
            }
            let Some(spring) = shape_spring(rest, frame, settings) else { continue };
            if kept((frame - 1, spring.next)) {
                let (frames, coefficients) = shape_row(rest, (frame, spring), None);
                rows.push((0..3).map(|k| (path, frames[k], coefficients[k])).collect());
            }
        }
    }
    rows
}

/// Three frames and their coefficients.
type InteriorRow = ([usize; 3], [c64; 3]);

/// Differences per frame; `spans`: frames before and after.
fn scale_row(frame: usize, spans: (f64, f64)) -> InteriorRow {
    let root = (2.0 / (spans.0 + spans.1)).sqrt();
    let (before, after) = (c64::new(root / spans.0, 0.0), c64::new(root / spans.1, 0.0));
    ([frame - 1, frame, frame + 1], [before, -(before + after), after])
}

/// `compliance`: in place of that of the spring.
fn shape_row(path: &RestPath, (frame, spring): (usize, ShapeSpring), compliance: Option<f64>) -> InteriorRow {
    let stiffness = compliance.map_or(spring.stiffness, f64::recip);
    let points = &path.positions;
    let frames = [spring.before, frame, spring.next];
    let (before, after) = (points[frame] - points[spring.before], points[spring.next] - points[frame]);
    if spring.free <= stiffness {
        let c = before / (points[spring.next] - points[spring.before]);
        let factor = (stiffness / spring.free).sqrt();
        let one = c64::new(1.0, 0.0);
        return (frames, [(c - one) * factor, one * factor, -c * factor]);
    }
    let root = stiffness.sqrt();
    let (b, a) = (root / before, root / after);
    (frames, [b, -(b + a), a])
}
