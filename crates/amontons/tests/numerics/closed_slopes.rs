//! Derivatives of runs against those of closed forms.

use super::gradient::{by_keys, read};
use super::series::series_by_keys;

fn is_near(found: f64, known: f64, tolerance: f64) -> bool {
    (found - known).abs() <= tolerance * known.abs()
}

/// Two bars with EA = 1000 lie on each other with a friction of τ = 10 per length and are pulled apart by F = 10: at
/// each end they slip over F/(2τ). A cycle between F and −F takes D = F³/(3EAτ) at both ends, and the first pull D/4:
/// after one cycle from rest 5/4 D = 1/24, ∂/∂τ = −1/240 and ∂/∂EA = −1/24000.
fn lap(cells: usize) -> String {
    format!(
        r#"
name = "lap"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [
  {{ name = "lower", size = [2.0, 0.002], n = [{cells}, 1], elements = "Q1" }},
  {{ name = "upper", size = [2.0, 0.002], n = [{cells}, 1], origin = [0.0, 0.002], elements = "Q1" }},
]
[constants]
young = 5e5
[time]
end = 5.0
steps = 20
[material]
density = 0.0
elasticity = {{ law = "isotropic", young = "young", poisson = 0.0, stress_state = "plane-stress" }}
[[boundary]]
on = "lower_left"
displacement = [0, "free"]
[[boundary]]
on = "lower_bottom"
displacement = ["free", 0]
[[boundary]]
on = "upper_top"
displacement = ["free", 0]
[[boundary]]
on = "upper_right"
traction = ["5000*min(t, max(2 - t, min(t - 4, 1)))", 0]
[contact]
on = "lower_top"
with = "upper_bottom"
normal = {{ law = "bilateral" }}
friction = {{ law = "tresca", bound = 10.0 }}
"#
    )
}

/// Nodes at the distance h slip one after the other, so that the loss is off by the square of h over the slip length,
/// and its derivatives in the middle between two kinks.
#[test]
fn the_loss_of_a_lap_joint_has_the_derivatives_of_its_closed_form() {
    let keys = ["contact.friction.bound", "constants.young"];
    let known = [1.0 / 24.0, -1.0 / 240.0, -1.0 / 24000.0 * 0.002];
    let errors = [80, 160].map(|cells| {
        let found = by_keys(&lap(cells), &["energy.friction_dissipation"], &keys, None).expect("a gradient");
        let all = [found.outputs[0].1, found.derivatives[0][0], found.derivatives[0][1]];
        println!("{cells}: {all:?} {known:?}, {:?} {}", found.margin, found.ties);
        [0, 1, 2].map(|i| (all[i] / known[i] - 1.0).abs())
    });
    println!("{errors:?}");
    assert!(errors[1].iter().all(|error| *error <= 4e-3), "{errors:?}");
}

/// A mass on a spring with dry friction turns round at (−1)ⁿ(u₀ − 2nC), C = μmg/K, at times that do not depend on u₀
/// and μ: ∂/∂μ = 2e-3, −4e-3, 6e-3, −8e-3, ∂/∂u₀ = −1, 1, −1, 1 and ∂/∂K = −2e-8, 4e-8, −6e-8, 8e-8. After the last
/// turn it sticks.
const OSCILLATOR: &str = r#"
name = "oscillator"
[mesh]
kind = "rectangle"
size = [1.0, 0.01]
n = [1, 1]
diagonal = "right"
[constants]
start = 8.5e-4
[time]
end = 0.14137166941154070
steps = 18000
scheme = "bdf2"
[material]
density = 300
elasticity = { law = "isotropic", young = 1e6, poisson = 0.0, stress_state = "plane-stress" }
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "top"
traction = [0, -20]
[contact]
on = "bottom"
normal = { law = "compliance", stiffness = 1e9 }
friction = { law = "coulomb", coefficient = 0.1 }
[initial]
displacement = ["start*x", "-2e-8*x"]
[[probe]]
name = "end"
quantity = "displacement"
at = [1.0, 0.0]
"#;

#[test]
fn the_turns_of_an_oscillator_with_dry_friction_have_their_derivatives() {
    let keys = ["contact.friction.coefficient", "constants.start", "material.elasticity.young"];
    let found = series_by_keys(OSCILLATOR, &["end_x"], &keys).expect("a series");
    let mut turned = &found.derivatives[0][0];
    for turn in 1..=4_usize {
        let (sign, n) = (if turn % 2 == 0 { 1.0 } else { -1.0 }, turn as f64);
        let near = 4000 * turn - 500..4000 * turn + 500;
        let step = near.max_by(|a, b| (sign * found.values[*a][0]).total_cmp(&(sign * found.values[*b][0])));
        let row = &found.derivatives[step.expect("a turn")][0];
        // K = EH/L.
        let known = [-2e-3 * sign * n, sign, 2e-8 * sign * n * 0.01];
        println!("turn {turn}: {row:?} {known:?}");
        // Of the two nodes at the end one rubs: their motion apart is a phase, which K changes most.
        let scales = [2e-3 * 2e-3, 2e-3, 0.02 * 2e-10];
        for ((found, known), scale) in row.iter().zip(known).zip(scales) {
            assert!((found - known).abs() <= n * scale, "turn {turn}: {row:?} {known:?}");
        }
        turned = row;
    }
    let last = &found.derivatives[18000][0];
    assert!(turned.iter().zip(last).take(2).all(|(a, b)| is_near(*a, *b, 2e-2)), "{turned:?} {last:?}");
}

/// A force F = 0.1 pushes the end of a rod with EA = ρA = 1 and a dry friction of q = 1 per length. All stops at t =
/// 0.2, with u(0) = F²/(q EA): ∂u/∂F = 0.2, ∂u/∂q = ∂u/∂EA = −0.01 and ∂u/∂ρA = 0.
const WAVE: &str = r#"
name = "wave"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [0.25, 0.005]
n = [250, 1]
elements = "Q1"
[time]
end = 0.3
steps = 600
scheme = "bdf2"
[constants]
force = 0.1
[material]
density = 1.0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.0, stress_state = "plane-stress" }
[[boundary]]
on = "left"
traction = ["force", 0]
[[boundary]]
on = "right"
displacement = [0, "free"]
[[boundary]]
on = "top"
displacement = ["free", 0]
[contact]
on = "bottom"
normal = { law = "bilateral" }
friction = { law = "tresca", bound = 0.005 }
[[probe]]
name = "end"
quantity = "displacement"
at = [0.0, 0.0]
"#;

#[test]
fn a_wave_that_friction_stops_has_the_derivatives_of_its_closed_form() {
    let keys = ["constants.force", "contact.friction.bound", "material.elasticity.young", "material.density"];
    // The rod has the height 0.005, over which friction is a stress.
    let known = [0.2, -0.01 / 0.005, -0.01, 0.0];
    let found = by_keys(WAVE, &["end_x"], &keys, None).expect("a gradient");
    println!("{:?} {:?}", found.outputs, found.derivatives);
    for (found, known) in found.derivatives[0].iter().zip(known) {
        assert!((found - known).abs() <= 0.05 * known.abs().max(0.01), "{found:e} {known:e}");
    }
}

/// Two rods of length 1 with E = 1 and 2, α = 0.1 and 0.2, k = 1 and 2 between walls at θ = 10 and 0, with a gap g₀ =
/// 0.4 and a conductance h₀p, h₀ = 10. With equal α/k the rods grow by 1 whatever flows: p = (1 − g₀)/(1/E₁ + 1/E₂), so
/// that ∂p/∂g₀ = −2/3 and ∂p/∂h₀ = 0.
const CLOSING: &str = r#"
name = "closing"
units = "dimensionless"
[mesh]
kind = "blocks"
blocks = [{ name = "hot", size = [1.0], n = [4] }, { name = "cold", size = [1.0], n = [3], origin = [1.0] }]
[time]
end = 1.0
analysis = "steady"
[material]
elasticity = { law = "isotropic", young = 1.0, poisson = 0.0 }
expansion_coefficient = 0.1
conductivity = 1.0
[[region]]
on = "cold"
[region.material]
elasticity = { law = "isotropic", young = 2.0, poisson = 0.0 }
expansion_coefficient = 0.2
conductivity = 2.0
[[boundary]]
on = "hot_left"
displacement = [0]
temperature = 10.0
[[boundary]]
on = "cold_right"
displacement = [0]
temperature = 0.0
[contact]
on = "hot_right"
with = "cold_left"
gap = 0.4
normal = { law = "signorini" }
heat = { law = "pressure", coefficient = 10.0 }
[[probe]]
name = "pressure"
quantity = "pressure"
at = [1.0]
"#;

#[test]
fn heated_rods_that_close_a_gap_have_the_derivatives_of_their_closed_form() {
    let keys = ["contact.gap", "contact.heat.coefficient", "material.elasticity.young"];
    let found = by_keys(CLOSING, &["pressure"], &keys, None).expect("a gradient");
    println!("{:?} {:?}", found.outputs, found.derivatives);
    // ∂p/∂E₁ = p²/((1 − g₀) E₁²).
    let (pressure, known) = (0.4, [-2.0 / 3.0, 0.0, 0.16 / 0.6]);
    assert!(is_near(found.outputs[0].1, pressure, 1e-10));
    for (found, known) in found.derivatives[0].iter().zip(known) {
        assert!((found - known).abs() <= 1e-9, "{found:e} {known:e}");
    }
}

/// A flux q₀(1 − t/t_s) into a half-space: the surface has T = 2q₀√t (1 − 2t/(3t_s))/(e√π) with e = √(kρc), largest at
/// t_s/2: T = 79.426894, ∂/∂q₀ = 7.942689e-5, ∂/∂t_s = 9.928362 and ∂/∂k = −0.794269. The strip is far thicker than
/// heat diffuses.
fn brake(cells: usize) -> String {
    format!(
        r#"
name = "brake"
[mesh]
kind = "interval"
size = 0.06
n = {cells}
grading = 0
[constants]
power = 1e6
stop = 4.0
[time]
end = 2.0
steps = {cells}
scheme = "bdf2"
[material]
heat_capacity = 3.588e6
conductivity = 50
[[boundary]]
on = "left"
heat_inflow = "power*(1 - t/stop)"
[[probe]]
name = "surface"
quantity = "temperature"
at = [0.0]
"#
    )
    .replace("grading = 0\n", "")
}

#[test]
fn the_heat_of_a_stop_has_the_derivatives_of_its_closed_form() {
    let keys = ["constants.power", "constants.stop", "material.conductivity"];
    let known = [79.426_894, 7.942_689e-5, 9.928_362, -0.794_269];
    let errors = [100, 200, 400].map(|cells| {
        let found = by_keys(&brake(cells), &["surface"], &keys, None).expect("a gradient");
        let all = [found.outputs[0].1, found.derivatives[0][0], found.derivatives[0][1], found.derivatives[0][2]];
        [0, 1, 2, 3].map(|i| (all[i] / known[i] - 1.0).abs())
    });
    println!("{errors:?}");
    for i in 0..known.len() {
        let [coarse, middle, fine] = errors.map(|errors| errors[i]);
        assert!(fine <= 2e-3 && middle <= 0.6 * coarse && fine <= 0.6 * middle, "{i}: {coarse:e} {middle:e} {fine:e}");
    }
}

/// A block of width 0.4 that is pressed on a wider one: the force ∫ p is in proportion to the thickness, and the area
/// that touches to the thickness and to the width. The weights of the points change with both.
#[test]
fn integrals_over_a_pair_follow_its_size() {
    let text = r#"
name = "pressed"
units = "dimensionless"
thickness = 0.5
[mesh]
kind = "blocks"
blocks = [
  { name = "low", size = [1.0, 1.0], n = [7, 2], elements = "Q1" },
  { name = "high", size = [0.4, 1.0], n = [3, 2], origin = [0.3, 1.0], elements = "Q1" },
]
[time]
end = 1.0
steps = 1
[material]
density = 0.0
elasticity = { law = "isotropic", young = 100.0, poisson = 0.0, stress_state = "plane-stress" }
[[boundary]]
on = "low_bottom"
displacement = [0, 0]
[[boundary]]
on = "high_top"
displacement = [0, -1e-3]
[contact]
on = "high_bottom"
with = "low_top"
normal = { law = "signorini" }
[[probe]]
name = "force"
quantity = "pressure"
on = "high_bottom"
take = "integral"
[[probe]]
name = "area"
quantity = "touching"
on = "high_bottom"
take = "integral"
"#;
    let of = |text: &str| {
        let keys = ["thickness", "mesh.blocks[1].size[0]"];
        by_keys(text, &["force", "area", "final.contact.force.1"], &keys, None).expect("a gradient")
    };
    let found = of(text);
    let [force, area, resultant] = [0, 1, 2].map(|o| found.outputs[o].1);
    assert!(is_near(area, 0.2, 1e-12) && is_near(resultant, force, 1e-12), "{:?}", found.outputs);
    let slopes = &found.derivatives;
    // Everything is in proportion to the thickness.
    assert!(is_near(slopes[0][0], force / 0.5, 1e-8) && is_near(slopes[1][0], 0.4, 1e-8), "{slopes:?}");
    assert!(is_near(slopes[2][0], force / 0.5, 1e-8) && is_near(slopes[1][1], 0.5, 1e-8), "{slopes:?}");
    // The wider block against differences of runs.
    let [less, more] = [0.399_99, 0.400_01].map(|width: f64| {
        let changed = text.replace("size = [0.4, 1.0]", &format!("size = [{width:?}, 1.0]"));
        of(&changed).outputs[0].1
    });
    assert!(is_near(slopes[0][1], (more - less) / 2e-5, 1e-5), "{slopes:?} {}", (more - less) / 2e-5);
    assert!(is_near(slopes[2][1], slopes[0][1], 1e-8), "{slopes:?}");
}

/// Two bolts and a plate between them as springs in parallel below a rigid yoke, k_b = 1e8 N/m and k_c = 4e8 N/m: after
/// a preload of F_V = 10 kN a pull F_A = 8 kN leaves the plate F_V − F_A k_c/(k_b + k_c), and of 15 kN nothing.
#[test]
fn a_bolted_joint_has_the_derivatives_of_its_closed_form() {
    let text = read("crates/amontons/benchmarks/bolted-joint.toml");
    let (model, _) = text.split_once("[verify]").expect("checks");
    let plate = "[constants]\nplate = 5e10\nbolt = 5000\n[[region]]\non = \"plate\"\nmaterial = { density = 0, elasticity = \
                 { law = \"isotropic\", young = \"plate\", poisson = 0, stress_state = \"plane-stress\" } }\n[[side]]\n";
    let probe =
        |on: &str| format!("[[probe]]\nname = \"{on}\"\nquantity = \"pressure\"\non = \"{on}\"\ntake = \"mean\"\n");
    let text = model.replacen("[[side]]\n", plate, 1).replace("\"5 kN\"", "\"bolt\"");
    let text = text + &probe("left_upper_bottom") + &probe("plate_bottom");
    let outputs = ["left_upper_bottom", "plate_bottom"];
    let found = series_by_keys(&text, &outputs, &["constants.bolt", "constants.plate"]).expect("a series");
    let adjoint = by_keys(&text, &outputs, &["constants.bolt", "constants.plate"], None).expect("a gradient");
    // k_b k_c/(k_b + k_c)²/E of the plate, and the areas of a bolt and of the plate.
    let (shared, bolt, plate) = (0.16 / 5e10, 5e-5, 4e-4);
    let known: [[[f64; 2]; 2]; 3] = [
        [[-1.0 / bolt, 0.0], [2.0 / plate, 0.0]],
        [[-1.0 / bolt, 4000.0 * shared / bolt], [2.0 / plate, -8000.0 * shared / plate]],
        [[0.0; 2]; 2],
    ];
    for (n, known) in known.iter().enumerate() {
        let found = &found.derivatives[n + 1];
        println!("step {}: {found:?} {known:?}", n + 1);
        for (found, known) in found.iter().zip(known) {
            for (j, size) in [1.0 / bolt, 4000.0 * shared / bolt].into_iter().enumerate() {
                assert!((found[j] - known[j]).abs() <= 1e-9 * size, "step {}: {found:?} {known:?}", n + 1);
            }
        }
    }
    let last = adjoint.derivatives.iter().flatten();
    assert!(last.clone().all(|slope| slope.abs() < 1e-9 / bolt) && last.count() == 4, "{:?}", adjoint.derivatives);
}
