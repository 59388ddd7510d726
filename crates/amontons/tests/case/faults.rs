//! The paper's case with one thing spoiled each: the message is exact, with its place.

use crate::common::{spoil, told};
use amontons::case::{self, CaseError, FaultPlace, Source};
use proptest::prelude::*;

const PAPER: &str = include_str!("../../../../cases/paper.toml");

fn message(text: String, overrides: &[&str]) -> String {
    told(&Source::new("paper.toml", text), overrides)
}

/// A test each: `name: "old" => "new" set "KEY=VALUE" "line of the message"… ;`
macro_rules! spoiled {
    ($($name:ident: $old:literal => $new:literal $(set $set:literal)* $($line:literal)+;)*) => {
        $(#[test]
        fn $name() {
            let overrides: &[&str] = &[$($set),*];
            assert_eq!(message(spoil(PAPER, $old, $new), overrides), [$($line),+].join("\n"));
        })*
    };
}

// Syntax.
spoiled! {
    syntax_unclosed: "size = [1.0, 1.0]" => "size = [1.0, 1.0"
        "paper.toml:16:1: found `n`, expected `,` or `]`; close the array before it";
    syntax_no_value: "end = 1.0" => "end ="
        "paper.toml:20:6: found the end of the line, expected a value";
    syntax_bare_word: "law = \"lame\"" => "law = lame"
        "paper.toml:35:7: found `lame`, expected a value; put strings in quotes";
    syntax_no_equals: "end = 1.0" => "end 1.0"
        "paper.toml:20:5: found `1`, expected `=`; key with no value";
    duplicate_key: "end = 1.0" => "end = 1.0\nend = 2.0"
        "paper.toml:21:1: found `end` again, expected each key once in its table";
    duplicate_table: "[output]" => "[time]"
        "paper.toml:69:2: found `time` again, expected each key once in its table"
        "paper.toml:70:1: time.every: found an unknown key, expected one of accuracy, analysis, end, friction, inertia, mass, pressure, restitution, scheme, steps, theta; `every` belongs to [output]";
    two_syntax_errors: "end = 1.0\nsteps = 64" => "end = \nsteps = "
        "paper.toml:20:7: found the end of the line, expected a value"
        "paper.toml:21:9: found the end of the line, expected a value";
}

// Keys.
spoiled! {
    unknown_key_misspelled: "density = 1.0 " => "densty = 1.0 "
        "paper.toml:24:1: material.densty: found an unknown key, expected one of base, conductivity, coupling, density, dilatation, elasticity, expansion, expansion_coefficient, expansion_kind, heat_capacity, prony, stress_state, viscosity; did you mean `density`?";
    unknown_key_by_another_name: "young = 2.0" => "E = 2.0"
        "paper.toml:31:1: material.elasticity.E: found an unknown key, expected one of law, poisson, stress_state, young; did you mean `young`?";
    unknown_key_of_another_table: "[time] " => "[time]\nyoung = 2.0 #"
        "paper.toml:20:1: time.young: found an unknown key, expected one of accuracy, analysis, end, friction, inertia, mass, pressure, restitution, scheme, steps, theta; `young` belongs to [material.elasticity] with law = \"isotropic\" or [material.elasticity] with law = \"orthotropic\" or [material.elasticity] with law = \"von-mises-projection\"";
    unknown_key_without_a_guess: "[output]" => "[output]\nfoobar = 3"
        "paper.toml:70:1: output.foobar: found an unknown key, expected one of checkpoint, error, every, fields, format";
    format_unknown: "[output]" => "[output]\nformat = \"vtkhd\""
        "paper.toml:70:10: output.format: found \"vtkhd\", expected \"vtu\", \"vtkhdf\" or \"both\" (format of the fields of a finished run); did you mean \"vtkhdf\"?";
    format_of_another_type: "[output]" => "[output]\nformat = [\"vtu\", \"vtkhdf\"]"
        "paper.toml:70:10: output.format: found an array of 2, expected \"vtu\", \"vtkhdf\" or \"both\" (format of the fields of a finished run)";
    coupling_unknown: "[output]" => "[scheme]\ncoupling = \"monolitic\"\n[output]"
        "paper.toml:70:12: scheme.coupling: found \"monolitic\", expected \"staggered\", \"extrapolated\", \"fixed-point\" or \"monolithic\" (how mechanics and heat are coupled within a step); did you mean \"monolithic\"?";
    unknown_table: "[output]" => "[outputs]"
        "paper.toml:69:2: outputs: found an unknown key, expected one of accuracy, boundary, constants, contact, cyclic, exact, expected, initial, load, material, mesh, name, output, phase, probe, region, rigid, scheme, side, solver, stability, thickness, time, units, verify; did you mean `output`?";
    unknown_key_at_the_root: "name = \"paper\"" => "name = \"paper\"\nsteps = 4"
        "paper.toml:11:1: steps: found an unknown key, expected one of accuracy, boundary, constants, contact, cyclic, exact, expected, initial, load, material, mesh, name, output, phase, probe, region, rigid, scheme, side, solver, stability, thickness, time, units, verify; `steps` belongs to [output.checkpoint] or [[phase]] or [time]";
    unknown_key_of_a_law: "law = \"coulomb\", coefficient" => "law = \"none\", coefficient"
        "paper.toml:61:28: contact.friction.coefficient: found an unknown key, expected `law` alone; `coefficient` belongs to [contact.friction] with law = \"coulomb\" or [contact.friction] with law = \"slip-rate\" or [contact.friction] with law = \"temperature\" or [contact.friction] with law = \"pressure\" or [contact.friction] with law = \"expression\"";
    unknown_key_in_a_boundary: "traction = [1.4, 0.4]" => "tracton = [1.4, 0.4]"
        "paper.toml:49:1: boundary[1].tracton: found an unknown key, expected one of at, convection, dashpot, displacement, force, heat_inflow, normal_displacement, on, phases, pressure, release, spring, temperature, traction; did you mean `traction`?";
    missing_key: "density = 1.0 " => "# "
        "paper.toml:23:1: material.density: found no such key, expected a number ≥ 0, an expression in x, y, z or data of a mesh file (density ρ in kg/m³; 0: quasistatic)";
    missing_key_of_a_law: "young = 2.0" => ""
        "paper.toml:29:1: material.elasticity.young: found no such key, expected a number > 0, an expression in x, y, z, data of a mesh file or a table over the temperature (Young's modulus E in Pa)";
    missing_name: "name = \"paper\"" => ""
        "paper.toml: name: found no such key, expected a string (name of the case and of its results folder)";
    missing_table: "[time] " => "[initial.x] #"
        "paper.toml: time: found no such key, expected a table (the time interval (0, end) and its steps)"
        "paper.toml:19:10: initial.x: found an unknown key, expected one of displacement, state, temperature, velocity";
    missing_law: "law = \"lame\"" => ""
        "paper.toml:34:1: material.viscosity.law: found no such key, expected \"lame\", \"anisotropic\", \"carreau\" or \"power-law\"";
    missing_side: "on = \"left\"\n" => ""
        "paper.toml:47:1: boundary[1]: found neither `on` nor `at`, expected one of both: `on`, the name of a side, or `at`, the coordinates of a node";
    missing_mesh_kind: "kind = \"rectangle\"" => ""
        "paper.toml:13:1: mesh.kind: found no such key, expected \"rectangle\", \"interval\", \"box\", \"disc\", \"ring\", \"cylinder\" or \"blocks\", or the key `file`";
}

// Types.
spoiled! {
    expression_out_of_range: "density = 1.0 " => "density = \"-1.0\" "
        "paper.toml:24:11: material.density: found the value -1.0 at x = 0.0, y = 0.0, expected a number ≥ 0 (density ρ in kg/m³; 0: quasistatic)";
    word_for_number: "heat_capacity = 1.0 " => "heat_capacity = \"one\" "
        "paper.toml:25:18: material.heat_capacity: found `one`, expected a variable (x, y, z, t), a constant (pi, e) or a function";
    number_for_string: "name = \"paper\"" => "name = 3"
        "paper.toml:10:8: name: found 3, expected a string (name of the case and of its results folder)";
    table_for_number: "end = 1.0" => "end = { value = 1 }"
        "paper.toml:20:7: time.end: found a table, expected a number > 0 (end of the time interval in s)";
    boolean_for_field: "heat_source = 1.0" => "heat_source = true"
        "paper.toml:41:15: load.heat_source: found true, expected a number, an expression in x, y, z, t or a table in time (heat source q₀ in W/m³)";
    date_for_number: "end = 1.0" => "end = 2025-01-01"
        "paper.toml:20:7: time.end: found the date 2025-01-01, expected a number > 0 (end of the time interval in s)";
    number_for_table: "[output]\nevery = 16" => "output = 16\n[load2]"
        "paper.toml:69:1: initial.output: found an unknown key, expected one of displacement, state, temperature, velocity; `output` belongs to the beginning of the file, above all tables"
        "paper.toml:70:2: load2: found an unknown key, expected one of accuracy, boundary, constants, contact, cyclic, exact, expected, initial, load, material, mesh, name, output, phase, probe, region, rigid, scheme, side, solver, stability, thickness, time, units, verify; did you mean `load`?";
    number_for_vector: "traction = [1.4, 0.4]" => "traction = 1.4"
        "paper.toml:49:12: boundary[1].traction: found 1.4, expected an array, each a number, an expression in x, y, z, t or a table in time (traction f₁ = σν in Pa, one entry per component)";
    table_for_boundary: "[[boundary]]                         # Γ_D: (2.5), (2.7)\non = \"top\"\ndisplacement = [0, 0]\ntemperature = 0\n[[boundary]]                         # Γ_N¹: (2.6), (2.7)\non = \"left\"\ntraction = [1.4, 0.4]\ntemperature = 0\n[[boundary]]                         # Γ_N²: (2.6), (2.7)\non = \"right\"" => "[boundary]\non = \"right\""
        "paper.toml:43:1: boundary: found a table, expected an array, each a table (conditions on the sides, one entry per side); write [[boundary]]";
    fractional_cells: "n = 64" => "n = 6.5"
        "paper.toml:16:5: mesh.n: found 6.5, expected an integer ≥ 1 or two of them, [nx, ny] (cells per side)";
    float_cells: "n = 64" => "n = 64.0"
        "paper.toml:16:5: mesh.n: found 64.0, expected an integer ≥ 1 or two of them, [nx, ny] (cells per side); write 64";
    integer_too_long: "stiffness = 1e4" => "stiffness = 10000000000000000000000"
        "paper.toml:60:44: contact.normal.stiffness: found 10000000000000000000000, expected a number ≥ 0 (stiffness c_ν of the contact in Pa/m); an integer has at most 19 digits; write a larger number as 1e20";
    three_sizes: "size = [1.0, 1.0]" => "size = [1.0, 1.0, 1.0]"
        "paper.toml:15:8: mesh.size: found an array of 3, expected an array of 2, each a number > 0 (lengths of the sides in m)";
    words_in_size: "size = [1.0, 1.0]" => "size = [\"a\", 1.0]"
        "paper.toml:15:9: mesh.size[0]: found \"a\", expected a number > 0 (lengths of the sides in m)";
    three_numbers_of_cells: "n = 64" => "n = [4, 4, 4]"
        "paper.toml:16:5: mesh.n: found an array of 3, expected an array of 2, each an integer ≥ 1 (cells per side)";
}

// Ranges.
spoiled! {
    negative_size: "size = [1.0, 1.0]" => "size = [1.0, -1.0]"
        "paper.toml:15:14: mesh.size[1]: found -1.0, expected a number > 0 (lengths of the sides in m)";
    negative_density: "density = 1.0 " => "density = -1.0 "
        "paper.toml:24:11: material.density: found -1.0, expected a number ≥ 0 (density ρ in kg/m³; 0: quasistatic)";
    nan: "heat_capacity = 1.0 " => "heat_capacity = nan "
        "paper.toml:25:17: material.heat_capacity: found nan, expected a number ≥ 0 (heat capacity per volume, the factor of θ̇ in (2.4), in J/(m³ K); 0: steady heat)";
    inf: "stiffness = 1e4" => "stiffness = inf"
        "paper.toml:60:44: contact.normal.stiffness: found inf, expected a number ≥ 0 (stiffness c_ν of the contact in Pa/m)";
    overflow: "stiffness = 1e4" => "stiffness = 1e400"
        "paper.toml:60:44: contact.normal.stiffness: found 1e400, expected a number ≥ 0 (stiffness c_ν of the contact in Pa/m)";
    nan_in_a_field: "gap = 0.0 " => "gap = nan "
        "paper.toml:58:7: contact.gap: found nan, expected a number (gap g to the foundation along the outward normal, in m)";
    zero_steps: "steps = 64" => "steps = 0"
        "paper.toml:21:9: time.steps: found 0, expected an integer ≥ 1 and ≤ 1000000000 (number of equal time steps, or \"auto\" for steps that follow from `accuracy`)";
    negative_steps: "steps = 64" => "steps = -3"
        "paper.toml:21:9: time.steps: found -3, expected an integer ≥ 1 and ≤ 1000000000 (number of equal time steps, or \"auto\" for steps that follow from `accuracy`)";
    too_many_steps: "steps = 64" => "steps = 10_000_000_000"
        "paper.toml:21:9: time.steps: found 10000000000, expected an integer ≥ 1 and ≤ 1000000000 (number of equal time steps, or \"auto\" for steps that follow from `accuracy`)";
    zero_end: "end = 1.0" => "end = 0"
        "paper.toml:20:7: time.end: found 0, expected a number > 0 (end of the time interval in s)";
    zero_cells: "n = 64" => "n = 0"
        "paper.toml:16:5: mesh.n: found 0, expected an integer ≥ 1 (cells per side)";
    zero_cells_in_one_direction: "n = 64" => "n = [4, 0]"
        "paper.toml:16:9: mesh.n[1]: found 0, expected an integer ≥ 1 (cells per side)";
    zero_width: "width = 1e-5" => "width = 0"
        "paper.toml:62:51: contact.heat.width: found 0, expected a number > 0 (penetration in m at which the conductance is reached)";
    negative_friction: "coefficient = 0.2" => "coefficient = -0.2"
        "paper.toml:61:45: contact.friction.coefficient: found -0.2, expected a number ≥ 0 (friction coefficient μ)";
    negative_stiffness: "stiffness = 1e4" => "stiffness = -1e4"
        "paper.toml:60:44: contact.normal.stiffness: found -1e4, expected a number ≥ 0 (stiffness c_ν of the contact in Pa/m)";
    negative_conductance: "conductance = 1.0" => "conductance = -1.0"
        "paper.toml:62:38: contact.heat.conductance: found -1.0, expected a number ≥ 0 (conductance of closed contact in W/(m² K))";
    zero_young: "young = 2.0" => "young = 0"
        "paper.toml:31:9: material.elasticity.young: found 0, expected a number > 0 (Young's modulus E in Pa)";
    poisson_one: "poisson = 0.1" => "poisson = 1"
        "paper.toml:32:11: material.elasticity.poisson: found 1, expected a number > -1 and < 1 (Poisson's ratio ν)";
    poisson_below: "poisson = 0.1" => "poisson = -1.5"
        "paper.toml:32:11: material.elasticity.poisson: found -1.5, expected a number > -1 and < 1 (Poisson's ratio ν)";
    poisson_half_in_plane_strain: "poisson = 0.1\nstress_state = \"plane-stress\"" => "poisson = 0.5\nstress_state = \"plane-strain\""
        "paper.toml:32:11: material.elasticity.poisson: found 0.5, expected a number > -1 and < 0.5 in plane strain (Poisson's ratio ν); use 0.49 for a nearly incompressible material; incompressible materials are not supported";
    viscosity_not_monotone: "first = 10.0" => "first = -10.0"
        "paper.toml:34:1: material.viscosity: found first = -10.0 and second = 10.0, so 2·first + second = -10.0, expected second > 0 and 2·first + second > 0, as (H1) asks; set both to 0, or leave out `viscosity`, for no viscosity";
    negative_viscosity: "second = 10.0" => "second = -10.0"
        "paper.toml:37:10: material.viscosity.second: found -10.0, expected a number ≥ 0 (factor of τ in Pa s)";
    tiny_steps: "end = 1.0" => "end = 1e-310"
        "paper.toml:20:7: time.end: found steps of 1.5625e-312 s, expected a step length that is a normal number";
}

// Laws and words.
spoiled! {
    unknown_law: "law = \"isotropic\"" => "law = \"neo-hooke\""
        "paper.toml:30:7: material.elasticity.law: found \"neo-hooke\", expected \"isotropic\", \"orthotropic\", \"anisotropic\", \"von-mises-projection\" or \"hencky\"";
    misspelled_law: "law = \"coulomb\"" => "law = \"coulom\""
        "paper.toml:61:20: contact.friction.law: found \"coulom\", expected \"none\", \"coulomb\", \"stick\", \"tresca\", \"static-kinetic\", \"slip-rate\", \"temperature\", \"pressure\", \"expression\" or \"orthotropic\"; did you mean \"coulomb\"?";
    law_with_capitals: "law = \"compliance\"" => "law = \"Compliance\""
        "paper.toml:60:18: contact.normal.law: found \"Compliance\", expected \"compliance\", \"power\", \"table\", \"expression\", \"stop\", \"signorini\", \"bilateral\", \"damped\", \"hunt-crossley\", \"softening\" or \"adhesion\"; did you mean \"compliance\"?";
    law_that_is_a_number: "law = \"ramp\"" => "law = 3"
        "paper.toml:62:16: contact.heat.law: found 3, expected \"none\", \"constant\", \"ramp\", \"power\", \"pressure\", \"gap\", \"expression\", \"radiation\" or \"sum\"";
    unknown_mesh_kind: "kind = \"rectangle\"" => "kind = \"rectangl\""
        "paper.toml:14:8: mesh.kind: found \"rectangl\", expected \"rectangle\", \"interval\", \"box\", \"disc\", \"ring\", \"cylinder\" or \"blocks\", or the key `file`; did you mean \"rectangle\"?";
    misspelled_word: "stress_state = \"plane-stress\"" => "stress_state = \"plane stress\""
        "paper.toml:33:16: material.elasticity.stress_state: found \"plane stress\", expected \"plane-stress\" or \"plane-strain\" (plane stress or plane strain, of a plane body; the elements of an `.inp` file may say it); did you mean \"plane-stress\"?";
    unknown_word: "quadrature = \"nodal\"" => "quadrature = \"simpson\""
        "paper.toml:59:14: contact.quadrature: found \"simpson\", expected \"nodal\" or \"gauss\" (where the integrals over Γ_C are evaluated)";
    unknown_diagonal: "diagonal = \"right\"" => "diagonal = \"/\""
        "paper.toml:17:12: mesh.diagonal: found \"/\", expected \"right\", \"left\" or \"crossed\" (how the squares are cut into triangles)";
}

// Tensors.
spoiled! {
    asymmetric_tensor: "expansion = [[1, 1], [1, 1]]" => "expansion = [[1, 2], [3, 1]]"
        "paper.toml:26:13: material.expansion: found 2.0 in row 1, column 2 but 3.0 in row 2, column 1, expected a number or a symmetric 2 × 2 matrix";
    tensor_of_three_rows: "coupling = [[1, 1], [1, 1]]" => "coupling = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]"
        "paper.toml:27:12: material.coupling: found a matrix of 3 rows, expected a number or a symmetric 2 × 2 matrix";
    tensor_with_a_short_row: "coupling = [[1, 1], [1, 1]]" => "coupling = [[1, 1], [1]]"
        "paper.toml:27:12: material.coupling: found a row 2 of length 1, expected a number or a symmetric 2 × 2 matrix";
    tensor_as_a_vector: "conductivity = [[1, 0], [0, 1]]" => "conductivity = [1, 1]"
        "paper.toml:28:17: material.conductivity[0]: found 1, expected an array, each a number, an expression in x, y, z, data of a mesh file or a table over the temperature (heat conductivity tensor 𝓚 of (2.2) in W/(m K))"
        "paper.toml:28:20: material.conductivity[1]: found 1, expected an array, each a number, an expression in x, y, z, data of a mesh file or a table over the temperature (heat conductivity tensor 𝓚 of (2.2) in W/(m K))";
    tensor_as_a_string: "conductivity = [[1, 0], [0, 1]]" => "conductivity = \"identity\""
        "paper.toml:28:17: material.conductivity: found `identity`, expected a variable (x, y, z, t), a constant (pi, e) or a function";
    indefinite_conductivity: "conductivity = [[1, 0], [0, 1]]" => "conductivity = [[1, 0], [0, -1]]"
        "paper.toml:28:16: material.conductivity: found the eigenvalue -1.0, expected no negative eigenvalue: heat flows from warm to cold";
}

// Sides.
spoiled! {
    unknown_side: "on = \"left\"" => "on = \"lefft\""
        "paper.toml:48:6: boundary[1].on: found \"lefft\", expected one of the facet sets bottom, left, right, top; did you mean \"left\"?";
    unknown_side_far: "on = \"left\"" => "on = \"outer wall\""
        "paper.toml:48:6: boundary[1].on: found \"outer wall\", expected one of the facet sets bottom, left, right, top";
    unknown_contact_side: "on = \"bottom\"" => "on = \"botom\""
        "paper.toml:57:6: contact.on: found \"botom\", expected one of the facet sets bottom, left, right, top; did you mean \"bottom\"?";
    overlapping_sides: "on = \"right\"" => "on = \"left\""
        "paper.toml:52:6: boundary[2].on: found \"left\" again, expected each side in one [[boundary]] entry; merge it with entry 2 of the file, which is on the same side";
    three_components: "traction = [1.4, 0.4]" => "traction = [1.4, 0.4, 0]"
        "paper.toml:49:12: boundary[1].traction: found 3 components, expected 2 components";
    three_components_body: "body_force = [0.0, -1.0]" => "body_force = [0.0, -1.0, 0]"
        "paper.toml:40:14: load.body_force: found 3 components, expected 2 components";
    traction_on_gamma_d: "displacement = [0, 0]\ntemperature = 0\n[[boundary]]                         # Γ_N¹" => "displacement = [0, 0]\ntraction = [0, 0]\ntemperature = 0\n[[boundary]]                         # Γ_N¹"
        "paper.toml:46:12: boundary[0].traction: found a traction besides a displacement, expected one of the two: Γ_D and Γ_N do not overlap; remove one of them";
    inflow_and_temperature: "traction = [1.4, 0.4]" => "traction = [1.4, 0.4]\nheat_inflow = 1"
        "paper.toml:50:15: boundary[1].heat_inflow: found a heat inflow besides a temperature, expected one of the two; remove one of them";
    contact_on_gamma_d: "on = \"bottom\"" => "on = \"top\""
        "paper.toml:45:16: boundary[0].displacement: found a displacement on \"top\", expected Γ_D apart from Γ_C; [contact] is on the same side; a side that bears contact takes loads, springs and heat flows only"
        "paper.toml:46:15: boundary[0].temperature: found a temperature on \"top\", expected heat exchange or a temperature, not both; remove contact.heat or the temperature";
    temperature_on_contact: "on = \"bottom\"" => "on = \"right\""
        "paper.toml:54:15: boundary[2].temperature: found a temperature on \"right\", expected heat exchange or a temperature, not both; remove contact.heat or the temperature";
    steady_heat_without_temperature: "" => "" set "boundary=[]" set "material.heat_capacity=0" set "contact.heat={law='none'}"
        "--set boundary=[]: boundary: found no temperature prescribed and heat_capacity 0, expected a side whose temperature is known; give `temperature` on a side, or a positive material.heat_capacity";
    side_without_condition: "traction = [1.4, 0.4]\ntemperature = 0" => ""
        "paper.toml:47:1: boundary[1]: found a side without a condition, expected `displacement`, `traction`, `temperature`, `heat_inflow` or another condition; add a condition or remove the entry: a side without one is free of load and insulated";
}

// Names.
spoiled! {
    empty_name: "name = \"paper\"" => "name = \"\""
        "paper.toml:10:8: name: found an empty name, expected a name that a folder can have: letters, digits, `-`, `_`; choose another name: results go to results/<name>";
    name_with_a_separator: "name = \"paper\"" => "name = \"../paper\""
        "paper.toml:10:8: name: found `/` in \"../paper\", expected a name that a folder can have: letters, digits, `-`, `_`; choose another name: results go to results/<name>";
    name_with_a_leading_dot: "name = \"paper\"" => "name = \".paper\""
        "paper.toml:10:8: name: found a dot before \".paper\", expected a name that a folder can have: letters, digits, `-`, `_`; choose another name: results go to results/<name>";
    name_with_a_control_character: "name = \"paper\"" => "name = \"pa\\nper\""
        "paper.toml:10:8: name: found `\\n` in \"pa\\nper\", expected a name that a folder can have: letters, digits, `-`, `_`; choose another name: results go to results/<name>";
}

// Expressions.
spoiled! {
    expression_with_unknown_name: "heat_source = 1.0" => "heat_source = \"1 + sine(x)\""
        "paper.toml:41:20: load.heat_source: found `sine`, expected a variable (x, y, z, t), a constant (pi, e) or a function; did you mean sin?";
    expression_cut_off: "gap = 0.0 " => "gap = \"x + \" "
        "paper.toml:58:12: contact.gap: found the end of the expression, expected a number, a variable, a function or `(`";
    expression_in_a_vector: "traction = [1.4, 0.4]" => "traction = [\"1.4*θ\", 0.4]"
        "paper.toml:49:18: boundary[1].traction[0]: found `θ`, expected a variable (x, y, z, t), a constant (pi, e) or a function";
    expression_with_escape: "gap = 0.0 " => "gap = \"\\u0078 + @\" "
        "paper.toml:58:7: contact.gap: found `@`, expected an operator, a number, a name or a parenthesis";
    expression_in_literal_string: "gap = 0.0 " => "gap = '2x' "
        "paper.toml:58:9: contact.gap: found `x`, expected an operator or the end of the expression; write 2*x";
    expression_with_z: "heat_source = 1.0" => "heat_source = \"x*z\""
        "paper.toml:41:15: load.heat_source: found `z` in an expression, expected an expression in x, y, t: the body is plane";
    expression_infinite: "heat_source = 1.0" => "heat_source = \"1/x\""
        "paper.toml:41:15: load.heat_source: found the value inf at x = 0.0, y = 0.0, t = 0.0, expected finite values at all nodes on which it acts, at t = 0 and t = end";
    expression_nan_at_the_end: "foundation_temperature = 0.0" => "foundation_temperature = \"sqrt(0.5 - t)\""
        "paper.toml:62:82: contact.heat.foundation_temperature: found the value NaN at x = 0.0, y = 0.0, t = 1.0, expected finite values at all nodes on which it acts, at t = 0 and t = end";
    initial_with_t: "velocity = [0, 0]\n" => "velocity = [0, \"x*t\"]\n"
        "paper.toml:66:16: initial.velocity[1]: found `t` in an expression, expected an expression in x, y: it holds at t = 0";
    empty_expression: "heat_source = 1.0" => "heat_source = \"\""
        "paper.toml:41:16: load.heat_source: found the end of the expression, expected a number, a variable, a function or `(`";
}

// Overrides.
spoiled! {
    set_no_equals: "" => "" set "mesh.n"
        "--set mesh.n: found no `=`, expected KEY=VALUE, such as mesh.n=32";
    set_empty_key: "" => "" set "=3"
        "--set =3: found an empty key, expected a dotted key, such as mesh.n or boundary[1].traction";
    set_empty_value: "" => "" set "mesh.n="
        "--set mesh.n=: mesh.n: found no value, expected a TOML value behind `=`";
    set_bad_toml: "" => "" set "mesh.size=[1, 2"
        "--set mesh.size=[1, 2: mesh.size: found `[1, 2`, expected a TOML value; unclosed array, expected `]`";
    set_expression: "" => "" set "load.heat_source=sin(x)"
        "--set load.heat_source=sin(x): load.heat_source: found `sin(x)`, expected a TOML value; a string stands in quotes that the shell leaves alone: 'load.heat_source=\"sin(x)\"'";
    set_bad_index: "" => "" set "boundary[3].traction=[0, 0]"
        "--set boundary[3].traction=[0, 0]: boundary[3].traction: found index 3, expected an index from 0 to 2";
    set_key_in_array: "" => "" set "boundary.left.traction=[0, 0]"
        "--set boundary.left.traction=[0, 0]: boundary.left.traction: found the key `left` in an array, expected an index from 0 to 2";
    set_index_in_table: "" => "" set "mesh[0]=1"
        "--set mesh[0]=1: mesh[0]: found an index into mesh, which is a table, expected a key";
    set_through_value: "" => "" set "mesh.n.x=1"
        "--set mesh.n.x=1: mesh.n.x: found a value at mesh.n, expected a table or an array that the key leads through";
    set_unknown_key: "" => "" set "mesh.m=4"
        "--set mesh.m=4: mesh.m: found an unknown key, expected one of axisymmetric, diagonal, elements, kind, n, origin, refine_where, refined_cells, size";
    set_unknown_table: "" => "" set "contcat.gap=4"
        "--set contcat.gap=4: contcat: found an unknown key, expected one of accuracy, boundary, constants, contact, cyclic, exact, expected, initial, load, material, mesh, name, output, phase, probe, region, rigid, scheme, side, solver, stability, thickness, time, units, verify; did you mean `contact`?";
    set_wrong_value: "" => "" set "mesh.n=0"
        "--set mesh.n=0: mesh.n: found 0, expected an integer ≥ 1 (cells per side)";
    set_wrong_in_vector: "" => "" set "boundary.1.traction[0]=\"x+\""
        "--set boundary.1.traction[0]=\"x+\": boundary[1].traction[0]: found the end of the expression, expected a number, a variable, a function or `(`";
    set_bad_law: "" => "" set "contact.friction.law=trescas"
        "--set contact.friction.law=trescas: contact.friction.law: found \"trescas\", expected \"none\", \"coulomb\", \"stick\", \"tresca\", \"static-kinetic\", \"slip-rate\", \"temperature\", \"pressure\", \"expression\" or \"orthotropic\"; did you mean \"tresca\"?";
    set_missing: "initial]" => "initia]" set "initial.temprature=5"
        "paper.toml:64:2: initia: found an unknown key, expected one of accuracy, boundary, constants, contact, cyclic, exact, expected, initial, load, material, mesh, name, output, phase, probe, region, rigid, scheme, side, solver, stability, thickness, time, units, verify; did you mean `initial`?"
        "--set initial.temprature=5: initial.temprature: found an unknown key, expected one of displacement, state, temperature, velocity; did you mean `temperature`?";
    set_bracket: "" => "" set "boundary[0.on=4"
        "--set boundary[0.on=4: found `[` without `]`, expected a dotted key, such as mesh.n or boundary[1].traction";
    set_table_array: "" => "" set "boundary[0]=4"
        "--set boundary[0]=4: boundary[0]: found a value that is no table for a [[table]], expected a table";
    table_that_does_not_start_at_zero: "" => "" set "contact.normal={ law = 'table', penetration = [0.1, 1], pressure = [0, 1] }"
        "--set contact.normal={ law = 'table', penetration = [0.1, 1], pressure = [0, 1] }: contact.normal.penetration: found a pressure of 0.0 at the penetration 0.1 at the beginning, expected the pressure 0 at a penetration of at most 0";
    table_that_falls: "" => "" set "contact.normal={ law = 'table', penetration = [0, 1, 2], pressure = [0, 1, 0.5] }"
        "--set contact.normal={ law = 'table', penetration = [0, 1, 2], pressure = [0, 1, 0.5] }: contact.normal.pressure: found the pressure 0.5 after 1.0, expected pressures that do not fall";
    table_of_one_point: "" => "" set "contact.normal={ law = 'table', penetration = [0], pressure = [0] }"
        "--set contact.normal={ law = 'table', penetration = [0], pressure = [0] }: contact.normal.penetration: found 1 points, expected two at the least";
    residual_above_the_peak: "" => "" set "contact.normal={ law = 'softening', stiffness = 1e4, peak = 1, softening = 1e3, residual = 2 }"
        "--set contact.normal={ law = 'softening', stiffness = 1e4, peak = 1, softening = 1e3, residual = 2 }: contact.normal.residual: found 2.0, expected at most the peak, 1.0";
    accuracy_of_nothing_known: "" => "" set "accuracy={ of = ['elastics'], relative = 0.01 }"
        "--set accuracy={ of = ['elastics'], relative = 0.01 }: accuracy.of[0]: found \"elastics\", expected the name of a probe, or of a column of history.csv with a unit; did you mean \"elastic\"?";
    accuracy_of_nothing: "" => "" set "accuracy={ of = [], relative = 0.01 }"
        "--set accuracy={ of = [], relative = 0.01 }: accuracy.of: found no name, expected the name of a probe, or of a column of history.csv with a unit";
    accuracy_of_a_count: "" => "" set "accuracy={ of = ['stick'], relative = 0.01 }"
        "--set accuracy={ of = ['stick'], relative = 0.01 }: accuracy.of[0]: found \"stick\", expected the name of a probe, or of a column of history.csv with a unit; add a [[probe]] to the case";
    accuracy_of_all: "" => "" set "accuracy={ of = ['elastic'], relative = 1 }"
        "--set accuracy={ of = ['elastic'], relative = 1 }: accuracy.relative: found 1.0, expected a part of the number between 0 and 1, such as 0.01";
    exponent_below_one: "" => "" set "contact.normal={ law = 'power', stiffness = 1e4, exponent = 0.5 }"
        "--set contact.normal={ law = 'power', stiffness = 1e4, exponent = 0.5 }: contact.normal.exponent: found 0.5, expected a number ≥ 1 (exponent m of the penetration; 1.5 for a sphere)";
    static_below_kinetic: "" => "" set "contact.friction={ law = 'static-kinetic', static = 0.1, kinetic = 0.2 }"
        "--set contact.friction={ law = 'static-kinetic', static = 0.1, kinetic = 0.2 }: contact.friction.static: found 0.1, expected at least the kinetic coefficient, 0.2";
    speeds_that_do_not_grow: "" => "" set "contact.friction={ law = 'slip-rate', speed = [0, 0], coefficient = [0.1, 0.2] }"
        "--set contact.friction={ law = 'slip-rate', speed = [0, 0], coefficient = [0.1, 0.2] }: contact.friction.speed: found 0.0 after 0.0, expected larger and larger arguments";
    lists_of_two_lengths: "" => "" set "contact.friction={ law = 'pressure', pressure = [0, 1], coefficient = [0.1] }"
        "--set contact.friction={ law = 'pressure', pressure = [0, 1], coefficient = [0.1] }: contact.friction.coefficient: found 2 arguments and 1 values, expected as many";
    negative_coefficient_in_a_table: "" => "" set "contact.friction={ law = 'temperature', temperature = [0, 1], coefficient = [0.1, -0.1] }"
        "--set contact.friction={ law = 'temperature', temperature = [0, 1], coefficient = [0.1, -0.1] }: contact.friction.coefficient[1]: found -0.1, expected a number ≥ 0 (friction coefficients)";
    direction_of_three: "" => "" set "contact.friction={ law = 'orthotropic', coefficients = [0.1, 0.2], direction = [1, 0, 0] }"
        "--set contact.friction={ law = 'orthotropic', coefficients = [0.1, 0.2], direction = [1, 0, 0] }: contact.friction.direction: found 3 components, expected 2 components";
    direction_zero: "" => "" set "contact.friction={ law = 'orthotropic', coefficients = [0.1, 0.2], direction = [0, 0] }"
        "--set contact.friction={ law = 'orthotropic', coefficients = [0.1, 0.2], direction = [0, 0] }: contact.friction.direction: found zero, expected a direction";
    coefficient_zero: "" => "" set "contact.friction={ law = 'orthotropic', coefficients = [0, 0.2], direction = [1, 0] }"
        "--set contact.friction={ law = 'orthotropic', coefficients = [0, 0.2], direction = [1, 0] }: contact.friction.coefficients[0]: found 0.0, expected a positive number";
    more_than_all_friction_heat: "" => "" set "contact.frictional_heat=1.5"
        "--set contact.frictional_heat=1.5: contact.frictional_heat: found 1.5, expected a number ≥ 0 and ≤ 1 (fraction η of the friction power that enters the body as heat, from 0 to 1)";
    foundation_velocity_of_four: "" => "" set "contact.foundation_velocity=[1, 0, 0, 0]"
        "--set contact.foundation_velocity=[1, 0, 0, 0]: contact.foundation_velocity: found 4 components, expected 2 components, or 3 with motion out of the plane or the line of the body";
    obstacle_without_a_shape: "" => "" set "contact.obstacle={ radius = 1 }"
        "--set contact.obstacle={ radius = 1 }: contact.obstacle.shape: found no such key, expected \"plane\", \"sphere\", \"cylinder\", \"wave\", \"file\" or \"surface\"";
    obstacle_of_another_shape: "" => "" set "contact.obstacle={ shape = 'sphera', center = [0, 0], radius = 1 }"
        "--set contact.obstacle={ shape = 'sphera', center = [0, 0], radius = 1 }: contact.obstacle.shape: found \"sphera\", expected \"plane\", \"sphere\", \"cylinder\", \"wave\", \"file\" or \"surface\"; did you mean \"sphere\"?";
    obstacle_unknown_key: "" => "" set "contact.obstacle={ shape = 'plane', point = [0, 0], normal = [0, 1], radius = 1 }"
        "--set contact.obstacle={ shape = 'plane', point = [0, 0], normal = [0, 1], radius = 1 }: contact.obstacle.radius: found an unknown key, expected one of geometry, load, normal, point, shape, turning; `radius` belongs to [contact.obstacle] with shape = \"sphere\" or [contact.obstacle] with shape = \"cylinder\"";
    obstacle_geometry: "" => "" set "contact.obstacle={ shape = 'sphere', center = [0, 0], radius = 1, geometry = 'update' }"
        "--set contact.obstacle={ shape = 'sphere', center = [0, 0], radius = 1, geometry = 'update' }: contact.obstacle.geometry: found \"update\", expected \"reference\" or \"updated\" (configuration of the body in which distances and normals are evaluated); did you mean \"updated\"?";
    obstacle_radius_zero: "" => "" set "contact.obstacle={ shape = 'sphere', center = [0, 0], radius = 0 }"
        "--set contact.obstacle={ shape = 'sphere', center = [0, 0], radius = 0 }: contact.obstacle.radius: found 0, expected a number > 0 (radius in m)";
    obstacle_wavelength_negative: "" => "" set "contact.obstacle={ shape = 'wave', point = [0, 0], normal = [0, 1], direction = [1, 0], amplitude = 0.1, wavelength = -1 }"
        "--set contact.obstacle={ shape = 'wave', point = [0, 0], normal = [0, 1], direction = [1, 0], amplitude = 0.1, wavelength = -1 }: contact.obstacle.wavelength: found -1, expected a number > 0 (wavelength in m)";
    obstacle_normal_zero: "" => "" set "contact.obstacle={ shape = 'plane', point = [0, 0, 0], normal = [0, 0] }"
        "--set contact.obstacle={ shape = 'plane', point = [0, 0, 0], normal = [0, 0] }: contact.obstacle.point: found 3 components, expected 2 components"
        "--set contact.obstacle={ shape = 'plane', point = [0, 0, 0], normal = [0, 0] }: contact.obstacle.normal: found zero, expected a direction";
    obstacle_normal_of_three: "" => "" set "contact.obstacle={ shape = 'plane', point = [0, 0], normal = [0, 1, 0] }"
        "--set contact.obstacle={ shape = 'plane', point = [0, 0], normal = [0, 1, 0] }: contact.obstacle.normal: found 3 components, expected 2 components";
    obstacle_axis_in_the_plane: "" => "" set "contact.obstacle={ shape = 'cylinder', center = [0, 0], radius = 1, axis = [0, 0, 1] }"
        "--set contact.obstacle={ shape = 'cylinder', center = [0, 0], radius = 1, axis = [0, 0, 1] }: contact.obstacle.axis: found an axis, expected none: in the plane it is z";
    obstacle_wave_along_the_normal: "" => "" set "contact.obstacle={ shape = 'wave', point = [0, 0], normal = [0, 1], direction = [0, 2], amplitude = 0.1, wavelength = 1 }"
        "--set contact.obstacle={ shape = 'wave', point = [0, 0], normal = [0, 1], direction = [0, 2], amplitude = 0.1, wavelength = 1 }: contact.obstacle.direction: found a direction along the normal, expected one across it";
    obstacle_center_in_space: "" => "" set "contact.obstacle={ shape = 'sphere', center = ['t', 'y - 1'], radius = 1 }"
        "--set contact.obstacle={ shape = 'sphere', center = ['t', 'y - 1'], radius = 1 }: contact.obstacle.center[1]: found an expression in space, expected a number or an expression in t: the obstacle moves as a whole";
    obstacle_center_in_a_table_that_ends: "" => "" set "contact.obstacle={ shape = 'sphere', center = [0, { times = [0, 0.5], values = [0, 1] }], radius = 1 }"
        "--set contact.obstacle={ shape = 'sphere', center = [0, { times = [0, 0.5], values = [0, 1] }], radius = 1 }: contact.obstacle.center[1]: found a table that ends at t = 0.5, expected values to the end of the run, t = 1.0; give more rows, or `extend = \"hold\"` to keep the value at the end";
    obstacle_center_without_a_value: "" => "" set "contact.obstacle={ shape = 'sphere', center = [0, 'log(t - 1)'], radius = 1 }"
        "--set contact.obstacle={ shape = 'sphere', center = [0, 'log(t - 1)'], radius = 1 }: contact.obstacle.center[1]: found the value NaN at x = 0.0, y = 0.0, t = 0.0, expected finite values at all nodes on which it acts, at t = 0 and t = end";
    obstacle_level_constant: "" => "" set "contact.obstacle={ shape = 'surface', level = '1 - t' }"
        "--set contact.obstacle={ shape = 'surface', level = '1 - t' }: contact.obstacle.level: found an expression that is the same everywhere, expected one in space, positive outside the obstacle and negative inside";
    obstacle_level_in_z: "" => "" set "contact.obstacle={ shape = 'surface', level = 'y + z' }"
        "--set contact.obstacle={ shape = 'surface', level = 'y + z' }: contact.obstacle.level: found `z` in an expression, expected an expression in x, y, t: the body is plane";
    obstacle_level_without_a_zero: "" => "" set "contact.obstacle={ shape = 'surface', level = 'x^2 + 1' }"
        "--set contact.obstacle={ shape = 'surface', level = 'x^2 + 1' }: contact.obstacle.level: found no point of the zero level that is nearest to x = 0.0, y = 0.0 at t = 0, expected one for each node of the side; a level is positive outside the obstacle, negative inside and continuous";
    obstacle_level_misspelled: "" => "" set "contact.obstacle={ shape = 'surface', level = 'y + sinn(x)' }"
        "--set contact.obstacle={ shape = 'surface', level = 'y + sinn(x)' }: contact.obstacle.level: found `sinn`, expected a variable (x, y, z, t), a constant (pi, e) or a function; did you mean sin?";
    roughness_zero: "" => "" set "contact.heat={ law = 'sum', laws = [{ law = 'gap', conductivity = 1, roughness = 0 }], foundation_temperature = 0 }"
        "--set contact.heat={ law = 'sum', laws = [{ law = 'gap', conductivity = 1, roughness = 0 }], foundation_temperature = 0 }: contact.heat.laws[0].roughness: found 0, expected a number > 0 (effective width in m of a closed gap)";
    gauss_points_on_a_rigid_foundation: "quadrature = \"nodal\"" => "quadrature = \"gauss\"" set "contact.normal={ law = 'signorini' }"
        "paper.toml:59:14: contact.quadrature: found Gauss points on a rigid foundation, expected nodal quadrature; more points than nodes have no unique pressures";
    set_law_of_missing: "" => "" set "contact.friction={ law = \"none\", coefficient = 1 }"
        "--set contact.friction={ law = \"none\", coefficient = 1 }: contact.friction.coefficient: found an unknown key, expected `law` alone; `coefficient` belongs to [contact.friction] with law = \"coulomb\" or [contact.friction] with law = \"slip-rate\" or [contact.friction] with law = \"temperature\" or [contact.friction] with law = \"pressure\" or [contact.friction] with law = \"expression\"";
}

// Several at once, and what no replaced line shows.

#[test]
fn the_huge_mesh_is_refused_before_it_is_built() {
    for (n, found) in [
        ("1_000_000_000", "1000000000 × 1000000000 cells: 3.000e18 unknowns"),
        ("[70_000, 70_000]", "70000 × 70000 cells: 14700420003 unknowns"),
    ] {
        let message = message(spoil(PAPER, "n = 64", &format!("n = {n}")), &[]);
        assert!(message.starts_with(&format!("paper.toml:16:5: mesh.n: found {found}")), "{message}");
        assert!(message.ends_with("; take fewer cells") && message.lines().count() == 1, "{message}");
    }
}

#[test]
fn faults_of_all_gates_are_reported_together() {
    let mut text = spoil(PAPER, "heat_capacity = 1.0 ", "heat_capaciti = 1.0 ");
    for (old, new) in [
        ("density = 1.0 ", "density = -1.0 "),
        ("expansion = [[1, 1], [1, 1]]", "expansion = [[1, 2], [3, 1]]"),
        ("heat_source = 1.0", "heat_source = \"1 +\""),
        ("on = \"left\"", "on = \"lefft\""),
    ] {
        text = spoil(&text, old, new);
    }
    let expected = [
        "paper.toml:24:11: material.density: found -1.0, expected a number ≥ 0 (density ρ in kg/m³; 0: quasistatic)",
        "paper.toml:25:1: material.heat_capaciti: found an unknown key, expected one of base, conductivity, coupling, density, dilatation, elasticity, expansion, expansion_coefficient, expansion_kind, heat_capacity, prony, stress_state, viscosity; did you mean `heat_capacity`?",
        "paper.toml:26:13: material.expansion: found 2.0 in row 1, column 2 but 3.0 in row 2, column 1, expected a number or a symmetric 2 × 2 matrix",
        "paper.toml:41:19: load.heat_source: found the end of the expression, expected a number, a variable, a function or `(`",
        "paper.toml:48:6: boundary[1].on: found \"lefft\", expected one of the facet sets bottom, left, right, top; did you mean \"left\"?",
        "--set time.steps=0: time.steps: found 0, expected an integer ≥ 1 and ≤ 1000000000 (number of equal time steps, or \"auto\" for steps that follow from `accuracy`)",
        "--set mesh.size: found no `=`, expected KEY=VALUE, such as mesh.n=32",
    ];
    let mut lines: Vec<String> = message(text, &["time.steps=0", "mesh.size"]).lines().map(str::to_owned).collect();
    lines.sort();
    let mut expected = expected.map(str::to_owned).to_vec();
    expected.sort();
    assert_eq!(lines, expected);
}

#[test]
fn a_key_given_twice_does_not_hide_other_faults() {
    let text = spoil(PAPER, "end = 1.0", "end = 1.0\nend = 2.0\nstepz = 3");
    let expected = [
        "paper.toml:21:1: found `end` again, expected each key once in its table",
        "paper.toml:22:1: time.stepz: found an unknown key, expected one of accuracy, analysis, end, friction, inertia, mass, pressure, restitution, scheme, steps, theta; did you mean `steps`?",
    ];
    assert_eq!(message(text, &[]), expected.join("\n"));
}

/// Overrides that move text do not move the places of faults in the file.
#[test]
fn places_are_those_of_the_file_as_it_is() {
    let text = spoil(PAPER, "stiffness = 1e4", "stiffness = -1e4");
    let before = message(text.clone(), &[]);
    let long = "load.body_force=[\"sin(x)*cos(y)\", \"1 + 2 + 3 + 4 + 5 + 6\"]";
    assert_eq!(message(text, &["mesh.n=12345678", "mesh.n=8", long, "output.every=1"]), before);
}

#[test]
fn spans_cover_what_is_faulty() {
    let text = spoil(PAPER, "heat_source = 1.0", "heat_source = \"1 + θ*x\"");
    let result = case::parse(&Source::new("paper.toml", text), &[]);
    let Err(CaseError::Faults { file, faults, .. }) = result else { panic!("no faults") };
    let [fault] = faults.as_slice() else { panic!("{faults:?}") };
    let FaultPlace::File { start, end, .. } = fault.place else { panic!("{fault:?}") };
    assert_eq!(&file.text[start..end], "θ");
}

/// Brackets cost a level of recursion each in a parser.
#[test]
fn deep_nesting_is_refused() {
    for deep in ["[".repeat(100_000), "{a=".repeat(100_000), "(".repeat(9_000)] {
        let text = spoil(PAPER, "heat_source = 1.0", &format!("heat_source = {deep}"));
        assert_ne!(message(text, &["mesh.n=2"]), "no fault");
        assert_ne!(message(PAPER.to_owned(), &["mesh.n=2", &format!("load.heat_source={deep}")]), "no fault");
        assert_ne!(message(PAPER.to_owned(), &["mesh.n=2", &format!("load.heat_source=\"{deep}\"")]), "no fault");
    }
    assert_ne!(message(PAPER.to_owned(), &[&format!("{}=1", "a.".repeat(20_000) + "a")]), "no fault");
    for overrides in [[].as_slice(), &["mesh.n=2"]] {
        assert_ne!(message(format!("[{}a]", "a.".repeat(1_000_000)), overrides), "no fault");
    }
}

const KEYS: [&str; 14] = [
    "name",
    "mesh",
    "mesh.kind",
    "mesh.size[0]",
    "time.end",
    "time.steps",
    "boundary",
    "boundary[0]",
    "boundary.1.traction[0]",
    "material.expansion",
    "material.conductivity[0][0]",
    "contact.gap",
    "contact.heat",
    "initial.temperature",
];

/// A small mesh, so that a text that stays valid is cheap.
fn small() -> Vec<u8> {
    spoil(PAPER, "n = 64", "n = 2").into_bytes()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    /// Whatever the text and the overrides, there is a case or there are faults in the text.
    #[test]
    fn no_text_makes_it_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(b"\"'[]{}=.,#\n\\-0z\xce\0 +".to_vec()), 0u8..9), 1..6),
        key in prop_oneof![
            "[a-z.\\[\\]0-9\"]{0,12}",
            prop::sample::select(KEYS.to_vec()).prop_map(str::to_owned),
        ],
        value in prop_oneof!["[a-z0-9\\[\\]{}\"=.,-]{0,8}", "-?[0-9]{1,4}(e-?[0-9]{1,3})?", "\"[xyzt0-9+*/()^.-]{1,6}\""],
    ) {
        let mut bytes = small();
        for (index, byte, how) in changes {
            let at = index.index(bytes.len());
            match how {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                2..6 if bytes.len() > 1 => drop(bytes.remove(at)),
                6 => bytes.truncate(at.max(1)),
                _ => {}
            }
        }
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let source = Source::new("case.toml", text);
        for overrides in [vec![], vec![format!("{key}={value}")]] {
            if let Err(error) = case::parse(&source, &overrides) {
                let CaseError::Faults { file, faults, .. } = &error else { panic!("{error}") };
                prop_assert!(!faults.is_empty());
                for fault in faults {
                    if let FaultPlace::File { start, end, .. } = fault.place {
                        prop_assert!(file.text.get(start..end).is_some(), "{fault}");
                    }
                }
            }
        }
    }
}

// Several contacts, and foundations with a heat capacity.
spoiled! {
    contact_twice_on_a_side: "[contact]  " => "[[contact]]\non = \"bottom\"\nnormal = { law = \"signorini\" }\n[[contact]]  "
        "paper.toml:60:6: contact[1].on: found \"bottom\" again, expected one [[contact]] entry without `obstacle` per side; merge it with entry 1 of the file, which is on the same side, or give one of them an `obstacle`";
    contact_unknown_key_in_the_second: "[contact]  " => "[[contact]]\non = \"left\"\nnormal = { law = \"signorini\" }\n[[contact]]\nfrction = 1 #"
        "paper.toml:60:1: contact[1].frction: found an unknown key, expected one of automatic, close, fluid, foundation, foundation_velocity, friction, frictional_heat, gap, geometry, heat, name, nonmortar, normal, obstacle, on, phases, preload, quadrature, wear, with; did you mean `friction`?";
    contact_law_in_the_second: "[contact]  " => "[[contact]]\non = \"left\"\nnormal = { law = \"signorini\" }\n[[contact]]\nwear = { law = \"archard\", coefficient = -1 } #"
        "paper.toml:60:41: contact[1].wear.coefficient: found -1, expected a number ≥ 0 (wear coefficient in 1/Pa: Archard's dimensionless number divided by the hardness)";
    foundation_surroundings_in_space: "" => "" set "contact.foundation={ heat_capacity = 1, surroundings = 'x + t' }"
        "--set contact.foundation={ heat_capacity = 1, surroundings = 'x + t' }: contact.foundation.surroundings: found an expression in space, expected a number or an expression in t; remove x, y, z: a foundation with a heat capacity has one temperature";
    foundation_temperature_in_space: "" => "" set "contact.foundation={ heat_capacity = 1 }" set "contact.heat.foundation_temperature='x'"
        "--set contact.heat.foundation_temperature='x': contact.heat.foundation_temperature: found an expression in space, expected a number or an expression in t; remove x, y, z: a foundation with a heat capacity has one temperature";
    foundation_temperature_wrong: "" => "" set "contact.foundation={ heat_capacity = 1 }" set "contact.heat.foundation_temperature='x +'"
        "--set contact.heat.foundation_temperature='x +': contact.heat.foundation_temperature: found the end of the expression, expected a number, a variable, a function or `(`";
    foundation_without_capacity: "" => "" set "contact.foundation={ heat_capacity = 0, exchange = -1 }"
        "--set contact.foundation={ heat_capacity = 0, exchange = -1 }: contact.foundation.exchange: found -1, expected a number ≥ 0 (heat transfer to the surroundings in W/K, per unit of thickness in two dimensions)"
        "--set contact.foundation={ heat_capacity = 0, exchange = -1 }: contact.foundation.heat_capacity: found 0, expected a number > 0 (heat capacity of the foundation in J/K, per unit of thickness in two dimensions)";
    wear_table_falls: "" => "" set "contact.wear={ law = 'archard-temperature', temperature = [1, 0], coefficient = [1, 1] }"
        "--set contact.wear={ law = 'archard-temperature', temperature = [1, 0], coefficient = [1, 1] }: contact.wear.temperature: found 0.0 after 1.0, expected larger and larger arguments";
    wear_table_lengths: "" => "" set "contact.wear={ law = 'archard-temperature', temperature = [0, 1], coefficient = [1] }"
        "--set contact.wear={ law = 'archard-temperature', temperature = [0, 1], coefficient = [1] }: contact.wear.coefficient: found 2 arguments and 1 values, expected as many";
}
