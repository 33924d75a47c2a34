//! Many paths under three-term rows, tied by rows on a few of their points: solved on these points alone, and exactly.
//!
//! ```text
//!     min  ½ Σ |A p_{r} + B p_{r+1} + C p_{r+2} − t|²  +  ½ Σ weight |Σ coefficient · point − target|²
//!     subject to the hard point rows
//! ```
//!
//! Phases, each callable by itself; every one needs those before it:
//!
//! | phase | call | repeat when |
//! |---|---|---|
//! | condense, assemble | [`ChainSystem::new`] | coefficients or weights change |
//! | analyse | [`analyse`](crate::analyse) of [`ChainSystem::problem`] | point rows touch other points |
//! | factor | [`Analysis::factor`](crate::Analysis::factor) of it | coefficients or weights change |
//! | solve | [`ChainSystem::solve_into`] | targets change |
//! | expand | [`ChainSystem::expand`] | targets change |
//!
//! The reduced problem has the kept points as unknowns, for each span between kept pairs its two rows (of a span of
//! one row, that row), then the soft point rows, and the hard ones. Hard rows must be independent, else factoring ends
//! in [`KktError::Singular`]: [`analyse_rank`](crate::analyse_rank) of the problem's hard rows tells which are not.
//! A path that no point row holds, up to a similarity of all points tied together, ends there too.

use crate::augmented::check_length;
use crate::c64;
use crate::chain::{ChainRow, check_finite};
use crate::chain_path::{CondensedPath, PathTargets, RowTargets};
use crate::error::{KktError, SolveReport};
use crate::kkt::{Factor, Workspace};
use crate::least_squares::LeastSquares;
use crate::points::{PointRow, PointTerm};
use crate::scalar::Scalar;
use crate::sparse::RowMatrix;
use rayon::prelude::*;

/// Fewer points are done with before other threads have woken up.
const PARALLEL_POINTS: usize = 32_768;

/// A system of paths, condensed to the points that point rows touch.
#[derive(Clone, Debug)]
pub struct ChainSystem {
    paths: Vec<CondensedPath>,
    /// First unknown of each path, and the end.
    column_starts: Vec<usize>,
    row_targets: RowTargets,
    /// Roots of the weights of the point rows; none for hard ones.
    weight_roots: Vec<Option<f64>>,
    problem: LeastSquares<c64>,
}

/// Memory of solves and expansions with one system and factor; nothing else is allocated.
pub struct ChainWorkspace {
    paths: Vec<PathTargets>,
    soft_targets: Vec<c64>,
    hard_targets: Vec<c64>,
    kept: Vec<c64>,
    kkt: Workspace<c64>,
}

impl ChainSystem {
    /// Condenses all paths and assembles the reduced problem. `paths`: the rows of each path, two fewer than its points.
    ///
    /// Cost: linear in points and terms; parallel over paths.
    ///
    /// # Errors
    /// [`KktError::NotFinite`] for three-term rows, counted through all paths; [`KktError::Singular`] if rows leave a
    /// point free that no point row touches.
    ///
    /// # Panics
    /// If a point row names a path or point that does not exist.
    pub fn new(
        paths: &[Vec<ChainRow>],
        point_rows: &[PointRow<c64>],
        row_targets: RowTargets,
    ) -> Result<Self, KktError> {
        check_finite("M", paths.iter().flatten().map(|row| row.iter().all(|a| a.all_finite())))?;
        let touched = touched_points(paths, point_rows);
        let condense =
            |(rows, touched): (&Vec<ChainRow>, &Vec<usize>)| CondensedPath::new(rows, touched, row_targets);
        let condensed: Vec<Result<CondensedPath, KktError>> = if are_many(paths.iter().map(Vec::len)) {
            paths.par_iter().zip(&touched).map(condense).collect()
        } else {
            paths.iter().zip(&touched).map(condense).collect()
        };
        let paths = condensed.into_iter().collect::<Result<Vec<_>, _>>()?;
        let mut column_starts = vec![0];
        for path in &paths {
            column_starts.push(column_starts[column_starts.len() - 1] + path.kept.len());
        }
        let weight_roots = point_rows.iter().map(|row| row.weight.map(f64::sqrt)).collect();
        let problem = assemble(&paths, &column_starts, point_rows);
        Ok(Self { paths, column_starts, row_targets, weight_roots, problem })
    }

    /// The reduced problem: its unknowns are the kept points of all paths, in order.
    pub fn problem(&self) -> &LeastSquares<c64> {
        &self.problem
    }

    /// Memory for [`solve_into`](Self::solve_into) and [`expand`](Self::expand).
    pub fn workspace(&self, factor: &Factor<c64>) -> ChainWorkspace {
        ChainWorkspace {
            paths: self.paths.iter().map(|path| path.targets(self.row_targets)).collect(),
            soft_targets: vec![c64::default(); self.problem.soft.rows()],
            hard_targets: vec![c64::default(); self.problem.hard.rows()],
            kept: vec![c64::default(); self.problem.columns],
            kkt: factor.workspace(),
        }
    }

    /// Solves the reduced problem. `factor`: of [`problem`](Self::problem). `point_targets`: one per point row.
    /// `row_targets`: for each path one per three-term row; empty with [`RowTargets::Zero`]. The report's energy is
    /// that of all rows.
    ///
    /// # Errors
    /// As [`Factor::solve_into`]; block m stands for the point targets, t for the row targets, its paths and their rows.
    pub fn solve_into(
        &self,
        factor: &Factor<c64>,
        point_targets: &[c64],
        row_targets: &[Vec<c64>],
        workspace: &mut ChainWorkspace,
    ) -> Result<SolveReport, KktError> {
        check_length("m", self.weight_roots.len(), point_targets.len())?;
        check_finite("m", point_targets.iter().map(|target| target.all_finite()))?;
        self.reduce_targets(row_targets, &mut workspace.paths)?;
        self.fill_targets(point_targets, workspace);
        let ChainWorkspace { soft_targets, hard_targets, kept, kkt, .. } = workspace;
        factor.solve_into(soft_targets, hard_targets, kept, kkt)
    }

    /// Writes all points of all paths from the last solution. `points`: one vector per path, one number per point; what
    /// they hold after an error is undefined.
    ///
    /// Cost: one pass over the points; parallel over paths.
    ///
    /// # Errors
    /// [`KktError::ShapeMismatch`], block x; [`KktError::SolutionNotFinite`].
    pub fn expand(&self, workspace: &ChainWorkspace, points: &mut [Vec<c64>]) -> Result<(), KktError> {
        check_length("x", self.paths.len(), points.len())?;
        for (path, points) in self.paths.iter().zip(points.iter()) {
            check_length("x", path.point_count, points.len())?;
        }
        let expand = |(index, points): (usize, &mut Vec<c64>)| {
            let kept = &workspace.kept[self.column_starts[index]..self.column_starts[index + 1]];
            self.paths[index].expand(kept, &workspace.paths[index], points)
        };
        if self.is_large() {
            points.par_iter_mut().enumerate().try_for_each(expand)
        } else {
            points.iter_mut().enumerate().try_for_each(expand)
        }
    }

    fn reduce_targets(&self, row_targets: &[Vec<c64>], reduced: &mut [PathTargets]) -> Result<(), KktError> {
        if self.row_targets == RowTargets::Zero {
            return check_length("t", 0, row_targets.len());
        }
        check_length("t", self.paths.len(), row_targets.len())?;
        for (path, targets) in self.paths.iter().zip(row_targets) {
            check_length("t", path.point_count - 2, targets.len())?;
        }
        check_finite("t", row_targets.iter().flatten().map(|target| target.all_finite()))?;
        let reduce =
            |(index, out): (usize, &mut PathTargets)| self.paths[index].reduce(&row_targets[index], out);
        if self.is_large() {
            reduced.par_iter_mut().enumerate().for_each(reduce);
        } else {
            reduced.iter_mut().enumerate().for_each(reduce);
        }
        Ok(())
    }

    /// Targets of the reduced rows, in the order of [`assemble`].
    fn fill_targets(&self, point_targets: &[c64], workspace: &mut ChainWorkspace) {
        let ChainWorkspace { paths, soft_targets, hard_targets, .. } = workspace;
        let spans =
            self.paths.iter().zip(paths).flat_map(|(path, targets)| path.spans.iter().zip(&targets.spans));
        let of_spans = spans.flat_map(|(span, targets)| targets.iter().copied().take(span.piece.row_count()));
        let of_points = self.weight_roots.iter().zip(point_targets);
        let of_soft = of_points.clone().filter_map(|(root, target)| root.map(|root| target * root));
        soft_targets.iter_mut().zip(of_spans.chain(of_soft)).for_each(|(slot, target)| *slot = target);
        let of_hard = of_points.filter(|(root, _)| root.is_none()).map(|(_, &target)| target);
        hard_targets.iter_mut().zip(of_hard).for_each(|(slot, target)| *slot = target);
    }

    fn is_large(&self) -> bool {
        are_many(self.paths.iter().map(|path| path.point_count))
    }
}

impl ChainWorkspace {
    /// Multipliers of the hard point rows in the last solve, in their order: see [`Workspace::multipliers`].
    pub fn multipliers(&self) -> &[c64] {
        self.kkt.multipliers()
    }
}

/// Rows of the spans of all paths, soft point rows, hard point rows, over the kept points.
fn assemble(
    paths: &[CondensedPath],
    column_starts: &[usize],
    point_rows: &[PointRow<c64>],
) -> LeastSquares<c64> {
    let columns = column_starts[paths.len()];
    let (mut soft, mut hard) = (RowMatrix::new(columns), RowMatrix::new(columns));
    for (path, start) in paths.iter().zip(column_starts) {
        for span in &path.spans {
            for row in &span.piece.rows[..span.piece.row_count()] {
                soft.push_row(&[0, 1, 2, 3].map(|k: usize| (start + span.corners[k], row[k])));
            }
        }
    }
    let column = |&(path, point, _): &PointTerm<c64>| {
        let place = paths[path].kept.binary_search(&point);
        column_starts[path] + place.expect("touched points are kept")
    };
    for row in point_rows {
        let root = row.weight.map_or(1.0, f64::sqrt);
        let terms: Vec<_> = row.terms.iter().map(|term| (column(term), term.2 * root)).collect();
        if row.weight.is_some() { &mut soft } else { &mut hard }.push_row(&terms);
    }
    LeastSquares { columns, soft: soft.to_csr(), hard: hard.to_csr() }
}

/// Points of each path that point rows touch, rising.
fn touched_points(paths: &[Vec<ChainRow>], point_rows: &[PointRow<c64>]) -> Vec<Vec<usize>> {
    let mut touched = vec![Vec::new(); paths.len()];
    for &(path, point, _) in point_rows.iter().flat_map(|row| &row.terms) {
        let count = paths[path].len() + 2;
        assert!(point < count, "point {point} of a path of {count} points");
        touched[path].push(point);
    }
    for points in &mut touched {
        points.sort_unstable();
        points.dedup();
    }
    touched
}

fn are_many(points: impl Iterator<Item = usize>) -> bool {
    points.sum::<usize>() >= PARALLEL_POINTS
}
