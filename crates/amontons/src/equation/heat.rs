//! The heat half-step (4.2).

use std::sync::Arc;

use super::StepError;
use super::foundation::temperatures;
use super::mixing::Mixing;
use super::system::{HalfStep, REFINE, Renewal, Rounded, Step, over_blocks, without_contact};
use crate::inclusion::residual::Residual;
use crate::inclusion::{Exchange, HeatStep, Lumped, PointState};
use crate::linalg::{SolveError, Tangent, copy, map, map_block, max_abs, sum_block, zeros};
use crate::time::Rule;

/// Most passes of a heat half-step that is not linear.
const PASSES: usize = 100;

/// What the heat half-step found.
pub(crate) struct Heat {
    pub theta: Vec<f64>,
    pub mass_theta: Vec<f64>,
    pub d_theta: Vec<f64>,
    /// Heat supplied in the load and e(u, ·) of the displacement that the half-step was made with.
    pub supply: Arc<Vec<f64>>,
    pub coupling: Vec<f64>,
    /// The contact points, and the foundations that warm up.
    pub exchange: Exchange,
    /// ∫_{Γ_C} q·ν in W.
    pub through_contact: f64,
    /// Heat that has to be supplied, one number per prescribed temperature, W.
    pub reactions: Vec<f64>,
    /// Newton iterations on Γ_C, and sweeps.
    pub iterations: usize,
    pub sweeps: usize,
    /// Residual relative to `scale`, the largest term of the equation.
    pub residual: f64,
    pub scale: f64,
    pub amounts: Amounts,
}

/// Heat moved in one step, J.
#[derive(Default)]
pub(crate) struct Amounts {
    /// Stored at its end, less the factor of the form of storage.
    pub stored: f64,
    pub supplied: f64,
    pub coupling: f64,
    /// Through foundations, and made by friction between bodies, which all of it enters.
    pub contact: f64,
    pub rubbed: f64,
    pub prescribed: f64,
}

/// A heat half-step before the contact is known.
pub(crate) struct Begun {
    supply: Arc<Vec<f64>>,
    coupling: Vec<f64>,
    /// Where the half-step starts, with the prescribed values of t_n, and its products with the forms.
    theta: Vec<f64>,
    mass_theta: Vec<f64>,
    d_theta: Vec<f64>,
    /// The right-hand side for the increment over `theta`, reduced to Γ_C.
    reduced: Vec<f64>,
}

impl Begun {
    /// What of (4.2), with the displacement `u` in e, does not need the contact: up to the forward sweep. The half-step
    /// starts from θ_{n−1} or from a solution of the same step with another displacement.
    pub fn new(step: &Step, half: &HalfStep, u: &[f64], from: Option<&Heat>) -> Result<Begun, StepError> {
        let Step { discrete, old, bar, products, t, .. } = *step;
        let coupling = discrete.e.apply(u);
        let mut begun = if let Some(h) = from {
            let [theta, mass_theta, d_theta] = [&h.theta, &h.mass_theta, &h.d_theta].map(|v| copy(v));
            Begun { supply: Arc::clone(&h.supply), coupling, theta, mass_theta, d_theta, reduced: Vec::new() }
        } else {
            let mut theta = copy(&old.theta);
            discrete.q.prescribe(t, &mut theta);
            step.put_at_level(&mut theta);
            let [mass_theta, d_theta] = if theta == bar.theta {
                [copy(&products.mass_theta), copy(&products.d_theta)]
            } else {
                discrete.thermal_products(&theta)
            };
            Begun { supply: discrete.q_h.at(step.level), coupling, theta, mass_theta, d_theta, reduced: Vec::new() }
        };
        begun.reduced = begun.reduce(step, half)?;
        Ok(begun)
    }

    /// The forward sweep.
    fn reduce(&self, step: &Step, half: &HalfStep) -> Result<Vec<f64>, StepError> {
        half.system.reduce(&self.right(step)?).map_err(|source| step.unsolved("heat", source))
    }

    /// The right-hand side for the increment over θ at hand.
    fn right(&self, step: &Step) -> Result<Vec<f64>, StepError> {
        let storage = step.discrete.storage().0 / step.rule.delta;
        let terms = [&*self.supply, &self.coupling, &self.mass_theta, &step.products.mass_theta, &self.d_theta];
        let right = map(terms.map(|term| &**term), |[supply, coupling, mass_theta, bar, d_theta]| {
            supply + coupling - storage * (mass_theta - bar) - d_theta
        });
        step.finite(&right, "the data")?;
        Ok(right)
    }

    /// Solves (4.2) at the contact that the mechanical half-step has found.
    pub fn solve(mut self, step: &Step, half: &mut HalfStep, states: &[PointState]) -> Result<Heat, StepError> {
        let given = Given::new(step, &self.theta);
        if !step.discrete.conducts_linearly() {
            return self.solve_nonlinear(step, half, &given, states);
        }
        let (mut iterations, mut sweeps) = (0, 0);
        let mut previous = f64::INFINITY;
        loop {
            let (exchange, newton) = self.pass(step, half, &given, states)?;
            iterations += newton;
            sweeps += 2;
            let balance = self.balance(step, &exchange)?;
            if balance.residual.value <= REFINE || balance.residual.value >= 0.5 * previous {
                return self.found(step, exchange, balance, [iterations, sweeps]);
            }
            previous = balance.residual.value;
            self.reduced = self.reduce(step, half)?;
        }
    }

    /// The backward sweep with the contact solved before it: θ is that of the solution then.
    fn pass(
        &mut self,
        step: &Step,
        half: &mut HalfStep,
        given: &Given,
        states: &[PointState],
    ) -> Result<(Exchange, usize), StepError> {
        let HalfStep { system, on_contact, .. } = half;
        let guess = system.kept_of(&self.theta);
        let mut x = std::mem::take(&mut self.reduced);
        let solved = system
            .settle(&mut x, &self.theta, |condensed, r| {
                let Some(on_boundary) = given.on_boundary(step, on_contact, states) else {
                    let (x, iterations) = without_contact(condensed, r, &guess)?;
                    return Ok((x, (Exchange::default(), iterations)));
                };
                let (solved, exchange) = on_boundary.solve(condensed, r, &guess)?;
                Ok((solved.x, (exchange, solved.iterations)))
            })
            .map_err(|why| step.failed("heat", why))?;
        self.theta = system.expand(x, &self.theta).map_err(|source| step.unsolved("heat", source))?;
        step.finite(&self.theta, "heat")?;
        Ok(solved)
    }

    /// Solves (4.2) where 𝓚 or the heat capacity depend on the temperature: passes with the symmetric part of the
    /// tangent at an earlier temperature, mixed, with the contact solved in each.
    fn solve_nonlinear(
        mut self,
        step: &Step,
        half: &mut HalfStep,
        given: &Given,
        states: &[PointState],
    ) -> Result<Heat, StepError> {
        let (mut iterations, mut sweeps) = (0, 0);
        let (mut mixing, mut renewal, mut previous) = (Mixing::default(), Renewal::default(), f64::INFINITY);
        for passes in 1.. {
            let start = self.theta.clone();
            let (exchange, newton) = self.pass(step, half, given, states)?;
            iterations += newton;
            sweeps += 2;
            let balance = self.balance(step, &exchange)?;
            let ratio = balance.residual.value / previous;
            if Renewal::has_ended(balance.residual.value, ratio) || passes == PASSES {
                return self.found(step, exchange, balance, [iterations, sweeps]);
            }
            if renewal.is_due(ratio) {
                let tangent = step.discrete.thermal_tangent(step.rule, &self.theta);
                half.replace(tangent, &self.theta).map_err(|source| step.singular(source))?;
                mixing = Mixing::default();
            } else {
                self.theta = mixing.next(&start, &self.theta);
                [self.mass_theta, self.d_theta] = step.discrete.thermal_products(&self.theta);
            }
            previous = balance.residual.value;
            self.reduced = self.reduce(step, half)?;
        }
        Err(StepError::NotFinite { step: step.n, t: step.t, part: "heat" })
    }

    /// The residual of (4.2) at θ at hand, and the products of θ.
    fn balance(&mut self, step: &Step, exchange: &Exchange) -> Result<Balance, StepError> {
        let Begun { supply, coupling, theta, .. } = &*self;
        let Step { discrete, products, rule: Rule { delta, .. }, .. } = *step;
        let c = discrete.storage().0;
        let mut chi = zeros(theta.len());
        step.boundary.scatter_heat(exchange.sides(), &mut chi);
        let (through_contact, rubbed) = through(step, exchange);
        let mut rest = zeros(theta.len());
        // Of each block of the terms what is left of (4.2), at prescribed nodes the heat that has to be supplied there;
        // the largest entries, and the sums of the audit.
        let of_block = |first: usize, [mass_theta, d_theta]: [&[f64]; 2], rest: &mut [f64]| {
            let [bar, coupling, supply, chi] =
                [&products.mass_theta, coupling, &**supply, &chi].map(|v| &v[first..first + d_theta.len()]);
            let terms = [mass_theta, bar, d_theta, coupling, supply, chi];
            let largest = map_block(terms, rest, |[mass_theta, bar, d_theta, coupling, supply, chi]| {
                c / delta * (mass_theta - bar) + d_theta - coupling - supply + chi
            });
            (largest, sum_block([mass_theta, coupling, supply], |entries| entries))
        };
        let (made, blocks) = discrete.thermal_products_then(theta, &mut rest, of_block);
        let ([mass_theta, bar, d_theta, coupling, supply, _], sums) = over_blocks(&blocks);
        discrete.q.gather(&mut rest);
        let reactions = discrete.q.prescribed_of(&rest);
        discrete.q.mask(&mut rest);
        let storage = c / delta * mass_theta.max(bar);
        // A flux into a prescribed temperature may be of any size and is no term of an equation.
        let acting = coupling.max(supply).max(storage).max(discrete.q.largest_at(&step.boundary.nodes, &chi));
        let scale = acting.max(d_theta);
        let value = step.relative(max_abs(&rest), scale, "heat")?;
        [self.mass_theta, self.d_theta] = made;
        let residual = Residual { value, scale, acting, contact: 0.0 };
        Ok(Balance { residual, through_contact, reactions, rubbed, sums })
    }

    /// The solution, if its residual is accepted.
    fn found(
        self,
        step: &Step,
        exchange: Exchange,
        balance: Balance,
        [iterations, sweeps]: [usize; 2],
    ) -> Result<Heat, StepError> {
        let Begun { supply, coupling, theta, mass_theta, d_theta, .. } = self;
        let Step { discrete, rule: Rule { k, .. }, .. } = *step;
        let Balance { residual, through_contact, reactions, rubbed, sums } = balance;
        let scale = residual.scale;
        let residual = step.accept(residual, "heat", |of| match of {
            Rounded::Here => discrete.thermal_round_off(&theta),
            Rounded::Before => discrete.thermal_round_off(step.bar.theta),
            // No gap depends on it.
            Rounded::Places => 0.0,
            Rounded::Prescribed => {
                let mut prescribed = theta.clone();
                discrete.q.mask_free(&mut prescribed);
                discrete.thermal_round_off(&prescribed)
            }
        })?;
        let [stored, by_motion, sent] = sums;
        let amounts = Amounts {
            stored: step.rule.end([step.products.mass_theta.iter().sum(), stored]),
            supplied: k * (sent - discrete.convected(&theta)),
            coupling: k * by_motion,
            contact: k * through_contact,
            rubbed: k * rubbed,
            prescribed: -k * reactions.iter().sum::<f64>(),
        };
        Ok(Heat {
            theta,
            mass_theta,
            d_theta,
            supply,
            coupling,
            exchange,
            through_contact,
            reactions,
            iterations,
            sweeps,
            residual,
            scale,
            amounts,
        })
    }
}

/// How far (4.2) is from holding.
struct Balance {
    /// All terms but conduction act.
    residual: Residual,
    /// Heat that leaves through Γ_C, and what enters where the temperature is prescribed, W.
    through_contact: f64,
    reactions: Vec<f64>,
    /// Power of friction that enters both bodies of pairs, W.
    rubbed: f64,
    /// Of stored heat, coupling and supply.
    sums: [f64; 3],
}

/// Heat that leaves through foundations, and what friction makes at pairs, W.
fn through(step: &Step, exchange: &Exchange) -> (f64, f64) {
    let points = step.boundary.points.iter().zip(exchange.flux.iter().zip(&exchange.rubbed));
    points.fold((0.0, 0.0), |(out, made), (point, (flux, rubbed))| {
        if step.contacts[point.contact].pair.is_some() {
            (out, made + point.weight * rubbed)
        } else {
            (out + point.weight * flux.value, made)
        }
    })
}

impl Heat {
    /// Factorizes the symmetric part of the tangent of (4.2) as it is at the solution.
    pub fn renew(&self, step: &Step, half: &mut HalfStep) -> Result<(), SolveError> {
        half.replace(step.discrete.thermal_tangent(step.rule, &self.theta), &self.theta)
    }

    /// The derivative of χ in θ at the solution.
    pub fn contact_tangent(&self, step: &Step, half: &HalfStep, states: &[PointState]) -> Tangent {
        let given = Given::new(step, &self.theta);
        given
            .on_boundary(step, &half.on_contact, states)
            .map_or_else(Tangent::new, |on_boundary| on_boundary.tangent(&self.exchange))
    }
}

/// What is known on Γ_C before the half-step is solved.
struct Given {
    prescribed: Vec<f64>,
    foundation: Vec<f64>,
    lumped: Vec<Option<Lumped>>,
}

impl Given {
    fn new(step: &Step, theta: &[f64]) -> Given {
        let lumped = step.problem.contacts.iter().zip(&step.old.surface.foundation).map(|(contact, before)| {
            let (foundation, before) = (contact.foundation_heat.as_ref()?, (*before)?);
            let surroundings = foundation.surroundings.value(&[0.0; 3], step.level);
            Some(Lumped {
                storage: foundation.capacity / step.rule.delta,
                before,
                exchange: foundation.exchange,
                surroundings,
            })
        });
        Given {
            prescribed: step.boundary.restricted(1, theta),
            foundation: temperatures(step),
            lumped: lumped.collect(),
        }
    }

    /// The problem on Γ_C; none without contact.
    fn on_boundary<'a>(
        &'a self,
        step: &Step<'a>,
        unknown: &'a [Option<u32>],
        states: &'a [PointState],
    ) -> Option<HeatStep<'a>> {
        if step.problem.contacts.is_empty() {
            return None;
        }
        Some(HeatStep {
            contacts: step.contacts,
            boundary: step.boundary,
            unknown,
            theta_prescribed: &self.prescribed,
            foundation: &self.foundation,
            lumped: &self.lumped,
            states,
        })
    }
}
