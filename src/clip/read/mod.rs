//! Reads motion capture of any format into clips: metres, y up, quaternions.
//!
//! What a file leaves open (unit, axis that points up, whether frame 0 belongs to the motion) is guessed, and every guess is
//! a [`ReadNote`]. A file with z up is turned by −90° about x, joint axes as well: `(x, y, z)` becomes `(x, z, −y)`.

mod frozen;
mod guess;
mod quality;
#[cfg(test)]
mod tests;
mod world;

use std::collections::BTreeMap;
use std::sync::Arc;

use super::file_motion::FileMotion;
pub use super::file_motion::Up;
use crate::clip::Clip;
use crate::clip::acclaim::{self, AcclaimError};
use crate::clip::bvh::{self, BvhError};
use crate::clip::deepmimic::{self, DeepMimicError};
use crate::clip::note::ReadNote;
use crate::clip::roles::missing_roles;
use crate::clip::text::Position;
use crate::index::SourceFrame;
use crate::skeleton::JointRole;

/// The bytes of a capture.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Capture<'a> {
    /// A BVH file.
    Bvh(&'a [u8]),
    /// An Acclaim motion (AMC) and its skeleton (ASF).
    Acclaim {
        /// The ASF file.
        skeleton: &'a [u8],
        /// The AMC file.
        motion: &'a [u8],
    },
    /// A DeepMimic motion (JSON).
    DeepMimic(&'a [u8]),
}

/// What a caller knows better than the file, and whether to mend it; default: the header's rate, the rest guessed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Frames per second.
    pub fps: Option<f64>,
    /// Metres per file unit.
    pub unit_to_m: Option<f64>,
    /// Axis that points up.
    pub up: Option<Up>,
    /// Joints of roles, by their names in the file, over what names and tree tell.
    pub roles: BTreeMap<JointRole, String>,
    /// Fills in single frames that are no numbers or cannot be motion.
    pub repair: bool,
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
    /// Frames per second that the file states.
    pub header_fps: f64,
    /// What was guessed, repaired or looks odd.
    pub notes: Vec<ReadNote>,
}

/// Why a capture could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// A fault of a BVH file.
    #[error(transparent)]
    Bvh(#[from] BvhError),
    /// A fault of an ASF or AMC file.
    #[error(transparent)]
    Acclaim(#[from] AcclaimError),
    /// A fault of a DeepMimic file.
    #[error(transparent)]
    DeepMimic(#[from] DeepMimicError),
    /// A role was given to a joint the file does not have.
    #[error("{role} cannot be joint `{joint}`, which the file does not have; its joints are {known}")]
    NoSuchJoint {
        /// The role.
        role: JointRole,
        /// As asked for.
        joint: String,
        /// Names of the file's joints.
        known: String,
    },
    /// Read strictly, and something is only guessed or looks odd.
    #[error("read strictly: {}", list(.notes))]
    Strict {
        /// What would have been noted.
        notes: Vec<ReadNote>,
    },
}

impl ReadError {
    /// Where the fault is in its file, where it is at one place.
    pub fn position(&self) -> Option<Position> {
        match self {
            Self::Bvh(error) => Some(error.position()),
            Self::Acclaim(error) => Some(error.position()),
            Self::DeepMimic(error) => Some(error.position()),
            Self::NoSuchJoint { .. } | Self::Strict { .. } => None,
        }
    }

    /// Whether the fault is in the file of the skeleton, not in that of the motion.
    pub fn is_in_skeleton(&self) -> bool {
        matches!(self, Self::Acclaim(error) if error.is_in_skeleton())
    }

    /// The message without the place it starts with, for those who show the place in their own way.
    pub fn without_position(&self) -> String {
        let message = self.to_string();
        let place = self.position().map_or_else(String::new, |at| format!("{at}: "));
        message.strip_prefix(&place).unwrap_or(&message).to_owned()
    }
}

fn list(notes: &[ReadNote]) -> String {
    notes.iter().map(ReadNote::to_string).collect::<Vec<_>>().join("; ")
}

/// First usable frame of the rig with buttock joints, where the rest pose of frame 0 bleeds into frames 1 to 5.
const AFTER_BLEEDING: SourceFrame = SourceFrame(6);

/// Reads `capture` into a clip called `name`. Cost: linear in the file's length.
///
/// # Errors
/// [`ReadError`] with line and column of the first fault.
pub fn read(capture: Capture<'_>, name: &str, options: &ReadOptions) -> Result<ReadClip, ReadError> {
    let FileMotion { mut clip, header_fps, unit_to_m, up, mut notes } = match capture {
        Capture::Bvh(bytes) => bvh::motion(bytes, name, options.repair)?,
        Capture::Acclaim { skeleton, motion } => acclaim::motion(skeleton, motion, name, options.repair)?,
        Capture::DeepMimic(bytes) => deepmimic::motion(bytes, name, options.repair)?,
    };
    override_roles(&mut clip, &options.roles)?;
    match options.fps {
        Some(fps) => {
            clip.fps = fps;
            notes.retain(|note| !matches!(note, ReadNote::RateAssumed { .. }));
        }
        None if guess::is_film_rate(header_fps) => notes.push(ReadNote::FilmRate { fps: header_fps }),
        None => {}
    }
    let unit_to_m = options.unit_to_m.or(unit_to_m).unwrap_or_else(|| guessed_unit(&clip, &mut notes));
    let known_up = options.up.or(up);
    let up = known_up.unwrap_or_else(|| guess::up(&clip));
    if known_up.is_none() && up == Up::Z {
        notes.push(ReadNote::ZUpGuessed);
    }
    world::to_world(&mut clip, unit_to_m, up);
    leave_out_rest_pose(&mut clip, &mut notes);
    frozen::leave_out(&mut clip, &mut notes);
    quality::examine(&mut clip, options.repair, &mut notes);
    if let Some(metres) = guess::odd_size(&clip.skeleton) {
        notes.push(ReadNote::OddSize { metres });
    }
    let roles = missing_roles(&clip.skeleton);
    if !roles.is_empty() {
        notes.push(ReadNote::RolesMissing { roles });
    }
    Ok(ReadClip { clip, unit_to_m, up, header_fps, notes })
}

impl ReadClip {
    /// Uses the frames `first` to `last` alone; notes of what they leave out are settled by that.
    pub fn use_frames(&mut self, first: SourceFrame, last: SourceFrame) {
        self.clip.usable = (first, last);
        self.notes.retain(|note| !note.is_settled_by_frames());
    }

    /// Refuses what is only noted, but for repairs that were asked for.
    ///
    /// # Errors
    /// [`ReadError::Strict`] with all that is guessed or looks odd.
    pub fn strictly(self) -> Result<Self, ReadError> {
        if self.notes.iter().all(ReadNote::is_repair) {
            return Ok(self);
        }
        Err(ReadError::Strict { notes: self.notes })
    }
}

/// Gives roles to the joints that a caller names.
fn override_roles(clip: &mut Clip, roles: &BTreeMap<JointRole, String>) -> Result<(), ReadError> {
    let skeleton = Arc::make_mut(&mut clip.skeleton);
    for (role, name) in roles {
        let Some(joint) = skeleton.joint_named(name) else {
            let known: Vec<&str> = skeleton.joints.iter().map(|joint| joint.name.as_str()).collect();
            return Err(ReadError::NoSuchJoint { role: *role, joint: name.clone(), known: known.join(", ") });
        };
        for other in skeleton.joints.iter_mut().filter(|other| other.role == Some(*role)) {
            other.role = None;
        }
        skeleton.joints[joint.as_usize()].role = Some(*role);
    }
    Ok(())
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
