//! Rows relative to objects that move. Where a keyframed object is follows from the time of the row; a carried one is
//! where its carrier is, so that the row becomes one relative to the carrier. Source: Kim et al. 2009, §4.3 (objects).
//!
//! How far a carried object is from its carrier depends on where both were when it was grasped, and so on the edit
//! itself: the editor solves, reads it off, and solves again until nothing changes.

use crate::constraint::{ConstraintKind, Relation};
use crate::edit::expand::{Following, Wanted, place_at};
use crate::edit::hold::Hold;
use crate::edit::moved::Moved;
use crate::geometry::{c64, cis, wrap};
use crate::index::CharacterId;
use crate::object::ObjectPose;
use crate::object_motion::{ObjectMotion, Owner, Performance};
use crate::path;

/// A row that its own subject would have to satisfy by carrying the object differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OwnLoad {
    /// The carry, by position in the scene.
    pub carry: usize,
}

/// Who gives way where somebody must be beside a carried object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ties {
    /// They and the carrier.
    Both,
    /// They alone.
    OneWay,
}

/// What a constraint wants of one of its rows: its own value, or the one before the edit.
pub fn wanted(kind: &ConstraintKind, before: Wanted) -> Wanted {
    match (kind, before) {
        (ConstraintKind::Relative { offset: Relation::Given(offset), .. }, Wanted::Offset(_)) => {
            Wanted::Offset(*offset)
        }
        (ConstraintKind::Relative { facing: Relation::Given(angle), .. }, Wanted::Facing(_)) => {
            Wanted::Facing(*angle)
        }
        _ => before,
    }
}

/// The row in the world, with the object where it is.
pub fn in_the_world(following: &Following, wanted: Wanted, pose: ObjectPose) -> Hold {
    let at = following.at;
    match wanted {
        Wanted::Offset(offset) => Hold::Position { at, target: pose.beside(offset) },
        Wanted::Facing(angle) => Hold::Facing { at, heading: pose.facing + angle },
    }
}

/// Pose of the object of a row at the time of the row.
pub fn object_pose(moved: &Moved<'_>, motions: &[ObjectMotion], following: &Following) -> ObjectPose {
    let seconds = time_of_row(moved, following);
    motions[following.object.as_usize()].pose_at(moved.scene, moved, seconds)
}

fn time_of_row(moved: &Moved<'_>, following: &Following) -> f64 {
    moved.time(CharacterId::from_usize(following.at.path), following.at.frame)
}

/// The row as the solver takes it: in the world as long as nobody has carried the object, else relative to whoever carries
/// it, or carried it last, at that frame; one way, always in the world.
///
/// # Errors
/// [`OwnLoad`] where that is the one whom the row holds.
pub fn follow(
    moved: &Moved<'_>,
    motions: &[ObjectMotion],
    following: &Following,
    (wanted, ties): (Wanted, Ties),
) -> Result<Hold, OwnLoad> {
    let pose = object_pose(moved, motions, following);
    let seconds = time_of_row(moved, following);
    let span = motions[following.object.as_usize()].span_before(seconds);
    let (carry, seconds) = match &span.owner {
        Owner::Itself => return Ok(in_the_world(following, wanted, pose)),
        Owner::Carried(hold) => (hold.carry, seconds),
        Owner::Left { carry, .. } => (*carry, span.from),
    };
    let carriers = &moved.scene.carries[carry].by;
    let other = carriers.iter().find(|who| who.as_usize() != following.at.path);
    let carrier = match (other, &span.owner) {
        (Some(other), _) => *other,
        (None, Owner::Left { .. }) => carriers[0],
        (None, _) => return Err(OwnLoad { carry }),
    };
    if ties == Ties::OneWay {
        return Ok(in_the_world(following, wanted, pose));
    }
    let body = &moved.characters[carrier.as_usize()];
    let to = place_at(moved.scene, &body.rest, carrier, moved.frame(carrier, seconds));
    let turn = body.turns.at(to.frame);
    let (root, heading) = (path::at(&body.positions, to.frame) + cis(turn) * to.detail, to.heading + turn);
    let at = following.at;
    Ok(match wanted {
        Wanted::Offset(offset) => {
            Hold::Offset { at, to, offset: (pose.beside(offset) - root) * cis(-heading) }
        }
        Wanted::Facing(angle) => Hold::RelativeFacing { at, to, angle: wrap(pose.facing + angle - heading) },
    })
}

/// Whether two rows bind the same frames, with other numbers at most.
pub fn alike(a: &Hold, b: &Hold) -> bool {
    std::mem::discriminant(a) == std::mem::discriminant(b) && a.at() == b.at() && a.to() == b.to()
}

/// The numbers of a row: metres, or radians.
pub fn numbers(hold: &Hold) -> [f64; 2] {
    match hold {
        Hold::Position { target: point, .. } | Hold::Offset { offset: point, .. } => [point.re, point.im],
        Hold::Facing { heading: angle, .. } | Hold::RelativeFacing { angle, .. } => [*angle, 0.0],
    }
}

/// From the numbers of a row to those of another that binds the same frames; angles on the shorter arc.
pub fn step(from: &Hold, to: &Hold) -> [f64; 2] {
    let ([a, b], [c, d]) = (numbers(from), numbers(to));
    if from.is_direction() { [wrap(c - a), 0.0] } else { [c - a, d - b] }
}

/// Gives a row other numbers; whether that changes coefficients rather than a target.
pub fn renumber(hold: &mut Hold, [a, b]: [f64; 2]) -> bool {
    match hold {
        Hold::Position { target, .. } => *target = c64::new(a, b),
        Hold::Facing { heading, .. } => *heading = a,
        Hold::Offset { offset, .. } => *offset = c64::new(a, b),
        Hold::RelativeFacing { angle, .. } => *angle = a,
    }
    matches!(hold, Hold::Offset { .. } | Hold::RelativeFacing { .. })
}
