//! A solution in closed form of two bodies that stick to each other and exchange heat: errors and their orders, which
//! two independent programs have as well (`reference/two-bodies/convergence.csv`).

use std::collections::BTreeMap;
use std::f64::consts::PI;

use crate::common;
use amontons::case::{self, Source};
use amontons::element::ShapeTable;
use amontons::mesh::CellMap;
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{self, Settings};
use amontons::state::{State, StepReport};

/// λ and 2G of both bodies, conductivities of the lower and the upper one, conductance of the joint.
const LAME: [f64; 2] = [1.2, 1.6];
const CONDUCTIVITY: [f64; 2] = [1.5, 0.7];
const CONDUCTANCE: f64 = 3.0;

/// u = (0.02 sin(πx) y, −0.3 y + 0.03 cos(πx) y²) in both bodies.
fn displacement(x: f64, y: f64) -> [f64; 2] {
    [0.02 * (PI * x).sin() * y, -0.3 * y + 0.03 * (PI * x).cos() * y * y]
}

/// ε_xx, ε_yy, ε_xy.
fn strain(x: f64, y: f64) -> [f64; 3] {
    let (s, c) = (PI * x).sin_cos();
    [0.02 * PI * c * y, -0.3 + 0.06 * c * y, 0.5 * (0.02 * s - 0.03 * PI * s * y * y)]
}

/// cos(πx) (y + ½) above, cos(πx) (1 − K₂/h + K₂/K₁ (y − ½)) below.
fn temperature(x: f64, y: f64, is_above: bool) -> f64 {
    let [below, above] = CONDUCTIVITY;
    let factor = if is_above { y + 0.5 } else { 1.0 - above / CONDUCTANCE + above / below * (y - 0.5) };
    (PI * x).cos() * factor
}

fn text([n_upper, n_lower]: [usize; 2], nonmortar: &str) -> String {
    let [lambda, two_g] = LAME;
    let [below, above] = CONDUCTIVITY;
    let poisson = lambda / (2.0 * lambda + two_g);
    let young = two_g * (1.0 + poisson);
    // −div σ.
    let along = lambda * (0.02 * PI * PI + 0.06 * PI) + two_g * 0.02 * PI * PI + 0.5 * two_g * 0.06 * PI;
    let across = -(0.5 * two_g * 0.02 * PI + lambda * (0.02 * PI + 0.06) + two_g * 0.06);
    let across_y = 0.5 * two_g * 0.03 * PI * PI;
    let shear = format!("{:?}*(0.02*sin(pi*x) - 0.03*pi*sin(pi*x)*y^2)", 0.5 * two_g);
    let normal = format!("{lambda:?}*(0.02*pi*cos(pi*x)*y - 0.3 + 0.06*cos(pi*x)*y) + {two_g:?}*0.02*pi*cos(pi*x)*y");
    let lower_theta = format!("(1 - {:?} + {:?}*(y - 0.5))", above / CONDUCTANCE, above / below);
    let u = "[\"0.02*sin(pi*x)*y\", \"-0.3*y + 0.03*cos(pi*x)*y^2\"]";
    let mut text = format!(
        "name = \"orders\"\n[mesh]\nkind = \"blocks\"\n\
         [[mesh.blocks]]\nname = \"lower\"\nsize = [1.0, 0.5]\nn = [{n_lower}, {}]\n\
         [[mesh.blocks]]\nname = \"upper\"\nsize = [1.0, 0.5]\nn = [{n_upper}, {}]\norigin = [0.0, 0.5]\n\
         [time]\nend = 1.0\nsteps = 1\n[material]\n",
        n_lower / 2,
        n_upper / 2
    );
    for (head, conductivity) in [("", below), ("[[region]]\non = \"upper\"\n[region.material]\n", above)] {
        text += &format!(
            "{head}density = 0\nheat_capacity = 0\nconductivity = {conductivity:?}\n\
             elasticity = {{ law = \"isotropic\", young = {young:?}, poisson = {poisson:?}, stress_state = \"plane-strain\" }}\n"
        );
    }
    text += &format!(
        "[load]\nbody_force = [\"{along:?}*y*sin(pi*x)\", \"({across:?} + {across_y:?}*y^2)*cos(pi*x)\"]\n\
         heat_source = \"pi^2*cos(pi*x)*if(y < 0.5, {below:?}*{lower_theta}, {above:?}*(y + 0.5))\"\n"
    );
    for body in ["lower", "upper"] {
        for (side, sign) in [("left", "-"), ("right", "")] {
            text += &format!(
                "[[boundary]]\non = \"{body}_{side}\"\ntraction = [\"{sign}({normal})\", \"{sign}({shear})\"]\n"
            );
        }
    }
    text + &format!(
        "[[boundary]]\non = \"lower_bottom\"\ndisplacement = {u}\ntemperature = \"cos(pi*x)*{lower_theta}\"\n\
         [[boundary]]\non = \"upper_top\"\ndisplacement = {u}\ntemperature = \"cos(pi*x)*(y + 0.5)\"\n\
         [contact]\non = \"upper_bottom\"\nwith = \"lower_top\"\nnonmortar = \"{nonmortar}\"\n\
         normal = {{ law = \"signorini\" }}\nfriction = {{ law = \"coulomb\", coefficient = 0.6 }}\n\
         heat = {{ law = \"constant\", conductance = {CONDUCTANCE:?} }}\n"
    )
}

/// Errors in the norms of the table.
fn errors(problem: &Problem, state: &State, report: &StepReport) -> BTreeMap<&'static str, f64> {
    let mut sums = [0.0; 3];
    for block in &problem.mesh.blocks {
        let table = ShapeTable::new(block.element, 6);
        let mut map = CellMap::new(&problem.mesh, &table);
        for (cell, q) in block.cells().flat_map(|cell| (0..table.len()).map(move |q| (cell, q))) {
            map.at(cell, q);
            let ([x, y, _], weight) = (map.position, table.weights[q] * map.measure);
            let (mut u, mut theta, mut epsilon) = ([0.0; 2], 0.0, [0.0; 3]);
            for ((&node, value), g) in cell.iter().zip(map.values()).zip(&map.gradients) {
                let at = |c: usize| state.u[2 * node as usize + c];
                (0..2).for_each(|c| u[c] += value * at(c));
                theta += value * state.theta[node as usize];
                epsilon[0] += g[0] * at(0);
                epsilon[1] += g[1] * at(1);
                epsilon[2] += 0.5 * (g[1] * at(0) + g[0] * at(1));
            }
            let (exact_u, exact_e) = (displacement(x, y), strain(x, y));
            let off = |c: usize| (epsilon[c] - exact_e[c]).powi(2);
            sums[0] += weight * (0..2).map(|c| (u[c] - exact_u[c]).powi(2)).sum::<f64>();
            sums[1] += weight * (off(0) + off(1) + 2.0 * off(2));
            sums[2] += weight * (theta - temperature(x, y, block.region == 1)).powi(2);
        }
    }
    let boundary = problem.contact_boundary();
    let (mut pressure, mut friction, mut flux) = (0.0, 0.0, 0.0);
    for (i, point) in boundary.points.iter().enumerate() {
        let (x, state) = (point.x[0], &report.contact.states[i]);
        let [xx, yy, xy] = strain(x, 0.5);
        let exact = [-(LAME[0] * (xx + yy) + LAME[1] * yy), LAME[1] * xy];
        pressure += point.weight * (state.pressure - exact[0]).powi(2);
        // σν = −p ν − q on the side of the point: σ_xy ν_y = −q_x.
        let q = -state.q[0] * point.normal[1];
        friction += point.weight * (q - exact[1]).powi(2);
        let out = point.normal[1] * -CONDUCTIVITY[1] * (PI * x).cos();
        flux += point.weight * (report.contact.flux[i].value - out).powi(2);
    }
    let all = [sums[0], sums[1], sums[2], pressure, friction, flux].map(f64::sqrt);
    ["u_l2", "u_v", "theta_l2", "pressure_l2", "friction_l2", "heat_flux_l2"].into_iter().zip(all).collect()
}

fn solved(n: [usize; 2], nonmortar: &str) -> BTreeMap<&'static str, f64> {
    let text = text(n, nonmortar);
    let problem =
        case::parse(&Source::new("orders.toml", &text), &[]).unwrap_or_else(|e| panic!("{e}\n{text}")).problem;
    let mut memory = Memory::new().reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    run::run(&problem, &settings, &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    errors(&problem, memory.states.last().expect("a state"), &memory.reports[0])
}

/// P1: displacement 2 in L² and 1 in energy, temperature and heat flux 2, pressure and friction 1.2 to 1.5; the errors
/// are those of the table to 2 %, which leaves room for other quadratures of the loads.
#[test]
fn errors_and_orders_are_those_of_two_independent_programs() {
    let table = std::fs::read_to_string(common::file("crates/amontons/tests/reference/two-bodies/convergence.csv"));
    let table = table.expect("the table");
    for (side, nonmortar) in [("upper", "upper_bottom"), ("lower", "lower_top")] {
        let levels = [[8, 6], [16, 12], [32, 24]];
        let all: Vec<_> = levels.iter().map(|&n| solved(n, nonmortar)).collect();
        for ([n, _], found) in levels.iter().zip(&all) {
            for (quantity, error) in found {
                let head = format!("{side},{n},{},{quantity},", n * 3 / 4);
                let line = table.lines().find_map(|line| line.strip_prefix(&head)).unwrap_or_else(|| panic!("{head}"));
                let expected: f64 = line.split(',').next().expect("a number").parse().expect("a number");
                assert!((error / expected - 1.0).abs() < 0.02, "{head} {error:e}, expected {expected:e}");
            }
        }
        for (quantity, least) in [
            ("u_l2", 1.9),
            ("u_v", 0.95),
            ("theta_l2", 1.9),
            ("pressure_l2", 1.25),
            ("friction_l2", 1.35),
            ("heat_flux_l2", 1.85),
        ] {
            let order = (all[1][quantity] / all[2][quantity]).log2();
            assert!(order > least, "{quantity}, {side}: order {order}");
        }
    }
}
