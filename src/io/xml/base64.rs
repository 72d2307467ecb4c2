//! Base64 as VTK writes it: the header of an array may be padded apart from its data, so `=` can stand mid-stream.

use crate::io::error::{Fault, Place};

/// Marks a byte that is no base64 digit.
const NONE: u8 = 0xff;

const DIGITS: [u8; 256] = {
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut digits = [NONE; 256];
    let mut value = 0;
    while value < 64 {
        digits[alphabet[value] as usize] = value as u8;
        value += 1;
    }
    digits
};

/// Decodes as many bytes as are asked for, and no more.
pub(super) struct Decoder<'a> {
    text: &'a [u8],
    position: usize,
    /// Place of `text` in the file.
    start: usize,
    /// Decoded bytes that nobody asked for yet: `pending[..kept]`.
    pending: [u8; 3],
    kept: usize,
}

impl<'a> Decoder<'a> {
    pub fn new(text: &'a [u8], start: usize) -> Self {
        Self { text, position: 0, start, pending: [0; 3], kept: 0 }
    }

    /// Place of the next digit in the file.
    pub fn place(&self) -> Place {
        Place::Byte(self.start + self.position)
    }

    /// The most bytes that may still come.
    pub fn available(&self) -> usize {
        self.kept + (self.text.len() - self.position).div_ceil(4) * 3
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Result<Vec<u8>, Fault> {
        if count > self.available() {
            return Err(self.too_short(count, self.available()));
        }
        let mut bytes = Vec::with_capacity(count + 3);
        bytes.extend_from_slice(&self.pending[..self.kept.min(count)]);
        if count < self.kept {
            self.pending.copy_within(count..self.kept, 0);
            self.kept -= count;
            return Ok(bytes);
        }
        self.kept = 0;
        while bytes.len() < count {
            self.take_full_quanta(&mut bytes, count);
            if bytes.len() >= count {
                break;
            }
            let Some((quantum, length)) = self.quantum()? else {
                return Err(self.too_short(count, bytes.len()));
            };
            bytes.extend_from_slice(&quantum[..length]);
        }
        self.kept = bytes.len() - count;
        self.pending[..self.kept].copy_from_slice(&bytes[count..]);
        bytes.truncate(count);
        Ok(bytes)
    }

    /// The common case, without blanks and padding: four digits to three bytes.
    fn take_full_quanta(&mut self, bytes: &mut Vec<u8>, count: usize) {
        let quanta = (count - bytes.len()).div_ceil(3);
        for four in self.text[self.position..].chunks_exact(4).take(quanta) {
            let digits = [0, 1, 2, 3].map(|slot| DIGITS[four[slot] as usize]);
            if digits.contains(&NONE) {
                return;
            }
            let [a, b, c, d] = digits;
            bytes.extend_from_slice(&[a << 2 | b >> 4, b << 4 | c >> 2, c << 6 | d]);
            self.position += 4;
        }
    }

    /// One quantum with whatever blanks and padding it has; `None` at the end.
    fn quantum(&mut self) -> Result<Option<([u8; 3], usize)>, Fault> {
        let mut digits = [0u8; 4];
        let mut found = 0;
        let mut padded = false;
        while found < 4 {
            let Some(&byte) = self.text.get(self.position) else { break };
            if byte.is_ascii_whitespace() {
                self.position += 1;
                continue;
            }
            if byte == b'=' && found > 0 {
                padded = true;
                self.position += 1;
                // A second sign of the same quantum belongs to it; a third does not exist.
                if found == 2 && self.text.get(self.position) == Some(&b'=') {
                    self.position += 1;
                }
                break;
            }
            let digit = DIGITS[byte as usize];
            if byte == b'<' {
                break;
            }
            if digit == NONE {
                return Err(Fault::new(self.place(), format!("byte {byte:#04x} in base64 data"), "a base64 digit"));
            }
            digits[found] = digit;
            found += 1;
            self.position += 1;
        }
        if found == 0 {
            return Ok(None);
        }
        if found == 1 || found < 4 && !padded {
            return Err(Fault::new(self.place(), "base64 data that stops within a group", "groups of four digits"));
        }
        let [a, b, c, d] = digits;
        Ok(Some(([a << 2 | b >> 4, b << 4 | c >> 2, c << 6 | d], found - 1)))
    }

    fn too_short(&self, wanted: usize, found: usize) -> Fault {
        Fault::new(self.place(), format!("{found} bytes of base64 data"), format!("{wanted}"))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::Decoder;

    #[test]
    fn padding_inside_the_stream_ends_a_part() {
        let mut decoder = Decoder::new(b" AQAAAACAAAA2AAAALgAAAA==\n eF4V", 0);
        assert_eq!(decoder.take(4).unwrap(), [1, 0, 0, 0]);
        assert_eq!(decoder.take(12).unwrap(), [0, 128, 0, 0, 54, 0, 0, 0, 46, 0, 0, 0]);
        assert_eq!(decoder.take(3).unwrap(), [0x78, 0x5e, 0x15]);
        assert!(decoder.take(1).is_err());
    }

    #[test]
    fn bytes_left_over_from_a_group_come_next() {
        let mut decoder = Decoder::new(b"AQIDBAUG", 0);
        assert_eq!(decoder.take(1).unwrap(), [1]);
        assert_eq!(decoder.take(1).unwrap(), [2]);
        assert_eq!(decoder.take(3).unwrap(), [3, 4, 5]);
        assert_eq!(decoder.take(1).unwrap(), [6]);
    }

    #[test]
    fn strange_bytes_and_cut_groups_are_refused() {
        assert!(Decoder::new(b"AQ!DBAUG", 0).take(3).is_err());
        assert!(Decoder::new(b"AQI", 0).take(2).is_err());
        assert!(Decoder::new(b"A===", 0).take(1).is_err());
    }
}
