//! A pressure that begins in the gap, as that of rough surfaces and gaskets does.

use crate::common::solve;
use amontons::case::{self, Source};

/// Pressures over the opening: 0.1 at 0.01 and 1 where the gap closes.
const LAW: &str = "{ law = \"table\", penetration = [-0.02, -0.01, 0], pressure = [0, 0.1, 1.0] }";
const REST: &str = "[time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0\n\
                    elasticity = { law = \"isotropic\", young = 100, poisson = 0, stress_state = \"plane-strain\" }\n";

/// The pressures at the contact points at the end of a case.
fn pressures(text: &str, overrides: &[String]) -> Vec<f64> {
    let source = Source::new("gap.toml", format!("name = \"gap\"\nunits = \"dimensionless\"\n{REST}{text}"));
    let case = case::parse(&source, overrides).unwrap_or_else(|error| panic!("{error}"));
    let end = solve(&case.problem);
    let report = end.reports.last().expect("a step");
    report.contact.states.iter().map(|point| point.pressure).collect()
}

fn all_are(found: &[f64], expected: f64, what: &str) {
    assert!(!found.is_empty(), "{what}");
    assert!(found.iter().all(|p| (p - expected).abs() < 1e-12), "{what}: {found:?} for {expected}");
}

/// A block of height 1 over a gap of 0.01: 100 d = 0.1 − 10 d for its compression d, and 100 d = 50 (0.01 − d) with the
/// formula.
#[test]
fn a_block_is_pressed_before_it_touches() {
    let text = format!(
        "[mesh]\nkind = \"rectangle\"\nsize = [1, 1]\nn = [3, 2]\n[[boundary]]\non = \"top\"\ndisplacement = [0, 0]\n\
         [contact]\non = \"bottom\"\ngap = 0.01\nnormal = {LAW}\n"
    );
    let formula = "{ law = \"expression\", pressure = \"50*(r + 0.02)\", begin = -0.02 }";
    for elements in ["Q1", "Q2", "P1", "P2"] {
        for quadrature in ["nodal", "gauss"] {
            for (law, expected) in [(LAW, 1.0 / 11.0), (formula, 1.0 / 3.0)] {
                let overrides =
                    [format!("mesh.elements=\"{elements}\""), format!("contact.quadrature=\"{quadrature}\"")];
                all_are(&pressures(&text.replace(LAW, law), &overrides), expected, &format!("{overrides:?} {law}"));
            }
        }
    }
}

/// Two blocks with a gap of 0.01 between them, whichever side bears the points: 50 d = 0.1 − 10 d for the compression d
/// of both, and 50 d = 0.28 − 90 d where they are brought closer by 0.002.
#[test]
fn two_blocks_are_pressed_before_they_touch() {
    for (elements, solver) in [("Q1", "direct"), ("Q1", "iterative"), ("Q2", "direct"), ("P1", "direct")] {
        for nonmortar in ["low_top", "high_bottom"] {
            for (down, expected) in [(0.0, 0.5 / 6.0), (0.002, 0.1)] {
                let text = format!(
                    "[mesh]\nkind = \"blocks\"\nblocks = [\n\
                     {{ name = \"low\", size = [1, 1], n = [3, 2], elements = \"{elements}\" }},\n\
                     {{ name = \"high\", size = [1, 1], origin = [0, 1.01], n = [4, 3], elements = \"{elements}\" }},\n]\n\
                     [[boundary]]\non = \"high_top\"\ndisplacement = [0, {}]\n\
                     [[boundary]]\non = \"low_bottom\"\ndisplacement = [0, 0]\n[solver]\nsolver = \"{solver}\"\n\
                     [contact]\non = \"low_top\"\nwith = \"high_bottom\"\nnonmortar = \"{nonmortar}\"\nnormal = {LAW}\n\
                     friction = {{ law = \"coulomb\", coefficient = 0.2 }}\n",
                    -down
                );
                all_are(&pressures(&text, &[]), expected, &format!("{elements} {solver} {nonmortar} {down}"));
            }
        }
    }
}
