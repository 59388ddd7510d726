//! Pyramids over [0, 1]² with the apex at (0, 0, 1).

use super::basis::line;
use super::{
    CellType, Child, Element, Facet, FileOrder, FileOrders, P1_TRIANGLE, P2_TRIANGLE, Q1_QUADRILATERAL,
    Q2_QUADRILATERAL, parts,
};
use crate::quadrature::Shape;
use crate::tensor::Point;

/// Vertices of the base and the apex; middles of the base edges and of the edges to the apex; centre of the base.
const NODES: [Point; 14] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [1.0, 0.5, 0.0],
    [0.5, 1.0, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.5, 0.5, 0.5],
    [0.0, 0.5, 0.5],
    [0.5, 0.5, 0.0],
];
/// The nodes in the base, and the local numbers of the mid-edge nodes between its vertices and the apex.
const BASE: [usize; 9] = [0, 1, 2, 3, 5, 6, 7, 8, 13];
const UP: [usize; 4] = [9, 10, 11, 12];

/// Exodus numbers the base last.
const EXODUS_SIDES: FileOrder = FileOrder(&[1, 2, 3, 4, 0]);

/// Pyramids at the vertices of the base and at the apex, one inverted between them, and tetrahedra next to it.
fn children(_: &[Point]) -> Vec<Child> {
    const PYRAMIDS: [&[usize]; 6] = [
        &[0, 5, 13, 8, 9],
        &[1, 6, 13, 5, 10],
        &[2, 7, 13, 6, 11],
        &[3, 8, 13, 7, 12],
        &[9, 10, 11, 12, 4],
        &[9, 12, 11, 10, 13],
    ];
    const TETRAHEDRA: [&[usize]; 4] = [&[5, 13, 9, 10], &[6, 13, 10, 11], &[7, 13, 11, 12], &[8, 13, 12, 9]];
    [parts(Shape::Pyramid, &NODES, &PYRAMIDS), parts(Shape::Tetrahedron, &NODES, &TETRAHEDRA)].concat()
}

/// The coordinates in the unit square that is collapsed with height z, and its size 1 − z; the centre at the apex.
fn collapsed(x: &Point) -> (f64, f64, f64) {
    let size = 1.0 - x[2];
    if size > f64::EPSILON { (x[0] / size, x[1] / size, size) } else { (0.5, 0.5, size) }
}

/// Linear pyramid with five nodes: bilinear on the base, linear on the other faces, hence rational inside (Bedrosian,
/// 1992): with s = x/(1 − z), t = y/(1 − z) the functions of the base are those of the square in (s, t) times 1 − z.
///
/// The gradients at the apex depend on the direction of approach; those along s = t = ½ are used. Quadrature rules have
/// no point there.
pub static P1_PYRAMID: Element = Element {
    name: "P1 pyramid",
    shape: Shape::Pyramid,
    degree: 1,
    gradient_degree: 1,
    neighbours: 22.0,
    nodes: &[NODES[0], NODES[1], NODES[2], NODES[3], NODES[4]],
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
    children,
    types: &[CellType::new("5-node pyramid", 5).vtk(14).gmsh(7).aster("PY5", "PYRAM5").abaqus()],
    orders: FileOrders { exodus_sides: EXODUS_SIDES, ..FileOrders::SAME },
};

/// A function of the square at (s, t) with its slopes: a product of functions on the line.
fn in_square(degree: usize, node: &Point, (s, t): (f64, f64)) -> (f64, [f64; 2]) {
    let ((a, da), (b, db)) = (line(degree, node[0], s), line(degree, node[1], t));
    (a * b, [da * b, a * db])
}

fn values(x: &Point, out: &mut [f64]) {
    let (s, t, size) = collapsed(x);
    for node in BASE {
        out[node] = size * size * in_square(2, &NODES[node], (s, t)).0;
    }
    for (vertex, middle) in UP.into_iter().enumerate() {
        let upright = size * x[2] * in_square(1, &NODES[vertex], (s, t)).0;
        out[vertex] -= upright;
        out[middle] = 4.0 * upright;
    }
    out[4] = x[2] * (2.0 * x[2] - 1.0);
}

/// With r = 1 − z the function r² f(s, t) has the slopes r f_s, r f_t and r (s f_s + t f_t − 2 f), and r z f(s, t) has
/// the slopes z f_s, z f_t and z (s f_s + t f_t − f) + r f.
fn slopes(x: &Point, out: &mut [Point]) {
    let ((s, t, size), z) = (collapsed(x), x[2]);
    for node in BASE {
        let (f, [by_s, by_t]) = in_square(2, &NODES[node], (s, t));
        out[node] = [size * by_s, size * by_t, size * (s * by_s + t * by_t - 2.0 * f)];
    }
    for (vertex, middle) in UP.into_iter().enumerate() {
        let (f, [by_s, by_t]) = in_square(1, &NODES[vertex], (s, t));
        let upright = [z * by_s, z * by_t, z * (s * by_s + t * by_t - f) + size * f];
        out[vertex] = std::array::from_fn(|d| out[vertex][d] - upright[d]);
        out[middle] = upright.map(|slope| 4.0 * slope);
    }
    out[4] = [0.0, 0.0, 4.0 * z - 1.0];
}

/// Quadratic pyramid with 14 nodes: biquadratic on the base, quadratic on the other faces, hence rational inside.
///
/// With r = 1 − z, s = x/r and t = y/r its functions span 1, r Q₁(s, t) and r² Q₂(s, t), which contain all quadratic
/// polynomials (Bergot, Cohen, Duruflé, 2010). The functions of the base nodes are r² L, minus r z B at a vertex; those
/// in the middle of an edge to the apex are 4 r z B, with the biquadratic L and bilinear B of the square; that of the
/// apex is z (2z − 1). With serendipity instead of biquadratic functions on the base they are the functions of 13 nodes
/// (Bedrosian, 1992).
///
/// The gradients have degree 2 in s and in t and degree 1 in z, the functions degree 2 in each. Rules on pyramids are
/// products of rules in s, t and z, with two more degrees in z for the weight r². So a rule of degree 4 is exact for
/// products of two functions or gradients although they are no polynomials of (x, y, z), and for the volumes of curved
/// cells, whose determinants have degree 5 in s and in t and degree 3 in z.
///
/// The gradients at the apex depend on the direction of approach; those along s = t = ½ are used. Quadrature rules have
/// no point there.
pub static P2_PYRAMID: Element = Element {
    name: "P2 pyramid",
    shape: Shape::Pyramid,
    degree: 2,
    gradient_degree: 2,
    neighbours: 50.0,
    nodes: &NODES,
    facets: &[
        Facet { element: &Q2_QUADRILATERAL, nodes: &[0, 3, 2, 1, 8, 7, 6, 5, 13] },
        Facet { element: &P2_TRIANGLE, nodes: &[0, 1, 4, 5, 10, 9] },
        Facet { element: &P2_TRIANGLE, nodes: &[1, 2, 4, 6, 11, 10] },
        Facet { element: &P2_TRIANGLE, nodes: &[2, 3, 4, 7, 12, 11] },
        Facet { element: &P2_TRIANGLE, nodes: &[3, 0, 4, 8, 9, 12] },
    ],
    shape_functions: values,
    gradients: slopes,
    children,
    types: &[
        CellType::new("14-node pyramid", 14).gmsh(14),
        CellType::new("13-node pyramid", 13).vtk(27).gmsh(19).aster("P13", "PYRAM13"),
    ],
    orders: FileOrders {
        // Gmsh orders the edges by their first vertex: 01, 03, 04, 12, 14, 23, 24, 34.
        gmsh: FileOrder(&[0, 1, 2, 3, 4, 5, 8, 9, 6, 10, 7, 11, 12, 13]),
        exodus_sides: EXODUS_SIDES,
        ..FileOrders::SAME
    },
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::ShapeTable;

    /// ∫ N_i N_j and ∫ ∂N_i/∂x_c ∂N_j/∂x_c over the reference cell by a rule.
    fn products(degree: usize) -> Vec<f64> {
        let (table, n) = (ShapeTable::new(&P2_PYRAMID, degree), NODES.len());
        let mut sums = vec![0.0; 4 * n * n];
        for (q, weight) in table.weights.iter().enumerate() {
            let (values, gradients) = (table.values(q), table.gradients(q));
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                sums[4 * (n * i + j)] += weight * values[i] * values[j];
                (0..3).for_each(|c| sums[4 * (n * i + j) + c + 1] += weight * gradients[i][c] * gradients[j][c]);
            }
        }
        sums
    }

    /// The rule used by the forms is exact, and no rule of a lower degree is.
    #[test]
    fn products_of_functions_and_gradients_are_integrated_exactly() {
        let (exact, degree) = (products(12), 2 * P2_PYRAMID.gradient_degree);
        let error = |degree| products(degree).iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error(degree) < 1e-14, "{:e}", error(degree));
        assert!(error(degree - 1) > 1e-4, "{:e}", error(degree - 1));
    }

    /// The functions of thirteen nodes as Bedrosian (1992) gives them, over the base [−1, 1]².
    fn bedrosian([x, y, z]: Point) -> [f64; 13] {
        let (a, b) = (2.0 * x - (1.0 - z), 2.0 * y - (1.0 - z));
        let vertex = |p: f64, q: f64| {
            let bilinear = (1.0 + p * a) * (1.0 + q * b) - z + p * q * a * b * z / (1.0 - z);
            0.25 * (p * a + q * b - 1.0) * bilinear
        };
        let edge =
            |along: f64, across: f64| (1.0 + along - z) * (1.0 - along - z) * (1.0 + across - z) / (2.0 * (1.0 - z));
        let up = |p: f64, q: f64| z * (1.0 + p * a - z) * (1.0 + q * b - z) / (1.0 - z);
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let [n1, n2, n3, n4] = corners.map(|(p, q)| vertex(p, q));
        let [n10, n11, n12, n13] = corners.map(|(p, q)| up(p, q));
        let apex = z * (2.0 * z - 1.0);
        [n1, n2, n3, n4, apex, edge(a, -b), edge(b, a), edge(a, b), edge(b, -a), n10, n11, n12, n13]
    }

    /// With the centre of the base at −¼ Σ vertices + ½ Σ middles the 14 functions reduce to those of 13 nodes: a cell
    /// without that node keeps its shape.
    #[test]
    fn thirteen_nodes_are_a_part_of_fourteen() {
        for (x, _) in crate::quadrature::rule(Shape::Pyramid, 6).iter() {
            let mut values = [0.0; 14];
            (P2_PYRAMID.shape_functions)(x, &mut values);
            for (i, expected) in bedrosian(*x).into_iter().enumerate() {
                let share = if i < 4 { -0.25 } else { 0.5 * f64::from(u8::from((5..9).contains(&i))) };
                let found = values[i] + share * values[13];
                assert!((found - expected).abs() < 1e-15, "N_{i} at {x:?}: {found} and {expected}");
            }
        }
    }
}
