//! Conditions at points and along edges: the free bodies that they hold, the resultants of forces, and what is said
//! about faults.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::common::{largest, solve, spoil, told};
use amontons::case::{self, Files, Source};
use amontons::forms;
use amontons::hypotheses::findings;
use amontons::mesh::{self, Elements, Mesh};
use amontons::problem::BoundaryCondition;

fn source(text: &str, files: &[(&str, &str)]) -> Source {
    let memory: BTreeMap<String, Arc<[u8]>> =
        files.iter().map(|(name, text)| ((*name).to_owned(), Arc::from(text.as_bytes()))).collect();
    Source { files: Files::Memory(memory), ..Source::new("points.toml", text.to_owned()) }
}

/// A body without inertia.
fn body(mesh: &str, conditions: &str) -> String {
    let is_plane = mesh.contains("rectangle") && !mesh.contains("axisymmetric");
    let state = if is_plane { ", stress_state = \"plane-stress\"" } else { "" };
    format!(
        "name = \"points\"\n[mesh]\n{mesh}\n[time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0\n\
         elasticity = {{ law = \"isotropic\", young = 1000.0, poisson = 0.25{state} }}\n{conditions}"
    )
}

/// A bar under tension that statically determinate points hold is strained evenly, as one that nothing but symmetry
/// holds: the points bear nothing.
#[test]
fn points_that_hold_a_body_bear_nothing() {
    let pull = "[[boundary]]\non = \"left\"\ntraction = [-2, 0]\n[[boundary]]\non = \"right\"\ntraction = [2, 0]\n";
    let plane = format!(
        "{pull}[[boundary]]\nat = [0, 0]\ndisplacement = [0, 0]\n[[boundary]]\nat = [3.0, 0]\ndisplacement = [\"free\", 0]\n"
    );
    let pull = pull.replace(", 0]", ", 0, 0]");
    let space = format!(
        "{pull}[[boundary]]\nat = [0, 0, 0]\ndisplacement = [0, 0, 0]\n[[boundary]]\nat = [3, 0, 0]\n\
         displacement = [\"free\", 0, 0]\n[[boundary]]\nat = [0, 1, 0]\ndisplacement = [\"free\", \"free\", 0]\n"
    );
    for elements in ["P1", "P2", "Q1", "Q2"] {
        for (kind, size, n, conditions) in
            [("rectangle", "[3, 1]", "[6, 2]", &plane), ("box", "[3, 1, 0.5]", "[3, 2, 1]", &space)]
        {
            let mesh = format!("kind = \"{kind}\"\nsize = {size}\nn = {n}\nelements = \"{elements}\"");
            let case = case::parse(&source(&body(&mesh, conditions), &[]), &[]).unwrap_or_else(|e| panic!("{e}"));
            let state = solve(&case.problem).states.pop().unwrap();
            let dim = case.problem.mesh.dim;
            let (young, poisson) = (1000.0, 0.25);
            let strain = [2.0 / young, -poisson * 2.0 / young, -poisson * 2.0 / young];
            for (x, u) in case.problem.mesh.points.iter().zip(state.u.chunks_exact(dim)) {
                for c in 0..dim {
                    assert!((u[c] - strain[c] * x[c]).abs() < 1e-14, "{elements} {kind}: {u:?} at {x:?}");
                }
            }
        }
    }
}

/// F/|Γ| as a traction, on a side of a plane body, of one in space and of one of revolution.
#[test]
fn a_force_on_a_side_is_a_traction() {
    let mut turned = Mesh::rectangle_of(Elements::Q2, [2.0, 1.0], [3, 2], mesh::Diagonal::Right).unwrap();
    turned.points.iter_mut().for_each(|x| x[0] += 1.0);
    let plane = turned.clone();
    turned.axisymmetric = true;
    let space = Mesh::box_([2.0, 1.0, 0.5], [2, 2, 1], Elements::P2).unwrap();
    for (mesh, area) in [(plane, 1.0), (turned, std::f64::consts::TAU * 3.0), (space, 0.5)] {
        let force = [6.0, -2.0, 5.0].map(|f| f * area);
        let load = |condition: BoundaryCondition| forms::f(&mesh, &[], &[condition]).at(0.0);
        let by_force = load(BoundaryCondition::on("right").force(force.into_iter().take(mesh.dim)));
        let by_traction = load(BoundaryCondition::on("right").traction([6.0, -2.0, 5.0].into_iter().take(mesh.dim)));
        let difference: Vec<f64> = by_force.iter().zip(by_traction.iter()).map(|(a, b)| a - b).collect();
        assert!(largest(&difference) < 1e-14 * largest(&by_traction), "{difference:?}");
    }
}

/// A force at the middle of a rod held at its end: u = F x/EA up to there, and the same beyond.
#[test]
fn a_force_acts_inside_a_rod() {
    let text = body(
        "kind = \"interval\"\nsize = 2.0\nn = 8\nelements = \"P2\"",
        "[[boundary]]\non = \"left\"\ndisplacement = [0]\n[[boundary]]\nat = [0.5]\nforce = [\"3*t\"]\n",
    );
    let case = case::parse(&source(&text, &[]), &[]).unwrap_or_else(|e| panic!("{e}"));
    let state = solve(&case.problem).states.pop().unwrap();
    for (x, u) in case.problem.mesh.points.iter().zip(&state.u) {
        assert!((u - 3.0 / 1000.0 * x[0].min(0.5)).abs() < 1e-15, "{u} at {x:?}");
    }
}

/// A block of 20-node hexahedra whose edge is half a turn of an ellipse, as a part of a file of Abaqus.
fn bent(n: usize) -> String {
    let mut numbers: BTreeMap<[usize; 3], usize> = BTreeMap::new();
    let mut elements = String::new();
    let corners = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 0, 2], [2, 0, 2], [2, 2, 2], [0, 2, 2]];
    let middles = [
        [1, 0, 0],
        [2, 1, 0],
        [1, 2, 0],
        [0, 1, 0],
        [1, 0, 2],
        [2, 1, 2],
        [1, 2, 2],
        [0, 1, 2],
        [0, 0, 1],
        [2, 0, 1],
        [2, 2, 1],
        [0, 2, 1],
    ];
    for k in 0..n {
        let mut nodes = vec![(k + 1).to_string()];
        for [a, b, c] in corners.into_iter().chain(middles) {
            let next = numbers.len() + 1;
            nodes.push(numbers.entry([a, b, 2 * k + c]).or_insert(next).to_string());
        }
        elements += &(nodes.join(", ") + "\n");
    }
    let place = |[a, b, c]: [usize; 3]| {
        let (angle, r) = (std::f64::consts::PI * c as f64 / (2 * n) as f64, 1.0 + 0.25 * a as f64);
        [r * angle.cos(), 1.5 * r * angle.sin(), 0.2 * b as f64]
    };
    let mut nodes: Vec<(usize, [f64; 3])> = numbers.iter().map(|(at, number)| (*number, place(*at))).collect();
    nodes.sort_by_key(|(number, _)| *number);
    let nodes: String = nodes.iter().map(|(number, [x, y, z])| format!("{number}, {x:?}, {y:?}, {z:?}\n")).collect();
    let set = |is_in: &dyn Fn(&[usize; 3]) -> bool| -> String {
        numbers.iter().filter(|(at, _)| is_in(at)).map(|(_, number)| format!("{number},\n")).collect()
    };
    let (edge, end, root) = (
        set(&|[a, b, _]| (*a, *b) == (0, 0)),
        set(&|at| *at == [2, 2, 0] || *at == [0, 0, 2 * n]),
        set(&|at| at[2] == 0),
    );
    format!(
        "*NODE\n{nodes}*ELEMENT, TYPE=C3D20, ELSET=BODY\n{elements}*NSET, NSET=Rim\n{edge}*NSET, NSET=Tips\n{end}\
         *NSET, NSET=Root\n{root}"
    )
}

/// Resultant and moment about the origin of a load in space.
fn resultant(mesh: &Mesh, load: &[f64]) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for (x, f) in mesh.points.iter().zip(load.chunks_exact(3)) {
        for c in 0..3 {
            let (d, e) = ((c + 1) % 3, (c + 2) % 3);
            sum[c] += f[c];
            sum[3 + c] += x[d] * f[e] - x[e] * f[d];
        }
    }
    sum
}

/// A force along a curved edge has its resultant exactly, and the moment of one spread evenly by length to fourth
/// order; refinement keeps the edge and its length.
#[test]
fn a_force_along_an_edge_is_spread_by_length() {
    // Half an ellipse with the semi-axes 1 and 1.5, by the midpoint rule, which is of spectral accuracy here.
    let (mut length, mut height) = (0.0, 0.0);
    for i in 0..2000 {
        let angle = std::f64::consts::PI * (f64::from(i) + 0.5) / 2000.0;
        let element = angle.sin().hypot(1.5 * angle.cos()) * std::f64::consts::PI / 2000.0;
        (length, height) = (length + element, height + 1.5 * angle.sin() * element);
    }
    let mut errors = Vec::new();
    for n in [4, 8, 16] {
        let mesh = mesh::parse("inp", bent(n).as_bytes()).unwrap().mesh;
        assert_eq!((mesh.edges["Rim"].len(), mesh.edges["Tips"].len(), mesh.edges.len()), (n, 2, 2));
        assert_eq!(mesh.facets.keys().collect::<Vec<_>>(), ["Root"]);
        let moment = |mesh: &Mesh| {
            let load = forms::f(mesh, &[], &[BoundaryCondition::on("Rim").force([0.0, 0.0, 7.0])]).at(0.0);
            let [fx, fy, fz, mx, my, mz] = resultant(mesh, &load);
            assert!(largest(&[fx, fy, fz - 7.0, my, mz]) < 1e-13, "{:?}", resultant(mesh, &load));
            mx
        };
        let found = moment(&mesh);
        errors.push((found / (7.0 * height / length) - 1.0).abs());
        let finer = mesh.refined().unwrap();
        assert_eq!((finer.edges["Rim"].len(), finer.edges["Tips"].len()), (2 * n, 2));
        assert!((moment(&finer) - found).abs() < 1e-4 * found);
    }
    let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    assert!(orders.iter().all(|order| (3.7..5.0).contains(order)), "{errors:?} {orders:?}");
}

/// Points share a force in equal parts, and a refused condition names its place.
#[test]
fn points_of_a_file_share_a_force() {
    let mesh = mesh::parse("inp", bent(3).as_bytes()).unwrap().mesh;
    let load = forms::f(&mesh, &[], &[BoundaryCondition::on("Tips").force([0.0, 8.0, 0.0])]).at(0.0);
    let loaded: Vec<f64> = load.iter().copied().filter(|f| *f != 0.0).collect();
    assert_eq!(loaded, [4.0, 4.0]);
}

/// Gmsh's physical points and curves, by name and number; one of a point that is no node of the body is none.
#[test]
fn gmsh_names_points_and_edges() {
    let msh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n0 5 \"tip\"\n1 6 \"ridge\"\n0 8 \"centre\"\n$EndPhysicalNames\n\
         $Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 9 9 9\n$EndNodes\n$Elements\n5\n\
         1 4 2 1 1 1 2 3 4\n2 2 2 7 1 1 3 2\n3 1 2 6 1 1 4\n4 15 2 5 1 4\n5 15 2 8 1 5\n$EndElements\n";
    let mesh = mesh::parse("msh", msh.as_bytes()).unwrap().mesh;
    assert_eq!(mesh.facets.keys().collect::<Vec<_>>(), ["7"]);
    let edges: Vec<(&str, Vec<u32>)> = mesh.edges.iter().map(|(name, set)| (name.as_str(), set.node_list())).collect();
    assert_eq!(edges, [("ridge", vec![0, 3]), ("tip", vec![3])]);
    assert_eq!(mesh.points.len(), 4);
}

/// A temperature at a point, and where it is a node of a contact side.
#[test]
fn a_point_of_the_contact_may_be_held() {
    let text = body(
        "kind = \"rectangle\"\nsize = [1, 1]\nn = 4",
        "heat_capacity = 1\nconductivity = 1\n[[boundary]]\nat = [0.5, 0]\ndisplacement = [0, \"free\"]\ntemperature = 3\n\
         [[boundary]]\non = \"top\"\nforce = [0, -5]\n[contact]\non = \"bottom\"\nnormal = { law = \"signorini\" }\n",
    );
    let case = case::parse(&source(&text, &[]), &[]).unwrap_or_else(|e| panic!("{e}"));
    let memory = solve(&case.problem);
    let state = &memory.states.last().unwrap();
    // An even pressure of 5, in plane stress, about the axis x = 0.5.
    let (young, poisson) = (1000.0, 0.25);
    for (x, u) in case.problem.mesh.points.iter().zip(state.u.chunks_exact(2)) {
        assert!(
            (u[1] + 5.0 / young * x[1]).abs() < 1e-14 && (u[0] - poisson * 5.0 / young * (x[0] - 0.5)).abs() < 1e-14
        );
    }
    assert!((memory.reports.last().unwrap().contact.force[1].abs() - 5.0).abs() < 1e-12);
    let middle = case.problem.mesh.points.iter().position(|x| (x[0] - 0.5).hypot(x[1]) < 1e-12).unwrap();
    assert!((state.theta[middle] - 3.0).abs() < 1e-15);
}

const CASE: &str = "name = \"points\"\n[mesh]\nkind = \"rectangle\"\nsize = [2.0, 1.0]\nn = 2\n[time]\nend = 1.0\nsteps = 1\n\
    [material]\ndensity = 0\nelasticity = { law = \"isotropic\", young = 1.0, poisson = 0.0, stress_state = \"plane-stress\" }\n[[boundary]]\n\
    on = \"left\"\ndisplacement = [0, 0]\n[[boundary]]\nat = [2.0, 0.5]\nforce = [\"1 kN\", 0]\n";

#[test]
fn faults_have_their_place() {
    for (old, new, said) in [
        (
            "[2.0, 0.5]",
            "[2.0, 0.4]",
            "points.toml:16:6: boundary[1].at: found no node at these coordinates, expected those of a node; the nearest one is at x = 2.0, y = 0.5; a mesh with a node there has a vertex of a cell at it",
        ),
        ("[2.0, 0.5]", "[2.0]", "points.toml:16:6: boundary[1].at: found 1 coordinates, expected 2 coordinates"),
        (
            "at = [2.0, 0.5]",
            "at = [2.0, 0.5]\non = \"right\"",
            "points.toml:15:1: boundary[1]: found `on` and `at`, expected one of both: `on`, the name of a side, or `at`, the coordinates of a node",
        ),
        (
            "at = [2.0, 0.5]\n",
            "",
            "points.toml:15:1: boundary[1]: found neither `on` nor `at`, expected one of both: `on`, the name of a side, or `at`, the coordinates of a node",
        ),
        (
            "force = [\"1 kN\", 0]",
            "traction = [1, 0]",
            "points.toml:17:12: boundary[1].traction: found a traction on \"point (2.0, 0.5)\", which has no area, expected `displacement`, `force` or `temperature` on an edge or on points; give it on a side, or a `force`",
        ),
        (
            "force = [\"1 kN\", 0]",
            "force = [\"1 kPa\", 0]",
            "points.toml:17:10: boundary[1].force[0]: found \"1 kPa\", expected a quantity in N or in a unit that converts to it (force in N, one entry per component, spread evenly over the side)",
        ),
        (
            "force = [\"1 kN\", 0]",
            "force = [1]",
            "points.toml:17:9: boundary[1].force: found 1 components, expected 2 components",
        ),
        (
            "force = [\"1 kN\", 0]",
            "force = [1, 0]\ndisplacement = [0, 0]",
            "points.toml:17:9: boundary[1].force: found a force besides a displacement, expected one of the two: Γ_D and Γ_N do not overlap; remove one of them",
        ),
        (
            "force = [\"1 kN\", 0]",
            "force = [1, 0]\ndisplacement = [0, \"free\"]",
            "points.toml:17:10: boundary[1].force[0]: found a force in a direction whose displacement is prescribed, expected one of the two: Γ_D and Γ_N do not overlap; set it to 0",
        ),
    ] {
        assert_eq!(told(&source(&spoil(CASE, old, new), &[]), &[]), said, "{new}");
    }
}

/// A node where two bodies touch is none that a point may mean; a name of points is none that contact may have.
#[test]
fn points_are_of_one_body_and_bear_no_contact() {
    let blocks = "kind = \"blocks\"\nblocks = [ { name = \"a\", size = [1, 1], n = [1, 1] }, { name = \"b\", size = [1, 1], n = [1, 1], origin = [0, 1] } ]";
    let conditions = "[[boundary]]\non = \"a_bottom\"\ndisplacement = [0, 0]\n[[boundary]]\nat = [0, 1]\nforce = [0, 1]\n\
        [[boundary]]\non = \"b_top\"\ndisplacement = [0, 0]\n";
    let said = told(&source(&body(blocks, conditions), &[]), &[]);
    assert!(
        said.contains("boundary[1].at: found 2 nodes at these coordinates, expected one node; bodies that touch each have a node there"),
        "{said}"
    );
    let text = body(
        "kind = \"file\"\nfile = \"bent.inp\"",
        "[[boundary]]\non = \"Root\"\ndisplacement = [0, 0, 0]\n[contact]\non = \"Rim\"\nnormal = { law = \"signorini\" }\n",
    );
    let said = told(&source(&text, &[("bent.inp", &bent(2))]), &[]);
    assert!(said.contains("contact.on: found \"Rim\", expected one of the facet sets Root"), "{said}");
    let text = spoil(
        &text,
        "[contact]\non = \"Rim\"\nnormal = { law = \"signorini\" }\n",
        "[[boundary]]\non = \"Rmi\"\nforce = [1, 0, 0]\n",
    );
    let said = told(&source(&text, &[("bent.inp", &bent(2))]), &[]);
    assert!(
        said.contains("boundary[1].on: found \"Rmi\", expected one of the sides, edges and points Root, Rim, Tips; did you mean \"Rim\"?"),
        "{said}"
    );
}

/// A force on a point, or in space along an edge, is warned of; one on a side is not.
#[test]
fn a_force_without_area_is_warned_of() {
    let warned = |text: &str, files: &[(&str, &str)]| {
        let case = case::parse(&source(text, files), &[]).unwrap_or_else(|e| panic!("{e}"));
        let found = findings(&case.problem).into_iter().find(|f| f.id.as_str() == "point-force");
        found.map(|f| (f.place.clone(), f.value, f.needed))
    };
    assert_eq!(warned(CASE, &[]), Some(("boundary[1].force".to_owned(), Some(0.0), Some(1.0))));
    assert_eq!(warned(&spoil(CASE, "at = [2.0, 0.5]", "on = \"right\""), &[]), None);
    assert_eq!(warned(&spoil(CASE, "force = [\"1 kN\", 0]", "displacement = [1, \"free\"]"), &[]), None);
    let bent = bent(2);
    let text = body(
        "kind = \"file\"\nfile = \"bent.inp\"",
        "[[boundary]]\non = \"Root\"\ndisplacement = [0, 0, 0]\n[[boundary]]\non = \"Rim\"\nforce = [0, 0, 1]\n",
    );
    assert_eq!(warned(&text, &[("bent.inp", &bent)]), Some(("boundary[1].force".to_owned(), Some(1.0), Some(2.0))));
}
