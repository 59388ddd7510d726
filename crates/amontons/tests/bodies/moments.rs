//! Moments and rotations of sides: statics, exact fields of bending and torsion, and the motion of rigid parts.

use std::sync::Arc;

use amontons::case::{Case, Source};
use amontons::field::Field;
use amontons::output::{Memory, OutputError, Probe, ProbePlace, ProbeSet, Sink, Snapshot, Take};
use amontons::problem::Problem;
use amontons::run::run;
use amontons::tensor::{Point, Rotation, length};
use amontons::units::Measure;

use crate::at_rest::{parse, settings};
use crate::common::{Random, changed, told};

fn probe(quantity: &str, on: &str, about: Option<Point>) -> Probe {
    let take = if quantity.starts_with("rotation") { Take::Mean } else { Take::Integral };
    Probe { about, ..crate::at_rest::probe(quantity, ProbePlace::On(on.to_owned(), take)) }
}

/// The values of probes after the last step, and the results.
fn values(problem: &Problem, probes: &[Probe]) -> (Vec<f64>, Memory) {
    struct Last(ProbeSet, Vec<f64>);
    impl Sink for Last {
        fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
            self.1 = self.0.values(now);
            Ok(())
        }
    }
    let set = ProbeSet::new(problem, probes).unwrap_or_else(|(i, error)| panic!("{}: {error}", probes[i].name));
    let (mut last, mut memory) = (Last(set, Vec::new()), Memory::new().reports());
    run(problem, &settings(), &mut [&mut last, &mut memory]).unwrap();
    assert_eq!(last.1.len(), last.0.columns().len());
    (last.1, memory)
}

/// The number of a plane body, or the vector of one in space, of a moment or a rotation.
fn axial(dim: usize, values: &[f64]) -> Point {
    if dim == 3 { std::array::from_fn(|c| values[c]) } else { [0.0, 0.0, values[0]] }
}

fn minus(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|c| a[c] - b[c])
}

fn cross(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|c| a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3])
}

fn close(found: &Point, expected: &Point, size: f64, what: &str) {
    assert!(length(&minus(found, expected)) < 1e-9 * size, "{what}: {found:?} instead of {expected:?}");
}

/// A rotation of the body, and a shift.
fn place(random: &mut Random, dim: usize) -> (Rotation, Point) {
    let axis = if dim == 3 { [random.number(), random.number(), 1.0] } else { [0.0, 0.0, 1.0] };
    let shift = std::array::from_fn(|c| if c < dim { 5.0 * random.number() } else { 0.0 });
    (Rotation::about(&axis, 3.0 * random.number()), shift)
}

fn moved(x: &Point, (rotation, shift): &(Rotation, Point)) -> Point {
    let x = rotation.vector(x);
    std::array::from_fn(|c| x[c] + shift[c])
}

/// The problem with its mesh and its constant forces turned and moved.
fn elsewhere(problem: &Problem, to: &(Rotation, Point)) -> Problem {
    let turned = |fields: &[Field]| -> Vec<Field> {
        let v = std::array::from_fn(|c| fields.get(c).map_or(0.0, |field| field.value(&[0.0; 3], 0.0)));
        to.0.vector(&v).into_iter().take(fields.len()).map(Field::from).collect()
    };
    changed(problem, |data| {
        Arc::make_mut(&mut data.mesh).points.iter_mut().for_each(|x| *x = moved(x, to));
        for condition in &mut data.boundary {
            condition.force = condition.force.as_deref().map(turned);
        }
        for part in &mut data.rigid {
            (part.force, part.moment) = (turned(&part.force), turned(&part.moment));
            part.at = part.at.as_ref().map(|at| moved(at, to));
        }
    })
}

/// A beam of length 2, height 1 and, in space, depth 1: E = 1000, ν as given, held at its left end.
fn beam(dim: usize, poisson: f64, rest: &str) -> Case {
    let (mesh, flat, held) = if dim == 3 {
        ("kind = \"box\"\nsize = [2.0, 1.0, 1.0]\nn = [3, 2, 2]\nelements = \"Q2\"", "", "[0, 0, 0]")
    } else {
        (
            "kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [4, 2]\nelements = \"Q2\"",
            ", stress_state = \"plane-stress\"",
            "[0, 0]",
        )
    };
    parse(&format!(
        "name = \"beam\"\nunits = \"dimensionless\"\n[mesh]\n{mesh}\n[time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0\nelasticity = {{ law = \"isotropic\", young = 1000, poisson = {poisson:?}{flat} }}\n[[boundary]]\non = \"left\"\ndisplacement = {held}\n{rest}"
    ))
}

/// The clamp of a cantilever bears what acts on its end, F, and r × F about its own centre, or about another point, in
/// every direction; the end itself has the moment that is given.
#[test]
fn a_clamp_bears_the_moment_of_what_acts_on_the_end() {
    let mut random = Random(7);
    for dim in [2, 3] {
        let given: &str = if dim == 3 { "[3, -2, 1]" } else { "[3, -2]" };
        let case = beam(dim, 0.3, &format!("[[boundary]]\non = \"right\"\nforce = {given}\n"));
        let z = if dim == 3 { 0.5 } else { 0.0 };
        let force = [3.0, -2.0, if dim == 3 { 1.0 } else { 0.0 }];
        let end = [2.0, 0.5, z];
        for about in [None, Some([0.7, -1.3, if dim == 3 { 0.4 } else { 0.0 }])] {
            let to = place(&mut random, dim);
            let point = about.as_ref().map(|x| moved(x, &to));
            let probes = [
                probe("reaction_moment", "left", point),
                probe("total_moment", "left", point),
                probe("total_moment", "right", Some(point.unwrap_or(moved(&[0.0, 0.5, z], &to)))),
                probe("reaction_moment_magnitude", "left", point),
            ];
            let (found, _) = values(&elsewhere(&case.problem, &to), &probes);
            let moment = to.0.vector(&cross(&minus(&end, &about.unwrap_or([0.0, 0.5, z])), &force));
            let n = if dim == 3 { 3 } else { 1 };
            close(&axial(dim, &found), &moment.map(|c| -c), length(&moment), "clamp");
            close(&axial(dim, &found[n..]), &moment.map(|c| -c), length(&moment), "clamp, in all");
            close(&axial(dim, &found[2 * n..]), &moment, length(&moment), "end");
            assert!((found[3 * n] - length(&moment)).abs() < 1e-9 * length(&moment), "{found:?}");
        }
    }
}

/// Pure bending is exact with Q2 and ν = 0: the end turns by M L/(E I), the nearest rotation of the whole beam, bent to
/// a circle, is half of it, and a rigid end turns as its nodes do.
#[test]
fn an_end_that_is_bent_turns() {
    let mut random = Random(3);
    for dim in [2, 3] {
        let (text, moment) = if dim == 3 { ("[0, 0.5, -0.25]", [0.0, 0.5, -0.25]) } else { ("[0.5]", [0.0, 0.0, 0.5]) };
        let case = beam(dim, 0.0, &format!("[[rigid]]\non = \"right\"\nmoment = {text}\n"));
        let to = place(&mut random, dim);
        let mut problem = elsewhere(&case.problem, &to);
        if dim == 2 {
            problem = changed(&problem, |data| data.rigid[0].moment = vec![0.5.into()]);
        }
        let whole = Probe {
            about: None,
            ..crate::at_rest::probe("rotation", ProbePlace::Region("body".to_owned(), Take::Mean))
        };
        let probes = [probe("rotation", "right", None), whole, probe("total_moment", "right", None)];
        let (found, memory) = values(&problem, &probes);
        let n = if dim == 3 { 3 } else { 1 };
        let omega = to.0.vector(&moment.map(|m| m * 2.0 / (1000.0 / 12.0)));
        close(&axial(dim, &found), &omega, length(&omega), "end");
        close(&axial(dim, &found[n..]), &omega.map(|c| 0.5 * c), length(&omega), "beam");
        close(&axial(dim, &found[2 * n..]), &to.0.vector(&moment), length(&moment), "moment of the end");
        // u(x) − u(y) = ω × (x − y) on the rigid end.
        let state = memory.states.last().unwrap();
        let u = |node: u32| -> Point {
            std::array::from_fn(|c| if c < dim { state.u[node as usize * dim + c] } else { 0.0 })
        };
        let end = problem.mesh.facets["right"].node_list();
        for &node in &end {
            let arm = minus(&problem.mesh.points[node as usize], &problem.mesh.points[end[0] as usize]);
            let turned = cross(&axial(dim, &found), &arm);
            close(&minus(&u(node), &u(end[0])), &turned, length(&omega), "rigid end");
        }
    }
}

/// Torsion of a square bar with the lateral tractions that keep its sections plane: u = α (−z y, z x, 0), whose torque
/// is G α ∫ (x² + y²) and whose end turns by α L.
#[test]
fn a_bar_that_is_twisted_bears_its_torque() {
    let (alpha, length_, shear) = (0.01, 3.0, 400.0);
    let rest = format!(
        r#"[[boundary]]
on = "back"
displacement = [0, 0, 0]
[[boundary]]
on = "left"
traction = [0, 0, "{g}*(y - 0.5)"]
[[boundary]]
on = "right"
traction = [0, 0, "-{g}*(y - 0.5)"]
[[boundary]]
on = "bottom"
traction = [0, 0, "-{g}*(x - 0.5)"]
[[boundary]]
on = "top"
traction = [0, 0, "{g}*(x - 0.5)"]
[[boundary]]
on = "front"
traction = ["-{g}*(y - 0.5)", "{g}*(x - 0.5)", 0]
"#,
        g = shear * alpha
    );
    let case = parse(&format!(
        "name = \"bar\"\n[mesh]\nkind = \"box\"\nsize = [1.0, 1.0, {length_:?}]\nn = [2, 2, 3]\nelements = \"Q2\"\n[time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0\nelasticity = {{ law = \"isotropic\", young = {:?}, poisson = 0.25 }}\n{rest}",
        2.5 * shear
    ));
    let (found, _) = values(
        &case.problem,
        &[probe("reaction_moment", "back", None), probe("rotation", "front", None), probe("rotation_z", "top", None)],
    );
    let torque = shear * alpha / 6.0;
    close(&axial(3, &found), &[0.0, 0.0, -torque], torque, "torque");
    close(&axial(3, &found[3..]), &[0.0, 0.0, alpha * length_], alpha * length_, "end");
    // On the top, r = (x, 0, z − L/2) from its centre: ω_z = ∫ x (α z x) / ∫ x², of which the mean of z remains.
    assert!((found[6] - 0.5 * alpha * length_).abs() < 1e-9 * alpha * length_, "{found:?}");
}

/// All that acts on a body in equilibrium has no resultant and no moment, whatever it is: prescribed displacements,
/// tractions, pressures, forces, springs, contact with friction, and weight. A union of sides bears what they bear.
#[test]
fn what_acts_on_all_sides_is_in_equilibrium() {
    for dim in [2, 3] {
        for (quadrature, support) in [("nodal", "spring = 7"), ("gauss", "spring = [3, 5]")] {
            let case = loaded(dim, quadrature, support);
            let about = [0.3, 2.1, if dim == 3 { -0.7 } else { 0.0 }];
            let sides: &[&str] = if dim == 3 {
                &["left", "right", "top", "bottom", "front", "back"]
            } else {
                &["left", "right", "top", "bottom"]
            };
            let of = |name: &str| [probe("total_force", name, None), probe("total_moment", name, Some(about))];
            let probes: Vec<Probe> = sides.iter().chain(&["crown"]).flat_map(|side| of(side)).collect();
            let (found, memory) = values(&case.problem, &probes);
            let n = dim + if dim == 3 { 3 } else { 1 };
            let split = |row: &[f64]| {
                let force: Point = std::array::from_fn(|c| if c < dim { row[c] } else { 0.0 });
                (force, axial(dim, &row[dim..]))
            };
            let rows: Vec<(Point, Point)> = found.chunks(n).map(split).collect();
            // Weight at the centre of the body, (1, 1/2, 1/2), of which the volume is 2.
            let weight = [0.0, -2.0 * 0.04, 0.0];
            let arm = minus(&[1.0, 0.5, if dim == 3 { 0.5 } else { 0.0 }], &about);
            let mut sum = (weight, cross(&arm, &weight));
            let mut size = 0.0;
            for (force, moment) in &rows[..sides.len()] {
                size += length(force) + length(moment);
                sum = (std::array::from_fn(|c| sum.0[c] + force[c]), std::array::from_fn(|c| sum.1[c] + moment[c]));
            }
            let what = format!("{dim} {quadrature}");
            close(&sum.0, &[0.0; 3], size, &what);
            close(&sum.1, &[0.0; 3], size, &what);
            let contact = memory.reports.last().unwrap().contact.force;
            let own: Point = std::array::from_fn(|c| if c < dim { contact[c] } else { 0.0 });
            close(&rows[3].0, &own, size, &what);
            assert!(length(&own) > 1e-3 && own[0].abs() > 1e-5 && length(&rows[1].0) > 1e-3, "{what}: {rows:?}");
            let both = |c: usize| rows[1].0[c] + rows[2].0[c];
            close(&rows[sides.len()].0, &std::array::from_fn(both), size, &what);
            let both = |c: usize| rows[1].1[c] + rows[2].1[c];
            close(&rows[sides.len()].1, &std::array::from_fn(both), size, &what);
        }
    }
}

/// A body held at its left side, on springs at the right, loaded on top, on a foundation with friction.
fn loaded(dim: usize, quadrature: &str, support: &str) -> Case {
    let (mesh, flat, zero, force, traction) = if dim == 3 {
        ("kind = \"box\"\nsize = [2.0, 1.0, 1.0]\nn = [4, 2, 2]", "", ", 0", ", 0.02", ", \"0.1*z\"")
    } else {
        ("kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [6, 3]", ", stress_state = \"plane-strain\"", "", "", "")
    };
    let support = if dim == 3 { support.replace("[3, 5]", "[3, 5, 2]") } else { support.to_owned() };
    parse(&format!(
        r#"name = "loaded"
[mesh]
{mesh}
[[side]]
name = "crown"
of = ["right", "top"]
[time]
end = 1.0
steps = 2
inertia = false
[material]
elasticity = {{ law = "isotropic", young = 10, poisson = 0.3{flat} }}
[load]
body_force = [0, -0.04{zero}]
[[boundary]]
on = "left"
displacement = [0.02, "-0.03*t"{zero}]
[[boundary]]
on = "right"
{support}
dashpot = 2
force = [0.05, -0.03{force}]
[[boundary]]
on = "top"
pressure = "0.1 + 0.05*x*t"
traction = ["0.02*x", 0{traction}]
[contact]
on = "bottom"
normal = {{ law = "compliance", stiffness = 10 }}
friction = {{ law = "coulomb", coefficient = 0.25 }}
quadrature = "{quadrature}"
"#
    ))
}

/// Both sides of a pair bear opposite forces; a rigid part with a place has its moment about that, without one about
/// its centre.
#[test]
fn pairs_and_rigid_parts_bear_what_they_pass() {
    let case = parse(
        r#"name = "stack"
[mesh]
kind = "blocks"
blocks = [
  { name = "below", size = [1.0, 0.5], n = [4, 2] },
  { name = "above", size = [1.0, 0.5], n = [3, 2], origin = [0, 0.5] },
]
[time]
end = 1.0
steps = 1
inertia = false
[material]
elasticity = { law = "isotropic", young = 10, poisson = 0.3, stress_state = "plane-strain" }
[[boundary]]
on = "below_bottom"
displacement = [0, 0]
[[rigid]]
on = "above_top"
force = [0.05, -1]
at = [0.6, 1.0]
[contact]
on = "above_bottom"
with = "below_top"
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.3 }
"#,
    );
    let about = Some([0.2, 0.1, 0.0]);
    let probes = [
        probe("total_force", "above_bottom", None),
        probe("total_moment", "above_bottom", about),
        probe("total_force", "below_top", None),
        probe("total_moment", "below_top", about),
        probe("total_force", "above_top", None),
        probe("total_moment", "above_top", None),
        probe("total_moment", "above_top", about),
        probe("reaction_moment", "below_bottom", about),
    ];
    let (found, _) = values(&case.problem, &probes);
    // r × F of (0.05, −1) at (0.6, 1) about (0.2, 0.1).
    let moment = -0.4 - 0.9 * 0.05;
    let expected = [-0.05, 1.0, -moment, 0.05, -1.0, moment, 0.05, -1.0, 0.0, moment, -moment];
    for (i, (f, e)) in found.iter().zip(&expected).enumerate() {
        assert!((f - e).abs() < 1e-9, "{i}: {found:?} instead of {expected:?}");
    }
    let rigid = changed(&case.problem, |data| data.rigid[0].at = None);
    let (found, _) = values(&rigid, &probes[5..6]);
    assert!(found[0].abs() < 1e-12, "{found:?}");
}

/// What holds a rigid part at a point has the moment of its force about another one, in space.
#[test]
fn a_rigid_part_is_held_at_points() {
    let case = parse(
        r#"name = "held"
[mesh]
kind = "box"
size = [1.0, 1.0, 1.0]
n = 2
[time]
end = 1.0
steps = 1
inertia = false
[material]
elasticity = { law = "isotropic", young = 10, poisson = 0.3 }
[[boundary]]
on = "back"
force = [0.2, 0.3, -0.4]
[[rigid]]
on = "front"
[[boundary]]
at = [0, 0, 1]
displacement = [0, 0, 0]
[[boundary]]
at = [1, 0, 1]
displacement = ["free", 0, 0]
[[boundary]]
at = [0, 1, 1]
displacement = ["free", "free", 0]
"#,
    );
    let about = [0.1, -0.2, 0.3];
    let probes = ["reaction_moment", "total_moment"].map(|quantity| probe(quantity, "front", Some(about)));
    let (found, _) = values(&case.problem, &probes);
    let expected = cross(&minus(&[0.5, 0.5, 0.0], &about), &[-0.2, -0.3, 0.4]);
    close(&axial(3, &found), &expected, 1.0, "reaction");
    close(&axial(3, &found[3..]), &expected, 1.0, "in all");
}

/// Points of an edge turn with it: about the edge itself there is no rotation to be seen.
#[test]
fn an_edge_turns_about_what_is_across() {
    let case = beam(3, 0.0, "[[rigid]]\non = \"right\"\nmoment = [0, 0.5, -0.25]\n");
    let mut problem = case.problem.clone();
    problem = changed(&problem, |data| {
        let mesh = Arc::make_mut(&mut data.mesh);
        let on_edge = |x: &Point| x[0] + x[1] > 3.0 - 1e-9;
        let nodes: Vec<u32> = (0..).zip(&mesh.points).filter(|(_, x)| on_edge(x)).map(|(node, _)| node).collect();
        let edge = amontons::mesh::FacetSet::of(&amontons::element::POINT_LEFT, nodes);
        mesh.edges.insert("edge".to_owned(), edge);
    });
    let (found, _) = values(&problem, &[probe("rotation", "right", None), probe("rotation", "edge", None)]);
    let whole = [found[0], found[1], 0.0];
    close(&axial(3, &found[3..]), &whole, length(&whole), "edge along z");
}

/// Moments are in N m, per unit of thickness where forces are; rotations in rad.
#[test]
fn moments_and_rotations_have_units() {
    let case = beam(2, 0.3, "[[boundary]]\non = \"right\"\nforce = [1, 0]\n");
    let units = |problem: &Problem, of: &str| {
        let measure = probe(of, "left", None).measure().expect("a measure");
        problem.units().of(measure)
    };
    let si = changed(&case.problem, |data| data.system = amontons::units::UnitSystem::Si);
    let thick = changed(&si, |data| Arc::make_mut(&mut data.mesh).thickness = Some(0.5));
    assert_eq!(["reaction_moment", "total_force", "rotation"].map(|of| units(&si, of)), ["N m/m", "N/m", "rad"]);
    assert_eq!(["total_moment", "total_force", "rotation"].map(|of| units(&thick, of)), ["N m", "N", "rad"]);
    assert_eq!(["total_moment", "rotation"].map(|of| units(&case.problem, of)), ["", ""]);
    assert_eq!(probe("rotation", "left", None).measure(), Some(Measure::Angle));
    let of = |problem: &Problem| values(problem, &[probe("reaction_moment", "left", Some([0.0; 3]))]).0[0];
    // The whole of a body of thickness ½ bears the whole force, N, at the centre of its end.
    assert!((of(&case.problem) - 0.5).abs() < 1e-12 && (of(&thick) - 0.5).abs() < 1e-12);
    // Coordinates may have units.
    let held = "[[boundary]]\non = \"right\"\nforce = [1, 0]\n[[probe]]\nname = \"m\"\nquantity = \"reaction_moment\"\non = \"left\"\ntake = \"integral\"\nabout = [0, \"250 mm\"]\n";
    let text = "name = \"beam\"\n[mesh]\nkind = \"rectangle\"\nsize = [2.0, 1.0]\nn = 2\n[time]\nend = 1\nsteps = 1\n[material]\ndensity = 0\nelasticity = { law = \"isotropic\", young = 1000, poisson = 0.3, stress_state = \"plane-stress\" }\n[[boundary]]\non = \"left\"\ndisplacement = [0, 0]\n";
    let case = parse(&format!("{text}{held}"));
    let (found, _) = values(&case.problem, &case.probes);
    assert!((found[0] - 0.25).abs() < 1e-12, "{found:?}");
}

/// One message for each wrong probe.
#[test]
fn faults_of_moments_and_rotations() {
    let head = "name = \"body\"\n[mesh]\nkind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 2\n[time]\nend = 1\nsteps = 1\n[material]\ndensity = 0\nelasticity = { law = \"isotropic\", young = 2.0, poisson = 0.3, stress_state = \"plane-stress\" }\n[[boundary]]\non = \"left\"\ndisplacement = [0, 0]\n[[probe]]\nname = \"a\"\n";
    let line = head.lines().count();
    let fault = |rest: &str, row: usize, says: &str| {
        let expected = format!("body.toml:{}:{says}", line + row);
        assert_eq!(told(&Source::new("body.toml", format!("{head}{rest}")), &[]), expected);
    };
    fault(
        "quantity = \"reaction_moment\"\non = \"top\"\ntake = \"integral\"\n",
        1,
        "12: probe[0].quantity: found reaction_moment elsewhere than where the displacement is prescribed, expected a quantity that exists there",
    );
    fault(
        "quantity = \"reaction_moment_x\"\non = \"left\"\ntake = \"integral\"\n",
        1,
        "12: probe[0].quantity: found reaction_moment_x in 2 dimensions, expected a quantity that exists there",
    );
    fault(
        "quantity = \"reaction_moment\"\non = \"left\"\ntake = \"integral\"\nabout = [0, 0, 0]\n",
        4,
        "9: probe[0].about: found 3 coordinates, expected 2 coordinates",
    );
    fault(
        "quantity = \"reaction\"\non = \"left\"\ntake = \"integral\"\nabout = [0, 0]\n",
        4,
        "1: probe[0].about: found `about` of reaction, expected `about` of reaction_moment or total_moment",
    );
    fault(
        "quantity = \"rotation\"\non = \"left\"\ntake = \"max\"\n",
        3,
        "8: probe[0].take: found rotation other than its mean, expected \"mean\": the rotation of the side or region as a whole",
    );
    fault(
        "quantity = \"total_moment\"\non = \"left\"\ntake = \"mean\"\n",
        3,
        "8: probe[0].take: found total_moment other than its integral, expected \"integral\": the sum over the nodes",
    );
    fault(
        "quantity = \"rotation\"\nat = [1, 1]\n",
        1,
        "12: probe[0].quantity: found rotation of a single point, expected a quantity that exists there",
    );
    fault(
        "quantity = \"total_force\"\nat = [1, 1]\n",
        1,
        "12: probe[0].quantity: found total_force elsewhere than on a side, an edge or points, expected a quantity that exists there",
    );
    let ring = head.replace("n = 2\n", "n = 2\naxisymmetric = true\n").replace(", stress_state = \"plane-stress\"", "");
    let ring =
        ring.replace("[0, 0]\n[[probe]]", "[0, 0]\n[[boundary]]\non = \"top\"\nnormal_displacement = 0\n[[probe]]");
    let text = format!("{ring}quantity = \"total_moment\"\non = \"top\"\ntake = \"integral\"\n");
    assert_eq!(
        told(&Source::new("body.toml", text), &[]),
        "body.toml:21:12: probe[0].quantity: found total_moment in a body of revolution, which does not turn, expected a quantity that exists there"
    );
}

/// What a seal bears on its face is its load, the pressure of the bodies and that of the fluid together, with its
/// moment about the place of the force: nothing turns it but the guide.
#[test]
fn a_fluid_is_part_of_what_a_side_bears() {
    let problem = crate::common::case("crates/amontons/benchmarks/seal-with-fluid.toml", &[]).problem;
    let probes = [probe("total_force", "bottom", None), probe("total_moment", "bottom", Some([0.0; 3]))];
    let (values, memory) = values(&problem, &probes);
    close(&[values[0], values[1], 0.0], &[0.0, 0.6, 0.0], 0.6, "the force");
    // By hand: each point with what presses there, c r or p_f.
    let depth = -memory.states.last().unwrap().u[1];
    let moment: f64 = problem
        .contact_boundary()
        .points
        .iter()
        .map(|point| {
            let r = depth - 0.02 * point.x[0];
            point.weight * point.x[0] * if r > 0.0 { 100.0 * r } else { 0.25 }
        })
        .sum();
    assert!((values[2] - moment).abs() < 1e-9 * moment, "{} instead of {moment}", values[2]);
}

/// A quarter of a symmetric body: one side is held in x, the other in y, and both at their corner. Each bears what its
/// own condition holds there.
#[test]
fn at_a_corner_each_side_bears_its_own_component() {
    let case = parse(
        r#"name = "quarter"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 1.0]
n = [3, 3]
[time]
end = 1.0
steps = 1
inertia = false
[material]
elasticity = { law = "isotropic", young = 10, poisson = 0.3, stress_state = "plane-strain" }
[[boundary]]
on = "left"
normal_displacement = 0
[[boundary]]
on = "bottom"
displacement = ["free", "0.01*x"]
[[boundary]]
on = "right"
traction = [0.3, 0]
[[boundary]]
on = "top"
traction = [0, "0.1*x"]
"#,
    );
    let probes = ["left", "bottom"].map(|side| probe("total_force", side, None));
    let (found, _) = values(&case.problem, &probes);
    let expected = [-0.3, 0.0, 0.0, -0.05];
    for (f, e) in found.iter().zip(&expected) {
        assert!((f - e).abs() < 1e-11, "{found:?} instead of {expected:?}");
    }
}
