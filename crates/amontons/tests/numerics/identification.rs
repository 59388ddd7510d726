//! Identification: parameters that made the data, intervals over many draws of noise, what data do not determine.

use amontons::case::{self, Source};
use amontons::identification::{
    DescentEnding, DescentState, IdentificationError, IdentificationRequest, Identified, MeasuredTable, identify,
};

const NONE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// A block that is pushed along a warm foundation: it sticks, slips, turns round and warms up.
const BLOCK: &str = r#"
name = "block"
units = "dimensionless"
[constants]
mu = 0.35
fade = 0.08
[mesh]
kind = "rectangle"
size = [2, 1]
n = [4, 2]
elements = "Q1"
[time]
end = 2.0
steps = 24
analysis = "quasistatic"
[material]
elasticity = { law = "isotropic", young = 100, poisson = 0.3, stress_state = "plane-strain" }
heat_capacity = 1.0
conductivity = 0.4
[[boundary]]
on = "top"
displacement = ["0.03*sin(3*t)", "-0.01*min(4*t, 1)"]
temperature = 0
[contact]
on = "bottom"
normal = { law = "compliance", stiffness = 1e3 }
friction = { law = "expression", coefficient = "mu*(1 - fade*theta)" }
frictional_heat = 0.5
heat = { law = "constant", conductance = 2.0, foundation_temperature = 1.0 }
[[probe]]
name = "warm"
quantity = "temperature"
at = [1, 0]
"#;

fn source(text: &str) -> Source {
    Source::new("block.toml", text)
}

/// Identifies keys of a case from data.
fn fitted(
    text: &str,
    set: &[String],
    (keys, bounds): (&[&str], &[[f64; 2]]),
    data: &str,
) -> Result<Identified, IdentificationError> {
    gone_on(text, set, (keys, bounds), data, None, &mut |_| Ok(()))
}

fn gone_on(
    text: &str,
    set: &[String],
    (keys, bounds): (&[&str], &[[f64; 2]]),
    data: &str,
    from: Option<DescentState>,
    watch: &mut dyn FnMut(&DescentState) -> Result<(), IdentificationError>,
) -> Result<Identified, IdentificationError> {
    let source = source(text);
    let case = case::parse(&source, set).unwrap_or_else(|error| panic!("{error}"));
    let keys: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
    let family = case::family(&source, set, &keys).unwrap_or_else(|fault| panic!("{fault}"));
    let measured = MeasuredTable::parse("data.csv", data.as_bytes()).unwrap_or_else(|fault| panic!("{fault}"));
    let request = IdentificationRequest {
        family: &family,
        bounds,
        probes: &case.probes,
        measured: &measured,
        from,
        interrupt: None,
    };
    identify(&request, watch)
}

/// The outputs of a case at its steps: of `history.csv` the force along the foundation, and its probe.
fn outputs(text: &str) -> Vec<[f64; 3]> {
    use amontons::output::Memory;
    use amontons::run::{self, Settings};
    let case = case::parse(&source(text), &[]).unwrap_or_else(|error| panic!("{error}"));
    let mut memory = Memory::new().reports().states_every(1);
    let settings = Settings { certificate: false, ..Settings::default() };
    run::run(&case.problem, &settings, &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    let node = case.problem.mesh.points.iter().position(|x| (x[0] - 1.0).abs() + x[1].abs() < 1e-12).expect("a node");
    let rows = memory.states.iter().skip(1).zip(&memory.reports);
    rows.map(|(state, report)| [state.t, report.contact.force[0], state.theta[node]]).collect()
}

/// Normal deviates, the same in every run of the test.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// The outputs as data, with noise of these deviations; they are stated if `states`.
fn data(rows: &[[f64; 3]], deviations: [f64; 2], states: bool, noise: &mut Noise) -> String {
    let [force, warm] = deviations;
    let mut text =
        if states { "t,contact_force_x,contact_force_x_sigma,warm,warm_sigma\n" } else { "t,contact_force_x,warm\n" }
            .to_owned();
    for [t, f, theta] in rows {
        let (f, theta) = (f + force * noise.normal(), theta + warm * noise.normal());
        text += &if states {
            format!("{t:?},{f:?},{force:?},{theta:?},{warm:?}\n")
        } else {
            format!("{t:?},{f:?},{theta:?}\n")
        };
    }
    text
}

const KEYS: [&str; 4] = ["constants.mu", "constants.fade", "contact.heat.conductance", "material.elasticity.young"];
const TRUTH: [f64; 4] = [0.35, 0.08, 2.0, 100.0];

fn starts(values: [f64; 4]) -> Vec<String> {
    KEYS.iter().zip(values).map(|(key, value)| format!("{key}={value:?}")).collect()
}

#[test]
fn exact_data_give_back_the_parameters_that_made_them() {
    let text = data(&outputs(BLOCK), [0.0, 0.0], false, &mut Noise(1));
    for start in [[0.2, 0.02, 1.0, 70.0], [0.5, 0.15, 4.0, 150.0]] {
        let found = fitted(BLOCK, &starts(start), (&KEYS, &[NONE; 4]), &text).unwrap_or_else(|error| panic!("{error}"));
        for (of, truth) in found.parameters.iter().zip(TRUTH) {
            assert!((of.value / truth - 1.0).abs() < 1e-7, "{}: {} from {start:?}", of.name, of.value);
        }
        assert_eq!(found.ending, DescentEnding::Minimum);
        assert!(found.runs < 40, "{} runs", found.runs);
    }
}

/// Intervals hold what they promise: over 100 draws of noise the truth is in the 95 % ellipsoid 90 times or more, and
/// in the interval of each parameter 88 to 100 times, as it is with a chance of 0.95 in 999 of 1000 cases.
#[test]
fn intervals_contain_the_truth_in_nineteen_of_twenty_draws() {
    const CHI_SQUARE: f64 = 9.487_729; // quantile 0.95 with four degrees of freedom
    let rows = outputs(BLOCK);
    let (mut inside, mut each) = (0usize, [0usize; 4]);
    for (seed, states) in (0..100u64).map(|seed| (seed, true)) {
        let text = data(&rows, [0.003, 0.01], states, &mut Noise(1000 * seed + 17));
        let found = fitted(BLOCK, &starts([0.3, 0.06, 1.5, 90.0]), (&KEYS, &[NONE; 4]), &text)
            .unwrap_or_else(|error| panic!("{seed}: {error}"));
        let scaled: Vec<f64> = found
            .parameters
            .iter()
            .zip(TRUTH)
            .map(|(of, truth)| (of.value - truth) / of.deviation.expect("a deviation"))
            .collect();
        inside += usize::from(mahalanobis(&found, &scaled) <= CHI_SQUARE);
        for (count, of) in each.iter_mut().zip(&scaled) {
            *count += usize::from(of.abs() <= 1.96);
        }
    }
    println!("of 100 draws {inside} in the ellipsoid, {each:?} in the intervals");
    assert!((90..=100).contains(&inside), "{inside} in the ellipsoid");
    assert!(each.iter().all(|count| (88..=100).contains(count)), "{each:?} in the intervals");
    assert!(each.iter().any(|count| *count < 100), "intervals that never fail are too wide: {each:?}");
}

/// xᵀ C⁻¹ x with the matrix C of correlations, by elimination.
fn mahalanobis(found: &Identified, x: &[f64]) -> f64 {
    let p = x.len();
    let mut rows: Vec<Vec<f64>> = (0..p)
        .map(|i| (0..p).map(|j| found.correlations[i][j].expect("a correlation")).chain([x[i]]).collect())
        .collect();
    for i in 0..p {
        for k in i + 1..p {
            let factor = rows[k][i] / rows[i][i];
            let above = rows[i].clone();
            rows[k].iter_mut().zip(above).for_each(|(to, from)| *to -= factor * from);
        }
    }
    let mut solved = vec![0.0; p];
    for i in (0..p).rev() {
        let rest: f64 = (i + 1..p).map(|j| rows[i][j] * solved[j]).sum();
        solved[i] = (rows[i][p] - rest) / rows[i][i];
    }
    solved.iter().zip(x).map(|(solved, x)| solved * x).sum()
}

/// Deviations that the data do not state are found from the residuals, series by series.
#[test]
fn deviations_are_estimated_where_data_do_not_state_them() {
    let rows: Vec<[f64; 3]> = outputs(&BLOCK.replace("steps = 24", "steps = 400"));
    let text = data(&rows, [0.003, 0.05], false, &mut Noise(5));
    let case = BLOCK.replace("steps = 24", "steps = 400");
    let found = fitted(&case, &starts([0.3, 0.06, 1.5, 90.0]), (&KEYS, &[NONE; 4]), &text)
        .unwrap_or_else(|error| panic!("{error}"));
    // The relative error of a deviation of 400 values is 1/√800 = 0.035.
    for (of, deviation) in found.series.iter().zip([0.003, 0.05]) {
        let estimated = of.deviation.expect("an estimate");
        assert!((estimated / deviation - 1.0).abs() < 0.12, "{}: {estimated}", of.name);
        assert!(!of.is_systematic, "{}: {}", of.name, of.autocorrelation);
    }
    for (of, truth) in found.parameters.iter().zip(TRUTH) {
        let deviation = of.deviation.expect("a deviation");
        assert!((of.value - truth).abs() < 4.0 * deviation, "{}: {} ± {deviation}", of.name, of.value);
    }
    assert!((found.chi_square / found.freedom as f64 - 1.0).abs() < 0.01, "{}", found.chi_square);
}

/// A rod under a load: only the load over the stiffness is determined.
#[test]
fn a_quotient_is_determined_and_its_parts_are_not() {
    const ROD: &str = r#"
name = "rod"
units = "dimensionless"
[constants]
load = 3.0
[mesh]
kind = "interval"
size = 1.0
n = 4
[time]
end = 1.0
steps = 10
analysis = "quasistatic"
[material]
elasticity = { law = "isotropic", young = 20.0, poisson = 0.0 }
[[boundary]]
on = "left"
displacement = [0]
[[boundary]]
on = "right"
traction = ["load*t"]
[[probe]]
name = "u"
quantity = "displacement"
at = [1]
"#;
    let rows: Vec<String> =
        (1..=10).map(|n| format!("{:?},{:?},1e-4\n", 0.1 * f64::from(n), 0.02 * f64::from(n))).collect();
    let text = format!("t,u_x,u_x_sigma\n{}", rows.concat());
    let keys = ["constants.load", "material.elasticity.young"];
    let found = fitted(ROD, &[], (&keys, &[NONE; 2]), &text).unwrap_or_else(|error| panic!("{error}"));
    let [load, young] = [0, 1].map(|i| found.parameters[i].value);
    assert!((load / young / 0.2 - 1.0).abs() < 1e-9, "{load} / {young}");
    // The shortest relative change from 3/20 to 4/20: both parts change by as much, in opposite directions.
    assert!(load > 3.2 && young < 19.0, "{load} {young}");
    assert!(found.parameters.iter().all(|of| of.interval.is_none()));
    let [known, unknown] = [0, 1].map(|i| &found.combinations[i]);
    assert!(known.is_determined && !unknown.is_determined && unknown.half_width.is_none());
    assert!((known.exponents[0] + known.exponents[1]).abs() < 1e-7, "{:?}", known.exponents);
    // u = tF/E at ten times: the relative deviation of F/E is σ/√Σu², of which √2 times as much along a unit vector.
    let squares: f64 = (1..=10).map(|n| (0.02 * f64::from(n)).powi(2)).sum();
    let exact = 1.959_963_984_540_054 * 1e-4 / (2.0 * squares).sqrt();
    assert!((known.half_width.expect("a width") / exact - 1.0).abs() < 1e-6, "{:?} {exact}", known.half_width);
}

#[test]
fn bounds_hold_and_the_others_fit_beside_them() {
    let text = data(&outputs(BLOCK), [0.003, 0.01], true, &mut Noise(3));
    let bounds = [[0.0, 0.33], [0.0, f64::INFINITY], NONE, NONE];
    let found = fitted(BLOCK, &starts([0.3, 0.06, 1.5, 90.0]), (&KEYS, &bounds), &text)
        .unwrap_or_else(|error| panic!("{error}"));
    let mu = &found.parameters[0];
    assert!(mu.is_at_bound && mu.interval.is_none() && mu.value.to_bits() == 0.33f64.to_bits(), "{mu:?}");
    assert!(found.parameters[1..].iter().all(|of| !of.is_at_bound && of.interval.is_some()));
    // The others are those that are found if it stands at its bound in the case.
    let set: Vec<String> = starts([0.33, 0.06, 1.5, 90.0]);
    let alone = fitted(BLOCK, &set, (&KEYS[1..], &[NONE; 3]), &text).unwrap_or_else(|error| panic!("{error}"));
    for (a, b) in found.parameters[1..].iter().zip(&alone.parameters) {
        let deviation = b.deviation.expect("a deviation");
        assert!((a.value - b.value).abs() < 1e-3 * deviation, "{}: {} {}", a.name, a.value, b.value);
    }
}

/// A descent that was stopped after each of its steps ends with the bits of one that was not, on any number of threads.
#[test]
fn a_descent_goes_on_with_the_same_bits() {
    let text = data(&outputs(BLOCK), [0.003, 0.01], false, &mut Noise(8));
    let (set, asked) = (starts([0.25, 0.04, 1.0, 80.0]), (&KEYS[..], &[NONE; 4][..]));
    let whole = fitted(BLOCK, &set, asked, &text).unwrap_or_else(|error| panic!("{error}"));
    let mut from = None;
    let last = loop {
        let (mut seen, mut count) = (None, 0);
        let made = gone_on(BLOCK, &set, asked, &text, from.clone(), &mut |state| {
            count += 1;
            seen = Some(state.clone());
            if count == 2 { Err(IdentificationError::Interrupted) } else { Ok(()) }
        });
        match made {
            Ok(found) => break found,
            Err(IdentificationError::Interrupted) => {
                // It is kept as text.
                let kept = serde_json::to_string(&seen.expect("a state")).expect("a text");
                from = Some(serde_json::from_str(&kept).expect("a state"));
            }
            Err(error) => panic!("{error}"),
        }
    };
    assert_eq!(whole, last);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let alone = pool.install(|| fitted(BLOCK, &set, asked, &text)).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(whole, alone);
}

/// One value and one parameter: the value is met, and nothing tells how sure it is.
#[test]
fn as_many_values_as_parameters_have_no_intervals() {
    let rows = outputs(BLOCK);
    let [t, force, _] = rows[10];
    for (states, text) in [
        (false, format!("t,contact_force_x\n{t:?},{force:?}\n")),
        (true, format!("t,contact_force_x,contact_force_x_sigma\n{t:?},{force:?},0.003\n")),
    ] {
        let found = fitted(BLOCK, &starts([0.3, 0.08, 2.0, 100.0]), (&["constants.mu"], &[NONE]), &text)
            .unwrap_or_else(|error| panic!("{error}"));
        // Another coefficient may have the same force at one time. With a stated deviation the descent ends 1e-5 of it
        // from the minimum.
        let (mu, fitted) = (&found.parameters[0], found.points[0].fitted);
        assert!((fitted / force - 1.0).abs() < 1e-7, "{fitted} {force} {}", mu.value);
        assert_eq!((mu.interval.is_some(), found.combinations[0].is_determined), (states, true));
    }
    // A force with the sign of the one that the bench takes.
    let text: String = rows.iter().map(|[t, force, _]| format!("{t:?},{:?}\n", 0.0 - force)).collect();
    let found = fitted(BLOCK, &[], (&["constants.mu"], &[[0.0, 1.0]]), &format!("t,contact_force_x\n{text}"));
    let found = found.unwrap_or_else(|error| panic!("{error}"));
    assert!(found.parameters[0].is_at_bound || found.series[0].is_opposite, "{:?}", found.series);
}

/// A case that misses something is told from noise.
#[test]
fn residuals_that_go_together_are_told() {
    let text = data(&outputs(BLOCK), [0.003, 0.01], true, &mut Noise(4));
    // Without its fading the friction cannot follow.
    let found = fitted(BLOCK, &starts([0.3, 0.0, 1.5, 90.0]), (&["constants.mu"], &[NONE]), &text)
        .unwrap_or_else(|error| panic!("{error}"));
    assert!(found.series.iter().any(|of| of.is_systematic), "{:?}", found.series);
    assert!(found.chi_square > 2.0 * found.freedom as f64, "{}", found.chi_square);
}

#[test]
fn spoiled_data_have_one_clear_message() {
    let told = |text: &str| match MeasuredTable::parse("data.csv", text.as_bytes()) {
        Ok(_) => panic!("{text}"),
        Err(fault) => fault.to_string(),
    };
    for (text, message) in [
        ("", "data.csv: found no rows, expected a header with `t` and the names of outputs"),
        ("0,1\n1,2\n", "data.csv: found a first line of numbers, expected a header with `t` and the names of outputs"),
        (
            "x,u\n0,1\n",
            "data.csv: found the columns x, u, expected a column `t` with times in s, counted as in the run",
        ),
        ("t,time,u\n0,0,1\n", "data.csv: found several columns of times, expected one column `t`"),
        ("t\n0\n", "data.csv: found no column beside the times, expected a column per output, under its name"),
        ("t,u,u\n0,1,2\n", "data.csv: found two columns \"u\", expected columns with different names"),
        ("t,u\n0,1\n1\n", "data.csv: found 1 entries in line 3 of data.csv, expected 2, as in line 1"),
        ("t,u\n0,one\n", "data.csv: found \"one\" in line 2, expected a number in the column \"u\""),
        (
            "t;u\n0;1,5\n",
            "data.csv: found \"1,5\" in line 2, expected a number in the column \"u\"; decimals stand behind a point",
        ),
        ("t,u\n0,\n", "data.csv: found no value in the column \"u\", expected at least one; remove the column"),
        (
            "t,u,u_sigma\n0,1,0\n",
            "data.csv: found the standard deviation 0.0 in line 2, expected positive standard deviations",
        ),
        (
            "t,u,u_sigma\n0,1,\n",
            "data.csv: found no standard deviation in line 2, expected a standard deviation for each value of u",
        ),
        (
            "t,u,u_sigma,v\n0,1,1,1\n",
            "data.csv: found no column \"v_sigma\", expected standard deviations of all outputs, or of none",
        ),
        ("t,u\n,1\n", "data.csv: found no time in line 2, expected a time for each value of u"),
    ] {
        assert_eq!(told(text), message);
    }
}

/// The state of another descent, and bounds of another number of parameters, are refused, not indexed.
#[test]
fn a_state_of_other_parameters_is_refused() {
    let data = "t,warm\n1,0.5\n2,0.7\n";
    let state = DescentState {
        values: vec![0.3, 0.1],
        damping: 0.0,
        deviations: vec![1.0],
        estimates: 0,
        steps: 0,
        runs: 1,
        history: Vec::new(),
    };
    let made = gone_on(BLOCK, &[], (&["constants.mu"], &[NONE]), data, Some(state.clone()), &mut |_| Ok(()));
    let told = made.map(|_| ()).expect_err("a state of two parameters").to_string();
    assert!(told.starts_with("the state of the descent: found one of other parameters or data"), "{told}");
    let told =
        fitted(BLOCK, &[], (&["constants.mu"], &[NONE; 2]), data).map(|_| ()).expect_err("two bounds").to_string();
    assert!(told.starts_with("the parameters: found 1 names, 1 values and 2 bounds"), "{told}");
    // A descent that has used up its steps is no result.
    let state = DescentState { values: vec![0.3], steps: 200, ..state };
    let made = gone_on(BLOCK, &[], (&["constants.mu"], &[NONE]), data, Some(state), &mut |_| Ok(()));
    assert!(matches!(made, Err(IdentificationError::NoMinimum { steps: 200, .. })));
}

#[test]
fn what_cannot_be_identified_is_refused() {
    let told = |keys: &[&str], bounds: &[[f64; 2]], text: &str| match fitted(BLOCK, &[], (keys, bounds), text) {
        Ok(_) => panic!("{keys:?} {bounds:?} {text}"),
        Err(error) => error.to_string(),
    };
    let (mu, two) = (&["constants.mu"][..], "t,warm\n1,0.5\n2,0.7\n");
    for (found, message) in [
        (
            told(&KEYS, &[NONE; 4], two),
            "data.csv: found 2 values for 4 parameters, expected at least as many values as parameters; measure more, or free fewer parameters",
        ),
        (
            told(mu, &[[0.5, 0.4]], two),
            "constants.mu: found bounds from 0.5 to 0.4, expected a lower bound and a larger upper one",
        ),
        (
            told(mu, &[[0.4, 0.5]], two),
            "constants.mu: found 0.35 in the case, expected a value within its bounds; start from another value with --set constants.mu=VALUE",
        ),
        (
            told(&["constants.mu", "constants.mu"], &[NONE; 2], two),
            "constants.mu: found a parameter that is named twice, expected each parameter once",
        ),
        (
            told(mu, &[NONE], "t,warm\n1,0.5\n3,0.7\n"),
            "data.csv: found the time 3.0 of warm, expected times of the run; the run is from 0 to 2.0 s",
        ),
        (
            told(mu, &[NONE], "t,contact_force_x\n0.01,0.5\n"),
            "data.csv: found the time 0.01 of contact_force_x, expected a time at which it has a value; values of contact begin at the end of the first step, 0.08333333333333333 s",
        ),
    ] {
        assert_eq!(found, message);
    }
    let unknown = told(mu, &[NONE], "t,warmth\n1,0.5\n");
    assert!(unknown.starts_with("output warmth: found no number with derivatives, expected one of warm"), "{unknown}");
    let word = case::family(&source(BLOCK), &[], &["contact.friction.coefficient".to_owned()]).map(|_| ());
    let word = word.expect_err("an expression").to_string();
    assert!(word.contains("a number in an expression can be a key of [constants]"), "{word}");
}
