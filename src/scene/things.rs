//! What a scene file says of objects, and of hands and feet.

use crate::scene::report::At;
use crate::scene::tree::table;
use crate::scene::values::{OneOrPair, Pair, Plants, Strength, Tables, Triple, Turn};

table! {
    /// A thing in the scene.
    Object {
        required {
            /// Unique among characters and objects, without `/`, `:` and `#`.
            name: String,
            /// Ahead, up, across, metres.
            size: Triple<f64>,
        }
        optional {
            /// Middle of its base, metres `[x, -z]`.
            position: Pair<f64>,
            /// Of its base above the ground, metres (0 if left out).
            height: f64,
            /// Where it points, degrees counter-clockwise from +x seen from above (0 if left out).
            facing: f64,
            /// Where it is when, for a thing that moves by itself, in place of a position; rising in time. In between it
            /// moves straight and turns the shorter way.
            keys: Tables<ObjectKey>,
        }
    }
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
            /// Of its base above the ground, metres; left out: as at the key before, at first the object's.
            height: f64,
            /// Degrees counter-clockwise from +x seen from above; left out: as at the key before, at first the object's.
            facing: f64,
        }
    }
}

table! {
    /// Who has an object when; before and after it stays where it is.
    Carry {
        required {
            /// The object.
            object: String,
            /// One or two characters, between whose hands it is.
            by: Vec<At<String>>,
            /// First and last moment, of one of them.
            during: Pair<String>,
        }
        optional {
            /// For reports.
            name: String,
            /// What is carried is between the hands: "hard" is all that can be said.
            strength: Strength,
        }
    }
}

table! {
    /// Where a hand or foot is: met as far as the body reaches.
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
            /// How the joint is turned: "rest", as before the edit against what it reaches; or degrees about the x, y and z
            /// axis of what it reaches, in this order, from its pose in the skeleton. Left out: not held.
            orientation: Turn,
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
            /// Which joint, by role or by the file's name.
            joint: String,
            /// The moment (or pair of moments, with `during`) of `character`; left out: at the same time.
            at: OneOrPair,
            /// In the world, metres `[x, y, z]`.
            position: Triple<f64>,
            /// The object.
            object: String,
            /// In the object's axes, metres ahead, up, to the right, from the middle of its base; or from the joint, in the
            /// joint's axes (0 if left out): a place on the body.
            point: Triple<f64>,
        }
    }
}

table! {
    /// Feet and hands of the whole body.
    FullBody {
        required {}
        optional {
            /// Whether the stage runs (true if left out).
            enabled: bool,
            /// Whether planted feet keep the small drift of their capture ("as-captured", if left out), stand still as long as no
            /// joint turns by 5° for it ("pinned"), or stand still all along ("whole").
            plants: Plants,
        }
    }
}
