//! Things near a body: boxes that it carries, or that stand where it grasps them.

use glam::DVec3;

use super::figure::{Ball, Cloth, Group, Kind, Part};
use crate::geometry::plan_of;
use crate::object::ObjectPose;

/// A box, and where it is at each frame of a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct StripThing {
    /// Ahead, up, across, metres.
    pub size: [f64; 3],
    /// One a frame, or one for all of them.
    pub poses: Vec<ObjectPose>,
}

/// A thing is drawn with a body if it is no farther than an arm's length and a step from it, metres from the nearest side.
const NEAR: f64 = 1.1;
/// Edges are rounded so far, metres.
const ROUNDED: f64 = 0.006;

/// The things near a body that stands above `origin`, at a frame.
pub(super) fn groups<'a>(
    things: &'a [StripThing],
    frame: usize,
    origin: DVec3,
) -> impl Iterator<Item = Group> + 'a {
    things.iter().filter_map(move |thing| {
        let pose = thing.poses.get(frame).or_else(|| thing.poses.last())?;
        let [ahead, _, across] = thing.size;
        let away = plan_of(pose.local(origin));
        let beyond = |along: f64, size: f64| (along.abs() - 0.5 * size).max(0.0);
        let is_near = beyond(away.re, ahead).hypot(beyond(away.im, across)) < NEAR;
        is_near.then(|| Group { kind: Kind::Thing, parts: faces(thing.size, pose), bias: 0.0 })
    })
}

/// The six faces of a box.
fn faces([ahead, up, across]: [f64; 3], pose: &ObjectPose) -> Vec<Part> {
    let corner = |index: usize| {
        let side = |bit: usize| if index & bit == 0 { -0.5 } else { 0.5 };
        let point = DVec3::new(ahead * side(1), up * (side(2) + 0.5), across * side(4));
        Ball { centre: pose.apply(point), radius: ROUNDED }
    };
    let face = |bits: [usize; 2], other: usize| {
        let corners = [0, bits[0], bits[0] | bits[1], bits[1]].map(|own| corner(own | other));
        Part { cloth: Cloth::Thing, rim: true, balls: corners.to_vec() }
    };
    [([2, 4], 1), ([1, 4], 2), ([1, 2], 4)]
        .into_iter()
        .flat_map(|(bits, other)| [face(bits, 0), face(bits, other)])
        .collect()
}
