//! The text of a DeepMimic motion: one row of numbers a frame.

use super::body::{FIRST_PLACE, ROW};
use super::error::DeepMimicError;
use super::json::Json;
use crate::clip::repair::{Gap, LONGEST_GAP, fill_gaps};
use crate::clip::text::{TextError, Word};

/// Most values without a number that are filled in.
const GAP_LIMIT: usize = 65_536;

/// Rows that any file may have, and how many bytes of a larger one must stand behind each; motions have 400 and more.
const FREE_ROWS: usize = 65_536;
const BYTES_PER_ROW: usize = 128;

/// Places of the root beyond this are none, metres.
const FARTHEST: f64 = 1e9;

/// A whole file.
#[derive(Clone, Debug)]
pub(super) struct RawMotion<'a> {
    /// Tells positions.
    pub(super) json: Json<'a>,
    /// All rows, one after the other, [`ROW`] long; at least one.
    pub(super) values: Vec<f64>,
    /// Where each row starts in the file.
    pub(super) starts: Vec<usize>,
    /// Rows that were mended.
    pub(super) mended: Vec<usize>,
}

impl RawMotion<'_> {
    /// Where value `column` of `row` starts in the file.
    pub(super) fn byte_of(&self, row: usize, column: usize) -> usize {
        let mut json = self.json.moved_to(self.starts[row]);
        for _ in 0..column {
            // The row was read before: a mark, a value, a mark …
            json.takes(b'[');
            json.takes(b',');
            let _ = json.scalar("a number");
        }
        json.takes(b'[');
        json.takes(b',');
        json.peek().map_or(self.starts[row], |(start, _)| start)
    }
}

/// Reads the text; cost linear in its length, memory in what the file really holds. `repair`: values that are no finite
/// numbers are filled in.
pub(super) fn parse(bytes: &[u8], repair: bool) -> Result<RawMotion<'_>, DeepMimicError> {
    let mut json = Json::new(bytes);
    if !json.takes(b'{') {
        return Err(not_deepmimic(&mut json));
    }
    let mut rows = None;
    let mut has_loop = false;
    if !json.takes(b'}') {
        loop {
            member(&mut json, &mut rows, &mut has_loop, repair)?;
            if !json.takes(b',') {
                break;
            }
        }
        json.expect(b'}', "a comma or a closing brace")?;
    }
    if json.peek().is_some() {
        return Err(json.unexpected("the end of the file").into());
    }
    let end = json.position(bytes.len());
    let Rows { mut values, starts, gaps } = rows.ok_or(DeepMimicError::NoFramesKey { at: end })?;
    let mended = fill_gaps(&mut values, ROW, &gaps.unwrap_or_default(), |_| false)
        .map_err(|gap| DeepMimicError::LongGap { at: json.position(gap.start), limit: LONGEST_GAP })?;
    Ok(RawMotion { json, values, starts, mended })
}

fn not_deepmimic(json: &mut Json<'_>) -> DeepMimicError {
    match json.unexpected("an opening brace") {
        TextError::Unexpected { at, found, .. } => DeepMimicError::NotDeepMimic { at, found },
        other => DeepMimicError::NotDeepMimic { at: other.position(), found: "nothing".to_owned() },
    }
}

/// Key and value; what is neither `Frames` nor `Loop` is skipped.
fn member(
    json: &mut Json<'_>,
    rows: &mut Option<Rows>,
    has_loop: &mut bool,
    repair: bool,
) -> Result<(), DeepMimicError> {
    let key = json.key()?;
    let once = |is_there: bool, key_name| {
        let at = json.position(key.start);
        if is_there { Err(DeepMimicError::RepeatedKey { at, key: key_name }) } else { Ok(()) }
    };
    match key.bytes {
        b"Frames" => {
            once(rows.is_some(), "Frames")?;
            *rows = Some(frames(json, repair)?);
        }
        b"Loop" => {
            once(std::mem::replace(has_loop, true), "Loop")?;
            loop_mode(json)?;
        }
        _ => json.skip_value()?,
    }
    Ok(())
}

/// `"wrap"` or `"none"`: whether the motion repeats. A clip is what was captured, so that nothing follows from it.
fn loop_mode(json: &mut Json<'_>) -> Result<(), TextError> {
    let expected = "\"wrap\" or \"none\"";
    let mode = json.string(expected)?;
    if matches!(mode.bytes, b"wrap" | b"none") { Ok(()) } else { Err(json.unexpected_string(mode, expected)) }
}

/// Rows as they are read.
#[derive(Debug)]
struct Rows {
    values: Vec<f64>,
    starts: Vec<usize>,
    /// Values without a number; `None` where they are faults.
    gaps: Option<Vec<Gap>>,
}

/// The list of rows, at least one.
fn frames(json: &mut Json<'_>, repair: bool) -> Result<Rows, DeepMimicError> {
    let limit = FREE_ROWS + json.remaining() / BYTES_PER_ROW;
    let start = json.expect(b'[', "a list of rows")?;
    let mut rows = Rows { values: Vec::new(), starts: Vec::new(), gaps: repair.then(Vec::new) };
    if json.takes(b']') {
        return Err(DeepMimicError::NoFrames { at: json.position(start) });
    }
    loop {
        let before = json.remaining();
        row(json, &mut rows, limit)?;
        if rows.starts.len() == 1 {
            reserve(&mut rows, json.remaining(), before - json.remaining());
        }
        if !json.takes(b',') {
            break;
        }
    }
    json.expect(b']', "a comma or a closing bracket")?;
    Ok(rows)
}

/// Makes room for as many rows as the rest of the file holds if all are like the first, `bytes` long.
fn reserve(rows: &mut Rows, remaining: usize, bytes: usize) {
    let expected = remaining / bytes.max(2 * ROW);
    rows.values.reserve(expected * ROW);
    rows.starts.reserve(expected);
}

fn row(json: &mut Json<'_>, rows: &mut Rows, limit: usize) -> Result<(), DeepMimicError> {
    let start = json.expect(b'[', "a row of numbers in brackets")?;
    if rows.starts.len() == limit {
        return Err(DeepMimicError::TooManyRows { at: json.position(start), limit });
    }
    let mut found = 0;
    if !json.takes(b']') {
        loop {
            let word = json.scalar("a number")?;
            let number = number(json, rows, word, found)?;
            if found < ROW {
                rows.values.push(number);
            }
            found += 1;
            if !json.takes(b',') {
                break;
            }
        }
        json.expect(b']', "a comma or a closing bracket")?;
    }
    rows.starts.push(start);
    if found == ROW {
        return Ok(());
    }
    let row = rows.starts.len();
    Err(DeepMimicError::RowLength { at: json.position(start), row, expected: ROW, found })
}

/// One number, or NaN and a gap; `null` is one as well.
fn number<'a>(
    json: &Json<'a>,
    rows: &mut Rows,
    word: Word<'a>,
    column: usize,
) -> Result<f64, DeepMimicError> {
    let is_place = (FIRST_PLACE..FIRST_PLACE + 3).contains(&column);
    match (json.number(word), &mut rows.gaps) {
        (Ok(found), _) if is_place && found.abs() > FARTHEST => {
            Err(DeepMimicError::TooFar { at: json.position(word.start), found, most: FARTHEST })
        }
        (Ok(found), _) => Ok(found),
        (Err(error), Some(gaps)) if word.bytes == b"null" || matches!(error, TextError::NotFinite { .. }) => {
            if gaps.len() == GAP_LIMIT {
                let at = json.position(word.start);
                return Err(DeepMimicError::TooManyGaps { at, limit: GAP_LIMIT });
            }
            gaps.push(Gap { row: rows.starts.len(), column, start: word.start });
            Ok(f64::NAN)
        }
        (Err(error), _) => Err(error.into()),
    }
}
