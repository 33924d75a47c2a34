//! Repeated solves allocate nothing: all memory is asked for when a problem is built and factored.

use allocation_counter::measure;
use cotillion_solvers::workload::{STEP, Workload, relay_chain};
use cotillion_solvers::{
    Bent, ChainSystem, Compliance, KktForm, Knots, Network, PointRow, RowTargets, SpringPath, Track, analyse,
    c64, shape_rows,
};

/// Drag steps of each test; the first few show what only later steps need.
const STEPS: usize = 5;
/// Refinements from this one on are summed to 32 digits, in memory of their own.
const COMPENSATED: usize = 2;

fn allocations(work: impl FnOnce()) -> (u64, u64) {
    let counted = measure(work);
    (counted.count_total, counted.bytes_total)
}

#[test]
fn the_counter_counts() {
    let (count, bytes) = allocations(|| drop(std::hint::black_box(vec![0_u8; 100])));
    assert_eq!((count, bytes), (1, 100));
}

fn bending(path: &[c64]) -> SpringPath {
    let mut compliances = vec![1.0; path.len()];
    (compliances[0], compliances[path.len() - 1]) = (0.0, 0.0);
    SpringPath::Listed { points: path.to_vec(), compliances }
}

/// One long path with a pin at every fifth point, which is cut into pieces.
fn many_pins() -> Workload {
    let mut workload = relay_chain(1);
    let count = workload.paths[0].len();
    let pin = |i: usize| PointRow::soft(vec![(0, i, c64::new(1.0, 0.0))], 1.0);
    workload.rows = (0..count).step_by(5).map(pin).collect();
    workload.targets = workload.paths[0].iter().step_by(5).copied().collect();
    workload
}

/// Most refinements of any step.
fn drag_springs(workload: &Workload, paths: Vec<SpringPath>) -> usize {
    let problem = Compliance::new(paths, workload.rows.clone());
    let factor = problem.analyse().and_then(|analysis| analysis.factor(&problem)).expect("a regular system");
    let mut bent = Bent::new(&problem, &factor);
    let mut sum = c64::default();
    let mut refinements = 0;
    for step in 0..STEPS {
        let (targets, _) = workload.dragged(step);
        let counted = allocations(|| {
            let report = bent.solve(&problem, &factor, &targets).expect("an answer");
            refinements = refinements.max(report.refinements);
            (0..workload.paths.len()).for_each(|path| bent.expand(&problem, path, |_, x, _| sum += x));
        });
        assert_eq!(counted, (0, 0), "{} in step {step}", workload.name);
    }
    assert!(sum.is_finite());
    refinements
}

#[test]
fn springs_are_dragged_without_allocating() {
    for workload in [relay_chain(1), relay_chain(64), many_pins()] {
        drag_springs(&workload, workload.paths.iter().map(|path| bending(path)).collect());
        drag_springs(&workload, workload.paths.iter().map(|path| SpringPath::even(path.len())).collect());
    }
}

/// Hard pins on neighbouring points, far from the next such pair: the forces that turn a step all but cancel.
fn held_steps() -> Workload {
    let mut workload = relay_chain(1);
    let path: Vec<c64> =
        (0..4_000).map(|i| c64::new(0.04 * f64::from(i), (0.02 * f64::from(i)).sin())).collect();
    let held: Vec<usize> = (0..5).flat_map(|pair| [999 * pair, 999 * pair + 1]).collect();
    workload.rows = held.iter().map(|i| PointRow::hard(vec![(0, *i, c64::new(1.0, 0.0))])).collect();
    workload.targets = held.iter().map(|i| 0.9 * path[*i]).collect();
    workload.paths = vec![path];
    workload
}

#[test]
fn solves_with_compensated_sums_allocate_nothing_either() {
    let workload = held_steps();
    let refinements = drag_springs(&workload, workload.paths.iter().map(|path| bending(path)).collect());
    assert!(refinements >= COMPENSATED, "{refinements} refinements: none was compensated");
}

#[test]
fn times_are_dragged_without_allocating() {
    let workload = relay_chain(64);
    let tracks: Vec<Track> =
        workload.paths.iter().map(|path| Track { points: path.len(), tail: 0.0 }).collect();
    for knots in [Knots::Touched, Knots::All] {
        let network = Network::new(&tracks, STEP, &workload.time_rows, knots).expect("finite rows");
        let factor = analyse(&network.problem, KktForm::Hachtel)
            .and_then(|analysis| analysis.factor(&network.problem))
            .expect("a regular system");
        let mut workspace = factor.workspace();
        let (mut m, mut h) = network.targets();
        let mut x = vec![0.0; network.problem.columns];
        let mut times: Vec<Vec<f64>> = workload.paths.iter().map(|path| vec![0.0; path.len()]).collect();
        for step in 0..STEPS {
            let (_, targets) = workload.dragged(step);
            let counted = allocations(|| {
                network.write_targets(&targets, &mut m, &mut h);
                factor.solve_into(&m, &h, &mut x, &mut workspace).expect("an answer");
                network.expand(&x, &mut times);
                assert!(network.energy(&x, &m).springs.is_finite());
            });
            assert_eq!(counted, (0, 0), "{knots:?} in step {step}");
        }
    }
}

#[test]
fn chains_are_dragged_without_allocating() {
    let workload = relay_chain(64);
    let rows: Vec<_> = workload.paths.iter().map(|path| shape_rows(path)).collect();
    let system = ChainSystem::new(&rows, &workload.rows, RowTargets::Zero).expect("a regular system");
    let factor = analyse(system.problem(), KktForm::Hachtel)
        .and_then(|analysis| analysis.factor(system.problem()))
        .expect("a regular system");
    let mut workspace = system.workspace(&factor);
    let mut points = workload.paths.clone();
    for step in 0..STEPS {
        let (targets, _) = workload.dragged(step);
        let counted = allocations(|| {
            system.solve_into(&factor, &targets, &[], &mut workspace).expect("an answer");
            system.expand(&workspace, &mut points).expect("finite points");
        });
        assert_eq!(counted, (0, 0), "step {step}");
    }
}
