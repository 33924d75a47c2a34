//! Where in its cycle a gait is: from the strikes of the feet, and from how far one foot is ahead of the other.

use crate::clip::contacts::{BodyPoint, FootContacts, FootPoint, foot_point, runs};
use crate::clip::working::WorkingClip;
use crate::geometry::{cis, plan_of};

/// Strikes of one foot nearer than this are one that was seen twice, farther apart a rest between them, frames (0.4 s, 2 s).
const CYCLE: (usize, usize) = (12, 60);

/// Phase of a gait, working frame by working frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Gait {
    /// Share of the cycle that has passed since the last strike of the left foot, in [0, 1); `None` before its first and after
    /// its last strike, and where it rests.
    pub left: Vec<Option<f64>>,
    /// The same of the right foot.
    pub right: Vec<Option<f64>>,
    /// Median length of the cycles of both feet, frames; `None` where no foot strikes twice.
    pub cycle: Option<usize>,
}

/// Gait of a clip by the contacts of its feet.
pub fn gait(contacts: &[FootContacts]) -> Gait {
    let left: Vec<bool> = contacts.iter().map(|contact| contact.left_heel || contact.left_toe).collect();
    let right: Vec<bool> = contacts.iter().map(|contact| contact.right_heel || contact.right_toe).collect();
    let mut lengths: Vec<usize> =
        [&left, &right].into_iter().flat_map(|bears| cycles(bears)).map(|(from, to)| to - from).collect();
    lengths.sort_unstable();
    let cycle = lengths.get(lengths.len() / 2).copied();
    Gait { left: phases(&left), right: phases(&right), cycle }
}

/// Frames at which the foot comes down, from each of them to the next.
fn cycles(bears: &[bool]) -> Vec<(usize, usize)> {
    // A foot that bears from the first frame on has come down at a frame that nobody saw.
    let strikes: Vec<usize> =
        runs(bears).into_iter().map(|(first, _)| first).filter(|first| *first > 0).collect();
    let pairs = strikes.windows(2).map(|pair| (pair[0], pair[1]));
    pairs.filter(|(from, to)| (CYCLE.0..=CYCLE.1).contains(&(to - from))).collect()
}

fn phases(bears: &[bool]) -> Vec<Option<f64>> {
    let mut phases = vec![None; bears.len()];
    for (from, to) in cycles(bears) {
        for (frame, phase) in phases.iter_mut().enumerate().take(to).skip(from) {
            *phase = Some((frame - from) as f64 / (to - from) as f64);
        }
    }
    phases
}

impl Gait {
    /// Share of a cycle between frames `i` and `j`, whole cycles left out, in [0, ½]: the mean over the feet whose phase is known
    /// at both; `None` if neither is.
    pub fn apart(&self, i: usize, j: usize) -> Option<f64> {
        let of = |phases: &[Option<f64>]| {
            let difference = (phases[i]? - phases[j]?).abs();
            Some(difference.min(1.0 - difference))
        };
        match (of(&self.left), of(&self.right)) {
            (Some(left), Some(right)) => Some(0.5 * (left + right)),
            (left, right) => left.or(right),
        }
    }
}

/// How far the left ankle is ahead of the right one along the heading at each working frame, metres; `None` without ankles.
pub fn feet_apart(clip: &WorkingClip) -> Option<Vec<f64>> {
    let skeleton = &clip.clip.skeleton;
    let (left, right) =
        (foot_point(skeleton, FootPoint::LeftHeel)?, foot_point(skeleton, FootPoint::RightHeel)?);
    let apart = |frame: usize| {
        let frames = skeleton.forward_kinematics(&clip.pose(frame as f64));
        let place = |point: &BodyPoint| plan_of(point.place(&frames));
        (cis(-clip.headings[frame]) * (place(&left) - place(&right))).re
    };
    Some((0..clip.frame_count()).map(apart).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strikes of the left foot every 30 frames, from frame 5 on; of the right one half a cycle later.
    fn steps(frames: usize) -> Vec<FootContacts> {
        let bears = |frame: usize, strike: usize| frame >= strike && (frame - strike) % 30 < 18;
        (0..frames)
            .map(|frame| FootContacts {
                left_heel: bears(frame, 5),
                right_toe: bears(frame, 20),
                ..FootContacts::default()
            })
            .collect()
    }

    #[test]
    fn a_cycle_lasts_from_strike_to_strike() {
        let gait = gait(&steps(100));
        assert_eq!(gait.cycle, Some(30));
        assert_eq!(
            (gait.left[4], gait.left[5], gait.left[20], gait.left[95]),
            (None, Some(0.0), Some(0.5), None)
        );
        assert_eq!(gait.apart(10, 40), Some(0.0));
        assert_eq!(gait.apart(10, 55), Some(0.5));
        assert_eq!(gait.apart(0, 10), None);
    }

    #[test]
    fn rests_and_stutters_have_no_phase() {
        let mut contacts = steps(100);
        for contact in &mut contacts[30..] {
            *contact = FootContacts { left_heel: true, right_toe: true, ..FootContacts::default() };
        }
        contacts[33].left_heel = false;
        assert_eq!(gait(&contacts).cycle, None);
    }
}
