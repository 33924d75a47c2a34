//! Which frames need keyframes: those between equal ones do not, as players go straight from one to the next.

/// Frames among which values change.
pub(super) struct Changes {
    /// Whether a frame differs from the one before.
    differs: Vec<bool>,
}

impl Changes {
    /// Nothing changes in so many frames.
    pub(super) fn of(frames: usize) -> Self {
        Self { differs: vec![false; frames] }
    }

    /// Takes note of a channel, a row for each frame.
    pub(super) fn note<const N: usize>(&mut self, rows: &[[f32; N]]) {
        for (differs, pair) in self.differs.iter_mut().skip(1).zip(rows.windows(2)) {
            *differs |= pair[0] != pair[1];
        }
    }

    /// The frames to keep: first and last, and every one that differs from a neighbour.
    pub(super) fn kept(&self) -> Vec<usize> {
        let count = self.differs.len();
        let is_kept = |k: &usize| {
            *k == 0 || k + 1 == count || self.differs[*k] || self.differs.get(k + 1) == Some(&true)
        };
        (0..count).filter(is_kept).collect()
    }
}

/// The rows of some frames.
pub(super) fn picked<const N: usize>(rows: &[[f32; N]], kept: &[usize]) -> Vec<[f32; N]> {
    kept.iter().map(|k| rows[*k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_waits_has_two_keyframes() {
        let (mut changes, place) = (Changes::of(7), |x: f32| [x, 0.0, 0.0]);
        let places = [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 3.0].map(place);
        changes.note(&places);
        assert_eq!(changes.kept(), [0, 3, 4, 5, 6]);
        changes.note(&[[0.0_f32; 4]; 7]);
        assert_eq!(picked(&places, &changes.kept()), [1.0, 1.0, 2.0, 2.0, 3.0].map(place));
        assert_eq!(Changes::of(3).kept(), [0, 2]);
        assert_eq!(Changes::of(1).kept(), [0]);
    }
}
