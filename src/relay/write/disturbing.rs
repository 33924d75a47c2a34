//! Those who get in the way.

use std::fmt::Write;

use super::carriers::way;
use super::text::{Group, HARD, Relative, body, character, degrees, group, point, quoted, relative, sync};
use crate::geometry::c64;
use crate::relay::acts::Place;
use crate::relay::disturbers::{ASIDE_AT, Disturber, PAT_FROM, TAKEOFF, aside_name, pat_from};
use crate::relay::layout::{Layout, disturbed};
use crate::relay::{Disturbance, Relay};

pub(super) fn disturbing(relay: &Relay, layout: &Layout) -> String {
    let comments = [
        (Disturbance::Aside, "Who stands in a carrier's way steps aside just as it comes."),
        (Disturbance::Jump, "Who jumps over a hurdle takes off as a carrier comes by."),
        (Disturbance::Pat, "Who waits for a box is patted on the back, by a hand that then goes away."),
    ];
    let mut text = String::new();
    for (how, comment) in comments.into_iter().filter(|(how, _)| disturbed(layout, *how)) {
        let _ = write!(text, "\n# {comment}\n");
        let own = |disturber: &&(usize, &Disturber)| disturber.1.how == how;
        let all: Vec<(usize, &Disturber)> = layout.disturbers.iter().enumerate().collect();
        let rows = all.iter().filter(own).map(|(index, disturber)| match how {
            Disturbance::Aside => aside_row(layout, *index, disturber),
            Disturbance::Jump => jump_row(layout, *index, disturber),
            Disturbance::Pat => pat_row(*index, disturber),
        });
        let (keys, tables) = match how {
            Disturbance::Aside => (ASIDE_KEYS, aside_tables()),
            Disturbance::Jump => (JUMP_KEYS, jump_tables()),
            Disturbance::Pat => (PAT_KEYS, pat_tables()),
        };
        text += &group(&Group { keys, rows: rows.collect(), tables });
    }
    debug_assert!(relay.disturbers != Some(0) || text.is_empty(), "nobody disturbs unasked");
    text
}

fn whom(index: usize, disturber: &Disturber) -> Vec<String> {
    vec![
        (index + 1).to_string(),
        (disturber.whom + 1).to_string(),
        point(disturber.start.position),
        degrees(disturber.start.facing),
        quoted(&body(disturber.stature)),
    ]
}

const ASIDE_KEYS: &[&str] = &["n", "carrier", "walks", "position", "facing", "body", "steps", "late", "left"];

/// With the name of the carrier's walk.
fn walking(layout: &Layout, index: usize, disturber: &Disturber) -> Vec<String> {
    let mut row = whom(index, disturber);
    row.insert(2, quoted(way(layout, &layout.carriers[disturber.whom])));
    row
}

fn aside_row(layout: &Layout, index: usize, disturber: &Disturber) -> Vec<String> {
    let mut row = walking(layout, index, disturber);
    let side = if disturber.left { ASIDE_AT.1 } else { -ASIDE_AT.1 };
    row.extend([quoted(aside_name(!disturber.left)), format!("{:.2}", disturber.late), format!("{side:.1}")]);
    row
}

/// A carrier's moment half way.
const HALFWAY: &str = "carrier {carrier}/{walks}:halfway";
/// What such a moment is held together with.
const AS_COMES: &str = "disturber {n} as carrier {carrier} comes";

fn aside_tables() -> String {
    let at = "disturber {n}/{steps}:aside";
    let before = relative(&Relative {
        name: "disturber {n} before carrier {carrier}",
        at,
        to: HALFWAY,
        offset: &format!("[{:?}, \"{{left}}\"]", ASIDE_AT.0),
        facing: Some("180.0"),
        strength: "1.0",
    });
    character("disturber {n}", "[\"{steps}\"]") + &before + &sync(AS_COMES, [at, HALFWAY], Some("{late}"))
}

const JUMP_KEYS: &[&str] =
    &["n", "carrier", "walks", "position", "facing", "body", "hurdle", "heading", "late", "past", "left"];

fn jump_row(layout: &Layout, index: usize, disturber: &Disturber) -> Vec<String> {
    let mut row = walking(layout, index, disturber);
    let hurdle = disturber.hurdle.unwrap_or(Place { position: c64::new(0.0, 0.0), facing: 0.0 });
    let (past, left) = disturber.beside;
    row.extend([
        point(hurdle.position),
        degrees(hurdle.facing),
        format!("{:.2}", disturber.late),
        format!("{past:.1}"),
        format!("{left:.1}"),
    ]);
    row
}

fn jump_tables() -> String {
    let at = "disturber {n}/jump:takeoff";
    let hurdle = r#"
[[group.object]]
name = "hurdle {n}"
size = [0.08, 0.3, 1.0]
position = "{hurdle}"
facing = "{heading}"
"#;
    let pelvis = "# of the pelvis, which is ahead of the feet: the flight is half way over it";
    let before = relative(&Relative {
        name: "disturber {n} before its hurdle",
        at,
        to: "hurdle {n}",
        offset: &format!("{:<35}{pelvis}", format!("[{:?}, 0.0]", -TAKEOFF)),
        facing: Some("0.0"),
        strength: HARD,
    });
    let beside = relative(&Relative {
        name: "carrier {carrier} beside hurdle {n}",
        at: HALFWAY,
        to: "hurdle {n}",
        offset: "[\"{past}\", \"{left}\"]",
        facing: None,
        strength: "1.0",
    });
    let comes = sync(AS_COMES, [at, HALFWAY], Some("{late}"));
    [character("disturber {n}", r#"["come", "jump", "come"]"#).as_str(), hurdle, &before, &beside, &comes]
        .concat()
}

const PAT_KEYS: &[&str] = &["n", "carrier", "position", "facing", "body", "leaves", "ahead"];

fn pat_row(index: usize, disturber: &Disturber) -> Vec<String> {
    let mut row = whom(index, disturber);
    row.extend([quoted(aside_name(disturber.left)), format!("{:.3}", pat_from(disturber.stature).0)]);
    row
}

fn pat_tables() -> String {
    let (at, to) = ("disturber {n}/pat:hit", "carrier {carrier}/wait:patted");
    let behind = relative(&Relative {
        name: "disturber {n} behind carrier {carrier}",
        at,
        to,
        offset: &format!("[\"{{ahead}}\", {:?}]", PAT_FROM.1),
        facing: Some("0.0"),
        strength: HARD,
    });
    let hand = r#"
[[group.end_effector]]
name = "hand of disturber {n}"
at = "disturber {n}/pat:hit"
joint = "right_hand"
target = { character = "carrier {carrier}", joint = "chest", point = [-0.1, 0.1, -0.16], at = "carrier {carrier}/wait:patted" }   # left, up, ahead
"#;
    let pats = sync("disturber {n} pats carrier {carrier}", [at, to], None);
    [character("disturber {n}", r#"["pat", "{leaves}"]"#).as_str(), &behind, &pats, hand].concat()
}
