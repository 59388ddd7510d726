//! Derivatives of runs of bodies that change with the temperature, of nonlinear ones, of sectors and rigid parts, of
//! coupled half-steps, of steady states and of heat alone, held to differences of whole runs and to formulas.

use super::gradient::{TURNED, by_keys};
use super::series::check_within;

fn check_by_runs(text: &str, outputs: &[&str], keys: &[&str]) {
    check_within(4e-3, text, outputs, keys);
}

const OUTPUTS: [&str; 6] =
    ["corner_x", "stress", "pressure", "warm", "final.contact.force.1", "energy.friction_dissipation"];
const BRANCHES: &str = "prony = [{ ratio = 0.4, time = 0.3 }]\n";
const TABLE: &str = "young = { temperature = [-10.0, 20.0], value = [130.0, 70.0] }";

/// The body of which all numbers depend on the temperature.
fn warm() -> String {
    let changes = [
        ("young = 100.0", TABLE),
        ("heat_capacity = 2.0", "heat_capacity = { temperature = [-10.0, 20.0], value = [1.0, 4.0] }"),
        ("expansion = 1.5", "expansion = { temperature = [-10.0, 20.0], value = [1.0, 2.5] }"),
        ("conductivity = 0.8", "conductivity = { temperature = [-10.0, 20.0], value = [0.3, 1.8] }"),
        ("second = 0.5", "second = { temperature = [-10.0, 20.0], value = [0.9, 0.1] }"),
    ];
    changes.iter().fold(TURNED.replace(BRANCHES, ""), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

const OF_TABLES: [&str; 6] = [
    "material.elasticity.young.value[1]",
    "material.heat_capacity.value[0]",
    "material.expansion.value[1]",
    "material.conductivity.value[1]",
    "material.viscosity.second.value[0]",
    "contact.friction.static",
];

/// The table of each number is a parameter, by every scheme.
#[test]
fn runs_of_warm_bodies_have_the_slopes_of_differences() {
    check_by_runs(&warm(), &OUTPUTS, &OF_TABLES);
    let scheme = |text: &str, scheme: &str| text.replace("[time]", &format!("[time]\nscheme = {scheme}"));
    let keys = ["material.heat_capacity.value[0]", "material.conductivity.value[1]", "initial.temperature", "time.end"];
    check_by_runs(&scheme(&warm(), "\"theta\"\ntheta = 0.6"), &OUTPUTS, &keys);
    let wear = TURNED.lines().find(|line| line.starts_with("wear")).expect("wear");
    check_by_runs(&scheme(&warm().replace(wear, ""), "\"bdf2\""), &OUTPUTS, &keys);
}

/// An elastic law of which the shear falls with the strain.
#[test]
fn runs_of_nonlinear_bodies_have_the_slopes_of_differences() {
    let line = "law = \"isotropic\", young = 100.0, poisson = 0.3,";
    let hencky = "law = \"hencky\", bulk = 90.0, shear = 45.0, shear_infinite = 20.0, strain = 0.01, exponent = 0.5,";
    let text = TURNED.replace(line, hencky).replace(BRANCHES, "");
    assert!(text.contains("hencky"));
    let keys = ["material.elasticity.bulk", "material.elasticity.shear", "material.elasticity.strain", "contact.gap"];
    check_by_runs(&text, &OUTPUTS, &keys);
    check_by_runs(&text.replace("[time]", "[time]\nscheme = \"theta\"\ntheta = 0.5"), &OUTPUTS, &keys[..2]);
}

/// Both half-steps at once, by both iterations, with numbers that depend on the temperature and without.
#[test]
fn runs_of_coupled_half_steps_have_the_slopes_of_differences() {
    let coupled = |text: &str, by: &str| format!("{text}[scheme]\ncoupling = \"{by}\"\n");
    let keys = ["material.expansion", "contact.heat.exponent", "initial.temperature"];
    check_by_runs(&coupled(TURNED, "monolithic"), &OUTPUTS, &keys);
    check_by_runs(&coupled(TURNED, "monolithic"), &OUTPUTS[2..], &["material.coupling"]);
    check_by_runs(&coupled(TURNED, "fixed-point"), &OUTPUTS, &keys[..2]);
    // The temperature of the half-steps of mechanics is extrapolated by the rate of the step before.
    let keys = ["material.expansion", "material.conductivity", "initial.temperature", "time.end"];
    for scheme in ["\"euler\"", "\"theta\"\ntheta = 0.5"] {
        let text = TURNED.replace("[time]", &format!("[time]\nscheme = {scheme}"));
        check_by_runs(&coupled(&text, "extrapolated"), &OUTPUTS, &keys);
    }
    let theta = warm().replace("[time]", "[time]\nscheme = \"theta\"\ntheta = 0.7");
    check_by_runs(&coupled(&theta, "monolithic"), &OUTPUTS, &OF_TABLES[1..4]);
    check_by_runs(&coupled(&warm(), "monolithic"), &OUTPUTS, &OF_TABLES[..3]);
}

/// A quarter of a ring that is pressed from inside into a bore that turns, with heat and Maxwell branches.
const SECTOR: &str = r#"
name = "sector"
units = "dimensionless"
[mesh]
kind = "ring"
radii = [1.0, 2.0]
angle = 1.5707963267948966
n = [2, 4]
elements = "Q1"
[time]
end = 1.0
steps = 4
[material]
density = 1.0
heat_capacity = 1.0
expansion = 0.5
coupling = 0.3
conductivity = 0.8
elasticity = { law = "isotropic", young = 100.0, poisson = 0.3, stress_state = "plane-strain" }
viscosity = { law = "lame", first = 0.2, second = 0.5 }
prony = [{ ratio = 0.4, time = 0.3 }]
[[cyclic]]
sides = ["start", "end"]
[load]
heat_source = 1.5
[initial]
temperature = 1.0
[[boundary]]
on = "inner"
pressure = "30*t*(2 + 0.3*(x^4 - 6*x^2*y^2 + y^4)/(x^2 + y^2)^2)"
spring = 30
temperature = "1 + t"
[contact]
on = "outer"
gap = 0.01
normal = { law = "compliance", stiffness = 1e3 }
friction = { law = "coulomb", coefficient = 0.3 }
foundation_velocity = ["-y", "x"]
frictional_heat = 0.5
heat = { law = "constant", conductance = 0.7, foundation_temperature = 0.5 }
[[probe]]
name = "corner"
quantity = "displacement"
at = [1.5, 0.0]
[[probe]]
name = "pressure"
quantity = "pressure"
on = "outer"
take = "mean"
[[probe]]
name = "warm"
quantity = "temperature"
on = "outer"
take = "max"
"#;

/// Nodes that follow others, turned.
#[test]
fn runs_of_sectors_have_the_slopes_of_differences() {
    let outputs = ["corner_x", "corner_y", "pressure", "warm", "energy.friction_dissipation"];
    let keys = ["material.elasticity.young", "contact.friction.coefficient", "material.expansion", "contact.gap"];
    check_by_runs(SECTOR, &outputs, &keys);
    let rigid = SECTOR.replace("{ law = \"compliance\", stiffness = 1e3 }", "{ law = \"signorini\" }");
    check_by_runs(&rigid, &outputs, &keys[..3]);
}

/// A block with a rigid punch on it that leans, on a layer and on a rigid belt.
const PUNCH: &str = r#"
name = "punch"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [{ name = "body", size = [1.0, 0.5], n = [4, 2], diagonal = "right", turn = { angle = 0.4 } }]
[time]
end = 1.0
steps = 5
[material]
density = 1.3
elasticity = { law = "isotropic", young = 100.0, poisson = 0.3, stress_state = "plane-strain" }
viscosity = { law = "lame", first = 0.2, second = 0.5 }
[[rigid]]
on = "body_top"
force = ["0.2 + 0.1*t", "-1.6*t"]
moment = ["0.04*t"]
[[boundary]]
on = "body_left"
spring = 30.0
[contact]
on = "body_bottom"
gap = 0.0
normal = { law = "compliance", stiffness = 300.0 }
friction = { law = "coulomb", coefficient = 0.3 }
foundation_velocity = ["0.2*cos(0.4)", "0.2*sin(0.4)"]
[[probe]]
name = "corner"
quantity = "displacement"
at = [0.0, 0.0]
[[probe]]
name = "stress"
quantity = "von_mises"
at = [0.3, 0.4]
[[probe]]
name = "pressure"
quantity = "pressure"
on = "body_bottom"
take = "integral"
"#;

/// Nodes that move as a rigid body under a force and a moment, and with a prescribed motion.
#[test]
fn runs_with_rigid_parts_have_the_slopes_of_differences() {
    let outputs = ["corner_x", "corner_y", "stress", "pressure", "final.contact.force.0"];
    let keys = ["material.elasticity.young", "material.density", "contact.friction.coefficient"];
    check_by_runs(PUNCH, &outputs, &keys);
    let driven = "[[boundary]]\non = \"body_top\"\ndisplacement = [\"free\", \"-0.01*t\"]\n[contact]";
    check_by_runs(&PUNCH.replace("[contact]", driven), &outputs, &keys[..2]);
    let rigid = PUNCH.replace("{ law = \"compliance\", stiffness = 300.0 }", "{ law = \"signorini\" }");
    check_by_runs(&rigid.replace("gap = 0.0", "gap = -0.001"), &outputs, &keys);
}

/// Heat alone, with numbers that depend on the temperature.
const HOT: &str = r#"
name = "hot"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 0.5]
n = [6, 3]
diagonal = "right"
[time]
end = 1.0
steps = 6
[material]
heat_capacity = { temperature = [0.0, 10.0], value = [1.0, 4.0] }
conductivity = { temperature = [0.0, 10.0], value = [0.3, 1.8] }
[initial]
temperature = 1.0
[[boundary]]
on = "left"
heat_inflow = "8*(1 - t/2)"
[[boundary]]
on = "right"
convection = { coefficient = 2.0, ambient = 0.5 }
[[boundary]]
on = "top"
temperature = "1 + 3*t*x"
[[probe]]
name = "left"
quantity = "temperature"
at = [0.0, 0.0]
[[probe]]
name = "mean"
quantity = "temperature"
on = "right"
take = "mean"
"#;

/// A body that conducts heat and does not move.
#[test]
fn runs_of_heat_alone_have_the_slopes_of_differences() {
    let outputs = ["left", "mean"];
    let keys =
        ["material.conductivity.value[1]", "material.heat_capacity.value[0]", "boundary[1].convection.coefficient"];
    for scheme in ["\"euler\"", "\"theta\"\ntheta = 0.5", "\"bdf2\""] {
        check_by_runs(&HOT.replace("[time]", &format!("[time]\nscheme = {scheme}")), &outputs, &keys);
    }
    let constant = HOT.replace("{ temperature = [0.0, 10.0], value = [1.0, 4.0] }", "2.0");
    check_by_runs(&constant, &outputs, &["material.heat_capacity", "initial.temperature", "time.end"]);
}

/// Steel between a wall at 0 K and a belt out of the plane that leaves it all heat of friction, at half the critical
/// speed V_c = 2k/(fαEL): p = p₀/(1 − V/V_c) with p₀ = Eδ/L, so that ∂p/∂f = p/(f (V_c/V − 1)) and ∂p/∂k = −f/k ∂p/∂f.
const HOT_ROD: &str = r#"
name = "rod"
[mesh]
kind = "interval"
size = 0.02
n = 4
[time]
end = 2.0
analysis = "steady"
[material]
elasticity = { law = "isotropic", young = 2e11, poisson = 0.0 }
expansion_coefficient = 1e-5
conductivity = 50
[[boundary]]
on = "left"
displacement = [0]
temperature = 0
[contact]
on = "right"
gap = -1e-6
foundation_velocity = [0, 0, 4.166666666666667e-3]
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.3 }
frictional_heat = 1
[[probe]]
name = "pressure"
quantity = "pressure"
at = [0.02]
[[probe]]
name = "warm"
quantity = "temperature"
at = [0.02]
"#;

#[test]
fn steady_hot_sliding_has_the_derivatives_of_its_closed_form() {
    let keys = ["contact.friction.coefficient", "material.conductivity", "contact.gap", "material.elasticity.young"];
    let found = by_keys(HOT_ROD, &["pressure", "warm"], &keys, None).expect("a gradient");
    // p = 2e7 and θ = fpVL/k = 10 at f = 0.3, k = 50, δ = 1e-6.
    let known = [[2e7 / 0.3, -2e7 / 50.0, -2e13, 2.0 * 2e7 / 2e11], [20.0 / 0.3, -20.0 / 50.0, -1e7, 20.0 / 2e11]];
    for (i, row) in known.iter().enumerate() {
        for (j, known) in row.iter().enumerate() {
            let slope = found.derivatives[i][j];
            println!("{} by {}: {slope:e} {known:e}", found.outputs[i].0, keys[j]);
            assert!((slope / known - 1.0).abs() <= 1e-8, "{} by {}: {slope:e} {known:e}", found.outputs[i].0, keys[j]);
        }
    }
    check_by_runs(HOT_ROD, &["pressure", "warm"], &keys[..2]);
}

/// A body that starts in its static equilibrium, on a layer and on a rigid foundation.
#[test]
fn runs_from_an_equilibrium_have_the_slopes_of_differences() {
    let text = TURNED.replace("velocity = [0.01, -0.02]", "state = \"equilibrium\"");
    let text = text.replace("traction = [\"0.4*sin(2*t)\", 0.3]", "traction = [\"0.4*sin(2*t) - 0.7\", 0.3]");
    let keys = ["material.elasticity.young", "material.expansion", "initial.temperature", "load.body_force[1]"];
    check_by_runs(&text, &OUTPUTS, &keys);
    let layer = "law = \"damped\", stiffness = 4000.0, damping = 7.0";
    assert!(text.contains(layer));
    check_by_runs(&text.replace(layer, "law = \"signorini\""), &OUTPUTS, &keys[..2]);
}

/// Maxwell branches whose times vary in space: their springs have strains of their own.
#[test]
fn runs_with_relaxation_times_that_vary_have_the_slopes_of_differences() {
    let varying = BRANCHES.replace("time = 0.3", "time = \"slow*(1 + x)\"");
    let text = TURNED.replace(BRANCHES, &varying).replace("[mesh]", "[constants]\nslow = 0.3\n[mesh]");
    let outputs = ["corner_x", "pressure", "warm", "final.contact.force.1"];
    let keys = ["constants.slow", "material.elasticity.young", "contact.friction.static", "initial.velocity[1]"];
    for scheme in ["\"euler\"", "\"theta\"\ntheta = 0.6"] {
        check_by_runs(&text.replace("[time]", &format!("[time]\nscheme = {scheme}")), &outputs, &keys);
    }
    let refused = by_keys(&text, &["stress"], &keys[..1], None).unwrap_err().to_string();
    assert!(refused.contains("output stress: found von_mises of a body with relaxation times that vary"), "{refused}");
}
