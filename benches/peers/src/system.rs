//! Square systems that stand for the least-squares problem, assembled for the other libraries.

use cotillion_solvers::{CsMat, LeastSquares, c64};

/// `α` of the Hachtel form, as in our own.
const ALPHA: f64 = 1.0 / 1024.0;

/// Which square system. The rows of the benchmark's problems have norms between 1 and 2, so nothing is scaled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `[MᴴM Hᴴ; H 0]`
    NormalEquations,
    /// `[αI M 0; Mᴴ 0 Hᴴ; 0 H 0]`
    Hachtel,
}

/// Kind of numbers a library is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// Complex: half the unknowns.
    Complex,
    /// Each complex unknown as two real ones, side by side.
    Real,
}

/// Both forms.
pub const FORMS: [Form; 2] = [Form::NormalEquations, Form::Hachtel];

/// Both kinds.
pub const NUMBERS: [Numbers; 2] = [Numbers::Complex, Numbers::Real];

/// Matrix compressed by columns. Vectors that go with it are pairs (real part, imaginary part) for both kinds of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// Kind of numbers.
    pub numbers: Numbers,
    /// Where each column begins; one more than there are columns.
    pub starts: Vec<i32>,
    /// Row of each entry, rising within a column.
    pub rows: Vec<i32>,
    /// Entries; pairs if complex.
    pub values: Vec<f64>,
    /// Per unknown, the sign that makes a shifted matrix quasi-definite.
    pub signs: Vec<f64>,
}

/// Blocks of the unknowns of a system: residuals (Hachtel form only), points, multipliers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Index of the first point.
    pub points: usize,
    /// Index of the first multiplier.
    pub multipliers: usize,
    /// Complex unknowns.
    pub size: usize,
}

type Entry = (usize, usize, c64);

/// Layout of the system of a problem.
pub fn layout(problem: &LeastSquares<c64>, form: Form) -> Layout {
    let points = if form == Form::Hachtel { problem.soft.rows() } else { 0 };
    let multipliers = points + problem.columns;
    Layout { points, multipliers, size: multipliers + problem.hard.rows() }
}

/// The system's matrix. Entries that are exactly zero are left out.
///
/// # Panics
/// If it has more than 2³¹ entries.
pub fn assemble(problem: &LeastSquares<c64>, form: Form, numbers: Numbers) -> Matrix {
    let layout = layout(problem, form);
    let entries = summed(complex_entries(problem, form, layout));
    let signs = (0..layout.size).map(|i| sign(form, layout, i));
    match numbers {
        Numbers::Complex => Matrix {
            numbers,
            starts: starts(layout.size, entries.iter().map(|e| e.0)),
            rows: entries.iter().map(|e| index(e.1)).collect(),
            values: entries.iter().flat_map(|e| [e.2.re, e.2.im]).collect(),
            signs: signs.collect(),
        },
        Numbers::Real => {
            let parts = real_entries(&entries);
            Matrix {
                numbers,
                starts: starts(2 * layout.size, parts.iter().map(|e| e.0)),
                rows: parts.iter().map(|e| index(e.1)).collect(),
                values: parts.iter().map(|e| e.2).collect(),
                signs: signs.flat_map(|s| [s, s]).collect(),
            }
        }
    }
}

/// The system's right-hand side, in pairs.
pub fn right_hand_side(problem: &LeastSquares<c64>, form: Form, m: &[c64], h: &[c64]) -> Vec<f64> {
    let mut b = match form {
        Form::Hachtel => [m, &vec![c64::default(); problem.columns]].concat(),
        Form::NormalEquations => {
            let mut b = vec![c64::default(); problem.columns];
            for (row, m_i) in problem.soft.outer_iterator().zip(m) {
                row.iter().for_each(|(j, a)| b[j] += a.conj() * m_i);
            }
            b
        }
    };
    b.extend_from_slice(h);
    b.iter().flat_map(|z| [z.re, z.im]).collect()
}

/// The points of a solution in pairs.
pub fn points_of(layout: Layout, x: &[f64]) -> Vec<c64> {
    x[2 * layout.points..2 * layout.multipliers].chunks(2).map(|z| c64::new(z[0], z[1])).collect()
}

fn complex_entries(problem: &LeastSquares<c64>, form: Form, layout: Layout) -> Vec<Entry> {
    let mut entries = Vec::new();
    match form {
        Form::Hachtel => {
            entries.extend((0..layout.points).map(|i| (i, i, c64::new(ALPHA, 0.0))));
            push_block(&mut entries, &problem.soft, 0, layout.points);
        }
        Form::NormalEquations => push_product(&mut entries, &problem.soft),
    }
    push_block(&mut entries, &problem.hard, layout.multipliers, layout.points);
    entries
}

/// `A` with its first row and column at the given places, and `Aᴴ` opposite.
fn push_block(entries: &mut Vec<Entry>, a: &CsMat<c64>, row_start: usize, column_start: usize) {
    for (i, row) in a.outer_iterator().enumerate() {
        for (j, a_ij) in row.iter() {
            entries.push((column_start + j, row_start + i, *a_ij));
            entries.push((row_start + i, column_start + j, a_ij.conj()));
        }
    }
}

/// `AᴴA`.
fn push_product(entries: &mut Vec<Entry>, a: &CsMat<c64>) {
    for row in a.outer_iterator() {
        for (j, a_j) in row.iter() {
            entries.extend(row.iter().map(|(k, a_k)| (k, j, a_j.conj() * a_k)));
        }
    }
}

/// Entries by column, then row, each place once.
fn summed(mut entries: Vec<Entry>) -> Vec<Entry> {
    entries.sort_by_key(|&(column, row, _)| (column, row));
    entries.dedup_by(|next, kept| {
        let same = (next.0, next.1) == (kept.0, kept.1);
        if same {
            kept.2 += next.2;
        }
        same
    });
    entries
}

/// `a` as `[re −im; im re]`.
fn real_entries(entries: &[Entry]) -> Vec<(usize, usize, f64)> {
    let four = |&(column, row, a): &Entry| {
        let (c, r) = (2 * column, 2 * row);
        [(c, r, a.re), (c, r + 1, a.im), (c + 1, r, -a.im), (c + 1, r + 1, a.re)]
    };
    let mut parts: Vec<_> = entries.iter().flat_map(four).filter(|e| e.2 != 0.0).collect();
    parts.sort_by_key(|&(column, row, _)| (column, row));
    parts
}

/// Positive and negative blocks in turn: `[MᴴM + δI, Hᴴ; H, −δI]`, `[αI + δI, M, 0; Mᴴ, −δI, Hᴴ; 0, H, δI]`.
fn sign(form: Form, layout: Layout, i: usize) -> f64 {
    let is_point = (layout.points..layout.multipliers).contains(&i);
    if is_point == (form == Form::NormalEquations) { 1.0 } else { -1.0 }
}

fn starts(columns: usize, column_of_entries: impl Iterator<Item = usize>) -> Vec<i32> {
    let mut starts = vec![0; columns + 1];
    column_of_entries.for_each(|column| starts[column + 1] += 1);
    for column in 0..columns {
        starts[column + 1] += starts[column];
    }
    starts
}

fn index(i: usize) -> i32 {
    i32::try_from(i).expect("benchmarks have fewer than 2³¹ unknowns")
}

#[cfg(test)]
mod tests {
    use super::*;
    use cotillion_solvers::RowMatrix;

    /// One soft row `(1 + i) x − x' = m`, one hard row `x' = h`.
    fn two_points() -> LeastSquares<c64> {
        let (mut soft, mut hard) = (RowMatrix::new(2), RowMatrix::new(2));
        soft.push_row(&[(0, c64::new(1.0, 1.0)), (1, c64::new(-1.0, 0.0))]);
        hard.push_row(&[(1, c64::new(1.0, 0.0))]);
        LeastSquares { columns: 2, soft: soft.to_csr(), hard: hard.to_csr() }
    }

    #[test]
    fn normal_equations_are_assembled_by_columns() {
        let matrix = assemble(&two_points(), Form::NormalEquations, Numbers::Complex);
        assert_eq!(matrix.starts, [0, 2, 5, 6]);
        assert_eq!(matrix.rows, [0, 1, 0, 1, 2, 1]);
        assert_eq!(matrix.values, [2.0, 0.0, -1.0, -1.0, -1.0, 1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0]);
        assert_eq!(matrix.signs, [1.0, 1.0, -1.0]);
    }

    #[test]
    fn real_numbers_leave_out_zeros() {
        let matrix = assemble(&two_points(), Form::Hachtel, Numbers::Real);
        assert_eq!(matrix.starts.len(), 9);
        assert_eq!(matrix.rows[..4], [0, 2, 3, 4]); // α, then the real and imaginary part of 1 − i, then −1
        assert_eq!(matrix.values[..4], [ALPHA, 1.0, -1.0, -1.0]);
        assert_eq!(matrix.signs, [1.0, 1.0, -1.0, -1.0, -1.0, -1.0, 1.0, 1.0]);
    }

    #[test]
    fn right_hand_side_of_the_normal_equations_is_projected() {
        let (m, h) = ([c64::new(0.0, 2.0)], [c64::new(3.0, 4.0)]);
        let b = right_hand_side(&two_points(), Form::NormalEquations, &m, &h);
        assert_eq!(b, [2.0, 2.0, 0.0, -2.0, 3.0, 4.0]);
        assert_eq!(
            right_hand_side(&two_points(), Form::Hachtel, &m, &h),
            [0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 3.0, 4.0]
        );
    }
}
