//! By how much the result misses each constraint: on the solved paths, and on the final motion at the moments themselves.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use crate::clip::facing::facing;
use crate::constraint::{ConstraintKind, Moment};
use crate::edit::expand::{Expansion, expand};
use crate::edit::following::{in_the_world, object_pose, wanted};
use crate::edit::hold::{Hold, Place};
use crate::edit::time_row::TimePoint;
use crate::edit::{Edit, EditedCharacter, Moved};
use crate::geometry::{c64, cis, plan_of, wrap};
use crate::index::CharacterId;
use crate::object_motion::{Performance, object_motions, skeleton_of};
use crate::path;
use crate::resample::time_of;
use crate::scene::Scene;

/// What a constraint holds is missed by this much, the most over an interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// Places on the final motion, metres; `None` where no place is held.
    pub position: Option<f64>,
    /// Places on the solved path, metres.
    pub path_position: Option<f64>,
    /// Facings on the final motion, radians.
    pub facing: Option<f64>,
    /// Times, seconds.
    pub seconds: Option<f64>,
}

/// A moment that a constraint, a carry or an end effector names, and when it happens in the result.
#[derive(Clone, Debug, PartialEq)]
pub struct MomentTime {
    /// As in the scene file.
    pub name: String,
    /// Scene time, seconds.
    pub time: f64,
}

/// Where a body is and how it faces at an instant.
#[derive(Clone, Copy)]
struct Stance {
    position: c64,
    heading: f64,
}

/// Residuals of all constraints of a scene, in its order, with bodies as the edit of the paths leaves them. Cost: linear in
/// constraint samples.
pub fn residuals(scene: &Scene, edit: &Edit) -> Vec<Residual> {
    residuals_of(scene, edit, &Moved { scene, characters: &edit.characters })
}

/// [`residuals`] with bodies as in `result`: hands that reach far pull the whole body off its path.
pub fn residuals_of(scene: &Scene, edit: &Edit, result: &impl Performance) -> Vec<Residual> {
    let rests: Vec<_> = edit.characters.iter().map(|character| character.rest.clone()).collect();
    let Expansion { mut held, times, following } = expand(scene, &rests);
    let moved = Moved { scene, characters: &edit.characters };
    let objects = object_motions(scene, &moved);
    for row in &following {
        let own = &mut held[row.row];
        let kind = &scene.constraints[own.constraint.as_usize()].kind;
        own.hold = in_the_world(row, wanted(kind, row.before), object_pose(&moved, &objects, row));
    }
    let mut residuals = vec![Residual::default(); scene.constraints.len()];
    for row in held {
        let own = &mut residuals[row.constraint.as_usize()];
        let on_path = |place: Place| path_stance(&edit.characters[place.path], place);
        let on_motion = |place: Place| motion_stance((scene, edit), result, place);
        match miss(row.hold, on_motion) {
            Miss::Metres(metres) => {
                worst(&mut own.position, metres);
                if let Miss::Metres(metres) = miss(row.hold, on_path) {
                    worst(&mut own.path_position, metres);
                }
            }
            Miss::Radians(radians) => worst(&mut own.facing, radians),
        }
    }
    for row in times {
        let time = |point: TimePoint| time_of(&edit.characters[point.track].times, point.frame);
        let seconds = time(row.at) - row.minus.map_or(0.0, time) - row.seconds;
        worst(&mut residuals[row.constraint.as_usize()].seconds, seconds.abs());
    }
    residuals
}

fn worst(known: &mut Option<f64>, value: f64) {
    *known = Some(known.unwrap_or(0.0).max(value));
}

enum Miss {
    Metres(f64),
    Radians(f64),
}

fn miss(hold: Hold, stance: impl Fn(Place) -> Stance) -> Miss {
    match hold {
        Hold::Position { at, target } => Miss::Metres((stance(at).position - target).norm()),
        Hold::Beside { at, to, from, target } => {
            let place = |place| stance(place).position;
            Miss::Metres((place(at) - place(to) + place(from) - target).norm())
        }
        Hold::Facing { at, heading } => Miss::Radians(wrap(stance(at).heading - heading).abs()),
        Hold::Offset { at, to, offset } => {
            let partner = stance(to);
            let found = (stance(at).position - partner.position) * cis(-partner.heading);
            Miss::Metres((found - offset).norm())
        }
        Hold::RelativeFacing { at, to, angle } => {
            Miss::Radians(wrap(stance(at).heading - stance(to).heading - angle).abs())
        }
    }
}

fn path_stance(character: &EditedCharacter, place: Place) -> Stance {
    let turn = character.turns.at(place.frame);
    let position = path::at(&character.positions, place.frame) + cis(turn) * place.detail;
    Stance { position, heading: place.heading + turn }
}

fn motion_stance((scene, edit): (&Scene, &Edit), result: &impl Performance, place: Place) -> Stance {
    let who = CharacterId::from_usize(place.path);
    let pose = result.pose(who, place.frame);
    let skeleton = skeleton_of(scene, who);
    let turned = place.heading + edit.characters[place.path].turns.at(place.frame);
    let heading = facing(skeleton, &skeleton.forward_kinematics(&pose)).unwrap_or(turned);
    Stance { position: plan_of(pose.root), heading }
}

/// Every moment that something names, once, in the order of the scene, with its time in the result.
pub fn moment_times(scene: &Scene, edit: &Edit) -> Vec<MomentTime> {
    let mut known = BTreeSet::new();
    let time = |moment: &Moment| {
        let times = &edit.characters[moment.character.as_usize()].times;
        MomentTime { name: moment.name.clone(), time: time_of(times, scene.frame_of(moment)) }
    };
    scene.moments().filter(|moment| known.insert(&moment.name)).map(time).collect()
}

/// Largest residual of a constraint in the unit of its kind: metres for places, radians where only a facing is held,
/// seconds for times.
pub fn largest(kind: &ConstraintKind, residual: &Residual) -> (f64, &'static str) {
    match kind {
        ConstraintKind::Pin { .. } | ConstraintKind::Relative { .. } => match residual.position {
            Some(metres) => (metres, "m"),
            None => (residual.facing.unwrap_or(0.0) * 180.0 / PI, "deg"),
        },
        _ => (residual.seconds.unwrap_or(0.0), "s"),
    }
}
