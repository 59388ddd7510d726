//! A factorized system with its condensed operator, and what the parts of a step share.

use std::sync::Arc;

use super::{Discretization, State, StepError};
use crate::contact::{PointOnBoundary, Status};
use crate::inclusion::{NotConverged, Rule};
use crate::linalg::{Backend, BlockMatrix, Condensed, Entry, Factor, FactorError, Unknowns};
use crate::problem::Problem;
use crate::space::Space;
use crate::tensor::Point;

/// Largest relative residual of a step that is accepted.
pub const ACCEPTED: f64 = 1e-10;
/// Roundings of a state, each of half a last bit or less, that a residual may have: those of u and of the terms made of
/// it.
const ROUNDINGS: f64 = 2.0;
/// Largest share of it in what acts on the body.
const BESIDE: f64 = 1e-4;
/// Relative residual above which another pass of sweeps is made.
pub const REFINE: f64 = 1e-11;

/// What is known when a step is made.
#[derive(Clone, Copy)]
pub(super) struct Step<'a> {
    pub problem: &'a Problem,
    pub discrete: &'a Discretization,
    /// The state that the step starts from.
    pub old: &'a State,
    pub products: &'a Products,
    /// n.
    pub n: usize,
    /// t_n in s, and the length k of the step, by which a rate at its end counts in the audit.
    pub t: f64,
    pub k: f64,
    /// The rule in time.
    pub rule: Rule,
}

impl Step<'_> {
    /// ū + γ w, ū = u_{n−1}.
    pub fn displacement(&self, w: &[f64]) -> Vec<f64> {
        let gamma = self.rule.gamma;
        self.old.u.iter().zip(w).map(|(u, w)| u + gamma * w).collect()
    }

    /// |ū| + γ |w|, the sizes of what u_n is the sum of.
    pub fn sizes(&self, w: &[f64]) -> Vec<f64> {
        self.old.u.iter().zip(w).map(|(u, w)| u.abs() + self.rule.gamma * w.abs()).collect()
    }

    /// z_n = (z̄ + γ w)/(1 + γ/τ) of each branch that relaxes.
    pub fn branches(&self, w: &[f64]) -> Vec<Vec<f64>> {
        let gamma = self.rule.gamma;
        let branches = self.discrete.branches.iter().zip(&self.old.branches);
        branches
            .map(|(branch, z)| z.iter().zip(w).map(|(z, w)| branch.factor(self.rule) * (z + gamma * w)).collect())
            .collect()
    }

    /// Σ ∫ 𝓖ε(z_n):ε(·) of the branches; empty without.
    pub fn relaxing(&self, w: &[f64]) -> Vec<f64> {
        let mut sum = Vec::new();
        for (branch, z) in self.discrete.branches.iter().zip(self.branches(w)) {
            let force = branch.form.apply(&z);
            if sum.is_empty() {
                sum = force;
            } else {
                sum.iter_mut().zip(&force).for_each(|(sum, force)| *sum += force);
            }
        }
        sum
    }

    /// An error where a value is not finite.
    pub fn finite(&self, values: &[f64], part: &'static str) -> Result<(), StepError> {
        if values.iter().all(|v| v.is_finite()) {
            Ok(())
        } else {
            Err(StepError::NotFinite { step: self.n, t: self.t, part })
        }
    }

    /// A residual relative to the largest term of its equation.
    pub fn relative(&self, residual: f64, scale: f64, part: &'static str) -> Result<f64, StepError> {
        let relative = if residual == 0.0 { 0.0 } else { residual / scale };
        if relative.is_nan() { Err(StepError::NotFinite { step: self.n, t: self.t, part }) } else { Ok(relative) }
    }

    /// The residual relative to the largest term, if it is small enough to be a result: below [`ACCEPTED`], or what the
    /// last bits of the state make of it (`round_off`), as long as that is small beside what acts on the body
    /// (`driven`), if something does. A contact force that is no more than that round-off is none.
    pub fn accept(
        &self,
        [residual, scale, driven, contact]: [f64; 4],
        part: &'static str,
        round_off: impl FnOnce() -> f64,
    ) -> Result<f64, StepError> {
        if residual <= ACCEPTED {
            return Ok(residual);
        }
        let round_off = round_off();
        let driven = if contact > ROUNDINGS * round_off { driven.max(contact) } else { driven };
        if residual * scale <= ROUNDINGS * round_off && (driven == 0.0 || round_off <= BESIDE * driven) {
            return Ok(residual);
        }
        Err(StepError::Residual { step: self.n, t: self.t, part, residual, accepted: ACCEPTED })
    }

    /// A tangent that could not be factorized.
    pub fn singular(&self, source: FactorError) -> StepError {
        StepError::Singular { step: self.n, t: self.t, source }
    }

    /// The iteration on Γ_C that did not end.
    pub fn not_converged(&self, part: &'static str, why: NotConverged) -> StepError {
        let unsettled = self.unsettled(&why);
        StepError::NotConverged { step: self.n, t: self.t, part, why: Box::new(why), unsettled }
    }

    /// The first contact points that did not settle: place, side, laws, states of the last iterates.
    fn unsettled(&self, why: &NotConverged) -> String {
        const TOLD: usize = 3;
        let name = |law: String| law.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned();
        let one = |(i, states): &(usize, Vec<Status>)| {
            let point = self.discrete.boundary.points.get(*i)?;
            let contact = self.problem.contacts.get(point.side)?;
            let laws = [format!("{:?}", contact.normal), format!("{:?}", contact.friction)].map(name).join(", ");
            let states: Vec<&str> = states.iter().map(|status| status.name()).collect();
            let [x, y, z] = point.x;
            Some(format!("({x}, {y}, {z}) on \"{}\" ({laws}): {}", contact.on, states.join(", ")))
        };
        let told: Vec<String> = why.unsettled.iter().filter_map(one).take(TOLD).collect();
        if told.is_empty() {
            return String::new();
        }
        let count = why.unsettled.len();
        let points = if count == 1 { "point does" } else { "points do" };
        format!("; {count} contact {points} not settle: {}", told.join("; "))
    }
}

/// Products of a state with the forms, which one step computes and the next one needs.
#[derive(Debug)]
pub(super) struct Products {
    /// t_n of the state.
    pub t: f64,
    /// (ρ·, ·), or (·, ·) where the density is the same everywhere.
    pub mass_w: Vec<f64>,
    pub a_u: Vec<f64>,
    /// a(w, ·); empty where a is not linear.
    pub a_w: Vec<f64>,
    pub b_w: Vec<f64>,
    pub mass_theta: Vec<f64>,
    pub d_theta: Vec<f64>,
}

impl Products {
    /// The products of a state.
    pub fn of(discrete: &Discretization, state: &State) -> Products {
        let [mass_w, a_u, a_w, b_w] = discrete.mechanical_products(&state.u, &state.w);
        let (mass_theta, d_theta) = (discrete.storage().1.apply(&state.theta), discrete.apply_d(&state.theta));
        Products { t: state.t, mass_w, a_u, a_w, b_w, mass_theta, d_theta }
    }
}

/// A factorized system with its condensed operator.
#[derive(Debug)]
pub(super) struct System {
    pub unknowns: Unknowns,
    pub factor: Box<dyn Factor>,
    backend: Arc<dyn Backend>,
    factorizations: usize,
    pub condensed: Condensed,
    /// Contact unknown of each degree of freedom of the contact nodes.
    pub on_contact: Vec<Option<u32>>,
}

impl System {
    /// Factorizes a matrix with the contact unknowns last.
    pub fn new(
        matrix: &BlockMatrix,
        discrete: &Discretization,
        space: &Space,
        backend: &Arc<dyn Backend>,
    ) -> Result<System, FactorError> {
        let contact = &discrete.boundary.nodes;
        let unknowns = Unknowns::new(matrix, &discrete.mesh.points, space.components, &space.free, contact);
        let factor = backend.factorize(matrix, &unknowns)?;
        let condensed = Condensed::new(factor.condensed(), unknowns.contact_nodes(space.components));
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
        Ok(System { unknowns, factor, backend: Arc::clone(backend), factorizations: 1, condensed, on_contact })
    }

    /// Factorizes another matrix with the same unknowns.
    pub fn refactorize(&mut self, matrix: &BlockMatrix) -> Result<(), FactorError> {
        self.factor = self.backend.factorize(matrix, &self.unknowns)?;
        self.condensed.replace(self.factor.condensed());
        self.factorizations += 1;
        Ok(())
    }

    /// Factorizations so far.
    pub fn factorizations(&self) -> usize {
        self.factorizations
    }

    /// The forward sweep: the right-hand side in elimination order, reduced to Γ_C.
    pub fn reduce(&self, right: &[f64]) -> Vec<f64> {
        let mut x = self.unknowns.gather(right);
        self.factor.forward(&mut x);
        x
    }

    /// The problem on Γ_C, which `solve` finds from the reduced right-hand side, and the backward sweep:
    /// adds the increment that the right-hand side causes to the values.
    pub fn expand<T>(
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

    /// Solves the system with the entries of a contact term added, for all degrees of freedom.
    pub fn linearised(&mut self, entries: &[Entry], right: &[f64]) -> Vec<f64> {
        let mut x = self.reduce(right);
        let (_, contact) = x.split_at_mut(self.unknowns.interior);
        if !contact.is_empty() {
            // The entries are in the bases of the contact points.
            let turns = self.condensed.turns().to_vec();
            for turn in &turns {
                turn.forward(contact);
            }
            self.condensed.solve(entries, contact);
            for turn in &turns {
                turn.back(contact);
            }
        }
        self.factor.backward(&mut x);
        let mut values = vec![0.0; right.len()];
        self.unknowns.add(&x, &mut values);
        values
    }

    /// The contact unknowns of a vector over all degrees of freedom.
    pub fn contact_of(&self, values: &[f64]) -> Vec<f64> {
        self.unknowns.contact().iter().map(|&d| values[d as usize]).collect()
    }

    /// Contact unknown of each degree of freedom of the contact nodes, none where prescribed.
    pub fn on_contact(&self) -> &[Option<u32>] {
        &self.on_contact
    }
}

/// Values at the contact nodes, node-major.
pub(super) fn at_nodes(discrete: &Discretization, components: usize, values: &[f64]) -> Vec<f64> {
    discrete
        .boundary
        .nodes
        .iter()
        .flat_map(|&n| &values[n as usize * components..(n as usize + 1) * components])
        .copied()
        .collect()
}

/// Values at the contact points of a scalar at the nodes.
pub(super) fn scalars_at(discrete: &Discretization, values: &[f64]) -> Vec<f64> {
    let boundary = &discrete.boundary;
    boundary
        .points
        .iter()
        .map(|point| point.nodes.iter().map(|&(node, value)| value * values[boundary.nodes[node] as usize]).sum())
        .collect()
}

/// Σ ω Nᵀ · of vectors at the contact points, over all degrees of freedom.
pub(super) fn on_degrees(discrete: &Discretization, vectors: impl Iterator<Item = Point>) -> Vec<f64> {
    let (boundary, dim) = (&discrete.boundary, discrete.mesh.dim);
    let mut sum = vec![0.0; discrete.v.free.len()];
    for (point, vector) in boundary.points.iter().zip(vectors) {
        for &(node, value) in &point.nodes {
            for c in 0..dim {
                sum[boundary.nodes[node] as usize * dim + c] += point.weight * value * vector[c];
            }
        }
    }
    sum
}

/// The vector of a field over all degrees of freedom at a contact point.
pub(super) fn vector_at(discrete: &Discretization, point: &PointOnBoundary, values: &[f64]) -> Point {
    let mut v = [0.0; 3];
    for &(node, value) in &point.nodes {
        for c in 0..discrete.mesh.dim {
            v[c] += value * values[discrete.boundary.nodes[node] as usize * discrete.mesh.dim + c];
        }
    }
    v
}

/// a − b.
pub(super) fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
