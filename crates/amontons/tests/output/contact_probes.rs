//! Probes of contact: at points of Γ_C they are interpolated from the contact points, over sides they are sums over
//! them.

use amontons::case::{self, Case, Source};
use amontons::output::{OutputError, ProbeSet, Sink, Snapshot};
use amontons::run::{Settings, run};

const BODY: &str = body!(
    "MESH",
    "end = 0.2, steps = 2",
    1,
    "young = 2.0, poisson = 0.3STATE",
    r#"
viscosity = { law = "lame", first = 1, second = 1 }
heat_capacity = 1
conductivity = 1
[[boundary]]
on = "top"
displacement = TOP
[contact]
on = "bottom"
quadrature = "QUADRATURE"
foundation_velocity = BELT
normal = { law = "compliance", stiffness = "STIFFNESS" }
friction = { law = "coulomb", coefficient = 0.25 }
wear = { law = "archard", coefficient = 1e-3 }
"#
);

fn body(mesh: &str, dim: usize, quadrature: &str, probes: &str) -> Case {
    let (top, belt) =
        if dim == 2 { ("[0, \"-0.1*t*(1 + x)\"]", "[1, 0]") } else { ("[0, \"-0.1*t*(1 + x)\", 0]", "[0.6, 0, 0.8]") };
    let text = BODY
        .replace("MESH", mesh)
        .replace("STATE", if dim == 2 { ", stress_state = \"plane-stress\"" } else { "" })
        .replace("TOP", top)
        .replace("BELT", belt)
        .replace("QUADRATURE", quadrature)
        .replace("\"STIFFNESS\"", "100");
    case::parse(&Source::new("body.toml", text + probes), &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// The values of the probes at the end, by the names of their columns, and the contact points: position, weight,
/// pressure, traction, slip and wear.
#[derive(Default)]
struct End {
    probes: Option<ProbeSet>,
    values: Vec<(String, f64)>,
    points: Vec<([f64; 3], f64, f64, [f64; 3], [f64; 3], f64)>,
}

impl End {
    fn of(case: &Case) -> End {
        let mut end = End { probes: Some(ProbeSet::new(&case.problem, &case.probes).unwrap()), ..End::default() };
        run(&case.problem, &Settings::default(), &mut [&mut end]).unwrap();
        end
    }

    fn value(&self, name: &str) -> f64 {
        self.values
            .iter()
            .find(|(known, _)| known == name)
            .unwrap_or_else(|| panic!("no {name} in {:?}", self.values))
            .1
    }
}

impl Sink for End {
    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        let probes = self.probes.as_ref().unwrap();
        self.values = probes.columns().iter().cloned().zip(probes.values(now)).collect();
        let (states, surface) = (&now.report.unwrap().contact.states, &now.state.surface);
        let points = now.discretization.boundary.points.iter().zip(states).zip(&surface.wear);
        self.points = points
            .map(|((point, state), wear)| {
                (point.x, point.weight, state.pressure, state.q.map(|q| -q), state.slip, *wear)
            })
            .collect();
        Ok(())
    }
}

const PROBES: &str = r#"
    [[probe]]
    name = "p"
    quantity = "pressure"
    at = AT
    [[probe]]
    name = "q"
    quantity = "traction"
    at = AT
    [[probe]]
    name = "v"
    quantity = "slip_velocity_magnitude"
    at = AT
    [[probe]]
    name = "load"
    quantity = "pressure"
    on = "bottom"
    take = "integral"
    [[probe]]
    name = "drag"
    quantity = "traction"
    on = "bottom"
    take = "integral"
    [[probe]]
    name = "worn"
    quantity = "wear"
    on = "bottom"
    take = "max"
    [[probe]]
    name = "area"
    quantity = "touching"
    on = "bottom"
    take = "integral"
"#;

/// At a node, and between two, on linear and quadratic facets: the value of the shape functions.
#[test]
fn values_at_points_are_interpolated() {
    let meshes = [
        (2, "kind = 'rectangle', size = [1, 1], n = [4, 4], elements = 'P1'", "[0.25, 0]", vec![(0.25, 0.0, 1.0)]),
        (
            2,
            "kind = 'rectangle', size = [1, 1], n = [4, 4], elements = 'Q1'",
            "[0.3, 0]",
            vec![(0.25, 0.0, 0.8), (0.5, 0.0, 0.2)],
        ),
        // N at 1/4 of a quadratic segment: 3/8, 3/4, −1/8.
        (
            2,
            "kind = 'rectangle', size = [1, 1], n = [2, 2], elements = 'Q2'",
            "[0.125, 0]",
            vec![(0.0, 0.0, 0.375), (0.25, 0.0, 0.75), (0.5, 0.0, -0.125)],
        ),
        (
            3,
            "kind = 'box', size = [1, 1, 1], n = [2, 2, 2], elements = 'Q1'",
            "[0.25, 0, 0.5]",
            vec![(0.0, 0.5, 0.5), (0.5, 0.5, 0.5)],
        ),
    ];
    for (dim, mesh, at, terms) in meshes {
        let end = End::of(&body(mesh, dim, "nodal", &PROBES.replace("AT", at)));
        let of = |x: f64, z: f64| {
            end.points.iter().find(|p| (p.0[0] - x).abs() < 1e-12 && (p.0[2] - z).abs() < 1e-12).unwrap()
        };
        let sum = |f: &dyn Fn(f64, f64) -> f64| terms.iter().map(|&(x, z, n)| n * f(x, z)).sum::<f64>();
        let near = |name: &str, expected: f64| {
            assert!((end.value(name) - expected).abs() < 1e-13, "{mesh}, {name}: {} for {expected}", end.value(name));
        };
        near("p", sum(&|x, z| of(x, z).2));
        near("q_x", sum(&|x, z| of(x, z).3[0]));
        near("load", end.points.iter().map(|p| p.1 * p.2).sum());
        near("drag_x", end.points.iter().map(|p| p.1 * p.3[0]).sum());
        near("worn", end.points.iter().map(|p| p.5).fold(0.0, f64::max));
        near("area", 1.0);
        assert!(end.value("load") > 0.0 && end.value("worn") > 0.0, "it is pressed and rubbed");
        // The belt is faster than the body: friction pulls along, at the bound.
        let mu = end.value("drag_x").hypot(if dim == 3 { end.value("drag_z") } else { 0.0 }) / end.value("load");
        assert!((mu - 0.25).abs() < 1e-3, "{mu}");
    }
}

/// With Gauss quadrature a value at a point is that of the contact point next to it.
#[test]
fn values_next_to_gauss_points() {
    let end =
        End::of(&body("kind = 'rectangle', size = [1, 1], n = [4, 4]", 2, "gauss", &PROBES.replace("AT", "[0.3, 0]")));
    // Those of [1/4, 1/2] are at 3/8 ∓ 1/(8√3).
    let nearest = end.points.iter().find(|p| (p.0[0] - (0.375 - 0.125 / 3f64.sqrt())).abs() < 1e-12).unwrap();
    assert_eq!(end.value("p").to_bits(), nearest.2.to_bits());
    assert_eq!(end.value("v").to_bits(), nearest.4[0].abs().to_bits());
}

#[test]
fn elsewhere_there_is_no_contact() {
    for (at, whole) in [("at = [0.3, 0.1]", "at"), ("at = [0.0, 0.25]", "at"), ("on = 'top'\ntake = 'max'", "on")] {
        let probe = format!("[[probe]]\nname = 'p'\nquantity = 'slip_velocity_x'\n{at}\n");
        let text = BODY
            .replace("MESH", "kind = 'rectangle', size = [1, 1], n = 4")
            .replace("STATE", ", stress_state = \"plane-stress\"")
            .replace("TOP", "[0, 0]")
            .replace("BELT", "[1, 0]");
        let text = text.replace("QUADRATURE", "nodal").replace("\"STIFFNESS\"", "100") + &probe;
        let error = case::parse(&Source::new("body.toml", text), &[]).unwrap_err().to_string();
        assert!(error.contains("slip_velocity_x elsewhere than on a side of a contact"), "{whole}: {error}");
    }
}
