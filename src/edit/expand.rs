//! From a scene's constraints to rows at single instants. Source: Kim et al. 2009, §4.2–4.3.

use crate::constraint::{Constraint, ConstraintKind, Moment, Partner, Relation, Strength, When};
use crate::edit::hold::{HeldRow, Hold, Place};
use crate::edit::time_row::{TimePoint, TimeRow};
use crate::geometry::{c64, cis, plan_of};
use crate::index::ConstraintId;
use crate::path::{self, RestPath};
use crate::scene::{Object, Scene};

/// Frames between the samples of an interval.
const SAMPLE_STRIDE: f64 = 10.0;

/// Rows of all constraints of a scene; paths and tracks are numbered as its characters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expansion {
    /// Spatial rows, in the order of the constraints.
    pub held: Vec<HeldRow>,
    /// Temporal rows, in the order of the constraints.
    pub times: Vec<TimeRow>,
}

/// Expands every constraint of `scene`, whose characters have the rest paths `rests`.
pub fn expand(scene: &Scene, rests: &[RestPath]) -> Expansion {
    let mut expansion = Expansion::default();
    for (index, constraint) in scene.constraints.iter().enumerate() {
        let id = ConstraintId::from_usize(index);
        match &constraint.kind {
            ConstraintKind::Pin { when, .. } => {
                for (frame, share) in samples(scene, when) {
                    let at = place(scene, rests, when, frame);
                    let strength = shared(constraint.strength, share);
                    push_pin(&mut expansion.held, id, strength, at, &constraint.kind);
                }
            }
            ConstraintKind::Relative { when, partner, .. } => {
                for (frame, to, share) in pairs(scene, when, partner) {
                    let at = place(scene, rests, when, frame);
                    let to = to.map(|(when, frame)| place(scene, rests, when, frame));
                    let strength = shared(constraint.strength, share);
                    push_relative(
                        &mut expansion.held,
                        id,
                        strength,
                        (at, to),
                        (constraint, &scene.objects, rests),
                    );
                }
            }
            ConstraintKind::Time { at, seconds } => {
                let at = time_point(scene, at);
                let strength = constraint.strength;
                expansion.times.push(TimeRow {
                    constraint: id,
                    strength,
                    at,
                    minus: None,
                    seconds: *seconds,
                });
            }
            ConstraintKind::Duration { from, to, seconds } => {
                let (at, minus) = (time_point(scene, to), Some(time_point(scene, from)));
                let strength = constraint.strength;
                expansion.times.push(TimeRow { constraint: id, strength, at, minus, seconds: *seconds });
            }
            ConstraintKind::Sync { moments, offset } => {
                for other in &moments[1..] {
                    push_sync(
                        &mut expansion.times,
                        id,
                        constraint.strength,
                        scene,
                        (&moments[0], other, *offset),
                    );
                }
            }
        }
    }
    expansion
}

/// Frame on its character's track of a moment.
pub fn frame_of(scene: &Scene, moment: &Moment) -> f64 {
    let track = &scene.characters[moment.character.as_usize()].track;
    track.locate(moment.instant).expect("a checked scene's tracks show every frame that a moment names")
}

fn time_point(scene: &Scene, moment: &Moment) -> TimePoint {
    TimePoint { track: moment.character.as_usize(), frame: frame_of(scene, moment) }
}

/// Strength of one sample that stands for `share` frames of an interval; `None` at an instant.
fn shared(strength: Strength, share: Option<f64>) -> Strength {
    match (strength, share) {
        (Strength::Soft(weight), Some(share)) => Strength::Soft(weight * share),
        _ => strength,
    }
}

/// Frames at which a constraint is held, with their trapezoid shares of an interval.
fn samples(scene: &Scene, when: &When) -> Vec<(f64, Option<f64>)> {
    match when {
        When::At(moment) => vec![(frame_of(scene, moment), None)],
        When::During(from, to) => interval(frame_of(scene, from), frame_of(scene, to))
            .into_iter()
            .map(|(frame, share)| (frame, Some(share)))
            .collect(),
    }
}

/// Every tenth frame of an interval, both ends included, with the frames each stands for (trapezoid rule).
fn interval(from: f64, to: f64) -> Vec<(f64, f64)> {
    let mut frames = vec![from];
    while frames[frames.len() - 1] + SAMPLE_STRIDE < to - 1e-9 {
        frames.push(frames[frames.len() - 1] + SAMPLE_STRIDE);
    }
    if to - from > 1e-9 {
        frames.push(to);
    }
    let last = frames.len() - 1;
    if last == 0 {
        return vec![(from, 1.0)];
    }
    let share = |i: usize| 0.5 * (frames[(i + 1).min(last)] - frames[i.saturating_sub(1)]);
    frames.iter().enumerate().map(|(i, frame)| (*frame, share(i))).collect()
}

/// A sample of a relative constraint: own frame, the partner's moment and frame, share of an interval.
type PairSample<'a> = (f64, Option<(&'a When, f64)>, Option<f64>);

/// Samples of a relative constraint; partners of an interval go through theirs at the same pace.
fn pairs<'a>(scene: &Scene, when: &When, partner: &'a Partner) -> Vec<PairSample<'a>> {
    let own = samples(scene, when);
    let Partner::Character(other) = partner else {
        return own.into_iter().map(|(frame, share)| (frame, None, share)).collect();
    };
    let (first, last) = (own[0].0, own[own.len() - 1].0);
    let (start, end) = match other {
        When::At(moment) => (frame_of(scene, moment), frame_of(scene, moment)),
        When::During(from, to) => (frame_of(scene, from), frame_of(scene, to)),
    };
    let at = |frame: f64| {
        if last > first { start + (frame - first) / (last - first) * (end - start) } else { start }
    };
    own.into_iter().map(|(frame, share)| (frame, Some((other, at(frame))), share)).collect()
}

/// The instant at a track frame, with what the rest motion says there.
fn place(scene: &Scene, rests: &[RestPath], when: &When, frame: f64) -> Place {
    let path = when.character().as_usize();
    let track = &scene.characters[path].track;
    let whole = (frame - frame.round()).abs() < 1e-9 && frame.round() < rests[path].len() as f64;
    let frame = if whole { frame.round() } else { frame };
    let detail = if whole {
        c64::default()
    } else {
        plan_of(track.pose(frame).root) - path::at(&rests[path].positions, frame)
    };
    Place { path, frame, heading: track.heading(frame), detail }
}

/// Point of the rest motion at a place.
fn rest_point(rests: &[RestPath], place: Place) -> c64 {
    path::at(&rests[place.path].positions, place.frame) + place.detail
}

fn push_pin(
    held: &mut Vec<HeldRow>,
    constraint: ConstraintId,
    strength: Strength,
    at: Place,
    kind: &ConstraintKind,
) {
    let ConstraintKind::Pin { position, facing, .. } = kind else { return };
    let holds = [
        position.map(|target| Hold::Position { at, target }),
        facing.map(|heading| Hold::Facing { at, heading }),
    ];
    held.extend(holds.into_iter().flatten().map(|hold| HeldRow { constraint, strength, hold }));
}

fn push_relative(
    held: &mut Vec<HeldRow>,
    id: ConstraintId,
    strength: Strength,
    (at, to): (Place, Option<Place>),
    (constraint, objects, rests): (&Constraint, &[Object], &[RestPath]),
) {
    let ConstraintKind::Relative { partner, offset, facing, .. } = &constraint.kind else { return };
    let own = rest_point(rests, at);
    let frame = |place: Option<Place>| match (place, partner) {
        (Some(to), _) => (rest_point(rests, to), to.heading),
        (None, Partner::Object(object)) => {
            let object = &objects[object.as_usize()];
            (object.position, object.facing)
        }
        (None, Partner::Character(_)) => (c64::default(), 0.0),
    };
    let (origin, heading) = frame(to);
    let offset = match offset {
        Relation::Given(offset) => Some(*offset),
        Relation::AsBefore => Some((own - origin) * cis(-heading)),
        Relation::Free => None,
    };
    let angle = match facing {
        Relation::Given(angle) => Some(*angle),
        Relation::AsBefore => Some(at.heading - heading),
        Relation::Free => None,
    };
    let holds = match to {
        Some(to) => [
            offset.map(|offset| Hold::Offset { at, to, offset }),
            angle.map(|angle| Hold::RelativeFacing { at, to, angle }),
        ],
        None => [
            offset.map(|offset| Hold::Position { at, target: origin + cis(heading) * offset }),
            angle.map(|angle| Hold::Facing { at, heading: heading + angle }),
        ],
    };
    held.extend(holds.into_iter().flatten().map(|hold| HeldRow { constraint: id, strength, hold }));
}

/// Rows that tie two moments, or two intervals sample by sample.
fn push_sync(
    times: &mut Vec<TimeRow>,
    constraint: ConstraintId,
    strength: Strength,
    scene: &Scene,
    (first, other, seconds): (&When, &When, f64),
) {
    let partner = Partner::Character(other.clone());
    for (frame, to, share) in pairs(scene, first, &partner) {
        let at = TimePoint { track: first.character().as_usize(), frame };
        let minus = to.map(|(when, frame)| TimePoint { track: when.character().as_usize(), frame });
        times.push(TimeRow { constraint, strength: shared(strength, share), at, minus, seconds });
    }
}

/// Sets the numbers of `row` anew from its constraint, whose structure has not changed; `true` if coefficients changed
/// rather than targets.
pub fn retarget(row: &mut HeldRow, kind: &ConstraintKind, objects: &[Object]) -> bool {
    let (held_offset, held_facing, object) = match kind {
        ConstraintKind::Pin { position, facing, .. } => {
            match &mut row.hold {
                Hold::Position { target, .. } => *target = position.unwrap_or(*target),
                Hold::Facing { heading, .. } => *heading = facing.unwrap_or(*heading),
                Hold::Offset { .. } | Hold::RelativeFacing { .. } => {}
            }
            return false;
        }
        ConstraintKind::Relative { offset, facing, partner, .. } => {
            let object = match partner {
                Partner::Object(object) => Some(&objects[object.as_usize()]),
                Partner::Character(_) => None,
            };
            (offset, facing, object)
        }
        ConstraintKind::Time { .. } | ConstraintKind::Duration { .. } | ConstraintKind::Sync { .. } => {
            return false;
        }
    };
    match (&mut row.hold, object) {
        (Hold::Position { target, .. }, Some(object)) => {
            if let Relation::Given(offset) = held_offset {
                *target = object.position + cis(object.facing) * offset;
            }
            false
        }
        (Hold::Facing { heading, .. }, Some(object)) => {
            if let Relation::Given(angle) = held_facing {
                *heading = object.facing + angle;
            }
            false
        }
        (Hold::Offset { offset, .. }, _) => replace(offset, held_offset),
        (Hold::RelativeFacing { angle, .. }, _) => replace(angle, held_facing),
        (Hold::Position { .. } | Hold::Facing { .. }, None) => false,
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
