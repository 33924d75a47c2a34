//! Bounds on steps: reference cases of warped times, and random programs against a search over all active sets.

use cotillion_solvers::{
    BoundMethod, BoundedQp, BoundedSolution, BoundsError, DMatrix, DVector, solve_bounded,
};
use proptest::prelude::*;

/// A program under construction: `½ w (a x − b)²` and rows with two bounds.
struct Program {
    qp: BoundedQp,
}

impl Program {
    fn new(unknowns: usize) -> Self {
        let rows = DMatrix::zeros(0, unknowns);
        Self {
            qp: BoundedQp {
                hessian: DMatrix::zeros(unknowns, unknowns),
                linear: DVector::zeros(unknowns),
                equalities: rows.clone(),
                equality_targets: DVector::zeros(0),
                inequalities: rows,
                lower_bounds: DVector::zeros(0),
            },
        }
    }

    fn row(&self, terms: &[(usize, f64)]) -> DVector<f64> {
        let mut row = DVector::zeros(self.qp.linear.len());
        terms.iter().for_each(|&(j, a)| row[j] += a);
        row
    }

    fn soft(&mut self, weight: f64, terms: &[(usize, f64)], target: f64) {
        let a = self.row(terms);
        self.qp.hessian += weight * &a * a.transpose();
        self.qp.linear += weight * target * a;
    }

    fn hard(&mut self, terms: &[(usize, f64)], target: f64) {
        let a = self.row(terms);
        push(&mut self.qp.equalities, &mut self.qp.equality_targets, &a, target);
    }

    fn between(&mut self, terms: &[(usize, f64)], lower: f64, upper: f64) {
        let a = self.row(terms);
        push(&mut self.qp.inequalities, &mut self.qp.lower_bounds, &a, lower);
        push(&mut self.qp.inequalities, &mut self.qp.lower_bounds, &-a, -upper);
    }

    /// Rest energy and bounds of `n` steps of length h between two instants, condensed to these.
    fn steps(&mut self, from: usize, to: usize, n: f64, (h, lower, upper): (f64, f64, f64)) {
        self.soft(1.0 / n, &[(from, -1.0), (to, 1.0)], n * h);
        self.between(&[(from, -1.0), (to, 1.0)], n * lower, n * upper);
    }
}

fn push(matrix: &mut DMatrix<f64>, targets: &mut DVector<f64>, row: &DVector<f64>, target: f64) {
    let rows = matrix.nrows();
    *matrix = matrix.clone().insert_row(rows, 0.0);
    matrix.row_mut(rows).copy_from(&row.transpose());
    *targets = targets.clone().push(target);
}

/// Two tracks of 60 and 80 instants, 1/30 s apart at rest, tied at instants 30 = 40 and 59 = 79, the end drawn to 4 s.
/// Unknowns: a0, a30, a59, b0, b40, b79.
fn two_tracks(lower: f64, upper: f64) -> Program {
    let h = 1.0 / 30.0;
    let mut program = Program::new(6);
    for (from, to, n) in [(0, 1, 30.0), (1, 2, 29.0), (3, 4, 40.0), (4, 5, 39.0)] {
        program.steps(from, to, n, (h, lower * h, upper * h));
    }
    program.soft(1.0, &[(2, 1.0)], 4.0);
    program.hard(&[(0, 1.0)], 0.0);
    program.hard(&[(3, 1.0)], 0.0);
    program.hard(&[(1, 1.0), (4, -1.0)], 0.0);
    program.hard(&[(2, 1.0), (5, -1.0)], 0.0);
    program
}

/// `½ Σ w (target)²`, the part of the energy that the objective leaves out, for [`two_tracks`].
const TWO_TRACKS_CONSTANT: f64 = 0.5 * (138.0 / 900.0 + 16.0);

#[test]
fn tied_tracks_stretch_to_their_bounds() {
    let program = two_tracks(0.5, 1.5);
    let solution = solve_bounded(&program.qp, BoundMethod::DualActiveSet).expect("feasible");
    assert!((solution.x[1] - 1.5).abs() < 1e-12 && (solution.x[2] - 2.95).abs() < 1e-12);
    let energy = program.qp.objective(&solution.x) + TWO_TRACKS_CONSTANT;
    assert!((energy / 0.560_080_128_205_128 - 1.0).abs() < 1e-12);
    let mut active = solution.active;
    active.sort_unstable();
    assert_eq!(active, vec![1, 3], "both pieces of the shorter track are as slow as they may be");
}

#[test]
fn paper_iteration_contradicts_the_ties() {
    let program = two_tracks(0.5, 1.5);
    let Err(BoundsError::Infeasible { row, certificate, .. }) =
        solve_bounded(&program.qp, BoundMethod::PaperIteration)
    else {
        panic!("the rows clamped at once contradict the ties")
    };
    assert_eq!((row, certificate), (5, vec![1]));
}

#[test]
fn loose_bounds_change_nothing() {
    let program = two_tracks(0.1, 10.0);
    let solution = solve_bounded(&program.qp, BoundMethod::DualActiveSet).expect("feasible");
    assert!((solution.x[1] - 2.004_712_136_772_576).abs() < 1e-12);
    assert!((solution.x[2] - 3.949_725_125_354_907).abs() < 1e-12);
    assert_eq!((solution.active.len(), solution.iterations), (0, 0));
    let energy = program.qp.objective(&solution.x) + TWO_TRACKS_CONSTANT;
    assert!((energy / 0.045_558_911_778_328_13 - 1.0).abs() < 1e-10); // cancels two digits
}

/// Four instants 1 apart at rest, two of their differences drawn to where bounds forbid.
fn four_instants() -> Program {
    let mut program = Program::new(4);
    (0..3).for_each(|i| program.steps(i, i + 1, 1.0, (1.0, 0.5, 1.5)));
    program.hard(&[(0, 1.0)], 0.0);
    program.soft(9.0, &[(0, -1.0), (2, 1.0)], 5.5);
    program.soft(100.0, &[(1, -1.0), (3, 1.0)], 0.5);
    program
}

#[test]
fn paper_iteration_stops_short_of_the_optimum() {
    let program = four_instants();
    let constant = 0.5 * (3.0 + 9.0 * 5.5 * 5.5 + 100.0 * 0.25);
    let reached = |solution: &BoundedSolution, x: [f64; 4], energy: f64| {
        assert!(solution.x.iter().zip(x).all(|(a, b)| (a - b).abs() < 1e-12), "{solution:?}");
        assert!((program.qp.objective(&solution.x) + constant - energy).abs() < 1e-10);
    };
    let best = solve_bounded(&program.qp, BoundMethod::DualActiveSet).expect("feasible");
    reached(&best, [0.0, 1.5, 2.0, 2.5], 68.0);
    let clamped = solve_bounded(&program.qp, BoundMethod::PaperIteration).expect("clamped rows agree");
    reached(&clamped, [0.0, 1.5, 3.0, 3.5], 141.0);
    assert!(clamped.multipliers.iter().any(|&u| u < 0.0), "a clamped row wants to be released");
}

#[test]
fn contradicting_bounds_name_each_other() {
    let mut program = four_instants();
    program.hard(&[(0, -1.0), (3, 1.0)], 5.0);
    let Err(BoundsError::Infeasible { row, mut certificate, equalities, violation }) =
        solve_bounded(&program.qp, BoundMethod::DualActiveSet)
    else {
        panic!("three steps of at most 1.5 do not make 5")
    };
    certificate.push(row);
    certificate.sort_unstable();
    assert_eq!((certificate, equalities), (vec![1, 3, 5], vec![1]));
    assert!((violation - 0.5).abs() < 1e-9);
}

#[test]
fn spoilt_programs_are_refused() {
    let mut program = four_instants();
    program.qp.linear[2] = f64::NAN;
    let refused = |program: &Program| solve_bounded(&program.qp, BoundMethod::DualActiveSet).err();
    assert_eq!(refused(&program), Some(BoundsError::NotFinite { block: "g", row: 2 }));
    let mut program = four_instants();
    program.hard(&[(0, 1.0)], 0.0);
    assert_eq!(refused(&program), Some(BoundsError::Singular));
    let mut program = four_instants();
    program.qp.lower_bounds = DVector::zeros(2);
    assert!(matches!(refused(&program), Some(BoundsError::ShapeMismatch { block: "C", rows: 2, .. })));
}

/// By how much the search may miss a row.
const SLACK: f64 = 1e-8;

/// Best point over all sets of rows held with equality: slow, and nothing like the method under test.
fn search(qp: &BoundedQp) -> Option<Vec<f64>> {
    let (n, rows) = (qp.linear.len(), qp.inequalities.nrows());
    let candidates = (0..1_u32 << rows).filter_map(|set| {
        let held: Vec<usize> = (0..rows).filter(|k| set >> k & 1 == 1).collect();
        let size = n + held.len();
        let mut kkt = DMatrix::zeros(size, size);
        kkt.view_mut((0, 0), (n, n)).copy_from(&qp.hessian);
        let mut b = DVector::zeros(size);
        b.rows_mut(0, n).copy_from(&qp.linear);
        for (k, &row) in held.iter().enumerate() {
            kkt.view_mut((n + k, 0), (1, n)).copy_from(&qp.inequalities.row(row));
            kkt.view_mut((0, n + k), (n, 1)).copy_from(&qp.inequalities.row(row).transpose());
            b[n + k] = qp.lower_bounds[row];
        }
        let x = kkt.full_piv_lu().solve(&b)?.rows(0, n).into_owned();
        let slack = &qp.inequalities * &x - &qp.lower_bounds;
        slack.iter().all(|&s| s > -SLACK).then(|| x.as_slice().to_vec())
    });
    candidates.min_by(|a, b| qp.objective(a).total_cmp(&qp.objective(b)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn active_sets_match_a_search_over_all(
        factor in prop::collection::vec(-1.0..1.0_f64, 9),
        linear in prop::collection::vec(-5.0..5.0_f64, 3),
        rows in prop::collection::vec((prop::collection::vec(-1.0..1.0_f64, 3), -2.0..1.0_f64), 1..8),
    ) {
        let factor = DMatrix::from_vec(3, 3, factor);
        let mut program = Program::new(3);
        program.qp.hessian = &factor * factor.transpose() + DMatrix::identity(3, 3) * 0.1;
        program.qp.linear = DVector::from_vec(linear);
        for (row, bound) in &rows {
            let row = DVector::from_column_slice(row);
            prop_assume!(row.norm() > 0.1);
            push(&mut program.qp.inequalities, &mut program.qp.lower_bounds, &row, *bound);
        }
        match solve_bounded(&program.qp, BoundMethod::DualActiveSet) {
            Ok(solution) => {
                let best = search(&program.qp).expect("a feasible point was found");
                let difference = program.qp.objective(&solution.x) - program.qp.objective(&best);
                // Where the search oversteps rows by its slack, it gains the slack times their multipliers.
                let forces = 1.0 + solution.multipliers.iter().sum::<f64>();
                prop_assert!(difference < 2.0 * SLACK * forces, "off by {difference:e}");
                prop_assert!(solution.multipliers.iter().all(|&u| u >= 0.0));
                let slack = &program.qp.inequalities * DVector::from_vec(solution.x) - &program.qp.lower_bounds;
                prop_assert!(slack.iter().all(|&s| s > -SLACK));
            }
            Err(BoundsError::Infeasible { .. }) => prop_assert_eq!(search(&program.qp), None),
            Err(other) => prop_assert!(false, "{other}"),
        }
    }
}
