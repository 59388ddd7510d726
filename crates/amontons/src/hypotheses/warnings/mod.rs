//! Warnings: data and runs that are legal but hardly intended. Each has a place, a number and a repair, and is absent
//! if nothing is wrong.
//!
//! | id | warns if | by |
//! |---|---|---|
//! | `coincident-nodes` | nodes at one place are not the same node | [`coincident`] |
//! | `part-free` | a part of the body can move without strain and has no contact | supports |
//! | `point-force` | a force acts on points, or in space along an edge | the data |
//! | `contact-held` | the normal displacement of a contact point is prescribed, so that its law does not act | supports |
//! | `rigid-on-rigid` | a rigid part meets a rigid foundation, or another rigid part, by rigid contact | the data |
//! | `pair-gap` | bodies of a pair overlap at rest, or facets are deep compared with the gap between them | the gap of the mesh |
//! | `obstacle-size` | an obstacle from a file is far larger or smaller than the body | its extent |
//! | `start-inside` | a side is inside an obstacle at t = 0, or where its contact begins with a phase | distances at the contact points |
//! | `start-kept` | a scheme that holds velocities keeps a penetration of a rigid foundation at t = 0, or where its contact begins | its gap, the run |
//! | `phase-jump` | a dynamic phase begins with a displacement that is prescribed away from where the side is | the data, the run |
//! | `expansion-scale` | 𝓜 has the size of a coefficient of thermal expansion α | the material |
//! | `expansion-zz` | 𝓜 is a matrix in plane strain, so that 𝓜_zz = 0 | the material |
//! | `mean-dilatation` | the mean dilatation is requested for linear simplices, where it has no effect | the cells |
//! | `coefficient-jump` | a coefficient of the material jumps within a cell | its values along the edges of cells |
//! | `thermal-layer` | the heat from Γ_C does not penetrate a cell | lengths |
//! | `strain` | the strain is not small | the run |
//! | `temperature-range` | temperatures leave the range that the data allow | the run |
//! | `absolute-zero` | a temperature is below the absolute zero of a radiating contact | the run |
//! | `penetration` | a foundation gives way by more than the size of a cell | the run |
//! | `undetermined-motion` | no support, contact or load determines a rigid motion | the run |
//! | `no-contact` | no contact point presses in any step | the run |
//! | `few-points` | a contact that ends within a side is borne by fewer than four points | the run |
//! | `leak` | a fluid has passed through a contact to points that it should not reach | the run |
//! | `scheme-share` | the scheme takes more than 2 % of the energy of a motion | the run |
//! | `alternation` | velocities change sign from step to step | the run |
//! | `magnitude` | waves in a material are slower or faster than in any | the material |
//! | `no-effect` | results do not depend on a datum | the data |
//! | `static-friction` | friction drops when slip starts, and neither inertia nor viscosity slows the slip | the data |
//! | `nodal-stress` | stresses recovered at the nodes are far from those in the cells | the run |
//! | `many-systems` | steps take ten times the contact systems that were predicted | the run |

mod begins;
mod effect;
mod gaps;
mod jump;
mod kept;
mod rigid;
mod run;
mod sizes;
mod supports;
mod thermal;

pub use run::{Figures, Penetration, of_run};

use super::sample::at;
use super::tensors::norm;
use super::{Finding, FindingId, FindingStatus};
use crate::material::{Dilatation, OperatorConstants};
use crate::mesh::FacetSet;
use crate::mesh::defects::coincident;
use crate::problem::Problem;
use crate::tensor::Sym;
use crate::units::{Measure, UnitSystem};

/// A warning with the value found and the limit that it violates.
fn warning(
    id: FindingId,
    place: &str,
    [value, limit]: [f64; 2],
    message: String,
    repair: impl Into<String>,
) -> Finding {
    Finding::new(id, FindingStatus::Fails, message, place).numbers(Some(value), Some(limit)).repair(repair)
}

/// The warnings about data.
pub(super) fn of_data(problem: &Problem) -> Vec<Finding> {
    let mut findings: Vec<Finding> = Vec::new();
    findings.extend(not_merged(problem));
    findings.extend(supports::part_free(problem));
    findings.extend(supports::contact_held(problem));
    findings.extend(supports::point_force(problem));
    findings.extend(rigid::on_rigid(problem));
    findings.extend(gaps::of_pairs(problem));
    findings.extend(gaps::of_obstacles(problem));
    findings.extend(kept::at_start(problem));
    findings.extend(begins::of_data(problem));
    findings.extend(sizes::of_obstacles(problem));
    for (region, _) in problem.materials.iter().enumerate() {
        findings.extend(expansion_scale(problem, region));
        findings.extend(expansion_zz(problem, region));
        findings.extend(mean_dilatation(problem, region));
        findings.extend(magnitude(problem, region));
        findings.extend(jump::jump(problem, region));
    }
    findings.extend(thermal::layer(problem));
    findings.extend(effect::without_effect(problem));
    findings.extend(effect::jumps(problem));
    findings
}

/// `coincident-nodes`, except for nodes of the two sides of a pair, which may touch.
fn not_merged(problem: &Problem) -> Option<Finding> {
    let mesh = &*problem.mesh;
    let paired: Vec<Vec<u32>> = problem
        .contacts
        .iter()
        .filter(|contact| contact.pair.is_some())
        .map(|contact| {
            let sides = contact.sides().filter_map(|side| mesh.facets.get(side));
            let mut nodes: Vec<u32> = sides.flat_map(FacetSet::node_list).collect();
            nodes.sort_unstable();
            nodes
        })
        .collect();
    let of_pair =
        |pair: &[u32; 2]| paired.iter().any(|nodes| pair.iter().all(|node| nodes.binary_search(node).is_ok()));
    let mut pairs = coincident(mesh);
    pairs.retain(|pair| !of_pair(pair));
    let [a, b] = *pairs.first()?;
    let x = mesh.points.get(a as usize)?;
    let message = format!(
        "{} pairs of different nodes coincide, the first {a} and {b}, counted from 0, at {}: the body may come apart there, and no heat passes",
        pairs.len(),
        at(x)
    );
    let repair = "merge the nodes where the mesh is made (in Gmsh: Coherence Mesh, or BooleanFragments of the parts); leave them if a crack is intended";
    Some(warning(FindingId::CoincidentNodes, "mesh.file", [pairs.len() as f64, 0.0], message, repair))
}

/// Path in the case file of a number of the material of a region.
fn material_key(problem: &Problem, region: usize, key: &str) -> String {
    if problem.materials.len() == 1 {
        format!("material.{key}")
    } else {
        format!("material.{key}, region \"{}\"", problem.mesh.regions.get(region).map_or("", |name| name))
    }
}

/// Thermal strain per kelvin below which 𝓜 fits no material: Zerodur and ULE, which expand least, have 1e-8.
const LEAST_EXPANSION: f64 = 1e-9;
/// Range of coefficients of thermal expansion, per kelvin.
const COEFFICIENTS: std::ops::RangeInclusive<f64> = 1e-8..=1e-3;

/// `expansion-scale`: 𝓜 = α (3λ + 2μ) is a stress per kelvin; with a value of the size of α nothing expands.
fn expansion_scale(problem: &Problem, region: usize) -> Option<Finding> {
    let material = problem.materials.get(region)?;
    let values = problem.values_in(region, |m| &m.expansion);
    let eigenvalues = values.iter().flat_map(|sample| sample.value.eigenvalues(problem.mesh.tensor_dim()));
    let largest = eigenvalues.fold(0.0, |max: f64, e| max.max(e.abs()));
    let stiffness = material.elasticity.constants().lipschitz;
    let strain = largest / stiffness;
    if !(strain < LEAST_EXPANSION && COEFFICIENTS.contains(&largest)) {
        return None;
    }
    let message = format!(
        "𝓜 = {largest:.3e} expands the body by {strain:.1e} per kelvin, less than any material: it has the size of a coefficient of thermal expansion α, \
         but 𝓜 is the stress per kelvin of a body that is held"
    );
    let repair = format!(
        "give α E/(1 − 2ν), in plane stress α E/(1 − ν): about {:.2e} for α = {largest:.3e}",
        largest * stiffness
    );
    Some(warning(
        FindingId::ExpansionScale,
        &material_key(problem, region, "expansion"),
        [strain, LEAST_EXPANSION],
        message,
        repair,
    ))
}

/// `expansion-zz`: in plane strain a scalar also expands the body across its plane, a matrix of the plane does not.
fn expansion_zz(problem: &Problem, region: usize) -> Option<Finding> {
    let material = problem.materials.get(region)?;
    let x = problem.mesh.points.first()?;
    // A law for plane strain returns σ_zz.
    let held = problem.mesh.dim == 2
        && !problem.mesh.axisymmetric
        && material.elasticity.value(x, &(1e-6 * Sym::identity(2))).0[3] != 0.0;
    let expansion = material.expansion.at(x);
    if !held || expansion.0[3] != 0.0 || norm(&expansion, 2) == 0.0 {
        return None;
    }
    let [m_xx, m_yy] = [0, 1].map(|i| expansion.get(i, i));
    let multiple = m_xx.to_bits() == m_yy.to_bits() && expansion.get(0, 1) == 0.0;
    let repair = if multiple {
        format!("write the number, expansion = {m_xx:?}, which is that multiple of the identity in space")
    } else {
        "read stresses in the plane only: σ_zz and the von Mises stress lack −θ 𝓜_zz".to_owned()
    };
    let message = "a matrix of the plane has 𝓜_zz = 0: in plane strain σ_zz, and with it the von Mises stress, lacks the thermal stress −θ 𝓜_zz that a number gives";
    Some(warning(
        FindingId::ExpansionZz,
        &material_key(problem, region, "expansion"),
        [0.0, m_xx.abs().max(m_yy.abs())],
        message.to_owned(),
        repair,
    ))
}

/// `magnitude`: √(λ/ρ), λ the largest eigenvalue of 𝓔, is the wave speed. In materials as dense as stone it is
/// kilometres per second, and nowhere more than 20: otherwise a modulus in MPa or a density in t/mm³ was probably read
/// as SI.
fn magnitude(problem: &Problem, region: usize) -> Option<Finding> {
    const DENSE: f64 = 2000.0;
    const SPEEDS: [f64; 2] = [30.0, 3e4];
    let material = problem.materials.get(region).filter(|_| problem.system == UnitSystem::Si)?;
    let x = problem.mesh.points.first()?;
    let density = material.density.at(x);
    let stiffness =
        OperatorConstants::of_linear(&material.elasticity.tangent(x, &Sym::ZERO), problem.mesh.dim).lipschitz;
    let speed = (stiffness / density).sqrt();
    let [slowest, fastest] = SPEEDS;
    if !(density > 0.0 && stiffness > 0.0) || !((density > DENSE && speed < slowest) || speed > fastest) {
        return None;
    }
    let units = problem.units();
    let message = format!(
        "with a stiffness of {} and a density of {} kg/m³ waves travel at {}: no material has both",
        units.write(stiffness, Measure::Stress),
        units.write(density, Measure::Number),
        units.write(speed, Measure::Velocity)
    );
    let repair = "give both in SI units, Pa and kg/m³, or with their units: young = \"210 GPa\"";
    let limit = if speed < slowest { slowest } else { fastest };
    let key = material_key(problem, region, "elasticity");
    Some(warning(FindingId::Magnitude, &key, [speed, limit], message, repair))
}

/// `mean-dilatation`: the dilatation of a linear triangle or tetrahedron is constant and equals its mean.
fn mean_dilatation(problem: &Problem, region: usize) -> Option<Finding> {
    let mesh = &*problem.mesh;
    problem.materials.get(region).filter(|material| material.dilatation == Dilatation::Mean)?;
    let of_region = problem.region_of(region);
    let cells = mesh.blocks.iter().filter(|block| of_region.is_none_or(|region| block.region == region));
    let counts: Vec<(bool, usize)> =
        cells.map(|block| (block.element.nodes.len() == mesh.dim + 1 && mesh.dim > 1, block.cells().count())).collect();
    let simplices: usize = counts.iter().filter(|(is_simplex, _)| *is_simplex).map(|(_, count)| count).sum();
    if simplices == 0 {
        return None;
    }
    let all: usize = counts.iter().map(|(_, count)| count).sum();
    let message = format!(
        "dilatation = \"mean\" changes nothing in {simplices} of {all} cells, linear {}, whose dilatation is constant: near incompressibility they stay far too stiff",
        if mesh.dim == 2 { "triangles" } else { "tetrahedra" }
    );
    let repair = "take quadrilaterals, hexahedra or quadratic cells: elements = \"Q1\", \"Q2\" or \"P2\" in [mesh]";
    let numbers = [simplices as f64, 0.0];
    Some(warning(FindingId::MeanDilatation, &material_key(problem, region, "dilatation"), numbers, message, repair))
}
