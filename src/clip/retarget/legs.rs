//! Legs of two bones that bring ankles where the scaled clip has them.

use glam::{DQuat, DVec3};

use crate::clip::retarget::stance::{LEGS, Stance};
use crate::geometry::smoothstep;
use crate::index::JointId;
use crate::limb::{Limb, minimal_rotation};
use crate::skeleton::{JointFrame, Pose, Skeleton};

/// Knees bent less than this, as their distance from the line of the leg over its length, take their side from the thigh.
const CLEAR_BOW: f64 = 0.02;
/// A foot turns wholly about its toe from this slope of the sole on: the sine of 6°.
const ON_TOE: f64 = 0.1;
/// A sole that looks up less than this bears on nothing: the cosine of 73°.
const UPRIGHT: f64 = 0.3;

/// An ankle rises or sinks by less than this for the length of the foot: rather the toe hangs a little, metres.
const HIGHEST_RISE: f64 = 0.05;
/// Thighs and shanks that are shorter, metres and as a share of the other, bend nothing.
const LEAST_BONE: f64 = 1e-3;
const SHORTEST_SHARE: f64 = 1e-3;
/// Share of its length up to which a leg is stretched.
const STRETCHED: f64 = 0.9995;
/// A body comes down no farther for its legs to reach, metres.
const DEEPEST_DROP: f64 = 0.05;

/// One leg of both bodies.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Leg {
    /// Hip, knee and ankle in the clip.
    pub(super) source: [JointId; 3],
    /// Hip, knee and ankle of the other body.
    joints: [JointId; 3],
    /// Parents of these.
    parents: [Option<JointId>; 3],
    /// The thigh's axis in its own axes that looks ahead when the body stands.
    knee_ahead: DVec3,
    foot: Option<Foot>,
}

/// What a foot does on its toe.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Foot {
    /// From the sole's axes to those of the foot joint.
    axes: DQuat,
    /// What the scaled foot of the clip is longer, in the sole's axes, metres.
    longer: DVec3,
}

/// Legs that both bodies have whole, with two bones to bend.
pub(super) fn legs(source: &Skeleton, onto: &Skeleton, stances: &[Stance; 2], scale: f64) -> Vec<Leg> {
    let joints = |skeleton: &Skeleton, roles: [_; 3]| {
        let [hip, knee, ankle] = roles.map(|role| skeleton.joint_of(role));
        Some([hip?, knee?, ankle?])
    };
    let rest = onto.forward_kinematics(&onto.rest_pose());
    let leg = |side: usize| {
        let joints_onto = joints(onto, LEGS[side])?;
        let [thigh, shank] = limb(&rest, joints_onto).lengths();
        if thigh.min(shank) < LEAST_BONE.max(SHORTEST_SHARE * thigh.max(shank)) {
            return None;
        }
        let foot = match stances.each_ref().map(|stance| stance.soles[side]) {
            [Some(from), Some(to)] => Some(Foot { axes: to.axes, longer: from.toe * scale - to.toe }),
            _ => None,
        };
        Some(Leg {
            source: joints(source, LEGS[side])?,
            joints: joints_onto,
            parents: joints_onto.map(|joint| onto.joints[joint.as_usize()].parent),
            knee_ahead: stances[1].body * DVec3::Z,
            foot,
        })
    };
    (0..2).filter_map(leg).collect()
}

impl Leg {
    /// Where the ankle goes: where the scaled clip has it, `ankle`; a foot that has risen onto its toe, and is longer or
    /// shorter than the scaled one, turns about its own toe.
    ///
    /// With F the sole's axes in the world, F₀ the same sole flat, and δ what the scaled foot is longer, the toe stays where
    /// the flat foot had it if the ankle moves by (F − F₀)·δ.
    pub(super) fn ankle_goal(&self, ankle: DVec3, frames: &[JointFrame]) -> DVec3 {
        let Some(foot) = self.foot else {
            return ankle;
        };
        let sole = frames[self.joints[2].as_usize()].rotation * foot.axes;
        let (ahead, up) = (sole * DVec3::Z, sole * DVec3::Y);
        let on_toe = smoothstep(-ahead.y / ON_TOE) * smoothstep(up.y / UPRIGHT);
        let Some(flat) = DVec3::new(ahead.x, 0.0, ahead.z).try_normalize() else {
            return ankle;
        };
        let delta = foot.longer;
        let stands = DVec3::Y.cross(flat) * delta.x + DVec3::Y * delta.y + flat * delta.z;
        let mut shift = (sole * delta - stands) * on_toe;
        shift.y = HIGHEST_RISE * (shift.y / HIGHEST_RISE).tanh();
        ankle + shift
    }

    /// How far the hips must come down for the leg to reach `goal`, metres, at most [`DEEPEST_DROP`].
    pub(super) fn drop(&self, frames: &[JointFrame], goal: DVec3) -> f64 {
        let limb = limb(frames, self.joints);
        let length = STRETCHED * limb.lengths().iter().sum::<f64>();
        let to_goal = goal - limb.upper;
        if to_goal.y > 0.0 || to_goal.length() <= length {
            return 0.0;
        }
        let across_sq = to_goal.x * to_goal.x + to_goal.z * to_goal.z;
        let reached = (length * length - across_sq).max(0.0).sqrt();
        (-to_goal.y - reached).clamp(0.0, DEEPEST_DROP)
    }

    /// Turns thigh and shank so that the ankle comes to `goal`; the foot keeps its turn in the world. Gives how far the ankle
    /// stays from it, metres. `source`, `frames`: world frames of the clip's pose, and of `pose`.
    pub(super) fn bring(
        &self,
        pose: &mut Pose,
        (source, frames): (&[JointFrame], &[JointFrame]),
        goal: DVec3,
    ) -> f64 {
        let limb = limb(frames, self.joints);
        let [hip, knee, ankle] = self.joints.map(JointId::as_usize);
        let reach = limb.reach(goal, self.pole(source, frames));
        let thigh = minimal_rotation(limb.middle - limb.upper, reach.middle - limb.upper);
        let shank = minimal_rotation(thigh * (limb.lower - limb.middle), reach.lower - reach.middle);
        let above = |joint: usize| {
            let parent = self.parents[joint];
            parent.map_or(DQuat::IDENTITY, |parent| frames[parent.as_usize()].rotation)
        };
        let local = |above: DQuat, own: DQuat| (above.inverse() * own).normalize();
        pose.rotations[hip] = local(above(0), thigh * frames[hip].rotation);
        pose.rotations[knee] = local(thigh * above(1), shank * thigh * frames[knee].rotation);
        pose.rotations[ankle] = local(shank * thigh * above(2), frames[ankle].rotation);
        reach.shortfall
    }

    /// Where the knee points: as in the clip, towards the front of the thigh where the leg is nearly straight.
    fn pole(&self, source: &[JointFrame], frames: &[JointFrame]) -> DVec3 {
        let clip = limb(source, self.source);
        let length: f64 = clip.lengths().iter().sum();
        let ahead = frames[self.joints[0].as_usize()].rotation * self.knee_ahead;
        clip.bow() / length.max(f64::MIN_POSITIVE) + ahead * CLEAR_BOW
    }
}

/// Drops that are nowhere less than `drops` and come and go over `width` frames: the greatest near each frame, averaged.
/// Cost: frames times `width`.
pub(super) fn smooth_drops(drops: &[f64], width: usize) -> Vec<f64> {
    if drops.iter().all(|drop| *drop == 0.0) {
        return drops.to_vec();
    }
    let near = |frame: usize| frame.saturating_sub(width)..(frame + width + 1).min(drops.len());
    let greatest: Vec<f64> =
        (0..drops.len()).map(|frame| drops[near(frame)].iter().copied().fold(0.0, f64::max)).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    (0..drops.len()).map(|frame| mean(&greatest[near(frame)])).collect()
}

fn limb(frames: &[JointFrame], joints: [JointId; 3]) -> Limb {
    let [upper, middle, lower] = joints.map(|joint| frames[joint.as_usize()].position);
    Limb { upper, middle, lower }
}
