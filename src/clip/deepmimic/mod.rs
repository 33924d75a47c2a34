//! Reads DeepMimic motions: JSON with a list `Frames`, one row of 44 numbers a frame, of the 13-joint humanoid.
//!
//! A row: duration of the frame in seconds; place of the root in metres; rotations of root, chest, neck, then of hip, knee,
//! ankle, shoulder and elbow of the right side and of the left. Rotations are quaternions w x y z against the parent; knees and
//! elbows have one angle about z, radians: knees bend with negative ones, elbows with positive ones. The body looks along +x,
//! y is up, its left is −z. Offsets of the joints are those of the humanoid's model file. Wrists are fixed; they, the soles'
//! front edges and the crown are end sites.
//!
//! Limits: 2³² − 1 frames, 65 536 and one more for every 128 bytes; durations of 1 µs to 10 s; a root within 10⁹ m. Memory
//! follows what the file holds, and nesting costs no stack. Keys other than `Frames` and `Loop` are skipped.
//!
//! What files leave open:
//! - The rate is that of most frames. The last row's duration is left out, as no frame follows; up to a tenth of the others may
//!   differ by more than 0.1 %, with a note, and are taken to last as long as the rest. More are refused.
//! - Quaternions are scaled to length 1; a length off by more than 1 % is noted, below 0.5 or above 2 refused.
//! - `Loop` is checked and has no effect: a clip is what was captured.
//!
//! Source: Peng, Abbeel, Levine, van de Panne, *DeepMimic: Example-Guided Deep Reinforcement Learning of Physics-Based
//! Character Skills*, SIGGRAPH 2018, and the humanoid published with it.

mod body;
mod convert;
mod error;
mod json;
mod parse;
mod rate;
#[cfg(test)]
mod tests;

pub use error::DeepMimicError;

use crate::clip::file_motion::{FileMotion, Up};
use crate::clip::note::ReadNote;
use crate::index::SourceFrame;

/// The motion of the file `bytes`, called `name`. `repair`: values that are no finite numbers, or `null`, are filled in from
/// the frames around them. Cost: linear in the file's length, but for sorting the durations.
///
/// # Errors
/// [`DeepMimicError`] with line and column of the first fault.
pub(in crate::clip) fn motion(bytes: &[u8], name: &str, repair: bool) -> Result<FileMotion, DeepMimicError> {
    let raw = parse::parse(bytes, repair)?;
    let mut notes = Vec::new();
    if !raw.mended.is_empty() {
        let frames = raw.mended.iter().copied().map(SourceFrame::from_usize).collect();
        notes.push(ReadNote::ValuesFilledIn { frames });
    }
    let header_fps = rate::frame_rate(&raw, &mut notes)?;
    let clip = convert::clip(&raw, name, header_fps, &mut notes)?;
    Ok(FileMotion { clip, header_fps, unit_to_m: Some(1.0), up: Some(Up::Y), notes })
}
