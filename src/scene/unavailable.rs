//! Tables of stages that are not available yet: read for what they say, then refused by name (`refuse.rs`).

use crate::scene::report::At;
use crate::scene::tree::table;
use crate::scene::values::{Anything, OneOrPair, Pair, Strength, Triple};

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
