//! Strains stored at the points of the cells, and the forms of linear laws on them.
//!
//! If the relaxation time of a branch varies over the body, the strain of its spring belongs to no displacement. It is
//! stored at the quadrature points of strain products, so that the forms need no interpolation.

use std::sync::Arc;

use super::assembly::{CellPoint, by_cells, of_region, strain_components};
use super::state::{strain, vector};
use super::stiffness;
use crate::element::{Element, ShapeTable};
use crate::field::Law;
use crate::linalg::{BlockMatrix, Graph};
use crate::material::{Dilatation, TensorLaw};
use crate::mesh::Mesh;
use crate::quadrature::rule;
use crate::tensor::{Point, Sym};

/// The points of the rule for strain products in all cells, in their order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrainPoints<'a> {
    pub mesh: &'a Mesh,
    pub dilatation: &'a [Dilatation],
}

impl StrainPoints<'_> {
    /// Numbers per strain at a point: the Mandel components that may be nonzero.
    pub fn components(&self) -> usize {
        strain_components(self.mesh)
    }

    /// The points of an element.
    pub fn table(&self, element: &'static Element) -> ShapeTable {
        ShapeTable::new(element, self.mesh.gradient_products(element))
    }

    /// Number of points in all cells.
    pub fn count(&self) -> usize {
        self.mesh.blocks.iter().map(|block| block.len() * self.table(block.element).len()).sum()
    }

    /// A function of region and position at all points.
    pub fn values(&self, of: impl Fn(usize, &Point) -> f64 + Sync) -> Vec<f64> {
        self.at_points(None, 1, |cell, _, out| out[0] = of(cell.region, &cell.map.position))
    }

    /// The strain of a displacement at all points.
    pub fn strains(&self, v: &[f64]) -> Vec<f64> {
        self.at_points(Some(self.dilatation), self.components(), |cell, _, out| {
            out.iter_mut().zip(strain(cell, v).0).for_each(|(out, component)| *out = component);
        })
    }

    /// The transposed of [`StrainPoints::strains`] times numbers at all points: a vector of nodes.
    pub fn strains_transposed(&self, numbers: &[f64]) -> Vec<f64> {
        let weights = self.at_points(None, 1, |_, weight, out| out[0] = weight);
        let n = self.components();
        let densities: Vec<f64> = numbers.iter().enumerate().map(|(i, number)| number / weights[i / n]).collect();
        let of = |cell: &CellPoint| Some(self.kept(&densities, cell.point));
        vector(self.mesh, self.dilatation, |e| self.mesh.gradient_products(e), of)
    }

    /// The transposed of [`StrainPoints::force`] times a vector of nodes: numbers at all points.
    pub fn force_transposed(&self, laws: &[&Law<dyn TensorLaw>], y: &[f64]) -> Vec<f64> {
        self.at_points(Some(self.dilatation), self.components(), |cell, weight, out| {
            let Some(law) = of_region(laws, cell.region) else { return };
            let stress = law.value(&cell.map.position, &strain(cell, y));
            out.iter_mut().zip(stress.0).for_each(|(out, component)| *out = weight * component);
        })
    }

    /// `size` numbers at each point, from its weight.
    fn at_points(
        &self,
        strains: Option<&[Dilatation]>,
        size: usize,
        of: impl Fn(&CellPoint, f64, &mut [f64]) + Sync,
    ) -> Vec<f64> {
        let mut all = Vec::with_capacity(size * self.count());
        by_cells(
            self.mesh,
            |e| self.mesh.gradient_products(e),
            strains,
            |e| size * rule(e.shape, self.mesh.gradient_products(e)).weights.len(),
            |cell, out| {
                let mut room = out.chunks_exact_mut(size);
                cell.integrate(|cell, weight| room.next().into_iter().for_each(|out| of(cell, weight, out)));
            },
            |_, _, values| all.extend_from_slice(values),
        );
        all
    }

    /// The stored strain at a point.
    pub fn kept(&self, strains: &[f64], point: usize) -> Sym {
        let (mut strain, n) = (Sym::ZERO, self.components());
        strain.0.iter_mut().zip(strains.iter().skip(point * n).take(n)).for_each(|(to, from)| *to = *from);
        strain
    }

    /// The vector of ∫ 𝓖e:ε(v) with the stored strains e.
    pub fn force(&self, laws: &[&Law<dyn TensorLaw>], strains: &[f64]) -> Vec<f64> {
        vector(
            self.mesh,
            self.dilatation,
            |e| self.mesh.gradient_products(e),
            |cell| Some(of_region(laws, cell.region)?.value(&cell.map.position, &self.kept(strains, cell.point))),
        )
    }

    /// ∫ e:𝓖e and ∫ c e:𝓖e with a factor c at each point.
    pub fn products(&self, laws: &[&Law<dyn TensorLaw>], strains: &[f64], factor: &[f64]) -> [f64; 2] {
        let mut sums = [0.0; 2];
        by_cells(
            self.mesh,
            |e| self.mesh.gradient_products(e),
            None,
            |_| 2,
            |cell, out| {
                let Some(law) = of_region(laws, cell.region) else { return };
                cell.integrate(|cell, weight| {
                    let e = self.kept(strains, cell.point);
                    let product = weight * law.value(&cell.map.position, &e).dot(&e);
                    out[0] += product;
                    out[1] += factor[cell.point] * product;
                });
            },
            |_, _, products| {
                for pair in products.as_chunks::<2>().0 {
                    sums.iter_mut().zip(pair).for_each(|(sum, term)| *sum += term);
                }
            },
        );
        sums
    }

    /// ∫ c 𝓖ε(u):ε(v) with a factor c at each point.
    pub fn form(&self, graph: &Arc<Graph>, laws: &[&Law<dyn TensorLaw>], factor: &[f64]) -> BlockMatrix {
        stiffness::assemble(self.mesh, graph, self.dilatation, laws, factor, |law, cell| {
            law.tangent(&cell.map.position, &Sym::ZERO)
        })
    }
}
