//! A clip of one skeleton performed by another.
//!
//! Joints correspond by role (and by name, where two joints without role share one). A joint turns in the world as the one
//! it corresponds to, from rest poses that are aligned first: bodies by hips and trunk, limbs bone by bone, feet by how
//! their soles stand on the ground. Places scale by the length of the legs; the ground of the clip becomes the ground of
//! the other body, and two-bone legs bring the ankles where the scaled clip has them, so that planted feet stand.

mod align;
mod legs;
mod stance;

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{DQuat, DVec3};
use serde::Serialize;

use crate::clip::Clip;
use crate::clip::retarget::align::{Drive, drives};
use crate::clip::retarget::legs::Leg;
use crate::clip::retarget::stance::Stance;
use crate::geometry::slerp;
use crate::index::{JointId, SourceFrame, floor_index};
use crate::skeleton::{JointFrame, JointRole, Pose, Skeleton};

/// What became of the joints.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RetargetReport {
    /// Length of the new legs over that of the clip's; places scale by it.
    pub scale: f64,
    /// Joints of the new skeleton that nothing in the clip moves, by name: they keep their rest against their parents.
    pub at_rest: Vec<String>,
    /// Joints of the clip whose motion against their neighbours is lost, by name.
    pub unused: Vec<String>,
    /// Farthest that a leg stays from where the scaled clip has its ankle, metres.
    pub shortfall: f64,
}

/// Why a clip cannot be performed by another skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RetargetError {
    /// Besides the root no joint corresponds to any.
    #[error("their skeletons have no joint in common besides the root")]
    NothingInCommon,
}

/// `clip` performed by the skeleton of `onto`, whose feet on the ground tell how its soles stand; at the clip's own rate,
/// with its events and usable range. A clip whose skeleton matches already comes out bit for bit.
///
/// Cost: linear in frames times joints, of both clips.
///
/// # Errors
/// [`RetargetError`] if the skeletons have nothing in common.
pub fn retarget(clip: &Clip, onto: &Clip) -> Result<(Clip, RetargetReport), RetargetError> {
    if clip.skeleton.matches(&onto.skeleton) {
        return Ok((clip.clone(), RetargetReport { scale: 1.0, ..RetargetReport::default() }));
    }
    let plan = Plan::new(clip, onto)?;
    let mut report = plan.report(&clip.skeleton);
    let sources = || (0..clip.frame_count()).map(|frame| source_frames(clip, frame));
    let (mut poses, reaches): (Vec<Pose>, Vec<f64>) = sources().map(|source| plan.standing(&source)).unzip();
    let drops = legs::smooth_drops(&reaches, floor_index(DROP_FADE * clip.fps));
    for (frame, (source, pose)) in sources().zip(&mut poses).enumerate() {
        pose.root.y -= drops[frame];
        let shortfall = plan.bring_legs(&source, pose);
        let is_usable = (clip.usable.0.as_usize()..=clip.usable.1.as_usize()).contains(&frame);
        report.shortfall = report.shortfall.max(if is_usable { shortfall } else { 0.0 });
    }
    let made = Clip::from_poses(&clip.name, Arc::clone(&onto.skeleton), clip.fps, &poses);
    let (events, contacts) = (clip.events.clone(), clip.contacts.clone());
    Ok((Clip { events, contacts, usable: clip.usable, ..made }, report))
}

fn source_frames(clip: &Clip, frame: usize) -> Vec<JointFrame> {
    clip.skeleton.forward_kinematics(&clip.pose(SourceFrame::from_usize(frame)))
}

/// Where legs do not reach, the body comes down over so long before and after, seconds.
const DROP_FADE: f64 = 0.1;

/// Everything that is the same in all frames.
struct Plan<'a> {
    skeleton: &'a Skeleton,
    drives: Vec<Drive>,
    source_hips: Vec<JointId>,
    hips: Vec<JointId>,
    scale: f64,
    /// Ankles of flat feet above the world's origin: in the clip, and where they stand now, metres.
    ankles: [f64; 2],
    legs: Vec<Leg>,
}

impl<'a> Plan<'a> {
    fn new(clip: &Clip, onto: &'a Clip) -> Result<Self, RetargetError> {
        let stances = [Stance::of(clip), Stance::of(onto)];
        let drives = drives(&clip.skeleton, &onto.skeleton, &stances);
        if drives.iter().skip(1).all(|drive| !matches!(drive, Drive::Joint { .. })) {
            return Err(RetargetError::NothingInCommon);
        }
        let scale = stances[1].size / stances[0].size;
        Ok(Self {
            skeleton: &onto.skeleton,
            drives,
            source_hips: hips(&clip.skeleton),
            hips: hips(&onto.skeleton),
            scale,
            ankles: [stances[0].ankle_height, stances[1].ankle_height],
            legs: legs::legs(&clip.skeleton, &onto.skeleton, &stances, scale),
        })
    }

    /// Where a place of the clip lies for the other body.
    fn place(&self, place: DVec3) -> DVec3 {
        let [from, to] = self.ankles;
        (place - DVec3::Y * from) * self.scale + DVec3::Y * to
    }

    /// The pose like `source` with its hips where they belong, legs by attitude alone; and how far it must come down for
    /// its legs to reach, metres.
    fn standing(&self, source: &[JointFrame]) -> (Pose, f64) {
        let mut pose = self.attitudes(source);
        let mut frames = self.skeleton.forward_kinematics(&pose);
        let shift = self.place(middle(source, &self.source_hips)) - middle(&frames, &self.hips);
        pose.root += shift;
        for frame in &mut frames {
            frame.position += shift;
        }
        let drop = |leg: &Leg| leg.drop(&frames, self.goal(leg, source, &frames));
        let drop = self.legs.iter().map(drop).fold(0.0, f64::max);
        (pose, drop)
    }

    fn goal(&self, leg: &Leg, source: &[JointFrame], frames: &[JointFrame]) -> DVec3 {
        leg.ankle_goal(self.place(source[leg.source[2].as_usize()].position), frames)
    }

    /// Brings the ankles of `pose` to their goals; how far the worse one stays from it, metres.
    fn bring_legs(&self, source: &[JointFrame], pose: &mut Pose) -> f64 {
        let frames = self.skeleton.forward_kinematics(pose);
        let bring = |leg: &Leg| leg.bring(pose, (source, &frames), self.goal(leg, source, &frames));
        self.legs.iter().map(bring).fold(0.0, f64::max)
    }

    /// Rotations by the drives, the root at the origin.
    fn attitudes(&self, source: &[JointFrame]) -> Pose {
        let mut world: Vec<DQuat> = Vec::with_capacity(self.drives.len());
        let mut rotations = Vec::with_capacity(self.drives.len());
        let turned = |from: &JointId, align: &DQuat| source[from.as_usize()].rotation * *align;
        for (joint, drive) in self.skeleton.joints.iter().zip(&self.drives) {
            let above = joint.parent.map_or(DQuat::IDENTITY, |parent| world[parent.as_usize()]);
            let (own, local) = match drive {
                Drive::Rest => (above, DQuat::IDENTITY),
                Drive::Joint { source, align } => {
                    let own = turned(source, align).normalize();
                    (own, (above.inverse() * own).normalize())
                }
                Drive::Between { ends, share } => {
                    let [from, to] = ends.map(|(joint, align)| turned(&joint, &align).normalize());
                    let own = slerp(from, to, *share);
                    (own, (above.inverse() * own).normalize())
                }
            };
            world.push(own);
            rotations.push(local);
        }
        Pose { root: DVec3::ZERO, rotations, offsets: Vec::new() }
    }

    fn report(&self, source: &Skeleton) -> RetargetReport {
        let mut used = BTreeSet::new();
        for drive in &self.drives {
            match drive {
                Drive::Rest => {}
                Drive::Joint { source, .. } => drop(used.insert(*source)),
                Drive::Between { ends, .. } => used.extend(ends.map(|(joint, _)| joint)),
            }
        }
        let names = |skeleton: &Skeleton, is_meant: &dyn Fn(usize) -> bool| {
            let joints = skeleton.joints.iter().enumerate();
            joints.filter(|(index, _)| is_meant(*index)).map(|(_, joint)| joint.name.clone()).collect()
        };
        RetargetReport {
            scale: self.scale,
            at_rest: names(self.skeleton, &|joint| matches!(self.drives[joint], Drive::Rest)),
            unused: names(source, &|joint| !used.contains(&JointId::from_usize(joint))),
            shortfall: 0.0,
        }
    }
}

/// Both hip joints, else the root.
fn hips(skeleton: &Skeleton) -> Vec<JointId> {
    match [JointRole::LeftHip, JointRole::RightHip].map(|role| skeleton.joint_of(role)) {
        [Some(left), Some(right)] => vec![left, right],
        _ => vec![JointId(0)],
    }
}

fn middle(frames: &[JointFrame], joints: &[JointId]) -> DVec3 {
    joints.iter().map(|joint| frames[joint.as_usize()].position).sum::<DVec3>() / joints.len() as f64
}
