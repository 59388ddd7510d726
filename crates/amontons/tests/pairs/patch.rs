//! Uniform stress through two bodies whose meshes have nothing in common: turned against each other in space, and on an
//! inclined joint on either side of its angle of friction.

use std::sync::Arc;

use crate::common;
use amontons::case::{self, Source};
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{self, RunError, Settings};

/// The problem of a text whose points are moved, each by its number and place.
fn moved(text: &str, to: impl Fn(usize, &[f64; 3]) -> [f64; 3]) -> Problem {
    let read = case::parse(&Source::new("patch.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    common::changed(&read.problem, |data| {
        let mut mesh = (*data.mesh).clone();
        mesh.points.iter_mut().enumerate().for_each(|(i, x)| *x = to(i, x));
        data.mesh = Arc::new(mesh);
    })
}

fn run_of(problem: &Problem) -> Result<Memory, RunError> {
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    run::run(problem, &settings, &mut [&mut memory])?;
    Ok(memory)
}

/// A joint at the angle φ, of 5 cells below and 7 above, on which the uniform stress −p e_y⊗e_y, p = 1, acts.
fn joint(tangent: f64, friction: f64, time: &str, density: f64) -> Problem {
    let young = 1e4;
    let widening = 0.3 * 1.3 / young;
    let text = format!(
        "name = \"joint\"\n[mesh]\nkind = \"blocks\"\n\
         [[mesh.blocks]]\nname = \"lower\"\nsize = [1, 1]\nn = [5, 4]\n\
         [[mesh.blocks]]\nname = \"upper\"\nsize = [1, 1]\nn = [7, 5]\norigin = [0, 1]\n\
         [time]\n{time}\n[material]\ndensity = {density:?}\n\
         elasticity = {{ law = \"isotropic\", young = {young:?}, poisson = 0.3, stress_state = \"plane-strain\" }}\n\
         [[boundary]]\non = \"lower_bottom\"\ndisplacement = [\"{widening:?}*x\", 0]\n\
         [[boundary]]\non = \"upper_top\"\ntraction = [0, -1]\n\
         [contact]\non = \"upper_bottom\"\nwith = \"lower_top\"\nnormal = {{ law = \"signorini\" }}\n\
         friction = {{ law = \"coulomb\", coefficient = {friction:?} }}\n"
    );
    moved(&text, |_, &[x, y, z]| {
        let rise = tangent * (x - 0.5);
        [x, if y <= 1.0 { y * (1.0 + rise) } else { 2.0 - (2.0 - y) * (1.0 - rise) }, z]
    })
}

/// A joint sticks if and only if μ ≥ tan φ: one hundredth above it bears p cos²φ and p sin φ cos φ without slip.
#[test]
fn a_joint_sticks_above_its_angle_of_friction() {
    for angle in [10f64, 20.0, 30.0] {
        let (sine, cosine) = angle.to_radians().sin_cos();
        let memory = run_of(&joint(sine / cosine, 1.01 * sine / cosine, "end = 1\nsteps = 1", 0.0)).expect("a run");
        let states = &memory.reports[0].contact.states;
        assert_eq!(states.len(), 8);
        for state in states {
            let tangential = state.q.iter().map(|q| q * q).sum::<f64>().sqrt();
            assert!((state.pressure - cosine * cosine).abs() < 1e-9, "{angle}°: {state:?}");
            assert!((tangential - sine * cosine).abs() < 1e-9, "{angle}°: {state:?}");
            assert!(state.slip.iter().all(|slip| slip.abs() < 1e-12), "{angle}°: {state:?}");
        }
    }
}

/// A number with four digits after the point.
fn four(value: f64) -> String {
    format!("{value:.4}").trim_end_matches('0').to_owned()
}

/// One hundredth below it slides: without inertia that is an error with its name, with inertia the upper body gains
/// p (sin φ − μ cos φ)/(ρ h) a second along the joint.
#[test]
fn a_joint_slides_below_its_angle_of_friction() {
    for angle in [10f64, 20.0, 30.0] {
        let (sine, cosine) = angle.to_radians().sin_cos();
        let (tangent, friction) = (sine / cosine, 0.99 * sine / cosine);
        let refused = run_of(&joint(tangent, friction, "end = 1\nsteps = 1", 0.0)).expect_err("an error");
        // Along the joint, turned by the angle.
        let motion = format!("body `upper` moves along ({}, {})", four(cosine), four(sine));
        assert!(refused.to_string().contains(&motion), "{angle}°: {refused}, expected {motion}");
        let problem = joint(tangent, friction, "end = 1\nsteps = 100", 1.0);
        let memory = run_of(&problem).expect("a run");
        let upper: Vec<usize> = (30..problem.mesh.points.len()).collect();
        let speed = |m: usize| {
            let along = |&i: &usize| -(memory.states[m].w[2 * i] * cosine + memory.states[m].w[2 * i + 1] * sine);
            upper.iter().map(along).sum::<f64>() / upper.len() as f64
        };
        let gained = (speed(100) - speed(50)) / 0.5;
        let expected = sine - friction * cosine;
        assert!((gained - expected).abs() < 1e-2 * expected, "{angle}°: {gained}, {expected}");
    }
}

/// Tetrahedra under hexahedra, whose nodes on the joint are turned by up to 30° and shifted: the stress stays uniform.
#[test]
fn meshes_turned_against_each_other_pass_a_uniform_stress() {
    let text = "name = \"turned\"\n[mesh]\nkind = \"blocks\"\n\
        [[mesh.blocks]]\nname = \"lower\"\nsize = [1, 1, 1]\nn = [5, 2, 4]\nelements = \"P1\"\n\
        [[mesh.blocks]]\nname = \"upper\"\nsize = [1, 1, 1]\nn = [4, 3, 4]\norigin = [0, 1, 0]\nelements = \"Q1\"\n\
        [time]\nend = 1\nsteps = 1\n[material]\ndensity = 0\n\
        elasticity = { law = \"isotropic\", young = 2000, poisson = 0.3 }\n\
        [[boundary]]\non = \"lower_left\"\ndisplacement = [0, \"free\", \"free\"]\n\
        [[boundary]]\non = \"upper_left\"\ndisplacement = [0, \"free\", \"free\"]\n\
        [[boundary]]\non = \"lower_back\"\ndisplacement = [\"free\", \"free\", 0]\n\
        [[boundary]]\non = \"upper_back\"\ndisplacement = [\"free\", \"free\", 0]\n\
        [[boundary]]\non = \"lower_bottom\"\ndisplacement = [\"free\", 0, \"free\"]\n\
        [[boundary]]\non = \"upper_top\"\npressure = 25\n\
        [contact]\non = \"upper_bottom\"\nwith = \"lower_top\"\nnormal = { law = \"signorini\" }\n";
    let lower = 6 * 3 * 5;
    let problem = moved(text, |i, &[x, y, z]| {
        if i < lower {
            return [x, y, z];
        }
        // Outlines stay: the angle is 30° in the middle and zero on the sides.
        let bump = 16.0 * x * (1.0 - x) * z * (1.0 - z);
        let (sine, cosine) = (30f64.to_radians() * bump).sin_cos();
        let [a, b] = [x - 0.5 + 0.07 * bump, z - 0.5 - 0.04 * bump];
        [0.5 + cosine * a - sine * b, y, 0.5 + sine * a + cosine * b]
    });
    let memory = run_of(&problem).expect("a run");
    let states = &memory.reports[0].contact.states;
    assert!(states.iter().all(|state| (state.pressure - 25.0).abs() < 25.0 * 1e-10), "{states:?}");
    let u = &memory.states.last().expect("a state").u;
    for (i, x) in problem.mesh.points.iter().enumerate() {
        let exact = [0.3 * x[0], -x[1], 0.3 * x[2]].map(|value| value * 25.0 / 2000.0);
        for c in 0..3 {
            assert!((u[3 * i + c] - exact[c]).abs() < 1e-10 * 0.025, "{x:?}: {} and {exact:?}", u[3 * i + c]);
        }
    }
}

/// Rings whose polygons do not match, tied and without a load: nothing is stressed. With a load they move as one ring
/// does.
#[test]
fn a_tie_of_unlike_polygons_is_at_rest_without_a_load() {
    let rings = |blocks: &str, more: &str, outer: &str, traction: &str| {
        let text = format!(
            "name = \"rings\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"blocks\"\nblocks = [{blocks}]\n\
             [time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0\n\
             elasticity = {{ law = \"isotropic\", young = 100.0, poisson = 0.3, stress_state = \"plane-strain\" }}\n\
             [[boundary]]\non = \"i_inner\"\ndisplacement = [0, 0]\n\
             [[boundary]]\non = \"{outer}\"\ntraction = {traction}\n{more}"
        );
        moved(&text, |_, x| *x)
    };
    let largest = |problem: &Problem| common::largest(&run_of(problem).expect("a run").states[1].u);
    let one = "{ name = \"i\", radii = [1.0, 2.0], n = [6, 24], elements = \"Q2\" }";
    let whole = largest(&rings(one, "", "i_outer", "[0.1, 0]"));
    let two = "{ name = \"i\", radii = [1.0, 1.5], n = [3, 24] }, { name = \"o\", radii = [1.5, 2.0], n = [3, 16] }";
    for (on, with) in [("o_inner", "i_outer"), ("i_outer", "o_inner")] {
        let tie = format!(
            "[contact]\non = \"{on}\"\nwith = \"{with}\"\nnormal = {{ law = \"bilateral\" }}\n\
             friction = {{ law = \"stick\" }}\n"
        );
        assert!(largest(&rings(two, &tie, "o_outer", "[0, 0]")) < 1e-14, "{on}");
        let tied = largest(&rings(two, &tie, "o_outer", "[0.1, 0]"));
        assert!((tied / whole - 1.0).abs() < 0.1, "{on}: {tied} of {whole}");
    }
}

/// Two blocks beside each other, cut at c, on a table whose facets they do not match, all pressed by 1.
fn two_on_a_table(dim: usize, elements: [&str; 2], cells: [usize; 3], cut: f64, side: Option<&str>) -> Problem {
    let vector = |x: &str, y: &str, z: &str| if dim == 2 { format!("[{x}, {y}]") } else { format!("[{x}, {y}, {z}]") };
    let block = |name: &str, [x, y]: [f64; 2], length: f64, n: usize, elements: &str, across: &str| {
        format!(
            "[[mesh.blocks]]\nname = \"{name}\"\nelements = \"{elements}\"\nsize = {}\norigin = {}\nn = {}\n",
            vector(&format!("{length:?}"), "0.5", "1.0"),
            vector(&format!("{x:?}"), &format!("{y:?}"), "0.0"),
            vector(&n.to_string(), "2", across)
        )
    };
    let held = |on: &str, displacement: String| format!("[[boundary]]\non = \"{on}\"\ndisplacement = {displacement}\n");
    let mut text = String::from("name = \"two\"\n[mesh]\nkind = \"blocks\"\n");
    text += &block("table", [0.0, -0.5], 1.0, cells[0], elements[0], "2");
    text += &block("a", [0.0, 0.0], cut, cells[1], elements[1], "3");
    text += &block("b", [cut, 0.0], 1.0 - cut, cells[2], elements[1], "3");
    text += "[time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 0\n\
             [material.elasticity]\nlaw = \"isotropic\"\nyoung = 10\npoisson = 0.3\n";
    text += if dim == 2 { "stress_state = \"plane-strain\"\n" } else { "" };
    for side in ["table_left", "a_left", "b_right"] {
        text += &held(side, vector("0", "\"free\"", "\"free\""));
    }
    for body in ["table", "a", "b"].iter().filter(|_| dim == 3) {
        text += &held(&format!("{body}_front"), vector("\"free\"", "\"free\"", "0"));
    }
    text += &held("table_bottom", vector("\"free\"", "0", "\"free\""));
    for body in ["a", "b"] {
        text += &format!("[[boundary]]\non = \"{body}_top\"\ntraction = {}\n", vector("0", "-1", "0"));
        text +=
            &format!("[[contact]]\non = \"{body}_bottom\"\nwith = \"table_top\"\nnormal = {{ law = \"signorini\" }}\n");
        text += &side.map_or_else(String::new, |side| format!("nonmortar = \"{}\"\n", side.replace("body", body)));
    }
    moved(&text, |_, x| *x)
}

/// A uniform pressure passes where either contact covers facets in part, by slivers, too, with the points on either
/// side. In space a contact that covers a single row of facets of the table beside another contact is left out: the
/// functions on it are constant on each facet, and one more than facets, so that they do not determine the pressures.
#[test]
fn a_uniform_pressure_passes_through_partly_covered_facets() {
    let mut random = common::Random(29);
    let quick = [["P1", "P1"], ["Q1", "Q1"], ["P2", "P2"], ["Q2", "Q2"], ["Q1", "P2"], ["Q2", "Q1"]];
    for (dim, elements) in quick.into_iter().map(|e| (2, e)).chain([(3, ["P1", "P1"]), (3, ["Q1", "Q1"])]) {
        for cells in [[5, 3, 4], [8, 2, 2], [3, 7, 5]] {
            let anywhere = 0.5 + 0.3 * random.number();
            for cut in [0.43, 0.6001, 0.3999].into_iter().chain((dim == 2).then_some(anywhere)) {
                for side in [None, Some("body_bottom"), Some("table_top")] {
                    let what = format!("{dim}, {elements:?}, {cells:?}, cut {cut}, {side:?}");
                    let memory = run_of(&two_on_a_table(dim, elements, cells, cut, side));
                    let memory = memory.unwrap_or_else(|error| panic!("{what}: {error}"));
                    for state in &memory.reports[0].contact.states {
                        assert!((state.pressure - 1.0).abs() < 1e-10, "{what}: {}", state.pressure);
                    }
                }
            }
        }
    }
}
