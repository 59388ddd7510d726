//! The complementary energy of the composite stresses of a simplex in the moments of its tractions and its mean.
//!
//! The moments are b = B b̂ with those of the reference simplex, and a stress in balance has the mean Σ sym(b ⊗ arm)
//! and T₀. Each b̂ and each component of T̂₀ = B⁻¹ T₀ B⁻ᵀ has one stress in the reference simplex. The energies of all
//! simplices are sums of the same products of these stresses, with the compliance Bᵀ C⁻¹ B.

use super::composite::{Composite, SimplexMap, volume};
use super::dense::product;
use super::stress::{LocalCompliance, StepLaws};
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
    /// The stresses at the points: per field, by point and component.
    at_points: Vec<Vec<f64>>,
    /// Their divergences, per field and part.
    divergences: Vec<Vec<Point>>,
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
        let mut fields = moment_fields_of(&composite);
        for k in 0..m {
            let mut data = vec![0.0; Composite::data(dim)];
            data[ReferenceStresses::moments(dim) + k] = 1.0;
            fields.push((0..n * n).map(|at| composite.at_node(&data, at / n, at % n)).collect());
        }
        let points = barycentric_points(dim, degree);
        let value = |field: &Vec<Sym>, point: &BarycentricPoint| {
            point.in_part.iter().enumerate().fold(Sym::ZERO, |sum, (node, a)| sum + *a * field[point.part * n + node])
        };
        let of_field = |field: &Vec<Sym>| -> Vec<f64> {
            points.iter().flat_map(|point| value(field, point).0.into_iter().take(m)).collect()
        };
        let at_points = fields.iter().map(of_field).collect();
        let divergences = fields.iter().map(|field| divergences(dim, field)).collect();
        ReferenceStresses { dim, points, at_points, divergences, products: products(dim, &fields) }
    }

    /// The stresses at a point, with their divergences there.
    pub fn fields(&self, q: usize) -> impl Iterator<Item = (Sym, &Point)> {
        let (m, part) = (mandel_len(self.dim), self.points[q].part);
        self.at_points.iter().zip(&self.divergences).map(move |(field, divergences)| {
            let own = &field[q * m..(q + 1) * m];
            (Sym(std::array::from_fn(|k| own.get(k).copied().unwrap_or(0.0))), &divergences[part])
        })
    }

    /// The stresses of the reference simplex, by point and component.
    fn stresses(&self, data: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.at_points.first().map_or(0, Vec::len)];
        for (field, x) in self.at_points.iter().zip(data) {
            sum.iter_mut().zip(field).for_each(|(sum, value)| *sum += x * value);
        }
        sum
    }
}

/// The stresses of the reference simplex at the nodes of its parts, one per moment, with the mean of a stress in
/// balance.
pub(super) fn moment_fields(dim: usize) -> Vec<Vec<Sym>> {
    moment_fields_of(&Composite::new(dim))
}

fn moment_fields_of(composite: &Composite) -> Vec<Vec<Sym>> {
    let dim = composite.dim;
    let (n, m) = (dim + 1, mandel_len(dim));
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
    fields
}

/// The divergence of a stress in each part.
fn divergences(dim: usize, field: &[Sym]) -> Vec<Point> {
    let n = dim + 1;
    let vertex = |v: usize| -> Point { std::array::from_fn(|c| f64::from(u8::from(v == c + 1))) };
    let centre: Point = std::array::from_fn(|c| if c < dim { 1.0 / n as f64 } else { 0.0 });
    let of_part = |part: usize| {
        let nodes: Vec<Point> = (0..n).map(|v| if v == part { centre } else { vertex(v) }).collect();
        let map = SimplexMap::new(dim, &nodes);
        let images = (0..n).map(|node| field[part * n + node].apply(&map.gradient(node)));
        images.fold([0.0; 3], |sum: Point, image| std::array::from_fn(|c| sum[c] + image[c]))
    };
    (0..n).map(of_part).collect()
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
    /// G of the moments, until it is taken.
    gram: Vec<f64>,
    /// G of all data with T̂₀.
    coupling: Vec<f64>,
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
        for (q, (point, compliance)) in stresses.points.iter().zip(compliance).enumerate() {
            let pulled = form.pulled(compliance);
            let mut places = sum.iter_mut();
            let at = q * m..(q + 1) * m;
            for (i, a) in stresses.at_points.iter().enumerate() {
                let a = &a[at.clone()];
                let strain: Vec<f64> =
                    (0..m).map(|l| point.weight * (0..m).map(|k| pulled[k][l] * a[k]).sum::<f64>()).collect();
                for (b, sum) in stresses.at_points[..=i].iter().zip(&mut places) {
                    *sum += strain.iter().zip(&b[at.clone()]).map(|(x, y)| x * y).sum::<f64>();
                }
            }
        }
        form.fill(&sum);
        form
    }

    /// A form that is zero.
    pub fn empty(stresses: &ReferenceStresses, vertices: &[Point], thickness: f64) -> SimplexForm {
        let share = 1.0 / vertices.len() as f64;
        let centre: Point = std::array::from_fn(|c| vertices.iter().map(|x| share * x[c]).sum());
        let arms = vertices.iter().map(|x| std::array::from_fn(|c| x[c] - centre[c])).collect();
        let size = ReferenceStresses::data(stresses.dim);
        let map = SimplexMap::new(stresses.dim, vertices);
        SimplexForm { map, arms, gram: Vec::new(), coupling: Vec::new(), size, thickness }
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

    /// Sets the matrix from its lower triangle.
    pub fn fill(&mut self, packed: &[f64]) {
        let n = ReferenceStresses::moments(self.map.dim);
        let at = |i: usize, j: usize| packed[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        self.gram = (0..n).flat_map(|i| (0..n).map(move |j| at(i, j))).collect();
        self.coupling = (0..self.size).flat_map(|i| (n..self.size).map(move |j| at(i, j))).collect();
    }

    /// Gives the part of G of all moments away, as a square matrix.
    pub fn take_moments(&mut self) -> Vec<f64> {
        std::mem::take(&mut self.gram)
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
        let product = |row: &[f64]| -> f64 { row.iter().zip(missing).map(|(a, b)| a * b).sum() };
        let mut slopes: Vec<f64> = self.coupling.chunks_exact(mandel_len(dim)).map(product).collect();
        let mut constant = 0.5 * slopes[n..].iter().zip(missing).map(|(a, b)| a * b).sum::<f64>();
        if let Some(deviation) = deviation {
            constant += deviation.energy + product(&deviation.slopes[n..]);
            slopes.iter_mut().zip(&deviation.slopes).for_each(|(a, b)| *a += b);
        }
        let slopes = slopes[..n].chunks_exact(dim).map(|slope| {
            let slope: Point = std::array::from_fn(|c| if c < dim { slope[c] } else { 0.0 });
            self.map.inverse_transposed_times(&slope)
        });
        (slopes.collect(), constant)
    }

    /// The data of the reference simplex of a stress with moments, by the places of the composite element, and an
    /// integral.
    pub fn data(&self, moments: &[Point], total: &Sym) -> Vec<f64> {
        let dim = self.map.dim;
        let mut data = Vec::with_capacity(self.size);
        for moment in moments {
            data.extend_from_slice(&self.map.inverse_times(moment)[..dim]);
        }
        let forces = moments.iter().enumerate().map(|(at, moment)| (vertex(dim, at), *moment));
        let rest = -1.0 * self.missing(forces, total);
        data.extend_from_slice(&self.map.pulled(&rest)[..mandel_len(dim)]);
        data
    }

    /// What a stress, known at the points with its strain C⁻¹σ by a function, has beside the composite stress with its
    /// moments, by the places of the composite element, and its integral.
    pub fn deviation<'c>(
        &self,
        stresses: &ReferenceStresses,
        (moments, total): (&[Point], &Sym),
        at: impl Fn(usize) -> (Sym, &'c LocalCompliance),
    ) -> Deviation {
        let (dim, data) = (self.map.dim, self.data(moments, total));
        let m = mandel_len(dim);
        let (mut strains, mut energy) = (Vec::with_capacity(stresses.points.len() * m), 0.0);
        let composite = stresses.stresses(&data);
        for (q, (point, composite)) in stresses.points.iter().zip(composite.chunks_exact(m)).enumerate() {
            let (stress, compliance) = at(q);
            let composite = Sym(std::array::from_fn(|k| composite.get(k).copied().unwrap_or(0.0)));
            let off = stress - self.thickness.recip() * self.map.stress(&composite);
            let strain = compliance.times(&off);
            let weight = point.weight * volume(dim);
            energy += 0.5 * weight * self.map.determinant * self.thickness * off.dot(&strain);
            strains.extend(self.map.strain(&strain).0.iter().take(m).map(|x| weight * x));
        }
        let slopes = stresses.at_points.iter().map(|field| 0.0 - product(field, &strains)).collect();
        Deviation { slopes, energy }
    }
}

/// The vertex of a moment in the order of the composite element.
pub(super) fn vertex(dim: usize, at: usize) -> usize {
    let (facet, place) = (at / dim, at % dim);
    if place < facet { place } else { place + 1 }
}

/// The form on a simplex; `None` if its stiffness is not positive definite. `at` goes to a point.
pub(super) fn form(
    laws: &StepLaws,
    region: usize,
    stresses: &ReferenceStresses,
    vertices: &[Point],
    mut at: impl FnMut(usize) -> Point,
) -> Option<SimplexForm> {
    let thickness = laws.mesh.thickness();
    if laws.varies(region) {
        let compliance: Option<Vec<LocalCompliance>> =
            (0..stresses.points.len()).map(|q| laws.compliance(region, &at(q))).collect();
        return Some(SimplexForm::varying(stresses, vertices, &compliance?, thickness));
    }
    Some(SimplexForm::new(stresses, vertices, &laws.compliance(region, &vertices[0])?, thickness))
}
