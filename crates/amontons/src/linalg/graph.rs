//! The graph of the nodes of a mesh.

use std::collections::BTreeMap;

use crate::mesh::{Link, Mesh};
use crate::space::RigidNodes;

/// Node adjacency by shared cells: compressed rows, columns ascending, the node itself included.
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    pub(super) start: Vec<usize>,
    pub(super) columns: Vec<u32>,
}

impl Graph {
    /// The graph of pairs of nodes that are coupled, each with itself and in both orders.
    #[must_use]
    pub fn of_pairs(nodes: usize, pairs: impl IntoIterator<Item = (u32, u32)>) -> Graph {
        let mut all: Vec<(u32, u32)> = pairs.into_iter().flat_map(|(i, j)| [(i, j), (j, i)]).collect();
        all.extend((0..nodes as u32).map(|i| (i, i)));
        all.sort_unstable();
        all.dedup();
        let mut start = vec![0; nodes + 1];
        for (i, _) in &all {
            start[*i as usize + 1] += 1;
        }
        for i in 0..nodes {
            start[i + 1] += start[i];
        }
        Graph { start, columns: all.into_iter().map(|(_, j)| j).collect() }
    }

    /// The graph of the nodes of a mesh.
    #[must_use]
    pub fn of_mesh(mesh: &Mesh) -> Graph {
        let n = mesh.points.len();
        let mut count = vec![0usize; n + 1];
        for block in &mesh.blocks {
            for cell in block.cells() {
                for &a in cell {
                    count[a as usize + 1] += cell.len();
                }
            }
        }
        for i in 0..n {
            count[i + 1] += count[i];
        }
        let mut filled = count.clone();
        let mut pairs = vec![0u32; count[n]];
        for block in &mesh.blocks {
            for cell in block.cells() {
                for &a in cell {
                    for &b in cell {
                        pairs[filled[a as usize]] = b;
                        filled[a as usize] += 1;
                    }
                }
            }
        }
        let (mut start, mut columns) = (vec![0], Vec::new());
        for i in 0..n {
            let row = &mut pairs[count[i]..count[i + 1]];
            row.sort_unstable();
            for (k, &c) in row.iter().enumerate() {
                if k == 0 || row[k - 1] != c {
                    columns.push(c);
                }
            }
            start.push(columns.len());
        }
        Graph { start, columns }
    }

    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.start.len() - 1
    }

    /// Number of pairs of nodes that share a cell.
    #[must_use]
    pub fn pairs(&self) -> usize {
        self.columns.len()
    }

    /// True if there are no nodes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The nodes that share a cell with node `i`, itself included, ascending.
    #[must_use]
    pub fn row(&self, i: usize) -> &[u32] {
        &self.columns[self.start[i]..self.start[i + 1]]
    }

    /// The graph with more neighbours of some nodes.
    #[must_use]
    pub(super) fn and(&self, more: &BTreeMap<u32, Vec<u32>>) -> Graph {
        let (mut start, mut columns) = (vec![0], Vec::with_capacity(self.columns.len()));
        for i in 0..self.len() {
            let first = columns.len();
            columns.extend_from_slice(self.row(i));
            if let Some(more) = more.get(&(i as u32)) {
                columns.extend_from_slice(more);
                columns[first..].sort_unstable();
                let mut last = first;
                for at in first + 1..columns.len() {
                    if columns[at] != columns[last] {
                        last += 1;
                        columns[last] = columns[at];
                    }
                }
                columns.truncate(last + 1);
            }
            start.push(columns.len());
        }
        Graph { start, columns }
    }

    /// The graph with each following node merged into the node that it follows. The row of a following node contains
    /// itself only.
    #[must_use]
    pub fn linked(&self, links: &[Link]) -> Graph {
        let leaders = leaders(self.len(), links);
        let mut rows: Vec<(u32, Vec<u32>)> = Vec::new();
        for link in links {
            let row = self.row(link.node as usize).iter().map(|&j| leaders[j as usize]).collect();
            rows.push((link.to, row));
        }
        rows.sort_by_key(|(node, _)| *node);
        let (mut start, mut columns, mut row) = (vec![0], Vec::with_capacity(self.columns.len()), Vec::new());
        for i in 0..self.len() {
            row.clear();
            if leaders[i] as usize == i {
                row.extend(self.row(i).iter().map(|&j| leaders[j as usize]));
                let from = rows.partition_point(|(node, _)| (*node as usize) < i);
                let followed = rows[from..].iter().take_while(|(node, _)| *node as usize == i);
                followed.for_each(|(_, more)| row.extend(more));
            } else {
                row.push(i as u32);
            }
            row.sort_unstable();
            row.dedup();
            columns.extend_from_slice(&row);
            start.push(columns.len());
        }
        Graph { start, columns }
    }

    /// The graph with the nodes of each rigid body replaced by the nodes that hold its motions. The rows of its other
    /// nodes contain themselves only.
    #[must_use]
    pub fn rigid(&self, rigid: &[RigidNodes]) -> Graph {
        let body_of = bodies(self.len(), rigid);
        let seen = |j: u32, row: &mut Vec<u32>| match body_of[j as usize] {
            Some(body) => row.extend(rigid[body as usize].slots()),
            None => row.push(j),
        };
        let of_body = |body: &RigidNodes| {
            let mut row: Vec<u32> = Vec::new();
            for &node in &body.nodes {
                self.row(node as usize).iter().for_each(|&j| seen(j, &mut row));
            }
            row.sort_unstable();
            row.dedup();
            row
        };
        let of_bodies: Vec<Vec<u32>> = rigid.iter().map(of_body).collect();
        let (mut start, mut columns, mut row) = (vec![0], Vec::with_capacity(self.columns.len()), Vec::new());
        for (i, body) in body_of.iter().enumerate() {
            row.clear();
            match body.map(|body| body as usize) {
                Some(body) if rigid[body].slots().contains(&(i as u32)) => row.extend_from_slice(&of_bodies[body]),
                Some(_) => row.push(i as u32),
                None => self.row(i).iter().for_each(|&j| seen(j, &mut row)),
            }
            row.sort_unstable();
            row.dedup();
            columns.extend_from_slice(&row);
            start.push(columns.len());
        }
        Graph { start, columns }
    }

    /// Position of the pair (i, j) among all pairs, or `None` if they share no cell.
    pub(super) fn slot(&self, i: usize, j: u32) -> Option<usize> {
        self.row(i).binary_search(&j).ok().map(|k| self.start[i] + k)
    }
}

/// Number of the rigid body per node, or `None` if the node belongs to none.
pub(super) fn bodies(nodes: usize, rigid: &[RigidNodes]) -> Vec<Option<u32>> {
    let mut bodies = vec![None; nodes];
    for (number, body) in (0..).zip(rigid) {
        body.nodes.iter().for_each(|&node| bodies[node as usize] = Some(number));
    }
    bodies
}

/// Node that each node follows, or itself.
pub(super) fn leaders(nodes: usize, links: &[Link]) -> Vec<u32> {
    let mut leaders: Vec<u32> = (0..nodes as u32).collect();
    for link in links {
        leaders[link.node as usize] = link.to;
    }
    leaders
}
