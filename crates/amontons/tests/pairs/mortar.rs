//! The rows of pairs against two independent programs (`reference/two-bodies/mortar.csv`) and exact integrals.

use std::collections::{BTreeMap, BTreeSet};

use crate::common;
use amontons::case::{self, Source};
use amontons::contact::Supports;
use amontons::contact::mortar::{FacingSides, Mortar, MortarRow};
use amontons::element::P1_SEGMENT;
use amontons::mesh::{Block, FacetSet, Mesh};
use amontons::tensor::Point;

/// A node by its coordinates, rounded.
type Place = [i64; 3];

fn place(x: &Point) -> Place {
    x.map(|c| (c * 1e9).round() as i64)
}

/// A row of the table: matrix, places of row and column, value.
struct Entry {
    matrix: String,
    row: Point,
    column: Point,
    value: f64,
}

fn table() -> BTreeMap<String, Vec<Entry>> {
    let text = std::fs::read_to_string(common::file("crates/amontons/tests/reference/two-bodies/mortar.csv"));
    let text = text.expect("the table");
    let mut all: BTreeMap<String, Vec<Entry>> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let (name, rest) = match line.strip_prefix('"') {
            Some(quoted) => quoted.split_once("\",").expect("a name in quotes"),
            None => line.split_once(',').expect("a name"),
        };
        let cells: Vec<&str> = rest.split(',').collect();
        let number = |i: usize| if cells[i].is_empty() { 0.0 } else { cells[i].parse().expect("a number") };
        let point = |first: usize| [number(first), number(first + 1), number(first + 2)];
        let entry = Entry { matrix: cells[0].to_owned(), row: point(1), column: point(4), value: number(7) };
        all.entry(name.to_owned()).or_default().push(entry);
    }
    all
}

/// Two polygons with sides of P1 segments; the upper one is traversed from right to left.
fn polygons(lower: &[Point], upper: &[Point]) -> (Mesh, [FacetSet; 2]) {
    let points: Vec<Point> = lower.iter().chain(upper).copied().collect();
    let side = |nodes: Vec<u32>| {
        let segments = nodes.windows(2).flat_map(|pair| pair.iter().copied()).collect();
        FacetSet::of(&P1_SEGMENT, segments)
    };
    let n = lower.len() as u32;
    let sides = [side((0..n).rev().collect()), side((n..n + upper.len() as u32).collect())];
    (mesh_of(2, points), sides)
}

fn mesh_of(dim: usize, points: Vec<Point>) -> Mesh {
    let blocks: Vec<Block> = Vec::new();
    Mesh {
        dim,
        axisymmetric: false,
        thickness: None,
        points,
        blocks,
        regions: Vec::new(),
        facets: BTreeMap::new(),
        edges: BTreeMap::new(),
    }
}

fn assert_rows(name: &str, entries: &[Entry], mesh: &Mesh, rows: &[MortarRow]) {
    let mut found: BTreeMap<(String, Place, Place), f64> = BTreeMap::new();
    let mut add = |matrix: &str, row: u32, column: Option<u32>, value: f64| {
        let at = |node: u32| place(&mesh.points[node as usize]);
        found.insert((matrix.to_owned(), at(row), column.map_or([0; 3], at)), value);
    };
    for row in rows {
        row.own.iter().for_each(|&(j, share)| add("D", row.node, Some(j), share * row.weight));
        row.other.iter().for_each(|&(l, share)| add("M", row.node, Some(l), share * row.weight));
        add("gap", row.node, None, row.gap);
        for (c, axis) in ["x", "y", "z"].into_iter().enumerate().take(mesh.dim) {
            add(&format!("normal_{axis}"), row.node, None, row.normal[c]);
        }
    }
    // The table has the geometry of nodes without a multiplier as well.
    let bears = |at: &Point| rows.iter().any(|row| place(&mesh.points[row.node as usize]) == place(at));
    for Entry { matrix, row, column, value } in entries.iter().filter(|entry| bears(&entry.row)) {
        let key = (matrix.clone(), place(row), place(column));
        let computed = found.remove(&key).unwrap_or_else(|| panic!("{name}: no {matrix} at {row:?}, {column:?}"));
        assert!((computed - value).abs() < 1e-14, "{name}, {matrix} at {row:?}, {column:?}: {computed:e}, {value:e}");
    }
    for (key, value) in &found {
        assert!(value.abs() < 1e-14, "{name}: {key:?} = {value:e} is not in the table");
    }
}

/// The nodes of rows and columns, by x.
fn sorted(entries: &[Entry], matrix: &str, of: fn(&Entry) -> Point) -> Vec<Point> {
    let mut points: Vec<Point> = entries.iter().filter(|e| e.matrix == matrix).map(of).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points.dedup_by(|a, b| place(a) == place(b));
    points
}

/// Held in every direction.
const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Rows of sides that are partly covered join their rims: `formulation` has those.
#[test]
fn rows_in_the_plane_are_those_of_two_independent_programs() {
    for (name, entries) in table().iter().filter(|(name, _)| *name != "bricks" && !name.starts_with("partly covered")) {
        let mortar = sorted(entries, "M", |e| e.column);
        let mut nonmortar = sorted(entries, "D", |e| e.column);
        nonmortar.dedup_by(|a, b| place(a) == place(b));
        let is_below = name.contains("below");
        let (mesh, [lower, upper]) =
            if is_below { polygons(&nonmortar, &mortar) } else { polygons(&mortar, &nonmortar) };
        let first_prescribed = name.contains("first node prescribed");
        let first = mesh.points.len() - nonmortar.len();
        // Both bodies are held there.
        let at = |node: usize| place(&mesh.points[node]);
        let held = |node: u32| if first_prescribed && at(node as usize) == at(first) { AXES } else { [[0.0; 3]; 3] };
        let (nonmortar, mortar) = if is_below { (&lower, &upper) } else { (&upper, &lower) };
        let supports = Supports { held: &held, ..Supports::NONE };
        let sides = FacingSides { mesh: &mesh, x: &mesh.points, nonmortar, mortar, supports, keeps_all: false };
        assert_rows(name, entries, &mesh, &Mortar::new(&sides).rows);
    }
}

#[test]
fn rows_in_space_are_those_of_two_independent_programs() {
    let case = common::case("crates/amontons/tests/reference/two-bodies/cases/h-bricks.toml", &[]);
    let mesh = &case.problem.mesh;
    let sides = FacingSides {
        mesh,
        x: &mesh.points,
        nonmortar: &mesh.facets["upper_bottom"],
        mortar: &mesh.facets["lower_top"],
        supports: Supports::NONE,
        keeps_all: false,
    };
    assert_rows("bricks", &table()["bricks"], mesh, &Mortar::new(&sides).rows);
}

/// Nodes 0, 5/4, 2 against 0, 1, 2: D = diag(5/8, 1, 3/8) and M in exact rationals, entries below zero among them.
#[test]
fn exact_rationals_on_one_line() {
    let line = |x: [f64; 3]| x.map(|x| [x, 0.0, 0.0]);
    let (mesh, [lower, upper]) = polygons(&line([0.0, 1.0, 2.0]), &line([0.0, 1.25, 2.0]));
    let sides = FacingSides {
        mesh: &mesh,
        x: &mesh.points,
        nonmortar: &upper,
        mortar: &lower,
        supports: Supports::NONE,
        keeps_all: false,
    };
    let made = Mortar::new(&sides);
    let m = [[0.6, 0.05, -0.025], [-0.1, 0.95, 0.15], [0.0, 0.0, 0.375]];
    for ((row, weight), m) in made.rows.iter().zip([0.625, 1.0, 0.375]).zip(m) {
        assert!((row.weight - weight).abs() < 1e-15 && row.own.len() == 1 && (row.own[0].1 - 1.0).abs() < 1e-15);
        for (l, m) in m.into_iter().enumerate() {
            let found: f64 = row.other.iter().filter(|(node, _)| *node == l as u32).map(|(_, p)| p * row.weight).sum();
            assert!((found - m).abs() < 1e-15, "{found}, {m}");
        }
    }
    assert!((made.measure - 2.0).abs() < 1e-15 && (made.covered - 2.0).abs() < 1e-15);
}

/// Sides that a body of linear, quadratic, triangular or quadrilateral cells has: Σ D_ij = Σ M_il = ω_i; linear
/// functions have no jump on a flat interface; a uniform pressure is its consistent load on both sides.
#[test]
fn rows_reproduce_linear_functions_and_uniform_pressures() {
    use amontons::mesh::{Diagonal, Elements};
    let elements = [Elements::P1, Elements::P2, Elements::Q1, Elements::Q2];
    let plane = |e, n| Mesh::rectangle_of(e, [1.0, 1.0], [n, 2], Diagonal::Left).expect("a mesh");
    let space = |e, n| Mesh::box_([1.0, 1.0, 1.0], [n, 1, n + 1], e).expect("a mesh");
    for own in elements {
        for other in elements {
            assert_pair(&plane(own, 3), &plane(other, 4), &format!("{own:?} on {other:?} in the plane"));
            assert_pair(&space(own, 2), &space(other, 3), &format!("{own:?} on {other:?} in space"));
        }
    }
}

/// The same on facets that are no parallelograms, as meshes of quadrilaterals have them: the functions of one side on
/// those of the other are then no polynomials.
#[test]
fn rows_reproduce_them_on_facets_of_any_shape() {
    use amontons::mesh::Elements;
    let mut random = common::Random(7);
    let mut shaken = |elements, n: usize| {
        let mut mesh = Mesh::box_([1.0, 1.0, 1.0], [n, 1, n + 1], elements).expect("a mesh");
        let is_inside = |c: f64| c > 1e-9 && c < 1.0 - 1e-9;
        for x in mesh.points.iter_mut().filter(|x| is_inside(x[0]) && is_inside(x[2])) {
            [x[0], x[2]] = [x[0], x[2]].map(|c| c + 0.3 * random.number() / (n + 1) as f64);
        }
        mesh
    };
    for (own, other) in [Elements::P1, Elements::Q1].into_iter().flat_map(|e| [(e, Elements::P1), (e, Elements::Q1)]) {
        for _ in 0..5 {
            assert_pair(&shaken(own, 3), &shaken(other, 4), &format!("{own:?} on {other:?}, shaken"));
        }
    }
}

/// `upper` stands on `lower`, its bottom on the top of that, both turned about an axis askew.
fn assert_pair(upper: &Mesh, lower: &Mesh, name: &str) {
    let dim = upper.dim;
    let turn = |x: Point| -> Point {
        let (c, s) = (0.3f64.cos(), 0.3f64.sin());
        let [x, y, z] = [c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]];
        if dim == 2 { [x, y, 0.0] } else { [x, c * y - s * z, s * y + c * z] }
    };
    let n = lower.points.len() as u32;
    let raised = upper.points.iter().map(|x| [x[0], x[1] + 1.0, x[2]]);
    let mut mesh = mesh_of(dim, lower.points.iter().copied().chain(raised).map(turn).collect());
    mesh.axisymmetric = false;
    let mut bottom = upper.facets["bottom"].clone();
    bottom.blocks.iter_mut().for_each(|block| block.nodes.iter_mut().for_each(|node| *node += n));
    let top = lower.facets["top"].clone();
    let sides = FacingSides {
        mesh: &mesh,
        x: &mesh.points,
        nonmortar: &bottom,
        mortar: &top,
        supports: Supports::NONE,
        keeps_all: false,
    };
    let made = Mortar::new(&sides);
    assert!((made.covered - made.measure).abs() < 1e-12, "{name}: {} of {}", made.covered, made.measure);
    let mut loads: BTreeMap<u32, f64> = BTreeMap::new();
    for row in &made.rows {
        let sum = |shares: &[(u32, f64)]| shares.iter().map(|(_, share)| share).sum::<f64>();
        assert!(row.weight > 0.0, "{name}");
        assert!((sum(&row.own) - 1.0).abs() < 1e-12 && (sum(&row.other) - 1.0).abs() < 1e-12, "{name}");
        for c in 0..dim {
            let at = |shares: &[(u32, f64)]| shares.iter().map(|&(i, s)| s * mesh.points[i as usize][c]).sum::<f64>();
            assert!((at(&row.own) - at(&row.other)).abs() < 1e-12, "{name}: jump of a linear function");
        }
        assert!(row.gap.abs() < 1e-12, "{name}");
        for (shares, sign) in [(&row.own, 1.0), (&row.other, -1.0)] {
            for &(node, share) in shares {
                *loads.entry(node).or_default() += sign * row.weight * share;
            }
        }
    }
    // ∫N over both sides.
    for (set, sign) in [(&bottom, 1.0), (&top, -1.0)] {
        for (element, nodes) in set.facets() {
            let table = amontons::element::ShapeTable::new(element, 4);
            let mut map = amontons::mesh::FacetMap::new(&mesh, &table);
            for q in 0..table.len() {
                map.at(nodes, q);
                for (node, value) in nodes.iter().zip(table.values(q)) {
                    *loads.entry(*node).or_default() -= sign * table.weights[q] * map.area * value;
                }
            }
        }
    }
    let off = loads.values().fold(0.0, |most: f64, load| most.max(load.abs()));
    assert!(off < 1e-12, "{name}: the load of a uniform pressure is off by {off:e}");
}

/// Of two facets behind each other the nearer one is faced; a facet that turns its back is not.
#[test]
fn the_nearest_facet_is_faced() {
    let line = |x: &[f64], y: f64| x.iter().map(|&x| [x, y, 0.0]).collect::<Vec<_>>();
    let (mut mesh, [lower, upper]) = polygons(&line(&[0.0, 1.0, 2.0], -0.1), &line(&[0.0, 1.0, 2.0], 0.0));
    let first = mesh.points.len() as u32;
    mesh.points.extend(line(&[0.2, 1.4], -0.5));
    mesh.points.extend(line(&[0.0, 2.0], -0.05));
    let mut mortar = lower;
    // One behind the lower side, one in front of it that looks away.
    mortar.push(&P1_SEGMENT, [first + 1, first]);
    mortar.push(&P1_SEGMENT, [first + 2, first + 3]);
    let sides = FacingSides {
        mesh: &mesh,
        x: &mesh.points,
        nonmortar: &upper,
        mortar: &mortar,
        supports: Supports::NONE,
        keeps_all: false,
    };
    let made = Mortar::new(&sides);
    let faced: BTreeSet<u32> = made.rows.iter().flat_map(|row| row.other.iter().map(|(node, _)| *node)).collect();
    assert!(faced.into_iter().eq(0..3));
    assert!(made.rows.iter().all(|row| (row.gap - 0.1).abs() < 1e-15));
    assert!((made.covered - 2.0).abs() < 1e-15);
}

/// A node that nothing faces is no contact point, and has no weight where all are asked for.
#[test]
fn uncovered_nodes_have_no_weight() {
    let line = |x: &[f64]| x.iter().map(|&x| [x, 0.0, 0.0]).collect::<Vec<_>>();
    let (mesh, [lower, upper]) = polygons(&line(&[0.0, 1.0]), &line(&[0.0, 1.0, 2.0, 3.0]));
    let sides = FacingSides {
        mesh: &mesh,
        x: &mesh.points,
        nonmortar: &upper,
        mortar: &lower,
        supports: Supports::NONE,
        keeps_all: false,
    };
    assert_eq!(Mortar::new(&sides).rows.len(), 2);
    let all = Mortar::new(&FacingSides { keeps_all: true, ..sides }).rows;
    for (row, weight) in all.iter().zip([0.5, 0.5, 0.0, 0.0]) {
        assert!((row.weight - weight).abs() < 1e-15);
    }
    assert!(all[2].gap >= 3.0 && all[3].other.is_empty());
}

/// Blocks anywhere on triangles in space: a point has at least 0.7 of a third of a triangle, also where all neighbours
/// of a sliver are slivers, as at the corners of a block; and all have the area of the block together.
#[test]
fn no_point_has_the_weight_of_a_sliver() {
    let mut random = common::Random(11);
    for _ in 0..60 {
        let [x, z] = [(); 2].map(|()| 0.6 + 0.5 * random.number());
        let length = 0.65 + 0.25 * random.number();
        let text = format!(
            "name = \"sliver\"\n[mesh]\nkind = \"blocks\"\nblocks = [\n\
             {{ name = \"table\", size = [2.0, 1.0, 2.0], n = [14, 1, 14], elements = \"P1\" }},\n\
             {{ name = \"above\", size = [{length:?}, 0.7, {length:?}], origin = [{x:?}, 1.0, {z:?}], n = [3, 1, 3] }},\n]\n\
             [time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 1\n\
             elasticity = {{ law = \"isotropic\", young = 1000, poisson = 0.25 }}\n\
             [contact]\non = \"above_bottom\"\nwith = \"table_top\"\nnonmortar = \"table_top\"\n\
             normal = {{ law = \"signorini\" }}\n"
        );
        let read = case::parse(&Source::new("sliver.toml", &text), &[]).unwrap_or_else(|error| panic!("{error}"));
        let points = read.problem.contact_boundary().points;
        let weights: Vec<f64> = points.iter().map(|point| point.weight).filter(|weight| *weight > 0.0).collect();
        let (least, sum) = (weights.iter().copied().fold(f64::INFINITY, f64::min), weights.iter().sum::<f64>());
        let triangle = 0.5 / 49.0;
        assert!(least > 0.7 / 3.0 * triangle * (1.0 - 1e-9), "{x}, {z}, {length}: {least:e} of {triangle:e}");
        assert!((sum / (length * length) - 1.0).abs() < 1e-12, "{x}, {z}, {length}: {sum}");
    }
}

/// A strip that is narrower than the facets that bear its points has laws along all of its length: the length of the
/// strip between two of them is no more than four facets, and the resultant of a linear pressure keeps its place.
#[test]
fn a_strip_of_slivers_has_points_along_its_length() {
    let mut random = common::Random(17);
    for elements in ["P1", "Q1"] {
        for _ in 0..12 {
            let (width, x) = (0.1 + 0.04 * random.number(), 0.77 + 0.02 * random.number());
            let text = format!(
                "name = \"strip\"\n[mesh]\nkind = \"blocks\"\nblocks = [\n\
                 {{ name = \"table\", size = [2.0, 1.0, 3.0], n = [8, 1, 12], elements = \"{elements}\" }},\n\
                 {{ name = \"above\", size = [{width:?}, 0.3, 2.4], origin = [{x:?}, 1.0, 0.3], n = [1, 1, 9] }},\n]\n\
                 [time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 1\n\
                 elasticity = {{ law = \"isotropic\", young = 1000, poisson = 0.25 }}\n\
                 [contact]\non = \"above_bottom\"\nwith = \"table_top\"\nnonmortar = \"table_top\"\n\
                 normal = {{ law = \"signorini\" }}\n"
            );
            let read = case::parse(&Source::new("strip.toml", &text), &[]).unwrap_or_else(|error| panic!("{error}"));
            let points = read.problem.contact_boundary().points;
            let bearing: Vec<(f64, f64)> =
                points.iter().filter(|point| point.weight > 0.0).map(|point| (point.x[2], point.weight)).collect();
            let area: f64 = bearing.iter().map(|(_, weight)| weight).sum();
            assert!((area - 2.4 * width).abs() < 1e-12, "{elements}, {width}, {x}: {area}");
            let mut along: Vec<f64> = bearing.iter().map(|(z, _)| *z).chain([0.3, 2.7]).collect();
            along.sort_by(f64::total_cmp);
            let widest = along.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
            assert!(widest <= 1.0 + 1e-12, "{elements}, {width}, {x}: {along:?}");
        }
    }
}
