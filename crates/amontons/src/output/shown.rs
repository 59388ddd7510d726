//! Every value that a run shows, with its place, meaning, measured quantity and location.
//!
//! Summary, report, pictures, `manifest.json`, the reference and `amontons explain` use this list. So one value has one
//! name and one unit everywhere, and a maximum says over which locations it is taken: contact points, centres of cells,
//! nodes, and means about nodes have maxima of their own.

use super::names::{CONTACT, FIELDS, HISTORY, SIDES, SUMMARY};
use super::{ContactSummary, Final};
use crate::units::Measure;

/// The location of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lives {
    /// The whole body or a side: a sum, an integral, a count.
    Whole,
    /// At the nodes of the mesh: unknowns of the problem.
    Node,
    /// At the nodes, recovered from the values in the cells around ([`super::nodal_stress`]).
    Recovered,
    /// At the centres of the cells.
    Cell,
    /// At the quadrature points of the cells.
    Quadrature,
    /// At the contact points.
    Point,
    /// The nodes of a side: the value of the contact point of the node, or the mean of the points that it takes part
    /// in.
    Mean,
}

impl Lives {
    /// The words after a value: `5.2 MPa at the centre of a cell`; empty for a value of the whole.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Lives::Whole => "",
            Lives::Node => "at the nodes",
            Lives::Recovered => "recovered at the nodes",
            Lives::Cell => "at the centre of a cell",
            Lives::Quadrature => "at a quadrature point",
            Lives::Point => "at a contact point",
            Lives::Mean => "as the mean of neighbouring points",
        }
    }

    /// A text followed by these words.
    #[must_use]
    pub fn after(self, text: &str) -> String {
        format!("{text} {}", self.words()).trim_end().to_owned()
    }
}

/// The table or file of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ResultTable {
    /// `summary.json`: numbers of the last good step.
    Summary,
    /// `history.csv`: one row per step.
    History,
    /// `contact.csv`: one row per contact point.
    Contact,
    /// `fields.pvd`: arrays over the body.
    Fields,
    /// `contact.pvd`: arrays over the sides of contact.
    Surface,
}

impl ResultTable {
    /// The name of the file.
    #[must_use]
    pub fn file(self) -> &'static str {
        match self {
            ResultTable::Summary => SUMMARY,
            ResultTable::History => HISTORY,
            ResultTable::Contact => CONTACT,
            ResultTable::Fields => FIELDS,
            ResultTable::Surface => SIDES,
        }
    }
}

/// A value that a run shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Its table.
    pub table: ResultTable,
    /// Its name there: a key of `summary.json`, a column or an array.
    pub name: String,
    /// The quantity that it measures, or `None` for text, and for norms, whose units no other value has.
    pub measure: Option<Measure>,
    /// Its location.
    pub lives: Lives,
}

impl Shown {
    pub(super) fn new(table: ResultTable, name: impl Into<String>, measure: Option<Measure>, lives: Lives) -> Shown {
        Shown { table, name: name.into(), measure, lives }
    }

    /// Its meaning in words.
    #[must_use]
    pub fn meaning(&self) -> &'static str {
        meaning(&self.name)
    }
}

/// A figure of `summary.json`.
pub(super) struct Figure {
    /// Its key, such as `final.von_mises_max`.
    key: &'static str,
    measure: Option<Measure>,
    lives: Lives,
    value: FigureValue,
}

/// Function that takes a figure from a summary; `None` if a run does not have it.
enum FigureValue {
    Number(fn(&Final) -> Option<f64>),
    Vector(fn(&Final) -> &[f64]),
    OfContact(fn(&ContactSummary) -> Option<f64>),
    VectorOfContact(fn(&ContactSummary) -> &[f64]),
}

use FigureValue::{Number, OfContact, Vector, VectorOfContact};

/// The figures of `summary.json`.
pub(super) fn summary_shown() -> impl Iterator<Item = Shown> {
    FIGURES.iter().map(|figure| Shown::new(ResultTable::Summary, figure.key, figure.measure, figure.lives))
}

impl Figure {
    /// Its numbers with their keys; for vectors the keys end with the component: `final.displacement_max[0]`.
    pub fn values(&self, last: &Final) -> Vec<(String, f64)> {
        let contact = last.contact.as_ref();
        let (number, vector) = match self.value {
            Number(value) => (value(last), &[][..]),
            Vector(value) => (None, value(last)),
            OfContact(value) => (contact.and_then(value), &[][..]),
            VectorOfContact(value) => (None, contact.map(value).unwrap_or_default()),
        };
        let components = vector.iter().enumerate().map(|(c, value)| (format!("{}[{c}]", self.key), *value));
        number.map(|value| (self.key.to_owned(), value)).into_iter().chain(components).collect()
    }
}

const fn figure(key: &'static str, measure: Measure, lives: Lives, value: FigureValue) -> Figure {
    Figure { key, measure: Some(measure), lives, value }
}

const fn norm(key: &'static str, value: fn(&Final) -> Option<f64>) -> Figure {
    Figure { key, measure: None, lives: Lives::Whole, value: Number(value) }
}

/// The figures of the last good step. Figures of contact also exist per side, below `final.contact.sides`.
pub(super) static FIGURES: [Figure; 29] = [
    figure("final.displacement_min", Measure::Length, Lives::Node, Vector(|last| &last.displacement_min)),
    figure("final.displacement_max", Measure::Length, Lives::Node, Vector(|last| &last.displacement_max)),
    figure("final.velocity_max", Measure::Velocity, Lives::Node, Vector(|last| &last.velocity_max)),
    figure("final.temperature_min", Measure::Temperature, Lives::Node, Number(|last| last.temperature_min)),
    figure("final.temperature_max", Measure::Temperature, Lives::Node, Number(|last| last.temperature_max)),
    figure("final.von_mises_max", Measure::Stress, Lives::Cell, Number(|last| last.von_mises_max)),
    figure("final.strain_max", Measure::Number, Lives::Quadrature, Number(|last| last.strain_max)),
    figure("final.undershoot", Measure::TemperatureDifference, Lives::Node, Number(|last| last.undershoot)),
    figure("final.overshoot", Measure::TemperatureDifference, Lives::Node, Number(|last| last.overshoot)),
    figure("final.penetration_per_cell", Measure::Number, Lives::Point, Number(|last| last.penetration_per_cell)),
    norm("final.norms.displacement_l2", |last| last.norms.displacement_l2),
    norm("final.norms.displacement_v", |last| last.norms.displacement_v),
    norm("final.norms.velocity_l2", |last| last.norms.velocity_l2),
    norm("final.norms.temperature_l2", |last| last.norms.temperature_l2),
    figure("final.contact.force", Measure::Force, Lives::Whole, VectorOfContact(|c| &c.force)),
    figure("final.contact.moment", Measure::Moment, Lives::Whole, OfContact(|c| c.moment)),
    figure(
        "final.contact.moment_about_origin",
        Measure::Moment,
        Lives::Whole,
        VectorOfContact(|c| c.moment_about_origin.as_deref().unwrap_or_default()),
    ),
    figure("final.contact.heat_flow", Measure::Power, Lives::Whole, OfContact(|c| c.heat_flow)),
    figure("final.contact.penetration_max", Measure::Length, Lives::Point, OfContact(|c| Some(c.penetration_max))),
    figure("final.contact.pressure_max", Measure::Stress, Lives::Point, OfContact(|c| Some(c.pressure_max))),
    figure("final.contact.open", Measure::Number, Lives::Whole, OfContact(|c| Some(c.open as f64))),
    figure("final.contact.stick", Measure::Number, Lives::Whole, OfContact(|c| Some(c.stick as f64))),
    figure("final.contact.slip", Measure::Number, Lives::Whole, OfContact(|c| Some(c.slip as f64))),
    figure("final.contact.area", Measure::Area, Lives::Whole, OfContact(|c| Some(c.area))),
    figure("final.contact.center", Measure::Length, Lives::Whole, VectorOfContact(|c| &c.center)),
    figure("final.contact.wear_max", Measure::Length, Lives::Point, OfContact(|c| Some(c.wear_max))),
    figure("final.contact.wear_volume", Measure::Volume, Lives::Whole, OfContact(|c| Some(c.wear_volume))),
    figure(
        "final.contact.obstacle_displacement",
        Measure::Length,
        Lives::Whole,
        OfContact(|c| c.obstacle_displacement),
    ),
    figure(
        "final.contact.foundation_temperature",
        Measure::Temperature,
        Lives::Whole,
        OfContact(|c| c.foundation_temperature),
    ),
];

/// A text about a figure of the summary, followed by the words of its location.
pub(super) fn placed(key: &str, text: &str) -> String {
    let lives = FIGURES.iter().find(|figure| figure.key == key).map_or(Lives::Whole, |figure| figure.lives);
    lives.after(text)
}

/// Meanings of values by their names without components; for the summary by the last part of the key.
const MEANINGS: [(&str, &str); 89] = [
    ("step", "number of the step"),
    ("t", "time"),
    ("kinetic", "kinetic energy at t"),
    ("elastic", "elastic energy at t, of relaxing springs, too"),
    ("viscous_dissipation", "dissipated by viscosity since the start"),
    ("friction_dissipation", "dissipated by friction since the start"),
    ("contact_energy", "energy of compliant contact at t"),
    ("load_work", "work of loads and prescribed displacements since the start"),
    ("thermal_work", "work of thermal stress since the start"),
    ("scheme_dissipation", "what the time-stepping scheme itself took since the start"),
    ("closing_error", "error of the energy balance"),
    ("heat_content", "heat of the body at t, above that at θ = 0"),
    ("heat_contact", "heat that has come through contact since the start"),
    ("contact_force", "resultant of σν on Γ_C, of all contacts or of one"),
    (
        "contact_moment",
        "moment of σν: in space about the origin, of bodies of revolution about the axis where a foundation turns about it",
    ),
    ("penetration_max", "largest penetration"),
    ("open", "contact points without traction"),
    ("stick", "contact points that stick"),
    ("slip", "contact points that slip"),
    ("newton_mechanics", "Newton iterations of the mechanical step"),
    ("newton_heat", "Newton iterations of the heat step"),
    ("heat_prescribed", "heat from prescribed temperatures since the start"),
    ("heat_supplied", "heat of sources, inflows and convection since the start"),
    ("heat_coupling", "heat of strain (𝓡) since the start"),
    ("heat_closing_error", "error of the heat balance"),
    ("passes", "passes over both half-steps"),
    ("contraction", "mean contraction factor of the fixed-point coupling; 0 without one"),
    ("contact_area", "area in contact"),
    ("wear_max", "largest depth worn off"),
    ("wear_volume", "volume worn off"),
    ("wear_dissipation", "energy of what has worn off"),
    ("impact_dissipation", "energy that impacts on rigid foundations took since the start, in the ϑ-scheme"),
    (
        "heat_scheme",
        "heat that rates of BDF2 store beyond the heat content, less what bodies took on the way to steady states",
    ),
    ("heat_friction", "heat of friction in the body since the start"),
    ("heat_foundation", "heat of foundations with a heat capacity at t"),
    ("heat_surroundings", "heat that foundations have given to their surroundings"),
    ("parts", "parts that the step was made in: 1, or more of a halved one"),
    ("contact_center", "where the pressure acts, Σ ω p x/Σ ω p"),
    ("obstacle_displacement", "δ, by which an obstacle has moved along its load"),
    ("foundation_temperature", "θ_F of a foundation with a heat capacity"),
    ("k", "length of the step"),
    ("phase", "name of the phase of the step"),
    ("modulus_work", "work of moduli and contact stiffnesses that change with time or temperature"),
    ("heat_pairs", "heat that has crossed pairs since the start"),
    ("heat_flow", "∫ q·ν over a side"),
    ("pressure_max", "largest contact pressure"),
    ("node", "number of the node; of Gauss points the number of the point"),
    ("x", "position at rest"),
    ("y", "position at rest"),
    ("z", "position at rest"),
    ("penetration", "r: how far the body is beyond the gap; negative where it is open"),
    ("pressure", "p_ν, the contact pressure"),
    ("traction", "σ_τ, what friction does to the body"),
    ("slip_velocity", "w_τ − v_F, of the body against what it faces"),
    ("status", "open, stick or slip; in files of fields 0, 1 or 2"),
    ("temperature", "temperature θ"),
    ("error", "energy of the discretization error of the cell, at most"),
    ("heat_flux", "q = −𝓚∇θ; on a side q·ν, heat that leaves the body"),
    ("weight", "area ω of a contact point or of a node"),
    ("wear", "depth worn off; of a pair in contact.csv off both bodies where they face each other now"),
    ("friction_work", "work of friction on the area since the start"),
    (
        "side",
        "name of the side that bears the points, or of the contact where several do; in files of fields its number",
    ),
    ("bound", "friction bound s"),
    ("opposite_temperature", "θ_F of the foundation, or θ of the other body of a pair"),
    ("displacement", "displacement u"),
    ("velocity", "velocity w = u̇"),
    ("nodal_stress", "stress σ of (2.1), continuous within a region"),
    ("nodal_von_mises", "von Mises stress of nodal_stress"),
    ("stress", "stress σ of (2.1)"),
    ("von_mises", "von Mises stress"),
    ("region", "number of the region"),
    ("strain", "strain ε(u)"),
    ("principal", "principal stresses, the largest first"),
    ("principal_direction_1", "direction of the first principal stress"),
    ("principal_direction_2", "direction of the second principal stress"),
    ("principal_direction_3", "direction of the third principal stress"),
    ("gap", "g − u_ν, negative where the body is beyond the gap"),
    ("displacement_min", "least displacement, by component"),
    ("displacement_max", "largest displacement, by component"),
    ("velocity_max", "largest velocity, by component and with its sign"),
    ("temperature_min", "least temperature"),
    ("temperature_max", "largest temperature"),
    ("von_mises_max", "largest von Mises stress"),
    ("strain_max", "largest principal strain in magnitude"),
    ("undershoot", "by how much a temperature was below the least that the data allow"),
    ("overshoot", "by how much a temperature was above the largest that the data allow"),
    ("penetration_per_cell", "largest penetration over the height of the lowest cell of its side"),
    ("center", "where the pressure acts, Σ ω p x/Σ ω p"),
    ("moment_about_origin", "moment of σν about the origin; about the normal of a plane body"),
];

/// Meanings of keys of the summary whose quantities have other names elsewhere.
const OF_SUMMARY: [(&str, &str); 7] = [
    ("displacement_l2", "‖u‖ in L²"),
    ("displacement_v", "‖u‖_V = ‖ε(u)‖ in L²"),
    ("velocity_l2", "‖w‖ in L²"),
    ("temperature_l2", "‖θ‖ in L²"),
    ("force", "resultant of σν on Γ_C, of all contacts or of one"),
    ("moment", "moment of σν about the axis of revolution, where a foundation turns about it"),
    ("area", "area in contact"),
];

/// The meaning of a value; a vector component ends with an axis.
fn meaning(name: &str) -> &'static str {
    let last = name.rsplit('.').next().unwrap_or(name);
    let of =
        |name: &str| MEANINGS.iter().chain(&OF_SUMMARY).find(|(known, _)| *known == name).map(|(_, meaning)| *meaning);
    let axes = ["_x", "_y", "_z"];
    let vector = || axes.iter().find_map(|axis| of(last.strip_suffix(axis)?));
    of(last).or_else(vector).unwrap_or_default()
}

#[cfg(all(test, feature = "plot"))]
mod tests;
