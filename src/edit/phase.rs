//! One phase of one component: factored once, solved for many targets.

use cotillion_solvers::{Dependency, Factor, KktError, KktForm, Workspace, analyse, analyse_rank};

use crate::edit::assemble::{PhaseSystem, Source, TargetRule, assemble};
use crate::edit::hold::{Phase, Prepared, Term};
use crate::edit::settings::SpatialSettings;
use crate::geometry::c64;
use crate::path::RestPath;

/// Dependent hard rows agree if they miss by no more than this, relative to the larger of 1 m and their targets.
const AGREEMENT: f64 = 1e-9;

/// One phase, factored, with the storage of its solves.
pub struct PhaseSolver {
    /// Matrices and target rules.
    pub system: PhaseSystem,
    /// Unknowns of the last solve.
    pub x: Vec<c64>,
    factor: Option<(Factor<c64>, Workspace<c64>)>,
    dependent: Vec<Dependency<c64>>,
    kept: Vec<usize>,
    soft_targets: Vec<c64>,
    all_hard_targets: Vec<c64>,
    hard_targets: Vec<c64>,
}

impl PhaseSolver {
    /// Assembles `phase` and finds the redundant hard rows.
    pub fn new(
        rests: &[RestPath],
        held: &[Prepared],
        phase: Phase,
        settings: &SpatialSettings,
        released: &[(usize, usize)],
    ) -> Self {
        let mut system = assemble(rests, held, phase, settings, released);
        let rank = analyse_rank(&system.hard_rows);
        system.keep_hard_rows(&rank.independent);
        Self {
            factor: None,
            dependent: rank.dependent,
            soft_targets: vec![c64::default(); system.soft.len()],
            all_hard_targets: vec![c64::default(); system.hard.len()],
            hard_targets: vec![c64::default(); rank.independent.len() + system.gauge.len()],
            kept: rank.independent,
            x: vec![c64::default(); system.columns.count],
            system,
        }
    }

    /// Factors the system unless that is done.
    ///
    /// # Errors
    /// What the solver says of a matrix it cannot factor.
    pub fn factor(&mut self) -> Result<(), KktError> {
        if self.factor.is_none() {
            let factor = analyse(&self.system.problem, KktForm::Hachtel)?.factor(&self.system.problem)?;
            let workspace = factor.workspace();
            self.factor = Some((factor, workspace));
        }
        Ok(())
    }

    /// Fills the right-hand sides: `value` of each source, less the constants of its points.
    pub fn set_targets(
        &mut self,
        value: impl Fn(&Source) -> c64,
        constant: impl Fn(usize, usize, usize) -> c64,
    ) {
        let frames = &self.system.columns.frames;
        let evaluate = |rule: &TargetRule| {
            let own = |(path, frame, c): &Term| {
                frames[*path][*frame].run.map_or(c64::default(), |run| c * constant(*path, *frame, run))
            };
            rule.scale * (value(&rule.source) - rule.constants.iter().map(own).sum::<c64>())
        };
        fill(&mut self.soft_targets, &self.system.soft, evaluate);
        fill(&mut self.all_hard_targets, &self.system.hard, evaluate);
        for (target, row) in self.hard_targets.iter_mut().zip(&self.kept) {
            *target = self.all_hard_targets[*row];
        }
        let kept = self.kept.len();
        fill(&mut self.hard_targets[kept..], &self.system.gauge, evaluate);
    }

    /// Held rows of the first dependent hard row that contradicts the others, and by how much.
    pub fn contradiction(&self) -> Option<(Vec<usize>, f64)> {
        self.dependent.iter().find_map(|dependency| {
            let miss = dependency.mismatch(&self.all_hard_targets);
            let size = dependency
                .combination
                .iter()
                .map(|(row, y)| (y * self.all_hard_targets[*row]).norm())
                .fold(1.0, f64::max);
            let rows = dependency.certificate();
            (miss > AGREEMENT * size)
                .then(|| (rows.into_iter().filter_map(|row| self.held_row(row)).collect(), miss))
        })
    }

    /// Held rows that other hard rows imply.
    pub fn redundant(&self) -> impl Iterator<Item = usize> {
        self.dependent.iter().filter_map(|dependency| self.held_row(dependency.row))
    }

    /// Held row that hard row `hard_row` came from.
    fn held_row(&self, hard_row: usize) -> Option<usize> {
        match self.system.hard[hard_row].source {
            Source::Held(index) => Some(index),
            Source::Interior { .. } | Source::Gauge(_) => None,
        }
    }

    /// Solves for the present targets.
    ///
    /// # Errors
    /// What the solver says.
    pub fn solve(&mut self) -> Result<(), KktError> {
        self.factor()?;
        let Some((factor, workspace)) = &mut self.factor else { return Ok(()) };
        factor.solve_into(&self.soft_targets, &self.hard_targets, &mut self.x, workspace).map(|_| ())
    }

    /// Energies of the interior rows and of the soft held rows.
    pub fn energies(&self) -> (f64, f64) {
        let (interior, all) = (self.system.interior, self.system.soft.len());
        let energy = |rows| self.system.problem.energy_of_rows(rows, &self.x, &self.soft_targets);
        (energy(0..interior), energy(interior..all))
    }
}

fn fill(targets: &mut [c64], rules: &[TargetRule], evaluate: impl Fn(&TargetRule) -> c64) {
    for (target, rule) in targets.iter_mut().zip(rules) {
        *target = evaluate(rule);
    }
}
