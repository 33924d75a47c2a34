//! The scene from above: grid, objects, paths.

use std::f64::consts::PI;

use super::axis::{mark_label, marks, round_step};
use super::crowd::{CROWD, draw_crowd};
use super::handles::draw_handles;
use super::labels::Labels;
use super::objects::draw_object;
use super::svg::{GREY, INK, Point, Rect, Sheet, TextStyle, tinted};
use super::view::{View, distance, is_drawable, towards};
use super::{Actor, Picture, PictureObject};
use crate::export::palette::colour;
use crate::geometry::c64;
use crate::object::ObjectPose;
use crate::path;

/// Scene time between two facing ticks, seconds.
pub(super) const TICK_EVERY: f64 = 0.5;
/// Least distance between grid lines, px.
const GRID_SPACING: f64 = 62.0;
/// Up to so many actors all are drawn in full and named.
pub(super) const FEW: usize = 24;
/// Among more actors so many names are tried.
const NAMED: usize = 40;
/// What a name may hide at most where there are too many for all, in the costs of [`Labels`].
const CROWDED: f64 = 75.0;
/// Points of paths that names avoid, over all actors.
const INK_POINTS: usize = 6000;

/// Draws the plan.
pub(super) fn draw_plan(sheet: &mut Sheet, view: &View, picture: &Picture) {
    draw_grid(sheet, view);
    sheet.open(r#"id="plan" clip-path="url(#frame)""#, "plan");
    if picture.actors.len() < CROWD {
        draw_everybody(sheet, view, picture);
    } else {
        draw_crowd(sheet, view, picture);
        write_names(sheet, view, picture, &mut obstacles(view, picture));
    }
    sheet.close();
    draw_scale_bar(sheet, view);
}

/// Objects, paths and handles, each by itself.
fn draw_everybody(sheet: &mut Sheet, view: &View, picture: &Picture) {
    picture.objects.iter().for_each(|object| draw_object(sheet, view, object));
    let pen = if picture.actors.len() <= FEW { 2.2 } else { 1.1 };
    for (index, actor) in picture.actors.iter().enumerate() {
        draw_rest(sheet, view, (index, actor));
    }
    for (index, actor) in picture.actors.iter().enumerate() {
        draw_edited(sheet, view, (index, actor), pen);
    }
    let mut labels = obstacles(view, picture);
    let names = draw_handles(sheet, view, picture, &mut labels);
    for (index, actor) in picture.actors.iter().enumerate() {
        draw_ends(sheet, view, (index, actor), pen);
    }
    write_names(sheet, view, picture, &mut labels);
    for (at, name) in names {
        let style = TextStyle { size: 10.5, colour: INK, anchor: "middle", halo: true };
        labels.write(sheet, at, (&name, style), CROWDED);
    }
}

/// Grid lines with their metres.
pub(super) fn draw_grid(sheet: &mut Sheet, view: &View) {
    let frame = view.frame;
    let (low, high) = view.corners();
    let step = round_step(GRID_SPACING / view.scale);
    let style = TextStyle { size: 10.5, colour: GREY, anchor: "middle", halo: false };
    let pen = r##"stroke="#e6e9ed" stroke-width="1""##;
    sheet.rect(frame, r##"fill="#fcfcfd" stroke="none""##);
    for mark in marks(low.re, high.re, step) {
        let x = view.place(c64::new(mark, 0.0))[0];
        sheet.line([x, frame.y], [x, frame.y + frame.h], pen);
        sheet.text([x, frame.y + frame.h + 14.0], style, &format!("{} m", mark_label(mark, step)));
    }
    for mark in marks(low.im, high.im, step) {
        let y = view.place(c64::new(0.0, mark))[1];
        sheet.line([frame.x, y], [frame.x + frame.w, y], pen);
        let style = TextStyle { anchor: "end", ..style };
        sheet.text([frame.x - 6.0, y + 3.7], style, &format!("{} m", mark_label(mark, step)));
    }
    sheet.rect(frame, r##"fill="none" stroke="#c9ced4" stroke-width="1""##);
}

/// Where the scale bar and its label stand.
fn scale_bar(view: &View) -> (Rect, f64) {
    let step = round_step(50.0 / view.scale);
    let (w, frame) = (step * view.scale, view.frame);
    (Rect { x: frame.x + frame.w - w - 14.0, y: frame.y + frame.h - 30.0, w, h: 20.0 }, step)
}

pub(super) fn draw_scale_bar(sheet: &mut Sheet, view: &View) {
    let (rect, step) = scale_bar(view);
    let (left, right, y) = (rect.x, rect.x + rect.w, rect.y + rect.h - 2.0);
    let bar = [[left, y - 4.0], [left, y], [right, y], [right, y - 4.0]];
    sheet.polyline(&bar, &format!(r#"stroke="{INK}" stroke-width="1.4""#));
    let style = TextStyle { size: 10.5, colour: INK, anchor: "middle", halo: true };
    sheet.text([left + rect.w / 2.0, y - 6.0], style, &format!("{} m", mark_label(step, step)));
}

fn draw_rest(sheet: &mut Sheet, view: &View, (index, actor): (usize, &Actor)) {
    let points = view.path(actor.rest, 0.7);
    let stroke = tinted(colour(index), 0.5);
    sheet.polyline(&points, &format!(r#"stroke="{stroke}" stroke-width="1" stroke-dasharray="4 3""#));
}

/// Path after the edit, with facing ticks.
fn draw_edited(sheet: &mut Sheet, view: &View, (index, actor): (usize, &Actor), pen: f64) {
    let stroke = tinted(colour(index), 0.0);
    sheet.open(&format!(r#"stroke="{stroke}" stroke-linecap="round" stroke-linejoin="round""#), actor.name);
    sheet.polyline(&view.path(actor.edited, 0.5), &format!(r#"stroke-width="{pen}""#));
    let dark = tinted(shaded(index), 0.0);
    let (length, width) = (3.0 + 2.8 * pen, pen * 0.55);
    for (from, heading) in facing_ticks(view, actor) {
        let to = towards(from, heading, length);
        sheet.line(from, to, &format!(r#"stroke="{dark}" stroke-width="{width:.2}""#));
        sheet.circle(from, pen * 0.8, &format!(r#"fill="{dark}" stroke="none""#));
    }
    sheet.close();
}

/// An actor's colour, dark enough for text and thin lines.
pub(super) fn shaded(index: usize) -> [u8; 3] {
    colour(index).map(|channel| channel / 3 * 2)
}

/// Place and facing at every half second, without ticks that would hide each other.
fn facing_ticks(view: &View, actor: &Actor) -> Vec<(Point, f64)> {
    let mut ticks: Vec<(Point, f64)> = Vec::new();
    let half_second = |time: f64| (time / TICK_EVERY).floor();
    for (frame, pair) in actor.times.windows(2).enumerate() {
        let (Some(here), Some(heading)) = (actor.edited.get(frame + 1), actor.headings.get(frame + 1)) else {
            break;
        };
        let passed = half_second(pair[1]) > half_second(pair[0]);
        if !passed || !is_drawable(*here) || !heading.is_finite() {
            continue;
        }
        let share = ((half_second(pair[1]) * TICK_EVERY - pair[0]) / (pair[1] - pair[0])).clamp(0.0, 1.0);
        let from = view.place(path::at(actor.edited, frame as f64 + share));
        let hidden = |other: &(Point, f64)| distance(other.0, from) < 2.5 && (other.1 - heading).cos() > 0.98;
        if from.iter().all(|x| x.is_finite()) && !ticks.iter().any(hidden) {
            ticks.push((from, *heading));
        }
    }
    ticks
}

/// Dot at the start, arrow head at the end.
fn draw_ends(sheet: &mut Sheet, view: &View, (index, actor): (usize, &Actor), pen: f64) {
    let points = view.path(actor.edited, 0.5);
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
    let fill = tinted(colour(index), 0.0);
    let rim = format!(r##"fill="{fill}" stroke="#ffffff" stroke-width="0.8""##);
    let size = 3.0 + 2.2 * pen;
    let before = points.iter().rev().find(|point| distance(**point, *last) >= size);
    let heading = before.map_or_else(
        || actor.headings.last().copied().filter(|heading| heading.is_finite()).unwrap_or(0.0),
        |before| (before[1] - last[1]).atan2(last[0] - before[0]),
    );
    let wings = [0.42, -0.42].map(|turn| towards(*last, heading + PI + turn, size * 1.7));
    sheet.polygon(&[towards(*last, heading, pen), wings[0], wings[1]], &rim);
    sheet.circle(*first, 1.6 + pen, &rim);
}

/// What names must not hide.
fn obstacles(view: &View, picture: &Picture) -> Labels {
    let mut labels = Labels { frame: view.frame, names: Vec::new(), symbols: Vec::new(), ink: Vec::new() };
    let (bar, _) = scale_bar(view);
    labels.names.push(Rect { x: bar.x - 8.0, y: bar.y - 2.0, w: bar.w + 16.0, h: bar.h + 4.0 });
    for actor in &picture.actors {
        let points = view.path(actor.edited, 5.0);
        let ends = points.first().into_iter().chain(points.last());
        ends.for_each(|end| labels.reserve(*end, 6.0));
        let room = INK_POINTS / picture.actors.len();
        let every = points.len().div_ceil(room.max(1)).max(1);
        labels.ink.extend(points.iter().step_by(every));
    }
    labels
}

/// Names of objects and actors; only of some, where there are many.
fn write_names(sheet: &mut Sheet, view: &View, picture: &Picture, labels: &mut Labels) {
    let count = picture.actors.len();
    let most = if count + picture.objects.len() <= FEW { f64::INFINITY } else { CROWDED };
    let size = if count <= 12 { 13.0 } else { 11.0 };
    for (index, actor) in picture.actors.iter().enumerate().step_by(count.div_ceil(NAMED).max(1)) {
        let Some(start) = actor.edited.iter().copied().find(|point| is_drawable(*point)) else { continue };
        let colour = tinted(shaded(index), 0.0);
        let style = TextStyle { size, colour: &colour, anchor: "middle", halo: true };
        labels.write(sheet, view.place(start), (actor.name, style), most);
    }
    let first =
        |object: &PictureObject| object.poses.first().map_or(c64::new(f64::NAN, 0.0), ObjectPose::plan);
    for object in picture.objects.iter().take(NAMED).filter(|object| is_drawable(first(object))) {
        let style = TextStyle { size: 11.0, colour: "#6b6452", anchor: "middle", halo: true };
        labels.write(sheet, view.place(first(object)), (object.name, style), most);
    }
}
