//! Runs for an accuracy: bars of numbers against closed forms, and meshes that become finer where they matter.

use amontons::accuracy::{
    AccuracyEnding, AccuracyError, AccuracyNews, AccuracyRequest, AccurateCase, ValueLevel, of_values,
};
use amontons::adjoint::{GradientRequest, gradient, multipliers};
use amontons::case::Source;
use amontons::run::Settings;

/// Refines a case until numbers are accurate.
fn refined(text: &str, overrides: &[&str], of: &str, relative: f64) -> Result<AccurateCase<ValueLevel>, AccuracyError> {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let (source, settings) = (Source::new("case.toml", text), Settings::default());
    let request = AccuracyRequest { source: &source, overrides: &overrides, relative, settings: &settings };
    let asked: Vec<String> = of.split(',').map(str::to_owned).collect();
    of_values(&request, &asked, &mut |news| {
        if let AccuracyNews::Level(level) = news {
            let rows = level
                .goals
                .iter()
                .map(|goal| format!("{} {:e} +- {:e}", goal.row.name, goal.row.value, goal.row.bar()));
            println!("{} cells {} steps: {}", level.cells, level.steps, rows.collect::<Vec<_>>().join(", "));
        }
    })
}

fn shipped(path: &str) -> String {
    let path = format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// A shipped case with one more probe.
fn with_probe(path: &str, probe: &str) -> String {
    format!("{}\n[[probe]]\n{probe}\n", shipped(path))
}

/// The number and its bar at the end of each level.
fn numbers(found: &AccurateCase<ValueLevel>) -> Vec<(f64, f64)> {
    found.levels.iter().map(|level| (level.goals[0].row.value, level.goals[0].row.bar())).collect()
}

const BENCHMARKS: &str = "crates/amontons/benchmarks";

/// Numbers whose closed form is known, on meshes and with steps that are too coarse: from the second level on, which is
/// the first that may be the last, the bar is at least the error, and at the end it is as small as asked.
#[test]
fn numbers_have_bars_above_their_errors() {
    let edge = shipped("cases/contact-edge.toml");
    let at = |x: &str| {
        with_probe("cases/contact-edge.toml", &format!("name = \"q\"\nquantity = \"pressure\"\nat = [{x}, 0.0]"))
    };
    let fin = with_probe(
        &format!("{BENCHMARKS}/convection-fin.toml"),
        "name = \"tip\"\nquantity = \"temperature\"\nat = [2.0, 0.0]",
    );
    let rod = with_probe(
        &format!("{BENCHMARKS}/kelvin-voigt-rod.toml"),
        "name = \"end\"\nquantity = \"displacement_x\"\nat = [1.0, 0.0]",
    );
    let roller = shipped(&format!("{BENCHMARKS}/hertz-cylinder-obstacle.toml"));
    let cases: [(&str, &str, &[&str], &str, f64, f64); 7] = [
        ("a contact edge", &edge, &[], "p", 0.01, 0.2_f64.sqrt()),
        ("the same near the edge", &at("0.05"), &[], "q", 0.01, 0.05_f64.sqrt()),
        ("linear triangles", &at("0.5"), &["mesh.elements=\"P1\""], "q", 0.01, 0.5_f64.sqrt()),
        ("quadrilaterals", &edge, &["mesh.elements=\"Q1\""], "p", 0.01, 0.2_f64.sqrt()),
        ("a fin", &fin, &["mesh.n=[4, 1]", "mesh.elements=\"P1\""], "tip", 0.001, 3.532_146_268_614_795_7),
        ("a rod that creeps", &rod, &["time.steps=4", "time.end=0.3"], "end", 0.01, (1.0 - (-3.06_f64).exp()) / 102.0),
        ("a cylinder", &roller, &[], "contact_force_y", 0.01, 0.007_853_981_633_974_483),
    ];
    for (what, text, overrides, of, relative, exact) in cases {
        let found = refined(text, overrides, of, relative).unwrap_or_else(|error| panic!("{what}: {error}"));
        assert_eq!(found.ending, AccuracyEnding::Reached, "{what}");
        for (value, bar) in numbers(&found).into_iter().skip(1) {
            let error = (value - exact).abs();
            println!("{what}: {value} bar {bar:e} error {error:e}");
            assert!(error <= bar + 1e-9 * exact, "{what}: {value} +- {bar}, exact {exact}");
        }
        let last = numbers(&found).pop().expect("a level");
        assert!(last.1 <= relative * exact * 1.02, "{what}: {last:?}");
    }
}

/// A probe of one side of a pair, whose closed form is Lamé's.
#[test]
fn the_pressure_of_a_press_fit_has_a_bar_above_its_error() {
    let fit = with_probe(
        &format!("{BENCHMARKS}/pair-press-fit.toml"),
        "name = \"fit\"\nquantity = \"pressure\"\non = \"inner_right\"\ntake = \"mean\"",
    );
    let coarse = fit.replace("\"Q2\"", "\"Q1\"").replace("n = [8, 1]", "n = [4, 2]").replace("0.1]", "5.0]");
    let found = refined(&coarse, &[], "fit", 0.002).expect("an accuracy");
    assert_eq!(found.ending, AccuracyEnding::Reached);
    for (value, bar) in numbers(&found).into_iter().skip(1) {
        println!("{value} +- {bar:e}: error {:e}", (value - 5.859_375).abs());
        assert!((value - 5.859_375).abs() <= bar, "{value} +- {bar}");
    }
    assert!(found.levels.len() > 1);
}

/// The sides of a sector keep the same mesh: it is refined as a whole. Closed form: u_y = 5.2e-3 (1 − 1/r²) x.
#[test]
fn a_sector_is_refined_as_a_whole() {
    let sector = with_probe(
        &format!("{BENCHMARKS}/twisted-sector.toml"),
        "name = \"q\"\nquantity = \"displacement_y\"\nat = [1.7, 0.4]",
    );
    let found = refined(&sector, &["mesh.elements=\"P1\""], "q", 0.0005).expect("levels");
    assert!(found.ending == AccuracyEnding::Reached && found.levels.len() > 2, "{:?}", found.ending);
    let exact = 5.2e-3 * (1.0 - 1.0 / (1.7_f64.powi(2) + 0.4_f64.powi(2))) * 1.7;
    for (value, bar) in numbers(&found).into_iter().skip(1) {
        assert!((value - exact).abs() <= bar, "{value} +- {bar}, exact {exact}");
    }
}

/// A block between two plates, whose clamped corners have singular stresses.
const CLAMPED: &str = r#"
name = "clamped"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 1.0]
n = [4, 4]
[time]
end = 1.0
steps = 1
analysis = "quasistatic"
[material]
elasticity = { law = "isotropic", young = 1.0, poisson = 0.3, stress_state = "plane-strain" }
[[boundary]]
on = "top"
displacement = [0.0, -0.1]
[[boundary]]
on = "bottom"
displacement = [0.0, 0.0]
[[probe]]
name = "corner"
quantity = "von_mises"
at = [0.0, 0.0]
[[probe]]
name = "side"
quantity = "displacement"
at = [1.0, 0.5]
"#;

/// A stress at a corner has no limit: that is said, and the run ends. A displacement beside it has one, and is named by
/// its probe with both of its components.
#[test]
fn a_number_without_a_limit_is_named() {
    let found = refined(CLAMPED, &[], "corner", 0.01).expect("levels");
    let AccuracyEnding::Stands(why) = &found.ending else { panic!("{:?}", found.ending) };
    assert!(why.contains("may have no limit"), "{why}");
    let found = refined(CLAMPED, &[], "side", 0.001).expect("levels");
    let last = &found.levels[found.levels.len() - 1];
    let names: Vec<&str> = last.goals.iter().map(|goal| goal.row.name.as_str()).collect();
    assert_eq!((names, &found.ending), (vec!["side_x", "side_y"], &AccuracyEnding::Reached));
    // The component that moves little has the scale of the other.
    assert!(last.goals[1].relative < 0.001, "{:?}", last.goals);
}

/// A block that meets its foundation in the middle of a step, with a gap and friction: two and four steps have the same
/// end to the last digit, eight another one by half a per cent. One halving alone does not show that.
#[test]
fn steps_that_hit_the_same_number_by_chance_are_halved_again() {
    let text = r#"
name = "dragged"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [0.897091, 1.0]
n = [5, 5]
elements = "Q1"
[time]
end = 1.0
steps = 2
analysis = "quasistatic"
[material]
elasticity = { law = "isotropic", young = 1.0, poisson = 0.0201307, stress_state = "plane-strain" }
[[boundary]]
on = "top"
displacement = ["0.0746992*t^2", "-0.0673042*t^2"]
[contact]
on = "bottom"
gap = 0.01
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.434619 }
[[probe]]
name = "d"
quantity = "displacement_y"
at = [0.712882, 0.306302]
"#;
    let found = refined(text, &[], "d", 0.01).expect("levels");
    let last = &found.levels[found.levels.len() - 1];
    // Of a mesh of 160 × 160 cells with 64 steps.
    let (value, reference) = (last.goals[0].row.value, -0.033_653_2_f64);
    assert!(last.steps >= 8 && found.ending == AccuracyEnding::Reached, "{} steps", last.steps);
    assert!((value / reference - 1.0).abs() < 0.01, "{value}");
}

/// Cells become finer where they matter for the number, and by derivatives less elsewhere than by jumps alone: the
/// number at one side does not see the corners at the other.
#[test]
fn cells_that_do_not_matter_stay_coarse() {
    let long = CLAMPED
        .replace("size = [1.0, 1.0]\nn = [4, 4]", "size = [1.0, 6.0]\nn = [2, 12]")
        .replace("displacement = [0.0, -0.1]", "displacement = [0.1, -0.1]")
        .replace("at = [1.0, 0.5]", "at = [1.0, 0.7]")
        + "[[probe]]\nname = \"strain\"\nquantity = \"strain_yy\"\nat = [0.4, 0.6]\n";
    let found = refined(&long, &[], "strain", 0.004).expect("levels");
    let mesh = &found.case.problem.mesh;
    let at = |low: f64, high: f64| mesh.points.iter().filter(|x| x[1] >= low && x[1] <= high).count();
    println!("{} below, {} above", at(0.0, 1.5), at(4.5, 6.0));
    assert!(found.levels.len() > 2 && found.levels.iter().all(|level| level.unweighted.is_none()));
    assert!(at(0.0, 1.5) > 3 * at(4.5, 6.0), "{} below, {} above", at(0.0, 1.5), at(4.5, 6.0));
}

#[test]
fn what_cannot_be_asked_for_is_refused() {
    let told = |of: &str, relative: f64| match refined(CLAMPED, &[], of, relative) {
        Err(error) => error.to_string(),
        Ok(found) => panic!("{:?}", found.levels),
    };
    let unknown = told("corners", 0.1);
    assert!(unknown.starts_with("--of: corners: found no such number, expected one of corner, side, "), "{unknown}");
    assert!(told("corner", 1.5).starts_with("--accuracy: found 1.5, expected a part"));
    assert!(told("corner", f64::NAN).starts_with("--accuracy: found NaN"));
}

/// The multipliers of the steps are derivatives by nodal forces: with a body force of density f in each of them, their
/// sum over steps and nodes is the derivative by f.
#[test]
fn multipliers_are_derivatives_by_forces() {
    let source = super::gradient::source("block-stick-slip");
    let case = super::gradient::parsed(&source, &[]);
    let sets: super::gradient::Overrides = Box::new(|value| vec![format!("load.body_force=[0.0, {value:e}]")]);
    let along = super::gradient::parameter(&source, ("load", 0.0), &sets);
    let outputs = ["corner_x".to_owned(), "pressure".to_owned()];
    let request = GradientRequest {
        problem: &case.problem,
        probes: &case.probes,
        outputs: &outputs,
        parameters: &[along],
        memory: None,
        interrupt: None,
    };
    let expected = gradient(&request).expect("derivatives");
    // ∫ φ of linear triangles: a third of the areas around a node.
    let mesh = &case.problem.mesh;
    let mut areas = vec![0.0; mesh.points.len()];
    for cell in mesh.blocks.iter().flat_map(|block| block.nodes.chunks_exact(3)) {
        let [a, b, c] = [0, 1, 2].map(|i| mesh.points[cell[i] as usize]);
        let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        for &node in cell {
            areas[node as usize] += twice / 6.0;
        }
    }
    let (mut sums, mut steps) = ([0.0; 2], 0);
    multipliers(&GradientRequest { parameters: &[], ..request }, &mut |output, [z, _]| {
        steps += 1;
        sums[output] += areas.iter().enumerate().map(|(node, area)| area * z[2 * node + 1]).sum::<f64>();
    })
    .expect("multipliers");
    assert_eq!(steps, 2 * case.problem.timeline.steps());
    for (sum, row) in sums.iter().zip(&expected.derivatives) {
        assert!(
            (sum - row[0]).abs() < 1e-8 * row[0].abs() && row[0].abs() > 1e-6,
            "{sums:?} {:?}",
            expected.derivatives
        );
    }
}

/// A pressed and dragged block, wherever it lies, whatever the axes and the units are.
#[test]
fn the_bars_of_a_body_do_not_know_where_it_lies() {
    let of = |turn: f64, mirror: f64, stiffness: f64, origin: [f64; 2], elements: &str| {
        let diagonal = match (elements, mirror > 0.0) {
            ("Q1", _) => "",
            (_, true) => ", diagonal = \"right\"",
            (_, false) => ", diagonal = \"left\"",
        };
        let text = super::adaptive::block(turn, mirror, stiffness, origin, elements).replace(", DIAGONAL", diagonal);
        let x = if mirror > 0.0 { 0.7 } else { 1.3 };
        let (s, c) = turn.sin_cos();
        let at = [origin[0] + c * x, origin[1] + s * x];
        let probe = format!("[[probe]]\nname = \"p\"\nquantity = \"pressure\"\nat = {at:?}\n");
        let found = refined(&(text + &probe), &[], "p", 0.01).expect("levels");
        let of_level = |level: &ValueLevel| (level.cells, level.goals[0].row.bar() / level.goals[0].row.value);
        found.levels.iter().map(of_level).collect::<Vec<_>>()
    };
    for elements in ["P1", "P2", "Q1"] {
        let plain = of(0.0, 1.0, 1.0, [0.0; 2], elements);
        assert!(plain.len() > 1, "{elements}: {plain:?}");
        let others = [
            ("turned", of(0.7, 1.0, 1.0, [0.0; 2], elements)),
            ("upside down", of(std::f64::consts::PI, 1.0, 1.0, [0.0; 2], elements)),
            ("mirrored", of(0.0, -1.0, 1.0, [0.0; 2], elements)),
            ("stiffer", of(0.0, 1.0, 2.1e11, [0.0; 2], elements)),
            ("moved", of(0.0, 1.0, 1.0, [1e-9, 1e3], elements)),
        ];
        for (name, other) in others {
            assert_eq!(other.len(), plain.len(), "{elements} {name}: {plain:?} {other:?}");
            for (plain, other) in plain.iter().zip(&other) {
                let is_same = plain.0 == other.0 && (plain.1 - other.1).abs() < 1e-6 * plain.1;
                assert!(is_same, "{elements} {name}: {plain:?} {other:?}");
            }
        }
    }
}
