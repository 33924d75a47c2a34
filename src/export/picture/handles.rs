//! Constraints in the plan: pins, and pairs that keep their distance.

use super::labels::Labels;
use super::svg::{INK, Point, Rect, Sheet};
use super::view::{View, distance, is_drawable, towards};
use super::{Handle, Picture};
use crate::geometry::c64;
use crate::path;

/// Half the side of a pin's square, px.
const HALF: f64 = 5.0;
/// From this distance on a hairline leads from a pin to the path, px.
const VISIBLE: f64 = 3.0;
/// Up to so many pairs are named.
const NAMED: usize = 12;

/// Draws all handles; returns the names to write, each with its point.
pub(super) fn draw_handles(
    sheet: &mut Sheet,
    view: &View,
    picture: &Picture,
    labels: &mut Labels,
) -> Vec<(Point, String)> {
    let mut names: Vec<(Point, String)> = Vec::new();
    for handle in &picture.handles {
        let Some(at) = point_of(picture, handle.actor, handle.frame).map(|point| view.place(point)) else {
            continue;
        };
        let partner = handle.partner.and_then(|(other, frame)| point_of(picture, other, frame));
        sheet.open("", &handle.name);
        if let Some(partner) = partner.map(|point| view.place(point)) {
            draw_pair(sheet, [at, partner], handle.hard);
            [at, partner].into_iter().for_each(|end| labels.reserve(end, 3.0));
            let between = |s: f64| [at[0] + s * (partner[0] - at[0]), at[1] + s * (partner[1] - at[1])];
            labels.ink.extend((1..30).map(|k| between(f64::from(k) / 30.0)));
            if names.iter().all(|(_, name)| *name != handle.name) {
                names.push((between(0.5), handle.name.clone()));
            }
        } else {
            let target = handle.target.filter(|target| is_drawable(*target)).map(|target| view.place(target));
            if let (Some(from), Some(to)) = (handle.dragged_from.filter(|from| is_drawable(*from)), target) {
                draw_drag(sheet, view.place(from), to);
            }
            draw_pin(sheet, handle, at, target);
            labels.reserve(target.unwrap_or(at), HALF + 1.0);
        }
        sheet.close();
    }
    if names.len() <= NAMED { names } else { Vec::new() }
}

/// Place of an actor at a frame of its edited path.
fn point_of(picture: &Picture, actor: usize, frame: f64) -> Option<c64> {
    let edited = picture.actors.get(actor)?.edited;
    let frame = frame.clamp(0.0, edited.len().checked_sub(1)? as f64);
    Some(path::at(edited, frame)).filter(|point| is_drawable(*point))
}

/// A dark line with a dot at either end, hollow if soft.
fn draw_pair(sheet: &mut Sheet, ends: [Point; 2], hard: bool) {
    let fill = if hard { INK } else { "#ffffff" };
    sheet.line(ends[0], ends[1], &format!(r#"stroke="{INK}" stroke-width="1.5""#));
    for end in ends {
        sheet.circle(end, 2.6, &format!(r#"fill="{fill}" stroke="{INK}" stroke-width="1""#));
    }
}

/// A dotted line from where a pin was to where it is, from a small ring.
fn draw_drag(sheet: &mut Sheet, from: Point, to: Point) {
    sheet.line(from, to, &drag_pen());
    draw_drag_start(sheet, from);
}

/// Line of a drag.
pub(super) fn drag_pen() -> String {
    format!(r#"stroke="{INK}" stroke-width="1.1" stroke-dasharray="1 4" stroke-linecap="round""#)
}

/// Where a drag begins.
pub(super) fn draw_drag_start(sheet: &mut Sheet, at: Point) {
    sheet.circle(at, 2.4, &format!(r##"fill="#ffffff" stroke="{INK}" stroke-width="1""##));
}

/// A square at the target, filled if hard, with a tick where it faces; a ring on the path if only the facing is held.
fn draw_pin(sheet: &mut Sheet, handle: &Handle, at: Point, target: Option<Point>) {
    let centre = target.unwrap_or(at);
    let pen = format!(r#"stroke="{INK}" stroke-width="1.3""#);
    if distance(at, centre) >= VISIBLE {
        sheet.line(centre, at, &format!(r#"stroke="{INK}" stroke-width="0.7""#));
        sheet.circle(at, 1.8, &format!(r#"fill="{INK}""#));
    }
    if let Some(facing) = handle.facing.filter(|facing| facing.is_finite()) {
        sheet.line(centre, towards(centre, facing, HALF + 11.0), &pen);
    }
    let fill = if handle.hard { INK } else { "none" };
    if target.is_some() {
        let square = Rect { x: centre[0] - HALF, y: centre[1] - HALF, w: 2.0 * HALF, h: 2.0 * HALF };
        sheet.rect(square, &format!(r#"fill="{fill}" {pen}"#));
    } else {
        sheet.circle(centre, HALF, &format!(r#"fill="{fill}" {pen}"#));
    }
}
