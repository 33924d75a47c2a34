//! Fingers of those who carry stay as they grasped: what a hand holds does not slip through them.

use std::ops::Range;

use crate::geometry::{slerp, smoothstep};
use crate::index::{CharacterId, JointId};
use crate::object_motion::{Owner, Performance, skeleton_of};
use crate::reach::{Stage, within};
use crate::skeleton::{Pose, Skeleton};

/// Seconds in which fingers close before a grasp and open after a release.
const CLOSING: f64 = 5.0 / 30.0;

/// Gives all joints below the hands of a character, as long as they carry, the rotations of the grasp. `times`: of `poses`,
/// rising. Cost: linear in samples and joints.
pub fn hold_fingers<P: Performance>(
    stage: &Stage<'_, P>,
    who: CharacterId,
    (times, poses): (&[f64], &mut [Pose]),
) {
    let objects = stage.ties.objects(stage.scene, who).into_iter();
    let spans = objects.flat_map(|object| &stage.objects[object.as_usize()].spans);
    let skeleton = skeleton_of(stage.scene, who);
    let mut holds = Vec::new();
    for span in spans {
        let Owner::Carried(hold) = &span.owner else {
            continue;
        };
        let grasp = || stage.performance.pose(who, stage.performance.frame(who, span.from));
        let own = hold.grips.iter().filter(|grip| grip.character == who);
        let joints: Vec<JointId> = own.flat_map(|grip| below(skeleton, grip.joint)).collect();
        if !joints.is_empty() {
            holds.push((joints, grasp(), within(times, span.from, span.to)));
        }
    }
    for (joints, grasp, range) in &holds {
        close(times, poses, range, |pose, share| turn(pose, (joints, grasp), share));
    }
    // Last, so that no hand opens while it carries something else.
    for (joints, grasp, range) in holds {
        for pose in &mut poses[range] {
            turn(pose, (&joints, &grasp), 1.0);
        }
    }
}

/// Calls `turn` for the samples beside `range`, with the share to which fingers are closed.
fn close(times: &[f64], poses: &mut [Pose], range: &Range<usize>, turn: impl Fn(&mut Pose, f64)) {
    if range.is_empty() {
        return;
    }
    let (from, to) = (times[range.start], times[range.end - 1]);
    for at in within(times, from - CLOSING, to + CLOSING) {
        let away = (from - times[at]).max(times[at] - to).max(0.0);
        turn(&mut poses[at], 1.0 - smoothstep(away / CLOSING));
    }
}

fn turn(pose: &mut Pose, (joints, grasp): (&[JointId], &Pose), share: f64) {
    for joint in joints {
        let at = joint.as_usize();
        let held = grasp.rotations[at];
        pose.rotations[at] = if share < 1.0 { slerp(pose.rotations[at], held, share) } else { held };
    }
}

/// All joints that hang on `hand`.
fn below(skeleton: &Skeleton, hand: JointId) -> Vec<JointId> {
    let mut hangs = vec![false; skeleton.joints.len()];
    for (at, joint) in skeleton.joints.iter().enumerate() {
        hangs[at] = joint.parent.is_some_and(|parent| parent == hand || hangs[parent.as_usize()]);
    }
    (0..hangs.len()).filter(|at| hangs[*at]).map(JointId::from_usize).collect()
}
