//! Boxes, and those who hand them on.

use super::text::{
    Group, HARD, Relative, body, carry, character, degrees, group, point, quoted, relative, sync,
};
use crate::geometry::cis;
use crate::relay::Relay;
use crate::relay::acts::{GRASP, PALMS_APART, STATURE, turn_name};
use crate::relay::layout::{Carrier, Layout, Part, apart};
use crate::relay::ways::{wait_name, wait_seconds};

pub(super) fn boxes(layout: &Layout) -> Group {
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
        tables: box_tables(),
    }
}

fn box_tables() -> String {
    let object = r#"
[[group.object]]
name = "box {n}"
size = [0.44, 0.3, 0.3]                     # ahead, up, across: room for the hands of two, one before the other's
position = "{position}"
facing = "{facing}"
"#;
    let begins = r#"
[[group.time]]
name = "box {n} begins"
at = "carrier {by}:start"
seconds = "{begins}"
strength = "hard"
"#;
    let before = relative(&Relative {
        name: "carrier {by} before box {n}",
        at: "carrier {by}/pick up:grasp",
        to: "box {n}",
        offset: "[\"{ahead}\", 0.0]",
        facing: Some("0.0"),
        strength: HARD,
    });
    let has = carry(("carrier {by}", "box {n}"), ("pick up:grasp", "hand over:release"));
    [object, &before, &has, begins].concat()
}

pub(super) fn first(layout: &Layout) -> String {
    let carrier = &layout.carriers[0];
    format!(
        "\n[[character]]\nname = \"carrier 1\"\ntrack = [\"pick up\", \"{}\", \"hand over\", \"rest\"]\n\
         skeleton = \"{}\"\nposition = {}\nfacing = {}\n",
        way(layout, carrier),
        body(carrier.stature),
        point(carrier.start.position),
        degrees(carrier.start.facing)
    )
}

pub(super) fn middle(relay: &Relay, layout: &Layout) -> Group {
    let rows = layout.carriers.iter().enumerate().filter_map(|(n, carrier)| match carrier.part {
        Part::Middle(turned) => Some(taker((layout, n), turned)),
        _ => None,
    });
    Group { keys: TAKER, rows: rows.collect(), tables: taking(relay) }
}

const TAKER: &[&str] = &["n", "box", "comes", "turns", "walks", "position", "facing", "body"];

/// Name of a carrier's walk with the box.
pub(super) fn way<'a>(layout: &'a Layout, carrier: &Carrier) -> &'a str {
    &layout.acts.carries[carrier.walk].name
}

fn taker((layout, n): (&Layout, usize), turned: i32) -> Vec<String> {
    let carrier = &layout.carriers[n];
    vec![
        (n + 1).to_string(),
        (carrier.load + 1).to_string(),
        quoted(if carrier.comes { "come" } else { "wait" }),
        quoted(&turn_name(turned, true)),
        quoted(way(layout, carrier)),
        point(carrier.start.position),
        degrees(carrier.start.facing),
        quoted(&body(carrier.stature)),
    ]
}

const CHANGES: &str = r#"
[group.discrete]
times = [["carrier {n}/{walks}:start", "carrier {n}/{walks}:end"]]
"#;

fn taking(relay: &Relay) -> String {
    let track = r#"["{comes}", "take over", "{turns}", "{walks}", "hand over", "rest"]"#;
    let has = carry(("carrier {n}", "box {box}"), ("take over:grasp", "hand over:release"));
    [character("carrier {n}", track).as_str(), &has, if relay.discrete { CHANGES } else { "" }].concat()
}

pub(super) fn between(layout: &Layout) -> Group {
    let rows = layout.carriers.iter().enumerate().filter_map(|(n, carrier)| {
        let Part::Between(back) = carrier.part else {
            return None;
        };
        let walked = layout.acts.backs[back.walk].name.as_str();
        let mut way = vec!["pick up", way(layout, carrier), "hand over", "turn about", walked];
        let turned = back.facing.map(|degrees| turn_name(degrees, false));
        let waits: Vec<String> = wait_seconds(back.wait).into_iter().map(wait_name).collect();
        way.extend(turned.as_deref());
        way.extend(waits.iter().map(String::as_str));
        way.extend(["take over", "put down", "rest"]);
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
        tables: character("carrier {n}", "\"{track}\"")
            + &carry(("carrier {n}", "box {box}"), ("take over:grasp", "put down:release")),
    }
}

/// After the others in the file: owners of one object stand in the order of time.
pub(super) fn last(relay: &Relay, layout: &Layout) -> String {
    let n = layout.carriers.len() - 1;
    let carrier = &layout.carriers[n];
    let Part::Last(turned) = carrier.part else {
        return String::new();
    };
    let text = group(&Group { keys: TAKER, rows: vec![taker((layout, n), turned)], tables: taking(relay) });
    text.replace("hand over", "put down")
}

/// The moments that a hand-over is for the two.
const TAKES: &str = "carrier {n+1}/take over:grasp";
const GIVES: &str = "carrier {n}/hand over:release";

pub(super) fn hand_overs(layout: &Layout) -> Group {
    let pairs = layout.carriers.windows(2).enumerate();
    let rows = pairs.map(|(n, pair)| {
        vec![(n + 1).to_string(), format!("{:.3}", apart(pair[0].stature, pair[1].stature))]
    });
    Group {
        keys: &["n", "apart"],
        rows: rows.collect(),
        tables: relative(&Relative {
            name: "carrier {n+1} before carrier {n}",
            at: TAKES,
            to: GIVES,
            offset: "[\"{apart}\", 0.0]",
            facing: Some("180.0"),
            strength: HARD,
        }) + &sync("hand-over {n}", [TAKES, GIVES], None),
    }
}

pub(super) fn marks(layout: &Layout) -> Group {
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
"#
        .to_owned(),
    }
}

pub(super) fn end(layout: &Layout) -> String {
    let n = layout.carriers.len();
    let carrier = &layout.carriers[n - 1];
    format!(
        "\n[[pin]]\nname = \"the end\"\nat = \"carrier {n}/put down:release\"\nposition = {}\nstrength = 1.0\n",
        point(carrier.give.position)
    )
}

/// Drags the end on, straight ahead, half a metre at a time.
pub(super) fn drag(layout: &Layout, metres: f64) -> String {
    let last = layout.carriers[layout.carriers.len() - 1].give;
    let to = point(last.position + cis(last.facing) * metres);
    let steps = format!("{:.0}", (metres / DRAG_STEP).ceil());
    format!(
        "\n# The end is dragged on by {metres} m.\n\n[[drag]]\nhandle = \"the end\"\nto = {to}\nsteps = {steps}\n"
    )
}

/// Metres by which the end is dragged from one update to the next.
const DRAG_STEP: f64 = 0.5;
