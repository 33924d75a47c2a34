//! Tables of stages that are not available yet: read for what they say, then refused by name (`refuse.rs`).

use crate::scene::tree::table;

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
