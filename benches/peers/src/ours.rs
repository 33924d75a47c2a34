//! Our own solvers, as this benchmark calls them: from rest paths to edited paths, everything included.

use crate::problem::{shape_problem, split_targets};
use cotillion_solvers::workload::Workload;
use cotillion_solvers::{
    Bent, ChainRow, ChainSystem, ChainWorkspace, Compliance, ComplianceFactor, Factor, KktError, KktForm,
    RowTargets, SpringPath, Workspace, analyse, c64, shape_rows,
};

/// Ways of ours to solve a workload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// Paths as springs, rows as unknowns: what the program uses.
    Compliance,
    /// Paths condensed by reflections to constrained samples.
    Chain,
    /// All samples as unknowns, Hachtel form, complex sparse LU with refinement.
    Hachtel,
    /// All samples as unknowns, normal equations, complex sparse LU with refinement.
    NormalEquations,
}

/// What is measured; ratios are to the first.
pub const ROUTES: [Route; 4] = [Route::Compliance, Route::Chain, Route::Hachtel, Route::NormalEquations];

impl Route {
    /// For tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Compliance => "ours: compliance",
            Self::Chain => "ours: chain",
            Self::Hachtel => "ours: full, Hachtel form",
            Self::NormalEquations => "ours: full, normal equations",
        }
    }
}

/// Edits paths with nothing known beforehand, and returns them with all that can be kept.
///
/// # Errors
/// Those of the solver.
pub fn cold(route: Route, workload: &Workload) -> Result<Drag, KktError> {
    let mut drag = Drag::new(route, workload)?;
    drag.step(workload, &workload.targets)?;
    Ok(drag)
}

/// What is kept while a handle is dragged.
pub struct Drag {
    solver: Solver,
    /// Edited paths.
    pub paths: Vec<Vec<c64>>,
}

enum Solver {
    Compliance(Box<(Compliance, ComplianceFactor, Bent)>),
    Chain(Box<(ChainSystem, Factor<c64>, ChainWorkspace)>),
    Full(Box<(Factor<c64>, Workspace<c64>, Vec<c64>)>),
}

impl Drag {
    /// All that does not depend on targets.
    ///
    /// # Errors
    /// Those of the solver.
    pub fn new(route: Route, workload: &Workload) -> Result<Self, KktError> {
        let solver = match route {
            Route::Compliance => compliance(workload)?,
            Route::Chain => chain(workload)?,
            Route::Hachtel => full(workload, KktForm::Hachtel)?,
            Route::NormalEquations => full(workload, KktForm::NormalEquations)?,
        };
        Ok(Self { solver, paths: workload.paths.clone() })
    }

    /// Edited paths for other targets, one for each of the workload's rows.
    ///
    /// # Errors
    /// Those of the solver.
    pub fn step(&mut self, workload: &Workload, targets: &[c64]) -> Result<&[Vec<c64>], KktError> {
        match &mut self.solver {
            Solver::Compliance(solver) => {
                let (problem, factor, bent) = &mut **solver;
                bent.solve(problem, factor, targets)?;
                for (path, points) in self.paths.iter_mut().enumerate() {
                    bent.expand(problem, path, |j, x, _| points[j] = x);
                }
            }
            Solver::Chain(solver) => {
                let (system, factor, workspace) = &mut **solver;
                system.solve_into(factor, targets, &[], workspace)?;
                system.expand(workspace, &mut self.paths)?;
            }
            Solver::Full(solver) => {
                let (factor, workspace, x) = &mut **solver;
                let (m, h) = split_targets(workload, targets);
                factor.solve_into(&m, &h, x, workspace)?;
                let mut rest = x.as_slice();
                for path in &mut self.paths {
                    let (own, others) = rest.split_at(path.len());
                    path.copy_from_slice(own);
                    rest = others;
                }
            }
        }
        Ok(&self.paths)
    }
}

fn compliance(workload: &Workload) -> Result<Solver, KktError> {
    let paths = workload.paths.iter().map(|path| SpringPath::of_shape(path.clone())).collect();
    let problem = Compliance::new(paths, workload.rows.clone());
    let factor = problem.analyse()?.factor(&problem)?;
    let bent = Bent::new(&problem, &factor);
    Ok(Solver::Compliance(Box::new((problem, factor, bent))))
}

fn chain(workload: &Workload) -> Result<Solver, KktError> {
    let rows: Vec<Vec<ChainRow>> = workload.paths.iter().map(|path| shape_rows(path)).collect();
    let system = ChainSystem::new(&rows, &workload.rows, RowTargets::Zero)?;
    let factor = analyse(system.problem(), KktForm::Hachtel)?.factor(system.problem())?;
    let workspace = system.workspace(&factor);
    Ok(Solver::Chain(Box::new((system, factor, workspace))))
}

fn full(workload: &Workload, form: KktForm) -> Result<Solver, KktError> {
    let problem = shape_problem(workload);
    let factor = analyse(&problem, form)?.factor(&problem)?;
    let workspace = factor.workspace();
    let x = vec![c64::default(); problem.columns];
    Ok(Solver::Full(Box::new((factor, workspace, x))))
}
