//! The way that locomotion takes: straight, or round a circle.
//!
//! Places on it are *course coordinates*: x to its left, y up, z along it, metres. The course begins at the origin along +z.
//! On a straight course they are the world's, to the bit.

use glam::{DQuat, DVec3};

use super::limbs::Foot;
use crate::geometry::yaw;
use crate::skeleton::Pose;

/// A course of constant curvature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Course {
    /// One over the radius, 1/m; positive to the left.
    pub(super) curvature: f64,
}

/// Rigid motion from the course straightened at one place to the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Where on the course, metres.
    along: f64,
    /// Where in the world.
    origin: DVec3,
    /// About +y, radians.
    pub(super) heading: f64,
    straight: bool,
}

impl Course {
    /// The place `along` metres from the beginning.
    pub(super) fn place(&self, along: f64) -> Place {
        let heading = self.curvature * along;
        let straight = self.curvature == 0.0;
        let origin = if straight {
            DVec3::Z * along
        } else {
            DVec3::new(2.0 * (0.5 * heading).sin().powi(2), 0.0, heading.sin()) / self.curvature
        };
        Place { along, origin, heading, straight }
    }

    /// World position of a point in course coordinates.
    pub(super) fn to_world(self, point: DVec3) -> DVec3 {
        self.place(point.z).to_world(point)
    }

    /// Course coordinates of a point that is given in the course straightened at `place`, less than half a circle away.
    pub(super) fn bend(&self, place: Place, point: DVec3) -> DVec3 {
        if place.straight {
            return point;
        }
        let (x, z, curvature) = (point.x, point.z - place.along, self.curvature);
        let towards_center = 1.0 - curvature * x;
        let radius = towards_center.hypot(curvature * z);
        // (1 − radius) / curvature, without cancellation on wide curves.
        let left = (2.0 * x - curvature * (x * x + z * z)) / (1.0 + radius);
        DVec3::new(left, point.y, place.along + (curvature * z).atan2(towards_center) / curvature)
    }
}

impl Place {
    /// World position of a point on the course straightened here.
    pub(super) fn to_world(self, point: DVec3) -> DVec3 {
        if self.straight {
            return point;
        }
        self.origin + self.turn() * (point - DVec3::Z * self.along)
    }

    /// A foot of the world on the course straightened here.
    pub(super) fn straighten(self, foot: Foot) -> Foot {
        if self.straight {
            return foot;
        }
        let ankle = self.turn().inverse() * (foot.ankle - self.origin) + DVec3::Z * self.along;
        Foot { ankle, turn: foot.turn - self.heading, ..foot }
    }

    /// Takes a pose on the course straightened here to the world.
    pub(super) fn bring(self, pose: &mut Pose) {
        if !self.straight {
            pose.root = self.to_world(pose.root);
            pose.rotations[0] = self.turn() * pose.rotations[0];
        }
    }

    fn turn(self) -> DQuat {
        yaw(self.heading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_of_a_circle_ends_beside_its_centre() {
        let course = Course { curvature: 0.5 };
        let end = course.to_world(DVec3::new(0.0, 1.0, std::f64::consts::PI));
        assert!(end.distance(DVec3::new(2.0, 1.0, 2.0)) < 1e-12, "{end}");
        let left = course.to_world(DVec3::new(0.3, 1.0, std::f64::consts::PI));
        assert!(left.distance(DVec3::new(2.0, 1.0, 1.7)) < 1e-12, "{left}");
    }

    #[test]
    fn course_coordinates_come_back() {
        for curvature in [-1.5, -1e-9, 1e-4, 0.7] {
            let course = Course { curvature };
            let place = course.place(9.0);
            let point = DVec3::new(0.2, 0.1, 9.4);
            let straightened = place.straighten(Foot {
                ankle: course.to_world(point),
                turn: course.place(9.4).heading,
                pitch: 0.0,
                toe: 0.0,
            });
            assert!(course.bend(place, straightened.ankle).distance(point) < 1e-12);
            assert!((straightened.turn - 0.4 * curvature).abs() < 1e-12);
        }
    }
}
