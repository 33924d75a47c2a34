//! Frames that cannot be motion: single frames that depart and come back, and jumps of the whole body.

use crate::clip::Clip;
use crate::clip::note::ReadNote;
use crate::geometry::{log, slerp};
use crate::index::{JointId, SourceFrame};

/// No body travels faster, m/s; sprinters reach 12.
const FASTEST_ROOT: f64 = 15.0;
/// A smaller step is no jump, however short the frame, metres.
const LEAST_STEP: f64 = 0.15;
/// No joint turns faster and back again, rad/s.
const FASTEST_TURN: f64 = 35.0;
/// A smaller turn is no glitch, however short the frame, radians.
const LEAST_TURN: f64 = 0.35;
/// A frame is a glitch if the frames around it differ by less than this share of what it departs by.
const RETURN_SHARE: f64 = 0.5;
/// A jump so near to an end of the file cuts off what lies beyond it, frames; and so many must be left.
const CUT_OFF: usize = 10;

/// Notes frames that cannot be motion. With `repair` single ones are filled in from the frames around them. A jump of the
/// body near an end of the file leaves the few frames beyond it out of the usable ones.
///
/// Cost: linear in frames and joints.
pub(super) fn examine(clip: &mut Clip, repair: bool, notes: &mut Vec<ReadNote>) {
    if clip.frame_count() < 3 {
        return;
    }
    let glitches = glitches(clip);
    if repair {
        for glitch in &glitches {
            fill_in(clip, *glitch);
        }
    }
    let mut frames: Vec<SourceFrame> = glitches.iter().map(|glitch| glitch.frame).collect();
    frames.dedup();
    if !frames.is_empty() {
        notes.push(if repair {
            ReadNote::GlitchesRepaired { frames }
        } else {
            ReadNote::Glitches { frames }
        });
    }
    leave_out_jumps(clip, notes);
}

/// One frame of a joint, or of the root's place, that departs from its neighbours and comes back.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Glitch {
    frame: SourceFrame,
    /// `None`: the place of the root.
    joint: Option<JointId>,
}

/// All glitches, by frame.
fn glitches(clip: &Clip) -> Vec<Glitch> {
    let joints = clip.skeleton.joints.len();
    let step = LEAST_STEP.max(FASTEST_ROOT / clip.fps);
    let turn = LEAST_TURN.max(FASTEST_TURN / clip.fps);
    let mut found = Vec::new();
    for frame in 1..clip.frame_count() - 1 {
        let root = |frame: usize| clip.root_positions[frame];
        let distance = |a: usize, b: usize| root(a).distance(root(b));
        if departs(
            distance(frame - 1, frame),
            distance(frame, frame + 1),
            distance(frame - 1, frame + 1),
            step,
        ) {
            found.push(Glitch { frame: SourceFrame::from_usize(frame), joint: None });
        }
        for joint in 0..joints {
            let at = |frame: usize| clip.rotations[frame * joints + joint];
            let angle = |a: usize, b: usize| log(at(a).inverse() * at(b)).length();
            // Most joints hardly turn: one dot product tells.
            if at(frame - 1).dot(at(frame)).abs() > (0.5 * turn).min(3.0).cos() {
                continue;
            }
            if departs(angle(frame - 1, frame), angle(frame, frame + 1), angle(frame - 1, frame + 1), turn) {
                found.push(Glitch {
                    frame: SourceFrame::from_usize(frame),
                    joint: Some(JointId::from_usize(joint)),
                });
            }
        }
    }
    found
}

fn departs(there: f64, back: f64, across: f64, limit: f64) -> bool {
    there > limit && back > limit && across < RETURN_SHARE * there.min(back)
}

/// Puts what departs half way between the frames around it.
fn fill_in(clip: &mut Clip, glitch: Glitch) {
    let frame = glitch.frame.as_usize();
    match glitch.joint {
        None => {
            clip.root_positions[frame] =
                clip.root_positions[frame - 1].midpoint(clip.root_positions[frame + 1]);
        }
        Some(joint) => {
            let joints = clip.skeleton.joints.len();
            let at = frame * joints + joint.as_usize();
            clip.rotations[at] = slerp(clip.rotations[at - joints], clip.rotations[at + joints], 0.5);
        }
    }
}

/// Cuts off what lies beyond a jump near an end; notes jumps elsewhere.
fn leave_out_jumps(clip: &mut Clip, notes: &mut Vec<ReadNote>) {
    let limit = LEAST_STEP.max(FASTEST_ROOT / clip.fps);
    let step = |frame: usize| clip.root_positions[frame - 1].distance(clip.root_positions[frame]);
    let (first, last) = (clip.usable.0.as_usize(), clip.usable.1.as_usize());
    let jumps: Vec<usize> = (first + 1..=last).filter(|&frame| step(frame) > limit).collect();
    let mut inside = Vec::new();
    for frame in jumps {
        let metres = step(frame);
        let frame_id = SourceFrame::from_usize(frame);
        if frame - first <= CUT_OFF && last - frame > CUT_OFF {
            clip.usable.0 = frame_id;
            notes.push(ReadNote::JumpLeftOut { frame: frame_id, metres, usable: clip.usable });
        } else if last - frame < CUT_OFF && frame - first > CUT_OFF {
            clip.usable.1 = SourceFrame::from_usize(frame - 1);
            notes.push(ReadNote::JumpLeftOut { frame: frame_id, metres, usable: clip.usable });
            break;
        } else {
            inside.push(frame_id);
        }
    }
    if !inside.is_empty() {
        notes.push(ReadNote::Jumps { frames: inside });
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};

    use super::*;
    use crate::clip::builtin::generate;
    use std::collections::BTreeMap;

    fn walk() -> Clip {
        generate("walk", &BTreeMap::new()).expect("a generated clip")
    }

    fn examined(mut clip: Clip, repair: bool) -> (Clip, Vec<ReadNote>) {
        let mut notes = Vec::new();
        examine(&mut clip, repair, &mut notes);
        (clip, notes)
    }

    #[test]
    fn a_walk_has_nothing_to_note() {
        assert_eq!(examined(walk(), true), (walk(), vec![]));
    }

    #[test]
    fn a_joint_that_departs_for_one_frame_is_named_and_mended() {
        let mut clip = walk();
        let joints = clip.skeleton.joints.len();
        clip.rotations[20 * joints + 6] *= DQuat::from_rotation_z(2.0);
        let frames = vec![SourceFrame(20)];
        assert_eq!(examined(clip.clone(), false).1, [ReadNote::Glitches { frames: frames.clone() }]);
        let (mended, notes) = examined(clip, true);
        assert_eq!(notes, [ReadNote::GlitchesRepaired { frames }]);
        let off = mended.rotations[20 * joints + 6].angle_between(walk().rotations[20 * joints + 6]);
        // Half way between neighbours of a swinging arm.
        assert!(off < 0.02, "{off}");
    }

    #[test]
    fn frames_before_a_jump_of_the_body_are_left_out() {
        let mut clip = walk();
        for root in &mut clip.root_positions[..4] {
            *root -= DVec3::X * 2.0;
        }
        let (clip, notes) = examined(clip, true);
        assert_eq!(clip.usable.0, SourceFrame(4));
        assert!(matches!(notes[..], [ReadNote::JumpLeftOut { frame: SourceFrame(4), .. }]));
    }

    #[test]
    fn a_jump_in_the_middle_is_noted() {
        let mut clip = walk();
        for root in &mut clip.root_positions[..50] {
            *root -= DVec3::X * 2.0;
        }
        let (clip, notes) = examined(clip, false);
        assert_eq!(clip.usable.0, SourceFrame(0));
        assert_eq!(notes, [ReadNote::Jumps { frames: vec![SourceFrame(50)] }]);
    }
}
