//! By how much a motion misses what joints must reach.

use super::{Miss, Reach, Stage, at_rest, constrained_times, ends, joint_at};
use crate::geometry::log;
use crate::index::CharacterId;
use crate::object_motion::{AtRest, Owner, Performance};

/// By how much the joint of the end effector at `index` in `result` misses what it reaches: over an interval at both ends, on all
/// ticks of the scene's clock within, and at all moments within that constrain the same character. Cost: linear in samples
/// and joints.
pub fn effector_residual<P: Performance>(
    stage: &Stage<'_, P>,
    result: &impl Performance,
    index: usize,
) -> Miss {
    let effector = &stage.scene.end_effectors[index];
    let rest = AtRest(stage.scene);
    let rest = at_rest(stage, &rest);
    let reach = Reach { effector, own: effector.when.character() };
    let mut miss = Miss::default();
    for time in samples(stage, ends(stage, &effector.when), reach.own) {
        let own = joint_at((stage.scene, result), reach.own, effector.joint, time);
        let partner = reach.partner(stage, result, time);
        miss.metres = miss.metres.max(own.position.distance(partner.position));
        if let Some(rotation) = reach.rotation(stage, &rest, (partner.rotation, time)) {
            let off = log(own.rotation.inverse() * rotation).length();
            miss.radians = Some(miss.radians.unwrap_or(0.0).max(off));
        }
    }
    miss
}

/// [`effector_residual`] of all end effectors of the scene.
pub fn effector_residuals<P: Performance>(stage: &Stage<'_, P>, result: &impl Performance) -> Vec<Miss> {
    (0..stage.scene.end_effectors.len()).map(|index| effector_residual(stage, result, index)).collect()
}

/// Largest distance of a hand of `who` in `result` from where it holds what it carries, or of its nearest point from that, whichever is
/// more, for each carry that it has a part in, metres: at both ends, on all ticks of the scene's clock within, and at all moments within that constrain the same carrier.
/// Cost: linear in samples and joints.
pub fn carry_residuals_of<P: Performance>(
    stage: &Stage<'_, P>,
    result: &impl Performance,
    who: CharacterId,
) -> Vec<(usize, f64)> {
    let mut found = Vec::new();
    for object in stage.ties.objects(stage.scene, who) {
        let motion = &stage.objects[object.as_usize()];
        for span in &motion.spans {
            let Owner::Carried(hold) = &span.owner else {
                continue;
            };
            let own: Vec<_> = hold.grips.iter().filter(|grip| grip.character == who).collect();
            if own.is_empty() {
                continue;
            }
            let mut worst = 0.0_f64;
            for time in samples(stage, [span.from, span.to], who) {
                let pose = motion.pose_at(stage.scene, stage.performance, time);
                let body = result.pose(who, result.frame(who, time));
                let misses = own.iter().map(|grip| grip.miss((stage.scene, object), &body, &pose));
                worst = misses.fold(worst, f64::max);
            }
            found.push((hold.carry, worst));
        }
    }
    found
}

/// The largest of [`carry_residuals_of`] of all who have a part in it, for each carry of the scene.
pub fn carry_residuals<P: Performance>(stage: &Stage<'_, P>, result: &impl Performance) -> Vec<f64> {
    let mut worst = vec![0.0_f64; stage.scene.carries.len()];
    for who in (0..stage.scene.characters.len()).map(CharacterId::from_usize) {
        for (carry, metres) in carry_residuals_of(stage, result, who) {
            worst[carry] = worst[carry].max(metres);
        }
    }
    worst
}

/// Both ends of an interval, the ticks of the scene's clock between them, and what else constrains a character there.
fn samples<P: Performance>(stage: &Stage<'_, P>, [from, to]: [f64; 2], who: CharacterId) -> Vec<f64> {
    let fps = stage.scene.fps;
    let first = (from * fps).ceil();
    let ticks = (0..).map(|k| (first + f64::from(k)) / fps).take_while(|time| *time < to);
    let moments = constrained_times((stage.scene, stage.ties), stage.performance, who).into_iter();
    let between = moments.filter(|time| (from..to).contains(time));
    [from, to].into_iter().chain(ticks).chain(between).collect()
}
