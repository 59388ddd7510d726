//! The systems K(rule) of both half-steps, and the store of them by rule.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::predictor;
use super::system::HalfStep;
use crate::discretization::Discretization;
use crate::inclusion::Loose;
use crate::linalg::{Account, Backend, Choice, Decided, SolveError, System, TangentKey, join};
use crate::problem::Problem;
use crate::time::{Analysis, Rule, Start};

/// The name of a system that cannot be factorized, and the error.
pub(crate) type SystemError = (&'static str, SolveError);

/// The systems of the half-steps that a problem has, for one rule.
#[derive(Debug)]
pub(crate) struct Systems {
    pub rule: Rule,
    pub mechanics: Option<HalfStep>,
    pub heat: Option<HalfStep>,
    /// M/k, if steps start from an admissible velocity.
    pub predictor: Option<HalfStep>,
    /// Rigid motions of the parts that are supported by contact only.
    pub loose: Arc<Loose>,
}

impl Systems {
    /// Factorizes K_u and K_θ for a rule, at the temperature `theta`. For nonlinear laws K_u is the tangent at rest;
    /// each step replaces it.
    ///
    /// # Errors
    /// The name of the system that cannot be factorized, and the error.
    fn factorize(
        problem: &Problem,
        discrete: &Discretization,
        rule: Rule,
        theta: &[f64],
        backend: &Arc<dyn Backend>,
    ) -> Result<Systems, SystemError> {
        let rest = vec![0.0; discrete.v.free.len()];
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
        let (mechanics, heat) = join(
            backend.is_collective(),
            || physics.has_mechanics().then(mechanics).transpose(),
            || physics.has_heat().then(heat).transpose(),
        );
        let mechanics = mechanics.map_err(|source| ("mechanical", source))?;
        let predictor = mechanics.as_ref().filter(|_| predictor::acts(problem, &rule)).map(|mechanics| {
            // A resumed run knows the solver of the mechanical half-step, so the predictor has the same.
            let known: Vec<Decided> = decided(mechanics, discrete.mesh.dim).into_iter().collect();
            let backend = backend.decided(&known).unwrap_or_else(|| Arc::clone(backend));
            HalfStep::new(discrete.inertia_matrix(rule.k), discrete, &discrete.v, &backend)
        });
        let predictor = predictor.transpose().map_err(|source| ("inertia of the mechanical", source))?;
        let loose = match (&mechanics, rule.analysis) {
            (None, _) => Loose::default(),
            (Some(half), Analysis::Dynamic) => half.motions(problem, discrete),
            (Some(half), Analysis::Quasistatic | Analysis::Steady) => {
                half.motions(&problem.without_inertia(), discrete)
            }
        };
        let heat = heat.map_err(|source| ("heat", source))?;
        Ok(Systems { rule, mechanics, heat, predictor, loose: Arc::new(loose) })
    }

    fn all(&self) -> impl Iterator<Item = &System> {
        self.halves().chain(&self.predictor).map(|half| &half.system)
    }

    /// Krylov iterations so far.
    pub fn iterations(&self) -> usize {
        self.all().map(System::iterations).sum()
    }

    fn halves(&self) -> impl Iterator<Item = &HalfStep> {
        self.mechanics.iter().chain(&self.heat)
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut System> {
        let all = self.mechanics.iter_mut().chain(&mut self.heat).chain(&mut self.predictor);
        all.map(|half| &mut half.system)
    }

    /// Factorizes the matrices at these temperatures, one per half-step; an empty one leaves the matrix as it is.
    fn recall<'a>(
        &mut self,
        discrete: &Discretization,
        mut temperatures: impl Iterator<Item = &'a Vec<f64>>,
    ) -> Result<(), SystemError> {
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
    fn go_back<'a>(
        &mut self,
        discrete: &Discretization,
        start: &[f64],
        mut temperatures: impl Iterator<Item = &'a Vec<f64>>,
    ) -> Result<(), SystemError> {
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
    fn factorizations(&self) -> [usize; 2] {
        self.all().fold([0; 2], |[matrices, contacts], system| {
            let (matrix, contact) = system.factorizations();
            [matrices + matrix, contacts + contact]
        })
    }

    /// What the systems say of themselves.
    fn solvers(&self) -> Solvers {
        let [mechanics, heat] =
            [&self.mechanics, &self.heat].map(|half| half.as_ref().map_or(0, |half| half.system.unknowns().len()));
        let on_contact = |half: &HalfStep| half.on_contact.iter().flatten().count();
        let is_iterative = self.all().any(|system| system.name() == "iterative");
        let choice = self.all().find_map(System::choice);
        let given = self.all().find_map(System::reason);
        let asked = || given.unwrap_or_else(|| Choice::ASKED.to_owned());
        let mut backend_reason = choice.map_or_else(asked, |choice| choice.why.clone());
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

/// The solver of a half-step, if the program has chosen it.
fn decided(half: &HalfStep, components: usize) -> Option<Decided> {
    let choice = half.system.choice()?;
    let Choice { why, may_change, .. } = choice.clone();
    Some(Decided { components, direct: choice.is_direct(), why, may_change })
}

/// The systems of a run by their rules. Each is made once, when a step first needs it, and kept until it is dropped.
#[derive(Debug)]
pub(crate) struct Cache {
    backend: Arc<dyn Backend>,
    /// Temperature at which matrices are factorized first.
    start: Vec<f64>,
    all: Vec<Systems>,
    /// What the systems that were dropped last said of themselves, with the factorizations of all dropped ones.
    dropped: Solvers,
    /// The solvers of the systems that were there before a change of conditions.
    decided: Vec<Decided>,
}

impl Cache {
    pub(crate) fn new(backend: &Arc<dyn Backend>, start: Vec<f64>) -> Cache {
        Cache { backend: Arc::clone(backend), start, all: Vec::new(), dropped: Solvers::default(), decided: Vec::new() }
    }

    /// The systems of a rule, factorized if they are not there.
    ///
    /// # Errors
    /// Those of [`Systems::factorize`].
    pub(crate) fn systems(
        &mut self,
        problem: &Problem,
        discrete: &Discretization,
        rule: Rule,
    ) -> Result<&mut Systems, SystemError> {
        let place = if let Some(place) = self.all.iter().position(|systems| systems.rule == rule) {
            place
        } else {
            self.all.push(Systems::factorize(problem, discrete, rule, &self.start, &self.backend)?);
            self.all.len() - 1
        };
        Ok(&mut self.all[place])
    }

    /// Drops the systems of all other rules.
    pub(crate) fn keep_only(&mut self, is_needed: impl Fn(&Rule) -> bool) {
        let (kept, dropped) = std::mem::take(&mut self.all).into_iter().partition(|systems| is_needed(&systems.rule));
        self.all = kept;
        for systems in Vec::into_iter(dropped) {
            let [matrices, contacts] = self.dropped.factorizations;
            let solvers = Systems::solvers(&systems);
            let factorizations = [matrices + solvers.factorizations[0], contacts + solvers.factorizations[1]];
            self.dropped = Solvers { factorizations, ..solvers };
        }
    }

    /// Drops all systems, because conditions change. Those of the next phase have the same solvers, as after a resume.
    pub(crate) fn drop_all(&mut self, dim: usize) {
        self.decided = self.kept(dim).solvers;
        if let Some(backend) = self.backend.decided(&self.decided) {
            self.backend = backend;
        }
        self.keep_only(|_| false);
    }

    /// Numbers stored by the factors of all systems.
    pub(crate) fn stored(&self) -> usize {
        self.all.iter().flat_map(Systems::all).map(System::stored).sum()
    }

    /// The solvers, with the factorizations of all systems so far.
    pub(crate) fn solvers(&self) -> Solvers {
        let made = self.all.iter().map(Systems::factorizations);
        let factorizations = made.fold(self.dropped.factorizations, |[matrices, contacts], [matrix, contact]| {
            [matrices + matrix, contacts + contact]
        });
        let own = self.all.first().map_or_else(|| self.dropped.clone(), Systems::solvers);
        Solvers { factorizations, ..own }
    }

    /// Systems that a resumed run has to factorize again, as [`Kept`] has them.
    pub(crate) fn kept(&self, dim: usize) -> Kept {
        let all = || self.all.iter().flat_map(Systems::all);
        let of = |half: &Option<HalfStep>, components: usize| decided(half.as_ref()?, components);
        let first = self.all.first().map(|Systems { mechanics, heat, .. }| [of(mechanics, dim), of(heat, 1)]);
        Kept {
            rules: self.all.iter().map(|systems| KeptRule::of(&systems.rule)).collect(),
            temperatures: self.all.iter().flat_map(Systems::halves).map(|half| half.at.clone()).collect(),
            tangents: all().map(|system| system.condensed().kept()).collect(),
            solvers: first.map_or_else(|| self.decided.clone(), |first| first.into_iter().flatten().collect()),
            accounts: all().map(|system| system.condensed().account()).collect(),
            phase: 0,
        }
    }

    /// Makes the systems of a run before, and drops others.
    ///
    /// # Errors
    /// Those of [`Systems::factorize`].
    pub(crate) fn recall(
        &mut self,
        problem: &Problem,
        discrete: &Discretization,
        kept: &Kept,
    ) -> Result<(), SystemError> {
        let rules: Vec<Rule> = kept.rules.iter().map(|rule| rule.in_problem(problem)).collect();
        self.arrange(problem, discrete, &rules)?;
        let mut temperatures = kept.temperatures.iter();
        self.all.iter_mut().try_for_each(|systems| systems.recall(discrete, &mut temperatures))?;
        for (i, system) in self.all.iter_mut().flat_map(Systems::all_mut).enumerate() {
            let condensed = system.condensed_mut();
            kept.tangents.get(i).into_iter().for_each(|kept| condensed.recall(kept));
            kept.accounts.get(i).into_iter().for_each(|account| condensed.go_on_from(*account));
        }
        Ok(())
    }

    /// Makes exactly the systems of these rules, in their order.
    ///
    /// # Errors
    /// Those of [`Systems::factorize`].
    fn arrange(&mut self, problem: &Problem, discrete: &Discretization, rules: &[Rule]) -> Result<(), SystemError> {
        self.keep_only(|rule| rules.contains(rule));
        rules.iter().try_for_each(|rule| self.systems(problem, discrete, *rule).map(|_| ()))?;
        self.all.sort_by_key(|systems| rules.iter().position(|rule| *rule == systems.rule));
        Ok(())
    }

    /// Goes back to the systems of an earlier state of this run.
    ///
    /// Factors of tangents on Γ_C are found by the tangent and stay. Matrices are factorized again only if they were
    /// refactorized at another temperature since, or dropped, or if a factor has replaced an iteration.
    ///
    /// # Errors
    /// Those of [`Systems::factorize`].
    pub(crate) fn go_back(
        &mut self,
        problem: &Problem,
        discrete: &Discretization,
        kept: &Kept,
    ) -> Result<(), SystemError> {
        let rules: Vec<Rule> = kept.rules.iter().map(|rule| rule.in_problem(problem)).collect();
        let is_there = |rule: &Rule| self.all.iter().any(|systems| systems.rule == *rule);
        if !rules.iter().all(is_there) {
            self.keep_only(|_| false);
            return self.recall(problem, discrete, kept);
        }
        self.arrange(problem, discrete, &rules)?;
        let now = self.all.iter().flat_map(Systems::all).map(|system| system.condensed().account().is_left);
        // A factor has replaced an iteration since.
        if now.zip(&kept.accounts).any(|(now, then)| now != then.is_left) {
            self.keep_only(|_| false);
            return self.recall(problem, discrete, kept);
        }
        let mut temperatures = kept.temperatures.iter();
        self.all.iter_mut().try_for_each(|systems| systems.go_back(discrete, &self.start, &mut temperatures))?;
        for (system, account) in self.all.iter_mut().flat_map(Systems::all_mut).zip(&kept.accounts) {
            system.condensed_mut().go_on_from(*account);
        }
        Ok(())
    }
}

/// Factorizations that a scheme keeps between steps, and the chosen solvers, so that a resumed run has the same bits
/// and counts as one without a break.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    /// Rules that have matrices.
    pub rules: Vec<KeptRule>,
    /// Temperature of each system whose matrix was refactorized for it; empty for others.
    #[serde(default)]
    pub temperatures: Vec<Vec<f64>>,
    /// The tangents on Γ_C of each system.
    pub tangents: Vec<Vec<TangentKey>>,
    /// Solvers of the systems that the program has chosen.
    pub solvers: Vec<Decided>,
    /// The work of the iteration of each system.
    #[serde(default)]
    pub accounts: Vec<Account>,
    /// The phase whose conditions the systems have.
    #[serde(default)]
    pub phase: usize,
}

/// What tells the rules of a run apart.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptRule {
    /// Length k of the step, s.
    pub k: f64,
    /// Whether inertia acts.
    pub analysis: Analysis,
    /// Whether the step adds to two states.
    #[serde(default)]
    pub has_two_states: bool,
}

impl KeptRule {
    /// The rule of a problem, whose step lengths may differ from the kept one by round-off.
    fn in_problem(self, problem: &Problem) -> Rule {
        let k = problem.timeline.snapped(self.k);
        if self.has_two_states { problem.rule(self.analysis, k) } else { problem.starting_rule(self.analysis, k) }
    }

    fn of(rule: &Rule) -> KeptRule {
        KeptRule { k: rule.k, analysis: rule.analysis, has_two_states: rule.start == Start::TwoStates }
    }
}

/// The systems of a scheme, and the work done with them.
#[derive(Clone, Debug, Default, PartialEq)]
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
