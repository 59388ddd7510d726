//! Cyclic symmetry: a sector does what it does in the whole of which it is a part.

use std::sync::Arc;

use crate::at_rest::{parse, settings};
use crate::common::{changed, largest, spoil, told};
use amontons::case::Source;
use amontons::element::P1_TRIANGLE;
use amontons::field::Field;
use amontons::hypotheses::full;
use amontons::mesh::defects::components;
use amontons::mesh::{Cyclic, Diagonal, Elements, FacetSet, Mesh, NotCyclic};
use amontons::model::rigid_motions;
use amontons::output::Memory;
use amontons::problem::{BoundaryCondition, Problem};
use amontons::run::run;
use amontons::tensor::{Point, length};

const BODY: &str = "[time]\nend = 0.4\nsteps = 4\n\
    [material]\ndensity = 1\nheat_capacity = 1\nconductivity = 1\nexpansion = 0.3\ncoupling = 0.2\n\
    elasticity = { law = \"isotropic\", young = 100.0, poisson = 0.3STATE }\n\
    viscosity = { law = \"lame\", first = 0.1, second = 0.2 }\n";

/// Sectors about z through the origin.
const Z: Cyclic = Cyclic { sides: [String::new(), String::new()], through: [0.0; 3], axis: [0.0, 0.0, 2.0] };

/// A run with all its states.
fn solved(problem: &Problem) -> Memory {
    let mut memory = Memory::new().states_every(1).reports();
    run(problem, &settings(), &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}"));
    memory
}

/// The node of a mesh at each node of a sector, moved.
fn places(sector: &Mesh, whole: &Mesh, by: Point) -> Vec<usize> {
    let of = |x: &Point| {
        let found = (0..whole.points.len())
            .find(|&i| length(&std::array::from_fn(|c| whole.points[i][c] - x[c] - by[c])) < 1e-9);
        found.unwrap_or_else(|| panic!("no node at {x:?}"))
    };
    sector.points.iter().map(of).collect()
}

/// The same for several bodies, of which nodes may be at one place.
fn places_of_bodies(sector: &Problem, whole: &Problem) -> Vec<usize> {
    let [parts, bodies] = [sector, whole].map(|problem| components(&problem.mesh));
    let mut places = vec![usize::MAX; sector.mesh.points.len()];
    for (part, body) in parts.iter().zip(&bodies) {
        for &node in &part.nodes {
            let x = sector.mesh.points[node as usize];
            let near = |y: &Point| length(&std::array::from_fn(|c| y[c] - x[c])) < 1e-9;
            places[node as usize] =
                *body.nodes.iter().find(|&&other| near(&whole.mesh.points[other as usize])).unwrap() as usize;
        }
    }
    places
}

/// All fields of a sector, and what happens at its contact points, are those of the whole.
fn assert_same(sector: &Problem, whole: &Problem, by: Point, tolerance: f64) {
    let nodes = places(&sector.mesh, &whole.mesh, by);
    let [part, all] = [sector, whole].map(solved);
    let dim = sector.mesh.dim;
    assert_eq!(part.states.len(), all.states.len());
    for (part, all) in part.states.iter().zip(&all.states) {
        for (name, part, all, n) in
            [("u", &part.u, &all.u, dim), ("w", &part.w, &all.w, dim), ("θ", &part.theta, &all.theta, 1)]
        {
            let there: Vec<f64> = nodes.iter().flat_map(|&node| &all[node * n..(node + 1) * n]).copied().collect();
            let error: Vec<f64> = part.iter().zip(&there).map(|(a, b)| a - b).collect();
            assert!(largest(&error) <= tolerance * largest(&there), "{name}: {:e}", largest(&error) / largest(&there));
        }
    }
    let [on_part, on_all] = [sector, whole].map(|problem| problem.contact_boundary());
    let scale = all.reports.iter().flat_map(|r| &r.contact.states).fold(0.0f64, |m, s| m.max(s.pressure));
    assert!(scale > 0.0, "nothing touches");
    for (part, all) in part.reports.iter().zip(&all.reports) {
        for (point, state) in on_part.points.iter().zip(&part.contact.states) {
            let node = nodes[on_part.nodes[point.nodes[0].0] as usize];
            let there = on_all.points.iter().position(|p| on_all.nodes[p.nodes[0].0] as usize == node).unwrap();
            let (normal, other) = (on_all.points[there].normal, &all.contact.states[there]);
            assert!(length(&std::array::from_fn(|c| point.normal[c] - normal[c])) < 1e-12, "ν at {:?}", point.x);
            assert_eq!(state.status, other.status, "at {:?}", point.x);
            let q = length(&std::array::from_fn(|c| state.q[c] - other.q[c]));
            let p = (state.pressure - other.pressure).abs();
            assert!(p.max(q) <= 100.0 * tolerance * scale, "traction at {:?}: {p:e} {q:e} of {scale:e}", point.x);
        }
    }
}

/// A quarter of a ring, or the ring, pressed from inside into a bore that turns, with loads that four sectors share.
fn ring(elements: &str, normal: &str, is_whole: bool, more: &str) -> String {
    let (angle, around) = if is_whole { (String::new(), 24) } else { ("angle = 1.5707963267948966\n".to_owned(), 6) };
    let four = "(x^4 - 6*x^2*y^2 + y^4)/(x^2 + y^2)^2";
    let cyclic = if is_whole { "" } else { "[[cyclic]]\nsides = [\"start\", \"end\"]\n" };
    format!(
        "name = \"ring\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"ring\"\nradii = [1.0, 2.0]\n{angle}n = [3, {around}]\nelements = \"{elements}\"\n\
         {}{cyclic}[load]\nheat_source = \"1 + {four}\"\n\
         [[boundary]]\non = \"inner\"\npressure = \"50*t*(2 + {four})\"\nspring = 30\ntemperature = \"t*(1 + {four})\"\n\
         [contact]\non = \"outer\"\ngap = 0.3\nnormal = {normal}\nfriction = {{ law = \"coulomb\", coefficient = 0.3 }}\nfoundation_velocity = [\"-y\", \"x\"]\n\
         heat = {{ law = \"ramp\", conductance = 1, width = 1e-3, foundation_temperature = 0.5 }}\n{more}",
        BODY.replace("STATE", ", stress_state = \"plane-strain\""),
    )
}

const COMPLIANCE: &str = "{ law = \"compliance\", stiffness = 1e3 }";
const RIGID: &str = "{ law = \"signorini\" }";

/// In the plane, on a compliant and on a rigid foundation, with friction and heat, with a factor and
/// by an iteration.
#[test]
fn a_quarter_of_a_ring_does_what_the_ring_does() {
    for elements in ["Q1", "Q2"] {
        for normal in [COMPLIANCE, RIGID] {
            let [part, whole] = [false, true].map(|is_whole| parse(&ring(elements, normal, is_whole, "")).problem);
            assert_same(&part, &whole, [0.0; 3], 1e-10);
        }
    }
    let theta =
        |is_whole| ring("Q1", COMPLIANCE, is_whole, "").replace("steps = 4\n", "steps = 4\nscheme = \"theta\"\n");
    let [part, whole] = [false, true].map(|is_whole| parse(&theta(is_whole)).problem);
    assert_same(&part, &whole, [0.0; 3], 1e-10);
    let iterative = "[solver]\nsolver = \"iterative\"\n";
    let part = parse(&ring("Q1", RIGID, false, iterative)).problem;
    assert_same(&part, &parse(&ring("Q1", RIGID, true, "")).problem, [0.0; 3], 1e-9);
}

/// A half of a square, turned by 180°, with the centre on its side: the whole has u(−x) = −u(x).
#[test]
fn half_a_square_does_what_the_square_does() {
    for elements in ["P1", "P2", "Q2"] {
        let text = |height: f64, n: usize, origin: f64, sides: &str| {
            format!(
                "name = \"square\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"rectangle\"\nsize = [2.0, {height}]\nn = [8, {n}]\norigin = [-1.0, {origin}]\nelements = \"{elements}\"\n\
                 {}[contact]\non = \"top\"\nnormal = {COMPLIANCE}\nfriction = {{ law = \"coulomb\", coefficient = 0.3 }}\n\
                 heat = {{ law = \"ramp\", conductance = 1, width = 1e-3, foundation_temperature = 0.5 }}\nfoundation_velocity = [1, 0]\n\
                 [[boundary]]\non = \"left\"\ntraction = [\"5*y*t\", 3]\n[[boundary]]\non = \"right\"\ntraction = [\"5*y*t\", -3]\n{sides}",
                BODY.replace("STATE", ", stress_state = \"plane-strain\"")
            )
        };
        let pressed = "[load]\nbody_force = [0, \"y/abs(y + 1e-30)*20\"]\n";
        let half = parse(&text(1.0, 4, 0.0, pressed)).problem;
        let half = changed(&half, |data| {
            let mut mesh = Mesh::clone(&data.mesh);
            let bottom = mesh.facets.remove("bottom").unwrap();
            for (name, is_left) in [("first", false), ("second", true)] {
                let mut set = FacetSet { blocks: Vec::new() };
                for block in &bottom.blocks {
                    let nodes = block.nodes.chunks_exact(block.element.nodes.len()).filter(|facet| {
                        (mesh.points[facet[0] as usize][0] + mesh.points[facet[1] as usize][0] < 0.0) == is_left
                    });
                    set.blocks.extend(FacetSet::of(block.element, nodes.flatten().copied().collect()).blocks);
                }
                mesh.facets.insert(name.to_owned(), set);
            }
            data.mesh = Arc::new(mesh);
            let sides = ["first", "second"].map(str::to_owned);
            data.cyclic = vec![Cyclic { sides, ..Z }];
        });
        // Below, the foundation is turned, too: it moves the other way.
        let below = "[[contact]]\non = \"bottom\"";
        let whole = text(2.0, 8, -1.0, pressed).replace("[contact]\n", "[[contact]]\n");
        let (start, end) = (whole.find("[[contact]]").unwrap(), whole.find("[[boundary]]").unwrap());
        let twin = whole[start..end].replace("[[contact]]\non = \"top\"", below).replace("[1, 0]", "[-1, 0]");
        let whole = parse(&whole.replacen("[[boundary]]", &format!("{twin}[[boundary]]"), 1)).problem;
        assert_same(&half, &whole, [0.0; 3], 1e-10);
    }
}

/// A third of a tube, or the tube, pressed axially and twisted by the foundation that it stands on.
fn tube(mesh: &Mesh, more: &str) -> Problem {
    let text = format!(
        "name = \"tube\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"cylinder\"\nradii = [1.0, 2.0]\nheight = 1.0\nn = [2, 12, 2]\nelements = \"Q1\"\n{}\
         [[boundary]]\non = \"top\"\npressure = \"20*t\"\ntemperature = 1\n[[boundary]]\non = \"outer\"\nspring = 20\n\
         [contact]\non = \"bottom\"\nnormal = {RIGID}\nfriction = {{ law = \"coulomb\", coefficient = 0.2 }}\nfoundation_velocity = [\"-y\", \"x\", 0]\n\
         heat = {{ law = \"ramp\", conductance = 1, width = 1e-3, foundation_temperature = 0.5 }}\n{more}",
        BODY.replace("STATE", "")
    );
    changed(&parse(&text).problem, |data| {
        data.mesh = Arc::new(mesh.clone());
        if mesh.facets.contains_key("start") {
            data.cyclic = vec![Cyclic { sides: ["start", "end"].map(str::to_owned), ..Z }];
        }
    })
}

fn sector_of_tube() -> Mesh {
    Mesh::cylinder([1.0, 2.0], Some(std::f64::consts::TAU / 3.0), 1.0, [2, 4, 2], Elements::Q1).unwrap()
}

/// The sides of sectors that are generated match, in all elements.
#[test]
fn generated_sectors_match() {
    for elements in [Elements::P1, Elements::P2, Elements::Q1, Elements::Q2] {
        for n in 2..9 {
            let angle = Some(std::f64::consts::TAU / f64::from(n));
            let plane = Mesh::ring([1.0, 2.0], angle, [3, 2], elements).unwrap();
            let space = Mesh::cylinder([0.5, 2.0], angle, 0.7, [3, 2, 2], elements).unwrap();
            for mesh in [plane, space] {
                let sector = Cyclic { sides: ["start", "end"].map(str::to_owned), ..Z };
                assert_eq!(sector.links(&mesh).map(|(_, sectors)| sectors), Ok(n as usize), "{elements:?}, {n}");
            }
        }
    }
}

/// In space, with a factor and by an iteration.
#[test]
fn a_third_of_a_tube_does_what_the_tube_does() {
    let whole = tube(&Mesh::cylinder([1.0, 2.0], None, 1.0, [2, 12, 2], Elements::Q1).unwrap(), "");
    for (solver, tolerance) in [("direct", 1e-10), ("iterative", 1e-9)] {
        let part = tube(&sector_of_tube(), &format!("[solver]\nsolver = \"{solver}\"\n"));
        assert_same(&part, &whole, [0.0; 3], tolerance);
    }
}

/// The certificate can be made of a sector, and its findings on the step are those of the whole: a sector without
/// supports can turn about its axis, and nothing else.
#[test]
fn a_sector_is_judged() {
    let part = parse(&ring("P1", COMPLIANCE, false, "")).problem;
    let certificate = full(&part);
    assert!(!certificate.findings.is_empty());
}

/// What no support holds can turn about the axis, and in space move along it; everything else the sectors hinder each
/// other from.
#[test]
fn a_sector_without_supports_turns_about_its_axis() {
    let free = spoil(&ring("Q1", COMPLIANCE, false, ""), "spring = 30\n", "");
    let problem = parse(&free).problem;
    assert_eq!(rigid_motions(&problem, &components(&problem.mesh)), [1]);
    let tube = changed(&tube(&sector_of_tube(), ""), |data| data.boundary.clear());
    assert_eq!(rigid_motions(&tube, &components(&tube.mesh)), [2]);
}

/// A tyre on a hub, pressed and twisted, each with its own mesh.
fn tyre(cells: usize, is_whole: bool) -> Problem {
    let four = "(x^4 - 6*x^2*y^2 + y^4)/(x^2 + y^2)^2";
    let text = format!(
        "name = \"tyre\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"blocks\"\nblocks = [\n{{ name = \"hub\", radii = [1.0, 2.0], n = [{}, {}], elements = \"Q1\" }},\n\
         {{ name = \"tyre\", radii = [2.0, 3.0], n = [{}, {}], elements = \"Q1\" }}]\n{}\
         [[boundary]]\non = \"tyre_outer\"\npressure = \"20*t*(2 + {four})\"\nspring = [30, 30]\n[[boundary]]\non = \"hub_inner\"\nspring = 30\ntraction = [\"-y*5*t\", \"x*5*t\"]\n\
         [contact]\non = \"hub_outer\"\nwith = \"tyre_inner\"\nnormal = {RIGID}\nfriction = {{ law = \"coulomb\", coefficient = 0.4 }}\n\
         heat = {{ law = \"ramp\", conductance = 1, width = 1e-3 }}\n",
        cells,
        12 * cells,
        cells,
        16 * cells,
        BODY.replace("STATE", ", stress_state = \"plane-strain\"")
    );
    let whole = parse(&text).problem;
    if is_whole {
        return whole;
    }
    let quarter = Some(std::f64::consts::FRAC_PI_2);
    let [hub, tyre] = [([1.0, 2.0], 3), ([2.0, 3.0], 4)]
        .map(|(radii, around)| Mesh::ring(radii, quarter, [cells, around * cells], Elements::Q1).unwrap());
    changed(&whole, |data| {
        data.mesh = Arc::new(Mesh::assembly(&[("hub".to_owned(), hub), ("tyre".to_owned(), tyre)]).unwrap());
        data.cyclic = ["hub", "tyre"]
            .map(|body| Cyclic { sides: ["start", "end"].map(|side| format!("{body}_{side}")), ..Z })
            .to_vec();
    })
}

/// Two bodies: fields and pressures of the sector are those of the whole, also at the seam.
#[test]
fn a_pair_in_a_quarter_does_what_it_does_in_the_whole() {
    let differences = [2, 4, 8].map(|cells| {
        let [part, whole] = [false, true].map(|is_whole| tyre(cells, is_whole));
        let nodes = places_of_bodies(&part, &whole);
        let [part, whole] = [&part, &whole].map(solved);
        for (part, whole) in part.states.iter().zip(&whole.states) {
            let there: Vec<f64> = nodes.iter().flat_map(|&node| &whole.u[2 * node..2 * node + 2]).copied().collect();
            let error: Vec<f64> = part.u.iter().zip(&there).map(|(a, b)| a - b).collect();
            assert!(largest(&error) <= 1e-10 * largest(&there), "{:e}", largest(&error) / largest(&there));
        }
        let [part, whole] = [&part, &whole].map(|run| {
            let states = &run.reports.last().unwrap().contact.states;
            states.iter().fold(0.0f64, |most, state| most.max(state.pressure))
        });
        (part - whole).abs() / whole
    });
    assert!(differences.iter().all(|difference| *difference < 1e-9), "{differences:?}");
}

/// A sector about any line in space: turned and moved, with the axis and the loads along, it does the same.
#[test]
fn the_axis_may_be_any_line() {
    let (sector, direction) = (sector_of_tube(), [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0]);
    let plain = tube(&sector, "");
    // A rotation that takes z to the direction, from the half-way vector: v ↦ 2 (h·v) h − v.
    let half: Point = [direction[0], direction[1], direction[2] + 1.0];
    let size = length(&half);
    let half = half.map(|c| c / size);
    let turn = |v: &Point| -> Point {
        let along: f64 = (0..3).map(|c| half[c] * v[c]).sum();
        std::array::from_fn(|c| 2.0 * along * half[c] - v[c])
    };
    let by = [3.0, -1.0, 2.0];
    let mut moved = sector.clone();
    for x in &mut moved.points {
        *x = turn(x);
        (0..3).for_each(|c| x[c] += by[c]);
    }
    // The foundation turns about the axis: v = a × (x − by).
    let spin = (0..3).map(|c| {
        Field::of_space(move |x| {
            let [y, a] = [std::array::from_fn::<f64, 3, _>(|d| x[d] - by[d]), direction];
            a[(c + 1) % 3] * y[(c + 2) % 3] - a[(c + 2) % 3] * y[(c + 1) % 3]
        })
    });
    let spin: Vec<Field> = spin.collect();
    let turned = changed(&plain, |data| {
        data.mesh = Arc::new(moved);
        data.contacts[0].foundation_velocity = spin;
        data.cyclic[0] = Cyclic { through: by, axis: direction, ..data.cyclic[0].clone() };
    });
    let [plain, turned] = [&plain, &turned].map(|problem| solved(problem).states.pop().unwrap());
    let there: Vec<f64> = plain.u.chunks_exact(3).flat_map(|u| turn(&[u[0], u[1], u[2]])).collect();
    let error: Vec<f64> = there.iter().zip(&turned.u).map(|(a, b)| a - b).collect();
    assert!(largest(&error) <= 1e-10 * largest(&there), "{:e}", largest(&error) / largest(&there));
}

/// What is said of sectors that are none.
#[test]
fn a_sector_that_is_none_is_refused() {
    let sound = ring("Q1", COMPLIANCE, false, "");
    let sides = "sides = [\"start\", \"end\"]\n";
    for (old, new, message) in [
        (
            sides,
            "sides = [\"start\", \"inner\"]\n",
            "cyclic[0].sides[1]: found \"inner\", which has conditions in boundary[0], expected a side without conditions; the body goes on behind this side: remove the conditions; a plane of symmetry takes `normal_displacement = 0` instead of cyclic symmetry",
        ),
        (
            sides,
            "sides = [\"start\", \"ends\"]\n",
            "cyclic[0].sides[1]: found \"ends\", expected one of the facet sets end, inner, outer, start; did you mean \"end\"?",
        ),
        (
            sides,
            "sides = [\"start\", \"outer\"]\n",
            "cyclic[0].sides[1]: found \"outer\", which is in contact, expected a side without contact",
        ),
        (
            sides,
            "sides = [\"start\", \"start\"]\n",
            "cyclic[0].sides: found one side twice, expected the two sides of a sector",
        ),
        (
            sides,
            "sides = [\"start\", \"end\"]\ncenter = [0.1, 0]\n",
            "cyclic[0].sides: found an angle of 93.8141° from \"start\" to \"end\", expected 360° divided by a whole number; check `center` and `axis`, and whether the sides are those along which the sector meets its neighbours",
        ),
        (
            sides,
            "sides = [\"start\", \"end\"]\ncenter = [0, 0, 0]\n",
            "cyclic[0].center: found 3 coordinates, expected 2 coordinates",
        ),
        (
            sides,
            "sides = [\"start\", \"end\"]\naxis = [0, 0, 1]\n",
            "cyclic[0].axis: found an axis, expected none: in the plane it is z",
        ),
        (
            "angle = 1.5707963267948966",
            "angle = 1.5",
            "cyclic[0].sides: found an angle of 85.9437° from \"start\" to \"end\", expected 360° divided by a whole number; check `center` and `axis`, and whether the sides are those along which the sector meets its neighbours",
        ),
        (
            "[[cyclic]]",
            "[[cyclic]]\nsides = [\"end\", \"start\"]\n[[cyclic]]",
            "cyclic[1].sides: found sides that another entry has joined already, expected the sides of one sector; give each pair of sides in one entry, and no side of two sectors about different axes",
        ),
        (
            "[[cyclic]]",
            "[[boundary]]\non = \"end\"\ntraction = [1, 0]\n[[cyclic]]",
            "cyclic[0].sides[1]: found \"end\", which has conditions in boundary[0], expected a side without conditions; the body goes on behind this side: remove the conditions; a plane of symmetry takes `normal_displacement = 0` instead of cyclic symmetry",
        ),
    ] {
        assert_eq!(first_fault(&spoil(&sound, old, new)), message);
    }
}

/// What is given at both ends of a seam and is not the same.
#[test]
fn what_differs_at_a_seam_is_refused() {
    let sound = ring("Q1", COMPLIANCE, false, "");
    for (old, new, message) in [
        (
            "temperature = \"t*(1 +",
            "temperature = \"x + t*(1 +",
            "boundary[0].temperature: found a value at x = 0.0, y = 1.0 that is not the one at x = 1.0, y = 0.0, turned, expected the same on both sides of the sector; the body is repeated about its axis: what is given in one sector is given in every other, turned",
        ),
        (
            "spring = 30\n",
            "displacement = [0, \"free\"]\n",
            "boundary[0].displacement: found a value at x = 0.0, y = 1.0 that is not the one at x = 1.0, y = 0.0, turned, expected the same on both sides of the sector; the body is repeated about its axis: what is given in one sector is given in every other, turned",
        ),
        (
            "[[cyclic]]",
            "[initial]\ntemperature = \"y\"\n[[cyclic]]",
            "initial.temperature: found a value at x = 0.0, y = 1.0 that is not the one at x = 1.0, y = 0.0, turned, expected the same on both sides of the sector; the body is repeated about its axis: what is given in one sector is given in every other, turned",
        ),
        (
            "[[cyclic]]",
            "[initial]\nvelocity = [\"-y\", 0]\n[[cyclic]]",
            "initial.velocity: found a value at x = 0.0, y = 1.0 that is not the one at x = 1.0, y = 0.0, turned, expected the same on both sides of the sector; the body is repeated about its axis: what is given in one sector is given in every other, turned",
        ),
    ] {
        assert_eq!(first_fault(&spoil(&sound, old, new)), message);
    }
}

/// A temperature that is zero on the whole side but for the round-off of coordinates, r² − 1 at the bore, is the same
/// on both sides; one that is not zero there is not, however small it is.
#[test]
fn round_off_of_coordinates_is_no_difference() {
    let with = |temperature: Field| {
        let data = tube(&sector_of_tube(), "");
        data.with(|data| data.boundary.push(BoundaryCondition::on("inner").temperature(temperature)))
    };
    let zero = with(Field::of_space(|x| x[0] * x[0] + x[1] * x[1] - 1.0));
    assert!(zero.is_ok(), "{zero:?}");
    assert!(with(Field::of_space(|x| 1e-20 * x[0])).is_err());
    assert!(with(Field::of_space(|x| x[2].sqrt())).is_ok());
}

/// The first fault of a case without its place in the file.
fn first_fault(text: &str) -> String {
    let found = told(&Source::new("ring.toml", text), &[]);
    let first = found.lines().next().and_then(|line| line.split_once(": "));
    first.map_or_else(String::new, |(_, what)| what.to_owned())
}

/// Sides whose meshes do not match.
#[test]
fn meshes_that_do_not_match_are_told_apart() {
    let quarter = |first: &str, second: &str| Cyclic { sides: [first, second].map(str::to_owned), ..Z };
    let ring = Mesh::ring([1.0, 2.0], Some(std::f64::consts::FRAC_PI_2), [3, 6], Elements::Q1).unwrap();
    assert_eq!(quarter("start", "inner").links(&ring), Err(NotCyclic::Count([4, 7])));
    let oblong = Mesh::rectangle([2.0, 1.0], [4, 4], Diagonal::Right).unwrap();
    let found = quarter("bottom", "left").links(&oblong);
    assert!(matches!(found, Err(NotCyclic::Apart(_, distance)) if (distance - 0.5).abs() < 1e-12), "{found:?}");
    let square = Mesh::rectangle([1.0, 1.0], [4, 4], Diagonal::Right).unwrap();
    let (links, sectors) = quarter("bottom", "left").links(&square).unwrap();
    assert_eq!((sectors, links.nodes.len(), links.on_axis.len()), (4, 4, 1));
    let facets = |second_rises: bool| {
        let mut mesh = Mesh::box_([1.0; 3], [2, 2, 2], Elements::Q1).unwrap();
        for (side, rises) in [("bottom", true), ("left", second_rises)] {
            let triangles = halved(&mesh, side, rises);
            mesh.facets.insert(side.to_owned(), FacetSet::of(&P1_TRIANGLE, triangles));
        }
        quarter("bottom", "left").links(&mesh).map(|(_, sectors)| sectors)
    };
    assert_eq!(facets(true), Ok(4));
    assert!(matches!(facets(false), Err(NotCyclic::Cut(_))));
}

/// The squares of a side, each cut into two triangles by the diagonal from its lowest corner or by the other one.
fn halved(mesh: &Mesh, side: &str, rises: bool) -> Vec<u32> {
    let x = |node: u32| mesh.points[node as usize];
    let height = |node: u32| x(node).iter().sum::<f64>();
    let of_square = |square: &[u32]| {
        let mut corners = square.to_vec();
        corners.sort_by(|&a, &b| height(a).total_cmp(&height(b)));
        let [low, a, b, high] = corners[..] else { panic!("{corners:?}") };
        if rises { [low, high, a, low, high, b] } else { [a, b, low, a, b, high] }
    };
    mesh.facets[side].blocks[0].nodes.chunks_exact(4).flat_map(of_square).collect()
}
