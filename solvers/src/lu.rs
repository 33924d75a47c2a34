//! Sparse LU factorisation of square matrices. The only file that names faer.
//!
//! Columns are ordered by COLAMD, which bounds the fill for whatever rows the pivoting picks, then factored
//! left-looking, column by column, with partial pivoting. Two other ways were measured on augmented systems of long
//! chains: supernodal panels, three times slower since the chains have no panels worth the name; and minimum degree on
//! `K + Kᵀ`, half as costly to order, but off-diagonal pivots upset it: one row over all unknowns, even cut into
//! pieces, then takes seconds to factor instead of milliseconds. All work is sequential, so that the same matrix gives
//! the same bytes whatever the number of threads.
//!
//! A factorisation of a rank-deficient matrix often succeeds here and yields NaN, infinities or numbers like 1e31:
//! callers must probe what they get ([`refine`](crate::refine)).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::lu::partial_pivoting::inverse::{inverse as write_inverse, inverse_scratch};
use faer::perm::Perm;
use faer::sparse::linalg::colamd;
use faer::sparse::linalg::lu::simplicial::{
    SimplicialLu, factorize_simplicial_numeric_lu, factorize_simplicial_numeric_lu_scratch,
    solve_in_place_scratch,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::traits::math_utils::zero;
use faer::{Conj, Mat, MatMut, Par};

/// A number type the factorisation can work on; implemented for `f64` and complex `f64`, sealed by its private module.
pub trait Element: faer::traits::ComplexField {}
impl Element for f64 {}
impl Element for num_complex::Complex64 {}

/// Where a square matrix compressed by columns has entries.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ColumnPattern {
    /// Rows and columns of the matrix.
    pub(crate) size: usize,
    /// Where each column begins in `row_indices`; `size + 1` numbers.
    pub(crate) column_starts: Vec<usize>,
    /// Row of each entry, rising within a column.
    pub(crate) row_indices: Vec<usize>,
}

/// The matrix has no LU factorisation, or none that fits into memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NoFactor;

/// Order of elimination for one pattern.
#[derive(Clone, Debug)]
pub(crate) struct LuOrder {
    columns: Perm<usize>,
}

/// A factored matrix.
#[derive(Clone, Debug)]
pub(crate) struct Lu<T> {
    columns: Perm<usize>,
    rows: Perm<usize>,
    factors: SimplicialLu<usize, T>,
}

/// Memory that a solve needs.
pub(crate) struct LuScratch(MemBuffer);

impl LuOrder {
    /// Chooses the order of elimination, which depends on the pattern alone.
    pub(crate) fn new(pattern: &ColumnPattern) -> Result<Self, NoFactor> {
        let matrix = symbolic(pattern);
        let size = pattern.size;
        let (mut forward, mut inverse) = (vec![0; size], vec![0; size]);
        let scratch = colamd::order_scratch::<usize>(size, size, pattern.row_indices.len());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| NoFactor)?;
        let stack = MemStack::new(&mut memory);
        colamd::order(&mut forward, &mut inverse, matrix, colamd::Control::default(), stack)
            .map_err(|_| NoFactor)?;
        Ok(Self { columns: Perm::new_checked(forward.into(), inverse.into(), size) })
    }

    /// Factors the matrix with these entries, in the order of the pattern this was made for.
    pub(crate) fn factor<T: Element>(
        &self,
        pattern: &ColumnPattern,
        values: &[T],
    ) -> Result<Lu<T>, NoFactor> {
        let size = pattern.size;
        let (mut forward, mut inverse) = (vec![0; size], vec![0; size]);
        let mut factors = SimplicialLu::new();
        let scratch = factorize_simplicial_numeric_lu_scratch::<usize, T>(size, size);
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| NoFactor)?;
        factorize_simplicial_numeric_lu(
            &mut forward,
            &mut inverse,
            &mut factors,
            SparseColMatRef::new(symbolic(pattern), values),
            self.columns.as_ref(),
            MemStack::new(&mut memory),
        )
        .map_err(|_| NoFactor)?;
        let rows = Perm::new_checked(forward.into(), inverse.into(), size);
        Ok(Lu { columns: self.columns.clone(), rows, factors })
    }
}

impl<T: Element> Lu<T> {
    /// Memory for [`Lu::solve_in_place`].
    pub(crate) fn scratch(&self) -> LuScratch {
        self.scratch_of_columns(1)
    }

    /// Replaces `b` by the solution of `K x = b`. Garbage if `K` is singular.
    pub(crate) fn solve_in_place(&self, b: &mut [T], scratch: &mut LuScratch) {
        self.solve_columns_in_place(b, 1, scratch);
    }

    /// Memory for [`Lu::solve_columns_in_place`].
    pub(crate) fn scratch_of_columns(&self, count: usize) -> LuScratch {
        LuScratch(MemBuffer::new(solve_in_place_scratch::<usize, T>(self.rows.len(), count, Par::Seq)))
    }

    /// The same for `count` right-hand sides, one after the other: four at once are twice as fast as one by one.
    pub(crate) fn solve_columns_in_place(&self, b: &mut [T], count: usize, scratch: &mut LuScratch) {
        let size = self.rows.len();
        self.factors.solve_in_place_with_conj(
            self.rows.as_ref(),
            self.columns.as_ref(),
            Conj::No,
            MatMut::from_column_major_slice_mut(b, size, count),
            Par::Seq,
            MemStack::new(&mut scratch.0),
        );
    }
}

/// Inverse of a matrix by dense factors, column by column; garbage if it is singular. Cost: cubic.
pub(crate) fn dense_inverse<T: Element>(pattern: &ColumnPattern, values: &[T]) -> Vec<T> {
    let size = pattern.size;
    let mut factors = Mat::<T>::zeros(size, size);
    for column in 0..size {
        for entry in pattern.column_starts[column]..pattern.column_starts[column + 1] {
            factors[(pattern.row_indices[entry], column)] = values[entry].clone();
        }
    }
    let (mut forward, mut inverse) = (vec![0_usize; size], vec![0; size]);
    let factor = lu_in_place_scratch::<usize, T>(size, size, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(factor.or(inverse_scratch::<usize, T>(size, Par::Seq)));
    let stack = MemStack::new(&mut memory);
    let (_, rows) =
        lu_in_place(factors.as_mut(), &mut forward, &mut inverse, Par::Seq, stack, Default::default());
    let mut all = vec![zero::<T>(); size * size];
    let out = MatMut::from_column_major_slice_mut(&mut all, size, size);
    write_inverse(out, factors.as_ref(), factors.as_ref(), rows, Par::Seq, stack);
    all
}

fn symbolic(pattern: &ColumnPattern) -> SymbolicSparseColMatRef<'_, usize> {
    let ColumnPattern { size, column_starts, row_indices } = pattern;
    SymbolicSparseColMatRef::new_checked(*size, *size, column_starts, None, row_indices)
}
