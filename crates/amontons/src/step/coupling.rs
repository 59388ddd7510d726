//! Coupling of the half-steps of one step: [`Coupling`].
//!
//! One *pass* solves (4.1) with a given temperature in m and (4.2) with a given displacement in e. The staggered scheme
//! is one pass with θ_{n−1} and u_{n−1}, the extrapolated one a pass with the temperature of the steps before,
//! continued to the time of the equations, and the displacement found with it. The map of (u, θ) to the solution of
//! both half-steps is the operator Φ of (3.10), taken within a step: iterating it is the fixed-point coupling, and a
//! root of Φ(θ) − θ by Newton's method, with the mechanical half-step eliminated exactly, is the monolithic one. Both
//! end where (4.1) and (4.2) hold with θ_n in m and u_n in e.

use super::linearised::Linearised;
use crate::equation::heat::{self, Heat};
use crate::equation::mechanics::{Beside, Mechanics};
use crate::equation::system::{ACCEPTED, HalfStep, Step, difference};
use crate::equation::{StepError, tried};
use crate::inclusion::PointState;
use crate::linalg::{dot, gmres, max_abs};
use crate::problem::Coupling;
use crate::space::Space;
use crate::state::{Contraction, CouplingReport};

/// Defect of the coupling, relative to the largest term of the equations, at which the coupling iteration ends.
const COUPLED: f64 = 1e-12;
/// Smallest defect whose ratio to another one is a contraction factor and not round-off.
const TELLING: f64 = 1e-9;
/// Passes without progress after which the coupling has failed, and after which Newton's method is treated as cycling.
const WITHOUT_PROGRESS: usize = 60;
const CIRCLING: usize = 6;
/// Shortest fraction of a Newton step of the monolithic coupling that is tried.
const SHORTEST_STEP: f64 = 1.0 / 1024.0;
/// Residual, relative to the initial one, at which the linear systems of the monolithic coupling count as solved.
const LINEAR: f64 = 1e-10;
/// Most matrix products per system: the matrix is the identity plus a compact operator, so a few products suffice.
const PRODUCTS: usize = 200;

/// A completed step.
pub(crate) struct Made {
    pub mechanics: Mechanics,
    pub heat: Heat,
    pub report: CouplingReport,
    /// Newton iterations of mechanics and heat, and sweeps, of all passes.
    pub iterations: [usize; 2],
    pub sweeps: usize,
}

/// Both half-steps, solved.
struct Pass {
    mechanics: Mechanics,
    heat: Heat,
}

/// The systems of both half-steps, and the work done with them.
pub(crate) struct Coupled<'a> {
    pub step: Step<'a>,
    pub mechanics: &'a mut HalfStep,
    pub heat: &'a mut HalfStep,
    passes: usize,
    iterations: [usize; 2],
    sweeps: usize,
}

impl<'a> Coupled<'a> {
    pub fn new(step: &Step<'a>, mechanics: &'a mut HalfStep, heat: &'a mut HalfStep) -> Coupled<'a> {
        Coupled { step: *step, mechanics, heat, passes: 0, iterations: [0; 2], sweeps: 0 }
    }

    /// Makes the step.
    pub fn solve(mut self) -> Result<Made, StepError> {
        let coupling = self.step.coupling();
        let (pass, defect, progress) = match coupling {
            Coupling::Staggered => {
                let pass = self.pass(&self.step.old.theta, self.step.old.deformation(), None)?;
                return Ok(self.made_once(pass));
            }
            Coupling::Extrapolated => {
                let pass = self.pass_in_turn(&self.step.extrapolated(), None)?;
                return Ok(self.made_once(pass));
            }
            Coupling::FixedPoint => self.fixed_point()?,
            Coupling::Monolithic => self.monolithic()?,
        };
        let contraction = if coupling == Coupling::FixedPoint { progress.contraction() } else { None };
        let report = CouplingReport { passes: self.passes, contraction, defect: Some(defect) };
        Ok(self.made(pass, report))
    }

    fn made_once(&self, pass: Pass) -> Made {
        self.made(pass, CouplingReport { passes: self.passes, ..CouplingReport::default() })
    }

    fn made(&self, pass: Pass, report: CouplingReport) -> Made {
        Made { mechanics: pass.mechanics, heat: pass.heat, report, iterations: self.iterations, sweeps: self.sweeps }
    }

    fn count(&mut self, pass: Pass) -> Pass {
        self.passes += 1;
        self.iterations[0] += pass.mechanics.iterations;
        self.iterations[1] += pass.heat.iterations;
        self.sweeps += pass.mechanics.sweeps + pass.heat.sweeps;
        pass
    }

    /// Φ: solves (4.1) with `theta` in m in parallel with (4.2) with `u` in e, from the start of the step or an earlier
    /// pass.
    fn pass(&mut self, theta: &[f64], u: &[f64], from: Option<&Pass>) -> Result<Pass, StepError> {
        let step = &self.step;
        let half = &mut *self.heat;
        let mut beside = HeatBeside { step, half, u, from: from.map(|from| &from.heat), begun: None, made: None };
        let mechanics = Mechanics::solve(step, self.mechanics, theta, from.map(|from| &from.mechanics), &mut beside)?;
        let heat = beside.end(&mechanics.end.states)?;
        Ok(self.count(Pass { mechanics, heat }))
    }

    /// Maps θ to the temperature of (4.2) at the displacement that solves (4.1) with θ.
    fn pass_in_turn(&mut self, theta: &[f64], from: Option<&Pass>) -> Result<Pass, StepError> {
        let mechanics = Mechanics::solve(&self.step, self.mechanics, theta, from.map(|from| &from.mechanics), &mut ())?;
        let begun = heat::Begun::new(&self.step, self.heat, mechanics.deformed(), from.map(|from| &from.heat))?;
        let heat = begun.solve(&self.step, self.heat, &mechanics.end.states)?;
        Ok(self.count(Pass { mechanics, heat }))
    }

    /// Defect of (4.1) with θ_n in m and in the contact laws, and of (4.2) with u_n in e, relative to their largest
    /// terms.
    fn defect(&self, pass: &Pass) -> Result<f64, StepError> {
        let Step { discrete, .. } = self.step;
        let change = |new: Vec<f64>, old: &[f64], space: &Space| {
            let mut change: Vec<f64> = new.iter().zip(old).map(|(new, old)| new - old).collect();
            space.gather(&mut change);
            space.mask(&mut change);
            max_abs(&change)
        };
        let Pass { mechanics, heat } = pass;
        let on_contact = heat.exchange.temperatures_on(self.step.contacts, self.step.boundary);
        let contact = mechanics.contact_change(&self.step, self.mechanics, &on_contact);
        let mut force = difference(&discrete.thermal_force(&heat.theta), &contact);
        if discrete.softens() {
            let a_u = discrete.apply_a(mechanics.u(), &heat.theta);
            let b_w = discrete.apply_b(&self.step.rates(mechanics.w()), &heat.theta);
            let terms = [(a_u, &mechanics.end.at.a_u), (b_w, &mechanics.end.at.b_w)];
            for (then, now) in terms {
                force.iter_mut().zip(difference(&then, now)).for_each(|(force, change)| *force -= change);
            }
        }
        let force = change(force, &pass.mechanics.thermal, &discrete.v);
        let supply = change(discrete.e.apply(pass.mechanics.deformed()), &pass.heat.coupling, &discrete.q);
        let force = self.step.relative(force, pass.mechanics.end.residual.scale, "mechanics")?;
        Ok(force.max(self.step.relative(supply, pass.heat.scale, "heat")?))
    }

    fn failed(&self, defect: f64, contraction: Option<Contraction>) -> StepError {
        let (step, t, passes) = (self.step.n, self.step.t, self.passes);
        if self.step.rule.is_steady() {
            return StepError::NotSteady { step, t, passes, defect };
        }
        StepError::Coupling { step, t, coupling: self.step.coupling(), passes, defect, contraction }
    }

    /// Iterates Φ until its arguments equal its values.
    fn fixed_point(&mut self) -> Result<(Pass, f64, Progress), StepError> {
        let mut pass = self.pass(&self.step.old.theta, self.step.old.deformation(), None)?;
        let mut progress = Progress::default();
        loop {
            let defect = self.defect(&pass)?;
            match progress.after(defect) {
                Verdict::Coupled => return Ok((pass, defect, progress)),
                Verdict::Failed => return Err(self.failed(defect, progress.contraction())),
                Verdict::GoOn => {}
            }
            pass = self.pass(&pass.heat.theta, pass.mechanics.deformed(), Some(&pass))?;
        }
    }

    /// Applies Newton's method to Φ(θ) − θ = 0, with the mechanical half-step eliminated.
    fn monolithic(&mut self) -> Result<(Pass, f64, Progress), StepError> {
        let start = self.step.old.theta.clone();
        let mut now = Iterate::new(self.pass_in_turn(&start, None)?, start);
        let mut progress = Progress::default();
        loop {
            let defect = self.defect(&now.pass)?;
            match progress.after(defect) {
                Verdict::Coupled => return Ok((now.pass, defect, progress)),
                Verdict::Failed => return Err(self.failed(defect, None)),
                Verdict::GoOn => {}
            }
            // If Newton's method cycles around a kink, some passes of the fixed-point coupling lead out of the cycle.
            let circling = progress.without() / CIRCLING % 2 == 1;
            let next = if circling { None } else { self.newton(&now)? };
            now = match next {
                Some(next) => next,
                None => self.iterate(now.pass.heat.theta.clone(), &now.pass)?,
            };
        }
    }

    /// The iterate with the temperature `theta` in m.
    fn iterate(&mut self, theta: Vec<f64>, from: &Pass) -> Result<Iterate, StepError> {
        Ok(Iterate::new(self.pass_in_turn(&theta, Some(from))?, theta))
    }

    /// Returns the first candidate that reduces the residual: the full Newton step, a pass of the fixed-point coupling,
    /// ever shorter fractions of the Newton step. Returns `None` if no candidate does or no direction is found; the
    /// fixed-point passes then continue.
    fn newton(&mut self, now: &Iterate) -> Result<Option<Iterate>, StepError> {
        let Some(change) = self.direction(now)? else { return Ok(None) };
        let part = |alpha: f64| {
            now.theta.iter().zip(&change).map(|(theta, change)| theta + alpha * change).collect::<Vec<f64>>()
        };
        let shorter = std::iter::successors(Some(0.5), |alpha| Some(0.5 * alpha));
        let shorter = shorter.take_while(|&alpha| alpha >= SHORTEST_STEP).map(part);
        for theta in [part(1.0), now.pass.heat.theta.clone()].into_iter().chain(shorter) {
            let next = tried(self.iterate(theta, &now.pass))?;
            if let Some(next) = next.filter(|next| next.merit < now.merit) {
                return Ok(Some(next));
            }
        }
        Ok(None)
    }

    /// The Newton step of the temperature, or `None` if its systems cannot be solved.
    fn direction(&mut self, now: &Iterate) -> Result<Option<Vec<f64>>, StepError> {
        let most = now.residual.len().min(PRODUCTS);
        let Pass { mechanics, heat } = &now.pass;
        let tangent = Linearised::new(&self.step, [self.mechanics, self.heat], mechanics, heat);
        let found = tangent.and_then(|tangent| {
            let right = tangent.right(self.heat, &now.residual)?;
            let product = |change: &[f64]| {
                let product = tangent.apply(&self.step, [self.mechanics, self.heat], change)?;
                self.sweeps += 4;
                Ok(product)
            };
            gmres(product, &right, LINEAR, most)
        });
        let (step, t) = (self.step.n, self.step.t);
        tried(found.map(|found| found.x).map_err(|source| StepError::Linear { step, t, part: "the coupling", source }))
    }
}

/// The heat half-step, run in parallel with the mechanical one, from which it needs only the contact on Γ_C.
struct HeatBeside<'a> {
    step: &'a Step<'a>,
    half: &'a mut HalfStep,
    u: &'a [f64],
    from: Option<&'a Heat>,
    begun: Option<Result<heat::Begun, StepError>>,
    made: Option<Result<Heat, StepError>>,
}

impl HeatBeside<'_> {
    fn begin(&self) -> Result<heat::Begun, StepError> {
        heat::Begun::new(self.step, self.half, self.u, self.from)
    }

    fn solve(&mut self, states: &[PointState]) -> Result<Heat, StepError> {
        let begun = self.begun.take().unwrap_or_else(|| self.begin())?;
        begun.solve(self.step, self.half, states)
    }

    /// The heat half-step at the contact of the solution, which is the contact passed in last.
    fn end(mut self, states: &[PointState]) -> Result<Heat, StepError> {
        self.made.take().unwrap_or_else(|| self.solve(states))
    }
}

impl Beside for HeatBeside<'_> {
    /// The forward sweep.
    fn with_contact(&mut self) {
        if self.begun.is_none() {
            self.begun = Some(self.begin());
        }
    }

    fn with_rest(&mut self, states: &[PointState]) {
        self.made = Some(self.solve(states));
    }
}

/// An iterate of the monolithic coupling.
struct Iterate {
    /// The temperature in m.
    theta: Vec<f64>,
    pass: Pass,
    /// Φ(θ) − θ, and its square.
    residual: Vec<f64>,
    merit: f64,
}

impl Iterate {
    fn new(pass: Pass, theta: Vec<f64>) -> Iterate {
        let residual = difference(&pass.heat.theta, &theta);
        Iterate { merit: dot(&residual, &residual), residual, pass, theta }
    }
}

/// Progress of the coupling iteration.
#[derive(Default)]
struct Progress {
    /// The defect after each pass.
    defects: Vec<f64>,
    /// Index of the least defect.
    least: usize,
}

enum Verdict {
    GoOn,
    Coupled,
    Failed,
}

impl Progress {
    fn after(&mut self, defect: f64) -> Verdict {
        // Round-off may keep the defect from decreasing further.
        let stalled = defect <= ACCEPTED && self.defects.last().is_some_and(|last| defect > 0.5 * last);
        if self.defects.get(self.least).is_none_or(|&least| defect < least) {
            self.least = self.defects.len();
        }
        self.defects.push(defect);
        if defect <= COUPLED || stalled {
            Verdict::Coupled
        } else if self.without() > WITHOUT_PROGRESS {
            Verdict::Failed
        } else {
            Verdict::GoOn
        }
    }

    /// Passes since the least defect.
    fn without(&self) -> usize {
        self.defects.len() - 1 - self.least
    }

    /// The observed contraction factors: mean and largest ratio of two consecutive defects above round-off.
    fn contraction(&self) -> Option<Contraction> {
        let telling: Vec<f64> = self.defects.iter().copied().take_while(|&defect| defect > TELLING).collect();
        let (first, last, ratios) =
            (telling.first()?, telling.last()?, telling.len().checked_sub(1).filter(|&n| n > 0)?);
        let largest = telling.windows(2).map(|pair| pair[1] / pair[0]).fold(0.0, f64::max);
        Some(Contraction { mean: (last / first).powf(1.0 / ratios as f64), largest })
    }
}
