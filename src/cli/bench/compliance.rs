//! The compliance back end: paths as chains of springs, one unknown a row and two a path.

use cotillion_solvers::workload::Workload;
use cotillion_solvers::{Bent, Compliance, ComplianceFactor, KktError, SpringPath, c64};
use rayon::prelude::*;

use super::measure::{MANY_SAMPLES, Part, Phase, Solver, Watch};

/// Shape or scale system over the rows.
pub(super) struct Springs {
    problem: Compliance,
    factor: ComplianceFactor,
    bent: Bent,
    rows: Vec<cotillion_solvers::PointRow<c64>>,
    deviations: Vec<c64>,
}

impl Solver for Springs {
    type Point = c64;

    fn prepare(workload: &Workload, part: Part, watch: &mut Watch) -> Result<Self, KktError> {
        let problem = watch.lap(Phase::Assemble, || {
            let spring = |path: &Vec<c64>| match part {
                Part::Shape => SpringPath::of_shape(path.clone()),
                Part::Scale | Part::Time => SpringPath::even(path.len()),
            };
            Compliance::new(workload.paths.iter().map(spring).collect(), workload.rows.clone())
        });
        let analysis = watch.lap(Phase::Analyse, || problem.analyse())?;
        let factor = watch.lap(Phase::Factor, || analysis.factor(&problem))?;
        let bent = Bent::new(&problem, &factor);
        let rows = if part == Part::Scale { workload.rows.clone() } else { Vec::new() };
        Ok(Self { problem, factor, bent, rows, deviations: workload.targets.clone() })
    }

    /// The scale system is solved for what is added to the path of the given steps.
    fn solve_into(
        &mut self,
        steps: &[Vec<c64>],
        targets: &[c64],
        points: &mut [Vec<c64>],
        watch: &mut Watch,
    ) -> Result<(), KktError> {
        watch.lap(Phase::Solve, || {
            self.deviations.copy_from_slice(targets);
            for_each(points, |path, points| walk(steps.get(path), points));
            for (deviation, row) in self.deviations.iter_mut().zip(&self.rows) {
                *deviation -= row.terms.iter().map(|(path, j, c)| c * points[*path][*j]).sum::<c64>();
            }
            self.bent.solve(&self.problem, &self.factor, &self.deviations)
        })?;
        watch.lap(Phase::Expand, || {
            for_each(points, |path, points| self.bent.expand(&self.problem, path, |j, x, _| points[j] += x));
        });
        Ok(())
    }
}

/// The path of these steps from 0; no path without steps.
fn walk(steps: Option<&Vec<c64>>, points: &mut [c64]) {
    points.fill(c64::default());
    for (i, step) in steps.into_iter().flatten().enumerate() {
        points[i + 1] = points[i] + step;
    }
}

/// Calls `work` with the number and the points of every path, on all threads where there is enough to do.
fn for_each(points: &mut [Vec<c64>], work: impl Fn(usize, &mut Vec<c64>) + Sync) {
    if points.iter().map(Vec::len).sum::<usize>() > MANY_SAMPLES {
        points.par_iter_mut().enumerate().with_min_len(16).for_each(|(path, points)| work(path, points));
    } else {
        points.iter_mut().enumerate().for_each(|(path, points)| work(path, points));
    }
}
