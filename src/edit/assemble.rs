//! Rows of the spatial systems: shape rows, scale rows, and the sparse matrices they make with the held rows.

use cotillion_solvers::{CsMat, LeastSquares, RowMatrix};

use crate::constraint::Strength;
use crate::edit::columns::Columns;
use crate::edit::gauge;
use crate::edit::hold::{Phase, Prepared, Term};
use crate::edit::settings::{RunMode, SpatialSettings};
use crate::geometry::c64;
use crate::path::RestPath;

use crate::clip::working::WORKING_STEP;

/// Rows inside a stationary stretch that had to be released weigh this much more than others.
const RELEASED_WEIGHT: f64 = 100.0;
/// A row is stiffened by at most this factor.
const LARGEST_STIFFENING: f64 = 1e4;

/// One interior row of a path: `factor · (…)` over the three frames, by [`Phase`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InteriorRow {
    /// Frames before, at and after.
    pub frames: [usize; 3],
    /// Coefficients of the three points.
    pub coefficients: [c64; 3],
    /// What the row and its target are multiplied by.
    pub factor: f64,
}

/// Rows of one path in one phase. Source: Kim et al. 2009, eqs. 3 and 7.
///
/// In the shape phase `−(1−c_i)·p_{i−1} + p_i − c_i·p_{i+1} = 0`, c from the rest path, stiffened where the path is slow;
/// in the scale phase second differences. None strictly inside a stationary stretch (but scale rows where it keeps its shape
/// only), and one for a repeated point.
pub fn interior_rows(
    path: &RestPath,
    phase: Phase,
    settings: &SpatialSettings,
    released: impl Fn(usize) -> bool,
) -> Vec<InteriorRow> {
    let inside = |frame: usize| {
        path.rigid.iter().enumerate().find(|(_, (a, b))| *a < frame && frame < *b).map(|(run, _)| run)
    };
    let mut rows = Vec::with_capacity(path.len());
    for frame in 1..path.len().saturating_sub(1) {
        let run = inside(frame);
        let weight = match run {
            Some(run) if released(run) => RELEASED_WEIGHT.sqrt(),
            Some(_) if phase == Phase::Scale && settings.runs == RunMode::Similar => 1.0,
            Some(_) => continue,
            None => 1.0,
        };
        let row = match phase {
            Phase::Shape => shape_row(path, frame, settings),
            Phase::Scale => Some(scale_row(frame)),
        };
        rows.extend(row.map(|row| InteriorRow { factor: row.factor * weight, ..row }));
    }
    rows
}

fn scale_row(frame: usize) -> InteriorRow {
    let one = c64::new(1.0, 0.0);
    InteriorRow { frames: [frame - 1, frame, frame + 1], coefficients: [one, -2.0 * one, one], factor: 1.0 }
}

/// `None` at later frames of a repeated point, and where it lies at an end of the path.
fn shape_row(path: &RestPath, frame: usize, settings: &SpatialSettings) -> Option<InteriorRow> {
    if path.coincide(frame - 1, frame) {
        return None;
    }
    let next = (frame + 1..path.len()).find(|next| !path.coincide(next - 1, *next))?;
    let points = &path.positions;
    let (before, after) = (points[frame] - points[frame - 1], points[next] - points[frame]);
    let tangent = points[next] - points[frame - 1];
    let free = before.norm_sqr() * after.norm_sqr() / tangent.norm_sqr();
    let floor = (WORKING_STEP * settings.stiffness_speed / 2.0).powi(2);
    let frames = [frame - 1, frame, next];
    let one = c64::new(1.0, 0.0);
    if free <= settings.stiffness_cap {
        let c = before / tangent;
        let factor = (floor / free).max(1.0).sqrt().min(LARGEST_STIFFENING);
        return Some(InteriorRow { frames, coefficients: [c - one, one, -c], factor });
    }
    let root = settings.stiffness_cap.sqrt();
    let (b, a) = (root / before, root / after);
    Some(InteriorRow { frames, coefficients: [b, -(b + a), a], factor: 1.0 })
}

/// Where the target of a matrix row comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// An interior row of a path (path, middle frame): 0, or the change of the rescaled segments.
    Interior {
        /// By position in the component.
        path: usize,
        /// Frame in the middle.
        frame: usize,
    },
    /// A held row, by position in the list.
    Held(usize),
    /// A gauge row: the value on the reference path.
    Gauge(usize),
}

/// A matrix row's target rule: `scale · (source − constants)`.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetRule {
    /// What it equals.
    pub source: Source,
    /// Factor of the whole row.
    pub scale: f64,
    /// Terms whose points have a constant part, which moves to the right.
    pub constants: Vec<Term>,
}

/// One phase of one component: matrices and how to fill their right-hand sides.
#[derive(Clone, Debug)]
pub struct PhaseSystem {
    /// Unknowns.
    pub columns: Columns,
    /// `M` and `H` (independent rows only).
    pub problem: LeastSquares<c64>,
    /// Rules of the rows of `M`: interior rows first.
    pub soft: Vec<TargetRule>,
    /// How many rows of `M` are interior rows.
    pub interior: usize,
    /// Rules of all hard held rows, redundant ones included.
    pub hard: Vec<TargetRule>,
    /// Hard held rows without the redundant ones, as a matrix of the rows in `hard`.
    pub hard_rows: CsMat<c64>,
    /// Rules of the gauge rows, appended to `H`.
    pub gauge: Vec<TargetRule>,
    /// Coefficients of the gauge rows on the points of the paths.
    pub gauge_terms: Vec<Vec<Term>>,
}

/// Assembles `phase` of a component. `released`: stretches (path, position) without rigidity. Redundant hard rows are
/// still in; the caller finds them. Cost: linear in frames.
pub fn assemble(
    paths: &[RestPath],
    held: &[Prepared],
    phase: Phase,
    settings: &SpatialSettings,
    released: &[(usize, usize)],
) -> PhaseSystem {
    let columns = Columns::new(paths, phase, settings.runs, released);
    let counts: Vec<usize> = paths.iter().map(RestPath::len).collect();
    let mut soft = RowBlock::new(&columns);
    for (index, path) in paths.iter().enumerate() {
        for row in interior_rows(path, phase, settings, |run| released.contains(&(index, run))) {
            let terms: Vec<Term> =
                row.frames.iter().zip(row.coefficients).map(|(frame, c)| (index, *frame, c)).collect();
            soft.push(&terms, row.factor, Source::Interior { path: index, frame: row.frames[1] });
        }
    }
    let interior = soft.rules.len();
    let mut hard = RowBlock::new(&columns);
    let mut functionals = Vec::new();
    for (index, prepared) in held.iter().enumerate() {
        if !prepared.binds(phase, settings.runs == RunMode::Rigid) {
            continue;
        }
        let terms = prepared.terms(phase, settings.relative, &counts);
        match prepared.row.strength {
            Strength::Hard => hard.push(&terms, 1.0, Source::Held(index)),
            Strength::Soft(weight) => {
                soft.push(&terms, weight.sqrt() * prepared.soft_scale(), Source::Held(index));
            }
        }
        functionals.push(terms);
    }
    let gauge_terms = gauge::rows(paths, &functionals, phase, settings.runs, released);
    let mut gauge = RowBlock::new(&columns);
    for (index, terms) in gauge_terms.iter().enumerate() {
        gauge.push(terms, 1.0, Source::Gauge(index));
    }
    let hard_rows = hard.matrix.to_csr();
    let problem =
        LeastSquares { columns: columns.count, soft: soft.matrix.to_csr(), hard: hard_rows.clone() };
    let (soft, hard, gauge) = (soft.rules, hard.rules, gauge.rules);
    PhaseSystem { columns, problem, soft, interior, hard, hard_rows, gauge, gauge_terms }
}

impl PhaseSystem {
    /// Makes `H` of the hard rows `kept` and the gauge rows.
    pub fn keep_hard_rows(&mut self, kept: &[usize]) {
        let mut matrix = RowMatrix::new(self.columns.count);
        for row in kept {
            if let Some(values) = self.hard_rows.outer_view(*row) {
                let terms: Vec<(usize, c64)> =
                    values.iter().map(|(column, value)| (column, *value)).collect();
                matrix.push_row(&terms);
            }
        }
        let mut spare = Vec::new();
        for terms in &self.gauge_terms {
            let mut row = Vec::with_capacity(terms.len());
            self.columns.expand(terms, &mut row, &mut spare);
            matrix.push_row(&row);
        }
        self.problem.hard = matrix.to_csr();
    }
}

/// A growing block of rows with their rules.
struct RowBlock<'a> {
    columns: &'a Columns,
    matrix: RowMatrix<c64>,
    rules: Vec<TargetRule>,
}

impl<'a> RowBlock<'a> {
    fn new(columns: &'a Columns) -> Self {
        Self { columns, matrix: RowMatrix::new(columns.count), rules: Vec::new() }
    }

    fn push(&mut self, terms: &[Term], scale: f64, source: Source) {
        let mut row = Vec::with_capacity(2 * terms.len());
        let mut constants = Vec::new();
        self.columns.expand(terms, &mut row, &mut constants);
        row.iter_mut().for_each(|(_, value)| *value *= scale);
        self.matrix.push_row(&row);
        self.rules.push(TargetRule { source, scale, constants });
    }
}
