//! Plants: stretches in which a foot (or a hand) bears, and where it is to stand in each.

use glam::{DQuat, DVec3};

use crate::clip::contacts::{ContactPoint, Contacts, runs};
use crate::clip::facing::turn_about_up;
use crate::full_body::chain::{EndPose, Place};
use crate::full_body::fade::Span;
use crate::geometry::{RigidMotion, c64, cis, plan_of, yaw};

/// One leg along the samples, or an arm, whose hand is like a heel.
#[derive(Clone, Debug, PartialEq)]
pub struct LegTrack {
    /// Where it is as captured, before the edit; where it stands through a seam, as [`crate::full_body::seams`] has it.
    pub rest: Vec<Place>,
    /// Where the edit of the path carries it.
    pub moved: Vec<Place>,
    /// When its heel bears.
    pub heel: Vec<bool>,
    /// When its toe bears.
    pub toe: Vec<bool>,
}

impl LegTrack {
    /// When heel or toe bears.
    pub fn bears(&self) -> Vec<bool> {
        self.heel.iter().zip(&self.toe).map(|(heel, toe)| *heel || *toe).collect()
    }
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

/// What bears on a limb: its lower joint (a heel or a hand), and its end (a toe).
pub type Soles = [Option<ContactPoint>; 2];

/// Of the legs, left and right.
pub const FEET: [Soles; 2] = [
    [Some(ContactPoint::LeftHeel), Some(ContactPoint::LeftToe)],
    [Some(ContactPoint::RightHeel), Some(ContactPoint::RightToe)],
];

/// Of the arms, left and right.
pub const HANDS: [Soles; 2] = [[Some(ContactPoint::LeftHand), None], [Some(ContactPoint::RightHand), None]];

/// When the lower joint and the end of a limb bear.
pub fn bearing(contacts: &[Contacts], soles: Soles) -> [Vec<bool>; 2] {
    let bears = |sole: Option<ContactPoint>, contact: &Contacts| sole.is_some_and(|point| contact.at(point));
    soles.map(|sole| contacts.iter().map(|contact| bears(sole, contact)).collect())
}

/// The plants of a leg, in the order of time: one for each stretch in which heel or toe bear.
pub fn plants(times: &[f64], leg: &LegTrack) -> Vec<Plant> {
    let spans = runs(&leg.bears()).into_iter().map(|(first, last)| Span { first, last });
    spans.map(|span| Plant { span, motion: ground_motion(times, leg, span) }).collect()
}

/// The rigid motion of the ground nearest to what the edit does to the foot during `span`: its mean turn, and the mean place
/// of the point (ankle or toe) that bears longer. Means are over time, so that extra samples do not count.
fn ground_motion(times: &[f64], leg: &LegTrack, span: Span) -> RigidMotion {
    let Span { first, last } = span;
    let stands_for = |at: usize| match times[(at + 1).min(last)] - times[at.saturating_sub(1).max(first)] {
        0.0 => 1.0,
        time => time,
    };
    let turn: c64 = (first..=last)
        .map(|at| cis(turn_about_up(turn_between(&leg.rest[at], &leg.moved[at]))) * stands_for(at))
        .sum();
    let time = |labels: &[bool]| -> f64 { (first..=last).filter(|at| labels[*at]).map(stands_for).sum() };
    let by_heel = time(&leg.heel) >= time(&leg.toe);
    let labels = if by_heel { &leg.heel } else { &leg.toe };
    let point = |place: &Place| plan_of(if by_heel { place.limb.lower } else { place.end });
    let mean = |places: &[Place]| {
        let bearing = (first..=last).filter(|at| labels[*at]);
        bearing.map(|at| point(&places[at]) * stands_for(at)).sum::<c64>() / time(labels)
    };
    RigidMotion::carrying(mean(&leg.rest), mean(&leg.moved), turn.arg())
}

/// Turn of the foot from `rest` to `moved`, in the world.
fn turn_between(rest: &Place, moved: &Place) -> DQuat {
    moved.lower_rotation * rest.lower_rotation.inverse()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::limb::Limb;

    /// Rounding of a few operations on metres.
    const ROUNDING: f64 = 1e-12;

    /// A foot that stands `at`, turned by `heading`, its toe 0.2 m ahead.
    fn foot(at: c64, heading: f64) -> Place {
        let lower = crate::geometry::world_of(at, 0.08);
        let limb = Limb { upper: lower + DVec3::Y * 0.8, middle: lower + DVec3::Y * 0.4, lower };
        let rotation = yaw(heading);
        Place {
            limb,
            upper_rotation: rotation,
            lower_rotation: rotation,
            end: lower + rotation * DVec3::X * 0.2,
        }
    }

    #[test]
    fn a_rigid_edit_is_found_again_and_a_sliding_one_meets_in_the_middle() {
        let times: Vec<f64> = (0..11).map(|k| f64::from(k) / 30.0).collect();
        let rest: Vec<Place> = (0..11).map(|k| foot(c64::new(0.001 * f64::from(k), 1.0), 0.3)).collect();
        let moved: Vec<Place> = (0..11)
            .map(|k| {
                let slide = 0.01 * f64::from(k - 5);
                foot(c64::new(-1.0, 0.001 * f64::from(k) + slide), 0.3 + FRAC_PI_2 + slide)
            })
            .collect();
        let leg = LegTrack { rest, moved, heel: vec![true; 11], toe: vec![false; 11] };
        let found = plants(&times, &leg);
        assert_eq!(found.len(), 1);
        assert!((found[0].motion.angle() - FRAC_PI_2).abs() < ROUNDING);
        for k in 0..11 {
            let carried = found[0].carry(&leg.rest[k].end_pose());
            let expected = c64::new(-1.0, 0.001 * k as f64);
            assert!((plan_of(carried.position) - expected).norm() < ROUNDING);
            assert_eq!(carried.position.y, 0.08);
        }
    }
}
