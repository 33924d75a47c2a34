//! Time tracks: a row per actor over one axis of seconds.

use super::axis::{mark_label, marks, round_step};
use super::crowd::CROWD;
use super::density;
use super::flags::{self, draw_flags};
use super::plan::shaded;
use super::svg::{GREY, INK, Rect, Sheet, TextStyle, clipped, text_width, tinted};
use super::{Actor, Extent, Picture};
use crate::export::palette::colour;

/// Widest column of names, px.
const WIDEST_NAME: f64 = 130.0;
/// Narrowest column of names, as wide as the labels left of the plan, px.
const LEAST_COLUMN: f64 = 38.0;
/// Least distance between time marks, px.
const MARK_SPACING: f64 = 55.0;
/// Font size of names and clips, px.
const SIZE: f64 = 11.0;

/// Where times and rows lie on the sheet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// All rows: their left edge is the first time.
    pub rows: Rect,
    /// Height of a row, px.
    pub row: f64,
    /// First time, seconds.
    pub first: f64,
    /// Last time, seconds.
    pub last: f64,
}

impl Axis {
    /// Place of a time, px.
    pub(super) fn x(&self, time: f64) -> f64 {
        let share = (time - self.first) / (self.last - self.first);
        self.rows.x + share.clamp(0.0, 1.0) * self.rows.w
    }

    /// Middle of an actor's row, px.
    pub(super) fn y(&self, actor: usize) -> f64 {
        self.rows.y + (actor as f64 + 0.5) * self.row
    }
}

/// Draws the tracks into `place`, of which the height is free, over the times of `extent`; returns their lower edge.
pub(super) fn draw_tracks(sheet: &mut Sheet, picture: &Picture, (place, extent): (Rect, &Extent)) -> f64 {
    if picture.actors.len() >= CROWD {
        return draw_crowd_tracks(sheet, picture, (place, extent));
    }
    let mut axis = axis_of(picture, place, extent);
    axis.rows.y += flags::height(picture, &axis);
    sheet.open(r#"id="tracks""#, "time tracks");
    draw_axis(sheet, &axis);
    draw_names(sheet, &axis, picture);
    for (index, actor) in picture.actors.iter().enumerate() {
        draw_row(sheet, &axis, (index, actor));
    }
    draw_flags(sheet, &axis, picture);
    for (index, actor) in picture.actors.iter().enumerate().filter(|_| axis.row >= 15.0) {
        draw_clip_names(sheet, &axis, (index, actor), &flags::crossings(picture, &axis, index));
    }
    sheet.close();
    axis.rows.y + axis.rows.h + 20.0
}

/// Rows of many people each.
fn draw_crowd_tracks(sheet: &mut Sheet, picture: &Picture, (place, extent): (Rect, &Extent)) -> f64 {
    let mut axis = axis_of(picture, density::room(place), extent);
    let (rows, height) = density::rows(picture.actors.len());
    (axis.row, axis.rows.h) = (height, height * rows as f64);
    sheet.open(r#"id="tracks""#, "time tracks");
    density::draw_density(sheet, &axis, picture);
    draw_axis(sheet, &axis);
    density::draw_row_names(sheet, &axis, picture, WIDEST_NAME);
    sheet.close();
    axis.rows.y + axis.rows.h + 20.0
}

fn axis_of(picture: &Picture, place: Rect, extent: &Extent) -> Axis {
    let (first, last) = extent.times;
    let last = last.max(first + 0.1).max(first + first.abs() * 1e-9);
    let count = picture.actors.len();
    let row = match count {
        0..=6 => 27.0,
        7..=12 => 22.0,
        13..=24 => 16.0,
        _ => (400.0 / count as f64).max(2.0),
    };
    let widest = picture.actors.iter().map(|actor| text_width(actor.name, SIZE)).fold(24.0, f64::max);
    let names = (widest.min(WIDEST_NAME) + 10.0).max(LEAST_COLUMN);
    let rows = Rect {
        x: place.x + names,
        y: place.y,
        w: place.w - names - extent.names,
        h: row * count.max(1) as f64,
    };
    Axis { rows, row, first, last }
}

fn draw_axis(sheet: &mut Sheet, axis: &Axis) {
    let rows = axis.rows;
    let step = round_step(MARK_SPACING * (axis.last - axis.first) / rows.w);
    let bottom = rows.y + rows.h;
    for mark in marks(axis.first, axis.last, step) {
        let x = axis.x(mark);
        sheet.line([x, rows.y], [x, bottom + 4.0], r##"stroke="#e1e5e9" stroke-width="1""##);
        let style = TextStyle { size: 10.5, colour: GREY, anchor: "middle", halo: false };
        sheet.text([x, bottom + 15.0], style, &format!("{} s", mark_label(mark, step)));
    }
    sheet.line([rows.x, bottom], [rows.x + rows.w, bottom], r##"stroke="#c9ced4" stroke-width="1""##);
}

/// Names left of the rows; every second, third … where rows are low.
fn draw_names(sheet: &mut Sheet, axis: &Axis, picture: &Picture) {
    let every = (1..).find(|every| f64::from(*every) * axis.row >= 12.0).unwrap_or(1);
    for (index, actor) in picture.actors.iter().enumerate().step_by(usize::try_from(every).unwrap_or(1)) {
        let colour = tinted(shaded(index), 0.0);
        let style = TextStyle { size: SIZE, colour: &colour, anchor: "end", halo: false };
        let name = clipped(actor.name, SIZE, WIDEST_NAME);
        sheet.text([axis.rows.x - 8.0, axis.y(index) + SIZE * 0.34], style, &name);
    }
}

/// Clips of one actor as bars, stationary stretches as stripes at their feet.
fn draw_row(sheet: &mut Sheet, axis: &Axis, (index, actor): (usize, &Actor)) {
    let margin = (axis.row * 0.16).min(3.5);
    let bar = |from: f64, to: f64| Rect {
        x: from,
        y: axis.y(index) - axis.row / 2.0 + margin,
        w: (to - from).max(0.8),
        h: axis.row - 2.0 * margin,
    };
    let fill = tinted(colour(index), 0.62);
    let stripe = tinted(colour(index), 0.12);
    let rim = if axis.row > 8.0 { r##"stroke="#ffffff" stroke-width="1""## } else { "" };
    sheet.open("", actor.name);
    for (_, first, last) in &actor.clips {
        let Some((from, to)) = span(axis, actor, (*first, *last)) else { continue };
        let round = (axis.row * 0.14).min((to - from) / 2.0);
        sheet.rect(bar(from, to), &format!(r#"rx="{round:.2}" fill="{fill}" {rim}"#));
    }
    for (from, to) in actor.stationary.iter().filter_map(|frames| span(axis, actor, *frames)) {
        let whole = bar(from, to);
        let h = (whole.h * 0.2).max(1.0);
        let rect = Rect { y: whole.y + whole.h - h, h, ..whole };
        sheet.rect(rect, &format!(r#"fill="{stripe}""#));
    }
    sheet.close();
}

/// Left and right edges of frames of an actor, px.
fn span(axis: &Axis, actor: &Actor, (first, last): (usize, usize)) -> Option<(f64, f64)> {
    let last = last.min(actor.times.len().checked_sub(1)?);
    let (from, to) = (actor.times.get(first)?, actor.times.get(last)?);
    (from.is_finite() && to.is_finite() && first <= last).then(|| (axis.x(*from), axis.x(*to)))
}

/// Names of clips in their bars, right of the lines that would cross them; `crossings` rises.
fn draw_clip_names(sheet: &mut Sheet, axis: &Axis, (index, actor): (usize, &Actor), crossings: &[f64]) {
    let size = if axis.row > 20.0 { 10.5 } else { 9.5 };
    for (label, first, last) in &actor.clips {
        let Some((from, to)) = span(axis, actor, (*first, *last)) else { continue };
        let width = text_width(label, size);
        let mut left = from + 5.0;
        for crossing in crossings {
            if left - 5.0 <= *crossing && *crossing < left + width && *crossing < to {
                left = crossing + 7.0;
            }
        }
        let shown = clipped(label, size, to - left - 4.0);
        let style = TextStyle { size, colour: INK, anchor: "start", halo: false };
        if !shown.is_empty() {
            sheet.text([left, axis.y(index) + size * 0.28], style, &shown);
        }
    }
}
