//! The complementary energy of the composite stresses of a simplex in the moments of its tractions and its mean.
//!
//! Moments b = B b̂ and the mean T = Σ sym(b ⊗ arm) + T₀ of a stress in balance are those of the reference simplex,
//! T̂ = Σ sym(b̂ ⊗ â) + T̂₀: each b̂ and each component of T̂₀ has one stress there, whatever the simplex. The energies of
//! all simplices are sums of the same products of these stresses, with the compliance Bᵀ C⁻¹ B.

use super::composite::{Composite, SimplexMap, volume};
use super::stress::LocalCompliance;
use crate::quadrature::{Shape, rule};
use crate::tensor::{MANDEL, Point, Sym, mandel_len};

/// A point of a part of the composite element: the part, its coordinates there, and those in the simplex.
#[derive(Debug)]
pub(super) struct BarycentricPoint {
    pub part: usize,
    pub in_part: Vec<f64>,
    pub in_simplex: Vec<f64>,
    pub weight: f64,
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

/// The stresses of the reference simplex, one per moment and per component of T̂₀.
#[derive(Debug)]
pub(super) struct ReferenceStresses {
    pub dim: usize,
    /// Points of the parts of a simplex.
    pub points: Vec<BarycentricPoint>,
    /// The stresses at the points: `at_points[q][field]`.
    at_points: Vec<Vec<Sym>>,
    /// Means of products, per pair of components k ≤ l and then pair of fields i ≥ j.
    products: Vec<Vec<f64>>,
}

impl ReferenceStresses {
    /// Number of moments.
    pub fn moments(dim: usize) -> usize {
        (dim + 1) * dim * dim
    }

    /// Number of moments and components.
    pub fn data(dim: usize) -> usize {
        Composite::data(dim)
    }

    /// The stresses, and points at which polynomials of a degree are integrated.
    pub fn new(dim: usize, degree: usize) -> ReferenceStresses {
        let (n, m) = (dim + 1, mandel_len(dim));
        let composite = Composite::new(dim);
        let mut fields: Vec<Vec<Sym>> = Vec::new();
        for facet in 0..n {
            for vertex in (0..n).filter(|&vertex| vertex != facet) {
                for r in 0..dim {
                    let mut data = vec![0.0; Composite::data(dim)];
                    data[Composite::place(dim, facet, vertex) + r] = 1.0;
                    // The arm of the vertex from the centre.
                    let arm = |c: usize| f64::from(u8::from(vertex == c + 1)) - 1.0 / n as f64;
                    for (k, &(i, j)) in MANDEL.iter().enumerate().take(m) {
                        let [a, b] = [(i, j), (j, i)].map(|(i, j)| if i == r { arm(j) } else { 0.0 });
                        data[ReferenceStresses::moments(dim) + k] = 0.5 * (a + b);
                    }
                    fields.push((0..n * n).map(|at| composite.at_node(&data, at / n, at % n)).collect());
                }
            }
        }
        for k in 0..m {
            let mut data = vec![0.0; Composite::data(dim)];
            data[ReferenceStresses::moments(dim) + k] = 1.0;
            fields.push((0..n * n).map(|at| composite.at_node(&data, at / n, at % n)).collect());
        }
        let points = barycentric_points(dim, degree);
        let value = |field: &Vec<Sym>, point: &BarycentricPoint| {
            point.in_part.iter().enumerate().fold(Sym::ZERO, |sum, (node, a)| sum + *a * field[point.part * n + node])
        };
        let at_points = points.iter().map(|point| fields.iter().map(|field| value(field, point)).collect()).collect();
        ReferenceStresses { dim, points, at_points, products: products(dim, &fields) }
    }

    /// The stress of the reference simplex at a point.
    fn stress(&self, q: usize, data: &[f64]) -> Sym {
        self.at_points[q].iter().zip(data).fold(Sym::ZERO, |sum, (field, x)| sum + *x * *field)
    }
}

/// The means of the products of components of all fields.
fn products(dim: usize, fields: &[Vec<Sym>]) -> Vec<Vec<f64>> {
    let (n, m) = (dim + 1, mandel_len(dim));
    // ∫ λ_a λ_b over a part is its volume times (1 + δ_ab)/(n (n + 1)).
    let share = 1.0 / (n * n * (n + 1)) as f64;
    let spread: Vec<Vec<Sym>> = fields
        .iter()
        .map(|field| {
            let of_part = |part: usize| field[part * n..(part + 1) * n].iter().fold(Sym::ZERO, |sum, s| sum + *s);
            (0..n * n).map(|at| share * (of_part(at / n) + field[at])).collect()
        })
        .collect();
    let mut all = Vec::new();
    for k in 0..m {
        for l in k..m {
            let mut packed = Vec::new();
            for (i, a) in fields.iter().enumerate() {
                for b in &spread[..=i] {
                    let mean = |k: usize, l: usize| -> f64 { a.iter().zip(b).map(|(a, b)| a.0[k] * b.0[l]).sum() };
                    packed.push(if k == l { mean(k, l) } else { mean(k, l) + mean(l, k) });
                }
            }
            all.push(packed);
        }
    }
    all
}

/// The energy of a simplex in the moments and T̂₀ of the reference simplex, divided by its thickness: ½ x·G x.
#[derive(Debug)]
pub(super) struct SimplexForm {
    pub map: SimplexMap,
    /// Arms of the vertices from the centre, m.
    pub arms: Vec<Point>,
    gram: Vec<f64>,
    size: usize,
    thickness: f64,
}

/// What a discrete stress has beside the composite stress with its moments and its mean.
#[derive(Debug)]
pub(super) struct Deviation {
    /// The slope of the energy in the data of the reference simplex.
    pub slopes: Vec<f64>,
    /// Its own energy, J.
    pub energy: f64,
}

impl SimplexForm {
    /// The form on a simplex with one compliance.
    pub fn new(
        stresses: &ReferenceStresses,
        vertices: &[Point],
        compliance: &LocalCompliance,
        thickness: f64,
    ) -> SimplexForm {
        let mut form = SimplexForm::empty(stresses, vertices, thickness);
        let packed = form.pulled(compliance);
        let mut sum = vec![0.0; stresses.products.first().map_or(0, Vec::len)];
        let m = mandel_len(stresses.dim);
        let pairs = (0..m).flat_map(|k| (k..m).map(move |l| (k, l)));
        for ((k, l), products) in pairs.zip(&stresses.products) {
            let factor = packed[k][l];
            sum.iter_mut().zip(products).for_each(|(sum, x)| *sum += factor * x);
        }
        form.fill(&sum);
        form
    }

    /// The form on a simplex whose compliance varies, known at the points.
    pub fn varying(
        stresses: &ReferenceStresses,
        vertices: &[Point],
        compliance: &[LocalCompliance],
        thickness: f64,
    ) -> SimplexForm {
        let mut form = SimplexForm::empty(stresses, vertices, thickness);
        let mut sum = vec![0.0; form.size * (form.size + 1) / 2];
        let m = mandel_len(stresses.dim);
        for ((point, fields), compliance) in stresses.points.iter().zip(&stresses.at_points).zip(compliance) {
            let pulled = form.pulled(compliance);
            let mut places = sum.iter_mut();
            for (i, a) in fields.iter().enumerate() {
                let strain: Vec<f64> =
                    (0..m).map(|l| point.weight * (0..m).map(|k| pulled[k][l] * a.0[k]).sum::<f64>()).collect();
                for (b, sum) in fields[..=i].iter().zip(&mut places) {
                    *sum += strain.iter().zip(&b.0).map(|(x, y)| x * y).sum::<f64>();
                }
            }
        }
        form.fill(&sum);
        form
    }

    fn empty(stresses: &ReferenceStresses, vertices: &[Point], thickness: f64) -> SimplexForm {
        let share = 1.0 / vertices.len() as f64;
        let centre: Point = std::array::from_fn(|c| vertices.iter().map(|x| share * x[c]).sum());
        let arms = vertices.iter().map(|x| std::array::from_fn(|c| x[c] - centre[c])).collect();
        let size = ReferenceStresses::data(stresses.dim);
        let map = SimplexMap::new(stresses.dim, vertices);
        SimplexForm { map, arms, gram: vec![0.0; size * size], size, thickness }
    }

    /// The compliance for stresses of the reference simplex, times the volume.
    fn pulled(&self, compliance: &LocalCompliance) -> [[f64; 6]; 6] {
        let m = mandel_len(self.map.dim);
        let factor = volume(self.map.dim) * self.map.determinant / self.thickness;
        let unit = |k: usize| Sym(std::array::from_fn(|i| f64::from(u8::from(i == k))));
        let images: [Sym; 6] = std::array::from_fn(|k| if k < m { self.map.stress(&unit(k)) } else { Sym::ZERO });
        let strains = images.map(|image| compliance.times(&image));
        std::array::from_fn(|k| std::array::from_fn(|l| factor * images[k].dot(&strains[l])))
    }

    fn fill(&mut self, packed: &[f64]) {
        let mut values = packed.iter();
        for i in 0..self.size {
            for j in 0..=i {
                let value = values.next().copied().unwrap_or(0.0);
                self.gram[i * self.size + j] = value;
                self.gram[j * self.size + i] = value;
            }
        }
    }

    /// The part of G of all moments, as a square matrix.
    pub fn of_moments(&self) -> Vec<f64> {
        let n = ReferenceStresses::moments(self.map.dim);
        self.gram.chunks_exact(self.size).take(n).flat_map(|row| row[..n].iter().copied()).collect()
    }

    /// T₀ of moments and loads, by vertex, and the integral of a stress: what its mean has too little, N m.
    pub fn missing(&self, forces: impl Iterator<Item = (usize, Point)>, total: &Sym) -> Sym {
        let mut sum = [[0.0; 3]; 3];
        for (vertex, force) in forces {
            for (row, f) in sum.iter_mut().zip(&force) {
                row.iter_mut().zip(&self.arms[vertex]).for_each(|(sum, arm)| *sum += f * arm);
            }
        }
        Sym::from_fn(self.map.dim, |r, c| 0.5 * (sum[r][c] + sum[c][r])) - *total
    }

    /// The slopes of the energy in the moments b, by the places of the composite element, and its value at b = 0, from
    /// T₀ and what a discrete stress has beside the composite one.
    pub fn affine(&self, missing: &Sym, deviation: Option<&Deviation>) -> (Vec<Point>, f64) {
        let (dim, n) = (self.map.dim, ReferenceStresses::moments(self.map.dim));
        let missing = &self.map.pulled(missing)[..mandel_len(dim)];
        let product = |row: &[f64]| -> f64 { row[n..].iter().zip(missing).map(|(a, b)| a * b).sum() };
        let mut slopes: Vec<f64> = self.gram.chunks_exact(self.size).map(product).collect();
        let mut constant = 0.5 * slopes[n..].iter().zip(missing).map(|(a, b)| a * b).sum::<f64>();
        if let Some(deviation) = deviation {
            constant += deviation.energy + product(&deviation.slopes);
            slopes.iter_mut().zip(&deviation.slopes).for_each(|(a, b)| *a += b);
        }
        let slopes = slopes[..n].chunks_exact(dim).map(|slope| {
            let slope: Point = std::array::from_fn(|c| if c < dim { slope[c] } else { 0.0 });
            self.map.inverse_transposed_times(&slope)
        });
        (slopes.collect(), constant)
    }

    /// What a stress, known at the points with its strain C⁻¹σ by a function, has beside the composite stress with its
    /// moments, by the places of the composite element, and its integral.
    pub fn deviation(
        &self,
        stresses: &ReferenceStresses,
        (moments, total): (&[Point], &Sym),
        mut at: impl FnMut(usize) -> (Sym, LocalCompliance),
    ) -> Deviation {
        let dim = self.map.dim;
        let mut data = Vec::with_capacity(self.size);
        for moment in moments {
            data.extend_from_slice(&self.map.inverse_times(moment)[..dim]);
        }
        let forces = moments.iter().enumerate().map(|(at, moment)| (vertex(dim, at), *moment));
        let rest = -1.0 * self.missing(forces, total);
        data.extend_from_slice(&self.map.pulled(&rest)[..mandel_len(dim)]);
        let mut deviation = Deviation { slopes: vec![0.0; self.size], energy: 0.0 };
        let volume = volume(dim);
        for (q, point) in stresses.points.iter().enumerate() {
            let (stress, compliance) = at(q);
            let composite = self.map.stress(&stresses.stress(q, &data));
            let off = stress - self.thickness.recip() * composite;
            let strain = compliance.times(&off);
            let weight = point.weight * volume;
            deviation.energy += 0.5 * weight * self.map.determinant * self.thickness * off.dot(&strain);
            let pulled = self.map.strain(&strain);
            for (slope, field) in deviation.slopes.iter_mut().zip(&stresses.at_points[q]) {
                *slope -= weight * field.dot(&pulled);
            }
        }
        deviation
    }
}

/// The vertex of a moment in the order of the composite element.
pub(super) fn vertex(dim: usize, at: usize) -> usize {
    let (facet, place) = (at / dim, at % dim);
    if place < facet { place } else { place + 1 }
}
