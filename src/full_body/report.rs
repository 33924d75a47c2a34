//! What was done to a body, and by how much it misses.

use glam::DVec3;

use crate::clip::contacts::{ContactPoint, Contacts, contact_point, runs};
use crate::full_body::BodyInput;
use crate::full_body::chain::world_frame;
use crate::full_body::feet::Leg;
pub use crate::full_body::feet::TOLERATED;
use crate::geometry::log;
use crate::index::JointId;
use crate::skeleton::{Pose, Skeleton};

/// What [`crate::full_body::refine`] did, and what it could not do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyReport {
    /// Ends and feet that stay farther than [`TOLERATED`] from where they must be, the worst sample of each stretch.
    pub shortfalls: Vec<Shortfall>,
    /// Largest shift of the root, metres.
    pub root_shift: f64,
    /// Largest shift of the root downwards, metres.
    pub root_drop: f64,
    /// Largest change of a joint's angle; `None` where none changed.
    pub largest_change: Option<JointChange>,
    /// Every stretch in which a point of a foot, or a hand, is planted.
    pub plants: Vec<PlantedPoint>,
    /// Every whole contact of such a point, whether or not it is planted all along.
    pub contacts: Vec<WholeContact>,
}

/// A contact of a point of a foot, or of a hand, from its first to its last sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WholeContact {
    /// Which point.
    pub point: ContactPoint,
    /// First sample.
    pub first: usize,
    /// Last sample.
    pub last: usize,
    /// Share of its samples at which the point is planted: fewer than all where feet are pinned, which hold what stands
    /// still, and about targets for a foot that bears.
    pub held: f64,
    /// Largest distance from its mean place as captured, metres …
    pub captured_drift: f64,
    /// … and in the result.
    pub drift: f64,
}

impl WholeContact {
    /// As if it were planted all along.
    pub fn as_plant(&self) -> PlantedPoint {
        let Self { point, first, last, captured_drift, drift, .. } = *self;
        PlantedPoint { point, first, last, captured_drift, drift }
    }
}

/// A joint that does not get where it must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shortfall {
    /// Which one.
    pub joint: JointId,
    /// Worst sample.
    pub sample: usize,
    /// What is missing there, metres.
    pub metres: f64,
}

/// A joint that was turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointChange {
    /// Which one.
    pub joint: JointId,
    /// At which sample.
    pub sample: usize,
    /// By how much, radians.
    pub angle: f64,
}

/// A point of a foot, or a hand, while it is planted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantedPoint {
    /// Which point.
    pub point: ContactPoint,
    /// First sample.
    pub first: usize,
    /// Last sample.
    pub last: usize,
    /// Largest distance from its mean place as captured, without what seams shift it by, metres …
    pub captured_drift: f64,
    /// … and in the result.
    pub drift: f64,
}

/// Measures the result `poses`.
pub(super) fn report(
    skeleton: &Skeleton,
    input: &BodyInput,
    (legs, planted): (&[Leg], &[Contacts]),
    poses: &[Pose],
) -> BodyReport {
    let shifts = || poses.iter().zip(&input.moved).map(|(pose, moved)| pose.root - moved.root);
    BodyReport {
        shortfalls: shortfalls(skeleton, input, legs, poses),
        root_shift: shifts().map(DVec3::length).fold(0.0, f64::max),
        root_drop: shifts().map(|shift| -shift.y).fold(0.0, f64::max),
        largest_change: largest_change(&input.moved, poses),
        plants: plants(skeleton, (&input.rest, legs), planted, poses),
        contacts: whole_contacts(skeleton, (input, legs), planted, poses),
    }
}

fn shortfalls(skeleton: &Skeleton, input: &BodyInput, legs: &[Leg], poses: &[Pose]) -> Vec<Shortfall> {
    let mut found = Vec::new();
    for leg in legs {
        let joint = leg.chain.lower;
        let missing = |at: usize| {
            if leg.bound[at] { leg.miss(at, &leg.chain.place(skeleton, &poses[at])) } else { 0.0 }
        };
        push_worst(&mut found, joint, 0, (0..poses.len()).map(missing).collect());
    }
    for end in &input.effectors {
        let misses = (end.first..end.first + end.targets.len())
            .map(|at| end.shortfall(skeleton, &poses[at], at).unwrap_or(0.0))
            .collect();
        push_worst(&mut found, end.joint, end.first, misses);
    }
    found
}

/// The worst of each stretch of misses above what is tolerated.
fn push_worst(found: &mut Vec<Shortfall>, joint: JointId, first: usize, misses: Vec<f64>) {
    let labels: Vec<bool> = misses.iter().map(|miss| *miss > TOLERATED).collect();
    for (start, end) in runs(&labels) {
        let worst = (start..=end).max_by(|a, b| misses[*a].total_cmp(&misses[*b])).unwrap_or(start);
        found.push(Shortfall { joint, sample: first + worst, metres: misses[worst] });
    }
}

fn largest_change(before: &[Pose], after: &[Pose]) -> Option<JointChange> {
    let mut largest: Option<JointChange> = None;
    for (sample, (before, after)) in before.iter().zip(after).enumerate() {
        for (joint, (from, to)) in before.rotations.iter().zip(&after.rotations).enumerate() {
            if from == to {
                continue;
            }
            let angle = log(from.inverse() * *to).length();
            if largest.is_none_or(|largest| angle > largest.angle) {
                largest = Some(JointChange { joint: JointId::from_usize(joint), sample, angle });
            }
        }
    }
    largest
}

fn plants(
    skeleton: &Skeleton,
    (rest, legs): (&[Pose], &[Leg]),
    planted: &[Contacts],
    poses: &[Pose],
) -> Vec<PlantedPoint> {
    let mut found = Vec::new();
    for point in ContactPoint::ALL {
        let Some(at) = contact_point(skeleton, point) else {
            continue;
        };
        let labels: Vec<bool> = planted.iter().map(|contact| contact.at(point)).collect();
        let place = |pose: &Pose| {
            let frame = world_frame(skeleton, pose, at.joint);
            frame.position + frame.rotation * at.local
        };
        let of_leg = legs.iter().find_map(|leg| leg.captured(point));
        let captured = of_leg.unwrap_or_else(|| rest.iter().map(place).collect());
        for (first, last) in runs(&labels) {
            let captured_drift = drift(&captured[first..=last]);
            let drift = drift(&poses[first..=last].iter().map(place).collect::<Vec<_>>());
            found.push(PlantedPoint { point, first, last, captured_drift, drift });
        }
    }
    found
}

fn whole_contacts(
    skeleton: &Skeleton,
    (input, legs): (&BodyInput, &[Leg]),
    planted: &[Contacts],
    poses: &[Pose],
) -> Vec<WholeContact> {
    let whole = |plant: PlantedPoint| {
        let PlantedPoint { point, first, last, captured_drift, drift } = plant;
        let held = planted[first..=last].iter().filter(|contact| contact.at(point)).count();
        let held = held as f64 / (last + 1 - first) as f64;
        WholeContact { point, first, last, held, captured_drift, drift }
    };
    plants(skeleton, (&input.rest, legs), &input.contacts, poses).into_iter().map(whole).collect()
}

/// Largest distance of places from their mean, metres.
fn drift(places: &[DVec3]) -> f64 {
    let mean = places.iter().sum::<DVec3>() / places.len() as f64;
    places.iter().map(|place| place.distance(mean)).fold(0.0, f64::max)
}
