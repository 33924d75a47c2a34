//! The text of a BVH file as it stands: joints, channels, rows; file units, degrees.

use super::error::BvhError;
use crate::clip::file_motion::is_paid_for;
use crate::clip::repair::{Gap, LONGEST_GAP, fill_gaps};
use crate::clip::text::{Cursor, TextError, Word, quote};
use crate::skeleton::Axis;

/// Most joints a file may have.
pub(super) const JOINT_LIMIT: usize = 65_536;

/// Coordinates beyond this, file units, belong to no body.
const FARTHEST: f64 = 1e9;

/// Frame times outside these are none, seconds; ten seconds a frame already make 300 working frames each.
const SHORTEST_FRAME: f64 = 1e-6;
const LONGEST_FRAME: f64 = 10.0;

/// One column of the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    Position(Axis),
    Rotation(Axis),
}

/// A joint as the file has it.
#[derive(Clone, Debug)]
pub(super) struct RawJoint {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    /// File units.
    pub(super) offset: [f64; 3],
    pub(super) end_sites: Vec<[f64; 3]>,
    /// In the order of the file; empty where the file has no CHANNELS line.
    pub(super) channels: Vec<Channel>,
}

/// A whole file.
#[derive(Clone, Debug)]
pub(super) struct RawBvh {
    pub(super) joints: Vec<RawJoint>,
    /// Seconds, as written.
    pub(super) frame_time: f64,
    /// Half a unit of the last digit of the frame time, seconds.
    pub(super) frame_time_rounding: f64,
    /// All rows, one after the other.
    pub(super) values: Vec<f64>,
    /// At least 1.
    pub(super) frame_count: usize,
    /// Rows that were mended.
    pub(super) mended: Vec<usize>,
}

/// A joint whose braces are open.
struct OpenJoint {
    index: usize,
    has_offset: bool,
    has_channels: bool,
}

/// Reads the text; cost linear in its length, memory in what the file really holds. `repair`: values that are no finite
/// numbers are filled in.
pub(super) fn parse(bytes: &[u8], repair: bool) -> Result<RawBvh, BvhError> {
    let mut cursor = Cursor::new(bytes);
    let joints = hierarchy(&mut cursor)?;
    let frames_word = keyed_word(&mut cursor, &["Frames:"], "`Frames:`", "the number of frames")?;
    let frame_count = cursor.count(frames_word, "frames")?;
    if frame_count == 0 {
        return Err(BvhError::NoFrames { at: cursor.position(frames_word.start) });
    }
    let time_word = keyed_word(&mut cursor, &["Frame", "Time:"], "`Frame Time:`", "the frame time")?;
    let frame_time = cursor.number(time_word)?;
    if !(SHORTEST_FRAME..=LONGEST_FRAME).contains(&frame_time) {
        return Err(BvhError::FrameTime { at: cursor.position(time_word.start), found: frame_time });
    }
    end_line(&mut cursor)?;
    let channels: Vec<Channel> = joints.iter().flat_map(|joint| joint.channels.iter().copied()).collect();
    if channels.is_empty() {
        return Err(BvhError::NoChannels { at: cursor.position(frames_word.start) });
    }
    let mut gaps = Vec::new();
    let mut values = rows(&mut cursor, frame_count, &channels, repair.then_some(&mut gaps))?;
    let has_place =
        |joint: &&RawJoint| joint.channels.iter().any(|channel| matches!(channel, Channel::Position(_)));
    // Joints that move take three numbers more.
    let columns = channels.len() + 3 * joints.iter().filter(has_place).count();
    if !is_paid_for(bytes.len(), frame_count, joints.len(), columns) {
        let at = cursor.position(frames_word.start);
        return Err(BvhError::TooManyRotations { at, joints: joints.len(), frames: frame_count });
    }
    let is_angle = |column: usize| matches!(channels[column], Channel::Rotation(_));
    let mended = fill_gaps(&mut values, channels.len(), &gaps, is_angle)
        .map_err(|gap| BvhError::LongGap { at: cursor.position(gap.start), limit: LONGEST_GAP })?;
    Ok(RawBvh {
        joints,
        frame_time,
        frame_time_rounding: half_unit_of_last_digit(time_word.bytes),
        values,
        frame_count,
        mended,
    })
}

/// Joints from HIERARCHY to MOTION, both words read; no recursion, so nesting may be deep.
fn hierarchy(cursor: &mut Cursor<'_>) -> Result<Vec<RawJoint>, BvhError> {
    match cursor.word() {
        Some(word) if word.is("HIERARCHY") => {}
        other => {
            return Err(BvhError::NotBvh {
                at: other.map_or_else(|| cursor.here(), |word| cursor.position(word.start)),
                found: other.map_or_else(|| "nothing".to_owned(), |word| format!("`{}`", quote(word.bytes))),
            });
        }
    }
    cursor.expect("ROOT", "ROOT")?;
    let mut joints = Vec::new();
    let mut open = vec![open_joint(cursor, &mut joints, None)?];
    while !open.is_empty() {
        joint_line(cursor, &mut joints, &mut open)?;
    }
    match cursor.peek() {
        Some(word) if word.is("ROOT") => Err(BvhError::SecondRoot { at: cursor.position(word.start) }),
        _ => {
            cursor.expect("MOTION", "MOTION")?;
            Ok(joints)
        }
    }
}

/// Name and opening brace of a joint, behind ROOT or JOINT.
fn open_joint(
    cursor: &mut Cursor<'_>,
    joints: &mut Vec<RawJoint>,
    parent: Option<usize>,
) -> Result<OpenJoint, BvhError> {
    let name = cursor.rest_of_line();
    let at = || cursor.position(name.start);
    if name.bytes.is_empty() {
        return Err(BvhError::NoName { at: at() });
    }
    if joints.len() == JOINT_LIMIT {
        return Err(BvhError::TooManyJoints { at: at(), limit: JOINT_LIMIT });
    }
    joints.push(RawJoint {
        name: String::from_utf8_lossy(name.bytes).into_owned(),
        parent,
        offset: [0.0; 3],
        end_sites: Vec::new(),
        channels: Vec::new(),
    });
    cursor.expect("{", "an opening brace")?;
    Ok(OpenJoint { index: joints.len() - 1, has_offset: false, has_channels: false })
}

/// One item inside the innermost open joint: OFFSET, CHANNELS, JOINT, End Site or its closing brace.
fn joint_line(
    cursor: &mut Cursor<'_>,
    joints: &mut Vec<RawJoint>,
    open: &mut Vec<OpenJoint>,
) -> Result<(), BvhError> {
    let current = open.last_mut().expect("called while a joint is open");
    let index = current.index;
    let Some(word) = cursor.word() else {
        return Err(BvhError::MissingBrace { at: cursor.here(), joint: joints[index].name.clone() });
    };
    let joint = &mut joints[index];
    if word.is("OFFSET") {
        once(cursor, word, &mut current.has_offset, &joint.name, "OFFSET")?;
        joint.offset = three_numbers(cursor)?;
    } else if word.is("CHANNELS") {
        once(cursor, word, &mut current.has_channels, &joint.name, "CHANNELS")?;
        joint.channels = channels(cursor, &joint.name)?;
    } else if word.is("JOINT") {
        open.push(open_joint(cursor, joints, Some(index))?);
    } else if word.is("End") {
        joint.end_sites.push(end_site(cursor)?);
    } else if word.is("}") {
        close(cursor, word, current, &joint.name)?;
        open.pop();
    } else if word.is("MOTION") {
        return Err(BvhError::MissingBrace { at: cursor.position(word.start), joint: joint.name.clone() });
    } else {
        return Err(cursor.unexpected(word, "OFFSET, CHANNELS, JOINT, End Site or a closing brace").into());
    }
    Ok(())
}

fn once(
    cursor: &Cursor<'_>,
    word: Word<'_>,
    seen: &mut bool,
    joint: &str,
    what: &'static str,
) -> Result<(), BvhError> {
    if std::mem::replace(seen, true) {
        return Err(BvhError::Repeated { at: cursor.position(word.start), joint: joint.to_owned(), what });
    }
    Ok(())
}

fn close(cursor: &Cursor<'_>, brace: Word<'_>, joint: &OpenJoint, name: &str) -> Result<(), BvhError> {
    if joint.has_offset {
        return Ok(());
    }
    Err(BvhError::NoOffset { at: cursor.position(brace.start), joint: name.to_owned() })
}

/// What follows the word End: a label, braces and an offset in them.
fn end_site(cursor: &mut Cursor<'_>) -> Result<[f64; 3], BvhError> {
    cursor.rest_of_line();
    cursor.expect("{", "an opening brace")?;
    cursor.expect("OFFSET", "OFFSET")?;
    let offset = three_numbers(cursor)?;
    cursor.expect("}", "a closing brace")?;
    Ok(offset)
}

/// What follows the word CHANNELS; names that follow are counted to the end, so that the message can name both numbers.
fn channels(cursor: &mut Cursor<'_>, joint: &str) -> Result<Vec<Channel>, BvhError> {
    let count_word = cursor.next("a number of channels")?;
    let announced = cursor.count(count_word, "channels")?;
    let mut found: Vec<Channel> = Vec::new();
    while let Some(word) = cursor.peek() {
        let Some(channel) = channel(word.bytes) else {
            if found.len() < announced && !is_structure(word) {
                return Err(BvhError::UnknownChannel {
                    at: cursor.position(word.start),
                    found: quote(word.bytes),
                });
            }
            break;
        };
        if found.contains(&channel) {
            return Err(BvhError::RepeatedChannel {
                at: cursor.position(word.start),
                joint: joint.to_owned(),
                channel: quote(word.bytes),
            });
        }
        found.push(channel);
        cursor.word();
    }
    if found.len() == announced {
        return Ok(found);
    }
    Err(BvhError::ChannelCount {
        at: cursor.position(count_word.start),
        joint: joint.to_owned(),
        announced,
        found: found.len(),
    })
}

fn is_structure(word: Word<'_>) -> bool {
    ["OFFSET", "JOINT", "End", "}", "{", "MOTION", "CHANNELS"].iter().any(|keyword| word.is(keyword))
}

fn channel(word: &[u8]) -> Option<Channel> {
    let axis = match word.first()?.to_ascii_lowercase() {
        b'x' => Axis::X,
        b'y' => Axis::Y,
        b'z' => Axis::Z,
        _ => return None,
    };
    let kind = &word[1..];
    if kind.eq_ignore_ascii_case(b"position") {
        Some(Channel::Position(axis))
    } else if kind.eq_ignore_ascii_case(b"rotation") {
        Some(Channel::Rotation(axis))
    } else {
        None
    }
}

/// `frame_count` lines of a number for each of `channels`, blank lines skipped.
///
/// With `gaps`, values that are no finite numbers go there and are NaN in the rows.
fn rows(
    cursor: &mut Cursor<'_>,
    frame_count: usize,
    channels: &[Channel],
    mut gaps: Option<&mut Vec<Gap>>,
) -> Result<Vec<f64>, BvhError> {
    let width = channels.len();
    // The count is only announced; what follows can hold one number in two bytes at most.
    let mut values = Vec::with_capacity((cursor.remaining() / 2).min(frame_count.saturating_mul(width)));
    for row in 0..frame_count {
        let Some(first) = cursor.peek() else {
            return Err(BvhError::RowsMissing { at: cursor.here(), announced: frame_count, found: row });
        };
        cursor.go_to(first.start);
        let found = row_values(cursor, row, &mut values, gaps.as_deref_mut())?;
        if found != width {
            return Err(BvhError::RowLength {
                at: cursor.position(first.start),
                row: row + 1,
                expected: width,
                found,
            });
        }
        let numbers = &values[row * width..];
        if let Some(&found) = numbers.iter().find(|found| found.abs() > FARTHEST) {
            return Err(BvhError::TooFar { at: cursor.position(first.start), found, most: FARTHEST });
        }
    }
    match cursor.word() {
        None => Ok(values),
        Some(word) => Err(BvhError::RowsLeft { at: cursor.position(word.start), announced: frame_count }),
    }
}

/// Appends the numbers of this line to `values`, and returns how many.
fn row_values(
    cursor: &mut Cursor<'_>,
    row: usize,
    values: &mut Vec<f64>,
    mut gaps: Option<&mut Vec<Gap>>,
) -> Result<usize, BvhError> {
    let mut found = 0;
    loop {
        if let Some(number) = cursor.short_decimal_in_line() {
            values.push(number);
        } else if let Some(word) = cursor.word_in_line() {
            values.push(number_or_gap(cursor, word, [row, found], gaps.as_deref_mut())?);
        } else {
            return Ok(found);
        }
        found += 1;
    }
}

fn number_or_gap(
    cursor: &Cursor<'_>,
    word: Word<'_>,
    [row, column]: [usize; 2],
    gaps: Option<&mut Vec<Gap>>,
) -> Result<f64, TextError> {
    match (cursor.number(word), gaps) {
        (Err(TextError::NotFinite { .. }), Some(gaps)) => {
            gaps.push(Gap { row, column, start: word.start });
            Ok(f64::NAN)
        }
        (number, _) => number,
    }
}

/// Half a unit of the last digit written, e.g. 5e-8 for `.0083333`.
fn half_unit_of_last_digit(number: &[u8]) -> f64 {
    let exponent_at = number.iter().position(|byte| byte.eq_ignore_ascii_case(&b'e'));
    let (mantissa, exponent) = number.split_at(exponent_at.unwrap_or(number.len()));
    let exponent: i32 =
        exponent.get(1..).and_then(|digits| std::str::from_utf8(digits).ok()?.parse().ok()).unwrap_or(0);
    let decimals =
        mantissa.iter().position(|&byte| byte == b'.').map_or(0, |point| mantissa.len() - point - 1);
    0.5 * 10_f64.powi(exponent.saturating_sub_unsigned(u32::try_from(decimals).unwrap_or(u32::MAX)))
}

fn three_numbers(cursor: &mut Cursor<'_>) -> Result<[f64; 3], BvhError> {
    let mut numbers = [0.0; 3];
    for number in &mut numbers {
        let word = cursor.next("a number")?;
        let found = cursor.number(word)?;
        if found.abs() > FARTHEST {
            return Err(BvhError::TooFar { at: cursor.position(word.start), found, most: FARTHEST });
        }
        *number = found;
    }
    Ok(numbers)
}

/// The word behind the words `keys`.
fn keyed_word<'a>(
    cursor: &mut Cursor<'a>,
    keys: &[&str],
    keys_quoted: &'static str,
    value: &'static str,
) -> Result<Word<'a>, BvhError> {
    for key in keys {
        let word = cursor.next(keys_quoted)?;
        let starts =
            word.bytes.get(..key.len()).is_some_and(|start| start.eq_ignore_ascii_case(key.as_bytes()));
        // `Frames:122` is written without a blank now and then.
        if !starts || (word.bytes.len() > key.len() && !key.ends_with(':')) {
            return Err(cursor.unexpected(word, keys_quoted).into());
        }
        cursor.go_to(word.start + key.len());
    }
    Ok(cursor.next(value)?)
}

fn end_line(cursor: &mut Cursor<'_>) -> Result<(), BvhError> {
    match cursor.word_in_line() {
        None => Ok(()),
        Some(word) => Err(cursor.unexpected(word, "the end of the line").into()),
    }
}
