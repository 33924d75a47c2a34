//! The hands of those who carry something.

use glam::DVec3;

use super::{Performance, heading};
use crate::geometry::{plan_of, yaw};
use crate::index::{CharacterId, JointId, floor_index};
use crate::object::{Carry, ObjectPose};
use crate::scene::Scene;
use crate::skeleton::{JointFrame, JointRole, Pose, Skeleton};

/// Hands that come nearer to each other than this, seen from above, tell no heading, metres.
pub const LEAST_WIDTH: f64 = 0.05;

/// A body, as far as what it carries needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyHands {
    /// The root, metres.
    pub root: DVec3,
    /// Facing of the body, radians.
    pub heading: f64,
    /// Left and right hand in the world.
    pub hands: [(JointId, JointFrame); 2],
}

impl BodyHands {
    /// Of a body with hands. Cost: linear in joints.
    pub fn of(skeleton: &Skeleton, pose: &Pose) -> Self {
        let frames = skeleton.forward_kinematics(pose);
        let hand = |role: JointRole| {
            let joint = skeleton.joint_of(role).expect("who carries in a checked scene has hands");
            (joint, frames[joint.as_usize()])
        };
        let hands = [JointRole::LeftHand, JointRole::RightHand].map(hand);
        Self { root: pose.root, heading: heading(skeleton, &frames), hands }
    }

    /// The same body with its root elsewhere, turned about the vertical by `turn` radians.
    pub fn moved(&self, root: DVec3, turn: f64) -> Self {
        let rotation = yaw(turn);
        let moved = |(joint, frame): (JointId, JointFrame)| {
            let position = root + rotation * (frame.position - self.root);
            (joint, JointFrame { position, rotation: rotation * frame.rotation })
        };
        Self { root, heading: self.heading + turn, hands: self.hands.map(moved) }
    }
}

/// Whether the hands of those who carry tell a heading, from one frame of the track of whoever says when to another. Frame by
/// frame of theirs: time may be stretched out of all proportion. Cost: linear in these frames.
pub fn hands_stay_apart(
    scene: &Scene,
    performance: &impl Performance,
    carry: usize,
    [first, last]: [f64; 2],
) -> bool {
    let carry = &scene.carries[carry];
    let who = carry.during.0.character;
    let mut frames = (0..=floor_index(last - first)).map(|k| first + k as f64).chain([last]);
    frames.all(|frame| {
        let hands = match carry.by[..] {
            [alone] if alone == who => Hands::of([(who, performance.hands(scene, who, frame))]),
            _ => Hands::at(scene, performance, carry, performance.time(who, frame)),
        };
        plan_of(hands.across).norm() >= LEAST_WIDTH
    })
}

/// The hands of everybody who carries an object, at one instant.
pub(super) struct Hands {
    middle: DVec3,
    /// From left to right.
    across: DVec3,
    /// Of the first carrier's body, radians.
    body: f64,
    pub(super) grips: Vec<(CharacterId, JointId, JointFrame)>,
}

impl Hands {
    pub(super) fn at(scene: &Scene, performance: &impl Performance, carry: &Carry, seconds: f64) -> Self {
        let body =
            |who: &CharacterId| (*who, performance.hands(scene, *who, performance.frame(*who, seconds)));
        Self::of(carry.by.iter().map(body))
    }

    fn of(bodies: impl IntoIterator<Item = (CharacterId, BodyHands)>) -> Self {
        let mut grips = Vec::with_capacity(4);
        let mut body = None;
        for (who, own) in bodies {
            body = body.or(Some(own.heading));
            grips.extend(own.hands.map(|(joint, frame)| (who, joint, frame)));
        }
        let place = |hand: usize| grips[hand].2.position;
        let (left, right) = match grips.len() {
            2 => (place(0), place(1)),
            _ => (place(0).midpoint(place(1)), place(2).midpoint(place(3))),
        };
        Self {
            middle: left.midpoint(right),
            across: right - left,
            body: body.expect("somebody carries in a checked scene"),
            grips,
        }
    }

    pub(super) fn frame(&self, by_hands: bool) -> ObjectPose {
        let facing = if by_hands { plan_of(self.across).arg() } else { self.body };
        ObjectPose { position: self.middle, facing }
    }
}
