//! Facts about the transitions within a clip, as the motion graph finds them.

use serde::Serialize;

/// Transitions of one clip onto itself; frames and lengths are in working frames, 30 a second.
///
/// Counted are pairs of similar frames from 0.3 to 2 s apart, the lengths that an edit may take out or repeat at once, unless it
/// says otherwise.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TransitionFacts {
    /// Number of working frames.
    pub frames: usize,
    /// Median distance M of pairs of moving frames; `None` where nothing moves for long enough.
    pub median_distance: Option<f64>,
    /// Largest distance of similar frames.
    pub largest_distance: f64,
    /// Similar pairs at any length.
    pub all_pairs: usize,
    /// Similar pairs.
    pub pairs: usize,
    /// Pairs a second of the clip.
    pub per_second: f64,
    /// Pairs whose frames do not both move.
    pub idle: usize,
    /// Pairs of moving frames whose phases in the gait are known from the strikes of the feet.
    pub known_phase: usize,
    /// Share of these whose phases are less than a tenth of a cycle apart.
    pub whole_cycles: Option<f64>,
    /// Median length of the gait's cycle.
    pub cycle: Option<usize>,
    /// Largest difference, over all pairs, of how far one foot is ahead of the other, as a share of its range; `None` without
    /// pairs or without a gait.
    pub feet_apart: Option<f64>,
    /// Median turn of the heading between the frames of pairs, degrees, without sign.
    pub turn_deg: Option<f64>,
    /// Frames without a frame of a pair within ten frames.
    pub without: usize,
    /// Largest set of frames from each of which all others can be reached by playing on and by transitions of any length.
    pub looping: usize,
}

impl TransitionFacts {
    /// What matters of it, in a line.
    pub(super) fn text(&self) -> String {
        if self.pairs == 0 {
            return "none from 0.3 to 2 s".to_owned();
        }
        let mut text = format!("{:.1} a second", self.per_second);
        if self.idle > 0 {
            text += &format!(" ({} of {} idle)", self.idle, self.pairs);
        }
        if let Some(share) = self.whole_cycles {
            text += &format!(", whole cycles {:.0} %", 100.0 * share);
        }
        text + &format!("; none near {} of {} frames", self.without, self.frames)
    }
}
