//! Hips of somebody who leans, where hard constraints hold them.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::clip::contacts::runs;
use crate::constraint::{Moment, When};
use crate::edit::Moved;
use crate::full_body::hierarchical::spread;
use crate::full_body::{Effector, Target};
use crate::geometry::{exp, log};
use crate::index::{CharacterId, JointId};
use crate::object_motion::moment_time;
use crate::reach::{Stage, within};
use crate::skeleton::Pose;
use crate::ties::held_by;

/// Seconds in which hips come to where they are held, and go on: quicker they would push themselves.
const EASE: f64 = 0.6;

/// The root of `who`, who was in the poses `before` and leans in the poses `now` (one a sample of `times`), as an end that must be
/// where and as it was wherever a hard constraint holds place or facing; about these samples it goes there and leaves again smoothly.
/// The whole turn is taken back: a pelvis that leaned above feet that stand would not be in their reach.
pub(super) fn hips(
    stage: &Stage<'_, Moved<'_>>,
    who: CharacterId,
    times: &[f64],
    (before, now): (&[Pose], &[Pose]),
) -> Vec<Effector> {
    let missing = |at: usize| {
        let (was, is) = (&before[at], &now[at]);
        (at, [was.root - is.root, log(was.rotations[0] * is.rotations[0].inverse())])
    };
    let exact: Vec<(usize, [DVec3; 2])> = held(stage, who, times).into_iter().map(missing).collect();
    let displacements = spread(times, &exact, EASE);
    let moves: Vec<bool> = displacements.iter().map(|own| *own != [DVec3::ZERO; 2]).collect();
    let target = |at: usize| {
        let [shift, turn] = displacements[at];
        let rotation = (exp(turn) * now[at].rotations[0]).normalize();
        Target { position: now[at].root + shift, rotation: Some(rotation) }
    };
    let effector = |(first, last): (usize, usize)| Effector {
        joint: JointId(0),
        first,
        targets: (first..=last).map(target).collect(),
        holds: false,
    };
    runs(&moves).into_iter().map(effector).collect()
}

/// Hips this near are where they must be, metres.
const THERE: f64 = 1e-7;

/// `hips` at the height that legs let them have in `poses`, which were to have them: constraints hold places on the ground plan only.
/// `None` where all are there.
pub(super) fn within_legs(hips: &[Effector], poses: &[Pose]) -> Option<Vec<Effector>> {
    let mut lower = hips.to_vec();
    let mut any = false;
    for end in &mut lower {
        for (target, pose) in end.targets.iter_mut().zip(&poses[end.first..]) {
            any |= target.position.distance(pose.root) > THERE;
            target.position.y = target.position.y.min(pose.root.y);
        }
    }
    any.then_some(lower)
}

/// Samples at which a hard constraint holds somebody's place or facing.
fn held(stage: &Stage<'_, Moved<'_>>, who: CharacterId, times: &[f64]) -> BTreeSet<usize> {
    let samples = |when: &When| {
        let time = |moment: &Moment| moment_time(stage.scene, stage.performance, moment);
        match when {
            When::At(moment) => within(times, time(moment), time(moment)),
            When::During(from, to) => within(times, time(from), time(to)),
        }
    };
    let holds = stage.ties.holds[who.as_usize()].iter();
    let whens = holds.flat_map(|index| held_by(&stage.scene.constraints[*index].kind));
    whens.filter(|when| when.character() == who).flat_map(samples).collect()
}
