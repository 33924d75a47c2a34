//! Paths of points under three-term rows: all the rows between two pairs of neighbouring points are worth two rows.
//!
//! Row `r` of a path (from 0) is centred on point `r + 1`: `A p_r + B p_{r+1} + C p_{r+2} = t`. The rows `a..d` reach
//! from the pair `(a, a+1)` to the pair `(d, d+1)`. There are `d − a` of them, and two fewer points strictly between the
//! pairs. Minimised over these points their energy is that of two rows on the pairs, with no constant left over:
//!
//! ```text
//!     min over p_{a+2} … p_{d−1} of ½ Σ |A p + B p + C p − t|²  =  ½ ‖R (p_a, p_{a+1}, p_d, p_{d+1})ᵀ − s‖²,   R ∈ ℂ^{2×4}
//! ```
//!
//! Points are eliminated from the left by one 3 × 3 reflection each, on the rows themselves; `MᴴM`, which squares the
//! condition number, is never formed. A state of two rows over `(a, a+1, x, y)` takes up the row over `(x, y, w)`; the
//! reflection leaves one row that holds `x`, kept as a rule for back-substitution, and two rows over `(a, a+1, y, w)`.
//!
//! Rows `a..c` and `c..d` share the pair `(c, c+1)` and no row: [`compose`] joins their pieces, associatively.
//! Rows do not change when their points move as a rigid body (or are scaled, where coefficients are those of
//! [`shape_rows`]), so pieces can be reused wherever a stretch of a path is copied to.
//!
//! Source: Golub and Van Loan, *Matrix Computations*, 4th ed., §5.1 (complex reflections), §5.3 (least squares by QR).

use crate::augmented::check_length;
use crate::c64;
use crate::error::KktError;
use crate::scalar::Scalar;

/// Coefficients of a three-term row on a point's predecessor, the point and its successor.
pub type ChainRow = [c64; 3];

/// A column whose part outside the columns before it is smaller, relative to the column, leaves its point free.
const PIVOT_TOLERANCE: f64 = 1e-13;
/// Squared norms from here up have the squares of all entries that matter among normal numbers.
const SMALLEST_NORM_SQ: f64 = 1e-200;

const ZERO: c64 = c64::new(0.0, 0.0);
const ONE: c64 = c64::new(1.0, 0.0);

/// Rows `a..d` of a path, condensed to two rows on its outer pairs of points.
///
/// The pairs of a single row share a point, `a + 1 = d`: its coefficient is in the second column, the third column is
/// zero, and so is the second row. The empty piece, [`Default`], has only zeros.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChainPiece {
    /// Rows of the path behind it, `d − a`.
    pub length: usize,
    /// `R`, over `(p_a, p_{a+1}, p_d, p_{d+1})`.
    pub rows: [[c64; 4]; 2],
    /// `s`.
    pub targets: [c64; 2],
}

impl ChainPiece {
    /// The piece of a single row.
    pub fn of_row([before, at, after]: ChainRow, target: c64) -> Self {
        Self { length: 1, rows: [[before, at, ZERO, after], [ZERO; 4]], targets: [target, ZERO] }
    }

    /// `½‖R p − s‖²` for the four points of the outer pairs.
    pub fn energy(&self, corners: [c64; 4]) -> f64 {
        let residual = |(row, &target): (&[c64; 4], &c64)| -> f64 {
            let value: c64 = row.iter().zip(corners).map(|(r, p)| r * p).sum();
            (value - target).norm_sqr()
        };
        0.5 * self.rows.iter().zip(&self.targets).map(residual).sum::<f64>()
    }

    /// Rows of `R` that are not zero by construction.
    pub(crate) fn row_count(&self) -> usize {
        self.length.min(2)
    }
}

/// Rows that hold every inner point of a path to its place relative to its neighbours, up to a similarity:
/// `(z − 1, 1, −z)` with `z = (q_i − q_{i−1}) / (q_{i+1} − q_{i−1})`. Not finite where a point's neighbours coincide.
///
/// Source: Kim, Hyun, Kim, Lee, *Synchronized Multi-Character Motion Editing*, SIGGRAPH 2009, in complex numbers.
pub fn shape_rows(rest_path: &[c64]) -> Vec<ChainRow> {
    let row = |q: &[c64]| {
        let z = (q[1] - q[0]) / (q[2] - q[0]);
        [z - ONE, ONE, -z]
    };
    rest_path.windows(3).map(row).collect()
}

/// Condenses consecutive rows of a path. `targets`: one per row.
///
/// Cost: linear in the rows; allocates nothing.
///
/// # Errors
/// [`KktError::Singular`] if the rows leave an inner point free; [`KktError::ShapeMismatch`] and [`KktError::NotFinite`]
/// with block M for coefficients, t for targets.
pub fn condense(rows: &[ChainRow], targets: &[c64]) -> Result<ChainPiece, KktError> {
    check(rows, targets)?;
    let (mut reduced, mut next) = (TargetState::new(targets), 2);
    let piece = eliminate_points(rows, |_, reflection| {
        reduced.take_up(&reflection, targets[next]);
        next += 1;
    })?;
    Ok(ChainPiece { targets: reduced.0, ..piece })
}

/// Checks rows and targets from outside.
pub(crate) fn check(rows: &[ChainRow], targets: &[c64]) -> Result<(), KktError> {
    check_length("t", rows.len(), targets.len())?;
    check_finite("M", rows.iter().map(|row| row.iter().all(|a| a.all_finite())))?;
    check_finite("t", targets.iter().map(|t| t.all_finite()))
}

/// Refuses the first row that is not finite.
pub(crate) fn check_finite(
    block: &'static str,
    mut finite: impl Iterator<Item = bool>,
) -> Result<(), KktError> {
    finite.position(|finite| !finite).map_or(Ok(()), |row| Err(KktError::NotFinite { block, row }))
}

/// Joins a piece to the next one of the path: the shared pair of points is eliminated.
///
/// # Errors
/// [`KktError::Singular`] if the rows leave a point of the shared pair free.
pub fn compose(left: &ChainPiece, right: &ChainPiece) -> Result<ChainPiece, KktError> {
    if left.length == 0 || right.length == 0 {
        return Ok(if left.length == 0 { *right } else { *left });
    }
    let mut columns = stacked(left, right);
    let sizes = [0, 1].map(|column: usize| norm_sq(&columns[column]));
    // Points of a piece of one row are all outer points, and stay.
    let inner = [(0, left.length > 1), (1, right.length > 1)];
    for (column, _) in inner.into_iter().filter(|&(_, eliminated)| eliminated) {
        let [first, rest @ ..] = columns[column];
        let reflection = Reflection::new(first, rest, sizes[column]).ok_or(KktError::Singular)?;
        for entries in &mut columns {
            let [first, rest @ ..] = *entries;
            let (_, [second, third, fourth]) = reflection.apply(first, rest);
            *entries = [second, third, fourth, ZERO];
        }
    }
    let [_, _, outer @ .., targets] = columns;
    Ok(ChainPiece {
        length: left.length + right.length,
        rows: [outer.map(|entries| entries[0]), outer.map(|entries| entries[1])],
        targets: [targets[0], targets[1]],
    })
}

/// Columns of the rows of both pieces over `(c, c+1, a, a+1, d, d+1)` and their targets; rows of zeros come last.
fn stacked(left: &ChainPiece, right: &ChainPiece) -> [[c64; 4]; 7] {
    let shared = [if left.length == 1 { 3 } else { 0 }, if right.length == 1 { 4 } else { 1 }];
    let mut columns = [[ZERO; 4]; 7];
    let mut push = |row: usize, places: [usize; 4], (entries, target): (&[c64; 4], c64)| {
        places.iter().zip(entries).for_each(|(&column, entry)| columns[column][row] += entry);
        columns[6][row] = target;
    };
    for k in 0..left.row_count() {
        push(k, [2, 3, shared[0], shared[1]], (&left.rows[k], left.targets[k]));
    }
    for k in 0..right.row_count() {
        push(left.row_count() + k, [shared[0], shared[1], 4, 5], (&right.rows[k], right.targets[k]));
    }
    columns
}

/// `x = p_a + m₀ p_a + m₁ (p_{a+1} − p_a) + m₂ (y − p_a) + m₃ (w − p_a)`, plus a constant where rows have targets; y, w
/// are the points after x.
pub(crate) type Rule = [c64; 4];

/// Eliminates the points strictly between the outer pairs of some rows, from the left. For each, `eliminated` is given
/// the rule and the reflection.
///
/// Works on points relative to the first, `p_a`, whose own column then holds the sums of the rows: zero, for rows that
/// ignore translations, so that being far from the origin costs no digits.
///
/// # Errors
/// [`KktError::Singular`] if the rows leave a point free.
pub(crate) fn eliminate_points(
    rows: &[ChainRow],
    mut eliminated: impl FnMut(Rule, Reflection<2>),
) -> Result<ChainPiece, KktError> {
    let [first, second, rest @ ..] = rows else {
        return Ok(rows.first().map_or(ChainPiece::default(), |&row| ChainPiece::of_row(row, ZERO)));
    };
    // Columns a, a + 1, x, y of the state.
    let mut a = [sum(first), sum(second)];
    let mut b = [first[1], second[0]];
    let mut x = [first[2], second[1]];
    let mut y = [ZERO, second[2]];
    for (row @ &[row_x, row_y, row_w], before) in rest.iter().zip(rows.windows(2)) {
        let column = [before[0][2], before[1][1], row_x];
        let reflection = Reflection::new(x[0], [x[1], row_x], norm_sq(&column)).ok_or(KktError::Singular)?;
        let mut rule = [ZERO; 4];
        (rule[0], a) = reflection.apply(a[0], [a[1], sum(row)]);
        (rule[1], b) = reflection.apply(b[0], [b[1], ZERO]);
        (rule[2], x) = reflection.apply(y[0], [y[1], row_y]);
        (rule[3], y) = reflection.apply(ZERO, [ZERO, row_w]);
        eliminated(rule.map(|entry| -entry * reflection.inverse_pivot), reflection);
    }
    let rows = [0, 1].map(|k: usize| [a[k] - (b[k] + x[k] + y[k]), b[k], x[k], y[k]]);
    Ok(ChainPiece { length: rest.len() + 2, rows, targets: [ZERO; 2] })
}

/// Sum of the coefficients, in the order that is exact for `(z − 1, 1, −z)` with z near a half.
fn sum([before, at, after]: &ChainRow) -> c64 {
    (before + at) + after
}

/// Targets of the two rows of the state while points are eliminated.
pub(crate) struct TargetState(pub(crate) [c64; 2]);

impl TargetState {
    /// Before the first elimination. `targets`: of all rows of the piece.
    pub(crate) fn new(targets: &[c64]) -> Self {
        Self([0, 1].map(|k: usize| targets.get(k).copied().unwrap_or_default()))
    }

    /// Takes up the target of the next row and returns the constant of the rule.
    pub(crate) fn take_up(&mut self, reflection: &Reflection<2>, target: c64) -> c64 {
        let (rule, state) = reflection.apply(self.0[0], [self.0[1], target]);
        self.0 = state;
        rule * reflection.inverse_pivot
    }
}

/// Householder reflection `I − τ (1, v) (1, v)ᴴ` that leaves only the first entry, the pivot, of some column.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reflection<const N: usize> {
    tau: f64,
    v: [c64; N],
    inverse_pivot: c64,
}

impl<const N: usize> Reflection<N> {
    /// None if the column vanishes against `size_sq`, the squared norm that it had before earlier eliminations.
    fn new(first: c64, rest: [c64; N], size_sq: f64) -> Option<Self> {
        let norm_sq = first.norm_sqr() + norm_sq(&rest);
        let least = SMALLEST_NORM_SQ.max(PIVOT_TOLERANCE * PIVOT_TOLERANCE * size_sq);
        if !norm_sq.is_finite() || norm_sq <= least {
            return None;
        }
        let (norm, modulus) = (norm_sq.sqrt(), first.norm_sqr().sqrt());
        let turn = if modulus > f64::EPSILON * norm { first.conj() / modulus } else { ONE };
        // The pivot turns away from the first entry, so that nothing cancels.
        let reach = norm + modulus;
        let scale = turn / reach;
        Some(Self { tau: reach / norm, v: rest.map(|entry| entry * scale), inverse_pivot: -turn / norm })
    }

    /// Reflects a column, first entry and the rest.
    #[inline]
    fn apply(&self, first: c64, mut rest: [c64; N]) -> (c64, [c64; N]) {
        let along: c64 = self.v.iter().zip(&rest).map(|(v, entry)| v.conj() * entry).sum();
        let share = (first + along) * self.tau;
        self.v.iter().zip(&mut rest).for_each(|(v, entry)| *entry -= v * share);
        (first - share, rest)
    }
}

fn norm_sq(column: &[c64]) -> f64 {
    column.iter().map(c64::norm_sqr).sum()
}
