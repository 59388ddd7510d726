//! Data in space and time and conditions on sides, as the case file has them: what holds, and each fault with its
//! place.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::common::{spoil, told};
use amontons::case::{self, Files, Source};
use amontons::field::Field;
use amontons::problem::Support;

const CASE: &str = r#"name = "sides"
[mesh]
kind = "rectangle"
size = [2.0, 1.0]
n = 2
[time]
end = 2.0
steps = 4
[material]
density = 1.0
heat_capacity = 1.0
expansion = 0.0
coupling = 0.0
conductivity = 1.0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.0, stress_state = "plane-stress" }
viscosity = { law = "lame", first = 0.0, second = 1.0 }
[load]
heat_source = 1.0
[[boundary]]
on = "left"
displacement = [0, "free"]
temperature = 0.0
[[boundary]]
on = "right"
traction = [1.0, 0.0]
heat_inflow = 1.0
[[boundary]]
on = "top"
normal_displacement = 0.0
convection = { coefficient = 2.0, ambient = "t" }
[[boundary]]
on = "bottom"
spring = 5.0
dashpot = [1.0, "x"]
pressure = { times = [0, 2], values = [0, 1] }
"#;

const FORCE: &str = "t,force,\"heat\"\n0,0,1\n1,2,1\n2,-1,3\n";

fn source(text: String) -> Source {
    let files = [
        ("load.csv", FORCE),
        ("short.csv", "0,1\n1,2\n"),
        ("late.csv", "t,f\n0.5,1\n2,2\n"),
        ("ragged.csv", "t,f\n0,1\n1\n"),
        ("word.csv", "t,f\n0,1\n1,two\n"),
        ("comma.csv", "t;f\n0;1\n1;2,5\n"),
        ("back.csv", "t,f\n0,1\n1,2\n\n1,3\n"),
        ("one.csv", "t\n0\n"),
        ("empty.csv", "# nothing\n"),
        ("header.csv", "t,f\n"),
        ("infinite.csv", "0,1\n1,inf\n"),
    ];
    let memory: BTreeMap<String, Arc<[u8]>> =
        files.map(|(name, text)| (name.to_owned(), Arc::from(text.as_bytes()))).into();
    Source { files: Files::Memory(memory), ..Source::new("sides.toml", text) }
}

fn message(text: String, overrides: &[&str]) -> String {
    told(&source(text), overrides)
}

#[test]
fn sides_are_what_the_case_says() {
    let case = case::parse(&source(CASE.to_owned()), &[]).unwrap();
    let [left, _, top, bottom] = case.problem.boundary.as_slice() else { panic!() };
    assert_eq!(left.displacement, Some(vec![Some(Field::ZERO), None]));
    assert_eq!(top.convection.as_ref().unwrap().coefficient, Field::Constant(2.0));
    assert_eq!(bottom.spring, Some(Support::Normal(Field::Constant(5.0))));
    assert!((bottom.pressure.as_ref().unwrap().value(&[0.0; 3], 0.5) - 0.25).abs() < 1e-15);
    // Left holds x, top the normal, which is y; the corner of both has both.
    let space = case.problem.displacement_space();
    let held: Vec<usize> = (0..space.free.len()).filter(|&dof| !space.free[dof]).collect();
    assert_eq!(held, [0, 6, 12, 13, 15, 17]);
    assert!(case.inputs.is_empty() && case.text == CASE && case.fingerprint() == CASE);
}

#[test]
fn columns_are_found_by_header_or_number() {
    let value = |datum: &str, x: f64, t: f64| {
        let text = spoil(CASE, "heat_source = 1.0", &format!("heat_source = {datum}"));
        let case = case::parse(&source(text), &[]).unwrap_or_else(|error| panic!("{datum}: {error}"));
        case.problem.heat_source.value(&[x, 0.0, 0.0], t)
    };
    for (datum, expected) in [
        ("{ table = \"load.csv\" }", 0.5),
        ("{ table = \"load.csv\", column = \"heat\", time = \"t\" }", 2.0),
        ("{ table = \"load.csv\", column = 3, factor = 2 }", 4.0),
        ("{ table = \"load.csv\", column = 3, factor = \"x*(1 - x)\" }", 0.5),
        ("{ table = \"short.csv\", extend = \"hold\" }", 2.0),
        ("{ times = [-1, 1, 3], values = [0, 2, 6], factor = \"t\" }", 1.5 * 3.0),
    ] {
        assert!((value(datum, 0.5, 1.5) - expected).abs() < 1e-14, "{datum}");
    }
}

/// The case as run refers to the copies, and read with the copies it is the same case.
#[test]
fn copies_of_files_make_the_same_case() {
    let text = spoil(CASE, "heat_source = 1.0", "heat_source = { table = \"load.csv\", column = 3 } # from the oven");
    let first =
        case::parse(&source(text.clone()), &["load.body_force=[0, { table = \"load.csv\" }]".to_owned()]).unwrap();
    assert!(
        first.text.contains("heat_source = { table = \"inputs/load.csv\", column = 3 } # from the oven\n"),
        "{}",
        first.text
    );
    assert!(first.text.contains("body_force = [0, { table = \"inputs/load.csv\" }]"), "{}", first.text);
    let [copy] = first.inputs.as_slice() else { panic!() };
    assert_eq!((copy.path.as_str(), &*copy.bytes), ("inputs/load.csv", FORCE.as_bytes()));
    let files = Files::Memory([(copy.path.clone(), Arc::clone(&copy.bytes))].into());
    let again = case::parse(&Source { files, ..Source::new("case.toml", first.text.clone()) }, &[]).unwrap();
    assert_eq!((&again.text, &again.inputs, again.fingerprint()), (&first.text, &first.inputs, first.fingerprint()));
    // Other contents are another case.
    let files = Files::Memory([(copy.path.clone(), Arc::from(FORCE.replace("2,-1,3", "2,-1,4").as_bytes()))].into());
    let other = case::parse(&Source { files, ..Source::new("case.toml", first.text.clone()) }, &[]).unwrap();
    assert!(other.text == first.text && other.fingerprint() != first.fingerprint());
}

/// A test each: `name: "old" => "new" "line of the message"… ;`
macro_rules! spoiled {
    ($($name:ident: $old:literal => $new:literal $(set $set:literal)* $($line:literal)+;)*) => {
        $(#[test]
        fn $name() {
            let overrides: &[&str] = &[$($set),*];
            assert_eq!(message(spoil(CASE, $old, $new), overrides), [$($line),+].join("\n"));
        })*
    };
}

// Tables.
spoiled! {
    no_such_file: "heat_source = 1.0" => "heat_source = { table = \"laod.csv\" }"
        "sides.toml:18:25: load.heat_source.table: found \"laod.csv\", which is not there, expected a file beside the case file; did you mean \"load.csv\"?";
    no_such_column: "heat_source = 1.0" => "heat_source = { table = \"load.csv\", column = \"forse\" }"
        "sides.toml:18:46: load.heat_source.column: found \"forse\", expected one of the columns t, force, heat of load.csv; did you mean \"force\"?";
    no_such_time_column: "heat_source = 1.0" => "heat_source = { table = \"load.csv\", time = 4 }"
        "sides.toml:18:44: load.heat_source.time: found 3 columns in load.csv, expected at least 4";
    column_zero: "heat_source = 1.0" => "heat_source = { table = \"load.csv\", column = 0 }"
        "sides.toml:18:46: load.heat_source.column: found 0, expected an integer ≥ 1 (column of the values, by header or by number from 1; default: the second)";
    column_without_header: "heat_source = 1.0" => "heat_source = { table = \"short.csv\", column = \"f\" }"
        "sides.toml:18:47: load.heat_source.column: found \"f\", but short.csv has no header, expected the number of a column from 1 to 2";
    table_too_short: "heat_source = 1.0" => "heat_source = { table = \"short.csv\" }"
        "sides.toml:18:15: load.heat_source: found a table that ends at t = 1.0, expected values to the end of the run, t = 2.0; give more rows, or `extend = \"hold\"` to keep the value at the end";
    table_too_late: "heat_source = 1.0" => "heat_source = { table = \"late.csv\" }"
        "sides.toml:18:15: load.heat_source: found a table that begins at t = 0.5, expected values from t = 0; give more rows, or `extend = \"hold\"` to keep the value at the end";
    table_too_short_on_a_side: "heat_inflow = 1.0" => "heat_inflow = { table = \"short.csv\" }"
        "sides.toml:26:15: boundary[1].heat_inflow: found a table that ends at t = 1.0, expected values to the end of the run, t = 2.0; give more rows, or `extend = \"hold\"` to keep the value at the end";
    ragged_row: "heat_source = 1.0" => "heat_source = { table = \"ragged.csv\" }"
        "sides.toml:18:25: load.heat_source.table: found 1 entries in line 3 of ragged.csv, expected 2, as in line 1";
    word_in_a_row: "heat_source = 1.0" => "heat_source = { table = \"word.csv\" }"
        "sides.toml:18:25: load.heat_source.table: found \"two\" in line 3 of word.csv, expected a number in the column \"f\"";
    decimal_comma: "heat_source = 1.0" => "heat_source = { table = \"comma.csv\" }"
        "sides.toml:18:25: load.heat_source.table: found \"2,5\" in line 3 of comma.csv, expected a number in the column \"f\"; decimals stand behind a point";
    infinite_in_a_row: "heat_source = 1.0" => "heat_source = { table = \"infinite.csv\" }"
        "sides.toml:18:25: load.heat_source.table: found \"inf\" in line 2 of infinite.csv, expected a number in column 2";
    times_that_go_back: "heat_source = 1.0" => "heat_source = { table = \"back.csv\" }"
        "sides.toml:18:25: load.heat_source.table: found the time 1.0 after 1.0 in line 5 of back.csv, expected times that increase";
    one_column: "heat_source = 1.0" => "heat_source = { table = \"one.csv\" }"
        "sides.toml:18:25: load.heat_source.table: found 1 columns in one.csv, expected at least 2";
    empty_file: "heat_source = 1.0" => "heat_source = { table = \"empty.csv\" }"
        "sides.toml:18:25: load.heat_source.table: found no rows in empty.csv, expected a time and a value per row";
    header_alone: "heat_source = 1.0" => "heat_source = { table = \"header.csv\" }"
        "sides.toml:18:25: load.heat_source.table: found no rows in header.csv, expected a time and a value per row";
    file_and_values: "heat_source = 1.0" => "heat_source = { table = \"load.csv\", times = [0, 2], values = [0, 1] }"
        "sides.toml:18:15: load.heat_source: found a table without clear data, expected either `table`, the name of a file, or `times` and `values`";
    neither_file_nor_values: "heat_source = 1.0" => "heat_source = { times = [0, 2] }"
        "sides.toml:18:15: load.heat_source: found a table without clear data, expected either `table`, the name of a file, or `times` and `values`";
    column_of_values: "heat_source = 1.0" => "heat_source = { times = [0, 2], values = [0, 1], column = 2 }"
        "sides.toml:18:59: load.heat_source.column: found `column` besides `times` and `values`, expected `table`, a file, with it";
    values_are_missing: "values = [0, 1]" => "values = [0]"
        "sides.toml:35:39: boundary[3].pressure.values: found 1 values for 2 times, expected one value per time";
    no_times: "times = [0, 2], values = [0, 1]" => "times = [], values = []"
        "sides.toml:35:22: boundary[3].pressure.times: found no times, expected at least one";
    equal_times: "times = [0, 2], values = [0, 1]" => "times = [0, 2, 2], values = [0, 1, 2]"
        "sides.toml:35:29: boundary[3].pressure.times[2]: found the time 2.0 after 2.0, expected times that increase";
    faulty_factor: "values = [0, 1]" => "values = [0, 1], factor = \"x*\""
        "sides.toml:35:59: boundary[3].pressure.factor: found the end of the expression, expected a number, a variable, a function or `(`";
    factor_with_z: "values = [0, 1]" => "values = [0, 1], factor = \"z\""
        "sides.toml:35:56: boundary[3].pressure.factor: found `z` in an expression, expected an expression in x, y, t: the body is plane";
    factor_infinite: "values = [0, 1]" => "values = [1, 1], factor = \"1/x\""
        "sides.toml:35:12: boundary[3].pressure: found the value inf at x = 0.0, y = 0.0, t = 0.0, expected finite values at all nodes on which it acts, at t = 0 and t = end";
    unknown_extension: "values = [0, 1]" => "values = [0, 1], extend = \"linear\""
        "sides.toml:35:56: boundary[3].pressure.extend: found \"linear\", expected \"none\" or \"hold\" (extrapolation outside the times)";
    unknown_key_of_a_table: "values = [0, 1]" => "valeus = [0, 1]"
        "sides.toml:35:30: boundary[3].pressure.valeus: found an unknown key, expected one of column, data, extend, factor, file, table, temperature, time, times, value, values; did you mean `values`?";
    table_of_initial_data: "[load]" => "[initial]\ntemperature = { times = [0, 2], values = [0, 1] }\n[load]"
        "sides.toml:18:15: initial.temperature: found a table, expected a number or an expression in x, y, z, t (temperature θ₀ in K)";
    table_of_a_coefficient: "coefficient = 2.0" => "coefficient = { times = [0, 2], values = [0, 1] }"
        "sides.toml:30:30: boundary[2].convection.coefficient: found a table, expected a number or an expression in x, y, z, t (heat transfer coefficient h in W/(m² K), constant in time)";
}

// Conditions that exclude each other.
spoiled! {
    displacement_twice: "displacement = [0, \"free\"]" => "displacement = [0, \"free\"]\nnormal_displacement = 0"
        "sides.toml:22:23: boundary[0].normal_displacement: found a displacement along the normal and one by components, expected one of the two; remove one of them";
    free_misspelled: "displacement = [0, \"free\"]" => "displacement = [0, \"fre\"]"
        "sides.toml:21:21: boundary[0].displacement[1]: found `fre`, expected a variable (x, y, z, t), a constant (pi, e) or a function";
    free_traction: "traction = [1.0, 0.0]" => "traction = [\"free\", 0.0]"
        "sides.toml:25:14: boundary[1].traction[0]: found `free`, expected a variable (x, y, z, t), a constant (pi, e) or a function";
    traction_on_a_held_component: "displacement = [0, \"free\"]" => "displacement = [0, \"free\"]\ntraction = [1, 2]"
        "sides.toml:22:13: boundary[0].traction[0]: found a traction in a direction whose displacement is prescribed, expected one of the two: Γ_D and Γ_N do not overlap; set it to 0";
    traction_on_a_held_normal: "normal_displacement = 0.0" => "normal_displacement = 0.0\ntraction = [1, 2]"
        "sides.toml:30:16: boundary[2].traction[1]: found a traction in a direction whose displacement is prescribed, expected one of the two: Γ_D and Γ_N do not overlap; set it to 0";
    pressure_on_a_held_normal: "normal_displacement = 0.0" => "normal_displacement = 0.0\npressure = 1"
        "sides.toml:30:12: boundary[2].pressure: found a pressure along the normal besides a displacement along it, expected one of the two: Γ_D and Γ_N do not overlap; remove one of them";
    spring_on_a_held_normal: "normal_displacement = 0.0" => "normal_displacement = 0.0\nspring = 1"
        "sides.toml:30:10: boundary[2].spring: found a spring along the normal besides a displacement along it, expected one of the two: Γ_D and Γ_N do not overlap; remove one of them";
    dashpot_on_a_held_side: "displacement = [0, \"free\"]" => "displacement = [0, 0]\ndashpot = [1, 1]"
        "sides.toml:22:11: boundary[0].dashpot: found a dashpot besides a displacement, expected one of the two: Γ_D and Γ_N do not overlap; remove one of them";
    convection_besides_a_temperature: "temperature = 0.0" => "temperature = 0.0\nconvection = { coefficient = 1 }"
        "sides.toml:23:14: boundary[0].convection: found a heat exchange with the surroundings besides a temperature, expected one of the two; remove one of them";
    normal_displacement_on_contact: "[load]" => "[contact]\non = \"top\"\nnormal = { law = \"compliance\", stiffness = 1 }\n[load]"
        "sides.toml:32:23: boundary[2].normal_displacement: found a displacement on \"top\", expected Γ_D apart from Γ_C; [contact] is on the same side; a side that bears contact takes loads, springs and heat flows only";
    spring_of_three_components: "spring = 5.0" => "spring = [1, 2, 3]"
        "sides.toml:33:10: boundary[3].spring: found 3 components, expected 2 components";
    negative_spring: "spring = 5.0" => "spring = -5.0"
        "sides.toml:33:10: boundary[3].spring: found the value -5.0, expected no negative value";
    spring_in_time: "spring = 5.0" => "spring = \"t\""
        "sides.toml:33:10: boundary[3].spring: found `t` in an expression, expected an expression in x, y: it is the same at all times";
    dashpot_negative_somewhere: "dashpot = [1.0, \"x\"]" => "dashpot = [1.0, \"x - 1\"]"
        "sides.toml:34:17: boundary[3].dashpot[1]: found the value -1.0 at x = 0.0, y = 0.0, expected no negative value";
    negative_convection: "coefficient = 2.0" => "coefficient = -2.0"
        "sides.toml:30:30: boundary[2].convection.coefficient: found the value -2.0, expected no negative value";
    convection_without_coefficient: "coefficient = 2.0, " => ""
        "sides.toml:30:14: boundary[2].convection.coefficient: found no such key, expected a number or an expression in x, y, z, t (heat transfer coefficient h in W/(m² K), constant in time)";
    convection_that_is_a_number: "convection = { coefficient = 2.0, ambient = \"t\" }" => "convection = 2.0"
        "sides.toml:30:14: boundary[2].convection: found 2.0, expected a table (heat exchange with the surroundings, −q·ν = coefficient (ambient − θ))";
}

/// Springs hold a body without density, dashpots and pressures do not.
#[test]
fn a_body_that_springs_hold_is_held() {
    let text =
        |side: &str| format!("{}\n[[boundary]]\non = \"left\"\n{side}\n", CASE.split("[[boundary]]").next().unwrap());
    let quasistatic = ["material.density=0", "material.heat_capacity=0"];
    let unheld = "boundary: found no displacement prescribed and density 0, expected a part Γ_D that holds the body; give `displacement` on a side, or a positive material.density";
    let uncooled = "boundary: found no temperature prescribed and heat_capacity 0, expected a side whose temperature is known; give `temperature` on a side, or a positive material.heat_capacity";
    for (side, faults) in [
        ("spring = [1, 1]\nconvection = { coefficient = 1 }", vec![]),
        ("spring = 0\nconvection = { coefficient = 0 }", vec![unheld, uncooled]),
        ("dashpot = [1, 1]\ntemperature = 0", vec![unheld]),
        ("displacement = [\"free\", \"free\"]\nheat_inflow = 1", vec![unheld, uncooled]),
        ("normal_displacement = 0\ntemperature = 0", vec![]),
    ] {
        let message = message(text(side), &quasistatic);
        let lines: Vec<&str> =
            message.lines().map(|line| line.strip_prefix("sides.toml:20:1: ").unwrap_or(line)).collect();
        assert_eq!(lines, if faults.is_empty() { vec!["no fault"] } else { faults }, "{side}");
    }
}

#[test]
fn a_text_without_a_folder_refers_to_no_files() {
    let text = spoil(CASE, "heat_source = 1.0", "heat_source = { table = \"load.csv\" }");
    let expected = "sides.toml:18:25: load.heat_source.table: found the file \"load.csv\", expected data in the case itself: it is a text without a folder";
    assert_eq!(told(&Source::new("sides.toml", text), &[]), expected);
}

/// Names are seen from the folder of the case file.
#[test]
fn files_are_found_beside_the_case_file() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("beside");
    std::fs::create_dir_all(folder.join("data")).unwrap();
    std::fs::write(folder.join("data/load.csv"), FORCE).unwrap();
    let path = folder.join("sides.toml");
    let write = |name: &str| {
        std::fs::write(&path, spoil(CASE, "heat_source = 1.0", &format!("heat_source = {{ table = \"{name}\" }}")))
            .unwrap();
    };
    write("data/load.csv");
    let case = case::read(&path, &[]).unwrap();
    assert!((case.problem.heat_source.value(&[0.0; 3], 0.5) - 1.0).abs() < 1e-15);
    for (name, what) in [
        ("data/lode.csv", "which is not there, expected a file beside the case file; did you mean \"data/load.csv\"?"),
        ("data", "which is no file, expected a file beside the case file"),
    ] {
        write(name);
        let message = case::read(&path, &[]).unwrap_err().to_string();
        assert_eq!(message, format!("{}:18:25: load.heat_source.table: found \"{name}\", {what}", path.display()));
    }
}
