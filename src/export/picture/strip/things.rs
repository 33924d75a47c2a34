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
    /// Performers, on the same clock.
    pub partners: &'a [&'a Clip],
    /// Which of them the body itself is, if any.
    pub own: Option<usize>,
    /// When partners are drawn though they are not near.
    pub ties: &'a [StripTie],
}

/// A partner with whom a body has to do for a while.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StripTie {
    /// Which of the performers.
    pub partner: usize,
    /// First frame of the clock.
    pub first: SourceFrame,
    /// Last frame of the clock.
    pub last: SourceFrame,
}

impl StripTie {
    fn contains(&self, frame: SourceFrame) -> bool {
        (self.first..=self.last).contains(&frame)
    }
}

/// A box, and where it is at each frame of a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct StripThing {
    /// Ahead, up, across, metres.
    pub size: [f64; 3],
    /// One a frame, or one for all of them.
    pub poses: Vec<ObjectPose>,
    /// Who has it when: they are drawn wherever it is, so that it does not hang in the air.
    pub carriers: Vec<StripTie>,
}

/// A thing is drawn with a body if it is no farther than an arm's length and a step from it, metres from the nearest side.
const NEAR: f64 = 1.1;
/// Partners are drawn with a body if their roots are so near, metres: a hand-over at arm's length.
const BESIDE: f64 = 1.3;
/// Partners who are tied to a body are drawn up to here, metres: farther off, poses would be too small to see.
const TIED: f64 = 4.0;
/// Edges are rounded so far, metres.
const ROUNDED: f64 = 0.006;

/// The things near a body that stands above `origin`, at a frame.
pub(super) fn groups<'a>(
    things: &'a [StripThing],
    frame: usize,
    origin: DVec3,
) -> impl Iterator<Item = Group> + 'a {
    things.iter().filter_map(move |thing| {
        let pose = near(thing, frame, origin)?;
        Some(Group { kind: Kind::Thing, parts: faces(thing.size, pose), bias: 0.0 })
    })
}

/// Where a thing is at a frame, if that is near a body that stands above `origin`.
fn near(thing: &StripThing, frame: usize, origin: DVec3) -> Option<&ObjectPose> {
    let pose = thing.poses.get(frame).or_else(|| thing.poses.last())?;
    let [ahead, _, across] = thing.size;
    let away = plan_of(pose.local(origin));
    let beyond = |along: f64, size: f64| (along.abs() - 0.5 * size).max(0.0);
    (beyond(away.re, ahead).hypot(beyond(away.im, across)) < NEAR).then_some(pose)
}

/// The partners near a body, each with its place in the company and what draws it, at any of the frames.
pub(super) fn partners<'a>(
    clip: &Clip,
    company: &Company<'a>,
    frames: &[SourceFrame],
) -> Vec<(usize, Figure<'a>)> {
    let is_shown = |who: &usize| {
        let place = |frame: &SourceFrame| clip.root_positions[frame.as_usize()];
        Some(*who) != company.own
            && frames.iter().any(|frame| is_beside(company, *who, (*frame, place(frame))))
    };
    let shown = (0..company.partners.len()).filter(is_shown);
    shown.map(|who| (who, Figure::new(company.partners[who]))).collect()
}

/// The bodies of partners near `origin` at a frame, in other shirts.
pub(super) fn partner_groups(
    company: &Company,
    partners: &[(usize, Figure)],
    (frame, origin): (SourceFrame, DVec3),
) -> Vec<Group> {
    let near = partners.iter().filter(|(who, _)| is_beside(company, *who, (frame, origin)));
    let mut groups: Vec<Group> = near
        .flat_map(|(who, figure)| {
            let clip = company.partners[*who];
            figure.groups(&clip.skeleton.forward_kinematics(&clip.pose(shown(clip, frame))))
        })
        .collect();
    for part in groups.iter_mut().flat_map(|group| &mut group.parts).filter(|part| part.cloth == Cloth::Shirt)
    {
        part.cloth = Cloth::PartnerShirt;
    }
    groups
}

fn is_beside(company: &Company, who: usize, (frame, place): (SourceFrame, DVec3)) -> bool {
    let partner = company.partners[who];
    let root = partner.root_positions[shown(partner, frame).as_usize()];
    let with = |ties: &[StripTie]| ties.iter().any(|tie| tie.partner == who && tie.contains(frame));
    let mut things = company.things.iter().filter(|thing| with(&thing.carriers));
    let carries = things.any(|thing| near(thing, frame.as_usize(), place).is_some());
    let far = if carries || with(company.ties) { TIED } else { BESIDE };
    (plan_of(root) - plan_of(place)).norm() < far
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
