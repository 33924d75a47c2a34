//! Hips of somebody who leans, where hard constraints hold their place.

use std::collections::BTreeMap;

use crate::clip::facing::facing;
use crate::constraint::When;
use crate::edit::Moved;
use crate::full_body::{Effector, Target};
use crate::geometry::{wrap, yaw};
use crate::index::{CharacterId, JointId};
use crate::object_motion::{moment_time, skeleton_of};
use crate::reach::{Stage, within};
use crate::skeleton::{Pose, Skeleton};
use crate::ties::held_by;

/// What of somebody is held at a sample.
#[derive(Clone, Copy, Default)]
struct Held {
    place: bool,
    facing: bool,
}

/// The root of `who`, who was in the poses `before` and leans in the poses `now` (one a sample of `times`), as an end that must be
/// where it was, seen from above, wherever a hard constraint holds the place, and face as it did wherever one holds that.
pub(super) fn hips(
    stage: &Stage<'_, Moved<'_>>,
    who: CharacterId,
    times: &[f64],
    (before, now): (&[Pose], &[Pose]),
) -> Vec<Effector> {
    let skeleton = skeleton_of(stage.scene, who);
    let effector = |(at, held): (usize, Held)| {
        let (was, is) = (&before[at], &now[at]);
        let position = if held.place { was.root.with_y(is.root.y) } else { is.root };
        let rotation = if held.facing { turned_back(skeleton, was, is) } else { None };
        Effector { joint: JointId(0), first: at, targets: vec![Target { position, rotation }], holds: false }
    };
    held(stage, who, times).into_iter().map(effector).collect()
}

/// World rotation of the root with which the body in the pose `is` faces as in the pose `was`; `None` where hips show no facing.
fn turned_back(skeleton: &Skeleton, was: &Pose, is: &Pose) -> Option<glam::DQuat> {
    let shown = |pose: &Pose| facing(skeleton, &skeleton.forward_kinematics(pose));
    Some(yaw(wrap(shown(was)? - shown(is)?)) * is.rotations[0])
}

fn held(stage: &Stage<'_, Moved<'_>>, who: CharacterId, times: &[f64]) -> BTreeMap<usize, Held> {
    let mut samples: BTreeMap<usize, Held> = BTreeMap::new();
    let time = |moment| moment_time(stage.scene, stage.performance, moment);
    for index in &stage.ties.holds[who.as_usize()] {
        let (whens, place, facing) = held_by(&stage.scene.constraints[*index].kind);
        for when in whens.into_iter().filter(|when| when.character() == who) {
            let [from, to] = match when {
                When::At(moment) => [time(moment); 2],
                When::During(from, to) => [time(from), time(to)],
            };
            for at in within(times, from, to) {
                let own = samples.entry(at).or_default();
                *own = Held { place: own.place || place, facing: own.facing || facing };
            }
        }
    }
    samples
}
