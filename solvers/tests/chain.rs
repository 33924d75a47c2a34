//! A chain of planar paths, tied end to end by hard rows and drawn by four soft pins, is solved to reference values that
//! were computed in extended precision.

use cotillion_solvers::{KktForm, LeastSquares, RowMatrix, analyse, c64, solve};

/// Samples of each path.
const SAMPLES: usize = 200;

fn rest_path(c: f64) -> Vec<c64> {
    let point =
        |t: f64| c64::new(1.5 * c + 3.0 * t, 0.3 * (9.0 * t + c).sin() + 0.2 * c + 0.01 * (37.0 * t).sin());
    (0..SAMPLES).map(|i| point(i as f64 / SAMPLES as f64)).collect()
}

/// Rows with their targets.
struct Rows(RowMatrix<c64>, Vec<c64>);

impl Rows {
    fn push(&mut self, terms: &[(usize, c64)], target: c64) {
        self.0.push_row(terms);
        self.1.push(target);
    }
}

/// Soft and hard rows of a chain of `count` paths; unknown `200 c + i` is sample i of path c.
fn chain(count: usize) -> (Rows, Rows) {
    let one = c64::new(1.0, 0.0);
    let zero = c64::default();
    let mut soft = Rows(RowMatrix::new(count * SAMPLES), Vec::new());
    let mut hard = Rows(RowMatrix::new(count * SAMPLES), Vec::new());
    let paths: Vec<_> = (0..count).map(|c| rest_path(c as f64)).collect();
    for (c, p) in paths.iter().enumerate() {
        for i in 1..SAMPLES - 1 {
            let z = (p[i] - p[i - 1]) / (p[i + 1] - p[i - 1]);
            let at = c * SAMPLES + i;
            soft.push(&[(at, one), (at - 1, z - one), (at + 1, -z)], zero);
        }
    }
    let pins = [
        (0, 0, zero),
        (count - 1, SAMPLES - 1, c64::new(2.0, 3.0)),
        (count / 2, SAMPLES / 3, c64::new(0.0, 2.0)),
        (0, 2 * SAMPLES / 3, c64::new(0.2, 0.1)),
    ];
    for (c, i, offset) in pins {
        soft.push(&[(c * SAMPLES + i, one)], paths[c][i] + offset);
    }
    let ahead = c64::new(0.3, 1.2);
    for c in 0..count - 1 {
        let (i, j) = ((c + 1) * SAMPLES + SAMPLES / 4, c * SAMPLES + 3 * SAMPLES / 4);
        hard.push(&[(i, one), (j, -one), (j + 1, -ahead), (j - 1, ahead)], zero);
        hard.push(&[(i + 1, one), (i - 1, -one), (j + 1, one), (j - 1, -one)], zero);
    }
    (soft, hard)
}

fn problem_of(soft: &Rows, hard: &Rows) -> LeastSquares<c64> {
    LeastSquares { columns: soft.0.columns(), soft: soft.0.to_csr(), hard: hard.0.to_csr() }
}

/// Each complex row as its two real parts; unknowns `2k`, `2k + 1` are the parts of unknown k.
fn stacked(rows: &Rows) -> (RowMatrix<f64>, Vec<f64>) {
    let mut real = RowMatrix::new(2 * rows.0.columns());
    for row in rows.0.to_csr().outer_iterator() {
        let re: Vec<_> = row.iter().flat_map(|(j, a)| [(2 * j, a.re), (2 * j + 1, -a.im)]).collect();
        let im: Vec<_> = row.iter().flat_map(|(j, a)| [(2 * j, a.im), (2 * j + 1, a.re)]).collect();
        real.push_row(&re);
        real.push_row(&im);
    }
    (real, rows.1.iter().flat_map(|b| [b.re, b.im]).collect())
}

/// Reference values carry 16 digits, and positions are below 100.
const TOLERANCE: f64 = 1e-10;

#[test]
fn ten_paths_match_the_reference() {
    let (soft, hard) = chain(10);
    let solution = solve(&problem_of(&soft, &hard), &soft.1, &hard.1).expect("four pins hold the chain");
    let reference = c64::new(5.813_551_112_688_542, 2.769_720_488_645_895_7);
    assert!((solution.x[5 * SAMPLES + 100] - reference).norm() < TOLERANCE);
    let reference = c64::new(0.104_599_182_720_965_8, 0.082_369_634_562_799_6);
    assert!((solution.x[5] - reference).norm() < TOLERANCE);
    assert!(solution.report.hard_residual < 1e-12 && solution.report.relative_residual < 1e-12);
}

#[test]
fn seventy_eight_paths_match_the_reference() {
    let (soft, hard) = chain(78);
    let solution = solve(&problem_of(&soft, &hard), &soft.1, &hard.1).expect("four pins hold the chain");
    let reference = c64::new(58.998_429_613_471_06, 9.413_471_960_046_654);
    assert!((solution.x[39 * SAMPLES + 100] - reference).norm() < TOLERANCE);
    let reference = c64::new(0.092_148_887_768_899_7, 0.069_138_873_359_794_5);
    assert!((solution.x[5] - reference).norm() < TOLERANCE);
}

#[test]
fn stacked_real_form_agrees_with_the_complex_one() {
    let (soft, hard) = chain(10);
    let complex = solve(&problem_of(&soft, &hard), &soft.1, &hard.1).expect("four pins hold the chain");
    let ((m_rows, m), (h_rows, h)) = (stacked(&soft), stacked(&hard));
    let problem = LeastSquares { columns: m_rows.columns(), soft: m_rows.to_csr(), hard: h_rows.to_csr() };
    let real = solve(&problem, &m, &h).expect("the same problem");
    for (z, parts) in complex.x.iter().zip(real.x.chunks(2)) {
        assert!((z - c64::new(parts[0], parts[1])).norm() < TOLERANCE);
    }
    assert!((real.report.energy / complex.report.energy - 1.0).abs() < 1e-9);
}

#[test]
fn normal_equations_agree_to_their_poorer_accuracy() {
    let (soft, hard) = chain(10);
    let problem = problem_of(&soft, &hard);
    let exact = solve(&problem, &soft.1, &hard.1).expect("four pins hold the chain");
    let analysis = analyse(&problem, KktForm::NormalEquations).expect("shapes fit");
    let rough = analysis.factor(&problem).and_then(|f| f.solve(&soft.1, &hard.1)).expect("the same problem");
    let error = exact.x.iter().zip(&rough.x).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(error < 1e-6, "normal equations are off by {error:e}");
}

#[test]
fn runs_repeat_to_the_last_bit() {
    let (soft, hard) = chain(10);
    let problem = problem_of(&soft, &hard);
    let analysis = analyse(&problem, KktForm::Hachtel).expect("shapes fit");
    let factor = analysis.factor(&problem).expect("four pins hold the chain");
    let mut workspace = factor.workspace();
    let mut x = vec![c64::default(); problem.columns];
    let first = solve(&problem, &soft.1, &hard.1).expect("four pins hold the chain");
    let elsewhere: Vec<_> = soft.1.iter().map(|m| m * 2.0 + 1.0).collect();
    factor.solve_into(&elsewhere, &hard.1, &mut x, &mut workspace).expect("other targets");
    factor.solve_into(&soft.1, &hard.1, &mut x, &mut workspace).expect("the first targets again");
    assert_eq!(x, first.x);
    assert_eq!(workspace.multipliers(), first.multipliers);
}

#[test]
fn row_over_all_unknowns_is_solved_like_any_other() {
    let (soft, mut hard) = chain(10);
    let columns = soft.0.columns();
    let share = c64::new(1.0 / columns as f64, 0.0);
    let terms: Vec<_> = (0..columns).map(|j| (j, share)).collect();
    hard.push(&terms, c64::new(8.0, 3.0));
    let solution = solve(&problem_of(&soft, &hard), &soft.1, &hard.1).expect("a mean is no contradiction");
    let mean = solution.x.iter().sum::<c64>() * share;
    assert!((mean - c64::new(8.0, 3.0)).norm() < 1e-12);
    let problem = problem_of(&soft, &hard);
    let force = problem.soft_residual(&solution.x, &soft.1);
    let mut gradient = vec![c64::default(); columns];
    for (row, r) in problem.soft.outer_iterator().zip(&force) {
        row.iter().for_each(|(j, a)| gradient[j] += a.conj() * r);
    }
    for (row, lambda) in problem.hard.outer_iterator().zip(&solution.multipliers) {
        row.iter().for_each(|(j, a)| gradient[j] -= a.conj() * lambda);
    }
    assert!(gradient.iter().all(|g| g.norm() < 1e-12), "Mᴴ(m − M x) = Hᴴλ");
}
