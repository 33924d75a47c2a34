//! Why an edit has no answer.

use cotillion_solvers::{BoundsError, KktError};

use crate::edit::clash::Miss;

/// A constraint as its author knows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// Its name.
    pub name: String,
    /// Line of the scene file, from 1; 0 where there is none.
    pub line: u32,
}

impl std::fmt::Display for Named {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.line {
            0 => write!(f, "\"{}\"", self.name),
            line => write!(f, "\"{}\" (line {line})", self.name),
        }
    }
}

/// Why an edit has no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// Hard constraints on places or facings contradict each other.
    #[error("{} {} by {miss}", list(.constraints), clash(.constraints))]
    Conflict {
        /// Which, in the order of the scene.
        constraints: Vec<Named>,
        /// By how much.
        miss: Miss,
    },
    /// Hard constraints on times contradict each other.
    #[error("{} {} by {miss:.6} s", list(.constraints), clash(.constraints))]
    TimeConflict {
        /// Which, in the order of the scene.
        constraints: Vec<Named>,
        /// By how much, seconds.
        miss: f64,
    },
    /// Hard times cannot be met with the bounds on time steps.
    #[error(
        "{} cannot be met with time steps between {min_step} and {max_step} of the original: {deficit:.6} s are missing",
        list(.constraints)
    )]
    InfeasibleTimes {
        /// The constraints on the cycle, in the order of the scene.
        constraints: Vec<Named>,
        /// How many seconds are missing.
        deficit: f64,
        /// Smallest step, as a multiple of the rest step.
        min_step: f64,
        /// Largest step, as a multiple of the rest step.
        max_step: f64,
    },
    /// Without bounds, a time track can run backwards; then no motion shows it.
    #[error(
        "the time of {character} runs backwards at frame {frame} of its track; bound it with [warp] min_step"
    )]
    BackwardTime {
        /// Whose.
        character: String,
        /// Where it turns.
        frame: usize,
    },
    /// Somebody grasps an object that another carry still has.
    #[error(
        "{first} and {second} overlap by {seconds:.6} s: an object is carried by one [[carry]] at a time"
    )]
    CarriesOverlap {
        /// The one that has it.
        first: Named,
        /// The one that begins too early.
        second: Named,
        /// By how much.
        seconds: f64,
    },
    /// Somebody grasps an object while they carry another.
    #[error("{first} and {second} overlap by {seconds:.6} s: {character} carries one thing at a time")]
    HandsTaken {
        /// Whose hands.
        character: String,
        /// The carry that comes first in the scene.
        first: Named,
        /// The other.
        second: Named,
        /// By how much.
        seconds: f64,
    },
    /// A place relative to an object that whoever is to be there carries just then.
    #[error("{constraint} holds somebody relative to what they carry just then, by {carry}")]
    OwnLoad {
        /// Which.
        constraint: Named,
        /// The carry.
        carry: Named,
    },
    /// Places relative to carried objects change where these are grasped, and that changes the places, without end.
    #[error("{}: no place relative to what is carried stays, as it moves those who carry", list(.0))]
    Unsettled(Vec<Named>),
    /// The bounded time problem could not be solved.
    #[error("the time steps of {characters} could not be kept in bounds")]
    Bounds {
        /// The characters in it.
        characters: String,
        /// What the solver says.
        #[source]
        source: BoundsError,
    },
    /// A target that is not a number.
    #[error("the target of {0} is not a finite number")]
    NotFinite(Named),
    /// A target of another kind than the constraint.
    #[error("{0} has no {1} that could be moved")]
    NoSuchTarget(Named, &'static str),
    /// The linear system could not be solved.
    #[error("the {system} system of {characters} could not be solved")]
    Solver {
        /// `shape`, `scale` or `time`.
        system: &'static str,
        /// The characters in it.
        characters: String,
        /// What the solver says.
        #[source]
        source: KktError,
    },
}

fn list(constraints: &[Named]) -> String {
    let names = constraints.iter().map(Named::to_string).collect::<Vec<_>>().join(" and ");
    format!("{} {names}", if constraints.len() == 1 { "constraint" } else { "constraints" })
}

/// What constraints do that cannot all hold; one of them may hold several moments.
fn clash(constraints: &[Named]) -> &'static str {
    if constraints.len() == 1 {
        "contradicts itself: its moments miss"
    } else {
        "contradict each other: they miss"
    }
}
