//! Which equality rows depend on which others.

use crate::scalar::Scalar;
use sprs::CsMat;
use std::collections::{BTreeMap, BTreeSet};

/// A row is dependent if elimination leaves no larger entry of it, relative to its length.
const REMAINDER_TOLERANCE: f64 = 1e-10;
/// Entries smaller than this, relative to the length of their row, are rounding errors of elimination.
const ROUNDING: f64 = 1e-14;
/// Rows with smaller coefficients, relative to the largest, are not part of a certificate.
const CERTIFICATE_TOLERANCE: f64 = 1e-6;

/// Rows of a matrix sorted into a basis and the rest.
#[derive(Clone, Debug, PartialEq)]
pub struct RankReport<T> {
    /// Rows independent of those before them, rising. Their number is the rank.
    pub independent: Vec<usize>,
    /// The others, each as a combination of independent rows before it.
    pub dependent: Vec<Dependency<T>>,
}

/// A vanishing combination of rows, `Σ y_k row_k = 0`.
#[derive(Clone, Debug, PartialEq)]
pub struct Dependency<T> {
    /// The row found dependent, the last of the combination; its coefficient is 1.
    pub row: usize,
    /// Rows and their coefficients `y_k`, by rising row.
    pub combination: Vec<(usize, T)>,
}

impl<T: Scalar> Dependency<T> {
    /// `|Σ y_k h_k|`: zero if the rows with these targets agree, else the amount by which they contradict each other.
    /// The other rows given, it is what the target of [`row`](Self::row) misses.
    pub fn mismatch(&self, h: &[T]) -> f64 {
        self.combination.iter().fold(T::zero(), |sum, &(k, y)| sum + y * h[k]).modulus()
    }

    /// Rows that take part, by rising index: without any one of them the others are independent.
    pub fn certificate(&self) -> Vec<usize> {
        let largest = self.combination.iter().map(|(_, y)| y.modulus()).fold(0.0, f64::max);
        let counts = |&&(_, y): &&(usize, T)| y.modulus() > CERTIFICATE_TOLERANCE * largest;
        self.combination.iter().filter(counts).map(|&(k, _)| k).collect()
    }
}

/// Sorts rows, in order of priority, into independent ones and combinations of earlier ones.
///
/// Gaussian elimination: each row is reduced by the earlier ones, from the first to the last whose pivot it holds; what
/// is left is a new row of the basis, with a pivot at least half its largest entry, in a column few rows touch. Only
/// rows that share columns meet, so chains of thousands of rows that overlap in turn cost no more than their entries,
/// where Gram–Schmidt would make every direction as long as the chain. Multipliers are kept apart and multiplied out
/// only for dependent rows.
///
/// # Panics
/// If `hard` is compressed by columns.
pub fn analyse_rank<T: Scalar>(hard: &CsMat<T>) -> RankReport<T> {
    assert!(hard.is_csr(), "matrix is compressed by columns");
    let mut report = RankReport { independent: Vec::new(), dependent: Vec::new() };
    let mut basis = Basis::new(hard);
    for (index, row) in hard.outer_iterator().enumerate() {
        let mut rest: Sparse<T> = row.iter().map(|(j, &a)| (j, a)).collect();
        let length = rest.values().map(|a| a.modulus_squared()).sum::<f64>().sqrt();
        let used = basis.reduce(&mut rest, ROUNDING * length);
        let remainder = rest.values().map(|a| a.modulus()).fold(0.0, f64::max);
        if remainder > REMAINDER_TOLERANCE * length {
            report.independent.push(index);
            basis.push(index, rest, used);
        } else {
            report.dependent.push(Dependency { row: index, combination: basis.combination(index, &used) });
        }
    }
    report
}

/// Sparse vector; a tree, so that sums run in a fixed order.
type Sparse<T> = BTreeMap<usize, T>;

/// A row in echelon form: the row given minus multiples of earlier rows of the basis.
struct Echelon<T> {
    given: usize,
    pivot: T,
    pivot_column: usize,
    entries: Sparse<T>,
    used: Vec<(usize, T)>,
}

struct Basis<T> {
    rows: Vec<Echelon<T>>,
    row_of_pivot: Vec<Option<usize>>,
    column_counts: Vec<usize>,
}

impl<T: Scalar> Basis<T> {
    fn new(hard: &CsMat<T>) -> Self {
        let mut column_counts = vec![0; hard.cols()];
        hard.indices().iter().for_each(|&j| column_counts[j] += 1);
        Self { rows: Vec::new(), row_of_pivot: vec![None; hard.cols()], column_counts }
    }

    /// Eliminates the pivots of the basis from a row and returns the multiples of basis rows taken off. Entries down
    /// to `rounding` are dropped. A basis row holds no pivot of an earlier one, so one pass in their order is enough.
    fn reduce(&self, rest: &mut Sparse<T>, rounding: f64) -> Vec<(usize, T)> {
        let mut waiting: BTreeSet<usize> = rest.keys().filter_map(|&j| self.row_of_pivot[j]).collect();
        let mut used = Vec::new();
        while let Some(k) = waiting.pop_first() {
            let row = &self.rows[k];
            let Some(entry) = rest.remove(&row.pivot_column) else {
                continue;
            };
            if entry.modulus() <= rounding {
                continue;
            }
            let factor = entry / row.pivot;
            for (&j, &a) in row.entries.iter().filter(|&(&j, _)| j != row.pivot_column) {
                *rest.entry(j).or_insert(T::zero()) -= factor * a;
                waiting.extend(self.row_of_pivot[j]);
            }
            used.push((k, factor));
        }
        rest.retain(|_, a| a.modulus() > rounding);
        used
    }

    fn push(&mut self, given: usize, entries: Sparse<T>, used: Vec<(usize, T)>) {
        let largest = entries.values().map(|a| a.modulus()).fold(0.0, f64::max);
        let candidates = entries.iter().filter(|(_, a)| a.modulus() >= 0.5 * largest);
        let (&pivot_column, &pivot) =
            candidates.min_by_key(|&(&j, _)| self.column_counts[j]).expect("an independent row has entries");
        self.row_of_pivot[pivot_column] = Some(self.rows.len());
        self.rows.push(Echelon { given, pivot, pivot_column, entries, used });
    }

    /// Given rows behind `row − Σ factor · basis row`, by rising index.
    fn combination(&self, row: usize, used: &[(usize, T)]) -> Vec<(usize, T)> {
        let mut of_basis: Sparse<T> = used.iter().map(|&(k, factor)| (k, -factor)).collect();
        let mut combination = vec![(row, T::one())];
        while let Some((k, y)) = of_basis.pop_last() {
            combination.push((self.rows[k].given, y));
            for &(earlier, factor) in &self.rows[k].used {
                *of_basis.entry(earlier).or_insert(T::zero()) -= y * factor;
            }
        }
        combination.sort_unstable_by_key(|&(k, _)| k);
        combination
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RowMatrix, c64};

    /// Rows 0, 1, 2 pin unknowns 0, 100, 199; row 3 copies row 0; row 4 is row 0 + row 1.
    fn pins() -> CsMat<c64> {
        let one = c64::new(1.0, 0.0);
        let mut rows = RowMatrix::new(200);
        for pin in [0, 100, 199, 0] {
            rows.push_row(&[(pin, one)]);
        }
        rows.push_row(&[(0, one), (100, one)]);
        rows.to_csr()
    }

    #[test]
    fn redundant_pins_are_found_and_agree() {
        let report = analyse_rank(&pins());
        assert_eq!(report.independent, vec![0, 1, 2]);
        let target = |re| c64::new(re, -re);
        let h = [target(1.0), target(2.0), target(5.0), target(1.0), target(3.0)];
        assert!(report.dependent.iter().all(|d| d.mismatch(&h) < 1e-15));
        let certificates: Vec<_> = report.dependent.iter().map(Dependency::certificate).collect();
        assert_eq!(certificates, vec![vec![0, 3], vec![0, 1, 4]]);
    }

    #[test]
    fn contradicting_copy_names_both_rows_and_the_mismatch() {
        let report = analyse_rank(&pins());
        let mut h = [c64::default(); 5];
        h[3] = c64::new(0.0, 0.1);
        assert_eq!(report.dependent[0].certificate(), vec![0, 3]);
        assert!((report.dependent[0].mismatch(&h) - 0.1).abs() < 1e-15);
        assert_eq!(report.dependent[1].mismatch(&h), 0.0);
    }

    #[test]
    fn complex_combinations_vanish() {
        let mut rows = RowMatrix::new(3);
        let (a, b) = (c64::new(1.0, 2.0), c64::new(-0.5, 3.0));
        rows.push_row(&[(0, a), (1, b)]);
        rows.push_row(&[(1, a), (2, b)]);
        rows.push_row(&[(0, a * b), (1, b * b - a * a), (2, -a * b)]);
        let dependency = &analyse_rank(&rows.to_csr()).dependent[0];
        let expected = [-b, a, c64::new(1.0, 0.0)];
        for (&(_, y), e) in dependency.combination.iter().zip(expected) {
            assert!((y - e).norm() < 1e-13);
        }
    }

    #[test]
    fn long_overlapping_chain_has_full_rank() {
        let count = 3000;
        let mut rows = RowMatrix::new(count + 1);
        for i in 0..count {
            rows.push_row(&[(i, -1.0), (i + 1, 1.0)]);
        }
        rows.push_row(&[(0, -1.0), (count, 1.0)]);
        let report = analyse_rank(&rows.to_csr());
        assert_eq!(report.independent.len(), count);
        assert_eq!(report.dependent[0].certificate().len(), count + 1);
    }
}
