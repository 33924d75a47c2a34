//! Our own solvers, as this benchmark calls them: from rest paths to edited paths, everything included.

use crate::problem::{shape_problem, split_targets};
use cotillion_solvers::workload::Workload;
use cotillion_solvers::{Factor, KktError, KktForm, Workspace, analyse, c64};

/// Ways of ours to solve a workload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// All samples as unknowns, Hachtel form, complex sparse LU with refinement.
    Hachtel,
    /// All samples as unknowns, normal equations, complex sparse LU with refinement.
    NormalEquations,
}

/// What is measured; ratios are to the first.
pub const ROUTES: [Route; 2] = [Route::Hachtel, Route::NormalEquations];

impl Route {
    /// For tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hachtel => "ours: full, Hachtel form",
            Self::NormalEquations => "ours: full, normal equations",
        }
    }

    fn form(self) -> KktForm {
        match self {
            Self::Hachtel => KktForm::Hachtel,
            Self::NormalEquations => KktForm::NormalEquations,
        }
    }
}

/// Edited paths, with nothing known beforehand.
///
/// # Errors
/// Those of the solver.
pub fn cold(route: Route, workload: &Workload) -> Result<Vec<Vec<c64>>, KktError> {
    let mut drag = Drag::new(route, workload)?;
    drag.step(workload, &workload.targets)?;
    Ok(drag.paths)
}

/// What is kept while a handle is dragged.
pub struct Drag {
    factor: Factor<c64>,
    workspace: Workspace<c64>,
    x: Vec<c64>,
    paths: Vec<Vec<c64>>,
}

impl Drag {
    /// All that does not depend on targets.
    ///
    /// # Errors
    /// Those of the solver.
    pub fn new(route: Route, workload: &Workload) -> Result<Self, KktError> {
        let problem = shape_problem(workload);
        let factor = analyse(&problem, route.form())?.factor(&problem)?;
        let workspace = factor.workspace();
        let x = vec![c64::default(); problem.columns];
        Ok(Self { factor, workspace, x, paths: workload.paths.clone() })
    }

    /// Edited paths for other targets, one for each of the workload's rows.
    ///
    /// # Errors
    /// Those of the solver.
    pub fn step(&mut self, workload: &Workload, targets: &[c64]) -> Result<&[Vec<c64>], KktError> {
        let (m, h) = split_targets(workload, targets);
        self.factor.solve_into(&m, &h, &mut self.x, &mut self.workspace)?;
        let mut rest = self.x.as_slice();
        for path in &mut self.paths {
            let (own, others) = rest.split_at(path.len());
            path.copy_from_slice(own);
            rest = others;
        }
        Ok(&self.paths)
    }
}
