//! Hands on boxes: how far a hand is from a box, and how it is brought and turned to touch it.
//!
//! Whoever carries stands somewhere near the box with hands that do what they did when captured: a box is rarely where they
//! held something. A wrist comes as near as a palm is long, the hand goes with its forearm, then turns towards the box until
//! it touches; where wrists do not turn so far, it comes nearer instead.

use glam::{DQuat, DVec3};

use crate::geometry::{exp, log};
use crate::index::JointId;
use crate::limb::{Limb, minimal_rotation};
use crate::skeleton::{JointFrame, JointRole, Skeleton};

/// From the wrist, which is the joint of a hand, to what its palm touches, metres.
const PALM: f64 = 0.1;

/// A hand nearer than this touches, metres.
const TOUCHES: f64 = 1e-4;

/// A hand turns no farther than this towards what it holds, radians: 60°. Wrists bend by 80°, but the arm comes to lie a little
/// otherwise than is known when the hand is turned.
const LARGEST_TURN: f64 = 1.047;

/// Halvings of a share or a stretch that end below rounding of metres.
const HALVINGS: usize = 40;

/// The bones of a hand, from its wrist to all finger tips.
#[derive(Clone, Debug, PartialEq)]
pub struct Hand {
    /// Both ends of each, in the axes of the wrist, metres. At least one, which may be a point.
    bones: Vec<[DVec3; 2]>,
}

/// A wrist in the axes of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WristPose {
    /// Metres.
    pub position: DVec3,
    /// From the axes of the wrist.
    pub rotation: DQuat,
}

impl Hand {
    /// The hand `wrist` of a body whose joints are at `frames`. Cost: linear in joints.
    pub fn of(skeleton: &Skeleton, frames: &[JointFrame], wrist: JointId) -> Self {
        let JointFrame { position, rotation } = frames[wrist.as_usize()];
        let local = |point: DVec3| rotation.inverse() * (point - position);
        let mut belongs = vec![false; frames.len()];
        let mut bones = Vec::new();
        for (at, joint) in skeleton.joints.iter().enumerate() {
            let frame = frames[at];
            let parent = joint.parent.map(JointId::as_usize).filter(|parent| belongs[*parent]);
            belongs[at] = at == wrist.as_usize() || parent.is_some();
            bones.extend(parent.map(|parent| [frames[parent].position, frame.position].map(local)));
            let end = joint.end_site.filter(|_| belongs[at]);
            bones.extend(end.map(|end| [frame.position, frame.position + frame.rotation * end].map(local)));
        }
        if bones.is_empty() {
            bones.push([DVec3::ZERO; 2]);
        }
        Self { bones }
    }

    /// Distance from a box of some size (ahead, up, across) to the nearest point of the hand, metres; 0 within.
    pub fn distance(&self, size: [f64; 3], wrist: &WristPose) -> f64 {
        let placed = |end: DVec3| wrist.position + wrist.rotation * end;
        let distances = self.bones.iter().map(|bone| bone_to_box(size, bone.map(placed)));
        distances.fold(f64::INFINITY, f64::min)
    }

    /// From the wrist to what is farthest from it.
    fn tip(&self) -> DVec3 {
        let ends = self.bones.iter().flatten().copied();
        ends.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or_default()
    }

    /// How the wrist of an arm that is at `wrist` must be to touch a box of some size: as it is where it is near enough and
    /// touches. `arm`: in the axes of the box; `None` where the body has none.
    pub fn touching(&self, size: [f64; 3], arm: Option<&Limb>, wrist: &WristPose) -> WristPose {
        let as_it_is = WristPose { position: within_reach(size, wrist.position, PALM), ..*wrist };
        if self.distance(size, &as_it_is) < TOUCHES {
            return as_it_is;
        }
        let palm = PALM.min(self.tip().length());
        let near = within_reach(size, wrist.position, palm);
        let along = arm.map_or(DQuat::IDENTITY, |arm| with_forearm(arm, near));
        let start = WristPose { position: near, rotation: along * wrist.rotation };
        let turned = |share: f64| self.turned(size, &start, share);
        if self.distance(size, &turned(1.0)) < TOUCHES {
            return turned(least(|share| self.distance(size, &turned(share)) < TOUCHES));
        }
        let surface = nearest(size, near);
        let nearer = |share: f64| {
            let nearer = WristPose { position: near.lerp(surface, share), ..start };
            self.turned(size, &nearer, 1.0)
        };
        nearer(least(|share| self.distance(size, &nearer(share)) < TOUCHES))
    }

    /// `wrist`, turned so that the hand points to the box, or a `share` of it.
    fn turned(&self, size: [f64; 3], wrist: &WristPose, share: f64) -> WristPose {
        let turn =
            minimal_rotation(wrist.rotation * self.tip(), nearest(size, wrist.position) - wrist.position);
        let turn = log(turn).clamp_length_max(LARGEST_TURN) * share;
        WristPose { rotation: (exp(turn) * wrist.rotation).normalize(), ..*wrist }
    }
}

/// The arm to which a hand belongs, in the world.
pub fn arm_of(skeleton: &Skeleton, frames: &[JointFrame], wrist: JointId) -> Option<Limb> {
    let [upper, middle] = match skeleton.joints[wrist.as_usize()].role? {
        JointRole::LeftHand => [JointRole::LeftShoulder, JointRole::LeftElbow],
        JointRole::RightHand => [JointRole::RightShoulder, JointRole::RightElbow],
        _ => return None,
    }
    .map(|role| skeleton.joint_of(role).map(|joint| frames[joint.as_usize()].position));
    Some(Limb { upper: upper?, middle: middle?, lower: frames[wrist.as_usize()].position })
}

/// How the forearm turns where the arm reaches `target`.
fn with_forearm(arm: &Limb, target: DVec3) -> DQuat {
    let reach = arm.reach(target, arm.bow());
    minimal_rotation(arm.lower - arm.middle, reach.lower - reach.middle)
}

/// The least share for which `holds`, which does for 1.
fn least(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut no, mut yes) = (0.0, 1.0);
    if holds(no) {
        return no;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (no + yes);
        (no, yes) = if holds(middle) { (no, middle) } else { (middle, yes) };
    }
    yes
}

/// The point of a box of some size that is nearest to `point`.
fn nearest([ahead, up, across]: [f64; 3], point: DVec3) -> DVec3 {
    let corner = DVec3::new(0.5 * ahead, up, 0.5 * across);
    point.clamp(DVec3::new(-corner.x, 0.0, -corner.z), corner)
}

/// The point nearest to `point` that is no farther than `reach` from a box of some size.
fn within_reach(size: [f64; 3], point: DVec3, reach: f64) -> DVec3 {
    let nearest = nearest(size, point);
    let away = point - nearest;
    if away.length() > reach { nearest + away * (reach / away.length()) } else { point }
}

/// Distance of a bone from a box of some size: the distance from what is convex is convex along a line, and the least of it is
/// found by thirds.
fn bone_to_box(size: [f64; 3], [from, to]: [DVec3; 2]) -> f64 {
    let distance = |share: f64| {
        let point = from.lerp(to, share);
        point.distance(nearest(size, point))
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let third = (high - low) / 3.0;
        let (a, b) = (low + third, high - third);
        (low, high) = if distance(a) < distance(b) { (low, b) } else { (a, high) };
    }
    [0.0, 0.5 * (low + high), 1.0].map(distance).into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::builtin::generate;
    use crate::index::SourceFrame;
    use proptest::prelude::*;

    /// Where a touch is found to, metres.
    const TOUCHED: f64 = 2.0 * TOUCHES;

    /// A left hand that hangs with its arm, in the axes of its wrist; the arm; the wrist.
    fn hanging() -> (Hand, Limb, WristPose) {
        let clip = generate("idle", &Default::default()).expect("a known clip");
        let joint = clip.skeleton.joint_of(JointRole::LeftHand).expect("generated bodies have hands");
        let frames = clip.skeleton.forward_kinematics(&clip.pose(SourceFrame(0)));
        let JointFrame { position, rotation } = frames[joint.as_usize()];
        let arm = arm_of(&clip.skeleton, &frames, joint).expect("generated bodies have arms");
        (Hand::of(&clip.skeleton, &frames, joint), arm, WristPose { position, rotation })
    }

    proptest! {
        /// Wherever it hangs beside a box, above or below it.
        #[test]
        fn a_hand_touches_whatever_box_it_holds(
            place in prop::array::uniform3(-1.0..1.0_f64),
            size in prop::array::uniform3(0.05..0.6_f64),
            has_arm in any::<bool>(),
        ) {
            let (hand, arm, wrist) = hanging();
            let shift = DVec3::from_array(place) - wrist.position;
            let wrist = WristPose { position: wrist.position + shift, ..wrist };
            let arm = Limb { upper: arm.upper + shift, middle: arm.middle + shift, lower: arm.lower + shift };
            let touching = hand.touching(size, has_arm.then_some(&arm), &wrist);
            let off = hand.distance(size, &touching);
            prop_assert!(off < TOUCHED, "{off}");
            let away = touching.position.distance(nearest(size, touching.position));
            prop_assert!(away < PALM + 1e-12, "{away}");
        }
    }

    #[test]
    fn a_hand_that_touches_stays_as_it_is() {
        let (hand, arm, wrist) = hanging();
        let size = [0.3, 0.2, 0.3];
        let reaches = hand.tip().length().min(PALM) * 0.9;
        let points_down = minimal_rotation(wrist.rotation * hand.tip(), DVec3::NEG_Y) * wrist.rotation;
        let above = WristPose { position: DVec3::new(0.05, 0.2 + reaches, 0.05), rotation: points_down };
        assert_eq!(hand.touching(size, Some(&arm), &above), above);
    }

    #[test]
    fn a_hand_without_bones_is_brought_to_the_box_itself() {
        let wrist = WristPose { position: DVec3::new(0.7, 0.1, 0.0), rotation: DQuat::IDENTITY };
        let touching = Hand { bones: vec![[DVec3::ZERO; 2]] }.touching([0.4, 0.2, 0.4], None, &wrist);
        assert!(touching.position.distance(DVec3::new(0.2, 0.1, 0.0)) < TOUCHED, "{touching:?}");
    }

    #[test]
    fn a_bone_that_passes_an_edge_is_nearest_between_its_ends() {
        let bone = [DVec3::new(0.3, 0.0, -1.0), DVec3::new(-0.7, 2.0, 1.0)].map(|end| end + DVec3::Y);
        let size = [0.2, 1.0, 0.4];
        let points = (0..=10_000).map(|k| bone[0].lerp(bone[1], f64::from(k) / 1e4));
        let sampled = points.map(|point| point.distance(nearest(size, point))).fold(f64::INFINITY, f64::min);
        let found = bone_to_box(size, bone);
        assert!(found <= sampled + 1e-12 && sampled - found < 1e-4, "{found} {sampled}");
    }
}
