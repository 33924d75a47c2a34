//! Displacements of constrained samples spread over the motion about them, coarse first; then the constrained samples
//! exactly.
//!
//! Source: Lee & Shin, *A Hierarchical Approach to Interactive Motion Editing for Human-like Figures*, SIGGRAPH 1999.

use glam::DVec3;

use crate::full_body::aim::{Mobility, solve};
use crate::full_body::chain::{Chain, Place};
use crate::full_body::displacement::{Sample, Spline};
use crate::full_body::effector::{Effector, end_pose};
use crate::full_body::fade::{Slopes, fill};
use crate::full_body::pins::spans;
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
    let mut displacements = vec![[DVec3::ZERO; N]; times.len()];
    let mut labels = vec![false; times.len()];
    for (at, value) in exact {
        displacements[*at] = *value;
        labels[*at] = true;
    }
    fill(times, &spans(&labels), (BLEND, Slopes::Level), &mut displacements);
    displacements
}

/// Brings the ends on `limb` to the targets of `effectors` (all of this limb) in `poses`. Cost: linear in samples.
pub fn bring(skeleton: &Skeleton, times: &[f64], limb: &Chain, effectors: &[&Effector], poses: &mut [Pose]) {
    let constrained: Vec<usize> =
        (0..times.len()).filter(|&at| effectors.iter().any(|effector| effector.at(at).is_some())).collect();
    if constrained.is_empty() {
        return;
    }
    let places: Vec<Place> = poses.iter().map(|pose| limb.place(skeleton, pose)).collect();
    let mobility = Mobility::of(skeleton, limb, places.iter());
    let task = Task { skeleton, limb, effectors, mobility };
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
    for (pose, turns) in poses.iter_mut().zip(&exact) {
        task.apply(pose, turns);
    }
}

/// One limb and what it must do.
struct Task<'a> {
    skeleton: &'a Skeleton,
    limb: &'a Chain,
    effectors: &'a [&'a Effector],
    mobility: Mobility,
}

impl Task<'_> {
    /// Largest distance of an end from its target, metres.
    fn distance(&self, pose: &Pose, at: usize) -> f64 {
        let distances = self.effectors.iter().filter_map(|end| end.shortfall(self.skeleton, pose, at));
        distances.fold(0.0, f64::max)
    }

    /// Rotation vectors, each in its joint's own axes, by which the limb must turn to be at its target; of several
    /// effectors at once the last one counts.
    fn displacement(&self, pose: &Pose, at: usize) -> [DVec3; 3] {
        let end = self.effectors.iter().rev().find_map(|end| Some((end.joint, end.at(at)?)));
        let Some(end) = end else {
            return [DVec3::ZERO; 3];
        };
        let target = end_pose(self.skeleton, self.limb, pose, end);
        let place = self.limb.place(self.skeleton, pose);
        let mut solved = pose.clone();
        solve(self.limb, self.skeleton, &mut solved, (&place, &target), &self.mobility);
        self.joints().map(|joint| log(pose.rotations[joint].inverse() * solved.rotations[joint]))
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
