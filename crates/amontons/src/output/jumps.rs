//! Jumps between cells: where a mesh is too coarse for a field.
//!
//! The gradient v of a discrete field jumps from cell to cell, that of a smooth one does not. At each vertex of a cell
//! v is compared with its mean v̄ over the cells of the region around the vertex: the square of the jumps of a cell K
//! is the mean of |v − v̄|² over its vertices times |K|, about ∫_K |v − v̄|². It shows where an error is, not how
//! large it is. Every cell counts alike in the mean: weighted by volumes, a large cell beside small ones would be the
//! mean, and its own jump, which is that of its size, would vanish.
//!
//! Source: O. C. Zienkiewicz, J. Z. Zhu, Int. J. Numer. Methods Eng. 24 (1987) 337–357.

use super::cells::{Evaluator, Tables};
use super::{OutputError, Sink, Snapshot};
use crate::arrays::all_at_once;
use crate::element::{Element, ShapeTable};
use crate::material::material_arrays;
use crate::mesh::{Block, CellMap, Mesh};
use crate::quadrature::{QuadratureRule, rule};
use crate::tensor::Point;

/// Points of a cell from which its values at the vertices follow: the centre, and, unless the gradients are constant,
/// the middles between it and the vertices. A vertex may lie on the axis of a body of revolution, where u_r/r has no
/// value.
fn points(element: &Element) -> QuadratureRule {
    let centre = element.centre();
    let mut points = vec![centre];
    if element.gradient_degree > 0 {
        let vertices = element.nodes.iter().take(element.shape.vertices());
        points.extend(vertices.map(|x| -> Point { std::array::from_fn(|d| 0.5 * (x[d] + centre[d])) }));
    }
    QuadratureRule { weights: vec![1.0; points.len()], points }
}

/// The value at a vertex, of a linear function through those at the [`points`].
fn at_vertex<const N: usize>(values: &[[f64; N]], vertex: usize) -> [f64; N] {
    match values {
        [centre, middles @ ..] if vertex < middles.len() => {
            std::array::from_fn(|c| 2.0 * middles[vertex][c] - centre[c])
        }
        [centre, ..] => *centre,
        [] => [0.0; N],
    }
}

/// Volumes of the cells of a block, by the Jacobian at their centres.
fn volumes(mesh: &Mesh, block: &Block) -> Vec<f64> {
    let table = ShapeTable::at(block.element, &[block.element.centre()]);
    let reference: f64 = rule(block.element.shape, 1).weights.iter().sum();
    let mut map = CellMap::new(mesh, &table);
    let volume = |cell| {
        map.at(cell, 0);
        reference * map.measure.abs()
    };
    block.cells().map(volume).collect()
}

/// The squares of the jumps of each cell. `values` holds those at the [`points`] of the cells, per block.
fn squares<const N: usize>(mesh: &Mesh, values: &[Vec<[f64; N]>]) -> Vec<f64> {
    let sizes: Vec<Vec<f64>> = mesh.blocks.iter().map(|block| volumes(mesh, block)).collect();
    let regions = mesh.blocks.iter().map(|block| block.region + 1).max().unwrap_or(0);
    let mut found: Vec<Vec<f64>> = mesh.blocks.iter().map(|_| Vec::new()).collect();
    for region in 0..regions {
        let blocks = || {
            let all = mesh.blocks.iter().zip(values).zip(&sizes).enumerate();
            all.filter(|(_, ((block, _), _))| block.region == region)
        };
        let cells = |block: &'_ Block| (points(block.element).points.len(), block.element.shape.vertices());
        let mut means = vec![([0.0; N], 0.0); mesh.points.len()];
        for (_, ((block, values), _)) in blocks() {
            let (count, vertices) = cells(block);
            for (cell, values) in block.cells().zip(values.chunks_exact(count)) {
                for (a, &node) in cell.iter().take(vertices).enumerate() {
                    let Some((sum, around)) = means.get_mut(node as usize) else { continue };
                    let here = at_vertex(values, a);
                    sum.iter_mut().zip(here).for_each(|(sum, here)| *sum += here);
                    *around += 1.0;
                }
            }
        }
        for (b, ((block, values), sizes)) in blocks() {
            let (count, vertices) = cells(block);
            let of_cell = |((cell, values), size): ((&[u32], &[[f64; N]]), &f64)| {
                let of_vertex = |(a, node): (usize, &u32)| -> f64 {
                    let Some((sum, around)) = means.get(*node as usize) else { return 0.0 };
                    let here = at_vertex(values, a);
                    here.iter().zip(sum).map(|(here, sum)| (here - sum / around).powi(2)).sum()
                };
                let sum: f64 = cell.iter().take(vertices).enumerate().map(of_vertex).sum();
                size * sum / vertices as f64
            };
            if let Some(found) = found.get_mut(b) {
                *found = block.cells().zip(values.chunks_exact(count)).zip(sizes).map(of_cell).collect();
            }
        }
    }
    found.into_iter().flatten().collect()
}

/// The squares of the jumps of the gradient of a nodal field, per cell.
#[must_use]
pub fn gradient_jumps(mesh: &Mesh, components: usize, field: &[f64]) -> Vec<f64> {
    let of_block = |block: &Block| {
        let table = ShapeTable::of_rule(block.element, points(block.element));
        let mut map = CellMap::new(mesh, &table);
        let mut values = Vec::with_capacity(block.len() * table.len());
        for cell in block.cells() {
            for q in 0..table.len() {
                map.at(cell, q);
                let mut gradient = [0.0; 9];
                for (&node, g) in cell.iter().zip(&map.gradients) {
                    let at_node = field.iter().skip(node as usize * components).take(components);
                    for (row, value) in gradient.chunks_exact_mut(3).zip(at_node) {
                        row.iter_mut().zip(g).for_each(|(sum, g)| *sum += value * g);
                    }
                }
                values.push(gradient);
            }
        }
        values
    };
    squares(mesh, &mesh.blocks.iter().map(of_block).collect::<Vec<_>>())
}

/// The squares of the jumps of stress and heat flux per cell, summed over the steps of a run.
#[derive(Clone, Debug, Default)]
pub struct JumpsOfRun {
    /// Of σ, Pa² m^d.
    pub stress: Vec<f64>,
    /// Of 𝓚∇θ, (W/m²)² m^d.
    pub flux: Vec<f64>,
}

impl JumpsOfRun {
    fn take(&mut self, now: &Snapshot) {
        let (problem, state) = (now.problem, now.state);
        let tables = Tables::new(problem, points);
        let mesh = &problem.mesh;
        let (mut stresses, mut fluxes) = (Vec::new(), Vec::new());
        all_at_once(&material_arrays(&problem.materials), || {
            for (b, block) in mesh.blocks.iter().enumerate() {
                let (mut evaluator, count) = (Evaluator::new(problem, state, &tables, b), tables.points[b].len());
                let (mut stress, mut flux) = (Vec::new(), Vec::new());
                for (cell, q) in (0..block.len()).flat_map(|cell| (0..count).map(move |q| (cell, q))) {
                    let at = evaluator.at(cell, q);
                    stress.push(at.stress.0);
                    flux.push(at.heat_flux);
                }
                stresses.push(stress);
                fluxes.push(flux);
            }
        });
        let add = |to: &mut Vec<f64>, more: Vec<f64>| {
            to.resize(more.len(), 0.0);
            to.iter_mut().zip(more).for_each(|(to, more)| *to += more);
        };
        add(&mut self.stress, squares(mesh, &stresses));
        add(&mut self.flux, squares(mesh, &fluxes));
    }
}

impl Sink for JumpsOfRun {
    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        if now.report.is_some() {
            self.take(now);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Diagonal, Elements, MeshError};

    /// Gradients 2 and 0 in two halves of a rod: at the middle their mean is 1, and each half has the square ½ · ½ · 1.
    #[test]
    fn a_kink_of_a_rod_is_shared_by_its_halves() -> Result<(), MeshError> {
        let mesh = Mesh::interval(1.0, 2, Elements::P1)?;
        assert_eq!(gradient_jumps(&mesh, 1, &[0.0, 1.0, 1.0]), [0.25, 0.25]);
        // A half beside a quarter has twice its square.
        let mut uneven = mesh.clone();
        uneven.points[2][0] = 0.75;
        assert_eq!(gradient_jumps(&uneven, 1, &[0.0, 1.0, 1.0]), [0.25, 0.125]);
        // Regions have gradients of their own.
        let mut halves = mesh.clone();
        let nodes = halves.blocks[0].nodes.split_off(2);
        halves.blocks.push(Block { element: halves.blocks[0].element, region: 1, nodes });
        assert_eq!(gradient_jumps(&halves, 1, &[0.0, 1.0, 1.0]), [0.0, 0.0]);
        Ok(())
    }

    /// A field that the element contains together with its gradient has no jumps, that of a higher degree has some.
    #[test]
    fn smooth_fields_have_no_jumps() -> Result<(), MeshError> {
        for (elements, degree) in [(Elements::P1, 1), (Elements::Q1, 1), (Elements::P2, 2), (Elements::Q2, 2)] {
            let mesh = Mesh::rectangle_of(elements, [1.0, 2.0], [3, 2], Diagonal::Left)?;
            let of = |power: i32| -> f64 {
                let field = |x: &Point| (x[0] + 0.5 * x[1]).powi(power);
                let values: Vec<f64> = mesh.points.iter().flat_map(|x| [field(x), -field(x)]).collect();
                gradient_jumps(&mesh, 2, &values).iter().sum()
            };
            assert!(of(degree) < 1e-20 && of(degree + 1) > 1e-4, "{elements:?}: {} {}", of(degree), of(degree + 1));
        }
        Ok(())
    }
}
