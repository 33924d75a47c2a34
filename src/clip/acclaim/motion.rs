//! The text of an AMC file: one row of values a frame, in the order of the skeleton; file units, degrees.

use std::collections::HashMap;

use super::error::AmcError;
use super::lines::Lines;
use super::skeleton::{AngleUnit, Dof, FARTHEST, RawSkeleton};
use crate::clip::file_motion::is_paid_for;
use crate::clip::repair::{Gap, LONGEST_GAP, fill_gaps};
use crate::clip::text::{TextError, Word, quote};

/// Most values without a number that are filled in.
const GAP_LIMIT: usize = 65_536;

/// Rates outside these are none, samples a second: frames of 10 s to 1 µs, as in BVH files.
const RATES: std::ops::RangeInclusive<f64> = 0.1..=1e6;

/// A whole file.
#[derive(Clone, Debug)]
pub(super) struct RawMotion {
    /// All rows, one after the other, [`Columns::width`] long.
    pub(super) values: Vec<f64>,
    /// At least 1.
    pub(super) frame_count: usize,
    /// Samples a second, where the file says.
    pub(super) fps: Option<f64>,
    /// Rows that were mended.
    pub(super) mended: Vec<usize>,
}

/// Where the values of the root and of each bone stand in a row.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    /// What each column is.
    pub(super) dofs: Vec<Dof>,
    /// First column of the root, then of each bone, and at the end the length of a row.
    pub(super) starts: Vec<usize>,
}

impl Columns {
    pub(super) fn of(skeleton: &RawSkeleton<'_>) -> Self {
        let mut dofs = skeleton.root.dofs.clone();
        let mut starts = vec![0, dofs.len()];
        for bone in &skeleton.bones {
            dofs.extend(bone.dofs.iter().copied().map(Dof::Turn));
            starts.push(dofs.len());
        }
        Self { dofs, starts }
    }

    pub(super) fn width(&self) -> usize {
        self.dofs.len()
    }
}

/// What is known while the rows are read.
struct Reading<'s, 'a> {
    lines: Lines<'a>,
    skeleton: &'s RawSkeleton<'s>,
    columns: &'s Columns,
    /// Position in `columns.starts` of the root and of each bone by name.
    index: HashMap<&'s [u8], usize>,
    /// Number of the frame in which the root and each bone were seen last.
    seen: Vec<Option<u64>>,
    angles: AngleUnit,
    values: Vec<f64>,
    /// Values without a number; `None` where they are faults.
    gaps: Option<Vec<Gap>>,
}

/// Reads the text; cost linear in its length, memory in what the file really holds. `repair`: values that are no finite
/// numbers and frames that are left out are filled in.
pub(super) fn parse(
    bytes: &[u8],
    skeleton: &RawSkeleton<'_>,
    columns: &Columns,
    repair: bool,
) -> Result<RawMotion, AmcError> {
    let mut lines = Lines::new(bytes);
    let (angles, fps) = header(&mut lines, skeleton.angles)?;
    let mut index: HashMap<&[u8], usize> =
        skeleton.bones.iter().enumerate().map(|(bone, found)| (found.name.bytes, bone + 1)).collect();
    index.insert(b"root", 0);
    let mut reading = Reading {
        lines,
        skeleton,
        columns,
        index,
        seen: vec![None; skeleton.bones.len() + 1],
        angles,
        values: Vec::new(),
        gaps: repair.then(Vec::new),
    };
    let frame_count = frames(&mut reading)?;
    let Reading { lines, mut values, gaps, .. } = reading;
    let is_angle = |column: usize| matches!(columns.dofs[column], Dof::Turn(_));
    let mended = fill_gaps(&mut values, columns.width(), &gaps.unwrap_or_default(), is_angle)
        .map_err(|gap| AmcError::LongGap { at: lines.position_of_byte(gap.start), limit: LONGEST_GAP })?;
    Ok(RawMotion { values, frame_count, fps, mended })
}

/// The words with a colon before the first frame: unit of the angles, rate.
fn header(lines: &mut Lines<'_>, usual: AngleUnit) -> Result<(AngleUnit, Option<f64>), AmcError> {
    let mut angles = usual;
    let mut fps = None;
    while let Some(word) = lines.peek().filter(|word| word.bytes.first() == Some(&b':')) {
        lines.word();
        if word.is(":DEGREES") {
            angles = AngleUnit::Degrees;
        } else if word.is(":RADIANS") {
            angles = AngleUnit::Radians;
        } else if word.is(":SAMPLES-PER-SECOND") {
            let found = lines.next_number()?;
            if !RATES.contains(&found) {
                return Err(AmcError::Rate { at: lines.position(word), found });
            }
            fps = Some(found);
        } else if !word.is(":FULLY-SPECIFIED") {
            let known = ":FULLY-SPECIFIED, :DEGREES, :RADIANS or :SAMPLES-PER-SECOND";
            return Err(lines.unexpected(word, known).into());
        }
        lines.end_line()?;
    }
    Ok((angles, fps))
}

/// All frames to the end of the file; their number, left out ones that are to be filled in counted.
fn frames(reading: &mut Reading<'_, '_>) -> Result<usize, AmcError> {
    let bytes = reading.lines.remaining();
    let (joints, width) = (reading.seen.len(), reading.columns.width());
    let mut expected = None;
    let mut count = 0;
    while let Some(word) = reading.lines.word() {
        let number = frame_number(reading, word)?;
        count += left_out(reading, word, expected.unwrap_or(number), number)?;
        count += 1;
        if !is_paid_for(bytes, count, joints, width) {
            let at = reading.lines.position(word);
            return Err(AmcError::TooManyRotations { at, joints, frames: count });
        }
        let before = reading.lines.remaining();
        frame(reading, word, number)?;
        if expected.is_none() {
            reserve(reading, before - reading.lines.remaining());
        }
        expected = Some(number + 1);
    }
    if count == 0 {
        return Err(AmcError::NoFrames { at: reading.lines.here() });
    }
    Ok(count)
}

/// Makes room for as many rows as the rest of the file holds if all frames are like the first, `bytes` long.
fn reserve(reading: &mut Reading<'_, '_>, bytes: usize) {
    let width = reading.columns.width();
    reading.values.reserve(reading.lines.remaining() / bytes.max(2 * width).max(1) * width);
}

fn frame_number(reading: &mut Reading<'_, '_>, word: Word<'_>) -> Result<u64, AmcError> {
    if !is_number(word) {
        return Err(reading.lines.unexpected(word, "the number of a frame").into());
    }
    let text = std::str::from_utf8(word.bytes).ok();
    let number = text.and_then(|text| text.parse::<u32>().ok()).ok_or_else(|| TextError::NotACount {
        at: reading.lines.position(word),
        found: quote(word.bytes),
        what: "frames",
    })?;
    reading.lines.end_line()?;
    Ok(u64::from(number))
}

fn is_number(word: Word<'_>) -> bool {
    word.bytes.iter().all(u8::is_ascii_digit)
}

/// Number of frames left out before frame `found`, rows of gaps for which are made.
fn left_out(
    reading: &mut Reading<'_, '_>,
    word: Word<'_>,
    expected: u64,
    found: u64,
) -> Result<usize, AmcError> {
    let missing = found.checked_sub(expected).and_then(|missing| usize::try_from(missing).ok());
    let limit = if reading.gaps.is_some() { LONGEST_GAP } else { 0 };
    let Some(missing) = missing.filter(|missing| *missing <= limit) else {
        return Err(AmcError::FrameNumber { at: reading.lines.position(word), expected, found });
    };
    for _ in 0..missing {
        for _ in 0..reading.columns.width() {
            put(reading, word, f64::NAN)?;
        }
    }
    Ok(missing)
}

/// Appends a value, or a gap where it is no number.
fn put(reading: &mut Reading<'_, '_>, word: Word<'_>, value: f64) -> Result<(), AmcError> {
    let at = reading.values.len();
    reading.values.push(value);
    if value.is_nan() { gap(reading, word, at) } else { Ok(()) }
}

/// Notes that value `at` is none.
fn gap(reading: &mut Reading<'_, '_>, word: Word<'_>, at: usize) -> Result<(), AmcError> {
    let width = reading.columns.width();
    let gaps = reading.gaps.as_mut().expect("values are NaN where gaps are allowed only");
    if gaps.len() == GAP_LIMIT {
        return Err(AmcError::TooManyGaps { at: reading.lines.position(word), limit: GAP_LIMIT });
    }
    gaps.push(Gap { row: at / width, column: at % width, start: word.start });
    Ok(())
}

/// The lines of one frame, up to the next number; `start` is where it starts.
fn frame(reading: &mut Reading<'_, '_>, start: Word<'_>, number: u64) -> Result<(), AmcError> {
    let row = reading.values.len();
    reading.values.resize(row + reading.columns.width(), 0.0);
    while let Some(word) = reading.lines.peek().filter(|word| !is_number(*word)) {
        reading.lines.word();
        bone(reading, word, row, number)?;
    }
    let starts = &reading.columns.starts;
    let lacks = |bone: &usize| starts[*bone] < starts[*bone + 1] && reading.seen[*bone] != Some(number);
    match (0..reading.seen.len()).find(lacks) {
        None => Ok(()),
        Some(bone) => {
            let name =
                bone.checked_sub(1).map_or(&b"root"[..], |bone| reading.skeleton.bones[bone].name.bytes);
            let at = reading.lines.position(start);
            Err(AmcError::MissingBone { at, bone: quote(name), frame: number })
        }
    }
}

/// The values behind the name of a bone, to the end of the line, into the row that starts at `row`.
fn bone(reading: &mut Reading<'_, '_>, name: Word<'_>, row: usize, frame: u64) -> Result<(), AmcError> {
    let shown = || quote(name.bytes);
    let found = if name.is("root") { Some(0) } else { reading.index.get(name.bytes).copied() };
    let Some(bone) = found else {
        return Err(AmcError::UnknownBone { at: reading.lines.position(name), name: shown(), frame });
    };
    if reading.seen[bone].replace(frame) == Some(frame) {
        return Err(AmcError::RepeatedBone { at: reading.lines.position(name), bone: shown(), frame });
    }
    let (start, end) = (reading.columns.starts[bone], reading.columns.starts[bone + 1]);
    let mut column = start;
    while let Some(word) = reading.lines.word_in_line() {
        if column < end {
            value(reading, word, row, column)?;
        }
        column += 1;
    }
    if column == end {
        return Ok(());
    }
    let (expected, found) = (end - start, column - start);
    Err(AmcError::ValueCount { at: reading.lines.position(name), bone: shown(), frame, expected, found })
}

/// One value, angles in degrees.
fn value(reading: &mut Reading<'_, '_>, word: Word<'_>, row: usize, column: usize) -> Result<(), AmcError> {
    let found = match reading.lines.number(word) {
        Ok(found) => found,
        Err(TextError::NotFinite { .. }) if reading.gaps.is_some() => {
            reading.values[row + column] = f64::NAN;
            return gap(reading, word, row + column);
        }
        Err(error) => return Err(error.into()),
    };
    if found.abs() > FARTHEST {
        return Err(AmcError::TooFar { at: reading.lines.position(word), found, most: FARTHEST });
    }
    reading.values[row + column] = match reading.columns.dofs[column] {
        Dof::Turn(_) => reading.angles.to_degrees(found),
        Dof::Place(_) => found,
    };
    Ok(())
}
