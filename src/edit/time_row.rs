//! Temporal constraints as rows. Source: Kim et al. 2009, §4.3.

use cotillion_solvers::PointRow;

use crate::constraint::Strength;
use crate::index::ConstraintId;
use crate::path::bracket;

/// A moment of a track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimePoint {
    /// Track, by position in the list of frame counts.
    pub track: usize,
    /// Frame, a fraction where rates differ.
    pub frame: f64,
}

/// One row of a temporal constraint: time of `at`, less time of `minus`, equals `seconds`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeRow {
    /// Which constraint of the scene.
    pub constraint: ConstraintId,
    /// Hard, or the weight of this row.
    pub strength: Strength,
    /// Moment.
    pub at: TimePoint,
    /// Moment whose time is taken off; none for an absolute time.
    pub minus: Option<TimePoint>,
    /// Seconds.
    pub seconds: f64,
}

impl TimeRow {
    /// The row on the frames of tracks; `counts`: frames of each track. A moment between frames touches both.
    pub fn on_points(&self, counts: &[usize]) -> PointRow<f64> {
        let mut terms = Vec::with_capacity(4);
        for (point, sign) in std::iter::once((self.at, 1.0)).chain(self.minus.map(|minus| (minus, -1.0))) {
            let (low, high, share) = bracket(point.frame, counts[point.track]);
            if share != 1.0 {
                terms.push((point.track, low, sign * (1.0 - share)));
            }
            if share != 0.0 {
                terms.push((point.track, high, sign * share));
            }
        }
        match self.strength {
            Strength::Hard => PointRow::hard(terms),
            Strength::Soft(weight) => PointRow::soft(terms, weight),
        }
    }
}

/// Bounds on steps, as multiples of the rest step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepBounds {
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
}
