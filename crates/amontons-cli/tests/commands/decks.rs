//! `amontons import`: laws, parts, local axes and steps of small decks, against closed forms.

use std::fs;
use std::path::Path;

use crate::common::{amontons, assert_code, output, read, stderr, stdout};
use tempfile::{TempDir, tempdir};

/// Two cubes of 10 mm on each other, the upper one between `UNDER` and `LID`; what follows the elements.
fn cubes(rest: &str) -> String {
    let corners = [(0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0), (0, 0, 10), (10, 0, 10), (10, 10, 10), (0, 10, 10)];
    let mut deck = "*NODE, NSET=NALL\n".to_owned();
    for cube in 0..2 {
        for (number, (x, y, z)) in corners.iter().enumerate() {
            deck += &format!("{}, {x}, {y}, {}\n", 10 * cube + number + 1, z + 10 * cube);
        }
    }
    deck + "*ELEMENT, TYPE=C3D8, ELSET=ALL\n1, 1, 2, 3, 4, 5, 6, 7, 8\n2, 11, 12, 13, 14, 15, 16, 17, 18\n\
            *SURFACE, NAME=OVER\n1, S2\n*SURFACE, NAME=UNDER\n2, S1\n*SURFACE, NAME=LID\n2, S2\n\
            *NSET, NSET=FIX\n1, 2, 3, 4\n*NSET, NSET=TOP\n15, 16, 17, 18\n"
        + rest
}

/// The case of a deck in mm, N, s, and what was said; the folder holds both.
fn imported(deck: &str) -> (TempDir, String) {
    let folder = tempdir().expect("a folder");
    fs::write(folder.path().join("deck.inp"), deck).expect("a deck");
    let said = import(folder.path());
    (folder, said)
}

fn import(folder: &Path) -> String {
    let done = output(amontons(&["import", "deck.inp", "--units", "mm-N-s"]).current_dir(folder));
    assert_code(&done, 0);
    stdout(&done)
}

/// Rows of a quantity at a point in m, one per step.
fn probed(folder: &Path, quantity: &str, at: &str) -> Vec<f64> {
    let mut case = read(&folder.join("deck.toml"));
    case += &format!("\n[[probe]]\nname = \"own\"\nquantity = \"{quantity}\"\nat = {at}\n");
    fs::write(folder.join("deck.toml"), case).expect("a case");
    let done = output(amontons(&["run", "deck.toml", "--out", "results", "--no-certificate"]).current_dir(folder));
    assert_code(&done, 0);
    let table = read(&folder.join("results/probes.csv"));
    let column = table.lines().next().expect("a head").split(',').position(|name| name == "own").expect("the probe");
    table.lines().skip(1).map(|line| line.split(',').nth(column).expect("a cell").parse().expect("a number")).collect()
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{found:e}, expected {expected:e}");
}

/// The lid sinks by the elastic strain of 21 MPa and by the overclosure that the law has at 21 MPa.
#[test]
fn laws_of_pressure_have_their_overclosure() {
    let elastic = 20.0 * 21.0 / 210_000.0;
    // Between 10 and 30 MPa; p = 10 exp(ln(100) d / 0.01) less one per cent; a slope; none.
    let laws = [
        ("TABULAR\n0, 0\n10, 0.001\n30, 0.002", 0.00155, 1e-9),
        // It begins in the gap, or beyond, and the sides are apart at rest.
        ("TABULAR\n0, -0.001\n10, 0\n30, 0.001", 0.00055, 1e-9),
        ("TABULAR\n0, 0.001\n10, 0.002\n30, 0.003", 0.00255, 1e-9),
        ("TABULAR\n0, -0.001\n10, 0\n30, 0.001\n*CLEARANCE, VALUE=0.0005", 0.00105, 1e-9),
        ("EXPONENTIAL\n0.01, 10", 0.01 * 2.1_f64.ln() / 100.0_f64.ln(), 0.003),
        ("LINEAR\n1e4, 1", 0.0021, 1e-9),
        ("HARD", 0.0, 1e-9),
        ("TIED", 0.0, 1e-9),
    ];
    for (law, overclosure, tolerance) in laws {
        // The clearance is that of a pair that stands before it.
        let (law, apart) =
            law.split_once("\n*").map_or((law, String::new()), |(law, rest)| (law, format!("*{rest}\n")));
        let (folder, _) = imported(&cubes(&format!(
            "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n\
             *SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE={law}\n\
             *CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nUNDER, OVER\n{apart}*BOUNDARY\nFIX, ENCASTRE\n\
             *STEP\n*STATIC\n*DLOAD\n2, P2, 21.\n*END STEP\n"
        )));
        let found = probed(folder.path(), "displacement_z", "[0, 0, 0.02]");
        assert_near(found[0], -1e-3 * (elastic + overclosure), tolerance);
    }
}

/// Bodies that rest and pass heat: three resistances in a row, 10/50, 1/5 and 10/50 K mm²/mW over 60 K.
#[test]
fn a_joint_passes_heat_in_a_step_of_heat_alone() {
    let (folder, said) = imported(&cubes(
        "*MATERIAL, NAME=STEEL\n*CONDUCTIVITY\n50.\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n\
         *SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n*GAP CONDUCTANCE\n5.\n\
         *CONTACT PAIR, INTERACTION=I\nUNDER, OVER\n*STEP\n*HEAT TRANSFER, STEADY STATE\n*BOUNDARY\n\
         FIX, 11, 11, 20.\nTOP, 11, 11, 80.\n*END STEP\n",
    ));
    assert!(!said.contains("differs"), "{said}");
    let found = probed(folder.path(), "temperature", "[0.005, 0.005, 0.005]");
    assert_near(*found.last().expect("a step"), 30.0, 1e-9);
}

/// A pull that is there at once sets two cubes in motion, as it does two bars in a row with a consistent mass.
#[test]
fn a_load_of_a_dynamic_step_does_not_ramp() {
    let (folder, said) = imported(&cubes(
        "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.\n*DENSITY\n7.85e-9\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n\
         *TIE, NAME=BOND\nUNDER, OVER\n*BOUNDARY\nFIX, 1, 3\n*STEP\n*DYNAMIC, DIRECT\n1e-8, 1e-6\n*DSLOAD\n\
         LID, P, -100.\n*END STEP\n",
    ));
    assert!(said.contains("*DYNAMIC: both programs damp by rules of their own"), "{said}");
    let case = read(&folder.path().join("deck.toml"));
    assert!(case.contains("\nend = 1e-6\nsteps = 100\n") && case.contains("\npressure = -1e8\n"), "{case}");
    assert!(case.contains("\ndensity = 7850.0 ") && !case.contains("inertia"), "{case}");
    let found = probed(folder.path(), "displacement_z", "[0, 0, 0.02]");
    let (mass, stiffness, t): (f64, f64, f64) = (7850.0 * 1e-6, 210e9 * 0.01, 1e-6);
    // A consistent mass of a bar of two elements: 1/6 (4, 1; 1, 2) m, and stiffness (2, −1; −1, 1) k.
    let force = 100e6 * 1e-4;
    assert_near(found[99], at_end_of_two_bars(mass, stiffness, force, t), 0.02);
}

/// Displacement of the end of two bars in a row at a time, by many steps of the explicit rule.
fn at_end_of_two_bars(mass: f64, stiffness: f64, force: f64, t: f64) -> f64 {
    let (mut u, mut w) = ([0.0_f64; 2], [0.0_f64; 2]);
    let steps = 200_000;
    let k = t / f64::from(steps);
    for _ in 0..steps {
        let load = [-stiffness * (2.0 * u[0] - u[1]), force - stiffness * (u[1] - u[0])];
        // The inverse of (4, 1; 1, 2)/6 is (2, −1; −1, 4) 6/7.
        let rate = [2.0 * load[0] - load[1], 4.0 * load[1] - load[0]].map(|r| r * 6.0 / (7.0 * mass));
        for i in 0..2 {
            w[i] += k * rate[i];
            u[i] += k * w[i];
        }
    }
    u[1]
}

/// Heat flows into the nodes of a side, of a cube by set and of a ring by number: 10 K per 10 mm is q = 50 mW/mm².
#[test]
fn heat_flows_into_nodes_are_those_of_their_side() {
    let (folder, said) = imported(&cubes(
        "*MATERIAL, NAME=STEEL\n*CONDUCTIVITY\n50.\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*TIE, NAME=BOND\n\
         UNDER, OVER\n*STEP\n*HEAT TRANSFER, STEADY STATE\n*BOUNDARY\nFIX, 11, 11, 20.\n*CFLUX\nTOP, 11, 1250.\n\
         *END STEP\n",
    ));
    assert!(
        said.contains("*CFLUX: the heat flow into the nodes is spread evenly over their side [may matter]"),
        "{said}"
    );
    let found = probed(folder.path(), "temperature", "[0, 0, 0.02]");
    // 4 · 1250 mW over 100 mm²; the tie conducts well, but not without end.
    assert_near(*found.last().expect("a step"), 20.0 + 20.0, 1e-3);
    let deck = "*NODE, NSET=NALL\n1, 10, 0\n2, 20, 0\n3, 20, 10\n4, 10, 10\n*ELEMENT, TYPE=CAX4, ELSET=ALL\n1, 1, 2, 3, 4\n\
                *NSET, NSET=FIX\n1, 2\n*MATERIAL, NAME=STEEL\n*CONDUCTIVITY\n50.\n\
                *SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*STEP\n*HEAT TRANSFER, STEADY STATE\n*BOUNDARY\n\
                FIX, 11, 11, 0.\n*CFLUX\n3, 11, 23561.9449\n4, 11, 23561.9449\n*END STEP\n";
    let (folder, _) = imported(deck);
    // Both together are 50 mW/mm² on π (20² − 10²) mm².
    let found = probed(folder.path(), "temperature", "[0.015, 0.01]");
    assert_near(*found.last().expect("a step"), 10.0, 1e-6);
}

/// A cube that a hot core would have: α from 20 K on by a table whose zero is elsewhere, θ from 20 to 120.
#[test]
fn expansion_counts_from_the_initial_temperature() {
    let (folder, _) = imported(&cubes(
        "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.\n*EXPANSION, ZERO=-80.\n1e-5, 0.\n2e-5, 200.\n\
         *SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*TIE, NAME=BOND\nUNDER, OVER\n\
         *INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 20.\n*BOUNDARY\nFIX, 3\n1, 1, 2\n2, 2\n\
         *STEP\n*STATIC\n*TEMPERATURE\nNALL, 120.\n*END STEP\n",
    ));
    // α(120) (120 + 80) − α(20) (20 + 80), with α = 1e-5 + 5e-8 θ.
    let strain = 1.6e-5 * 200.0 - 1.1e-5 * 100.0;
    let found = probed(folder.path(), "displacement_z", "[0, 0, 0.02]");
    assert_near(found[0], 0.02 * strain, 2e-3);
    // The temperature is given: nothing conducts, and it grows over the step as it does in the deck.
    let case = read(&folder.path().join("deck.toml"));
    assert!(case.contains("temperature = { times = [0.0, 1.0], values = [0.0, 100.0] }   # *TEMPERATURE\n"), "{case}");
    assert!(!case.contains("conductivity") && !case.contains("[initial]"), "{case}");
}

/// `*TEMPERATURE` by an amplitude, half way up at half of the time; node by node it is told and not taken.
#[test]
fn temperatures_that_are_given_follow_their_amplitude() {
    let deck = |lines: &str| {
        cubes(&format!(
            "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*EXPANSION\n1e-5\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n\
             *TIE, NAME=BOND\nUNDER, OVER\n*AMPLITUDE, NAME=RISE\n0., 0., 1., 0.5\n\
             *BOUNDARY\nFIX, 3\n1, 1, 2\n2, 2\n*STEP\n*STATIC\n*TEMPERATURE{lines}\n*END STEP\n"
        ))
    };
    let (folder, _) = imported(&deck(", AMPLITUDE=RISE\nNALL, 100."));
    let found = probed(folder.path(), "displacement_z", "[0, 0, 0.02]");
    assert_near(*found.last().expect("a step"), 0.02 * 50.0 * 1e-5, 1e-9);
    let (folder, told) = imported(&deck("\n1, 100.\n2, 80."));
    let why = "*TEMPERATURE: temperatures that differ from node to node are not taken: give `temperature` in [load] as an expression or as data of a mesh file [the answer differs]";
    assert!(told.contains(why), "{told}");
    assert!(!read(&folder.path().join("deck.toml")).contains("temperature ="));
}

/// Moduli over the temperature see it where nothing expands: E of 210 and 150 GPa at 20 and 120, here at 70.
#[test]
fn moduli_see_a_temperature_that_is_given() {
    let (folder, _) = imported(&cubes(
        "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0., 20.\n150000., 0., 120.\n\
         *SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*TIE, NAME=BOND\nUNDER, OVER\n\
         *INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 20.\n*BOUNDARY\nFIX, 3\n1, 1, 2\n2, 2\n\
         *STEP\n*STATIC\n*TEMPERATURE\nNALL, 70.\n*DLOAD\n2, P2, 18.\n*END STEP\n",
    ));
    let found = probed(folder.path(), "displacement_z", "[0, 0, 0.02]");
    assert_near(*found.last().expect("a step"), -0.02 * 18.0 / 180_000.0, 1e-9);
}

/// Parts of which each has a set of the same name, materials in a file that the deck includes, a tie, and two steps.
#[test]
fn parts_keep_their_materials() {
    let part = |name: &str, material: &str| {
        format!(
            "*PART, NAME={name}\n*NODE\n1, 0, 0\n2, 10, 0\n3, 10, 10\n4, 0, 10\n*ELEMENT, TYPE=CPS4\n1, 1, 2, 3, 4\n\
             *ELSET, ELSET=Set-1\n1\n*SOLID SECTION, ELSET=Set-1, MATERIAL={material}\n3.\n*END PART\n"
        )
    };
    let folder = tempdir().expect("a folder");
    fs::create_dir(folder.path().join("data")).expect("a folder");
    let materials = "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000, 0.\n*MATERIAL, NAME=ALU\n*ELASTIC\n70000, 0.\n";
    fs::write(folder.path().join("data/materials.txt"), materials).expect("a file");
    let deck = part("A", "STEEL")
        + &part("B", "ALU")
        + "*ASSEMBLY, NAME=ALL\n*INSTANCE, NAME=LOW, PART=A\n*END INSTANCE\n*INSTANCE, NAME=HIGH, PART=B\n0, 10, 0\n\
           *END INSTANCE\n*NSET, NSET=FIX, INSTANCE=LOW\n1, 2\n*NSET, NSET=SYM, INSTANCE=LOW\n1, 4\n\
           *NSET, NSET=SYM, INSTANCE=HIGH\n1, 4\n*ELSET, ELSET=UPPER, INSTANCE=HIGH\n1\n*ELSET, ELSET=LOWER, INSTANCE=LOW\n1\n\
           *SURFACE, NAME=UNDER\nUPPER, S1\n*SURFACE, NAME=OVER\nLOWER, S3\n*TIE, NAME=T\nUNDER, OVER\n*END ASSEMBLY\n\
           *INCLUDE, INPUT=data/materials.txt\n*BOUNDARY\nFIX, YSYMM\nSYM, XSYMM\n\
           *STEP\n*STATIC\n*DLOAD\nUPPER, P3, -21.\n*END STEP\n\
           *STEP\n*STATIC\n*DLOAD, OP=NEW\n*CLOAD\nHIGH.3, 2, 315.\nHIGH.4, 2, 315.\n*END STEP\n";
    fs::write(folder.path().join("deck.inp"), deck).expect("a deck");
    import(folder.path());
    assert!(read(&folder.path().join("deck.toml")).contains("# data/materials.txt line 5"));
    let found = probed(folder.path(), "displacement_y", "[0.01, 0.02]");
    // 630 N on 10 mm × 3 mm in both steps.
    let expected = 0.01 * 21.0 * (1.0 / 210_000.0 + 1.0 / 70_000.0);
    assert_eq!(found.len(), 2);
    assert_near(found[0], expected, 1e-9);
    assert_near(found[1], expected, 1e-9);
}

/// A plate of 10 × 5 × 1 mm that is turned by atan(3/4), held and loaded in its own axes: 20 MPa along (−0.6, 0.8).
#[test]
fn local_axes_hold_and_load() {
    let deck = "*NODE\n1, 0, 0\n2, 8, 6\n3, 5, 10\n4, -3, 4\n*ELEMENT, TYPE=CPS4, ELSET=ALL\n1, 1, 2, 3, 4\n\
                *NSET, NSET=LOW\n1, 2\n*NSET, NSET=TOP\n3, 4\n*MATERIAL, NAME=STEEL\n*ELASTIC\n210000, 0.\n\
                *SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n1.\n*TRANSFORM, NSET=LOW\n0.8, 0.6, 0, -0.6, 0.8, 0\n\
                *TRANSFORM, NSET=TOP\n0.8, 0.6, 0, -0.6, 0.8, 0\n*BOUNDARY\nLOW, 2\n1, 1, 2\n\
                *STEP\n*STATIC\n*CLOAD\nTOP, 2, 100.\n*END STEP\n";
    let (folder, _) = imported(deck);
    let stretch = 0.005 * 20.0 / 210_000.0;
    assert_near(probed(folder.path(), "displacement_x", "[0.005, 0.01]")[0], -0.6 * stretch, 1e-9);
    // Another component of the displacement than the normal one is none that a case can hold, nor is that of a node.
    let refused = |held: &str, found: &str| {
        fs::write(folder.path().join("deck.inp"), deck.replace("LOW, 2\n", held)).expect("a deck");
        let done = output(amontons(&["import", "deck.inp", "--force"]).current_dir(folder.path()));
        assert_code(&done, 2);
        assert_eq!(stderr(&done), format!("Error: deck.inp, {found}\n"));
    };
    refused(
        "LOW, 2\n2, 1, 1\n",
        "line 23: found nodes that are held along one axis of a *TRANSFORM and are no side, \
         expected a node set of whole facets, or axes along x, y or z",
    );
    refused(
        "LOW, 1\n",
        "line 22: found a side that is held along axis 1 of a *TRANSFORM, to which it is not normal, \
         expected an axis along x, y or z, or along the normal of the side",
    );
}

/// Facets as elements, as Gmsh writes them, are no parts of the body: a plane element on a cube bears no load.
#[test]
fn facets_as_elements_are_no_parts_of_the_body() {
    let deck = cubes(
        "*ELEMENT, TYPE=CPS4, ELSET=LAST\n3, 15, 16, 17, 18\n*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.\n\
         *SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*TIE, NAME=BOND\nUNDER, OVER\n*BOUNDARY\nFIX, 1, 3\n*STEP\n\
         *STATIC\n*BOUNDARY\nTOP, 3, 3, 0.002\n*END STEP\n",
    );
    let folder = tempdir().expect("a folder");
    fs::write(folder.path().join("deck.inp"), &deck).expect("a deck");
    import(folder.path());
    assert_near(probed(folder.path(), "stress_zz", "[0.005, 0.005, 0.005]")[0], 21e6, 1e-9);
    let spoiled = deck.replace("*BOUNDARY\nTOP, 3, 3, 0.002", "*DLOAD\nLAST, P1, 1.");
    fs::write(folder.path().join("deck.inp"), spoiled).expect("a deck");
    let done = output(amontons(&["import", "deck.inp", "--force"]).current_dir(folder.path()));
    assert_code(&done, 2);
    let expected = "line 44: found \"LAST\" without a solid element, expected a set of elements of the body";
    assert_eq!(stderr(&done), format!("Error: deck.inp, {expected}\n"));
}

/// What holds in a part of the steps is told, and files that include each other end.
#[test]
fn what_a_case_cannot_do_in_time_is_told() {
    let (folder, said) = imported(&cubes(
        "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*TIE, NAME=BOND\n\
         UNDER, OVER\n*BOUNDARY\nFIX, 1, 3\n*STEP\n*STATIC\n*END STEP\n*STEP\n*STATIC\n*BOUNDARY\nTOP, 3, 3, -0.01\n\
         *END STEP\n*STEP\n*STATIC\n*BOUNDARY, OP=NEW\nFIX, 1, 3\n*END STEP\n",
    ));
    for line in [
        "  line 42  condition on TOP: the case has it from the start, the deck from this step on [the answer differs]\n",
        "  line 47  condition on TOP: the case has it to the end with the value 0, the deck removes it in this step \
         [the answer differs]\n",
    ] {
        assert!(said.contains(line), "{said}");
    }
    fs::write(folder.path().join("round.inp"), "*INCLUDE, INPUT=round.inp\n").expect("a deck");
    let done = output(amontons(&["import", "round.inp"]).current_dir(folder.path()));
    assert_code(&done, 2);
    let expected = "line 1: found *INCLUDE of \"round.inp\", which includes this file, expected files that end";
    assert_eq!(stderr(&done), format!("Error: round.inp, {expected}\n"));
}

/// The two cubes with a reference node; what holds the lower one, and what is said of the rest.
fn platen(model: &str, step: &str) -> (String, String) {
    let (folder, said) = imported(&cubes(&format!(
        "*NODE\n99, 5., 5., 30.\n98, 0., 0., 0.\n*NSET, NSET=UP\n15, 16, 17, 18\n*ELSET, ELSET=UPPER\n2\n\
         *MATERIAL, NAME=STEEL\n*ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*TIE, NAME=T\nUNDER, OVER\n\
         {model}*BOUNDARY\nFIX, ENCASTRE\n*STEP\n*STATIC\n{step}*END STEP\n"
    )));
    (read(&folder.path().join("deck.toml")), said)
}

/// The ways to name a rigid part are one table of the case, with what acts on its reference node.
#[test]
fn rigid_parts_are_named_in_many_ways() {
    let ways = [
        ("*RIGID BODY, NSET=UP, REF NODE=99\n", "UP"),
        ("*RIGID BODY, NSET=UP, REF NODE=99, ROT NODE=98\n", "UP"),
        ("*COUPLING, REF NODE=99, SURFACE=LID, CONSTRAINT NAME=C\n*KINEMATIC\n", "LID"),
        ("*COUPLING, REF NODE=99, SURFACE=LID, CONSTRAINT NAME=C\n*KINEMATIC\n1, 1\n2, 3\n", "LID"),
        ("*KINEMATIC COUPLING, REF NODE=99\nUP, 1, 3\n", "UP"),
        ("*KINEMATIC COUPLING, REF NODE=99\n15, 1, 6\n16, 1, 6\n17, 1, 6\n18, 1, 6\n", "rigid-"),
    ];
    for (model, on) in ways {
        let (turning, about) = if model.contains("ROT") { (98, "1") } else { (99, "4") };
        let step = format!("*CLOAD\n99, 1, 3.\n99, 1, 4.\n{turning}, {about}, 5.\n");
        let (case, said) = platen(model, &step);
        assert!(!said.contains("the answer differs"), "{said}");
        let rigid = case.split("[[rigid]]").nth(1).unwrap_or_else(|| panic!("{model}{case}"));
        let lines: Vec<&str> = rigid.lines().skip(1).take_while(|line| !line.is_empty()).collect();
        assert!(lines[0].starts_with(&format!("on = \"{on}")), "{lines:?}");
        assert_eq!(lines[1], "force = [{ times = [0.0, 1.0], values = [0.0, 7.0] }, 0.0, 0.0]");
        assert_eq!(lines[2], "at = [0.005, 0.005, 0.03]");
        assert_eq!(lines[3], "moment = [{ times = [0.0, 1.0], values = [0.0, 0.005] }, 0.0, 0.0]");
        assert_eq!(lines.len(), 4, "{lines:?}");
    }
}

/// A region is rigid as a whole, by its elements or by all of its nodes.
#[test]
fn a_rigid_region_is_named_as_such() {
    let all =
        ["*RIGID BODY, ELSET=UPPER, REF NODE=99\n", "*NSET, NSET=N, ELSET=UPPER\n*RIGID BODY, NSET=N, REF NODE=99\n"];
    for model in all {
        let (case, said) =
            platen(&format!("*SOLID SECTION, ELSET=UPPER, MATERIAL=STEEL\n{model}"), "*CLOAD\n99, 3, 1.\n");
        assert!(case.contains("[[rigid]]") && case.contains("\non = \"UPPER\"\nforce"), "{case}");
        assert!(!said.contains("the answer differs"), "{said}");
    }
}

/// What holds a part: all rotations guide it, a reference node at one of its nodes is a hinge; the rest is told.
#[test]
fn what_holds_a_rigid_part_is_taken_or_told() {
    let (free, hinge) = ("*RIGID BODY, NSET=UP, REF NODE=99, ROT NODE=98\n", "*RIGID BODY, NSET=UP, REF NODE=17\n");
    let coupling = "*COUPLING, REF NODE=99, SURFACE=LID, CONSTRAINT NAME=C\n";
    let distributing = format!("{coupling}*DISTRIBUTING\n");
    let some = format!("{coupling}*KINEMATIC\n3, 3\n");
    let twice = format!("{free}*RIGID BODY, NSET=FIX, REF NODE=99\n");
    let shared = format!("{free}*RIGID BODY, NSET=TOP\n");
    let guided = "*BOUNDARY\n98, 1, 3\n99, 1, 1, 2.\n";
    let taken = "guided = true\n\n[[boundary]]                         # *BOUNDARY line ";
    let all = [
        (free, guided, Some(taken), None),
        (
            free,
            "*BOUNDARY\n98, 1, 3\n*CLOAD\n98, 2, 1.\n",
            Some("guided"),
            Some("the rotation is held, which takes it [does"),
        ),
        (free, "*BOUNDARY\n98, 1, 2\n", None, Some("holds all rotations or none")),
        (
            free,
            "*BOUNDARY\n98, 1, 3\n98, 1, 1, 0.1\n",
            Some("guided"),
            Some("the rotation that the deck prescribes is 0"),
        ),
        (free, "*BOUNDARY\n99, 1, 3\n", None, Some("turns about a reference node that is none of its nodes")),
        (free, "*CLOAD\n99, 11, 1.\n", None, Some("*CLOAD in direction 11")),
        (free, "*END STEP\n*STEP\n*STATIC\n*BOUNDARY\n98, 1, 3\n", Some("guided"), Some("the deck from this step on")),
        (hinge, "*BOUNDARY\n17, 1, 3\n", Some("displacement = [0.0, 0.0, 0.0]"), None),
        (&distributing, "", None, Some("*DISTRIBUTING: the nodes are not coupled [the answer differs]")),
        (&some, "", None, Some("*COUPLING of some directions")),
        (&twice, "", Some("[[rigid]]"), Some("its reference node is that of another rigid part")),
        (&shared, "", Some("[[rigid]]"), Some("another rigid part has some of its nodes")),
        ("*RIGID BODY, NSET=NALL\n", "", None, Some("it is on several bodies")),
        ("*RIGID BODY, ELSET=SHELLS, REF NODE=99\n", "", None, Some("no node of it belongs to a solid element")),
        ("*RIGID BODY, ANALYTICAL SURFACE=S, REF NODE=99\n", "", None, Some("the body is not rigid")),
    ];
    for (model, step, written, told) in all {
        let (case, said) = platen(model, step);
        assert!(written.is_none_or(|text| case.contains(text)), "{model}{step}{case}");
        assert!(written.is_some() || !case.contains("guided = true"), "{case}");
        match told {
            Some(text) => assert!(said.contains(text), "{model}{step}{said}"),
            None => assert!(!said.contains("the answer differs"), "{model}{step}{said}"),
        }
    }
    let (case, _) = platen(free, guided);
    assert!(
        case.contains(
            "\non = \"UP\"\ndisplacement = [{ times = [0.0, 1.0], values = [0.0, 0.002] }, \"free\", \"free\"]"
        )
    );
    let (case, _) = platen(free, "*END STEP\n*STEP\n*STATIC\n*CLOAD, OP=NEW\n99, 1, 0.\n");
    assert!(!case.contains("guided = true"), "{case}");
}

/// A reference point of an assembly has a number of its own, which nodes of instances have, too.
#[test]
fn an_assembly_has_its_reference_points() {
    let (folder, said) = imported(
        "*PART, NAME=CUBE\n*NODE\n1, 0, 0, 0\n2, 10, 0, 0\n3, 10, 10, 0\n4, 0, 10, 0\n5, 0, 0, 10\n6, 10, 0, 10\n\
         7, 10, 10, 10\n8, 0, 10, 10\n*ELEMENT, TYPE=C3D8, ELSET=ALL\n1, 1, 2, 3, 4, 5, 6, 7, 8\n\
         *SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*END PART\n*ASSEMBLY, NAME=A\n\
         *INSTANCE, NAME=BLOCK, PART=CUBE\n*END INSTANCE\n*NODE\n1, 5., 5., 30.\n*NSET, NSET=POINT\n1,\n\
         *NSET, NSET=LOW, INSTANCE=BLOCK\n1, 2, 3, 4\n*NSET, NSET=HIGH, INSTANCE=BLOCK\n5, 6, 7, 8\n\
         *RIGID BODY, REF NODE=POINT, TIE NSET=HIGH\n*END ASSEMBLY\n*MATERIAL, NAME=STEEL\n*ELASTIC\n1000., 0.\n\
         *BOUNDARY\nLOW, ENCASTRE\n*STEP\n*STATIC\n*BOUNDARY\nPOINT, 4, 6\n*CLOAD\nPOINT, 3, -100.\n*END STEP\n",
    );
    assert!(!said.contains("the answer differs"), "{said}");
    let found = probed(folder.path(), "displacement_z", "[0.01, 0.01, 0.01]");
    assert_near(found[0], -0.01 / 1000.0, 1e-9);
    assert!(read(&folder.path().join("deck.toml")).contains("guided = true"));
}

/// OP=NEW takes away the forces that it does not repeat.
#[test]
fn forces_on_rigid_parts_are_renewed() {
    let next = "*CLOAD\n99, 1, 3.\n*END STEP\n*STEP\n*STATIC\n*CLOAD, OP=NEW\n99, 2, 4.\n";
    let (case, _) = platen("*RIGID BODY, NSET=UP, REF NODE=99\n", next);
    let expected = "force = [{ times = [0.0, 1.0, 2.0], values = [0.0, 3.0, 0.0] }, { times = [0.0, 1.0, 2.0], values = [0.0, 0.0, 4.0] }, 0.0]";
    assert!(case.contains(expected), "{case}");
}

/// What a cube of E = 100 and ν = 0.25 with branches does under a tension of 1 that is there at once: the strain along
/// it after each of 100 steps, and what is said.
fn creeping(elastic: &str, prony: &str) -> (Vec<f64>, String) {
    let (folder, said) = imported(&format!(
        "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n\
         *ELEMENT, TYPE=C3D8, ELSET=ALL\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=LOW\n1, 2, 3, 4\n*NSET, NSET=LEFT\n1, 4, 5, 8\n\
         *NSET, NSET=FRONT\n1, 2, 5, 6\n*SURFACE, NAME=LID\n1, S2\n*AMPLITUDE, NAME=ON\n0., 1., 10., 1.\n\
         *MATERIAL, NAME=SOFT\n*ELASTIC{elastic}\n100., 0.25\n*VISCOELASTIC, TIME=PRONY\n{prony}\n\
         *SOLID SECTION, ELSET=ALL, MATERIAL=SOFT\n*BOUNDARY\nLOW, 3\nLEFT, 1\nFRONT, 2\n*STEP\n*VISCO, CETOL=0.01\n\
         0.02, 2.\n*DSLOAD, AMPLITUDE=ON\nLID, P, -1.\n*END STEP\n"
    ));
    (probed(folder.path(), "displacement_z", "[0, 0, 0.001]").iter().map(|u| 1e3 * u).collect(), said)
}

/// The strain under a tension of 1 of a body whose shear relaxes from G₀ to G∞ and whose volume has K: 1/(9K) + J/3.
fn creep_in_shear(bulk: f64, short: f64, long: f64, time: f64, t: f64) -> f64 {
    let compliance = 1.0 / long - (1.0 / long - 1.0 / short) * f64::exp(-t * long / (time * short));
    1.0 / (9.0 * bulk) + compliance / 3.0
}

/// Branches of shear alone: the g of Abaqus are parts of the instantaneous modulus, and *ELASTIC has the moduli of long
/// times, or with MODULI=INSTANTANEOUS those at once.
#[test]
fn shear_relaxes_by_its_own_branches() {
    // E = 100 and ν = 0.25: K = 200/3, G = 40. g = 0.6 of G₀ relaxes in 0.5.
    let (bulk, shear, g, time) = (200.0 / 3.0, 40.0, 0.6, 0.5);
    for (elastic, short, long) in [("", shear / (1.0 - g), shear), (", MODULI=INSTANTANEOUS", shear, shear * (1.0 - g))]
    {
        let (found, said) = creeping(elastic, "0.6, 0., 0.5");
        assert!(!said.contains("the answer differs"), "{said}");
        assert_eq!(found.len(), 100);
        for step in [1, 25, 100] {
            // Backward Euler with a step of 0.02 beside a time of 0.5.
            assert_near(found[step - 1], creep_in_shear(bulk, short, long, time, 0.02 * step as f64), 0.01);
        }
        let growth = found[99] - found[0];
        let exact = creep_in_shear(bulk, short, long, time, 2.0) - creep_in_shear(bulk, short, long, time, 0.02);
        assert_near(growth, exact, 0.02);
    }
}

/// g = k: E relaxes as a whole, and ν is constant. A k below g is a branch of both and one of shear; above g it is
/// told.
#[test]
fn branches_of_shear_and_volume_are_taken_apart() {
    for (elastic, long) in [("", 100.0), (", MODULI=INSTANTANEOUS", 40.0)] {
        let (found, said) = creeping(elastic, "0.6, 0.6, 0.5");
        assert!(!said.contains("the answer differs"), "{said}");
        let short = long / 0.4;
        let exact = |t: f64| 1.0 / long - (1.0 / long - 1.0 / short) * f64::exp(-t * 0.4 / 0.5);
        for step in [1, 100] {
            assert_near(found[step - 1], exact(0.02 * step as f64), 0.01);
        }
    }
    // At once as the instantaneous moduli say: E₀ of K₀ = K/(1 − 0.2) and G₀ = G/(1 − 0.6).
    let (found, said) = creeping("", "0.6, 0.2, 1e6");
    assert!(!said.contains("the answer differs"), "{said}");
    let (bulk, shear) = (200.0 / 3.0 / 0.8, 40.0 / 0.4);
    assert_near(found[0], 1.0 / (9.0 * bulk) + 1.0 / (3.0 * shear), 1e-5);
    let (found, said) = creeping("", "0.1, 0.2, 0.5");
    assert!(
        said.contains("*VISCOELASTIC: taken are branches whose shear relaxes at least as the volume does"),
        "{said}"
    );
    assert_near(found[0], 0.01, 1e-9);
}

/// What has no branches of shear alone is told: plane stress, and moduli that are not isotropic.
#[test]
fn branches_of_shear_that_a_case_has_not_are_told() {
    let deck = |kind: &str| {
        format!(
            "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n*ELEMENT, TYPE={kind}, ELSET=ALL\n1, 1, 2, 3, 4\n\
             *NSET, NSET=LOW\n1, 2\n*SURFACE, NAME=LID\n1, S3\n*MATERIAL, NAME=SOFT\n*ELASTIC\n100., 0.25\n\
             *VISCOELASTIC, TIME=PRONY\n0.6, 0., 0.5\n*SOLID SECTION, ELSET=ALL, MATERIAL=SOFT\n*BOUNDARY\nLOW, 1, 2\n\
             *STEP\n*STATIC\n*DSLOAD\nLID, P, 1.\n*END STEP\n"
        )
    };
    let (folder, said) = imported(&deck("CPS4"));
    assert!(said.contains("line 15  *VISCOELASTIC: a case has no branch of shear alone in plane stress"), "{said}");
    assert!(!read(&folder.path().join("deck.toml")).contains("prony"));
    let (folder, said) = imported(&deck("CPE4"));
    let branch = "prony = [{ ratio = 1.5, time = 0.5, deviatoric = true }]";
    assert!(read(&folder.path().join("deck.toml")).contains(branch) && !said.contains("the answer differs"), "{said}");
    assert!(said.contains("Abaqus has the moduli of long times in a static step"), "{said}");
}
