//! The chain back end: every path condensed to its constrained points by reflections, times to springs in series.

use cotillion_solvers as solvers;
use cotillion_solvers::workload::{STEP, Workload};
use cotillion_solvers::{
    ChainRow, ChainSystem, ChainWorkspace, Factor, KktError, KktForm, Knots, RowTargets, Track, Workspace,
    analyse, c64, shape_rows,
};

use super::measure::{Part, Phase, Solver, Watch};
use super::stands::StandRows;

/// Shape or scale system over the constrained points.
pub(super) struct Chain {
    system: ChainSystem,
    factor: Factor<c64>,
    workspace: ChainWorkspace,
    /// Targets of the second differences.
    bends: Vec<Vec<c64>>,
    stands: StandRows,
    /// Targets of the rows of the workload, then of the stands.
    targets: Vec<c64>,
}

impl Solver for Chain {
    type Point = c64;

    fn prepare(workload: &Workload, part: Part, watch: &mut Watch) -> Result<Self, KktError> {
        let targets = if part == Part::Shape { RowTargets::Zero } else { RowTargets::PerSolve };
        let stands = StandRows::new(workload, part);
        let system = watch.lap(Phase::Assemble, || {
            let rows: Vec<Vec<ChainRow>> = workload.paths.iter().map(|path| path_rows(path, part)).collect();
            let point_rows = [workload.rows.as_slice(), &stands.rows].concat();
            ChainSystem::new(&rows, &point_rows, targets)
        })?;
        let analysis = watch.lap(Phase::Analyse, || analyse(system.problem(), KktForm::Hachtel))?;
        let factor = watch.lap(Phase::Factor, || analysis.factor(system.problem()))?;
        let workspace = system.workspace(&factor);
        let bends = match targets {
            RowTargets::Zero => Vec::new(),
            RowTargets::PerSolve => {
                workload.paths.iter().map(|path| vec![c64::default(); path.len() - 2]).collect()
            }
        };
        Ok(Self { system, factor, workspace, bends, stands, targets: Vec::new() })
    }

    fn solve_into(
        &mut self,
        steps: &[Vec<c64>],
        targets: &[c64],
        points: &mut [Vec<c64>],
        watch: &mut Watch,
    ) -> Result<(), KktError> {
        watch.lap(Phase::Solve, || {
            for (bends, steps) in self.bends.iter_mut().zip(steps) {
                let differences = steps.windows(2).map(|pair| pair[1] - pair[0]);
                bends.iter_mut().zip(differences).for_each(|(bend, difference)| *bend = difference);
            }
            self.targets.clear();
            self.targets.extend_from_slice(targets);
            self.stands.visit_targets(steps, |target| self.targets.push(target));
            self.system.solve_into(&self.factor, &self.targets, &self.bends, &mut self.workspace)
        })?;
        watch.lap(Phase::Expand, || self.system.expand(&self.workspace, points))
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
        let factor = watch.lap(Phase::Factor, || analysis.factor(&network.problem))?;
        let workspace = factor.workspace();
        let (m, h) = network.targets();
        let delays = vec![0.0; network.problem.columns];
        Ok(Self { network, factor, workspace, m, h, delays })
    }

    fn solve_into(
        &mut self,
        _: &[Vec<c64>],
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
