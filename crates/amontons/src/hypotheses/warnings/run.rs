//! Warnings at the end of a run.

use super::super::sample::at;
use super::super::{Finding, FindingId};
use super::{begins, warning};
use crate::contact::Leak;
use crate::linalg::PATTERNS;
use crate::problem::{Misfit, Problem};
use crate::tensor::Point;
use crate::time::Analysis;
use crate::units::Measure;

/// Strain above which the error of small-strain theory exceeds the same fraction: 5 %.
const STRAIN: f64 = 0.05;
/// Fraction of the range of temperatures by which they may leave that of the data.
const RANGE: f64 = 0.01;
/// Penetration relative to the cell height on Γ_C above which a foundation has given way.
const PENETRATION: f64 = 0.1;

/// Number of points bearing a contact below which its pressures are hardly resolved.
const POINTS: usize = 4;
/// Fraction of the energy that the scheme may dissipate in a motion.
const SCHEME: f64 = 0.02;
/// Fraction of all steps that reverse the velocity, and their least number, above which the velocity alternates.
const ALTERNATES: f64 = 0.25;
const REVERSALS: usize = 4;
/// Fraction of the energy turned over above which kinetic energy counts.
const MOVES: f64 = 0.01;
/// Ratio of the largest nodal von Mises stress to that in a cell above which neither is resolved.
const APART: f64 = 1.5;
/// Stress, relative to that of the strain, below which it is round-off, as in a freely expanding body.
const ROUND_OFF: f64 = 1e-9;
/// Ratio of the contact systems of a step to the predicted number above which the prediction of the time is off.
const OFF: f64 = 10.0;
/// Operations of contact systems, about half a minute, below which the warning is omitted.
const COSTLY: f64 = 1e12;

/// Results of a run on which warnings are based.
#[derive(Clone, Debug)]
pub struct Figures {
    /// Largest principal strain in magnitude at the last step.
    pub strain: f64,
    /// Position of the largest strain, m.
    pub strain_at: Point,
    /// Least and largest nodal temperature since the start, K.
    pub temperature: [f64; 2],
    /// Excess of these below and above all that the data allow, K; `None` if sources and sinks allow any temperature.
    pub outside: [Option<f64>; 2],
    /// Largest penetration relative to the cells of its side at the last step; `None` without contact.
    pub penetration: Option<Penetration>,
    /// The undetermined rigid motions of the last step, in words.
    pub loose: Vec<String>,
    /// Number of steps made.
    pub steps: usize,
    /// Number of steps at whose end a contact point bore a traction.
    pub contact_steps: usize,
    /// Number of steps that reversed the velocity.
    pub reversed_steps: usize,
    /// The partly open contact with the fewest points under traction at the last step, and their number.
    pub few: Option<(usize, usize)>,
    /// The contact with the first leak, and the position of the narrowest place on its path.
    pub leak: Option<(usize, Leak, Point)>,
    /// Energy dissipated by the scheme, kinetic energy at the last step, and all energy turned over.
    pub scheme: [f64; 3],
    /// Energy that impacts on rigid foundations took in the ϑ-scheme, J.
    pub impacts: f64,
    /// Largest von Mises stress at the centre of a cell, Pa.
    pub von_mises: f64,
    /// Largest von Mises stress recovered at a node, Pa, and its position; `None` if not known.
    pub recovered: Option<(f64, Point)>,
    /// Stress of the largest strain in the stiffest material, Pa.
    pub stiff: f64,
    /// Number of contact systems factorized, and the unknowns of one.
    pub systems: [usize; 2],
    /// What began with a phase where the body was not.
    pub misfits: Vec<Misfit>,
}

/// A penetration relative to the cells of the side.
#[derive(Clone, Copy, Debug)]
pub struct Penetration {
    /// Number of the contact of the problem.
    pub side: usize,
    /// Largest penetration, m.
    pub depth: f64,
    /// Least height of a cell on the side, m.
    pub cell: f64,
}

/// The warnings about a run.
#[must_use]
pub fn of_run(problem: &Problem, figures: &Figures) -> Vec<Finding> {
    let parts = [
        strain(figures),
        temperature_range(problem, figures),
        absolute_zero(problem, figures),
        penetration(problem, figures),
        undetermined(problem, figures),
        no_contact(problem, figures),
        few_points(problem, figures),
        leak(problem, figures),
        scheme_share(problem, figures),
        alternation(figures),
        nodal_stress(problem, figures),
        many_systems(figures),
    ];
    parts.into_iter().flatten().chain(begins::of_run(problem, &figures.misfits)).collect()
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
    if !problem.physics.has_heat() {
        return None;
    }
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
        units.write(problem.timeline.shortest(), Measure::Time)
    );
    let repair = format!(
        "use finer cells where heat enters suddenly, h ≤ √(6 k K/c){}, or longer steps, or data that change gradually",
        problem.materials.first().map_or_else(String::new, |m| {
            // If coefficients vary, those at one node give the length of the layer.
            let x = problem.mesh.points.first().copied().unwrap_or_default();
            let (capacity, conductivity) = (m.heat_capacity.at(&x), m.conductivity.at(&x));
            let conductivity = conductivity.eigenvalues(problem.mesh.dim).first().copied().unwrap_or(0.0).max(0.0);
            if capacity <= 0.0 {
                return String::new();
            }
            format!(
                " = {}",
                units.write((6.0 * problem.timeline.shortest() * conductivity / capacity).sqrt(), Measure::Length)
            )
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

/// Undetermined motions: the smallest ones are computed, and another mesh may give others.
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

/// `no-contact`: only for finished runs, and if contacts act by pressure alone.
fn no_contact(problem: &Problem, figures: &Figures) -> Option<Finding> {
    let may_press = problem.contacts.iter().any(|contact| !contact.is_tie());
    if !may_press || problem.physics.has_heat() || figures.steps < problem.timeline.steps() || figures.contact_steps > 0
    {
        return None;
    }
    let message = format!(
        "at the end of no step of {} a contact point bears anything: the results are those of bodies without contact",
        figures.steps
    );
    let repair = "check the sides of the contact, its gap, the sign of loads and normals, and the units of the mesh";
    Some(warning(FindingId::NoContact, "contact", [0.0, 1.0], message, repair))
}

/// `few-points`.
fn few_points(problem: &Problem, figures: &Figures) -> Option<Finding> {
    let (side, pressed) = figures.few.filter(|(_, pressed)| *pressed < POINTS && problem.mesh.dim > 1)?;
    let contact = problem.contacts.get(side)?;
    let message = format!(
        "{} of \"{}\" {} at the last step, and others are open: so few points give the size of the contact to a facet only, and hardly its largest pressure",
        if pressed == 1 { "1 contact point".to_owned() } else { format!("{pressed} contact points") },
        contact.bearing(),
        if pressed == 1 { "bears the contact" } else { "bear the contact" }
    );
    let repair = "use facets there that are at most a quarter as long as the contact";
    Some(warning(FindingId::FewPoints, "mesh", [pressed as f64, POINTS as f64], message, repair))
}

/// `leak`.
fn leak(problem: &Problem, figures: &Figures) -> Option<Finding> {
    let (side, Leak { t, gap, .. }, x) = figures.leak?;
    let fluid = problem.contacts.get(side)?.fluid.as_ref()?;
    let units = problem.units();
    let narrow = if gap >= 0.0 {
        format!("past a gap of {} at {}", units.write(gap, Measure::Length), at(&x))
    } else {
        format!("past {}, where the sides press by less than `sealed_above`", at(&x))
    };
    let message = format!(
        "the fluid comes from \"{}\" through the contact to \"{}\" at t = {}, {narrow}",
        fluid.from,
        fluid.to,
        units.write(t, Measure::Time)
    );
    let place = format!("{}.fluid", problem.contact_path(side));
    let repair = "press the seal more, or lower the pressure of the fluid";
    Some(warning(FindingId::Leak, &place, [t, problem.timeline.end()], message, repair))
}

/// `scheme-share`: only if there is a motion that the scheme could slow down. In a slow process the dissipation of the
/// scheme is a sum over steps of work, and the state at their end is right.
fn scheme_share(problem: &Problem, figures: &Figures) -> Option<Finding> {
    let [taken, kinetic, turned_over] = figures.scheme;
    // What a rigid part loses is its own energy, by its coefficient of restitution.
    let impacts = if problem.rigid.is_empty() { figures.impacts } else { 0.0 };
    let taken = taken + impacts;
    let is_thrown = problem.initial.velocity.iter().any(|velocity| !velocity.is_zero());
    if taken <= SCHEME * turned_over || !(is_thrown || kinetic > MOVES * turned_over) {
        return None;
    }
    let share = taken / turned_over;
    let message = format!(
        "the time-stepping scheme itself took {:.0} % of the energy turned over: oscillations and rebounds are computed weaker than they are, by as much",
        100.0 * share
    );
    let rule = problem.rule(Analysis::Dynamic, problem.timeline.longest());
    let is_balanced = rule.balances_contact_at_end();
    let repair = if is_balanced && rule.level <= 0.5 {
        "use more steps (time.steps): the share falls with the step"
    } else if !rule.is_backward_euler() && rule.contact.is_none() && !is_balanced {
        "use more steps (time.steps): the share falls with the square of the step; or set time.scheme = \"theta\""
    } else if rule.contact.is_none() && !is_balanced {
        "set time.scheme = \"theta\", which keeps the energy but for impacts on rigid foundations, or use more steps (time.steps): the share falls with the step, across an impact with its square root"
    } else if rule.level > 0.5 {
        "lower time.theta to 0.5, or use more steps (time.steps)"
    } else {
        "a point that hits a rigid foundation loses the energy of its own mass: refine the mesh there, or use a compliance, which loses none; or more steps (time.steps)"
    };
    Some(warning(FindingId::SchemeShare, "time.steps", [share, SCHEME], message, repair))
}

/// `alternation`: a motion of the period 2k, which no step resolves. At ϑ = ½ it is not damped: a body without inertia
/// and viscosity whose initial state is not in equilibrium alternates about its motion in all steps, and a law of
/// contact that is not linear takes a wrong mean of it.
fn alternation(figures: &Figures) -> Option<Finding> {
    let share = figures.reversed_steps as f64 / figures.steps.max(1) as f64;
    if share <= ALTERNATES || figures.reversed_steps < REVERSALS {
        return None;
    }
    let message = format!(
        "in {} of {} steps the velocity changed its sign: the results alternate from step to step, and may do so about a wrong mean",
        figures.reversed_steps, figures.steps
    );
    let repair = "start in equilibrium (initial.displacement, loads and gaps that grow from nothing), use more steps, or damp what a step does not resolve: time.theta above 0.5, or time.scheme = \"euler\"";
    Some(warning(FindingId::Alternation, "time", [share, ALTERNATES], message, repair))
}

/// `nodal-stress`: both stresses are right up to the size of a cell, so they differ where stresses vary from cell to
/// cell.
fn nodal_stress(problem: &Problem, figures: &Figures) -> Option<Finding> {
    let (recovered, x) = figures.recovered?;
    let ratio = recovered / figures.von_mises;
    if figures.von_mises <= ROUND_OFF * figures.stiff || ratio <= APART {
        return None;
    }
    let write = |stress: f64| problem.units().write(stress, Measure::Stress);
    let message = format!(
        "the von Mises stress is up to {} recovered at the nodes, at {}, and up to {} at the centre of a cell: cells there do not resolve it",
        write(recovered),
        at(&x),
        write(figures.von_mises)
    );
    let repair = "use smaller or quadratic cells there; at a sharp corner or the end of a support the stress has no limit, and neither number means anything";
    Some(warning(FindingId::NodalStress, "mesh", [ratio, APART], message, repair))
}

/// `many-systems`.
fn many_systems(figures: &Figures) -> Option<Finding> {
    let [systems, unknowns] = figures.systems.map(|count| count as f64);
    let (made, predicted) = (systems / figures.steps.max(1) as f64, PATTERNS);
    let operations = 2.0 / 3.0 * unknowns.powi(3) * systems;
    if made <= OFF * predicted || operations <= COSTLY {
        return None;
    }
    let message = format!(
        "a step takes {made:.0} contact systems in the mean, {:.0} times the {predicted:.0} that the time of the run is predicted with",
        made / predicted
    );
    let repair = "use more steps: each then changes less of the contact; a contact that is far stiffer than the body, or friction beside few supports, take most";
    Some(warning(FindingId::ManySystems, "time.steps", [made, OFF * predicted], message, repair))
}
