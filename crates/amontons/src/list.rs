//! Lists whose memory is used again.
//!
//! A step makes some hundred vectors and lists, in every step of the same sizes. While a scheme makes steps, the memory
//! of a list that is dropped is kept for the next one of its size. After the first steps the system is not asked for
//! memory any more. Finite element libraries hand out work vectors from such a store; here a list takes its memory from
//! it and gives it back by itself.

use std::any::{Any, TypeId};
use std::collections::BTreeMap;
use std::fmt::{self, Debug};
use std::mem::take;
use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::iter::{
    FromParallelIterator, IntoParallelIterator, IntoParallelRefIterator, ParallelExtend, ParallelIterator,
};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A [`Vec`] whose memory is kept for the next list of its size, as long as some [`Keeping`] lives.
///
/// ```
/// use amontons::list::List;
///
/// let squares: List<f64> = [1.0, 2.0].into_iter().map(|x| x * x).collect();
/// assert_eq!(squares, [1.0, 4.0]);
/// ```
pub struct List<T: Send + 'static>(Vec<T>);

/// The memory of lists is kept as long as a value of this type lives.
#[derive(Debug)]
pub struct Keeping(());

/// The memory that is kept.
struct Store {
    /// How many [`Keeping`]s live.
    keeping: usize,
    /// A `Vec<Vec<T>>` for each type T, by their capacities.
    lists: BTreeMap<TypeId, Box<dyn Any + Send>>,
}

static STORE: Mutex<Store> = Mutex::new(Store { keeping: 0, lists: BTreeMap::new() });

/// Least room of a list.
const LEAST: usize = 4;

/// The room that a list takes for so many entries, in steps of an eighth to a quarter: lists that grow a little from
/// step to step have the same one.
fn rounded(room: usize) -> usize {
    let step = (room.checked_next_power_of_two().unwrap_or(room) / 8).max(1);
    room.checked_next_multiple_of(step).unwrap_or(room).max(LEAST)
}

impl Store {
    fn lock() -> MutexGuard<'static, Store> {
        STORE.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The lists of a type; none where none are kept.
    fn of<T: Send + 'static>(&mut self) -> Option<&mut Vec<Vec<T>>> {
        if self.keeping == 0 {
            return None;
        }
        let lists = self.lists.entry(TypeId::of::<T>()).or_insert_with(|| Box::new(Vec::<Vec<T>>::new()));
        lists.downcast_mut()
    }
}

impl Keeping {
    /// Begins to keep memory.
    #[must_use]
    pub fn begin() -> Keeping {
        Store::lock().keeping += 1;
        Keeping(())
    }
}

impl Drop for Keeping {
    fn drop(&mut self) {
        let is_last = {
            let mut store = Store::lock();
            store.keeping -= 1;
            store.keeping == 0
        };
        if is_last {
            give_back();
        }
    }
}

/// Gives the memory that is kept back to the system, as before work that needs other memory.
pub fn give_back() {
    let lists = take(&mut Store::lock().lists);
    drop(lists);
}

impl<T: Send + 'static> Drop for List<T> {
    fn drop(&mut self) {
        // Entries of no size have no memory.
        if self.0.capacity() == 0 || size_of::<T>() == 0 {
            return;
        }
        // Before the store is locked: entries may be lists.
        if std::mem::needs_drop::<T>() {
            self.0.clear();
        }
        let mut store = Store::lock();
        if let Some(lists) = store.of() {
            let place = lists.partition_point(|list| list.capacity() < self.0.capacity());
            lists.insert(place, take(&mut self.0));
        }
    }
}

impl<T: Send + 'static> List<T> {
    /// A list without entries.
    #[must_use]
    pub const fn new() -> List<T> {
        List(Vec::new())
    }

    /// A list without entries, with room for so many.
    #[must_use]
    pub fn with_capacity(room: usize) -> List<T> {
        if room == 0 {
            return List::new();
        }
        let mut list = List::kept(room).unwrap_or_else(|| List(Vec::with_capacity(rounded(room))));
        list.0.clear();
        list
    }

    /// Makes room for so many more entries. A list that outgrows its memory takes a larger one from the store, too.
    pub fn reserve(&mut self, more: usize) {
        let room = self.len().saturating_add(more);
        if room > self.0.capacity() {
            let mut larger = List::with_capacity(room.max(2 * self.0.capacity()));
            larger.0.append(&mut self.0);
            *self = larger;
        }
    }

    /// Adds an entry at the end.
    pub fn push(&mut self, entry: T) {
        self.reserve(1);
        self.0.push(entry);
    }

    /// Adds an entry before the one that has this place.
    ///
    /// # Panics
    /// Where the place is behind the end.
    pub fn insert(&mut self, place: usize, entry: T) {
        self.reserve(1);
        self.0.insert(place, entry);
    }

    /// Takes the last entry off.
    pub fn pop(&mut self) -> Option<T> {
        self.0.pop()
    }

    /// Takes an entry out; those behind it move up.
    ///
    /// # Panics
    /// Where there is no such entry.
    pub fn remove(&mut self, place: usize) -> T {
        self.0.remove(place)
    }

    /// Takes out the entries that are not to be kept.
    pub fn retain(&mut self, keep: impl FnMut(&T) -> bool) {
        self.0.retain(keep);
    }

    /// A list that was kept with room for so many entries, with entries that it had.
    fn kept(room: usize) -> Option<List<T>> {
        let mut store = Store::lock();
        let lists = store.of::<T>()?;
        let place = lists.partition_point(|list| list.capacity() < room);
        // No more than a quarter larger: what is twice as large is asked for again.
        let most = rounded(room.saturating_add(room / 4));
        (lists.get(place)?.capacity() <= most).then(|| List(lists.remove(place)))
    }
}

impl<T: Clone + Send + 'static> List<T> {
    /// A list of so many entries of the same value.
    #[must_use]
    pub fn filled(value: T, count: usize) -> List<T> {
        let mut list = List::with_capacity(count);
        list.resize(count, value);
        list
    }

    /// A list with these entries.
    #[must_use]
    pub fn copied(entries: &[T]) -> List<T> {
        let mut list = List::new();
        list.extend_from_slice(entries);
        list
    }

    /// Adds these entries at the end.
    pub fn extend_from_slice(&mut self, entries: &[T]) {
        self.reserve(entries.len());
        self.0.extend_from_slice(entries);
    }

    /// Takes the last entries off, or adds some of this value, until there are so many.
    pub fn resize(&mut self, count: usize, value: T) {
        self.reserve(count.saturating_sub(self.len()));
        self.0.resize(count, value);
    }
}

impl List<f64> {
    /// A list of so many numbers, whatever they are: the caller writes all of them.
    pub(crate) fn to_be_written(count: usize) -> List<f64> {
        let mut list = List::kept(count).unwrap_or_else(|| List(vec![0.0; rounded(count)]));
        list.0.resize(count, 0.0);
        list
    }
}

impl<T: Send + 'static> Default for List<T> {
    fn default() -> List<T> {
        List::new()
    }
}

impl<T: Send + 'static> Deref for List<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.0
    }
}

impl<T: Send + 'static> DerefMut for List<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.0
    }
}

impl<T: Send + 'static> AsRef<[T]> for List<T> {
    fn as_ref(&self) -> &[T] {
        &self.0
    }
}

impl<T: Debug + Send + 'static> Debug for List<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl<T: Clone + Send + 'static> Clone for List<T> {
    fn clone(&self) -> List<T> {
        List::copied(self)
    }

    fn clone_from(&mut self, from: &List<T>) {
        self.reserve(from.len().saturating_sub(self.len()));
        self.0.clone_from(&from.0);
    }
}

impl<T: PartialEq + Send + 'static, V: AsRef<[T]>> PartialEq<V> for List<T> {
    fn eq(&self, other: &V) -> bool {
        self.0 == other.as_ref()
    }
}

/// The entries move: memory that is not of the store would come to it with every list that is made so.
impl<T: Send + 'static> From<Vec<T>> for List<T> {
    fn from(mut entries: Vec<T>) -> List<T> {
        let mut list = List::with_capacity(entries.len());
        list.0.append(&mut entries);
        list
    }
}

impl<T: Send + 'static> From<List<T>> for Vec<T> {
    fn from(mut list: List<T>) -> Vec<T> {
        take(&mut list.0)
    }
}

impl<T: Send + 'static> Extend<T> for List<T> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, entries: I) {
        let entries = entries.into_iter();
        let (least, most) = entries.size_hint();
        self.reserve(least);
        if most == Some(least) {
            self.0.extend(entries);
        } else {
            entries.for_each(|entry| self.push(entry));
        }
    }
}

impl<T: Send + 'static> FromIterator<T> for List<T> {
    fn from_iter<I: IntoIterator<Item = T>>(entries: I) -> List<T> {
        let mut list = List::new();
        list.extend(entries);
        list
    }
}

impl<T: Send + 'static> FromParallelIterator<T> for List<T> {
    fn from_par_iter<I: IntoParallelIterator<Item = T>>(entries: I) -> List<T> {
        let entries = entries.into_par_iter();
        let Some(count) = entries.opt_len() else { return entries.collect::<Vec<T>>().into() };
        let mut list = List::with_capacity(count);
        list.0.par_extend(entries);
        list
    }
}

/// The iterator that takes the entries out of a list, from the first to the last.
#[derive(Debug)]
pub struct Entries<T: Send + 'static>(List<T>);

impl<T: Send + 'static> Iterator for Entries<T> {
    type Item = T;

    fn next(&mut self) -> Option<T> {
        self.0.pop()
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.0.len(), Some(self.0.len()))
    }
}

impl<T: Send + 'static> ExactSizeIterator for Entries<T> {}

impl<T: Send + 'static> IntoIterator for List<T> {
    type Item = T;
    type IntoIter = Entries<T>;

    fn into_iter(mut self) -> Entries<T> {
        // The last entry is the next one.
        self.reverse();
        Entries(self)
    }
}

impl<'a, T: Send + 'static> IntoIterator for &'a List<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> std::slice::Iter<'a, T> {
        self.0.iter()
    }
}

impl<'a, T: Send + Sync + 'static> IntoParallelIterator for &'a List<T> {
    type Item = &'a T;
    type Iter = rayon::slice::Iter<'a, T>;

    fn into_par_iter(self) -> rayon::slice::Iter<'a, T> {
        self.0.par_iter()
    }
}

impl<'a, T: Send + 'static> IntoIterator for &'a mut List<T> {
    type Item = &'a mut T;
    type IntoIter = std::slice::IterMut<'a, T>;

    fn into_iter(self) -> std::slice::IterMut<'a, T> {
        self.0.iter_mut()
    }
}

impl<T: Serialize + Send + 'static> Serialize for List<T> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(to)
    }
}

impl<'de, T: Deserialize<'de> + Send + 'static> Deserialize<'de> for List<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<List<T>, D::Error> {
        Vec::deserialize(from).map(List::from)
    }
}

/// Entries that are borrowed, or a list of their own once they are changed: what [`std::borrow::Cow`] is for a `Vec`.
#[derive(Debug)]
pub enum Lent<'a, T: Send + 'static> {
    /// Borrowed entries.
    Given(&'a [T]),
    /// A list of their own.
    Own(List<T>),
}

impl<T: Clone + Send + 'static> Lent<'_, T> {
    /// The entries to be changed: a copy of those that are given.
    pub fn to_mut(&mut self) -> &mut [T] {
        if let Lent::Given(entries) = self {
            *self = Lent::Own(List::copied(entries));
        }
        match self {
            Lent::Own(entries) => entries,
            Lent::Given(_) => &mut [],
        }
    }
}

impl<T: Send + 'static> Deref for Lent<'_, T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        match self {
            Lent::Given(entries) => entries,
            Lent::Own(entries) => entries,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many lists of a type are kept.
    fn kept<T: Send + 'static>() -> usize {
        Store::lock().of::<T>().map_or(0, |lists| lists.len())
    }

    /// Types of its own, so that the other tests of the program have no lists of it.
    #[test]
    fn memory_that_is_done_with_is_that_of_the_next_list() {
        #[derive(Clone, Copy, Debug, PartialEq)]
        struct Entry(u64);
        let _keeping = Keeping::begin();
        let list = List::filled(Entry(1), 1000);
        let place = list.as_ptr();
        drop(list);
        // Of a little less, and of a little more that fits.
        let list: List<Entry> = (0..990).map(Entry).collect();
        assert!(list.as_ptr() == place && list.len() == 990 && list[989] == Entry(989));
        assert_eq!(kept::<Entry>(), 0);
        drop(list);
        // Not of far less, which would have large memory in vain, and not of more.
        let [few, many] = [List::filled(Entry(2), 400), List::filled(Entry(2), 1500)];
        assert!(few.as_ptr() != place && many.as_ptr() != place && kept::<Entry>() == 1);
        assert_eq!(List::copied(&few), few);
    }

    /// However lists are made, and however they grow: memory does not pile up.
    #[test]
    fn as_many_lists_are_kept_as_there_were_at_once() {
        #[derive(Clone, Debug, PartialEq)]
        struct Entry(usize);
        let _keeping = Keeping::begin();
        let mut most = 0;
        for round in 0..200 {
            let mut pushed = List::new();
            (0..70).for_each(|i| pushed.push(Entry(i)));
            let mut found: List<Entry> = (0..9).flat_map(|i| (0..i).map(Entry)).collect();
            found.extend_from_slice(&pushed);
            let given: List<Entry> = vec![Entry(round); 33].into();
            let in_parallel: List<Entry> = (0..90).into_par_iter().filter(|i| i % 2 == 0).map(Entry).collect();
            assert_eq!((pushed.len(), found.len(), given.len(), in_parallel.len()), (70, 106, 33, 45));
            assert!(in_parallel.into_iter().map(|Entry(i)| i).eq((0..90).step_by(2)));
            // Lists of lists.
            let mut lists = List::filled(pushed, 3);
            lists.retain(|list| list.len() == 70);
            assert!(lists.pop().is_some_and(|list| list.last() == Some(&Entry(69))));
            drop((found, given, lists));
            if round == 20 {
                most = kept::<Entry>();
            }
        }
        assert!(most > 0 && kept::<Entry>() == most, "{most} and {}", kept::<Entry>());
    }

    /// Sizes that rise from step to step, as of a pattern that spreads, find the memory of a little smaller ones.
    #[test]
    fn sizes_that_rise_take_little_memory_anew() {
        #[derive(Clone, Debug)]
        struct Entry;
        let _keeping = Keeping::begin();
        let rooms: Vec<usize> = (1..10_000).map(|count| List::filled([0u16; 3], count).0.capacity()).collect();
        assert!(rooms.iter().zip(1..).all(|(room, count)| (count..count + count / 4 + 4).contains(room)));
        assert!(rooms.chunk_by(usize::eq).count() < 70);
        // Entries without a size take none.
        (0..9).for_each(|_| drop(List::filled(Entry, 5)));
        assert_eq!(kept::<Entry>(), 0);
    }

    /// Numbers that are to be written may be any; all others are what they are said to be.
    #[test]
    fn entries_before_are_not_seen() {
        let _keeping = Keeping::begin();
        drop(List::filled(f64::NAN, 777));
        assert_eq!(List::to_be_written(770).len(), 770);
        drop(List::filled(f64::NAN, 777));
        assert!(List::filled(1.0, 770).iter().all(|entry| *entry > 0.5));
        assert!(List::<f64>::with_capacity(770).is_empty());
        let mut lent = Lent::Given(&[1.0, 2.0]);
        lent.to_mut()[0] = 3.0;
        assert_eq!(*lent, [3.0, 2.0]);
    }
}
