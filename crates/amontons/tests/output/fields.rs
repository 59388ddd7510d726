//! What a run gives: stresses at nodes and their order, fields of the snapshots.
#![allow(clippy::too_many_lines, clippy::too_many_arguments, reason = "a test is one list of cases")]
#![allow(clippy::float_cmp, reason = "some values are exact")]

use std::fs;
use std::sync::Arc;

use crate::at_rest::{PLANE_STRAIN, PLANE_STRESS, folder, hooke, options, parse, probe, read, settings, text};
use crate::common::{self, Random, changed};
use amontons::case::Case;
use amontons::element::ShapeTable;
use amontons::material::StressState;
use amontons::mesh::{Block, CellMap};
use amontons::output::{Folder, Memory, NodalStress, ProbePlace, Take, cell_values, nodal_stress};
use amontons::run::run;
use amontons::state::State;
use amontons::tensor::{Point, Sym};

/// The state at t = 0.
fn initial(case: &Case) -> State {
    let mut memory = Memory::new().states_every(1);
    run(&case.problem, &settings(), &mut [&mut memory]).unwrap();
    memory.states.swap_remove(0)
}

/// A smooth displacement and temperature as the case file says them, in `dim` dimensions.
fn smooth(dim: usize) -> (String, String) {
    let phase = |all: [f64; 3]| {
        all.iter().zip(["x", "y", "z"]).take(dim).map(|(c, x)| format!("({c}*{x})")).collect::<Vec<_>>().join("+")
    };
    let u = [
        format!("0.1*sin({})", phase([1.0, 2.0, -1.0])),
        format!("0.1*cos({})", phase([2.0, -1.0, 1.0])),
        format!("0.1*sin({})", phase([1.0, -1.0, 2.0])),
    ];
    (
        format!("[{}]", u[..dim].iter().map(|u| format!("\"{u}\"")).collect::<Vec<_>>().join(", ")),
        format!("\"cos({})\"", phase([1.0, -1.0, 1.0])),
    )
}

/// Its stress by Hooke's law with thermal expansion.
fn smooth_stress(dim: usize, plane: StressState, x: &Point) -> Sym {
    let phase = |c: [f64; 3]| (0..dim).map(|d| c[d] * x[d]).sum::<f64>();
    let (a, b, c) = ([1.0, 2.0, -1.0], [2.0, -1.0, 1.0], [1.0, -1.0, 2.0]);
    let slopes = [(0.1 * phase(a).cos(), a), (-0.1 * phase(b).sin(), b), (0.1 * phase(c).cos(), c)];
    let strain = Sym::from_fn(dim, |i, j| 0.5 * (slopes[i].0 * slopes[i].1[j] + slopes[j].0 * slopes[j].1[i]));
    hooke(dim, plane, &strain, phase([1.0, -1.0, 1.0]).cos())
}

/// Errors in L² of the stresses of the cells and of the recovered ones, for the smooth fields, and the largest at a
/// node.
fn errors(mesh: &str, dim: usize, plane: StressState) -> [f64; 3] {
    let (u, theta) = smooth(dim);
    let state = match plane {
        _ if dim == 3 => "",
        StressState::PlaneStrain => PLANE_STRAIN,
        StressState::PlaneStress => PLANE_STRESS,
    };
    let case = parse(&text(mesh, state, &u, &theta, ""));
    let (state, mesh) = (initial(&case), &case.problem.mesh);
    let (cells, nodal) = (cell_values(&case.problem, &state), nodal_stress(&case.problem, &state));
    let (mut of_cells, mut of_nodes, mut cells) = (0.0, 0.0, cells.into_iter());
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, 2 * block.element.degree + 2);
        let mut map = CellMap::new(mesh, &table);
        for (cell, values) in block.cells().zip(&mut cells) {
            for q in 0..table.len() {
                map.at(cell, q);
                let exact = smooth_stress(dim, plane, &map.position);
                let recovered = at_shape(&nodal, block, cell, map.values());
                let weight = table.weights[q] * map.measure;
                of_cells += weight * (values.stress - exact).norm().powi(2);
                of_nodes += weight * (recovered - exact).norm().powi(2);
            }
        }
    }
    let at_nodes =
        nodal.regions[0].iter().map(|(node, s)| (*s - smooth_stress(dim, plane, &mesh.points[*node as usize])).norm());
    [of_cells.sqrt(), of_nodes.sqrt(), at_nodes.fold(0.0, f64::max)]
}

fn at_shape(nodal: &NodalStress, block: &Block, cell: &[u32], shape: &[f64]) -> Sym {
    cell.iter().zip(shape).fold(Sym::ZERO, |sum, (&node, value)| sum + *value * nodal.get(block.region, node).unwrap())
}

/// Zienkiewicz and Zhu (1992): one order more than the stress of the cells, up to the boundary.
#[test]
fn recovered_stresses_converge_one_order_faster() {
    use StressState::{PlaneStrain, PlaneStress};
    let cases: [(&str, usize, StressState, [usize; 2], f64); 9] = [
        ("kind = \"interval\"\nsize = 1.0\nn = {n}\nelements = \"P1\"", 1, PlaneStress, [16, 32], 2.0),
        ("kind = \"interval\"\nsize = 1.0\nn = {n}\nelements = \"P2\"", 1, PlaneStress, [16, 32], 3.0),
        ("kind = \"rectangle\"\nsize = [1.0, 1.0]\nn = {n}\nelements = \"P1\"", 2, PlaneStress, [16, 32], 2.0),
        ("kind = \"rectangle\"\nsize = [1.0, 1.0]\nn = {n}\nelements = \"Q1\"", 2, PlaneStrain, [16, 32], 2.0),
        ("kind = \"rectangle\"\nsize = [1.0, 1.0]\nn = {n}\nelements = \"P2\"", 2, PlaneStrain, [8, 16], 3.0),
        ("kind = \"rectangle\"\nsize = [1.0, 1.0]\nn = {n}\nelements = \"Q2\"", 2, PlaneStress, [8, 16], 3.0),
        ("kind = \"box\"\nsize = [1.0, 1.0, 1.0]\nn = {n}\nelements = \"P1\"", 3, PlaneStress, [4, 8], 2.0),
        ("kind = \"box\"\nsize = [1.0, 1.0, 1.0]\nn = {n}\nelements = \"Q1\"", 3, PlaneStress, [4, 8], 2.0),
        ("kind = \"box\"\nsize = [1.0, 1.0, 1.0]\nn = {n}\nelements = \"Q2\"", 3, PlaneStress, [2, 4], 3.0),
    ];
    for (mesh, dim, plane, levels, order) in cases {
        let [coarse, fine] = levels.map(|n| errors(&mesh.replace("{n}", &n.to_string()), dim, plane));
        let slopes: Vec<f64> = coarse.iter().zip(&fine).map(|(c, f)| (c / f).log2()).collect();
        println!("{mesh}: {slopes:?} {fine:?}");
        assert!((slopes[0] - 1.0).abs() < 0.1, "{mesh}: the stress of the cells is of order {}", slopes[0]);
        assert!(slopes[1] > order - 0.25, "{mesh}: the recovered stress is of order {}", slopes[1]);
    }
}

/// A polynomial stress of the degree of the elements is recovered as it is, at the boundary too, and in a layer of one
/// cell, whose nodes are all on the boundary.
#[test]
fn polynomial_stresses_are_recovered_exactly() {
    let quadratic = ["x^2+3*x*y-y^2", "0.5*x^2-x*y+2*y^2"];
    let exact = |x: &Point| {
        let [normal_x, normal_y, shear] = [2.0 * x[0] + 3.0 * x[1], 4.0 * x[1] - x[0], 2.0 * x[0] - 1.5 * x[1]];
        Sym::from_fn(2, |i, j| [[normal_x, shear], [shear, normal_y]][i][j])
    };
    for (elements, n) in
        [("P2", "[5, 4]"), ("Q2", "[5, 4]"), ("P2", "[6, 1]"), ("Q2", "[6, 1]"), ("Q2", "[1, 1]"), ("P2", "[2, 1]")]
    {
        let mesh = format!("kind = \"rectangle\"\nsize = [3.0, 1.0]\nn = {n}\nelements = \"{elements}\"");
        let u = format!("[\"{}\", \"{}\"]", quadratic[0], quadratic[1]);
        let case = parse(&text(&mesh, PLANE_STRESS, &u, "0", ""));
        for &(node, stress) in &nodal_stress(&case.problem, &initial(&case)).regions[0] {
            let expected = hooke(2, StressState::PlaneStress, &exact(&case.problem.mesh.points[node as usize]), 0.0);
            assert!((stress - expected).norm() < 1e-11, "{elements} {n}: {stress:?} instead of {expected:?}");
        }
    }
    // Linear elements, a constant stress: a layer of squares determines no slope across.
    for mesh in [
        "kind = \"rectangle\"\nsize = [3.0, 1.0]\nn = [6, 1]\nelements = \"Q1\"",
        "kind = \"rectangle\"\nsize = [3.0, 1.0]\nn = [1, 1]",
    ] {
        let case = parse(&text(mesh, PLANE_STRAIN, "[\"0.1*x-0.2*y\", \"0.3*y\"]", "2", ""));
        let strain = Sym::from_fn(2, |i, j| [[0.1, -0.1], [-0.1, 0.3]][i][j]);
        for &(_, stress) in &nodal_stress(&case.problem, &initial(&case)).regions[0] {
            assert!((stress - hooke(2, StressState::PlaneStrain, &strain, 2.0)).norm() < 1e-13);
        }
    }
}

/// A bent plate of one layer of tetrahedra whose nodes are anywhere: no stress at a node is far beyond those of the
/// cells. As a polynomial of the points, which hardly determine one, it was up to 10⁷ times as large.
#[test]
fn recovered_stresses_are_bounded_by_those_of_the_cells() {
    let (mut random, mut worst) = (Random(3), 0.0f64);
    for (number, elements) in (0..200).zip(["P1", "P2", "Q1"].into_iter().cycle()) {
        let n = 2 + number % 5;
        let mesh =
            format!("kind = \"box\"\nsize = [1.0, 1.0, 0.1]\nn = [{n}, {}, 1]\nelements = \"{elements}\"", n + 1);
        let u = "[\"-x*(z-0.05)+1e-3*sin(9*y)\", \"1e-3*x*y\", \"0.5*x^2\"]";
        let mut case = parse(&text(&mesh, "", u, "0", ""));
        case.problem = changed(&case.problem, |data| {
            let mut mesh = (*data.mesh).clone();
            let bend = [(); 4].map(|()| 3.0 * random.number());
            for x in &mut mesh.points {
                let [along, across] =
                    [(bend[0] * x[0] + bend[1] * x[1]).sin(), (bend[2] * x[0] + bend[3] * x[1]).cos()];
                *x = [
                    x[0] + 0.06 / f64::from(n) * along,
                    x[1] + 0.06 / f64::from(n) * across,
                    x[2] * (1.0 + 0.3 * along),
                ];
            }
            data.mesh = Arc::new(mesh);
        });
        let (state, problem) = (initial(&case), &case.problem);
        let largest = |all: &mut dyn Iterator<Item = f64>| all.fold(0.0, f64::max);
        let of_cells = largest(&mut cell_values(problem, &state).iter().map(|values| values.stress.norm()));
        let of_nodes = largest(&mut nodal_stress(problem, &state).regions[0].iter().map(|(_, stress)| stress.norm()));
        worst = worst.max(of_nodes / of_cells);
        // The centre of a cell that goes through the plate has none of its bending.
        let most = if elements == "P1" { 5.0 } else { 100.0 };
        assert!(of_nodes < most * of_cells, "{mesh}: {of_nodes:e} at nodes, {of_cells:e} in cells");
    }
    println!("up to {worst} times");
}

/// At an interface each material has its own stress; the file of the fields has the mean there.
#[test]
fn stresses_jump_where_materials_meet() {
    let mut case =
        parse(&text("kind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 8", PLANE_STRESS, "[\"0.1*x\", 0]", "0", ""));
    let stiff = parse(
        &text("kind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 1", PLANE_STRESS, "[0, 0]", "0", "")
            .replace("young = 2", "young = 6"),
    );
    let mut mesh = (*case.problem.mesh).clone();
    let block = mesh.blocks.remove(0);
    for region in 0..2 {
        let is_in = |cell: &&[u32]| (cell.iter().all(|&n| mesh.points[n as usize][0] <= 0.5)) == (region == 0);
        let nodes = block.cells().filter(is_in).flatten().copied().collect();
        mesh.blocks.push(Block { element: block.element, region, nodes });
    }
    mesh.regions = vec!["soft".to_owned(), "stiff".to_owned()];
    case.problem = changed(&case.problem, |data| {
        data.mesh = Arc::new(mesh);
        data.materials.extend(stiff.problem.materials.iter().cloned());
        data.materials.truncate(2);
    });
    let nodal = nodal_stress(&case.problem, &initial(&case));
    let soft = hooke(2, StressState::PlaneStress, &Sym::from_fn(2, |i, j| if i + j == 0 { 0.1 } else { 0.0 }), 0.0);
    for (region, factor) in [(0, 1.0), (1, 3.0)] {
        assert_eq!(nodal.regions[region].len(), 5 * 9);
        for (_, stress) in &nodal.regions[region] {
            assert!((*stress - factor * soft).norm() < 1e-14, "{stress:?}");
        }
    }
    for (x, stress) in case.problem.mesh.points.iter().zip(nodal.means(81)) {
        let factor = if x[0] < 0.5 {
            1.0
        } else if x[0] > 0.5 {
            3.0
        } else {
            2.0
        };
        assert!((stress - factor * soft).norm() < 1e-14);
    }
    let probes = [
        probe("stress_xx", ProbePlace::Region("stiff".to_owned(), Take::Min)),
        probe("stress_xx", ProbePlace::Region("soft".to_owned(), Take::Max)),
    ];
    let found = read(&case, &probes);
    assert!((found[0] - 3.0 * soft.get(0, 0)).abs() < 1e-14 && (found[1] - soft.get(0, 0)).abs() < 1e-14, "{found:?}");
}

/// The files of the fields have what is asked for beside what every file has.
#[test]
fn files_have_the_fields_asked_for() {
    let names = |fields: &str| {
        let overrides: Vec<String> = ["mesh.n=4", "time.steps=1", "output.every=0"]
            .iter()
            .map(|&o| o.to_owned())
            .chain((!fields.is_empty()).then(|| format!("output.fields={fields}")))
            .collect();
        let case = common::case("cases/paper.toml", &overrides);
        let path = folder("fields");
        run(&case.problem, &settings(), &mut [&mut Folder::create(&path, options(&case)).unwrap()]).unwrap();
        let text = fs::read_to_string(path.join("fields/step_0000001.vtu")).unwrap();
        let mut names: Vec<String> =
            text.split("Name=\"").skip(1).map(|rest| rest.split('"').next().unwrap().to_owned()).collect();
        names.retain(|name| !matches!(name.as_str(), "Points" | "connectivity" | "offsets" | "types" | ""));
        names.sort();
        names.join(" ")
    };
    assert_eq!(names(""), "displacement nodal_von_mises region stress temperature velocity von_mises");
    assert_eq!(names("[]"), "displacement nodal_von_mises region temperature velocity von_mises");
    assert_eq!(
        names("[\"stress\", \"strain\", \"principal\", \"heat-flux\", \"nodal-stress\", \"stress\"]"),
        "displacement heat_flux nodal_stress nodal_von_mises principal principal_direction_1 principal_direction_2 principal_direction_3 region strain stress \
         temperature velocity von_mises"
    );
}

/// One file for all snapshots has the mesh once, and takes less than seven tenths of the bytes of files of their own.
#[test]
fn the_file_of_all_fields_has_the_mesh_once() {
    let overrides = ["mesh.n=24", "time.steps=20", "output.every=1", "output.format=\"both\""].map(str::to_owned);
    let case = common::case("cases/paper.toml", &overrides);
    let path = folder("packed");
    run(&case.problem, &settings(), &mut [&mut Folder::create(&path, case.folder_options()).unwrap()]).unwrap();
    let own: u64 = fs::read_dir(path.join("fields")).unwrap().map(|file| file.unwrap().metadata().unwrap().len()).sum();
    let packed = fs::metadata(path.join("fields.vtkhdf")).unwrap().len();
    assert!(10 * packed < 7 * own, "{packed} bytes, and {own} in files of their own");
    let file = hdf5_pure::File::open(path.join("fields.vtkhdf")).unwrap();
    let rows = |name: &str| file.dataset(&format!("VTKHDF/{name}")).unwrap().shape().unwrap()[0] as usize;
    let (mesh, cells) = (&case.problem.mesh, case.problem.mesh.cell_count());
    assert_eq!([rows("Points"), rows("Types"), rows("Connectivity")], [mesh.points.len(), cells, 3 * cells]);
    assert_eq!([rows("PointData/displacement"), rows("CellData/region")], [21 * mesh.points.len(), cells]);
    let root = file.group("VTKHDF").unwrap().attrs().unwrap();
    assert_eq!(root["Version"].to_i64s(), Some(vec![2, 0]));
    assert_eq!(root["Type"].as_str(), Some("UnstructuredGrid"));
    let steps = file.group("VTKHDF/Steps").unwrap();
    assert_eq!(steps.attrs().unwrap()["NSteps"].as_i64(), Some(21));
    let times: Vec<u64> = (0..=20).map(|n| case.problem.timeline.time(n).to_bits()).collect();
    let found = file.dataset("VTKHDF/Steps/Values").unwrap().read_f64().unwrap();
    assert_eq!(found.iter().map(|t| t.to_bits()).collect::<Vec<_>>(), times);
    for name in ["NumberOfParts", "PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"] {
        let all = file.dataset(&format!("VTKHDF/Steps/{name}")).unwrap().read_i64().unwrap();
        assert_eq!(all, [i64::from(name == "NumberOfParts"); 21], "{name}");
    }
    let offsets = file.dataset("VTKHDF/Steps/PointDataOffsets/velocity").unwrap().read_i64().unwrap();
    assert!(offsets.iter().enumerate().all(|(n, offset)| *offset == (n * mesh.points.len()) as i64), "{offsets:?}");
}
