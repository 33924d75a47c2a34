//! Who carries, reaches, is reached and is held: found once, so that what one character needs costs nothing for all the others.

use std::collections::BTreeSet;

use crate::constraint::{ConstraintKind, Partner, Strength, When};
use crate::effector::{EffectorTarget, EndEffector, Orientation};
use crate::index::{CharacterId, ObjectId};
use crate::object_motion::{AtRest, ObjectMotion, object_motions};
use crate::scene::Scene;

/// What ties the characters of a scene to objects and to each other's bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Ties {
    /// Of each character: carries that it has a part in, by position in [`Scene::carries`], rising.
    pub carries: Vec<Vec<usize>>,
    /// Of each character: end effectors of its own and those that reach a joint of it, by position in
    /// [`Scene::end_effectors`], rising.
    pub effectors: Vec<Vec<usize>>,
    /// Of each character: hard constraints of its place or facing, by position in [`Scene::constraints`], rising; empty where nobody
    /// is touched up, as bodies are on their paths then but for what they reach.
    pub holds: Vec<Vec<usize>>,
    /// The objects of the motion before any edit; empty where nothing is turned as it was to an object then.
    pub rest_objects: Vec<ObjectMotion>,
}

impl Ties {
    /// Those of a scene. Cost: linear.
    pub fn of(scene: &Scene) -> Self {
        let nothing: Vec<Vec<usize>> = vec![Vec::new(); scene.characters.len()];
        let holds = holds(scene, nothing.clone());
        let (mut carries, mut effectors) = (nothing.clone(), nothing);
        for (index, carry) in scene.carries.iter().enumerate() {
            let who: BTreeSet<&CharacterId> = carry.by.iter().collect();
            who.into_iter().for_each(|who| carries[who.as_usize()].push(index));
        }
        for (index, effector) in scene.end_effectors.iter().enumerate() {
            let who: BTreeSet<CharacterId> =
                [Some(effector.when.character()), reached(effector)].into_iter().flatten().collect();
            who.into_iter().for_each(|who| effectors[who.as_usize()].push(index));
        }
        let is_turned_as_before = |effector: &EndEffector| {
            effector.orientation == Some(Orientation::AsBefore)
                && matches!(effector.target, EffectorTarget::Object { .. })
        };
        let needs_rest = scene.end_effectors.iter().any(is_turned_as_before);
        let rest_objects = if needs_rest { object_motions(scene, &AtRest(scene)) } else { Vec::new() };
        Self { carries, effectors, holds, rest_objects }
    }

    /// The objects that a character carries at some time, in their order.
    pub fn objects(&self, scene: &Scene, who: CharacterId) -> BTreeSet<ObjectId> {
        self.carries[who.as_usize()].iter().map(|carry| scene.carries[*carry].object).collect()
    }
}

/// When a constraint holds somebody's place or facing; never, where it is about time.
pub fn held_by(kind: &ConstraintKind) -> Vec<&When> {
    match kind {
        ConstraintKind::Pin { when, .. } => vec![when],
        ConstraintKind::Relative { when, partner: Partner::Character(theirs), .. } => vec![when, theirs],
        ConstraintKind::Relative { when, partner: Partner::Object(_), .. } => vec![when],
        ConstraintKind::Time { .. } | ConstraintKind::Duration { .. } | ConstraintKind::Sync { .. } => {
            Vec::new()
        }
    }
}

/// See [`Ties::holds`]. `nothing`: an empty list a character.
fn holds(scene: &Scene, nothing: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    let mut holds = nothing;
    if scene.physics.is_none() {
        return holds;
    }
    for (index, constraint) in scene.constraints.iter().enumerate() {
        if constraint.strength != Strength::Hard {
            continue;
        }
        let who: BTreeSet<CharacterId> = held_by(&constraint.kind).into_iter().map(When::character).collect();
        who.into_iter().for_each(|who| holds[who.as_usize()].push(index));
    }
    holds
}

/// Whose joint an end effector reaches.
fn reached(effector: &EndEffector) -> Option<CharacterId> {
    match effector.target {
        EffectorTarget::Joint { character, .. } => Some(character),
        EffectorTarget::World(_) | EffectorTarget::Object { .. } => None,
    }
}
