//! Counts that a packed file announces: no more is read, and no more memory taken, than its bytes can hold.

use super::MeshFileError;

/// Bytes that deflate packs into one, at the most.
const DEFLATE: u64 = 1032;
/// Least bytes of a number of a coordinate, a node or a family.
pub(in crate::mesh) const NUMBER: u64 = 4;
/// Bytes of a character of a name.
pub(in crate::mesh) const CHARACTER: u64 = 1;

/// What a file of some length can hold.
#[derive(Clone, Copy, Debug)]
pub(in crate::mesh) struct Room {
    bytes: u64,
}

impl Room {
    pub fn of(file: &[u8]) -> Room {
        Room { bytes: file.len() as u64 }
    }

    /// # Errors
    /// When so many values of so many bytes each do not fit, however well they are packed.
    pub fn holds(self, what: &str, shape: &[u64], each: u64) -> Result<(), MeshFileError> {
        let values = shape.iter().fold(1, |product: u64, n| product.saturating_mul(*n));
        if values.saturating_mul(each) <= self.bytes.saturating_mul(DEFLATE) {
            return Ok(());
        }
        let message =
            format!("{what} announces {values} values, more than the {} bytes of the file can hold", self.bytes);
        Err(MeshFileError::Grid { message })
    }

    /// How many things may be counted of which each takes more than a number of the file.
    pub fn things(self) -> usize {
        usize::try_from(self.bytes / NUMBER).unwrap_or(usize::MAX)
    }
}
