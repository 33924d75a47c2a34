//! What the user should know about an edit that succeeded.

use crate::edit::error::Named;

/// What the user should know about an edit that succeeded.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EditNote {
    /// Other hard constraints imply this one, or part of it.
    Redundant(Named),
    /// A stationary stretch could not stay rigid: hard constraints pull it apart.
    Released {
        /// Whose.
        character: String,
        /// First and last working frame of the stretch.
        frames: (usize, usize),
    },
    /// The path turned over, and the facing was interpolated (or could not be).
    Flip {
        /// Whose.
        character: String,
        /// First and last working frame.
        frames: (usize, usize),
        /// Whether the facing was interpolated.
        repaired: bool,
    },
    /// Some time steps stand at their bounds.
    StepsAtBound {
        /// How many.
        steps: usize,
    },
}

impl std::fmt::Display for EditNote {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Redundant(named) => {
                write!(f, "{named} says in part what other hard constraints say already")
            }
            Self::Released { character, frames: (first, last) } => {
                write!(
                    f,
                    "{character} stands at frames {first}–{last}, but hard constraints pull this stretch apart"
                )
            }
            Self::Flip { character, frames: (first, last), repaired: true } => {
                write!(
                    f,
                    "the path of {character} folds back at frames {first}–{last}; the facing passes over it"
                )
            }
            Self::Flip { character, frames: (first, last), repaired: false } => {
                write!(
                    f,
                    "the facing of {character} jumps at frames {first}–{last}, where the path folds back"
                )
            }
            Self::StepsAtBound { steps } => write!(f, "{steps} time steps stand at their bounds"),
        }
    }
}
