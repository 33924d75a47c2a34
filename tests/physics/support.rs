//! Polygons of support.

use cotillion::physics::support::{centroid, hull, nearest, shrunk, slid};
use glam::{DVec2, DVec3};
use proptest::prelude::*;

/// Stated to nine digits.
const STATED: f64 = 1e-8;
/// Rounding of a few operations on numbers below 10.
const ROUNDING: f64 = 1e-12;

fn sole() -> Vec<DVec2> {
    hull(
        &[[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.0, 0.1], [0.1, 0.05], [0.1, 0.0], [0.2, 0.1]]
            .map(DVec2::from_array),
    )
}

fn distance(polygon: &[DVec2], x: f64, z: f64) -> (f64, DVec2) {
    let found = nearest(polygon, DVec2::new(x, z)).expect("the polygon has corners");
    (found.distance, found.point)
}

#[test]
fn a_rectangle_has_four_corners_whatever_lies_on_and_in_it() {
    assert_eq!(sole().len(), 4);
}

#[test]
fn distances_to_a_rectangle_are_those_to_its_nearest_edge_or_corner() {
    let (beside, at) = distance(&sole(), 0.3, 0.05);
    assert!((beside - 0.1).abs() < ROUNDING && at.distance(DVec2::new(0.2, 0.05)) < ROUNDING);
    let (beyond, corner) = distance(&sole(), 0.25, 0.15);
    assert!((beyond - 0.070_710_678).abs() < STATED && corner.distance(DVec2::new(0.2, 0.1)) < ROUNDING);
    assert!((distance(&sole(), -0.1, -0.2).0 - 0.223_606_798).abs() < STATED);
    assert_eq!(distance(&sole(), 0.1, 0.07), (0.0, DVec2::new(0.1, 0.07)));
}

#[test]
fn segments_and_points_have_distances_too() {
    let segment = hull(&[DVec2::ZERO, DVec2::new(0.1, 0.0), DVec2::new(0.2, 0.0)]);
    assert_eq!(segment.len(), 2);
    assert!((distance(&segment, 0.3, 0.1).0 - 0.141_421_356).abs() < STATED);
    // On the line through it, but beyond its end: no inside test may see it.
    assert!((distance(&segment, 0.3, 0.0).0 - 0.1).abs() < ROUNDING);
    let point = hull(&[DVec2::ONE, DVec2::ONE + DVec2::splat(1e-10)]);
    assert_eq!(point.len(), 1);
    assert!((distance(&point, 1.0, 3.0).0 - 2.0).abs() < 1e-9);
    assert_eq!(nearest(&[], DVec2::ZERO), None);
}

#[test]
fn a_margin_moves_edges_inwards_but_never_beyond_the_middle() {
    let small = shrunk(&sole(), 0.02);
    assert_eq!(small.len(), 4);
    assert!((distance(&small, 0.0, 0.05).0 - 0.02).abs() < ROUNDING);
    let thin = shrunk(&sole(), 0.07);
    assert!((distance(&thin, 0.1, 0.0).0 - 0.05).abs() < 1e-9, "{thin:?}");
    assert!((distance(&thin, 0.0, 0.05).0 - 0.07).abs() < 1e-9, "{thin:?}");
    let gone = shrunk(&sole(), 3.0);
    assert!((distance(&gone, 0.0, 0.0).0 - 0.1_f64.hypot(0.05)).abs() < 1e-9, "{gone:?}");
    let segment = shrunk(&[DVec2::ZERO, DVec2::X], 0.3);
    assert!((distance(&segment, 0.0, 0.0).0 - 0.3).abs() < ROUNDING);
    assert_eq!(shrunk(&sole(), 0.0), sole());
}

#[test]
fn a_contact_slides_along_the_force_onto_the_plane() {
    let step = slid(DVec3::new(0.3, 0.2, 0.1), DVec3::new(50.0, 500.0, -100.0), 0.0);
    assert!(step.distance(DVec2::new(0.28, 0.14)) < ROUNDING);
}

fn points() -> impl Strategy<Value = Vec<DVec2>> {
    prop::collection::vec([-1.0..1.0_f64, -1.0..1.0].prop_map(DVec2::from_array), 3..14)
}

proptest! {
    #[test]
    fn every_point_is_inside_its_hull_which_turns_one_way(points in points()) {
        let corners = hull(&points);
        for point in &points {
            prop_assert!(nearest(&corners, *point).is_some_and(|found| found.distance < 1e-8));
        }
        for k in 0..corners.len() {
            let [a, b, c] = [0, 1, 2].map(|step| corners[(k + step) % corners.len()]);
            prop_assert!((b - a).perp_dot(c - b) > 0.0);
        }
    }

    /// Against sampling: no point of the polygon is nearer than the one found.
    #[test]
    fn nothing_of_the_polygon_is_nearer(points in points(), x in -2.0..2.0_f64, z in -2.0..2.0_f64, s in 0.0..1.0_f64, t in 0.0..1.0_f64) {
        let corners = hull(&points);
        let from = DVec2::new(x, z);
        let found = nearest(&corners, from).expect("there are corners");
        for k in 0..corners.len() {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            let inside = corners[0].lerp(a.lerp(b, s), t);
            prop_assert!(from.distance(inside) >= found.distance - ROUNDING);
        }
        prop_assert!(nearest(&corners, found.point).is_some_and(|again| again.distance < 1e-9));
    }

    #[test]
    fn the_centroid_stays_inside_whatever_the_margin(points in points(), margin in 0.0..3.0_f64) {
        let corners = hull(&points);
        let middle = centroid(&corners).expect("there are corners");
        let small = shrunk(&corners, margin);
        prop_assert!(nearest(&small, middle).is_some_and(|found| found.distance < 1e-7), "{small:?}");
        for corner in &small {
            prop_assert!(nearest(&corners, *corner).is_some_and(|found| found.distance < 1e-7));
        }
    }
}
