//! The complementary energy of σ̂ − σ_h in a cell, half the square of the constitutive relation error, as a function of
//! the moments of the tractions on its facets.

use super::balance::CellForces;
use super::composite::{Composite, SimplexMap, volume};
use super::dense::Constrained;
use super::skeleton::{ElementTables, Skeleton, linear_functions};
use super::stress::{StepLaws, StepMotion};
use crate::element::{Element, Q1_QUADRILATERAL, ShapeTable};
use crate::mesh::CellMap;
use crate::quadrature::{Shape, rule};
use crate::tensor::{Point, Sym};

/// ½ b·G b + h·b + c of the outward moments b, by facet, vertex of the facet and component, J.
#[derive(Clone, Debug)]
pub(super) struct CellEnergy {
    size: usize,
    gram: Vec<f64>,
    linear: Vec<f64>,
    constant: f64,
}

impl CellEnergy {
    fn new(size: usize) -> CellEnergy {
        CellEnergy { size, gram: vec![0.0; size * size], linear: vec![0.0; size], constant: 0.0 }
    }

    /// G entry.
    pub fn gram(&self, i: usize, j: usize) -> f64 {
        self.gram[i * self.size + j]
    }

    /// G b.
    pub fn times(&self, b: &[f64]) -> Vec<f64> {
        self.gram.chunks_exact(self.size).map(|row| row.iter().zip(b).map(|(a, b)| a * b).sum()).collect()
    }

    /// G b + h.
    pub fn slope(&self, b: &[f64]) -> Vec<f64> {
        self.times(b).iter().zip(&self.linear).map(|(a, b)| a + b).collect()
    }

    /// The energy, which round-off may make negative where it is zero.
    pub fn value(&self, b: &[f64]) -> f64 {
        let sum: f64 = self.times(b).iter().zip(&self.linear).zip(b).map(|((g, h), b)| (0.5 * g + h) * b).sum();
        (sum + self.constant).max(0.0)
    }

    /// The size of moments whose energy is that of the stress of the cell, N.
    pub fn size_of_moments(&self) -> f64 {
        let stiffest = (0..self.size).map(|k| self.gram(k, k)).fold(0.0, f64::max);
        if stiffest > 0.0 { (2.0 * self.constant / stiffest).sqrt() } else { 0.0 }
    }

    /// Adds ½ weight ‖Σ b_k f_k + first‖² of fields at a point, in the norm of the compliance.
    fn add(&mut self, weight: f64, compliance: &super::stress::LocalCompliance, first: &Sym, fields: &[(usize, Sym)]) {
        self.constant += 0.5 * weight * compliance.product(first, first);
        for (k, field) in fields {
            let strain = compliance.times(field);
            self.linear[*k] += weight * strain.dot(first);
            for (l, other) in fields {
                self.gram[k * self.size + l] += weight * strain.dot(other);
            }
        }
    }
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

/// Evaluates composite stresses in the cells of a mesh.
pub(super) struct StressEvaluation<'a> {
    laws: &'a StepLaws<'a>,
    skeleton: &'a Skeleton,
    motion: &'a StepMotion<'a>,
    composite: Composite,
    /// Points of the parts of a simplex.
    points: Vec<BarycentricPoint>,
    /// The tables of simplices at these points per block.
    tables: Vec<Option<ShapeTable>>,
}

impl<'a> StressEvaluation<'a> {
    /// The composite element on the cells, `motion` that of σ_h.
    pub fn new(laws: &'a StepLaws<'a>, skeleton: &'a Skeleton, motion: &'a StepMotion<'a>) -> StressEvaluation<'a> {
        let dim = laws.mesh.dim;
        let degree = |of: &ElementTables| {
            let element = of.element;
            let warm = if motion.theta.is_empty() { 0 } else { element.degree };
            2 * warm.max(element.gradient_degree).max(1) + if element.is_simplex() { 0 } else { 4 }
        };
        let varies = laws.mesh.blocks.iter().any(|block| laws.varies(block.region));
        let degree = skeleton.tables.iter().map(degree).max().unwrap_or(2) + if varies { 4 } else { 0 };
        let points = barycentric_points(dim, degree);
        let table = |element: &'static Element| {
            let at = |point: &BarycentricPoint| -> Point {
                std::array::from_fn(|c| point.in_simplex.iter().zip(element.nodes).map(|(a, x)| a * x[c]).sum())
            };
            element.is_simplex().then(|| ShapeTable::at(element, &points.iter().map(at).collect::<Vec<_>>()))
        };
        let tables = skeleton.tables.iter().map(|tables| table(tables.element)).collect();
        StressEvaluation { laws, skeleton, motion, composite: Composite::new(dim), points, tables }
    }

    /// The energy of a cell; `None` if its stiffness is not positive definite.
    pub fn of_cell(&self, cell: usize, forces: &CellForces) -> Option<CellEnergy> {
        match &self.tables[self.skeleton.cells[cell].block] {
            Some(table) => self.of_simplex(cell, forces, table),
            None => self.of_quadrilateral(cell, forces),
        }
    }

    fn of_simplex(&self, cell: usize, forces: &CellForces, table: &ShapeTable) -> Option<CellEnergy> {
        let (mesh, nodes) = (self.laws.mesh, self.skeleton.nodes(self.laws.mesh, cell));
        let (dim, element) = (mesh.dim, self.skeleton.tables(cell).element);
        let vertices: Vec<Point> = nodes[..=dim].iter().map(|&node| mesh.points[node as usize]).collect();
        let simplex = Simplex::new(&self.composite, vertices);
        let thickness = mesh.thickness();
        let loads: Vec<Point> = forces.load.iter().map(|force| force.map(|c| c / thickness)).collect();
        let first = simplex.stresses(&[], &loads);
        let mut columns = Vec::new();
        for facet in element.facets {
            let opposite = (0..=dim).find(|vertex| !facet.nodes[..dim].contains(vertex)).unwrap_or(0);
            for &vertex in &facet.nodes[..dim] {
                for c in 0..dim {
                    let unit = std::array::from_fn(|i| if i == c { thickness.recip() } else { 0.0 });
                    columns.push(simplex.stresses(&[(opposite, vertex, unit)], &[]));
                }
            }
        }
        let mut energy = CellEnergy::new(columns.len());
        let mut at = CellMap::new(mesh, table);
        let region = self.laws.region(self.skeleton, cell);
        let volume = simplex.map.determinant * volume(dim) * thickness;
        for (q, point) in self.points.iter().enumerate() {
            at.at(nodes, q);
            let first = self.value(&first, point) - self.laws.at(region, &at, nodes, self.motion);
            let fields: Vec<(usize, Sym)> =
                columns.iter().map(|column| self.value(column, point)).enumerate().collect();
            energy.add(point.weight * volume, &self.laws.compliance(region, &at.position)?, &first, &fields);
        }
        Some(energy)
    }

    fn value(&self, at_nodes: &[Sym], point: &BarycentricPoint) -> Sym {
        let n = self.composite.dim + 1;
        point.in_part.iter().enumerate().fold(Sym::ZERO, |sum, (node, a)| sum + *a * at_nodes[point.part * n + node])
    }

    /// A quadrilateral in four triangles about the mean of its vertices, with the tractions between them that make the
    /// complementary energy least.
    fn of_quadrilateral(&self, cell: usize, forces: &CellForces) -> Option<CellEnergy> {
        let (mesh, nodes) = (self.laws.mesh, self.skeleton.nodes(self.laws.mesh, cell));
        let corners: Vec<Point> = nodes[..4].iter().map(|&node| mesh.points[node as usize]).collect();
        let centre: Point = std::array::from_fn(|c| corners.iter().map(|x| 0.25 * x[c]).sum());
        let of = |i: usize| Simplex::new(&self.composite, vec![corners[i], corners[(i + 1) % 4], centre]);
        let parts: Vec<Simplex> = (0..4).map(of).collect();
        let area: f64 = parts.iter().map(|part| 0.5 * part.map.determinant).sum();
        // The load per area: its moments are those of a constant.
        let load = forces.load.iter().fold([0.0; 3], |sum: Point, f| std::array::from_fn(|c| sum[c] + f[c]));
        let thickness = mesh.thickness();
        let load = load.map(|c| c / (area * thickness));
        Quadrilateral { evaluation: self, cell, nodes, corners, parts, load, thickness }.energy()
    }
}

/// A simplex with its composite stresses.
struct Simplex<'a> {
    composite: &'a Composite,
    map: SimplexMap,
    vertices: Vec<Point>,
    centre: Point,
}

impl<'a> Simplex<'a> {
    fn new(composite: &'a Composite, vertices: Vec<Point>) -> Simplex<'a> {
        let map = SimplexMap::new(composite.dim, &vertices);
        let share = 1.0 / vertices.len() as f64;
        let centre = std::array::from_fn(|c| vertices.iter().map(|x| share * x[c]).sum());
        Simplex { composite, map, vertices, centre }
    }

    /// The stresses at the nodes of the parts from moments of tractions, each by facet and vertex, and loads ∫ f φ of
    /// the vertices. The mean is that of a balance, ∫ σ = Σ x ⊗ (b + ∫ f φ), and symmetric.
    fn stresses(&self, moments: &[(usize, usize, Point)], loads: &[Point]) -> Vec<Sym> {
        let dim = self.composite.dim;
        let mut total = [[0.0; 3]; 3];
        let all = moments.iter().map(|(_, vertex, moment)| (*vertex, moment)).chain(loads.iter().enumerate());
        for (vertex, force) in all {
            for (r, row) in total.iter_mut().enumerate() {
                (0..dim).for_each(|c| row[c] += force[r] * (self.vertices[vertex][c] - self.centre[c]));
            }
        }
        let total = Sym::from_fn(dim, |r, c| 0.5 * (total[r][c] + total[c][r]));
        let data = self.composite.pulled_back(&self.map, moments, &total);
        let n = dim + 1;
        (0..n * n).map(|at| self.map.stress(&self.composite.at_node(&data, at / n, at % n))).collect()
    }

    /// Forces and moment of plane forces at vertices about the centre.
    fn resultants(&self, forces: impl Iterator<Item = (usize, Point)>) -> [f64; 3] {
        forces.fold([0.0; 3], |sum, (vertex, force)| {
            let arm = [0, 1].map(|c| self.vertices[vertex][c] - self.centre[c]);
            [sum[0] + force[0], sum[1] + force[1], sum[2] + arm[0] * force[1] - arm[1] * force[0]]
        })
    }
}

/// Moments of a quadrilateral on its sides, and between its triangles: two components at both ends of four lines.
const LINES: usize = 16;

/// A quadrilateral in four triangles: triangle i has the vertices i, i + 1 and the centre.
struct Quadrilateral<'a> {
    evaluation: &'a StressEvaluation<'a>,
    cell: usize,
    nodes: &'a [u32],
    corners: Vec<Point>,
    parts: Vec<Simplex<'a>>,
    /// f, N/m³.
    load: Point,
    thickness: f64,
}

impl Quadrilateral<'_> {
    /// Moments that act on triangle i: number of the unknown, facet, vertex, and the moment for a unit of it. The line
    /// from vertex j to the centre has the unknowns 16 + 4j…, at the vertex and the centre, outward for triangle j.
    fn moments(&self, i: usize) -> Vec<(usize, (usize, usize, Point))> {
        let facets = self.evaluation.skeleton.tables(self.cell).element.facets;
        let next = (i + 1) % 4;
        let mut all = Vec::new();
        let unit = |c: usize, size: f64| -> Point { std::array::from_fn(|k| if k == c { size } else { 0.0 }) };
        for c in 0..2 {
            for (side, facet) in facets.iter().enumerate() {
                for (place, &node) in facet.nodes[..2].iter().enumerate() {
                    if facet.nodes[..2].contains(&i) && facet.nodes[..2].contains(&next) {
                        let vertex = usize::from(node == next);
                        all.push((4 * side + 2 * place + c, (2, vertex, unit(c, self.thickness.recip()))));
                    }
                }
            }
            all.push((LINES + 4 * i + c, (1, 0, unit(c, 1.0))));
            all.push((LINES + 4 * i + 2 + c, (1, 2, unit(c, 1.0))));
            all.push((LINES + 4 * next + c, (0, 1, unit(c, -1.0))));
            all.push((LINES + 4 * next + 2 + c, (0, 2, unit(c, -1.0))));
        }
        all
    }

    /// The points of triangle i in the reference cell.
    fn table(&self, i: usize) -> ShapeTable {
        let element = self.evaluation.skeleton.tables(self.cell).element;
        let vertices = &self.parts[i].vertices;
        let of = |point: &BarycentricPoint| {
            let x = std::array::from_fn(|c| point.in_simplex.iter().zip(vertices).map(|(a, x)| a * x[c]).sum());
            in_reference(&self.corners, &x)
        };
        ShapeTable::at(element, &self.evaluation.points.iter().map(of).collect::<Vec<Point>>())
    }

    /// The energy in the moments on the sides, the least in those between the triangles.
    fn energy(&self) -> Option<CellEnergy> {
        let laws = self.evaluation.laws;
        let region = laws.region(self.evaluation.skeleton, self.cell);
        let mut all = CellEnergy::new(2 * LINES);
        let (mut rows, mut right) = (vec![vec![0.0; 2 * LINES]; 12], vec![0.0; 12]);
        for (i, part) in self.parts.iter().enumerate() {
            let moments = self.moments(i);
            let loads = vec![self.load.map(|c| c * part.map.determinant / 6.0); 3];
            let resultants = part.resultants(loads.iter().copied().enumerate());
            (0..3).for_each(|e| right[3 * i + e] = 0.0 - resultants[e]);
            for &(k, (_, vertex, moment)) in &moments {
                let resultants = part.resultants(std::iter::once((vertex, moment)));
                (0..3).for_each(|e| rows[3 * i + e][k] = resultants[e]);
            }
            let first = part.stresses(&[], &loads);
            let columns: Vec<(usize, Vec<Sym>)> =
                moments.iter().map(|&(k, moment)| (k, part.stresses(&[moment], &[]))).collect();
            let (table, volume) = (self.table(i), 0.5 * part.map.determinant * self.thickness);
            let mut at = CellMap::new(laws.mesh, &table);
            for (q, point) in self.evaluation.points.iter().enumerate() {
                at.at(self.nodes, q);
                let first =
                    self.evaluation.value(&first, point) - laws.at(region, &at, self.nodes, self.evaluation.motion);
                let fields: Vec<(usize, Sym)> =
                    columns.iter().map(|(k, column)| (*k, self.evaluation.value(column, point))).collect();
                all.add(point.weight * volume, &laws.compliance(region, &at.position)?, &first, &fields);
            }
        }
        Some(condensed(&all, &rows, &right))
    }
}

/// The least energy in the second half of the unknowns y under equations of all, A_b b + A_y y = c: y = Y b + y₀.
fn condensed(all: &CellEnergy, rows: &[Vec<f64>], right: &[f64]) -> CellEnergy {
    let inner = |i: usize, j: usize| all.gram(LINES + i, LINES + j);
    let gram: Vec<Vec<f64>> = (0..LINES).map(|i| (0..LINES).map(|j| inner(i, j)).collect()).collect();
    let of_rows: Vec<Vec<f64>> = rows.iter().map(|row| row[LINES..].to_vec()).collect();
    let problem = Constrained::new(gram, &of_rows);
    // The columns of (b, Y b) and the constant (0, y₀).
    let mut columns: Vec<Vec<f64>> = (0..LINES)
        .map(|k| {
            let linear: Vec<f64> = (0..LINES).map(|i| all.gram(LINES + i, k)).collect();
            let right: Vec<f64> = rows.iter().map(|row| 0.0 - row[k]).collect();
            let mut column: Vec<f64> = (0..LINES).map(|j| f64::from(u8::from(j == k))).collect();
            column.extend(problem.solve(&linear, &right));
            column
        })
        .collect();
    let mut fixed = vec![0.0; LINES];
    fixed.extend(problem.solve(&all.linear[LINES..], right));
    columns.push(fixed);
    let images: Vec<Vec<f64>> = columns.iter().map(|column| all.times(column)).collect();
    let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut energy = CellEnergy::new(LINES);
    let fixed = &columns[LINES];
    for k in 0..LINES {
        energy.linear[k] = product(&columns[k], &all.linear) + product(&columns[k], &images[LINES]);
        (0..LINES).for_each(|l| energy.gram[k * LINES + l] = product(&columns[k], &images[l]));
    }
    energy.constant = all.constant + product(fixed, &all.linear) + 0.5 * product(fixed, &images[LINES]);
    energy
}

/// The reference coordinates of a point of a convex quadrilateral, by Newton's method.
fn in_reference(corners: &[Point], x: &Point) -> Point {
    let mut at = [0.5, 0.5, 0.0];
    for _ in 0..32 {
        let shape = linear_functions(Shape::Quadrilateral, &Q1_QUADRILATERAL, &at);
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
