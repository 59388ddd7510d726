//! The numbers of a factor in large pages of memory, where the system has them.
//!
//! A sweep goes through tens of megabytes. In pages of 4 kB these are more than the tables of a processor hold, and
//! looking pages up takes a tenth of the time.

use std::ops::Deref;

/// Numbers that are only read.
#[derive(Debug)]
pub(super) enum Numbers {
    Plain(Box<[f64]>),
    #[cfg(target_os = "linux")]
    Mapped(memmap2::MmapMut),
}

impl Numbers {
    /// These numbers, moved to large pages where the system gives them.
    pub fn new(mut numbers: Vec<f64>) -> Numbers {
        numbers.shrink_to_fit();
        #[cfg(target_os = "linux")]
        if let Some(map) = mapped(numbers.len()) {
            return Numbers::Mapped(moved(numbers, map));
        }
        Numbers::Plain(numbers.into_boxed_slice())
    }
}

/// Bytes of a large page.
#[cfg(target_os = "linux")]
const LARGE: usize = 2 << 20;

/// Large pages for so many numbers, which take no memory until they are written to; none for what fits into a few.
#[cfg(target_os = "linux")]
fn mapped(count: usize) -> Option<memmap2::MmapMut> {
    let bytes = count.checked_mul(size_of::<f64>()).filter(|bytes| *bytes >= 4 * LARGE)?;
    let map = memmap2::MmapMut::map_anon(bytes).ok()?;
    map.advise(memmap2::Advice::HugePage).ok()?;
    Some(map)
}

/// The numbers in the pages. They are moved from the end, and the memory that they leave is given back as they go: a
/// factor may take most of what there is.
#[cfg(target_os = "linux")]
fn moved(mut numbers: Vec<f64>, mut map: memmap2::MmapMut) -> memmap2::MmapMut {
    let pages: &mut [f64] = bytemuck::cast_slice_mut(&mut map);
    while !numbers.is_empty() {
        let from = numbers.len().saturating_sub(8 * LARGE / size_of::<f64>());
        pages[from..numbers.len()].copy_from_slice(&numbers[from..]);
        numbers.truncate(from);
        numbers.shrink_to_fit();
    }
    map
}

impl Deref for Numbers {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        match self {
            Numbers::Plain(numbers) => numbers,
            #[cfg(target_os = "linux")]
            Numbers::Mapped(map) => bytemuck::cast_slice(map),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay() {
        for count in [0, 1, 1000, 3_000_001] {
            let all: Vec<f64> = (0..count).map(f64::from).collect();
            let numbers = Numbers::new(all.clone());
            assert!(*numbers == all[..], "{count}");
        }
    }
}
