//! The scene file of a relay: what people read, edit and compare.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::acts::{Act, GRASP, PALMS_APART, Place, STATURE, turn};
use super::disturbers::{ASIDE_AT, BESIDE, Disturber, aside, jump, pat, pat_from};
use super::layout::{Carrier, Layout, Part, apart, disturbed, statures};
use super::{Along, Disturbance, Relay};
use crate::geometry::{c64, cis, wrap};

/// A group: its columns, a row each, and the tables below.
struct Group {
    keys: &'static [&'static str],
    rows: Vec<Vec<String>>,
    tables: &'static str,
}

/// The whole file.
pub fn scene(relay: &Relay, layout: &Layout, command: &str) -> String {
    let mut text = head(relay, layout, command);
    text += &clips(relay, layout);
    if relay.discrete {
        text += "\n[discrete]                                  # steps come and go where boxes are carried, and nowhere else\n";
        text += "kinds = [\"duplicate\", \"delete\"]\n";
    }
    text += "\n# The boxes, and who picks each of them up: palms 0.08 m behind its middle, which leaves room for the next.\n";
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
    let mut all: Vec<&Act> = vec![&acts.pick_up, &acts.carry, &acts.hand_over, &acts.put_down, &acts.rest];
    if has(|part| matches!(part, Part::Middle(_) | Part::Last(_))) {
        all.extend(
            layout.carriers.iter().any(|carrier| is_taker(carrier) && !carrier.comes).then_some(&acts.wait),
        );
    }
    let jumps = disturbed(layout, Disturbance::Jump);
    let come = jumps || layout.carriers.iter().any(|carrier| carrier.comes);
    all.extend(come.then_some(&acts.come));
    all.push(&acts.take_over);
    all.extend(between.then_some([&acts.about, &acts.back]).into_iter().flatten());
    let mut made: Vec<Act> = turns(layout, true).into_iter().map(|degrees| turn(degrees, true)).collect();
    made.extend(turns(layout, false).into_iter().map(|degrees| turn(degrees, false)));
    made.extend(disturbing_clips(layout));
    let mut text = "\n[clips]\n".to_owned();
    for act in all.into_iter().chain(&made) {
        let _ = writeln!(text, "{} = {}", key(&act.name), act.declaration);
    }
    for seconds in waits(layout) {
        let _ = writeln!(text, "\"wait {seconds}\" = {{ builtin = \"idle\", seconds = {seconds} }}");
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

fn waits(layout: &Layout) -> BTreeSet<String> {
    let waits = layout.carriers.iter().filter_map(|carrier| match carrier.part {
        Part::Between(back) => Some(format!("{:.1}", back.wait)),
        _ => None,
    });
    waits.collect()
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

fn boxes(layout: &Layout) -> Group {
    let rows = layout.starters.iter().zip(&layout.beginnings).enumerate().map(|(load, (by, beginning))| {
        let carrier = &layout.carriers[*by];
        let behind = GRASP * carrier.stature / STATURE + 0.5 * PALMS_APART;
        let position = carrier.take.position + cis(carrier.give.facing) * behind;
        vec![
            (load + 1).to_string(),
            (by + 1).to_string(),
            point(position),
            degrees(carrier.give.facing),
            format!("{:.3}", -behind),
            format!("{beginning:.2}"),
        ]
    });
    Group {
        keys: &["n", "by", "position", "facing", "ahead", "begins"],
        rows: rows.collect(),
        tables: r#"
[[group.object]]
name = "box {n}"
size = [0.4, 0.3, 0.3]                      # ahead, up, across: room for the hands of two, one behind the other's
position = "{position}"
facing = "{facing}"

[[group.relative]]
name = "carrier {by} before box {n}"
at = "carrier {by}/pick up:grasp"
to = "box {n}"
offset = ["{ahead}", 0.0]
facing = 0.0
strength = "hard"

[[group.carry]]
name = "carrier {by} has box {n}"
object = "box {n}"
by = ["carrier {by}"]
during = ["carrier {by}/pick up:grasp", "carrier {by}/hand over:release"]

[[group.time]]
name = "box {n} begins"
at = "carrier {by}:start"
seconds = "{begins}"
strength = "hard"
"#,
    }
}

fn first(layout: &Layout) -> String {
    let carrier = &layout.carriers[0];
    format!(
        "\n[[character]]\nname = \"carrier 1\"\ntrack = [\"pick up\", \"carry\", \"hand over\", \"rest\"]\n\
         skeleton = \"{}\"\nposition = {}\nfacing = {}\n",
        body(carrier.stature),
        point(carrier.start.position),
        degrees(carrier.start.facing)
    )
}

fn middle(relay: &Relay, layout: &Layout) -> Group {
    let rows = layout.carriers.iter().enumerate().filter_map(|(n, carrier)| match carrier.part {
        Part::Middle(turned) => Some(taker(n, carrier, turned)),
        _ => None,
    });
    Group {
        keys: TAKER,
        rows: rows.collect(),
        tables: if relay.discrete { MIDDLE_THAT_CHANGES } else { MIDDLE },
    }
}

const TAKER: &[&str] = &["n", "box", "comes", "turns", "position", "facing", "body"];

fn taker(n: usize, carrier: &Carrier, turned: i32) -> Vec<String> {
    vec![
        (n + 1).to_string(),
        (carrier.load + 1).to_string(),
        quoted(if carrier.comes { "come" } else { "wait" }),
        quoted(&turn(turned, true).name),
        point(carrier.start.position),
        degrees(carrier.start.facing),
        quoted(&body(carrier.stature)),
    ]
}

const MIDDLE: &str = r#"
[[group.character]]
name = "carrier {n}"
track = ["{comes}", "take over", "{turns}", "carry", "hand over", "rest"]
skeleton = "{body}"
position = "{position}"
facing = "{facing}"

[[group.carry]]
name = "carrier {n} has box {box}"
object = "box {box}"
by = ["carrier {n}"]
during = ["carrier {n}/take over:grasp", "carrier {n}/hand over:release"]
"#;

const MIDDLE_THAT_CHANGES: &str = r#"
[[group.character]]
name = "carrier {n}"
track = ["{comes}", "take over", "{turns}", "carry", "hand over", "rest"]
skeleton = "{body}"
position = "{position}"
facing = "{facing}"

[[group.carry]]
name = "carrier {n} has box {box}"
object = "box {box}"
by = ["carrier {n}"]
during = ["carrier {n}/take over:grasp", "carrier {n}/hand over:release"]

[group.discrete]
times = [["carrier {n}/carry:start", "carrier {n}/carry:end"]]
"#;

fn between(layout: &Layout) -> Group {
    let rows = layout.carriers.iter().enumerate().filter_map(|(n, carrier)| {
        let Part::Between(back) = carrier.part else {
            return None;
        };
        let mut way = vec!["pick up", "carry", "hand over", "turn about", "walk back"];
        let (turned, wait) =
            (back.facing.map(|degrees| turn(degrees, false).name), format!("wait {:.1}", back.wait));
        way.extend(turned.as_deref());
        way.extend([wait.as_str(), "take over", "put down", "rest"]);
        let track: Vec<String> = way.into_iter().map(quoted).collect();
        Some(vec![
            (n + 1).to_string(),
            carrier.load.to_string(),
            point(carrier.start.position),
            degrees(carrier.start.facing),
            quoted(&body(carrier.stature)),
            format!("[{}]", track.join(", ")),
        ])
    });
    Group {
        keys: &["n", "box", "position", "facing", "body", "track"],
        rows: rows.collect(),
        tables: r#"
[[group.character]]
name = "carrier {n}"
track = "{track}"
skeleton = "{body}"
position = "{position}"
facing = "{facing}"

[[group.carry]]
name = "carrier {n} has box {box}"
object = "box {box}"
by = ["carrier {n}"]
during = ["carrier {n}/take over:grasp", "carrier {n}/put down:release"]
"#,
    }
}

/// After the others in the file: owners of one object stand in the order of time.
fn last(relay: &Relay, layout: &Layout) -> String {
    let n = layout.carriers.len() - 1;
    let carrier = &layout.carriers[n];
    let Part::Last(turned) = carrier.part else {
        return String::new();
    };
    let text = group(&Group {
        keys: TAKER,
        rows: vec![taker(n, carrier, turned)],
        tables: if relay.discrete { MIDDLE_THAT_CHANGES } else { MIDDLE },
    });
    text.replace("hand over", "put down")
}

fn hand_overs(layout: &Layout) -> Group {
    let pairs = layout.carriers.windows(2).enumerate();
    let rows = pairs.map(|(n, pair)| {
        vec![(n + 1).to_string(), format!("{:.3}", apart(pair[0].stature, pair[1].stature))]
    });
    Group {
        keys: &["n", "apart"],
        rows: rows.collect(),
        tables: r#"
[[group.relative]]
name = "carrier {n+1} before carrier {n}"
at = "carrier {n+1}/take over:grasp"
to = "carrier {n}/hand over:release"
offset = ["{apart}", 0.0]
facing = 180.0
strength = "hard"

[[group.sync]]
name = "hand-over {n}"
moments = ["carrier {n+1}/take over:grasp", "carrier {n}/hand over:release"]
strength = "hard"
"#,
    }
}

fn marks(layout: &Layout) -> Group {
    let givers = layout.carriers[..layout.carriers.len() - 1].iter().enumerate();
    let rows = givers
        .filter(|(n, _)| n % 2 == 1)
        .map(|(n, carrier)| vec![(n + 1).to_string(), point(carrier.give.position)]);
    Group {
        keys: &["n", "position"],
        rows: rows.collect(),
        tables: r#"
[[group.pin]]
name = "mark {n}"
at = "carrier {n}/hand over:release"
position = "{position}"
strength = 1.0
"#,
    }
}

fn end(layout: &Layout) -> String {
    let n = layout.carriers.len();
    let carrier = &layout.carriers[n - 1];
    format!(
        "\n[[pin]]\nname = \"the end\"\nat = \"carrier {n}/put down:release\"\nposition = {}\nstrength = 1.0\n",
        point(carrier.give.position)
    )
}

fn disturbing(relay: &Relay, layout: &Layout) -> String {
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

const ASIDE_KEYS: &[&str] = &["n", "carrier", "position", "facing", "body", "steps", "late", "left"];

fn aside_row(index: usize, disturber: &Disturber) -> Vec<String> {
    let mut row = whom(index, disturber);
    let side = if disturber.left { ASIDE_AT.1 } else { -ASIDE_AT.1 };
    row.extend([
        quoted(&aside(!disturber.left).name),
        format!("{:.2}", disturber.late),
        format!("{side:.1}"),
    ]);
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
    row.extend([quoted(&aside(disturber.left).name), format!("{:.3}", pat_from(disturber.stature).0)]);
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

/// The text of a group, its columns aligned.
fn group(group: &Group) -> String {
    let widths: Vec<usize> = (0..group.keys.len())
        .map(|column| group.rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0))
        .collect();
    let keys: Vec<String> = group.keys.iter().map(|key| format!("\"{key}\"")).collect();
    let mut text = format!("\n[[group]]\nkeys = [{}]\nrows = [\n", keys.join(", "));
    for row in &group.rows {
        let cells: Vec<String> =
            row.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}", width = *width)).collect();
        let _ = writeln!(text, "    [{}],", cells.join(", "));
    }
    text + "]\n" + group.tables
}

/// Name of a body.
fn body(stature: f64) -> String {
    format!("body {:.0}", 100.0 * stature)
}

fn quoted(text: &str) -> String {
    format!("\"{text}\"")
}

/// A key, in quotes where TOML asks for them.
fn key(name: &str) -> String {
    if name.contains(' ') { quoted(name) } else { name.to_owned() }
}

/// To the millimetre: what is finer differs from machine to machine.
fn point(position: c64) -> String {
    format!("[{}, {}]", metres(position.re), metres(position.im))
}

fn metres(value: f64) -> String {
    let text = format!("{value:.3}");
    if text == "-0.000" { "0.000".to_owned() } else { text }
}

/// To the tenth of a degree.
fn degrees(angle: f64) -> String {
    let text = format!("{:.1}", wrap(angle).to_degrees());
    match text.as_str() {
        "-0.0" => "0.0".to_owned(),
        "-180.0" => "180.0".to_owned(),
        _ => text,
    }
}

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

    #[test]
    fn numbers_have_one_zero() {
        assert_eq!((metres(-0.0001), metres(-0.0006)), ("0.000".to_owned(), "-0.001".to_owned()));
        let turned = [-0.0001, std::f64::consts::PI, -std::f64::consts::PI].map(degrees);
        assert_eq!(turned, ["0.0", "180.0", "180.0"]);
    }
}
