//! Where the zero moment points of the two clips of a blend were.

use glam::DVec2;

use crate::clip::Clip;
use crate::clip::derived::{Blended, Share};
use crate::index::floor_index;
use crate::physics::body_model::BodyModel;
use crate::physics::ground::target::Source;
use crate::physics::stages::Stages;
use crate::physics::zmp::DistanceSummary;

/// Both clips of `blended` as one source, weighted as they are blended; its distances are those of both together. Cost: linear.
///
/// Where only one of them stands, no place is known; a blend keeps the heading that it has.
pub fn blended_source(blended: &Blended, parts: [(&Clip, &Stages); 2], body: &BodyModel) -> Source {
    let [from, to] = parts.map(|(clip, stages)| Source::of(clip, body, stages));
    let turn = blended.motion.angle();
    let offset = |filter: usize, share: &Share| {
        let first = offset_at(&from, filter, share.from);
        // Turns count from above, pairs (x, z) the other way.
        let second = || offset_at(&to, filter, share.to).map(|own| DVec2::from_angle(-turn).rotate(own));
        match share.weight {
            weight if weight <= 0.0 => first,
            weight if weight >= 1.0 => second(),
            weight => Some(first?.lerp(second()?, weight)),
        }
    };
    let joints = blended.clip.skeleton.joints.len();
    Source {
        offsets: [0, 1].map(|filter| blended.shares.iter().map(|share| offset(filter, share)).collect()),
        roots: blended.clip.rotations.chunks_exact(joints).map(|rotations| rotations[0]).collect(),
        distances: [0, 1].map(|filter| together(from.distances[filter], to.distances[filter])),
    }
}

fn offset_at(source: &Source, filter: usize, frame: f64) -> Option<DVec2> {
    source.offsets[filter].get(floor_index(frame.max(0.0) + 0.5)).copied().flatten()
}

fn together(a: Option<DistanceSummary>, b: Option<DistanceSummary>) -> Option<DistanceSummary> {
    let (Some(a), Some(b)) = (a, b) else { return a.or(b) };
    let frames = a.frames + b.frames;
    let mean = |a_own: f64, b_own: f64| (a_own * a.frames as f64 + b_own * b.frames as f64) / frames as f64;
    Some(DistanceSummary {
        mean: mean(a.mean, b.mean),
        largest: a.largest.max(b.largest),
        outside: mean(a.outside, b.outside),
        frames,
    })
}
