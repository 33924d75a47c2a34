//! Motions that no row sees: combinations of a given basis, found by sparse elimination.

use std::collections::BTreeMap;

use crate::c64;
use crate::rank::analyse_rank;
use crate::sparse::RowMatrix;

/// A combination of motions, or what rows see of a motion: index, share; rising.
pub type Combination = Vec<(usize, c64)>;

/// A group of motions is surely fixed by rows if the determinant of their Gram matrix exceeds this share of the square of its
/// trace; what is less sure is left to elimination.
const SURELY_FIXED: f64 = 1e-9;

/// Combinations of orthonormal motions that none of `rows` rows sees, orthonormal.
///
/// `seen`: what each row sees of each motion, by motion; rows normalised. `groups`: first motion of each group of one or two
/// (the motions of one path), and one more that closes the last. Cost: linear where rows fix group after group; else that
/// of a sparse elimination, near linear where rows tie neighbours only.
pub fn free_combinations(seen: &[Combination], groups: &[usize], rows: usize) -> Vec<Combination> {
    if Peeling::new(seen, groups, rows).fixes_all() {
        return Vec::new();
    }
    // Motions that few rows see go first: what all others are tied to would fill them up.
    let mut order: Vec<usize> = (0..seen.len()).collect();
    order.sort_by_key(|motion| seen[*motion].len());
    let mut matrix = RowMatrix::new(rows.max(1));
    for motion in &order {
        matrix.push_row(&seen[*motion]);
    }
    let dependent = analyse_rank(&matrix.to_csr()).dependent;
    let in_order = |combination: Combination| -> Combination {
        combination.into_iter().map(|(place, share)| (order[place], share)).collect()
    };
    orthonormal(dependent.into_iter().map(|dependency| in_order(dependency.combination)))
}

/// Groups that rows fix one after the other: each by rows that see nothing else that is still free.
struct Peeling<'a> {
    seen: &'a [Combination],
    groups: &'a [usize],
    /// Groups that each row sees and that are free, their number, and the sum of their indices: the last one left is known.
    free: Vec<(usize, usize)>,
}

impl<'a> Peeling<'a> {
    fn new(seen: &'a [Combination], groups: &'a [usize], rows: usize) -> Self {
        let mut free = vec![(0, 0); rows];
        for (group, range) in groups.windows(2).enumerate() {
            for (row, _) in rows_of(&seen[range[0]..range[1]]) {
                free[row].0 += 1;
                free[row].1 += group;
            }
        }
        Self { seen, groups, free }
    }

    fn fixes_all(&mut self) -> bool {
        let count = self.groups.len() - 1;
        let mut fixed = vec![false; count];
        let mut waiting: Vec<usize> = (0..count).rev().collect();
        while let Some(group) = waiting.pop() {
            if fixed[group] || !self.is_fixed(group) {
                continue;
            }
            fixed[group] = true;
            for (row, _) in rows_of(&self.seen[self.groups[group]..self.groups[group + 1]]) {
                self.free[row].0 -= 1;
                self.free[row].1 -= group;
                if self.free[row].0 == 1 {
                    waiting.push(self.free[row].1);
                }
            }
        }
        fixed.into_iter().all(|fixed| fixed)
    }

    /// Whether rows that see no other free group fix this one.
    fn is_fixed(&self, group: usize) -> bool {
        let own = &self.seen[self.groups[group]..self.groups[group + 1]];
        let (mut first, mut mixed, mut second) = (0.0, c64::default(), 0.0);
        for (row, [a, b]) in rows_of(own) {
            if self.free[row].0 == 1 {
                first += a.norm_sqr();
                mixed += a.conj() * b;
                second += b.norm_sqr();
            }
        }
        match own.len() {
            1 => first > 0.0,
            _ => first * second - mixed.norm_sqr() > SURELY_FIXED * (first + second).powi(2),
        }
    }
}

/// Rows that see a group of one or two motions, with what they see of each; both list the same rows.
fn rows_of(own: &[Combination]) -> impl Iterator<Item = (usize, [c64; 2])> + '_ {
    own[0].iter().enumerate().map(|(place, (row, first))| {
        let second = own.get(1).map_or(c64::default(), |other| other[place].1);
        (*row, [*first, second])
    })
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
