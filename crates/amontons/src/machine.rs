//! What the machine allows: memory, disk space, a clock, and files that are safe to read.

use std::fs::{File, OpenOptions};
use std::io::{self, Read};
use std::path::Path;
#[cfg(not(target_family = "wasm"))]
pub(crate) use std::time::Instant;

// The standard library has no clock in a browser.
#[cfg(target_family = "wasm")]
pub(crate) use web_time::Instant;

/// Address space that a thread takes for products of dense blocks and for its own allocations.
#[cfg(unix)]
const PER_THREAD: f64 = 2.0 * 67_108_864.0;

/// Memory that can still be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Memory {
    /// Bytes.
    pub bytes: f64,
    /// What limits it; none where it is the memory of the machine.
    pub limit: Option<&'static str>,
}

/// Memory that can still be taken, by the tightest of what limits it; none where the system does not report it.
pub(crate) fn memory() -> Option<Memory> {
    let limit = if cfg!(unix) { "the limit of the address space, `ulimit -v`" } else { "the address space" };
    let space = address_space().map(|bytes| Memory { bytes, limit: Some(limit) });
    least(physical_memory().into_iter().chain(space))
}

/// The same without the limit of the address space: beyond it an allocation fails, while memory that the machine or the
/// control group does not have is promised, and ends the program when it is written to.
pub(crate) fn physical_memory() -> Option<Memory> {
    let machine = machine_memory().map(|bytes| Memory { bytes, limit: None });
    let group = cgroup().map(|bytes| Memory { bytes, limit: Some("the memory limit of the control group") });
    least(machine.into_iter().chain(group))
}

fn least(all: impl Iterator<Item = Memory>) -> Option<Memory> {
    all.min_by(|a, b| a.bytes.total_cmp(&b.bytes))
}

/// Bytes that the machine can give without swapping. On macOS these are the pages that are free, active or inactive.
#[cfg(any(target_os = "macos", windows))]
fn machine_memory() -> Option<f64> {
    let mut system = sysinfo::System::new().ok()?;
    system.refresh_memory_specifics(sysinfo::MemoryRefreshKind::nothing().with_ram());
    // Where the system does not answer, all numbers are zero.
    (system.total_memory() > 0).then(|| system.available_memory() as f64)
}

#[cfg(not(any(target_os = "macos", windows)))]
fn machine_memory() -> Option<f64> {
    field("/proc/meminfo", "MemAvailable:")
}

/// Bytes of address space below the limit of the process.
#[cfg(unix)]
fn address_space() -> Option<f64> {
    let limit = rustix::process::getrlimit(rustix::process::Resource::As).current?;
    let taken = field("/proc/self/status", "VmSize:").unwrap_or(0.0);
    // Outside of a pool there are no threads yet, and to ask for their number would start some.
    let threads = rayon::current_thread_index().map_or(1, |_| rayon::current_num_threads());
    Some((limit as f64 - taken - threads as f64 * PER_THREAD).max(0.0))
}

/// In a browser the addresses of 32 bits end it.
#[cfg(target_family = "wasm")]
fn address_space() -> Option<f64> {
    const PAGE: f64 = 65_536.0;
    Some(4_294_967_296.0 - core::arch::wasm32::memory_size::<0>() as f64 * PAGE)
}

#[cfg(not(any(unix, target_family = "wasm")))]
fn address_space() -> Option<f64> {
    None
}

/// A field of a table of the kernel, given in kB there, in bytes.
fn field(table: &str, name: &str) -> Option<f64> {
    let text = read_text(Path::new(table), 1 << 20).ok()?;
    let kibibytes: f64 =
        text.lines().find_map(|line| line.strip_prefix(name))?.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024.0)
}

/// Most memory that this process held, bytes, where the system reports it.
pub(crate) fn peak_memory() -> Option<u64> {
    field("/proc/self/status", "VmHWM:").map(|bytes| bytes as u64)
}

fn cgroup() -> Option<f64> {
    let groups = read_text(Path::new("/proc/self/cgroup"), 1 << 20).ok()?;
    cgroup_free(&groups, Path::new("/sys/fs/cgroup"))
}

/// Bytes below the limits of the control groups that `/proc/self/cgroup` lists, of version 1 and 2, with those above
/// them; `root` is where the groups are mounted.
fn cgroup_free(groups: &str, root: &Path) -> Option<f64> {
    let number = |path: &Path| read_text(path, 1 << 16).ok()?.trim().parse::<f64>().ok();
    let mut least: Option<f64> = None;
    for line in groups.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else { continue };
        let (mount, [limit, usage]) = match controllers {
            "" => (root.to_owned(), ["memory.max", "memory.current"]),
            all if all.split(',').any(|c| c == "memory") => {
                (root.join("memory"), ["memory.limit_in_bytes", "memory.usage_in_bytes"])
            }
            _ => continue,
        };
        let inside = mount.join(path.trim_start_matches('/'));
        // In a container the path may be one that is seen from outside only: the mount itself is then the group.
        for group in inside.ancestors().take_while(|group| group.starts_with(&mount)) {
            // Version 1 writes no limit as a number beyond any memory.
            let Some(limit) = number(&group.join(limit)).filter(|limit| *limit < 1e18) else { continue };
            // Pages of files that were read are given back when memory is needed.
            let cache = read_text(&group.join("memory.stat"), 1 << 20).ok().and_then(|stat| {
                let line = stat.lines().find_map(|line| line.strip_prefix("inactive_file "))?;
                line.trim().parse::<f64>().ok()
            });
            let taken = number(&group.join(usage)).unwrap_or(0.0) - cache.unwrap_or(0.0);
            let free = (limit - taken.max(0.0)).max(0.0);
            least = Some(least.map_or(free, |least| least.min(free)));
        }
    }
    least
}

/// Bytes that can still be written to the file system of a path, where the system reports it.
#[cfg(unix)]
pub(crate) fn disk_free(path: &Path) -> Option<u64> {
    let system = rustix::fs::statvfs(path).ok()?;
    system.f_bavail.checked_mul(system.f_frsize)
}

#[cfg(not(unix))]
pub(crate) fn disk_free(_path: &Path) -> Option<u64> {
    None
}

/// Opens a regular file for reading.
///
/// Pipes, devices and folders are refused and never waited for.
///
/// # Errors
/// When the file cannot be opened or is none.
pub(crate) fn open(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits().cast_signed());
    }
    let file = options.open(path)?;
    let meta = file.metadata()?;
    if meta.is_file() {
        return Ok(file);
    }
    let found = if meta.is_dir() { "found a folder" } else { "found a pipe or a device" };
    Err(io::Error::new(io::ErrorKind::InvalidInput, format!("{found}, expected a regular file")))
}

/// What a file holds that is a regular file of at most `longest` bytes.
///
/// # Errors
/// When the file cannot be read, is none, or is longer.
pub(crate) fn read(path: &Path, longest: u64) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let length = file.metadata()?.len();
    let too_long = || {
        let message = format!("found more than {longest} bytes, expected at most that many");
        io::Error::new(io::ErrorKind::FileTooLarge, message)
    };
    if length > longest {
        return Err(too_long());
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length as usize).map_err(|_| io::Error::from(io::ErrorKind::OutOfMemory))?;
    // A file may grow while it is read, and those of the kernel have no length.
    file.take(longest + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > longest { Err(too_long()) } else { Ok(bytes) }
}

/// The text of a file, as [`read`] reads it.
///
/// # Errors
/// As [`read`]; also when it is not UTF-8.
pub(crate) fn read_text(path: &Path, longest: u64) -> io::Result<String> {
    String::from_utf8(read(path, longest)?)
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "found bytes that are no UTF-8 text"))
}

/// Whether a path, links followed, is one below a folder. Of a file that is not there the folder counts that it would
/// be in.
pub(crate) fn is_inside(folder: &Path, path: &Path) -> bool {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let real = path.canonicalize().or_else(|_| path.parent().unwrap_or(folder).canonicalize());
    folder.canonicalize().is_ok_and(|folder| real.is_ok_and(|real| real.starts_with(folder)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;

    #[test]
    fn the_tightest_group_counts_in_both_versions() {
        let folder = std::env::temp_dir().join(format!("amontons-cgroup-{}", std::process::id()));
        let put = |path: &str, text: &str| {
            let path = folder.join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        put("job/memory.max", "1000000\n");
        put("job/memory.current", "400000\n");
        put("job/memory.stat", "anon 1\ninactive_file 100000\n");
        put("job/step/memory.max", "max\n");
        put("memory/user/memory.limit_in_bytes", "650000\n");
        put("memory/user/memory.usage_in_bytes", "50000\n");
        put("memory/memory.limit_in_bytes", "9223372036854771712\n");
        // 1000000 − (400000 − 100000), and 650000 − 50000.
        let free = |groups: &str| cgroup_free(groups, &folder);
        assert_eq!(free("0::/job/step\n"), Some(700_000.0));
        assert_eq!(free("12:cpu:/\n4:memory:/user\n0::/job/step\n"), Some(600_000.0));
        assert_eq!(free("4:memory:/\n"), None);
        assert_eq!(free("0::/seen/from/outside\n"), None);
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn only_regular_files_of_a_bounded_length_are_read() {
        let path = std::env::temp_dir().join(format!("amontons-read-{}", std::process::id()));
        std::fs::write(&path, "12345").unwrap();
        assert_eq!(read(&path, 5).unwrap(), b"12345");
        assert_eq!(read(&path, 4).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
        std::fs::remove_file(&path).unwrap();
        for other in ["/dev/zero", "/tmp"].iter().filter(|other| Path::new(other).exists()) {
            assert_eq!(read(Path::new(other), 5).unwrap_err().kind(), io::ErrorKind::InvalidInput, "{other}");
        }
    }

    #[test]
    fn the_machine_reports_memory_and_disk() {
        if cfg!(any(target_os = "linux", target_os = "macos", windows)) {
            assert!(physical_memory().unwrap().bytes > 0.0 && memory().unwrap().bytes > 0.0);
        }
        if cfg!(unix) {
            assert!(disk_free(&std::env::temp_dir()).is_some());
        }
        if cfg!(target_os = "linux") {
            assert!(peak_memory().unwrap() > 0);
        }
    }
}
