//! Outlines of balls seen from far away: the convex hull of their disks.

use std::f64::consts::TAU;

use crate::export::picture::svg::Point;

/// A ball as it is seen: its middle and its radius, in one unit.
pub(in crate::export::picture) type Disk = (Point, f64);

/// Corners of the convex hull of `disks`, each taken as a polygon of `corners` corners; counter-clockwise where y points
/// up. Cost: n log n in all corners.
///
/// Source: A. M. Andrew, *Another efficient algorithm for convex hulls in two dimensions*, 1979.
pub(in crate::export::picture) fn hull(disks: &[Disk], corners: u32) -> Vec<Point> {
    let mut points: Vec<Point> = disks.iter().flat_map(|disk| rim(*disk, corners)).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut outline = half_hull(points.iter().copied());
    outline.extend(half_hull(points.iter().rev().copied()));
    outline
}

fn rim(([x, y], radius): Disk, corners: u32) -> impl Iterator<Item = Point> {
    (0..corners).map(move |corner| {
        let (sine, cosine) = (TAU * f64::from(corner) / f64::from(corners)).sin_cos();
        [x + radius * cosine, y + radius * sine]
    })
}

/// The hull from the first point to the last, on the right of the way; the last one is left out.
fn half_hull(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for point in points {
        while let [.., a, b] = kept[..]
            && cross(a, b, point) <= 0.0
        {
            kept.pop();
        }
        kept.push(point);
    }
    kept.pop();
    kept
}

/// Twice the area of the triangle, positive where it is walked counter-clockwise.
fn cross(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_holds_every_disk_and_turns_one_way() {
        let disks = [([0.0, 0.0], 1.0), ([3.0, 0.5], 0.4), ([1.0, 0.2], 0.1), ([-1.0, 2.0], 0.7)];
        let outline = hull(&disks, 24);
        for (index, a) in outline.iter().enumerate() {
            let (b, c) = (outline[(index + 1) % outline.len()], outline[(index + 2) % outline.len()]);
            assert!(cross(*a, b, c) > 0.0);
            for (centre, radius) in disks {
                let length = (b[0] - a[0]).hypot(b[1] - a[1]);
                // A polygon of 24 corners lies within 1 % of its circle.
                assert!(cross(*a, b, centre) / length > 0.99 * radius - 1e-12);
            }
        }
    }

    #[test]
    fn no_disk_has_no_hull() {
        assert!(hull(&[], 8).is_empty());
    }
}
