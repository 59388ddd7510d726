//! Backward Euler with the half-steps one after the other: Problem 4.1 as it stands.

use super::{ContactReport, Counts, Discretization, Ledger, Scheme, SetupError, State, StepError, StepReport};
use crate::linalg::{
    Backend, BlockMatrix, Condensed, Factor, HeatStep, MechanicalStep, Multipliers, NotConverged, PointState, Unknowns, dot, max_abs, mechanical_products,
};
use crate::problem::Problem;
use crate::space::Space;
use crate::tensor::Point;

/// Largest relative residual of a step that is accepted.
pub const ACCEPTED: f64 = 1e-10;
/// Relative residual above which another pass of sweeps is made.
pub const REFINE: f64 = 1e-11;

/// Backward Euler for (4.1) and (4.2): mechanics with θ_{n−1}, then heat with u_{n−1} in e and u_n in χ.
#[derive(Debug)]
pub struct BackwardEuler {
    problem: Problem,
    discrete: Discretization,
    mechanics: System,
    heat: System,
    factorizations: usize,
    /// Products that one step computes and the next one needs, with the step they belong to.
    products: Option<Products>,
}

/// A factorized system with its condensed operator.
#[derive(Debug)]
struct System {
    unknowns: Unknowns,
    factor: Box<dyn Factor>,
    condensed: Condensed,
    /// Contact unknown of each degree of freedom of the contact nodes.
    on_contact: Vec<Option<u32>>,
}

#[derive(Debug)]
struct Products {
    step: usize,
    mass_w: Vec<f64>,
    a_u: Vec<f64>,
    a_w: Vec<f64>,
    b_w: Vec<f64>,
    mass_theta: Vec<f64>,
    d_theta: Vec<f64>,
}

impl System {
    fn new(matrix: &BlockMatrix, discrete: &Discretization, space: &Space, backend: &dyn Backend) -> Result<System, crate::linalg::FactorError> {
        let contact = &discrete.boundary.nodes;
        let unknowns = Unknowns::new(matrix, &discrete.mesh.points, space.components, &space.free, contact);
        let factor = backend.factorize(matrix, &unknowns)?;
        let condensed = Condensed::new(factor.condensed());
        let mut next = 0;
        let on_contact = contact
            .iter()
            .flat_map(|&node| (0..space.components).map(move |c| node as usize * space.components + c))
            .map(|dof| {
                space.free[dof].then(|| {
                    next += 1;
                    next - 1
                })
            })
            .collect();
        Ok(System { unknowns, factor, condensed, on_contact })
    }

    /// The forward sweep: the right-hand side in elimination order, reduced to Γ_C.
    fn reduce(&self, right: &[f64]) -> Vec<f64> {
        let mut x = self.unknowns.gather(right);
        self.factor.forward(&mut x);
        x
    }

    /// The problem on Γ_C, which `solve` finds from the reduced right-hand side, and the backward sweep:
    /// adds the increment that the right-hand side causes to the values.
    fn expand<T>(
        &mut self,
        mut x: Vec<f64>,
        values: &mut [f64],
        solve: impl FnOnce(&mut Condensed, &[Option<u32>], &[f64]) -> Result<(Vec<f64>, T), NotConverged>,
    ) -> Result<T, NotConverged> {
        let (_, contact) = x.split_at_mut(self.unknowns.interior);
        let (solved, result) = solve(&mut self.condensed, &self.on_contact, contact)?;
        for (x, (solved, &dof)) in contact.iter_mut().zip(solved.iter().zip(self.unknowns.contact())) {
            *x = solved - values[dof as usize];
        }
        self.factor.backward(&mut x);
        self.unknowns.add(&x, values);
        Ok(result)
    }

    /// The contact unknowns of a vector over all degrees of freedom.
    fn contact_of(&self, values: &[f64]) -> Vec<f64> {
        self.unknowns.contact().iter().map(|&d| values[d as usize]).collect()
    }
}

/// Values at the contact nodes, node-major.
fn at_nodes(discrete: &Discretization, components: usize, values: &[f64]) -> Vec<f64> {
    discrete.boundary.nodes.iter().flat_map(|&n| &values[n as usize * components..(n as usize + 1) * components]).copied().collect()
}

impl BackwardEuler {
    /// Assembles and factorizes: the only factorizations of a run.
    ///
    /// # Errors
    /// When a system is singular or does not fit into memory.
    pub fn new(problem: &Problem, backend: &dyn Backend) -> Result<BackwardEuler, SetupError> {
        let discrete = Discretization::new(problem);
        let (k, material) = (problem.k(), &problem.material);
        let (mechanics, heat) = rayon::join(
            || System::new(&discrete.mechanical_matrix(material.density, k), &discrete, &discrete.v, backend),
            || System::new(&discrete.thermal_matrix(material.heat_capacity, k), &discrete, &discrete.q, backend),
        );
        let mechanics = mechanics.map_err(|source| SetupError::Factor { part: "mechanical", source })?;
        let heat = heat.map_err(|source| SetupError::Factor { part: "heat", source })?;
        Ok(BackwardEuler { problem: problem.clone(), discrete, mechanics, heat, factorizations: 2, products: None })
    }

    /// Unknowns of displacement, temperature and on Γ_C.
    #[must_use]
    pub fn unknowns(&self) -> [usize; 3] {
        [self.mechanics.unknowns.len(), self.heat.unknowns.len(), self.mechanics.condensed.len()]
    }

    /// Numbers that both factors store.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.mechanics.factor.stored() + self.heat.factor.stored()
    }

    /// The products of a state with the matrices, kept from the step that made it where possible.
    fn products_of(&mut self, state: &State) -> Products {
        match self.products.take().filter(|p| p.step == state.step) {
            Some(products) => products,
            None => Products {
                step: state.step,
                mass_w: self.discrete.mass.apply(&state.w),
                a_u: self.discrete.a.apply(&state.u),
                a_w: self.discrete.a.apply(&state.w),
                b_w: self.discrete.b.apply(&state.w),
                mass_theta: self.discrete.mass.apply(&state.theta),
                d_theta: self.discrete.d.apply(&state.theta),
            },
        }
    }

    /// The mechanical half-step (4.1).
    fn mechanics(problem: &Problem, discrete: &Discretization, system: &mut System, old: &State, products: &Products, t: f64) -> Result<Mechanics, StepError> {
        let (k, rho) = (problem.k(), problem.material.density);
        let step = old.step + 1;
        let load = discrete.f.at(t);
        let thermal = discrete.m.apply(&old.theta);

        // Prescribed displacements are met by the velocity: w = (u_D(t_n) − u_{n−1})/k.
        let mut w = vec![0.0; load.len()];
        discrete.v.prescribe(t, &mut w);
        for (i, w) in w.iter_mut().enumerate() {
            *w = if discrete.v.free[i] { old.w[i] } else { (*w - old.u[i]) / k };
        }
        let [mut mass_w, mut a_w, mut b_w] = if w == old.w {
            [products.mass_w.clone(), products.a_w.clone(), products.b_w.clone()]
        } else {
            [&discrete.mass, &discrete.a, &discrete.b].map(|form| form.apply(&w))
        };
        let mut a_u: Vec<f64> = products.a_u.iter().zip(&a_w).map(|(a_u, a_w)| a_u + k * a_w).collect();

        let gap = problem.contact.as_ref().map_or(Vec::new(), |c| discrete.at_contact(&c.gap, t));
        let (u_old, w_prescribed) = (at_nodes(discrete, discrete.mesh.dim, &old.u), at_nodes(discrete, discrete.mesh.dim, &w));
        let mut multipliers = old.multipliers.clone();
        let (mut iterations, mut sweeps) = (0, 0);
        let mut previous = f64::INFINITY;
        loop {
            // The step is solved for the increment over the velocity at hand, at first w_{n−1}; what the
            // round-off of the sweeps leaves is met by another pass.
            let right: Vec<f64> = (0..load.len()).map(|i| load[i] + thermal[i] - rho / k * (mass_w[i] - products.mass_w[i]) - b_w[i] - a_u[i]).collect();
            finite(&right, step, t, "the data")?;
            let guess = system.contact_of(&w);
            let (states, newton) = system
                .expand(system.reduce(&right), &mut w, |condensed, unknown, r| {
                    let Some(contact) = &problem.contact else { return Ok((Vec::new(), (Vec::new(), 0))) };
                    let dim = discrete.mesh.dim;
                    let on_boundary =
                        MechanicalStep { contact, boundary: &discrete.boundary, unknown, dim, k, u_old: &u_old, w_prescribed: &w_prescribed, gap: &gap };
                    let solved = on_boundary.solve(condensed, r, &guess, &mut multipliers)?;
                    let states = on_boundary.states(&solved.x, &multipliers);
                    Ok((solved.x, (states, solved.iterations)))
                })
                .map_err(|why| StepError::NotConverged { step, t, part: "mechanics", why })?;
            iterations += newton;
            sweeps += 2;
            finite(&w, step, t, "mechanics")?;
            let u: Vec<f64> = (0..w.len()).map(|i| old.u[i] + k * w[i]).collect();
            [mass_w, a_u, a_w, b_w] = mechanical_products(&discrete.mass, &discrete.a, &discrete.b, &u, &w);
            let (force, contact_force) = contact_forces(discrete, &states);
            // What is left of (4.1) tested with every basis function; at prescribed nodes the reaction.
            let mut rest: Vec<f64> =
                (0..w.len()).map(|i| rho / k * (mass_w[i] - products.mass_w[i]) + b_w[i] + a_u[i] - thermal[i] - load[i] + contact_force[i]).collect();
            let support_work = (0..w.len()).filter(|&i| !discrete.v.free[i]).map(|i| k * rest[i] * w[i]).sum();
            discrete.v.mask(&mut rest);
            let inertia = rho / k * max_abs(&mass_w).max(max_abs(&products.mass_w));
            let terms = [&b_w, &a_u, &thermal, &load, &contact_force].map(|term| max_abs(term));
            let residual = relative(max_abs(&rest), terms.into_iter().fold(inertia, f64::max), step, t, "mechanics")?;
            if residual > REFINE && residual < 0.5 * previous {
                previous = residual;
                continue;
            }
            let residual = accept(residual, step, t, "mechanics")?;
            return Ok(Mechanics { u, w, multipliers, states, iterations, sweeps, residual, load, thermal, mass_w, a_u, a_w, b_w, gap, force, support_work });
        }
    }

    /// What of the heat half-step (4.2) does not need u_n: up to the forward sweep.
    fn begin_heat(problem: &Problem, discrete: &Discretization, system: &System, old: &State, products: &Products, t: f64) -> Result<HeatBegun, StepError> {
        let supply = discrete.q_h.at(t);
        let coupling = discrete.e.apply(&old.u);
        let mut theta = old.theta.clone();
        discrete.q.prescribe(t, &mut theta);
        let [mass_theta, d_theta] = if theta == old.theta {
            [products.mass_theta.clone(), products.d_theta.clone()]
        } else {
            [&discrete.mass, &discrete.d].map(|form| form.apply(&theta))
        };
        let mut begun = HeatBegun { supply, coupling, theta, mass_theta, d_theta, reduced: Vec::new() };
        begun.reduced = system.reduce(&begun.right(problem, products, old.step + 1, t)?);
        Ok(begun)
    }

    /// The heat half-step (4.2) at the contact that the mechanical one has found.
    fn heat(&mut self, mut begun: HeatBegun, old: &State, products: &Products, t: f64, states: &[PointState]) -> Result<Heat, StepError> {
        let (k, c) = (self.problem.k(), self.problem.material.heat_capacity);
        let Self { problem, discrete, heat: system, .. } = self;
        let step = old.step + 1;
        let foundation = problem.contact.as_ref().map_or(Vec::new(), |c| discrete.at_contact(&c.foundation_temperature, t));
        let prescribed = at_nodes(discrete, 1, &begun.theta);
        let (mut iterations, mut sweeps) = (0, 0);
        let mut previous = f64::INFINITY;
        loop {
            let reduced = std::mem::take(&mut begun.reduced);
            let HeatBegun { supply, coupling, theta, mass_theta, d_theta, .. } = &mut begun;
            let guess = system.contact_of(theta);
            let (at_points, newton) = system
                .expand(reduced, theta, |condensed, unknown, r| {
                    let Some(contact) = &problem.contact else { return Ok((Vec::new(), (Vec::new(), 0))) };
                    let on_boundary =
                        HeatStep { contact, boundary: &discrete.boundary, unknown, theta_prescribed: &prescribed, foundation: &foundation, states };
                    let solved = on_boundary.solve(condensed, r, &guess)?;
                    let fluxes = on_boundary.fluxes(&solved.x);
                    Ok((solved.x, (fluxes, solved.iterations)))
                })
                .map_err(|why| StepError::NotConverged { step, t, part: "heat", why })?;
            iterations += newton;
            sweeps += 2;
            finite(theta, step, t, "heat")?;
            [*mass_theta, *d_theta] = [&discrete.mass, &discrete.d].map(|form| form.apply(theta));
            let (temperature, flux): (Vec<f64>, Vec<_>) = at_points.into_iter().unzip();
            let mut chi = vec![0.0; theta.len()];
            let mut heat_flow = 0.0;
            for (point, flux) in discrete.boundary.points.iter().zip(&flux) {
                heat_flow += point.weight * flux.value;
                for &(node, value) in &point.nodes {
                    chi[discrete.boundary.nodes[node] as usize] += point.weight * value * flux.value;
                }
            }
            // What is left of (4.2); at prescribed nodes the heat that has to be supplied there.
            let mut rest: Vec<f64> =
                (0..theta.len()).map(|i| c / k * (mass_theta[i] - products.mass_theta[i]) + d_theta[i] - coupling[i] - supply[i] + chi[i]).collect();
            let through_prescribed = -(0..rest.len()).filter(|&i| !discrete.q.free[i]).map(|i| rest[i]).sum::<f64>();
            discrete.q.mask(&mut rest);
            let storage = c / k * max_abs(mass_theta).max(max_abs(&products.mass_theta));
            let terms = [&*d_theta, coupling, supply, &chi].map(|term| max_abs(term));
            let residual = relative(max_abs(&rest), terms.into_iter().fold(storage, f64::max), step, t, "heat")?;
            if residual > REFINE && residual < 0.5 * previous {
                previous = residual;
                begun.reduced = system.reduce(&begun.right(problem, products, step, t)?);
                continue;
            }
            let residual = accept(residual, step, t, "heat")?;
            let sum = |v: &[f64]| v.iter().sum::<f64>();
            let amounts = HeatAmounts { supplied: k * sum(supply), coupling: k * sum(coupling), contact: k * heat_flow, prescribed: k * through_prescribed };
            let HeatBegun { theta, mass_theta, d_theta, .. } = begun;
            return Ok(Heat { theta, mass_theta, d_theta, temperature, flux, through_contact: heat_flow, iterations, sweeps, residual, amounts });
        }
    }

    /// The ledger after a step.
    fn audit(&self, old: &State, products: &Products, mechanics: &Mechanics, heat: &Heat) -> Ledger {
        let (k, rho, c) = (self.problem.k(), self.problem.material.density, self.problem.material.heat_capacity);
        let m = mechanics;
        let before = &old.ledger;
        let kinetic = 0.5 * rho * dot(&m.w, &m.mass_w);
        let elastic = 0.5 * dot(&m.u, &m.a_u);
        let viscous = k * dot(&m.w, &m.b_w);
        let inertial = 0.5 * rho * dot(&difference(&m.w, &old.w), &difference(&m.mass_w, &products.mass_w));
        let elastic_scheme = 0.5 * dot(&difference(&m.u, &old.u), &difference(&m.a_u, &products.a_u));
        let thermal_work = k * dot(&m.w, &m.thermal);
        let mut load_work = k * dot(&m.w, &m.load) + m.support_work;
        let (mut friction, mut contact_energy, mut pressing) = (0.0, 0.0, 0.0);
        if let Some(contact) = &self.problem.contact {
            let old_gap = self.discrete.at_contact(&contact.gap, old.t);
            for (i, (point, state)) in self.discrete.boundary.points.iter().zip(&m.states).enumerate() {
                friction += k * point.weight * crate::tensor::dot(&state.q, &state.slip);
                contact_energy += point.weight * contact.normal.potential(&point.x, state.penetration);
                let w_nu = crate::tensor::dot(&self.velocity_at(point, &m.w), &point.normal);
                pressing += k * point.weight * state.pressure * w_nu;
                // A foundation that moves does work on the body.
                load_work -= point.weight * state.pressure * (m.gap[i] - old_gap[i]);
            }
        }
        let gap_work = load_work - (k * dot(&m.w, &m.load) + m.support_work);
        let compliance_scheme = pressing + gap_work - (contact_energy - before.contact_energy);
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

    fn velocity_at(&self, point: &crate::contact::PointOnBoundary, w: &[f64]) -> Point {
        let mut v = [0.0; 3];
        for &(node, value) in &point.nodes {
            for c in 0..self.discrete.mesh.dim {
                v[c] += value * w[self.discrete.boundary.nodes[node] as usize * self.discrete.mesh.dim + c];
            }
        }
        v
    }
}

impl Scheme for BackwardEuler {
    fn discretization(&self) -> &Discretization {
        &self.discrete
    }

    fn initial(&self) -> Result<State, SetupError> {
        let (mesh, data) = (&self.discrete.mesh, &self.problem.initial);
        let u = self.discrete.v.interpolate(mesh, &data.displacement, 0.0);
        let w = self.discrete.v.interpolate(mesh, &data.velocity, 0.0);
        let theta = self.discrete.q.interpolate(mesh, std::slice::from_ref(&data.temperature), 0.0);
        for (values, name) in [(&u, "displacement"), (&w, "velocity"), (&theta, "temperature")] {
            if values.iter().any(|v| !v.is_finite()) {
                return Err(SetupError::Initial(name));
            }
        }
        let material = &self.problem.material;
        let kinetic = 0.5 * material.density * dot(&w, &self.discrete.mass.apply(&w));
        let elastic = 0.5 * dot(&u, &self.discrete.a.apply(&u));
        let mut contact_energy = 0.0;
        if let Some(contact) = &self.problem.contact {
            let gap = self.discrete.at_contact(&contact.gap, 0.0);
            for (point, gap) in self.discrete.boundary.points.iter().zip(gap) {
                let r = crate::tensor::dot(&self.velocity_at(point, &u), &point.normal) - gap;
                contact_energy += point.weight * contact.normal.potential(&point.x, r);
            }
        }
        let heat_content = material.heat_capacity * self.discrete.mass.apply(&theta).iter().sum::<f64>();
        let ledger = Ledger {
            kinetic,
            elastic,
            contact_energy,
            turned_over: kinetic + elastic + contact_energy,
            heat_content,
            heat_turned_over: heat_content.abs(),
            ..Ledger::default()
        };
        let multipliers = Multipliers { q: vec![[0.0; 3]; self.discrete.boundary.points.len()] };
        Ok(State { step: 0, t: 0.0, u, w, theta, multipliers, ledger, counts: Counts::default() })
    }

    fn step(&mut self, old: &State) -> Result<(State, StepReport), StepError> {
        let step = old.step + 1;
        let t = self.problem.time(step);
        let products = self.products_of(old);
        // Heat needs u_n on Γ_C only: its forward sweep is made beside the mechanical half-step.
        let Self { problem, discrete, mechanics, heat, .. } = self;
        let (mechanics, begun) =
            rayon::join(|| Self::mechanics(problem, discrete, mechanics, old, &products, t), || Self::begin_heat(problem, discrete, heat, old, &products, t));
        let mechanics = mechanics?;
        let heat = self.heat(begun?, old, &products, t, &mechanics.states)?;
        let ledger = self.audit(old, &products, &mechanics, &heat);
        if !(ledger.closing_error.is_finite() && ledger.heat_closing_error.is_finite()) {
            return Err(StepError::NotFinite { step, t, part: "the energy" });
        }
        let counts = Counts {
            newton_mechanics_total: old.counts.newton_mechanics_total + mechanics.iterations,
            newton_mechanics_max: old.counts.newton_mechanics_max.max(mechanics.iterations),
            newton_heat_total: old.counts.newton_heat_total + heat.iterations,
            sweeps: old.counts.sweeps + mechanics.sweeps + heat.sweeps,
            residual_max: old.counts.residual_max.max(mechanics.residual).max(heat.residual),
        };
        let report = StepReport {
            newton_mechanics: mechanics.iterations,
            newton_heat: heat.iterations,
            residual: mechanics.residual.max(heat.residual),
            contact: ContactReport {
                states: mechanics.states,
                temperature: heat.temperature,
                flux: heat.flux,
                force: mechanics.force,
                heat_flow: heat.through_contact,
            },
        };
        self.products = Some(Products {
            step,
            mass_w: mechanics.mass_w,
            a_u: mechanics.a_u,
            a_w: mechanics.a_w,
            b_w: mechanics.b_w,
            mass_theta: heat.mass_theta,
            d_theta: heat.d_theta,
        });
        let state = State { step, t, u: mechanics.u, w: mechanics.w, theta: heat.theta, multipliers: mechanics.multipliers, ledger, counts };
        Ok((state, report))
    }

    fn factorizations(&self) -> (usize, usize) {
        (self.factorizations, self.mechanics.condensed.factorizations() + self.heat.condensed.factorizations())
    }
}

/// What the mechanical half-step found.
struct Mechanics {
    u: Vec<f64>,
    w: Vec<f64>,
    multipliers: Multipliers,
    states: Vec<PointState>,
    iterations: usize,
    sweeps: usize,
    residual: f64,
    load: Vec<f64>,
    thermal: Vec<f64>,
    mass_w: Vec<f64>,
    a_u: Vec<f64>,
    a_w: Vec<f64>,
    b_w: Vec<f64>,
    gap: Vec<f64>,
    force: Point,
    support_work: f64,
}

/// A heat half-step before the contact is known.
struct HeatBegun {
    supply: Vec<f64>,
    coupling: Vec<f64>,
    /// θ_{n−1} with the prescribed values of t_n, and its products with the forms.
    theta: Vec<f64>,
    mass_theta: Vec<f64>,
    d_theta: Vec<f64>,
    /// The right-hand side for the increment over `theta`, reduced to Γ_C.
    reduced: Vec<f64>,
}

impl HeatBegun {
    /// The right-hand side for the increment over θ at hand.
    fn right(&self, problem: &Problem, products: &Products, step: usize, t: f64) -> Result<Vec<f64>, StepError> {
        let storage = problem.material.heat_capacity / problem.k();
        let right: Vec<f64> = (0..self.supply.len())
            .map(|i| self.supply[i] + self.coupling[i] - storage * (self.mass_theta[i] - products.mass_theta[i]) - self.d_theta[i])
            .collect();
        finite(&right, step, t, "the data")?;
        Ok(right)
    }
}

/// What the heat half-step found.
struct Heat {
    theta: Vec<f64>,
    mass_theta: Vec<f64>,
    d_theta: Vec<f64>,
    temperature: Vec<f64>,
    flux: Vec<crate::contact::Flux>,
    through_contact: f64,
    iterations: usize,
    sweeps: usize,
    residual: f64,
    amounts: HeatAmounts,
}

/// Heat moved in one step, J.
struct HeatAmounts {
    supplied: f64,
    coupling: f64,
    contact: f64,
    prescribed: f64,
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn finite(values: &[f64], step: usize, t: f64, part: &'static str) -> Result<(), StepError> {
    if values.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(StepError::NotFinite { step, t, part }) }
}

/// A residual relative to the largest term of its equation.
fn relative(residual: f64, scale: f64, step: usize, t: f64, part: &'static str) -> Result<f64, StepError> {
    let relative = if residual == 0.0 { 0.0 } else { residual / scale };
    if relative.is_nan() { Err(StepError::NotFinite { step, t, part }) } else { Ok(relative) }
}

/// The relative residual, if it is small enough to be a result.
fn accept(residual: f64, step: usize, t: f64, part: &'static str) -> Result<f64, StepError> {
    if residual > ACCEPTED { Err(StepError::Residual { step, t, part, residual, accepted: ACCEPTED }) } else { Ok(residual) }
}

/// The resultant of σν on Γ_C, and Σ ω Nᵀ (p ν + q) over all degrees of freedom.
fn contact_forces(discrete: &Discretization, states: &[PointState]) -> (Point, Vec<f64>) {
    let dim = discrete.mesh.dim;
    let (mut resultant, mut forces) = ([0.0; 3], vec![0.0; discrete.v.free.len()]);
    for (point, state) in discrete.boundary.points.iter().zip(states) {
        for c in 0..dim {
            let traction = state.pressure * point.normal[c] + state.q[c];
            resultant[c] -= point.weight * traction;
            for &(node, value) in &point.nodes {
                forces[discrete.boundary.nodes[node] as usize * dim + c] += point.weight * value * traction;
            }
        }
    }
    (resultant, forces)
}
