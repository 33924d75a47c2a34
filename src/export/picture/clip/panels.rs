//! Charts of a clip over time: heights of the feet with their contacts, speed.

use super::super::axis::{mark_label, marks, round_step};
use super::super::svg::{GREY, INK, Point, Rect, Sheet, TextStyle, text_width};
use super::{Drawn, FLIGHT, RAISED, STATIONARY, foot_ink};
use crate::clip::contacts::{ContactPoint, percentile, runs};

/// A chart over the time of the file.
struct Panel {
    frame: Rect,
    /// First and last time, seconds.
    times: (f64, f64),
    /// Value of the upper edge; the lower is 0.
    most: f64,
}

/// Height of the contact bars below a foot's chart, and of all that is below the last chart, px.
const BARS: f64 = 24.0;
/// Space above a chart for its title, px.
const TITLE: f64 = 26.0;
/// Share of the frames in which a point of a foot is lower than the floor is taken to be.
const FLOOR_PERCENTILE: f64 = 0.01;
/// Least heights of a foot's chart, metres, and of the speed's, m/s.
const LEAST: (f64, f64) = (0.2, 0.5);
/// Least distance between time marks, px.
const MARK_SPACING: f64 = 52.0;

/// Draws all charts into `place`.
pub(super) fn draw_panels(sheet: &mut Sheet, drawn: &Drawn, place: Rect) {
    let times = (drawn.times[0], drawn.times[drawn.times.len() - 1].max(drawn.times[0] + 1e-3));
    let h = (place.h - 2.0 * (TITLE + BARS)) / 3.0;
    let frame = |row: f64, above: f64| Rect { y: place.y + row * (h + TITLE) + above, h, ..place };
    let floor = floor(drawn);
    let feet = drawn.points.iter().filter(|(point, _)| ContactPoint::FEET.contains(point));
    let heights = feet.flat_map(|(_, places)| places.iter().map(|place| place.y - floor));
    let highest = heights.fold(LEAST.0, f64::max) * 1.06;
    let fastest = drawn.speeds.iter().copied().fold(LEAST.1, f64::max) * 1.08;
    let feet = [
        ("left foot: height, m", [ContactPoint::LeftHeel, ContactPoint::LeftToe, ContactPoint::LeftHand]),
        ("right foot: height, m", [ContactPoint::RightHeel, ContactPoint::RightToe, ContactPoint::RightHand]),
    ];
    for (row, (title, points)) in feet.into_iter().enumerate() {
        let above = row as f64 * BARS;
        let panel = Panel { frame: frame(row as f64, above), times, most: highest };
        panel.background(sheet, drawn, title);
        draw_foot(sheet, &panel, drawn, (points, floor));
    }
    let panel = Panel { frame: frame(2.0, 2.0 * BARS), times, most: fastest };
    panel.background(sheet, drawn, "speed of the root on the ground, m/s");
    panel.line(sheet, &drawn.times, &drawn.speeds, &format!(r#"stroke="{INK}" stroke-width="1.6""#));
    panel.time_axis(sheet, drawn.working.clip.fps);
    draw_events(sheet, &panel, drawn, place.y);
}

/// Height of the floor, metres: below the lowest point of the feet.
fn floor(drawn: &Drawn) -> f64 {
    let low = |places: &Vec<glam::DVec3>| {
        percentile(places.iter().map(|place| place.y).collect(), FLOOR_PERCENTILE)
    };
    let feet = drawn.points.iter().filter(|(point, _)| ContactPoint::FEET.contains(point));
    feet.map(|(_, places)| low(places)).reduce(f64::min).unwrap_or(0.0)
}

/// Ground off the floor, heights of heel and toe, and bars below while they, or the hand of the side, bear.
fn draw_foot(sheet: &mut Sheet, panel: &Panel, drawn: &Drawn, (points, floor): ([ContactPoint; 3], f64)) {
    let ink = foot_ink(points[0] == ContactPoint::LeftHeel);
    draw_grounds(sheet, panel, drawn, points);
    for (point, (name, bar, dash)) in points.into_iter().zip(ROWS) {
        let Some(places) = drawn.places(point) else { continue };
        if ContactPoint::FEET.contains(&point) {
            let heights: Vec<f64> = places.iter().map(|place| place.y - floor).collect();
            let pen = format!(r#"stroke="{ink}" stroke-width="1.5"{dash}"#);
            panel.line(sheet, &drawn.times, &heights, &pen);
        }
        let top = panel.frame.y + panel.frame.h + bar;
        let style = TextStyle { size: 9.0, colour: GREY, anchor: "end", halo: false };
        sheet.text([panel.frame.x - 6.0, top + 5.4], style, name);
        let bears: Vec<bool> = drawn.working.contacts.iter().map(|contact| contact.at(point)).collect();
        for run in runs(&bears) {
            let (from, to) = panel.span(drawn, run);
            let place = Rect { x: from, y: top, w: (to - from).max(1.0), h: 5.0 };
            sheet.rect(place, &format!(r#"fill="{ink}""#));
        }
    }
}

/// Heel, toe, hand: name, distance of the bar from the chart, px, and how the line is broken.
const ROWS: [(&str, f64, &str); 3] =
    [("heel", 7.0, ""), ("toe", 14.0, r#" stroke-dasharray="4 2.5""#), ("hand", 21.0, "")];

/// Shades from the floor up to what `points` rest on.
fn draw_grounds(sheet: &mut Sheet, panel: &Panel, drawn: &Drawn, points: [ContactPoint; 3]) {
    for ground in drawn.working.grounds.iter().filter(|ground| points.contains(&ground.point)) {
        let (from, to) = panel.span(drawn, (ground.first, ground.last));
        let (top, bottom) = (panel.y(ground.height), panel.y(0.0));
        let place = Rect { x: from, y: top, w: to - from, h: bottom - top };
        sheet.rect(place, &format!(r#"fill="{RAISED}""#));
    }
}

/// Dashed lines down all charts, named above them as far as there is room.
fn draw_events(sheet: &mut Sheet, panel: &Panel, drawn: &Drawn, top: f64) {
    let clip = &drawn.working.clip;
    let mut events: Vec<(f64, &str)> =
        clip.events.iter().map(|(name, frame)| (f64::from(frame.0) / clip.fps, name.as_str())).collect();
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    let style = TextStyle { size: 11.0, colour: "#b34700", anchor: "middle", halo: true };
    let mut free = 0.0;
    for (time, name) in events {
        let x = panel.x(time);
        let bottom = panel.frame.y + panel.frame.h;
        sheet.line([x, top], [x, bottom], r##"stroke="#d2691e" stroke-width="1" stroke-dasharray="3 3""##);
        let half = text_width(name, style.size) / 2.0;
        if x - half > free {
            sheet.text([x, top + 12.0], style, name);
            free = x + half + 4.0;
        }
    }
}

impl Panel {
    fn x(&self, time: f64) -> f64 {
        let share = (time - self.times.0) / (self.times.1 - self.times.0);
        self.frame.x + share.clamp(0.0, 1.0) * self.frame.w
    }

    fn y(&self, value: f64) -> f64 {
        self.frame.y + self.frame.h * (1.0 - (value / self.most).clamp(0.0, 1.0))
    }

    /// Left and right edge of working frames, each half a step wide to both sides, px.
    fn span(&self, drawn: &Drawn, (first, last): (usize, usize)) -> (f64, f64) {
        let half = crate::clip::working::WORKING_STEP / 2.0;
        (self.x(drawn.times[first] - half), self.x(drawn.times[last] + half))
    }

    /// Shades of what the body does, title and values.
    fn background(&self, sheet: &mut Sheet, drawn: &Drawn, title: &str) {
        let frame = self.frame;
        sheet.rect(frame, r##"fill="#fcfcfd""##);
        for (labels, shade) in [(&drawn.working.stationary, STATIONARY), (&drawn.working.flight, FLIGHT)] {
            for run in runs(labels) {
                let (from, to) = self.span(drawn, run);
                sheet.rect(Rect { x: from, w: to - from, ..frame }, &format!(r#"fill="{shade}""#));
            }
        }
        let style = |size, anchor| TextStyle { size, colour: GREY, anchor, halo: false };
        sheet.text([frame.x, frame.y - 6.0], style(11.5, "start"), title);
        let step = round_step(self.most / 4.0);
        for mark in marks(0.0, self.most, step) {
            let y = self.y(mark);
            sheet.line([frame.x, y], [frame.x + frame.w, y], r##"stroke="#dfe3e8" stroke-width="0.8""##);
            sheet.text([frame.x - 6.0, y + 3.6], style(10.5, "end"), &mark_label(mark, step));
        }
        sheet.rect(frame, r##"fill="none" stroke="#c9ced4" stroke-width="1""##);
    }

    fn line(&self, sheet: &mut Sheet, times: &[f64], values: &[f64], pen: &str) {
        let points: Vec<Point> =
            times.iter().zip(values).map(|(time, value)| [self.x(*time), self.y(*value)]).collect();
        sheet.polyline(&points, &format!(r#"{pen} stroke-linejoin="round""#));
    }

    /// Seconds, and below them the file's frames.
    fn time_axis(&self, sheet: &mut Sheet, fps: f64) {
        let bottom = self.frame.y + self.frame.h;
        let step = round_step(MARK_SPACING * (self.times.1 - self.times.0) / self.frame.w);
        let style = |size| TextStyle { size, colour: GREY, anchor: "middle", halo: false };
        for mark in marks(self.times.0, self.times.1, step) {
            let x = self.x(mark);
            sheet.line([x, bottom], [x, bottom + 4.0], r##"stroke="#9aa1a9" stroke-width="1""##);
            sheet.text([x, bottom + 15.0], style(10.5), &format!("{} s", mark_label(mark, step)));
            sheet.text([x, bottom + 28.0], style(9.0), &format!("{:.0}", mark * fps));
        }
        let left = TextStyle { anchor: "end", ..style(9.0) };
        sheet.text([self.frame.x - 6.0, bottom + 28.0], left, "frame");
    }
}
