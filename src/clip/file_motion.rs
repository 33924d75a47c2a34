//! What every reader of a format produces: a motion in the units and axes of its file.

use std::fmt;

use super::Clip;
use super::note::ReadNote;

/// A motion as its file has it.
#[derive(Clone, Debug)]
pub(super) struct FileMotion {
    /// File units and axes; all frames usable, roles by name.
    pub(super) clip: Clip,
    /// Frames per second the file states, or its format implies.
    pub(super) header_fps: f64,
    /// Metres per file unit, where the format or the file settles it.
    pub(super) unit_to_m: Option<f64>,
    /// Axis that points up, where the format settles it.
    pub(super) up: Option<Up>,
    /// What was found odd so far.
    pub(super) notes: Vec<ReadNote>,
}

/// Axis that points up in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the two axes")]
pub enum Up {
    Y,
    Z,
}

impl fmt::Display for Up {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Y => "y",
            Self::Z => "z",
        })
    }
}
