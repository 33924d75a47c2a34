//! What ties times: connectors between rows, and their names on flags above.

use super::crowd::CROWD;
use super::svg::{INK, Point, Sheet, TextStyle, clipped, text_width};
use super::tracks::Axis;
use super::{Picture, Tie};

/// Font size of the names, px.
const SIZE: f64 = 10.5;
/// Height of a line of names, px.
const LINE: f64 = 15.0;
/// Most lines of names; ties beyond have none.
const LINES: usize = 8;
/// Widest name, px.
const WIDEST: f64 = 150.0;
/// From its pole to a name: a flag's width and a gap, px.
const FLAG: f64 = 10.0;
/// Right of the last time, px.
const MARGIN: f64 = 12.0;

/// A name above the rows.
struct Flag<'a> {
    tie: &'a Tie,
    name: String,
    /// Place of its time.
    pole: f64,
    /// Left and right edge of the name.
    span: (f64, f64),
    /// Line, counted upwards from the rows.
    line: usize,
}

/// Space right of the time axis for names of ties near its end, px.
pub(super) fn room(picture: &Picture) -> f64 {
    if picture.actors.len() >= CROWD {
        return MARGIN;
    }
    let times = || picture.ties.iter().filter_map(|tie| start_of(tie, picture.actors.len()));
    let last = picture.actors.iter().flat_map(|actor| actor.times).copied().fold(0.0, f64::max);
    let last = times().map(|(_, time)| time).fold(last, f64::max);
    let late = picture
        .ties
        .iter()
        .filter(|tie| start_of(tie, picture.actors.len()).is_some_and(|(_, time)| time > 0.9 * last));
    late.map(|tie| FLAG + text_width(&tie.name, SIZE).min(WIDEST)).fold(MARGIN, f64::max).min(110.0)
}

/// Height of all lines of names, px.
pub(super) fn height(picture: &Picture, axis: &Axis) -> f64 {
    let lines = flags(picture, axis).iter().map(|flag| flag.line + 1).max().unwrap_or(0);
    lines as f64 * LINE + 4.0
}

/// Draws connectors, then names with poles down to their points.
pub(super) fn draw_flags(sheet: &mut Sheet, axis: &Axis, picture: &Picture) {
    let flags = flags(picture, axis);
    let count = picture.actors.len();
    for flag in &flags {
        let top = axis.rows.y - flag.line as f64 * LINE - LINE + 2.0;
        if let Some((actor, _)) = start_of(flag.tie, count) {
            let to = [flag.pole, axis.y(actor)];
            sheet.line([flag.pole, top], to, r##"stroke="#7a828b" stroke-width="0.7""##);
        }
    }
    for tie in &picture.ties {
        draw_tie(sheet, axis, tie, count);
    }
    for flag in &flags {
        draw_flag(sheet, axis, flag);
    }
}

fn draw_flag(sheet: &mut Sheet, axis: &Axis, flag: &Flag) {
    let top = axis.rows.y - flag.line as f64 * LINE - LINE + 2.0;
    let (x, middle) = (flag.pole, top + 4.0);
    if flag.tie.pinned {
        sheet.polygon(&[[x, top], [x + 8.0, middle], [x, middle + 4.0]], &format!(r#"fill="{INK}""#));
    } else {
        sheet.circle([x, middle], 2.2, &format!(r#"fill="{INK}""#));
    }
    let style = TextStyle { size: SIZE, colour: INK, anchor: "start", halo: true };
    sheet.text([flag.span.0, top + 8.5], style, &flag.name);
}

/// Where poles and connectors cross an actor's row, px, rising.
pub(super) fn crossings(picture: &Picture, axis: &Axis, row: usize) -> Vec<f64> {
    let count = picture.actors.len();
    let mut crossings: Vec<f64> = Vec::new();
    for tie in &picture.ties {
        let points = sorted(tie, count);
        let pole = points.first().filter(|(actor, _)| row <= *actor);
        crossings.extend(pole.map(|(_, time)| axis.x(*time)));
        crossings.extend(points.iter().filter(|(actor, _)| *actor == row).map(|(_, time)| axis.x(*time)));
        for pair in points.windows(2).filter(|pair| pair[0].0 < row && row < pair[1].0) {
            let share = (row - pair[0].0) as f64 / (pair[1].0 - pair[0].0) as f64;
            crossings.push(axis.x(pair[0].1 + share * (pair[1].1 - pair[0].1)));
        }
    }
    crossings.sort_by(f64::total_cmp);
    crossings
}

/// Points of a tie from the highest row down.
fn sorted(tie: &Tie, count: usize) -> Vec<(usize, f64)> {
    let mut points: Vec<(usize, f64)> = drawable(tie, count).collect();
    points.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points
}

/// Dots on the rows, joined where there are several; a fixed time has a ring.
fn draw_tie(sheet: &mut Sheet, axis: &Axis, tie: &Tie, count: usize) {
    let points = sorted(tie, count);
    let places: Vec<Point> = points.iter().map(|(actor, time)| [axis.x(*time), axis.y(*actor)]).collect();
    let radius = (axis.row * 0.14).clamp(1.0, 3.2);
    sheet.open("", &tie.name);
    if places.len() > 1 {
        sheet.polyline(&places, &format!(r#"stroke="{INK}" stroke-width="{:.2}""#, radius * 0.45));
    }
    for place in places {
        let fill = if tie.pinned { "#ffffff" } else { INK };
        sheet.circle(place, radius, &format!(r#"fill="{fill}" stroke="{INK}" stroke-width="1""#));
    }
    sheet.close();
}

/// Names with their places. From right to left each stands above those it would cover, so that poles pass left of names.
fn flags<'a>(picture: &'a Picture, axis: &Axis) -> Vec<Flag<'a>> {
    let count = picture.actors.len();
    let poles = picture.ties.iter().filter_map(|tie| Some((tie, axis.x(start_of(tie, count)?.1))));
    let mut poles: Vec<(&Tie, f64)> = poles.collect();
    poles.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut flags: Vec<Flag> = Vec::new();
    for (tie, pole) in poles {
        let name = clipped(&tie.name, SIZE, WIDEST);
        let width = text_width(&name, SIZE);
        let right = (pole + FLAG + width).min(axis.rows.x + axis.rows.w + 112.0);
        let span = (right - width, right);
        let below = flags.iter().filter(|flag| flag.pole <= span.1 + 8.0 && pole <= flag.span.1 + 8.0);
        let line = below.map(|flag| flag.line + 1).max().unwrap_or(0);
        if line < LINES {
            flags.push(Flag { tie, name, pole, span, line });
        }
    }
    flags
}

/// Highest row of a tie, and its time.
fn start_of(tie: &Tie, count: usize) -> Option<(usize, f64)> {
    drawable(tie, count).min_by_key(|(actor, _)| *actor)
}

fn drawable(tie: &Tie, count: usize) -> impl Iterator<Item = (usize, f64)> {
    tie.points.iter().copied().filter(move |(actor, time)| *actor < count && time.abs() < 1e12)
}
