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
    /// A copy, or these where the system gives no large pages.
    pub fn new(mut numbers: Vec<f64>) -> Numbers {
        #[cfg(target_os = "linux")]
        if let Some(mapped) = mapped(&numbers) {
            return Numbers::Mapped(mapped);
        }
        numbers.shrink_to_fit();
        Numbers::Plain(numbers.into_boxed_slice())
    }
}

/// Bytes of a large page.
#[cfg(target_os = "linux")]
const LARGE: usize = 2 << 20;

/// A copy in large pages; none of what fits into a few of them.
#[cfg(target_os = "linux")]
fn mapped(numbers: &[f64]) -> Option<memmap2::MmapMut> {
    let bytes: &[u8] = bytemuck::cast_slice(numbers);
    if bytes.len() < 4 * LARGE {
        return None;
    }
    let mut map = memmap2::MmapMut::map_anon(bytes.len()).ok()?;
    // Before it is written to: pages are made then.
    map.advise(memmap2::Advice::HugePage).ok()?;
    map.copy_from_slice(bytes);
    Some(map)
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
