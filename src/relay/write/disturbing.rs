//! Those who get in the way.

use std::fmt::Write;

use super::text::{Group, body, degrees, group, point, quoted};
use crate::geometry::c64;
use crate::relay::acts::Place;
use crate::relay::disturbers::{ASIDE_AT, BESIDE, Disturber, aside_name, pat_from};
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
            Disturbance::Aside => aside_row(*index, disturber),
            Disturbance::Jump => jump_row(*index, disturber),
            Disturbance::Pat => pat_row(*index, disturber),
        });
        let (keys, tables) = match how {
            Disturbance::Aside => (ASIDE_KEYS, ASIDE_TABLES),
            Disturbance::Jump => (JUMP_KEYS, JUMP_TABLES),
            Disturbance::Pat => (PAT_KEYS, PAT_TABLES),
        };
        text += &group(&Group { keys, rows: rows.collect(), tables: tables.to_owned() });
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

const ASIDE_KEYS: &[&str] = &["n", "carrier", "position", "facing", "body", "steps", "late", "left"];

fn aside_row(index: usize, disturber: &Disturber) -> Vec<String> {
    let mut row = whom(index, disturber);
    let side = if disturber.left { ASIDE_AT.1 } else { -ASIDE_AT.1 };
    row.extend([quoted(aside_name(!disturber.left)), format!("{:.2}", disturber.late), format!("{side:.1}")]);
    row
}

const ASIDE_TABLES: &str = r#"
[[group.character]]
name = "disturber {n}"
track = ["{steps}"]
skeleton = "{body}"
position = "{position}"
facing = "{facing}"

[[group.relative]]
name = "disturber {n} before carrier {carrier}"
at = "disturber {n}/{steps}:aside"
to = "carrier {carrier}/carry:halfway"
offset = [1.1, "{left}"]
facing = 180.0
strength = 1.0

[[group.sync]]
name = "disturber {n} as carrier {carrier} comes"
moments = ["disturber {n}/{steps}:aside", "carrier {carrier}/carry:halfway"]
offset = "{late}"
strength = "hard"
"#;

const JUMP_KEYS: &[&str] =
    &["n", "carrier", "position", "facing", "body", "hurdle", "heading", "late", "left"];

fn jump_row(index: usize, disturber: &Disturber) -> Vec<String> {
    let mut row = whom(index, disturber);
    let hurdle = disturber.hurdle.unwrap_or(Place { position: c64::new(0.0, 0.0), facing: 0.0 });
    let side = if disturber.left { BESIDE.1 } else { -BESIDE.1 };
    row.extend([
        point(hurdle.position),
        degrees(hurdle.facing),
        format!("{:.2}", disturber.late),
        format!("{side:.1}"),
    ]);
    row
}

const JUMP_TABLES: &str = r#"
[[group.character]]
name = "disturber {n}"
track = ["come", "jump", "come"]
skeleton = "{body}"
position = "{position}"
facing = "{facing}"

[[group.object]]
name = "hurdle {n}"
size = [0.08, 0.3, 1.0]
position = "{hurdle}"
facing = "{heading}"

[[group.relative]]
name = "disturber {n} before its hurdle"
at = "disturber {n}/jump:takeoff"
to = "hurdle {n}"
offset = [-0.35, 0.0]                       # of the pelvis, which is ahead of the feet: the flight is half way over it
facing = 0.0
strength = "hard"

[[group.relative]]
name = "carrier {carrier} beside hurdle {n}"
at = "carrier {carrier}/carry:halfway"
to = "hurdle {n}"
offset = [0.3, "{left}"]
strength = 1.0

[[group.sync]]
name = "disturber {n} as carrier {carrier} comes"
moments = ["disturber {n}/jump:takeoff", "carrier {carrier}/carry:halfway"]
offset = "{late}"
strength = "hard"
"#;

const PAT_KEYS: &[&str] = &["n", "carrier", "position", "facing", "body", "leaves", "ahead"];

fn pat_row(index: usize, disturber: &Disturber) -> Vec<String> {
    let mut row = whom(index, disturber);
    row.extend([quoted(aside_name(disturber.left)), format!("{:.3}", pat_from(disturber.stature).0)]);
    row
}

const PAT_TABLES: &str = r#"
[[group.character]]
name = "disturber {n}"
track = ["pat", "{leaves}"]
skeleton = "{body}"
position = "{position}"
facing = "{facing}"

[[group.relative]]
name = "disturber {n} behind carrier {carrier}"
at = "disturber {n}/pat:hit"
to = "carrier {carrier}/wait:patted"
offset = ["{ahead}", 0.1]
facing = 0.0
strength = "hard"

[[group.sync]]
name = "disturber {n} pats carrier {carrier}"
moments = ["disturber {n}/pat:hit", "carrier {carrier}/wait:patted"]
strength = "hard"

[[group.end_effector]]
name = "hand of disturber {n}"
at = "disturber {n}/pat:hit"
joint = "right_hand"
target = { character = "carrier {carrier}", joint = "chest", point = [-0.1, 0.1, -0.16], at = "carrier {carrier}/wait:patted" }   # left, up, ahead
"#;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relay::disturbers::{PAT_FROM, TAKEOFF};

    #[test]
    fn written_offsets_are_those_of_the_layout() {
        assert!(ASIDE_TABLES.contains(&format!("offset = [{}, ", ASIDE_AT.0)));
        assert!(JUMP_TABLES.contains(&format!("offset = [-{TAKEOFF}, 0.0]")));
        assert!(JUMP_TABLES.contains(&format!("offset = [{}, ", BESIDE.0)));
        assert!(PAT_TABLES.contains(&format!("offset = [\"{{ahead}}\", {}]", PAT_FROM.1)));
    }
}
