//! Where the plan lies on the sheet.

use super::extent::bounds;
use super::svg::{Point, Rect};
use crate::geometry::c64;
use crate::object::ObjectPose;

/// Space between the outermost point and the frame, px.
const PADDING: f64 = 46.0;
/// Least height of the frame, px.
const LOWEST: f64 = 270.0;
/// Smallest extent drawn, metres.
const LEAST_EXTENT: f64 = 1.0;
/// Coordinates beyond are left out, metres.
const FURTHEST: f64 = 1e12;

/// Map from plan metres to the sheet, at equal scales.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// Frame of the plan on the sheet.
    pub frame: Rect,
    /// Pixels a metre.
    pub scale: f64,
    /// Plan point in the middle of the frame.
    pub centre: c64,
}

impl View {
    /// Fits what lies between two corners into a frame with its upper left corner at `corner`, of width `width`, at most
    /// `highest` high.
    pub(super) fn fit((low, high): (c64, c64), corner: Point, (width, highest): (f64, f64)) -> Self {
        let centre = (low + high) / 2.0;
        let least = LEAST_EXTENT.max(centre.norm() * 1e-6);
        let size = high - low;
        let (across, up) = (size.re.max(least), size.im.max(least));
        let scale = ((width - 2.0 * PADDING) / across).min((highest - 2.0 * PADDING) / up);
        let height = (up * scale + 2.0 * PADDING).clamp(LOWEST, highest);
        View { frame: Rect { x: corner[0], y: corner[1], w: width, h: height }, scale, centre }
    }

    /// Fits points into a frame.
    pub(super) fn enclosing(points: impl Iterator<Item = c64>, frame: Rect) -> Self {
        let (low, high) = bounds(points);
        let centre = (low + high) / 2.0;
        let least = LEAST_EXTENT.max(centre.norm() * 1e-6);
        let (across, up) = ((high - low).re.max(least), (high - low).im.max(least));
        let scale = ((frame.w - 2.0 * PADDING) / across).min((frame.h - 2.0 * PADDING) / up);
        View { frame, scale, centre }
    }

    /// Place of a plan point.
    pub(super) fn place(&self, point: c64) -> Point {
        let from_centre = (point - self.centre) * self.scale;
        [
            self.frame.x + self.frame.w / 2.0 + from_centre.re,
            self.frame.y + self.frame.h / 2.0 - from_centre.im,
        ]
    }

    /// Plan points of the frame's lower left and upper right corners.
    pub(super) fn corners(&self) -> (c64, c64) {
        let half = c64::new(self.frame.w, self.frame.h) / (2.0 * self.scale);
        (self.centre - half, self.centre + half)
    }

    /// A path on the sheet, without points that lie less than `spacing` px from the one before.
    pub(super) fn path(&self, path: &[c64], spacing: f64) -> Vec<Point> {
        let mut points: Vec<Point> = Vec::new();
        let drawable = || path.iter().filter(|point| is_drawable(**point));
        for point in drawable().map(|point| self.place(*point)) {
            if points.last().is_none_or(|last| distance(*last, point) >= spacing) {
                points.push(point);
            }
        }
        if let Some(last) = drawable().next_back().map(|point| self.place(*point))
            && points.last() != Some(&last)
        {
            points.push(last);
        }
        points
    }
}

/// Whether a point can be drawn: finite and not absurdly far.
pub(super) fn is_drawable(point: c64) -> bool {
    point.re.abs() <= FURTHEST && point.im.abs() <= FURTHEST
}

/// Distance on the sheet, px.
pub(super) fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Point `length` px from `from` in a direction of the plan.
pub(super) fn towards(from: Point, heading: f64, length: f64) -> Point {
    [from[0] + length * heading.cos(), from[1] - length * heading.sin()]
}

/// Corners of an object's base at a pose: front left, front right, back right, back left.
pub(super) fn base(size: [f64; 3], pose: &ObjectPose) -> [c64; 4] {
    let (ahead, left) = (size[0] / 2.0, size[2] / 2.0);
    [(ahead, left), (ahead, -left), (-ahead, -left), (-ahead, left)].map(|(x, y)| pose.beside(c64::new(x, y)))
}
