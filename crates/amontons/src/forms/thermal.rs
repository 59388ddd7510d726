//! Forms with temperature-dependent coefficients, as vectors of the nodal temperature, and their derivatives.

use std::sync::Arc;

use super::assembly::{CellPoint, assemble, by_cells, of_region};
use super::state::{strain, vector};
use super::works;
use crate::field::{Coefficient, Law};
use crate::linalg::{BlockMatrix, Graph};
use crate::material::{Dilatation, TensorLaw};
use crate::mesh::Mesh;
use crate::tensor::{Point, Sym, dot};

/// Step of a difference quotient in the temperature, as a fraction of the range of the coefficient.
const STEP: f64 = 1e-6;

/// The two temperatures around θ for a difference quotient; `None` if the range is empty.
fn around(temperatures: &[f64], theta: f64) -> Option<[f64; 2]> {
    let (first, last) = (*temperatures.first()?, *temperatures.last()?);
    let h = STEP * (last - first);
    let ends = [theta - h, theta + h].map(|end| end.max(first).min(last));
    (ends[1] > ends[0]).then_some(ends)
}

/// The derivative of a tensor in the temperature.
fn slope(coefficient: &Coefficient<Sym>, x: &Point, theta: f64) -> Sym {
    let Some([from, to]) = around(coefficient.temperatures(), theta) else { return Sym::ZERO };
    (1.0 / (to - from)) * (coefficient.at_temperature(x, to) - coefficient.at_temperature(x, from))
}

/// Sums per node of `form(cell, sums of the cell)`.
fn scalars(
    mesh: &Mesh,
    degree: impl Fn(&crate::element::Element) -> usize,
    form: impl Fn(&mut CellPoint, &mut [f64]) + Sync,
) -> Vec<f64> {
    let mut out = vec![0.0; mesh.points.len()];
    by_cells(
        mesh,
        degree,
        None,
        |e| e.nodes.len(),
        form,
        |nodes, _, sums| {
            for (&node, sum) in nodes.iter().zip(sums) {
                out[node as usize] += sum;
            }
        },
    );
    out
}

/// ∫ H(θ) η with the enthalpy H(θ) = ∫₀^θ c.
pub(crate) fn stored_heat(mesh: &Mesh, capacity: &[Coefficient<f64>], theta: &[f64]) -> Vec<f64> {
    scalars(
        mesh,
        |e| mesh.value_products(e, false),
        |cell, out| {
            let Some(capacity) = capacity.get(cell.region).or(capacity.last()) else { return };
            cell.integrate(|cell, weight| {
                let heat = weight * capacity.integral(&cell.map.position, cell.scalar(theta));
                for (out, value) in out.iter_mut().zip(cell.map.values()) {
                    *out += heat * value;
                }
            });
        },
    )
}

/// ∇θ at the point of a cell, from differences to its first node: exactly zero for a uniform temperature.
fn gradient(cell: &CellPoint, theta: &[f64]) -> Point {
    let first = cell.nodes.first().map_or(0.0, |&node| theta[node as usize]);
    let mut sum = [0.0; 3];
    for (&node, g) in cell.nodes.iter().zip(&cell.map.gradients) {
        let difference = theta[node as usize] - first;
        sum.iter_mut().zip(g).for_each(|(sum, g)| *sum += difference * g);
    }
    sum
}

/// d(θ, η) = ∫ 𝓚(θ)∇θ·∇η.
pub(crate) fn conduction(mesh: &Mesh, conductivity: &[Coefficient<Sym>], theta: &[f64]) -> Vec<f64> {
    scalars(
        mesh,
        |e| mesh.flux_products(e),
        |cell, out| {
            let Some(conductivity) = conductivity.get(cell.region).or(conductivity.last()) else { return };
            cell.integrate(|cell, weight| {
                let flux = cell.local(conductivity, theta).apply(&gradient(cell, theta));
                for (out, g) in out.iter_mut().zip(&cell.map.gradients) {
                    *out += weight * dot(&flux, g);
                }
            });
        },
    )
}

/// The additional term of the derivative of [`conduction`] besides ∫ 𝓚(θ)∇δ·∇η: ∫ δ 𝓚′(θ)∇θ·∇η, rows η, columns δ.
pub(crate) fn conduction_slope(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    conductivity: &[Coefficient<Sym>],
    theta: &[f64],
) -> BlockMatrix {
    assemble(
        mesh,
        graph,
        (1, 1),
        |e| mesh.flux_products(e),
        None,
        |cell, out| {
            let Some(conductivity) = conductivity.get(cell.region).or(conductivity.last()) else { return };
            cell.integrate(|cell, weight| {
                let slope = slope(conductivity, &cell.map.position, cell.scalar(theta));
                let (flux, values) = (slope.apply(&gradient(cell, theta)), cell.map.values());
                for (row, g) in out.chunks_exact_mut(values.len()).zip(&cell.map.gradients) {
                    for (out, value) in row.iter_mut().zip(values) {
                        *out += weight * dot(&flux, g) * value;
                    }
                }
            });
        },
    )
}

/// m(θ, v) = ∫ θ 𝓜(θ):ε(v).
pub(crate) fn expanded(
    mesh: &Mesh,
    expansion: &[Coefficient<Sym>],
    dilatation: &[Dilatation],
    theta: &[f64],
) -> Vec<f64> {
    vector(
        mesh,
        dilatation,
        |e| mesh.value_products(e, true),
        |cell| {
            let expansion = expansion.get(cell.region).or(expansion.last())?;
            Some(cell.scalar(theta) * cell.local(expansion, theta))
        },
    )
}

/// The derivative of [`expanded`]: ∫ δ (θ𝓜(θ))′:ε(v), rows v, columns δ.
pub(crate) fn expansion_slope(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    expansion: &[Coefficient<Sym>],
    dilatation: &[Dilatation],
    theta: &[f64],
) -> BlockMatrix {
    works(
        mesh,
        graph,
        dilatation,
        |e| mesh.value_products(e, true),
        |cell| {
            let expansion = expansion.get(cell.region).or(expansion.last())?;
            let here = cell.scalar(theta);
            Some(cell.local(expansion, theta) + here * slope(expansion, &cell.map.position, here))
        },
    )
}

/// The derivative of [`residual`](super::residual) in the temperature: ∫ δ ∂𝓔(θ, ε(u))/∂θ:ε(v), rows v, columns δ.
pub(crate) fn law_slope(
    mesh: &Mesh,
    graph: &Arc<Graph>,
    laws: &[&Law<dyn TensorLaw>],
    dilatation: &[Dilatation],
    [u, theta]: [&[f64]; 2],
) -> BlockMatrix {
    works(
        mesh,
        graph,
        dilatation,
        |e| mesh.gradient_products(e),
        |cell| {
            let law = of_region(laws, cell.region)?.graded()?;
            let (x, strain) = (&cell.map.position, strain(cell, u));
            let [from, to] = around(law.temperatures(), cell.scalar(theta))?;
            let at = |theta: f64| law.at_temperature(x, theta).value(x, &strain);
            Some((1.0 / (to - from)) * (at(to) - at(from)))
        },
    )
}
