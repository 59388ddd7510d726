//! Files that are either complete or absent.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::OutputError;
use crate::machine;

/// Longest file of a results folder that is read into memory.
pub(crate) const LONGEST: u64 = 1 << 36;

/// Two hexadecimal digits per byte.
pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
}

/// SHA-256, hexadecimal.
pub(crate) fn sha256(bytes: impl AsRef<[u8]>) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// A file as it was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct WrittenFile {
    /// Its length.
    pub bytes: u64,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

impl WrittenFile {
    /// The record of a file with these bytes.
    pub fn of(bytes: &[u8]) -> WrittenFile {
        WrittenFile { bytes: bytes.len() as u64, sha256: sha256(bytes) }
    }

    /// The record of a file on the disk.
    pub fn read(path: &Path) -> io::Result<WrittenFile> {
        let mut out = Out::new(io::sink());
        io::copy(&mut machine::open(path)?, &mut out)?;
        Ok(out.written())
    }
}

/// A writer that counts and hashes the bytes written.
pub(super) struct Out<W: Write> {
    to: W,
    hash: Sha256,
    bytes: u64,
}

impl<W: Write> Out<W> {
    fn new(to: W) -> Out<W> {
        Out { to, hash: Sha256::new(), bytes: 0 }
    }

    fn written(&self) -> WrittenFile {
        WrittenFile { bytes: self.bytes, sha256: hexadecimal(&self.hash.clone().finalize()) }
    }
}

impl<W: Write> Write for Out<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.to.write(bytes)?;
        self.hash.update(&bytes[..count]);
        self.bytes += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

/// Writes a file under a temporary name and renames it when it is complete and on the disk: a crash leaves the old file
/// or the new one, never a part.
///
/// The temporary name cannot be guessed and is created anew, so that no existing link is followed.
pub(super) fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut Out<BufWriter<File>>) -> io::Result<()>,
) -> Result<WrittenFile, OutputError> {
    let (temporary, file) = temporary(path).map_err(OutputError::io("write", path))?;
    let result = (|| {
        let mut out = Out::new(BufWriter::new(file));
        write(&mut out)?;
        let written = out.written();
        out.to.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
        fs::rename(&temporary, path)?;
        sync_folder(path.parent())?;
        Ok(written)
    })();
    if result.is_err() {
        // The temporary file is ours and incomplete; the first error is the one to report.
        let _ = fs::remove_file(&temporary);
    }
    result.map_err(OutputError::io("write", path))
}

/// Lets `make` create a file by path, with the same guarantee: under a temporary name, renamed when all is on the disk.
/// An error of `make` is returned in the inner result.
pub(super) fn make_atomically<E>(
    path: &Path,
    make: impl FnOnce(&Path) -> Result<(), E>,
) -> Result<Result<WrittenFile, E>, OutputError> {
    let (temporary, _) = temporary(path).map_err(OutputError::io("write", path))?;
    let made = make(&temporary);
    let result = match made {
        Ok(()) => (|| {
            let written = WrittenFile::read(&temporary)?;
            File::open(&temporary)?.sync_all()?;
            fs::rename(&temporary, path)?;
            sync_folder(path.parent())?;
            Ok(Ok(written))
        })(),
        Err(error) => Ok(Err(error)),
    };
    if !matches!(result, Ok(Ok(_))) {
        let _ = fs::remove_file(&temporary);
    }
    result.map_err(OutputError::io("write", path))
}

/// Writes a file of these bytes, which is afterwards complete or absent.
#[cfg(feature = "plot")]
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match write_atomically(path, |out| out.write_all(bytes)) {
        Ok(_) => Ok(()),
        Err(OutputError::Io { source, .. }) => Err(source),
        Err(error) => Err(io::Error::other(error)),
    }
}

/// Flushes the names in a folder to the disk.
pub(super) fn sync_folder(folder: Option<&Path>) -> io::Result<()> {
    #[cfg(unix)]
    if let Some(folder) = folder {
        File::open(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?.sync_all()?;
    }
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
}

/// Writes a value as indented JSON, atomically.
pub(super) fn write_json(path: &Path, value: &impl Serialize) -> Result<WrittenFile, OutputError> {
    write_atomically(path, |out| {
        serde_json::to_writer_pretty(&mut *out, value)?;
        out.write_all(b"\n")
    })
}

/// Creates a folder with its parents.
pub(super) fn create_folder(path: &Path) -> Result<(), OutputError> {
    fs::create_dir_all(path).map_err(OutputError::io("create", path))
}

/// Removes a file, or a link but not its target. A missing file is no error.
pub(super) fn remove_file(path: &Path) -> Result<(), OutputError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(OutputError::io("remove", path)(error)),
        _ => Ok(()),
    }
}

/// Removes a folder of ours with its content. A missing folder is no error.
pub(super) fn remove_folder(path: &Path) -> Result<(), OutputError> {
    match fs::symlink_metadata(path) {
        Ok(meta) if meta.is_dir() => fs::remove_dir_all(path).map_err(OutputError::io("remove", path)),
        _ => remove_file(path),
    }
}

/// Removes a folder if it is empty.
pub(super) fn remove_empty_folder(path: &Path) {
    // A folder that is not empty holds files of somebody else.
    let _ = fs::remove_dir(path);
}

/// Moves a file. A missing file is no error.
pub(super) fn move_file(from: &Path, to: &Path) -> Result<(), OutputError> {
    match fs::rename(from, to) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(OutputError::io("move", from)(error)),
        _ => Ok(()),
    }
}

/// Copies a file atomically. A missing file is no error.
pub(super) fn copy_file(from: &Path, to: &Path) -> Result<(), OutputError> {
    match machine::open(from) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        file => {
            let mut file = file.map_err(OutputError::io("read", from))?;
            write_atomically(to, |out| io::copy(&mut file, out).map(|_| ())).map(|_| ())
        }
    }
}

/// Digits of the random part of a temporary name.
const DIGITS: usize = 16;
const ENDING: &str = ".part";

/// A new file next to `path` under a unique name.
fn temporary(path: &Path) -> io::Result<(PathBuf, File)> {
    let mut refused = io::Error::from(io::ErrorKind::AlreadyExists);
    for attempt in 0..16 {
        // The keys of `RandomState` are random.
        let number = RandomState::new().hash_one(attempt);
        let mut name = OsString::from(".");
        name.push(path.file_name().unwrap_or_default());
        name.push(format!(".{number:0DIGITS$x}{ENDING}"));
        let temporary = path.with_file_name(name);
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => refused = error,
            file => return Ok((temporary, file?)),
        }
    }
    Err(refused)
}

/// The final name of a temporary file, or `None` if the name is not one of ours.
pub(super) fn of_temporary(name: &str) -> Option<&str> {
    let (file, number) = name.strip_prefix('.')?.strip_suffix(ENDING)?.rsplit_once('.')?;
    (number.len() == DIGITS && number.bytes().all(|b| b.is_ascii_hexdigit())).then_some(file)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;

    #[test]
    fn what_was_written_is_noted_and_no_link_is_followed() {
        let folder = std::env::temp_dir().join(format!("amontons-files-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let (path, mine) = (folder.join("a.csv"), folder.join("mine"));
        fs::write(&mine, "mine").unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink(&mine, &path).unwrap();
        let written = write_atomically(&path, |out| out.write_all(b"abc")).unwrap();
        // FIPS 180-4, example B.1.
        assert_eq!(written.sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert_eq!((written.bytes, &WrittenFile::read(&path).unwrap()), (3, &written));
        assert_eq!(fs::read(&mine).unwrap(), b"mine");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 2, "no temporary file is left");
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn temporary_names_are_known() {
        assert_eq!(of_temporary(".step_0000003.vtu.0123456789abcdef.part"), Some("step_0000003.vtu"));
        for other in ["step.0123456789abcdef.part", ".a.012.part", ".a.0123456789abcdeg.part", ".a.part", ".bashrc"] {
            assert_eq!(of_temporary(other), None, "{other}");
        }
    }
}
