//! From where a body is looked at: far away, so that sizes do not depend on distance.

use glam::DVec3;

use crate::export::picture::svg::Point;
use crate::geometry::{cis, world_of};

/// Side from which poses are seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StripView {
    /// From the right of the body, which looks and goes to the right of the picture.
    #[default]
    Side,
    /// From ahead: the body looks at who sees it.
    Front,
    /// From above; the body looks to the right of the picture.
    Above,
    /// From its right, ahead and a little above.
    ThreeQuarter,
}

impl StripView {
    /// How it is called in a picture.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Side => "from the side",
            Self::Front => "from the front",
            Self::Above => "from above",
            Self::ThreeQuarter => "three-quarter view",
        }
    }

    /// Angle from the body's right to its front, and above the ground, degrees.
    const fn angles(self) -> (f64, f64) {
        match self {
            Self::Side => (0.0, 7.0),
            Self::Front => (90.0, 7.0),
            Self::Above => (0.0, 90.0),
            Self::ThreeQuarter => (42.0, 16.0),
        }
    }
}

/// Axes of a picture in the world, unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Camera {
    /// To the right of the picture.
    pub(super) right: DVec3,
    /// Up the picture.
    pub(super) up: DVec3,
    /// To who looks at it.
    pub(super) towards: DVec3,
}

impl Camera {
    /// Looks at a body of some heading.
    pub(super) fn new(view: StripView, heading: f64) -> Self {
        let ahead = world_of(cis(heading), 0.0);
        let right_of_body = ahead.cross(DVec3::Y);
        let (around, above) = view.angles();
        let (around_sine, around_cosine) = around.to_radians().sin_cos();
        let level = right_of_body * around_cosine + ahead * around_sine;
        let (sine, cosine) = above.to_radians().sin_cos();
        Self {
            right: DVec3::Y.cross(level),
            up: DVec3::Y * cosine - level * sine,
            towards: DVec3::Y * sine + level * cosine,
        }
    }

    /// Where a point is seen: x right, y up.
    pub(super) fn place(&self, point: DVec3) -> Point {
        [point.dot(self.right), point.dot(self.up)]
    }

    /// How near a point is.
    pub(super) fn nearness(&self, point: DVec3) -> f64 {
        point.dot(self.towards)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a few products.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn a_body_seen_from_the_side_goes_to_the_right_with_its_right_hand_nearer() {
        // Heading 0: ahead is +x, the body's right is +z.
        let camera = Camera::new(StripView::Side, 0.0);
        assert!((camera.place(DVec3::X)[0] - 1.0).abs() < ROUNDING);
        assert!(camera.nearness(DVec3::Z) > 0.9);
        let front = Camera::new(StripView::Front, 0.0);
        assert!(
            (front.place(DVec3::NEG_Z)[0] - 1.0).abs() < ROUNDING,
            "its left is on the right of the picture"
        );
        assert!(front.nearness(DVec3::X) > 0.9);
        let above = Camera::new(StripView::Above, 0.0);
        assert!((above.place(DVec3::X)[0] - 1.0).abs() < ROUNDING);
        assert!((above.place(DVec3::NEG_Z)[1] - 1.0).abs() < ROUNDING);
    }

    #[test]
    fn axes_are_right_handed_in_every_view() {
        for view in [StripView::Side, StripView::Front, StripView::Above, StripView::ThreeQuarter] {
            let Camera { right, up, towards } = Camera::new(view, 0.7);
            assert!((right.cross(up) - towards).length() < ROUNDING, "{view:?}");
        }
    }
}
