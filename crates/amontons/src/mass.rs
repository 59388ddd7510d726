//! The mass matrix of the inertia term, and the redistribution of mass away from the nodes in contact.
//!
//! A node that is stopped by a foundation has to lose its momentum at once, and in a discrete body that is the momentum
//! of its share of the mass: pressures oscillate and energy is lost or gained with every impact. With the redistributed
//! mass no node in contact has a mass, and total mass, centre and inertia of each body are those of the consistent mass
//! matrix M. It is made in two steps.
//!
//! 1. M₀ = Pᵀ M P, where P takes the velocity of a node in contact from the mean of those near it. So M₀ is positive
//!    where M is, and translations have their kinetic energy, but the centre has moved by a cell in the strip of cells
//!    at the contact.
//! 2. M_r = M₀ + δM with the least δM, Σ (δM_ij)²/M₀_ij, that gives all affine velocities their kinetic energy: δM_ij =
//!    M₀_ij y_i·Θ y_j with y = (1, x) and one symmetric matrix Θ for each body. It is as if the density were changed by
//!    a quadratic function of the size of (h/L)², h the size of the cells at the contact and L that of the body.
//!
//! An extrapolation P that is affine by itself needs no second step, but its steep weights make the nodes behind the
//! contact heavy, and the pressure rings.
//!
//! Source: H. B. Khenous, P. Laborde, Y. Renard, Eur. J. Mech. A/Solids 27 (2008) 918–932, who take the least change of
//! M with the same pattern.

use crate::linalg::{BlockMatrix, Graph, NodalMap};
use crate::mesh::Mesh;
use crate::mesh::defects::{Component, components};
use crate::tensor::{Point, Sym, dot, minus};

/// The mass matrix of the inertia term.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MassMatrix {
    /// That of the shape functions.
    #[default]
    Consistent,
    /// The consistent one with the mass of the nodes in contact moved to nodes near them.
    Redistributed,
}

/// Largest change of an entry by the second step, relative to it: no mass vanishes or changes its sign. A bar needs
/// four cells, whose M_r is as positive as M; with three the change is 1.2 times an entry, and M_r is not positive.
const MOST: f64 = 0.9;
/// Pivot, over the first one, that is round-off: the nodes with mass lie in a plane.
const SINGULAR: f64 = 1e-10;

/// Why the mass of a node cannot be moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NotMoved {
    /// All nodes of its body are in contact.
    AllInContact(u32),
    /// The nodes of its body that are not in contact cannot have its inertia.
    TooFew(u32),
}

/// The map P of nodal velocities: that of each massless node is the mean of those of the nodes with mass in the least
/// number of rings of cells about it that has any.
///
/// # Errors
/// The first node of a body all of whose nodes are massless.
pub(crate) fn means(graph: &Graph, massless: Vec<u32>) -> Result<NodalMap, NotMoved> {
    let of = |&node: &u32| {
        let near = nearest(graph, &massless, node).ok_or(NotMoved::AllInContact(node))?;
        let share = 1.0 / near.len() as f64;
        Ok(near.into_iter().map(|node| (node, share)).collect())
    };
    Ok(NodalMap { from: massless.iter().map(of).collect::<Result<_, _>>()?, nodes: massless })
}

/// The nodes with mass in the least number of rings of cells about a node.
fn nearest(graph: &Graph, massless: &[u32], node: u32) -> Option<Vec<u32>> {
    let (mut seen, mut outer) = (vec![node], vec![node]);
    while !outer.is_empty() {
        let mut next: Vec<u32> = outer.iter().flat_map(|&i| graph.row(i as usize)).copied().collect();
        next.sort_unstable();
        next.dedup();
        next.retain(|i| seen.binary_search(i).is_err());
        let found: Vec<u32> = next.iter().copied().filter(|i| massless.binary_search(i).is_err()).collect();
        if !found.is_empty() {
            return Some(found);
        }
        seen.extend_from_slice(&next);
        seen.sort_unstable();
        outer = next;
    }
    None
}

/// The redistributed form of inertia M_r of the form M of inertia, by the means of [`means`].
///
/// # Errors
/// A massless node of the first body that has too few nodes with mass.
pub(crate) fn redistributed(mesh: &Mesh, form: &BlockMatrix, map: &NodalMap) -> Result<BlockMatrix, NotMoved> {
    let mut moved = form.congruent(map);
    for body in components(mesh) {
        let Some(&first) = body.nodes.iter().find(|node| map.nodes.binary_search(node).is_ok()) else { continue };
        let affine = Affine::of(mesh, &body);
        let lost = affine.lost(form, &moved, &body);
        if lost.iter().all(|lost| lost.abs() <= 0.0) {
            continue;
        }
        let theta = affine.change(&moved, &body, lost).ok_or(NotMoved::TooFew(first))?;
        let factor = |i: usize, j: u32| affine.of_pair(&theta, i as u32, j);
        // Rows and columns of nodes without mass stay zero.
        let masses = |i: usize| moved.row(i).filter(|(_, value)| value.iter().any(|value| value.abs() > 0.0));
        let largest = |i: usize| masses(i).map(|(j, _)| factor(i, j as u32).abs()).fold(0.0, f64::max);
        let most = body.nodes.iter().map(|&i| largest(i as usize)).fold(0.0, f64::max);
        if most.is_nan() || most > MOST {
            return Err(NotMoved::TooFew(first));
        }
        for &i in &body.nodes {
            moved.scale_row(i as usize, |j| 1.0 + factor(i as usize, j));
        }
    }
    Ok(moved)
}

/// The affine functions y = (1, x) of a body, with positions from its middle along its principal axes, each over the
/// extent of the body: slender bodies are as well determined as others.
struct Affine<'a> {
    mesh: &'a Mesh,
    middle: Point,
    axes: Vec<Point>,
}

impl<'a> Affine<'a> {
    fn of(mesh: &'a Mesh, body: &Component) -> Affine<'a> {
        let places = || body.nodes.iter().map(|&node| &mesh.points[node as usize]);
        let share = 1.0 / body.nodes.len() as f64;
        let middle: Point = std::array::from_fn(|c| share * places().map(|x| x[c]).sum::<f64>());
        let spread =
            Sym::from_fn(3, |i, j| places().map(|x| minus(x, &middle)).map(|x| x[i] * x[j]).sum::<f64>() * share);
        let axes = spread.principal_axes().into_iter().take(mesh.dim);
        Affine { mesh, middle, axes: axes.map(|(square, axis)| axis.map(|c| c / square.max(0.0).sqrt())).collect() }
    }

    /// The values at a node.
    fn at(&self, node: u32) -> [f64; 4] {
        let x = minus(&self.mesh.points[node as usize], &self.middle);
        let along = |c: usize| self.axes.get(c).map_or(0.0, |axis| dot(axis, &x));
        [1.0, along(0), along(1), along(2)]
    }

    /// The pairs r ≤ s of the functions, by which symmetric matrices are numbered.
    fn pairs(&self) -> Vec<(usize, usize)> {
        (0..=self.mesh.dim).flat_map(|s| (0..=s).map(move |r| (r, s))).collect()
    }

    /// Products y_r(i) y_s(j) of all pairs of functions, symmetric in both nodes.
    fn products(&self, i: u32, j: u32) -> Vec<f64> {
        let (a, b) = (self.at(i), self.at(j));
        self.pairs().into_iter().map(|(r, s)| 0.5 * (a[r] * b[s] + a[s] * b[r])).collect()
    }

    /// y_i·Θ y_j.
    fn of_pair(&self, theta: &[f64], i: u32, j: u32) -> f64 {
        self.products(i, j).iter().zip(theta).map(|(product, theta)| product * theta).sum()
    }

    /// y_r·(M − M₀) y_s of all pairs.
    fn lost(&self, form: &BlockMatrix, moved: &BlockMatrix, body: &Component) -> Vec<f64> {
        let mut lost = vec![0.0; self.pairs().len()];
        for &i in &body.nodes {
            let rows = form.row(i as usize).zip(moved.row(i as usize));
            for ((j, own), (_, moved)) in rows {
                let change = own.iter().sum::<f64>() - moved.iter().sum::<f64>();
                let products = self.products(i, j as u32);
                lost.iter_mut().zip(products).for_each(|(sum, product)| *sum += change * product);
            }
        }
        lost
    }

    /// Θ by which the products of M₀ change by these amounts; `None` if they do not determine it.
    fn change(&self, moved: &BlockMatrix, body: &Component, lost: Vec<f64>) -> Option<Vec<f64>> {
        let size = lost.len();
        let mut matrix = vec![vec![0.0; size]; size];
        for &i in &body.nodes {
            for (j, value) in moved.row(i as usize) {
                let (value, products) = (value.iter().sum::<f64>(), self.products(i, j as u32));
                for (row, a) in matrix.iter_mut().zip(&products) {
                    row.iter_mut().zip(&products).for_each(|(sum, b)| *sum += value * a * b);
                }
            }
        }
        solved(matrix, lost)
    }
}

/// The solution of a system whose matrix is symmetric and positive, or `None` if it is not to round-off.
fn solved(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let least = SINGULAR * matrix.first()?.first()?;
    for k in 0..right.len() {
        let (pivot_row, pivot) = (matrix[k].clone(), matrix[k][k]);
        if pivot.is_nan() || pivot <= least {
            return None;
        }
        let above = right[k];
        for (row, value) in matrix.iter_mut().zip(&mut right).skip(k + 1) {
            let factor = row[k] / pivot;
            row.iter_mut().zip(&pivot_row).for_each(|(entry, above)| *entry -= factor * above);
            *value -= factor * above;
        }
    }
    for k in (0..right.len()).rev() {
        let known: f64 = matrix[k].iter().zip(&right).skip(k + 1).map(|(entry, x)| entry * x).sum();
        right[k] = (right[k] - known) / matrix[k][k];
    }
    Some(right)
}
