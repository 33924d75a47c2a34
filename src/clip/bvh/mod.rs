//! Reads the text of BVH files of any flavour: joints, channels, rows.
//!
//! Limits: 65 536 joints, 2³² − 1 frames, joints times frames up to 2¹⁹ and one more for every 4 bytes, coordinates up to
//! 10⁹ file units, a frame time of 1 µs to 10 s, one body a file. Memory follows what a file holds, never what it announces,
//! and nesting costs no stack. Reading takes keywords and channels in any case, any channel order and any rotation order.
//!
//! Conventions that files leave open:
//! - Position channels of the root replace its OFFSET, a channel that is missing keeps the OFFSET's coordinate. Joints below
//!   the root with position channels move against their parents; there the channels replace the OFFSET too, unless they are
//!   nearer to zero than to the offsets throughout the file, which then are displacements to be added.
//! - Fewer than three rotation channels are completed by the other axes, unturned.

mod convert;
mod error;
mod parse;
mod rate;

pub use error::BvhError;

use crate::clip::file_motion::FileMotion;
use crate::clip::note::ReadNote;
use crate::index::SourceFrame;

/// The motion of the BVH file `bytes`, called `name`. `repair`: values that are no finite numbers are filled in from the
/// frames around them. Cost: linear in the file's length.
///
/// # Errors
/// [`BvhError`] with line and column of the first fault.
pub(in crate::clip) fn motion(bytes: &[u8], name: &str, repair: bool) -> Result<FileMotion, BvhError> {
    let raw = parse::parse(bytes, repair)?;
    let mut notes = Vec::new();
    if !raw.mended.is_empty() {
        notes.push(ReadNote::ValuesFilledIn {
            frames: raw.mended.iter().copied().map(SourceFrame::from_usize).collect(),
        });
    }
    let header_fps = rate::frame_rate(&raw);
    let clip = convert::clip_in_file_units(&raw, name, header_fps, &mut notes);
    Ok(FileMotion { clip, header_fps, unit_to_m: None, up: None, notes })
}
