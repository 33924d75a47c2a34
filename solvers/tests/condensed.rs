//! Paths condensed to their constrained points have the minimisers and energies of all their points.

use cotillion_solvers::workload::{Workload, relay_chain};
use cotillion_solvers::{
    ChainRow, ChainSystem, ChainWorkspace, Dependency, KktError, KktForm, LeastSquares, PointRow, RowMatrix,
    RowTargets, SolveReport, analyse, analyse_rank, c64, condense, shape_rows, solve,
};
use paths::{ONE, ROUNDING, number, probes, rows, second_differences, wavy_path};
use proptest::prelude::*;

mod paths;

/// Reference values carry 16 digits, and positions are below 100.
const REFERENCE_TOLERANCE: f64 = 1e-10;
/// Positions reach 1 500 and add up over a thousand paths.
const LONG_CHAIN_TOLERANCE: f64 = 1e-6;

/// Rows of an end, and fourth differences of a cubic, sum a few values of size one, each off by some roundings.
const FEW_ROUNDINGS: f64 = 1e-12;
/// Energies of the full problem are sums over 200 000 rows whose residuals carry about 10 digits.
const ENERGY_TOLERANCE: f64 = 1e-8;

/// A path system, with targets, as the full problem over all points sees it.
struct System {
    paths: Vec<Vec<ChainRow>>,
    row_targets: Vec<Vec<c64>>,
    point_rows: Vec<PointRow<c64>>,
    point_targets: Vec<c64>,
}

impl System {
    fn of_workload(workload: Workload) -> Self {
        let paths: Vec<_> = workload.paths.iter().map(|path| shape_rows(path)).collect();
        let row_targets = paths.iter().map(|rows| vec![c64::default(); rows.len()]).collect();
        Self { paths, row_targets, point_rows: workload.rows, point_targets: workload.targets }
    }

    fn blank_points(&self) -> Vec<Vec<c64>> {
        self.paths.iter().map(|rows| vec![c64::default(); rows.len() + 2]).collect()
    }

    fn condensed(&self, row_targets: RowTargets) -> Result<(SolveReport, Vec<Vec<c64>>), KktError> {
        let system = ChainSystem::new(&self.paths, &self.point_rows, row_targets)?;
        let factor = analyse(system.problem(), KktForm::Hachtel)?.factor(system.problem())?;
        let mut workspace = system.workspace(&factor);
        let row_targets = if row_targets == RowTargets::Zero { &[] } else { self.row_targets.as_slice() };
        let report = system.solve_into(&factor, &self.point_targets, row_targets, &mut workspace)?;
        let mut points = self.blank_points();
        system.expand(&workspace, &mut points)?;
        Ok((report, points))
    }

    fn full(&self) -> Result<(SolveReport, Vec<Vec<c64>>), KktError> {
        let (problem, m, h) = self.full_problem();
        let solution = solve(&problem, &m, &h)?;
        let mut rest = solution.x.as_slice();
        let mut points = self.blank_points();
        for path in &mut points {
            let (own, others) = rest.split_at(path.len());
            path.copy_from_slice(own);
            rest = others;
        }
        Ok((solution.report, points))
    }

    fn full_problem(&self) -> (LeastSquares<c64>, Vec<c64>, Vec<c64>) {
        let mut starts = vec![0];
        self.paths.iter().for_each(|rows| starts.push(starts[starts.len() - 1] + rows.len() + 2));
        let columns = starts[self.paths.len()];
        let (mut soft, mut hard) = (RowMatrix::new(columns), RowMatrix::new(columns));
        let (mut m, mut h) = (Vec::new(), Vec::new());
        for ((rows, targets), start) in self.paths.iter().zip(&self.row_targets).zip(&starts) {
            for (r, (row, target)) in rows.iter().zip(targets).enumerate() {
                soft.push_row(&[0, 1, 2].map(|k: usize| (start + r + k, row[k])));
                m.push(*target);
            }
        }
        for (row, &target) in self.point_rows.iter().zip(&self.point_targets) {
            let root = row.weight.map_or(1.0, f64::sqrt);
            let terms: Vec<_> = row.terms.iter().map(|&(p, i, a)| (starts[p] + i, a * root)).collect();
            let (rows, goals) = if row.weight.is_some() { (&mut soft, &mut m) } else { (&mut hard, &mut h) };
            rows.push_row(&terms);
            goals.push(target * root);
        }
        (LeastSquares { columns, soft: soft.to_csr(), hard: hard.to_csr() }, m, h)
    }
}

fn farthest(a: &[Vec<c64>], b: &[Vec<c64>]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[test]
fn ten_condensed_paths_match_the_reference() {
    let (report, points) =
        System::of_workload(relay_chain(10)).condensed(RowTargets::Zero).expect("four pins hold the chain");
    let reference = c64::new(5.813_551_112_688_542, 2.769_720_488_645_895_7);
    assert!((points[5][100] - reference).norm() < REFERENCE_TOLERANCE);
    let reference = c64::new(0.104_599_182_720_965_8, 0.082_369_634_562_799_6);
    assert!((points[0][5] - reference).norm() < REFERENCE_TOLERANCE);
    assert!(report.hard_residual < FEW_ROUNDINGS);
}

#[test]
fn seventy_eight_condensed_paths_match_the_reference() {
    let (_, points) =
        System::of_workload(relay_chain(78)).condensed(RowTargets::Zero).expect("four pins hold the chain");
    let reference = c64::new(58.998_429_613_471_06, 9.413_471_960_046_654);
    assert!((points[39][100] - reference).norm() < REFERENCE_TOLERANCE);
    let reference = c64::new(0.092_148_887_768_899_7, 0.069_138_873_359_794_5);
    assert!((points[0][5] - reference).norm() < REFERENCE_TOLERANCE);
}

#[test]
fn thousand_condensed_paths_agree_with_all_their_points() {
    let system = System::of_workload(relay_chain(1000));
    let (report, points) = system.condensed(RowTargets::Zero).expect("four pins hold the chain");
    let (full_report, full_points) = system.full().expect("four pins hold the chain");
    assert!(farthest(&points, &full_points) < LONG_CHAIN_TOLERANCE);
    assert!((report.energy / full_report.energy - 1.0).abs() < ENERGY_TOLERANCE);
}

#[test]
fn zero_targets_given_or_not_are_the_same() {
    let system = System::of_workload(relay_chain(10));
    let (_, silent) = system.condensed(RowTargets::Zero).expect("four pins hold the chain");
    let (_, given) = system.condensed(RowTargets::PerSolve).expect("four pins hold the chain");
    assert_eq!(silent, given);
}

/// Large enough to be spread over threads.
#[test]
fn bytes_do_not_depend_on_the_number_of_threads() {
    let system = System::of_workload(relay_chain(200));
    let on_threads = |count| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads start");
        pool.install(|| system.condensed(RowTargets::PerSolve)).expect("four pins hold the chain").1
    };
    assert_eq!(on_threads(1), on_threads(3));
}

#[test]
fn solves_with_other_targets_in_between_repeat_to_the_last_bit() {
    let workload = relay_chain(10);
    let dragged = workload.dragged(3).0;
    let System { paths, point_rows, point_targets, .. } = System::of_workload(workload);
    let system = ChainSystem::new(&paths, &point_rows, RowTargets::Zero).expect("rows are finite");
    let analysis = analyse(system.problem(), KktForm::Hachtel).expect("shapes fit");
    let factor = analysis.factor(system.problem()).expect("four pins hold the chain");
    let mut workspace = system.workspace(&factor);
    let solve_and_expand = |targets: &[c64], workspace: &mut ChainWorkspace| {
        let mut points: Vec<_> = paths.iter().map(|rows| vec![ONE; rows.len() + 2]).collect();
        system.solve_into(&factor, targets, &[], workspace).expect("four pins hold the chain");
        system.expand(workspace, &mut points).expect("shapes fit");
        points
    };
    let first = solve_and_expand(&point_targets, &mut workspace);
    assert!(farthest(&first, &solve_and_expand(&dragged, &mut workspace)) > 0.01);
    assert_eq!(first, solve_and_expand(&point_targets, &mut workspace));
}

/// Targets of every row of a path that are met by itself.
fn values_of_rows(rows: &[ChainRow], points: &[c64]) -> Vec<c64> {
    rows.iter().zip(points.windows(3)).map(|(row, p)| row[0] * p[0] + row[1] * p[1] + row[2] * p[2]).collect()
}

#[test]
fn condensed_second_differences_have_cubic_interiors() {
    let (count, wobble) = (200, |i: usize| c64::new((0.3 * i as f64).sin(), (0.7 * i as f64).cos()));
    let rows = second_differences(count - 2);
    let sums: Vec<c64> = (0..count).map(|i| wobble(i) * 0.1 * i as f64).collect();
    let system = System {
        row_targets: vec![values_of_rows(&rows, &sums)],
        paths: vec![rows],
        point_rows: [20, 21, 90, 150, 151].map(|i| PointRow::hard(vec![(0, i, ONE)])).to_vec(),
        point_targets: [3.0, 2.9, 4.0, 1.0, 2.0].map(|x| c64::new(x, 1.0 - x)).to_vec(),
    };
    let (_, points) = system.condensed(RowTargets::PerSolve).expect("pins hold the path");
    let q: Vec<c64> = points[0].iter().zip(&sums).map(|(p, sum)| p - sum).collect();
    let size = q.iter().map(|q| q.norm()).fold(0.0, f64::max);
    let inside =
        |start: usize| start + 4 <= 20 + 1 || (20..=86).contains(&start) || (90..=147).contains(&start);
    for (start, w) in q.windows(5).enumerate().filter(|&(start, _)| inside(start)) {
        let fourth = w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4];
        assert!(fourth.norm() < FEW_ROUNDINGS * size, "fourth difference {fourth} at {start}");
    }
}

#[test]
fn extended_ends_meet_their_rows() {
    let path = wavy_path(60);
    let rows = shape_rows(&path);
    let targets: Vec<c64> = (0..58).map(|i| c64::new(0.01 * i as f64, -0.1)).collect();
    let system = System {
        paths: vec![rows.clone()],
        row_targets: vec![targets.clone()],
        point_rows: [30, 40].map(|i| PointRow::hard(vec![(0, i, ONE)])).to_vec(),
        point_targets: vec![ONE, 3.0 * ONE],
    };
    let (_, points) = system.condensed(RowTargets::PerSolve).expect("two pins fix a similarity");
    for (row, (value, target)) in values_of_rows(&rows, &points[0]).iter().zip(&targets).enumerate() {
        let free = !(30..41).contains(&row);
        assert!(!free || (value - target).norm() < FEW_ROUNDINGS, "row {row} of a free end");
    }
}

/// Row 25 without its last coefficient says nothing about where the path goes on.
#[test]
fn ends_that_rows_leave_free_are_refused() {
    let mut rows = shape_rows(&wavy_path(30));
    rows[25][2] = c64::default();
    let point_rows = [10, 18].map(|i| PointRow::hard(vec![(0, i, ONE)])).to_vec();
    let system =
        System { row_targets: vec![vec![]], paths: vec![rows], point_rows, point_targets: vec![ONE; 2] };
    assert_eq!(
        system.condensed(RowTargets::Zero).expect_err("points after it outnumber rows"),
        KktError::Singular
    );
}

#[test]
fn repeated_hard_rows_are_refused_and_named_by_rank() {
    let mut system = System::of_workload(relay_chain(3));
    system.point_rows.push(system.point_rows[5].clone());
    system.point_targets.push(system.point_targets[5]);
    assert_eq!(system.condensed(RowTargets::Zero).expect_err("a copy"), KktError::Singular);
    let reduced =
        ChainSystem::new(&system.paths, &system.point_rows, RowTargets::Zero).expect("points differ");
    let dependent = analyse_rank(&reduced.problem().hard).dependent;
    assert_eq!(dependent.iter().map(Dependency::certificate).collect::<Vec<_>>(), vec![vec![1, 4]]);
}

#[test]
fn paths_that_nothing_holds_are_refused() {
    let mut system = System::of_workload(relay_chain(3));
    system.point_rows.truncate(1);
    system.point_targets.truncate(1);
    assert_eq!(system.condensed(RowTargets::Zero).expect_err("free paths"), KktError::Singular);
}

#[test]
fn rows_that_are_not_finite_are_refused() {
    let mut system = System::of_workload(relay_chain(3));
    system.paths[1][7][2].re = f64::NAN;
    let row = system.paths[0].len() + 7;
    assert_eq!(
        system.condensed(RowTargets::Zero).expect_err("not a number"),
        KktError::NotFinite { block: "M", row }
    );
}

proptest! {
    /// Kept sets of every kind: neighbours, overlapping stencils, points at the ends.
    #[test]
    fn condensed_minimisers_are_those_of_all_points(
        paths in prop::collection::vec(rows(0..30), 1..4),
        touched in prop::collection::vec((0..4_usize, 0..32_usize, number(), any::<bool>()), 8..16),
        ties in prop::collection::vec((0..32_usize, 0..32_usize, number(), number()), 0..3),
    ) {
        let (paths, row_targets): (Vec<_>, Vec<_>) = paths.into_iter().unzip();
        let mut system = System { paths, row_targets, point_rows: Vec::new(), point_targets: Vec::new() };
        for (path, point, target, stencil) in touched {
            let path = path % system.paths.len();
            let count = system.paths[path].len() + 2;
            let point = point % count;
            let mut terms = vec![(path, point, ONE)];
            if stencil && (1..count - 1).contains(&point) {
                terms = vec![(path, point - 1, -ONE), (path, point + 1, ONE)];
            }
            system.point_rows.push(PointRow::soft(terms, 0.5));
            system.point_targets.push(target);
        }
        for (k, (i, j, coefficient, target)) in ties.into_iter().enumerate() {
            let last = system.paths.len() - 1;
            let (i, j) = (i % (system.paths[0].len() + 2), j % (system.paths[last].len() + 2));
            system.point_rows.push(PointRow::hard(vec![(0, i, ONE), (last, j, coefficient)]));
            system.point_targets.push(target * (k + 1) as f64);
        }
        let full = system.full();
        prop_assume!(full.is_ok()); // held points, independent ties
        let (report, points) = full.expect("assumed");
        prop_assume!(points.iter().flatten().all(|p| p.norm() < 100.0)); // and not barely so
        let (condensed_report, condensed_points) = system.condensed(RowTargets::PerSolve).expect("has a solution");
        let error = farthest(&points, &condensed_points);
        prop_assert!(error < 100.0 * ROUNDING, "points differ by {error:e}");
        prop_assert!((report.energy - condensed_report.energy).abs() < ROUNDING * (1.0 + report.energy));
    }

    #[test]
    fn condensed_energy_is_the_minimum_over_inner_points((rows, targets) in rows(1..60), probes in probes()) {
        let piece = condense(&rows, &targets).expect("no point is free");
        let (first, last) = (0, rows.len());
        for probe in probes {
            let mut pins =
                vec![(first, probe[0]), (first + 1, probe[1]), (last, probe[2]), (last + 1, probe[3])];
            pins.dedup_by_key(|pin| pin.0);
            let point_rows = pins.iter().map(|pin| PointRow::hard(vec![(0, pin.0, ONE)])).collect();
            let point_targets = pins.iter().map(|pin| pin.1).collect();
            let system = System {
                paths: vec![rows.clone()], row_targets: vec![targets.clone()], point_rows, point_targets,
            };
            let full = system.full().expect("pins hold both ends").0.energy;
            prop_assert!((piece.energy(probe) - full).abs() < ROUNDING * (1.0 + full));
        }
    }
}
