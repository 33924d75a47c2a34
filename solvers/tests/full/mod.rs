//! The full system of all points, solved by the augmented matrix: what reductions are compared with.

use cotillion_solvers::{LeastSquares, PointRow, RowMatrix, Solution, c64, shape_rows, solve};

/// Minimises shape rows of `paths` and soft `rows` subject to the hard ones; one target a row. Unknowns: all points, path
/// after path.
pub(crate) fn solve_full(paths: &[Vec<c64>], rows: &[PointRow<c64>], targets: &[c64]) -> Solution<c64> {
    let mut starts = vec![0];
    for path in paths {
        starts.push(starts[starts.len() - 1] + path.len());
    }
    let columns = starts[paths.len()];
    let (mut soft, mut hard) = (RowMatrix::new(columns), RowMatrix::new(columns));
    let (mut m, mut h) = (Vec::new(), Vec::new());
    for (path, start) in paths.iter().zip(&starts) {
        for (i, row) in shape_rows(path).iter().enumerate() {
            soft.push_row(&[(start + i, row[0]), (start + i + 1, row[1]), (start + i + 2, row[2])]);
            m.push(c64::default());
        }
    }
    for (row, target) in rows.iter().zip(targets) {
        let root = row.weight.unwrap_or(1.0).sqrt();
        let terms: Vec<_> = row.terms.iter().map(|(path, j, c)| (starts[*path] + j, c * root)).collect();
        let (matrix, side) = if row.weight.is_some() { (&mut soft, &mut m) } else { (&mut hard, &mut h) };
        matrix.push_row(&terms);
        side.push(target * root);
    }
    let problem = LeastSquares { columns, soft: soft.to_csr(), hard: hard.to_csr() };
    solve(&problem, &m, &h).expect("regular")
}
