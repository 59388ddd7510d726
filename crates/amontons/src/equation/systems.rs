//! The systems K(rule) of both half-steps, for one step length.

use std::sync::Arc;

use super::system::HalfStep;
use crate::discretization::Discretization;
use crate::linalg::{Backend, Choice, SolveError, System};
use crate::problem::Problem;
use crate::time::Rule;

/// The systems of the half-steps that a problem has, for one step length.
#[derive(Debug)]
pub(crate) struct Systems {
    pub rule: Rule,
    pub mechanics: Option<HalfStep>,
    pub heat: Option<HalfStep>,
}

impl Systems {
    /// Factorizes K_u and K_θ for step length `k`, at the temperature `theta`. For nonlinear laws K_u is the tangent at
    /// rest; each step replaces it.
    ///
    /// # Errors
    /// The name of the system that cannot be factorized, and the error.
    pub(crate) fn factorize(
        problem: &Problem,
        discrete: &Discretization,
        (k, theta): (f64, &[f64]),
        backend: &Arc<dyn Backend>,
    ) -> Result<Systems, (&'static str, SolveError)> {
        let rest = vec![0.0; discrete.v.free.len()];
        let rule = problem.scheme.rule(k);
        let mechanics = || {
            HalfStep::new(
                discrete.mechanical_tangent(rule, &rest, &rest, &discrete.warmed(theta)),
                discrete,
                &discrete.v,
                backend,
            )
        };
        let heat = || HalfStep::new(discrete.thermal_tangent(rule, theta), discrete, &discrete.q, backend);
        let physics = problem.physics;
        let (mechanics, heat) = rayon::join(
            || physics.has_mechanics().then(mechanics).transpose(),
            || physics.has_heat().then(heat).transpose(),
        );
        Ok(Systems {
            rule,
            mechanics: mechanics.map_err(|source| ("mechanical", source))?,
            heat: heat.map_err(|source| ("heat", source))?,
        })
    }

    pub(crate) fn all(&self) -> impl Iterator<Item = &System> {
        self.mechanics.iter().chain(&self.heat).map(|half| &half.system)
    }

    pub(crate) fn halves(&self) -> impl Iterator<Item = &HalfStep> {
        self.mechanics.iter().chain(&self.heat)
    }

    pub(crate) fn all_mut(&mut self) -> impl Iterator<Item = &mut System> {
        self.mechanics.iter_mut().chain(&mut self.heat).map(|half| &mut half.system)
    }

    /// Factorizes the matrices at these temperatures, one per half-step; an empty one leaves the matrix as it is.
    pub(crate) fn recall<'a>(
        &mut self,
        discrete: &Discretization,
        mut temperatures: impl Iterator<Item = &'a Vec<f64>>,
    ) -> Result<(), (&'static str, SolveError)> {
        let rest = vec![0.0; discrete.v.free.len()];
        if let Some(half) = &mut self.mechanics
            && let Some(theta) = temperatures.next().filter(|theta| theta.len() == discrete.q.free.len())
        {
            let tangent = discrete.mechanical_tangent(self.rule, &rest, &rest, &discrete.warmed(theta));
            half.replace(tangent, theta).map_err(|source| ("mechanical", source))?;
        }
        if let Some(half) = &mut self.heat
            && let Some(theta) = temperatures.next().filter(|theta| theta.len() == discrete.q.free.len())
        {
            half.replace(discrete.thermal_tangent(self.rule, theta), theta).map_err(|source| ("heat", source))?;
        }
        Ok(())
    }

    /// Makes the matrices those of these temperatures, one per half-step; an empty one stands for `start`.
    ///
    /// # Errors
    /// Those of [`Systems::factorize`].
    pub(crate) fn go_back<'a>(
        &mut self,
        discrete: &Discretization,
        start: &[f64],
        mut temperatures: impl Iterator<Item = &'a Vec<f64>>,
    ) -> Result<(), (&'static str, SolveError)> {
        let rest = vec![0.0; discrete.v.free.len()];
        let at = |wanted: &'a [f64]| if wanted.is_empty() { start.to_vec() } else { wanted.to_vec() };
        if let Some(half) = &mut self.mechanics
            && let Some(wanted) = temperatures.next().filter(|wanted| **wanted != half.at)
        {
            let theta = at(wanted);
            let tangent = discrete.mechanical_tangent(self.rule, &rest, &rest, &discrete.warmed(&theta));
            half.replace(tangent, wanted).map_err(|source| ("mechanical", source))?;
        }
        if let Some(half) = &mut self.heat
            && let Some(wanted) = temperatures.next().filter(|wanted| **wanted != half.at)
        {
            let tangent = discrete.thermal_tangent(self.rule, &at(wanted));
            half.replace(tangent, wanted).map_err(|source| ("heat", source))?;
        }
        Ok(())
    }

    /// Factorizations of the matrices so far, and of contact systems.
    pub(crate) fn factorizations(&self) -> [usize; 2] {
        self.all().fold([0; 2], |[matrices, contacts], system| {
            let (matrix, contact) = system.factorizations();
            [matrices + matrix, contacts + contact]
        })
    }

    /// What the systems say of themselves.
    pub(crate) fn solvers(&self) -> Solvers {
        let [mechanics, heat] =
            [&self.mechanics, &self.heat].map(|half| half.as_ref().map_or(0, |half| half.system.unknowns().len()));
        let on_contact = |half: &HalfStep| half.on_contact.iter().flatten().count();
        let is_iterative = self.all().any(|system| system.name() == "iterative");
        let choice = self.all().find_map(System::choice);
        let mut backend_reason = choice.map_or_else(|| Choice::ASKED.to_owned(), |choice| choice.why.clone());
        if self.all().any(|system| system.condensed().account().is_left) {
            backend_reason += "; the iteration took more work than predicted and was left for a factor";
        }
        Solvers {
            factorizations: self.factorizations(),
            unknowns: [mechanics, heat, self.mechanics.as_ref().map_or(0, on_contact)],
            backend: if is_iterative { "iterative" } else { "direct" },
            backend_reason,
        }
    }
}

/// The systems of a scheme, and the work done with them.
#[derive(Clone, Debug, PartialEq)]
pub struct Solvers {
    /// Factorizations of the matrices so far, and of contact systems.
    pub factorizations: [usize; 2],
    /// Unknowns of displacement, temperature and on Γ_C.
    pub unknowns: [usize; 3],
    /// `iterative` if one of the systems is solved so, else `direct`.
    pub backend: &'static str,
    /// Reason for the choice: predicted effort of both solvers, for the mechanical half-step if there is one.
    pub backend_reason: String,
}
