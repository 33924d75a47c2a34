//! One phase of one component: factored once, solved for many targets.
//!
//! Unknown are deviations from a reference path that satisfies all interior rows, so that only held rows have targets: what
//! they miss on the reference.

use std::ops::Range;

use cotillion_solvers::{
    Bent, Dependency, Drawing, Effort, KktError, Likeness, PathResponse, PointRow, RowMatrix, analyse_rank,
};

use crate::edit::bound_rows::BoundRows;
use crate::edit::columns::{Columns, Freedom};
use crate::edit::direct::{DirectPhase, FrameProblem};
use crate::edit::hold::{Prepared, Term};
use crate::edit::own_path::OwnPath;
use crate::edit::reduced::ReducedPhase;
use crate::edit::settings::{Backend, SpatialSettings};
use crate::geometry::c64;

/// Dependent hard rows agree if they miss by no more than this, relative to the larger of 1 m and their targets.
const AGREEMENT: f64 = 1e-9;

/// One phase with the storage of its solves.
pub struct PhaseSolver {
    /// Held rows that bind in this phase.
    rows: BoundRows,
    /// Positions in `rows` of the hard ones.
    hard: Vec<usize>,
    /// Combinations of hard rows, by position in `hard`, that vanish.
    dependent: Vec<Dependency<c64>>,
    /// Positions in `rows` of what the system holds: all but redundant ones; and the rows themselves once the direct system is
    /// made.
    kept: Vec<usize>,
    kept_rows: Vec<PointRow<c64>>,
    /// Targets of `rows`, of the hard ones, and of `kept`.
    deviations: Vec<c64>,
    hard_deviations: Vec<c64>,
    kept_deviations: Vec<c64>,
    reduced: Option<ReducedPhase>,
    /// The last solution of the reduced system, or memory for the first.
    pub bent: Option<Bent>,
    /// In place of the reduced system where that cannot express the paths or cannot be solved; made when first needed.
    direct: Option<Box<DirectPhase>>,
    /// What was asked for.
    backend: Backend,
    /// Which of them the present solution is of.
    answer: Backend,
}

impl PhaseSolver {
    /// Finds the redundant hard rows and assembles the others.
    pub fn new(freedom: Freedom, held: &[Prepared], settings: &SpatialSettings, backend: Backend) -> Self {
        let rows = BoundRows::new(freedom, held, settings);
        let hard: Vec<usize> = (0..rows.len()).filter(|row| rows.weight(*row).is_none()).collect();
        let terms = |row: &usize| rows.terms(*row);
        let columns = Columns::touched(freedom, hard.iter().map(terms));
        let mut matrix = RowMatrix::new(columns.count);
        hard.iter().for_each(|row| {
            matrix.push_row(&columns.row(terms(row)));
        });
        let dependent = analyse_rank(&matrix.to_csr()).dependent;
        let redundant: Vec<usize> = dependent.iter().map(|dependency| hard[dependency.row]).collect();
        let kept: Vec<usize> = (0..rows.len()).filter(|row| redundant.binary_search(row).is_err()).collect();
        let kept_rows: Vec<PointRow<c64>> = kept.iter().map(|row| rows.point_row(*row)).collect();
        let reduced = match backend {
            Backend::Reduced => ReducedPhase::new(freedom, kept_rows, settings),
            Backend::Direct | Backend::Published => None,
        };
        Self {
            answer: if reduced.is_some() { Backend::Reduced } else { Backend::Direct },
            backend,
            reduced,
            bent: None,
            direct: None,
            deviations: vec![c64::default(); rows.len()],
            hard_deviations: vec![c64::default(); hard.len()],
            kept_deviations: vec![c64::default(); kept.len()],
            rows,
            hard,
            dependent,
            kept,
            kept_rows: Vec::new(),
        }
    }

    /// Of no rows: room for one that may not be needed.
    pub fn none() -> Self {
        Self {
            rows: BoundRows::default(),
            hard: Vec::new(),
            dependent: Vec::new(),
            kept: Vec::new(),
            kept_rows: Vec::new(),
            deviations: Vec::new(),
            hard_deviations: Vec::new(),
            kept_deviations: Vec::new(),
            reduced: None,
            bent: None,
            direct: None,
            backend: Backend::Reduced,
            answer: Backend::Direct,
        }
    }

    /// Factors the system unless that is done: the direct one where the reduced one cannot be.
    ///
    /// # Errors
    /// What the solver says of a matrix it cannot factor.
    pub fn factor(&mut self, freedom: Freedom, settings: &SpatialSettings) -> Result<(), KktError> {
        if self.reduced.as_mut().is_some_and(|reduced| reduced.factor().is_err()) {
            self.reduced = None;
        }
        if self.reduced.is_some() { Ok(()) } else { self.direct(freedom, settings).factor() }
    }

    fn direct(&mut self, freedom: Freedom, settings: &SpatialSettings) -> &mut DirectPhase {
        let Self { direct, kept_rows, kept, rows, backend, .. } = self;
        direct.get_or_insert_with(|| {
            *kept_rows = kept.iter().map(|row| rows.point_row(*row)).collect();
            Box::new(DirectPhase::new(freedom, kept_rows, settings, *backend))
        })
    }

    /// Takes over what the system before knows of the pattern, if only coefficients have changed since.
    pub fn adopt(&mut self, before: &Self) {
        if let (Some(own), Some(before)) = (&mut self.reduced, &before.reduced) {
            own.adopt(before);
        }
    }

    /// Sets what held rows miss on the reference: `value` of each held row, `reference` of each path and frame.
    pub fn set_targets(&mut self, value: impl Fn(usize) -> c64, reference: impl Fn(usize, usize) -> c64) {
        let rows = self.rows.held.iter().zip(self.rows.iter());
        for (deviation, (held, (terms, _))) in self.deviations.iter_mut().zip(rows) {
            let on_reference = |(path, frame, c): &Term| c * reference(*path, *frame);
            *deviation = value(*held) - terms.iter().map(on_reference).sum::<c64>();
        }
        for (deviation, row) in self.hard_deviations.iter_mut().zip(&self.hard) {
            *deviation = self.deviations[*row];
        }
        for (deviation, row) in self.kept_deviations.iter_mut().zip(&self.kept) {
            *deviation = self.deviations[*row];
        }
    }

    /// Held rows of the first dependent hard row that contradicts the others, and by how much.
    pub fn contradiction(&self) -> Option<(Vec<usize>, f64)> {
        self.dependent.iter().find_map(|dependency| {
            let miss = dependency.mismatch(&self.hard_deviations);
            let share = |(row, y): &(usize, c64)| (y * self.hard_deviations[*row]).norm();
            let size = dependency.combination.iter().map(share).fold(1.0, f64::max);
            let held = |row: usize| self.rows.held[self.hard[row]];
            (miss > AGREEMENT * size)
                .then(|| (dependency.certificate().into_iter().map(held).collect(), miss))
        })
    }

    /// Held rows that other hard rows imply.
    pub fn redundant(&self) -> impl Iterator<Item = usize> {
        self.dependent.iter().map(|dependency| self.rows.held[self.hard[dependency.row]])
    }

    /// Solves for the present targets: reduced; where its rows depend on each other too nearly for that, all frames. The
    /// answer depends on the present targets alone.
    ///
    /// # Errors
    /// What the solver says.
    pub fn solve(&mut self, freedom: Freedom, settings: &SpatialSettings) -> Result<(), KktError> {
        self.factor(freedom, settings)?;
        self.answer = Backend::Direct;
        let Self { reduced, bent, kept_deviations, .. } = self;
        if reduced.as_mut().is_some_and(|reduced| reduced.solve(kept_deviations, bent)) {
            self.answer = Backend::Reduced;
            return Ok(());
        }
        self.direct(freedom, settings);
        let Some(direct) = &mut self.direct else { return Ok(()) };
        direct.solve(&self.kept_rows, &self.kept_deviations)
    }

    /// The reduced system and its solution, where that is the present one.
    fn told(&self) -> Option<(&ReducedPhase, &Bent)> {
        self.reduced.as_ref().filter(|_| self.answer == Backend::Reduced).zip(self.bent.as_ref())
    }

    /// Fills in the points of a path: reference plus deviation.
    pub fn points(&self, path: usize, reference: impl Fn(usize) -> c64, points: &mut [c64]) {
        let fill = |frame: usize, deviation: c64| points[frame] = reference(frame) + deviation;
        match (self.told(), &self.direct) {
            (Some((reduced, bent)), _) => reduced.visit(bent, path, fill),
            (_, Some(direct)) => direct.visit(path, fill),
            _ => {}
        }
    }

    /// Draws a path of deviations as springs give it; `false` where another system answered.
    pub fn draw(&self, path: usize, drawing: &mut impl Drawing) -> bool {
        self.told().map(|(reduced, bent)| reduced.draw(bent, path, drawing)).is_some()
    }

    /// Compares a path of deviations with that of another solution of the same springs: ranges of frames, and how far the segments
    /// after them are apart; `false` where springs do not tell.
    pub fn compare(&self, other: &Self, path: usize, visit: impl FnMut(Range<usize>, Likeness)) -> bool {
        let (Some((reduced, bent)), Some(other)) = (self.told(), other.told()) else { return false };
        reduced.compare(bent, other, path, visit)
    }

    /// By how much the energy may be less, at most, where the points of path p that targets were measured by are off by `by(p)`, m.
    pub fn work(&self, by: impl Fn(usize) -> f64) -> f64 {
        self.told().map_or(0.0, |(reduced, bent)| reduced.work(bent, self.kept.len(), by))
    }

    /// Energies of the interior rows and of the soft held rows.
    pub fn energies(&self) -> (f64, f64) {
        match (self.told(), &self.direct) {
            (Some((reduced, bent)), _) => reduced.energies(bent),
            (_, Some(direct)) => direct.energies(),
            _ => (0.0, 0.0),
        }
    }

    /// The problem of all frames as last solved, where that is what is solved ([`Backend::Direct`]).
    pub fn frame_problem(&self) -> Option<FrameProblem<'_>> {
        self.direct.as_ref().filter(|_| self.answer != Backend::Reduced).map(|direct| direct.frame_problem())
    }

    /// How path `path` answers to changes of itself; `None` where there is no reduced system, or motions are free.
    pub fn response(&self, path: usize) -> Option<PathResponse> {
        self.reduced.as_ref()?.response(path)
    }

    /// The same with another path `path`, that of `freedom`, which is `own`, and the rows `held` in place of the present ones, which come
    /// second, factored by an update; `None` where more would change than that path. `response`: of the path in this system. `before`: the same in an earlier system, whose
    /// work is taken over where it is the same.
    pub fn exchanged(
        &self,
        (path, freedom, own): (usize, Freedom, &OwnPath),
        held: (&[Prepared], &[Prepared]),
        settings: &SpatialSettings,
        (response, before): (&PathResponse, Option<&Self>),
    ) -> Option<Self> {
        let reduced = self.reduced.as_ref().filter(|_| self.dependent.is_empty())?;
        let rows = self.rows.with_path((path, freedom), held, settings)?;
        let (springs, before) =
            (own.springs(freedom.phase, settings)?, before.and_then(|before| before.reduced.as_ref()));
        let reduced = reduced.exchanged((path, freedom), springs, &rows, (response, before))?;
        Some(Self {
            rows,
            hard: self.hard.clone(),
            dependent: Vec::new(),
            kept: self.kept.clone(),
            kept_rows: Vec::new(),
            deviations: self.deviations.clone(),
            hard_deviations: self.hard_deviations.clone(),
            kept_deviations: self.kept_deviations.clone(),
            reduced: Some(reduced),
            bent: None,
            direct: None,
            backend: Backend::Reduced,
            answer: Backend::Reduced,
        })
    }

    /// How far reduced solves go from now on.
    pub fn set_effort(&mut self, effort: Effort) {
        self.reduced.iter_mut().for_each(|reduced| reduced.effort = effort);
    }

    /// Number of free motions that are fixed as at rest.
    pub fn gauges(&self) -> usize {
        let direct = || self.direct.as_ref().map_or(0, |direct| direct.gauges);
        self.reduced.as_ref().map_or_else(direct, ReducedPhase::gauges)
    }
}
