//! Which process owns which rows: whole nodes, near to one another.
//!
//! The mesh is on every process, so nodes are divided by their positions: the box around them is cut across its longest
//! edge, again and again, into parts with as many blocks of the matrix as there are processes. This takes no library
//! and gives the same parts everywhere.

use amontons::linalg::{BlockMatrix, SolveError};
use amontons::tensor::Point;

use crate::session::Session;
use crate::sys;

/// The rows of a matrix on nodes with `size` degrees of freedom each.
#[derive(Debug)]
pub struct Rows {
    /// Degrees of freedom per node.
    pub size: usize,
    /// Own nodes, ascending.
    pub own: Vec<u32>,
    /// Number of each node in the order of the processes, and the nodes in that order.
    pub number: Vec<i32>,
    order: Vec<u32>,
    /// Number of this process's first node in that order.
    first: i32,
    /// Owner of each node.
    owner: Vec<u32>,
    /// Degrees of freedom per process, and the place of the first.
    counts: Vec<i32>,
    starts: Vec<i32>,
}

impl Rows {
    /// Divides the nodes of a matrix by their positions, or by their numbers if `points` has none.
    pub fn new(session: &Session, matrix: &BlockMatrix, points: &[Point]) -> Rows {
        let (size, _) = matrix.block_shape();
        let graph = matrix.graph();
        let weights: Vec<usize> = (0..graph.len()).map(|node| graph.row(node).len()).collect();
        let mut owner = vec![0; graph.len()];
        let mut nodes: Vec<u32> = (0..graph.len() as u32).collect();
        let points = if points.len() == graph.len() { points } else { &[] };
        divide(&Division { points, weights: &weights }, &mut nodes, [0, session.size()], &mut owner);
        Rows::owned_by(session, owner, size)
    }

    fn owned_by(session: &Session, owner: Vec<u32>, size: usize) -> Rows {
        let mut order: Vec<u32> = (0..owner.len() as u32).collect();
        // Within a process nodes keep their order, which is that of the mesh.
        order.sort_by_key(|node| owner[*node as usize]);
        let mut number = vec![0; owner.len()];
        order.iter().enumerate().for_each(|(k, node)| number[*node as usize] = k as i32);
        let mut counts = vec![0; session.size()];
        for owner in &owner {
            counts[*owner as usize] += size as i32;
        }
        let starts = starts(&counts);
        let first = starts[session.rank()] / size.max(1) as i32;
        let own = order.iter().copied().filter(|node| owner[*node as usize] as usize == session.rank()).collect();
        Rows { size, own, number, order, first, owner, counts, starts }
    }

    /// Number of own rows.
    pub fn len(&self) -> usize {
        self.own.len() * self.size
    }

    /// Number of all rows.
    pub fn all(&self) -> usize {
        self.owner.len() * self.size
    }

    /// True if a node belongs to this process; `node` counts in the order of the processes.
    pub fn has(&self, node: i32) -> bool {
        node >= self.first && node < self.first + self.own.len() as i32
    }

    /// Place of a degree of freedom among the own rows, or `None` if another process has it.
    pub fn place(&self, dof: u32) -> Option<usize> {
        let (node, component) = (dof as usize / self.size, dof as usize % self.size);
        let number = self.number[node];
        self.has(number).then(|| (number - self.first) as usize * self.size + component)
    }

    /// The own entries of a vector over all degrees of freedom.
    pub fn take(&self, full: &[f64]) -> Vec<f64> {
        let of_node = |node: &u32| full[*node as usize * self.size..][..self.size].iter().copied();
        self.own.iter().flat_map(of_node).collect()
    }

    /// A vector over all degrees of freedom from the own entries of all processes.
    pub fn gather(&self, session: &Session, own: &[f64]) -> Result<Vec<f64>, SolveError> {
        let all = session.given(sys::gather(own, &self.counts, &self.starts))?;
        let mut full = vec![0.0; all.len()];
        for (node, values) in self.order.iter().zip(all.chunks_exact(self.size)) {
            full[*node as usize * self.size..][..self.size].copy_from_slice(values);
        }
        Ok(full)
    }
}

/// Some degrees of freedom, whose values every process gets.
#[derive(Debug)]
pub struct Seen {
    /// Place among these and among the own rows, of those that this process has.
    mine: Vec<(u32, u32)>,
    /// Places among these in the order of the processes.
    order: Vec<u32>,
    counts: Vec<i32>,
    starts: Vec<i32>,
}

impl Seen {
    /// Some degrees of freedom, each once.
    pub fn new(session: &Session, rows: &Rows, dofs: &[u32]) -> Seen {
        let owner = |dof: &u32| rows.owner[*dof as usize / rows.size];
        let mut order: Vec<u32> = (0..dofs.len() as u32).collect();
        order.sort_by_key(|place| owner(&dofs[*place as usize]));
        let mut counts = vec![0; session.size()];
        for dof in dofs {
            counts[owner(dof) as usize] += 1;
        }
        let own = |place: &u32| Some((*place, rows.place(dofs[*place as usize])? as u32));
        Seen { mine: order.iter().filter_map(own).collect(), starts: starts(&counts), counts, order }
    }

    /// The values of a vector of own rows at all of these.
    pub fn gather(&self, session: &Session, own: &[f64]) -> Result<Vec<f64>, SolveError> {
        let mine: Vec<f64> = self.mine.iter().map(|(_, row)| own[*row as usize]).collect();
        let all = session.given(sys::gather(&mine, &self.counts, &self.starts))?;
        let mut values = vec![0.0; all.len()];
        self.order.iter().zip(all).for_each(|(place, value)| values[*place as usize] = value);
        Ok(values)
    }

    /// Writes the values at the own ones of these.
    pub fn put(&self, values: &[f64], own: &mut [f64]) {
        self.mine.iter().for_each(|(place, row)| own[*row as usize] = values[*place as usize]);
    }

    /// Adds the values at the own ones of these.
    pub fn add(&self, values: &[f64], own: &mut [f64]) {
        self.mine.iter().for_each(|(place, row)| own[*row as usize] += values[*place as usize]);
    }
}

/// The place of the first of each count, one after the other.
fn starts(counts: &[i32]) -> Vec<i32> {
    let mut next = 0;
    let place = |count: &i32| {
        let start = next;
        next += count;
        start
    };
    counts.iter().map(place).collect()
}

/// What a division looks at.
struct Division<'a> {
    /// Position per node, or none.
    points: &'a [Point],
    /// Work per node.
    weights: &'a [usize],
}

/// Divides nodes between the processes of a range.
fn divide(by: &Division, nodes: &mut [u32], [from, to]: [usize; 2], owner: &mut [u32]) {
    if to - from <= 1 {
        for node in nodes {
            owner[*node as usize] = from as u32;
        }
        return;
    }
    if !by.points.is_empty() {
        let range = |c: usize| {
            let at = nodes.iter().map(|node| by.points[*node as usize][c]);
            let [low, high] = at.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
            high - low
        };
        let longest = (0..3).max_by(|&a, &b| range(a).total_cmp(&range(b))).unwrap_or(0);
        nodes.sort_by(|&a, &b| {
            let at = |node: u32| by.points[node as usize][longest];
            at(a).total_cmp(&at(b)).then(a.cmp(&b))
        });
    }
    let middle = usize::midpoint(from, to);
    let whole: usize = nodes.iter().map(|node| by.weights[*node as usize]).sum();
    let wanted = whole * (middle - from) / (to - from);
    let mut sum = 0;
    let mut goes_on = |node: &u32| {
        sum += by.weights[*node as usize];
        sum <= wanted
    };
    let cut = nodes.iter().take_while(|node| goes_on(node)).count();
    let (first, second) = nodes.split_at_mut(cut);
    divide(by, first, [from, middle], owner);
    divide(by, second, [middle, to], owner);
}
