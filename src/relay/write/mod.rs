//! The scene file of a relay: what people read, edit and compare.

mod carriers;
mod disturbing;
mod text;

use std::collections::BTreeSet;
use std::fmt::Write;

use self::carriers::{between, boxes, drag, end, first, hand_overs, last, marks, middle};
use self::disturbing::disturbing;
use self::text::{body, group, key};
use super::acts::{Act, turn};
use super::disturbers::{aside, jump, pat};
use super::layout::{Carrier, Layout, Part, disturbed, statures};
use super::ways::{wait_name, wait_seconds};
use super::{Along, Disturbance, Relay};

/// The whole file.
pub fn scene(relay: &Relay, layout: &Layout, command: &str) -> String {
    let mut text = head(relay, layout, command);
    text += &clips(relay, layout);
    if relay.discrete {
        text += "\n[discrete]                                  # steps come and go where boxes are carried, and nowhere else\n";
        text += "kinds = [\"duplicate\", \"delete\"]\n";
    }
    text += "\n# The boxes, and who picks each of them up: palms 0.12 m behind its middle, which leaves room for the next.\n";
    text += &group(&boxes(layout));
    text += "\n# Those who carry. The first picks its box up and hands it on.\n";
    text += &first(layout);
    let middle = middle(relay, layout);
    if !middle.rows.is_empty() {
        text += "\n# Each of these takes a box from the one before, turns, and carries it to the next.\n";
        text += &group(&middle);
    }
    let between = between(layout);
    if !between.rows.is_empty() {
        text += "\n# These start a box, walk back, and put the one before it down.\n";
        text += &group(&between);
    }
    text += "\n# The last one puts the last box down.\n";
    text += &last(relay, layout);
    text += "\n# The hand-overs: one moment, in which the taker stands face to face with the giver, palms of both on the box.\n";
    text += &group(&hand_overs(layout));
    text += "\n# Where: every other hand-over, and the end.\n";
    let marks = marks(layout);
    if !marks.rows.is_empty() {
        text += &group(&marks);
    }
    text += &end(layout);
    text += &relay.drag.map_or(String::new(), |metres| drag(layout, metres));
    text += &disturbing(relay, layout);
    text
}

fn head(relay: &Relay, layout: &Layout, command: &str) -> String {
    let (carriers, disturbers) = (layout.carriers.len(), layout.disturbers.len());
    let boxes = if relay.boxes == 1 { "one box".to_owned() } else { format!("{} boxes", relay.boxes) };
    let curve = match relay.along {
        Along::Line => "a line",
        Along::Circle => "a circle",
        Along::Spiral => "a spiral",
        Along::Points(_) => "a curve through points",
        Along::Drawing(_) => "a curve as drawn",
    };
    let mut text = format!("# A relay of {}: {carriers} hand {boxes} on along {curve}", relay.characters);
    if disturbers > 0 {
        let _ = write!(text, ", {disturbers} get in the way");
    }
    let _ = write!(
        text,
        ".\n# Written by: {command}\n\
         # What must hold: each of the {} hand-overs is one moment, in which the taker stands before the giver, face to face; a box\n\
         # has one owner at a time from first to last, never jumps, and both hands of its owner stay on it.\n\
         # A group stands for its tables once for every row, with the row's values in place of {{name}}.\n\
         \ntitle = \"Relay of {}\"\nfps = 30\n",
        carriers - 1,
        relay.characters
    );
    text
}

fn clips(relay: &Relay, layout: &Layout) -> String {
    let acts = &layout.acts;
    let has = |part: fn(&Part) -> bool| layout.carriers.iter().any(|carrier| part(&carrier.part));
    let between = has(|part| matches!(part, Part::Between(_)));
    let mut all: Vec<&Act> = vec![&acts.pick_up, &acts.hand_over, &acts.put_down, &acts.rest];
    if has(|part| matches!(part, Part::Middle(_) | Part::Last(_))) {
        all.extend(
            layout.carriers.iter().any(|carrier| is_taker(carrier) && !carrier.comes).then_some(&acts.wait),
        );
    }
    let jumps = disturbed(layout, Disturbance::Jump);
    let come = jumps || layout.carriers.iter().any(|carrier| carrier.comes);
    all.extend(come.then_some(&acts.come));
    all.push(&acts.take_over);
    all.extend(between.then_some(&acts.about));
    all.extend(acts.carries.iter().chain(&acts.backs));
    let mut made: Vec<Act> = turns(layout, true).into_iter().map(|degrees| turn(degrees, true)).collect();
    made.extend(turns(layout, false).into_iter().map(|degrees| turn(degrees, false)));
    made.extend(disturbing_clips(layout));
    let mut text = "\n[clips]\n".to_owned();
    for act in all.into_iter().chain(&made) {
        let _ = writeln!(text, "{} = {}", key(&act.name), act.declaration);
    }
    for seconds in waits(layout) {
        let name = key(&wait_name(seconds));
        let _ = writeln!(text, "{name} = {{ builtin = \"idle\", seconds = {seconds} }}");
    }
    let used: BTreeSet<String> = layout
        .carriers
        .iter()
        .map(|carrier| carrier.stature)
        .chain(layout.disturbers.iter().map(|disturber| disturber.stature))
        .map(body)
        .collect();
    for stature in statures(relay.heights).into_iter().filter(|stature| used.contains(&body(*stature))) {
        let _ = writeln!(text, "{} = {{ builtin = \"idle\", stature = {stature} }}", key(&body(stature)));
    }
    text
}

fn is_taker(carrier: &Carrier) -> bool {
    matches!(carrier.part, Part::Middle(_) | Part::Last(_))
}

fn turns(layout: &Layout, with_box: bool) -> BTreeSet<i32> {
    let turned = layout.carriers.iter().filter_map(|carrier| match carrier.part {
        Part::Middle(degrees) | Part::Last(degrees) if with_box => Some(degrees),
        Part::Between(back) if !with_box => back.facing,
        _ => None,
    });
    turned.collect()
}

/// Seconds of all clips of waiting, rising.
fn waits(layout: &Layout) -> Vec<f64> {
    let waits = layout.carriers.iter().filter_map(|carrier| match carrier.part {
        Part::Between(back) => Some(wait_seconds(back.wait)),
        _ => None,
    });
    let mut waits: Vec<f64> = waits.flatten().collect();
    waits.sort_by(f64::total_cmp);
    waits.dedup();
    waits
}

fn disturbing_clips(layout: &Layout) -> Vec<Act> {
    let leaves = |left: bool| {
        layout.disturbers.iter().any(|disturber| match disturber.how {
            Disturbance::Aside => disturber.left != left,
            Disturbance::Pat => disturber.left == left,
            Disturbance::Jump => false,
        })
    };
    let mut clips: Vec<Act> = [true, false].into_iter().filter(|left| leaves(*left)).map(aside).collect();
    clips.extend(disturbed(layout, Disturbance::Jump).then(jump));
    clips.extend(disturbed(layout, Disturbance::Pat).then(pat));
    clips
}
