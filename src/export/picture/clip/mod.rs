//! The picture of one clip: its path from above, heights of its feet, its speed.

use std::sync::Arc;

mod ground;
mod panels;

use self::ground::{FACING, draw_ground};
use self::panels::draw_panels;
use super::sheet_document;
use super::svg::{GREY, INK, Point, Rect, Sheet, TextStyle, clipped, tinted};
use crate::clip::Clip;
use crate::clip::contacts::{ContactPoint, contact_point};
use crate::clip::measure::root_path;
use crate::clip::working::WorkingClip;
use crate::export::palette::colour;
use crate::geometry::plan_of;
use glam::DVec3;

/// Everything that is drawn, at working frames of the usable part.
struct Drawn {
    working: WorkingClip,
    /// Time of each working frame in the file, seconds: of its frame 0 is 0.
    times: Vec<f64>,
    /// Points of the feet that the skeleton has, and hands that bear, and where they are, metres.
    points: Vec<(ContactPoint, Vec<DVec3>)>,
    /// Root on the ground per second, m/s.
    speeds: Vec<f64>,
}

/// Width of the sheet, px.
const WIDTH: f64 = 1120.0;
/// Frames of the plan and of all charts, px.
const PLAN: Rect = Rect { x: 58.0, y: 78.0, w: 430.0, h: 452.0 };
const CHARTS: Rect = Rect { x: 560.0, y: 78.0, w: 536.0, h: 452.0 };
/// Height of the sheet, px.
const HEIGHT: f64 = 606.0;
/// Shades of flights and of stationary stretches.
const FLIGHT: &str = "#ffe9c2";
const STATIONARY: &str = "#e3e9f1";
/// Ground higher than the floor.
const RAISED: &str = "#d9c9ae";
/// Steps to each side over which a speed is taken, working frames: a ninth of a second in all.
const SPEED_REACH: usize = 2;

/// SVG of one clip, 1120 px wide: on the left its path from above with facings, prints of feet and hands, and times, on the
/// right heights of its feet with contacts and the ground off the floor, and its speed. Equal clips give equal text.
///
/// # Panics
/// If the clip has no frames.
pub fn clip_svg(clip: &Clip) -> String {
    let drawn = Drawn::of(clip);
    let mut sheet = Sheet::default();
    write_head(&mut sheet, clip);
    draw_ground(&mut sheet, &drawn, PLAN);
    draw_panels(&mut sheet, &drawn, CHARTS);
    write_legend(&mut sheet);
    sheet_document(&clip.name, &sheet.body, WIDTH, HEIGHT)
}

impl Drawn {
    fn of(clip: &Clip) -> Self {
        let (first, last) = clip.usable;
        let working = WorkingClip::new(&clip.name, Arc::new(clip.clone()), first, last);
        let count = working.frame_count();
        let times = (0..count).map(|index| working.source_frame(index as f64) / clip.fps).collect();
        let is_drawn = |point: &ContactPoint| {
            ContactPoint::FEET.contains(point) || working.contacts.iter().any(|contact| contact.at(*point))
        };
        let joints: Vec<_> = ContactPoint::ALL
            .into_iter()
            .filter(is_drawn)
            .filter_map(|point| Some((point, contact_point(&clip.skeleton, point)?)))
            .collect();
        let mut points: Vec<(ContactPoint, Vec<DVec3>)> =
            joints.iter().map(|(point, _)| (*point, Vec::with_capacity(count))).collect();
        for index in 0..count {
            let frames = clip.skeleton.forward_kinematics(&working.pose(index as f64));
            for ((_, places), (_, point)) in points.iter_mut().zip(&joints) {
                places.push(point.place(&frames));
            }
        }
        let speeds = speeds(&working, clip.fps);
        Self { working, times, points, speeds }
    }

    /// Where a point of a foot or a hand that bears is; `None` where the skeleton does not have it.
    fn places(&self, point: ContactPoint) -> Option<&[DVec3]> {
        self.points.iter().find(|(own, _)| *own == point).map(|(_, places)| places.as_slice())
    }
}

/// Speed of the root on the ground, from places a few frames before and after, m/s.
fn speeds(working: &WorkingClip, fps: f64) -> Vec<f64> {
    let last = working.frame_count() - 1;
    let place = |index: usize| plan_of(working.clip.root_at(working.source_frame(index as f64)));
    let time = |index: usize| working.source_frame(index as f64) / fps;
    (0..=last)
        .map(|index| {
            let (from, to) = (index.saturating_sub(SPEED_REACH), (index + SPEED_REACH).min(last));
            if from == to { 0.0 } else { (place(to) - place(from)).norm() / (time(to) - time(from)) }
        })
        .collect()
}

fn write_head(sheet: &mut Sheet, clip: &Clip) {
    let style = |size, colour| TextStyle { size, colour, anchor: "start", halo: false };
    let room = WIDTH - PLAN.x - 20.0;
    sheet.text([PLAN.x, 34.0], style(20.0, INK), &clipped(&clip.name, 20.0, room));
    let (first, last) = clip.usable;
    let way = root_path(clip, first, last);
    let caption = format!(
        "{} joints; frames {}–{} at {} a second, {:.2} s; {way:.2} m",
        clip.skeleton.joints.len(),
        first.0,
        last.0,
        super::rate(clip.fps),
        f64::from(last.0 - first.0) / clip.fps,
    );
    sheet.text([PLAN.x, 55.0], style(12.5, GREY), &clipped(&caption, 12.5, room));
}

/// What colours mean, below everything.
fn write_legend(sheet: &mut Sheet) {
    let y = HEIGHT - 24.0;
    let style = TextStyle { size: 11.5, colour: GREY, anchor: "start", halo: false };
    let swatch = |sheet: &mut Sheet, x: f64, fill: &str, name: &str| {
        let place = Rect { x, y: y - 9.0, w: 16.0, h: 11.0 };
        sheet.rect(place, &format!(r##"fill="{fill}" stroke="#9aa1a9" stroke-width="0.6" rx="2""##));
        sheet.text([x + 22.0, y], style, name);
    };
    swatch(sheet, PLAN.x, &foot_fill(true), "left foot");
    swatch(sheet, PLAN.x + 100.0, &foot_fill(false), "right foot");
    let tick: [Point; 2] = [[PLAN.x + 204.0, y - 4.0], [PLAN.x + 222.0, y - 4.0]];
    sheet.line(tick[0], tick[1], &format!(r#"stroke="{FACING}" stroke-width="1.5""#));
    sheet.circle(tick[0], 2.4, &format!(r#"fill="{INK}""#));
    sheet.text([tick[1][0] + 6.0, y], style, "place and facing at a time; later is darker");
    swatch(sheet, CHARTS.x, FLIGHT, "in flight");
    swatch(sheet, CHARTS.x + 96.0, STATIONARY, "stationary");
    swatch(sheet, CHARTS.x + 200.0, RAISED, "ground off the floor");
    sheet.text([CHARTS.x + 345.0, y], style, "bars: heel, toe, stated hand bear");
}

/// Colours of what is of a foot: for lines, for areas.
fn foot_ink(is_left: bool) -> String {
    tinted(colour(usize::from(!is_left)), 0.0)
}

fn foot_fill(is_left: bool) -> String {
    tinted(colour(usize::from(!is_left)), 0.6)
}
