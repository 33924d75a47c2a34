//! An edited scene from above, in motion: people as arrow heads that look where they face, and what is carried.
//!
//! Every motion is a list of keyframes (SMIL), as few as the picture can tell apart; a program that shows no animation shows
//! the beginning.

use std::fmt::Write as _;

use super::crowd::{CROWD, pen, shades_of};
use super::plan::{draw_grid, draw_scale_bar};
use super::simplify::{kept, simplified, tenths};
use super::svg::{GREY, INK, Rect, Sheet, TextStyle, clipped, escaped, number, tinted, title_of};
use super::view::{View, is_drawable};
use super::{FONTS, MARGIN, Picture, PictureObject, extent_of};
use crate::export::palette::colour;
use crate::geometry::{c64, wrap};

/// Width of the plan, px.
const WIDTH: f64 = 720.0;
/// Upper left corner of the plan, px: room for the title and for metres.
const CORNER: [f64; 2] = [56.0, 44.0];
/// Places and turns may be off by so much, px and degrees.
const OFF: (f64, f64) = (0.4, 6.0);
/// Ways that are drawn may be off by so much, px.
const WAY_OFF: f64 = 0.3;
/// Length of a person on the ground, metres, and the least on the sheet, px.
const PERSON: (f64, f64) = (0.75, 5.0);
/// Least side of what is carried, px.
const THING: f64 = 3.5;
/// It lasts no longer, seconds; what does is played faster.
const LONGEST: f64 = 30.0;
/// The end is shown for so long, seconds.
const PAUSE: f64 = 1.0;

/// SVG of an edited scene in motion, over and over, at the speed of life where it takes no longer than half a minute.
pub fn animated_svg(picture: &Picture) -> String {
    let extent = extent_of(picture);
    let view = View::fit(extent.plan, CORNER, (WIDTH, WIDTH));
    let span = (extent.times.1 - extent.times.0).max(1e-3);
    let clock = Clock { first: extent.times.0, span, seconds: span.min(LONGEST) + PAUSE };
    let mut sheet = Sheet::default();
    let style = TextStyle { size: 17.0, colour: INK, anchor: "start", halo: false };
    sheet.text([CORNER[0], CORNER[1] - 14.0], style, &clipped(picture.title, style.size, WIDTH - 120.0));
    let style = TextStyle { size: 10.5, colour: GREY, anchor: "end", halo: false };
    let speed = span / (clock.seconds - PAUSE);
    let told = if speed > 1.005 { format!("{span:.0} s, ×{speed:.1}") } else { format!("{span:.0} s") };
    sheet.text([CORNER[0] + WIDTH, CORNER[1] - 14.0], style, &told);
    draw_grid(&mut sheet, &view);
    sheet.open(r#"clip-path="url(#frame)""#, "plan");
    draw_ways(&mut sheet, &view, picture);
    let still = picture.objects.iter().filter(|object| object.poses.len() < 2);
    still.for_each(|object| super::objects::draw_object(&mut sheet, &view, object));
    draw_things(&mut sheet, &view, (picture, clock));
    draw_people(&mut sheet, &view, (picture, clock));
    sheet.close();
    draw_clock(&mut sheet, &view, clock);
    draw_scale_bar(&mut sheet, &view);
    let height = view.frame.y + view.frame.h + 34.0;
    document(picture.title, &sheet.body, (&view, height))
}

/// How scene time is played.
#[derive(Clone, Copy)]
struct Clock {
    /// First time of the scene, seconds.
    first: f64,
    /// Until its last one, seconds.
    span: f64,
    /// Of the animation, with the pause, seconds.
    seconds: f64,
}

impl Clock {
    /// Share of the animation at a scene time.
    fn share(&self, time: f64) -> f64 {
        let played = (time - self.first) / self.span * (self.seconds - PAUSE);
        (played / self.seconds).clamp(0.0, 1.0)
    }
}

/// Where somebody or something is, and turned how, along time.
struct Motion {
    /// Shares of the animation, rising.
    shares: Vec<f64>,
    /// px.
    places: Vec<[f64; 2]>,
    /// Degrees, clockwise on the sheet, without jumps.
    angles: Vec<f64>,
}

impl Motion {
    /// Of samples in the order of time: share, plan point, facing. Those that cannot be drawn are left out.
    fn of(view: &View, samples: impl Iterator<Item = (f64, c64, f64)>) -> Self {
        let mut motion = Self { shares: Vec::new(), places: Vec::new(), angles: Vec::new() };
        let mut facing_before = None;
        for (share, at, facing) in samples {
            if !is_drawable(at) || !facing.is_finite() || !share.is_finite() {
                continue;
            }
            let angle = match (facing_before, motion.angles.last()) {
                (Some(before), Some(angle)) => angle - wrap(facing - before).to_degrees(),
                _ => -wrap(facing).to_degrees(),
            };
            facing_before = Some(facing);
            motion.shares.push(share);
            motion.places.push(view.place(at));
            motion.angles.push(angle);
        }
        motion
    }

    /// `<animateTransform>` of both, each with as few keyframes as it needs; before, as an attribute, where it begins.
    fn animated(&self, seconds: f64) -> Option<(String, String)> {
        let (place, angle) = (self.places.first()?, self.angles.first()?);
        let share = |(a, b): (usize, usize), k: usize| {
            let span = self.shares[b] - self.shares[a];
            if span > 0.0 { (self.shares[k] - self.shares[a]) / span } else { 0.0 }
        };
        let off_place = |ends: (usize, usize), k: usize| {
            let s = share(ends, k);
            let at = |axis: usize| {
                let (from, to) = (self.places[ends.0][axis], self.places[ends.1][axis]);
                from + s * (to - from) - self.places[k][axis]
            };
            at(0).hypot(at(1))
        };
        let off_angle = |ends: (usize, usize), k: usize| {
            let (from, to) = (self.angles[ends.0], self.angles[ends.1]);
            (from + share(ends, k) * (to - from) - self.angles[k]).abs()
        };
        let count = self.shares.len();
        let place_of = |k: usize| format!("{} {}", short(self.places[k][0]), short(self.places[k][1]));
        let angle_of = |k: usize| format!("{:.0}", self.angles[k]);
        let moves = self.keyframes("translate", &kept(count, OFF.0, off_place), place_of, seconds);
        let turns = self.keyframes("rotate", &kept(count, OFF.1, off_angle), angle_of, seconds);
        let begins = format!("translate({} {}) rotate({angle:.0})", short(place[0]), short(place[1]));
        let turns = turns.replace("<animateTransform", r#"<animateTransform additive="sum""#);
        Some((begins, moves + &turns))
    }

    /// One animation of the frames `kept`; it holds before the first and after the last.
    fn keyframes(&self, kind: &str, kept: &[usize], value: impl Fn(usize) -> String, seconds: f64) -> String {
        let mut keys: Vec<(String, String)> = Vec::new();
        let first = kept.iter().take(1).map(|k| (0.0, *k));
        let last = kept.iter().rev().take(1).map(|k| (1.0, *k));
        for (share, k) in first.chain(kept.iter().map(|k| (self.shares[*k], *k))).chain(last) {
            let key = (share_text(share), value(k));
            if keys.last() != Some(&key) {
                keys.push(key);
            }
        }
        if keys.windows(2).all(|pair| pair[0].1 == pair[1].1) {
            keys = vec![("0".to_owned(), keys.first().map_or(String::new(), |key| key.1.clone()))];
            keys.push(("1".to_owned(), keys[0].1.clone()));
        }
        let (times, values): (Vec<String>, Vec<String>) = keys.into_iter().unzip();
        format!(
            r#"<animateTransform attributeName="transform" type="{kind}" dur="{}s" repeatCount="indefinite" keyTimes="{}" values="{}"/>"#,
            number(seconds),
            times.join(";"),
            values.join(";")
        )
    }
}

/// To the tenth of a pixel.
fn short(px: f64) -> String {
    let text = format!("{px:.1}");
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}

/// Four decimals: to the frame, in half a minute.
fn share_text(share: f64) -> String {
    let text = format!("{share:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text.is_empty() || text == "0" { "0".to_owned() } else { text.trim_start_matches('0').to_owned() }
}

/// Everybody's way, pale.
fn draw_ways(sheet: &mut Sheet, view: &View, picture: &Picture) {
    let mut data = String::new();
    for actor in &picture.actors {
        data += &tenths(&simplified(&view.path(actor.edited, 0.3), WAY_OFF));
    }
    let pen = 10.0 * pen(view);
    sheet.raw(&format!(
        r##"<path d="{data}" transform="scale(.1)" fill="none" stroke="#cfd6de" stroke-width="{pen:.1}" stroke-linecap="round"/>"##
    ));
}

fn draw_people(sheet: &mut Sheet, view: &View, (picture, clock): (&Picture, Clock)) {
    let length = (PERSON.0 * view.scale).max(PERSON.1);
    let [tip, back, side] = [0.6, -0.4, 0.38].map(|share| number(share * length));
    sheet.raw(&format!(
        r##"<defs><path id="who" d="M{tip} 0L{back} {side}L{} 0L{back} -{side}z" stroke="#fff" stroke-width=".7"/></defs>"##,
        number(-0.2 * length)
    ));
    let crowd = (picture.actors.len() >= CROWD).then(|| shades_of(picture));
    for (index, actor) in picture.actors.iter().enumerate() {
        let samples = actor.times.iter().zip(actor.edited).zip(actor.headings);
        let samples = samples.map(|((time, at), facing)| (clock.share(*time), *at, *facing));
        let Some((begins, animated)) = Motion::of(view, samples).animated(clock.seconds) else { continue };
        let fill = crowd.as_ref().map_or_else(|| tinted(colour(index), 0.0), |shades| shades[index].clone());
        sheet.raw(&format!(
            r##"<use href="#who" fill="{fill}" transform="{begins}"><title>{}</title>{animated}</use>"##,
            escaped(actor.name)
        ));
    }
}

/// What moves, where it is carried.
fn draw_things(sheet: &mut Sheet, view: &View, (picture, clock): (&Picture, Clock)) {
    for object in picture.objects.iter().filter(|object| object.poses.len() > 1) {
        let [w, h] = [object.size[0], object.size[2]].map(|side| (side * view.scale).max(THING));
        let samples = object_samples(object, picture, clock);
        let Some((begins, animated)) = Motion::of(view, samples).animated(clock.seconds) else { continue };
        let rect = Rect { x: -w / 2.0, y: -h / 2.0, w, h };
        let [x, y, w, h] = [rect.x, rect.y, rect.w, rect.h].map(number);
        let mut text = format!(r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" transform="{begins}""#);
        let _ = write!(
            text,
            r##" fill="#c79a5b" stroke="#6b5430" stroke-width=".8"><title>{}</title>{animated}</rect>"##,
            escaped(object.name)
        );
        sheet.raw(&text);
    }
}

fn object_samples<'a>(
    object: &'a PictureObject,
    picture: &Picture,
    clock: Clock,
) -> impl Iterator<Item = (f64, c64, f64)> + 'a {
    let (first, last) = picture.clock;
    let step = (last - first) / (object.poses.len() - 1) as f64;
    let poses = object.poses.iter().enumerate();
    poses.map(move |(k, pose)| (clock.share(first + k as f64 * step), pose.plan(), pose.facing))
}

/// A bar along the lower edge that grows with time.
fn draw_clock(sheet: &mut Sheet, view: &View, clock: Clock) {
    let frame = view.frame;
    let [x, y, w] = [frame.x, frame.y + frame.h - 3.0, frame.w].map(number);
    let end = share_text(clock.share(clock.first + clock.span));
    sheet.raw(&format!(
        r##"<rect x="{x}" y="{y}" width="0" height="3" fill="#3a6ea5"><animate attributeName="width" dur="{}s" repeatCount="indefinite" keyTimes="0;{end};1" values="0;{w};{w}"/></rect>"##,
        number(clock.seconds)
    ));
}

fn document(title: &str, body: &str, (view, height): (&View, f64)) -> String {
    let [width, height] = [CORNER[0] + WIDTH + MARGIN, height].map(number);
    let [x, y, w, h] = [view.frame.x, view.frame.y, view.frame.w, view.frame.h].map(number);
    let size = format!(r#"width="{width}" height="{height}" viewBox="0 0 {width} {height}""#);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" {size} font-family=\"{FONTS}\">\n{}\n\
         <clipPath id=\"frame\"><rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/></clipPath>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{body}</svg>\n",
        title_of(title)
    )
}
