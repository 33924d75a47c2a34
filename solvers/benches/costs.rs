//! Costs of the solvers, one by one: what is done once for a pattern, once for coefficients, and at every drag step.

use cotillion_solvers::workload::{CHAIN_SAMPLES, STEP, Workload, relay_chain};
use cotillion_solvers::{
    Bent, ChainSystem, Change, Compliance, Factor, KktForm, Knots, LeastSquares, MomentTree, Network, Part,
    PathResponse, PointRow, RowMatrix, RowTargets, Scalar, SplicedPath, SpringPath, Track, analyse,
    analyse_rank, c64, shape_rows,
};
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// Tied paths of [`CHAIN_SAMPLES`] samples.
const CHARACTERS: [usize; 4] = [1, 16, 64, 1_000];
/// Lengths of a single path.
const SAMPLES: [usize; 3] = [CHAIN_SAMPLES, 1_000, 10_000];

/// Axis, parameter and workload.
type Case = (&'static str, usize, Workload);

fn cases() -> Vec<Case> {
    let long = SAMPLES.iter().map(|samples| ("samples", *samples, long_path(*samples)));
    let tied = CHARACTERS.iter().map(|characters| ("characters", *characters, relay_chain(*characters)));
    long.chain(tied).collect()
}

/// One path with the pins and times of [`relay_chain`].
fn long_path(samples: usize) -> Workload {
    let mut workload = relay_chain(1);
    let scaled = |i: usize| i * (samples - 1) / (CHAIN_SAMPLES - 1);
    let point = |i: usize| c64::new(0.04 * i as f64, 0.3 * (0.06 * i as f64).sin());
    workload.paths = vec![(0..samples).map(point).collect()];
    for row in &mut workload.rows {
        row.terms.iter_mut().for_each(|(_, i, _)| *i = scaled(*i));
    }
    for row in &mut workload.time_rows {
        row.terms.iter_mut().for_each(|(_, i, _)| *i = scaled(*i));
    }
    workload
}

/// Targets of rows on points and of rows on times.
type Targets = (Vec<c64>, Vec<f64>);

/// Measures `work` for each case, on what `prepare` makes of it, with the targets of two drag steps in turn.
fn group<P, R>(
    criterion: &mut Criterion,
    name: &str,
    prepare: impl Fn(&Workload) -> P,
    mut work: impl FnMut(&Workload, &mut P, &Targets) -> R,
) {
    let mut group: BenchmarkGroup<_> = criterion.benchmark_group(name);
    group.sample_size(20);
    for (axis, parameter, workload) in cases() {
        let mut prepared = prepare(&workload);
        let (targets, mut step) = ([workload.dragged(0), workload.dragged(1)], 0);
        group.throughput(Throughput::Elements(workload.samples() as u64));
        group.bench_function(BenchmarkId::new(axis, parameter), |b| {
            b.iter(|| {
                step = 1 - step;
                work(&workload, &mut prepared, &targets[step])
            });
        });
    }
    group.finish();
}

fn springs(workload: &Workload) -> Vec<SpringPath> {
    workload.paths.iter().map(|path| SpringPath::of_shape(path.clone())).collect()
}

fn compliance(criterion: &mut Criterion) {
    let assembled = |workload: &Workload| Compliance::new(springs(workload), workload.rows.clone());
    group(criterion, "compliance_assemble", springs, |workload, springs, _| {
        Compliance::new(springs.clone(), workload.rows.clone())
    });
    group(criterion, "compliance_analyse", assembled, |_, problem, _| problem.analyse());
    let analysed = |workload: &Workload| {
        let problem = assembled(workload);
        let analysis = problem.analyse().expect("finite rows");
        (problem, analysis)
    };
    group(criterion, "compliance_factor", analysed, |_, (problem, analysis), _| analysis.factor(problem));
    let factored = |workload: &Workload| {
        let (problem, analysis) = analysed(workload);
        let factor = analysis.factor(&problem).expect("a regular system");
        let mut bent = Bent::new(&problem, &factor);
        bent.solve(&problem, &factor, &workload.targets).expect("an answer");
        (problem, factor, bent)
    };
    group(criterion, "compliance_solve", factored, |_, (problem, factor, bent), targets| {
        bent.solve(problem, factor, &targets.0)
    });
    group(criterion, "compliance_expand", factored, |workload, (problem, _, bent), _| {
        let mut farthest = 0.0_f64;
        for path in 0..workload.paths.len() {
            bent.expand(problem, path, |_, x, _| farthest = farthest.max(x.re));
        }
        farthest
    });
}

/// One candidate, its splice included: a stretch of the middle path goes twice.
fn what_if(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("what_if");
    for (axis, parameter, workload) in cases() {
        let problem = Compliance::new(springs(&workload), workload.rows.clone());
        let factor = problem.analyse().expect("finite rows").factor(&problem).expect("a regular system");
        let mut bent = Bent::new(&problem, &factor);
        bent.solve(&problem, &factor, &workload.targets).expect("an answer");
        let path = workload.paths.len() / 2;
        let trees = [MomentTree::new(&SpringPath::of_shape(workload.paths[path].clone()))];
        let response = PathResponse::new(&problem, &factor, path);
        group.bench_function(BenchmarkId::new(axis, parameter), |b| {
            b.iter(|| {
                let splice = twice(&workload, path, &trees);
                let change = changed(&workload, path, (&splice, &response.rows));
                response.energy(&problem, (&bent, &workload.targets), &change).expect("a regular candidate")
            });
        });
    }
    group.finish();
}

/// First and last sample, 0.4 and 0.45 of the way, of the stretch that goes twice: no row is near.
fn stretch(workload: &Workload, path: usize) -> (usize, usize) {
    let last = workload.paths[path].len() - 1;
    (2 * last / 5, 9 * last / 20)
}

fn twice<'a>(workload: &Workload, path: usize, trees: &'a [MomentTree]) -> SplicedPath<'a> {
    let ((first, end), points) = (stretch(workload, path), &workload.paths[path]);
    let one = c64::new(1.0, 0.0);
    let seam = 1e3; // Of the order of the others; exact compliances cost the caller a few operations.
    let before = Part { source: 0, points: (0, end), turn: one, start: points[0], compliances: (0.0, seam) };
    let after = Part {
        source: 0,
        points: (first + 1, points.len() - 1),
        turn: one,
        start: points[end] + points[first + 1] - points[first],
        compliances: (seam, 0.0),
    };
    SplicedPath::new(trees, vec![before, after])
}

fn changed<'a>(
    workload: &Workload,
    path: usize,
    (splice, rows): (&'a SplicedPath<'a>, &[usize]),
) -> Change<'a> {
    let (first, end) = stretch(workload, path);
    let moved = |j: usize| if j > end { j + end - first } else { j };
    let own = |row: &usize| {
        let terms = workload.rows[*row].terms.iter().filter(|term| term.0 == path);
        terms.map(|(_, j, value)| (moved(*j), *value)).collect()
    };
    let targets = rows.iter().map(|row| workload.targets[*row]).collect();
    Change { path: splice, terms: rows.iter().map(own).collect(), targets }
}

fn factor<T: Scalar>(problem: &LeastSquares<T>) -> Factor<T> {
    let analysis = analyse(problem, KktForm::Hachtel).expect("finite rows");
    analysis.factor(problem).expect("a regular system")
}

fn chain(criterion: &mut Criterion) {
    let rows =
        |workload: &Workload| -> Vec<_> { workload.paths.iter().map(|path| shape_rows(path)).collect() };
    let condensed = |workload: &Workload| {
        ChainSystem::new(&rows(workload), &workload.rows, RowTargets::Zero).expect("a regular system")
    };
    group(criterion, "chain_condense", rows, |workload, rows, _| {
        ChainSystem::new(rows, &workload.rows, RowTargets::Zero)
    });
    group(criterion, "chain_factor", condensed, |_, system, _| factor(system.problem()));
    let ready = |workload: &Workload| {
        let system = condensed(workload);
        let factor = factor(system.problem());
        let workspace = system.workspace(&factor);
        (system, factor, workspace, workload.paths.clone())
    };
    group(criterion, "chain_drag", ready, |_, (system, factor, workspace, points), targets| {
        system.solve_into(factor, &targets.0, &[], workspace).expect("an answer");
        system.expand(workspace, points)
    });
}

fn network(criterion: &mut Criterion) {
    let tracks = |workload: &Workload| -> Vec<Track> {
        workload.paths.iter().map(|path| Track { points: path.len(), tail: 0.0 }).collect()
    };
    let assembled = move |workload: &Workload| {
        Network::new(&tracks(workload), STEP, &workload.time_rows, Knots::Touched).expect("finite rows")
    };
    group(criterion, "network_cold", |_| (), |workload, (), _| factor(&assembled(workload).problem));
    let ready = |workload: &Workload| {
        let network = assembled(workload);
        let factor = factor(&network.problem);
        let workspace = factor.workspace();
        let x = vec![0.0; network.problem.columns];
        let times: Vec<Vec<f64>> = workload.paths.iter().map(|path| vec![0.0; path.len()]).collect();
        (network.targets(), network, factor, workspace, x, times)
    };
    group(criterion, "network_drag", ready, |_, prepared, targets| {
        let ((m, h), network, factor, workspace, x, times) = prepared;
        network.write_targets(&targets.1, m, h);
        let report = factor.solve_into(m, h, x, workspace).expect("an answer");
        network.expand(x, times);
        report.energy
    });
}

/// Columns of the points that rows touch.
fn hard_rows(workload: &Workload) -> RowMatrix<c64> {
    let hard: Vec<&PointRow<c64>> = workload.rows.iter().filter(|row| row.weight.is_none()).collect();
    let places = hard.iter().flat_map(|row| row.terms.iter().map(|(path, point, _)| (*path, *point)));
    let mut columns: Vec<(usize, usize)> = places.collect();
    columns.sort_unstable();
    columns.dedup();
    let mut matrix = RowMatrix::new(columns.len());
    for row in hard {
        let column = |path, point| columns.partition_point(|known| *known < (path, point));
        let entries: Vec<_> = row.terms.iter().map(|(path, point, c)| (column(*path, *point), *c)).collect();
        matrix.push_row(&entries);
    }
    matrix
}

fn rank(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("rank");
    group.sample_size(20);
    for characters in CHARACTERS.into_iter().filter(|characters| *characters > 1) {
        let matrix = hard_rows(&relay_chain(characters)).to_csr();
        group.throughput(Throughput::Elements(matrix.rows() as u64));
        group
            .bench_function(BenchmarkId::new("characters", characters), |b| b.iter(|| analyse_rank(&matrix)));
    }
    group.finish();
}

criterion_group!(benches, compliance, what_if, chain, network, rank);
criterion_main!(benches);
