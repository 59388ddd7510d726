//! One case said in two ways: with a thickness, without inertia, and with laws as formulas.

use amontons::case::{self, Source};
use amontons::output::{Memory, Summary};
use amontons::run::{Settings, run};

/// A block that is pressed onto another one and dragged over it, with heat; the second lies on a foundation.
const PAIR: &str = r#"
name = "pair"
[mesh]
kind = "blocks"
blocks = [
    { name = "up", size = [1.0, 0.5], origin = [0.1, 0.4], n = [5, 3] },
    { name = "low", size = [1.4, 0.4], n = [6, 2] },
]
[time]
end = 0.5
steps = 6
[material]
density = 2.0
heat_capacity = 1.0
conductivity = 1.0
expansion = 0.3
coupling = 0.2
elasticity = { law = "isotropic", young = 100.0, poisson = 0.3, stress_state = "plane-strain" }
viscosity = { law = "lame", first = 0.2, second = 0.3 }
[load]
body_force = [0.0, -0.5]
[[boundary]]
on = "up_top"
displacement = ["0.1*t", "-0.05*t"]
temperature = "3*t"
[[boundary]]
on = "up_left"
traction = [0.3, 0]
heat_inflow = 0.4
[[contact]]
on = "up_bottom"
with = "low_top"
normal = { law = "compliance", stiffness = 2e3 }
friction = { law = "coulomb", coefficient = 0.3 }
frictional_heat = 0.5
heat = { law = "constant", conductance = 2.0 }
[[contact]]
on = "low_bottom"
normal = { law = "compliance", stiffness = 3e3 }
friction = { law = "coulomb", coefficient = 0.5 }
"#;

fn solved(text: &str, overrides: &[&str]) -> (Summary, Memory) {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let case = case::parse(&Source::new("pair.toml", text), &overrides).unwrap_or_else(|error| panic!("{error}"));
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    let summary = run(&case.problem, &settings, &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    (summary, memory)
}

/// A text with a key above its tables.
fn above(text: &str, key: &str) -> String {
    format!("{key}\n{text}")
}

/// A power of two as thickness changes no bit of the fields and multiplies every integral; another one changes their
/// round-off. The units are those of the whole body.
#[test]
fn a_thickness_multiplies_integrals_alone() {
    let (one, states) = solved(PAIR, &[]);
    for (thickness, tolerance) in [(0.25, 0.0), (0.01, 1e-10)] {
        let (all, other) = solved(&above(PAIR, &format!("thickness = {thickness:?}")), &[]);
        let near = |a: &[f64], b: &[f64]| {
            let size = a.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance * size), "{thickness}: {a:?} {b:?}");
        };
        for (state, other) in states.states.iter().zip(&other.states) {
            near(&state.u, &other.u);
            near(&state.theta, &other.theta);
        }
        let scaled = |values: &[f64]| values.iter().map(|value| value * thickness).collect::<Vec<f64>>();
        let contacts = [&one, &all].map(|summary| summary.last.contact.clone().expect("contact"));
        let [per_metre, whole] = contacts.each_ref().map(|contact| &contact.sides);
        for (side, contact) in per_metre {
            near(&scaled(&contact.force), &whole[side].force);
            near(&scaled(&[contact.area]), &[whole[side].area]);
            near(&[contact.pressure_max], &[whole[side].pressure_max]);
        }
        let of = |summary: &Summary| {
            let energy = &summary.energy;
            [energy.kinetic, energy.elastic, energy.friction_dissipation, energy.contact_energy, energy.heat_content]
        };
        near(&scaled(&of(&one)), &of(&all));
        let force =
            |summary: &Summary| summary.rows().into_iter().find(|(name, _)| name == "contact force").expect("a row").1;
        assert!(force(&one).contains("N/m,") && !force(&all).contains("N/m,"), "{}", force(&all));
        assert!(all.energy.closing_error.abs() < 1e-10);
    }
}

#[test]
fn only_plane_bodies_have_a_thickness() {
    let told = |text: &str| case::parse(&Source::new("pair.toml", text), &[]).err().map(|error| error.to_string());
    let rectangle = "name = \"a\"\n[mesh]\nkind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 2\naxisymmetric = true\n";
    let rest = "[time]\nend = 1.0\nsteps = 1\n[material]\nheat_capacity = 1.0\nconductivity = 1.0\n";
    let wrong = told(&format!("thickness = 0.1\n{rectangle}{rest}")).expect("a fault");
    assert!(wrong.contains("the thickness of a body of revolution"), "{wrong}");
    assert!(told(&format!("{rectangle}{rest}")).is_none());
    // The force of a body with a thickness is in N: one per metre would be taken for that of all of it.
    let pushed = |above: &str, force: &str| {
        let pushed = PAIR.replace("traction = [0.3, 0]", &format!("force = [\"{force}\", 0]"));
        told(&format!("{above}{pushed}")).unwrap_or_default()
    };
    assert!(
        pushed("thickness = 0.1\n", "3 N/m").contains("a quantity in N"),
        "{}",
        pushed("thickness = 0.1\n", "3 N/m")
    );
    assert_eq!([pushed("thickness = 0.1\n", "3 N"), pushed("", "3 N/m")], ["", ""]);
    let negative = told(&above(PAIR, "thickness = -0.1")).expect("a fault");
    assert!(negative.contains("thickness"), "{negative}");
}

/// Without inertia a density changes nothing, and may be left out.
#[test]
fn a_density_counts_with_inertia_alone() {
    let (still, of_still) = solved(PAIR, &["time.inertia=false"]);
    let (none, of_none) = solved(PAIR, &["material.density=0"]);
    let (left_out, of_left_out) = solved(&PAIR.replace("density = 2.0\n", ""), &["time.inertia=false"]);
    let (moving, _) = solved(PAIR, &[]);
    for (summary, memory) in [(&none, &of_none), (&left_out, &of_left_out)] {
        assert_eq!(still.last.displacement_max, summary.last.displacement_max);
        assert_eq!(of_still.states.last().expect("a state").u, memory.states.last().expect("a state").u);
    }
    assert!(moving.energy.kinetic > 0.0 && still.energy.kinetic.to_bits() == 0);
    assert_ne!(still.last.displacement_max, moving.last.displacement_max);
}

/// Formulas of the laws that the program has give what these give: in the pressure, its energy, friction and heat.
#[test]
fn laws_are_formulas_too() {
    let law = |key: &str, value: &str| format!("{key} = {value}");
    let replaced = |all: &[(&str, &str)]| {
        all.iter().fold(PAIR.to_owned(), |text, (old, new)| {
            assert!(text.contains(old), "{old}");
            text.replace(old, new)
        })
    };
    let friction = law("friction", "{ law = \"coulomb\", coefficient = 0.3 }");
    let heat = law("heat", "{ law = \"constant\", conductance = 2.0 }");
    let normal = law("normal", "{ law = \"compliance\", stiffness = 2e3 }");
    let cases: [(&str, String, &str); 7] = [
        ("2000*r", normal.clone(), "normal = { law = \"expression\", pressure = \"2000*r\" }"),
        ("twice", normal.clone(), "normal = { law = \"expression\", pressure = \"1000*r\", factor = 2 }"),
        ("constant", friction.clone(), "friction = { law = \"expression\", coefficient = \"0.3\" }"),
        ("of nothing", friction.clone(), "friction = { law = \"expression\", coefficient = \"0.3 + 0*p*v*theta\" }"),
        ("factor", friction.clone(), "friction = { law = \"expression\", coefficient = \"0.6\", factor = 0.5 }"),
        ("heat", heat.clone(), "heat = { law = \"expression\", conductance = \"2\" }"),
        ("heat factor", heat.clone(), "heat = { law = \"expression\", conductance = \"1\", factor = 2 }"),
    ];
    let near = |name: &str, a: &Memory, b: &Memory| {
        for (a, b) in a.states.iter().zip(&b.states) {
            for (a, b) in [(&a.u, &b.u), (&a.theta, &b.theta)] {
                let size = a.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
                assert!(a.iter().zip(b.iter()).all(|(a, b)| (a - b).abs() <= 1e-10 * size), "{name}");
            }
        }
    };
    let (_, known) = solved(PAIR, &[]);
    for (name, old, new) in &cases {
        let (summary, found) = solved(&replaced(&[(old, new)]), &[]);
        near(name, &known, &found);
        assert!(summary.energy.closing_error.abs() < 1e-10, "{name}");
    }
    // Laws that vary: a power, a decay with the slip speed, a power of the pressure.
    let pairs = [
        (
            &normal,
            "normal = { law = \"power\", stiffness = 5e4, exponent = 1.5 }",
            "normal = { law = \"expression\", pressure = \"5e4*r*sqrt(r)\" }",
        ),
        (
            &friction,
            "friction = { law = \"static-kinetic\", static = 0.4, kinetic = 0.2, decay_speed = 0.5 }",
            "friction = { law = \"expression\", coefficient = \"0.2 + 0.2*exp(-v/0.5)\" }",
        ),
        (
            &heat,
            "heat = { law = \"pressure\", coefficient = 0.8, exponent = 0.9 }",
            "heat = { law = \"expression\", conductance = \"0.8*p^0.9\" }",
        ),
    ];
    for (old, law, formula) in pairs {
        let (_, known) = solved(&replaced(&[(old, law)]), &[]);
        let (summary, found) = solved(&replaced(&[(old, formula)]), &[]);
        near(formula, &known, &found);
        assert!(summary.energy.closing_error.abs() < 1e-10, "{formula}: {}", summary.energy.closing_error);
    }
}

/// A formula that is no law is a fault with its place, what was found and what was expected.
#[test]
fn formulas_that_are_no_laws() {
    let told = |table: &str, formula: &str| {
        let text = PAIR.replace("normal = { law = \"compliance\", stiffness = 2e3 }", table);
        let text = text.replace("FORMULA", formula);
        case::parse(&Source::new("pair.toml", text.clone()), &[])
            .err()
            .map(|error| error.to_string())
            .unwrap_or_default()
    };
    let normal = "normal = { law = \"expression\", pressure = \"FORMULA\" }";
    for (formula, words) in [
        ("1e3*(r + 1e-3)", "at r = 0"),
        ("-5*r", "falls or is not finite"),
        ("1e3*r - 1e3*r^2", "falls or is not finite"),
        ("1e3*x", "a variable (r)"),
        ("1e3*r*", "at byte"),
        ("1/r", "at r = 0"),
    ] {
        let found = told(normal, formula);
        assert!(found.contains(words) && found.contains("pressure"), "{formula}: {found}");
    }
    // An exponential that overflows far beyond every pressure is one.
    assert_eq!(told(normal, "1e3*(exp(r/1e-6) - 1)"), "");
    // A temperature that the case does not have.
    let cold = "name = \"a\"\n[mesh]\nkind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 2\n[time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 1.0\n\
        elasticity = { law = \"isotropic\", young = 1.0, poisson = 0.3, stress_state = \"plane-strain\" }\n[contact]\non = \"bottom\"\n\
        normal = { law = \"compliance\", stiffness = 10 }\nfriction = { law = \"expression\", coefficient = \"0.2*(1 - theta)\" }\n";
    let found = case::parse(&Source::new("a.toml", cold), &[]).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(found.contains("friction of the temperature"), "{found}");
}
