//! Words, lines and bytes of a text file with binary parts, with their places.

use super::error::{Fault, Place, quoted};

/// Reads a file from front to back.
pub(super) struct Lexer<'a> {
    bytes: &'a [u8],
    position: usize,
    /// Whether arrays are big-endian bytes instead of words.
    pub binary: bool,
    /// Major version of the format.
    pub major: u32,
    /// The character that makes the rest of its line a comment.
    comment: Option<u8>,
}

impl<'a> Lexer<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0, binary: false, major: 0, comment: None }
    }

    /// As [`Lexer::new`], for a format in which `comment` makes the rest of its line a comment.
    pub fn with_comments(bytes: &'a [u8], comment: u8) -> Self {
        Self { comment: Some(comment), ..Self::new(bytes) }
    }

    /// The current place: lines say more in text, bytes where binary data lies between.
    pub fn place(&self) -> Place {
        if self.binary {
            return Place::Byte(self.position);
        }
        Place::Line(self.bytes[..self.position].iter().filter(|&&byte| byte == b'\n').count() + 1)
    }

    pub fn fault(&self, found: impl Into<String>, expected: impl Into<String>) -> Fault {
        Fault::new(self.place(), found, expected)
    }

    /// Bytes that are left.
    pub fn remaining(&self) -> usize {
        self.bytes.len() - self.position
    }

    /// The rest of the current line, without its end.
    pub fn line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.position..];
        let length = rest.iter().position(|&byte| byte == b'\n');
        self.position += length.map_or(rest.len(), |length| length + 1);
        let line = &rest[..length.unwrap_or(rest.len())];
        line.strip_suffix(b"\r").unwrap_or(line)
    }

    /// Whether nothing is left.
    pub fn is_at_end(&self) -> bool {
        self.remaining() == 0
    }

    fn skip_blanks(&mut self) {
        while let Some(&byte) = self.bytes.get(self.position) {
            if Some(byte) == self.comment {
                self.line();
            } else if byte.is_ascii_whitespace() {
                self.position += 1;
            } else {
                return;
            }
        }
    }

    /// The next word, or `None` at the end.
    pub fn word(&mut self) -> Option<&'a [u8]> {
        self.skip_blanks();
        let rest = &self.bytes[self.position..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.position += length;
        (length > 0).then(|| &rest[..length])
    }

    /// The next word, without going past it.
    pub fn peek(&mut self) -> Option<&'a [u8]> {
        let position = self.position;
        let word = self.word();
        self.position = position;
        word
    }

    /// The next word as text.
    pub fn text(&mut self, expected: &str) -> Result<&'a str, Fault> {
        self.skip_blanks();
        let start = self.position;
        match self.word().map(|word| (word, std::str::from_utf8(word))) {
            Some((_, Ok(text))) => Ok(text),
            Some((word, Err(_))) => {
                self.position = start;
                Err(self.fault(quoted(&String::from_utf8_lossy(word)), expected))
            }
            None => Err(self.fault("the end of the file", expected)),
        }
    }

    /// The next word as a number.
    pub fn number<T: std::str::FromStr>(&mut self, expected: &str) -> Result<T, Fault> {
        self.skip_blanks();
        let position = self.position;
        let text = self.text(expected)?;
        text.parse().map_err(|_| {
            self.position = position;
            self.fault(quoted(text), expected)
        })
    }

    /// The next word as a name, with its percent codes decoded.
    pub fn name(&mut self) -> Result<String, Fault> {
        self.text("a name").map(decoded)
    }

    /// The given number of bytes.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        match self.bytes[self.position..].split_at_checked(count) {
            Some((taken, _)) => {
                self.position += count;
                Ok(taken)
            }
            None => Err(self.fault(format!("{} bytes before the end", self.remaining()), format!("{count}"))),
        }
    }

    /// Whether the next word is `keyword`, in any case; if so, goes past it.
    pub fn accepts(&mut self, keyword: &str) -> bool {
        let is_next = self.peek().is_some_and(|word| word.eq_ignore_ascii_case(keyword.as_bytes()));
        if is_next {
            self.word();
        }
        is_next
    }
}

/// A name without its percent codes, which stand for blanks and bytes outside ASCII.
pub(super) fn decoded(text: &str) -> String {
    String::from_utf8_lossy(&decoded_bytes(text.as_bytes())).into_owned()
}

/// As [`decoded`], for bytes.
pub(super) fn decoded_bytes(text: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some((&byte, tail)) = rest.split_first() {
        let code = tail.get(..2).filter(|_| byte == b'%');
        let value = code.and_then(|code| std::str::from_utf8(code).ok()).and_then(|code| u8::from_str_radix(code, 16).ok());
        bytes.push(value.unwrap_or(byte));
        rest = if value.is_some() { &tail[2..] } else { tail };
    }
    bytes
}

/// Text with percent codes for everything that would break a word.
pub(super) fn encoded(text: &[u8]) -> String {
    let mut words = String::with_capacity(text.len());
    for &byte in text {
        if byte <= b' ' || byte >= 0x7f || matches!(byte, b'"' | b'%') {
            words.push_str(&format!("%{byte:02X}"));
        } else {
            words.push(byte as char);
        }
    }
    words
}
