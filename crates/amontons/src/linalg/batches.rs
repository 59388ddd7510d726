//! Subtrees of the elimination tree that repeat, side by side.
//!
//! On a uniform mesh most small subtrees have the same numbers at the same places. A sweep takes several of them at
//! once, an entry of each in the lanes of a vector: a number of the factor is read once for all, and columns that are
//! too short to be worked on as vectors need not be.
#![allow(clippy::inline_always, reason = "a loop is compiled for the vector instructions of the function it is in")]

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use super::panel::{LANES, Lanes, Panel, Rows, Run, Value};

/// Most columns of a subtree: its entries in all lanes fit into the second-level cache.
const MOST: usize = 512;
/// Fewest lanes to fill: with fewer subtrees, one after the other is faster.
const LEAST: usize = LANES / 2;

/// Subtrees that are the same.
#[derive(Debug)]
pub(super) struct Batch {
    /// Their panels, on a vector of the columns of a subtree and the rows below it.
    panels: Vec<Panel>,
    /// The rows below the panels one by one: an entry of each of several vectors fills a line of memory by itself.
    rows: Vec<u32>,
    columns: usize,
    places: Vec<Place>,
    /// The rows below the subtrees.
    below: Vec<Run>,
}

/// Where a subtree stands in the vector of its task: its first column, and the rows below in the list of its batch.
#[derive(Debug)]
struct Place {
    first: usize,
    below: Range<usize>,
}

/// Vectors that a sweep works in.
#[derive(Default)]
pub(super) struct Workspace {
    /// The entries that a panel of one vector sees.
    pub of_one: Vec<f64>,
    /// The vectors of subtrees side by side, and the entries that a panel of them sees.
    local: Vec<Lanes>,
    dense: Vec<Lanes>,
}

impl Workspace {
    /// Without memory.
    pub const fn new() -> Workspace {
        Workspace { of_one: Vec::new(), local: Vec::new(), dense: Vec::new() }
    }
}

impl Batch {
    /// Columns of all the subtrees.
    #[cfg(test)]
    pub fn all_columns(&self) -> usize {
        self.columns * self.places.len()
    }

    /// Solves L y = r on the columns of the subtrees, and adds what they take from the rows below.
    #[inline(always)]
    pub fn forward(&self, values: &[f64], vector: &mut [f64], Workspace { local, dense, .. }: &mut Workspace) {
        for places in self.places.chunks(LANES) {
            self.enter(places, vector, local);
            for panel in &self.panels {
                panel.forward(panel.values(values), &self.rows, local, dense);
            }
            self.leave(places, local, vector);
            for (l, place) in places.iter().enumerate() {
                let mut below = local[self.columns..].iter();
                for rows in &self.below[place.below.clone()] {
                    for (entry, local) in vector[rows.range()].iter_mut().zip(&mut below) {
                        *entry += local.0[l];
                    }
                }
            }
        }
    }

    /// Solves Lᵀ x = y on the columns of the subtrees with the rows below known.
    #[inline(always)]
    pub fn backward(&self, values: &[f64], vector: &mut [f64], Workspace { local, dense, .. }: &mut Workspace) {
        for places in self.places.chunks(LANES) {
            self.enter(places, vector, local);
            for (l, place) in places.iter().enumerate() {
                let mut below = local[self.columns..].iter_mut();
                for rows in &self.below[place.below.clone()] {
                    for (entry, local) in vector[rows.range()].iter().zip(&mut below) {
                        local.0[l] = *entry;
                    }
                }
            }
            for panel in self.panels.iter().rev() {
                panel.backward(panel.values(values), &self.rows, local, dense);
            }
            self.leave(places, local, vector);
        }
    }

    /// Takes the entries at the columns, and zero below and in lanes without a place.
    #[inline(always)]
    fn enter(&self, places: &[Place], vector: &[f64], local: &mut Vec<Lanes>) {
        let below = self.panels.last().map_or(0, |panel| panel.below.len());
        local.clear();
        local.resize(self.columns + below, Lanes::ZERO);
        for (l, place) in places.iter().enumerate() {
            for (local, entry) in local.iter_mut().zip(&vector[place.first..][..self.columns]) {
                local.0[l] = *entry;
            }
        }
    }

    /// Puts the entries at the columns back.
    #[inline(always)]
    fn leave(&self, places: &[Place], local: &[Lanes], vector: &mut [f64]) {
        for (l, place) in places.iter().enumerate() {
            for (entry, local) in vector[place.first..][..self.columns].iter_mut().zip(local) {
                *entry = local.0[l];
            }
        }
    }
}

/// What makes two subtrees the same: columns, rows and place of the numbers of the last panel; and for each subtree
/// below it the kind, the first column, and the rows below, counted in the vector of the whole subtree.
#[derive(PartialEq, Eq, Hash)]
struct Kind {
    panel: [usize; 3],
    children: Vec<(usize, usize, Vec<u32>)>,
}

/// The subtrees of a task: number p consists of panel p and all panels below it in the elimination tree.
struct Subtrees<'a> {
    panels: &'a [Panel],
    rows: &'a [Run],
    parent: Vec<Option<usize>>,
    children: Vec<Vec<usize>>,
    /// First panel and first column of each subtree.
    first: Vec<usize>,
    begin: Vec<usize>,
    /// Equal numbers for subtrees that are the same; none for a subtree with more than [`MOST`] columns.
    kind: Vec<Option<usize>>,
}

impl<'a> Subtrees<'a> {
    /// On a vector whose first `own` entries are columns of the panels.
    fn new(panels: &'a [Panel], rows: &'a [Run], own: usize) -> Subtrees<'a> {
        let mut owner = vec![0; own];
        for (p, panel) in panels.iter().enumerate() {
            owner[panel.first..panel.first + panel.columns].fill(p);
        }
        let parent = |panel: &Panel| {
            let row = Run::positions(&rows[panel.below.clone()]).next()?;
            owner.get(row as usize).copied()
        };
        let count = panels.len();
        let mut trees = Subtrees {
            panels,
            rows,
            parent: panels.iter().map(parent).collect(),
            children: vec![Vec::new(); count],
            first: (0..count).collect(),
            begin: panels.iter().map(|panel| panel.first).collect(),
            kind: Vec::with_capacity(count),
        };
        let mut kinds = HashMap::new();
        for p in 0..count {
            let kind = trees.kind_of(p).map(|kind| {
                let next = kinds.len();
                *kinds.entry(kind).or_insert(next)
            });
            trees.kind.push(kind);
            if let Some(parent) = trees.parent[p] {
                trees.children[parent].push(p);
                trees.first[parent] = trees.first[parent].min(trees.first[p]);
                trees.begin[parent] = trees.begin[parent].min(trees.begin[p]);
            }
        }
        trees
    }

    /// The rows below a subtree.
    fn below(&self, p: usize) -> impl Iterator<Item = u32> {
        Run::positions(&self.rows[self.panels[p].below.clone()])
    }

    /// Where the columns of a subtree end.
    fn end(&self, p: usize) -> usize {
        self.panels[p].first + self.panels[p].columns
    }

    fn columns(&self, p: usize) -> usize {
        self.end(p) - self.begin[p]
    }

    /// The description of a subtree by which others are compared with it. The subtrees below it have their kinds.
    fn kind_of(&self, p: usize) -> Option<Kind> {
        let panel = &self.panels[p];
        // The columns of a subtree follow each other.
        let all = panel.columns + self.children[p].iter().map(|&child| self.columns(child)).sum::<usize>();
        if all > MOST || all != self.columns(p) {
            return None;
        }
        let rows: Vec<u32> = self.below(p).collect();
        let child = |&child: &usize| {
            Some((self.kind[child]?, self.begin[child] - self.begin[p], self.rows_in(child, p, &rows)?))
        };
        let children = self.children[p].iter().map(child).collect::<Option<_>>()?;
        Some(Kind { panel: [panel.columns, panel.leading, panel.values], children })
    }

    /// The rows below a panel in the vector of the subtree of `p`, below which are `rows`.
    fn rows_in(&self, panel: usize, p: usize, rows: &[u32]) -> Option<Vec<u32>> {
        let (begin, end) = (self.begin[p] as u32, self.end(p) as u32);
        let place = |row: u32| {
            if row < end {
                row.checked_sub(begin)
            } else {
                rows.binary_search(&row).ok().map(|k| end - begin + k as u32)
            }
        };
        self.below(panel).map(place).collect()
    }

    /// The panels of the subtree of `p` on its own vector, and the rows below them.
    fn panels_of(&self, p: usize) -> Option<(Vec<Panel>, Vec<u32>)> {
        let (below, mut rows): (Vec<u32>, _) = (self.below(p).collect(), Vec::new());
        let of = |q: usize| {
            let (panel, begin) = (&self.panels[q], rows.len());
            rows.extend(self.rows_in(q, p, &below)?);
            Some(Panel { first: panel.first - self.begin[p], below: begin..rows.len(), ..panel.clone() })
        };
        let panels = (self.first[p]..=p).map(of).collect::<Option<_>>()?;
        Some((panels, rows))
    }

    /// Subtrees that are the same side by side; none of no subtree.
    fn batch(&self, members: &[usize]) -> Option<Batch> {
        let &first = members.first()?;
        let (panels, rows) = self.panels_of(first)?;
        let mut below = Vec::new();
        let place = |&p: &usize| Place { first: self.begin[p], below: Run::append(self.below(p), &mut below) };
        let places = members.iter().map(place).collect();
        Some(Batch { panels, rows, columns: self.columns(first), places, below })
    }
}

/// Moves the subtrees that repeat from the panels of a task to batches. The vector of the task begins with its `own`
/// columns. The largest subtrees come first; where too few are the same, the subtrees below them are compared.
pub(super) fn batches(panels: &mut Vec<Panel>, rows: &mut Vec<Run>, own: usize) -> Vec<Batch> {
    let trees = Subtrees::new(panels, rows, own);
    let mut is_taken = vec![false; panels.len()];
    let is_largest = |p: &usize| trees.kind[*p].is_some() && trees.parent[*p].is_none_or(|p| trees.kind[p].is_none());
    let (mut batches, mut open): (Vec<Batch>, Vec<usize>) =
        (Vec::new(), (0..panels.len()).filter(is_largest).collect());
    while !open.is_empty() {
        let mut alike: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
        for p in open.drain(..) {
            alike.entry(trees.kind[p]).or_default().push(p);
        }
        for mut members in alike.into_values() {
            let over = members.len() % LANES;
            let rest = if over < LEAST { members.split_off(members.len() - over) } else { Vec::new() };
            if let Some(batch) = trees.batch(&members) {
                batches.push(batch);
                for p in members {
                    is_taken[trees.first[p]..=p].fill(true);
                }
            }
            open.extend(rest.iter().flat_map(|&p| &trees.children[p]));
        }
    }
    let mut left = Vec::new();
    let stays = |(panel, is_taken): (&Panel, bool)| {
        let below = Run::positions(&rows[panel.below.clone()]);
        (!is_taken).then(|| Panel { below: Run::append(below, &mut left), ..panel.clone() })
    };
    *panels = panels.iter().zip(is_taken).filter_map(stays).collect();
    *rows = left;
    batches
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Subtrees of a column and two columns above it, with the same numbers, in which the first column has its row in
    /// one or the other of the two: L y = r and Lᵀ x = y hold by the entries of L.
    #[test]
    fn subtrees_whose_rows_differ_are_different() {
        let (count, values) = (2 * LANES, [2.0, 0.5, 4.0, 0.25, 8.0]);
        let row = |s: usize| 3 * s + 1 + s % 2;
        let (mut panels, mut rows) = (Vec::new(), Vec::new());
        for first in (0..count).map(|s| 3 * s) {
            let below = Run::append([row(first / 3) as u32], &mut rows);
            panels.push(Panel { first, columns: 1, below, values: 0, leading: 2 });
            panels.push(Panel { first: first + 1, columns: 2, below: 0..0, values: 2, leading: 2 });
        }
        let found = batches(&mut panels, &mut rows, 3 * count);
        assert!(panels.is_empty() && found.iter().map(|batch| batch.places.len()).eq([LANES, LANES]));
        let r: Vec<f64> = (0..3 * count).map(|i| (i as f64).sin()).collect();
        let (mut x, mut workspace) = (r.clone(), Workspace::new());
        for batch in &found {
            batch.forward(&values, &mut x, &mut workspace);
        }
        let y = x.clone();
        for batch in &found {
            batch.backward(&values, &mut x, &mut workspace);
        }
        let is_near = |a: f64, b: f64| (a - b).abs() < 1e-15;
        for s in 0..count {
            let [i, j, k] = [3 * s, 3 * s + 1, 3 * s + 2];
            let under = |at: usize| if at == row(s) { 0.5 } else { 0.0 };
            assert!(is_near(2.0 * y[i], r[i]) && is_near(under(j) * y[i] + 4.0 * y[j], r[j]), "forward, subtree {s}");
            assert!(is_near(under(k) * y[i] + 0.25 * y[j] + 8.0 * y[k], r[k]), "forward, subtree {s}");
            assert!(is_near(8.0 * x[k], y[k]) && is_near(4.0 * x[j] + 0.25 * x[k], y[j]), "backward, subtree {s}");
            assert!(is_near(2.0 * x[i] + 0.5 * x[row(s)], y[i]), "backward, subtree {s}");
        }
    }
}
