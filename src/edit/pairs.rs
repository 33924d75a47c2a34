//! Systems of all frames as they were published: coordinates of all frames as real unknowns, what is rigid held by rows with
//! multipliers, normal equations. To compare with; everything else solves the same in complex numbers.
//!
//! Source: Kim et al. 2009, eqs. 5 and 6 (systems) and §4.2 (stationary stretches).

use cotillion_solvers::{CsMat, Factor, KktError, KktForm, LeastSquares, RowMatrix, Workspace, analyse};

use crate::geometry::c64;

/// A factored system of pairs of real unknowns.
pub struct Pairs {
    factor: Factor<f64>,
    workspace: Workspace<f64>,
    soft_targets: Vec<f64>,
    hard_targets: Vec<f64>,
    x: Vec<f64>,
}

impl Pairs {
    /// Plans and factors the normal equations of a problem.
    ///
    /// # Errors
    /// What the solver says of a matrix it cannot factor.
    pub fn new(problem: &LeastSquares<c64>) -> Result<Self, KktError> {
        let columns = 2 * problem.columns;
        let real = |rows| pairs_of(rows, columns).to_csr();
        let problem = LeastSquares { columns, soft: real(&problem.soft), hard: real(&problem.hard) };
        let factor = analyse(&problem, KktForm::NormalEquations)?.factor(&problem)?;
        let workspace = factor.workspace();
        let (soft_targets, hard_targets) = (vec![0.0; problem.soft.rows()], vec![0.0; problem.hard.rows()]);
        Ok(Self { factor, workspace, soft_targets, hard_targets, x: vec![0.0; columns] })
    }

    /// Solves for targets of the soft and the hard rows.
    ///
    /// # Errors
    /// What the solver says.
    pub fn solve_into(&mut self, (m, h): (&[c64], &[c64]), x: &mut [c64]) -> Result<(), KktError> {
        split(m, &mut self.soft_targets);
        split(h, &mut self.hard_targets);
        let Self { factor, workspace, soft_targets, hard_targets, x: numbers } = self;
        factor.solve_into(soft_targets, hard_targets, numbers, workspace)?;
        x.iter_mut().zip(numbers.chunks_exact(2)).for_each(|(x, pair)| *x = c64::new(pair[0], pair[1]));
        Ok(())
    }
}

fn split(points: &[c64], numbers: &mut [f64]) {
    for (pair, point) in numbers.chunks_exact_mut(2).zip(points) {
        (pair[0], pair[1]) = (point.re, point.im);
    }
}

/// Two rows of real numbers for each complex one.
fn pairs_of(rows: &CsMat<c64>, columns: usize) -> RowMatrix<f64> {
    let mut pairs = RowMatrix::new(columns);
    for row in rows.outer_iterator() {
        let real: Vec<_> = row.iter().flat_map(|(j, a)| [(2 * j, a.re), (2 * j + 1, -a.im)]).collect();
        let imaginary: Vec<_> = row.iter().flat_map(|(j, a)| [(2 * j, a.im), (2 * j + 1, a.re)]).collect();
        pairs.push_row(&real);
        pairs.push_row(&imaginary);
    }
    pairs
}
