//! Cases of mechanics alone and of heat alone, and the coefficient of thermal expansion.
#![allow(clippy::float_cmp, reason = "zeros are exact")]

use std::fs;

use crate::common::told;
use amontons::case::{self, Source};
use amontons::output::{Folder, FolderOptions, Memory, Summary};
use amontons::run::{self, Settings};
use amontons::state::State;

fn solved(text: &str, overrides: &[&str]) -> (State, Summary) {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let case = case::parse(&Source::new("case.toml", text), &overrides).unwrap_or_else(|error| panic!("{error}"));
    let mut memory = Memory::default();
    let summary =
        run::run(&case.problem, &Settings::default(), &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    (memory.states.last().expect("a state").clone(), summary)
}

/// A block that is pressed onto a compliant foundation, without any key of heat.
const MECHANICS: &str = r#"
name = "mechanics"
[mesh]
kind = "rectangle"
size = [1, 1]
n = [8, 8]
[time]
end = 1
steps = 4
[material]
density = 0
elasticity = { law = "isotropic", young = 10, poisson = 0.3, stress_state = "plane-stress" }
[[boundary]]
on = "top"
displacement = [0.01, -0.02]
[contact]
on = "bottom"
normal = { law = "compliance", stiffness = 100 }
friction = { law = "coulomb", coefficient = 0.3 }
"#;

/// A plate that is heated inside and cooled at its sides, without any key of mechanics.
const HEAT: &str = r#"
name = "heat"
[mesh]
kind = "rectangle"
size = [1, 0.25]
n = [16, 4]
elements = "P2"
[time]
end = 0.5
steps = 8
[material]
heat_capacity = 0
conductivity = 2
[load]
heat_source = 3
[[boundary]]
on = "left"
temperature = 1
[[boundary]]
on = "right"
temperature = 1
"#;

/// The same problem with every key of heat, zero or without effect, gives the same motion to the last bit.
#[test]
fn mechanics_alone_is_the_problem_without_heat() {
    let (alone, summary) = solved(MECHANICS, &[]);
    let with_heat = [
        "material.heat_capacity=1",
        "material.conductivity=1",
        "material.expansion=0",
        "material.coupling=0",
        "material.viscosity={ law = \"lame\", first = 0, second = 0 }",
    ];
    let (both, coupled) = solved(MECHANICS, &with_heat);
    assert_eq!((&alone.u, &alone.w), (&both.u, &both.w));
    assert!(alone.u.iter().any(|&u| u != 0.0) && alone.theta.iter().all(|&theta| theta == 0.0));
    // One factorization and two sweeps per step: nothing is done for a heat half-step.
    assert_eq!((summary.solver.factorizations, coupled.solver.factorizations), (1, 2));
    assert_eq!((summary.unknowns.temperature, summary.solver.newton_heat_total), (0, 0));
    assert_eq!(coupled.solver.sweeps, summary.solver.sweeps + 2 * 4);
    assert_eq!((summary.last.temperature_min, summary.last.temperature_max), (None, None));
    assert!(coupled.last.temperature_min.is_some() && summary.last.von_mises_max == coupled.last.von_mises_max);
    let ids: Vec<&str> = summary.findings.iter().map(|finding| finding.id.as_str()).collect();
    assert!(["H1", "H2", "H6", "H8", "step-unique", "energy"].iter().all(|id| ids.contains(id)), "{ids:?}");
    assert!(!["H3", "H4", "H5", "H7", "phi-L", "heat"].iter().any(|id| ids.contains(id)), "{ids:?}");
}

/// −2θ″ = 3 between ends at 1: θ = 1 + ¾ x (1 − x), which quadratic elements have exactly.
#[test]
fn heat_alone_is_conduction() {
    let (state, summary) = solved(HEAT, &[]);
    let case = case::parse(&Source::new("case.toml", HEAT), &[]).expect("a case");
    for (point, theta) in case.problem.mesh.points.iter().zip(&state.theta) {
        assert!((theta - (1.0 + 0.75 * point[0] * (1.0 - point[0]))).abs() < 1e-13, "{point:?}: {theta}");
    }
    assert!(state.u.iter().chain(&state.w).all(|&v| v == 0.0));
    assert_eq!((summary.solver.factorizations, summary.solver.sweeps, summary.unknowns.displacement), (1, 2 * 8, 0));
    assert_eq!((summary.last.von_mises_max, summary.last.displacement_max.len()), (None, 0));
    let ids: Vec<&str> = summary.findings.iter().map(|finding| finding.id.as_str()).collect();
    assert_eq!(ids, ["H3", "H6", "mesh-quality", "heat"]);
}

/// The decay of the first sine mode in time, by backward Euler: each step divides by 1 + k κ π²/c.
#[test]
fn heat_alone_decays_by_its_own_factor() {
    let overrides = [
        "mesh.n=[64, 1]",
        "mesh.size=[1, 0.1]",
        "load.heat_source=0",
        "material.heat_capacity=4",
        "initial.temperature=\"sin(pi*x)\"",
        "boundary[0].temperature=0",
        "boundary[1].temperature=0",
    ];
    let (state, _) = solved(HEAT, &overrides);
    let factor = 1.0 + 0.0625 * 2.0 * std::f64::consts::PI.powi(2) / 4.0;
    let most = state.theta.iter().copied().fold(0.0, f64::max);
    assert!((most * factor.powi(8) - 1.0).abs() < 1e-5, "{most}");
}

#[test]
fn results_have_only_the_fields_of_the_case() {
    for (text, absent, present) in [
        (MECHANICS, vec!["temperature", "heat_flux"], vec!["displacement", "von_mises"]),
        (HEAT, vec!["displacement", "velocity", "stress", "von_mises"], vec!["temperature", "heat_flux"]),
    ] {
        let case = case::parse(
            &Source::new("case.toml", text),
            &["output.fields=[\"stress\", \"heat-flux\", \"nodal-stress\"]".to_owned()],
        )
        .expect("a case");
        let folder = tempfile(&case.problem.name);
        let mut results = Folder::create(&folder, FolderOptions { every: 0, force: true, ..case.folder_options() })
            .expect("a folder");
        run::run(&case.problem, &Settings::default(), &mut [&mut results]).expect("a run");
        let file =
            fs::read(folder.join(format!("fields/step_{:07}.vtu", case.problem.timeline.steps()))).expect("the fields");
        let fields = String::from_utf8_lossy(&file);
        for name in &absent {
            assert!(!fields.contains(&format!("Name=\"{name}\"")), "{name}");
        }
        for name in &present {
            assert!(fields.contains(&format!("Name=\"{name}\"")), "{name}");
        }
        let summary: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(folder.join("summary.json")).expect("a summary")).expect("JSON");
        // Names stay: what there is not is null.
        let is_null = |key: &str| summary["final"].as_object().expect("a table")[key].is_null();
        let (mechanics, heat) = (present[0] == "displacement", present[0] == "temperature");
        assert_eq!([is_null("temperature_max"), is_null("von_mises_max")], [mechanics, heat]);
        let norms = &summary["final"]["norms"];
        assert_eq!(
            [norms["temperature_l2"].is_null(), norms["displacement_v"].is_null(), is_null("contact")],
            [mechanics, heat, heat]
        );
        let contact = fs::read_to_string(folder.join("contact.csv")).expect("contact");
        let header: Vec<&str> = contact.lines().next().expect("a header").split(',').collect();
        let column = header.iter().position(|name| *name == "temperature").expect("a column");
        assert!(
            contact
                .lines()
                .skip(1)
                .all(|row| row.split(',').nth(column) == Some("") && row.split(',').count() == header.len())
        );
        // Pictures and the verification from files go by what is there.
        let pictures = amontons::plot::folder(&folder, &amontons::plot::Options::default())
            .unwrap_or_else(|error| panic!("{error}"));
        let has = |name: &str| pictures.iter().any(|path| path.ends_with(format!("plots/{name}.svg")));
        assert_eq!([has("temperature"), has("von-mises")], [present[0] == "temperature", present[0] == "displacement"]);
        let history = fs::read_to_string(folder.join("plots/history.svg")).expect("a picture");
        let balances = ["energy", "heat"].map(|name| history.contains(&format!("closing error of the {name} balance")));
        assert_eq!(balances, [mechanics, heat]);
        let found = amontons::verify::recompute(&folder).expect("a run");
        assert!(found.holds(), "{found:?}");
        fs::remove_dir_all(&folder).expect("a folder");
    }
}

fn tempfile(name: &str) -> std::path::PathBuf {
    std::env::temp_dir().join(format!("amontons-physics-{name}-{}", std::process::id()))
}

/// Each key of an equation that the case does not have is named, and each that its own equation needs.
#[test]
fn keys_of_equations_that_a_case_lacks_are_named() {
    let said = |text: &str, overrides: &[&str]| told(&Source::new("case.toml", text), overrides);
    assert_eq!(
        said(MECHANICS, &["boundary[0].temperature=3"]),
        "--set boundary[0].temperature=3: boundary[0].temperature: found a temperature in a case without heat, expected keys of mechanics only: no material has any of heat; remove it, or give material.heat_capacity and material.conductivity"
    );
    for (key, value) in [
        ("load.heat_source", "1"),
        ("initial.temperature", "1"),
        ("contact.frictional_heat", "0.5"),
        ("contact.foundation", "{ heat_capacity = 1 }"),
        ("contact.heat", "{ law = \"pressure\", coefficient = 1, foundation_temperature = 0 }"),
        ("contact.friction", "{ law = \"temperature\", temperature = [0, 1], coefficient = [0, 1] }"),
        ("contact.wear", "{ law = \"archard-temperature\", temperature = [0, 1], coefficient = [0, 1] }"),
    ] {
        let text = said(MECHANICS, &[&format!("{key}={value}")]);
        assert!(
            text.contains(&format!(": {key}: found "))
                && text.contains("in a case without heat")
                && text.lines().count() == 1,
            "{text}"
        );
    }
    for (key, value) in [
        ("load.body_force", "[0, 1]"),
        ("boundary[0].traction", "[0, 1]"),
        ("initial.velocity", "[0, 1]"),
        ("boundary[1].spring", "2"),
    ] {
        let text = said(HEAT, &[&format!("{key}={value}")]);
        assert!(
            text.contains(&format!(": {key}: found "))
                && text.contains("in a case without mechanics")
                && text.lines().count() == 1,
            "{text}"
        );
    }
    let needs = |text: &str, set: &str, key: &str| {
        let told = said(text, &[set]);
        assert!(told.contains(&format!("material.{key}: found no such key, expected ")), "{told}");
    };
    needs(MECHANICS, "material.conductivity=1", "heat_capacity");
    needs(MECHANICS, "material.heat_capacity=1", "conductivity");
    needs(MECHANICS, "material.expansion=1", "conductivity");
    needs(HEAT, "material.density=1", "elasticity");
    needs(HEAT, "material.expansion_coefficient=1e-5", "elasticity");
    let probe = "probe=[{ name = \"p\", quantity = \"temperature\", at = [0.5, 0.5] }]";
    assert!(said(MECHANICS, &[probe]).contains("temperature, a field that the case does not solve for"));
}

/// A case of expansion under the temperature rise 40 everywhere; E = 200, ν = 0.25, α = 1e-3.
fn expansion(mesh: &str, material: &str, boundary: &str) -> String {
    format!(
        r#"
name = "expansion"
[mesh]
{mesh}
[time]
end = 1
steps = 1
[initial]
temperature = 40
[material]
density = 0
heat_capacity = 1
conductivity = 1
{material}
{boundary}
"#
    )
}

const PLANE: &str = "kind = \"rectangle\"\nsize = [2, 1]\nn = [4, 2]";
const SPACE: &str = "kind = \"box\"\nsize = [2, 1, 1]\nn = [2, 1, 1]\nelements = \"Q1\"";
const REVOLUTION: &str = "kind = \"rectangle\"\nsize = [2, 1]\nn = [4, 2]\nelements = \"Q2\"\naxisymmetric = true";

fn isotropic(state: &str) -> String {
    let state = if state.is_empty() { String::new() } else { format!(", stress_state = \"{state}\"") };
    format!("expansion_coefficient = 1e-3\nelasticity = {{ law = \"isotropic\", young = 200, poisson = 0.25{state} }}")
}

/// Symmetry planes at x = 0, y = 0 (and z = 0): the body may expand.
fn free(dim: usize) -> String {
    let side = |on: &str| format!("[[boundary]]\non = \"{on}\"\nnormal_displacement = 0\n");
    ["left", "bottom", "back"].iter().take(dim).map(|on| side(on)).collect()
}

/// All sides held along their normals.
fn clamped(dim: usize) -> String {
    let side = |on: &str| format!("[[boundary]]\non = \"{on}\"\nnormal_displacement = 0\n");
    ["left", "right", "bottom", "top", "back", "front"].iter().take(2 * dim).map(|on| side(on)).collect()
}

/// Strain and stress of every cell, which must be the same: xx yy zz xy.
fn uniform(text: &str) -> [[f64; 4]; 2] {
    let (state, _) = solved(text, &[]);
    let case = case::parse(&Source::new("case.toml", text), &[]).expect("a case");
    let cells = amontons::output::cell_values(&case.problem, &state);
    let of = |tensor: &amontons::tensor::Sym| [(0, 0), (1, 1), (2, 2), (0, 1)].map(|(i, j)| tensor.get(i, j));
    let [strain, stress] = [of(&cells[0].strain), of(&cells[0].stress)];
    for cell in &cells {
        for (found, first) in of(&cell.strain).iter().chain(&of(&cell.stress)).zip(strain.iter().chain(&stress)) {
            assert!((found - first).abs() < 1e-11, "not uniform: {found} {first}");
        }
    }
    [strain, stress]
}

fn assert_near(found: [f64; 4], expected: [f64; 4], what: &str) {
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-11, "{what}: {found}, expected {expected}");
    }
}

/// αΔT = 0.04 (Timoshenko and Goodier, Theory of Elasticity, chapter 13).
#[test]
fn isotropic_expansion_has_its_closed_forms() {
    let (strain, young, nu) = (0.04, 200.0, 0.25);
    let [e, s] = uniform(&expansion(PLANE, &isotropic("plane-stress"), &free(2)));
    assert_near(e, [strain, strain, 0.0, 0.0], "free, plane stress");
    assert_near(s, [0.0; 4], "free, plane stress");
    // In plane strain the third direction is held: the strain in the plane grows by 1 + ν, and σ₃₃ = −EαΔT.
    let [e, s] = uniform(&expansion(PLANE, &isotropic("plane-strain"), &free(2)));
    assert_near(e, [(1.0 + nu) * strain, (1.0 + nu) * strain, 0.0, 0.0], "free, plane strain");
    assert_near(s, [0.0, 0.0, -young * strain, 0.0], "free, plane strain");
    for (mesh, dim, what) in [(SPACE, 3, "in space"), (REVOLUTION, 1, "revolution")] {
        let sides =
            if dim == 3 { free(3) } else { "[[boundary]]\non = \"bottom\"\nnormal_displacement = 0\n".to_owned() };
        let [e, s] = uniform(&expansion(mesh, &isotropic(""), &sides));
        assert_near(e, [strain, strain, strain, 0.0], what);
        assert_near(s, [0.0; 4], what);
    }
    // Clamped: −EαΔT/(1 − ν) in plane stress, −EαΔT/(1 − 2ν) where all three directions are held.
    let [e, s] = uniform(&expansion(PLANE, &isotropic("plane-stress"), &clamped(2)));
    let (in_plane, in_space) = (-young * strain / (1.0 - nu), -young * strain / (1.0 - 2.0 * nu));
    assert_near(e, [0.0; 4], "clamped, plane stress");
    assert_near(s, [in_plane, in_plane, 0.0, 0.0], "clamped, plane stress");
    for (mesh, state, dim, what) in [
        (PLANE, "plane-strain", 2, "clamped, plane strain"),
        (SPACE, "", 3, "clamped in space"),
        (REVOLUTION, "", 2, "clamped, revolution"),
    ] {
        let [_, s] = uniform(&expansion(mesh, &isotropic(state), &clamped(dim)));
        assert_near(s, [in_space, in_space, in_space, 0.0], what);
    }
    // A rod: uniaxial stress and uniaxial strain.
    let rod = "kind = \"interval\"\nsize = 1\nn = 2";
    for (state, stress) in [("plane-stress", -young * strain), ("plane-strain", in_space)] {
        let [_, s] = uniform(&expansion(rod, &isotropic(state), &clamped(1)));
        assert!((s[0] - stress).abs() < 1e-11, "{state}: {} {stress}", s[0]);
    }
}

/// An orthotropic body with turned axes expands freely by α turned, without stress; clamped it has the stress of the
/// compliance, solved here.
#[test]
fn orthotropic_expansion_follows_the_axes_of_the_material() {
    let (angle, along) = (0.4f64, [1e-3, 3e-3, -5e-4]);
    let material = |state: &str| {
        format!(
            "expansion_coefficient = [1e-3, 3e-3, -5e-4]\nelasticity = {{ law = \"orthotropic\", young = [300, 100, 50], poisson = [0.3, 0.2, 0.25], shear = [60, 40, 30], orientation = {angle}{state} }}"
        )
    };
    let (c, s) = (angle.cos(), angle.sin());
    let turned = [
        c * c * along[0] + s * s * along[1],
        s * s * along[0] + c * c * along[1],
        along[2],
        c * s * (along[0] - along[1]),
    ]
    .map(|a| 40.0 * a);
    // Held at a point and against rotation only: x = 0 at one node would need a node set, so a soft spring holds the
    // body.
    let sides = "[[boundary]]\non = \"left\"\nspring = [1e-9, 1e-9]\n";
    let (plane_stress, plane_strain) = (", stress_state = \"plane-stress\"", ", stress_state = \"plane-strain\"");
    let [e, stress] = uniform_loosely(&expansion(PLANE, &material(plane_stress), sides));
    for (found, expected) in
        [(e[0], turned[0]), (e[1], turned[1]), (e[3], turned[3]), (stress[0], 0.0), (stress[1], 0.0), (stress[3], 0.0)]
    {
        assert!((found - expected).abs() < 1e-7, "{found} {expected}");
    }
    // Clamped in plane strain and in space: σ = −𝓔α ΔT, in the axes of the material −C α with C the inverse of the
    // compliance.
    let compliance = [
        [1.0 / 300.0, -0.3 / 300.0, -0.2 / 300.0],
        [-0.3 / 300.0, 1.0 / 100.0, -0.25 / 100.0],
        [-0.2 / 300.0, -0.25 / 100.0, 1.0 / 50.0],
    ];
    let sigma = solve3(compliance, along.map(|a| -40.0 * a));
    let expected = [
        c * c * sigma[0] + s * s * sigma[1],
        s * s * sigma[0] + c * c * sigma[1],
        sigma[2],
        c * s * (sigma[0] - sigma[1]),
    ];
    let all = |dim: usize, sides: &[&str]| -> String {
        sides
            .iter()
            .map(|on| {
                format!(
                    "[[boundary]]\non = \"{on}\"\ndisplacement = {}\n",
                    if dim == 3 { "[0, 0, 0]" } else { "[0, 0]" }
                )
            })
            .collect()
    };
    let [_, found] = uniform(&expansion(PLANE, &material(plane_strain), &all(2, &["left", "right", "bottom", "top"])));
    assert_near(found, expected, "clamped, plane strain");
    let [_, found] =
        uniform(&expansion(SPACE, &material(""), &all(3, &["left", "right", "bottom", "top", "back", "front"])));
    assert_near(found, expected, "clamped in space");
    // Clamped in plane stress: the compliance of the plane alone.
    let plane =
        solve2([[1.0 / 300.0, -0.3 / 300.0], [-0.3 / 300.0, 1.0 / 100.0]], [-40.0 * along[0], -40.0 * along[1]]);
    let expected =
        [c * c * plane[0] + s * s * plane[1], s * s * plane[0] + c * c * plane[1], 0.0, c * s * (plane[0] - plane[1])];
    let [_, found] = uniform(&expansion(PLANE, &material(plane_stress), &all(2, &["left", "right", "bottom", "top"])));
    assert_near(found, expected, "clamped, plane stress");
}

/// Strain and stress of the first cell.
fn uniform_loosely(text: &str) -> [[f64; 4]; 2] {
    let (state, _) = solved(text, &[]);
    let case = case::parse(&Source::new("case.toml", text), &[]).expect("a case");
    let cell = amontons::output::cell_values(&case.problem, &state)[0];
    [&cell.strain, &cell.stress].map(|tensor| [(0, 0), (1, 1), (2, 2), (0, 1)].map(|(i, j)| tensor.get(i, j)))
}

/// Cramer's rule.
fn solve2(a: [[f64; 2]; 2], b: [f64; 2]) -> [f64; 2] {
    let det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    [(b[0] * a[1][1] - a[0][1] * b[1]) / det, (a[0][0] * b[1] - b[0] * a[1][0]) / det]
}

fn solve3(a: [[f64; 3]; 3], b: [f64; 3]) -> [f64; 3] {
    let det = |m: [[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    std::array::from_fn(|c| {
        let mut with = a;
        for r in 0..3 {
            with[r][c] = b[r];
        }
        det(with) / det(a)
    })
}

/// A law that is not linear is linear in the change of volume, so a single coefficient is exact where no direction is
/// condensed.
#[test]
fn nonlinear_laws_take_a_single_coefficient_where_it_is_exact() {
    // κ = 4, so 𝓜 = 3κα and a clamped body has the pressure 3κ·0.04.
    let hencky = |state: &str| {
        format!(
            "expansion_coefficient = 1e-3\nelasticity = {{ law = \"hencky\", bulk = 4, shear = 3, shear_infinite = 1, strain = 0.01, exponent = 0.5{state} }}"
        )
    };
    let [_, s] = uniform(&expansion(PLANE, &hencky(", stress_state = \"plane-strain\""), &clamped(2)));
    assert_near(s, [-0.48, -0.48, -0.48, 0.0], "clamped, plane strain");
    let said = |text: &str| told(&Source::new("case.toml", text), &[]);
    assert!(
        said(&expansion(PLANE, &hencky(""), &clamped(2)))
            .contains("material.expansion_coefficient: found a law of elasticity that is not linear")
    );
}

#[test]
fn faults_of_expansion_are_named() {
    let said = |text: &str, overrides: &[&str]| told(&Source::new("case.toml", text), overrides);
    let case = expansion(PLANE, &isotropic("plane-stress"), &free(2));
    assert_eq!(
        said(&case, &["material.expansion=1"]),
        "case.toml:16:25: material.expansion_coefficient: found `expansion` besides it, expected either `expansion` or `expansion_coefficient`; remove one of the two: 𝓜 = 𝓔α follows from the coefficient"
    );
    let turned = "expansion_coefficient = [1e-3, 2e-3, 3e-3]\nelasticity = { law = \"orthotropic\", young = [3, 2, 1], poisson = [0.1, 0.1, 0.1], shear = [1, 1, 1], orientation = [0.1, 0.2, 0.3] }";
    let text = said(&expansion(REVOLUTION, turned, "[[boundary]]\non = \"bottom\"\nnormal_displacement = 0\n"), &[]);
    assert!(text.contains("material.expansion_coefficient: found a component rθ or zθ"), "{text}");
    assert!(
        said(&case, &["material.expansion_coefficient=[1, 2]"]).contains("found an array of 2, expected an array of 3")
    );
}
