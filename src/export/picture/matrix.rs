//! The picture of a clip's motion graph: distances of all pairs of frames, and the pairs that were chosen.

use std::fmt::Write as _;

use rayon::prelude::*;

use super::axis::{mark_label, marks, round_step};
use super::sheet_document;
use super::svg::{GREY, INK, Rect, Sheet, TextStyle, clipped, number, tinted};
use crate::clip::contacts::{Contacts, runs};
use crate::clip::working::{WORKING_STEP, WorkingClip};
use crate::export::palette::colour;
use crate::graph::MotionGraph;
use crate::graph::facts::EDITABLE;
use crate::similarity::{Admissible, Features, features, mean_rotations};

/// The matrix on the sheet, and the sheet, px.
const PLACE: Rect = Rect { x: 74.0, y: 74.0, w: 640.0, h: 640.0 };
const WIDTH: f64 = 930.0;
const HEIGHT: f64 = 770.0;
/// Most cells a side, and most frames a side that are looked at: of a longer clip every so many are.
const MOST_CELLS: usize = 256;
const MOST_FRAMES: usize = 4096;
/// Shades of distances.
const LEVELS: usize = 20;
/// Distances up to so many times the largest of similar frames are told apart.
const SHOWN: f64 = 4.0;
/// Colours from the most alike to the least, sRGB.
const RAMP: [[f64; 3]; 5] = [
    [20.0, 30.0, 80.0],
    [40.0, 90.0, 160.0],
    [110.0, 170.0, 200.0],
    [200.0, 220.0, 225.0],
    [250.0, 250.0, 250.0],
];
/// Colours of pairs that edits may use, and of longer ones.
const CHOSEN: &str = "#d7301f";
const LONGER: &str = "#f4a582";

/// SVG of the distances of all frames of clip `clip` of `graph`, which is `working`, 930 px wide: dark where frames are alike; in
/// the lower left half the pairs that the graph keeps. Equal graphs give equal text. Cost: quadratic in frames, up to 4096.
pub fn graph_svg(working: &WorkingClip, graph: &MotionGraph, clip: usize) -> String {
    let body = graph.bodies[graph.clips[clip].body];
    let mut sheet = Sheet::default();
    let title = TextStyle { size: 17.0, colour: INK, anchor: "start", halo: false };
    sheet.text([PLACE.x, 32.0], title, &clipped(&working.name, title.size, PLACE.w));
    draw_distances(&mut sheet, working, body.largest);
    let frames = working.frame_count() as f64;
    let kept = draw_pairs(&mut sheet, graph, clip, PLACE.w / frames);
    draw_axes(&mut sheet, working);
    draw_feet(&mut sheet, working);
    sheet.rect(PLACE, r##"fill="none" stroke="#c9ced4" stroke-width="1""##);
    draw_legend(&mut sheet, &body, kept);
    sheet_document(&working.name, &sheet.body, WIDTH, HEIGHT)
}

/// Cells of equal shade, one path a shade.
fn draw_distances(sheet: &mut Sheet, working: &WorkingClip, largest: f64) {
    let count = working.frame_count();
    let cells = count.min(MOST_CELLS);
    let stride = count.div_ceil(MOST_FRAMES);
    let features = features(working, &mean_rotations(&[working]));
    let range = |cell: usize| (cell * count / cells)..((cell + 1) * count / cells);
    let level = |distance: f64| {
        let share = (distance / (SHOWN * largest)).min(1.0);
        crate::index::floor_index(share * LEVELS as f64).min(LEVELS - 1)
    };
    let least = |features: &Features, row: usize, column: usize| {
        let all = range(row).step_by(stride).flat_map(|i| range(column).step_by(stride).map(move |j| (i, j)));
        all.map(|(i, j)| features.distance_sq(i, features, j)).fold(f64::INFINITY, f64::min).sqrt()
    };
    let rows: Vec<Vec<usize>> = (0..cells)
        .into_par_iter()
        .map(|row| (0..cells).map(|column| level(least(&features, row, column))).collect())
        .collect();
    let size = PLACE.w / cells as f64;
    for shade in 0..LEVELS - 1 {
        let mut path = String::new();
        for (row, levels) in rows.iter().enumerate() {
            let own: Vec<bool> = levels.iter().map(|level| *level == shade).collect();
            for (first, last) in runs(&own) {
                // Edges by their own places, not by lengths: neighbours round them alike.
                let [left, right] = [first, last + 1].map(|cell| number(PLACE.x + cell as f64 * size));
                let [top, bottom] = [row, row + 1].map(|cell| number(PLACE.y + cell as f64 * size));
                let _ = write!(path, "M{left} {top}H{right}V{bottom}H{left}z");
            }
        }
        if !path.is_empty() {
            let fill = shade_colour(shade);
            sheet.raw(&format!(r#"<path d="{path}" fill="{fill}" shape-rendering="crispEdges"/>"#));
        }
    }
}

fn shade_colour(shade: usize) -> String {
    let at = shade as f64 / (LEVELS - 1) as f64 * (RAMP.len() - 1) as f64;
    let lower = crate::index::floor_index(at).min(RAMP.len() - 2);
    let mixed = |k: usize| RAMP[lower][k] + (at - lower as f64) * (RAMP[lower + 1][k] - RAMP[lower][k]);
    tinted([mixed(0), mixed(1), mixed(2)], 0.0)
}

/// Dots below the diagonal; how many edits may use, and how many are longer.
fn draw_pairs(sheet: &mut Sheet, graph: &MotionGraph, clip: usize, frame: f64) -> (usize, usize) {
    for length in [*EDITABLE.start(), *EDITABLE.end()] {
        let off = length as f64 * frame;
        if off < PLACE.w {
            let (from, to) = ([PLACE.x, PLACE.y + off], [PLACE.x + PLACE.w - off, PLACE.y + PLACE.h]);
            sheet.line(from, to, &format!(r#"stroke="{CHOSEN}" stroke-width="0.8" stroke-dasharray="4 4""#));
        }
    }
    let radius = (0.9 * frame).clamp(1.4, 3.6);
    let mut kept = (0, 0);
    for (i, j, _) in graph.pairs().filter(|(i, j, _)| graph.place(*i).0 == clip && graph.place(*j).0 == clip)
    {
        let first = graph.clips[clip].first.as_usize();
        let (i, j) = (i.as_usize() - first, j.as_usize() - first);
        let is_editable = EDITABLE.contains(&(j - i));
        let place = |frame_number: usize| (frame_number as f64 + 0.5) * frame;
        let centre = [PLACE.x + place(i), PLACE.y + place(j)];
        let fill = if is_editable { CHOSEN } else { LONGER };
        sheet.circle(centre, radius, &format!(r##"fill="{fill}" stroke="#ffffff" stroke-width="0.6""##));
        *(if is_editable { &mut kept.0 } else { &mut kept.1 }) += 1;
    }
    kept
}

/// Seconds along the top and the left edge, the file's frames along the bottom.
fn draw_axes(sheet: &mut Sheet, working: &WorkingClip) {
    let count = working.frame_count() as f64;
    let seconds = count * WORKING_STEP;
    let step = round_step(seconds / 12.0);
    let style = |anchor| TextStyle { size: 10.5, colour: GREY, anchor, halo: false };
    for mark in marks(0.0, seconds, step) {
        let along = mark / seconds * PLACE.w;
        let label = mark_label(mark, step);
        sheet.text([PLACE.x - 18.0, PLACE.y + along + 3.6], style("end"), &format!("{label} s"));
        sheet.text([PLACE.x + along, PLACE.y - 18.0], style("middle"), &format!("{label} s"));
        let frame = format!("{:.0}", working.source_frame(mark / WORKING_STEP));
        sheet.text([PLACE.x + along, PLACE.y + PLACE.h + 16.0], style("middle"), &frame);
        let bottom = PLACE.y + PLACE.h;
        sheet.line([PLACE.x + along, bottom], [PLACE.x + along, bottom + 4.0], r##"stroke="#9aa1a9""##);
    }
    let below = [PLACE.x + PLACE.w / 2.0, PLACE.y + PLACE.h + 34.0];
    sheet.text(below, style("middle"), "frame of the file");
}

/// Bars along the top and the left edge while a foot bears.
fn draw_feet(sheet: &mut Sheet, working: &WorkingClip) {
    let frame = PLACE.w / working.frame_count() as f64;
    let bears: [fn(&Contacts) -> bool; 2] = [|c| c.left_foot(), |c| c.right_foot()];
    for (foot, bears) in bears.iter().enumerate() {
        let fill = format!(r#"fill="{}""#, tinted(colour(foot), 0.0));
        let off = 13.0 - 6.0 * foot as f64;
        let labels: Vec<bool> = working.contacts.iter().map(bears).collect();
        for (first, last) in runs(&labels) {
            let (from, length) = (first as f64 * frame, (last + 1 - first) as f64 * frame);
            sheet.rect(Rect { x: PLACE.x + from, y: PLACE.y - off, w: length, h: 4.0 }, &fill);
            sheet.rect(Rect { x: PLACE.x - off, y: PLACE.y + from, w: 4.0, h: length }, &fill);
        }
    }
}

fn draw_legend(sheet: &mut Sheet, body: &Admissible, (editable, longer): (usize, usize)) {
    let style = |colour| TextStyle { size: 11.5, colour, anchor: "start", halo: false };
    let (x, top, height) = (PLACE.x + PLACE.w + 26.0, PLACE.y + 26.0, 240.0);
    sheet.text([x, top - 12.0], style(INK), "distance of two frames");
    let step = height / LEVELS as f64;
    for shade in 0..LEVELS {
        let cell = Rect { x, y: top + shade as f64 * step, w: 18.0, h: step + 0.3 };
        sheet.rect(cell, &format!(r#"fill="{}""#, shade_colour(shade)));
    }
    sheet.rect(Rect { x, y: top, w: 18.0, h: height }, r##"fill="none" stroke="#c9ced4""##);
    let mut mark = |distance: f64, label: &str| {
        let y = top + (distance / (SHOWN * body.largest)).min(1.0) * height;
        sheet.line([x, y], [x + 22.0, y], &format!(r#"stroke="{INK}""#));
        sheet.text([x + 27.0, y + 4.0], style(GREY), label);
    };
    mark(0.0, "0");
    mark(body.largest, &format!("{:.2}: similar", body.largest));
    if let Some(median) = body.median {
        mark(median, &format!("{median:.2}: median, moving"));
    }
    let y = top + height + 34.0;
    let lines =
        [(CHOSEN, format!("{editable} pairs, 0.3 to 2 s")), (LONGER, format!("{longer} pairs, longer"))];
    for (row, (fill, text)) in lines.iter().enumerate() {
        let y = y + 20.0 * row as f64;
        sheet.circle([x + 8.0, y - 4.0], 3.6, &format!(r#"fill="{fill}""#));
        sheet.text([x + 27.0, y], style(GREY), text);
    }
    for (foot, name) in ["left foot bears", "right foot bears"].into_iter().enumerate() {
        let y = y + 50.0 + 20.0 * foot as f64;
        sheet.rect(
            Rect { x, y: y - 6.0, w: 18.0, h: 4.0 },
            &format!(r#"fill="{}""#, tinted(colour(foot), 0.0)),
        );
        sheet.text([x + 27.0, y], style(GREY), name);
    }
}
