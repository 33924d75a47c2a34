//! Problems without an answer end in an error, never in NaN.

use cotillion_solvers::{KktError, KktForm, LeastSquares, RowMatrix, analyse, solve};

fn rows(columns: usize, rows: &[&[(usize, f64)]]) -> RowMatrix<f64> {
    let mut matrix = RowMatrix::new(columns);
    rows.iter().for_each(|row| {
        matrix.push_row(row);
    });
    matrix
}

/// Four unknowns, second differences small, the first two held.
fn valid() -> (LeastSquares<f64>, Vec<f64>, Vec<f64>) {
    let soft = rows(4, &[&[(0, 1.0), (1, -2.0), (2, 1.0)], &[(1, 1.0), (2, -2.0), (3, 1.0)]]);
    let hard = rows(4, &[&[(0, 1.0)], &[(1, 1.0)]]);
    (LeastSquares { columns: 4, soft: soft.to_csr(), hard: hard.to_csr() }, vec![0.0; 2], vec![1.0, 2.0])
}

#[test]
fn valid_problem_is_solved() {
    let (problem, m, h) = valid();
    let x = solve(&problem, &m, &h).expect("two points make a line").x;
    assert!(x.iter().zip([1.0, 2.0, 3.0, 4.0]).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn free_unknowns_are_singular() {
    let (mut problem, m, _) = valid();
    problem.hard = rows(4, &[&[(0, 1.0)]]).to_csr();
    assert_eq!(solve(&problem, &m, &[1.0]), Err(KktError::Singular));
    problem.hard = rows(4, &[]).to_csr();
    assert_eq!(solve(&problem, &m, &[]), Err(KktError::Singular));
    for form in [KktForm::Hachtel, KktForm::NormalEquations] {
        let analysis = analyse(&problem, form).expect("shapes fit");
        assert_eq!(analysis.factor(&problem).err(), Some(KktError::Singular));
    }
}

#[test]
fn dependent_hard_rows_are_singular() {
    let (mut problem, m, _) = valid();
    let sum = [(0, 0.1), (1, 0.3)];
    problem.hard = rows(4, &[&[(0, 1.0)], &[(1, 1.0)], &sum]).to_csr();
    assert_eq!(solve(&problem, &m, &[1.0, 2.0, 0.7]), Err(KktError::Singular));
    problem.hard = rows(4, &[&[(0, 1.0)], &[(1, 1.0)], &[(2, 0.0)]]).to_csr();
    assert_eq!(solve(&problem, &m, &[1.0, 2.0, 0.0]), Err(KktError::Singular));
}

#[test]
fn numbers_that_are_none_are_refused_by_row() {
    let (mut problem, m, h) = valid();
    assert_eq!(solve(&problem, &[0.0, f64::NAN], &h), Err(KktError::NotFinite { block: "m", row: 1 }));
    assert_eq!(solve(&problem, &m, &[f64::INFINITY, 0.0]), Err(KktError::NotFinite { block: "h", row: 0 }));
    problem.hard = rows(4, &[&[(0, 1.0)], &[(1, f64::NAN)]]).to_csr();
    assert_eq!(solve(&problem, &m, &h), Err(KktError::NotFinite { block: "H", row: 1 }));
}

#[test]
fn shapes_that_do_not_fit_are_named() {
    let (mut problem, m, h) = valid();
    let mismatch =
        |block, side, expected, actual| Err(KktError::ShapeMismatch { block, side, expected, actual });
    assert_eq!(solve(&problem, &m[..1], &h), mismatch("m", "rows", 2, 1));
    assert_eq!(solve(&problem, &m, &[]), mismatch("h", "rows", 2, 0));
    let analysis = analyse(&problem, KktForm::Hachtel).expect("shapes fit");
    problem.columns = 5;
    assert_eq!(solve(&problem, &m, &h), mismatch("M", "columns", 5, 4));
    problem.columns = 4;
    problem.soft = rows(4, &[&[(0, 1.0)], &[(3, 1.0)]]).to_csr();
    assert_eq!(analysis.factor(&problem).err(), Some(KktError::PatternChanged { block: "M" }));
}

#[test]
fn empty_problems_have_empty_solutions() {
    let problem = LeastSquares { columns: 0, soft: rows(0, &[]).to_csr(), hard: rows(0, &[]).to_csr() };
    assert_eq!(solve(&problem, &[], &[]).expect("nothing to solve").x, Vec::<f64>::new());
}
