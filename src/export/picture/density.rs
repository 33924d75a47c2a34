//! Time tracks of a crowd: rows of many people each, darker where more of them walk.

use std::fmt::Write as _;

use super::svg::{GREY, INK, Rect, Sheet, TextStyle, clipped, tinted};
use super::tracks::Axis;
use super::{Actor, Picture};

/// Rows at most.
const ROWS: usize = 100;
/// Height of all rows together, px.
const HEIGHT: f64 = 400.0;
/// Times that are looked at.
const TIMES: usize = 240;
/// Who is faster walks, m/s: slower than the slowest stroll, faster than anybody sways.
const WALKS: f64 = 0.25;
/// Shades from nobody to as many as ever.
const SHADES: usize = 6;

/// People of a row.
pub(super) fn of_row(count: usize) -> usize {
    count.div_ceil(ROWS).max(1)
}

/// Rows and their height, px.
pub(super) fn rows(count: usize) -> (usize, f64) {
    let rows = count.div_ceil(of_row(count)).max(1);
    (rows, HEIGHT / rows as f64)
}

/// Draws the rows, and says what they show.
pub(super) fn draw_density(sheet: &mut Sheet, axis: &Axis, picture: &Picture) {
    let of_row = of_row(picture.actors.len());
    let counts: Vec<Vec<Option<usize>>> =
        picture.actors.chunks(of_row).map(|actors| counts(actors, axis)).collect();
    let most = counts.iter().flatten().flatten().copied().max().unwrap_or(0).max(1);
    let style = TextStyle { size: 10.5, colour: GREY, anchor: "start", halo: false };
    let rows = if of_row == 1 { "a row for each".to_owned() } else { format!("rows of {of_row} characters") };
    let told = format!(
        "{} characters, {rows}: from light, where nobody walks, to dark, where {most} do",
        picture.actors.len()
    );
    sheet.text([axis.rows.x, axis.rows.y - 6.0], style, &told);
    let mut shades = vec![String::new(); SHADES];
    let width = axis.rows.w / TIMES as f64;
    for (row, counts) in counts.iter().enumerate() {
        for (from, to, shade) in runs(counts, most) {
            let _ = write!(
                shades[shade],
                "M{:.0} {:.0}h{:.0}",
                10.0 * (axis.rows.x + from as f64 * width),
                10.0 * axis.y(row),
                10.0 * (to - from) as f64 * width
            );
        }
    }
    sheet.raw(&format!(
        r#"<g transform="scale(.1)" fill="none" stroke-width="{:.1}">"#,
        10.0 * (axis.row - 0.15 * axis.row.min(3.0))
    ));
    for (shade, data) in shades.iter().enumerate().filter(|(_, data)| !data.is_empty()) {
        let colour = tinted([24_u8, 62, 110], 0.9 * (1.0 - shade as f64 / (SHADES - 1) as f64));
        sheet.raw(&format!(r#"<path d="{data}" stroke="{colour}"/>"#));
    }
    sheet.close();
}

/// Names of the first in every row that has room for a name.
pub(super) fn draw_row_names(sheet: &mut Sheet, axis: &Axis, picture: &Picture, widest: f64) {
    let of_row = of_row(picture.actors.len());
    let mut below = f64::NEG_INFINITY;
    for (row, actors) in picture.actors.chunks(of_row).enumerate() {
        let y = axis.y(row);
        if y >= below {
            let style = TextStyle { size: 11.0, colour: INK, anchor: "end", halo: false };
            sheet.text([axis.rows.x - 8.0, y + 3.7], style, &clipped(actors[0].name, 11.0, widest));
            below = y + 14.0;
        }
    }
}

/// How many of some actors walk at each time; `None` where none of them is there.
fn counts(actors: &[Actor], axis: &Axis) -> Vec<Option<usize>> {
    let mut counts = vec![None; TIMES];
    let step = (axis.last - axis.first) / TIMES as f64;
    for actor in actors {
        for (k, count) in counts.iter_mut().enumerate() {
            let time = axis.first + (k as f64 + 0.5) * step;
            if let Some(speed) = speed(actor, time) {
                *count = Some(count.unwrap_or(0) + usize::from(speed > WALKS));
            }
        }
    }
    counts
}

/// How fast an actor is at a time, m/s; `None` before its first frame and after its last.
fn speed(actor: &Actor, time: f64) -> Option<f64> {
    let after = actor.times.partition_point(|own| *own <= time);
    let frames = (after.checked_sub(1)?, after);
    let (from, to) = (actor.edited.get(frames.0)?, actor.edited.get(frames.1)?);
    let seconds = actor.times.get(frames.1)? - actor.times[frames.0];
    Some((to - from).norm() / seconds).filter(|speed| speed.is_finite())
}

/// First time, the one after the last, and shade, of equal shades in a row.
fn runs(counts: &[Option<usize>], most: usize) -> Vec<(usize, usize, usize)> {
    let shade = |count: usize| (count * (SHADES - 1)).div_ceil(most);
    let mut runs: Vec<(usize, usize, usize)> = Vec::new();
    for (k, count) in counts.iter().enumerate() {
        let Some(shade) = count.map(shade) else { continue };
        match runs.last_mut().filter(|(_, to, known)| *to == k && *known == shade) {
            Some((_, to, _)) => *to = k + 1,
            None => runs.push((k, k + 1, shade)),
        }
    }
    runs
}

/// Where rows lie: below what says what they show.
pub(super) fn room(place: Rect) -> Rect {
    Rect { y: place.y + 16.0, ..place }
}
