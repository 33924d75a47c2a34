//! How far the joints of a limb turn: knees and elbows fold so far, thighs and upper arms stay in wide cones.
//!
//! The limits are those of supple people: walks, runs, leaps and dances as captured stay within. Where a capture goes beyond, it
//! is the limit itself. Legs and arms that are brought somewhere stop there, and what is missing is told as a shortfall.
//!
//! Source: ranges of motion after Norkin & White, *Measurement of Joint Motion*, 5th ed., 2016, appendix, widened.

use glam::{DQuat, DVec3};

use crate::full_body::chain::Chain;
use crate::limb::{Limb, minimal_rotation};
use crate::skeleton::{JointFrame, JointRole, Skeleton};

/// Knees and elbows fold so far, radians: 155°.
pub const MOST_BENT: f64 = 2.705;

/// Thighs stay this near to an axis 50° ahead of straight down, radians: 120°, from 70° backwards (of which the pelvis, which is
/// not tilted here, would take the most) to 170° forwards.
const THIGH: (f64, f64) = (0.873, 2.094);

/// Upper arms stay this near to an axis level between ahead and outwards, radians: 150°. Only straight backwards and inwards,
/// through the own back, is out of it.
const UPPER_ARM: f64 = 2.618;

/// Nearer than this to upright a rest pose tells ahead from down, cosine of 60°.
const UPRIGHT: f64 = 0.5;

/// A cone in which an upper bone stays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Unit vector in the axes of the joint that the limb hangs on.
    pub axis: DVec3,
    /// Largest angle from it, radians.
    pub angle: f64,
}

impl Cone {
    /// The cone of the upper bone of `limb`; `None` where the rest pose does not tell which way is ahead.
    pub fn of(skeleton: &Skeleton, limb: &Chain) -> Option<Self> {
        let frames = skeleton.forward_kinematics(&skeleton.rest_pose());
        let place = |role| Some(frames[skeleton.joint_of(role)?.as_usize()].position);
        let hips = [place(JointRole::LeftHip)?, place(JointRole::RightHip)?];
        let shoulders = [place(JointRole::LeftShoulder)?, place(JointRole::RightShoulder)?];
        let trunk = shoulders[0].midpoint(shoulders[1]) - hips[0].midpoint(hips[1]);
        let left = (hips[0] - hips[1]).with_y(0.0).try_normalize()?;
        let ahead = left.cross(DVec3::Y);
        let (axis, angle) = match skeleton.joints[limb.upper.as_usize()].role? {
            JointRole::LeftHip | JointRole::RightHip => {
                let (sine, cosine) = THIGH.0.sin_cos();
                (ahead * sine - DVec3::Y * cosine, THIGH.1)
            }
            JointRole::LeftShoulder => ((ahead + left).normalize(), UPPER_ARM),
            JointRole::RightShoulder => ((ahead - left).normalize(), UPPER_ARM),
            _ => return None,
        };
        let above: &JointFrame = &frames[skeleton.joints[limb.upper.as_usize()].parent?.as_usize()];
        let is_upright = trunk.normalize_or_zero().y > UPRIGHT;
        is_upright.then(|| Self { axis: above.rotation.inverse() * axis, angle })
    }

    /// Places of the middle and of the lower joint of `limb`, which is to have them at `middle` and `lower`, with the upper
    /// bone inside the cone (`above`: from its axes to the world's), or no farther out than in `limb` itself.
    ///
    /// The limb swivels about the line between its ends as little as it takes; where no swivel is enough, the upper bone stops
    /// at the cone and the lower one points to where its end was to be.
    pub fn clamp(&self, above: DQuat, limb: &Limb, [middle, lower]: [DVec3; 2]) -> [DVec3; 2] {
        let axis = above * self.axis;
        let most = self.angle.max((limb.middle - limb.upper).angle_between(axis));
        if (middle - limb.upper).angle_between(axis) <= most + ROUNDING {
            return [middle, lower];
        }
        let swivelled = swivel(limb.upper, [middle, lower], (axis, most));
        let bone = swivelled - limb.upper;
        if bone.angle_between(axis) - most <= ROUNDING {
            return [swivelled, lower];
        }
        let back = back(bone, (axis, most));
        let stopped = limb.upper + back * bone;
        let on = (lower - stopped).normalize_or(back * (lower - swivelled).normalize_or_zero());
        [stopped, stopped + on * (lower - swivelled).length()]
    }

    /// `bone`, where the upper bone of `limb` is to be, or where it stops on its way there: at the cone (`above`: from its axes to
    /// the world's), or no farther out than in `limb` itself.
    pub fn stop(&self, above: DQuat, limb: &Limb, bone: DVec3) -> DVec3 {
        let axis = above * self.axis;
        let most = self.angle.max((limb.middle - limb.upper).angle_between(axis));
        if bone.angle_between(axis) - most <= ROUNDING { bone } else { back(bone, (axis, most)) * bone }
    }
}

/// The turn that takes `bone`, which is farther than `most` from `axis`, back to there.
fn back(bone: DVec3, (axis, most): (DVec3, f64)) -> DQuat {
    let angle = bone.angle_between(axis);
    DQuat::IDENTITY.slerp(minimal_rotation(bone, axis), (angle - most) / angle)
}

/// Rounding of an angle between vectors that are nearly parallel, radians.
const ROUNDING: f64 = 1e-9;

/// The middle joint swivelled about the line from `upper` to the lower joint until it is `most` from `axis`, or as near as it
/// comes.
fn swivel(upper: DVec3, [middle, lower]: [DVec3; 2], (axis, most): (DVec3, f64)) -> DVec3 {
    let along = (lower - upper).normalize_or_zero();
    let foot = upper + along * (middle - upper).dot(along);
    let bow = middle - foot;
    let Some(best) = axis.reject_from(along).try_normalize().filter(|_| along != DVec3::ZERO) else {
        return middle;
    };
    // With the bow at an angle φ from `best` the bone's share along the axis is level + rise·cos φ.
    let (level, rise) = ((foot - upper).dot(axis), bow.length() * best.dot(axis));
    let wanted = (middle - upper).length() * most.cos();
    let cosine = if rise > f64::MIN_POSITIVE { ((wanted - level) / rise).clamp(-1.0, 1.0) } else { 1.0 };
    let side = if along.cross(best).dot(bow) < 0.0 { -1.0 } else { 1.0 };
    foot + DQuat::from_axis_angle(along, side * cosine.acos()) * best * bow.length()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::clip::builtin::{generate, names};
    use crate::full_body::chain::{arms, legs};
    use crate::index::SourceFrame;

    fn arm(middle: DVec3, lower: DVec3) -> Limb {
        Limb { upper: DVec3::ZERO, middle, lower }
    }

    #[test]
    fn no_generated_body_goes_beyond_the_limits() {
        for name in names().map(|info| info.name) {
            let clip = generate(name, &Default::default()).expect("a known clip");
            let skeleton = &clip.skeleton;
            for limb in legs(skeleton).into_iter().chain(arms(skeleton)).flatten() {
                let cone = Cone::of(skeleton, &limb).expect("the generated body stands at rest");
                for frame in 0..clip.frame_count() {
                    let pose = clip.pose(SourceFrame::from_usize(frame));
                    let place = limb.place(skeleton, &pose);
                    let above = place.upper_rotation * pose.rotations[limb.upper.as_usize()].inverse();
                    let bone = place.limb.middle - place.limb.upper;
                    assert!(bone.angle_between(above * cone.axis) < cone.angle, "{name}, frame {frame}");
                    assert!(place.limb.bend() < MOST_BENT, "{name}, frame {frame}");
                }
            }
        }
    }

    proptest! {
        #[test]
        fn upper_bones_stay_in_their_cones_and_bones_keep_their_lengths(
            axis in prop::array::uniform3(-1.0..1.0_f64),
            angle in 0.3..2.8_f64,
            before in prop::array::uniform3(-1.0..1.0_f64),
            middle in prop::array::uniform3(-1.0..1.0_f64),
            lower in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            let unit = |v: [f64; 3]| DVec3::from_array(v).try_normalize().unwrap_or(DVec3::X);
            let cone = Cone { axis: unit(axis), angle };
            let (middle, fore) = (unit(middle), unit(lower));
            let lower = middle + 0.8 * fore;
            let limb = arm(unit(before), unit(before) * 1.7);
            let [found, end] = cone.clamp(DQuat::IDENTITY, &limb, [middle, lower]);
            let most = angle.max(limb.middle.angle_between(cone.axis));
            prop_assert!(found.angle_between(cone.axis) <= most + 1e-7);
            prop_assert!((found.length() - 1.0).abs() < 1e-9 && (found.distance(end) - 0.8).abs() < 1e-9);
            if middle.angle_between(cone.axis) <= most {
                prop_assert_eq!([found, end], [middle, lower]);
            }
        }
    }

    #[test]
    fn an_arm_swivels_before_it_gives_up_its_hand() {
        let cone = Cone { axis: DVec3::X, angle: 0.5 };
        // Bent to the side by 45°, its hand straight ahead: with the elbow below as above, as far from ahead.
        let limb = arm(DVec3::X, DVec3::X * 2.0);
        let (middle, hand) = (DVec3::new(1.0, 1.0, 0.0).normalize(), DVec3::X * 2.0_f64.sqrt());
        let [_, end] = cone.clamp(DQuat::IDENTITY, &limb, [middle, hand]);
        assert!(end.distance(hand) > 0.1, "no swivel brings it into the cone");
        let tilted = Cone { axis: DVec3::new(1.0, -0.7, 0.0).normalize(), angle: 0.5 };
        let limb = arm(tilted.axis, tilted.axis * 2.0);
        let [elbow, end] = tilted.clamp(DQuat::IDENTITY, &limb, [middle, hand]);
        assert_eq!(end, hand);
        assert!(elbow.y < 0.0 && (elbow.angle_between(tilted.axis) - 0.5).abs() < 1e-7, "{elbow}");
    }
}
