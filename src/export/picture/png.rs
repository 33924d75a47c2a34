//! The picture in pixels.

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::roxmltree::{self, Document, Node};
use resvg::usvg::{self, Options, Tree};

use super::stroke_font;
use super::svg::number;

/// Why an SVG did not become a PNG.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// Not XML.
    #[error("the picture is not XML")]
    Xml(#[from] roxmltree::Error),
    /// Not SVG.
    #[error("the picture is not SVG")]
    Svg(#[from] usvg::Error),
    /// No picture has this size, or memory does not hold it.
    #[error("no picture is {width} pixels wide and {height} high")]
    Size {
        /// Asked width, pixels.
        width: u32,
        /// Height that belongs to it, pixels.
        height: u32,
    },
    /// The pixels could not be written as PNG.
    #[error("the pixels do not become a PNG")]
    Encode(#[source] Box<dyn std::error::Error + Send + Sync>),
}

/// PNG of an SVG, `width` pixels wide, on white. Texts are drawn with strokes of our own: the same on every machine, with
/// fonts or without.
///
/// # Errors
/// [`PictureError`] if the text is not SVG, or the width is 0 or too large.
pub fn to_png(svg: &str, width: u32) -> Result<Vec<u8>, PictureError> {
    let tree = Tree::from_str(&without_text(svg)?, &Options::default())?;
    let scale = f64::from(width) / f64::from(tree.size().width());
    let height = pixels(f64::from(tree.size().height()) * scale);
    let fits = u64::from(width) * u64::from(height) <= MOST_PIXELS;
    let pixmap = if fits { Pixmap::new(width, height) } else { None };
    let mut pixmap = pixmap.ok_or(PictureError::Size { width, height })?;
    pixmap.fill(Color::WHITE);
    let scale = width as f32 / tree.size().width();
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|error| PictureError::Encode(Box::new(error)))
}

/// Largest picture, pixels; each takes four bytes.
const MOST_PIXELS: u64 = 250_000_000;

/// Whole pixels, one at least.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "casts of floats saturate")]
fn pixels(length: f64) -> u32 {
    length.round().max(1.0) as u32
}

/// The SVG with strokes in place of texts.
fn without_text(svg: &str) -> Result<String, PictureError> {
    let document = Document::parse(svg)?;
    let mut drawn = String::with_capacity(svg.len() * 2);
    let mut done = 0;
    for text in
        document.descendants().filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "text")))
    {
        drawn.push_str(&svg[done..text.range().start]);
        drawn.push_str(&strokes(text));
        done = text.range().end;
    }
    drawn.push_str(&svg[done..]);
    Ok(drawn)
}

/// A text element as strokes, its rim below them.
fn strokes(node: Node) -> String {
    let value = |name: &str| node.attribute(name).and_then(|value| value.parse().ok()).unwrap_or(0.0);
    let text = node.text().unwrap_or("");
    let scale = value("font-size") / stroke_font::EM;
    let left = match node.attribute("text-anchor") {
        Some("middle") => value("x") - stroke_font::width(text) * scale / 2.0,
        Some("end") => value("x") - stroke_font::width(text) * scale,
        _ => value("x"),
    };
    let letters = letters(text);
    let pen = |colour: &str, width: f64| {
        let place = format!("translate({} {}) scale({scale})", number(left), number(value("y")));
        let round = r#"stroke-linecap="round" stroke-linejoin="round""#;
        format!(
            r#"<g transform="{place}" fill="none" stroke="{colour}" stroke-width="{width}" {round}>{letters}</g>"#
        )
    };
    let rim = node.attribute("stroke").map_or(String::new(), |colour| pen(colour, RIM));
    rim + &pen(node.attribute("fill").unwrap_or("#000000"), stroke_font::PEN)
}

/// Pen of the rim around letters, in units of the stroke font.
const RIM: f64 = 7.0;

fn letters(text: &str) -> String {
    stroke_font::lines(text)
        .filter(|(_, path)| !path.is_empty())
        .map(|(x, path)| format!(r#"<path transform="translate({})" d="{path}"/>"#, number(x)))
        .collect()
}
