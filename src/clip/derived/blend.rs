//! Two clips blended over one cycle of their gaits.

use std::sync::Arc;

use crate::clip::Clip;
use crate::clip::contacts::runs;
use crate::clip::working::WorkingClip;
use crate::geometry::{RigidMotion, c64, cis, plan_of, slerp, smoothstep, world_of, yaw};
use crate::index::{SourceFrame, floor_index};
use crate::skeleton::Pose;

/// Why two clips are not blended.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BlendError {
    /// Bodies with other joints.
    #[error("\"{from}\" and \"{to}\" have different skeletons")]
    OtherSkeleton {
        /// Name of the one.
        from: String,
        /// Name of the other.
        to: String,
    },
    /// Clips at different rates.
    #[error("\"{from}\" has {from_fps} frames a second, \"{to}\" has {to_fps}")]
    OtherRate {
        /// Name of the one.
        from: String,
        /// Its rate.
        from_fps: f64,
        /// Name of the other.
        to: String,
        /// Its rate.
        to_fps: f64,
    },
    /// No foot strikes twice in both.
    #[error("no foot strikes the floor twice both in \"{from}\" and in \"{to}\"")]
    NoCycle {
        /// Name of the one.
        from: String,
        /// Name of the other.
        to: String,
    },
}

/// What a frame of a blend is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Frame of the first clip, a fraction; its last one used where it has no share.
    pub from: f64,
    /// Frame of the second clip; its first one used where it has no share.
    pub to: f64,
    /// Of the second clip, 0 to 1.
    pub weight: f64,
}

/// Two clips in one.
#[derive(Clone, Debug, PartialEq)]
pub struct Blended {
    /// Without events and stated contacts.
    pub clip: Clip,
    /// Of what each of its frames is made.
    pub shares: Vec<Share>,
    /// Motion of the ground that takes the second clip to its place in the blend.
    pub motion: RigidMotion,
}

/// `from` up to its last cycle, which goes over into the first cycle of `to`, then the rest of that. A cycle is from one strike of a
/// foot to its next; the strikes of both coincide. Joints, heights and the velocities of the root are faded by smoothstep along the
/// cycle, which passes at a rate between those of the two. `to` is turned so that it travels where `from` does.
///
/// # Errors
/// [`BlendError`] for clips that do not fit together or have no cycle.
pub fn blended(from: &Clip, to: &Clip) -> Result<Blended, BlendError> {
    let names = || (from.name.clone(), to.name.clone());
    if !from.skeleton.matches(&to.skeleton) {
        let (from, to) = names();
        return Err(BlendError::OtherSkeleton { from, to });
    }
    if (from.fps - to.fps).abs() > 1e-6 * from.fps {
        let (from_fps, to_fps) = (from.fps, to.fps);
        let (from, to) = names();
        return Err(BlendError::OtherRate { from, from_fps, to, to_fps });
    }
    let cycles = cycles(from, to).ok_or_else(|| {
        let (from, to) = names();
        BlendError::NoCycle { from, to }
    })?;
    Ok(cycles.blend(from, to))
}

/// Frames of the last cycle of the one clip and of the first of the other.
#[derive(Clone, Copy, Debug)]
struct Cycles {
    from: (usize, usize),
    to: (usize, usize),
}

/// Strikes nearer than this are one that was seen twice, seconds.
const SHORTEST_CYCLE: f64 = 0.4;

/// Of the foot that strikes last in `from`, if both have cycles of it.
fn cycles(from: &Clip, to: &Clip) -> Option<Cycles> {
    let (mine, theirs) = (strikes(from), strikes(to));
    let cycle = |foot: usize| {
        let [.., first, last] = mine[foot][..] else { return None };
        let [start, end, ..] = theirs[foot][..] else { return None };
        Some(Cycles { from: (first, last), to: (start, end) })
    };
    [0, 1].into_iter().filter_map(cycle).max_by_key(|cycles| cycles.from.1)
}

/// Frames of the clip at which the left and the right foot come down.
fn strikes(clip: &Clip) -> [Vec<usize>; 2] {
    let working = WorkingClip::new(&clip.name, Arc::new(clip.clone()), clip.usable.0, clip.usable.1);
    let of = |bears: Vec<bool>| {
        let mut strikes: Vec<usize> = Vec::new();
        for (first, _) in runs(&bears).into_iter().filter(|(first, _)| *first > 0) {
            let frame = floor_index(working.source_frame(first as f64).round());
            let is_new = strikes.last().is_none_or(|last| (frame - last) as f64 > SHORTEST_CYCLE * clip.fps);
            strikes.extend(is_new.then_some(frame));
        }
        strikes
    };
    [
        of(working.contacts.iter().map(|contact| contact.left_foot()).collect()),
        of(working.contacts.iter().map(|contact| contact.right_foot()).collect()),
    ]
}

impl Cycles {
    fn blend(&self, from: &Clip, to: &Clip) -> Blended {
        let turn = cis(self.travel(from, self.from).arg() - self.travel(to, self.to).arg());
        let shares = self.shares(from, to);
        let mut poses: Vec<Pose> = Vec::with_capacity(shares.len());
        let mut place = plan_of(from.root_at(shares[0].from));
        let mut motion = RigidMotion::IDENTITY;
        for (frame, share) in shares.iter().enumerate() {
            if let Some(before) = frame.checked_sub(1).map(|before| shares[before]) {
                place += step(from, to, turn, &before.half_way(share));
            }
            if share.weight <= 0.0 {
                place = plan_of(from.root_at(share.from));
            }
            let mut pose = mixed(from, to, turn, share);
            pose.root = world_of(place, pose.root.y);
            if share.weight >= 1.0 {
                motion = RigidMotion::carrying(plan_of(to.root_at(share.to)), place, turn.arg());
            }
            poses.push(pose);
        }
        let name = format!("{} to {}", from.name, to.name);
        Blended {
            clip: Clip::from_poses(&name, Arc::clone(&from.skeleton), from.fps, &poses),
            shares,
            motion,
        }
    }

    fn travel(&self, clip: &Clip, (first, last): (usize, usize)) -> c64 {
        plan_of(clip.root_positions[last]) - plan_of(clip.root_positions[first])
    }

    fn shares(&self, from: &Clip, to: &Clip) -> Vec<Share> {
        let [mine, theirs] = [self.from, self.to].map(|(first, last)| (last - first) as f64);
        let count = floor_index((0.5 * (mine + theirs)).round()).max(1);
        let alone = (from.usable.0.as_usize()..self.from.0).map(|frame| Share {
            from: frame as f64,
            to: self.to.0 as f64,
            weight: 0.0,
        });
        let together = (0..count).map(|frame| {
            let passed = passed_at(frame as f64 / count as f64, mine, theirs);
            Share {
                from: self.from.0 as f64 + passed * mine,
                to: self.to.0 as f64 + passed * theirs,
                weight: smoothstep(passed),
            }
        });
        let after = (self.to.1..=to.usable.1.as_usize()).map(|frame| Share {
            from: self.from.1 as f64,
            to: frame as f64,
            weight: 1.0,
        });
        alone.chain(together).chain(after).collect()
    }
}

/// Share of the cycle that has passed at the share `time` of the blend's time, where the cycle's length goes from `mine` to `theirs`
/// by smoothstep.
///
/// `t(u) = A u + (B − A)(u³ − u⁴/2)`, by bisection.
fn passed_at(time: f64, mine: f64, theirs: f64) -> f64 {
    let whole = 0.5 * (mine + theirs);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let u = 0.5 * (low + high);
        let at = mine * u + (theirs - mine) * (u.powi(3) - 0.5 * u.powi(4));
        if at < time * whole { low = u } else { high = u }
    }
    // Bisection never tells zero.
    if time == 0.0 { 0.0 } else { 0.5 * (low + high) }
}

impl Share {
    fn half_way(&self, other: &Self) -> Self {
        let mid = |a: f64, b: f64| 0.5 * (a + b);
        Self {
            from: mid(self.from, other.from),
            to: mid(self.to, other.to),
            weight: mid(self.weight, other.weight),
        }
    }
}

/// Way of the root in one frame at a share.
fn step(from: &Clip, to: &Clip, turn: c64, share: &Share) -> c64 {
    let way =
        |clip: &Clip, frame: f64| plan_of(clip.root_at(frame + 0.5)) - plan_of(clip.root_at(frame - 0.5));
    let mut step = c64::new(0.0, 0.0);
    if share.weight < 1.0 {
        step += (1.0 - share.weight) * way(from, share.from);
    }
    if share.weight > 0.0 {
        step += share.weight * turn * way(to, share.to);
    }
    step
}

fn mixed(from: &Clip, to: &Clip, turn: c64, share: &Share) -> Pose {
    let turned = |clip: &Clip, frame: f64| {
        let mut pose = clip.sample(frame);
        pose.rotations[0] = yaw(turn.arg()) * pose.rotations[0];
        pose
    };
    if share.weight <= 0.0 {
        return from.sample(share.from);
    }
    let end = turned(to, share.to);
    if share.weight >= 1.0 {
        return end;
    }
    let mut pose = from.sample(share.from);
    pose.root = pose.root.lerp(end.root, share.weight);
    for (own, other) in pose.rotations.iter_mut().zip(&end.rotations) {
        *own = slerp(*own, *other, share.weight);
    }
    for ((_, own), (_, other)) in pose.offsets.iter_mut().zip(&end.offsets) {
        *own = own.lerp(*other, share.weight);
    }
    pose
}

impl Blended {
    /// First frame of the blend without share of the first clip; its length if there is none.
    pub fn alone_from(&self) -> SourceFrame {
        SourceFrame::from_usize(self.shares.iter().take_while(|share| share.weight < 1.0).count())
    }
}
