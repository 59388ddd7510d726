//! The columns of `history.csv` and `contact.csv`: name, measured quantity and value of each, in one place.
//!
//! Writers, readers, pictures and the guide take names and units from here.

use super::csv::join;
use super::shown::{Lives, ResultTable, Shown};
use super::{ContactSummary, Snapshot};
use crate::contact::{PointOnBoundary, Quadrature, names, names_of_points};
use crate::inclusion::PointState;
use crate::problem::ProblemData;
use crate::state::{Ledger, StepReport};
use crate::tensor::Point;
use crate::units::Measure;

/// Names of the coordinate directions.
const AXES: [&str; 3] = ["x", "y", "z"];

/// A kind of table: the data from which its rows are made.
pub trait TableRows {
    /// A row, borrowed from a run.
    type Row<'a>;
    /// Location of the values of its columns, except maxima.
    const LIVES: Lives;
}

/// `history.csv`: one row per step.
pub enum History {}

impl TableRows for History {
    type Row<'a> = StepRow<'a>;
    const LIVES: Lives = Lives::Whole;
}

/// `contact.csv`: one row per contact point.
pub enum ContactColumns {}

impl TableRows for ContactColumns {
    type Row<'a> = PointRow<'a>;
    const LIVES: Lives = Lives::Point;
}

/// A column of a table, or the columns of a vector.
pub struct Column<T: TableRows> {
    /// Its name; the columns of a vector add `_x`, `_y`, `_z`.
    pub name: &'static str,
    /// The quantity that it measures, or `None` for text.
    pub measure: Option<Measure>,
    lives: Lives,
    value: ColumnValue<T>,
}

/// Function that takes the value of a column from a row.
enum ColumnValue<T: TableRows> {
    Number(fn(&T::Row<'_>) -> f64),
    Vector(fn(&T::Row<'_>) -> Point),
    /// A vector on Γ_C, which may have a component out of the plane of the body.
    OnContact(fn(&T::Row<'_>) -> Point),
    /// A number that is absent in some runs.
    Optional(fn(&T::Row<'_>) -> Option<f64>),
    Text(fn(&T::Row<'_>) -> String),
}

impl<T: TableRows> Column<T> {
    const fn number(name: &'static str, measure: Measure, value: fn(&T::Row<'_>) -> f64) -> Column<T> {
        Column { name, measure: Some(measure), lives: T::LIVES, value: ColumnValue::Number(value) }
    }

    /// A column with the maximum over the contact points.
    const fn largest(name: &'static str, measure: Measure, value: fn(&T::Row<'_>) -> f64) -> Column<T> {
        Column { name, measure: Some(measure), lives: Lives::Point, value: ColumnValue::Number(value) }
    }

    const fn vector(name: &'static str, measure: Measure, value: fn(&T::Row<'_>) -> Point) -> Column<T> {
        Column { name, measure: Some(measure), lives: T::LIVES, value: ColumnValue::Vector(value) }
    }

    const fn on_contact(name: &'static str, measure: Measure, value: fn(&T::Row<'_>) -> Point) -> Column<T> {
        Column { name, measure: Some(measure), lives: T::LIVES, value: ColumnValue::OnContact(value) }
    }

    const fn optional(name: &'static str, measure: Measure, value: fn(&T::Row<'_>) -> Option<f64>) -> Column<T> {
        Column { name, measure: Some(measure), lives: T::LIVES, value: ColumnValue::Optional(value) }
    }

    const fn text(name: &'static str, value: fn(&T::Row<'_>) -> String) -> Column<T> {
        Column { name, measure: None, lives: T::LIVES, value: ColumnValue::Text(value) }
    }

    /// The name of component `c` of a vector: `contact_force_x`. A vector without a name is the position: `x`.
    #[must_use]
    pub fn component(&self, c: usize) -> String {
        let axis = AXES.get(c).copied().unwrap_or_default();
        if self.name.is_empty() { axis.to_owned() } else { format!("{}_{axis}", self.name) }
    }

    /// Its names and measured quantities, with `dim` components for vectors and `on_contact` for vectors on Γ_C.
    fn named(&self, [dim, on_contact]: [usize; 2]) -> Vec<(String, Option<Measure>)> {
        let names = match self.value {
            ColumnValue::Vector(_) => (0..dim).map(|c| self.component(c)).collect(),
            ColumnValue::OnContact(_) => (0..on_contact).map(|c| self.component(c)).collect(),
            _ => vec![self.name.to_owned()],
        };
        names.into_iter().map(|name| (name, self.measure)).collect()
    }

    /// Its names with measured quantity and location, for a body in space.
    fn shown(&self, table: ResultTable) -> Vec<Shown> {
        let shown = |(name, measure)| Shown::new(table, name, measure, self.lives);
        self.named([3, 3]).into_iter().map(shown).collect()
    }

    /// The contact that a column of this name belongs to: `left` for `foundation_temperature@left`, "" for the only
    /// contact, or `None` for a name of another column.
    #[must_use]
    pub fn side_of<'a>(&self, name: &'a str) -> Option<&'a str> {
        match name.strip_prefix(self.name)? {
            "" => Some(""),
            rest => rest.strip_prefix('@'),
        }
    }
}

/// Data of a row of `history.csv`: a step with its contact, of all sides or of one.
pub struct StepRow<'a> {
    ledger: &'a Ledger,
    report: &'a StepReport,
    step: usize,
    t: f64,
    /// Length and phase of the step.
    k: f64,
    phase: &'a str,
    contact: ContactSummary,
    foundation: Option<f64>,
}

impl<'a> StepRow<'a> {
    fn new(now: &Snapshot<'a>, report: &'a StepReport, side: Option<usize>) -> StepRow<'a> {
        let state = now.state;
        let foundation = side.and_then(|side| state.surface.foundation.get(side).copied().flatten());
        let contact = ContactSummary::new(now, &report.contact, side);
        let timeline = &now.problem.timeline;
        let phase = state.phase(timeline).map_or("", |phase| &phase.name);
        let k = state.made(timeline).k;
        StepRow { ledger: &state.ledger, report, step: state.step, t: state.t, k, phase, contact, foundation }
    }
}

fn vector(components: &[f64]) -> Point {
    std::array::from_fn(|c| components.get(c).copied().unwrap_or_default())
}

macro_rules! columns {
    ($table:ty: $($id:ident = $kind:ident($($argument:expr),*);)*) => {
        $(
            #[doc = concat!("`", stringify!($id), "`, as its name says.")]
            pub const $id: Column<$table> = Column::$kind($($argument),*);
        )*
    };
}

columns! { History:
    STEP = number("step", Measure::Number, |row| row.step as f64);
    TIME = number("t", Measure::Time, |row| row.t);
    KINETIC = number("kinetic", Measure::Energy, |row| row.ledger.kinetic);
    ELASTIC = number("elastic", Measure::Energy, |row| row.ledger.elastic);
    VISCOUS_DISSIPATION = number("viscous_dissipation", Measure::Energy, |row| row.ledger.viscous_dissipation);
    FRICTION_DISSIPATION = number("friction_dissipation", Measure::Energy, |row| row.ledger.friction_dissipation);
    CONTACT_ENERGY = number("contact_energy", Measure::Energy, |row| row.ledger.contact_energy);
    LOAD_WORK = number("load_work", Measure::Energy, |row| row.ledger.load_work);
    THERMAL_WORK = number("thermal_work", Measure::Energy, |row| row.ledger.thermal_work);
    SCHEME_DISSIPATION = number("scheme_dissipation", Measure::Energy, |row| row.ledger.scheme_dissipation);
    CLOSING_ERROR = number("closing_error", Measure::Energy, |row| row.ledger.closing_error);
    HEAT_CONTENT = number("heat_content", Measure::Energy, |row| row.ledger.heat_content);
    HEAT_CONTACT = number("heat_contact", Measure::Energy, |row| row.ledger.heat_contact);
    CONTACT_FORCE = on_contact("contact_force", Measure::Force, |row| vector(&row.contact.force));
    CONTACT_MOMENT = optional("contact_moment", Measure::Moment, |row| row.contact.moment);
    CONTACT_MOMENTS = vector("contact_moment", Measure::Moment, |row| {
        vector(row.contact.moment_about_origin.as_deref().unwrap_or_default())
    });
    PENETRATION_MAX = largest("penetration_max", Measure::Length, |row| row.contact.penetration_max);
    OPEN = number("open", Measure::Number, |row| row.contact.open as f64);
    STICK = number("stick", Measure::Number, |row| row.contact.stick as f64);
    SLIP = number("slip", Measure::Number, |row| row.contact.slip as f64);
    NEWTON_MECHANICS = number("newton_mechanics", Measure::Number, |row| row.report.newton_mechanics as f64);
    NEWTON_HEAT = number("newton_heat", Measure::Number, |row| row.report.newton_heat as f64);
    HEAT_PRESCRIBED = number("heat_prescribed", Measure::Energy, |row| row.ledger.heat_prescribed);
    HEAT_SUPPLIED = number("heat_supplied", Measure::Energy, |row| row.ledger.heat_supplied);
    HEAT_COUPLING = number("heat_coupling", Measure::Energy, |row| row.ledger.heat_coupling);
    HEAT_CLOSING_ERROR = number("heat_closing_error", Measure::Energy, |row| row.ledger.heat_closing_error);
    PASSES = number("passes", Measure::Number, |row| row.report.coupling.passes as f64);
    // A missing contraction factor is written as 0, so that every row has a number in every column.
    CONTRACTION = number("contraction", Measure::Number, |row| row.report.coupling.contraction.unwrap_or_default().mean);
    CONTACT_AREA = number("contact_area", Measure::Area, |row| row.contact.area);
    WEAR_MAX = largest("wear_max", Measure::Length, |row| row.contact.wear_max);
    WEAR_VOLUME = number("wear_volume", Measure::Volume, |row| row.contact.wear_volume);
    WEAR_DISSIPATION = number("wear_dissipation", Measure::Energy, |row| row.ledger.wear_dissipation);
    IMPACT_DISSIPATION = number("impact_dissipation", Measure::Energy, |row| row.ledger.impact_dissipation);
    HEAT_SCHEME = number("heat_scheme", Measure::Energy, |row| row.ledger.heat_scheme);
    HEAT_FRICTION = number("heat_friction", Measure::Energy, |row| row.ledger.heat_friction);
    HEAT_FOUNDATION = number("heat_foundation", Measure::Energy, |row| row.ledger.heat_foundation);
    HEAT_SURROUNDINGS = number("heat_surroundings", Measure::Energy, |row| row.ledger.heat_surroundings);
    PARTS = number("parts", Measure::Number, |row| row.report.parts as f64);
    CONTACT_CENTER = vector("contact_center", Measure::Length, |row| vector(&row.contact.center));
    OBSTACLE_DISPLACEMENT =
        optional("obstacle_displacement", Measure::Length, |row| row.contact.obstacle_displacement);
    FOUNDATION_TEMPERATURE = optional("foundation_temperature", Measure::Temperature, |row| row.foundation);
    MODULUS_WORK = number("modulus_work", Measure::Energy, |row| row.ledger.modulus_work);
    HEAT_PAIRS = number("heat_pairs", Measure::Energy, |row| row.ledger.heat_pairs);
    HEAT_FLOW = number("heat_flow", Measure::Power, |row| row.contact.heat_flow.unwrap_or(0.0));
    PRESSURE_MAX = largest("pressure_max", Measure::Stress, |row| row.contact.pressure_max);
    STEP_LENGTH = number("k", Measure::Time, |row| row.k);
    PHASE = text("phase", |row| row.phase.to_owned());
}

/// The columns of `history.csv` in their order, except those of each contact.
const OF_STEP: &[&Column<History>] = &[
    &STEP,
    &TIME,
    &KINETIC,
    &ELASTIC,
    &VISCOUS_DISSIPATION,
    &FRICTION_DISSIPATION,
    &CONTACT_ENERGY,
    &LOAD_WORK,
    &THERMAL_WORK,
    &SCHEME_DISSIPATION,
    &CLOSING_ERROR,
    &HEAT_CONTENT,
    &HEAT_CONTACT,
    &CONTACT_FORCE,
    &PENETRATION_MAX,
    &OPEN,
    &STICK,
    &SLIP,
    &NEWTON_MECHANICS,
    &NEWTON_HEAT,
    &HEAT_PRESCRIBED,
    &HEAT_SUPPLIED,
    &HEAT_COUPLING,
    &HEAT_CLOSING_ERROR,
    &PASSES,
    &CONTRACTION,
    &CONTACT_AREA,
    &WEAR_MAX,
    &WEAR_VOLUME,
    &WEAR_DISSIPATION,
    &HEAT_FRICTION,
    &HEAT_FOUNDATION,
    &HEAT_SURROUNDINGS,
    &PARTS,
    &CONTACT_CENTER,
    &MODULUS_WORK,
];

/// Columns of pairs of bodies, after them: the first for any number of contacts, the others for a single contact.
const OF_PAIRS: &[&Column<History>] = &[&HEAT_PAIRS, &HEAT_FLOW, &PRESSURE_MAX];

/// Columns of each of several contacts, after its [`FOUNDATION_TEMPERATURE`].
const OF_SIDE: &[&Column<History>] = &[
    &CONTACT_FORCE,
    &CONTACT_CENTER,
    &CONTACT_AREA,
    &HEAT_FLOW,
    &PENETRATION_MAX,
    &PRESSURE_MAX,
    &OPEN,
    &STICK,
    &SLIP,
    &WEAR_MAX,
    &WEAR_VOLUME,
];

/// The columns of a step.
fn of_step(problem: &ProblemData) -> impl Iterator<Item = &'static Column<History>> + use<> {
    let has_pairs = problem.contacts.iter().any(|contact| contact.pair.is_some());
    let more = usize::from(has_pairs) * if problem.contacts.len() > 1 { 1 } else { OF_PAIRS.len() };
    let impacts = problem.has_impacts().then_some(&IMPACT_DISSIPATION as &'static Column<History>);
    let stores = problem.adds_to_two_states() || problem.timeline.first_steady().is_some();
    let stored = stores.then_some(&HEAT_SCHEME as &'static Column<History>);
    OF_STEP.iter().chain(OF_PAIRS.iter().take(more)).copied().chain(impacts).chain(stored).chain(turning(problem))
}

/// The moment column: about the axis for a body of revolution with a turning foundation, about the origin for a body in
/// space with contact, `None` otherwise.
fn turning(problem: &ProblemData) -> Option<&'static Column<History>> {
    let in_space = problem.mesh.dim == 3 && !problem.contacts.is_empty();
    problem.turns().then_some(&CONTACT_MOMENT).or_else(|| in_space.then_some(&CONTACT_MOMENTS))
}

/// The columns of a contact: temperature of a foundation that warms up, displacement of an obstacle under a load, and
/// all others if there are several contacts.
fn of_side(problem: &ProblemData, side: usize) -> impl Iterator<Item = &'static Column<History>> + use<> {
    let warms_up = problem.contacts.get(side).is_some_and(|contact| contact.foundation_heat.is_some());
    let several = problem.contacts.len() > 1;
    let foundation = warms_up.then_some(&FOUNDATION_TEMPERATURE as &'static Column<History>);
    let is_loaded = problem.contacts.get(side).and_then(|contact| contact.obstacle.as_ref()?.load.as_ref()).is_some();
    let moved = is_loaded.then_some(&OBSTACLE_DISPLACEMENT as &'static Column<History>);
    let turning = turning(problem).filter(|_| several);
    foundation.into_iter().chain(moved).chain(if several { OF_SIDE } else { &[] }.iter().copied()).chain(turning)
}

/// Columns of a run with phases, after all others; the first one is that of a run whose steps are chosen, too.
const OF_PHASE: &[&Column<History>] = &[&STEP_LENGTH, &PHASE];

/// The columns of the length and phase of a step; none in a run of equal steps without phases.
fn of_phase(problem: &ProblemData) -> impl Iterator<Item = &'static Column<History>> + use<> {
    let count = match (problem.timeline.has_phases(), problem.timeline.is_automatic()) {
        (true, _) => OF_PHASE.len(),
        (false, true) => 1,
        (false, false) => 0,
    };
    OF_PHASE.iter().take(count).copied()
}

/// Names of the columns of `history.csv` that hold numbers, with the quantities they measure. Each of several contacts
/// has its own columns, ending with `@` and its name, or the name of its side if it has none.
#[must_use]
pub fn history_measures(problem: &ProblemData) -> Vec<(String, Measure)> {
    history_names(problem).into_iter().filter_map(|(name, measure)| Some((name, measure?))).collect()
}

/// Names of all columns of `history.csv`, with the quantities they measure.
pub(super) fn history_names(problem: &ProblemData) -> Vec<(String, Option<Measure>)> {
    let n = [problem.mesh.dim, problem.components_of_force()];
    let mut all: Vec<_> = of_step(problem).flat_map(|column| column.named(n)).collect();
    for (side, name) in names(&problem.contacts).iter().enumerate() {
        let end = if problem.contacts.len() > 1 { format!("@{}", in_header(name)) } else { String::new() };
        let columns = of_side(problem, side).flat_map(|column| column.named(n));
        all.extend(columns.map(|(name, measure)| (name + &end, measure)));
    }
    all.extend(of_phase(problem).flat_map(|column| column.named(n)));
    all
}

/// Names of the columns of `history.csv`.
#[must_use]
pub fn history_columns(problem: &ProblemData) -> Vec<String> {
    history_names(problem).into_iter().map(|(name, _)| name).collect()
}

/// The row of a step, in the order of [`history_columns`], or `None` at t = 0. A column of words has NaN.
#[must_use]
pub fn history_values(now: &Snapshot) -> Option<Vec<f64>> {
    let report = now.report?;
    let (dim, on_contact) = (now.problem.mesh.dim, now.problem.components_of_force());
    let mut values = Vec::new();
    let mut add = |column: &Column<History>, step: &StepRow| match column.value {
        ColumnValue::Number(value) => values.push(value(step)),
        ColumnValue::Vector(value) => values.extend(value(step).iter().take(dim)),
        ColumnValue::OnContact(value) => values.extend(value(step).iter().take(on_contact)),
        ColumnValue::Optional(value) => values.extend(value(step)),
        ColumnValue::Text(_) => values.push(f64::NAN),
    };
    let all = StepRow::new(now, report, None);
    for column in of_step(now.problem) {
        add(column, &all);
    }
    for side in 0..now.problem.contacts.len() {
        let of_this: Vec<_> = of_side(now.problem, side).collect();
        if !of_this.is_empty() {
            let step = StepRow::new(now, report, Some(side));
            for column in of_this {
                add(column, &step);
            }
        }
    }
    of_phase(now.problem).for_each(|column| add(column, &all));
    Some(values)
}

/// The row of a step as it is written: numbers, and behind them the name of the phase.
pub(super) fn history_row(now: &Snapshot) -> Option<String> {
    let mut values = history_values(now)?;
    let Some(phase) = now.state.phase(&now.problem.timeline) else { return Some(join(&values)) };
    values.pop();
    Some(join(&values) + "," + &phase.name)
}

/// Data of a row of `contact.csv`: a contact point after a step.
pub struct PointRow<'a> {
    now: &'a Snapshot<'a>,
    number: usize,
    point: &'a PointOnBoundary,
    state: &'a PointState,
    temperature: f64,
    opposite: f64,
    flux: f64,
    weight: f64,
    /// Name of the contact in the rows of its points.
    called: &'a str,
}

impl PointRow<'_> {
    /// The number of the node with nodal quadrature, else the number of the contact point, from 0.
    fn node(&self) -> usize {
        let nodal =
            self.now.problem.contacts.get(self.point.contact).is_some_and(|c| c.quadrature == Quadrature::Nodal);
        let on_node = self.point.nodes.first().filter(|_| nodal);
        on_node
            .and_then(|(node, _)| self.now.discretization.boundary.nodes.get(*node))
            .map_or(self.number, |&node| node as usize)
    }

    /// `None` without heat: then there is no heat flux and no opposite temperature.
    fn of_heat(&self, value: f64) -> Option<f64> {
        self.now.problem.physics.has_heat().then_some(value)
    }

    /// True if no facet of the other side covers this point of a pair.
    fn faces_nothing(&self) -> bool {
        let is_pair = self.now.problem.contacts.get(self.point.contact).is_some_and(|contact| contact.pair.is_some());
        is_pair && self.point.nodes.len() == self.point.own
    }

    fn kept(&self, values: &[f64]) -> f64 {
        values.get(self.number).copied().unwrap_or(0.0)
    }
}

columns! { ContactColumns:
    NODE = text("node", |row| row.node().to_string());
    POSITION = vector("", Measure::Length, |row| row.point.x);
    PENETRATION = number("penetration", Measure::Length, |row| row.state.penetration);
    PRESSURE = number("pressure", Measure::Stress, |row| row.state.pressure);
    TRACTION = on_contact("traction", Measure::Stress, |row| row.state.q.map(|q| 0.0 - q));
    SLIP_VELOCITY = on_contact("slip_velocity", Measure::Velocity, |row| row.state.slip);
    STATUS = text("status", |row| row.state.status.name().to_owned());
    TEMPERATURE = optional("temperature", Measure::Temperature, |row| {
        row.now.problem.physics.has_temperature().then_some(row.temperature)
    });
    HEAT_FLUX = optional("heat_flux", Measure::HeatFlux, |row| row.of_heat(row.flux));
    WEIGHT = number("weight", Measure::Area, |row| row.weight);
    WEAR = number("wear", Measure::Length, |row| row.kept(&row.now.state.surface.wear));
    FRICTION_WORK = number("friction_work", Measure::SurfaceWork, |row| row.kept(&row.now.state.surface.friction_work));
    SIDE = text("side", |row| row.called.to_owned());
    BOUND = number("bound", Measure::Stress, |row| row.state.bound);
    OPPOSITE_TEMPERATURE = optional("opposite_temperature", Measure::Temperature, |row| {
        row.of_heat(row.opposite).filter(|_| !row.faces_nothing())
    });
}

/// The columns of `contact.csv` in their order.
const OF_POINT: &[&Column<ContactColumns>] = &[
    &NODE,
    &POSITION,
    &PENETRATION,
    &PRESSURE,
    &TRACTION,
    &SLIP_VELOCITY,
    &STATUS,
    &TEMPERATURE,
    &HEAT_FLUX,
    &WEIGHT,
    &WEAR,
    &FRICTION_WORK,
    &SIDE,
    &BOUND,
    &OPPOSITE_TEMPERATURE,
];

/// Names of the columns of `contact.csv` with the quantities they measure, `None` for text.
#[must_use]
pub fn contact_measures(problem: &ProblemData) -> Vec<(String, Option<Measure>)> {
    let n = [problem.mesh.dim, problem.components_on_contact()];
    OF_POINT.iter().flat_map(|column| column.named(n)).collect()
}

/// The values of a column of `contact.csv`.
#[derive(Clone, Debug, PartialEq)]
pub enum ContactValues {
    /// Numbers; NaN for values that a run does not have.
    Numbers(Vec<f64>),
    /// Text.
    Words(Vec<String>),
}

/// The columns of `contact.csv` after a step, with their names; empty at t = 0.
#[must_use]
pub fn contact_columns(now: &Snapshot) -> Vec<(String, ContactValues)> {
    let called = names_of_points(&now.problem.contacts);
    let (rows, dim, on_contact) = (points(now, &called), now.problem.mesh.dim, now.problem.components_on_contact());
    if now.report.is_none() {
        return Vec::new();
    }
    let numbers = |value: &dyn Fn(&PointRow) -> f64| ContactValues::Numbers(rows.iter().map(value).collect());
    let values = |column: &&Column<ContactColumns>| match column.value {
        ColumnValue::Number(value) => vec![numbers(&value)],
        ColumnValue::Vector(value) => (0..dim).map(|c| numbers(&|row| value(row)[c])).collect(),
        ColumnValue::OnContact(value) => (0..on_contact).map(|c| numbers(&|row| value(row)[c])).collect(),
        ColumnValue::Optional(value) => vec![numbers(&|row| value(row).unwrap_or(f64::NAN))],
        ColumnValue::Text(value) => vec![ContactValues::Words(rows.iter().map(value).collect())],
    };
    contact_measures(now.problem).into_iter().map(|(name, _)| name).zip(OF_POINT.iter().flat_map(values)).collect()
}

/// The contact points after a step, with the name of the contact in `called`; empty at t = 0.
fn points<'a>(now: &'a Snapshot<'a>, called: &'a [String]) -> Vec<PointRow<'a>> {
    let Some(report) = now.report else { return Vec::new() };
    let contact = &report.contact;
    let of_heat = contact.temperature.iter().zip(&contact.opposite).zip(&contact.flux);
    let rows = now.discretization.boundary.points.iter().zip(contact.states.iter().zip(of_heat)).enumerate();
    rows.map(|(number, (point, (state, ((&temperature, &opposite), flux))))| {
        let weight = contact.weights.get(number).copied().unwrap_or(point.weight);
        let called = called.get(point.contact).map_or("", String::as_str);
        PointRow { now, number, point, state, temperature, opposite, flux: flux.value, weight, called }
    })
    .collect()
}

/// The rows of `contact.csv` after a step, as they are written.
pub(crate) fn contact_rows(now: &Snapshot) -> Vec<String> {
    let (dim, on_contact) = (now.problem.mesh.dim, now.problem.components_on_contact());
    let line = |row: &PointRow| {
        let cell = |column: &&Column<ContactColumns>| match column.value {
            ColumnValue::Number(value) => format!("{:?}", value(row)),
            ColumnValue::Vector(value) => join(&value(row)[..dim]),
            ColumnValue::OnContact(value) => join(&value(row)[..on_contact]),
            ColumnValue::Optional(value) => value(row).map_or_else(String::new, |value| format!("{value:?}")),
            ColumnValue::Text(value) => quoted(&value(row)),
        };
        OF_POINT.iter().map(cell).collect::<Vec<_>>().join(",")
    };
    points(now, &names_of_points(&now.problem.contacts)).iter().map(line).collect()
}

/// A name as a field of a table: quoted if it contains a comma, a quote or a line end, preceded by an apostrophe if a
/// spreadsheet would read it as a formula.
fn quoted(name: &str) -> String {
    let is_formula = name.starts_with(['=', '+', '-', '@', '\t']);
    let name = if is_formula { format!("'{name}") } else { name.to_owned() };
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name }
}

/// The name of a side in the header of a table, with commas and quotes replaced.
pub(crate) fn in_header(name: &str) -> String {
    name.replace(|c: char| c.is_control() || matches!(c, ',' | '"'), "_")
}

/// Every column that `history.csv` can have, in space; columns of contacts come without `@` and name.
pub(super) fn history_shown() -> impl Iterator<Item = Shown> {
    let mut all: Vec<&Column<History>> = OF_STEP.iter().chain(OF_PAIRS).copied().collect();
    all.extend([
        &CONTACT_MOMENT as &Column<History>,
        &CONTACT_MOMENTS,
        &FOUNDATION_TEMPERATURE,
        &OBSTACLE_DISPLACEMENT,
        &IMPACT_DISSIPATION,
        &HEAT_SCHEME,
        &STEP_LENGTH,
        &PHASE,
    ]);
    all.into_iter().flat_map(|column| column.shown(ResultTable::History))
}

/// Every column that `contact.csv` can have, in space.
pub(super) fn contact_shown() -> impl Iterator<Item = Shown> {
    OF_POINT.iter().flat_map(|column| column.shown(ResultTable::Contact))
}
