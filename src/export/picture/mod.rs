//! Pictures as SVG and PNG: of an edited scene, its paths from above and its time tracks below; of one clip; charts of costs.

use std::fmt::Write as _;

use crate::geometry::c64;
use crate::object::ObjectPose;

mod animated;
mod axis;
mod chart;
mod clip;
mod crowd;
mod density;
mod extent;
mod flags;
mod handles;
mod labels;
mod legend;
mod matrix;
mod objects;
mod plan;
mod png;
mod simplify;
mod strip;
mod stroke_font;
mod svg;
mod touch_up;
mod tracks;
mod view;

pub use animated::animated_svg;
pub use chart::{Chart, Series, chart_svg};
pub use clip::clip_svg;
pub use extent::{Extent, extent_of};
pub use matrix::graph_svg;
pub use png::{PictureError, to_png};
pub use strip::{Company, StripOptions, StripThing, StripTie, StripView, strip_svg};
pub use touch_up::{TouchUpCurves, touch_up_svg};

use crowd::CROWD;
use legend::draw_legend;
use plan::draw_plan;
use svg::{INK, Rect, Sheet, TextStyle, clipped, number, title_of};
use tracks::draw_tracks;
use view::View;

/// An edited scene as it is drawn.
#[derive(Clone, Debug, Default)]
pub struct Picture<'a> {
    /// Title of the scene.
    pub title: &'a str,
    /// Who moves, in the order of their rows and colours.
    pub actors: Vec<Actor<'a>>,
    /// What stands around.
    pub objects: Vec<PictureObject<'a>>,
    /// Constraints on places and facings.
    pub handles: Vec<Handle>,
    /// Constraints on times.
    pub ties: Vec<Tie>,
    /// Scene times of the first and the last pose of objects that move, between which the others are spread evenly, seconds.
    pub clock: (f64, f64),
}

/// An object of the scene, a box seen from above.
#[derive(Clone, Debug)]
pub struct PictureObject<'a> {
    /// Its name.
    pub name: &'a str,
    /// Length ahead, height, width across, metres.
    pub size: [f64; 3],
    /// Where it is: one pose, or its poses along time.
    pub poses: Vec<ObjectPose>,
    /// Where it is grasped and where it is released, plan metres.
    pub grasped: Vec<c64>,
    /// See `grasped`.
    pub released: Vec<c64>,
}

/// One character before and after the edit; frame by frame, 30 a second of rest time.
#[derive(Clone, Debug)]
pub struct Actor<'a> {
    /// Its name.
    pub name: &'a str,
    /// Path before the edit, plan metres.
    pub rest: &'a [c64],
    /// Path after the edit, plan metres.
    pub edited: &'a [c64],
    /// Facing of each edited frame, radians.
    pub headings: &'a [f64],
    /// Scene time of each edited frame, seconds, rising.
    pub times: &'a [f64],
    /// Label, first and last frame of each clip.
    pub clips: Vec<(String, usize, usize)>,
    /// First and last frame of each stationary stretch.
    pub stationary: Vec<(usize, usize)>,
}

/// A constraint on a place or a facing.
#[derive(Clone, Debug)]
pub struct Handle {
    /// Position of the actor in [`Picture::actors`].
    pub actor: usize,
    /// Fractional frame of the actor it holds.
    pub frame: f64,
    /// Where it shall be, plan metres.
    pub target: Option<c64>,
    /// Where it shall look, radians.
    pub facing: Option<f64>,
    /// Holds exactly; otherwise as nearly as can be.
    pub hard: bool,
    /// Name of the constraint.
    pub name: String,
    /// For placements relative to another actor: that actor and its fractional frame.
    pub partner: Option<(usize, f64)>,
    /// Where drags took it from, plan metres.
    pub dragged_from: Option<c64>,
}

/// A constraint on times.
#[derive(Clone, Debug)]
pub struct Tie {
    /// Actor and scene time, seconds, of each moment.
    pub points: Vec<(usize, f64)>,
    /// Name of the constraint.
    pub name: String,
    /// The time is given; otherwise the moments are tied to each other.
    pub pinned: bool,
}

/// Width of the sheet, px.
const WIDTH: f64 = 1000.0;
/// Left and right edges of the plan's frame, px; the legend stands right of it.
const PLAN: (f64, f64) = (56.0, 830.0);
/// Upper edge of the plan's frame, px.
const TOP: f64 = 52.0;
/// Greatest height of the plan's frame where people are few, px; a crowd has a square.
const HIGHEST: f64 = 580.0;
/// Around everything, px.
const MARGIN: f64 = 18.0;
/// Families for all text; what is there first counts.
const FONTS: &str = "Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif";

/// SVG of an edited scene, 1000 px wide: the plan with a metric grid, a legend, time tracks.
///
/// Equal pictures give equal text. Coordinates that are not finite are left out; names of constraints, and names that
/// find no room, are there as `<title>` of what they name; of more than 200 actors, only theirs. Size: linear in actors, some
/// hundred bytes for each of so many.
pub fn to_svg(picture: &Picture) -> String {
    to_svg_covering(picture, &extent_of(picture))
}

/// The same with plan and time axis as large as `extent`: pictures of one extent show everything at the same place and scale.
pub fn to_svg_covering(picture: &Picture, extent: &Extent) -> String {
    let mut sheet = Sheet::default();
    let highest = if picture.actors.len() < CROWD { HIGHEST } else { PLAN.1 - PLAN.0 };
    let view = View::fit(extent.plan, [PLAN.0, TOP], (PLAN.1 - PLAN.0, highest));
    let style = TextStyle { size: 19.0, colour: INK, anchor: "start", halo: false };
    sheet.text([PLAN.0, TOP - 17.0], style, &clipped(picture.title, style.size, WIDTH - PLAN.0 - MARGIN));
    draw_plan(&mut sheet, &view, picture);
    draw_legend(&mut sheet, [PLAN.1 + 16.0, TOP], picture);
    let top = view.frame.y + view.frame.h + 34.0;
    let place = Rect { x: MARGIN, y: top, w: WIDTH - 2.0 * MARGIN, h: 0.0 };
    let height = draw_tracks(&mut sheet, picture, (place, extent)) + MARGIN;
    document(picture.title, &sheet.body, (height, view.frame))
}

/// The whole file around the elements.
fn document(title: &str, body: &str, (height, frame): (f64, Rect)) -> String {
    let (width, height) = (number(WIDTH), number(height));
    let [x, y, w, h] = [frame.x, frame.y, frame.w, frame.h].map(number);
    let mut out = String::with_capacity(body.len() + 1000);
    let size = format!(r#"width="{width}" height="{height}" viewBox="0 0 {width} {height}""#);
    let _ = writeln!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="{FONTS}">"#);
    let _ = writeln!(out, "{}", title_of(title));
    let _ =
        writeln!(out, r#"<clipPath id="frame"><rect x="{x}" y="{y}" width="{w}" height="{h}"/></clipPath>"#);
    let _ = writeln!(out, r##"<rect width="{width}" height="{height}" fill="#ffffff"/>"##);
    out.push_str(body);
    out.push_str("</svg>\n");
    out
}

/// A whole file of some size around elements, on white.
fn sheet_document(title: &str, body: &str, width: f64, height: f64) -> String {
    let whole = Rect { x: 0.0, y: 0.0, w: width, h: height };
    let mut paper = Sheet::default();
    paper.rect(whole, r##"fill="#ffffff""##);
    let [width, height] = [width, height].map(number);
    let size = format!(r#"width="{width}" height="{height}" viewBox="0 0 {width} {height}""#);
    let mut out = String::with_capacity(body.len() + 1000);
    let fonts = FONTS;
    let _ = writeln!(out, r#"<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="{fonts}">"#);
    let _ = writeln!(out, "{}", title_of(title));
    out.push_str(&paper.body);
    out.push_str(body);
    out.push_str("</svg>\n");
    out
}

/// A rate with as many of three decimals as it needs.
fn rate(fps: f64) -> String {
    let text = format!("{fps:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests;
