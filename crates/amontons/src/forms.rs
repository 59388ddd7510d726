//! The forms of Problem 4.1, one function a letter of the paper, assembled on the nodes of a mesh.
//!
//! | function | form | blocks |
//! |---|---|---|
//! | [`inner_h`] | (w, v)_H, (θ, η)_{L²} = ∫ θ η | 1 × 1 |
//! | [`a`], [`b`] | ∫ 𝓔ε(u):ε(v), ∫ 𝓥ε(w):ε(v) | d × d |
//! | [`d`] | ∫ 𝓚∇θ·∇η | 1 × 1 |
//! | [`m`] | ∫ θ 𝓜:ε(v) | d × 1 |
//! | [`e`] | ∫ 𝓡:ε(u) η | 1 × d |
//! | [`f`], [`q`] | ∫ f₀·v + ∫_{Γ_N} f₁·v, ∫ q₀ η + heat inflow | load vectors |
//!
//! j and χ, the terms on Γ_C, are evaluated at contact points in [`crate::linalg`].

use std::sync::Arc;

use crate::element::{Element, MAX_NODES};
use crate::field::Field;
use crate::linalg::{BlockMatrix, Graph};
use crate::material::TensorLaw;
use crate::mesh::{CellMap, FacetMap, Mesh};
use crate::problem::BoundaryCondition;
use crate::quadrature::{Rule, rule};
use crate::tensor::{MANDEL, Point, Sym, mandel_len, mandel_weight};

/// Sums `form(map, matrix of the cell, weight)` over the quadrature points of all cells.
fn assemble(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    shape: (usize, usize),
    degree: impl Fn(&Element) -> usize,
    form: impl Fn(&CellMap, f64, usize, &mut [f64]),
) -> BlockMatrix {
    let mut matrix = BlockMatrix::zero(graph, shape.0, shape.1);
    for block in &mesh.blocks {
        let n = block.element.nodes.len();
        let rule = rule(block.element.shape, degree(block.element));
        let mut cell_matrix = vec![0.0; n * n * shape.0 * shape.1];
        for cell in block.cells() {
            cell_matrix.fill(0.0);
            for (at, weight) in rule.iter() {
                let map = CellMap::new(mesh, block.element, cell, at);
                form(&map, weight * map.determinant, n, &mut cell_matrix);
            }
            matrix.add(cell, &cell_matrix);
        }
    }
    matrix
}

/// Mandel components of ε(v) for the vector field v = N e_c with gradient `g` of N.
fn strain_of(dim: usize, g: &Point, c: usize) -> Sym {
    let mut strain = Sym::ZERO;
    for (s, &(i, j)) in MANDEL.iter().enumerate().take(mandel_len(dim)) {
        // ε_ij = (∂_j v_i + ∂_i v_j)/2, times the Mandel weight.
        let e = 0.5 * ((if i == c { g[j] } else { 0.0 }) + (if j == c { g[i] } else { 0.0 }));
        strain.0[s] = mandel_weight(i, j) * e;
    }
    strain
}

/// (θ, η)_{L²(Ω)}, and by components (w, v)_H.
#[must_use]
pub fn inner_h(mesh: &Mesh, graph: &Arc<Graph>) -> BlockMatrix {
    assemble(
        mesh,
        graph,
        (1, 1),
        |e| 2 * e.degree,
        |map, weight, n, out| {
            for i in 0..n {
                for j in 0..n {
                    out[i * n + j] += weight * map.values[i] * map.values[j];
                }
            }
        },
    )
}

/// a(u, v) = ∫ 𝓔ε(u):ε(v) of a linear law.
#[must_use]
pub fn a(mesh: &Mesh, graph: &Arc<Graph>, elasticity: &dyn TensorLaw) -> BlockMatrix {
    tensor_form(mesh, graph, elasticity)
}

/// b(w, v) = ∫ 𝓥ε(w):ε(v) of a linear law.
#[must_use]
pub fn b(mesh: &Mesh, graph: &Arc<Graph>, viscosity: &dyn TensorLaw) -> BlockMatrix {
    tensor_form(mesh, graph, viscosity)
}

fn tensor_form(mesh: &Mesh, graph: &Arc<Graph>, law: &dyn TensorLaw) -> BlockMatrix {
    let dim = mesh.dim;
    assemble(
        mesh,
        graph,
        (dim, dim),
        |e| 2 * (e.degree - 1),
        |map, weight, n, out| {
            let tangent = law.tangent(&map.position, &Sym::ZERO);
            let width = n * dim;
            for j in 0..n {
                for c in 0..dim {
                    let stress = weight * tangent.apply(&strain_of(dim, &map.gradients[j], c));
                    for i in 0..n {
                        for r in 0..dim {
                            // Components 33 of a plane law do no work: the strain has none.
                            out[(i * dim + r) * width + j * dim + c] += stress.dot(&strain_of(dim, &map.gradients[i], r));
                        }
                    }
                }
            }
        },
    )
    .of_differences()
}

/// d(θ, η) = ∫ 𝓚∇θ·∇η.
#[must_use]
pub fn d(mesh: &Mesh, graph: &Arc<Graph>, conductivity: &Sym) -> BlockMatrix {
    assemble(
        mesh,
        graph,
        (1, 1),
        |e| 2 * (e.degree - 1),
        |map, weight, n, out| {
            for j in 0..n {
                let flux = conductivity.apply(&map.gradients[j]);
                for i in 0..n {
                    out[i * n + j] += weight * crate::tensor::dot(&flux, &map.gradients[i]);
                }
            }
        },
    )
    .of_differences()
}

/// m(θ, v) = ∫ θ 𝓜:ε(v), rows v, columns θ.
#[must_use]
pub fn m(mesh: &Mesh, graph: &Arc<Graph>, expansion: &Sym) -> BlockMatrix {
    let dim = mesh.dim;
    assemble(
        mesh,
        graph,
        (dim, 1),
        |e| 2 * e.degree - 1,
        |map, weight, n, out| {
            for i in 0..n {
                for r in 0..dim {
                    let work = weight * expansion.dot(&strain_of(dim, &map.gradients[i], r));
                    for j in 0..n {
                        out[(i * dim + r) * n + j] += work * map.values[j];
                    }
                }
            }
        },
    )
}

/// e(u, η) = ∫ 𝓡:ε(u) η, rows η, columns u.
#[must_use]
pub fn e(mesh: &Mesh, graph: &Arc<Graph>, coupling: &Sym) -> BlockMatrix {
    let dim = mesh.dim;
    assemble(
        mesh,
        graph,
        (1, dim),
        |e| 2 * e.degree - 1,
        |map, weight, n, out| {
            for j in 0..n {
                for c in 0..dim {
                    let heat = weight * coupling.dot(&strain_of(dim, &map.gradients[j], c));
                    for i in 0..n {
                        out[i * n * dim + j * dim + c] += heat * map.values[i];
                    }
                }
            }
        },
    )
    .of_differences()
}

/// Degree of the rules that integrate data against shape functions: exact for cubic data on P1.
fn data_degree(element: &Element) -> usize {
    element.degree + 3
}

/// A load linear in its data: fixed entries, and terms whose field varies with time.
#[derive(Debug, Default)]
pub struct Load {
    constant: Vec<f64>,
    varying: Vec<Varying>,
}

#[derive(Debug)]
struct Varying {
    field: Field,
    points: Vec<Point>,
    /// Where and with what weight the value at each point enters, `per_point` entries a point.
    entries: Vec<(u32, f64)>,
    per_point: usize,
}

impl Load {
    fn new(size: usize) -> Load {
        Load { constant: vec![0.0; size], varying: Vec::new() }
    }

    /// The load vector at time t.
    #[must_use]
    pub fn at(&self, t: f64) -> Vec<f64> {
        let mut load = self.constant.clone();
        for term in &self.varying {
            term.add(t, &mut load);
        }
        load
    }

    /// Adds ∫ field N for the points given by `place`.
    fn add(&mut self, field: &Field, per_point: usize, points: Vec<Point>, entries: Vec<(u32, f64)>) {
        if field.is_zero() {
            return;
        }
        let term = Varying { field: field.clone(), points, entries, per_point };
        if field.depends_on_time() {
            self.varying.push(term);
        } else {
            term.add(0.0, &mut self.constant);
        }
    }
}

impl Varying {
    fn add(&self, t: f64, load: &mut [f64]) {
        let values = self.field.values(&self.points, t);
        for (value, entries) in values.iter().zip(self.entries.chunks_exact(self.per_point)) {
            for &(at, weight) in entries {
                load[at as usize] += weight * value;
            }
        }
    }
}

/// Points and entries of ∫ · N_i over cells or facets, for component `c` of `components`.
fn over<'a>(
    shapes: impl Iterator<Item = (&'a Element, &'a [u32])>,
    map: impl Fn(&Element, &[u32], &Point) -> (Point, f64, [f64; MAX_NODES]),
    components: usize,
    c: usize,
) -> (Vec<Point>, Vec<(u32, f64)>) {
    let (mut points, mut entries) = (Vec::new(), Vec::new());
    let mut cached: Option<(&'static str, Rule)> = None;
    for (element, nodes) in shapes {
        if cached.as_ref().is_none_or(|(name, _)| *name != element.name) {
            cached = Some((element.name, rule(element.shape, data_degree(element))));
        }
        let Some((_, rule)) = &cached else { continue };
        for (at, weight) in rule.iter() {
            let (x, measure, values) = map(element, nodes, at);
            points.push(x);
            entries.extend(nodes.iter().zip(values).map(|(&node, value)| (node * components as u32 + c as u32, weight * measure * value)));
        }
    }
    (points, entries)
}

fn cell_terms(mesh: &Mesh, load: &mut Load, field: &Field, components: usize, c: usize) {
    if field.is_zero() {
        return;
    }
    for block in &mesh.blocks {
        let (points, entries) = over(
            block.cells().map(|cell| (block.element, cell)),
            |element, nodes, at| {
                let map = CellMap::new(mesh, element, nodes, at);
                (map.position, map.determinant, map.values)
            },
            components,
            c,
        );
        load.add(field, block.element.nodes.len(), points, entries);
    }
}

fn facet_terms(mesh: &Mesh, load: &mut Load, on: &str, field: &Field, components: usize, c: usize) {
    let Some(set) = mesh.facets.get(on).filter(|_| !field.is_zero()) else { return };
    let (points, entries) = over(
        set.facets().map(|facet| (set.element, facet)),
        |element, nodes, at| {
            let map = FacetMap::new(mesh, element, nodes, at);
            (map.position, map.area, map.values)
        },
        components,
        c,
    );
    load.add(field, set.element.nodes.len(), points, entries);
}

/// (f(t), v)_V of (2.16): body force and tractions.
#[must_use]
pub fn f(mesh: &Mesh, body_force: &[Field], boundary: &[BoundaryCondition]) -> Load {
    let mut load = Load::new(mesh.points.len() * mesh.dim);
    for (c, field) in body_force.iter().enumerate() {
        cell_terms(mesh, &mut load, field, mesh.dim, c);
    }
    for condition in boundary {
        for (c, field) in condition.traction.iter().flatten().enumerate() {
            facet_terms(mesh, &mut load, &condition.on, field, mesh.dim, c);
        }
    }
    load
}

/// (q_h(t), η)_Q of (2.17): heat source, and heat inflow through the boundary.
#[must_use]
pub fn q(mesh: &Mesh, heat_source: &Field, boundary: &[BoundaryCondition]) -> Load {
    let mut load = Load::new(mesh.points.len());
    cell_terms(mesh, &mut load, heat_source, 1, 0);
    for condition in boundary {
        if let Some(field) = &condition.heat_inflow {
            facet_terms(mesh, &mut load, &condition.on, field, 1, 0);
        }
    }
    load
}
