//! One path of a factored problem exchanged for another: the factorisation stays, a small update makes good the difference.
//!
//! The other path changes the entries of its own rows and of its similarities, on a border P of a few unknowns. With `G` the
//! inverse on the border, `Δ` the change of its entries, and x₀ the solution of the system as factored,
//!
//! ```text
//!     (K + PΔPᴴ) x = b        x = x₀ − K⁻¹P Δ (I + GΔ)⁻¹ Pᴴx₀
//! ```
//!
//! Solutions are refined against the springs of the exchanged path like any other, so that they are as good as those of a
//! factorisation of its own.
//!
//! Source: Hager, *Updating the inverse of a matrix*, SIAM Review 31 (1989).

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Dyn, LU};

use crate::c64;
use crate::compliance::Compliance;
use crate::path_loads::PathLoads;
use crate::pieces::cut_path;
use crate::points::PointRow;
use crate::springs::SpringPath;

/// The update of a factorisation.
#[derive(Clone, Debug)]
pub(crate) struct Exchange {
    /// Unknowns that the path has entries in.
    border: Vec<usize>,
    /// K⁻¹P, real and imaginary: products of real numbers are several times as fast.
    columns: Arc<[DMatrix<f64>; 2]>,
    /// Δ.
    difference: DMatrix<c64>,
    /// I + GΔ.
    system: LU<c64, Dyn, Dyn>,
}

/// A system is singular if its largest pivot is as many times its smallest: something is free, but for rounding. Regular ones
/// stay below 1e11.
const MOST_SPREAD: f64 = 1e13;

impl Exchange {
    /// `None` where the system is singular to rounding. Cost: by the cube of the border.
    pub(crate) fn new(
        border: Vec<usize>,
        columns: Arc<[DMatrix<f64>; 2]>,
        (inverse, difference): (&DMatrix<c64>, DMatrix<c64>),
    ) -> Option<Self> {
        let size = border.len();
        let system = (DMatrix::identity(size, size) + product(inverse, &difference)).lu();
        let pivots = (0..size).map(|k| system.lu_internal()[(k, k)].norm());
        let (least, most) = pivots.fold((f64::INFINITY, 0.0_f64), |(a, b), own| (a.min(own), b.max(own)));
        let regular = size == 0 || most < MOST_SPREAD * least; // which NaN is not
        regular.then_some(Self { border, columns, difference, system })
    }

    /// From the solution of the system as factored to that of the exchanged one.
    pub(crate) fn correct(&self, x: &mut [c64]) {
        let mut own = DVector::from_iterator(self.border.len(), self.border.iter().map(|index| x[*index]));
        // A pivot that is 0 would have been found when it was factored.
        self.system.solve_mut(&mut own);
        let forces = &self.difference * own;
        let [real, imaginary] = &*self.columns;
        let (forces_re, forces_im) = (forces.map(|force| force.re), forces.map(|force| force.im));
        let mut moved_re = real * &forces_re;
        moved_re.gemv(-1.0, imaginary, &forces_im, 1.0);
        let mut moved_im = real * &forces_im;
        moved_im.gemv(1.0, imaginary, &forces_re, 1.0);
        for (x, (re, im)) in x.iter_mut().zip(moved_re.iter().zip(moved_im.iter())) {
            *x -= c64::new(*re, *im);
        }
    }
}

/// `A B` by products of real matrices, which are several times as fast as those of complex ones.
fn product(a: &DMatrix<c64>, b: &DMatrix<c64>) -> DMatrix<c64> {
    let parts = |matrix: &DMatrix<c64>| (matrix.map(|value| value.re), matrix.map(|value| value.im));
    let ((a_re, a_im), (b_re, b_im)) = (parts(a), parts(b));
    let (real, imaginary) = (&a_re * &b_re - &a_im * &b_im, &a_re * &b_im + &a_im * &b_re);
    real.zip_map(&imaginary, c64::new)
}

impl Compliance {
    /// The problem with other springs for `path` and other terms and targets of the rows on it: `rows` are those given, all
    /// others as they are. It is solved with [`PathResponse::factor`](crate::PathResponse::factor), and cannot be factored by
    /// itself. `None` where it has other unknowns, or motions are free. Cost: by the points and rows of the path.
    pub fn with_path(&self, path: usize, springs: SpringPath, rows: Vec<PointRow<c64>>) -> Option<Self> {
        if !self.free.is_empty() || rows.len() != self.given {
            return None;
        }
        let own = self.first_pieces[path]..self.first_pieces[path + 1];
        let first_joint = self.given + 2 * (own.start - path);
        let mut terms = Vec::new();
        for (index, row) in rows.iter().enumerate() {
            let own = row.terms.iter().filter(|term| term.0 == path);
            terms.extend(own.map(|(_, point, value)| (index, *point, *value)));
        }
        let (pieces, joints) = cut_path((path, &springs), terms, first_joint);
        if pieces.len() != own.len() {
            return None;
        }
        let mut loads = self.loads.clone();
        for (piece, index) in pieces.iter().zip(own) {
            let known = PathLoads::new(&springs, piece.own.clone(), &piece.terms);
            let motions = self.layout.similarities[index + 1] - self.layout.similarities[index];
            if known.motions() != motions || !known.is_finite() {
                return None;
            }
            loads[index] = Arc::new(known);
        }
        let mut all = rows;
        all.extend_from_slice(&self.rows[self.given..]);
        all[first_joint..first_joint + joints.len()].clone_from_slice(&joints);
        let mut paths = self.paths.clone();
        paths[path] = Arc::new(springs);
        Some(self.like(paths, all, loads))
    }
}
