//! Pairs of texts that say the same.
#![allow(clippy::too_many_lines, clippy::too_many_arguments, reason = "a test is one list of cases")]

use std::collections::BTreeMap;
use std::sync::Arc;

use amontons::mesh::{Diagonal, Elements, Mesh};

use crate::cases::STEPS;
use crate::frame::STEP;
use crate::writer::{self, Format};

pub struct Way {
    pub name: &'static str,
    pub one: String,
    pub other: String,
    pub files: BTreeMap<String, Arc<[u8]>>,
}

const MESH: &str = "mesh = { kind = \"rectangle\", size = [1, 0.8], n = [5, 4] }\n";
const MATERIAL: &str = "density = 1\nheat_capacity = 1\nexpansion = 1.5\ncoupling = 0.5\nconductivity = 0.7\n\
    elasticity = { law = \"isotropic\", young = 20, poisson = 0.25, stress_state = \"plane-strain\" }\nviscosity = { law = \"lame\", first = 0.3, second = 0.5 }\n";
const HELD: &str = "[[boundary]]\non = \"top\"\ndisplacement = [0, 0]\ntemperature = \"t\"\n";
const DRIVEN: &str =
    "[[boundary]]\non = \"left\"\ntraction = [1.4, 0.4]\n[[boundary]]\non = \"right\"\npressure = \"0.8*t\"\n";
const LOAD: &str = "[load]\nbody_force = [0, -6]\n";
const NORMAL: &str = "normal = { law = \"compliance\", stiffness = 1000 }\n";
const FRICTION: &str = "friction = { law = \"coulomb\", coefficient = 0.3 }\n";
const HEAT: &str = "heat = { law = \"ramp\", conductance = 1, width = 1e-3, foundation_temperature = 5 }\n";

/// The case that both texts start from.
fn case() -> String {
    let time = format!("time = {{ end = {:?}, steps = {STEPS} }}\n", STEPS as f64 * STEP);
    format!(
        "name = \"pair\"\n{MESH}{time}[material]\n{MATERIAL}{LOAD}{HELD}{DRIVEN}[contact]\non = \"bottom\"\n{NORMAL}{FRICTION}{HEAT}"
    )
}

/// The case with parts replaced, each of which it must have.
fn with(parts: &[(&str, &str)]) -> String {
    parts.iter().fold(case(), |text, (from, to)| {
        assert!(text.contains(from), "the case has no {from}");
        text.replacen(from, to, 1)
    })
}

fn rectangle() -> Mesh {
    Mesh::rectangle_of(Elements::P1, [1.0, 0.8], [5, 4], Diagonal::Right).expect("a rectangle")
}

/// The rectangle in two regions, parted at x = 0.4.
fn parted() -> Mesh {
    let mut mesh = rectangle();
    let whole = mesh.blocks.remove(0);
    for (region, name) in ["soft", "hard"].into_iter().enumerate() {
        let centre =
            |cell: &[u32]| cell.iter().map(|&node| mesh.points[node as usize][0]).sum::<f64>() / cell.len() as f64;
        let nodes = whole.cells().filter(|cell| (centre(cell) > 0.4) == (region == 1)).flatten().copied().collect();
        mesh.blocks.push(amontons::mesh::Block { element: whole.element, region, nodes });
        mesh.regions.truncate(region);
        mesh.regions.push(name.to_owned());
    }
    mesh
}

pub fn all() -> Vec<Way> {
    let files: BTreeMap<String, Arc<[u8]>> = [("body.msh", rectangle()), ("parted.msh", parted())]
        .into_iter()
        .map(|(name, mesh)| {
            (name.to_owned(), writer::write(&mesh, Format { version: 2, binary: None, step: 1, spread: 1 }).into())
        })
        .collect();
    let way = |name: &'static str, one: &[(&str, &str)], other: &[(&str, &str)]| Way {
        name,
        one: with(one),
        other: with(other),
        files: files.clone(),
    };
    // 𝓔 of E = 20, ν = 0.25: λ = G = 8.
    let voigt = "[[24, 8, 8, 0, 0, 0], [8, 24, 8, 0, 0, 0], [8, 8, 24, 0, 0, 0], [0, 0, 0, 8, 0, 0], [0, 0, 0, 0, 8, 0], [0, 0, 0, 0, 0, 8]]";
    let isotropic = "{ law = \"isotropic\", young = 20, poisson = 0.25, stress_state = \"plane-strain\" }";
    let anisotropic = format!("{{ law = \"anisotropic\", voigt = {voigt}, stress_state = \"plane-strain\" }}");
    let orthotropic = "{ law = \"orthotropic\", young = [20, 20, 20], poisson = [0.25, 0.25, 0.25], shear = [8, 8, 8], stress_state = \"plane-strain\" }";
    let material = format!("[material]\n{MATERIAL}");
    let regions = format!(
        "{material}[[region]]\non = \"soft\"\n[region.material]\n{MATERIAL}[[region]]\non = \"hard\"\n[region.material]\n{MATERIAL}"
    );
    let gap = format!("gap = 0.01\n{NORMAL}");
    let obstacle = |shape: &str| format!("obstacle = {{ {shape} }}\n{NORMAL}");
    let table = "{ law = \"table\", penetration = [0, 0.001, 0.5], pressure = [0, 1, 500] }";
    vec![
        way("a rectangle and its mesh file", &[], &[(MESH, "mesh = { kind = \"file\", file = \"body.msh\" }\n")]),
        way(
            "two regions of one material",
            &[],
            &[(MESH, "mesh = { kind = \"file\", file = \"parted.msh\" }\n"), (&material, &regions)],
        ),
        way("a number and an expression", &[], &[("[1.4, 0.4]", "[\"1.4 + 0*x\", \"0.2 + 0.2*cos(0*t)\"]")]),
        way("an expression and a table", &[], &[("\"0.8*t\"", "{ times = [0, 0.25, 2], values = [0, 0.2, 1.6] }")]),
        way("a pressure and a traction", &[], &[("pressure = \"0.8*t\"", "traction = [\"-0.8*t\", 0]")]),
        way(
            "a body force and the weight by a table",
            &[],
            &[("[0, -6]", "[0, { times = [0, 9], values = [-3, -3], factor = 2 }]")],
        ),
        way("isotropic and anisotropic", &[], &[(isotropic, &anisotropic)]),
        way("isotropic and orthotropic", &[], &[(isotropic, orthotropic)]),
        way("a number and a matrix", &[], &[("conductivity = 0.7", "conductivity = [[0.7, 0], [0, 0.7]]")]),
        way("one contact and a list of one", &[], &[("[contact]", "[[contact]]")]),
        way(
            "a gap and a plane",
            &[(NORMAL, &gap)],
            &[(NORMAL, &obstacle("shape = \"plane\", point = [0.3, -0.01], normal = [0, 2]"))],
        ),
        way(
            "a disc and a cylinder",
            &[(NORMAL, &obstacle("shape = \"sphere\", center = [0.4, -4.005], radius = 4"))],
            &[(NORMAL, &obstacle("shape = \"cylinder\", center = [0.4, -4.005], radius = 4"))],
        ),
        way(
            "a disc and the level of its distance",
            &[(NORMAL, &obstacle("shape = \"sphere\", center = [0.4, -4.005], radius = 4"))],
            &[(NORMAL, &obstacle("shape = \"surface\", level = \"sqrt((x - 0.4)^2 + (y + 4.005)^2) - 4\""))],
        ),
        way(
            "a plane that moves and a gap that closes",
            &[(NORMAL, &obstacle("shape = \"plane\", point = [0, \"0.002*t - 0.005\"], normal = [0, 1]"))],
            &[(NORMAL, &format!("gap = \"0.005 - 0.002*t\"\n{NORMAL}"))],
        ),
        way(
            "compliance and power 1",
            &[],
            &[("{ law = \"compliance\", stiffness = 1000 }", "{ law = \"power\", stiffness = 1000, exponent = 1 }")],
        ),
        way("compliance and a table", &[], &[("{ law = \"compliance\", stiffness = 1000 }", table)]),
        way(
            "compliance and a stop out of reach",
            &[],
            &[("{ law = \"compliance\", stiffness = 1000 }", "{ law = \"stop\", stiffness = 1000, depth = 1 }")],
        ),
        way(
            "compliance and no damping",
            &[],
            &[("{ law = \"compliance\", stiffness = 1000 }", "{ law = \"damped\", stiffness = 1000, damping = 0 }")],
        ),
        way(
            "Signorini and a stop at 0",
            &[("{ law = \"compliance\", stiffness = 1000 }", "{ law = \"signorini\" }")],
            &[("{ law = \"compliance\", stiffness = 1000 }", "{ law = \"stop\", stiffness = 7, depth = 0 }")],
        ),
        way(
            "Coulomb and equal coefficients",
            &[],
            &[(FRICTION, "friction = { law = \"static-kinetic\", static = 0.3, kinetic = 0.3 }\n")],
        ),
        way(
            "Coulomb and a cap out of reach",
            &[],
            &[(FRICTION, "friction = { law = \"coulomb\", coefficient = 0.3, cap = 1e3 }\n")],
        ),
        way(
            "Coulomb and a constant of the pressure",
            &[],
            &[(FRICTION, "friction = { law = \"pressure\", pressure = [0, 9], coefficient = [0.3, 0.3] }\n")],
        ),
        way(
            "Coulomb and a constant of the speed",
            &[],
            &[(FRICTION, "friction = { law = \"slip-rate\", speed = [0, 1], coefficient = [0.3, 0.3] }\n")],
        ),
        way(
            "Coulomb and a constant of the temperature",
            &[],
            &[(FRICTION, "friction = { law = \"temperature\", temperature = [0, 1], coefficient = [0.3, 0.3] }\n")],
        ),
        way(
            "a law and a sum of one",
            &[],
            &[(
                HEAT,
                "heat = { law = \"sum\", laws = [{ law = \"ramp\", conductance = 0.4, width = 1e-3 }, { law = \"ramp\", conductance = 0.6, width = 1e-3 }], foundation_temperature = 5 }\n",
            )],
        ),
        way(
            "a foundation and a moving one at rest",
            &[],
            &[(NORMAL, &format!("foundation_velocity = [\"0*t\", 0]\n{NORMAL}"))],
        ),
    ]
}
