//! Numbers of constraints that have moved, into rows whose structure stays.

use crate::constraint::{ConstraintKind, Partner, Relation};
use crate::edit::hold::{HeldRow, Hold};
use crate::scene::Scene;

/// Sets the numbers of `row` anew from its constraint, whose structure has not changed; `true` if coefficients changed
/// rather than targets. Rows relative to objects that move stay as they are: the next solve sets them.
pub fn retarget(row: &mut HeldRow, scene: &Scene) -> bool {
    match &scene.constraints[row.constraint.as_usize()].kind {
        ConstraintKind::Pin { position, facing, .. } => {
            match &mut row.hold {
                Hold::Position { target, .. } => *target = position.unwrap_or(*target),
                Hold::Facing { heading, .. } => *heading = facing.unwrap_or(*heading),
                Hold::Offset { .. } | Hold::RelativeFacing { .. } | Hold::Beside { .. } => {}
            }
            false
        }
        ConstraintKind::Relative { offset, facing, partner: Partner::Character(_), .. } => {
            match &mut row.hold {
                Hold::Offset { offset: own, .. } => replace(own, offset),
                Hold::RelativeFacing { angle, .. } => replace(angle, facing),
                Hold::Position { .. } | Hold::Facing { .. } | Hold::Beside { .. } => false,
            }
        }
        ConstraintKind::Relative { offset, facing, partner: Partner::Object(object), .. } => {
            if scene.moves(*object) {
                return false;
            }
            let pose = scene.objects[object.as_usize()].course.pose_at(0.0);
            match (&mut row.hold, offset, facing) {
                (Hold::Position { target, .. }, Relation::Given(offset), _) => *target = pose.beside(*offset),
                (Hold::Facing { heading, .. }, _, Relation::Given(angle)) => *heading = pose.facing + angle,
                _ => {}
            }
            false
        }
        ConstraintKind::Time { .. } | ConstraintKind::Duration { .. } | ConstraintKind::Sync { .. } => false,
    }
}

fn replace<T: Copy + PartialEq>(value: &mut T, relation: &Relation<T>) -> bool {
    match relation {
        Relation::Given(new) if *new != *value => {
            *value = *new;
            true
        }
        _ => false,
    }
}

/// Seconds that the rows of a temporal constraint ask for at present.
pub fn seconds_of(kind: &ConstraintKind) -> Option<f64> {
    match kind {
        ConstraintKind::Time { seconds, .. } | ConstraintKind::Duration { seconds, .. } => Some(*seconds),
        ConstraintKind::Sync { offset, .. } => Some(*offset),
        ConstraintKind::Pin { .. } | ConstraintKind::Relative { .. } => None,
    }
}
