//! Two deformable bodies against two independent programs: `reference/two-bodies`.

use std::collections::BTreeMap;

use crate::common;
use amontons::case::Case;
use amontons::contact::{ContactPoint, Status};
use amontons::discretization::Discretization;
use amontons::output::{Memory, Outcome, Summary};
use amontons::run::{self, Settings};
use amontons::state::{Ledger, State, StepReport};
use amontons::tensor::length;

/// Deviation allowed, relative to the scale of a group of quantities.
const TOLERANCE: f64 = 1e-8;
const FOLDER: &str = "crates/amontons/tests/reference/two-bodies";

fn read(name: &str) -> Vec<BTreeMap<String, String>> {
    let text = std::fs::read_to_string(common::file(&format!("{FOLDER}/{name}"))).expect("a table");
    let mut lines = text.lines();
    let header: Vec<String> = lines.next().expect("a header").split(',').map(str::to_owned).collect();
    lines.map(|line| header.iter().cloned().zip(line.split(',').map(str::to_owned)).collect()).collect()
}

fn number(row: &BTreeMap<String, String>, key: &str) -> f64 {
    if row[key].is_empty() { 0.0 } else { row[key].parse().unwrap_or_else(|_| panic!("{key} of {row:?}")) }
}

/// A run of a case with the state and the report of every step.
struct Run {
    case: Case,
    discretization: Discretization,
    states: Vec<State>,
    reports: Vec<StepReport>,
    summary: Summary,
}

fn run(name: &str) -> Run {
    let case = common::case(&format!("{FOLDER}/cases/{name}.toml"), &[]);
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    let summary = run::run(&case.problem, &settings, &mut [&mut memory]).expect("a run");
    assert_eq!(summary.outcome, Outcome::Done, "{name}");
    let discretization = Discretization::new(&case.problem);
    Run { case, discretization, states: memory.states, reports: memory.reports, summary }
}

/// The group whose largest value is the scale of a quantity; the quantity itself where it has none.
fn group(quantity: &str) -> String {
    let energies = ["kinetic", "elastic", "viscous", "thermal_work", "work", "numerical", "friction_work"];
    if quantity.contains("_force_") || quantity.ends_with("_normal") {
        "forces".to_owned()
    } else if energies.contains(&quantity) {
        "energies".to_owned()
    } else if quantity.starts_with("heat_") {
        "heat".to_owned()
    } else if quantity.ends_with("_heat") || quantity.ends_with("_friction_power") {
        "powers".to_owned()
    } else if quantity.contains("_ux_") || quantity.contains("_uy_") || quantity.contains("_uz_") {
        "displacements".to_owned()
    } else {
        quantity.to_owned()
    }
}

/// The quantities of the table that a run has at a step, with sums of those that it has only together.
fn reference(rows: &[&BTreeMap<String, String>]) -> BTreeMap<String, f64> {
    let all: BTreeMap<&str, f64> = rows.iter().map(|row| (row["quantity"].as_str(), number(row, "value"))).collect();
    let sum = |names: &[&str]| names.iter().filter_map(|name| all.get(name)).sum::<f64>();
    let mut values = BTreeMap::new();
    for (name, value) in &all {
        let told = ["kinetic", "elastic", "viscous", "thermal_work"].contains(name)
            || ["heat_stored", "heat_source", "heat_coupling", "heat_to_foundation", "heat_friction_interface"]
                .contains(name)
            || ["_force_", "_normal", "_open", "_stick", "_slip", "_max", "_min", "_l2"]
                .iter()
                .any(|e| name.contains(e))
                && !name.starts_with("body")
            || ["interface_heat", "foundation_heat"].contains(name)
            || name.ends_with("_friction_power")
            || name.starts_with("body") && (name.ends_with("_min") || name.ends_with("_max"));
        if told {
            values.insert((*name).to_owned(), *value);
        }
    }
    values.insert("work".to_owned(), sum(&["load_work", "reaction_work"]));
    values.insert("friction_work".to_owned(), sum(&["interface_friction_work", "foundation_friction_work"]));
    let numerical = ["kinetic_num", "elastic_num", "interface_contact_work", "foundation_contact_work"];
    values.insert("numerical".to_owned(), sum(&numerical));
    if all.contains_key("heat_in_prescribed") {
        values.insert("heat_prescribed".to_owned(), -all["heat_in_prescribed"]);
    }
    values
}

impl Run {
    /// The quantity of the table at a step.
    fn value(&self, quantity: &str, step: usize) -> f64 {
        let [before, now] = [step - 1, step].map(|n| &self.states[n].ledger);
        let change = |of: fn(&Ledger) -> f64| of(now) - of(before);
        match quantity {
            "kinetic" => now.kinetic,
            "elastic" => now.elastic,
            "viscous" => change(|l| l.viscous_dissipation),
            "thermal_work" => change(|l| l.thermal_work),
            "work" => change(|l| l.load_work),
            "friction_work" => change(|l| l.friction_dissipation),
            "numerical" => change(|l| l.scheme_dissipation + l.contact_energy),
            "heat_stored" => change(|l| l.heat_content),
            "heat_source" => change(|l| l.heat_supplied),
            "heat_coupling" => change(|l| l.heat_coupling),
            "heat_prescribed" => change(|l| l.heat_prescribed),
            "heat_to_foundation" => change(|l| l.heat_contact),
            "heat_friction_interface" => change(|l| l.heat_pairs),
            _ => match quantity.strip_prefix("body") {
                Some(rest) => self.of_body(rest, step),
                None => self.of_contact(quantity, step),
            },
        }
    }

    fn of_body(&self, rest: &str, step: usize) -> f64 {
        let (body, rest) = rest.split_once('_').expect("a body");
        let (field, take) = rest.rsplit_once('_').expect("an extreme");
        let region = body.parse::<usize>().expect("a number") - 1;
        let (mesh, state) = (&self.case.problem.mesh, &self.states[step]);
        let of_region = mesh.blocks.iter().filter(|block| block.region == region);
        let nodes = of_region.flat_map(|block| block.nodes.iter().map(|&node| node as usize));
        let at = |node: usize| match field {
            "theta" => state.theta[node],
            component => state.u[node * mesh.dim + "xyz".find(&component[1..]).expect("an axis")],
        };
        let fold: fn(f64, f64) -> f64 = if take == "min" { f64::min } else { f64::max };
        nodes.map(at).reduce(fold).expect("a node")
    }

    fn of_contact(&self, quantity: &str, step: usize) -> f64 {
        let (which, what) = quantity.split_once('_').expect("a contact");
        let points = self.points(which, step);
        let sum = |of: &dyn Fn(&Point) -> f64| points.iter().map(|p| p.weight * of(p)).sum::<f64>();
        let count = |status: Status| points.iter().filter(|p| p.status == status).count() as f64;
        match what {
            "force_x" => -sum(&|p| p.force[0]),
            "force_y" => -sum(&|p| p.force[1]),
            "force_z" => -sum(&|p| p.force[2]),
            "normal" => sum(&|p| p.pressure),
            "heat" => sum(&|p| p.heat),
            "friction_power" => sum(&|p| p.power),
            "open" => count(Status::Open),
            "stick" => count(Status::Stick),
            "slip" => count(Status::Slip),
            "pressure_max" => points.iter().map(|p| p.pressure).fold(0.0, f64::max),
            "pressure_l2" => sum(&|p| p.pressure.powi(2)).sqrt(),
            "tangential_l2" => sum(&|p| length(&p.q).powi(2)).sqrt(),
            _ => panic!("{quantity} is not compared"),
        }
    }

    /// The contact points of the pair, or of the foundation.
    fn points(&self, which: &str, step: usize) -> Vec<Point> {
        let (contact, problem) = (&self.reports[step - 1].contact, &self.case.problem);
        let side = problem.contacts.iter().position(|c| c.pair.is_some() == (which == "interface")).expect("a contact");
        let rubbing = ContactPoint { friction_power: 1.0, ..ContactPoint::default() };
        // The law is that of `on`: what does not enter it enters the other side.
        let of_on = -problem.contacts[side].heat.flux(&rubbing).value;
        let share = if problem.contacts[side].sign() > 0.0 { of_on } else { 1.0 - of_on };
        let boundary = &self.discretization.boundary;
        let of_side = boundary.points.iter().enumerate().filter(|(_, point)| point.contact == side);
        let of = |(i, point): (usize, &amontons::contact::PointOnBoundary)| {
            let state = &contact.states[i];
            let power: f64 = (0..3).map(|c| state.q[c] * state.slip[c]).sum();
            Point {
                x: point.x,
                weight: contact.weights[i],
                normal: state.normal,
                pressure: state.pressure,
                penetration: state.penetration,
                q: state.q,
                slip: state.slip,
                status: state.status,
                force: std::array::from_fn(|c| state.pressure * state.normal[c] + state.q[c]),
                heat: contact.flux[i].value + share * power,
                power,
            }
        };
        of_side.map(of).collect()
    }
}

/// A contact point after a step.
struct Point {
    x: [f64; 3],
    weight: f64,
    normal: [f64; 3],
    pressure: f64,
    penetration: f64,
    q: [f64; 3],
    slip: [f64; 3],
    status: Status,
    force: [f64; 3],
    /// Q of the exchange, without the heat of friction.
    heat: f64,
    power: f64,
}

/// Whether a count tells states: without friction, and at nodes that bear none, open or not is all that does. Nodes at
/// the rim of a side that is partly covered have no law of their own here: the curved sides of `d-hertz` are, far from
/// the contact.
fn tells(run: &Run, quantity: &str) -> bool {
    if quantity.ends_with("_open") && run.case.problem.name.starts_with("d-hertz") {
        return false;
    }
    let frictionless = run.case.problem.contacts.iter().any(|contact| contact.friction.is_frictionless());
    !((quantity.ends_with("_stick") || quantity.ends_with("_slip")) && (frictionless || run.has_smooth_points()))
}

impl Run {
    fn has_smooth_points(&self) -> bool {
        self.discretization.boundary.points.iter().any(|point| point.held != [[0.0; 3]; 3])
    }
}

const CASES: [&str; 13] = [
    "b-square-0-constant",
    "b-square-0-pressure",
    "b-square-10-constant",
    "b-square-10-pressure",
    "c-cycle",
    "c-cycle-compliance",
    "c-cycle-curved",
    "d-hertz",
    "d-hertz-friction",
    "e-rods",
    "f-rings",
    "h-bricks",
    "i-crosspoint",
];

#[test]
fn steps_agree_with_two_independent_programs() {
    let (steps, nodes) = (read("steps.csv"), read("nodes.csv"));
    for name in CASES.into_iter().chain(["i-crosspoint-matching"]) {
        let run = run(name);
        let rows: Vec<_> = steps.iter().filter(|row| row["case"] == name).collect();
        let mut by_step: BTreeMap<usize, Vec<_>> = BTreeMap::new();
        for &row in &rows {
            by_step.entry(number(row, "step") as usize).or_default().push(row);
        }
        let expected: Vec<_> = by_step.iter().map(|(&step, rows)| (step, reference(rows))).collect();
        let mut scales: BTreeMap<String, f64> = BTreeMap::new();
        for (quantity, value) in expected.iter().flat_map(|(_, values)| values) {
            let scale = scales.entry(group(quantity)).or_default();
            *scale = scale.max(value.abs());
        }
        // In a steady state the amounts cancel: what passes the pair in a step is their scale.
        let passed = scales.get("powers").copied().unwrap_or(0.0) * run.case.problem.timeline.longest();
        scales.entry("heat".to_owned()).and_modify(|scale| *scale = scale.max(passed));
        let mut compared = 0;
        for (step, values) in &expected {
            for (quantity, value) in values.iter().filter(|(quantity, _)| tells(&run, quantity)) {
                let (computed, scale) = (run.value(quantity, *step), scales[&group(quantity)]);
                let off = (computed - value).abs();
                assert!(
                    off <= TOLERANCE * scale,
                    "{name}, step {step}, {quantity}: {computed:e}, expected {value:e}, scale {scale:e}"
                );
                compared += 1;
            }
        }
        assert!(compared > 15 * expected.len(), "{name}: {compared} numbers of {} steps", expected.len());
        let last = run.states.last().expect("a state");
        assert!(last.ledger.relative_closing_error() < 1e-12, "{name}: {:e}", last.ledger.relative_closing_error());
        assert!(last.ledger.relative_heat_closing_error() < 1e-12, "{name}");
        assert_norms(name, &run, &rows);
        assert_nodes(name, &run, &nodes, &scales);
    }
}

/// The norms of the summary are those of both bodies together.
fn assert_norms(name: &str, run: &Run, rows: &[&BTreeMap<String, String>]) {
    let last = rows.iter().map(|row| number(row, "step") as usize).max().expect("a step");
    let of = |quantity: &str| {
        let both = rows.iter().filter(|row| {
            number(row, "step") as usize == last
                && row["quantity"].starts_with("body")
                && row["quantity"][6..] == *quantity
        });
        both.map(|row| number(row, "value").powi(2)).sum::<f64>().sqrt()
    };
    let norms = &run.summary.last.norms;
    for (quantity, computed) in [
        ("u_l2", norms.displacement_l2.unwrap_or(0.0)),
        ("u_v", norms.displacement_v.unwrap_or(0.0)),
        ("w_l2", norms.velocity_l2.unwrap_or(0.0)),
        ("theta_l2", norms.temperature_l2.unwrap_or(0.0)),
    ] {
        if !rows.iter().any(|row| row["quantity"].ends_with(quantity)) {
            continue;
        }
        let expected = of(quantity);
        assert!((computed - expected).abs() <= TOLERANCE * expected, "{name}, {quantity}: {computed:e}, {expected:e}");
    }
}

fn assert_nodes(name: &str, run: &Run, nodes: &[BTreeMap<String, String>], scales: &BTreeMap<String, f64>) {
    let of_case: Vec<_> = nodes.iter().filter(|row| row["case"] == name).collect();
    let (last, dim) = (run.reports.len(), run.case.problem.mesh.dim);
    let largest =
        |of: &dyn Fn(&BTreeMap<String, String>) -> f64| of_case.iter().map(|r| of(r).abs()).fold(0.0, f64::max);
    let (pressure, flux) = (largest(&|r| number(r, "pressure")), largest(&|r| number(r, "heat_flux")));
    let velocity = run.states[last].w.iter().fold(0.0, |m: f64, w| m.max(w.abs()));
    let power = largest(&|r| number(r, "friction_power"));
    let displacement = scales["displacements"];
    for which in ["interface", "foundation"] {
        let rows: Vec<_> = of_case.iter().filter(|row| row["contact"] == which).collect();
        if rows.is_empty() {
            continue;
        }
        let points = run.points(which, last);
        // Where the sides of `d-hertz` turn away from each other by more than 35° nothing faces a point.
        let turns_away = name.starts_with("d-hertz");
        assert!(turns_away || points.len() == rows.len(), "{name}: {} contact points of the {which}", points.len());
        for row in rows.into_iter().filter(|row| !turns_away || row["status"] != "open") {
            let x = ["x", "y", "z"].map(|key| number(row, key));
            let away = |p: &Point| (0..3).map(|c| (p.x[c] - x[c]).abs()).fold(0.0, f64::max);
            let point = points.iter().min_by(|a, b| away(a).total_cmp(&away(b))).expect("a point");
            assert!(away(point) < 1e-12, "{name}: no contact point at {x:?}");
            // Normals of sides that are covered in part are means by the lengths of the facets, which differ here by
            // half the square of the slope, 2e-4 at the edge of contact, between facets that turn by 1e-3.
            let tolerance = if turns_away { 1e-7 } else { TOLERANCE };
            let near = |what: &str, computed: f64, expected: f64, scale: f64| {
                assert!(
                    (computed - expected).abs() <= tolerance * scale,
                    "{name}, {what} at {x:?}: {computed:e}, expected {expected:e}, scale {scale:e}"
                );
            };
            near("weight", point.weight, number(row, "weight"), number(row, "weight"));
            near("penetration", point.penetration, number(row, "penetration"), displacement);
            near("pressure", point.pressure, number(row, "pressure"), pressure);
            near("heat flux", point.heat, number(row, "heat_flux"), flux);
            // A case without heat has no powers in the table.
            if !row["friction_power"].is_empty() {
                near("power of friction", point.power, number(row, "friction_power"), power);
            }
            if dim == 2 {
                let along = |v: &[f64; 3]| point.normal[0] * v[1] - point.normal[1] * v[0];
                near("friction", along(&point.q), number(row, "friction_1"), pressure);
                near("slip", along(&point.slip), number(row, "slip_velocity_1"), velocity);
            } else if dim == 3 {
                let size = |key: &str| number(row, &format!("{key}_1")).hypot(number(row, &format!("{key}_2")));
                near("friction", length(&point.q), size("friction"), pressure);
                near("slip", length(&point.slip), size("slip_velocity"), velocity);
            }
            let is_open = point.status == Status::Open;
            assert_eq!(is_open, row["status"] == "open", "{name}: status at {x:?}");
        }
    }
}

/// `[verify]` of every case, closed forms among them, and heat that leaves one body and enters the other.
#[test]
fn every_case_verifies() {
    assert_eq!(common::verified(&common::file(&format!("{FOLDER}/cases"))), 21);
}
