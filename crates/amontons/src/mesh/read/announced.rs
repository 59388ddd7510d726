//! Checks of the counts that a packed file announces: neither reading nor memory exceeds what its bytes can hold.

use super::MeshFileError;

/// Largest compression ratio of deflate.
const DEFLATE: u64 = 1032;
/// Least number of bytes of a coordinate, node or family number.
pub(in crate::mesh) const NUMBER: u64 = 4;
/// Bytes of a character of a name.
pub(in crate::mesh) const CHARACTER: u64 = 1;

/// Limits derived from the length of a file.
#[derive(Clone, Copy, Debug)]
pub(in crate::mesh) struct Room {
    bytes: u64,
}

impl Room {
    pub fn of(file: &[u8]) -> Room {
        Room { bytes: file.len() as u64 }
    }

    /// # Errors
    /// Fails if the values of `each` bytes cannot fit into the file, however well they are packed.
    pub fn holds(self, what: &str, shape: &[u64], each: u64) -> Result<(), MeshFileError> {
        let values = shape.iter().fold(1, |product: u64, n| product.saturating_mul(*n));
        if values.saturating_mul(each) <= self.bytes.saturating_mul(DEFLATE) {
            return Ok(());
        }
        let message =
            format!("{what} announces {values} values, more than the {} bytes of the file can hold", self.bytes);
        Err(MeshFileError::Grid { message })
    }

    /// Upper bound of the number of items that take at least a number of the file each.
    pub fn things(self) -> usize {
        usize::try_from(self.bytes / NUMBER).unwrap_or(usize::MAX)
    }
}
