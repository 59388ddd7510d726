//! A column of one cell that can only shear: at its free end one velocity w and one temperature θ, so that a step is
//! two scalar equations.
#![allow(dead_code, reason = "each test uses a part")]

use amontons::case::{self, Source};
use amontons::problem::Problem;

/// Width and height 1, fixed at the top, u_y = −δ everywhere with c_ν δ = 1, so that p = 1 at the bottom, where with
/// shear modulus G, viscosity b and body force f
///
/// ```text
///     ρ (w − w′)/(3k) + b w + G u + q = f/2,     c (θ − θ′)/(3k) + κ θ = ‖q‖ |w − v_F|.
/// ```
///
/// Further keys of the case are set by `overrides`.
pub fn column(overrides: &[&str]) -> Problem {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    case::parse(&Source::new("column", CASE), &overrides).unwrap_or_else(|error| panic!("{error}")).problem
}

/// ρ = 3, b = G = 1, c = 3, κ = 1.
const CASE: &str = r#"
name = "column"

[mesh]
kind = "rectangle"
size = [1, 1]
n = [1, 1]
elements = "Q1"

[time]
end = 0.5
steps = 1

[material]
density = 3
heat_capacity = 3
expansion = 0
coupling = 0
conductivity = 1
elasticity = { law = "isotropic", young = 2, poisson = 0, stress_state = "plane-stress" }
viscosity = { law = "lame", first = 0, second = 2 }

[initial]
displacement = [0, -0.001]

[load]
body_force = [0, 0]

[[boundary]]
on = "top"
displacement = [0, -0.001]
temperature = 0
[[boundary]]
on = "left"
displacement = ["free", -0.001]
[[boundary]]
on = "right"
displacement = ["free", -0.001]

[contact]
on = "bottom"
normal = { law = "compliance", stiffness = 1000 }
friction = { law = "coulomb", coefficient = 0.3 }
frictional_heat = 1
"#;
