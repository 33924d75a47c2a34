//! Condensed pieces of a path compose, and can be cut out, replaced and spliced.

use cotillion_solvers::{
    ChainPiece, ChainTree, KktError, SplicePart, c64, compose, condense, shape_rows, splice,
};
use paths::{ONE, ROUNDING, probes, rows, second_differences, wavy_path};
use proptest::prelude::*;

mod paths;

/// Energy of points met to rounding: squares of about 1e-14.
const NOTHING: f64 = 1e-24;

fn corners(points: &[c64], first: usize, last: usize) -> [c64; 4] {
    [points[first], points[first + 1], points[last], points[last + 1]]
}

#[test]
fn similarities_cost_a_condensed_shape_nothing() {
    let path = wavy_path(200);
    let rows = shape_rows(&path);
    for (first, last) in [(0, 198), (3, 4), (10, 12), (10, 13), (50, 150)] {
        let piece = condense(&rows[first..last], &vec![c64::default(); last - first]).expect("points differ");
        let moved = corners(&path, first, last).map(|p| c64::new(0.3, -1.2) * p + c64::new(5.0, 2.0));
        assert!(piece.energy(moved) < NOTHING, "rows {first}..{last}");
        let mut bent = moved;
        bent[3] += c64::new(0.0, 0.1);
        assert!(piece.energy(bent) > 1e-6, "rows {first}..{last}: a bend costs energy");
    }
}

fn same_energies(a: &ChainPiece, b: &ChainPiece, probes: &[[c64; 4]]) -> Result<(), TestCaseError> {
    prop_assert_eq!(a.length, b.length);
    for &probe in probes {
        let (a, b) = (a.energy(probe), b.energy(probe));
        prop_assert!((a - b).abs() < ROUNDING * (1.0 + a), "{} against {}", a, b);
    }
    Ok(())
}

proptest! {
    #[test]
    fn composition_is_associative_and_equals_condensing(
        (rows, targets) in rows(1..50), cuts in [0..50_usize, 0..50_usize], probes in probes(),
    ) {
        let piece = |from: usize, to: usize| condense(&rows[from..to], &targets[from..to]).expect("no point is free");
        let mut cuts = cuts.map(|cut| cut % (rows.len() + 1));
        cuts.sort_unstable();
        let [b, c] = cuts;
        let (left, middle, right) = (piece(0, b), piece(b, c), piece(c, rows.len()));
        let join = |left: &ChainPiece, right: &ChainPiece| compose(left, right).expect("no point is free");
        same_energies(&join(&join(&left, &middle), &right), &piece(0, rows.len()), &probes)?;
        same_energies(&join(&left, &join(&middle, &right)), &piece(0, rows.len()), &probes)?;
    }

    #[test]
    fn stretches_of_a_tree_are_condensed_rows(
        (mut rows, mut targets) in rows(1..50), (row, target) in rows(1),
        range in [0..50_usize, 0..50_usize], replaced in 0..50_usize, probes in probes(),
    ) {
        let mut tree = ChainTree::new(&rows, &targets).expect("no point is free");
        let mut range = range.map(|end| end % (rows.len() + 1));
        range.sort_unstable();
        let direct = condense(&rows[range[0]..range[1]], &targets[range[0]..range[1]]).expect("no point is free");
        same_energies(&tree.piece(range[0]..range[1]).expect("no point is free"), &direct, &probes)?;
        let replaced = replaced % rows.len();
        (rows[replaced], targets[replaced]) = (row[0], target[0]);
        tree.replace_row(replaced, row[0], target[0]).expect("no point is free");
        prop_assert_eq!(tree, ChainTree::new(&rows, &targets).expect("no point is free"));
    }
}

/// A path, and a copy of a stretch of another one put into it, turned and moved.
#[test]
fn spliced_pieces_are_those_of_the_spliced_path() {
    let (base, other) = (wavy_path(120), wavy_path(90).into_iter().map(|p| p * p).collect::<Vec<_>>());
    let turned = |p: &c64| c64::new(0.6, 0.8) * p + c64::new(7.0, -3.0);
    let path: Vec<c64> = base[..50]
        .iter()
        .copied()
        .chain(other[20..60].iter().map(turned))
        .chain(base[70..].iter().copied())
        .collect();
    let rows = shape_rows(&path);
    let zeros = vec![c64::default(); 200];
    let tree =
        |path: &[c64]| ChainTree::new(&shape_rows(path), &zeros[..path.len() - 2]).expect("points differ");
    let (base_tree, other_tree) = (tree(&base), tree(&other));
    let junction = |row: usize| SplicePart::Row { coefficients: rows[row], target: c64::default() };
    let spliced = splice(&[
        SplicePart::Stretch { tree: &base_tree, rows: 0..48 },
        junction(48),
        junction(49),
        SplicePart::Stretch { tree: &other_tree, rows: 20..58 },
        junction(88),
        junction(89),
        SplicePart::Stretch { tree: &base_tree, rows: 70..118 },
    ])
    .expect("points differ");
    let direct = condense(&rows, &zeros[..rows.len()]).expect("points differ");
    assert_eq!(spliced.length, direct.length);
    let mut probe = corners(&path, 0, rows.len());
    assert!(spliced.energy(probe) < NOTHING);
    probe[1] += c64::new(0.1, 0.2);
    probe[3] += c64::new(-0.3, 0.1);
    assert!((spliced.energy(probe) / direct.energy(probe) - 1.0).abs() < ROUNDING);
}

#[test]
fn rows_that_would_free_a_point_leave_the_tree_as_it_was() {
    let rows = second_differences(16);
    let nothing = [c64::default(); 3];
    let mut tree = ChainTree::new(&rows, &[ONE; 16]).expect("no point is free");
    tree.replace_row(5, nothing, ONE).expect("two rows still hold each point");
    tree.replace_row(6, nothing, ONE).expect("one row still holds each point");
    let before = tree.clone();
    assert_eq!(tree.replace_row(7, nothing, ONE), Err(KktError::Singular));
    assert_eq!(tree, before);
}

/// A point whose neighbours coincide has no place relative to them.
#[test]
fn shapes_of_coincident_neighbours_are_refused() {
    let mut path = wavy_path(20);
    path[7] = path[5];
    let (rows, zeros) = (shape_rows(&path), vec![c64::default(); 18]);
    let refusal = KktError::NotFinite { block: "M", row: 5 };
    assert_eq!(condense(&rows, &zeros), Err(refusal));
    assert_eq!(ChainTree::new(&rows, &zeros), Err(refusal));
    let mut tree = ChainTree::new(&shape_rows(&wavy_path(20)), &zeros).expect("points differ");
    assert!(tree.replace_row(5, rows[5], ONE).is_err());
    let refused = splice(&[SplicePart::Row { coefficients: rows[5], target: ONE }]);
    assert_eq!(refused, Err(KktError::NotFinite { block: "M", row: 0 }));
}
