//! Probes: what they read, when they are written, and their faults.
#![allow(clippy::too_many_lines, clippy::too_many_arguments, reason = "a test is one list of cases")]
#![allow(clippy::float_cmp, reason = "some values are exact")]

use std::fs;
use std::path::Path;

use crate::at_rest::{
    CONDUCTIVITY, EXPANSION, PLANE_STRAIN, PLANE_STRESS, POISSON, YOUNG, folder, hooke, options, parse, probe, read,
    settings, text,
};
use crate::common::{self, told};
use amontons::case::{self, Case, Source};
use amontons::material::StressState;
use amontons::output::{Checkpoint, Folder, Memory, Probe, Sink, Take};
use amontons::output::{OutputError, ProbePlace, Snapshot};
use amontons::run::{Settings, resume, run};
use amontons::tensor::Sym;
use amontons::verify::verify;

fn assert_read(case: &Case, expected: &[(&str, ProbePlace, &[f64])]) {
    let probes: Vec<Probe> = expected.iter().map(|(quantity, place, _)| probe(quantity, place.clone())).collect();
    let mut found = read(case, &probes).into_iter();
    for (quantity, place, values) in expected {
        for value in *values {
            let found = found.next().unwrap();
            assert!(
                (found - value).abs() < 1e-13 * (1.0 + value.abs()),
                "{quantity} {place:?}: {found} instead of {value}"
            );
        }
    }
    assert_eq!(found.next(), None);
}

fn on(side: &str, take: Take) -> ProbePlace {
    ProbePlace::On(side.to_owned(), take)
}

/// Linear fields in each dimension, read at points, on sides and in regions; on linear elements they are exact.
#[test]
fn probes_read_linear_fields() {
    use Take::{Integral, Max, Mean, Min};
    let body = |take| ProbePlace::Region("body".to_owned(), take);
    let plane = parse(&text(
        "kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [4, 3]",
        PLANE_STRAIN,
        "[\"0.1*x-0.2*y\", \"0.3*y\"]",
        "\"1+2*x+3*y\"",
        "",
    ));
    let at = ProbePlace::At([0.7, 0.3, 0.0]);
    let strain = Sym::from_fn(2, |i, j| [[0.1, -0.1], [-0.1, 0.3]][i][j]);
    let stress = |theta: f64| hooke(2, StressState::PlaneStrain, &strain, theta);
    let here = stress(1.0 + 1.4 + 0.9);
    let six = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|(i, j)| here.get(i, j));
    assert_read(
        &plane,
        &[
            ("displacement", at.clone(), &[0.01, 0.09]),
            ("displacement_y", at.clone(), &[0.09]),
            ("displacement_magnitude", at.clone(), &[0.01f64.hypot(0.09)]),
            ("velocity", at.clone(), &[0.0, 0.0]),
            ("stress", at.clone(), &six),
            ("strain", at.clone(), &[0.1, 0.3, 0.0, -0.1, 0.0, 0.0]),
            ("mean_stress", at.clone(), &[here.trace() / 3.0]),
            ("von_mises", at.clone(), &[here.von_mises()]),
            ("heat_flux", at, &[-4.0, -6.0]),
            ("temperature", on("right", Mean), &[6.5]),
            ("temperature", on("right", Max), &[8.0]),
            ("temperature", on("right", Min), &[5.0]),
            ("temperature", on("top", Integral), &[12.0]),
            ("heat_flux_normal", on("left", Integral), &[4.0]),
            ("heat_flux_normal", on("top", Integral), &[-12.0]),
            ("stress_normal", on("right", Mean), &[stress(6.5).get(0, 0)]),
            ("stress_xy", on("bottom", Integral), &[2.0 * stress(0.0).get(0, 1)]),
            ("temperature", body(Integral), &[9.0]),
            ("temperature", body(Max), &[8.0]),
            ("stress_zz", body(Mean), &[stress(4.5).get(2, 2)]),
            ("stress_zz", body(Max), &[stress(1.0).get(2, 2)]),
            ("displacement_x", body(Min), &[-0.2]),
        ],
    );
    let solid = parse(&text(
        "kind = \"box\"\nsize = [1.0, 2.0, 3.0]\nn = [2, 2, 3]",
        "",
        "[\"0.1*z\", 0, \"0.2*z\"]",
        "\"z-x\"",
        "",
    ));
    let strain = Sym::from_fn(3, |i, j| [[0.0, 0.0, 0.05], [0.0, 0.0, 0.0], [0.05, 0.0, 0.2]][i][j]);
    assert_read(
        &solid,
        &[
            ("displacement", ProbePlace::At([0.3, 0.9, 2.0]), &[0.2, 0.0, 0.4]),
            (
                "stress_zx",
                ProbePlace::At([0.3, 0.9, 2.0]),
                &[hooke(3, StressState::PlaneStress, &strain, 0.0).get(0, 2)],
            ),
            ("stress_normal", on("front", Mean), &[hooke(3, StressState::PlaneStress, &strain, 2.5).get(2, 2)]),
            ("heat_flux_normal", on("back", Integral), &[4.0]),
            ("temperature", body(Integral), &[6.0]),
            ("displacement_z", on("left", Max), &[0.6]),
        ],
    );
    let rod = parse(&text("kind = \"interval\"\nsize = 2.0\nn = 5", PLANE_STRESS, "[\"0.1*x\"]", "\"3*x\"", ""));
    assert_read(
        &rod,
        &[
            ("displacement", ProbePlace::At([0.5, 0.0, 0.0]), &[0.05]),
            ("stress_xx", on("right", Mean), &[0.1 * YOUNG - EXPANSION * 6.0]),
            ("von_mises", ProbePlace::At([2.0, 0.0, 0.0]), &[EXPANSION * 6.0 - 0.1 * YOUNG]),
            ("heat_flux_normal", on("left", Integral), &[6.0]),
        ],
    );
}

/// The stress of three dimensions: σ₃₃ of plane strain, the hoop stress of a body of revolution, on its axis too.
#[test]
fn stresses_of_bodies_that_lack_a_direction() {
    let shear = YOUNG / (2.0 * (1.0 + POISSON));
    let lambda = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    let at = ProbePlace::At([0.25, 0.5, 0.0]);
    let square = "kind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 4";
    let plane = |state| parse(&text(square, state, "[\"0.1*x\", 0]", "0", ""));
    assert_read(
        &plane(PLANE_STRAIN),
        &[("stress_zz", at.clone(), &[0.1 * lambda]), ("von_mises", at.clone(), &[0.2 * shear])],
    );
    let first = 0.1 * YOUNG / (1.0 - POISSON * POISSON);
    let von_mises = first * (1.0 - POISSON + POISSON * POISSON).sqrt();
    assert_read(
        &plane(PLANE_STRESS),
        &[
            ("stress_zz", at.clone(), &[0.0]),
            ("von_mises", at.clone(), &[von_mises]),
            ("principal", at.clone(), &[first, POISSON * first, 0.0]),
        ],
    );
    let round = parse(&text(&format!("{square}\naxisymmetric = true"), "", "[\"0.1*x\", 0]", "\"x\"", ""));
    let radial = 0.2 * (lambda + shear);
    let side = on("right", Take::Integral);
    assert_read(
        &parse(&text(&format!("{square}\naxisymmetric = true"), "", "[\"0.1*x\", 0]", "0", "")),
        &[
            ("hoop", at.clone(), &[radial]),
            ("stress_xx", at.clone(), &[radial]),
            ("stress_yy", at, &[0.2 * lambda]),
            ("hoop", on("left", Take::Max), &[radial]),
        ],
    );
    assert_read(&round, &[("heat_flux_normal", side, &[-CONDUCTIVITY * std::f64::consts::TAU])]);
}

fn paper_with_probes() -> Case {
    let text = fs::read_to_string(common::file("cases/paper.toml")).unwrap();
    let probes = "\n[[probe]]\nname = \"p\"\nquantity = \"pressure\"\non = \"bottom\"\ntake = \"integral\"\n\
        [[probe]]\nname = \"p_max\"\nquantity = \"pressure\"\non = \"bottom\"\ntake = \"max\"\n\
        [[probe]]\nname = \"tip\"\nquantity = \"displacement\"\nat = [0, 0]\n\
        [[probe]]\nname = \"hot\"\nquantity = \"temperature\"\nregion = \"body\"\ntake = \"max\"\n";
    let overrides: Vec<String> = ["mesh.n=8", "time.steps=8", "output.every=0"].map(str::to_owned).to_vec();
    case::parse(&Source::new("paper.toml", text + probes), &overrides).unwrap_or_else(|error| panic!("{error}"))
}

fn table(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| line.split(','));
    let names = lines.next().unwrap().map(str::to_owned).collect();
    (names, lines.map(|row| row.map(|v| v.parse().unwrap()).collect()).collect())
}

/// probes.csv has one row per step; what it says is what history.csv, contact.csv and the state say.
#[test]
fn probes_are_written_after_every_step() {
    let (case, path) = (paper_with_probes(), folder("steps"));
    let (mut results, mut memory) = (Folder::create(&path, options(&case)).unwrap(), Memory::new().states_every(1));
    let summary = run(&case.problem, &settings(), &mut [&mut results, &mut memory]).unwrap();
    let (names, rows) = table(&path.join("probes.csv"));
    assert_eq!(names, ["step", "t", "p", "p_max", "tip_x", "tip_y", "hot"]);
    assert_eq!(rows.len(), 8);
    let (columns, history) = table(&path.join("history.csv"));
    let force = columns.iter().position(|c| c == "contact_force_y").unwrap();
    for ((row, history), state) in rows.iter().zip(&history).zip(&memory.states[1..]) {
        assert_eq!((row[0], row[1]), (history[0], history[1]));
        // The normal of the bottom is −e_y: σν·e_y is the pressure.
        assert!((row[2] - history[force]).abs() < 1e-12 * history[force].abs(), "{} and {}", row[2], history[force]);
        assert_eq!(row[4..], [state.u[0], state.u[1], state.theta.iter().copied().fold(f64::MIN, f64::max)]);
    }
    assert_eq!(rows[7][3], summary.last.contact.unwrap().pressure_max);
}

/// A run that goes on cuts rows behind its checkpoint and ends with the file of a run without a break.
#[test]
fn probes_go_on_with_the_run() {
    /// Ends a run after its third step.
    struct Stop(std::sync::Arc<std::sync::atomic::AtomicBool>);
    impl Sink for Stop {
        fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
            self.0.store(now.state.step == 3, std::sync::atomic::Ordering::Relaxed);
            Ok(())
        }
    }
    let (case, whole, broken) = (paper_with_probes(), folder("whole"), folder("broken"));
    run(&case.problem, &settings(), &mut [&mut Folder::create(&whole, options(&case)).unwrap()]).unwrap();
    let flag = std::sync::Arc::default();
    let mut stop = Stop(std::sync::Arc::clone(&flag));
    let interrupted = Settings { interrupt: Some(flag), ..settings() };
    assert!(
        run(&case.problem, &interrupted, &mut [&mut Folder::create(&broken, options(&case)).unwrap(), &mut stop])
            .is_err()
    );
    let file = broken.join("probes.csv");
    let kept = fs::read_to_string(&file).unwrap();
    assert_eq!(kept.lines().count(), 4);
    fs::write(&file, kept + "4,0.5,1,1,1,1,1\n5,0.6").unwrap();
    let checkpoint = Checkpoint::read(&broken, &case.identity()).unwrap().unwrap();
    resume(&case.problem, checkpoint, &settings(), &mut [&mut Folder::reopen(&broken, options(&case)).unwrap()])
        .unwrap();
    assert_eq!(fs::read_to_string(&file).unwrap(), fs::read_to_string(whole.join("probes.csv")).unwrap());
}

/// Faults of probes and of checks with their places, all at once.
#[test]
fn faults_of_probes_have_their_places() {
    let base = text("kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = 2", PLANE_STRAIN, "[0, 0]", "0", "");
    let line = base.lines().count();
    let case = |more: &str, expected: &[(usize, &str)]| {
        let told = told(&Source::new("body.toml", base.clone() + more), &[]);
        let lines: Vec<String> =
            expected.iter().map(|(offset, says)| format!("body.toml:{}:{says}", line + offset)).collect();
        assert_eq!(told, lines.join("\n"));
    };
    let probe = |quantity: &str, place: &str| format!("[[probe]]\nname = \"a\"\nquantity = \"{quantity}\"\n{place}\n");
    assert_eq!(told(&Source::new("body.toml", base.clone() + &probe("temperature", "at = [1, 1]")), &[]), "no fault");
    case(
        &probe("temperature", "at = [2.5, 1]"),
        &[(
            4,
            "6: probe[0].at: found (2.5, 1), outside the body, expected a point of the body, which reaches from (0, 0) to (2, 1)",
        )],
    );
    case(
        &probe("temperature", "at = [1, 1, 0]"),
        &[(4, "6: probe[0].at: found 3 coordinates, expected 2 coordinates")],
    );
    case(
        &probe("temperature", ""),
        &[(1, "1: probe[0]: found no place, expected one of `at`, `on`, `contact` and `region`")],
    );
    case(
        &probe("temperature", "on = \"lft\"\ntake = \"max\""),
        &[(
            4,
            "6: probe[0].on: found \"lft\", expected one of the facet sets bottom, left, right, top; did you mean \"left\"?",
        )],
    );
    case(
        &probe("temperature", "region = \"boddy\"\ntake = \"max\""),
        &[(4, "10: probe[0].region: found \"boddy\", expected one of the regions body; did you mean \"body\"?")],
    );
    case(
        &probe("temperature", "on = \"left\""),
        &[(
            1,
            "1: probe[0].take: found no such key, expected \"mean\", \"max\", \"min\" or \"integral\" (what is taken of the values)",
        )],
    );
    case(
        &probe("displacement_z", "at = [1, 1]"),
        &[(3, "12: probe[0].quantity: found displacement_z in 2 dimensions, expected a quantity that exists there")],
    );
    case(
        &probe("hoop", "at = [1, 1]"),
        &[(
            3,
            "12: probe[0].quantity: found hoop in a body that is not axisymmetric, expected a quantity that exists there",
        )],
    );
    case(
        &probe("heat_flux_normal", "at = [1, 1]"),
        &[(
            3,
            "12: probe[0].quantity: found heat_flux_normal elsewhere than on a side, expected a quantity that exists there",
        )],
    );
    case(
        &probe("pressure", "on = \"left\"\ntake = \"max\""),
        &[(
            3,
            "12: probe[0].quantity: found pressure elsewhere than on a side of a contact, expected a quantity that exists there",
        )],
    );
    case(
        &probe("von_misses", "at = [1, 1]"),
        &[(
            3,
            "12: probe[0].quantity: found \"von_misses\", expected the name of a quantity, such as \"displacement_x\", \"temperature\", \"stress_xx\" or \"von_mises\" (quantity that is recorded); did you mean \"von_mises\"?",
        )],
    );
    let twice = probe("temperature", "at = [1, 1]") + &probe("von_mises", "at = [3, 1]\ntake = \"max\"");
    case(
        &twice,
        &[
            (
                6,
                "8: probe[1].name: found \"a\" again, expected a name of its own for each column of probes.csv, which begin with step and t",
            ),
            (
                9,
                "1: probe[1].take: found `take` of the value at a point, expected `take` with `on`, `contact` or `region`",
            ),
        ],
    );
    let check = "[verify]\ntitle = \"t\"\nsource = \"s\"\n[[verify.check]]\nkind = \"probe\"\nfield = \"stress_xx\"\nat = [0, 2]\ntime = 0\nreference = 1\ntolerance = 1\n";
    case(
        check,
        &[(
            7,
            "6: verify.check[0].at: found (0, 2), outside the body, expected a point of the body, which reaches from (0, 0) to (2, 1)",
        )],
    );
}

/// Lamé's thick-walled cylinder under an inner pressure, radii 1 and 2 (Timoshenko and Goodier, *Theory of Elasticity*,
/// section 28): in plane strain on a quarter of the ring, and as a body of revolution; checked by the case file alone.
#[test]
fn a_case_file_checks_the_stresses_of_a_cylinder() {
    let material = "[time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0\nheat_capacity = 1\nexpansion = 0\ncoupling = 0\nconductivity = 1\n\
        viscosity = { law = \"lame\", first = 0.0, second = 0.0 }\n";
    let elastic = |more: &str| format!("elasticity = {{ law = \"isotropic\", young = 2.0, poisson = 0.3{more} }}\n");
    let held = |side: &str| format!("[[boundary]]\non = \"{side}\"\nnormal_displacement = 0\n");
    let pressed = |side: &str| format!("[[boundary]]\non = \"{side}\"\npressure = 1\n");
    let check = |field: &str, place: &str, reference: f64| {
        format!(
            "[[verify.check]]\nkind = \"probe\"\nfield = \"{field}\"\n{place}\ntime = 1\nreference = {reference:?}\ntolerance = 1e-3\n"
        )
    };
    // σ_θ = p (b² + a²)/(b² − a²) and σ_r = −p inside, σ_θ = 2 p a²/(b² − a²) outside, u_r = (1 + ν)/E p a
    // ((1 − 2ν)a² + b²)/(b² − a²).
    let (hoop, outside, displacement) = (5.0 / 3.0, 2.0 / 3.0, 1.3 / 2.0 * 4.4 / 3.0);
    let verify_block = "[verify]\ntitle = \"Lamé\"\nsource = \"closed form\"\n";
    let ring = |n: usize| {
        let checks = [
            check("stress_yy", "at = [1, 0]", hoop),
            check("stress_xx", "at = [1, 0]", -1.0),
            check("displacement_x", "at = [1, 0]", displacement),
            check("principal_1", "on = \"inner\"\ntake = \"max\"", hoop),
            check("stress_normal", "on = \"inner\"\ntake = \"mean\"", -1.0),
        ];
        let angle = std::f64::consts::FRAC_PI_2;
        let mesh =
            format!("kind = \"ring\"\nradii = [1.0, 2.0]\nangle = {angle:?}\nn = [{n}, {n}]\nelements = \"Q2\"\n");
        let sides = [held("start"), held("end"), pressed("inner")].concat();
        format!(
            "name = \"ring\"\n[mesh]\n{mesh}{material}{}{sides}{verify_block}{}",
            elastic(PLANE_STRAIN),
            checks.concat()
        )
    };
    let tube = |n: usize| {
        let checks = [
            check("hoop", "on = \"left\"\ntake = \"max\"", hoop),
            check("hoop", "at = [2, 0.25]", outside),
            check("displacement_x", "at = [1, 0.25]", displacement),
            check("stress_normal", "on = \"left\"\ntake = \"integral\"", -std::f64::consts::PI),
        ];
        let mesh = format!(
            "kind = \"rectangle\"\norigin = [1.0, 0.0]\nsize = [1.0, 0.5]\nn = [{n}, 4]\nelements = \"Q2\"\naxisymmetric = true\n"
        );
        let sides = [held("bottom"), held("top"), pressed("left")].concat();
        format!("name = \"tube\"\n[mesh]\n{mesh}{material}{}{sides}{verify_block}{}", elastic(""), checks.concat())
    };
    let verdicts = |name: &str, text: &str| verify(name, text, &settings()).unwrap_or_else(|error| panic!("{error}"));
    for (name, text) in [("ring", &ring as &dyn Fn(usize) -> String), ("tube", &tube)] {
        let [coarse, fine] = [16, 32].map(|n| verdicts(name, &text(n)));
        for (c, f) in coarse.iter().zip(&fine) {
            println!(
                "{name} {}: {} against {}, {:.1e}, order {}",
                f.what,
                f.computed,
                f.reference,
                f.error,
                (c.error / f.error).log2()
            );
            // Quadratic elements: stresses at the boundary of the third order, displacements of the fourth at nodes.
            let order = if f.what.starts_with("displacement") { 3.5 } else { 2.5 };
            assert!((c.error / f.error).log2() > order && f.holds, "{c:?}\n{f:?}");
        }
    }
}

/// A rod held at a strain ε from t = 0 on: the stress of backward Euler is E ε (1 + g (1 + k/τ)^−n), the branch
/// included.
#[test]
fn stresses_that_relax_are_in_the_stress() {
    let text = "name = \"rod\"\n[mesh]\nkind = \"interval\"\nsize = 2.0\nn = 4\n[time]\nend = 1.0\nsteps = 5\n[material]\ndensity = 0\nheat_capacity = 1\n\
        expansion = 0\ncoupling = 0\nconductivity = 1\nviscosity = { law = \"lame\", first = 0.0, second = 0.0 }\n\
        elasticity = { law = \"isotropic\", young = 3.0, poisson = 0.3, stress_state = \"plane-stress\" }\nprony = [{ ratio = 2.0, time = 0.4 }]\n\
        [[boundary]]\non = \"left\"\ndisplacement = [0]\n[[boundary]]\non = \"right\"\ndisplacement = [0.02]\n";
    let (case, path) =
        (parse(&format!("{text}[[probe]]\nname = \"s\"\nquantity = \"stress_xx\"\nat = [1.3]\n")), folder("relaxing"));
    let summary = run(&case.problem, &settings(), &mut [&mut Folder::create(&path, options(&case)).unwrap()]).unwrap();
    let (_, rows) = table(&path.join("probes.csv"));
    for row in &rows {
        let expected = 3.0 * 0.01 * (1.0 + 2.0 * (1.0 + 0.2 / 0.4f64).powf(-row[0]));
        assert!((row[2] - expected).abs() < 1e-14, "step {}: {} instead of {expected}", row[0], row[2]);
    }
    assert!(rows.len() == 5 && summary.last.von_mises_max.is_some_and(|most| (most - rows[4][2]).abs() < 1e-15));
}
