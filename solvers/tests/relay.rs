//! Chains of many paths and paths of many points bend to their reference values by the compliance form.

use cotillion_solvers::workload::{Workload, relay_chain};
use cotillion_solvers::{Bent, Compliance, PointRow, SpringPath, c64};
use full::solve_full;

mod full;

/// Claimed for chains of up to 78 paths, metres.
const SHORT_CHAIN: f64 = 1e-9;
/// Claimed for a chain of 1 000.
const LONG_CHAIN: f64 = 1e-6;
/// Claimed for one path of 20 000 points.
const LONG_PATH: f64 = 1e-7;
/// Printed energies, relative.
const ENERGY: f64 = 1e-9;

fn bend(workload: &Workload) -> (Vec<Vec<c64>>, f64) {
    let springs = workload.paths.iter().map(|path| SpringPath::of_shape(path.clone())).collect();
    let problem = Compliance::new(springs, workload.rows.clone());
    let factor = problem.analyse().expect("sound").factor(&problem).expect("regular");
    let mut bent = Bent::new(&problem, &factor);
    let report = bent.solve(&problem, &factor, &workload.targets).expect("an answer");
    let mut points = workload.paths.clone();
    for (path, points) in points.iter_mut().enumerate() {
        bent.expand(&problem, path, |j, x, _| points[j] = x);
    }
    (points, report.energy)
}

/// By the full system.
fn refined(workload: &Workload) -> Vec<c64> {
    solve_full(&workload.paths, &workload.rows, &workload.targets).x
}

fn assert_near(points: &[Vec<c64>], reference: &[c64], tolerance: f64) {
    let worst = points.iter().flatten().zip(reference).map(|(p, q)| (p - q).norm()).fold(0.0, f64::max);
    assert!(worst < tolerance, "off by {worst:e}");
}

#[test]
fn chains_of_ten_and_of_78_paths_have_their_printed_points() {
    let (ten, _) = bend(&relay_chain(10));
    assert!((ten[5][100] - c64::new(5.813_551_112_688_542, 2.769_720_488_645_896)).norm() < SHORT_CHAIN);
    assert!((ten[0][5] - c64::new(0.104_599_182_720_966, 0.082_369_634_562_8)).norm() < SHORT_CHAIN);
    let (many, _) = bend(&relay_chain(78));
    assert!((many[39][100] - c64::new(58.998_429_613_471_06, 9.413_471_960_046_653)).norm() < SHORT_CHAIN);
    assert!((many[0][5] - c64::new(0.092_148_887_768_9, 0.069_138_873_359_794)).norm() < SHORT_CHAIN);
}

#[test]
fn a_chain_of_a_thousand_paths_bends_as_the_refined_full_system() {
    let workload = relay_chain(1000);
    let (points, _) = bend(&workload);
    assert_near(&points, &refined(&workload), LONG_CHAIN);
}

/// A wave of `count` points, its middle drawn aside and its end to one and a half of its length: hard pins.
fn pulled_wave(count: usize) -> Workload {
    let path: Vec<c64> =
        (0..count).map(|i| c64::new(0.04 * i as f64, 0.3 * (0.06 * i as f64).sin())).collect();
    let pins = [
        (0, path[0]),
        (count / 2, path[count / 2] + c64::new(0.5, 1.0)),
        (count - 1, path[0] + 1.5 * (path[count - 1] - path[0])),
    ];
    Workload {
        name: String::new(),
        rows: pins.iter().map(|(j, _)| PointRow::hard(vec![(0, *j, c64::new(1.0, 0.0))])).collect(),
        targets: pins.iter().map(|(_, target)| *target).collect(),
        paths: vec![path],
        time_rows: Vec::new(),
        time_targets: Vec::new(),
        stands: Vec::new(),
        handle: (1, 0),
    }
}

#[test]
fn long_paths_have_their_printed_energies() {
    let printed =
        [(1_000, 6.039_057_600_016e-7), (4_000, 1.606_120_865_004e-7), (20_000, 3.274_114_518_57e-8)];
    for (count, expected) in printed {
        let workload = pulled_wave(count);
        let (points, energy) = bend(&workload);
        assert!((energy / expected - 1.0).abs() < ENERGY, "{count} points: {energy:e}");
        assert_near(&points, &refined(&workload), LONG_PATH);
    }
}

#[test]
fn points_do_not_depend_on_the_number_of_threads() {
    let workload = relay_chain(200);
    let bits = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let (points, energy) = pool.install(|| bend(&workload));
        let bits = points.iter().flatten().flat_map(|p| [p.re.to_bits(), p.im.to_bits()]);
        bits.chain([energy.to_bits()]).collect::<Vec<_>>()
    };
    assert_eq!(bits(1), bits(3));
}
