//! Words and lines of a byte buffer, with exact places for errors.

use super::error::{BvhError, Position};

/// Longest piece of a file that an error quotes, characters.
const QUOTE_LIMIT: usize = 40;

/// A word of the file and where it starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word<'a> {
    pub(super) start: usize,
    pub(super) bytes: &'a [u8],
}

/// Reads forward; remembers a byte position only, lines and columns are counted when an error needs them.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    /// At the start of `bytes`, behind a byte order mark.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        Self { bytes, at: 0 }
    }

    /// Bytes not yet read.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Line and column of byte `start`; LF, CR LF and a lone CR end a line.
    pub(super) fn position(&self, start: usize) -> Position {
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
    pub(super) fn here(&self) -> Position {
        self.position(self.at)
    }

    /// Next word, line ends skipped as blanks; `None` at the end of the file.
    pub(super) fn word(&mut self) -> Option<Word<'a>> {
        self.skip(|byte| byte.is_ascii_whitespace());
        self.take_word()
    }

    /// Next word of this line; `None` where the line has no more.
    pub(super) fn word_in_line(&mut self) -> Option<Word<'a>> {
        self.skip(|byte| byte.is_ascii_whitespace() && !is_line_end(byte));
        self.take_word()
    }

    /// The same without moving.
    pub(super) fn peek(&self) -> Option<Word<'a>> {
        self.clone().word()
    }

    /// Rest of this line without blanks around it and without a brace at its end, which is left to be read.
    pub(super) fn rest_of_line(&mut self) -> Word<'a> {
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

    /// The finite number written as `word`.
    pub(super) fn number(&self, word: Word<'a>) -> Result<f64, BvhError> {
        let parsed = std::str::from_utf8(word.bytes).ok().and_then(|text| text.parse::<f64>().ok());
        match parsed {
            Some(value) if value.is_finite() => Ok(value),
            Some(_) => Err(BvhError::NotFinite { at: self.position(word.start), found: quote(word.bytes) }),
            None => Err(BvhError::NotANumber { at: self.position(word.start), found: quote(word.bytes) }),
        }
    }

    /// The whole number written as `word`.
    pub(super) fn count(&self, word: Word<'a>, what: &'static str) -> Result<usize, BvhError> {
        std::str::from_utf8(word.bytes)
            .ok()
            .and_then(|text| text.parse::<u32>().ok())
            .map(|count| count as usize)
            .ok_or_else(|| BvhError::NotACount {
                at: self.position(word.start),
                found: quote(word.bytes),
                what,
            })
    }
}

fn is_line_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}

/// A piece of the file as an error shows it: printable, not long.
pub(super) fn quote(bytes: &[u8]) -> String {
    let shown = &bytes[..bytes.len().min(4 * QUOTE_LIMIT)];
    let text: String =
        String::from_utf8_lossy(shown).chars().flat_map(char::escape_debug).take(QUOTE_LIMIT).collect();
    let cut = shown.len() < bytes.len() || text.chars().count() == QUOTE_LIMIT;
    if cut { text + "…" } else { text }
}
