//! Pairs of sides that cannot be, and what is said about them.

use crate::common;
use amontons::case::{self, Source};
use amontons::hypotheses::{self, FindingId, FindingStatus};

/// A pad on a disc; the spoiled line stands for one line of it.
const CASE: &str = r#"
name = "pad-on-disc"
[mesh]
kind = "blocks"
[[mesh.blocks]]
name = "disc"
size = [4.0, 1.0]
n = [7, 2]
[[mesh.blocks]]
name = "pad"
size = [2.0, 1.0]
n = [4, 2]
origin = [1.0, 1.0]
[time]
end = 1.0
steps = 2
[material]
density = 0
heat_capacity = 0
conductivity = 1
elasticity = { law = "isotropic", young = 1e6, poisson = 0.3, stress_state = "plane-strain" }
[[boundary]]
on = "disc_bottom"
displacement = [0, 0]
temperature = 0
[[boundary]]
on = "pad_top"
displacement = [0, -1e-3]
temperature = 1
[contact]
on = "pad_bottom"
with = "disc_top"
normal = { law = "signorini" }
heat = { law = "constant", conductance = 1 }
"#;

fn spoiled(old: &str, new: &str) -> String {
    let text = common::spoil(CASE, old, new);
    common::told(&Source::new("pad.toml", text), &[])
}

macro_rules! faults {
    ($($name:ident: $old:literal => $new:literal, $told:literal;)*) => {$(
        #[test]
        fn $name() {
            let told = spoiled($old, $new);
            assert!(told.contains($told), "{told}\nexpected {}", $told);
        }
    )*};
}

faults! {
    sound: "" => "", "no fault";
    with_itself: "with = \"disc_top\"" => "with = \"pad_bottom\"",
        "contact.with: found \"pad_bottom\" with itself, expected another side; the two faces of one body are two sides with names of their own";
    with_a_side_that_is_not_there: "with = \"disc_top\"" => "with = \"disc_tpo\"",
        "contact.with: found \"disc_tpo\", expected one of the facet sets disc_bottom, disc_left, disc_right, disc_top, pad_bottom, pad_left, pad_right, pad_top; did you mean \"disc_top\"?";
    never_meets: "with = \"disc_top\"" => "with = \"disc_bottom\"",
        "contact.with: found no point of \"pad_bottom\" that faces \"disc_bottom\", expected sides that face each other along their normals; check the names of the sides, the units of the mesh and the orientation of the bodies";
    beside_each_other: "origin = [1.0, 1.0]" => "origin = [5.0, 1.0]",
        "contact.with: found no point of \"pad_bottom\" that faces \"disc_top\"";
    nonmortar_elsewhere: "with = \"disc_top\"" => "with = \"disc_top\"\nnonmortar = \"pad_top\"",
        "contact.nonmortar: found \"pad_top\", expected one of the sides of the pair, \"pad_bottom\" or \"disc_top\"";
    nonmortar_of_a_foundation: "with = \"disc_top\"" => "nonmortar = \"pad_bottom\"",
        "contact.nonmortar: found `nonmortar` without `with`, expected a pair of deformable sides; give `with`, the other side of the pair, or remove it";
    no_foundation_temperature: "with = \"disc_top\"" => "",
        "contact.heat.foundation_temperature: found no such key, expected a number, an expression in x, y, z, t or a table in time";
    a_foundation_temperature: "conductance = 1 }" => "conductance = 1, foundation_temperature = 3 }",
        "contact.heat.foundation_temperature: found `heat.foundation_temperature` besides `with`, expected a rigid foundation, or the other side of a pair, not both; remove one of them";
    an_obstacle: "with = \"disc_top\"" => "with = \"disc_top\"\nobstacle = { shape = \"plane\", point = [0, 0], normal = [0, 1] }",
        "contact.obstacle: found `obstacle` besides `with`, expected a rigid foundation, or the other side of a pair, not both";
    gauss_points: "with = \"disc_top\"" => "with = \"disc_top\"\nquadrature = \"gauss\"",
        "contact.quadrature: found Gauss points on a pair, expected nodal quadrature; the points of a pair are the vertices of its nonmortar side";
    twice: "[contact]\non = \"pad_bottom\"" => "[[contact]]\non = \"disc_top\"\nwith = \"pad_bottom\"\nnormal = { law = \"signorini\" }\n[[contact]]\non = \"pad_bottom\"",
        "contact[1].with: found \"pad_bottom\" and \"disc_top\" again, expected each pair of sides once; remove it, or merge it with entry 1";
    nothing_holds_the_disc: "on = \"disc_bottom\"\ndisplacement = [0, 0]" => "on = \"disc_bottom\"\npressure = 0",
        "no fault";
    nothing_holds_anything: "displacement = [0, -1e-3]\ntemperature = 1" => "pressure = 1\ntemperature = 1",
        "no fault";
    blocks_of_other_dimensions: "size = [2.0, 1.0]" => "size = [2.0, 1.0, 1.0]",
        "mesh.blocks[1].size: found 3 numbers, expected 2 of them, as the first block is in 2 dimensions";
    blocks_of_one_name: "name = \"pad\"" => "name = \"disc\"",
        "mesh.blocks[1].name: found \"disc\" again, expected a name of its own for each block";
    a_block_without_a_size: "size = [2.0, 1.0]\n" => "",
        "mesh.blocks[1]: found neither `size` nor `radii` nor `file`, expected one of them: `size` of an interval, rectangle or box, `radii` of a round body, a mesh `file`";
    a_block_of_two_shapes: "size = [2.0, 1.0]" => "size = [2.0, 1.0]\nradii = [0, 1]",
        "mesh.blocks[1]: found both `size` and `radii`, expected one of them";
    a_cylinder_in_the_plane: "size = [2.0, 1.0]" => "radii = [0.5, 1.0]\nheight = 1.0",
        "mesh.blocks[1].radii: found a body in 3 dimensions, expected one in 2, as the first block is";
    a_height_of_a_rectangle: "size = [2.0, 1.0]" => "size = [2.0, 1.0]\nheight = 1.0",
        "mesh.blocks[1].height: found `height`, expected it only besides the `radii` of a cylinder; remove it";
    an_angle_of_a_rectangle: "size = [2.0, 1.0]" => "size = [2.0, 1.0]\nangle = 1.0",
        "mesh.blocks[1].angle: found `angle`, expected it only besides the `radii` of a ring or a cylinder; remove it";
    a_diagonal_of_quadrilaterals: "size = [2.0, 1.0]" => "size = [2.0, 1.0]\ndiagonal = \"left\"\nelements = \"Q1\"",
        "mesh.blocks[1].diagonal: found `diagonal`, expected it only in a rectangle of triangles, P1 or P2; remove it";
    a_ring_with_a_hole_that_is_too_large: "size = [2.0, 1.0]" => "radii = [1.0, 0.5]",
        "mesh.blocks[1]: found ";
    a_disc_of_five_cells_around: "size = [2.0, 1.0]\nn = [4, 2]" => "radii = [0, 0.5]\nn = [4, 5]",
        "mesh.blocks[1]: found 5";
}

/// Parts that hold each other by pairs, but that nothing holds.
#[test]
fn bodies_that_nothing_holds() {
    let text =
        CASE.replace("displacement = [0, 0]", "pressure = 0").replace("displacement = [0, -1e-3]", "pressure = 1");
    let told = common::told(&Source::new("pad.toml", text), &[]);
    assert!(told.contains("found no displacement prescribed and density 0 in part 1 of the body"), "{told}");
}

/// A pad that only its pair holds: where a side of the pair is unknown, nothing else is told.
#[test]
fn a_body_that_an_unknown_pair_would_hold() {
    let loose = CASE.replace("displacement = [0, -1e-3]\ntemperature = 1", "pressure = 1");
    let told = |old: &str, new: &str| common::told(&Source::new("pad.toml", common::spoil(&loose, old, new)), &[]);
    let pair = "on = \"pad_bottom\"\nwith = \"disc_top\"";
    assert_eq!(told("", ""), "no fault");
    for (new, begin) in [
        ("on = \"pad_bottom\"\nwith = \"disc_tpo\"", "contact.with: found \"disc_tpo\""),
        ("on = \"pad_botom\"\nwith = \"disc_top\"", "contact.on: found \"pad_botom\""),
    ] {
        let told = told(pair, new);
        assert!(told.contains(begin) && told.lines().count() == 1, "{told}");
    }
    let apart = "origin = [1.0, 1.1]";
    let loose = common::spoil(&loose, "origin = [1.0, 1.0]", apart);
    let text = common::spoil(&loose, pair, "automatic = { distance = 1e-3 }");
    let told = common::told(&Source::new("pad.toml", text), &[]);
    assert!(told.contains("found no two bodies within 1e-3 m of each other"), "{told}");
    assert_eq!(told.lines().count(), 1, "{told}");
}

/// Sides that share facets.
#[test]
fn sides_that_overlap() {
    let case = case::parse(&Source::new("pad.toml", CASE), &[]).expect("a case");
    let made = case.problem.with(|data| {
        let mut mesh = (*data.mesh).clone();
        let both = mesh.facets["pad_bottom"].blocks.iter().chain(&mesh.facets["disc_top"].blocks).cloned().collect();
        mesh.facets.insert("disc_top".to_owned(), amontons::mesh::FacetSet { blocks: both });
        data.mesh = std::sync::Arc::new(mesh);
    });
    let told = made.expect_err("a fault").to_string();
    assert!(told.contains("found 4 facets of \"pad_bottom\" on \"disc_top\" as well"), "{told}");
}

fn faced(text: &str) -> hypotheses::Finding {
    let case = case::parse(&Source::new("pad.toml", text), &[]).unwrap_or_else(|error| panic!("{error}"));
    let all = hypotheses::findings(&case.problem);
    all.into_iter().find(|finding| finding.id == FindingId::Pairs).expect("a finding on the pair")
}

/// Which side bears the points is told, and how much of it is faced.
#[test]
fn what_faces_what_is_told() {
    let finding = faced(CASE);
    assert_eq!(finding.status, FindingStatus::Holds);
    assert!(
        finding.message.starts_with("\"pad_bottom\" bears 5 contact points, and \"disc_top\" faces 100.0000 % of it"),
        "{}",
        finding.message
    );
    let finding = faced(&CASE.replace("origin = [1.0, 1.0]", "origin = [3.0, 1.0]"));
    assert_eq!(finding.status, FindingStatus::NotCovered);
    assert!(finding.message.contains("faces 50.0000 % of it"), "{}", finding.message);
    let deep = CASE.replace("origin = [1.0, 1.0]", "origin = [1.0, 0.875]");
    assert_eq!(faced(&deep).status, FindingStatus::Holds);
}

/// Where no side is named: that of the softer body; of similar ones the one that is covered more, then the finer, then
/// the smaller one.
#[test]
fn the_softer_then_the_covered_then_the_finer_side_is_nonmortar() {
    let bearing = |text: &str| {
        let case = case::parse(&Source::new("pad.toml", text), &[]).unwrap_or_else(|error| panic!("{error}"));
        case.problem.contacts[0].bearing().to_owned()
    };
    assert_eq!(bearing(CASE), "pad_bottom");
    assert_eq!(bearing(&CASE.replace("n = [7, 2]", "n = [15, 2]")), "pad_bottom");
    // However fine the other one is, the pad is covered as a whole.
    assert_eq!(bearing(&CASE.replace("n = [7, 2]", "n = [17, 2]")), "pad_bottom");
    let swapped = CASE.replace("on = \"pad_bottom\"\nwith = \"disc_top\"", "on = \"disc_top\"\nwith = \"pad_bottom\"");
    assert_eq!(bearing(&swapped), "pad_bottom");
    assert_eq!(bearing(&swapped.replace("n = [7, 2]", "n = [17, 2]")), "pad_bottom");
    // Both 4 m long.
    let long =
        swapped.replace("size = [2.0, 1.0]", "size = [4.0, 1.0]").replace("origin = [1.0, 1.0]", "origin = [0.0, 1.0]");
    let region = |body: &str, young: f64| {
        let law =
            format!("{{ law = \"isotropic\", young = {young:e}, poisson = 0.3, stress_state = \"plane-strain\" }}");
        format!(
            "[[region]]\non = \"{body}\"\n[region.material]\ndensity = 0\nheat_capacity = 0\nconductivity = 1\nelasticity = {law}\n"
        )
    };
    let soft = |body: &str, young: f64| long.clone() + &region(body, young);
    assert_eq!(bearing(&long), "disc_top");
    assert_eq!(bearing(&soft("pad", 1e5)), "pad_bottom");
    assert_eq!(bearing(&soft("disc", 1e7)), "pad_bottom");
    assert_eq!(bearing(&soft("disc", 1e5)), "disc_top");
    assert_eq!(bearing(&soft("pad", 8e5)), "disc_top");
    // Facets of 0.44 and 0.57 m are similar.
    assert_eq!(bearing(&soft("pad", 8e5).replace("n = [4, 2]", "n = [9, 2]")), "disc_top");
    // Below the pad there are 3 nodes, or 1, about which the pad could turn: then the stiffer side has the points.
    let coarse = |n: usize| CASE.replace("n = [7, 2]", &format!("n = [{n}, 2]")) + &region("disc", 1e5);
    assert_eq!(bearing(&coarse(4)), "disc_top");
    assert_eq!(bearing(&coarse(2)), "pad_bottom");
    let named = "with = \"disc_top\"\nnonmortar = \"disc_top\"";
    assert_eq!(bearing(&CASE.replace("with = \"disc_top\"", named)), "disc_top");
}
