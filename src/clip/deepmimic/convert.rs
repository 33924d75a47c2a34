//! From the rows of a file to a clip.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;

use super::body::{BODY, FIRST_PLACE, ROW, rotation, skeleton};
use super::error::DeepMimicError;
use super::parse::RawMotion;
use crate::clip::Clip;
use crate::clip::note::ReadNote;
use crate::index::SourceFrame;

/// A quaternion may be so much longer or shorter than 1 by rounding alone.
const LENGTH_ROUNDING: f64 = 0.01;

/// The clip; all frames usable.
pub(super) fn clip(
    raw: &RawMotion<'_>,
    name: &str,
    fps: f64,
    notes: &mut Vec<ReadNote>,
) -> Result<Clip, DeepMimicError> {
    let frame_count = raw.starts.len();
    let mut root_positions = Vec::with_capacity(frame_count);
    let mut rotations = Vec::with_capacity(frame_count * BODY.len());
    let mut scaled = Vec::new();
    let mut farthest: f64 = 1.0;
    for (row, numbers) in raw.values.chunks_exact(ROW).enumerate() {
        root_positions.push(DVec3::from_slice(&numbers[FIRST_PLACE..]));
        let mut is_scaled = false;
        for part in &BODY {
            let (turn, length) = rotation(part, &numbers[part.columns()])
                .map_err(|length| no_rotation(raw, [row, part.column], part.name, length))?;
            rotations.push(turn);
            is_scaled |= (length - 1.0).abs() > LENGTH_ROUNDING;
            if (length - 1.0).abs() > (farthest - 1.0).abs() {
                farthest = length;
            }
        }
        if is_scaled {
            scaled.push(SourceFrame::from_usize(row));
        }
    }
    if !scaled.is_empty() {
        notes.push(ReadNote::RotationsScaled { frames: scaled, length: farthest });
    }
    Ok(Clip {
        name: name.to_owned(),
        skeleton: Arc::new(skeleton()),
        fps,
        root_positions,
        rotations,
        moving_offsets: Vec::new(),
        events: BTreeMap::new(),
        contacts: Vec::new(),
        usable: (SourceFrame(0), SourceFrame::from_usize(frame_count - 1)),
    })
}

fn no_rotation(
    raw: &RawMotion<'_>,
    [row, column]: [usize; 2],
    joint: &'static str,
    length: f64,
) -> DeepMimicError {
    let at = raw.json.position(raw.byte_of(row, column));
    DeepMimicError::NoRotation { at, row: row + 1, joint, length }
}
