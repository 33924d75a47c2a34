//! What can be wrong with Acclaim files, where, and what to do about it.

use crate::clip::text::{Position, TextError};

/// Why a skeleton or a motion could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AcclaimError {
    /// A fault of the skeleton's file.
    #[error(transparent)]
    Skeleton(#[from] AsfError),
    /// A fault of the motion's file.
    #[error(transparent)]
    Motion(#[from] AmcError),
}

impl AcclaimError {
    /// Where the fault is.
    pub fn position(&self) -> Position {
        match self {
            Self::Skeleton(error) => error.position(),
            Self::Motion(error) => error.position(),
        }
    }

    /// Whether the fault is in the skeleton's file, not in the motion's.
    pub fn is_in_skeleton(&self) -> bool {
        matches!(self, Self::Skeleton(_))
    }
}

/// What is wrong with an ASF file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "`at` is the place of the fault, the other fields stand in the message")]
pub enum AsfError {
    /// A word that is none, or not the one that belongs there.
    #[error(transparent)]
    Text(#[from] TextError),
    /// The first word is no section.
    #[error("{at}: not an ASF file, which starts with a section such as :version (found {found})")]
    NotAsf { at: Position, found: String },
    /// A section without which there is no skeleton.
    #[error("{at}: the file ends without a {section} section; it seems cut short, copy or export it again")]
    NoSection { at: Position, section: &'static str },
    /// A section or a field that stands twice.
    #[error("{at}: a second `{what}`; each may stand once")]
    Repeated { at: Position, what: String },
    /// A bone that lacks a field.
    #[error("{at}: bone `{bone}` ends without `{field}`; add a line with it")]
    BoneLacks { at: Position, bone: String, field: &'static str },
    /// Two bones of one name, or a bone called root.
    #[error("{at}: a second bone called `{name}`; motions tell bones by their names, give it another")]
    NameTaken { at: Position, name: String },
    /// More bones than the reader takes.
    #[error("{at}: more than {limit} bones; leave out what is not a body")]
    TooManyBones { at: Position, limit: usize },
    /// A length or coordinate that no body has.
    #[error("{at}: {found:e} is no {what}; it must lie between {least:e} and {most:e}")]
    OutOfRange { at: Position, found: f64, what: &'static str, least: f64, most: f64 },
    /// Letters that are no order of rotations.
    #[error("{at}: `{found}` is no order of rotations; write each of X, Y and Z once, as in XYZ")]
    RotationOrder { at: Position, found: String },
    /// A word that is no channel.
    #[error("{at}: unknown degree of freedom `{found}`; {known}")]
    UnknownDof { at: Position, found: String, known: &'static str },
    /// A bone that slides or stretches.
    #[error(
        "{at}: bone `{bone}` moves along `{found}`; only turning bones are read: rx, ry, rz. Convert the motion to BVH"
    )]
    MovingBone { at: Position, bone: String, found: String },
    /// As many limits as degrees of freedom, or none.
    #[error("{at}: bone `{bone}` has {dofs} degrees of freedom, but {found} limits; write one for each")]
    LimitCount { at: Position, bone: String, dofs: usize, found: usize },
    /// A lower limit above the upper one.
    #[error("{at}: the lower limit {low} lies above the upper limit {high}; exchange them")]
    LimitsCross { at: Position, low: f64, high: f64 },
    /// The hierarchy has a bone the file does not describe.
    #[error("{at}: no bone `{name}` in :bonedata; correct the name")]
    UnknownBone { at: Position, name: String },
    /// A bone that hangs on two.
    #[error("{at}: `{bone}` already hangs on another bone; it can have one parent only")]
    SecondParent { at: Position, bone: String },
    /// A bone that hangs on nothing, or on itself in the end.
    #[error("{at}: no way leads from the root to bone `{bone}`; hang it on one in :hierarchy")]
    NotConnected { at: Position, bone: String },
}

impl AsfError {
    /// Where the fault is.
    pub fn position(&self) -> Position {
        match self {
            Self::Text(error) => error.position(),
            Self::NotAsf { at, .. }
            | Self::NoSection { at, .. }
            | Self::Repeated { at, .. }
            | Self::BoneLacks { at, .. }
            | Self::NameTaken { at, .. }
            | Self::TooManyBones { at, .. }
            | Self::OutOfRange { at, .. }
            | Self::RotationOrder { at, .. }
            | Self::UnknownDof { at, .. }
            | Self::MovingBone { at, .. }
            | Self::LimitCount { at, .. }
            | Self::LimitsCross { at, .. }
            | Self::UnknownBone { at, .. }
            | Self::SecondParent { at, .. }
            | Self::NotConnected { at, .. } => *at,
        }
    }
}

/// What is wrong with an AMC file; `frame` is the number in the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "`at` is the place of the fault, the other fields stand in the message")]
pub enum AmcError {
    /// A word that is none, or not the one that belongs there.
    #[error(transparent)]
    Text(#[from] TextError),
    /// The motion has no frames.
    #[error("{at}: the file has no frames; a clip needs one at least")]
    NoFrames { at: Position },
    /// A rate out of all reason.
    #[error("{at}: {found} samples a second; the rate must lie between 0.1 and 1000000")]
    Rate { at: Position, found: f64 },
    /// A frame is left out, or there twice.
    #[error(
        "{at}: frame {found} where frame {expected} should follow; restore what is missing, or number anew"
    )]
    FrameNumber { at: Position, expected: u64, found: u64 },
    /// A bone that the skeleton does not have.
    #[error(
        "{at}: frame {frame} has a bone `{name}`, which the skeleton has not; name the skeleton of this performer"
    )]
    UnknownBone { at: Position, name: String, frame: u64 },
    /// A bone twice in one frame.
    #[error("{at}: bone `{bone}` stands twice in frame {frame}; remove one line")]
    RepeatedBone { at: Position, bone: String, frame: u64 },
    /// A frame that lacks a bone.
    #[error("{at}: frame {frame} lacks bone `{bone}`; every frame must have all bones that turn")]
    MissingBone { at: Position, bone: String, frame: u64 },
    /// A line with another number of values than the bone has degrees of freedom.
    #[error(
        "{at}: bone `{bone}` has {found} values in frame {frame}, expected {expected}, one for each degree of freedom"
    )]
    ValueCount { at: Position, bone: String, frame: u64, expected: usize, found: usize },
    /// A value that no capture has.
    #[error("{at}: {found:e} is neither a coordinate nor an angle; all must stay within {most:e}")]
    TooFar { at: Position, found: f64, most: f64 },
    /// Too many values in a row of frames that are no numbers.
    #[error("{at}: more than {limit} frames without a number here cannot be filled in; leave them out")]
    LongGap { at: Position, limit: usize },
    /// Too many values that are no numbers.
    #[error(
        "{at}: more than {limit} values without a number cannot be filled in; this is no capture any more"
    )]
    TooManyGaps { at: Position, limit: usize },
    /// More joints and frames than a text of its size can mean.
    #[error(
        "{at}: {frames} frames of {joints} joints in a file of this size; leave out bones that do not turn, or split the motion"
    )]
    TooManyRotations { at: Position, joints: usize, frames: usize },
}

impl AmcError {
    /// Where the fault is.
    pub fn position(&self) -> Position {
        match self {
            Self::Text(error) => error.position(),
            Self::NoFrames { at }
            | Self::Rate { at, .. }
            | Self::FrameNumber { at, .. }
            | Self::UnknownBone { at, .. }
            | Self::RepeatedBone { at, .. }
            | Self::MissingBone { at, .. }
            | Self::ValueCount { at, .. }
            | Self::TooFar { at, .. }
            | Self::LongGap { at, .. }
            | Self::TooManyGaps { at, .. }
            | Self::TooManyRotations { at, .. } => *at,
        }
    }
}
