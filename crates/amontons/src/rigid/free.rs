//! The motions without strain of a part that supports allow.

use faer::{Mat, Side};

use super::Motion;
use crate::mesh::defects::Component;
use crate::mesh::{FacetSet, Mesh};
use crate::problem::{Problem, Support};
use crate::space::{RigidNodes, Space};
use crate::tensor::{Point, dot};

/// Fraction of the size of a motion below which a support does not prevent it: the precision of coordinates in mesh
/// files.
const UNSEEN: f64 = 1e-6;

/// The independent motions without strain of a part, given with its number, that supports allow. `held` lists nodes
/// with directions in which they are held elastically, see [`supported`].
#[must_use]
pub fn free_motions(
    mesh: &Mesh,
    space: &Space,
    held: &[(u32, Point)],
    (number, part): (usize, &Component),
) -> Vec<Motion> {
    let all = all_motions(mesh, (number, part));
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let along = |node: u32, direction: &Point| -> Vec<f64> {
        let x = mesh.points.get(node as usize).copied().unwrap_or_default();
        all.iter().map(|motion| dot(&motion.at(&x), direction)).collect()
    };
    for &node in &part.nodes {
        rows.extend(space.held_directions(node).map(|direction| along(node, &direction)));
    }
    let inside = |node: u32| part.nodes.binary_search(&node).is_ok();
    rows.extend(held.iter().filter(|(node, _)| inside(*node)).map(|(node, direction)| along(*node, direction)));
    // The motion of a node that follows another one is that of its leader, turned.
    for link in space.links.iter().filter(|link| inside(link.node) && inside(link.to)) {
        for axis in space.directions(link.to).iter().take(mesh.dim) {
            let [own, followed] = [along(link.node, &link.turned(axis)), along(link.to, axis)];
            rows.push(own.iter().zip(followed).map(|(own, followed)| own - followed).collect());
        }
    }
    for body in space.rigid.iter().filter(|body| body.nodes.first().is_some_and(|&node| inside(node))) {
        rows.extend(rows_of_rigid(body, all.len(), (mesh.dim, &along)));
    }
    let kernel = kernel(all.len(), &rows);
    kernel.iter().filter_map(|a| Motion::sum(a.iter().copied().zip(&all))).collect()
}

/// What a rigid body forbids of `count` motions, whose values at a node along a direction are `along`: its prescribed
/// motions, each a sum over its nodes, and what the motions have at its nodes beyond its own, a turn if it is guided.
fn rows_of_rigid(
    body: &RigidNodes,
    count: usize,
    (dim, along): (usize, &dyn Fn(u32, &Point) -> Vec<f64>),
) -> Vec<Vec<f64>> {
    let mut own = vec![vec![0.0; count]; body.motions.len()];
    for (i, &node) in body.nodes.iter().enumerate() {
        for (row, motion) in own.iter_mut().zip(body.at(i)) {
            row.iter_mut().zip(along(node, &motion)).for_each(|(sum, more)| *sum += more);
        }
    }
    let mut rows = Vec::new();
    for (i, &node) in body.nodes.iter().enumerate() {
        for axis in 0..dim {
            let mut beyond = along(node, &std::array::from_fn(|c| f64::from(u8::from(c == axis))));
            for (own, motion) in own.iter().zip(body.at(i)) {
                beyond.iter_mut().zip(own).for_each(|(beyond, own)| *beyond -= own * motion[axis]);
            }
            beyond.iter_mut().filter(|beyond| beyond.abs() < UNSEEN).for_each(|beyond| *beyond = 0.0);
            if beyond.iter().any(|beyond| beyond.abs() > 0.0) {
                rows.push(beyond);
            }
        }
    }
    own.truncate(body.held);
    rows.extend(own);
    rows
}

/// The motions of a part without supports: along the axes, and about the centre, scaled by the inverse size of the
/// part. A body of revolution moves only along its axis.
fn all_motions(mesh: &Mesh, (number, part): (usize, &Component)) -> Vec<Motion> {
    let [low, high] = part.bounds(mesh);
    let centre: Point = std::array::from_fn(|d| if d < mesh.dim { 0.5 * (low[d] + high[d]) } else { 0.0 });
    let size = (0..mesh.dim).map(|d| high[d] - low[d]).fold(0.0, f64::max);
    let unit = |axis: usize| -> Point { std::array::from_fn(|d| f64::from(u8::from(d == axis))) };
    let shifted = |axis: usize| Motion { part: number, shift: unit(axis), turn: [0.0; 3], centre };
    let turned = |axis: usize| {
        let turn = unit(axis).map(|c| if size > 0.0 { c / size } else { 0.0 });
        Motion { part: number, shift: [0.0; 3], turn, centre }
    };
    match mesh.dim {
        _ if mesh.axisymmetric => vec![shifted(1)],
        1 => vec![shifted(0)],
        2 => vec![shifted(0), shifted(1), turned(2)],
        _ => (0..3).map(shifted).chain((0..3).map(turned)).collect(),
    }
}

/// An orthonormal basis of the vectors with n entries that all rows map to zero.
fn kernel(n: usize, rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let unit = |k: usize| (0..n).map(|j| f64::from(u8::from(j == k))).collect::<Vec<f64>>();
    let largest = rows.iter().map(|row| row.iter().map(|r| r * r).sum::<f64>()).fold(0.0, f64::max);
    if largest == 0.0 {
        return (0..n).map(unit).collect();
    }
    let gram = Mat::from_fn(n, n, |i, j| rows.iter().map(|row| row[i] * row[j]).sum::<f64>());
    let Ok(eigen) = gram.self_adjoint_eigen(Side::Lower) else { return Vec::new() };
    let values: Vec<f64> = eigen.S().column_vector().iter().copied().collect();
    let free = (0..n).filter(|&k| values[k] <= UNSEEN * UNSEEN * largest);
    free.map(|k| eigen.U().col(k).iter().copied().collect()).collect()
}

/// Nodes with the directions in which springs, and also dashpots if `dashpots` is true, hold them.
#[must_use]
pub fn supported(problem: &Problem, dashpots: bool) -> Vec<(u32, Point)> {
    let mesh = &problem.mesh;
    let mut held = Vec::new();
    for b in &problem.boundary {
        let Some(set) = mesh.facets.get(&b.on) else { continue };
        for support in b.spring.iter().chain(b.dashpot.iter().filter(|_| dashpots)) {
            match support {
                Support::Components(fields) => {
                    for (c, _) in fields.iter().enumerate().take(mesh.dim).filter(|(_, field)| !field.is_zero()) {
                        let axis: Point = std::array::from_fn(|d| f64::from(u8::from(d == c)));
                        held.extend(set.node_list().into_iter().map(|node| (node, axis)));
                    }
                }
                Support::Normal(field) if field.is_zero() => {}
                Support::Normal(_) => normals(mesh, set, |node, normal| held.push((node, normal))),
            }
        }
    }
    held
}

/// Calls `at` with the normals of all facets of a side at their nodes.
pub(super) fn normals(mesh: &Mesh, set: &FacetSet, mut at: impl FnMut(u32, Point)) {
    for block in &set.blocks {
        let table = crate::element::ShapeTable::at(block.element, block.element.nodes);
        let mut map = crate::mesh::FacetMap::new(mesh, &table);
        for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
            for (q, &node) in facet.iter().enumerate() {
                map.at(facet, q);
                at(node, map.normal);
            }
        }
    }
}
