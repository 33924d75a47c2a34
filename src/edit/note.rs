//! What the user should know about an edit that succeeded.

use crate::edit::error::Named;

/// So many constraints are named in one note.
const MOST_NAMED: usize = 5;

/// What the user should know about an edit that succeeded.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EditNote {
    /// Hard constraints that others imply, in whole or in part.
    Redundant(Vec<Named>),
    /// A path is drastically longer or shorter than before.
    Stretched {
        /// Whose.
        character: String,
        /// Length after the edit over length before.
        ratio: f64,
    },
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
    /// A path stays stretched, and nothing in the motion graph fits to change that.
    NothingFits {
        /// Whose.
        character: String,
        /// Length after the edit over length before.
        ratio: f64,
    },
}

impl std::fmt::Display for EditNote {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Redundant(named) => {
                let shown: Vec<String> = named.iter().take(MOST_NAMED).map(ToString::to_string).collect();
                let more = match named.len().saturating_sub(MOST_NAMED) {
                    0 => String::new(),
                    more => format!(" and {more} more"),
                };
                write!(f, "other hard constraints imply all or part of {}{more}", shown.join(", "))
            }
            Self::Stretched { character, ratio } => {
                write!(f, "the path of {character} is {ratio:.2} times as long as before")
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
            Self::NothingFits { character, ratio } => {
                write!(
                    f,
                    "nothing in the motion graph fits the track of {character}: its path is stretched {ratio:.2} times"
                )
            }
        }
    }
}
