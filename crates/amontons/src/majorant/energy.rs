//! The complementary energy of σ̂ − σ_h in a cell, half the square of the constitutive relation error, as a function of
//! the tractions on its facets.

use super::Refused;
use super::balance::CellForces;
use super::discrete::CellStress;
use super::hexahedron::HexahedronShape;
use super::revolution::{KnownPoint, RevolvedTriangle};
use super::shapes::{CellShape, CellShapes, SimplexShape};
use super::skeleton::Skeleton;
use super::stress::{StepLaws, StepMotion};
use crate::mesh::CellMap;
use crate::tensor::Point;

/// ½ δ·G δ + h·δ + c of the components y = y_h + δ of the outward tractions, by facet, J. The differences to the
/// tractions y_h of the discrete stress are as small as the error, so that nothing cancels.
#[derive(Clone, Debug)]
pub(super) struct CellEnergy<'s> {
    gram: &'s [f64],
    discrete: Vec<f64>,
    linear: Vec<f64>,
    constant: f64,
}

impl CellEnergy<'_> {
    /// Number of components.
    pub fn len(&self) -> usize {
        self.linear.len()
    }

    /// G y.
    pub fn times(&self, y: &[f64], image: &mut [f64]) {
        image.fill(0.0);
        for (row, y) in self.gram.chunks_exact(y.len()).zip(y) {
            image.iter_mut().zip(row).for_each(|(sum, g)| *sum += g * y);
        }
    }

    /// G δ + h, and the energy, which round-off may make negative where it is zero.
    pub fn slope(&self, y: &mut [f64], slope: &mut [f64]) -> f64 {
        y.iter_mut().zip(&self.discrete).for_each(|(y, own)| *y -= own);
        self.times(y, slope);
        let sum: f64 = slope.iter().zip(&self.linear).zip(y).map(|((g, h), y)| (0.5 * g + h) * *y).sum();
        slope.iter_mut().zip(&self.linear).for_each(|(slope, h)| *slope += h);
        (sum + self.constant).max(0.0)
    }

    /// The largest component of the tractions of the discrete stress, N.
    pub fn size(&self) -> f64 {
        self.discrete.iter().fold(0.0, |most, y| most.max(y.abs()))
    }
}

/// Evaluates the energies of the cells of a mesh.
pub(super) struct EnergyEvaluation<'a> {
    pub laws: &'a StepLaws<'a>,
    pub skeleton: &'a Skeleton,
    /// The motion of σ_h.
    pub motion: &'a StepMotion<'a>,
    pub shapes: &'a CellShapes,
    /// The body force at a point of a region, N/m³.
    pub body_force: &'a (dyn Fn(usize, &CellMap) -> Point + Sync),
}

impl<'a> EnergyEvaluation<'a> {
    /// The energy of a cell with loads ∫ f φ.
    ///
    /// # Errors
    /// If the stiffness is not positive definite at a point.
    pub fn of_cell(&self, cell: usize, forces: &CellForces) -> Result<CellEnergy<'a>, Refused> {
        let (shape, facets) = (self.shapes.of(cell), &self.skeleton.cells[cell].facets);
        if let CellShape::Hexahedron(shape) = shape {
            return Ok(self.of_hexahedron((cell, shape), forces));
        }
        let stress = CellStress::new(self.laws, self.skeleton, self.motion, cell);
        let found = match shape {
            CellShape::Simplex(shape) => self.of_simplex((cell, shape), &stress, forces),
            CellShape::Quadrilateral(shape) => {
                let (region, nodes) = self.region_and_nodes(cell);
                let step = (self.laws, self.motion);
                shape.affine(step, (region, nodes), (&stress.moments, &forces.load_density()), &self.shapes.stresses)
            }
            CellShape::Hexahedron(_) => None,
        };
        let (slopes, constant) = found.ok_or_else(|| Refused::new("a stiffness that is not positive"))?;
        let dim = self.laws.mesh.dim;
        let mut energy = CellEnergy {
            gram: shape.gram(),
            discrete: Vec::with_capacity(facets.len() * dim * dim),
            linear: Vec::with_capacity(facets.len() * dim * dim),
            constant,
        };
        for ((&facet, moments), slopes) in facets.iter().zip(&stress.moments).zip(slopes.chunks_exact(dim)) {
            let modes = &self.skeleton.modes[facet];
            energy.discrete.extend_from_slice(&modes.of_moments(&moments[..dim])[..dim * dim]);
            energy.linear.extend_from_slice(&modes.slopes(slopes)[..dim * dim]);
        }
        Ok(energy)
    }

    fn region_and_nodes(&self, cell: usize) -> (usize, &'a [u32]) {
        (self.laws.region(self.skeleton, cell), self.skeleton.nodes(self.laws.mesh, cell))
    }

    fn of_hexahedron(&self, (cell, shape): (usize, &'a HexahedronShape), forces: &CellForces) -> CellEnergy<'a> {
        let mut energy = CellEnergy { gram: &shape.gram, discrete: Vec::new(), linear: Vec::new(), constant: 0.0 };
        let Some(table) = self.shapes.tables[self.skeleton.cells[cell].block].as_ref() else { return energy };
        let step = (self.laws, self.motion);
        let (moments, linear, constant) =
            shape.affine(step, self.region_and_nodes(cell), &forces.load_density(), table);
        for (&facet, moments) in self.skeleton.cells[cell].facets.iter().zip(&moments) {
            energy.discrete.extend(self.skeleton.modes[facet].of_moments(moments));
        }
        (energy.linear, energy.constant) = (linear, constant);
        energy
    }

    /// The slopes in the moments by facet and slot, and the value, where the moments are those of the discrete stress.
    fn of_simplex(
        &self,
        (cell, shape): (usize, &SimplexShape),
        stress: &CellStress,
        forces: &CellForces,
    ) -> Option<(Vec<Point>, f64)> {
        let (mesh, skeleton) = (self.laws.mesh, self.skeleton);
        let dim = mesh.dim;
        let facets = &skeleton.cells[cell].facets;
        // The vertex in the cell and the place in the composite element of each moment by facet and slot.
        let at = |(local, slot): (usize, usize)| {
            let vertex = skeleton.corner(mesh, (cell, facets[local]), slot);
            let opposite = skeleton.opposite(cell, local);
            (vertex, opposite * dim + if vertex > opposite { vertex - 1 } else { vertex })
        };
        let places: Vec<(usize, usize)> = (0..=dim).flat_map(|l| (0..dim).map(move |s| (l, s))).map(at).collect();
        let moments = || stress.moments.iter().flat_map(|moments| &moments[..dim]);
        let loads = forces.load.iter().copied().enumerate().take(dim + 1);
        let by_vertex = places.iter().zip(moments()).map(|((vertex, _), moment)| (*vertex, *moment));
        let missing = shape.form.missing(by_vertex.chain(loads), &stress.total);
        let deviation = if stress.is_linear {
            None
        } else {
            let mut ordered = vec![[0.0; 3]; places.len()];
            places.iter().zip(moments()).for_each(|((_, place), moment)| ordered[*place] = *moment);
            let known = self.at_points(cell)?;
            let (stresses, own) = (&self.shapes.stresses, (&ordered[..], &stress.total));
            Some(if mesh.axisymmetric {
                let vertices = skeleton.nodes(mesh, cell)[..3].iter().map(|&node| mesh.points[node as usize]);
                let triangle = RevolvedTriangle::new(&vertices.collect::<Vec<Point>>());
                triangle.deviation(&shape.form, stresses, own, |q| known[q])
            } else {
                shape.form.deviation(stresses, own, |q| (known[q].0, &known[q].1))
            })
        };
        let (slopes, constant) = shape.form.affine(&missing, deviation.as_ref());
        Some((places.iter().map(|(_, place)| slopes[*place]).collect(), constant))
    }

    /// The stress, the compliance and the first component of the body force at the points of a simplex.
    fn at_points(&self, cell: usize) -> Option<Vec<KnownPoint>> {
        let nodes = self.skeleton.nodes(self.laws.mesh, cell);
        let region = self.laws.region(self.skeleton, cell);
        let table = self.shapes.tables[self.skeleton.cells[cell].block].as_ref()?;
        let mut at = CellMap::new(self.laws.mesh, table);
        (0..self.shapes.stresses.points.len())
            .map(|q| {
                at.at(nodes, q);
                let compliance = self.laws.compliance(region, &at.position)?;
                let force = (self.body_force)(region, &at)[0];
                Some((self.laws.at(region, &at, nodes, self.motion), compliance, force))
            })
            .collect()
    }
}
