//! A clip as a row of poses, drawn as simple clothed bodies with the boxes that they carry: who sees it recognises the motion.
//!
//! Poses that travel stand at their real distance where they do not cover each other, else they are spaced evenly. Frames
//! that events name are among them.

mod bearing;
mod camera;
mod figure;
mod fit;
pub(super) mod hull;
mod landmarks;
mod layout;
mod paint;
mod things;

pub use camera::StripView;
pub use things::{Company, StripThing};

use self::bearing::{Bearing, Bearings};
use self::camera::Camera;
use self::figure::{Figure, Group};
use self::layout::{Layout, Span, chosen_frames};
use self::paint::{Painter, Stand};
use super::sheet_document;
use super::svg::{GREY, INK, Sheet, TextStyle, clipped};
use crate::clip::Clip;
use crate::clip::facing::headings;
use crate::geometry::plan_of;
use crate::index::SourceFrame;
use glam::DVec3;

/// How a strip is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StripOptions {
    /// How many poses, at least one; never more than there are frames.
    pub poses: usize,
    /// From where.
    pub view: StripView,
}

impl Default for StripOptions {
    fn default() -> Self {
        Self { poses: 12, view: StripView::Side }
    }
}

/// One pose, ready to be drawn.
struct Posed {
    frame: SourceFrame,
    /// Ground below the body, world metres.
    origin: DVec3,
    groups: Vec<Group>,
    /// What it covers around its origin, metres.
    span: Span,
    bearing: Vec<Bearing>,
}

/// Around everything, px.
const MARGIN: f64 = 26.0;
/// Title and caption above the first row, px.
const HEAD: f64 = 76.0;
/// Frame numbers below a row, px.
const FOOT: f64 = 26.0;
/// Below a row, where there are several, px.
const BETWEEN_ROWS: f64 = 16.0;
/// Events below them, px.
const EVENTS: f64 = 18.0;

/// SVG of poses of `clip`, at most 1600 px wide, higher where they take several rows; with each pose the `company` near it.
/// Equal clips give equal text.
///
/// # Panics
/// If the clip has no frames.
pub fn strip_svg(clip: &Clip, company: &Company, options: &StripOptions) -> String {
    let figure = Figure::new(clip);
    let camera = Camera::new(options.view, heading(clip));
    let bearings = Bearings::of(clip);
    let frames = chosen_frames(clip, options.poses);
    let partners = things::partners(clip, company, &frames);
    let posed: Vec<Posed> = frames
        .into_iter()
        .map(|frame| {
            let mut own = posed(clip, &figure, (frame, &bearings));
            own.groups.extend(things::groups(company.things, frame.as_usize(), own.origin));
            own.groups.extend(things::partner_groups(&partners, frame, own.origin));
            own.span = span(&own, &camera);
            own
        })
        .collect();
    let spans: Vec<Span> = posed.iter().map(|pose| pose.span).collect();
    let travel: Vec<f64> = posed.iter().map(|pose| camera.place(pose.origin - posed[0].origin)[0]).collect();
    let layout = Layout::of(&spans, &travel);
    let mut sheet = Sheet::default();
    let (width, height) =
        (layout.width + 2.0 * MARGIN, HEAD + layout.rows as f64 * row_pitch(clip, &layout) + MARGIN / 2.0);
    write_head(&mut sheet, clip, (options, &layout), width);
    let mut painter = Painter { sheet: &mut sheet, camera, gradients: 0 };
    for row in 0..layout.rows {
        draw_row(&mut painter, clip, &posed, (&layout, row));
    }
    sheet_document(&clip.name, &sheet.body, width, height)
}

/// Heading that the view is taken against: where the clip goes if its body goes ahead, else where it looks at first.
fn heading(clip: &Clip) -> f64 {
    /// Shorter ways do not count, metres.
    const LEAST_WAY: f64 = 0.5;
    /// Further off its facing a body goes sideways or backwards, cosine of 60°.
    const AHEAD: f64 = 0.5;
    let (first, last) = clip.usable;
    let frames = vec![clip.skeleton.forward_kinematics(&clip.pose(first))];
    let facing = headings(&clip.skeleton, &frames).first().copied().unwrap_or(0.0);
    let plan = |frame: SourceFrame| plan_of(clip.root_positions[frame.as_usize()]);
    let way = plan(last) - plan(first);
    if way.norm() > LEAST_WAY && (way.arg() - facing).cos() > AHEAD { way.arg() } else { facing }
}

fn posed(clip: &Clip, figure: &Figure, (frame, bearings): (SourceFrame, &Bearings)) -> Posed {
    let frames = clip.skeleton.forward_kinematics(&clip.pose(frame));
    let origin = frames[0].position.with_y(figure.ground);
    let bearing = bearings.at(frame, &frames, figure.ground);
    Posed { frame, origin, groups: figure.groups(&frames), span: Span::default(), bearing }
}

fn span(pose: &Posed, camera: &Camera) -> Span {
    let balls = pose.groups.iter().flat_map(|group| &group.parts).flat_map(|part| &part.balls);
    balls.fold(Span::default(), |span, ball| span.with(camera.place(ball.centre - pose.origin), ball.radius))
}

fn write_head(sheet: &mut Sheet, clip: &Clip, (options, layout): (&StripOptions, &Layout), width: f64) {
    let style = |size, colour, anchor| TextStyle { size, colour, anchor, halo: false };
    let room = width - 2.0 * MARGIN;
    sheet.text([MARGIN, 34.0], style(20.0, INK, "start"), &clipped(&clip.name, 20.0, room));
    let (first, last) = clip.usable;
    let seconds = f64::from(last.0 - first.0) / clip.fps;
    let places = if layout.is_real { "at their distance" } else { "moved apart" };
    let caption = format!(
        "{}, {places}; frames {}–{} at {} a second, {seconds:.2} s",
        options.view.name(),
        first.0,
        last.0,
        super::rate(clip.fps),
    );
    sheet.text([MARGIN, 54.0], style(12.5, GREY, "start"), &clipped(&caption, 12.5, room));
}

/// Height of a row with its labels, px.
fn row_pitch(clip: &Clip, layout: &Layout) -> f64 {
    let events = if clip.events.is_empty() { 0.0 } else { EVENTS };
    layout.row_height() + FOOT + events + if layout.rows > 1 { BETWEEN_ROWS } else { 0.0 }
}

/// Ground, shadows, bodies and labels of one row.
fn draw_row(painter: &mut Painter, clip: &Clip, posed: &[Posed], (layout, row): (&Layout, usize)) {
    let top = HEAD + row as f64 * row_pitch(clip, layout);
    let ground = top + layout.above * layout.scale;
    let bottom = top + layout.row_height();
    let pen = r##"stroke="#b9c0c8" stroke-width="1""##;
    painter.sheet.line([MARGIN, ground], [MARGIN + layout.width, ground], pen);
    if row == 0 {
        draw_scale_bar(painter.sheet, layout);
    }
    let own = layout.places.iter().enumerate().filter(|(_, place)| place.0 == row);
    let stands: Vec<(usize, Stand)> = own
        .map(|(index, (_, x))| {
            let at = [MARGIN + x * layout.scale, ground];
            (index, Stand { origin: posed[index].origin, at, scale: layout.scale })
        })
        .collect();
    for (index, stand) in &stands {
        painter.shadow(&posed[*index].groups, stand);
    }
    for (index, stand) in &stands {
        let pose = &posed[*index];
        painter.sheet.open("", &format!("frame {}", pose.frame.0));
        painter.grounds(&pose.bearing, stand);
        painter.body(&pose.groups, stand);
        painter.bearing(&pose.bearing, stand);
        painter.sheet.close();
        label(painter.sheet, clip, pose.frame, [stand.at[0] + layout.label_offset(pose.span), bottom]);
    }
}

/// Number of a frame, and the events at it.
fn label(sheet: &mut Sheet, clip: &Clip, frame: SourceFrame, [x, bottom]: [f64; 2]) {
    let style = |size, colour| TextStyle { size, colour, anchor: "middle", halo: false };
    sheet.text([x, bottom + 18.0], style(12.0, GREY), &frame.0.to_string());
    let events: Vec<&str> =
        clip.events.iter().filter(|(_, at)| **at == frame).map(|(name, _)| name.as_str()).collect();
    if !events.is_empty() {
        sheet.text([x, bottom + 36.0], style(13.5, "#b34700"), &events.join(", "));
    }
}

/// A metre, at the right end of the head.
fn draw_scale_bar(sheet: &mut Sheet, layout: &Layout) {
    let (right, y) = (MARGIN + layout.width, 50.0);
    let left = right - layout.scale;
    let bar = [[left, y - 5.0], [left, y], [right, y], [right, y - 5.0]];
    sheet.polyline(&bar, &format!(r#"stroke="{INK}" stroke-width="1.4""#));
    let style = TextStyle { size: 11.5, colour: INK, anchor: "middle", halo: false };
    sheet.text([f64::midpoint(left, right), y - 7.0], style, "1 m");
}
