//! Discrete changes in a report.

use serde::Serialize;

use crate::discrete::editor::{LogEntry, Occasion};
use crate::discrete::outcome::TrackChanges;
use crate::export::report::RestEdited;
use crate::track::Track;

/// What became of a track that could change.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ChangesReport {
    /// Working frames.
    pub track_frames: RestEdited,
    /// What the deformation still adds.
    pub stretch: Stretch,
    /// Sum of the turns at the seams of changes, degrees.
    pub seam_turns: f64,
    /// How often one source frame is shown at most.
    pub copies: usize,
}

/// Edited over changed but not yet deformed.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Stretch {
    /// Of the path on the ground.
    pub length: f64,
    /// Of the duration.
    pub time: f64,
}

/// A discrete edit.
#[derive(Clone, Debug, Serialize)]
pub struct DiscreteReport {
    /// `delete`, `duplicate`, `insert` or `replace`.
    pub kind: &'static str,
    /// Where: the first frame that came or went (the one before, where others were put in), by clip and file frame.
    pub at: String,
    /// Working frames that came, less those that went.
    pub frames: i64,
    /// Drag in which it happened, from 0; left out before the first one and when settling.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drag: Option<usize>,
    /// Step of that drag, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<usize>,
    /// Whether it happened after all drags.
    pub settling: bool,
    /// Whether it takes an earlier change back.
    pub undo: bool,
    /// Deformation energy before and after the update; before, `null` where the track could not reach the targets.
    pub energy: [f64; 2],
}

impl ChangesReport {
    /// What to tell of a track, before and after.
    pub fn new(changes: &TrackChanges, before: &Track, after: &Track) -> Self {
        Self {
            track_frames: RestEdited {
                rest: before.frame_count() as f64,
                edited: after.frame_count() as f64,
            },
            stretch: Stretch { length: changes.length, time: changes.time },
            seam_turns: changes.turns.to_degrees(),
            copies: changes.copies,
        }
    }
}

impl DiscreteReport {
    /// What to tell of one change.
    pub fn new(entry: &LogEntry) -> Self {
        let (drag, step) = match entry.occasion {
            Occasion::Drag { drag, step } => (Some(drag), Some(step)),
            Occasion::First | Occasion::Settling => (None, None),
        };
        Self {
            kind: entry.kind.name(),
            at: entry.at.clone(),
            frames: entry.frames,
            drag,
            step,
            settling: entry.occasion == Occasion::Settling,
            undo: entry.undo,
            energy: [entry.energy.0, entry.energy.1],
        }
    }
}
