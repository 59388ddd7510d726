//! What `check` tells of a model: sizes, time scales and the cost of a step, by formulas.

use std::f64::consts::{PI, TAU};

use amontons::linalg::{Estimate, Graph, Layout};
use amontons::mesh::{Elements, Mesh};
use amontons::model::Model;
use amontons::step::{March, Scheme};

use super::{BAR, BLOCK, doubled, near, problem};

/// P1 elements of length h of a bar give ω² = (E/ρ)(6/h²)(1 − cos κh)/(2 + cos κh), κ = π/2L fixed and free, κ = π/L
/// held at both ends.
#[test]
fn time_scales_of_a_bar() {
    let lambda = |kappa: f64, h: f64| 6.0 / (h * h) * (1.0 - (kappa * h).cos()) / (2.0 + (kappa * h).cos());
    let bar = [
        "mesh={ kind = \"interval\", size = 2.0, n = 20 }",
        "material.density=2.0",
        "material.elasticity.young=8.0",
        "material.heat_capacity=3.0",
    ];
    let ends = "boundary=[{ on = \"left\", displacement = [0], temperature = 0 }, { on = \"right\", temperature = 0 }]";
    let times = |more: &[&str]| Model::new(&problem(BAR, &[&bar[..], &[ends], more].concat())).times;
    let found = times(&[]);
    near(found.first_period.expect("a period"), TAU / (4.0 * lambda(PI / 4.0, 0.1)).sqrt(), 1e-10);
    near(found.heat.expect("a time"), 3.0 / lambda(PI / 2.0, 0.1), 1e-10);
    assert!(
        (found.first_period.unwrap_or(0.0) / 4.0 - 1.0).abs() < 1e-3
            && found.retardation.is_none()
            && found.relaxation.is_empty()
    );
    let damped = times(&[
        "material.viscosity={ law = \"lame\", first = 0.0, second = 4.0 }",
        "material.prony=[{ ratio = 0.5, time = 0.25 }]",
    ]);
    assert_eq!((damped.retardation, damped.relaxation), (Some([0.5, 0.5]), vec![0.25]));
    // Nothing holds these.
    assert_eq!(times(&["boundary=[{ on = \"right\", traction = [0] }]"]).first_period, None);
    assert_eq!(times(&["boundary=[{ on = \"left\", displacement = [0] }]"]).heat, None);
    let inert = times(&["material.density=0", "material.heat_capacity=0"]);
    assert_eq!((inert.first_period, inert.heat), (None, None));
}

#[test]
fn sizes_of_a_body() {
    let model = Model::new(&problem(BLOCK, &["material.density=3.0", "mesh.origin=[1.0, -2.0]"]));
    assert_eq!(model.bounds, [vec![1.0, -2.0], vec![3.0, -1.0]]);
    near(model.mass, 6.0, 1e-13);
    near(model.sides["bottom"], 2.0, 1e-14);
    near(model.sides["left"], 1.0, 1e-14);
    assert_eq!((model.contact_points["bottom"], model.parts), (9, 1));
    // A solid cylinder of revolution, radius 2 and height 1.
    let round = ["mesh.axisymmetric=true", "material.elasticity={ law = \"isotropic\", young = 2.0, poisson = 0.2 }"];
    let model = Model::new(&problem(BLOCK, &round));
    near(model.volume, 4.0 * PI, 1e-13);
    near(model.sides["right"], 4.0 * PI, 1e-13);
    near(model.sides["bottom"], 4.0 * PI, 1e-13);
    assert_eq!(Model::new(&doubled(&problem(BLOCK, &[]), 2.0)).parts, 2);
}

/// The count is that of the factors that a run makes but for the zeros in their supernodes, and for what repeats in a
/// body that is the same everywhere. One cell of 27 nodes has a dense matrix of 81 unknowns: columns of 81, 80, …
/// entries, and Σ c² = n(n + 1)(2n + 1)/6 operations.
#[test]
fn the_cost_is_that_of_the_factors() {
    let varying = ["material.density=\"1 + x*y\"", "material.heat_capacity=\"1 + x*y\""];
    let even = |n: &str| March::new(&problem(BLOCK, &[n])).expect("factors").stored() as f64;
    let counted = |n: &str| Model::new(&problem(BLOCK, &[n])).cost.factors.iter().sum::<usize>() as f64;
    let share = |n: &str| even(n) / counted(n);
    // What repeats is stored once: the more the finer the mesh.
    assert!(share("mesh.n=[128, 64]") < 0.6 && share("mesh.n=[32, 16]") < 1.1, "{}", share("mesh.n=[128, 64]"));
    for overrides in [
        &[][..],
        &["mesh.n=[40, 20]", "mesh.elements=\"P2\""],
        &["boundary=[{ on = \"left\", displacement = [0, \"free\"] }]"],
    ] {
        let problem = problem(BLOCK, &[overrides, &varying].concat());
        let cost = Model::new(&problem).cost;
        let scheme = March::new(&problem).expect("factors");
        // S is not stored with the factor: the triangles of u and θ on Γ_C.
        let triangle = |n: usize| n * (n + 1) / 2;
        let condensed = triangle(cost.unknowns[2]) + triangle(cost.unknowns[2].div_ceil(2));
        let (counted, stored) = (cost.factors.iter().sum::<usize>() as f64, (scheme.stored() + condensed) as f64);
        assert_eq!(cost.unknowns, scheme.solvers().unknowns);
        assert!((1.0..1.6).contains(&(stored / counted)), "{stored} stored, {counted} counted");
    }
    let mesh = Mesh::box_([1.0; 3], [1; 3], Elements::Q2).expect("a mesh");
    let graph = Graph::of_mesh(&mesh);
    let layout = Layout {
        points: &mesh.points,
        components: 3,
        free: &[true; 81],
        frames: &[],
        links: &[],
        rigid: &[],
        contact: &[],
    };
    let counted = Estimate::of(&graph, layout.free, 3, &layout.ordering(&graph));
    assert_eq!((counted.unknowns, counted.entries, counted.stored), (81, 81.0 * 81.0, 81.0 * 82.0 / 2.0));
    near(counted.flops, 81.0 * 82.0 * 163.0 / 6.0, 1e-14);
}
