//! Sparse solutions match dense ones by complete pivoting, and meet the conditions of a minimum.

use cotillion_solvers::{DMatrix, DVector, KktForm, LeastSquares, RowMatrix, analyse};
use proptest::prelude::*;

const COLUMNS: usize = 8;
/// Random rows have entries below 2 and conditions below about 1e4.
const ROUNDING: f64 = 1e-9;

type Row = Vec<(usize, f64)>;

fn row() -> impl Strategy<Value = Row> {
    prop::collection::vec((0..COLUMNS, -2.0..2.0_f64), 1..4)
}

fn assemble(rows: &[Row]) -> (RowMatrix<f64>, DMatrix<f64>) {
    let mut sparse = RowMatrix::new(COLUMNS);
    let mut dense = DMatrix::zeros(rows.len(), COLUMNS);
    for (i, row) in rows.iter().enumerate() {
        sparse.push_row(row);
        row.iter().for_each(|&(j, a)| dense[(i, j)] += a);
    }
    (sparse, dense)
}

/// Minimiser by complete pivoting on the dense system of normal equations and hard rows.
fn dense_minimiser(m: (&DMatrix<f64>, &DVector<f64>), h: (&DMatrix<f64>, &DVector<f64>)) -> DVector<f64> {
    let size = COLUMNS + h.0.nrows();
    let mut kkt = DMatrix::zeros(size, size);
    kkt.view_mut((0, 0), (COLUMNS, COLUMNS)).copy_from(&(m.0.transpose() * m.0));
    kkt.view_mut((COLUMNS, 0), h.0.shape()).copy_from(h.0);
    kkt.view_mut((0, COLUMNS), (COLUMNS, h.0.nrows())).copy_from(&h.0.transpose());
    let mut b = DVector::zeros(size);
    b.rows_mut(0, COLUMNS).copy_from(&(m.0.transpose() * m.1));
    b.rows_mut(COLUMNS, h.0.nrows()).copy_from(h.1);
    kkt.full_piv_lu().solve(&b).expect("hard rows are independent").rows(0, COLUMNS).into_owned()
}

proptest! {
    #[test]
    fn sparse_minimisers_match_dense_ones(
        extra in prop::collection::vec(row(), 0..8),
        hard in prop::collection::vec(row(), 1..4),
        soft_targets in prop::collection::vec(-3.0..3.0_f64, 2 * COLUMNS),
        hard_targets in prop::collection::vec(-3.0..3.0_f64, 3),
    ) {
        // A weak row for each unknown makes the minimiser unique.
        let soft: Vec<Row> = (0..COLUMNS).map(|j| vec![(j, 0.3)]).chain(extra).collect();
        let (soft_rows, soft_dense) = assemble(&soft);
        let (hard_rows, hard_dense) = assemble(&hard);
        let condition = hard_dense.clone().svd(false, false).singular_values;
        prop_assume!(condition.min() > 1e-2 * condition.max()); // independent hard rows
        let (m, h) = (&soft_targets[..soft.len()], &hard_targets[..hard.len()]);
        let (m_vector, h_vector) = (DVector::from_column_slice(m), DVector::from_column_slice(h));
        let expected = dense_minimiser((&soft_dense, &m_vector), (&hard_dense, &h_vector));
        let problem = LeastSquares { columns: COLUMNS, soft: soft_rows.to_csr(), hard: hard_rows.to_csr() };
        for form in [KktForm::Hachtel, KktForm::NormalEquations] {
            let factor = analyse(&problem, form).and_then(|a| a.factor(&problem)).expect("rows are independent");
            let solution = factor.solve(m, h).expect("rows are independent");
            let x = DVector::from_column_slice(&solution.x);
            prop_assert!((&x - &expected).amax() < ROUNDING);
            prop_assert!((&hard_dense * &x - &h_vector).amax() < 1e-12 * (1.0 + x.amax()));
            let lambda = DVector::from_column_slice(&solution.multipliers);
            let gradient = soft_dense.transpose() * (&m_vector - &soft_dense * &x) - hard_dense.transpose() * lambda;
            prop_assert!(gradient.amax() < 1e-11 * (1.0 + x.amax()));
            let energy = problem.energy(&solution.x, m);
            prop_assert!((solution.report.energy - energy).abs() < 1e-10 * (1.0 + energy));
        }
    }
}
