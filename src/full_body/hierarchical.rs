//! Displacements of constrained samples spread over the motion about them, coarse first; then the constrained samples
//! exactly.
//!
//! Source: Lee & Shin, *A Hierarchical Approach to Interactive Motion Editing for Human-like Figures*, SIGGRAPH 1999.

use glam::{DQuat, DVec3};

use crate::full_body::aim::{Mobility, solve};
use crate::full_body::chain::{Chain, Place, set_in_world};
use crate::full_body::displacement::{Sample, Spline};
use crate::full_body::effector::{Effector, Part, Target, end_pose};
use crate::full_body::fade::{Slopes, fill};
use crate::full_body::feet::{FADE, Leg};
use crate::full_body::ground::Floor;
use crate::full_body::hinge::{bend_above, bring_lower, bring_upper};
use crate::full_body::pins::spans;
use crate::full_body::wrist::Wrist;
use crate::geometry::{exp, log};
use crate::index::floor_index;
use crate::skeleton::{Pose, Skeleton};

/// Distances of knots, seconds, coarse to fine: 8, 4 and 2 working frames. A control point reaches four knots, so that
/// nothing changes farther than 32 frames from a constraint.
pub const KNOTS: [f64; 3] = [8.0 / 30.0, 4.0 / 30.0, 2.0 / 30.0];

/// Levels stop when all samples are nearer than this to their targets, metres.
pub const CLOSE: f64 = 1e-3;

/// Seconds in which the last, exact displacement vanishes.
const BLEND: f64 = 5.0 / 30.0;

/// Vectors as the channels of a sample.
pub fn sample<const N: usize>(time: f64, vectors: &[DVec3]) -> Sample<N> {
    Sample { time, value: std::array::from_fn(|channel| vectors[channel / 3][channel % 3]) }
}

/// The spline through `samples` with knots about `spacing` seconds apart, over all of `times`.
pub fn level<const N: usize>(times: &[f64], samples: &[Sample<N>], spacing: f64) -> Spline<N> {
    let (start, end) = (times[0], times[times.len() - 1]);
    let spans = floor_index(((end - start) / spacing).ceil()).max(1);
    Spline::fit(start, start + spans as f64 * spacing, spans, samples)
}

/// Displacements of single samples, in the order of time, blended out over 5 working frames beside them.
pub fn blended<const N: usize>(times: &[f64], exact: &[(usize, [DVec3; N])]) -> Vec<[DVec3; N]> {
    spread(times, exact, BLEND)
}

/// The same over `fade` seconds, in any order.
pub fn spread<const N: usize>(times: &[f64], exact: &[(usize, [DVec3; N])], fade: f64) -> Vec<[DVec3; N]> {
    let mut displacements = vec![[DVec3::ZERO; N]; times.len()];
    let mut labels = vec![false; times.len()];
    for (at, value) in exact {
        displacements[*at] = *value;
        labels[*at] = true;
    }
    fill(times, &spans(&labels), (fade, Slopes::Level), &mut displacements);
    displacements
}

/// Brings the ends on `limb` to the targets of `effectors` (all of this limb) in `poses`. Cost: linear in samples.
pub fn bring(skeleton: &Skeleton, times: &[f64], limb: &Chain, effectors: &[&Effector], poses: &mut [Pose]) {
    let constrained: Vec<usize> =
        (0..times.len()).filter(|&at| effectors.iter().any(|effector| effector.at(at).is_some())).collect();
    if constrained.is_empty() {
        return;
    }
    let task = Task::new((skeleton, limb), effectors, poses);
    for spacing in KNOTS {
        if constrained.iter().all(|&at| task.distance(&poses[at], at) < CLOSE) {
            break;
        }
        let samples: Vec<Sample<9>> =
            constrained.iter().map(|&at| sample(times[at], &task.displacement(&poses[at], at))).collect();
        let spline = level(times, &samples, spacing);
        for (pose, time) in poses.iter_mut().zip(times) {
            let value = spline.at(*time);
            task.apply(
                pose,
                &std::array::from_fn(|joint| DVec3::from_slice(&value[3 * joint..3 * joint + 3])),
            );
        }
    }
    let exact: Vec<(usize, [DVec3; 3])> =
        constrained.iter().map(|&at| (at, task.displacement(&poses[at], at))).collect();
    let exact = blended(times, &exact);
    // What goes over to a hand that holds has no limit that it has not.
    let holds = effectors.iter().any(|end| end.holds);
    for (at, (pose, turns)) in poses.iter_mut().zip(&exact).enumerate() {
        task.apply(pose, turns);
        if !holds {
            task.stop_wrist(pose, at);
        }
    }
}

/// Brings the ends on the bones of `leg` above its foot (or its hand, which bears) to the targets of `effectors` in `poses`; where
/// the foot is bound nothing changes, and nowhere it is below the ground. Cost: linear in samples.
pub fn bring_beside(
    skeleton: &Skeleton,
    times: &[f64],
    leg: &Leg,
    effectors: &[&Effector],
    poses: &mut [Pose],
) {
    if effectors.is_empty() {
        return;
    }
    let task = Task { grounds: leg.grounds(), ..Task::new((skeleton, &leg.chain), effectors, poses) };
    let displacement = |at: usize| {
        if leg.bound[at] {
            return Some((at, [DVec3::ZERO; 3]));
        }
        task.asked(at).map(|_| (at, task.displacement(&poses[at], at)))
    };
    let exact: Vec<(usize, [DVec3; 3])> = (0..times.len()).filter_map(displacement).collect();
    for (pose, turns) in poses.iter_mut().zip(spread(times, &exact, FADE)) {
        task.apply(pose, &turns);
    }
}

/// One limb and what it must do.
struct Task<'a> {
    skeleton: &'a Skeleton,
    limb: &'a Chain,
    effectors: &'a [&'a Effector],
    mobility: Mobility,
    wrist: Option<Wrist>,
    /// Rotation of the lower joint at each sample before anything is brought anywhere.
    captured: Vec<DQuat>,
    /// How low the lower joint and the end of a leg may come at each sample; empty for arms.
    grounds: Vec<Floor>,
}

impl<'a> Task<'a> {
    fn new(
        (skeleton, limb): (&'a Skeleton, &'a Chain),
        effectors: &'a [&'a Effector],
        poses: &[Pose],
    ) -> Self {
        let places: Vec<Place> = poses.iter().map(|pose| limb.place(skeleton, pose)).collect();
        let mobility = Mobility::of(skeleton, limb, places.iter());
        let captured = poses.iter().map(|pose| pose.rotations[limb.lower.as_usize()]).collect();
        Self {
            skeleton,
            limb,
            effectors,
            mobility,
            wrist: Wrist::of(skeleton, limb),
            captured,
            grounds: Vec::new(),
        }
    }

    /// What is asked of the limb at a sample: of several effectors the one farthest out, of those the last one.
    fn asked(&self, at: usize) -> Option<(Part, &'a Effector, &'a Target)> {
        let asked = |end: &&'a Effector| Some((end.part(self.skeleton, self.limb)?, *end, end.at(at)?));
        self.effectors.iter().rev().filter_map(asked).min_by_key(|(part, ..)| *part)
    }

    /// Largest distance of an end from its target, metres.
    fn distance(&self, pose: &Pose, at: usize) -> f64 {
        let distances = self.effectors.iter().filter_map(|end| end.shortfall(self.skeleton, pose, at));
        distances.fold(0.0, f64::max)
    }

    /// Rotation vectors, each in its joint's own axes, by which the limb must turn to be at its target.
    fn displacement(&self, pose: &Pose, at: usize) -> [DVec3; 3] {
        let Some((part, effector, target)) = self.asked(at) else {
            return [DVec3::ZERO; 3];
        };
        let (mut solved, joint) = (pose.clone(), effector.joint);
        let (limb, end) = ((self.limb, &self.mobility), (joint, target.position));
        match (part, target.rotation) {
            (Part::Upper, rotation) => {
                bring_upper(limb, self.skeleton, &mut solved, end);
                if let Some(rotation) = rotation.filter(|_| joint == self.limb.middle) {
                    set_in_world(self.skeleton, &mut solved, joint, rotation);
                } else if let Some(ground) = self.grounds.get(at) {
                    bend_above(limb, self.skeleton, &mut solved, *ground);
                }
            }
            (Part::End, Some(_)) => self.bring_turned(&mut solved, at, (effector, target)),
            (Part::End | Part::Lower, _) => bring_lower(limb, self.skeleton, &mut solved, end),
        }
        self.joints().map(|joint| log(pose.rotations[joint].inverse() * solved.rotations[joint]))
    }

    /// Brings a hand to its target, turned as asked; where its wrist does not turn so far, its place goes first, unless it holds
    /// something.
    fn bring_turned(&self, pose: &mut Pose, at: usize, (effector, target): (&Effector, &Target)) {
        let joint = effector.joint;
        let goal = end_pose(self.skeleton, self.limb, pose, (joint, target));
        let place = self.limb.place(self.skeleton, pose);
        solve(self.limb, self.skeleton, pose, (&place, &goal), &self.mobility);
        if !effector.holds && self.stop_wrist(pose, at) && joint != self.limb.lower {
            bring_lower((self.limb, &self.mobility), self.skeleton, pose, (joint, target.position));
        }
    }

    /// Turns the wrist back to where wrists turn; says whether it had to.
    fn stop_wrist(&self, pose: &mut Pose, at: usize) -> bool {
        let own = &mut pose.rotations[self.limb.lower.as_usize()];
        let stopped = self.wrist.map_or(*own, |wrist| wrist.clamp(self.captured[at], *own));
        let had_to = stopped != *own;
        *own = stopped;
        had_to
    }

    fn apply(&self, pose: &mut Pose, turns: &[DVec3; 3]) {
        for (joint, turn) in self.joints().into_iter().zip(turns) {
            if *turn != DVec3::ZERO {
                pose.rotations[joint] = (pose.rotations[joint] * exp(*turn)).normalize();
            }
        }
    }

    fn joints(&self) -> [usize; 3] {
        [self.limb.upper, self.limb.middle, self.limb.lower].map(crate::index::JointId::as_usize)
    }
}
