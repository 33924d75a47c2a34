//! Where two hands meet: in the middle between them, or where both arms reach nearest to it.

use glam::DVec3;

use crate::index::{CharacterId, JointId};
use crate::object_motion::{Performance, skeleton_of};
use crate::scene::Scene;
use crate::skeleton::{JointRole, Pose};

/// Hands that meet do so with arms no straighter than this, share of their length.
const COMFORTABLE: f64 = 0.95;

/// Sweeps over two balls.
const SWEEPS: usize = 60;

/// A hand and how far its arm reaches, in the world.
#[derive(Clone, Copy, Debug)]
struct Arm {
    hand: DVec3,
    /// Shoulder, and metres from there; `None` where the body has no such arm.
    ball: Option<(DVec3, f64)>,
}

/// Where two hands meet: whose, which joint, at which scene time. Cost: linear in joints.
pub fn meeting_point(
    (scene, performance): (&Scene, &impl Performance),
    hands: [(CharacterId, JointId, f64); 2],
) -> DVec3 {
    let [own, theirs] = hands.map(|(who, hand, time)| {
        Arm::at(scene, who, hand, performance.pose(who, performance.frame(who, time)))
    });
    let middle = own.hand.midpoint(theirs.hand);
    own.ball.zip(theirs.ball).map_or(middle, |(own, theirs)| nearest_in_both([own, theirs], middle))
}

/// Whether a joint is the wrist of a hand.
pub fn is_hand(scene: &Scene, who: CharacterId, joint: JointId) -> bool {
    let role = skeleton_of(scene, who).joints[joint.as_usize()].role;
    matches!(role, Some(JointRole::LeftHand | JointRole::RightHand))
}

impl Arm {
    fn at(scene: &Scene, who: CharacterId, hand: JointId, pose: Pose) -> Self {
        let skeleton = skeleton_of(scene, who);
        let frames = skeleton.forward_kinematics(&pose);
        let place = |joint: JointId| frames[joint.as_usize()].position;
        let roles = match skeleton.joints[hand.as_usize()].role {
            Some(JointRole::LeftHand) => Some([JointRole::LeftShoulder, JointRole::LeftElbow]),
            Some(JointRole::RightHand) => Some([JointRole::RightShoulder, JointRole::RightElbow]),
            _ => None,
        };
        let ball = |[shoulder, elbow]: [JointRole; 2]| {
            let (shoulder, elbow) = (place(skeleton.joint_of(shoulder)?), place(skeleton.joint_of(elbow)?));
            Some((shoulder, COMFORTABLE * (shoulder.distance(elbow) + elbow.distance(place(hand)))))
        };
        Self { hand: place(hand), ball: roles.and_then(ball) }
    }
}

/// The point nearest to `middle` in two balls, centre and radius; where they do not meet, halfway between them.
fn nearest_in_both(balls: [(DVec3, f64); 2], middle: DVec3) -> DVec3 {
    let [(a, own), (b, theirs)] = balls;
    let gap = a.distance(b) - own - theirs;
    if gap >= 0.0 {
        return a + (b - a).normalize_or_zero() * (own + 0.5 * gap);
    }
    // Dykstra: alternate projections that remember what they took away end at the nearest point.
    let (mut point, mut taken) = (middle, [DVec3::ZERO; 2]);
    for _ in 0..SWEEPS {
        for ((centre, radius), taken) in balls.iter().zip(&mut taken) {
            let wanted = point + *taken;
            point = *centre + (wanted - *centre).clamp_length_max(*radius);
            *taken = wanted - point;
        }
    }
    point
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of alternate projections.
    const CONVERGED: f64 = 1e-3;

    #[test]
    fn hands_meet_in_the_middle_where_arms_reach_it_and_as_near_to_it_as_they_do_elsewhere() {
        let balls = [(DVec3::new(0.0, 1.4, 0.0), 0.5), (DVec3::new(0.8, 1.4, 0.0), 0.5)];
        let within = DVec3::new(0.4, 1.2, 0.0);
        assert_eq!(nearest_in_both(balls, within), within);
        let hanging = nearest_in_both(balls, DVec3::new(0.4, 0.8, 0.0));
        // 0.4 m to either side an arm of 0.5 m is 0.3 m lower.
        assert!(hanging.distance(DVec3::new(0.4, 1.1, 0.0)) < CONVERGED, "{hanging}");
        let apart = [balls[0], (DVec3::new(2.0, 1.4, 0.0), 0.7)];
        assert!(nearest_in_both(apart, within).distance(DVec3::new(0.9, 1.4, 0.0)) < CONVERGED);
    }
}
