//! Long rows cut into chains of short ones, so that a row over all unknowns does not fill the factors.
//!
//! A row `Σ a_j x_j = b` over many columns (a gauge row, a centre of mass) makes minimum-degree orderings fill in
//! dozens of times the entries of the matrix. It says the same as a running sum with new unknowns `s_k`:
//!
//! ```text
//!     Σ_{j in B_1} a_j x_j             − c s_1     = 0
//!     c s_1 + Σ_{j in B_2} a_j x_j     − c s_2     = 0
//!     …
//!     c s_{L−1} + Σ_{j in B_L} a_j x_j             = b
//! ```
//!
//! `c` is about `Σ |a_j|`, so that no `s_k` is much larger than the unknowns: with `c` like one coefficient, sums over
//! 200 000 unknowns cost so many digits that the system passes for singular.
//!
//! All but the last are hard rows, the last is hard or soft as the row was. Minimisers and energy are unchanged, and
//! the multiplier of a hard row is that of its last piece.
//!
//! Source: Grcar, *Matrix stretching for linear equations*, Sandia report SAND90-8723 (1990).

use crate::least_squares::LeastSquares;
use crate::scalar::Scalar;
use crate::sparse::RowMatrix;

/// Rows with more entries are cut.
const LONGEST_ROW: usize = 24;
/// Entries of the given row in each piece.
const PIECE: usize = 8;

/// A problem of short rows with the minimisers of the given one, in its leading unknowns.
pub(crate) struct Stretched<T> {
    /// Soft rows, in the order given.
    pub(crate) soft: RowMatrix<T>,
    /// Hard rows: pieces, each chain in front of its last piece.
    pub(crate) hard: RowMatrix<T>,
    /// For each given hard row, the row of `hard` that bears its target and its multiplier.
    pub(crate) hard_rows: Vec<usize>,
}

/// Cuts the long rows of a problem. Which rows depends on the pattern only.
pub(crate) fn stretch<T: Scalar>(problem: &LeastSquares<T>) -> Stretched<T> {
    let rows = problem.soft.outer_iterator().chain(problem.hard.outer_iterator());
    let columns = problem.columns + rows.map(|row| cuts(row.nnz())).sum::<usize>();
    let mut stretched =
        Stretched { soft: RowMatrix::new(columns), hard: RowMatrix::new(columns), hard_rows: Vec::new() };
    let mut next_column = problem.columns;
    let mut terms = Vec::new();
    for row in problem.soft.outer_iterator() {
        terms.clear();
        terms.extend(row.iter().map(|(j, &a)| (j, a)));
        cut_row(&mut terms, &mut stretched.hard, &mut next_column);
        stretched.soft.push_row(&terms);
    }
    for row in problem.hard.outer_iterator() {
        terms.clear();
        terms.extend(row.iter().map(|(j, &a)| (j, a)));
        cut_row(&mut terms, &mut stretched.hard, &mut next_column);
        let bearer = stretched.hard.push_row(&terms);
        stretched.hard_rows.push(bearer);
    }
    stretched
}

/// New unknowns of a row.
fn cuts(entries: usize) -> usize {
    if entries > LONGEST_ROW { entries.div_ceil(PIECE) - 1 } else { 0 }
}

/// Moves all pieces of a row but the last to `hard`, and leaves the last in `terms`.
fn cut_row<T: Scalar>(terms: &mut Vec<(usize, T)>, hard: &mut RowMatrix<T>, next_column: &mut usize) {
    let cuts = cuts(terms.len());
    if cuts == 0 {
        return;
    }
    let c = T::from_real(power_of_two_below(terms.iter().map(|(_, a)| a.modulus()).sum()));
    let mut carried: Option<(usize, T)> = None;
    for piece in terms.chunks(PIECE).take(cuts) {
        let mut row: Vec<_> = carried.into_iter().chain(piece.iter().copied()).collect();
        row.push((*next_column, -c));
        hard.push_row(&row);
        carried = Some((*next_column, c));
        *next_column += 1;
    }
    terms.drain(..cuts * PIECE);
    terms.extend(carried);
}

/// The largest power of two that is not above `x`; 1 for zero, subnormal, infinite and undefined numbers.
pub(crate) fn power_of_two_below(x: f64) -> f64 {
    const EXPONENT_BITS: u64 = 0x7ff0_0000_0000_0000;
    if x.is_normal() { f64::from_bits(x.to_bits() & EXPONENT_BITS) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_rows_stay_as_they_are() {
        let mut rows = RowMatrix::new(LONGEST_ROW);
        rows.push_row(&(0..LONGEST_ROW).map(|j| (j, 1.0)).collect::<Vec<_>>());
        let soft = rows.to_csr();
        let problem = LeastSquares { columns: LONGEST_ROW, hard: RowMatrix::new(LONGEST_ROW).to_csr(), soft };
        let stretched = stretch(&problem);
        assert_eq!(stretched.soft.to_csr(), problem.soft);
        assert_eq!(stretched.hard.rows(), 0);
    }

    #[test]
    fn pieces_add_up_to_the_row() {
        let columns = 30;
        let mut rows = RowMatrix::new(columns);
        rows.push_row(&(0..columns).map(|j| (j, 3.0)).collect::<Vec<_>>());
        let problem =
            LeastSquares { columns, soft: RowMatrix::<f64>::new(columns).to_csr(), hard: rows.to_csr() };
        let stretched = stretch(&problem);
        let hard = stretched.hard.to_csr();
        assert_eq!((hard.rows(), hard.cols(), stretched.hard_rows), (4, 33, vec![3]));
        let mut sums = vec![0.0; hard.cols()];
        for row in hard.outer_iterator() {
            row.iter().for_each(|(j, a)| sums[j] += a);
        }
        assert!(sums[..columns].iter().all(|&a| a == 3.0) && sums[columns..].iter().all(|&a| a == 0.0));
    }

    #[test]
    fn powers_of_two() {
        assert_eq!(
            [1.0, 3.9, 4.0, 0.3, 0.0, f64::NAN].map(power_of_two_below),
            [1.0, 2.0, 4.0, 0.25, 1.0, 1.0]
        );
    }
}
