//! Lagrange functions of the elements: on the line, their products, and on simplices.

use crate::tensor::Point;

/// Value and derivative at x of the Lagrange function on [0, 1] of a degree (1 or 2) that is 1 at `node` (0, ½ or 1).
pub(super) fn line(degree: usize, node: f64, x: f64) -> (f64, f64) {
    match (degree, node < 0.25, node > 0.75) {
        (1, true, _) => (1.0 - x, -1.0),
        (1, ..) => (x, 1.0),
        (_, true, _) => ((1.0 - x) * (1.0 - 2.0 * x), 4.0 * x - 3.0),
        (_, _, true) => (x * (2.0 * x - 1.0), 4.0 * x - 1.0),
        _ => (4.0 * x * (1.0 - x), 4.0 - 8.0 * x),
    }
}

/// Products of functions on the line in `dim` directions.
pub(super) fn product(dim: usize, degree: usize, nodes: &[Point], x: &Point, out: &mut [f64]) {
    for (value, node) in out.iter_mut().zip(nodes) {
        *value = (0..dim).map(|d| line(degree, node[d], x[d]).0).product();
    }
}

/// Gradients of [`product`].
pub(super) fn product_gradients(dim: usize, degree: usize, nodes: &[Point], x: &Point, out: &mut [Point]) {
    for (gradient, node) in out.iter_mut().zip(nodes) {
        *gradient = [0.0; 3];
        for (d, component) in gradient.iter_mut().enumerate().take(dim) {
            *component = (0..dim)
                .map(|e| if d == e { line(degree, node[e], x[e]).1 } else { line(degree, node[e], x[e]).0 })
                .product();
        }
    }
}

/// Barycentric coordinate `i` of a point of the unit simplex.
fn barycentric(dim: usize, i: usize, x: &Point) -> f64 {
    if i == 0 { x[..dim].iter().fold(1.0, |rest, c| rest - c) } else { x[i - 1] }
}

/// Component `d` of the gradient of barycentric coordinate `i`.
fn slope(i: usize, d: usize) -> f64 {
    if i == 0 {
        -1.0
    } else if i == d + 1 {
        1.0
    } else {
        0.0
    }
}

/// Quadratic functions on the unit simplex: λ(2λ − 1) at the vertices, 4 λ_a λ_b in the middle of the edges (a, b).
pub(super) fn quadratic(dim: usize, edges: &[(usize, usize)], x: &Point, out: &mut [f64]) {
    let (vertices, middles) = out.split_at_mut(dim + 1);
    for (i, value) in vertices.iter_mut().enumerate() {
        let l = barycentric(dim, i, x);
        *value = l * (2.0 * l - 1.0);
    }
    for (value, &(a, b)) in middles.iter_mut().zip(edges) {
        *value = 4.0 * barycentric(dim, a, x) * barycentric(dim, b, x);
    }
}

/// Gradients of [`quadratic`].
pub(super) fn quadratic_gradients(dim: usize, edges: &[(usize, usize)], x: &Point, out: &mut [Point]) {
    let (vertices, middles) = out.split_at_mut(dim + 1);
    let within = |f: &dyn Fn(usize) -> f64| std::array::from_fn(|d| if d < dim { f(d) } else { 0.0 });
    for (i, gradient) in vertices.iter_mut().enumerate() {
        let l = barycentric(dim, i, x);
        *gradient = within(&|d| (4.0 * l - 1.0) * slope(i, d));
    }
    for (gradient, &(a, b)) in middles.iter_mut().zip(edges) {
        let (la, lb) = (barycentric(dim, a, x), barycentric(dim, b, x));
        *gradient = within(&|d| 4.0 * (slope(a, d) * lb + la * slope(b, d)));
    }
}

/// Linear functions on the unit simplex.
pub(super) fn linear(dim: usize, x: &Point, out: &mut [f64]) {
    for (i, value) in out.iter_mut().enumerate().take(dim + 1) {
        *value = barycentric(dim, i, x);
    }
}

/// Gradients of [`linear`].
pub(super) fn linear_gradients(dim: usize, out: &mut [Point]) {
    for (i, gradient) in out.iter_mut().enumerate().take(dim + 1) {
        *gradient = std::array::from_fn(|d| if d < dim { slope(i, d) } else { 0.0 });
    }
}
