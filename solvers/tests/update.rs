//! What-ifs give the energy of a full solve: the printed candidate of a scene of three paths, random splices of it, random
//! scenes, random stretches of time.

use std::sync::Arc;

use cotillion_solvers::{
    Bent, Change, Compliance, ComplianceFactor, KktForm, Knots, MomentTree, Network, Part, PathResponse,
    PointRow, SplicedPath, SpringPath, StepResponse, Track, analyse, c64,
};
use full::solve_full;
use proptest::prelude::*;

mod full;

/// Energies, relative, or what Ê, 27 000 times as much, does not see.
const ENERGIES: (f64, f64) = (1e-8, 1e-12 / 27_000.0);

/// Energies of times, where Ê is 30 times as much.
const TIME_ENERGY: f64 = 1e-12 / 30.0;

#[derive(Clone, Debug)]
struct Scene {
    paths: Vec<Vec<c64>>,
    rows: Vec<PointRow<c64>>,
    targets: Vec<c64>,
}

const ONE: c64 = c64::new(1.0, 0.0);

/// The scene 'M' of the reference numbers: two ties between three paths, pins, one soft handle.
fn scene_m() -> Scene {
    let s = (0..200).map(|i| c64::new(0.04 * f64::from(i), 0.3 * (0.06 * f64::from(i)).sin()));
    let t = (0..200).map(|i| c64::new(7.96 - 0.04 * f64::from(i), 1.0 + 0.2 * (0.05 * f64::from(i)).sin()));
    let turn = c64::from_polar(1.0, 0.7);
    let u = (0..150).map(|i| {
        c64::new(-1.0, -2.0) + turn * c64::new(0.05 * f64::from(i), 0.2 * (0.08 * f64::from(i)).sin())
    });
    let paths: Vec<Vec<c64>> = vec![s.collect(), t.collect(), u.collect()];
    let mut scene = Scene { paths, rows: Vec::new(), targets: Vec::new() };
    tie(&mut scene, (0, 100), (1, 100));
    tie(&mut scene, (1, 150), (2, 70));
    for (path, j, offset) in
        [(0, 0, c64::new(-1.0, 1.0)), (0, 199, ONE * 0.0), (1, 0, ONE * 0.0), (2, 0, ONE * 0.0)]
    {
        scene.rows.push(PointRow::hard(vec![(path, j, ONE)]));
        scene.targets.push(scene.paths[path][j] + offset);
    }
    scene.rows.push(PointRow::soft(vec![(2, 149, ONE)], 5.0));
    scene.targets.push(scene.paths[2][149] + c64::new(0.0, 0.5));
    scene
}

/// Hard rows that keep place and direction of one point relative to another as they are.
fn tie(scene: &mut Scene, (a, i): (usize, usize), (b, j): (usize, usize)) {
    let chord = |path: usize, k: usize| scene.paths[path][k + 1] - scene.paths[path][k - 1];
    let c = (scene.paths[a][i] - scene.paths[b][j]) / chord(b, j);
    let d = chord(a, i) / chord(b, j);
    scene.rows.push(PointRow::hard(vec![(a, i, ONE), (b, j, -ONE), (b, j + 1, -c), (b, j - 1, c)]));
    scene.rows.push(PointRow::hard(vec![(a, i + 1, ONE), (a, i - 1, -ONE), (b, j + 1, -d), (b, j - 1, d)]));
    scene.targets.extend([c64::default(); 2]);
}

/// The minimum of the full system.
fn full_energy(scene: &Scene) -> f64 {
    solve_full(&scene.paths, &scene.rows, &scene.targets).report.energy
}

/// Stretches of paths one after the other, each laid by the point before it onto the end of the one before, tangent on
/// tangent.
fn spliced<'a>(
    trees: &'a [MomentTree],
    paths: &[Vec<c64>],
    stretches: &[(usize, usize, usize)],
) -> SplicedPath<'a> {
    let tangent = |path: usize, j: usize| {
        paths[path][(j + 1).min(paths[path].len() - 1)] - paths[path][j.saturating_sub(1)]
    };
    let mut parts: Vec<Part> = Vec::new();
    for (source, first, last) in stretches {
        let (turn, start) = match parts.last() {
            None => (ONE, paths[*source][*first]),
            Some(before) => {
                let end = before.points.1;
                let placed_end = before.start
                    + before.turn * (paths[before.source][end] - paths[before.source][before.points.0]);
                let turn = before.turn * tangent(before.source, end) / tangent(*source, first - 1);
                let turn = turn / turn.norm();
                (turn, placed_end + turn * (paths[*source][*first] - paths[*source][first - 1]))
            }
        };
        parts.push(Part { source: *source, points: (*first, *last), turn, start, compliances: (0.0, 0.0) });
    }
    let plain = SplicedPath::new(trees, parts.clone());
    let compliance = |j: usize| {
        if j == 0 || j + 1 == plain.len() {
            return 0.0;
        }
        let (a, b, c) = (plain.point(j - 1), plain.point(j), plain.point(j + 1));
        (c - a).norm_sqr() / ((b - a).norm_sqr() * (c - b).norm_sqr())
    };
    let mut next = 0;
    for part in &mut parts {
        let last = next + part.points.1 - part.points.0;
        part.compliances = (compliance(next), compliance(last));
        next = last + 1;
    }
    SplicedPath::new(trees, parts)
}

/// What-if energy of `stretches` in place of path 0, whose frames keep their rows where they first appear; and that of a full
/// solve.
fn both_energies(scene: &Scene, stretches: &[(usize, usize, usize)]) -> (f64, f64) {
    let springs: Vec<SpringPath> =
        scene.paths.iter().map(|path| SpringPath::of_shape(path.clone())).collect();
    let trees: Vec<MomentTree> = springs.iter().map(MomentTree::new).collect();
    let problem = Compliance::new(springs, scene.rows.clone());
    let factor = problem.analyse().expect("sound").factor(&problem).expect("regular");
    let mut bent = Bent::new(&problem, &factor);
    bent.solve(&problem, &factor, &scene.targets).expect("an answer");
    let response = PathResponse::new(&problem, &factor, 0);
    let path = spliced(&trees, &scene.paths, stretches);
    let moved = |frame: usize| {
        let mut start = 0;
        for (source, first, last) in stretches {
            if *source == 0 && (*first..=*last).contains(&frame) {
                return start + frame - first;
            }
            start += last - first + 1;
        }
        unreachable!("candidates keep the frames of rows")
    };
    let mut changed = scene.clone();
    changed.paths[0] = (0..path.len()).map(|j| path.point(j)).collect();
    for row in &mut changed.rows {
        row.terms.iter_mut().filter(|term| term.0 == 0).for_each(|term| term.1 = moved(term.1));
    }
    let own = |row: &usize| {
        let terms = changed.rows[*row].terms.iter().filter(|term| term.0 == 0);
        terms.map(|(_, point, value)| (*point, *value)).collect()
    };
    let change = Change {
        path: &path,
        terms: response.rows.iter().map(own).collect(),
        targets: response.rows.iter().map(|row| scene.targets[*row]).collect(),
    };
    let energy = response.energy(&problem, (&bent, &scene.targets), &change).expect("a regular candidate");
    let full = full_energy(&changed);
    if let Some(exchanged) = problem.with_path(0, Arc::new(path.listed()), given(&changed.rows), None) {
        assert_same((exchanged_energy(&response, (&problem, &factor), (&exchanged, &scene.targets)), full));
    }
    (energy, full)
}

/// Energy of a problem with another path, solved by the factorisation of the present one.
fn exchanged_energy(
    response: &PathResponse,
    present: (&Compliance, &ComplianceFactor),
    (exchanged, targets): (&Compliance, &[c64]),
) -> f64 {
    let factor = response.factor(present, exchanged, None).expect("a regular candidate");
    Bent::new(exchanged, &factor).solve(exchanged, &factor, targets).expect("an answer").energy
}

#[test]
fn a_path_exchanged_for_itself_changes_nothing() {
    let scene = scene_m();
    let springs: Vec<SpringPath> =
        scene.paths.iter().map(|path| SpringPath::of_shape(path.clone())).collect();
    let problem = Compliance::new(springs.clone(), scene.rows.clone());
    let factor = problem.analyse().expect("sound").factor(&problem).expect("regular");
    for (path, springs) in springs.into_iter().enumerate() {
        let response = PathResponse::new(&problem, &factor, path);
        let same =
            problem.with_path(path, Arc::new(springs), given(&scene.rows), None).expect("the same unknowns");
        let energy = exchanged_energy(&response, (&problem, &factor), (&same, &scene.targets));
        assert_same((energy, full_energy(&scene)));
    }
}

/// A path exchanged in one problem, then in others of which another path was changed: what the first exchange found is taken
/// over where it holds, scaled anew.
#[test]
fn an_exchange_taken_over_from_another_problem_has_the_energy_of_a_full_solve() {
    let shaped = |path: &[c64]| SpringPath::of_shape(path.to_vec());
    let wide = |path: &[c64], share: f64| -> Vec<c64> {
        path.iter().map(|p| share * p + c64::new(0.0, 0.02 * (3.0 * p.re).sin())).collect()
    };
    let rest = scene_m();
    let (other, another) = (wide(&rest.paths[0], 1.4), wide(&rest.paths[0], 0.7));
    let mut known: Option<(Compliance, ComplianceFactor)> = None;
    let springs = Arc::new(shaped(&other));
    for (size, path) in [(1.0, &other), (3.0, &other), (0.1, &other), (0.1, &another), (2.0, &other)] {
        let mut scene = rest.clone();
        scene.paths[1] = wide(&rest.paths[1], size);
        let problem =
            Compliance::new(scene.paths.iter().map(|path| shaped(path)).collect(), scene.rows.clone());
        let factor = problem.analyse().expect("sound").factor(&problem).expect("regular");
        let response = PathResponse::new(&problem, &factor, 0);
        let springs = if *path == other { Arc::clone(&springs) } else { Arc::new(shaped(path)) };
        let (problem_before, factor_before) =
            (known.as_ref().map(|own| &own.0), known.as_ref().map(|own| &own.1));
        let exchanged =
            problem.with_path(0, springs, given(&scene.rows), problem_before).expect("the same unknowns");
        let update =
            response.factor((&problem, &factor), &exchanged, factor_before).expect("a regular candidate");
        let solved =
            Bent::new(&exchanged, &update).solve(&exchanged, &update, &scene.targets).expect("an answer");
        scene.paths[0].clone_from(path);
        assert_same((solved.energy, full_energy(&scene)));
        known = Some((exchanged, update));
    }
}

fn assert_same((energy, full): (f64, f64)) {
    let allowed = (ENERGIES.0 * full).max(ENERGIES.1);
    assert!(
        (energy - full).abs() <= allowed,
        "{energy:e} is not {full:e}: {:e}",
        (energy / full - 1.0).abs()
    );
}

#[test]
fn the_printed_candidate_has_its_printed_energy() {
    let scene = scene_m();
    assert!((full_energy(&scene) / 3.471_964_989_6e-7 - 1.0).abs() < 1e-8);
    let duplicated = [(0, 0, 60), (0, 41, 199)];
    let trees: Vec<MomentTree> =
        scene.paths.iter().map(|path| MomentTree::new(&SpringPath::of_shape(path.clone()))).collect();
    let path = spliced(&trees, &scene.paths, &duplicated);
    assert_eq!(path.len(), 220);
    assert!((path.point(100) - c64::new(3.965_173_477_941_7, -0.734_189_866_587_137)).norm() < 1e-12);
    assert!((path.point(219) - c64::new(8.723_449_998_119_75, -0.911_757_706_189_773)).norm() < 1e-12);
    let (energy, full) = both_energies(&scene, &duplicated);
    assert!((energy / 7.143_421_607_3e-8 - 1.0).abs() < 1e-8, "{energy:e}");
    assert_same((energy, full));
}

#[test]
fn listed_splices_have_the_moments_of_the_splice() {
    let scene = scene_m();
    let trees: Vec<MomentTree> =
        scene.paths.iter().map(|path| MomentTree::new(&SpringPath::of_shape(path.clone()))).collect();
    let path = spliced(&trees, &scene.paths, &[(0, 0, 30), (2, 7, 7), (1, 20, 61), (0, 60, 199)]);
    let listed = path.listed();
    for (from, to) in [(0, 0), (0, 213), (3, 31), (30, 33), (31, 32), (50, 180)] {
        let (a, b) = (path.moments(from, to), listed.moments(from, to));
        assert!((a.zeroth / b.zeroth - 1.0).abs() < 1e-12 || a.zeroth == b.zeroth);
        assert!((a.first - b.first).norm() <= 1e-12 * b.first.norm());
        assert!((a.second - b.second).abs() <= 1e-12 * b.second);
        assert!((a.chord - b.chord).norm() <= 1e-12);
    }
}

/// Deletion, duplication, insertion or replacement between the rows at frames `low` and `high` of path 0.
fn candidate(
    low: usize,
    high: usize,
    last: usize,
    others: Vec<usize>,
) -> impl Strategy<Value = Vec<(usize, usize, usize)>> {
    let kind = 0..4_usize;
    let frames = (low..high - 6, 2..40_usize);
    let source = (0..others.len(), 5..60_usize, 5..50_usize);
    (kind, frames, source).prop_map(move |(kind, (i, length), (other, from, count))| {
        let j = (i + length).min(high - 1);
        let middle = (other, from, (from + count).min(others[other] - 2));
        match kind {
            0 => vec![(0, 0, i), (0, j, last)],
            1 => vec![(0, 0, j), (0, i + 1, last)],
            2 => vec![(0, 0, i), middle, (0, i + 1, last)],
            _ => vec![(0, 0, i), middle, (0, j, last)],
        }
    })
}

/// A smooth walk.
fn walk(count: usize) -> impl Strategy<Value = Vec<c64>> {
    let start = (-3.0..3.0_f64, -3.0..3.0_f64, -3.0..3.0_f64);
    (start, 0.02..0.06_f64, -0.5..0.5_f64, 0.02..0.1_f64).prop_map(
        move |((x, y, heading), speed, bend, rate)| {
            let mut point = c64::new(x, y);
            let mut points = Vec::with_capacity(count);
            for i in 0..count {
                points.push(point);
                point += c64::from_polar(speed, heading + bend * (rate * i as f64).sin());
            }
            points
        },
    )
}

fn any_scene() -> impl Strategy<Value = Scene> {
    (1..5_usize).prop_flat_map(|count| {
        let paths: Vec<_> = (0..count).map(|_| walk(160)).collect();
        let pin = (
            0..count,
            2..158_usize,
            -1.0..1.0_f64,
            -1.0..1.0_f64,
            prop_oneof![Just(None), (0.5..20.0_f64).prop_map(Some)],
        );
        (
            paths,
            prop::collection::vec(pin, 0..3),
            prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 2 * count),
        )
            .prop_map(move |(paths, pins, ends)| {
                let mut scene = Scene { paths, rows: Vec::new(), targets: Vec::new() };
                for path in 1..count {
                    tie(&mut scene, (path - 1, 80), (path, 40));
                }
                // Everybody is held at the start, and hardly at the end.
                for (index, (x, y)) in ends.into_iter().enumerate() {
                    let (path, j) = (index / 2, if index % 2 == 0 { 1 } else { 159 });
                    let terms = vec![(path, j, ONE)];
                    scene.rows.push(if index % 2 == 0 {
                        PointRow::hard(terms)
                    } else {
                        PointRow::soft(terms, 0.1)
                    });
                    scene.targets.push(scene.paths[path][j] + c64::new(x, y));
                }
                for (path, j, x, y, weight) in pins {
                    if path > 0 {
                        scene
                            .rows
                            .push(PointRow { terms: vec![(path, j, ONE)], weight: weight.or(Some(3.0)) });
                        scene.targets.push(scene.paths[path][j] + c64::new(x, y));
                    }
                }
                scene
            })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn random_candidates_of_the_scene_equal_the_full_solve(
        stretches in prop_oneof![candidate(2, 98, 199, vec![200, 200, 150]), candidate(103, 196, 199, vec![200, 200, 150])],
    ) {
        assert_same(both_energies(&scene_m(), &stretches));
    }

    #[test]
    fn random_candidates_of_random_scenes_equal_the_full_solve(
        (scene, stretches) in any_scene().prop_flat_map(|scene| {
            let others = scene.paths.iter().map(Vec::len).collect();
            (Just(scene), candidate(3, 78, 159, others))
        }),
    ) {
        assert_same(both_energies(&scene, &stretches));
    }

    #[test]
    fn other_numbers_of_steps_equal_the_full_solve(
        held in prop::collection::vec((0..2_usize, 0..60_usize, prop_oneof![Just(None), (0.1..50.0_f64).prop_map(Some)], -0.5..0.5_f64), 2..7),
        ends in (1..40_usize, 1..40_usize),
        piece in 0..8_usize,
        steps in 1..90_usize,
    ) {
        let step = 1.0 / 30.0;
        let mut rows = vec![PointRow::soft(vec![(0, ends.0, 1.0), (1, ends.1, -1.0)], 2.0), PointRow::hard(vec![(0, 0, 1.0)])];
        let mut targets = vec![(ends.0 as f64 - ends.1 as f64) * step + 0.1, 0.0];
        for (track, point, weight, delay) in held {
            let hard_already = weight.is_none() && rows.len() > 4;
            rows.push(PointRow { terms: vec![(track, point, 1.0)], weight: if hard_already { Some(1.0) } else { weight } });
            targets.push(point as f64 * step + delay);
        }
        let solved = |tracks: &[Track; 2], rows: &[PointRow<f64>]| {
            let network = Network::new(tracks, step, rows, Knots::Touched).expect("sound");
            let factor = analyse(&network.problem, KktForm::Hachtel).expect("sound").factor(&network.problem).expect("regular");
            let (mut m, mut h) = network.targets();
            network.write_targets(&targets, &mut m, &mut h);
            let x = factor.solve(&m, &h).expect("an answer").x;
            let energy = network.energy(&x, &m);
            (network, factor, x, energy.springs + energy.rows)
        };
        let (network, factor, x, energy) = solved(&[Track { points: 60, tail: 0.0 }; 2], &rows);
        prop_assume!(!network.pieces.is_empty() && network.dependent.is_empty());
        let piece = piece % network.pieces.len();
        let response = StepResponse::new(&network, &factor, piece, &mut factor.workspace()).expect("regular");
        let (track, first) = network.place(network.pieces[piece].from);
        let old = network.pieces[piece].steps;
        let moved =
            |own: usize, point: usize| if own == track && point > first { point + steps - old } else { point };
        let changed: Vec<PointRow<f64>> = rows.iter().map(|row| PointRow {
            terms: row.terms.iter().map(|(own, point, a)| (*own, moved(*own, *point), *a)).collect(),
            weight: row.weight,
        }).collect();
        let (other, _, delays, full) = solved(&[Track { points: 60 + 90, tail: 0.0 }; 2], &changed);
        let found = response.restepped(&network, (&x, energy), steps);
        let close = (found.energy - full).abs() <= (ENERGIES.0 * full).max(TIME_ENERGY);
        prop_assert!(close, "{:e} is not {full:e}", found.energy);
        for knot in 0..x.len() {
            let moved = x[knot] + network.place(knot).1 as f64 * step + found.moved * response.answer()[knot];
            let expected = delays[knot] + other.place(knot).1 as f64 * step;
            prop_assert!((moved - expected).abs() < 1e-9, "knot {knot}: {moved} is not {expected}");
        }
    }
}

/// Terms and weights of rows.
fn given(rows: &[PointRow<c64>]) -> impl Iterator<Item = (&[(usize, usize, c64)], Option<f64>)> {
    rows.iter().map(|row| (row.terms.as_slice(), row.weight))
}
