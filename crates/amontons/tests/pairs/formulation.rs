//! The coupling of pairs against an independent program: fifteen small cases (`reference/pairs`), each with its
//! weights, normals, gaps, rows, pressures, friction and displacements. They show joined rims, facing within 35°,
//! kinks, held nodes, the range of gaps, and the functions of quadratic facets.

use std::collections::{BTreeMap, BTreeSet};

use amontons::case::Case;
use amontons::contact::{ContactBoundary, Pair, PointOnBoundary};
use amontons::output::{Memory, Outcome};
use amontons::run::{self, Settings};
use serde_json::Value;

use crate::common;

/// Deviation allowed, relative to the largest value of a kind.
const TOLERANCE: f64 = 1e-9;
const FOLDER: &str = "crates/amontons/tests/reference/pairs";

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|c| c.as_f64().expect("a number")).collect()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no number {key}"))
}

/// Computed and reference values by kind, compared at the end, since the largest value of a kind is its scale.
#[derive(Default)]
struct Compared(BTreeMap<&'static str, Vec<(String, f64, f64)>>);

impl Compared {
    fn add(&mut self, kind: &'static str, place: String, computed: f64, reference: f64) {
        self.0.entry(kind).or_default().push((place, computed, reference));
    }

    fn check(&self, name: &str, scales: &BTreeMap<&str, f64>) {
        for (kind, values) in &self.0 {
            let largest = values.iter().map(|(_, _, reference)| reference.abs()).fold(0.0, f64::max);
            let scale = largest.max(scales.get(kind).copied().unwrap_or(0.0));
            for (place, computed, reference) in values {
                let off = (computed - reference).abs();
                assert!(off <= TOLERANCE * scale, "{name}, {kind} at {place}: {computed:e}, {reference:e}");
            }
        }
    }
}

/// The node with an id of the table: nodes are in the order of the file, two may be at one place.
fn node_of(id: &Value) -> usize {
    id.as_u64().expect("an id") as usize - 1
}

/// A case that has run, with the table that it is held against.
struct Run {
    name: String,
    reference: Value,
    case: Case,
    memory: Memory,
    /// Γ_C of the last step.
    boundary: ContactBoundary,
}

impl Run {
    fn new(name: &str) -> Run {
        let text = std::fs::read_to_string(common::file(&format!("{FOLDER}/{name}.json"))).expect("the reference");
        let reference = serde_json::from_str(&text).expect("a table");
        let case = common::case(&format!("{FOLDER}/{name}.toml"), &[]);
        let mut memory = Memory::new().states_every(1).reports();
        let settings = Settings { certificate: false, ..Settings::default() };
        let summary = run::run(&case.problem, &settings, &mut [&mut memory]).expect("a run");
        assert_eq!(summary.outcome, Outcome::Done, "{name}");
        let last = memory.reports.last().expect("a step").contact.boundary.clone();
        let boundary = last.map_or_else(|| case.problem.contact_boundary(), |last| (*last).clone());
        Run { name: name.to_owned(), reference, case, memory, boundary }
    }

    fn compare_nodes(&self, all: &mut Compared) {
        let mesh = &self.case.problem.mesh;
        let u = &self.memory.states.last().expect("a state").u;
        for row in self.reference["nodes"].as_array().expect("nodes") {
            let node = node_of(&row["id"]);
            let (x, at) = (numbers(&row["x"]), &mesh.points[node]);
            assert!(x.iter().zip(at).all(|(a, b)| (a - b).abs() < 1e-12), "{}: node {node} is at {at:?}", self.name);
            for (c, value) in numbers(&row["displacement"]).into_iter().enumerate() {
                all.add("displacement", format!("node {node}"), u[node * mesh.dim + c], value);
            }
        }
    }

    /// The point of a row of the table.
    fn point(&self, row: &Value) -> usize {
        let node = node_of(&row["node"]);
        let is_here = |point: &PointOnBoundary| {
            let first = point.nodes.first().map(|(node, _)| self.boundary.nodes[*node] as usize);
            point.weight > 0.0 && first == Some(node)
        };
        let found = self.boundary.points.iter().position(is_here);
        found.unwrap_or_else(|| panic!("{}: no point at node {node}", self.name))
    }

    fn compare_point(&self, i: usize, row: &Value, all: &mut Compared) {
        let (point, place) = (&self.boundary.points[i], format!("node {}", node_of(&row["node"])));
        let state = &self.memory.reports.last().expect("a step").contact.states[i];
        all.add("weight", place.clone(), point.weight, number(row, "weight"));
        all.add("pressure", place.clone(), state.pressure, number(row, "pressure"));
        all.add("clamped", place.clone(), point.clamped, number(row, "gap") - number(row, "gap_of_the_rows"));
        // Of a pairing that is made anew the gap counts from the bodies at rest, that of the table from the last step.
        if !self.case.problem.contacts[0].pair.as_ref().is_some_and(Pair::is_updated) {
            all.add("gap", place.clone(), point.gap, number(row, "gap"));
        }
        for (c, normal) in numbers(&row["normal"]).into_iter().enumerate() {
            all.add("normal", place.clone(), point.normal[c], normal);
        }
        for (c, friction) in numbers(&row["friction"]).into_iter().enumerate() {
            all.add("friction", place.clone(), state.q[c], friction);
        }
        let (own, other) = point.nodes.split_at(point.own);
        for (key, sign, entries) in [("own", 1.0, own), ("other", -1.0, other)] {
            let of = |&(node, value): &(usize, f64)| (self.boundary.nodes[node] as usize, sign * value);
            let mut found: BTreeMap<usize, f64> = entries.iter().map(of).collect();
            for entry in row[key].as_array().expect("entries") {
                let value = found.remove(&node_of(&entry[0])).unwrap_or(0.0);
                all.add("row", format!("{place}, {key}"), value, entry[1].as_f64().expect("a number"));
            }
            for value in found.into_values() {
                all.add("row", format!("{place}, {key}"), value, 0.0);
            }
        }
    }
}

fn compare(name: &str) {
    let (run, mut all) = (Run::new(name), Compared::default());
    run.compare_nodes(&mut all);
    let mut borne = BTreeSet::new();
    for row in run.reference["points"].as_array().expect("points") {
        let i = run.point(row);
        borne.insert(i);
        run.compare_point(i, row, &mut all);
    }
    let others = run.boundary.points.iter().enumerate().filter(|(i, point)| point.weight > 0.0 && !borne.contains(i));
    let others: Vec<_> = others.map(|(_, point)| point.x).collect();
    assert!(others.is_empty(), "{name}: points that are not in the table at {others:?}");
    let length = run.case.problem.mesh.points.iter().flatten().fold(0.0, |most: f64, c| most.max(c.abs()));
    let pressure = all.0["pressure"].iter().map(|(_, _, p)| p.abs()).fold(0.0, f64::max);
    all.check(name, &[("gap", 1e-3 * length), ("clamped", 1e-3 * length), ("friction", pressure)].into());
}

macro_rules! cases {
    ($($function:ident: $name:literal;)*) => { $(
        #[test]
        fn $function() {
            compare($name);
        }
    )* };
}

cases! {
    bricks: "bricks";
    bricks_with_friction: "bricks-friction";
    chamfers_of_20_degrees: "chamfer-20";
    chamfers_of_45_degrees: "chamfer-45";
    a_crosspoint: "crosspoint";
    a_foot_that_is_covered: "foot-covered";
    a_foot_of_quadratic_triangles: "foot-p2-compliance";
    a_rim_with_friction: "foot-rim-friction";
    a_foot_with_slivers: "foot-slivers";
    a_held_corner: "held-push";
    a_ring: "ring";
    a_block_that_slides_off: "slide-off";
    quadratic_tetrahedra: "tetrahedra-p2";
    a_tie: "tie";
    a_v_block: "v-block-90";
}
