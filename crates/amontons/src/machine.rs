//! Resources of the machine: memory, disk space, a clock, and safe reading of files.

use std::fs::{File, OpenOptions};
use std::io::{self, Read};
use std::path::Path;
#[cfg(not(target_family = "wasm"))]
pub(crate) use std::time::Instant;

// The standard library has no clock in a browser.
#[cfg(target_family = "wasm")]
pub(crate) use web_time::Instant;

/// Address space per thread for products of dense blocks and its own allocations, bytes.
#[cfg(unix)]
const PER_THREAD: f64 = 2.0 * 67_108_864.0;

/// Available memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FreeMemory {
    /// Bytes.
    pub bytes: f64,
    /// The limiting resource; `None` if it is the memory of the machine.
    pub limit: Option<&'static str>,
}

/// Available memory by the tightest limit; `None` if the system does not report it.
pub(crate) fn memory() -> Option<FreeMemory> {
    let limit = if cfg!(unix) { "the limit of the address space, `ulimit -v`" } else { "the address space" };
    let space = address_space().map(|bytes| FreeMemory { bytes, limit: Some(limit) });
    least(physical_memory().into_iter().chain(space))
}

/// Available memory without the limit of the address space: beyond that limit an allocation fails, while memory that
/// the machine or the control group lacks is promised, and writing to it kills the program.
pub(crate) fn physical_memory() -> Option<FreeMemory> {
    let machine = machine_memory().map(|bytes| FreeMemory { bytes, limit: None });
    let group = cgroup().map(|bytes| FreeMemory { bytes, limit: Some("the memory limit of the control group") });
    least(machine.into_iter().chain(group))
}

fn least(all: impl Iterator<Item = FreeMemory>) -> Option<FreeMemory> {
    all.min_by(|a, b| a.bytes.total_cmp(&b.bytes))
}

/// Bytes available without swapping. On macOS these are the free, active and inactive pages.
#[cfg(any(target_os = "macos", windows))]
fn machine_memory() -> Option<f64> {
    let mut system = sysinfo::System::new().ok()?;
    system.refresh_memory_specifics(sysinfo::MemoryRefreshKind::nothing().with_ram());
    // If the system does not answer, all numbers are zero.
    (system.total_memory() > 0).then(|| system.available_memory() as f64)
}

#[cfg(not(any(target_os = "macos", windows)))]
fn machine_memory() -> Option<f64> {
    field("/proc/meminfo", "MemAvailable:")
}

/// Bytes of address space left below the limit of the process.
#[cfg(unix)]
fn address_space() -> Option<f64> {
    let limit = rustix::process::getrlimit(rustix::process::Resource::As).current?;
    let taken = field("/proc/self/status", "VmSize:").unwrap_or(0.0);
    // Outside of a pool there are no threads yet, and asking for their number would start some.
    let threads = rayon::current_thread_index().map_or(1, |_| rayon::current_num_threads());
    Some((limit as f64 - taken - threads as f64 * PER_THREAD).max(0.0))
}

/// In a browser, 32-bit addresses limit the memory.
#[cfg(target_family = "wasm")]
fn address_space() -> Option<f64> {
    const PAGE: f64 = 65_536.0;
    Some(4_294_967_296.0 - core::arch::wasm32::memory_size::<0>() as f64 * PAGE)
}

#[cfg(not(any(unix, target_family = "wasm")))]
fn address_space() -> Option<f64> {
    None
}

/// A field of a kernel table, converted from kB to bytes.
fn field(table: &str, name: &str) -> Option<f64> {
    let text = read_text(Path::new(table), 1 << 20).ok()?;
    let kibibytes: f64 =
        text.lines().find_map(|line| line.strip_prefix(name))?.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024.0)
}

/// Peak memory of this process in bytes; `None` if the system does not report it.
pub(crate) fn peak_memory() -> Option<u64> {
    field("/proc/self/status", "VmHWM:").map(|bytes| bytes as u64)
}

fn cgroup() -> Option<f64> {
    let groups = read_text(Path::new("/proc/self/cgroup"), 1 << 20).ok()?;
    cgroup_free(&groups, Path::new("/sys/fs/cgroup"))
}

/// Bytes below the limits of the control groups listed in `/proc/self/cgroup`, of version 1 and 2, and of their
/// parents; `root` is their mount point.
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
        // In a container the path may be valid only outside: the mount itself is then the group.
        for group in inside.ancestors().take_while(|group| group.starts_with(&mount)) {
            // Version 1 writes a huge number for no limit.
            let Some(limit) = number(&group.join(limit)).filter(|limit| *limit < 1e18) else { continue };
            // Cached pages of files are released when memory is needed.
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

/// Free bytes on the file system of a path; `None` if the system does not report it.
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
/// Pipes, devices and folders are refused without waiting for them.
///
/// # Errors
/// Fails if the file cannot be opened or is not regular.
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

/// The contents of a regular file of at most `longest` bytes.
///
/// # Errors
/// Fails if the file cannot be read, is not regular, or is longer.
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
    // A file may grow while it is read, and kernel files report no length.
    file.take(longest + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > longest { Err(too_long()) } else { Ok(bytes) }
}

/// The text of a file, read by [`read`].
///
/// # Errors
/// Fails like [`read`], and if the contents are not UTF-8.
pub(crate) fn read_text(path: &Path, longest: u64) -> io::Result<String> {
    String::from_utf8(read(path, longest)?)
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "found bytes that are no UTF-8 text"))
}

/// True if a path, with links resolved, is inside a folder. For a missing file its parent folder counts.
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
