//! The derivatives of the forms of the bodies by a parameter.

use super::KINK;
use super::instance::{PhasedInstance, ProblemInstance, SolvedStep, deformation, driving, heated_by};
use super::stencil;
use crate::discretization::Discretization;
use crate::equation::system::Step;
use crate::linalg::BlockMatrix;
use crate::problem::Physics;

/// Kink of a form, relative to its derivative, up to which there is none.
const SMOOTH: f64 = 1e-3 * KINK;

/// The derivatives of ρM, A, B and the matrix of m, and of the heat capacity times M, D and the matrix of e, by a
/// parameter; `None` for forms that do not change. One product with a derivative takes the place of four with forms.
#[derive(Default)]
pub(super) struct FormSlopes {
    inertia: Option<BlockMatrix>,
    a: Option<BlockMatrix>,
    b: Option<BlockMatrix>,
    m: Option<BlockMatrix>,
    storage: Option<BlockMatrix>,
    d: Option<BlockMatrix>,
    e: Option<BlockMatrix>,
}

/// A form with the factor of its matrix, and a form of the boundary that is added to it.
type OfForm = fn(&Discretization) -> (f64, &BlockMatrix, Option<&BlockMatrix>);

impl FormSlopes {
    /// The derivatives of the forms of a problem by a parameter, from problems at −2h, −h, h and 2h, which then leave
    /// their forms to it; per phase, `None` where the residuals of the bodies themselves are needed.
    pub fn of_phases(base: &PhasedInstance, h: f64, around: &mut [PhasedInstance; 4]) -> Vec<Option<FormSlopes>> {
        let of = |(phase, here): (usize, &ProblemInstance)| {
            if here.problem.physics == Physics::Warmed {
                return None;
            }
            let around = around.each_ref().map(|of| &*of.in_phase(phase).discrete);
            FormSlopes::new(h, &here.discrete, around).ok()
        };
        let found: Vec<Option<FormSlopes>> = base.all().enumerate().map(of).collect();
        for (phase, _) in found.iter().enumerate().filter(|(_, slopes)| slopes.is_some()) {
            for own in around.iter_mut().filter_map(|variant| variant.in_phase_mut(phase)) {
                own.leave_forms(base.in_phase(phase));
            }
        }
        found
    }

    /// The derivatives at a step h of the parameter, of the forms of the problem and of those at −2h, −h, h and 2h.
    ///
    /// # Errors
    /// If the bodies are not of constant forms alone, or if a form has a kink.
    fn new(h: f64, here: &Discretization, around: [&Discretization; 4]) -> Result<FormSlopes, NoSlope> {
        let [a, b, c, d] = around;
        let all = [a, b, here, c, d];
        if !all.iter().all(|of| of.is_constant() && of.branches.is_empty()) {
            return Err(NoSlope);
        }
        let slope = |of: OfForm| slope_of(h, all, of);
        Ok(FormSlopes {
            inertia: slope(|of| (of.inertia().0, of.inertia().1, None))?,
            a: slope(|of| (1.0, &of.a, of.springs.as_ref()))?,
            b: slope(|of| (1.0, &of.b, of.dashpots.as_ref()))?,
            m: slope(|of| (1.0, &of.m, None))?,
            storage: slope(|of| (of.storage().0, of.storage().1, None))?,
            d: slope(|of| (1.0, &of.d, of.convection.as_ref()))?,
            e: slope(|of| (1.0, &of.e, None))?,
        })
    }

    /// The derivatives of (4.1) and (4.2) through the forms, at the unknowns of a step; `None` where there is none.
    pub fn at(&self, base: &ProblemInstance, of: &SolvedStep) -> [Option<Vec<f64>>; 2] {
        base.step(of.n, of.old, |step| [self.of_mechanics(step, of), self.of_heat(step, of)])
    }

    fn of_mechanics(&self, step: &Step, of: &SolvedStep) -> Option<Vec<f64>> {
        if !step.problem.physics.has_mechanics() {
            return None;
        }
        let (rule, w) = (step.rule, &of.at.w);
        let mut sum = None;
        if let Some(inertia) = self.inertia.as_ref().filter(|_| rule.inertia(1.0) > 0.0) {
            let change: Vec<f64> = w.iter().zip(step.bar.w).map(|(w, bar)| (w - bar) / rule.delta).collect();
            add(&mut sum, 1.0, inertia.apply(&change));
        }
        let mut take = |factor: f64, form: &Option<BlockMatrix>, of: &dyn Fn() -> Vec<f64>| {
            if let Some(form) = form {
                add(&mut sum, factor, form.apply(&of()));
            }
        };
        take(1.0, &self.a, &|| deformation(step, w));
        take(1.0, &self.b, &|| step.rates(w).into_owned());
        take(-1.0, &self.m, &|| driving(step, &of.at.theta));
        sum
    }

    fn of_heat(&self, step: &Step, of: &SolvedStep) -> Option<Vec<f64>> {
        if !step.problem.physics.has_heat() {
            return None;
        }
        let (delta, theta) = (step.rule.delta, &of.at.theta);
        let mut sum = None;
        if let Some(storage) = &self.storage {
            let change: Vec<f64> = theta.iter().zip(step.bar.theta).map(|(now, bar)| (now - bar) / delta).collect();
            add(&mut sum, 1.0, storage.apply(&change));
        }
        if let Some(d) = &self.d {
            add(&mut sum, 1.0, d.apply(theta));
        }
        if let Some(e) = &self.e {
            add(&mut sum, -1.0, e.apply(&heated_by(step, &of.at.w)));
        }
        sum
    }
}

fn add(sum: &mut Option<Vec<f64>>, factor: f64, of: Vec<f64>) {
    let sum = sum.get_or_insert_with(|| vec![0.0; of.len()]);
    sum.iter_mut().zip(of).for_each(|(sum, of)| *sum += factor * of);
}

/// The forms of a problem have no derivatives of their own.
struct NoSlope;

/// The derivative of a form; `None` if it does not change. What is added at the boundary is
/// differentiated apart, beside which the form of the body may be large.
fn slope_of(h: f64, all: [&Discretization; 5], of: OfForm) -> Result<Option<BlockMatrix>, NoSlope> {
    let forms = all.map(of);
    let body = slope(h, forms.map(|(factor, form, _)| Some((factor, form))))?;
    let boundary = slope(h, forms.map(|(_, _, boundary)| boundary.map(|form| (1.0, form))))?;
    Ok(match (body, boundary) {
        (Some(mut body), Some(boundary)) => {
            body.add_scaled(1.0, &boundary);
            Some(body)
        }
        (body, boundary) => body.or(boundary),
    })
}

fn slope(h: f64, forms: [Option<(f64, &BlockMatrix)>; 5]) -> Result<Option<BlockMatrix>, NoSlope> {
    let [a, b, here, c, d] = forms;
    let (Some((scale, at)), Some(a), Some(b), Some(c), Some(d)) = (here, a, b, c, d) else {
        return if forms.iter().all(Option::is_none) { Ok(None) } else { Err(NoSlope) };
    };
    let same = |(factor, form): &(f64, &BlockMatrix)| factor.to_bits() == scale.to_bits() && form.is_same(at);
    if [a, b, c, d].iter().all(same) {
        return Ok(None);
    }
    let sum = |terms: [(f64, (f64, &BlockMatrix)); 4], of_here: f64| {
        let mut sum = at.scaled(of_here * scale / h);
        for (weight, (factor, form)) in terms {
            sum.add_scaled(weight * factor / h, form);
        }
        sum
    };
    let slope = sum([(-2.0 / 3.0, b), (2.0 / 3.0, c), (1.0 / 12.0, a), (-1.0 / 12.0, d)], 0.0);
    let kink = sum([(2.0, b), (2.0, c), (-0.5, a), (-0.5, d)], -3.0);
    let least = SMOOTH * slope.largest() + stencil::OF_LISTS * f64::EPSILON * (scale * at.largest() / h).abs();
    if kink.largest() <= least { Ok(Some(slope)) } else { Err(NoSlope) }
}
