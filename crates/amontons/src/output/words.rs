//! The results of a run in words, for the printed summary and the report.

use std::collections::BTreeMap;

use super::shown::placed;
use super::{ContactSummary, Outcome, Seconds, SolverCounts, Summary};
use crate::problem::Choice;
use crate::time::ChosenSteps;
use crate::units::{Extent, Measure, Units, beyond};

/// A name and its text.
type WordRow = (String, String);

fn row(name: &str, text: &str) -> WordRow {
    (name.to_owned(), text.to_owned())
}

impl Summary {
    /// The case, the outcome of its run, and its progress.
    #[must_use]
    pub fn headline(&self) -> String {
        let state = match self.outcome {
            Outcome::Done => "done",
            Outcome::NotConverged => "not converged",
            Outcome::Interrupted => "interrupted",
            Outcome::Unsound => "unsound",
        };
        let time = self.units.exact(self.time, Measure::Time);
        format!("{}: {state}, {} steps to t = {time} in {:.2} s", self.case, self.steps, self.seconds.total)
    }

    /// The results for reading, names and texts: first the requested results, then how they were computed.
    #[must_use]
    pub fn rows(&self) -> Vec<(String, String)> {
        let mechanics = !self.last.displacement_min.is_empty();
        // A given temperature has no heat balance.
        let is_balanced = self.unknowns.temperature > 0 || self.energy.heat_turned_over > 0.0;
        let heat = self.last.temperature_min.is_some() && (is_balanced || !mechanics);
        let mut rows = self.of_contact();
        rows.extend(self.of_fields());
        rows.extend(extent(self.units, mechanics));
        let closes = |name: &str, what: &str, error: f64| {
            row(&format!("{name} closes to"), &format!("{error:.1e} of the {what} turned over"))
        };
        rows.extend(self.discretization_error.as_ref().map(|error| row("discretization error", &error.line())));
        rows.extend(mechanics.then(|| closes("energy", "energy", self.energy.closing_error)));
        rows.extend(heat.then(|| closes("heat", "heat", self.energy.heat_closing_error)));
        rows.extend(self.chosen.as_ref().map(|chosen| lengths(chosen, self.units)));
        rows.extend(halved(&self.solver));
        rows.extend(computed_with(&self.choices));
        let counts = &self.unknowns;
        let unknowns = [counts.displacement, counts.temperature, counts.contact];
        rows.push(row("unknowns", &unknowns_in_words(unknowns, mechanics, heat)));
        rows.push(systems(&self.solver));
        rows.push(row("time", &phases(&self.seconds)));
        rows
    }

    /// Contact on all sides together, and on each of several.
    fn of_contact(&self) -> Vec<WordRow> {
        let Some(contact) = self.last.contact.as_ref().filter(|c| c.open + c.stick + c.slip > 0) else {
            return Vec::new();
        };
        let force = contact.sides.values().flat_map(|side| &side.force).fold(0.0, |m: f64, f| m.max(f.abs()));
        let stress = self.last.von_mises_max.unwrap_or(0.0).max(contact.pressure_max);
        let moment = contact.sides.values().map(lever).fold(lever(contact), f64::max);
        let mut rows = touching("contact", contact, [force, stress, moment], self.units);
        for (side, contact) in &contact.sides {
            rows.extend(touching(&format!("on \"{side}\""), contact, [0.0, stress, moment], self.units));
        }
        rows
    }

    /// The largest values of the fields.
    fn of_fields(&self) -> Vec<WordRow> {
        let (end, units) = (&self.last, self.units);
        let up_to =
            |key: &str, most: f64, measure| placed(key, &format!("up to {}", units.write_beside(most, 0.0, measure)));
        let of_von_mises = |most| row("von Mises stress", &up_to("final.von_mises_max", most, Measure::Stress));
        let mut rows: Vec<WordRow> = end.von_mises_max.map(of_von_mises).into_iter().collect();
        rows.extend(end.strain_max.map(|most| row("strain", &up_to("final.strain_max", most, Measure::Number))));
        if let (Some(min), Some(max)) = (end.temperature_min, end.temperature_max) {
            let range = range(units, [min, max], Measure::Temperature);
            rows.push(row("temperature", &placed("final.temperature_max", &range)));
        }
        let ends = end.displacement_min.iter().chain(&end.displacement_max);
        let largest = ends.fold(0.0, |largest: f64, end| largest.max(end.abs()));
        for (axis, (min, max)) in ["x", "y", "z"].iter().zip(end.displacement_min.iter().zip(&end.displacement_max)) {
            let range = range(units, [min, max].map(|end| beyond(*end, largest)), Measure::Length);
            rows.push(row(&format!("displacement {axis}"), &placed("final.displacement_max", &range)));
        }
        rows
    }
}

/// The choices of the program, one row each; the first row has the name.
#[must_use]
pub fn computed_with(choices: &[Choice]) -> Vec<(String, String)> {
    let name = |number: usize| if number == 0 { "computed with" } else { "" };
    let of =
        |(number, Choice { what, value, why }): (usize, &Choice)| row(name(number), &format!("{what} {value}: {why}"));
    choices.iter().enumerate().map(of).collect()
}

/// Numbers of unknowns for displacement, temperature and contact, as far as a case has them.
#[must_use]
pub fn unknowns_in_words([displacement, temperature, contact]: [usize; 3], mechanics: bool, heat: bool) -> String {
    let of_mechanics = |count: usize, what: &str| mechanics.then(|| format!("{count} {what}"));
    let all = [
        of_mechanics(displacement, "displacement"),
        heat.then(|| format!("{temperature} temperature")),
        of_mechanics(contact, "on the contact side"),
    ];
    all.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// The times of the phases of a run.
fn phases(seconds: &Seconds) -> String {
    let Seconds { certificate, setup, factor, steps, output, .. } = seconds;
    format!(
        "{certificate:.2} s certificate, {setup:.2} s setup, {factor:.2} s factor, {steps:.2} s steps, {output:.2} s output"
    )
}

/// The solver of the linear systems.
fn systems(solver: &SolverCounts) -> WordRow {
    let way = match solver.backend.as_str() {
        "iterative" => format!("by an iteration without a factor, {} Krylov iterations", solver.krylov_iterations),
        _ => "by a factor".to_owned(),
    };
    row("linear systems", &format!("{way}: {}", solver.backend_reason))
}

/// An error over what was asked for that is told.
const MORE: f64 = 1.05;

/// The steps that were chosen by their errors.
fn lengths(chosen: &ChosenSteps, units: Units) -> WordRow {
    let ChosenSteps { made, rejected, unjudged, shortest, longest, error, over_accuracy } = *chosen;
    let [shortest, longest] = [shortest, longest].map(|k| units.write(k, Measure::Time));
    let mut text = format!(
        "{made} of {shortest} to {longest}, {rejected} made anew with a shorter length, estimated error {error:.1e}"
    );
    if over_accuracy > MORE {
        text += &format!(", {over_accuracy:.1} times what was asked for");
    }
    if unjudged > 0 {
        text += &format!(", not known in {unjudged} of them, which no shorter length solves");
    }
    row("chosen steps", &text)
}

/// Halved and ambiguous steps, if there are any.
fn halved(solver: &SolverCounts) -> Option<WordRow> {
    let SolverCounts { halved_steps, ambiguous_steps, .. } = *solver;
    let ambiguous = match ambiguous_steps {
        0 => "none of them remains ambiguous".to_owned(),
        some => format!("{some} of all steps remain ambiguous"),
    };
    (halved_steps > 0 || ambiguous_steps > 0)
        .then(|| row("halved steps", &format!("{halved_steps} steps, {ambiguous}")))
}

/// The ends of a range in one unit.
fn range(units: Units, ends: [f64; 2], measure: Measure) -> String {
    let (low, high, unit) = units.range(ends, measure);
    format!("{low} … {high} {unit}").trim_end().to_owned()
}

/// The extent of integrals over a body, or `None` if they cover all of it.
fn extent(units: Units, mechanics: bool) -> Option<WordRow> {
    let text = match units.extent {
        Extent::Line => "per unit of cross-section",
        Extent::Plane => "per unit of thickness",
        Extent::Revolution => "of the full turn",
        Extent::Sheet | Extent::Space => return None,
    };
    Some(row(if mechanics { "forces, energies" } else { "heat" }, text))
}

/// The largest product of force and distance from the origin of a contact.
fn lever(contact: &ContactSummary) -> f64 {
    let largest = |v: &[f64]| v.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    largest(&contact.force) * largest(&contact.center)
}

/// The moments of a contact, rounded relative to moments as large as `beside`.
fn moments(contact: &ContactSummary, beside: f64, units: Units) -> impl Iterator<Item = WordRow> {
    let about_axis = contact.moment.map(|moment| format!("{} about the axis", units.write(moment, Measure::Moment)));
    let about_origin = contact.moment_about_origin.as_ref().filter(|moment| moment.iter().any(|m| *m != 0.0));
    let about_origin = about_origin.map(|moment| units.vector_beside(moment, beside, Measure::Moment));
    let about_origin = about_origin.map(|moment| format!("{moment} about the origin"));
    about_axis.into_iter().chain(about_origin).map(|text| row("moment", &text))
}

/// Contact on one side or on all, rounded relative to the forces, stresses and moments in `beside`, with wear and
/// foundation temperature if there are any. Between bodies at rest heat only.
fn touching(name: &str, contact: &ContactSummary, beside: [f64; 3], units: Units) -> Vec<WordRow> {
    let [beside, stress, of_moment] = beside;
    let write = |value: f64, measure: Measure| units.write(value, measure);
    if contact.force.is_empty() {
        return at_rest(name, contact, units);
    }
    let force = units.vector_beside(&contact.force, beside, Measure::Force);
    let mut lines = vec![
        row(
            name,
            &format!(
                "{} open, {} stick, {} slip; area {}",
                contact.open,
                contact.stick,
                contact.slip,
                write(contact.area, Measure::Area)
            ),
        ),
        row(
            "contact force",
            &placed(
                "final.contact.pressure_max",
                &format!(
                    "{force}, pressure up to {}",
                    units.write_beside(contact.pressure_max, stress, Measure::Stress)
                ),
            ),
        ),
    ];
    lines.extend(moments(contact, of_moment, units));
    lines.extend(
        contact.heat_flow.filter(|flow| *flow != 0.0).map(|flow| row("heat through it", &write(flow, Measure::Power))),
    );
    lines.extend(by_mechanism(&contact.heat_passed, units));
    if let Some(defect) = &contact.moment_defect {
        lines.push(row("defect of moments", &units.vector_beside(defect, of_moment, Measure::Moment)));
    }
    if contact.wear_max > 0.0 {
        let [deep, volume] = [write(contact.wear_max, Measure::Length), write(contact.wear_volume, Measure::Volume)];
        let deep = placed("final.contact.wear_max", &format!("up to {deep} deep"));
        lines.push(row("wear", &format!("{deep}, volume {volume}")));
    }
    let volumes =
        contact.wear_volumes.iter().map(|(side, volume)| format!("{side} {}", write(*volume, Measure::Volume)));
    let volumes: Vec<String> = volumes.collect();
    lines.extend((contact.wear_max > 0.0 && !volumes.is_empty()).then(|| row("of this", &volumes.join(", "))));
    lines.extend(contact.foundation_temperature.map(|theta| row("foundation", &write(theta, Measure::Temperature))));
    lines.extend(tightened(contact, units));
    let moved =
        contact.obstacle_displacement.map(|by| format!("moved by {} along its load", write(by, Measure::Length)));
    lines.extend(moved.map(|moved| row("obstacle", &moved)));
    lines.extend(wet(contact, units));
    lines
}

/// The area wetted by a fluid, and the time of the first leak.
fn wet(contact: &ContactSummary, units: Units) -> Option<WordRow> {
    let area = units.write(contact.wet_area?, Measure::Area);
    let leaks = contact.leaks_since.map(|t| format!(", comes through since t = {}", units.write(t, Measure::Time)));
    Some(row("fluid", &format!("wets {area}{}", leaks.unwrap_or_default())))
}

/// The tension of a bolt, and the distance by which its section is drawn together.
fn tightened(contact: &ContactSummary, units: Units) -> Option<WordRow> {
    let [tension, drawn] = [(contact.tension?, Measure::Force), (contact.drawn?, Measure::Length)]
        .map(|(value, of)| units.write(value, of));
    Some(row("tension", &format!("{tension}, drawn together by {drawn}")))
}

/// The heat through a contact of bodies at rest.
fn at_rest(name: &str, contact: &ContactSummary, units: Units) -> Vec<WordRow> {
    let flow = contact.heat_flow.map(|flow| format!("heat through it {}", units.write(flow, Measure::Power)));
    let mut rows: Vec<WordRow> = flow.map(|flow| row(name, &flow)).into_iter().collect();
    rows.extend(by_mechanism(&contact.heat_passed, units));
    rows.extend(
        contact.foundation_temperature.map(|theta| row("foundation", &units.write(theta, Measure::Temperature))),
    );
    rows
}

/// Heat that has passed a contact, by mechanism, if there are several.
fn by_mechanism(heat: &BTreeMap<String, f64>, units: Units) -> Option<WordRow> {
    let most = heat.values().fold(0.0, |most: f64, heat| most.max(heat.abs()));
    let write = |heat: f64| units.write_beside(heat, most, Measure::Energy);
    let ways: Vec<String> = heat.iter().map(|(way, heat)| format!("{way} {}", write(*heat))).collect();
    (ways.len() > 1).then(|| row("heat passed", &ways.join(", ")))
}
