//! Frames that cannot be motion: single frames that depart and come back, and jumps of a joint or of the whole body.

use crate::clip::Clip;
use crate::clip::note::ReadNote;
use crate::clip::repair::LONGEST_GAP;
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
/// A smaller turn of a joint is no jump, however short the frame, radians: 45°. Toes snap by 30° as they leave the ground.
const LEAST_JOINT_JUMP: f64 = 0.785;
/// A joint jumps if it turns so many times as far as a frame before and after.
const JUMP_RATIO: f64 = 5.0;
/// Where so many frames are glitches, it is the angles or the rate that are wrong, share of all.
const SICK_SHARE: f64 = 0.05;
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
    let found = glitches(clip);
    let frames = frames_of(&found);
    if frames.len() as f64 > SICK_SHARE * clip.frame_count() as f64 {
        notes.push(ReadNote::ManyGlitches { frames: frames.len(), of: clip.frame_count() });
    } else if repair {
        let mut mended: Vec<Glitch> = Vec::new();
        for run in runs_of(found) {
            if fill_in(clip, &run) {
                mended.extend(run);
            }
        }
        note(frames_of(&mended), notes, |frames| ReadNote::GlitchesRepaired { frames });
        note(frames_of(&glitches(clip)), notes, |frames| ReadNote::Glitches { frames });
    } else {
        note(frames, notes, |frames| ReadNote::Glitches { frames });
    }
    leave_out_jumps(clip, notes);
    note_joint_jumps(clip, notes);
}

fn note(frames: Vec<SourceFrame>, notes: &mut Vec<ReadNote>, of: impl FnOnce(Vec<SourceFrame>) -> ReadNote) {
    if !frames.is_empty() {
        notes.push(of(frames));
    }
}

/// Frames of glitches, each once, rising.
fn frames_of(glitches: &[Glitch]) -> Vec<SourceFrame> {
    let mut frames: Vec<SourceFrame> = glitches.iter().map(|glitch| glitch.frame).collect();
    frames.sort_unstable();
    frames.dedup();
    frames
}

/// Glitches of one joint in adjoining frames together: between them none is known to be right.
fn runs_of(mut glitches: Vec<Glitch>) -> Vec<Vec<Glitch>> {
    glitches.sort_unstable_by_key(|glitch| (glitch.joint, glitch.frame));
    let adjoin = |a: &Glitch, b: &Glitch| a.joint == b.joint && a.frame.0 + 1 == b.frame.0;
    glitches.chunk_by(adjoin).map(<[Glitch]>::to_vec).collect()
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

/// Puts what departs evenly between the frames around the run; `false` where the run is too long to know.
fn fill_in(clip: &mut Clip, run: &[Glitch]) -> bool {
    if run.len() > LONGEST_GAP {
        return false;
    }
    let (before, after) = (run[0].frame.as_usize() - 1, run[run.len() - 1].frame.as_usize() + 1);
    let joints = clip.skeleton.joints.len();
    for (step, glitch) in run.iter().enumerate() {
        let share = (step + 1) as f64 / (run.len() + 1) as f64;
        let frame = glitch.frame.as_usize();
        match glitch.joint {
            None => {
                let places = &mut clip.root_positions;
                places[frame] = places[before].lerp(places[after], share);
            }
            Some(joint) => {
                let at = |frame: usize| frame * joints + joint.as_usize();
                clip.rotations[at(frame)] =
                    slerp(clip.rotations[at(before)], clip.rotations[at(after)], share);
            }
        }
    }
    true
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

/// Notes joints with a role (fingers jump in many captures) that turn farther than they can between two usable frames near an
/// end, and stay there. The frames beyond stay in use: the rest of the body may be right there.
fn note_joint_jumps(clip: &Clip, notes: &mut Vec<ReadNote>) {
    let (first, last) = (clip.usable.0.as_usize(), clip.usable.1.as_usize());
    if last - first <= 2 * CUT_OFF {
        return;
    }
    let joints = clip.skeleton.joints.len();
    let limit = LEAST_JOINT_JUMP.max(FASTEST_TURN / clip.fps);
    let turn = |joint: usize, frame: usize| {
        let at = |frame: usize| clip.rotations[frame * joints + joint];
        log(at(frame - 1).inverse() * at(frame)).length()
    };
    let mut frames: Vec<SourceFrame> = Vec::new();
    let mut farthest = (0, 0.0);
    for frame in (first + 1..=first + CUT_OFF).chain(last - CUT_OFF + 1..=last) {
        for joint in (0..joints).filter(|joint| clip.skeleton.joints[*joint].role.is_some()) {
            let own = turn(joint, frame);
            // What moves fast does so for some frames; what departs and comes back is told elsewhere.
            let beside = |frame: usize| (first + 1..=last).contains(&frame).then(|| turn(joint, frame));
            let fastest = [beside(frame - 1), beside(frame + 1)].into_iter().flatten().fold(0.0, f64::max);
            if own > limit && own > JUMP_RATIO * fastest {
                frames.push(SourceFrame::from_usize(frame));
                farthest = if own > farthest.1 { (joint, own) } else { farthest };
            }
        }
    }
    frames.dedup();
    let joint = clip.skeleton.joints[farthest.0].name.clone();
    note(frames, notes, |frames| ReadNote::JointJumps { frames, joint, turn: farthest.1 });
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};

    use super::*;
    use crate::clip::builtin::generate;
    use crate::skeleton::JointRole;
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
    fn adjoining_frames_are_filled_in_together_and_long_runs_are_left() {
        let spoilt = |last: usize| {
            let mut clip = walk();
            let joints = clip.skeleton.joints.len();
            for frame in 20..=last {
                // One way and the other: every frame departs from both its neighbours.
                let turn = if frame % 2 == 0 { 2.5 } else { 0.0 };
                clip.rotations[frame * joints + 6] *= DQuat::from_rotation_z(turn);
            }
            clip
        };
        let (mended, notes) = examined(spoilt(22), true);
        assert_eq!(notes, [ReadNote::GlitchesRepaired { frames: [20, 21, 22].map(SourceFrame).to_vec() }]);
        let joints = mended.skeleton.joints.len();
        for frame in 20..=22 {
            let at = frame * joints + 6;
            assert!(mended.rotations[at].angle_between(walk().rotations[at]) < 0.05, "{frame}");
        }
        let (left, notes) = examined(spoilt(24), true);
        assert!(matches!(notes[..], [ReadNote::Glitches { .. }]), "{notes:?}");
        assert_eq!(left, spoilt(24));
    }

    #[test]
    fn a_clip_full_of_glitches_is_not_repaired_but_doubted() {
        let mut clip = walk();
        let joints = clip.skeleton.joints.len();
        for frame in (10..90).step_by(4) {
            clip.rotations[frame * joints + 6] *= DQuat::from_rotation_z(2.0);
        }
        let (same, notes) = examined(clip.clone(), true);
        assert_eq!(same, clip);
        assert_eq!(notes, [ReadNote::ManyGlitches { frames: 20, of: clip.frame_count() }]);
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
    fn an_arm_that_is_elsewhere_in_the_first_frames_is_named() {
        let mut clip = walk();
        let joints = clip.skeleton.joints.len();
        let arm = clip.skeleton.joint_of(JointRole::LeftShoulder).expect("generated bodies have arms");
        for frame in 0..2 {
            clip.rotations[frame * joints + arm.as_usize()] = DQuat::IDENTITY;
        }
        let before = clip.clone();
        let (after, notes) = examined(clip, false);
        let name = &after.skeleton.joints[arm.as_usize()].name;
        let [ReadNote::JointJumps { frames, joint, turn }] = &notes[..] else { panic!("{notes:?}") };
        assert_eq!((&frames[..], joint), (&[SourceFrame(2)][..], name));
        assert!(*turn > FASTEST_TURN / after.fps, "{turn}");
        assert_eq!(after, before, "it is told, and every frame stays in use");
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
