//! Orders in time of every scheme where contact is closed, opens and slips, by the slope of the errors over the steps.

use amontons::case::{self, Source};

use crate::common::{self, largest, solve};

/// A rod that bounces on a layer: in contact from t = 0.01 to t = 0.3 or so.
const ROD: &str = "name = \"rod\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"interval\"\nsize = 2.0\nn = 8\n\
    [time]\nend = 0.4\nsteps = 60\n[material]\ndensity = 1.5\n\
    elasticity = { law = \"isotropic\", young = 300.0, poisson = 0.0 }\n\
    viscosity = { law = \"lame\", first = 0.0, second = 0.3 }\n[initial]\nvelocity = [-1.0]\n\
    [contact]\non = \"left\"\ngap = 0.0131\nnormal = { law = \"compliance\", stiffness = 500.0 }\n";

/// u at the end.
fn end(text: &str, keys: &[&str], steps: usize) -> Vec<f64> {
    let mut keys: Vec<String> = keys.iter().map(|&key| key.to_owned()).collect();
    keys.push(format!("time.steps={steps}"));
    let problem = case::parse(&Source::new("order.toml", text), &keys).unwrap_or_else(|error| panic!("{error}"));
    solve(&problem.problem).states.pop().expect("a state").u
}

/// The slope of log error over log steps by least squares, with the errors relative to the largest displacement.
fn slope(text: &str, keys: &[&str], steps: &[usize], exact: &[f64]) -> f64 {
    let points: Vec<[f64; 2]> = steps
        .iter()
        .map(|&n| {
            let u = end(text, keys, n);
            let error = u.iter().zip(exact).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
            [-(n as f64).ln(), (error / largest(exact)).ln()]
        })
        .collect();
    let mean = |c: usize| points.iter().map(|p| p[c]).sum::<f64>() / points.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    let sums = points.iter().fold([0.0; 2], |[a, b], p| [a + (p[0] - x) * (p[1] - y), b + (p[0] - x).powi(2)]);
    sums[0] / sums[1]
}

/// Where a layer closes and opens.
#[test]
fn orders_where_contact_opens() {
    let exact = end(ROD, &["time.scheme=theta"], 40_960);
    for (keys, order) in [
        (&["time.scheme=euler"][..], 1.0),
        (&["time.scheme=theta"], 2.0),
        (&["time.scheme=theta", "time.pressure=plain"], 2.0),
        (&["time.scheme=theta", "time.theta=0.6"], 1.0),
        (&["time.scheme=bdf2"], 2.0),
        (&["time.scheme=contact-stabilised"], 2.0),
    ] {
        let found = slope(ROD, keys, &[320, 640, 1280, 2560], &exact);
        assert!((found - order).abs() < 0.2, "{keys:?}: order {found}");
    }
}

/// Where a rigid wall is hit and left: of about the first order, with errors that depend on where in a step the wall
/// is hit, and the contact-stabilised scheme of the second to its own limit.
#[test]
fn orders_where_a_wall_is_hit() {
    let keys = |scheme: &'static str| [scheme, "contact.normal={ law = \"signorini\" }"];
    let exact = end(ROD, &keys("time.scheme=theta"), 81_920);
    for scheme in ["time.scheme=euler", "time.scheme=theta", "time.scheme=bdf2"] {
        let found = slope(ROD, &keys(scheme), &[150, 310, 630, 1270, 2550, 5110], &exact);
        assert!(found > 0.6 && (found < 1.2 || scheme != "time.scheme=euler"), "{scheme}: order {found}");
    }
    let own = keys("time.scheme=contact-stabilised");
    let found = slope(ROD, &own, &[150, 310, 630, 1270], &end(ROD, &own, 40_960));
    assert!((found - 2.0).abs() < 0.4, "order {found}");
}

/// A block that sticks and slips: of the first order or nearly so in all schemes, with errors that are much smaller at
/// ϑ = ½.
#[test]
fn orders_where_friction_sticks_and_slips() {
    let text = std::fs::read_to_string(common::file("crates/amontons/tests/reference/time/stick-slip-midpoint.toml"));
    let text = common::spoil(&text.expect("the case"), "theta = 0.5\n", "");
    let steps = [320, 640, 1280, 2560];
    let exact = end(&text, &["time.scheme=theta"], 20_480);
    let error = |keys: &[&str]| {
        let u = end(&text, keys, 320);
        u.iter().zip(&exact).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()))
    };
    for keys in [
        &["time.scheme=euler"][..],
        &["time.scheme=theta"],
        &["time.scheme=theta", "time.friction=end"],
        &["time.scheme=bdf2"],
    ] {
        let found = slope(&text, keys, &steps, &exact);
        assert!(found > 0.6, "{keys:?}: order {found}");
    }
    let [euler, half] = [["time.scheme=euler"], ["time.scheme=theta"]].map(|keys| error(&keys));
    assert!(half < 0.1 * euler, "{half:e} and {euler:e}");
}

/// A wave in a rod that friction stops, with 600 steps of half a cell: u(0) = F²/(qEA) = 0.01 and, where the load has
/// acted for 0.1, 0.0075 by characteristics.
#[test]
fn a_friction_wave_needs_few_steps() {
    let file = common::file("crates/amontons/benchmarks/friction-wave.toml");
    let keys = ["mesh.n=[250, 1]", "time.steps=600"].map(str::to_owned);
    let memory = solve(&case::read(&file, &keys).unwrap_or_else(|error| panic!("{error}")).problem);
    for (step, expected) in [(600, 0.01), (200, 0.0075)] {
        let found = memory.states[step].u[0];
        assert!((found - expected).abs() < 0.005 * expected, "step {step}: {found}, expected {expected}");
    }
}
