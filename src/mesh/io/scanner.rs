//! Text of mesh files: tokens and lines, numbers, and faults that name their line.

use crate::base::error::Error;
use std::path::Path;

/// Why a file cannot be read; becomes an [`Error`] once the path is known.
#[derive(Debug)]
pub enum Fault {
    /// The content is wrong.
    Content(String),
    /// Anything else, a limit for instance.
    Other(Error),
}

impl Fault {
    /// A fault of the content.
    pub fn new(message: impl Into<String>) -> Fault {
        Fault::Content(message.into())
    }

    /// The error with the path it concerns.
    pub fn into_error(self, path: &Path) -> Error {
        match self {
            Fault::Content(message) => Error::File { path: path.to_path_buf(), message },
            Fault::Other(error) => error,
        }
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Fault {
        Fault::Other(error)
    }
}

/// Reads text from left to right. Lines end with `\n`, `\r\n` or `\r`.
#[derive(Clone)]
pub struct Scanner<'a> {
    bytes: &'a [u8],
    position: usize,
    comment: Option<u8>,
}

impl<'a> Scanner<'a> {
    /// Starts after a byte order mark, if there is one.
    pub fn new(bytes: &'a [u8]) -> Scanner<'a> {
        let position = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Scanner { bytes, position, comment: None }
    }

    /// Skips from `mark` to the end of the line wherever a token could begin.
    pub fn with_comments(mut self, mark: u8) -> Scanner<'a> {
        self.comment = Some(mark);
        self
    }

    /// Bytes not yet read.
    pub fn remaining(&self) -> &'a [u8] {
        &self.bytes[self.position..]
    }

    /// Byte offset.
    pub fn position(&self) -> usize {
        self.position
    }

    /// Skips bytes.
    pub fn advance(&mut self, count: usize) {
        self.position = (self.position + count).min(self.bytes.len());
    }

    /// The next word, on this line or a later one.
    pub fn token(&mut self) -> Option<&'a [u8]> {
        loop {
            while self.peek().is_some_and(|byte| is_blank(byte) || is_line_end(byte)) {
                self.position += 1;
            }
            if self.comment.is_none() || self.peek() != self.comment {
                return self.word();
            }
            self.skip_line();
        }
    }

    /// The next word of this line.
    pub fn token_in_line(&mut self) -> Option<&'a [u8]> {
        while self.peek().is_some_and(is_blank) {
            self.position += 1;
        }
        if self.comment.is_some() && self.peek() == self.comment { None } else { self.word() }
    }

    /// Goes to the start of the next line; false at the end of the text.
    pub fn skip_line(&mut self) -> bool {
        self.line();
        self.position < self.bytes.len()
    }

    /// The rest of this line, without its end; the next read starts on the next line.
    pub fn line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.position..];
        let length = rest.iter().position(|&byte| is_line_end(byte)).unwrap_or(rest.len());
        self.position += length;
        match self.bytes[self.position..] {
            [b'\r', b'\n', ..] => self.position += 2,
            [_, ..] => self.position += 1,
            [] => {}
        }
        &rest[..length]
    }

    /// A fault at the current line.
    pub fn fault(&self, message: impl std::fmt::Display) -> Fault {
        Fault::Content(format!("line {}: {message}", self.line_number()))
    }

    /// The current line, from 1. O(bytes).
    pub fn line_number(&self) -> usize {
        let read = &self.bytes[..self.position];
        let count = |end: u8| read.iter().filter(|&&byte| byte == end).count();
        1 + if self.bytes.contains(&b'\n') { count(b'\n') } else { count(b'\r') }
    }

    /// The next word as a number, on this line or a later one.
    pub fn number(&mut self, what: impl std::fmt::Display) -> Result<f64, Fault> {
        match self.token() {
            None => {
                Err(self.fault(format_args!("the file ends within {what}; it is cut off, export it again")))
            }
            Some(word) => self.parse_number(word, what),
        }
    }

    /// A word as a number.
    pub fn parse_number(&self, word: &[u8], what: impl std::fmt::Display) -> Result<f64, Fault> {
        parse_float(word).ok_or_else(|| {
            self.fault(format_args!(
                "{what} has {} where a number should be; correct the line or export the file again",
                quote(word)
            ))
        })
    }

    /// The next word as a whole number that is not negative, on this line or a later one.
    pub fn count(&mut self, what: impl std::fmt::Display) -> Result<u64, Fault> {
        match self.token() {
            None => Err(self.fault(format_args!("the file ends within {what}; it is cut off, export it again"))),
            Some(word) => parse_integer(word).and_then(|value| u64::try_from(value).ok()).ok_or_else(|| {
                self.fault(format_args!(
                    "{what} has {} where a whole number from 0 should be; correct the line or export the file again",
                    quote(word)
                ))
            }),
        }
    }

    /// The next word as a vertex index, on this line or a later one.
    pub fn index(&mut self, what: impl std::fmt::Display) -> Result<u32, Fault> {
        let value = self.count(&what)?;
        u32::try_from(value).map_err(|_| {
            self.fault(format_args!(
                "{what} refers to vertex {value}, far more than a file can hold; export it again"
            ))
        })
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.position).copied()
    }

    fn word(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.position..];
        let length = rest.iter().position(|&byte| is_blank(byte) || is_line_end(byte)).unwrap_or(rest.len());
        self.position += length;
        (length > 0).then_some(&rest[..length])
    }
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0x0b | 0x0c)
}

fn is_line_end(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

/// A decimal number; the spellings of "not a number" that C libraries print are understood too.
pub fn parse_float(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| {
        let lower = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
        (lower.starts_with("nan") || lower.starts_with("1.#")).then_some(f64::NAN)
    })
}

/// A whole number, also when written like `3.0`.
pub fn parse_integer(word: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| {
        let value: f64 = text.parse().ok()?;
        (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
    })
}

/// A word for a message: quoted, shortened, printable.
pub fn quote(word: &[u8]) -> String {
    let text: String = String::from_utf8_lossy(&word[..word.len().min(40)]).escape_debug().collect();
    if word.len() > 40 { format!("\"{text}...\"") } else { format!("\"{text}\"") }
}
