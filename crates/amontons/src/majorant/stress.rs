//! The discrete stress and the compliance of the bodies in a step.

use super::Refused;
use super::skeleton::Skeleton;
use crate::element::ShapeTable;
use crate::material::Material;
use crate::mesh::{CellMap, Mesh};
use crate::problem::Problem;
use crate::tensor::{Point, Sym, SymMap, mandel_len};
use crate::time::Rule;

/// The springs of the Maxwell branches with one relaxation time τ: σ = 𝓖ε(z), z = c u + z₀.
#[derive(Debug)]
pub(super) struct RelaxingStress {
    /// c = 1/(1 + γ/τ).
    scale: f64,
    /// z₀, m, node-major.
    offset: Vec<f64>,
    /// 𝓖 per region.
    springs: Vec<SymMap>,
}

impl RelaxingStress {
    /// The springs with the relaxation time of a group of branches, which is uniform, and whose z is known at the end
    /// of a step.
    pub fn new(problem: &Problem, time: f64, rule: Rule, (z, u): (&[f64], &[f64])) -> RelaxingStress {
        let scale = if rule.is_steady() { 0.0 } else { 1.0 / (1.0 + rule.gamma / time) };
        let spring = |material: &Material| {
            let mut sum = SymMap([[0.0; 6]; 6]);
            let branches = material.prony.as_ref().map_or(&[][..], |prony| prony.branches());
            for branch in branches.iter().filter(|branch| branch.time.to_bits() == time.to_bits()) {
                add(&mut sum, 1.0, &branch.modulus);
            }
            sum
        };
        RelaxingStress {
            scale,
            offset: z.iter().zip(u).map(|(z, u)| z - scale * u).collect(),
            springs: problem.materials.iter().map(spring).collect(),
        }
    }

    fn spring(&self, region: usize) -> &SymMap {
        self.springs.get(region).unwrap_or(&self.springs[self.springs.len() - 1])
    }
}

/// Adds a multiple of a map.
fn add(sum: &mut SymMap, scale: f64, map: &SymMap) {
    for (row, other) in sum.0.iter_mut().zip(&map.0) {
        row.iter_mut().zip(other).for_each(|(a, b)| *a += scale * b);
    }
}

/// The elastic and viscous laws of a step from ū of length γ: σ = 𝓔ε(u) + 𝓥ε(u − ū)/γ + Σ 𝓖ε(z) − θ𝓜.
#[derive(Debug)]
pub(super) struct StepLaws<'a> {
    pub mesh: &'a Mesh,
    materials: &'a [Material],
    /// 1/γ in 1/s; zero in a steady step.
    rate: f64,
    relaxing: Vec<RelaxingStress>,
    /// Compliance, its size and the stiffness per region, or `None` if they vary in space.
    constant: Vec<Option<(LocalCompliance, f64, SymMap)>>,
}

/// (𝓔 + 𝓥/γ + Σ c𝓖)⁻¹ on 𝕊^d.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalCompliance {
    inverse: [[f64; 6]; 6],
    m: usize,
}

impl LocalCompliance {
    /// Inverts a symmetric positive definite map on 𝕊^d; `None` if it is not.
    pub fn new(map: &SymMap, dim: usize) -> Option<LocalCompliance> {
        let m = mandel_len(dim);
        let mut a = [[0.0; 12]; 6];
        for i in 0..m {
            for j in 0..m {
                a[i][j] = 0.5 * (map.0[i][j] + map.0[j][i]);
            }
            a[i][m + i] = 1.0;
        }
        for column in 0..m {
            // Elimination without pivoting has positive pivots only if the map is positive definite.
            let pivot = a[column][column];
            if pivot.is_nan() || pivot <= 0.0 {
                return None;
            }
            let own = a[column].map(|x| x / pivot);
            for (row, entries) in a.iter_mut().enumerate().take(m) {
                let factor = if row == column { 0.0 } else { entries[column] };
                entries.iter_mut().zip(&own).for_each(|(x, y)| *x -= factor * y);
            }
            a[column] = own;
        }
        let inverse = std::array::from_fn(|i| std::array::from_fn(|j| if i < m && j < m { a[i][m + j] } else { 0.0 }));
        Some(LocalCompliance { inverse, m })
    }

    /// C⁻¹:σ.
    pub fn times(&self, sigma: &Sym) -> Sym {
        Sym(std::array::from_fn(|i| (0..self.m).map(|j| self.inverse[i][j] * sigma.0[j]).sum()))
    }

    /// A size of the compliance in 1/Pa that does not depend on the axes.
    pub fn size(&self) -> f64 {
        self.inverse.iter().flatten().map(|x| x * x).sum::<f64>().sqrt()
    }
}

/// Displacements and the temperature of a step, node-major.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepMotion<'a> {
    pub u: &'a [f64],
    /// ū; used by viscosity alone.
    pub before: &'a [f64],
    /// θ, or empty if it has no stress.
    pub theta: &'a [f64],
}

impl<'a> StepLaws<'a> {
    /// The laws of a step.
    ///
    /// # Errors
    /// If the stiffness is not positive definite.
    pub fn new(problem: &'a Problem, rate: f64, relaxing: Vec<RelaxingStress>) -> Result<StepLaws<'a>, Refused> {
        let mesh: &Mesh = &problem.mesh;
        let mut laws = StepLaws { mesh, materials: &problem.materials, rate, relaxing, constant: Vec::new() };
        let regions = mesh.blocks.iter().map(|block| block.region + 1).max().unwrap_or(0);
        for region in 0..regions {
            let constant = if laws.varies(region) {
                None
            } else {
                let map = laws.stiffness(region, &[0.0; 3]);
                let compliance = LocalCompliance::new(&map, mesh.tensor_dim())
                    .ok_or_else(|| Refused::new("a stiffness that is not positive"))?;
                Some((compliance, compliance.size(), map))
            };
            laws.constant.push(constant);
        }
        Ok(laws)
    }

    fn material(&self, region: usize) -> &Material {
        self.materials.get(region).unwrap_or(&self.materials[self.materials.len() - 1])
    }

    /// True if the stiffness varies within a region.
    pub fn varies(&self, region: usize) -> bool {
        let material = self.material(region);
        material.elasticity.graded().is_some() || material.viscosity.graded().is_some()
    }

    /// True if the stress of a cell is linear in a simplex.
    pub fn is_linear(&self, skeleton: &Skeleton, cell: usize, motion: &StepMotion) -> bool {
        let (region, element) = (self.region(skeleton, cell), skeleton.tables(cell).element);
        let is_warm_linear = || element.degree <= 1 && self.material(region).expansion.constant().is_some();
        element.is_simplex()
            && element.gradient_degree <= 1
            && !self.varies(region)
            && !self.mesh.axisymmetric
            && (motion.theta.is_empty() || is_warm_linear())
    }

    fn stiffness(&self, region: usize, x: &Point) -> SymMap {
        let material = self.material(region);
        let mut map = material.elasticity.tangent(x, &Sym::ZERO);
        if self.rate > 0.0 {
            add(&mut map, self.rate, &material.viscosity.tangent(x, &Sym::ZERO));
        }
        for relaxing in &self.relaxing {
            add(&mut map, relaxing.scale, relaxing.spring(region));
        }
        map
    }

    /// C⁻¹ at a point of a region.
    pub fn compliance(&self, region: usize, x: &Point) -> Option<LocalCompliance> {
        match self.constant.get(region) {
            Some(Some((known, ..))) => Some(*known),
            _ => LocalCompliance::new(&self.stiffness(region, x), self.mesh.tensor_dim()),
        }
    }

    /// The size of C⁻¹ at a point of a region, 1/Pa; zero if the stiffness is not positive definite there.
    pub fn softness(&self, region: usize, x: &Point) -> f64 {
        match self.constant.get(region) {
            Some(Some((_, size, _))) => *size,
            _ => self.compliance(region, x).map_or(0.0, |compliance| compliance.size()),
        }
    }

    fn strain(&self, map: &CellMap, nodes: &[u32], values: &[f64]) -> Sym {
        let dim = self.mesh.dim;
        let mut gradient = [[0.0; 3]; 3];
        for (g, &node) in map.gradients.iter().zip(nodes) {
            for (row, u) in gradient.iter_mut().zip(&values[node as usize * dim..][..dim]) {
                (0..dim).for_each(|c| row[c] += u * g[c]);
            }
        }
        if self.mesh.axisymmetric {
            let radial = nodes.iter().zip(map.values()).map(|(&node, v)| v * values[node as usize * dim]);
            gradient[2][2] = radial.sum::<f64>() / map.position[0];
        }
        Sym::from_fn(self.mesh.tensor_dim(), |i, j| 0.5 * (gradient[i][j] + gradient[j][i]))
    }

    /// ε(u):C:ε(u), twice the density of energy of a field.
    pub fn energy(&self, region: usize, map: &CellMap, nodes: &[u32], u: &[f64]) -> f64 {
        let strain = self.strain(map, nodes, u);
        match self.constant.get(region) {
            Some(Some((_, _, stiffness))) => stiffness.apply(&strain).dot(&strain),
            _ => self.stiffness(region, &map.position).apply(&strain).dot(&strain),
        }
    }

    /// The stress at a point of a cell.
    pub fn at(&self, region: usize, map: &CellMap, nodes: &[u32], motion: &StepMotion) -> Sym {
        let material = self.material(region);
        let x = &map.position;
        let strain = self.strain(map, nodes, motion.u);
        let mut stress = material.elasticity.value(x, &strain);
        if self.rate > 0.0 {
            let change = strain - self.strain(map, nodes, motion.before);
            stress += self.rate * material.viscosity.value(x, &change);
        }
        for relaxing in &self.relaxing {
            let spring = relaxing.scale * strain + self.strain(map, nodes, &relaxing.offset);
            stress += relaxing.spring(region).apply(&spring);
        }
        if !motion.theta.is_empty() {
            let theta: f64 = nodes.iter().zip(map.values()).map(|(&node, v)| v * motion.theta[node as usize]).sum();
            stress = stress - theta * material.expansion.at(x);
        }
        let m = if self.mesh.axisymmetric { 4 } else { mandel_len(self.mesh.dim) };
        Sym(std::array::from_fn(|i| if i < m { stress.0[i] } else { 0.0 }))
    }

    /// ∫ σ:ε(N_i e_c) of a cell by node, then component, with the points of the forms of the body.
    pub fn forces(&self, skeleton: &Skeleton, cell: usize, motion: &StepMotion) -> Vec<Point> {
        let nodes = skeleton.nodes(self.mesh, cell);
        let region = self.region(skeleton, cell);
        let mut forces = vec![[0.0; 3]; nodes.len()];
        self.integrate(&skeleton.tables(cell).body, nodes, |map, weight| {
            let stress = self.at(region, map, nodes, motion);
            for (force, gradient) in forces.iter_mut().zip(&map.gradients) {
                let work = stress.apply(gradient);
                (0..3).for_each(|c| force[c] += weight * work[c]);
            }
            if self.mesh.axisymmetric {
                let hoop = weight * stress.get(2, 2) / map.position[0];
                forces.iter_mut().zip(map.values()).for_each(|(force, value)| force[0] += hoop * value);
            }
        });
        forces
    }

    /// ∫ σ_θθ N_i/r of a cell of a body of revolution by node, with the points of the forms of the body.
    pub fn hoop_forces(&self, skeleton: &Skeleton, cell: usize, motion: &StepMotion) -> Vec<f64> {
        let (nodes, region) = (skeleton.nodes(self.mesh, cell), self.region(skeleton, cell));
        let mut forces = vec![0.0; nodes.len()];
        self.integrate(&skeleton.tables(cell).body, nodes, |map, weight| {
            let hoop = weight * self.at(region, map, nodes, motion).get(2, 2) / map.position[0];
            forces.iter_mut().zip(map.values()).for_each(|(force, value)| *force += hoop * value);
        });
        forces
    }

    pub fn region(&self, skeleton: &Skeleton, cell: usize) -> usize {
        self.mesh.blocks[skeleton.cells[cell].block].region
    }

    /// Calls `at` with each point of a cell and its weight.
    pub fn integrate(&self, table: &ShapeTable, nodes: &[u32], mut at: impl FnMut(&CellMap, f64)) {
        let mut map = CellMap::new(self.mesh, table);
        for (q, weight) in table.weights.iter().enumerate() {
            map.at(nodes, q);
            let weight = weight * map.measure;
            at(&map, weight);
        }
    }
}
