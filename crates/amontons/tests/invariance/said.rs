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
        ("1e3*(r + 1e-3)", "where it begins"),
        ("-5*r", "falls or is not finite"),
        ("1e3*r - 1e3*r^2", "falls or is not finite"),
        ("1e3*x", "a variable (r)"),
        ("1e3*r*", "at byte"),
        ("1/r", "where it begins"),
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

/// The largest difference of the displacements and temperatures of two runs, relative to their size.
fn apart(one: &Memory, other: &Memory) -> f64 {
    let [a, b] = [one, other].map(|run| run.states.iter().flat_map(|state| state.u.iter().chain(&state.theta)));
    let size = one.states.iter().flat_map(|state| state.u.iter()).fold(0.0, |most: f64, v| most.max(v.abs()));
    assert!(size > 0.0 && one.states.len() == other.states.len());
    a.zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / size
}

/// Sides that a case names by their place are those of the mesh: with a pair, friction, heat and wear.
#[test]
fn sides_by_their_place_are_those_of_the_mesh() {
    let places = [
        ("up_bottom", "region = \"up\"\non = { plane = { point = [0, 0.4], normal = [0, 1] } }"),
        (
            "low_top",
            "region = \"low\"\non = { near = { point = [0.7, 0.4], distance = 0.7001 }, normal = { direction = [0, 1] } }",
        ),
        ("low_bottom", "on = { plane = { point = [5, 0], normal = [0, -3] } }"),
        ("up_top", "on = { box = { from = [0, 0.9], to = [2, 1] } }"),
        ("up_left", "of = [\"up_left\", \"up_top\"]\non = { normal = { direction = [-1, 0], angle = 0.1 } }"),
    ];
    let wear = "[[contact]]\non = \"up_bottom\"\nwear = { law = \"archard\", coefficient = 1e-3 }";
    let pair = PAIR.replacen("[[contact]]\non = \"up_bottom\"", wear, 1);
    let mut named = pair.clone();
    for (name, place) in places {
        named = named.replace(&format!("on = \"{name}\""), &format!("on = \"my {name}\""));
        named = named.replace(&format!("with = \"{name}\""), &format!("with = \"my {name}\""));
        named += &format!("[[side]]\nname = \"my {name}\"\n{place}\n");
    }
    for solver in ["direct", "iterative"] {
        let solver = format!("solver.solver=\"{solver}\"");
        let [(_, one), (_, other)] = [&pair, &named].map(|text| solved(text, &[&solver]));
        let apart = apart(&one, &other);
        assert!(apart < 1e-9, "{solver}: {apart:e}");
    }
}

/// Sides of a sector by their place: those that are repeated, loaded and pressed.
#[test]
fn sides_of_sectors_have_places() {
    let sector = "name = \"sector\"\n[mesh]\nkind = \"ring\"\nradii = [1, 2]\nangle = 1.5707963267948966\nn = [3, 6]\nelements = \"Q1\"\n\
                  [time]\nend = 1\nsteps = 2\n[material]\ndensity = 0\n\
                  elasticity = { law = \"isotropic\", young = 10, poisson = 0.3, stress_state = \"plane-strain\" }\n\
                  [[cyclic]]\nsides = [\"start\", \"end\"]\n[[boundary]]\non = \"outer\"\npressure = 0.1\n\
                  [contact]\non = \"inner\"\ngap = 0.001\nnormal = { law = \"signorini\" }\n\
                  friction = { law = \"coulomb\", coefficient = 0.2 }\n";
    let named = sector
        .replace("\"start\", \"end\"", "\"a\", \"b\"")
        .replace("on = \"outer\"", "on = \"c\"")
        .replace("on = \"inner\"", "on = \"d\"")
        + "[[side]]\nname = \"a\"\non = { plane = { point = [0, 0], normal = [0, 1] } }\n\
           [[side]]\nname = \"b\"\non = { plane = { point = [0, 0], normal = [1, 0] } }\n\
           [[side]]\nname = \"c\"\non = { cylinder = { radius = 2 } }\n[[side]]\nname = \"d\"\non = { cylinder = { radius = 1 } }\n";
    let [(_, one), (_, other)] = [sector, &named].map(|text| solved(text, &[]));
    let apart = apart(&one, &other);
    assert!(apart < 1e-9, "{apart:e}");
}
