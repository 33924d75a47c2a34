//! Spring problems without an answer end in an error, never in NaN; one plan serves all problems of its pattern.

use cotillion_solvers::{Bent, Compliance, KktError, PointRow, SolveReport, SpringPath, c64};

const ONE: c64 = c64::new(1.0, 0.0);

fn wave() -> SpringPath {
    SpringPath::of_shape((0..50).map(|i| c64::new(0.1 * f64::from(i), (0.2 * f64::from(i)).sin())).collect())
}

/// Two pins.
fn valid() -> Vec<PointRow<c64>> {
    vec![PointRow::hard(vec![(0, 3, ONE)]), PointRow::soft(vec![(0, 40, ONE)], 10.0)]
}

const TARGETS: [c64; 2] = [c64::new(0.0, 1.0), c64::new(4.0, 0.0)];

fn solve(path: SpringPath, rows: Vec<PointRow<c64>>, targets: &[c64]) -> Result<SolveReport, KktError> {
    let problem = Compliance::new(vec![path], rows);
    let factor = problem.analyse()?.factor(&problem)?;
    Bent::new(&problem, &factor).solve(&problem, &factor, targets)
}

#[test]
fn valid_problem_is_solved() {
    assert!(solve(wave(), valid(), &TARGETS).expect("two pins move a path").energy < 1e-20);
}

#[test]
fn numbers_that_are_none_are_refused() {
    for bad in [f64::NAN, f64::INFINITY] {
        let mut rows = valid();
        rows[1].terms[0].2 = c64::new(bad, 0.0);
        assert_eq!(solve(wave(), rows, &TARGETS), Err(KktError::NotFinite { block: "C", row: 1 }));
        let mut rows = valid();
        rows[1].weight = Some(bad);
        assert_eq!(solve(wave(), rows, &TARGETS), Err(KktError::NotFinite { block: "C", row: 1 }));
        let targets = [TARGETS[0], c64::new(0.0, bad)];
        assert_eq!(solve(wave(), valid(), &targets), Err(KktError::NotFinite { block: "d", row: 1 }));
        let SpringPath::Listed { mut points, compliances } = wave() else { unreachable!("a listed path") };
        points[7].im = bad;
        let path = SpringPath::Listed { points, compliances };
        assert_eq!(solve(path, valid(), &TARGETS), Err(KktError::NotFinite { block: "q", row: 0 }));
    }
    let mut rows = valid();
    rows[1].weight = Some(0.0);
    assert_eq!(solve(wave(), rows, &TARGETS), Err(KktError::NotFinite { block: "C", row: 1 }));
}

#[test]
fn hard_rows_that_depend_on_each_other_are_singular() {
    let mut rows = valid();
    rows.push(PointRow::hard(vec![(0, 3, ONE * 2.0)]));
    assert_eq!(solve(wave(), rows, &[TARGETS[0], TARGETS[1], ONE]), Err(KktError::Singular));
}

#[test]
fn wrong_numbers_of_targets_are_refused() {
    let expected = KktError::ShapeMismatch { block: "d", side: "rows", expected: 2, actual: 1 };
    assert_eq!(solve(wave(), valid(), &TARGETS[..1]), Err(expected));
}

#[test]
fn a_plan_serves_other_weights_and_coefficients_but_no_other_rows() {
    let first = Compliance::new(vec![wave()], valid());
    let plan = first.analyse().expect("sound");
    let mut rows = valid();
    rows[1] = PointRow::soft(vec![(0, 40, c64::new(0.5, 2.0))], 3.0);
    let other = Compliance::new(vec![wave()], rows.clone());
    let by_first_plan = plan.factor(&other).expect("the same pattern");
    let by_own_plan = other.analyse().expect("sound").factor(&other).expect("regular");
    let solved = |factor| {
        let mut bent = Bent::new(&other, factor);
        bent.solve(&other, factor, &TARGETS).expect("an answer");
        let mut points = Vec::new();
        bent.expand(&other, 0, |_, x, _| points.push(x));
        points
    };
    assert_eq!(solved(&by_first_plan), solved(&by_own_plan));
    rows.push(PointRow::soft(vec![(0, 9, ONE)], 1.0));
    let third = Compliance::new(vec![wave()], rows);
    assert_eq!(plan.factor(&third).err(), Some(KktError::PatternChanged { block: "C" }));
}

#[test]
fn paths_that_nothing_holds_stay_where_they_are() {
    let problem = Compliance::new(vec![wave(), SpringPath::even(9)], Vec::new());
    assert_eq!(problem.free_motions(), 4);
    let factor = problem.analyse().expect("sound").factor(&problem).expect("regular");
    let mut bent = Bent::new(&problem, &factor);
    bent.solve(&problem, &factor, &[]).expect("nothing to do");
    for path in 0..2 {
        bent.expand(&problem, path, |_, x, _| assert_eq!(x, c64::default()));
    }
}

#[test]
fn one_pin_moves_a_path_without_turning_it() {
    let problem = Compliance::new(vec![wave()], vec![PointRow::soft(vec![(0, 10, ONE)], 2.0)]);
    assert_eq!(problem.free_motions(), 1);
    let factor = problem.analyse().expect("sound").factor(&problem).expect("regular");
    let mut bent = Bent::new(&problem, &factor);
    let report = bent.solve(&problem, &factor, &[c64::new(0.5, -0.2)]).expect("a shift and a turn");
    assert!(report.energy < 1e-20);
    let mut sum = c64::default();
    bent.expand(&problem, 0, |j, x, _| {
        sum += x;
        if j == 10 {
            assert!((x - c64::new(0.5, -0.2)).norm() < 1e-12);
        }
    });
    // Of all similarities that put the pin in its place, this one moves all points together the least.
    let centre = problem_centre();
    let SpringPath::Listed { points, .. } = wave() else { unreachable!("a listed path") };
    let arm = points[10] - centre;
    let spread: f64 = points.iter().map(|q| (q - centre).norm_sqr()).sum();
    let turn = c64::new(0.5, -0.2) * arm.conj() / (spread / 50.0 + arm.norm_sqr());
    let shift = c64::new(0.5, -0.2) - turn * arm;
    assert!((sum / 50.0 - shift).norm() < 1e-12);
}

fn problem_centre() -> c64 {
    let SpringPath::Listed { points, .. } = wave() else { unreachable!("a listed path") };
    points.iter().sum::<c64>() / 50.0
}
