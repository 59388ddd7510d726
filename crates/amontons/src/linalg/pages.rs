//! Storage of the numbers of a matrix, a factor or a multigrid level in large pages of memory, if the system has them.
//!
//! A sweep reads tens of megabytes. In pages of 4 kB these are more than the page tables of a processor hold, and
//! looking pages up takes a tenth of the time. The system also hands out large pages in less time.

use std::ops::{Deref, DerefMut};

use bytemuck::Pod;

/// Numbers, initially zero. In large pages they take no memory until they are written to.
#[derive(Debug)]
pub(super) struct PagedNumbers<T = f64> {
    memory: PageStore<T>,
    count: usize,
}

#[derive(Debug)]
enum PageStore<T> {
    Plain(Vec<T>),
    #[cfg(target_os = "linux")]
    Mapped(memmap2::MmapMut),
}

impl<T: Pod> PagedNumbers<T> {
    /// Allocates `count` zeros, or returns `None` if there is not enough memory.
    pub fn zeros(count: usize) -> Option<PagedNumbers<T>> {
        #[cfg(target_os = "linux")]
        if let Some(map) = mapped(count.checked_mul(size_of::<T>())?) {
            return Some(PagedNumbers { memory: PageStore::Mapped(map), count });
        }
        let mut numbers = Vec::new();
        numbers.try_reserve_exact(count).ok()?;
        numbers.resize(count, T::zeroed());
        Some(PagedNumbers { memory: PageStore::Plain(numbers), count })
    }

    /// Allocates `count` numbers, initially zero, and has `fill` write them. The program ends if there is not enough
    /// memory, as for a vector.
    pub fn of(count: usize, fill: impl FnOnce(&mut [T])) -> PagedNumbers<T> {
        let plain = || PagedNumbers { memory: PageStore::Plain(vec![T::zeroed(); count]), count };
        let mut numbers = PagedNumbers::zeros(count).unwrap_or_else(plain);
        fill(&mut numbers);
        numbers
    }

    /// Keeps the first `count` numbers. If the others are more than half, their memory is released.
    pub fn first(self, count: usize) -> PagedNumbers<T> {
        let count = count.min(self.count);
        if 2 * count < self.count
            && let Some(mut first) = PagedNumbers::zeros(count)
        {
            first.copy_from_slice(&self[..count]);
            return first;
        }
        PagedNumbers { count, ..self }
    }
}

/// Bytes per large page.
#[cfg(target_os = "linux")]
const LARGE: usize = 2 << 20;

/// Allocates large pages for a number of bytes, or returns `None` if they would be fewer than four or are not
/// available.
#[cfg(target_os = "linux")]
fn mapped(bytes: usize) -> Option<memmap2::MmapMut> {
    if bytes < 4 * LARGE {
        return None;
    }
    let map = memmap2::MmapMut::map_anon(bytes).ok()?;
    map.advise(memmap2::Advice::HugePage).ok()?;
    Some(map)
}

impl<T: Pod> Clone for PagedNumbers<T> {
    fn clone(&self) -> PagedNumbers<T> {
        PagedNumbers::of(self.count, |same| same.copy_from_slice(self))
    }
}

impl<T: Pod> Deref for PagedNumbers<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match &self.memory {
            PageStore::Plain(numbers) => &numbers[..self.count],
            #[cfg(target_os = "linux")]
            PageStore::Mapped(map) => &bytemuck::cast_slice(map)[..self.count],
        }
    }
}

impl<T: Pod> DerefMut for PagedNumbers<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        match &mut self.memory {
            PageStore::Plain(numbers) => &mut numbers[..self.count],
            #[cfg(target_os = "linux")]
            PageStore::Mapped(map) => &mut bytemuck::cast_slice_mut(map)[..self.count],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay() {
        for count in [0, 1, 1000, 3_000_001] {
            let mut numbers = PagedNumbers::<f64>::zeros(count).expect("memory");
            assert!(numbers.len() == count && numbers.iter().all(|number| number.to_bits() == 0));
            numbers.iter_mut().enumerate().for_each(|(i, number)| *number = i as f64);
            for kept in [count, count - count / 5, count / 7] {
                numbers = numbers.first(kept);
                assert!(numbers.iter().copied().eq((0..kept).map(|i| i as f64)), "{kept} of {count}");
            }
        }
    }

    #[test]
    fn copies_are_apart() {
        for count in [0, 7, 5_000_003] {
            let numbers = PagedNumbers::of(count, |all| all.iter_mut().enumerate().for_each(|(i, x)| *x = i as f32));
            let mut copy = numbers.clone();
            assert_eq!(copy[..], numbers[..]);
            copy.iter_mut().for_each(|x| *x = -1.0);
            assert!(
                numbers.len() == count && numbers.iter().enumerate().all(|(i, x)| x.to_bits() == (i as f32).to_bits())
            );
        }
    }
}
