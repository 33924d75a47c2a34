//! From a scene's constraints to rows at single instants. Source: Kim et al. 2009, §4.2–4.3.

use std::collections::BTreeMap;

use crate::constraint::{Captured, Constraint, ConstraintKind, Moment, Partner, Relation, Strength, When};
use crate::edit::hold::{HeldRow, Hold, Place};
use crate::edit::time_row::{TimePoint, TimeRow};
use crate::geometry::{c64, cis, plan_of};
use crate::index::{CharacterId, ConstraintId, ObjectId};
use crate::object::ObjectPose;
use crate::object_motion::{AtRest, Objects, Performance};
use crate::path::{self, RestPath};
use crate::scene::Scene;

/// Frames between the samples of an interval.
const SAMPLE_STRIDE: f64 = 10.0;

/// Rows of all constraints of a scene; paths and tracks are numbered as its characters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expansion {
    /// Spatial rows, in the order of the constraints.
    pub held: Vec<HeldRow>,
    /// Temporal rows, in the order of the constraints.
    pub times: Vec<TimeRow>,
    /// Spatial rows relative to objects that move, rising.
    pub following: Vec<Following>,
}

/// A row relative to an object that moves. What it binds is known once times are; before, it is as at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following {
    /// Position in [`Expansion::held`].
    pub row: usize,
    /// Whose row it is.
    pub constraint: ConstraintId,
    /// Which object.
    pub object: ObjectId,
    /// Who and when.
    pub at: Place,
    /// What the constraint wanted if it asked for what was before the edit.
    pub before: Wanted,
}

/// What a row wants relative to an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wanted {
    /// Ahead + i·left of the object, metres.
    Offset(c64),
    /// Facing minus the object's, radians.
    Facing(f64),
}

/// Expands every constraint of `scene`, whose characters have the rest paths `rests`.
pub fn expand(scene: &Scene, rests: &[RestPath]) -> Expansion {
    expand_some(scene, &rests.iter().collect::<Vec<_>>(), |_| true)
}

/// Expands the constraints that are `wanted`.
pub fn expand_some(
    scene: &Scene,
    rests: &[&RestPath],
    wanted: impl Fn(&ConstraintKind) -> bool,
) -> Expansion {
    let performance = AtRest(scene);
    let rest = Rest { scene, rests, objects: Objects::new(scene, &performance, &[]) };
    let mut expansion = Expansion { times: expand_times(scene, &wanted), ..Expansion::default() };
    let constraints = scene.constraints.iter().enumerate().filter(|(_, constraint)| wanted(&constraint.kind));
    for (index, Constraint { strength, kind, .. }) in constraints {
        let constraint = ConstraintId::from_usize(index);
        for Sample { hold, share, follows } in holds(&rest, (constraint, kind)) {
            let row = expansion.held.len();
            expansion.following.extend(follows.map(|(object, before)| Following {
                row,
                constraint,
                object,
                at: hold.at(),
                before,
            }));
            expansion.held.push(HeldRow { constraint, strength: shared(*strength, share), hold });
        }
    }
    expansion
}

/// Temporal rows of the constraints that are `wanted`.
fn expand_times(scene: &Scene, wanted: impl Fn(&ConstraintKind) -> bool) -> Vec<TimeRow> {
    let constraints = scene.constraints.iter().enumerate().filter(|(_, constraint)| wanted(&constraint.kind));
    let rows = |(index, constraint): (usize, &Constraint)| {
        let row = move |tie: Tie| TimeRow {
            constraint: ConstraintId::from_usize(index),
            strength: shared(constraint.strength, tie.share),
            at: tie.at,
            minus: tie.minus,
            seconds: tie.seconds,
        };
        ties(scene, &constraint.kind).into_iter().map(row).collect::<Vec<_>>()
    };
    constraints.flat_map(rows).collect()
}

/// The scene before the edit.
struct Rest<'a> {
    scene: &'a Scene,
    rests: &'a [&'a RestPath],
    objects: Objects<'a, AtRest<'a>>,
}

/// What is held at one instant.
struct Sample {
    hold: Hold,
    /// Of an interval, frames.
    share: Option<f64>,
    /// The object that moves, and what was before the edit.
    follows: Option<(ObjectId, Wanted)>,
}

/// What a spatial constraint holds at each of its samples, with the sample's share of an interval.
fn holds(rest: &Rest<'_>, (constraint, kind): (ConstraintId, &ConstraintKind)) -> Vec<Sample> {
    let (scene, rests) = (rest.scene, rest.rests);
    let mut all = Vec::new();
    let alone = |share: Option<f64>| move |hold: Hold| Sample { hold, share, follows: None };
    let captured = scene.captured.get(&constraint);
    match kind {
        ConstraintKind::Pin { when, position, facing } => {
            for (frame, share) in samples(scene, when) {
                let at = place(scene, rests, when, frame);
                all.extend(position.map(|target| Hold::Position { at, target }).map(alone(share)));
                all.extend(facing.map(|heading| Hold::Facing { at, heading }).map(alone(share)));
            }
        }
        ConstraintKind::Relative { when, partner, offset, facing } => {
            let samples = pairs(scene, when, partner);
            let shares = shares(&samples);
            for ((frame, to, share), passed) in samples.into_iter().zip(shares) {
                let at = place(scene, rests, when, frame);
                let known = captured.map(|captured| captured.at(passed));
                match (to, partner) {
                    (Some((when, frame)), _) => {
                        let to = place(scene, rests, when, frame);
                        let before = known.unwrap_or_else(|| beside(rests, at, to));
                        let holds = body_holds((at, to), before, (*offset, *facing));
                        all.extend(holds.into_iter().flatten().map(alone(share)));
                    }
                    (None, Partner::Object(object)) => {
                        let holds = object_holds(rest, (at, known), *object, (*offset, *facing));
                        all.extend(holds.into_iter().flatten().map(|(hold, before)| {
                            let follows = scene.moves(*object).then_some((*object, before));
                            Sample { hold, share, follows }
                        }));
                    }
                    (None, Partner::Character(_)) => {}
                }
            }
        }
        ConstraintKind::Time { .. } | ConstraintKind::Duration { .. } | ConstraintKind::Sync { .. } => {}
    }
    all
}

/// Offset and facing of one place relative to another before the edit.
fn beside(rests: &[&RestPath], at: Place, to: Place) -> (c64, f64) {
    let offset = (rest_point(rests, at) - rest_point(rests, to)) * cis(-to.heading);
    (offset, at.heading - to.heading)
}

fn body_holds(
    (at, to): (Place, Place),
    before: (c64, f64),
    (offset, facing): (Relation<c64>, Relation<f64>),
) -> [Option<Hold>; 2] {
    [
        value(offset, before.0).map(|offset| Hold::Offset { at, to, offset }),
        value(facing, before.1).map(|angle| Hold::RelativeFacing { at, to, angle }),
    ]
}

/// Share of the interval that has passed at each of its samples; 0 at an instant.
fn shares(samples: &[PairSample<'_>]) -> Vec<f64> {
    let (first, last) = (samples[0].0, samples[samples.len() - 1].0);
    let share =
        |(frame, ..): &PairSample<'_>| if last > first { (frame - first) / (last - first) } else { 0.0 };
    samples.iter().map(share).collect()
}

/// What the constraints of `scene` that ask for what was before the edit have now. Cost: that of [`expand`].
pub fn capture(scene: &Scene, rests: &[RestPath]) -> BTreeMap<ConstraintId, Captured> {
    let rests: &[&RestPath] = &rests.iter().collect::<Vec<_>>();
    let performance = AtRest(scene);
    let rest = Rest { scene, rests, objects: Objects::new(scene, &performance, &[]) };
    let mut all = BTreeMap::new();
    for (index, constraint) in scene.constraints.iter().enumerate() {
        let ConstraintKind::Relative { when, partner, offset, facing } = &constraint.kind else { continue };
        if *offset != Relation::AsBefore && *facing != Relation::AsBefore {
            continue;
        }
        let samples = pairs(scene, when, partner);
        let mut captured = Captured { shares: shares(&samples), ..Captured::default() };
        for (frame, to, _) in samples {
            let at = place(scene, rests, when, frame);
            let (offset, facing) = match (to, partner) {
                (Some((when, frame)), _) => beside(rests, at, place(scene, rests, when, frame)),
                (None, Partner::Object(object)) => beside_object(&rest, at, *object).1,
                (None, Partner::Character(_)) => continue,
            };
            captured.offsets.push(offset);
            captured.facings.push(facing);
        }
        all.insert(ConstraintId::from_usize(index), captured);
    }
    all
}

/// Pose of an object before the edit at the time of a place, and offset and facing of the place relative to it.
fn beside_object(rest: &Rest<'_>, at: Place, object: ObjectId) -> (ObjectPose, (c64, f64)) {
    let seconds = AtRest(rest.scene).time(CharacterId::from_usize(at.path), at.frame);
    let pose = rest.objects.pose_at(object, seconds);
    let offset = (rest_point(rest.rests, at) - pose.plan()) * cis(-pose.facing);
    (pose, (offset, at.heading - pose.facing))
}

/// Place and facing relative to an object where it is at rest, each with its value before the edit.
fn object_holds(
    rest: &Rest<'_>,
    (at, known): (Place, Option<(c64, f64)>),
    object: ObjectId,
    (offset, facing): (Relation<c64>, Relation<f64>),
) -> [Option<(Hold, Wanted)>; 2] {
    let asked = known.is_none() && (offset == Relation::AsBefore || facing == Relation::AsBefore);
    let (pose, (before, turned)) = if asked || !rest.scene.moves(object) {
        let (pose, found) = beside_object(rest, at, object);
        (pose, known.unwrap_or(found))
    } else {
        // Where it is then, solves tell.
        (ObjectPose::default(), known.unwrap_or_default())
    };
    let position = value(offset, before).map(|offset| Hold::Position { at, target: pose.beside(offset) });
    let heading = value(facing, turned).map(|angle| Hold::Facing { at, heading: pose.facing + angle });
    [position.map(|hold| (hold, Wanted::Offset(before))), heading.map(|hold| (hold, Wanted::Facing(turned)))]
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

fn time_point(scene: &Scene, moment: &Moment) -> TimePoint {
    TimePoint { track: moment.character.as_usize(), frame: scene.frame_of(moment) }
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
        When::At(moment) => vec![(scene.frame_of(moment), None)],
        When::During(from, to) => interval(scene.frame_of(from), scene.frame_of(to))
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
        When::At(moment) => (scene.frame_of(moment), scene.frame_of(moment)),
        When::During(from, to) => (scene.frame_of(from), scene.frame_of(to)),
    };
    let at = |frame: f64| {
        if last > first { start + (frame - first) / (last - first) * (end - start) } else { start }
    };
    own.into_iter().map(|(frame, share)| (frame, Some((other, at(frame))), share)).collect()
}

/// The instant at a track frame, with what the rest motion says there.
fn place(scene: &Scene, rests: &[&RestPath], when: &When, frame: f64) -> Place {
    let path = when.character().as_usize();
    let (track, rest) = (&scene.characters[path].track, rests[path]);
    let whole = (frame - frame.round()).abs() < 1e-9 && frame.round() < rest.len() as f64;
    let frame = if whole { frame.round() } else { frame };
    let detail = if whole {
        c64::default()
    } else {
        plan_of(track.pose(frame).root) - path::at(&rest.positions, frame)
    };
    Place { path, frame, heading: track.heading(frame), detail }
}

/// Point of the rest motion at a place.
fn rest_point(rests: &[&RestPath], place: Place) -> c64 {
    path::at(&rests[place.path].positions, place.frame) + place.detail
}
