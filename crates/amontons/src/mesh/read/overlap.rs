//! Regions of cells in several groups: a material belongs to one region.
//!
//! A cell is in the region of its smallest group if that lies within its other groups: of "all" and "soft" within it,
//! "soft" keeps its name and "all" is the rest. If two groups only overlap, their common cells form a region with both
//! names, "left+upper". Of groups with the same cells the first counts.

use std::collections::{BTreeMap, BTreeSet};

use super::{Skipped, listed};

/// Assignment of cells in several groups to regions.
pub(super) struct Overlap {
    /// Names of the groups, and of the additional regions.
    names: Vec<String>,
    /// The region of each combination of groups: its index among the names, and its number of cells.
    of: BTreeMap<BTreeSet<usize>, (usize, usize)>,
    /// Indices of the names that are regions, in order.
    used: Vec<usize>,
}

impl Overlap {
    /// Assigns regions from the names of groups and the number of cells per combination of groups. Cells without a
    /// group are in the first region.
    pub fn new(names: Vec<String>, cells: impl Iterator<Item = (BTreeSet<usize>, usize)>) -> Overlap {
        let mut of: BTreeMap<BTreeSet<usize>, (usize, usize)> = BTreeMap::new();
        for (groups, count) in cells {
            of.entry(groups).or_insert((0, 0)).1 += count;
        }
        let mut sizes = vec![0; names.len()];
        for (groups, (_, count)) in &of {
            for &group in groups {
                sizes[group] += count;
            }
        }
        let smallest = |groups: &BTreeSet<usize>| groups.iter().copied().min_by_key(|&group| sizes[group]);
        let within = within(&of, &smallest);
        let mut overlap = Overlap { names, of: BTreeMap::new(), used: Vec::new() };
        for (groups, (_, count)) in &of {
            let first = smallest(groups).unwrap_or(0);
            let nested = within.get(&first).is_none_or(|within| groups.is_subset(within));
            let region = if nested { first } else { overlap.joined(groups) };
            overlap.of.insert(groups.clone(), (region, *count));
        }
        let used: BTreeSet<usize> = overlap.of.values().map(|(region, _)| *region).collect();
        overlap.used = used.into_iter().collect();
        overlap
    }

    /// The index of the region with the joined names of these groups.
    fn joined(&mut self, groups: &BTreeSet<usize>) -> usize {
        let names: Vec<&str> = groups.iter().filter_map(|&group| self.names.get(group)).map(String::as_str).collect();
        let name = names.join("+");
        self.names.iter().position(|other| *other == name).unwrap_or_else(|| {
            self.names.push(name);
            self.names.len() - 1
        })
    }

    /// The number of the region of cells in these groups.
    pub fn region(&self, groups: &BTreeSet<usize>) -> usize {
        let place = self.of.get(groups).map_or(0, |(region, _)| *region);
        self.used.binary_search(&place).unwrap_or(0)
    }

    /// The assignments of cells in several groups, in words.
    pub fn told(&self) -> Vec<Skipped> {
        let several = self.of.iter().filter(|(groups, _)| groups.len() > 1);
        let told = |(groups, (region, count)): (&BTreeSet<usize>, &(usize, usize))| {
            let names = listed(groups.iter().filter_map(|&group| self.names.get(group)));
            let region = self.names.get(*region).map_or("", String::as_str);
            let what = format!("groups beside one of cells in {names}: these are in the region {region:?}");
            Skipped { what, file: None, line: None, count: *count }
        };
        several.map(told).collect()
    }

    /// The names of the regions.
    pub fn into_regions(self) -> Vec<String> {
        let names = self.names;
        self.used.iter().filter_map(|&place| names.get(place).cloned()).collect()
    }
}

/// For each group that is the smallest of a combination: the groups that contain all its cells.
fn within(
    of: &BTreeMap<BTreeSet<usize>, (usize, usize)>,
    smallest: &impl Fn(&BTreeSet<usize>) -> Option<usize>,
) -> BTreeMap<usize, BTreeSet<usize>> {
    let several: Vec<&BTreeSet<usize>> = of.keys().filter(|groups| groups.len() > 1).collect();
    let wanted: BTreeSet<usize> = several.iter().filter_map(|groups| smallest(groups)).collect();
    let mut within: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    // Combinations of few groups come first, so that intersections stay short.
    let mut all: Vec<&BTreeSet<usize>> = of.keys().collect();
    all.sort_by_key(|groups| groups.len());
    for groups in all {
        for &group in groups.iter().filter(|group| wanted.contains(group)) {
            within
                .entry(group)
                .and_modify(|common| common.retain(|other| groups.contains(other)))
                .or_insert_with(|| groups.clone());
        }
    }
    within
}
