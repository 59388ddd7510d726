//! Tables over the temperature with one thing spoiled each: the message is exact, with key, temperature and value.

use crate::common::{SMALL, told};
use amontons::case::Source;

/// A test each: `name: "KEY" "VALUE" "message behind the place"`.
macro_rules! spoiled {
    ($($name:ident: $key:literal $value:literal $line:literal;)*) => {
        $(#[test]
        fn $name() {
            let set = format!("{}={}", $key, $value);
            let expected = $line.replacen("KEY", $key, 1);
            let found = told(&Source::new("thermal.toml", SMALL), &[&set]);
            let found = found.strip_prefix(&format!("--set {set}: ")).unwrap_or(&found);
            assert_eq!(found, expected);
        })*
    };
}

spoiled! {
    temperatures_that_do_not_increase: "material.conductivity" "{ temperature = [0, 20, 20], value = [1, 2, 3] }"
        "KEY.temperature[2]: found the temperature 20.0 after 20.0, expected temperatures that increase";
    a_value_missing: "material.heat_capacity" "{ temperature = [0, 20], value = [1] }"
        "KEY.value: found 1 values for 2 temperatures, expected one value per temperature";
    no_rows: "material.heat_capacity" "{ temperature = [], value = [] }"
        "KEY.temperature: found no temperatures, expected at least one";
    a_value_that_is_not_finite: "material.elasticity.young" "{ temperature = [0, 20], value = [1, inf] }"
        "KEY.value[1]: found inf, expected a number (values of the coefficient, one per temperature)";
    a_temperature_that_is_not_finite: "material.elasticity.young" "{ temperature = [0, nan], value = [1, 2] }"
        "KEY.temperature[1]: found nan, expected a number (temperatures in K in increasing order, with `value`)";
    a_modulus_that_is_negative_at_one_temperature: "material.elasticity.young" "{ temperature = [0, 20, 40], value = [10, 5, -1] }"
        "KEY: found the value -1.0 at θ = 40.0, expected a number > 0 (Young's modulus E in Pa)";
    a_factor_that_makes_it_negative: "material.heat_capacity" "{ temperature = [0, 20], value = [1, 2], factor = \"x - 0.5\" }"
        "KEY: found the value -0.5 at θ = 0.0 at x = 0.0, y = 0.0, expected a number ≥ 0 (heat capacity per volume, the factor of θ̇ in (2.4), in J/(m³ K); 0: steady heat)";
    a_ratio_that_plane_strain_refuses: "material.elasticity.poisson" "{ temperature = [0, 20], value = [0.3, 0.5] }"
        "KEY: found 0.5 at x = 0.0, y = 0.0, θ = 20.0, expected a number > -1 and < 0.5 in plane strain (Poisson's ratio ν); use 0.49 for a nearly incompressible material; incompressible materials are not supported";
    heat_from_cold_to_warm_at_one_temperature: "material.conductivity" "{ temperature = [0, 20], value = [1, -1] }"
        "KEY: found the eigenvalue -1.0 at x = 0.0, y = 0.0, θ = 20.0, expected no negative eigenvalue: heat flows from warm to cold";
    an_initial_temperature_beyond_the_table: "material.conductivity" "{ temperature = [20, 200], value = [1, 2] }"
        "thermal.toml: initial.temperature: found the temperature 0.0 at x = 0.0, y = 0.0, expected temperatures from 20.0 to 200.0, which material.conductivity covers; extend the table, or give another initial temperature";
    tables_without_a_common_range: "material.elasticity" "{ law = 'isotropic', young = { temperature = [0, 10], value = [1, 2] }, poisson = { temperature = [20, 30], value = [0.1, 0.2] }, stress_state = 'plane-stress' }"
        "KEY: found tables over temperatures without a common range, expected tables of one law that have temperatures in common";
    a_density: "material.density" "{ temperature = [0, 20], value = [1, 2] }"
        "KEY: found a table over the temperature, expected a number, an expression or a table in time: this datum does not depend on the temperature";
    a_load: "load.heat_source" "{ temperature = [0, 20], value = [1, 2] }"
        "KEY: found a table over the temperature, expected a number, an expression or a table in time: this datum does not depend on the temperature";
    times_besides_temperatures: "material.heat_capacity" "{ temperature = [0, 20], value = [1, 2], times = [0, 1] }"
        "KEY: found a table without clear data, expected `temperature` and `value`, with `factor` alone";
    values_without_temperatures: "material.heat_capacity" "{ value = [1, 2] }"
        "KEY: found a table without clear data, expected `temperature` and `value`, with `factor` alone";
    a_factor_in_time: "material.heat_capacity" "{ temperature = [0, 20], value = [1, 2], factor = \"1 + t\" }"
        "KEY.factor: found `t` in an expression, expected an expression in x, y";
    branches_besides_a_modulus_over_the_temperature: "material" "{ density = 1, heat_capacity = 1, conductivity = 1, elasticity = { law = 'isotropic', young = { temperature = [0, 1], value = [1, 2] }, poisson = 0.3, stress_state = 'plane-stress' }, prony = [{ ratio = 0.5, time = 1.0 }] }"
        "KEY.prony: found branches besides an elasticity over the temperature, expected an elasticity that does not depend on the temperature: branches are multiples of it";
    tangent_coefficients_that_do_not_reach_zero: "material" "{ density = 1, heat_capacity = 1, conductivity = 1, elasticity = { law = 'isotropic', young = 1, poisson = 0.3, stress_state = 'plane-stress' }, expansion_coefficient = { temperature = [-20, -5], value = [1, 2] }, expansion_kind = 'tangent' }"
        "KEY.expansion_coefficient: found tangent coefficients from θ = -20.0 to θ = -5.0, expected a table that covers θ = 0; extend the table to θ = 0, at which nothing is expanded";
}
