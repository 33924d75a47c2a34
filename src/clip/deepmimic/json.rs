//! Reads forward through JSON text; remembers a byte position only.

use crate::clip::text::{Cursor, Position, TextError, Word};

/// A place in JSON text. No value is built, and nesting costs no stack.
#[derive(Clone, Debug)]
pub(super) struct Json<'a> {
    /// Tells positions and reads numbers; never moves.
    text: Cursor<'a>,
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Json<'a> {
    /// At the start of `bytes`, behind a byte order mark.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        Self { text: Cursor::new(bytes), bytes, at: 0 }
    }

    /// At byte `start` of the same text.
    pub(super) fn moved_to(&self, start: usize) -> Self {
        Self { at: start, ..self.clone() }
    }

    /// Bytes not yet read.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Line and column of byte `start`.
    pub(super) fn position(&self, start: usize) -> Position {
        self.text.position(start)
    }

    /// First byte of what follows, blanks skipped, and where it is; `None` at the end of the file.
    pub(super) fn peek(&mut self) -> Option<(usize, u8)> {
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        self.bytes.get(self.at).map(|&byte| (self.at, byte))
    }

    /// Reads the mark `wanted` if it follows.
    pub(super) fn takes(&mut self, wanted: u8) -> bool {
        let follows = self.peek().is_some_and(|(_, byte)| byte == wanted);
        self.at += usize::from(follows);
        follows
    }

    /// Reads the mark `wanted`; returns where it is.
    pub(super) fn expect(&mut self, wanted: u8, expected: &'static str) -> Result<usize, TextError> {
        if self.takes(wanted) { Ok(self.at - 1) } else { Err(self.unexpected(expected)) }
    }

    /// What stands between quotation marks, escapes as they are; starts at the first mark.
    pub(super) fn string(&mut self, expected: &'static str) -> Result<Word<'a>, TextError> {
        let start = self.expect(b'"', expected)?;
        loop {
            match self.bytes.get(self.at) {
                None => {
                    let at = self.position(self.at);
                    return Err(TextError::EndOfFile { at, expected: "a closing quotation mark" });
                }
                Some(b'"') => break,
                // Whatever is escaped does not close the string.
                Some(b'\\') => self.at = (self.at + 2).min(self.bytes.len()),
                Some(_) => self.at += 1,
            }
        }
        self.at += 1;
        Ok(Word { start, bytes: &self.bytes[start + 1..self.at - 1] })
    }

    /// The key of a member and the colon behind it.
    pub(super) fn key(&mut self) -> Result<Word<'a>, TextError> {
        let key = self.string("a key in quotation marks")?;
        self.expect(b':', "a colon")?;
        Ok(key)
    }

    /// A number, or a word in its place: all up to the next blank or mark.
    pub(super) fn scalar(&mut self, expected: &'static str) -> Result<Word<'a>, TextError> {
        let word = self.ahead();
        if word.bytes.is_empty() || is_mark(word.bytes[0]) {
            return Err(self.unexpected(expected));
        }
        self.at = word.start + word.bytes.len();
        Ok(word)
    }

    /// The finite number written as `word`.
    pub(super) fn number(&self, word: Word<'a>) -> Result<f64, TextError> {
        self.text.number(word)
    }

    /// Skips any value. Memory: a byte for each bracket that is open.
    pub(super) fn skip_value(&mut self) -> Result<(), TextError> {
        let mut open: Vec<u8> = Vec::new();
        loop {
            match self.peek() {
                Some((_, mark @ (b'[' | b'{'))) => {
                    self.at += 1;
                    open.push(mark);
                    if !self.takes(closing(mark)) {
                        if mark == b'{' {
                            self.key()?;
                        }
                        continue;
                    }
                    open.pop();
                }
                Some((_, b'"')) => {
                    self.string("a value")?;
                }
                _ => self.skip_scalar()?,
            }
            if self.leave(&mut open)? {
                return Ok(());
            }
        }
    }

    /// Goes on behind a value: closes brackets up to a comma. Whether all are closed.
    fn leave(&mut self, open: &mut Vec<u8>) -> Result<bool, TextError> {
        while let Some(&mark) = open.last() {
            if self.takes(b',') {
                if mark == b'{' {
                    self.key()?;
                }
                return Ok(false);
            }
            self.expect(closing(mark), "a comma or a closing bracket")?;
            open.pop();
        }
        Ok(true)
    }

    fn skip_scalar(&mut self) -> Result<(), TextError> {
        let word = self.scalar("a value")?;
        match word.bytes {
            b"true" | b"false" | b"null" => Ok(()),
            _ => self.number(word).map(drop),
        }
    }

    /// The error of finding what follows where the format asks for `expected`.
    pub(super) fn unexpected(&mut self, expected: &'static str) -> TextError {
        let word = self.ahead();
        if word.bytes.is_empty() {
            return TextError::EndOfFile { at: self.position(word.start), expected };
        }
        self.text.unexpected(word, expected)
    }

    /// The error of finding the string `word` where the format asks for `expected`.
    pub(super) fn unexpected_string(&self, word: Word<'_>, expected: &'static str) -> TextError {
        self.text.unexpected(word, expected)
    }

    /// What follows, not read: a mark, or all up to the next blank or mark; empty at the end of the file.
    fn ahead(&mut self) -> Word<'a> {
        let Some((start, first)) = self.peek() else {
            return Word { start: self.bytes.len(), bytes: &[] };
        };
        let rest = &self.bytes[start..];
        let ends = |byte: &u8| is_mark(*byte) || byte.is_ascii_whitespace();
        let length = if is_mark(first) { 1 } else { rest.iter().position(ends).unwrap_or(rest.len()) };
        Word { start, bytes: &rest[..length] }
    }
}

fn is_mark(byte: u8) -> bool {
    matches!(byte, b'[' | b']' | b'{' | b'}' | b',' | b':' | b'"')
}

fn closing(mark: u8) -> u8 {
    if mark == b'[' { b']' } else { b'}' }
}
