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
const NAMED: &str = "material = { base = \"steel-s235\", stress_state = \"plane-stress\" }\n";

/// A material by its name is the table that the program prints for it: the runs have the same bits.
#[test]
fn a_name_stands_for_a_table() -> Result<(), CaseError> {
    let written = "[material]\ndensity = 7850\nheat_capacity = 3452430.0\nconductivity = 53.3\n\
                   expansion_coefficient = 12e-6\nelasticity = { law = \"isotropic\", young = 210e9, poisson = 0.3, stress_state = \"plane-stress\" }\n";
    let [named, based, plain] =
        [NAMED, "[material]\nbase = \"steel-s235\"\nstress_state = \"plane-stress\"\n", written]
            .map(|material| parse(&text(material, HEATED)));
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
    for (more, expected) in [(PULLED, Physics::Mechanics), (HEATED, Physics::Coupled)] {
        assert_eq!(parse(&text(NAMED, more))?.problem.physics, expected, "{more}");
    }
    // Heat asks nobody how the body is held.
    assert_eq!(parse(&text("material = \"steel-s235\"\n", WARM))?.problem.physics, Physics::Heat);
    let conducts = "[material]\nbase = \"steel-s235\"\nstress_state = \"plane-stress\"\nconductivity = 40\n";
    assert_eq!(parse(&text(conducts, PULLED))?.problem.physics, Physics::Coupled);
    // Its stress state is a word of mechanics.
    assert_eq!(parse(&text(NAMED, ""))?.problem.physics, Physics::Mechanics);
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
        ("stress_state = \"plane-stress\"\n", e / (1.0 - nu * nu)),
        ("stress_state = \"plane-strain\"\n", e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))),
        ("elasticity = { law = \"isotropic\", young = 1e9, poisson = 0, stress_state = \"plane-stress\" }\n", 1e9),
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
    let chapter = std::fs::read_to_string(common::file("book/src/materials.md")).expect("the chapter");
    for (name, m) in case::materials() {
        let [young, expansion] = [m.young / 1e9, (m.expansion_coefficient * 1e12).round() / 1e6];
        let numbers = [young, m.poisson, m.density, expansion, m.specific_heat, m.conductivity];
        let cells: Vec<String> = numbers.iter().map(ToString::to_string).collect();
        let row = format!("| `{name}` | {} | {} | {} |\n", m.title, cells.join(" | "), m.source);
        assert!(chapter.contains(&row), "{row}");
    }
}

/// Of a plane body somebody says how the third direction is held: the case, or the elements of its file.
#[test]
fn nobody_guesses_the_stress_state() {
    const LAW: &str = "elasticity = { law = \"isotropic\", young = 1.0, poisson = 0.4 }\n";
    let body = |mesh: &str, material: &str, elements: &str| {
        let file = format!(
            "*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n5,2,0\n6,2,1\n*ELEMENT,TYPE={elements},ELSET=A\n1,1,2,3,4\n\
             *ELEMENT,TYPE=CPE4,ELSET=B\n2,2,5,6,3\n*NSET,NSET=top\n3,4\n"
        );
        let text = format!("name = \"body\"\n[mesh]\n{mesh}\n[time]\nend = 1\nsteps = 1\n[material]\n{material}");
        let files = [("body.inp".to_owned(), std::sync::Arc::from(file.into_bytes()))].into();
        Source { files: case::Files::Memory(files), ..Source::new("body.toml", text) }
    };
    let mechanics = format!("density = 1\n{LAW}");
    let rectangle = "kind = \"rectangle\"\nsize = [1, 1]\nn = 1";
    let expected = "material.elasticity.stress_state: found no such key, expected \"plane-stress\" or \"plane-strain\" of a plane \
                    body; \"plane-stress\" is a thin sheet whose faces are free, \"plane-strain\" a long body whose ends are held";
    let file = "file = \"body.inp\"";
    for (mesh, elements) in [(rectangle, ""), (file, "CPS4")] {
        let message = told(&body(mesh, &mechanics, elements), &[]);
        assert!(message.contains(expected) && message.lines().count() == 1, "{mesh}, {elements}: {message}");
    }
    let named = told(&body(rectangle, "base = \"steel-s235\"\ndensity = 1\n", ""), &[]);
    assert!(named.contains("material.stress_state: found no such key") && named.contains("{ base = NAME, "), "{named}");

    let strain = Sym::from_fn(2, |i, j| if i == j { 1e-3 } else { 0.0 });
    let stress = |source: &Source| {
        let case = case::parse(source, &[]).unwrap_or_else(|error| panic!("{error}"));
        case.problem.materials[0].stress(&[0.0; 3], &strain, &Sym::ZERO, 0.0).get(0, 0)
    };
    // Under ε_x = ε_y: E ε/(1 − ν) with free faces, E ε/((1 + ν)(1 − 2ν)) between held ones.
    let (free, held) = (1e-3 / 0.6, 1e-3 / (1.4 * 0.2));
    let near = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-12, "{found:e}, {expected:e}");
    near(stress(&body(file, &mechanics, "CPE4")), held);
    let given = |state: &str| mechanics.replace(" }", &format!(", stress_state = \"{state}\" }}"));
    near(stress(&body(file, &given("plane-stress"), "CPE4")), free);
    near(stress(&body(file, &given("plane-strain"), "CPS4")), held);
    near(stress(&body(rectangle, &given("plane-stress"), "")), free);
    // A bar, a body of revolution, one in space and one of heat alone are asked nothing.
    for (mesh, material) in [
        ("kind = \"interval\"\nsize = 1\nn = 2", mechanics.as_str()),
        ("kind = \"rectangle\"\nsize = [1, 1]\nn = 1\naxisymmetric = true", &mechanics),
        ("kind = \"box\"\nsize = [1, 1, 1]\nn = 1", &mechanics),
        (rectangle, "heat_capacity = 1\nconductivity = 1\n"),
    ] {
        let message = case::parse(&body(mesh, material, ""), &[]).err().map(|error| error.to_string());
        assert!(message.is_none_or(|told| !told.contains("stress_state")), "{mesh}");
    }
}
