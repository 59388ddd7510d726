//! Coefficients in space and time with one thing spoiled each: the message is exact, with key, point and value.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::common::{SMALL, told};
use amontons::case::{self, Files, Source};

/// A test each: `name: "KEY=VALUE" "message";`
macro_rules! spoiled {
    ($($name:ident: $set:literal $line:literal;)*) => {
        $(#[test]
        fn $name() {
            assert_eq!(told(&Source::new("graded.toml", SMALL), &[$set]), $line);
        })*
    };
}

spoiled! {
    a_wrong_variable: "material.elasticity.young=\"10 + r\""
        "--set material.elasticity.young=\"10 + r\": material.elasticity.young: found `r`, expected a variable (x, y, z, t), a constant (pi, e) or a function";
    a_coordinate_that_the_body_lacks: "material.density=\"1 + z\""
        "--set material.density=\"1 + z\": material.density: found `z` in an expression, expected an expression in x, y, t: the body is plane";
    time_in_a_material: "material.density=\"1 + t\""
        "--set material.density=\"1 + t\": material.density: found `t` in an expression, or a table in time, expected an expression in x, y: it is the same at all times";
    a_table_in_time_in_a_material: "material.heat_capacity={ times = [0, 1], values = [1, 2] }"
        "--set material.heat_capacity={ times = [0, 1], values = [1, 2] }: material.heat_capacity: found `t` in an expression, or a table in time, expected an expression in x, y: it is the same at all times";
    a_stiffness_that_is_negative_at_one_time: "contact.normal.stiffness=\"100*(0.6 - t)\""
        "--set contact.normal.stiffness=\"100*(0.6 - t)\": contact.normal.stiffness: found the value -15.000000000000002 at x = 0.0, y = 0.0, t = 0.75, expected a number ≥ 0 (stiffness c_ν of the contact in Pa/m)";
    negative_at_one_point: "material.elasticity.young=\"0.5 - 12*x*(1 - x)*y*(1 - y)\""
        "--set material.elasticity.young=\"0.5 - 12*x*(1 - x)*y*(1 - y)\": material.elasticity.young: found the value -0.25 at x = 0.5, y = 0.5, expected a number > 0 (Young's modulus E in Pa)";
    zero_at_one_point: "material.elasticity.young=\"(x - 0.5)^2 + (y - 0.5)^2\""
        "--set material.elasticity.young=\"(x - 0.5)^2 + (y - 0.5)^2\": material.elasticity.young: found the value 0.0 at x = 0.5, y = 0.5, expected a number > 0 (Young's modulus E in Pa)";
    not_finite_at_one_point_of_an_integral: "material.conductivity=\"if((x - 1/3)^2 + (y - 1/6)^2 < 1e-12, log(-1), 1)\""
        "--set material.conductivity=\"if((x - 1/3)^2 + (y - 1/6)^2 < 1e-12, log(-1), 1)\": material.conductivity: found the value NaN at x = 0.3333333333333333, y = 0.16666666666666666, expected a finite number (heat conductivity tensor 𝓚 of (2.2) in W/(m K))";
    not_finite_at_a_node: "material.density=\"1/x\""
        "--set material.density=\"1/x\": material.density: found the value inf at x = 0.0, y = 0.0, expected a number ≥ 0 (density ρ in kg/m³; 0: quasistatic)";
    a_ratio_beyond_its_limit: "material.elasticity.poisson=\"0.3 + 0.8*x\""
        "--set material.elasticity.poisson=\"0.3 + 0.8*x\": material.elasticity.poisson: found the value 1.1 at x = 1.0, y = 0.0, expected a number > -1 and < 1 (Poisson's ratio ν)";
    a_ratio_that_plane_strain_refuses: "material.elasticity.poisson=\"0.3 + 0.2*x\""
        "--set material.elasticity.poisson=\"0.3 + 0.2*x\": material.elasticity.poisson: found 0.5 at x = 1.0, y = 0.0, expected a number > -1 and < 0.5 in plane strain (Poisson's ratio ν); use 0.49 for a nearly incompressible material; incompressible materials are not supported";
    a_viscosity_that_breaks_h1: "material.viscosity.first=\"0.1 - x\""
        "graded.toml:18:13: material.viscosity: found first = -0.4 and second = 0.2, so 2·first + second = -0.6000000000000001 at x = 0.5, y = 0.0, expected second > 0 and 2·first + second > 0, as (H1) asks; set both to 0, or leave out `viscosity`, for no viscosity";
    heat_from_cold_to_warm: "material.conductivity=[[\"1\", \"x\"], [\"x\", \"0.5\"]]"
        "--set material.conductivity=[[\"1\", \"x\"], [\"x\", \"0.5\"]]: material.conductivity: found the eigenvalue -0.2807764064044151 at x = 1.0, y = 0.0, expected no negative eigenvalue: heat flows from warm to cold";
    a_tensor_that_is_not_symmetric: "material.conductivity=[[1, \"x/2\"], [\"y/2\", 1]]"
        "--set material.conductivity=[[1, \"x/2\"], [\"y/2\", 1]]: material.conductivity: found 0.25 in row 1, column 2 but 0.0 in row 2, column 1 at x = 0.5, y = 0.0, expected a number or a symmetric 2 × 2 matrix";
    a_stiffness_that_is_not_definite: "material.elasticity={ law = 'orthotropic', young = [1, 1, 1], poisson = ['1.2*x', 0, 0], shear = [1, 1, 1], stress_state = 'plane-stress' }"
        "--set material.elasticity={ law = 'orthotropic', young = [1, 1, 1], poisson = ['1.2*x', 0, 0], shear = [1, 1, 1], stress_state = 'plane-stress' }: material.elasticity: found a compliance −ν_ij (E_j/E_i)^½ of the normal strains, with ones on its diagonal, with eigenvalues from -2.000e-1 to 2.200e0 at x = 1.0, y = 0.0, expected all of them positive";
    negative_friction_at_one_node: "contact.friction.coefficient=\"0.3 - x\""
        "--set contact.friction.coefficient=\"0.3 - x\": contact.friction.coefficient: found the value -0.2 at x = 0.5, y = 0.0, expected a number ≥ 0 (friction coefficient μ)";
    negative_friction_at_one_time: "contact.friction.coefficient=\"0.3 - 0.5*t\""
        "--set contact.friction.coefficient=\"0.3 - 0.5*t\": contact.friction.coefficient: found the value -0.07500000000000001 at x = 0.0, y = 0.0, t = 0.75, expected a number ≥ 0 (friction coefficient μ)";
    a_table_that_ends_before_the_run: "contact.friction.coefficient={ times = [0, 0.5], values = [0.1, 0.2] }"
        "--set contact.friction.coefficient={ times = [0, 0.5], values = [0.1, 0.2] }: contact.friction.coefficient: found a table from t = 0.0 to t = 0.5, expected values from t = 0 to the end of the run, t = 1.0; give more rows, or `extend = \"hold\"` to keep the value at the end";
    a_width_of_zero: "contact.heat.width=\"1e-3*x\""
        "--set contact.heat.width=\"1e-3*x\": contact.heat.width: found the value 0.0 at x = 0.0, y = 0.0, expected a number > 0 (penetration in m at which the conductance is reached)";
    kinetic_above_static: "contact.friction={ law = 'static-kinetic', static = 0.3, kinetic = '0.2 + 0.2*x' }"
        "--set contact.friction={ law = 'static-kinetic', static = 0.3, kinetic = '0.2 + 0.2*x' }: contact.friction.static: found 0.3 at x = 0.5, y = 0.0, expected at least the kinetic coefficient, 0.30000000000000004";
    residual_above_the_peak: "contact.normal={ law = 'softening', stiffness = 10, peak = 1, softening = 1, residual = '2*x' }"
        "--set contact.normal={ law = 'softening', stiffness = 10, peak = 1, softening = 1, residual = '2*x' }: contact.normal.residual: found 2.0 at x = 1.0, y = 0.0, expected at most the peak, 1.0";
    branches_of_a_ratio_that_is_negative: "material.prony=[{ ratio = 'x - 0.2', time = 1 }]"
        "--set material.prony=[{ ratio = 'x - 0.2', time = 1 }]: material.prony[0].ratio: found the value -0.2 at x = 0.0, y = 0.0, expected a number > 0 (modulus of the branch divided by that of 𝓔, the long-term modulus)";
    a_relaxation_time_that_is_negative_at_a_side: "material.prony=[{ ratio = 1, time = 'x - 0.2' }]"
        "--set material.prony=[{ ratio = 1, time = 'x - 0.2' }]: material.prony[0].time: found the value -0.2 at x = 0.0, y = 0.0, expected a number > 0 (relaxation time in s)";
    a_syntax_error_inside: "material.elasticity.young=\"10 + *x\""
        "--set material.elasticity.young=\"10 + *x\": material.elasticity.young: found `*`, expected a number, a variable, a function or `(`";
    data_of_a_generated_mesh: "material.density={ data = \"density\" }"
        "--set material.density={ data = \"density\" }: material.density: found data without a file, expected `file`, the mesh file that has the data: the mesh of the case is not from a file";
    data_with_times: "material.density={ data = \"density\", times = [0, 1] }"
        "--set material.density={ data = \"density\", times = [0, 1] }: material.density: found a table without clear data, expected `data`, the name of data of a mesh file, with `file` and `factor` alone";
}

/// What is said of data of a mesh file.
fn of_file(set: &str, file: &str, bytes: &str) -> String {
    let files = BTreeMap::from([(file.to_owned(), Arc::from(bytes.as_bytes()))]);
    let source = Source { files: Files::Memory(files), ..Source::new("graded.toml", SMALL) };
    case::parse(&source, &[set.to_owned()]).map_or_else(|error| error.to_string(), |_| "no fault".to_owned())
}

/// One triangle with three nodes in a square of one, and data of two numbers.
const TRIANGLE: &str = r#"<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="3" NumberOfCells="1">
<Points><DataArray type="Float64" Name="Points" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">3</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">5</DataArray></Cells>
<CellData><DataArray type="Float64" Name="one" format="ascii">1</DataArray>
<DataArray type="Float64" Name="two" format="ascii" NumberOfComponents="2">1 2</DataArray>
<DataArray type="Float64" Name="long" format="ascii">1 2</DataArray></CellData>
<PointData><DataArray type="Float64" Name="nodes" format="ascii">1 2 -3</DataArray></PointData>
</Piece></UnstructuredGrid></VTKFile>"#;

#[test]
fn data_of_files() {
    let set = |data: &str| format!("material.density={{ data = \"{data}\", file = \"part.vtu\" }}");
    let said = |data: &str| of_file(&set(data), "part.vtu", TRIANGLE).replace(&format!("--set {}: ", set(data)), "");
    let expected = [
        (
            "two",
            "material.density.data: found the data \"two\" have 2 components and 2 numbers in part.vtu, expected one number for each of the 1 cells",
        ),
        (
            "long",
            "material.density.data: found the array long has 2 values, not 1 for each of 1 cells in part.vtu, expected a mesh with data",
        ),
        (
            "other",
            "material.density.data: found no data \"other\" in part.vtu, expected data of the cells or the points with this name",
        ),
        (
            "one",
            "material.density: found the value NaN at x = 1.0, y = 0.5, expected a number ≥ 0 (density ρ in kg/m³; 0: quasistatic)",
        ),
        (
            "nodes",
            "material.density: found the value -1.0 at x = 0.0, y = 0.5, expected a number ≥ 0 (density ρ in kg/m³; 0: quasistatic)",
        ),
    ];
    for (data, message) in expected {
        assert_eq!(said(data), message);
    }
    let other = "material.density={ data = \"one\", file = \"part.csv\" }";
    assert_eq!(
        of_file(other, "part.csv", ""),
        format!(
            "--set {other}: material.density.file: found the file part.csv, expected a file .msh (Gmsh) or .vtu (VTK) with data of cells or nodes"
        )
    );
    let missing = "material.density={ data = \"one\", file = \"party.vtu\" }";
    assert_eq!(
        of_file(missing, "part.vtu", TRIANGLE),
        format!(
            "--set {missing}: material.density.file: found \"party.vtu\", which is not there, expected a file beside the case file; did you mean \"part.vtu\"?"
        )
    );
}
