//! Words of a line: a letter and its number, with their place in the text.
//!
//! [`Lexer`] walks a line once and yields words or what is wrong at a place. It knows spaces, comments, letters and
//! numbers, but no meaning. Columns count characters: bytes, less the continuation bytes of UTF-8, so that the column
//! agrees with an editor's even behind a comment with accents.

use core::fmt::{self, Write as _};

use super::decimal::{Number, NumberError};
use super::diagnostic::DiagnosticKind;

/// Letter and number, e.g. `X-12.5`.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// Upper case, A to Z.
    pub letter: char,
    /// As written.
    pub number: Number,
}

impl fmt::Display for Word {
    /// As written, but in upper case and without spaces.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_char(self.letter)?;
        self.number.fmt(f)
    }
}

/// Place in a line.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    /// First character, from 1.
    pub(crate) column: u32,
    /// Characters.
    pub(crate) length: u32,
}

/// Word with its place.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct Placed {
    pub(crate) word: Word,
    pub(crate) span: Span,
}

/// What is wrong, and where.
pub(crate) type Flaw = (Span, DiagnosticKind);

/// Characters in a text: its bytes without the continuation bytes of UTF-8.
pub(crate) fn characters(text: &[u8]) -> u32 {
    let first = text.iter().filter(|&&byte| byte & 0xc0 != 0x80);
    // not `count`: for all the compiler knows, it overflows
    first.fold(0, |count, _| count.saturating_add(1))
}

/// Whether a byte may stand outside comments.
const fn is_text(byte: u8) -> bool {
    matches!(byte, b'\t' | b' '..=b'~')
}

/// Walks the words of a line.
#[derive(Clone, Debug)]
pub(crate) struct Lexer<'a> {
    rest: &'a [u8],
    column: u32,
    byte_reported: bool,
}

impl<'a> Lexer<'a> {
    /// Starts at column 1.
    pub(crate) const fn new(line: &'a [u8]) -> Self {
        Self { rest: line, column: 1, byte_reported: false }
    }

    /// Consumes `count` bytes and returns how many characters they were.
    fn advance(&mut self, count: usize) -> u32 {
        let (head, tail) = self.rest.split_at_checked(count).unwrap_or((self.rest, &[]));
        self.rest = tail;
        let length = characters(head);
        self.column = self.column.saturating_add(length);
        length
    }

    /// Consumes bytes while `accept` holds.
    fn advance_while(&mut self, accept: impl Fn(u8) -> bool) -> (&'a [u8], u32) {
        let accepted = self.rest.iter().take_while(|&&byte| accept(byte));
        let count = accepted.fold(0_usize, |count, _| count.saturating_add(1));
        let head = self.rest.split_at_checked(count).map_or(self.rest, |(head, _)| head);
        (head, self.advance(count))
    }

    fn skip_spaces(&mut self) {
        self.advance_while(|byte| matches!(byte, b' ' | b'\t'));
    }

    /// Consumes `byte` if it comes next, spaces aside.
    pub(crate) fn accept(&mut self, byte: u8) -> bool {
        self.skip_spaces();
        let found = self.rest.first() == Some(&byte);
        if found {
            self.advance(1);
        }
        found
    }

    /// Sign, digits, point, and whatever else stands there up to a letter, a space, a comment or a refused byte.
    fn number_text(&mut self) -> (&'a [u8], u32) {
        self.advance_while(|byte| {
            is_text(byte) && !byte.is_ascii_alphabetic() && !matches!(byte, b' ' | b'\t' | b'(' | b';')
        })
    }

    /// A word, whose letter comes next.
    fn word(&mut self, letter: char) -> Result<Placed, Flaw> {
        let column = self.column;
        let mut length = self.advance(1);
        let before = self.clone();
        self.skip_spaces();
        let (text, _) = self.number_text();
        if text.is_empty() {
            *self = before; // the spaces are not of the word
        } else {
            length = self.column.saturating_sub(column);
        }
        let span = Span { column, length };
        match Number::parse(text) {
            Ok(number) => Ok(Placed { word: Word { letter, number }, span }),
            Err(NumberError::Missing) => Err((span, DiagnosticKind::NumberMissing(letter))),
            Err(NumberError::Malformed) => Err((span, DiagnosticKind::NumberMalformed(letter))),
            Err(NumberError::TooLong) => Err((span, DiagnosticKind::NumberTooLong(letter))),
        }
    }

    /// A comment in parentheses, whose opening comes next. `Some` when it is not closed.
    fn comment(&mut self) -> Option<Flaw> {
        let column = self.column;
        let (_, length) = self.advance_while(|byte| byte != b')');
        if self.rest.is_empty() {
            return Some((Span { column, length }, DiagnosticKind::CommentOpen));
        }
        self.advance(1);
        None
    }
}

impl Iterator for Lexer<'_> {
    type Item = Result<Placed, Flaw>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            self.skip_spaces();
            let column = self.column;
            match *self.rest.first()? {
                b';' => self.rest = &[],
                b'(' => {
                    if let Some(flaw) = self.comment() {
                        return Some(Err(flaw));
                    }
                }
                letter if letter.is_ascii_alphabetic() => {
                    return Some(self.word(char::from(letter.to_ascii_uppercase())));
                }
                b'0'..=b'9' | b'+' | b'-' | b'.' => {
                    let (_, length) = self.number_text();
                    return Some(Err((Span { column, length }, DiagnosticKind::NumberAlone)));
                }
                byte if is_text(byte) => {
                    let length = self.advance(1);
                    return Some(Err((Span { column, length }, DiagnosticKind::Character(char::from(byte)))));
                }
                byte => {
                    self.advance_while(|byte| !is_text(byte));
                    let length = self.column.saturating_sub(column).max(1);
                    if !core::mem::replace(&mut self.byte_reported, true) {
                        return Some(Err((Span { column, length }, DiagnosticKind::Byte(byte))));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;
    use std::vec::Vec;

    fn spans(line: &str) -> Vec<(u32, u32)> {
        Lexer::new(line.as_bytes())
            .map(|token| token.map_or_else(|(span, _)| span, |placed| placed.span))
            .map(|span| (span.column, span.length))
            .collect()
    }

    #[test]
    fn spaces_stand_between_and_inside_words_but_not_inside_numbers() {
        let words: Vec<_> = Lexer::new(b"g01x 10\tZ-5").map(|token| token.unwrap().word.to_string()).collect();
        assert_eq!(words, ["G01", "X10", "Z-5"]);
        let tokens: Vec<_> = Lexer::new(b"X1 0").collect();
        assert_eq!(tokens[1], Err((Span { column: 4, length: 1 }, DiagnosticKind::NumberAlone)));
    }

    #[test]
    fn columns_count_characters() {
        assert_eq!(spans("(größe) X1 Y22 "), [(9, 2), (12, 3)]);
        assert_eq!(spans("  X   7"), [(3, 5)]);
    }

    #[test]
    fn comments_are_skipped() {
        assert_eq!(spans("(a)X1(b ( c)Y2;Z3"), [(4, 2), (13, 2)]);
        let tokens: Vec<_> = Lexer::new(b"X1 (open").collect();
        assert_eq!(tokens[1], Err((Span { column: 4, length: 5 }, DiagnosticKind::CommentOpen)));
    }

    #[test]
    fn a_refused_byte_is_told_once_a_line() {
        let flaws: Vec<_> = Lexer::new("X1 é Y2 \u{7}Z3 é".as_bytes()).filter_map(Result::err).collect();
        assert_eq!(flaws, [(Span { column: 4, length: 1 }, DiagnosticKind::Byte(0xc3))]);
    }

    #[test]
    fn a_flaw_covers_the_whole_number() {
        assert_eq!(spans("X1.2.3 Z#5 W[1+2] K"), [(1, 6), (8, 3), (12, 6), (19, 1)]);
    }
}
