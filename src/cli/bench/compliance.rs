//! The compliance back end: paths as chains of springs, one unknown a row and two a path.

use cotillion_solvers::workload::Workload;
use cotillion_solvers::{Bent, Compliance, ComplianceFactor, KktError, PointRow, SpringPath, c64};
use rayon::prelude::*;

use super::measure::{MANY_SAMPLES, Part, Phase, Solver, Steps, Watch, map_paths};

/// Shape or scale system over the rows.
pub(super) struct Springs {
    problem: Compliance,
    factor: ComplianceFactor,
    bent: Bent,
    /// Rows of the workload, where the system is solved for what is added to a path of given steps; else none.
    rows: Vec<PointRow<c64>>,
    /// Targets of the rows of the workload, then of those of the stands, which are 0.
    targets: Vec<c64>,
}

impl Solver for Springs {
    type Point = c64;

    fn prepare(workload: &Workload, part: Part, watch: &mut Watch) -> Result<Self, KktError> {
        let (problem, rows, targets) = watch.lap(Phase::Assemble, || {
            let paths = map_paths(workload, |path| spring_path(workload, path, part));
            let stands = if part == Part::Scale { first_steps(workload) } else { Vec::new() };
            let targets = vec![c64::default(); workload.rows.len() + stands.len()];
            let rows = if part == Part::Scale { workload.rows.clone() } else { Vec::new() };
            let all = [workload.rows.as_slice(), &stands].concat();
            (Compliance::new(paths, all), rows, targets)
        });
        let analysis = watch.lap(Phase::Analyse, || problem.analyse())?;
        let (factor, bent) = watch.lap(Phase::Factor, || {
            let factor = analysis.factor(&problem)?;
            let bent = Bent::new(&problem, &factor);
            Ok((factor, bent))
        })?;
        Ok(Self { problem, factor, bent, rows, targets })
    }

    fn solve_into(
        &mut self,
        steps: Option<Steps<'_>>,
        targets: &[c64],
        points: &mut [Vec<c64>],
        watch: &mut Watch,
    ) -> Result<(), KktError> {
        let Self { problem, factor, bent, rows, targets: own } = self;
        watch.lap(Phase::Solve, || {
            own[..targets.len()].copy_from_slice(targets);
            if let Some(steps) = steps {
                for_each(points, |path, points| walk(steps, path, points));
            }
            for (deviation, row) in own.iter_mut().zip(rows.iter()) {
                *deviation -= row.terms.iter().map(|(path, j, c)| c * points[*path][*j]).sum::<c64>();
            }
            bent.solve(problem, factor, own)
        })?;
        watch.lap(Phase::Expand, || match steps {
            None => for_each(points, |path, points| bent.expand(problem, path, |j, x, _| points[j] = x)),
            Some(_) => for_each(points, |path, points| bent.expand(problem, path, |j, x, _| points[j] += x)),
        });
        Ok(())
    }
}

/// Springs of a path; none give way inside its stands.
fn spring_path(workload: &Workload, path: usize, part: Part) -> SpringPath {
    let rest = &workload.paths[path];
    let mut springs =
        if part == Part::Shape { SpringPath::of_shape(rest.clone()) } else { SpringPath::even(rest.len()) };
    for (_, first, last) in workload.stands_of(path) {
        match &mut springs {
            SpringPath::Listed { compliances, .. } => compliances[first + 1..*last].fill(0.0),
            SpringPath::Even { stretches, .. } => stretches.extend([(first + 1, 0.0), (*last, 1.0)]),
        }
    }
    springs
}

/// Rows that add nothing to the first step of a stand: its springs keep the others like it.
fn first_steps(workload: &Workload) -> Vec<PointRow<c64>> {
    let one = c64::new(1.0, 0.0);
    let row = |&(path, first, _): &(usize, usize, usize)| {
        PointRow::hard(vec![(path, first + 1, one), (path, first, -one)])
    };
    workload.stands.iter().map(row).collect()
}

/// The path of these steps from 0.
fn walk(steps: Steps<'_>, path: usize, points: &mut [c64]) {
    let (first, others) = points.split_first_mut().expect("a path has points");
    *first = c64::default();
    steps.write(path, others);
    let mut at = *first;
    for point in others {
        at += *point;
        *point = at;
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
