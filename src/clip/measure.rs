//! What can be measured on any clip, captured or edited: slide of the feet, length of the path, height.

use glam::DVec3;

use crate::clip::Clip;
use crate::clip::contacts::{ContactPoint, Contacts, contact_point, percentile, runs};
use crate::clip::flight::{fitted_gravity, mean_heights};
use crate::clip::note::ReadNote;
use crate::clip::roles::is_helper;
use crate::clip::working::{WORKING_STEP, WorkingClip};
use crate::geometry::plan_of;
use crate::index::{SourceFrame, floor_index};
use crate::skeleton::{JointFrame, Pose, Skeleton};

/// Time between the samples of a root's path: jitter does not add to its length, seconds.
pub const PATH_STEP: f64 = 0.1;

/// Mean horizontal speed of the points of the feet while they are in contact, m/s; `None` without any contact.
///
/// `contacts`: one for each frame of `clip`. A step between two frames counts for a point that is in contact at both.
pub fn foot_slide(clip: &Clip, contacts: &[Contacts]) -> Option<f64> {
    let frames = 0..clip.frame_count();
    let times: Vec<f64> = frames.clone().map(|frame| frame as f64 / clip.fps).collect();
    let poses: Vec<Pose> = frames.map(|frame| clip.pose(SourceFrame::from_usize(frame))).collect();
    foot_slide_at(&clip.skeleton, (&times, &poses), contacts)
}

/// [`foot_slide`] of poses at any times, seconds, rising: one pose and one contact a time.
pub fn foot_slide_at(
    skeleton: &Skeleton,
    (times, poses): (&[f64], &[Pose]),
    contacts: &[Contacts],
) -> Option<f64> {
    debug_assert_eq!([times.len(), poses.len()], [contacts.len(); 2], "one pose and one contact a time");
    let points: Vec<_> = ContactPoint::FEET
        .into_iter()
        .filter_map(|point| Some((point, contact_point(skeleton, point)?)))
        .collect();
    let (mut length, mut seconds) = (0.0, 0.0);
    let mut before: Option<Vec<DVec3>> = None;
    for (at, contact) in contacts.iter().enumerate() {
        let frames = skeleton.forward_kinematics(&poses[at]);
        let places: Vec<DVec3> = points.iter().map(|(_, point)| point.place(&frames)).collect();
        for (index, (point, _)) in points.iter().enumerate() {
            let Some(before) = &before else { break };
            if contact.at(*point) && contacts[at - 1].at(*point) {
                length += (plan_of(places[index]) - plan_of(before[index])).norm();
                seconds += times[at] - times[at - 1];
            }
        }
        before = Some(places);
    }
    (seconds > 0.0).then(|| length / seconds)
}

/// [`foot_slide`] of a range on its working frames, m/s.
pub fn foot_slide_working(working: &WorkingClip) -> Option<f64> {
    let poses: Vec<Pose> = (0..working.frame_count()).map(|index| working.pose(index as f64)).collect();
    let clip = Clip::from_poses(&working.name, working.clip.skeleton.clone(), 1.0 / WORKING_STEP, &poses);
    foot_slide(&clip, &working.contacts)
}

/// Length of the root's path on the ground from file frame `first` to `last`, sampled every [`PATH_STEP`], metres.
pub fn root_path(clip: &Clip, first: SourceFrame, last: SourceFrame) -> f64 {
    let (start, end) = (f64::from(first.0), f64::from(last.0));
    let step = (PATH_STEP * clip.fps).max(1.0);
    let samples = floor_index((end - start) / step + 1e-9);
    let place = |sample: usize| plan_of(clip.root_at((start + sample as f64 * step).min(end)));
    // From 0: the sum of nothing is −0.
    (1..=samples).fold(0.0, |length, sample| length + (place(sample) - place(sample - 1)).norm())
}

/// Shortest flight whose fall tells a wrong rate from noise, working frames.
const SHORTEST_FALL: usize = 8;

/// Bodies do not fall faster, m/s²: limbs move against the body, and flights are detected a little early or late. Slower
/// falls may be those of a body that is held.
const FASTEST_FALL: f64 = 18.0;

/// What to say about a clip that falls faster than bodies do in its longest flight: its rate is wrong, or its unit. `None` where
/// it does, or no flight is long enough to tell. Cost: linear in frames times joints.
pub fn doubtful_fall(working: &WorkingClip) -> Option<ReadNote> {
    let (first, last) = runs(&working.flight).into_iter().max_by_key(|(first, last)| last - first)?;
    if last + 1 - first < SHORTEST_FALL {
        return None;
    }
    let frames = |index: usize| working.clip.skeleton.forward_kinematics(&working.pose(index as f64));
    let poses: Vec<Vec<JointFrame>> = (first..=last).map(frames).collect();
    let gravity = fitted_gravity(&mean_heights(&working.clip.skeleton, &poses), WORKING_STEP);
    let likely_fps = working.clip.fps * (GRAVITY / gravity).sqrt();
    (gravity > FASTEST_FALL).then_some(ReadNote::DoubtfulFall { gravity, fps: working.clip.fps, likely_fps })
}

/// m/s².
const GRAVITY: f64 = 9.81;

/// Share of the frames in which a body is lower than its standing height: more than half, as captures bend now and then.
const STANDING_SHARE: f64 = 0.6;

/// Height of the highest joint above the lowest one when the body stands, metres: the 60th percentile over the file frames
/// `first` to `last`, end sites and helper joints left out. Clips that mostly lie or sit give less.
pub fn standing_height(clip: &Clip, first: SourceFrame, last: SourceFrame) -> f64 {
    let counted: Vec<usize> = (0..clip.skeleton.joints.len())
        .filter(|&index| !is_helper(&clip.skeleton.joints[index].name))
        .collect();
    let heights = (first.as_usize()..=last.as_usize())
        .map(|frame| {
            let frames = frames_at(clip, frame);
            let heights = || counted.iter().map(|&joint| frames[joint].position.y);
            heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min)
        })
        .collect();
    percentile(heights, STANDING_SHARE)
}

fn frames_at(clip: &Clip, frame: usize) -> Vec<JointFrame> {
    clip.skeleton.forward_kinematics(&clip.pose(SourceFrame::from_usize(frame)))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::clip::roles::assign_roles;
    use crate::index::JointId;
    use crate::skeleton::{Axis, Joint};

    /// A leg whose foot slides along x at 0.3 m/s.
    fn sliding() -> Clip {
        let mut joints: Vec<Joint> = ["Hips", "LeftUpLeg", "LeftLeg", "LeftFoot"]
            .iter()
            .enumerate()
            .map(|(index, name)| Joint {
                name: (*name).to_owned(),
                parent: index.checked_sub(1).map(JointId::from_usize),
                offset: DVec3::NEG_Y * 0.4,
                end_site: None,
                rotation_order: [Axis::Z, Axis::X, Axis::Y],
                role: None,
            })
            .collect();
        assign_roles(&mut joints);
        let skeleton = Skeleton { joints };
        let poses: Vec<Pose> = (0..61)
            .map(|frame| Pose { root: DVec3::new(0.01 * f64::from(frame), 1.2, 0.0), ..skeleton.rest_pose() })
            .collect();
        Clip::from_poses("sliding", Arc::new(skeleton), 30.0, &poses)
    }

    #[test]
    fn a_foot_slides_only_while_in_contact() {
        let clip = sliding();
        let mut contacts = vec![Contacts::default(); 61];
        assert_eq!(foot_slide(&clip, &contacts), None);
        for contact in &mut contacts[10..20] {
            contact.left_heel = true;
        }
        let slide = foot_slide(&clip, &contacts).expect("ten frames of contact");
        assert!((slide - 0.3).abs() < 1e-9);
    }

    #[test]
    fn path_and_height_of_a_sliding_leg() {
        let clip = sliding();
        let (first, last) = clip.usable;
        assert!((root_path(&clip, first, last) - 0.6).abs() < 1e-12);
        assert!((standing_height(&clip, first, last) - 1.2).abs() < 1e-12);
        assert_eq!(root_path(&clip, first, first).to_bits(), 0.0_f64.to_bits());
    }
}
