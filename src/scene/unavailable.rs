//! Tables of stages that are not available yet: read for what they say, then refused by name.

use crate::scene::raw::{Object, Scene};
use crate::scene::report::{At, Place, Report};
use crate::scene::tree::{Field, table};
use crate::scene::values::{Anything, OneOrPair, Pair, Strength, Tables, Triple};

/// Reports every stage that `scene` asks for and that is not available yet.
pub fn refuse(scene: &Scene, report: &mut Report) {
    refuse_tables(&scene.carry, "[[carry]]", report);
    refuse_tables(&scene.end_effector, "[[end_effector]]", report);
    refuse_tables(&scene.drag, "[[drag]]", report);
    let objects = scene.object.value().map_or(&[][..], |tables| &tables.0);
    for object in objects {
        refuse_keys(&object.value, report);
    }
    if let Some(discrete) = scene.discrete.given()
        && discrete.value.enabled.value() != Some(&false)
    {
        let help = "remove the table, or set enabled = false";
        refuse_one(&discrete.place, "[discrete]", help, report);
    }
    if let Some(physics) = scene.physics.given()
        && physics.value.touch_up.value() != Some(&false)
    {
        let help = "remove the table, or set touch_up = false";
        refuse_one(&physics.place, "[physics]", help, report);
    }
    if let Some(full_body) = scene.full_body.given()
        && (full_body.value.enabled.value() != Some(&false) || !full_body.value.plants.is_absent())
    {
        let help = "remove the table, or set enabled = false and leave \"plants\" out";
        refuse_one(&full_body.place, "[full_body]", help, report);
    }
}

fn refuse_tables<T>(tables: &Field<Tables<T>>, what: &str, report: &mut Report) {
    let Some(Tables(tables)) = tables.value() else {
        return;
    };
    if let Some(first) = tables.first() {
        let help = match tables.len() {
            1 => "remove this table".to_owned(),
            count => format!("remove all {count} tables of this kind"),
        };
        refuse_one(&first.place, what, &help, report);
    }
}

fn refuse_keys(object: &Object, report: &mut Report) {
    if let Some(keys) = object.keys.given() {
        let help = "remove \"keys\" and give the object one \"position\"";
        refuse_one(&keys.place, "an object that moves by \"keys\"", help, report);
    }
}

fn refuse_one(place: &Place, what: &str, help: &str, report: &mut Report) {
    report.fault(place, format!("{what} is not available yet"), help);
}

table! {
    /// Where an object is at one time.
    ObjectKey {
        required {
            /// Scene time.
            seconds: f64,
            /// Middle of its base, metres `[x, -z]`.
            position: Pair<f64>,
        }
        optional {
            /// Of its base above the ground, metres (0 if left out).
            height: f64,
            /// Degrees counter-clockwise from +x seen from above.
            facing: f64,
        }
    }
}

table! {
    /// Who has an object when; before and after it stays where it is. Not available yet.
    Carry {
        required {
            /// The object.
            object: String,
            /// One or two characters, between whose hands it is.
            by: Vec<At<String>>,
            /// First and last moment.
            during: Pair<String>,
        }
        optional {
            /// For reports and drags.
            name: String,
            /// "hard", or a weight; left out: soft with the default weight.
            strength: Strength,
        }
    }
}

table! {
    /// Where a hand or foot is. Not available yet.
    EndEffector {
        required {
            /// By role (`left_hand`, `right_foot`, `pelvis`, …) or by the file's name.
            joint: String,
            /// What it reaches.
            target: Target,
        }
        optional {
            /// For reports.
            name: String,
            /// The moment.
            at: String,
            /// An interval in place of a moment: its first and last moment, of one character.
            during: Pair<String>,
        }
    }
}

table! {
    /// What a hand or foot reaches: a joint of somebody, a point of the world, or a point of an object.
    Target {
        required {}
        optional {
            /// Whose joint.
            character: String,
            /// Which joint.
            joint: String,
            /// When, if not at the same time.
            at: OneOrPair,
            /// In the world, metres `[x, y, z]`.
            position: Triple<f64>,
            /// The object.
            object: String,
            /// In the object's axes, metres.
            point: Triple<f64>,
        }
    }
}

table! {
    /// A handle that is pulled in small steps. Not available yet.
    Drag {
        required {
            /// A moment, or a constraint by its name.
            handle: String,
        }
        optional {
            /// Ground point where a position goes, metres `[x, -z]`.
            to: Pair<f64>,
            /// Heading where a facing goes, degrees.
            facing: f64,
            /// Where a time or a duration goes.
            seconds: f64,
            /// Where a relative place goes, metres ahead and to the left.
            offset: Pair<f64>,
            /// How many equal steps.
            #[schemars(range(min = 1))]
            steps: u32,
        }
    }
}

table! {
    /// Insertion and removal of steps where bending would stretch a stride. Not available yet.
    Discrete {
        required {}
        optional {
            /// Whether the stage runs.
            enabled: bool,
            /// Only these characters.
            characters: Vec<At<String>>,
            /// Only these kinds of edits.
            kinds: Vec<At<String>>,
            /// Only these times.
            times: Anything,
            /// Only these regions.
            regions: Anything,
        }
    }
}

table! {
    /// Physical plausibility of the result. Not available yet.
    Physics {
        required {}
        optional {
            /// Whether the touch-up runs.
            touch_up: bool,
        }
    }
}

table! {
    /// Feet and hands of the whole body. Not available yet.
    FullBody {
        required {}
        optional {
            /// Whether the stage runs.
            enabled: bool,
            /// Where feet are planted.
            plants: Anything,
        }
    }
}
