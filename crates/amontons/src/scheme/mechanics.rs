//! The mechanical half-step (4.1).

use super::Discretization;
use super::StepError;
use super::system::{REFINE, Step, System, at_nodes};
use crate::linalg::{Entry, MechanicalStep, Multipliers, PointState, PointTangent, max_abs};
use crate::tensor::Point;

/// What the mechanical half-step found.
pub(super) struct Mechanics {
    pub u: Vec<f64>,
    pub w: Vec<f64>,
    pub multipliers: Multipliers,
    pub states: Vec<PointState>,
    /// Newton iterations on Γ_C, and sweeps.
    pub iterations: usize,
    pub sweeps: usize,
    /// Residual relative to `scale`, the largest term of the equation.
    pub residual: f64,
    pub scale: f64,
    pub load: Vec<f64>,
    /// m(θ, ·) of the temperature that the half-step was made with.
    pub thermal: Vec<f64>,
    pub mass_w: Vec<f64>,
    pub a_u: Vec<f64>,
    pub a_w: Vec<f64>,
    pub b_w: Vec<f64>,
    /// What the contact points were given.
    pub given: Given,
    /// Resultant of σν on Γ_C.
    pub force: Point,
    /// Work of the supports in the step, J.
    pub support_work: f64,
}

/// What is known on Γ_C before the half-step is solved.
#[derive(Clone)]
pub(super) struct Given {
    u_old: Vec<f64>,
    w_prescribed: Vec<f64>,
    /// g(t_n) at the contact points, m.
    pub gap: Vec<f64>,
}

impl Given {
    /// The problem on Γ_C; none without contact.
    fn on_boundary<'a>(&'a self, step: &Step<'a>, unknown: &'a [Option<u32>]) -> Option<MechanicalStep<'a>> {
        Some(MechanicalStep {
            contact: step.problem.contact.as_ref()?,
            boundary: &step.discrete.boundary,
            unknown,
            dim: step.discrete.mesh.dim,
            k: step.problem.k(),
            u_old: &self.u_old,
            w_prescribed: &self.w_prescribed,
            gap: &self.gap,
        })
    }
}

impl Mechanics {
    /// Solves (4.1) with the temperature `theta` in m, from the velocity w_{n−1} or from a solution of the same
    /// step with another temperature.
    pub fn solve(step: &Step, system: &mut System, theta: &[f64], from: Option<&Mechanics>) -> Result<Mechanics, StepError> {
        let Step { problem, discrete, old, products, .. } = *step;
        let (k, rho) = (problem.k(), problem.material.density);
        let thermal = discrete.m.apply(theta);
        let Begun { mut w, mut multipliers, load, given, mut mass_w, mut a_u, mut b_w } = from.map_or_else(|| Begun::new(step), Begun::from);
        let (mut iterations, mut sweeps) = (0, 0);
        let mut previous = f64::INFINITY;
        loop {
            // The step is solved for the increment over the velocity at hand; what the round-off of the
            // sweeps leaves is met by another pass.
            let right: Vec<f64> = (0..load.len()).map(|i| load[i] + thermal[i] - rho / k * (mass_w[i] - products.mass_w[i]) - b_w[i] - a_u[i]).collect();
            step.finite(&right, "the data")?;
            let guess = system.contact_of(&w);
            let (states, newton) = system
                .expand(system.reduce(&right), &mut w, |condensed, unknown, r| {
                    let Some(on_boundary) = given.on_boundary(step, unknown) else { return Ok((Vec::new(), (Vec::new(), 0))) };
                    let solved = on_boundary.solve(condensed, r, &guess, &mut multipliers)?;
                    let states = on_boundary.states(&solved.x, &multipliers);
                    Ok((solved.x, (states, solved.iterations)))
                })
                .map_err(|why| step.not_converged("mechanics", why))?;
            iterations += newton;
            sweeps += 2;
            step.finite(&w, "mechanics")?;
            let u: Vec<f64> = (0..w.len()).map(|i| old.u[i] + k * w[i]).collect();
            let a_w;
            [mass_w, a_u, a_w, b_w] = discrete.mechanical_products(&u, &w);
            let (force, contact_force) = contact_forces(discrete, &states);
            // What is left of (4.1) tested with every basis function; at prescribed nodes the reaction.
            let mut rest: Vec<f64> =
                (0..w.len()).map(|i| rho / k * (mass_w[i] - products.mass_w[i]) + b_w[i] + a_u[i] - thermal[i] - load[i] + contact_force[i]).collect();
            let support_work = (0..w.len()).filter(|&i| !discrete.v.free[i]).map(|i| k * rest[i] * w[i]).sum();
            discrete.v.mask(&mut rest);
            let inertia = rho / k * max_abs(&mass_w).max(max_abs(&products.mass_w));
            let terms = [&b_w, &a_u, &thermal, &load, &contact_force].map(|term| max_abs(term));
            let scale = terms.into_iter().fold(inertia, f64::max);
            let residual = step.relative(max_abs(&rest), scale, "mechanics")?;
            if residual > REFINE && residual < 0.5 * previous {
                previous = residual;
                continue;
            }
            let residual = step.accept(residual, "mechanics")?;
            return Ok(Mechanics {
                u,
                w,
                multipliers,
                states,
                iterations,
                sweeps,
                residual,
                scale,
                load,
                thermal,
                mass_w,
                a_u,
                a_w,
                b_w,
                given,
                force,
                support_work,
            });
        }
    }

    /// The derivative of the contact forces at the solution: the entries it adds to S, and what each contact point sees.
    pub fn contact_tangent(&self, step: &Step, system: &System) -> (Vec<Entry>, Vec<PointTangent>) {
        let on_boundary = self.given.on_boundary(step, system.on_contact());
        on_boundary.map_or_else(Default::default, |on_boundary| on_boundary.tangent(&system.condensed, &system.contact_of(&self.w), &self.multipliers))
    }
}

/// Where a half-step starts.
struct Begun {
    w: Vec<f64>,
    multipliers: Multipliers,
    load: Vec<f64>,
    given: Given,
    mass_w: Vec<f64>,
    a_u: Vec<f64>,
    b_w: Vec<f64>,
}

impl Begun {
    /// At w_{n−1}, and where the displacement is prescribed, at (u_D(t_n) − u_{n−1})/k.
    fn new(step: &Step) -> Begun {
        let Step { problem, discrete, old, products, t, .. } = *step;
        let k = problem.k();
        let load = discrete.f.at(t);
        let mut w = vec![0.0; load.len()];
        discrete.v.prescribe(t, &mut w);
        for (i, w) in w.iter_mut().enumerate() {
            *w = if discrete.v.free[i] { old.w[i] } else { (*w - old.u[i]) / k };
        }
        let [mass_w, a_w, b_w] = if w == old.w {
            [products.mass_w.clone(), products.a_w.clone(), products.b_w.clone()]
        } else {
            [discrete.mass.apply(&w), discrete.apply_a(&w), discrete.apply_b(&w)]
        };
        let a_u = products.a_u.iter().zip(&a_w).map(|(a_u, a_w)| a_u + k * a_w).collect();
        let gap = problem.contact.as_ref().map_or(Vec::new(), |c| discrete.at_contact(&c.gap, t));
        let given = Given { u_old: at_nodes(discrete, discrete.mesh.dim, &old.u), w_prescribed: at_nodes(discrete, discrete.mesh.dim, &w), gap };
        Begun { w, multipliers: old.multipliers.clone(), load, given, mass_w, a_u, b_w }
    }
}

impl From<&Mechanics> for Begun {
    /// At a solution of the same step.
    fn from(m: &Mechanics) -> Begun {
        let Mechanics { w, multipliers, load, given, mass_w, a_u, b_w, .. } = m;
        Begun {
            w: w.clone(),
            multipliers: multipliers.clone(),
            load: load.clone(),
            given: given.clone(),
            mass_w: mass_w.clone(),
            a_u: a_u.clone(),
            b_w: b_w.clone(),
        }
    }
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
