//! A half-plane pressed on a rigid cylinder to which it sticks, against the closed form of Spence (Proc. R. Soc. A 305,
//! 1968): quadratic elements, every node sticks where the body is when the contact reaches it.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use amontons::case::{self, Files, Source};
use amontons::mesh::{Diagonal, Elements, Mesh};
use amontons::output::Memory;
use amontons::run::{Settings, run};

#[path = "../mesh_files/writer.rs"]
#[allow(dead_code, reason = "the tests of mesh files use the rest")]
pub mod writer;

const POISSON: f64 = 0.3;
const RADIUS: f64 = 5000.0;

/// Half of a block of 200 × 200, cells of size h where it touches, growing by 1.3 beyond.
fn block(h: f64) -> Mesh {
    let lines = |fine: f64| {
        let (mut lines, mut step) = (vec![0.0], h);
        while lines[lines.len() - 1] < 200.0 {
            let last = lines[lines.len() - 1];
            if last > fine - 1e-9 {
                step *= 1.3;
            }
            lines.push(last + step);
        }
        lines
    };
    let [x, y] = [1.3, 0.4].map(lines);
    let mut mesh = Mesh::rectangle_of(
        Elements::P1,
        [x.len() as f64 - 1.0, y.len() as f64 - 1.0],
        [x.len() - 1, y.len() - 1],
        Diagonal::Right,
    )
    .expect("a rectangle");
    mesh.points.iter_mut().for_each(|p| *p = [x[p[0].round() as usize], y[p[1].round() as usize], 0.0]);
    mesh.quadratic().expect("a quadratic mesh")
}

/// E/(1 − ν²) = 1.
const CASE: &str = body!(
    r#"kind = "file", file = "block.msh""#,
    "end = 1, steps = 100",
    0,
    r#"young = 0.91, poisson = 0.3, stress_state = "plane-strain""#,
    r#"
[[boundary]]
on = "left"
normal_displacement = 0
[[boundary]]
on = "top"
displacement = ["free", "-0.00062*t"]
[contact]
on = "bottom"
obstacle = { shape = "cylinder", center = [0, -5000], radius = 5000 }
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 1e3 }
"#
);

/// ∫ f over (0, b) by the midpoint rule.
fn integral(b: f64, n: usize, f: impl Fn(f64) -> f64) -> f64 {
    (0..n).map(|i| f(b * (i as f64 + 0.5) / n as f64)).sum::<f64>() * b / n as f64
}

/// η, and the factor K of p + iq = K ∫ c (c² − x²)^(−½) ((c + x)/(c − x))^(iη) dc: stuck punches of half width c, one
/// after the other, whose slopes at their edges are that of the cylinder.
fn constants() -> (f64, f64) {
    let eta = (3.0 - 4.0 * POISSON).ln() / (2.0 * PI);
    let slope = 1.0 - 2.0 * eta * integral(40.0, 4000, |u| (2.0 * eta * u).sin() / u.cosh());
    (eta, (PI * eta).cosh() / (2.0 * RADIUS * slope))
}

/// p and q at x < a.
fn exact(x: f64, a: f64) -> [f64; 2] {
    let (eta, k) = constants();
    let angle = |w: f64| 2.0 * eta * (x / w).asinh();
    let width = (a * a - x * x).sqrt();
    [k * integral(width, 400, |w| angle(w).cos()), k * integral(width, 400, |w| angle(w).sin())]
}

/// Largest errors of p and q at x < 0.8 a, at the nodes and of the means about vertices, over the largest pressure.
fn errors(h: f64, steps: usize) -> [[f64; 2]; 2] {
    let bytes = writer::write(&block(h), writer::Format { version: 4, binary: None, step: 1, spread: 1 });
    let files = Files::Memory(BTreeMap::from([("block.msh".to_owned(), bytes.into())]));
    let source = Source { files, ..Source::new("stuck.toml", CASE) };
    let problem =
        case::parse(&source, &[format!("time.steps={steps}")]).unwrap_or_else(|error| panic!("{error}")).problem;
    let mut memory = Memory::new().reports();
    run(&problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut memory])
        .unwrap_or_else(|error| panic!("{error}"));
    let (boundary, states) = (problem.contact_boundary(), &memory.reports.last().expect("a step").contact.states);
    // The load of the other half too; P = K a² π/(2 cosh πη).
    let load =
        2.0 * boundary.points.iter().zip(states).map(|(point, state)| point.weight * state.pressure).sum::<f64>();
    let (eta, k) = constants();
    let a = (2.0 * load * (PI * eta).cosh() / (PI * k)).sqrt();
    let means = boundary.vertex_means(&problem.mesh, 0, &problem.mesh.facets["bottom"]);
    let alone: Vec<Vec<(usize, f64)>> = (0..boundary.points.len()).map(|i| vec![(i, 1.0)]).collect();
    [alone, means].map(|all| {
        let mut worst = [0.0f64; 2];
        for shares in &all {
            let mean = |value: &dyn Fn(usize) -> f64| shares.iter().map(|&(i, share)| share * value(i)).sum::<f64>();
            let x = mean(&|i| boundary.points[i].x[0]);
            // About x = 0 the other half is missing.
            if x > h / 2.0 && x < 0.8 * a {
                let found = [mean(&|i| states[i].pressure), mean(&|i| -states[i].q[0])];
                (0..2).for_each(|c| worst[c] = worst[c].max((found[c] - exact(x, a)[c]).abs() / (k * a)));
            }
        }
        worst
    })
}

/// The traction alternates between vertices and middle nodes by some hundredths of the largest pressure, since the edge
/// of contact advances from node to node and the body sticks where it is then; this falls slowly with h. Its means
/// about the vertices are those of the closed form, and converge.
#[test]
fn means_about_vertices_are_the_closed_form() {
    let [[_, zigzag], coarse] = errors(0.2, 120);
    let [[_, finer], fine] = errors(0.1, 240);
    assert!(zigzag > 0.02 && finer > 0.02, "the nodes alternate: {zigzag}, {finer}");
    let orders = [0, 1].map(|c| (coarse[c] / fine[c]).log2());
    assert!(orders.iter().all(|order| *order > 0.8), "orders {orders:?}, errors {coarse:?}, {fine:?}");
    // The cell at the edge bears (h/a)^(3/2) of the load, which the mesh may misplace over the contact: 0.03 in the
    // mean for h = a/10.
    assert!(fine[0] < 0.03 && fine[1] < 0.2 * finer, "{fine:?}, {finer}");
}
