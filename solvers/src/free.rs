//! Motions that no row sees: combinations of a given basis, found by sparse elimination.

use std::collections::BTreeMap;

use crate::c64;
use crate::rank::analyse_rank;
use crate::sparse::RowMatrix;

/// A combination of motions, or what rows see of a motion: index, share; rising.
pub type Combination = Vec<(usize, c64)>;

/// Combinations of orthonormal motions that none of `rows` rows sees, orthonormal. `seen`: what each row sees of each
/// motion, by motion; rows normalised. Cost: that of a sparse elimination; near linear where rows tie neighbours only.
pub fn free_combinations(seen: &[Combination], rows: usize) -> Vec<Combination> {
    let mut matrix = RowMatrix::new(rows.max(1));
    for own in seen {
        matrix.push_row(own);
    }
    let dependent = analyse_rank(&matrix.to_csr()).dependent;
    orthonormal(dependent.into_iter().map(|dependency| dependency.combination))
}

/// Modified Gram–Schmidt, twice, on sparse vectors that are independent.
fn orthonormal(vectors: impl Iterator<Item = Combination>) -> Vec<Combination> {
    let mut basis: Vec<Combination> = Vec::new();
    for mut vector in vectors {
        vector.sort_unstable_by_key(|(index, _)| *index);
        for _ in 0..2 {
            for known in &basis {
                let share = dot(known, &vector);
                if share != c64::default() {
                    vector = less(&vector, share, known);
                }
            }
            let length = vector.iter().map(|(_, value)| value.norm_sqr()).sum::<f64>().sqrt();
            vector.iter_mut().for_each(|(_, value)| *value /= length);
        }
        basis.push(vector);
    }
    basis
}

/// `aᴴb` of sparse vectors.
fn dot(a: &Combination, b: &Combination) -> c64 {
    let value = |(index, x): &(usize, c64)| {
        b.binary_search_by_key(index, |(other, _)| *other)
            .map_or(c64::default(), |place| x.conj() * b[place].1)
    };
    a.iter().map(value).sum()
}

/// `a − share·b` of sparse vectors.
fn less(a: &Combination, share: c64, b: &Combination) -> Combination {
    let mut sum: BTreeMap<usize, c64> = a.iter().copied().collect();
    for (index, value) in b {
        *sum.entry(*index).or_default() -= share * value;
    }
    sum.into_iter().collect()
}
