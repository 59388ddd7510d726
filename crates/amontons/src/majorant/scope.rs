//! What the bound of the error covers.

use super::contact::NormalKind;
use super::quadrilateral::is_distorted;
use super::stress::StepLaws;
use super::{Refused, Remarks};
use crate::contact::{Contact, ContactPoint, Quadrature};
use crate::discretization::Discretization;
use crate::field::Field;
use crate::machine::FreeMemory;
use crate::material::{Dilatation, Prony};
use crate::mesh::{Block, Mesh};
use crate::problem::{Coupling, Physics, Problem, RegionLoad};
use crate::quadrature::Shape;
use crate::state::{State, StepReport};
use crate::time::{Analysis, Instant, Rule};

/// Refuses what a bound would be wrong for.
pub(super) fn check(problem: &Problem, discrete: &Discretization) -> Result<(), Refused> {
    let refuse = |reason: &str| Err(Refused::new(reason));
    if !problem.physics.has_mechanics() {
        return refuse("a problem without mechanics");
    }
    if problem.mesh.axisymmetric {
        check_revolution(&problem.mesh)?;
    }
    if !discrete.is_linear() {
        return refuse("bodies whose laws are nonlinear or depend on temperature");
    }
    let branches = problem.materials.iter().filter_map(|m| m.prony.as_ref()).flat_map(Prony::branches);
    if branches.into_iter().any(|branch| branch.time_varies() || branch.modulus_varies()) {
        return refuse("Maxwell branches that vary in space");
    }
    if discrete.dilatation.contains(&Dilatation::Mean) {
        return refuse("the mean dilatation");
    }
    if discrete.springs.is_some() || discrete.dashpots.is_some() {
        return refuse("springs or dashpots at the boundary");
    }
    if !discrete.v.links.is_empty() || !problem.cyclic.is_empty() {
        return refuse("a sector of a cyclic structure");
    }
    if !discrete.v.rigid.is_empty() {
        return refuse("rigid parts");
    }
    problem.contacts.iter().filter(|contact| contact.acts()).try_for_each(check_contact)
}

/// Distance of a vertex from the axis, relative to the largest, that counts as round-off.
const ON_AXIS: f64 = 1e-9;

/// Refuses bodies of revolution in which a stress of finite energy would have to vanish on the axis, and cells whose
/// hoop strain is no polynomial over the radius.
fn check_revolution(mesh: &Mesh) -> Result<(), Refused> {
    let largest = mesh.points.iter().map(|x| x[0]).fold(0.0, f64::max);
    let mut cells = mesh.blocks.iter().flat_map(Block::cells).flatten();
    if cells.any(|&node| mesh.points[node as usize][0] <= ON_AXIS * largest) {
        return Err(Refused::new("a body of revolution that reaches its axis"));
    }
    if mesh.blocks.iter().any(|block| block.element.shape != Shape::Triangle) {
        return Err(Refused::new("quadrilaterals of a body of revolution"));
    }
    Ok(())
}

/// Bytes that a cell takes with its facets and patches, by dimension: measured with P1, no two cells alike, and rounded
/// up.
const PER_CELL: [f64; 3] = [4e3, 16e3, 40e3];

/// Bytes that a hexahedron takes beside these if no other is like it: the matrices of its shape and of three patches,
/// counted with Q2, and rounded up.
const PER_HEXAHEDRON: f64 = 1.3e6;

/// Refuses a mesh whose bound does not fit into memory.
pub(super) fn check_memory(mesh: &Mesh, free: Option<FreeMemory>) -> Result<(), Refused> {
    let cells = mesh.cell_count();
    fits(&format!("{cells} cells"), cells as f64 * PER_CELL[mesh.dim.clamp(1, 3) - 1], free)
}

/// Refuses more hexahedra that are not alike than fit into memory.
pub(super) fn check_hexahedra(count: usize, free: Option<FreeMemory>) -> Result<(), Refused> {
    fits(&format!("{count} hexahedra that are not alike"), count as f64 * PER_HEXAHEDRON, free)
}

/// Refuses what needs more bytes than are free.
fn fits(what: &str, need: f64, free: Option<FreeMemory>) -> Result<(), Refused> {
    const GIGABYTE: f64 = 1e9;
    match free {
        Some(FreeMemory { bytes, .. }) if need > bytes => Err(Refused(format!(
            "{what}, whose bound takes about {:.2} GB of memory, and {:.2} GB are free",
            need / GIGABYTE,
            bytes / GIGABYTE
        ))),
        _ => Ok(()),
    }
}

fn check_contact(contact: &Contact) -> Result<(), Refused> {
    let refuse = |reason: &str| Err(Refused::new(reason));
    if contact.pair.is_some() {
        return refuse("contact between two bodies");
    }
    if contact.wear.is_some() || contact.fluid.is_some() {
        return refuse("wear, or a fluid in the contact");
    }
    let Some(kind) = NormalKind::of(contact.normal.as_ref()) else {
        return refuse("a normal law that softens, depends on the rate, or is stiff beyond a stop");
    };
    if kind != NormalKind::Function && contact.quadrature == Quadrature::Gauss {
        return refuse("a rigid foundation at Gauss points");
    }
    if contact.quadrature == Quadrature::Gauss && !contact.friction.is_frictionless() {
        return refuse("friction at Gauss points");
    }
    Ok(())
}

/// The step that led to a state, if the bound covers it.
pub(super) fn rule_of(problem: &Problem, state: &State, report: &StepReport) -> Result<(Instant, Rule), Refused> {
    let refuse = |reason: &str| Err(Refused::new(reason));
    let made = state.made(&problem.timeline);
    let rule = made.analysis.rule(problem.scheme, made.k);
    if made.analysis == Analysis::Dynamic && problem.materials.iter().any(|m| m.density.constant() != Some(0.0)) {
        return refuse("inertia");
    }
    if !rule.is_steady() && !rule.is_backward_euler() {
        return refuse("a scheme other than backward Euler");
    }
    let has_friction = problem.contacts.iter().any(|c| c.acts() && !c.friction.is_frictionless());
    if rule.is_steady() && has_friction {
        return refuse("friction in a steady step");
    }
    if problem.timeline.is_automatic() {
        return refuse("steps that choose their lengths");
    }
    if !state.surface.offset.is_empty() {
        return refuse("a bilateral contact that began with a phase");
    }
    if report.parts > 1 {
        return refuse("a step made in halves");
    }
    if !report.forces.is_empty() || !state.released.is_empty() {
        return refuse("nodal forces from outside, or of supports that are giving up theirs");
    }
    if !report.loose.is_empty() {
        return refuse("rigid motions that are not determined");
    }
    Ok((made, rule))
}

/// The temperature whose stress acts in the step, or none.
pub(super) fn temperature<'s>(
    problem: &Problem,
    discrete: &Discretization,
    state: &'s State,
) -> Result<&'s [f64], Refused> {
    let acts = problem.physics.has_temperature()
        && problem.materials.iter().any(|m| m.expansion.constant().is_none_or(|tensor| tensor.norm() > 0.0));
    if !acts {
        return Ok(&[]);
    }
    if !discrete.expands_linearly() {
        return Err(Refused::new("expansion that depends on temperature"));
    }
    match problem.physics {
        Physics::Warmed => Ok(&state.theta),
        _ if problem.coupling.is_mutual() => Ok(&state.theta),
        _ if problem.coupling == Coupling::Extrapolated => Err(Refused::new("extrapolated temperatures")),
        _ => Err(Refused::new("half-steps one after the other, with the temperature of the step before")),
    }
}

/// Says why a number is an estimate, and what the bound does not count.
pub(super) fn remark(problem: &Problem, laws: &StepLaws, contacts: &[Contact], t: f64, remarks: &mut Remarks) {
    let regions = problem.mesh.blocks.iter().map(|block| block.region);
    if regions.into_iter().any(|region| laws.varies(region)) {
        remarks.estimate("the stiffness varies within cells: integrals are taken by quadrature");
    }
    if has_distorted_quadrilaterals(&problem.mesh) {
        remarks.estimate("quadrilaterals are no parallelograms: integrals are taken by quadrature");
    }
    let varies = |load: &RegionLoad| {
        load.gravity.iter().any(|(gravity, density)| {
            let acts = !gravity.iter().all(Field::is_zero);
            acts && (density.varies() || gravity.iter().any(Field::depends_on_space))
        })
    };
    if problem.region_loads.iter().any(varies) {
        remarks.estimate(
            "gravity or the density varies in space: the deviation from the mean of each cell is not counted",
        );
    }
    let loads = problem.body_force.iter();
    let loads = loads.chain(problem.region_loads.iter().flat_map(|load| &load.body_force));
    if loads.into_iter().any(Field::depends_on_space) {
        remarks.estimate("a body force varies in space: its deviation from the mean of each cell is not counted");
    }
    if problem.mesh.axisymmetric && is_loaded_along_axis(problem) {
        remarks.estimate("a body force along the axis of a body of revolution: its growth with r is not counted");
    }
    if problem.materials.iter().any(|m| m.expansion.varies()) {
        remarks.estimate("the expansion varies within cells: integrals are taken by quadrature");
    }
    if problem.physics.has_heat()
        && problem.materials.iter().any(|m| m.expansion.constant().is_none_or(|t| t.norm() > 0.0))
    {
        remarks.note("the temperature is the computed one");
    }
    let held =
        problem.boundary.iter().flat_map(|b| b.displacement.iter().flatten().flatten().chain(&b.normal_displacement));
    if held.into_iter().any(Field::depends_on_space) {
        remarks.note("prescribed displacements are those interpolated on the mesh");
    }
    for contact in contacts.iter().filter(|contact| contact.acts()) {
        if contact.gap.depends_on_space() || contact.obstacle.is_some() {
            remarks.note("the gap is that interpolated on the mesh");
        }
        if contact.friction.is_frictionless() {
            continue;
        }
        let never = contact.friction.never_slips();
        let is_bilateral = NormalKind::of(contact.normal.as_ref()) == Some(NormalKind::Bilateral);
        if (never && !is_bilateral) || !(never || is_given(contact, t)) {
            remarks.estimate("the friction bound depends on the solution: the bound of the discrete pressure is taken");
        }
    }
}

/// True if a body force may act along the axis.
fn is_loaded_along_axis(problem: &Problem) -> bool {
    let acts = |fields: &[Field]| fields.get(1).is_some_and(|field| !field.is_zero());
    let of_region =
        |load: &RegionLoad| acts(&load.body_force) || load.gravity.as_ref().is_some_and(|(gravity, _)| acts(gravity));
    acts(&problem.body_force) || problem.region_loads.iter().any(of_region)
}

/// True if the strain of a quadrilateral is no polynomial.
fn has_distorted_quadrilaterals(mesh: &Mesh) -> bool {
    let of = |nodes: &[u32]| is_distorted(&[0, 1, 2, 3].map(|i| mesh.points[nodes[i] as usize]));
    let blocks = mesh.blocks.iter().filter(|block| block.element.shape == Shape::Quadrilateral);
    blocks.flat_map(Block::cells).any(of)
}

/// True if the friction bound is one number.
fn is_given(contact: &Contact, _t: f64) -> bool {
    if contact.friction.graded().is_some() || contact.friction.drops_from_rest() {
        return false;
    }
    let at = |pressure: f64, slip_speed: f64| {
        contact.friction.bound(&ContactPoint { pressure, slip_speed, penetration: pressure, ..ContactPoint::default() })
    };
    let first = at(0.0, 0.0);
    let tries = [1e-9, 1.0, 1e9].into_iter().flat_map(|p| [0.0, 1e-9, 1.0, 1e9].map(|v| at(p, v)));
    let is_same = |a: f64, b: f64| a.to_bits() == b.to_bits();
    let no_cone = contact.friction.cone(&[0.0; 3], &[0.0, 0.0, 1.0]).is_none();
    no_cone && tries.into_iter().all(|bound| is_same(bound.value, first.value) && is_same(bound.by_pressure.abs(), 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Elements;

    #[test]
    fn a_mesh_whose_bound_does_not_fit_is_refused() {
        let Ok(mesh) = Mesh::box_([1.0; 3], [3, 3, 3], Elements::P1) else { panic!("a mesh") };
        let free = |bytes: f64| Some(FreeMemory { bytes, limit: None });
        assert_eq!(
            (mesh.cell_count(), check_memory(&mesh, free(2e7)), check_memory(&mesh, None)),
            (162, Ok(()), Ok(()))
        );
        assert_eq!((check_hexahedra(100, free(2e8)), check_hexahedra(100, None)), (Ok(()), Ok(())));
        let told = check_hexahedra(100, free(1e8)).err().map(|refused| refused.reason().to_owned());
        let expected =
            "100 hexahedra that are not alike, whose bound takes about 0.13 GB of memory, and 0.10 GB are free";
        assert_eq!(told.as_deref(), Some(expected));
        let told = check_memory(&mesh, free(6e6)).err().map(|refused| refused.reason().to_owned());
        assert_eq!(told.as_deref(), Some("162 cells, whose bound takes about 0.01 GB of memory, and 0.01 GB are free"));
    }
}
