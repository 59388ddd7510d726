//! Gaps that the mesh makes, and sides that start inside an obstacle: each with numbers of its geometry, and cases
//! beside them of which nothing is said.

use crate::{no_word, problem, told, warns};

/// Two blocks that touch along y = 0.
const BLOCKS: &str = r#"
name = "blocks"
[mesh]
kind = "blocks"
blocks = [
  { name = "a", size = [1.0, 0.5], n = [4, 2], elements = "Q1" },
  { name = "b", size = [1.0, 0.5], origin = [0.0, -0.5], n = [6, 2], elements = "Q1" },
]
[time]
end = 1.0
steps = 1
[material]
density = 0
elasticity = { law = "isotropic", young = 2e5, poisson = 0.3, stress_state = "plane-strain" }
[[boundary]]
on = "b_bottom"
displacement = [0, 0]
[[boundary]]
on = "a_top"
displacement = [0, -1e-3]
[contact]
on = "a_bottom"
with = "b_top"
normal = { law = "signorini" }
"#;

fn blocks(origin: &str, more: &[&str]) -> amontons::problem::Problem {
    let mesh = format!(
        "mesh.blocks=[{{ name = \"a\", size = [1.0, 0.5], origin = {origin}, n = [4, 2], elements = \"Q1\" }}, {{ name = \"b\", size = [1.0, 0.5], origin = [0.0, -0.5], n = [6, 2], elements = \"Q1\" }}]"
    );
    let mut sets = vec![mesh.as_str()];
    sets.extend(more);
    problem(BLOCKS, &sets)
}

/// Flat sides: the overlap is that of the coordinates, and round-off is none.
#[test]
fn bodies_that_overlap_at_rest() {
    let finding = told(&blocks("[0.0, -0.125]", &[]), "pair-gap");
    let message = finding.as_ref().map(|finding| finding.message.clone()).unwrap_or_default();
    assert!(message.contains("they overlap at rest by up to 125 mm, at x = 0.0, y = -0.125"), "{message}");
    assert!(message.contains("between \"a_bottom\" and \"b_top\" goes from -125 to -125 mm"), "{message}");
    let [overlap, _] = warns(finding, "contact.gap");
    assert!((overlap - 0.125).abs() < 1e-14, "{overlap}");
    for (origin, more) in [
        ("[0.0, 0.0]", &[][..]),
        ("[0.0, -1e-16]", &[]),
        ("[0.0, -1e-9]", &[]),
        ("[0.0, 0.01]", &[]),
        ("[0.0, -0.125]", &["contact.close=true"]),
        ("[0.0, -0.125]", &["contact.gap=-1e-5"]),
        ("[0.5, 0.0]", &[]),
    ] {
        no_word(told(&blocks(origin, more), "pair-gap"));
    }
    // Millimetres, and the other side named first.
    let small = problem(
        BLOCKS,
        &[
            "mesh.blocks=[{ name = \"a\", size = [1e-3, 5e-4], origin = [0.0, -1.25e-4], n = [4, 2], elements = \"Q1\" }, { name = \"b\", size = [1e-3, 5e-4], origin = [0.0, -5e-4], n = [6, 2], elements = \"Q1\" }]",
            "contact.on=\"b_top\"",
            "contact.with=\"a_bottom\"",
        ],
    );
    let [overlap, _] = warns(told(&small, "pair-gap"), "contact.gap");
    assert!((overlap - 0.125e-3).abs() < 1e-17, "{overlap}");
}

/// A shaft in a bearing with a radial clearance of 10 µm.
fn bearing(radius: f64, n: [usize; 2], elements: &str, more: &[&str]) -> amontons::problem::Problem {
    let text = format!(
        r#"
name = "bearing"
[mesh]
kind = "blocks"
blocks = [
  {{ name = "shaft", radii = [0, {radius}], n = [2, {}], elements = "{elements}" }},
  {{ name = "ring", radii = [20e-3, 40e-3], n = [2, {}], elements = "{elements}" }},
]
[time]
end = 1.0
steps = 1
[material]
density = 0
elasticity = {{ law = "isotropic", young = 210e9, poisson = 0.3, stress_state = "plane-strain" }}
[[boundary]]
on = "ring_outer"
displacement = [0, 0]
[contact]
on = "shaft_outer"
with = "ring_inner"
normal = {{ law = "signorini" }}
"#,
        n[0], n[1]
    );
    problem(&text, more)
}

/// A chord of n in a circle of radius R is R (1 − cos π/n) deep: 24 µm of 64, 19 µm of 72.
#[test]
fn facets_deeper_than_the_clearance() {
    let sagitta = |radius: f64, n: f64| radius * (1.0 - (std::f64::consts::PI / n).cos());
    for swap in [&[][..], &["contact.on=\"ring_inner\"", "contact.with=\"shaft_outer\""]] {
        let finding = told(&bearing(19.99e-3, [64, 72], "Q1", swap), "pair-gap").expect("a warning");
        let depths = [sagitta(19.99e-3, 64.0), sagitta(20e-3, 72.0)];
        assert!(depths.iter().all(|depth| *depth > 10e-6));
        let words = if swap.is_empty() {
            "the facets of \"shaft_outer\" are 24.1 µm deep, those of \"ring_inner\" 19 µm, beside a mean gap of "
        } else {
            "the facets of \"ring_inner\" are 19 µm deep, those of \"shaft_outer\" 24.1 µm, beside a mean gap of "
        };
        for told in [words, "pressures follow the facets"] {
            assert!(finding.message.contains(told), "{}", finding.message);
        }
        assert!(finding.warns() && finding.repair.is_some_and(|repair| repair.contains("gap = \"10 µm\"")));
    }
    // Half of the clearance still makes the pressure a third too large; of a fine or a quadratic side nothing is told,
    // of facets that face each other one by one, of a clearance that is given, or of one that is wide.
    assert!(told(&bearing(19.99e-3, [128, 136], "Q1", &[]), "pair-gap").is_some());
    for quiet in [
        bearing(19.99e-3, [512, 528], "Q1", &[]),
        bearing(19.99e-3, [64, 72], "Q2", &[]),
        bearing(19.99e-3, [64, 64], "Q1", &[]),
        bearing(19.99e-3, [64, 72], "Q1", &["contact.gap=\"10 µm\""]),
        bearing(19.5e-3, [64, 72], "Q1", &[]),
    ] {
        no_word(told(&quiet, "pair-gap"));
    }
    // An interference that is drawn overlaps, and is told as that: along the normals of the facets its 100 µm are
    // 100 cos(π/64) µm, and so much less again along those of the points.
    let drawn = told(&bearing(20.1e-3, [64, 64], "Q1", &[]), "pair-gap").expect("a warning");
    assert!(drawn.message.contains("they overlap at rest by up to 99.8 µm"), "{}", drawn.message);
}

/// A cylinder that touches a block in one point has facets deeper than its gap there, as every mesh has.
#[test]
fn a_cylinder_on_a_block() {
    let text = BLOCKS
        .replace(
            r#"{ name = "a", size = [1.0, 0.5], n = [4, 2], elements = "Q1" }"#,
            r#"{ name = "a", radii = [0, 0.25], origin = [0.5, 0.25], n = [4, 32], elements = "Q1" }"#,
        )
        .replace("a_bottom", "a_outer")
        .replace("[[boundary]]\non = \"a_top\"\ndisplacement = [0, -1e-3]\n", "[load]\nbody_force = [0, -1]\n");
    no_word(told(&problem(&text, &[]), "pair-gap"));
}

/// A block under obstacles.
#[test]
fn a_side_that_starts_inside() {
    let block = |contact: &[&str]| {
        let mut sets = vec!["contact={ on = \"bottom\", normal = { law = \"signorini\" } }"];
        sets.extend(contact);
        told(&problem(crate::BLOCK, &sets), "start-inside")
    };
    let floor = |y: &str| format!("contact.obstacle={{ shape = \"plane\", point = [0, \"{y}\"], normal = [0, 1] }}");
    let finding = block(&[&floor("0.125 + t")]);
    let message = finding.as_ref().map(|finding| finding.message.clone()).unwrap_or_default();
    assert!(
        message.starts_with("at t = 0 \"bottom\" is inside the obstacle by up to 125 mm, at ")
            && message.contains("at 9 of its 9 contact points"),
        "{message}"
    );
    assert!((warns(finding, "contact.obstacle")[0] - 0.125).abs() < 1e-15);
    // What is added to the distance counts, and the sign of a level.
    no_word(block(&[&floor("0.125"), "contact.gap=0.125"]));
    no_word(block(&[&floor("t")]));
    no_word(block(&[&floor("1e-16")]));
    no_word(block(&[&floor("-0.1 + t")]));
    let level = |level: &str| block(&[&format!("contact.obstacle={{ shape = \"surface\", level = \"{level}\" }}")]);
    no_word(level("y + 0.01 + x/10"));
    let [deep, _] = warns(level("-y - 0.01 - x/10"), "contact.obstacle");
    assert!((deep - 0.21 / 1.01f64.sqrt()).abs() < 1e-12, "{deep}");
    // The gap of a foundation is a datum: a preload is meant.
    no_word(block(&["contact.gap=-1e-3"]));
    no_word(block(&["contact.gap=-0.03"]));
    // The body may start elsewhere.
    warns(block(&[&floor("-0.1 + t"), "initial={ displacement = [0, -0.15] }"]), "contact.obstacle");
    no_word(block(&[&floor("0.125"), "initial={ displacement = [0, 0.125] }"]));
}

/// The mean of a constant dilatation is itself: of linear triangles and tetrahedra it is told, of other cells not.
#[test]
fn a_mean_dilatation_that_changes_nothing() {
    let of = |elements: &str| {
        let elements = format!("mesh.elements=\"{elements}\"");
        told(&problem(crate::BLOCK, &["material.dilatation=\"mean\"", &elements]), "mean-dilatation")
    };
    let [cells, none] = warns(of("P1"), "material.dilatation");
    assert_eq!([cells, none], [64.0, 0.0]);
    for elements in ["P2", "Q1", "Q2"] {
        no_word(of(elements));
    }
    no_word(told(&problem(crate::BLOCK, &[]), "mean-dilatation"));
}
