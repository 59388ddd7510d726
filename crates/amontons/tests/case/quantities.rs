//! Numbers with a unit in a case file: `"210 GPa"`.

use crate::common::{self, told};
use amontons::case::{self, CaseError, Source};
use amontons::run::{self, Settings};
use amontons::units::Measure;

/// A case in °C is reported in °C, differences of temperature in K: "272 K" was −1 °C. One without units of
/// temperature, or in K, is in K.
#[test]
fn temperatures_are_named_on_the_scale_of_the_case() {
    let unit = |text: &str| {
        let case = case::parse(&Source::new("pad.toml", text), &[]).unwrap_or_else(|error| panic!("{error}"));
        let rows = run::run(&case.problem, &Settings::default(), &mut []).expect("a run").rows();
        let range = rows.iter().find(|(name, _)| name == "temperature").expect("a row").1.clone();
        let units = case.problem.units();
        (units.of(Measure::Temperature), units.of(Measure::TemperatureDifference), range)
    };
    let (celsius, difference, range) = unit(DRAWN);
    assert!(
        celsius == "°C" && difference == "K" && range.ends_with(" °C at the nodes"),
        "{celsius}, {difference}, {range}"
    );
    for text in [PLAIN.to_owned(), DRAWN.replace("°C", "K")] {
        let (kelvin, difference, range) = unit(&text);
        assert!(
            kelvin == "K" && difference == "K" && range.ends_with(" K at the nodes"),
            "{kelvin}, {difference}, {range}"
        );
    }
}

/// A brake pad in the units of a drawing.
const DRAWN: &str = r#"
name = "pad"
[mesh]
kind = "rectangle"
size = ["60 mm", "2 cm"]
n = [6, 2]
[material]
density = "7.3 g/cm³"
heat_capacity = "2.5e3 kJ/(m³ K)"
conductivity = "50 W/(m K)"
expansion_coefficient = "12e-6 1/K"
elasticity = { law = "isotropic", young = { temperature = ["20 °C", "600 °C"], value = ["210 GPa", "110 kN/mm²"] }, poisson = 0.3, stress_state = "plane-stress" }
viscosity = { law = "lame", first = "1 MPa s", second = "2 MPa·s" }
[initial]
temperature = "20 °C"
[load]
body_force = [0, "-70 kN/m³"]
[time]
end = "2 min"
steps = 3
[[boundary]]
on = "top"
displacement = ["1e-3 µm", "-2 µm"]
temperature = { times = ["0 s", "1 h"], values = ["20 °C", "300 °C"] }
[contact]
on = "bottom"
gap = "0.5 µm"
normal = { law = "compliance", stiffness = "1 GPa/mm" }
friction = { law = "coulomb", coefficient = "40 %", cap = "200 N/mm²" }
heat = { law = "ramp", conductance = "3 kW/(m² K)", width = "2 µm", foundation_temperature = "20 °C", truncation = "50 K" }
foundation = { heat_capacity = "4 kJ/(m K)", exchange = "2 W/(m K)" }
foundation_velocity = ["3.6 km/h", 0]
[output]
checkpoint = { seconds = "1 min" }
"#;

/// The same with plain numbers.
const PLAIN: &str = r#"
name = "pad"
[mesh]
kind = "rectangle"
size = [0.06, 0.02]
n = [6, 2]
[material]
density = 7300
heat_capacity = 2.5e6
conductivity = 50
expansion_coefficient = 12e-6
elasticity = { law = "isotropic", young = { temperature = [20, 600], value = [210e9, 110e9] }, poisson = 0.3, stress_state = "plane-stress" }
viscosity = { law = "lame", first = 1e6, second = 2e6 }
[initial]
temperature = 20
[load]
body_force = [0, -70e3]
[time]
end = 120
steps = 3
[[boundary]]
on = "top"
displacement = [1e-9, -2e-6]
temperature = { times = [0, 3600], values = [20, 300] }
[contact]
on = "bottom"
gap = 0.5e-6
normal = { law = "compliance", stiffness = 1e12 }
friction = { law = "coulomb", coefficient = 0.4, cap = 200e6 }
heat = { law = "ramp", conductance = 3000, width = 2e-6, foundation_temperature = 20, truncation = 50 }
foundation = { heat_capacity = 4000, exchange = 2 }
foundation_velocity = [1, 0]
[output]
checkpoint = { seconds = 60 }
"#;

/// A number with a unit is the number in SI units to the last bit: the runs agree in every bit.
#[test]
fn units_change_no_bit() -> Result<(), CaseError> {
    let parse = |text: &str| case::parse(&Source::new("pad.toml", text), &[]);
    let (drawn, plain) = (parse(DRAWN)?, parse(PLAIN)?);
    assert_eq!(drawn.checkpoint, plain.checkpoint);
    let [drawn_run, plain_run] = [&drawn, &plain].map(|case| common::solve(&case.problem));
    let last = |run: &amontons::output::Memory| {
        let state = run.states.last().expect("a state").clone();
        [state.u, state.w, state.theta].iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>()
    };
    assert!(last(&plain_run).iter().any(|bits| *bits != 0));
    assert_eq!(last(&drawn_run), last(&plain_run));
    assert_eq!(drawn.text, DRAWN, "the case is kept as it was written");
    Ok(())
}

/// A change of the drawn pad, and what is said of it.
const FAULTS: &[(&str, &str, &str)] = &[
    (
        "\"210 GPa\"",
        "\"210 mm\"",
        "12:89: material.elasticity.young.value[0]: found \"210 mm\", expected a quantity in Pa or in a unit that converts to it (values of the coefficient, one per temperature)",
    ),
    (
        "\"60 mm\"",
        "\"60 mmm\"",
        "5:9: mesh.size[0]: found \"60 mmm\", expected a quantity in m or in a unit that converts to it (lengths of the sides in m); the unit `mmm` is not known; units are written as in \"W/(m K)\"",
    ),
    (
        "\"60 mm\"",
        "\"-60 mm\"",
        "5:9: mesh.size[0]: found \"-60 mm\", expected a number > 0 (lengths of the sides in m)",
    ),
    (
        "\"7.3 g/cm³\"",
        "\"7.3 g/cm²\"",
        "8:11: material.density: found \"7.3 g/cm²\", expected a quantity in kg/m³ or in a unit that converts to it (density ρ in kg/m³; 0: quasistatic)",
    ),
    (
        "\"50 W/(m K)\"",
        "\"50 W/m K\"",
        "10:16: material.conductivity: found \"50 W/m K\", expected a quantity in W/(m K) or in a unit that converts to it (heat conductivity tensor 𝓚 of (2.2) in W/(m K))",
    ),
    (
        "\"12e-6 1/K\"",
        "\"12e-6 K\"",
        "11:25: material.expansion_coefficient: found \"12e-6 K\", expected a quantity in 1/K or in a unit that converts to it (coefficient of thermal expansion α in 1/K, from which 𝓜 = 𝓔α follows)",
    ),
    (
        "\"2 min\"",
        "\"2 minutes\"",
        "19:7: time.end: found \"2 minutes\", expected a quantity in s or in a unit that converts to it (end of the time interval in s); the unit `minutes` is not known; units are written as in \"W/(m K)\"",
    ),
    (
        "\"2 min\"",
        "\"2 GHz\"",
        "19:7: time.end: found \"2 GHz\", expected a quantity in s or in a unit that converts to it (end of the time interval in s)",
    ),
    (
        "\"40 %\"",
        "\"40 mm\"",
        "29:45: contact.friction.coefficient: found \"40 mm\", expected a number without a unit (friction coefficient μ)",
    ),
    (
        "\"3 kW/(m² K)\"",
        "\"3 kW/(m² K\"",
        "30:38: contact.heat.conductance: found \"3 kW/(m² K\", expected a quantity in W/(m² K) or in a unit that converts to it (conductance of closed contact in W/(m² K)); the unit `kW/(m² K` is not known; units are written as in \"W/(m K)\"",
    ),
    (
        "foundation_temperature = \"20 °C\"",
        "foundation_temperature = \"293.15 K\"",
        "30:94: contact.heat.foundation_temperature: found a temperature in K beside one in °C, boundary[0].temperature.values[0], expected all temperatures of a case on one scale; thermal stress is zero at the temperature 0 on the scale of the case",
    ),
    (
        "\"60 mm\"",
        "\"1e2147483647 km\"",
        "5:9: mesh.size[0]: found \"1e2147483647 km\", expected a number > 0 (lengths of the sides in m)",
    ),
    (
        "\"-70 kN/m³\"",
        "\"-70 kN\"",
        "17:18: load.body_force[1]: found \"-70 kN\", expected a quantity in N/m³ or in a unit that converts to it (body force f₀ in N/m³, one entry per component; empty for zero)",
    ),
    (
        "\"4 kJ/(m K)\"",
        "\"4 kJ/(m² K)\"",
        "31:32: contact.foundation.heat_capacity: found \"4 kJ/(m² K)\", expected a quantity in J/K or in a unit that converts to it (heat capacity of the foundation in J/K, per unit of thickness in two dimensions)",
    ),
    (
        "coefficient = \"40 %\"",
        "coefficient = \"-40 %\"",
        "29:45: contact.friction.coefficient: found \"-40 %\", expected a number ≥ 0, an expression in x, y, z, t or a table in time (friction coefficient μ)",
    ),
    (
        "steps = 3",
        "steps = \"3 s\"",
        "20:9: time.steps: found \"3 s\", expected \"auto\" (number of equal time steps, or \"auto\" for steps that follow from `accuracy`)",
    ),
    (
        "\"0.5 µm\"",
        "\"0.5 µm*x\"",
        "27:7: contact.gap: found \"0.5 µm*x\", expected a quantity in m or in a unit that converts to it (gap g to the foundation along the outward normal, in m); the unit `µm*x` is not known; units are written as in \"W/(m K)\"",
    ),
    (
        "poisson = 0.3",
        "poisson = \"0.3 GPa\"",
        "12:127: material.elasticity.poisson: found \"0.3 GPa\", expected a number without a unit (Poisson's ratio ν)",
    ),
];

#[test]
fn wrong_units_are_told() {
    for (old, new, expected) in FAULTS {
        let text = common::spoil(DRAWN, old, new);
        assert_eq!(told(&Source::new("pad.toml", text), &[]), format!("pad.toml:{expected}"), "{new}");
    }
}

/// The keys that have a unit, by their units; a key of one law only stands behind the law.
const UNITS: &[(&str, &str)] = &[
    ("1/K", "Material.expansion_coefficient"),
    ("1/Pa", "Wear archard.coefficient, Wear archard-temperature.coefficient"),
    ("1/s", "Stability.growth, Viscosity power-law.threshold"),
    ("Hz", "Stability.frequency"),
    ("J/(m³ K)", "Material.heat_capacity"),
    ("J/K", "Foundation.heat_capacity"),
    (
        "K",
        "Boundary.temperature, Convection.ambient, Exact.temperature, Foundation.surroundings, \
          Foundation.temperature, Friction temperature.temperature, \
          Heat constant.foundation_temperature, Heat constant.truncation, \
          Heat ramp.foundation_temperature, Heat ramp.truncation, Heat power.foundation_temperature, \
          Heat power.truncation, Heat pressure.foundation_temperature, Heat pressure.truncation, \
          Heat gap.foundation_temperature, Heat gap.truncation, Heat expression.foundation_temperature, \
          Heat expression.truncation, Heat radiation.absolute_zero, \
          Heat radiation.foundation_temperature, Heat sum.foundation_temperature, \
          HeatTerm constant.truncation, HeatTerm ramp.truncation, HeatTerm power.truncation, \
          HeatTerm pressure.truncation, HeatTerm gap.truncation, HeatTerm expression.truncation, HeatTerm radiation.absolute_zero, \
          Initial.temperature, Load.temperature, Region.temperature, TableData.temperature, Wear archard-temperature.temperature",
    ),
    ("N", "Boundary.force, ObstacleLoad.force, Preload.force, Rigid.force"),
    ("N m", "Rigid.moment"),
    ("N/m³", "Load.body_force, Region.body_force"),
    (
        "Pa",
        "Boundary.pressure, Boundary.traction, Elasticity isotropic.young, \
          Elasticity orthotropic.shear, Elasticity orthotropic.young, Elasticity anisotropic.voigt, \
          Elasticity von-mises-projection.excess, Elasticity von-mises-projection.young, \
          Elasticity hencky.bulk, Elasticity hencky.shear, Elasticity hencky.shear_infinite, \
          Fluid.pressure, Fluid.sealed_above, Friction coulomb.cap, Friction tresca.bound, Friction static-kinetic.cap, \
          Friction slip-rate.cap, Friction temperature.cap, Friction pressure.cap, \
          Friction pressure.pressure, Friction expression.cap, Normal table.pressure, Normal softening.peak, \
          Normal softening.residual, Normal adhesion.strength",
    ),
    (
        "Pa s",
        "Viscosity lame.first, Viscosity lame.second, Viscosity anisotropic.voigt, \
          Viscosity carreau.bulk, Viscosity carreau.infinite, Viscosity carreau.zero, \
          Viscosity power-law.bulk, Viscosity power-law.floor",
    ),
    ("Pa s/m", "Boundary.dashpot, Normal damped.damping"),
    ("Pa/K", "Material.expansion"),
    (
        "Pa/m",
        "Boundary.spring, Normal compliance.stiffness, Normal stop.stiffness, \
          Normal damped.stiffness, Normal softening.softening, Normal softening.stiffness, \
          Normal adhesion.stiffness",
    ),
    ("W/(m K)", "Heat gap.conductivity, HeatTerm gap.conductivity, Material.conductivity"),
    (
        "W/(m² K)",
        "Convection.coefficient, Heat constant.conductance, Heat ramp.conductance, \
          HeatTerm constant.conductance, HeatTerm ramp.conductance",
    ),
    ("W/(m² K⁴)", "Heat radiation.constant, HeatTerm radiation.constant"),
    ("W/K", "Foundation.exchange"),
    ("W/m²", "Boundary.heat_inflow"),
    ("W/m³", "Load.heat_source, Material.coupling, Region.heat_source"),
    ("kg", "ObstacleLoad.mass"),
    ("kg/m³", "Material.density"),
    (
        "m",
        "Automatic.distance, Block.height, Block.origin, Block.radii, Block.size, Boundary.at, Boundary.displacement, Boundary.normal_displacement, \
          Check probe.about, Check probe.at, Contact.gap, Cyclic.center, Exact.displacement, Heat ramp.width, Heat gap.roughness, \
          HeatTerm ramp.width, HeatTerm gap.roughness, InBox.from, InBox.to, InPlane.point, Initial.displacement, Mesh rectangle.origin, \
          Mesh rectangle.size, Mesh interval.size, Mesh box.size, Mesh disc.radius, Mesh ring.radii, \
          Mesh cylinder.height, Mesh cylinder.radii, Near.distance, Near.point, Normal table.penetration, Normal expression.begin, Normal stop.depth, \
          Normal adhesion.release, Obstacle plane.point, Obstacle sphere.center, \
          Obstacle sphere.radius, Obstacle cylinder.center, Obstacle cylinder.radius, \
          Obstacle wave.amplitude, Obstacle wave.point, Obstacle wave.wavelength, Obstacle file.origin, OnCylinder.point, OnCylinder.radius, OnSphere.center, \
          OnSphere.radius, Probe.about, Probe.at, Rigid.at, Turning.about",
    ),
    (
        "m/s",
        "Contact.foundation_velocity, Friction static-kinetic.decay_speed, Friction slip-rate.speed, \
          Initial.velocity",
    ),
    ("m/s²", "Load.gravity"),
    (
        "rad",
        "Block.angle, Elasticity orthotropic.orientation, Elasticity anisotropic.orientation, Facing.angle, Mesh ring.angle, \
          Mesh cylinder.angle, Turn.angle, Turning.angle, Viscosity anisotropic.orientation",
    ),
    (
        "s",
        "Branch.time, Check probe.time, Check history.time, Checkpoint.seconds, Preload.until, RunPhase.end, TableData.time, \
          TableData.times, Time.end, Viscosity carreau.time",
    ),
    ("s/m", "Normal hunt-crossley.damping"),
];

/// What a key measures is read off its description: all of them are listed here, to be held against their meaning.
#[test]
fn the_units_of_all_keys() {
    let schema = case::schema();
    let mut found = std::collections::BTreeMap::<String, Vec<String>>::new();
    for (name, table) in schema["$defs"].as_object().expect("tables") {
        units(name, table, &mut found);
    }
    let found: Vec<(String, String)> = found.into_iter().map(|(unit, keys)| (unit, keys.join(", "))).collect();
    let expected: Vec<(String, String)> =
        UNITS.iter().map(|(unit, keys)| ((*unit).to_owned(), (*keys).to_owned())).collect();
    assert_eq!(found, expected);
}

/// The schema lets a text with a unit stand where the program does: an editor has nothing to say against one.
#[test]
fn the_schema_allows_texts_with_units() {
    let schema = case::schema();
    let number = |pointer: &str| schema.pointer(pointer).unwrap_or_else(|| panic!("{pointer}")).clone();
    let time = number("/$defs/Time/properties");
    let allowed = serde_json::json!(["number", "string"]);
    assert_eq!((&time["end"]["type"], &time["end"]["x-unit"]), (&allowed, &serde_json::json!("s")));
    let kinds: Vec<_> = [0, 1].map(|i| number(&format!("/$defs/StepNumber/anyOf/{i}"))).into();
    assert_eq!((&kinds[0]["type"], &kinds[1]["$ref"]), (&"integer".into(), &"#/$defs/ChosenByProgram".into()));
    for key in ["times", "values", "value", "temperature"] {
        assert_eq!(number(&format!("/$defs/TableData/properties/{key}/items/type")), allowed, "{key}");
    }
    assert_eq!(number("/$defs/Material/type"), serde_json::json!(["object", "string"]));
}

/// `"210 GPa"` is refused where numbers have no units.
#[test]
fn a_case_without_units_has_none() {
    let text = common::spoil(DRAWN, "name = \"pad\"", "name = \"pad\"\nunits = \"dimensionless\"");
    let told = told(&Source::new("pad.toml", text), &[]);
    assert_eq!(
        told.lines().next(),
        Some(
            "pad.toml:6:9: mesh.size[0]: found \"60 mm\", expected a number without a unit, as the key `units` of the case \
             says (lengths of the sides in m)"
        )
    );
    assert_eq!(told.lines().count(), 33, "one for each quantity");
}

/// Overrides take units, too, in quotes or as bare words.
#[test]
fn overrides_have_units() -> Result<(), CaseError> {
    for value in ["\"2 ms\"", "0.002"] {
        let case = case::parse(&Source::new("pad.toml", PLAIN), &[format!("time.end={value}")])?;
        assert_eq!(case.problem.timeline.longest().to_bits(), (0.002f64 / 3.0).to_bits());
    }
    assert_eq!(
        told(&Source::new("pad.toml", PLAIN), &["time.end=\"2 mm\""]),
        "--set time.end=\"2 mm\": time.end: found \"2 mm\", expected a quantity in s or in a unit that converts to it \
         (end of the time interval in s)"
    );
    Ok(())
}

fn units(name: &str, table: &serde_json::Value, found: &mut std::collections::BTreeMap<String, Vec<String>>) {
    for (key, property) in table["properties"].as_object().into_iter().flatten() {
        if let Some(unit) = property["x-unit"].as_str() {
            found.entry(unit.to_owned()).or_default().push(format!("{name}.{key}"));
        }
    }
    for variant in table["oneOf"].as_array().into_iter().flatten() {
        let tag = variant["properties"].as_object().and_then(|all| all.values().find_map(|tag| tag["const"].as_str()));
        units(&format!("{name} {}", tag.unwrap_or_default()), variant, found);
    }
}
