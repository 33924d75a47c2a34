//! What a scene file says of physical plausibility.

use schemars::JsonSchema;
use toml::de::DeValue;

use crate::scene::report::{At, Report};
use crate::scene::tree::{Node, Read, table};
use crate::scene::values::{Alternative, Word, WordOr, not_a_choice, words};

table! {
    /// Physical plausibility of the result: bodies lean as their ways ask for, flights fall as bodies do.
    Physics {
        required {}
        optional {
            /// Whether the touch-up runs (true if left out).
            touch_up: bool,
            /// Only these characters.
            characters: Vec<At<String>>,
            /// Where zero moment points are to be: "carried", where the motion before the edit had them (if left out in mode
            /// "production"), or "hull", in the polygon of support.
            target: TargetWord,
            /// Polygons are made smaller by this share of the stature; of target "hull" only (0.0125 if left out; 0 in mode "paper").
            #[schemars(range(min = 0, max = 0.1))]
            margin: f64,
            /// What turns in which order: "level" (if left out), "uphill", "published", or a list of steps.
            schedule: WordOr<ScheduleWord, Vec<At<Step>>>,
            /// The schedule is gone through this often at most (3 if left out; 1 for "published" and in mode "paper").
            #[schemars(range(min = 1, max = 1000))]
            rounds: u32,
            /// A mean distance that is good enough, metres (if left out that of the motion before the edit; 0 in mode "paper").
            #[schemars(range(min = 0, max = 10))]
            tolerance: f64,
            /// Whether turns bring the point exactly to its place (false if left out).
            two_axis: bool,
            /// Whether flights are made to fall as bodies do (true if left out).
            flight: bool,
            /// Whose shares of the segments ("winter75" if left out).
            table: TableWord,
            /// Of everybody, kg (75 if left out); motions do not depend on it.
            #[schemars(range(max = 1_000_000))]
            mass: f64,
        }
    }
}

table! {
    /// One step of a touch-up.
    Step {
        required {
            /// What turns, all by one angle: "lower", "upper", "arms", or a joint by its role with all that hangs on it.
            turns: Vec<At<String>>,
        }
        optional {
            /// What is carried along without being turned.
            keeps: Vec<At<String>>,
            /// How much of the turn is done, above 0 and at most 1 (0.5 if left out).
            #[schemars(range(max = 1))]
            share: f64,
            /// Width of the kernel that smooths it, frames at 30 a second (20 if left out).
            #[schemars(range(max = 300))]
            width: f64,
            /// Turns are no larger than this, degrees (28 if left out).
            #[schemars(range(max = 90))]
            largest_turn: f64,
        }
    }
}

words! {
    /// Where zero moment points are to be.
    TargetWord {
        /// Where the motion before the edit had them.
        Carried = "carried",
        /// In the polygon of support.
        Hull = "hull",
    }
}

words! {
    /// What turns in which order.
    ScheduleWord {
        /// Lower body, upper body, arms.
        Level = "level",
        /// Upper body, lower body, arms.
        Uphill = "uphill",
        /// Five of the lower body, five of the upper, two of the arms.
        Published = "published",
    }
}

words! {
    /// Shares of the segments of a body.
    TableWord {
        /// Dempster's by Winter.
        Winter75 = "winter75",
        /// Xiao et al. as printed.
        Xiao2005 = "xiao2005",
    }
}

impl Alternative for Vec<At<Step>> {
    const NOUN: &'static str = "a list of steps";

    fn is_meant(value: &DeValue<'_>) -> bool {
        value.is_array()
    }
}
