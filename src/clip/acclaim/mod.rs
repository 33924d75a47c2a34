//! Reads Acclaim skeletons (ASF) and motions (AMC), the format of CMU's capture database.
//!
//! Limits: 65 535 bones below the root, 2³² − 1 frames, lengths and coordinates up to 10⁹ file units, joints times frames up
//! to 2¹⁹ and one more for every 8 bytes of the motion. Memory follows what the files hold, never what they announce, and
//! nesting costs no stack. Keywords may be in any case, sections and fields in any order; `#` starts a comment.
//!
//! A joint stands where a bone starts, which is where its parent ends; a leaf's own end is an end site. With `axis` of the
//! bone as rotation C (the first letter of its order turned first) and the values of its `dof` as M (the first turned first),
//! the joint's rotation is C·M·C⁻¹. [`Joint::rotation_order`](crate::skeleton::Joint::rotation_order) has the order of the
//! product M, in which what is turned first stands last.
//!
//! Conventions that the files leave open:
//! - A unit is an inch over `length`: 0.45 in CMU's files makes 0.0564 m. Where `length` is 1 or missing, nobody meant inches:
//!   the unit is guessed from the size of the body.
//! - The root's `position` is added to its translations, its `orientation` O comes before its rotations: O·M.
//! - Angles of a motion are in the unit it states, else in that of its skeleton, else in degrees.
//! - The rate is not part of the format. Unless the motion has `:SAMPLES-PER-SECOND`, CMU's 120 is taken, with a note.
//! - Bones turn only: `dof` with tx, ty, tz or l is refused.
//! - `limits` are checked for their form and not kept: captures exceed them everywhere.
//! - Frames may start at any number but must follow one another; `repair` fills in up to three left out.
//!
//! Source: Lander, *Working with Motion Capture File Formats*, Game Developer, January 1998; CMU Graphics Lab Motion Capture
//! Database.

mod bones;
mod convert;
mod error;
mod lines;
mod motion;
mod skeleton;
#[cfg(test)]
mod tests;
mod tree;

pub use error::{AcclaimError, AmcError, AsfError};

use crate::clip::file_motion::{FileMotion, Up};
use crate::clip::note::ReadNote;
use crate::index::SourceFrame;

/// Metres per inch.
const INCH: f64 = 0.0254;

/// Rate of CMU's captures, frames per second.
const USUAL_FPS: f64 = 120.0;

/// The motion of the AMC file `motion` on the skeleton of the ASF file `skeleton`, called `name`. `repair`: values that are no
/// finite numbers, and up to three frames left out, are filled in from the frames around them. Cost: linear in the files'
/// lengths and in joints times frames.
///
/// # Errors
/// [`AcclaimError`] with line and column of the first fault, the skeleton's before the motion's.
pub(in crate::clip) fn motion(
    skeleton: &[u8],
    motion: &[u8],
    name: &str,
    repair: bool,
) -> Result<FileMotion, AcclaimError> {
    let skeleton = skeleton::parse(skeleton)?;
    let columns = motion::Columns::of(&skeleton);
    let motion = motion::parse(motion, &skeleton, &columns, repair)?;
    let mut notes = Vec::new();
    if !motion.mended.is_empty() {
        let frames = motion.mended.iter().copied().map(SourceFrame::from_usize).collect();
        notes.push(ReadNote::ValuesFilledIn { frames });
    }
    if motion.fps.is_none() {
        notes.push(ReadNote::RateAssumed { fps: USUAL_FPS });
    }
    let header_fps = motion.fps.unwrap_or(USUAL_FPS);
    let clip = convert::clip_in_file_units(&skeleton, &columns, &motion, name, header_fps);
    let unit_to_m = skeleton.units_per_inch.filter(|length| *length != 1.0).map(|length| INCH / length);
    Ok(FileMotion { clip, header_fps, unit_to_m, up: Some(Up::Y), notes })
}
