//! A crowd from above: a stroke for each path, coloured by when it is walked, everything else in a few strokes.

use std::fmt::Write as _;

use super::simplify::{simplified, tenths};
use super::svg::{INK, Point, Rect, Sheet, escaped, tinted};
use super::view::{View, base, is_drawable};
use super::{Actor, Handle, Picture, PictureObject};
use crate::export::palette::ramp;
use crate::geometry::c64;
use crate::object::ObjectPose;
use crate::path;

/// From so many characters on.
pub(super) const CROWD: usize = 201;
/// Lines may be off by so much, px.
const OFF: f64 = 0.25;
/// Shades of the colours of times.
const SHADES: usize = 32;
/// Width of a stroke on the ground, metres, and on the sheet, px.
const STROKE: (f64, std::ops::RangeInclusive<f64>) = (0.22, 0.45..=1.1);

/// Draws objects, paths and handles of the plan.
pub(super) fn draw_crowd(sheet: &mut Sheet, view: &View, picture: &Picture) {
    let pen = pen(view);
    draw_things(sheet, view, &picture.objects);
    draw_paths(sheet, view, picture, pen);
    draw_handles(sheet, view, picture, pen);
}

/// Width of strokes, px.
pub(super) fn pen(view: &View) -> f64 {
    (STROKE.0 * view.scale).clamp(*STROKE.1.start(), *STROKE.1.end())
}

/// All objects, their ways below them.
fn draw_things(sheet: &mut Sheet, view: &View, objects: &[PictureObject]) {
    let mut ways = String::new();
    let mut boxes = String::new();
    for object in objects {
        let way: Vec<c64> = object.poses.iter().map(ObjectPose::plan).collect();
        let points = simplified(&view.path(&way, 0.3), OFF);
        if points.len() > 1 {
            ways += &tenths(&points);
        }
        let corners = object.poses.first().map(|pose| base(object.size, pose));
        if let Some(corners) = corners.filter(|corners| corners.iter().all(|corner| is_drawable(*corner))) {
            let _ = write!(boxes, "{}z", tenths(&corners.map(|corner| view.place(corner))));
        }
    }
    let title = format!("{} objects", objects.len());
    sheet.open(r##"transform="scale(.1)" stroke="#8d8470" stroke-linejoin="round""##, &title);
    for (data, pen) in [
        (ways, r#"fill="none" stroke-width="12" stroke-dasharray="8 16" stroke-opacity=".6""#),
        (boxes, r##"fill="#efe9dd" stroke-width="6""##),
    ] {
        if !data.is_empty() {
            sheet.raw(&format!(r#"<path d="{data}" {pen}/>"#));
        }
    }
    sheet.close();
}

/// Paths in the order of times, each with an arrow head at its end.
fn draw_paths(sheet: &mut Sheet, view: &View, picture: &Picture, pen: f64) {
    let shades = shades(picture);
    for shade in 0..SHADES {
        if !shades.contains(&shade) {
            continue;
        }
        let stroke = tinted(ramp(shade as f64 / (SHADES - 1) as f64), 0.0);
        let head = format!(
            r#"<marker id="head{shade}" viewBox="-6 -3 8 6" markerWidth="5" markerHeight="4" orient="auto"><path d="M2 0L-6 3V-3z" fill="{stroke}"/></marker>"#
        );
        sheet.raw(&head);
        let attributes = format!(
            r#"transform="scale(.1)" fill="none" stroke="{stroke}" stroke-width="{:.1}" stroke-linecap="round" stroke-linejoin="round" marker-end="url(#head{shade})""#,
            10.0 * pen
        );
        sheet.raw(&format!("<g {attributes}>"));
        let own = picture.actors.iter().zip(&shades).filter(|(_, own)| **own == shade);
        for (actor, _) in own {
            let data = tenths(&simplified(&view.path(actor.edited, 0.3), OFF));
            if !data.is_empty() {
                sheet.raw(&format!(r#"<path d="{data}"><title>{}</title></path>"#, escaped(actor.name)));
            }
        }
        sheet.close();
    }
}

/// First and last of the times at which actors are half way.
fn half_ways(picture: &Picture) -> Option<(f64, f64)> {
    let times = picture.actors.iter().filter_map(half_way);
    times.fold(None, |ends: Option<(f64, f64)>, time| {
        let (first, last) = ends.unwrap_or((time, time));
        Some((first.min(time), last.max(time)))
    })
}

/// Shade of each actor, by the time at which it has half of its way behind it.
fn shades(picture: &Picture) -> Vec<usize> {
    let (first, last) = half_ways(picture).unwrap_or((0.0, 1.0));
    let share = |time: f64| if last > first { (time - first) / (last - first) } else { 0.0 };
    let shade = |actor: &Actor| {
        let share = half_way(actor).map_or(0.0, share);
        let below = (0..SHADES).rev().find(|shade| share * SHADES as f64 >= *shade as f64);
        below.unwrap_or(0)
    };
    picture.actors.iter().map(shade).collect()
}

/// Colour of each actor in a crowd.
pub(super) fn shades_of(picture: &Picture) -> Vec<String> {
    let of = |shade: usize| tinted(ramp(shade as f64 / (SHADES - 1) as f64), 0.0);
    shades(picture).into_iter().map(of).collect()
}

/// When an actor has half of its way behind it, seconds.
fn half_way(actor: &Actor) -> Option<f64> {
    let steps = || actor.edited.windows(2).map(|pair| (pair[1] - pair[0]).norm());
    let whole: f64 = steps().filter(|step| step.is_finite()).sum();
    let mut gone = 0.0;
    let passed = steps().position(|step| {
        gone += if step.is_finite() { step } else { 0.0 };
        gone >= 0.5 * whole
    });
    let frame = passed.filter(|_| whole > 0.0).unwrap_or(actor.times.len() / 2);
    actor.times.get(frame).copied().filter(|time| time.abs() < 1e12)
}

/// Pins as squares, pairs as lines, the hard ones filled and dark.
fn draw_handles(sheet: &mut Sheet, view: &View, picture: &Picture, pen: f64) {
    let [hard, soft] = [true, false].map(|hard| {
        let own = || picture.handles.iter().filter(move |handle| handle.hard == hard);
        let pins = own().filter_map(|handle| square(view, handle, 1.5 * pen)).collect::<String>();
        let pairs = own().filter_map(|handle| pair(view, picture, handle)).collect::<String>();
        (pins, pairs)
    });
    sheet.open(r#"transform="scale(.1)" fill="none""#, "what is held");
    let width = 10.0 * pen;
    for (data, pen) in [
        (&soft.1, format!(r##"stroke="#7a828b" stroke-width="{:.1}""##, 0.6 * width)),
        (&hard.1, format!(r#"stroke="{INK}" stroke-width="{width:.1}""#)),
        (&soft.0, format!(r##"stroke="#7a828b" stroke-width="{:.1}""##, 0.6 * width)),
        (&hard.0, format!(r#"fill="{INK}""#)),
    ] {
        if !data.is_empty() {
            sheet.raw(&format!(r#"<path d="{data}" {pen}/>"#));
        }
    }
    sheet.close();
    for handle in &picture.handles {
        draw_drag(sheet, view, handle);
    }
}

/// A square around a pin's target, or around its place if that is free.
fn square(view: &View, handle: &Handle, half: f64) -> Option<String> {
    let target = handle.target.filter(|target| is_drawable(*target) && handle.partner.is_none())?;
    let [x, y] = view.place(target);
    let Rect { x, y, w, h } = Rect { x: x - half, y: y - half, w: 2.0 * half, h: 2.0 * half };
    Some(tenths(&[[x, y], [x + w, y], [x + w, y + h], [x, y + h]]) + "z")
}

/// A line between two who are held relative to each other.
fn pair(view: &View, picture: &Picture, handle: &Handle) -> Option<String> {
    let (other, frame) = handle.partner?;
    let place = |actor: usize, frame: f64| -> Option<Point> {
        let edited = picture.actors.get(actor)?.edited;
        let frame = frame.clamp(0.0, edited.len().checked_sub(1)? as f64);
        Some(path::at(edited, frame)).filter(|point| is_drawable(*point)).map(|point| view.place(point))
    };
    Some(tenths(&[place(handle.actor, handle.frame)?, place(other, frame)?]))
}

/// Where a drag took a pin from.
fn draw_drag(sheet: &mut Sheet, view: &View, handle: &Handle) {
    let ends = handle.dragged_from.zip(handle.target).filter(|(a, b)| is_drawable(*a) && is_drawable(*b));
    if let Some((from, to)) = ends {
        sheet.open("", &handle.name);
        sheet.line(view.place(from), view.place(to), &super::handles::drag_pen());
        super::handles::draw_drag_start(sheet, view.place(from));
        sheet.close();
    }
}
