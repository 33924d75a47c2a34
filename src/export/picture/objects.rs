//! Objects from above: where they stand, the way of those that move, where they are grasped and released.

use super::PictureObject;
use super::svg::{Point, Sheet};
use super::view::{View, base, is_drawable};
use crate::geometry::c64;
use crate::object::ObjectPose;

/// Outline of objects, and of what belongs to them.
pub(super) const OUTLINE: &str = "#8d8470";
/// Half the side of the mark of a grasp or release, px.
const MARK: f64 = 3.4;

/// A rectangle with a wedge at its front; of one that moves also its way, and where it ends, hollow.
pub(super) fn draw_object(sheet: &mut Sheet, view: &View, object: &PictureObject) {
    let (Some(first), Some(last)) = (object.poses.first(), object.poses.last()) else { return };
    sheet.open("", object.name);
    let way: Vec<c64> = object.poses.iter().map(ObjectPose::plan).collect();
    let points = view.path(&way, 0.7);
    if points.len() > 1 {
        sheet.polyline(&points, &way_pen());
    }
    draw_box(sheet, view, base(object.size, first), "#efe9dd");
    if last != first {
        draw_box(sheet, view, base(object.size, last), "none");
    }
    for (places, fill) in [(&object.grasped, OUTLINE), (&object.released, "#ffffff")] {
        for place in places.iter().filter(|place| is_drawable(**place)) {
            draw_mark(sheet, view.place(*place), fill);
        }
    }
    sheet.close();
}

/// How the way of an object is drawn.
pub(super) fn way_pen() -> String {
    format!(r#"stroke="{OUTLINE}" stroke-width="1.6" stroke-dasharray="1 3" stroke-linecap="round""#)
}

/// A small diamond: filled where an object is grasped, hollow where it is released.
pub(super) fn draw_mark(sheet: &mut Sheet, [x, y]: Point, fill: &str) {
    let corners = [[x - MARK, y], [x, y - MARK], [x + MARK, y], [x, y + MARK]];
    sheet.polygon(&corners, &format!(r#"fill="{fill}" stroke="{OUTLINE}" stroke-width="1.2""#));
}

fn draw_box(sheet: &mut Sheet, view: &View, corners: [c64; 4], fill: &str) {
    if !corners.iter().all(|corner| is_drawable(*corner)) {
        return;
    }
    let [front_left, front_right, back_right, _] = corners;
    let pen = format!(r#"fill="{fill}" stroke="{OUTLINE}" stroke-width="1.2" stroke-linejoin="round""#);
    sheet.polygon(&corners.map(|corner| view.place(corner)), &pen);
    let (front, depth) = ((front_left + front_right) / 2.0, front_right - back_right);
    let half = (front_left - front_right) / 2.0;
    let size = half.norm().min(depth.norm() / 2.0).min(12.0 / view.scale);
    let unit = |along: c64| if along.norm() > 0.0 { along / along.norm() } else { along };
    let back = front - unit(depth) * size;
    let wedge = [front, back + unit(half) * size * 0.5, back - unit(half) * size * 0.5];
    sheet.polygon(&wedge.map(|corner| view.place(corner)), &format!(r#"fill="{OUTLINE}""#));
}
