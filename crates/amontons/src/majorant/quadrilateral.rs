//! A quadrilateral in four triangles about the mean of its vertices: triangle i has the vertices i, i + 1 and the mean.
//!
//! The tractions between the triangles are those that make the complementary energy least under the balance of each.

use super::dense::{Constrained, congruent, product};
use super::simplex::{ReferenceStresses, SimplexForm, form, vertex};
use super::skeleton::{Skeleton, linear_functions};
use super::stress::{LocalCompliance, StepLaws, StepMotion};
use crate::element::{Q1_QUADRILATERAL, ShapeTable};
use crate::mesh::CellMap;
use crate::quadrature;
use crate::tensor::{Point, Sym, length, minus};

/// Moments of a quadrilateral on its sides, and between its triangles: two components at both ends of four lines.
const LINES: usize = 16;

/// Distance of a vertex from that of a parallelogram, relative to the first side, that counts as round-off.
const AFFINE: f64 = 1e-9;

/// True if a quadrilateral is no parallelogram.
pub(super) fn is_distorted(corners: &[Point]) -> bool {
    let off: Point = std::array::from_fn(|c| corners[0][c] - corners[1][c] + corners[2][c] - corners[3][c]);
    length(&off) > AFFINE * length(&minus(&corners[1], &corners[0]))
}

/// What quadrilaterals of one shape share.
#[derive(Debug)]
pub(super) struct QuadrilateralShape {
    /// G in the components of the tractions on the sides, the least in those between the triangles.
    pub gram: Vec<f64>,
    triangles: Vec<Triangle>,
    /// G of all moments.
    all: Vec<f64>,
    /// Balance of the triangles, per force and moment of each.
    rows: Vec<Vec<f64>>,
    /// The problem of the moments between the triangles.
    inner: Constrained,
    /// The least moments of a unit of each moment on the sides, all of them.
    columns: Vec<Vec<f64>>,
    /// The points of the triangles if these are the same in all parallelograms, else none.
    tables: Vec<ShapeTable>,
    /// The points of the lines from the vertices to the mean.
    lines: Vec<ShapeTable>,
    vertices: Vec<Point>,
    on_line: Vec<(Point, f64)>,
    /// The vertices and the mean.
    corners: ShapeTable,
    /// True if the strain of a bilinear function is linear.
    is_parallelogram: bool,
}

#[derive(Debug)]
struct Triangle {
    form: SimplexForm,
    /// Number, sign, place in the composite element and component of each moment that acts.
    acting: Vec<(usize, f64, usize, usize)>,
    area: f64,
}

/// The moments that act on triangle i. The line from vertex j to the mean has the moments 16 + 4j…, at the vertex and
/// the mean, outward for triangle j; those of the sides are in the order of their facets.
fn acting(skeleton: &Skeleton, nodes: &[u32], cell: usize, i: usize) -> Vec<(usize, f64, usize, usize)> {
    let next = (i + 1) % 4;
    let mut all = Vec::new();
    // Places of the composite element: facet and vertex (0: 1, 2), (1: 0, 2), (2: 0, 1).
    for c in 0..2 {
        for (side, &facet) in skeleton.cells[cell].facets.iter().enumerate() {
            let vertices = &skeleton.facets[facet].vertices;
            if vertices.contains(&nodes[i]) && vertices.contains(&nodes[next]) {
                for (slot, node) in vertices.iter().enumerate() {
                    all.push((4 * side + 2 * slot + c, 1.0, 4 + usize::from(*node == nodes[next]), c));
                }
            }
        }
        all.push((LINES + 4 * i + c, 1.0, 2, c));
        all.push((LINES + 4 * i + 2 + c, 1.0, 3, c));
        all.push((LINES + 4 * next + c, -1.0, 0, c));
        all.push((LINES + 4 * next + 2 + c, -1.0, 1, c));
    }
    all
}

impl Triangle {
    /// The moments that act, by the places of the composite element.
    fn moments(&self, of: &[f64]) -> [Point; 6] {
        let mut moments = [[0.0; 3]; 6];
        for &(number, sign, place, c) in &self.acting {
            moments[place][c] += sign * of[number];
        }
        moments
    }

    /// Forces and moment about the centre.
    fn resultants(&self, forces: impl Iterator<Item = (usize, Point)>) -> [f64; 3] {
        forces.fold([0.0; 3], |sum, (vertex, force)| {
            let arm = &self.form.arms[vertex];
            [sum[0] + force[0], sum[1] + force[1], sum[2] + arm[0] * force[1] - arm[1] * force[0]]
        })
    }
}

fn by_vertex(moments: &[Point; 6]) -> impl Iterator<Item = (usize, Point)> {
    moments.iter().enumerate().map(|(at, moment)| (vertex(2, at), *moment))
}

impl QuadrilateralShape {
    /// The shape of a cell; `None` if its stiffness is not positive definite.
    pub fn new(
        laws: &StepLaws,
        skeleton: &Skeleton,
        cell: usize,
        stresses: &ReferenceStresses,
    ) -> Option<QuadrilateralShape> {
        let nodes = skeleton.nodes(laws.mesh, cell);
        let corners: Vec<Point> = nodes[..4].iter().map(|&node| laws.mesh.points[node as usize]).collect();
        let centre: Point = std::array::from_fn(|c| corners.iter().map(|x| 0.25 * x[c]).sum());
        let element = skeleton.tables(cell).element;
        let mut shape = QuadrilateralShape {
            gram: Vec::new(),
            triangles: Vec::new(),
            all: vec![0.0; 4 * LINES * LINES],
            rows: vec![vec![0.0; 2 * LINES]; 12],
            inner: Constrained::new(Vec::new(), &[]),
            columns: Vec::new(),
            tables: Vec::new(),
            lines: Vec::new(),
            vertices: corners.clone(),
            on_line: quadrature::rule(quadrature::Shape::Segment, 2 * element.gradient_degree + 2)
                .iter()
                .map(|(x, weight)| (*x, weight))
                .collect(),
            corners: ShapeTable::at(
                element,
                &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 0.0]],
            ),
            is_parallelogram: !is_distorted(&corners),
        };
        let region = laws.region(skeleton, cell);
        for i in 0..4 {
            let vertices = [corners[i], corners[(i + 1) % 4], centre];
            let in_part = |weights: &[f64]| -> Point {
                std::array::from_fn(|c| weights.iter().zip(&vertices).map(|(a, x)| a * x[c]).sum())
            };
            if shape.is_parallelogram {
                shape.tables.push(shape.table(i, stresses));
            }
            let on_line = shape.on_line.iter().map(|(x, _)| in_part(&[1.0 - x[0], 0.0, x[0]]));
            let on_line: Vec<Point> = on_line.map(|x| in_reference(&corners, &x)).collect();
            shape.lines.push(ShapeTable::at(element, &on_line));
            let form = form(laws, region, stresses, &vertices, |q| in_part(&stresses.points[q].in_simplex))?;
            let acting = acting(skeleton, nodes, cell, i);
            let area = 0.5 * form.map.determinant;
            shape.triangles.push(Triangle { form, acting, area });
        }
        shape.condense(skeleton, cell);
        Some(shape)
    }

    /// The least energy in the second half of the moments x = (b, y) under A_b b + A_y y = c: y = Y b + y₀.
    fn condense(&mut self, skeleton: &Skeleton, cell: usize) {
        let n = 2 * LINES;
        for (i, triangle) in self.triangles.iter_mut().enumerate() {
            let moments = triangle.form.take_moments();
            let map = &triangle.form.map;
            let block: Vec<f64> = (0..4)
                .map(|at| {
                    let unit: Point = std::array::from_fn(|c| f64::from(u8::from(c == at % 2)));
                    map.inverse_times(&unit)[at / 2]
                })
                .collect();
            let blocks: Vec<(usize, Vec<f64>)> = (0..6).map(|place| (2 * place, block.clone())).collect();
            let gram = congruent(&moments, 2, &blocks);
            for &(a, sign, place, c) in &triangle.acting {
                for &(b, other, at, d) in &triangle.acting {
                    self.all[a * n + b] += sign * other * gram[(2 * place + c) * 12 + 2 * at + d];
                }
                let unit: Point = std::array::from_fn(|k| if k == c { sign } else { 0.0 });
                let resultants = triangle.resultants(std::iter::once((vertex(2, place), unit)));
                (0..3).for_each(|e| self.rows[3 * i + e][a] += resultants[e]);
            }
        }
        let inner = (LINES..n).map(|i| self.all[i * n + LINES..][..LINES].to_vec()).collect();
        let of_inner: Vec<Vec<f64>> = self.rows.iter().map(|row| row[LINES..].to_vec()).collect();
        self.inner = Constrained::new(inner, &of_inner);
        let column = |k: usize| {
            let linear: Vec<f64> = (LINES..n).map(|i| self.all[i * n + k]).collect();
            let right: Vec<f64> = self.rows.iter().map(|row| 0.0 - row[k]).collect();
            let mut column: Vec<f64> = (0..LINES).map(|j| f64::from(u8::from(j == k))).collect();
            column.extend(self.inner.solve(&linear, &right));
            column
        };
        self.columns = (0..LINES).map(column).collect();
        let images: Vec<Vec<f64>> = self.columns.iter().map(|column| self.times(column)).collect();
        let gram: Vec<f64> =
            self.columns.iter().flat_map(|a| images.iter().map(|b| product(a, b)).collect::<Vec<f64>>()).collect();
        let blocks = skeleton.cells[cell].facets.iter().enumerate().map(|(side, &facet)| {
            let mut block = vec![0.0; 16];
            for column in 0..4 {
                let mut y = [0.0; 9];
                y[column] = 1.0;
                let moments = skeleton.modes[facet].moments(&y);
                (0..4).for_each(|row| block[row * 4 + column] = moments[row / 2][row % 2]);
            }
            (4 * side, block)
        });
        self.gram = congruent(&gram, 4, &blocks.collect::<Vec<_>>());
    }

    fn times(&self, x: &[f64]) -> Vec<f64> {
        self.all.chunks_exact(2 * LINES).map(|row| product(row, x)).collect()
    }

    /// The slopes of the energy in the moments on the sides, by side and slot, and its value, where these moments are
    /// those of the discrete stress, under a load in N/m³.
    pub fn affine(
        &self,
        (laws, motion): (&StepLaws, &StepMotion),
        (region, nodes): (usize, &[u32]),
        (sides, load): (&[[Point; 4]], &Point),
        stresses: &ReferenceStresses,
    ) -> Option<(Vec<Point>, f64)> {
        let is_linear = self.is_linear(laws, region, motion);
        let base = self.discrete_moments((laws, motion), (region, nodes), sides, is_linear);
        let (mut linear, mut constant) = (vec![0.0; 2 * LINES], 0.0);
        let mut right = vec![0.0; 12];
        let thickness = laws.mesh.thickness();
        let corners = if is_linear { self.at_corners(laws, motion, (region, nodes)) } else { Vec::new() };
        for (i, triangle) in self.triangles.iter().enumerate() {
            let volume = triangle.area * thickness;
            let known =
                if is_linear { Vec::new() } else { self.at_points(laws, motion, (region, nodes), (i, stresses))? };
            let total = if is_linear {
                (volume / 3.0) * (corners[i] + corners[(i + 1) % 4] + corners[4])
            } else {
                let sum = known.iter().zip(&stresses.points);
                sum.fold(Sym::ZERO, |sum, ((stress, _), point)| sum + (point.weight * volume) * *stress)
            };
            let moments = triangle.moments(&base);
            let at = |q: usize| -> (Sym, &LocalCompliance) { (known[q].0, &known[q].1) };
            let deviation = (!is_linear).then(|| triangle.form.deviation(stresses, (&moments, &total), at));
            let loads = (0..3).map(|vertex| (vertex, load.map(|c| c * volume / 3.0)));
            let forces: Vec<(usize, Point)> = by_vertex(&moments).chain(loads).collect();
            let missing = triangle.form.missing(forces.iter().copied(), &total);
            let (slopes, own) = triangle.form.affine(&missing, deviation.as_ref());
            constant += own;
            for &(number, sign, place, c) in &triangle.acting {
                linear[number] += sign * slopes[place][c];
            }
            let resultants = triangle.resultants(forces.into_iter());
            (0..3).for_each(|e| right[3 * i + e] = 0.0 - resultants[e]);
        }
        let mut fixed = vec![0.0; LINES];
        fixed.extend(self.inner.solve(&linear[LINES..], &right));
        let image = self.times(&fixed);
        constant += product(&fixed, &linear) + 0.5 * product(&fixed, &image);
        let slope = |column: &Vec<f64>| product(column, &linear) + product(column, &image);
        let slopes: Vec<f64> = self.columns.iter().map(slope).collect();
        Some((slopes.chunks_exact(2).map(|s| [s[0], s[1], 0.0]).collect(), constant))
    }

    /// True if the discrete stress is linear: it is a composite stress in each triangle.
    fn is_linear(&self, laws: &StepLaws, region: usize, motion: &StepMotion) -> bool {
        let is_bilinear = self.corners.element.degree == 1;
        self.is_parallelogram && is_bilinear && motion.theta.is_empty() && !laws.varies(region)
    }

    /// The discrete stress at the vertices and the mean.
    fn at_corners(&self, laws: &StepLaws, motion: &StepMotion, (region, nodes): (usize, &[u32])) -> Vec<Sym> {
        let mut at = CellMap::new(laws.mesh, &self.corners);
        let stress = |q: usize| {
            at.at(nodes, q);
            laws.at(region, &at, nodes, motion)
        };
        (0..5).map(stress).collect()
    }

    /// The points of a triangle in the reference cell.
    fn table(&self, triangle: usize, stresses: &ReferenceStresses) -> ShapeTable {
        let x = &self.vertices;
        let centre: Point = std::array::from_fn(|c| x.iter().map(|x| 0.25 * x[c]).sum());
        let vertices = [x[triangle], x[(triangle + 1) % 4], centre];
        let of = |weights: &Vec<f64>| {
            let at: Point = std::array::from_fn(|c| weights.iter().zip(&vertices).map(|(a, x)| a * x[c]).sum());
            in_reference(x, &at)
        };
        let points: Vec<Point> = stresses.points.iter().map(|point| of(&point.in_simplex)).collect();
        ShapeTable::at(self.corners.element, &points)
    }

    /// The discrete stress and the compliance at the points of a triangle.
    fn at_points(
        &self,
        laws: &StepLaws,
        motion: &StepMotion,
        (region, nodes): (usize, &[u32]),
        (triangle, stresses): (usize, &ReferenceStresses),
    ) -> Option<Vec<(Sym, LocalCompliance)>> {
        let made;
        let table = if let Some(table) = self.tables.get(triangle) {
            table
        } else {
            made = self.table(triangle, stresses);
            &made
        };
        let mut at = CellMap::new(laws.mesh, table);
        let known = |q: usize| {
            at.at(nodes, q);
            Some((laws.at(region, &at, nodes, motion), laws.compliance(region, &at.position)?))
        };
        (0..table.len()).map(known).collect()
    }

    /// All moments of the discrete stress.
    fn discrete_moments(
        &self,
        (laws, motion): (&StepLaws, &StepMotion),
        (region, nodes): (usize, &[u32]),
        sides: &[[Point; 4]],
        is_linear: bool,
    ) -> Vec<f64> {
        let mut all: Vec<f64> = sides
            .iter()
            .take(4)
            .flat_map(|side| side[..2].iter().flat_map(|moment| moment[..2].iter().copied()))
            .collect();
        let corners = if is_linear { self.at_corners(laws, motion, (region, nodes)) } else { Vec::new() };
        for (i, triangle) in self.triangles.iter().enumerate() {
            // Length times normal, out of triangle i, of the side opposite to its second vertex.
            let normal = triangle.form.map.gradient(1).map(|c| -2.0 * c * triangle.area * laws.mesh.thickness());
            let mut moments = [[0.0; 3]; 2];
            let mut add = |traction: &Point, weights: [f64; 2]| {
                for (moment, weight) in moments.iter_mut().zip(weights) {
                    (0..2).for_each(|c| moment[c] += weight * traction[c]);
                }
            };
            if is_linear {
                add(&corners[i].apply(&normal), [1.0 / 3.0, 1.0 / 6.0]);
                add(&corners[4].apply(&normal), [1.0 / 6.0, 1.0 / 3.0]);
            } else {
                let mut at = CellMap::new(laws.mesh, &self.lines[i]);
                for (q, (x, weight)) in self.on_line.iter().enumerate() {
                    at.at(nodes, q);
                    let traction = laws.at(region, &at, nodes, motion).apply(&normal);
                    add(&traction, [weight * (1.0 - x[0]), weight * x[0]]);
                }
            }
            all.extend(moments.iter().flat_map(|moment| moment[..2].iter().copied()));
        }
        all
    }
}

/// The reference coordinates of a point of a convex quadrilateral, by Newton's method.
fn in_reference(corners: &[Point], x: &Point) -> Point {
    let mut at = [0.5, 0.5, 0.0];
    for _ in 0..32 {
        let shape = linear_functions(quadrature::Shape::Quadrilateral, &Q1_QUADRILATERAL, &at);
        let mut gradients = [[0.0; 3]; 4];
        (Q1_QUADRILATERAL.gradients)(&at, &mut gradients);
        let sum = |c: usize, of: &dyn Fn(usize) -> f64| -> f64 { (0..4).map(|v| of(v) * corners[v][c]).sum() };
        let off = [0, 1].map(|c| x[c] - sum(c, &|v| shape[v]));
        let j = [0, 1].map(|c| [0, 1].map(|d| sum(c, &|v| gradients[v][d])));
        let determinant = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        let change =
            [(j[1][1] * off[0] - j[0][1] * off[1]) / determinant, (j[0][0] * off[1] - j[1][0] * off[0]) / determinant];
        at[0] += change[0];
        at[1] += change[1];
        if change[0].abs() + change[1].abs() < 1e-15 {
            break;
        }
    }
    at
}
