//! Condensed networks against the system of all their points, written down by hand; bounds on steps by two routes.

use cotillion_solvers::{
    BoundMethod, BoundsError, Factor, KktError, KktForm, Knots, LeastSquares, Network, PointRow, RowMatrix,
    StepRange, Track, analyse, analyse_rank, solve, solve_bounded,
    workload::{STEP, relay_chain},
};
use proptest::prelude::*;

/// Times agree to this: they stay below 100, and systems of some hundred rows lose four digits of 1e-16.
const SAME_TIME: f64 = 1e-9;
/// Energies agree to this share.
const SAME_ENERGY: f64 = 1e-8;
/// And energies below this are rounding: squares of what sums of times around 10 leave in a residual that should be 0.
const NO_ENERGY: f64 = 1e-14;

/// Tracks with rows on them and their targets.
#[derive(Clone, Debug)]
struct Case {
    tracks: Vec<Track>,
    rows: Vec<PointRow<f64>>,
    targets: Vec<f64>,
}

fn factored(network: &Network) -> Result<Factor<f64>, KktError> {
    analyse(&network.problem, KktForm::Hachtel)?.factor(&network.problem)
}

fn blank(tracks: &[Track]) -> Vec<Vec<f64>> {
    tracks.iter().map(|track| vec![0.0; track.points]).collect()
}

/// Times, and energies of springs and rows.
type Answer = (Vec<Vec<f64>>, f64, f64);

fn condensed(case: &Case, knots: Knots) -> Result<Answer, KktError> {
    let network = Network::new(&case.tracks, STEP, &case.rows, knots)?;
    let factor = factored(&network)?;
    let (mut m, mut h) = network.targets();
    network.write_targets(&case.targets, &mut m, &mut h);
    let x = factor.solve(&m, &h)?.x;
    let mut times = blank(&case.tracks);
    network.expand(&x, &mut times);
    let energy = network.energy(&x, &m);
    Ok((times, energy.springs, energy.rows))
}

/// The system of all points, in times instead of delays, without anything of [`Network`]. Tracks must be held in place.
fn full(case: &Case) -> Result<Answer, KktError> {
    let mut starts = vec![0];
    case.tracks.iter().for_each(|track| starts.push(starts[starts.len() - 1] + track.points));
    let columns = starts[case.tracks.len()];
    let mut soft = (RowMatrix::new(columns), Vec::new());
    let mut hard = (RowMatrix::new(columns), Vec::new());
    for (track, start) in case.tracks.iter().zip(&starts) {
        for i in 1..track.points {
            let root = if i + 1 == track.points { (1.0 + track.tail).sqrt() } else { 1.0 };
            soft.0.push_row(&[(start + i - 1, -root), (start + i, root)]);
            soft.1.push(root * STEP);
        }
    }
    let springs = soft.1.len();
    for (row, target) in case.rows.iter().zip(&case.targets) {
        let root = row.weight.unwrap_or(1.0).sqrt();
        let terms: Vec<_> =
            row.terms.iter().map(|(track, point, a)| (starts[*track] + point, root * a)).collect();
        let rows = if row.weight.is_some() { &mut soft } else { &mut hard };
        rows.0.push_row(&terms);
        rows.1.push(root * target);
    }
    let problem = LeastSquares { columns, soft: soft.0.to_csr(), hard: hard.0.to_csr() };
    let x = solve(&problem, &soft.1, &hard.1)?.x;
    let rows = springs..soft.1.len();
    Ok((
        starts.windows(2).map(|ends| x[ends[0]..ends[1]].to_vec()).collect(),
        problem.energy_of_rows(0..springs, &x, &soft.1),
        problem.energy_of_rows(rows, &x, &soft.1),
    ))
}

fn assert_same(a: &Answer, b: &Answer) {
    for (a, b) in a.0.iter().flatten().zip(b.0.iter().flatten()) {
        assert!((a - b).abs() < SAME_TIME, "{a} is not {b}");
    }
    for (a, b) in [(a.1, b.1), (a.2, b.2)] {
        assert!((a - b).abs() <= SAME_ENERGY * b + NO_ENERGY, "energy {a:e} is not {b:e}");
    }
}

fn chain(characters: usize) -> Case {
    let workload = relay_chain(characters);
    let tracks = workload.paths.iter().map(|path| Track { points: path.len(), tail: 0.0 }).collect();
    Case { tracks, rows: workload.time_rows, targets: workload.time_targets }
}

#[test]
fn a_relay_condenses_to_two_knots_a_track() {
    let case = chain(78);
    let network = Network::new(&case.tracks, STEP, &case.rows, Knots::Touched).expect("finite rows");
    assert_eq!(network.problem.columns, 2 * 78);
    assert_same(&condensed(&case, Knots::Touched).expect("held"), &full(&case).expect("held"));
}

#[test]
fn ten_thousand_tied_tracks_share_the_stretch_evenly() {
    let count = 10_000;
    let (times, springs, rows) = condensed(&chain(count), Knots::Touched).expect("held");
    // Ends and ties make one spring of 150 + 100 (count − 2) + 50 + 99 steps and two soft pins, drawn apart by 2.
    let steps = 150.0 + 100.0 * (count as f64 - 2.0) + 149.0;
    let force = 2.0 / (steps + 2.0);
    assert!((springs / (0.5 * steps * force * force) - 1.0).abs() < SAME_ENERGY);
    assert!((rows / (force * force) - 1.0).abs() < SAME_ENERGY);
    for (i, time) in times[count / 2].iter().enumerate().take(150).skip(50) {
        let before = 150.0 + 100.0 * (count as f64 / 2.0 - 1.0) + (i as f64 - 50.0);
        assert!((time - i as f64 * STEP - force * (1.0 + before)).abs() < 1e-12);
    }
}

#[test]
fn tracks_that_nothing_holds_stay_as_at_rest() {
    let tie = |a: usize, b: usize| PointRow::hard(vec![(a, 30, 1.0), (b, 20, -1.0)]);
    let tracks = vec![Track { points: 60, tail: 0.0 }; 5];
    // 1 and 3 are tied to each other alone, 4 is held, 0 and 2 are free.
    let rows = vec![tie(1, 3), PointRow::soft(vec![(4, 10, 1.0)], 2.0)];
    let case = Case { tracks, rows, targets: vec![1.0, 7.0] };
    let (times, springs, _) = condensed(&case, Knots::Touched).expect("gauge rows hold the rest");
    assert!(springs < NO_ENERGY);
    for (track, delay) in [(0, 0.0), (1, 0.0), (2, 0.0), (3, 10.0 * STEP - 1.0), (4, 7.0 - 10.0 * STEP)] {
        for (i, time) in times[track].iter().enumerate() {
            assert!((time - i as f64 * STEP - delay).abs() < SAME_TIME);
        }
    }
}

#[test]
fn tracks_of_one_point_and_of_none_are_no_trouble() {
    let tracks = [0, 1, 2].map(|points| Track { points, tail: 0.0 }).to_vec();
    let rows = vec![PointRow::hard(vec![(1, 0, 1.0)]), PointRow::hard(vec![(2, 1, 1.0), (1, 0, -1.0)])];
    let (times, ..) =
        condensed(&Case { tracks, rows, targets: vec![3.0, 2.0] }, Knots::Touched).expect("held");
    assert_eq!((times[0].len(), times[1][0]), (0, 3.0));
    assert!((times[2][0] - 5.0 + STEP).abs() < SAME_TIME && (times[2][1] - 5.0).abs() < SAME_TIME);
}

#[test]
fn repeated_and_contradicting_rows_are_numbered_as_given() {
    let pin = |point: usize| PointRow::hard(vec![(0, point, 1.0)]);
    let rows = [pin(5), PointRow::soft(vec![(0, 30, 1.0)], 1.0), pin(20), pin(5)];
    let tracks = [Track { points: 40, tail: 0.0 }];
    let network = Network::new(&tracks, STEP, &rows, Knots::Touched).expect("finite rows");
    assert_eq!((network.kept.clone(), network.dependent.len()), (vec![0, 2], 1));
    assert_eq!(network.dependent[0].certificate(), vec![0, 3]);
    assert!((network.dependent[0].mismatch(&[1.0, 9.0, 2.0, 1.25]) - 0.25).abs() < 1e-15);
}

#[test]
fn spoilt_rows_are_refused() {
    let tracks = [Track { points: 40, tail: 0.0 }];
    let refused = |row: PointRow<f64>| Network::new(&tracks, STEP, &[row], Knots::Touched).err();
    let nan = PointRow::hard(vec![(0, 3, f64::NAN)]);
    assert_eq!(refused(nan), Some(KktError::NotFinite { block: "H", row: 0 }));
    let negative = PointRow::soft(vec![(0, 3, 1.0)], -1.0);
    assert!(matches!(refused(negative), Some(KktError::NotFinite { block: "M", .. })));
}

#[test]
#[should_panic(expected = "point 40 of a track of 40")]
fn points_out_of_range_are_a_bug_of_the_caller() {
    let rows = [PointRow::hard(vec![(0, 40, 1.0)])];
    drop(Network::new(&[Track { points: 40, tail: 0.0 }], STEP, &rows, Knots::Touched));
}

/// Tracks tied at random, some of them with a tail; the first point of each is drawn to some time.
fn case() -> impl Strategy<Value = Case> {
    let tracks = prop::collection::vec((2..80_usize, prop_oneof![Just(0.0), 0.1..0.9_f64]), 1..5);
    tracks.prop_flat_map(|tracks| {
        let tracks: Vec<Track> = tracks.into_iter().map(|(points, tail)| Track { points, tail }).collect();
        let count = tracks.len();
        let place = (0..count, 0.0..1.0_f64);
        let weight = prop::option::of(0.01..100.0_f64);
        let tie = (place.clone(), place, weight, -0.4..0.4_f64);
        let holds = prop::collection::vec((0.01..10.0_f64, -0.4..0.4_f64), count);
        (prop::collection::vec(tie, 0..8), holds).prop_map(move |(ties, holds)| {
            let mut case = Case { tracks: tracks.clone(), rows: Vec::new(), targets: Vec::new() };
            for (track, (weight, change)) in holds.into_iter().enumerate() {
                case.rows.push(PointRow::soft(vec![(track, 0, 1.0)], weight));
                case.targets.push(change);
            }
            for (a, b, weight, change) in ties {
                let (mut terms, x) = fractional(&case.tracks, a, 1.0);
                let (others, y) = fractional(&case.tracks, b, -1.0);
                terms.extend(others);
                case.rows.push(PointRow { terms, weight });
                case.targets.push((x - y) * STEP + change);
            }
            case
        })
    })
}

/// Terms of a moment between two points, and its place.
fn fractional(tracks: &[Track], (track, share): (usize, f64), sign: f64) -> (Vec<(usize, usize, f64)>, f64) {
    let last = tracks[track].points - 1;
    let low = (0..last).rev().find(|i| *i as f64 <= share * last as f64).unwrap_or(0);
    let part = share * last as f64 - low as f64;
    let terms = vec![(track, low, sign * (1.0 - part)), (track, low + 1, sign * part)];
    (terms, share * last as f64)
}

/// Drops hard rows that depend on others.
fn independent(mut case: Case) -> Case {
    let network = Network::new(&case.tracks, STEP, &case.rows, Knots::Touched).expect("finite rows");
    for dependency in network.dependent.iter().rev() {
        case.rows.remove(dependency.row);
        case.targets.remove(dependency.row);
    }
    case
}

/// What two routes to the bounded optimum make of a case.
type Bounded = Result<(Vec<f64>, Vec<usize>), BoundsError>;

fn both_routes(case: &Case, range: StepRange) -> (Network, Bounded, Bounded) {
    let network = Network::new(&case.tracks, STEP, &case.rows, Knots::Touched).expect("finite rows");
    let (mut m, mut h) = network.targets();
    network.write_targets(&case.targets, &mut m, &mut h);
    let sparse = network.solve_within((&m, &h), range);
    let dense = solve_bounded(&network.dense_program((&m, &h), range), BoundMethod::DualActiveSet);
    (network, sparse.map(|s| (s.x, s.active)), dense.map(|s| (s.x, s.active)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn condensed_networks_match_the_system_of_all_points(case in case()) {
        let case = independent(case);
        let reference = full(&case).expect("every track is held");
        assert_same(&condensed(&case, Knots::Touched).expect("every track is held"), &reference);
        assert_same(&condensed(&case, Knots::All).expect("every track is held"), &reference);
    }

    #[test]
    fn ranks_on_knots_are_ranks_on_points(case in case()) {
        let knots = Network::new(&case.tracks, STEP, &case.rows, Knots::Touched).expect("finite rows");
        let mut matrix = RowMatrix::new(case.tracks.len() * 100);
        for row in case.rows.iter().filter(|row| row.weight.is_none()) {
            let terms: Vec<_> = row.terms.iter().map(|(track, point, a)| (100 * track + point, *a)).collect();
            matrix.push_row(&terms);
        }
        let report = analyse_rank(&matrix.to_csr());
        let hard: Vec<usize> = (0..case.rows.len()).filter(|row| case.rows[*row].weight.is_none()).collect();
        let expected: Vec<usize> = report.independent.into_iter().map(|row| hard[row]).collect();
        prop_assert_eq!(knots.kept, expected);
    }

    #[test]
    fn sparse_and_dense_active_sets_agree(case in case(), min in 0.3..0.95_f64, max in 1.05..1.9_f64) {
        let case = independent(case);
        let range = StepRange { min: min * STEP, max: max * STEP };
        match both_routes(&case, range) {
            (network, Ok((x, mut active)), Ok((y, mut others))) => {
                let mut times = [blank(&case.tracks), blank(&case.tracks)];
                network.expand(&x, &mut times[0]);
                network.expand(&y, &mut times[1]);
                for (a, b) in times[0].iter().flatten().zip(times[1].iter().flatten()) {
                    prop_assert!((a - b).abs() < SAME_TIME, "{a} is not {b}");
                }
                active.sort_unstable();
                others.sort_unstable();
                prop_assert_eq!(active, others);
            }
            (_, Err(BoundsError::Infeasible { .. }), Err(BoundsError::Infeasible { .. })) => {}
            (_, sparse, dense) => prop_assert!(false, "sparse: {sparse:?}, dense: {dense:?}"),
        }
    }
}

/// Everybody in a relay of `characters` is late, and nobody may step longer than `max`.
fn stretched(characters: usize, seconds: f64) -> Case {
    let mut case = chain(characters);
    case.rows[1].weight = Some(1e3);
    case.targets[1] += seconds;
    case
}

#[test]
fn a_relay_at_its_bounds_agrees_by_both_routes() {
    let case = stretched(20, 60.0);
    let (_, sparse, dense) = both_routes(&case, StepRange { min: 0.5 * STEP, max: 1.5 * STEP });
    let ((x, active), (y, others)) = (sparse.expect("feasible"), dense.expect("feasible"));
    assert!(active.len() > 15 && active.len() == others.len());
    assert!(x.iter().zip(&y).all(|(a, b)| (a - b).abs() < SAME_TIME));
}

#[test]
fn hundreds_of_tracks_reach_their_bounds() {
    let count = 400;
    let case = stretched(count, 2000.0);
    let range = StepRange { min: 0.5 * STEP, max: 1.5 * STEP };
    let network = Network::new(&case.tracks, STEP, &case.rows, Knots::Touched).expect("finite rows");
    let (mut m, mut h) = network.targets();
    network.write_targets(&case.targets, &mut m, &mut h);
    let solution = network.solve_within((&m, &h), range).expect("soft ends give way");
    assert_eq!(solution.active.len(), network.pieces.len());
    for piece in &network.pieces {
        assert!((network.lengthening(piece, &solution.x) - 0.5 * STEP).abs() < 1e-12);
    }
    assert!(solution.multipliers.iter().all(|u| *u >= 0.0));
}
