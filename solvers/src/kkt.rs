//! Sparse solution of `min ½‖M x − m‖²` subject to `H x = h`: analyse once, factor once per weights, solve many.
//!
//! [`KktForm::Hachtel`], the default, keeps the residual as an unknown and does not square the condition number of `M`:
//!
//! ```text
//!     | α D²  D M   0    |  | s |     | D m |        r = m − M x = α D s
//!     | MᴴD   0     HᴴE  |  | x |  =  |  0  |        λ = −α E μ
//!     | 0     E H   0    |  | μ |     | E h |
//! ```
//!
//! `D`, `E`: diagonal, powers of two that bring the rows of `M`, `H` to norms between 1 and 2; `α = 2⁻¹⁰`.
//! Powers of two change no digit, so the scaled matrix is the true one. [`KktForm::NormalEquations`] is
//!
//! ```text
//!     | MᴴM  HᴴE |  | x |     | Mᴴm |
//!     | E H  0   |  | μ |  =  | E h |        λ = E μ
//! ```
//!
//! which is smaller, and off by millimetres where the first is exact to rounding, because `MᴴM` is already rounded.
//! Rows with many entries are cut into short ones first.
//!
//! Every factorisation is probed and every solution checked: sparse LU reports success on singular matrices.
//!
//! Sources: Hachtel's augmented matrix, see Duff and Reid, *A comparison of some methods for the solution of sparse
//! overdetermined systems of linear equations*, J. Inst. Maths Applics 17 (1976); Björck, *Numerical Methods for Least
//! Squares Problems* (1996), §2.7.

use crate::augmented::{
    ALPHA, KktForm, Layout, RowPattern, check_length, check_pattern, check_shape, check_target, check_values,
    row_residuals, row_scales, visit_entries,
};
use crate::error::{KktError, Solution, SolveReport};
use crate::least_squares::LeastSquares;
use crate::lu::LuOrder;
use crate::refine::{RefineScratch, RefinedLu, Refinement, largest, relative_to};
use crate::scalar::Scalar;
use crate::sparse::Assembly;
use crate::stretch::stretch;
use sprs::CsMat;
use std::sync::Arc;

/// Solutions whose equations are off by more, relative to the targets, are refused.
const ALLOWED_RESIDUAL: f64 = 1e-9;

/// What depends only on where the matrices have entries. Cheap to clone, to be shared by factorisations.
#[derive(Clone, Debug)]
pub struct Analysis(Arc<Plan>);

#[derive(Debug)]
struct Plan {
    form: KktForm,
    columns: usize,
    soft_pattern: RowPattern,
    hard_pattern: RowPattern,
    layout: Layout,
    hard_rows: Vec<usize>,
    assembly: Assembly,
    order: LuOrder,
}

/// A factored problem, for many targets.
#[derive(Clone, Debug)]
pub struct Factor<T> {
    plan: Arc<Plan>,
    problem: LeastSquares<T>,
    stretched_soft: CsMat<T>,
    soft_scales: Vec<f64>,
    hard_scales: Vec<f64>,
    lu: RefinedLu<T>,
}

/// Memory of solves with one factor; nothing else is allocated.
pub struct Workspace<T> {
    right_hand_side: Vec<T>,
    unknowns: Vec<T>,
    residual: Vec<T>,
    scratch: RefineScratch<T>,
    multipliers: Vec<T>,
}

/// Plans the factorisation of a problem from its pattern: cuts long rows, chooses the order of elimination.
///
/// Cost: linear in the entries of `M` and `H` for the Hachtel form; for the normal equations, in their squares per row.
///
/// # Errors
/// [`KktError::ShapeMismatch`], [`KktError::NotByRows`]; [`KktError::Singular`] if memory runs out.
pub fn analyse<T: Scalar>(problem: &LeastSquares<T>, form: KktForm) -> Result<Analysis, KktError> {
    check_shape(problem)?;
    let stretched = stretch(problem);
    let layout = Layout::new(&stretched, form);
    let (soft, hard) = (stretched.soft.to_csr(), stretched.hard.to_csr());
    let scales = (vec![1.0; soft.rows()], vec![1.0; hard.rows()]);
    let mut positions = Vec::new();
    visit_entries(form, layout, (&soft, &scales.0), (&hard, &scales.1), |position, _| {
        positions.push(position)
    });
    let assembly = Assembly::new(layout.size, &positions);
    let order = LuOrder::new(&assembly.pattern).map_err(|_| KktError::Singular)?;
    Ok(Analysis(Arc::new(Plan {
        form,
        columns: problem.columns,
        soft_pattern: RowPattern::of(&problem.soft),
        hard_pattern: RowPattern::of(&problem.hard),
        layout,
        hard_rows: stretched.hard_rows,
        assembly,
        order,
    })))
}

/// Solves one problem once, in Hachtel form.
///
/// # Errors
/// As [`analyse`], [`Analysis::factor`] and [`Factor::solve_into`].
pub fn solve<T: Scalar>(problem: &LeastSquares<T>, m: &[T], h: &[T]) -> Result<Solution<T>, KktError> {
    analyse(problem, KktForm::default())?.factor(problem)?.solve(m, h)
}

impl Analysis {
    /// Factors a problem that has the pattern of the analysed one. Keeps a copy of its matrices.
    ///
    /// # Errors
    /// [`KktError::PatternChanged`], [`KktError::NotFinite`]; [`KktError::Singular`] if hard rows depend on each other
    /// or some unknown is held by no row.
    pub fn factor<T: Scalar>(&self, problem: &LeastSquares<T>) -> Result<Factor<T>, KktError> {
        let plan = &*self.0;
        check_shape(problem)?;
        check_pattern("M", &plan.soft_pattern, &problem.soft)?;
        check_pattern("H", &plan.hard_pattern, &problem.hard)?;
        check_values("M", &problem.soft)?;
        check_values("H", &problem.hard)?;
        let stretched = stretch(problem);
        let (soft, hard) = (stretched.soft.to_csr(), stretched.hard.to_csr());
        let (soft_scales, hard_scales) = (row_scales(&soft), row_scales(&hard));
        let mut data = Vec::new();
        let blocks = ((&soft, soft_scales.as_slice()), (&hard, hard_scales.as_slice()));
        visit_entries(plan.form, plan.layout, blocks.0, blocks.1, |_, value| data.push(value));
        let values = plan.assembly.values(&data);
        let lu =
            RefinedLu::new(&plan.assembly.pattern, &plan.order, values).map_err(|_| KktError::Singular)?;
        Ok(Factor {
            plan: self.0.clone(),
            problem: problem.clone(),
            stretched_soft: soft,
            soft_scales,
            hard_scales,
            lu,
        })
    }
}

impl<T: Scalar> Factor<T> {
    /// Memory for [`solve_into`](Self::solve_into), for this factor and others of the same analysis.
    pub fn workspace(&self) -> Workspace<T> {
        let size = self.plan.layout.size;
        Workspace {
            right_hand_side: vec![T::zero(); size],
            unknowns: vec![T::zero(); size],
            residual: vec![T::zero(); size],
            scratch: self.lu.scratch(size),
            multipliers: vec![T::zero(); self.problem.hard.rows()],
        }
    }

    /// Solves for one pair of targets. `m`: one number per soft row, `h`: one per hard row, `x`: one per column,
    /// overwritten; its content is undefined after an error.
    ///
    /// # Errors
    /// [`KktError::ShapeMismatch`] and [`KktError::NotFinite`] for the targets; [`KktError::SolutionNotFinite`] and
    /// [`KktError::Residual`] if no solution came out.
    pub fn solve_into(
        &self,
        m: &[T],
        h: &[T],
        x: &mut [T],
        workspace: &mut Workspace<T>,
    ) -> Result<SolveReport, KktError> {
        check_target("m", self.problem.soft.rows(), m)?;
        check_target("h", self.problem.hard.rows(), h)?;
        check_length("x", self.plan.columns, x.len())?;
        let scale = self.fill_right_hand_side(m, h, &mut workspace.right_hand_side);
        let Layout { unknowns, .. } = self.plan.layout;
        let Workspace { right_hand_side, unknowns: u, scratch, .. } = workspace;
        let watched = unknowns..unknowns + self.plan.columns;
        let pattern = &self.plan.assembly.pattern;
        let refinement = self.lu.solve(pattern, (right_hand_side, u), watched.clone(), scratch);
        let relative_residual = self.check_solution(scale, workspace)?;
        x.copy_from_slice(&workspace.unknowns[watched]);
        self.read_multipliers(workspace);
        Ok(self.report((m, h), x, workspace, (refinement, relative_residual)))
    }

    /// [`solve_into`](Self::solve_into) with memory of its own.
    ///
    /// # Errors
    /// As [`solve_into`](Self::solve_into).
    pub fn solve(&self, m: &[T], h: &[T]) -> Result<Solution<T>, KktError> {
        let mut workspace = self.workspace();
        let mut x = vec![T::zero(); self.plan.columns];
        let report = self.solve_into(m, h, &mut x, &mut workspace)?;
        Ok(Solution { x, multipliers: workspace.multipliers, report })
    }

    /// Writes the right-hand side and returns its scale: the largest scaled target.
    fn fill_right_hand_side(&self, m: &[T], h: &[T], out: &mut [T]) -> f64 {
        let Layout { unknowns, multipliers, .. } = self.plan.layout;
        out.fill(T::zero());
        let mut scale = 0.0_f64;
        for (i, (&m_i, &d)) in m.iter().zip(&self.soft_scales).enumerate() {
            scale = scale.max(m_i.modulus() * d);
            if self.plan.form == KktForm::Hachtel {
                out[i] = m_i.scale(d);
            }
        }
        if self.plan.form == KktForm::NormalEquations {
            for (row, &m_i) in self.stretched_soft.outer_iterator().zip(m) {
                row.iter().for_each(|(j, &a)| out[unknowns + j] += a.conjugate() * m_i);
            }
        }
        for (&row, &h_i) in self.plan.hard_rows.iter().zip(h) {
            out[multipliers + row] = h_i.scale(self.hard_scales[row]);
            scale = scale.max(h_i.modulus() * self.hard_scales[row]);
        }
        scale
    }
    /// Relative residual of the scaled system, if it is small enough.
    fn check_solution(&self, scale: f64, workspace: &mut Workspace<T>) -> Result<f64, KktError> {
        let Layout { unknowns, multipliers, .. } = self.plan.layout;
        let Workspace { right_hand_side: b, unknowns: u, residual, .. } = workspace;
        if !u.iter().all(|u_i| u_i.all_finite()) {
            return Err(KktError::SolutionNotFinite);
        }
        self.lu.residual_into(&self.plan.assembly.pattern, (b, u), residual);
        let rows = largest(&residual[..unknowns]).max(largest(&residual[multipliers..]));
        let forces = [&u[..unknowns], &u[multipliers..], &b[unknowns..multipliers]].map(largest);
        let gradient_scale = forces.into_iter().fold(scale, f64::max);
        let gradient = largest(&residual[unknowns..multipliers]);
        let relative = relative_to(rows, scale).max(relative_to(gradient, gradient_scale));
        if relative <= ALLOWED_RESIDUAL {
            Ok(relative)
        } else {
            Err(KktError::Residual { relative, allowed: ALLOWED_RESIDUAL })
        }
    }

    fn read_multipliers(&self, workspace: &mut Workspace<T>) {
        let factor = match self.plan.form {
            KktForm::Hachtel => -ALPHA,
            KktForm::NormalEquations => 1.0,
        };
        let scaled = &workspace.unknowns[self.plan.layout.multipliers..];
        for (lambda, &row) in workspace.multipliers.iter_mut().zip(&self.plan.hard_rows) {
            *lambda = scaled[row].scale(factor * self.hard_scales[row]);
        }
    }

    fn report(
        &self,
        (m, h): (&[T], &[T]),
        x: &[T],
        workspace: &Workspace<T>,
        (refinement, relative_residual): (Refinement, f64),
    ) -> SolveReport {
        let energy = match self.plan.form {
            KktForm::Hachtel => {
                let squares = workspace.unknowns.iter().zip(&self.soft_scales);
                0.5 * squares.map(|(s, d)| s.scale(ALPHA * d).modulus_squared()).sum::<f64>()
            }
            KktForm::NormalEquations => {
                0.5 * row_residuals(&self.problem.soft, x, m).map(|r| r.modulus_squared()).sum::<f64>()
            }
        };
        SolveReport {
            energy,
            hard_residual: row_residuals(&self.problem.hard, x, h).fold(0.0, |a, r| r.modulus().max(a)),
            relative_residual,
            last_correction: refinement.last_correction,
            refinements: refinement.steps,
        }
    }
}

impl<T> Workspace<T> {
    /// `λ` of the last solve, one per hard row: `Mᴴ(m − M x) = Hᴴλ`.
    pub fn multipliers(&self) -> &[T] {
        &self.multipliers
    }
}
