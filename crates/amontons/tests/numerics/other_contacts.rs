//! Derivatives of runs with foundations that warm up and with wear of both sides of a pair.

use super::gradient::{TURNED, by_keys};
use super::series::check_within;

/// [`TURNED`] with a foundation that friction and the body warm.
fn warming() -> String {
    let heat = "exponent = 0.95, foundation_temperature = 3.0 }";
    let more = "foundation = { heat_capacity = 0.2, exchange = 0.3, surroundings = \"1 + t\" }";
    assert!(TURNED.contains(heat));
    TURNED.replace(heat, &format!("{heat}\n{more}"))
}

#[test]
fn runs_with_a_foundation_that_warms_have_the_slopes_of_differences() {
    let outputs = ["corner_x", "pressure", "warm", "final.contact.force.1", "energy.friction_dissipation"];
    let keys = [
        "contact.foundation.heat_capacity",
        "contact.foundation.exchange",
        "contact.frictional_heat",
        "contact.heat.foundation_temperature",
        "contact.friction.kinetic",
        "material.elasticity.young",
    ];
    check_within(2e-3, &warming(), &outputs, &keys);
    let by = |scheme: &str| warming().replace("[time]", &format!("[time]\nscheme = {scheme}"));
    check_within(2e-3, &by("\"theta\"\ntheta = 0.6"), &outputs[1..4], &keys[..5]);
    let bdf2 = by("\"bdf2\"");
    let wear = bdf2.lines().find(|line| line.starts_with("wear")).expect("wear").to_owned();
    check_within(2e-3, &bdf2.replace(&wear, ""), &outputs[1..4], &keys[..5]);
    for coupling in ["monolithic", "extrapolated"] {
        let text = format!("{}\n[scheme]\ncoupling = \"{coupling}\"\n", warming());
        check_within(2e-3, &text, &outputs[..4], &keys);
    }
}

/// A body of one temperature, θ, and a foundation, θ_F, exchange h A (θ − θ_F): their difference falls by 1/(1 + k h A
/// (1/C_B + 1/C)) in each step, and C_B θ + C θ_F does not change.
const TWO: &str = r#"
name = "two"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [0.5, 0.4]
n = [1, 1]
[time]
end = 1.5
steps = 5
[material]
heat_capacity = 3.0
conductivity = 1e6
[initial]
temperature = 2.0
[contact]
on = "bottom"
heat = { law = "constant", conductance = 0.7, foundation_temperature = 1.2 }
foundation = { heat_capacity = 0.25, exchange = 0, surroundings = 0 }
[[probe]]
name = "warm"
quantity = "temperature"
at = [0.0, 0.0]
"#;

#[test]
fn a_body_and_its_foundation_have_the_derivatives_of_their_closed_form() {
    let keys = [
        "contact.heat.conductance",
        "contact.foundation.heat_capacity",
        "contact.heat.foundation_temperature",
        "initial.temperature",
    ];
    let found = by_keys(TWO, &["warm"], &keys, None).expect("a gradient");
    // C_B = 3 · 0.2, A = 0.5, k = 0.3.
    let warm = |[h, capacity, foundation, body]: [f64; 4]| {
        let own = 0.6;
        let falls = 1.0 + 0.3 * 0.5 * h * (1.0 / own + 1.0 / capacity);
        let mean = (own * body + capacity * foundation) / (own + capacity);
        mean + (body - foundation) * falls.powi(-5) * capacity / (own + capacity)
    };
    let at = [0.7, 0.25, 1.2, 2.0];
    assert!((found.outputs[0].1 - warm(at)).abs() < 1e-6, "{:?}", found.outputs);
    for (j, key) in keys.iter().enumerate() {
        let moved = |by: f64| warm(std::array::from_fn(|i| at[i] + if i == j { by } else { 0.0 }));
        // Of fourth order.
        let h = 1e-3;
        let known = (8.0 * (moved(h) - moved(-h)) - (moved(2.0 * h) - moved(-2.0 * h))) / (12.0 * h);
        let slope = found.derivatives[0][j];
        println!("{key}: {slope:e} {known:e}");
        assert!((slope - known).abs() <= 1e-6 * known.abs(), "{key}: {slope:e} {known:e}");
    }
}

/// Two blocks of unlike facets, turned off the axes, that rub and wear each other.
const RUBBING: &str = r#"
name = "rubbing"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [
  { name = "base", size = [1.2, 0.4], n = [5, 2], turn = { angle = 0.4 } },
  { name = "body", size = [1.0, 0.5], n = [3, 2], turn = { angle = 0.4 }, origin = [-0.06366123752317171, 0.40736623183201914] },
]
[time]
end = 1.0
steps = 6
[material]
density = 0.9
heat_capacity = 2.0
expansion = 0.4
coupling = 0.2
conductivity = 0.8
elasticity = { law = "isotropic", young = 80.0, poisson = 0.3, stress_state = "plane-strain" }
viscosity = { law = "lame", first = 0.2, second = 0.5 }
[initial]
temperature = 1.0
[[boundary]]
on = "body_top"
displacement = ["0.05*t*cos(0.4) + 0.02*min(2*t, 1)*sin(0.4)", "0.05*t*sin(0.4) - 0.02*min(2*t, 1)*cos(0.4)"]
temperature = 1.0
[[boundary]]
on = "base_bottom"
displacement = [0, 0]
temperature = 1.0
[contact]
on = "base_top"
with = "body_bottom"
geometry = "reference"
gap = 0.001
normal = { law = "compliance", stiffness = 700.0 }
friction = { law = "coulomb", coefficient = 0.12 }
frictional_heat = 0.6
heat = { law = "pressure", coefficient = 0.6, exponent = 0.95 }
wear = { law = "archard", coefficient = 0.05, fraction = 0.3 }
[[probe]]
name = "corner"
quantity = "displacement"
at = [0.6626905853253884, 1.2573150711421124]
[[probe]]
name = "pressure"
quantity = "pressure"
on = "base_top"
take = "integral"
[[probe]]
name = "worn"
quantity = "wear"
on = "base_top"
take = "mean"
[[probe]]
name = "warm"
quantity = "temperature"
on = "base_top"
take = "mean"
"#;

#[test]
fn runs_with_wear_of_a_pair_have_the_slopes_of_differences() {
    let outputs = ["corner_x", "pressure", "worn", "warm", "final.contact.force.1", "final.contact.wear_volume"];
    let keys = [
        "contact.wear.coefficient",
        "contact.wear.fraction",
        "contact.friction.coefficient",
        "contact.normal.stiffness",
        "material.elasticity.young",
        "contact.gap",
    ];
    for nonmortar in ["base_top", "body_bottom"] {
        let text = RUBBING.replace("[contact]", &format!("[contact]\nnonmortar = \"{nonmortar}\""));
        check_within(1e-3, &text, &outputs, &keys);
        let rigid = text.replace("law = \"compliance\", stiffness = 700.0", "law = \"signorini\"");
        check_within(1e-3, &rigid, &outputs[..3], &keys[..3]);
    }
    let theta = RUBBING.replace("[time]", "[time]\nscheme = \"theta\"\ntheta = 0.6");
    check_within(1e-3, &theta, &outputs[..3], &keys[..4]);
    let at_once = format!("{RUBBING}\n[scheme]\ncoupling = \"monolithic\"\n");
    check_within(1e-3, &at_once, &outputs[..3], &keys[..4]);
}

/// A body, turned off the axes, that closes a gap from its left end on; a fluid comes in from the right.
fn sealing() -> String {
    let gap =
        "gap = \"0.02*(x*cos(0.4) + y*sin(0.4))\"\nfluid = { pressure = \"pool*(0.5 + t)\", from = \"body_right\" }";
    let text = RUBBING.replace("gap = 0.001", gap).replace("[time]", "[constants]\npool = 0.3\n[time]");
    let wear = "wear = { law = \"archard\", coefficient = 0.05, fraction = 0.3 }\n";
    assert!(text.contains(wear));
    text.replace(wear, "")
        .replace("name = \"worn\"\nquantity = \"wear\"", "name = \"worn\"\nquantity = \"penetration\"")
}

#[test]
fn runs_with_a_fluid_have_the_slopes_of_differences() {
    let outputs = ["corner_x", "pressure", "worn", "final.contact.force.1", "energy.friction_dissipation"];
    let keys =
        ["constants.pool", "contact.friction.coefficient", "contact.normal.stiffness", "material.elasticity.young"];
    check_within(1e-3, &sealing(), &outputs, &keys);
    let dry = sealing().replace("pool*(0.5 + t)", "0*pool*(0.5 + t)");
    let found = by_keys(&dry, &["corner_x"], &["constants.pool"], None).expect("a gradient");
    assert!(found.derivatives[0][0].abs() <= 1e-12, "{:?}", found.derivatives);
}

/// A rigid seal that is guided, on a layer with the stiffness c and the gap x/50, with a fluid of the pressure p_f
/// beside it: c A (δ − mean gap) + p_f (1 − A) = F, A the area that is closed, of 40 cells up to the node 29.
const SEAL: &str = r#"
name = "seal"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 0.3]
n = [40, 1]
elements = "Q1"
[constants]
force = 0.6
[time]
end = 2.0
steps = 4
[material]
density = 0
elasticity = { law = "isotropic", young = 1000.0, poisson = 0.3, stress_state = "plane-strain" }
[[rigid]]
on = "body"
guided = true
force = [0, "-force*min(1, t)"]
[contact]
on = "bottom"
gap = "0.02*x"
normal = { law = "compliance", stiffness = 100.0 }
friction = { law = "tresca", bound = 1 }
fluid = { pressure = 0.25, from = "right" }
[[probe]]
name = "down"
quantity = "displacement"
at = [0.0, 0.0]
"#;

#[test]
fn a_seal_beside_a_fluid_has_the_derivatives_of_its_closed_form() {
    let keys = ["constants.force", "contact.fluid.pressure", "contact.normal.stiffness"];
    let found = by_keys(SEAL, &["down_y"], &keys, None).expect("a gradient");
    let (area, pressing) = (1.0 / 80.0 + 29.0 / 40.0, 0.6 - 0.25 * (1.0 - 59.0 / 80.0));
    let known = [-1.0 / (100.0 * area), (1.0 - area) / (100.0 * area), pressing / (100.0 * 100.0 * area)];
    for (j, key) in keys.iter().enumerate() {
        let slope = found.derivatives[0][j];
        println!("{key}: {slope:e} {:e}", known[j]);
        assert!((slope - known[j]).abs() <= 1e-9 * known[j].abs(), "{key}: {slope:e} {:e}", known[j]);
    }
}
