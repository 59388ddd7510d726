//! Modes of the sector of a cyclic body: those of the whole body, by number of waves.

use std::f64::consts::TAU;
use std::sync::Arc;

use amontons::case::{self, Case, Source};
use amontons::mesh::Mesh;
use amontons::run::{Settings, Stepping};
use amontons::stability::{Mode, ModeKind, ModeRegion, Modes, StabilityError, Wanted, modes};
use faer::c64;

/// Number of sectors, and cells around each.
const SECTORS: usize = 9;
const AROUND: usize = 2;

fn parsed(text: &str) -> Case {
    case::parse(&Source::new("case.toml", text.to_owned()), &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn found(case: &Case, wanted: &Wanted) -> Result<Modes, StabilityError> {
    let mut run = Stepping::new(&case.problem, &Settings::default()).expect("a run");
    while !run.is_done() {
        run.step().expect("a step");
    }
    let seen = run.snapshot();
    modes(&case.problem, seen.discretization, seen.state, seen.report.expect("a step"), wanted)
}

/// A body of sectors: the case of the whole or of a sector.
struct Body {
    /// Tables of the mesh, with `AROUND` for the number of cells around and `ANGLE` for the key of the angle.
    mesh: &'static str,
    /// The pairs of cut sides.
    cuts: &'static [&'static str],
    /// All other tables.
    rest: String,
    /// Key of the axis of the sectors, in space.
    axis: &'static str,
}

impl Body {
    fn case(&self, sectors: usize, is_whole: bool) -> Case {
        let (cells, angle) = if is_whole {
            (sectors * AROUND, String::new())
        } else {
            (AROUND, format!("angle = {:?}", TAU / sectors as f64))
        };
        let mesh = self.mesh.replace("AROUND", &cells.to_string()).replace("ANGLE", &angle);
        let cut = |name: &&str| format!("[[cyclic]]\nsides = [\"{name}start\", \"{name}end\"]\n{}\n", self.axis);
        let cuts: String = if is_whole { String::new() } else { self.cuts.iter().map(cut).collect() };
        parsed(&format!("name = \"body\"\nunits = \"dimensionless\"\n{mesh}{}{cuts}", self.rest))
    }

    /// The modes of the whole and those of a sector in a region.
    fn both(&self, sectors: usize, kind: ModeKind, region: ModeRegion) -> [Modes; 2] {
        let wanted = Wanted { kind, count: 1, region: Some(region), waves: None, interrupt: None };
        [true, false].map(|is_whole| found(&self.case(sectors, is_whole), &wanted).unwrap_or_else(|e| panic!("{e}")))
    }
}

/// Asserts that two lists of modes have the same eigenvalues, each as often, to 1e-8 of the modulus, and the same
/// shares of the contacts.
fn assert_union(name: &str, whole: &Modes, sector: &Modes) {
    assert_eq!((whole.missing(), sector.missing()), (0, 0), "{name}: counts");
    assert_eq!(whole.modes.len(), sector.modes.len(), "{name}: numbers of modes");
    let counted: usize = sector.counts.iter().map(|count| count.modes).sum();
    assert_eq!(counted, sector.modes.len(), "{name}: modes by number of waves");
    let off = |a: &Mode, b: &Mode| (a.growth - b.growth).hypot(a.frequency - b.frequency);
    let mut left: Vec<&Mode> = sector.modes.iter().collect();
    let mut worst = 0.0f64;
    for mode in &whole.modes {
        let nearest = (0..left.len()).min_by(|a, b| off(left[*a], mode).total_cmp(&off(left[*b], mode)));
        let own = left.swap_remove(nearest.expect("a mode"));
        worst = worst.max(off(own, mode) / mode.growth.hypot(mode.frequency));
    }
    assert!(worst < 1e-8, "{name}: {worst:e} off");
    assert!(whole.modes.iter().chain(&sector.modes).all(|mode| mode.residual < 1e-9), "{name}: residuals");
    let bring = |modes: &Modes| modes.modes.iter().flat_map(|mode| mode.by_contact.clone()).sum::<f64>();
    let size: f64 = whole.modes.iter().map(|mode| mode.growth.hypot(mode.frequency)).sum();
    assert!((bring(whole) - bring(sector)).abs() < 1e-7 * size, "{name}: {} and {}", bring(whole), bring(sector));
}

/// Asserts that the shapes of the sector, turned and with their phases, are those of the whole up to a factor.
fn assert_shapes(name: &str, [whole, sector]: &[Case; 2], [of_whole, of_sector]: [&Modes; 2]) {
    let cyclic = &sector.problem.cyclic[0];
    let node_at = |x: [f64; 3]| {
        let near = |y: &[f64; 3]| (0..3).all(|c| (x[c] - y[c]).abs() < 1e-9);
        whole.problem.mesh.points.iter().position(near).expect("a node of the whole")
    };
    let dim = whole.problem.mesh.dim;
    for mode in &of_whole.modes {
        let off = |other: &&Mode| (other.growth - mode.growth).hypot(other.frequency - mode.frequency);
        let own = of_sector.modes.iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("a mode");
        let mut spread = vec![c64::default(); mode.displacement.len()];
        for place in 0..SECTORS {
            let [cosine, sine] = own.phase(place, SECTORS);
            for (i, x) in sector.problem.mesh.points.iter().enumerate() {
                let node = node_at(cyclic.position(x, [place, SECTORS]));
                let part =
                    |k: usize| std::array::from_fn(|c| if c < dim { own.displacement[i * dim + c][k] } else { 0.0 });
                let [re, im] = [0, 1].map(|k| cyclic.vector(&part(k), [place, SECTORS]));
                for c in 0..dim {
                    spread[node * dim + c] = c64::new(re[c], im[c]) * c64::new(cosine, sine);
                }
            }
        }
        let shape: Vec<c64> = mode.displacement.iter().map(|u| c64::new(u[0], u[1])).collect();
        let product = |a: &[c64], b: &[c64]| a.iter().zip(b).map(|(a, b)| a.conj() * *b).sum::<c64>().norm();
        let same = product(&spread, &shape).powi(2) / (product(&spread, &spread) * product(&shape, &shape));
        assert!((same - 1.0).abs() < 1e-6, "{name}: {own:?} is {same} of the shape of the whole");
    }
}

fn region(growth: [f64; 2], frequency: [f64; 2]) -> ModeRegion {
    ModeRegion { growth, frequency }
}

const RING: &str = "[mesh]\nkind = \"ring\"\nradii = [1.0, 2.0]\nn = [3, AROUND]\nelements = \"Q1\"\nANGLE\n";

/// A ring whose outer side is held on a drum that turns in it, as `benchmarks/squeal-ring.toml`.
fn drum(material: &str, friction: f64) -> String {
    format!(
        r#"
[time]
end = 1.0
analysis = "steady"
[material]
density = 1.0
elasticity = {{ law = "isotropic", young = 1.0, poisson = 0.3, stress_state = "plane-strain" }}
{material}
[[boundary]]
on = "outer"
displacement = [0, 0]
[contact]
on = "inner"
gap = -1e-3
normal = {{ law = "bilateral" }}
friction = {{ law = "coulomb", coefficient = {friction:?} }}
foundation_velocity = ["-y", "x"]
"#
    )
}

const VISCOUS: &str = "viscosity = { law = \"lame\", first = 5.8e-3, second = 7.7e-3 }";

/// A ring on a turning drum, with and without damping, with and without friction, away from the real axis and on it:
/// the modes of the whole are those of the sector, each as often.
#[test]
fn a_ring_has_the_modes_of_its_sector() {
    let near = region([-0.6, 0.6], [0.0, 4.0]);
    let away = region([0.01, 0.6], [1.5, 5.0]);
    for (material, friction, region) in
        [(VISCOUS, 0.6, near), (VISCOUS, 0.6, away), ("", 0.6, near), ("", 0.0, region([-0.1, 0.1], [0.0, 4.0]))]
    {
        let body = Body { mesh: RING, cuts: &[""], rest: drum(material, friction), axis: "" };
        let [whole, sector] = body.both(SECTORS, ModeKind::Squeal, region);
        let name = format!("friction {friction}, {material}, {region:?}");
        assert_union(&name, &whole, &sector);
        assert!(whole.modes.len() >= 9, "{name}: {} modes", whole.modes.len());
        assert_eq!((sector.sectors, sector.counts.len()), (SECTORS, SECTORS / 2 + 1));
        if friction > 0.0 {
            let cases = [true, false].map(|is_whole| body.case(SECTORS, is_whole));
            assert_shapes(&name, &cases, [&whole, &sector]);
        }
    }
}

/// Branches of the material, in a region without their poles.
#[test]
fn a_ring_that_relaxes_has_the_modes_of_its_sector() {
    let branches = format!("{VISCOUS}\nprony = [{{ ratio = 0.1, time = 0.7 }}]");
    let body = Body { mesh: RING, cuts: &[""], rest: drum(&branches, 0.6), axis: "" };
    for region in [region([-0.6, 0.6], [0.3, 4.0]), region([0.01, 0.6], [0.0, 5.0])] {
        let [whole, sector] = body.both(6, ModeKind::Squeal, region);
        assert_union(&format!("{region:?}"), &whole, &sector);
        assert!(whole.modes.len() >= 5, "{region:?}: {} modes", whole.modes.len());
    }
    let wanted = Wanted { kind: ModeKind::Squeal, count: 3, region: None, waves: None, interrupt: None };
    let lowest = found(&body.case(6, false), &wanted).unwrap_or_else(|error| panic!("{error}"));
    assert!(lowest.counts.iter().all(|count| count.modes >= 3 && count.missing == 0), "{:?}", lowest.counts);
}

/// A tube in space on a drum that turns and moves along its axis, with drag; an even number of sectors, so that half of
/// them is a number of waves.
#[test]
fn a_tube_has_the_modes_of_its_sector() {
    let mesh = "[mesh]\nkind = \"cylinder\"\nradii = [1.0, 2.0]\nheight = 1.0\nn = [2, AROUND, 1]\nelements = \"Q1\"\n\
                ANGLE\n";
    let rest = r#"
[time]
end = 1.0
analysis = "steady"
[material]
density = 1.0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.3 }
viscosity = { law = "lame", first = 0.002, second = 0.004 }
[[boundary]]
on = "outer"
displacement = [0, 0, 0]
[contact]
on = "inner"
gap = -1e-2
normal = { law = "damped", stiffness = 3.0, damping = 0.02 }
friction = { law = "coulomb", coefficient = 0.5 }
foundation_velocity = ["-y", "x", 0.3]
"#;
    let body = Body { mesh, cuts: &[""], rest: rest.to_owned(), axis: "axis = [0, 0, 1]" };
    let [whole, sector] = body.both(6, ModeKind::Squeal, region([-0.6, 0.6], [0.0, 2.2]));
    assert_union("tube", &whole, &sector);
    assert!(whole.modes.len() >= 8, "{} modes", whole.modes.len());
}

/// A ring with heat, rubbed by a drum that turns, or that slides along the axis so that all eigenvalues are real.
fn warm_ring(velocity: &str) -> String {
    format!(
        r#"
[time]
end = 1e-9
steps = 1
[material]
density = 1.0
heat_capacity = 1.0
conductivity = 1.0
expansion = 0.5
coupling = 0.0
elasticity = {{ law = "isotropic", young = 2.0, poisson = 0.3, stress_state = "plane-strain" }}
[[boundary]]
on = "outer"
displacement = [0, 0]
[contact]
on = "inner"
gap = -1e-9
normal = {{ law = "bilateral" }}
friction = {{ law = "coulomb", coefficient = 0.3 }}
frictional_heat = 1.0
foundation_velocity = {velocity}
heat = {{ law = "constant", conductance = 0.7, foundation_temperature = 0.0 }}
"#
    )
}

/// Hot spots: complex eigenvalues where they are dragged around, real ones of which all but those of no waves are
/// double where the drum slides along its axis.
#[test]
fn a_ring_has_the_hot_spots_of_its_sector() {
    for (velocity, region) in [
        ("[\"-20*y\", \"20*x\"]", region([-60.0, 60.0], [0.0, 60.0])),
        ("[0, 0, 20]", region([-60.0, 60.0], [0.0, 20.0])),
    ] {
        let mut body = Body { mesh: RING, cuts: &[""], rest: warm_ring(velocity), axis: "" };
        body.rest = body.rest.replace("density = 1.0", "density = 0.0").replace("coupling = 0.0\n", "");
        let [whole, sector] = body.both(SECTORS, ModeKind::Thermal, region);
        assert_union(velocity, &whole, &sector);
        assert!(whole.modes.len() >= 8, "{velocity}: {} modes", whole.modes.len());
    }
}

/// Squeal and heat in one pencil.
#[test]
fn a_warm_ring_has_the_modes_of_its_sector() {
    // A short first step would press with its inertia.
    let rest = warm_ring("[\"-2*y\", \"2*x\"]").replace("end = 1e-9", "end = 1.0");
    let body = Body { mesh: RING, cuts: &[""], rest, axis: "" };
    let [whole, sector] = body.both(6, ModeKind::Coupled, region([-0.9, 2.0], [0.0, 4.0]));
    assert_union("coupled", &whole, &sector);
    assert!(whole.modes.len() >= 8, "{} modes", whole.modes.len());
}

/// Two rings that slide on each other, with points at the cut that face the neighbouring sector.
#[test]
fn two_rings_have_the_modes_of_their_sector() {
    let mesh = r#"[mesh]
kind = "blocks"
[[mesh.blocks]]
name = "hub"
radii = [0.5, 1.0]
n = [1, AROUND]
elements = "Q1"
ANGLE
[[mesh.blocks]]
name = "rim"
radii = [1.0, 2.0]
n = [2, AROUND]
elements = "Q1"
ANGLE
"#;
    let rest = r#"
[time]
end = 1.0
analysis = "steady"
[material]
density = 1.0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.3, stress_state = "plane-strain" }
[[boundary]]
on = "rim_outer"
displacement = ["-1e-3*x", "-1e-3*y"]
[[boundary]]
on = "hub_inner"
displacement = [0, 0]
[contact]
on = "hub_outer"
with = "rim_inner"
normal = { law = "signorini" }
friction = { law = "coulomb", coefficient = 0.4 }
foundation_velocity = ["-y", "x"]
"#;
    let body = Body { mesh, cuts: &["hub_", "rim_"], rest: rest.to_owned(), axis: "" };
    let [whole, sector] = body.both(6, ModeKind::Squeal, region([-0.9, 0.9], [0.0, 4.0]));
    assert_union("two rings", &whole, &sector);
    assert!(whole.modes.len() >= 8, "{} modes", whole.modes.len());
}

/// The nodes of a mesh in another order, and its cells in each block.
fn renumbered(mesh: &Mesh, seed: u64) -> Mesh {
    let mut state = seed;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut shuffled = |count: usize| -> Vec<usize> {
        let mut all: Vec<usize> = (0..count).collect();
        (1..count).rev().for_each(|i| all.swap(i, random(i + 1)));
        all
    };
    let mut other = mesh.clone();
    let number = shuffled(mesh.points.len());
    for (x, new) in mesh.points.iter().zip(&number) {
        other.points[*new] = *x;
    }
    let map = |nodes: &mut Vec<u32>| nodes.iter_mut().for_each(|node| *node = number[*node as usize] as u32);
    for block in &mut other.blocks {
        map(&mut block.nodes);
        let width = block.element.nodes.len();
        let cells: Vec<Vec<u32>> = block.nodes.chunks(width).map(<[u32]>::to_vec).collect();
        block.nodes = shuffled(cells.len()).into_iter().flat_map(|cell| cells[cell].clone()).collect();
    }
    let sets = other.facets.values_mut().chain(other.edges.values_mut());
    sets.flat_map(|set| &mut set.blocks).for_each(|block| map(&mut block.nodes));
    other
}

/// Modes do not know how a mesh is numbered: squares, and triangles of Gmsh with curved sides, as a sector and by
/// itself.
#[test]
fn modes_do_not_know_how_a_mesh_is_numbered() {
    let path = crate::common::file("crates/amontons/tests/meshes/quarter_ring.msh");
    let gmsh = amontons::mesh::read(&path).unwrap_or_else(|error| panic!("{error}"));
    let ring = RING.replace("AROUND", "4").replace("ANGLE", &format!("angle = {:?}", TAU / 4.0));
    let cyclic = "[[cyclic]]\nsides = [\"start\", \"end\"]\n";
    for (mesh, cut) in [(Some(&gmsh), cyclic), (Some(&gmsh), ""), (None, cyclic)] {
        let text = format!("name = \"body\"\nunits = \"dimensionless\"\n{ring}{}{cut}", drum(VISCOUS, 0.6));
        let mut case = parsed(&text);
        if let Some(mesh) = mesh {
            case.problem = crate::common::changed(&case.problem, |data| data.mesh = Arc::new(mesh.clone()));
        }
        let region = Some(region([-0.6, 0.6], [0.0, 4.0]));
        let wanted = Wanted { kind: ModeKind::Squeal, count: 1, region, waves: None, interrupt: None };
        let ordered = found(&case, &wanted).unwrap_or_else(|error| panic!("{error}"));
        assert!(ordered.modes.len() >= 5, "{} modes", ordered.modes.len());
        for seed in 1..4 {
            let mut other = parsed(&text);
            let mesh = Arc::new(renumbered(&case.problem.mesh, seed));
            other.problem = crate::common::changed(&case.problem, |data| data.mesh = mesh);
            let shuffled = found(&other, &wanted).unwrap_or_else(|error| panic!("{error}"));
            assert_union(&format!("{cut}{seed}"), &ordered, &shuffled);
        }
    }
}

/// Numbers of waves that a body does not have are refused; those that are given are searched alone.
#[test]
fn waves_are_those_of_the_sectors() {
    let body = Body { mesh: RING, cuts: &[""], rest: drum(VISCOUS, 0.6), axis: "" };
    let of = |is_whole: bool, waves: &[usize]| {
        let wanted = Wanted { kind: ModeKind::Squeal, count: 3, region: None, waves: Some(waves), interrupt: None };
        found(&body.case(6, is_whole), &wanted)
    };
    let some = of(false, &[3, 1]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(some.counts.iter().map(|count| count.waves).collect::<Vec<_>>(), [1, 3]);
    assert!(some.modes.iter().all(|mode| [1, 3].contains(&mode.waves.expect("a number").abs())));
    assert!(some.counts.iter().all(|count| count.modes >= 3 && count.missing == 0), "{:?}", some.counts);
    for (is_whole, waves, told) in [(false, [4], "at most 3, half of 6 sectors"), (true, [1], "expected a sector")] {
        let error = of(is_whole, &waves).expect_err("a refusal").to_string();
        assert!(error.starts_with("stability.waves: ") && error.contains(told), "{error}");
    }
}

/// A sixteenth of `benchmarks/squeal-ring.toml`, against the three modes of two waves that grow (Chebyshev collocation
/// of another program). That has e^{2iθ + λt} with Im λ of −2.06, −3.06 and 4.21 for σ_rθ = −f σ_rr: its drum drags
/// the ring in the negative sense, and the first two run in the positive one. Here the drum turns the other way.
#[test]
fn a_sector_squeals_in_two_waves_as_elsewhere() {
    let path = crate::common::file("crates/amontons/benchmarks/squeal-ring.toml");
    let overrides = [
        format!("mesh.angle={:?}", TAU / 16.0),
        "mesh.n=[8, 4]".to_owned(),
        "cyclic=[{ sides = [\"start\", \"end\"] }]".to_owned(),
    ];
    let case = case::read(&path, &overrides).unwrap_or_else(|error| panic!("{error}"));
    let region = Some(region([0.05, 1.0], [0.0, TAU * 0.8]));
    let wanted = Wanted { kind: ModeKind::Squeal, count: 1, region, waves: Some(&[2]), interrupt: None };
    let found = found(&case, &wanted).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((found.modes.len(), found.missing()), (3, 0), "{:?}", found.counts);
    for (growth, frequency, waves) in [(0.08505, 2.0613, -2), (0.21498, 3.0645, -2), (0.20006, 4.2095, 2)] {
        let mode = found.modes.iter().find(|mode| (mode.frequency - frequency).abs() < 1e-3);
        let mode = mode.unwrap_or_else(|| panic!("no mode of {frequency} rad/s"));
        assert!((mode.growth - growth).abs() < 2e-4, "{frequency} rad/s: growth {}", mode.growth);
        assert_eq!(mode.waves, Some(waves), "{frequency} rad/s");
    }
}

/// The same on finer meshes, a sector of two cells around each: of fourth order, and with Richardson's extrapolation
/// within 1e-6 of the modulus.
#[test]
fn modes_of_a_ring_are_of_fourth_order() {
    let path = crate::common::file("crates/amontons/benchmarks/squeal-ring.toml");
    let exact = [
        c64::new(0.085_054_91, 2.061_272_5),
        c64::new(0.214_977_63, 3.064_465_19),
        c64::new(0.200_064_46, 4.209_486_89),
    ];
    let all = [8usize, 16, 32].map(|n| {
        let overrides = [
            format!("mesh.angle={:?}", TAU / (4 * n) as f64),
            format!("mesh.n=[{n}, 2]"),
            "cyclic=[{ sides = [\"start\", \"end\"] }]".to_owned(),
        ];
        let case = case::read(&path, &overrides).unwrap_or_else(|error| panic!("{error}"));
        let region = Some(region([0.05, 1.0], [0.0, TAU * 0.8]));
        let wanted = Wanted { kind: ModeKind::Squeal, count: 1, region, waves: Some(&[2]), interrupt: None };
        let found = found(&case, &wanted).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((found.modes.len(), found.missing()), (3, 0), "{n}: {:?}", found.counts);
        [0, 1, 2].map(|k| c64::new(found.modes[k].growth, found.modes[k].frequency))
    });
    for (k, exact) in exact.into_iter().enumerate() {
        let errors = [0, 1, 2].map(|level| (all[level][k] - exact).norm() / exact.norm());
        let richardson = (16.0 * all[2][k] - all[1][k]) / 15.0;
        let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
        assert!(orders.iter().all(|order| (order - 4.0).abs() < 0.3), "{exact}: {errors:?}, {orders:?}");
        assert!((richardson - exact).norm() < 1e-6 * exact.norm(), "{exact}: {richardson}");
    }
}
