//! The parameters, and the problems at values around theirs.

use super::error::GradientError;
use super::forms::FormSlopes;
use super::instance::{PhasedInstance, ProblemInstance, SolvedStep};
use super::stencil::STEP;
use crate::inclusion::Local;
use crate::problem::{Fault, Problem};
use crate::space::NodeFrame;

/// A number on which a problem depends.
pub struct Parameter<'a> {
    /// Its name, such as the key of a case.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// The problem at another value.
    pub problem: Box<dyn Fn(f64) -> Result<Problem, Fault> + 'a>,
}

/// Number of times that the step of a parameter is reduced, and by what.
const TRIES: i32 = 4;
const SHRINK: f64 = 64.0;
/// Change of a component of a direction that counts as round-off.
const SAME_AXES: f64 = 1e-12;
/// Decades that are tried for the scale of a parameter that is zero.
const DECADES: i32 = 13;

/// The problems at −2h, −h, h and 2h of a parameter.
pub(super) struct Variants {
    pub h: f64,
    pub all: [PhasedInstance; 4],
    /// The derivatives of the forms per phase, where the problems have the forms of the base.
    forms: Vec<Option<FormSlopes>>,
}

impl Variants {
    /// The derivatives of the equations of a step through the forms of the bodies; `None` where there is none, or where
    /// the problems have forms of their own.
    pub fn through_forms(&self, base: &ProblemInstance, of: &SolvedStep) -> [Option<Vec<f64>>; 2] {
        let phase = base.problem.timeline.instant(of.n).phase;
        self.forms.get(phase).and_then(Option::as_ref).map_or([None, None], |forms| forms.at(base, of))
    }
}

impl Parameter<'_> {
    /// The parameter of the problem whose step leads to the equilibrium at t = 0.
    pub(super) fn at_equilibrium(&self) -> Parameter<'_> {
        let problem = |value: f64| (self.problem)(value).map(|problem| problem.in_phase(0).at_equilibrium());
        Parameter { name: self.name.clone(), value: self.value, problem: Box::new(problem) }
    }

    /// The problems around the value at a step of the `shrunk`-th size. A parameter that is zero has the largest scale
    /// of the decades from 1 on that leaves all contact points of the last step on their branches.
    pub(super) fn variants(
        &self,
        base: &PhasedInstance,
        last: (&SolvedStep, &[Local]),
        shrunk: i32,
    ) -> Result<Variants, GradientError> {
        let scale = if self.value == 0.0 { self.scale_of_zero(base, last)? } else { self.value.abs() };
        let mut failed = None;
        for shrunk in shrunk..TRIES {
            match self.around(base, STEP * scale / SHRINK.powi(shrunk)) {
                Ok(variants) => return Ok(variants),
                Err(error) => failed.get_or_insert(error),
            };
        }
        Err(failed.unwrap_or_else(|| self.kink()))
    }

    /// The refusal of a parameter at which a law has a kink.
    pub(super) fn kink(&self) -> GradientError {
        let fault = Fault::new(
            self.name.clone(),
            format!("{}, at which data or laws have a kink", self.value),
            "a value at which the run is differentiable",
        );
        GradientError::refused(fault.hint("take differences to one side"))
    }

    fn around(&self, base: &PhasedInstance, h: f64) -> Result<Variants, GradientError> {
        let at = |j: f64| {
            let problem = (self.problem)(self.value + j * h).map_err(GradientError::refused)?;
            let instance = PhasedInstance::beside(&problem, base);
            self.compare(&base.first, &instance.first)?;
            base.all().zip(instance.all()).try_for_each(|(base, other)| self.compare(base, other))?;
            Ok::<PhasedInstance, GradientError>(instance)
        };
        let mut all = [at(-2.0)?, at(-1.0)?, at(1.0)?, at(2.0)?];
        let forms = FormSlopes::of_phases(base, h, &mut all);
        Ok(Variants { h, all, forms })
    }

    /// Checks that a problem has the steps, nodes and contact points of another one.
    fn compare(&self, base: &ProblemInstance, other: &ProblemInstance) -> Result<(), GradientError> {
        let counts = |of: &ProblemInstance| {
            let (problem, discrete) = (&of.problem, &of.discrete);
            [
                (problem.timeline.steps(), "steps"),
                (discrete.mesh.points.len(), "nodes"),
                (discrete.boundary.points.len(), "contact points"),
                (problem.contacts.len(), "contacts"),
                (discrete.branches.len(), "relaxation times"),
            ]
        };
        let changed = counts(base).into_iter().zip(counts(other)).find(|(a, b)| a.0 != b.0);
        let told = |found: String, expected: String| {
            let fault = Fault::new(self.name.clone(), found, expected);
            Err(GradientError::refused(fault.hint("leave it out of the parameters")))
        };
        if let Some(((count, what), (changed, _))) = changed {
            return told(
                format!("a key that changes the number of {what} from {count} to {changed}"),
                format!("a key on which the number of {what} does not depend"),
            );
        }
        if base.discrete.boundary.nodes != other.discrete.boundary.nodes {
            return told("a key that changes the nodes of contacts".into(), "a key of a value".into());
        }
        if base.problem.scheme != other.problem.scheme {
            return told("a key of the scheme in time".into(), "a key on which the scheme does not depend".into());
        }
        let [v, q] = [[&base.discrete.v, &other.discrete.v], [&base.discrete.q, &other.discrete.q]];
        if [v, q].iter().any(|[a, b]| a.free != b.free) {
            return told("a key that changes which values are prescribed".into(), "a key of a value".into());
        }
        let frames = base.discrete.v.frames.iter().zip(&other.discrete.v.frames);
        let turned = |(a, b): (&NodeFrame, &NodeFrame)| {
            let change = a.axes.as_flattened().iter().zip(b.axes.as_flattened()).map(|(a, b)| (a - b).abs());
            change.fold(0.0, f64::max)
        };
        if frames.map(turned).fold(0.0, f64::max) > SAME_AXES {
            let expected = "a key on which these directions do not depend";
            return told("a key that turns the directions of supports".into(), expected.into());
        }
        Ok(())
    }

    fn scale_of_zero(
        &self,
        base: &PhasedInstance,
        (last, forces): (&SolvedStep, &[Local]),
    ) -> Result<f64, GradientError> {
        let branches = |of: &PhasedInstance| -> Vec<[bool; 2]> {
            of.of(last.n).residual(last, forces, None).points.iter().map(|point| point.branch).collect()
        };
        let here = branches(base);
        let mut failed = None;
        for decade in 0..DECADES {
            let scale = 10f64.powi(0 - decade);
            match self.around(base, STEP * scale) {
                Ok(variants) if variants.all.iter().all(|variant| branches(variant) == here) => return Ok(scale),
                Ok(_) => {}
                Err(error) => failed = Some(error),
            }
        }
        // A contact point is on a kink; where it can be left, the sweep finds it.
        failed.map_or(Ok(10f64.powi(-DECADES / 2)), Err)
    }
}
