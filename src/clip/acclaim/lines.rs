//! Words of Acclaim files: like those of any text, but `#` starts a comment and parentheses stand by themselves.

use crate::clip::text::{Cursor, Position, TextError, Word};

/// Reads forward, comments left out.
#[derive(Clone, Debug)]
pub(super) struct Lines<'a> {
    cursor: Cursor<'a>,
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { cursor: Cursor::new(bytes) }
    }

    /// Next word on this line or a later one; `None` at the end of the file.
    pub(super) fn word(&mut self) -> Option<Word<'a>> {
        loop {
            let word = self.cursor.word()?;
            if !is_comment(word) {
                return Some(word);
            }
            self.skip_line();
        }
    }

    /// Next word of this line; `None` where the line has no more.
    pub(super) fn word_in_line(&mut self) -> Option<Word<'a>> {
        let word = self.cursor.word_in_line()?;
        if is_comment(word) {
            self.skip_line();
            return None;
        }
        Some(word)
    }

    /// The word that [`Self::word`] will read.
    pub(super) fn peek(&self) -> Option<Word<'a>> {
        self.clone().word()
    }

    /// Next word, whatever it is, where the format asks for `expected`.
    pub(super) fn next(&mut self, expected: &'static str) -> Result<Word<'a>, TextError> {
        self.word().ok_or_else(|| TextError::EndOfFile { at: self.here(), expected })
    }

    /// Reads the word `keyword`, in any case.
    pub(super) fn expect(&mut self, keyword: &str, expected: &'static str) -> Result<(), TextError> {
        let word = self.next(expected)?;
        if word.is(keyword) { Ok(()) } else { Err(self.unexpected(word, expected)) }
    }

    pub(super) fn end_line(&mut self) -> Result<(), TextError> {
        match self.word_in_line() {
            None => Ok(()),
            Some(word) => Err(self.unexpected(word, "the end of the line")),
        }
    }

    pub(super) fn skip_line(&mut self) {
        while self.cursor.word_in_line().is_some() {}
    }

    /// Skips lines to the next one that starts a section, which is left to be read.
    pub(super) fn skip_section(&mut self) {
        self.skip_line();
        while self.cursor.peek().is_some_and(|word| !is_section(word)) {
            self.cursor.word();
            self.skip_line();
        }
    }

    /// The next word of a section's body: not one that starts another section, which is left to be read.
    pub(super) fn word_in_section(&mut self) -> Option<Word<'a>> {
        let mut ahead = self.clone();
        let word = ahead.word()?;
        if is_section(word) {
            return None;
        }
        *self = ahead;
        Some(word)
    }

    pub(super) fn number(&self, word: Word<'a>) -> Result<f64, TextError> {
        self.cursor.number(word)
    }

    pub(super) fn next_number(&mut self) -> Result<f64, TextError> {
        let word = self.next("a number")?;
        self.cursor.number(word)
    }

    pub(super) fn count(&self, word: Word<'a>, what: &'static str) -> Result<usize, TextError> {
        self.cursor.count(word, what)
    }

    pub(super) fn remaining(&self) -> usize {
        self.cursor.remaining()
    }

    pub(super) fn position(&self, word: Word<'_>) -> Position {
        self.cursor.position(word.start)
    }

    pub(super) fn position_of_byte(&self, start: usize) -> Position {
        self.cursor.position(start)
    }

    pub(super) fn here(&self) -> Position {
        self.cursor.here()
    }

    pub(super) fn unexpected(&self, word: Word<'_>, expected: &'static str) -> TextError {
        self.cursor.unexpected(word, expected)
    }
}

fn is_comment(word: Word<'_>) -> bool {
    word.bytes.first() == Some(&b'#')
}

fn is_section(word: Word<'_>) -> bool {
    word.bytes.first() == Some(&b':')
}

/// Splits words at parentheses, which are pieces of their own.
#[derive(Debug)]
pub(super) struct Pieces<'l, 'a> {
    lines: &'l mut Lines<'a>,
    rest: Word<'a>,
}

impl<'l, 'a> Pieces<'l, 'a> {
    pub(super) fn new(lines: &'l mut Lines<'a>) -> Self {
        Self { lines, rest: Word { start: 0, bytes: &[] } }
    }

    /// Next piece, where the format asks for `expected`.
    pub(super) fn next(&mut self, expected: &'static str) -> Result<Word<'a>, TextError> {
        if self.rest.bytes.is_empty() {
            self.rest = self.lines.next(expected)?;
        }
        let is_parenthesis = |byte: &u8| matches!(byte, b'(' | b')');
        let until = self.rest.bytes.iter().position(is_parenthesis).unwrap_or(self.rest.bytes.len()).max(1);
        let (piece, rest) = self.rest.bytes.split_at(until);
        let start = self.rest.start;
        self.rest = Word { start: start + until, bytes: rest };
        Ok(Word { start, bytes: piece })
    }

    pub(super) fn expect(&mut self, mark: &str, expected: &'static str) -> Result<Word<'a>, TextError> {
        let piece = self.next(expected)?;
        if piece.is(mark) { Ok(piece) } else { Err(self.lines.unexpected(piece, expected)) }
    }

    /// Whether the next piece opens a parenthesis; with anything else in the middle of a word the answer is yes, so that
    /// reading on finds the fault.
    pub(super) fn opens(&self) -> bool {
        let next = if self.rest.bytes.is_empty() { self.lines.peek() } else { Some(self.rest) };
        !self.rest.bytes.is_empty() || next.is_some_and(|word| word.bytes.first() == Some(&b'('))
    }

    pub(super) fn lines(&self) -> &Lines<'a> {
        self.lines
    }
}
