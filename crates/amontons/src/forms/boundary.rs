//! Forms over sides: springs, dashpots and convection, as conditions of the third kind.

use std::sync::Arc;

use crate::element::ShapeTable;
use crate::field::Field;
use crate::linalg::{BlockMatrix, Graph};
use crate::mesh::{FacetMap, FacetSet, Mesh};
use crate::problem::{BoundaryCondition, Support};
use crate::tensor::Point;

/// ∫ κ(x, ν) N_j·N_i over the sides with a coefficient κ, a tensor of `components`² entries; `None` if there is no such
/// side.
///
/// The rule is exact for coefficients that are quadratic on a flat facet.
fn assemble<'a, K: 'a>(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    components: usize,
    sides: impl Iterator<Item = (&'a FacetSet, &'a K)>,
    coefficient: impl Fn(&K, &FacetMap) -> [Point; 3],
) -> Option<BlockMatrix> {
    let mut matrix = None;
    for (set, given) in sides {
        let matrix = matrix.get_or_insert_with(|| BlockMatrix::zero(graph, components, components));
        for block in &set.blocks {
            let table = ShapeTable::new(block.element, 2 * block.element.degree + 2);
            let (mut map, width) = (FacetMap::new(mesh, &table), block.element.nodes.len() * components);
            let mut form = vec![0.0; width * width];
            for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
                form.fill(0.0);
                for (q, weight) in table.weights.iter().enumerate() {
                    map.at(facet, q);
                    let (kappa, values) = (coefficient(given, &map), map.values());
                    for (i, entry) in form.iter_mut().enumerate() {
                        let (row, column) = (i / width, i % width);
                        let shapes = values[row / components] * values[column / components];
                        *entry += weight * map.area * shapes * kappa[row % components][column % components];
                    }
                }
                matrix.add(facet, &form);
            }
        }
    }
    matrix
}

/// κ = k ν ⊗ ν, or diagonal with the entries k_i.
fn stiffness(support: &Support, map: &FacetMap) -> [Point; 3] {
    let value = |field: &Field| field.value(&map.position, 0.0);
    match support {
        Support::Normal(k) => {
            let k = value(k);
            map.normal.map(|nu| map.normal.map(|mu| k * nu * mu))
        }
        Support::Components(k) => {
            std::array::from_fn(|r| std::array::from_fn(|c| if r == c { k.get(c).map_or(0.0, value) } else { 0.0 }))
        }
    }
}

/// The sides with a condition of one kind, and the condition.
fn sides<'a, K: 'a>(
    mesh: &'a Mesh,
    boundary: &'a [BoundaryCondition],
    of: fn(&BoundaryCondition) -> Option<&K>,
) -> impl Iterator<Item = (&'a FacetSet, &'a K)> {
    boundary.iter().filter_map(move |b| Some((mesh.facets.get(&b.on)?, of(b)?)))
}

/// ∫ (κ u)·v of the springs at the boundary, with the traction −κu.
#[must_use]
pub fn springs(mesh: &Mesh, graph: &Arc<Graph>, boundary: &[BoundaryCondition]) -> Option<BlockMatrix> {
    assemble(mesh, graph, mesh.dim, sides(mesh, boundary, |b| b.spring.as_ref()), stiffness)
}

/// ∫ (κ w)·v of the dashpots at the boundary, with the traction −κu̇.
#[must_use]
pub fn dashpots(mesh: &Mesh, graph: &Arc<Graph>, boundary: &[BoundaryCondition]) -> Option<BlockMatrix> {
    assemble(mesh, graph, mesh.dim, sides(mesh, boundary, |b| b.dashpot.as_ref()), stiffness)
}

/// [`springs`] and [`dashpots`] restricted to the facets of a set.
pub(crate) fn supports_on(mesh: &Mesh, boundary: &[BoundaryCondition], set: &FacetSet) -> [Option<BlockMatrix>; 2] {
    let graph = Arc::new(Graph::of_mesh(mesh));
    let kinds: [fn(&BoundaryCondition) -> Option<&Support>; 2] = [|b| b.spring.as_ref(), |b| b.dashpot.as_ref()];
    kinds.map(|of| {
        let common: Vec<(FacetSet, &Support)> =
            sides(mesh, boundary, of).map(|(side, support)| (set.common(side), support)).collect();
        let common = common.iter().filter(|(common, _)| !common.is_empty());
        assemble(mesh, &graph, mesh.dim, common.map(|(common, support)| (common, *support)), stiffness)
    })
}

/// ∫ h θ η of the heat exchange −q·ν = h (θ_a − θ); the part h θ_a is a load, see [`super::q`].
#[must_use]
pub fn convection(mesh: &Mesh, graph: &Arc<Graph>, boundary: &[BoundaryCondition]) -> Option<BlockMatrix> {
    assemble(mesh, graph, 1, sides(mesh, boundary, |b| b.convection.as_ref()), |convection, map| {
        [[convection.coefficient.value(&map.position, 0.0), 0.0, 0.0], [0.0; 3], [0.0; 3]]
    })
}
