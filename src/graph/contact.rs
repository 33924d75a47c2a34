//! Whether two frames stand on the same feet, as far apart.

use crate::clip::contacts::Contacts;
use crate::clip::gait::{feet_apart, gait};
use crate::clip::working::WorkingClip;
use crate::similarity::moving;

/// How far one foot is ahead of the other may differ by this at two similar frames, as a share of its range.
const APART: f64 = 0.25;

/// What the feet of a clip do at each working frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Feet {
    /// When each foot bears: left, right.
    pub bear: Vec<[bool; 2]>,
    /// How far the left one is ahead of the right one, metres, and the range of that; `None` without a gait.
    pub apart: Option<(Vec<f64>, f64)>,
}

impl Feet {
    /// Of a clip. Cost: linear in frames times joints.
    pub(super) fn of(clip: &WorkingClip) -> Self {
        let has_gait = gait(&clip.contacts, &moving(clip)).cycle.is_some();
        let apart = has_gait.then(|| feet_apart(clip)).flatten().map(|apart| {
            let low = apart.iter().copied().fold(f64::INFINITY, f64::min);
            let high = apart.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            (apart, high - low)
        });
        Self { apart, ..Self::bearing(&clip.contacts) }
    }

    /// A foot bears where its heel or its toe does.
    fn bearing(contacts: &[Contacts]) -> Self {
        let bear = contacts.iter().map(|contacts| [contacts.left_foot(), contacts.right_foot()]).collect();
        Self { bear, apart: None }
    }

    /// Whether both feet do the same at frame `i` of one clip and frame `j` of another, give or take `tolerance` frames
    /// (strikes are found to a frame or so), and are about as far apart where both clips have a gait.
    pub(super) fn agree(&self, i: usize, other: &Self, j: usize, tolerance: usize) -> bool {
        let near = |feet: &Self, frame: usize, foot: usize, bears: bool| {
            let end = (frame + tolerance + 1).min(feet.bear.len());
            feet.bear[frame.saturating_sub(tolerance)..end].iter().any(|both| both[foot] == bears)
        };
        self.stride(i, other, j)
            && (0..2).all(|foot| {
                near(other, j, foot, self.bear[i][foot]) && near(self, i, foot, other.bear[j][foot])
            })
    }

    fn stride(&self, i: usize, other: &Self, j: usize) -> bool {
        let (Some((own, range)), Some((others, their_range))) = (&self.apart, &other.apart) else {
            return true;
        };
        (own[i] - others[j]).abs() <= APART * range.min(*their_range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strike_may_be_a_frame_off_and_no_more() {
        let strikes =
            |at: usize| Feet { bear: (0..10).map(|frame| [frame >= at, true]).collect(), apart: None };
        for (off, agrees) in [(0, true), (1, true), (2, false)] {
            assert_eq!(strikes(5).agree(5, &strikes(5 + off), 5, 1), agrees, "{off} frames off");
            assert_eq!(
                strikes(5 + off).agree(5, &strikes(5), 5, 1),
                agrees,
                "{off} frames off, the other way"
            );
            assert_eq!(strikes(5).agree(5, &strikes(5 + off), 5, 0), off == 0);
        }
    }

    #[test]
    fn strides_agree_to_a_quarter_of_the_shorter_range() {
        let feet = |apart: f64, range: f64| Feet { bear: vec![[true; 2]], apart: Some((vec![apart], range)) };
        let still = Feet { bear: vec![[true; 2]], apart: None };
        assert!(feet(0.3, 1.2).agree(0, &feet(0.5, 0.8), 0, 1));
        assert!(!feet(0.3, 1.2).agree(0, &feet(0.51, 0.8), 0, 1));
        assert!(!feet(0.51, 0.8).agree(0, &feet(0.3, 1.2), 0, 1));
        assert!(feet(0.3, 1.2).agree(0, &still, 0, 1), "who has no gait sets no range");
    }
}
