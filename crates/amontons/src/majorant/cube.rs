//! Stresses in balance on the cube [0, 1]³, of which parallelepipeds are affine images.
//!
//! The cube is cut into 24 tetrahedra about its centre and the middles of its facets: tetrahedron 4f + j has the
//! vertices j and j + 1 of facet f, the middle of f, and the centre. In each the stress is the composite one. The
//! balance of the tetrahedra does not depend on materials, nor on the parallelepiped: with the edges B of that,
//! stresses are B σ̂ Bᵀ/det B and moments B b̂. So the stresses of all parallelepipeds are combinations of the same
//! fields:
//!
//! 1. those without load and without tractions on the facets of the cube, an orthonormal basis of the tractions between
//!    the tetrahedra with which each of these is in balance;
//! 2. one per moment of the tractions on the triangles of the facets;
//! 3. one per component of a load that is constant.
//!
//! Fields of the second and third kind are in balance only together, if the cube is.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use rayon::prelude::*;

use super::composite::{SimplexMap, volume};
use super::dense::{Semidefinite, kernel, product};
use super::simplex::{moment_fields, vertex};
use super::skeleton::linear_functions;
use crate::element::{Element, Q1_HEXAHEDRON};
use crate::quadrature::{Shape, rule};
use crate::tensor::{Point, minus};

/// Moments of tractions on the facets: component c at vertex s of triangle j of facet f is 36f + 9j + 3s + c.
pub(super) const OUTER: usize = 216;
/// Moments of the tractions between the tetrahedra: on 24 triangles inside the pyramids of the facets, and on 12
/// between these.
const INNER: usize = 324;
const TETRAHEDRA: usize = 24;
/// Vertices of the four parts of a tetrahedron.
const NODES: usize = 16;
/// Independent components of stress.
const COMPONENTS: usize = 6;

/// A tetrahedron of the cube.
struct CubeTetrahedron {
    vertices: [Point; 4],
    /// Number and sign of each of its moments, component by component, in the order of the composite element.
    acting: Vec<(usize, f64)>,
}

fn mean(points: &[Point]) -> Point {
    std::array::from_fn(|c| points.iter().map(|x| x[c]).sum::<f64>() / points.len() as f64)
}

fn tetrahedra() -> Vec<CubeTetrahedron> {
    let mut edges: Vec<[usize; 2]> = Vec::new();
    let mut all = Vec::with_capacity(TETRAHEDRA);
    for (f, facet) in Q1_HEXAHEDRON.facets.iter().enumerate() {
        let corners: Vec<Point> = facet.nodes.iter().map(|&node| Q1_HEXAHEDRON.nodes[node]).collect();
        for j in 0..4 {
            let next = (j + 1) % 4;
            let (a, b) = (facet.nodes[j], facet.nodes[next]);
            let edge = [a.min(b), a.max(b)];
            let known = edges.iter().position(|own| *own == edge);
            let between = known.unwrap_or(edges.len());
            if known.is_none() {
                edges.push(edge);
            }
            let inside = |corner: usize| OUTER + 9 * (4 * f + corner);
            let slots = if a < b { [0, 1, 2] } else { [1, 0, 2] };
            // First number, sign and slots of the facet opposite to each vertex.
            let facets = [
                (inside(next), -1.0, [0, 1, 2]),
                (inside(j), 1.0, [0, 1, 2]),
                (OUTER + 9 * (TETRAHEDRA + between), if known.is_none() { 1.0 } else { -1.0 }, slots),
                (9 * (4 * f + j), 1.0, [0, 1, 2]),
            ];
            let acting = facets
                .iter()
                .flat_map(|&(first, sign, slots)| (0..9).map(move |at| (first + 3 * slots[at / 3] + at % 3, sign)));
            let vertices = [corners[j], corners[next], mean(&corners), [0.5; 3]];
            all.push(CubeTetrahedron { vertices, acting: acting.collect() });
        }
    }
    all
}

/// The rows of the balance of all tetrahedra, force and moment of each, in the moments and a load.
fn balance(all: &[CubeTetrahedron]) -> Vec<Vec<f64>> {
    let mut rows = vec![vec![0.0; OUTER + INNER + 3]; 6 * all.len()];
    for (of, rows) in all.iter().zip(rows.chunks_exact_mut(6)) {
        let centre = mean(&of.vertices);
        for (at, &(number, sign)) in of.acting.iter().enumerate() {
            let (arm, c) = (minus(&of.vertices[vertex(3, at / 3)], &centre), at % 3);
            let (next, last) = ((c + 1) % 3, (c + 2) % 3);
            rows[c][number] += sign;
            // e_c at the arm turns about the other axes.
            rows[3 + next][number] += sign * arm[last];
            rows[3 + last][number] -= sign * arm[next];
        }
        (0..3).for_each(|c| rows[c][OUTER + INNER + c] += 1.0 / TETRAHEDRA as f64);
    }
    rows
}

/// The moments of all fields: per moment, by field.
fn moments_of_fields(all: &[CubeTetrahedron]) -> Vec<Vec<f64>> {
    let rows = balance(all);
    let inner: Vec<Vec<f64>> = rows.iter().map(|row| row[OUTER..OUTER + INNER].to_vec()).collect();
    let free = kernel(&inner, INNER);
    let normal: Vec<Vec<f64>> = inner.iter().map(|a| inner.iter().map(|b| product(a, b)).collect()).collect();
    let normal = Semidefinite::new(&normal);
    let bound = free.len();
    let mut moments = vec![vec![0.0; bound + OUTER + 3]; OUTER + INNER];
    for (field, own) in free.iter().enumerate() {
        own.iter().enumerate().for_each(|(at, x)| moments[OUTER + at][field] = *x);
    }
    for datum in 0..OUTER + 3 {
        let column = if datum < OUTER { datum } else { datum + INNER };
        let right: Vec<f64> = rows.iter().map(|row| 0.0 - row[column]).collect();
        let multipliers = normal.solve(&right);
        for (row, x) in inner.iter().zip(&multipliers) {
            row.iter().enumerate().for_each(|(at, a)| moments[OUTER + at][bound + datum] += a * x);
        }
        if datum < OUTER {
            moments[datum][bound + datum] = 1.0;
        }
    }
    moments
}

/// The fields of the cube at the vertices of the parts of the tetrahedra, with their products.
#[derive(Debug)]
pub(super) struct CubeStresses {
    /// Number of fields that no tractions or loads cause: those come first.
    pub free: usize,
    /// Number of fields.
    pub fields: usize,
    /// Per component: by vertex of a part, then field.
    values: Vec<Vec<f64>>,
    /// ∫ of products per pair of components k ≤ l: the lower triangle by fields.
    products: Vec<Vec<f64>>,
    /// The tetrahedra, for points in them.
    vertices: Vec<[Point; 4]>,
}

impl CubeStresses {
    pub fn new() -> CubeStresses {
        let all = tetrahedra();
        let moments = moments_of_fields(&all);
        let fields = moments.first().map_or(0, Vec::len);
        let reference = moment_fields(3);
        let mut values = vec![vec![0.0; TETRAHEDRA * NODES * fields]; COMPONENTS];
        for (t, of) in all.iter().enumerate() {
            let map = SimplexMap::new(3, &of.vertices);
            for (at, &(number, sign)) in of.acting.iter().enumerate() {
                let unit: Point = std::array::from_fn(|c| f64::from(u8::from(c == at % 3)));
                let weights = map.inverse_times(&unit);
                for node in 0..NODES {
                    let sum = |r: usize| weights[r] * reference[at / 3 * 3 + r][node];
                    let stress = sign * map.stress(&(sum(0) + sum(1) + sum(2)));
                    for (values, x) in values.iter_mut().zip(&stress.0) {
                        let row = &mut values[(t * NODES + node) * fields..][..fields];
                        row.iter_mut().zip(&moments[number]).for_each(|(sum, moment)| *sum += x * moment);
                    }
                }
            }
        }
        let spread: Vec<Vec<f64>> = values.iter().map(|values| spread(values, fields)).collect();
        let pairs: Vec<(usize, usize)> = (0..COMPONENTS).flat_map(|k| (k..COMPONENTS).map(move |l| (k, l))).collect();
        let products = pairs.into_par_iter().map(|(k, l)| products(&values[k], &spread[l], (fields, k == l))).collect();
        let vertices = all.iter().map(|of| of.vertices).collect();
        CubeStresses { free: fields - OUTER - 3, fields, values, products, vertices }
    }

    /// The energies ∫ X:D:X of all fields, by field, with one D.
    pub fn energies(&self, compliance: &[[f64; 6]; 6]) -> Vec<f64> {
        let mut packed = vec![0.0; self.fields * (self.fields + 1) / 2];
        let pairs = (0..COMPONENTS).flat_map(|k| (k..COMPONENTS).map(move |l| (k, l)));
        for ((k, l), products) in pairs.zip(&self.products) {
            let factor = compliance[k][l];
            packed.iter_mut().zip(products).for_each(|(sum, x)| *sum += factor * x);
        }
        let at = |i: usize, j: usize| packed[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        (0..self.fields).flat_map(|i| (0..self.fields).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect()
    }

    /// ∫ of the components of all fields times the functions of an element: by component, field and function.
    fn with_functions(&self, element: &Element) -> Vec<Vec<f64>> {
        let n = element.nodes.len();
        let moments = part_moments(&self.vertices, element);
        let of = |values: &Vec<f64>| {
            let mut sum = vec![0.0; self.fields * n];
            for (row, moments) in values.chunks_exact(self.fields).zip(moments.chunks_exact(n)) {
                for (sum, x) in sum.chunks_exact_mut(n).zip(row) {
                    sum.iter_mut().zip(moments).for_each(|(sum, moment)| *sum += x * moment);
                }
            }
            sum
        };
        self.values.par_iter().map(of).collect()
    }
}

/// The products of the functions of an element with each other and with the fields of the cube.
#[derive(Debug)]
pub(super) struct NodalProducts {
    /// Number of functions.
    pub count: usize,
    /// ∫ of the components of the fields times the functions: by component, field and function.
    pub with_fields: Vec<Vec<f64>>,
    /// ∫ of the products of two functions.
    pub own: Vec<f64>,
}

impl NodalProducts {
    pub fn new(cube: &CubeStresses, element: &Element) -> NodalProducts {
        let count = element.nodes.len();
        NodalProducts { count, with_fields: cube.with_functions(element), own: function_products(element) }
    }
}

/// ∫ over the cube of the products of the functions of an element.
fn function_products(element: &Element) -> Vec<f64> {
    let n = element.nodes.len();
    let mut sum = vec![0.0; n * n];
    let mut values = vec![0.0; n];
    for (x, weight) in rule(Shape::Hexahedron, 2 * element.degree).iter() {
        (element.shape_functions)(x, &mut values);
        for (row, a) in sum.chunks_exact_mut(n).zip(&values) {
            row.iter_mut().zip(&values).for_each(|(sum, b)| *sum += weight * a * b);
        }
    }
    sum
}

/// ∫ of the linear function of each vertex of each part times the functions of an element.
fn part_moments(tetrahedra: &[[Point; 4]], element: &Element) -> Vec<f64> {
    let n = element.nodes.len();
    let mut all = Vec::with_capacity(tetrahedra.len() * NODES * n);
    let mut values = vec![0.0; n];
    let rule = rule(Shape::Tetrahedron, 3 * element.degree + 1);
    for vertices in tetrahedra {
        let centre = mean(vertices);
        for part in 0..4 {
            let corners: [Point; 4] = std::array::from_fn(|v| if v == part { centre } else { vertices[v] });
            let mut sum = vec![0.0; 4 * n];
            for (x, weight) in rule.iter() {
                let hats = linear_functions(Shape::Tetrahedron, element, x);
                let at = std::array::from_fn(|c| hats.iter().zip(&corners).map(|(a, x)| a * x[c]).sum());
                (element.shape_functions)(&at, &mut values);
                let weight = weight / volume(3) * PART;
                for (sum, hat) in sum.chunks_exact_mut(n).zip(&hats) {
                    sum.iter_mut().zip(&values).for_each(|(sum, value)| *sum += weight * hat * value);
                }
            }
            all.extend(sum);
        }
    }
    all
}

/// Volume of a part.
const PART: f64 = 1.0 / (4 * TETRAHEDRA) as f64;

/// The mass matrices of the parts, ∫ λ_a λ_b = |part| (1 + δ_ab)/20, times values.
fn spread(values: &[f64], fields: usize) -> Vec<f64> {
    let mut all = Vec::with_capacity(values.len());
    for part in values.chunks_exact(4 * fields) {
        let mut sum = vec![0.0; fields];
        for row in part.chunks_exact(fields) {
            sum.iter_mut().zip(row).for_each(|(sum, x)| *sum += x);
        }
        for row in part.chunks_exact(fields) {
            all.extend(row.iter().zip(&sum).map(|(x, sum)| PART / 20.0 * (x + sum)));
        }
    }
    all
}

/// The lower triangle of Xᵀ Y, to which its transpose is added for two components.
fn products(x: &[f64], y: &[f64], (fields, is_one): (usize, bool)) -> Vec<f64> {
    let mut sum = Mat::<f64>::zeros(fields, fields);
    let [x, y] = [x, y].map(|of| MatRef::from_row_major_slice(of, of.len() / fields, fields));
    matmul(sum.as_mut(), Accum::Replace, x.transpose(), y, 1.0, Par::Seq);
    let at = |i: usize, j: usize| if is_one { sum[(i, j)] } else { sum[(i, j)] + sum[(j, i)] };
    (0..fields).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect()
}
