//! How far a hand turns against its forearm.
//!
//! Of what is asked of a hand its place goes first: its wrist stops where wrists do, and the rest of its orientation is missing.
//! Hands that hold something turn with it.
//!
//! Source: ranges of motion after Norkin & White, *Measurement of Joint Motion*, 5th ed., 2016, appendix, widened.

use glam::{DQuat, DVec3};

use crate::full_body::chain::Chain;
use crate::limb::minimal_rotation;
use crate::skeleton::Skeleton;

/// A hand stays this near to the line of its forearm, as both lie at rest, radians: 110°. Wrists bend by 80°; hands that
/// bear, as captured, by 106°.
pub const SWING: f64 = 1.92;

/// A hand turns so far about the line of its forearm, radians: 145°. Where forearms have no joint for it, wrists do all of it.
pub const TWIST: f64 = 2.531;

/// The wrist of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrist {
    /// From the joint's axes to those of the joint that it hangs on, at rest.
    rest: DQuat,
    /// Direction of the forearm in the axes of the joint that the wrist hangs on.
    along: DVec3,
}

/// How far a hand is turned: away from the line of its forearm, and about it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Turned {
    swing: DQuat,
    swing_angle: f64,
    /// Signed, radians.
    twist_angle: f64,
}

impl Wrist {
    /// Of `limb`; `None` for one that ends without a wrist.
    pub fn of(skeleton: &Skeleton, limb: &Chain) -> Option<Self> {
        let parent = skeleton.joints[limb.lower.as_usize()].parent.filter(|_| !limb.is_open())?;
        let rest = skeleton.rest_pose();
        let frames = skeleton.forward_kinematics(&rest);
        let [middle, lower] = [limb.middle, limb.lower].map(|joint| frames[joint.as_usize()].position);
        let along = frames[parent.as_usize()].rotation.inverse() * (lower - middle).try_normalize()?;
        Some(Self { rest: rest.rotations[limb.lower.as_usize()], along })
    }

    /// `rotation` of the joint, or the nearest that wrists have, or that has no more of what goes beyond than `captured`.
    pub fn clamp(&self, captured: DQuat, rotation: DQuat) -> DQuat {
        let (captured, turned) = (self.turned(captured), self.turned(rotation));
        let swing_most = SWING.max(captured.swing_angle);
        let twist_most = TWIST.max(captured.twist_angle.abs());
        if turned.swing_angle <= swing_most && turned.twist_angle.abs() <= twist_most {
            return rotation;
        }
        let share = (swing_most / turned.swing_angle.max(f64::MIN_POSITIVE)).min(1.0);
        let swing = DQuat::IDENTITY.slerp(turned.swing, share);
        let twist = turned.twist_angle.clamp(-twist_most, twist_most);
        (swing * DQuat::from_axis_angle(self.along, twist) * self.rest).normalize()
    }

    /// How far `rotation` of the joint takes the hand from the line of the forearm, and about it, radians.
    pub fn angles(&self, rotation: DQuat) -> [f64; 2] {
        let turned = self.turned(rotation);
        [turned.swing_angle, turned.twist_angle.abs()]
    }

    fn turned(&self, rotation: DQuat) -> Turned {
        let turn = rotation * self.rest.inverse();
        let swing = minimal_rotation(self.along, turn * self.along);
        let twist = swing.inverse() * turn;
        let twist = if twist.w < 0.0 { -twist } else { twist };
        Turned {
            swing,
            swing_angle: self.along.angle_between(turn * self.along),
            twist_angle: 2.0 * twist.xyz().dot(self.along).atan2(twist.w),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::clip::builtin::{generate, names};
    use crate::full_body::chain::arms;
    use crate::index::SourceFrame;

    /// Rounding of an angle between vectors that are nearly parallel, radians.
    const ROUNDING: f64 = 1e-7;

    #[test]
    fn no_generated_hand_goes_beyond_the_limits() {
        for name in names().map(|info| info.name) {
            let clip = generate(name, &Default::default()).expect("a known clip");
            for limb in arms(&clip.skeleton).into_iter().flatten() {
                let wrist = Wrist::of(&clip.skeleton, &limb).expect("generated arms have wrists");
                for frame in 0..clip.frame_count() {
                    let pose = clip.pose(SourceFrame::from_usize(frame));
                    let [swing, twist] = wrist.angles(pose.rotations[limb.lower.as_usize()]);
                    assert!(swing < SWING && twist < TWIST, "{name}, frame {frame}: {swing} {twist}");
                }
            }
        }
    }

    fn rotation(of: [f64; 3]) -> DQuat {
        crate::geometry::exp(DVec3::from_array(of))
    }

    proptest! {
        #[test]
        fn wrists_stop_at_their_limits_or_where_they_are_already(
            rest in prop::array::uniform3(-2.0..2.0_f64),
            along in prop::array::uniform3(-1.0..1.0_f64),
            captured in prop::array::uniform3(-2.0..2.0_f64),
            asked in prop::array::uniform3(-3.0..3.0_f64),
        ) {
            let along = DVec3::from_array(along).normalize_or(DVec3::X);
            let wrist = Wrist { rest: rotation(rest), along };
            let [captured, asked] = [captured, asked].map(rotation);
            let [swing, twist] = wrist.angles(wrist.clamp(captured, asked));
            let [captured_swing, captured_twist] = wrist.angles(captured);
            prop_assert!(swing < SWING.max(captured_swing) + ROUNDING, "{swing}");
            prop_assert!(twist < TWIST.max(captured_twist) + ROUNDING, "{twist}");
            prop_assert_eq!(wrist.clamp(captured, captured), captured);
            let [asked_swing, asked_twist] = wrist.angles(asked);
            if asked_swing <= SWING && asked_twist <= TWIST {
                prop_assert_eq!(wrist.clamp(captured, asked), asked);
            }
        }
    }
}
