//! Reads BVH files of any flavour into clips: metres, y up, quaternions.
//!
//! Limits: 65 536 joints, 2³² − 1 frames, a frame time of 1 µs to 10 s, one body a file. Memory follows what a file holds, never what it announces, and
//! nesting costs no stack. Reading takes keywords and channels in any case, any channel order and any rotation order.
//!
//! Conventions that files leave open:
//! - Position channels of the root replace its OFFSET, a channel that is missing keeps the OFFSET's coordinate. Joints below
//!   the root with position channels move against their parents; there the channels replace the OFFSET too, unless they are
//!   nearer to zero than to the offsets throughout the file, which then are displacements to be added.
//! - Fewer than three rotation channels are completed by the other axes, unturned.
//! - A file with z up is turned by −90° about x, joint axes as well: `(x, y, z)` becomes `(x, z, −y)`.

mod convert;
mod cursor;
mod error;
mod guess;
mod parse;
#[cfg(test)]
mod tests;

use std::fmt;

pub use error::{BvhError, Position};

use crate::clip::Clip;
use crate::clip::roles::missing_roles;
use crate::index::SourceFrame;
use crate::skeleton::JointRole;

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

/// What a caller knows better than the file; all `None`: the header's rate, the rest guessed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Frames per second.
    pub fps: Option<f64>,
    /// Metres per file unit.
    pub unit_to_m: Option<f64>,
    /// Axis that points up.
    pub up: Option<Up>,
}

/// A clip and how its file was understood.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadClip {
    /// The motion, converted.
    pub clip: Clip,
    /// Metres per file unit.
    pub unit_to_m: f64,
    /// Axis that points up in the file.
    pub up: Up,
    /// Frames per second that the file's frame time means.
    pub header_fps: f64,
    /// What was guessed or looks odd.
    pub notes: Vec<ReadNote>,
}

/// Something a person should know about a file that was read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ReadNote {
    /// The unit was guessed from the size of the body.
    UnitGuessed {
        /// Metres per file unit.
        unit_to_m: f64,
    },
    /// The skeleton has no size to guess the unit from; metres were taken.
    UnitUnknown,
    /// The file was taken to have z up.
    ZUpGuessed,
    /// Frame 0 is a rest pose that jumps to frame 1.
    RestPoseLeftOut {
        /// First frame to use.
        first_usable: SourceFrame,
    },
    /// The body jumps from frame 0 to frame 1.
    FirstFrameJumps,
    /// Two joints share a name.
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A joint has more than one end site; the first was kept.
    EndSitesDropped {
        /// Name of the joint.
        joint: String,
    },
    /// Position channels below the root were taken as displacements from the offsets.
    DisplacementChannels,
    /// Parts of the body were not found.
    RolesMissing {
        /// What is missing.
        roles: Vec<JointRole>,
    },
    /// One frame only: no speeds.
    SingleFrame,
}

impl fmt::Display for ReadNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnitGuessed { unit_to_m } => {
                write!(
                    f,
                    "unit guessed from the size of the body: {unit_to_m:.6} m; give `unit` to settle it"
                )
            }
            Self::UnitUnknown => {
                f.write_str("no size to guess the unit from, metres taken; give `unit` to settle it")
            }
            Self::ZUpGuessed => f.write_str("taken to have z up; give `up` to settle it"),
            Self::RestPoseLeftOut { first_usable } => {
                let first = first_usable.0;
                write!(f, "frame 0 is a rest pose; the clip is used from frame {first} on")
            }
            Self::FirstFrameJumps => {
                f.write_str("the body jumps from frame 0 to frame 1; give `frames` to leave frame 0 out")
            }
            Self::DuplicateName { name } => {
                write!(f, "two joints are called `{name}`; the first answers to the name")
            }
            Self::EndSitesDropped { joint } => {
                write!(f, "joint `{joint}` has several end sites; the first was kept")
            }
            Self::DisplacementChannels => {
                f.write_str("position channels below the root are near zero and were added to the offsets")
            }
            Self::RolesMissing { roles } => {
                let names: Vec<String> = roles.iter().map(|role| format!("{role:?}")).collect();
                write!(f, "no joint found for {}", names.join(", "))
            }
            Self::SingleFrame => f.write_str("a single frame: a pose, no motion"),
        }
    }
}

/// First usable frame of the rig with buttock joints, where the rest pose of frame 0 bleeds into frames 1 to 5.
const AFTER_BLEEDING: SourceFrame = SourceFrame(6);

/// Reads the BVH file `bytes` into a clip called `name`. Cost: linear in the file's length.
///
/// # Errors
/// [`BvhError`] with line and column of the first fault.
pub fn read(bytes: &[u8], name: &str, options: &ReadOptions) -> Result<ReadClip, BvhError> {
    let raw = parse::parse(bytes)?;
    let header_fps = guess::frame_rate(&raw);
    let mut notes = Vec::new();
    let mut clip = convert::clip_in_file_units(&raw, name, options.fps.unwrap_or(header_fps), &mut notes);
    let unit_to_m = options.unit_to_m.unwrap_or_else(|| guessed_unit(&clip, &mut notes));
    let up = options.up.unwrap_or_else(|| guess::up(&clip));
    if options.up.is_none() && up == Up::Z {
        notes.push(ReadNote::ZUpGuessed);
    }
    convert::to_world(&mut clip, unit_to_m, up);
    leave_out_rest_pose(&mut clip, &mut notes);
    let roles = missing_roles(&clip.skeleton);
    if !roles.is_empty() {
        notes.push(ReadNote::RolesMissing { roles });
    }
    Ok(ReadClip { clip, unit_to_m, up, header_fps, notes })
}

fn guessed_unit(clip: &Clip, notes: &mut Vec<ReadNote>) -> f64 {
    match guess::unit_to_m(&clip.skeleton) {
        Some(unit_to_m) => {
            notes.push(ReadNote::UnitGuessed { unit_to_m });
            unit_to_m
        }
        None => {
            notes.push(ReadNote::UnitUnknown);
            1.0
        }
    }
}

fn leave_out_rest_pose(clip: &mut Clip, notes: &mut Vec<ReadNote>) {
    if clip.frame_count() == 1 {
        notes.push(ReadNote::SingleFrame);
    }
    match guess::start(clip) {
        guess::Start::Smooth => {}
        guess::Start::Jump => notes.push(ReadNote::FirstFrameJumps),
        guess::Start::RestPose => {
            let bleeds = guess::is_buttock_rig(&clip.skeleton) && AFTER_BLEEDING < clip.usable.1;
            let first_usable = if bleeds { AFTER_BLEEDING } else { SourceFrame(1) };
            clip.usable.0 = first_usable;
            notes.push(ReadNote::RestPoseLeftOut { first_usable });
        }
    }
}
