//! The ledger after a step: every term of the energy and heat identities.

use super::Ledger;
use super::heat::Heat;
use super::mechanics::Mechanics;
use super::system::{Step, difference, vector_at};
use crate::contact::GraphKind;
use crate::linalg::dot;
use crate::tensor;

/// The ledger after a step.
pub(super) fn audit(step: &Step, m: &Mechanics, heat: &Heat) -> Ledger {
    let Step { problem, discrete, old, products, .. } = *step;
    let (k, (rho, _), (c, _)) = (problem.k(), discrete.inertia(), discrete.storage());
    let before = &old.ledger;
    let kinetic = 0.5 * rho * dot(&m.w, &m.mass_w);
    let Stored { elastic, relaxed, scheme: elastic_scheme } = stored(step, m);
    let viscous = k * dot(&m.w, &m.b_w) + relaxed;
    let inertial = 0.5 * rho * dot(&difference(&m.w, &old.w), &difference(&m.mass_w, &products.mass_w));
    let thermal_work = k * dot(&m.w, &m.thermal);
    let mut load_work = k * dot(&m.w, &m.load) + m.support_work;
    let (mut friction, mut contact_energy, mut pressing, mut damping) = (0.0, 0.0, 0.0, 0.0);
    if let Some(contact) = &problem.contact {
        for (i, (point, state)) in discrete.boundary.points.iter().zip(&m.states).enumerate() {
            friction += k * point.weight * tensor::dot(&state.q, &state.slip);
            contact_energy += point.weight * contact.normal.potential(&point.x, state.penetration);
            let w_nu = tensor::dot(&vector_at(discrete, point, &m.w), &point.normal);
            let (gap_rate, weight) = (m.given.gap_rate[i], k * point.weight);
            pressing += weight * state.pressure * (w_nu - gap_rate);
            if contact.normal.graph() == GraphKind::Function {
                // What the pressure has beyond that at rest dissipates.
                damping += weight * (state.pressure - contact.normal.pressure(&point.x, state.penetration, 0.0, 0.0).value) * (w_nu - gap_rate);
            }
            // A foundation that moves does work on the body.
            load_work -= weight * state.pressure * gap_rate;
            if let Some(v_f) = m.given.foundation_velocity.get(i) {
                load_work -= weight * tensor::dot(&state.q, v_f);
            }
        }
    }
    let viscous = viscous + damping;
    let compliance_scheme = pressing - damping - (contact_energy - before.contact_energy);
    let scheme = inertial + elastic_scheme + compliance_scheme;
    let error = (kinetic - before.kinetic) + (elastic - before.elastic) + (contact_energy - before.contact_energy) + viscous + friction + scheme
        - load_work
        - thermal_work;

    let heat_content = c * heat.mass_theta.iter().sum::<f64>();
    let amounts = &heat.amounts;
    let heat_error = (heat_content - before.heat_content) + amounts.contact + amounts.prescribed - amounts.supplied - amounts.coupling;
    Ledger {
        kinetic,
        elastic,
        viscous_dissipation: before.viscous_dissipation + viscous,
        friction_dissipation: before.friction_dissipation + friction,
        contact_energy,
        load_work: before.load_work + load_work,
        thermal_work: before.thermal_work + thermal_work,
        scheme_dissipation: before.scheme_dissipation + scheme,
        closing_error: before.closing_error + error,
        turned_over: before.turned_over + load_work.abs() + thermal_work.abs(),
        heat_content,
        heat_contact: before.heat_contact + amounts.contact,
        heat_prescribed: before.heat_prescribed + amounts.prescribed,
        heat_supplied: before.heat_supplied + amounts.supplied,
        heat_coupling: before.heat_coupling + amounts.coupling,
        heat_closing_error: before.heat_closing_error + heat_error,
        heat_turned_over: before.heat_turned_over + amounts.contact.abs() + amounts.prescribed.abs() + amounts.supplied.abs() + amounts.coupling.abs(),
    }
}

/// The energy that the body stores after a step, and what it dissipates in one besides viscosity.
struct Stored {
    /// In elasticity, springs and branches, J.
    elastic: f64,
    /// Dissipated by the dashpots of the branches, J.
    relaxed: f64,
    /// Dissipated by the scheme, J.
    scheme: f64,
}

fn stored(step: &Step, m: &Mechanics) -> Stored {
    let Step { problem, discrete, old, products, .. } = *step;
    let k = problem.k();
    let change = difference(&m.u, &old.u);
    let mut branches = 0.0;
    let mut sum = if discrete.is_linear() {
        Stored { elastic: 0.5 * dot(&m.u, &m.a_u), relaxed: 0.0, scheme: 0.5 * dot(&change, &difference(&m.a_u, &products.a_u)) }
    } else {
        // What the stress works beyond the change of the potential is the scheme's; without a potential the work is taken for stored.
        let work = dot(&change, &m.a_u);
        let before = old.ledger.elastic - old.branches.iter().zip(&discrete.branches).map(|(z, b)| 0.5 * dot(z, &b.form.apply(z))).sum::<f64>();
        let elastic = discrete.stored_energy(&m.u).unwrap_or(before + work);
        Stored { elastic, relaxed: 0.0, scheme: work - (elastic - before) }
    };
    // q_n:(ε_n − ε_{n−1}) = [½ z:𝓖z] + (k/τ) z_n:𝓖z_n + ½ Δz:𝓖Δz in every branch.
    for ((branch, new), old) in discrete.branches.iter().zip(&m.branches).zip(&old.branches) {
        let (force, change) = (branch.form.apply(new), difference(new, old));
        branches += 0.5 * dot(new, &force);
        sum.relaxed += k / branch.time * dot(new, &force);
        sum.scheme += 0.5 * dot(&change, &branch.form.apply(&change));
    }
    sum.elastic += branches;
    sum
}
