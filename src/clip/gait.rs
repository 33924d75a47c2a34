//! Where in its cycle a gait is: from the strikes of the feet, which alternate, and from how far one foot is ahead of the other.

use crate::clip::contacts::{BodyPoint, ContactPoint, Contacts, contact_point, runs};
use crate::clip::working::WorkingClip;
use crate::geometry::{cis, plan_of};

/// Strikes of one foot nearer than this are one that was seen twice, farther apart a rest between them, frames (0.4 s, 2 s).
const CYCLE: (usize, usize) = (12, 60);
/// The other foot strikes at least this share of a cycle after and before the one: together they hop.
const ALTERNATE: f64 = 0.2;

/// Phase of a gait, working frame by working frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Gait {
    /// Share of the cycle that has passed since the last strike of the left foot, in [0, 1); `None` before its first and after
    /// its last strike, and where it rests.
    pub left: Vec<Option<f64>>,
    /// The same of the right foot.
    pub right: Vec<Option<f64>>,
    /// Median length of the cycles of both feet, frames; `None` where no foot strikes twice with the
    /// other in between.
    pub cycle: Option<usize>,
}

/// Gait of a clip by the contacts of its feet and by which frames move: who stands shifts feet without a gait. One of each a
/// working frame.
pub fn gait(contacts: &[Contacts], moves: &[bool]) -> Gait {
    let left: Vec<bool> = contacts.iter().map(|contact| contact.left_foot()).collect();
    let right: Vec<bool> = contacts.iter().map(|contact| contact.right_foot()).collect();
    let (left, right) = (strikes(&left), strikes(&right));
    let goes_on = |(from, to): &(usize, usize)| moves[*from..*to].iter().all(|moves| *moves);
    let of_left: Vec<(usize, usize)> = cycles(&left, &right).into_iter().filter(goes_on).collect();
    let of_right: Vec<(usize, usize)> = cycles(&right, &left).into_iter().filter(goes_on).collect();
    let mut lengths: Vec<usize> = of_left.iter().chain(&of_right).map(|(from, to)| to - from).collect();
    lengths.sort_unstable();
    let cycle = lengths.get(lengths.len() / 2).copied();
    Gait { left: phases(&of_left, contacts.len()), right: phases(&of_right, contacts.len()), cycle }
}

/// Frames at which a foot comes down. One that bears from the first frame on has come down at a frame that nobody saw.
fn strikes(bears: &[bool]) -> Vec<usize> {
    runs(bears).into_iter().map(|(first, _)| first).filter(|first| *first > 0).collect()
}

/// From strike to strike of one foot, where the other strikes well in between.
fn cycles(strikes: &[usize], other: &[usize]) -> Vec<(usize, usize)> {
    let alternates = |(from, to): &(usize, usize)| {
        let margin = ALTERNATE * (to - from) as f64;
        other.iter().any(|at| *at as f64 >= *from as f64 + margin && *at as f64 <= *to as f64 - margin)
    };
    let pairs = strikes.windows(2).map(|pair| (pair[0], pair[1]));
    pairs.filter(|(from, to)| (CYCLE.0..=CYCLE.1).contains(&(to - from))).filter(alternates).collect()
}

fn phases(cycles: &[(usize, usize)], frames: usize) -> Vec<Option<f64>> {
    let mut phases = vec![None; frames];
    for (from, to) in cycles {
        for (passed, phase) in phases[*from..*to].iter_mut().enumerate() {
            *phase = Some(passed as f64 / (to - from) as f64);
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
        (contact_point(skeleton, ContactPoint::LeftHeel)?, contact_point(skeleton, ContactPoint::RightHeel)?);
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
    fn steps(frames: usize) -> Vec<Contacts> {
        let bears = |frame: usize, strike: usize| frame >= strike && (frame - strike) % 30 < 18;
        (0..frames)
            .map(|frame| Contacts {
                left_heel: bears(frame, 5),
                right_toe: bears(frame, 20),
                ..Contacts::default()
            })
            .collect()
    }

    #[test]
    fn a_cycle_lasts_from_strike_to_strike() {
        let gait = gait(&steps(100), &[true; 100]);
        assert_eq!(gait.cycle, Some(30));
        assert_eq!(
            (gait.left[4], gait.left[5], gait.left[20], gait.left[95]),
            (None, Some(0.0), Some(0.5), None)
        );
        assert_eq!(gait.apart(10, 40), Some(0.0));
        assert_eq!(gait.apart(10, 55), Some(0.5));
        assert_eq!(gait.apart(0, 10), None);
        assert_eq!(super::gait(&steps(100), &[false; 100]).cycle, None, "on the spot");
    }

    #[test]
    fn hops_are_no_gait() {
        let mut contacts = steps(100);
        contacts.iter_mut().for_each(|contact| contact.right_toe = contact.left_heel);
        assert_eq!(gait(&contacts, &[true; 100]).cycle, None, "on both feet");
        contacts.iter_mut().for_each(|contact| contact.right_toe = false);
        assert_eq!(gait(&contacts, &[true; 100]).cycle, None, "on one foot");
    }

    #[test]
    fn rests_and_stutters_have_no_phase() {
        let mut contacts = steps(100);
        for contact in &mut contacts[8..] {
            *contact = Contacts { left_heel: true, right_toe: true, ..Contacts::default() };
        }
        contacts[33].left_heel = false;
        assert_eq!(gait(&contacts, &[true; 100]).cycle, None);
    }
}
