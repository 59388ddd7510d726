//! The complementary energy of σ̂ − σ_h in the cells: half the square of the constitutive relation error.

use super::balance::{CellForces, Moments, semidefinite};
use super::composite::{Affine, Composite};
use super::skeleton::{Skeleton, linear_functions};
use super::stress::{Laws, Motion};
use crate::element::{Element, ShapeTable};
use crate::mesh::CellMap;
use crate::quadrature::{QuadratureRule, Shape, rule};
use crate::tensor::{Point, Sym};

/// A simplex with the data of its composite stress, and where its points lie in the reference cell.
struct Part {
    map: Affine,
    vertices: Vec<Point>,
}

/// Evaluates composite stresses in the cells of a mesh.
pub(super) struct Evaluation<'a> {
    pub laws: &'a Laws<'a>,
    pub skeleton: &'a Skeleton,
    composite: Composite,
    /// Points of the parts of a simplex in barycentric coordinates, with weights that sum to 1.
    points: Vec<BarycentricPoint>,
    /// The tables of simplices at these points per block.
    tables: Vec<Option<ShapeTable>>,
}

/// A point of a part of the composite element: the part, its coordinates there, and those in the simplex.
struct BarycentricPoint {
    part: usize,
    in_part: Vec<f64>,
    in_simplex: Vec<f64>,
    weight: f64,
}

fn barycentric_points(dim: usize, degree: usize) -> Vec<BarycentricPoint> {
    let shape = [Shape::Segment, Shape::Triangle, Shape::Tetrahedron][dim - 1];
    let rule = rule(shape, degree);
    let n = dim + 1;
    let mut points = Vec::new();
    for part in 0..n {
        for (x, weight) in rule.iter() {
            let rest: f64 = 1.0 - x[..dim].iter().sum::<f64>();
            let in_part: Vec<f64> = std::iter::once(rest).chain(x[..dim].iter().copied()).collect();
            let centre = in_part[part] / n as f64;
            let in_simplex = (0..n).map(|v| centre + if v == part { 0.0 } else { in_part[v] }).collect();
            let weight = weight / shape.measure() / n as f64;
            points.push(BarycentricPoint { part, in_part, in_simplex, weight });
        }
    }
    points
}

impl<'a> Evaluation<'a> {
    /// The composite element on cells whose discrete stress is integrated well with this degree.
    pub fn new(laws: &'a Laws<'a>, skeleton: &'a Skeleton) -> Evaluation<'a> {
        let dim = laws.mesh.dim;
        let degree = |of: &super::skeleton::ElementTables| {
            let element = of.element;
            let stress = element.degree.max(element.gradient_degree).max(1);
            2 * stress + if element.is_simplex() { 2 } else { 4 }
        };
        let degree = skeleton.tables.iter().map(degree).max().unwrap_or(2);
        let points = barycentric_points(dim, degree);
        let table = |element: &'static Element| {
            let at = |point: &BarycentricPoint| -> Point {
                std::array::from_fn(|c| point.in_simplex.iter().zip(element.nodes).map(|(a, x)| a * x[c]).sum())
            };
            element.is_simplex().then(|| ShapeTable::at(element, &points.iter().map(at).collect::<Vec<_>>()))
        };
        let tables = skeleton.tables.iter().map(|tables| table(tables.element)).collect();
        Evaluation { laws, skeleton, composite: Composite::new(dim), points, tables }
    }

    /// ½ ∫ (σ̂ − σ_h):C⁻¹:(σ̂ − σ_h) over a cell, J. `motion` is that of σ_h, `total` the integral of the stress that
    /// is in balance.
    pub fn of_cell(
        &self,
        cell: usize,
        forces: &CellForces,
        moments: &Moments,
        (motion, total): (&Motion, &Sym),
    ) -> Option<f64> {
        match &self.tables[self.skeleton.cells[cell].block] {
            Some(table) => self.of_simplex(cell, moments, (motion, total), table),
            None => self.of_quadrilateral(cell, forces, moments, motion),
        }
    }

    /// The moment of the traction on a facet of a cell at a node, outward.
    fn moment(&self, cell: usize, local: usize, node: u32, moments: &Moments) -> Point {
        let facet = self.skeleton.cells[cell].facets[local];
        let of = &self.skeleton.facets[facet];
        let sign = of.sign(cell) / self.laws.mesh.thickness();
        of.place(node).map_or([0.0; 3], |place| moments[facet][place].map(|c| sign * c))
    }

    fn of_simplex(
        &self,
        cell: usize,
        moments: &Moments,
        (motion, total): (&Motion, &Sym),
        table: &ShapeTable,
    ) -> Option<f64> {
        let (mesh, nodes) = (self.laws.mesh, self.skeleton.nodes(self.laws.mesh, cell));
        let (dim, element) = (mesh.dim, self.skeleton.tables(cell).element);
        let vertices: Vec<Point> = nodes[..=dim].iter().map(|&node| mesh.points[node as usize]).collect();
        let map = Affine::new(dim, &vertices);
        // The facet opposite to a vertex is that without it.
        let opposite = |vertex: usize| {
            let corners = |local: usize| element.facets[local].nodes.iter().take(dim);
            (0..element.facets.len()).find(|&local| corners(local).all(|&node| node != vertex)).unwrap_or(0)
        };
        let locals: Vec<usize> = (0..=dim).map(opposite).collect();
        let moment = |facet: usize, vertex: usize| self.moment(cell, locals[facet], nodes[vertex], moments);
        let data = self.composite.pulled_back(&map, moment, &(mesh.thickness().recip() * *total));
        let at_nodes = self.at_nodes(&data, &map);
        let mut at = CellMap::new(mesh, table);
        let (region, mut sum) = (self.laws.region(self.skeleton, cell), 0.0);
        for (q, point) in self.points.iter().enumerate() {
            at.at(nodes, q);
            let difference = self.value(&at_nodes, point) - self.laws.at(region, &at, nodes, motion);
            let compliance = self.laws.compliance(region, &at.position)?;
            sum += 0.5 * point.weight * compliance.product(&difference, &difference);
        }
        Some(sum * map.determinant * super::composite::volume(dim) * mesh.thickness())
    }

    /// The stresses at the nodes of the parts of a simplex.
    fn at_nodes(&self, data: &[f64], map: &Affine) -> Vec<Sym> {
        let n = self.composite.dim + 1;
        (0..n * n).map(|at| map.stress(&self.composite.at_node(data, at / n, at % n))).collect()
    }

    fn value(&self, at_nodes: &[Sym], point: &BarycentricPoint) -> Sym {
        let n = self.composite.dim + 1;
        point.in_part.iter().enumerate().fold(Sym::ZERO, |sum, (node, a)| sum + *a * at_nodes[point.part * n + node])
    }

    /// A quadrilateral in four triangles about the mean of its vertices, with the tractions between them that make the
    /// complementary energy least.
    fn of_quadrilateral(&self, cell: usize, forces: &CellForces, moments: &Moments, motion: &Motion) -> Option<f64> {
        let (mesh, nodes) = (self.laws.mesh, self.skeleton.nodes(self.laws.mesh, cell));
        let corners: Vec<Point> = nodes[..4].iter().map(|&node| mesh.points[node as usize]).collect();
        let centre: Point = std::array::from_fn(|c| corners.iter().map(|x| 0.25 * x[c]).sum());
        let element = self.skeleton.tables(cell).element;
        let known: Vec<[Point; 2]> = (0..4)
            .map(|i| {
                let side = element.facets.iter().position(|facet| facet.nodes[..2] == [i, (i + 1) % 4]);
                let at = |node: usize| self.moment(cell, side.unwrap_or(i), nodes[node], moments);
                [at(i), at((i + 1) % 4)]
            })
            .collect();
        let parts: Vec<Part> = (0..4)
            .map(|i| {
                let vertices = vec![corners[i], corners[(i + 1) % 4], centre];
                Part { map: Affine::new(2, &vertices), vertices }
            })
            .collect();
        let area: f64 = parts.iter().map(|part| 0.5 * part.map.determinant).sum();
        // The load per area: its moments are those of a constant.
        let load = forces.load.iter().fold([0.0; 3], |sum: Point, f| std::array::from_fn(|c| sum[c] + f[c]));
        let load = load.map(|c| c / (area * mesh.thickness()));
        let quad = Quadrilateral { evaluation: self, cell, nodes, parts, known, load };
        quad.least(motion).map(|energy| energy * mesh.thickness())
    }
}

/// Number of unknown moments of a quadrilateral: two components at both ends of four lines to the centre.
const LINES: usize = 16;
/// Number of equations: two forces and a moment per triangle.
const EQUATIONS: usize = 12;

/// A quadrilateral in four triangles: triangle i has the vertices i, i + 1 and the centre.
struct Quadrilateral<'a> {
    evaluation: &'a Evaluation<'a>,
    cell: usize,
    nodes: &'a [u32],
    parts: Vec<Part>,
    /// Moments on the sides at both ends.
    known: Vec<[Point; 2]>,
    /// f, N/m³.
    load: Point,
}

impl Quadrilateral<'_> {
    /// Moments on triangle i by facet and vertex, as the composite element numbers them, of unknowns y: the line from
    /// vertex j has the moments y[4j..] at the vertex and y[4j + 2..] at the centre, outward for triangle j.
    fn moments(&self, i: usize, y: &[f64], with_known: bool) -> [[Point; 3]; 3] {
        let mut all = [[[0.0; 3]; 3]; 3];
        let next = (i + 1) % 4;
        if with_known {
            all[2][0] = self.known[i][0];
            all[2][1] = self.known[i][1];
        }
        for c in 0..2 {
            all[1][0][c] = y[4 * i + c];
            all[1][2][c] = y[4 * i + 2 + c];
            all[0][1][c] = -y[4 * next + c];
            all[0][2][c] = -y[4 * next + 2 + c];
        }
        all
    }

    /// Forces and moment of a triangle about the centre.
    fn resultants(&self, i: usize, moments: &[[Point; 3]; 3], with_load: bool) -> [f64; 3] {
        let Part { map, vertices } = &self.parts[i];
        let mut sum = [0.0; 3];
        let mut add = |x: &Point, force: &Point| {
            sum[0] += force[0];
            sum[1] += force[1];
            let arm = [x[0] - vertices[2][0], x[1] - vertices[2][1]];
            sum[2] += arm[0] * force[1] - arm[1] * force[0];
        };
        for facet in moments {
            facet.iter().zip(vertices).for_each(|(force, x)| add(x, force));
        }
        if with_load {
            let share = map.determinant / 6.0;
            vertices.iter().for_each(|x| add(x, &self.load.map(|c| c * share)));
        }
        sum
    }

    /// The stresses at the nodes of the parts of triangle i.
    fn stresses(&self, i: usize, moments: &[[Point; 3]; 3], with_load: bool) -> Vec<Sym> {
        let Part { map, vertices } = &self.parts[i];
        let share = if with_load { map.determinant / 6.0 } else { 0.0 };
        // ∫ σ = Σ x ⊗ (b + ∫ f φ), symmetric for tractions in balance.
        let mut total = [[0.0; 2]; 2];
        for (v, x) in vertices.iter().enumerate() {
            for (r, row) in total.iter_mut().enumerate() {
                let force: f64 = moments.iter().map(|facet| facet[v][r]).sum::<f64>() + share * self.load[r];
                (0..2).for_each(|c| row[c] += force * (x[c] - vertices[2][c]));
            }
        }
        let total = Sym::from_fn(2, |r, c| 0.5 * (total[r][c] + total[c][r]));
        let composite = &self.evaluation.composite;
        let data = composite.pulled_back(map, |facet, vertex| moments[facet][vertex], &total);
        self.evaluation.at_nodes(&data, map)
    }

    /// The points of triangle i in the reference cell.
    fn table(&self, i: usize) -> ShapeTable {
        let element = self.evaluation.skeleton.tables(self.cell).element;
        let corners: Vec<Point> = self.parts.iter().map(|part| part.vertices[0]).collect();
        let points: Vec<Point> = self
            .evaluation
            .points
            .iter()
            .map(|point| {
                let vertices = &self.parts[i].vertices;
                let x: Point = std::array::from_fn(|c| point.in_simplex.iter().zip(vertices).map(|(a, x)| a * x[c]).sum());
                in_reference(&corners, &x)
            })
            .collect();
        let weights = vec![1.0; points.len()];
        ShapeTable::of_rule(element, QuadratureRule { points, weights })
    }

    /// The least complementary energy of σ̂ − σ_h, per thickness.
    fn least(&self, motion: &Motion) -> Option<f64> {
        let laws = self.evaluation.laws;
        let region = laws.region(self.evaluation.skeleton, self.cell);
        let (mut gram, mut linear, mut constant) = ([[0.0; LINES]; LINES], [0.0; LINES], 0.0);
        let (mut rows, mut right) = (vec![[0.0; LINES]; EQUATIONS], [0.0; EQUATIONS]);
        for i in 0..4 {
            let own: Vec<usize> = (4 * i..4 * i + 4).chain(4 * ((i + 1) % 4)..4 * ((i + 1) % 4) + 4).collect();
            let unit = |k: usize| -> [f64; LINES] { std::array::from_fn(|j| f64::from(u8::from(j == k))) };
            let fixed = self.moments(i, &[0.0; LINES], true);
            let columns: Vec<[[Point; 3]; 3]> = own.iter().map(|&k| self.moments(i, &unit(k), false)).collect();
            let resultants = self.resultants(i, &fixed, true);
            (0..3).for_each(|e| right[3 * i + e] = 0.0 - resultants[e]);
            for (&k, column) in own.iter().zip(&columns) {
                let resultants = self.resultants(i, column, false);
                (0..3).for_each(|e| rows[3 * i + e][k] = resultants[e]);
            }
            let fixed = self.stresses(i, &fixed, true);
            let fields: Vec<Vec<Sym>> = columns.iter().map(|column| self.stresses(i, column, false)).collect();
            let (table, area) = (self.table(i), 0.5 * self.parts[i].map.determinant);
            let mut at = CellMap::new(laws.mesh, &table);
            for (q, point) in self.evaluation.points.iter().enumerate() {
                at.at(self.nodes, q);
                let compliance = laws.compliance(region, &at.position)?;
                let value = |field: &Vec<Sym>| self.evaluation.value(field, point);
                let first = value(&fixed) - laws.at(region, &at, self.nodes, motion);
                let weight = point.weight * area;
                constant += 0.5 * weight * compliance.product(&first, &first);
                let values: Vec<Sym> = fields.iter().map(value).collect();
                for (a, &k) in values.iter().zip(&own) {
                    linear[k] += weight * compliance.product(a, &first);
                    for (b, &l) in values.iter().zip(&own) {
                        gram[k][l] += weight * compliance.product(a, b);
                    }
                }
            }
        }
        let y = constrained(&gram, &linear, &rows, &right);
        let quadratic: f64 = (0..LINES).map(|k| y[k] * (0..LINES).map(|l| gram[k][l] * y[l]).sum::<f64>()).sum();
        let first: f64 = linear.iter().zip(&y).map(|(a, b)| a * b).sum();
        Some((0.5 * quadratic + first + constant).max(0.0))
    }
}

/// The least ½ y·G y + h·y among the y with A y = c, of equations that may depend on each other.
fn constrained(
    gram: &[[f64; LINES]; LINES],
    linear: &[f64; LINES],
    rows: &[[f64; LINES]],
    right: &[f64],
) -> Vec<f64> {
    let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    // Forces and moments have different units: rows of length 1.
    let sizes: Vec<f64> = rows.iter().map(|row| product(row, row).sqrt().max(f64::MIN_POSITIVE)).collect();
    let rows: Vec<Vec<f64>> =
        rows.iter().zip(&sizes).map(|(row, size)| row.iter().map(|x| x / size).collect()).collect();
    let right: Vec<f64> = right.iter().zip(&sizes).map(|(x, size)| x / size).collect();
    let normal: Vec<Vec<f64>> = rows.iter().map(|a| rows.iter().map(|b| product(a, b)).collect()).collect();
    let onto = |right: &[f64]| -> Vec<f64> {
        let (multipliers, _) = semidefinite(normal.clone(), right);
        (0..LINES).map(|k| rows.iter().zip(&multipliers).map(|(row, m)| row[k] * m).sum()).collect()
    };
    let first = onto(&right);
    // Z = I − Aᵀ(AAᵀ)⁺A by columns, then Z G Z + (I − Z) times a scale.
    let projected = |v: &[f64]| -> Vec<f64> {
        let across = onto(&rows.iter().map(|row| product(row, v)).collect::<Vec<_>>());
        v.iter().zip(&across).map(|(a, b)| a - b).collect()
    };
    let unit = |k: usize| -> Vec<f64> { (0..LINES).map(|j| f64::from(u8::from(j == k))).collect() };
    let columns: Vec<Vec<f64>> = (0..LINES).map(|k| projected(&unit(k))).collect();
    let scale = (0..LINES).map(|k| gram[k][k]).fold(0.0, f64::max);
    let times = |v: &[f64]| -> Vec<f64> { gram.iter().map(|row| product(row, v)).collect() };
    let matrix: Vec<Vec<f64>> = columns
        .iter()
        .enumerate()
        .map(|(k, column)| {
            let image = projected(&times(column));
            (0..LINES).map(|l| image[l] + scale * (f64::from(u8::from(k == l)) - column[l])).collect()
        })
        .collect();
    let slope: Vec<f64> = times(&first).iter().zip(linear).map(|(a, b)| 0.0 - a - b).collect();
    let (change, _) = semidefinite(matrix, &projected(&slope));
    let change = projected(&change);
    first.iter().zip(&change).map(|(a, b)| a + b).collect()
}

/// The reference coordinates of a point of a convex quadrilateral, by Newton's method.
fn in_reference(corners: &[Point], x: &Point) -> Point {
    let mut at = [0.5, 0.5, 0.0];
    for _ in 0..32 {
        let shape = linear_functions(Shape::Quadrilateral, &crate::element::Q1_QUADRILATERAL, &at);
        let mut gradients = [[0.0; 3]; 4];
        (crate::element::Q1_QUADRILATERAL.gradients)(&at, &mut gradients);
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
