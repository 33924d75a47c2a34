//! What the symbols mean; only those that occur.

use super::Picture;
use super::crowd::CROWD;
use super::handles::{drag_pen, draw_drag_start};
use super::objects::{OUTLINE, draw_mark, way_pen};
use super::svg::{INK, Point, Rect, Sheet, TextStyle, tinted};
use crate::export::palette::ramp;

/// Height of a line, px.
const LINE: f64 = 19.0;
/// Width of the symbols, px.
const SYMBOL: f64 = 26.0;

/// A symbol's meaning, whether it occurs, and how it is drawn around the middle of its place.
type Entry = (&'static str, bool, fn(&mut Sheet, Point));

/// Draws the legend with its upper left corner at `corner`.
pub(super) fn draw_legend(sheet: &mut Sheet, corner: Point, picture: &Picture) {
    sheet.open(r#"id="legend""#, "legend");
    let shown = entries(picture).into_iter().filter(|(_, occurs, _)| *occurs);
    for (line, (meaning, _, draw)) in shown.enumerate() {
        let y = corner[1] + (line as f64 + 0.5) * LINE;
        draw(sheet, [corner[0] + SYMBOL / 2.0, y]);
        let style = TextStyle { size: 10.5, colour: INK, anchor: "start", halo: false };
        sheet.text([corner[0] + SYMBOL + 8.0, y + 3.7], style, meaning);
    }
    sheet.close();
}

fn entries(picture: &Picture) -> Vec<Entry> {
    let crowd = picture.actors.len() >= CROWD;
    let actors = !picture.actors.is_empty() && !crowd;
    let pin =
        |hard: bool| picture.handles.iter().any(|handle| handle.target.is_some() && handle.hard == hard);
    let ring = picture.handles.iter().any(|handle| handle.target.is_none() && handle.partner.is_none());
    let pair =
        |hard: bool| picture.handles.iter().any(|handle| handle.partner.is_some() && handle.hard == hard);
    let still = picture.actors.iter().any(|actor| !actor.stationary.is_empty());
    vec![
        ("path before the edit", actors, |sheet, at| {
            stroke(sheet, at, r##"stroke="#9aa1a9" stroke-width="1" stroke-dasharray="4 3""##);
        }),
        ("path after the edit", actors, |sheet, at| {
            stroke(sheet, at, r##"stroke="#566" stroke-width="2.2""##)
        }),
        ("start and end", actors, draw_ends),
        ("facing, every 0.5 s", actors, draw_ticks),
        ("path, early to late", crowd, draw_ramp),
        ("pin, hard", pin(true), |sheet, at| draw_pin(sheet, at, INK)),
        ("pin, soft", pin(false), |sheet, at| draw_pin(sheet, at, "none")),
        ("facing held", ring, |sheet, at| {
            sheet.circle(at, 5.0, &format!(r#"fill="none" stroke="{INK}" stroke-width="1.3""#));
            sheet.line(at, [at[0] + 12.0, at[1]], &format!(r#"stroke="{INK}" stroke-width="1.3""#));
        }),
        ("dragged here", picture.handles.iter().any(|handle| handle.dragged_from.is_some()), |sheet, at| {
            stroke(sheet, at, &drag_pen());
            draw_drag_start(sheet, [at[0] - 13.0, at[1]]);
        }),
        ("relative, hard", pair(true), |sheet, at| draw_pair(sheet, at, INK)),
        ("relative, soft", pair(false), |sheet, at| draw_pair(sheet, at, "#ffffff")),
        ("object, its front", !picture.objects.is_empty(), draw_object),
        ("way of an object", picture.objects.iter().any(|object| object.poses.len() > 1), |sheet, at| {
            stroke(sheet, at, &way_pen());
        }),
        (
            "grasped",
            !crowd && picture.objects.iter().any(|object| !object.grasped.is_empty()),
            |sheet, at| {
                draw_mark(sheet, at, OUTLINE);
            },
        ),
        (
            "released",
            !crowd && picture.objects.iter().any(|object| !object.released.is_empty()),
            |sheet, at| {
                draw_mark(sheet, at, "#ffffff");
            },
        ),
        ("stationary", still && !crowd, draw_stationary),
        ("same moment", !crowd && picture.ties.iter().any(|tie| !tie.pinned), draw_tie),
        ("given time", !crowd && picture.ties.iter().any(|tie| tie.pinned), draw_flag),
    ]
}

/// The colours of times.
fn draw_ramp(sheet: &mut Sheet, [x, y]: Point) {
    for k in 0..13 {
        let (k, left) = (f64::from(k), x - 13.0 + 2.0 * f64::from(k));
        let pen = format!(r#"stroke="{}" stroke-width="3""#, tinted(ramp(k / 12.0), 0.0));
        sheet.line([left, y], [left + 2.0, y], &pen);
    }
}

fn stroke(sheet: &mut Sheet, [x, y]: Point, pen: &str) {
    sheet.line([x - 13.0, y], [x + 13.0, y], pen);
}

fn draw_ends(sheet: &mut Sheet, [x, y]: Point) {
    stroke(sheet, [x, y], r##"stroke="#566" stroke-width="2.2""##);
    sheet.circle([x - 11.0, y], 3.8, r##"fill="#566""##);
    sheet.polygon(&[[x + 15.0, y], [x + 6.0, y - 4.0], [x + 6.0, y + 4.0]], r##"fill="#566""##);
}

fn draw_ticks(sheet: &mut Sheet, [x, y]: Point) {
    stroke(sheet, [x, y + 3.0], r##"stroke="#566" stroke-width="2.2""##);
    for left in [-8.0, 0.0, 8.0] {
        sheet.circle([x + left, y + 3.0], 1.8, r##"fill="#233""##);
        sheet.line([x + left, y + 3.0], [x + left + 2.0, y - 6.0], r##"stroke="#233" stroke-width="1.2""##);
    }
}

fn draw_pin(sheet: &mut Sheet, [x, y]: Point, fill: &str) {
    let pen = format!(r#"stroke="{INK}" stroke-width="1.3""#);
    sheet.line([x, y], [x + 14.0, y - 3.0], &pen);
    let square = Rect { x: x - 5.0, y: y - 5.0, w: 10.0, h: 10.0 };
    sheet.rect(square, &format!(r#"fill="{fill}" {pen}"#));
}

fn draw_pair(sheet: &mut Sheet, [x, y]: Point, fill: &str) {
    sheet.line([x - 9.0, y], [x + 9.0, y], &format!(r#"stroke="{INK}" stroke-width="1.5""#));
    for end in [x - 9.0, x + 9.0] {
        sheet.circle([end, y], 2.6, &format!(r#"fill="{fill}" stroke="{INK}" stroke-width="1""#));
    }
}

fn draw_object(sheet: &mut Sheet, [x, y]: Point) {
    let pen = r##"fill="#efe9dd" stroke="#8d8470" stroke-width="1.2""##;
    sheet.rect(Rect { x: x - 10.0, y: y - 6.0, w: 20.0, h: 12.0 }, pen);
    sheet.polygon(&[[x + 10.0, y], [x + 4.0, y - 4.0], [x + 4.0, y + 4.0]], r##"fill="#8d8470""##);
}

fn draw_stationary(sheet: &mut Sheet, [x, y]: Point) {
    let bar = Rect { x: x - 13.0, y: y - 7.0, w: 26.0, h: 14.0 };
    sheet.rect(bar, r##"rx="2.5" fill="#ccd2d6""##);
    sheet.rect(Rect { y: y + 4.0, h: 3.0, ..bar }, r##"fill="#566""##);
}

fn draw_tie(sheet: &mut Sheet, [x, y]: Point) {
    sheet.line([x, y - 6.0], [x, y + 6.0], &format!(r#"stroke="{INK}" stroke-width="1.4""#));
    for end in [y - 6.0, y + 6.0] {
        sheet.circle([x, end], 2.4, &format!(r#"fill="{INK}""#));
    }
}

fn draw_flag(sheet: &mut Sheet, [x, y]: Point) {
    sheet.line([x - 3.0, y - 7.0], [x - 3.0, y + 5.0], r##"stroke="#7a828b" stroke-width="0.7""##);
    sheet.polygon(&[[x - 3.0, y - 8.0], [x + 5.0, y - 4.0], [x - 3.0, y]], &format!(r#"fill="{INK}""#));
    let ring = format!(r##"fill="#ffffff" stroke="{INK}" stroke-width="1""##);
    sheet.circle([x - 3.0, y + 6.0], 2.4, &ring);
}
