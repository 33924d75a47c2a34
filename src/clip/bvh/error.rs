//! What can be wrong with a BVH file, where, and what to do about it.

use crate::clip::text::{Position, TextError};

/// Why a BVH file could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "`at` is the place of the fault, the other fields stand in the message")]
pub enum BvhError {
    /// A word that is none, or not the one that belongs there.
    #[error(transparent)]
    Text(#[from] TextError),
    /// The first word is not HIERARCHY.
    #[error("{at}: not a BVH file, which starts with the word HIERARCHY (found {found})")]
    NotBvh { at: Position, found: String },
    /// A joint's braces are never closed.
    #[error("{at}: the file ends inside joint `{joint}`; a closing brace is missing")]
    MissingBrace { at: Position, joint: String },
    /// The hierarchy has a second ROOT.
    #[error("{at}: a second ROOT; split the file, one body in each")]
    SecondRoot { at: Position },
    /// A joint without a name.
    #[error("{at}: a joint without a name; write one after ROOT or JOINT")]
    NoName { at: Position },
    /// A joint with two OFFSET or two CHANNELS lines.
    #[error("{at}: joint `{joint}` has a second {what} line; remove one")]
    Repeated { at: Position, joint: String, what: &'static str },
    /// A joint without an OFFSET line.
    #[error("{at}: joint `{joint}` closes without an OFFSET line; add one, in the parent's axes")]
    NoOffset { at: Position, joint: String },
    /// More joints than the reader takes.
    #[error("{at}: more than {limit} joints; leave out what is not a body")]
    TooManyJoints { at: Position, limit: usize },
    /// A word that is no channel.
    #[error(
        "{at}: unknown channel `{found}`; channels are Xposition, Yposition, Zposition, Xrotation, Yrotation, Zrotation"
    )]
    UnknownChannel { at: Position, found: String },
    /// The number after CHANNELS is not that of the names behind it.
    #[error(
        "{at}: joint `{joint}` announces {announced} channels, but {found} names follow; make the two agree"
    )]
    ChannelCount { at: Position, joint: String, announced: usize, found: usize },
    /// One channel twice in one joint.
    #[error("{at}: joint `{joint}` has the channel `{channel}` twice; each may stand once")]
    RepeatedChannel { at: Position, joint: String, channel: String },
    /// No joint has a channel, so that there is nothing to say in a row.
    #[error("{at}: no joint has channels, so that the file has no motion; give the root its CHANNELS line")]
    NoChannels { at: Position },
    /// More joints and frames than a text of its size can mean.
    #[error(
        "{at}: {frames} frames of {joints} joints in a file of this size; leave out joints that do not turn, or split the motion"
    )]
    TooManyRotations { at: Position, joints: usize, frames: usize },
    /// A coordinate or an angle that no body has.
    #[error("{at}: {found:e} is neither a coordinate nor an angle; all must stay within {most:e}")]
    TooFar { at: Position, found: f64, most: f64 },
    /// The motion has no frames.
    #[error("{at}: the file has no frames; a clip needs one at least")]
    NoFrames { at: Position },
    /// A frame time of zero or less, or out of all reason.
    #[error(
        "{at}: frame time {found} s; it must lie above 0 and be 10 at most, as in 0.0083333 for 120 frames a second"
    )]
    FrameTime { at: Position, found: f64 },
    /// A row with another number of values than there are channels.
    #[error("{at}: row {row} of the motion has {found} values, expected {expected}, one for each channel")]
    RowLength { at: Position, row: usize, expected: usize, found: usize },
    /// Fewer rows than announced.
    #[error(
        "{at}: {announced} frames announced, {found} rows found; correct the number after Frames: or restore the rows"
    )]
    RowsMissing { at: Position, announced: usize, found: usize },
    /// Too many values in a row of frames that are no numbers.
    #[error("{at}: more than {limit} frames without a number here cannot be filled in; leave them out")]
    LongGap { at: Position, limit: usize },
    /// More than the announced rows.
    #[error(
        "{at}: {announced} frames announced, but more follows the last row; correct the number after Frames:"
    )]
    RowsLeft { at: Position, announced: usize },
}

impl BvhError {
    /// Where the fault is.
    pub fn position(&self) -> Position {
        match self {
            Self::Text(error) => error.position(),
            Self::NotBvh { at, .. }
            | Self::MissingBrace { at, .. }
            | Self::SecondRoot { at, .. }
            | Self::NoName { at, .. }
            | Self::Repeated { at, .. }
            | Self::NoOffset { at, .. }
            | Self::TooManyJoints { at, .. }
            | Self::UnknownChannel { at, .. }
            | Self::ChannelCount { at, .. }
            | Self::RepeatedChannel { at, .. }
            | Self::NoChannels { at }
            | Self::TooManyRotations { at, .. }
            | Self::TooFar { at, .. }
            | Self::NoFrames { at, .. }
            | Self::FrameTime { at, .. }
            | Self::RowLength { at, .. }
            | Self::RowsMissing { at, .. }
            | Self::LongGap { at, .. }
            | Self::RowsLeft { at, .. } => *at,
        }
    }
}
