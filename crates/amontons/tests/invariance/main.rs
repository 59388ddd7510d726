//! Pairs of runs that must agree: a case and the same case turned, mirrored, shifted, renumbered, in other units, later
//! in time, or said in another way. Fields and contact forces agree to 1e-10 of their largest magnitude, iteration
//! counts to 10 % or one in every second step.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod cases;
mod frame;
mod said;
mod ways;
#[path = "../mesh_files/writer.rs"]
#[allow(dead_code, reason = "the tests of mesh files use the rest")]
mod writer;

use std::collections::BTreeMap;

use amontons::case::{self, Files, Source};
use amontons::contact::ContactBoundary;
use amontons::mesh::Mesh;
use amontons::output::Memory;
use amontons::run::{Settings, run};
use amontons::state::StepReport;
use amontons::tensor::Point;
use cases::{Case, STEPS};
use frame::{Frame, Random, STEP};
use writer::Format;

const TOLERANCE: f64 = 1e-10;

/// What a run came to, in the frame of the case.
struct Outcome {
    mesh: Mesh,
    boundary: ContactBoundary,
    memory: Memory,
    frame: Frame,
}

/// Runs a case text with a mesh beside it.
fn outcome(text: &str, files: BTreeMap<String, std::sync::Arc<[u8]>>, frame: &Frame) -> Result<Outcome, String> {
    let source = Source { files: Files::Memory(files), ..Source::new("pair.toml", text) };
    let problem = case::parse(&source, &[]).map_err(|error| format!("{error}\n{text}"))?.problem;
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, threads: Some(1), ..Settings::default() };
    run(&problem, &settings, &mut [&mut memory]).map_err(|error| error.to_string())?;
    Ok(Outcome { mesh: (*problem.mesh).clone(), boundary: problem.contact_boundary(), memory, frame: frame.clone() })
}

/// The keys of `[time]` for backward Euler, for the ϑ-scheme, for BDF2, for the contact-stabilised scheme, and for
/// nodes in contact without mass.
const EULER: &str = "";
const THETA: &str = ", scheme = \"theta\", theta = 0.6, restitution = 0.3";
const BDF2: &str = ", scheme = \"bdf2\"";
const STABILISED: &str = ", scheme = \"contact-stabilised\"";
const MASSLESS: &str = ", scheme = \"theta\", mass = \"redistributed\"";

fn text(case: &Case, frame: &Frame, scheme: &str) -> String {
    let steps = STEPS + frame.later;
    format!(
        "name = \"pair\"\nmesh = {{ kind = \"file\", file = \"body.msh\", axisymmetric = {} }}\ntime = {{ end = {:?}, steps = {steps}{scheme} }}\n{}",
        case.mesh.axisymmetric,
        steps as f64 * STEP * frame.time,
        frame.text(&case.template)
    )
}

fn files(mesh: &Mesh) -> BTreeMap<String, std::sync::Arc<[u8]>> {
    let bytes = writer::write(mesh, Format { version: 4, binary: None, step: 1, spread: 1 });
    BTreeMap::from([("body.msh".to_owned(), bytes.into())])
}

fn in_frame(case: &Case, frame: &Frame, scheme: &str) -> Result<Outcome, String> {
    outcome(&text(case, frame, scheme), files(&frame.mesh(&case.mesh)), frame)
}

/// Which of some points each point of a case is, in its frame.
fn places<'a>(of: impl Iterator<Item = &'a Point>, frame: &Frame, all: &[Point]) -> Vec<usize> {
    let near = |a: &Point, b: &Point| (0..3).all(|d| (a[d] - b[d]).abs() < 1e-9 * frame.length * 4.0);
    of.map(|x| {
        let image = frame.point(x);
        all.iter().position(|y| near(y, &image)).unwrap_or_else(|| panic!("no point at {image:?}"))
    })
    .collect()
}

/// Largest difference of pairs of numbers over the largest magnitude of the first ones.
fn relative(pairs: &[(f64, f64)]) -> f64 {
    let size = pairs.iter().fold(0.0f64, |size, pair| size.max(pair.0.abs()));
    let worst = pairs.iter().fold(0.0f64, |worst, pair| {
        if (pair.0 - pair.1).is_nan() { f64::NAN } else { worst.max((pair.0 - pair.1).abs()) }
    });
    if worst == 0.0 { 0.0 } else { worst / size }
}

/// Whether every contact point has a node, or as a vertex of a pair a dual function, of its own.
fn is_unique(outcome: &Outcome) -> bool {
    outcome.boundary.points.iter().all(|point| point.own == 1 || point.nodes.len() > point.own)
}

/// p ν + q at the contact points; with Gauss points, whose tractions need not be unique where more of them stick than
/// there are nodes, the mean tractions of the nodes, Σ ω N (p ν + q)/Σ ω N.
fn tractions(outcome: &Outcome, report: &StepReport) -> Vec<Point> {
    let states = report
        .contact
        .states
        .iter()
        .map(|state| std::array::from_fn(|d| state.pressure * state.normal[d] + state.q[d]));
    if is_unique(outcome) {
        return states.collect();
    }
    let mut sums = vec![([0.0; 3], 0.0); outcome.boundary.nodes.len()];
    for (point, traction) in outcome.boundary.points.iter().zip(states) {
        for &(node, value) in &point.nodes {
            (0..3).for_each(|d| sums[node].0[d] += point.weight * value * traction[d]);
            sums[node].1 += point.weight * value;
        }
    }
    sums.into_iter().map(|(sum, weight)| sum.map(|c: f64| c / weight)).collect()
}

/// Where [`tractions`] are.
fn spots(outcome: &Outcome) -> Vec<Point> {
    let nodes = outcome.boundary.nodes.iter().map(|&node| outcome.mesh.points[node as usize]);
    if is_unique(outcome) { outcome.boundary.points.iter().map(|point| point.x).collect() } else { nodes.collect() }
}

/// What differs, if something does: of fields at all nodes and of tractions and heat fluxes on Γ_C, at all times.
fn difference(base: &Outcome, other: &Outcome) -> Result<(), String> {
    let (frame, dim) = (&other.frame, base.mesh.dim);
    let nodes = places(base.mesh.points.iter(), frame, &other.mesh.points);
    let points = places(
        base.boundary.points.iter().map(|point| &point.x),
        frame,
        &other.boundary.points.iter().map(|point| point.x).collect::<Vec<_>>(),
    );
    let spots = places(spots(base).iter(), frame, &spots(other));
    let mut pairs: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    let mut add = |name: &'static str, unit: &str, base: f64, other: f64| {
        pairs.entry(name).or_default().push((base, other / frame.unit(unit)));
    };
    // A vector of this frame in that of the case.
    let back = |v: &Point| -> Point { std::array::from_fn(|j| (0..3).map(|i| frame.q[i][j] * v[i]).sum()) };
    for (a, b) in base.memory.states.iter().zip(other.memory.states.iter().skip(frame.later)) {
        for (i, &j) in nodes.iter().enumerate() {
            for (name, unit, field, image) in [("u", "m", &a.u, &b.u), ("w", "m/s", &a.w, &b.w)] {
                let turned = back(&std::array::from_fn(|d| if d < dim { image[j * dim + d] } else { 0.0 }));
                (0..dim).for_each(|d| add(name, unit, field[i * dim + d], turned[d]));
            }
            add("theta", "K", a.theta[i], b.theta[j]);
        }
    }
    let later = &other.memory.reports[frame.later..];
    for (a, b) in base.memory.reports.iter().zip(later) {
        let (one, image) = (tractions(base, a), tractions(other, b));
        for (one, &j) in one.iter().zip(&spots) {
            let turned = back(&image[j]);
            (0..dim).for_each(|d| add("traction", "Pa", one[d], turned[d]));
        }
        for (i, &j) in points.iter().enumerate() {
            add("flux", "W/m2", a.contact.flux[i].value, b.contact.flux[j].value);
        }
    }
    let mut told: Vec<String> = pairs
        .iter()
        .map(|(name, pairs)| (name, relative(pairs)))
        .filter(|(_, d)| d.is_nan() || *d > TOLERANCE)
        .map(|(n, d)| format!("{n} by {d:.1e}"))
        .collect();
    if let Some(halved) = [&base.memory.reports[..], later].concat().iter().find(|report| report.parts > 1) {
        told.push(format!("a step in {} parts", halved.parts));
    }
    let count = |reports: &[StepReport]| {
        [reports.iter().map(|r| r.newton_mechanics).sum::<usize>(), reports.iter().map(|r| r.newton_heat).sum()]
    };
    for (a, b) in count(&base.memory.reports).into_iter().zip(count(later)) {
        // Round-off decides whether a step ends with one more.
        if a.abs_diff(b) as f64 > (0.1 * a.max(b) as f64).max(0.5 * base.memory.reports.len() as f64) {
            told.push(format!("{a} iterations against {b}"));
        }
    }
    if told.is_empty() { Ok(()) } else { Err(told.join(", ")) }
}

/// The descriptions that a case is held against, with their names.
fn frames(case: &Case, random: &mut Random) -> Vec<(&'static str, Frame)> {
    let (dim, around_axis) = (case.mesh.dim, case.mesh.axisymmetric);
    let mut frames = vec![
        ("mirrored", Frame::mirrored(dim, around_axis, random)),
        ("renumbered", Frame { numbering: Some(7), ..Frame::same() }),
        ("in mm, t, ms, °F", Frame { length: 1e3, mass: 1e-3, time: 1e3, temperature: 1.8, ..Frame::same() }),
        (
            "shifted",
            Frame {
                shift: std::array::from_fn(|d| {
                    if d < dim && !(around_axis && d == 0) { 20.0 * random.number() - 10.0 } else { 0.0 }
                }),
                ..Frame::same()
            },
        ),
        ("later", Frame { later: 5, ..Frame::same() }),
    ];
    if dim > 1 && !around_axis {
        frames.push(("turned", Frame::turned(dim, random)));
        frames.push(("turned a little", tilted(1e-6)));
        let all = Frame::turned(dim, random);
        frames.push((
            "all at once",
            Frame {
                numbering: Some(11),
                shift: [3.0, -2.0, if dim > 2 { 1.0 } else { 0.0 }],
                length: 0.3,
                mass: 7.0,
                time: 2.3,
                temperature: 0.6,
                later: 3,
                ..all
            },
        ));
    }
    frames
}

/// Turned by a small angle, which leaves components across the normal where round-off was.
fn tilted(angle: f64) -> Frame {
    let (s, c) = angle.sin_cos();
    Frame { q: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], ..Frame::same() }
}

#[test]
fn a_case_does_not_depend_on_its_description() {
    let pairs = described_otherwise(EULER, |error| panic!("{error}"));
    assert!(pairs >= 80, "{pairs} pairs");
}

/// The same in the ϑ-scheme, of all cases whose laws it takes, rigid foundations among them.
#[test]
fn a_case_does_not_depend_on_its_description_in_the_theta_scheme() {
    let pairs = described_otherwise(THETA, |error| {
        assert!(error.contains("with time.scheme = \"theta\""), "{error}");
    });
    assert!(pairs >= 60, "{pairs} pairs");
}

/// The same with BDF2, of all cases without wear, preloads and foundations that warm up.
#[test]
fn a_case_does_not_depend_on_its_description_with_bdf2() {
    let pairs = described_otherwise(BDF2, |error| {
        assert!(error.contains("with time.scheme = \"bdf2\""), "{error}");
    });
    assert!(pairs >= 60, "{pairs} pairs");
}

/// The same with the contact-stabilised scheme, of all cases that the ϑ-scheme takes and that have masses.
#[test]
fn a_case_does_not_depend_on_its_description_stabilised() {
    let pairs = described_otherwise(STABILISED, |error| {
        assert!(error.contains("with time.scheme = \"contact-stabilised\""), "{error}");
    });
    assert!(pairs >= 60, "{pairs} pairs");
}

/// The same with nodes in contact without mass, of all cases that the ϑ-scheme takes and that have layers enough.
#[test]
fn a_case_does_not_depend_on_its_description_without_mass_in_contact() {
    let pairs = described_otherwise(MASSLESS, |error| {
        assert!(error.contains("with time.scheme = \"theta\"") || error.contains("time.mass"), "{error}");
    });
    assert!(pairs >= 40, "{pairs} pairs");
}

/// Compares the descriptions of all cases that run, and returns their number; `refused` is called for others.
fn described_otherwise(scheme: &str, refused: impl Fn(&str)) -> usize {
    let (mut random, mut faults, mut pairs) = (Random(2026), Vec::new(), 0);
    for case in cases::all() {
        let base = match in_frame(&case, &Frame::same(), scheme) {
            Ok(base) => base,
            Err(error) => {
                refused(&format!("{}: {error}", case.name));
                continue;
            }
        };
        let states = base.memory.reports.iter().flat_map(|report| &report.contact.states);
        assert!(states.clone().any(|state| state.pressure > 0.0), "{}: there is contact to compare", case.name);
        assert!(
            case.mesh.dim == 1
                || states.clone().any(|state| state.bound > 0.0 && state.slip.iter().any(|s| s.abs() > 0.0)),
            "{}: there is slip to compare",
            case.name
        );
        // The first step of BDF2 is one of backward Euler, wherever it begins.
        let is_told = |frame: &Frame| scheme != BDF2 || frame.later == 0;
        for (name, frame) in frames(&case, &mut random).into_iter().filter(|(_, frame)| is_told(frame)) {
            pairs += 1;
            match in_frame(&case, &frame, scheme).and_then(|other| difference(&base, &other)) {
                Ok(()) => {}
                Err(told) => faults.push(format!("{}, {name}: {told}", case.name)),
            }
        }
    }
    assert!(faults.is_empty(), "{} of {pairs} pairs differ:\n{}", faults.len(), faults.join("\n"));
    pairs
}

#[test]
fn two_ways_to_say_one_thing_agree() {
    let (mut faults, all) = (Vec::new(), ways::all());
    for way in &all {
        let runs = [&way.one, &way.other].map(|text| {
            outcome(text, way.files.clone(), &Frame::same()).unwrap_or_else(|error| panic!("{}: {error}", way.name))
        });
        assert!(
            runs[0].memory.reports.iter().flat_map(|r| &r.contact.states).any(|state| state.pressure > 0.0),
            "{}: there is contact",
            way.name
        );
        if let Err(told) = difference(&runs[0], &runs[1]) {
            faults.push(format!("{}: {told}", way.name));
        }
    }
    assert!(faults.is_empty(), "{} of {} pairs differ:\n{}", faults.len(), all.len(), faults.join("\n"));
}
