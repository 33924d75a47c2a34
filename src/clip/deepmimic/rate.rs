//! How long the frames of a motion last.

use super::body::ROW;
use super::error::DeepMimicError;
use super::parse::RawMotion;
use crate::clip::note::ReadNote;
use crate::index::SourceFrame;

/// Durations outside these are none, seconds.
const DURATIONS: std::ops::RangeInclusive<f64> = 1e-6..=10.0;

/// Frames last equally long if their durations differ by less than this share.
const SAME_DURATION: f64 = 1e-3;

/// A rate so near to a whole one, as a share of it, is that one: durations are cut to six decimals, 0.016666 for 1/60.
const RATE_ROUNDING: f64 = 1e-4;

/// At most one frame in so many may last longer or shorter than the others.
const UNEVEN_SHARE: usize = 10;

/// Rate of a single frame that lasts no time.
const RATE_OF_A_POSE: f64 = 30.0;

/// Frames per second. The last row's duration says nothing: no frame follows it.
pub(super) fn frame_rate(raw: &RawMotion<'_>, notes: &mut Vec<ReadNote>) -> Result<f64, DeepMimicError> {
    let durations: Vec<f64> = raw.values.iter().step_by(ROW).copied().collect();
    let error = |row: usize, found| {
        let at = raw.json.position(raw.byte_of(row, 0));
        DeepMimicError::Duration { at, row: row + 1, found }
    };
    if let Some(row) = durations.iter().position(|duration| *duration < 0.0) {
        return Err(error(row, durations[row]));
    }
    let steps = &durations[..(durations.len() - 1).max(1)];
    let mut sorted = steps.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let usual = sorted[sorted.len() / 2];
    if durations.len() == 1 && usual == 0.0 {
        notes.push(ReadNote::RateAssumed { fps: RATE_OF_A_POSE });
        return Ok(RATE_OF_A_POSE);
    }
    if !DURATIONS.contains(&usual) {
        let row = steps.iter().position(|duration| *duration == usual).unwrap_or(0);
        return Err(error(row, usual));
    }
    note_uneven(raw, steps, usual, notes)?;
    let rate = 1.0 / usual;
    let whole = rate.round();
    Ok(if (rate - whole).abs() <= RATE_ROUNDING * whole { whole } else { rate })
}

/// Notes rows that last longer or shorter than `usual`, or refuses where they are many.
fn note_uneven(
    raw: &RawMotion<'_>,
    steps: &[f64],
    usual: f64,
    notes: &mut Vec<ReadNote>,
) -> Result<(), DeepMimicError> {
    let is_uneven = |row: &usize| (steps[*row] - usual).abs() > SAME_DURATION * usual;
    let uneven: Vec<usize> = (0..steps.len()).filter(is_uneven).collect();
    let Some(&first) = uneven.first() else {
        return Ok(());
    };
    if uneven.len() * UNEVEN_SHARE > steps.len() {
        let at = raw.json.position(raw.byte_of(first, 0));
        return Err(DeepMimicError::Uneven { at, row: first + 1, found: steps[first], usual });
    }
    notes.push(ReadNote::UnevenFrames { frames: uneven.into_iter().map(SourceFrame::from_usize).collect() });
    Ok(())
}
