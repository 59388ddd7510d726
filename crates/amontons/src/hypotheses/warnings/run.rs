//! Warnings at the end of a run.

use super::super::laws::at;
use super::super::{Finding, FindingId};
use super::warning;
use crate::problem::Problem;
use crate::tensor::Point;
use crate::units::Measure;

/// Strain above which a theory of small strains is off by more than it: 5 %.
const STRAIN: f64 = 0.05;
/// Share of the range of temperatures by which they may leave that of the data.
const RANGE: f64 = 0.01;
/// Penetration beside the height of a cell on Γ_C above which a foundation has given way.
const PENETRATION: f64 = 0.1;

/// What a run came to, to be judged.
#[derive(Clone, Debug)]
pub struct Figures {
    /// Largest principal strain in magnitude at the last step, and where.
    pub strain: f64,
    /// Where it is.
    pub strain_at: Point,
    /// Least and largest nodal temperature since the start, K.
    pub temperature: [f64; 2],
    /// By how much these are below and above all that the data allow, K; none where sources and sinks allow any.
    pub outside: [Option<f64>; 2],
    /// Largest penetration beside the cells of its side at the last step; none without contact.
    pub penetration: Option<Penetration>,
    /// The rigid motions that nothing determines in the last step, in words.
    pub loose: Vec<String>,
}

/// A penetration beside the cells of the side.
#[derive(Clone, Copy, Debug)]
pub struct Penetration {
    /// Which of the contacts of the problem.
    pub side: usize,
    /// Largest penetration, m.
    pub depth: f64,
    /// Least height of a cell on the side, m.
    pub cell: f64,
}

/// The warnings that a run gives cause for.
#[must_use]
pub fn of_run(problem: &Problem, figures: &Figures) -> Vec<Finding> {
    let parts = [
        strain(figures),
        temperature_range(problem, figures),
        absolute_zero(problem, figures),
        penetration(problem, figures),
        undetermined(problem, figures),
    ];
    parts.into_iter().flatten().collect()
}

fn strain(figures: &Figures) -> Option<Finding> {
    let strain = figures.strain;
    if strain <= STRAIN {
        return None;
    }
    let message = format!(
        "the largest principal strain is {:.3} % at {}: small-strain theory neglects terms of its square, so that the stress has a relative error of about this size",
        100.0 * strain,
        at(&figures.strain_at)
    );
    let repair = "reduce loads or prescribed displacements, or check the units of material.elasticity";
    Some(warning(FindingId::Strain, "material.elasticity", [strain, STRAIN], message, repair))
}

fn temperature_range(problem: &Problem, figures: &Figures) -> Option<Finding> {
    let [low, high] = figures.temperature;
    let sides = [(figures.outside[0], "below", low), (figures.outside[1], "above", high)];
    let (by, which, extreme) = sides
        .into_iter()
        .filter_map(|(by, which, extreme)| Some((by?, which, extreme)))
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    let (range, units) = (high - low, problem.units());
    if by <= RANGE * range {
        return None;
    }
    let message = format!(
        "a temperature of {} is {} {which} all values that the data allow: the step of {} is short for the size of the cells next to a \
         sudden change, and the consistent mass matrix undershoots there",
        units.write(extreme, Measure::Temperature),
        units.write(by, Measure::TemperatureDifference),
        units.write(problem.k(), Measure::Time)
    );
    let repair = format!(
        "use finer cells where heat enters suddenly, h ≤ √(6 k K/c){}, or longer steps, or data that change gradually",
        problem.materials.first().map_or_else(String::new, |m| {
            // Of coefficients that vary, those of a node say how long the layer is.
            let x = problem.mesh.points.first().copied().unwrap_or_default();
            let (capacity, conductivity) = (m.heat_capacity.at(&x), m.conductivity.at(&x));
            let conductivity = conductivity.eigenvalues(problem.mesh.dim).first().copied().unwrap_or(0.0).max(0.0);
            if capacity <= 0.0 {
                return String::new();
            }
            format!(" = {}", units.write((6.0 * problem.k() * conductivity / capacity).sqrt(), Measure::Length))
        })
    );
    Some(warning(FindingId::TemperatureRange, "time.steps", [by, RANGE * range], message, repair))
}

fn absolute_zero(problem: &Problem, figures: &Figures) -> Option<Finding> {
    let (side, zero) =
        problem.contacts.iter().enumerate().find_map(|(side, c)| Some((side, c.heat.absolute_zero()?)))?;
    let low = figures.temperature[0];
    if low >= zero {
        return None;
    }
    let message =
        format!("a temperature of {low:.6e} is below absolute_zero = {zero:?}: the body does not radiate there");
    let repair = "correct absolute_zero, heat sources and the units of the heat data; see the warning temperature-range if there is one";
    Some(warning(
        FindingId::AbsoluteZero,
        &format!("{}.heat.absolute_zero", problem.contact_path(side)),
        [low, zero],
        message,
        repair,
    ))
}

/// Motions that nothing determines: they are the least, and another mesh may give others.
fn undetermined(problem: &Problem, figures: &Figures) -> Option<Finding> {
    let [first, rest @ ..] = figures.loose.as_slice() else { return None };
    let motions = rest.iter().fold(first.clone(), |told, motion| format!("{told}; {motion}"));
    let message = format!(
        "nothing determines in the last step whether {motions}: no support, no closed contact and no friction resists it, and no load acts along it; of all such \
         motions the results have the least"
    );
    let place = problem.contacts.iter().enumerate().map(|(side, _)| problem.contact_path(side)).next();
    let repair = "hold the motion by `displacement` or `normal_displacement` on a side or at a point (`at`), which then bears nothing, if its size matters";
    let place = place.unwrap_or_else(|| "contact".to_owned());
    Some(warning(FindingId::Undetermined, &place, [figures.loose.len() as f64, 0.0], message, repair))
}

fn penetration(problem: &Problem, figures: &Figures) -> Option<Finding> {
    let Penetration { side, depth, cell } = figures.penetration?;
    if depth <= PENETRATION * cell {
        return None;
    }
    let message = format!(
        "the body penetrates the foundation by {}, {:.3} of the height of the lowest cell on Γ_C: the foundation is soft compared with the body",
        problem.units().write(depth, Measure::Length),
        depth / cell
    );
    let place = format!("{}.normal", problem.contact_path(side));
    Some(warning(
        FindingId::Penetration,
        &place,
        [depth, PENETRATION * cell],
        message,
        "use a stiffer foundation, or law = \"signorini\" for a rigid one",
    ))
}
