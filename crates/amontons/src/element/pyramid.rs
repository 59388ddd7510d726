//! Pyramids over [0, 1]² with the apex at (0, 0, 1).

use super::{Element, Facet, P1_TRIANGLE, Q1_QUADRILATERAL};
use crate::quadrature::Shape;
use crate::tensor::Point;

/// The place in the square that is collapsed to height z; at the apex, where every place is the same, the middle.
fn collapsed(x: &Point) -> (f64, f64, f64) {
    let size = 1.0 - x[2];
    if size > f64::EPSILON { (x[0] / size, x[1] / size, size) } else { (0.5, 0.5, size) }
}

/// Linear pyramid, of five nodes: bilinear on the base, linear on the other faces, hence rational inside
/// (Bedrosian, 1992): with s = x/(1 − z), t = y/(1 − z) the functions of the base are those of the square in
/// (s, t) times 1 − z.
///
/// The gradients at the apex depend on the direction of approach; those along s = t = ½ are taken. Rules have no point
/// there.
pub static P1_PYRAMID: Element = Element {
    name: "P1 pyramid",
    shape: Shape::Pyramid,
    degree: 1,
    gradient_degree: 1,
    nodes: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    facets: &[
        Facet { element: &Q1_QUADRILATERAL, nodes: &[0, 3, 2, 1] },
        Facet { element: &P1_TRIANGLE, nodes: &[0, 1, 4] },
        Facet { element: &P1_TRIANGLE, nodes: &[1, 2, 4] },
        Facet { element: &P1_TRIANGLE, nodes: &[2, 3, 4] },
        Facet { element: &P1_TRIANGLE, nodes: &[3, 0, 4] },
    ],
    shape_functions: |x, n| {
        let (s, t, size) = collapsed(x);
        n[0] = (1.0 - s) * (1.0 - t) * size;
        n[1] = s * (1.0 - t) * size;
        n[2] = s * t * size;
        n[3] = (1.0 - s) * t * size;
        n[4] = x[2];
    },
    gradients: |x, g| {
        let (s, t, _) = collapsed(x);
        g[0] = [t - 1.0, s - 1.0, s * t - 1.0];
        g[1] = [1.0 - t, -s, -s * t];
        g[2] = [t, s, s * t];
        g[3] = [-t, 1.0 - s, -s * t];
        g[4] = [0.0, 0.0, 1.0];
    },
    vtk: 14,
    gmsh: 7,
    gmsh_nodes: &[0, 1, 2, 3, 4],
};
