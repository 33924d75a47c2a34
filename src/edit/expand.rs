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
    for (index, Constraint { strength, kind, .. }) in scene.constraints.iter().enumerate() {
        let constraint = ConstraintId::from_usize(index);
        expansion.held.extend(holds(scene, rests, kind).into_iter().map(|(hold, share)| HeldRow {
            constraint,
            strength: shared(*strength, share),
            hold,
        }));
        expansion.times.extend(ties(scene, kind).into_iter().map(|tie| TimeRow {
            constraint,
            strength: shared(*strength, tie.share),
            at: tie.at,
            minus: tie.minus,
            seconds: tie.seconds,
        }));
    }
    expansion
}

/// What a spatial constraint holds at each of its samples, with the sample's share of an interval.
fn holds(scene: &Scene, rests: &[RestPath], kind: &ConstraintKind) -> Vec<(Hold, Option<f64>)> {
    let mut all = Vec::new();
    match kind {
        ConstraintKind::Pin { when, position, facing } => {
            for (frame, share) in samples(scene, when) {
                let at = place(scene, rests, when, frame);
                all.extend(position.map(|target| (Hold::Position { at, target }, share)));
                all.extend(facing.map(|heading| (Hold::Facing { at, heading }, share)));
            }
        }
        ConstraintKind::Relative { when, partner, offset, facing } => {
            for (frame, to, share) in pairs(scene, when, partner) {
                let at = place(scene, rests, when, frame);
                let frame = match (to, partner) {
                    (Some((when, frame)), _) => Frame::Body(place(scene, rests, when, frame)),
                    (None, Partner::Object(object)) => Frame::Object(&scene.objects[object.as_usize()]),
                    (None, Partner::Character(_)) => continue,
                };
                let holds = relative_holds(rests, at, frame, (*offset, *facing));
                all.extend(holds.into_iter().flatten().map(|hold| (hold, share)));
            }
        }
        ConstraintKind::Time { .. } | ConstraintKind::Duration { .. } | ConstraintKind::Sync { .. } => {}
    }
    all
}

/// Whose facing and place a relative constraint counts from.
enum Frame<'a> {
    Body(Place),
    Object(&'a Object),
}

fn relative_holds(
    rests: &[RestPath],
    at: Place,
    frame: Frame,
    (offset, facing): (Relation<c64>, Relation<f64>),
) -> [Option<Hold>; 2] {
    let (origin, heading) = match frame {
        Frame::Body(to) => (rest_point(rests, to), to.heading),
        Frame::Object(object) => (object.position, object.facing),
    };
    let before = (rest_point(rests, at) - origin) * cis(-heading);
    let offset = value(offset, before);
    let angle = value(facing, at.heading - heading);
    match frame {
        Frame::Body(to) => [
            offset.map(|offset| Hold::Offset { at, to, offset }),
            angle.map(|angle| Hold::RelativeFacing { at, to, angle }),
        ],
        Frame::Object(_) => [
            offset.map(|offset| Hold::Position { at, target: origin + cis(heading) * offset }),
            angle.map(|angle| Hold::Facing { at, heading: heading + angle }),
        ],
    }
}

/// The value that a relation holds, if any; `before`: the one before the edit.
fn value<T>(relation: Relation<T>, before: T) -> Option<T> {
    match relation {
        Relation::Given(value) => Some(value),
        Relation::AsBefore => Some(before),
        Relation::Free => None,
    }
}

/// What a temporal constraint ties at one of its samples.
struct Tie {
    at: TimePoint,
    minus: Option<TimePoint>,
    seconds: f64,
    share: Option<f64>,
}

fn ties(scene: &Scene, kind: &ConstraintKind) -> Vec<Tie> {
    match kind {
        ConstraintKind::Time { at, seconds } => {
            vec![Tie { at: time_point(scene, at), minus: None, seconds: *seconds, share: None }]
        }
        ConstraintKind::Duration { from, to, seconds } => {
            let minus = Some(time_point(scene, from));
            vec![Tie { at: time_point(scene, to), minus, seconds: *seconds, share: None }]
        }
        ConstraintKind::Sync { moments, offset } => {
            moments[1..].iter().flat_map(|other| sync_ties(scene, &moments[0], other, *offset)).collect()
        }
        ConstraintKind::Pin { .. } | ConstraintKind::Relative { .. } => Vec::new(),
    }
}

/// Ties of two moments, or of two intervals sample by sample.
fn sync_ties(scene: &Scene, first: &When, other: &When, seconds: f64) -> Vec<Tie> {
    let partner = Partner::Character(other.clone());
    let tie = |(frame, to, share): PairSample| Tie {
        at: TimePoint { track: first.character().as_usize(), frame },
        minus: to.map(|(when, frame)| TimePoint { track: when.character().as_usize(), frame }),
        seconds,
        share,
    };
    pairs(scene, first, &partner).into_iter().map(tie).collect()
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
