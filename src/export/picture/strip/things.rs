//! What is near a body: boxes that it carries, or that stand where it grasps them, and partners.

use glam::DVec3;

use super::figure::{Ball, Cloth, Figure, Group, Kind, Part};
use crate::clip::Clip;
use crate::geometry::plan_of;
use crate::index::SourceFrame;
use crate::object::ObjectPose;

/// What is drawn with a body where it is near.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Company<'a> {
    /// Boxes.
    pub things: &'a [StripThing],
    /// Other performers, on the same clock.
    pub partners: &'a [&'a Clip],
}

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
/// Partners are drawn with a body if their roots are so near, metres: a hand-over at arm's length.
const BESIDE: f64 = 1.3;
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

/// The partners near a body, each with what draws it, at any of the frames.
pub(super) fn partners<'a>(
    clip: &Clip,
    company: &Company<'a>,
    frames: &[SourceFrame],
) -> Vec<(&'a Clip, Figure<'a>)> {
    let comes_near = |partner: &&&Clip| {
        frames.iter().any(|frame| is_beside(partner, *frame, clip.root_positions[frame.as_usize()]))
    };
    company.partners.iter().filter(comes_near).map(|partner| (*partner, Figure::new(partner))).collect()
}

/// The bodies of partners near `origin` at a frame, in other shirts.
pub(super) fn partner_groups(partners: &[(&Clip, Figure)], frame: SourceFrame, origin: DVec3) -> Vec<Group> {
    let near = partners.iter().filter(|(clip, _)| is_beside(clip, frame, origin));
    let mut groups: Vec<Group> = near
        .flat_map(|(clip, figure)| {
            figure.groups(&clip.skeleton.forward_kinematics(&clip.pose(shown(clip, frame))))
        })
        .collect();
    for part in groups.iter_mut().flat_map(|group| &mut group.parts).filter(|part| part.cloth == Cloth::Shirt)
    {
        part.cloth = Cloth::PartnerShirt;
    }
    groups
}

fn is_beside(partner: &Clip, frame: SourceFrame, place: DVec3) -> bool {
    let root = partner.root_positions[shown(partner, frame).as_usize()];
    (plan_of(root) - plan_of(place)).norm() < BESIDE
}

/// After its end a clip holds its last pose.
fn shown(clip: &Clip, frame: SourceFrame) -> SourceFrame {
    frame.min(SourceFrame::from_usize(clip.frame_count() - 1))
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
