//! The congruence Pᵀ M P of a form on scalars with a sparse map P of nodal values.

use std::collections::BTreeMap;

use super::graph::Graph;
use super::sparse::BlockMatrix;

/// A map of nodal values: the value at some nodes is a sum over other nodes, and all others keep their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodalMap {
    /// The nodes whose values are replaced, ascending.
    pub nodes: Vec<u32>,
    /// For each of them the nodes that it takes its value from, none of them replaced, ascending, with their weights.
    pub from: Vec<Vec<(u32, f64)>>,
}

impl NodalMap {
    /// What the value at a node is a sum of.
    fn row(&self, node: u32) -> Option<&[(u32, f64)]> {
        self.nodes.binary_search(&node).ok().map(|place| self.from[place].as_slice())
    }

    /// The nodes that the values at some nodes are sums of.
    fn columns(&self, row: &[u32]) -> Vec<u32> {
        let mut columns: Vec<u32> = Vec::new();
        for &j in row {
            match self.row(j) {
                Some(from) => columns.extend(from.iter().map(|(b, _)| *b)),
                None => columns.push(j),
            }
        }
        columns.sort_unstable();
        columns.dedup();
        columns
    }

    /// The nodes at which M P has other rows than M: the replaced ones and their neighbours.
    fn touched(&self, graph: &Graph) -> Vec<u32> {
        let mut touched: Vec<u32> = self.nodes.iter().flat_map(|&node| graph.row(node as usize)).copied().collect();
        touched.sort_unstable();
        touched.dedup();
        touched
    }

    /// The graph with the pairs of nodes that Pᵀ M P joins besides those of M.
    #[must_use]
    pub fn joined(&self, graph: &Graph) -> Graph {
        let mut more: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for i in self.touched(graph) {
            let columns = self.columns(graph.row(i as usize));
            let mut add = |a: u32| more.entry(a).or_default().extend_from_slice(&columns);
            match self.row(i) {
                Some(from) => from.iter().for_each(|(a, _)| add(*a)),
                None => add(i),
            }
        }
        graph.and(&more)
    }
}

impl BlockMatrix {
    /// Pᵀ M P of this form M on scalars, whose graph has the pairs that [`NodalMap::joined`] adds. Sums go over nodes
    /// in their order.
    #[must_use]
    pub fn congruent(&self, map: &NodalMap) -> BlockMatrix {
        let mut out = BlockMatrix::zero(self.graph(), 1, 1);
        let touched = map.touched(self.graph());
        for i in 0..self.graph().len() {
            let own = self.row(i).map(|(j, value)| (j as u32, value.first().copied().unwrap_or(0.0)));
            if touched.binary_search(&(i as u32)).is_err() {
                out.add_to_row(i, 1.0, own);
                continue;
            }
            // The row of M P.
            let mut row: BTreeMap<u32, f64> = BTreeMap::new();
            for (j, value) in own {
                match map.row(j) {
                    Some(from) => from.iter().for_each(|(b, weight)| *row.entry(*b).or_default() += value * weight),
                    None => *row.entry(j).or_default() += value,
                }
            }
            let row = || row.iter().map(|(b, value)| (*b, *value));
            match map.row(i as u32) {
                Some(from) => from.iter().for_each(|(a, weight)| out.add_to_row(*a as usize, *weight, row())),
                None => out.add_to_row(i, 1.0, row()),
            }
        }
        out
    }
}
