//! The graph against the whole matrix, and what must hold of any.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use proptest::prelude::*;

use super::thinning::Pair;
use super::*;
use crate::clip::builtin::generate;
use crate::clip::contacts::Contacts;
use crate::geometry::{RigidMotion, c64, yaw};
use crate::index::{SourceFrame, floor_index};
use crate::similarity::NEIGHBOURS;

/// Rounding of features of a few units, and of the distances between them.
const ROUNDING: f64 = 1e-12;

fn working(name: &str, parameters: &[(&str, f64)]) -> Arc<WorkingClip> {
    let parameters: BTreeMap<String, f64> = parameters.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect();
    let clip = Arc::new(generate(name, &parameters).expect("a generated clip"));
    let (first, last) = clip.usable;
    Arc::new(WorkingClip::new(name, clip, first, last))
}

fn side(frames: &[[f64; 3]], feet: &[[bool; 2]]) -> Side {
    let features = Features { width: 3, values: frames.concat() };
    Side { factors: Factors::new(&features), features, feet: Feet { bear: feet.to_vec(), apart: None } }
}

/// Local maxima of the whole matrix, from the most alike on, each unless an accepted one is near.
fn by_the_book(block: &Block) -> Vec<(usize, usize)> {
    let count = |side: &Side| side.feet.bear.len();
    let distance_sq = |i: usize, j: usize| block.rows.features.distance_sq(i, &block.columns.features, j);
    let is_ridge = block.settings.maxima == Maxima::Ridge;
    let is_maximum = |i: usize, j: usize| {
        (-1_isize..=1).all(|down| {
            (-1_isize..=1).all(|right| {
                let place = i.checked_add_signed(down).zip(j.checked_add_signed(right));
                let inside = place.filter(|(i, j)| *i < count(block.rows) && *j < count(block.columns));
                let Some((k, l)) = inside.filter(|_| (down, right) != (0, 0)) else { return true };
                let (own, other) = (distance_sq(i, j), distance_sq(k, l));
                match is_ridge {
                    true => down == right || own <= other,
                    false => own < other || (own == other && (k, l) > (i, j)),
                }
            })
        })
    };
    let agree = |i: usize, j: usize| {
        block.rows.feet.agree(i, &block.columns.feet, j, block.settings.contact_tolerance)
    };
    let mut candidates: Vec<(usize, usize, usize)> = (0..count(block.rows))
        .flat_map(|i| (0..count(block.columns)).map(move |j| (i, j)))
        .filter(|(i, j)| !block.is_diagonal || *j >= i + NEIGHBOURS)
        .filter(|(i, j)| distance_sq(*i, *j) < block.largest_sq && agree(*i, *j) && is_maximum(*i, *j))
        .map(|(i, j)| (floor_index((distance_sq(i, j).sqrt() / 1e-9).round()), i, j))
        .collect();
    candidates.sort_unstable();
    let mut accepted: Vec<(usize, usize)> = Vec::new();
    for (_, i, j) in candidates {
        let is_near = |(k, l): &(usize, usize)| {
            let (diagonals, along) = ((j + k).abs_diff(i + l), (i + j).abs_diff(k + l));
            diagonals <= 1 && along <= 10
        };
        if !is_ridge || !accepted.iter().any(is_near) {
            accepted.push((i, j));
        }
    }
    accepted.sort_unstable();
    accepted
}

/// Frames with few values, so that many distances are equal; or with any.
fn frames() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let of_few = prop::collection::vec([0..3_i32, 0..3, 0..2].prop_map(|v| v.map(f64::from)), 12..40);
    let wave =
        (8_usize..20, 0.0..0.3_f64, prop::collection::vec([-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], 12..60));
    let of_any = wave.prop_map(|(period, noise, values)| {
        let phase = |k: usize| 2.0 * PI * k as f64 / period as f64;
        values
            .iter()
            .enumerate()
            .map(|(k, v)| [phase(k).cos() + noise * v[0], phase(k).sin() + noise * v[1], noise * v[2]])
            .collect()
    });
    prop_oneof![of_few, of_any]
}

fn feet(count: usize, bits: u64) -> Vec<[bool; 2]> {
    (0..count).map(|k| [(bits >> (k / 3 % 64)) & 1 == 1, (bits >> (k / 5 % 64)) & 1 == 1]).collect()
}

proptest! {
    /// Neither tiles nor bands nor rounding of the products are seen in the result.
    #[test]
    fn tile_by_tile_it_is_what_the_whole_matrix_gives(
        (a, b) in (frames(), frames()),
        bits in any::<u64>(),
        (is_diagonal, is_strict) in any::<(bool, bool)>(),
        tile in (1_usize..12, 1_usize..12),
        largest in 0.2..2.0_f64,
        contact_tolerance in 0_usize..2,
    ) {
        let (rows, columns) = (side(&a, &feet(a.len(), bits)), side(&b, &feet(b.len(), !bits)));
        let maxima = if is_strict { Maxima::Strict8 } else { Maxima::Ridge };
        let block = Block {
            rows: &rows,
            columns: if is_diagonal { &rows } else { &columns },
            is_diagonal,
            largest_sq: largest * largest,
            settings: GraphSettings { maxima, contact_tolerance, ..GraphSettings::default() },
            tile,
        };
        let mut found: Vec<(usize, usize)> = block.pairs().iter().map(|pair: &Pair| (pair.row, pair.column)).collect();
        found.sort_unstable();
        prop_assert_eq!(found, by_the_book(&block));
    }

    #[test]
    fn a_product_is_as_near_to_the_sum_of_squares_as_it_says(
        (a, b) in (frames(), frames()), scale in 1e-3..1e3_f64,
    ) {
        let scaled = |frames: &[[f64; 3]]| frames.iter().map(|f| f.map(|v| v * scale)).collect::<Vec<_>>();
        let (a, b) = (side(&scaled(&a), &[]), side(&scaled(&b), &[]));
        let (rows, columns) = (a.features.values.len() / 3, b.features.values.len() / 3);
        let nearly = a.factors.distances_sq(0..rows, &b.factors, 0..columns);
        let most = a.factors.rounding(&b.factors);
        for i in 0..rows {
            for j in 0..columns {
                prop_assert!((nearly[(i, j)] - a.features.distance_sq(i, &b.features, j)).abs() <= most);
            }
        }
    }

    /// Moving or turning what one of two frames was cut from changes nothing.
    #[test]
    fn distances_ignore_where_on_the_ground_a_clip_lies(
        turn in -PI..PI, shift in [-5.0..5.0_f64, -5.0..5.0],
    ) {
        let walk = working("walk", &[("seconds", 3.0)]);
        let motion = RigidMotion::carrying(c64::new(0.0, 0.0), c64::new(shift[0], shift[1]), turn);
        let mut clip = (*walk.clip).clone();
        let joints = clip.skeleton.joints.len();
        for (frame, root) in clip.root_positions.iter_mut().enumerate() {
            *root = motion.apply_world(*root);
            clip.rotations[frame * joints] = yaw(turn) * clip.rotations[frame * joints];
        }
        let (first, last) = clip.usable;
        let moved = WorkingClip::new("moved", Arc::new(clip), first, last);
        let mean = mean_rotations(&[&walk]);
        let (at_home, elsewhere) = (features(&walk, &mean), features(&moved, &mean));
        for i in (0..walk.frame_count()).step_by(7) {
            for j in (0..walk.frame_count()).step_by(3) {
                let expected = at_home.distance(i, &at_home, j);
                prop_assert!((elsewhere.distance(i, &at_home, j) - expected).abs() < ROUNDING);
                prop_assert!((elsewhere.distance(i, &elsewhere, j) - expected).abs() < ROUNDING);
            }
        }
    }
}

#[test]
fn distances_are_symmetric_and_nothing_is_nearer_than_itself() {
    let walk = working("walk", &[]);
    let features = features(&walk, &mean_rotations(&[&walk]));
    for i in 0..walk.frame_count() {
        assert_eq!(features.distance(i, &features, i), 0.0);
        for j in 0..i {
            let (there, back) = (features.distance(i, &features, j), features.distance(j, &features, i));
            assert_eq!(there.to_bits(), back.to_bits());
        }
    }
}

/// Periods of the generated gaits at their default speeds, frames.
const PERIODS: [(&str, usize); 2] = [("walk", 34), ("run", 22)];

#[test]
fn a_periodic_clip_goes_on_only_after_whole_cycles() {
    for (name, period) in PERIODS {
        let clip = working(name, &[("seconds", 12.0)]);
        let ridge = motion_graph(std::slice::from_ref(&clip), &GraphSettings::default());
        let strict = GraphSettings { maxima: Maxima::Strict8, ..GraphSettings::default() };
        let strict = motion_graph(std::slice::from_ref(&clip), &strict);
        for graph in [&ridge, &strict] {
            assert!(graph.pairs().count() > 10, "{name}");
            for (i, j, _) in graph.pairs() {
                assert_eq!((j.0 - i.0) as usize % period, 0, "{name}: {i:?} {j:?}");
            }
        }
        // One pair in six frames along each diagonal, where ties are broken by their numbers.
        let frames = clip.frame_count();
        let expected: usize = (1..frames / period + 1).map(|m| (frames - m * period).div_ceil(6)).sum();
        let kept = ridge.pairs().count();
        assert!(kept.abs_diff(expected) * 5 < expected, "{name}: {kept} of about {expected}");
    }
}

#[test]
fn similar_frames_are_sorted_mutual_and_near() {
    let clips =
        [working("walk", &[("start", 1.0)]), working("idle", &[]), working("walk", &[("speed", 1.3)])];
    let graph = motion_graph(&clips, &GraphSettings::default());
    assert_eq!((graph.bodies.len(), graph.frame_count()), (1, clips.iter().map(|c| c.frame_count()).sum()));
    let mut across = 0;
    for i in (0..graph.frame_count()).map(GraphFrame::from_usize) {
        let own: Vec<(GraphFrame, f64)> = graph.similar_to(i).collect();
        assert!(own.windows(2).all(|pair| pair[0].0 < pair[1].0));
        for (j, distance) in own {
            assert!(distance <= graph.bodies[0].largest);
            assert!(graph.similar_to(j).any(|back| back == (i, distance)));
            let ((a, _), (b, _)) = (graph.place(i), graph.place(j));
            assert!(a != b || i.0.abs_diff(j.0) as usize >= NEIGHBOURS);
            across += usize::from(a != b);
        }
    }
    assert!(across > 0, "clips of one body are compared");
    for (clip, working) in clips.iter().enumerate() {
        let last = FrameIndex::from_usize(working.frame_count() - 1);
        assert_eq!(graph.place(graph.frame(clip, last)), (clip, last));
    }
}

#[test]
fn clips_of_different_bodies_are_not_compared() {
    let clips = [working("walk", &[]), working("walk", &[("stature", 1.6)]), working("walk", &[])];
    let graph = motion_graph(&clips, &GraphSettings::default());
    assert_eq!(graph.clips.iter().map(|clip| clip.body).collect::<Vec<_>>(), [0, 1, 0]);
    let between = |a: usize, b: usize| {
        graph.pairs().filter(|(i, j, _)| (graph.place(*i).0, graph.place(*j).0) == (a, b)).count()
    };
    assert_eq!((between(0, 1), between(1, 2)), (0, 0));
    assert!(between(0, 2) > 0 && between(1, 1) > 0);
}

#[test]
fn a_graph_does_not_depend_on_the_number_of_threads() {
    let clips = [working("walk", &[("seconds", 20.0), ("turn", 20.0)]), working("walk", &[("start", 1.0)])];
    let made = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
        pool.install(|| motion_graph(&clips, &GraphSettings::default()))
    });
    assert!(made[0] == made[1] && made[0] == made[2]);
}

#[test]
fn what_has_no_frames_to_compare_has_no_transitions() {
    assert_eq!(motion_graph(&[], &GraphSettings::default()).frame_count(), 0);
    let walk = working("walk", &[]);
    for last in [0, 1, 5] {
        let short = WorkingClip::new("short", walk.clip.clone(), SourceFrame(0), SourceFrame(last));
        let frames = short.frame_count();
        let graph = motion_graph(&[Arc::new(short)], &GraphSettings::default());
        assert_eq!((graph.frame_count(), graph.similar.len()), (frames, 0));
    }
}

#[test]
fn feet_that_do_otherwise_keep_frames_apart() {
    let walk = working("walk", &[("seconds", 6.0)]);
    let graph = motion_graph(std::slice::from_ref(&walk), &GraphSettings::default());
    let mut lifted = (*walk).clone();
    let half = lifted.contacts.len() / 2;
    lifted.contacts[half..].fill(Contacts::default());
    let without = motion_graph(&[Arc::new(lifted)], &GraphSettings::default());
    let crossing = |graph: &MotionGraph| {
        graph.pairs().filter(|(i, j, _)| i.as_usize() + 2 < half && j.as_usize() > half + 2).count()
    };
    assert!(crossing(&graph) > 0 && crossing(&without) == 0);
}
