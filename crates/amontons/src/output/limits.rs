//! Validity figures of a run: strain, temperatures outside the data, penetration relative to the cells.

use super::{Snapshot, cell_values, largest_strain, nodal_stress};
use crate::contact::{Contact, ContactPoint, Leak};
use crate::hypotheses::warnings::{Figures, Penetration};
use crate::material::{Material, OperatorConstants};
use crate::model::cell_heights;
use crate::problem::{Problem, ProblemData};
use crate::tensor::{Point, Sym};

/// The figures of a run up to a step.
pub(super) fn figures(last: &Snapshot) -> Figures {
    let Snapshot { problem, state, report, .. } = *last;
    let mesh = &problem.mesh;
    let (strain, strain_at) = largest_strain(mesh, state.deformation());
    let of_side = |(side, contact): (usize, &Contact)| {
        let cell = cell_heights(mesh, mesh.facets.get(contact.bearing())?)
            .into_iter()
            .map(|cell| cell.height)
            .reduce(f64::min)?;
        let states = last.discretization.boundary.points.iter().zip(&report?.contact.states);
        let depth =
            states.filter(|(point, _)| point.contact == side).fold(0.0, |max, (_, state)| state.penetration.max(max));
        Some(Penetration { side, depth, cell })
    };
    let sides = problem.contacts.iter().enumerate().filter_map(of_side);
    Figures {
        strain,
        strain_at,
        temperature: state.temperatures,
        // Data of phases that are over have warmed and cooled the body, too.
        outside: outside(&problem.clone().into_data(), state.temperatures, strain, state.t),
        loose: report.map(|report| report.loose.clone()).unwrap_or_default(),
        steps: state.step,
        contact_steps: state.counts.contact_steps,
        reversed_steps: state.counts.reversed_steps,
        few: few(last),
        leak: leak(last),
        scheme: [state.ledger.scheme_dissipation, state.ledger.kinetic, state.ledger.turned_over],
        impacts: state.ledger.impact_dissipation,
        von_mises: cell_values(problem, state).iter().map(|cell| cell.stress.von_mises()).fold(0.0, f64::max),
        recovered: recovered(last),
        stiff: strain * stiffness(problem),
        systems: [last.work.contact_factorizations, last.discretization.boundary.nodes.len() * mesh.dim],
        misfits: state.counts.misfits.clone(),
        penetration: sides.max_by(|a, b| (a.depth / a.cell).total_cmp(&(b.depth / b.cell))),
    }
}

/// Stress per strain of the stiffest material, Pa.
fn stiffness(problem: &Problem) -> f64 {
    let Some(x) = problem.mesh.points.first() else { return 0.0 };
    let of = |material: &Material| {
        OperatorConstants::of_linear(&material.elasticity.tangent(x, &Sym::ZERO), problem.mesh.tensor_dim()).lipschitz
    };
    problem.materials.iter().map(of).fold(0.0, f64::max)
}

/// The largest von Mises stress recovered at a node, and its position.
fn recovered(last: &Snapshot) -> Option<(f64, Point)> {
    let Snapshot { problem, state, .. } = *last;
    let stresses = problem.physics.has_mechanics().then(|| nodal_stress(problem, state))?;
    let all = stresses.regions.iter().flatten().map(|(node, stress)| (stress.von_mises(), *node));
    let (most, node) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((most, *problem.mesh.points.get(node as usize)?))
}

/// The first contact that leaked, and the narrowest place on the path of the fluid.
fn leak(last: &Snapshot) -> Option<(usize, Leak, Point)> {
    let leaks = last.state.surface.wet.leaks.iter().enumerate();
    let (side, leak) =
        leaks.filter_map(|(side, leak)| Some((side, (*leak)?))).min_by(|a, b| a.1.t.total_cmp(&b.1.t))?;
    Some((side, leak, last.discretization.boundary.points.get(leak.narrowest)?.x))
}

/// The partly open contact with the fewest points bearing a traction, and their number.
fn few(last: &Snapshot) -> Option<(usize, usize)> {
    let contact = &last.report?.contact;
    let boundary = contact.boundary.as_deref().unwrap_or(&last.discretization.boundary);
    let counts = |side: usize| {
        let states = boundary.points.iter().zip(&contact.states);
        let faced = states.filter(|(point, _)| point.contact == side && point.weight > 0.0);
        faced.fold([0, 0], |[pressed, open], (_, state)| {
            let presses = state.bears();
            [pressed + usize::from(presses), open + usize::from(!presses)]
        })
    };
    let sides = (0..last.problem.contacts.len()).filter(|&side| !last.problem.contacts[side].is_tie());
    let partly = sides.map(|side| (side, counts(side))).filter(|(_, [pressed, open])| *pressed > 0 && *open > 0);
    partly.map(|(side, [pressed, _])| (side, pressed)).min_by_key(|(_, pressed)| *pressed)
}

/// Excess of temperatures below and above the bounds of the maximum principle of (2.4): without sinks no temperature is
/// below all data, without sources none is above. The bound allows for the heat 𝓡:ε(u) with the strain of the last
/// step.
fn outside(problem: &ProblemData, [low, high]: [f64; 2], strain: f64, t: f64) -> [Option<f64>; 2] {
    let [least, largest] = problem.temperature_bounds();
    let [sinks, sources] = problem.heat_signs();
    let rubbing = ContactPoint { friction_power: 1.0, ..ContactPoint::default() };
    let rubs = problem
        .contacts
        .iter()
        .any(|c| c.heat.flux(&rubbing).value < 0.0 || c.foundation_heat.is_some() || c.pair.is_some());
    let dim = problem.mesh.tensor_dim();
    let norm = |tensor: &Sym| tensor.eigenvalues(dim).into_iter().map(f64::abs).sum::<f64>();
    let rates = (0..problem.materials.len()).map(|material| {
        let couplings = problem.values_in(material, |m| &m.coupling);
        let capacities = problem.values_in(material, |m| &m.heat_capacity);
        let coupling = couplings.iter().map(|sample| norm(&sample.value)).fold(0.0, f64::max);
        (coupling, capacities.iter().map(|sample| sample.value).fold(f64::INFINITY, f64::min))
    });
    let rates = rates.filter(|(coupling, _)| *coupling > 0.0);
    let coupled = rates.map(|(coupling, capacity)| coupling * strain * t / capacity).fold(0.0, f64::max);
    let beyond = |by: f64, unbounded: bool| (!unbounded && coupled.is_finite()).then(|| (by - coupled).max(0.0));
    [beyond(least - low, sinks), beyond(high - largest, sources || rubs)]
}
