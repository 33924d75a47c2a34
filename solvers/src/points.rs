//! Rows on the points of several sequences (paths, tracks), before it is decided which points are unknowns.

/// One term of a row: sequence, point in it (counted from 0), coefficient.
pub type PointTerm<T> = (usize, usize, T);

/// A linear row on points, `Σ coefficient · point = target`; targets are given with each solve.
#[derive(Clone, Debug, PartialEq)]
pub struct PointRow<T> {
    /// Terms in any order; terms of one point are summed.
    pub terms: Vec<PointTerm<T>>,
    /// `None`: the row must hold. Else its energy is `½·weight·|Σ … − target|²`; above 0.
    pub weight: Option<f64>,
}

impl<T> PointRow<T> {
    /// A row that must hold.
    pub fn hard(terms: Vec<PointTerm<T>>) -> Self {
        Self { terms, weight: None }
    }

    /// A row with energy `½·weight·|…|²`.
    pub fn soft(terms: Vec<PointTerm<T>>, weight: f64) -> Self {
        Self { terms, weight: Some(weight) }
    }
}
