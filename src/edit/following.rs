//! Rows relative to objects that move. Where a keyframed object is follows from the time of the row; a carried one is
//! where its carrier has brought it, so that the row becomes one relative to the carrier. Source: Kim et al. 2009, §4.3.
//!
//! There the object keeps its place relative to the carrier. But a carrier who is elsewhere at the grasp holds the object
//! otherwise: moving the carrier's whole path does not move it. So the row counts from the grasp on,
//!
//! ```text
//!     o(t) = p(t) − p(t₀) + r        p: carrier, t₀: grasp
//! ```
//!
//! with the rest `r` (where the object was at the grasp, to which other carriers may have brought it, and how it has turned
//! since) as on the present paths: the editor solves, reads it off, and solves again until nothing changes. In the
//! solution `r` is what it is; that its change is not foreseen only costs rounds. A turn is left in it, as otherwise
//! carriers would be sent far away, from where a small turn moves the object much.

use crate::constraint::{ConstraintKind, Relation};
use crate::edit::expand::{Following, Wanted};
use crate::edit::hold::{Hold, Place};
use crate::edit::moved::Moved;
use crate::geometry::{c64, wrap};
use crate::index::CharacterId;
use crate::object::ObjectPose;
use crate::object_motion::{ObjectMotion, Objects, Performance, Possessor};
use crate::path;

/// A row that its own subject would have to satisfy by carrying the object differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OwnLoad {
    /// The carry, by position in the scene.
    pub carry: usize,
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

/// The row as the solver takes it: in the world as long as nobody has carried the object. Then a place is held together
/// with the carrier's path from the grasp to that frame, or to the release, as only this moves the object; what the object
/// was like at the grasp, and how it is turned, is taken as it is on the present paths.
///
/// # Errors
/// [`OwnLoad`] where the carrier is the one whom the row holds.
pub fn follow(
    moved: &Moved<'_>,
    objects: &Objects<'_, impl Performance>,
    following: &Following,
    wanted: Wanted,
) -> Result<Hold, OwnLoad> {
    let (object, seconds) = (following.object, time_of_row(moved, following));
    let had = objects.possession_before(object, seconds);
    let in_the_world = || in_the_world(following, wanted, objects.pose_at(object, seconds));
    let (carry, until) = match had.by {
        Possessor::Itself => return Ok(in_the_world()),
        Possessor::Carried(carry) => (carry, seconds),
        Possessor::Left(carry) => (carry, had.from),
    };
    let carriers = &moved.scene.carries[carry].by;
    let other = carriers.iter().find(|who| who.as_usize() != following.at.path);
    let carrier = match (other, had.by) {
        (Some(other), _) => *other,
        (None, Possessor::Left(_)) => carriers[0],
        (None, _) => return Err(OwnLoad { carry }),
    };
    let Wanted::Offset(offset) = wanted else {
        return Ok(in_the_world());
    };
    let grasp = objects.grasped(object, carry).min(until);
    let on_path = |seconds: f64| {
        let path = carrier.as_usize();
        let place =
            Place { path, frame: moved.frame(carrier, seconds), heading: 0.0, detail: c64::default() };
        (place, path::at(&moved.characters[path].positions, place.frame))
    };
    let ((to, there), (from, then)) = (on_path(until), on_path(grasp));
    let target = objects.pose_at(object, seconds).beside(offset) - (there - then);
    Ok(Hold::Beside { at: following.at, to, from, target })
}

/// Whether two rows bind the same frames, with other numbers at most.
pub fn alike(a: &Hold, b: &Hold) -> bool {
    match (a, b) {
        (Hold::Beside { at: a, to: b, from: c, .. }, Hold::Beside { at: d, to: e, from: f, .. }) => {
            (a, b, c) == (d, e, f)
        }
        _ => std::mem::discriminant(a) == std::mem::discriminant(b) && a.at() == b.at() && a.to() == b.to(),
    }
}

/// The numbers of a row, two each: metres, or radians and nothing.
pub fn numbers(hold: &Hold) -> [f64; 2] {
    match hold {
        Hold::Position { target: point, .. }
        | Hold::Beside { target: point, .. }
        | Hold::Offset { offset: point, .. } => [point.re, point.im],
        Hold::Facing { heading: angle, .. } | Hold::RelativeFacing { angle, .. } => [*angle, 0.0],
    }
}

/// From the numbers of a row to those of another that binds the same frames; angles on the shorter arc.
pub fn step(from: &Hold, to: &Hold) -> [f64; 2] {
    let ([a, b], [c, d]) = (numbers(from), numbers(to));
    if from.is_direction() { [wrap(c - a), 0.0] } else { [c - a, d - b] }
}

/// The row `like` with other numbers.
pub fn with_numbers(like: &Hold, [a, b]: [f64; 2]) -> Hold {
    let mut hold = *like;
    match &mut hold {
        Hold::Position { target: point, .. }
        | Hold::Beside { target: point, .. }
        | Hold::Offset { offset: point, .. } => *point = c64::new(a, b),
        Hold::Facing { heading: angle, .. } | Hold::RelativeFacing { angle, .. } => *angle = a,
    }
    hold
}
