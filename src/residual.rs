//! By how much the result misses each constraint: on the solved paths, and on the final motion at the moments themselves.

use std::collections::{BTreeMap, BTreeSet};

use crate::clip::facing::pose_facing;
use crate::constraint::Moment;
use crate::edit::expand::{Expansion, expand};
use crate::edit::following::{in_the_world, object_pose, wanted};
use crate::edit::hold::{HeldRow, Hold, Place};
use crate::edit::time_row::{TimePoint, TimeRow};
use crate::edit::{Edit, EditedCharacter, Moved};
use crate::geometry::{c64, cis, plan_of, wrap};
use crate::index::CharacterId;
use crate::object_motion::{ObjectMotion, Performance, object_motions, skeleton_of};
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// On the ground, metres.
    pub position: c64,
    /// Radians.
    pub heading: f64,
}

/// Residuals of all constraints of a scene, in its order, with bodies as the edit of the paths leaves them. Cost: linear in
/// constraint samples.
pub fn residuals(scene: &Scene, edit: &Edit) -> Vec<Residual> {
    residuals_of(scene, edit, &Moved { scene, characters: &edit.characters })
}

/// [`residuals`] with bodies as in `result`: hands that reach far pull the whole body off its path.
pub fn residuals_of(scene: &Scene, edit: &Edit, result: &impl Performance) -> Vec<Residual> {
    let moved = Moved { scene, characters: &edit.characters };
    let demands = Demands::of((scene, edit), &object_motions(scene, &moved));
    let mut stances = Stances::default();
    for who in (0..scene.characters.len()).map(CharacterId::from_usize) {
        stances.extend(demands.stances((scene, edit), result, who));
    }
    demands.residuals((scene, edit), &stances)
}

/// What the constraints of a scene hold of its result, found once for all characters.
pub struct Demands {
    held: Vec<HeldRow>,
    times: Vec<TimeRow>,
    /// Places of each character that some row looks at.
    places: Vec<Vec<Place>>,
}

/// Where bodies are on the final motion: by character, and the bits of the frame of its track.
pub type Stances = BTreeMap<(usize, u64), Stance>;

impl Demands {
    /// Those of a scene. `objects`: as carried on the moved paths. Cost: linear in constraint samples.
    pub fn of((scene, edit): (&Scene, &Edit), objects: &[ObjectMotion]) -> Self {
        let rests: Vec<_> = edit.characters.iter().map(|character| character.rest.clone()).collect();
        let Expansion { mut held, times, following } = expand(scene, &rests);
        let moved = Moved { scene, characters: &edit.characters };
        for row in &following {
            let own = &mut held[row.row];
            let kind = &scene.constraints[own.constraint.as_usize()].kind;
            own.hold = in_the_world(row, wanted(kind, row.before), object_pose(&moved, objects, row));
        }
        let mut places = vec![Vec::new(); scene.characters.len()];
        for place in held.iter().flat_map(|row| places_of(row.hold)) {
            places[place.path].push(place);
        }
        Self { held, times, places }
    }

    /// Where a character is in `result` wherever something is held of it.
    pub fn stances(
        &self,
        (scene, edit): (&Scene, &Edit),
        result: &impl Performance,
        who: CharacterId,
    ) -> Stances {
        let stance = |place: &Place| (key(*place), motion_stance((scene, edit), result, *place));
        self.places[who.as_usize()].iter().map(stance).collect()
    }

    /// Residuals of all constraints, in the order of the scene. `stances`: of all characters.
    pub fn residuals(&self, edited: (&Scene, &Edit), stances: &Stances) -> Vec<Residual> {
        self.residuals_of(edited, stances, |_| true)
    }

    /// [`Demands::residuals`] where a constraint is one of those whom `are_own` names: the first character that it holds.
    /// `stances`: of these, and of those [`Demands::beside`] them. What is of times is told of all.
    pub fn residuals_of(
        &self,
        (scene, edit): (&Scene, &Edit),
        stances: &Stances,
        are_own: impl Fn(CharacterId) -> bool,
    ) -> Vec<Residual> {
        let mut residuals = vec![Residual::default(); scene.constraints.len()];
        for row in self.held.iter().filter(|row| are_own(first_of(row))) {
            let own = &mut residuals[row.constraint.as_usize()];
            let on_path = |place: Place| path_stance(&edit.characters[place.path], place);
            match miss(row.hold, |place| stances[&key(place)]) {
                Miss::Metres(metres) => {
                    worst(&mut own.position, metres);
                    if let Miss::Metres(metres) = miss(row.hold, on_path) {
                        worst(&mut own.path_position, metres);
                    }
                }
                Miss::Radians(radians) => worst(&mut own.facing, radians),
            }
        }
        for row in &self.times {
            let time = |point: TimePoint| time_of(&edit.characters[point.track].times, point.frame);
            let seconds = time(row.at) - row.minus.map_or(0.0, time) - row.seconds;
            worst(&mut residuals[row.constraint.as_usize()].seconds, seconds.abs());
        }
        residuals
    }
}

impl Demands {
    /// Characters to whom constraints hold those whom `are_own` names, none of these; rising.
    pub fn beside(&self, are_own: impl Fn(CharacterId) -> bool) -> Vec<CharacterId> {
        let own = self.held.iter().filter(|row| are_own(first_of(row)));
        let all: BTreeSet<CharacterId> = own
            .flat_map(|row| places_of(row.hold))
            .map(|place| CharacterId::from_usize(place.path))
            .collect();
        all.into_iter().filter(|who| !are_own(*who)).collect()
    }
}

/// Whom a row holds.
fn first_of(row: &HeldRow) -> CharacterId {
    let path = places_of(row.hold).next().map_or(0, |place| place.path);
    CharacterId::from_usize(path)
}

const fn key(place: Place) -> (usize, u64) {
    (place.path, place.frame.to_bits())
}

/// Where a row looks.
fn places_of(hold: Hold) -> impl Iterator<Item = Place> {
    let [first, second, third] = match hold {
        Hold::Position { at, .. } | Hold::Facing { at, .. } => [Some(at), None, None],
        Hold::Beside { at, to, from, .. } => [Some(at), Some(to), Some(from)],
        Hold::Offset { at, to, .. } | Hold::RelativeFacing { at, to, .. } => [Some(at), Some(to), None],
    };
    [first, second, third].into_iter().flatten()
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
    let heading = pose_facing(skeleton, &pose).unwrap_or(turned);
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

/// Largest residual of a constraint of some kind ([`keyword`](crate::constraint::ConstraintKind::keyword)) in the unit of its kind: metres for places, degrees
/// where only a facing is held, seconds for times.
pub fn largest(kind: &str, residual: &Residual) -> (f64, &'static str) {
    match kind {
        "pin" | "relative" => match residual.position {
            Some(metres) => (metres, "m"),
            None => (residual.facing.unwrap_or(0.0).to_degrees(), "deg"),
        },
        _ => (residual.seconds.unwrap_or(0.0), "s"),
    }
}
