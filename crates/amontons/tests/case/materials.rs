//! Materials by name: `material = "steel-s235"`.

use crate::common::{self, told};
use amontons::case::{self, Case, CaseError, Source};
use amontons::problem::Physics;
use amontons::tensor::Sym;

/// A bar of a material that is written by `material`, with `more`.
fn text(material: &str, more: &str) -> String {
    format!(
        "name = \"bar\"\n{}[mesh]\nkind = \"rectangle\"\nsize = [1.0, 0.5]\nn = 2\n[time]\nend = 1.0\nsteps = 2\n{}{more}",
        if material.starts_with('[') { "" } else { material },
        if material.starts_with('[') { material } else { "" },
    )
}

fn parse(text: &str) -> Result<Case, CaseError> {
    case::parse(&Source::new("bar.toml", text), &[])
}

const PULLED: &str =
    "[[boundary]]\non = \"left\"\ndisplacement = [0, 0]\n[[boundary]]\non = \"right\"\ntraction = [1e6, 0]\n";
const HEATED: &str = "[[boundary]]\non = \"left\"\ndisplacement = [0, 0]\ntemperature = \"20 °C\"\n";
const WARM: &str = "[[boundary]]\non = \"left\"\ntemperature = \"20 °C\"\n";
const NAMED: &str = "material = \"steel-s235\"\n";

/// A material by its name is the table that the program prints for it: the runs have the same bits.
#[test]
fn a_name_stands_for_a_table() -> Result<(), CaseError> {
    let written = "[material]\ndensity = 7850\nheat_capacity = 3452430.0\nconductivity = 53.3\n\
                   expansion_coefficient = 12e-6\nelasticity = { law = \"isotropic\", young = 210e9, poisson = 0.3 }\n";
    let [named, based, plain] =
        [NAMED, "[material]\nbase = \"steel-s235\"\n", written].map(|material| parse(&text(material, HEATED)));
    let last = |case: Result<Case, CaseError>| {
        let run = common::solve(&case?.problem);
        let state = run.states.last().expect("a state").clone();
        Ok(state.u.iter().chain(&state.theta).map(|v| v.to_bits()).collect::<Vec<_>>())
    };
    let (named, based, plain): (Vec<u64>, Vec<u64>, Result<Vec<u64>, CaseError>) =
        (last(named)?, last(based)?, last(plain));
    assert!(plain.as_ref().is_ok_and(|plain| plain.iter().any(|bits| *bits != 0)));
    assert_eq!(
        (Ok(&named), Ok(&based)),
        (plain.as_ref().map_err(ToString::to_string), plain.as_ref().map_err(ToString::to_string))
    );
    Ok(())
}

/// The equations are those that the rest of the case is about.
#[test]
fn a_name_says_nothing_of_the_equations() -> Result<(), CaseError> {
    for (more, expected) in [(PULLED, Physics::Mechanics), (WARM, Physics::Heat), (HEATED, Physics::Coupled)] {
        assert_eq!(parse(&text(NAMED, more))?.problem.physics, expected, "{more}");
    }
    let conducts = "[material]\nbase = \"steel-s235\"\nconductivity = 40\n";
    assert_eq!(parse(&text(conducts, PULLED))?.problem.physics, Physics::Coupled);
    assert_eq!(parse(&text(NAMED, ""))?.problem.physics, Physics::Coupled);
    Ok(())
}

/// Keys that are given take the place of those of the material.
#[test]
fn keys_beside_a_name_hold() -> Result<(), CaseError> {
    let strain = Sym::from_fn(2, |i, j| if (i, j) == (0, 0) { 1e-3 } else { 0.0 });
    let stress = |material: &str| -> Result<f64, CaseError> {
        let case = parse(&text(material, PULLED))?;
        let material = &case.problem.materials[0];
        assert_eq!(material.density.at(&[0.0; 3]).to_bits(), 0);
        Ok(material.stress(&[0.0; 3], &strain, &Sym::ZERO, 0.0).get(0, 0))
    };
    let base = "[material]\nbase = \"steel-s235\"\ndensity = 0\n";
    let (e, nu) = (210e9, 0.3);
    for (more, expected) in [
        ("", e / (1.0 - nu * nu)),
        ("stress_state = \"plane-strain\"\n", e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))),
        ("elasticity = { law = \"isotropic\", young = 1e9, poisson = 0 }\n", 1e9),
    ] {
        let found = stress(&format!("{base}{more}"))?;
        assert!((found - 1e-3 * expected).abs() < 1e-12 * 1e-3 * expected, "{more}: {found:e}");
    }
    Ok(())
}

#[test]
fn faults_are_told() {
    for (material, more, expected) in [
        (
            "material = \"steel-s253\"\n",
            HEATED,
            "bar.toml:2:12: material.base: found \"steel-s253\", expected the name of a material; did you mean \"steel-s235\"?",
        ),
        (
            "[material]\nbase = \"adamantium\"\n",
            HEATED,
            "bar.toml:10:8: material.base: found \"adamantium\", expected the name of a material; `amontons materials` lists them",
        ),
        (
            "[material]\nstress_state = \"plane-strain\"\ndensity = 1\nelasticity = { law = \"isotropic\", young = 1, poisson = 0 }\n",
            PULLED,
            "bar.toml:10:16: material.stress_state: found a stress state without `base`, expected `elasticity.stress_state`",
        ),
        (
            "material = 7850\n",
            HEATED,
            "bar.toml:2:12: material: found 7850, expected a table or the name of a material (material of the body, except in \
             regions with their own)",
        ),
        (
            NAMED,
            "[[region]]\non = \"body\"\nmaterial = \"glass\"\n",
            "bar.toml:12:12: region[0].material.base: found \"glass\", expected the name of a material; `amontons materials` \
             lists them",
        ),
    ] {
        assert_eq!(told(&Source::new("bar.toml", text(material, more)), &[]), expected);
    }
}

/// The table of the chapter has the values of the program.
#[test]
fn the_chapter_lists_them_all() {
    let chapter = std::fs::read_to_string(common::file("book/src/meshes.md")).expect("the chapter");
    for (name, m) in case::materials() {
        let [young, expansion] = [m.young / 1e9, (m.expansion_coefficient * 1e12).round() / 1e6];
        let numbers = [young, m.poisson, m.density, expansion, m.specific_heat, m.conductivity];
        let cells: Vec<String> = numbers.iter().map(ToString::to_string).collect();
        let row = format!("| `{name}` | {} | {} | {} |\n", m.title, cells.join(" | "), m.source);
        assert!(chapter.contains(&row), "{row}");
    }
}
