//! The variables of a netCDF file of any format: classic, with 64-bit offsets or data, and netCDF-4, which is HDF5.

use super::super::read::{CHARACTER, MeshFileError, NUMBER, Room};
use super::refuse;

/// First bytes of HDF5.
const HDF5: &[u8] = b"\x89HDF";

/// A file with named arrays.
pub(super) struct Variables {
    file: NetcdfFormat,
    room: Room,
}

enum NetcdfFormat {
    Classic(netcdf_reader::NcFile),
    Hdf5(hdf5_pure::File),
}

/// The numbers of an array; integers up to 2⁵³ are exact.
pub(super) struct NetcdfNumbers {
    pub shape: Vec<usize>,
    pub values: Vec<f64>,
}

fn told(name: &str, error: impl std::fmt::Display) -> MeshFileError {
    refuse(format!("the variable {name} cannot be read: {error}"))
}

impl Variables {
    pub fn of(bytes: &[u8]) -> Result<Variables, MeshFileError> {
        let unknown = |error: &dyn std::fmt::Display| {
            refuse(format!("no netCDF, which an Exodus file is: {error}; it may be truncated"))
        };
        let file = if bytes.starts_with(HDF5) {
            NetcdfFormat::Hdf5(hdf5_pure::File::from_bytes(bytes.to_vec()).map_err(|error| unknown(&error))?)
        } else {
            NetcdfFormat::Classic(netcdf_reader::NcFile::from_bytes(bytes).map_err(|error| unknown(&error))?)
        };
        Ok(Variables { file, room: Room::of(bytes) })
    }

    /// Largest number of blocks or sets that the file can have.
    pub fn most_things(&self) -> usize {
        self.room.things()
    }

    /// Shape of a variable with values of `each` bytes; `None` if there is no variable of this name.
    fn shape(&self, name: &str, each: u64) -> Result<Option<Vec<usize>>, MeshFileError> {
        let shape = match &self.file {
            NetcdfFormat::Classic(file) => file.variable(name).ok().map(netcdf_reader::NcVariable::shape),
            NetcdfFormat::Hdf5(file) => {
                let data = file.dataset(name).ok();
                data.map(|data| data.shape().map_err(|error| told(name, error))).transpose()?
            }
        };
        if let Some(shape) = &shape {
            self.room.holds(&format!("the variable {name}"), shape, each)?;
        }
        let length = |n: u64| usize::try_from(n).map_err(|error| told(name, error));
        shape.map(|shape| shape.into_iter().map(length).collect()).transpose()
    }

    pub fn numbers(&self, name: &str) -> Result<Option<NetcdfNumbers>, MeshFileError> {
        let Some(shape) = self.shape(name, NUMBER)? else { return Ok(None) };
        let values = match &self.file {
            NetcdfFormat::Classic(file) => {
                file.read_variable_as_f64(name).map(|values| values.into_iter().collect()).map_err(|e| told(name, e))?
            }
            NetcdfFormat::Hdf5(file) => {
                file.dataset(name).and_then(|data| data.read_f64()).map_err(|error| told(name, error))?
            }
        };
        Ok(Some(NetcdfNumbers { shape, values }))
    }

    /// The numbers of a one-dimensional array; empty if there is no such array.
    pub fn list(&self, name: &str) -> Result<Vec<f64>, MeshFileError> {
        Ok(self.numbers(name)?.map_or_else(Vec::new, |numbers| numbers.values))
    }

    /// The rows of an array of characters, without trailing zeros and blanks.
    pub fn lines(&self, name: &str) -> Result<Vec<String>, MeshFileError> {
        let Some(shape) = self.shape(name, CHARACTER)? else { return Ok(Vec::new()) };
        let trimmed = |text: &str| text.split('\0').next().unwrap_or_default().trim().to_owned();
        match &self.file {
            NetcdfFormat::Classic(file) => {
                let lines = file.read_variable_as_strings(name).map_err(|error| told(name, error))?;
                Ok(lines.iter().map(|line| trimmed(line)).collect())
            }
            NetcdfFormat::Hdf5(file) => {
                let bytes = file.dataset(name).and_then(|data| data.read_raw()).map_err(|error| told(name, error))?;
                let length = shape.last().copied().unwrap_or(1).max(1);
                Ok(bytes.chunks(length).map(|line| trimmed(&String::from_utf8_lossy(line))).collect())
            }
        }
    }

    /// An attribute of a variable as text.
    pub fn attribute(&self, name: &str, key: &str) -> Option<String> {
        let text = match &self.file {
            NetcdfFormat::Classic(file) => file.variable(name).ok()?.attribute(key)?.value.as_string()?,
            NetcdfFormat::Hdf5(file) => file.dataset(name).ok()?.attrs().ok()?.get(key)?.as_str()?.to_owned(),
        };
        Some(text.trim_matches(['\0', ' ']).to_owned())
    }
}
