//! Tables of stages that are not available yet: read for what they say, then refused by name (`refuse.rs`).

use crate::scene::report::At;
use crate::scene::tree::table;
use crate::scene::values::{Anything, Pair};

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
