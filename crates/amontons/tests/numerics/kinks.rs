//! Derivatives beside kinks: laws that bend within the step of a parameter, points that nothing moves, start of slip.

use amontons::adjoint::{GradientRequest, GradientTable, Parameter, SeriesRequest, SeriesTable, gradient, series};
use amontons::case::{Case, Source};

use super::gradient::{Overrides, parameter, parsed, source};
use super::series::check_within;

/// The derivatives of a text by parameters with their values, by both methods.
fn by_both(text: &str, outputs: &[&str], parameters: &[(&str, f64, Overrides)]) -> (GradientTable, SeriesTable) {
    let source = Source::new("case", text);
    let Case { problem, probes, .. } = &parsed(&source, &[]);
    let outputs: &[String] = &outputs.iter().map(ToString::to_string).collect::<Vec<_>>();
    let parameters: &[Parameter] =
        &parameters.iter().map(|(name, value, sets)| parameter(&source, (name, *value), sets)).collect::<Vec<_>>();
    let request = GradientRequest { problem, probes, outputs, parameters, memory: None, interrupt: None };
    let request_of_series = SeriesRequest { problem, probes, outputs, parameters, interrupt: None };
    (gradient(&request).expect("a gradient"), series(&request_of_series).expect("a series"))
}

/// Asserts that two numbers agree to a tolerance relative to the second one.
fn assert_near(what: &str, found: f64, expected: f64, tolerance: f64) {
    println!("{what}: {found:e}, expected {expected:e}");
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{what}: {found:e}, expected {expected:e}");
}

/// A rod of stiffness 10 whose end is moved by a hardly touches a layer with p = c rⁿ, r far below, near and above the
/// thousandth of the gap g by which data are changed:
///
/// 10 (a − u) = c rⁿ,  r = u − g,  so that ∂u/∂g = s/(10 + s) and ∂p/∂g = −10 s/(10 + s) with s = c n rⁿ⁻¹.
#[test]
fn a_power_of_a_small_penetration_has_the_derivatives_of_its_closed_form() {
    let (c, n, gap) = (3000.0, 1.5, 0.02);
    for r in [1e-6, 1e-5, 1.9e-5, 3e-5, 5e-5, 1e-4] {
        let moved = gap + r + c * f64::powf(r, n) / 10.0;
        let text = source("rod").text.replace("0.1*t", &format!("{moved:?}*t"));
        let text = text.replace("\"compliance\", stiffness = 30.0", "\"power\", stiffness = 3000.0, exponent = 1.5");
        let sets: Overrides = Box::new(|value| vec![format!("contact.gap={value:?}")]);
        let (adjoint, tangent) = by_both(&text, &["end_x", "pressure"], &[("gap", gap, sets)]);
        let s = c * n * f64::powf(r, n - 1.0);
        let last = tangent.derivatives.last().expect("a step");
        for (i, expected) in [s / (10.0 + s), -10.0 * s / (10.0 + s)].into_iter().enumerate() {
            assert_near(&format!("adjoint, r = {r:e}"), adjoint.derivatives[i][0], expected, 1e-8);
            assert_near(&format!("tangent, r = {r:e}"), last[i][0], expected, 1e-8);
        }
        assert_eq!((adjoint.ties, tangent.ties), (0, 0));
    }
}

/// A block that wears, with a side that is held in all directions down to Γ_C: its last contact point bears nothing.
const HELD: &str = r#"
name = "held"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 0.5]
n = [3, 2]
diagonal = "right"
[time]
end = 1.0
steps = 3
[material]
density = 1.0
elasticity = { law = "isotropic", young = 50.0, poisson = 0.3, stress_state = "plane-strain" }
[[boundary]]
on = "left"
displacement = ["0.01*t", "-0.01*t"]
[[boundary]]
on = "top"
traction = [0.1, "-1.0*t"]
[contact]
on = "bottom"
gap = -0.002
normal = { law = "compliance", stiffness = 500.0 }
friction = { law = "coulomb", coefficient = 0.3 }
foundation_velocity = [0.05, 0]
wear = { law = "archard", coefficient = 0.002 }
[[probe]]
name = "corner"
quantity = "displacement"
at = [1.0, 0.5]
[[probe]]
name = "pressure"
quantity = "pressure"
on = "bottom"
take = "integral"
"#;

#[test]
fn points_that_nothing_moves_have_the_slopes_of_differences() {
    let keys = ["material.elasticity.young", "contact.wear.coefficient", "contact.gap"];
    let outputs = ["corner_x", "pressure", "final.contact.force.0", "final.contact.wear_volume"];
    for normal in ["\"compliance\", stiffness = 500.0", "\"signorini\""] {
        check_within(4e-3, &HELD.replace("\"compliance\", stiffness = 500.0", normal), &outputs, &keys);
    }
}

/// Linear triangles of which one corner moves, along Γ_C, with the stiffness E (1/2 + 1/4) = 100 and half of the load.
const SPRING: &str = r#"
name = "start-of-slip"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 1.0]
n = [1, 1]
diagonal = "right"
[time]
end = 1.0
steps = 1
[material]
density = 0.0
elasticity = { law = "isotropic", young = 133.33333333333334, poisson = 0.0, stress_state = "plane-stress" }
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "top"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = [8.0, 0.0]
[contact]
on = "bottom"
normal = { law = "bilateral" }
friction = { law = "tresca", bound = 8.0 }
[[probe]]
name = "corner"
quantity = "displacement"
at = [1.0, 0.0]
"#;

/// u = max(0, (F − μN)/k) with k = 100, N = 10, F = 4; half of the bound μN/ω = 20 μ acts at the corner. At μ = 0.4
/// both one-sided derivatives, −0.1 and 0, are given.
#[test]
fn the_start_of_slip_has_both_one_sided_derivatives() {
    for (mu, u, slope) in [(0.3, 0.01, -0.1), (0.4, 0.0, f64::NAN), (0.5, 0.0, 0.0)] {
        let text = SPRING.replace("bound = 8.0", &format!("bound = {:?}", 20.0 * mu));
        for text in [text.clone(), text.replace("[8.0, 0.0]", "[8.0, -3.0]")] {
            let sets: Overrides = Box::new(|value| vec![format!("contact.friction.bound={:?}", 20.0 * value)]);
            let (adjoint, tangent) = by_both(&text, &["corner_x"], &[("mu", mu, sets)]);
            assert!((adjoint.outputs[0].1 - u).abs() <= 1e-14, "{mu}: {:?}", adjoint.outputs);
            let [here, last] = [adjoint.derivatives[0][0], tangent.derivatives[1][0][0]];
            println!("{mu}: {here:e} {last:e} {:?} {:?} {:?}", adjoint.beyond, adjoint.margin, tangent.margin);
            let Some(beyond) = adjoint.beyond.as_ref().map(|beyond| beyond[0][0]) else {
                assert!(!slope.is_nan() && adjoint.ties == 0 && tangent.ties == 0, "{mu}: {adjoint:?}");
                assert!((here - slope).abs() <= 1e-11 && (last - slope).abs() <= 1e-11, "{mu}: {here:e} {last:e}");
                continue;
            };
            assert!(slope.is_nan() && adjoint.ties == 1 && tangent.ties == 1, "{mu}: {adjoint:?} {tangent:?}");
            let both = [here.min(beyond), here.max(beyond)];
            assert!((both[0] + 0.1).abs() <= 1e-11 && both[1].abs() <= 1e-11, "{mu}: {both:?}");
            assert!(both.iter().any(|one| (last - one).abs() <= 1e-11), "{mu}: {last:e} of {both:?}");
        }
    }
}

/// A rod with EA = 1000 on a base with friction τ = 10 per length, pulled by F = 10: it slips over F/τ = 1, and
///
/// u = F²/(2τEA),  D = F³/(6τEA) of the first pull, a quarter of that of a cycle.
///
/// Nodes at the distance h slip one after the other: u and D are off by the square of h/ℓ, and so are the derivatives
/// at whole multiples F = m τ h, in the middle between two kinks. Shear over the height H changes u by τH/G at most.
#[test]
fn a_rod_on_a_base_has_the_derivatives_of_its_closed_form() {
    let text = r#"
name = "rod-on-a-base"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.5, 0.002]
n = [96, 1]
elements = "Q1"
[time]
end = 1.0
steps = 4
[material]
density = 0.0
elasticity = { law = "isotropic", young = 5e5, poisson = 0.0, stress_state = "plane-stress" }
[[boundary]]
on = "left"
displacement = [0, "free"]
[[boundary]]
on = "top"
displacement = ["free", 0]
[[boundary]]
on = "right"
traction = ["5000.0*t", 0]
[contact]
on = "bottom"
normal = { law = "bilateral" }
friction = { law = "tresca", bound = 10.0 }
[[probe]]
name = "end"
quantity = "displacement"
at = [1.5, 0.0]
"#;
    let force: Overrides = Box::new(|value| vec![format!("boundary[2].traction=[\"{:?}*t\", 0]", value / 0.002)]);
    let bound: Overrides = Box::new(|value| vec![format!("contact.friction.bound={value:?}")]);
    let stiffness: Overrides = Box::new(|value| vec![format!("material.elasticity.young={:?}", value / 0.002)]);
    let parameters = [("F", 10.0, force), ("tau", 10.0, bound), ("EA", 1000.0, stiffness)];
    let (adjoint, tangent) = by_both(text, &["end_x", "energy.friction_dissipation"], &parameters);
    assert_eq!((adjoint.ties, tangent.ties), (0, 0), "{:?}", adjoint.margin);
    let expected = [[1e-3, -5e-4, -5e-6], [0.005, -0.02 / 12.0, -0.05 / 3000.0]];
    let values = [0.005, 0.05 / 3.0];
    for (i, expected) in expected.iter().enumerate() {
        let value = adjoint.outputs[i].1;
        println!("{}: {value:e}, expected {:e}", adjoint.outputs[i].0, values[i]);
        assert!((value - values[i]).abs() <= 1e-3 * values[i], "{value:e}");
        for (j, expected) in expected.iter().enumerate() {
            let last = tangent.derivatives.last().expect("a step")[i][j];
            for found in [adjoint.derivatives[i][j], last] {
                println!("{i} by {}: {found:e}, expected {expected:e}", parameters[j].0);
                assert!((found - expected).abs() <= 2e-3 * expected.abs(), "{i} by {j}: {found:e} {expected:e}");
            }
        }
    }
}
