//! Assembly of sparse matrices: rows as they come, and block matrices whose pattern stays while values change.

use crate::lu::ColumnPattern;
use crate::scalar::Scalar;
use sprs::CsMat;

/// Matrix under construction, one row after the other.
///
/// ```
/// use cotillion_solvers::RowMatrix;
///
/// let mut rows = RowMatrix::new(3);
/// rows.push_row(&[(2, 1.0), (0, 4.0), (2, 1.0)]);
/// assert_eq!(rows.to_csr().get(0, 2), Some(&2.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RowMatrix<T> {
    columns: usize,
    row_starts: Vec<usize>,
    indices: Vec<usize>,
    values: Vec<T>,
}

impl<T: Scalar> RowMatrix<T> {
    /// A matrix of no rows yet.
    pub fn new(columns: usize) -> Self {
        Self { columns, row_starts: vec![0], indices: Vec::new(), values: Vec::new() }
    }

    /// Columns, fixed from the start.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows so far.
    pub fn rows(&self) -> usize {
        self.row_starts.len() - 1
    }

    /// Appends the row `Σ coefficient · x_column` and returns its index. Terms come in any order; terms of one column
    /// are summed, in the order given. A sum of zero stays an entry, so the pattern does not depend on values.
    ///
    /// # Panics
    /// If a column is not smaller than the matrix's number of columns.
    pub fn push_row(&mut self, terms: &[(usize, T)]) -> usize {
        let start = self.indices.len();
        for &(column, value) in terms {
            assert!(column < self.columns, "column {column} of a matrix of {} columns", self.columns);
            match self.indices[start..].binary_search(&column) {
                Ok(at) => self.values[start + at] += value,
                Err(at) => {
                    self.indices.insert(start + at, column);
                    self.values.insert(start + at, value);
                }
            }
        }
        self.row_starts.push(self.indices.len());
        self.rows() - 1
    }

    /// The matrix so far, compressed by rows.
    pub fn to_csr(&self) -> CsMat<T> {
        CsMat::new(
            (self.rows(), self.columns),
            self.row_starts.clone(),
            self.indices.clone(),
            self.values.clone(),
        )
    }
}

/// `A x`, for a matrix compressed by rows.
///
/// # Panics
/// If `a` is compressed by columns, or `x` is shorter than a row of `a`.
pub fn multiply<T: Scalar>(a: &CsMat<T>, x: &[T]) -> Vec<T> {
    assert!(a.is_csr(), "matrix is compressed by columns");
    a.outer_iterator().map(|row| row.iter().fold(T::zero(), |sum, (j, &a_ij)| sum + a_ij * x[j])).collect()
}

/// Pattern of a square matrix compressed by columns, with the place of every datum that goes into it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Assembly {
    /// Where the matrix has entries.
    pub(crate) pattern: ColumnPattern,
    slots: Vec<usize>,
}

impl Assembly {
    /// Pattern that takes datum `k` at `positions[k] = (row, column)`. Data at one position are summed.
    pub(crate) fn new(size: usize, positions: &[(usize, usize)]) -> Self {
        let order = by_column_then_row(size, positions);
        let mut column_starts = vec![0; size + 1];
        let mut row_indices = Vec::with_capacity(positions.len());
        let mut slots = vec![0; positions.len()];
        let mut last = None;
        for datum in order {
            let (row, column) = positions[datum];
            if last != Some((row, column)) {
                row_indices.push(row);
                column_starts[column + 1] += 1;
                last = Some((row, column));
            }
            slots[datum] = row_indices.len() - 1;
        }
        for column in 0..size {
            column_starts[column + 1] += column_starts[column];
        }
        Self { pattern: ColumnPattern { size, column_starts, row_indices }, slots }
    }

    /// Stored values of the matrix made of `data`, in the order of the positions.
    pub(crate) fn values<T: Scalar>(&self, data: &[T]) -> Vec<T> {
        debug_assert_eq!(data.len(), self.slots.len(), "one datum per position");
        let mut values = vec![T::zero(); self.pattern.row_indices.len()];
        for (&slot, &datum) in self.slots.iter().zip(data) {
            values[slot] += datum;
        }
        values
    }
}

/// Data sorted by column, then row, then order of arrival: two counting sorts, linear in size and data.
fn by_column_then_row(size: usize, positions: &[(usize, usize)]) -> Vec<usize> {
    let arrival: Vec<usize> = (0..positions.len()).collect();
    let by_row = counting_sort(size, &arrival, |datum| positions[datum].0);
    counting_sort(size, &by_row, |datum| positions[datum].1)
}

fn counting_sort(size: usize, items: &[usize], key: impl Fn(usize) -> usize) -> Vec<usize> {
    let mut next = vec![0; size + 1];
    for &item in items {
        next[key(item) + 1] += 1;
    }
    for k in 0..size {
        next[k + 1] += next[k];
    }
    let mut sorted = vec![0; items.len()];
    for &item in items {
        let place = &mut next[key(item)];
        sorted[*place] = item;
        *place += 1;
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_of_one_column_are_summed() {
        let mut rows = RowMatrix::new(4);
        assert_eq!(rows.push_row(&[(3, 1.0), (1, 2.0), (3, 0.5)]), 0);
        assert_eq!(rows.push_row(&[]), 1);
        let a = rows.to_csr();
        assert_eq!((a.rows(), a.cols(), a.nnz()), (2, 4, 2));
        assert_eq!(multiply(&a, &[1.0, 10.0, 100.0, 1000.0]), vec![1520.0, 0.0]);
    }

    #[test]
    #[should_panic(expected = "column 4 of a matrix of 4 columns")]
    fn columns_out_of_range_are_a_bug_of_the_caller() {
        RowMatrix::new(4).push_row(&[(4, 1.0)]);
    }

    #[test]
    fn data_find_their_entries_again() {
        let assembly = Assembly::new(3, &[(2, 0), (0, 1), (2, 0), (1, 0)]);
        assert_eq!(assembly.pattern.column_starts, vec![0, 2, 3, 3]);
        assert_eq!(assembly.pattern.row_indices, vec![1, 2, 0]);
        assert_eq!(assembly.values(&[1.0, 2.0, 4.0, 8.0]), vec![8.0, 5.0, 2.0]);
    }
}
