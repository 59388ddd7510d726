//! Reads numbers of a Gmsh file, from text or from bytes of either order.

use super::super::read::{FilePosition, MeshFileError};

/// Format of the numbers of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberEncoding {
    Ascii,
    Binary {
        big: bool,
        /// Bytes of a `size_t`.
        size: usize,
    },
}

/// A place in the bytes of a file.
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    pub mode: NumberEncoding,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Cursor<'a> {
        Cursor { bytes, at: 0, mode: NumberEncoding::Ascii }
    }

    /// The byte at which the next number begins.
    pub(super) fn position(&mut self) -> usize {
        if self.mode == NumberEncoding::Ascii {
            self.skip_space();
        }
        self.at
    }

    /// The byte at which the next word begins, in parts that are text in every file.
    pub(super) fn word_position(&mut self) -> usize {
        self.skip_space();
        self.at
    }

    /// Position of a byte as named in messages: its line in a text file.
    pub(super) fn place(&self, at: usize) -> FilePosition {
        match self.mode {
            NumberEncoding::Ascii => FilePosition::line(self.bytes, at),
            NumberEncoding::Binary { .. } => FilePosition::Byte(at),
        }
    }

    /// The error for unexpected contents at a byte.
    pub(super) fn fault(&self, at: usize, expected: impl Into<String>) -> MeshFileError {
        let rest = self.bytes.get(at..).unwrap_or_default();
        let token = rest.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        let found = if rest.is_empty() {
            "the end of the file".to_owned()
        } else if token.is_empty() {
            "the end of the line".to_owned()
        } else {
            format!("`{}`", token.get(..token.len().min(40)).unwrap_or_default().escape_ascii())
        };
        MeshFileError::Syntax { at: self.place(at), found, expected: expected.into() }
    }

    fn skip_space(&mut self) {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        self.at += rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
    }

    /// The next word; empty at the end of the file.
    pub(super) fn token(&mut self) -> &'a [u8] {
        self.skip_space();
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let length = rest.iter().take_while(|b| !b.is_ascii_whitespace()).count();
        self.at += length;
        rest.get(..length).unwrap_or_default()
    }

    /// The next word with its first byte, in text and between binary sections.
    pub(super) fn word(&mut self) -> (usize, &'a [u8]) {
        let word = self.token();
        (self.at - word.len(), word)
    }

    /// The rest of the line without its end; moves the cursor behind it.
    pub(super) fn line(&mut self) -> &'a [u8] {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let length = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        rest.get(..length).unwrap_or_default()
    }

    /// Moves to the first byte of values after text: in a binary file the next line.
    pub(super) fn begin_data(&mut self) {
        if self.mode != NumberEncoding::Ascii {
            self.line();
        }
    }

    /// Moves behind the word that ends a section, ignoring everything before it.
    pub(super) fn skip_section(&mut self, name: &[u8]) -> Result<(), MeshFileError> {
        let end = [b"$End", name.get(1..).unwrap_or_default()].concat();
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let mut from = 0;
        while let Some(dollar) = rest.get(from..).and_then(|r| r.iter().position(|&b| b == b'$')) {
            from += dollar;
            if rest.get(from..).is_some_and(|r| r.starts_with(&end)) {
                self.at += from + end.len();
                return Ok(());
            }
            from += 1;
        }
        Err(self.fault(self.bytes.len(), String::from_utf8_lossy(&end)))
    }

    /// Moves behind the word that ends a section, which must come next.
    pub(super) fn end_section(&mut self, name: &str) -> Result<(), MeshFileError> {
        let (at, word) = self.word();
        if word == [b"$End", name.as_bytes()].concat() { Ok(()) } else { Err(self.fault(at, format!("$End{name}"))) }
    }

    /// An integer written as text in every file.
    pub(super) fn text_integer(&mut self, expected: &'static str) -> Result<i64, MeshFileError> {
        let token = self.token();
        let (negative, digits) = match token.split_first() {
            Some((b'-', rest)) => (true, rest),
            Some((b'+', rest)) => (false, rest),
            _ => (false, token),
        };
        let value = digits.iter().try_fold(0_i64, |value, byte| {
            let digit = byte.wrapping_sub(b'0');
            if digit < 10 { value.checked_mul(10)?.checked_add(i64::from(digit)) } else { None }
        });
        match value {
            Some(value) if !digits.is_empty() => Ok(if negative { -value } else { value }),
            _ => Err(self.fault(self.at - token.len(), expected)),
        }
    }

    fn take<const N: usize>(&mut self, big: bool, expected: &'static str) -> Result<[u8; N], MeshFileError> {
        let chunk = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<N>());
        let end = || MeshFileError::Syntax {
            at: self.place(self.at),
            found: "the end of the file".to_owned(),
            expected: expected.to_owned(),
        };
        let mut chunk = *chunk.ok_or_else(end)?;
        self.at += N;
        if big {
            chunk.reverse();
        }
        Ok(chunk)
    }

    /// An `int` of the format.
    pub(super) fn integer(&mut self, expected: &'static str) -> Result<i64, MeshFileError> {
        match self.mode {
            NumberEncoding::Ascii => self.text_integer(expected),
            NumberEncoding::Binary { big, .. } => Ok(i64::from(i32::from_le_bytes(self.take(big, expected)?))),
        }
    }

    /// A `size_t` of the format.
    pub(super) fn size(&mut self, expected: &'static str) -> Result<u64, MeshFileError> {
        match self.mode {
            NumberEncoding::Ascii => {
                let at = self.position();
                u64::try_from(self.text_integer(expected)?).map_err(|_| self.fault(at, expected))
            }
            NumberEncoding::Binary { big, size: 4 } => Ok(u64::from(u32::from_le_bytes(self.take(big, expected)?))),
            NumberEncoding::Binary { big, .. } => Ok(u64::from_le_bytes(self.take(big, expected)?)),
        }
    }

    /// A `double` of the format.
    pub(super) fn real(&mut self, expected: &'static str) -> Result<f64, MeshFileError> {
        match self.mode {
            NumberEncoding::Ascii => {
                let token = self.token();
                let value = std::str::from_utf8(token).ok().and_then(|t| t.parse().ok());
                value.ok_or_else(|| self.fault(self.at - token.len(), expected))
            }
            NumberEncoding::Binary { big, .. } => Ok(f64::from_le_bytes(self.take(big, expected)?)),
        }
    }

    /// Refuses a count of items that the rest of the file cannot hold, given the numbers and bytes per item.
    pub(super) fn fits(
        &self,
        at: usize,
        what: &'static str,
        found: u64,
        numbers: usize,
        binary_bytes: usize,
    ) -> Result<usize, MeshFileError> {
        let rest = self.bytes.len().saturating_sub(self.at) as u64;
        let each = match self.mode {
            // A digit and a space; the last number may lack the space.
            NumberEncoding::Ascii => 2 * numbers,
            NumberEncoding::Binary { .. } => binary_bytes,
        };
        let room = (rest + 1) / each.max(1) as u64;
        if found > room.min(u64::from(u32::MAX)) {
            Err(MeshFileError::Count { at: self.place(at), what, found, room })
        } else {
            Ok(found as usize)
        }
    }

    /// A list of integers after its length.
    pub(super) fn list(&mut self, what: &'static str) -> Result<Vec<i64>, MeshFileError> {
        let at = self.position();
        let count = self.size(what)?;
        let count = self.fits(at, what, count, 1, 4)?;
        (0..count).map(|_| self.integer(what)).collect()
    }

    /// Bytes of a `size_t` in a binary file.
    pub(super) fn size_bytes(&self) -> usize {
        match self.mode {
            NumberEncoding::Binary { size, .. } => size,
            NumberEncoding::Ascii => 1,
        }
    }

    /// Detects the byte order from the integer 1 at the beginning of a binary file.
    pub(super) fn byte_order(&mut self, size: usize) -> Result<(), MeshFileError> {
        let at = self.at;
        self.mode = NumberEncoding::Binary { big: false, size };
        let one = self.take::<4>(false, "the integer 1 in binary, which shows the byte order")?;
        let big = match one {
            [1, 0, 0, 0] => false,
            [0, 0, 0, 1] => true,
            _ => {
                return Err(MeshFileError::Syntax {
                    at: self.place(at),
                    found: format!("the bytes {one:?}"),
                    expected: "the integer 1 in binary".to_owned(),
                });
            }
        };
        self.mode = NumberEncoding::Binary { big, size };
        Ok(())
    }
}
