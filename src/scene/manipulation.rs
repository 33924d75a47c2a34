//! What a scene file says of manipulation: handles that are pulled, steps that come and go.

use crate::scene::report::At;
use crate::scene::tree::table;
use crate::scene::values::{ChangeKind, Evaluator, Pair};

table! {
    /// A handle that is pulled in equal steps, one update each.
    Drag {
        required {
            /// A moment, whose pin is pulled (one at rest is added where there is none), or a constraint by its name.
            handle: String,
        }
        optional {
            /// Ground point where a position goes, metres `[x, -z]`.
            to: Pair<f64>,
            /// Heading where a facing goes, degrees.
            facing: f64,
            /// Where a time, a duration or the offset of a sync goes.
            seconds: f64,
            /// Where a relative place goes, metres ahead and to the left.
            offset: Pair<f64>,
            /// How many equal steps (20 if left out).
            #[schemars(range(min = 1, max = 100_000))]
            steps: u32,
        }
    }
}

table! {
    /// Insertion and removal of steps where bending would stretch a stride.
    Discrete {
        required {}
        optional {
            /// Whether the stage runs (true if left out).
            enabled: bool,
            /// Only these characters.
            characters: Vec<At<String>>,
            /// Only these kinds of changes.
            kinds: Vec<At<ChangeKind>>,
            /// Only within these intervals, each from a moment to a later one of the same character.
            times: Vec<At<Pair<String>>>,
            /// Only where somebody is within one of these rectangles before the edit: opposite corners, metres `[x, -z]`.
            regions: Vec<At<Pair<Pair<f64>>>>,
            /// How candidates are weighed ("exact" if left out).
            evaluator: Evaluator,
            /// Whether changes go on after the last drag until none is worth it (true if left out).
            settle: bool,
            /// Whether the result depends on the motion at rest and where the handles are only, not on the way they took; slower
            /// (false if left out).
            reversible: bool,
        }
    }
}
