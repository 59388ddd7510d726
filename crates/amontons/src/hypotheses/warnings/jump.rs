//! `coefficient-jump`: a coefficient of the material that jumps within a cell.

use super::super::sample::at;
use super::super::{Finding, FindingId};
use super::{material_key, warning};
use crate::field::Law;
use crate::material::TensorLaw;
use crate::mesh::{Block, Mesh};
use crate::problem::Problem;
use crate::tensor::{Point, Sym};

/// Change along an edge, relative to the values, below which no jump is searched.
const SMALL: f64 = 1e-2;
/// Halvings of an edge: over the last piece a smooth coefficient changes by about 2⁻¹⁶ of its change along the edge.
const HALVINGS: usize = 16;
/// Fraction of the change along an edge that counts as a jump if it occurs over the last piece.
const JUMP: f64 = 0.1;
/// Fraction of a cell by which its nodes are moved inward, so that jumps between cells do not count.
const INWARD: f64 = 1e-6;

/// The value of a coefficient at a point: the entries of a map on 𝕊^d, or fewer.
type CoefficientValue = [f64; 36];

/// Warns if a coefficient of the material jumps within a cell, which reduces the order of the method.
pub(super) fn jump(problem: &Problem, material: usize) -> Option<Finding> {
    let m = problem.materials.get(material)?;
    let region = problem.region_of(material);
    let tangent = |law: &Law<dyn TensorLaw>, x: &Point| flat(law.tangent(x, &Sym::ZERO).0.iter().flatten());
    let laws = [("elasticity", &m.elasticity), ("viscosity", &m.viscosity)];
    let laws = laws.into_iter().filter(|(_, law)| law.graded().is_some());
    let laws = laws.map(|(key, law)| (key, first(&problem.mesh, region, &|x| tangent(law, x))));
    let numbers = [("density", &m.density), ("heat_capacity", &m.heat_capacity)].into_iter();
    let numbers = numbers.filter(|(_, of)| of.varies());
    let numbers = numbers.map(|(key, of)| (key, first(&problem.mesh, region, &|x| flat([of.at(x)].iter()))));
    let tensors = [("conductivity", &m.conductivity), ("expansion", &m.expansion), ("coupling", &m.coupling)];
    let tensors = tensors.into_iter().filter(|(_, of)| of.varies());
    let tensors = tensors.map(|(key, of)| (key, first(&problem.mesh, region, &|x| flat(of.at(x).0.iter()))));
    let (key, (x, change)) = laws.chain(numbers).chain(tensors).find_map(|(key, found)| Some((key, found?)))?;
    let message = format!(
        "{key} jumps within a cell, at {}, by {:.0} % of itself: the order of the strain or the heat flux falls to one half",
        at(&x),
        100.0 * change
    );
    let repair =
        "put the jump on the sides of cells, as a region or by `data` of the mesh file, or use finer cells there";
    Some(warning(FindingId::CoefficientJump, &material_key(problem, material, key), [change, 0.0], message, repair))
}

fn flat<'a>(entries: impl Iterator<Item = &'a f64>) -> CoefficientValue {
    let mut value = [0.0; 36];
    value.iter_mut().zip(entries).for_each(|(value, entry)| *value = *entry);
    value
}

fn distance(a: &CoefficientValue, b: &CoefficientValue) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// The first jump of a coefficient along the edges from the first node of a cell, with its size relative to the values.
fn first(mesh: &Mesh, region: Option<usize>, value: &dyn Fn(&Point) -> CoefficientValue) -> Option<(Point, f64)> {
    let blocks = mesh.blocks.iter().filter(|block| region.is_none_or(|region| block.region == region));
    blocks.flat_map(|block: &Block| block.cells()).find_map(|cell| {
        let corners: Vec<Point> = cell.iter().filter_map(|&n| mesh.points.get(n as usize).copied()).collect();
        let count = corners.len() as f64;
        let centre: Point = std::array::from_fn(|d| corners.iter().map(|x| x[d]).sum::<f64>() / count);
        let inside = |x: &Point| -> Point { std::array::from_fn(|d| x[d] + INWARD * (centre[d] - x[d])) };
        let start = inside(corners.first()?);
        corners.iter().skip(1).find_map(|end| along([start, inside(end)], value))
    })
}

/// A jump between two points, found by repeatedly taking the half with the larger change.
fn along([mut from, mut to]: [Point; 2], value: &dyn Fn(&Point) -> CoefficientValue) -> Option<(Point, f64)> {
    let zero = [0.0; 36];
    let (mut low, mut high) = (value(&from), value(&to));
    let (whole, size) = (distance(&low, &high), distance(&low, &zero).max(distance(&high, &zero)));
    if whole.is_nan() || whole <= SMALL * size {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle: Point = std::array::from_fn(|d| 0.5 * (from[d] + to[d]));
        let here = value(&middle);
        if distance(&low, &here) > distance(&here, &high) {
            (to, high) = (middle, here);
        } else {
            (from, low) = (middle, here);
        }
    }
    let left = distance(&low, &high);
    (left > JUMP * whole).then_some((from, left / size))
}
