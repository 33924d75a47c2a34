//! Whether two frames stand on the same feet.

use crate::clip::contacts::Contacts;

/// When each foot bears: left, right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Feet(pub Vec<[bool; 2]>);

impl Feet {
    /// A foot bears where its heel or its toe does.
    pub(super) fn new(contacts: &[Contacts]) -> Self {
        Self(contacts.iter().map(|contacts| [contacts.left_foot(), contacts.right_foot()]).collect())
    }

    /// Whether both feet do the same at frame `i` of one clip and frame `j` of another, give or take `tolerance` frames:
    /// strikes are found to a frame or so.
    pub(super) fn agree(&self, i: usize, other: &Self, j: usize, tolerance: usize) -> bool {
        let near = |feet: &Self, frame: usize, foot: usize, bears: bool| {
            let end = (frame + tolerance + 1).min(feet.0.len());
            feet.0[frame.saturating_sub(tolerance)..end].iter().any(|both| both[foot] == bears)
        };
        (0..2).all(|foot| near(other, j, foot, self.0[i][foot]) && near(self, i, foot, other.0[j][foot]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strike_may_be_a_frame_off_and_no_more() {
        let strikes = |at: usize| Feet((0..10).map(|frame| [frame >= at, true]).collect());
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
}
