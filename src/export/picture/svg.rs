//! SVG text, one element a call, with fixed decimals so that equal pictures are equal files.

use std::fmt::Write as _;

use super::stroke_font;

/// Point of the sheet, px: x right, y down.
pub(super) type Point = [f64; 2];

/// Colour of text, axes and what ties characters.
pub(super) const INK: &str = "#22262b";
/// Colour of labels that explain.
pub(super) const GREY: &str = "#6b727a";
/// Furthest a coordinate may lie from the sheet's origin, px.
const LIMIT: f64 = 1e6;

/// Upright rectangle of the sheet, px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rect {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub w: f64,
    /// Height.
    pub h: f64,
}

impl Rect {
    /// Whether the two share more than an edge.
    pub(super) fn overlaps(&self, other: &Rect) -> bool {
        self.x < other.x + other.w
            && other.x < self.x + self.w
            && self.y < other.y + other.h
            && other.y < self.y + self.h
    }

    /// Whether the point lies inside.
    pub(super) fn contains(&self, [x, y]: Point) -> bool {
        self.x <= x && x <= self.x + self.w && self.y <= y && y <= self.y + self.h
    }

    /// Whether `other` lies inside.
    pub(super) fn encloses(&self, other: &Rect) -> bool {
        self.contains([other.x, other.y]) && self.contains([other.x + other.w, other.y + other.h])
    }
}

/// How a text stands at its point.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextStyle<'a> {
    /// Font size, px.
    pub size: f64,
    /// Fill colour.
    pub colour: &'a str,
    /// `start`, `middle` or `end`.
    pub anchor: &'a str,
    /// With a white rim that keeps lines below it apart.
    pub halo: bool,
}

/// Elements of a picture, in drawing order.
#[derive(Default)]
pub(super) struct Sheet {
    /// The elements so far.
    pub body: String,
}

impl Sheet {
    /// Adds text as it is.
    pub(super) fn raw(&mut self, text: &str) {
        self.body.push_str(text);
        self.body.push('\n');
    }

    /// Opens a group; `attributes` as in SVG, `title` is shown when pointing at it.
    pub(super) fn open(&mut self, attributes: &str, title: &str) {
        self.raw(&format!("<g {attributes}>{}", title_of(title)));
    }

    /// Closes the group opened last.
    pub(super) fn close(&mut self) {
        self.raw("</g>");
    }

    /// Straight line.
    pub(super) fn line(&mut self, from: Point, to: Point, attributes: &str) {
        let [x1, y1] = from.map(number);
        let [x2, y2] = to.map(number);
        self.raw(&format!(r#"<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" {attributes}/>"#));
    }

    /// Polyline without fill.
    pub(super) fn polyline(&mut self, points: &[Point], attributes: &str) {
        self.raw(&format!(r#"<polyline points="{}" fill="none" {attributes}/>"#, listed(points)));
    }

    /// Closed polygon.
    pub(super) fn polygon(&mut self, points: &[Point], attributes: &str) {
        self.raw(&format!(r#"<polygon points="{}" {attributes}/>"#, listed(points)));
    }

    /// Disk or circle.
    pub(super) fn circle(&mut self, centre: Point, radius: f64, attributes: &str) {
        let [x, y] = centre.map(number);
        self.raw(&format!(r#"<circle cx="{x}" cy="{y}" r="{}" {attributes}/>"#, number(radius)));
    }

    /// Upright rectangle.
    pub(super) fn rect(&mut self, rect: Rect, attributes: &str) {
        let [x, y, w, h] = [rect.x, rect.y, rect.w, rect.h].map(number);
        self.raw(&format!(r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" {attributes}/>"#));
    }

    /// A line of text, its baseline at `at`.
    pub(super) fn text(&mut self, at: Point, style: TextStyle, text: &str) {
        let [x, y] = at.map(number);
        let TextStyle { size, colour, anchor, halo } = style;
        let size = number(size);
        let rim = if halo {
            r##" stroke="#ffffff" stroke-width="3" stroke-linejoin="round" paint-order="stroke""##
        } else {
            ""
        };
        let place = format!(r#"x="{x}" y="{y}" font-size="{size}" text-anchor="{anchor}""#);
        self.raw(&format!(r#"<text {place} fill="{colour}"{rim}>{}</text>"#, escaped(text)));
    }
}

/// `<title>` element.
pub(super) fn title_of(text: &str) -> String {
    format!("<title>{}</title>", escaped(text))
}

/// Width of a line of text, px.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    stroke_font::width(text) * size / stroke_font::EM
}

/// The text, cut with an ellipsis where it is wider than `width` px; empty if not even that fits.
pub(super) fn clipped(text: &str, size: f64, width: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let mut kept: Vec<char> = text.chars().take(400).collect();
    while kept.pop().is_some() {
        let short = format!("{}…", kept.iter().collect::<String>().trim_end());
        if text_width(&short, size) <= width {
            return if kept.is_empty() { String::new() } else { short };
        }
    }
    String::new()
}

/// Text with what XML reserves escaped, and what it forbids replaced.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Hexadecimal sRGB, `share` of the way to white.
pub(super) fn tinted<Channel: Into<f64>>(colour: [Channel; 3], share: f64) -> String {
    let [r, g, b] = colour.map(|channel| {
        let channel: f64 = channel.into();
        format!("{:.0}", channel + (255.0 - channel) * share)
    });
    format!("rgb({r},{g},{b})")
}

/// A coordinate with two decimals at most; what is not finite becomes 0.
pub(super) fn number(value: f64) -> String {
    let value = if value.is_finite() { value.clamp(-LIMIT, LIMIT) } else { 0.0 };
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn listed(points: &[Point]) -> String {
    let mut list = String::with_capacity(points.len() * 14);
    for [x, y] in points {
        let gap = if list.is_empty() { "" } else { " " };
        let _ = write!(list, "{gap}{},{}", number(*x), number(*y));
    }
    list
}
