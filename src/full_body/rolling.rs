//! Feet that are held by their toes alone: they roll about these as the knee likes it.

use glam::DVec3;

use crate::full_body::chain::{EndPose, Place};
use crate::full_body::feet::Leg;
use crate::limb::{Limb, minimal_rotation};

impl Leg {
    /// Whether the foot stands on its toe alone at sample `at`, held still, and may roll about it.
    pub fn is_rolling(&self, at: usize) -> bool {
        self.rolls[at] && self.stands(at)
    }

    /// From the ankle of `foot`, which is that of sample `at` moved, to its toe.
    pub fn to_toe(&self, at: usize, foot: &EndPose) -> DVec3 {
        let own = &self.track.moved[at];
        foot.rotation * own.lower_rotation.inverse() * (own.end - own.limb.lower)
    }

    /// Where the foot is to be at sample `at`, rolled about its toe so that its ankle is `span` from the `hip`; the nearest such place.
    pub fn rolled(&self, at: usize, hip: DVec3, span: f64) -> EndPose {
        let foot = self.target(at);
        let to_toe = self.to_toe(at, &foot);
        let toe = foot.position + to_toe;
        // Leg and foot are like a limb from hip to toe that bends at the ankle.
        let middle = hip + DVec3::NEG_Y * span;
        let limb = Limb { upper: hip, middle, lower: middle + DVec3::NEG_Y * to_toe.length() };
        let ankle = limb.reach(toe, foot.position - hip).middle;
        let rotation = minimal_rotation(to_toe, toe - ankle) * foot.rotation;
        EndPose { position: ankle, rotation: rotation.normalize() }
    }

    /// How far the foot, which is at `place`, is from where it is held or must be, metres: its ankle, or the toe about which it
    /// rolls.
    pub fn miss(&self, at: usize, place: &Place) -> f64 {
        let target = self.target(at);
        if self.is_rolling(at) {
            place.end.distance(target.position + self.to_toe(at, &target))
        } else {
            place.limb.lower.distance(target.position)
        }
    }
}
