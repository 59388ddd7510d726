//! One writer per folder: an advisory lock that the system releases when its holder ends, however it ends.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::OutputError;

/// Name of the file that is locked.
const FILE: &str = ".amontons.lock";

/// The exclusive right to write into a folder, until it is dropped.
///
/// File systems without locks grant it to everyone.
#[derive(Debug)]
pub struct FolderLock {
    file: File,
    path: PathBuf,
}

impl FolderLock {
    /// Takes the right to write into an existing folder.
    ///
    /// # Errors
    /// [`OutputError::InUse`] if another process, or another part of this one, writes into it.
    pub fn take(folder: &Path) -> Result<FolderLock, OutputError> {
        let path = folder.join(FILE);
        loop {
            let mut file = open(&path).map_err(OutputError::io("create", &path))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let mut holder = String::new();
                    // The holder only makes the message clearer.
                    let _ = (&file).take(200).read_to_string(&mut holder);
                    return Err(OutputError::InUse { path: folder.to_owned(), holder: holder.trim().to_owned() });
                }
                Err(TryLockError::Error(error)) if is_without_locks(&error) => {}
                Err(TryLockError::Error(error)) => return Err(OutputError::io("lock", &path)(error)),
            }
            // The previous holder may have removed the file when it ended: then the name belongs to another file.
            if is_at(&file, &path) {
                let holder = format!(
                    "process {} since {}",
                    std::process::id(),
                    humantime::format_rfc3339_seconds(SystemTime::now())
                );
                let noted = file.set_len(0).and_then(|()| file.write_all(holder.as_bytes()));
                noted.map_err(OutputError::io("write", &path))?;
                return Ok(FolderLock { file, path });
            }
        }
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        if is_at(&self.file, &self.path) {
            // A lock file that stays is taken over by the next writer.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// True if a file system has no locks.
fn is_without_locks(error: &io::Error) -> bool {
    #[cfg(unix)]
    if error.raw_os_error() == Some(rustix::io::Errno::NOLCK.raw_os_error()) {
        return true;
    }
    error.kind() == io::ErrorKind::Unsupported
}

/// Opens the file of a lock; a link in its place is not followed.
fn open(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(rustix::fs::OFlags::NOFOLLOW.bits().cast_signed());
    }
    options.open(path)
}

/// True if the name still refers to the open file.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let of = |meta: fs::Metadata| (meta.dev(), meta.ino());
    file.metadata().is_ok_and(|open| fs::symlink_metadata(path).is_ok_and(|named| of(open) == of(named)))
}

/// On other systems an open file cannot be removed.
#[cfg(not(unix))]
fn is_at(_file: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;

    #[test]
    fn one_writer_at_a_time() {
        let folder = std::env::temp_dir().join(format!("amontons-lock-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let first = FolderLock::take(&folder).unwrap();
        let told = FolderLock::take(&folder).unwrap_err().to_string();
        assert!(told.contains(&format!("process {}", std::process::id())), "{told}");
        drop(first);
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0, "the file goes with the lock");
        // A file left by a killed process is no lock.
        fs::write(folder.join(FILE), "process 1").unwrap();
        drop(FolderLock::take(&folder).unwrap());
        #[cfg(unix)]
        {
            let mine = folder.join("mine");
            fs::write(&mine, "mine").unwrap();
            std::os::unix::fs::symlink(&mine, folder.join(FILE)).unwrap();
            assert!(FolderLock::take(&folder).is_err(), "a link is not followed");
            assert_eq!(fs::read(&mine).unwrap(), b"mine");
        }
        fs::remove_dir_all(&folder).unwrap();
    }
}
