//! Reactions of prescribed displacements and temperatures: balance of forces, of momentum and of heat, and closed
//! forms.

use std::f64::consts::PI;
use std::fs;

use crate::at_rest::{folder, options, parse, probe, read, settings};
use crate::common::told;
use amontons::case::{Case, Source};
use amontons::output::{Folder, Memory, ProbeSet, Sink, Snapshot};
use amontons::output::{OutputError, ProbePlace, Take};
use amontons::run::run;

const MATERIAL: &str = "density = 0\nelasticity = { law = \"isotropic\", young = 2.0, poisson = 0.3, stress_state = \"plane-stress\" }\nviscosity = { law = \"lame\", first = 0, second = 0 }\n";

const HEAT: &str = "heat_capacity = 0\nconductivity = 2\n";

/// A body in equilibrium in every step.
fn case(mesh: &str, material: &str, rest: &str) -> Case {
    let is_plane = mesh.contains("rectangle") && !mesh.contains("axisymmetric");
    let without = material.replace(", stress_state = \"plane-stress\"", "");
    let material = if is_plane { material } else { &without };
    parse(&format!("name = \"body\"\n[mesh]\n{mesh}\n[time]\nend = 0.5\nsteps = 2\n[material]\n{material}\n{rest}"))
}

fn read_probe(name: &str, quantity: &str, on: &str) -> String {
    format!("[[probe]]\nname = \"{name}\"\nquantity = \"{quantity}\"\non = \"{on}\"\ntake = \"integral\"\n")
}

/// The values of the probes after every step, in the order of their columns, and the force of contact.
fn rows(case: &Case) -> Vec<(Vec<f64>, [f64; 3])> {
    struct Rows(ProbeSet, Vec<(Vec<f64>, [f64; 3])>);
    impl Sink for Rows {
        fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
            self.1.push((self.0.values(now), now.report.unwrap().contact.force));
            Ok(())
        }
    }
    let mut rows = Rows(ProbeSet::new(&case.problem, &case.probes).unwrap(), Vec::new());
    run(&case.problem, &settings(), &mut [&mut rows]).unwrap();
    assert_eq!(rows.1.len(), case.problem.timeline.steps());
    rows.1
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?} and {expected:?}");
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= tolerance * (1.0 + e.abs()), "{found:?} instead of {expected:?}");
    }
}

/// A held side bears the whole load, whatever the elements: tractions, weight and pressures that are integrated
/// exactly.
#[test]
fn a_held_side_bears_the_load() {
    for elements in ["P1", "P2", "Q1", "Q2"] {
        let plane = case(
            &format!("kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [6, 3]\nelements = \"{elements}\""),
            MATERIAL,
            &[
                "[load]\nbody_force = [0.5, \"-2*x\"]\n[[boundary]]\non = \"left\"\ndisplacement = [0, 0]\n\
               [[boundary]]\non = \"right\"\ntraction = [3, \"-1*t\"]\n",
                &read_probe("r", "reaction", "left"),
                &read_probe("r_y", "reaction_y", "left"),
                &read_probe("size", "reaction_magnitude", "left"),
            ]
            .concat(),
        );
        for (step, (values, _)) in rows(&plane).iter().enumerate() {
            let (x, y) = (-(3.0 + 1.0), 0.25 * (step + 1) as f64 + 4.0);
            assert_close(values, &[x, y, y, x.hypot(y)], 1e-12);
        }
        // A full turn of a tube: a body force of 1 along it, and a radial force that the sliding side does not bear.
        let tube = case(
            &format!(
                "kind = \"rectangle\"\norigin = [1.0, 0.0]\nsize = [1.0, 0.5]\nn = [4, 2]\naxisymmetric = true\nelements = \"{elements}\""
            ),
            MATERIAL,
            &[
                "[load]\nbody_force = [0.3, 1]\n[[boundary]]\non = \"bottom\"\nnormal_displacement = 0\n",
                &read_probe("r", "reaction", "bottom"),
            ]
            .concat(),
        );
        for (values, _) in rows(&tube) {
            assert_close(&values, &[0.0, -PI * 3.0 * 0.5], 1e-12);
        }
    }
    for elements in ["P1", "P2", "Q1"] {
        let block = case(
            &format!("kind = \"box\"\nsize = [2.0, 1.0, 1.5]\nn = [4, 2, 3]\nelements = \"{elements}\""),
            MATERIAL,
            &[
                "[load]\nbody_force = [0.1, 0.2, \"-z\"]\n[[boundary]]\non = \"left\"\ndisplacement = [0, 0, 0]\n\
               [[boundary]]\non = \"right\"\npressure = 2\n",
                &read_probe("r", "reaction", "left"),
            ]
            .concat(),
        );
        for (values, _) in rows(&block) {
            assert_close(&values, &[-0.3 + 3.0, -0.6, 2.25], 1e-12);
        }
    }
}

/// Uniaxial strain: σ_x = (λ + 2μ) ε on the side that moves, σ_y = λ ε on the sides that hold it.
#[test]
fn a_side_that_moves_needs_the_force_of_the_formula() {
    let material = MATERIAL.replace("plane-stress", "plane-strain");
    let held = |side: &str, value: &str| {
        format!(
            "[[boundary]]\non = \"{side}\"\nnormal_displacement = \"{value}\"\n{}",
            read_probe(side, "reaction", side)
        )
    };
    let sides = [held("left", "0"), held("right", "0.1*t"), held("bottom", "0"), held("top", "0")].concat();
    let body = case("kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [5, 3]", &material, &sides);
    let (lambda, shear) = (2.0 * 0.3 / (1.3 * 0.4), 2.0 / 2.6);
    for (step, (values, _)) in rows(&body).iter().enumerate() {
        let strain = 0.1 * 0.25 * (step + 1) as f64 / 2.0;
        let (axial, lateral) = ((lambda + 2.0 * shear) * strain, lambda * strain * 2.0);
        // A corner belongs to two sides: its share of the other component is the other side's.
        let [x, y] = [&values[0..4], &values[4..8]];
        assert_close(&[x[0], x[2], y[1], y[3]], &[-axial, axial, -lateral, lateral], 1e-12);
    }
}

/// Force and rate of momentum: reaction + load = d/dt ∫ρw in every step of a body that is shaken.
#[test]
fn reactions_change_the_momentum() {
    let material = MATERIAL.replace("density = 0", "density = 3").replace("second = 0", "second = 0.2");
    let rest = [
        "[load]\nbody_force = [0.5, 0]\n[[boundary]]\non = \"left\"\ndisplacement = [\"0.1*t^2\", \"0.2*t\"]\n\
         [[probe]]\nname = \"w\"\nquantity = \"velocity\"\nregion = \"body\"\ntake = \"integral\"\n",
        &read_probe("r", "reaction", "left"),
    ]
    .concat();
    let body = case("kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [6, 3]\nelements = \"P2\"", &material, &rest);
    let mut before = read(&body, &body.probes);
    assert!(before[2].is_nan() && before[3].is_nan(), "no reaction is known at t = 0");
    for (values, _) in rows(&body) {
        let rate = |c: usize| 3.0 * (values[c] - before[c]) / 0.25;
        assert!(rate(0).abs() > 0.1 && rate(1).abs() > 0.01, "the body moves");
        assert_close(&values[2..], &[rate(0) - 1.0, rate(1)], 1e-12);
        before = values;
    }
}

/// A block pressed and dragged on a foundation: what holds it above, its weight and the contact are in balance.
#[test]
fn reactions_and_contact_are_in_balance() {
    for quadrature in ["nodal", "gauss"] {
        let rest = [
            "[load]\nbody_force = [0, -0.01]\n[[boundary]]\non = \"top\"\ndisplacement = [\"0.02*t\", \"-0.05*t*(1 + x)\"]\n[contact]\non = \"bottom\"\n\
             normal = { law = \"compliance\", stiffness = 10 }\nfriction = { law = \"coulomb\", coefficient = 0.25 }\n",
            &format!("quadrature = \"{quadrature}\"\n"),
            &read_probe("r", "reaction", "top"),
        ]
        .concat();
        let body = case("kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [6, 3]", MATERIAL, &rest);
        for (values, force) in rows(&body) {
            assert!(force[0].abs() > 1e-4 && force[1] > 1e-2, "{force:?}");
            assert_close(&values, &[-force[0], -force[1] + 0.02], 1e-12);
        }
    }
}

/// A wall between two temperatures: k Δθ/L flows in on one side and out on the other; a source leaves through both.
#[test]
fn heat_that_is_supplied() {
    let rest = [
        "[load]\nheat_source = 0.5\n[[boundary]]\non = \"left\"\ntemperature = 1\n[[boundary]]\non = \"right\"\ntemperature = \"1 + 3*t\"\n",
        &read_probe("a", "reaction_heat", "left"),
        &read_probe("b", "reaction_heat", "right"),
    ]
    .concat();
    let wall = case("kind = \"rectangle\"\nsize = [2.0, 1.5]\nn = [6, 3]", HEAT, &rest);
    for (step, (values, _)) in rows(&wall).iter().enumerate() {
        let through = 2.0 * 0.75 * (step + 1) as f64 / 2.0 * 1.5;
        assert_close(values, &[-through - 0.75, through - 0.75], 1e-12);
    }
}

/// probes.csv has the reactions of every step; points may be asked for, too.
#[test]
fn reactions_of_points_are_written() {
    let rest =
        "[[boundary]]\nat = [0, 0]\ndisplacement = [0, 0]\n[[boundary]]\nat = [2, 0]\ndisplacement = [\"free\", 0]\n\
        [[boundary]]\non = \"top\"\npressure = \"x\"\n"
            .to_owned()
            + &["a\"\nquantity = \"reaction\"\nat = [0, 0]\n", "b\"\nquantity = \"reaction_y\"\nat = [2, 0]\n"]
                .map(|probe| format!("[[probe]]\nname = \"{probe}"))
                .concat();
    let beam = case("kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [6, 3]", MATERIAL, &rest);
    let (path, mut memory) = (folder("reactions"), Memory::new());
    run(&beam.problem, &settings(), &mut [&mut Folder::create(&path, options(&beam)).unwrap(), &mut memory]).unwrap();
    let table = fs::read_to_string(path.join("probes.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("step,t,a_x,a_y,b"));
    for line in lines {
        let values: Vec<f64> = line.split(',').skip(2).map(|value| value.parse().unwrap()).collect();
        // ∫x dx = 2 with its centre at x = 4/3.
        assert_close(&values, &[0.0, 2.0 / 3.0, 4.0 / 3.0], 1e-12);
    }
}

/// Where nothing is prescribed there is no reaction, and it has no mean.
#[test]
fn faults_of_reactions() {
    let head = "name = \"body\"\n[mesh]\nkind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 2\n[time]\nend = 1\nsteps = 1\n[material]\n"
        .to_owned()
        + MATERIAL
        + "heat_capacity = 1\nconductivity = 1\n[[boundary]]\non = \"left\"\ndisplacement = [0, 0]\n[[probe]]\nname = \"a\"\n";
    let line = head.lines().count();
    let fault = |rest: &str, row: usize, says: &str| {
        let expected = format!("body.toml:{}:{says}", line + row);
        assert_eq!(told(&Source::new("body.toml", head.clone() + rest), &[]), expected);
    };
    fault(
        "quantity = \"reaction\"\non = \"top\"\ntake = \"integral\"\n",
        1,
        "12: probe[0].quantity: found reaction elsewhere than where the displacement is prescribed, expected a quantity that exists there",
    );
    fault(
        "quantity = \"reaction_heat\"\non = \"left\"\ntake = \"integral\"\n",
        1,
        "12: probe[0].quantity: found reaction_heat elsewhere than where the temperature is prescribed, expected a quantity that exists there",
    );
    fault(
        "quantity = \"reaction_x\"\nat = [1, 0]\n",
        1,
        "12: probe[0].quantity: found reaction_x elsewhere than where the displacement is prescribed, expected a quantity that exists there",
    );
    fault(
        "quantity = \"reaction\"\non = \"left\"\ntake = \"max\"\n",
        3,
        "8: probe[0].take: found reaction other than its integral, expected \"integral\": the sum over the nodes",
    );
    assert!(amontons::output::Quantity::parse("reaction_normal").is_none());
    let place = ProbePlace::On("left".to_owned(), Take::Integral);
    assert_eq!(probe("reaction", place.clone()).measure(), Some(amontons::units::Measure::Force));
    assert_eq!(probe("reaction_heat", place).measure(), Some(amontons::units::Measure::Power));
}
