//! One phase reduced exactly to its held rows: paths as springs.

use std::ops::Range;
use std::sync::Arc;

use cotillion_solvers::{
    Bent, Compliance, ComplianceAnalysis, ComplianceFactor, Drawing, Effort, KktError, Likeness,
    PathResponse, PointRow, SpringPath,
};
use rayon::prelude::*;

use crate::edit::bound_rows::BoundRows;
use crate::edit::columns::Freedom;
use crate::edit::settings::SpatialSettings;
use crate::edit::springs::{run_rows, spring_path};
use crate::geometry::c64;

/// Springs of a group of paths with its held rows, for deviations from a reference that bends no spring.
pub struct ReducedPhase {
    problem: Compliance,
    analysis: Option<ComplianceAnalysis>,
    factor: Option<ComplianceFactor>,
    /// Of held rows, then of rigid stretches, which are 0.
    targets: Vec<c64>,
    /// Of solves.
    pub effort: Effort,
}

impl ReducedPhase {
    /// Assembles, or `None` where springs cannot express the paths, or where there are so many rows on the same frames that
    /// all frames are the smaller system. `rows`: held rows, the hard ones independent. Cost: linear in frames.
    pub fn new(freedom: Freedom, mut rows: Vec<PointRow<c64>>, settings: &SpatialSettings) -> Option<Self> {
        if crowded(freedom.paths.len(), &rows) {
            return None;
        }
        let paths = (0..freedom.paths.len()).into_par_iter().with_min_len(16);
        let paths = paths.map(|path| spring_path(freedom, path, settings)).collect::<Option<Vec<_>>>()?;
        rows.extend(run_rows(freedom));
        let targets = vec![c64::default(); rows.len()];
        Some(Self {
            problem: Compliance::new(paths, rows),
            analysis: None,
            factor: None,
            targets,
            effort: Effort::Full,
        })
    }

    /// Factors the system unless that is done.
    ///
    /// # Errors
    /// What the solver says of a matrix it cannot factor.
    pub fn factor(&mut self) -> Result<(), KktError> {
        if self.factor.is_none() {
            let analysis = self.analysis()?;
            self.factor = Some(analysis.factor(&self.problem)?);
        }
        Ok(())
    }

    /// Plans the elimination unless that is done, or was for another system of the same pattern.
    fn analysis(&mut self) -> Result<ComplianceAnalysis, KktError> {
        let fits = |analysis: &ComplianceAnalysis| analysis.fits(&self.problem);
        let analysis = match self.analysis.take().filter(fits) {
            Some(analysis) => analysis,
            None => self.problem.analyse()?,
        };
        Ok(self.analysis.insert(analysis).clone())
    }

    /// Takes over what another system of the same rows, with other coefficients, knows of their pattern.
    pub fn adopt(&mut self, before: &Self) {
        self.analysis.clone_from(&before.analysis);
    }

    /// Solves for one target a held row, with the memory of an earlier solve, if there was one; whether the solution is good to
    /// rounding. It is not where rows that are many, stiff and close together depend on each other nearly.
    pub fn solve(&mut self, targets: &[c64], memory: &mut Option<Bent>) -> bool {
        self.targets[..targets.len()].copy_from_slice(targets);
        let Some(factor) = &self.factor else { return false };
        let bent = memory.get_or_insert_with(|| Bent::new(&self.problem, factor));
        bent.fit(&self.problem, factor);
        let solved = bent.solve_to(self.effort, (&self.problem, factor), &self.targets);
        solved.is_ok() && bent.settled()
    }

    /// Calls `visit` with every frame of a path and its deviation.
    pub fn visit(&self, bent: &Bent, path: usize, mut visit: impl FnMut(usize, c64)) {
        bent.expand(&self.problem, path, |frame, x, _| visit(frame, x));
    }

    /// Draws a path of deviations.
    pub fn draw(&self, bent: &Bent, path: usize, drawing: &mut impl Drawing) {
        bent.draw(&self.problem, path, drawing);
    }

    /// Compares a path with that of another solution, see [`Bent::compare`].
    pub fn compare(
        &self,
        bent: &Bent,
        (other, its): (&Self, &Bent),
        path: usize,
        visit: impl FnMut(Range<usize>, Likeness),
    ) -> bool {
        bent.compare(&self.problem, (its, &other.problem), path, visit)
    }

    /// See [`Bent::work`]; `rows`: how many held rows there are.
    pub fn work(&self, bent: &Bent, rows: usize, by: impl Fn(usize) -> f64) -> f64 {
        bent.work(&self.problem, rows, by)
    }

    /// Energies of the springs and of the soft held rows.
    pub fn energies(&self, bent: &Bent) -> (f64, f64) {
        (bent.spring_energy(), bent.soft_energy(&self.problem))
    }

    /// How path `path` answers to changes of itself; `None` where the system is not factored, or leaves motions free that a
    /// changed path might not.
    pub fn response(&self, path: usize) -> Option<PathResponse> {
        let factor = self.factor.as_ref().filter(|_| self.problem.free_motions() == 0)?;
        Some(PathResponse::new(&self.problem, factor, path))
    }

    /// The same with the path `path` of `freedom`, of other `springs`, and other terms and weights of the rows on it;
    /// `None` where that has other unknowns or is singular. `response`: of the path. `before`: the same in an earlier system, whose
    /// work is taken over where it is the same.
    pub fn exchanged(
        &self,
        (path, freedom): (usize, Freedom),
        springs: Arc<SpringPath>,
        rows: &BoundRows,
        (response, before): (&PathResponse, Option<&Self>),
    ) -> Option<Self> {
        let factor = self.factor.as_ref()?;
        let run_rows = run_rows(freedom);
        let targets = self.targets.clone();
        let run_rows = run_rows.iter().map(|row| (row.terms.as_slice(), row.weight));
        let rows = rows.iter().chain(run_rows);
        let problem = self.problem.with_path(path, springs, rows, before.map(|before| &before.problem))?;
        let before = before.and_then(|before| before.factor.as_ref());
        let factor = response.factor((&self.problem, factor), &problem, before).ok()?;
        Some(Self { problem, analysis: None, factor: Some(factor), targets, effort: Effort::Estimate })
    }

    /// Free motions fixed as at rest.
    pub fn gauges(&self) -> usize {
        self.problem.free_motions()
    }
}

/// Rows on one path that are always taken on, and how many more for each frame they touch.
const ROWS: (usize, usize) = (64, 8);

/// Whether the rows of some path are many more than the frames they touch.
fn crowded(paths: usize, rows: &[PointRow<c64>]) -> bool {
    let mut frames: Vec<Vec<usize>> = vec![Vec::new(); paths];
    rows.iter().flat_map(|row| &row.terms).for_each(|(path, frame, _)| frames[*path].push(*frame));
    frames.into_iter().any(|mut own| {
        let terms = own.len();
        own.sort_unstable();
        own.dedup();
        terms > ROWS.0 + ROWS.1 * own.len()
    })
}
