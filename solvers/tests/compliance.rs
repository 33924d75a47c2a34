//! The compliance form has the minimiser of the full system: random paths, stiff and rigid stretches, soft and hard rows,
//! few of them or so many that paths are cut into pieces.

use cotillion_solvers::{
    Bent, Compliance, Effort, KktError, LeastSquares, PointRow, RowMatrix, SpringPath, analyse_rank, c64,
    solve,
};
use proptest::prelude::*;

/// Points are below 100 and systems well enough conditioned for ten digits.
const PLACES: f64 = 1e-8;
/// Energies, relative, or absolute where the minimum is all but 0.
const ENERGIES: (f64, f64) = (1e-8, 1e-14);
/// The same for sketches: one substitution that misses its rows by 1e-6 at most.
const SKETCHES: (f64, f64) = (1e-4, 1e-9);

/// Of each path.
const POINTS: usize = 130;

#[derive(Clone, Debug)]
struct Problem {
    paths: Vec<SpringPath>,
    rows: Vec<PointRow<c64>>,
    targets: Vec<c64>,
}

fn point() -> impl Strategy<Value = c64> {
    (-2.0..2.0_f64, -2.0..2.0_f64).prop_map(|(x, y)| c64::new(x, y))
}

/// A walk that never stands still, with stretches of other compliance, some rigid.
fn path() -> impl Strategy<Value = SpringPath> {
    let step = (0.5..1.5_f64, -0.6..0.6_f64);
    let compliance = prop_oneof![4 => Just(1.0), 1 => Just(0.0), 1 => 1e-3..1e3_f64];
    let stretches = prop::collection::vec((2..40_usize, compliance), 1..8);
    (prop::collection::vec(step, POINTS - 1), stretches, any::<bool>()).prop_map(
        |(steps, stretches, even)| {
            let mut point = c64::new(3.0, -1.0);
            let mut heading = 0.0;
            let mut points = vec![point];
            for (length, turn) in steps {
                heading += turn;
                point += c64::from_polar(length, heading);
                points.push(point);
            }
            let count = points.len();
            let mut starts = vec![(0, 1.0)];
            let mut start = 0;
            for (length, compliance) in stretches {
                start += length;
                starts.push((start, compliance));
            }
            if even {
                return SpringPath::Even { count, stretches: starts };
            }
            let at = |s: usize| starts.iter().rev().find(|(first, _)| *first <= s).map_or(1.0, |(_, c)| *c);
            let own = |s: usize| if s == 0 || s == count - 1 { 0.0 } else { at(s) };
            SpringPath::Listed { points, compliances: (0..count).map(own).collect() }
        },
    )
}

fn row(paths: usize) -> impl Strategy<Value = (PointRow<c64>, c64)> {
    let coefficient = prop_oneof![Just(c64::new(1.0, 0.0)), Just(c64::new(-1.0, 0.0)), point()];
    let term = (0..paths, 0..POINTS, coefficient);
    let weight = prop_oneof![3 => (0.1..100.0_f64).prop_map(Some), 1 => Just(None)];
    (prop::collection::vec(term, 1..4), weight, point())
        .prop_map(|(terms, weight, target)| (PointRow { terms, weight }, target))
}

fn problem() -> impl Strategy<Value = Problem> {
    (1..4_usize).prop_flat_map(|paths| {
        let rows =
            prop_oneof![prop::collection::vec(row(paths), 6..20), prop::collection::vec(row(paths), 90..140)];
        (prop::collection::vec(path(), paths), rows).prop_map(|(paths, rows)| {
            // Every path is pinned at two places, that no combination of other rows is all that holds it.
            let pins = (0..paths.len()).flat_map(|path| [(path, 5), (path, 120)]);
            let pin =
                |(path, j)| (PointRow::soft(vec![(path, j, c64::new(1.0, 0.0))], 1.0), c64::new(1.0, 2.0));
            let (rows, targets) = pins.map(pin).chain(rows).unzip();
            Problem { paths, rows, targets }
        })
    })
}

/// Compliance of spring s.
fn compliance(path: &SpringPath, s: usize) -> f64 {
    match path {
        SpringPath::Listed { compliances, .. } => compliances[s],
        SpringPath::Even { stretches, .. } => {
            stretches.iter().rev().find(|(first, _)| *first <= s).map_or(0.0, |(_, c)| *c)
        }
    }
}

/// The same problem over all points: a rigid spring is a hard row.
fn full(problem: &Problem) -> Option<(Vec<Vec<c64>>, f64)> {
    let starts: Vec<usize> = problem
        .paths
        .iter()
        .scan(0, |next, path| {
            let start = *next;
            *next += path.len();
            Some(start)
        })
        .collect();
    let columns = problem.paths.iter().map(SpringPath::len).sum();
    let (mut soft, mut hard) = (RowMatrix::new(columns), RowMatrix::new(columns));
    let (mut m, mut h) = (Vec::new(), Vec::new());
    for (path, start) in problem.paths.iter().zip(&starts) {
        for s in 1..path.len() - 1 {
            let (before, after) = (path.point(s) - path.point(s - 1), path.point(s + 1) - path.point(s));
            let c = compliance(path, s);
            let root = if c > 0.0 { c.sqrt().recip() } else { 1.0 };
            let (b, a) = (root / before, root / after);
            let terms = [(start + s - 1, b), (start + s, -(b + a)), (start + s + 1, a)];
            if c > 0.0 {
                soft.push_row(&terms);
                m.push(c64::default());
            } else {
                hard.push_row(&terms);
                h.push(c64::default());
            }
        }
    }
    for (row, target) in problem.rows.iter().zip(&problem.targets) {
        let root = row.weight.unwrap_or(1.0).sqrt();
        let terms: Vec<_> = row.terms.iter().map(|(path, j, c)| (starts[*path] + j, c * root)).collect();
        if row.weight.is_some() {
            soft.push_row(&terms);
            m.push(target * root);
        } else {
            hard.push_row(&terms);
            h.push(*target);
        }
    }
    let hard = hard.to_csr();
    if !analyse_rank(&hard).dependent.is_empty() {
        return None;
    }
    let solution = solve(&LeastSquares { columns, soft: soft.to_csr(), hard }, &m, &h).ok()?;
    let paths = problem.paths.iter().zip(&starts);
    let points = paths.map(|(path, start)| solution.x[*start..start + path.len()].to_vec()).collect();
    Some((points, solution.report.energy))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn springs_bend_like_the_full_system(problem in problem()) {
        let reference = full(&problem);
        prop_assume!(reference.is_some());
        let (points, energy) = reference.expect("just seen");
        let system = Compliance::new(problem.paths.clone(), problem.rows.clone());
        prop_assert_eq!(system.free_motions(), 0);
        let factor = system.analyse().expect("a sound problem").factor(&system).expect("regular");
        let mut bent = Bent::new(&system, &factor);
        let report = match bent.solve(&system, &factor, &problem.targets) {
            // Rows that depend on each other too nearly are refused, now and then: other cases take their place.
            Err(KktError::Residual { .. }) => return Err(TestCaseError::reject("rows nearly depend on each other")),
            answer => answer.expect("an answer"),
        };
        let scale = points.iter().flatten().map(|p| p.norm()).fold(1.0, f64::max);
        for (path, points) in points.iter().enumerate() {
            let mut seen = 0;
            bent.expand(&system, path, |j, x, _| {
                assert_eq!(j, seen, "points come in order");
                assert!((x - points[j]).norm() < PLACES * scale, "path {path} point {j}: {x} or {}", points[j]);
                seen += 1;
            });
            prop_assert_eq!(seen, points.len());
        }
        let apart = (report.energy - energy).abs();
        prop_assert!(apart <= (ENERGIES.0 * energy).max(ENERGIES.1), "{} or {energy}", report.energy);
        let sketch = bent.solve_to(Effort::Sketch, (&system, &factor), &problem.targets).expect("an answer");
        let apart = (sketch.energy - energy).abs();
        prop_assert!(apart <= (SKETCHES.0 * energy).max(SKETCHES.1), "{} or {energy}", sketch.energy);
    }
}

/// Factors of all segments of a path.
fn bends(bent: &Bent, system: &Compliance, path: usize) -> Vec<c64> {
    let mut factors = Vec::new();
    bent.expand(system, path, |_, _, factor| factors.push(factor));
    factors
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    /// Bounds hold, and where only a little changes they are little.
    #[test]
    fn bends_are_compared_without_drawing_them(
        problem in problem(),
        moved in prop::collection::vec(point(), 160),
        by in prop_oneof![Just(0.0), Just(1e-6), 1e-3..1.0_f64],
    ) {
        let system = Compliance::new(problem.paths.clone(), problem.rows.clone());
        let factor = system.analyse().expect("a sound problem").factor(&system);
        prop_assume!(factor.is_ok(), "hard rows depend on each other");
        let factor = factor.expect("just seen");
        let solved = |targets: &[c64]| {
            let mut bent = Bent::new(&system, &factor);
            bent.solve(&system, &factor, targets).ok().map(|report| (bent, report.energy))
        };
        // What rows see of points that move by no more than `by`, in some direction.
        let seen = |row: usize| problem.rows[row].terms.iter().map(|term| term.2.norm()).sum::<f64>() * by;
        let direction = |row: usize| moved[row] / moved[row].norm().max(1e-9);
        let targets: Vec<c64> =
            (0..problem.rows.len()).map(|row| problem.targets[row] + seen(row) * direction(row)).collect();
        let (own, its) = (solved(&problem.targets), solved(&targets));
        prop_assume!(own.is_some() && its.is_some());
        let ((own, energy), (its, other)) = (own.expect("just seen"), its.expect("just seen"));
        for path in 0..problem.paths.len() {
            let (factors, others) = (bends(&own, &system, path), bends(&its, &system, path));
            let size = factors.iter().chain(&others).map(|z| z.norm()).fold(1.0, f64::max);
            let mut next = 0;
            let told = own.compare(&system, (&its, &system), path, |range, likeness| {
                assert_eq!(range.start, next, "ranges come in order");
                next = range.end;
                for j in range {
                    let (apart, bent) = ((factors[j] - others[j]).norm(), (factors[j] - likeness.factor).norm());
                    assert!(apart <= likeness.apart + 1e-7 * size, "path {path} segment {j}: {apart} is more than {}", likeness.apart);
                    assert!(bent <= likeness.bend() + 1e-7 * size, "path {path} segment {j}: {bent} is more than {}", likeness.bend());
                    assert!(by > 0.0 || likeness.apart == 0.0, "nothing changed");
                }
            });
            prop_assert!(told && next == POINTS);
        }
        let work = own.work(&system, problem.rows.len(), |_| by);
        prop_assert!(other >= energy - work - 1e-7 * (energy + other), "{energy} fell to {other} by more than {work}");
        prop_assert_eq!(own.work(&system, problem.rows.len(), |_| 0.0), 0.0);
    }

    #[test]
    fn other_springs_are_not_compared(problem in problem()) {
        let system = Compliance::new(problem.paths.clone(), problem.rows.clone());
        let again = Compliance::new(problem.paths.clone(), problem.rows.clone());
        let factor = system.analyse().expect("a sound problem").factor(&system);
        prop_assume!(factor.is_ok(), "hard rows depend on each other");
        let factor = factor.expect("just seen");
        let bent = Bent::new(&system, &factor);
        prop_assert!(!bent.compare(&system, (&bent, &again), 0, |_, _| panic!("other springs")));
    }
}
