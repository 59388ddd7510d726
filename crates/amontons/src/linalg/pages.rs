//! The numbers of a factor in large pages of memory, where the system has them.
//!
//! A sweep goes through tens of megabytes. In pages of 4 kB these are more than the tables of a processor hold, and
//! looking pages up takes a tenth of the time.

use std::ops::{Deref, DerefMut};

/// Numbers, zero at first. In large pages they take no memory where they have not been written to.
#[derive(Debug)]
pub(super) struct Numbers {
    memory: Memory,
    count: usize,
}

#[derive(Debug)]
enum Memory {
    Plain(Vec<f64>),
    #[cfg(target_os = "linux")]
    Mapped(memmap2::MmapMut),
}

impl Numbers {
    /// So many zeros; none where the memory cannot be had.
    pub fn zeros(count: usize) -> Option<Numbers> {
        #[cfg(target_os = "linux")]
        if let Some(map) = mapped(count) {
            return Some(Numbers { memory: Memory::Mapped(map), count });
        }
        let mut numbers = Vec::new();
        numbers.try_reserve_exact(count).ok()?;
        numbers.resize(count, 0.0);
        Some(Numbers { memory: Memory::Plain(numbers), count })
    }

    /// The first of the numbers. What the others take is given back where it is more than that.
    pub fn first(self, count: usize) -> Numbers {
        if 2 * count >= self.count {
            return Numbers { count, ..self };
        }
        match Numbers::zeros(count) {
            Some(mut first) => {
                first.copy_from_slice(&self[..count]);
                first
            }
            None => Numbers { count, ..self },
        }
    }
}

/// Bytes of a large page.
#[cfg(target_os = "linux")]
const LARGE: usize = 2 << 20;

/// Large pages for so many numbers; none for what fits into a few.
#[cfg(target_os = "linux")]
fn mapped(count: usize) -> Option<memmap2::MmapMut> {
    let bytes = count.checked_mul(size_of::<f64>()).filter(|bytes| *bytes >= 4 * LARGE)?;
    let map = memmap2::MmapMut::map_anon(bytes).ok()?;
    map.advise(memmap2::Advice::HugePage).ok()?;
    Some(map)
}

impl Deref for Numbers {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        match &self.memory {
            Memory::Plain(numbers) => &numbers[..self.count],
            #[cfg(target_os = "linux")]
            Memory::Mapped(map) => &bytemuck::cast_slice(map)[..self.count],
        }
    }
}

impl DerefMut for Numbers {
    fn deref_mut(&mut self) -> &mut [f64] {
        match &mut self.memory {
            Memory::Plain(numbers) => &mut numbers[..self.count],
            #[cfg(target_os = "linux")]
            Memory::Mapped(map) => &mut bytemuck::cast_slice_mut(map)[..self.count],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay() {
        for count in [0, 1, 1000, 3_000_001] {
            let mut numbers = Numbers::zeros(count).expect("memory");
            assert!(numbers.len() == count && numbers.iter().all(|number| number.to_bits() == 0));
            numbers.iter_mut().enumerate().for_each(|(i, number)| *number = i as f64);
            for kept in [count, count - count / 5, count / 7] {
                numbers = numbers.first(kept);
                assert!(numbers.iter().copied().eq((0..kept).map(|i| i as f64)), "{kept} of {count}");
            }
        }
    }
}
