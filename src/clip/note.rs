//! What a reader of clips guessed, repaired or found odd.

use std::fmt;

use crate::index::SourceFrame;
use crate::skeleton::JointRole;

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
    /// Values that were no finite numbers were filled in on request.
    ValuesFilledIn {
        /// Where.
        frames: Vec<SourceFrame>,
    },
    /// Single frames in which a joint or the body departs and comes back.
    Glitches {
        /// Which.
        frames: Vec<SourceFrame>,
    },
    /// The same, filled in on request.
    GlitchesRepaired {
        /// Which.
        frames: Vec<SourceFrame>,
    },
    /// So many glitches that something else must be wrong.
    ManyGlitches {
        /// In how many frames.
        frames: usize,
        /// Of how many.
        of: usize,
    },
    /// The rate differs from what the frame time's few digits say.
    RateRounded {
        /// Frames per second by the digits.
        written: f64,
        /// Frames per second taken.
        fps: f64,
    },
    /// The body has a size that bodies do not have.
    OddSize {
        /// Largest extent at rest, metres.
        metres: f64,
    },
    /// The body jumps, and the few frames beyond the jump are not used.
    JumpLeftOut {
        /// First frame after the jump.
        frame: SourceFrame,
        /// How far.
        metres: f64,
        /// First and last frame to use.
        usable: (SourceFrame, SourceFrame),
    },
    /// A moving body is frozen at an end of the file, in frames that are not used.
    FrozenLeftOut {
        /// The frames that repeat their neighbour, first and last.
        frozen: (SourceFrame, SourceFrame),
        /// What is left to use.
        usable: (SourceFrame, SourceFrame),
    },
    /// The body jumps farther than it can between two frames.
    Jumps {
        /// First frames after the jumps.
        frames: Vec<SourceFrame>,
    },
    /// A joint turns farther than it can between two frames near an end, and does not come back.
    JointJumps {
        /// First frames after the jumps.
        frames: Vec<SourceFrame>,
        /// Name of the joint that turns farthest.
        joint: String,
        /// How far, radians.
        turn: f64,
    },
    /// The file does not state its rate; that of most captures in its format was taken.
    RateAssumed {
        /// Frames per second.
        fps: f64,
    },
    /// Rotations whose four numbers are not those of a rotation; they were scaled.
    RotationsScaled {
        /// Frames with such rotations.
        frames: Vec<SourceFrame>,
        /// Length farthest from 1.
        length: f64,
    },
    /// Frames that last longer or shorter than most; they were taken to last as long.
    UnevenFrames {
        /// Which.
        frames: Vec<SourceFrame>,
    },
    /// The body falls faster than bodies do.
    DoubtfulFall {
        /// Downward acceleration of the mean of the joints, m/s².
        gravity: f64,
        /// Frames per second it was read at.
        fps: f64,
        /// Frames per second at which it would fall with 9.81 m/s².
        likely_fps: f64,
    },
    /// The rate is that of film, which programs write when they are not told another.
    FilmRate {
        /// Frames per second.
        fps: f64,
    },
}

impl ReadNote {
    /// Whether naming the frames to use leaves nothing to say.
    pub const fn is_settled_by_frames(&self) -> bool {
        matches!(
            self,
            Self::RestPoseLeftOut { .. }
                | Self::FirstFrameJumps
                | Self::JumpLeftOut { .. }
                | Self::FrozenLeftOut { .. }
        )
    }

    /// Whether it tells of single frames, all of them outside `first..=last`, or of jumps that no two frames of these have between
    /// them.
    pub fn is_outside(&self, first: SourceFrame, last: SourceFrame) -> bool {
        if let Self::Jumps { frames } | Self::JointJumps { frames, .. } = self {
            return frames.iter().all(|frame| *frame <= first || *frame > last);
        }
        let (Self::ValuesFilledIn { frames } | Self::Glitches { frames } | Self::GlitchesRepaired { frames }) =
            self
        else {
            return false;
        };
        frames.iter().all(|frame| !(first..=last).contains(frame))
    }

    /// Whether this tells of a repair that was asked for, not of a doubt.
    pub const fn is_repair(&self) -> bool {
        matches!(self, Self::ValuesFilledIn { .. } | Self::GlitchesRepaired { .. })
    }
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
                let names: Vec<&str> = roles.iter().map(|role| role.name()).collect();
                write!(f, "no joint found for {}", names.join(", "))
            }
            Self::SingleFrame => f.write_str("a single frame: a pose, no motion"),
            _ => self.doubt(f),
        }
    }
}

impl ReadNote {
    /// What is told of frames and sizes that cannot be right.
    fn doubt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ValuesFilledIn { frames } => {
                write!(f, "values that are no numbers were filled in: {}", frame_list(frames))
            }
            Self::Glitches { frames } => write!(
                f,
                "a joint departs for a single frame and comes back: {}; `repair` fills it in",
                frame_list(frames)
            ),
            Self::GlitchesRepaired { frames } => {
                write!(f, "frames that depart and come back were filled in: {}", frame_list(frames))
            }
            Self::ManyGlitches { frames, of } => write!(
                f,
                "joints depart and come back in {frames} of {of} frames: the angles or the rate are wrong; give `fps`, or \
                 export the file again"
            ),
            Self::OddSize { metres } => {
                write!(f, "the body measures {metres:.3} m: its unit is wrong, or it is no body; give `unit`")
            }
            Self::JumpLeftOut { frame, metres, usable: (first, last) } => write!(
                f,
                "the body jumps {metres:.2} m from frame {} to {}; the clip is used from frame {} to {}",
                frame.0 - 1,
                frame.0,
                first.0,
                last.0
            ),
            Self::FrozenLeftOut { frozen: (from, to), usable: (first, last) } => write!(
                f,
                "the moving body is frozen in frames {} to {}, which are all the same; the clip is used from frame {} to {}",
                from.0, to.0, first.0, last.0
            ),
            Self::Jumps { frames } => write!(
                f,
                "the body jumps farther than it can: before {}; give `frames` to leave it out",
                frame_list(frames)
            ),
            Self::JointJumps { frames, joint, turn } => write!(
                f,
                "a joint (`{joint}` by {:.0}°) turns farther than it can and does not come back: before {}; give `frames` to leave it \
                 out",
                turn.to_degrees(),
                frame_list(frames)
            ),
            Self::RotationsScaled { frames, length } => write!(
                f,
                "quaternions of length {length:.2} instead of 1 were scaled: {}; the motion was edited by hand there",
                frame_list(frames)
            ),
            Self::UnevenFrames { frames } => write!(
                f,
                "frames that last longer or shorter than the others were taken to last as long: {}",
                frame_list(frames)
            ),
            _ => self.doubtful_rate(f),
        }
    }
}

impl ReadNote {
    /// What is told of rates that were guessed or cannot be right.
    fn doubtful_rate(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RateRounded { written, fps } => write!(
                f,
                "the frame time means {fps} frames a second, though its few digits say {written:.1}; give `fps` to settle it"
            ),
            Self::RateAssumed { fps } => {
                write!(
                    f,
                    "the file does not state its rate, {fps} frames a second taken; give `fps` to settle it"
                )
            }
            Self::DoubtfulFall { gravity, fps, likely_fps } => write!(
                f,
                "the body falls with {gravity:.1} m/s² at {fps} frames a second: with {likely_fps:.0} it would fall as bodies do; \
                 give `fps`, or `unit`, if that is wrong"
            ),
            Self::FilmRate { fps } => write!(
                f,
                "{} frames a second is what programs write when they are not told the rate; captures are rarely \
                 taken at it: give `fps` to settle it",
                (fps * 1e3).round() / 1e3
            ),
            // The others are told where this is called.
            _ => Ok(()),
        }
    }
}

/// Frames a note names before it says how many more there are.
const FRAMES_NAMED: usize = 8;

fn frame_list(frames: &[SourceFrame]) -> String {
    let named: Vec<String> = frames.iter().take(FRAMES_NAMED).map(|frame| frame.0.to_string()).collect();
    let word = if frames.len() == 1 { "frame" } else { "frames" };
    let more = frames.len().saturating_sub(FRAMES_NAMED);
    let rest = if more == 0 { String::new() } else { format!(" and {more} more") };
    format!("{word} {}{rest}", named.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_of_single_frames_are_outside_a_range_only_if_all_of_them_are() {
        let [two, nine] = [2, 9].map(SourceFrame);
        let note = ReadNote::Glitches { frames: vec![two, nine] };
        assert!(note.is_outside(SourceFrame(3), SourceFrame(8)));
        assert!(!note.is_outside(SourceFrame(3), nine) && !note.is_outside(two, SourceFrame(8)));
        let jumps = ReadNote::Jumps { frames: vec![two, nine] };
        assert!(jumps.is_outside(two, SourceFrame(8)) && !jumps.is_outside(SourceFrame(1), SourceFrame(8)));
        assert!(!jumps.is_outside(two, nine));
        assert!(!ReadNote::UnitUnknown.is_outside(SourceFrame(3), SourceFrame(8)));
    }
}
