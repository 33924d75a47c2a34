//! Words and lines of a byte buffer, with exact places for errors; shared by all readers of text files.

use std::fmt;

/// A place in a text file, both counted from 1; columns count characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub struct Position {
    pub line: usize,
    pub column: usize,
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

/// What can be wrong with any text file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "`at` is the place of the fault, the other fields stand in the message")]
pub enum TextError {
    /// Another word than the format asks for.
    #[error("{at}: expected {expected}, found {found}; correct this line or export the file again")]
    Unexpected { at: Position, expected: &'static str, found: String },
    /// The file ends too early.
    #[error(
        "{at}: the file ends where {expected} should follow; it seems cut short, copy or export it again"
    )]
    EndOfFile { at: Position, expected: &'static str },
    /// A word where a number belongs.
    #[error("{at}: `{found}` is not a number; decimals are written with a point")]
    NotANumber { at: Position, found: String },
    /// NaN, infinity or overflow.
    #[error(
        "{at}: `{found}` is not a finite number; `repair` fills in single ones, else mend the value or leave the frame out"
    )]
    NotFinite { at: Position, found: String },
    /// A count that is negative, a fraction or too large.
    #[error("{at}: `{found}` is not a count of {what}; write a whole number from 0 to 4294967295")]
    NotACount { at: Position, found: String, what: &'static str },
}

impl TextError {
    /// Where the fault is.
    pub fn position(&self) -> Position {
        match self {
            Self::Unexpected { at, .. }
            | Self::EndOfFile { at, .. }
            | Self::NotANumber { at, .. }
            | Self::NotFinite { at, .. }
            | Self::NotACount { at, .. } => *at,
        }
    }
}

/// 10⁰ to 10²², all exact.
const POWERS_OF_TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// Longest piece of a file that an error quotes, characters.
const QUOTE_LIMIT: usize = 40;

/// A word of the file and where it starts.
#[derive(Clone, Copy, Debug)]
pub(in crate::clip) struct Word<'a> {
    pub(in crate::clip) start: usize,
    pub(in crate::clip) bytes: &'a [u8],
}

impl Word<'_> {
    /// Whether the word is `keyword`, in any case.
    pub(in crate::clip) fn is(self, keyword: &str) -> bool {
        self.bytes.eq_ignore_ascii_case(keyword.as_bytes())
    }
}

/// Reads forward; remembers a byte position only, lines and columns are counted when an error needs them.
#[derive(Clone, Debug)]
pub(in crate::clip) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    /// At the start of `bytes`, behind a byte order mark.
    pub(in crate::clip) fn new(bytes: &'a [u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        Self { bytes, at: 0 }
    }

    /// Bytes not yet read.
    pub(in crate::clip) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Line and column of byte `start`; LF, CR LF and a lone CR end a line.
    pub(in crate::clip) fn position(&self, start: usize) -> Position {
        let before = &self.bytes[..start.min(self.bytes.len())];
        let mut line = 1;
        let mut line_start = 0;
        for (index, &byte) in before.iter().enumerate() {
            let ends = byte == b'\n' || (byte == b'\r' && self.bytes.get(index + 1) != Some(&b'\n'));
            if ends {
                line += 1;
                line_start = index + 1;
            }
        }
        let continuation = |byte: &&u8| **byte & 0xc0 == 0x80;
        let column = before.len() - line_start - before[line_start..].iter().filter(continuation).count() + 1;
        Position { line, column }
    }

    /// Where reading goes on.
    pub(in crate::clip) fn here(&self) -> Position {
        self.position(self.at)
    }

    /// Next word, line ends skipped as blanks; `None` at the end of the file.
    pub(in crate::clip) fn word(&mut self) -> Option<Word<'a>> {
        self.skip(|byte| byte.is_ascii_whitespace());
        self.take_word()
    }

    /// Next word of this line; `None` where the line has no more.
    pub(in crate::clip) fn word_in_line(&mut self) -> Option<Word<'a>> {
        self.skip(|byte| byte.is_ascii_whitespace() && !is_line_end(byte));
        self.take_word()
    }

    /// The same without moving.
    pub(in crate::clip) fn peek(&self) -> Option<Word<'a>> {
        self.clone().word()
    }

    /// Goes on reading at byte `start`, which a word had.
    pub(in crate::clip) fn go_to(&mut self, start: usize) {
        self.at = start;
    }

    /// Rest of this line without blanks around it and without a brace at its end, which is left to be read.
    pub(in crate::clip) fn rest_of_line(&mut self) -> Word<'a> {
        self.skip(|byte| byte.is_ascii_whitespace() && !is_line_end(byte));
        let start = self.at;
        self.skip(|byte| !is_line_end(byte));
        let mut bytes = self.bytes[start..self.at].trim_ascii_end();
        if let Some(before) = bytes.strip_suffix(b"{") {
            self.at = start + before.len();
            bytes = before.trim_ascii_end();
        }
        Word { start, bytes }
    }

    /// Next word, whatever it is, where the format asks for `expected`.
    pub(in crate::clip) fn next(&mut self, expected: &'static str) -> Result<Word<'a>, TextError> {
        self.word().ok_or_else(|| TextError::EndOfFile { at: self.here(), expected })
    }

    /// Reads the word `keyword`, in any case.
    pub(in crate::clip) fn expect(&mut self, keyword: &str, expected: &'static str) -> Result<(), TextError> {
        let word = self.next(expected)?;
        if word.is(keyword) { Ok(()) } else { Err(self.unexpected(word, expected)) }
    }

    /// The error of finding `word` where the format asks for `expected`.
    pub(in crate::clip) fn unexpected(&self, word: Word<'_>, expected: &'static str) -> TextError {
        TextError::Unexpected {
            at: self.position(word.start),
            expected,
            found: format!("`{}`", quote(word.bytes)),
        }
    }

    fn skip(&mut self, wanted: impl Fn(u8) -> bool) {
        while self.at < self.bytes.len() && wanted(self.bytes[self.at]) {
            self.at += 1;
        }
    }

    fn take_word(&mut self) -> Option<Word<'a>> {
        let start = self.at;
        self.skip(|byte| !byte.is_ascii_whitespace());
        (self.at > start).then(|| Word { start, bytes: &self.bytes[start..self.at] })
    }

    /// The number that is next in this line if it is a short decimal, else nothing, without moving: what takes more care
    /// is left to [`Cursor::word_in_line`] and [`Cursor::number`]. The same value as theirs, several times faster.
    ///
    /// Up to 15 digits and a power of ten up to 10²² are exact, so that their product or quotient is the nearest number.
    /// Source: Clinger, *How to Read Floating Point Numbers Accurately*, PLDI 1990, §4.
    pub(in crate::clip) fn short_decimal_in_line(&mut self) -> Option<f64> {
        const MOST_DIGITS: usize = 15;
        let mut rest = &self.bytes[self.at..];
        while let [b' ' | b'\t', after @ ..] = rest {
            rest = after;
        }
        let negative = rest.first() == Some(&b'-');
        rest = &rest[usize::from(negative)..];
        let (whole, mut rest, before_point) = digits(rest, 0);
        let (mut number, mut decimals) = (whole, 0);
        if let [b'.', after @ ..] = rest {
            (number, rest, decimals) = digits(after, whole);
        }
        // More digits overflow.
        if !(1..=MOST_DIGITS).contains(&(before_point + decimals)) {
            return None;
        }
        let (exponent, rest) = exponent(rest)?;
        if !rest.first().is_none_or(u8::is_ascii_whitespace) {
            return None;
        }
        // Signed numbers are converted faster.
        let number = i64::try_from(number).ok()? as f64;
        let value = scaled(number, exponent - i32::try_from(decimals).ok()?)?;
        self.at = self.bytes.len() - rest.len();
        Some(if negative { -value } else { value })
    }

    /// The finite number written as `word`.
    pub(in crate::clip) fn number(&self, word: Word<'a>) -> Result<f64, TextError> {
        let parsed = std::str::from_utf8(word.bytes).ok().and_then(|text| text.parse::<f64>().ok());
        match parsed {
            Some(value) if value.is_finite() => Ok(value),
            None if !is_c_nan(word.bytes) => {
                Err(TextError::NotANumber { at: self.position(word.start), found: quote(word.bytes) })
            }
            _ => Err(TextError::NotFinite { at: self.position(word.start), found: quote(word.bytes) }),
        }
    }

    /// The whole number written as `word`.
    pub(in crate::clip) fn count(&self, word: Word<'a>, what: &'static str) -> Result<usize, TextError> {
        std::str::from_utf8(word.bytes)
            .ok()
            .and_then(|text| text.parse::<u32>().ok())
            .map(|count| count as usize)
            .ok_or_else(|| TextError::NotACount {
                at: self.position(word.start),
                found: quote(word.bytes),
                what,
            })
    }
}

/// Whether `word` is how C libraries write what is no number: `-1.#IND`, `1.#QNAN0`, `-nan(ind)`.
fn is_c_nan(word: &[u8]) -> bool {
    let word = word.to_ascii_lowercase();
    let unsigned = word.strip_prefix(b"-").unwrap_or(&word);
    unsigned.starts_with(b"1.#") || unsigned.starts_with(b"nan(")
}

/// The digits that `text` starts with, appended to `number`; what follows them, and how many they are.
///
/// Eight bytes at a time, without a branch that depends on how many of them are digits.
/// Source: Lemire, *Number Parsing at a Gigabyte per Second*, Software: Practice and Experience 51 (2021), §4.
fn digits(text: &[u8], mut number: u64) -> (u64, &[u8], usize) {
    let mut rest = text;
    while let Some(chunk) = rest.first_chunk() {
        let (value, count) = eight_digits(u64::from_le_bytes(*chunk));
        number = number.wrapping_mul(WHOLE_POWERS_OF_TEN[count]).wrapping_add(value);
        rest = &rest[count..];
        if count < 8 {
            return (number, rest, text.len() - rest.len());
        }
    }
    while let [digit @ b'0'..=b'9', after @ ..] = rest {
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
        rest = after;
    }
    (number, rest, text.len() - rest.len())
}

/// 10⁰ to 10⁸.
const WHOLE_POWERS_OF_TEN: [u64; 9] =
    [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// Value and number of the digits that eight characters start with, the first in the lowest byte.
fn eight_digits(chunk: u64) -> (u64, usize) {
    const EACH: u64 = 0x0101_0101_0101_0101;
    let from_zero = chunk.wrapping_sub(u64::from(b'0') * EACH);
    // The top bit of a byte below '0' or above '9'; a borrow or carry reaches only bytes behind the first of them.
    let others = (from_zero | chunk.wrapping_add((0x80 - u64::from(b'9') - 1) * EACH)) & (0x80 * EACH);
    let bits = others.trailing_zeros() & !7;
    // Zeros in front of the digits, nothing behind them.
    let aligned = if bits == 0 { 0 } else { from_zero << (64 - bits) };
    let pairs = aligned.wrapping_mul(10).wrapping_add(aligned >> 8) & 0x00ff_00ff_00ff_00ff;
    let fours = pairs.wrapping_mul(100).wrapping_add(pairs >> 16) & 0x0000_ffff_0000_ffff;
    let eight = fours.wrapping_mul(10_000).wrapping_add(fours >> 32) & 0xffff_ffff;
    (eight, (bits / 8) as usize)
}

/// The exponent that `text` starts with, 0 where none is, and what follows; `None` for one of more than four digits.
fn exponent(text: &[u8]) -> Option<(i32, &[u8])> {
    let [b'e' | b'E', text @ ..] = text else {
        return Some((0, text));
    };
    let negative = text.first() == Some(&b'-');
    let signed = usize::from(matches!(text.first(), Some(b'-' | b'+')));
    let (number, rest, length) = digits(&text[signed..], 0);
    if !(1..=4).contains(&length) {
        return None;
    }
    let exponent = i32::try_from(number).ok()?;
    Some((if negative { -exponent } else { exponent }, rest))
}

/// `digits`·10^`exponent` where one operation on exact numbers gives it.
fn scaled(digits: f64, exponent: i32) -> Option<f64> {
    let power = *POWERS_OF_TEN.get(exponent.unsigned_abs() as usize)?;
    Some(if exponent < 0 { digits / power } else { digits * power })
}

fn is_line_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}

/// A piece of the file as an error shows it: printable, not long.
pub(in crate::clip) fn quote(bytes: &[u8]) -> String {
    let shown = &bytes[..bytes.len().min(4 * QUOTE_LIMIT)];
    let text: String =
        String::from_utf8_lossy(shown).chars().flat_map(char::escape_debug).take(QUOTE_LIMIT).collect();
    let cut = shown.len() < bytes.len() || text.chars().count() == QUOTE_LIMIT;
    if cut { text + "…" } else { text }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// What the careful way makes of the first word of `text`.
    fn careful(text: &str) -> Option<f64> {
        let mut cursor = Cursor::new(text.as_bytes());
        let word = cursor.word_in_line()?;
        cursor.number(word).ok()
    }

    proptest! {
        /// Digits, signs, points, exponents and stray letters in any order: the quick way is the careful one, or none.
        #[test]
        fn short_decimals_are_read_as_the_careful_way_reads_them(text in "[ \t]{0,2}[-+]{0,2}[0-9]{0,12}[.]{0,2}[0-9]{0,12}([eE][-+]?)?[0-9x]{0,3} ?") {
            let mut cursor = Cursor::new(text.as_bytes());
            if let Some(quick) = cursor.short_decimal_in_line() {
                prop_assert_eq!(Some(quick.to_bits()), careful(&text).map(f64::to_bits));
                prop_assert!(cursor.word_in_line().is_none());
            }
        }

        #[test]
        fn what_is_written_with_ten_decimals_is_read_the_quick_way(value in -9999.0..9999.0_f64) {
            let text = format!("{value:.10}");
            let quick = Cursor::new(text.as_bytes()).short_decimal_in_line();
            prop_assert_eq!(quick, careful(&text));
            prop_assert!(quick.is_some());
        }
    }

    #[test]
    fn what_takes_care_is_left_alone() {
        for text in
            ["1e25", "1e", "1e-", "1e00001", "nan", "-", ".", "1.2.3", "+1", "1234567890123456", "1x", ""]
        {
            let mut cursor = Cursor::new(text.as_bytes());
            assert_eq!(cursor.short_decimal_in_line(), None, "{text}");
            assert_eq!(cursor.remaining(), text.len());
        }
    }
}
