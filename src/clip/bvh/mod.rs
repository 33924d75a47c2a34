//! Reads the text of BVH files of any flavour: joints, channels, rows.
//!
//! Limits: 65 536 joints, 2³² − 1 frames, coordinates up to 10⁹ file units, a frame time of 1 µs to 10 s, one body a file.
//! Memory follows what a file holds, never what it announces: a clip may take 36 MiB and 4.5 bytes for each of the file's;
//! captures take two. Nesting costs no stack. Reading takes keywords and channels in any case, any channel order and any rotation order.
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

/// A rate that differs by more from what the frame time's digits say is noted.
const ROUNDED: f64 = 0.05;

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
    let written = 1.0 / raw.frame_time;
    if (header_fps / written - 1.0).abs() > ROUNDED {
        notes.push(ReadNote::RateRounded { written, fps: header_fps });
    }
    let clip = convert::clip_in_file_units(&raw, name, header_fps, &mut notes);
    Ok(FileMotion { clip, header_fps, unit_to_m: None, up: None, notes })
}
