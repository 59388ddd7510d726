//! The cases of the pairs: every law, in one to three dimensions, all data growing from rest.
#![allow(clippy::too_many_lines, clippy::too_many_arguments, reason = "a test is one list of cases")]

use std::fmt::Write as _;

use amontons::mesh::{Diagonal, Elements, Mesh};

pub struct Case {
    pub name: &'static str,
    pub mesh: Mesh,
    /// The case without its name, mesh and time; tokens as in `Frame::text`.
    pub template: String,
}

/// Twelve steps of 1/16.
pub const STEPS: usize = 12;

/// All but contact, of a body that is held on top, driven from the sides and by its weight, and heated from within.
fn body(dim: usize, stress_state: &str, weight: f64) -> String {
    let [held, expansion, gravity, left, right] = match dim {
        1 => ["[0]", "<Pa/K|1>", "<v:N/m3|W*min(4*T, 1)>", "", ""],
        2 => [
            "<m|0; 0>",
            "<Pa/K|1, 0.4; 0.4, 1.3>",
            "<N/m3|0; -W*min(4*T, 1)>",
            "<Pa|1.4*T; 0.4*T>",
            "<Pa|-0.8*T*Y; 0.4*T>",
        ],
        _ => [
            "<m|0; 0; 0>",
            "<Pa/K|1, 0.4, 0.1; 0.4, 1.3, 0.2; 0.1, 0.2, 0.9>",
            "<N/m3|0.1*T; -W*min(4*T, 1); 0.2*T>",
            "<Pa|1.4*T; 0.4*T; 0.3*T*Z>",
            "<Pa|-0.8*T*Y; 0.4*T; -0.5*T>",
        ],
    };
    let gravity = gravity.replace('W', &format!("{weight:?}"));
    let (coupling, conductivity) = match dim {
        1 => ("<W/m3|0.5>", "<W/mK|1>"),
        2 => ("<W/m3|0.5, 0.1; 0.1, 0.8>", "<W/mK|1, 0.2; 0.2, 0.7>"),
        _ => ("<W/m3|0.5, 0.1, 0; 0.1, 0.8, 0.2; 0, 0.2, 0.6>", "<W/mK|1, 0.2, 0; 0.2, 0.7, 0.1; 0, 0.1, 1.2>"),
    };
    let sides = if dim == 1 {
        format!("[[boundary]]\non = \"left\"\ndisplacement = {held}\ntemperature = <K|T>\n")
    } else {
        format!(
            "[[boundary]]\non = \"top\"\ndisplacement = {held}\ntemperature = <K|T*X>\n[[boundary]]\non = \"left\"\ntraction = {left}\n\
             convection = {{ coefficient = <W/m2K|0.4>, ambient = <K|2*T> }}\n[[boundary]]\non = \"right\"\ntraction = {right}\nspring = <Pa/m|0.5>\n"
        )
    };
    format!(
        "[material]\ndensity = <kg/m3|1>\nheat_capacity = <J/m3K|1>\nexpansion = {expansion}\ncoupling = {coupling}\nconductivity = {conductivity}\n\
         elasticity = {{ law = \"isotropic\", young = <Pa|20>, poisson = 0.3{stress_state} }}\n\
         viscosity = {{ law = \"lame\", first = <Pas|0.3>, second = <Pas|0.5> }}\n\
         [load]\nbody_force = {gravity}\nheat_source = <W/m3|T>\n{sides}"
    )
}

fn contact(on: &str, laws: &str) -> String {
    format!("[contact]\non = \"{on}\"\n{laws}")
}

const STRAIN: &str = ", stress_state = \"plane-strain\"";
const SHEET: &str = ", stress_state = \"plane-stress\"";

fn plane(name: &'static str, elements: Elements, state: &str, laws: &str) -> Case {
    let mesh = Mesh::rectangle_of(elements, [1.0, 0.8], [5, 4], Diagonal::Right).expect("a rectangle");
    Case { name, mesh, template: body(2, state, 6.0) + &contact("bottom", laws) }
}

fn space(name: &'static str, elements: Elements, n: [usize; 3], laws: &str) -> Case {
    let mesh = Mesh::box_([1.0, 0.8, 0.6], n, elements).expect("a box");
    Case { name, mesh, template: body(3, "", 6.0) + &contact("bottom", laws) }
}

fn revolution(name: &'static str, elements: Elements, laws: &str) -> Case {
    let mut mesh = Mesh::rectangle_of(elements, [1.0, 0.8], [5, 4], Diagonal::Right).expect("a rectangle");
    mesh.points.iter_mut().for_each(|x| x[0] += 0.5);
    let mesh = Mesh { axisymmetric: true, ..mesh };
    // A tensor of a body of revolution has its hoop component last; multiples of the identity do without.
    let template = body(2, "", 6.0)
        .replace("<Pa/K|1, 0.4; 0.4, 1.3>", "<Pa/K|1>")
        .replace("<W/m3|0.5, 0.1; 0.1, 0.8>", "<W/m3|0.5>")
        .replace("<W/mK|1, 0.2; 0.2, 0.7>", "<W/mK|1>");
    Case { name, mesh, template: template + &contact("bottom", laws) }
}

/// A body on another one, 0.01 apart at rest, whose mesh does not match.
fn pair(name: &'static str, dim: usize, elements: [Elements; 2], laws: &str) -> Case {
    let block = |size: [f64; 3], n: [usize; 3], elements: Elements, corner: [f64; 3]| {
        let mesh = if dim == 2 {
            Mesh::rectangle_of(elements, [size[0], size[1]], [n[0], n[1]], Diagonal::Right)
        } else {
            Mesh::box_(size, n, elements)
        };
        mesh.expect("a block").moved(corner)
    };
    let (n, below) = if dim == 2 { ([5, 4, 0], [7, 3, 0]) } else { ([3, 2, 2], [2, 2, 3]) };
    let bodies = [
        ("upper".to_owned(), block([1.0, 0.8, 0.6], n, elements[0], [0.0; 3])),
        (
            "lower".to_owned(),
            block([1.4, 0.4, 0.9], below, elements[1], [-0.2, -0.41, if dim > 2 { -0.1 } else { 0.0 }]),
        ),
    ];
    let mesh = Mesh::assembly(&bodies).expect("two bodies");
    let mut upper = body(dim, if dim == 2 { STRAIN } else { "" }, 6.0);
    for side in ["top", "left", "right"] {
        upper = upper.replace(&format!("on = \"{side}\""), &format!("on = \"upper_{side}\""));
    }
    let held = if dim == 2 { "<m|0; 0>" } else { "<m|0; 0; 0>" };
    let lower = format!("[[boundary]]\non = \"lower_bottom\"\ndisplacement = {held}\ntemperature = <K|0>\n");
    let laws = format!("with = \"lower_top\"\n{laws}");
    Case { name, mesh, template: upper + &lower + &contact("upper_bottom", &laws) }
}

/// A case whose body is not held on top but pressed there by a rigid side, or is rigid as a whole: `on` is the side or
/// the region, and gravity acts besides.
fn rigid(name: &'static str, on: &str, case: Case) -> Case {
    let (held, load, gravity) = match case.mesh.dim {
        2 if case.mesh.axisymmetric => ("<m|0; 0>", "force = <N|0; -3*T>", "<m/s2|0; -0.3*T>"),
        2 => ("<m|0; 0>", "force = <N/m|0.3*T; -3*T>\nmoment = <a:N|0.2*T>\nat = <x|0.6; 0.7>", "<m/s2|0.2*T; -0.3*T>"),
        _ => (
            "<m|0; 0; 0>",
            "force = <N|0.2*T; -2*T; 0.1*T>\nmoment = <a:Nm|0.05*T; 0.02*T; 0.1*T>\nat = <x|0.6; 0.7; 0.35>",
            "<m/s2|0.2*T; -0.3*T; 0.1*T>",
        ),
    };
    let free = case.template.replacen(&format!("displacement = {held}\n"), "", 1);
    assert!(free.len() < case.template.len(), "a body that is held");
    let template =
        free.replacen("[load]\n", &format!("[[rigid]]\non = \"{on}\"\n{load}\n[load]\ngravity = {gravity}\n"), 1);
    Case { name, template, ..case }
}

/// A case with coefficients of body and contact that vary in space, and those of friction and conductance in time.
fn graded(name: &'static str, case: Case) -> Case {
    let changes = [
        ("density = <kg/m3|1>", "density = <kg/m3|1 + 0.5*X>"),
        ("heat_capacity = <J/m3K|1>", "heat_capacity = <J/m3K|1 + 0.3*Y>"),
        ("young = <Pa|20>, poisson = 0.3", "young = <Pa|20 + 8*X*Y>, poisson = <1|0.3 - 0.1*X>"),
        ("first = <Pas|0.3>, second = <Pas|0.5>", "first = <Pas|0.3 + 0.1*Y>, second = <Pas|0.5 + 0.2*X>"),
        (
            "[load]\n",
            "prony = [{ ratio = <1|0.5 + 0.2*X>, time = <s|0.1 + 0.2*Y> }, { ratio = 0.3, time = <s|0.2> }]\n[load]\n",
        ),
        ("stiffness = <Pa/m|1e4>", "stiffness = <Pa/m|1e4*(1 + X)>"),
        ("coefficient = 0.2", "coefficient = <1|0.2 + 0.1*X + 0.1*T>"),
        ("conductance = <W/m2K|1>, width = <m|1e-4>", "conductance = <W/m2K|1 + X*T>, width = <m|1e-4*(1 + X)>"),
    ];
    let mut template = case.template;
    for (old, new) in changes {
        assert_eq!(template.matches(old).count(), 1, "{name}: {old}");
        template = template.replace(old, new);
    }
    for (key, unit, other) in [("coupling", "W/m3", "0.5 + 0.3*X"), ("conductivity", "W/mK", "1 + 0.4*X*Y")] {
        let (before, rest) = template.split_once(&format!("{key} = <")).expect("the key");
        let (_, after) = rest.split_once('>').expect("the end of a token");
        template = format!("{before}{key} = <{unit}|{other}>{after}");
    }
    Case { name, template, ..case }
}

/// A case with coefficients of the body that depend on the temperature, and some of them on space too.
fn thermal(name: &'static str, case: Case) -> Case {
    let table = |unit: &str, values: &str, more: &str| {
        format!("{{ temperature = <K|-20, 40>, value = <{unit}|{values}>{more} }}")
    };
    let space = ", factor = <1|1 + 0.2*X>";
    let changes = [
        ("heat_capacity = <J/m3K|1>", format!("heat_capacity = {}", table("J/m3K", "0.5, 2", ""))),
        ("young = <Pa|20>", format!("young = {}", table("Pa", "30, 10", space))),
        ("second = <Pas|0.5>", format!("second = {}", table("Pas", "0.7, 0.3", ""))),
    ];
    let mut template = case.template;
    for (old, new) in changes {
        assert_eq!(template.matches(old).count(), 1, "{name}: {old}");
        template = template.replace(old, &new);
    }
    for (key, new) in
        [("expansion", table("Pa/K", "0.5, 1.5", space)), ("conductivity", table("W/mK", "0.4, 2", space))]
    {
        let (before, rest) = template.split_once(&format!("{key} = <")).expect("the key");
        let (_, after) = rest.split_once('>').expect("the end of a token");
        template = format!("{before}{key} = {new}{after}");
    }
    Case { name, template, ..case }
}

/// A case whose linear systems an iteration solves: its levels and smoothers know nothing of axes, units and numbers.
fn iterated(name: &'static str, case: Case) -> Case {
    Case { name, template: format!("solver = {{ solver = \"iterative\" }}\n{}", case.template), ..case }
}

/// A case whose right side, and in space its front, slides in a plane, by `front` in a moving one: at the edges the top
/// holds them, and contact ends at them.
fn rollers(name: &'static str, front: &str, case: Case) -> Case {
    let (before, rest) = case.template.split_once("[[boundary]]\non = \"right\"").expect("the right side");
    let (_, after) = rest.split_once("spring = <Pa/m|0.5>\n").expect("its spring");
    let mut sides = "[[boundary]]\non = \"right\"\nnormal_displacement = <m|0.004*T*(1 + Y)>\n".to_owned();
    if case.mesh.dim == 3 {
        let _ = writeln!(sides, "[[boundary]]\non = \"front\"\nnormal_displacement = <m|{front}>");
    }
    Case { name, template: format!("{before}{sides}{after}"), ..case }
}

/// A sector of a ring, or of a tube, whose neighbours do as it does; contact at the bore.
fn sector(name: &'static str, dim: usize, elements: Elements, laws: &str) -> Case {
    let angle = Some(std::f64::consts::TAU / 5.0);
    let (mesh, center, axis) = if dim == 2 {
        (Mesh::ring([0.5, 1.2], angle, [3, 5], elements), "<x|0; 0>", "")
    } else {
        (Mesh::cylinder([0.5, 1.2], angle, 0.6, [2, 3, 2], elements), "<x|0; 0; 0>", "axis = <1|0; 0; 1>\n")
    };
    let mut mesh = mesh.expect("a sector");
    for (new, old) in [("held", "outer"), ("base", "inner")] {
        let set = mesh.facets.remove(old).expect("a side");
        mesh.facets.insert(new.to_owned(), set);
    }
    let whole = body(dim, if dim == 2 { STRAIN } else { "" }, 6.0);
    let (loads, _) = whole.split_once("[[boundary]]").expect("the sides");
    let held = if dim == 2 { "<m|0; 0>" } else { "<m|0; 0; 0>" };
    let sides = format!(
        "[[boundary]]\non = \"held\"\ndisplacement = {held}\ntemperature = <K|T>\n\
         [[cyclic]]\nsides = [\"start\", \"end\"]\ncenter = {center}\n{axis}"
    );
    Case { name, mesh, template: format!("{loads}{sides}{}", contact("base", laws)) }
}

pub fn all() -> Vec<Case> {
    let laws = "normal = { law = \"compliance\", stiffness = <Pa/m|1e4> }\nfriction = { law = \"coulomb\", coefficient = 0.2 }\n\
                heat = { law = \"ramp\", conductance = <W/m2K|1>, width = <m|1e-4>, foundation_temperature = <K|10*T> }\n";
    let mut all = with_constants();
    let rigid = "normal = { law = \"signorini\" }\nfriction = { law = \"coulomb\", coefficient = 0.3 }\nfrictional_heat = 0.6\n\
                 heat = { law = \"pressure\", coefficient = <W/m2K/Pa.95|0.4>, exponent = 0.95 }\n";
    let held = "normal = { law = \"signorini\" }\nfriction = { law = \"coulomb\", coefficient = 0.3 }\n\
                heat = { law = \"pressure\", coefficient = <W/m2K/Pa.95|0.4>, exponent = 0.95, foundation_temperature = <K|3*T> }\n";
    let soft = "normal = { law = \"compliance\", stiffness = <Pa/m|1e3> }\nfriction = { law = \"coulomb\", coefficient = 0.3 }\n\
                heat = { law = \"constant\", conductance = <W/m2K|2> }\n";
    all.push(pair("two bodies: Signorini, Coulomb (P1)", 2, [Elements::P1; 2], rigid));
    let updated = format!("geometry = \"updated\"\n{rigid}");
    all.push(pair("two bodies: Signorini, Coulomb, updated (P1 on Q1)", 2, [Elements::P1, Elements::Q1], &updated));
    all.push(pair("two bodies: compliance, Coulomb (Q1 on P1)", 3, [Elements::Q1, Elements::P1], soft));
    all.push(graded("coefficients in space, P1 in the plane", plane("", Elements::P1, STRAIN, laws)));
    all.push(graded("coefficients in space, Q2 in the plane", plane("", Elements::Q2, SHEET, laws)));
    all.push(graded("coefficients in space, P1", space("", Elements::P1, [3, 2, 2], laws)));
    all.push(thermal("coefficients of the temperature, P1 in the plane", plane("", Elements::P1, STRAIN, laws)));
    all.push(thermal("coefficients of the temperature, P1", space("", Elements::P1, [3, 2, 2], laws)));
    all.push(rollers("sides that slide, P1 in the plane", "", plane("", Elements::P1, STRAIN, laws)));
    all.push(rollers("sides that slide, Q2 in the plane", "", plane("", Elements::Q2, SHEET, held)));
    all.push(rollers(
        "sides that slide, quadratic tetrahedra",
        "-0.003*T*(1 + X)",
        space("", Elements::P2, [2, 2, 1], held),
    ));
    all.push(rollers("sides that slide, hexahedra", "0", space("", Elements::Q1, [3, 2, 2], laws)));
    all.push(rollers(
        "by an iteration: sides that slide",
        "-0.003*T*(1 + X)",
        iterated("", space("", Elements::P1, [6, 5, 5], laws)),
    ));
    all.push(self::rigid("a rigid side, P1 in the plane", "top", plane("", Elements::P1, STRAIN, laws)));
    all.push(self::rigid("a rigid side, hexahedra", "top", space("", Elements::Q1, [3, 2, 2], held)));
    all.push(self::rigid("a rigid side of revolution, Q2", "top", revolution("", Elements::Q2, laws)));
    let bodies = [Elements::P1, Elements::Q1];
    all.push(self::rigid("a rigid body on another one (P1 on Q1)", "upper", pair("", 2, bodies, rigid)));
    all.push(self::rigid("a rigid body on another one, updated", "upper", pair("", 2, bodies, &updated)));
    all.push(iterated(
        "by an iteration: a rigid side on another body (Q1)",
        self::rigid("", "upper_top", pair("", 3, [Elements::Q1; 2], soft)),
    ));
    all.push(sector("sectors, quadrilaterals", 2, Elements::Q1, laws));
    all.push(sector("sectors, quadratic triangles", 2, Elements::P2, held));
    all.push(sector("sectors in space, hexahedra", 3, Elements::Q1, held));
    all.push(iterated("by an iteration: sectors in space", sector("", 3, Elements::Q1, laws)));
    all.push(iterated(
        "by an iteration: compliance, Coulomb, ramp (tetrahedra)",
        space("", Elements::P1, [6, 5, 5], laws),
    ));
    all.push(iterated("by an iteration: Signorini, Coulomb (hexahedra)", space("", Elements::Q1, [6, 5, 5], held)));
    all.push(iterated("by an iteration, two bodies: Signorini, Coulomb (P2)", pair("", 3, [Elements::P2; 2], rigid)));
    all.push(iterated("by an iteration, two bodies: compliance, Coulomb (Q1)", pair("", 3, [Elements::Q1; 2], soft)));
    all
}

fn with_constants() -> Vec<Case> {
    let rod = Mesh::interval(1.0, 10, Elements::P1).expect("an interval");
    vec![
        plane(
            "compliance, Coulomb, ramp (P1)",
            Elements::P1,
            SHEET,
            "normal = { law = \"compliance\", stiffness = <Pa/m|1e4> }\nfriction = { law = \"coulomb\", coefficient = 0.2 }\n\
             heat = { law = \"ramp\", conductance = <W/m2K|1>, width = <m|1e-4>, foundation_temperature = <K|10*T> }\n",
        ),
        plane(
            "power, weakening, gap (P2)",
            Elements::P2,
            STRAIN,
            "gap = <m|0.01*(X - 0.3)^2>\nnormal = { law = \"power\", stiffness = <Pa/m1.5|3e3>, exponent = 1.5 }\n\
             friction = { law = \"static-kinetic\", static = 0.4, kinetic = 0.3, decay_speed = <m/s|0.5> }\nfrictional_heat = 0.5\n",
        ),
        plane(
            "stop, capped Coulomb, moving foundation (Q1)",
            Elements::Q1,
            SHEET,
            "normal = { law = \"stop\", stiffness = <Pa/m|200>, depth = <m|0.003> }\nfriction = { law = \"coulomb\", coefficient = 0.3, cap = <Pa|0.8> }\n\
             foundation_velocity = <m/s|-0.3*T; 0.1*T>\nfrictional_heat = 1\n\
             heat = { law = \"pressure\", coefficient = <W/m2K/Pa.95|0.4>, exponent = 0.95, foundation_temperature = <K|3*T> }\n",
        ),
        plane(
            "Signorini, Tresca, gas in the gap (Q2)",
            Elements::Q2,
            STRAIN,
            "normal = { law = \"signorini\" }\nfriction = { law = \"tresca\", bound = <Pa|0.3> }\n\
             heat = { law = \"gap\", conductivity = <W/mK|0.01>, roughness = <m|0.02>, foundation_temperature = <K|3*T> }\n",
        ),
        plane(
            "Signorini, Coulomb, wear, power conductance (P1)",
            Elements::P1,
            STRAIN,
            "normal = { law = \"compliance\", stiffness = <Pa/m|500> }\nfriction = { law = \"coulomb\", coefficient = 0.4 }\n\
             wear = { law = \"archard\", coefficient = <1/Pa|0.05> }\nfoundation_velocity = <m/s|0.5*T; 0>\n\
             heat = { law = \"power\", coefficient = <W/m3K|50>, exponent = 1, foundation_temperature = <K|3*T> }\n",
        ),
        plane(
            "foundation that slides out of the plane, wear (Q1)",
            Elements::Q1,
            STRAIN,
            "normal = { law = \"compliance\", stiffness = <Pa/m|500> }\nfriction = { law = \"static-kinetic\", static = 0.4, kinetic = 0.3, decay_speed = <m/s|0.5> }\n\
             wear = { law = \"archard\", coefficient = <1/Pa|0.05> }\nfoundation_velocity = <m/s|0.5*T; 0; 0.3 - 0.2*X>\nfrictional_heat = 0.5\n",
        ),
        plane(
            "Gauss points (P1)",
            Elements::P1,
            SHEET,
            "quadrature = \"gauss\"\nnormal = { law = \"compliance\", stiffness = <Pa/m|1e3> }\nfriction = { law = \"coulomb\", coefficient = 0.2 }\n\
             heat = { law = \"ramp\", conductance = <W/m2K|1>, width = <m|1e-3>, foundation_temperature = <K|10*T> }\n",
        ),
        plane(
            "Signorini on a disc, updated (P2)",
            Elements::P2,
            STRAIN,
            "obstacle = { shape = \"sphere\", center = <x|0.4; -4.005>, radius = <m|4>, geometry = \"updated\" }\n\
             normal = { law = \"signorini\" }\nfriction = { law = \"coulomb\", coefficient = 0.5 }\n",
        ),
        space(
            "compliance, Coulomb, ramp (tetrahedra)",
            Elements::P1,
            [3, 2, 2],
            "normal = { law = \"compliance\", stiffness = <Pa/m|1e4> }\nfriction = { law = \"coulomb\", coefficient = 0.2 }\n\
             heat = { law = \"ramp\", conductance = <W/m2K|1>, width = <m|1e-4>, foundation_temperature = <K|10*T> }\n",
        ),
        space(
            "compliance, orthotropic friction (hexahedra)",
            Elements::Q1,
            [3, 2, 2],
            "normal = { law = \"compliance\", stiffness = <Pa/m|1e3> }\n\
             friction = { law = \"orthotropic\", coefficients = [0.1, 0.4], direction = <1|1; 0; 0.5> }\nfrictional_heat = 0.7\n",
        ),
        space(
            "Signorini, Coulomb (quadratic tetrahedra)",
            Elements::P2,
            [2, 2, 1],
            "normal = { law = \"signorini\" }\nfriction = { law = \"coulomb\", coefficient = 0.3 }\n\
             heat = { law = \"pressure\", coefficient = <W/m2K/Pa.95|0.4>, exponent = 0.95, foundation_temperature = <K|3*T> }\n",
        ),
        revolution(
            "revolution: Signorini, Coulomb (P1)",
            Elements::P1,
            "normal = { law = \"signorini\" }\nfriction = { law = \"coulomb\", coefficient = 0.3 }\n\
             heat = { law = \"pressure\", coefficient = <W/m2K/Pa.95|0.4>, exponent = 0.95, foundation_temperature = <K|3*T> }\n",
        ),
        revolution(
            "revolution: compliance, Coulomb (P2)",
            Elements::P2,
            "normal = { law = \"compliance\", stiffness = <Pa/m|1e3> }\nfriction = { law = \"coulomb\", coefficient = 0.3 }\n",
        ),
        Case {
            name: "rod: damped layer, ramp",
            mesh: rod,
            template: body(1, "", 3.0)
                + &contact(
                    "right",
                    "gap = <m|0.01>\nnormal = { law = \"damped\", stiffness = <Pa/m|100>, damping = <Pas/m|3> }\n\
                     heat = { law = \"ramp\", conductance = <W/m2K|1>, width = <m|1e-3>, foundation_temperature = <K|10*T> }\n",
                ),
        },
    ]
}
