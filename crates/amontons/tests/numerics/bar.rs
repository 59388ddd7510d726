//! The bar that hits a wall (D. Doyen, A. Ern, S. Piperno, SIAM J. Sci. Comput. 33 (2011) 223) in many schemes, against
//! an independent program.

use amontons::case::{self, Source};

use crate::common::{file, solve};

/// The energy of the bar at the start, J.
const ENERGY: f64 = 500.0;

/// The keys that pose a row of the table, or `None` for a scheme that the program does not offer.
fn keys(row: &[&str]) -> Option<Vec<String>> {
    let of = |i: usize| row[i];
    let (law, scheme, theta) = (of(1), of(2), of(3));
    let own = match scheme {
        "euler (position)" => "scheme = \"euler\"".to_owned(),
        "theta e=0" => format!("scheme = \"theta\", theta = {theta}"),
        "theta e=0.5" => format!("scheme = \"theta\", theta = {theta}, restitution = 0.5"),
        "theta e=1 (persistency)" => format!("scheme = \"theta\", theta = {theta}, restitution = 1.0"),
        "theta gradient" => format!("scheme = \"theta\", theta = {theta}, pressure = \"gradient\""),
        "contact-stabilised" => "scheme = \"contact-stabilised\"".to_owned(),
        "theta plain" => format!("scheme = \"theta\", theta = {theta}, pressure = \"plain\""),
        _ => return None,
    };
    let normal = match law.strip_prefix("compliance ") {
        Some(stiffness) => format!("{{ law = \"compliance\", stiffness = {stiffness} }}"),
        None => "{ law = \"signorini\" }".to_owned(),
    };
    let k: f64 = of(5).parse().expect("a number");
    let time = format!("time={{ end = 1.5, steps = {}, {own} }}", (1.5f64 / k).round());
    Some(vec![time, format!("contact.normal={normal}"), format!("mesh.n={}", of(4))])
}

/// Energy, largest penetration, displacements of both ends, and velocity of the far end.
#[test]
fn a_bar_hits_a_wall_as_in_the_table() {
    let text = "name = \"bar\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"interval\"\nsize = 10.0\nn = 100\n\
        [time]\nend = 1.5\nsteps = 300\n[material]\ndensity = 1.0\n\
        elasticity = { law = \"isotropic\", young = 900.0, poisson = 0.0 }\n\
        [initial]\nvelocity = [-10.0]\n[contact]\non = \"left\"\ngap = 5.0\nnormal = { law = \"signorini\" }\n";
    let table = file("crates/amontons/tests/reference/time/bar.csv");
    let table = std::fs::read_to_string(table).expect("the reference numbers");
    let mut rows = 0;
    for row in table.lines().skip(1).map(|line| line.split(',').collect::<Vec<&str>>()) {
        let Some(keys) = keys(&row) else { continue };
        rows += 1;
        let number = |i: usize| row[i].parse::<f64>().expect("a number");
        let problem = case::parse(&Source::new("bar.toml", text), &keys).unwrap_or_else(|error| panic!("{error}"));
        let memory = solve(&problem.problem);
        let state = memory.states.last().expect("a state");
        let ledger = &state.ledger;
        let energy = (ledger.kinetic + ledger.elastic + ledger.contact_energy) / ENERGY;
        let [near, far] = [state.u[0], state.u[state.u.len() - 1]];
        for (what, found, expected) in [
            ("energy", energy, number(6)),
            ("impact", ledger.impact_dissipation / ENERGY, number(18)),
            ("u at the wall", near, number(19)),
            ("u at the far end", far, number(20)),
            ("w at the far end", state.w[state.w.len() - 1] / 10.0, number(22) / 10.0),
        ] {
            assert!((found - expected).abs() < 1e-8, "{what} of {row:?}: {found}, expected {expected}");
        }
        assert!(ledger.closing_error.abs() <= 1e-11 * ledger.turned_over, "{row:?}");
    }
    assert!(rows >= 50, "{rows} rows");
}

/// A pin of steel that falls by many times its deformation, so that its rigid motion is split off: exactly as a stone
/// does with ϑ = ½ and contact-stabilised, and almost without strain in every scheme until it hits the
/// floor, which bears ρ c v then.
#[test]
fn a_pin_that_falls_far_hits_the_floor_with_its_velocity() {
    for scheme in ["euler", "theta", "bdf2", "contact-stabilised"] {
        let is_exact = ["theta", "contact-stabilised"].contains(&scheme);
        let keys = [format!("time.scheme={scheme}"), "mesh.n=100".to_owned(), "phase.impact.steps=200".to_owned()];
        let problem = case::read(&file("cases/dropped-pin.toml"), &keys).unwrap_or_else(|error| panic!("{error}"));
        let memory = solve(&problem.problem);
        let fallen = &memory.states[10];
        let (t, far) = (fallen.t, -0.5 * 9.81 * fallen.t * fallen.t);
        // Backward Euler falls by g k t/2 too far.
        let late = if scheme == "euler" { 0.1 } else { 0.01 };
        assert!(fallen.u.iter().all(|u| (u / far - 1.0).abs() <= late * 1.001), "{scheme}: {} at {t}", fallen.u[0]);
        if is_exact {
            assert!(fallen.u.iter().all(|u| (u / far - 1.0).abs() < 1e-11), "{} of {far}", fallen.u[0]);
        }
        // Where the residual is accepted without a split, the strain is the round-off of the displacement.
        let strained = fallen.ledger.elastic / fallen.ledger.kinetic;
        assert!(strained < if is_exact { 1e-15 } else { 1e-6 }, "{scheme}: {strained:e}");
        assert!(!is_exact || !fallen.carried.rigid.is_empty(), "nothing is split off");
        let pressed = memory.reports.iter().flat_map(|report| &report.contact.states).map(|state| state.pressure);
        let most = pressed.fold(0.0, f64::max);
        assert!(scheme == "euler" || (most / 39.12e6 - 1.0).abs() < 0.15, "{scheme}: at most {most:e} Pa");
        for state in &memory.states {
            let ledger = &state.ledger;
            assert!(ledger.closing_error.abs() <= 1e-11 * ledger.turned_over, "{scheme}, step {}", state.step);
        }
    }
}

/// A pin that has fallen far and one that starts near the floor with its velocity bear the same pressures, step for
/// step: what is split off is where the floor sees it.
#[test]
fn a_pin_hits_the_floor_alike_from_far_and_from_near() {
    let (fall, span) = (0.100_963, 2e-5);
    let pressures = |[scheme, law]: [&str; 2], far: bool| -> Vec<f64> {
        let impact = |start: f64| format!("{{ name = \"impact\", end = {:?}, steps = 200 }}", start + span);
        let own = if far {
            vec![format!("phase=[{{ name = \"fall\", end = {fall:?}, steps = 10 }}, {}]", impact(fall))]
        } else {
            vec![
                format!("phase=[{}]", impact(0.0)),
                format!("initial.velocity=[{:?}]", -9.81 * fall),
                format!("contact.gap={:?}", 0.05 - 0.5 * 9.81 * fall * fall),
            ]
        };
        let keys =
            [vec![format!("time.scheme={scheme}"), "mesh.n=100".to_owned(), format!("contact.normal={law}")], own]
                .concat();
        let problem = case::read(&file("cases/dropped-pin.toml"), &keys).unwrap_or_else(|error| panic!("{error}"));
        let memory = solve(&problem.problem);
        let last = memory.states.last().expect("a state");
        assert_eq!(!last.carried.rigid.is_empty(), far, "a far motion is split off, and a near one is not");
        let reports = &memory.reports[memory.reports.len() - 200..];
        reports.iter().map(|report| report.contact.states[0].pressure / 39.12e6).collect()
    };
    let (rigid, layer) = ("{ law = \"signorini\" }", "{ law = \"compliance\", stiffness = 4e14 }");
    for [scheme, law] in [["theta", rigid], ["theta", layer], ["contact-stabilised", rigid]] {
        let [far, near] = [true, false].map(|far| pressures([scheme, law], far));
        assert!(near.iter().filter(|p| **p > 0.5).count() > 50, "{scheme}, {law}: it hits");
        for (n, (far, near)) in far.iter().zip(&near).enumerate() {
            assert!((far - near).abs() < 1e-6, "{scheme}, {law}, step {n}: {far} from far, {near} from near");
        }
    }
}
