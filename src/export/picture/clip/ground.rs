//! A clip from above: root path with facings and times, footprints, stationary stretches, flights.

use super::super::axis::{mark_label, marks, round_step};
use super::super::labels::Labels;
use super::super::plan::{draw_grid, draw_scale_bar};
use super::super::strip::hull::{Disk, hull};
use super::super::svg::{GREY, INK, Point, Rect, Sheet, TextStyle, tinted};
use super::super::view::{View, is_drawable, towards};
use super::{Drawn, FLIGHT, STATIONARY, foot_fill, foot_ink};
use crate::clip::contacts::{ContactPoint, runs};
use crate::geometry::{c64, cis, lerp_angle, plan_of};
use crate::path;

/// Colour of the path at its start and at its end, sRGB.
const PATH: ([f64; 3], [f64; 3]) = ([150.0, 168.0, 190.0], [30.0, 38.0, 52.0]);
/// Pieces of the path, each of one colour.
const PIECES: usize = 24;
const ROUND: &str = r#"stroke-linecap="round" stroke-linejoin="round""#;
/// Colour of facing ticks.
pub(super) const FACING: &str = "#8a2be2";
/// Most times along a path, and the least path between two, px.
const TICKS: (f64, f64) = (12.0, 34.0);
/// Length of a facing tick, px.
const TICK: f64 = 15.0;
/// Heel to ball, half a heel's width, half a ball's, of a foot without a toe to measure, metres.
const FOOT: [f64; 3] = [0.13, 0.034, 0.044];
/// Radius of a hand's ring, metres.
const HAND: f64 = 0.05;
/// From the toe joint to the tip of the foot, metres.
const TIP: f64 = 0.05;

/// Draws the plan into `frame`.
pub(super) fn draw_ground(sheet: &mut Sheet, drawn: &Drawn, frame: Rect) {
    let prints = footprints(drawn);
    let corners = prints.iter().flat_map(|print| print.disks.map(|(centre, _)| centre));
    let view = View::enclosing(drawn.working.positions.iter().copied().chain(corners), frame);
    draw_grid(sheet, &view);
    sheet.raw(&clip_path(frame));
    sheet.open(r#"clip-path="url(#frame)""#, "path from above");
    draw_stays(sheet, &view, drawn);
    for print in &prints {
        let disks: Vec<Disk> =
            print.disks.iter().map(|(centre, radius)| (view.place(*centre), radius * view.scale)).collect();
        let (fill, ink) = (foot_fill(print.is_left), foot_ink(print.is_left));
        sheet.polygon(
            &hull(&disks, 16),
            &format!(r#"fill="{fill}" fill-opacity="0.7" stroke="{ink}" stroke-width="0.7""#),
        );
    }
    draw_hands(sheet, &view, drawn);
    draw_path(sheet, &view, drawn);
    draw_times(sheet, &view, drawn);
    sheet.close();
    draw_scale_bar(sheet, &view);
}

fn clip_path(frame: Rect) -> String {
    let [x, y, w, h] = [frame.x, frame.y, frame.w, frame.h].map(super::super::svg::number);
    format!(r#"<clipPath id="frame"><rect x="{x}" y="{y}" width="{w}" height="{h}"/></clipPath>"#)
}

/// A foot on the ground.
struct Footprint {
    is_left: bool,
    /// Heel, ball, tip.
    disks: [(c64, f64); 3],
}

/// One print for each time a foot is put down, where it stands flattest in the middle of that time.
fn footprints(drawn: &Drawn) -> Vec<Footprint> {
    let mut prints = Vec::new();
    for (heel, toe) in
        [(ContactPoint::LeftHeel, ContactPoint::LeftToe), (ContactPoint::RightHeel, ContactPoint::RightToe)]
    {
        let Some(ankles) = drawn.places(heel) else { continue };
        let contacts = &drawn.working.contacts;
        let bears: Vec<bool> = contacts.iter().map(|contact| contact.at(heel) || contact.at(toe)).collect();
        for (first, last) in runs(&bears) {
            let middle = usize::midpoint(first, last);
            let is_flat = |index: &usize| contacts[*index].at(heel) && contacts[*index].at(toe);
            let flat = (first..=last).filter(is_flat).min_by_key(|index| index.abs_diff(middle));
            let index = flat.unwrap_or(middle);
            let ankle = plan_of(ankles[index]);
            let facing = cis(drawn.working.headings[index]) * FOOT[0];
            let along = drawn.places(toe).map_or(facing, |toes| plan_of(toes[index]) - ankle);
            let ahead = if along.norm() > 1e-6 { along / along.norm() } else { facing / FOOT[0] };
            prints.push(Footprint {
                is_left: heel == ContactPoint::LeftHeel,
                disks: [
                    (ankle - ahead * FOOT[1], FOOT[1]),
                    (ankle + along, FOOT[2]),
                    (ankle + along + ahead * TIP, FOOT[1]),
                ],
            });
        }
    }
    prints
}

/// A ring at the mean place of each time that a hand bears.
fn draw_hands(sheet: &mut Sheet, view: &View, drawn: &Drawn) {
    for hand in [ContactPoint::LeftHand, ContactPoint::RightHand] {
        let Some(places) = drawn.places(hand) else { continue };
        let ink = foot_ink(hand == ContactPoint::LeftHand);
        let bears: Vec<bool> = drawn.working.contacts.iter().map(|contact| contact.at(hand)).collect();
        for (first, last) in runs(&bears) {
            let count = (last + 1 - first) as f64;
            let middle = places[first..=last].iter().map(|place| plan_of(*place)).sum::<c64>() / count;
            if is_drawable(middle) {
                let radius = (HAND * view.scale).max(3.0);
                let pen = format!(r#"fill="none" stroke="{ink}" stroke-width="2""#);
                sheet.open("", "hand");
                sheet.circle(view.place(middle), radius, &pen);
                sheet.close();
            }
        }
    }
}

/// A disk around each stationary stretch, with its length.
fn draw_stays(sheet: &mut Sheet, view: &View, drawn: &Drawn) {
    for (first, last) in runs(&drawn.working.stationary) {
        let stretch = &drawn.working.positions[first..=last];
        let middle = stretch.iter().sum::<c64>() / stretch.len() as f64;
        let reach = stretch.iter().map(|point| (point - middle).norm()).fold(0.0, f64::max);
        if is_drawable(middle) {
            let radius = (reach * view.scale + 9.0).max(16.0);
            sheet.open("", &format!("stays for {:.2} s", drawn.times[last] - drawn.times[first]));
            sheet.circle(
                view.place(middle),
                radius,
                &format!(r##"fill="{STATIONARY}" stroke="#b9c4d2" stroke-width="0.8""##),
            );
            sheet.close();
        }
    }
}

fn draw_path(sheet: &mut Sheet, view: &View, drawn: &Drawn) {
    let positions = &drawn.working.positions;
    for (first, last) in runs(&drawn.working.flight) {
        let points = view.path(&positions[first..=last], 0.5);
        sheet.polyline(&points, &format!(r#"stroke="{FLIGHT}" stroke-width="9" stroke-linecap="round""#));
    }
    let last = positions.len() - 1;
    for piece in 0..PIECES.min(last) {
        let (from, to) = (piece * last / PIECES.min(last), (piece + 1) * last / PIECES.min(last));
        let share = piece as f64 / PIECES as f64;
        let stroke = tinted([0, 1, 2].map(|k| PATH.0[k] + share * (PATH.1[k] - PATH.0[k])), 0.0);
        let points = view.path(&positions[from..=to], 0.5);
        sheet.polyline(&points, &format!(r#"stroke="{stroke}" stroke-width="1.9" {ROUND}"#));
    }
}

/// Dots, facing ticks and times along the path; the first and the last frame among them.
fn draw_times(sheet: &mut Sheet, view: &View, drawn: &Drawn) {
    let (first, last) = (drawn.times[0], drawn.times[drawn.times.len() - 1]);
    let points = view.path(&drawn.working.positions, 0.5);
    let length: f64 =
        points.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum();
    let step = round_step((last - first) * (TICKS.1 / length.max(1.0)).clamp(1.0 / TICKS.0, 0.25));
    let mut labels = Labels { frame: view.frame, names: Vec::new(), symbols: Vec::new(), ink: points };
    let mut shown: Vec<(f64, Point)> = Vec::new();
    let inner =
        marks(first, last, step).into_iter().filter(|t| *t > first + 0.3 * step && *t < last - 0.3 * step);
    for time in std::iter::once(first).chain(inner).chain((last > first).then_some(last)) {
        let (at, heading) = pose_at(drawn, time);
        if !is_drawable(at) {
            continue;
        }
        let from = view.place(at);
        let is_end = time == first || time == last;
        let pen = format!(r#"stroke="{FACING}" stroke-width="{}" {ROUND}"#, if is_end { 2.2 } else { 1.5 });
        sheet.line(from, towards(from, heading, TICK), &pen);
        sheet.circle(from, if is_end { 3.6 } else { 2.4 }, &format!(r#"fill="{INK}""#));
        labels.reserve(from, 4.0);
        labels.reserve(towards(from, heading, TICK * 0.6), 5.0);
        shown.push((time, from));
    }
    let style = |colour| TextStyle { size: 10.5, colour, anchor: "middle", halo: true };
    // Ends first: they must not be crowded out.
    shown.sort_by_key(|(time, _)| !(*time == first || *time == last));
    for (time, at) in shown {
        let is_end = time == first || time == last;
        let text = if is_end { format!("{time:.2} s") } else { mark_label(time, step) };
        labels.write(sheet, at, (&text, style(if is_end { INK } else { GREY })), 55.0);
    }
}

/// Place and heading at a time of the file.
fn pose_at(drawn: &Drawn, time: f64) -> (c64, f64) {
    let working = &drawn.working;
    let last = (working.frame_count() - 1) as f64;
    let frame = working.working_frame(time * working.clip.fps).clamp(0.0, last);
    let (lower, share) = (frame.floor(), frame - frame.floor());
    let index = crate::index::floor_index(lower);
    let next = (index + 1).min(working.frame_count() - 1);
    let heading = lerp_angle(working.headings[index], working.headings[next], share);
    (path::at(&working.positions, frame), heading)
}
