//! Meshes of every element, and functions on them, for the tests of elements and forms.
#![allow(dead_code, reason = "each test uses a part")]

use amontons::element::{self, Element, ShapeTable};
use amontons::mesh::{Block, CellMap, Diagonal, Elements, FacetSet, Mesh};
use amontons::tensor::Point;

/// The unit interval, square or cube in n cells a direction, of an element.
pub fn unit(element: &'static Element, n: usize) -> Mesh {
    distorted(element, n, 0.0)
}

/// The same with inner vertices moved off the grid by up to a share of the spacing, in the same way in every run.
/// Middle nodes follow: the cells keep straight edges.
pub fn distorted(element: &'static Element, n: usize, share: f64) -> Mesh {
    let linear = match element.name {
        name if name.ends_with("segment") => Mesh::interval(1.0, n, Elements::P1),
        name if name.ends_with("triangle") => Mesh::rectangle([1.0; 2], [n; 2], Diagonal::Right),
        name if name.ends_with("quadrilateral") => Mesh::rectangle_of(Elements::Q1, [1.0; 2], [n; 2], Diagonal::Right),
        name if name.ends_with("tetrahedron") => Mesh::box_([1.0; 3], [n; 3], Elements::P1),
        name if name.ends_with("prism") => {
            Mesh::rectangle([1.0; 2], [n; 2], Diagonal::Right).and_then(|m| m.extruded(1.0, n, ["back", "front"]))
        }
        name if name.ends_with("pyramid") => Mesh::box_([1.0; 3], [n; 3], Elements::Q1).map(|m| pyramids(&m)),
        _ => Mesh::box_([1.0; 3], [n; 3], Elements::Q1),
    };
    let mut mesh = linear.expect("a mesh of the unit cube");
    for (i, p) in mesh.points.iter_mut().enumerate() {
        let dim = mesh.dim;
        if p[..dim].iter().all(|&x| x > 1e-9 && x < 1.0 - 1e-9) {
            for (d, x) in p.iter_mut().enumerate().take(dim) {
                *x += share / n as f64 * ((13 * d + 7) as f64 * i as f64).sin();
            }
        }
    }
    let mesh = if element.degree == 2 { mesh.quadratic().expect("a quadratic mesh") } else { mesh };
    assert!(mesh.blocks.iter().all(|b| b.element.name == element.name));
    mesh.check().expect("positive cells");
    mesh
}

/// Six pyramids a cube, with their apices in its middle.
fn pyramids(mesh: &Mesh) -> Mesh {
    let mut out = Mesh { blocks: Vec::new(), ..mesh.clone() };
    let mut nodes = Vec::new();
    for cell in mesh.blocks[0].cells() {
        let middle: Point =
            std::array::from_fn(|d| cell.iter().map(|&n| mesh.points[n as usize][d]).sum::<f64>() / 8.0);
        let apex = out.points.len() as u32;
        out.points.push(middle);
        for facet in mesh.blocks[0].element.facets {
            // Seen from the apex the base runs the other way than seen from outside.
            nodes.extend(facet.nodes.iter().rev().map(|&i| cell[i]));
            nodes.push(apex);
        }
    }
    out.blocks.push(Block { element: &element::P1_PYRAMID, region: 0, nodes });
    out
}

/// Every element that bodies are made of.
pub fn cells() -> impl Iterator<Item = &'static Element> {
    element::ALL.into_iter().filter(|e| e.dim() > 0)
}

/// Whether each node lies on the boundary.
pub fn on_boundary(mesh: &Mesh) -> Vec<bool> {
    let boundary: FacetSet = mesh.boundary();
    let mut on = vec![false; mesh.points.len()];
    boundary.node_list().into_iter().for_each(|n| on[n as usize] = true);
    on
}

/// ‖v − v_h‖ and ‖∇(v − v_h)‖ of a scalar function, `f` giving value and gradient of v.
pub fn errors(mesh: &Mesh, values: &[f64], f: impl Fn(&Point) -> (f64, Point)) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, 2 * block.element.degree + 4);
        let mut map = CellMap::new(mesh, &table);
        for cell in block.cells() {
            for (q, weight) in table.weights.iter().enumerate() {
                map.at(cell, q);
                let (mut value, mut gradient) = f(&map.position);
                for ((&node, shape), g) in cell.iter().zip(map.values()).zip(&map.gradients) {
                    value -= shape * values[node as usize];
                    (0..3).for_each(|d| gradient[d] -= g[d] * values[node as usize]);
                }
                sums[0] += weight * map.measure * value * value;
                sums[1] += weight * map.measure * gradient[..mesh.dim].iter().map(|g| g * g).sum::<f64>();
            }
        }
    }
    sums.map(f64::sqrt)
}

/// Component `c` of a field of `components` components a node.
pub fn component(field: &[f64], components: usize, c: usize) -> Vec<f64> {
    field.iter().skip(c).step_by(components).copied().collect()
}
