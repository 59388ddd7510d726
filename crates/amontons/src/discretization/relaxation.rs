//! Stress relaxation: the Maxwell branches of all materials on a mesh, with their state.

use std::borrow::Cow;
use std::sync::Arc;

use super::ZERO;
use crate::field::Law;
use crate::forms::{self, StrainPoints};
use crate::linalg::{BlockMatrix, Graph, dot};
use crate::material::{Branch, Dilatation, Material, Prony, TensorLaw};
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::time::{Rule, Start};

/// Maxwell branches of the body that share one state.
///
/// The spring of a branch has the strain e with ė + e/τ = ε(u̇). If τ is uniform, e = ε(z) is the strain of a field z
/// with ż + z/τ = u̇, and one nodal z serves all branches with this τ. If τ varies, e is the strain of no field and is
/// stored at the points of the cells at which the forms need it.
#[derive(Debug)]
pub struct Relaxation(BranchKind);

#[derive(Debug)]
enum BranchKind {
    /// One relaxation time τ, s, with the form ∫ 𝓖ε(·):ε(·).
    Same { time: f64, form: BlockMatrix },
    /// Springs per region, and τ (s) at the points of the cells.
    Varying {
        mesh: Arc<Mesh>,
        dilatation: Vec<Dilatation>,
        graph: Arc<Graph>,
        springs: Vec<Law<dyn TensorLaw>>,
        times: Vec<f64>,
    },
}

/// Energies of the branches over a step in the energy identity, J.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Relaxed {
    /// Energy stored in the springs at the end of the step.
    pub stored: f64,
    /// Energy dissipated by the dashpots.
    pub dissipated: f64,
    /// Energy dissipated by the time scheme.
    pub scheme: f64,
}

impl Relaxation {
    /// Branches of all materials: first one group per relaxation time, ascending, then those whose time varies in
    /// space.
    pub(super) fn of(problem: &Problem, graph: &Arc<Graph>) -> Vec<Relaxation> {
        let mesh = &problem.mesh;
        let same = problem.relaxation_times().into_iter().map(|time| {
            let is_its = |branch: &&Branch| !branch.time_varies() && branch.time.to_bits() == time.to_bits();
            let of = |m: &Material| branches_of(m).iter().filter(is_its).cloned().collect::<Vec<_>>();
            Relaxation(BranchKind::Same {
                time,
                form: form(problem, graph, problem.materials.iter().map(of).collect()),
            })
        });
        let varying = (0..problem.varying_branches()).map(|number| {
            let of = |m: &Material| m.varying_branches().nth(number).unwrap_or(&ZERO).clone();
            let springs: Vec<Branch> = problem.materials.iter().map(of).collect();
            let dilatation = problem.dilatation();
            let points = StrainPoints { mesh, dilatation: &dilatation };
            let times = points.values(|region, x| {
                springs.get(region).or(springs.last()).map_or(f64::INFINITY, |spring| spring.at(x).time)
            });
            let springs = springs.iter().map(Branch::law).collect();
            let (mesh, graph) = (Arc::clone(mesh), Arc::clone(graph));
            Relaxation(BranchKind::Varying { mesh, dilatation, graph, springs, times })
        });
        same.chain(varying).collect()
    }

    /// τ in s and the form of the springs if τ is uniform; `None` if it varies in space.
    #[must_use]
    pub fn uniform(&self) -> Option<(f64, &BlockMatrix)> {
        match &self.0 {
            BranchKind::Same { time, form } => Some((*time, form)),
            BranchKind::Varying { .. } => None,
        }
    }

    /// Length of the state: `fields`, the length of a displacement vector, if τ is uniform, otherwise that of the
    /// strains at all points.
    #[must_use]
    pub fn size(&self, fields: usize) -> usize {
        match &self.0 {
            BranchKind::Same { .. } => fields,
            BranchKind::Varying { mesh, dilatation, times, .. } => {
                StrainPoints { mesh, dilatation }.components() * times.len()
            }
        }
    }

    /// True if the state is a nodal field: τ is uniform.
    #[must_use]
    pub fn has_field(&self) -> bool {
        matches!(self.0, BranchKind::Same { .. })
    }

    /// The state z_ϑ = (z̄ + γ w)/(1 + γ/τ), or that of strains, e_ϑ = (ē + γ ε(w))/(1 + γ/τ).
    #[must_use]
    pub fn step(&self, rule: Rule, bar: &[f64], w: &[f64]) -> Vec<f64> {
        let gamma = rule.gamma;
        match &self.0 {
            BranchKind::Same { time, .. } => {
                bar.iter().zip(w).map(|(z, w)| factor(rule, *time) * (z + gamma * w)).collect()
            }
            BranchKind::Varying { mesh, dilatation, times, .. } => {
                let points = StrainPoints { mesh, dilatation };
                let mut strains = points.strains(w);
                let count = points.components();
                for ((e, bar), time) in strains.chunks_exact_mut(count).zip(bar.chunks_exact(count)).zip(times) {
                    e.iter_mut().zip(bar).for_each(|(e, bar)| *e = factor(rule, *time) * (bar + gamma * *e));
                }
                strains
            }
        }
    }

    /// What a step keeps of a state, z̄/(1 + γ/τ): its derivative by z̄, which is symmetric, times a vector.
    #[must_use]
    pub fn kept(&self, rule: Rule, bar: &[f64]) -> Vec<f64> {
        match &self.0 {
            BranchKind::Same { time, .. } => bar.iter().map(|z| factor(rule, *time) * z).collect(),
            BranchKind::Varying { mesh, dilatation, times, .. } => {
                let count = StrainPoints { mesh, dilatation }.components();
                bar.iter().enumerate().map(|(i, e)| factor(rule, times[i / count]) * e).collect()
            }
        }
    }

    /// The transposed of the derivative of [`Relaxation::step`] by w times a vector.
    #[must_use]
    pub fn step_transposed(&self, rule: Rule, state: &[f64]) -> Vec<f64> {
        let mut kept = self.kept(rule, state);
        for number in &mut kept {
            *number *= rule.gamma;
        }
        match &self.0 {
            BranchKind::Same { .. } => kept,
            BranchKind::Varying { mesh, dilatation, .. } => StrainPoints { mesh, dilatation }.strains_transposed(&kept),
        }
    }

    /// The transposed of [`Relaxation::force`] times a vector of nodes.
    #[must_use]
    pub fn force_transposed(&self, y: &[f64]) -> Vec<f64> {
        match &self.0 {
            BranchKind::Same { form, .. } => form.apply(y),
            BranchKind::Varying { mesh, dilatation, springs, .. } => {
                StrainPoints { mesh, dilatation }.force_transposed(&borrowed(springs), y)
            }
        }
    }

    /// Nodal forces ∫ 𝓖e:ε(·) of a state.
    #[must_use]
    pub fn force(&self, state: &[f64]) -> Vec<f64> {
        match &self.0 {
            BranchKind::Same { form, .. } => form.apply(state),
            BranchKind::Varying { mesh, dilatation, springs, .. } => {
                StrainPoints { mesh, dilatation }.force(&borrowed(springs), state)
            }
        }
    }

    /// Adds γ/(1 + γ/τ) ∫ 𝓖ε(·):ε(·), the derivative of [`Relaxation::force`] by w_n.
    pub(super) fn add_stiffness(&self, rule: Rule, matrix: &mut BlockMatrix) {
        match &self.0 {
            BranchKind::Same { time, form } => matrix.add_scaled(rule.gamma * factor(rule, *time), form),
            BranchKind::Varying { mesh, dilatation, graph, springs, times } => {
                let factors: Vec<f64> = times.iter().map(|time| factor(rule, *time)).collect();
                let points = StrainPoints { mesh, dilatation };
                matrix.add_scaled(rule.gamma, &points.form(graph, &borrowed(springs), &factors));
            }
        }
    }

    /// Energy ½ ∫ e:𝓖e of the springs, J.
    pub(crate) fn energy(&self, state: &[f64]) -> f64 {
        match &self.0 {
            BranchKind::Same { form, .. } => 0.5 * dot(state, &form.apply(state)),
            BranchKind::Varying { .. } => 0.5 * self.products(state)[0],
        }
    }

    /// Energies over a step with the state at t_ϑ, from e₀ and ē: the terms of q_ϑ:(ε₁ − ε₀) = [½ e:𝓖e] +
    /// (k/τ) e_ϑ:𝓖e_ϑ + (ϑ − ½) Δe:𝓖Δe, or of a step that adds to two states k/γ (e₁ − ē):𝓖e₁ − [½ e:𝓖e] in the place
    /// of the last one. In a steady step the dashpots take all that the springs had.
    pub(crate) fn balance(&self, rule: Rule, [old, bar]: [&[f64]; 2], at_level: &[f64]) -> Relaxed {
        if rule.is_steady() {
            return Relaxed { stored: 0.0, dissipated: self.energy(old), scheme: 0.0 };
        }
        let (k, share) = (rule.k, rule.level - 0.5);
        let end = || at_level.iter().zip(old).map(|(at, old)| rule.end([*old, *at])).collect::<Vec<f64>>();
        let new: Cow<[f64]> = if rule.is_at_end() { Cow::Borrowed(at_level) } else { Cow::Owned(end()) };
        let from = if rule.start == Start::State { old } else { bar };
        let change: Vec<f64> = new.iter().zip(from).map(|(new, old)| new - old).collect();
        if rule.start == Start::TwoStates {
            let sum: Vec<f64> = at_level.iter().zip(&change).map(|(at, change)| at + change).collect();
            // By polarisation, 2 a:𝓖b of the state and its change.
            let [[now, rate], [changed, _], [both, _]] = [at_level, &change, &sum].map(|e| self.energies(e));
            let (stored, worked) = (0.5 * now, 0.5 * k / rule.gamma * (both - now - changed));
            return Relaxed { stored, dissipated: k * rate, scheme: worked - (stored - self.energy(old)) };
        }
        match &self.0 {
            BranchKind::Same { time, form } => {
                let product = dot(at_level, &form.apply(at_level));
                let stored = if rule.is_at_end() { product } else { dot(&new, &form.apply(&new)) };
                let scheme = share * dot(&change, &form.apply(&change));
                Relaxed { stored: 0.5 * stored, dissipated: k / time * product, scheme }
            }
            BranchKind::Varying { .. } => {
                let ([product, rate], scheme) = (self.products(at_level), share * self.products(&change)[0]);
                let stored = if rule.is_at_end() { product } else { self.products(&new)[0] };
                Relaxed { stored: 0.5 * stored, dissipated: k * rate, scheme }
            }
        }
    }

    /// ∫ e:𝓖e and ∫ e:𝓖e/τ of a state.
    fn energies(&self, state: &[f64]) -> [f64; 2] {
        match &self.0 {
            BranchKind::Same { time, form } => {
                let product = dot(state, &form.apply(state));
                [product, product / time]
            }
            BranchKind::Varying { .. } => self.products(state),
        }
    }

    /// ∫ e:𝓖e and ∫ e:𝓖e/τ of strains at the points.
    fn products(&self, strains: &[f64]) -> [f64; 2] {
        let BranchKind::Varying { mesh, dilatation, springs, times, .. } = &self.0 else { return [0.0; 2] };
        let rates: Vec<f64> = times.iter().map(|time| 1.0 / time).collect();
        StrainPoints { mesh, dilatation }.products(&borrowed(springs), strains, &rates)
    }
}

/// Scale 1/(1 + γ/τ) by which a step reduces the strain of a spring; a steady one leaves none.
fn factor(rule: Rule, time: f64) -> f64 {
    if rule.is_steady() { 0.0 } else { 1.0 / (1.0 + rule.gamma / time) }
}

fn branches_of(material: &Material) -> &[Branch] {
    material.prony.as_ref().map_or(&[], Prony::branches)
}

fn borrowed(laws: &[Law<dyn TensorLaw>]) -> Vec<&Law<dyn TensorLaw>> {
    laws.iter().collect()
}

/// ∫ 𝓖ε(·):ε(·) with the sum of the springs of each region.
fn form(problem: &Problem, graph: &Arc<Graph>, by_region: Vec<Vec<Branch>>) -> BlockMatrix {
    let dilatation = problem.dilatation();
    let assemble = |springs: &[Branch]| {
        let laws: Vec<_> = springs.iter().map(Branch::law).collect();
        forms::tensor_form(&problem.mesh, graph, &borrowed(&laws), &dilatation)
    };
    let uniform = |branches: &Vec<Branch>| {
        let mut sum = ZERO.clone();
        for branch in branches.iter().filter(|branch| !branch.modulus_varies()) {
            for (sum, entry) in sum.modulus.0.iter_mut().flatten().zip(branch.modulus.0.iter().flatten()) {
                *sum += entry;
            }
        }
        sum
    };
    let mut form = assemble(&by_region.iter().map(uniform).collect::<Vec<_>>());
    // Springs that vary in space, one per region at a time.
    let graded = |branches: Vec<Branch>| branches.into_iter().filter(Branch::modulus_varies).collect();
    let graded: Vec<Vec<Branch>> = by_region.into_iter().map(graded).collect();
    for number in 0..graded.iter().map(Vec::len).max().unwrap_or(0) {
        let springs: Vec<Branch> = graded.iter().map(|all| all.get(number).unwrap_or(&ZERO).clone()).collect();
        form.add_scaled(1.0, &assemble(&springs));
    }
    form
}
