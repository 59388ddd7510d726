//! The equations of the contacts that a force drives, beside those of the mechanical half-step.
//!
//! With x the unknowns of the half-step, a the lengths δ at its end, and R the equations of the half-step, the lengths
//! are eliminated by one solution per driven contact:
//!
//! ```text
//!     J dx + R_a da = r,   E_x dx + E_a da = s,        E = m δ̈ − Σ ω (p ν + q)·d − F
//! ```

use faer::Mat;
use faer::linalg::solvers::Solve;

use super::balances::bound;
use super::bordered::Pushed;
use super::factors::StepFactors;
use super::instance::{ProblemInstance, SolvedStep};
use super::points::LinearPoint;
use super::transpose::Transposed;
use crate::equation::system::Step;
use crate::inclusion::{Drive, Local};
use crate::linalg::{SolveError, dot, zeros};
use crate::tensor::{Point, dot as inner};

/// A driven contact in a step, linearised.
pub(super) struct LinearDrive {
    pub contact: usize,
    /// The derivative of E by δ.
    own: f64,
    /// m/k² and m/k.
    pub inertia: [f64; 2],
    /// d in the basis of each contact point; zero at those of other contacts.
    along: Vec<Local>,
}

/// The driven contacts of a step with the change of the other unknowns by each δ, or by each E in the transposed
/// equations.
pub(super) struct DrivenStep<T> {
    pub drives: Vec<LinearDrive>,
    solutions: Vec<T>,
    /// E_a − E_x J⁻¹ R_a, or its transposed.
    matrix: Mat<f64>,
}

/// True if something is asked of a driven contact. One that nothing presses, accelerates or touches stays where it is.
fn is_asked(drive: &Drive, of: &SolvedStep, step: &Step) -> bool {
    let own = step.boundary.points.iter().zip(of.states).filter(|(point, _)| point.contact == drive.contact);
    let mut tractions = own.map(|(_, state)| state.pressure.abs().max(bound(state.bound)));
    drive.force.abs() > 0.0 || drive.inertia[1] > 0.0 || tractions.any(|traction| traction > 0.0)
}

/// The driven contacts of a step.
fn drives(step: &Step, of: &SolvedStep, points: &[LinearPoint]) -> Vec<LinearDrive> {
    let made = |drive: Drive| {
        let direction = |point: &LinearPoint| drive.direction.unwrap_or(point.basis[0]);
        let is_own = |point: &LinearPoint| point.contact == drive.contact;
        let along = |point: &LinearPoint| -> Local {
            if is_own(point) { point.basis.map(|axis| inner(&axis, &direction(point))) } else { [0.0; 3] }
        };
        let weights = step.boundary.points.iter().map(|point| point.weight);
        // Along ν itself the force turns with it.
        let turned = |(point, weight): (&LinearPoint, f64)| {
            drive.direction.map_or(0.0, |d| weight * inner(&point.advance.turned(&point.force), &d))
        };
        let own = points.iter().zip(weights).filter(|(point, _)| is_own(point)).map(turned).sum::<f64>();
        let [_, rate] = drive.inertia;
        LinearDrive {
            contact: drive.contact,
            own: rate - own,
            inertia: [rate, rate * step.rule.k],
            along: points.iter().map(along).collect(),
        }
    };
    if !step.problem.physics.has_mechanics() {
        return Vec::new();
    }
    let all = step.drives(&of.at.surface.advance).into_iter();
    all.filter(|drive| is_asked(drive, of, step)).map(made).collect()
}

impl LinearDrive {
    /// The change of E with that of the forces at the points.
    fn by_forces(&self, step: &Step, forces: &[Local]) -> f64 {
        let all = step.boundary.points.iter().zip(self.along.iter().zip(forces));
        all.map(|(point, (along, force))| 0.0 - point.weight * inner(along, force)).sum()
    }
}

/// The forces on the degrees of freedom with δ of a contact, whose points turn.
pub(super) fn turned(step: &Step, points: &[LinearPoint], contact: usize) -> Vec<f64> {
    let of = |point: &LinearPoint| -> Point {
        if point.contact != contact {
            return [0.0; 3];
        }
        let [p, q1, q2] = point.force;
        point.advance.turned(&[p + point.fluid, q1, q2])
    };
    let mut sum = zeros(step.discrete.v.free.len());
    step.boundary.scatter(step.discrete.v.components, points.iter().map(of), &mut sum);
    sum
}

/// The change of the defects of the points with δ of a contact.
fn defects(points: &[LinearPoint], contact: usize) -> Vec<Local> {
    let of = |point: &LinearPoint| -> Local {
        if point.contact != contact {
            return [0.0; 3];
        }
        let [a, b, c, ..] = point.forth(&point.advance.at_end());
        [a, b, c]
    };
    points.iter().map(of).collect()
}

impl DrivenStep<Transposed> {
    /// The driven contacts of a step for the transposed equations.
    pub fn back(
        factors: &mut StepFactors,
        base: &ProblemInstance,
        of: &SolvedStep,
        points: &[LinearPoint],
    ) -> Result<DrivenStep<Transposed>, SolveError> {
        let drives = base.step(of.n, of.old, |step| drives(step, of, points));
        let mut solutions = Vec::with_capacity(drives.len());
        for drive in &drives {
            let force: Vec<Local> = drive.along.iter().map(|along| along.map(|d| 0.0 - d)).collect();
            let none = zeros(base.discrete.v.free.len());
            solutions.push(factors.mechanics(base, of, points, (&none, &force))?);
        }
        let mut matrix = Mat::zeros(drives.len(), drives.len());
        for (j, solution) in solutions.iter().enumerate() {
            let through = base.step(of.n, of.old, |step| through(step, points, (&drives, solution)));
            for (i, through) in through.into_iter().enumerate() {
                matrix[(i, j)] = if i == j { drives[i].own } else { 0.0 } - through;
            }
        }
        Ok(DrivenStep { drives, solutions, matrix })
    }

    /// Adds the part of the multipliers of E, one per drive, to a solution without them; `weights` are those of δ at
    /// the end of the step. Returns these multipliers.
    pub fn add(&self, step: &Step, points: &[LinearPoint], weights: &[f64], to: &mut Transposed) -> Vec<f64> {
        if self.drives.is_empty() {
            return Vec::new();
        }
        let known = through(step, points, (&self.drives, to));
        let right: Vec<f64> =
            self.drives.iter().zip(known).map(|(drive, known)| weights[drive.contact] - known).collect();
        let found = self.solved(&right);
        for (eta, solution) in found.iter().zip(&self.solutions) {
            subtract(*eta, &solution.y, &mut to.y);
            subtract(*eta, &solution.prescribed, &mut to.prescribed);
            subtract(*eta, solution.points.as_flattened(), to.points.as_flattened_mut());
        }
        found
    }
}

/// R_aᵀ times multipliers of the half-step, per drive.
fn through(step: &Step, points: &[LinearPoint], (drives, of): (&[LinearDrive], &Transposed)) -> Vec<f64> {
    let by_drive = |drive: &LinearDrive| {
        let at_points = step.boundary.points.iter().zip(defects(points, drive.contact).into_iter().zip(&of.points));
        let at_points: f64 = at_points.map(|(point, (by, mu))| point.weight * inner(&by, mu)).sum();
        dot(&turned(step, points, drive.contact), &of.y) + at_points
    };
    drives.iter().map(by_drive).collect()
}

/// The changes of the velocities and of the forces at the points.
pub(super) type Shifted = (Vec<f64>, Vec<Local>);

impl DrivenStep<Shifted> {
    /// The driven contacts of a step for the equations themselves.
    pub fn forth(
        factors: &mut StepFactors,
        base: &ProblemInstance,
        of: &SolvedStep,
        points: &[LinearPoint],
    ) -> Result<DrivenStep<Shifted>, SolveError> {
        let drives = base.step(of.n, of.old, |step| drives(step, of, points));
        let mut solutions = Vec::with_capacity(drives.len());
        for drive in &drives {
            let right = base.step(of.n, of.old, |step| turned(step, points, drive.contact));
            let (defects, held) = (defects(points, drive.contact), zeros(right.len()));
            solutions.push(factors.moved(base, of, points, &Pushed { right, defects, held })?);
        }
        let mut matrix = Mat::zeros(drives.len(), drives.len());
        for (j, (_, forces)) in solutions.iter().enumerate() {
            for (i, drive) in drives.iter().enumerate() {
                let by_forces = base.step(of.n, of.old, |step| drive.by_forces(step, forces));
                matrix[(i, j)] = if i == j { drive.own } else { 0.0 } - by_forces;
            }
        }
        Ok(DrivenStep { drives, solutions, matrix })
    }

    /// Adds the part of the changes of δ to a solution without them; `right` are the right-hand sides of E, one per
    /// drive. Returns the changes.
    pub fn add(&self, step: &Step, right: &[f64], (w, forces): (&mut [f64], &mut [Local])) -> Vec<f64> {
        if self.drives.is_empty() {
            return Vec::new();
        }
        let right: Vec<f64> =
            self.drives.iter().zip(right).map(|(drive, right)| right - drive.by_forces(step, forces)).collect();
        let found = self.solved(&right);
        for (change, (of_w, of_forces)) in found.iter().zip(&self.solutions) {
            subtract(*change, of_w, w);
            subtract(*change, of_forces.as_flattened(), forces.as_flattened_mut());
        }
        found
    }
}

impl<T> DrivenStep<T> {
    fn solved(&self, right: &[f64]) -> Vec<f64> {
        let right = Mat::from_fn(right.len(), 1, |i, _| right[i]);
        let found = self.matrix.partial_piv_lu().solve(&right);
        (0..found.nrows()).map(|i| found[(i, 0)]).collect()
    }
}

fn subtract(factor: f64, from: &[f64], to: &mut [f64]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to -= factor * from);
}
