//! The coupling of pairs against an independent program: fifteen small cases (`reference/pairs`), each with its
//! weights, normals, gaps, rows, pressures, friction and displacements. They show joined rims, facing within 35°,
//! kinks, held nodes, the range of gaps, and the functions of quadratic facets.

use std::collections::{BTreeMap, BTreeSet};

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

fn compare(name: &str) {
    let text = std::fs::read_to_string(common::file(&format!("{FOLDER}/{name}.json"))).expect("the reference");
    let reference: Value = serde_json::from_str(&text).expect("a table");
    let case = common::case(&format!("{FOLDER}/{name}.toml"), &[]);
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    let summary = run::run(&case.problem, &settings, &mut [&mut memory]).expect("a run");
    assert_eq!(summary.outcome, Outcome::Done, "{name}");
    let (mesh, last) = (&case.problem.mesh, memory.states.len() - 1);
    let node_of: BTreeMap<u64, usize> = {
        let of = |node: &Value| {
            let x = numbers(&node["x"]);
            let id = node["id"].as_u64().expect("an id");
            // Nodes are in the order of the file; two may be at one place.
            let at = &mesh.points[id as usize - 1];
            assert!(x.iter().zip(at).all(|(a, b)| (a - b).abs() < 1e-12), "{name}: node {id} is at {at:?}");
            (id, id as usize - 1)
        };
        reference["nodes"].as_array().expect("nodes").iter().map(of).collect()
    };
    let mut all = Compared::default();
    for node in reference["nodes"].as_array().expect("nodes") {
        let id = node["id"].as_u64().expect("an id");
        for (c, u) in numbers(&node["displacement"]).into_iter().enumerate() {
            all.add("displacement", format!("node {id}"), memory.states[last].u[node_of[&id] * mesh.dim + c], u);
        }
    }
    let report = &memory.reports[last - 1].contact;
    // Of a pairing that is made anew the last one.
    let before = memory.states[last - 1].u.to_vec();
    let boundary = amontons::problem::with_supports(&case.problem.displacement_space(), None, |supports| {
        let at_rest = case.problem.contact_boundary();
        let moved = at_rest.updated(&case.problem.contacts, mesh, &before, supports);
        moved.map_or(at_rest, |moved| (*moved).clone())
    });
    let mut borne = BTreeSet::new();
    for point in reference["points"].as_array().expect("points") {
        let id = point["node"].as_u64().expect("an id");
        let place = format!("node {id}");
        let is_here = |p: &amontons::contact::PointOnBoundary| {
            p.weight > 0.0 && p.nodes.first().is_some_and(|(node, _)| boundary.nodes[*node] as usize == node_of[&id])
        };
        let found = boundary.points.iter().position(is_here);
        let i = found.unwrap_or_else(|| panic!("{name}: no point at node {id}"));
        borne.insert(i);
        let (own, state) = (&boundary.points[i], &report.states[i]);
        // Of revolution the table has the weights of the circle as well.
        all.add("weight", place.clone(), own.weight, number(point, "weight"));
        all.add("pressure", place.clone(), state.pressure, number(point, "pressure"));
        let shift = if memory.states.len() > 2 && case.problem.contacts[0].pair.as_ref().is_some_and(|p| p.is_updated())
        {
            None
        } else {
            Some(number(point, "gap"))
        };
        if let Some(gap) = shift {
            all.add("gap", place.clone(), own.gap, gap);
        }
        all.add("clamped", place.clone(), own.clamped, number(point, "gap") - number(point, "gap_of_the_rows"));
        for (c, normal) in numbers(&point["normal"]).into_iter().enumerate() {
            all.add("normal", place.clone(), own.normal[c], normal);
        }
        for (c, friction) in numbers(&point["friction"]).into_iter().enumerate() {
            all.add("friction", place.clone(), state.q[c], friction);
        }
        for (key, sign, entries) in [("own", 1.0, &own.nodes[..own.own]), ("other", -1.0, &own.nodes[own.own..])] {
            let mut found: BTreeMap<usize, f64> =
                entries.iter().map(|&(node, value)| (boundary.nodes[node] as usize, sign * value)).collect();
            for entry in point[key].as_array().expect("entries") {
                let node = node_of[&entry[0].as_u64().expect("an id")];
                let value = found.remove(&node).unwrap_or(0.0);
                all.add("row", format!("{place}, {key}"), value, entry[1].as_f64().expect("a number"));
            }
            found.values().for_each(|value| all.add("row", format!("{place}, {key}"), *value, 0.0));
        }
    }
    let others = boundary.points.iter().enumerate().filter(|(i, point)| point.weight > 0.0 && !borne.contains(i));
    let others: Vec<_> = others.map(|(_, point)| point.x).collect();
    assert!(others.is_empty(), "{name}: points that are not in the table at {others:?}");
    let length = mesh.points.iter().flatten().fold(0.0, |most: f64, c| most.max(c.abs()));
    let pressure = all.0["pressure"].iter().map(|(_, _, p)| p.abs()).fold(0.0, f64::max);
    let scales = [("gap", 1e-3 * length), ("clamped", 1e-3 * length), ("friction", pressure)];
    all.check(name, &scales.into_iter().collect());
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
