//! Which joints turn in a step, which are carried, and about what.

use crate::index::JointId;
use crate::physics::body_model::BodyModel;
use crate::skeleton::{JointRole, Skeleton};

/// A part of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// From the root to the hips, and the legs.
    Lower,
    /// All but [`Part::Lower`].
    Upper,
    /// The upper arms and what hangs on them.
    Arms,
    /// The joint of a role and what hangs on it.
    Below(JointRole),
}

/// What a joint does in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointMotion {
    /// Nothing.
    Stays,
    /// Turns with the component of this place in [`LinkSets::components`].
    Turns(usize),
    /// Is carried without being turned by the border of this place in [`LinkSets::borders`].
    Carried(usize),
}

/// Joints that turn as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Component {
    /// The one on which the others hang. The root turns about a point of the ground, any other one about its own place.
    pub top: JointId,
}

/// A joint that is carried, on one that turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Border {
    /// Keeps its rotation in the world, and so does what hangs on it.
    pub joint: JointId,
    /// What carries it: place in [`LinkSets::components`].
    pub component: usize,
}

/// What moves in a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkSets {
    /// One a joint.
    pub motions: Vec<JointMotion>,
    /// Turn all by one angle, each about its own pivot.
    pub components: Vec<Component>,
    /// Carry the rest.
    pub borders: Vec<Border>,
}

/// Why parts make no step.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PartsError {
    /// Parts that the skeleton lacks.
    #[error("nothing turns: the skeleton has none of the parts")]
    NothingTurns,
    /// Two parts overlap.
    #[error("joint \"{joint}\" is both to turn and to be carried")]
    Both {
        /// Its name.
        joint: String,
    },
    /// A carried joint hangs on one that stays: it cannot be carried.
    #[error("joint \"{joint}\" is to be carried, but hangs on one that stays")]
    NotCarried {
        /// Its name.
        joint: String,
    },
    /// A joint that turns or stays hangs on one that moves otherwise.
    #[error("joint \"{joint}\" hangs on one that is carried or turns, and would be torn off it")]
    Torn {
        /// Its name.
        joint: String,
    },
}

/// The joints of parts that turn and that are carried; all others stay. Cost: quadratic in joints.
///
/// # Errors
/// [`PartsError`] for parts that overlap or would be torn apart: what turns hangs on what turns or stays, what is carried on what turns or
/// is carried, what stays on what stays.
pub fn link_sets(
    skeleton: &Skeleton,
    body: &BodyModel,
    turned: &[Part],
    carried: &[Part],
) -> Result<LinkSets, PartsError> {
    let [turns, is_carried] = [turned, carried].map(|parts| members(skeleton, body, parts));
    let mut sets = LinkSets { motions: Vec::new(), components: Vec::new(), borders: Vec::new() };
    for (index, joint) in skeleton.joints.iter().enumerate() {
        let name = || joint.name.clone();
        let above = joint.parent.map(|parent| sets.motions[parent.as_usize()]);
        let motion = match (turns[index], is_carried[index]) {
            (true, true) => return Err(PartsError::Both { joint: name() }),
            (true, false) => match above {
                Some(JointMotion::Turns(component)) => JointMotion::Turns(component),
                Some(JointMotion::Carried(_)) => return Err(PartsError::Torn { joint: name() }),
                Some(JointMotion::Stays) | None => {
                    sets.components.push(Component { top: JointId::from_usize(index) });
                    JointMotion::Turns(sets.components.len() - 1)
                }
            },
            (false, true) => match above {
                Some(JointMotion::Carried(border)) => JointMotion::Carried(border),
                Some(JointMotion::Turns(component)) => {
                    sets.borders.push(Border { joint: JointId::from_usize(index), component });
                    JointMotion::Carried(sets.borders.len() - 1)
                }
                Some(JointMotion::Stays) | None => return Err(PartsError::NotCarried { joint: name() }),
            },
            (false, false) => match above {
                Some(JointMotion::Stays) | None => JointMotion::Stays,
                Some(_) => return Err(PartsError::Torn { joint: name() }),
            },
        };
        sets.motions.push(motion);
    }
    if sets.components.is_empty() { Err(PartsError::NothingTurns) } else { Ok(sets) }
}

impl LinkSets {
    /// Whether the whole body moves: about a point of the ground.
    pub fn moves_root(&self) -> bool {
        self.motions.first().is_some_and(|motion| *motion != JointMotion::Stays)
    }
}

fn members(skeleton: &Skeleton, body: &BodyModel, parts: &[Part]) -> Vec<bool> {
    let mut members = vec![false; skeleton.joints.len()];
    for part in parts {
        for (member, own) in members.iter_mut().zip(joints_of(skeleton, body, *part)) {
            *member |= own;
        }
    }
    members
}

fn joints_of(skeleton: &Skeleton, body: &BodyModel, part: Part) -> Vec<bool> {
    let below = |roles: &[JointRole]| {
        let tops: Vec<JointId> = roles.iter().filter_map(|role| body.foot(skeleton, *role)).collect();
        subtrees(skeleton, &tops)
    };
    match part {
        Part::Lower => lower(skeleton, body),
        Part::Upper => lower(skeleton, body).into_iter().map(|is_lower| !is_lower).collect(),
        Part::Arms => below(&[JointRole::LeftShoulder, JointRole::RightShoulder]),
        Part::Below(role) => below(&[role]),
    }
}

fn subtrees(skeleton: &Skeleton, tops: &[JointId]) -> Vec<bool> {
    let mut members: Vec<bool> = Vec::with_capacity(skeleton.joints.len());
    for (index, joint) in skeleton.joints.iter().enumerate() {
        let is_top = tops.iter().any(|top| top.as_usize() == index);
        members.push(is_top || joint.parent.is_some_and(|parent| members[parent.as_usize()]));
    }
    members
}

fn lower(skeleton: &Skeleton, body: &BodyModel) -> Vec<bool> {
    let hips = [JointRole::LeftHip, JointRole::RightHip];
    let hips: Vec<JointId> = hips.into_iter().filter_map(|role| body.foot(skeleton, role)).collect();
    let mut members = subtrees(skeleton, &hips);
    members[0] = true;
    for hip in hips {
        let mut above = Some(hip);
        while let Some(joint) = above {
            members[joint.as_usize()] = true;
            above = skeleton.joints[joint.as_usize()].parent;
        }
    }
    members
}
