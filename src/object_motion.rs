//! Objects along time: who has each of them when, without gap or jump, and where it is at any instant.
//!
//! An object is where its course says until somebody grasps it; carried, it is rigid to the frame of the hands (middle
//! between them, heading across from the left to the right one; of two carriers from the middle of the first one's hands
//! to the second one's); released, it stays there until it is grasped again. What it is rigid to is taken at the grasp
//! itself, so that its pose is continuous there. Source: Kim et al. 2009, §4.3 (objects).

mod asked;
mod hands;
mod possession;

use glam::{DQuat, DVec3};

use crate::clip::facing::facing;
use crate::clip::working::WORKING_STEP;
use crate::constraint::Moment;
use crate::geometry::{plan_of, yaw};
use crate::index::{CharacterId, JointId, ObjectId};
use crate::limb::Limb;
use crate::object::{Carry, Course, ObjectPose, hand_overs, same_hands};
use crate::scene::Scene;
use crate::skeleton::{JointFrame, Pose, Skeleton};
use crate::touch::{Hand, WristPose, arm_of};

use hands::Hands;

pub use asked::Objects;
pub use hands::{BodyHands, LEAST_WIDTH, hands_stay_apart};
pub use possession::{Possession, Possessor, possession_before, possessions};

/// Somebody grasps what somebody else still has: so much is taken for rounding of soft times, and the second has it then,
/// seconds.
pub const HAND_OVER: f64 = WORKING_STEP;

/// Moments this near are one, seconds.
const SAME_MOMENT: f64 = 1e-9;

/// How everybody moves, before or after an edit.
pub trait Performance {
    /// Scene time of a fractional frame of a character's track, seconds.
    fn time(&self, who: CharacterId, frame: f64) -> f64;

    /// Frame of a character's track at a scene time, held before the first and after the last.
    fn frame(&self, who: CharacterId, seconds: f64) -> f64;

    /// Pose at a fractional frame of a character's track.
    fn pose(&self, who: CharacterId, frame: f64) -> Pose;

    /// The hands at a fractional frame of a character's track, who has some.
    fn hands(&self, scene: &Scene, who: CharacterId, frame: f64) -> BodyHands {
        BodyHands::of(skeleton_of(scene, who), &self.pose(who, frame))
    }

    /// Whether hands tell the heading of what they carry, from one frame of the track of whoever says when to another.
    fn tells_heading(&self, scene: &Scene, carry: usize, frames: [f64; 2]) -> bool
    where
        Self: Sized,
    {
        hands_stay_apart(scene, self, carry, frames)
    }
}

/// Everybody as before the edit: all tracks start at scene time 0.
#[derive(Clone, Copy)]
pub struct AtRest<'a>(pub &'a Scene);

impl Performance for AtRest<'_> {
    fn time(&self, _: CharacterId, frame: f64) -> f64 {
        frame * WORKING_STEP
    }

    fn frame(&self, who: CharacterId, seconds: f64) -> f64 {
        let track = &self.0.characters[who.as_usize()].track;
        let last = track.frame_count() as f64 - 1.0 + track.overhang();
        (seconds / WORKING_STEP).clamp(0.0, last)
    }

    fn pose(&self, who: CharacterId, frame: f64) -> Pose {
        self.0.characters[who.as_usize()].track.pose(frame)
    }
}

/// What decides where an object is.
#[derive(Clone, Debug, PartialEq)]
pub enum Owner {
    /// Its own course.
    Itself,
    /// The hands of whoever carries it.
    Carried(Hold),
    /// Nobody: it stays where this carry ended.
    Left {
        /// Position in [`Scene::carries`].
        carry: usize,
        /// Where.
        pose: ObjectPose,
    },
}

/// How an object is held.
#[derive(Clone, Debug, PartialEq)]
pub struct Hold {
    /// Position in [`Scene::carries`].
    pub carry: usize,
    /// The object in the frame of the hands.
    pub attachment: ObjectPose,
    /// Whether the hands tell the heading; otherwise they come too near to each other, and the first carrier's body does.
    pub by_hands: bool,
    /// Where each hand holds it, carrier by carrier, left before right.
    pub grips: Vec<Grip>,
}

/// Where a hand holds an object: as at the grasp, or as near to that as it touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// Whose.
    pub character: CharacterId,
    /// The hand.
    pub joint: JointId,
    /// Of the wrist, in the object's axes, metres: near enough for the hand to touch it.
    pub point: DVec3,
    /// From the axes of the hand to the object's.
    pub rotation: DQuat,
}

/// An owner and how long.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// Scene time, seconds; −∞ at first.
    pub from: f64,
    /// Scene time, seconds: where the next span begins, ∞ at last.
    pub to: f64,
    /// Who.
    pub owner: Owner,
}

/// An object along time.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectMotion {
    /// Which.
    pub object: ObjectId,
    /// In the order of time, without gap.
    pub spans: Vec<Span>,
}

/// Somebody grasps an object that another carry still has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// The carry that has it, by position in [`Scene::carries`].
    pub first: usize,
    /// The one that begins too early.
    pub second: usize,
    /// By how much, seconds.
    pub seconds: f64,
}

/// Scene time of a moment, seconds.
pub fn moment_time(scene: &Scene, performance: &impl Performance, moment: &Moment) -> f64 {
    performance.time(moment.character, scene.frame_of(moment))
}

/// The first carry that begins before the one before it of the same object has ended, if any.
pub fn overlap(scene: &Scene, performance: &impl Performance) -> Option<Overlap> {
    hand_overs(&scene.carries).find_map(|(first, second)| {
        let released = moment_time(scene, performance, &scene.carries[first].during.1);
        let seconds = released - moment_time(scene, performance, &scene.carries[second].during.0);
        (seconds > HAND_OVER).then_some(Overlap { first, second, seconds })
    })
}

/// Two things that somebody carries at the same time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoLoads {
    /// Who has only two hands.
    pub character: CharacterId,
    /// Both carries, in the order of the file.
    pub overlap: Overlap,
}

/// The first carry that asks for the hands of somebody who still carries something else, if any. Cost: linear in carries, but for
/// those of one character.
pub fn two_loads(scene: &Scene, performance: &impl Performance) -> Option<TwoLoads> {
    let during = |carry: usize| {
        let (grasp, release) = &scene.carries[carry].during;
        [grasp, release].map(|moment| moment_time(scene, performance, moment))
    };
    same_hands(&scene.carries).into_iter().find_map(|(first, second, character)| {
        let seconds = both(during(first), during(second));
        (seconds > HAND_OVER).then_some(TwoLoads { character, overlap: Overlap { first, second, seconds } })
    })
}

/// For how long two carries last at once, seconds; 0 and less where they do not.
pub fn both([grasp, release]: [f64; 2], [begins, ends]: [f64; 2]) -> f64 {
    release.min(ends) - grasp.max(begins)
}

/// All objects of a scene along time. Cost: linear in working frames of carries and joints.
///
/// Carries that overlap are cut short where the next begins, in the order of the file; [`overlap`] finds them.
pub fn object_motions(scene: &Scene, performance: &impl Performance) -> Vec<ObjectMotion> {
    let mut carries: Vec<Vec<usize>> = vec![Vec::new(); scene.objects.len()];
    for (index, carry) in scene.carries.iter().enumerate() {
        carries[carry.object.as_usize()].push(index);
    }
    let ids = (0..scene.objects.len()).map(ObjectId::from_usize);
    let motion = |(object, own): (ObjectId, Vec<usize>)| {
        motion_of((scene, performance), object, &carry_times(scene, performance, &own))
    };
    ids.zip(carries).map(motion).collect()
}

/// Carries, by position in the scene, with the times of their grasps and releases.
fn carry_times(scene: &Scene, performance: &impl Performance, carries: &[usize]) -> Vec<(usize, [f64; 2])> {
    let times = |carry: &usize| {
        let (grasp, release) = &scene.carries[*carry].during;
        (*carry, [grasp, release].map(|moment| moment_time(scene, performance, moment)))
    };
    carries.iter().map(times).collect()
}

/// The motion of one object, whose carries, by position in [`Scene::carries`] and rising, begin and end at these times.
fn motion_of(
    (scene, performance): (&Scene, &impl Performance),
    object: ObjectId,
    carries: &[(usize, [f64; 2])],
) -> ObjectMotion {
    let mut motion = ObjectMotion { object, spans: Vec::new() };
    for Possession { from, to, by } in possessions(carries) {
        let owner = match by {
            Possessor::Itself => Owner::Itself,
            Possessor::Carried(carry) => {
                let pose = motion.pose_in(motion.spans.len() - 1, (scene, performance), from);
                let known = carries.binary_search_by_key(&carry, |(index, _)| *index);
                let released = known.map_or(to, |known| carries[known].1[1].max(from));
                Owner::Carried(Hold::at(scene, performance, (carry, [from, released]), pose))
            }
            Possessor::Left(carry) => {
                let pose = motion.pose_in(motion.spans.len() - 1, (scene, performance), from);
                Owner::Left { carry, pose }
            }
        };
        motion.spans.push(Span { from, to, owner });
    }
    motion
}

impl ObjectMotion {
    fn pose_in(
        &self,
        span: usize,
        (scene, performance): (&Scene, &impl Performance),
        seconds: f64,
    ) -> ObjectPose {
        match &self.spans[span].owner {
            Owner::Itself => scene.objects[self.object.as_usize()].course.pose_at(seconds),
            Owner::Carried(hold) => hold.pose_at(&scene.carries[hold.carry], (scene, performance), seconds),
            Owner::Left { pose, .. } => *pose,
        }
    }

    /// Whether the object is ever elsewhere than at first: it has keys, or somebody carries it.
    pub fn moves(&self, scene: &Scene) -> bool {
        self.spans.len() > 1 || matches!(scene.objects[self.object.as_usize()].course, Course::Keys(_))
    }

    /// The span that holds at a scene time; at a hand-over the one that begins.
    pub fn span_at(&self, seconds: f64) -> &Span {
        &self.spans[self.spans.partition_point(|span| span.from <= seconds).saturating_sub(1)]
    }

    /// Pose at a scene time. `performance`: the one the motion was made of. Cost: linear in joints.
    pub fn pose_at(&self, scene: &Scene, performance: &impl Performance, seconds: f64) -> ObjectPose {
        let span = self.spans.partition_point(|span| span.from <= seconds).saturating_sub(1);
        self.pose_in(span, (scene, performance), seconds)
    }
}

impl Hold {
    /// The hold of the carry `index` from one time to another of an object that is at `pose` at first.
    fn at(
        scene: &Scene,
        performance: &impl Performance,
        (index, [from, to]): (usize, [f64; 2]),
        pose: ObjectPose,
    ) -> Self {
        let carry = &scene.carries[index];
        let frames = [from, to].map(|seconds| performance.frame(carry.during.0.character, seconds));
        let by_hands = performance.tells_heading(scene, index, frames);
        let hands = Hands::at(scene, performance, carry, from);
        let grips = hands.grips.iter().map(|(character, joint, _)| {
            let body = performance.pose(*character, performance.frame(*character, from));
            Grip::new((scene, carry), (*character, *joint), &body, &pose)
        });
        let attachment = hands.frame(by_hands).relative(&pose);
        Self { carry: index, attachment, by_hands, grips: grips.collect() }
    }

    fn pose_at(
        &self,
        carry: &Carry,
        (scene, performance): (&Scene, &impl Performance),
        seconds: f64,
    ) -> ObjectPose {
        Hands::at(scene, performance, carry, seconds).frame(self.by_hands).compose(&self.attachment)
    }
}

impl Grip {
    /// Of a hand of somebody who is as in `body` at the grasp, of an object that is at `pose` then.
    fn new(
        (scene, carry): (&Scene, &Carry),
        (character, joint): (CharacterId, JointId),
        body: &Pose,
        pose: &ObjectPose,
    ) -> Self {
        let skeleton = skeleton_of(scene, character);
        let frames = skeleton.forward_kinematics(body);
        let arm = arm_of(skeleton, &frames, joint).map(|arm| Limb {
            upper: pose.local(arm.upper),
            middle: pose.local(arm.middle),
            lower: pose.local(arm.lower),
        });
        let wrist = wrist_at(pose, &frames[joint.as_usize()]);
        let size = scene.objects[carry.object.as_usize()].size;
        let WristPose { position, rotation } =
            Hand::of(skeleton, &frames, joint).touching(size, arm.as_ref(), &wrist);
        Self { character, joint, point: position, rotation }
    }

    /// How far the hand of somebody who is as in `body` is from where it holds an object that is at `pose`, or its nearest point
    /// from the object, whichever is more, metres. Cost: linear in joints.
    pub fn miss(&self, (scene, object): (&Scene, ObjectId), body: &Pose, pose: &ObjectPose) -> f64 {
        let skeleton = skeleton_of(scene, self.character);
        let frames = skeleton.forward_kinematics(body);
        let wrist = wrist_at(pose, &frames[self.joint.as_usize()]);
        let size = scene.objects[object.as_usize()].size;
        let off = Hand::of(skeleton, &frames, self.joint).distance(size, &wrist);
        off.max(wrist.position.distance(self.point))
    }
}

/// A wrist in the axes of an object that is at `pose`.
fn wrist_at(pose: &ObjectPose, wrist: &JointFrame) -> WristPose {
    WristPose { position: pose.local(wrist.position), rotation: yaw(pose.facing).inverse() * wrist.rotation }
}

/// Skeleton of a character.
pub fn skeleton_of(scene: &Scene, who: CharacterId) -> &Skeleton {
    &scene.characters[who.as_usize()].track.clips[0].clip.skeleton
}

/// Facing of a body; where it shows none, that of its root.
fn heading(skeleton: &Skeleton, frames: &[JointFrame]) -> f64 {
    facing(skeleton, frames).unwrap_or_else(|| plan_of(frames[0].rotation * DVec3::Z).arg())
}
