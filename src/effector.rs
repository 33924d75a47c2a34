//! What hands, feet and other joints must reach: met by the full body as far as it reaches, never by bending paths.

use glam::{DQuat, DVec3};

use crate::constraint::{Moment, When};
use crate::index::{CharacterId, JointId, ObjectId};

/// A joint of somebody that must be somewhere at a moment or over an interval.
#[derive(Clone, Debug, PartialEq)]
pub struct EndEffector {
    /// Its author's name for it, or `end_effector[0]` … in the order of the file.
    pub name: String,
    /// Line of the scene file, from 1; 0 where the scene does not come from a file.
    pub line: u32,
    /// When, and whose joint.
    pub when: When,
    /// Which joint of the character's skeleton.
    pub joint: JointId,
    /// How the joint is turned; `None`: not held.
    pub orientation: Option<Orientation>,
    /// Where it must be.
    pub target: EffectorTarget,
}

/// How a joint is turned, in the axes of what it reaches: the world's, the object's, or those of the partner's joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orientation {
    /// As before the edit; over an interval sample by sample.
    AsBefore,
    /// From the axes of the joint to these axes.
    Given(DQuat),
}

/// What a joint reaches.
#[derive(Clone, Debug, PartialEq)]
pub enum EffectorTarget {
    /// A point of the world, metres.
    World(DVec3),
    /// A point of an object.
    Object {
        /// Which.
        object: ObjectId,
        /// In its axes (ahead, up, right, from the middle of its base), metres.
        point: DVec3,
    },
    /// A joint of another character. Two hands meet in the middle; anything else is reached where it is.
    Joint {
        /// Whose.
        character: CharacterId,
        /// Of that character's skeleton.
        joint: JointId,
        /// From the joint, in its axes, metres: a place on the body.
        point: DVec3,
        /// When there, an interval with an interval; `None`: at the same time.
        when: Option<When>,
    },
}

impl EndEffector {
    /// Every moment it names, in the order of the file.
    pub fn moments(&self) -> Vec<&Moment> {
        let own = self.when.moments().into_iter();
        match &self.target {
            EffectorTarget::Joint { when: Some(when), .. } => own.chain(when.moments()).collect(),
            _ => own.collect(),
        }
    }

    /// Every moment it names, to be changed.
    pub fn moments_mut(&mut self) -> Vec<&mut Moment> {
        let own = self.when.moments_mut().into_iter();
        match &mut self.target {
            EffectorTarget::Joint { when: Some(when), .. } => own.chain(when.moments_mut()).collect(),
            _ => own.collect(),
        }
    }
}
