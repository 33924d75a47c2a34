//! The chain back end: every path condensed to its constrained points by reflections, times to springs in series.

use cotillion_solvers as solvers;
use cotillion_solvers::workload::{STEP, Workload};
use cotillion_solvers::{
    ChainRow, ChainSystem, ChainWorkspace, Factor, KktError, KktForm, Knots, RowTargets, Track, Workspace,
    analyse, c64, shape_rows,
};
use rayon::prelude::*;

use super::measure::{MANY_SAMPLES, Part, Phase, Solver, Steps, Watch, map_paths};

/// Shape or scale system over the constrained points.
pub(super) struct Chain {
    system: ChainSystem,
    factor: Factor<c64>,
    workspace: ChainWorkspace,
    /// Targets of the second differences.
    bends: Vec<Vec<c64>>,
    /// Targets of the rows of the stands, then of those of the workload.
    targets: Vec<c64>,
}

impl Solver for Chain {
    type Point = c64;

    fn prepare(workload: &Workload, part: Part, watch: &mut Watch) -> Result<Self, KktError> {
        let targets = if part == Part::Shape { RowTargets::Zero } else { RowTargets::PerSolve };
        let (system, rows) = watch.lap(Phase::Assemble, || {
            let rows = map_paths(workload, |path| path_rows(&workload.paths[path], part));
            let point_rows = [part.stand_rows(workload), workload.rows.clone()].concat();
            Ok((ChainSystem::new(&rows, &point_rows, targets)?, point_rows.len()))
        })?;
        let analysis = watch.lap(Phase::Analyse, || analyse(system.problem(), KktForm::Hachtel))?;
        let (factor, workspace) = watch.lap(Phase::Factor, || {
            let factor = analysis.factor(system.problem())?;
            let workspace = system.workspace(&factor);
            Ok((factor, workspace))
        })?;
        let bends = match targets {
            RowTargets::Zero => Vec::new(),
            RowTargets::PerSolve => {
                workload.paths.iter().map(|path| vec![c64::default(); path.len() - 2]).collect()
            }
        };
        Ok(Self { system, factor, workspace, bends, targets: vec![c64::default(); rows] })
    }

    fn solve_into(
        &mut self,
        steps: Option<Steps<'_>>,
        targets: &[c64],
        points: &mut [Vec<c64>],
        watch: &mut Watch,
    ) -> Result<(), KktError> {
        watch.lap(Phase::Solve, || {
            let stands = self.targets.len() - targets.len();
            let (stands, own) = self.targets.split_at_mut(stands);
            own.copy_from_slice(targets);
            if let Some(steps) = steps {
                write_bends(steps, &mut self.bends);
                write_stands(steps, stands);
            }
            self.system.solve_into(&self.factor, &self.targets, &self.bends, &mut self.workspace)
        })?;
        watch.lap(Phase::Expand, || self.system.expand(&self.workspace, points))
    }
}

/// Second differences of the steps of all paths.
fn write_bends(steps: Steps<'_>, bends: &mut [Vec<c64>]) {
    let write = |own: &mut Vec<c64>, (path, bends): (usize, &mut Vec<c64>)| {
        own.resize(bends.len() + 1, c64::default());
        steps.write(path, own);
        bends.iter_mut().zip(own.windows(2)).for_each(|(bend, pair)| *bend = pair[1] - pair[0]);
    };
    if bends.iter().map(Vec::len).sum::<usize>() > MANY_SAMPLES {
        bends.par_iter_mut().enumerate().with_min_len(16).for_each_init(Vec::new, write);
    } else {
        let mut own = Vec::new();
        bends.iter_mut().enumerate().for_each(|bends| write(&mut own, bends));
    }
}

/// Steps of the stands.
fn write_stands(steps: Steps<'_>, targets: &mut [c64]) {
    let mut targets = targets.iter_mut();
    let mut own = Vec::new();
    for (path, rest) in steps.workload.paths.iter().enumerate() {
        let stands = steps.workload.stands_of(path);
        if !stands.is_empty() {
            own.resize(rest.len() - 1, c64::default());
            steps.write(path, &mut own);
        }
        let of_stands = stands.iter().flat_map(|(_, first, last)| &own[*first..*last]);
        of_stands.zip(&mut targets).for_each(|(step, target)| *target = *step);
    }
}

fn path_rows(rest: &[c64], part: Part) -> Vec<ChainRow> {
    if part == Part::Shape {
        return shape_rows(rest);
    }
    let one = c64::new(1.0, 0.0);
    vec![[one, one * -2.0, one]; rest.len() - 2]
}

/// Time system over the constrained points.
pub(super) struct Network {
    network: solvers::Network,
    factor: Factor<f64>,
    workspace: Workspace<f64>,
    m: Vec<f64>,
    h: Vec<f64>,
    delays: Vec<f64>,
}

impl Solver for Network {
    type Point = f64;

    fn prepare(workload: &Workload, _: Part, watch: &mut Watch) -> Result<Self, KktError> {
        let network = watch.lap(Phase::Assemble, || {
            let track = |path: &Vec<c64>| Track { points: path.len(), tail: 0.0 };
            let tracks: Vec<Track> = workload.paths.iter().map(track).collect();
            solvers::Network::new(&tracks, STEP, &workload.time_rows, Knots::Touched)
        })?;
        let analysis = watch.lap(Phase::Analyse, || analyse(&network.problem, KktForm::Hachtel))?;
        let (factor, workspace) = watch.lap(Phase::Factor, || {
            let factor = analysis.factor(&network.problem)?;
            let workspace = factor.workspace();
            Ok((factor, workspace))
        })?;
        let (m, h) = network.targets();
        let delays = vec![0.0; network.problem.columns];
        Ok(Self { network, factor, workspace, m, h, delays })
    }

    fn solve_into(
        &mut self,
        _: Option<Steps<'_>>,
        targets: &[f64],
        times: &mut [Vec<f64>],
        watch: &mut Watch,
    ) -> Result<(), KktError> {
        watch.lap(Phase::Solve, || {
            self.network.write_targets(targets, &mut self.m, &mut self.h);
            self.factor.solve_into(&self.m, &self.h, &mut self.delays, &mut self.workspace)
        })?;
        watch.lap(Phase::Expand, || self.network.expand(&self.delays, times));
        Ok(())
    }
}
