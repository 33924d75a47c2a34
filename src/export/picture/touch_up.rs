//! What a touch-up changes: distances of the zero moment point, angular momentum and height of the centre of mass along time, before
//! and after, and the mean distance step by step.

use super::axis::{mark_label, marks, round_step};
use super::sheet_document;
use super::svg::{GREY, INK, Point, Rect, Sheet, TextStyle, clipped, tinted};
use crate::clip::contacts::runs;
use crate::export::palette::colour;
use crate::physics::course::Course;
use crate::physics::stages::{Bearer, Phase, Stages};

/// A touch-up as it is drawn.
#[derive(Clone, Copy, Debug)]
pub struct TouchUpCurves<'a> {
    /// First line.
    pub title: &'a str,
    /// Second line, smaller.
    pub subtitle: &'a str,
    /// Frames per second.
    pub fps: f64,
    /// The motion as it came.
    pub before: &'a Course,
    /// The result.
    pub after: &'a Course,
    /// When it stands on what.
    pub stages: &'a Stages,
    /// Mean distances on the ground at the start and after each step, by the filter that is optimised and at 6 Hz, metres.
    pub steps: &'a [[f64; 2]],
    /// So many steps are in the result.
    pub kept: usize,
}

const WIDTH: f64 = 1120.0;
const HEIGHT: f64 = 612.0;
/// Left column: charts along time; right column: steps. px.
const CHARTS: Rect = Rect { x: 66.0, y: 92.0, w: 710.0, h: 448.0 };
const STEPS: Rect = Rect { x: 866.0, y: 92.0, w: 228.0, h: 132.0 };
/// Between charts, with the title of the lower one, px.
const BETWEEN: f64 = 30.0;
/// Least distance between time marks, px.
const MARK_SPACING: f64 = 56.0;
const BEFORE: &str = "#9a6a3a";
const FLIGHT: &str = "#ffe9c2";
const TOUCH: &str = "#f1f1ee";
const JUDGE_DASH: &str = r#" stroke-dasharray="4 2.5""#;
/// Least span of a chart: of distances in millimetres, momentum in kg m²/s, heights in metres.
const LEAST: [f64; 3] = [5.0, 2.0, 0.1];

/// SVG of a touch-up, 1120 px wide. Equal touch-ups give equal text.
pub fn touch_up_svg(curves: &TouchUpCurves<'_>) -> String {
    let mut sheet = Sheet::default();
    write_head(&mut sheet, curves);
    let h = (CHARTS.h - 2.0 * BETWEEN) / 3.0;
    let frame = |row: f64| Rect { y: CHARTS.y + row * (h + BETWEEN), h, ..CHARTS };
    draw_distances(&mut sheet, curves, frame(0.0));
    let both = [curves.before, curves.after];
    let momentum = both.map(|course| course.momentum.as_slice());
    let heights = both.map(|course| course.heights.as_slice());
    draw_pair(&mut sheet, curves, (frame(1.0), MOMENTUM), (momentum, LEAST[1]));
    draw_pair(&mut sheet, curves, (frame(2.0), HEIGHTS), (heights, LEAST[2]));
    draw_feet(&mut sheet, &Panel::along_time(curves, frame(2.0), (0.0, 1.0)), curves);
    draw_steps(&mut sheet, curves);
    write_legend(&mut sheet);
    sheet_document(curves.title, &sheet.body, WIDTH, HEIGHT)
}

const DISTANCES: &str = "zero moment point to polygon of support, mm";
const MOMENTUM: &str = "angular momentum about the centre of mass, kg m²/s";
const HEIGHTS: &str = "height of the centre of mass, m";

/// A chart.
struct Panel {
    frame: Rect,
    /// Values of its left and right edges.
    across: (f64, f64),
    /// Values of its lower and upper edges.
    up: (f64, f64),
}

impl Panel {
    fn along_time(curves: &TouchUpCurves<'_>, frame: Rect, up: (f64, f64)) -> Self {
        let seconds = curves.stages.phases.len().saturating_sub(1) as f64 / curves.fps;
        Self { frame, across: (0.0, seconds.max(1e-3)), up }
    }

    fn x(&self, value: f64) -> f64 {
        let (low, high) = self.across;
        self.frame.x + ((value - low) / (high - low)).clamp(0.0, 1.0) * self.frame.w
    }

    fn y(&self, value: f64) -> f64 {
        let (low, high) = self.up;
        self.frame.y + self.frame.h * (1.0 - ((value - low) / (high - low)).clamp(0.0, 1.0))
    }

    /// Title, values and their lines over what is shaded.
    fn scales(&self, sheet: &mut Sheet, title: &str) {
        let frame = self.frame;
        let style = |size, anchor| TextStyle { size, colour: GREY, anchor, halo: false };
        sheet.text([frame.x, frame.y - 7.0], style(11.5, "start"), title);
        let step = round_step((self.up.1 - self.up.0) / 4.0);
        for mark in marks(self.up.0, self.up.1, step) {
            let y = self.y(mark);
            sheet.line([frame.x, y], [frame.x + frame.w, y], r##"stroke="#dfe3e8" stroke-width="0.8""##);
            sheet.text([frame.x - 6.0, y + 3.6], style(10.5, "end"), &mark_label(mark, step));
        }
        sheet.rect(frame, r##"fill="none" stroke="#c9ced4" stroke-width="1""##);
    }

    /// Shades of flights, and of frames that touch without standing.
    fn shades(&self, sheet: &mut Sheet, curves: &TouchUpCurves<'_>) {
        sheet.rect(self.frame, r##"fill="#fcfcfd""##);
        for (phase, shade) in [(Phase::Touch, TOUCH), (Phase::Flight, FLIGHT)] {
            let labels: Vec<bool> = curves.stages.phases.iter().map(|own| *own == phase).collect();
            for run in runs(&labels) {
                let (x, w) = self.span(run, curves.fps);
                sheet.rect(Rect { x, w, ..self.frame }, &format!(r#"fill="{shade}""#));
            }
        }
    }

    /// Left edge and width of frames, each half a step wide to both sides, px.
    fn span(&self, (first, last): (usize, usize), fps: f64) -> (f64, f64) {
        let (from, to) = (self.x((first as f64 - 0.5) / fps), self.x((last as f64 + 0.5) / fps));
        (from, to - from)
    }

    fn line(&self, sheet: &mut Sheet, points: &[Point], pen: &str) {
        let placed: Vec<Point> = points.iter().map(|[x, y]| [self.x(*x), self.y(*y)]).collect();
        sheet.polyline(&placed, &format!(r#"{pen} stroke-linejoin="round""#));
    }
}

fn ink() -> String {
    tinted(colour(0), 0.0)
}

/// How a motion is drawn: colour and width of its line.
fn pens() -> [String; 2] {
    [format!(r#"stroke="{BEFORE}" stroke-width="1.3""#), format!(r#"stroke="{}" stroke-width="1.7""#, ink())]
}

fn draw_distances(sheet: &mut Sheet, curves: &TouchUpCurves<'_>, frame: Rect) {
    let both = [curves.before, curves.after];
    let values = both.iter().flat_map(|course| course.distances.iter().flatten().flatten());
    let most = values.map(|metres| metres * 1e3).fold(LEAST[0], f64::max) * 1.06;
    let panel = Panel::along_time(curves, frame, (0.0, most));
    panel.shades(sheet, curves);
    panel.scales(sheet, DISTANCES);
    for (course, pen) in both.into_iter().zip(pens()) {
        for (distances, dash) in course.distances.iter().zip(["", JUDGE_DASH]) {
            let pen = format!("{pen}{dash}");
            for (first, last) in runs(&distances.iter().map(Option::is_some).collect::<Vec<_>>()) {
                let point = |frame: usize| [frame as f64 / curves.fps, distances[frame].unwrap_or(0.0) * 1e3];
                panel.line(sheet, &(first..=last).map(point).collect::<Vec<_>>(), &pen);
            }
        }
    }
}

/// A chart of one number before and after; from 0 where that is no waste of room.
fn draw_pair(
    sheet: &mut Sheet,
    curves: &TouchUpCurves<'_>,
    (frame, title): (Rect, &str),
    (both, least): ([&[f64]; 2], f64),
) {
    let panel = Panel::along_time(curves, frame, range(both, least));
    panel.shades(sheet, curves);
    panel.scales(sheet, title);
    for (values, pen) in both.into_iter().zip(pens()) {
        let points: Vec<Point> =
            values.iter().enumerate().map(|(at, value)| [at as f64 / curves.fps, *value]).collect();
        panel.line(sheet, &points, &pen);
    }
}

/// Values of a chart's lower and upper edges.
fn range(both: [&[f64]; 2], least: f64) -> (f64, f64) {
    let values = || both.into_iter().flatten().copied();
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    if low > high {
        return (0.0, least);
    }
    let room = (high - low).max(least) * 0.08;
    let middle = f64::midpoint(low, high);
    let (low, high) = (low.min(middle - least / 2.0) - room, high.max(middle + least / 2.0) + room);
    if low < 0.5 * high { (0.0, high) } else { (low, high) }
}

/// Bars while the left and the right foot support, and the axis of time.
fn draw_feet(sheet: &mut Sheet, panel: &Panel, curves: &TouchUpCurves<'_>) {
    use crate::physics::sole::Side;
    let mut top = panel.frame.y + panel.frame.h + 8.0;
    let style = |size, anchor| TextStyle { size, colour: GREY, anchor, halo: false };
    for (side, name, hue) in [(Side::Left, "left", 0), (Side::Right, "right", 1)] {
        let of_side =
            |bearer: &Bearer| matches!(bearer, Bearer::Sole(own, _) | Bearer::Hand(own) if *own == side);
        let supports: Vec<_> = curves.stages.supports.iter().filter(|own| of_side(&own.bearer)).collect();
        let bears: Vec<bool> = (0..curves.stages.phases.len())
            .map(|frame| supports.iter().any(|own| own.bears[frame]))
            .collect();
        let fill = format!(r#"fill="{}""#, tinted(colour(hue), 0.45));
        for run in runs(&bears) {
            let (x, w) = panel.span(run, curves.fps);
            sheet.rect(Rect { x, y: top, w: w.max(1.0), h: 6.0 }, &fill);
        }
        sheet.text([panel.frame.x - 6.0, top + 6.0], style(9.0, "end"), name);
        top += 10.0;
    }
    let step = round_step(MARK_SPACING * panel.across.1 / panel.frame.w);
    for mark in marks(0.0, panel.across.1, step) {
        let x = panel.x(mark);
        sheet.line([x, top], [x, top + 4.0], r##"stroke="#9aa1a9" stroke-width="1""##);
        sheet.text([x, top + 15.0], style(10.5, "middle"), &format!("{} s", mark_label(mark, step)));
        sheet.text([x, top + 28.0], style(9.0, "middle"), &format!("{:.0}", mark * curves.fps));
    }
    sheet.text([panel.frame.x - 6.0, top + 28.0], style(9.0, "end"), "frame");
}

/// Mean distances after each step; a ring around the one that is kept.
fn draw_steps(sheet: &mut Sheet, curves: &TouchUpCurves<'_>) {
    let most = curves.steps.iter().flatten().map(|metres| metres * 1e3).fold(1.0, f64::max) * 1.08;
    let last = curves.steps.len().saturating_sub(1).max(1) as f64;
    let panel = Panel { frame: STEPS, across: (-0.03 * last, 1.03 * last), up: (0.0, most) };
    sheet.rect(STEPS, r##"fill="#fcfcfd""##);
    panel.scales(sheet, "mean distance after each step, mm");
    let hue = ink();
    for (filter, dash) in ["", JUDGE_DASH].into_iter().enumerate() {
        let points: Vec<Point> =
            curves.steps.iter().enumerate().map(|(step, means)| [step as f64, means[filter] * 1e3]).collect();
        panel.line(sheet, &points, &format!(r#"stroke="{hue}" stroke-width="1.5"{dash}"#));
        let fill = if filter == 0 { hue.as_str() } else { "#ffffff" };
        let pen = format!(r#"fill="{fill}" stroke="{hue}" stroke-width="1.1""#);
        points.iter().for_each(|[x, y]| sheet.circle([panel.x(*x), panel.y(*y)], 2.4, &pen));
        if let Some([x, y]) = points.get(curves.kept) {
            let ring = format!(r#"fill="none" stroke="{INK}" stroke-width="1""#);
            sheet.circle([panel.x(*x), panel.y(*y)], 5.6, &ring);
        }
    }
    let style = TextStyle { size: 10.5, colour: GREY, anchor: "middle", halo: false };
    let every = round_step((last / 8.0).max(1.0));
    for mark in marks(0.0, last, every) {
        sheet.text([panel.x(mark), STEPS.y + STEPS.h + 15.0], style, &format!("{mark:.0}"));
    }
}

fn write_head(sheet: &mut Sheet, curves: &TouchUpCurves<'_>) {
    let style = |size, colour| TextStyle { size, colour, anchor: "start", halo: false };
    let room = WIDTH - CHARTS.x - 20.0;
    sheet.text([CHARTS.x, 34.0], style(20.0, INK), &clipped(curves.title, 20.0, room));
    sheet.text([CHARTS.x, 55.0], style(12.5, GREY), &clipped(curves.subtitle, 12.5, room));
}

/// What lines and shades mean, below the steps.
fn write_legend(sheet: &mut Sheet) {
    let style = TextStyle { size: 11.5, colour: GREY, anchor: "start", halo: false };
    let [before, after] = pens();
    let lines = [
        (before.clone(), "as it came"),
        (after.clone(), "touched up"),
        (format!("{before}{JUDGE_DASH}"), "as it came, at 6 Hz"),
        (format!("{after}{JUDGE_DASH}"), "touched up, at 6 Hz"),
    ];
    let mut y = STEPS.y + STEPS.h + 52.0;
    for (pen, name) in lines {
        sheet.line([STEPS.x, y - 4.0], [STEPS.x + 28.0, y - 4.0], &pen);
        sheet.text([STEPS.x + 38.0, y], style, name);
        y += 21.0;
    }
    sheet.circle([STEPS.x + 14.0, y - 4.0], 5.6, &format!(r#"fill="none" stroke="{INK}" stroke-width="1""#));
    sheet.text([STEPS.x + 38.0, y], style, "step whose result is kept");
    y += 25.0;
    let shades = [
        (FLIGHT.to_owned(), "in flight"),
        (TOUCH.to_owned(), "touches, nothing supports"),
        (tinted(colour(0), 0.45), "left foot or hand supports"),
        (tinted(colour(1), 0.45), "right foot or hand supports"),
    ];
    for (fill, name) in shades {
        let place = Rect { x: STEPS.x + 4.0, y: y - 9.5, w: 20.0, h: 11.0 };
        sheet.rect(place, &format!(r##"fill="{fill}" stroke="#9aa1a9" stroke-width="0.6" rx="2""##));
        sheet.text([STEPS.x + 38.0, y], style, name);
        y += 21.0;
    }
    let remark = ["no distance within 0.17 s of the ends,", "in flight, and where little bears"];
    y += 6.0;
    for line in remark {
        sheet.text([STEPS.x, y], TextStyle { size: 10.5, ..style }, line);
        y += 14.0;
    }
}
