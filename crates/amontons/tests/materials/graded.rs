//! Coefficients that vary in space and time: against regions, numbers, data of mesh files and closures.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::Arc;

use crate::common::{case as shipped, changed, largest, paper};
use amontons::case::{self, Case, Files, Source};
use amontons::contact::{Compliance, Coulomb, FrictionLaw, HeatLaw, NormalLaw, Ramp, Status};
use amontons::contract;
use amontons::field::{Coefficient, Law};
use amontons::hypotheses::{FindingId, certificate, findings};
use amontons::material::{Isotropic, OrthotropicConstants, Prony, StressState, TensorLaw};
use amontons::mesh::{Block, Diagonal, Elements, Mesh};
use amontons::problem::Problem;
use amontons::state::State;
use amontons::step::{March, Scheme};
use amontons::tensor::{Point, Rotation, Sym};

/// The last state of a run.
fn run(problem: &Problem) -> State {
    let mut scheme = March::new(problem).expect("a regular system");
    let mut state = scheme.initial().expect("finite initial data");
    for _ in 0..problem.timeline.steps() {
        state = scheme.step(&state).unwrap_or_else(|error| panic!("{error}")).0;
    }
    state
}

fn assert_same(found: &State, expected: &State, tolerance: f64, what: &str) {
    for (name, a, b) in
        [("u", &found.u, &expected.u), ("w", &found.w, &expected.w), ("θ", &found.theta, &expected.theta)]
    {
        let scale = largest(b).max(f64::MIN_POSITIVE);
        let worst = a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(worst <= tolerance * scale, "{what}: {name} differs by {:e} of itself", worst / scale);
    }
}

const SMALL: [&str; 3] = ["mesh.n=6", "time.steps=6", "time.end=0.5"];

/// The cells left of the middle in a region of their own.
fn halved(mesh: &Mesh) -> Mesh {
    let mut blocks: Vec<Block> = Vec::new();
    for block in &mesh.blocks {
        for (region, is_left) in [(0, true), (1, false)] {
            let left = |cell: &[u32]| cell.iter().all(|&node| mesh.points[node as usize][0] < 0.5 + 1e-12);
            let nodes = block.cells().filter(|cell| left(cell) == is_left).flatten().copied().collect();
            blocks.push(Block { region, nodes, ..block.clone() });
        }
    }
    Mesh { blocks, regions: vec!["left".to_owned(), "right".to_owned()], ..mesh.clone() }
}

/// Two regions with materials of their own, and one material with the same data as functions of x: equal to round-off,
/// with branches that relax too.
#[test]
fn regions_are_what_functions_with_jumps_are() {
    for elements in [Elements::P1, Elements::Q1, Elements::P2] {
        let problem = paper(&SMALL).problem;
        let square = Mesh::rectangle_of(elements, [1.0, 1.0], [6, 6], Diagonal::Right).unwrap();
        let mesh = Arc::new(halved(&square));
        let right = |x: &Point| x[0] > 0.5;
        let of = |right: bool| if right { 1.7 } else { 1.0 };
        let sheet = StressState::PlaneStress;
        let elastic = move |factor: f64| Isotropic::elastic(2, 2.0 * factor, 0.1 * factor, sheet);
        let viscous = move |factor: f64| Isotropic::lame(2, 10.0 * factor, 10.0, sheet);
        let branches =
            |law: &Law<dyn TensorLaw>, factor: f64| Prony::ratios(law, &[(0.5, 0.3 * factor), (1.0, 0.1)]).unwrap();
        let tensor = |factor: f64| Sym([1.0, factor, 0.2, 0.0, 0.0, 0.0]);
        let regions = changed(&problem, |data| {
            data.mesh = Arc::clone(&mesh);
            let mut both = [data.materials[0].clone(), data.materials[0].clone()];
            for (material, factor) in both.iter_mut().zip([of(false), of(true)]) {
                (material.elasticity, material.viscosity) = (elastic(factor).into(), viscous(factor).into());
                material.prony = Some(branches(&material.elasticity, factor));
                (material.density, material.heat_capacity) = (factor.into(), (2.0 * factor).into());
                material.expansion = tensor(factor).into();
                material.coupling = tensor(factor).into();
                material.conductivity = tensor(factor).into();
            }
            data.materials = both.to_vec();
        });
        let whole = changed(&problem, |data| {
            data.mesh = Arc::clone(&mesh);
            let at = move |x: &Point| of(right(x));
            let points = mesh.sites(None);
            let material = &mut data.materials[0];
            material.elasticity = Law::<dyn TensorLaw>::in_space(&points, move |x| Arc::new(elastic(at(x))));
            let pairs = [(0.5.into(), Coefficient::varying(move |x| 0.3 * at(x))), (1.0.into(), 0.1.into())];
            material.prony = Some(
                Prony::varying(&pairs.map(|(ratio, time)| (material.elasticity.clone(), ratio, time)), &points)
                    .unwrap(),
            );
            material.viscosity = Law::<dyn TensorLaw>::in_space(&points, move |x| Arc::new(viscous(at(x))));
            material.density = Coefficient::varying(at);
            material.heat_capacity = Coefficient::varying(move |x| 2.0 * at(x));
            material.expansion = Coefficient::varying(move |x| tensor(at(x)));
            material.coupling = Coefficient::varying(move |x| tensor(at(x)));
            material.conductivity = Coefficient::varying(move |x| tensor(at(x)));
        });
        assert_same(&run(&whole), &run(&regions), 1e-11, &format!("{elements:?}"));
    }
}

/// Laws with their keys and numbers; in tables an `N` marks the numbers.
const LAWS: [(&str, &[(&str, &str)]); 9] = [
    (
        "the paper",
        &[
            ("material.density", "1.0"),
            ("material.heat_capacity", "1.0"),
            ("material.elasticity.young", "2.0"),
            ("material.elasticity.poisson", "0.1"),
            ("material.viscosity.first", "10.0"),
            ("material.viscosity.second", "10.0"),
            ("material.conductivity", "1.0"),
            ("material.expansion", "1.0"),
            ("material.coupling", "1.0"),
            ("contact.normal.stiffness", "1e4"),
            ("contact.friction.coefficient", "0.2"),
            ("contact.heat.conductance", "1.0"),
            ("contact.heat.width", "1e-5"),
            ("contact.frictional_heat", "0.4"),
        ],
    ),
    (
        "orthotropic",
        &[(
            "material.elasticity",
            "{ law = 'orthotropic', young = [3N, 2N, 1N], poisson = [0.2N, 0.1N, 0.1N], shear = [1N, 1N, 1N], orientation = 0.4N, stress_state = 'plane-stress' }",
        )],
    ),
    (
        "von Mises",
        &[(
            "material.elasticity",
            "{ law = 'von-mises-projection', young = 2N, poisson = 0.1N, excess = 1N, radius = 0.01N, stress_state = 'plane-stress' }",
        )],
    ),
    (
        "Hencky",
        &[(
            "material.elasticity",
            "{ law = 'hencky', bulk = 2N, shear = 1N, shear_infinite = 0.5N, strain = 0.1N, exponent = 0.5N, stress_state = 'plane-stress' }",
        )],
    ),
    (
        "Carreau",
        &[(
            "material.viscosity",
            "{ law = 'carreau', bulk = 5N, zero = 10N, infinite = 5N, time = 1N, exponent = 0.5N }",
        )],
    ),
    (
        "power law",
        &[(
            "material.viscosity",
            "{ law = 'power-law', bulk = 5N, consistency = 10N, exponent = 0.5N, threshold = 0.1N, floor = 1N }",
        )],
    ),
    (
        "branches",
        &[
            ("material.prony", "[{ ratio = 0.5N, time = 0.2N }, { ratio = 0.25N, time = 0.2 }]"),
            ("material.elasticity.young", "2N"),
        ],
    ),
    (
        "power, static-kinetic, power",
        &[
            ("contact.normal", "{ law = 'power', stiffness = 300N, exponent = 1.5N }"),
            (
                "contact.friction",
                "{ law = 'static-kinetic', static = 0.4N, kinetic = 0.3N, decay_speed = 0.5N, cap = 0.8N }",
            ),
            (
                "contact.heat",
                "{ law = 'sum', laws = [{ law = 'power', coefficient = 3N, exponent = 1N, truncation = 5N }, { law = 'gap', conductivity = 0.1N, roughness = 0.1N }, { law = 'radiation', emissivity = 0.5N }], foundation_temperature = 2 }",
            ),
            ("contact.wear", "{ law = 'archard', coefficient = 1e-3N }"),
        ],
    ),
    (
        "tables",
        &[
            ("contact.normal", "{ law = 'table', penetration = [0, 0.1, 0.2], pressure = [0, 10, 30], factor = 1.5N }"),
            ("contact.friction", "{ law = 'slip-rate', speed = [0, 1], coefficient = [0.2, 0.3], factor = 1.2N }"),
            ("contact.heat", "{ law = 'pressure', coefficient = 0.3N, exponent = 0.9N, foundation_temperature = 2 }"),
            (
                "contact.wear",
                "{ law = 'archard-temperature', temperature = [0, 1], coefficient = [1e-3, 2e-3], factor = 0.5N }",
            ),
        ],
    ),
];

/// Every number of a law as an expression of the same value: a run that is equal to round-off.
#[test]
fn expressions_of_a_value_are_that_value() {
    let number = |text: &str| format!("\"{text} + 0*x\"");
    for (name, keys) in LAWS {
        let with = |varies: bool| {
            let mut sets: Vec<String> = SMALL.iter().map(|set| (*set).to_owned()).collect();
            for (key, value) in keys {
                let value = match (value.parse::<f64>(), varies) {
                    (Ok(_), true) => number(value),
                    (Ok(_), false) => (*value).to_owned(),
                    (Err(_), varies) => marked(value, varies),
                };
                sets.push(format!("{key}={value}"));
            }
            shipped("cases/paper.toml", &sets).problem
        };
        let (numbers, expressions) = (run(&with(false)), run(&with(true)));
        assert_same(&expressions, &numbers, 1e-10, name);
        let ledger = expressions.ledger;
        assert!(ledger.relative_closing_error().abs() < 1e-12, "{name}: {:e}", ledger.relative_closing_error());
        assert!(ledger.relative_heat_closing_error().abs() < 1e-12, "{name}");
    }
}

/// A table in which the numbers that an `N` marks stand as numbers or as expressions.
fn marked(text: &str, varies: bool) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(end) = rest.find('N') {
        let begin = rest[..end].rfind(|c: char| !"0123456789.e-".contains(c)).map_or(0, |i| i + 1);
        let number = &rest[begin..end];
        let _ = write!(out, "{}", &rest[..begin]);
        let _ = if varies { write!(out, "\"{number} + 0*x\"") } else { write!(out, "{number}") };
        rest = &rest[end + 1..];
    }
    out + rest
}

/// A VTU file of a mesh in text form, with data of cells and of points.
fn vtu(mesh: &Mesh, cells: impl Fn(&Point) -> f64, points: impl Fn(&Point) -> f64) -> String {
    let block = &mesh.blocks[0];
    let list = |values: Vec<String>| values.join(" ");
    let n = block.element.nodes.len();
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n\
         <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n\
         <Points><DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">{}</DataArray></Points>\n\
         <Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">{}</DataArray>\n\
         <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">{}</DataArray>\n\
         <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">{}</DataArray></Cells>\n\
         <CellData><DataArray type=\"Float64\" Name=\"of_cells\" format=\"ascii\">{}</DataArray></CellData>\n\
         <PointData><DataArray type=\"Float64\" Name=\"of_nodes\" format=\"ascii\">{}</DataArray></PointData>\n\
         </Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
        mesh.points.len(),
        block.len(),
        list(mesh.points.iter().flatten().map(|x| format!("{x:?}")).collect()),
        list(block.nodes.iter().map(ToString::to_string).collect()),
        list((1..=block.len()).map(|i| (i * n).to_string()).collect()),
        list(vec![block.element.vtk().to_string(); block.len()]),
        list(block.cells().map(|cell| format!("{:?}", cells(&centre(mesh, cell)))).collect()),
        list(mesh.points.iter().map(|x| format!("{:?}", points(x))).collect()),
    )
}

/// The same mesh and data in the format of Gmsh, version 2.2 or 4.1, with numbers that do not begin at 0.
fn msh(mesh: &Mesh, version: &str, cells: impl Fn(&Point) -> f64, points: impl Fn(&Point) -> f64) -> String {
    let (block, mut out) = (&mesh.blocks[0], format!("$MeshFormat\n{version} 0 8\n$EndMeshFormat\n"));
    let (nodes, count) = (mesh.points.len(), block.len());
    let code = block.element.types[0].gmsh.expect("a type of Gmsh");
    let in_file = |cell: &[u32]| -> String {
        let order = block.element.orders.gmsh;
        (0..cell.len()).map(|i| (cell[order.local(i)] + 7).to_string()).collect::<Vec<_>>().join(" ")
    };
    if version == "2.2" {
        let _ = writeln!(out, "$Nodes\n{nodes}");
        for (i, x) in mesh.points.iter().enumerate() {
            let _ = writeln!(out, "{} {:?} {:?} {:?}", i + 7, x[0], x[1], x[2]);
        }
        let _ = writeln!(out, "$EndNodes\n$Elements\n{count}");
        for (i, cell) in block.cells().enumerate() {
            let _ = writeln!(out, "{} {code} 2 0 1 {}", i + 11, in_file(cell));
        }
    } else {
        let _ = writeln!(out, "$Nodes\n1 {nodes} 7 {}\n2 1 0 {nodes}", nodes + 6);
        (0..nodes).for_each(|i| out += &format!("{}\n", i + 7));
        for x in &mesh.points {
            let _ = writeln!(out, "{:?} {:?} {:?}", x[0], x[1], x[2]);
        }
        let dim = mesh.dim;
        let _ = writeln!(out, "$EndNodes\n$Elements\n1 {count} 11 {}\n{dim} 1 {code} {count}", count + 10);
        for (i, cell) in block.cells().enumerate() {
            let _ = writeln!(out, "{} {}", i + 11, in_file(cell));
        }
    }
    out += "$EndElements\n$NodeData\n1\n\"other\"\n1\n0.0\n3\n0\n1\n1\n7 1.0\n$EndNodeData\n";
    let _ = writeln!(out, "$ElementData\n1\n\"of_cells\"\n1\n0.0\n3\n0\n1\n{count}");
    for (i, cell) in block.cells().enumerate() {
        let _ = writeln!(out, "{} {:?}", i + 11, cells(&centre(mesh, cell)));
    }
    let _ = writeln!(out, "$EndElementData\n$NodeData\n1\n\"of_nodes\"\n1\n0.0\n3\n0\n1\n{nodes}");
    for (i, x) in mesh.points.iter().enumerate() {
        let _ = writeln!(out, "{} {:?}", i + 7, points(x));
    }
    out + "$EndNodeData\n"
}

fn centre(mesh: &Mesh, cell: &[u32]) -> Point {
    std::array::from_fn(|d| cell.iter().map(|&n| mesh.points[n as usize][d]).sum::<f64>() / cell.len() as f64)
}

fn with_file(text: &str, name: &str, file: &str, sets: &[String]) -> Result<Case, case::CaseError> {
    let files = BTreeMap::from([(name.to_owned(), Arc::from(file.as_bytes()))]);
    let text = text.replace("body.vtu", name);
    case::parse(&Source { files: Files::Memory(files), ..Source::new("graded.toml", text.as_str()) }, sets)
}

const BODY: &str = r#"
name = "graded"
[mesh]
file = "body.vtu"
[time]
end = 0.5
steps = 4
[material]
density = 1.0
heat_capacity = 1.0
conductivity = 1.0
expansion = 0.3
coupling = 0.2
elasticity = { law = "isotropic", young = 10.0, poisson = 0.3, stress_state = "plane-stress" }
viscosity = { law = "lame", first = 0.1, second = 0.2 }
[load]
body_force = [0.3, "-1 - x"]
heat_source = 1.0
[contact]
on = "boundary"
normal = { law = "compliance", stiffness = 100 }
friction = { law = "coulomb", coefficient = 0.3 }
heat = { law = "ramp", conductance = 1, width = 1e-3, foundation_temperature = 0.5 }
[[boundary]]
on = "boundary"
spring = 1.0
"#;

/// Values of cells are those of an expression with jumps between the cells, and values of nodes those of an expression
/// that is linear in the cells; off the axes and in bricks and quadrilaterals too.
#[test]
fn data_of_a_mesh_file_are_expressions() {
    for (mesh, dim) in [
        (Mesh::rectangle_of(Elements::P1, [1.0, 0.7], [6, 4], Diagonal::Right).unwrap(), 2),
        (Mesh::rectangle_of(Elements::Q1, [1.0, 0.7], [6, 4], Diagonal::Right).unwrap(), 2),
        (Mesh::box_([1.0, 0.7, 0.5], [4, 2, 2], Elements::Q1).unwrap(), 3),
    ] {
        // The body is turned: cells meet the axes at an angle.
        let (s, c) = 0.4f64.sin_cos();
        let turned = Mesh {
            points: mesh.points.iter().map(|x| [c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]]).collect(),
            ..mesh.clone()
        };
        let along = move |x: &Point| c * x[0] + s * x[1];
        let text = format!("({c:?})*x + ({s:?})*y");
        let (jump, linear) =
            (move |x: &Point| if along(x) < 0.5 { 3.0 } else { 8.0 }, move |x: &Point| 3.0 + 2.0 * along(x));
        let files = [
            ("body.vtu", vtu(&turned, jump, linear)),
            ("body.msh", msh(&turned, "2.2", jump, linear)),
            ("body.MSH", msh(&turned, "4.1", jump, linear)),
        ];
        let in_space = BODY.replace("\"-1 - x\"]", "\"-1 - x\", 0.2]").replace(", stress_state = \"plane-stress\"", "");
        let body = if dim == 3 { in_space } else { BODY.to_owned() };
        for (name, file) in &files {
            let read =
                |sets: &[String]| with_file(&body, name, file, sets).unwrap_or_else(|e| panic!("{name}: {e}")).problem;
            for (data, expression) in
                [("of_cells", format!("if({text} < 0.5, 3, 8)")), ("of_nodes", format!("3 + 2*({text})"))]
            {
                let keys = |value: &str| -> Vec<String> {
                    ["density", "heat_capacity", "conductivity", "elasticity.young", "viscosity.second"]
                        .iter()
                        .map(|key| format!("material.{key}={value}"))
                        .collect()
                };
                let by_data = read(&keys(&format!("{{ data = \"{data}\" }}")));
                let by_expression = read(&keys(&format!("\"{expression}\"")));
                assert_same(&run(&by_data), &run(&by_expression), 1e-11, &format!("{name}, {data}, d = {dim}"));
            }
            // A coefficient of contact at the nodes of a side.
            let friction = |value: &str| vec![format!("contact.friction.coefficient={value}")];
            let by_data = read(&friction("{ data = \"of_nodes\", factor = 0.1 }"));
            let by_expression = read(&friction(&format!("\"0.1*(3 + 2*({text}))\"")));
            assert_same(&run(&by_data), &run(&by_expression), 1e-11, "friction by the nodes");
        }
    }
}

/// A body that conducts much loses its heat through a contact whose conductance changes with time: backward Euler makes
/// θ_n = θ_{n−1}/(1 + k h(t_n)/(c L)).
#[test]
fn a_conductance_in_time() {
    let text = r#"
name = "cooling"
[mesh]
kind = "interval"
size = 2.0
n = 2
[time]
end = 1.0
steps = 8
[material]
density = 0
heat_capacity = 3.0
conductivity = 1e9
expansion = 0
coupling = 0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.0 }
[initial]
temperature = 1.0
displacement = ["0.5*x"]
[[boundary]]
on = "left"
displacement = [0]
[contact]
on = "right"
normal = { law = "bilateral" }
heat = { law = "pressure", coefficient = "1 + 4*t^2", exponent = 1e-12, foundation_temperature = 0 }
gap = -0.5
"#;
    let h = |t: f64| 1.0 + 4.0 * t * t;
    let table = |t: f64| 3.0 * if t < 0.5 { 1.0 + 2.0 * t } else { 4.0 * t };
    let sum = "{ law = 'sum', laws = [{ law = 'pressure', coefficient = '1 + 4*t^2', exponent = 1e-12 }, { law = 'radiation', emissivity = 0 }], foundation_temperature = 0 }";
    for (set, h) in [
        ("contact.heat.coefficient=\"1 + 4*t^2\"".to_owned(), &h as &dyn Fn(f64) -> f64),
        ("contact.heat.coefficient={ times = [0, 0.5, 1], values = [1, 2, 4], factor = \"1 + x\" }".to_owned(), &table),
        (format!("contact.heat={sum}"), &h),
    ] {
        let sets = [set.clone()];
        let problem = case::parse(&Source::new("cooling.toml", text), &sets).unwrap_or_else(|e| panic!("{e}")).problem;
        let mut expected = 1.0;
        for n in 1..=8 {
            let t = f64::from(n) / 8.0;
            expected /= 1.0 + h(t) / 8.0 / 6.0;
        }
        let state = run(&problem);
        for theta in &state.theta {
            assert!((theta / expected - 1.0).abs() < 1e-7, "{set}: {theta}, expected {expected}");
        }
        assert!(state.ledger.relative_heat_closing_error().abs() < 1e-12);
        let finding = findings(&problem).into_iter().find(|finding| finding.id == FindingId::H7).expect("(H7)");
        assert!(finding.message.contains("depends on the time"), "{}", finding.message);
    }
}

/// Where the side slips, the friction traction is μ(x, t) p at the end of every step, and points that stick do not
/// exceed that bound.
#[test]
fn a_friction_coefficient_in_space_and_time() {
    let problem = paper(&[
        "mesh.n=8",
        "time.steps=8",
        "contact.friction.coefficient=\"0.1 + 0.2*t + 0.3*x\"",
        "contact.foundation_velocity=[3, 0]",
    ])
    .problem;
    let mut scheme = March::new(&problem).expect("a regular system");
    let mut state = scheme.initial().expect("finite initial data");
    let mut slipping = 0;
    for n in 1..=8 {
        let (next, report) = scheme.step(&state).unwrap_or_else(|error| panic!("{error}"));
        let t = f64::from(n) / 8.0;
        for (at, point) in report.contact.states.iter().zip(&scheme.discretization().boundary.points) {
            let bound = (0.1 + 0.2 * t + 0.3 * point.x[0]) * at.pressure.max(0.0);
            let traction = at.q.iter().map(|q| q * q).sum::<f64>().sqrt();
            assert!(traction <= bound * (1.0 + 1e-12), "{traction} {bound}");
            if at.status == Status::Slip && at.pressure > 0.0 {
                slipping += 1;
                assert!((traction - bound).abs() <= 1e-12 * bound, "t = {t}: {traction}, expected {bound}");
            }
        }
        state = next;
    }
    assert!(slipping > 40, "{slipping} points slipped");
}

/// Constants are extremes over the body and over the side, with their places.
#[test]
fn the_certificate_names_where_constants_are_attained() {
    let problem = paper(&[
        "mesh.n=4",
        "material.elasticity.young=\"2 + x*y\"",
        "material.elasticity.poisson=0",
        "material.viscosity.second=\"3 - x\"",
        "material.viscosity.first=0",
        "material.conductivity=\"1 + y\"",
        "material.expansion=\"1 - 3*x\"",
        "contact.normal.stiffness=\"100*(1 + x)\"",
        "contact.friction.coefficient=\"0.5 - 0.4*x\"",
        "contact.heat.conductance=\"4*x*(1 - x)\"",
    ])
    .problem;
    let certificate = certificate(&problem).expect("a certificate");
    let constants = certificate.constants;
    let near = |found: f64, expected: f64| assert!((found - expected).abs() <= 1e-14 * expected, "{found} {expected}");
    // With ν = 0 the eigenvalues of 𝓔 are E, those of 𝓥 without μ₁ are μ₂.
    near(constants.m_a, 2.0);
    near(constants.lipschitz_a, 3.0);
    near(constants.m_b, 2.0);
    near(constants.lipschitz_b, 3.0);
    near(constants.m_d, 1.0);
    near(constants.bound_d, 2.0);
    near(constants.lipschitz_nu.unwrap(), 200.0);
    // (0.5 − 0.4x) 100 (1 + x) at the nodes x = 0, 1/4, …: 40 · 1.25 at 1/4, 50 at 0.
    near(constants.lipschitz_tau.unwrap(), 50.0);
    near(constants.bound_kc.unwrap(), 1.0);
    let message =
        |id: FindingId| certificate.findings.iter().find(|f| f.id == id).expect("the finding").message.clone();
    for (id, parts) in [
        (FindingId::H1, ["m_b = 2.000000e0 at (1.0, 0.0, 0.0)", "M_b = 3.000000e0 at (0.0, 0.0, 0.0)"]),
        (FindingId::H2, ["m_a = 2.000000e0 at (0.0, 0.0, 0.0)", "M_a = 3.000000e0 at (1.0, 1.0, 0.0)"]),
        (FindingId::H3, ["the eigenvalues 1.000000, 1.000000", "the least over the body, at (0.0, 0.0, 0.0)"]),
        (FindingId::H4, ["‖𝓜‖ = 2.828427e0 at (1.0, ", "bounded"]),
        (FindingId::H7, ["M_kc = 1.000000e0 at (0.5, 0.0, 0.0)", "bounded"]),
        (FindingId::H8, ["L_ν = 2.000000e2 at (1.0, 0.0, 0.0)", "L_τ = 5.000000e1 at (0.0, 0.0, 0.0)"]),
    ] {
        for part in parts {
            assert!(message(id).contains(part), "{id:?}: {}", message(id));
        }
    }
}

/// A coefficient that jumps within a cell is named with its place; one that jumps between cells, or is steep and
/// smooth, is not.
#[test]
fn jumps_within_cells_are_named() {
    let said = |sets: &[&str]| {
        let sets: Vec<&str> = ["mesh.n=4"].iter().chain(sets).copied().collect();
        let certificate = certificate(&paper(&sets).problem).expect("a certificate");
        certificate.findings.into_iter().find(|finding| finding.id == FindingId::CoefficientJump)
    };
    for quiet in [
        "material.density=\"if(x < 0.5, 1, 2)\"",
        "material.density=\"1 + x + 3*y^2\"",
        "material.elasticity.young=\"exp(8*x)\"",
        "material.conductivity=\"1.1 + sin(20*x)\"",
        "material.elasticity.young=\"max(1, 4*x)\"",
    ] {
        assert_eq!(said(&[quiet]), None, "{quiet}");
    }
    for (jumping, place) in [
        ("material.density=\"if(x < 0.3, 1, 2)\"", "material.density"),
        ("material.elasticity.young=\"1 + (y > 0.6)\"", "material.elasticity"),
        ("material.viscosity.second=\"10 + floor(3*x)\"", "material.viscosity"),
        ("material.conductivity=[[1, 0], [0, \"1 + step(x + y - 0.37)\"]]", "material.conductivity"),
    ] {
        let finding = said(&[jumping]).unwrap_or_else(|| panic!("{jumping}: nothing is said"));
        assert_eq!(finding.place, place);
        assert!(finding.fails() && finding.message.contains("jumps within a cell, at ("), "{}", finding.message);
    }
    let finding = said(&["material.density=\"if(x < 0.3, 1, 2)\""]).expect("a finding");
    assert!((finding.value.expect("the jump") - 0.5).abs() < 1e-12);
}

/// Laws by closures keep the contract of laws.
#[test]
fn closures_keep_the_contract() {
    let corners: Vec<Point> = (0..8).map(|i| [0, 1, 2].map(|d| f64::from((i >> d) & 1))).collect();
    for dim in 1..=3 {
        let law = Law::<dyn TensorLaw>::in_space(&corners, move |x| {
            Arc::new(Isotropic::elastic(dim, 1.0 + x[0] + x[1], 0.2, StressState::PlaneStrain))
        });
        contract::assert_tensor_law(law.as_ref(), dim, 1.0);
        contract::assert_isotropic(law.as_ref(), dim, 1.0);
        let wood = OrthotropicConstants { young: [9.0, 0.8, 0.4], poisson: [0.3, 0.3, 0.5], shear: [0.8, 0.7, 0.1] };
        let state = StressState::PlaneStrain;
        let grain = Law::<dyn TensorLaw>::in_space(&corners, move |x| {
            Arc::new(
                amontons::material::Linear::orthotropic(&wood, &Rotation::in_plane(x[0]), dim, state).expect("wood"),
            )
        });
        contract::assert_tensor_law(grain.as_ref(), dim, 1.0);
    }
    let normal = Law::<dyn NormalLaw>::in_space(&corners, |x| Arc::new(Compliance { stiffness: 1e4 * (1.0 + x[0]) }));
    contract::assert_normal_law(normal.as_ref(), 1e-4);
    let friction = Law::<dyn FrictionLaw>::in_space(&corners, |x| Arc::new(Coulomb { coefficient: 0.3 + 0.1 * x[1] }));
    contract::assert_friction_law(friction.as_ref(), 1.0);
    let heat = Law::<dyn HeatLaw>::in_space(&corners, |x| {
        Arc::new(Ramp { conductance: 2.0 + x[0], width: 0.5 + x[1], truncation: None })
    });
    contract::assert_heat_law(heat.as_ref(), 0.5);
}
