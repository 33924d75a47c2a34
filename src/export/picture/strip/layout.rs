//! Which frames of a clip a strip shows, and where they stand.

use crate::clip::Clip;
use crate::index::{SourceFrame, floor_index};

/// What a pose covers around its origin, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Default for Span {
    /// Covers nothing.
    fn default() -> Self {
        let none = f64::INFINITY;
        Self { left: none, right: -none, low: none, high: -none }
    }
}

impl Span {
    /// Also covers a disk, as far as it is not absurdly far away.
    pub(super) fn with(self, place: [f64; 2], radius: f64) -> Self {
        let [x, y] = place.map(|coordinate| coordinate.clamp(-FURTHEST, FURTHEST));
        Self {
            left: self.left.min(x - radius),
            right: self.right.max(x + radius),
            low: self.low.min(y - radius),
            high: self.high.max(y + radius),
        }
    }

    fn width(&self) -> f64 {
        self.right - self.left
    }
}

/// Where poses stand.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// Row, and place of the origin from the left edge, metres, of each pose.
    pub(super) places: Vec<(usize, f64)>,
    pub(super) rows: usize,
    /// Poses stand as far apart as they are in the clip.
    pub(super) is_real: bool,
    /// Pixels a metre.
    pub(super) scale: f64,
    /// Width of all rows, px.
    pub(super) width: f64,
    /// Highest and lowest point of any pose against the ground line, metres.
    pub(super) above: f64,
    pub(super) below: f64,
}

/// Widest row, px.
const WIDEST: f64 = 1548.0;
/// Highest row, px.
const HIGHEST: f64 = 900.0;
/// Coordinates beyond are drawn there, metres.
const FURTHEST: f64 = 1e12;
/// Narrowest row, px: room for the title.
const NARROWEST: f64 = 420.0;
/// Largest and smallest scale, pixels a metre; a standing body is between 155 and 260 px high.
const SCALES: (f64, f64) = (150.0, 90.0);
/// Smallest scale of poses at their real distance, pixels a metre.
const LEAST_REAL: f64 = 62.0;
/// Between poses spaced evenly, metres.
const GAP: f64 = 0.07;
/// Neighbours at their real distance may share so much of the narrower one's width.
const SHARED: f64 = 0.12;

impl Layout {
    /// `spans`: of all poses in order; `travel`: how far to the right each is of the first, metres.
    pub(super) fn of(spans: &[Span], travel: &[f64]) -> Self {
        let real = at_distance(spans, travel);
        let is_real = real.is_some();
        let (places, metres) = real.unwrap_or_else(|| spaced(spans));
        let rows = places.last().map_or(1, |place| place.0 + 1);
        let above = spans.iter().map(|span| span.high).fold(0.1, f64::max);
        let below = spans.iter().map(|span| -span.low).fold(0.0, f64::max);
        let scale = (WIDEST / metres).min(SCALES.0).min(HIGHEST / (above + below));
        Self { places, rows, is_real, scale, width: (metres * scale).max(NARROWEST), above, below }
    }

    /// Height of a row without its labels, px.
    pub(super) fn row_height(&self) -> f64 {
        (self.above + self.below) * self.scale
    }

    /// From a pose's origin to the middle of what it covers, px.
    pub(super) fn label_offset(&self, span: Span) -> f64 {
        f64::midpoint(span.left, span.right) * self.scale
    }
}

/// Places in one row at the real distances, and its width, metres; `None` where poses would cover each other or be small.
fn at_distance(spans: &[Span], travel: &[f64]) -> Option<(Vec<(usize, f64)>, f64)> {
    let edges: Vec<(f64, f64)> =
        spans.iter().zip(travel).map(|(span, x)| (x + span.left, x + span.right)).collect();
    for (index, a) in edges.iter().enumerate() {
        for (other, b) in edges.iter().enumerate().skip(index + 1) {
            let shared = a.1.min(b.1) - a.0.max(b.0);
            if shared > SHARED * spans[index].width().min(spans[other].width()) {
                return None;
            }
        }
    }
    let left = edges.iter().map(|edge| edge.0).fold(f64::INFINITY, f64::min);
    let right = edges.iter().map(|edge| edge.1).fold(f64::NEG_INFINITY, f64::max);
    let fits = spans.len() > 1 && (right - left) * LEAST_REAL <= WIDEST;
    fits.then(|| (travel.iter().map(|x| (0, x - left)).collect(), right - left))
}

/// Places evenly spaced, in as few rows as leave bodies large enough, and the width of a row, metres.
fn spaced(spans: &[Span]) -> (Vec<(usize, f64)>, f64) {
    let left = spans.iter().map(|span| -span.left).fold(0.0, f64::max);
    let right = spans.iter().map(|span| span.right).fold(0.0, f64::max);
    let pairs = spans.windows(2).map(|pair| pair[0].right - pair[1].left);
    let pitch = pairs.fold(0.3, f64::max) + GAP;
    let width = |columns: usize| left + right + (columns - 1) as f64 * pitch;
    let columns = |rows: usize| spans.len().div_ceil(rows);
    let rows =
        (1..spans.len()).find(|rows| width(columns(*rows)) * SCALES.1 <= WIDEST).unwrap_or(spans.len());
    let columns = columns(rows).max(1);
    let places = (0..spans.len()).map(|index| (index / columns, left + (index % columns) as f64 * pitch));
    (places.collect(), width(columns))
}

/// Frames spread evenly over the usable part, both ends among them; the nearest of them gives way to each event.
pub(super) fn chosen_frames(clip: &Clip, poses: usize) -> Vec<SourceFrame> {
    let (first, last) = clip.usable;
    let count = poses.clamp(1, last.as_usize() - first.as_usize() + 1);
    let step = f64::from(last.0 - first.0) / (count.max(2) - 1) as f64;
    let spread = |index: usize| first.as_usize() + floor_index(index as f64 * step + 0.5);
    let mut frames: Vec<(SourceFrame, bool)> =
        (0..count).map(|index| (SourceFrame::from_usize(spread(index)), false)).collect();
    for event in clip.events.values().filter(|event| first <= **event && **event <= last) {
        if frames.iter().any(|(frame, is_event)| frame == event && *is_event) {
            continue;
        }
        let free = frames.iter_mut().filter(|(_, is_event)| !is_event);
        if let Some(nearest) = free.min_by_key(|(frame, _)| frame.0.abs_diff(event.0)) {
            *nearest = (*event, true);
        }
    }
    frames.sort();
    frames.dedup_by_key(|(frame, _)| *frame);
    frames.into_iter().map(|(frame, _)| frame).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::clip::builtin::generate;

    /// Somebody 0.6 m wide and 1.7 m high.
    const BODY: Span = Span { left: -0.3, right: 0.3, low: -0.05, high: 1.7 };

    #[test]
    fn poses_stand_at_their_distance_where_they_do_not_cover_each_other() {
        let far = Layout::of(&[BODY; 4], &[0.0, 0.7, 1.5, 2.2]);
        assert!(far.is_real && far.rows == 1);
        assert!((far.places[2].1 - far.places[0].1 - 1.5).abs() < 1e-12);
        let near = Layout::of(&[BODY; 4], &[0.0, 0.7, 0.9, 2.2]);
        assert!(!near.is_real);
        let steps: Vec<f64> = near.places.windows(2).map(|pair| pair[1].1 - pair[0].1).collect();
        assert!(steps.iter().all(|step| (step - steps[0]).abs() < 1e-12 && *step > 0.6));
        let there_and_back = Layout::of(&[BODY; 3], &[0.0, 2.0, 0.1]);
        assert!(!there_and_back.is_real, "the first and the last cover each other");
    }

    #[test]
    fn many_poses_take_rows_and_stay_large() {
        let layout = Layout::of(&[BODY; 60], &[0.0; 60]);
        assert!(layout.rows > 1 && layout.scale >= SCALES.0.min(SCALES.1));
        assert!(layout.places.iter().all(|(row, x)| *row < layout.rows && *x * layout.scale <= WIDEST));
    }

    #[test]
    fn frames_of_events_are_shown_and_so_are_both_ends() {
        let slap = generate("slap", &BTreeMap::new()).expect("a generated clip");
        for poses in [2, 5, 12, 40] {
            let frames = chosen_frames(&slap, poses);
            assert_eq!(frames.len(), poses);
            assert!(frames.contains(&slap.events["hit"]), "{poses}");
            assert!(frames.is_sorted() && frames.windows(2).all(|pair| pair[0] != pair[1]));
        }
        let all = chosen_frames(&slap, 10_000);
        assert_eq!(all.len(), slap.frame_count());
        assert_eq!(chosen_frames(&slap, 12).last(), Some(&slap.usable.1));
    }
}
