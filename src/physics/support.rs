//! Support polygons on the plan, points `(x, z)` of the world: hull, distance, projection, margin.

use glam::{DVec2, DVec3};

/// Points nearer than this are one, metres.
const SAME_POINT: f64 = 1e-9;

/// Convex hull of `points` counter-clockwise in (x, z), without collinear and repeated points: none, one, two or at least three
/// corners. Cost: `n log n`.
///
/// Source: Andrew's monotone chain, *Another efficient algorithm for convex hulls in two dimensions*, 1979.
pub fn hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut apart: Vec<DVec2> = Vec::with_capacity(sorted.len());
    for point in sorted {
        if apart.iter().all(|other| other.distance(point) > SAME_POINT) {
            apart.push(point);
        }
    }
    if apart.len() < 3 {
        return apart;
    }
    let mut lower = chain(apart.iter().copied());
    let mut upper = chain(apart.iter().rev().copied());
    // Each chain ends where the other begins.
    lower.pop();
    upper.pop();
    lower.append(&mut upper);
    lower
}

/// The turns to the left along `points`, first and last included.
fn chain(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut chain: Vec<DVec2> = Vec::new();
    for point in points {
        while let [.., a, b] = chain[..] {
            // A corner nearer to the line through its neighbours than points that are one is no corner.
            if (b - a).perp_dot(point - a) > SAME_POINT * point.distance(a) {
                break;
            }
            chain.pop();
        }
        chain.push(point);
    }
    chain
}

/// A point of a polygon and how far it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// `(x, z)`, metres.
    pub point: DVec2,
    /// Metres; 0 inside.
    pub distance: f64,
}

/// The point of `polygon` (of [`hull`]) nearest to `point`: the point itself inside; `None` without corners.
pub fn nearest(polygon: &[DVec2], point: DVec2) -> Option<Nearest> {
    let first = *polygon.first()?;
    if polygon.len() > 2 && edges(polygon).all(|(a, b)| (b - a).perp_dot(point - a) >= 0.0) {
        return Some(Nearest { point, distance: 0.0 });
    }
    let start = Nearest { point: first, distance: point.distance(first) };
    let on_edges = edges(polygon).map(|(a, b)| {
        let on = on_segment(a, b, point);
        Nearest { point: on, distance: point.distance(on) }
    });
    Some(on_edges.fold(start, |best, other| if other.distance < best.distance { other } else { best }))
}

fn edges(polygon: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    let next = polygon.iter().skip(1).chain(polygon.first());
    polygon.iter().copied().zip(next.copied())
}

fn on_segment(a: DVec2, b: DVec2, point: DVec2) -> DVec2 {
    let along = b - a;
    let length_sq = along.length_squared();
    let share = if length_sq > 0.0 { ((point - a).dot(along) / length_sq).clamp(0.0, 1.0) } else { 0.0 };
    a + share * along
}

/// Centre of area of `polygon` (of [`hull`]), of a segment its middle; `None` without corners.
pub fn centroid(polygon: &[DVec2]) -> Option<DVec2> {
    let first = *polygon.first()?;
    if let [a, b] = *polygon {
        return Some(a.midpoint(b));
    }
    let (mut area, mut sum) = (0.0, DVec2::ZERO);
    for (a, b) in edges(polygon) {
        let double = (a - first).perp_dot(b - first);
        area += double;
        sum += double * ((a - first) + (b - first)) / 3.0;
    }
    Some(if area > 0.0 { first + sum / area } else { first })
}

/// `polygon` (of [`hull`]) with every edge moved inwards by `margin` metres, but never beyond the centroid; a segment is shortened
/// at both ends, at most to its middle.
pub fn shrunk(polygon: &[DVec2], margin: f64) -> Vec<DVec2> {
    let Some(center) = centroid(polygon) else {
        return Vec::new();
    };
    if margin <= 0.0 || polygon.len() == 1 {
        return polygon.to_vec();
    }
    if let [a, b] = *polygon {
        let share = (margin / a.distance(b)).min(0.5);
        return hull(&[a.lerp(b, share), b.lerp(a, share)]);
    }
    let mut left = polygon.to_vec();
    for (a, b) in edges(polygon) {
        let inwards = (b - a).perp() / a.distance(b);
        let limit = inwards.dot(a) + margin.min(inwards.dot(center - a));
        left = cut(&left, inwards, limit);
    }
    // Rounding may cut away all where every edge meets the centroid.
    if left.is_empty() { vec![center] } else { hull(&left) }
}

/// The part of a convex polygon with `inwards · p ≥ limit`.
///
/// Source: Sutherland and Hodgman, *Reentrant polygon clipping*, 1974.
fn cut(polygon: &[DVec2], inwards: DVec2, limit: f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (a, b) in edges(polygon) {
        let (over_a, over_b) = (inwards.dot(a) - limit, inwards.dot(b) - limit);
        if over_a >= 0.0 {
            kept.push(a);
        }
        if (over_a >= 0.0) != (over_b >= 0.0) {
            kept.push(a.lerp(b, over_a / (over_a - over_b)));
        }
    }
    kept
}

/// Where the line through `contact` along `force` meets the height `height`, `(x, z)`, metres: contacts at different heights bear
/// as if they were there, exactly if their forces are parallel to the total `force`.
///
/// A force that does not push upwards moves nothing.
pub fn slid(contact: DVec3, force: DVec3, height: f64) -> DVec2 {
    let rise = contact.y - height;
    let slope = if force.y > 0.0 { rise / force.y } else { 0.0 };
    DVec2::new(contact.x - force.x * slope, contact.z - force.z * slope)
}
