//! Reads DeepMimic motions (JSON).

use crate::clip::file_motion::FileMotion;
use crate::clip::text::{Position, TextError};

/// Why a motion could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeepMimicError {
    /// A word that is none, or not the one that belongs there.
    #[error(transparent)]
    Text(#[from] TextError),
}

impl DeepMimicError {
    /// Where the fault is.
    pub fn position(&self) -> Position {
        match self {
            Self::Text(error) => error.position(),
        }
    }
}

/// The motion of a DeepMimic file.
pub(in crate::clip) fn motion(motion: &[u8], name: &str, repair: bool) -> Result<FileMotion, DeepMimicError> {
    let _ = (motion, name, repair);
    Err(TextError::EndOfFile { at: Position { line: 1, column: 1 }, expected: "a reader" }.into())
}
