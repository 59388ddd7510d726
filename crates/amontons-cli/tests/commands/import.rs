//! `amontons import`: decks of CalculiX become cases with the same answers.
//!
//! Forces, displacements and temperatures are compared with closed forms and with those of CalculiX 2.20 for the same
//! decks, which `tests/decks/run` computes anew.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{amontons, assert_code, output, read, stderr, stdout};
use tempfile::{TempDir, tempdir};

/// Largest difference from CalculiX, relative to the number.
const TOLERANCE: f64 = 0.015;

/// A deck: that of the guide is with the cases.
fn deck(name: &str) -> PathBuf {
    let folder = if name == "punch" { "../../cases" } else { "tests/data/decks" };
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join(format!("{name}.inp"))
}

/// A folder with a deck and its case in SI.
fn imported(name: &str) -> (TempDir, String) {
    let folder = tempdir().expect("a folder");
    fs::copy(deck(name), folder.path().join("deck.inp")).expect("a deck");
    let done = output(amontons(&["import", "deck.inp", "--units", "mm-N-s"]).current_dir(folder.path()));
    assert_code(&done, 0);
    (folder, stdout(&done))
}

/// The columns of the probes of a run of the case, with more probes at points in mm.
fn run(folder: &Path, more: &[(&str, &str, &str)]) -> Vec<(String, Vec<f64>)> {
    let mut case = read(&folder.join("deck.toml"));
    for (name, quantity, at) in more {
        case += &format!("\n[[probe]]\nname = \"{name}\"\nquantity = \"{quantity}\"\nat = {at}\n");
    }
    fs::write(folder.join("deck.toml"), case).expect("a case");
    let done = output(amontons(&["run", "deck.toml", "--out", "results", "--no-certificate"]).current_dir(folder));
    assert_code(&done, 0);
    let table = read(&folder.join("results/probes.csv"));
    let mut lines = table.lines();
    let names = lines.next().expect("a head").split(',').map(str::to_owned);
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    names.enumerate().map(|(column, name)| (name, rows.iter().map(|row| row[column]).collect())).collect()
}

/// The value of a column at a time.
fn at(columns: &[(String, Vec<f64>)], name: &str, t: f64) -> f64 {
    let of = |name: &str| {
        let names: Vec<&String> = columns.iter().map(|(name, _)| name).collect();
        &columns.iter().find(|(own, _)| own == name).unwrap_or_else(|| panic!("{name} in {names:?}")).1
    };
    let row = of("t").iter().position(|time| (time - t).abs() < 1e-9).expect("the time");
    of(name)[row]
}

fn assert_near(found: f64, expected: f64, what: &str) {
    assert!((found / expected - 1.0).abs() < TOLERANCE, "{what}: {found:e}, expected {expected:e}");
}

/// The force on the plane of symmetry is that of the pressure, and the edge moves as CalculiX has it.
#[test]
fn a_plate_with_a_hole_is_pulled() {
    let (folder, said) = imported("plate");
    assert!(said.contains("*NODE PRINT (2 times): output only [does not matter]"), "{said}");
    let found =
        run(folder.path(), &[("middle", "displacement_x", "[0.05, 0]"), ("corner", "displacement_x", "[0.05, 0.05]")]);
    assert_near(at(&found, "reaction-SYMX_x", 1.0), -100.0 * 50.0 * 2.0, "reaction");
    assert_near(at(&found, "middle", 1.0), 2.503_711e-5, "middle");
    assert_near(at(&found, "corner", 1.0), 2.355_113e-5, "corner");
}

/// A block is pressed on another one and dragged until it slides: forces of CalculiX at the ends of both steps.
#[test]
fn blocks_are_pressed_and_dragged() {
    let ccx = [("blocks-linear", 27_900.74, -8_219.161, 27_419.17), ("blocks-hard", 30_437.04, -8_920.842, 29_768.57)];
    for (name, pressed, dragged, last) in ccx {
        let (folder, said) = imported(name);
        let found = run(folder.path(), &[]);
        assert_near(at(&found, "reaction-FLOOR_z", 1.0), pressed, name);
        assert_near(at(&found, "reaction-FLOOR_x", 2.0), dragged, name);
        assert_near(at(&found, "reaction-FLOOR_z", 2.0), last, name);
        assert!(!said.contains("the answer differs"), "{said}");
    }
}

/// A hot bar between rigid guides: E(θ) α(θ) Δθ on its face, and (1 + ν) α Δθ R at its surface.
#[test]
fn a_bar_of_revolution_is_heated() {
    let (folder, _) = imported("bar");
    let found = run(folder.path(), &[("outer", "displacement_x", "[0.01, 0.025]")]);
    let strain: f64 = 2.4e-5 * 80.0;
    let force = 66_000.0 * strain * std::f64::consts::PI * 100.0;
    assert_near(at(&found, "reaction-BOTTOM_y", 1.0), force, "force");
    // CalculiX writes the force on two of 360 degrees.
    assert_near(at(&found, "reaction-BOTTOM_y", 1.0), 221.1232 * 180.0, "CalculiX");
    assert_near(at(&found, "outer", 1.0), 1.33 * strain * 0.01, "radius");
}

/// Flux q at one end, film h at the other: θ = θ_a + q/h + q (L − x)/k.
#[test]
fn a_rod_conducts_heat() {
    let (folder, _) = imported("rod");
    let found =
        run(folder.path(), &[("hot", "temperature", "[0, 0.01, 0.01]"), ("cold", "temperature", "[0.1, 0.01, 0.01]")]);
    assert_near(at(&found, "cold", 1.0), 20.0 + 50.0 / 0.5, "cold");
    assert_near(at(&found, "hot", 1.0), 20.0 + 50.0 / 0.5 + 50.0 * 100.0 / 50.0, "hot");
}

/// Two tied blocks: displacements of CalculiX at two corners.
#[test]
fn tied_blocks_are_pulled() {
    let (folder, _) = imported("tied");
    let found = run(
        folder.path(),
        &[("low", "displacement_z", "[0, 0, 0.04]"), ("high", "displacement_z", "[0.02, 0.02, 0.04]")],
    );
    assert_near(at(&found, "reaction-FLOOR_z", 1.0), -40_000.0, "force");
    assert_near(at(&found, "low", 1.0), 3.616_614e-5, "low");
    assert_near(at(&found, "high", 1.0), 3.962_625e-5, "high");
}

/// A punch follows an amplitude in the first step and ramps from where it is in the second.
#[test]
fn a_punch_follows_its_steps() {
    let (folder, _) = imported("punch");
    let found = run(folder.path(), &[]);
    for (t, along, across) in
        [(0.5, 0.0, 561.5958), (1.0, 0.0, 452.3371), (1.5, -11.08962, 339.2527), (2.0, -22.17921, 226.1684)]
    {
        assert_near(at(&found, "reaction-FLOOR_y", t), across, "across");
        if along != 0.0 {
            assert_near(at(&found, "reaction-FLOOR_x", t), along, "along");
        }
    }
}

/// The conductance of a joint depends on its pressure, which depends on the temperatures: values of CalculiX.
#[test]
fn heat_passes_a_joint_under_pressure() {
    let (folder, said) = imported("gap");
    assert!(read(&folder.path().join("deck.toml")).contains("# Temperatures count from 20.0"), "{said}");
    let found = run(
        folder.path(),
        &[("below", "temperature", "[0.01, 0.01, 0.0075]"), ("above", "temperature", "[0.01, 0.01, 0.0125]")],
    );
    // Linear from 20 to 43.667 and from 96.333 to 120.
    assert_near(20.0 + at(&found, "below", 1.0), 20.0 + 0.75 * 23.667_28, "below");
    assert_near(20.0 + at(&found, "above", 1.0), 120.0 - 0.75 * 23.667_28, "above");
    assert_near(at(&found, "reaction-FLOOR_z", 1.0), 124_690.7, "force");
}

/// Faces, nodes and supports by number, with gravity: the tip of CalculiX, and the weight and the loads at the support.
#[test]
fn a_cantilever_is_loaded_by_numbers() {
    let (folder, said) = imported("beam");
    assert!(said.contains("deck-sides.inp: its mesh"), "{said}");
    let found = run(folder.path(), &[("tip", "displacement_z", "[0.1, 0.005, 0.005]")]);
    assert_near(at(&found, "tip", 1.0), -4.920_921e-4, "tip");
    // Five nodes in a row, three of each of two cells: three sets without neighbours, so that none is an edge.
    assert_eq!(read(&folder.path().join("deck.toml")).matches("\nforce = [").count(), 3);
    let weight = 7.85e-9 * 1e4 * 9810.0;
    let held = read(&folder.path().join("deck.toml"));
    let name = held.lines().find_map(|line| line.strip_prefix("name = \"reaction-")).expect("a probe");
    let column = format!("reaction-{}_z", name.trim_end_matches('"'));
    assert_near(at(&found, &column, 1.0), 0.5 * 50.0 * 10.0 + 5.0 * 20.0 + weight, "force");
}

/// Fibres along askew axes, and a centrifugal force about an axis beside the plate: two corners of CalculiX.
#[test]
fn an_orthotropic_plate_turns_about_an_axis() {
    let (folder, _) = imported("ply");
    let found =
        run(folder.path(), &[("low", "displacement", "[0.04, 0, 0]"), ("high", "displacement", "[0.04, 0.015, 0.01]")]);
    let corners =
        [("low", [2.816_376e-4, -2.248_250e-4, -2.593_665e-4]), ("high", [2.963_512e-4, -2.084_540e-4, -3.000_588e-4])];
    for (corner, ccx) in corners {
        // The cells have 27 nodes here and 20 there.
        let largest = ccx.into_iter().fold(0.0, |largest: f64, value: f64| largest.max(value.abs()));
        for (axis, expected) in ["x", "y", "z"].into_iter().zip(ccx) {
            let found = at(&found, &format!("{corner}_{axis}"), 1.0);
            assert!((found - expected).abs() < TOLERANCE * largest, "{corner}_{axis}: {found:e}, {expected:e}");
        }
    }
    // 20 MPa on 15 mm × 10 mm, and ρ ω² V times the distance of the centre from the axis.
    let [traction, turning]: [f64; 2] = [20.0 * 150.0, 1.6e-9 * 1e8 * 6000.0];
    assert_near(at(&found, "reaction-LEFT_x", 1.0), -(traction + turning * 25.0), "reaction");
    assert_near(at(&found, "reaction-LEFT_y", 1.0), -turning * (4.5 * 0.64 - 5.0 * 0.48), "reaction");
}

/// A bar under a rigid platen: −F L/(E A) and the tilt of F e L/(E I) by the eccentric force, then that of the moment.
#[test]
fn a_platen_tilts_under_an_eccentric_force_and_a_moment() {
    let (folder, said) = imported("platen");
    assert!(!said.contains("the answer differs") && !said.contains("may matter"), "{said}");
    let corners = [("near", [0.0, 0.0]), ("far", [10.0, 10.0])];
    let places = corners.map(|(name, [x, y])| (name, format!("[{}, {}, 0.04]", x / 1e3, y / 1e3)));
    let probes: Vec<_> = places.iter().map(|(name, at)| (*name, "displacement", at.as_str())).collect();
    let found = run(folder.path(), &probes);
    // E A and E I in N and N mm², lengths in mm.
    let (area, bending, length) = (210_000.0 * 100.0, 210_000.0 * 1e4 / 12.0, 40.0);
    let [about_y, about_x]: [f64; 2] = [1000.0 * 3.0 * length / bending, 800.0 * length / bending];
    for (name, [x, y]) in corners {
        let across = |about_x: f64| -1000.0 * length / area - about_y * (x - 5.0) + about_x * (y - 5.0);
        assert_near(1e3 * at(&found, &format!("{name}_z"), 1.0), across(0.0), name);
        assert_near(1e3 * at(&found, &format!("{name}_z"), 2.0), across(about_x), name);
        assert_near(1e3 * at(&found, &format!("{name}_x"), 2.0), about_y * length / 2.0, name);
        assert_near(1e3 * at(&found, &format!("{name}_y"), 2.0), -about_x * length / 2.0, name);
    }
}

/// A platen between columns is moved aside and pressed: 12 E I u/L³ with the compliance L/(κ G A) of shear, and
/// F L/(E A).
#[test]
fn a_coupled_platen_that_is_guided_moves_as_prescribed() {
    let (folder, said) = imported("coupled");
    assert!(!said.contains("the answer differs") && !said.contains("may matter"), "{said}");
    let found = run(folder.path(), &[("top", "displacement", "[0.01, 0, 0.04]")]);
    let [bending, shear]: [f64; 2] =
        [12.0 * 210_000.0 * 1e4 / 12.0 / 40.0_f64.powi(3), 5.0 / 6.0 * 105_000.0 * 100.0 / 40.0];
    assert_near(at(&found, "reaction-FIX_x", 1.0), -0.02 / (bending.recip() + shear.recip()), "force");
    assert_near(at(&found, "reaction-FIX_x", 1.0), -576.0689, "CalculiX");
    assert_near(at(&found, "reaction-LID_x", 1.0), 576.0689, "CalculiX");
    assert_near(at(&found, "top_x", 1.0), 2e-5, "top");
    assert_near(at(&found, "top_z", 1.0), -1000.0 * 40.0 / (210_000.0 * 100.0) * 1e-3, "top");
}

/// What a deck without units becomes: numbers of the deck, and a case that says so.
#[test]
fn a_deck_keeps_its_numbers_without_units() {
    let folder = tempdir().expect("a folder");
    fs::write(folder.path().join("deck.inp"), SMALL).expect("a deck");
    let done = output(amontons(&["import", "deck.inp", "--out", "other.toml"]).current_dir(folder.path()));
    assert_code(&done, 0);
    let case = read(&folder.path().join("other.toml"));
    for line in [
        "units = \"dimensionless\"",
        "thickness = 2.5",
        "elasticity = { law = \"isotropic\", young = 1000.0, poisson = 0.25, stress_state = \"plane-strain\" }   # line 13",
        "pressure = { times = [0.0, 1.0], values = [0.0, 8.0] }",
        "displacement = [0.0, 0.0]",
        "# Units: not known: the case has the numbers of the deck without units; --units mm-N-s makes it one in SI.",
    ] {
        assert!(case.lines().any(|own| own == line), "{line}\nin\n{case}");
    }
    let again = output(amontons(&["import", "deck.inp", "--out", "other.toml"]).current_dir(folder.path()));
    assert_code(&again, 2);
    let forced = output(amontons(&["import", "deck.inp", "--out", "other.toml", "--force"]).current_dir(folder.path()));
    assert_code(&forced, 0);
    let over = output(amontons(&["import", "deck.inp", "--out", "deck.inp", "--force"]).current_dir(folder.path()));
    assert_code(&over, 2);
    assert_eq!(read(&folder.path().join("deck.inp")), SMALL);
}

/// One element in plane strain.
const SMALL: &str = "*NODE
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
*ELEMENT, TYPE=CPE4, ELSET=ALL
1, 1, 2, 3, 4
*NSET, NSET=BASE
1, 2
*SURFACE, NAME=LID
1, S3
*MATERIAL, NAME=SOFT
*ELASTIC
1000, 0.25
*SOLID SECTION, ELSET=ALL, MATERIAL=SOFT
2.5
*BOUNDARY
BASE, 1, 2
*STEP
*STATIC
*DSLOAD
LID, P, 8
*END STEP
";

/// Decks with a fault, by what is replaced in the small one, and what is said of it.
#[test]
fn a_spoiled_deck_is_refused_with_its_line() {
    let spoiled = [
        (
            "*STATIC\n",
            "*BUCKLE\n2\n",
            "line 20: found *BUCKLE, a buckling analysis, expected a static, dynamic, heat transfer or coupled temperature-displacement step",
        ),
        (
            "*STATIC\n",
            "*FREQUENCY\n10\n",
            "line 20: found *FREQUENCY, an analysis of natural frequencies, expected a static, dynamic, heat transfer or coupled temperature-displacement step",
        ),
        ("*STATIC\n", "", "line 19: found a step without a procedure, expected *STATIC, *HEAT TRANSFER or another one"),
        (
            "TYPE=CPE4, ELSET=ALL\n1, 1, 2, 3, 4",
            "TYPE=B31, ELSET=ALL\n1, 1, 2",
            "line 6: found 1 elements of type B31, which are no parts of a body, expected solid elements, such as C3D8, C3D10, CPS4, CPE4 or CAX4",
        ),
        ("1000, 0.25", "1000", "line 14: found \"1000\", expected Young's modulus and Poisson's ratio"),
        ("1000, 0.25", "1e999, 0.25", "line 14: found \"1e999\", expected a finite number"),
        (
            "*ELASTIC\n1000, 0.25\n",
            "*DENSITY\n1\n",
            "line 12: found the material SOFT without *ELASTIC, expected *ELASTIC below *MATERIAL, which the steps of the deck need",
        ),
        ("MATERIAL=SOFT", "MATERIAL=HARD", "line 15: found MATERIAL=HARD, expected a *MATERIAL that the deck defines"),
        ("BASE, 1, 2", "FLOOR, 1, 2", "line 18: found \"FLOOR\", expected a node or a node set that the deck has"),
        ("BASE, 1, 2", "9, 1, 2", "line 18: found \"9\", expected a node or a node set that the deck has"),
        (
            "BASE, 1, 2",
            "BASE, 2, 1",
            "line 18: found degrees of freedom 2 to 1, expected a first one and a last one that is not smaller, 1 to 3 or 11",
        ),
        ("LID, P, 8", "TOP, P, 8", "line 22: found \"TOP\", expected a *SURFACE that the deck defines"),
        ("LID, P, 8", "LID, P", "line 22: found \"LID, P\", expected a value"),
        (
            "*DSLOAD\nLID, P, 8",
            "*DLOAD\nALL, P7, 8",
            "line 22: found the face P7 of an element without it, expected P1, P2, … up to its number of faces",
        ),
        (
            "*DSLOAD",
            "*DSLOAD, AMPLITUDE=RISE",
            "line 21: found AMPLITUDE=RISE, expected an *AMPLITUDE that the deck defines before",
        ),
        ("*STATIC\n", "*STATIC\n0.1, -1\n", "line 21: found -1.0, expected a positive time"),
        (
            "*END STEP\n",
            "*END STEP\n*CONTACT PAIR, INTERACTION=DRY\nLID, LID\n",
            "line 24: found INTERACTION=DRY, expected a *SURFACE INTERACTION that the deck defines before",
        ),
    ];
    let folder = tempdir().expect("a folder");
    for (from, to, expected) in spoiled {
        assert!(SMALL.contains(from), "{from}");
        fs::write(folder.path().join("deck.inp"), SMALL.replacen(from, to, 1)).expect("a deck");
        let done = output(amontons(&["import", "deck.inp"]).current_dir(folder.path()));
        assert_code(&done, 2);
        assert_eq!(stderr(&done), format!("Error: deck.inp, {expected}\n"));
        assert!(!folder.path().join("deck.toml").exists(), "{expected}");
    }
}

/// What is not taken is told with its line and with what it means for the answer.
#[test]
fn what_is_left_out_is_told() {
    let folder = tempdir().expect("a folder");
    let deck = SMALL
        .replace("*SOLID", "*PLASTIC\n10, 0\n*SOLID")
        .replace("*STEP\n", "*STEP, NLGEOM, PERTURBATION\n")
        .replace("*END STEP", "*EQUATION\n2\n1, 1, 1, 2, 1, -1\n*CONTROLS\n*NODE FILE\nU\n*WAVE\n*END STEP");
    fs::write(folder.path().join("deck.inp"), deck).expect("a deck");
    let done = output(amontons(&["import", "deck.inp"]).current_dir(folder.path()));
    assert_code(&done, 0);
    let (said, case) = (stdout(&done), read(&folder.path().join("deck.toml")));
    for line in [
        "line 15  *PLASTIC: the case is elastic: the answer differs where the yield stress is reached [the answer differs]",
        "line 25  *EQUATION: the nodes are not coupled [the answer differs]",
        "line 21  NLGEOM: a case is a theory of small displacements and strains [may matter]",
        "line 21  PERTURBATION of *STEP: the parameter is not taken [may matter]",
        "line 31  *WAVE: not known: see whether the answer depends on it [may matter]",
        "line 28  *CONTROLS: control of the solution, which is not needed here [does not matter]",
        "line 29  *NODE FILE: output only [does not matter]",
    ] {
        assert!(said.contains(&format!("  {line}\n")), "{line}\nin\n{said}");
        assert!(case.contains(&format!("#   {line}\n")), "{line}\nin\n{case}");
    }
}
