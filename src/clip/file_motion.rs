//! What every reader of a format produces: a motion in the units and axes of its file.

use std::fmt;

use glam::{DQuat, DVec3};

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

/// Memory that any clip may take while it is read, bytes; a longer text may take nine halves of itself more. With all that
/// comes and goes meanwhile this stays below 64 MiB and 8 bytes for each of the text's.
const FREE_MEMORY: usize = 36 << 20;

/// Whether a text of `bytes` may hold so many frames of `joints`, each of `columns` numbers: joints without numbers, and
/// numbers of a single digit, take memory that no text pays for. Captures take twice their text.
pub(super) fn is_paid_for(bytes: usize, frames: usize, joints: usize, columns: usize) -> bool {
    let [turns, numbers] = [(joints, size_of::<DQuat>()), (columns, size_of::<f64>())]
        .map(|(count, each)| count.saturating_mul(each));
    let frame = turns.saturating_add(numbers).saturating_add(size_of::<DVec3>());
    frames.saturating_mul(frame) <= FREE_MEMORY + bytes / 2 * 9
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
