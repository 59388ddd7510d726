//! Derivatives of runs with contacts that a force drives: sections that are tightened, obstacles under a load.

use super::gradient::by_keys;
use super::series::check_within;

/// A bolt beside a plate that stands on a rigid ground, both below a yoke, turned off the axes. The section of the bolt
/// is tightened in the first three of six steps; the yoke, which rubs on the plate, is then pulled aside.
pub(super) const BOLTED: &str = r#"
name = "bolted"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [
  { name = "lower", size = [0.3, 0.4], n = [2, 2], turn = { angle = 0.4 } },
  { name = "upper", size = [0.3, 0.6], n = [2, 2], turn = { angle = 0.4 }, origin = [-0.15576733692346023, 0.3684243976011541] },
  { name = "plate", size = [1.0, 1.0], n = [3, 3], turn = { angle = 0.4 }, origin = [0.552636596401731, 0.2336510053851903] },
  { name = "yoke", size = [1.6, 0.3], n = [5, 1], turn = { angle = 0.4 }, origin = [-0.3894183423086505, 0.9210609940028851] },
]
[constants]
bolt = 1.6
[time]
end = 1.0
steps = 6
[material]
density = 0.8
heat_capacity = 2.0
expansion = 0.02
coupling = 0.2
conductivity = 0.8
elasticity = { law = "isotropic", young = 100.0, poisson = 0.3, stress_state = "plane-strain" }
viscosity = { law = "lame", first = 0.2, second = 0.5 }
[initial]
temperature = 1.0
[[boundary]]
on = "lower_bottom"
displacement = [0, 0]
[[boundary]]
on = "yoke_top"
traction = ["0.5*sin(3*t)", "0.2*t"]
temperature = 1.0
[[contact]]
name = "section"
on = "upper_bottom"
with = "lower_top"
normal = { law = "bilateral" }
friction = { law = "stick" }
heat = { law = "constant", conductance = 0.7 }
preload = { force = "bolt*(0.2 + t)", until = 0.45 }
[[contact]]
on = "upper_top"
with = "yoke_bottom"
normal = { law = "bilateral" }
friction = { law = "stick" }
[[contact]]
on = "plate_top"
with = "yoke_bottom"
gap = -0.001
normal = { law = "compliance", stiffness = 900.0 }
friction = { law = "coulomb", coefficient = 0.2 }
frictional_heat = 0.6
heat = { law = "pressure", coefficient = 0.6, exponent = 0.95 }
[[contact]]
on = "plate_bottom"
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.15 }
foundation_velocity = ["0.01*cos(0.4)", "0.01*sin(0.4)"]
heat = { law = "constant", conductance = 0.4, foundation_temperature = 2.0 }
[[probe]]
name = "corner"
quantity = "displacement"
at = [0.9674537454033706, 1.8204486398975916]
[[probe]]
name = "section"
quantity = "pressure"
on = "upper_bottom"
take = "integral"
[[probe]]
name = "warm"
quantity = "temperature"
on = "plate_top"
take = "mean"
"#;

#[test]
fn runs_with_a_tightened_bolt_have_the_slopes_of_differences() {
    let outputs = ["corner_x", "corner_y", "section", "warm", "energy.friction_dissipation", "final.contact.force.1"];
    let keys = [
        "constants.bolt",
        "contact[0].preload.until",
        "material.elasticity.young",
        "contact[2].friction.coefficient",
        "contact[2].gap",
    ];
    check_within(1e-3, BOLTED, &outputs, &keys);
    check_within(1e-2, BOLTED, &["warm"], &["contact[2].heat.coefficient"]);
    let at_once = format!("{BOLTED}\n[scheme]\ncoupling = \"monolithic\"\n");
    check_within(1e-3, &at_once, &["corner_x", "section", "warm"], &keys[..4]);
    // Tightened without inertia.
    let phases = "[[phase]]\nname = \"tighten\"\nend = 0.5\nsteps = 3\nanalysis = \"quasistatic\"\n\
                  [[phase]]\nname = \"work\"\nend = 1.0\nsteps = 4\n[material]";
    let phases = BOLTED.replace("end = 1.0\nsteps = 6\n", "").replace("[material]", phases);
    check_within(4e-4, &phases, &["corner_x", "section", "warm"], &keys[..4]);
}

/// A block, turned off the axes, on which a disc lies that a force presses askew; the foot of the block moves to and
/// fro.
const PRESSED: &str = r#"
name = "pressed"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [{ name = "body", size = [1.0, 0.5], n = [8, 3], turn = { angle = 0.4 } }]
[constants]
press = 3.0
[time]
end = 1.0
steps = 6
[material]
density = 0.8
heat_capacity = 2.0
expansion = 0.4
coupling = 0.2
conductivity = 0.8
elasticity = { law = "isotropic", young = 100.0, poisson = 0.3, stress_state = "plane-strain" }
viscosity = { law = "lame", first = 0.2, second = 0.5 }
[initial]
temperature = 1.0
[[boundary]]
on = "body_bottom"
displacement = ["0.012*sin(3*t)*cos(0.4)", "0.012*sin(3*t)*sin(0.4)"]
temperature = 1.0
[contact]
on = "body_top"
gap = 0.001
normal = { law = "compliance", stiffness = 900.0 }
friction = { law = "coulomb", coefficient = 0.2 }
frictional_heat = 0.6
heat = { law = "pressure", coefficient = 0.6, exponent = 0.95, foundation_temperature = 2.0 }
[contact.obstacle]
shape = "sphere"
center = [-0.8571594880633071, 3.439735689267861]
radius = 3.0
load = { force = "press*(0.3 + t)", direction = [0.5736305411092275, -0.843177325541155], mass = 1.4 }
[[probe]]
name = "corner"
quantity = "displacement"
at = [0.7263518228485598, 0.8499488393100931]
[[probe]]
name = "pressure"
quantity = "pressure"
on = "body_top"
take = "integral"
[[probe]]
name = "traction"
quantity = "traction"
on = "body_top"
take = "integral"
[[probe]]
name = "warm"
quantity = "temperature"
on = "body_top"
take = "mean"
"#;

/// Keys of [`PRESSED`]. The normals of the disc turn with its place.
const PRESSED_BY: [&str; 6] = [
    "contact.obstacle.radius",
    "constants.press",
    "contact.obstacle.load.mass",
    "material.elasticity.young",
    "contact.friction.coefficient",
    "contact.gap",
];

#[test]
fn runs_with_an_obstacle_under_a_load_have_the_slopes_of_differences() {
    let outputs =
        ["corner_x", "pressure", "traction_x", "warm", "final.contact.force.0", "energy.friction_dissipation"];
    check_within(1e-3, PRESSED, &outputs, &PRESSED_BY[1..]);
    // The place of the surface of the disc changes by its radius times the step.
    check_within(1e-5, PRESSED, &outputs, &PRESSED_BY[..1]);
    check_within(1e-2, PRESSED, &["warm"], &["contact.heat.coefficient"]);
    let at_once = format!("{PRESSED}\n[scheme]\ncoupling = \"monolithic\"\n");
    check_within(1e-3, &at_once, &outputs[..5], &PRESSED_BY[1..6]);
    // A rigid disc without a mass, from an equilibrium.
    let still = PRESSED.replace(", mass = 1.4", "").replace("[initial]", "[initial]\nstate = \"equilibrium\"");
    let rigid = still.replace("law = \"compliance\", stiffness = 900.0", "law = \"signorini\"");
    check_within(1e-3, &rigid, &outputs[..5], &["constants.press", "material.elasticity.young"]);
}

/// A plane that a force F presses on a block of height h on a layer of the stiffness s: all is in series, and δ is the
/// gap plus F/(A s) + F h/(E A).
#[test]
fn a_pressed_plane_has_the_derivatives_of_its_closed_form() {
    let text = r#"
name = "punch"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [0.5, 0.8]
n = [2, 3]
[time]
end = 1.0
steps = 2
[material]
density = 0
elasticity = { law = "isotropic", young = 1000.0, poisson = 0, stress_state = "plane-stress" }
[[boundary]]
on = "bottom"
displacement = [0, 0]
[contact]
on = "top"
normal = { law = "compliance", stiffness = 500.0 }
[contact.obstacle]
shape = "plane"
point = [0, 1.1]
normal = [0, -1]
load = { force = 7.0, direction = [0, -1] }
[[probe]]
name = "end"
quantity = "displacement"
at = [0.5, 0.8]
[[probe]]
name = "deep"
quantity = "penetration"
on = "top"
take = "mean"
"#;
    let keys = ["contact.obstacle.load.force", "material.elasticity.young", "contact.normal.stiffness", "contact.gap"];
    let text = text.replace("[contact]", "[contact]\ngap = 0.1");
    let found = by_keys(&text, &["end_y", "deep"], &keys, None).expect("a gradient");
    // u = −F h/(E A), r = F/(A s), with A = 0.5.
    let (u, r) = (0.0 - 7.0 * 0.8 / 500.0, 7.0 / 250.0);
    let known = [[u / 7.0, 0.0 - u / 1000.0, 0.0, 0.0], [r / 7.0, 0.0, 0.0 - r / 500.0, 0.0]];
    for (i, row) in known.iter().enumerate() {
        for (j, known) in row.iter().enumerate() {
            let slope = found.derivatives[i][j];
            println!("{} by {}: {slope:e} {known:e}", found.outputs[i].0, keys[j]);
            assert!((slope - known).abs() <= 1e-9 * known.abs().max(1e-3), "{}: {slope:e} {known:e}", keys[j]);
        }
    }
}
