//! What can be wrong with a DeepMimic motion, where, and what to do about it.

use crate::clip::text::{Position, TextError};

/// Why a motion could not be read; rows count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "`at` is the place of the fault, the other fields stand in the message")]
pub enum DeepMimicError {
    /// A word that is none, or not the one that belongs there.
    #[error(transparent)]
    Text(#[from] TextError),
    /// The first character is no opening brace.
    #[error("{at}: not a DeepMimic motion, which starts with an opening brace (found {found})")]
    NotDeepMimic { at: Position, found: String },
    /// A key that stands twice.
    #[error("{at}: a second key `{key}`; remove one")]
    RepeatedKey { at: Position, key: &'static str },
    /// No frames at all.
    #[error("{at}: no key `Frames`; a motion has its rows there")]
    NoFramesKey { at: Position },
    /// An empty list of frames.
    #[error("{at}: the file has no frames; a clip needs one at least")]
    NoFrames { at: Position },
    /// A row that is not of the humanoid's length.
    #[error("{at}: row {row} has {found} values, expected {expected}; only the humanoid's motions are read")]
    RowLength { at: Position, row: usize, expected: usize, found: usize },
    /// More rows than the text can hold in earnest.
    #[error(
        "{at}: more than {limit} rows for a file of this size; write numbers in full, or split the motion"
    )]
    TooManyRows { at: Position, limit: usize },
    /// A duration that none can be.
    #[error(
        "{at}: row {row} lasts {found} s; it must be above 0 and 10 at most, as in 0.0333333 for 30 frames a second"
    )]
    Duration { at: Position, row: usize, found: f64 },
    /// Too many rows that last longer or shorter than most.
    #[error("{at}: row {row} lasts {found} s, most last {usual}; sample the motion evenly")]
    Uneven { at: Position, row: usize, found: f64, usual: f64 },
    /// Four numbers far from any rotation.
    #[error("{at}: the quaternion of `{joint}` in row {row} has length {length}, expected 1; repair it")]
    NoRotation { at: Position, row: usize, joint: &'static str, length: f64 },
    /// A place of the root that no capture has.
    #[error("{at}: {found:e} is no coordinate; the root must stay within {most} m")]
    TooFar { at: Position, found: f64, most: f64 },
    /// Too many values in a row of frames that are no numbers.
    #[error("{at}: more than {limit} frames without a number here cannot be filled in; leave them out")]
    LongGap { at: Position, limit: usize },
    /// Too many values that are no numbers.
    #[error(
        "{at}: more than {limit} values without a number cannot be filled in; this is no capture any more"
    )]
    TooManyGaps { at: Position, limit: usize },
}

impl DeepMimicError {
    /// Where the fault is.
    pub fn position(&self) -> Position {
        match self {
            Self::Text(error) => error.position(),
            Self::NotDeepMimic { at, .. }
            | Self::RepeatedKey { at, .. }
            | Self::NoFramesKey { at }
            | Self::NoFrames { at }
            | Self::RowLength { at, .. }
            | Self::TooManyRows { at, .. }
            | Self::Duration { at, .. }
            | Self::Uneven { at, .. }
            | Self::NoRotation { at, .. }
            | Self::TooFar { at, .. }
            | Self::LongGap { at, .. }
            | Self::TooManyGaps { at, .. } => *at,
        }
    }
}
