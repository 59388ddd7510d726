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
