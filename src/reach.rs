//! What hands and other joints must reach, sample by sample, and by how much a motion misses it.
//!
//! Targets are those of the full body: the hands of whoever carries an object, where they hold it, and the end effectors of
//! the scene. Samples are scene times of one character, the frames of the clock and [`constrained_times`] between them.

mod missed;

use std::ops::Range;

use glam::{DQuat, DVec3};

use crate::constraint::{Moment, When};
use crate::effector::{EffectorTarget, EndEffector, Orientation};
use crate::geometry::yaw;
use crate::index::{CharacterId, JointId};
use crate::meeting::{is_hand, meeting_point};
use crate::object_motion::{AtRest, ObjectMotion, Owner, Performance, moment_time, skeleton_of};
use crate::scene::Scene;
use crate::skeleton::JointFrame;
use crate::ties::Ties;

pub use missed::{carry_residuals, carry_residuals_of, effector_residual, effector_residuals};

/// Samples this near to a moment are at it, seconds.
const AT_MOMENT: f64 = 1e-7;

/// What comes nearer than this is reached, metres.
pub const REACHED: f64 = 1e-3;

/// What asks for a joint to be somewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A carry, by position in [`Scene::carries`].
    Carry(usize),
    /// An end effector, by position in [`Scene::end_effectors`].
    EndEffector(usize),
}

/// Where a joint of a character must be over a stretch of its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTarget {
    /// What asks for it.
    pub source: Source,
    /// Which joint.
    pub joint: JointId,
    /// Which samples.
    pub samples: Range<usize>,
    /// In the world, one a sample of the stretch, metres.
    pub positions: Vec<DVec3>,
    /// From the joint's axes to the world's, one a sample; empty: not held.
    pub rotations: Vec<DQuat>,
}

/// A scene with its objects, as somebody performs it.
#[derive(Clone, Copy)]
pub struct Stage<'a, P> {
    /// The scene.
    pub scene: &'a Scene,
    /// How everybody moves before the full body: what object motions were made of.
    pub performance: &'a P,
    /// The objects along time.
    pub objects: &'a [ObjectMotion],
    /// Who is tied to what in the scene.
    pub ties: &'a Ties,
}

impl<P> Stage<'_, P> {
    /// End effectors of a character's own and those that reach it, with their positions in the scene.
    fn effectors(&self, who: CharacterId) -> impl Iterator<Item = (usize, &EndEffector)> {
        self.ties.effectors[who.as_usize()].iter().map(|index| (*index, &self.scene.end_effectors[*index]))
    }
}

/// Everybody as corrected so far.
#[derive(Clone, Copy)]
pub struct Others<'a, Q> {
    /// How they move: corrected where they are, else as before the full body.
    pub performance: &'a Q,
    /// Who is corrected.
    pub corrected: &'a dyn Fn(CharacterId) -> bool,
}

/// Whose bodies a character must know to reach them: of those it reaches, and of those whose hands it comes to meet; in the
/// order of the file, some more than once. Cost: linear in what is tied to it.
pub fn partners(scene: &Scene, ties: &Ties, who: CharacterId) -> Vec<CharacterId> {
    let partner = |effector: &EndEffector| {
        let EffectorTarget::Joint { character, .. } = effector.target else {
            return None;
        };
        let reach = Reach { effector, own: effector.when.character() };
        let met = character == who && reach.meets(scene);
        if reach.own == who { Some(character) } else { met.then_some(reach.own) }
    };
    ties.effectors[who.as_usize()].iter().filter_map(|index| partner(&scene.end_effectors[*index])).collect()
}

/// Scene times of all moments that ask for something of a character's joints, hold its hips while it leans, or at which others reach
/// its joints; rising.
/// Cost: linear in what is tied to it.
pub fn constrained_times(
    (scene, ties): (&Scene, &Ties),
    performance: &impl Performance,
    who: CharacterId,
) -> Vec<f64> {
    let effectors = ties.effectors[who.as_usize()].iter().map(|index| &scene.end_effectors[*index]);
    let own = effectors.flat_map(|effector| moments_of(effector, who));
    let carries = ties.carries[who.as_usize()].iter().map(|index| &scene.carries[*index]);
    let holds = ties.holds[who.as_usize()].iter().flat_map(|index| scene.constraints[*index].kind.moments());
    let all = own
        .chain(carries.flat_map(|carry| [&carry.during.0, &carry.during.1]))
        .chain(holds.filter(|moment| moment.character == who));
    let mut times: Vec<f64> = all.map(|moment| moment_time(scene, performance, moment)).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// The moments of `effector` at which it asks for something of a character, or reaches it.
fn moments_of(effector: &EndEffector, who: CharacterId) -> impl Iterator<Item = &Moment> {
    let reached = matches!(effector.target,
        EffectorTarget::Joint { character, when: None, .. } if character == who);
    effector.moments().into_iter().filter(move |moment| reached || moment.character == who)
}

/// Targets of a character's hands while they carry: of the wrists, turned with what they carry. `samples`: scene times,
/// rising. Cost: linear in samples and joints.
pub fn carry_targets<P: Performance>(
    stage: &Stage<'_, P>,
    who: CharacterId,
    samples: &[f64],
) -> Vec<JointTarget> {
    let mut targets = Vec::new();
    for object in stage.ties.objects(stage.scene, who) {
        let motion = &stage.objects[object.as_usize()];
        for span in &motion.spans {
            let Owner::Carried(hold) = &span.owner else {
                continue;
            };
            let range = within(samples, span.from, span.to);
            let own = hold.grips.iter().filter(|grip| grip.character == who);
            if range.is_empty() || own.clone().next().is_none() {
                continue;
            }
            let times = &samples[range.clone()];
            let poses: Vec<_> =
                times.iter().map(|time| motion.pose_at(stage.scene, stage.performance, *time)).collect();
            targets.extend(own.map(|grip| JointTarget {
                source: Source::Carry(hold.carry),
                joint: grip.joint,
                samples: range.clone(),
                positions: poses.iter().map(|pose| pose.apply(grip.point)).collect(),
                rotations: poses.iter().map(|pose| yaw(pose.facing) * grip.rotation).collect(),
            }));
        }
    }
    targets
}

/// Targets of a character's end effectors, and of its hands that meet those of others: where those are in `others`. Hands
/// of whom nobody is corrected yet meet in the middle. `samples`: scene times, rising, all [`constrained_times`] among
/// them. Cost: linear in samples and joints.
pub fn effector_targets<P: Performance, Q: Performance>(
    stage: &Stage<'_, P>,
    others: &Others<'_, Q>,
    who: CharacterId,
    samples: &[f64],
) -> Vec<JointTarget> {
    let mut targets = Vec::new();
    let performance = AtRest(stage.scene);
    let rest = at_rest(stage, &performance);
    for (index, effector) in stage.effectors(who) {
        let source = Source::EndEffector(index);
        let reach = Reach { effector, own: effector.when.character() };
        if reach.own == who {
            let [from, to] = ends(stage, &effector.when);
            let range = within(samples, from, to);
            let aims = samples[range.clone()].iter().map(|time| reach.aim((stage, &rest), others, *time));
            let (positions, rotations): (Vec<DVec3>, Vec<Option<DQuat>>) = aims.unzip();
            let rotations = rotations.into_iter().flatten().collect();
            targets.push(JointTarget { source, joint: effector.joint, samples: range, positions, rotations });
        }
        if let Some((joint, [from, to])) = reach.met_by(stage, who) {
            let range = within(samples, from, to);
            let aims = samples[range.clone()].iter();
            let positions = aims.map(|time| reach.met_at(stage, others, reach.own_time(stage, *time)));
            let (positions, rotations) = (positions.collect(), Vec::new());
            targets.push(JointTarget { source, joint, samples: range, positions, rotations });
        }
    }
    targets.retain(|target| !target.samples.is_empty());
    targets
}

/// By how much a joint misses what it must reach, the most over an interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Miss {
    /// Of its place, metres.
    pub metres: f64,
    /// Of how it is turned, radians; `None` where that is not held.
    pub radians: Option<f64>,
}

/// The scene before any edit, performed as captured.
fn at_rest<'a, P>(stage: &Stage<'a, P>, rest: &'a AtRest<'a>) -> Stage<'a, AtRest<'a>> {
    Stage { scene: stage.scene, performance: rest, objects: &stage.ties.rest_objects, ties: stage.ties }
}

/// Samples from one time to another, both included.
pub fn within(samples: &[f64], from: f64, to: f64) -> Range<usize> {
    let first = samples.partition_point(|time| *time < from - AT_MOMENT);
    first..samples.partition_point(|time| *time <= to + AT_MOMENT).max(first)
}

/// Scene times of a moment, twice, or of both ends of an interval.
fn ends<P: Performance>(stage: &Stage<'_, P>, when: &When) -> [f64; 2] {
    let time = |moment| moment_time(stage.scene, stage.performance, moment);
    match when {
        When::At(moment) => [time(moment); 2],
        When::During(from, to) => [time(from), time(to)],
    }
}

/// Frames of the track likewise.
fn end_frames(scene: &Scene, when: &When) -> [f64; 2] {
    match when {
        When::At(moment) => [scene.frame_of(moment); 2],
        When::During(from, to) => [scene.frame_of(from), scene.frame_of(to)],
    }
}

fn joint_at(
    (scene, performance): (&Scene, &impl Performance),
    who: CharacterId,
    joint: JointId,
    time: f64,
) -> JointFrame {
    let pose = performance.pose(who, performance.frame(who, time));
    skeleton_of(scene, who).forward_kinematics(&pose)[joint.as_usize()]
}

/// The time of `other` that goes with a time of `when`: at the same share of the frames of an interval.
fn paired_time<P: Performance>(stage: &Stage<'_, P>, (when, other): (&When, &When), time: f64) -> f64 {
    let [from, to] = end_frames(stage.scene, when);
    let [start, end] = end_frames(stage.scene, other);
    let frame = stage.performance.frame(when.character(), time);
    let share = if to > from { ((frame - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
    stage.performance.time(other.character(), start + share * (end - start))
}

/// An end effector and whose it is.
struct Reach<'a> {
    effector: &'a EndEffector,
    own: CharacterId,
}

impl Reach<'_> {
    /// What is reached at an own time, with its axes, joints of others as in `result`.
    fn partner<P: Performance>(
        &self,
        stage: &Stage<'_, P>,
        result: &impl Performance,
        time: f64,
    ) -> JointFrame {
        match &self.effector.target {
            EffectorTarget::World(position) => JointFrame { position: *position, rotation: DQuat::IDENTITY },
            EffectorTarget::Object { object, point } => {
                let pose = stage.objects[object.as_usize()].pose_at(stage.scene, stage.performance, time);
                JointFrame { position: pose.apply(*point), rotation: yaw(pose.facing) }
            }
            EffectorTarget::Joint { character, joint, point, when } => {
                let theirs = when
                    .as_ref()
                    .map_or(time, |other| paired_time(stage, (&self.effector.when, other), time));
                let reached = joint_at((stage.scene, result), *character, *joint, theirs);
                JointFrame { position: reached.position + reached.rotation * *point, ..reached }
            }
        }
    }

    /// Where the joint must be at an own time, and how turned where that is held.
    fn aim<P: Performance, Q: Performance>(
        &self,
        (stage, rest): (&Stage<'_, P>, &Stage<'_, AtRest<'_>>),
        others: &Others<'_, Q>,
        time: f64,
    ) -> (DVec3, Option<DQuat>) {
        let partner = self.partner(stage, others.performance, time);
        let comes = match self.effector.target {
            EffectorTarget::Joint { character, .. } => {
                self.meets(stage.scene) && !(others.corrected)(character)
            }
            _ => false,
        };
        let position = if comes { self.middle(stage, time) } else { partner.position };
        (position, self.rotation(stage, rest, (partner.rotation, time)))
    }

    /// Where the hand that comes to meet this one must be at a time of this one: where this one is, once that is told.
    fn met_at<P: Performance, Q: Performance>(
        &self,
        stage: &Stage<'_, P>,
        others: &Others<'_, Q>,
        time: f64,
    ) -> DVec3 {
        if (others.corrected)(self.own) {
            joint_at((stage.scene, others.performance), self.own, self.effector.joint, time).position
        } else {
            self.middle(stage, time)
        }
    }

    /// Where two hands meet, at an own time, as nobody is corrected.
    fn middle<P: Performance>(&self, stage: &Stage<'_, P>, time: f64) -> DVec3 {
        let (scene, own) = (stage.scene, (self.own, self.effector.joint, time));
        let EffectorTarget::Joint { character, joint, when, .. } = &self.effector.target else {
            return self.partner(stage, stage.performance, time).position;
        };
        let theirs =
            when.as_ref().map_or(time, |other| paired_time(stage, (&self.effector.when, other), time));
        meeting_point((scene, stage.performance), [own, (*character, *joint, theirs)])
    }

    /// Whether the joint is a hand and what it reaches another, which comes to meet it.
    fn meets(&self, scene: &Scene) -> bool {
        match &self.effector.target {
            EffectorTarget::Joint { character, joint, point, .. } => {
                let hands =
                    is_hand(scene, self.own, self.effector.joint) && is_hand(scene, *character, *joint);
                hands && *point == DVec3::ZERO
            }
            _ => false,
        }
    }

    /// How the joint must be turned at an own time, where that is held and what it reaches has the axes `partner`.
    fn rotation<P: Performance>(
        &self,
        stage: &Stage<'_, P>,
        rest: &Stage<'_, AtRest<'_>>,
        (partner, time): (DQuat, f64),
    ) -> Option<DQuat> {
        match self.effector.orientation? {
            Orientation::Given(turn) => Some(partner * turn),
            Orientation::AsBefore => {
                let before = rest.performance.time(self.own, stage.performance.frame(self.own, time));
                let own =
                    joint_at((rest.scene, rest.performance), self.own, self.effector.joint, before).rotation;
                let reached = self.partner(rest, rest.performance, before).rotation;
                Some(partner * (reached.inverse() * own))
            }
        }
    }

    /// The hand of `who` that comes to meet the joint, and from when to when.
    fn met_by<P: Performance>(&self, stage: &Stage<'_, P>, who: CharacterId) -> Option<(JointId, [f64; 2])> {
        let EffectorTarget::Joint { character, joint, when, .. } = &self.effector.target else {
            return None;
        };
        let times = ends(stage, when.as_ref().unwrap_or(&self.effector.when));
        (*character == who && self.meets(stage.scene)).then_some((*joint, times))
    }

    /// The own time that goes with a time of the partner.
    fn own_time<P: Performance>(&self, stage: &Stage<'_, P>, time: f64) -> f64 {
        match &self.effector.target {
            EffectorTarget::Joint { when: Some(other), .. } => {
                paired_time(stage, (other, &self.effector.when), time)
            }
            _ => time,
        }
    }
}
