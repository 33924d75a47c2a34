//! Plants: stretches in which a foot bears, and where it is to stand in each.

use glam::{DQuat, DVec3};

use crate::clip::contacts::{FootContacts, FootPoint, runs};
use crate::clip::facing::turn_about_up;
use crate::full_body::chain::{EndPose, Place};
use crate::full_body::fade::Span;
use crate::geometry::{RigidMotion, c64, cis, plan_of, yaw};

/// One leg along the samples.
#[derive(Clone, Debug, PartialEq)]
pub struct LegTrack {
    /// Where it is as captured, before the edit.
    pub rest: Vec<Place>,
    /// Where the edit of the path carries it.
    pub moved: Vec<Place>,
    /// When its heel bears.
    pub heel: Vec<bool>,
    /// When its toe bears.
    pub toe: Vec<bool>,
}

/// By how much a foot is displaced: its ankle, metres, and the foot, a rotation vector in the world's axes.
pub type Displacement = [DVec3; 2];

/// A stretch in which any point of one foot bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    /// When.
    pub span: Span,
    /// Motion of the ground that takes the captured foot to where it is to stand.
    pub motion: RigidMotion,
}

impl Plant {
    /// The foot `rest`, moved with the ground; its height stays.
    pub fn carry(&self, rest: &EndPose) -> EndPose {
        EndPose {
            position: self.motion.apply_world(rest.position),
            rotation: yaw(self.motion.angle()) * rest.rotation,
        }
    }
}

/// Heel and toe of one side: 0 the left, 1 the right.
pub const fn points(side: usize) -> [FootPoint; 2] {
    if side == 0 {
        [FootPoint::LeftHeel, FootPoint::LeftToe]
    } else {
        [FootPoint::RightHeel, FootPoint::RightToe]
    }
}

/// When the heel and the toe of one side bear.
pub fn bearing(contacts: &[FootContacts], side: usize) -> [Vec<bool>; 2] {
    points(side).map(|point| contacts.iter().map(|contact| contact.at(point)).collect())
}

/// The plants of a leg, in the order of time: one for each stretch in which heel or toe bear.
pub fn plants(leg: &LegTrack) -> Vec<Plant> {
    let bears: Vec<bool> = leg.heel.iter().zip(&leg.toe).map(|(heel, toe)| *heel || *toe).collect();
    let plant = |(first, last)| Plant { span: Span { first, last }, motion: ground_motion(leg, first, last) };
    runs(&bears).into_iter().map(plant).collect()
}

/// The rigid motion of the ground nearest to what the edit does to the foot from sample `first` to `last`: its mean turn,
/// and the mean place of the point (ankle or toe) that bears longer.
fn ground_motion(leg: &LegTrack, first: usize, last: usize) -> RigidMotion {
    let turn =
        (first..=last).map(|at| cis(turn_about_up(turn_between(&leg.rest[at], &leg.moved[at])))).sum::<c64>();
    let angle = turn.arg();
    let count = |labels: &[bool]| labels[first..=last].iter().filter(|label| **label).count();
    let by_heel = count(&leg.heel) >= count(&leg.toe);
    let labels = if by_heel { &leg.heel } else { &leg.toe };
    let point = |place: &Place| plan_of(if by_heel { place.limb.lower } else { place.end });
    let mean = |places: &[Place]| {
        let bearing = (first..=last).filter(|at| labels[*at]);
        bearing.map(|at| point(&places[at])).sum::<c64>() / count(labels) as f64
    };
    RigidMotion::carrying(mean(&leg.rest), mean(&leg.moved), angle)
}

/// Turn of the foot from `rest` to `moved`, in the world.
fn turn_between(rest: &Place, moved: &Place) -> DQuat {
    moved.lower_rotation * rest.lower_rotation.inverse()
}
